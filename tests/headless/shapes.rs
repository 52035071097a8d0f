//! What happens when a cloth meets shapes of every kind, large and small, still and moving.

use std::f32::consts::{FRAC_PI_2, PI};

use bevy::prelude::*;
use bevy_drape::{contact::deepest_penetration, plugin::ClothContact, prelude::*};

use crate::support::*;

/// Positions of a few metres in single precision, after some operations each (m).
const ROUNDING: f64 = 3.0e-6;

/// Lies flat at a height, its middle above the origin.
fn lying(cloth: Cloth, height: f32) -> (Cloth, Transform) {
    let place = Transform::from_xyz(-cloth.width() / 2.0, height, -cloth.height() / 2.0);
    let turned = Quat::from_rotation_x(-FRAC_PI_2);
    (cloth, place.with_rotation(turned))
}

/// Every shape, and how high it reaches (m), unturned.
fn shapes() -> Vec<(ClothCollider, f32)> {
    let pyramid = [
        Vec3::new(-0.3, -0.2, -0.3),
        Vec3::new(0.3, -0.2, -0.3),
        Vec3::new(0.3, -0.2, 0.3),
        Vec3::new(-0.3, -0.2, 0.3),
        Vec3::Y * 0.2,
    ];
    let sides = [
        [0, 1, 2],
        [0, 2, 3],
        [0, 4, 1],
        [1, 4, 2],
        [2, 4, 3],
        [3, 4, 0],
    ];
    let stool = [
        (
            Isometry3d::from_xyz(0.0, 0.15, 0.0),
            ClothCollider::cylinder(0.3, 0.1),
        ),
        (Isometry3d::IDENTITY, ClothCollider::cuboid(0.1, 0.3, 0.1)),
    ];
    vec![
        (ClothCollider::cylinder(0.3, 0.4), 0.2),
        (ClothCollider::cone(0.3, 0.5), 0.25),
        (ClothCollider::convex_hull(pyramid), 0.2),
        (ClothCollider::trimesh(pyramid, sides), 0.2),
        (ClothCollider::compound(stool), 0.2),
        (ClothCollider::ball(0.3), 0.3),
        (ClothCollider::capsule(0.2, 0.4), 0.4),
        (ClothCollider::cuboid(0.5, 0.4, 0.6), 0.2),
        (ClothCollider::plane(), 0.0),
    ]
}

fn contact(app: &App, cloth: Entity, collider: Entity) -> Option<ClothContact> {
    let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
    contacts.with(collider).copied()
}

/// How deep the deepest free particle is inside of a collider (m), in f64.
fn left_inside(app: &App, cloth: Entity, collider: Entity) -> f64 {
    let world = app.world();
    let frame = world.get::<ClothFrame>(cloth).expect("a frame");
    let settings = world.get::<ClothSettings>(cloth).expect("settings");
    let transform = world.get::<Transform>(collider).expect("a transform");
    let shape = world.get::<ClothCollider>(collider).expect("a collider");
    let shape = shape.scaled(transform.scale).expect("a valid collider");
    let pose = frame.isometry().inverse() * transform.to_isometry();
    deepest_penetration(
        particles(app, cloth),
        &shape,
        pose,
        settings.particle_radius,
    )
}

/// How deep a particle may be inside after a tick (m): what is drawn is inside only beyond its radius of 10 mm. What came in within a
/// sub-step is pushed out at its end; an older overlap, as edges leave one, is let out slowly, so that it throws nothing. The deepest of these drops is
/// 5.4 mm, on the edge of a turned cone.
const LEFT: f64 = 0.006;

