//! Snapshots: what is put back goes on to the last bit, in the same app and in a new one.

mod ids;
pub mod scene;
mod tears;
mod threads;

use bevy::prelude::*;
use bevy_drape::prelude::*;

use self::scene::{Clock, everything};
use crate::support::*;

/// All that is seen of a tick: particles and contacts of each cloth, bit by bit, and which touches began and ended.
#[derive(PartialEq, Clone)]
struct Seen {
    cloths: Vec<(Vec<u32>, Vec<ClothContact>, bool)>,
    began: Vec<(Entity, Entity)>,
    ended: Vec<(Entity, Entity)>,
}

fn next(app: &mut App, cloths: &[Entity]) -> Seen {
    tick(app, 1);
    let of = |cloth: &Entity| {
        assert!(app.world().get::<ClothFault>(*cloth).is_none());
        let particles = particles(app, *cloth);
        let positions = particles.positions().flat_map(|at| at.to_array());
        let velocities = (0..particles.len())
            .flat_map(|index| particles.velocity(index).expect("it exists").to_array());
        let contacts = app.world().get::<ClothContacts>(*cloth).expect("contacts");
        (
            positions.chain(velocities).map(f32::to_bits).collect(),
            contacts.iter().copied().collect(),
            stats(app, *cloth).is_asleep,
        )
    };
    let cloths = cloths.iter().map(of).collect();
    let began = messages::<ClothTouchStarted>(app);
    let ended = messages::<ClothTouchStopped>(app);
    Seen {
        cloths,
        began: began.iter().map(|of| (of.cloth, of.collider)).collect(),
        ended: ended.iter().map(|of| (of.cloth, of.collider)).collect(),
    }
}

fn compare(expected: &[Seen], app: &mut App, cloths: &[Entity], context: &str) {
    for (number, expected) in expected.iter().enumerate() {
        let found = next(app, cloths);
        for (index, (expected, found)) in expected.cloths.iter().zip(&found.cloths).enumerate() {
            let differ = expected.0.iter().zip(&found.0);
            let differ = differ.filter(|(a, b)| a != b).count();
            assert_eq!(differ, 0, "{context}: cloth {index}, {number} ticks on");
            assert_eq!(expected.1, found.1, "{context}: contacts of {index}");
            assert_eq!(expected.2, found.2, "{context}: sleep of {index}");
        }
        assert!(*expected == found, "{context}: touches {number} ticks on");
    }
}

/// Those of earlier ticks.
fn forget_messages(app: &mut App) {
    messages::<ClothTouchStarted>(app);
    messages::<ClothTouchStopped>(app);
}

/// Saved at some ticks, and continued for up to 600, where tests run at their full length: in the same app, put back there
/// afterwards, and in one that has just begun, from a file.
#[test]
fn what_is_restored_goes_on_to_the_last_bit() {
    let longest = if is_long() { 600 } else { 150 };
    let all = [(1, longest), (40, 100), (96, 100), (330, 200)];
    let (mut app, cloths) = everything();
    let (mut saved, mut seen) = (Vec::new(), Vec::new());
    for number in 0..=600 {
        if all.iter().any(|(start, _)| *start == number) {
            let clock = *app.world().resource::<Clock>();
            saved.push((ClothWorldSnapshot::of(app.world_mut()), clock));
        }
        seen.push(next(&mut app, &cloths));
    }
    // It is worth the name.
    let mut of_one = seen.iter().map(|seen| &seen.cloths[1]);
    let slept = of_one.any(|(_, contacts, is_asleep)| *is_asleep && !contacts.is_empty());
    let woke = !seen[600].cloths[1].2;
    assert!(slept && woke, "asleep on a ball {slept}, woken {woke}");
    assert!(seen.iter().any(|seen| !seen.ended.is_empty()));
    for ((start, ticks), (saved, clock)) in all.into_iter().zip(saved) {
        let expected = &seen[start..start + ticks];
        saved.restore(app.world_mut()).expect("the same world");
        app.insert_resource(clock);
        forget_messages(&mut app);
        compare(expected, &mut app, &cloths, &format!("again from {start}"));
        let text = ron::to_string(&saved).expect("it can be written");
        let read: ClothWorldSnapshot = ron::from_str(&text).expect("it can be read");
        let (mut fresh, same) = everything();
        assert_eq!(cloths, same);
        read.restore(fresh.world_mut()).expect("the same entities");
        fresh.insert_resource(clock);
        compare(expected, &mut fresh, &cloths, &format!("anew from {start}"));
    }
}

