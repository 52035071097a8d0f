//! How a point lies to shapes that are more than a formula, against `f64`.

use bevy::math::{DVec2, DVec3, Isometry3d, Quat, Vec3};
use proptest::prelude::*;

use super::{
    ONLY, all_of, build, deepest_at, loose,
    random::{Random, cases},
};
use crate::{
    cloth::{ClothError, MeshError, ShapeError},
    contact::{
        candidates::{ContactSettings, NarrowPhase},
        colliders::{ClothCollider, ColliderShape},
    },
    solver::SubStep,
};

/// Of lengths up to 6 m: some fifty roundings of half an ε each in parry's projections, 50 × 6e-8 × 6 m.
const ROUNDING: f64 = 2.0e-5;

fn shape(collider: &ClothCollider) -> ColliderShape {
    collider.scaled(Vec3::ONE).expect("a valid collider")
}

fn distance(shape: &ColliderShape, point: Vec3) -> f64 {
    f64::from(shape.nearest(Isometry3d::IDENTITY, point).distance)
}

/// The signed distance from a convex polygon, its corners counted anticlockwise.
fn from_polygon(corners: &[DVec2], point: DVec2) -> f64 {
    let (mut inside, mut outside) = (f64::NEG_INFINITY, f64::INFINITY);
    for (index, &from) in corners.iter().enumerate() {
        let to = corners[(index + 1) % corners.len()];
        let along = to - from;
        let beyond = (point - from).dot(DVec2::new(along.y, -along.x)) / along.length();
        inside = inside.max(beyond);
        let part = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        outside = outside.min(point.distance(from + along * part));
    }
    if inside <= 0.0 { inside } else { outside }
}

/// The signed distance from the convex hull of a few points: its faces are the planes of three that leave all the others
/// behind.
pub fn from_hull(points: &[Vec3], point: Vec3) -> f64 {
    let points: Vec<DVec3> = points.iter().map(|point| point.as_dvec3()).collect();
    let point = point.as_dvec3();
    let (mut inside, mut outside) = (f64::NEG_INFINITY, f64::INFINITY);
    for i in 0..points.len() {
        for j in 0..points.len() {
            for k in 0..points.len() {
                let [a, b, c] = [points[i], points[j], points[k]];
                let normal = (b - a).cross(c - a).normalize_or_zero();
                let is_face = normal != DVec3::ZERO
                    && points.iter().all(|other| normal.dot(*other - a) < 1.0e-9);
                if !is_face {
                    continue;
                }
                inside = inside.max(normal.dot(point - a));
                outside = outside.min(from_triangle([a, b, c], point));
            }
        }
    }
    if inside <= 0.0 { inside } else { outside }
}

/// How far a point is from a triangle.
fn from_triangle([a, b, c]: [DVec3; 3], point: DVec3) -> f64 {
    let normal = (b - a).cross(c - a).normalize();
    let is_above = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|&(from, to)| (to - from).cross(point - from).dot(normal) >= 0.0);
    if is_above {
        return normal.dot(point - a).abs();
    }
    let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| {
        let along = to - from;
        let part = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        point.distance(from + along * part)
    });
    edges.into_iter().fold(f64::INFINITY, f64::min)
}

fn ring(point: Vec3) -> DVec2 {
    let point = point.as_dvec3();
    DVec2::new(point.x.hypot(point.z), point.y)
}

