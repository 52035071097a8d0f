//! A part of a surface laid flat: proof that it does not touch itself.

use std::ops::Range;

use bevy::math::{Vec2, Vec3, Vec3A};
use multiversion::multiversion;

use super::lanes::Eight;
use crate::cloth::{ByParticle, MapInline, Surface};

/// Faces that leave the plane by more than the angle of this cosine are not laid flat.
const LEAST_COSINE: f32 = 2.0 / 3.0;

/// Most particles of a window.
const MOST_PARTICLES: usize = 256;

/// Part of a window's size by which what is missing at its border does not count.
const BORDER: f32 = 1.0e-5;

/// Part by which a bound is lowered: more than the rounding errors, and than what is missing at a border.
const ROUNDING: f32 = 1.0e-3;

/// A part of a surface, projected at rest onto its plane. Its faces cover the convex hull of its points there, once.
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
/// So no bend by less than a right angle to either side lets two points meet. A cone of normals says nothing
/// about a patch whose outline crosses itself; this bound covers that, too.
#[derive(Debug)]
pub(super) struct Flattened {
    particles: Vec<u32>,
    faces: Vec<EightFaces>,
    /// Smallest height of a face in the plane (m): the least distance there of any two features without a common particle.
    closest: f32,
    /// Largest ratio of a distance along the surface at rest to that in the plane.
    ratio: f32,
}

/// Eight faces: the places of their corners among the particles, and the inverse of the matrix of their edges in the plane (1/m).
/// The last face of a window fills the rest.
#[derive(Debug, Clone)]
struct EightFaces {
    corners: [[u8; 8]; 3],
    inverse: [Eight; 4],
}

/// What one measurement needs.
#[derive(Debug, Clone)]
pub(super) struct Scratch {
    places: [Vec3A; MOST_PARTICLES],
    gradients: Vec<[Eight; 6]>,
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            places: [Vec3A::ZERO; MOST_PARTICLES],
            gradients: Vec::new(),
        }
    }
}

impl Flattened {
    /// λ: a lower bound of the ratio of any two points' distance to that in the plane; 0 or less where they may meet.
    pub fn unfolded(&self, places: &[Vec3A], scratch: &mut Scratch) -> f32 {
        for (at, &particle) in scratch.places.iter_mut().zip(&self.particles) {
            *at = places[particle as usize];
        }
        least_eigenvalue(&self.faces, scratch)
    }

    /// A lower bound of the distance of any two features without a common particle, less that at which they touch (m), from
    /// [λ](Self::unfolded). They touch at the `thickness`, or at a part `of_rest` of their distance at rest if that is less.
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

    /// Smallest height of a face in the plane (m).
    pub fn closest(&self) -> f32 {
        self.closest
    }
}

