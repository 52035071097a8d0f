//! The state that all methods step, and the arithmetic that they share.

use super::{Scene, error::MethodError};
use bevy::math::Vec3;
use bevy_drape::cloth::{Spring, SpringKind};
use faer::traits::RealField;

/// The precision that a method computes in: `f32` or `f64`.
pub trait Real: RealField + Copy + From<f32> + Into<f64> {
    /// The nearest number to `value`.
    fn from_f64(value: f64) -> Self;
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// `self` to the power `exponent`.
    #[must_use]
    fn powf(self, exponent: Self) -> Self;
}

impl Real for f32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounding is what is asked for"
    )]
    fn from_f64(value: f64) -> Self {
        value as Self
    }
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    fn powf(self, exponent: Self) -> Self {
        Self::powf(self, exponent)
    }
}

impl Real for f64 {
    fn from_f64(value: f64) -> Self {
        value
    }
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    fn powf(self, exponent: Self) -> Self {
        Self::powf(self, exponent)
    }
}

/// Particles joined by springs.
#[derive(Debug, Clone, PartialEq)]
pub struct MassSpring<R> {
    /// Positions, m.
    pub positions: Vec<[R; 3]>,
    /// Velocities, m/s. That of a pinned particle has no effect.
    pub velocities: Vec<[R; 3]>,
    /// Inverse masses, 1/kg; 0 is pinned.
    pub inverse_mass: Vec<R>,
    /// Springs, in the order in which they are swept.
    pub springs: Vec<Spring>,
}

impl<R: Real> MassSpring<R> {
    /// A network at rest, from `positions` (m), `inverse_masses` (1/kg, 0 is
    /// pinned) and `springs` in the order in which they are swept.
    ///
    /// # Errors
    /// [`MethodError`] when the counts differ, a spring does not join two
    /// different particles, or a value is negative or not finite.
    pub fn new(
        positions: &[Vec3],
        inverse_masses: &[f32],
        springs: &[Spring],
    ) -> Result<Self, MethodError> {
        let particles = positions.len();
        if particles != inverse_masses.len() {
            return Err(MethodError::Counts {
                positions: particles,
                inverse_masses: inverse_masses.len(),
            });
        }
        let valid = |value: f32| value.is_finite() && value >= 0.0;
        if let Some(particle) = inverse_masses.iter().position(|&w| !valid(w)) {
            let inverse_mass = inverse_masses[particle];
            return Err(MethodError::InverseMass {
                particle,
                inverse_mass,
            });
        }
        for (index, spring) in springs.iter().enumerate() {
            let [a, b] = ends(spring);
            if a == b || a.max(b) >= particles {
                return Err(MethodError::Ends {
                    spring: index,
                    ends: spring.ends,
                    particles,
                });
            }
            if !valid(spring.rest_length) || !valid(spring.compliance) {
                return Err(MethodError::Spring {
                    spring: index,
                    rest_length: spring.rest_length,
                    compliance: spring.compliance,
                });
            }
        }
        Ok(Self {
            positions: positions
                .iter()
                .map(|p| p.to_array().map(R::from))
                .collect(),
            velocities: vec![[R::from(0.0); 3]; particles],
            inverse_mass: inverse_masses.iter().map(|&w| R::from(w)).collect(),
            springs: springs.to_vec(),
        })
    }

    /// The network of a scene, its springs in the order in which the plugin's solver sweeps them.
    ///
    /// # Errors
    /// See [`new`](Self::new).
    pub fn of_scene(scene: &Scene) -> Result<Self, MethodError> {
        let positions: Vec<Vec3> = scene.particles.positions().collect();
        let inverse_masses: Vec<f32> = scene.particles.inverse_masses().collect();
        Self::new(&positions, &inverse_masses, &scene.springs.to_vec())
    }

    /// Largest (length - rest length) / rest length over the structural
    /// springs, at least 0; NaN when one of their ends is NaN.
    #[must_use]
    pub fn largest_stretch(&self) -> f64 {
        let mut largest = 0.0;
        for spring in self
            .springs
            .iter()
            .filter(|s| s.kind == SpringKind::Structural)
        {
            let stretch = self.length(spring) / f64::from(spring.rest_length) - 1.0;
            if stretch.is_nan() {
                return stretch; // `f64::max` would hide it
            }
            largest = stretch.max(largest);
        }
        largest
    }

    /// Root mean square of the distances (m) between the particles of this
    /// network and the same particles of `other`, which may be of another
    /// precision.
    ///
    /// # Panics
    /// When the networks differ in their number of particles.
    #[must_use]
    pub fn rms_distance<S: Real>(&self, other: &MassSpring<S>) -> f64 {
        assert_eq!(
            self.positions.len(),
            other.positions.len(),
            "different networks"
        );
        let mut sum = 0.0;
        let mut count = 0.0;
        for (&p, &q) in self.positions.iter().zip(&other.positions) {
            let offset = sub(p.map(Into::into), q.map(Into::into));
            sum += dot(offset, offset);
            count += 1.0;
        }
        if count > 0.0 {
            f64::sqrt(sum / count)
        } else {
            0.0
        }
    }

    fn length(&self, spring: &Spring) -> f64 {
        let [a, b] = ends(spring).map(|end| self.positions[end].map(Into::into));
        let offset = sub(a, b);
        f64::sqrt(dot(offset, offset))
    }
}

/// The ends of a spring as indices.
#[inline]
pub(super) fn ends(spring: &Spring) -> [usize; 2] {
    spring.ends.map(|end| end as usize)
}

pub(super) fn add<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn sub<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn scale<R: Real>(a: [R; 3], factor: R) -> [R; 3] {
    a.map(|component| component * factor)
}

pub(super) fn dot<R: Real>(a: [R; 3], b: [R; 3]) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Length (m) and direction of the spring from its second end to its first;
/// nothing when the ends coincide, as there is no direction to act along.
pub(super) fn along<R: Real>(positions: &[[R; 3]], [a, b]: [usize; 2]) -> Option<(R, [R; 3])> {
    let offset = sub(positions[a], positions[b]);
    let length = dot(offset, offset).sqrt();
    (length > R::from(0.0)).then(|| (length, scale(offset, R::from(1.0) / length)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_stretch_is_known_and_a_lost_particle_seen() {
        let spring = Spring {
            kind: SpringKind::Structural,
            ends: [0, 1],
            rest_length: 1.0,
            compliance: 0.01,
        };
        let places = [Vec3::new(0.0, 2.0, 0.0), Vec3::new(0.0, 0.5, 0.0)];
        let mut state = MassSpring::<f64>::new(&places, &[0.0, 0.5], &[spring]).expect("valid");
        assert!((state.largest_stretch() - 0.5).abs() < 1e-12);
        state.positions[0][0] = f64::NAN;
        assert!(state.largest_stretch().is_nan());
    }
}
