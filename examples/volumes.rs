//! A debug view of bounding volumes: six equal cloths and balls, each searched by another kind of volume.
//!
//! The volumes are sphere, AABB, OBB, and k-DOPs of 14, 18 and 26 faces. One level of each tree is drawn:
//!
//! - red: the volume touches the ball, or may do so within the tick
//! - green: the search visited it, and nothing touches it
//! - faint: the search did not visit it, since a volume above it is green
//!
//! Each cloth has a `SearchMethod` and a `ShowClothGizmos`. The labels are Bevy's text gizmos with figures from
//! `ClothStats`. All six cloths move identically, bit for bit.
//!
//! ```sh
//! cargo run --example volumes                         # a window, or headless where no window opens
//! cargo run --example volumes -- --headless --out DIR # no window: prints a report, saves DIR/volumes.png
//! ```
//!
//! | Key | Action |
//! |---|---|
//! | Left drag on a cloth | pull it |
//! | Left drag, right drag, wheel | orbit, pan, zoom |
//! | Space | pause, resume |
//! | N | single step while paused |
//! | M | next fabric |
//! | R | reset the cloths |
//! | P | show, hide the panel |
//! | G | show, hide springs |
//! | L | show the next level of bounding volumes |
//! | B | next search method |
//! | C | next contact method: automatic, particles, triangles |

use std::{f32::consts::TAU, process::ExitCode};

use bevy::{color::palettes::css, light::NotShadowCaster, prelude::*};
use bevy_drape::{
    hierarchy::{BoundRule, BoundingVolume},
    prelude::*,
};
use examples_shared::headless::{Picture, Run};
use examples_shared::stage::{Grid, Shot, StagePlugin};
use examples_shared::workshop::{Weave, Workshop};
use examples_shared::{measured::median, report::print, start::Example};
use serde::Serialize;

/// Width of a cloth (m). This and all places are sums of few powers of two, so that the cloths differ by nothing, not even
/// by rounding.
const WIDTH: f32 = 1.5;
/// The level that is drawn first: patches of 4 × 4 particles.
const LEVEL: usize = 3;
/// The ball's radius (m).
const RADIUS: f32 = 0.3;
/// Distance between the cloths (m).
const PITCH: Vec2 = Vec2::new(2.5, 2.25);

fn build(app: &mut App) {
    let stage = StagePlugin {
        has_floor: false,
        ..StagePlugin::lit_from(4.0, 8.0, 3.0)
    };
    app.add_plugins((stage, DrapePlugins::default()))
        .insert_resource(ClearColor(Color::srgb(0.22, 0.24, 0.27)))
        .add_systems(Startup, spawn_panels)
        .add_systems(FixedUpdate, swing.before(ClothSystems::Prepare))
        .add_systems(Update, write_labels);
}

/// Where a ball swings.
#[derive(Component)]
struct Swing(Vec3);

fn spawn_panels(mut shop: Workshop, mut store: ResMut<GizmoConfigStore>) {
    let (config, look) = store.config_mut::<ClothGizmos>();
    config.line.width = 1.6;
    look.unvisited = Color::srgba(0.5, 0.6, 0.7, 0.12);
    let weave = shop.weave(Weave::Plain, 2, |_, _| Color::srgb(0.33, 0.43, 0.72));
    let sheer = shop.paint(StandardMaterial {
        // The ball, behind, is seen through it.
        base_color: Color::WHITE.with_alpha(0.6),
        alpha_mode: AlphaMode::Blend,
        ..weave
    });
    let orange = shop.paint(Color::srgb(0.95, 0.6, 0.2));
    let ball = shop.mesh(Sphere::new(RADIUS).mesh().uv(64, 32));
    let side = shop.grid.0;
    for (place, (_, volume)) in BoundingVolume::ALL.into_iter().enumerate() {
        let (row, column) = ((place / 3) as f32, (place % 3) as f32);
        let middle = Vec3::new((column - 1.0) * PITCH.x, (0.5 - row) * PITCH.y, 0.0);
        shop.commands.spawn((
            Name::new(volume.name()),
            Cloth::new(side, side, WIDTH / (side - 1) as f32).centred(),
            SearchMethod::Tree(volume, BoundRule::Refit),
            ShowClothGizmos::level(LEVEL),
            sheer.clone(),
            NotShadowCaster,
            Transform::from_translation(middle),
        ));
        let rest = middle + Vec3::new(0.125, -0.1875, 0.0);
        shop.commands.spawn((
            ClothCollider::ball(RADIUS),
            Swing(rest),
            ball.clone(),
            orange.clone(),
            Transform::from_translation(rest + Vec3::NEG_Z),
        ));
    }
}

