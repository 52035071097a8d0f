//! Calibrates the springs along edges, so that the surface stretches alike in all directions.
//!
//! Springs that represent the area of their faces have the right mean stiffness. On an irregular mesh they are up to a
//! tenth off: too stiff along the preferred direction of the edges, and too soft across it. Particles that are not in
//! the middle of their neighbours add compliance. Both effects are measured around each particle, and each spring is
//! corrected by the measured compliance in its direction.
//!
//! A woven surface has Young's moduli a along the warp and b along the weft. Springs of all directions stretch like an
//! isotropic sheet that was drawn out along the warp: with φ from the warp and `s = cos²φ ⁄ t + t sin²φ`, t⁴ = a ⁄ b, a
//! spring has the compliance s³ ⁄ √(a b), and a strip cut in that direction s² ⁄ √(a b). The shear modulus is
//! √(a b) × 3⁄8. Springs cannot have all four constants of an orthotropic sheet, as their C₁₂ is C₆₆.

use bevy::math::{DMat2, DMat3, DVec2, DVec3, Vec3};

use super::{graph::Graph, springs::Link};
use crate::cloth::spring::SpringKind;

/// More passes would fit the springs around one particle at the cost of others: eight are worse than none.
const PASSES: usize = 2;

/// The smallest and largest factor of a spring's correction in a pass.
const LIMITS: [f64; 2] = [0.3, 3.0];

/// The compliance of a surface around a particle, in its tangent plane. Like strain, a direction n counts as (nx², ny²,
/// nx ny).
#[derive(Debug, Clone, Copy)]
struct Star {
    /// The springs' stiffness if all particles follow the strain.
    affine: DMat3,
    /// The stiffness lost because the springs move the particle.
    lost: DMat3,
    /// The area that the springs represent (m²).
    area: f64,
}

/// Corrects the springs along edges. `normals` are the particles' normals, of length 1. `is_border` marks particles on
/// a border, whose star is incomplete. The compliance that is wanted in the direction of each, relative to the
/// material's, is the square of its `softness`; 1 for a surface that is alike in all directions.
pub(super) fn calibrate(
    links: &mut [Link],
    rest: &[Vec3],
    normals: &[Vec3],
    is_border: &[bool],
    softness: impl Fn(usize) -> f64,
) {
    // Springs along edges come last.
    let first = links.partition_point(|link| link.kind != SpringKind::Structural);
    let links = &mut links[first..];
    let edges = links.iter().enumerate();
    let graph = Graph::new(rest.len(), edges.map(|(at, link)| (link.ends, at as f32)));
    let frames: Vec<Frame> = normals.iter().map(|normal| Frame::new(*normal)).collect();
    let square = |link: &Link| f64::from(link.rest_length).powi(2);
    // Stiffness × length² of a patch's springs, before and after: the area that they represent (m²).
    let area = |link: &Link| square(link) / f64::from(link.slenderness);
    let areas: Vec<f64> = links.iter().map(area).collect();
    let softness: Vec<f64> = (0..links.len()).map(softness).collect();
    let corrected = areas.iter().zip(&softness);
    let mut corrected: Vec<f64> = corrected.map(|(area, soft)| area / soft.powi(3)).collect();
    let turns = turns(&graph, &frames);
    for _ in 0..PASSES {
        let star = |particle: usize| {
            if is_border[particle] {
                return None;
            }
            let mut star = Springs::NONE;
            for &(other, at) in graph.of(particle as u32) {
                let span = rest[other as usize] - rest[particle];
                let (at, length) = (at as usize, f64::from(span.length()));
                let direction = frames[particle].direction(span);
                star.add(direction, length, corrected[at], areas[at]);
            }
            star.relaxed()
        };
        let stars: Vec<Option<Star>> = (0..rest.len()).map(star).collect();
        let compliance = |particle: usize| {
            let mut sum = stars[particle].unwrap_or(Star::NONE);
            for (near, turn) in graph.of(particle as u32).iter().zip(&turns[particle]) {
                if let Some(star) = &stars[near.0 as usize] {
                    sum.add(star, *turn);
                }
            }
            sum.compliance()
        };
        let compliances: Vec<Option<DMat3>> = (0..rest.len()).map(compliance).collect();
        for ((link, corrected), softness) in links.iter().zip(&mut corrected).zip(&softness) {
            let [a, b] = link.ends.map(|end| end as usize);
            let given = |particle: usize| {
                let direction = strain(frames[particle].direction(rest[b] - rest[a]));
                Some(direction.dot(compliances[particle]? * direction))
            };
            // Without a complete star nearby, there is no estimate.
            let known = [given(a), given(b)].into_iter().flatten();
            let (count, sum) =
                known.fold((0.0, 0.0), |(count, sum), given| (count + 1.0, sum + given));
            if count > 0.0 && sum.is_finite() {
                let given = sum / count / (softness * softness);
                *corrected *= given.clamp(LIMITS[0], LIMITS[1]);
            }
        }
    }
    for (link, corrected) in links.iter_mut().zip(corrected) {
        link.slenderness = (square(link) / corrected) as f32;
    }
}

