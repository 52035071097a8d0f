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
    fault::Part, frame::global_transform,
};
use crate::{
    cloth::{
        Cloth, ClothError, ClothGrid, ClothMaterial, ClothParticles, Pins, SpringKind, Springs,
    },
    hierarchy::{BoundRule, QuadTree},
    solver::{ClothSettings, PinMotion, Stretch, TickStep},
};

/// The pins of a cloth from which the game took its [`Pins`]. In place of other components the defaults count.
static NO_PINS: Pins = Pins::none();

#[derive(QueryData)]
#[query_data(mutable)]
pub(super) struct Preparing {
    entity: Entity,
    cloth: &'static Cloth,
    material: Option<&'static ClothMaterial>,
    pins: Option<&'static Pins>,
    settings: Option<&'static ClothSettings>,
    rule: Option<&'static BoundRule>,
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
        cloth.tick.sound = outcome.is_ok();
        ClothFault::report(
            &mut commands,
            cloth.entity,
            cloth.fault,
            Part::Cloth,
            outcome,
        );
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
        let settings = self.settings.copied().unwrap_or_default();
        let material = self.material.copied().unwrap_or_default();
        settings.validate()?;
        let gravity = settings.gravity.unwrap_or(gravity);
        for value in gravity.to_array() {
            ClothError::check(value, f32::is_finite, "gravity (m/s²)", "finite")?;
        }
        let was_woven = self.weave(&material, scale)?;
        self.particles.validate()?;
        self.tick.pins.clear();
        if !was_woven {
            *self.frame = frame;
        } else if seconds > 0.0 && *self.frame != frame {
            self.carry(self.frame.isometry(), frame.isometry());
            *self.frame = frame;
        }
        if self.tick.written != Some(self.particles.last_changed()) {
            self.tick.stretch = Stretch::measure(&self.topology.springs, &self.particles);
            self.stats.stretch = self.tick.stretch;
            self.tick.written = Some(self.particles.last_changed());
        }
        let acceleration = self.frame.isometry().rotation.inverse() * gravity;
        self.tick.step = Some(TickStep {
            seconds,
            substeps: settings.substeps,
            acceleration,
            damping: material.damping,
        });
        self.tick.rule = self.rule.copied().unwrap_or_default();
        self.tick.friction = material.friction;
        self.tick.particle_radius = settings.particle_radius;
        self.tick.reach = self.reach(acceleration.length(), seconds);
        Ok(())
    }

    /// How far a particle may get in the tick by itself (m): by its speed and gravity, by what carries its
    /// neighbours' pins, and by what a spring that is stretched now gives back.
    fn reach(&self, acceleration: f32, seconds: f32) -> f32 {
        let carried = self.tick.pins.iter().map(|pin| pin.from.distance(pin.to));
        let longest_spring = self.topology.grid.spacing().length();
        (self.particles.largest_speed() + acceleration * seconds) * seconds
            + carried.fold(0.0, f32::max)
            + self.tick.stretch.bound * longest_spring
    }

    /// Builds what does not exist yet or was made from other components than those present. Returns whether
    /// the cloth had been woven before. Changes nothing on an error.
    fn weave(&mut self, material: &ClothMaterial, scale: Vec3) -> Result<bool, ClothError> {
        let woven = self.topology.woven.as_ref();
        let was_woven =
            woven.is_some_and(|(cloth, ..)| cloth == self.cloth) && !self.particles.is_empty();
        if was_woven {
            self.follow_changes(material)?;
        } else {
            self.weave_anew(material, scale)?;
        }
        Ok(was_woven)
    }

    fn weave_anew(&mut self, material: &ClothMaterial, scale: Vec3) -> Result<(), ClothError> {
        let pins = self.pins.unwrap_or(&NO_PINS);
        let grid = self.cloth.grid(scale)?;
        material.validate()?;
        pins.validate(&grid)?;
        // Particles that came with a newly spawned cloth are kept; those of another grid are not.
        let mut particles = if self.topology.woven.is_some() || self.particles.is_empty() {
            ClothParticles::at_rest(&grid, material)?
        } else {
            check_count(&self.particles, &grid)?;
            self.particles.clone()
        };
        particles.weigh(&grid, material, pins)?;
        let springs = Springs::of_grid(&grid, material);
        let tree = QuadTree::of_grid(&grid, springs.has(SpringKind::Shear));
        *self.particles = particles;
        *self.topology = ClothTopology {
            grid,
            springs,
            tree,
            woven: Some((*self.cloth, *material, pins.clone())),
        };
        Ok(())
    }

    /// Takes over another material or other pins: masses, springs and tree only where they change, so that a
    /// mass that the game has set outlasts a change of damping.
    fn follow_changes(&mut self, material: &ClothMaterial) -> Result<(), ClothError> {
        let pins = self.pins.unwrap_or(&NO_PINS);
        let topology = &mut *self.topology;
        check_count(&self.particles, &topology.grid)?;
        let Some((_, was, were_pinned)) = &mut topology.woven else {
            return Ok(());
        };
        if was == material && were_pinned == pins {
            return Ok(());
        }
        material.validate()?;
        if was.areal_density != material.areal_density || were_pinned != pins {
            self.particles.weigh(&topology.grid, material, pins)?;
        }
        let compliances = |of: &ClothMaterial| {
            [
                of.stretch_compliance,
                of.shear_compliance,
                of.bend_compliance,
            ]
        };
        if compliances(was) != compliances(material) {
            let had_diagonals = topology.springs.has(SpringKind::Shear);
            topology.springs = Springs::of_grid(&topology.grid, material);
            let has_diagonals = topology.springs.has(SpringKind::Shear);
            if had_diagonals != has_diagonals {
                topology.tree = QuadTree::of_grid(&topology.grid, has_diagonals);
            }
            // The stretch that bounds rely on is measured over other springs now.
            self.tick.written = None;
        }
        (*was, *were_pinned) = (*material, pins.clone());
        Ok(())
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

/// Whether the particles are as many as the grid has, in as many columns.
fn check_count(particles: &ClothParticles, grid: &ClothGrid) -> Result<(), ClothError> {
    if particles.fit(grid) {
        return Ok(());
    }
    Err(ClothError::ParticleCount {
        expected: grid.len(),
        found: particles.len(),
    })
}