/// From behind into the cloth and back, every six seconds.
fn swing(mut balls: Query<(&Swing, &mut Transform)>, time: Res<Time>) {
    let angle = TAU * time.elapsed_secs() / 6.0;
    for (swing, mut transform) in &mut balls {
        transform.translation = swing.0 + Vec3::NEG_Z * (0.4 + 0.5 * angle.cos());
    }
}

fn write_labels(
    cloths: Query<(&Transform, &SearchMethod, &ClothStats), With<Cloth>>,
    mut gizmos: Gizmos,
) {
    for (transform, method, stats) in &cloths {
        let mut write = |text: &str, size: f32, up: f32, color: Color| {
            let place = transform.translation + Vec3::Y * (WIDTH / 2.0 + up);
            gizmos.text(
                Isometry3d::from_translation(place),
                text,
                size,
                Vec2::ZERO,
                color,
            );
        };
        let name = method.to_string();
        write(&name, 0.13, 0.28, Color::WHITE);
        let figures = format!("{} nodes visited", stats.nodes_visited);
        write(&figures, 0.09, 0.12, css::LIGHT_GRAY.into());
    }
}

/// What is printed of one cloth: the most of any tick, and medians over those in which it was searched.
#[derive(Serialize, Default)]
struct Row {
    search: String,
    nodes_visited: f64,
    particles_tested: f64,
    rebuild_ms: f64,
    query_ms: f64,
}

#[derive(Serialize)]
struct Report {
    ticks: u64,
    particles: u32,
    cloths: Vec<Row>,
    /// Whether all cloths end in the same state, bit for bit.
    same: bool,
    #[serde(flatten)]
    picture: Picture,
}

/// Nodes, particles, and the times of refit and search (ms).
#[derive(Component, Default)]
struct Measured([Vec<f64>; 4]);

fn measure(mut cloths: Query<(&ClothStats, &mut Measured)>) {
    for (stats, mut measured) in &mut cloths {
        if stats.leaf_tests > 0 {
            let figures = [
                stats.nodes_visited as f64,
                stats.leaf_tests as f64,
                stats.rebuild_ms,
                stats.query_ms,
            ];
            for (all, figure) in measured.0.iter_mut().zip(figures) {
                all.push(figure);
            }
        }
    }
}

fn report(mut run: Run) -> ExitCode {
    run.app
        .register_required_components::<Cloth, Measured>()
        .add_systems(FixedLast, measure);
    let picture = run.picture();
    let figures = run.finish();
    let world = run.app.world_mut();
    let mut cloths = world.query::<(&SearchMethod, &mut Measured, &ClothParticles)>();
    let mut first: Option<Vec<Vec3>> = None;
    let mut same = true;
    let mut rows = Vec::new();
    for (method, mut measured, particles) in cloths.iter_mut(world) {
        let [nodes, tested, rebuild, query] = &mut measured.0;
        let most = |figures: &[f64]| figures.iter().copied().fold(0.0, f64::max);
        rows.push(Row {
            search: method.to_string(),
            nodes_visited: most(nodes),
            particles_tested: most(tested),
            rebuild_ms: median(rebuild),
            query_ms: median(query),
        });
        let positions: Vec<Vec3> = particles.positions().collect();
        same &= *first.get_or_insert_with(|| positions.clone()) == positions;
    }
    let Grid(grid) = *world.resource::<Grid>();
    let report = Report {
        ticks: figures.ticks,
        particles: grid * grid,
        cloths: rows,
        same,
        picture,
    };
    print(&report, run.options.json, print_report)
}

fn print_report(report: &Report) {
    println!("Six bounding volumes, headless");
    println!(
        "  ticks    {}; {} particles in each cloth",
        report.ticks, report.particles
    );
    println!(
        "  {:<18} {:>8} {:>10} {:>10} {:>10}",
        "searched by", "nodes", "particles", "refit, ms", "search, ms"
    );
    for row in &report.cloths {
        println!(
            "  {:<18} {:>8} {:>10} {:>10.4} {:>10.4}",
            row.search, row.nodes_visited, row.particles_tested, row.rebuild_ms, row.query_ms
        );
    }
    let same = if report.same {
        "identical in all six, bit for bit"
    } else {
        "differs"
    };
    println!("  motion   {same}");
    println!("  picture  {}", report.picture);
}

fn main() -> ExitCode {
    Example {
        name: "volumes",
        about: "Debug view: six kinds of bounding volume, side by side.",
        title: "six bounding volumes (debug view)",
        seconds: "3",
        particles: 32,
        shot: Shot {
            from: Vec3::new(-2.6, 1.6, 12.0),
            focus: Vec3::new(0.0, 0.12, 0.0),
            fov: 0.375,
        },
        drawn_at: f64::INFINITY,
        scene: build,
        report,
    }
    .run()
}