proptest! {
    #![proptest_config(cases(400))]

    /// A cylinder is a rectangle and a cone a triangle, turned around the axis.
    #[test]
    fn cylinders_and_cones_are_turned_polygons(seed in any::<u64>()) {
        let mut random = Random(seed);
        let (r, h) = (random.between(0.1, 1.5), random.between(0.1, 3.0));
        let (cylinder, cone) = (shape(&ClothCollider::cylinder(r, h)), shape(&ClothCollider::cone(r, h)));
        let (r, h) = (f64::from(r), f64::from(h) / 2.0);
        let base = [DVec2::new(-r, -h), DVec2::new(r, -h)];
        let rectangle = [base[0], base[1], DVec2::new(r, h), DVec2::new(-r, h)];
        let triangle = [base[0], base[1], DVec2::new(0.0, h)];
        for _ in 0..32 {
            let point = random.within(2.5);
            let off = distance(&cylinder, point) - from_polygon(&rectangle, ring(point));
            prop_assert!(off.abs() < ROUNDING, "cylinder {point}: {off}");
            let off = distance(&cone, point) - from_polygon(&triangle, ring(point));
            prop_assert!(off.abs() < ROUNDING, "cone {point}: {off}");
        }
    }

    /// A hull, and the mesh of its triangles whichever way they are turned, keep the distance from the faces of the hull, and the
    /// normal leads to the surface.
    #[test]
    fn hulls_keep_the_distance_of_their_faces(seed in any::<u64>()) {
        let mut random = Random(seed);
        let points: Vec<Vec3> = (0..8).map(|_| random.within(1.5)).collect();
        let hull = shape(&ClothCollider::convex_hull(points.clone()));
        for _ in 0..12 {
            let point = random.within(2.5);
            let exact = from_hull(&points, point);
            let off = distance(&hull, point) - exact;
            prop_assert!(off.abs() < ROUNDING, "{point}: {off} of {exact}");
            let nearest = hull.nearest(Isometry3d::IDENTITY, point);
            let surface = point - nearest.normal * nearest.distance;
            prop_assert!(from_hull(&points, surface).abs() < 2.0 * ROUNDING, "{point}");
        }
    }

    /// Under any scale, mirrored too, a hull is that of the scaled points.
    #[test]
    fn scaled_hulls_are_hulls_of_scaled_points(seed in any::<u64>()) {
        let mut random = Random(seed);
        let points: Vec<Vec3> = (0..6).map(|_| random.within(1.0)).collect();
        let sign = |random: &mut Random| if random.part() < 0.5 { -1.0 } else { 1.0 };
        let scale = Vec3::from_array([(); 3].map(|()| sign(&mut random) * random.between(0.3, 2.0)));
        let collider = ClothCollider::convex_hull(points.clone());
        // The scale asked for first is the one that is kept.
        let _ = collider.scaled(Vec3::ONE);
        let hull = collider.scaled(scale).expect("a valid hull");
        let scaled: Vec<Vec3> = points.iter().map(|&point| point * scale).collect();
        for _ in 0..8 {
            let point = random.within(2.0);
            let off = distance(&hull, point) - from_hull(&scaled, point);
            prop_assert!(off.abs() < ROUNDING, "{point}: {off}");
        }
    }

    /// Whatever the shape, its motion, its turn and the particles': none is inside when the sub-step ends.
    #[test]
    fn none_is_left_inside_of_a_geometry(seed in any::<u64>(), is_moving in any::<bool>()) {
        let mut random = Random(seed);
        let collider = random.geometry();
        let (travel, turn) = if is_moving { (4.0, 1.5) } else { (0.0, 0.0) };
        let collider = random.moving(shape(&collider), 1.0, travel, turn);
        let centre = Vec3::from(collider.from.translation);
        let positions: Vec<Vec3> = (0..24).map(|_| centre + random.within(1.5)).collect();
        let displacements: Vec<Vec3> =
            (0..24).map(|_| random.within(1.0) * random.part()).collect();
        let mut particles = loose(&positions, &displacements);
        let (surface, _) = build(24, 2, 0.1);
        let settings = ContactSettings {
            particle_radius: random.between(0.01, 0.1),
            narrow_phase: NarrowPhase::Particles,
            ..ContactSettings::default()
        };
        let mut detection = all_of(std::slice::from_ref(&collider), &settings, &surface, &particles);
        let substep = SubStep {
            index: 1,
            count: 3,
            ..ONLY
        };
        detection.respond(&mut particles, &settings, substep, |_| {});
        let deepest = deepest_at(&particles, &collider, substep.end(), settings.particle_radius);
        // Of lengths up to 12 m.
        prop_assert!(deepest < 4.0 * ROUNDING, "{collider:?} {deepest}");
    }
}

