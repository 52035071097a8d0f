//! Torn cloth through rollback, sleep, drawing, seams and hands.

use super::*;

/// Whatever was torn after a snapshot is whole again when it is restored, and tears as before, to the bit: also in an app that
/// has just spawned its cloth.
#[test]
fn what_is_torn_is_rolled_back() {
    for cloth in [Cloth::new(9, 9, 0.1), mesh(0.8, 0.8, 0.1)] {
        let spawn = |app: &mut App| {
            let parts = (
                cloth.clone(),
                top(),
                ClothMaterial::COTTON,
                ClothTearing::default(),
            );
            app.world_mut().spawn(parts).id()
        };
        let mut app = app();
        let torn = spawn(&mut app);
        tick(&mut app, 20);
        cut_at(&mut app, -0.33);
        tick(&mut app, 10);
        let saved = ClothSnapshot::of(app.world(), torn).expect("a cloth");
        let go_on = |app: &mut App, cloth: Entity| {
            tick(app, 5);
            cut_at(app, -0.62);
            tick(app, 25);
            particles(app, cloth).clone()
        };
        let expected = go_on(&mut app, torn);
        saved.restore(app.world_mut(), torn).expect("it is there");
        assert!(go_on(&mut app, torn) == expected);
        let mut other = crate::support::app();
        let clone = spawn(&mut other);
        saved
            .restore(other.world_mut(), clone)
            .expect("it is there");
        assert!(go_on(&mut other, clone) == expected);
        // Between a cut and its opening.
        cut_at(&mut app, -0.18);
        let saved = ClothSnapshot::of(app.world(), torn).expect("a cloth");
        tick(&mut app, 20);
        let expected = particles(&app, torn).clone();
        for app in [&mut app, &mut other] {
            let mut cloths = app.world_mut().query_filtered::<Entity, With<Cloth>>();
            let cloth = cloths.single(app.world()).expect("one cloth");
            saved.restore(app.world_mut(), cloth).expect("it is there");
            tick(app, 20);
            assert_eq!(app.world().get::<ClothFault>(cloth), None);
            assert!(particles(app, cloth) == &expected);
        }
        // Mended, it is the whole cloth.
        app.world_mut()
            .entity_mut(torn)
            .insert(ClothTears::default());
        tick(&mut app, 1);
        assert_eq!(surface(&app, torn).pieces(), 1);
        assert!(!surface(&app, torn).is_torn());
    }
}

/// All edges at once: each face is a piece of its own, and falls. The mass stays: shares of areas are rounded by some 10⁻⁷. No two faces
/// cross, though those that hang from pins swing among those that fall.
#[test]
fn all_edges_may_tear_at_once() {
    for cloth in [Cloth::new(12, 12, 0.1), mesh(1.1, 1.1, 0.1)] {
        let mut app = app();
        let parts = (cloth, ClothTears::default(), ClothSelfCollision::default());
        let cloth = app.world_mut().spawn(parts).id();
        tick(&mut app, 3);
        let (edges, faces) = (
            edges_where(&app, cloth, |_| true),
            surface(&app, cloth).triangles().len(),
        );
        let (mass, _) = motion(&app, cloth);
        tear(&mut app, cloth, edges);
        for ticks in [1, 9, 20] {
            tick(&mut app, ticks);
            assert_eq!(crossings(&app, cloth), 0);
        }
        assert!((motion(&app, cloth).0 / mass - 1.0).abs() < 1.0e-6);
        assert_eq!(surface(&app, cloth).pieces(), faces);
        assert_eq!(particles(&app, cloth).len(), 3 * faces);
        assert!(particles(&app, cloth).validate().is_ok());
        assert_eq!(app.world().get::<ClothFault>(cloth), None);
    }
}

