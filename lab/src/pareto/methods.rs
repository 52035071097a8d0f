//! What moves the cloths: the library's solver and its peers, each with its settings.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use bevy::math::{DVec3, Vec3, bounding::BoundingSphere};
use bevy_drape::{
    cloth::{ClothParticles, Surface},
    contact::{ContactSettings, Detection, MovingCollider, NarrowPhase},
    hierarchy::TopDownQuery,
    solver::{Control, Solver, Stretch, Substepping},
};

use super::scenes::{Ball, Case};
use crate::methods::{MassSpring, Method, Real, Stepper, one_sweep};

/// A method with its settings.
#[derive(Debug, Clone, Copy)]
pub enum Way {
    /// This many steps a tick.
    Peer(Method, u32),
    Ours(Substepping, Springs),
}

/// How the library's solver takes the springs of a sub-step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Springs {
    /// Thread by thread, each solved exactly; of second order in time.
    Threads,
    /// One sweep, spring by spring; of first order.
    OneSweep,
}

pub const EXPLICIT: &str = "explicit forces";
pub const POSITION_BASED: &str = "position-based";
pub const SMALL_STEPS: &str = "small steps, plain";
pub const PROJECTIVE: &str = "projective dynamics";
pub const OURS: &str = "ours";
pub const ONE_SWEEP: &str = "one sweep";
pub const TOLERANCE: &str = "ours, by tolerance";

/// In the order in which they are shown.
pub const METHODS: [&str; 7] = [
    OURS,
    TOLERANCE,
    ONE_SWEEP,
    SMALL_STEPS,
    POSITION_BASED,
    PROJECTIVE,
    EXPLICIT,
];

impl Way {
    /// All that a scene is simulated by. Explicit forces need at least `limit` steps a tick.
    pub fn all(limit: f64, is_quick: bool) -> Vec<Self> {
        let substeps: &[u32] = if is_quick {
            &[5, 20, 80]
        } else {
            &[5, 7, 10, 14, 20, 28, 40, 57, 80, 113, 160]
        };
        let fixed = |springs| {
            substeps
                .iter()
                .map(move |&count| Self::Ours(Substepping::Fixed(count), springs))
        };
        let tolerances: &[f32] = if is_quick {
            &[0.02, 0.005]
        } else {
            &[0.05, 0.02, 0.01, 0.005, 0.002]
        };
        let tolerance = |&stretch: &f32| {
            let max_substeps = 100;
            let substepping = Substepping::Adaptive {
                stretch,
                max_substeps,
            };
            Self::Ours(substepping, Springs::Threads)
        };
        let small = |&substeps: &u32| Self::Peer(Method::SmallSteps { substeps }, 1);
        let position_based =
            |(iterations, steps)| Self::Peer(Method::PositionBased { iterations }, steps);
        let swept: &[(u32, u32)] = if is_quick {
            &[(10, 1), (40, 1)]
        } else {
            &[
                (5, 1),
                (10, 1),
                (20, 1),
                (40, 1),
                (80, 1),
                (5, 2),
                (10, 2),
                (20, 2),
                (40, 2),
            ]
        };
        let projective =
            |(iterations, steps)| Self::Peer(Method::ProjectiveDynamics { iterations }, steps);
        let solved: &[(u32, u32)] = if is_quick {
            &[(1, 1), (10, 1)]
        } else {
            &[
                (1, 1),
                (2, 1),
                (5, 1),
                (10, 1),
                (20, 1),
                (40, 1),
                (1, 4),
                (2, 4),
                (5, 4),
            ]
        };
        // Of stiff cloth, only as few as will do: that takes long enough.
        let factors: &[f64] = match (limit > 200.0, is_quick) {
            (true, _) => &[1.1],
            (false, true) => &[1.1, 4.0],
            (false, false) => &[1.1, 2.0, 4.0],
        };
        let explicit = |factor: &f64| Self::Peer(Method::Hooke, (factor * limit).ceil() as u32);
        let mut all: Vec<Self> = fixed(Springs::Threads).collect();
        all.extend(tolerances.iter().map(tolerance));
        all.extend(fixed(Springs::OneSweep));
        all.extend(substeps.iter().map(small));
        all.extend(swept.iter().copied().map(position_based));
        all.extend(solved.iter().copied().map(projective));
        all.extend(factors.iter().map(explicit));
        all
    }