/// Each tick is done eleven times: rolled back by ten, and done again. What comes of it is what comes without.
#[test]
fn ten_ticks_may_be_rolled_back_in_each_tick() {
    let (mut straight, cloths) = everything();
    let (mut rolled, _) = everything();
    tick(&mut straight, 20);
    tick(&mut rolled, 20);
    let mut kept: Vec<(ClothWorldSnapshot, Clock)> = Vec::new();
    for number in 0..60 {
        let mut snapshot = match kept.len() {
            10 => kept.remove(0).0,
            _ => ClothWorldSnapshot::default(),
        };
        snapshot.take(rolled.world_mut());
        kept.push((snapshot, *rolled.world().resource::<Clock>()));
        tick(&mut rolled, 1);
        // Something that came late from elsewhere has all of them done again.
        let (oldest, clock) = kept.first().expect("a tick").clone();
        oldest.restore(rolled.world_mut()).expect("the same world");
        rolled.insert_resource(clock);
        tick(&mut rolled, kept.len());
        tick(&mut straight, 1);
        for (index, cloth) in cloths.iter().enumerate() {
            let (expected, found) = (particles(&straight, *cloth), particles(&rolled, *cloth));
            assert!(expected == found, "cloth {index} in tick {number}");
        }
    }
}

/// One cloth alone, put back without a word on anything else, has its shape, its velocities and its sleep.
#[test]
fn one_cloth_may_be_put_back() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::new(9, 9, 0.1)).id();
    tick(&mut app, 30);
    let saved = ClothSnapshot::of(app.world(), cloth).expect("a cloth");
    assert_eq!(saved.particles(), particles(&app, cloth));
    tick(&mut app, 30);
    let after = particles(&app, cloth).clone();
    saved.restore(app.world_mut(), cloth).expect("the cloth");
    tick(&mut app, 30);
    assert_eq!(&after, particles(&app, cloth));
    // Of other entities in another world.
    let mut other = crate::support::app();
    other.world_mut().spawn_empty();
    let twin = other.world_mut().spawn(Cloth::new(9, 9, 0.1)).id();
    saved.restore(other.world_mut(), twin).expect("a cloth");
    tick(&mut other, 30);
    assert_eq!(&after, particles(&other, twin));
}

/// What can't be restored is said, and nothing is changed.
#[test]
fn what_is_wrong_with_a_snapshot_is_said() {
    let (mut app, cloths) = everything();
    tick(&mut app, 20);
    let saved = ClothWorldSnapshot::of(app.world_mut());
    let text = ron::to_string(&saved).expect("it can be written");
    tick(&mut app, 5);
    let before: Vec<_> = (cloths.iter().map(|cloth| particles(&app, *cloth).clone())).collect();
    let nobody = app.world_mut().spawn_empty().id();
    let error = ClothSnapshot::of(app.world(), nobody).expect_err("no cloth");
    assert_eq!(error, SnapshotError::NoCloth { entity: nobody });
    let (_, one) = saved.cloths().next().expect("a cloth");
    let error = one.restore(app.world_mut(), nobody).expect_err("no cloth");
    assert_eq!(error, SnapshotError::NoCloth { entity: nobody });
    let newer = text.replacen("version:12", "version:13", 1);
    let newer: ClothWorldSnapshot = ron::from_str(&newer).expect("it can be read");
    let error = newer.restore(app.world_mut()).expect_err("a newer one");
    assert_eq!(
        error,
        SnapshotError::Version {
            found: 13,
            expected: 12
        }
    );
    // A particle that there is not: of what is attached, and of what touches.
    let attached = text.match_indices("attached:[(particle:");
    let touching = text.match_indices("points:[(particle:");
    let named: Vec<_> = attached.chain(touching).collect();
    assert!(named.len() > 3);
    for (at, found) in named {
        let (known, rest) = text.split_at(at + found.len());
        let none = format!("{known}9999{rest}");
        let none: ClothWorldSnapshot = ron::from_str(&none).expect("it can be read");
        let error = none.restore(app.world_mut()).expect_err("no such particle");
        assert!(matches!(error, SnapshotError::Damaged { entity } if cloths.contains(&entity)));
    }
    let collider = (app
        .world_mut()
        .query_filtered::<Entity, With<ClothCollider>>())
    .iter(app.world())
    .next()
    .expect("a collider");
    app.world_mut().despawn(collider);
    let error = saved.restore(app.world_mut()).expect_err("one has gone");
    let component = "ClothCollider";
    assert_eq!(
        error,
        SnapshotError::Gone {
            entity: collider,
            component
        }
    );
    for (cloth, before) in cloths.iter().zip(before) {
        assert!(*particles(&app, *cloth) == before);
    }
}

