//! The system that moves all cloths.

use bevy::prelude::{Query, ResMut};

use super::{
    member::{Member, members},
    pieces::{hold_sleeping_pieces, let_pieces_go},
    seams::{Sewing, SewnSeams},
    substeps::simulate,
    tick::{Colliders, IntegrateQuery, IntegrateQueryItem},
};
use crate::plugin::{
    naming::Named,
    prepare::{Island, Islands},
    threads::{MIN_TO_SPLIT, for_each, threads},
};

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
        simulate_island(island, &mut cloths, &mut seams, &colliders, &names);
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
    for_each(&mut cloths, awake > 1 && work >= MIN_TO_SHARE, |cloth| {
        simulate_alone(cloth, &colliders, &names);
    });
}

/// Cloths that may touch each other, or that are sewn together.
fn simulate_island(
    island: &mut Island,
    cloths: &mut Query<IntegrateQuery>,
    seams: &mut SewnSeams,
    colliders: &Colliders,
    names: &Query<Named>,
) {
    let mut members = members(cloths, &island.entities);
    for Member { cloth, .. } in &mut members {
        cloth.built.solver.set_partitions(1);
        // Other cloths touch them, or are sewn to them.
        cloth.state.resting.pieces.wake();
    }
    let mut sewing = Sewing::begin(island, &members, seams);
    let contact = &mut island.contact;
    sewing.tell(contact, &members);
    simulate(&mut members, &mut sewing, Some(contact), colliders, names);
}

/// A cloth that touches no other.
fn simulate_alone(cloth: IntegrateQueryItem, colliders: &Colliders, names: &Query<Named>) {
    // Cloths that may touch each other have been moved.
    if cloth.scratch.is_in_island {
        return;
    }
    let Some(mut member) = Member::of(cloth) else {
        return;
    };
    // Asleep.
    let Some(step) = member.step else {
        return;
    };
    let cloth = &mut member.cloth;
    let partitions = match cloth.particles.len() < MIN_TO_SPLIT {
        true => 1,
        false => threads(),
    };
    cloth.built.solver.set_partitions(partitions);
    hold_sleeping_pieces(cloth, &step);
    let touches_itself = (cloth.scratch.self_collision).is_some_and(|of| of.with_itself);
    let mut contact = touches_itself.then(|| cloth.scratch.mutual.take().unwrap_or_default());
    let mut sewing = Sewing::default();
    let (members, layers) = (std::slice::from_mut(&mut member), contact.as_deref_mut());
    simulate(members, &mut sewing, layers, colliders, names);
    let_pieces_go(&mut member.cloth);
    if contact.is_some() {
        member.cloth.scratch.mutual = contact;
    }
}
