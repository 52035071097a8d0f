//! Floor 1, the dynamics of cloth: chains are solved exactly, and motion is of second order in time, in small
//! sub-steps.
//!
//! A tick is cut into sub-steps of Δt: small steps instead of many sweeps (Macklin et al. 2019). Each sub-step has
//! three stages:
//!
//! 1. Predict the free motion of every particle, by backward differences of second order or by the paper's equation
//!    (2).
//! 2. Resist bending, like a plate.
//! 3. Hold the rest lengths of the springs. These are XPBD constraints (Macklin et al. 2016), solved chain by chain,
//!    each chain as one system of equations.
//!
//! # Chains solved exactly
//! A chain is a path of springs: a row, a column or a diagonal of a grid, or a straight path of edges in a mesh. One
//! sweep over its springs carries a correction by one spring only, which leaves an error of (n − 1)² g Δt² in each
//! sub-step, for a chain of n particles. But the multipliers λ of all its springs together are the solution of a
//! tridiagonal system:
//!
//! ```text
//!   x₀ ──s₁── x₁ ──s₂── x₂ ──s₃── x₃        nᵢ: direction of spring i, Cᵢ: by how much it is too long
//!
//!   Aᵢᵢ = wᵢ₋₁ + wᵢ + α/(c Δt²)             Aᵢ,ᵢ₊₁ = −wᵢ nᵢ·nᵢ₊₁
//!   A λ = −C,                                Δxᵢ = wᵢ (λᵢ nᵢ − λᵢ₊₁ nᵢ₊₁)
//! ```
//!
//! Elimination solves it in one forward and one backward pass (Thomas). Pins are particles with the inverse mass w = 0,
//! anywhere in the chain. Equations are divided by rest lengths and multiplied by lengths, so that no square root is
//! needed: two divisions per spring.
//!
//! **ε.** A rigid, straight chain between two pins has one equation too many, and its system has no solution. So the
//! softness of a spring, on the diagonal, is at least the fraction ε = 10⁻³ of w, plus 0.2 of the relative error of the
//! squared length. Without the second part, a chain between pins that are too far apart would pull with C/ε, and throw
//! particles beside its line far beyond it. A material that is softer than that is not changed.
//!
//! **Order.** Diagonals first, then rows, then columns; the last ones are held best. On a mesh all chains are solved
//! forward and back, because a motion of second order gains energy from one direction alone.
//!
//! **Second pass.** The chains solved after a row or column move its particles again. Where it carries many others, that adds
//! up from sub-step to sub-step. So the rows and columns of a grid are measured after the pass. Those in which more than
//! 0.5 % of a spring's length is left are solved again, in up to four rounds. Of elastic springs, what is left is
//! C + α/(c Δt²) λ, with the multipliers of all rounds. Where little is left, the next three sub-steps are not measured.
//! Chains with damping along them, and those of meshes, are solved once.
//!
//! **Cost** (64², one thread, AVX2): a spring of a diagonal costs 1.1 times a spring of a column, a spring of a row 1.3
//! times. The lanes of a row are strips of one chain, and the coupling between them is a system of its own.
//!
//! **Soft cloth** needs no solver where its sub-steps are shorter than 1.9/ω̂, with `ω̂² = 2 max_i w_i Σ_j k_ij`. Its
//! springs act by explicit forces then, in steps of velocity Verlet, in a third of the time
//! ([`Solver::longest_explicit_substep`]). The solver chooses this automatically where it takes at most twice the
//! sub-steps ([`Solver::needed`]).
//!
//! **Damping along springs** is a force of τ/α times the speed at which a spring lengthens. It is part of the same
//! equations, at the end of the sub-step: with κ = 1/(1 + τ/Δt), C becomes `κ C + (1 − κ)(C − C₀)` and α becomes κ α,
//! where C₀ is C as the sub-step began. C − C₀ is the change of a spring's length: it is 0 where the spring only turns.
//!
//! **Limits.** Each chain is solved exactly, but the coupling from one chain to the next is not. A load that hangs by
//! one corner passes from chain to chain, by one chain in each round: with too few sub-steps, four rounds don't
//! suffice, and the spring beside the pin stretches ([`needed`]). The effect of tension across a chain is explicit.
//! The shortest ripple of a membrane of tension N and spacing h has ω = 2 √(2 N ⁄ ρ) ⁄ h, and needs a sub-step below
//! 2.2 ⁄ ω; otherwise slow modes ring too low. For 65² of cotton under 1 % of stretch these are 36 sub-steps in 1/64 s.
//! [`Substepping::Automatic`] takes them. Chains of irregular meshes leave much of the tension unsolved:
//! λ begins at 0 in each sub-step, and a chain that is not straight pulls itself straight before those across it pull.
//! With vertices moved by 0.3 spacings, a membrane with 1 % of stretch rings 60 to 73 % too low. More sub-steps mend a part of that.
//!
//! [`needed`]: Substepping::needed

mod bending;
mod chains;
mod damping_reference;
mod energy;
mod envelope;
#[doc(hidden)]
pub mod forces;
mod free_pieces;
mod kernels;
mod list;
mod motion;
mod partitions;
mod rest;
mod seam;
mod settings;
mod soft_springs;
mod spin;
mod spring_solver;
mod step;
mod stretch;
mod substep;
mod substepping;
#[cfg(test)]
mod tests;
mod tether;
mod torn_grid;

#[doc(hidden)]
pub use bending::Bending;
pub use bending::ClothCreasing;
pub(crate) use bending::creases_of_torn;
pub use envelope::ClothLimit;
pub(crate) use envelope::LimitInputs;
pub use forces::ClothPressure;
pub(crate) use free_pieces::FreePieces;
#[doc(hidden)]
pub use kernels::SimdLevel;
pub(crate) use motion::MotionConstraints;
pub(crate) use partitions::with_threads_awake;
#[doc(hidden)]
pub use rest::{Rest, RestLimits, RestRule};
pub(crate) use seam::{Seam, SeamCloth, SeamPull};
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
