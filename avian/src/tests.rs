//! Tests of the adapter.

use super::*;

/// Goes on by so many ticks.
fn run(app: &mut App, ticks: u32) {
    for _ in 0..ticks {
        app.update();
    }
}

/// The trampoline takes the ball's fall and its weight: the ball rests on it, in the dent that its weight makes.
#[test]
fn the_ball_rests_on_the_trampoline() {
    let mut app = game();
    let cloth = app.world_mut().spawn(trampoline()).id();
    run(&mut app, 3 * TICKS);
    let [.., unloaded] = look(&app, cloth, cloth);
    let ball = app.world_mut().spawn(ball(1.0)).id();
    run(&mut app, 19 * TICKS);
    let mut lowest = Vec::new();
    for _ in 0..TICKS {
        run(&mut app, 1);
        let [height, speed, dent] = look(&app, ball, cloth);
        // Gravity acts at once, and the cloth takes its impulse back over the tick: half of it remains.
        assert!(
            speed.abs() < 0.6 * 9.81 / TICKS as f32,
            "{speed} m/s after twenty seconds"
        );
        assert!((height - RADIUS - dent).abs() < 0.01, "{height}, {dent}");
        lowest.push(dent);
    }
    let [deep, high] =
        [f32::min, f32::max].map(|f| lowest.iter().copied().reduce(f).unwrap_or(0.0));
    println!("the dent: {deep} to {high} m, {unloaded} m without the ball");
    assert!(high - deep < 5.0e-3, "it moves from {deep} to {high}");
    assert!(
        deep > -0.3 && high < unloaded - 0.01,
        "{deep}, {unloaded} without the ball"
    );
    let [place, position] = [
        app.world().get::<Transform>(ball).map(|at| at.translation),
        app.world().get::<Position>(ball).map(|at| at.0),
    ];
    assert_eq!(place, position);
}

/// Nothing else of this program holds the ball.
#[test]
fn without_push_back_the_ball_falls() {
    let mut app = game();
    let cloth = app.world_mut().spawn(trampoline()).id();
    let ball = app.world_mut().spawn(ball(1.0)).id();
    app.world_mut().entity_mut(ball).remove::<AvianPushBack>();
    run(&mut app, 2 * TICKS);
    let [height, ..] = look(&app, ball, cloth);
    assert!(height < -10.0, "{height}");
}

/// A thrown sheet gives its lost momentum to Avian's body, within a dozen roundings of a float per tick.
#[test]
fn a_body_gets_what_the_cloth_lost() {
    let mut app = game();
    app.insert_resource(Gravity(Vec3::ZERO))
        .insert_resource(ClothGravity(Vec3::ZERO));
    let material = ClothMaterial {
        damping: 0.0,
        ..ClothMaterial::COTTON
    };
    let sheet = Cloth::new(17, 17, 0.05).lying().centred();
    let above = Transform::from_xyz(0.1, 0.25, -0.1);
    let sheet = app
        .world_mut()
        .spawn((sheet, Pins::none(), material, above))
        .id();
    let ball = app.world_mut().spawn(ball(0.0)).id();
    run(&mut app, 4);
    let mut particles = app
        .world_mut()
        .get_mut::<ClothParticles>(sheet)
        .expect("particles");
    for index in 0..particles.len() {
        particles
            .set_velocity(index, Vec3::NEG_Y * 2.0)
            .expect("it exists");
    }
    let momenta = |app: &App| {
        let particles = app.world().get::<ClothParticles>(sheet).expect("particles");
        let of_particle = |index| {
            let mass = 1.0 / particles.inverse_mass(index).expect("it exists");
            (particles.velocity(index).expect("it exists") * mass).as_dvec3()
        };
        let of_sheet: bevy::math::DVec3 = (0..particles.len()).map(of_particle).sum();
        let velocity = app.world().get::<LinearVelocity>(ball).expect("a velocity");
        (of_sheet, (velocity.0 * MASS).as_dvec3())
    };
    let (start, _) = momenta(&app);
    run(&mut app, TICKS);
    let (of_sheet, of_ball) = momenta(&app);
    let off = (of_sheet + of_ball - start).length() / start.length();
    println!("off by {off}, the ball has {of_ball} of {start}");
    assert!(off < 1.0e-5, "momentum is off by {off}");
    assert!(
        of_ball.y < 0.2 * start.y,
        "the ball has {of_ball} of {start}"
    );
}

