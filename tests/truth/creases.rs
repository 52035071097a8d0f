//! Creases against the closed form of an elastic-plastic strip, and the conservation of momentum.

use bevy::math::{DVec3, Vec3};
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, ClothParticles, Springs, Surface},
    solver::{Bending, ClothCreasing, Solver, TickStep, TimeOrder},
};

use crate::meshes::irregular;

/// Length and width of the strip (m).
const LENGTH: f32 = 0.2;
const WIDTH: f32 = 0.04;

const MATERIAL: ClothMaterial = ClothMaterial {
    // No mesh of a cylinder has all its edges as long as at rest: it gives.
    stretch_compliance: 1.0e-3,
    bend_rigidity: 2.0e-2,
    damping: 0.0,
    ..ClothMaterial::COTTON
};

/// A strip along x that nothing pulls at.
struct Strip {
    particles: ClothParticles,
    solver: Solver,
    rest: Vec<Vec3>,
    /// m.
    length: f32,
    /// Of a grid (m).
    spacing: Option<f32>,
}

impl Strip {
    fn grid(spacing: f32, creasing: Option<ClothCreasing>) -> Self {
        let count = |side: f32| (side / spacing).round() as u32 + 1;
        let cloth = Cloth::new(count(LENGTH), count(WIDTH), spacing);
        let surface = cloth.surface(Vec3::ONE).expect("a valid grid");
        Self {
            spacing: Some(spacing),
            ..Self::new(&surface, creasing)
        }
    }

    fn mesh(spacing: f32, creasing: Option<ClothCreasing>) -> Self {
        let mesh = irregular(LENGTH, WIDTH, spacing, 0.2);
        let surface = Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface");
        Self::new(&surface, creasing)
    }

    /// A strap of 5 × 1 cm, of leather.
    fn leather() -> Self {
        let (length, spacing) = (0.05, 2.5e-3);
        let cloth = Cloth::new(21, 5, spacing);
        let surface = cloth.surface(Vec3::ONE).expect("a valid grid");
        let creasing = Some(ClothCreasing::LEATHER);
        Self {
            length,
            spacing: Some(spacing),
            ..Self::of(&surface, &ClothMaterial::LEATHER, creasing)
        }
    }

    fn new(surface: &Surface, creasing: Option<ClothCreasing>) -> Self {
        Self::of(surface, &MATERIAL, creasing)
    }

    fn of(surface: &Surface, material: &ClothMaterial, creasing: Option<ClothCreasing>) -> Self {
        let particles = ClothParticles::at_rest(surface, material).expect("a valid material");
        let springs = Springs::of_surface(surface, material);
        let mut solver = Solver::of_surface(surface, &springs);
        let mut bending = Bending::new(surface, material).expect("it resists");
        bending.set_creasing(surface, material, creasing);
        solver.set_bending(Some(bending));
        Self {
            rest: surface.rest_positions().to_vec(),
            particles,
            solver,
            length: LENGTH,
            spacing: None,
        }
    }

    fn tick(&mut self, damping: f32) {
        let step = TickStep {
            seconds: 1.0 / 60.0,
            substeps: 20,
            acceleration: Vec3::ZERO,
            damping,
            order: if damping == 1.0 {
                TimeOrder::First
            } else {
                TimeOrder::Second
            },
            ..TickStep::default()
        };
        self.solver
            .advance(&mut self.particles, step, &[], |_, _| false);
    }

    /// Puts it on a cylinder of this curvature (1/m).
    fn bend(&mut self, curvature: f32) {
        for (index, rest) in self.rest.iter().enumerate() {
            // The chords of a grid keep their length. Its curvature is exact then.
            let angle = match self.spacing {
                Some(spacing) => rest.x / spacing * 2.0 * (0.5 * spacing * curvature).asin(),
                None => rest.x * curvature,
            };
            let (sin, cos) = angle.sin_cos();
            let bent = Vec3::new(sin / curvature, rest.y, (1.0 - cos) / curvature);
            let still = Vec3::ZERO;
            let particles = &mut self.particles;
            particles.set_position(index, bent).expect("it exists");
            particles.set_displacement(index, still).expect("it exists");
        }
    }

