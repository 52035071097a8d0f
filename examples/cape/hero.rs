//! How the hero moves: around a circle, as a game's own controller would, and which animation goes with that.

use std::{f32::consts::PI, time::Duration};

use bevy::{gltf::GltfAssetLabel, prelude::*};

use crate::scene::HERO;

/// Radius of the circle (m), speed (m/s) and how fast it is reached (m/s²).
const RADIUS: f32 = 2.3;
const SPEED: f32 = 4.2;
const PICK_UP: f32 = 7.0;
/// Speed up into a jump (m/s), and gravity (m/s²).
const JUMP: f32 = 4.4;
const GRAVITY: f32 = 9.81;
/// From one animation to another.
const FADE: Duration = Duration::from_millis(180);
/// Where it begins on the circle (rad).
const BEGINS: f32 = -2.5;

/// A hero, and what it is to do.
#[derive(Component)]
pub struct Hero {
    pub runs: bool,
    /// Once.
    pub jumps: bool,
    pub teleports: bool,
    /// Where on the circle (rad), how fast (m/s), how high (m) and how fast upwards (m/s).
    angle: f32,
    speed: f32,
    height: f32,
    rise: f32,
}

impl Default for Hero {
    fn default() -> Self {
        Self {
            runs: true,
            jumps: false,
            teleports: false,
            angle: BEGINS,
            speed: 0.0,
            height: 0.0,
            rise: 0.0,
        }
    }
}

impl Hero {
    /// Where it is, looking along its way.
    pub fn place(&self) -> Transform {
        let (sin, cos) = self.angle.sin_cos();
        let place = Vec3::new(RADIUS * sin, self.height, RADIUS * cos);
        Transform::from_translation(place).looking_to(Vec3::new(cos, 0.0, -sin), Vec3::Y)
    }
}

/// Moves heroes, in fixed ticks.
pub fn go(mut heroes: Query<(&mut Hero, &mut Transform)>, time: Res<Time>) {
    let seconds = time.delta_secs();
    for (mut hero, mut place) in &mut heroes {
        let wanted = if hero.runs { SPEED } else { 0.0 };
        let step = PICK_UP * seconds;
        hero.speed += (wanted - hero.speed).clamp(-step, step);
        hero.angle += hero.speed / RADIUS * seconds;
        if std::mem::take(&mut hero.jumps) && hero.height == 0.0 {
            hero.rise = JUMP;
        }
        hero.height = (hero.height + hero.rise * seconds).max(0.0);
        hero.rise = match hero.height > 0.0 {
            true => hero.rise - GRAVITY * seconds,
            false => 0.0,
        };
        if std::mem::take(&mut hero.teleports) {
            hero.angle += PI;
        }
        *place = hero.place();
    }
}

/// The animations of the file.
#[derive(Resource)]
pub struct Moves {
    graph: Handle<AnimationGraph>,
    idle: AnimationNodeIndex,
    run: AnimationNodeIndex,
    jump: AnimationNodeIndex,
}

pub fn load_moves(
    mut commands: Commands,
    assets: Res<AssetServer>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
) {
    let clips = [0, 1, 2].map(|clip| assets.load(GltfAssetLabel::Animation(clip).from_asset(HERO)));
    let (graph, nodes) = AnimationGraph::from_clips(clips);
    commands.insert_resource(Moves {
        graph: graphs.add(graph),
        idle: nodes[0],
        run: nodes[1],
        jump: nodes[2],
    });
}

/// A player that the file's scene came with gets its animations.
pub fn prepare_player(added: On<Add, AnimationPlayer>, moves: Res<Moves>, mut commands: Commands) {
    commands.entity(added.entity).insert((
        AnimationGraphHandle(moves.graph.clone()),
        AnimationTransitions::new(),
    ));
}

/// Plays what a hero does.
pub fn animate(
    heroes: Query<&Hero>,
    parents: Query<&ChildOf>,
    mut players: Query<(Entity, &mut AnimationPlayer, &mut AnimationTransitions)>,
    moves: Res<Moves>,
) {
    for (entity, mut player, mut transitions) in &mut players {
        let above = parents
            .iter_ancestors(entity)
            .find_map(|above| heroes.get(above).ok());
        let Some(hero) = above else {
            continue;
        };
        let wanted = if hero.height > 0.0 {
            moves.jump
        } else if hero.speed > 0.5 {
            moves.run
        } else {
            moves.idle
        };
        if transitions.get_main_animation() != Some(wanted) {
            let playing = transitions.play(&mut player, wanted, FADE);
            if wanted != moves.jump {
                playing.repeat();
            }
        }
    }
}

/// Without anybody at the keys: stands, runs, jumps, teleports, and stands again.
pub struct ScriptPlugin;

impl Plugin for ScriptPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(FixedUpdate, follow_script.before(go));
    }
}

fn follow_script(mut heroes: Query<&mut Hero>, time: Res<Time>) {
    let seconds = time.elapsed_secs();
    let is_now = |at: f32| (at..at + time.delta_secs()).contains(&seconds);
    for mut hero in &mut heroes {
        hero.runs = (1.2..7.5).contains(&seconds);
        hero.jumps = is_now(5.0);
        hero.teleports = is_now(6.5);
    }
}
