//! Holds the house's order: files import from floors below their own only, and in no circle. Floors below the plugin's
//! hold no systems, queries, resources or app. Functions, structs and files stay small enough to be read at once.

use std::collections::BTreeSet;

use imports::{HOUSE, House, circles, circles_of_children, parent};
use lists::{CIRCLES, LONG_FILES, LONG_FUNCTIONS, WIDE_STRUCTS};
use source::Module;

#[path = "house/faults.rs"]
mod faults;
#[path = "house/imports.rs"]
mod imports;
#[path = "house/lists.rs"]
mod lists;
#[path = "house/source.rs"]
mod source;

/// Each floor's modules, from the ground up. Modules of one floor may not import each other.
const FLOORS: [&[&str]; 4] = [
    &["cloth"],
    &["solver", "hierarchy"],
    &["contact"],
    &["plugin"],
];

/// Names that no floor below the plugin's may use.
const ECS: &str = "App Commands DeferredWorld EntityCommands EntityMut EntityRef EntityWorldMut FromWorld \
    MessageReader MessageWriter Query QueryState Res ResMut Resource Single SubApp SystemParam World";

/// Faults. The first line of each says which, others tell more.
type Found = BTreeSet<String>;

fn names(found: &Found) -> Vec<&str> {
    let first_lines = found.iter().map(|fault| fault.lines().next());
    first_lines.map(Option::unwrap_or_default).collect()
}

/// Fails for what is not among the exceptions, and for exceptions that are none any more.
fn held(exceptions: &[&str], found: &Found) {
    let names = names(found);
    let named = found.iter().zip(&names);
    let new = named.filter(|(_, name)| !exceptions.contains(name));
    let new: Vec<_> = new.map(|(fault, _)| fault.as_str()).collect();
    assert!(new.is_empty(), "\n{}", new.join("\n"));
    let gone: Vec<_> = exceptions
        .iter()
        .filter(|each| !names.contains(each))
        .collect();
    assert!(gone.is_empty(), "remove from the list: {gone:?}");
}

/// The floor of a module.
fn floor(module: &str) -> Option<usize> {
    FLOORS
        .iter()
        .position(|modules| modules.contains(&top(module)))
}

fn top(module: &str) -> &str {
    module.split("::").next().unwrap_or_default()
}

/// Imports from where they are not allowed.
fn climbing(house: &House) -> Found {
    let mut climbing = Found::new();
    for (at, module) in house.0.iter().filter(|(at, _)| floor(at).is_some()) {
        for path in module.all_paths() {
            // A name that another floor hands on is an import from that floor, too.
            let named = path.get(1).filter(|_| path[0].ends_with("crate"));
            let defined = house.definition(at, path).map(|(home, ..)| top(home));
            let others = named.map(String::as_str).into_iter().chain(defined);
            let is_above = |other| floor(other).is_none() || floor(other) >= floor(at);
            if others.filter(|other| *other != top(at)).any(is_above) {
                climbing.insert(format!("{}: {}", module.file, path.join("::")));
            }
        }
    }
    climbing
}

/// Names of Bevy's world in lower floors.
fn worldly(house: &House) -> Found {
    let mut worldly = Found::new();
    for (at, module) in &house.0 {
        // Only a cloth that is spawned can say that no plugin is there.
        if floor(at).is_none_or(|floor| floor == 3) || at == "cloth::presence" {
            continue;
        }
        for path in module.all_paths() {
            let is_ecs = |name: &String| ECS.split(' ').any(|each| each == name);
            let text = path.join("::");
            let is_app = text.starts_with("bevy::app");
            if is_app || path.iter().any(is_ecs) || text.contains("super::super") {
                worldly.insert(format!("{}: {text}", module.file));
            }
        }
    }
    worldly
}

/// Names of the search for tears in the code of sub-steps. A cloth tears as a tick ends, so one that may not tear pays nothing.
fn tearing(house: &House) -> Found {
    let mut tearing = Found::new();
    for (at, module) in &house.0 {
        let is_substep = ["solver", "contact", "plugin::step"]
            .iter()
            .any(|of| at == of || at.starts_with(&format!("{of}::")));
        let named = module.all_paths().flatten();
        let is_of_tears = |name: &&String| name.starts_with("ClothTear") || *name == "TearSearch";
        for name in named.filter(|name| is_substep && is_of_tears(name)) {
            tearing.insert(format!("{}: {name}", module.file));
        }
    }
    tearing
}

