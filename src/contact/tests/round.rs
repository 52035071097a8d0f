//! Triangles on round surfaces, whose edges are left to the particles.

use bevy::math::{Isometry3d, Vec3};
use proptest::prelude::*;

use super::random::{Random, cases};
use crate::contact::colliders::{ClothCollider, ColliderShape, at};

fn shape(collider: &ClothCollider) -> ColliderShape {
    collider.scaled(Vec3::ONE).expect("a valid collider")
}

fn distance(shape: &ColliderShape, point: Vec3) -> f32 {
    shape.nearest(Isometry3d::IDENTITY, point).distance
}

/// Corners that are `off` a surface of turned lines, within `side` of each other (m). The radius at a height is given.
fn triangle(random: &mut Random, [off, side]: [f32; 2], radius: impl Fn(f32) -> f32) -> [Vec3; 3] {
    let widest = radius(0.0);
    loop {
        let mut corner = || {
            let (height, angle) = (
                random.between(0.0, side),
                random.between(0.0, side / widest),
            );
            let out = radius(height) + off;
            Vec3::new(out * angle.cos(), height, out * angle.sin())
        };
        let corners = [corner(), corner(), corner()];
        let [a, b, c] = corners;
        if a.distance(b).max(b.distance(c)).max(c.distance(a)) <= side {
            return corners;
        }
    }
}

/// The deepest of many points of a triangle (m).
fn deepest(shape: &ColliderShape, corners: [Vec3; 3]) -> f32 {
    let mut deepest = f32::NEG_INFINITY;
    for i in 0..=12_u8 {
        for j in 0..=12 - i {
            let [u, v] = [i, j].map(|part| f32::from(part) / 12.0);
            deepest = deepest.max(-distance(shape, at(corners, [u, v, 1.0 - u - v])));
        }
    }
    deepest
}

proptest! {
    #![proptest_config(cases(300))]

    /// From the radius l²/(6 r) on, all of a triangle of sides up to l is outside if its corners are r outside.
    #[test]
    fn triangles_on_round_surfaces_are_outside(seed in any::<u64>()) {
        let mut random = Random(seed);
        let off = random.between(0.002, 0.02);
        let side = off * random.between(1.0, 8.0);
        let smooth = side * side / (6.0 * off);
        let wide = smooth * random.between(1.0, 1.5);
        let cylinder = shape(&ClothCollider::cylinder(wide, 20.0 * wide + 4.0 * side));
        let triangle_on = triangle(&mut random, [off, side], |_| wide);
        prop_assert!(deepest(&cylinder, triangle_on) < 1.0e-5 * wide, "cylinder of {wide} m");
        // Its radius is the least where the triangle ends at its upper side.
        let (base, slope) = (wide + side * 2.0, random.between(0.1, 1.0));
        let cone = shape(&ClothCollider::cone(base, base / slope));
        let bottom = -base / slope / 2.0;
        let low = (base - wide - slope * side) / slope;
        let on_cone = triangle(&mut random, [off * 1.0_f32.hypot(slope), side], |height| base - slope * (low + height));
        let on_cone = on_cone.map(|corner| corner + Vec3::Y * (bottom + low));
        prop_assert!(deepest(&cone, on_cone) < 1.0e-5 * base, "cone of {base} m");
    }

    /// The edges of a cone are so many at each height that its flat sides are at most 0.25 % of its radius below the surface. Those
    /// that are left out are where it is wide.
    #[test]
    fn edges_are_left_out_where_a_cone_is_wide(seed in any::<u64>()) {
        let mut random = Random(seed);
        let (radius, height) = (random.between(0.1, 2.0), random.between(0.1, 2.0));
        let cone = shape(&ClothCollider::cone(radius, height));
        let smooth = radius * random.between(0.05, 0.9);
        let all = [Vec3::splat(-9.0), Vec3::splat(9.0)];
        let (mut every, mut some) = (Vec::new(), Vec::new());
        cone.edges_near(all, f32::INFINITY, |_, edge| every.push(*edge));
        cone.edges_near(all, smooth, |_, edge| some.push(*edge));
        for _ in 0..20 {
            let part = random.between(0.01, 0.99);
            let level = height * (0.5 - part);
            let crossing = |edges: &[crate::contact::colliders::SharpEdge]| {
                let mut angles: Vec<f32> = edges.iter().filter_map(|edge| {
                    let [a, b] = edge.ends;
                    let is_crossing = a.y.min(b.y) <= level && a.y.max(b.y) > level;
                    let place = a.lerp(b, (level - a.y) / (b.y - a.y));
                    is_crossing.then(|| place.z.atan2(place.x))
                }).collect();
                angles.sort_by(f32::total_cmp);
                angles
            };
            let angles = crossing(&every);
            let around = angles[0] + std::f32::consts::TAU;
            let next = angles[1..].iter().chain([&around]);
            let widest = next.zip(&angles).map(|(b, a)| b - a).fold(0.0, f32::max);
            let below = part * (1.0 - (widest / 2.0).cos());
            prop_assert!(below < 0.0025, "{below} at {part}");
            let left = crossing(&some);
            prop_assert!(left.is_empty() || left.len() == angles.len());
            // A piece ends where the cone is half as wide.
            prop_assert!(!left.is_empty() || part * radius >= smooth * 0.999, "{part}");
            prop_assert!(left.is_empty() || part * radius <= 2.0 * smooth * 1.001, "{part}");
        }
    }
}

/// On half of the radius from which edges are left out, a triangle does come in: the sagitta of its side is about l²/(8 R).
#[test]
fn on_narrow_cylinders_triangles_come_in() {
    let (off, side) = (0.01, 0.05);
    let narrow = side * side / (6.0 * off) / 2.0;
    let cylinder = shape(&ClothCollider::cylinder(narrow, 1.0));
    let out = narrow + off;
    let half = (side / 2.0 / out).asin();
    let corner = |angle: f32, height: f32| Vec3::new(out * angle.cos(), height, out * angle.sin());
    let corners = [corner(half, 0.0), corner(-half, 0.0), corner(0.0, 0.01)];
    assert!(deepest(&cylinder, corners) > 0.1 * off);
}
