//! Meshes whose threads are solved there and back: what they gain, how far they stretch, and how fast they converge.

use bevy::math::{DVec3, Vec3};
use bevy_drape::{
    cloth::{ClothMaterial, ClothParticles, Springs, Surface},
    solver::{Solver, TickStep},
};

use crate::{meshes, scene::GRAVITY};

/// A square of 2 m, lying, of irregular triangles or of a grid's.
fn surface(side: u32, is_regular: bool) -> Surface {
    let spacing = 2.0 / (side - 1) as f32;
    let mesh = if is_regular {
        meshes::regular(side, side, spacing)
    } else {
        meshes::irregular(2.0, 2.0, spacing, 0.3)
    };
    Surface::of_mesh(&mesh, 1.0e-5, Vec3::ONE).expect("a surface")
}

/// A solver of the same springs one by one.
fn one_sweep(springs: &Springs, particles: &ClothParticles) -> Solver {
    let list = Springs::of_list(&springs.to_vec(), particles.len()).expect("valid springs");
    Solver::new(&list, particles)
}

/// Without damping and bending, of these compliances along edges and in shear (m/N).
fn material(compliance: f32, shear: f32) -> ClothMaterial {
    ClothMaterial {
        areal_density: 0.15,
        stretch_compliance: compliance,
        shear_compliance: shear,
        bend_rigidity: 0.0,
        weft: None,
        stiffening: None,
        stretch_damping: 0.0,
        damping: 0.0,
        friction: 0.0,
    }
}

/// It lies, all but 10⁻⁵ m, and is held where `is_pinned` says so of a place at rest.
fn lying(
    surface: &Surface,
    material: &ClothMaterial,
    is_pinned: impl Fn(Vec3) -> bool,
) -> ClothParticles {
    let mut particles = ClothParticles::at_rest(surface, material).expect("a valid material");
    for (index, place) in surface.rest_positions().iter().enumerate() {
        let uneven = 1.0e-5 * (1.7 * index as f32).sin();
        particles
            .set_position(index, Vec3::new(place.x, uneven, -place.y))
            .expect("it exists");
        if is_pinned(*place) {
            particles.set_inverse_mass(index, 0.0).expect("it exists");
        }
    }
    particles
}

fn step(substeps: u32, acceleration: Vec3) -> TickStep {
    TickStep {
        seconds: 1.0 / 60.0,
        substeps,
        acceleration,
        ..TickStep::default()
    }
}

/// Kinetic and potential energy (J): what springs hold comes on top, so that this is never more than what there was before they
/// were stretched.
fn energy(particles: &ClothParticles, acceleration: Vec3) -> f64 {
    let own = |index: usize| {
        let weight = particles.inverse_mass(index).expect("it exists");
        let place = particles.position(index).expect("it exists").as_dvec3();
        let velocity = particles.velocity(index).expect("it exists").as_dvec3();
        let energy = velocity.length_squared() / 2.0 - acceleration.as_dvec3().dot(place);
        if weight > 0.0 {
            energy / f64::from(weight)
        } else {
            0.0
        }
    };
    (0..particles.len()).map(own).sum()
}

/// Rigid and soft, alone and with rigid or soft springs across edges; hung by its top edge, two corners or one, held along two
/// sides, or shaken without gravity. One per cent of the energy of a fall by 1 m, or of what it is shaken with, is left for the
/// velocities, which are those of half a sub-step before.
#[test]
fn no_mesh_gains_energy() {
    let corner = |place: Vec3, x: f32| place.distance(Vec3::X * x) < 1.0e-3;
    let pinnings: [(&str, Box<dyn Fn(Vec3) -> bool>); 5] = [
        ("top", Box::new(|place| place.y > -1.0e-4)),
        (
            "two corners",
            Box::new(move |place| corner(place, 0.0) || corner(place, 2.0)),
        ),
        ("one corner", Box::new(move |place| corner(place, 0.0))),
        ("two sides", Box::new(|place| (place.x - 1.0).abs() > 0.999)),
        ("shaken", Box::new(|_| false)),
    ];
    let mut worst = 0.0_f64;
    for is_regular in [true, false] {
        let surface = surface(16, is_regular);
        for (compliance, shear) in [
            (0.0, f32::INFINITY),
            (0.0, 0.0),
            (1.0e-4, f32::INFINITY),
            (1.0e-4, 0.0),
            (1.0e-3, 1.0e-3),
        ] {
            let material = material(compliance, shear);
            let springs = Springs::of_surface(&surface, &material);
            for (name, is_pinned) in &pinnings {
                for substeps in [5, 10, 20, 40] {
                    let mut particles = lying(&surface, &material, is_pinned);
                    let mut acceleration = GRAVITY;
                    if *name == "shaken" {
                        acceleration = Vec3::ZERO;
                        for index in 0..particles.len() {
                            let phase = index as f32;
                            let wave =
                                Vec3::new(phase.sin(), (1.7 * phase).cos(), (0.3 * phase).sin());
                            particles
                                .set_velocity(index, wave / 2.0)
                                .expect("it exists");
                        }
                    }
                    let start = energy(&particles, acceleration);
                    let mass: f64 = particles
                        .inverse_masses()
                        .filter(|weight| *weight > 0.0)
                        .map(|weight| 1.0 / f64::from(weight))
                        .sum();
                    let scale = if acceleration == Vec3::ZERO {
                        start
                    } else {
                        mass * 9.81
                    };
                    let mut solver = Solver::of_surface(&surface, &springs);
                    for _ in 0..180 {
                        solver.advance(
                            &mut particles,
                            step(substeps, acceleration),
                            &[],
                            |_, _| false,
                        );
                        let gained = (energy(&particles, acceleration) - start) / scale;
                        assert!(
                            gained < 0.01,
                            "{name}, {compliance} {shear}, {substeps} sub-steps: {gained}"
                        );
                        worst = worst.max(gained);
                    }
                }
            }
        }
    }
    println!("most gained: {:.2} %", 100.0 * worst);
}

