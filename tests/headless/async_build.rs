//! Cloths that are built in the background.

use std::{sync::Arc, thread, time::Duration};

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// Ticks until the cloth is built; its own first tick is the last of these.
fn wait_for(app: &mut App, cloth: Entity) -> usize {
    for waited in 1..2_000 {
        tick(app, 1);
        assert!(app.world().get::<ClothFault>(cloth).is_none());
        if !particles(app, cloth).is_empty() {
            return waited;
        }
        thread::sleep(Duration::from_millis(2));
    }
    panic!("it is not built in four seconds");
}

fn surface(app: &App, cloth: Entity) -> Arc<Surface> {
    let built = app.world().get::<ClothBuilt>(cloth).expect("built");
    built.surface().clone()
}

fn triangles() -> Cloth {
    let grid = Cloth::new(20, 20, 0.05).surface(Vec3::ONE).expect("a grid");
    let positions = grid.rest_positions().to_vec();
    Cloth::triangles(positions, grid.triangles().to_vec())
}

fn kinds() -> [(Cloth, ClothMaterialMap); 3] {
    let stiffer = ClothPaint::at_rest(|place| 4.0 * place.x);
    let map = ClothMaterialMap {
        stretch: ClothFactor::added(stiffer),
        ..default()
    };
    [
        (triangles(), default()),
        (Cloth::new(20, 20, 0.05), map.clone()),
        (triangles(), map),
    ]
}

/// Whatever it is made of, it begins a few ticks later and moves to the bit as one that is built at once. Until then it is no
/// fault.
#[test]
fn it_begins_later_and_moves_alike() {
    for (cloth, map) in kinds() {
        let bundle = || {
            let cloth = cloth.clone();
            (cloth, map.clone(), Pins::new([Pin::Vertex(0)]))
        };
        let mut app = app();
        let waiting = app.world_mut().spawn((bundle(), ClothAsyncBuild)).id();
        let waited = wait_for(&mut app, waiting);
        assert!(waited > 1, "built in its first tick");
        let at_once = app.world_mut().spawn(bundle()).id();
        let later = app.world_mut().spawn((bundle(), ClothAsyncBuild)).id();
        let begun = particles(&app, waiting).clone();
        tick(&mut app, 1);
        assert_eq!(particles(&app, at_once), &begun);
        assert_eq!(particles(&app, later), &begun, "it shares what is built");
        assert!(Arc::ptr_eq(&surface(&app, waiting), &surface(&app, later)));
        let before = particles(&app, waiting).clone();
        tick(&mut app, 30);
        let after = particles(&app, waiting).clone();
        let mut app = app_of(bundle());
        let other = app.1;
        tick(&mut app.0, 2);
        assert_eq!(particles(&app.0, other), &before);
        tick(&mut app.0, 30);
        assert_eq!(particles(&app.0, other), &after);
    }
}

fn app_of(bundle: impl Bundle) -> (App, Entity) {
    let mut app = app();
    let cloth = app.world_mut().spawn(bundle).id();
    (app, cloth)
}

/// What is asked for while something else is built is what comes; what nobody waits for any more harms nobody.
#[test]
fn a_cloth_that_changes_or_goes_while_it_is_built() {
    let mut app = app();
    let changed = app.world_mut().spawn((triangles(), ClothAsyncBuild)).id();
    let gone = app
        .world_mut()
        .spawn((triangles().welded(0.01), ClothAsyncBuild));
    let gone = gone.id();
    tick(&mut app, 1);
    change::<Cloth>(&mut app, changed, |cloth| *cloth = Cloth::new(7, 9, 0.1));
    app.world_mut().entity_mut(gone).despawn();
    wait_for(&mut app, changed);
    assert_eq!(particles(&app, changed).len(), 63);
    tick(&mut app, 100);
    // It goes on without a second build.
    app.world_mut()
        .entity_mut(changed)
        .remove::<ClothAsyncBuild>();
    let before = particles(&app, changed).position(60).expect("it exists");
    let speed = particles(&app, changed).largest_speed();
    tick(&mut app, 1);
    let after = particles(&app, changed).position(60).expect("it exists");
    // Gravity for a tick is added to its speed.
    let farthest = (speed + GRAVITY * TICK) * TICK;
    assert!(after.distance(before) <= farthest, "{before} {after}");
    assert_ne!(particles(&app, changed).largest_speed(), 0.0, "it goes on");
}

