//! Vertices bound to faces, eight at a time.

use bevy::math::Vec3;
use multiversion::multiversion;

use crate::cloth::lanes::{LANES, Lanes};

/// Valid range of a normal's or direction's squared length (m²). Outside it, rounding has destroyed the vector: the
/// face is crushed or folded.
const SQUARES: std::ops::Range<f32> = 1.0e-24..1.0e24;

/// A vertex bound to a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bound {
    pub corners: [u32; 3],
    /// Barycentric coordinates of its point.
    pub weights: [f32; 3],
    /// α and β.
    pub along: [f32; 2],
    /// The offset from its point to the vertex, its normal and its tangent, in its frame.
    pub inside: [Vec3; 3],
}

/// Eight bound vertices, as a structure of arrays. Unused lanes repeat the first vertex.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Eight {
    corners: [[u32; LANES]; 3],
    weights: [Lanes; 3],
    along: [Lanes; 2],
    inside: [[Lanes; 3]; 3],
}

impl Eight {
    /// From one to eight vertices.
    pub fn of(bound: &[Bound]) -> Self {
        let each = |lane: usize| bound.get(lane).unwrap_or(&bound[0]);
        let lanes = |of: &dyn Fn(&Bound) -> f32| std::array::from_fn(|lane| of(each(lane)));
        Self {
            corners: std::array::from_fn(|at| std::array::from_fn(|lane| each(lane).corners[at])),
            weights: std::array::from_fn(|at| lanes(&|bound| bound.weights[at])),
            along: std::array::from_fn(|at| lanes(&|bound| bound.along[at])),
            inside: std::array::from_fn(|vector| {
                std::array::from_fn(|axis| lanes(&|bound| bound.inside[vector][axis]))
            }),
        }
    }

    /// The vertex of a lane.
    pub fn lane(&self, lane: usize) -> Bound {
        let inside = |vector: usize| Vec3::from(self.inside[vector].map(|axis| axis[lane]));
        Bound {
            corners: self.corners.map(|corner| corner[lane]),
            weights: self.weights.map(|weight| weight[lane]),
            along: self.along.map(|part| part[lane]),
            inside: [0, 1, 2].map(inside),
        }
    }
}

/// The position and frame of a vertex's point.
pub(super) struct Frame {
    pub point: Vec3,
    axes: [Vec3; 3],
}

impl Frame {
    /// The frame between three particles, from their normals.
    pub fn new(places: [Vec3; 3], normals: [Vec3; 3], weights: [f32; 3], along: [f32; 2]) -> Self {
        let blend = |[a, b, c]: [Vec3; 3]| a * weights[0] + b * weights[1] + c * weights[2];
        let [ab, ac] = [places[1] - places[0], places[2] - places[0]];
        let is_known = |vector: &Vec3| SQUARES.contains(&vector.length_squared());
        // Opposite normals cancel in a folded face: then its own normal is used.
        let normal = Some(blend(normals)).filter(is_known).map(Vec3::normalize);
        let normal = normal.unwrap_or_else(|| ab.cross(ac).normalize_or(Vec3::Y));
        let direction = ab * along[0] + ac * along[1];
        let direction = direction - normal * normal.dot(direction);
        let direction = Some(direction).filter(is_known).map(Vec3::normalize);
        let direction = direction.unwrap_or_else(|| normal.any_orthonormal_vector());
        Self {
            point: blend(places),
            axes: [direction, normal.cross(direction), normal],
        }
    }

    /// Transforms a vector from the frame.
    fn out(&self, inside: Vec3) -> Vec3 {
        self.axes[0] * inside.x + self.axes[1] * inside.y + self.axes[2] * inside.z
    }

    /// Transforms a vector into the frame.
    pub fn inside(&self, out: Vec3) -> Vec3 {
        Vec3::from(self.axes.map(|axis| axis.dot(out)))
    }
}

/// Makes a vector of length 1, and returns the square of its length.
#[inline(always)]
fn normalize(vector: &mut [f32; 3]) -> f32 {
    let [x, y, z] = *vector;
    let square = x * x + y * y + z * z;
    let inverse = 1.0 / square.sqrt();
    *vector = vector.map(|of| of * inverse);
    square
}

