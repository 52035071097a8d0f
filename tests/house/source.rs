//! Reads files: what a module imports, names and implements, and how large things are.

use std::{collections::BTreeSet, fs, path::Path};

use quote::ToTokens;
use syn::{
    ImplItem, Item, ItemMod, ItemUse, Macro, MetaList, PatIdent, Signature, TraitItemFn, Type,
    UseTree, Visibility,
    spanned::Spanned,
    visit::{self, Visit},
};

/// The segments of a path such as `super::a::B`.
pub type Segments = Vec<String>;

/// A file's module, without its tests.
#[derive(Default)]
pub struct Module {
    pub file: String,
    /// The names that it imports, `*` for all of another module; their paths; whether for others, too.
    pub imports: Vec<(String, Segments, bool)>,
    /// The paths that its code names, other than in imports: a name alone is a path, too.
    pub paths: BTreeSet<Segments>,
    pub traits: BTreeSet<String>,
    /// Types with blocks of inherent methods.
    pub implemented: Vec<Segments>,
    /// With their lines from `fn` to the end, and with their fields.
    pub functions: Vec<(String, usize)>,
    pub structs: Vec<(String, usize)>,
    pub lines: [(String, usize); 1],
    /// In how many inline modules it is being read. They count as parts of the file's own.
    depth: usize,
}

/// Rust files of a folder and of those below it, without tests: those may look at all floors.
pub fn files(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy();
        if path.is_dir() && name != "tests" {
            found.extend(files(&path).iter().map(|file| format!("{name}/{file}")));
        } else if name.ends_with(".rs") && name != "tests.rs" {
            found.push(name.into_owned());
        }
    }
    found
}

/// Name and path of each import of a tree.
fn leaves(tree: &UseTree, mut path: Segments) -> Vec<(String, Segments)> {
    let (name, last) = match tree {
        UseTree::Path(tree) => {
            path.push(tree.ident.to_string());
            return leaves(&tree.tree, path);
        }
        UseTree::Group(group) => {
            let each = group.items.iter();
            return each.flat_map(|tree| leaves(tree, path.clone())).collect();
        }
        UseTree::Name(tree) => (tree.ident.to_string(), tree.ident.to_string()),
        UseTree::Rename(tree) => (tree.rename.to_string(), tree.ident.to_string()),
        UseTree::Glob(_) => ("*".into(), "*".into()),
    };
    path.extend((last != "self").then_some(last));
    // `a::{self}` is `a`.
    let own = path.last().filter(|_| name == "self");
    vec![(own.cloned().unwrap_or(name), path)]
}

/// Lines from where one part of the code begins to where another ends.
fn lines(first: &impl Spanned, last: &impl Spanned) -> usize {
    last.span().end().line - first.span().start().line + 1
}

impl Module {
    pub fn of(file: &str, text: &str) -> Self {
        let mut module = Self {
            file: file.to_owned(),
            lines: [("all".to_owned(), text.lines().count())],
            ..Self::default()
        };
        module.visit_file(&syn::parse_file(text).expect("Rust"));
        module
    }

    pub fn all_paths(&self) -> impl Iterator<Item = &Segments> {
        let imported = self.imports.iter().map(|(_, path, _)| path);
        imported.chain(&self.paths)
    }

    fn is_of_tests(&mut self, item: &impl ToTokens) -> bool {
        let tokens = item.to_token_stream().into_iter();
        let texts = tokens.map(|token| token.to_string().replace(' ', ""));
        let is_of_tests = texts
            .take_while(|text| text.starts_with(['#', '[']))
            .any(|text| text == "[cfg(test)]" || text.starts_with("[cfg(all(test,"));
        self.lines[0].1 -= if is_of_tests { lines(item, item) } else { 0 };
        is_of_tests
    }

    /// A path as one of the file's own module.
    fn of_file(&self, mut path: Segments) -> Segments {
        for _ in 0..self.depth {
            let is_own = path.first().is_some_and(|first| first == "super");
            path.drain(..usize::from(is_own));
        }
        path
    }

    fn read_function(&mut self, signature: &Signature, all: &impl Spanned) {
        let name = signature.ident.to_string();
        self.functions.push((name, lines(signature, all)));
    }

    /// Macros and attributes are read as mere tokens: names and paths are seen, but not the groups of a `use`, what
    /// is implemented, and sizes.
    fn read_tokens(&mut self, tokens: &impl ToString) {
        let text = tokens.to_string().replace(" ::", "::").replace(":: ", "::");
        let text = text.replace("$ ", "$");
        let is_of_path = |each: char| each.is_alphanumeric() || "_$:".contains(each);
        for path in text.split(|each| !is_of_path(each)) {
            let path = path.trim_end_matches(':').split("::");
            let path = path.map(str::to_owned).collect();
            self.paths.insert(self.of_file(path));
        }
    }
}

fn segments(path: &syn::Path) -> Segments {
    let each = path.segments.iter();
    each.map(|segment| segment.ident.to_string()).collect()
}

impl<'a> Visit<'a> for Module {
    fn visit_item(&mut self, item: &'a Item) {
        if self.is_of_tests(item) {
            return;
        }
        match item {
            Item::Fn(item) => self.read_function(&item.sig, item),
            Item::Struct(item) => {
                let fields = item.fields.len();
                self.structs.push((item.ident.to_string(), fields));
            }
            Item::Trait(item) => _ = self.traits.insert(item.ident.to_string()),
            Item::Impl(item) if item.trait_.is_none() => {
                if let Type::Path(implemented) = &*item.self_ty {
                    self.implemented.push(segments(&implemented.path));
                }
            }
            _ => {}
        }
        visit::visit_item(self, item);
    }

    fn visit_impl_item(&mut self, item: &'a ImplItem) {
        if self.is_of_tests(item) {
            return;
        }
        if let ImplItem::Fn(item) = item {
            self.read_function(&item.sig, item);
        }
        visit::visit_impl_item(self, item);
    }

    fn visit_trait_item_fn(&mut self, item: &'a TraitItemFn) {
        self.read_function(&item.sig, item);
        visit::visit_trait_item_fn(self, item);
    }

    /// Not its name: a module may be called as what is handed on from it, and does not make use of it by that.
    fn visit_item_mod(&mut self, item: &'a ItemMod) {
        self.depth += 1;
        let items = item.content.iter().flat_map(|(_, items)| items);
        items.for_each(|item| self.visit_item(item));
        self.depth -= 1;
    }

    fn visit_item_use(&mut self, item: &'a ItemUse) {
        let is_public = !matches!(item.vis, Visibility::Inherited);
        for (name, path) in leaves(&item.tree, Vec::new()) {
            self.imports.push((name, self.of_file(path), is_public));
        }
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        self.paths.insert(self.of_file(segments(path)));
        visit::visit_path(self, path);
    }

    /// It may be that of a constant.
    fn visit_pat_ident(&mut self, pattern: &'a PatIdent) {
        self.paths.insert(vec![pattern.ident.to_string()]);
        visit::visit_pat_ident(self, pattern);
    }

    fn visit_macro(&mut self, each: &'a Macro) {
        self.read_tokens(&each.tokens);
        visit::visit_macro(self, each);
    }

    fn visit_meta_list(&mut self, list: &'a MetaList) {
        self.read_tokens(&list.tokens);
    }
}
