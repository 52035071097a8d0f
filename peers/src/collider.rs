//! Bodies that cloth meets, and how deep it is in them.

use bevy::math::{DQuat, DVec3, Isometry3d, Vec3};

/// A body that moves along a given path, or not at all.
#[derive(Clone, Copy)]
pub struct Collider {
    pub shape: Shape,
    /// Where it is after so many seconds.
    pub at: fn(f32) -> Isometry3d,
    pub moves: bool,
}

/// Around its own origin; lengths in m.
#[derive(Debug, Clone, Copy)]
pub enum Shape {
    Ball(f32),
    /// Along y, with `length` between the centres of its half-balls.
    Capsule {
        radius: f32,
        length: f32,
    },
    /// By its sides.
    Cuboid(Vec3),
    /// All below y = 0.
    Floor,
}

impl Shape {
    /// The distance (m) of a place from its surface, negative inside.
    fn distance(self, place: DVec3) -> f64 {
        match self {
            Self::Ball(radius) => place.length() - f64::from(radius),
            Self::Capsule { radius, length } => {
                let half = 0.5 * f64::from(length);
                let along = place.y.clamp(-half, half);
                place.distance(DVec3::Y * along) - f64::from(radius)
            }
            Self::Cuboid(sides) => {
                let beyond = place.abs() - 0.5 * sides.as_dvec3();
                beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
            }
            Self::Floor => place.y,
        }
    }
}

/// How deep the deepest corner, and the deepest point of all flat triangles, are in colliders (m) after so many seconds; 0 if nothing
/// is, NaN if a place is. By brute force.
pub fn depths(
    places: &[[f32; 3]],
    triangles: &[[u32; 3]],
    colliders: &[Collider],
    seconds: f32,
) -> [f64; 2] {
    if places.iter().flatten().any(|place| !place.is_finite()) {
        return [f64::NAN; 2];
    }
    let (mut of_corners, mut of_triangles) = (0.0_f64, 0.0_f64);
    for collider in colliders {
        let at = (collider.at)(seconds);
        let (origin, turn) = (
            at.translation.as_dvec3(),
            at.rotation.as_dquat().normalize(),
        );
        let own: Vec<DVec3> = places
            .iter()
            .map(|place| into(*place, origin, turn))
            .collect();
        let depth = |place: DVec3| -collider.shape.distance(place);
        of_corners = own
            .iter()
            .map(|place| depth(*place))
            .fold(of_corners, f64::max);
        of_triangles = of_triangles.max(of_corners);
        for triangle in triangles {
            let corners = triangle.map(|corner| own[corner as usize]);
            of_triangles = deeper(of_triangles, corners, SPLITS, &depth);
        }
    }
    [of_corners, of_triangles]
}

fn into(place: [f32; 3], origin: DVec3, turn: DQuat) -> DVec3 {
    turn.inverse() * (Vec3::from_array(place).as_dvec3() - origin)
}

/// How often a triangle is cut into four to find parts that are not deep.
const SPLITS: u32 = 3;

/// The larger of a depth and that of a triangle's points.
fn deeper(known: f64, [a, b, c]: [DVec3; 3], splits: u32, depth: &impl Fn(DVec3) -> f64) -> f64 {
    let centre = (a + b + c) / 3.0;
    let reach = [a, b, c].map(|corner| corner.distance(centre));
    // Nothing of it is deeper than its centre by more than it is away from it.
    if depth(centre) + reach.into_iter().fold(0.0, f64::max) <= known {
        return known;
    }
    if splits == 0 {
        return known.max(deepest([a, b, c], depth));
    }
    let [d, e, f] = [(b, c), (c, a), (a, b)].map(|(a, b)| a.midpoint(b));
    [[a, f, e], [f, b, d], [e, d, c], [d, e, f]]
        .into_iter()
        .fold(known, |known, part| deeper(known, part, splits - 1, depth))
}

/// The largest depth of a triangle's points. In a convex body it has one peak along each line, and so have the largest ones of
/// parallel lines.
fn deepest([a, b, c]: [DVec3; 3], depth: impl Fn(DVec3) -> f64) -> f64 {
    peak(|along| {
        let [from, to] = [a.lerp(b, along), a.lerp(c, along)];
        peak(|across| depth(from.lerp(to, across)))
    })
}