    pub fn method(&self) -> &'static str {
        match self {
            Self::Peer(Method::Hooke, _) => EXPLICIT,
            Self::Peer(Method::PositionBased { .. }, _) => POSITION_BASED,
            Self::Peer(Method::SmallSteps { .. }, _) => SMALL_STEPS,
            Self::Peer(Method::ProjectiveDynamics { .. }, _) => PROJECTIVE,
            Self::Ours(Substepping::Adaptive { .. }, _) => TOLERANCE,
            Self::Ours(_, Springs::Threads) => OURS,
            Self::Ours(_, Springs::OneSweep) => ONE_SWEEP,
        }
    }

    pub fn setting(&self) -> String {
        let iterations = |count: u32, steps: u32| {
            let plural = if count == 1 { "" } else { "s" };
            match steps {
                1 => format!("{count} iteration{plural}"),
                _ => format!("{steps} × {count} iteration{plural}"),
            }
        };
        match *self {
            Self::Peer(Method::Hooke, steps) => format!("{steps} steps"),
            Self::Peer(Method::PositionBased { iterations: count }, steps)
            | Self::Peer(Method::ProjectiveDynamics { iterations: count }, steps) => {
                iterations(count, steps)
            }
            Self::Peer(Method::SmallSteps { substeps }, _)
            | Self::Ours(Substepping::Fixed(substeps), _) => format!("{substeps} sub-steps"),
            Self::Ours(Substepping::Automatic, _) => "automatic".into(),
            Self::Ours(Substepping::Adaptive { stretch, .. }, _) => {
                format!("{} % of stretch", (1.0e5 * stretch).round() / 1.0e3)
            }
        }
    }
}

/// A case on its way.
pub enum Player<'a, R: Real> {
    Peer(Box<Peer<'a, R>>),
    Ours(Box<Ours<'a>>),
}

impl<'a, R: Real> Player<'a, R> {
    /// At the beginning; what is made once is made here.
    pub fn new(case: &'a Case, way: Way) -> Self {
        match way {
            Way::Peer(method, steps) => Self::Peer(Box::new(Peer::new(case, method, steps))),
            Way::Ours(substepping, tethers) => {
                Self::Ours(Box::new(Ours::new(case, substepping, tethers)))
            }
        }
    }

    /// One tick. Returns the time that it took.
    pub fn tick(&mut self, tick: u32) -> Duration {
        let start = Instant::now();
        match self {
            Self::Peer(peer) => peer.tick(tick),
            Self::Ours(ours) => ours.tick(tick),
        }
        start.elapsed()
    }

    /// Where all particles are.
    pub fn positions(&self, to: &mut Vec<DVec3>) {
        to.clear();
        match self {
            Self::Peer(peer) => {
                let positions = peer.network.positions.iter();
                to.extend(positions.map(|at| DVec3::from(at.map(Into::into))));
            }
            Self::Ours(ours) => to.extend(ours.particles.positions().map(Vec3::as_dvec3)),
        }
    }

    /// The deepest that any particle was found inside of the ball (m), before it was pushed out.
    pub fn deepest(&self) -> f64 {
        match self {
            Self::Peer(peer) => peer.deepest,
            Self::Ours(ours) => ours.deepest,
        }
    }

    /// Sub-steps or steps that it has taken in all, those in vain included.
    pub fn substeps(&self) -> u32 {
        match self {
            Self::Peer(peer) => peer.taken,
            Self::Ours(ours) => ours.taken,
        }
    }
}

/// A plain method.
pub struct Peer<'a, R: Real> {
    case: &'a Case,
    network: MassSpring<R>,
    stepper: Stepper<R>,
    /// Of the stepper a tick, and how many of the method's one of these is.
    steps: u32,
    substeps: u32,
    taken: u32,
    deepest: f64,
}

impl<'a, R: Real> Peer<'a, R> {
    fn new(case: &'a Case, method: Method, steps: u32) -> Self {
        let network: MassSpring<R> = MassSpring::of_scene(&case.scene).expect("a valid network");
        // A ball is answered after each step: of small ones, after each of these.
        let (method, steps, substeps) = match method {
            Method::SmallSteps { substeps } if case.ball.is_some() => {
                (Method::SmallSteps { substeps: 1 }, steps * substeps, 1)
            }
            Method::SmallSteps { substeps } => (method, steps, substeps),
            _ => (method, steps, 1),
        };
        let seconds = f64::from(case.scene.seconds) / f64::from(steps);
        let stepper = Stepper::new(method, &network, seconds).expect("a valid method");
        Self {
            case,
            network,
            stepper,
            steps,
            substeps,
            taken: 0,
            deepest: 0.0,
        }
    }