/// The angle of each neighbour's frame in that of each particle.
fn turns(graph: &Graph, frames: &[Frame]) -> Vec<Vec<DVec2>> {
    let of_particle = |(particle, frame): (usize, &Frame)| {
        let neighbours = graph.of(particle as u32).iter();
        let turn = |near: &(u32, f32)| frame.angle_to(&frames[near.0 as usize]);
        neighbours.map(turn).collect()
    };
    frames.iter().enumerate().map(of_particle).collect()
}

/// Two axes of a tangent plane and its normal.
#[derive(Debug, Clone, Copy)]
struct Frame([Vec3; 3]);

impl Frame {
    fn new(normal: Vec3) -> Self {
        let (a, b) = normal.any_orthonormal_pair();
        Self([a, b, normal])
    }

    /// A direction on the surface, unfolded into the plane, of length 1.
    fn direction(&self, span: Vec3) -> DVec2 {
        let Self([a, b, _]) = self;
        DVec2::new(f64::from(span.dot(*a)), f64::from(span.dot(*b))).normalize_or_zero()
    }

    /// Cosine and sine of the angle of another frame's first axis in this one, unfolded along the line between the
    /// planes.
    fn angle_to(&self, other: &Self) -> DVec2 {
        if self.0 == other.0 {
            return DVec2::X;
        }
        let turn = bevy::math::Quat::from_rotation_arc(other.0[2], self.0[2]);
        self.direction(turn * other.0[0])
    }
}

/// (nx², ny², nx ny) of a direction n.
fn strain(direction: DVec2) -> DVec3 {
    let DVec2 { x, y } = direction;
    DVec3::new(x * x, y * y, x * y)
}

/// Sums over the springs around a particle.
#[derive(Debug)]
struct Springs {
    affine: DMat3,
    /// The stiffness that holds the particle, and the pull of strain on it: two rows.
    holding: DMat2,
    pulling: [DVec3; 2],
    area: f64,
}

impl Springs {
    const NONE: Self = Self {
        affine: DMat3::ZERO,
        holding: DMat2::ZERO,
        pulling: [DVec3::ZERO; 2],
        area: 0.0,
    };

    /// Adds a spring in a direction, of a length (m), with the areas that it represents (m²).
    fn add(&mut self, direction: DVec2, length: f64, corrected: f64, area: f64) {
        let strain = strain(direction);
        let outer = DMat3::from_cols(strain * strain.x, strain * strain.y, strain * strain.z);
        let stiffness = corrected / (length * length);
        self.affine += outer * (corrected / 2.0);
        self.holding +=
            DMat2::from_cols(direction * direction.x, direction * direction.y) * stiffness;
        self.pulling[0] += strain * (direction.x * stiffness * length);
        self.pulling[1] += strain * (direction.y * stiffness * length);
        self.area += area / 6.0;
    }

