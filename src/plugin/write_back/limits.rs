//! Reports cloths that leave the envelope in which they are simulated well.

use bevy::{
    ecs::entity::EntityHashSet,
    prelude::{Entity, Local, Message, MessageWriter, Query, Reflect, warn},
};

use crate::{
    cloth::ClothParticles,
    plugin::{
        naming::{Named, Part},
        prepare::FAR,
        state::{ClothScratch, ClothState, ClothStats},
    },
    solver::ClothLimit,
};

/// Reports are gathered for this number of ticks, half a second at Bevy's 64 Hz, so that many cloths make one line of
/// the log.
const GATHERED: u32 = 32;

/// Sent when a cloth has been outside the envelope in which it is simulated well for more than an instant. The log says
/// so too, with the remedy: once for each limit, and again when it gets ten times worse.
#[derive(Message, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
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
struct Gathered {
    cloths: EntityHashSet,
    ticks: u32,
    worst: Option<Worst>,
}

/// The cloth that is farthest beyond a limit.
#[derive(Debug)]
struct Worst {
    name: String,
    /// Its quantity, and the largest good value of that.
    figures: [f32; 2],
    /// The colliders that it is caught between, if it is.
    caught: Option<String>,
}

/// Cloths to be logged.
#[derive(Debug, Default)]
pub(crate) struct Unsaid {
    limits: [Gathered; ClothLimit::ALL.len()],
    dragged: Gathered,
}

impl Gathered {
    fn add(
        &mut self,
        cloth: Entity,
        figures: [f32; 2],
        describe: impl FnOnce() -> (String, Option<String>),
    ) {
        self.cloths.insert(cloth);
        // The limit of failed sub-steps is 0.
        let excess = |[quantity, good]: [f32; 2]| match good {
            0.0 => quantity,
            _ => quantity / good,
        };
        let known = self.worst.as_ref().map(|worst| excess(worst.figures));
        if known.is_none_or(|worst| excess(figures) > worst) {
            let (name, caught) = describe();
            self.worst = Some(Worst {
                name,
                figures,
                caught,
            });
        }
    }

    /// Counts a tick. Returns the number of cloths to log and the worst of them, if there are any.
    fn take(&mut self) -> Option<(usize, Worst)> {
        self.ticks += u32::from(!self.cloths.is_empty());
        if self.ticks < GATHERED {
            return None;
        }
        let Self { cloths, worst, .. } = std::mem::take(self);
        Some((cloths.len(), worst?))
    }

    /// A tick has passed. Returns what is to be logged of a limit, if anything is.
    fn line(&mut self, limit: ClothLimit) -> Option<String> {
        let (cloths, worst) = self.take()?;
        let (name, figures) = (worst.name, limit.figures(worst.figures));
        let remedy = worst.caught.map_or(limit.remedy().into(), |colliders| {
            format!(
                "caught between {colliders}: move them apart, or let it meet fewer of them with `ClothLayers`"
            )
        });
        Some(if cloths == 1 {
            format!("{name} is {limit}: {figures}: {remedy}")
        } else {
            format!("{cloths} cloths are {limit}, {name} most: {figures}: {remedy}")
        })
    }

    /// A tick has passed. Returns what is to be logged of jumps that drag cloths along, if anything is.
    fn drag_line(&mut self) -> Option<String> {
        let (cloths, worst) = self.take()?;
        let (name, [displacement, limit]) = (worst.name, worst.figures);
        let (name, most) = match cloths {
            1 => (format!("{name} was"), String::new()),
            _ => (format!("{cloths} cloths were"), format!(", {name} most")),
        };
        Some(format!(
            "{name} dragged along by a jump{most}: {displacement:.1} m in a tick (limit {limit} m): insert `ClothTeleport` on the cloth in the tick of the jump, or give its character a `ClothInertia`, which teleports it beyond `teleport_distance`"
        ))
    }
}

/// What a cloth is looked at by.
type Reported = (
    Named,
    &'static ClothParticles,
    &'static mut ClothState,
    &'static mut ClothScratch,
    &'static mut ClothStats,
);

/// Looks at every cloth that moved in the tick.
pub(crate) fn report_limits(
    mut cloths: Query<Reported>,
    names: Query<Named>,
    mut exceeded: MessageWriter<ClothLimitExceeded>,
    mut unsaid: Local<Unsaid>,
) {
    let Unsaid { limits, dragged } = &mut *unsaid;
    for (name, particles, mut state, mut scratch, mut stats) in &mut cloths {
        // Kept while the cloth sleeps or is frozen; not written, so that change detection does not see it.
        let Some(limit_inputs) = scratch.limit_inputs else {
            continue;
        };
        scratch.limit_inputs = None;
        stats.exceeded = None;
        scratch.settling = match scratch.dragged > 0.0 {
            true => GATHERED,
            false => scratch.settling.saturating_sub(1),
        };
        if scratch.dragged > 0.0 && !state.reported.was_dragged {
            state.reported.was_dragged = true;
            let describe = || (name.describe(Part::Cloth), None);
            dragged.add(name.entity, [scratch.dragged, FAR], describe);
        }
        // Longer sub-steps stretch more, and the level of detail asked for them.
        let is_coarse = state.lod.moved_by() > 1;
        for (index, limit) in ClothLimit::ALL.into_iter().enumerate() {
            if is_coarse && limit != ClothLimit::Layers {
                continue;
            }
            let beyond = limit_inputs.exceeded(limit);
            stats.exceeded = stats.exceeded.or(beyond.map(|_| limit));
            let is_stretch = matches!(limit, ClothLimit::Stretch | ClothLimit::Tolerance);
            // A jump stretches the cloth, and is logged itself.
            if is_stretch && scratch.settling > 0 {
                continue;
            }
            let is_reported =
                state.reported.excess[index].observe(limit, beyond.map(|[quantity, _]| quantity));
            if let Some([quantity, good_up_to]) = beyond
                && is_reported
            {
                exceeded.write(ClothLimitExceeded {
                    cloth: name.entity,
                    limit,
                    quantity,
                    good_up_to,
                });
                limits[index].add(name.entity, [quantity, good_up_to], || {
                    let caught = is_stretch.then(|| catchers(&scratch, particles, &names));
                    (name.describe(Part::Cloth), caught.flatten())
                });
            }
        }
    }
    let lines = ClothLimit::ALL.into_iter().zip(limits);
    let lines = lines.filter_map(|(limit, gathered)| gathered.line(limit));
    for line in lines.chain(dragged.drag_line()) {
        warn!("{line}");
    }
}

/// Which two colliders a cloth is caught between, if it is.
fn catchers(
    scratch: &ClothScratch,
    particles: &ClothParticles,
    names: &Query<Named>,
) -> Option<String> {
    let colliders = scratch.detection.caught_between(particles)?;
    let [first, second] = colliders.map(|id| {
        let (entity, _) = *scratch.near.get(id)?;
        Some(names.get(entity).ok()?.describe(Part::Collider))
    });
    Some(format!("{} and {}", first?, second?))
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
                    let name = || (format!("cloth \"flag {cloth}\""), None);
                    let entity = Entity::from_raw_u32(cloth).expect("an entity");
                    gathered.add(entity, [stretch, 0.15], name);
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
            let name = || ("cloth \"flag\"".into(), None);
            gathered.add(Entity::PLACEHOLDER, [stretch, 0.15], name);
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
