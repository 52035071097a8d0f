//! The steps of a tick, and their order.

use bevy::ecs::schedule::SystemSet;

/// The steps of a tick, in this order. Each runs once per tick, not once per sub-step.
///
/// Systems that move colliders or write particles belong before [`Prepare`](Self::Prepare); systems that read the
/// results belong after [`WriteBack`](Self::WriteBack).
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ClothSystems {
    /// Builds new cloths, checks every input, and reads transforms, gravity and colliders.
    Prepare,
    /// Finds the colliders near each cloth, chooses how to search, and updates the bounding volumes.
    Rebuild,
    /// Searches the trees from the top down for candidates: particles that a collider may touch. The bounds are
    /// inflated by the distance that cloth and collider can move in the tick.
    Query,
    /// Runs all sub-steps: Verlet integration, springs, pins, and collision response for the candidates.
    Integrate,
    /// Writes messages and diagnostics.
    WriteBack,
}

/// A plugin whose field `schedule` is given to `new`, and is [`FixedUpdate`](bevy::app::FixedUpdate) by default.
macro_rules! runs_in_schedule {
    ($(#[$doc:meta])* $plugin:ident) => {
        impl Default for $plugin {
            fn default() -> Self {
                Self::new(bevy::app::FixedUpdate)
            }
        }

        impl $plugin {
            $(#[$doc])*
            pub fn new(schedule: impl bevy::ecs::schedule::ScheduleLabel) -> Self {
                Self {
                    schedule: schedule.intern(),
                }
            }
        }
    };
}
pub(super) use runs_in_schedule;
