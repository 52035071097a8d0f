//! Follows the pose of a skeleton as a tick begins.

use std::sync::Arc;

use bevy::prelude::{DetectChanges, Isometry3d, Mut, Quat, Vec3};

use super::{carry::set_motion, preparing::PrepareQueryItem, source::Sources};
use crate::{
    cloth::{ClothError, ClothParticles},
    plugin::{
        frame::ClothFrame,
        state::{Pose, SkinLimits},
    },
    solver::PinMotion,
};

/// Takes over a `ClothSkin`, and places the pose from the joints that have been read into `scratch`. A new cloth is
/// put into the pose.
///
/// # Errors
/// The error of the component, or of the mesh's joints.
pub(crate) fn place_pose(
    cloth: &mut PrepareQueryItem,
    sources: &Sources,
    frame: &ClothFrame,
    begins: bool,
) -> Result<(), ClothError> {
    renew_limits(cloth)?;
    place_joints(cloth, sources, frame)?;
    if begins && cloth.built.skin.is_some() {
        begin_in_pose(cloth);
    }
    Ok(())
}

/// Places the pose from the joints that have been read into `scratch`, if the cloth follows one.
fn place_joints(
    cloth: &mut PrepareQueryItem,
    sources: &Sources,
    frame: &ClothFrame,
) -> Result<(), ClothError> {
    let (built, pose) = (&*cloth.built, &mut cloth.scratch.pose);
    let Some(limits) = &built.skin else {
        return Ok(());
    };
    let with_normals = !limits.backstops.is_empty();
    let skinning = match pose.joints.is_empty() {
        true => None,
        false => (built.shared).skinning(|source, surface| sources.skinning(source, surface))?,
    };
    pose.place(built.surface(), skinning, frame, with_normals)
}

/// Moves a frozen cloth, in this frame, with the joints that have been read into `scratch`. Each particle keeps its
/// place relative to its place in the pose.
///
/// # Errors
/// The error of the mesh's joints.
pub(crate) fn stand_in_pose(
    cloth: &mut PrepareQueryItem,
    sources: &Sources,
) -> Result<(), ClothError> {
    let (frame, known) = (*cloth.frame, &cloth.state.pose);
    let is_new = cloth.scratch.pose.joints != known.joints || known.frame != frame;
    if known.places.is_empty() || !is_new {
        return Ok(());
    }
    place_joints(cloth, sources, &frame)?;
    let (from, state) = (&mut cloth.scratch.pose, &mut *cloth.state);
    std::mem::swap(from, &mut state.pose);
    if let Some(turn) = state.pose.turn_since(from) {
        teleport_to_pose([from, &state.pose], turn, &mut cloth.particles);
        state.inputs.written = Some(cloth.particles.last_changed());
    }
    Ok(())
}

/// Takes over a `ClothSkin` that is new, has changed, or was removed. Particles that it no longer holds get their
/// mass back.
///
/// # Errors
/// The error of the component; nothing is changed then.
fn renew_limits(cloth: &mut PrepareQueryItem) -> Result<(), ClothError> {
    let (skin, particles) = (cloth.game.skin.as_ref(), &mut cloth.particles);
    let (built, state) = (&mut *cloth.built, &mut *cloth.state);
    let surface = built.surface();
    let known = built.skin.as_ref();
    let is_known = match (skin, known) {
        (None, None) => true,
        (Some(skin), Some(known)) => {
            known.changed == skin.last_changed() && Arc::ptr_eq(&known.surface, surface)
        }
        _ => false,
    };
    if is_known {
        return Ok(());
    }
    let new = match skin {
        Some(skin) => Some(SkinLimits::new(skin, skin.last_changed(), surface)?),
        None => None,
    };
    let is_held =
        |index: &usize| (new.as_ref()).is_some_and(|new| new.max_distances[*index] == 0.0);
    // Nothing was held on another surface.
    let known = known.filter(|known| Arc::ptr_eq(&known.surface, surface));
    let held = known.into_iter().flat_map(|known| known.held());
    let released: Vec<usize> = held.filter(|index| !is_held(index)).collect();
    if !released.is_empty() {
        built.give_masses(released.into_iter(), particles);
        for attached in &state.attachments.attached {
            particles.pin(attached.particle as usize);
        }
        built.forget_tethers();
    }
    built.skin = new.map(Box::new);
    if skin.is_none() {
        state.pose = Pose::default();
    }
    if !state.resumes {
        state.wake();
    }
    Ok(())
}