/// What is attached to more than the game says by now is held by what it says, and by nothing else.
#[test]
fn a_file_may_know_of_other_attachments() {
    let pole = |app: &mut App, x| app.world_mut().spawn(Transform::from_xyz(x, 0.0, 0.0)).id();
    let run = |corners: &[Corner], saved: Option<&str>| {
        let mut app = app();
        let poles = [pole(&mut app, 0.0), pole(&mut app, 0.8)];
        let all = corners.iter().zip(poles);
        let all = all.map(|(corner, pole)| (Pin::Corner(*corner), pole));
        let attached = (Pins::none(), ClothAttachments::new(all));
        let cloth = app
            .world_mut()
            .spawn((Cloth::new(9, 9, 0.1), attached))
            .id();
        if let Some(saved) = saved {
            let saved: ClothSnapshot = ron::from_str(saved).expect("it can be read");
            saved.restore(app.world_mut(), cloth).expect("the cloth");
        }
        tick(&mut app, 20);
        let pinned = particles(&app, cloth)
            .inverse_masses()
            .filter(|w| *w == 0.0)
            .count();
        let saved = ClothSnapshot::of(app.world(), cloth).expect("a cloth");
        assert!(app.world().get::<ClothFault>(cloth).is_none());
        (pinned, ron::to_string(&saved).expect("it can be written"))
    };
    let corners = [Corner::TopLeft, Corner::TopRight];
    let (pinned, saved) = run(&corners, None);
    assert_eq!(pinned, 2);
    for now in [&corners[..], &corners[1..], &[]] {
        let (pinned, _) = run(now, Some(&saved));
        assert_eq!(pinned, now.len());
    }
}

/// What was at a lower level goes on at the full one where nobody asks for levels.
#[test]
fn what_stood_still_moves_in_an_app_without_levels() {
    let mut frozen = app();
    let lod = ClothLod::at(ClothLodLevel::Frozen);
    let free = || (Cloth::new(9, 9, 0.1), Pins::none());
    let cloth = frozen.world_mut().spawn((free(), lod)).id();
    tick(&mut frozen, 8);
    let saved = ClothSnapshot::of(frozen.world(), cloth).expect("a cloth");
    let mut app = app();
    let cloth = app.world_mut().spawn(free()).id();
    saved.restore(app.world_mut(), cloth).expect("the cloth");
    tick(&mut app, 3);
    assert_eq!(stats(&app, cloth).level, ClothLodLevel::Full);
    let fault = app.world().get::<ClothFault>(cloth);
    let speed = particles(&app, cloth).largest_speed();
    assert!(
        speed > 0.1,
        "{speed} m/s, {fault:?}, {:?}",
        stats(&app, cloth)
    );
}

/// A cloth that has lost its particles gets them back.
#[test]
fn particles_that_are_gone_come_back() {
    let (mut app, cloths) = everything();
    tick(&mut app, 40);
    let saved = ClothWorldSnapshot::of(app.world_mut());
    let clock = *app.world().resource::<Clock>();
    forget_messages(&mut app);
    let seen: Vec<Seen> = (0..20).map(|_| next(&mut app, &cloths)).collect();
    for (index, cloth) in cloths.iter().enumerate() {
        let mut cloth = app.world_mut().entity_mut(*cloth);
        match index % 3 {
            0 => cloth.remove::<ClothParticles>(),
            1 => cloth.remove::<(ClothParticles, ClothFrame)>(),
            _ => &mut cloth,
        };
    }
    saved.restore(app.world_mut()).expect("the same world");
    app.insert_resource(clock);
    forget_messages(&mut app);
    compare(&seen, &mut app, &cloths, "with particles again");
}
