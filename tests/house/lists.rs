//! Exceptions of today. None may come in addition, and who ends one takes it from its list.

/// Each folder's children that import each other.
pub const CIRCLES: &[&str] = &[];

/// More than 80 lines.
pub const LONG_FUNCTIONS: &[&str] = &[];

/// More than 16 fields.
pub const WIDE_STRUCTS: &[&str] = &[
    "plugin/state/scratch.rs: ClothScratch",
    "plugin/state/stats.rs: ClothStats",
];

/// More than 400 lines, without tests.
pub const LONG_FILES: &[&str] = &[];
