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
            &mut ClothSearch,
            &mut ClothStats,
        ),
        Without<ClothFault>,
    >,
) {
    for (topology, particles, settings, &rule, mut search, mut stats) in &mut cloths {
        if !topology.fits(particles) {
            continue;
        }
        let start = Instant::now();
        search.bounds.rebuild(
            rule,
            &topology.tree,
            &topology.grid,
            particles,
            stats.stretch.bound,
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
    for (topology, particles, frame, mut search, mut tick, mut stats) in &mut cloths {
        if !topology.fits(particles) {
            continue;
        }
        let start = Instant::now();
        let ClothSearch { bounds, query } = &mut *search;
        query.clear(&topology.tree);
        tick.balls.clear();
        for (collider, motion) in &colliders {
            let Some(ball) = motion.seen_from(frame) else {
                continue;
            };
            // A particle gets as far as its own speed and gravity take it, or as a ball drags it.
            let margin = tick.reach + ball.travel();
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
        if !topology.fits(&particles) {
            continue;
        }
        let start = Instant::now();
        let ClothTick {
            step,
            pins,
            balls,
            touched,
            written,
            ..
        } = &mut *tick;
        // A schedule may run without time passing.
        if step.seconds > 0.0 {
            let candidates = search.query.candidates();
            let (radius, friction) = (settings.particle_radius, material.friction);
            advance(
                &mut particles,
                &topology.springs,
                *step,
                pins,
                |particles, substep| {
                    for BallInReach {
                        ball,
                        candidates: range,
                        deepest,
                        ..
                    } in &mut *balls
                    {
                        let candidates = &candidates[range.clone()];
                        let touched = &mut touched[range.clone()];
                        let depth = push_out(
                            particles, candidates, touched, ball, radius, friction, substep,
                        );
                        *deepest = deepest.max(depth);
                    }
                },
            );
            contacts.renew(balls.iter().map(|ball| {
                ClothContact {
                    collider: ball.collider,
                    particles: touched[ball.candidates.clone()]
                        .iter()
                        .filter(|&&touched| touched)
                        .count(),
                    deepest_penetration: ball.deepest,
                }
            }));
            stats.stretch = Stretch::measure(&topology.springs, &particles);
            *written = Some(particles.last_changed());
        }
        stats.contacts = contacts.iter().map(|contact| contact.particles).sum();
        stats.integrate_ms = milliseconds_since(start);
    }
}

fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1.0e3
}
