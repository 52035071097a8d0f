use super::*;
use crate::cloth::{recipe::Cloth, surface::triangles::TriangleMesh};
use bevy::math::{Mat3, Quat};

/// A vertex where a surface takes it.
#[derive(Debug)]
struct BoundVertex {
    position: Vec3,
    normal: Vec3,
    tangent: Vec3,
}

/// A lying grid of 7 × 5 particles, 0.1 m apart, scaled along its axes.
fn sheet(scale: Vec3) -> Surface {
    let cloth = Cloth::new(7, 5, 0.1).lying();
    cloth.surface(scale).expect("a valid grid")
}

/// Some vertices above, below and beside a sheet of that extent, with normals and tangents at right angles to each other.
fn fine(surface: &Surface) -> [Vec<Vec3>; 3] {
    let corner = surface
        .rest_positions()
        .iter()
        .copied()
        .fold(Vec3::MAX, Vec3::min);
    let far = surface
        .rest_positions()
        .iter()
        .copied()
        .fold(Vec3::MIN, Vec3::max);
    let mut all = [const { Vec::new() }; 3];
    for index in 0..400 {
        let part = |factor: f32| (index as f32 * factor).fract();
        let share = Vec3::new(part(0.618), 0.0, part(0.414)) * 1.1 - Vec3::splat(0.05);
        let height = 0.04 * (part(0.732) - 0.5);
        all[0].push((corner + (far - corner) * share).with_y(height));
        let normal = Vec3::new(part(0.317) - 0.5, 1.0, part(0.236) - 0.5).normalize();
        all[1].push(normal);
        all[2].push(normal.any_orthonormal_vector());
    }
    all
}

fn bind(surface: &Surface, [positions, normals, tangents]: &[Vec<Vec3>; 3]) -> SurfaceBinding {
    SurfaceBinding::new(surface, positions, normals, tangents).expect("near the surface")
}

fn moved(
    surface: &Surface,
    binding: &SurfaceBinding,
    to: impl Fn(Vec3) -> Vec3,
) -> Vec<BoundVertex> {
    let positions: Vec<_> = surface.rest_positions().iter().copied().map(to).collect();
    let mut normals = Vec::new();
    surface.normals_at(&positions, &mut normals);
    let [mut places, mut facing] = [(); 2].map(|()| vec![[f32::NAN; 3]; binding.len()]);
    let mut tangents = vec![[f32::NAN; 4]; binding.len()];
    binding.write(
        &positions,
        &normals,
        &mut places,
        &mut facing,
        &mut tangents,
    );
    let vertices = places.iter().zip(&facing).zip(&tangents);
    vertices
        .map(|((position, normal), [x, y, z, _])| BoundVertex {
            position: (*position).into(),
            normal: (*normal).into(),
            tangent: Vec3::new(*x, *y, *z),
        })
        .collect()
}

/// The vertices, their normals and their tangents are where a motion of a rigid body takes them, at rest too. Of numbers below 2 m, in
/// some twenty roundings of 2⁻²⁴ × 2 each.
#[test]
fn follows_a_rigid_motion() {
    let close = |found: Vec3, expected: Vec3| {
        assert!(found.distance(expected) < 3.0e-6, "{found} {expected}");
    };
    for scale in [Vec3::ONE, Vec3::new(1.5, 1.0, 0.7)] {
        let surface = sheet(scale);
        let fine = fine(&surface);
        let binding = bind(&surface, &fine);
        for (rotation, offset) in [
            (Quat::IDENTITY, Vec3::ZERO),
            (
                Quat::from_euler(bevy::math::EulerRot::XYZ, 1.0, 2.0, -0.7),
                Vec3::new(0.3, -0.5, 1.0),
            ),
        ] {
            let found = moved(&surface, &binding, |place| rotation * place + offset);
            for (index, found) in found.into_iter().enumerate() {
                close(found.position, rotation * fine[0][index] + offset);
                close(found.normal, rotation * fine[1][index]);
                close(found.tangent, rotation * fine[2][index]);
            }
        }
    }
}

/// What lies above the cloth moves affinely with it, and its height stays what it was, at right angles to the surface: A x + h n,
/// where n is the normal of the plane that the sheet has come to.
#[test]
fn follows_an_affine_motion() {
    let surface = sheet(Vec3::ONE);
    let corner = surface.rest_positions()[0];
    let size = Vec3::new(0.6, 0.0, 0.4) * (surface.rest_positions()[34] - corner).signum();
    let places: Vec<(Vec3, f32)> = (0..200)
        .map(|index| {
            let part = |factor: f32| (index as f32 * factor).fract();
            let place = corner + size * Vec3::new(part(0.618), 0.0, part(0.414));
            (place, 0.1 * (part(0.732) - 0.5))
        })
        .collect();
    let up = surface.normal_of(0);
    let positions: Vec<_> = places
        .iter()
        .map(|(place, height)| *place + up * *height)
        .collect();
    let normals = vec![up; positions.len()];
    let binding = bind(&surface, &[positions, normals, vec![Vec3::X; 200]]);
    let by = Mat3::from_cols(
        Vec3::new(1.3, 0.2, 0.4),
        Vec3::new(0.0, 1.0, 0.0),
        Vec3::new(-0.5, 0.3, 0.8),
    );
    let by = Mat3::from_quat(Quat::from_rotation_x(0.8)) * by;
    let normal = (by * Vec3::Z).cross(by * Vec3::X).normalize() * up.y;
    let found = moved(&surface, &binding, |place| by * place);
    for (found, (place, height)) in found.iter().zip(&places) {
        let expected = by * *place + normal * *height;
        assert!(
            found.position.distance(expected) < 2.0e-6,
            "{found:?} {expected}"
        );
        assert!(found.normal.distance(normal) < 2.0e-6);
        // The texture's direction goes along with the cloth, sheared as it is.
        assert!(found.tangent.distance((by * Vec3::X).normalize()) < 2.0e-6);
    }
}

