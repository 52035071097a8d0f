//! Counts intersecting triangles of cloths: by brute force, in f64.

use bevy::math::{DVec3, Vec3};

use crate::cloth::Surface;

/// Counts pairs of intersecting triangles, for surfaces whose particles are at these positions (m) in a common frame.
/// Triangles of one surface that share a particle do not count. For tests and charts: it takes milliseconds.
pub fn intersections(cloths: &[(&Surface, Vec<Vec3>)]) -> usize {
    let mut triangles: Vec<Triangle> = cloths
        .iter()
        .enumerate()
        .flat_map(|(cloth, (surface, places))| {
            let faces = surface.triangles().iter();
            faces.map(move |&particles| Triangle {
                cloth,
                particles,
                corners: particles.map(|particle| places[particle as usize].as_dvec3()),
            })
        })
        .collect();
    triangles.sort_by(|a, b| a.low().x.total_cmp(&b.low().x));
    let mut count = 0;
    for (index, a) in triangles.iter().enumerate() {
        let (low, high) = (a.low(), a.high());
        let near = triangles[index + 1..]
            .iter()
            .take_while(|b| b.low().x <= high.x);
        let may_meet = |b: &&Triangle| {
            let (from, to) = (b.low(), b.high());
            from.y <= high.y && to.y >= low.y && from.z <= high.z && to.z >= low.z
        };
        count += near
            .filter(may_meet)
            .filter(|b| !a.is_beside(b) && a.intersects(b))
            .count();
    }
    count
}

#[derive(Debug, Clone, Copy)]
struct Triangle {
    cloth: usize,
    particles: [u32; 3],
    corners: [DVec3; 3],
}

impl Triangle {
    fn low(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        a.min(b).min(c)
    }

    fn high(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        a.max(b).max(c)
    }

    /// Whether both share a corner.
    fn is_beside(&self, other: &Self) -> bool {
        let own = &self.particles;
        self.cloth == other.cloth && own.iter().any(|corner| other.particles.contains(corner))
    }

    /// Whether an edge of one passes through the other.
    fn intersects(&self, other: &Self) -> bool {
        let pass = |a: &Self, b: &Self| {
            let [p, q, r] = a.corners;
            let mut edges = [[p, q], [q, r], [r, p]].into_iter();
            edges.any(|edge| passes(edge, b.corners))
        };
        pass(self, other) || pass(other, self)
    }
}

/// Whether an edge passes through a face: its ends are on both sides, and the face's edges all pass it on one side. In
/// f64, as edges of a flat sheet lie in the planes of its faces but for rounding.
pub(super) fn passes([p, q]: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> bool {
    let volume = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (b - a).cross(c - a).dot(d - a);
    if volume(a, b, c, p) * volume(a, b, c, q) >= 0.0 {
        return false;
    }
    let sides = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0)
}