    /// Bends it for a tick, and lets it spring back slowly.
    fn bend_and_release(&mut self, curvature: f32) {
        self.bend_and_release_for(&[curvature], 150);
    }

    /// Bends it to one curvature after another (1/m), and lets go.
    fn bend_and_release_for(&mut self, curvatures: &[f32], ticks: u32) {
        let masses: Vec<f32> = self.particles.inverse_masses().collect();
        for curvature in curvatures {
            self.bend(*curvature);
            for index in 0..masses.len() {
                self.particles
                    .set_inverse_mass(index, 0.0)
                    .expect("it exists");
            }
            self.tick(1.0);
        }
        for (index, mass) in masses.into_iter().enumerate() {
            self.particles
                .set_inverse_mass(index, mass)
                .expect("it exists");
        }
        for _ in 0..ticks {
            self.tick(1.0);
        }
    }

    /// The curvature of the arc on the chord between its ends (1/m), however the strip is turned.
    fn curvature(&self) -> f64 {
        let end = |x: f32| {
            let places = self.rest.iter().zip(self.particles.positions());
            let own = places.filter(|(rest, _)| (rest.x - x).abs() < 1.0e-5);
            let own: Vec<DVec3> = own.map(|(_, place)| place.as_dvec3()).collect();
            own.iter().sum::<DVec3>() / own.len() as f64
        };
        let chord = end(0.0).distance(end(self.length));
        // Of half the angle of the arc: the sine falls off more and more.
        let (mut least, mut most) = (0.0_f64, std::f64::consts::PI);
        for _ in 0..60 {
            let half = 0.5 * (least + most);
            // The chords of a grid are straight.
            let of_chord = match self.spacing {
                Some(spacing) => {
                    let count = f64::from((self.length / spacing).round());
                    f64::from(spacing) * half.sin() / (half / count).sin()
                }
                None => f64::from(self.length) * half.sin() / half,
            };
            if of_chord > chord {
                least = half;
            } else {
                most = half;
            }
        }
        match self.spacing {
            Some(spacing) => {
                let count = f64::from((self.length / spacing).round());
                2.0 * (least / count).sin() / f64::from(spacing)
            }
            None => 2.0 * least / f64::from(self.length),
        }
    }
}

fn creasing(yield_curvature: f32, hardening: f32) -> ClothCreasing {
    ClothCreasing {
        yield_curvature,
        hardening,
    }
}

/// A strip that is bent to κ has the moment `M = D (κ_y + h (κ − κ_y))`. Without it, it springs back by M ⁄ D: it keeps
/// `(1 − h) (κ − κ_y)`, or, as it yields again on its way back, `κ_y (1 − h) ⁄ h`.
fn kept(creasing: ClothCreasing, curvature: f32) -> f64 {
    let left = (1.0 - creasing.hardening) * (curvature - creasing.yield_curvature);
    f64::from(left.min(creasing.largest_crease()))
}

/// Grids are exact: their stencils have the same curvature on a circle, and lie on one again. What is left is the stretch on that
/// circle, and rounding. The chord of a strip of length L is shorter by L³ κ ⁄ 12 m for each 1/m more, which is 0.7 mm for 1/m here.
/// Of its places, rounding and a stretch of 10⁻⁴ make 0.01 mm, which is worth 0.02/m.
#[test]
fn a_strip_of_a_grid_springs_back_as_the_closed_form_says() {
    for hardening in [0.0, 0.3, 0.8] {
        let creasing = creasing(4.0, hardening);
        for curvature in [6.0, 10.0, 18.0] {
            let exact = kept(creasing, curvature);
            for spacing in [0.02, 0.01] {
                let mut strip = Strip::grid(spacing, Some(creasing));
                strip.bend_and_release(curvature);
                let found = strip.curvature();
                println!("{spacing} m, h {hardening}, {curvature}/m: {found:.3} of {exact:.3}/m");
                assert!((found - exact).abs() < 0.02, "{found} {exact}");
            }
        }
    }
}

