//! Bad input: named, logged once, left out; everything else goes on, and mending is enough.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

#[derive(Resource, Default)]
struct TimesReported(usize);

/// Runs a good cloth and ball beside `bad`, which must end with a fault that `is_expected`, reported once; then
/// mends it, and expects it to be simulated.
pub fn expect_fault(
    bad: impl Bundle,
    spoil: impl FnOnce(&mut App, Entity),
    is_expected: fn(&ClothError) -> bool,
    mend: impl FnOnce(&mut App, Entity),
) {
    let mut app = app();
    app.init_resource::<TimesReported>()
        .add_observer(|_: On<Insert, ClothFault>, mut times: ResMut<TimesReported>| times.0 += 1);
    let bad = app.world_mut().spawn(bad).id();
    let good = app.world_mut().spawn((Cloth::default(), Pins::none())).id();
    spoil(&mut app, bad);
    tick(&mut app, 5);
    // As text, in which a NaN equals another.
    let state = |app: &App| format!("{:?}", app.world().get::<ClothParticles>(bad));
    let left = state(&app);
    tick(&mut app, 5);
    assert_eq!(state(&app), left, "left as it is while at fault");
    let fault = app
        .world()
        .get::<ClothFault>(bad)
        .map(|fault| fault.error.clone());
    let error = fault.expect("a fault");
    assert!(is_expected(&error), "{error:?}");
    assert_eq!(app.world().resource::<TimesReported>().0, 1, "{error}");
    assert!(
        position(&app, good, (0, 0)).y < -0.05,
        "the good cloth falls"
    );
    mend(&mut app, bad);
    tick(&mut app, 10);
    assert!(app.world().get::<ClothFault>(bad).is_none(), "mended");
    if app.world().get::<Cloth>(bad).is_some() {
        let particles = particles(&app, bad);
        assert_eq!(particles.validate(), Ok(()));
        assert!(
            particles.position((1, 1)).expect("a particle").y < -0.1,
            "and simulated"
        );
    }
}

fn expect_bad_quantity(bad: impl Bundle, mend: impl FnOnce(&mut App, Entity)) {
    expect_fault(bad, |_, _| {}, |error| error.quantity().is_some(), mend);
}

fn mend_cloth(app: &mut App, entity: Entity) {
    change::<Cloth>(app, entity, |cloth| *cloth = default());
}

#[test]
fn too_few_columns_or_rows() {
    for (columns, rows) in [(0, 0), (1, 16), (16, 1), (0, 5)] {
        let is_expected =
            |error: &ClothError| matches!(error, ClothError::Grid(GridError::TooSmall { .. }));
        expect_fault(
            Cloth::new(columns, rows, 0.1),
            |_, _| {},
            is_expected,
            mend_cloth,
        );
    }
}

#[test]
fn a_product_that_overflows() {
    for (columns, rows) in [
        (u32::MAX, u32::MAX),
        (65_536, 65_536),
        (1 << 16, (1 << 8) + 1),
    ] {
        let is_expected =
            |error: &ClothError| matches!(error, ClothError::Grid(GridError::TooLarge { .. }));
        expect_fault(
            Cloth::new(columns, rows, 0.1),
            |_, _| {},
            is_expected,
            mend_cloth,
        );
    }
}

#[test]
fn a_spacing_that_is_no_length() {
    for spacing in [0.0, -0.1, f32::NAN, f32::INFINITY, 1e-25] {
        expect_bad_quantity(Cloth::new(8, 8, spacing), mend_cloth);
    }
}

#[test]
fn a_material_that_cannot_be() {
    let spoiled: [fn(&mut ClothMaterial); 11] = [
        |material| material.areal_density = 0.0,
        |material| material.areal_density = -1.0,
        |material| material.areal_density = f32::NAN,
        |material| material.areal_density = 1e-38,
        |material| material.stretch_compliance = -1.0,
        |material| material.stretch_compliance = f32::INFINITY,
        |material| material.shear_compliance = f32::NAN,
        |material| material.bend_rigidity = -0.5,
        |material| material.damping = 1.5,
        |material| {
            material.weft = Some(ClothWeft {
                stretch_compliance: f32::NAN,
                ..default()
            });
        },
        |material| material.friction = f32::NAN,
    ];
    for spoil in spoiled {
        let mut material = ClothMaterial::COTTON;
        spoil(&mut material);
        expect_bad_quantity((Cloth::default(), material), |app, entity| {
            change::<ClothMaterial>(app, entity, |material| *material = ClothMaterial::SILK);
        });
    }
}

