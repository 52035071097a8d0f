//! Where bodies stand.

use std::ops::Range;

use bevy::math::{Isometry3d, Vec3};

use super::{
    cover::{Cover, Near},
    point::StandingPoint,
};
use crate::{
    cloth::{ClothParticles, LANES, MapInline, Slot},
    contact::{
        candidates::ContactBlock,
        colliders::{MOST_POINTS, Manifold, ManifoldPoint, MovingCollider, Nearest, moving_of},
        friction::Impulse,
    },
};

/// Cloth is looked for at each point of the manifold, and at these parts of the way to their middle.
const INWARDS: [f32; 4] = [0.0, 0.25, 0.5, 0.75];

/// A point without cloth goes by the cloth at another one, if the cosine between their normals is at least this.
const ALIKE: f32 = 0.9;

/// A body this near to where it would stand is taken to stand there, in radii of a particle.
const CLOSE: f32 = 0.5;

/// How far a body is kept from what it stands on, in radii of the particles between: a little more than they need, so that
/// cloth slips through.
pub(super) const THICKNESS: f32 = 2.1;

/// Cloth lies flat on something where it is nearer than this many radii of a particle.
const FLAT: f32 = 1.5;

/// A body that turns by this angle rolls: it stands on other points (rad).
const ROLLS: f32 = 0.01;

/// A point where a body stands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Support {
    /// The points on the body and on the ground, each in its own frame (m).
    pub on_body: Vec3,
    pub on_ground: Vec3,
    /// Normal out of the ground, in its frame, of length 1.
    pub normal: Vec3,
    /// How high the body was above the ground as it was found (m).
    height: f32,
    pub cloth: Cover,
    /// Impulse along the normal in the sub-step (kg·m).
    pub pushed: f64,
    /// The part of all impulses that friction on the body has not used yet in the tick (kg·m).
    pub unspent: f64,
}

/// A body, and the collider that it stands on.
#[derive(Debug, Clone)]
pub(crate) struct Stand {
    /// The caller's IDs of the body and of the ground.
    pub body: usize,
    pub ground: usize,
    /// Its supports among all, and its particles among those between.
    pub(super) supports: Range<usize>,
    pub between: Range<usize>,
    /// Whether the ground has held the body in the tick, or it is close enough to.
    pub(super) holds: bool,
    /// Impulse along the normal that friction on the cloth has not used yet in the tick (kg·m).
    pub(super) unspent: f64,
    /// All that friction on the body had left as the tick was searched anew (kg·m).
    left: f64,
    /// The impulse on the ground in the last sub-step.
    pub given: Impulse,
}

/// All bodies that stand on cloth which lies on something, in a tick.
#[derive(Debug, Default, Clone)]
pub(crate) struct Supports {
    pub stands: Vec<Stand>,
    /// The particles that are pressed, of each stand.
    pub between: Vec<u32>,
    pub(super) all: Vec<Support>,
    /// The points of one body in a sub-step.
    pub(super) points: Vec<StandingPoint>,
    /// The fraction of the tick at which they were searched for, and the stands of the search before.
    searched_at: f32,
    before: Vec<Stand>,
    /// Particles that a body does not push, and their inverse masses (1/kg).
    hidden: Vec<(Slot, f32)>,
    manifold: Manifold,
}

impl Supports {
    /// Forgets everything, as a tick begins.
    pub fn clear(&mut self) {
        self.begin_search(0.0);
        self.before.clear();
    }

    /// Begins to search anew at a fraction of a tick.
    pub fn begin_search(&mut self, passed: f32) {
        self.searched_at = passed;
        for stand in &mut self.stands {
            let own = self.all[stand.supports.clone()].iter();
            stand.left = own.map(|support| support.unspent).sum();
        }
        std::mem::swap(&mut self.before, &mut self.stands);
        self.stands.clear();
        self.all.clear();
        self.between.clear();
    }

