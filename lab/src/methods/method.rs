//! The methods that can be chosen.

/// A time-stepping method for a spring network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Explicit forces of Hooke's law with Verlet integration: the springs of
    /// Provot 1995, "Deformation Constraints in a Mass-Spring Model to Describe
    /// Rigid Cloth Behavior", without the constraints. Stable for steps below
    /// 2 / [`largest_frequency`](super::largest_frequency).
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
