//! The guide: from a first cloth to what to do when one fails. Each chapter can be read alone, and its programs are run as tests.
//!
//! 1. [Your first cloth](first_cloth): a sheet, a ball, a material, and where its particles are.
//! 2. [Your own model](own_model): any triangle mesh, from Blender to Bevy.
//! 3. [Characters](characters): capes, skirts and coats on a skeleton, level of detail.
//! 4. [Wind](wind): the air of the world, of a place, and of one cloth; pressure.
//! 5. [Tuning](tuning): what stretches, what swings, what costs.
//! 6. [When it fails](when_it_fails): faults, limits, and what to do about each.
//! 7. [Saving](saving): snapshots, rollback, worlds whose origin jumps.
//! 8. [Recipes](recipes): picking cloth with the mouse, gathering a pinned row, opening a curtain.
//! 9. [Migrating from `bevy_silk`](migrating_from_bevy_silk): its names, and ours.

#[doc = include_str!("guide/first_cloth.md")]
pub mod first_cloth {}

#[doc = include_str!("guide/own_model.md")]
pub mod own_model {}

#[doc = include_str!("guide/characters.md")]
pub mod characters {}

#[doc = include_str!("guide/wind.md")]
pub mod wind {}

#[doc = include_str!("guide/tuning.md")]
pub mod tuning {}

#[doc = include_str!("guide/when_it_fails.md")]
pub mod when_it_fails {}

#[doc = include_str!("guide/saving.md")]
pub mod saving {}

#[doc = include_str!("guide/recipes.md")]
pub mod recipes {}

#[doc = include_str!("guide/migrating_from_bevy_silk.md")]
pub mod migrating_from_bevy_silk {}
