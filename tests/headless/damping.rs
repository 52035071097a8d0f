//! What a material's damping takes from: motion relative to what carries the cloth, and no other.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use super::meshes::sheets::sheet;
use crate::support::*;

/// A grid and a mesh of 1.1 m × 1.1 m that hang from the x-axis or lie along it, with pins there.
fn sheets() -> [(Cloth, Pin, Transform); 2] {
    let (positions, triangles) = sheet(12, 12);
    let hanging = Transform::from_rotation(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2));
    [
        (Cloth::new(12, 12, 0.1), Pin::Row(0), Transform::IDENTITY),
        (
            Cloth::triangles(positions, triangles),
            Pin::at_rest(|place| place.z < 0.01),
            hanging,
        ),
    ]
}

/// In the world: the mean velocity of all that is free, by mass (m/s).
fn velocity_of_centre(app: &App, cloth: Entity) -> Vec3 {
    let (mut mass, mut momentum) = (0.0, Vec3::ZERO);
    let particles = particles(app, cloth);
    for (index, inverse_mass) in particles.inverse_masses().enumerate() {
        if inverse_mass > 0.0 {
            mass += 1.0 / inverse_mass;
            momentum += particles.velocity(index).expect("a particle") / inverse_mass;
        }
    }
    let frame: &ClothFrame = app.world().get(cloth).expect("a frame");
    frame.isometry().rotation * (momentum / mass)
}

/// All materials fall alike, v = g t, whatever moves within them: what damping takes is that alone. Each of at most 1280 sub-steps
/// rounds a displacement by 2⁻²⁴ of itself, always to one side at worst: 8·10⁻⁵ of the velocity; solving springs of a mesh and
/// the sum over particles round by as much.
#[test]
fn all_materials_fall_alike_and_lose_inner_motion() {
    for (name, material) in ClothMaterial::PRESETS {
        for (kind, (cloth, _, place)) in ["grid", "mesh"].into_iter().zip(sheets()) {
            let fall = |damping: f32| {
                let mut app = app();
                let material = ClothMaterial {
                    damping,
                    ..material
                };
                // Triangles have no texture for a warp to follow.
                let grain = ClothGrain::along(place.rotation.inverse() * Vec3::Y);
                let bundle = (cloth.clone(), Pins::none(), material, grain, place);
                let cloth = app.world_mut().spawn(bundle).id();
                tick(&mut app, 1);
                change::<ClothParticles>(&mut app, cloth, |particles| {
                    for index in 0..particles.len() {
                        let side = if index % 2 == 0 { 1.0 } else { -1.0 };
                        let normal = place.rotation.inverse() * Vec3::Z;
                        let own = particles.velocity(index).expect("a particle");
                        let shaken = own + 0.5 * side * normal;
                        particles.set_velocity(index, shaken).expect("a particle");
                    }
                });
                let before = velocity_of_centre(&app, cloth);
                tick(&mut app, 64);
                let gained = velocity_of_centre(&app, cloth) - before;
                let off = gained.distance(Vec3::NEG_Y * GRAVITY);
                assert!(off < 2.0e-4 * GRAVITY, "{kind} of {name}: {gained}");
                let particles = particles(&app, cloth);
                let mean = place.rotation.inverse() * velocity_of_centre(&app, cloth);
                let square = |velocity: Vec3| velocity.distance_squared(mean);
                let each = (0..particles.len())
                    .map(|index| square(particles.velocity(index).expect("a particle")));
                (each.sum::<f32>() / particles.len() as f32).sqrt()
            };
            let _ = fall(material.damping);
            // Stiff materials go on to unfold, however damped.
            let [undamped, damped] = [0.0, 0.1].map(fall);
            let is_limp = material.bend_rigidity <= ClothMaterial::COTTON.bend_rigidity;
            assert!(
                !is_limp || damped < 0.6 * undamped,
                "{kind} of {name}: {damped} {undamped}"
            );
        }
    }
}

/// Moves at a speed along z, and faster by an acceleration (m/s, m/s²).
#[derive(Component)]
struct Driving {
    speed: f32,
    acceleration: f32,
}

fn drive(mut driving: Query<(&mut Driving, &mut Transform)>, time: Res<Time>) {
    for (mut driving, mut place) in &mut driving {
        let gained = driving.acceleration * time.delta_secs();
        place.translation.z += (driving.speed + 0.5 * gained) * time.delta_secs();
        driving.speed += gained;
    }
}

