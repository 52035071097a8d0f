//! The first step of a tick: builds new cloths, and checks and takes over every input.

use bevy::prelude::{Commands, DetectChanges, Mut, Query, Res, ResMut, Time};

use super::{
    asleep::sleeps_as_it_was,
    attach::follow_targets,
    broad_phase::clear_stats,
    build_inputs::{Build, BuildInputs, Building},
    carry::{carry, jump, new_from_old},
    freeze::{freeze, thaw},
    notice::notice_new,
    preparing::{PrepareQuery, PrepareQueryItem, Surroundings},
    skin::{move_with_pose, place_pose, stand_in_pose},
    step::{prepare_contact, prepare_step, see_whether_it_rests},
};
use crate::{
    cloth::{ClothError, ClothParticles},
    plugin::{
        authoring::{ClothGravity, ClothLod, ClothLodLevel, ClothTeleport, GlobalClothLod},
        frame::ClothFrame,
        naming::Part,
        state::{ClothFault, GameForces, Inputs, LodAction, Notices, SharedParts},
    },
};

/// Prepares each cloth, or marks it with a fault.
pub(crate) fn prepare_cloths(
    mut cloths: Query<PrepareQuery>,
    around: Surroundings,
    (mut parts, mut notices): (ResMut<SharedParts>, ResMut<Notices>),
    gravity: Res<ClothGravity>,
    global_lod: Option<Res<GlobalClothLod>>,
    time: Res<Time>,
    mut commands: Commands,
) {
    for entity in &around.teleports {
        commands.entity(entity).try_remove::<ClothTeleport>();
    }
    parts.builds.begin_tick();
    let global_lod = global_lod.as_ref().map(|global| &global.0);
    for mut cloth in &mut cloths {
        let level = cloth.state.lod.level;
        if cloth.stats.level != level {
            cloth.stats.level = level;
        }
        if cloth.state.lod.action == LodAction::Wait {
            skip(&mut cloth);
            continue;
        }
        let (seconds, ticks) = cloth.state.lod.take(time.delta_secs());
        let inputs = Inputs::of(&cloth.game, gravity.0);
        let lod = cloth.game.lod.or(global_lod);
        let checked = lod.map_or(Ok(()), ClothLod::validate);
        let inputs = checked.map_err(ClothError::from).and(inputs);
        let outcome = inputs.and_then(|inputs| {
            if cloth.state.lod.action == LodAction::Stand {
                skip(&mut cloth);
                return stand_still(&mut cloth, &around);
            }
            let forces = GameForces::of(&cloth.game.forces, &around.field)?;
            if sleeps_as_it_was(&cloth, &inputs, &around, forces, seconds) {
                return Ok(());
            }
            // Forgets the work of an earlier tick.
            cloth.scratch.forget_tick();
            let seconds = (seconds, ticks);
            prepare(&mut cloth, &inputs, &around, forces, &mut parts, seconds)?;
            notice_new(&mut cloth, &inputs, &mut notices);
            Ok(())
        });
        cloth.state.is_valid = outcome.is_ok();
        if outcome.is_err() {
            skip(&mut cloth);
            if !cloth.state.resumes {
                cloth.state.wake();
            }
        }
        if cloth.game.teleport.is_some() && outcome.is_ok() {
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

/// Lets the tick pass without the cloth.
fn skip(cloth: &mut PrepareQueryItem) {
    cloth.scratch.forget_tick();
    cloth.bounds.leave_out();
    clear_stats(&mut cloth.stats, false);
    (cloth.stats.integrate_ms, cloth.stats.substeps) = (0.0, 0);
    cloth.stats.is_asleep = false;
}

/// Keeps the cloth's shape, and moves it with its carrier.
fn stand_still(cloth: &mut PrepareQueryItem, around: &Surroundings) -> Result<(), ClothError> {
    if cloth.state.inputs.written != Some(cloth.particles.last_changed()) {
        check_particles(&mut cloth.particles)?;
    }
    cloth.contacts.clear();
    freeze(cloth, &around.targets)?;
    if cloth.built.skin.is_some() && cloth.state.lod.level != ClothLodLevel::Off {
        let place = |joint| around.targets.place(joint);
        (around.skins).read(cloth.entity, place, &mut cloth.scratch.pose.joints)?;
        stand_in_pose(cloth, &around.sources)?;
    }
    Ok(())
}

fn prepare(
    cloth: &mut PrepareQueryItem,
    inputs: &Inputs,
    around: &Surroundings,
    forces: GameForces,
    parts: &mut SharedParts,
    (seconds, ticks): (f32, u32),
) -> Result<(), ClothError> {
    let before = *cloth.frame;
    let (frame, build) = build_cloth(cloth, inputs, around, parts)?;
    let has_stood = cloth.state.lod.frozen.is_some();
    let was_written = take_over(cloth, inputs, around, [&before, &frame], seconds)?;
    let forces = forces.on(cloth.built.surface())?;
    let (is_known, fastest) = (
        cloth.state.is_valid && !has_stood,
        cloth.state.largest_speed,
    );
    apply_motion(cloth, around, [&before, &frame], build, seconds, has_stood)?;
    let scratch = &mut *cloth.scratch;
    scratch.begins |= build == Build::New;
    // What stood still, or was at fault, may have been put anywhere meanwhile.
    if is_known && !scratch.pins.is_empty() {
        scratch.dragged = jump(&scratch.pins, fastest, (seconds, ticks));
    }
    let acceleration = cloth.frame.isometry().rotation.inverse() * inputs.gravity;
    let (built, state) = (&mut *cloth.built, &mut *cloth.state);
    if was_written || cloth.scratch.teleports {
        state.stretch = built.solver.measure(&cloth.particles);
        built.refresh_masses(&cloth.particles);
        cloth.stats.stretch = state.stretch;
        state.wake();
    }
    built.tether(
        inputs.settings.tethers,
        &inputs.material,
        &cloth.particles,
        inputs.gravity.length(),
        &mut state.largest_gravity,
    );
    cloth.scratch.was_put = was_written || build != Build::Kept || cloth.scratch.teleports;
    see_whether_it_rests(cloth, inputs, around, forces, acceleration, seconds);
    prepare_step(cloth, inputs, around, acceleration, (seconds, ticks));
    prepare_contact(cloth, inputs, acceleration, seconds);
    clear_stats(&mut cloth.stats, cloth.state.rest.is_asleep());
    cloth.state.resumes = false;
    Ok(())
}

/// Builds a cloth that is not built yet. Returns the place of its entity, and the result.
fn build_cloth(
    cloth: &mut PrepareQueryItem,
    inputs: &Inputs,
    around: &Surroundings,
    parts: &mut SharedParts,
) -> Result<(ClothFrame, Build), ClothError> {
    let (targets, sources) = (&around.targets, &around.sources);
    let transform = targets.cloths.of(cloth.entity)?;
    let (frame, mut scale) = ClothFrame::of(&transform)?;
    if cloth.game.skin.is_some() {
        let place = |joint| targets.place(joint);
        let pose = &mut cloth.scratch.pose;
        (around.skins).read(cloth.entity, place, &mut pose.joints)?;
        // How large it is in the world is the skeleton's matter.
        scale = pose.scale().unwrap_or(scale);
    }
    let wanted = BuildInputs {
        cloth: &cloth.game.cloth,
        changes: cloth.game.changes(),
        source: sources.find(cloth.entity, &cloth.game.cloth, cloth.built.source())?,
        material: &inputs.material,
        grain: cloth.game.grain(),
        map: cloth.game.map.as_deref(),
        tears: cloth.game.tears(),
        pins: cloth.game.pins(),
        attachments: cloth.game.attachments(),
        scale,
        has_layers: (inputs.self_collision.as_ref()).is_some_and(|of| of.with_itself),
        is_async: around.async_builds.contains(cloth.entity),
    };
    let is_new = cloth.built.from.is_some() || cloth.particles.is_empty();
    let mut building = Building {
        wanted: &wanted,
        sources,
        parts,
        particles: &mut cloth.particles,
        built: &mut cloth.built,
        state: &mut cloth.state,
    };
    let build = building.build()?;
    if build == Build::New {
        *cloth.frame = frame;
    }
    let begins = build == Build::New && is_new;
    place_pose(cloth, sources, &frame, begins)?;
    Ok((frame, build))
}

/// Takes over particles that the game wrote, and checks settings against the surface. Returns whether the particles
/// differ from those of the last tick.
fn take_over(
    cloth: &mut PrepareQueryItem,
    inputs: &Inputs,
    around: &Surroundings,
    frames: [&ClothFrame; 2],
    seconds: f32,
) -> Result<bool, ClothError> {
    // A cloth with a fault may have been moved anywhere meanwhile.
    let jumps =
        cloth.game.teleport.is_some() || around.roots.jumps(cloth.entity) || !cloth.state.is_valid;
    let has_stood = thaw(cloth, &around.targets, frames, (seconds, jumps));
    let (particles, state) = (&mut cloth.particles, &mut *cloth.state);
    // Saving or restoring particles may mark them as changed without a change.
    let was_written = has_stood
        || state.inputs.written != Some(particles.last_changed())
            && !state.rest.sleeps_as(particles);
    // Particles that nothing wrote are as they were when they were last checked.
    if was_written || !state.is_valid {
        state.largest_speed = check_particles(particles)?;
    }
    let surface = cloth.built.surface();
    if let Some(self_collision) = &inputs.self_collision {
        self_collision.validate(surface)?;
    }
    Ok(was_written)
}

/// Follows the entity, the root that carries it, the pose, and the targets of attachments.
fn apply_motion(
    cloth: &mut PrepareQueryItem,
    around: &Surroundings,
    [before, frame]: [&ClothFrame; 2],
    build: Build,
    seconds: f32,
    has_stood: bool,
) -> Result<(), ClothError> {
    let Surroundings { targets, roots, .. } = around;
    let (state, scratch) = (&mut *cloth.state, &mut *cloth.scratch);
    targets.find(
        cloth.entity,
        cloth.game.attachments(),
        &state.attachments.given,
        cloth.built.surface(),
        &mut state.attachments.targets,
        &mut scratch.targets,
    )?;
    let target = state.attachments.targets.first().copied();
    let (moves, goes_on) = (seconds > 0.0, build != Build::New);
    scratch.carried = match moves && goes_on {
        true => roots.carry(cloth.entity, target)?,
        false => None,
    };
    let new_from_old = new_from_old([&*cloth.frame, frame], scratch.carried.as_ref());
    let is_moved = new_from_old.is_some();
    let new_from_old = new_from_old.unwrap_or_default();
    scratch.teleports = cloth.game.teleport.is_some()
        || roots.jumps(cloth.entity)
        || target.is_some_and(|target| roots.jumps(target));
    if let Some(skin) = &cloth.game.skin
        && moves
        && goes_on
    {
        let displacement = scratch.pose.farthest_from(&state.pose, new_from_old);
        // A frozen cloth is put where its skeleton has moved meanwhile.
        scratch.teleports |= has_stood || displacement > skin.teleport_distance;
    }
    if scratch.teleports {
        scratch.carried = None;
        *cloth.frame = *frame;
    } else if moves && is_moved {
        carry(&mut cloth.particles, new_from_old, &mut scratch.pins);
        state.wake();
        *cloth.frame = *frame;
    }
    if moves || build != Build::Kept || scratch.teleports {
        let teleport_from = scratch.teleports.then_some(*before);
        move_with_pose(cloth, new_from_old, goes_on);
        follow_targets(cloth, teleport_from);
    }
    Ok(())
}

/// The speed of the fastest particle (m/s), if all are valid.
fn check_particles(particles: &mut Mut<ClothParticles>) -> Result<f32, ClothError> {
    let survey = particles.survey();
    if survey.is_valid {
        return Ok(survey.largest_speed);
    }
    particles.validate()?;
    // The particles are valid again, but invalid ones may have left values in the padding.
    particles.clear_padding();
    particles.mend_substep();
    Ok(particles.survey().largest_speed)
}
