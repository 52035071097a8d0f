//! What a contact does to what it touches, whatever it is.

use bevy::math::Vec3;

/// A contact at the end of a sub-step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contact {
    /// Away from the collider, of length 1.
    pub normal: Vec3,
    /// How far along the normal it has to move (m).
    pub depth: f32,
    /// Its displacement in the sub-step, less that of the collider's surface (m).
    pub relative: Vec3,
}

/// What has to be added to the position and to the displacement of what is touched (m).
#[derive(Debug, Clone, Copy)]
pub(super) struct Push {
    pub position: Vec3,
    pub displacement: Vec3,
}

impl Contact {
    /// Pushes out along the normal, and slows against the surface by Coulomb's law: the tangential move is taken
    /// away up to μ times the normal one. What was inside already leaves without gaining speed.
    pub fn push(&self, friction: f32) -> Push {
        let Self {
            normal,
            depth,
            relative,
        } = *self;
        let tangential = relative - normal * normal.dot(relative);
        // What both came towards each other in this sub-step is what velocity has to lose, and what friction can
        // hold against. An older overlap is no velocity, and must not become one.
        let stopped = depth.min(-normal.dot(relative)).max(0.0);
        let slip = tangential.length();
        let grip = if slip > friction * stopped {
            friction * stopped / slip
        } else {
            1.0
        };
        Push {
            position: normal * depth - tangential * grip,
            displacement: normal * stopped - tangential * grip,
        }
    }
}

/// How many steps are taken along a way towards what may be hit on it.
pub(super) const MAX_STEPS: u32 = 32;

/// The part of a sub-step, from 0 to 1, after which two things first are as near as `touch` (m), to a `tolerance` (m)
/// above it, stepping no farther at a time than can be without coming nearer (conservative advancement; Mirtich
/// 1996). `distance` is that between them when a part has passed (m), `speed` the most that it changes by in the
/// whole sub-step (m).
///
/// `None` if they do not meet, or if they pass each other so closely that the steps run out: as they do when what
/// moves slides along.
pub(super) fn first_touch(
    speed: f32,
    touch: f32,
    tolerance: f32,
    distance: impl Fn(f32) -> f32,
) -> Option<f32> {
    let mut part = 0.0;
    for _ in 0..MAX_STEPS {
        let left = distance(part) - touch;
        if left <= tolerance {
            return Some(part);
        }
        part += left / speed;
        if part > 1.0 {
            return None;
        }
    }
    None
}
