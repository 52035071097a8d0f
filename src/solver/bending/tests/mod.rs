//! Against dense matrices in f64.

mod creases;
mod dense;
mod mesh;
mod soft;
mod torn;

use bevy::math::{DVec3, Quat, Vec3};

use super::*;
use crate::{
    cloth::{Cloth, ClothGrain, ClothParticles, ClothWeft, StiffnessFactors, TriangleMesh},
    solver::kernels::SimdLevel,
};
use dense::expected;

/// A generator of numbers from −1 to 1.
fn noise() -> impl FnMut() -> f64 {
    let mut state = 7_u32;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 23) - 1.0
    }
}

const RIGIDITY: f32 = 1.0e-4;

fn material() -> ClothMaterial {
    ClothMaterial {
        bend_rigidity: RIGIDITY,
        ..ClothMaterial::COTTON
    }
}

/// Particles somewhere near their rest positions, with displacements; of each `pins`th nothing moves.
fn disturbed(surface: &Surface, pins: usize, amplitude: f64) -> ClothParticles {
    let mut particles = ClothParticles::at_rest(surface, &material()).expect("valid");
    let mut noise = noise();
    let mut random = |scale: f64| DVec3::new(noise(), noise(), noise()).as_vec3() * scale as f32;
    for index in 0..particles.len() {
        let place = surface.rest_positions()[index] + random(amplitude);
        particles.set_position(index, place).expect("it exists");
        particles
            .set_displacement(index, random(amplitude / 10.0))
            .expect("it exists");
        let inverse_mass = particles.inverse_mass(index).expect("it exists");
        let is_pinned = pins > 0 && index % pins == pins / 2;
        let mass = if is_pinned {
            0.0
        } else {
            1.0 + index as f32 % 3.0
        };
        particles
            .set_inverse_mass(index, inverse_mass * mass)
            .expect("it exists");
    }
    particles
}

/// What bending adds to the displacements.
fn added(
    bending: &mut Bending,
    particles: &ClothParticles,
    weight: f32,
    level: SimdLevel,
) -> Vec<Vec3> {
    let mut after = particles.clone();
    bending.prepare(after.blocks(), weight);
    bending.solve(after.blocks_mut(), &level.kernels());
    let pairs = after.displacements().zip(particles.displacements());
    pairs.map(|(after, before)| after - before).collect()
}

/// Whether forces push it, as it was prepared.
fn is_soft(bending: &Bending) -> bool {
    match &bending.of {
        Kind::Grid(grid) => grid.is_soft(),
        Kind::Torn(torn) => torn.is_soft(),
        Kind::Mesh(mesh) => mesh.is_soft(),
    }
}

/// The largest weight (s²) with which it is pushed, or one.
fn softest(bending: &mut Bending, particles: &ClothParticles) -> f32 {
    let (mut soft, mut stiff) = (0.0_f32, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (soft + stiff);
        bending.prepare(particles.blocks(), middle);
        if is_soft(bending) {
            soft = middle;
        } else {
            stiff = middle;
        }
    }
    soft
}

/// Bits of what bending leaves.
fn solved(bending: &mut Bending, particles: &ClothParticles, level: SimdLevel) -> Vec<[u32; 3]> {
    let added = added(bending, particles, 1.0e-5, level);
    added
        .iter()
        .map(|of| of.to_array().map(f32::to_bits))
        .collect()
}

/// At rounding: grids of all kinds of strips and borders, pins anywhere, soft and stiff.
#[test]
fn chains_are_solved_as_dense_matrices_are() {
    for (columns, rows) in [
        (2, 2),
        (3, 2),
        (2, 3),
        (3, 3),
        (4, 9),
        (9, 5),
        (17, 11),
        (33, 10),
        (40, 8),
    ] {
        let grid = Cloth::new(columns, rows, 0.02)
            .grid(Vec3::new(1.0, 1.3, 1.0))
            .expect("valid");
        let surface = Surface::of_grid(&grid);
        for pins in [0, 1, 2, 7] {
            let particles = disturbed(&surface, pins, 0.005);
            let mut bending = Bending::new(&surface, &material()).expect("it is stiff");
            for weight in [1.0e-7, 1.0e-5, 1.0e-3] {
                let found = added(&mut bending, &particles, weight, SimdLevel::Auto);
                if is_soft(&bending) {
                    continue;
                }
                let expected = expected(&grid, &particles, f64::from(weight));
                for (at, (found, expected)) in found.iter().zip(&expected).enumerate() {
                    let off = found.as_dvec3().distance(*expected);
                    assert!(
                        off < 2.0e-6,
                        "{columns} × {rows}, pins {pins}, s {weight}, {at}: {found} for {expected}"
                    );
                    let is_pinned = particles.is_pinned(at).expect("it exists");
                    assert!(!is_pinned || *found == Vec3::ZERO);
                }
            }
        }
    }
}

