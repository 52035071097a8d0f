//! Settings and results of a cloth's contacts.

use bevy::{math::Vec3, reflect::Reflect};

use super::{blocks::Ranges, narrow_phase::NarrowPhase};
use crate::{
    contact::{colliders::MovingCollider, friction::Impulse},
    solver::SubStep,
};

/// The penetrating area of triangles is measured in every fourth sub-step, in the last one, and until there is some. It
/// costs half as much as a push.
const MEASURED_EACH: u32 = 4;

/// A particle near a collider, and its depth.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ContactPoint {
    /// Index of the particle. If triangles of its own are tested, it stands for them.
    pub particle: u32,
    /// Its largest depth inside the collider in the tick (m). If it stayed outside, minus its smallest distance. −∞ if it
    /// was not tested, because it is pinned or far away, and outside of shapes other than balls, capsules, planes and
    /// boxes.
    pub depth: f32,
}

/// A collider that may touch the cloth in this tick.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Touch {
    /// The caller's ID of the collider.
    pub id: usize,
    /// Its shape and motion.
    pub collider: MovingCollider,
    /// Its narrow phase, never `Auto`: `Triangles` if it is tested against any.
    pub narrow_phase: NarrowPhase,
    /// The largest depth (m), 0 if nothing was inside.
    pub deepest: f32,
    /// The largest penetrating area of the cloth at the end of a sub-step (m²). Against triangles, it is measured in
    /// every fourth sub-step and in the last. Of particles, each counts with its share of the cloth's area.
    pub area: f32,
    /// The largest ∫ depth dA over that area (m³).
    pub volume: f32,
    /// The impulse of the cloth on the collider in the tick so far, in the cloth's frame (N·s): the momentum that
    /// contact and friction took from the cloth. The release of an older overlap does not count.
    pub impulse: Vec3,
    /// The angular impulse about the collider's origin, at its position in each sub-step (N·m·s).
    pub angular_impulse: Vec3,
    pub(crate) of: Ranges,
    /// Displacement in the tick so far (m).
    pub(crate) travelled: f32,
}

impl Touch {
    /// Whether the penetrating area of triangles is measured in this sub-step.
    pub(crate) fn is_measured_in(&self, substep: SubStep) -> bool {
        let next = substep.index + 1;
        self.area == 0.0 || next.is_multiple_of(MEASURED_EACH) || next == substep.count
    }

    /// Adds the impulse of a sub-step that takes some seconds.
    pub(crate) fn add_impulse(&mut self, given: &Impulse, seconds: f32) {
        let seconds = f64::from(seconds);
        self.impulse += (given.linear / seconds).as_vec3();
        self.angular_impulse += (given.angular / seconds).as_vec3();
    }
}

/// The contact settings of a cloth in a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSettings {
    /// Radius of each particle (m).
    pub particle_radius: f32,
    /// Coulomb's μ.
    pub friction: f32,
    /// The narrow phase.
    pub narrow_phase: NarrowPhase,
    /// Whether fast motion is tested along its whole path; only comparisons turn this off.
    #[doc(hidden)]
    pub is_swept: bool,
}

impl Default for ContactSettings {
    /// Points without friction.
    fn default() -> Self {
        Self {
            particle_radius: 0.0,
            friction: 0.0,
            narrow_phase: NarrowPhase::Auto,
            is_swept: true,
        }
    }
}
