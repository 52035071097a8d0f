//! Reports cloths that leave the envelope in which they are simulated well.

use bevy::{
    ecs::{
        entity::{Entity, EntityHashSet},
        message::{Message, MessageWriter},
        system::{Local, Query},
    },
    log::warn,
    reflect::Reflect,
};

use super::{
    ClothScratch, ClothState, ClothStats,
    naming::{Named, Part},
};
use crate::solver::ClothLimit;

/// Reports are gathered for this number of ticks, half a second at Bevy's 64 Hz, so that many cloths make one line of
/// the log.
const GATHERED: u32 = 32;

/// Sent when a cloth has been outside the envelope in which it is simulated well for more than an instant. The log says
/// so too, with the remedy: once for each limit, and again when it gets ten times worse.
#[derive(Message, Reflect, Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ClothLimitExceeded {
    /// The cloth.
    pub cloth: Entity,
    /// The limit that it exceeds.
    pub limit: ClothLimit,
    /// The value of the limited quantity: a stretch, a ratio of masses, a distance (m), a damping, a travel in radii,
    /// or a number of sub-steps.
    pub quantity: f32,
    /// The largest value at which the cloth is simulated well.
    pub good_up_to: f32,
}

/// Cloths beyond one limit that the log does not know of yet.
#[derive(Debug, Default)]
pub(super) struct Gathered {
    cloths: EntityHashSet,
    ticks: u32,
    /// The cloth that is farthest beyond the limit, with its quantity and the largest good value of that.
    worst: Option<(String, [f32; 2])>,
}

impl Gathered {
    fn add(&mut self, cloth: Entity, name: impl FnOnce() -> String, quantity: [f32; 2]) {
        self.cloths.insert(cloth);
        // The limit of failed sub-steps is 0.
        let excess = |[quantity, good]: [f32; 2]| match good {
            0.0 => quantity,
            _ => quantity / good,
        };
        let known = self.worst.as_ref().map(|(_, worst)| excess(*worst));
        if known.is_none_or(|worst| excess(quantity) > worst) {
            self.worst = Some((name(), quantity));
        }
    }

    /// Counts a tick. Returns the line to log, if there is one.
    fn line(&mut self, limit: ClothLimit) -> Option<String> {
        self.ticks += u32::from(!self.cloths.is_empty());
        if self.ticks < GATHERED {
            return None;
        }
        let Self { cloths, worst, .. } = std::mem::take(self);
        let (name, quantity) = worst?;
        let (figures, remedy) = (limit.figures(quantity), limit.remedy());
        let cloths = cloths.len();
        Some(if cloths == 1 {
            format!("{name} is {limit}: {figures}: {remedy}")
        } else {
            format!("{cloths} cloths are {limit}, {name} most: {figures}: {remedy}")
        })
    }
}

/// Looks at every cloth that moved in the tick.
pub(super) fn report_limits(
    mut cloths: Query<(Named, &mut ClothState, &mut ClothScratch, &mut ClothStats)>,
    mut exceeded: MessageWriter<ClothLimitExceeded>,
    mut gathered: Local<[Gathered; ClothLimit::ALL.len()]>,
) {
    for (name, mut state, mut scratch, mut stats) in &mut cloths {
        // Kept while the cloth sleeps or is frozen; not written, so that change detection does not see it.
        let Some(limit_inputs) = scratch.limit_inputs else {
            continue;
        };
        scratch.limit_inputs = None;
        stats.exceeded = None;
        // Longer sub-steps stretch more, and the level of detail asked for them.
        let is_coarse = state.lod.moved_by() > 1;
        for (index, limit) in ClothLimit::ALL.into_iter().enumerate() {
            if is_coarse && limit != ClothLimit::Layers {
                continue;
            }
            let beyond = limit_inputs.exceeded(limit);
            stats.exceeded = stats.exceeded.or(beyond.map(|_| limit));
            let is_reported =
                state.excess[index].observe(limit, beyond.map(|[quantity, _]| quantity));
            if let Some([quantity, good_up_to]) = beyond
                && is_reported
            {
                exceeded.write(ClothLimitExceeded {
                    cloth: name.entity,
                    limit,
                    quantity,
                    good_up_to,
                });
                let figures = [quantity, good_up_to];
                gathered[index].add(name.entity, || name.describe(Part::Cloth), figures);
            }
        }
    }
    for (limit, gathered) in ClothLimit::ALL.into_iter().zip(&mut *gathered) {
        if let Some(line) = gathered.line(limit) {
            warn!("{line}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: ClothLimit = ClothLimit::Stretch;

    /// Sixty cloths within half a second are one line with the worst of them.
    #[test]
    fn many_are_one_line() {
        let mut gathered = Gathered::default();
        let mut lines = Vec::new();
        for tick in 0..200 {
            if tick < 30 {
                for cloth in [2 * tick, 2 * tick + 1] {
                    let stretch = if cloth == 17 { 0.31 } else { 0.2 };
                    let name = || format!("cloth \"flag {cloth}\"");
                    let entity = Entity::from_raw_u32(cloth).expect("an entity");
                    gathered.add(entity, name, [stretch, 0.15]);
                }
            }
            lines.extend(gathered.line(LIMIT));
        }
        let expected = "60 cloths are overstretched, cloth \"flag 17\" most: 31 % (limit 15 %): ";
        assert!(
            matches!(&lines[..], [line] if line.starts_with(expected)),
            "{lines:?}"
        );
    }

    #[test]
    fn one_is_named_with_its_figures() {
        let mut gathered = Gathered::default();
        let mut add = |stretch| {
            gathered.add(
                Entity::PLACEHOLDER,
                || "cloth \"flag\"".into(),
                [stretch, 0.15],
            );
        };
        // Ten times worse within the same half second is one cloth all the same.
        add(0.031);
        add(0.31);
        let line = (0..GATHERED).find_map(|_| gathered.line(LIMIT));
        let line = line.expect("a line");
        let expected = "cloth \"flag\" is overstretched: 31 % (limit 15 %): ";
        assert!(line.starts_with(expected), "{line}");
    }
}