    /// Finds where a body stands on the ground at a fraction of the tick. Both have the caller's IDs.
    pub fn find(
        &mut self,
        [(body, moving), (ground, below)]: [(usize, &MovingCollider); 2],
        near: &Near,
        passed: f32,
    ) {
        let poses = [moving.pose_at(passed), below.pose_at(passed)];
        let [place, ground_place] = poses.map_inline(|pose| Vec3::from(pose.translation));
        let extent = moving.shape.extent();
        let far = place.distance(ground_place) + extent;
        let travel = moving.max_surface_travel(extent) + below.max_surface_travel(far);
        let within = 3.0 * near.radius + travel;
        let in_ground = poses[1].inverse() * place;
        let reach = extent + within;
        let is_near = (below.shape.nearest_within(in_ground, reach)).distance <= reach;
        if !(is_near && within.is_finite()) {
            return;
        }
        let between = poses[1].inverse() * poses[0];
        (self.manifold).find([&below.shape, &moving.shape], between, within);
        let first = [self.all.len(), self.between.len()];
        let middle = self.manifold.middle();
        let points = &self.manifold.points;
        let place = |point: &ManifoldPoint| Place::of(point, [moving, below], poses, passed);
        let cover = |point: &ManifoldPoint| {
            let mut inwards = INWARDS.iter().map(|&part| point.lerp(&middle, part));
            inwards.find_map(|point| {
                let place = place(&point);
                near.cover([place.below, place.above], place.normal)
            })
        };
        let mut cloth = [None; MOST_POINTS];
        for (to, point) in cloth.iter_mut().zip(points) {
            *to = cover(point);
        }
        for (point, own) in points.iter().zip(&cloth) {
            let is_alike = |other: &ManifoldPoint| other.normal.dot(point.normal) > ALIKE;
            let pairs = points.iter().zip(&cloth);
            let mut alike = pairs.filter(|(other, _)| is_alike(other));
            let cloth = own.or_else(|| alike.find_map(|(_, cloth)| *cloth));
            let supported = cloth.map(|cloth| place(point).support(cloth, poses));
            self.all.extend(supported);
        }
        let found = &mut self.all[first[0]..];
        if found.is_empty() {
            return;
        }
        let heights = found.iter().map(|support| support.height);
        let lowest = heights.fold(f32::INFINITY, f32::min);
        let is_close = lowest < (THICKNESS + CLOSE) * near.radius;
        self.between.extend(near.pressed([moving, below], passed));
        if self.between.len() == first[1] {
            let corners = found.iter().flat_map(|support| support.cloth.corners);
            self.between.extend(corners);
            self.between[first[1]..].sort_unstable();
            self.between.dedup();
        }
        let is_it = |stand: &&Stand| (stand.body, stand.ground) == (body, ground);
        let known = self.before.iter().find(is_it);
        let left = known.map_or(0.0, |known| known.left);
        let count = found.len() as f64;
        for support in found {
            support.unspent = left / count;
        }
        self.stands.push(Stand {
            body,
            ground,
            supports: first[0]..self.all.len(),
            between: first[1]..self.between.len(),
            holds: is_close || known.is_some_and(|known| known.holds),
            unspent: known.map_or(0.0, |known| known.unspent),
            left: 0.0,
            given: Impulse::default(),
        });
    }

    /// Whether a body has rolled to other points at a fraction of the tick.
    pub fn have_rolled(&self, moving: &MovingCollider, passed: f32) -> bool {
        moving.turn.length() * (passed - self.searched_at) > ROLLS
    }

    /// The stands on what holds a body in this tick.
    fn holding(&self, body: usize) -> impl Iterator<Item = &Stand> {
        let stands = self.stands.iter();
        stands.filter(move |stand| stand.body == body && stand.holds)
    }

    /// Whether something holds a body in this tick.
    pub fn is_held(&self, body: usize) -> bool {
        self.holding(body).next().is_some()
    }

