//! The sub-steps of cloths that may touch each other, run together.

use bevy::{
    ecs::{entity::Entity, system::Query},
    log::warn,
    platform::time::Instant,
};

use super::{
    member::{Few, Member, members, participants},
    seams::{Sewing, SewnSeams},
    tick::{Colliders, IntegrateQuery},
};
use crate::{
    contact::{ClothLayers, Inside, MutualContact},
    plugin::{
        clock::milliseconds_since,
        naming::{Named, Part},
        prepare::Island,
    },
    solver::{LimitInputs, StartedTick, Stretch, SubStep, Substepping, TickStep},
};

/// Simulates the tick of all cloths of an island, and repeats it with more sub-steps while the tolerance of one of them
/// needs it.
pub(crate) fn integrate_together(
    island: &mut Island,
    cloths: &mut Query<IntegrateQuery>,
    seams: &mut SewnSeams,
    colliders: &Colliders,
    names: &Query<Named>,
) {
    let start = Instant::now();
    let mut members = members(cloths, &island.entities);
    let mut sewing = Sewing::begin(island, &members, seams);
    sewing.tell(&mut island.contact, &members);
    // All take the largest number of sub-steps that any of them needs.
    let mut substeps = members
        .iter()
        .filter_map(|member| member.step.map(|step| step.substeps))
        .max()
        .unwrap_or(1)
        .max(sewing.needed(&members));
    let may_repeat = members.iter().any(|member| {
        matches!(
            member.cloth.scratch.substepping,
            Substepping::Adaptive { .. }
        )
    });
    if may_repeat {
        for member in members.iter_mut().filter(|member| member.step.is_some()) {
            let backup = &mut member.cloth.scratch.backup;
            backup.copy_from(&member.cloth.particles);
        }
    }
    loop {
        let more = advance(
            &mut members,
            &mut sewing,
            substeps,
            &mut island.contact,
            colliders,
            names,
        );
        let Some(more) = more else {
            break;
        };
        substeps = more;
        for member in members.iter_mut().filter(|member| member.step.is_some()) {
            member.cloth.restart();
        }
        sewing.restart();
        island.contact.forget();
    }
    let seconds = members.iter().find_map(|member| member.step);
    sewing.end(seconds.map_or(0.0, |step| step.seconds));
    let milliseconds = milliseconds_since(start) / members.len().max(1) as f64;
    for Member { cloth, step, .. } in &mut members {
        if let Some(step) = step {
            let own = cloth.limit_inputs(TickStep { substeps, ..*step });
            let lost = island.contact.lost();
            cloth.scratch.limit_inputs = Some(LimitInputs { lost, ..own });
            cloth.finish(milliseconds);
            cloth.state.layer_substeps = island.contact.wanted_substeps();
            cloth.stats.layer_pairs = island.contact.pairs();
            cloth.stats.layer_searches = island.contact.searches();
        }
    }
}

/// A single run through the sub-steps of all. Returns the number that a tolerance needs, if these were too few.
fn advance(
    members: &mut [Member],
    sewing: &mut Sewing,
    substeps: u32,
    contact: &mut MutualContact,
    colliders: &Colliders,
    names: &Query<Named>,
) -> Option<u32> {
    let seconds = members.iter().find_map(|member| member.step)?.seconds;
    let dt = seconds / substeps as f32;
    let mut ticks = begin(members, substeps);
    let layers: Few<ClothLayers> = members
        .iter()
        .map(|member| member.cloth.layers.copied().unwrap_or_default())
        .collect();
    let meets = |a: usize, b: usize| layers[a].interacts_with(layers[b]);
    contact.begin(&participants(members), meets);
    warn_of_inside(members, contact, names);
    let mut is_pushed: Few<bool> = members.iter().map(|_| false).collect();
    let mut moved: Few<Option<SubStep>> = Few::new();
    for index in 0..substeps {
        moved.clear();
        for (Member { cloth, .. }, tick) in members.iter_mut().zip(&mut ticks) {
            let substep = tick.as_mut().and_then(|tick| {
                let (solver, pins) = (&mut cloth.built.solver, &cloth.scratch.pins);
                let mut substep = solver.substep(&mut cloth.particles, pins, tick)?;
                if cloth.hold(&mut substep) {
                    tick.note_push(&mut cloth.particles);
                }
                Some(substep)
            });
            moved.push(substep);
        }
        sewing.close(members, &mut ticks, &mut moved, (index + 1) as f32 * dt, dt);
        contact.note_before_colliders(&participants(members));
        for ((member, tick), substep) in members.iter_mut().zip(&mut ticks).zip(&moved) {
            if let (Some(tick), Some(substep)) = (tick, *substep)
                && member.cloth.touch(substep, colliders)
            {
                tick.note_push(&mut member.cloth.particles);
            }
        }
        is_pushed.fill(false);
        let farthest = contact.respond(&mut participants(members), meets, dt, &mut is_pushed);
        for ((member, tick), is_pushed) in members.iter_mut().zip(&mut ticks).zip(&is_pushed) {
            if let Some(tick) = tick
                && *is_pushed
            {
                member.cloth.scratch.detection.note_push(farthest);
                tick.note_push(&mut member.cloth.particles);
            }
        }
    }
    end(members, ticks, substeps)
}

