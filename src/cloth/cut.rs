//! Cuts through a cloth.

use bevy::math::{DVec3, Vec3};

use super::{particles::ClothParticles, surface::Surface};

/// The area that a blade sweeps: two triangles, in the cloth's frame (m).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cut {
    triangles: [[DVec3; 3]; 2],
    low: DVec3,
    high: DVec3,
}

impl Cut {
    /// Of a straight blade that goes from two ends to two others.
    pub fn new(from: [Vec3; 2], to: [Vec3; 2]) -> Self {
        let ([a, b], [c, d]) = (from.map(Vec3::as_dvec3), to.map(Vec3::as_dvec3));
        Self {
            triangles: [[a, b, d], [a, d, c]],
            low: a.min(b).min(c.min(d)),
            high: a.max(b).max(c.max(d)),
        }
    }

    /// The edges of the whole surface between faces that the cut parts: it crosses the way from the middle of one to the
    /// middle of the edge and on to the middle of the other an odd number of times.
    pub fn edges(&self, surface: &Surface, particles: &ClothParticles) -> Vec<[u32; 2]> {
        let mut edges = Vec::new();
        if !(self.low.is_finite() && self.high.is_finite()) {
            return edges;
        }
        let places: Vec<DVec3> = particles.positions().map(Vec3::as_dvec3).collect();
        let middle = |face: [u32; 3]| surface.middle_of(face, &places);
        surface.for_each_fold(|ends, [one, other]| {
            let [a, b] = ends.map(|end| places[end as usize]);
            let way = [middle(one), (a + b) / 2.0, middle(other)];
            let [low, high] = [DVec3::min, DVec3::max].map(|of| of(of(way[0], way[1]), way[2]));
            if high.cmplt(self.low).any() || low.cmpgt(self.high).any() {
                return;
            }
            let pieces = [[way[0], way[1]], [way[1], way[2]]];
            let crossings = pieces.map(|piece| {
                let crossed = self.triangles.iter().filter(|of| crosses(piece, **of));
                crossed.count()
            });
            if crossings.iter().sum::<usize>() % 2 == 1 {
                edges.push(ends.map(|end| surface.origin_of(end)));
            }
        });
        edges
    }
}

/// Whether a segment goes through a triangle. Of two triangles or segments with a common end, exactly one is crossed there.
fn crosses([from, to]: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> bool {
    let normal = (b - a).cross(c - a);
    let [above, below] = [from, to].map(|end| (end - a).dot(normal) > 0.0);
    if above == below {
        return false;
    }
    let direction = to - from;
    let side = |p: DVec3, q: DVec3| direction.dot((p - from).cross(q - from)) > 0.0;
    // Which side an edge is on must not depend on its direction.
    let sides = [[a, b], [b, c], [c, a]].map(|[p, q]| match is_before(p, q) {
        true => side(p, q),
        false => !side(q, p),
    });
    sides[0] == sides[1] && sides[1] == sides[2]
}

/// An order of points.
fn is_before(p: DVec3, q: DVec3) -> bool {
    let axes = p.to_array().into_iter().zip(q.to_array());
    let mut orders = axes.map(|(p, q)| p.total_cmp(&q));
    let order = orders.find(|order| order.is_ne());
    order.is_some_and(std::cmp::Ordering::is_lt)
}