#[test]
fn what_is_no_tear_is_said() {
    let mut app = app();
    let cloth = app
        .world_mut()
        .spawn((Cloth::new(5, 5, 0.1), ClothTears::default()))
        .id();
    tick(&mut app, 2);
    // Blades that are nowhere, or miss.
    for from in [
        [Vec3::NAN; 2],
        [Vec3::INFINITY, Vec3::ZERO],
        [Vec3::splat(3.0), Vec3::splat(4.0)],
        [Vec3::ZERO; 2],
    ] {
        assert_eq!(sweep(&mut app, from, [Vec3::splat(5.0), Vec3::ONE]), 0);
    }
    let fault = |app: &App| {
        app.world()
            .get::<ClothFault>(cloth)
            .map(|fault| fault.error.clone())
    };
    let place = position(&app, cloth, (3, 3));
    tear(&mut app, cloth, [[0, 13]]);
    tick(&mut app, 1);
    assert_eq!(
        fault(&app),
        Some(ClothError::Tear(TearError::NoSuchEdge { edge: [0, 13] }))
    );
    assert_eq!(position(&app, cloth, (3, 3)), place, "it is left out");
    app.world_mut()
        .entity_mut(cloth)
        .insert(ClothTears::default());
    tick(&mut app, 1);
    assert_eq!(fault(&app), None);
    for strength in [0.0, -3.0, f32::NAN] {
        app.world_mut()
            .entity_mut(cloth)
            .insert((ClothMaterial::COTTON, ClothTearing::new(strength)));
        tick(&mut app, 1);
        assert!(
            matches!(fault(&app), Some(ClothError::Quantity(_))),
            "{strength}"
        );
    }
    let rigid = ClothMaterial {
        stretch_compliance: 0.0,
        ..ClothMaterial::COTTON
    };
    app.world_mut()
        .entity_mut(cloth)
        .insert((rigid, ClothTearing::default()));
    tick(&mut app, 1);
    assert!(matches!(fault(&app), Some(ClothError::Quantity(_))));
}

/// The drawn mesh has the faces of the torn surface: its vertices are where the particles are, with the texture of the whole.
#[test]
fn what_is_torn_is_drawn_torn() {
    let mut app = app_that_draws(FixedUpdate);
    let asset = irregular(0.8, 0.8, 0.1, 0.3);
    let whole = Mesh::new(bevy::mesh::PrimitiveTopology::TriangleList, default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, asset.positions.clone())
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, asset.normals.clone())
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, asset.uvs.clone())
        .with_inserted_indices(bevy::mesh::Indices::U32(
            asset.triangles.iter().flatten().copied().collect(),
        ));
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(whole);
    let of_asset = app
        .world_mut()
        .spawn((Cloth::mesh(), Mesh3d(handle), top(), ClothTears::default()))
        .id();
    let of_grid = app
        .world_mut()
        .spawn((Cloth::new(9, 9, 0.1), ClothTears::default()))
        .id();
    tick(&mut app, 20);
    assert!(cut_at(&mut app, -0.43) > 14);
    tick(&mut app, 8);
    for cloth in [of_asset, of_grid] {
        let handle = app
            .world()
            .get::<Mesh3d>(cloth)
            .expect("it is drawn")
            .0
            .clone();
        let mesh = app
            .world()
            .resource::<Assets<Mesh>>()
            .get(&handle)
            .expect("its mesh");
        let Some(VertexAttributeValues::Float32x3(places)) =
            mesh.attribute(Mesh::ATTRIBUTE_POSITION)
        else {
            panic!("positions");
        };
        let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0)
        else {
            panic!("texture coordinates");
        };
        let indices: Vec<usize> = mesh.indices().expect("indices").iter().collect();
        let surface = surface(&app, cloth);
        assert_eq!(indices.len(), 3 * surface.triangles().len());
        // No side of a drawn triangle is stretched across the cut, and the texture is where it was at rest.
        for triangle in indices.chunks(3) {
            for side in 0..3 {
                let [a, b] = [triangle[side], triangle[(side + 1) % 3]];
                let long = Vec3::from(places[a]).distance(Vec3::from(places[b]));
                let at_rest = 0.8 * Vec2::from(uvs[a]).distance(Vec2::from(uvs[b]));
                assert!(long < 1.1 * at_rest, "{long} {at_rest}");
            }
        }
        assert_eq!(surface.pieces(), 2);
    }
}

