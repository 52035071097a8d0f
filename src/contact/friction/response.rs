//! The response to a contact.

use bevy::math::{DVec3, Vec3};

use crate::{
    cloth::{larger, smaller},
    contact::colliders::ColliderSubstep,
};

/// A contact at the end of a sub-step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Contact {
    /// Direction away from the collider, of length 1.
    pub normal: Vec3,
    /// Penetration along the normal (m).
    pub depth: f32,
    /// Displacement in the sub-step relative to the collider's surface (m).
    pub relative: Vec3,
}

impl Contact {
    /// The contact of a point of the cloth, by its position and its displacement in the sub-step (m). It touches at this
    /// `reach` from the surface (m).
    #[inline]
    pub fn of(
        motion: &ColliderSubstep,
        [position, displacement]: [Vec3; 2],
        (normal, depth): (Vec3, f32),
        reach: f32,
    ) -> Self {
        let surface = motion.surface_motion(position + normal * (depth - reach));
        Self {
            normal,
            depth,
            relative: displacement - surface,
        }
    }

    /// The stopped displacement along the normal, and the total push out including it (m).
    ///
    /// Velocity loses only the approach of this sub-step, and only that counts for friction. An older overlap is not a
    /// velocity, and must not become one.
    pub fn stopped_and_out(&self, push_out: &PushOut) -> [f32; 2] {
        let stopped = self.depth.min(-self.normal.dot(self.relative)).max(0.0);
        [stopped, stopped + push_out.of(self.depth - stopped)]
    }

    /// Pushes out along the normal, and applies Coulomb friction: the tangential displacement shrinks by up to μ times
    /// the normal one. An older overlap is released without gaining speed, at a limited rate. Returns the corrections of
    /// position and displacement (m).
    pub fn push(&self, friction: f32, push_out: &PushOut) -> [Vec3; 2] {
        let (normal, relative) = (self.normal, self.relative);
        let tangential = relative - normal * normal.dot(relative);
        let [stopped, far] = self.stopped_and_out(push_out);
        let slip = tangential.length();
        let most = friction * stopped;
        let grip = if slip > most { most / slip } else { 1.0 };
        let held = tangential * grip;
        [normal * far - held, normal * stopped - held]
    }
}

/// Release rate of an overlap that existed when a contact began. If it were released at once, it would stretch the
/// springs beside it, and these would throw the cloth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PushOut {
    /// Fraction of it released in a sub-step.
    pub rate: f32,
    /// Smallest and largest release (m).
    pub slowest: f32,
    pub fastest: f32,
}

/// Time in which an overlap decays to 1/e (s), and the smallest and largest speed of the release (m/s).
const OVERLAP_TIME: f32 = 0.1;
const SLOWEST_OUT: f32 = 0.05;
const FASTEST_OUT: f32 = 0.25;

impl PushOut {
    /// For a sub-step of `seconds`, in which the collider itself moves by `travel` (m) and so makes way at once.
    /// `shares` is the share of each of several pushes on the same particle.
    pub fn new(seconds: f32, travel: f32, shares: f32) -> Self {
        let seconds = seconds / shares;
        Self {
            rate: seconds / OVERLAP_TIME,
            slowest: SLOWEST_OUT * seconds + travel,
            fastest: FASTEST_OUT * seconds + travel,
        }
    }

    /// As [`Contact::stopped_and_out`], for one of eight lanes: the stopped displacement, and the release beside it (m).
    /// `apart` is the relative displacement along the normal (m).
    #[inline(always)]
    pub fn of_lane(&self, depth: f32, apart: f32) -> (f32, f32) {
        let stopped = larger(smaller(depth, -apart), 0.0);
        let overlap = depth - stopped;
        let released = larger(overlap * self.rate, self.slowest);
        let released = smaller(released, self.fastest);
        (stopped, smaller(released, overlap))
    }

    /// The released part of an overlap (m).
    pub fn of(&self, overlap: f32) -> f32 {
        let released = (overlap * self.rate).max(self.slowest);
        released.min(self.fastest).min(overlap)
    }
}

/// The impulse on a collider as mass × displacement (kg m): momentum times the sub-step.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct Impulse {
    pub linear: DVec3,
    /// Moment about the collider's origin (kg m²).
    pub angular: DVec3,
}

impl Impulse {
    /// Adds a particle of an inverse mass (1/kg) at an arm from the collider's origin (m), pushed by a displacement
    /// (m).
    pub fn add(&mut self, arm: Vec3, displacement: Vec3, inverse_mass: f32) {
        let given = -displacement.as_dvec3() / f64::from(inverse_mass);
        self.linear += given;
        self.angular += arm.as_dvec3().cross(given);
    }

    /// Keeps a fraction of it.
    pub fn scale(&mut self, part: f64) {
        self.linear *= part;
        self.angular *= part;
    }

    /// Adds another impulse.
    pub fn merge(&mut self, other: &Self) {
        self.linear += other.linear;
        self.angular += other.angular;
    }
}

/// Largest number of steps along a path towards a possible hit.
pub(crate) const MAX_STEPS: u32 = 32;

/// The fraction of a sub-step, from 0 to 1, at which two objects are first within `touch` (m), with a `tolerance` (m)
/// above it. Each step is short enough not to pass a contact (conservative advancement; Mirtich 1996). `distance` is
/// the distance at a fraction (m), and `speed` its largest change in the whole sub-step (m).
///
/// `None` if they do not meet. If they stay so close that the steps run out, for example while sliding, returns the
/// fraction reached: no earlier contact was missed, and later ones are unknown.
pub(crate) fn first_touch(
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
        let step = left / speed;
        part += step;
        if part > 1.0 {
            return None;
        }
        // Too fast: rounding would lose the next step.
        if step < f32::EPSILON {
            break;
        }
    }
    // Close for so long: this counts as a touch. NaN does not.
    (part <= 1.0).then_some(part)
}
