//! How cloth moves: against closed forms.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// Only springs along rows and columns, so that each column hangs by itself.
const COLUMNS_ALONE: ClothMaterial = ClothMaterial {
    shear_compliance: f32::INFINITY,
    bend_rigidity: 0.0,
    ..ClothMaterial::COTTON
};

/// ½ g t², to the rounding of 1280 additions to 5 m and what the first sub-steps, of first order since masses were given, make
/// of it: 3/2 g Δt² with the five sub-steps that 16² particles need.
#[test]
fn free_fall_is_exact() {
    let mut app = app();
    let material = ClothMaterial {
        damping: 0.0,
        ..default()
    };
    let cloth = app
        .world_mut()
        .spawn((Cloth::default(), Pins::none(), material))
        .id();
    tick(&mut app, 64);
    let fallen = -position(&app, cloth, (0, 0)).y;
    let exact = 0.5 * GRAVITY;
    let begun = 1.5 * GRAVITY / (64.0_f32 * 5.0).powi(2);
    assert!(
        (fallen - exact).abs() < 1.1 * begun + 1280.0 * f32::EPSILON * 5.0,
        "{fallen} {exact}"
    );
}

/// Hooke's column: under its own weight a column of height H stretches by α ρ g H²/2, whatever the grid. A sweep
/// that is as stiff as mass/Δt² leaves at most F (w + w) Δt² more a spring, F being the weight below it:
/// (rows − 1)² g Δt² in all.
#[test]
fn a_hanging_cloth_has_the_stretch_that_its_compliance_gives() {
    for (rows, spacing) in [(16, 0.1), (31, 0.05)] {
        let mut app = app();
        let compliance = 0.02;
        let cloth = Cloth::new(6, rows, spacing);
        let material = ClothMaterial {
            stretch_compliance: compliance,
            damping: 0.05,
            ..COLUMNS_ALONE
        };
        let settings = ClothSettings {
            sleeps: false,
            ..ClothSettings::substeps(40)
        };
        let height = cloth.height();
        let entity = app.world_mut().spawn((cloth, material, settings)).id();
        tick(&mut app, 64 * 12);
        let particles = particles(&app, entity);
        let extension = compliance * material.areal_density * GRAVITY * height * height / 2.0;
        let substep = TICK / 40.0;
        let unfinished = ((rows - 1) as f32).powi(2) * GRAVITY * substep * substep;
        for column in 0..6 {
            let end = |row| particles.position((row, column)).expect("a particle");
            let length = (1..rows)
                .map(|row| end(row).distance(end(row - 1)))
                .sum::<f32>();
            let found = length - height;
            assert!(
                (found - extension).abs() < unfinished,
                "{rows} rows: {found} {extension} ± {unfinished}"
            );
        }
        let speed = particles.largest_speed();
        assert!(speed < 1e-3, "at rest, not {speed} m/s");
    }
}

/// With shear springs and bending a cloth hangs no longer than its columns alone would.
#[test]
fn shear_and_bending_only_help() {
    let mut app = app();
    let cloth = Cloth::default();
    let material = ClothMaterial {
        damping: 0.05,
        ..default()
    };
    let height = cloth.height();
    let entity = app.world_mut().spawn((cloth, material)).id();
    tick(&mut app, 64 * 10);
    let elastic =
        material.stretch_compliance * material.areal_density * GRAVITY * height * height / 2.0;
    let unfinished = 15.0_f32.powi(2) * GRAVITY * (TICK / 20.0).powi(2);
    for column in 0..16 {
        let at = |row| position(&app, entity, (row, column));
        let length = (1..16)
            .map(|row| at(row).distance(at(row - 1)))
            .sum::<f32>();
        assert!(length < height + elastic + unfinished, "{length}");
        assert!(length > height * 0.999, "{length}");
    }
}

#[test]
fn a_pinned_particle_never_moves() {
    let mut app = app();
    let pins = Pins::new([Pin::Corner(Corner::TopLeft), Pin::Index(5), Pin::Cell(9, 9)]);
    let cloth = app
        .world_mut()
        .spawn((Cloth::default(), pins, Transform::from_xyz(3.0, 2.0, 1.0)))
        .id();
    app.world_mut()
        .spawn((ClothCollider::ball(0.4), Transform::from_xyz(3.5, 1.5, 1.0)));
    tick(&mut app, 1);
    for _ in 0..100 {
        tick(&mut app, 1);
        for (cell, rest) in [
            ((0, 0), Vec3::ZERO),
            ((0, 5), Vec3::new(0.5, 0.0, 0.0)),
            ((9, 9), Vec3::new(0.90000004, -0.90000004, 0.0)),
        ] {
            assert_eq!(position(&app, cloth, cell), rest);
        }
    }
    assert!(position(&app, cloth, (15, 0)).y < -1.0, "the others do");
}

/// What is pinned follows a change of the pins at run time, and of the masses with them.
#[test]
fn pins_and_material_may_change_at_any_time() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    tick(&mut app, 10);
    let before = position(&app, cloth, (0, 8));
    change::<Pins>(&mut app, cloth, |pins| {
        *pins = Pins::new([Pin::Corner(Corner::TopLeft), Pin::Corner(Corner::TopRight)]);
    });
    change::<ClothMaterial>(&mut app, cloth, |material| material.areal_density = 1.5);
    tick(&mut app, 10);
    assert!(position(&app, cloth, (0, 8)).y < before.y);
    let mass: f32 = particles(&app, cloth)
        .inverse_masses()
        .filter(|&w| w > 0.0)
        .map(f32::recip)
        .sum();
    let corners = 2.0 * 1.5 * 0.1 * 0.1 / 4.0;
    assert!((mass - (1.5 * 1.5 * 1.5 - corners)).abs() < 1e-4, "{mass}");
}

