//! Stitches between the two sides of a seam.

use bevy::math::Vec3;

use super::{line::Line, nearest::nearest, side::SewnSide};
use crate::cloth::arrays::distinct;

/// A particle of one side, and the point of the other side that it is sewn to.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Stitch {
    /// The side of `point`: 0 or 1.
    pub side: u32,
    pub point: u32,
    /// Particles of the other side, and their weights, whose sum is 1.
    pub onto: [u32; 3],
    pub weights: [f32; 3],
    /// Where it is along the seam (0 to 1).
    pub at: f32,
    /// The length of the seam that belongs to it (m).
    pub share: f32,
}

/// The stitches between two sides, of particles at these places in a common frame (m). Lines are matched by the fraction of
/// their length. A region, and lines of other numbers, are sewn at their nearest points. `spacing` is the length of a
/// stitch where no line says so (m).
pub(crate) fn stitches(sides: [&SewnSide; 2], places: [&[Vec3]; 2], spacing: f32) -> Vec<Stitch> {
    let lines = sides.map(SewnSide::lines);
    let [first, second] = lines;
    let mut stitches = if !first.is_empty() && first.len() == second.len() {
        between_lines(lines, places)
    } else {
        // The particles of lines go onto regions, and many go onto few.
        let side = match (first.is_empty(), second.is_empty()) {
            (false, true) => 0,
            (true, false) => 1,
            (false, false) => usize::from(sides[1].len() > sides[0].len()),
            (true, true) => usize::from(sides[1].len() < sides[0].len()),
        };
        onto_nearest(side, sides, places)
    };
    for stitch in stitches.iter_mut().filter(|stitch| stitch.share <= 0.0) {
        stitch.share = spacing;
    }
    stitches
}

/// Sews each line to the one that is nearest of those that are left.
fn between_lines([first, second]: [&[Line]; 2], places: [&[Vec3]; 2]) -> Vec<Stitch> {
    let total: f32 = first.iter().map(|line| line.length).sum();
    let mut left: Vec<usize> = (0..second.len()).collect();
    let mut stitches = Vec::new();
    let mut before = 0.0;
    for line in first {
        let far = |other: &usize| line.distance_squared(&second[*other], places);
        let nearest = (0..left.len()).min_by(|a, b| far(&left[*a]).total_cmp(&far(&left[*b])));
        let Some(nearest) = nearest else {
            break;
        };
        let other = &second[left.remove(nearest)];
        let part = |at: f32| match total > 0.0 {
            true => (before + at.clamp(0.0, 1.0) * line.length) / total,
            false => 0.0,
        };
        sew(line, other, places, part, &mut stitches);
        before += line.length;
    }
    stitches
}

/// Sews two lines. `part` takes a position along the first to that along the seam.
fn sew(
    first: &Line,
    second: &Line,
    places: [&[Vec3]; 2],
    part: impl Fn(f32) -> f32,
    stitches: &mut Vec<Stitch>,
) {
    let there = first.align(second, places);
    let back = there.inverse();
    let side = u32::from(second.particles.len() > first.particles.len());
    let (fine, coarse) = match side {
        0 => (first, second),
        _ => (second, first),
    };
    for (index, (&point, &at)) in fine.particles.iter().zip(&fine.at).enumerate() {
        let on_first = match (side, first.is_ring || second.is_ring) {
            (0, _) => at,
            (_, true) => back.of(at).rem_euclid(1.0),
            _ => back.of(at),
        };
        let onto = match side {
            0 if second.is_ring || !first.is_ring => there.of(at),
            0 => there.of(at).rem_euclid(1.0),
            _ => on_first,
        };
        let ([a, b], weight) = coarse.around(onto);
        stitches.push(Stitch {
            side,
            point,
            onto: [a, b, b],
            weights: [1.0 - weight, weight, 0.0],
            at: part(on_first),
            share: fine.share(index),
        });
    }
}

/// Sews each particle of one side to the nearest point of the other.
fn onto_nearest(side: usize, sides: [&SewnSide; 2], places: [&[Vec3]; 2]) -> Vec<Stitch> {
    let of: Vec<[u32; 3]> = match sides[1 - side] {
        SewnSide::Lines(lines) => lines.iter().flat_map(Line::segments).collect(),
        SewnSide::Region(faces) => faces.clone(),
    };
    let (own, others) = (places[side], places[1 - side]);
    let stitch = |point: u32, at: f32, share: f32| {
        let (onto, weights) = nearest(&of, others, own[point as usize])?;
        Some(Stitch {
            side: side as u32,
            point,
            onto,
            weights,
            at,
            share,
        })
    };
    match sides[side] {
        SewnSide::Region(faces) => {
            let points = distinct(faces.iter().flatten().copied()).into_iter();
            points.filter_map(|point| stitch(point, 0.5, 0.0)).collect()
        }
        SewnSide::Lines(lines) => {
            let total: f32 = lines.iter().map(|line| line.length).sum();
            let mut before = 0.0;
            let mut stitches = Vec::new();
            for line in lines {
                for (index, (&point, at)) in line.particles.iter().zip(&line.at).enumerate() {
                    let at = (before + at * line.length) / total.max(f32::MIN_POSITIVE);
                    stitches.extend(stitch(point, at, line.share(index)));
                }
                before += line.length;
            }
            stitches
        }
    }
}
