//! A grid as a plate: clamped round about, and flying free.

use bevy::math::{DVec3, Vec3};
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    solver::{Bending, Solver, TickStep},
};
use examples_shared::sheet::{GRAVITY, Sheet, threads};

/// Particles along a side, spacing (m), and from where on all are held.
const SIDE: u32 = 41;
const SPACING: f32 = 0.01;
const HELD_FROM: f32 = 0.1775;

/// How far a plate of this rigidity (N·m) sags at each particle (m), clamped outside of a circle, with nothing but its bending.
fn sags(rigidity: f32) -> Vec<(Vec3, f32)> {
    let material = ClothMaterial {
        bend_rigidity: rigidity,
        ..ClothMaterial::COTTON
    };
    let grid = Cloth::new(SIDE, SIDE, SPACING)
        .lying()
        .grid(Vec3::ONE)
        .expect("a valid grid");
    let surface = Surface::of_grid(&grid);
    let mut particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
    let places: Vec<Vec3> = particles.positions().collect();
    let middle = places[places.len() / 2];
    for (index, place) in places.iter().enumerate() {
        if place.distance(middle) > HELD_FROM {
            particles.set_inverse_mass(index, 0.0).expect("it exists");
        }
    }
    let mut solver = Solver::new(&Springs::default(), &particles);
    solver.set_bending(Bending::new(&surface, &material));
    let step = TickStep {
        acceleration: Vec3::NEG_Y * GRAVITY as f32,
        damping: 0.05,
        ..TickStep::default()
    };
    for _ in 0..64 * 6 {
        solver.advance(&mut particles, step, &[], |_, _| false);
    }
    let each = places.iter().zip(particles.positions());
    each.map(|(before, after)| (*before - middle, before.y - after.y))
        .collect()
}

/// A round plate that is clamped sags by w (a² − r²)² ⁄ 64 D (Timoshenko), at an angle to the rows as along them, soft enough to be
/// pushed (1e-5 N·m) or solved (1e-3). The clamp is half a spacing beyond the first held particles, which are between none and a
/// spacing and a half away: half of one less or more in a is worth 11 % of a⁴.
#[test]
fn a_round_plate_sags_alike_in_all_directions() {
    let radius = HELD_FROM + SPACING;
    for rigidity in [1.0e-5, 1.0e-3] {
        let weight = ClothMaterial::COTTON.areal_density * GRAVITY as f32;
        let (mut level, mut oblique) = (Vec::new(), Vec::new());
        for (from_middle, sag) in sags(rigidity) {
            let distance = from_middle.length();
            if distance > 0.5 * radius {
                continue;
            }
            let exact =
                weight * (radius * radius - distance * distance).powi(2) / (64.0 * rigidity);
            let ratio = sag / exact;
            assert!(
                (ratio - 1.0).abs() < 0.11,
                "{rigidity} {from_middle}: {ratio}"
            );
            let angle = from_middle.z.abs().atan2(from_middle.x.abs()).to_degrees();
            if distance > 0.4 * radius {
                match (angle - 45.0).abs() {
                    0.0..5.0 => oblique.push(ratio),
                    35.0.. => level.push(ratio),
                    _ => {}
                }
            }
        }
        let [level, oblique] =
            [level, oblique].map(|all| all.iter().sum::<f32>() / all.len() as f32);
        println!("{rigidity} N·m: {level:.4} along rows, {oblique:.4} at 45°");
        assert!((level / oblique - 1.0).abs() < 0.02, "{level} {oblique}");
    }
}

