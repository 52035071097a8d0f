//! The cloths of an island, in their tick.

use bevy::{
    ecs::entity::EntityIndexSet,
    prelude::{Isometry3d, Query},
};

use smallvec::SmallVec;

use super::tick::{IntegrateQuery, IntegrateQueryItem};
use crate::{
    contact::Participant,
    solver::{SeamCloth, Substepping, TickStep},
};

/// One for each cloth or seam of an island. Up to eight are not on the heap.
pub(super) type Few<T> = SmallVec<[T; 8]>;

/// A cloth in its tick, alone or in an island.
pub(super) struct Member<'w, 's> {
    pub cloth: IntegrateQueryItem<'w, 's>,
    /// `None` of one that sleeps.
    pub step: Option<TickStep>,
    pub to_common: Option<Isometry3d>,
    /// Whether its tick is done again if it takes too few sub-steps.
    pub may_repeat: bool,
}

/// The cloths of an island that are moved in the tick, and those that sleep in it. Those that touch cloth come first.
pub(super) fn members<'w, 's>(
    cloths: &'w mut Query<'_, 's, IntegrateQuery>,
    entities: &EntityIndexSet,
) -> Few<Member<'w, 's>> {
    let each = cloths.iter_many_unique_mut(entities);
    let mut members: Few<Member> = each.filter_map(Member::of).collect();
    // Only a tolerance is worth the search for layers that a repetition takes.
    for member in &mut members {
        let substepping = member.cloth.scratch.substepping;
        member.may_repeat &= matches!(substepping, Substepping::Adaptive { .. });
    }
    members.sort_by_key(|member| member.cloth.scratch.self_collision.is_none());
    let first = members.first().map(|first| first.cloth.frame.isometry());
    for member in members.iter_mut().skip(1) {
        let frame = member.cloth.frame.isometry();
        member.to_common = first.map(|first| first.inverse() * frame);
    }
    members
}

/// Those that touch cloth.
pub(super) fn participants<'a>(members: &'a mut [Member]) -> Few<Participant<'a>> {
    let each = members.iter_mut();
    each.filter_map(|member| {
        let cloth = &mut member.cloth;
        Some(Participant {
            settings: cloth.scratch.self_collision?,
            thickness: (cloth.built.from.as_ref())
                .and_then(|from| from.factors.thickness.as_deref()),
            particles: &mut cloth.particles,
            sheet: cloth.built.shared.sheet(),
            to_common: member.to_common,
            is_fixed: cloth.state.rest.is_asleep(),
        })
    })
    .collect()
}

impl<'w, 's> Member<'w, 's> {
    /// A cloth, unless it is not moved in the tick.
    pub fn of(mut cloth: IntegrateQueryItem<'w, 's>) -> Option<Self> {
        let is_asleep = cloth.state.rest.is_asleep();
        // One that sleeps stays prepared while nothing changes. Any other has to be prepared again before it moves again.
        let step = match is_asleep {
            true => cloth.scratch.step,
            false => cloth.scratch.step.take(),
        }?;
        // A schedule may run without time passing.
        if !cloth.built.matches(&cloth.particles) || step.seconds == 0.0 {
            return None;
        }
        cloth.stats.is_asleep = is_asleep;
        (cloth.stats.integrate_ms, cloth.stats.substeps) = (0.0, 0);
        cloth.stats.sleeping_particles = 0;
        Some(Self {
            may_repeat: !is_asleep && cloth.may_repeat(),
            cloth,
            step: (!is_asleep).then_some(step),
            to_common: None,
        })
    }

    /// As a seam sees it.
    pub fn sewn(&mut self, to_common: Option<Isometry3d>) -> SeamCloth<'_> {
        SeamCloth {
            particles: &mut self.cloth.particles,
            to_common,
            is_fixed: self.step.is_none(),
        }
    }
}
