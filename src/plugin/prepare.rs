//! The first step of a tick: new cloths are built, every input is checked and taken over. One function after the other, each
//! with what it needs.

use bevy::{
    ecs::{
        change_detection::{DetectChanges, Mut, Ref},
        entity::Entity,
        query::{Has, QueryData},
        system::{Commands, Query, Res, ResMut},
    },
    math::{Isometry3d, Vec3},
    time::Time,
};

use super::{
    ClothAttachments, ClothBuilt, ClothFault, ClothFrame, ClothGravity, ClothPaused, ClothScratch,
    ClothSearch, ClothState, ClothStats, ClothTeleport,
    attach::{Targets, follow_targets},
    broad_phase::{clear_stats, reach, update_bounds},
    build::{Build, Wanted, build},
    components::BroadPhaseBounds,
    frame::global_transform,
    inputs::Inputs,
    naming::Part,
    shared::SharedParts,
    source::Sources,
};
use crate::{
    cloth::{Cloth, ClothError, ClothMaterial, ClothParticles, Pins},
    contact::{ClothSelfCollision, ContactSettings, NarrowPhase},
    hierarchy::SearchMethod,
    solver::{ClothSettings, DampingFrame, PinMotion, Substepping, TickStep},
};

/// Sub-steps of a cloth whose layers touch, unless it asks for a number of its own.
const FOR_LAYERS: u32 = 16;

/// The pins of a cloth from which the game took its [`Pins`].
static NO_PINS: Pins = Pins::none();

#[derive(QueryData)]
#[query_data(mutable)]
pub(super) struct Preparing {
    entity: Entity,
    cloth: Ref<'static, Cloth>,
    material: Option<&'static ClothMaterial>,
    pins: Option<&'static Pins>,
    attachments: Option<&'static ClothAttachments>,
    settings: Option<&'static ClothSettings>,
    method: Option<&'static SearchMethod>,
    narrow_phase: Option<&'static NarrowPhase>,
    self_collision: Option<&'static ClothSelfCollision>,
    particles: &'static mut ClothParticles,
    built: &'static mut ClothBuilt,
    state: &'static mut ClothState,
    scratch: &'static mut ClothScratch,
    frame: &'static mut ClothFrame,
    stats: &'static mut ClothStats,
    bounds: &'static mut BroadPhaseBounds,
    search: &'static mut ClothSearch,
    teleport: Option<&'static ClothTeleport>,
    is_paused: Has<ClothPaused>,
    fault: Option<&'static ClothFault>,
}