/// The largest value from 0 to 1 of a function that has one peak, by thirds.
fn peak(value: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..32 {
        let third = (high - low) / 3.0;
        if value(low + third) < value(high - third) {
            low += third;
        } else {
            high -= third;
        }
    }
    // A peak at an end is never reached between.
    [0.0, 0.5 * (low + high), 1.0]
        .map(value)
        .into_iter()
        .fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Quat;

    /// Numbers from −0.4 to 0.6, the same each time.
    fn random() -> impl FnMut() -> f64 {
        let mut state = 1_u32;
        move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24) - 0.4
        }
    }

    /// The point of a triangle that is nearest to the origin, by its regions (Ericson 2005, Real-Time Collision Detection, 5.1.5).
    fn nearest([a, b, c]: [DVec3; 3]) -> DVec3 {
        let (ab, ac) = (b - a, c - a);
        let [at_a, at_b, at_c] = [a, b, c].map(|corner| [-ab.dot(corner), -ac.dot(corner)]);
        if at_a[0] <= 0.0 && at_a[1] <= 0.0 {
            return a;
        }
        if at_b[0] >= 0.0 && at_b[1] <= at_b[0] {
            return b;
        }
        let beside_ab = at_a[0] * at_b[1] - at_b[0] * at_a[1];
        if beside_ab <= 0.0 && at_a[0] >= 0.0 && at_b[0] <= 0.0 {
            return a + ab * (at_a[0] / (at_a[0] - at_b[0]));
        }
        if at_c[1] >= 0.0 && at_c[0] <= at_c[1] {
            return c;
        }
        let beside_ac = at_c[0] * at_a[1] - at_a[0] * at_c[1];
        if beside_ac <= 0.0 && at_a[1] >= 0.0 && at_c[1] <= 0.0 {
            return a + ac * (at_a[1] / (at_a[1] - at_c[1]));
        }
        let beside_bc = at_b[0] * at_c[1] - at_c[0] * at_b[1];
        let (from_b, from_c) = (at_b[1] - at_b[0], at_c[0] - at_c[1]);
        if beside_bc <= 0.0 && from_b >= 0.0 && from_c >= 0.0 {
            return b + (c - b) * (from_b / (from_b + from_c));
        }
        let sum = beside_ab + beside_ac + beside_bc;
        a + ab * (beside_ac / sum) + ac * (beside_ab / sum)
    }

    #[test]
    fn depth_in_a_ball_is_that_of_the_nearest_point() {
        let mut next = random();
        for _ in 0..500 {
            let corners = [(); 3].map(|()| DVec3::new(next(), next(), next()));
            let depth = |place: DVec3| -Shape::Ball(0.5).distance(place);
            let exact = 0.5 - nearest(corners).length();
            let found = deepest(corners, depth);
            assert!((found - exact).abs() < 1.0e-6, "{found} {exact}");
            let found = deeper(0.1, corners, SPLITS, &depth);
            assert!((found - exact.max(0.1)).abs() < 1.0e-6, "{found} {exact}");
        }
    }

    #[test]
    fn no_point_of_a_triangle_is_deeper() {
        let shapes = [
            Shape::Ball(0.3),
            Shape::Capsule {
                radius: 0.2,
                length: 0.4,
            },
            Shape::Cuboid(Vec3::new(0.5, 0.3, 0.7)),
            Shape::Floor,
        ];
        let mut next = random();
        for shape in [(); 100].iter().flat_map(|()| shapes) {
            let corners = [(); 3].map(|()| DVec3::new(next(), next(), next()));
            let depth = |place: DVec3| -shape.distance(place);
            let found = deepest(corners, depth);
            // Points of a fine grid over the triangle: none deeper, and one as deep as its width.
            let each = (0..=40).flat_map(|i| (0..=40 - i).map(move |j| [i, j].map(f64::from)));
            let tried = each
                .map(|[i, j]| {
                    let [a, b, c] = corners;
                    depth(a + (b - a) * (i / 40.0) + (c - a) * (j / 40.0))
                })
                .fold(f64::NEG_INFINITY, f64::max);
            assert!(found >= tried - 1.0e-6, "{shape:?}: {found} {tried}");
            assert!(tried >= found - 2.5 / 40.0, "{shape:?}: {found} {tried}");
        }
    }

    #[test]
    fn depths_are_those_of_closed_forms() {
        // A triangle through the middle of a box, with all corners outside.
        let cuboid = |at: fn(f32) -> Isometry3d| Collider {
            shape: Shape::Cuboid(Vec3::ONE),
            at,
            moves: false,
        };
        let still: fn(f32) -> Isometry3d = |_| Isometry3d::IDENTITY;
        let over = [[-1.0, 0.5, 0.0], [0.5, -1.0, 0.0], [2.0, 2.0, 0.0]];
        let triangle = [[0, 1, 2]];
        let [corner, deep] = depths(&over, &triangle, &[cuboid(still)], 0.0);
        assert_eq!(corner, 0.0);
        assert!((deep - 0.5).abs() < 1.0e-6, "{deep}");
        // A box turned and moved with its triangle.
        let moved: fn(f32) -> Isometry3d =
            |seconds| Isometry3d::new(Vec3::X * seconds, Quat::from_rotation_y(seconds));
        let places = over.map(|place| (moved(2.0) * Vec3::from_array(place)).to_array());
        let [_, turned] = depths(&places, &triangle, &[cuboid(moved)], 2.0);
        assert!((turned - deep).abs() < 1.0e-5, "{turned}");
        // The lowest corner is the deepest in a floor.
        let floor = Collider {
            shape: Shape::Floor,
            at: still,
            moves: false,
        };
        let depth = depths(&over, &triangle, &[floor], 0.0);
        assert!(
            depth.map(|depth| (depth - 1.0).abs() < 1.0e-9) == [true; 2],
            "{depth:?}"
        );
        assert!(depths(&[[f32::NAN; 3]], &[], &[floor], 0.0)[0].is_nan());
    }
}
