#[path = "lab/games/scenes.rs"]
mod scenes;
use std::time::Instant;
use bevy::{ecs::schedule::SingleThreadedExecutor, prelude::*, time::TimeUpdateStrategy};
use bevy_drape::{contact::intersections, plugin::ClothBuilt, prelude::*};
use scenes::*;

#[derive(Resource)]
struct Clock(Instant, Vec<f64>);
fn start(mut c: ResMut<Clock>) { c.0 = Instant::now(); }
fn stop(mut c: ResMut<Clock>) { let p = c.0.elapsed().as_secs_f64(); c.1.push(1e3 * p); }

fn count(world: &mut World) -> usize {
    let mut cloths = world.query::<(&ClothBuilt, &ClothParticles, &ClothFrame)>();
    let placed: Vec<_> = cloths.iter(world).map(|(b, p, f)| (b.surface().clone(), p.positions().map(|x| f.to_world(x)).collect::<Vec<_>>())).collect();
    let v: Vec<_> = placed.iter().map(|(s, p)| (&**s, p.clone())).collect();
    intersections(&v)
}

fn run(scene: &Scene, with: bool, check: bool, trace: bool) -> (f64, f64, f64, f64, usize, usize, f64, usize) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default()))
        .init_asset::<Mesh>()
        .add_plugins(DrapePlugins::default())
        .insert_resource(Time::<Fixed>::from_hz(RATE as f64))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
        .insert_resource(Clock(Instant::now(), vec![]))
        .edit_schedule(FixedUpdate, |s| { s.set_executor(SingleThreadedExecutor::new()); })
        .add_systems(FixedUpdate, (start.before(ClothSystems::Prepare), stop.after(ClothSystems::WriteBack)));
    let layers = Layers(with.then(ClothSelfCollision::default));
    scene.spawn(app.world_mut(), &layers);
    app.finish(); app.cleanup();
    (0..3).for_each(|_| app.update());
    // Begin as moved.
    let world = app.world_mut();
    let mut moved = world.query::<(&Moved, &mut ClothParticles, &ClothFrame)>();
    for (m, mut p, f) in moved.iter_mut(world) {
        for i in 0..p.len() { let at = f.to_world(p.position(i).unwrap()); let own = f.isometry().inverse() * m.0(at); p.set_position(i, own).unwrap(); }
    }
    app.world_mut().resource_mut::<Clock>().1.clear();
    let (mut bad, mut badt, mut searches, mut pairs) = (0, 0, 0.0, 0);
    let t0 = Instant::now();
    let mut ticks = scene.ticks;
    for t in 0..scene.ticks {
        follow(app.world_mut(), t as u32);
        app.update();
        if check { let n = count(app.world_mut()); bad = bad.max(n); badt += usize::from(n > 0); }
        let w = app.world_mut();
        let mut st = w.query::<&ClothStats>();
        let (mut s, mut p) = (0, 0);
        for x in st.iter(w) { s = s.max(x.layer_searches); p = p.max(x.layer_pairs); }
        searches += s as f64; pairs = pairs.max(p);
        if trace && t % 10 == 0 { println!("   {t}: {:.2} ms pairs {p} searches {s} substeps {:?}", app.world().resource::<Clock>().1.last().unwrap().clone(), st.iter(app.world()).next().map(|s| s.substeps)); }
        if t0.elapsed().as_secs_f64() > 60.0 { ticks = t + 1; break; }
    }
    let mut v = app.world().resource::<Clock>().1.clone();
    let mean = v.iter().sum::<f64>() / v.len() as f64;
    v.sort_by(f64::total_cmp);
    (mean, v[v.len() / 2], v[v.len() * 99 / 100], *v.last().unwrap(), bad, badt, searches / ticks as f64, pairs)
}

