//! Why a spring network or a stepper cannot be made.

use super::method::Method;
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::FaerError;

/// Why a spring network or a stepper cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
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
