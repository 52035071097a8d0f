//! What is timed: searches, and a tick of the solver.

use std::sync::Arc;

use bevy::math::{Vec3, bounding::BoundingSphere};
use bevy_drape::{
    cloth::{Cloth, ClothMaterial, Surface},
    contact::{ContactSettings, Detection, MovingCollider, NarrowPhase},
    hierarchy::{Core, NodeBounds, Probe, TopDownQuery, brute_force},
    solver::{Solver, TickStep},
};

use crate::{
    cloths::{CHOICES, Choice},
    draped::{Draped, SPACING},
    exactness::missed_and_false,
    measure::{seconds, seconds_each},
    parry::ParryTree,
};

/// One way to search.
pub enum Searcher {
    Tree(Box<NodeBounds>, Choice),
    Scan,
    /// In f64, one by one.
    Brute,
    Parry(Box<ParryTree>),
}

impl Searcher {
    pub fn all(draped: &Draped) -> Vec<Self> {
        let trees = CHOICES
            .iter()
            .map(|&choice| Self::Tree(Box::default(), choice));
        let others = [
            Self::Scan,
            Self::Brute,
            Self::Parry(Box::new(ParryTree::new(&draped.particles))),
        ];
        trees.chain(others).collect()
    }

    pub fn names(&self) -> [&'static str; 2] {
        match self {
            Self::Tree(_, (volume, rule)) => [volume.name(), rule.name()],
            Self::Scan => ["particles", SCAN],
            Self::Brute => ["particles", BRUTE],
            Self::Parry(_) => ["AABBs", PARRY],
        }
    }

    pub fn rebuild(&mut self, draped: &Draped) {
        match self {
            Self::Tree(bounds, choice) => draped.rebuild(bounds, *choice),
            Self::Parry(tree) => tree.update(&draped.particles, 0.0),
            Self::Scan | Self::Brute => {}
        }
    }

    /// Says how many contacts it found.
    pub fn search(&self, query: &mut TopDownQuery, draped: &Draped, ball: &Probe) -> usize {
        query.clear();
        match self {
            Self::Tree(bounds, _) => query
                .search(&draped.tree, bounds, &draped.particles, ball)
                .len(),
            Self::Scan => query.scan(&draped.particles, ball).len(),
            Self::Brute => brute_force(&draped.particles, ball).len(),
            Self::Parry(tree) => tree.count(&draped.particles, ball),
        }
    }

    /// How many contacts it does not find, and how many it finds that are none.
    pub fn missed_and_false(
        &self,
        query: &mut TopDownQuery,
        draped: &Draped,
        ball: &Probe,
        truth: &[u32],
    ) -> [usize; 2] {
        let count = self.search(query, draped, ball);
        match self {
            Self::Tree(..) | Self::Scan => missed_and_false(query.candidates(), truth),
            Self::Brute => missed_and_false(&brute_force(&draped.particles, ball), truth),
            // It only counts, and each particle for itself.
            Self::Parry(_) => [
                truth.len().saturating_sub(count),
                count.saturating_sub(truth.len()),
            ],
        }
    }

    pub fn has_rebuild(&self) -> bool {
        !matches!(self, Self::Scan | Self::Brute)
    }
}

pub const SCAN: &str = "scan";
pub const BRUTE: &str = "brute force, f64";
pub const PARRY: &str = "parry3d";

/// A tick of a solver on one thread, with the response to the ball.
pub struct Ticking {
    solver: Solver,
    surface: Arc<Surface>,
    detection: Detection,
    query: TopDownQuery,
}

impl Ticking {
    pub fn new(draped: &Draped, side: u32) -> Self {
        let surface = Cloth::new(side, side, SPACING)
            .surface(Vec3::ONE)
            .expect("a valid grid");
        Self {
            solver: Solver::new(&draped.springs, &draped.particles),
            surface: Arc::new(surface),
            detection: Detection::default(),
            query: TopDownQuery::default(),
        }
    }

    /// What it takes to measure the largest stretch (s), which a tick does in its last sub-step.
    pub fn stretch_seconds(&self, least: f64, draped: &Draped) -> f64 {
        seconds_each(least, || self.solver.measure(&draped.particles))
    }

    /// What the solver takes (s): the search for candidates is not in it.
    pub fn seconds(&mut self, draped: &Draped, ball: &Probe) -> f64 {
        let mut particles = draped.particles.clone();
        let Core::Point(centre) = ball.core else {
            return f64::NAN;
        };
        let collider = MovingCollider::ball(ball.radius, centre, centre);
        let settings = ContactSettings {
            particle_radius: ball.particle_radius,
            friction: ClothMaterial::COTTON.friction,
            narrow_phase: NarrowPhase::Particles,
            ..Default::default()
        };
        // A ball around all of the cloth, and more than a particle moves in the tick.
        let cloth = BoundingSphere::new(Vec3::ZERO, 200.0);
        self.detection.begin(&self.surface, 4.0 * SPACING);
        let (probe, against) =
            self.detection
                .probe(&collider, &settings, &self.surface, SPACING, &cloth);
        self.query.clear();
        self.query.scan(&particles, &probe);
        let found = self.query.candidates();
        self.detection.add(0, &collider, against, found, &particles);
        let step = TickStep {
            acceleration: Vec3::NEG_Y * 9.81,
            damping: ClothMaterial::COTTON.damping,
            ..Default::default()
        };
        let Self {
            solver, detection, ..
        } = self;
        seconds(|| {
            solver.advance(&mut particles, step, &[], |particles, substep| {
                detection.respond(particles, &settings, substep, |_| {})
            });
        })
    }
}