/// Puts the particles of a new cloth, which are at rest, into its pose.
fn begin_in_pose(cloth: &mut PrepareQueryItem) {
    let (pose, particles) = (&cloth.scratch.pose, &mut cloth.particles);
    if pose.joints.is_empty() {
        return;
    }
    let rest = cloth.built.surface().rest_positions();
    for (index, (place, rest)) in pose.places.iter().zip(rest).enumerate() {
        // They begin a little beside the surface.
        let beside = particles.position_at(index) - *rest;
        particles.put(index, *place + beside);
    }
}

/// Takes over a pose that has been placed in `scratch`, as a tick begins in which the cloth's frame changes by
/// `new_from_old`. It `goes_on` unless it is new or teleports.
pub(crate) fn move_with_pose(
    cloth: &mut PrepareQueryItem,
    new_from_old: Isometry3d,
    goes_on: bool,
) {
    if cloth.built.skin.is_none() {
        return;
    }
    let (state, scratch) = (&mut *cloth.state, &mut *cloth.scratch);
    let was_there = goes_on && !state.pose.places.is_empty();
    std::mem::swap(&mut scratch.pose, &mut state.pose);
    let (from, to) = (&mut scratch.pose, &state.pose);
    let turn = to.turn_since(from);
    if was_there
        && scratch.teleports
        && let Some(turn) = turn
    {
        teleport_to_pose([from, to], turn, &mut cloth.particles);
        // They move with their skeleton, not with the target that they are attached to.
        state.attachments.first_target = None;
    }
    let jumps = scratch.teleports || !was_there;
    if jumps {
        from.copy_from(to);
    } else {
        from.transform(new_from_old);
        // A new backstop: there were no normals before.
        if from.normals.len() != to.normals.len() {
            from.normals.clone_from(&to.normals);
        }
    }
    follow_pose(cloth, jumps);
    if cloth.scratch.constraints.travel() > 0.0 {
        cloth.state.wake();
    }
}

/// Keeps the place of each particle relative to its place in the pose, from one frame to another that is rotated.
fn teleport_to_pose([from, to]: [&Pose; 2], turn: Quat, particles: &mut Mut<ClothParticles>) {
    particles.transform(Isometry3d::from_rotation(turn));
    for (index, (from, to)) in from.places.iter().zip(&to.places).enumerate() {
        let beside = particles.position_at(index) - turn * *from;
        particles.put(index, *to + beside);
    }
}

/// Moves held particles with the pose in this tick. Keeps the others in their ball and outside their
/// backstop. If the cloth is new or `jumps`, held particles are put where the pose ends.
fn follow_pose(cloth: &mut PrepareQueryItem, jumps: bool) {
    let scratch = &mut *cloth.scratch;
    let (from, motions, constraints) = (&scratch.pose, &mut scratch.pins, &mut scratch.constraints);
    let (to, particles) = (&cloth.state.pose, &mut cloth.particles);
    constraints.clear();
    let Some(limits) = &cloth.built.skin else {
        return;
    };
    let is_free = |index: &usize| particles.inverse_mass(*index) != Some(0.0);
    let is_new = limits.held().any(|index| is_free(&index));
    if is_new {
        limits.held().for_each(|index| particles.pin(index));
    }
    let has_backstops = !limits.backstops.is_empty();
    if limits.has_balls || has_backstops {
        constraints.begin(particles, has_backstops);
    }
    let carried = motions.len();
    if jumps {
        for index in 0..particles.len() {
            if particles.inverse_mass(index) == Some(0.0) {
                particles.put(index, to.places[index]);
            }
        }
    } else {
        let masses = particles.inverse_masses().enumerate();
        for (index, _) in masses.filter(|(_, weight)| *weight == 0.0) {
            let (at, to) = (particles.position_at(index), to.places[index]);
            let motion = PinMotion {
                particle: index as u32,
                from: at,
                to,
            };
            set_motion(motions, carried, motion);
        }
    }
    if limits.has_balls {
        for (index, &radius) in limits.max_distances.iter().enumerate() {
            if radius > 0.0 && radius < f32::INFINITY {
                constraints.set_ball(index, [from.places[index], to.places[index]], radius);
            }
        }
    }
    for (index, &distance) in limits.backstops.iter().enumerate() {
        if distance < f32::INFINITY {
            let behind = |pose: &Pose| -> Vec3 {
                pose.places[index] - pose.normals[index] * (distance + limits.radius)
            };
            constraints.set_backstop(index, [behind(from), behind(to)], limits.radius);
        }
    }
    if is_new {
        cloth.built.forget_tethers();
    }
}
