//! k-DOPs (Klosowski et al. 1998): polytopes between pairs of parallel planes with fixed directions.

use bevy::math::{Vec3, Vec3A, bounding::Aabb3d};

use super::{
    aabb::unite_slab,
    bounding::Volume,
    slabs::{self, Slab},
};
use crate::{
    cloth::{LANES, Lanes, MapInline, View, X, Y, Z, larger, smaller},
    hierarchy::probe::{Core, Probe},
};

/// Normals of the faces, corners and edges of a cube.
const AXES: [[f32; 3]; 13] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [1.0, 1.0, -1.0],
    [1.0, -1.0, 1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, 1.0],
    [0.0, 1.0, -1.0],
];

/// A polytope between `N` pairs of parallel planes: a 14-DOP has 7, an 18-DOP 9, a 26-DOP 13.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KDop<const N: usize> {
    low: [f32; N],
    high: [f32; N],
}

impl<const N: usize> KDop<N> {
    /// An 18-DOP cuts edges and keeps corners.
    #[inline(always)]
    const fn axis(at: usize) -> [f32; 3] {
        AXES[if N == 9 && at >= 3 { at + 4 } else { at }]
    }

    /// Its extent along each axis: the axis, and the minimum and maximum of the dot product with it (m).
    pub fn slabs(&self) -> impl Iterator<Item = (Vec3, f32, f32)> + '_ {
        (0..N).map(|at| (Self::axis(at).into(), self.low[at], self.high[at]))
    }

    /// The corners of each face, in order; faces with fewer than three are left out.
    pub fn faces(&self) -> Vec<Vec<Vec3>> {
        let sides = |(axis, low, high): (Vec3, f32, f32)| [(axis, high), (-axis, -low)];
        let planes = || self.slabs().flat_map(sides);
        let extent = largest(self.high.iter().chain(&self.low));
        let slack = extent * 1.0e-5;
        let face = |(normal, distance): (Vec3, f32)| {
            // A square of the plane larger than everything, cut by every other plane.
            let (u, v) = (normal / normal.length()).any_orthonormal_pair();
            let middle = normal * (distance / normal.length_squared());
            let size = 4.0 * extent + 1.0;
            let corners = [u + v, v - u, -u - v, u - v];
            let mut corners = corners.map(|corner| middle + corner * size).to_vec();
            for (normal, distance) in planes().filter(|other| *other != (normal, distance)) {
                corners = cut(&corners, normal, distance + slack);
            }
            corners
        };
        let mut faces: Vec<Vec<Vec3>> = planes().map(face).collect();
        faces.retain(|corners| corners.len() > 2);
        faces
    }

    fn size(&self) -> f32 {
        3.0 * largest(self.low[..3].iter().chain(&self.high[..3]))
    }
}

/// The largest of these numbers, without their signs.
fn largest<'a>(numbers: impl Iterator<Item = &'a f32>) -> f32 {
    numbers.fold(0.0_f32, |most, each| most.max(each.abs()))
}

/// The part of a convex polygon behind a plane (Sutherland and Hodgman 1974).
fn cut(corners: &[Vec3], normal: Vec3, distance: f32) -> Vec<Vec3> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (index, &corner) in corners.iter().enumerate() {
        let next = corners[(index + 1) % corners.len()];
        let (before, after) = (corner.dot(normal) - distance, next.dot(normal) - distance);
        if before <= 0.0 {
            kept.push(corner);
        }
        if (before <= 0.0) != (after <= 0.0) {
            kept.push(corner.lerp(next, before / (before - after)));
        }
    }
    kept
}

impl<const N: usize> Volume for KDop<N> {
    /// Minimum and maximum of the dot products.
    type Lanes = [[Lanes; N]; 2];

    const UNSET: Self::Lanes = [[[0.0; LANES]; N]; 2];

