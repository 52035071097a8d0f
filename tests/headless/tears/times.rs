//! The time that a tear takes, in the tick and ahead of it.

use super::*;

/// How long a tick takes on average (ms).
fn ms(app: &mut App, ticks: usize) -> f64 {
    let start = Instant::now();
    tick(app, ticks);
    1000.0 * start.elapsed().as_secs_f64() / ticks as f64
}

/// A cloth of 1.6 m that hangs, and may be torn.
fn hung(side: u32, is_mesh: bool) -> (App, Entity) {
    let spacing = 1.6 / (side - 1) as f32;
    let cloth = match is_mesh {
        false => Cloth::new(side, side, spacing),
        true => mesh(1.6, 1.6, spacing),
    };
    let mut app = app();
    let parts = (cloth, top(), ClothTears::default());
    let cloth = app.world_mut().spawn(parts).id();
    tick(&mut app, 10);
    (app, cloth)
}

/// The time between two frames.
fn pause() -> Duration {
    Duration::from_millis(if is_long() { 60 } else { 5 })
}

/// Tears a face of the whole surface out, and returns how long the next tick takes (ms). `is_ahead` builds its surface in the background,
/// in the time between two frames.
fn tear_out(app: &mut App, cloth: Entity, whole: &Surface, face: usize, is_ahead: bool) -> f64 {
    let count = surface(app, cloth).len();
    change::<ClothTears>(app, cloth, |tears| {
        tears.tear_out(whole, whole.triangles()[face]);
    });
    if is_ahead {
        app.world_mut().run_schedule(Last);
        thread::sleep(pause());
    }
    let opens = ms(app, 1);
    assert!(surface(app, cloth).len() > count);
    opens
}

fn median(mut of: Vec<f64>) -> f64 {
    of.sort_by(f64::total_cmp);
    of[of.len() / 2]
}

/// A cloth from which faces are torn out, one in a tick. Returns how long a tick of it takes (ms): whole, and torn; then the median of how much
/// longer the ticks that tear take, and the most.
fn times_of_tears(side: u32, is_mesh: bool, is_ahead: bool) -> [f64; 4] {
    let (mut app, cloth) = hung(side, is_mesh);
    let whole = ms(&mut app, 20);
    let untorn = surface(&app, cloth).clone();
    let middle = untorn.triangles().len() / 2;
    let opens: Vec<f64> = (0..11)
        .map(|number| tear_out(&mut app, cloth, &untorn, middle + 5 * number, is_ahead))
        .collect();
    let torn = ms(&mut app, 20);
    let most = opens.iter().copied().fold(0.0, f64::max);
    [whole, torn, median(opens) - torn, most - torn]
}

/// How long a tick takes (ms), in the median, each after a pause: of a whole cloth; of one that tears in each, anywhere; and of the same one,
/// once it tears no more.
fn times_of_tearing(side: u32, is_mesh: bool) -> [f64; 3] {
    let (mut app, cloth) = hung(side, is_mesh);
    let untorn = surface(&app, cloth).clone();
    let faces = untorn.triangles().len();
    let unchanged = |app: &mut App| {
        let ticks = (0..20).map(|_| {
            thread::sleep(pause());
            ms(app, 1)
        });
        median(ticks.collect())
    };
    let whole = unchanged(&mut app);
    let tears = (0..40)
        .map(|number| tear_out(&mut app, cloth, &untorn, (617 * number + 300) % faces, true))
        .skip(20);
    let tears = median(tears.collect());
    [whole, tears, unchanged(&mut app)]
}

/// A tear opens in cloth of any size in the tick after it is listed. How long that takes, with `--nocapture`; of 64², where tests run at
/// their full length.
#[test]
fn a_tear_opens_in_cloth_of_any_size() {
    let sides: &[u32] = if is_long() { &[16, 32, 64] } else { &[16, 32] };
    for &side in sides {
        for is_mesh in [false, true] {
            let [at_once, ahead] =
                [false, true].map(|is_ahead| times_of_tears(side, is_mesh, is_ahead));
            println!(
                "{side}²{}: a tick takes {:.2} ms, of the torn one {:.2}; the one that tears {:.2} more, at most {:.1}; built ahead {:.2}, at most {:.1}",
                if is_mesh { " of a mesh" } else { "" },
                at_once[0],
                at_once[1],
                at_once[2],
                at_once[3],
                ahead[2],
                ahead[3],
            );
            let [whole, tears, torn] = times_of_tearing(side, is_mesh);
            println!(
                "    after a pause: {whole:.2} ms, of one that tears in each tick {tears:.2}, once it tears no more {torn:.2}"
            );
        }
    }
}

/// The next face of each cloth to be torn out, in order.
#[derive(Resource, Default)]
struct NextFace(usize);

fn tear_next(mut next: ResMut<NextFace>, mut cloths: Query<(&mut ClothTears, &ClothBuilt)>) {
    for (mut tears, built) in &mut cloths {
        let faces = built.surface().triangles();
        tears.tear_out(built.surface(), faces[(7 * next.0) % faces.len()]);
    }
    next.0 += 1;
}

/// Cloths that tear in each frame, after its tick, have the same bits whether their surfaces are built ahead on other threads, beside the
/// systems of the game, or within the tick. It ends, too: no system waits for what waits for it.
#[test]
fn what_is_built_ahead_is_as_built_in_the_tick() {
    let start = || {
        let mut app = app();
        app.init_resource::<NextFace>();
        let cloths = [0, 1, 2, 3].map(|number| {
            let cloth = match number % 2 {
                0 => Cloth::new(14, 14, 0.1),
                _ => mesh(1.3, 1.3, 0.1),
            };
            // One that does not bend is built soonest.
            let material = ClothMaterial {
                bend_rigidity: if number < 2 { 0.0 } else { 1.0e-5 },
                ..ClothMaterial::COTTON
            };
            let parts = (cloth, material, top(), ClothTears::default());
            app.world_mut().spawn(parts).id()
        });
        tick(&mut app, 2);
        (app, cloths)
    };
    let ((mut ahead, cloths), (mut at_once, same)) = (start(), start());
    run_on_all_threads(&mut ahead);
    ahead.add_systems(Update, tear_next);
    for number in 0..if is_long() { 500 } else { 60 } {
        tick(&mut ahead, 1);
        tick(&mut at_once, 1);
        // After the frame, so that nothing sees it before the next tick.
        at_once
            .world_mut()
            .run_system_cached(tear_next)
            .expect("cloths and a number");
        for (cloth, same) in cloths.iter().zip(same) {
            let [is, expected] = [(&ahead, *cloth), (&at_once, same)].map(|(app, cloth)| {
                let particles = particles(app, cloth);
                assert!(surface(app, cloth).is_torn() || number == 0);
                particles.clone()
            });
            assert!(is == expected, "{cloth} in tick {number}");
        }
    }
}
