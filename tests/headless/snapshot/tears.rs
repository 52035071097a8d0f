//! Snapshots of cloth that tears.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::{
    support::*,
    tears::{cut_at, mesh, tears, top},
};

fn sheets() -> [Cloth; 2] {
    [Cloth::new(13, 13, 0.1), mesh(1.2, 1.2, 0.1)]
}

/// A sheet that hangs, with a cut at a height that has opened, if any.
fn hung(cloth: Cloth, opened: Option<f32>) -> (App, Entity) {
    let mut app = app();
    let parts = (cloth, top(), ClothTears::default());
    let cloth = app.world_mut().spawn(parts).id();
    tick(&mut app, 20);
    if let Some(height) = opened {
        assert!(cut_at(&mut app, height) > 5);
        tick(&mut app, 4);
    }
    (app, cloth)
}

/// The ticks from here on: particles and tears after each.
fn go_on(app: &mut App, cloth: Entity) -> Vec<(ClothParticles, ClothTears)> {
    let next = |_| {
        tick(app, 1);
        assert_eq!(app.world().get::<ClothFault>(cloth), None);
        (particles(app, cloth).clone(), tears(app, cloth).clone())
    };
    (0..24).map(next).collect()
}

/// Other tears are being built in the background as a snapshot is restored: of a whole cloth, of one between a cut and its opening, and of a
/// torn one. It goes on to the last bit as it did without them.
#[test]
fn tears_that_are_being_built_are_forgotten() {
    let cases = [(None, None), (None, Some(-0.33)), (Some(-0.33), None)];
    for (cloth, (opened, listed)) in sheets()
        .into_iter()
        .flat_map(|cloth| cases.map(|case| (cloth.clone(), case)))
    {
        let (mut app, cloth) = hung(cloth, opened);
        if let Some(height) = listed {
            assert!(cut_at(&mut app, height) > 5);
        }
        let saved = ClothSnapshot::of(app.world(), cloth).expect("a cloth");
        let expected = go_on(&mut app, cloth);
        saved.restore(app.world_mut(), cloth).expect("the cloth");
        assert!(cut_at(&mut app, -0.62) > 5);
        // The end of a frame, in which it begins to be built.
        app.world_mut().run_schedule(Last);
        saved.restore(app.world_mut(), cloth).expect("the cloth");
        assert!(go_on(&mut app, cloth) == expected, "{opened:?} {listed:?}");
    }
}

/// A cut between a snapshot and the next tick is the one that was made there at first, and a ray hits the same, although what is built
/// belongs to later tears: of a whole cloth, and of a torn one.
#[test]
fn a_cut_right_after_a_snapshot_is_as_before() {
    for (cloth, opened) in sheets()
        .into_iter()
        .flat_map(|cloth| [None, Some(-0.33)].map(|opened| (cloth.clone(), opened)))
    {
        let (mut app, cloth) = hung(cloth, opened);
        let saved = ClothSnapshot::of(app.world(), cloth).expect("a cloth");
        let cut = |app: &mut App| {
            let hit = app
                .world_mut()
                .run_system_cached(|mut rays: ClothRayCast| {
                    rays.cast(Ray3d::new(Vec3::new(0.57, -0.51, 3.0), Dir3::NEG_Z), 9.0)
                })
                .expect("a system");
            (hit.expect("the sheet is there"), cut_at(app, -0.62))
        };
        let first = cut(&mut app);
        assert!(first.1 > 5);
        let expected = go_on(&mut app, cloth);
        saved.restore(app.world_mut(), cloth).expect("the cloth");
        assert_eq!(cut(&mut app), first);
        assert!(go_on(&mut app, cloth) == expected, "{opened:?}");
    }
}

/// A snapshot from the middle of a tear that runs under load goes on to the last bit, in the same app and in one that has just spawned
/// its cloth: with the same edges in the same ticks.
#[test]
fn a_tear_that_runs_is_rolled_back() {
    for cloth in sheets() {
        let mut app = app();
        // Its weight is 1.4 to 2 N/m.
        let parts = (cloth, top(), ClothMaterial::COTTON);
        let torn = app
            .world_mut()
            .spawn((parts.clone(), ClothTears::default()))
            .id();
        tick(&mut app, 40);
        let tearing = ClothTearing::new(0.5);
        app.world_mut().entity_mut(torn).insert(tearing);
        let mut ticks = 0;
        while tears(&app, torn).edges().len() < 3 {
            ticks += 1;
            assert!(ticks < 60, "it tears");
            tick(&mut app, 1);
        }
        let saved = ClothSnapshot::of(app.world(), torn).expect("a cloth");
        let count = tears(&app, torn).edges().len();
        let expected = go_on(&mut app, torn);
        let last = &expected.last().expect("ticks").1;
        assert!(last.edges().len() > count + 3, "it runs on");
        saved.restore(app.world_mut(), torn).expect("the cloth");
        assert!(go_on(&mut app, torn) == expected);
        let mut other = crate::support::app();
        let clone = other.world_mut().spawn((parts, tearing)).id();
        saved.restore(other.world_mut(), clone).expect("the cloth");
        assert!(go_on(&mut other, clone) == expected);
    }
}

/// A mesh has its grain for the sake of a tearing. A snapshot from before that goes on to the last bit once the tearing is gone.
#[test]
fn a_tear_and_its_grain_are_rolled_back() {
    let mut app = app();
    let grain = ClothGrain::along(Vec3::new(0.3, 1.0, 0.0));
    let parts = (mesh(1.2, 1.2, 0.1), top(), ClothMaterial::COTTON, grain);
    let cloth = app.world_mut().spawn(parts).id();
    tick(&mut app, 20);
    let saved = ClothSnapshot::of(app.world(), cloth).expect("a cloth");
    let go_on = |app: &mut App| -> Vec<ClothParticles> {
        let next = |_| {
            tick(app, 1);
            assert_eq!(app.world().get::<ClothFault>(cloth), None);
            particles(app, cloth).clone()
        };
        (0..24).map(next).collect()
    };
    let expected = go_on(&mut app);
    let tearing = ClothTearing {
        strength: 0.5,
        weft_strength: 0.4,
    };
    app.world_mut().entity_mut(cloth).insert(tearing);
    tick(&mut app, 40);
    assert!(!tears(&app, cloth).is_empty());
    saved.restore(app.world_mut(), cloth).expect("the cloth");
    app.world_mut().entity_mut(cloth).remove::<ClothTearing>();
    assert!(go_on(&mut app) == expected);
}
