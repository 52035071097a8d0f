//! Strips of irregular meshes stretch as the material says.

use bevy::math::Vec3;
use bevy_drape::{
    cloth::{ClothMaterial, ClothParticles, Springs, Surface},
    solver::{Bending, Solver, Tethers, TickStep},
};

use crate::meshes::irregular;

const GRAVITY: f32 = 9.81;
/// From the pins to the free end (m).
const HEIGHT: f32 = 2.0;

/// How far a strip that is hung by its top row gives under its weight (m): the mean over its free end. It is `width` m wide
/// and `high` particles high.
fn elongation(width: f32, high: u32, jitter: f32, material: &ClothMaterial) -> f32 {
    let mesh = irregular(width, HEIGHT, HEIGHT / (high - 1) as f32, jitter);
    let surface = Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface");
    let mut particles = ClothParticles::at_rest(&surface, material).expect("a valid material");
    let rest = surface.rest_positions();
    for (index, place) in rest.iter().enumerate() {
        if place.y > -1.0e-6 {
            particles.set_inverse_mass(index, 0.0).expect("it exists");
        }
    }
    let springs = Springs::of_surface(&surface, material);
    let mut solver = Solver::new(&springs, &particles);
    solver.set_bending(Bending::new(&surface, material));
    solver.set_tethers(Tethers::new(&surface, material, &particles, GRAVITY));
    let step = TickStep {
        seconds: 1.0 / 64.0,
        substeps: 80,
        acceleration: Vec3::new(0.0, -GRAVITY, 0.0),
        damping: material.damping,
        ..TickStep::default()
    };
    for _ in 0..64 * 4 {
        solver.advance(&mut particles, step, &[], |_, _| false);
    }
    let end = particles
        .positions()
        .zip(rest)
        .filter(|(_, rest)| rest.y < -HEIGHT + 1.0e-4);
    let sags: Vec<f32> = end.map(|(place, rest)| rest.y - place.y).collect();
    assert!(sags.len() >= 5, "{}", sags.len());
    sags.iter().sum::<f32>() / sags.len() as f32
}

/// A strip of compliance α gives α ρ g H²/2 to a few per cent, the more irregular its triangles are the less exactly, with nothing but springs along its edges
/// and with what resists its bending besides. The finest take most of the time: CI sets `BEVY_DRAPE_LONG`.
#[test]
fn irregular_strips_give_as_the_material_says() {
    let compliance = 2.0e-2;
    let is_long = std::env::var_os("BEVY_DRAPE_LONG").is_some();
    let highs: &[u32] = if is_long { &[16, 32, 48] } else { &[16, 32] };
    for (name, [shear, bend]) in [
        ("edges alone", [f32::INFINITY, 0.0]),
        ("cotton", [10.0 * compliance, 6.0e-6]),
    ] {
        let material = ClothMaterial {
            stretch_compliance: compliance,
            shear_compliance: shear,
            bend_rigidity: bend,
            damping: 0.05,
            ..ClothMaterial::COTTON
        };
        let exact = compliance * material.areal_density * GRAVITY * HEIGHT * HEIGHT / 2.0;
        let (mut least, mut most) = (f32::MAX, f32::MIN);
        for (jitter, allowed) in [(0.1, 0.03), (0.2, 0.04), (0.3, 0.055)] {
            for width in [0.5, 1.0] {
                for &high in highs {
                    let ratio = elongation(width, high, jitter, &material) / exact;
                    println!("{name}, {width} m wide, {high} high, jitter {jitter}: {ratio:.3}");
                    assert!(
                        (ratio - 1.0).abs() < allowed,
                        "{name} {width} {high} {jitter}: {ratio}"
                    );
                    (least, most) = (least.min(ratio), most.max(ratio));
                }
            }
        }
        println!("{name}: {least:.3} to {most:.3}");
    }
}
