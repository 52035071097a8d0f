//! Contact with the triangles of irregular meshes.

use std::{f32::consts::TAU, sync::Arc};

use bevy::math::{Isometry3d, Quat, Vec3};

use super::{
    LONG, ONLY,
    random::Random,
    shots::{SPACING, Shot},
};
use crate::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    contact::{
        candidates::{ContactSettings, NarrowPhase},
        colliders::{ColliderShape, MovingCollider, nearest},
        detection::Detection,
    },
    hierarchy::TopDownQuery,
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
    assert!(at_rest <= surface.face_reach(false) * (1.0 + 1.0e-6));
    let mut random = Random(5);
    for index in 0..particles.len() {
        let moved = particles.position(index).expect("it exists") + random.within(0.1);
        particles.set_position(index, moved).expect("it exists");
    }
    let moved = particles.longest_face_reach(&surface);
    assert!((moved / truth(&particles) - 1.0).abs() < 1.0e-6);
    assert!(moved > at_rest);
}

/// A mesh whose columns are 1 cm apart on the left and 9 cm on the right, with diagonals of either kind.
fn graded(random: &mut Random) -> (Arc<Surface>, ClothParticles) {
    let mut places = Vec::new();
    let (mut columns, mut x, rows) = (0, 0.0, 41);
    while x < 1.2 {
        places.extend((0..rows).map(|row| Vec3::new(x, 0.02 * row as f32, 0.0)));
        (columns, x) = (columns + 1, x + 0.01 + 0.07 * x);
    }
    let index = |column: u32, row: u32| column * rows + row;
    let cells = (0..columns - 1).flat_map(|column| (0..rows - 1).map(move |row| (column, row)));
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|(column, row)| {
            let [a, b] = [index(column, row), index(column + 1, row)];
            let [c, d] = [a + 1, b + 1];
            match random.below(2) {
                0 => [[a, b, c], [b, d, c]],
                _ => [[a, b, d], [a, d, c]],
            }
        })
        .collect();
    let cloth = Cloth::triangles(places, triangles);
    let surface = cloth.surface(Vec3::ONE).expect("a surface");
    let mut particles =
        ClothParticles::at_rest(&surface, &ClothMaterial::COTTON).expect("a valid material");
    particles.set_substep(LONG);
    (Arc::new(surface), particles)
}

/// A tick in which the particles within a margin of a collider (m) are its candidates.
fn near(
    margin: f32,
    collider: &MovingCollider,
    settings: &ContactSettings,
    surface: &Arc<Surface>,
    particles: &ClothParticles,
) -> Detection {
    let mut detection = Detection::default();
    detection.begin(surface, margin);
    let cloth = particles.bounding_sphere();
    let reach = particles.longest_face_reach(surface);
    let (probe, narrow_phase) = detection.probe(collider, settings, surface, reach, &cloth);
    let mut query = TopDownQuery::default();
    query.scan(particles, &probe);
    detection.add(0, collider, narrow_phase, query.candidates(), particles);
    detection
}

/// A ball, or a capsule, that a graded mesh cuts into by 4 mm; the ends of its core, and its radius (m).
fn in_the_way(random: &mut Random, seed: u64) -> (MovingCollider, [Vec3; 2], f32) {
    let radius = 0.08 + 0.14 * random.part();
    let on = Vec3::new(0.1 + random.part(), 0.2 + 0.4 * random.part(), 0.0);
    let centre = on - Vec3::Z * (radius - 0.004);
    let turn = Quat::from_rotation_z(TAU * random.part());
    let half_length = 0.2 * (seed % 2) as f32;
    let way = turn * Vec3::Y * half_length;
    let shape = match seed % 2 {
        0 => ColliderShape::Ball { radius },
        _ => ColliderShape::Capsule {
            radius,
            half_length,
        },
    };
    let pose = Isometry3d::new(centre, turn);
    let collider = MovingCollider::still(shape, pose);
    (collider, [centre - way, centre + way], radius)
}

