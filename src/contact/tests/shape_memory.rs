//! That what is remembered of edges changes nothing: against a cloth that remembers nothing.

use std::sync::Arc;

use bevy::math::{Isometry3d, Vec3};
use proptest::prelude::*;

use super::{
    begin_with_all, build,
    random::{Random, many_cases},
};
use crate::{
    cloth::{ClothParticles, Surface},
    contact::{
        candidates::{ContactPoint, ContactSettings, NarrowPhase},
        colliders::{ClothCollider, ColliderShape, MovingCollider},
        detection::Detection,
    },
    solver::SubStep,
};

const SPACING: f32 = 0.06;
const SIDE: u32 = 12;
const SUBSTEPS: u32 = 12;
const TICKS: usize = 3;

/// Something with edges, as large as a few cells.
fn shape(random: &mut Random) -> ColliderShape {
    let collider = match random.below(6) {
        0 => ClothCollider::trimesh(
            vec![Vec3::ZERO, Vec3::X * 0.3, Vec3::Y * 0.3, Vec3::Z * 0.3],
            vec![[0, 1, 2], [0, 2, 3]],
        ),
        1 => {
            let heights: Vec<f32> = (0..36).map(|_| random.between(0.0, 0.1)).collect();
            ClothCollider::heightfield(heights, 6, Vec3::new(0.6, 1.0, 0.6))
        }
        2 | 3 => {
            let mut length = || random.between(0.02, 0.5);
            ClothCollider::cuboid(length(), length(), length())
        }
        _ => random.geometry(),
    };
    collider.scaled(Vec3::ONE).expect("a valid collider")
}

/// Contact with one collider, from tick to tick.
struct Memory<'a> {
    known: Detection,
    surface: &'a Arc<Surface>,
    settings: &'a ContactSettings,
}

impl<'a> Memory<'a> {
    fn new(surface: &'a Arc<Surface>, settings: &'a ContactSettings) -> Self {
        Self {
            known: Detection::default(),
            surface,
            settings,
        }
    }

    /// Begins a tick in which all particles are tested, with the collider under a number.
    fn begin(&mut self, id: usize, collider: &MovingCollider, particles: &ClothParticles) {
        begin_with_all(
            &mut self.known,
            &[(id, collider)],
            self.settings,
            self.surface,
            particles,
        );
    }
}

/// A cloth that lies over a shape and is shaken: each particle by itself and all together, by little and now and then by a lot.
#[derive(Clone)]
struct Shaken {
    random: Random,
    drift: Vec3,
    jitter: f32,
}

impl Shaken {
    /// Where each particle goes in the next sub-step. Returns how far the farthest does (m).
    fn shake(&mut self, particles: &mut [&mut ClothParticles], count: usize) -> f32 {
        if self.random.part() < 0.1 {
            self.drift = self.random.within(0.006);
            self.jitter = 0.003 * self.random.part().powi(4);
        }
        let mut farthest = 0.0_f32;
        for index in 0..count {
            let displacement = self.drift + self.random.within(self.jitter);
            farthest = farthest.max(displacement.length());
            for particles in particles.iter_mut() {
                let place = particles.position(index).expect("it exists");
                particles
                    .set_position(index, place + displacement)
                    .expect("it exists");
                particles
                    .set_displacement(index, displacement)
                    .expect("it exists");
            }
        }
        farthest * (1.0 + 1.0e-5)
    }
}

/// What is seen of a tick.
fn seen(detection: &Detection) -> Vec<(f32, Vec3, Vec<ContactPoint>)> {
    let touches = detection.touches().iter();
    touches
        .map(|touch| {
            (
                touch.deepest,
                touch.impulse,
                detection.points(touch).collect(),
            )
        })
        .collect()
}

fn place_over(particles: &mut ClothParticles, height: f32) {
    let middle = SPACING * (SIDE - 1) as f32 / 2.0;
    for index in 0..particles.len() {
        let place = particles.position(index).expect("it exists");
        let over = Vec3::new(place.x - middle, height, place.y + middle);
        particles.set_position(index, over).expect("it exists");
    }
    // As fast as in a game.
    particles.set_substep(1.0 / 1_200.0);
}