#[multiversion(targets("x86_64+avx+avx2"), dispatcher = "direct")]
fn least_eigenvalue(faces: &[EightFaces], scratch: &mut Scratch) -> f32 {
    let Scratch { places, gradients } = scratch;
    gradients.clear();
    let mut low = [[f32::INFINITY; 8]; 6];
    let mut high = [[f32::NEG_INFINITY; 8]; 6];
    for eight in faces {
        let mut edges = [[0.0; 8]; 6];
        for l in 0..8 {
            let [a, b, c] = eight
                .corners
                .map_inline(|corner| places[usize::from(corner[l])]);
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
        for of in 0..6 {
            for l in 0..8 {
                let number = gradient[of][l];
                low[of][l] = if number < low[of][l] {
                    number
                } else {
                    low[of][l]
                };
                high[of][l] = if number > high[of][l] {
                    number
                } else {
                    high[of][l]
                };
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
            least[l] = if number < least[l] { number } else { least[l] };
            sums[l] += number;
        }
    }
    let sum = sums.iter().sum::<f32>();
    if !sum.is_finite() {
        // Also without faces, and for NaN.
        return f32::NEG_INFINITY;
    }
    let largest = middle.iter().fold(0.0_f32, |most, of| most.max(of.abs()));
    least.into_iter().fold(f32::INFINITY, f32::min) - ROUNDING * largest
}

/// The rotation of two columns: F (FᵀF)^(−1/2); `None` if they are parallel.
fn rotation(first: Vec3, second: Vec3) -> Option<[Vec3; 2]> {
    let (a, d, mixed) = (
        first.length_squared(),
        second.length_squared(),
        first.dot(second),
    );
    // The square root of a 2 × 2 matrix by Cayley and Hamilton.
    let root = (a * d - mixed * mixed).max(0.0).sqrt();
    let trace = (a + d + 2.0 * root).sqrt();
    let [a, d, mixed] = [a + root, d + root, mixed].map(|of| of / trace);
    let inverse = 1.0 / (a * d - mixed * mixed);
    let columns = [
        (first * d - second * mixed) * inverse,
        (second * a - first * mixed) * inverse,
    ];
    columns.iter().all(|of| of.is_finite()).then_some(columns)
}

/// Lays parts of a surface flat.
pub(super) struct Flattening<'a> {
    surface: &'a Surface,
    /// The faces around each particle.
    around: ByParticle<u32>,
    /// The last part that each face and each particle was in, and the particle's place there.
    last_of_face: Vec<u32>,
    last_of_particle: Vec<[u32; 2]>,
    part: u32,
    faces: Vec<u32>,
}

impl<'a> Flattening<'a> {
    pub fn new(surface: &'a Surface) -> Self {
        let faces = surface.faces().all();
        let each = faces.iter().zip(0..);
        Self {
            surface,
            around: ByParticle::new(surface.len(), || {
                let each = each.clone();
                each.flat_map(|(corners, face)| corners.iter().map(move |&of| (of, face)))
            }),
            last_of_face: vec![0; faces.len()],
            last_of_particle: vec![[0; 2]; surface.len()],
            part: 0,
            faces: Vec::new(),
        }
    }

    /// Lays these faces flat, with those between them; `None` if they are not flat enough, or not whole.
    pub fn flatten(&mut self, of: impl Iterator<Item = [u32; 3]>) -> Option<Flattened> {
        self.part += 1;
        self.faces.clear();
        let (rest, all) = (self.surface.rest_positions(), self.surface.faces().all());
        let mut normal = Vec3::ZERO;
        let corners = |face: [u32; 3]| face.map(|corner| rest[corner as usize]);
        for face in of {
            let [a, b, c] = corners(face);
            normal += (b - a).cross(c - a);
            let around = self.around.of(face[0]).iter();
            let index = *around.clone().find(|&&index| all[index as usize] == face)?;
            self.last_of_face[index as usize] = self.part;
            self.faces.push(index);
        }
        let normal = normal.try_normalize()?;
        let [across, down] = normal.any_orthonormal_pair().into();
        let origin = rest[all[*self.faces.first()? as usize][0] as usize];
        let place = |particle: u32| {
            let at = rest[particle as usize] - origin;
            Vec2::new(across.dot(at), down.dot(at))
        };
        let points = self.faces.iter().flat_map(|&face| all[face as usize]);
        let hull = Hull::of(points.map(place).collect());
        self.fill(&hull, place)?;
        self.laid(place, normal)
    }

    /// Adds the faces between those that there are, until they cover their hull; `None` if some are missing.
    fn fill(&mut self, hull: &Hull, place: impl Fn(u32) -> Vec2) -> Option<()> {
        let all = self.surface.faces().all();
        let most = 4 * self.faces.len() + 16;
        let mut next = 0;
        while next < self.faces.len() {
            let index = self.faces[next];
            next += 1;
            let [a, b, c] = all[index as usize];
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let around = self.around.of(from).iter();
                let has = |other: &&u32| **other != index && all[**other as usize].contains(&to);
                let mut others = around.copied().filter(|other| has(&other));
                let other = others.next();
                let is_known = other.is_some_and(|of| self.last_of_face[of as usize] == self.part);
                if others.next().is_some() {
                    return None;
                }
                if is_known || !hull.is_crossed(place(from), place(to)) {
                    continue;
                }
                let other = other?;
                if self.faces.len() == most {
                    return None;
                }
                self.last_of_face[other as usize] = self.part;
                self.faces.push(other);
            }
        }
        Some(())
    }

    /// The faces in the plane; `None` if one of them does not lie there face up, or two of them one over the other.
    fn laid(&mut self, place: impl Fn(u32) -> Vec2, normal: Vec3) -> Option<Flattened> {
        let (rest, all) = (self.surface.rest_positions(), self.surface.faces().all());
        let mut particles = Vec::new();
        let mut laid = Vec::with_capacity(self.faces.len());
        let (mut closest, mut cosine) = (f32::INFINITY, 1.0_f32);
        let mut middle: Option<Vec2> = None;
        for &face in &self.faces {
            let corners = all[face as usize];
            let at = corners.map(&place);
            let [a, b, c] = corners.map(|corner| rest[corner as usize]);
            let area = (b - a).cross(c - a);
            cosine = cosine.min(normal.dot(area) / area.length());
            let [first, second] = [at[1] - at[0], at[2] - at[0]];
            let double = first.perp_dot(second);
            let longest = [first, second, at[2] - at[1]].map(Vec2::length);
            closest = closest.min(double / longest.into_iter().fold(0.0, f32::max));
            // All faces are face up, so each point is covered as often as any other.
            match middle {
                None => middle = Some((at[0] + at[1] + at[2]) / 3.0),
                Some(middle) if contains(&at, middle) => return None,
                Some(_) => {}
            }
            let places = corners.map(|corner| {
                let last = &mut self.last_of_particle[corner as usize];
                if last[0] != self.part {
                    *last = [self.part, particles.len() as u32];
                    particles.push(corner);
                }
                last[1]
            });
            let inverse = [second.y, -first.y, -second.x, first.x].map(|of| of / double);
            laid.push((places, inverse));
        }
        // Also for NaN.
        let is_flat = cosine >= LEAST_COSINE && closest > 0.0 && closest.is_finite();
        if !is_flat || particles.len() > MOST_PARTICLES {
            return None;
        }
        let faces = laid.chunks(8).map(|eight| {
            let of = |l: usize| &eight[l.min(eight.len() - 1)];
            EightFaces {
                corners: [0, 1, 2].map(|corner| std::array::from_fn(|l| of(l).0[corner] as u8)),
                inverse: [0, 1, 2, 3].map(|at| std::array::from_fn(|l| of(l).1[at])),
            }
        });
        Some(Flattened {
            particles,
            faces: faces.collect(),
            closest,
            ratio: 1.0 / cosine,
        })
    }
}

