//! Particles that a game gives a cloth.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{faults::expect_fault, meshes::sheets::sheet, support::*};

const COLUMNS: u32 = 24;
const ROWS: u32 = 19;

fn grid() -> Cloth {
    Cloth::new(COLUMNS, ROWS, 0.05).flat()
}

/// The particles of the grid, bulged, as a surface has them.
fn bulged() -> ClothParticles {
    let surface = grid().surface(Vec3::ONE).expect("a valid grid");
    let material = ClothMaterial::COTTON;
    let mut particles = ClothParticles::at_rest(&surface, &material).expect("a material");
    for index in 0..particles.len() {
        let place = particles.position(index).expect("a particle");
        let bulge = Vec3::Z * 0.1 * (4.0 * place.x).sin() * place.y;
        particles
            .set_position(index, place + bulge)
            .expect("a particle");
    }
    particles
}

/// The same as a list.
fn listed() -> ClothParticles {
    let particles = bulged();
    let (places, masses): (Vec<_>, Vec<_>) = particles
        .positions()
        .zip(particles.inverse_masses())
        .unzip();
    ClothParticles::new(&places, &masses).expect("finite particles")
}

/// A grid goes on from a list as from the particles of its own surface, to the last bit: spawned with it, or given it later.
#[test]
fn a_list_of_particles_is_laid_out_as_the_grid() {
    let mut app = app();
    let [own, list] = [bulged(), listed()].map(|given| app.world_mut().spawn((grid(), given)).id());
    let late = app.world_mut().spawn(grid()).id();
    tick(&mut app, 1);
    let first = position(&app, own, (9, 7));
    assert!(first.z.abs() > 0.01, "{first}");
    assert_eq!(position(&app, list, (9, 7)), first);
    tick(&mut app, 30);
    assert_eq!(particles(&app, own), particles(&app, list));
    change::<ClothParticles>(&mut app, late, |particles| *particles = listed());
    tick(&mut app, 1);
    for cloth in [own, list, late] {
        assert!(app.world().get::<ClothFault>(cloth).is_none());
    }
    assert_eq!(particles(&app, late).columns(), COLUMNS);
    let apart = position(&app, late, (9, 7)).distance(first);
    assert!(apart < 1.0e-2, "{apart}");
}

/// As many particles in other rows are not in the places of the grid's: the fault says both, and a list mends it.
#[test]
fn as_many_particles_of_another_grid_are_a_fault() {
    let turned = Cloth::new(ROWS, COLUMNS, 0.05).surface(Vec3::ONE);
    let turned = turned.expect("a valid grid");
    let turned = ClothParticles::at_rest(&turned, &ClothMaterial::COTTON).expect("a material");
    let (positions, triangles) = sheet(COLUMNS, ROWS);
    let mesh = Cloth::triangles(positions, triangles);
    for (cloth, says) in [
        (grid(), "the cloth has 24 columns × 19 rows, its"),
        (mesh, "the cloth has 456 particles of 456 vertices, its"),
    ] {
        let mut app = app();
        let cloth = app.world_mut().spawn((cloth, turned.clone())).id();
        tick(&mut app, 2);
        let fault = app.world().get::<ClothFault>(cloth).expect("a fault");
        assert_eq!(
            fault.error.to_string(),
            format!(
                "{says} `ClothParticles` have 19 columns × 24 rows: insert `ClothParticles::new` with a position for each index, or \
                 `ClothParticles::default()` to build the cloth at rest"
            )
        );
        change::<ClothParticles>(&mut app, cloth, |particles| *particles = listed());
        tick(&mut app, 2);
        assert!(app.world().get::<ClothFault>(cloth).is_none());
    }
}

/// A list of more or fewer is a fault that gives both numbers, and so is one of other masses.
#[test]
fn a_list_of_another_length_is_a_fault() {
    let short = ClothParticles::new(&[Vec3::ZERO; 9], &[1.0; 9]).expect("finite particles");
    expect_fault(
        (Cloth::new(4, 4, 0.1), short),
        |_, _| {},
        |error| {
            error.to_string()
                == "the cloth has 16 particles, its `ClothParticles` hold 9: insert 16, or `ClothParticles::default()` to build the cloth at \
                    rest"
        },
        |app, entity| change::<ClothParticles>(app, entity, |particles| *particles = default()),
    );
    let error = ClothParticles::new(&[Vec3::ZERO; 9], &[1.0; 8]).expect_err("a mass is missing");
    assert_eq!(
        error.to_string(),
        "9 positions have 8 inverse masses: give one for each"
    );
}
