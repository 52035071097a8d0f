//! All sub-steps of a tick.

use bevy::{
    ecs::{change_detection::DetectChanges, entity::Entity, query::QueryData, system::Query},
    math::Vec3,
    platform::time::Instant,
    tasks::{ComputeTaskPool, available_parallelism},
};

use super::{
    ClothBuilt, ClothContacts, ClothFrame, ClothScratch, ClothState, ClothStats,
    clock::milliseconds_since, colliders::ColliderMotion,
};
use crate::{
    cloth::ClothParticles,
    contact::ColliderShape,
    hierarchy::Core,
    solver::{LimitInputs, Stretch, Substepping, TickStep},
};

/// A cloth of fewer particles is solved by one task: two gain nothing at 128², and a factor of 1.3 at 256², 1.4 at 512².
const MIN_TO_SPLIT: usize = 256 * 256;

/// Cloths whose particles × sub-steps come to less are solved one after the other on this thread.
const MIN_TO_SHARE: usize = 64 * 64 * 20;

#[derive(QueryData)]
#[query_data(mutable)]
pub(super) struct Integrating {
    built: &'static mut ClothBuilt,
    frame: &'static ClothFrame,
    particles: &'static mut ClothParticles,
    state: &'static mut ClothState,
    scratch: &'static mut ClothScratch,
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
        if let Some(step) = cloth.scratch.step
            && !cloth.state.rest.is_asleep()
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

/// Threads that work on a tick: those of Bevy's compute pool, and the one that waits for them.
fn threads() -> usize {
    let pool = ComputeTaskPool::try_get().map_or(0, |pool| pool.thread_num());
    (pool + 1).min(available_parallelism())
}

impl IntegratingItem<'_, '_> {
    fn integrate(&mut self, colliders: &Query<(Entity, &ColliderMotion)>) {
        // Taken: a cloth that is not prepared again does not move again.
        let Some(step) = self.scratch.step.take() else {
            return;
        };
        // A schedule may run without time passing.
        if !self.built.matches(&self.particles) || step.seconds == 0.0 {
            return;
        }
        let is_asleep = self.state.rest.is_asleep();
        self.stats.is_asleep = is_asleep;
        if is_asleep {
            self.stats.integrate_ms = 0.0;
            self.stats.substeps = 0;
            return;
        }
        let start = Instant::now();
        self.solve(step, colliders);
        self.stats.integrate_ms = milliseconds_since(start);
        self.state.written = Some(self.particles.last_changed());
        self.remember_contacts();
        self.contacts
            .renew(&self.scratch.near, &self.scratch.detection);
        self.stats.requeries = self.scratch.detection.requeries();
        self.stats.stretch = self.state.stretch;
        self.stats.contacts = self.contacts.iter().map(|contact| contact.particles).sum();
    }

    /// What the cloth touches now, should it fall asleep.
    fn remember_contacts(&mut self) {
        let ClothScratch {
            near, detection, ..
        } = &*self.scratch;
        let touches = detection.touches().iter();
        let known =
            touches.filter_map(|touch| Some((near.get(touch.id)?.0, touch.collider.clone())));
        self.state.rests_on.clear();
        self.state.rests_on.extend(known);
    }

    /// Does the tick, and does it again with more sub-steps while the tolerance asks for it.
    fn solve(&mut self, mut step: TickStep, colliders: &Query<(Entity, &ColliderMotion)>) {
        let substepping = self.scratch.substepping;
        let bands = if self.particles.len() < MIN_TO_SPLIT {
            1
        } else {
            threads()
        };
        self.built.solver.set_bands(bands);
        let may_repeat = matches!(substepping, Substepping::Adaptive { .. });
        if may_repeat {
            self.scratch.backup.copy_from(&self.particles);
        }
        self.stats.substeps = 0;
        loop {
            let stretch = self.advance(step, colliders);
            self.stats.substeps += step.substeps;
            self.state.stretch = stretch;
            let Some(more) = self.state.control.observe(substepping, stretch) else {
                break;
            };
            step.substeps = more;
            self.particles.copy_from(&self.scratch.backup);
            self.scratch.detection.restart();
        }
        self.scratch.limit_inputs = Some(self.limit_inputs(step));
    }

    /// What the tick's last run of sub-steps asked of the cloth.
    fn limit_inputs(&self, step: TickStep) -> LimitInputs {
        let spacing = self.built.surface().spacing();
        let root = self
            .built
            .tree()
            .root_sphere(&self.particles, self.state.stretch.bound);
        let count = step.substeps as f32;
        // Of those that come to the ball around the cloth, a capsule's turn counted.
        let around = root.radius() + self.scratch.reach;
        let travels = self.scratch.near.iter().filter_map(|(_, collider)| {
            let core = Core::Segment([collider.from.translation.into(), collider.to]);
            if !core.may_reach(root.center.into(), around + collider.shape.extent()) {
                return None;
            }
            let travel = match collider.shape {
                ColliderShape::Ball { .. } => collider.travel(),
                _ => collider.max_surface_travel(f32::INFINITY),
            };
            LimitInputs::travel_in_radii(collider.shape.radius()?, travel / count, spacing.longest)
        });
        LimitInputs {
            collider_travel: travels.fold(0.0, f32::max),
            stretch: self.state.stretch.structural,
            substepping: self.scratch.substepping,
            is_beyond: self.state.control.is_beyond(),
            substep: step.seconds / count,
            damping: step.damping,
            material_stretch: self.built.material_stretch,
            holds_weight: self.built.surface().as_grid().is_some()
                || !self.built.solver.tethers().is_empty(),
            masses: self.built.masses,
            distance: (Vec3::from(root.center).length() - root.radius()).max(0.0),
            spacing: spacing.shortest,
        }
    }

    /// One way through the sub-steps.
    fn advance(&mut self, step: TickStep, colliders: &Query<(Entity, &ColliderMotion)>) -> Stretch {
        let ClothScratch {
            pins,
            near,
            near_set,
            detection,
            contact_settings,
            ..
        } = &mut *self.scratch;
        let solver = &mut self.built.solver;
        let frame = self.frame;
        solver.advance(&mut self.particles, step, pins, |particles, substep| {
            detection.respond(particles, contact_settings, substep, |numbered| {
                // Those that were far away may be near now; who is known keeps its number.
                near_set.clear();
                near_set.extend(near.iter().map(|(known, _)| *known));
                for (entity, motion) in colliders {
                    if !near_set.contains(&entity)
                        && let Some(collider) = motion.seen_from(frame)
                    {
                        numbered.push((near.len(), collider.clone()));
                        near.push((entity, collider));
                    }
                }
            })
        })
    }
}