#[test]
fn settings_that_cannot_be() {
    let good = ClothSettings::default();
    for settings in [
        ClothSettings::substeps(0),
        ClothSettings::substeps(u32::MAX),
        ClothSettings {
            particle_radius: -0.1,
            ..good
        },
        ClothSettings {
            gravity: Some(Vec3::NAN),
            ..good
        },
    ] {
        expect_bad_quantity((Cloth::default(), settings), |app, entity| {
            change::<ClothSettings>(app, entity, |settings| *settings = default());
        });
    }
}

#[test]
fn a_pin_out_of_range() {
    for pin in [
        Pin::Index(256),
        Pin::Cell(16, 0),
        Pin::Row(16),
        Pin::Column(99),
    ] {
        expect_fault(
            (Cloth::default(), Pins::new([pin])),
            |_, _| {},
            |error| matches!(error, ClothError::Pin(PinError::OutOfRange { .. })),
            |app, entity| change::<Pins>(app, entity, |pins| *pins = default()),
        );
    }
}

#[test]
fn a_transform_that_is_not_finite() {
    for bad in [
        Transform::from_xyz(f32::NAN, 0.0, 0.0),
        Transform::from_xyz(0.0, f32::INFINITY, 0.0),
        Transform::from_scale(Vec3::new(1.0, 0.0, 1.0)),
        Transform::from_scale(Vec3::NAN),
        Transform::from_rotation(Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)),
    ] {
        expect_fault(
            (Cloth::default(), bad),
            |_, _| {},
            |error| {
                matches!(
                    error,
                    ClothError::Transform(TransformError::Unusable { .. })
                )
            },
            |app, entity| change::<Transform>(app, entity, |transform| *transform = default()),
        );
    }
}

/// Nor does a transform that goes bad mid-run lose the cloth.
#[test]
fn a_transform_that_goes_bad() {
    expect_fault(
        Cloth::default(),
        |app, entity| {
            tick(app, 5);
            change::<Transform>(app, entity, |transform| transform.translation = Vec3::NAN);
        },
        |error| {
            matches!(
                error,
                ClothError::Transform(TransformError::Unusable { .. })
            )
        },
        |app, entity| change::<Transform>(app, entity, |transform| *transform = default()),
    );
}

#[test]
fn a_nan_that_a_game_wrote() {
    for bad in [f32::NAN, f32::INFINITY] {
        expect_fault(
            Cloth::default(),
            move |app, entity| {
                tick(app, 2);
                change::<ClothParticles>(app, entity, |particles| {
                    particles
                        .set_position((3, 4), Vec3::splat(bad))
                        .expect("a particle");
                });
            },
            |error| {
                matches!(
                    error,
                    ClothError::Particle(ParticleError::NotFinite { index: 52, .. })
                )
            },
            |app, entity| {
                change::<ClothParticles>(app, entity, |particles| {
                    particles
                        .set_position((3, 4), Vec3::new(0.4, -0.3, 0.0))
                        .expect("a particle");
                });
            },
        );
    }
}

#[test]
fn particles_of_another_cloth() {
    let surface = Cloth::new(4, 4, 0.1)
        .surface(Vec3::ONE)
        .expect("a valid grid");
    let foreign =
        ClothParticles::at_rest(&surface, &ClothMaterial::COTTON).expect("a valid material");
    expect_fault(
        (Cloth::default(), foreign),
        |_, _| {},
        |error| {
            matches!(
                error,
                ClothError::Particle(ParticleError::Count {
                    expected: 256,
                    found: 16
                })
            )
        },
        |app, entity| change::<ClothParticles>(app, entity, |particles| *particles = default()),
    );
}

#[test]
fn a_collider_of_no_size() {
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        expect_bad_quantity(ClothCollider::ball(radius), |app, entity| {
            change::<ClothCollider>(app, entity, |collider| *collider = default());
        });
    }
    expect_bad_quantity(
        (ClothCollider::default(), Transform::from_scale(Vec3::ZERO)),
        |app, entity| {
            change::<Transform>(app, entity, |transform| transform.scale = Vec3::ONE);
        },
    );
}

