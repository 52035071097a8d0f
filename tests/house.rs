//! Holds the house's order: a file imports from floors below its own only, and the floors below the plugin's
//! hold no systems, queries, resources or app. Within a floor, files import each other in no circle.

use std::fs;

use source::{code, is_of_tests, source_folder, sources};

#[path = "house/circles.rs"]
mod circles;
#[path = "house/implementations.rs"]
mod implementations;
#[path = "house/imports.rs"]
mod imports;
#[path = "house/modules.rs"]
mod modules;
#[path = "house/source.rs"]
mod source;

/// Each floor's modules, from the ground up. Modules of one floor may not import each other.
const FLOORS: [&[&str]; 4] = [
    &["cloth"],
    &["solver", "hierarchy"],
    &["contact"],
    &["plugin"],
];

/// Modules of this crate that a text names, as `crate::name` or in `crate::{name, …}`.
fn modules_named(code: &str) -> Vec<String> {
    let name = |text: &str| -> String {
        text.trim_start()
            .chars()
            .take_while(|each| each.is_alphanumeric() || *each == '_')
            .collect()
    };
    let mut names = Vec::new();
    for after in code.split("crate::").skip(1) {
        let Some(group) = after.strip_prefix('{') else {
            names.push(name(after));
            continue;
        };
        let mut depth = 0;
        names.push(name(group));
        for (place, each) in group.char_indices() {
            match each {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => names.push(name(&group[place + 1..])),
                _ => {}
            }
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

#[test]
fn floors_import_downwards_only() {
    for (floor, modules) in FLOORS.iter().enumerate() {
        for module in *modules {
            let files = sources(&source_folder().join(module));
            assert!(!files.is_empty(), "{module}");
            for file in files.iter().filter(|file| !is_of_tests(file)) {
                for name in modules_named(&code(file)) {
                    let allowed = name == *module
                        || FLOORS[..floor]
                            .iter()
                            .any(|below| below.contains(&name.as_str()));
                    assert!(
                        allowed,
                        "{} of floor {floor} imports {name}",
                        file.display()
                    );
                }
            }
        }
    }
}

#[test]
fn lower_floors_hold_no_ecs() {
    for module in FLOORS[..3].iter().copied().flatten() {
        for file in sources(&source_folder().join(module)) {
            // Only a cloth that is spawned can say that no plugin is there.
            if file.ends_with("cloth/presence.rs") {
                continue;
            }
            // The error of a mesh that only its renderer has left is no world.
            let code = code(&file).replace("ExtractedToRenderWorld", "");
            for word in [
                "Query<",
                "Single<",
                "MessageReader",
                "MessageWriter",
                "super::super",
                "Res<",
                "ResMut<",
                "Commands",
                "Resource",
                "App",
                "bevy::app",
                "World",
            ] {
                assert!(!code.contains(word), "{} holds {word}", file.display());
            }
        }
    }
}

#[test]
fn every_folder_is_on_a_floor() {
    let entries = fs::read_dir(source_folder())
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path());
    // A folder of texts is none of the house.
    for path in entries.filter(|path| path.is_dir() && !sources(path).is_empty()) {
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        assert!(
            FLOORS
                .iter()
                .any(|modules| modules.contains(&name.as_str())),
            "{name} is on no floor"
        );
    }
}

#[test]
fn grouped_and_single_imports_are_read() {
    let names = modules_named(
        "use crate::cloth::Pin;\nuse crate::{\n  solver::{A, B},\n  plugin,\n};\nfn f() { crate::contact::g() }",
    );
    assert_eq!(names, ["cloth", "solver", "plugin", "contact"]);
}

/// Cargo takes 1.0.0 for newer than 1.0.0-beta, and gives it to games that have no lock file yet.
#[test]
fn pre_releases_are_asked_for_exactly() {
    let manifests = [
        include_str!("../Cargo.toml"),
        include_str!("../lab/Cargo.toml"),
    ];
    for line in manifests.into_iter().flat_map(str::lines) {
        let asked = line.split("version = \"").skip(1);
        for version in asked.filter_map(|rest| rest.split('"').next()) {
            let is_pre_release = version.contains('-');
            assert!(!is_pre_release || version.starts_with('='), "{line}");
        }
    }
}