/// Begins the tick of each member that is moved.
fn begin(members: &mut [Member], substeps: u32) -> Few<Option<StartedTick>> {
    members
        .iter_mut()
        .map(|Member { cloth, step, .. }| {
            let step = TickStep {
                substeps,
                ..(*step)?
            };
            cloth.recall_carriers(substeps);
            let solver = &mut cloth.built.solver;
            solver.set_partitions(1);
            Some(solver.begin(&mut cloth.particles, step, &cloth.scratch.pins))
        })
        .collect()
}

/// Ends the tick of each member. Returns the number of sub-steps that a tolerance needs, if these were too few.
fn end(members: &mut [Member], ticks: Few<Option<StartedTick>>, substeps: u32) -> Option<u32> {
    let mut wanted = None;
    for (Member { cloth, step, .. }, tick) in members.iter_mut().zip(ticks) {
        let (Some(mut tick), Some(step)) = (tick, step) else {
            continue;
        };
        let solver = &mut cloth.built.solver;
        // Forces have half a push left.
        let rest = solver.substep(&mut cloth.particles, &cloth.scratch.pins, &mut tick);
        debug_assert!(rest.is_none(), "all sub-steps are done");
        let mut stretch: Stretch = solver.end(&mut cloth.particles, &cloth.scratch.pins, tick);
        stretch.load_substeps = cloth.load_substeps(step);
        let taken = TickStep { substeps, ..*step };
        stretch.contact_substeps = cloth.contact_substeps(&taken, &stretch);
        cloth.stats.substeps += substeps;
        cloth.state.stretch = stretch;
        let substepping = cloth.scratch.substepping;
        let more = cloth.state.control.observe(substepping, stretch);
        // Without a tolerance the tick is not begun again, and the next one takes more.
        if matches!(substepping, Substepping::Adaptive { .. }) {
            wanted = wanted.max(more);
        }
    }
    wanted
}

/// Warns of cloths that begin inside each other. A later tick, or this one done again, does not ask.
fn warn_of_inside(members: &mut [Member], contact: &MutualContact, names: &Query<Named>) {
    if members.iter().all(|member| !member.cloth.scratch.begins) {
        return;
    }
    let begin: Vec<(Entity, bool)> = members
        .iter_mut()
        .map(|Member { cloth, .. }| (cloth.entity, std::mem::take(&mut cloth.scratch.begins)))
        .collect();
    let inside = contact.begin_inside(&participants(members), |cloth| begin[cloth].1);
    let Some(Inside {
        cloths,
        share,
        distance,
        others,
    }) = inside
    else {
        return;
    };
    let names = cloths.map(|cloth| names.get(begin[cloth].0));
    let [Ok(first), Ok(second)] = names else {
        return;
    };
    let [first, second] = [first, second].map(|name| name.describe(Part::Cloth));
    let others = match others {
        0 => String::new(),
        others => format!(" (and {others} more likewise)"),
    };
    let (share, distance) = (100.0 * share, 1000.0 * distance);
    warn!(
        "{first} begins inside {second}{others}: {share:.0} % of its particles are nearer than {distance:.1} mm: spawn them a thickness apart, or keep them from meeting with `ClothLayers`"
    );
}