/// A cloth that falls on a collider of Avian's lies on Avian's surface of it.
#[test]
fn cloth_lies_on_every_shape() {
    let corners = [
        Vec3::ZERO,
        Vec3::new(1.5, 0.2, 0.0),
        Vec3::new(0.0, 0.4, 1.5),
        Vec3::new(-1.0, 0.3, -1.2),
    ];
    let pyramid = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    // Steep along one axis only.
    let ground = vec![
        vec![0.0, 0.0, 0.0],
        vec![0.5, 0.5, 0.5],
        vec![0.2, 0.2, 0.2],
        vec![0.7, 0.7, 0.7],
    ];
    let turned = Rotation(Quat::from_rotation_z(0.4));
    let shapes = [
        ("sphere", Collider::sphere(0.8)),
        ("cuboid", Collider::cuboid(1.5, 0.4, 1.2)),
        ("cylinder", Collider::cylinder(0.9, 0.3)),
        ("cone", Collider::cone(0.9, 0.5)),
        (
            "capsule",
            Collider::capsule_endpoints(0.5, Vec3::X, Vec3::new(-1.0, 0.3, 0.1)),
        ),
        ("half-space", Collider::half_space(Vec3::Y)),
        (
            "hull",
            Collider::convex_hull(corners.to_vec()).expect("it has a volume"),
        ),
        ("triangles", Collider::trimesh(corners.to_vec(), pyramid)),
        (
            "height field",
            Collider::heightfield(ground, Vec3::new(3.0, 1.0, 2.0)),
        ),
        (
            "compound",
            Collider::compound(vec![(
                Vec3::X * 0.2,
                turned,
                Collider::cuboid(1.5, 0.2, 1.5),
            )]),
        ),
    ];
    for (name, collider) in shapes {
        let mut app = game();
        let place = Transform::from_xyz(0.3, -0.2, 0.1).with_rotation(Quat::from_rotation_y(0.5));
        let body = (
            RigidBody::Static,
            collider.clone(),
            AvianClothCollider,
            place,
        );
        let body = app.world_mut().spawn(body).id();
        let cloth = Cloth::new(13, 13, 0.04).lying().centred();
        let above = Transform::from_xyz(0.3, 0.9, 0.1);
        let cloth = app.world_mut().spawn((cloth, Pins::none(), above)).id();
        let mut is_touched = false;
        for _ in 0..TICKS {
            run(&mut app, 1);
            let contacts = app.world().get::<ClothContacts>(cloth);
            is_touched |= contacts.is_some_and(|contacts| contacts.with(body).is_some());
            let frame = *app.world().get::<ClothFrame>(cloth).expect("a frame");
            let particles = app.world().get::<ClothParticles>(cloth).expect("particles");
            for at in particles.positions().map(|at| frame.to_world(at)) {
                let sky = at.with_y(5.0);
                let hit = collider.cast_ray(
                    place.translation,
                    place.rotation,
                    sky,
                    Vec3::NEG_Y,
                    20.0,
                    true,
                );
                let deep = hit.map_or(0.0, |(way, _)| 5.0 - way - at.y);
                assert!(deep < 0.01, "{name}: {at} is {deep} m below the surface");
            }
        }
        assert!(is_touched, "{name}");
    }
}

/// A body's locks are the cloth's; what no longer is dynamic is not pushed.
#[test]
fn locks_and_kinds_count() {
    let mut app = game();
    let locks = LockedAxes::new().lock_translation_x().lock_rotation_z();
    let ball = app.world_mut().spawn((ball(0.0), locks)).id();
    run(&mut app, 2);
    let body = app.world().get::<ClothBody>(ball).expect("a body");
    assert_eq!(body.mass, MASS);
    assert_eq!(body.locked_translation, BVec3::new(true, false, false));
    assert_eq!(body.locked_rotation, BVec3::new(false, false, true));
    app.world_mut()
        .entity_mut(ball)
        .insert(RigidBody::Kinematic);
    run(&mut app, 1);
    assert!(!app.world().entity(ball).contains::<ClothBody>());
    app.world_mut().entity_mut(ball).insert(RigidBody::Dynamic);
    run(&mut app, 1);
    assert!(app.world().entity(ball).contains::<ClothBody>());
    app.world_mut()
        .entity_mut(ball)
        .remove::<(AvianPushBack, AvianClothCollider)>();
    assert!(!app.world().entity(ball).contains::<ClothBody>());
    assert!(!app.world().entity(ball).contains::<ClothCollider>());
}