/// A cube of twelve triangles, two of each face, as `convex_hull` has it: the same by points and by triangles, whether those
/// are turned outwards or inwards.
#[test]
fn a_closed_mesh_has_an_inside_whichever_way_it_is_turned() {
    let corners: Vec<Vec3> = (0..8)
        .map(|corner| {
            Vec3::new(
                f32::from(corner & 1 != 0),
                f32::from(corner & 2 != 0),
                f32::from(corner & 4 != 0),
            )
        })
        .collect();
    let faces = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    let outwards = faces.map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).concat();
    let inwards: Vec<[u32; 3]> = outwards.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    let mut random = Random(3);
    for triangles in [outwards, inwards] {
        let cube = shape(&ClothCollider::trimesh(corners.clone(), triangles.clone()));
        let ColliderShape::Geometry(geometry) = &cube else {
            panic!("a geometry");
        };
        assert!(!geometry.is_two_sided());
        assert_eq!(geometry.triangles(), 12);
        for _ in 0..500 {
            let point = random.within(2.0);
            let off = distance(&cube, point) - from_hull(&corners, point);
            assert!(off.abs() < ROUNDING, "{point}: {off}");
        }
        // Without one face it encloses nothing, and has two sides.
        let open = shape(&ClothCollider::trimesh(
            corners.clone(),
            triangles[2..].to_vec(),
        ));
        assert!(distance(&open, Vec3::splat(0.5)) > 0.4);
    }
}

/// Below a height field all is inside, as deep as the slope is near; beside it nothing is.
#[test]
fn ground_is_solid_and_ends_at_its_rim() {
    // A slope of 0.5 along x, from −1 to 1 m.
    let heights: Vec<f32> = (0..15)
        .map(|index| (index % 5) as f32 * 0.25 - 0.5)
        .collect();
    let ground = shape(&ClothCollider::heightfield(
        heights,
        5,
        Vec3::new(2.0, 1.0, 4.0),
    ));
    let cosine = 1.0 / 1.25_f64.sqrt();
    for (point, above) in [
        (Vec3::new(0.0, 0.3, 0.5), 0.3),
        (Vec3::new(0.5, 0.2, -1.0), -0.05),
        (Vec3::new(-0.2, -0.4, 0.3), -0.3),
    ] {
        let off = distance(&ground, point) - above * cosine;
        assert!(off.abs() < ROUNDING, "{point}: {off}");
    }
    assert!(distance(&ground, Vec3::new(1.5, -1.0, 0.0)) > 0.5);
    // Mirrored, the slope goes down.
    let mirrored = ClothCollider::heightfield(vec![-0.5, 0.5, -0.5, 0.5], 2, Vec3::ONE)
        .scaled(Vec3::new(2.0, -1.0, 2.0))
        .expect("valid ground");
    assert!(distance(&mirrored, Vec3::new(0.5, 0.0, 0.0)) > 0.1);
    assert!(distance(&mirrored, Vec3::new(-0.5, 0.0, 0.0)) < -0.1);
}

/// A sheet is 1 mm thick, from either side.
#[test]
fn a_sheet_has_two_sides() {
    let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z];
    let sheet = shape(&ClothCollider::trimesh(square, [[0, 1, 2], [0, 2, 3]]));
    for height in [0.2_f32, -0.2, 0.0011, -0.0011] {
        let point = Vec3::new(0.6, height, 0.3);
        let nearest = sheet.nearest(Isometry3d::IDENTITY, point);
        assert!(
            (nearest.distance - (height.abs() - 0.0005)).abs() < 1.0e-6,
            "{height}"
        );
        assert!(nearest.normal.dot(Vec3::Y * height.signum()) > 0.999);
    }
}

