//! The stability limit of explicit steps.

use super::state::{MassSpring, add, along, dot, ends, scale, sub};

/// Relative change of the eigenvalue at which the power iteration ends.
const TOLERANCE: f64 = 1e-9;
/// Bound on the iterations. Reached only with nearly equal top frequencies,
/// whose common value is then known far better than to their distance.
const ITERATIONS: u32 = 100_000;

/// Largest angular frequency (rad/s) of the network in its present state.
///
/// It is the root of the largest eigenvalue of M^-1/2 K M^-1/2, found by power
/// iteration without forming the matrix. K is the tangent stiffness of springs
/// at their rest length, k n nᵀ with k = 1 / compliance along n; the stiffness
/// that tension adds across n is left out. Explicit symplectic steps are stable
/// below 2 / ω, the limit of central differences. Infinite with a rigid spring on a free
/// particle; 0 without springs.
#[must_use]
pub fn largest_frequency(state: &MassSpring<f64>) -> f64 {
    let roots: Vec<f64> = state.inverse_mass.iter().map(|w| w.sqrt()).collect();
    // Per spring: ends, direction n, stiffness.
    let mut rods = Vec::with_capacity(state.springs.len());
    for spring in &state.springs {
        let [a, b] = ends(spring);
        if roots[a] + roots[b] == 0.0 {
            continue;
        }
        if spring.compliance <= 0.0 {
            return f64::INFINITY;
        }
        if let Some((_, direction)) = along(&state.positions, [a, b]) {
            rods.push(([a, b], direction, 1.0 / f64::from(spring.compliance)));
        }
    }
    let mut vector = start(roots.len());
    let mut image = vec![[0.0; 3]; roots.len()];
    let mut eigenvalue = 0.0;
    for _ in 0..ITERATIONS {
        image.fill([0.0; 3]);
        for &([a, b], direction, stiffness) in &rods {
            let extension = dot(
                direction,
                sub(scale(vector[a], roots[a]), scale(vector[b], roots[b])),
            );
            let force = scale(direction, stiffness * extension);
            image[a] = add(image[a], scale(force, roots[a]));
            image[b] = sub(image[b], scale(force, roots[b]));
        }
        // The vector has length 1, so the length of its image tends to the
        // eigenvalue from below.
        let norm = image.iter().map(|&v| dot(v, v)).sum::<f64>().sqrt();
        if norm <= 0.0 {
            return 0.0;
        }
        for (vector, &image) in vector.iter_mut().zip(&image) {
            *vector = scale(image, 1.0 / norm);
        }
        let change = (norm - eigenvalue).abs();
        eigenvalue = norm;
        if change < TOLERANCE * norm {
            break;
        }
    }
    eigenvalue.sqrt()
}

/// A fixed vector of length 1 with no symmetry that a mode could be orthogonal
/// to: the fractional parts of multiples of the golden ratio, centred.
fn start(particles: usize) -> Vec<[f64; 3]> {
    let mut fraction = 0.0_f64;
    let mut next = || {
        fraction = (fraction + 0.618_033_988_749_895).fract();
        fraction - 0.5
    };
    let vector: Vec<[f64; 3]> = (0..particles).map(|_| [next(), next(), next()]).collect();
    let norm = vector.iter().map(|&v| dot(v, v)).sum::<f64>().sqrt();
    vector.into_iter().map(|v| scale(v, 1.0 / norm)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Vec3;
    use bevy_drape::cloth::{Spring, SpringKind};

    /// Two free particles on a spring swing with √(k (1/m₁ + 1/m₂)).
    #[test]
    fn largest_frequency_of_a_pair_is_known() {
        let spring = Spring {
            kind: SpringKind::Structural,
            ends: [0, 1],
            rest_length: 1.0,
            compliance: 0.01,
        };
        let pair =
            MassSpring::new(&[Vec3::ZERO, Vec3::X], &[2.0, 7.0], &[spring]).expect("a valid pair");
        // Inputs are rounded to `f32`.
        assert!((largest_frequency(&pair) / 30.0 - 1.0).abs() < 1e-7);
    }
}