/// All weights that a method takes turns with are kept, and other masses are seen.
#[test]
fn factors_follow_weights_and_masses() {
    let grid = Cloth::new(9, 9, 0.02).grid(Vec3::ONE).expect("valid");
    let surface = Surface::of_grid(&grid);
    let mut bending = Bending::new(&surface, &material()).expect("it is stiff");
    let mut particles = disturbed(&surface, 0, 0.005);
    for round in 0..3 {
        for weight in [1.0e-5, 4.0e-6, 1.0e-5, 3.0e-6, 4.0e-6, 2.5e-6, 1.0e-7] {
            let mut new = Bending::new(&surface, &material()).expect("it is stiff");
            let expected = added(&mut new, &particles, weight, SimdLevel::Auto);
            assert_eq!(
                added(&mut bending, &particles, weight, SimdLevel::Auto),
                expected
            );
        }
        particles
            .set_inverse_mass(20 + round, 0.0)
            .expect("it exists");
        particles
            .set_inverse_mass(5, 10.0 + round as f32)
            .expect("it exists");
    }
}

#[test]
fn all_instructions_give_the_same_bits() {
    for (columns, rows) in [(5, 4), (37, 19), (64, 20)] {
        let grid = Cloth::new(columns, rows, 0.02)
            .grid(Vec3::ONE)
            .expect("valid");
        let surface = Surface::of_grid(&grid);
        let particles = disturbed(&surface, 9, 0.01);
        let mut bending = Bending::new(&surface, &material()).expect("it is stiff");
        let widest = solved(&mut bending, &particles, SimdLevel::Auto);
        assert_eq!(
            widest,
            solved(&mut bending, &particles, SimdLevel::Baseline)
        );
    }
}

/// A sheet of triangles, with its inner vertices moved by up to `jitter` of the spacing and bent by `shape`.
fn sheet(side: u32, jitter: f64, shape: impl Fn(Vec3) -> Vec3) -> Surface {
    let mut noise = noise();
    let spacing = 0.02;
    let mut positions = Vec::new();
    for row in 0..=side {
        for column in 0..=side {
            let mut place = DVec3::new(f64::from(column), f64::from(row), 0.0);
            if (1..side).contains(&row) && (1..side).contains(&column) {
                place += jitter * DVec3::new(noise(), noise(), 0.0);
            }
            positions.push(shape((place * spacing).as_vec3()));
        }
    }
    let mut triangles = Vec::new();
    for row in 0..side {
        for column in 0..side {
            let a = row * (side + 1) + column;
            let (b, c, d) = (a + 1, a + side + 1, a + side + 2);
            triangles.extend(if (row + column) % 2 == 0 {
                [[a, b, c], [b, d, c]]
            } else {
                [[a, b, d], [a, d, c]]
            });
        }
    }
    let mesh = TriangleMesh {
        positions,
        triangles,
        ..Default::default()
    };
    Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface")
}

/// What bending does has neither weight nor, while little moves, a moment.
#[test]
fn nothing_pulls_from_outside() {
    let grid = Cloth::new(21, 13, 0.02)
        .grid(Vec3::new(1.0, 1.2, 1.0))
        .expect("valid");
    for surface in [Surface::of_grid(&grid), sheet(12, 0.2, |place| place)] {
        let particles = disturbed(&surface, 0, 1.0e-4);
        let mut bending = Bending::new(&surface, &material()).expect("it is stiff");
        let added = added(&mut bending, &particles, 1.0e-5, SimdLevel::Auto);
        let (mut impulse, mut moment, mut scale) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for ((added, inverse_mass), rest) in added
            .iter()
            .zip(particles.inverse_masses())
            .zip(surface.rest_positions())
        {
            let moved = added.as_dvec3() / f64::from(inverse_mass);
            impulse += moved;
            moment += rest.as_dvec3().cross(moved);
            scale += moved.length();
        }
        assert!(scale > 0.0);
        assert!(impulse.length() < 1.0e-3 * scale);
        assert!(moment.length() < 1.0e-3 * scale * f64::from(surface.diagonal()));
    }
}

/// A mesh bent to a cylinder of any direction has the energy of a plate, but for what its border does not know.
#[test]
fn meshes_are_as_stiff_as_the_plate_in_all_directions() {
    for jitter in [0.0, 0.25] {
        let surface = sheet(40, jitter, |place| place);
        let mesh = MeshMatrix::new(
            &surface,
            material().woven_bending(),
            &StiffnessFactors::default(),
            None,
        );
        for degrees in [0.0_f64, 22.5, 45.0, 90.0, 135.0] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let heights: Vec<f64> = surface
                .rest_positions()
                .iter()
                .map(|place| {
                    (f64::from(place.x) * cosine + f64::from(place.y) * sine).powi(2) / 2.0
                })
                .collect();
            let expected = 0.5 * f64::from(RIGIDITY * surface.area());
            let ratio = mesh.energy(&heights) / expected;
            println!("jitter {jitter}, {degrees}°: {ratio:.4}");
            assert!((0.93..1.01).contains(&ratio), "{jitter} {degrees}: {ratio}");
        }
    }
}