/// The parts of a cloth that was cut lie still, and it falls asleep.
#[test]
fn pieces_fall_asleep() {
    let mut app = app();
    app.world_mut()
        .spawn((ClothCollider::Plane, Transform::from_xyz(0.0, -1.4, 0.0)));
    let cloth = app
        .world_mut()
        .spawn((Cloth::new(9, 9, 0.1), ClothTears::default()))
        .id();
    tick(&mut app, 30);
    cut_at(&mut app, -0.43);
    tick(&mut app, 900);
    assert!(stats(&app, cloth).is_asleep);
    // A cut wakes it.
    cut_at(&mut app, -0.13);
    tick(&mut app, 1);
    assert!(!stats(&app, cloth).is_asleep);
    assert_eq!(surface(&app, cloth).pieces(), 3);
}

/// A flag with a patch sewn to it, of cloth that creases: cut through both, nothing is at fault, and the seam holds what is left
/// of the patch.
#[test]
fn sewn_and_creased_cloth_is_cut() {
    let mut app = app();
    let parts = (
        ClothTears::default(),
        ClothCreasing::LEATHER,
        ClothSelfCollision::default(),
    );
    let flag = app
        .world_mut()
        .spawn((Cloth::new(13, 13, 0.1), parts.clone()))
        .id();
    let before = Transform::from_xyz(0.35, -0.35, 0.01);
    let patch = (Cloth::new(9, 9, 0.0625), Pins::none(), before, parts);
    let patch = app.world_mut().spawn(patch).id();
    let border = Pin::filter(|row, column| row % 8 == 0 || column % 8 == 0);
    let middle = Pin::filter(|row, column| (3..=9).contains(&row) && (3..=9).contains(&column));
    app.world_mut()
        .spawn(ClothSeam::new((flag, middle), (patch, border)));
    tick(&mut app, 60);
    assert!(cut_at(&mut app, -0.63) > 12 + 7);
    tick(&mut app, 120);
    for cloth in [flag, patch] {
        assert_eq!(app.world().get::<ClothFault>(cloth), None);
        assert!(particles(&app, cloth).validate().is_ok());
        assert_eq!(surface(&app, cloth).pieces(), 2);
    }
    // The upper half of the patch hangs where it was, and does not slide off.
    let corner = particles(&app, patch).position(0).expect("it exists") + before.translation;
    assert!((corner.y + 0.35).abs() < 0.1, "{corner}");
}

/// A hand holds on to cloth that tears elsewhere, and a pin by its index holds all parts after its cloth is weighed again.
#[test]
fn hands_and_pins_outlast_tears() {
    let mut app = app();
    let pins = Pins::new([Pin::Index(4), Pin::at_rest(|place| place.y > -1.0e-3)]);
    let cloth = (Cloth::new(9, 9, 0.5), pins, ClothTears::default());
    let cloth = app.world_mut().spawn(cloth).id();
    tick(&mut app, 10);
    let grab = ClothGrab {
        cloth,
        particle: 76,
        ..default()
    };
    let target = particles(&app, cloth).position(76).expect("it exists");
    let hand = app.world_mut().spawn(ClothGrab { target, ..grab }).id();
    tick(&mut app, 5);
    tear(&mut app, cloth, [[4, 13], [13, 22]]);
    tick(&mut app, 5);
    assert!(app.world().get::<ClothGrab>(hand).is_some());
    assert_eq!(particles(&app, cloth).is_pinned(76), Some(true));
    change::<ClothMaterial>(&mut app, cloth, |material| material.areal_density = 0.3);
    tick(&mut app, 2);
    let pinned = particles(&app, cloth)
        .inverse_masses()
        .filter(|w| *w == 0.0);
    assert_eq!(
        pinned.count(),
        9 + 1 + 1,
        "a row, one part more of it, and the hand's"
    );
    // An edge that is none, written after the preparation, stops no tick.
    app.world_mut()
        .entity_mut(cloth)
        .insert(ClothTearing::default());
    app.add_systems(
        FixedUpdate,
        (|mut tears: Query<&mut ClothTears>| {
            tears
                .iter_mut()
                .for_each(|mut tears| assert!(tears.tear([7, 9_999]) || !tears.is_empty()));
        })
        .after(ClothSystems::Integrate)
        .before(ClothSystems::WriteBack),
    );
    tick(&mut app, 3);
    assert!(app.world().get::<ClothFault>(cloth).is_some());
}