/// On a mesh of fine and coarse triangles, the particles of fine ones are pushed out of a ball or a capsule, and coarse ones as
/// triangles, in one touch. No fine one dips deeper than its [width](Surface::face_widths) says, and no coarse one dips. The whole
/// mesh is pushed at once by its particles where all of it that is near is fine.
#[test]
fn coarse_triangles_are_pushed_and_fine_ones_left_to_their_particles() {
    let (mut mixed, mut fine) = (0, 0);
    for seed in 0..40 {
        let mut random = Random(seed);
        let (surface, mut particles) = graded(&mut random);
        let (collider, [start, end], radius) = in_the_way(&mut random, seed);
        let settings = ContactSettings::default();
        for _ in 0..20 {
            let mut detection = near(0.03, &collider, &settings, &surface, &particles);
            detection.respond(&mut particles, &settings, ONLY, |_| {});
            for touch in detection.touches() {
                let by_triangles = touch.narrow_phase == NarrowPhase::Triangles;
                mixed += u32::from(by_triangles && touch.of.has_points);
                fine += u32::from(!by_triangles);
            }
        }
        let place = |at: u32| particles.position(at as usize).expect("it exists");
        let widest = NarrowPhase::widest_fine(radius);
        for owner in 0..surface.len() as u32 {
            let width = surface.face_widths()[owner as usize];
            let circle = width / 2.0_f32.sqrt();
            // Pushes by turns leave some of the last ones; the sheet is stretched by less than a tenth.
            let most = match width <= widest {
                true => 1.1 * (radius - (radius * radius - circle * circle).sqrt()) + 2.0e-5,
                false => 2.0e-4,
            };
            for face in surface.faces().of(owner) {
                let corners = face.map(place);
                let near = nearest(corners, [start, end]);
                let dip = radius - near.offset.length();
                assert!(dip <= most, "{seed}, {width} of {radius}: {dip} of {most}");
                // 1 − √(1 − 1/18), and the same tenth.
                assert!(dip <= 0.032 * radius, "{seed}: {dip} of {radius}");
            }
        }
    }
    assert!(mixed > 100 && fine > 20, "{mixed}, {fine}");
}

/// However often triangles are searched for again in a sub-step, as a small margin is used up, particles beside them are pushed once:
/// they count once in the area.
#[test]
fn points_beside_triangles_are_pushed_once() {
    let mut stopped = 0;
    for seed in 0..20 {
        let mut random = Random(seed);
        let (surface, particles) = graded(&mut random);
        let (collider, ..) = in_the_way(&mut random, seed);
        let settings = ContactSettings::default();
        let [wide, narrow] = [0.1, 5.0e-4].map(|margin| {
            let mut particles = particles.clone();
            let mut detection = near(margin, &collider, &settings, &surface, &particles);
            detection.respond(&mut particles, &settings, ONLY, |_| {});
            let area = detection
                .touches()
                .iter()
                .map(|touch| touch.area)
                .sum::<f32>();
            (area, detection.requeries())
        });
        stopped += narrow.1;
        // By turns, a triangle may be hit that was clear before.
        assert!(narrow.0 <= 1.1 * wide.0, "{seed}: {narrow:?}, {wide:?}");
    }
    assert!(stopped > 20, "{stopped}");
}

/// Pins inside a collider leave the triangles at them out, with all of their owners'. These are pushed as particles then, and so
/// is everything else: no free particle stays inside.
#[test]
fn no_free_particle_beside_pins_stays_inside() {
    for seed in 0..40 {
        let mut random = Random(seed);
        let (surface, mut particles) = graded(&mut random);
        let (collider, core, radius) = in_the_way(&mut random, seed);
        let settings = ContactSettings {
            particle_radius: 0.002,
            friction: 0.4,
            ..ContactSettings::default()
        };
        let depth = |particles: &ClothParticles, index: usize| {
            let place = particles.position(index).expect("it exists");
            let (offset, along) = (place - core[0], core[1] - core[0]);
            let part = offset.dot(along) / along.length_squared().max(1.0e-9);
            radius - offset.distance(along * part.clamp(0.0, 1.0))
        };
        for index in 0..particles.len() {
            if depth(&particles, index) > 0.0 && random.below(3) == 0 {
                particles.set_inverse_mass(index, 0.0).expect("it exists");
            }
        }
        for _ in 0..20 {
            let mut detection = near(0.03, &collider, &settings, &surface, &particles);
            detection.respond(&mut particles, &settings, ONLY, |_| {});
        }
        let free = (0..particles.len()).filter(|index| particles.inverse_mass(*index) != Some(0.0));
        for index in free {
            let depth = depth(&particles, index);
            assert!(depth < 1.0e-4, "{seed}, {index}: {depth} of {radius}");
        }
    }
}