    fn tick(&mut self, tick: u32) {
        let scene = &self.case.scene;
        let acceleration = scene.acceleration.to_array().map(R::from);
        let seconds = R::from_f64(f64::from(scene.seconds) / f64::from(self.steps));
        for step in 1..=self.steps {
            self.stepper.step(
                &mut self.network,
                acceleration,
                R::from(scene.material.damping),
            );
            if self.case.ball.is_some() {
                let part = f64::from(step) / f64::from(self.steps);
                let depth = Ball::push(&mut self.network, tick, part, seconds);
                self.deepest = self.deepest.max(depth);
            }
        }
        self.taken += self.steps * self.substeps;
    }
}

/// The library's solver, on one thread, as the plugin drives it.
pub struct Ours<'a> {
    case: &'a Case,
    surface: Arc<Surface>,
    particles: ClothParticles,
    backup: ClothParticles,
    solver: Solver,
    /// At the end of the last tick, as is the speed of the fastest particle (m/s).
    stretch: Stretch,
    fastest: f32,
    substepping: Substepping,
    control: Control,
    detection: Detection,
    query: TopDownQuery,
    taken: u32,
    deepest: f64,
}

impl<'a> Ours<'a> {
    fn new(case: &'a Case, substepping: Substepping, springs: Springs) -> Self {
        let solver = match springs {
            Springs::Threads => case.scene.solver(false),
            Springs::OneSweep => one_sweep(&case.scene),
        };
        Self {
            case,
            surface: Arc::new(case.scene.surface.clone()),
            particles: case.scene.particles.clone(),
            backup: case.scene.particles.clone(),
            stretch: solver.measure(&case.scene.particles),
            solver,
            fastest: 0.0,
            substepping,
            control: Control::default(),
            detection: Detection::default(),
            query: TopDownQuery::default(),
            taken: 0,
            deepest: 0.0,
        }
    }

    /// How far a particle may get in a tick by itself (m), by the plugin's rule: contacts are searched for again where
    /// one gets farther.
    fn reach(&self) -> f32 {
        let scene = &self.case.scene;
        (self.fastest + scene.acceleration.length() * scene.seconds) * scene.seconds
            + self.stretch.bound * scene.grid.spacing().length()
    }

    /// Does the tick, and does it again with more sub-steps while the tolerance asks for it.
    fn tick(&mut self, tick: u32) {
        let scene = &self.case.scene;
        let contact_settings = ContactSettings {
            particle_radius: 0.0,
            friction: 0.0,
            narrow_phase: NarrowPhase::Particles,
            ..Default::default()
        };
        if self.case.ball.is_some() {
            let ball = MovingCollider::ball(Ball::RADIUS, Ball::at(tick), Ball::at(tick + 1));
            // A ball around all that the cloth ever does.
            let cloth = BoundingSphere::new(Ball::at(0), 4.0);
            self.detection.begin(&self.surface, self.reach());
            let (probe, against) =
                // Particles, not triangles, are tested.
                self.detection
                    .probe(&ball, &contact_settings, &scene.surface, 0.0, &cloth);
            self.query.clear();
            self.query.scan(&self.particles, &probe);
            let found = self.query.candidates();
            self.detection
                .add(0, &ball, against, found, &self.particles);
        }
        if matches!(self.substepping, Substepping::Adaptive { .. }) {
            self.backup.clone_from(&self.particles);
        }
        let along = scene.surface.particles_along();
        let needed = self
            .solver
            .needed(&self.particles, along, scene.seconds, scene.step(1).order);
        let mut substeps = self.control.substeps(self.substepping, needed);
        loop {
            let step = scene.step(substeps);
            let detection = &mut self.detection;
            let mut farthest = 0.0;
            let has_ball = self.case.ball.is_some();
            let stretch =
                self.solver
                    .advance(&mut self.particles, step, &[], |particles, substep| {
                        farthest = substep.farthest_move;
                        has_ball && detection.respond(particles, &contact_settings, substep, |_| {})
                    });
            self.taken += substeps;
            self.stretch = stretch;
            self.fastest = farthest * substeps as f32 / scene.seconds;
            let Some(more) = self.control.observe(self.substepping, stretch) else {
                // Of the way through the tick that counts: beginning again forgets the others'.
                let depths = self.detection.touches().iter().map(|touch| touch.deepest);
                self.deepest = self.deepest.max(f64::from(depths.fold(0.0, f32::max)));
                return;
            };
            self.particles.clone_from(&self.backup);
            self.detection.restart();
            substeps = more;
        }
    }
}
