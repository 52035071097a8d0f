//! Floor 1: how a cloth *moves*: threads solved exactly, and a motion of second order in time, in small sub-steps.
//!
//! A tick is cut into sub-steps of Δt (small steps instead of many sweeps: Macklin et al. 2019). Each predicts where every
//! particle would be by itself, by backward differences of second order or by the paper's equation (2), bends it back as a plate
//! would, and then holds the rest lengths of the springs, which are XPBD constraints (Macklin et al. 2016): thread by thread,
//! each solved as one system of equations.
//!
//! # Threads solved exactly
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
//! **Cost** (64², one thread, AVX2): a spring of a diagonal costs 1.1 times one of a column, one of a row 1.3 times: its lanes are
//! strips of one thread, and what they have to do with each other is a system of its own.
//!
//! **Soft cloth** is not solved at all where its sub-steps are shorter than 1.9/ω̂, with `ω̂² = 2 max_i w_i Σ_j k_ij`: its springs push
//! by their forces then, in steps of velocity Verlet, for a third of the time ([`Solver::longest_explicit_substep`]). Where that takes
//! no more than twice the sub-steps it is chosen by itself ([`Solver::needed`]).
//!
//! **Damping along springs** is a force of τ/α times the speed at which a spring gets longer. It is in the same equations, taken where
//! the sub-step ends: with κ = 1/(1 + τ/Δt), C becomes `κ C + (1 − κ)(C − C₀)` and α becomes κ α, where C₀ is C as the sub-step began.
//!
//! **Where it fails.** Each thread is exact by itself; what one leaves to the next is not. Where all the load hangs by one corner,
//! it passes from thread to thread, a step a sub-step: with too few of them the spring beside the pin stretches ([`needed`]). And
//! what tension does across a thread is explicit: its shortest ripple, of ω = 2 √(2 N ⁄ ρ) ⁄ h for a membrane of tension N and
//! spacing h, wants a sub-step below 2.2 ⁄ ω (65² of cotton under 1 % of stretch: 36 in 1/64 s), or slow modes ring too low;
//! [`Substepping::Automatic`] sees to that on grids.
//!
//! [`needed`]: Substepping::needed

mod air;
mod bands;
mod barrier;
mod bending;
mod commit;
mod drift;
mod energy;
mod envelope;
mod forces;
mod kernel;
mod list;
#[cfg(feature = "methods")]
#[doc(hidden)]
pub mod methods;
mod motion;
mod pace;
mod packet;
mod pentadiagonal;
mod pipeline;
mod plate;
mod predict;
mod rest;
mod run;
mod settings;
mod spin;
mod step;
mod stretch;
mod substep;
mod substepping;
mod sweep;
#[cfg(test)]
mod tests;
mod tether;
mod threads;
mod twist;

#[doc(hidden)]
pub use air::Air;
pub use air::ClothPressure;
pub(crate) use air::{AirMemory, FILLING};
#[doc(hidden)]
pub use bending::Bending;
pub use envelope::ClothLimit;
pub(crate) use envelope::LimitInputs;
#[doc(hidden)]
pub use kernel::SimdLevel;
pub(crate) use motion::MotionConstraints;
#[doc(hidden)]
pub use rest::Rest;
pub use settings::ClothSettings;
pub use step::TimeOrder;
#[doc(hidden)]
pub use step::{DampingFrame, PinMotion, SubStep, TickStep};
pub use stretch::Stretch;
#[doc(hidden)]
pub use substep::Solver;
pub(crate) use substep::StartedTick;
#[doc(hidden)]
pub use substepping::Control;
pub use substepping::Substepping;
#[doc(hidden)]
pub use tether::Tethers;
pub(crate) use tether::material_stretch;
