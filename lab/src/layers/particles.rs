//! What most engines do: particles as balls that push each other apart, found by a uniform spatial hash.
//!
//! A plain loop over the plugin's solver and its contact with the floor, from the same start as the plugin's own run. Edges and faces
//! are not looked at, so what is thinner than the spacing may pass between the balls.

use std::{sync::Arc, time::Instant};

use bevy::math::{Vec3, Vec3A, bounding::BoundingSphere};
use bevy_drape::{
    cloth::{ClothMaterial, ClothParticles, Springs, Surface},
    contact::{
        ClothCollider, ClothSelfCollision, ContactSettings, Detection, MovingCollider,
        intersections,
    },
    hierarchy::TopDownQuery,
    prelude::ClothSettings,
    solver::{Bending, Solver, Substepping, TickStep},
};

use super::{hash::Hash, play::Play};

/// Sub-steps while balls may push, at least: what the plugin takes in piles. Without contact both take as many as the cloth needs.
const FOR_LAYERS: u32 = 16;

/// The margin of a search, at least and at most, as a part of the thickness; between these it is what particles may come nearer to
/// each other in a tick.
const MARGINS: [f32; 2] = [0.25, 2.0];

/// Balls nearer than this many thicknesses at rest are no pair: neighbours at the spacing itself, too.
const AT_REST: f32 = 1.001;

/// A sheet on a floor, tick by tick.
pub struct Plain {
    surface: Arc<Surface>,
    particles: ClothParticles,
    solver: Solver,
    step: TickStep,
    floor: MovingCollider,
    detection: Detection,
    query: TopDownQuery,
    settings: ContactSettings,
    balls: Option<Balls>,
    /// What each tick took (ms).
    pub ms: Vec<f64>,
}

impl Plain {
    /// The only cloth of a scene that has just begun; with particles as thick (m) as that, if at all.
    pub fn new(play: &mut Play, thickness: Option<f32>) -> Self {
        let (surface, particles, frame) = play.cloth();
        let to_own = frame.inverse();
        let material = ClothMaterial::COTTON;
        let springs = Springs::of_surface(&surface, &material);
        let mut solver = Solver::of_surface(&surface, &springs);
        solver.set_bending(Bending::new(&surface, &material));
        solver.set_stretch_damping(material.stretch_damping);
        let seconds = TickStep::default().seconds;
        let needed = Substepping::needed(surface.particles_along(), seconds);
        let floor = ClothCollider::plane().scaled(Vec3::ONE);
        Self {
            step: TickStep {
                seconds,
                substeps: thickness.map_or(needed, |_| needed.max(FOR_LAYERS)),
                acceleration: to_own.rotation * (Vec3::NEG_Y * 9.81),
                damping: material.damping,
                ..TickStep::default()
            },
            floor: MovingCollider::still(floor.expect("a plane"), to_own),
            settings: ContactSettings {
                particle_radius: ClothSettings::default().particle_radius,
                friction: material.friction,
                ..ContactSettings::default()
            },
            balls: thickness.map(|thickness| Balls::new(&surface, &particles, thickness)),
            detection: Detection::default(),
            query: TopDownQuery::default(),
            ms: Vec::new(),
            surface,
            particles,
            solver,
        }
    }

    pub fn tick(&mut self) {
        let start = Instant::now();
        self.find_floor();
        let Self {
            solver,
            particles,
            detection,
            settings,
            balls,
            step,
            ..
        } = self;
        if let Some(balls) = balls {
            balls.begin(particles, step.substeps);
        }
        solver.advance(particles, *step, &[], |particles, substep| {
            let is_pushed = detection.respond(particles, settings, substep, |_| {});
            let pushed = balls.as_mut().map_or(0.0, |balls| balls.respond(particles));
            detection.note_push(pushed);
            is_pushed || pushed > 0.0
        });
        self.ms.push(1.0e3 * start.elapsed().as_secs_f64());
    }

    fn find_floor(&mut self) {
        let Self {
            step,
            particles,
            surface,
            detection,
            query,
            ..
        } = self;
        let speed = particles.largest_speed() + step.acceleration.length() * step.seconds;
        detection.begin(surface, speed * step.seconds + 0.01);
        let anywhere = particles.position(0).expect("it exists");
        let around = BoundingSphere::new(anywhere, 2.0 * surface.diagonal());
        let longest = 2.0 * surface.spacing().longest;
        let (probe, against) =
            detection.probe(&self.floor, &self.settings, surface, longest, &around);
        query.clear();
        query.scan(particles, &probe);
        detection.add(0, &self.floor, against, query.candidates(), particles);
    }

    /// Pairs of triangles that intersect, by brute force in f64.
    pub fn intersections(&self) -> usize {
        intersections(&[(&*self.surface, self.particles.positions().collect())])
    }

    /// Pairs of balls that may touch, and searches in the last tick.
    pub fn pairs(&self) -> (usize, u32) {
        let balls = self.balls.as_ref();
        balls.map_or((0, 0), |balls| (balls.pairs.len(), balls.searches))
    }
}

