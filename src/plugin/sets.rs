//! What happens in a tick, and in which order.

use bevy::ecs::schedule::SystemSet;

/// What happens in a tick, in this order. Each runs once a tick, not once a sub-step.
///
/// Systems that move colliders or write particles belong before [`Prepare`](Self::Prepare), those that read
/// what came of it after [`WriteBack`](Self::WriteBack).
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ClothSystems {
    /// Builds new cloths, checks every input, takes over transforms, gravity and colliders.
    Prepare,
    /// Finds which colliders are near, chooses how to search, and brings the bounding volumes up to date.
    Rebuild,
    /// Searches the trees from the top down, with bounds inflated by how far cloth and ball can move in the
    /// tick: candidates.
    Query,
    /// All sub-steps: Verlet, one sweep over the springs, response on the candidates.
    Integrate,
    /// Messages and diagnostics.
    WriteBack,
}
