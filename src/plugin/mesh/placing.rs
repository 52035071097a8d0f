//! Where a cloth is drawn between two ticks, so that its pins are drawn where that is drawn which carries them.
//!
//! The cloth is interpolated between the last two ticks. Its entity, or what it is attached to, may be drawn elsewhere:
//! where the latest tick left it, if nobody interpolates it, or where it went since. The picture of the cloth is moved
//! along, as one body, by as much as its carrier is drawn away from its own interpolation, so that no seam opens beside
//! the pins; attached particles are put on their targets exactly.

use bevy::{
    math::{Affine3A, Isometry3d, Vec3},
    transform::components::GlobalTransform,
};

use super::super::{
    ClothFrame,
    attach::{Attached, rigid},
    components::ClothTick,
};

/// Where a cloth's frame and its targets were as a tick ended.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Places {
    frame: ClothFrame,
    targets: Vec<Affine3A>,
}

/// Places as of the last two ticks.
#[derive(Debug, Default)]
pub(super) struct Carriers {
    before: Places,
    now: Places,
}

impl Carriers {
    /// Takes over a tick's.
    pub fn follow(&mut self, frame: ClothFrame, tick: &ClothTick) {
        std::mem::swap(&mut self.before, &mut self.now);
        self.now.frame = frame;
        self.now.targets.clone_from(&tick.targets);
        // What jumps, or begins to be carried, does not come from anywhere.
        if tick.teleports || self.before.frame == ClothFrame::default() {
            self.before.frame = frame;
        }
        if tick.teleports || self.before.targets.len() != self.now.targets.len() {
            self.before.targets.clone_from(&self.now.targets);
        }
    }

    /// Whether anything that carries pins has moved in the last tick.
    fn moved(&self) -> bool {
        self.before != self.now
    }
}

/// How a cloth is drawn in a frame.
pub(super) struct Drawn<'a> {
    pub tick: &'a ClothTick,
    pub carriers: &'a Carriers,
    /// Where its entity is drawn.
    pub entity: GlobalTransform,
    /// Where the targets of its attachments are drawn, in their order; empty where it has none.
    pub targets: &'a [Affine3A],
    /// How much of the last tick has passed, from 0 to 1.
    pub fraction: f32,
}

impl Drawn<'_> {
    /// From the frame that the particles are given in to that of the entity, which the mesh is given in.
    pub fn to_entity(&self) -> Affine3A {
        let frame = self.carriers.now.frame;
        let moves = self.entity.affine() != frame.affine() || self.carriers.moved();
        match self.correction() {
            Some(correction) => {
                self.entity.affine().inverse() * Affine3A::from(correction * frame.isometry())
            }
            None if moves => self.entity.affine().inverse() * Affine3A::from(frame.isometry()),
            None => frame.to_entity(),
        }
    }

    /// How far what carries the pins is drawn from its interpolation, where that is anything and there are pins.
    fn correction(&self) -> Option<Isometry3d> {
        let Carriers { before, now } = self.carriers;
        if let (Some(was), Some(is), Some(drawn)) = (
            before.targets.first(),
            now.targets.first(),
            self.targets.first(),
        ) {
            let differs = was != is || drawn != is;
            return differs.then(|| self.beyond(rigid(was), rigid(is), rigid(drawn)));
        }
        let drawn = self.entity.affine();
        let differs = before.frame != now.frame || drawn != now.frame.affine();
        let (was, is) = (before.frame.isometry(), now.frame.isometry());
        (self.tick.pinned > 0 && differs).then(|| self.beyond(was, is, rigid(&drawn)))
    }

    fn beyond(&self, was: Isometry3d, is: Isometry3d, drawn: Isometry3d) -> Isometry3d {
        let between = Isometry3d::new(
            was.translation.lerp(is.translation, self.fraction),
            was.rotation.slerp(is.rotation, self.fraction),
        );
        drawn * between.inverse()
    }

    /// Puts pinned particles where they are drawn exactly, in the entity's frame.
    pub fn put_pins(&self, drawn: &mut [Vec3]) {
        if self.tick.rest.is_asleep() && !self.carriers.moved() {
            return;
        }
        let scale_out = self.carriers.now.frame.to_entity();
        for pin in &self.tick.pins {
            if let Some(place) = drawn.get_mut(pin.particle as usize) {
                *place = scale_out.transform_point3(pin.to);
            }
        }
        let from_world = self.entity.affine().inverse();
        for Attached {
            particle,
            attachment,
            offset,
        } in &self.tick.attached
        {
            if let (Some(target), Some(place)) = (
                self.targets.get(*attachment),
                drawn.get_mut(*particle as usize),
            ) {
                *place = from_world.transform_point3(target.transform_point3(*offset));
            }
        }
    }
}
