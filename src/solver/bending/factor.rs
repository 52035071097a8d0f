//! A chain's pentadiagonal system and a strip's tridiagonal one, factored.

use crate::solver::kernels::Factor;

/// Puts a chain's numbers into its lane.
pub(super) fn set(factors: &mut Factor, lane: usize, factor: [f32; 3]) {
    for (lanes, number) in factors.iter_mut().zip(factor) {
        lanes[lane] = number;
    }
}

/// Factors M + s K of a chain of `count` particles into L D Lᵀ, in f64: given inverse masses (1/kg) and s k (kg), which each
/// particle has that has two neighbours. A pinned particle is coupled to none, and keeps its place: its 1/D is 0.
pub(super) fn factor_chain(
    count: u32,
    inverse_mass: impl Fn(u32) -> f64,
    stiffness: f64,
    mut put: impl FnMut(u32, [f32; 3]),
) {
    let is_inside = |at: u32| at > 0 && at + 1 < count;
    let k = |at: u32| if is_inside(at) { stiffness } else { 0.0 };
    // Of the particle before, and of the one before that: D, its inverse or 0, and the first number of L.
    let (mut one, mut two) = ((0.0, 0.0), (0.0, 0.0));
    let mut lower_of_one = 0.0;
    for at in 0..count {
        let inverse_mass = inverse_mass(at);
        let k_before = if at > 0 { k(at - 1) } else { 0.0 };
        let factor = if inverse_mass > 0.0 {
            let k_after = if at + 1 < count { k(at + 1) } else { 0.0 };
            let diagonal = 1.0 / inverse_mass + k_before + 4.0 * k(at) + k_after;
            let (beside, beyond) = (-2.0 * (k_before + k(at)), k_before);
            let lowest = beyond * two.1;
            let lower = (beside - beyond * lower_of_one) * one.1;
            let pivot = diagonal - lowest * lowest * two.0 - lower * lower * one.0;
            (pivot, lower, lowest)
        } else {
            (0.0, 0.0, 0.0)
        };
        let (pivot, lower, lowest) = factor;
        let inverse = if pivot > 0.0 { 1.0 / pivot } else { 0.0 };
        put(at, [lower, lowest, inverse].map(|number| number as f32));
        (two, one) = (one, (pivot, inverse));
        lower_of_one = lower;
    }
}

/// Factors a strip of cells of the twisting stiffness s k (kg) between two columns, in f64: of each row the number of L, 1/D and
/// the mass that resists a change of the difference between both columns, given what their inverse masses add up to (1/kg). Where
/// both are pinned the difference stays: all three are 0.
pub(super) fn factor_strip(
    rows: u32,
    stiffness: f64,
    inverse_masses: impl Fn(u32) -> f64,
    mut put: impl FnMut(u32, [f32; 3]),
) {
    let mut inverse_before = 0.0;
    for row in 0..rows {
        let inverse_mass = inverse_masses(row);
        let lower = -stiffness * inverse_before;
        let [inverse, mass] = if inverse_mass > 0.0 {
            let cells = f64::from(u8::from(row > 0) + u8::from(row + 1 < rows));
            let mass = 1.0 / inverse_mass;
            [1.0 / (mass + stiffness * (cells + lower)), mass]
        } else {
            [0.0; 2]
        };
        put(row, [lower, inverse, mass].map(|number| number as f32));
        inverse_before = inverse;
    }
}
