//! Explicit spring forces with Verlet integration.

use super::state::{MassSpring, Real, add, along, ends, scale, sub};

/// Verlet steps in their velocity form: with v = (x - `x_prev`) / dt the update
/// x' = x + (x - `x_prev`) kept + a dt² is v' = v kept + a dt, x' = x + v' dt.
/// So displacements are not rounded like positions, which matters in `f32`.
#[derive(Debug)]
pub(super) struct Hooke<R> {
    /// s
    step: R,
}

impl<R: Real> Hooke<R> {
    pub(super) fn new(step: R) -> Self {
        Self { step }
    }

    pub(super) fn step(&mut self, state: &mut MassSpring<R>, acceleration: [R; 3], kept: R) {
        let zero = R::from(0.0);
        let gained = scale(acceleration, self.step);
        for (velocity, &w) in state.velocities.iter_mut().zip(&state.inverse_mass) {
            if w > zero {
                *velocity = add(scale(*velocity, kept), gained);
            }
        }
        // All forces are taken at the old positions, so their order is free.
        for spring in &state.springs {
            let [a, b] = ends(spring);
            let Some((length, direction)) = along(&state.positions, [a, b]) else {
                continue;
            };
            let force = (length - R::from(spring.rest_length)) / R::from(spring.compliance);
            let impulse = scale(direction, force * self.step);
            let (w_a, w_b) = (state.inverse_mass[a], state.inverse_mass[b]);
            state.velocities[a] = sub(state.velocities[a], scale(impulse, w_a));
            state.velocities[b] = add(state.velocities[b], scale(impulse, w_b));
        }
        for ((position, &velocity), &w) in state
            .positions
            .iter_mut()
            .zip(&state.velocities)
            .zip(&state.inverse_mass)
        {
            if w > zero {
                *position = add(*position, scale(velocity, self.step));
            }
        }
    }
}
