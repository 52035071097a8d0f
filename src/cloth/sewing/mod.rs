//! Which particles of two surfaces a seam joins.
//!
//! In: the selection of each side, and where its particles are. Out: stitches, each from a particle of the finer side to a
//! point between up to three particles of the other.

mod line;
mod nearest;
mod side;
mod stitch;
#[cfg(test)]
mod tests;

pub(crate) use side::SewnSide;
pub(crate) use stitch::{Stitch, stitches};
