//! Finds the file that defines what another one imports.

use std::{
    collections::{BTreeMap, BTreeSet},
    iter::successors,
};

use crate::{
    imports::{Import, holds_word, implemented, paths, without_imports},
    source::{code, code_of, is_of_tests, source_folder, sources},
};

/// Imports followed from one to the next, at most: text that is being edited may lead in a ring.
const MOST_STEPS: usize = 16;

/// For each file the files that it imports from, and the names it imports from each.
pub type Graph = BTreeMap<String, BTreeMap<String, BTreeSet<String>>>;

/// The crate's modules by their paths, such as `cloth::particles`. The crate itself has none and its path is
/// empty: it imports from all floors, and nothing imports from it.
pub struct Modules(BTreeMap<String, Module>);

struct Module {
    file: String,
    imports: Vec<Import>,
    /// Without imports.
    code: String,
}

/// A module, and what a path names within it: nothing where the path is that of the module.
struct Place {
    module: String,
    rest: Vec<String>,
}

impl Modules {
    /// Those of the source folder's `folders`, without tests.
    pub fn read(folders: impl IntoIterator<Item = &'static str>) -> Self {
        let root = source_folder();
        let files = folders
            .into_iter()
            .flat_map(|folder| sources(&root.join(folder)));
        let modules = files.filter_map(|path| {
            let file = path.strip_prefix(&root).expect("a file of the folder");
            let named = (!is_of_tests(file)).then(|| file.to_string_lossy().replace('\\', "/"));
            named.map(|name| module(&name, &code(&path)))
        });
        Self(modules.collect())
    }

    /// Those of made-up files, by name and text.
    pub fn of<const N: usize>(files: [(&str, &str); N]) -> Self {
        let modules = files.map(|(file, text)| module(file, &code_of(text)));
        Self(modules.into_iter().collect())
    }

    pub fn dependencies(&self) -> Graph {
        let handed_on = self.handed_on();
        let mut graph = Graph::new();
        for (at, module) in &self.0 {
            let needed = module.imports.iter().filter(|import| {
                let is_for_others =
                    import.is_public || handed_on.contains(&(at.clone(), import.name.clone()));
                !is_for_others || holds_word(&module.code, &import.name)
            });
            let needed = needed.map(|import| import.path.clone());
            for path in needed.chain(paths(&module.code)) {
                let Some((home, name)) = self.definition(at, &path) else {
                    continue;
                };
                if home != *at {
                    let below = graph.entry(module.file.clone()).or_default();
                    let names = below.entry(self.file(&home)).or_default();
                    names.insert(name);
                }
            }
        }
        graph
    }

    /// The names that modules import and that others take from there. Without `pub` that is open to their children;
    /// nothing says then that the module itself has a use for the name.
    fn handed_on(&self) -> BTreeSet<(String, String)> {
        let mut handed_on = BTreeSet::new();
        for (at, module) in &self.0 {
            let imported = module.imports.iter().map(|import| import.path.clone());
            for path in imported.chain(paths(&module.code)) {
                let mut steps = self.steps(at, &path);
                steps.pop();
                let elsewhere = steps.into_iter().filter(|step| step.module != *at);
                let named =
                    elsewhere.filter_map(|step| Some((step.module, step.rest.into_iter().next()?)));
                handed_on.extend(named);
            }
        }
        handed_on
    }

    /// The module that defines what a path in module `at` names, and its name there. None for a module.
    ///
    /// What is from another crate counts as the module's own that names it.
    fn definition(&self, at: &str, path: &[String]) -> Option<(String, String)> {
        let last = self.steps(at, path).pop()?;
        let name = last.rest.into_iter().next()?;
        self.0
            .contains_key(&last.module)
            .then_some((last.module, name))
    }

    /// The places that a path leads to, from import to import. The last is where the name is defined.
    fn steps(&self, at: &str, path: &[String]) -> Vec<Place> {
        let next = |place: &Place| {
            let (name, below) = place.rest.split_first()?;
            let import = self.import(&place.module, name)?;
            Some(self.place(&place.module, &[&import.path, below].concat()))
        };
        successors(Some(self.place(at, path)), next)
            .take(MOST_STEPS)
            .collect()
    }

    /// Follows a path as far as its segments are modules.
    fn place(&self, at: &str, path: &[String]) -> Place {
        let mut module = at.to_owned();
        for (index, segment) in path.iter().enumerate() {
            module = match segment.as_str() {
                "crate" | "$crate" => String::new(),
                "self" => module,
                "super" => parent(&module).to_owned(),
                name => {
                    let child = child(&module, name);
                    // A function may be called as its module is, and be imported where the module is declared.
                    let is_import = path.len() == index + 1 && self.import(&module, name).is_some();
                    if is_import || !self.0.contains_key(&child) {
                        let rest = path[index..].to_vec();
                        return Place { module, rest };
                    }
                    child
                }
            };
        }
        Place {
            module,
            rest: Vec::new(),
        }
    }

    fn import(&self, module: &str, name: &str) -> Option<&Import> {
        let mut imports = self.0.get(module)?.imports.iter();
        imports.find(|import| import.name == name && !["*", "_"].contains(&name))
    }

    fn file(&self, module: &str) -> String {
        self.0
            .get(module)
            .map(|module| module.file.clone())
            .unwrap_or_default()
    }

    /// Blocks of inherent methods where nobody would look for them, one a line.
    pub fn strayed_implementations(&self) -> Vec<String> {
        let mut strayed = Vec::new();
        for (at, module) in &self.0 {
            for path in implemented(&module.code) {
                let Some((home, name)) = self.definition(at, &path) else {
                    continue;
                };
                if !self.may_implement(at, &home, &name) {
                    let (file, home) = (&module.file, self.file(&home));
                    strayed.push(format!("{file} implements {name} of {home}"));
                }
            }
        }
        strayed
    }

    fn may_implement(&self, at: &str, home: &str, name: &str) -> bool {
        at == home || !self.is_generated(home, name) && is_within(at, self.family(home))
    }

    /// Whether a type is the item of a query, which `QueryData` generates beside the query's struct.
    fn is_generated(&self, home: &str, name: &str) -> bool {
        let is_declared = |module: &Module| module.code.contains(&format!("struct {name}"));
        name.ends_with("Item") && !self.0.get(home).is_some_and(is_declared)
    }

    /// The module whose children may implement what module `home` defines: itself, or its folder's if it has no
    /// children. A floor's whole module is too large for that.
    fn family<'a>(&self, home: &'a str) -> &'a str {
        let has_children = self.0.keys().any(|module| is_within(module, home));
        let folder = parent(home);
        if has_children || parent(folder).is_empty() {
            home
        } else {
            folder
        }
    }
}

/// A file's module and its path.
fn module(file: &str, code: &str) -> (String, Module) {
    let path = file.trim_end_matches(".rs").trim_end_matches("/mod");
    let (imports, code) = without_imports(code);
    let module = Module {
        file: file.to_owned(),
        imports,
        code,
    };
    (path.replace('/', "::"), module)
}

fn parent(module: &str) -> &str {
    module.rsplit_once("::").map_or("", |(parent, _)| parent)
}

fn child(module: &str, name: &str) -> String {
    match module {
        "" => name.to_owned(),
        module => format!("{module}::{name}"),
    }
}

fn is_within(module: &str, folder: &str) -> bool {
    module
        .strip_prefix(folder)
        .is_some_and(|below| below.starts_with("::"))
}
