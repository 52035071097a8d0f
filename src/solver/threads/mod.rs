//! Threads of a grid, and of a mesh, solved exactly.
//!
//! A thread is a chain of springs: a row, a column or a diagonal of a grid, a path of edges that go straight on in a mesh. One
//! sweep over its springs carries a correction one spring far, so that of a thread of n particles (n − 1)² g Δt² is left in
//! each sub-step. But the multipliers λ of all its springs together are no more than a tridiagonal system,
//!
//! ```text
//!   x₀ ──s₁── x₁ ──s₂── x₂ ──s₃── x₃        nᵢ: direction of spring i, Cᵢ: by how much it is too long
//!
//!   Aᵢᵢ = wᵢ₋₁ + wᵢ + α/(c Δt²)             Aᵢ,ᵢ₊₁ = −wᵢ nᵢ·nᵢ₊₁
//!   A λ = −C,                                Δxᵢ = wᵢ (λᵢ nᵢ − λᵢ₊₁ nᵢ₊₁)
//! ```
//!
//! which elimination solves in one pass there and one back (Thomas). Pins are particles of no inverse mass w, anywhere in it.
//! Everything is divided by lengths at rest and multiplied by lengths, so that no root is taken: two divisions a spring.
//!
//! **ε.** A rigid thread that is straight between two pins has one equation too many, and the system no solution. So the diagonal
//! is never softer than by the part ε = 10⁻³ of w, and by 0.2 of what a squared length is off: a thread between pins that are too
//! far apart pulls with C/ε, and would throw what is off its line far beyond it. A material that gives more than that is not
//! changed.
//!
//! **Order.** Diagonals first, then rows, then columns; what is solved last is held best. On a mesh all threads there and back:
//! one way only, a motion of second order gains energy.
//!
//! **Cost** (64², one thread, AVX2): 0.8 ns a spring of a column, 1.1 of a diagonal, 2 of a row, whose lanes have to be turned;
//! 24 µs a sub-step of all 16,000, where one sweep took 11.
//!
//! **Where it fails.** Each thread is exact by itself; what one leaves to the next is not. Where all the load hangs by one corner,
//! it passes from thread to thread, a step a sub-step: with too few of them the spring beside the pin stretches ([`needed`]). And
//! what tension does across a thread is explicit: its shortest ripple, of ω = 2 √(2 N ⁄ ρ) ⁄ h for a membrane of tension N and
//! spacing h, wants a sub-step below about 1.2 ⁄ ω (65² of cotton under 1 % of stretch: 40 in 1/64 s), or slow modes ring too low.
//!
//! [`needed`]: super::Substepping::needed

mod beside;
mod bundle;
mod bundles;
mod direction;
mod down;
mod grid;
mod link;
mod rows;
mod systems;
#[cfg(test)]
mod tests;

pub(super) use bundle::{Solved, Step, bundle_backward, bundle_forward};
pub(super) use bundles::Bundles;
pub(super) use down::{
    Pull, clear, column_backward, column_forward, column_heads, left_backward, left_forward,
    left_heads, right_backward, right_forward,
};
pub(super) use grid::ThreadSweep;
pub(super) use link::{Family, Link, measure_given};
pub(super) use rows::{Rows, pull_row, row_equations, solve_turned, turn_back, turn_terms};