/// Blocks of inherent methods where nobody would look for them. They may be in a type's own module, in children of
/// it, or if it has none in its folder; but a floor's whole folder is too large for that.
fn strayed(house: &House) -> Found {
    let mut strayed = Found::new();
    for (at, module) in &house.0 {
        let types = module.implemented.iter();
        for (home, other, name) in types.filter_map(|path| house.definition(at, path)) {
            let is_within = |at: &str, folder: &str| at.starts_with(&format!("{folder}::"));
            let has_children = house.0.keys().any(|at| is_within(at, home));
            let is_family = has_children || parent(parent(home)).is_empty();
            let family = if is_family { home } else { parent(home) };
            // `QueryData` generates a query's item beside the query's struct.
            let mut structs = other.structs.iter();
            let is_generated = name.ends_with("Item") && structs.all(|(own, _)| *own != name);
            if at != home && (is_generated || !is_within(at, family)) {
                strayed.insert(format!("{}: {name} of {}", module.file, other.file));
            }
        }
    }
    strayed
}

/// The parts of the files that are larger than `most`.
fn larger(house: &House, most: usize, sizes: fn(&Module) -> &[(String, usize)]) -> Found {
    let mut larger = Found::new();
    for module in house.0.values() {
        for (name, size) in sizes(module).iter().filter(|(_, size)| *size > most) {
            larger.insert(format!(
                "{}: {name}\n    {size} is over {most}",
                module.file
            ));
        }
    }
    larger
}

/// Lines that ask for a pre-release, and for those after it. Cargo takes 1.0.0 for newer than 1.0.0-beta, and gives it
/// to games that have no lock file yet.
fn loose(manifest: &str) -> Found {
    let is_loose = |version: &str| version.contains('-') && !version.starts_with('=');
    let lines = manifest.lines().filter(|line| {
        let mut asked = line.split("version = \"").skip(1);
        asked.any(|rest| rest.split('"').next().is_some_and(is_loose))
    });
    lines.map(str::to_owned).collect()
}

#[test]
fn floors_import_downwards_only() {
    held(&[], &climbing(&HOUSE));
}

#[test]
fn lower_floors_hold_no_ecs() {
    held(&[], &worldly(&HOUSE));
}

#[test]
fn every_folder_is_on_a_floor() {
    let files = HOUSE.0.values().map(|module| module.file.split_once('/'));
    let folders: BTreeSet<_> = files.flatten().map(|(folder, _)| folder).collect();
    assert_eq!(folders, FLOORS.concat().into_iter().collect());
}

#[test]
fn files_import_each_other_in_no_circle() {
    held(&[], &circles(&HOUSE.imports(), Some));
}

#[test]
fn children_of_a_folder_import_each_other_in_no_circle() {
    held(CIRCLES, &circles_of_children(&HOUSE.imports()));
}

#[test]
fn no_substep_searches_for_tears() {
    held(&[], &tearing(&HOUSE));
}

#[test]
fn methods_are_beside_their_types() {
    held(&[], &strayed(&HOUSE));
}

#[test]
fn no_function_is_too_long() {
    let found = larger(&HOUSE, 80, |module| &module.functions);
    held(LONG_FUNCTIONS, &found);
}

#[test]
fn no_struct_is_too_wide() {
    let found = larger(&HOUSE, 16, |module| &module.structs);
    held(WIDE_STRUCTS, &found);
}

#[test]
fn no_file_is_too_long() {
    held(LONG_FILES, &larger(&HOUSE, 400, |module| &module.lines));
}

/// Cargo finds no test and no example by itself here: one that is not listed would never be built.
#[test]
fn each_test_program_and_example_is_listed() {
    let root = std::env::var("CARGO_MANIFEST_DIR").expect("cargo says where the crate is");
    let tests = ("test", "tests", include_str!("../Cargo.toml"));
    let examples = (
        "example",
        "examples",
        include_str!("../examples/Cargo.toml"),
    );
    for (kind, folder, manifest) in [tests, examples] {
        for entry in std::fs::read_dir(format!("{root}/{folder}")).expect("a folder") {
            let path = entry.expect("a file").path();
            let has = |file: &str| path.join(file).exists();
            let is_file = path.extension().is_some_and(|extension| extension == "rs");
            if is_file || has("main.rs") && !has("Cargo.toml") {
                let name = path.file_stem().and_then(|name| name.to_str());
                let name = name.expect("a name");
                let listed = format!("[[{kind}]]\nname = \"{name}\"\n");
                assert!(manifest.contains(&listed), "{name}");
            }
        }
    }
}

#[test]
fn pre_releases_are_asked_for_exactly() {
    held(&[], &loose(include_str!("../Cargo.toml")));
    held(&[], &loose(include_str!("../lab/Cargo.toml")));
    held(&[], &loose(include_str!("../examples/Cargo.toml")));
    held(&[], &loose(include_str!("headless/Cargo.toml")));
}
