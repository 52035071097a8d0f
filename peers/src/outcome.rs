//! What is measured of what a solver has done, alike for all of them.

use bevy::math::DVec3;
use bevy_drape::cloth::SpringKind;

use crate::{
    scene::{Scene, triangles},
    shared::exact::Exact,
};

/// Places of all particles (m).
pub type Places = Vec<[f32; 3]>;

/// What a solver has done with a scene.
pub struct Play {
    /// CPU time of a frame in the mean (ms), of all threads.
    pub ms: f64,
    /// After half a second.
    pub compared: Places,
    /// In each frame of the last second.
    pub last: Vec<Places>,
}

/// What came of it.
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    pub ms: f64,
    /// Of springs along rows and columns in the last second, as parts of their length.
    pub max_stretch: f64,
    pub rms_stretch: f64,
    /// RMS distance from the reference after half a second (m).
    pub off: Option<f64>,
    /// How deep triangles are in the ball, at most, in the last second (m).
    pub depth: Option<f64>,
}

impl Play {
    pub fn outcome(&self, scene: &Scene, reference: Option<&Exact>) -> Outcome {
        let sheet = scene.sheet_of(scene.compliance, 0);
        let threads: Vec<_> = sheet
            .springs
            .iter()
            .filter(|spring| spring.kind == SpringKind::Structural)
            .collect();
        let (mut largest, mut squares, mut count) = (f64::NEG_INFINITY, 0.0, 0.0);
        for places in &self.last {
            for spring in &threads {
                let [a, b] = spring.ends.map(|end| exact(places[end as usize]));
                let stretch = a.distance(b) / f64::from(spring.rest_length) - 1.0;
                // NaN stays.
                if stretch > largest || stretch.is_nan() {
                    largest = stretch;
                }
                squares += stretch * stretch;
                count += 1.0;
            }
        }
        let depth = |radius: f32| {
            let depths = self.last.iter().map(|places| depth(places, radius));
            depths.fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a })
        };
        Outcome {
            ms: self.ms,
            max_stretch: largest,
            rms_stretch: f64::sqrt(squares / count),
            off: reference
                .map(|reference| reference.distance(self.compared.iter().map(|at| exact(*at)))),
            depth: scene.ball.map(depth),
        }
    }
}

fn exact(place: [f32; 3]) -> DVec3 {
    DVec3::from_array(place.map(f64::from))
}

/// How deep the nearest point of all triangles is in a ball around the origin (m), by brute force.
fn depth(places: &Places, radius: f32) -> f64 {
    let nearest = triangles()
        .into_iter()
        .map(|corners| nearest(corners.map(|corner| exact(places[corner as usize]))).length())
        .fold(
            f64::INFINITY,
            |a, b| if b < a || b.is_nan() { b } else { a },
        );
    f64::from(radius) - nearest
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_is_nearer_than_all_others() {
        let mut random = 1_u32;
        let mut next = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(random >> 8) / f64::from(1 << 24) - 0.4
        };
        for _ in 0..500 {
            let corners = [(); 3].map(|()| DVec3::new(next(), next(), next()));
            let found = nearest(corners).length();
            // Points of a fine grid over the triangle: none nearer, and one as near as its width.
            let each = (0..=40).flat_map(|i| (0..=40 - i).map(move |j| [i, j].map(f64::from)));
            let tried = each
                .map(|[i, j]| {
                    let [a, b, c] = corners;
                    (a + (b - a) * (i / 40.0) + (c - a) * (j / 40.0)).length()
                })
                .fold(f64::INFINITY, f64::min);
            assert!(found <= tried + 1e-12, "{found} {tried}");
            assert!(tried <= found + 2.5 / 40.0, "{found} {tried}");
        }
    }
}
