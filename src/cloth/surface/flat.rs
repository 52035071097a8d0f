//! Surfaces that are flat and convex.

use bevy::math::{DVec2, DVec3, Vec3};

/// How far a particle of a flat surface may be off its plane, and how much larger than the surface its convex hull may be,
/// as parts of its size.
const FLAT: f64 = 1.0e-5;

/// A surface in its plane, if it is flat and convex.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Flat {
    /// Where each particle is in the plane (m).
    pub places: Vec<DVec2>,
    /// Whether stretch springs run along the plane's axes only, as threads.
    pub has_threads: bool,
}

impl Flat {
    /// From one particle to another in the plane (m).
    pub fn between(&self, a: usize, b: usize) -> [f32; 2] {
        (self.places[a] - self.places[b])
            .abs()
            .to_array()
            .map(|way| way as f32)
    }

    /// The plane of particles at `rest` (m) with faces of an `area` in all (m²), if they lie in one and there is neither a
    /// hole nor a bay nor a fold in it: then the convex hull has the same area.
    pub fn find(rest: &[Vec3], faces: &[[u32; 3]], area: f32) -> Option<Self> {
        let at = |particle: u32| rest[particle as usize].as_dvec3();
        let mut normal = DVec3::ZERO;
        for &[a, b, c] in faces {
            normal += (at(b) - at(a)).cross(at(c) - at(a));
        }
        let normal = normal.try_normalize()?;
        let origin = at(*faces.first()?.first()?);
        let (along, across) = normal.any_orthonormal_pair();
        let mut places = Vec::with_capacity(rest.len());
        let (mut size, mut off) = (0.0_f64, 0.0_f64);
        for position in rest {
            let offset = position.as_dvec3() - origin;
            off = off.max(offset.dot(normal).abs());
            size = size.max(offset.length());
            places.push(DVec2::new(offset.dot(along), offset.dot(across)));
        }
        let is_flat = off <= FLAT * size;
        let area = f64::from(area);
        (is_flat && hull_area(&places) <= area * (1.0 + 100.0 * FLAT)).then_some(Self {
            places,
            has_threads: false,
        })
    }
}

/// Area of the convex hull (m²): by its lower and upper chain (Andrew 1979).
fn hull_area(places: &[DVec2]) -> f64 {
    let mut sorted = places.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut hull: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = hull[..] {
                if (b - a).perp_dot(point - b) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(point);
        }
        let origin = hull.first().copied().unwrap_or_default();
        let pairs = hull.windows(2);
        pairs
            .map(|pair| (pair[0] - origin).perp_dot(pair[1] - origin))
            .sum::<f64>()
            / 2.0
    };
    chain(&mut sorted.iter().copied()) + chain(&mut sorted.iter().rev().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_is_flat_and_convex_and_one_with_a_hole_or_a_fold_is_not() {
        let square =
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, 0.5, y));
        let faces = [[0, 2, 1], [0, 3, 2]];
        let flat = Flat::find(&square, &faces, 1.0).expect("it is flat");
        assert!((flat.places[0].distance(flat.places[2]) - 2.0_f64.sqrt()).abs() < 1e-12);
        // A quarter is missing.
        assert_eq!(Flat::find(&square, &faces, 0.75), None);
        let mut folded = square;
        folded[2].y = 0.6;
        assert_eq!(Flat::find(&folded, &faces, 1.0), None);
        assert_eq!(Flat::find(&square[..2], &[], 0.0), None);
    }

    #[test]
    fn the_hull_of_a_star_is_larger_than_it_is() {
        let places: Vec<DVec2> = (0..10)
            .map(|tip| {
                let radius = if tip % 2 == 0 { 1.0 } else { 0.4 };
                DVec2::from_angle(f64::from(tip) * std::f64::consts::TAU / 10.0) * radius
            })
            .collect();
        let pentagon = 2.5 * (std::f64::consts::TAU / 5.0).sin();
        assert!((hull_area(&places) - pentagon).abs() < 1e-12);
    }
}
