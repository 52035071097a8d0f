//! The sub-steps of a tick: of one cloth, or of several that may touch each other, run together.

use bevy::{
    platform::time::Instant,
    prelude::{Entity, Query, warn},
};

use super::{
    member::{Few, Member, participants},
    seams::Sewing,
    tick::Colliders,
};
use crate::{
    contact::{ClothLayers, Inside, MutualContact},
    plugin::{
        clock::milliseconds_since,
        naming::{Named, Part},
    },
    solver::{StartedTick, Stretch, SubStep, TickStep, with_threads_awake},
};

/// Simulates the tick of some cloths, and repeats it with more sub-steps while one of them needs it. `contact` is that of their
/// layers.
pub(super) fn simulate(
    members: &mut [Member],
    sewing: &mut Sewing,
    mut contact: Option<&mut MutualContact>,
    colliders: &Colliders,
    names: &Query<Named>,
) {
    let start = Instant::now();
    // All take the largest number of sub-steps that any of them needs.
    let steps = members.iter().filter_map(|member| member.step);
    let needed = steps.map(|step| step.substeps).max();
    let mut substeps = needed.unwrap_or(1).max(1).max(sewing.needed(members));
    let may_repeat = members.iter().any(|member| member.may_repeat);
    if may_repeat {
        for member in members.iter_mut().filter(|member| member.step.is_some()) {
            let backup = &mut member.cloth.scratch.backup;
            backup.copy_from(&member.cloth.particles);
        }
    }
    // A member may want more than it would take alone, and less than the island has taken.
    while let Some(more) = advance(
        members,
        sewing,
        substeps,
        contact.as_deref_mut(),
        colliders,
        names,
    )
    .filter(|more| *more > substeps)
    {
        substeps = more;
        for member in members.iter_mut().filter(|member| member.step.is_some()) {
            member.cloth.restart();
        }
        sewing.restart();
        if let Some(contact) = &mut contact {
            contact.forget();
        }
    }
    let seconds = members.iter().find_map(|member| member.step);
    sewing.end(seconds.map_or(0.0, |step| step.seconds));
    let lost = contact.as_ref().map_or(0, |contact| contact.lost());
    let milliseconds = milliseconds_since(start) / members.len().max(1) as f64;
    for Member { cloth, step, .. } in members {
        let Some(step) = step else {
            continue;
        };
        let step = TickStep { substeps, ..*step };
        cloth.scratch.limit_inputs = Some(cloth.limit_inputs(step, lost));
        cloth.finish(milliseconds);
        if let Some(contact) = &contact {
            cloth.state.layer_substeps = contact.wanted_substeps();
            cloth.stats.layer_pairs = contact.pairs();
            cloth.stats.layer_searches = contact.searches();
        }
    }
}

/// The state of each member in a run through the sub-steps.
#[derive(Default)]
struct Run {
    ticks: Few<Option<StartedTick>>,
    /// The sub-step that it is moved by.
    moved: Few<Option<SubStep>>,
    /// Whether its layers were pushed in the sub-step.
    is_pushed: Few<bool>,
}

/// A single run through the sub-steps of all. Returns the number that one of them needs, if these were too few.
fn advance(
    members: &mut [Member],
    sewing: &mut Sewing,
    substeps: u32,
    mut contact: Option<&mut MutualContact>,
    colliders: &Colliders,
    names: &Query<Named>,
) -> Option<u32> {
    let seconds = members.iter().find_map(|member| member.step)?.seconds;
    let mut run = Run {
        ticks: begin(members, substeps),
        ..Default::default()
    };
    let layers = members.iter().map(|member| member.cloth.layers);
    let layers: Few<ClothLayers> = layers.map(|of| of.copied().unwrap_or_default()).collect();
    let meets = |a: usize, b: usize| layers[a].interacts_with(layers[b]);
    if let Some(contact) = &mut contact {
        contact.begin(&participants(members), meets);
        warn_of_inside(members, contact, names);
    }
    let started = members.iter().zip(&run.ticks);
    let partitions =
        started.filter_map(|(of, tick)| Some(of.cloth.built.solver.partitions_of(tick.as_ref()?)));
    let partitions = partitions.max().unwrap_or(1);
    with_threads_awake(partitions, || {
        for index in 0..substeps {
            let dt = seconds / substeps as f32;
            let time = (index + 1) as f32 * dt;
            let contact = contact.as_deref_mut();
            substep(
                members,
                &mut run,
                sewing,
                contact,
                [time, dt],
                &meets,
                colliders,
            );
        }
        end(members, run.ticks, substeps)
    })
}

/// A sub-step of all, in this order: springs, poses, seams, colliders, layers. It ends at a time of the tick, and takes `dt` (s).
fn substep(
    members: &mut [Member],
    run: &mut Run,
    sewing: &mut Sewing,
    mut contact: Option<&mut MutualContact>,
    [time, dt]: [f32; 2],
    meets: &impl Fn(usize, usize) -> bool,
    colliders: &Colliders,
) {
    let (ticks, moved) = (&mut run.ticks, &mut run.moved);
    moved.clear();
    let each = members.iter_mut().zip(&mut *ticks);
    moved.extend(each.map(|(Member { cloth, .. }, tick)| {
        let tick = tick.as_mut()?;
        let (solver, pins) = (&mut cloth.built.solver, &cloth.scratch.pins);
        let mut substep = solver.substep(&mut cloth.particles, pins, tick)?;
        if cloth.hold(&mut substep) {
            tick.note_push(&mut cloth.particles);
        }
        Some(substep)
    }));
    sewing.close(members, ticks, moved, time, dt);
    if let Some(contact) = &mut contact {
        contact.note_before_colliders(&participants(members));
    }
    for ((member, tick), substep) in members.iter_mut().zip(&mut *ticks).zip(&*moved) {
        if let (Some(tick), Some(substep)) = (tick, *substep)
            && member.cloth.touch(substep, colliders)
        {
            tick.note_push(&mut member.cloth.particles);
        }
    }
    let Some(contact) = contact else {
        return;
    };
    let is_pushed = &mut run.is_pushed;
    is_pushed.clear();
    is_pushed.resize(members.len(), false);
    let farthest = contact.respond(&mut participants(members), meets, dt, is_pushed);
    for ((member, tick), is_pushed) in members.iter_mut().zip(ticks).zip(is_pushed) {
        if let Some(tick) = tick
            && *is_pushed
        {
            member.cloth.scratch.detection.note_push(farthest);
            tick.note_push(&mut member.cloth.particles);
        }
    }
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
            Some(solver.begin(&mut cloth.particles, step, &cloth.scratch.pins))
        })
        .collect()
}

/// Ends the tick of each member. Returns the number of sub-steps that one needs, if these were too few.
fn end(members: &mut [Member], ticks: Few<Option<StartedTick>>, substeps: u32) -> Option<u32> {
    let mut wanted = None;
    for (member, tick) in members.iter_mut().zip(ticks) {
        let Member {
            cloth,
            step,
            may_repeat,
            ..
        } = member;
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
        let more = (cloth.state.control).observe(cloth.scratch.substepping, stretch);
        // If the tick is not begun again, the next one takes more.
        if *may_repeat {
            wanted = wanted.max(more);
        }
    }
    wanted
}

/// Warns of cloths that begin inside each other. A later tick, or this one done again, does not ask.
fn warn_of_inside(members: &mut [Member], contact: &MutualContact, names: &Query<Named>) {
    if members.len() < 2 || members.iter().all(|member| !member.cloth.scratch.begins) {
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