/// Meshes, to within the error of their triangles: 2.5 % of the curvature that they are bent to.
#[test]
fn a_strip_of_a_mesh_springs_back_as_the_closed_form_says() {
    for hardening in [0.0, 0.3, 0.8] {
        let creasing = creasing(4.0, hardening);
        for curvature in [6.0, 10.0, 14.0] {
            let exact = kept(creasing, curvature);
            for spacing in [0.02, 0.0133, 0.01] {
                let mut strip = Strip::mesh(spacing, Some(creasing));
                strip.bend_and_release(curvature);
                let found = strip.curvature();
                println!(
                    "{spacing} m, h {hardening}, {curvature}/m: {found:.3} of {exact:.3}/m, {:+.1} %",
                    100.0 * (found / exact - 1.0)
                );
                assert!(
                    (found - exact).abs() < 0.025 * f64::from(curvature),
                    "{found} {exact}"
                );
            }
        }
    }
}

/// A strap of leather yields around a radius of 4 cm. Bent around a smaller one, led back nearly to rest and let go, it keeps `(1 − h) (1 ⁄ r − κ_y)`: 25/m of 1.5 cm,
/// and 5/m of 3 cm. The chord of 5 cm is shorter by L³ κ ⁄ 12 m for each 1/m more: 0.26 mm at 25/m, and 0.05 mm at 5/m. A stretch of 10⁻⁴ is
/// 0.005 mm of it, which is worth 0.02/m and 0.1/m. Its slowest mode has the frequency ω = 22.4 ⁄ L² √(D ⁄ ρ) = 90/s, and loses (ω ⁄ 1200)² =
/// 0.006 of itself in each of 3000 sub-steps: nothing is left.
#[test]
fn a_strap_of_leather_remembers_its_buckle() {
    for (radius, exact, off) in [(0.015, 25.0, 0.05), (0.03, 5.0, 0.15)] {
        let mut strap = Strip::leather();
        strap.bend_and_release_for(&[1.0 / radius, exact as f32 + 5.0], 150);
        let found = strap.curvature();
        println!("around {radius} m: {found:.3} of {exact}/m");
        assert!((found - exact).abs() < off, "{found} {exact}");
        let law = kept(ClothCreasing::LEATHER, 1.0 / radius);
        assert!((law - exact).abs() < 1.0e-4, "{law}");
    }
}

/// A gentler bend leaves nothing. A chord is shorter by L³ κ² ⁄ 24, so a pressure of 10⁻⁵ looks like 0.3/m.
#[test]
fn a_strap_of_leather_forgets_a_gentle_bend() {
    let mut strap = Strip::leather();
    strap.bend_and_release(20.0);
    let found = strap.curvature();
    assert!(found < 0.4, "{found}");
}

/// A strip that was bent less than it yields is as straight as one that does not crease, to the last bit.
#[test]
fn nothing_stays_of_what_does_not_yield() {
    let strip = |creasing| {
        let mut strips = [Strip::grid(0.02, creasing), Strip::mesh(0.02, creasing)];
        for strip in &mut strips {
            strip.bend_and_release_for(&[6.0], 20);
        }
        strips.map(|strip| strip.particles)
    };
    // Near its border, a mesh of the cylinder is bent by a tenth more.
    assert!(strip(Some(creasing(9.0, 0.2))) == strip(None));
    assert!(strip(Some(creasing(5.0, 0.2))) != strip(None));
}

