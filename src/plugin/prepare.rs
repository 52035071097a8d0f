//! The first step of a tick: new cloths are woven, every input is checked and taken over.

use bevy::{
    ecs::{
        change_detection::DetectChanges,
        entity::Entity,
        query::QueryData,
        system::{Commands, Query, Res},
    },
    math::{Isometry3d, Vec3},
    time::Time,
    transform::{components::GlobalTransform, helper::TransformHelper},
};

use super::{
    ClothFault, ClothFrame, ClothGravity, ClothStats, ClothTopology, components::ClothTick,
    frame::global_transform,
};
use crate::{
    cloth::{Cloth, ClothError, ClothMaterial, ClothParticles, Pins, SpringKind, Springs},
    hierarchy::QuadTree,
    solver::{ClothSettings, PinMotion, Stretch, TickStep},
};

#[derive(QueryData)]
#[query_data(mutable)]
pub(super) struct Preparing {
    entity: Entity,
    cloth: &'static Cloth,
    material: &'static ClothMaterial,
    pins: &'static Pins,
    settings: &'static ClothSettings,
    particles: &'static mut ClothParticles,
    topology: &'static mut ClothTopology,
    frame: &'static mut ClothFrame,
    stats: &'static mut ClothStats,
    tick: &'static mut ClothTick,
    fault: Option<&'static ClothFault>,
}

/// Prepares each cloth, or marks it with what is wrong.
pub(super) fn prepare_cloths(
    mut cloths: Query<Preparing>,
    transforms: TransformHelper,
    gravity: Res<ClothGravity>,
    time: Res<Time>,
    mut commands: Commands,
) {
    for mut cloth in &mut cloths {
        let outcome = global_transform(&transforms, cloth.entity)
            .and_then(|transform| cloth.prepare(&transform, gravity.0, time.delta_secs()));
        ClothFault::report(&mut commands, cloth.entity, cloth.fault, outcome);
    }
}

impl PreparingItem<'_, '_> {
    fn prepare(
        &mut self,
        transform: &GlobalTransform,
        gravity: Vec3,
        seconds: f32,
    ) -> Result<(), ClothError> {
        let (frame, scale) = ClothFrame::of(transform)?;
        self.settings.validate()?;
        let gravity = self.settings.gravity.unwrap_or(gravity);
        for value in gravity.to_array() {
            ClothError::check(value, f32::is_finite, "gravity (m/s²)", "finite")?;
        }
        let was_woven = self.weave(scale)?;
        self.particles.validate()?;
        self.tick.pins.clear();
        if !was_woven {
            *self.frame = frame;
        } else if seconds > 0.0 && *self.frame != frame {
            self.carry(self.frame.isometry(), frame.isometry());
            *self.frame = frame;
        }
        if self.tick.written != Some(self.particles.last_changed()) {
            self.stats.stretch = Stretch::measure(&self.topology.springs, &self.particles);
            self.tick.written = Some(self.particles.last_changed());
        }
        let acceleration = self.frame.isometry().rotation.inverse() * gravity;
        self.tick.step = TickStep {
            seconds,
            substeps: self.settings.substeps,
            acceleration,
            damping: self.material.damping,
        };
        let carried = self
            .tick
            .pins
            .iter()
            .map(|pin| pin.from.distance(pin.to))
            .fold(0.0, f32::max);
        self.tick.reach =
            (self.particles.largest_speed() + acceleration.length() * seconds) * seconds + carried;
        Ok(())
    }

    /// Builds what does not exist yet or was made from other components than those present. Returns whether
    /// the cloth had been woven before. Changes nothing on an error.
    fn weave(&mut self, scale: Vec3) -> Result<bool, ClothError> {
        let (cloth, material, pins) = (self.cloth, self.material, self.pins);
        let same_cloth = self
            .topology
            .woven
            .as_ref()
            .map(|(woven, ..)| woven == cloth);
        if same_cloth != Some(true) || self.particles.is_empty() {
            let grid = cloth.grid(scale)?;
            material.validate()?;
            // Particles that came with a newly spawned cloth are kept; those of another grid are not.
            let mut particles = if same_cloth.is_some() || self.particles.is_empty() {
                ClothParticles::at_rest(&grid, material)?
            } else {
                self.particles.clone()
            };
            if (particles.len(), particles.columns()) != (grid.len(), grid.columns()) {
                let (expected, found) = (grid.len(), particles.len());
                return Err(ClothError::ParticleCount { expected, found });
            }
            particles.weigh(&grid, material, pins)?;
            let springs = Springs::of_grid(&grid, material);
            let tree = QuadTree::of_grid(&grid, springs.has(SpringKind::Shear));
            *self.particles = particles;
            let woven = Some((*cloth, *material, pins.clone()));
            *self.topology = ClothTopology {
                grid,
                springs,
                tree,
                woven,
            };
            return Ok(false);
        }
        let grid = self.topology.grid;
        if (self.particles.len(), self.particles.columns()) != (grid.len(), grid.columns()) {
            let (expected, found) = (grid.len(), self.particles.len());
            return Err(ClothError::ParticleCount { expected, found });
        }
        let made_from = self.topology.woven.as_ref();
        if made_from.is_none_or(|(_, woven, pinned)| woven != material || pinned != pins) {
            material.validate()?;
            self.particles.weigh(&grid, material, pins)?;
            self.topology.springs = Springs::of_grid(&grid, material);
            let diagonals = self.topology.springs.has(SpringKind::Shear);
            self.topology.tree = QuadTree::of_grid(&grid, diagonals);
            self.topology.woven = Some((*cloth, *material, pins.clone()));
        }
        Ok(true)
    }

    /// The frame has moved: the particles stay where they are in the world, and their pins go along in the
    /// course of the tick.
    fn carry(&mut self, old: Isometry3d, new: Isometry3d) {
        let new_from_old = new.inverse() * old;
        let columns = self.particles.columns_mut();
        let state = columns.position.iter_mut().zip(columns.displacement);
        for (index, ((position, displacement), &inverse_mass)) in
            state.zip(columns.inverse_mass).enumerate()
        {
            let pinned_to = *position;
            *position = new_from_old * *position;
            *displacement = new_from_old.rotation * *displacement;
            if inverse_mass == 0.0 {
                self.tick.pins.push(PinMotion {
                    particle: index as u32,
                    from: *position,
                    to: pinned_to,
                });
            }
        }
    }
}
