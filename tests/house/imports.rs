//! Finds the file that defines what another one imports, and circles of such imports.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::PathBuf,
    sync::LazyLock,
};

use crate::{
    Found,
    source::{Module, Segments, files},
};

/// The names that one file imports from another, by both.
pub type Imports = BTreeMap<(String, String), BTreeSet<String>>;

/// Modules by their paths in the crate, such as `cloth::particles`; the crate's own is that of `lib`.
pub struct House(pub BTreeMap<String, Module>);

/// That of the source folder, read once for all tests.
pub static HOUSE: LazyLock<House> = LazyLock::new(|| {
    // Asked as the test runs: checkouts that share a target folder may share the compiled test.
    let folder = std::env::var_os("CARGO_MANIFEST_DIR").expect("cargo says where the crate is");
    let root = PathBuf::from(folder).join("src");
    let text = |file: &String| fs::read_to_string(root.join(file)).expect("a source file");
    House::of(files(&root).iter().map(|file| (file.as_str(), text(file))))
});

impl House {
    pub fn of<'a>(files: impl IntoIterator<Item = (&'a str, impl AsRef<str>)>) -> Self {
        let modules = files.into_iter().map(|(file, text)| {
            let path = file.trim_end_matches(".rs").trim_end_matches("/mod");
            let path = if path == "lib" { "" } else { path };
            (path.replace('/', "::"), Module::of(file, text.as_ref()))
        });
        Self(modules.collect())
    }

    pub fn imports(&self) -> Imports {
        let mut imports = Imports::new();
        for (at, module) in &self.0 {
            // The code uses an import if it names it; else it hands it on. Traits need no name.
            let is_used = |(name, path, is_public): &&(String, Segments, bool)| {
                let found = self.definition(at, path).filter(|_| !is_public);
                name == "*" || found.is_some_and(|(_, home, name)| home.traits.contains(&name))
            };
            let used = module.imports.iter().filter(is_used);
            let paths = used.map(|(_, path, _)| path).chain(&module.paths);
            for (home, other, name) in paths.filter_map(|path| self.definition(at, path)) {
                if home != at {
                    let files = (module.file.clone(), other.file.clone());
                    imports.entry(files).or_default().insert(name);
                }
            }
        }
        imports
    }

    /// The module that defines what a path in module `at` names, and its name there. None for a module.
    ///
    /// A name from another crate counts as that of the module that asks for it.
    pub fn definition(&self, at: &str, path: &[String]) -> Option<(&str, &Module, String)> {
        let (name, rest) = path.split_first()?;
        let (at, module) = match name.as_str() {
            "crate" | "$crate" => return self.definition("", rest),
            "self" => return self.definition(at, rest),
            "super" => return self.definition(parent(at), rest),
            _ => self.0.get_key_value(at)?,
        };
        let mut imports = module.imports.iter();
        let import = imports.find(|import| import.0 == *name && name != "*");
        let child = format!("{at}::{name}");
        let child = child.trim_start_matches(':');
        match (import, self.0.contains_key(child)) {
            // A function may be called as its module is.
            (Some((_, path, _)), true) if rest.is_empty() => self.definition(at, path),
            (_, true) => self.definition(child, rest),
            // `use png::png` is from another crate, and `use each` hands on a macro of this file.
            (Some((_, path, _)), _) if path[0] != *name => {
                self.definition(at, &[path, rest].concat())
            }
            _ => Some((at, module, name.clone())),
        }
    }
}

pub fn parent(module: &str) -> &str {
    module.rsplit_once("::").map_or("", |(parent, _)| parent)
}

/// Sets of nodes that import each other, and what ties them. Files without a node do not count.
pub fn circles<'a>(imports: &'a Imports, node: impl Fn(&'a str) -> Option<&'a str>) -> Found {
    let nodes = |(from, to): &'a (String, String)| {
        let nodes = (node(from)?, node(to)?);
        (nodes.0 != nodes.1).then_some(nodes)
    };
    let mut below = BTreeMap::<_, BTreeSet<_>>::new();
    for (from, to) in imports.keys().filter_map(nodes) {
        below.entry(from).or_default().insert(to);
    }
    let reached = |from| {
        let (mut reached, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(node) = open.pop() {
            let next = below.get(node).into_iter().flatten().copied();
            open.extend(next.filter(|&next| reached.insert(next)));
        }
        reached
    };
    let reached: BTreeMap<_, _> = below.keys().map(|&from| (from, reached(from))).collect();
    let mut circles = Found::new();
    for (node, all) in &reached {
        let is_back = |other: &&str| reached.get(other).is_some_and(|all| all.contains(node));
        let circle: Vec<_> = all.iter().copied().filter(is_back).collect();
        let mut told = circle.join(", ");
        for (files, names) in imports {
            let is_tie = |(from, to)| circle.contains(&from) && circle.contains(&to);
            if nodes(files).is_some_and(is_tie) {
                told.push_str(&format!("\n    {} -> {}: {names:?}", files.0, files.1));
            }
        }
        circles.extend((!circle.is_empty()).then_some(told));
    }
    circles
}

/// Circles of each folder's children: files, and folders with all that is in them.
pub fn circles_of_children(imports: &Imports) -> Found {
    let files = imports.keys().map(|(from, _)| from.as_str());
    let folders = files.flat_map(|file| file.match_indices('/').map(|(end, _)| &file[..=end]));
    let folders: BTreeSet<_> = folders.chain([""]).collect();
    let circles = folders.iter().flat_map(|folder| {
        let child = |file| str::strip_prefix(file, folder)?.split('/').next();
        let circles = circles(imports, child).into_iter();
        circles.map(move |circle| format!("{folder}: {circle}"))
    });
    circles.collect()
}