/// The angle (°) by which a cape of much damping hangs back from the vertical on a vehicle, 12 s after it went along with it;
/// attached to it, or itself the vehicle.
fn hangs_back(
    (cloth, pin, place): (Cloth, Pin, Transform),
    is_attached: bool,
    speed: f32,
    acceleration: f32,
) -> f32 {
    let mut app = app();
    app.add_systems(FixedUpdate, drive.before(ClothSystems::Prepare));
    let driving = Driving {
        speed,
        acceleration,
    };
    let damped = ClothMaterial {
        damping: 0.05,
        ..default()
    };
    let bundle = (cloth, damped, place);
    let cape = if is_attached {
        let vehicle = app.world_mut().spawn((Transform::default(), driving)).id();
        let attached = ClothAttachments::new([(pin, vehicle)]);
        app.world_mut().spawn((bundle, Pins::none(), attached)).id()
    } else {
        app.world_mut()
            .spawn((bundle, Pins::new([pin]), driving))
            .id()
    };
    tick(&mut app, 1);
    change::<ClothParticles>(&mut app, cape, |particles| {
        let along = place.rotation.inverse() * Vec3::Z * speed;
        for index in 0..particles.len() {
            particles.set_velocity(index, along).expect("a particle");
        }
    });
    tick(&mut app, 64 * 12);
    let frame: &ClothFrame = app.world().get(cape).expect("a frame");
    let particles = particles(&app, cape);
    let mut ends = [(Vec3::ZERO, 0.0); 2];
    for (index, inverse_mass) in particles.inverse_masses().enumerate() {
        let at = frame.to_world(particles.position(index).expect("a particle"));
        let end = &mut ends[usize::from(inverse_mass > 0.0)];
        *end = (end.0 + at, end.1 + 1.0);
    }
    let [pins, free] = ends.map(|(sum, count)| sum / count);
    let arm = free - pins;
    (-arm.z).atan2(-arm.y).to_degrees()
}

/// A vehicle that drives on evenly is as one that stands: at 20 m/s the cape hangs straight down. On one that gains 3 m/s each
/// second, it hangs back by atan(a/g) = 17.0°. Half a degree is 1 cm at its hem: what a damped swing of 45 cm keeps of itself after 12 s,
/// e^(−1.5 · 12), is far less; a bend by the moment of its stiffness at the pins is less, too.
#[test]
fn a_cape_on_a_vehicle_hangs_as_gravity_and_acceleration_say() {
    for is_attached in [false, true] {
        for sheet in sheets() {
            for (speed, acceleration) in [(20.0, 0.0), (0.0, 3.0)] {
                let found = hangs_back(sheet.clone(), is_attached, speed, acceleration);
                let expected = (acceleration / GRAVITY).atan().to_degrees();
                println!("attached {is_attached}, {speed} m/s, {acceleration} m/s²: {found}°");
                assert!((found - expected).abs() < 0.5, "{found}° {expected}°");
            }
        }
    }
}

/// Damping does not hold back what friction carries: a sheet of D = 0.3, which would slip by 1 m/s · k of 21 m/s² if it were slowed down
/// against the world, lies still on a platform that moves at 1 m/s.
#[test]
fn a_platform_carries_what_lies_on_it() {
    let mut app = app();
    app.add_systems(FixedUpdate, drive.before(ClothSystems::Prepare));
    let driving = Driving {
        speed: 1.0,
        acceleration: 0.0,
    };
    app.world_mut().spawn((
        ClothCollider::cuboid(2.0, 0.1, 2.0),
        driving,
        Transform::from_xyz(0.0, -0.1, 0.0),
    ));
    let damped = ClothMaterial {
        damping: 0.3,
        ..default()
    };
    let sheet = (
        Cloth::new(12, 12, 0.1).lying().centred(),
        Pins::none(),
        damped,
        Transform::from_xyz(0.0, 0.02, 0.0),
    );
    let sheet = app.world_mut().spawn(sheet).id();
    tick(&mut app, 64 * 2);
    let at = |app: &App| {
        let frame: &ClothFrame = app.world().get(sheet).expect("a frame");
        frame.to_world(position(app, sheet, (6, 6))).z
    };
    let before = at(&app);
    tick(&mut app, 64);
    let carried = at(&app) - before;
    assert!((carried - 1.0).abs() < 0.01, "{carried} m");
}

/// Pins that the game frees by hand hold nothing any more: what falls is damped against itself, with tethers and without.
#[test]
fn what_is_freed_by_hand_falls_freely() {
    for tethers in [false, true] {
        let mut app = app();
        let material = ClothMaterial {
            damping: 0.02,
            ..default()
        };
        let settings = ClothSettings {
            tethers,
            ..default()
        };
        let bundle = (Cloth::new(9, 9, 0.1), material, settings);
        let cloth = app.world_mut().spawn(bundle).id();
        tick(&mut app, 4);
        change::<ClothParticles>(&mut app, cloth, |particles| {
            let free = particles.inverse_mass(40).expect("a particle");
            for index in 0..particles.len() {
                if particles.inverse_mass(index) == Some(0.0) {
                    particles.set_inverse_mass(index, free).expect("a mass");
                }
            }
        });
        tick(&mut app, 1);
        let from = velocity_of_centre(&app, cloth);
        tick(&mut app, 32);
        let fallen = velocity_of_centre(&app, cloth) - from;
        let truth = -32.0 * TICK * GRAVITY;
        // Rounding: see above.
        let error = (fallen.y / truth - 1.0).abs();
        assert!(error < 1.0e-3, "{fallen} {truth}, {tethers}");
    }
}
