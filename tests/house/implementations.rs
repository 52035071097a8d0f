//! A type's inherent methods are beside it, so that who imports the type depends on no file unseen.

use crate::{FLOORS, modules::Modules};

#[test]
fn methods_are_beside_their_types() {
    let strayed = Modules::read(FLOORS.concat()).strayed_implementations();
    assert!(strayed.is_empty(), "\n{}", strayed.join("\n"));
}

#[test]
fn strayed_methods_are_found() {
    let modules = Modules::of([
        ("floor/mod.rs", "pub use part::Part;"),
        (
            "floor/a.rs",
            "struct A;\nstruct MenuItem;\nimpl A {\n}\nimpl AskedItem<'_> {\n}",
        ),
        (
            "floor/a/b.rs",
            "use super::{A, AskedItem, MenuItem};\nimpl A {\n}\nimpl AskedItem<'_> {\n}\nimpl MenuItem {\n}",
        ),
        ("floor/part/mod.rs", "pub use c::Part;"),
        ("floor/part/c.rs", "pub struct Part;"),
        (
            "floor/part/d.rs",
            "use super::Part;\nimpl Part {\n}\nimpl Default for Part {\n}",
        ),
        (
            "floor/e.rs",
            "use super::Part;\nimpl Part {\n}\nimpl super::a::A {\n}",
        ),
    ]);
    let expected = [
        "floor/a/b.rs implements AskedItem of floor/a.rs",
        "floor/e.rs implements Part of floor/part/c.rs",
        "floor/e.rs implements A of floor/a.rs",
    ];
    assert_eq!(modules.strayed_implementations(), expected);
}