/// `½ D ∫ κ_xx² + κ_yy² + 2 κ_xy² dA` (J), of places of a square grid.
fn bent(places: &[DVec3], columns: usize, rigidity: f64) -> f64 {
    let rows = places.len() / columns;
    let at = |row: usize, column: usize| places[row * columns + column];
    let is_inside = |index: usize, count: usize| index > 0 && index + 1 < count;
    let width = |inside: bool| if inside { 1.0 } else { 0.5 };
    let mut sum = 0.0;
    for row in 0..rows {
        for column in 0..columns {
            let own = at(row, column);
            let (in_row, in_column) = (is_inside(column, columns), is_inside(row, rows));
            if in_row {
                let across = at(row, column - 1) - 2.0 * own + at(row, column + 1);
                sum += width(in_column) * across.length_squared();
            }
            if in_column {
                let down = at(row - 1, column) - 2.0 * own + at(row + 1, column);
                sum += width(in_row) * down.length_squared();
            }
            if row + 1 < rows && column + 1 < columns {
                let upper = own - at(row, column + 1);
                let lower = at(row + 1, column) - at(row + 1, column + 1);
                sum += 2.0 * (upper - lower).length_squared();
            }
        }
    }
    0.5 * rigidity * sum / (f64::from(SPACING) * f64::from(SPACING))
}

/// Let go flat, in waves and with some speed of each particle's own, it crumples. Its kinetic energy is never more than what it
/// began with, however stiff it is; nor is that with what bends it, as long as sub-steps can follow: of 1e-2 N·m, what the springs
/// leave of a bend of 10⁻⁵ m is more than that.
#[test]
fn a_crumpled_plate_gains_no_energy() {
    let mut most = 0.0_f64;
    for size in [(17, 17), (33, 9), (20, 3)] {
        for rigidity in [1.0e-6, 1.0e-4, 1.0e-2, 1.0] {
            for substeps in [5, 20, 40] {
                for speed in [0.1, 2.0] {
                    let [kinetic, all] = most_of(size, rigidity, substeps, speed);
                    let name =
                        format!("{size:?}, {rigidity} N·m, {substeps} sub-steps, {speed} m/s");
                    assert!(kinetic <= 1.0, "{name}: {kinetic}");
                    assert!(all <= 1.0 || rigidity > 1.0e-3, "{name}: {all}");
                    most = most.max(kinetic);
                }
            }
        }
    }
    println!("kinetic, at most {most:.4} of what it began with");
}

/// The largest kinetic energy at the end of any tick of two seconds, and that with what bends, in parts of what it begins with.
fn most_of(size: (u32, u32), rigidity: f32, substeps: u32, speed: f32) -> [f64; 2] {
    let material = ClothMaterial {
        bend_rigidity: rigidity,
        ..threads(0.0, 0.0)
    };
    let step = TickStep {
        substeps,
        ..TickStep::default()
    };
    let place = |row: u32, column: u32| SPACING * Vec3::new(column as f32, 0.0, row as f32);
    let mut sheet = Sheet::new(size, SPACING, material, step, place, |_, _| false);
    sheet.step.acceleration = Vec3::ZERO;
    for (row, column) in sheet.grid().cells() {
        let [row, column] = [row, column].map(|index| index as f32);
        let waves = (0.3 * column + 0.2 * row).sin() + (1.1 * row).sin() * (0.9 * column).cos();
        let own = 0.1 * (7.0 * row + 1.3 * column).sin();
        sheet
            .particles
            .set_velocity(
                (row as u32, column as u32),
                speed * Vec3::new(own, waves, -own),
            )
            .expect("it exists");
    }
    let energy = |sheet: &Sheet| {
        let velocity = |index: usize| sheet.particles.velocity(index).expect("it exists");
        let squares = (0..sheet.particles.len()).map(|at| velocity(at).as_dvec3().length_squared());
        let each = squares.zip(sheet.masses());
        let kinetic = each.map(|(square, mass)| 0.5 * mass * square).sum::<f64>();
        let places: Vec<DVec3> = sheet.particles.positions().map(Vec3::as_dvec3).collect();
        let bent = bent(&places, size.0 as usize, f64::from(rigidity));
        [kinetic, kinetic + bent]
    };
    let [start, _] = energy(&sheet);
    let mut most = [0.0_f64; 2];
    for _ in 0..128 {
        sheet.tick(|_, _| {});
        let now = energy(&sheet);
        assert!(now[1].is_finite(), "{size:?} {rigidity} {substeps}");
        most = [0, 1].map(|kind| most[kind].max(now[kind] / start));
    }
    most
}