/// A compound is as near as its nearest part, where that is; its parts may be compounds.
#[test]
fn a_compound_is_its_parts() {
    let turned = Quat::from_rotation_z(0.7);
    let place = Isometry3d::new(Vec3::new(1.0, 0.5, 0.0), turned);
    let cone = Isometry3d::from_xyz(-1.0, 0.0, 0.5);
    let inner = ClothCollider::compound([(place, ClothCollider::cuboid(0.4, 0.6, 0.8))]);
    let parts = [
        (Isometry3d::IDENTITY, inner),
        (cone, ClothCollider::cone(0.4, 0.8)),
        (
            Isometry3d::from_xyz(0.0, -1.0, 0.0),
            ClothCollider::ball(0.3),
        ),
    ];
    let whole = shape(&ClothCollider::compound(parts));
    let single = |collider: ClothCollider, pose: Isometry3d, point| {
        f64::from(shape(&collider).nearest(pose, point).distance)
    };
    let mut random = Random(11);
    for _ in 0..2_000 {
        let point = random.within(2.0);
        let each = [
            single(ClothCollider::cuboid(0.4, 0.6, 0.8), place, point),
            single(ClothCollider::cone(0.4, 0.8), cone, point),
            single(
                ClothCollider::ball(0.3),
                Isometry3d::from_xyz(0.0, -1.0, 0.0),
                point,
            ),
        ];
        let least = each.into_iter().fold(f64::INFINITY, f64::min);
        let off = distance(&whole, point) - least;
        assert!(off.abs() < ROUNDING, "{point}: {off}");
    }
}

/// That a surface is probably near makes the nearest point no other: of round parts and meshes together, beside a height
/// field and above it, and where nothing is known yet.
#[test]
fn a_hint_changes_nothing() {
    let board = || ClothCollider::trimesh(vec![Vec3::ZERO, Vec3::X, Vec3::Z], vec![[0, 1, 2]]);
    let field = || ClothCollider::heightfield(vec![0.3; 16], 4, Vec3::new(1.0, 1.0, 1.0));
    let beside = |x: f32, part: ClothCollider| (Isometry3d::from_xyz(x, 0.0, 0.0), part);
    let wholes = [
        vec![beside(1.5, ClothCollider::ball(0.1)), beside(0.0, board())],
        vec![
            beside(0.0, board()),
            beside(1.5, ClothCollider::cone(0.2, 0.4)),
        ],
        vec![beside(0.0, field())],
        vec![beside(0.0, field()), beside(0.7, ClothCollider::ball(0.1))],
    ];
    let mut random = Random(12);
    for parts in wholes {
        let whole = shape(&ClothCollider::compound(parts));
        for _ in 0..2_000 {
            let (before, displacement) = (random.within(1.2), random.within(0.1));
            let known = distance(&whole, before).abs() as f32;
            let exact = whole.nearest(Isometry3d::IDENTITY, before + displacement);
            for within in [known + displacement.length() + 1.0e-3, f32::NAN, f32::MAX] {
                let found = whole.nearest_within(before + displacement, within);
                assert_eq!(
                    found.distance, exact.distance,
                    "{before} {displacement} {within}"
                );
            }
        }
    }
}