/// Drops a free cloth on a collider whose transform goes as `at` says of the tick; after each tick, none of its
/// particles may be inside by more than what is let out slowly.
fn drop_on(collider: ClothCollider, height: f32, at: impl Fn(f32) -> Transform) {
    let mut app = app();
    let cloth = (lying(Cloth::new(24, 24, 0.05), height + 0.05), Pins::none());
    let cloth = app.world_mut().spawn(cloth).id();
    let entity = app.world_mut().spawn((collider.clone(), at(0.0))).id();
    let (mut deepest, mut most) = (0.0_f64, 0);
    for step in 1..=96 {
        change::<Transform>(&mut app, entity, |transform| *transform = at(step as f32));
        tick(&mut app, 1);
        deepest = deepest.max(left_inside(&app, cloth, entity));
        let contact = contact(&app, cloth, entity);
        most = most.max(contact.map_or(0, |contact| contact.particles));
        let is_embedded = contact.is_some_and(|contact| contact.is_embedded);
        assert!(!is_embedded, "{collider:?}: it came from outside");
    }
    assert!(deepest < LEFT, "{collider:?}: {deepest} m left inside");
    assert!(most > 4, "{collider:?}: {most} particles");
    let started = messages::<ClothTouchStarted>(&mut app);
    let first = started.first().expect("a touch");
    assert_eq!((first.cloth, first.collider), (cloth, entity));
    assert_eq!(particles(&app, cloth).validate(), Ok(()));
}

#[test]
fn nothing_is_left_inside_of_any_shape() {
    for (collider, height) in shapes() {
        drop_on(collider, height, |_| Transform::default());
    }
}

/// Turned about a slanted axis, and of another size along each axis: so each shape is not what it is at rest.
#[test]
fn nothing_is_left_inside_of_a_turned_and_scaled_shape() {
    let turned = Quat::from_axis_angle(Vec3::new(1.0, 0.5, -0.7).normalize(), 0.6);
    let scale = Vec3::new(1.2, 0.8, 1.5);
    for (collider, _) in shapes() {
        let height = match collider {
            ClothCollider::Plane => 1.0,
            _ => 0.6,
        };
        let place = Transform::from_xyz(0.03, 0.02, -0.04);
        drop_on(collider, height, |_| {
            place.with_rotation(turned).with_scale(scale)
        });
    }
}

/// Coming up at 1 m/s, to the side, and turning once a second: each sub-step tests it where it then is.
#[test]
fn nothing_is_left_inside_of_a_shape_that_moves_and_turns() {
    for (collider, height) in shapes() {
        let axis = match collider {
            // A plane that turned over would come round from above.
            ClothCollider::Plane => Vec3::Y,
            _ => Vec3::new(0.3, 1.0, 0.2).normalize(),
        };
        let clear = height + 0.3;
        drop_on(collider, clear, |step| {
            let seconds = step * TICK;
            let way = Vec3::new(0.3, 1.0, -0.2) * seconds.min(0.8);
            let turned = Quat::from_axis_angle(axis, 2.0 * PI * seconds);
            Transform::from_translation(way).with_rotation(turned)
        });
    }
}

/// A sheet on a plane lies at its particles' radius, wherever the plane is and however it is tilted: held by
/// friction or sliding, every particle is in contact in every sub-step.
#[test]
fn a_sheet_rests_on_a_plane_at_its_particles_radius() {
    for (height, tilt) in [(0.0, 0.0), (1.5, 0.0), (-0.7, 0.2), (0.3, 0.7)] {
        let mut app = app();
        let plane = Transform::from_xyz(0.0, height, 0.0)
            .with_rotation(Quat::from_rotation_z(tilt))
            .with_scale(Vec3::new(3.0, 0.5, 2.0));
        app.world_mut().spawn((ClothCollider::plane(), plane));
        // Parallel to the plane, 5 cm above it.
        let (cloth, place) = lying(Cloth::new(16, 16, 0.1), 0.05);
        let place = Transform::from_isometry(plane.to_isometry() * place.to_isometry());
        let settings = ClothSettings {
            particle_radius: 0.02,
            ..default()
        };
        let cloth = (cloth, Pins::none(), settings, place);
        let cloth = app.world_mut().spawn(cloth).id();
        tick(&mut app, 64);
        let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
        for position in particles(&app, cloth).positions() {
            let above = (frame.to_world(position) - plane.translation).dot(plane.up().into());
            let off = f64::from((above - 0.02).abs());
            assert!(off < ROUNDING, "{above} m above, at {height} m, {tilt} rad");
        }
    }
}

