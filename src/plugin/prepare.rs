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

use super::search::cover;
use super::{
    ClothAttachments, ClothFault, ClothFrame, ClothGravity, ClothSearch, ClothStats, ClothTeleport,
    ClothTopology,
    components::{ClothTick, Vicinity},
    fault::Part,
    frame::global_transform,
};
use crate::{
    cloth::{Cloth, ClothError, ClothMaterial, ClothParticles, Pins},
    contact::{NarrowPhase, Terms},
    hierarchy::{SearchMethod, SearchReason},
    solver::{ClothSettings, PinMotion, TickStep},
};

#[derive(QueryData)]
#[query_data(mutable)]
pub(super) struct Preparing {
    entity: Entity,
    pub(super) cloth: &'static Cloth,
    material: Option<&'static ClothMaterial>,
    pub(super) pins: Option<&'static Pins>,
    pub(super) attachments: Option<&'static ClothAttachments>,
    settings: Option<&'static ClothSettings>,
    method: Option<&'static SearchMethod>,
    narrow_phase: Option<&'static NarrowPhase>,
    pub(super) particles: &'static mut ClothParticles,
    pub(super) topology: &'static mut ClothTopology,
    pub(super) frame: &'static mut ClothFrame,
    stats: &'static mut ClothStats,
    pub(super) tick: &'static mut ClothTick,
    vicinity: &'static mut Vicinity,
    search: &'static mut ClothSearch,
    teleport: Option<&'static ClothTeleport>,
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
        let outcome = global_transform(&transforms, cloth.entity).and_then(|transform| {
            cloth.prepare(&transform, &transforms, gravity.0, time.delta_secs())
        });
        cloth.tick.sound = outcome.is_ok();
        if outcome.is_err() {
            cloth.vicinity.takes_part = false;
            cloth.vicinity.is_stale |= cloth.vicinity.is_searched;
            cloth.vicinity.is_searched = false;
        }
        if outcome.is_err() {
            cloth.tick.rest.disturb();
        }
        if cloth.teleport.is_some() && outcome.is_ok() {
            commands.entity(cloth.entity).try_remove::<ClothTeleport>();
        }
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
        transforms: &TransformHelper,
        gravity: Vec3,
        seconds: f32,
    ) -> Result<(), ClothError> {
        // Whatever is wrong, nothing of an earlier tick is done again.
        self.tick.step = None;
        self.tick.pins.clear();
        let (frame, scale) = ClothFrame::of(transform)?;
        let settings = self.settings.copied().unwrap_or_default();
        let material = self.material.copied().unwrap_or_default();
        settings.validate()?;
        let search = self.method.copied().unwrap_or_default();
        search.validate()?;
        let narrow_phase = self.narrow_phase.copied().unwrap_or_default();
        let gravity = settings.gravity.unwrap_or(gravity);
        for value in gravity.to_array() {
            ClothError::check(value, f32::is_finite, "gravity (m/s²)", "finite")?;
        }
        let was_woven = self.weave(&material, scale)?;
        let before = *self.frame;
        if !was_woven {
            *self.frame = frame;
        }
        // Who saves or restores particles may mark them as changed without a change.
        let was_written = self.tick.written != Some(self.particles.last_changed())
            && !self.tick.rest.sleeps_as(&self.particles);
        // A cloth that sleeps and that nobody wrote is what it was when it was looked at last.
        if was_written || !self.tick.rest.is_asleep() {
            self.tick.largest_speed = self.look_at_particles()?;
        }
        self.find_targets(transforms)?;
        let teleports = self.teleport.is_some();
        self.tick.teleports = teleports;
        if teleports {
            *self.frame = frame;
        } else if seconds > 0.0 && *self.frame != frame {
            self.carry(self.frame.isometry(), frame.isometry());
            *self.frame = frame;
        }
        if seconds > 0.0 || !was_woven || teleports {
            self.follow_targets(teleports.then_some(before));
        }
        if was_written || teleports {
            self.tick.stretch = self.tick.solver.measure(&self.particles);
            self.tick.masses = self.particles.free_masses();
            self.stats.stretch = self.tick.stretch;
            if !self.tick.solver.tethers().are_of(&self.particles) {
                self.tick.tethered = None;
            }
            self.tick.rest.disturb();
        }
        let acceleration = self.frame.isometry().rotation.inverse() * gravity;
        self.tether(settings.tethers, &material, gravity.length());
        let known = Some((settings, search, narrow_phase, acceleration));
        if self.tick.known != known || !self.tick.pins.is_empty() || !settings.sleeps {
            self.tick.known = known;
            self.tick.rest.disturb();
        } else if !self.tick.rest.is_asleep() {
            let diagonal = self.topology.grid.diagonal();
            let pull = acceleration.length();
            let rest = &mut self.tick.rest;
            rest.observe(seconds, &self.particles, diagonal, pull);
        }
        // The plugin's own writing, up to here.
        self.tick.written = Some(self.particles.last_changed());
        self.tick.step = Some(TickStep {
            seconds,
            substeps: self.tick.control.substeps(settings.precision),
            acceleration,
            damping: material.damping,
        });
        self.tick.precision = settings.precision;
        self.tick.search = search;
        self.tick.terms = Terms {
            particle_radius: settings.particle_radius,
            friction: material.friction,
            narrow_phase,
            ..Terms::default()
        };
        self.tick.reach = self.reach(acceleration.length(), seconds);
        self.look_around();
        Ok(())
    }

    /// How far around the cloth anything may be touched in the tick. Nothing is near until it is found to be.
    fn look_around(&mut self) {
        let expected = self.tick.reach;
        let ClothTick {
            terms,
            stretch,
            rest,
            near,
            detection,
            ..
        } = &mut *self.tick;
        let root = self
            .topology
            .tree
            .root_sphere(&self.particles, stretch.bound);
        let centre = self.frame.to_world(root.center.into());
        let around =
            expected + terms.particle_radius + cover(terms, stretch.bound, &self.topology.grid);
        let is_asleep = rest.is_asleep();
        // Its colliders stay those that it fell asleep on.
        let listens = is_asleep && !detection.touches().is_empty();
        let mut is_stale = self.vicinity.is_searched || self.vicinity.is_stale;
        if !is_asleep {
            near.clear();
            detection.begin(expected);
            if is_stale {
                self.search.query.clear();
                is_stale = false;
            }
        }
        *self.vicinity = Vicinity {
            centre,
            radius: (root.radius() + around) * (1.0 + 1.0e-5) + centre.length() * 1.0e-5,
            takes_part: true,
            listens,
            is_searched: false,
            is_stale,
        };
        self.stats.search = SearchMethod::Auto;
        self.stats.reason = if is_asleep {
            SearchReason::Asleep
        } else {
            SearchReason::NothingNear
        };
        (self.stats.rebuild_ms, self.stats.query_ms) = (0.0, 0.0);
        (self.stats.nodes_visited, self.stats.leaf_tests) = (0, 0);
        (self.stats.colliders_near, self.stats.by_triangles) = (0, 0);
        self.stats.requeries = 0;
    }

    /// The speed of the fastest particle (m/s), if all are sound.
    fn look_at_particles(&mut self) -> Result<f32, ClothError> {
        let survey = self.particles.survey();
        if survey.is_sound {
            return Ok(survey.largest_speed);
        }
        self.particles.validate()?;
        // What was not sound has been mended, but for what it left beside the particles.
        self.particles.clear_padding();
        Ok(self.particles.survey().largest_speed)
    }

    /// How far a particle may get in the tick by itself (m): by its speed and gravity, by what carries its
    /// neighbours' pins, and by what a spring that is stretched now gives back.
    fn reach(&self, acceleration: f32, seconds: f32) -> f32 {
        let carried = self.tick.pins.iter().map(|pin| pin.from.distance(pin.to));
        let longest_spring = self.topology.grid.spacing().length();
        (self.tick.largest_speed + acceleration * seconds) * seconds
            + carried.fold(0.0, f32::max)
            + self.tick.stretch.bound * longest_spring
    }

    /// The frame has moved: the particles stay where they are in the world, and their pins go along in the
    /// course of the tick.
    fn carry(&mut self, old: Isometry3d, new: Isometry3d) {
        let new_from_old = new.inverse() * old;
        self.tick.rest.disturb();
        let tick = &mut *self.tick;
        for (index, inverse_mass) in self.particles.inverse_masses().enumerate() {
            if inverse_mass == 0.0 {
                let pinned_to = self.particles.position_at(index);
                tick.pins.push(PinMotion {
                    particle: index as u32,
                    from: new_from_old * pinned_to,
                    to: pinned_to,
                });
            }
        }
        self.particles.transform(new_from_old);
    }
}