#[test]
fn a_collider_nowhere() {
    expect_fault(
        (
            ClothCollider::default(),
            Transform::from_xyz(0.0, f32::NAN, 0.0),
        ),
        |_, _| {},
        |error| {
            matches!(
                error,
                ClothError::Transform(TransformError::Unusable { .. })
            )
        },
        |app, entity| change::<Transform>(app, entity, |transform| *transform = default()),
    );
}

/// Larger than what can be computed with; only a plane has no end.
#[test]
fn a_collider_beyond_measure() {
    for collider in [
        ClothCollider::ball(1.0e13),
        ClothCollider::capsule(0.1, f32::MAX),
    ] {
        expect_bad_quantity(collider, |app, entity| {
            change::<ClothCollider>(app, entity, |collider| *collider = ClothCollider::plane());
        });
    }
}

/// A collider at fault is not there; mended, it is there at once, and has not come from where it was.
#[test]
fn a_collider_at_fault_is_not_met() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    let place = Transform::from_xyz(0.75, -1.0, 9.0);
    let ball = (ClothCollider::ball(0.3), place);
    let ball = app.world_mut().spawn(ball).id();
    let touches = |app: &App| {
        let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
        contacts.with(ball).is_some()
    };
    let put = |app: &mut App, z: f32| {
        change::<Transform>(app, ball, |place| place.translation.z = z);
        tick(app, 1);
    };
    tick(&mut app, 2);
    put(&mut app, f32::NAN);
    put(&mut app, -9.0);
    let lowest = particles(&app, cloth).positions().map(|at| at.z);
    let lowest = lowest.fold(0.0, f32::min);
    assert!(lowest > -0.1, "it has swept the cloth along: {lowest}");
    put(&mut app, f32::NAN);
    put(&mut app, 0.1);
    assert!(touches(&app));
    put(&mut app, f32::NAN);
    assert!(!touches(&app));
}

#[test]
fn gravity_that_is_not_finite() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::default()).id();
    app.insert_resource(ClothGravity(Vec3::NAN));
    tick(&mut app, 3);
    assert!(app.world().get::<ClothFault>(cloth).is_some());
    app.insert_resource(ClothGravity::default());
    tick(&mut app, 3);
    assert!(app.world().get::<ClothFault>(cloth).is_none());
}

/// An entity may be a cloth and a collider at once: each part's fault is reported once.
#[test]
fn a_cloth_that_is_a_collider_too() {
    let aside = Transform::from_xyz(9.0, 0.0, 0.0);
    expect_fault(
        (
            Cloth::default(),
            ClothCollider::ball(0.05),
            aside,
            Pins::new([Pin::Row(99)]),
        ),
        |_, _| {},
        |error| matches!(error, ClothError::Pin(PinError::OutOfRange { .. })),
        |app, entity| change::<Pins>(app, entity, |pins| *pins = default()),
    );
}

/// Each error says what is wrong, with the value.
#[test]
fn errors_read_well() {
    let error = Cloth::new(1, 8, 0.1)
        .grid(Vec3::ONE)
        .expect_err("too small");
    assert_eq!(
        error.to_string(),
        "a cloth needs at least 2 columns and 2 rows, not 1 × 8"
    );
    let error = Cloth::new(8, 8, -0.5)
        .grid(Vec3::ONE)
        .expect_err("negative");
    assert_eq!(error.to_string(), "spacing (m) must be positive, not -0.5");
    let surface = Cloth::new(4, 3, 0.5).surface(Vec3::ONE).expect("valid");
    let error = Pins::new([Pin::Row(3)])
        .validate(&surface)
        .expect_err("out of range");
    assert_eq!(
        error.to_string(),
        "Row(3) is outside a cloth of 4 columns × 3 rows"
    );
    let mut app = app();
    let nowhere = Transform::from_xyz(f32::NAN, 1.0, 0.0);
    let cloth = (Cloth::new(4, 4, 0.1), nowhere);
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 1);
    let fault = app.world().get::<ClothFault>(cloth).expect("a fault");
    assert_eq!(
        fault.error.to_string(),
        "the global transform must be finite, with a scale other than zero: \
         at [NaN, 1, 0], axes [1, 0, 0], [0, 1, 0] and [0, 0, 1]"
    );
}