/// Writes the vertices' positions, normals and tangents (x, y and z), as far as there is room. `around` are the
/// particles' positions and normals.
#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
pub(super) fn write_eights(
    eights: &[Eight],
    around: [&[Vec3]; 2],
    positions: &mut [[f32; 3]],
    normals: &mut [[f32; 3]],
    tangents: &mut [[f32; 4]],
) {
    for (index, eight) in eights.iter().enumerate() {
        // The position and the normal of each corner.
        let mut at = [[[[0.0; LANES]; 3]; 3]; 2];
        for (at, around) in at.iter_mut().zip(around) {
            for (at, corners) in at.iter_mut().zip(&eight.corners) {
                for lane in 0..LANES {
                    let vector = around[corners[lane] as usize];
                    (at[0][lane], at[1][lane], at[2][lane]) = (vector.x, vector.y, vector.z);
                }
            }
        }
        let [[a, b, c], [na, nb, nc]] = &at;
        let mut out = [[[0.0; LANES]; 3]; 3];
        let mut squares = [[0.0; LANES]; 2];
        for l in 0..LANES {
            let [u, v, w] = [
                eight.weights[0][l],
                eight.weights[1][l],
                eight.weights[2][l],
            ];
            let (mut point, mut n, mut t) = ([0.0; 3], [0.0; 3], [0.0; 3]);
            for x in 0..3 {
                point[x] = a[x][l] * u + b[x][l] * v + c[x][l] * w;
                n[x] = na[x][l] * u + nb[x][l] * v + nc[x][l] * w;
                t[x] = (b[x][l] - a[x][l]) * eight.along[0][l]
                    + (c[x][l] - a[x][l]) * eight.along[1][l];
            }
            squares[0][l] = normalize(&mut n);
            let along = n[0] * t[0] + n[1] * t[1] + n[2] * t[2];
            for x in 0..3 {
                t[x] -= n[x] * along;
            }
            squares[1][l] = normalize(&mut t);
            let s = [
                n[1] * t[2] - n[2] * t[1],
                n[2] * t[0] - n[0] * t[2],
                n[0] * t[1] - n[1] * t[0],
            ];
            for (out, inside) in out.iter_mut().zip(&eight.inside) {
                for x in 0..3 {
                    out[x][l] = t[x] * inside[0][l] + s[x] * inside[1][l] + n[x] * inside[2][l];
                }
            }
            for x in 0..3 {
                out[0][x][l] += point[x];
            }
        }
        for lane in 0..LANES {
            if !(SQUARES.contains(&squares[0][lane]) && SQUARES.contains(&squares[1][lane])) {
                let one = one(&eight.lane(lane), around);
                for (out, one) in out.iter_mut().zip(one) {
                    (out[0][lane], out[1][lane], out[2][lane]) = (one.x, one.y, one.z);
                }
            }
        }
        let [place, normal, tangent] = &out;
        let first = index * LANES;
        for (lane, out) in positions.iter_mut().skip(first).take(LANES).enumerate() {
            *out = [place[0][lane], place[1][lane], place[2][lane]];
        }
        for (lane, out) in normals.iter_mut().skip(first).take(LANES).enumerate() {
            *out = [normal[0][lane], normal[1][lane], normal[2][lane]];
        }
        for (lane, out) in tangents.iter_mut().skip(first).take(LANES).enumerate() {
            [out[0], out[1], out[2]] = [tangent[0][lane], tangent[1][lane], tangent[2][lane]];
        }
    }
}

/// The vertex, normal and tangent in a crushed face.
#[cold]
#[inline(never)]
fn one(bound: &Bound, [places, normals]: [&[Vec3]; 2]) -> [Vec3; 3] {
    let places = bound.corners.map(|corner| places[corner as usize]);
    let normals = bound.corners.map(|corner| normals[corner as usize]);
    let frame = Frame::new(places, normals, bound.weights, bound.along);
    let [offset, normal, tangent] = bound.inside.map(|inside| frame.out(inside));
    [frame.point + offset, normal, tangent]
}
