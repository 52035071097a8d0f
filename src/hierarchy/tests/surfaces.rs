//! Trees over surfaces that no grid is: irregular, open and closed, in pieces, with one side.

use std::f32::consts::{PI, TAU};

use bevy::math::{Vec3, Vec3Swizzles};
use proptest::strategy::{Strategy, ValueTree};

use super::{
    Searcher,
    states::{Scene, State, runner, states},
};
use crate::{
    cloth::{ClothMaterial, ClothParticles, SpringKind, Springs, Surface, TriangleMesh},
    hierarchy::tree::QuadTree,
    meshes::irregular,
    solver::Stretch,
};

/// Between neighbours, about (m).
const SPACING: f32 = 0.1;

fn surface(mesh: &TriangleMesh) -> Surface {
    Surface::of_mesh(mesh, 1.0e-4, Vec3::ONE).expect("a surface")
}

/// Cells between (columns + 1) × (rows + 1) vertices at places of their own; what is in one place will be one particle.
fn sheet(mesh: &mut TriangleMesh, columns: u32, rows: u32, place: impl Fn(f32, f32) -> Vec3) {
    let first = mesh.positions.len() as u32;
    for row in 0..=rows {
        for column in 0..=columns {
            let [across, down] =
                [(column, columns), (row, rows)].map(|(at, of)| at as f32 / of as f32);
            mesh.positions.push(place(across, down));
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = first + row * (columns + 1) + column;
            let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
            mesh.triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
}

/// Round, 0.4 m wide and 1 m long, open at both ends; pressed flat to a part of its depth.
fn sleeve(depth: f32) -> Surface {
    let mut mesh = TriangleMesh::default();
    sheet(&mut mesh, 24, 20, |around, down| {
        let (sin, cos) = (around * TAU).sin_cos();
        Vec3::new(0.2 * cos, -down, 0.2 * depth * sin)
    });
    surface(&mesh)
}

/// Closed on all sides, 0.4 m wide.
fn cube() -> Surface {
    let mut mesh = TriangleMesh::default();
    for axis in 0..3 {
        for side in [0.0, 0.4] {
            sheet(&mut mesh, 4, 4, |a, b| {
                let mut place = [0.0; 3];
                place[axis] = side;
                place[(axis + 1) % 3] = 0.4 * a;
                place[(axis + 2) % 3] = 0.4 * b;
                place.into()
            });
        }
    }
    surface(&mesh)
}

fn two_pieces() -> Surface {
    let mut mesh = irregular(0.9, 0.7, SPACING, 0.3);
    let other = irregular(0.5, 1.1, SPACING, 0.2);
    let first = mesh.positions.len() as u32;
    let beside = |place: &Vec3| *place + Vec3::new(0.3, 0.1, 0.25);
    mesh.positions.extend(other.positions.iter().map(beside));
    let beyond = |corners: &[u32; 3]| corners.map(|corner| corner + first);
    mesh.triangles.extend(other.triangles.iter().map(beyond));
    mesh.normals.clear();
    surface(&mesh)
}

fn moebius() -> Surface {
    let mut mesh = TriangleMesh::default();
    sheet(&mut mesh, 24, 3, |around, across| {
        let (sin, cos) = (around * TAU).sin_cos();
        let (up, out) = (around * PI).sin_cos();
        let beside = 0.3 * (across - 0.5);
        let radius = 0.4 + beside * out;
        Vec3::new(radius * cos, beside * up, radius * sin)
    });
    surface(&mesh)
}

/// Each with how many particles it has.
pub fn all() -> Vec<(&'static str, Surface, usize)> {
    vec![
        (
            "irregular",
            surface(&irregular(1.3, 0.9, SPACING, 0.4)),
            14 * 10,
        ),
        ("sleeve", sleeve(1.0), 24 * 21),
        ("flat sleeve", sleeve(0.05), 24 * 21),
        ("cube", cube(), 98),
        ("two pieces", two_pieces(), 10 * 8 + 6 * 12),
        ("Möbius", moebius(), 24 * 4),
    ]
}

/// A surface in a random state of its own, with a collider near it.
pub fn scene(surface: &Surface, state: &State) -> Scene {
    let material = ClothMaterial::COTTON;
    let springs = Springs::of_surface(surface, &material);
    let mut particles = ClothParticles::at_rest(surface, &material).expect("a valid material");
    let mut seed = state.seed | 1;
    let mut random = || {
        // Xorshift.
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    };
    for (index, rest) in surface.rest_positions().iter().enumerate() {
        let waves = Vec3::from((rest.yzx() * 4.0).to_array().map(f32::sin));
        let mut place = *rest + waves * state.waves * SPACING;
        if state.folded && rest.y < -0.3 {
            place.y = -0.6 - place.y;
        }
        place += Vec3::new(random(), random(), random()) * state.noise * SPACING;
        let place = place + state.origin * SPACING;
        particles.set_position(index, place).expect("it exists");
    }
    Scene {
        tree: QuadTree::of_surface(surface, springs.has(SpringKind::Shear)),
        stretch: Stretch::measure(&springs, &particles),
        probe: state.probe(&particles),
        particles,
    }
}

/// All volumes hold what is below them and find what brute force finds, over any surface in any state.
#[test]
fn every_surface_is_searched_as_by_brute_force() {
    for (name, surface, particles) in all() {
        assert_eq!(surface.len(), particles, "{name}");
        let mut runner = runner(3);
        let mut searcher = Searcher::default();
        let mut met = 0;
        for number in 0..400 {
            let state = states().new_tree(&mut runner).expect("a state").current();
            let scene = scene(&surface, &state);
            if number == 0 {
                assert_eq!(scene.tree.validate(particles), Ok(()), "{name}");
            }
            searcher
                .check(&scene, true)
                .unwrap_or_else(|error| panic!("{name}, {state:?}: {error}"));
            met += usize::from(!super::brute_force(&scene.particles, &scene.probe).is_empty());
        }
        assert!(met > 100, "{name}: {met}");
    }
}

/// Halves are of as many particles each: where two pieces are parted there is one patch with some of both on a level at
/// most, and it alone has an infinite radius.
#[test]
fn pieces_share_one_patch_a_level_at_most() {
    let surface = two_pieces();
    let tree = QuadTree::of_surface(&surface, false);
    for (level, nodes) in tree.levels().iter().enumerate() {
        let radii = nodes.clone().map(|node| tree.node(node).rest_radius);
        let endless = radii.filter(|radius| radius.is_infinite()).count();
        assert!(endless <= 1, "level {level}: {endless}");
    }
    assert_eq!(tree.node(0).rest_radius, f32::INFINITY);
}

/// Round or pressed flat, where patches are much smaller than a sleeve's circumference no more than a tenth of them reach
/// farther along it than a quarter of that, as one with particles of its front and of its back does.
#[test]
fn a_sleeves_front_shares_few_patches_with_its_back() {
    for depth in [1.0, 0.3, 0.05] {
        let surface = sleeve(depth);
        let tree = QuadTree::of_surface(&surface, false);
        // It is 1 m long.
        let quarter = surface.area() / 4.0;
        let is_small = |nodes: usize| (surface.area() / nodes as f32).sqrt() < 0.7 * quarter;
        let levels = tree.levels().iter().filter(|nodes| is_small(nodes.len()));
        let counts = levels.map(|nodes| {
            let reaches = |node: &u32| tree.node(*node).rest_radius > quarter;
            let count = nodes.clone().filter(reaches).count();
            println!("sleeve {depth}: {count} of {} patches", nodes.len());
            (count, nodes.len())
        });
        let counts: Vec<(usize, usize)> = counts.collect();
        assert!(counts.len() > 1);
        for (count, nodes) in counts {
            assert!(count * 10 <= nodes, "{depth}: {count} of {nodes}");
        }
    }
}
