//! Exceptions of today. None may come in addition, and who ends one takes it from its list.

/// Each folder's children that import each other.
pub const CIRCLES: &[&str] = &[];

/// More than 80 lines.
pub const LONG_FUNCTIONS: &[&str] = &[
    "cloth/surface/bound.rs: write_eights",
    "contact/colliders/geometry/parts.rs: add",
    "contact/detection/mod.rs: push_out",
    "contact/particles/lanes.rs: push",
    "contact/triangles/friction.rs: hold",
    "contact/triangles/lanes.rs: nearest_of_each",
    "contact/triangles/lanes.rs: pushes",
    "plugin/draw/mesh/mod.rs: update",
    "plugin/prepare/colliders/motion/mod.rs: follow",
    "plugin/simulation.rs: build",
    "plugin/step/island.rs: advance",
    "plugin/step/island.rs: integrate_together",
    "solver/bending/patch.rs: new",
    "solver/substep/started.rs: substep",
];

/// More than 16 fields.
pub const WIDE_STRUCTS: &[&str] = &[
    "cloth/surface/mod.rs: Surface",
    "contact/detection/mod.rs: Detection",
    "plugin/prepare/preparing.rs: PrepareQuery",
    "plugin/state/memory.rs: ClothState",
    "plugin/state/scratch.rs: ClothScratch",
    "plugin/state/stats.rs: ClothStats",
];

/// More than 400 lines, without tests.
pub const LONG_FILES: &[&str] = &[
    "cloth/particles/upkeep.rs: all",
    "contact/detection/embedded.rs: all",
    "contact/detection/mod.rs: all",
    "contact/layers/mod.rs: all",
    "contact/particles/lanes.rs: all",
    "plugin/step/tick.rs: all",
];
