//! What a contact does to what it touches, whatever it is.

use bevy::math::{DVec3, Vec3};

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
    /// How far along the normal it is stopped, and how far it is pushed out, that included (m).
    ///
    /// What both came towards each other in this sub-step is what velocity has to lose, and what friction can hold against. An older
    /// overlap is no velocity, and must not become one.
    pub fn stopped_and_out(&self, push_out: &PushOut) -> [f32; 2] {
        let stopped = self.depth.min(-self.normal.dot(self.relative)).max(0.0);
        [stopped, stopped + push_out.of(self.depth - stopped)]
    }

    /// Pushes out along the normal, and slows against the surface by Coulomb's law: the tangential move is taken
    /// away up to μ times the normal one. What was inside already leaves without gaining speed, as fast as it may.
    pub fn push(&self, friction: f32, push_out: &PushOut) -> Push {
        let Self {
            normal, relative, ..
        } = *self;
        let tangential = relative - normal * normal.dot(relative);
        let [stopped, far] = self.stopped_and_out(push_out);
        let slip = tangential.length();
        let grip = if slip > friction * stopped {
            friction * stopped / slip
        } else {
            1.0
        };
        Push {
            position: normal * far - tangential * grip,
            displacement: normal * stopped - tangential * grip,
        }
    }
}

/// How fast an overlap is let out that was there when a contact began. All of it at once would stretch the springs beside it,
/// and these would throw the cloth.
#[derive(Debug, Clone, Copy)]
pub(super) struct PushOut {
    /// The part of it that is let out in a sub-step.
    pub rate: f32,
    /// So far at least, and so far at most (m).
    pub slowest: f32,
    pub fastest: f32,
}

/// What an overlap takes to be let out to the part 1/e (s), and how slow and how fast it leaves at most (m/s).
const OVERLAP_TIME: f32 = 0.1;
const SLOWEST_OUT: f32 = 0.05;
const FASTEST_OUT: f32 = 0.25;

impl PushOut {
    /// In a sub-step of so many seconds, in which the collider itself travels so far (m): its own way makes room at once. With
    /// `shares`, what each of several that push the same particle has a part in.
    pub fn new(seconds: f32, travel: f32, shares: f32) -> Self {
        let seconds = seconds / shares;
        Self {
            rate: seconds / OVERLAP_TIME,
            slowest: SLOWEST_OUT * seconds + travel,
            fastest: FASTEST_OUT * seconds + travel,
        }
    }

    /// How much of an overlap is let out (m).
    pub fn of(&self, overlap: f32) -> f32 {
        let let_out = (overlap * self.rate).max(self.slowest);
        let_out.min(self.fastest).min(overlap)
    }
}

/// What a collider is given by what it pushes: mass × displacement (kg m), which over the sub-step is momentum.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct Given {
    pub linear: DVec3,
    /// About the collider's origin (kg m²).
    pub angular: DVec3,
}

impl Given {
    /// Adds what a particle of an inverse mass (1/kg), so far from the collider's origin (m), gives as it is pushed by a
    /// displacement (m).
    pub fn add(&mut self, arm: Vec3, displacement: Vec3, inverse_mass: f32) {
        let given = -displacement.as_dvec3() / f64::from(inverse_mass);
        self.linear += given;
        self.angular += arm.as_dvec3().cross(given);
    }

    /// Leaves a part of it.
    pub fn scale(&mut self, part: f64) {
        self.linear *= part;
        self.angular *= part;
    }

    /// Adds what another one was given.
    pub fn merge(&mut self, other: &Self) {
        self.linear += other.linear;
        self.angular += other.angular;
    }
}

/// How many steps are taken along a way towards what may be hit on it.
pub(super) const MAX_STEPS: u32 = 32;

/// The part of a sub-step, from 0 to 1, after which two things first are as near as `touch` (m), to a `tolerance` (m)
/// above it, stepping no farther at a time than can be without coming nearer (conservative advancement; Mirtich
/// 1996). `distance` is that between them when a part has passed (m), `speed` the most that it changes by in the
/// whole sub-step (m).
///
/// `None` if they do not meet. Where they are so close beside each other that the steps run out, as when what moves slides along, it is the
/// part that was come to: nothing was missed before, and what comes behind is not known.
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
        let step = left / speed;
        part += step;
        if part > 1.0 {
            return None;
        }
        // So fast that no number tells the next step from this one.
        if step < f32::EPSILON {
            break;
        }
    }
    // So long beside each other: as near as that is a touch. NaN is none.
    (part <= 1.0).then_some(part)
}
