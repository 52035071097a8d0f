//! The stage that moves the cloths: all sub-steps of a tick.
//!
//! In: the step of each cloth, the colliders near it, and the candidates of the search. Out: particles, state, contacts,
//! statistics, and the pushes on bodies.

mod integrate;
mod member;
mod pieces;
mod push;
mod seams;
mod substeps;
mod tick;

pub(crate) use integrate::integrate;
pub(crate) use push::push_bodies;