    /// The direction in which a body is held at a fraction of the tick, if it is. Colliders have their IDs.
    pub fn up_of(
        &self,
        body: usize,
        colliders: &[(usize, MovingCollider)],
        passed: f32,
    ) -> Option<Vec3> {
        let stand = self.holding(body).next()?;
        let ground = moving_of(colliders, stand.ground)?;
        Some(ground.pose_at(passed).rotation * self.all[stand.supports.start].normal)
    }

    /// Whether a collider holds a body in this tick.
    pub fn is_held_by(&self, body: usize, ground: usize) -> bool {
        self.holding(body).any(|stand| stand.ground == ground)
    }

    /// Pins cloth that lies flat on what holds a body while the body pushes other cloth, until [`show`](Self::show). The
    /// ground keeps the body off, and its edges do not hit each ripple below it. `near` are the blocks of particles near
    /// the body; `nearest` gives the distance of a point from a ground (m).
    pub fn hide(
        &mut self,
        body: usize,
        near: &[ContactBlock],
        particles: &mut ClothParticles,
        radius: f32,
        nearest: impl Fn(usize, Vec3) -> f32,
    ) {
        self.hidden.clear();
        if !self.is_held(body) {
            return;
        }
        let within = FLAT * radius;
        for contact in near {
            let block = contact.block as usize;
            for lane in 0..LANES {
                let here = &mut particles.blocks_mut()[block];
                let (place, inverse_mass) = (here.position(lane), here.inverse_mass(lane));
                let mut own = self.stands.iter().filter(|stand| stand.body == body);
                if inverse_mass > 0.0 && own.any(|stand| nearest(stand.ground, place) < within) {
                    self.hidden.push((Slot { block, lane }, inverse_mass));
                    here.set_inverse_mass(lane, 0.0);
                }
            }
        }
    }

    /// Whether anything is hidden now.
    pub fn has_hidden(&self) -> bool {
        !self.hidden.is_empty()
    }

    /// Frees what was hidden.
    pub fn show(&mut self, particles: &mut ClothParticles) {
        for (slot, inverse_mass) in self.hidden.drain(..) {
            particles.blocks_mut()[slot.block].set_inverse_mass(slot.lane, inverse_mass);
        }
    }
}

/// A point of the manifold, as exactly as the shapes tell.
struct Place {
    /// The points on the body and on the ground (m), and the normal there.
    above: Vec3,
    below: Vec3,
    normal: Vec3,
}

impl Place {
    /// The manifold is right to a tenth of a millimetre only, and what stands would rock. So these are the points of the
    /// surfaces nearest to it. `poses` are those of the body and of the ground.
    fn of(
        point: &ManifoldPoint,
        [body, ground]: [&MovingCollider; 2],
        poses: [Isometry3d; 2],
        passed: f32,
    ) -> Self {
        let on_body = poses[0] * point.on_second;
        let nearest = body.nearest(passed, on_body);
        let above = on_body - nearest.normal * nearest.distance;
        let Nearest { distance, normal } = ground.nearest(passed, above);
        let rough = poses[1].rotation * point.normal;
        // Inside of the ground, another side may be nearer.
        let [below, normal] = match distance < 0.0 && normal.dot(rough) < 0.99 {
            true => [poses[1] * point.on_first, rough],
            false => [above - normal * distance, normal],
        };
        Self {
            above,
            below,
            normal,
        }
    }

    /// The support there, by a piece of cloth. `poses` are those of the body and of the ground.
    fn support(&self, cloth: Cover, poses: [Isometry3d; 2]) -> Support {
        let [body, ground] = poses.map_inline(|pose| pose.inverse());
        Support {
            on_body: body * self.above,
            on_ground: ground * self.below,
            normal: ground.rotation * self.normal,
            height: (self.above - self.below).dot(self.normal),
            cloth,
            pushed: 0.0,
            unspent: 0.0,
        }
    }
}