fn hostile() {
    let states: [(&str, fn(usize) -> Vec3); 6] = [
        ("plane", |i| Vec3::new(((i * 7919) % 400) as f32 / 400.0, 0.0, ((i * 104729) % 401) as f32 / 401.0)),
        ("flat fold", |i| { let x = (i % 20) as f32 * 0.05; Vec3::new(if x > 0.5 { 1.0 - x } else { x }, 0.0, (i / 20) as f32 * 0.05) }),
        ("line", |i| Vec3::new(((i * 7919) % 400) as f32 / 400.0, 0.0, 0.0)),
        ("point", |_| Vec3::ZERO),
        ("cube", |i| Vec3::new(((i * 7919) % 400) as f32 / 400.0, ((i * 104729) % 401) as f32 / 401.0, ((i * 1299709) % 397) as f32 / 397.0)),
        ("small cube", |i| 0.05 * Vec3::new(((i * 7919) % 400) as f32 / 400.0, ((i * 104729) % 401) as f32 / 401.0, ((i * 1299709) % 397) as f32 / 397.0)),
    ];
    for (name, state) in states {
        for seconds in [1e-6, 1.0 / 240.0, 1.0 / 60.0, 0.5] {
            for two in [false, true] {
            let mut app = App::new();
            app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default())).init_asset::<Mesh>().add_plugins(DrapePlugins::default())
                .insert_resource(Time::<Fixed>::from_seconds(seconds)).insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
                .insert_resource(Clock(Instant::now(), vec![]))
                .edit_schedule(FixedUpdate, |s| { s.set_executor(SingleThreadedExecutor::new()); })
                .add_systems(FixedUpdate, (start.before(ClothSystems::Prepare), stop.after(ClothSystems::WriteBack)));
            app.world_mut().spawn(ClothCollider::plane());
            for _ in 0..if two { 2 } else { 1 } {
                let n = if two { 14 } else { 20 };
                app.world_mut().spawn((Cloth::new(n, n, 0.05), Pins::none(), ClothSelfCollision::default(), Transform::from_xyz(0.0, 0.5, 0.0)));
            }
            app.finish(); app.cleanup();
            (0..3).for_each(|_| app.update());
            let w = app.world_mut();
            let mut q = w.query::<&mut ClothParticles>();
            for mut p in q.iter_mut(w) { for i in 0..p.len() { p.set_position(i, state(i)).unwrap(); } }
            w.resource_mut::<Clock>().1.clear();
            for _ in 0..30 { app.update(); }
            let v = &app.world().resource::<Clock>().1;
            let worst = v.iter().copied().fold(0.0, f64::max);
            let mean = v.iter().sum::<f64>() / v.len() as f64;
            let w = app.world_mut();
            let mut q = w.query::<&ClothStats>();
            let ex = q.iter(w).next().map(|s| (s.substeps, format!("{:?}", s.exceeded)));
            if worst > 10.0 { println!("{name:10} dt {seconds:.6} two {two}: mean {mean:.2} worst {worst:.2} ms {ex:?}"); }
            }
        }
    }
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    if args.iter().any(|a| a == "hostile") { hostile(); return; }
    let has = |s: &str| args.iter().any(|a| a == s);
    for (k, scene) in SCENES.iter().enumerate() {
        let wanted: Vec<usize> = args.iter().filter_map(|a| a.parse().ok()).collect();
        if !wanted.is_empty() && !wanted.contains(&k) { continue; }
        let without = if has("only") { (0.0,0.0,0.0,0.0,0,0,0.0,0) } else { run(scene, false, false, false) };
        let w = run(scene, true, has("check"), has("trace"));
        println!("{k:2} {:26} without {:.2} ({:.2}) with {:.2} med {:.2} p99 {:.2} max {:.2} | adds {:.2} max {:.2} | x{:.2} | searches {:.1} pairs {} | bad {} in {}", scene.name, without.0, without.3, w.0, w.1, w.2, w.3, w.0 - without.0, w.3 - without.0, w.0 / without.0, w.6, w.7, w.4, w.5);
    }
}
