//! The systems of a tick between preparation and write-back.

use bevy::{
    ecs::{change_detection::DetectChanges, entity::Entity, system::Query},
    platform::time::Instant,
};

use super::{
    ClothContact, ClothContacts, ClothFrame, ClothSearch, ClothStats, ClothTopology,
    colliders::ColliderMotion,
    components::{BallInReach, ClothTick},
};
use crate::{
    cloth::ClothParticles,
    contact::{MovingBall, push_out},
    solver::{Stretch, advance},
};

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

/// Finds the particles that each collider may touch within the tick.
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
        query.clear(&topology.tree);
        tick.balls.clear();
        // Besides by itself, a particle may get as far as a ball drags it, of those that come near the cloth.
        let root = bounds.sphere(&topology.tree, particles, 0);
        let balls = || {
            let seen = |(collider, motion): (Entity, &ColliderMotion)| {
                Some((collider, motion.seen_from(frame)?))
            };
            colliders.iter().filter_map(seen)
        };
        let comes_near = |ball: &MovingBall| {
            let probe = ball.probe(tick.reach + ball.drag(), bounds.particle_radius());
            let reach = probe.radius + root.radius();
            probe.centre.distance_squared(root.center.into()) <= reach * reach
        };
        let near = balls().filter(|(_, ball)| comes_near(ball));
        let dragged = near.map(|(_, ball)| ball.drag()).fold(0.0, f32::max);
        let margin = tick.reach + dragged;
        for (collider, ball) in balls() {
            let probe = ball.probe(margin, bounds.particle_radius());
            let candidates = query.search(&topology.tree, bounds, particles, &probe);
            if !candidates.is_empty() {
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

/// Runs all sub-steps.
pub(super) fn integrate(
    mut cloths: Query<(
        &ClothTopology,
        &ClothSearch,
        &mut ClothParticles,
        &mut ClothTick,
        &mut ClothContacts,
        &mut ClothStats,
    )>,
) {
    for (topology, search, mut particles, mut tick, mut contacts, mut stats) in &mut cloths {
        // Taken: a cloth that is not prepared again does not move again.
        let Some(step) = tick.step.take() else {
            continue;
        };
        if !topology.fits(&particles) {
            continue;
        }
        let (radius, friction) = (tick.particle_radius, tick.friction);
        let ClothTick {
            stretch,
            pins,
            balls,
            touched,
            written,
            ..
        } = &mut *tick;
        // A schedule may run without time passing.
        if step.seconds == 0.0 {
            continue;
        }
        let candidates = search.query.candidates();
        let respond = |particles: &mut ClothParticles, substep| {
            for in_reach in &mut *balls {
                let range = in_reach.candidates.clone();
                let depth = push_out(
                    particles,
                    &candidates[range.clone()],
                    &mut touched[range],
                    &in_reach.ball,
                    radius,
                    friction,
                    substep,
                );
                in_reach.deepest = in_reach.deepest.max(depth);
            }
        };
        let start = Instant::now();
        advance(&mut particles, &topology.springs, step, pins, respond);
        stats.integrate_ms = milliseconds_since(start);
        let start = Instant::now();
        *stretch = Stretch::measure(&topology.springs, &particles);
        stats.rebuild_ms += milliseconds_since(start);
        *written = Some(particles.last_changed());
        contacts.renew(balls.iter().map(|in_reach| {
            let touched = &touched[in_reach.candidates.clone()];
            ClothContact {
                collider: in_reach.collider,
                particles: touched.iter().filter(|&&touched| touched).count(),
                deepest_penetration: in_reach.deepest,
            }
        }));
        stats.stretch = *stretch;
        stats.contacts = contacts.iter().map(|contact| contact.particles).sum();
    }
}

fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1.0e3
}