fn compare(seed: u64) -> Result<bool, TestCaseError> {
    let mut random = Random(seed);
    let (surface, mut particles): (Arc<Surface>, ClothParticles) = build(SIDE, SIDE, SPACING);
    let shape = shape(&mut random);
    let (_, reach) = shape.core(Isometry3d::IDENTITY);
    let top = match &shape {
        ColliderShape::Cuboid { half_size } => half_size.y,
        ColliderShape::Geometry(geometry) => geometry.bounds()[1].y,
        _ => reach,
    };
    place_over(&mut particles, top + random.between(0.0, 0.03));
    let collider = MovingCollider {
        to: random.within(0.05) * random.part().powi(3),
        turn: random.within(0.2) * random.part().powi(3),
        ..MovingCollider::still(shape, Isometry3d::IDENTITY)
    };
    let settings = ContactSettings {
        particle_radius: random.between(0.002, 0.015),
        friction: 0.4,
        narrow_phase: NarrowPhase::Triangles,
        ..ContactSettings::default()
    };
    let mut shaken = Shaken {
        random: Random(seed ^ 1),
        drift: Vec3::NEG_Y * 0.001,
        jitter: 0.0,
    };
    let mut memory = Memory::new(&surface, &settings);
    let mut is_touching = false;
    for tick in 0..TICKS {
        // Its place among the colliders changes, as others come and go.
        let id = random.below(2) as usize;
        let is_done_again = random.part() < 0.3;
        let begin = particles.clone();
        let same = shaken.clone();
        memory.begin(id, &collider, &particles);
        for round in 0..=usize::from(is_done_again) {
            if round > 0 {
                particles.copy_from(&begin);
                shaken = same.clone();
                memory.known.restart();
            }
            // Nothing is known of edges, nor of a tick that was done before.
            let mut forgetful = particles.clone();
            let mut fresh = Memory::new(&surface, &settings);
            fresh.begin(id, &collider, &forgetful);
            for index in 0..SUBSTEPS {
                let count = particles.len();
                let farthest_move = shaken.shake(&mut [&mut particles, &mut forgetful], count);
                let substep = SubStep {
                    index,
                    count: SUBSTEPS,
                    farthest_move,
                };
                fresh.known.forget_edges();
                memory
                    .known
                    .respond(&mut particles, &settings, substep, |_| {});
                fresh
                    .known
                    .respond(&mut forgetful, &settings, substep, |_| {});
                prop_assert!(
                    particles.positions().eq(forgetful.positions()),
                    "{seed} in {index} of {tick}"
                );
                prop_assert_eq!(
                    seen(&memory.known),
                    seen(&fresh.known),
                    "{} in {} of {}",
                    seed,
                    index,
                    tick
                );
            }
        }
        let mut touches = memory.known.touches().iter();
        is_touching |= touches.any(|touch| touch.deepest > 0.0);
    }
    Ok(is_touching)
}

/// A cloth that falls on a floor far from the floor's origin, each particle from another height, lands in the same
/// sub-steps whether the floor is known from above or not: rounding errors are larger there.
#[test]
fn what_lands_far_from_an_origin_lands_the_same() {
    let floor = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let corners = floor.map(|[x, z]| Vec3::new(20.0 + x, 0.0, z));
    let floor = ClothCollider::trimesh(corners.to_vec(), vec![[0, 2, 1], [0, 3, 2]]);
    let floor = floor.scaled(Vec3::ONE).expect("a floor");
    let collider = MovingCollider::still(floor, Isometry3d::from_xyz(-20.0, 0.0, 0.0));
    let settings = ContactSettings {
        particle_radius: 0.01,
        narrow_phase: NarrowPhase::Particles,
        ..ContactSettings::default()
    };
    for seed in 0..8 {
        let (surface, mut particles): (Arc<Surface>, ClothParticles) = build(SIDE, SIDE, SPACING);
        place_over(&mut particles, 0.0);
        let mut random = Random(seed);
        for index in 0..particles.len() {
            let up = Vec3::Y * random.between(0.011, 0.02);
            let place = particles.position(index).expect("it exists");
            particles
                .set_position(index, place + up)
                .expect("it exists");
        }
        let mut forgetful = particles.clone();
        let mut memory = Memory::new(&surface, &settings);
        for tick in 0..4 {
            let mut fresh = Memory::new(&surface, &settings);
            memory.begin(0, &collider, &particles);
            fresh.begin(0, &collider, &forgetful);
            for index in 0..SUBSTEPS {
                for particles in [&mut particles, &mut forgetful] {
                    for at in 0..particles.len() {
                        let displacement = Vec3::NEG_Y * 0.0003;
                        let place = particles.position(at).expect("it exists");
                        particles
                            .set_position(at, place + displacement)
                            .expect("it exists");
                        particles
                            .set_displacement(at, displacement)
                            .expect("it exists");
                    }
                }
                let substep = SubStep {
                    index,
                    count: SUBSTEPS,
                    farthest_move: 0.00031,
                };
                fresh.known.forget_edges();
                let known = &mut memory.known;
                known.respond(&mut particles, &settings, substep, |_| {});
                (fresh.known).respond(&mut forgetful, &settings, substep, |_| {});
                let is_same = particles.positions().eq(forgetful.positions());
                assert!(is_same, "{seed} in {index} of {tick}");
            }
        }
    }
}

proptest! {
    #![proptest_config(many_cases(1_000))]

    /// Whatever a cloth remembers of a shape's edges, contact does the same, bit for bit, as if it looked at all triangles anew
    /// in each sub-step; also where edges have come all through triangles.
    #[test]
    fn memory_changes_no_bit(seed in any::<u64>()) {
        compare(seed)?;
    }
}

#[test]
fn most_of_what_is_compared_touches() {
    let touching = (0..100).filter(|&seed| matches!(compare(seed), Ok(true)));
    assert!(touching.count() > 60);
}
