//! Exceptions of today. None may come in addition, and who ends one takes it from its list.

/// Each folder's children that import each other.
pub const CIRCLES: &[&str] = &[
    "cloth/: error.rs, grid.rs, material.rs, particles, pins, springs, surface",
    "contact/: detection, detection.rs",
    "hierarchy/: refit.rs, stored.rs, tree",
    "plugin/: air.rs, built.rs, fault.rs, mesh, scratch.rs, shared.rs, skin, source, state.rs, wind",
    "solver/: air, bending, forces, kernel.rs, predict.rs, sweep.rs, tether.rs, threads",
];

/// More than 80 lines.
pub const LONG_FUNCTIONS: &[&str] = &[
    "cloth/surface/bound.rs: write_eights",
    "contact/detection.rs: push_out",
    "contact/eight.rs: nearest",
    "contact/eight.rs: pushes",
    "contact/friction.rs: hold",
    "contact/geometry/parts.rs: add",
    "contact/lanes.rs: push",
    "plugin/colliders.rs: follow",
    "plugin/mesh/mod.rs: update",
    "plugin/simulation.rs: build",
    "plugin/together.rs: advance",
    "plugin/together.rs: integrate_together",
    "solver/bending/patch.rs: new",
    "solver/substep/started.rs: substep",
];

/// More than 16 fields.
pub const WIDE_STRUCTS: &[&str] = &[
    "cloth/surface/mod.rs: Surface",
    "contact/detection.rs: Detection",
    "plugin/mesh/component.rs: ClothMesh",
    "plugin/prepare/preparing.rs: Preparing",
    "plugin/scratch.rs: ClothScratch",
    "plugin/state.rs: ClothState",
    "plugin/stats.rs: ClothStats",
];

/// More than 400 lines, without tests.
pub const LONG_FILES: &[&str] = &[
    "cloth/particles/upkeep.rs: all",
    "contact/detection.rs: all",
    "contact/embedded.rs: all",
    "contact/lanes.rs: all",
    "contact/mutual/mod.rs: all",
    "plugin/tick.rs: all",
];
