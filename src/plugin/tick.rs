//! The systems of a tick between preparation and write-back.

use bevy::{
    ecs::{
        change_detection::{DetectChanges, Mut},
        entity::Entity,
        query::QueryData,
        system::Query,
    },
    log::warn,
    platform::time::Instant,
    tasks::{ComputeTaskPool, available_parallelism},
};

use super::{
    ClothContact, ClothContacts, ClothFrame, ClothSearch, ClothStats, ClothTopology,
    colliders::ColliderMotion,
    components::{BallInReach, ClothTick},
};
use crate::{
    cloth::ClothParticles,
    contact::{MovingBall, push_out},
    solver::{Precision, Stretch, TickStep},
};

/// A cloth of fewer particles is solved by one task: two gain nothing at 128², and a factor of 1.7 at 256².
const LEAST_TO_SPLIT: usize = 192 * 192;

/// Cloths whose particles × sub-steps come to less are solved one after the other on this thread.
const LEAST_TO_SHARE: usize = 64 * 64 * 20;

/// Brings the bounding spheres up to date.
pub(super) fn rebuild_hierarchies(
    mut cloths: Query<(
        &ClothTopology,
        &ClothParticles,
        &ClothTick,
        &mut ClothSearch,
        &mut ClothStats,
    )>,
) {
    for (topology, particles, tick, mut search, mut stats) in &mut cloths {
        if tick.step.is_none() || !topology.fits(particles) {
            continue;
        }
        // The spheres of a cloth that sleeps stay where they are.
        let is_known = search.bounds.rule() == tick.rule
            && search.bounds.particle_radius() == tick.particle_radius;
        if tick.rest.is_asleep() && is_known {
            stats.rebuild_ms = 0.0;
            continue;
        }
        let start = Instant::now();
        search.bounds.rebuild(
            tick.rule,
            &topology.tree,
            &topology.grid,
            particles,
            tick.stretch.bound,
            tick.particle_radius,
        );
        stats.rebuild_ms = milliseconds_since(start);
    }
}

/// Finds the particles that each collider may touch within the tick. What comes near a cloth that sleeps, or
/// leaves it, wakes it.
pub(super) fn query_collisions(
    mut cloths: Query<(
        &ClothTopology,
        &ClothParticles,
        &ClothFrame,
        &mut ClothSearch,
        &mut ClothTick,
        &mut ClothStats,
    )>,
    colliders: Query<(Entity, &ColliderMotion)>,
) {
    for (topology, particles, frame, mut search, mut tick, mut stats) in &mut cloths {
        if tick.step.is_none() || !topology.fits(particles) {
            continue;
        }
        let start = Instant::now();
        let ClothSearch { bounds, query } = &mut *search;
        // Besides by itself, a particle may get as far as a ball drags it, of those that come near the cloth.
        let root = bounds.sphere(&topology.tree, particles, 0);
        let balls = || {
            let seen = |(collider, motion): (Entity, &ColliderMotion)| {
                Some((collider, motion.seen_from(frame)?))
            };
            colliders.iter().filter_map(seen)
        };
        let comes_near = |ball: &MovingBall, reach: f32| {
            let probe = ball.probe(reach + ball.drag(), bounds.particle_radius());
            let reach = probe.radius + root.radius();
            probe.centre.distance_squared(root.center.into()) <= reach * reach
        };
        if tick.rest.is_asleep() {
            let rests_on = |collider: Entity, ball: &MovingBall| {
                let known = tick.balls.iter().find(|known| known.collider == collider);
                known.is_some_and(|known| known.ball == *ball)
            };
            let touches = |ball: &MovingBall| {
                // Nothing of the cloth moves towards it.
                let probe = ball.probe(0.0, bounds.particle_radius());
                query.finds_any(&topology.tree, bounds, particles, &probe)
            };
            let still = balls().filter(|(collider, ball)| rests_on(*collider, ball));
            let goes_on = still.count() == tick.balls.len()
                && balls()
                    .filter(|(collider, ball)| comes_near(ball, 0.0) && !rests_on(*collider, ball))
                    .all(|(_, ball)| !touches(&ball));
            if goes_on {
                stats.query_ms = milliseconds_since(start);
                continue;
            }
            tick.rest.disturb();
        }
        query.clear(&topology.tree);
        tick.balls.clear();
        let near = balls().filter(|(_, ball)| comes_near(ball, tick.reach));
        let dragged = near.map(|(_, ball)| ball.drag()).fold(0.0, f32::max);
        let margin = tick.reach + dragged;
        for (collider, ball) in balls() {
            let probe = ball.probe(margin, bounds.particle_radius());
            let candidates = query.search(&topology.tree, bounds, particles, &probe);
            if !candidates.is_empty() {
                if ball.drag() > 0.0 {
                    tick.rest.disturb();
                }
                tick.balls.push(BallInReach {
                    collider,
                    ball,
                    candidates,
                    deepest: 0.0,
                });
            }
        }
        tick.touched.clear();
        tick.touched.resize(query.candidates().len(), false);
        stats.nodes_visited = query.nodes_visited();
        stats.leaf_tests = query.leaf_tests();
        stats.query_ms = milliseconds_since(start);
    }
}