/// Rigid, hung from the horizontal, in 20 sub-steps: the largest stretch in the third second, against springs swept one by one.
#[test]
fn a_mesh_stretches_less_than_by_one_sweep() {
    for is_regular in [true, false] {
        let surface = surface(32, is_regular);
        let material = material(0.0, f32::INFINITY);
        let springs = Springs::of_surface(&surface, &material);
        let start = lying(&surface, &material, |place| {
            (place.y > -1.0e-4) && (place.x - 1.0).abs() > 0.999
        });
        let largest = |mut solver: Solver| {
            let mut particles = start.clone();
            (0..180).fold(0.0_f32, |largest, tick| {
                let stretch = solver.advance(&mut particles, step(20, GRAVITY), &[], |_, _| false);
                if tick < 120 {
                    0.0
                } else {
                    largest.max(stretch.structural)
                }
            })
        };
        let swept = largest(one_sweep(&springs, &start));
        let solved = largest(Solver::of_surface(&surface, &springs));
        println!(
            "two corners, regular {is_regular}: {:.1} %, by one sweep {:.1} %",
            100.0 * solved,
            100.0 * swept
        );
        assert!(solved < 0.1 && solved < swept / 4.0, "{solved} {swept}");
    }
}

/// Soft, fallen for a second from the horizontal: five sub-steps are nearer to a converged run than twenty sweeps.
#[test]
fn a_mesh_is_exact_in_few_sub_steps() {
    let surface = surface(24, false);
    let material = material(1.0e-3, f32::INFINITY);
    let springs = Springs::of_surface(&surface, &material);
    let start = lying(&surface, &material, |place| place.y > -1.0e-4);
    let fallen = |mut solver: Solver, substeps: u32| -> Vec<DVec3> {
        let mut particles = start.clone();
        for _ in 0..60 {
            let step = TickStep {
                material_stretch: 1.0,
                ..step(substeps, GRAVITY)
            };
            solver.advance(&mut particles, step, &[], |_, _| false);
        }
        particles.positions().map(Vec3::as_dvec3).collect()
    };
    let solved = |substeps| fallen(Solver::of_surface(&surface, &springs), substeps);
    let swept = |substeps| fallen(one_sweep(&springs, &start), substeps);
    let truth = solved(640);
    let off = |places: Vec<DVec3>| {
        let squares = places
            .iter()
            .zip(&truth)
            .map(|(a, b)| a.distance_squared(*b));
        (squares.sum::<f64>() / truth.len() as f64).sqrt()
    };
    let (five, twenty) = (off(solved(5)), off(swept(20)));
    println!("{five:.4} m off in 5 sub-steps, by one sweep {twenty:.4} in 20");
    assert!(five < twenty, "{five} {twenty}");
}

/// Cotton that hangs by its upper edge is pulled by ρ g H there, and gives α ρ g H, to a tenth: the springs there end below the edge.
/// In a frame that is 1 % wider, a mesh of a grid's triangles has springs of 1/α along rows and columns and of half of that along
/// diagonals: Σ F/l = 5 ε/((1 + ε) α) at a particle of the mass ρ h², so that ω² = 7.5 ε/((1 + ε) α ρ h²), resolved by 2.2/ω. As a
/// mesh is calibrated, and solved chain by chain, a tenth is allowed.
#[test]
fn a_mesh_knows_its_tension() {
    let (side, material) = (33, material(1.0e-4, f32::INFINITY));
    let surface = surface(side, true);
    let springs = Springs::of_surface(&surface, &material);
    let hung = |wider: f32, is_pinned: &dyn Fn(Vec3) -> bool| {
        let mut particles = ClothParticles::at_rest(&surface, &material).expect("a valid material");
        for (index, place) in surface.rest_positions().iter().enumerate() {
            particles
                .set_position(index, wider * *place)
                .expect("it exists");
            if is_pinned(*place) {
                particles.set_inverse_mass(index, 0.0).expect("it exists");
            }
        }
        let mut solver = Solver::of_surface(&surface, &springs);
        let mut step = step(40, GRAVITY);
        step.damping = 0.1;
        let mut stretch = solver.measure(&particles);
        for _ in 0..180 {
            stretch = solver.advance(&mut particles, step, &[], |_, _| false);
        }
        stretch
    };
    let stretch = hung(1.0, &|place| place.y > -1.0e-4);
    let pull = material.areal_density * 9.81 * 2.0;
    let given = material.stretch_compliance * pull;
    println!("hung: {} of {given}", stretch.material);
    assert!((stretch.material / given - 1.0).abs() < 0.1);
    let on_frame = |at: f32| !(1.0e-4..2.0 - 1.0e-4).contains(&at);
    let stretch = hung(1.01, &|place| on_frame(place.x) || on_frame(-place.y));
    let spacing = 2.0 / (side - 1) as f32;
    let mass = material.areal_density * spacing * spacing;
    let square = 7.5 * 0.01 / 1.01 / material.stretch_compliance / mass;
    let wanted = square.sqrt() / 60.0 / 2.2;
    println!(
        "in a frame: {} of {wanted} sub-steps",
        stretch.ripple_substeps
    );
    assert!((stretch.ripple_substeps / wanted - 1.0).abs() < 0.1);
    assert!((stretch.material / 0.01 - 1.0).abs() < 0.1);
}