/// Whether a triangle contains a point.
fn contains([a, b, c]: &[Vec2; 3], point: Vec2) -> bool {
    let is_left = |from: &Vec2, to: &Vec2| (*to - *from).perp_dot(point - *from) >= 0.0;
    is_left(a, b) && is_left(b, c) && is_left(c, a)
}

/// The convex hull of points, turned to the left.
struct Hull {
    corners: Vec<Vec2>,
    tolerance: f32,
}

impl Hull {
    /// By the chain of Andrew (1979).
    fn of(mut points: Vec<Vec2>) -> Self {
        points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        let mut corners: Vec<Vec2> = Vec::new();
        let mut chain = |points: &mut dyn Iterator<Item = Vec2>| {
            let first = corners.len();
            for point in points {
                while let [.., a, b] = corners[first..] {
                    if (b - a).perp_dot(point - b) > 0.0 {
                        break;
                    }
                    corners.pop();
                }
                corners.push(point);
            }
            corners.pop();
        };
        chain(&mut points.iter().copied());
        chain(&mut points.iter().rev().copied());
        let ends: Range<f32> = points
            .iter()
            .fold(f32::INFINITY..f32::NEG_INFINITY, |ends, at| {
                ends.start.min(at.min_element())..ends.end.max(at.max_element())
            });
        Self {
            corners,
            tolerance: BORDER * (ends.end - ends.start),
        }
    }

    /// Whether a line passes through its inside, but for the tolerance.
    fn is_crossed(&self, from: Vec2, to: Vec2) -> bool {
        let (mut start, mut end) = (0.0_f32, 1.0_f32);
        for (at, &corner) in self.corners.iter().enumerate() {
            let along = self.corners[(at + 1) % self.corners.len()] - corner;
            let along = along.normalize_or_zero();
            let depth = |point: Vec2| along.perp_dot(point - corner) - self.tolerance;
            let (first, last) = (depth(from), depth(to));
            if first <= 0.0 && last <= 0.0 {
                return false;
            }
            let cut = first / (first - last);
            if first < 0.0 {
                start = start.max(cut);
            } else if last < 0.0 {
                end = end.min(cut);
            }
        }
        start < end
    }
}
