//! The first step of a tick: new cloths are built, every input is checked and taken over. One function after the other, each
//! with what it needs.

use bevy::{
    ecs::{
        change_detection::{DetectChanges, Mut, Ref},
        entity::Entity,
        query::{QueryData, With, Without},
        system::{Commands, Query, Res, ResMut, SystemParam},
    },
    math::Vec3,
    time::Time,
};

use super::{
    ClothAir, ClothAttachments, ClothBuilt, ClothContacts, ClothFault, ClothFrame, ClothGravity,
    ClothScratch, ClothSearch, ClothState, ClothStats, ClothTeleport,
    attach::{Targets, follow_targets},
    broad_phase::{clear_stats, reach, update_bounds},
    build::{Wanted, build},
    carry::{carry, new_from_old},
    components::BroadPhaseBounds,
    frame::global_transform,
    freeze::{stand, thaw},
    inertia::Roots,
    inputs::Inputs,
    lod::{ClothLod, GlobalClothLod},
    lod_state::Turn,
    naming::Part,
    shared::SharedParts,
    skin::{Skins, move_with_pose, place_pose},
    source::Sources,
    wind::{Breeze, WindField},
};
use crate::{
    cloth::{Cloth, ClothError, ClothMaterial, ClothParticles, ClothSkin, Pins},
    contact::{ClothSelfCollision, ContactSettings, NarrowPhase},
    hierarchy::SearchMethod,
    solver::{ClothPressure, ClothSettings, Substepping, TickStep},
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
    skin: Option<Ref<'static, ClothSkin>>,
    settings: Option<&'static ClothSettings>,
    method: Option<&'static SearchMethod>,
    narrow_phase: Option<&'static NarrowPhase>,
    self_collision: Option<&'static ClothSelfCollision>,
    air: Option<&'static ClothAir>,
    pressure: Option<&'static ClothPressure>,
    lod: Option<&'static ClothLod>,
    particles: &'static mut ClothParticles,
    built: &'static mut ClothBuilt,
    state: &'static mut ClothState,
    scratch: &'static mut ClothScratch,
    frame: &'static mut ClothFrame,
    stats: &'static mut ClothStats,
    bounds: &'static mut BroadPhaseBounds,
    search: &'static mut ClothSearch,
    contacts: &'static mut ClothContacts,
    teleport: Option<&'static ClothTeleport>,
    fault: Option<&'static ClothFault>,
}

/// What a cloth is prepared with, besides its own components.
#[derive(SystemParam)]
pub(super) struct Surroundings<'w, 's> {
    targets: Targets<'w, 's>,
    sources: Sources<'w, 's>,
    skins: Skins<'w, 's>,
    roots: Roots<'w, 's>,
    field: Res<'w, WindField>,
    /// What takes others along.
    teleports: Query<'w, 's, Entity, (With<ClothTeleport>, Without<Cloth>)>,
}