/// Prepares each cloth, or marks it with what is wrong.
pub(super) fn prepare_cloths(
    mut cloths: Query<Preparing>,
    targets: Targets,
    sources: Sources,
    mut parts: ResMut<SharedParts>,
    gravity: Res<ClothGravity>,
    time: Res<Time>,
    mut commands: Commands,
) {
    for mut cloth in &mut cloths {
        let inputs = Inputs::of(
            cloth.settings,
            cloth.material,
            cloth.method,
            cloth.narrow_phase,
            cloth.self_collision,
            gravity.0,
        );
        let outcome = inputs.and_then(|inputs| {
            let is_known = cloth.state.is_valid && cloth.built.matches(&cloth.particles);
            if cloth.is_paused && is_known {
                return Ok(());
            }
            if cloth.sleeps_as_it_was(&inputs, &targets, &sources, time.delta_secs()) {
                return Ok(());
            }
            // Nothing of an earlier tick is done again.
            cloth.scratch.forget_tick();
            cloth.prepare(&inputs, &targets, &sources, &mut parts, time.delta_secs())
        });
        cloth.state.is_valid = outcome.is_ok();
        if cloth.is_paused && outcome.is_ok() {
            cloth.pause();
        }
        if outcome.is_err() {
            cloth.scratch.forget_tick();
            cloth.bounds.takes_part = false;
            cloth.bounds.is_stale |= cloth.bounds.is_searched;
            cloth.bounds.is_searched = false;
            cloth.state.rest.disturb();
        }
        if cloth.teleport.is_some() && outcome.is_ok() {
            commands.entity(cloth.entity).try_remove::<ClothTeleport>();
        }
        // What is on its way is no fault.
        let outcome = match outcome {
            Err(ClothError::MeshLoading) => Ok(()),
            outcome => outcome,
        };
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
    /// Has nothing happen to the cloth in this tick. It goes on as it was, seen from where its entity is then.
    fn pause(&mut self) {
        if !self.state.was_paused {
            self.state.was_paused = true;
            self.scratch.forget_tick();
            self.bounds.takes_part = false;
            self.bounds.is_stale |= self.bounds.is_searched;
            self.bounds.is_searched = false;
            clear_stats(&mut self.stats, false);
            (self.stats.integrate_ms, self.stats.substeps) = (0.0, 0);
        }
    }

    /// Whether the cloth sleeps, and nothing that it was prepared with has changed since: then there is nothing to prepare.
    fn sleeps_as_it_was(
        &self,
        inputs: &Inputs,
        targets: &Targets,
        sources: &Sources,
        seconds: f32,
    ) -> bool {
        let (state, built) = (&*self.state, &*self.built);
        if !(state.rest.is_asleep() && state.is_valid && self.stats.is_asleep) {
            return false;
        }
        let acceleration = self.frame.isometry().rotation.inverse() * inputs.gravity;
        let known = (
            inputs.settings,
            inputs.search,
            inputs.narrow_phase,
            inputs.self_collision,
            acceleration,
        );
        let known_contact = (
            self.scratch.contact_settings.particle_radius,
            self.scratch.contact_settings.friction,
        );
        let source = built.source();
        let pins = self.pins.unwrap_or(&NO_PINS);
        // What may wake it in this tick goes on with the step that it would have been prepared with.
        let is_prepared =
            !state.was_paused && (self.scratch.step).is_some_and(|step| step.seconds == seconds);
        is_prepared
            && state.known == Some(known)
            && known_contact == (inputs.settings.particle_radius, inputs.material.friction)
            && state.written == Some(self.particles.last_changed())
            && state.attachments.is_empty()
            && self
                .attachments
                .is_none_or(|attachments| attachments.as_slice().is_empty())
            && self.teleport.is_none()
            && self.fault.is_none()
            && built.is_made_from(self.cloth.last_changed(), &inputs.material, pins)
            && sources.find(self.entity, &self.cloth, source) == Ok(source)
            && global_transform(&targets.transforms, self.entity)
                .is_ok_and(|transform| self.frame.is_of(&transform))
    }

    fn prepare(
        &mut self,
        inputs: &Inputs,
        targets: &Targets,
        sources: &Sources,
        parts: &mut SharedParts,
        seconds: f32,
    ) -> Result<(), ClothError> {
        let transform = global_transform(&targets.transforms, self.entity)?;
        let (frame, scale) = ClothFrame::of(&transform)?;
        let Inputs {
            settings, material, ..
        } = inputs;
        let attachments = self.attachments.map_or(&[][..], ClothAttachments::as_slice);
        let (particles, state) = (&mut self.particles, &mut *self.state);
        let (built, scratch) = (&mut *self.built, &mut *self.scratch);
        let known = built.source();
        let wanted = Wanted {
            cloth: &self.cloth,
            changed: self.cloth.last_changed(),
            source: sources.find(self.entity, &self.cloth, known)?,
            material,
            pins: self.pins.unwrap_or(&NO_PINS),
            attachments,
            scale,
        };
        let build = build(&wanted, sources, parts, particles, built, state)?;
        let before = *self.frame;
        if build == Build::New {
            *self.frame = frame;
        }
        // Who saves or restores particles may mark them as changed without a change.
        let was_written =
            state.written != Some(particles.last_changed()) && !state.rest.sleeps_as(particles);
        // A cloth that sleeps and that nobody wrote is what it was when it was looked at last.
        if was_written || !state.rest.is_asleep() {
            state.largest_speed = check_particles(particles)?;
        }
        let surface = built.surface().clone();
        if let Some(self_collision) = &inputs.self_collision {
            self_collision.validate(&surface)?;
        }
        targets.find(
            attachments,
            &state.attachments,
            &surface,
            &mut state.targets,
            &mut scratch.targets,
        )?;
        // It has stood still meanwhile, seen from its entity.
        let resumes = std::mem::take(&mut state.was_paused);
        scratch.teleports = self.teleport.is_some() || resumes;
        if scratch.teleports {
            *self.frame = frame;
        } else if seconds > 0.0 && *self.frame != frame {
            carry(
                particles,
                self.frame.isometry(),
                frame.isometry(),
                &mut scratch.pins,
            );
            state.rest.disturb();
            *self.frame = frame;
        }
        if seconds > 0.0 || build != Build::Kept || scratch.teleports {
            follow_targets(
                attachments,
                &scratch.targets,
                *self.frame,
                scratch.teleports.then_some(before),
                particles,
                built,
                state,
                &mut scratch.pins,
            );
        }
        if was_written || scratch.teleports {
            state.stretch = built.solver.measure(particles);
            built.masses = particles.free_masses();
            self.stats.stretch = state.stretch;
            if !built.solver.tethers().matches(particles) {
                built.forget_tethers();
            }
            state.rest.disturb();
        }
        let acceleration = self.frame.isometry().rotation.inverse() * inputs.gravity;
        built.tether(
            settings.tethers,
            material,
            particles,
            inputs.gravity.length(),
            &mut state.largest_gravity,
        );
        let known = Some((
            *settings,
            inputs.search,
            inputs.narrow_phase,
            inputs.self_collision,
            acceleration,
        ));
        if state.known != known || !scratch.pins.is_empty() || !settings.sleeps {
            state.known = known;
            state.rest.disturb();
        } else if !state.rest.is_asleep() {
            let scale = (surface.diagonal(), acceleration.length());
            let lies_on_cloth = inputs.self_collision.is_some() && state.touches_cloth;
            state.rest.observe(seconds, particles, scale, lies_on_cloth);
        }
        // The plugin's own writing, up to here.
        state.written = Some(particles.last_changed());
        built.solver.set_stretch_damping(material.stretch_damping);
        let along = surface.particles_along();
        let needed = match settings.substepping {
            // Nobody asks.
            _ if state.rest.is_asleep() => Substepping::needed(along, seconds),
            Substepping::Fixed(substeps) => substeps,
            _ => (built.solver).needed(particles, along, seconds, settings.order),
        };
        // Layers may come nearer in a sub-step by a part of their thickness alone.
        let needed = match inputs.self_collision {
            Some(_) if state.touches_cloth => needed.max(FOR_LAYERS),
            _ => needed,
        };
        if !state.rest.is_asleep() {
            // The tick says so again.
            state.touches_cloth = false;
        }
        scratch.step = Some(TickStep {
            seconds,
            substeps: state.control.substeps(settings.substepping, needed),
            acceleration,
            damping: material.damping,
            damped_against: carrier(&scratch.pins, built.pinned, seconds),
            order: settings.order,
            material_stretch: built.material_stretch,
        });
        scratch.substepping = settings.substepping;
        scratch.is_in_island = false;
        scratch.self_collision = inputs.self_collision;
        scratch.was_put = was_written || build != Build::Kept || scratch.teleports;
        if scratch.was_put {
            state.carriers.clear();
        }
        if inputs.self_collision.is_none() {
            scratch.mutual = None;
        } else if let Some(mutual) = &mut scratch.mutual
            && scratch.was_put
        {
            mutual.forget();
        }
        scratch.search = inputs.search;
        scratch.contact_settings = ContactSettings {
            particle_radius: settings.particle_radius,
            friction: material.friction,
            narrow_phase: inputs.narrow_phase,
            ..ContactSettings::default()
        };
        scratch.reach = reach(
            state,
            &surface,
            &scratch.pins,
            acceleration.length(),
            seconds,
        );
        update_bounds(
            particles,
            &self.frame,
            built,
            state,
            scratch,
            &mut self.search,
            &mut self.bounds,
        );
        clear_stats(&mut self.stats, state.rest.is_asleep());
        Ok(())
    }
}

/// The frame has moved: the particles stay where they are in the world, and their pins go along in the course of the tick.
fn carry(
    particles: &mut ClothParticles,
    old: Isometry3d,
    new: Isometry3d,
    motions: &mut Vec<PinMotion>,
) {
    let new_from_old = new.inverse() * old;
    for (index, inverse_mass) in particles.inverse_masses().enumerate() {
        if inverse_mass == 0.0 {
            let pinned_to = particles.position_at(index);
            motions.push(PinMotion {
                particle: index as u32,
                from: new_from_old * pinned_to,
                to: pinned_to,
            });
        }
    }
    particles.transform(new_from_old);
}

/// What damping is relative to: what a cloth of that many pins hangs by, in the mean of all of them; itself if it has none.
fn carrier(pins: &[PinMotion], pinned: usize, seconds: f32) -> DampingFrame {
    if pinned == 0 {
        return DampingFrame::CentreOfMass;
    }
    let moved: Vec3 = pins.iter().map(|pin| pin.to - pin.from).sum();
    if moved == Vec3::ZERO || seconds == 0.0 {
        return DampingFrame::Still;
    }
    DampingFrame::Moving(moved / (pinned as f32 * seconds))
}

/// The speed of the fastest particle (m/s), if all are valid.
fn check_particles(particles: &mut Mut<ClothParticles>) -> Result<f32, ClothError> {
    let survey = particles.survey();
    if survey.is_valid {
        return Ok(survey.largest_speed);
    }
    particles.validate()?;
    // What was not valid has been mended, but for what it left beside the particles.
    particles.clear_padding();
    Ok(particles.survey().largest_speed)
}
