//! Each volume by itself, against f64.

use bevy::math::{
    Isometry3d, Mat3, Quat, Vec2, Vec3, Vec3Swizzles,
    bounding::{Aabb3d, BoundingSphere},
};
use proptest::prelude::*;

use super::*;
use crate::hierarchy::{
    probe::{Core, Probe},
    tests::holds::Holds,
};

fn within(limit: f32) -> impl Strategy<Value = Vec3> {
    (-limit..limit, -limit..limit, -limit..limit).prop_map(Vec3::from)
}

fn cores() -> impl Strategy<Value = Core> {
    let turn = within(4.0).prop_map(Quat::from_scaled_axis);
    prop_oneof![
        within(4.0).prop_map(Core::Point),
        (within(4.0), within(4.0)).prop_map(|(a, b)| Core::Segment([a, b])),
        (within(4.0), turn, within(2.0)).prop_map(|(centre, rotation, half)| Core::Cuboid {
            pose: Isometry3d::new(centre, rotation),
            half_size: half.abs(),
        }),
        (within(4.0), within(1.0)).prop_map(|(point, normal)| Core::HalfSpace {
            point,
            normal: normal.normalize_or(Vec3::X),
        }),
    ]
}

/// Around four patches of four particles each: it holds them all, holds its children, and never says that a probe is
/// out of reach which has one of them in reach.
fn check<V: Volume + Holds>(
    points: &[Vec3],
    core: Core,
    reach: f32,
    origin: Vec3,
) -> Result<(), TestCaseError> {
    let points: Vec<Vec3> = points.iter().map(|&point| point + origin).collect();
    let leaves: Vec<V> = points.iter().map(|&point| V::around(point, 0.0)).collect();
    let patches: Vec<V> = leaves
        .chunks(4)
        .map(|four| V::unite([&four[0], &four[1], &four[2], &four[3]]))
        .collect();
    let whole = V::unite([&patches[0], &patches[1], &patches[2], &patches[3]]);
    for (index, point) in points.iter().enumerate() {
        let patch = &patches[index / 4];
        prop_assert!(
            leaves[index].holds(point.as_dvec3(), 0.0),
            "leaf {:?}",
            leaves[index]
        );
        prop_assert!(patch.holds(point.as_dvec3(), 0.0), "{patch:?} {point}");
        prop_assert!(whole.holds(point.as_dvec3(), 0.0), "{whole:?} {point}");
        prop_assert!(patch.holds_volume(&leaves[index]) && whole.holds_volume(patch));
        let ball = V::around(*point, reach);
        prop_assert!(
            ball.holds(point.as_dvec3(), f64::from(reach) * 0.9999),
            "{ball:?}"
        );
    }
    let probe = Probe {
        core,
        radius: reach,
        particle_radius: 0.0,
    };
    for (index, point) in points.iter().enumerate() {
        if probe.meets(*point) {
            for volume in [&leaves[index], &patches[index / 4], &whole] {
                prop_assert!(
                    volume.may_reach(&probe, reach),
                    "{volume:?} {point} {probe:?}"
                );
            }
        }
    }
    // What is far away is told from what is near.
    let far = Probe::ball(origin + Vec3::splat(1.0e3), 1.0, 0.0);
    prop_assert!(!whole.may_reach(&far, 1.0));
    let mut lanes = V::UNSET;
    V::set_lane(&mut lanes, 5, whole);
    prop_assert_eq!(V::lane(&lanes, 5), whole);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn volumes_hold_and_never_deny(
        points in prop::collection::vec(within(2.0), 16),
        thinness in prop_oneof![Just(0.0f32), 0.0f32..9.0],
        turn in within(4.0).prop_map(Quat::from_scaled_axis),
        core in cores(),
        reach in 0.01f32..3.0,
        far_out in any::<bool>(),
    ) {
        // Some of them nearly on a line: down to rounding.
        let thin = Vec2::splat(10.0_f32.powf(-thinness)).extend(1.0).zxy();
        let points: Vec<Vec3> = points.iter().map(|&point| turn * (point * thin)).collect();
        let origin = if far_out { Vec3::new(900.0, -700.0, 800.0) } else { Vec3::ZERO };
        let moved = |point: Vec3| point + origin;
        let core = match core {
            Core::Point(centre) => Core::Point(moved(centre)),
            Core::Segment([a, b]) => Core::Segment([moved(a), moved(b)]),
            Core::Cuboid { pose, half_size } => {
                let pose = Isometry3d::new(moved(pose.translation.into()), pose.rotation);
                Core::Cuboid { pose, half_size }
            }
            Core::HalfSpace { point, normal } => Core::HalfSpace { point: moved(point), normal },
        };
        check::<BoundingSphere>(&points, core, reach, origin)?;
        check::<Aabb3d>(&points, core, reach, origin)?;
        check::<Obb>(&points, core, reach, origin)?;
        check::<KDop<7>>(&points, core, reach, origin)?;
        check::<KDop<9>>(&points, core, reach, origin)?;
        check::<KDop<13>>(&points, core, reach, origin)?;
    }
}