/// Bad input is a fault as it is at once, and is mended as that is.
#[test]
fn bad_input_is_found_in_the_background() {
    let nan = Cloth::triangles([Vec3::NAN, Vec3::X, Vec3::Y], [[0, 1, 2]]);
    let map = ClothMaterialMap {
        bending: ClothFactor::of(f32::NAN),
        ..default()
    };
    for (cloth, map) in [(nan, default()), (triangles(), map)] {
        let bundle = || (cloth.clone(), map.clone());
        let (mut app, at_once) = app_of(bundle());
        let waiting = app.world_mut().spawn((bundle(), ClothAsyncBuild)).id();
        let fault = |app: &App, cloth| {
            let fault = app.world().get::<ClothFault>(cloth);
            fault.map(|fault| fault.error.to_string())
        };
        for _ in 0..2_000 {
            tick(&mut app, 1);
            if fault(&app, waiting).is_some() {
                break;
            }
            thread::sleep(Duration::from_millis(2));
        }
        assert!(fault(&app, waiting).is_some());
        assert_eq!(fault(&app, waiting), fault(&app, at_once));
        let good = (triangles(), ClothMaterialMap::default());
        app.world_mut().entity_mut(waiting).insert(good);
        for _ in 0..2_000 {
            tick(&mut app, 1);
            if !particles(&app, waiting).is_empty() {
                break;
            }
            thread::sleep(Duration::from_millis(2));
        }
        tick(&mut app, 1);
        assert_eq!(fault(&app, waiting), None);
        assert_eq!(particles(&app, waiting).len(), 400);
    }
}

/// Restored, it goes on in the next tick: it is built at once.
#[test]
fn a_restored_cloth_does_not_wait() {
    let bundle = || (triangles(), Pins::new([Pin::Vertex(0)]), ClothAsyncBuild);
    let (mut app, cloth) = app_of(bundle());
    wait_for(&mut app, cloth);
    tick(&mut app, 10);
    let snapshot = ClothSnapshot::of(app.world(), cloth).expect("saved");
    tick(&mut app, 5);
    let expected = particles(&app, cloth).clone();
    let (mut other, restored) = app_of(bundle());
    snapshot
        .restore(other.world_mut(), restored)
        .expect("restored");
    tick(&mut other, 5);
    assert_eq!(particles(&other, restored), &expected);
}

/// A material and a map that change in every tick don't begin the work anew; what is built in the end is of the last.
#[test]
fn a_material_that_changes_while_it_is_built() {
    let mut app = app();
    let material = ClothMaterial::default();
    let bundle = (
        triangles(),
        material,
        ClothMaterialMap::default(),
        ClothAsyncBuild,
    );
    let cloth = app.world_mut().spawn(bundle).id();
    let mut last = 0.0;
    for at in 1..2_000 {
        last = 1.0 + at as f32;
        let factor = last;
        change::<ClothMaterialMap>(&mut app, cloth, |map| {
            map.density = ClothFactor::of(ClothPaint::at_rest(move |_| factor));
            map.stretch = ClothFactor::of(factor);
        });
        change::<ClothMaterial>(&mut app, cloth, |of| of.friction = 1.0 / factor);
        tick(&mut app, 1);
        if !particles(&app, cloth).is_empty() {
            break;
        }
        thread::sleep(Duration::from_millis(2));
    }
    let of_all = particles(&app, cloth).inverse_masses().map(f32::recip);
    let mass: f32 = of_all.sum();
    // 0.95 m on each side.
    let expected = last * material.areal_density * 0.95 * 0.95;
    // A sum of 400 numbers, each rounded.
    assert!((mass / expected - 1.0).abs() < 1.0e-4, "{mass} {expected}");
}
