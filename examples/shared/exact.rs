//! The same springs in f64, by explicit steps short enough that they count as exact.

use super::sheet::{GRAVITY, Sheet};
use bevy::math::{DVec3, Vec3};

/// A sheet's particles and springs, undamped.
pub struct Exact {
    positions: Vec<DVec3>,
    velocities: Vec<DVec3>,
    inverse_masses: Vec<f64>,
    /// Ends, rest length (m) and stiffness (N/m).
    springs: Vec<([usize; 2], f64, f64)>,
}

impl Exact {
    /// At rest where the sheet's particles are, with its springs, none of which may be rigid.
    pub fn of(sheet: &Sheet) -> Self {
        let spring = |ends: [u32; 2], length: f32, compliance: f32| {
            let ends = ends.map(|end| end as usize);
            (ends, f64::from(length), 1.0 / f64::from(compliance))
        };
        let springs = sheet.springs.iter();
        Self {
            positions: sheet.particles.positions().map(Vec3::as_dvec3).collect(),
            velocities: vec![DVec3::ZERO; sheet.particles.len()],
            inverse_masses: sheet.particles.inverse_masses().map(f64::from).collect(),
            springs: springs
                .map(|each| spring(each.ends, each.rest_length, each.compliance))
                .collect(),
        }
    }

    /// This many seconds on in this many steps: half of a kick, a drift and the other half, which is of second order and
    /// stable up to 2/ω of the stiffest mode.
    pub fn advance(&mut self, seconds: f64, steps: u32) {
        let dt = seconds / f64::from(steps);
        let mut accelerations = self.accelerations();
        for _ in 0..steps {
            let each = self.positions.iter_mut().zip(&mut self.velocities);
            for ((position, velocity), acceleration) in each.zip(&accelerations) {
                *velocity += 0.5 * dt * acceleration;
                *position += dt * *velocity;
            }
            accelerations = self.accelerations();
            for (velocity, acceleration) in self.velocities.iter_mut().zip(&accelerations) {
                *velocity += 0.5 * dt * acceleration;
            }
        }
    }

    fn accelerations(&self) -> Vec<DVec3> {
        let mut found = vec![DVec3::ZERO; self.positions.len()];
        for &([a, b], length, stiffness) in &self.springs {
            let offset = self.positions[b] - self.positions[a];
            let apart = offset.length();
            let force = stiffness * (apart - length) / apart * offset;
            found[a] += force;
            found[b] -= force;
        }
        for (force, &inverse_mass) in found.iter_mut().zip(&self.inverse_masses) {
            *force = if inverse_mass > 0.0 {
                *force * inverse_mass + DVec3::NEG_Y * GRAVITY
            } else {
                DVec3::ZERO
            };
        }
        found
    }

    /// Where the particles are (m).
    pub fn places(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.positions.iter().copied()
    }

    /// RMS distance (m) of other places from here.
    pub fn distance(&self, places: impl Iterator<Item = DVec3>) -> f64 {
        let each = places.zip(&self.positions);
        let squares: f64 = each.map(|(a, b)| a.distance_squared(*b)).sum();
        (squares / self.positions.len() as f64).sqrt()
    }
}
