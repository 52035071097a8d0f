//! Flat and convex surfaces.

use bevy::math::{DVec2, DVec3, Vec3};

/// Relative tolerances of a flat surface: a particle's distance from the plane, and the excess area of the convex hull.
const FLAT: f64 = 1.0e-5;

/// A surface in its plane, if it is flat and convex.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Flat {
    /// Position of each particle in the plane (m).
    pub places: Vec<DVec2>,
    /// Whether stretch springs run along the plane's axes only, as chains.
    pub has_chains: bool,
}

impl Flat {
    /// Vector from one particle to another in the plane (m).
    pub fn between(&self, a: usize, b: usize) -> [f32; 2] {
        let apart = (self.places[a] - self.places[b]).abs();
        apart.as_vec2().to_array()
    }

    /// The plane of particles at `rest` (m) with faces of a total `area` (m²), if they are flat and convex. There may
    /// be no hole, bay, slit, fold or second piece: all faces face one side, the convex hull has the same area, and
    /// every border particle is on the hull.
    pub fn find(rest: &[Vec3], faces: &[[u32; 3]], is_border: &[bool], area: f32) -> Option<Self> {
        let at = |particle: u32| rest[particle as usize].as_dvec3();
        let normal_of = |&[a, b, c]: &[u32; 3]| (at(b) - at(a)).cross(at(c) - at(a));
        let normal = faces.iter().map(normal_of).sum::<DVec3>().try_normalize()?;
        if faces.iter().any(|face| normal_of(face).dot(normal) < 0.0) {
            return None;
        }
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
        let hull = hull(&places);
        let area = f64::from(area);
        let is_whole = (hull_area(&hull) - area).abs() <= 100.0 * FLAT * area;
        if off > FLAT * size || !is_whole {
            return None;
        }
        let sides = || hull.windows(2).map(|side| [side[0], side[1]]);
        let is_on_hull = |place: DVec2| {
            sides().any(|[from, to]| {
                let away = (to - from).normalize_or_zero().perp_dot(place - from);
                away.abs() <= 10.0 * FLAT * size
            })
        };
        let mut borders = places.iter().zip(is_border);
        let has_chains = false;
        let is_convex = borders.all(|(place, is_border)| !is_border || is_on_hull(*place));
        is_convex.then_some(Self { places, has_chains })
    }
}

/// The convex hull as a closed polygon: its lower chain, then its upper chain (Andrew 1979).
fn hull(places: &[DVec2]) -> Vec<DVec2> {
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
        hull
    };
    let mut lower = chain(&mut sorted.iter().copied());
    lower.extend(chain(&mut sorted.iter().rev().copied()).into_iter().skip(1));
    lower
}

/// Area of a closed polygon (m²).
fn hull_area(hull: &[DVec2]) -> f64 {
    let origin = hull.first().copied().unwrap_or_default();
    let area = |pair: &[DVec2]| (pair[0] - origin).perp_dot(pair[1] - origin);
    hull.windows(2).map(area).sum::<f64>() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_is_flat_and_convex_and_one_with_a_hole_or_a_fold_is_not() {
        let square =
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, 0.5, y));
        let faces = [[0, 2, 1], [0, 3, 2]];
        let flat = Flat::find(&square, &faces, &[true; 4], 1.0).expect("it is flat");
        assert!((flat.places[0].distance(flat.places[2]) - 2.0_f64.sqrt()).abs() < 1e-12);
        // A quarter is missing.
        assert_eq!(Flat::find(&square, &faces, &[true; 4], 0.75), None);
        let mut folded = square;
        folded[2].y = 0.6;
        assert_eq!(Flat::find(&folded, &faces, &[true; 4], 1.0), None);
        assert_eq!(Flat::find(&square[..2], &[], &[], 0.0), None);
    }

    /// A slit to the middle of a square has no area, and the way around its end is longer than a straight line; two pieces
    /// side by side, or a fold onto itself, are no convex whole either.
    #[test]
    fn a_slit_a_second_piece_and_a_fold_are_found() {
        let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let slit = [
            at(0.0, 0.0),
            at(2.0, 0.0),
            at(2.0, 2.0),
            at(1.0, 2.0),
            at(1.0, 2.0),
            at(0.0, 2.0),
            at(1.0, 1.0),
        ];
        let faces = [[0, 1, 6], [1, 2, 6], [2, 3, 6], [4, 5, 6], [5, 0, 6]];
        assert_eq!(Flat::find(&slit, &faces, &[true; 7], 4.0), None);
        let pieces = [
            at(0.0, 0.0),
            at(1.0, 0.0),
            at(0.0, 1.0),
            at(1.0, 0.0),
            at(1.0, 1.0),
            at(0.0, 1.0),
        ];
        let faces = [[0, 1, 2], [3, 4, 5]];
        let pieces = Flat::find(&pieces, &faces, &[true; 6], 1.0);
        assert!(
            pieces.is_some(),
            "pieces that touch count as two by the surface"
        );
        let folded = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(0.5, 0.5)];
        let faces = [[0, 1, 3], [0, 2, 3], [0, 1, 2]];
        assert_eq!(Flat::find(&folded, &faces, &[true; 4], 1.0), None);
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
        assert!((hull_area(&hull(&places)) - pentagon).abs() < 1e-12);
    }
}
