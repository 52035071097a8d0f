//! The scenes: what touches itself, and how it is moved.

use std::{f32::consts::TAU, sync::Arc};

use bevy::prelude::*;
use bevy_drape::{plugin::ClothBuilt, prelude::*};

use crate::timed::{Clock, TimedTicks, crossed};

/// Ticks a second.
const RATE: f32 = 64.0;

/// What happens to a sheet, or to several.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scene {
    /// An edge is carried over the other one, and let go there.
    Fold,
    /// A strip of 1.2 × 0.4 m whose ends turn against each other, four turns in all.
    Twist,
    /// A sheet that stands on its edge is thrown down and falls into a pile.
    Drop,
    /// Ten sheets, each turned a little, fall on each other.
    Stack,
    /// Two balls close in on a hanging sheet from both sides.
    Balls,
    /// A flag is wound up by its pole, three times around.
    Pole,
    /// A sheet of any attitude and spin is thrown onto the floor.
    Random(u32),
    /// A sheet that falls, flat and far from itself.
    Flat,
    /// A sheet lies folded in the middle, one half on the other.
    Folded,
    /// Fifty sheets hang far from each other.
    Fifty,
}

impl Scene {
    pub fn name(self) -> &'static str {
        match self {
            Self::Fold => "fold",
            Self::Twist => "twist",
            Self::Drop => "drop",
            Self::Stack => "stack of 10",
            Self::Balls => "two balls",
            Self::Pole => "pole",
            Self::Random(_) => "random drop",
            Self::Flat => "flat, far from itself",
            Self::Folded => "half on half",
            Self::Fifty => "50 that are far",
        }
    }

    /// For how many ticks it is watched, at this speed (m/s).
    pub fn ticks(self, speed: f32) -> usize {
        let seconds = match self {
            Self::Fold => 1.6 / speed + 0.8,
            Self::Twist => TAU * 2.0 * 0.2 / speed + 0.2,
            Self::Balls => 0.7 / speed + 0.5,
            Self::Pole => TAU * 3.0 * POLE / speed + 0.5,
            Self::Drop | Self::Stack | Self::Random(_) => 1.6,
            Self::Flat | Self::Folded | Self::Fifty => 2.0,
        };
        (seconds * RATE) as usize
    }
}

/// Radius of the pole and of the balls (m).
const POLE: f32 = 0.1;
const BALL: f32 = 0.2;

/// What the scene moves, in an order that it knows.
#[derive(Component)]
struct Moved(f32);

/// An app in which a scene plays.
pub struct Play {
    app: App,
    scene: Scene,
    speed: f32,
    ticks: u32,
}

