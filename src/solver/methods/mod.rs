//! The methods that the library's own solver is compared with: small, plain
//! implementations that step the same springs under the same damping.
//!
//! They are yardsticks for benchmarks and experiments, not a second solver:
//! no collisions, no threads, no culling. Every method is generic over the
//! precision, so that a converged `f64` run can serve as the reference.

mod hooke;
mod position_based;
mod projective;
mod scenes;
mod stability;
mod state;
#[cfg(test)]
mod tests;

use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::FaerError;
use hooke::Hooke;
use position_based::{PositionBased, SmallSteps};
use projective::Projective;
pub use scenes::{GRAVITY, Scene};
pub use stability::largest_frequency;
pub use state::{MassSpring, Real};

/// A time-stepping method for a spring network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Explicit forces of Hooke's law with Verlet integration: the springs of
    /// Provot 1995, "Deformation Constraints in a Mass-Spring Model to Describe
    /// Rigid Cloth Behavior", without the constraints. Stable for steps below
    /// 2 / [`largest_frequency`].
    Hooke,
    /// XPBD: Gauss-Seidel sweeps with stored multipliers over a whole step
    /// (Macklin et al. 2016, "XPBD: Position-Based Simulation of Compliant
    /// Constrained Dynamics").
    PositionBased {
        /// Sweeps over all springs in a step, at least 1.
        iterations: u32,
    },
    /// XPBD with one sweep in each of many sub-steps (Macklin et al. 2019,
    /// "Small Steps in Physics Simulation").
    SmallSteps {
        /// Sub-steps that a step is cut into, at least 1.
        substeps: u32,
    },
    /// Implicit Euler by local and global solves with one factorization
    /// (Liu et al. 2013, "Fast Simulation of Mass-Spring Systems"; the mass-spring
    /// case of projective dynamics, Bouaziz et al. 2014).
    ProjectiveDynamics {
        /// Pairs of a local and a global solve in a step, at least 1.
        iterations: u32,
    },
}

/// Why a spring network or a stepper cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum MethodError {
    /// Positions and inverse masses differ in number.
    #[error("{positions} positions but {inverse_masses} inverse masses")]
    Counts {
        /// Number of positions.
        positions: usize,
        /// Number of inverse masses.
        inverse_masses: usize,
    },
    /// An inverse mass is negative or not finite.
    #[error("particle {particle} has the inverse mass {inverse_mass} 1/kg")]
    InverseMass {
        /// Index of the particle.
        particle: usize,
        /// Its inverse mass, 1/kg.
        inverse_mass: f32,
    },
    /// A spring does not join two different particles of the network.
    #[error("spring {spring} joins particles {ends:?} of {particles}")]
    Ends {
        /// Index of the spring.
        spring: usize,
        /// The ends it names.
        ends: [u32; 2],
        /// Number of particles.
        particles: usize,
    },
    /// A rest length or compliance is negative or not finite.
    #[error("spring {spring} has the rest length {rest_length} m and compliance {compliance} m/N")]
    Spring {
        /// Index of the spring.
        spring: usize,
        /// Its rest length, m.
        rest_length: f32,
        /// Its compliance, m/N.
        compliance: f32,
    },
    /// The method needs a stiffness, the reciprocal of the compliance.
    #[error(
        "{method:?} needs a finite stiffness, spring {spring} has the compliance {compliance} m/N"
    )]
    RigidSpring {
        /// The method that was asked for.
        method: Method,
        /// Index of the spring.
        spring: usize,
        /// Its compliance, m/N.
        compliance: f32,
    },
    /// The step is not a positive, finite time.
    #[error("a step of {seconds} s cannot be taken")]
    Step {
        /// The step that was asked for, s.
        seconds: f64,
    },
    /// The number of iterations or sub-steps is 0.
    #[error("{method:?} would do nothing in a step")]
    NoIterations {
        /// The method that was asked for.
        method: Method,
    },
    /// The system matrix of projective dynamics is not positive definite as
    /// rounded: its entries differ by more than the precision holds.
    #[error("the system matrix has no Cholesky factor")]
    NotPositiveDefinite(#[from] LltError),
    /// The system matrix of projective dynamics could not be stored.
    #[error("the system matrix could not be stored")]
    Matrix(#[from] FaerError),
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