/// Each of twenty balls has a contact of its own; one that is despawned as it touches says goodbye, and the others
/// go on touching.
#[test]
fn twenty_balls_are_twenty_contacts_and_one_may_vanish() {
    let mut app = app();
    let cloth = (lying(Cloth::new(41, 33, 0.05), 0.11), Pins::none());
    let cloth = app.world_mut().spawn(cloth).id();
    let balls: Vec<Entity> = (0..20)
        .map(|ball| {
            let (x, z) = ((ball % 5) as f32 - 2.0, (ball / 5) as f32 - 1.5);
            let place = Transform::from_xyz(0.4 * x, 0.0, 0.4 * z);
            app.world_mut()
                .spawn((ClothCollider::ball(0.1), place))
                .id()
        })
        .collect();
    let touched = |app: &App| {
        let contacts = app.world().get::<ClothContacts>(cloth).expect("contacts");
        contacts.iter().len()
    };
    let all = (0..64).any(|_| {
        tick(&mut app, 1);
        touched(&app) == 20
    });
    assert!(all, "{} of 20", touched(&app));
    let each = balls.iter().map(|&ball| contact(&app, cloth, ball));
    let sum: usize = each
        .map(|contact| contact.expect("a contact").particles)
        .sum();
    let stats = *app.world().get::<ClothStats>(cloth).expect("figures");
    assert_eq!(stats.contacts, sum);
    assert_eq!(stats.colliders_near, 20);
    messages::<ClothTouchStopped>(&mut app);

    app.world_mut().despawn(balls[7]);
    tick(&mut app, 1);
    let stopped = messages::<ClothTouchStopped>(&mut app);
    assert!(
        stopped
            .iter()
            .any(|reported| (reported.cloth, reported.collider) == (cloth, balls[7]))
    );
    assert_eq!(contact(&app, cloth, balls[7]), None);
    assert!(touched(&app) > 10);
    // And all at once, their cloth among them.
    balls
        .iter()
        .filter(|&&ball| ball != balls[7])
        .for_each(|&ball| {
            app.world_mut().despawn(ball);
        });
    app.world_mut().despawn(cloth);
    tick(&mut app, 2);
}

/// A sheet held by its rim, with a collider at its middle, from above.
fn sheet_and(collider: ClothCollider, at: Vec3, narrow_phase: NarrowPhase) -> (App, [Entity; 2]) {
    let mut app = app();
    let rim = Pins::filter(|row, column| row % 16 == 0 || column % 16 == 0);
    let cloth = (lying(Cloth::new(17, 17, 0.1), 0.0), rim, narrow_phase);
    let cloth = app.world_mut().spawn(cloth).id();
    let place = Transform::from_translation(at);
    let collider = app.world_mut().spawn((collider, place)).id();
    (app, [cloth, collider])
}

#[test]
fn small_colliders_are_tested_against_triangles_and_large_ones_against_particles() {
    use NarrowPhase::{Auto, Particles, Triangles};
    let ball = |radius| (ClothCollider::ball(radius), Vec3::Y * (radius - 0.03));
    let capsule = (ClothCollider::capsule(0.15, 0.4), Vec3::Y * 0.32);
    let cuboid = (ClothCollider::cuboid(0.3, 0.2, 0.3), Vec3::Y * 0.07);
    let plane = (ClothCollider::plane(), Vec3::Y * -0.005);
    for ((collider, at), asked, expected) in [
        (ball(0.2), Auto, Triangles),
        (ball(0.4), Auto, Particles),
        (capsule, Auto, Triangles),
        (ball(0.2), Particles, Particles),
        (ball(0.4), Triangles, Triangles),
        (cuboid.clone(), Auto, Triangles),
        (cuboid.clone(), Particles, Particles),
        (cuboid, Triangles, Triangles),
        (plane, Triangles, Particles),
    ] {
        let (mut app, [cloth, collider_entity]) = sheet_and(collider.clone(), at, asked);
        tick(&mut app, 2);
        let contact = contact(&app, cloth, collider_entity).expect("a contact");
        assert_eq!(contact.narrow_phase, expected, "{collider:?} {asked:?}");
        let stats = app.world().get::<ClothStats>(cloth).expect("figures");
        assert_eq!(stats.by_triangles, usize::from(expected == Triangles));
    }
}

