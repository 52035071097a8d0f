//! All sub-steps of a tick.

use bevy::{
    ecs::{change_detection::DetectChanges, entity::Entity, query::QueryData, system::Query},
    math::Vec3,
    platform::time::Instant,
    tasks::{ComputeTaskPool, available_parallelism},
};

use super::{
    ClothContacts, ClothFrame, ClothStats, ClothTopology, colliders::ColliderMotion,
    components::ClothTick,
};
use crate::{
    cloth::ClothParticles,
    contact::ColliderShape,
    hierarchy::Core,
    solver::{Load, Precision, Stretch, TickStep},
};

/// A cloth of fewer particles is solved by one task: two gain nothing at 128², and a factor of 1.7 at 256².
const LEAST_TO_SPLIT: usize = 192 * 192;

/// Cloths whose particles × sub-steps come to less are solved one after the other on this thread.
const LEAST_TO_SHARE: usize = 64 * 64 * 20;

#[derive(QueryData)]
#[query_data(mutable)]
pub(super) struct Integrating {
    topology: &'static ClothTopology,
    frame: &'static ClothFrame,
    particles: &'static mut ClothParticles,
    tick: &'static mut ClothTick,
    contacts: &'static mut ClothContacts,
    stats: &'static mut ClothStats,
}

/// Runs all sub-steps, of several cloths at once where there is enough to do.
pub(super) fn integrate(
    mut cloths: Query<Integrating>,
    colliders: Query<(Entity, &ColliderMotion)>,
) {
    let (mut awake, mut work) = (0, 0);
    for cloth in &cloths {
        if let Some(step) = cloth.tick.step
            && !cloth.tick.rest.is_asleep()
        {
            awake += 1;
            work += cloth.particles.len() * step.substeps as usize;
        }
    }
    if awake > 1 && work >= LEAST_TO_SHARE && threads() > 1 {
        cloths
            .par_iter_mut()
            .for_each(|mut cloth| cloth.integrate(&colliders));
    } else {
        cloths
            .iter_mut()
            .for_each(|mut cloth| cloth.integrate(&colliders));
    }
}

/// Threads that work on a tick: those of Bevy's compute pool, and the one that waits for them.
fn threads() -> usize {
    let pool = ComputeTaskPool::try_get().map_or(0, |pool| pool.thread_num());
    (pool + 1).min(available_parallelism())
}

impl IntegratingItem<'_, '_> {
    fn integrate(&mut self, colliders: &Query<(Entity, &ColliderMotion)>) {
        // Taken: a cloth that is not prepared again does not move again.
        let Some(step) = self.tick.step.take() else {
            return;
        };
        // A schedule may run without time passing.
        if !self.topology.fits(&self.particles) || step.seconds == 0.0 {
            return;
        }
        let is_asleep = self.tick.rest.is_asleep();
        self.stats.is_asleep = is_asleep;
        if is_asleep {
            self.stats.integrate_ms = 0.0;
            self.stats.substeps = 0;
            return;
        }
        let start = Instant::now();
        self.solve(step, colliders);
        self.stats.integrate_ms = milliseconds_since(start);
        self.tick.written = Some(self.particles.last_changed());
        self.contacts.renew(&self.tick.near, &self.tick.detection);
        self.stats.requeries = self.tick.detection.requeries();
        self.stats.stretch = self.tick.stretch;
        self.stats.contacts = self.contacts.iter().map(|contact| contact.particles).sum();
    }

    /// Does the tick, and does it again with more sub-steps while the tolerance asks for it.
    fn solve(&mut self, mut step: TickStep, colliders: &Query<(Entity, &ColliderMotion)>) {
        let precision = self.tick.precision;
        let bands = if self.particles.len() < LEAST_TO_SPLIT {
            1
        } else {
            threads()
        };
        self.tick.solver.set_bands(bands);
        let may_repeat = matches!(precision, Precision::Tolerance { .. });
        if may_repeat {
            self.tick.backup.copy_from(&self.particles);
        }
        self.stats.substeps = 0;
        loop {
            let stretch = self.advance(step, colliders);
            self.stats.substeps += step.substeps;
            self.tick.stretch = stretch;
            let Some(more) = self.tick.control.observe(precision, stretch) else {
                break;
            };
            step.substeps = more;
            self.particles.copy_from(&self.tick.backup);
            self.tick.detection.restart();
        }
        self.tick.load = Some(self.load(step));
    }

    /// What the tick's last run of sub-steps asked of the cloth.
    fn load(&self, step: TickStep) -> Load {
        let grid = self.topology.grid();
        let root = self
            .topology
            .tree
            .root_sphere(&self.particles, self.tick.stretch.bound);
        let spacing = grid.spacing().max_element();
        let count = step.substeps as f32;
        // Of those that come to the ball around the cloth, a capsule's turn counted.
        let around = root.radius() + self.tick.reach;
        let ways = self.tick.near.iter().filter_map(|(_, collider)| {
            let core = Core::Segment([collider.from.translation.into(), collider.to]);
            if !core.may_reach(root.center.into(), around + collider.shape.extent()) {
                return None;
            }
            let way = match collider.shape {
                ColliderShape::Ball { .. } => collider.travel(),
                _ => collider.drag(f32::INFINITY),
            };
            Load::way_of(collider.shape.radius()?, way / count, spacing)
        });
        Load {
            way: ways.fold(0.0, f32::max),
            stretch: self.tick.stretch.structural,
            precision: self.tick.precision,
            is_capped: self.tick.control.is_capped(),
            substep: step.seconds / count,
            damping: step.damping,
            given: self.tick.given_stretch,
            is_tethered: !self.tick.solver.tethers().is_empty(),
            masses: self.tick.masses,
            distance: (Vec3::from(root.center).length() - root.radius()).max(0.0),
            spacing: grid.spacing().min_element(),
        }
    }

    /// One way through the sub-steps.
    fn advance(&mut self, step: TickStep, colliders: &Query<(Entity, &ColliderMotion)>) -> Stretch {
        let ClothTick {
            solver,
            pins,
            near,
            near_set,
            detection,
            terms,
            ..
        } = &mut *self.tick;
        let frame = self.frame;
        solver.advance(&mut self.particles, step, pins, |particles, substep| {
            detection.respond(particles, terms, substep, |numbered| {
                // Those that were far away may be near now; who is known keeps its number.
                near_set.clear();
                near_set.extend(near.iter().map(|(known, _)| *known));
                for (entity, motion) in colliders {
                    if !near_set.contains(&entity)
                        && let Some(collider) = motion.seen_from(frame)
                    {
                        numbered.push((near.len(), collider));
                        near.push((entity, collider));
                    }
                }
            })
        })
    }
}

pub(super) fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1.0e3
}
