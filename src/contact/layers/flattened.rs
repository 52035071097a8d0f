//! A part of a surface laid flat: proof that it does not touch itself.

use bevy::math::{Vec3, Vec3A};
use multiversion::multiversion;

use super::lanes::Eight;
use crate::cloth::{MapInline, larger, smaller};

/// Most particles of a window.
pub(super) const MOST_PARTICLES: usize = 256;

/// Part of the largest gradient by which a bound is lowered: more than the rounding errors, and than what is missing at a border.
pub(super) const LOWERED: f32 = 5.0e-3;

/// A part of a surface, projected at rest onto its plane. Its faces cover the convex hull of its points there, each
/// point once.
///
/// # The proof that it does not touch itself
/// The straight line between two points u and v of the plane stays within the faces. Along it the surface follows the gradients
/// F = ∂x/∂u of the faces, 3 × 2. R has two orthonormal columns:
///
/// ```text
///   x(u) − x(v) = ∫ F d |u − v| dt                            d: direction from v to u
///   (x(u) − x(v)) · R d ≥ λ |u − v|                           λ: smallest eigenvalue of the symmetric part of Rᵀ F, of all faces
///   |x(u) − x(v)| ≥ λ |u − v|
/// ```
///
/// Any such R will do: a poor one only lowers λ. That of the middle of all F is a good one. What is flat at rest and bends
/// by less than a right angle to either side of it keeps its points apart. A cone of normals says nothing about a patch whose outline
/// crosses itself; this bound covers that, too.
///
/// Lines may leave the faces by [a little](super::flattening), where the border is not quite convex.
#[derive(Debug)]
pub(super) struct Flattened {
    pub particles: Vec<u32>,
    pub faces: Vec<EightFaces>,
    /// Smallest height of a face in the plane (m): the least distance there of any two features without a common particle.
    pub closest: f32,
    /// Largest ratio of a distance along the surface at rest to that in the plane.
    pub ratio: f32,
}

/// Eight faces: the places of their corners among the particles, and the inverse of the matrix of their edges in the plane (1/m).
/// The last face of a window fills the rest.
#[derive(Debug, Clone)]
pub(super) struct EightFaces {
    pub corners: [[u8; 8]; 3],
    pub inverse: [Eight; 4],
}

/// Memory of a measurement, to be used again.
#[derive(Debug, Default, Clone)]
pub(super) struct Scratch {
    places: Vec<Vec3A>,
    gradients: Vec<[Eight; 6]>,
}

impl Flattened {
    /// λ: a lower bound of the ratio of any two points' distance to that in the plane; 0 or less where they may meet.
    pub fn unfolded(&self, places: &[Vec3A], scratch: &mut Scratch) -> f32 {
        scratch.places.resize(MOST_PARTICLES, Vec3A::ZERO);
        for (at, &particle) in scratch.places.iter_mut().zip(&self.particles) {
            *at = places[particle as usize];
        }
        least_eigenvalue(&self.faces, scratch)
    }

    /// A lower bound of the distance of any two features without a common particle, less that at which they touch (m), from
    /// [λ](Self::unfolded); any number below 0 where they may touch. They touch at the `thickness`, or at a part `of_rest` of their
    /// distance at rest if that is less.
    pub fn slack(&self, unfolded: f32, thickness: f32, of_rest: f32) -> f32 {
        let of_rest = of_rest * self.ratio;
        let allowed = thickness.min(of_rest * self.closest);
        // Elsewhere features that are farther apart in the plane may have less.
        if unfolded >= of_rest || allowed == thickness {
            unfolded * self.closest - allowed
        } else {
            f32::NEG_INFINITY
        }
    }
}