    #[inline(always)]
    fn around(centre: Vec3, radius: f32) -> Self {
        let (mut low, mut high) = ([0.0; N], [0.0; N]);
        for at in 0..N {
            let axis = Vec3::from(Self::axis(at));
            let half = radius * axis.length() * (1.0 + 2.0 * f32::EPSILON)
                + centre.abs().dot(axis.abs()) * 2.0 * f32::EPSILON;
            let middle = centre.dot(axis);
            (low[at], high[at]) = (middle - half, middle + half);
        }
        Self { low, high }
    }

    fn unite(children: [&Self; 4]) -> Self {
        let low = |at: usize| children.map(|child| child.low[at]);
        let high = |at: usize| children.map(|child| child.high[at]);
        let (none, all) = (f32::INFINITY, f32::NEG_INFINITY);
        Self {
            low: std::array::from_fn(|at| low(at).into_iter().fold(none, f32::min)),
            high: std::array::from_fn(|at| high(at).into_iter().fold(all, f32::max)),
        }
    }

    #[inline(always)]
    fn may_reach(&self, probe: &Probe, reach: f32) -> bool {
        // Its first three pairs of planes form a box, whose test is tighter near its edges.
        let corner = |side: &[f32; N]| Vec3A::new(side[0], side[1], side[2]);
        let aabb = Aabb3d {
            min: corner(&self.low),
            max: corner(&self.high),
        };
        if !aabb.may_reach(probe, reach) {
            return false;
        }
        if let Core::HalfSpace { .. } = probe.core {
            return true;
        }
        let slabs = self.slabs().skip(3);
        let slabs = slabs.map(|(axis, low, high)| Slab { axis, low, high });
        slabs::may_reach(slabs, probe, reach, self.size())
    }

    fn faces(&self) -> Vec<Vec<Vec3>> {
        Self::faces(self)
    }

    fn inflated(&self, radius: f32) -> Self {
        let reach = |at: usize| radius * Vec3::from(Self::axis(at)).length();
        Self {
            low: std::array::from_fn(|at| self.low[at] - reach(at)),
            high: std::array::from_fn(|at| self.high[at] + reach(at)),
        }
    }

    #[inline(always)]
    fn of_particles(children: [&View; 4], [low, high]: &mut Self::Lanes) {
        let [a, b, c, d] = children;
        let mut slack: Lanes = [0.0; LANES];
        for l in 0..LANES {
            let size =
                |child: &View| (child[X + l].abs() + child[Y + l].abs()) + child[Z + l].abs();
            slack[l] =
                larger(larger(size(a), size(b)), larger(size(c), size(d))) * (2.0 * f32::EPSILON);
        }
        for (at, (low, high)) in low.iter_mut().zip(high).enumerate() {
            let [x, y, z] = Self::axis(at);
            for l in 0..LANES {
                let product =
                    |child: &View| (x * child[X + l] + y * child[Y + l]) + z * child[Z + l];
                let [a, b, c, d] = [product(a), product(b), product(c), product(d)];
                low[l] = smaller(smaller(a, b), smaller(c, d)) - slack[l];
                high[l] = larger(larger(a, b), larger(c, d)) + slack[l];
            }
        }
    }

    #[inline(always)]
    fn unite_lanes(children: [&Self::Lanes; 4], [low, high]: &mut Self::Lanes) {
        for (at, (low, high)) in low.iter_mut().zip(high).enumerate() {
            unite_slab(
                children.map_inline(|child| (&child[0][at], &child[1][at])),
                low,
                high,
            );
        }
    }

    #[inline(always)]
    fn lane(lanes: &Self::Lanes, lane: usize) -> Self {
        Self {
            low: std::array::from_fn(|at| lanes[0][at][lane]),
            high: std::array::from_fn(|at| lanes[1][at][lane]),
        }
    }

    fn set_lane(lanes: &mut Self::Lanes, lane: usize, volume: Self) {
        for (side, values) in lanes.iter_mut().zip([volume.low, volume.high]) {
            for (axis, value) in side.iter_mut().zip(values) {
                axis[lane] = value;
            }
        }
    }
}
