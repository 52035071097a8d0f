//! All sub-steps of a tick.

use bevy::ecs::system::{Query, ResMut};

use super::{
    island::integrate_together,
    seams::SewnSeams,
    tick::{Colliders, IntegrateQuery},
};
use crate::plugin::{naming::Named, prepare::Islands, threads::threads};

/// Cloths whose particles × sub-steps come to less are solved one after the other on this thread.
const MIN_TO_SHARE: usize = 64 * 64 * 20;

/// Runs all sub-steps, of several cloths at once where there is enough to do; of those that may touch each other, together.
pub(crate) fn integrate(
    mut cloths: Query<IntegrateQuery>,
    colliders: Colliders,
    mut islands: ResMut<Islands>,
    mut seams: SewnSeams,
    names: Query<Named>,
) {
    for island in &mut islands.all {
        integrate_together(island, &mut cloths, &mut seams, &colliders, &names);
    }
    let (mut awake, mut work) = (0, 0);
    for cloth in &cloths {
        if let Some(step) = cloth.scratch.step
            && !cloth.state.rest.is_asleep()
            && !cloth.scratch.is_in_island
        {
            awake += 1;
            work += cloth.particles.len() * step.substeps as usize;
        }
    }
    if awake > 1 && work >= MIN_TO_SHARE && threads() > 1 {
        cloths
            .par_iter_mut()
            .for_each(|mut cloth| cloth.integrate(&colliders));
    } else {
        cloths
            .iter_mut()
            .for_each(|mut cloth| cloth.integrate(&colliders));
    }
}