/// Momentum (kg m/s) and angular momentum (kg m²/s) around the centre of mass, and the kinetic energy (J).
fn momenta(particles: &ClothParticles) -> (DVec3, DVec3, f64) {
    let masses: Vec<f64> = (particles.inverse_masses().map(|of| 1.0 / f64::from(of))).collect();
    let mass: f64 = masses.iter().sum();
    let places: Vec<DVec3> = particles.positions().map(Vec3::as_dvec3).collect();
    let velocity = |index: usize| particles.velocity(index).expect("it exists").as_dvec3();
    let weighed = places
        .iter()
        .zip(&masses)
        .map(|(place, mass)| *mass * *place);
    let centre = weighed.sum::<DVec3>() / mass;
    let (mut momentum, mut turning, mut energy) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for (index, mass) in masses.iter().enumerate() {
        let own = *mass * velocity(index);
        momentum += own;
        turning += (places[index] - centre).cross(own);
        energy += 0.5 * own.dot(velocity(index));
    }
    (momentum, turning, energy)
}

/// A creased strip that is thrown, and turns once a second, keeps its motion as one without creases does. Rounding moves it by 10⁻⁵
/// of its own in 2400 sub-steps. A mesh is solved to 10⁻⁴, and in sub-steps of 1 ms a turn by 6/s has an error of 10⁻⁴ of its own. Its
/// crease turns with it.
#[test]
fn a_creased_strip_flies_on_and_turns_on() {
    for (name, make) in [
        (
            "grid",
            Strip::grid as fn(f32, Option<ClothCreasing>) -> Strip,
        ),
        ("mesh", Strip::mesh),
    ] {
        for crease in [false, true] {
            let creasing = creasing(4.0, 0.2);
            let mut strip = make(0.02, crease.then_some(creasing));
            if crease {
                strip.bend_and_release(10.0);
            }
            let before = strip.curvature();
            let turn = Vec3::new(1.0, 2.0, 6.0);
            for index in 0..strip.rest.len() {
                let place = strip.particles.position(index).expect("it exists");
                let velocity = Vec3::X + turn.cross(place);
                strip
                    .particles
                    .set_velocity(index, velocity)
                    .expect("it exists");
            }
            let (momentum, turning, energy) = momenta(&strip.particles);
            for _ in 0..120 {
                strip.tick(0.0);
            }
            let after = momenta(&strip.particles);
            let off = [
                (after.0 - momentum).length() / momentum.length(),
                (after.1 - turning).length() / turning.length(),
                after.2 / energy - 1.0,
            ];
            println!(
                "{name}, creased {crease}: momentum {:.1e}, angular {:.1e}, energy {:+.1e}, curvature {before:.3} to {:.3}/m",
                off[0],
                off[1],
                off[2],
                strip.curvature()
            );
            assert!(off[0] < 1.0e-4 && off[1] < 1.0e-3, "{off:?}");
            assert!(off[2] < 1.0e-4, "it gains energy: {off:?}");
            assert!((strip.curvature() - before).abs() < 0.02, "{before}");
        }
    }
}

/// At rest in the air, a creased strip does not begin to turn, though a mesh of a cylinder is never without tension: in two seconds it
/// moves by less than a hundredth of its length.
#[test]
fn a_creased_strip_rests() {
    for (name, mut strip) in [
        ("grid", Strip::grid(0.02, Some(creasing(4.0, 0.2)))),
        ("mesh", Strip::mesh(0.02, Some(creasing(4.0, 0.2)))),
    ] {
        strip.bend_and_release(10.0);
        let at: Vec<Vec3> = strip.particles.positions().collect();
        for _ in 0..120 {
            strip.tick(0.0);
        }
        let farthest = strip
            .particles
            .positions()
            .zip(at)
            .map(|(now, at)| now.distance(at));
        let farthest = farthest.fold(0.0, f32::max);
        println!(
            "{name}: moved by {:.3} mm in two seconds",
            1000.0 * farthest
        );
        assert!(farthest < 0.01 * LENGTH, "{name}: {farthest}");
    }
}
