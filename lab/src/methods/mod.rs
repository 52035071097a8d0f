//! Methods for comparison with the plugin's own solver: small, plain implementations that step the same springs under
//! the same damping.
//!
//! They are references for benchmarks and experiments, not a second solver: no collisions, no threads, no culling.
//! Every method is generic over the precision, so that a converged `f64` run can serve as the reference.

mod error;
mod hooke;
mod method;
mod position_based;
#[cfg(test)]
mod precision;
mod projective;
#[path = "../../../tests/shared/scene.rs"]
mod scene;
mod stability;
mod state;
#[cfg(test)]
mod tests;

pub use error::MethodError;
use hooke::Hooke;
pub use method::Method;
use position_based::{PositionBased, SmallSteps};
use projective::Projective;
pub use scene::{GRAVITY, Scene};
pub use stability::largest_frequency;
pub use state::{MassSpring, Real};

use bevy_drape::{
    cloth::Springs,
    solver::{Bending, Solver},
};

/// A solver for a scene's springs as a list: one sweep over them in each sub-step, spring by spring, of first order.
pub fn one_sweep(scene: &Scene) -> Solver {
    let list = Springs::of_list(&scene.springs.to_vec(), scene.particles.len());
    let list = list.expect("springs of a scene are valid");
    let mut solver = Solver::new(&list, &scene.particles);
    solver.set_bending(Bending::new(&scene.surface, &scene.material));
    solver
}

/// A method set up for one network and one length of step.
#[derive(Debug)]
pub struct Stepper<R: Real> {
    kernel: Kernel<R>,
    /// Time between two damped predictions, s: the step, or the sub-step.
    interval: R,
    particles: usize,
    springs: usize,
}

#[derive(Debug)]
enum Kernel<R: Real> {
    Hooke(Hooke<R>),
    PositionBased(PositionBased<R>),
    SmallSteps(SmallSteps<R>),
    Projective(Box<Projective<R>>),
}

impl<R: Real> Stepper<R> {
    /// Prepares `method` for the springs and masses of `state` and steps of
    /// `step_seconds` (s).
    ///
    /// # Errors
    /// [`MethodError`] when the step or the iterations are not positive, when
    /// the method needs stiffnesses and a spring is rigid, or when the system
    /// matrix cannot be factorized.
    pub fn new(
        method: Method,
        state: &MassSpring<R>,
        step_seconds: f64,
    ) -> Result<Self, MethodError> {
        let step = R::from_f64(step_seconds);
        // Also refuses a step that the precision rounds to 0.
        if !step_seconds.is_finite()
            || step.partial_cmp(&R::from_f64(0.0)) != Some(std::cmp::Ordering::Greater)
        {
            return Err(MethodError::Step {
                seconds: step_seconds,
            });
        }
        let count = match method {
            Method::Hooke => 1,
            Method::PositionBased { iterations } | Method::ProjectiveDynamics { iterations } => {
                iterations
            }
            Method::SmallSteps { substeps } => substeps,
        };
        if count == 0 {
            return Err(MethodError::NoIterations { method });
        }
        let mut interval = step;
        let kernel = match method {
            Method::Hooke => {
                refuse_rigid(method, state)?;
                Kernel::Hooke(Hooke::new(step))
            }
            Method::PositionBased { iterations } => {
                Kernel::PositionBased(PositionBased::new(state, step, iterations))
            }
            Method::SmallSteps { substeps } => {
                interval = step / R::from_f64(f64::from(substeps));
                Kernel::SmallSteps(SmallSteps::new(state, interval, substeps))
            }
            Method::ProjectiveDynamics { iterations } => {
                refuse_rigid(method, state)?;
                Kernel::Projective(Box::new(Projective::new(state, step, iterations)?))
            }
        };
        Ok(Self {
            kernel,
            interval,
            particles: state.positions.len(),
            springs: state.springs.len(),
        })
    }

    /// Advances `state` by one step under a uniform `acceleration` (m/s²).
    ///
    /// `damping` is the part of the velocity that is lost in 1/60 s, from 0
    /// to 1: over a time t the part (1 - damping)^(60 t) is kept.
    ///
    /// # Panics
    /// When `state` has not as many particles and springs as the network that
    /// the stepper was made for.
    pub fn step(&mut self, state: &mut MassSpring<R>, acceleration: [R; 3], damping: R) {
        assert_eq!(
            (self.particles, self.springs),
            (state.positions.len(), state.springs.len()),
            "the stepper was made for another network"
        );
        let kept = (R::from_f64(1.0) - damping).powf(R::from_f64(60.0) * self.interval);
        match &mut self.kernel {
            Kernel::Hooke(kernel) => kernel.step(state, acceleration, kept),
            Kernel::PositionBased(kernel) => kernel.step(state, acceleration, kept),
            Kernel::SmallSteps(kernel) => kernel.step(state, acceleration, kept),
            Kernel::Projective(kernel) => kernel.step(state, acceleration, kept),
        }
    }
}

fn refuse_rigid<R: Real>(method: Method, state: &MassSpring<R>) -> Result<(), MethodError> {
    // Below the smallest normal number the reciprocal is not a finite `f32`.
    let rigid = |compliance: f32| compliance < f32::MIN_POSITIVE;
    match state
        .springs
        .iter()
        .position(|spring| rigid(spring.compliance))
    {
        Some(spring) => Err(MethodError::RigidSpring {
            method,
            spring,
            compliance: state.springs[spring].compliance,
        }),
        None => Ok(()),
    }
}