/// Particles as balls. Kept from tick to tick.
struct Balls {
    /// How near two may come (m).
    thickness: f32,
    /// Coulomb's μ.
    friction: f32,
    rest: Vec<Vec3A>,
    inverse_masses: Vec<f32>,
    /// Where they are, and by how much they moved in the sub-step (m).
    places: Vec<Vec3A>,
    moved: Vec<Vec3A>,
    is_pushed: Vec<bool>,
    /// Where they were at the last search (m).
    origin: Vec<Vec3A>,
    /// How much nearer than they were any two may come before the next (m).
    margin: f32,
    hash: Hash,
    /// Those that may touch.
    pairs: Vec<[u32; 2]>,
    searches: u32,
}

impl Balls {
    fn new(surface: &Surface, particles: &ClothParticles, thickness: f32) -> Self {
        let rest = surface.rest_positions().iter();
        Self {
            thickness,
            friction: ClothSelfCollision::default().friction,
            rest: rest.copied().map(Vec3A::from).collect(),
            inverse_masses: particles.inverse_masses().collect(),
            places: Vec::new(),
            moved: Vec::new(),
            is_pushed: Vec::new(),
            origin: Vec::new(),
            margin: 0.0,
            hash: Hash::default(),
            pairs: Vec::new(),
            searches: 0,
        }
    }

    /// Begins a tick of so many sub-steps with a search.
    fn begin(&mut self, particles: &ClothParticles, substeps: u32) {
        self.gather(particles);
        let nearer = 2.0 * farthest_from_mean(self.moved.iter().copied()) * substeps as f32;
        let [least, most] = MARGINS.map(|part| part * self.thickness);
        self.margin = nearer.clamp(least, most);
        self.searches = 0;
        self.search();
    }

    fn gather(&mut self, particles: &ClothParticles) {
        self.places.clear();
        self.places.extend(particles.positions().map(Vec3A::from));
        self.moved.clear();
        self.moved
            .extend(particles.displacements().map(Vec3A::from));
    }

    fn search(&mut self) {
        self.searches += 1;
        self.origin.clone_from(&self.places);
        let Self {
            rest,
            pairs,
            thickness,
            ..
        } = self;
        let near_at_rest = (AT_REST * *thickness).powi(2);
        pairs.clear();
        self.hash
            .find(&self.places, *thickness + self.margin, |a, b| {
                if rest[a as usize].distance_squared(rest[b as usize]) > near_at_rest {
                    pairs.push([a, b]);
                }
            });
    }

    /// Pushes balls apart at the end of a sub-step, and says how far the one was that was pushed farthest (m).
    fn respond(&mut self, particles: &mut ClothParticles) -> f32 {
        self.gather(particles);
        let ways = self.places.iter().zip(&self.origin);
        if farthest_from_mean(ways.map(|(place, origin)| *place - *origin)) > self.margin / 2.0 {
            self.search();
        }
        self.is_pushed.clear();
        self.is_pushed.resize(self.places.len(), false);
        for index in 0..self.pairs.len() {
            self.push(self.pairs[index]);
        }
        self.scatter(particles)
    }

    /// All of the overlap goes out of the position, inverse masses weighted; velocity loses what both came towards each other in
    /// the sub-step, and an older overlap gives it none. Friction holds by Coulomb's law.
    fn push(&mut self, pair: [u32; 2]) {
        let [a, b] = pair.map(|ball| ball as usize);
        let between = self.places[a] - self.places[b];
        let squared = between.length_squared();
        if squared >= self.thickness * self.thickness || squared == 0.0 {
            return;
        }
        let distance = squared.sqrt();
        let normal = between / distance;
        let depth = self.thickness - distance;
        let relative = self.moved[a] - self.moved[b];
        let apart = normal.dot(relative);
        let stopped = depth.min(-apart).max(0.0);
        let tangential = relative - normal * apart;
        let (slip, most) = (tangential.length(), self.friction * stopped);
        let held = tangential * if slip > most { most / slip } else { 1.0 };
        let free = self.inverse_masses[a] + self.inverse_masses[b];
        for (ball, sign) in [(a, 1.0), (b, -1.0)] {
            let share = sign * self.inverse_masses[ball] / free;
            self.places[ball] += (normal * depth - held) * share;
            self.moved[ball] += (normal * stopped - held) * share;
            self.is_pushed[ball] = true;
        }
    }

    fn scatter(&self, particles: &mut ClothParticles) -> f32 {
        let mut farthest = 0.0_f32;
        for ball in (0..self.places.len()).filter(|&ball| self.is_pushed[ball]) {
            let place = Vec3::from(self.places[ball]);
            let before = particles.position(ball).expect("it exists");
            farthest = farthest.max(place.distance(before));
            particles.set_position(ball, place).expect("it exists");
            let moved = self.moved[ball].into();
            particles.set_displacement(ball, moved).expect("it exists");
        }
        farthest
    }
}

/// How far the farthest of some vectors is from their mean.
fn farthest_from_mean(all: impl ExactSizeIterator<Item = Vec3A> + Clone) -> f32 {
    let count = all.len() as f32;
    let mean = all.clone().sum::<Vec3A>() / count;
    let squares = all.map(|one| one.distance_squared(mean));
    squares.fold(0.0, f32::max).sqrt()
}