    fn relaxed(&self) -> Option<Star> {
        let held = self.holding.inverse();
        let [a, b] = self.pulling;
        let moved = [
            a * held.x_axis.x + b * held.y_axis.x,
            a * held.x_axis.y + b * held.y_axis.y,
        ];
        let column = |at: usize| moved[0] * a[at] + moved[1] * b[at];
        let lost = DMat3::from_cols(column(0), column(1), column(2));
        lost.is_finite().then_some(Star {
            affine: self.affine,
            lost,
            area: self.area,
        })
    }
}

impl Star {
    const NONE: Self = Self {
        affine: DMat3::ZERO,
        lost: DMat3::ZERO,
        area: 0.0,
    };

    /// Adds another star, whose plane is rotated by an angle of this cosine and sine.
    fn add(&mut self, other: &Self, angle: DVec2) {
        self.area += other.area;
        if angle == DVec2::X {
            self.affine += other.affine;
            self.lost += other.lost;
            return;
        }
        let (c, s) = (angle.x, angle.y);
        let turn = DMat3::from_cols(
            DVec3::new(c * c, s * s, c * s),
            DVec3::new(s * s, c * c, -c * s),
            DVec3::new(-2.0 * c * s, 2.0 * c * s, c * c - s * s),
        );
        let back = turn.transpose();
        self.affine += turn * other.affine * back;
        self.lost += turn * other.lost * back;
    }

    /// The compliance of a patch, relative to the intended one.
    fn compliance(&self) -> Option<DMat3> {
        let inverse = (self.affine * (1.0 / self.area)).inverse();
        let compliance = inverse + inverse * (self.lost * (1.0 / self.area)) * inverse;
        compliance.is_finite().then_some(compliance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equal in all directions already: nothing to correct.
    #[test]
    fn an_even_star_is_left_as_it_is() {
        let mut rest = vec![Vec3::ZERO];
        let at = |angle: usize, radius: f32| {
            let (s, c) = (angle as f32 * std::f32::consts::TAU / 6.0).sin_cos();
            Vec3::new(c, 0.0, s) * radius
        };
        rest.extend((0..6).map(|angle| at(angle, 0.1)));
        let area = 3.0_f32.sqrt() / 4.0 * 0.01;
        let link = |a: u32, b: u32, faces: f32| Link {
            kind: SpringKind::Structural,
            ends: [a, b],
            rest_length: 0.1,
            slenderness: 0.01 / (faces * area),
        };
        let mut links: Vec<Link> = (1..7).map(|other| link(0, other, 2.0)).collect();
        links.extend((1..7).map(|other| link(other, other % 6 + 1, 1.0)));
        let before = links.clone();
        let is_border: Vec<bool> = (0..7).map(|particle| particle > 0).collect();
        calibrate(&mut links, &rest, &[Vec3::Y; 7], &is_border, |_| 1.0);
        for (link, before) in links.iter().zip(&before) {
            assert!(
                (link.slenderness / before.slenderness - 1.0).abs() < 1.0e-4,
                "{link:?}"
            );
        }
        // Without any whole star, too.
        calibrate(&mut links, &rest, &[Vec3::Y; 7], &[true; 7], |_| 1.0);
    }

    /// What a star gives in a direction does not depend on the axes of its plane.
    #[test]
    fn turned_stars_are_the_same() {
        let mut springs = Springs::NONE;
        for (angle, area) in [
            (0.1_f64, 1.0),
            (1.3, 1.2),
            (2.2, 0.7),
            (4.0, 1.1),
            (5.0, 0.9),
        ] {
            springs.add(DVec2::from_angle(angle), 0.1, area, area);
        }
        let star = springs.relaxed().expect("enough directions");
        let mut turned = Star::NONE;
        let angle = DVec2::from_angle(0.7);
        turned.add(&star, angle);
        let (compliance, other) = (
            star.compliance().expect("it is"),
            turned.compliance().expect("it is"),
        );
        for direction in [0.0_f64, 0.5, 1.5] {
            let here = strain(DVec2::from_angle(direction));
            let there = strain(DVec2::from_angle(direction + 0.7));
            let difference = here.dot(compliance * here) - there.dot(other * there);
            assert!(difference.abs() < 1.0e-9, "{difference}");
        }
    }
}