/// A sheet that is rolled up to a cylinder: normals point away from its axis. At the particles exactly, as faces are alike to either
/// side; between two of them, at the angle θ, blended normals are off by θ³ s (1 − s)(1 − 2s)/6 + O(θ⁵), which is at most θ³/62. Where a
/// point is on the chord its angle is off that of its part s by half as much again at most.
#[test]
fn normals_on_a_cylinder_point_away_from_its_axis() {
    let cloth = Cloth::new(41, 5, 0.05).lying().centred();
    let surface = cloth.surface(Vec3::ONE).expect("a grid");
    let fine: Vec<Vec3> = (0..=380)
        .map(|at| Vec3::new(at as f32 / 200.0 - 0.95, 0.0, 0.01))
        .collect();
    let up = surface.normal_of(0);
    let count = fine.len();
    let binding = bind(
        &surface,
        &[fine.clone(), vec![up; count], vec![Vec3::X; count]],
    );
    let radius = 0.5;
    let roll = |at: Vec3| {
        let (sin, cos) = (at.x / radius).sin_cos();
        Vec3::new(radius * sin, radius * cos - radius, at.z)
    };
    let theta: f32 = 0.05 / radius;
    let bound = 1.5 * theta.powi(3) / 62.0 + 2.0e-6;
    for (found, at) in moved(&surface, &binding, roll).into_iter().zip(fine) {
        let (sin, cos) = (at.x / radius).sin_cos();
        let expected = Vec3::new(sin, cos, 0.0) * up.y;
        let off = found.normal.distance(expected);
        assert!(off < bound, "{off} > {bound} at {at}");
        // Length 1 and a right angle, to some roundings.
        assert!((found.tangent.length() - 1.0).abs() < 1.0e-6);
        assert!(found.tangent.dot(found.normal).abs() < 1.0e-6);
        assert!(found.tangent.dot(Vec3::new(cos, -sin, 0.0)) > 0.999);
    }
}

/// The distance to the point that each vertex is bound to is that of brute force over all faces, on a surface that is bent.
#[test]
fn binds_to_the_nearest_face() {
    let sheet = sheet(Vec3::ONE);
    let bend = |at: &Vec3| Vec3::new(at.x, 0.2 * (9.0 * at.x).sin() * (5.0 * at.z).cos(), at.z);
    let mesh = TriangleMesh {
        positions: sheet.rest_positions().iter().map(bend).collect(),
        triangles: sheet.triangles().to_vec(),
        ..TriangleMesh::default()
    };
    let surface = Surface::of_mesh(&mesh, 0.0, Vec3::ONE).expect("a surface");
    let fine = fine(&surface);
    let binding = bind(&surface, &fine);
    let rest = surface.rest_positions();
    let lanes = binding
        .eights
        .iter()
        .flat_map(|eight| (0..LANES).map(|lane| eight.lane(lane)));
    for (bound, position) in lanes.zip(&fine[0]) {
        let at = |[a, b, c]: [Vec3; 3], [u, v, w]: [f32; 3]| a * u + b * v + c * w;
        let own = bound.corners.map(|corner| rest[corner as usize]);
        let distance = at(own, bound.weights).distance(*position);
        for face in surface.triangles() {
            // A grid of 40 points along each side of a face, so that none is nearer than that grid lets be seen.
            let places = face.map(|corner| rest[corner as usize]);
            for (u, v) in (0..=40).flat_map(|u| (0..=40 - u).map(move |v| (u, v))) {
                let weights = [u, v, 40 - u - v].map(|part| part as f32 / 40.0);
                let other = at(places, weights).distance(*position);
                assert!(distance <= other + 1.0e-6, "{distance} {other}");
            }
        }
    }
}

#[test]
fn refuses_what_is_far_or_not_finite() {
    let surface = sheet(Vec3::ONE);
    let bind = |at: Vec3| SurfaceBinding::new(&surface, &[Vec3::ZERO, at], &[Vec3::Y; 2], &[]);
    assert!(bind(Vec3::Y * 0.5).is_ok_and(|binding| !binding.has_tangents()));
    let far = bind(Vec3::Y * 2.0);
    assert!(
        matches!(far, Err(MeshError::BoundTooFar { vertex: 1, .. })),
        "{far:?}"
    );
    let nan = bind(Vec3::NAN);
    assert!(
        matches!(nan, Err(MeshError::VertexNotFinite { vertex: 1, .. })),
        "{nan:?}"
    );
    let none = SurfaceBinding::new(&Surface::default(), &[Vec3::ZERO], &[Vec3::Y], &[]);
    assert!(
        matches!(none, Err(MeshError::WithoutArea { .. })),
        "{none:?}"
    );
}

/// A cloth that is crushed to a point or a line gives no NaN.
#[test]
fn stays_finite_on_a_crushed_surface() {
    let surface = sheet(Vec3::ONE);
    let fine = fine(&surface);
    let binding = bind(&surface, &fine);
    for by in [Vec3::ZERO, Vec3::X] {
        let found = moved(&surface, &binding, |place| place * by);
        let is_finite =
            |found: &BoundVertex| found.position.is_finite() && found.normal.is_finite();
        assert!(
            found
                .iter()
                .all(|found| is_finite(found) && found.tangent.is_finite())
        );
    }
}
