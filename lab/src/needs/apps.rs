//! Cloths and a ball in an app without a renderer: the time of all of the plugin's systems in a tick.

use bevy::prelude::*;
use bevy_drape::{
    hierarchy::{Probe, brute_force},
    prelude::*,
};

use super::{INSIDE, Row};
use crate::{
    experiment::Run,
    timed::{Clock, TimedTicks},
};

pub const ONE: &str = "one cloth, 64²";
pub const FAR: &str = "awake, ball far";
pub const NEAR: &str = "awake, ball near";
pub const TOUCHING: &str = "awake, ball drags it";
pub const ASLEEP: &str = "asleep on the ball";

pub const HUNDRED: &str = "100 cloths, 16²";
pub const ALL_AWAKE: &str = "all awake, 1 touched";
pub const ONE_TOUCHED: &str = "99 asleep, 1 touched";
pub const ALL_ASLEEP: &str = "all asleep";

/// Of the ball (m).
const RADIUS: f32 = 0.3;
/// Deeper than rounding (m).
const DEEP: f32 = 1.0e-5;

/// An app with cloths and one ball.
struct Stage {
    app: App,
    ball: Entity,
    /// Where the ball is, as it moves or for good (m).
    place: fn(tick: u32) -> Vec3,
    tick: u32,
    ms: Vec<f64>,
    left_inside: usize,
    /// The most colliders near one cloth, and particles of it that they touched, in any tick.
    near: usize,
    contacts: usize,
}

impl Stage {
    fn new(place: fn(u32) -> Vec3, cloths: u32, cloth: &Cloth, sleeps: bool) -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
            .add_plugins(TimedTicks);
        let material = ClothMaterial {
            damping: 0.1,
            ..default()
        };
        let settings = ClothSettings {
            sleeps,
            ..default()
        };
        for index in 0..cloths {
            let at = Vec3::new((index % 10) as f32, 0.0, (index / 10) as f32);
            let place = Transform::from_translation(at * 4.0);
            app.world_mut()
                .spawn((cloth.clone(), material, settings, place));
        }
        let collider = (
            ClothCollider::ball(RADIUS),
            Transform::from_translation(place(0)),
        );
        let ball = app.world_mut().spawn(collider).id();
        app.finish();
        app.cleanup();
        // Nothing is in time with the first update.
        app.update();
        Self {
            app,
            ball,
            place,
            tick: 0,
            ms: Vec::new(),
            left_inside: 0,
            near: 0,
            contacts: 0,
        }
    }

    fn update(&mut self) {
        self.tick += 1;
        let place = (self.place)(self.tick);
        if place != (self.place)(self.tick - 1)
            && let Some(mut transform) = self.app.world_mut().get_mut::<Transform>(self.ball)
        {
            transform.translation = place;
        }
        self.app.update();
    }

    /// Runs until this many cloths are asleep.
    fn settle(&mut self, asleep: usize) {
        for _ in 0..4000 {
            if self.asleep() >= asleep {
                return;
            }
            self.update();
        }
        panic!("{} of {asleep} cloths sleep", self.asleep());
    }

    fn asleep(&mut self) -> usize {
        let world = self.app.world_mut();
        let mut stats = world.query::<&ClothStats>();
        stats.iter(world).filter(|stats| stats.is_asleep).count()
    }

    /// A tick, with its time, and a look at what the ball has not pushed out.
    fn turn(&mut self) {
        self.update();
        let times = &self.app.world().resource::<Clock>().1;
        self.ms.extend(times.last());
        let centre = (self.place)(self.tick);
        let world = self.app.world_mut();
        let mut cloths =
            world.query::<(&ClothParticles, &ClothFrame, &ClothSettings, &ClothStats)>();
        for (particles, frame, settings, stats) in cloths.iter(world) {
            self.near = self.near.max(stats.colliders_near);
            self.contacts = self.contacts.max(stats.contacts);
            let seen = frame.isometry().inverse() * centre;
            let ball = Probe::ball(seen, RADIUS - DEEP, settings.particle_radius);
            self.left_inside = self.left_inside.max(brute_force(particles, &ball).len());
        }
    }

    fn row(&self, scene: &str, choice: &str) -> Row {
        Row::new(scene, choice, &self.ms, (self.left_inside as f64, INSIDE))
    }
}

fn far(_: u32) -> Vec3 {
    Vec3::new(0.0, 1.0e3, 0.0)
}

/// Within the cloth's bounding sphere, and not within reach of a tick.
fn near(_: u32) -> Vec3 {
    Vec3::new(0.95, -0.95, 0.6)
}

fn resting(_: u32) -> Vec3 {
    Vec3::new(0.95, -0.95, 0.2)
}

fn dragging(tick: u32) -> Vec3 {
    Vec3::new(0.95, -0.95, 0.2 + 0.05 * (tick as f32 / 30.0).sin())
}

/// One cloth, and what a ball does near it.
pub fn one_cloth(run: &mut Run) -> Vec<Row> {
    let turns = run.either(100, 1500);
    run.set("one cloth", format!("64², spacing 0.03 m, ball of 0.3 m, 20 sub-steps: all of the plugin's systems, {turns} ticks"));
    let stage = |place, sleeps| Stage::new(place, 1, &Cloth::new(64, 64, 0.03), sleeps);
    let mut stages = [
        (FAR, stage(far, false)),
        (NEAR, stage(near, false)),
        (TOUCHING, stage(dragging, false)),
        (ASLEEP, stage(resting, true)),
    ];
    stages[3].1.settle(1);
    // A ball that appears in the cloth is let out slowly.
    for (_, stage) in &mut stages[..3] {
        (0..120).for_each(|_| stage.update());
    }
    for _ in 0..turns {
        stages.iter_mut().for_each(|(_, stage)| stage.turn());
    }
    let seen = stages
        .each_ref()
        .map(|(_, stage)| (stage.near, stage.contacts > 0));
    assert_eq!(
        seen[..3],
        [(0, false), (1, false), (1, true)],
        "far, near and touching"
    );
    stages
        .iter()
        .map(|(choice, stage)| stage.row(ONE, choice))
        .collect()
}

/// A hundred cloths, and a ball that touches one of them, or none.
pub fn many_cloths(run: &mut Run) -> Vec<Row> {
    let turns = run.either(30, 500);
    run.set(
        "100 cloths",
        format!("16², spacing 0.12 m, the same ball: {turns} ticks, awake ones on all threads"),
    );
    let stage = |place, sleeps| Stage::new(place, 100, &Cloth::new(16, 16, 0.12), sleeps);
    let mut stages = [
        (ALL_AWAKE, stage(dragging, false)),
        (ONE_TOUCHED, stage(dragging, true)),
        (ALL_ASLEEP, stage(far, true)),
    ];
    stages[1].1.settle(99);
    stages[2].1.settle(100);
    (0..30).for_each(|_| stages[0].1.update());
    for _ in 0..turns {
        stages.iter_mut().for_each(|(_, stage)| stage.turn());
    }
    stages
        .iter()
        .map(|(choice, stage)| stage.row(HUNDRED, choice))
        .collect()
}