/// A balloon that is torn open has burst: it is no fault, and has no pressure.
#[test]
fn a_balloon_bursts() {
    let mut app = app_that_draws(FixedUpdate);
    let ball = Sphere::new(0.3).mesh().ico(6).expect("few vertices");
    let ball = app.world_mut().resource_mut::<Assets<Mesh>>().add(ball);
    let parts = (
        Cloth::mesh(),
        Mesh3d(ball),
        ClothPressure::Gauge(30.0),
        ClothTears::default(),
    );
    let cloth = app.world_mut().spawn(parts).id();
    tick(&mut app, 10);
    assert!(stats(&app, cloth).gauge_pressure > 29.0);
    let face = surface(&app, cloth).triangles()[100];
    let whole = surface(&app, cloth).clone();
    change::<ClothTears>(&mut app, cloth, |tears| {
        assert_eq!(tears.tear_out(&whole, face), 3);
    });
    tick(&mut app, 10);
    assert_eq!(app.world().get::<ClothFault>(cloth), None);
    assert_eq!(surface(&app, cloth).pieces(), 2);
    assert_eq!(stats(&app, cloth).gauge_pressure, 0.0);
}

/// A fine mesh on a cloth that is cut in two loses the triangles across the cut, and no other is stretched.
#[test]
fn a_render_mesh_is_torn_too() {
    let mut app = app_that_draws(FixedUpdate);
    let fine = Plane3d::new(Vec3::Z, Vec2::splat(0.4))
        .mesh()
        .subdivisions(30)
        .build();
    let triangles = fine.indices().expect("indices").len() / 3;
    let fine = app.world_mut().resource_mut::<Assets<Mesh>>().add(fine);
    let parts = (
        Cloth::new(9, 9, 0.1),
        ClothTears::default(),
        Visibility::Hidden,
    );
    let cloth = app.world_mut().spawn(parts).id();
    let place = Transform::from_xyz(0.4, -0.4, 0.0);
    let drawn = app
        .world_mut()
        .spawn((ClothRenderMesh { cloth }, Mesh3d(fine), place))
        .id();
    tick(&mut app, 5);
    assert!(cut_at(&mut app, -0.43) > 7);
    tick(&mut app, 20);
    let handle = app
        .world()
        .get::<Mesh3d>(drawn)
        .expect("it is drawn")
        .0
        .clone();
    let mesh = app
        .world()
        .resource::<Assets<Mesh>>()
        .get(&handle)
        .expect("its mesh");
    let Some(VertexAttributeValues::Float32x3(places)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION)
    else {
        panic!("positions");
    };
    let indices: Vec<usize> = mesh.indices().expect("indices").iter().collect();
    // A row of 31 squares is across the cut.
    let left = indices.len() / 3;
    assert!(
        left < triangles && left >= triangles - 2 * 31 * 2,
        "{left} of {triangles}"
    );
    let side = 0.8 / 31.0;
    for triangle in indices.chunks(3) {
        for at in 0..3 {
            let [a, b] =
                [triangle[at], triangle[(at + 1) % 3]].map(|vertex| Vec3::from(places[vertex]));
            assert!(
                a.distance(b) < 1.2 * std::f32::consts::SQRT_2 * side,
                "{a} {b}"
            );
        }
    }
}