/// What makes no shape says what is wrong with it.
#[test]
fn bad_shapes_are_told() {
    let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z];
    let error =
        |collider: ClothCollider, scale: Vec3| collider.scaled(scale).expect_err("an error");
    let flat = ClothError::Shape(ShapeError::FlatHull { points: 4 });
    assert_eq!(error(ClothCollider::convex_hull(square), Vec3::ONE), flat);
    for points in [
        vec![],
        vec![Vec3::ONE; 9],
        vec![Vec3::X, Vec3::X * 2.0, Vec3::X * 3.0],
    ] {
        let count = points.len();
        let told = error(ClothCollider::convex_hull(points), Vec3::ONE);
        assert_eq!(told, ShapeError::FlatHull { points: count }.into());
    }
    let told = error(ClothCollider::trimesh(square, []), Vec3::ONE);
    assert_eq!(told, MeshError::WithoutArea { triangles: 0 }.into());
    let told = error(
        ClothCollider::trimesh(square, [[0, 1, 1], [2, 2, 2]]),
        Vec3::ONE,
    );
    assert_eq!(told, MeshError::WithoutArea { triangles: 2 }.into());
    let told = error(ClothCollider::trimesh(square, [[0, 1, 7]]), Vec3::ONE);
    assert!(matches!(
        told,
        ClothError::Mesh(MeshError::TriangleOutOfRange {
            triangle: 0,
            vertices: 4,
            ..
        })
    ));
    for bad in [f32::NAN, f32::INFINITY, 1.0e30] {
        let mut points = square.to_vec();
        points.extend([Vec3::Y, Vec3::new(0.0, bad, 0.0)]);
        for collider in [
            ClothCollider::convex_hull(points.clone()),
            ClothCollider::trimesh(points, [[0, 1, 2]]),
        ] {
            let told = error(collider, Vec3::ONE);
            assert!(
                matches!(
                    told,
                    ClothError::Mesh(MeshError::VertexNotFinite { vertex: 5, .. })
                ),
                "{told}"
            );
        }
    }
    for (heights, columns) in [(4, 0), (4, 1), (3, 2), (4, 4), (0, 2)] {
        let ground = ClothCollider::heightfield(vec![0.0; heights], columns, Vec3::ONE);
        assert_eq!(
            error(ground, Vec3::ONE),
            ShapeError::HeightFieldSize { heights, columns }.into()
        );
    }
    let turned = Isometry3d::from_rotation(Quat::from_rotation_z(0.5));
    let skewed = ClothCollider::compound([(turned, ClothCollider::ball(1.0))]);
    assert!(skewed.scaled(Vec3::splat(-2.0)).is_ok());
    let scale = Vec3::new(1.0, 2.0, 1.0);
    assert_eq!(
        error(skewed, scale),
        ShapeError::SkewedPart { scale }.into()
    );
    for nothing in [
        ClothCollider::compound([]),
        ClothCollider::compound([(turned, ClothCollider::plane())]),
    ] {
        assert!(matches!(
            error(nothing, Vec3::ONE),
            ClothError::Shape(ShapeError::NoSuchShape { .. })
        ));
    }
    for scale in [
        Vec3::ZERO,
        Vec3::new(1.0, 0.0, 1.0),
        Vec3::NAN,
        Vec3::INFINITY,
    ] {
        let hull = ClothCollider::convex_hull([Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]);
        for collider in [
            hull,
            ClothCollider::cylinder(1.0, 1.0),
            ClothCollider::cone(1.0, 1.0),
            ClothCollider::trimesh(square, [[0, 1, 2]]),
            ClothCollider::heightfield(vec![0.0; 4], 2, Vec3::ONE),
            ClothCollider::compound([(Isometry3d::IDENTITY, ClothCollider::ball(1.0))]),
        ] {
            let told = error(collider, scale);
            assert!(matches!(told, ClothError::Quantity(_)), "{scale}: {told}");
        }
    }
}

/// What is built is built once for all clones.
#[test]
fn clones_share_what_is_built() {
    let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z];
    let sheet = ClothCollider::trimesh(square, [[0, 1, 2], [0, 2, 3]]);
    let other = sheet.clone();
    assert_eq!(sheet, other);
    assert_eq!(sheet.scaled(Vec3::ONE), other.scaled(Vec3::ONE));
    assert_ne!(sheet.scaled(Vec3::ONE), other.scaled(Vec3::splat(2.0)));
}
