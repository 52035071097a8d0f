//! The scenes in which speed is weighed against accuracy.

use bevy::math::Vec3;
use bevy_drape::cloth::{ClothParticles, Springs};

use crate::{
    methods::{MassSpring, Real, Scene},
    surfaces::Made,
};

/// Each is simulated for a second.
pub const TICKS: u32 = 60;

/// Width of the cloths (m).
const WIDTH: f32 = 2.0;
/// Of structural and shear springs (m/N).
const SOFT: f32 = 1.0e-3;
const STIFF: f32 = 1.0e-6;
/// The part of its velocity that a damped cloth loses in a tick. With a ball more: cloth without bending springs
/// wrinkles where it is pushed together, which no two methods do alike.
const DAMPING: f32 = 0.02;
const DAMPING_BY_BALL: f32 = 0.1;

/// What lies in the plane of the cloth, and what stands still (m, m/s): as the library's solver, peers take what is
/// less for nothing. What a ball's push leaves far from it is soon below 1e-38, which machines are slow with.
const MIN_PLACE: f32 = 1.0e-15;
const MIN_SPEED: f32 = 1.0e-12;

/// Those of which findings speak on their own.
pub const BALL: &str = "ball";
pub const STIFF_HANGING: &str = "stiff, hanging";
pub const STIFF_SWINGING: &str = "stiff, swinging";

/// A cloth hung by its top row, and what pushes it.
pub struct Case {
    pub name: &'static str,
    pub scene: Scene,
    pub ball: Option<Ball>,
}

impl Case {
    /// All scenes with cloths of `side`² particles.
    pub fn all(side: u32) -> [Self; 6] {
        let case = |name, angle, compliance, damping, ball| {
            let mut scene = Scene::swinging(side, WIDTH, angle, compliance).expect("a valid scene");
            scene.material.damping = damping;
            Self { name, scene, ball }
        };
        [
            case("hanging", 0.0, SOFT, DAMPING, None),
            case("swinging", 0.5, SOFT, 0.0, None),
            case(BALL, 0.0, SOFT, DAMPING_BY_BALL, Some(Ball)),
            case(STIFF_HANGING, 0.0, STIFF, DAMPING, None),
            case(STIFF_SWINGING, 0.5, STIFF, DAMPING, None),
            case("mesh, hanging", 0.0, SOFT, DAMPING, None).of_mesh(side),
        ]
    }

    /// The same of an irregular mesh.
    fn of_mesh(mut self, side: u32) -> Self {
        let (surface, _) = Made::Delaunay.surface([side; 2], WIDTH / (side - 1) as f32);
        let scene = &mut self.scene;
        scene.springs = Springs::of_surface(&surface, &scene.material);
        scene.particles =
            ClothParticles::at_rest(&surface, &scene.material).expect("a valid material");
        for (particle, rest) in surface.rest_positions().iter().enumerate() {
            // Hung by its top row, it begins at rest.
            if rest.y == 0.0 {
                let is_there = scene.particles.set_inverse_mass(particle, 0.0);
                is_there.expect("it exists");
            }
        }
        scene.surface = surface;
        self
    }

    pub fn is_mesh(&self) -> bool {
        self.scene.surface.as_grid().is_none()
    }

    pub fn particles(&self) -> usize {
        self.scene.particles.len()
    }

    /// Steps a tick that explicit forces need at least, if the network's largest frequency is this (rad/s).
    pub fn explicit_limit(&self, frequency: f64) -> f64 {
        frequency * f64::from(self.scene.seconds) / 2.0
    }

    /// How much higher its largest frequency is than that of the soft ones, all else being equal.
    pub fn stiffness(&self) -> f64 {
        f64::from(SOFT / self.scene.material.stretch_compliance).sqrt()
    }
}

/// A ball that moves slowly into the lower half of the cloth, a little beside its middle.
#[derive(Clone, Copy)]
pub struct Ball;

impl Ball {
    pub const RADIUS: f32 = 0.4;
    /// How far it pushes (m) in all.
    pub const WAY: f32 = 0.1;

    /// Where it is as a tick begins (m).
    pub fn at(tick: u32) -> Vec3 {
        // Slow at both ends.
        let part = tick as f32 / TICKS as f32;
        let part = 0.5 - 0.5 * (std::f32::consts::PI * part).cos();
        Vec3::new(0.93, -1.5, Self::WAY * part - Self::RADIUS)
    }

    /// Pushes what is inside of it out as a step ends, which is `part` of the way through the tick: to the surface,
    /// and without the velocity at which both came nearer to each other. What was inside before gains no speed.
    /// Returns how deep the deepest was (m).
    pub fn push<R: Real>(network: &mut MassSpring<R>, tick: u32, part: f64, seconds: R) -> f64 {
        let (from, to) = (Self::at(tick), Self::at(tick + 1));
        let place = from.as_dvec3().lerp(to.as_dvec3(), part).to_array();
        let velocity = ((to - from).as_dvec3() * f64::from(TICKS)).to_array();
        let (centre, velocity) = (place.map(R::from_f64), velocity.map(R::from_f64));
        let radius = R::from(Self::RADIUS);
        let zero = R::from(0.0);
        let dot = |a: [R; 3], b: [R; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (min_place, min_speed) = (R::from(MIN_PLACE), R::from(MIN_SPEED));
        let flush = |values: &mut [R; 3], least: R| {
            for value in values {
                if *value < least && *value > zero - least {
                    *value = zero;
                }
            }
        };
        let mut deepest = zero;
        let each = network.positions.iter_mut().zip(&mut network.velocities);
        for ((position, own), &inverse_mass) in each.zip(&network.inverse_mass) {
            flush(position, min_place);
            flush(own, min_speed);
            let offset = [0, 1, 2].map(|axis| position[axis] - centre[axis]);
            let square = dot(offset, offset);
            if square >= radius * radius || square <= zero || inverse_mass <= zero {
                continue;
            }
            let distance = Real::sqrt(square);
            let normal = offset.map(|along| along / distance);
            let depth = radius - distance;
            if depth > deepest {
                deepest = depth;
            }
            let approach = [0, 1, 2].map(|axis| velocity[axis] - own[axis]);
            let mut stopped = dot(normal, approach);
            if stopped > depth / seconds {
                stopped = depth / seconds;
            }
            for axis in 0..3 {
                position[axis] += normal[axis] * depth;
                if stopped > zero {
                    own[axis] += normal[axis] * stopped;
                }
            }
        }
        deepest.into()
    }
}
