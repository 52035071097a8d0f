//! A scene's cloth in motion by any of the methods.

use bevy::math::{DVec3, Vec3};
use bevy_drape::{
    cloth::{ClothParticles, Spring, SpringKind},
    solver::{Solver, TickStep},
};

use crate::methods::{MassSpring, Method, Scene, Stepper};

/// A method and its settings.
#[derive(Debug, Clone, Copy)]
pub enum Way {
    /// A step cut into this many of the method's own.
    Peer(Method, u32),
    /// The library's solver.
    Ours { substeps: u32, tethers: bool },
}

impl Way {
    pub fn explicit(steps: u32) -> Self {
        Self::Peer(Method::Hooke, steps)
    }

    pub fn position_based(iterations: u32) -> Self {
        Self::Peer(Method::PositionBased { iterations }, 1)
    }

    pub fn small_steps(substeps: u32) -> Self {
        // Each is a step of its own, to see how far particles went in it.
        Self::Peer(Method::SmallSteps { substeps: 1 }, substeps)
    }

    pub fn projective(iterations: u32) -> Self {
        Self::Peer(Method::ProjectiveDynamics { iterations }, 1)
    }

    pub fn tethered(substeps: u32) -> Self {
        let tethers = true;
        Self::Ours { substeps, tethers }
    }

    /// As by default.
    pub fn ours(substeps: u32) -> Self {
        let tethers = false;
        Self::Ours { substeps, tethers }
    }
}

/// A scene's cloth in motion.
pub struct Moving {
    kernel: Kernel,
    springs: Vec<Spring>,
    masses: Vec<f64>,
    acceleration: DVec3,
    /// Length of a method's own step (s).
    dt: f64,
    /// Positions before the last of them (m), to know the energy in its middle; ours keeps displacements.
    before: Vec<DVec3>,
}

enum Kernel {
    Peer {
        stepper: Stepper<f64>,
        network: Box<MassSpring<f64>>,
        cuts: u32,
        damping: f64,
    },
    Ours {
        solver: Box<Solver>,
        particles: Box<ClothParticles>,
        step: TickStep,
    },
}

impl Moving {
    /// A scene in steps of `seconds`.
    ///
    /// # Panics
    /// If the method can't be had for its springs.
    pub fn new(scene: &Scene, way: Way, seconds: f64) -> Self {
        let kernel = match way {
            Way::Peer(method, cuts) => {
                let mut network: MassSpring<f64> =
                    MassSpring::of_scene(scene).expect("a valid network");
                for (index, velocity) in network.velocities.iter_mut().enumerate() {
                    let given = scene.particles.velocity(index).expect("it exists");
                    *velocity = given.as_dvec3().to_array();
                }
                let step = seconds / f64::from(cuts);
                Kernel::Peer {
                    stepper: Stepper::new(method, &network, step).expect("a method for it"),
                    network: Box::new(network),
                    cuts,
                    damping: scene.material.damping.into(),
                }
            }
            Way::Ours { substeps, tethers } => Kernel::Ours {
                solver: Box::new(scene.solver(tethers)),
                particles: Box::new(scene.particles.clone()),
                step: TickStep {
                    seconds: seconds as f32,
                    ..scene.step(substeps)
                },
            },
        };
        let cuts = match way {
            Way::Peer(_, cuts) => cuts,
            Way::Ours { substeps, .. } => substeps,
        };
        let mass = |w: f32| if w > 0.0 { 1.0 / f64::from(w) } else { 0.0 };
        Self {
            kernel,
            springs: scene.springs.to_vec(),
            masses: scene.particles.inverse_masses().map(mass).collect(),
            acceleration: scene.acceleration.as_dvec3(),
            dt: seconds / f64::from(cuts),
            before: Vec::new(),
        }
    }

    pub fn step(&mut self) {
        match &mut self.kernel {
            Kernel::Peer {
                stepper,
                network,
                cuts,
                damping,
            } => {
                for _ in 0..*cuts {
                    self.before = network.positions.iter().map(|p| (*p).into()).collect();
                    stepper.step(network, self.acceleration.to_array(), *damping);
                }
            }
            Kernel::Ours {
                solver,
                particles,
                step,
            } => {
                solver.advance(particles, *step, &[], |_, _| false);
            }
        }
    }

    pub fn positions(&self) -> Vec<DVec3> {
        match &self.kernel {
            Kernel::Peer { network, .. } => network.positions.iter().map(|p| (*p).into()).collect(),
            Kernel::Ours { particles, .. } => particles.positions().map(Vec3::as_dvec3).collect(),
        }
    }

    /// How far each particle went in the last of the method's own steps (m).
    pub fn moves(&self) -> Vec<DVec3> {
        match &self.kernel {
            Kernel::Peer { .. } => {
                let moves = self.positions().into_iter().zip(&self.before);
                moves.map(|(now, before)| now - *before).collect()
            }
            Kernel::Ours { particles, .. } => {
                particles.displacements().map(Vec3::as_dvec3).collect()
            }
        }
    }

    /// Kinetic and potential energy (J), without that of the springs, in the middle of the method's last own step.
    ///
    /// There every method's velocity is known to second order by how far it went: at the end it would be that of half a
    /// step before, and the energy of a fall off by the part Δt g/v.
    pub fn energy(&self) -> f64 {
        let moves = self.moves();
        let cells = self.positions().into_iter().zip(&moves).zip(&self.masses);
        cells
            .map(|((position, moved), mass)| {
                let kinetic = 0.5 * (*moved / self.dt).length_squared();
                mass * (kinetic - self.acceleration.dot(position - *moved / 2.0))
            })
            .sum()
    }

    /// The largest stretch of a structural spring, at least 0; NaN if one's end is.
    pub fn stretch(&self) -> f64 {
        super::largest(self.ratios().map(|ratio| ratio - 1.0))
    }

    /// The mean length over rest length of structural springs.
    pub fn mean_length(&self) -> f64 {
        self.ratios().sum::<f64>() / self.ratios().count() as f64
    }

    fn ratios(&self) -> impl Iterator<Item = f64> {
        let positions = self.positions();
        let springs = self.springs.iter();
        springs
            .filter(|spring| spring.kind == SpringKind::Structural)
            .map(move |spring| {
                let [a, b] = spring.ends.map(|end| positions[end as usize]);
                a.distance(b) / f64::from(spring.rest_length)
            })
    }

    /// The mean velocity of all particles in the last of the method's own steps (m/s).
    pub fn mean_velocity(&self) -> DVec3 {
        let moves = self.moves();
        moves.iter().sum::<DVec3>() / (moves.len() as f64 * self.dt)
    }

    /// The largest speed of a particle (m/s).
    pub fn largest_speed(&self) -> f64 {
        super::largest(self.moves().iter().map(|moved| moved.length() / self.dt))
    }
}

/// The energy of a scene as it begins, counted as [`Moving::energy`] does, and what of it its swing to the vertical could
/// set free (J).
pub fn energy_at_start(scene: &Scene) -> [f64; 2] {
    let acceleration = scene.acceleration.as_dvec3();
    let (mut start, mut lowest) = (0.0, 0.0);
    for (cell, (position, w)) in scene.grid.cells().zip(
        scene
            .particles
            .positions()
            .zip(scene.particles.inverse_masses()),
    ) {
        if w > 0.0 {
            let mass = 1.0 / f64::from(w);
            let rest = scene.grid.rest_position(cell.0, cell.1).as_dvec3();
            start -= mass * acceleration.dot(position.as_dvec3());
            lowest -= mass * acceleration.dot(rest);
        }
    }
    [start, start - lowest]
}