#[derive(QueryData)]
#[query_data(mutable)]
pub(super) struct Integrating {
    entity: Entity,
    topology: &'static ClothTopology,
    search: &'static ClothSearch,
    particles: &'static mut ClothParticles,
    tick: &'static mut ClothTick,
    contacts: &'static mut ClothContacts,
    stats: &'static mut ClothStats,
}

/// Runs all sub-steps, of several cloths at once where there is enough to do.
pub(super) fn integrate(mut cloths: Query<Integrating>) {
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
            .for_each(|mut cloth| cloth.integrate());
    } else {
        cloths.iter_mut().for_each(|mut cloth| cloth.integrate());
    }
}

/// Threads that work on a tick: those of Bevy's compute pool, and the one that waits for them.
fn threads() -> usize {
    let pool = ComputeTaskPool::try_get().map_or(0, |pool| pool.thread_num());
    (pool + 1).min(available_parallelism())
}

impl IntegratingItem<'_, '_> {
    fn integrate(&mut self) {
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
        self.solve(step);
        self.stats.integrate_ms = milliseconds_since(start);
        self.tick.written = Some(self.particles.last_changed());
        let ClothTick { balls, touched, .. } = &*self.tick;
        self.contacts.renew(balls.iter().map(|in_reach| {
            let touched = &touched[in_reach.candidates.clone()];
            ClothContact {
                collider: in_reach.collider,
                particles: touched.iter().filter(|&&touched| touched).count(),
                deepest_penetration: in_reach.deepest,
            }
        }));
        self.stats.stretch = self.tick.stretch;
        self.stats.contacts = self.contacts.iter().map(|contact| contact.particles).sum();
    }

    /// Does the tick, and does it again with more sub-steps while the tolerance asks for it.
    fn solve(&mut self, mut step: TickStep) {
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
            let stretch = advance(&mut self.particles, &mut self.tick, self.search, step);
            self.stats.substeps += step.substeps;
            self.tick.stretch = stretch;
            let Some(more) = self.tick.control.observe(precision, stretch) else {
                break;
            };
            step.substeps = more;
            self.particles.copy_from(&self.tick.backup);
            self.tick.touched.fill(false);
            self.tick
                .balls
                .iter_mut()
                .for_each(|in_reach| in_reach.deepest = 0.0);
        }
        let is_capped = self.tick.control.is_capped();
        if is_capped && !self.tick.cap_is_told {
            self.tick.cap_is_told = true;
            warn!(
                "{} is stretched by {:.1} %, beyond its tolerance: {} sub-steps a tick, the most that its settings allow, do not suffice",
                self.entity,
                100.0 * self.tick.stretch.structural,
                step.substeps,
            );
        }
    }
}

fn advance(
    particles: &mut Mut<ClothParticles>,
    tick: &mut ClothTick,
    search: &ClothSearch,
    step: TickStep,
) -> Stretch {
    let ClothTick {
        solver,
        pins,
        balls,
        touched,
        particle_radius,
        friction,
        ..
    } = tick;
    let candidates = search.query.candidates();
    solver.advance(particles, step, pins, |particles, substep| {
        let mut has_moved = false;
        for in_reach in &mut *balls {
            let range = in_reach.candidates.clone();
            let depth = push_out(
                particles,
                &candidates[range.clone()],
                &mut touched[range],
                &in_reach.ball,
                *particle_radius,
                *friction,
                substep,
            );
            in_reach.deepest = in_reach.deepest.max(depth);
            has_moved |= depth > 0.0;
        }
        has_moved
    })
}

fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1.0e3
}