/// Prepares each cloth, or marks it with what is wrong.
pub(super) fn prepare_cloths(
    mut cloths: Query<Preparing>,
    around: Surroundings,
    mut parts: ResMut<SharedParts>,
    gravity: Res<ClothGravity>,
    global_lod: Option<Res<GlobalClothLod>>,
    time: Res<Time>,
    mut commands: Commands,
) {
    for entity in &around.teleports {
        commands.entity(entity).try_remove::<ClothTeleport>();
    }
    let global_lod = global_lod.as_ref().map(|global| &global.0);
    for mut cloth in &mut cloths {
        let level = cloth.state.lod.level;
        if cloth.stats.level != level {
            cloth.stats.level = level;
        }
        if cloth.state.lod.turn == Turn::Wait {
            cloth.pass();
            continue;
        }
        let (seconds, ticks) = cloth.state.lod.take(time.delta_secs());
        let inputs = Inputs::of(
            cloth.settings,
            cloth.material,
            cloth.method,
            cloth.narrow_phase,
            cloth.self_collision,
            gravity.0,
        );
        let lod = cloth.lod.or(global_lod);
        let inputs = lod.map_or(Ok(()), ClothLod::validate).and(inputs);
        let outcome = inputs.and_then(|inputs| {
            if cloth.state.lod.turn == Turn::Stand {
                cloth.pass();
                return cloth.stand(&around.targets);
            }
            let breeze = around.field.of_cloth(cloth.air)?;
            if cloth.sleeps_as_it_was(&inputs, &around, &breeze, seconds) {
                return Ok(());
            }
            // Nothing of an earlier tick is done again.
            cloth.scratch.forget_tick();
            let seconds = (seconds, ticks);
            cloth.prepare(&inputs, &around, breeze, &mut parts, seconds)
        });
        cloth.state.is_valid = outcome.is_ok();
        if outcome.is_err() {
            cloth.scratch.forget_tick();
            cloth.bounds.leave_out();
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
    /// Lets the tick pass without the cloth.
    fn pass(&mut self) {
        self.scratch.forget_tick();
        self.bounds.leave_out();
        clear_stats(&mut self.stats, false);
        (self.stats.integrate_ms, self.stats.substeps) = (0.0, 0);
        self.stats.is_asleep = false;
    }

    /// Has the cloth keep its shape, and go with what carries it.
    fn stand(&mut self, targets: &Targets) -> Result<(), ClothError> {
        if self.state.written != Some(self.particles.last_changed()) {
            check_particles(&mut self.particles)?;
        }
        self.contacts.clear();
        let (frame, state) = (&mut self.frame, &mut *self.state);
        stand(self.entity, targets, frame, &mut self.particles, state)
    }

    /// Whether the cloth sleeps, and nothing that it was prepared with has changed since: then there is nothing to prepare.
    fn sleeps_as_it_was(
        &self,
        inputs: &Inputs,
        around: &Surroundings,
        breeze: &Option<Breeze>,
        seconds: f32,
    ) -> bool {
        let Surroundings {
            targets,
            sources,
            field,
            ..
        } = around;
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
        let is_prepared = (self.scratch.step).is_some_and(|step| step.seconds == seconds);
        is_prepared
            && state.known == Some(known)
            && known_contact == (inputs.settings.particle_radius, inputs.material.friction)
            && state.written == Some(self.particles.last_changed())
            && state.attachments.is_empty()
            && self
                .attachments
                .is_none_or(|attachments| attachments.as_slice().is_empty())
            && self.teleport.is_none()
            && !around.roots.jumps(self.entity)
            && self.is_in_same_pose(around)
            && self.fault.is_none()
            && built.is_made_from(self.cloth.last_changed(), &inputs.material, pins)
            && sources.find(self.entity, &self.cloth, source) == Ok(source)
            && (state.air).is_still(breeze.as_ref(), self.pressure, field, || {
                ball(built, &self.particles, state.stretch.bound, &self.frame)
            })
            && global_transform(&targets.transforms, self.entity)
                .is_ok_and(|transform| self.frame.is_of(&transform))
    }

    /// Whether the pose that it follows is what it was in the last tick, or it follows none.
    fn is_in_same_pose(&self, around: &Surroundings) -> bool {
        let place = |joint| global_transform(&around.targets.transforms, joint).ok();
        match (&self.skin, &self.built.skin) {
            (None, None) => true,
            (Some(skin), Some(known)) => {
                skin.last_changed() == known.changed
                    && (around.skins).are_at(self.entity, place, &self.state.pose.joints)
            }
            _ => false,
        }
    }

    fn prepare(
        &mut self,
        inputs: &Inputs,
        around: &Surroundings,
        breeze: Option<Breeze>,
        parts: &mut SharedParts,
        (seconds, ticks): (f32, u32),
    ) -> Result<(), ClothError> {
        let Surroundings {
            targets,
            sources,
            field,
            ..
        } = around;
        let transform = global_transform(&targets.transforms, self.entity)?;
        let (frame, mut scale) = ClothFrame::of(&transform)?;
        let Inputs {
            settings, material, ..
        } = inputs;
        let attachments = self.attachments.map_or(&[][..], ClothAttachments::as_slice);
        let (particles, state) = (&mut self.particles, &mut *self.state);
        let (built, scratch) = (&mut *self.built, &mut *self.scratch);
        if self.skin.is_some() {
            let place = |joint| global_transform(&targets.transforms, joint).ok();
            (around.skins).read(self.entity, place, &mut scratch.pose.joints)?;
            // How large it is in the world is the skeleton's matter.
            scale = scratch.pose.scale().unwrap_or(scale);
        }
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
        let is_new = built.from.is_some() || particles.is_empty();
        let was_built = build(&wanted, sources, parts, particles, built, state)?;
        let before = *self.frame;
        if !was_built {
            *self.frame = frame;
        }
        let begins = !was_built && is_new;
        let skin = self.skin.as_ref();
        place_pose(
            skin, sources, &frame, begins, particles, built, state, scratch,
        )?;
        // What was at fault may have been put anywhere meanwhile.
        let jumps = self.teleport.is_some() || around.roots.jumps(self.entity) || !state.is_valid;
        let has_stood = thaw(targets, frame, (seconds, jumps), before, particles, state);
        // Who saves or restores particles may mark them as changed without a change.
        let was_written = has_stood
            || state.written != Some(particles.last_changed()) && !state.rest.sleeps_as(particles);
        // A cloth that sleeps and that nobody wrote is what it was when it was looked at last.
        if was_written || !state.rest.is_asleep() {
            state.largest_speed = check_particles(particles)?;
        }
        let surface = built.surface().clone();
        if let Some(self_collision) = &inputs.self_collision {
            self_collision.validate(&surface)?;
        }
        if let Some(pressure) = self.pressure {
            pressure.validate(&surface)?;
        }
        targets.find(
            attachments,
            &state.attachments,
            &surface,
            &mut state.targets,
            &mut scratch.targets,
        )?;
        let target = state.targets.first().copied();
        let roots = &around.roots;
        scratch.carried = match seconds > 0.0 && was_built {
            true => roots.carry(self.entity, target)?,
            false => None,
        };
        let new_from_old = new_from_old([&*self.frame, &frame], scratch.carried.as_ref());
        let is_moved = new_from_old.is_some();
        let new_from_old = new_from_old.unwrap_or_default();
        scratch.teleports = self.teleport.is_some()
            || roots.jumps(self.entity)
            || target.is_some_and(|target| roots.jumps(target));
        if let Some(skin) = &self.skin
            && seconds > 0.0
            && was_built
        {
            let way = scratch.pose.farthest_from(&state.pose, new_from_old);
            scratch.teleports |= way > skin.teleport_distance;
        }
        if scratch.teleports {
            scratch.carried = None;
            *self.frame = frame;
        } else if seconds > 0.0 && is_moved {
            carry(particles, new_from_old, &mut scratch.pins);
            state.rest.disturb();
            *self.frame = frame;
        }
        if seconds > 0.0 || !was_built || scratch.teleports {
            move_with_pose(
                [&before, &frame],
                new_from_old,
                was_built,
                particles,
                built,
                state,
                scratch,
            );
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
        );
        let known = Some((
            *settings,
            inputs.search,
            inputs.narrow_phase,
            inputs.self_collision,
            acceleration,
        ));
        let ball = || ball(built, particles, state.stretch.bound, &self.frame);
        let pressure = self.pressure;
        let is_still = state.air.is_still(breeze.as_ref(), pressure, field, ball);
        state.air.renew(breeze, pressure.copied(), field, ball);
        if state.known != known || !is_still || !scratch.pins.is_empty() || !settings.sleeps {
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
        if !state.rest.is_asleep() {
            let surface = &*surface;
            (state.air).set(&mut built.solver, surface, particles, &self.frame, field);
        }
        let along = surface.particles_along();
        // A tick that stands for several has as many as one: that is what it saves.
        let one = seconds / ticks as f32;
        let needed = match settings.substepping {
            // Nobody asks.
            _ if state.rest.is_asleep() => Substepping::needed(along, one),
            Substepping::Fixed(substeps) => substeps,
            _ => (built.solver).needed(particles, along, one, settings.order),
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
            order: settings.order,
            material_stretch: built.material_stretch,
        });
        scratch.substepping = settings.substepping;
        scratch.is_in_island = false;
        scratch.self_collision = inputs.self_collision;
        scratch.was_put = was_written || !was_built || scratch.teleports;
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
            acceleration.length()
                + state
                    .air
                    .acceleration(material, state.largest_speed, seconds),
            seconds,
        ) + scratch.constraints.travel();
        state.lod.reach = scratch.reach;
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

/// What is around a cloth in the world: a middle, and a radius (m).
fn ball(
    built: &ClothBuilt,
    particles: &ClothParticles,
    stretch: f32,
    frame: &ClothFrame,
) -> (Vec3, f32) {
    let root = built.tree().root_sphere(particles, stretch);
    (frame.to_world(root.center.into()), root.radius())
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
