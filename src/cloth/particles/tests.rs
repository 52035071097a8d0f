//! Indices, masses, velocities, and NaN.

use super::*;
use crate::cloth::recipe::Cloth;

fn particles() -> ClothParticles {
    let surface = Cloth::new(4, 3, 0.5)
        .surface(Vec3::ONE)
        .expect("a valid grid");
    ClothParticles::at_rest(&surface, &ClothMaterial::COTTON).expect("a valid material")
}

#[test]
fn index_and_cell_name_the_same_particle() {
    let mut particles = particles();
    assert_eq!(particles.index((2, 1)), Some(9));
    assert_eq!(particles.position(9), particles.position((2, 1)));
    particles.set_velocity((2, 1), Vec3::X).expect("it exists");
    assert!((particles.velocity(9).expect("it exists") - Vec3::X).length() < 1e-6);
    assert_eq!((particles.columns(), particles.rows()), (4, 3));
    assert_eq!(
        particles.index((0, 4)),
        None,
        "a column too far is not the next row"
    );
    assert!(matches!(
        particles.set_position((3, 0), Vec3::ZERO),
        Err(ParticleError::NoSuchParticle { rows: 3, .. })
    ));
}

#[test]
fn masses_add_up_to_density_times_area() {
    let mass: f32 = particles().inverse_masses().map(f32::recip).sum();
    assert!((mass - 0.15 * 1.5).abs() < 1e-6);
}

#[test]
fn set_substep_keeps_velocities() {
    let mut particles = particles();
    particles
        .set_velocity(5, Vec3::new(1.0, -2.0, 3.0))
        .expect("it exists");
    particles.set_substep(0.01);
    let velocity = particles.velocity(5).expect("it exists");
    assert!((velocity - Vec3::new(1.0, -2.0, 3.0)).length() < 1e-6);
    assert!((particles.displacement(5).expect("it exists").x - 0.01).abs() < 1e-8);
}

#[test]
fn each_number_that_is_not_finite_is_found() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.0e30] {
        let mut particles = particles();
        particles
            .set_position(7, Vec3::new(0.0, bad, 0.0))
            .expect("it exists");
        assert!(matches!(
            particles.validate(),
            Err(ParticleError::NotFinite { index: 7, .. })
        ));
        let mut particles = self::particles();
        particles
            .set_displacement(11, Vec3::new(0.0, 0.0, bad))
            .expect("it exists");
        assert!(matches!(
            particles.validate(),
            Err(ParticleError::NotFinite { index: 11, .. })
        ));
    }
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0] {
        let mut particles = particles();
        particles.set_inverse_mass(0, bad).expect("it exists");
        assert!(matches!(
            particles.validate(),
            Err(ParticleError::NotFinite { index: 0, .. })
        ));
    }
    assert_eq!(particles().validate(), Ok(()));
}