/// A ball of 0.4 spacings is pressed 0.2 m down through the middle of a cell. By particles, which it slips between
/// since radius and particle's radius together are less than half of the cell's diagonal, it goes through; by triangles
/// it takes the cloth along.
#[test]
fn a_small_ball_does_not_slip_through_unless_only_particles_are_tested() {
    let height = |step: i32| 0.06 - 0.26 * step as f32 / 96.0;
    let press = |narrow_phase| {
        let at = |step| Vec3::new(0.05, height(step), 0.05);
        let (mut app, [cloth, ball]) = sheet_and(ClothCollider::ball(0.04), at(0), narrow_phase);
        for step in 1..=96 {
            change::<Transform>(&mut app, ball, |place| place.translation = at(step));
            tick(&mut app, 1);
        }
        let corners = [(8, 8), (8, 9), (9, 8), (9, 9)];
        let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
        let heights = corners.map(|corner| frame.to_world(position(&app, cloth, corner)).y);
        let touches = contact(&app, cloth, ball).is_some();
        (heights.iter().sum::<f32>() / 4.0, touches)
    };
    let (by_triangles, touches) = press(NarrowPhase::Auto);
    assert!(touches && by_triangles < height(96), "{by_triangles} m");
    let (by_particles, touches) = press(NarrowPhase::Particles);
    assert!(!touches && by_particles > -0.1, "{by_particles} m");
}

/// Without gravity a sheet stays flat until it is pushed, so the first sub-step finds what geometry says: of a plane,
/// all of the sheet at one depth; of a ball, a disk.
#[test]
fn area_and_volume_of_a_contact_are_those_of_geometry() {
    let flat = |collider: ClothCollider, spacing: f32, at: Vec3| {
        let mut app = app();
        app.insert_resource(ClothGravity(Vec3::ZERO));
        let cloth = (lying(Cloth::new(65, 65, spacing), 0.0), Pins::none());
        let cloth = app.world_mut().spawn(cloth).id();
        let place = Transform::from_translation(at);
        let collider = app.world_mut().spawn((collider, place)).id();
        tick(&mut app, 1);
        contact(&app, cloth, collider).expect("a contact")
    };
    // All of the cloth is 3 cm inside, its own radius included.
    let found = flat(ClothCollider::plane(), 0.1, Vec3::Y * 0.02);
    let area = 6.4 * 6.4;
    assert!((found.area / area - 1.0).abs() < 1e-4, "{found:?}");
    assert!(
        (found.volume / (0.03 * area) - 1.0).abs() < 1e-4,
        "{found:?}"
    );

    // Radius with that of the particles R, centre at a height h: a disk of radius a, and R − √(h² + ρ²) deep.
    let (spacing, whole, height) = (0.02, 0.51_f32, 0.47_f32);
    let found = flat(ClothCollider::ball(0.5), spacing, Vec3::Y * height);
    let a = (whole * whole - height * height).sqrt();
    // Each particle stands for a square; those whose squares the circle crosses are at most half a diagonal off it.
    let half_diagonal = spacing / 2.0_f32.sqrt();
    let (low, high) = (a - half_diagonal, a + half_diagonal);
    assert!(found.narrow_phase == NarrowPhase::Particles);
    assert!(
        (PI * low * low..PI * high * high).contains(&found.area),
        "{found:?}, a {a}"
    );
    let volume = PI * whole * a * a - 2.0 / 3.0 * PI * (whole.powi(3) - height.powi(3));
    // The depth's slope is at most a / R: that over half a diagonal in the ring of squares that the circle crosses,
    // and its curvature, at most 1 / h, in all the others by the midpoint rule.
    let ring = PI * (high * high - low * low) * a / whole * half_diagonal;
    let inner = PI * a * a * spacing * spacing / (12.0 * height);
    assert!(
        (found.volume - volume).abs() < ring + inner,
        "{found:?}, volume {volume} ± {}",
        ring + inner
    );
}

