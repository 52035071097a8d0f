//! A made-up house with each kind of fault: each is found, and nothing besides.

use std::panic::catch_unwind;

use crate::{
    circles, circles_of_children, climbing, held, imports::House, larger, loose, names, strayed,
    worldly,
};

/// A file a line. `fabric` is handed on by the module that declares it, and of use only to its test.
const CROOKED: &str = "\
lib.rs: mod cloth; pub mod prelude { pub use crate::cloth::A; }
cloth/mod.rs: mod a; mod fabric; pub use a::{A, Open, Other as Renamed}; pub use fabric::fabric; use a::Trait; \
    struct Own(A); #[cfg(all(test, unix))] mod tests { fn f() { super::fabric() } } // fabric
cloth/a.rs: use super::{Own, fabric}; fn g(_: Own) { fabric() } pub trait Trait {} pub trait Open {} \
    pub struct A; pub struct Other; impl A { #[cfg(test)] fn f() { crate::plugin::f(); } }
cloth/fabric.rs: pub fn fabric() { crate::solver::S; }
solver/mod.rs: mod deep; pub use deep::Deep; pub struct S(bevy::app::Start); #[derive(Resource)] pub enum E {}
solver/deep/mod.rs: mod inner; pub use inner::{Deep, DeepItem};
solver/deep/inner.rs: pub struct Deep; mod inline { use super::super::super::S; type T = S; }
solver/deep/beside.rs: impl super::Deep {} impl super::DeepItem<'_> {} impl Clone for super::Deep {}
solver/far.rs: use super::Deep as D; use crate::cloth::a::{self}; fn f(_: a::Other) {} impl D {}
hierarchy/mod.rs: use crate::prelude::A; fn f() { crate::solver::Deep }
contact/mod.rs: macro_rules! m { ($name:ident) => { $crate::plugin::A::$name($crate::cloth::a::$name) } } \
    pub(crate) use m; pub const M: u8 = 0;
plugin/mod.rs: pub use crate::cloth::{A, Renamed}; use bevy::{self, prelude::*}; use crate::contact::{M, m}; \
    struct P(Renamed); m!(); fn g(x: u8) { if let M = x {} }";

fn crooked() -> House {
    House::of(CROOKED.lines().filter_map(|line| line.split_once(": ")))
}

#[test]
fn imports_are_of_the_files_that_define_them() {
    let imports = crooked().imports();
    let told = imports.iter();
    let told = told.map(|((from, to), names)| format!("{from} -> {to}: {names:?}"));
    let expected = [
        r#"cloth/a.rs -> cloth/fabric.rs: {"fabric"}"#,
        r#"cloth/a.rs -> cloth/mod.rs: {"Own"}"#,
        r#"cloth/fabric.rs -> solver/mod.rs: {"S"}"#,
        r#"cloth/mod.rs -> cloth/a.rs: {"A", "Trait"}"#,
        r#"contact/mod.rs -> cloth/a.rs: {"$name", "A"}"#,
        r#"hierarchy/mod.rs -> solver/deep/inner.rs: {"Deep"}"#,
        r#"plugin/mod.rs -> cloth/a.rs: {"Other"}"#,
        r#"plugin/mod.rs -> contact/mod.rs: {"M", "m"}"#,
        r#"solver/deep/beside.rs -> solver/deep/inner.rs: {"Deep", "DeepItem"}"#,
        r#"solver/deep/inner.rs -> solver/mod.rs: {"S"}"#,
        r#"solver/far.rs -> cloth/a.rs: {"Other"}"#,
        r#"solver/far.rs -> solver/deep/inner.rs: {"Deep"}"#,
    ];
    assert_eq!(told.collect::<Vec<_>>(), expected);
}

#[test]
fn circles_are_found() {
    let imports = crooked().imports();
    assert_eq!(
        names(&circles(&imports, Some)),
        ["cloth/a.rs, cloth/mod.rs"]
    );
    let found = circles_of_children(&imports);
    assert_eq!(names(&found), [": cloth, solver", "cloth/: a.rs, mod.rs"]);
}

#[test]
fn each_kind_of_fault_is_found() {
    let house = crooked();
    let expected = [
        "cloth/fabric.rs: crate::solver::S",
        "contact/mod.rs: $crate::plugin::A::$name",
        "hierarchy/mod.rs: crate::prelude::A",
        "hierarchy/mod.rs: crate::solver::Deep",
    ];
    assert_eq!(names(&climbing(&house)), expected);
    let expected = [
        "solver/deep/inner.rs: super::super::S",
        "solver/mod.rs: Resource",
        "solver/mod.rs: bevy::app::Start",
    ];
    assert_eq!(names(&worldly(&house)), expected);
    let expected = [
        "solver/deep/beside.rs: DeepItem of solver/deep/inner.rs",
        "solver/far.rs: Deep of solver/deep/inner.rs",
    ];
    assert_eq!(names(&strayed(&house)), expected);
    let found = loose("a = \"1.0\"\nb = { version = \"=2-rc\" }\nc = { version = \"3-rc\" }");
    assert_eq!(names(&found), ["c = { version = \"3-rc\" }"]);
}

#[test]
fn large_things_are_found_without_their_tests() {
    let text = "/// A.\nstruct A(u8, u8);\nfn short() {}\nfn long() {\n}\n\
        trait B {\n    fn own() {\n    }\n}\nimpl B for A {\n    fn given() {\n    }\n}\n";
    let tests = "#[cfg(test)]\nmod tests {\n    fn long() {\n    }\n}\n";
    let house = House::of([
        ("a.rs", text.to_owned() + tests),
        ("b.rs", tests.to_owned()),
    ]);
    let is_over = |most| !larger(&house, most, |module| &module.lines).is_empty();
    assert!(is_over(12) && !is_over(13));
    let found = larger(&house, 1, |module| &module.functions);
    assert_eq!(names(&found), ["a.rs: given", "a.rs: long", "a.rs: own"]);
    let found = larger(&house, 1, |module| &module.structs);
    assert_eq!(names(&found), ["a.rs: A"]);
}

#[test]
fn new_faults_fail_and_so_do_exceptions_that_are_gone() {
    let is_held = |exceptions: &[&str], found: &[&str]| {
        let found = found.iter().map(|&fault| fault.to_owned()).collect();
        catch_unwind(|| held(exceptions, &found)).is_ok()
    };
    assert!(is_held(&["a"], &["a\nmore"]));
    assert!(!is_held(&["a"], &["a", "b"]));
    assert!(!is_held(&["a", "b"], &["a"]));
}
