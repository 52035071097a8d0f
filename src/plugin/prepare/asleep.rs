//! Sleeping cloths, which need no preparation.

use bevy::prelude::{DetectChanges, Vec3};

use super::preparing::{PrepareQueryItem, Surroundings};
use crate::{
    cloth::ClothParticles,
    plugin::{
        frame::ClothFrame,
        state::{ClothBuilt, GameForces, Inputs},
    },
};

/// Whether the cloth sleeps and its inputs have not changed: then there is nothing to prepare.
pub(super) fn sleeps_as_it_was(
    cloth: &PrepareQueryItem,
    inputs: &Inputs,
    around: &Surroundings,
    forces: GameForces,
    seconds: f32,
) -> bool {
    let (state, built) = (&*cloth.state, &*cloth.built);
    if !(state.rest.is_asleep() && state.is_valid && cloth.stats.is_asleep) {
        return false;
    }
    let source = built.source();
    // If something wakes it in this tick, it continues with the step that it would have been prepared with.
    let is_prepared = (cloth.scratch.step).is_some_and(|step| step.seconds == seconds);
    is_prepared
        && state.inputs.known == Some(*inputs)
        && state.inputs.written == Some(cloth.particles.last_changed())
        && state.attachments.given.is_empty()
        && cloth.game.attachments().is_empty()
        && cloth.game.teleport.is_none()
        && !around.roots.jumps(cloth.entity)
        && is_in_same_pose(cloth, around)
        && built.is_made_from(&cloth.game.changes(), &inputs.material, cloth.game.pins())
        && around.sources.find(cloth.entity, &cloth.game.cloth, source) == Ok(source)
        && forces.on(built.surface()).is_ok_and(|forces| {
            let ball = || ball(built, &cloth.particles, state.stretch.bound, &cloth.frame);
            state.inputs.forces.is_still(forces, &around.field, ball)
        })
        && (around.targets.cloths.of(cloth.entity))
            .is_ok_and(|transform| cloth.frame.is_of(&transform))
}

/// Whether its pose is the same as in the last tick, or it follows none.
fn is_in_same_pose(cloth: &PrepareQueryItem, around: &Surroundings) -> bool {
    let place = |joint| around.targets.place(joint);
    match (&cloth.game.skin, &cloth.built.skin) {
        (None, None) => true,
        (Some(skin), Some(known)) => {
            skin.last_changed() == known.changed
                && (around.skins).are_at(cloth.entity, place, &cloth.state.pose.joints)
        }
        _ => false,
    }
}

/// A ball around a cloth in the world: centre and radius (m).
pub(super) fn ball(
    built: &ClothBuilt,
    particles: &ClothParticles,
    stretch: f32,
    frame: &ClothFrame,
) -> (Vec3, f32) {
    let root = built.tree().root_sphere(particles, stretch);
    (frame.to_world(root.center.into()), root.radius())
}
