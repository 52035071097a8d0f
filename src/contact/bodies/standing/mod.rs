//! Bodies that stand on another collider, through the cloth between them: a cup on a tablecloth.
//!
//! Cloth is so light that what lies on it and what it lies on press each other. Pushes by particles would go back and
//! forth a thousand times before they held a body. A body that particles carry (see [`Carriers`](super::Carriers)) could
//! not slide. So where cloth lies between, body and collider are kept apart at the points of their contact manifold, by
//! the thickness of the cloth:
//!
//! ```text
//!        body              n ↑
//!   ────┬──────┬────         │   on the body
//!   ~~~~~~~~~~~~~~~~ cloth   │
//!   ────┴──────┴────         ┴   on the ground
//! ```
//!
//! In each sub-step the impulses follow by projected Gauss–Seidel over all these points (sequential impulses: Catto
//! 2005). Friction on the body goes by the velocity of the cloth, with up to μ times the impulse at that point. A body
//! stays where the cloth stays, goes along where the cloth is slow, and slides else. Friction on the cloth comes from both
//! sides; the ground gets the rest, so that momentum is conserved.
//!
//! A physics engine gives gravity to a body once a tick, so that all of the impulse comes in the first sub-step. Friction
//! on the body uses it then, since the pull along a slope comes then, too. Friction on the cloth spends it in equal parts
//! until the tick ends: else the cloth would be held in one sub-step, and slip freely in all others.
//!
//! Impulses are here mass × displacement (kg·m): momentum times the sub-step. Nothing of this outlives a tick.

mod cover;
mod point;
mod stand;
mod supports;

pub(crate) use cover::Near;
pub(crate) use stand::{ContactStep, StandingResponse};
pub(crate) use supports::{Stand, Supports};