#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
fn least_eigenvalue(faces: &[EightFaces], scratch: &mut Scratch) -> f32 {
    let Scratch { places, gradients } = scratch;
    let Some(places) = places.first_chunk() else {
        return f32::NEG_INFINITY;
    };
    gradients.clear();
    let mut low = [[f32::INFINITY; 8]; 6];
    let mut high = [[f32::NEG_INFINITY; 8]; 6];
    for eight in faces {
        let gradient = gradient(eight, places);
        for of in 0..6 {
            for l in 0..8 {
                let number = gradient[of][l];
                low[of][l] = smaller(number, low[of][l]);
                high[of][l] = larger(number, high[of][l]);
            }
        }
        gradients.push(gradient);
    }
    let mut middle = [0.0; 6];
    for of in 0..6 {
        let low = low[of].iter().copied().fold(f32::INFINITY, f32::min);
        let high = high[of].iter().copied().fold(f32::NEG_INFINITY, f32::max);
        middle[of] = 0.5 * (low + high);
    }
    let first = Vec3::new(middle[0], middle[1], middle[2]);
    let second = Vec3::new(middle[3], middle[4], middle[5]);
    let Some([first, second]) = rotation(first, second) else {
        return f32::NEG_INFINITY;
    };
    let (first, second) = (first.to_array(), second.to_array());
    let mut least = [f32::INFINITY; 8];
    let mut sums = [0.0; 8];
    for gradient in gradients.iter() {
        for l in 0..8 {
            let dot = |along: &[f32; 3], from: usize| {
                along[0] * gradient[from][l]
                    + along[1] * gradient[from + 1][l]
                    + along[2] * gradient[from + 2][l]
            };
            let (a, d) = (dot(&first, 0), dot(&second, 3));
            let mixed = 0.5 * (dot(&first, 3) + dot(&second, 0));
            let half = 0.5 * (a - d);
            let number = 0.5 * (a + d) - (half * half + mixed * mixed).sqrt();
            least[l] = smaller(number, least[l]);
            sums[l] += number;
        }
    }
    let sum = sums.iter().sum::<f32>();
    if !sum.is_finite() {
        // NaN, which comparisons pass over.
        return f32::NEG_INFINITY;
    }
    let each = low.iter().chain(&high).flatten();
    let largest = each.fold(0.0_f32, |most, of| most.max(of.abs()));
    least.into_iter().fold(f32::INFINITY, f32::min) - LOWERED * largest
}

/// The gradients of eight faces: the two columns of F, by axis.
#[inline(always)]
fn gradient(eight: &EightFaces, places: &[Vec3A; MOST_PARTICLES]) -> [Eight; 6] {
    let mut edges = [[0.0; 8]; 6];
    for l in 0..8 {
        let [a, b, c] = (eight.corners).map_inline(|corner| places[usize::from(corner[l])]);
        let (first, second) = ((b - a).to_array(), (c - a).to_array());
        for axis in 0..3 {
            edges[axis][l] = first[axis];
            edges[3 + axis][l] = second[axis];
        }
    }
    let inverse = &eight.inverse;
    let mut gradient = [[0.0; 8]; 6];
    for axis in 0..3 {
        for l in 0..8 {
            let (first, second) = (edges[axis][l], edges[3 + axis][l]);
            gradient[axis][l] = first * inverse[0][l] + second * inverse[1][l];
            gradient[3 + axis][l] = first * inverse[2][l] + second * inverse[3][l];
        }
    }
    gradient
}

/// The rotation of two columns, F (FᵀF)^(−1/2); `None` if one is zero. Its columns are orthonormal, however F rounds where it is nearly
/// singular.
fn rotation(first: Vec3, second: Vec3) -> Option<[Vec3; 2]> {
    let (a, d, mixed) = (
        first.length_squared(),
        second.length_squared(),
        first.dot(second),
    );
    // The square root of a 2 × 2 matrix by Cayley and Hamilton, inverted. Its trace and determinant are left to normalizing.
    let root = (a * d - mixed * mixed).max(0.0).sqrt();
    let across = (first * (d + root) - second * mixed).try_normalize()?;
    let down = second * (a + root) - first * mixed;
    let down = down.reject_from_normalized(across).try_normalize()?;
    Some([across, down])
}
