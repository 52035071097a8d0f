//! Ropes: hung, laid over things, tied to cloth, and what they carry.

use bevy::{
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use bevy_drape::{plugin::ClothBuilt, prelude::*};
use bevy_rapier3d::prelude::{Collider, ColliderMassProperties, RigidBody};

use crate::{fuzz::random::Random, rapier::app_with_rapier, support::*};

/// Air and the material take the swing of what hangs.
fn damped() -> ClothMaterial {
    ClothMaterial {
        damping: 0.5,
        ..ClothMaterial::COTTON
    }
}

/// 0.16 kg for a metre of 2 cm, which stretches by 0.005 % under 1 N.
fn hemp() -> ClothMaterial {
    ClothMaterial {
        areal_density: 8.0,
        stretch_compliance: 1.0e-6,
        ..damped()
    }
}

fn spawn(app: &mut App, rope: impl Bundle) -> Entity {
    let rope = app.world_mut().spawn(rope).id();
    tick(app, 1);
    assert_eq!(app.world().get::<ClothFault>(rope), None);
    rope
}

/// The particles in the world (m).
fn places(app: &App, cloth: Entity) -> Vec<Vec3> {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let all = particles(app, cloth).positions();
    all.map(|place| frame.to_world(place)).collect()
}

fn length(places: &[Vec3]) -> f32 {
    places
        .windows(2)
        .map(|ends| ends[0].distance(ends[1]))
        .sum()
}

/// The radius of curvature a at the lowest point of a chain of some length between supports at one height, and its sag f (m):
/// `L = 2 a sinh(d ⁄ 2a)`, `f = a (cosh(d ⁄ 2a) − 1)`.
fn catenary(length: f64, distance: f64) -> [f32; 2] {
    let (mut low, mut high) = (1.0e-3_f64, 1.0e3_f64);
    for _ in 0..200 {
        let a = (low * high).sqrt();
        // The larger a, the straighter.
        if 2.0 * a * (distance / 2.0 / a).sinh() > length {
            low = a;
        } else {
            high = a;
        }
    }
    let sag = low * ((distance / 2.0 / low).cosh() - 1.0);
    [low, sag].map(|of| of as f32)
}

/// A rope pinned by its first particle hangs straight down. Between two pins it hangs as a catenary does, whatever its resolution:
/// a chain of n straight links is off by (1 ⁄ n)² of the sag, and the arc of its lowest link by h² ⁄ 8a, or by less than 1 ⁄ 500 of the
/// sag. Cotton stretches by less than 10⁻⁴ under this weight.
#[test]
fn it_hangs_as_a_chain_does() {
    for count in [11, 24, 65] {
        let spacing = 2.0 / (count - 1) as f32;
        let mut app = app();
        let free = spawn(&mut app, (Cloth::rope(count, spacing, 0.01), damped()));
        let between = Pins::new([Pin::Index(0), Pin::Index(count as usize - 1)]);
        let rope = (Cloth::rope(count, spacing, 0.01).lying(), between, damped());
        let rope = spawn(&mut app, rope);
        // The supports come closer: 1.2 m for 2 m of rope.
        for step in 1..=64 {
            let x = 2.0 - 0.8 * step as f32 / 64.0;
            change::<ClothParticles>(&mut app, rope, |particles| {
                particles
                    .set_position(count as usize - 1, Vec3::X * x)
                    .expect("it exists");
            });
            tick(&mut app, 1);
        }
        tick(&mut app, 1500);
        let hung = places(&app, free);
        let end = hung[count as usize - 1];
        assert!(end.distance(Vec3::NEG_Y * 2.0) < 1.0e-3, "{count}: {end}");
        let all = places(&app, rope);
        let sag = all.iter().map(|place| -place.y).fold(0.0, f32::max);
        let [radius, truth] = catenary(2.0, 1.2);
        println!("{count} particles: sag {sag} m, catenary {truth} m");
        let lowest = (spacing * spacing / (8.0 * radius)).min(2.0e-3 * truth);
        let tolerance = truth * (1.0 / (count - 1) as f32).powi(2) + lowest;
        assert!(
            (sag - truth).abs() < tolerance,
            "{count}: {sag} m, {truth} m"
        );
        assert!((length(&all) - 2.0).abs() < 2.0e-3, "{count}");
    }
}

/// It bends under its weight as a strip of two columns does that is as wide as the rope is thick: both are one beam. The strip may twist,
/// and does not.
#[test]
fn it_bends_as_a_strip_of_its_width() {
    let material = ClothMaterial {
        bend_rigidity: 4.0e-3,
        damping: 0.5,
        ..ClothMaterial::COTTON
    };
    let drop = |cloth: Cloth, pins: Vec<Pin>, place: Transform, last: usize| {
        let mut app = app();
        let cloth = spawn(&mut app, (cloth, Pins::new(pins), material, place));
        tick(&mut app, 1200);
        places(&app, cloth)[last].y
    };
    let rope = Cloth::rope(17, 0.02, 0.01).lying();
    let held = vec![Pin::Index(0), Pin::Index(1)];
    let rope = drop(rope, held, Transform::default(), 16);
    let strip = Cloth::new(17, 2, 0.02).lying();
    let held = vec![Pin::Column(0), Pin::Column(1)];
    let strip = drop(strip, held, Transform::default(), 16);
    assert!(strip < -0.01, "{strip} m");
    assert!(
        (rope - strip).abs() < 0.01 * strip.abs(),
        "{rope} m, {strip} m"
    );
}

/// It lies at its radius on a ball that is large or small for its spacing, also where both are scaled, and hangs down on both sides.
#[test]
fn it_hangs_over_a_ball() {
    for (ball, scale) in [(0.4, 1.0), (0.05, 1.0), (0.2, 2.0)] {
        let mut app = app();
        let place = Transform::from_xyz(0.0, ball + 0.05, 0.0).with_scale(Vec3::splat(scale));
        let rope = Cloth::rope(61, 0.025 / scale, 0.02 / scale);
        let rope = spawn(&mut app, (rope.lying().centred(), Pins::none(), place));
        app.world_mut().spawn(ClothCollider::ball(ball));
        tick(&mut app, 40);
        let distances = places(&app, rope).into_iter().map(Vec3::length);
        let nearest = distances.fold(f32::MAX, f32::min);
        // It may bounce off by a little.
        let reach = ball + 0.02;
        assert!(
            nearest > reach - 5.0e-4 && nearest < reach + 5.0e-3,
            "{ball}: {nearest} m"
        );
    }
}

/// Tied by its ends to the corners of a sail, two ropes hold it: a rope's last particle is where the corner is.
#[test]
fn it_ties_a_sail_by_its_corners() {
    let mut app = app();
    let sail = (
        Cloth::new(21, 21, 0.05),
        Pins::none(),
        damped(),
        Transform::from_xyz(0.0, -0.5, 0.0),
    );
    let sail = spawn(&mut app, sail);
    for (x, corner) in [(0.0, Corner::TopLeft), (1.0, Corner::TopRight)] {
        let place = Transform::from_xyz(x, 0.0, 0.0);
        let rope = spawn(&mut app, (Cloth::rope(11, 0.05, 0.005), hemp(), place));
        let seam = ClothSeam::new((rope, Pin::Index(10)), (sail, Pin::Corner(corner)));
        app.world_mut().spawn(seam);
    }
    tick(&mut app, 640);
    let own = places(&app, sail);
    let mut ropes = app
        .world_mut()
        .query_filtered::<(Entity, &Cloth), Without<ClothSeam>>();
    let is_rope = |cloth: &Cloth| cloth.shape.is_rope();
    let ropes: Vec<Entity> = ropes
        .iter(app.world())
        .filter_map(|(entity, cloth)| is_rope(cloth).then_some(entity))
        .collect();
    assert_eq!(ropes.len(), 2);
    for (rope, corner) in ropes.into_iter().zip([own[0], own[20]]) {
        let all = places(&app, rope);
        let end = all[10];
        assert!(end.distance(corner) < 2.0e-3, "{end} {corner}");
        assert!(length(&all) < 0.5 * 1.02, "{}", length(&all));
    }
    assert!(own.iter().all(|place| place.y < 0.0 && place.y > -1.7));
}

/// Two slings hold a plank that rapier moves: it comes to rest in them, level, above where the ropes are when they are taut.
#[test]
fn two_of_them_hold_a_plank() {
    let mut app = app_with_rapier();
    for x in [-0.3, 0.3] {
        let ends = Pins::new([Pin::Index(0), Pin::Index(50)]);
        let rope = (
            Cloth::rope(51, 0.02, 0.01),
            ends,
            hemp(),
            ClothSettings::substeps(60),
            Transform::from_xyz(x, 1.0, 0.0),
        );
        let rope = spawn(&mut app, rope);
        // Down, across below the plank, and up.
        change::<ClothParticles>(&mut app, rope, |particles| {
            for index in 0..51 {
                let along = 0.02 * index as f32;
                let place = Vec3::new(
                    0.0,
                    -along.min(1.0 - along).min(0.35),
                    (along - 0.35).clamp(0.0, 0.3) - 0.15,
                );
                particles.set_position(index, place).expect("it exists");
            }
        });
    }
    let plank = (
        RigidBody::Dynamic,
        Collider::cuboid(0.45, 0.02, 0.14),
        ColliderMassProperties::Mass(2.0),
        RapierClothCollider,
        ClothPushBack,
        Transform::from_xyz(0.0, 0.7, 0.0),
    );
    let plank = app.world_mut().spawn(plank).id();
    tick(&mut app, 640);
    let place = app.world().get::<Transform>(plank).expect("a place");
    let up = place.rotation * Vec3::Y;
    println!("the plank is at {}, up is {up}", place.translation);
    // Less than the rope's radius: it does not sink into the ropes.
    assert!(
        (place.translation.y - 0.68).abs() < 0.01,
        "{}",
        place.translation
    );
    assert!(up.y > 0.99, "{up}");
}

/// A rope that falls across a cloth with layers lies on it: no segment passes through a triangle.
#[test]
fn it_lies_on_cloth_with_layers() {
    for is_turned in [false, true] {
        let mut app = app();
        let layers = ClothSelfCollision::default();
        let sheet = Cloth::new(17, 17, 0.05).lying().centred();
        let corners = [
            Corner::TopLeft,
            Corner::TopRight,
            Corner::BottomLeft,
            Corner::BottomRight,
        ];
        let pins = Pins::new(corners.map(Pin::Corner));
        let sheet = spawn(&mut app, (sheet, pins, layers));
        let turn = if is_turned { 0.6 } else { 0.0 };
        let place = Transform::from_xyz(0.03, 0.1, 0.02).with_rotation(Quat::from_rotation_y(turn));
        let rope = Cloth::rope(31, 0.02, 0.01).lying().centred();
        let rope = spawn(&mut app, (rope, Pins::none(), layers, damped(), place));
        let surface = app
            .world()
            .get::<ClothBuilt>(sheet)
            .expect("built")
            .surface()
            .clone();
        for _ in 0..320 {
            tick(&mut app, 1);
            let (own, others) = (places(&app, rope), places(&app, sheet));
            for ends in own.windows(2) {
                for face in surface.triangles() {
                    let corners = face.map(|corner| others[corner as usize]);
                    assert!(
                        !crosses([ends[0], ends[1]], corners),
                        "{ends:?}, {corners:?}"
                    );
                }
            }
        }
        let lowest = places(&app, rope)
            .iter()
            .map(|place| place.y)
            .fold(f32::MAX, f32::min);
        assert!(lowest > -0.3, "{lowest} m");
    }
}

/// Whether a segment passes through a triangle, by signed volumes in f64.
fn crosses(ends: [Vec3; 2], corners: [Vec3; 3]) -> bool {
    let [p, q] = ends.map(Vec3::as_dvec3);
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let side = |at: bevy::math::DVec3| (b - a).cross(c - a).dot(at - a);
    let past = |from: bevy::math::DVec3, to: bevy::math::DVec3| (q - p).cross(from - p).dot(to - p);
    let around = [past(a, b), past(b, c), past(c, a)];
    let is_around = around.iter().all(|v| *v > 0.0) || around.iter().all(|v| *v < 0.0);
    side(p) * side(q) < 0.0 && is_around
}

/// The distance of two segments of ropes that do not cross, at eleven points of the first (m).
fn between([a, b]: [Vec3; 2], [c, d]: [Vec3; 2]) -> f32 {
    let along = d - c;
    let points = (0..=10).map(|part| a.lerp(b, part as f32 / 10.0));
    let apart = points.map(|point| {
        let part = (point - c).dot(along) / along.length_squared();
        point.distance(c + along * part.clamp(0.0, 1.0))
    });
    apart.fold(f32::INFINITY, f32::min)
}

/// A loop of rope along a path, whose strands begin one radius apart. The lower one is pinned, and the upper one lies on it. They move
/// apart to the rope's thickness, and stay there. Layers at rest may be closer by 4 %. While they are held between tests, they may come
/// closer by half of 8 %.
#[test]
fn strands_of_a_path_keep_their_thickness() {
    let radius = 0.01;
    let thickness = 2.0 * radius;
    let path = [
        [0.0, 0.0],
        [0.5, 0.0],
        [0.65, -0.1],
        [0.75, 0.0],
        [0.65, 0.1],
        [0.5, radius],
        [0.0, radius],
        [-0.1, 0.1],
    ];
    let path = path.map(|[x, y]| Vec3::new(x, y, 0.0));
    let rope = Cloth::rope_along(path, 0.05, radius);
    let surface = rope.surface(Vec3::ONE).expect("a rope");
    let rest = surface.rest_positions();
    let is_of = |height: f32| {
        move |place: Vec3| (place.y - height).abs() < 1.0e-5 && (-1.0e-5..0.501).contains(&place.x)
    };
    // The segments of a strand.
    let strand = |height: f32| -> Vec<usize> {
        let both = |at: &usize| rest[*at..at + 2].iter().all(|place| is_of(height)(*place));
        (0..rest.len() - 1).filter(both).collect()
    };
    let (lower, upper) = (strand(0.0), strand(radius));
    assert!(lower.len() > 7 && upper.len() > 7, "{lower:?} {upper:?}");
    let turn = Pin::Near {
        point: path[3],
        radius: 0.03,
    };
    let pins = Pins::new([Pin::at_rest(is_of(0.0)), turn, Pin::Index(rest.len() - 1)]);
    let mut app = app();
    let layers = ClothSelfCollision::of_thickness(thickness);
    let rope = spawn(&mut app, (rope, pins, layers, hemp()));
    let nearest = |app: &App| {
        let places = places(app, rope);
        let segment = |at: &usize| [places[*at], places[at + 1]];
        let pairs = upper.iter().flat_map(|a| lower.iter().map(move |b| [a, b]));
        pairs
            .map(|pair| {
                let [a, b] = pair.map(segment);
                between(a, b)
            })
            .fold(f32::INFINITY, f32::min)
    };
    tick(&mut app, 64);
    for _ in 0..64 {
        tick(&mut app, 1);
        let apart = nearest(&app);
        assert!(apart > 0.92 * thickness, "{apart} m");
        assert!(apart < 1.05 * thickness, "{apart} m: it lies there");
    }
    assert_eq!(app.world().get::<ClothFault>(rope), None);
}

/// Neighbours along a rope do not push each other, though it turns by right angles. Segments without a common particle are a spacing
/// apart, twice the largest thickness, of which this is nearly all. Nothing else moves this rope.
#[test]
fn neighbours_along_a_rope_are_left_alone() {
    let spacing = 0.05;
    let path = [
        [0, 0],
        [1, 0],
        [1, 1],
        [0, 1],
        [0, 2],
        [1, 2],
        [2, 2],
        [2, 1],
        [2, 0],
    ];
    let path = path.map(|[x, y]| spacing * Vec3::new(x as f32, y as f32, 0.0));
    let limp = ClothMaterial {
        bend_rigidity: 0.0,
        ..hemp()
    };
    let mut app = app();
    app.insert_resource(ClothGravity(Vec3::ZERO));
    let layers = ClothSelfCollision::of_thickness(0.49 * spacing);
    let rope = (
        Cloth::rope_along(path, spacing, 0.01),
        Pins::none(),
        limp,
        layers,
    );
    let rope = spawn(&mut app, rope);
    tick(&mut app, 64);
    let now = places(&app, rope);
    assert_eq!(now.len(), path.len());
    for (now, was) in now.iter().zip(path) {
        // Rounding of some hundred sub-steps, at 0.1 m.
        assert!(now.distance(was) < 1.0e-5, "{now} {was}");
    }
}

/// It keeps its place when its resolution changes, and is picked, taken and let go.
#[test]
fn it_is_refined_and_taken() {
    let mut app = app();
    let rope = spawn(&mut app, (Cloth::rope(11, 0.1, 0.01), damped()));
    tick(&mut app, 600);
    let before = places(&app, rope)[10];
    app.world_mut()
        .entity_mut(rope)
        .insert(Cloth::rope(41, 0.025, 0.01));
    tick(&mut app, 1);
    let all = places(&app, rope);
    assert_eq!(all.len(), 41);
    assert!(all[40].distance(before) < 1.0e-3);
    let hit = app
        .world_mut()
        .run_system_cached(|mut rays: ClothRayCast| {
            let at = |x| Ray3d::new(Vec3::new(x, -0.51, 3.0), Dir3::NEG_Z);
            assert_eq!(rays.cast(at(0.02), 10.0), None);
            rays.cast(at(0.009), 10.0)
        })
        .expect("a system")
        .expect("the rope is there");
    assert_eq!((hit.cloth, hit.particle), (rope, 20));
    let hand = app.world_mut().spawn(hit.grab()).id();
    tick(&mut app, 2);
    change::<ClothGrab>(&mut app, hand, |grab| grab.target += Vec3::X * 0.3);
    tick(&mut app, 200);
    let held = places(&app, rope)[20];
    assert!(held.x > 0.25, "{held}");
    app.world_mut().despawn(hand);
    tick(&mut app, 1200);
    let held = places(&app, rope)[20];
    assert!(held.x.abs() < 0.02, "{held}");
}

/// Along a path with a sharp turn, it hangs between its ends as a chain does: the path is forgotten.
#[test]
fn one_along_a_path_hangs_as_a_chain_does() {
    let points = [Vec3::ZERO, Vec3::new(0.6, 0.8, 0.0), Vec3::X * 1.2];
    let rope = Cloth::rope_along(points, 0.03, 0.01);
    let between = Pins::new([Pin::at_rest(|place| place.y < 1.0e-3)]);
    let mut app = app();
    let rope = spawn(&mut app, (rope, between, damped()));
    let begin = places(&app, rope);
    assert_eq!(begin.len(), 68);
    assert!(begin.iter().any(|place| place.y > 0.75), "{begin:?}");
    tick(&mut app, 1500);
    let all = places(&app, rope);
    let sag = all.iter().map(|place| -place.y).fold(0.0, f32::max);
    let [radius, truth] = catenary(2.0, 1.2);
    // As in the test above, and the corner may cut off half of a spacing.
    let spacing = 2.0 / 67.0_f32;
    let lowest = (spacing * spacing / (8.0 * radius)).min(2.0e-3 * truth);
    let tolerance = truth * (1.0 / 67.0_f32).powi(2) + lowest;
    assert!((sag - truth).abs() < tolerance, "{sag} m, {truth} m");
    assert!((length(&all) - 2.0).abs() < 2.0e-3);
}

/// An upright path falls over. One with another path is built anew, even of the same length; one with another spacing keeps its place.
#[test]
fn one_along_a_path_falls_over_and_changes() {
    let upright = [Vec3::ZERO, Vec3::Y];
    let mut app = app();
    let rope = spawn(&mut app, (Cloth::rope_along(upright, 0.05, 0.01), damped()));
    let end = |app: &App| *places(app, rope).last().expect("an end");
    // Its last part is folded up for long.
    tick(&mut app, 2100);
    let hung = end(&app);
    assert!(hung.distance(Vec3::NEG_Y) < 0.01, "{hung}");
    let change_to = |app: &mut App, path: [Vec3; 2], spacing| {
        let other = Cloth::rope_along(path, spacing, 0.01);
        app.world_mut().entity_mut(rope).insert(other);
        tick(app, 1);
    };
    change_to(&mut app, upright, 0.025);
    assert_eq!(places(&app, rope).len(), 41);
    assert!(end(&app).distance(hung) < 1.0e-3);
    change_to(&mut app, [Vec3::ZERO, Vec3::Z], 0.025);
    assert!(end(&app).distance(Vec3::Z) < 0.01);
    // Mirrored, it is as long as before.
    change::<Transform>(&mut app, rope, |place| place.scale.z = -1.0);
    tick(&mut app, 30);
    let other = Cloth::rope_along([Vec3::ZERO, Vec3::Z], 0.05, 0.01);
    app.world_mut().entity_mut(rope).insert(other);
    tick(&mut app, 1);
    assert!(end(&app).distance(-Vec3::Z) < 0.01);
}

/// A path that doubles back, so that neighbours begin in one place: it unfolds and hangs down. A flat one stands on its fold, like a pole.
#[test]
fn one_that_doubles_back_unfolds() {
    let path = [Vec3::ZERO, Vec3::NEG_Y, Vec3::ZERO];
    for (parts, is_flat) in [(15.0, false), (15.0, true), (16.0, false)] {
        let mut app = app();
        let rope = Cloth::rope_along(path, 2.0 / parts, 0.01);
        let rope = if is_flat { rope.flat() } else { rope };
        let rope = spawn(&mut app, (rope, damped()));
        let mut longest = 0.0_f32;
        for _ in 0..1200 {
            tick(&mut app, 1);
            longest = longest.max(length(&places(&app, rope)) / 2.0 - 1.0);
        }
        assert_eq!(app.world().get::<ClothFault>(rope), None);
        assert!(longest < 0.1, "{longest}");
        let end = *places(&app, rope).last().expect("an end");
        let hangs = end.distance(2.0 * Vec3::NEG_Y) < 0.01;
        assert!(hangs || is_flat, "{parts}: {end}");
    }
}

/// The edges of a mesh without faces, in any order and direction. It begins at the end with the lower index.
#[test]
fn edges_of_a_mesh_are_a_rope() {
    let place = |vertex: usize| Vec3::new(0.1 * vertex as f32, (vertex % 2) as f32, 0.0);
    // Where each vertex of the mesh is along the chain.
    let order = [4, 0, 6, 2, 5, 1, 3];
    let mesh = |topology, indices: &[u32]| {
        let places: Vec<Vec3> = order.map(place).to_vec();
        Mesh::new(topology, default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, places)
            .with_inserted_indices(Indices::U32(indices.to_vec()))
    };
    let vertex = |at: usize| {
        order
            .iter()
            .position(|of| *of == at)
            .expect("each is there") as u32
    };
    let chain: Vec<u32> = (0..7).map(vertex).collect();
    let list: Vec<u32> = [2, 5, 0, 3, 1, 4]
        .into_iter()
        .flat_map(|at| [chain[at + at % 2], chain[at + 1 - at % 2]])
        .collect();
    let reversed: Vec<u32> = chain.iter().rev().copied().collect();
    let points = |mesh: &Mesh| match Cloth::rope_of(mesh, 0.1, 0.01).map(|rope| rope.shape) {
        Ok(ClothShape::RopePath(path)) => Ok(path.points),
        Ok(other) => panic!("{other:?}"),
        Err(error) => Err(error),
    };
    let expected: Vec<Vec3> = (0..7).map(place).collect();
    for mesh in [
        mesh(PrimitiveTopology::LineList, &list),
        mesh(PrimitiveTopology::LineStrip, &chain),
        mesh(PrimitiveTopology::LineStrip, &reversed),
    ] {
        assert_eq!(points(&mesh).expect("a chain"), expected);
    }
    let refused = |indices: &[u32]| points(&mesh(PrimitiveTopology::LineList, indices));
    let no_chain = |vertex, edges| Err(RopeError::NotAChain { vertex, edges });
    // A branch, a ring, a chain beside a ring, a vertex without edges, one that does not exist, and no edges.
    assert_eq!(
        refused(&[0, 1, 1, 2, 1, 3, 3, 4, 4, 5, 5, 6]),
        no_chain(1, 3)
    );
    assert_eq!(
        refused(&[0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 0]),
        no_chain(0, 2)
    );
    assert_eq!(
        refused(&[0, 1, 1, 2, 3, 4, 4, 5, 5, 6, 6, 3]),
        no_chain(3, 2)
    );
    assert_eq!(refused(&[0, 1, 1, 2, 2, 3, 3, 4, 4, 5]), no_chain(6, 0));
    assert_eq!(
        refused(&[0, 1, 1, 0, 2, 3, 3, 4, 4, 5, 5, 6]),
        no_chain(0, 2)
    );
    assert_eq!(
        refused(&[0, 0, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6]),
        no_chain(0, 2)
    );
    let none_such = RopeError::NoSuchVertex {
        vertex: 9,
        vertices: 7,
    };
    assert_eq!(refused(&[0, 1, 1, 9]), Err(none_such));
    assert_eq!(refused(&[]), no_chain(0, 0));
    assert_eq!(refused(&[0, 1, 1]), Err(RopeError::Unpaired { indices: 3 }));
    let faces = points(&mesh(PrimitiveTopology::TriangleList, &[0, 1, 2]));
    assert!(matches!(faces, Err(RopeError::Topology { .. })));
    let empty = Mesh::new(PrimitiveTopology::LineList, default());
    assert_eq!(
        points(&empty),
        Err(RopeError::Mesh(MeshError::WithoutPositions))
    );
    let none: Vec<Vec3> = Vec::new();
    let none = empty.with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, none);
    assert_eq!(points(&none), Ok(Vec::new()));
}