impl Play {
    /// Sheets of so many particles along the longer side, kept a thickness (m) apart if there is one.
    pub fn new(scene: Scene, side: u32, speed: f32, thickness: Option<f32>) -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
            .add_plugins(TimedTicks);
        let layers = thickness.map(ClothSelfCollision::of_thickness);
        scene.spawn(app.world_mut(), side, layers);
        app.finish();
        app.cleanup();
        // Time begins with the second.
        (0..2).for_each(|_| app.update());
        let mut play = Self {
            app,
            scene,
            speed,
            ticks: 0,
        };
        play.throw();
        play
    }

    /// Gives the sheets their shape and their velocities.
    fn throw(&mut self) {
        let (scene, speed) = (self.scene, self.speed);
        let world = self.app.world_mut();
        let mut cloths = world.query::<(&mut ClothParticles, &ClothFrame)>();
        for (mut particles, frame) in cloths.iter_mut(world) {
            for index in 0..particles.len() {
                let at = particles.position(index).expect("it exists");
                let place = frame.to_world(at);
                let velocity = match scene {
                    Scene::Drop | Scene::Stack => Vec3::NEG_Y * speed,
                    Scene::Random(seed) => {
                        let mut draw = Draw(seed);
                        let along = Vec3::new(draw.next(), -1.0, draw.next()).normalize();
                        let spin = Vec3::from_array(std::array::from_fn(|_| draw.next()));
                        (along + (2.0 * spin).cross(place - Vec3::Y)) * speed
                    }
                    Scene::Folded => {
                        let folded = folded(place);
                        let own = frame.isometry().inverse() * folded;
                        particles.set_position(index, own).expect("it exists");
                        Vec3::ZERO
                    }
                    _ => continue,
                };
                let own = frame.isometry().rotation.inverse() * velocity;
                particles.set_velocity(index, own).expect("it exists");
            }
        }
    }

    /// A tick.
    pub fn tick(&mut self) {
        self.ticks += 1;
        let way = self.speed * self.ticks as f32 / RATE;
        let scene = self.scene;
        let world = self.app.world_mut();
        let mut moved = world.query::<(&Moved, &mut Transform)>();
        for (Moved(sign), mut at) in moved.iter_mut(world) {
            match scene {
                // Around the edge in the middle, by half a turn.
                Scene::Fold => {
                    let angle = (way / 0.5).min(0.98 * TAU / 2.0);
                    at.translation = Vec3::new(0.0, 0.02 + 0.5 * angle.sin(), -0.5 * angle.cos());
                }
                Scene::Twist => {
                    let angle = (way / 0.2).min(2.0 * TAU);
                    let nearer = 0.2 * angle / (2.0 * TAU);
                    at.translation = Vec3::X * *sign * (0.6 - nearer);
                    at.rotation = Quat::from_rotation_x(*sign * angle);
                }
                Scene::Balls => {
                    let apart = (0.9 - way).max(BALL + 0.01);
                    at.translation.z = *sign * apart;
                }
                Scene::Pole => {
                    let angle = (way / POLE).min(3.0 * TAU);
                    at.rotation = Quat::from_rotation_y(angle);
                }
                _ => {}
            }
        }
        let is_let_go = scene == Scene::Fold && way / 0.5 > 1.1 * TAU / 2.0;
        if is_let_go {
            let mut held = world.query_filtered::<Entity, With<ClothAttachments>>();
            for cloth in held.iter(world).collect::<Vec<_>>() {
                world.entity_mut(cloth).remove::<ClothAttachments>();
            }
        }
        self.app.update();
    }

    /// What the ticks took (ms).
    pub fn ms(&self) -> &[f64] {
        &self.app.world().resource::<Clock>().1
    }

    /// Pairs of features that are near each other, and searches in the last tick.
    pub fn pairs(&mut self) -> (usize, u32) {
        let world = self.app.world_mut();
        let mut all = world.query::<&ClothStats>();
        all.iter(world).fold((0, 0), |(pairs, searches), stats| {
            (
                pairs.max(stats.layer_pairs),
                searches.max(stats.layer_searches),
            )
        })
    }

    /// Whether all cloths sleep.
    pub fn is_asleep(&mut self) -> bool {
        let world = self.app.world_mut();
        let mut all = world.query::<&ClothStats>();
        all.iter(world).all(|stats| stats.is_asleep)
    }

    /// A cloth as it is now, in the frame that it is simulated in: for others to start from.
    pub fn cloth(&mut self) -> (Arc<Surface>, ClothParticles, Isometry3d) {
        let world = self.app.world_mut();
        let mut cloths = world.query::<(&ClothBuilt, &ClothParticles, &ClothFrame)>();
        let (built, particles, frame) = cloths.iter(world).next().expect("a cloth");
        (built.surface().clone(), particles.clone(), frame.isometry())
    }

    /// Pairs of triangles that intersect.
    pub fn intersections(&mut self) -> usize {
        crossed(self.app.world_mut())
    }
}

