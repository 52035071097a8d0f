//! Springs that lie anywhere, four at a time.
//!
//! Their eight ends are in as many places, so that gathering them would cost more than solving them if each were seven
//! numbers in seven places. For a sweep each particle is a row of its own, half a cache line. A spring then is four
//! loads and two stores of four numbers; the arithmetic is done for four of them at once, with one division and no
//! root.
//!
//! # The floor
//! Some thirty instructions a spring, of which eighteen move its ends: at four to five a cycle 2 ns at 3 GHz. The rows of
//! 5,000 particles are 160 kB: they stay in the second cache, and neighbours in the first.

use bevy::math::{Mat4, Vec4};

use super::{each::four, step_scale::StepScale};

/// Added to `w_a + w_b` (1/kg): negligible, but it keeps a spring between two pins from dividing by zero.
const MIN_SOFTNESS: f32 = 1.0e-18;

/// Springs in a packet.
pub(crate) const SPRINGS: usize = 4;

/// A particle during a sweep.
#[derive(Debug, Default, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Row {
    /// Position (m), and inverse mass (1/kg).
    pub place: Vec4,
    /// Displacement (m), and 0.
    pub moved: Vec4,
}

/// Springs of one colour: no two of them share an end, unless that is no particle's.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Packet {
    /// The rows of both ends.
    pub from: [u32; SPRINGS],
    pub to: [u32; SPRINGS],
    /// Squared length at rest (m²).
    pub rest_square: Vec4,
    /// m/N; 0 where there is no spring, between no particles.
    pub compliance: Vec4,
}

/// Moves the ends of all springs, one packet after the other, towards their rest lengths, in inverse proportion to their
/// masses. It is the XPBD distance constraint `λ = −C / (w_a + w_b + α/Δt²)`, once a sub-step (Macklin et al. 2016, 2019).
///
/// With q the squared length and r the rest length, C over the length, `1 − r/√q`, is taken as
/// `(q − r²) / (1.5 q + 0.5 r²)`, the first step of Halley's iteration for the root. At a stretch ε it is off by the part
/// ε²/4 (6·10⁻⁴ at 5 %).
///
/// Of this the way back is to know what each spring has pulled with, as a part of its length.
#[inline(always)]
pub(crate) fn relax_packets_there(
    rows: &mut [Row],
    packets: &[Packet],
    pulls: &mut [Vec4],
    step_scale: &StepScale,
) {
    for (packet, pull) in packets.iter().zip(pulls) {
        *pull = relax(rows, packet, step_scale, None);
    }
}

/// The way back: the last packet first. A spring that gives has pulled already, which it does not do twice. Adds what each pulls
/// with on this way.
#[inline(always)]
pub(crate) fn relax_packets_back(
    rows: &mut [Row],
    packets: &[Packet],
    pulls: &mut [Vec4],
    step_scale: &StepScale,
) {
    for (packet, pull) in packets.iter().zip(pulls).rev() {
        *pull += relax(rows, packet, step_scale, Some(*pull));
    }
}

/// Moves the ends of a packet's springs. Returns what they pull with: what moves their ends over inverse mass and length (kg).
#[inline(always)]
fn relax(rows: &mut [Row], packet: &Packet, step_scale: &StepScale, pulled: Option<Vec4>) -> Vec4 {
    let a = four(|at| rows[packet.from[at] as usize]);
    let b = four(|at| rows[packet.to[at] as usize]);
    let offsets: [Vec4; SPRINGS] =
        four(|at| (b[at].place - a[at].place) + (b[at].moved - a[at].moved));
    let [x, y, z, _] = turned(offsets);
    let (weight_a, weight_b) = (weights(&a), weights(&b));
    let q = x * x + y * y + z * z;
    let (mut r2, mut compliance) = (packet.rest_square, packet.compliance);
    let stiffer = &step_scale.stiffer;
    if stiffer.is_some() {
        let is_stiff = q.cmpgt(stiffer.from * r2) & compliance.cmpgt(Vec4::ZERO);
        r2 = Vec4::select(is_stiff, stiffer.squares[0] * r2, r2);
        compliance = Vec4::select(is_stiff, stiffer.compliance * compliance, compliance);
    }
    let (mut softness, mut beyond) = (compliance * step_scale.inverse_weight, q - r2);
    let scale = 1.5 * q + 0.5 * r2;
    if step_scale.kept < 1.0 {
        // The same as a grid's springs do: the change of length is measured like the stretch, against the length at the start.
        let moved: [Vec4; SPRINGS] = four(|at| b[at].moved - a[at].moved);
        let [dx, dy, dz, _] = turned(moved);
        let (sx, sy, sz) = (x - dx, y - dy, z - dz);
        let start = sx * sx + sy * sy + sz * sz;
        let longer = (x + sx) * dx + (y + sy) * dy + (z + sz) * dz;
        let opening = longer * (scale / (1.5 * q + 0.5 * start + MIN_SOFTNESS));
        let is_soft = packet.compliance.cmpgt(Vec4::ZERO);
        let kept = Vec4::select(is_soft, Vec4::splat(step_scale.kept), Vec4::ONE);
        softness *= kept;
        beyond = kept * beyond + (1.0 - kept) * opening;
    }
    let softness = softness + MIN_SOFTNESS;
    let weight = weight_a + weight_b + softness;
    if let Some(pulled) = pulled {
        beyond -= softness * pulled * scale;
    }
    let share = beyond / (scale * weight);
    let share_a = (share * weight_a).to_array();
    let share_b = (share * weight_b).to_array();
    for at in 0..SPRINGS {
        // What is beside a displacement stays 0.
        let offset = offsets[at] * Vec4::new(1.0, 1.0, 1.0, 0.0);
        rows[packet.from[at] as usize].moved = a[at].moved + offset * share_a[at];
        rows[packet.to[at] as usize].moved = b[at].moved - offset * share_b[at];
    }
    share
}

/// The first, second, third and fourth numbers of four vectors.
#[inline(always)]
pub(crate) fn turned([a, b, c, d]: [Vec4; 4]) -> [Vec4; 4] {
    let turned = Mat4::from_cols(a, b, c, d).transpose();
    [turned.x_axis, turned.y_axis, turned.z_axis, turned.w_axis]
}

#[inline(always)]
fn weights(rows: &[Row; SPRINGS]) -> Vec4 {
    let [a, b, c, d] = four(|at| rows[at].place.w);
    Vec4::new(a, b, c, d)
}
