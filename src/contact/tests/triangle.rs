//! Nearest points and areas of triangles, against dense sampling in `f64` and closed forms.

use std::f32::consts::PI;

use bevy::math::{DVec3, Vec3};
use proptest::prelude::*;

use super::random::{Random, cases};
use crate::contact::colliders::{area_within, at, nearest, nearest_to_point};

/// Samples an edge.
const SAMPLES: usize = 24;

/// The nearest of a dense net of points of the triangle, and of the segment (m).
fn sampled(triangle: [Vec3; 3], ends: [Vec3; 2]) -> f64 {
    let [a, b, c] = triangle.map(Vec3::as_dvec3);
    let [start, end] = ends.map(Vec3::as_dvec3);
    let along = end - start;
    let to_segment = |point: DVec3| {
        let t = ((point - start).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let foot = if t > 0.0 { start + along * t } else { start };
        point.distance(foot)
    };
    let part = |index: usize| index as f64 / SAMPLES as f64;
    (0..=SAMPLES)
        .flat_map(|i| (0..=SAMPLES - i).map(move |j| (part(i), part(j))))
        .map(|(u, v)| to_segment(a + (b - a) * u + (c - a) * v))
        .fold(f64::INFINITY, f64::min)
}

fn longest(triangle: [Vec3; 3]) -> f64 {
    let [a, b, c] = triangle.map(Vec3::as_dvec3);
    a.distance(b).max(b.distance(c)).max(c.distance(a))
}

/// Some triangle of about 1 m: any, one that is nearly or quite a line, or a point.
fn some_triangle(random: &mut Random) -> [Vec3; 3] {
    let a = random.within(1.0);
    let (ab, ac) = (random.within(1.0), random.within(1.0));
    match random.below(8) {
        0 => [a, a + ab, a + ab * random.between(-1.0, 2.0)],
        1 => [a, a + ab, a + ab * 0.5 + ac * 1.0e-4],
        2 => [a, a, a + ac],
        3 => [a; 3],
        _ => [a, a + ab, a + ac],
    }
}

proptest! {
    #![proptest_config(cases(6_000))]

    /// The nearest points are points of both, as far from each other as they say, and no farther than the nearest of
    /// the samples; which are farther than the true ones by less than the longest edge over the samples of one, as
    /// every point of the triangle has a sample so near. In rounding, some 30 of half an ε of 4 m; the edges of a
    /// triangle that is nearly a line lie nearly alongside a segment, where cancellation costs 3·10⁻⁴ of it.
    #[test]
    fn the_nearest_points_are_nearest(seed in any::<u64>(), is_point in any::<bool>()) {
        let mut random = Random(seed);
        let mut triangle = some_triangle(&mut random);
        let start = random.within(2.0);
        let end = if is_point { start } else { start + random.within(1.5) };
        // Half of them are small and beside the segment, as those of a cloth on a capsule.
        if random.below(2) == 0 {
            let middle = start.lerp(end, random.part()) + random.within(0.2);
            triangle = triangle.map(|corner| middle + 0.2 * corner);
        }
        let found = nearest(triangle, [start, end]);
        let sum: f32 = found.weights.iter().sum();
        prop_assert!((sum - 1.0).abs() < 1e-5, "{found:?}");
        prop_assert!(found.weights.iter().all(|w| (-1e-5..=1.0 + 1e-5).contains(w)), "{found:?}");
        prop_assert!((0.0..=1.0).contains(&found.along));
        let offset = at(triangle, found.weights) - start.lerp(end, found.along);
        prop_assert!(offset.distance(found.offset) < 1e-5);
        let (distance, truth) = (f64::from(found.offset.length()), sampled(triangle, [start, end]));
        let slack = if is_point { 1e-5 } else { 5e-4 };
        prop_assert!(distance < truth + slack, "{triangle:?} {start} {end}: {distance} {truth}");
        let coarse = longest(triangle) / SAMPLES as f64;
        prop_assert!(distance > truth - coarse - 1e-5, "{triangle:?} {start} {end}: {distance} {truth}");
        if is_point {
            prop_assert_eq!(found.weights, nearest_to_point(triangle, start));
        }
    }

    /// Against points thrown at the triangle: of 4000, the part that is within is off by less than five standard
    /// deviations, 5 × √(1/4 / 4000) = 0.04.
    #[test]
    fn the_area_within_is_that_of_thrown_points(seed in 0_u64..600) {
        let mut random = Random(seed);
        let triangle = some_triangle(&mut random);
        let [a, b, c] = triangle;
        let whole = (b - a).cross(c - a).length() / 2.0;
        let centre = a + (b - a) * random.between(-1.0, 2.0) + (c - a) * random.between(-1.0, 2.0);
        let radius = random.between(0.05, 1.5);
        let found = area_within(triangle, centre, radius);
        prop_assert!(found.is_finite());
        if whole > 1.0e-2 {
            let hits = (0..4000).filter(|_| {
                let (u, v) = (random.part(), random.part());
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                (a + (b - a) * u + (c - a) * v).distance(centre) < radius
            });
            let part = hits.count() as f32 / 4000.0;
            prop_assert!((found / whole - part).abs() < 0.04, "{found} {whole} {part}");
        }
    }
}

/// A triangle without area still has a nearest point, and none of its numbers is NaN.
#[test]
fn degenerate_triangles_give_finite_results() {
    let (a, b) = (Vec3::new(0.3, 0.1, -0.2), Vec3::new(1.0, 2.0, 3.0));
    let middle = a.midpoint(b);
    for triangle in [
        [a; 3],
        [a, a, b],
        [a, b, a],
        [b, a, a],
        [a, middle, b],
        [a, b, middle],
    ] {
        for ends in [
            [Vec3::ZERO; 2],
            [a, a],
            [a, b],
            [middle, Vec3::X],
            [Vec3::X, Vec3::Y],
        ] {
            let found = nearest(triangle, ends);
            assert!(found.offset.is_finite(), "{triangle:?} {ends:?} {found:?}");
            assert!(found.weights.iter().all(|w| w.is_finite()));
            assert!(found.along.is_finite());
            let truth = sampled(triangle, ends);
            let coarse = longest(triangle) / SAMPLES as f64;
            assert!((f64::from(found.offset.length()) - truth).abs() < coarse + 1e-5);
        }
        // Of edges of 4 m, some ε of a square.
        assert!(area_within(triangle, a, 1.0) < 1e-6);
    }
}

/// A disc inside of the triangle, a triangle inside of the disc, one that its edge halves, a corner's sector, and none:
/// each to 20 roundings.
#[test]
fn the_area_within_has_its_closed_forms() {
    let triangle = [Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 3.0];
    let cases = [
        (Vec3::new(1.0, 1.0, 0.0), 0.7, PI * 0.49),
        (Vec3::new(1.0, 1.0, 0.0), 9.0, 6.0),
        (Vec3::new(1.5, 0.0, 0.0), 0.5, PI * 0.125),
        (Vec3::ZERO, 1.0, PI / 4.0),
        (Vec3::X * 4.0, 1.0, 0.5 * (3.0_f32 / 4.0).atan()),
        (Vec3::new(-1.0, 1.0, 0.0), 0.9, 0.0),
        (Vec3::new(9.0, 9.0, 0.0), 2.0, 0.0),
        // Cut off by the line x = 0 at half of the radius: r² (acos ½ − ½ √¾).
        (
            Vec3::new(-0.25, 1.5, 0.0),
            0.5,
            0.25 * (0.5_f32.acos() - 0.5 * 0.75_f32.sqrt()),
        ),
    ];
    for (centre, radius, area) in cases {
        for turned in [triangle, [triangle[2], triangle[1], triangle[0]]] {
            let found = area_within(turned, centre, radius);
            assert!(
                (found - area).abs() < 1e-5 * (1.0 + radius * radius),
                "{centre} {radius}: {found} {area}"
            );
        }
    }
}
