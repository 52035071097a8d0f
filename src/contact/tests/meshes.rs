//! Contact with the triangles of irregular meshes.

use std::sync::Arc;

use bevy::math::Vec3;

use super::{
    random::Random,
    shots::{SPACING, Shot},
};
use crate::{
    cloth::{ClothMaterial, ClothParticles, Springs, Surface},
    meshes::irregular,
};

/// A mesh as large as the grid that is shot at; pinned all around, if asked for.
fn target(is_pinned: bool) -> (Arc<Surface>, Springs, ClothParticles) {
    let mesh = irregular(1.5, 1.5, SPACING, 0.3);
    let surface = Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface");
    let material = ClothMaterial::COTTON;
    let mut particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
    for (index, place) in surface.rest_positions().iter().enumerate() {
        let is_inside = |at: f32| (0.001..1.499).contains(&at);
        if is_pinned && !(is_inside(place.x) && is_inside(-place.y)) {
            particles.set_inverse_mass(index, 0.0).expect("it exists");
        }
    }
    let springs = Springs::of_surface(&surface, &material);
    (Arc::new(surface), springs, particles)
}

/// Small balls at 50 m/s against a mesh that is free, and against one that is pinned all around, for as long as that can
/// give way: none gets through a triangle. Tested at the ends of sub-steps alone, some do.
#[test]
fn no_small_fast_ball_gets_through_a_mesh() {
    let mut discrete = 0;
    for (is_pinned, ticks) in [(false, 13), (true, 2)] {
        let (surface, springs, particles) = target(is_pinned);
        for ratio in [0.25, 0.5, 1.0] {
            for seed in 0..9 {
                let mut random = Random(seed);
                let beside = random.within(1.0);
                let swept = Shot {
                    speed: 50.0,
                    radius: ratio * SPACING,
                    is_swept: true,
                    beside: [beside.x, beside.y],
                    delay: random.part(),
                    direction: Vec3::Z,
                    spin: random.direction() * 50.0 * random.part(),
                };
                let through =
                    |shot: Shot| shot.through_cloth(&surface, &springs, particles.clone(), ticks);
                assert_eq!(through(swept), None, "pinned: {is_pinned}, {swept:?}");
                let ends_alone = Shot {
                    is_swept: false,
                    ..swept
                };
                discrete += usize::from(through(ends_alone).is_some());
            }
        }
    }
    assert!(discrete > 0, "there is something to be swept for");
}

/// A face reaches as far from the particle that stands for it as its farthest corner is, wherever they have moved; at rest
/// no farther than the surface says.
#[test]
fn a_face_reaches_to_its_farthest_corner() {
    let (surface, _, mut particles) = target(false);
    let truth = |particles: &ClothParticles| {
        let place = |index: u32| particles.position(index as usize).expect("it exists");
        let reach = |face: &[u32; 3]| {
            let first = place(face[0].min(face[1]).min(face[2]));
            let distances = face.map(|corner| place(corner).distance(first));
            distances.into_iter().fold(0.0, f32::max)
        };
        surface.triangles().iter().map(reach).fold(0.0, f32::max)
    };
    let at_rest = particles.longest_face_reach(&surface);
    assert!((at_rest / truth(&particles) - 1.0).abs() < 1.0e-6);
    assert!(at_rest <= surface.face_reach() * (1.0 + 1.0e-6));
    let mut random = Random(5);
    for index in 0..particles.len() {
        let moved = particles.position(index).expect("it exists") + random.within(0.1);
        particles.set_position(index, moved).expect("it exists");
    }
    let moved = particles.longest_face_reach(&surface);
    assert!((moved / truth(&particles) - 1.0).abs() < 1.0e-6);
    assert!(moved > at_rest);
}