/// A mass that the game has set outlasts a change that has nothing to do with masses.
#[test]
fn a_grabbed_particle_stays_grabbed() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    tick(&mut app, 2);
    change::<ClothParticles>(&mut app, cloth, |particles| {
        particles.set_inverse_mass((9, 9), 0.0).expect("a particle");
    });
    let grabbed = position(&app, cloth, (9, 9));
    change::<ClothMaterial>(&mut app, cloth, |material| {
        material.damping = 0.1;
        material.shear_compliance = f32::INFINITY;
    });
    tick(&mut app, 30);
    assert_eq!(position(&app, cloth, (9, 9)), grabbed);
    change::<ClothMaterial>(&mut app, cloth, |material| material.areal_density = 0.3);
    tick(&mut app, 30);
    assert_ne!(position(&app, cloth, (9, 9)), grabbed);
}

/// Games may write particles, and empty them to begin again.
#[test]
fn games_may_write_particles() {
    let mut app = app();
    let cloth = (Cloth::default().flat(), Pins::none());
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 1);
    change::<ClothParticles>(&mut app, cloth, |particles| {
        for index in 0..particles.len() {
            particles
                .set_velocity(index, Vec3::Z * 3.0)
                .expect("a particle");
        }
    });
    tick(&mut app, 1);
    let z = position(&app, cloth, (4, 4)).z;
    assert!((z - 3.0 * TICK).abs() < 1e-3, "{z}");
    change::<ClothParticles>(&mut app, cloth, |particles| *particles = default());
    tick(&mut app, 1);
    assert_eq!(position(&app, cloth, (4, 4)).z, 0.0);
    change::<Cloth>(&mut app, cloth, |cloth| *cloth = Cloth::new(4, 5, 0.2));
    tick(&mut app, 1);
    assert_eq!(particles(&app, cloth).len(), 20);
}

/// Particles that come with a cloth are where it begins.
#[test]
fn a_cloth_may_begin_in_a_state_of_the_games_own() {
    let mut app = app();
    let cloth = app.world_mut().spawn((Cloth::default(), Pins::none())).id();
    tick(&mut app, 30);
    let fallen = particles(&app, cloth).clone();
    let copy = app
        .world_mut()
        .spawn((Cloth::default(), Pins::none(), fallen))
        .id();
    tick(&mut app, 30);
    assert_eq!(particles(&app, cloth), particles(&app, copy));
}

/// Velocity is g t whatever the sub-steps are and were: displacements are taken over to a new sub-step's length.
/// They are sums of up to 640 rounded terms.
#[test]
fn a_change_of_substeps_keeps_the_speed() {
    let mut app = app();
    let undamped = ClothMaterial {
        damping: 0.0,
        ..default()
    };
    let cloth = (Cloth::default(), Pins::none(), undamped);
    let cloth = app.world_mut().spawn(cloth).id();
    for (second, substeps) in [(0.5, 20), (1.0, 3), (1.5, 7)] {
        change::<ClothSettings>(&mut app, cloth, |settings| {
            settings.substepping = Substepping::Fixed(substeps);
        });
        tick(&mut app, 32);
        let speed = -particles(&app, cloth).velocity(9).expect("a particle").y;
        let expected = GRAVITY * second;
        assert!(
            (speed / expected - 1.0).abs() < 640.0 * f32::EPSILON,
            "{substeps}: {speed} {expected}"
        );
    }
}

/// Neither a huge step nor a change of its length blows a cloth up. In steps of seconds, in which a particle falls
/// hundreds of metres, a cloth may come to lie around the ball in rings that cannot leave it, as nothing passes through
/// a ball any more: it hangs whole again as soon as that is gone.
#[test]
fn huge_and_changing_steps_are_survived() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let ball = (
        ClothCollider::ball(0.4),
        Transform::from_xyz(0.7, -1.0, 0.1),
    );
    let ball = app.world_mut().spawn(ball).id();
    for seconds in [1.0 / 64.0, 1.0, 1.0 / 1000.0, 10.0, 1.0 / 64.0] {
        app.world_mut()
            .resource_mut::<Time<Fixed>>()
            .set_timestep_seconds(seconds);
        for substeps in [1, 20, 3] {
            change::<ClothSettings>(&mut app, cloth, |settings| {
                settings.substepping = Substepping::Fixed(substeps);
            });
            (0..20).for_each(|_| app.update());
            let particles = particles(&app, cloth);
            assert_eq!(particles.validate(), Ok(()));
            assert!(app.world().get::<ClothFault>(cloth).is_none());
        }
    }
    change::<ClothSettings>(&mut app, cloth, |settings| *settings = default());
    app.world_mut().despawn(ball);
    tick(&mut app, 64 * 20);
    let stretch = app
        .world()
        .get::<ClothStats>(cloth)
        .expect("figures")
        .stretch
        .structural;
    // It comes to rest below 1 %; one that had blown up would be at hundreds.
    assert!(stretch < 0.05, "{stretch}");
}
