//! XPBD: over whole steps with many sweeps, and over small steps with one.

use super::state::{MassSpring, Real, add, along, ends, scale, sub};

/// The compliance of each spring over a time step of `step` (s), in 1/kg:
/// the α̃ = α / dt² of Macklin et al. 2016.
fn scaled_compliance<R: Real>(state: &MassSpring<R>, step: R) -> Vec<R> {
    let scaled = |compliance: f32| R::from(compliance) / (step * step);
    state
        .springs
        .iter()
        .map(|spring| scaled(spring.compliance))
        .collect()
}

/// The impulse-like correction (kg m) that moves end a by `w_a` and end b by
/// `-w_b` times itself, and the change of the multiplier (Macklin et al. 2016,
/// eq. 17 and 18, for C = length - rest length).
fn correction<R: Real>(
    state: &MassSpring<R>,
    index: usize,
    compliance: R,
    multiplier: R,
) -> Option<([R; 3], R)> {
    let spring = &state.springs[index];
    let [a, b] = ends(spring);
    let inverse_mass = state.inverse_mass[a] + state.inverse_mass[b];
    if inverse_mass == R::from(0.0) {
        return None; // both ends pinned
    }
    let (length, direction) = along(&state.positions, [a, b])?;
    let constraint = length - R::from(spring.rest_length);
    let change = (-constraint - compliance * multiplier) / (inverse_mass + compliance);
    Some((scale(direction, change), change))
}

/// XPBD with stored multipliers.
#[derive(Debug)]
pub(super) struct PositionBased<R> {
    /// s
    step: R,
    iterations: u32,
    /// α / dt², 1/kg
    compliances: Vec<R>,
    multipliers: Vec<R>,
    /// Positions before the step, m.
    previous: Vec<[R; 3]>,
}

impl<R: Real> PositionBased<R> {
    pub(super) fn new(state: &MassSpring<R>, step: R, iterations: u32) -> Self {
        Self {
            step,
            iterations,
            compliances: scaled_compliance(state, step),
            multipliers: vec![R::from(0.0); state.springs.len()],
            previous: state.positions.clone(),
        }
    }

    pub(super) fn step(&mut self, state: &mut MassSpring<R>, acceleration: [R; 3], kept: R) {
        self.previous.copy_from_slice(&state.positions);
        let gained = scale(acceleration, self.step);
        for ((position, &velocity), &w) in state
            .positions
            .iter_mut()
            .zip(&state.velocities)
            .zip(&state.inverse_mass)
        {
            if w > R::from(0.0) {
                let velocity = add(scale(velocity, kept), gained);
                *position = add(*position, scale(velocity, self.step));
            }
        }
        self.multipliers.fill(R::from(0.0));
        for _ in 0..self.iterations {
            for index in 0..state.springs.len() {
                let (compliance, multiplier) =
                    (self.compliances[index], &mut self.multipliers[index]);
                let Some((moved, change)) = correction(state, index, compliance, *multiplier)
                else {
                    continue;
                };
                *multiplier += change;
                let [a, b] = ends(&state.springs[index]);
                let (w_a, w_b) = (state.inverse_mass[a], state.inverse_mass[b]);
                state.positions[a] = add(state.positions[a], scale(moved, w_a));
                state.positions[b] = sub(state.positions[b], scale(moved, w_b));
            }
        }
        let per_second = R::from(1.0) / self.step;
        for ((velocity, &position), &previous) in state
            .velocities
            .iter_mut()
            .zip(&state.positions)
            .zip(&self.previous)
        {
            *velocity = scale(sub(position, previous), per_second);
        }
    }
}

/// XPBD with one sweep a sub-step. With a single sweep every multiplier
/// starts at 0, so none is stored.
#[derive(Debug)]
pub(super) struct SmallSteps<R> {
    /// Length of a sub-step, s.
    substep: R,
    substeps: u32,
    /// α / dt², 1/kg
    compliances: Vec<R>,
    /// Way of each particle in the running sub-step, m. It is summed rather than
    /// taken as a difference of positions, whose rounding would be divided by
    /// the short sub-step.
    displacements: Vec<[R; 3]>,
}

impl<R: Real> SmallSteps<R> {
    pub(super) fn new(state: &MassSpring<R>, substep: R, substeps: u32) -> Self {
        Self {
            substep,
            substeps,
            compliances: scaled_compliance(state, substep),
            displacements: vec![[R::from(0.0); 3]; state.positions.len()],
        }
    }

    pub(super) fn step(&mut self, state: &mut MassSpring<R>, acceleration: [R; 3], kept: R) {
        let zero = R::from(0.0);
        for ((displacement, &velocity), &w) in self
            .displacements
            .iter_mut()
            .zip(&state.velocities)
            .zip(&state.inverse_mass)
        {
            *displacement = scale(velocity, if w > zero { self.substep } else { zero });
        }
        let gained = scale(acceleration, self.substep * self.substep);
        for _ in 0..self.substeps {
            for ((position, displacement), &w) in state
                .positions
                .iter_mut()
                .zip(&mut self.displacements)
                .zip(&state.inverse_mass)
            {
                if w > zero {
                    *displacement = add(scale(*displacement, kept), gained);
                    *position = add(*position, *displacement);
                }
            }
            self.sweep(state);
        }
        let per_second = R::from(1.0) / self.substep;
        for (velocity, &displacement) in state.velocities.iter_mut().zip(&self.displacements) {
            *velocity = scale(displacement, per_second);
        }
    }

    fn sweep(&mut self, state: &mut MassSpring<R>) {
        for index in 0..state.springs.len() {
            let compliance = self.compliances[index];
            let Some((moved, _)) = correction(state, index, compliance, R::from(0.0)) else {
                continue;
            };
            let [a, b] = ends(&state.springs[index]);
            let moved_a = scale(moved, state.inverse_mass[a]);
            let moved_b = scale(moved, state.inverse_mass[b]);
            state.positions[a] = add(state.positions[a], moved_a);
            state.positions[b] = sub(state.positions[b], moved_b);
            self.displacements[a] = add(self.displacements[a], moved_a);
            self.displacements[b] = sub(self.displacements[b], moved_b);
        }
    }
}
