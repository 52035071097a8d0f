//! Draws a cloth between two ticks so that its pins are drawn together with their carriers.
//!
//! The cloth is interpolated between the last two ticks. Its entity, or a target that it is attached to, may be drawn
//! elsewhere: where the latest tick left it, if nothing interpolates it, or where it has moved since. Particles are
//! moved along by the distance between their carriers' drawn places and interpolated places: pins by all of it, other
//! particles by less the farther they are from pins. So no seam opens beside a pin, and cloth that hangs far away does
//! not tremble.

use bevy::{
    math::Affine3A,
    prelude::{Entity, GlobalTransform, Isometry3d, Vec3},
};

use crate::{
    cloth::ClothParticles,
    plugin::{
        frame::{ClothFrame, Shift, rigid},
        state::{ClothBuilt, ClothScratch, ClothState},
    },
};

/// Places of a cloth's frame and its targets as a tick ended.
#[derive(Debug, Default, Clone, PartialEq)]
struct Places {
    frame: ClothFrame,
    targets: Vec<(Entity, Affine3A)>,
}

/// Places as of the last two ticks.
#[derive(Debug, Default)]
pub(super) struct Carriers {
    before: Places,
    now: Places,
    is_known: bool,
    weights: Weights,
}

impl Carriers {
    /// Takes over a tick's.
    pub fn follow(&mut self, frame: ClothFrame, state: &ClothState, scratch: &ClothScratch) {
        std::mem::swap(&mut self.before, &mut self.now);
        self.now.frame = frame;
        self.now.targets.clear();
        let entities = state.attachments.targets.iter().copied();
        let targets = entities.zip(scratch.targets.iter().copied());
        self.now.targets.extend(targets);
        // After a teleport, or in the first tick, there is no place before.
        if scratch.teleports || !self.is_known {
            self.before.clone_from(&self.now);
        }
        self.is_known = true;
        self.before.targets.truncate(self.now.targets.len());
        for (index, now) in self.now.targets.iter().enumerate() {
            match self.before.targets.get_mut(index) {
                Some(before) if before.0 == now.0 => {}
                Some(before) => *before = *now,
                None => self.before.targets.push(*now),
            }
        }
    }

    /// Takes over the place of a cloth in a tick in which it is not moved: the next move begins there.
    pub fn freeze(&mut self, frame: ClothFrame) {
        self.now.frame = frame;
        self.now.targets.clear();
    }

    /// Shifts it with the world's origin. A place that stood still stands still; `target` gives the current place of a
    /// target.
    pub fn shift(
        &mut self,
        shift: Shift,
        frames: [ClothFrame; 2],
        target: impl Fn(Entity) -> Option<Affine3A>,
    ) {
        for places in [&mut self.before, &mut self.now] {
            places.frame = places.frame.shifted_with(shift, frames);
            for (entity, place) in &mut places.targets {
                *place = shift.affine(*place, target(*entity));
            }
        }
    }

    /// Whether a target is drawn elsewhere than where the last tick had it.
    pub fn differ_from(&self, drawn: &[Affine3A]) -> bool {
        let known = self.now.targets.iter().map(|(_, target)| target);
        !known.eq(drawn)
    }
}

/// The share of each carrier's correction that moves each particle: of the targets in their order, then of the entity.
#[derive(Debug, Default)]
struct Weights {
    /// The pins that they are for.
    made_for: Option<u32>,
    carriers: usize,
    of_particle: Vec<f32>,
    /// Particles that are pinned to the entity.
    own: Vec<u32>,
}

impl Weights {
    /// Makes them again if the pins have changed.
    fn follow(&mut self, built: &ClothBuilt, particles: &ClothParticles, state: &ClothState) {
        if self.made_for == Some(built.pins_version) {
            return;
        }
        self.made_for = Some(built.pins_version);
        let targets = state.attachments.given.len();
        self.carriers = targets + 1;
        let mut carrier_of = vec![None; particles.len()];
        for (carrier, inverse_mass) in carrier_of.iter_mut().zip(particles.inverse_masses()) {
            *carrier = (inverse_mass == 0.0).then_some(targets);
        }
        for attached in &state.attachments.attached {
            carrier_of[attached.particle as usize] = Some(attached.attachment);
        }
        self.own.clear();
        let own = (0..particles.len()).filter(|&index| carrier_of[index] == Some(targets));
        self.own.extend(own.map(|index| index as u32));
        let distances_of = |carrier: usize| -> Vec<f32> {
            let all = 0..carrier_of.len() as u32;
            let sources = all.filter(|at| carrier_of[*at as usize] == Some(carrier));
            let found = built.surface().graph().distances(sources);
            found.into_iter().map(|(distance, _)| distance).collect()
        };
        let distances: Vec<Vec<f32>> = (0..self.carriers).map(distances_of).collect();
        let nearest = |index: usize| {
            let of_carriers = distances.iter().map(|distance| distance[index]);
            of_carriers.fold(f32::INFINITY, f32::min)
        };
        // Particles without a path to a carrier are not moved.
        let all = (0..particles.len()).map(nearest);
        let reached = all.filter(|distance| distance.is_finite());
        let farthest = reached.fold(0.0, f32::max);
        self.of_particle.clear();
        for index in 0..particles.len() {
            let nearest = nearest(index);
            // All of it beside the pins, nothing at the particle that is farthest from them.
            let far = nearest / farthest;
            let fades = 1.0 - if nearest > 0.0 { far } else { 0.0 };
            let share = |distance: f32| {
                let ratio = nearest / distance;
                if distance > 0.0 { ratio * ratio } else { 1.0 }
            };
            let shares = || distances.iter().map(|distance| share(distance[index]));
            let sum: f32 = shares().sum();
            let weights = shares().map(|share| share / sum * fades);
            let weights = weights.map(|weight| if weight.is_finite() { weight } else { 0.0 });
            self.of_particle.extend(weights);
        }
    }
}