/// A woven one has `½ (√D_warp cos²φ + √D_weft sin²φ)² κ²`, φ being between the curvature and the warp.
#[test]
fn woven_meshes_are_as_stiff_as_the_plate_in_all_directions() {
    let [warp, weft] = [RIGIDITY, RIGIDITY / 9.0];
    let material = ClothMaterial {
        bend_rigidity: warp,
        weft: Some(ClothWeft {
            bend_rigidity: weft,
            ..Default::default()
        }),
        ..material()
    };
    for (jitter, grain) in [(0.0, 0.0), (0.25, 0.0), (0.25, 30.0)] {
        let surface = sheet(40, jitter, |place| place);
        let along = Quat::from_rotation_z(f32::to_radians(grain)) * Vec3::X;
        let surface = ClothGrain::along(along)
            .apply(surface, &TriangleMesh::default())
            .expect("a grain");
        let mesh = MeshMatrix::new(
            &surface,
            material.woven_bending(),
            &StiffnessFactors::default(),
            None,
        );
        for degrees in [0.0_f64, 30.0, 45.0, 90.0, 120.0] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let heights: Vec<f64> = surface
                .rest_positions()
                .iter()
                .map(|place| {
                    (f64::from(place.x) * cosine + f64::from(place.y) * sine).powi(2) / 2.0
                })
                .collect();
            let (sine, cosine) = (degrees - f64::from(grain)).to_radians().sin_cos();
            let [warp, weft] = [warp, weft].map(|rigidity| f64::from(rigidity).sqrt());
            let rigidity = (warp * cosine * cosine + weft * sine * sine).powi(2);
            let expected = 0.5 * rigidity * f64::from(surface.area());
            let ratio = mesh.energy(&heights) / expected;
            println!("jitter {jitter}, grain {grain}°, {degrees}°: {ratio:.4}");
            // A border knows less, as in the test above: there the smallest curvature counts.
            assert!((0.9..1.01).contains(&ratio), "{degrees}: {ratio}");
        }
    }
}

/// What is modelled with curvature stays as it is, wherever it is turned.
#[test]
fn a_curved_mesh_rests_as_it_was_modelled() {
    let radius = 0.15;
    let curved = |place: Vec3| {
        let angle = place.x / radius;
        Vec3::new(radius * angle.sin(), place.y, radius * angle.cos())
    };
    let surface = sheet(16, 0.2, curved);
    let mut bending = Bending::new(&surface, &material()).expect("it is stiff");
    let turn = Quat::from_euler(bevy::math::EulerRot::XYZ, 0.3, 1.0, -2.0);
    for (turn, allowed) in [(Quat::IDENTITY, 1.0e-6), (turn, 1.0e-6)] {
        let mut particles = ClothParticles::at_rest(&surface, &material()).expect("valid");
        for (index, rest) in surface.rest_positions().iter().enumerate() {
            particles
                .set_position(index, turn * *rest)
                .expect("it exists");
        }
        let found = added(&mut bending, &particles, 1.0e-4, SimdLevel::Auto);
        let largest = found.iter().map(|of| of.length()).fold(0.0, f32::max);
        assert!(largest < allowed, "{largest}");
    }
    // Flat, it wants to bend.
    let mut particles = ClothParticles::at_rest(&surface, &material()).expect("valid");
    let flat = sheet(16, 0.2, |place| place);
    for vertex in 0..surface.vertices() {
        let [own, of_flat] = [&surface, &flat].map(|of| of.particle_of_vertex(vertex));
        let place = flat.rest_positions()[of_flat.expect("it exists")];
        particles
            .set_position(own.expect("it exists"), place)
            .expect("it exists");
    }
    let found = added(&mut bending, &particles, 1.0e-4, SimdLevel::Auto);
    assert!(found.iter().map(|of| of.length()).fold(0.0, f32::max) > 1.0e-4);
}

#[test]
fn what_bends_freely_has_none() {
    let free = ClothMaterial {
        bend_rigidity: 0.0,
        ..ClothMaterial::COTTON
    };
    let grid = Cloth::new(5, 5, 0.02).grid(Vec3::ONE).expect("valid");
    assert!(Bending::new(&Surface::of_grid(&grid), &free).is_none());
    assert!(Bending::new(&sheet(4, 0.0, |place| place), &free).is_none());
}
