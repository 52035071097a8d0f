//! The narrow phase by particles: each is a ball with its own radius.

use bevy::math::{DVec3, Mat3, Vec3};

use super::{
    lanes::{LaneMotion, Sums, push_cuboid, push_half_space, push_round},
    near::{Cuboid, HalfSpace, Round},
    planes::{Frame, Planes, find_planes, push_planes},
};
use crate::{
    cloth::{Block, ClothParticles, LANES, Lanes, MapInline},
    contact::{
        candidates::{ContactBlock, ContactSettings},
        colliders::{ColliderShape, ColliderSubstep, Nearest},
        friction::{Contact, Impulse, PushOut, first_touch},
    },
};

/// The result of a sub-step's contacts.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct ContactResult {
    /// Largest depth (m).
    pub deepest: f32,
    /// Largest push (m).
    pub farthest_push: f32,
    /// Penetrating area of the cloth (m²).
    pub area: f32,
    /// ∫ depth dA over it (m³).
    pub volume: f32,
    /// The impulse on the collider.
    pub given: Impulse,
}

impl ContactResult {
    /// This and what was pushed after it.
    pub fn and(mut self, other: &Self) -> Self {
        self.deepest = self.deepest.max(other.deepest);
        self.farthest_push += other.farthest_push;
        self.area += other.area;
        self.volume += other.volume;
        self.given.merge(&other.given);
        self
    }

    /// Adds the sums of blocks of lanes.
    pub fn add(&mut self, sums: &Sums) {
        let largest = |lanes: &Lanes| lanes.iter().copied().fold(0.0, f32::max);
        let sum = |lanes: &Lanes| lanes.iter().copied().map(f64::from).sum::<f64>();
        let vector =
            |lanes: &[Lanes; 3]| DVec3::from([0, 1, 2].map_inline(|axis| sum(&lanes[axis])));
        self.deepest = self.deepest.max(largest(&sums.deepest));
        let farthest = largest(&sums.farthest_push).sqrt();
        self.farthest_push = self.farthest_push.max(farthest);
        self.area += sum(&sums.area) as f32;
        self.volume += sum(&sums.volume) as f32;
        self.given.merge(&Impulse {
            linear: vector(&sums.linear),
            angular: vector(&sums.angular),
        });
    }
}

/// Pushes particles out that are inside `collider`, or that passed through it in this sub-step. Pinned particles do not
/// move. `planes` are those of the cloth's blocks; only a shape whose nearest point is expensive needs any.
pub(crate) fn push_particles(
    particles: &mut ClothParticles,
    contacts: &mut [ContactBlock],
    (planes, tick): (&mut [Planes], u32),
    of: &ColliderSubstep,
    motion: &LaneMotion,
) -> ContactResult {
    let mut found = ContactResult::default();
    let mut sums = Sums::default();
    let blocks = particles.blocks_mut();
    let shape = &of.collider.shape;
    if shape.is_geometry() {
        let frame = Frame::new(of, motion.particle_radius, tick);
        find_planes(blocks, contacts, planes, (shape, &frame, motion));
        push_planes(blocks, contacts, planes, (&frame, motion), &mut sums);
    } else {
        push_lanes(blocks, contacts, of, motion, &mut sums);
    }
    found.add(&sums);
    if sums.left > 0 {
        push_left(particles, contacts, of, motion, &mut found);
    }
    found
}

/// Constants for all blocks.
pub(crate) fn lane_motion(
    of: &ColliderSubstep,
    settings: &ContactSettings,
    push_out: PushOut,
    odometer: f32,
) -> LaneMotion {
    let (shape, particle_radius) = (&of.collider.shape, settings.particle_radius);
    let thickness = shape.thickness() + particle_radius;
    // Its nearest point is right at any depth.
    let [deepest, known] = match shape.is_geometry() {
        true => [f32::INFINITY; 2],
        false => [thickness / 2.0, thickness],
    };
    LaneMotion {
        origin: of.origin.to_array(),
        slide: of.slide.to_array(),
        spin: of.turn.to_array(),
        swing: of.swing,
        particle_radius,
        most: thickness / 2.0,
        deepest,
        // None for a half-space, which has no end.
        tolerance: if thickness.is_finite() {
            1.0e-3 * thickness
        } else {
            0.0
        },
        is_swept: settings.is_swept,
        friction: settings.friction,
        push_out,
        odometer,
        thickness: known,
    }
}

