//! Apps without a renderer, with many cloths and many colliders.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::timed::{Clock, TimedTicks};

/// How far cloths are from each other, and colliders (m).
const APART: f32 = 3.0;

/// How far below the cloths the colliders are that are far (m).
const BELOW: f32 = 30.0;

/// What cloths and colliders do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Cloths hang and do not rest; colliders are far and stand still.
    Awake,
    /// Cloths sleep; colliders are far and stand still.
    Asleep,
    /// As the first, and the colliders move.
    Moving,
    /// As the second, and the colliders move.
    AsleepMoving,
    /// Each cloth lies on a collider of its own, and does not rest.
    Touching,
}

impl State {
    pub fn name(self) -> &'static str {
        match self {
            Self::Awake => "awake, far",
            Self::Asleep => "asleep, far",
            Self::Moving => "awake, far, moving",
            Self::AsleepMoving => "asleep, far, moving",
            Self::Touching => "touching",
        }
    }

    fn sleeps(self) -> bool {
        matches!(self, Self::Asleep | Self::AsleepMoving)
    }
}

#[derive(Component)]
struct Mover;

/// An app, and what was measured of it.
pub struct Stage {
    app: App,
    state: State,
}

impl Stage {
    /// Cloths of so many particles along each side, and so many colliders.
    pub fn new(
        [cloths, side]: [u32; 2],
        colliders: u32,
        state: State,
        shape: &ClothCollider,
    ) -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
            .add_plugins(TimedTicks)
            .add_systems(FixedFirst, move_colliders);
        let is_touching = state == State::Touching;
        let settings = ClothSettings {
            sleeps: state.sleeps(),
            ..default()
        };
        let world = app.world_mut();
        for at in places(cloths) {
            let cloth = Cloth::new(side, side, 1.6 / (side - 1) as f32).centred();
            let pins = match state {
                // A cloth whose particles are all held rests at once.
                State::Asleep | State::AsleepMoving => Pins::filter(|_, _| true),
                State::Touching => Pins::none(),
                State::Awake | State::Moving => Pins::top_row(),
            };
            let tilt = if is_touching {
                Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2)
            } else {
                Quat::IDENTITY
            };
            let place = Transform::from_translation(at).with_rotation(tilt);
            world.spawn((cloth, pins, settings, place));
        }
        let below = if is_touching { 0.42 } else { BELOW };
        for at in places(colliders) {
            let place = Transform::from_translation(at - Vec3::Y * below);
            let collider = world.spawn((shape.clone(), place)).id();
            if matches!(state, State::Moving | State::AsleepMoving) {
                world.entity_mut(collider).insert(Mover);
            }
        }
        app.finish();
        app.cleanup();
        Self { app, state }
    }

    /// Ticks that are not measured.
    pub fn warm_up(&mut self, ticks: usize) {
        (0..ticks).for_each(|_| self.app.update());
        self.app.world_mut().resource_mut::<Clock>().1.clear();
    }

    /// One tick.
    pub fn turn(&mut self) {
        self.app.update();
    }

    /// What the ticks took (ms).
    pub fn ms(&self) -> &[f64] {
        &self.app.world().resource::<Clock>().1
    }

    /// Whether all is as its state says: colliders near, or not, and cloths asleep, or not.
    pub fn is_as_said(&mut self) -> bool {
        let has_colliders = {
            let world = self.app.world_mut();
            world.query::<&ClothCollider>().iter(world).len() > 0
        };
        let (sleeps, touches) = (self.state.sleeps(), self.state == State::Touching);
        let world = self.app.world_mut();
        let mut all = world.query::<&ClothStats>();
        all.iter(world).all(|stats| {
            stats.is_asleep == sleeps && (stats.contacts > 0) == (touches && has_colliders)
        })
    }
}

/// In a square.
fn places(count: u32) -> impl Iterator<Item = Vec3> {
    let side = f64::from(count).sqrt().ceil() as u32;
    (0..count)
        .map(move |index| Vec3::new((index % side) as f32, 0.0, (index / side) as f32) * APART)
}

/// Back and forth by 1.3 m/s.
fn move_colliders(mut movers: Query<&mut Transform, With<Mover>>, mut ticks: Local<u32>) {
    *ticks += 1;
    let step = if *ticks % 64 < 32 { 0.02 } else { -0.02 };
    for mut mover in &mut movers {
        mover.translation.x += step;
    }
}
