//! Files of a floor import each other in no circle, so that each can be read after those that it builds on.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use crate::{
    FLOORS,
    modules::{Graph, Modules},
};

/// For each import that is part of circles the shortest one, from its first file by name on; short ones first,
/// for long ones may be gone with them.
fn circles(graph: &Graph) -> Vec<Vec<&str>> {
    let mut circles = BTreeSet::new();
    for (file, below) in graph {
        for other in below.keys() {
            let Some(mut circle) = way(graph, other, file) else {
                continue;
            };
            let first = (0..circle.len()).min_by_key(|&place| circle[place]);
            circle.rotate_left(first.unwrap_or_default());
            circles.insert((circle.len(), circle));
        }
    }
    circles.into_iter().map(|(_, circle)| circle).collect()
}

/// The shortest way by imports from one file to another, with both.
fn way<'a>(graph: &'a Graph, from: &'a str, to: &'a str) -> Option<Vec<&'a str>> {
    let mut before = BTreeMap::from([(from, None)]);
    let mut reached = VecDeque::from([from]);
    while let Some(file) = reached.pop_front() {
        if file == to {
            let back = std::iter::successors(Some(file), |file| before[file]);
            let mut way: Vec<_> = back.collect();
            way.reverse();
            return Some(way);
        }
        for next in graph.get(file).into_iter().flat_map(BTreeMap::keys) {
            if !before.contains_key(next.as_str()) {
                before.insert(next, Some(file));
                reached.push_back(next);
            }
        }
    }
    None
}

/// `a.rs -> b.rs -> a.rs`, and what each imports from the next.
fn told(graph: &Graph, circle: &[&str]) -> String {
    let around = || circle.iter().chain(circle.first());
    let files: Vec<_> = around().copied().collect();
    let mut text = files.join(" -> ");
    for (file, next) in around().zip(around().skip(1)) {
        let names: Vec<_> = graph[*file][*next].iter().map(String::as_str).collect();
        text.push_str(&format!(
            "\n    {file} imports {} from {next}",
            names.join(", ")
        ));
    }
    text
}

fn all_told(graph: &Graph) -> Vec<String> {
    circles(graph)
        .iter()
        .map(|circle| told(graph, circle))
        .collect()
}

#[test]
fn files_import_each_other_in_no_circle() {
    // Circles from floor to floor are the floors' own test's, so that all floors may be looked at as one.
    let graph = Modules::read(FLOORS.concat()).dependencies();
    assert!(!graph.is_empty());
    let told = all_told(&graph);
    assert!(
        told.is_empty(),
        "{} circles\n{}",
        told.len(),
        told.join("\n")
    );
}

/// What each file of a made-up crate imports from which other: `a.rs: name of b.rs`.
fn imported<const N: usize>(files: [(&str, &str); N]) -> Vec<String> {
    let graph = Modules::of(files).dependencies();
    let edges = graph.iter().flat_map(|(file, below)| {
        let each = below
            .iter()
            .flat_map(|(other, names)| names.iter().map(move |name| (other, name)));
        each.map(move |(other, name)| format!("{file}: {name} of {other}"))
    });
    edges.collect()
}

#[test]
fn a_name_handed_on_is_of_the_file_that_defines_it() {
    let found = imported([
        (
            "floor/mod.rs",
            "mod a;\nmod deep;\npub use a::{A, Other as Renamed};\npub use deep::Deep;",
        ),
        ("floor/a.rs", "pub struct A;\npub struct Other;"),
        (
            "floor/deep/mod.rs",
            "mod inner;\npub use inner::Deep;\nuse inner::Private;",
        ),
        (
            "floor/deep/inner.rs",
            "pub struct Deep;\npub struct Private;",
        ),
        (
            "floor/deep/leaf.rs",
            "use super::Private;\nuse super::super::A;",
        ),
        (
            "floor/b.rs",
            "use bevy::math::Vec3;\nuse super::{Renamed, Deep as D};",
        ),
        (
            "other/mod.rs",
            "fn f() -> crate::floor::Deep { $crate::floor::a::$name() }",
        ),
    ]);
    let expected = [
        "floor/b.rs: Other of floor/a.rs",
        "floor/b.rs: Deep of floor/deep/inner.rs",
        "floor/deep/leaf.rs: A of floor/a.rs",
        "floor/deep/leaf.rs: Private of floor/deep/inner.rs",
        "other/mod.rs: $name of floor/a.rs",
        "other/mod.rs: Deep of floor/deep/inner.rs",
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_name_handed_on_and_used_is_imported() {
    let found = imported([
        (
            "floor/mod.rs",
            "pub use a::{A, Unused};\nuse a::Trait;\nuse b::*;\n// Unused\nstruct Own(A);",
        ),
        (
            "floor/a.rs",
            "use super::Own;\n#[cfg(test)]\nmod tests {\n    use super::super::b::B;\n}",
        ),
        (
            "floor/b.rs",
            "use super::{a, fabric};\nfn f() { a::g::<u8>(fabric) }",
        ),
        ("floor/fabric.rs", "pub fn fabric() {}"),
    ]);
    let expected = [
        "floor/a.rs: Own of floor/mod.rs",
        "floor/b.rs: g of floor/a.rs",
        "floor/mod.rs: A of floor/a.rs",
        "floor/mod.rs: Trait of floor/a.rs",
        "floor/mod.rs: * of floor/b.rs",
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_function_called_as_its_module_is_found() {
    let found = imported([
        ("floor/mod.rs", "mod fabric;\npub use fabric::fabric;"),
        ("floor/fabric.rs", "pub fn fabric() {}"),
        ("floor/a.rs", "use super::fabric;"),
    ]);
    assert_eq!(found, ["floor/a.rs: fabric of floor/fabric.rs"]);
}

#[test]
fn each_circle_is_told_once() {
    let graph = Modules::of([
        ("floor/a.rs", "use super::b::{B, more};"),
        ("floor/b.rs", "use super::c::C;"),
        ("floor/c.rs", "use super::{a::A, d::D};"),
        ("floor/d.rs", "use super::c::C;"),
        ("floor/e.rs", "use super::{a::A, floor::F};"),
    ])
    .dependencies();
    let expected = [
        "floor/c.rs -> floor/d.rs -> floor/c.rs\n    \
         floor/c.rs imports D from floor/d.rs\n    \
         floor/d.rs imports C from floor/c.rs",
        "floor/a.rs -> floor/b.rs -> floor/c.rs -> floor/a.rs\n    \
         floor/a.rs imports B, more from floor/b.rs\n    \
         floor/b.rs imports C from floor/c.rs\n    \
         floor/c.rs imports A from floor/a.rs",
    ];
    assert_eq!(all_told(&graph), expected);
}