/// A bad rope gets a fault that names the value, and nothing else stops.
#[test]
fn a_bad_rope_is_a_fault() {
    let mut app = app();
    let other = spawn(&mut app, Cloth::rope(8, 0.1, 0.01));
    for wrong in [
        Cloth::rope(1, 0.1, 0.01),
        Cloth::rope(8, 0.0, 0.01),
        Cloth::rope(8, 0.1, f32::NAN),
        Cloth::rope_along([], 0.1, 0.01),
        Cloth::rope_along([Vec3::ZERO, Vec3::X], 0.0, 0.01),
    ] {
        let rope = app.world_mut().spawn(wrong).id();
        tick(&mut app, 2);
        let fault = app.world().get::<ClothFault>(rope).expect("a fault");
        let text = fault.error.to_string();
        assert!(text.contains("rope"), "{text}");
    }
    assert_eq!(app.world().get::<ClothFault>(other), None);
}

/// A hundred ropes of any size, held anywhere, in wind, over a ball, with layers or without: all stay finite, and none is longer than it was by
/// more than a tenth.
#[test]
fn random_ropes_hold() {
    let mut random = Random(31);
    let mut longest = 0.0_f32;
    let mut app = app();
    app.insert_resource(ClothWind {
        velocity: Vec3::new(4.0, 0.0, 1.0),
        ..default()
    });
    let mut all = Vec::new();
    for number in 0..100 {
        let count = 2 + random.below(70) as u32;
        let (long, radius) = (0.3 + 2.0 * random.part(), 0.002 + 0.03 * random.part());
        let material = ClothMaterial {
            areal_density: 0.1 + 8.0 * random.part(),
            bend_rigidity: if random.one_in(2) {
                0.0
            } else {
                0.02 * random.part()
            },
            ..ClothMaterial::COTTON
        };
        let pins = match random.below(3) {
            0 => Pins::default(),
            1 => Pins::new([Pin::Index(0), Pin::Index(count as usize - 1)]),
            _ => Pins::none(),
        };
        let turn =
            Quat::from_rotation_z(6.0 * random.part()) * Quat::from_rotation_x(3.0 * random.part());
        let place = Vec3::new(5.0 * (number % 10) as f32, 0.0, 5.0 * (number / 10) as f32);
        let rope = Cloth::rope(count, long / (count - 1) as f32, radius);
        let rope = if random.one_in(2) { rope.lying() } else { rope };
        let place = Transform::from_translation(place).with_rotation(turn);
        let mut rope = app.world_mut().spawn((rope, pins, material, place));
        if random.one_in(3) {
            let spacing = long / (count - 1) as f32;
            rope.insert(ClothSelfCollision::of_thickness(spacing.min(0.02) / 4.0));
        }
        let rope = rope.id();
        let ball = place.translation + Vec3::new(0.2, -0.6, 0.1);
        app.world_mut()
            .spawn((ClothCollider::ball(0.3), Transform::from_translation(ball)));
        all.push((rope, long, ball, 0.3 + radius));
    }
    for _ in 0..240 {
        tick(&mut app, 1);
        for (rope, long, ..) in &all {
            let own = places(&app, *rope);
            assert!(own.iter().all(|place| place.is_finite()));
            longest = longest.max(length(&own) / long - 1.0);
        }
    }
    println!(
        "of 100 random ropes the longest was stretched by {:.2} %",
        100.0 * longest
    );
    assert!(longest < 0.1, "{longest}");
    let mut deepest = 0.0_f32;
    for (rope, _, ball, reach) in all {
        for (place, inverse_mass) in places(&app, rope)
            .into_iter()
            .zip(particles(&app, rope).inverse_masses())
        {
            if inverse_mass > 0.0 {
                deepest = deepest.max(reach - place.distance(ball));
            }
        }
        assert_eq!(app.world().get::<ClothFault>(rope), None);
    }
    println!("and the deepest in a ball by {:.3} mm", 1.0e3 * deepest);
    // As what hangs over a ball.
    assert!(deepest < 5.0e-4, "{deepest} m");
}
