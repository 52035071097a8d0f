//! The systems of a tick between preparation and write-back.

use bevy::{
    ecs::{change_detection::DetectChanges, entity::Entity, query::Without, system::Query},
    platform::time::Instant,
};

use super::{
    ClothContact, ClothContacts, ClothFault, ClothFrame, ClothSearch, ClothStats, ClothTopology,
    colliders::ColliderMotion,
    components::{BallInReach, ClothTick},
};
use crate::{
    cloth::{ClothMaterial, ClothParticles},
    contact::push_out,
    hierarchy::BoundRule,
    solver::{ClothSettings, Stretch, advance},
};

/// Brings the bounding spheres up to date.
pub(super) fn rebuild_hierarchies(
    mut cloths: Query<
        (
            &ClothTopology,
            &ClothParticles,
            &ClothSettings,
            &BoundRule,
            &ClothTick,
            &mut ClothSearch,
            &mut ClothStats,
        ),
        Without<ClothFault>,
    >,
) {
    for (topology, particles, settings, &rule, tick, mut search, mut stats) in &mut cloths {
        if tick.step.is_none() || !topology.fits(particles) {
            continue;
        }
        let start = Instant::now();
        search.bounds.rebuild(
            rule,
            &topology.tree,
            &topology.grid,
            particles,
            tick.stretch.bound,
            settings.particle_radius,
        );
        stats.rebuild_ms = milliseconds_since(start);
    }
}

/// Finds the particles that each collider may touch within the tick.
pub(super) fn query_collisions(
    mut cloths: Query<
        (
            &ClothTopology,
            &ClothParticles,
            &ClothFrame,
            &mut ClothSearch,
            &mut ClothTick,
            &mut ClothStats,
        ),
        Without<ClothFault>,
    >,
    colliders: Query<(Entity, &ColliderMotion), Without<ClothFault>>,
) {
    let travels = colliders.iter().map(|(_, motion)| motion.travel());
    let dragged = travels.fold(0.0, f32::max);
    for (topology, particles, frame, mut search, mut tick, mut stats) in &mut cloths {
        if tick.step.is_none() || !topology.fits(particles) {
            continue;
        }
        let start = Instant::now();
        let ClothSearch { bounds, query } = &mut *search;
        query.clear(&topology.tree);
        tick.balls.clear();
        // A particle gets as far as its own speed and gravity take it, or as the fastest ball drags it.
        let margin = tick.reach + dragged;
        for (collider, motion) in &colliders {
            let Some(ball) = motion.seen_from(frame) else {
                continue;
            };
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
    mut cloths: Query<
        (
            &ClothTopology,
            &ClothMaterial,
            &ClothSettings,
            &ClothSearch,
            &mut ClothParticles,
            &mut ClothTick,
            &mut ClothContacts,
            &mut ClothStats,
        ),
        Without<ClothFault>,
    >,
) {
    for (topology, material, settings, search, mut particles, mut tick, mut contacts, mut stats) in
        &mut cloths
    {
        // Taken: a cloth that is not prepared again does not move again.
        let Some(step) = tick.step.take() else {
            continue;
        };
        if !topology.fits(&particles) {
            continue;
        }
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
        let (radius, friction) = (settings.particle_radius, material.friction);
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
        *stretch = Stretch::measure(&topology.springs, &particles);
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