/// Runs a ball of a radius against the middle of a free cloth, in the middle of a cell, at a speed; until 2 m beyond.
/// Returns how far the cell's corners are in front of the ball's centre at the end, and whatever was left inside.
fn shoot(radius: f32, speed: f32, substeps: u32) -> (f32, f64) {
    let mut app = app_with_moving_balls();
    let settings = ClothSettings::substeps(substeps);
    let cloth = (Cloth::default(), Pins::none(), settings);
    let cloth = app.world_mut().spawn(cloth).id();
    // A collider's first way is known from its second tick on.
    let place = Transform::from_xyz(0.75, -0.75, -0.6 - 1.5 * speed * TICK);
    let ball = (ClothCollider::ball(radius), Moving(speed), place);
    let ball = app.world_mut().spawn(ball).id();
    let mut left = 0.0_f64;
    for _ in 0..2 + (2.0 / speed / TICK).ceil() as usize {
        tick(&mut app, 1);
        left = left.max(left_inside(&app, cloth, ball));
    }
    assert!(!messages::<ClothTouchStarted>(&mut app).is_empty());
    let centre = app.world().get::<Transform>(ball).expect("there");
    let centre = centre.translation.z;
    let corners = [(7, 7), (7, 8), (8, 7), (8, 8)];
    let ahead = corners.map(|cell| position(&app, cloth, cell).z - centre);
    (ahead.iter().sum::<f32>() / 4.0, left)
}

/// A ball that goes many times its size in a tick takes the cloth along. Of a smaller one the cell's corners say less, as
/// it wraps into the cell: that its centre passes through no triangle, up to 400 m/s, is tested beside the narrow phase.
#[test]
fn a_fast_ball_takes_the_cloth_along() {
    for (radius, fastest) in [(0.3, 400.0), (0.06, 100.0)] {
        for speed in [10.0, 50.0, 100.0, 200.0, 400.0]
            .into_iter()
            .filter(|speed| *speed <= fastest)
        {
            let (ahead, left) = shoot(radius, speed, 20);
            assert!(
                ahead > 0.0,
                "{radius} m at {speed} m/s: {ahead} m in front of it"
            );
            assert!(left < 1.0e-5, "{left} m left inside");
        }
    }
}

/// However fast, it leaves no particle inside.
#[test]
fn whatever_its_speed_nothing_is_left_inside_of_a_ball() {
    for speed in [100.0, 200.0, 1000.0] {
        let (_, left) = shoot(0.3, speed, 20);
        // Its centre is up to 3 speeds × a tick away from the cloth: rounding grows with it.
        let tolerance = 1.0e-6 * f64::from(1.0 + 3.0 * speed * TICK);
        assert!(left < tolerance, "{left} m left inside at {speed} m/s");
    }
}

/// Triangles at pins are left out where a box is right at them; once the pins are gone they are tested, though something is known of
/// the same particles already.
#[test]
fn pins_may_be_taken_off_at_a_box() {
    let mut app = app();
    let cloth = (Cloth::new(9, 9, 0.1).lying(), Pins::top_row());
    let cloth = app.world_mut().spawn(cloth).id();
    let place = Transform::from_xyz(0.4, -0.1, 0.0);
    app.world_mut()
        .spawn((ClothCollider::cuboid(0.5, 0.1, 0.1), place));
    tick(&mut app, 30);
    app.world_mut().entity_mut(cloth).insert(Pins::none());
    tick(&mut app, 30);
    assert!(app.world().get::<ClothFault>(cloth).is_none());
}
