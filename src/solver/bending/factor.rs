//! A thread's pentadiagonal system, factored.

use crate::solver::thread::Factor;

/// Puts a thread's numbers into its lane.
pub(super) fn set(factors: &mut Factor, lane: usize, factor: [f32; 3]) {
    for (lanes, number) in factors.iter_mut().zip(factor) {
        lanes[lane] = number;
    }
}

/// Factors M + s K of a thread of `count` particles into L D Lᵀ, in f64: given inverse masses (1/kg), and s k (kg) of each
/// particle that has two neighbours. A pinned particle is coupled to none, and keeps its place: its 1/D is 0.
pub(super) fn factor_thread(
    count: u32,
    inverse_mass: impl Fn(u32) -> f64,
    stiffness: impl Fn(u32) -> f64,
    mut put: impl FnMut(u32, [f32; 3]),
) {
    let k = |at: u32| {
        if at > 0 && at + 1 < count {
            stiffness(at)
        } else {
            0.0
        }
    };
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