/// Places with which a cloth is drawn in a frame.
pub(super) struct Drawn<'a> {
    pub built: &'a ClothBuilt,
    pub state: &'a ClothState,
    pub particles: &'a ClothParticles,
    /// Drawn place of its entity.
    pub entity: GlobalTransform,
    /// Drawn places of its attachments' targets, in their order; empty if it has none.
    pub targets: &'a [Affine3A],
    /// Fraction of the last tick that has passed, from 0 to 1.
    pub fraction: f32,
}

impl Drawn<'_> {
    /// Moves the interpolated particles from their frame to that of the entity, which is the frame of the mesh, along
    /// with their carriers. Particles that were already moved with a skeleton have no other carrier.
    pub fn place(&self, carriers: &mut Carriers, is_skinned: bool, drawn: &mut [Vec3]) {
        let frame = carriers.now.frame;
        let mut is_corrected = false;
        if is_skinned {
            carriers.weights.own.clear();
            carriers.weights.made_for = None;
            is_corrected = true;
        } else if !self.built.pinned.is_empty() {
            for index in 0..=self.state.attachments.given.len() {
                if let Some(correction) = self.correction(carriers, index) {
                    if !is_corrected {
                        let weights = &mut carriers.weights;
                        weights.follow(self.built, self.particles, self.state);
                        is_corrected = true;
                    }
                    // In the cloth's frame, one carrier after the other: each moves its own part.
                    let by = frame.isometry().inverse() * correction * frame.isometry();
                    let of = &carriers.weights;
                    let weights = of.of_particle.chunks_exact(of.carriers);
                    for (place, weights) in drawn.iter_mut().zip(weights) {
                        let weight = weights.get(index).copied().unwrap_or_default();
                        *place += (by * *place - *place) * weight;
                    }
                }
            }
        }
        let to_entity = if self.entity.affine() == frame.affine() {
            frame.to_entity()
        } else {
            self.entity.affine().inverse() * Affine3A::from(frame.isometry())
        };
        for place in &mut *drawn {
            *place = to_entity.transform_point3(*place);
        }
        if is_corrected {
            self.put_pins(carriers, drawn);
        }
    }

    /// Offset of a carrier's drawn place from its interpolated place, if it is not zero.
    fn correction(&self, carriers: &Carriers, index: usize) -> Option<Isometry3d> {
        let Carriers { before, now, .. } = carriers;
        if index == self.state.attachments.given.len() {
            let drawn = self.entity.affine();
            let differs = before.frame != now.frame || drawn != now.frame.affine();
            let (was, is) = (before.frame.isometry(), now.frame.isometry());
            return differs.then(|| self.beyond(was, is, rigid(&drawn)));
        }
        let ((_, was), (_, is)) = (before.targets.get(index)?, now.targets.get(index)?);
        let drawn = self.targets.get(index)?;
        let differs = was != is || drawn != is;
        differs.then(|| self.beyond(rigid(was), rigid(is), rigid(drawn)))
    }

    fn beyond(&self, was: Isometry3d, is: Isometry3d, drawn: Isometry3d) -> Isometry3d {
        let between = Isometry3d::new(
            was.translation.lerp(is.translation, self.fraction),
            was.rotation.slerp(is.rotation, self.fraction),
        );
        drawn * between.inverse()
    }

    /// Puts pinned particles where they are drawn exactly, in the entity's frame.
    fn put_pins(&self, carriers: &Carriers, drawn: &mut [Vec3]) {
        let scale_out = carriers.now.frame.to_entity();
        for &particle in &carriers.weights.own {
            let position = self.particles.position_at(particle as usize);
            drawn[particle as usize] = scale_out.transform_point3(position);
        }
        let from_world = self.entity.affine().inverse();
        for of in &self.state.attachments.attached {
            if let Some(target) = self.targets.get(of.attachment)
                && let Some(place) = drawn.get_mut(of.particle as usize)
            {
                *place = from_world.transform_point3(target.transform_point3(of.offset));
            }
        }
    }
}
