//! The impulses at the points where a body stands.

use bevy::math::DVec3;

use crate::contact::colliders::BodyMass;

/// Most rounds over all points, and the change below which they end, as a part of the largest impulse or displacement.
const ROUNDS: usize = 64;
const EXACT: f64 = 1.0e-5;

/// A point where a body stands, in a sub-step.
#[derive(Debug, Clone, Copy)]
pub(super) struct StandingPoint {
    /// Its indices among the stands and the supports.
    pub stand: usize,
    pub support: usize,
    /// From the body's centre of mass, and from the origin of the ground (m).
    pub arm: DVec3,
    pub below: DVec3,
    pub normal: DVec3,
    /// Least displacement along the normal that stops the approach, and that releases an older overlap (m).
    pub stop: f64,
    pub release: f64,
    /// Inverse mass along the normal (1/kg).
    pub inverse_mass: f64,
    /// Impulse along the normal, and what the sub-step gave before (kg·m).
    pub push: f64,
    pub before: f64,
    /// Impulse that moves the body's place alone (kg·m).
    pub released: f64,
    /// Displacement of the cloth relative to the body without friction (m).
    pub relative: DVec3,
    /// μ, the impulses that friction has not used yet, and the one of friction (kg·m).
    pub coefficient: f64,
    pub unspent: f64,
    pub friction: DVec3,
}

/// A displacement and a rotation of a body about its centre of mass.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Motion {
    pub go: DVec3,
    pub turn: DVec3,
}

impl Motion {
    fn at(&self, arm: DVec3) -> DVec3 {
        self.go + self.turn.cross(arm)
    }

    /// Adds what an impulse does to a body (kg·m).
    fn push(&mut self, mass: &BodyMass, arm: DVec3, impulse: DVec3) {
        self.go += f64::from(mass.inverse_mass) * (mass.free.as_dmat3() * impulse);
        self.turn += mass.inverse_inertia.as_dmat3() * arm.cross(impulse);
    }

    pub fn is_finite(&self) -> bool {
        self.go.is_finite() && self.turn.is_finite()
    }
}

/// Inverse mass of a body along a direction at an arm from its centre of mass (1/kg); 0 if it can't move there.
pub(super) fn inverse_mass(mass: &BodyMass, arm: DVec3, along: DVec3) -> f64 {
    let mut motion = Motion::default();
    motion.push(mass, arm, along);
    motion.at(arm).dot(along)
}

/// Pushes a body along the normals, until it comes nearer at no point. Returns its motion, and the one that moves it out of an
/// older overlap and gives it no speed.
pub(super) fn push_all(points: &mut [StandingPoint], mass: &BodyMass) -> [Motion; 2] {
    let [mut body, mut released] = [Motion::default(); 2];
    for _ in 0..ROUNDS {
        let comes_nearer = push(points, mass, &mut body);
        if !(release(points, mass, &mut released) || comes_nearer) {
            break;
        }
    }
    [body, released]
}

/// Lets the cloth take a body along, and pushes it along the normals again. Returns its motion.
pub(super) fn rub_all(points: &mut [StandingPoint], mass: &BodyMass) -> Motion {
    let mut body = Motion::default();
    for _ in 0..ROUNDS {
        let comes_nearer = push(points, mass, &mut body);
        if !(rub(points, mass, &mut body) || comes_nearer) {
            break;
        }
    }
    body
}

/// Pushes a body along the normals once. Returns whether it may still come nearer.
fn push(points: &mut [StandingPoint], mass: &BodyMass, body: &mut Motion) -> bool {
    let [mut most, mut changed] = [0.0_f64; 2];
    for point in points.iter_mut().filter(|point| point.inverse_mass > 0.0) {
        let wanted = point.stop - body.at(point.arm).dot(point.normal);
        // The sub-step may have pushed too much before.
        let push = (point.push + wanted / point.inverse_mass).max(-point.before);
        body.push(mass, point.arm, point.normal * (push - point.push));
        most = most.max(push.abs());
        changed = changed.max((push - point.push).abs());
        point.push = push;
    }
    changed > EXACT * most
}

/// Moves a body out of an older overlap once. Returns whether some may be left.
fn release(points: &mut [StandingPoint], mass: &BodyMass, body: &mut Motion) -> bool {
    let [mut most, mut changed] = [0.0_f64; 2];
    for point in points.iter_mut().filter(|point| point.inverse_mass > 0.0) {
        let wanted = point.release - body.at(point.arm).dot(point.normal);
        let released = (point.released + wanted / point.inverse_mass).max(0.0);
        let change = released - point.released;
        body.push(mass, point.arm, point.normal * change);
        (most, changed) = (most.max(released), changed.max(change.abs()));
        point.released = released;
    }
    changed > EXACT * most
}

/// Lets the cloth take a body along, with at most μ times the impulse at each point. Returns whether it may still slip.
fn rub(points: &mut [StandingPoint], mass: &BodyMass, body: &mut Motion) -> bool {
    let [mut largest, mut changed] = [0.0_f64; 2];
    for point in points {
        let relative = point.relative - body.at(point.arm);
        let slip = relative - point.normal * point.normal.dot(relative);
        let Some(along) = slip.try_normalize() else {
            continue;
        };
        let inverse_mass = inverse_mass(mass, point.arm, along);
        if inverse_mass <= 0.0 {
            continue;
        }
        let most = point.coefficient * (point.unspent + point.push).max(0.0);
        let friction = (point.friction + slip / inverse_mass).clamp_length_max(most);
        let change = friction - point.friction;
        body.push(mass, point.arm, change);
        (largest, changed) = (largest.max(most), changed.max(change.length()));
        point.friction = friction;
    }
    changed > EXACT * largest
}