/// Pushes blocks of particles, and marks the blocks that have to be tested one by one.
fn push_lanes(
    blocks: &mut [Block],
    contacts: &mut [ContactBlock],
    of: &ColliderSubstep,
    motion: &LaneMotion,
    sums: &mut Sums,
) {
    let centre = motion.origin;
    let up = of.pose.rotation * Vec3::Y;
    let round = |axis, half_length, radius| Round {
        centre,
        axis,
        half_length,
        reach: radius + motion.particle_radius,
    };
    match of.collider.shape {
        ColliderShape::Ball { radius } => {
            let ball = round([0.0; 3], 0.0, radius);
            push_round(blocks, contacts, &ball, motion, sums);
        }
        ColliderShape::Capsule {
            radius,
            half_length,
        } => {
            let capsule = round(up.to_array(), half_length, radius);
            push_round(blocks, contacts, &capsule, motion, sums);
        }
        ColliderShape::Cuboid { half_size } => {
            let cuboid = Cuboid {
                centre,
                axes: Mat3::from_quat(of.pose.rotation).to_cols_array_2d(),
                half_size: half_size.to_array(),
                reach: motion.particle_radius,
            };
            push_cuboid(blocks, contacts, &cuboid, motion, sums);
        }
        ColliderShape::HalfSpace => {
            let half_space = HalfSpace {
                centre,
                normal: up.normalize_or(Vec3::Y).to_array(),
                reach: motion.particle_radius,
            };
            push_half_space(blocks, contacts, &half_space, motion, sums);
        }
        ColliderShape::Geometry(_) | ColliderShape::Deforming(_) => {}
    }
}

/// Pushes the particles of the remaining blocks one by one.
fn push_left(
    particles: &mut ClothParticles,
    contacts: &mut [ContactBlock],
    of: &ColliderSubstep,
    motion: &LaneMotion,
    found: &mut ContactResult,
) {
    let (shape, thickness) = (&of.collider.shape, motion.thickness);
    let particle_radius = motion.particle_radius;
    for contact in contacts.iter_mut().filter(|contact| contact.left != 0) {
        for lane in (0..LANES).filter(|lane| contact.left & (1 << lane) != 0) {
            let block = &particles.blocks()[contact.block as usize];
            let inverse_mass = block.inverse_mass(lane);
            if inverse_mass == 0.0 {
                continue;
            }
            let (position, displacement) = (block.position(lane), block.displacement(lane));
            let nearest = of.nearest(position);
            let point = [position, displacement];
            let hit = hit(of, motion, point);
            let (normal, depth) =
                hit.unwrap_or((nearest.normal, particle_radius - nearest.distance));
            // Which others of a complex shape are tested depends on what is remembered.
            if depth > 0.0 || !shape.is_geometry() {
                contact.depth[lane] = contact.depth[lane].max(depth.min(thickness));
            }
            if depth <= 0.0 {
                continue;
            }
            let [push, change] = Contact::of(of, point, (normal, depth), particle_radius)
                .push(motion.friction * contact.grip[lane], &motion.push_out);
            let mut pushed = position + push;
            if hit.is_some() && shape.is_geometry() {
                // Another part of it may be in front of the one that was hit.
                let Nearest { distance, normal } = of.nearest(pushed);
                pushed += normal * (particle_radius - distance).max(0.0);
            }
            let block = &mut particles.blocks_mut()[contact.block as usize];
            block.set_position(lane, pushed);
            block.set_displacement(lane, displacement + change);
            (found.given).add(pushed - of.origin, change, inverse_mass);
            found.deepest = found.deepest.max(depth.min(thickness));
            found.farthest_push = found.farthest_push.max(pushed.distance(position));
            found.area += contact.area[lane];
            found.volume += contact.area[lane] * depth.min(thickness);
        }
    }
}

/// The normal where a particle from outside hit the collider, and its displacement along it to stay in front of the
/// surface there (m): for motion so large that the test at the end of the sub-step may come too late.
fn hit(
    of: &ColliderSubstep,
    motion: &LaneMotion,
    [position, displacement]: [Vec3; 2],
) -> Option<(Vec3, f32)> {
    let (radius, most) = (motion.particle_radius, motion.most);
    let speed = of.speed([displacement]);
    // A particle that moved less than half of the thickness is still on its original side.
    if !motion.is_swept || speed <= most || !speed.is_finite() {
        return None;
    }
    let start = position - displacement;
    let place = |part: f32| start + displacement * part;
    let nearest = |part: f32| of.collider.nearest(of.passed(part), place(part));
    // For a particle this deep already, the original side is unknown.
    if nearest(0.0).distance < radius - most {
        return None;
    }
    let distance = |part| nearest(part).distance;
    let part = first_touch(speed, radius, motion.tolerance, distance)?;
    let Nearest { distance, normal } = nearest(part);
    // The position that it would have, had it moved on with the surface: in front of every convex shape.
    let (carried, normal) = of.carry(part, place(part), normal);
    let depth = normal.dot(carried - position) + (radius - distance);
    (depth > 0.0).then_some((normal, depth))
}