impl Scene {
    fn spawn(self, world: &mut World, side: u32, layers: Option<ClothSelfCollision>) {
        let spacing = 1.0 / (side - 1) as f32;
        let sheet = Cloth::new(side, side, spacing);
        let lying = sheet.clone().lying().centred();
        let standing = sheet.clone().centred();
        let awake = ClothSettings {
            sleeps: self == Self::Stack,
            ..default()
        };
        if matches!(
            self,
            Self::Fold | Self::Drop | Self::Stack | Self::Random(_) | Self::Folded
        ) {
            world.spawn(ClothCollider::plane());
        }
        let mut cloths = Vec::new();
        match self {
            Self::Fold => {
                let edge = world.spawn((Moved(1.0), Transform::from_xyz(0.0, 0.02, -0.5)));
                let held = ClothAttachments::new([(Pin::Row(0), edge.id())]);
                let place = Transform::from_xyz(0.0, 0.02, 0.0);
                cloths.push(world.spawn((lying, Pins::none(), held, place)).id());
            }
            Self::Twist => {
                let [left, right] = [-1.0, 1.0].map(|sign| {
                    let place = Transform::from_xyz(0.6 * sign, 0.0, 0.0);
                    world.spawn((Moved(sign), place)).id()
                });
                let rows = side.div_ceil(3);
                let spacing = 1.2 / (side - 1) as f32;
                let strip = Cloth::new(side, rows, spacing).centred();
                let held =
                    ClothAttachments::new([(Pin::Column(0), left), (Pin::Column(side - 1), right)]);
                cloths.push(world.spawn((strip, Pins::none(), held)).id());
            }
            Self::Drop => {
                let place = Transform::from_xyz(0.0, 0.6, 0.0).with_rotation(Quat::from_euler(
                    EulerRot::XYZ,
                    0.1,
                    0.03,
                    0.02,
                ));
                cloths.push(world.spawn((standing, Pins::none(), place)).id());
            }
            Self::Stack => {
                for index in 0..10 {
                    let place = Transform::from_xyz(0.0, 0.01 + 0.02 * index as f32, 0.0)
                        .with_rotation(Quat::from_rotation_y(0.13 * index as f32));
                    let spawned = (lying.clone(), Pins::none(), place);
                    cloths.push(world.spawn(spawned).id());
                }
            }
            Self::Balls => {
                for (sign, off) in [(1.0, Vec2::new(0.1, 0.0)), (-1.0, Vec2::new(-0.05, 0.05))] {
                    let place = Transform::from_xyz(off.x, off.y, 0.9 * sign);
                    world.spawn((ClothCollider::ball(BALL), Moved(sign), place));
                }
                cloths.push(world.spawn((standing, Pins::top_row())).id());
            }
            Self::Pole => {
                let pole = (ClothCollider::capsule(POLE, 1.0), Moved(1.0));
                let pole = world.spawn((pole, Transform::default())).id();
                let held = ClothAttachments::new([(Pin::Column(0), pole)]);
                let place = Transform::from_xyz(0.5 + POLE + 0.02, 0.0, 0.0);
                cloths.push(world.spawn((standing, Pins::none(), held, place)).id());
            }
            Self::Random(seed) => {
                let mut draw = Draw(seed.wrapping_mul(7919) + 1);
                let angles = std::array::from_fn::<_, 3, _>(|_| 3.0 * draw.next());
                let turned = Quat::from_euler(EulerRot::XYZ, angles[0], angles[1], angles[2]);
                let place = Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(turned);
                cloths.push(world.spawn((standing, Pins::none(), place)).id());
            }
            Self::Flat => {
                let place = Transform::from_xyz(0.0, 50.0, 0.0);
                cloths.push(world.spawn((lying, Pins::none(), place)).id());
            }
            Self::Folded => cloths.push(world.spawn((lying, Pins::none())).id()),
            Self::Fifty => {
                for index in 0..50 {
                    let place = Transform::from_xyz(
                        1.5 * (index % 8) as f32,
                        0.0,
                        1.5 * (index / 8) as f32,
                    );
                    let spawned = (standing.clone(), Pins::top_row(), place);
                    cloths.push(world.spawn(spawned).id());
                }
            }
        }
        for cloth in cloths {
            let mut cloth = world.entity_mut(cloth);
            cloth.insert(awake);
            if let Some(layers) = layers {
                cloth.insert(layers);
            }
        }
    }
}

/// Where a point of a flat sheet is that lies folded around the x axis, on the floor (m).
fn folded(Vec3 { x, z, .. }: Vec3) -> Vec3 {
    const RADIUS: f32 = 0.004;
    let half = TAU / 4.0 * RADIUS;
    let low = 0.003;
    if z < -half {
        Vec3::new(x, low, z + half)
    } else if z > half {
        Vec3::new(x, low + 2.0 * RADIUS, half - z)
    } else {
        let angle = z / RADIUS;
        Vec3::new(x, low + RADIUS * (1.0 + angle.sin()), RADIUS * angle.cos())
    }
}

/// Numbers between −1 and 1, as if drawn.
struct Draw(u32);

impl Draw {
    fn next(&mut self) -> f32 {
        // Numerical Recipes' generator of 32 bits; the first few are alike for seeds that are.
        for _ in 0..4 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        }
        (self.0 >> 8) as f32 / (1 << 23) as f32 - 1.0
    }
}