/// Of a flat patch across two axes an OBB is flat, an AABB is not.
#[test]
fn an_obb_lies_along_its_patch() {
    let rotation = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(0.4);
    let corners = [
        Vec3::new(-1.0, 2.0, 0.0),
        Vec3::new(1.0, 2.0, 0.0),
        Vec3::new(-1.0, -2.0, 0.0),
        Vec3::new(1.0, -2.0, 0.0),
    ];
    let [a, b, c, d] = corners.map(|corner| Obb::around(rotation * corner, 0.0));
    let obb = Obb::unite([&a, &b, &c, &d]);
    assert!(
        obb.half_size.abs_diff_eq(Vec3::new(1.0, 2.0, 0.0), 1e-5),
        "{obb:?}"
    );
    assert!(obb.centre.length() < 1e-6);
    assert!((obb.axes.determinant() - 1.0).abs() < 1e-5);
}

/// The axes of a patch that is nearly a line are square to each other, however thin it is. (The plain cross product of
/// two nearly parallel sides was not, and boxes lost particles at their faces.)
#[test]
fn an_obbs_axes_are_square() {
    for turn in 0..1000 {
        let angle = turn as f32;
        let thin = 10.0_f32.powf(-0.009 * angle);
        let rotation = Quat::from_scaled_axis(Vec3::new(0.3, 0.7, -0.2) * angle);
        let corners = [
            Vec3::new(-1.0, -thin, 0.3 * thin),
            Vec3::new(1.0, 0.4 * thin, -thin),
            Vec3::new(-0.7, thin, 0.0),
            Vec3::new(0.8, thin, thin),
        ];
        let [a, b, c, d] = corners.map(|corner| Obb::around(rotation * corner, 0.0));
        let axes = Obb::unite([&a, &b, &c, &d]).axes;
        // Nine products and sums of rounded numbers up to 1: some 4 ε each.
        let off = axes.transpose() * axes - Mat3::IDENTITY;
        let largest = off
            .to_cols_array()
            .iter()
            .fold(0.0_f32, |a, b| a.max(b.abs()));
        assert!(largest <= 8.0 * f32::EPSILON, "{largest} at {thin}: {axes}");
    }
}

/// Around a ball the faces of a k-DOP are as many as its planes, each touches the ball, and each corner is beyond it.
#[test]
fn a_kdops_faces_are_its_planes() {
    fn check<const N: usize>(corners_of_faces: &[usize]) {
        let centre = Vec3::new(3.0, -1.0, 2.0);
        let faces = KDop::<N>::around(centre, 1.0).faces();
        let mut found: Vec<usize> = faces.iter().map(|face| distinct(face)).collect();
        found.sort_unstable();
        assert_eq!(found, corners_of_faces, "{N} pairs of planes");
        for face in &faces {
            let normal = (face[1] - face[0]).cross(face[2] - face[0]).normalize();
            assert!(
                ((face[0] - centre).dot(normal).abs() - 1.0).abs() < 1e-3,
                "{face:?}"
            );
            assert!(face.iter().all(|corner| corner.distance(centre) > 0.999));
        }
    }
    /// Where several planes meet in a corner, rounding leaves some of it.
    fn distinct(face: &[Vec3]) -> usize {
        let is_new = |index: &usize| {
            face[..*index]
                .iter()
                .all(|other| other.distance(face[*index]) > 1e-2)
        };
        (0..face.len()).filter(is_new).count()
    }
    // A cube whose corners are cut so deep that they meet: six squares and eight hexagons.
    check::<7>(&[4, 4, 4, 4, 4, 4, 6, 6, 6, 6, 6, 6, 6, 6]);
    // A cube whose edges are cut: six squares, and twelve hexagons.
    check::<9>(&[4, 4, 4, 4, 4, 4, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6]);
    // Both.
    let faces = KDop::<13>::around(Vec3::ZERO, 1.0).faces();
    assert_eq!(faces.len(), 26);
}
