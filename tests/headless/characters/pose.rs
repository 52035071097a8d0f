//! A cloth that follows a skinned pose.

use bevy::{
    camera::{primitives::Aabb, visibility::DynamicSkinnedMeshBounds},
    mesh::skinning::SkinnedMesh,
    prelude::*,
};
use bevy_drape::{plugin::ClothSkeleton, prelude::*};

use super::rig::*;
use crate::{mesh::vertices, meshes::sheets::*, support::*};

/// With a blend of 0, and with a max distance of 0, all particles are where f64 has the skinned vertices.
#[test]
fn the_pose_is_that_of_brute_force() {
    let none = ClothSkin {
        blend: 0.0,
        ..ClothSkin::default()
    };
    for skin in [none, ClothSkin::within(0.0)] {
        let (mut app, rig) = animated((skin, Transform::from_xyz(0.3, -0.2, 0.5)));
        go(&mut app, &rig, 1..40, |app| {
            let places = simulated(app, rig.cloth)
                .into_iter()
                .zip(skinned(app, &rig));
            for (place, truth) in places {
                let error = place.distance(truth);
                assert!(error < ROUNDING, "{place} {truth}: {error}");
            }
        });
        let mut masses = particles(&app, rig.cloth).inverse_masses();
        assert!(masses.all(|weight| weight == 0.0));
    }
}

/// A new cloth begins in the pose, not where its mesh is at rest.
#[test]
fn a_cloth_begins_in_its_pose() {
    let mut app = app_that_draws(FixedUpdate);
    app.insert_resource(ClothGravity(Vec3::ZERO));
    // Turned as one, and as small as a model in centimetres is made: nothing is stretched.
    let rig = rig(&mut app, ClothSkin::default());
    change::<Transform>(&mut app, rig.root, |root| {
        *root = Transform::from_xyz(3.0, 1.0, -2.0).with_scale(Vec3::splat(0.01));
    });
    change::<Transform>(&mut app, rig.bones[0], |bone| bone.rotate_y(2.0));
    tick(&mut app, 1);
    // By no more than it begins uneven, a ten-thousandth of a spacing of a millimetre.
    for (place, truth) in simulated(&app, rig.cloth).iter().zip(skinned(&app, &rig)) {
        assert!(place.distance(truth) < ROUNDING, "{place} {truth}");
    }
    let diagonal = surface(&app, rig.cloth).diagonal();
    assert!(
        (diagonal - 0.008 * 2.0_f32.sqrt()).abs() < 1.0e-5,
        "{diagonal}"
    );
}

/// Pins follow the pose, whatever the max distance says.
#[test]
fn pins_follow_the_pose() {
    let (mut app, rig) = animated((ClothSkin::default(), by_its_edge()));
    go(&mut app, &rig, 1..64, |app| {
        let places = simulated(app, rig.cloth)
            .into_iter()
            .zip(skinned(app, &rig));
        for (place, truth) in places.take(SIDE as usize) {
            assert!(place.distance(truth) < ROUNDING, "{place} {truth}");
        }
    });
    let (end, truth) = (simulated(&app, rig.cloth), skinned(&app, &rig));
    let last = (SIDE * SIDE - 1) as usize;
    assert!(end[last].distance(truth[last]) > 0.05, "the rest is free");
}

/// The mesh that is drawn has no joints, and is, by its entity's transform alone, where the particles are: those that are held
/// where the bones are drawn now, which here is where the tick had them, exactly.
#[test]
fn what_is_drawn_is_not_skinned_again() {
    let own = Transform::from_xyz(0.3, -0.2, 0.5).with_scale(Vec3::splat(1.5));
    // As a glTF file's have, whose bounds are those of its skeleton.
    let bounds = DynamicSkinnedMeshBounds;
    let (mut app, rig) = animated((ClothSkin::painted(), own, bounds, Visibility::default()));
    go(&mut app, &rig, 1..40, |app| {
        let handle = mesh_of(app, rig.cloth);
        let drawn = meshes(app).get(&handle).expect("a mesh");
        assert!(!drawn.contains_attribute(Mesh::ATTRIBUTE_JOINT_INDEX));
        assert!(!drawn.contains_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT));
        // By this alone the renderer takes the entity for skinned.
        assert!(app.world().get::<SkinnedMesh>(rig.cloth).is_none());
        let place = *app
            .world()
            .get::<GlobalTransform>(rig.cloth)
            .expect("a place");
        let drawn = vertices(app, rig.cloth, Mesh::ATTRIBUTE_POSITION);
        let bounds = app.world().get::<Aabb>(rig.cloth).expect("bounds");
        let [low, high] = drawn
            .iter()
            .fold([Vec3::MAX, Vec3::MIN], |[low, high], at| {
                [low.min(*at), high.max(*at)]
            });
        assert!(
            Vec3::from(bounds.min()).distance(low) < ROUNDING,
            "{bounds:?} {low}"
        );
        assert!(
            Vec3::from(bounds.max()).distance(high) < ROUNDING,
            "{bounds:?} {high}"
        );
        let truth = skinned(app, &rig);
        for (vertex, (drawn, truth)) in drawn.iter().zip(truth).enumerate() {
            let drawn = place.transform_point(*drawn);
            let distance = 0.05 * (vertex as u32 / SIDE) as f32;
            assert!(
                drawn.distance(truth) <= distance + ROUNDING,
                "{vertex}: {drawn} {truth}"
            );
        }
    });
    // Once all stands still, the picture is that of the particles.
    let still = |app: &mut App| {
        tick(app, 1);
        let place = *app
            .world()
            .get::<GlobalTransform>(rig.cloth)
            .expect("a place");
        let drawn = vertices(app, rig.cloth, Mesh::ATTRIBUTE_POSITION);
        let drawn: Vec<Vec3> = drawn.iter().map(|at| place.transform_point(*at)).collect();
        drawn
    };
    for _ in 0..400 {
        still(&mut app);
    }
    let before = simulated(&app, rig.cloth);
    let drawn = still(&mut app);
    for (drawn, particle) in drawn.iter().zip(before) {
        assert!(drawn.distance(particle) < ROUNDING, "{drawn} {particle}");
    }
    // What is no cloth any more is the renderer's again.
    app.world_mut().entity_mut(rig.cloth).remove::<Cloth>();
    tick(&mut app, 1);
    let skin = app.world().get::<SkinnedMesh>(rig.cloth);
    assert_eq!(skin.map(|skin| &*skin.joints), Some(&rig.bones[..]));
}

/// Bones that are moved after the last tick of a frame are drawn there: what is held goes along at once.
#[test]
fn what_is_held_is_drawn_where_the_bones_are_drawn() {
    let (mut app, rig) = animated((ClothSkin::painted(), Visibility::default()));
    app.add_systems(Update, move |mut bones: Query<&mut Transform>| {
        let mut bone = bones.get_mut(rig.bones[1]).expect("a bone");
        bone.rotate_local_z(0.05);
        let mut root = bones.get_mut(rig.root).expect("a root");
        root.translation.x += 0.05;
    });
    for _ in 0..30 {
        tick(&mut app, 1);
        let place = *app
            .world()
            .get::<GlobalTransform>(rig.cloth)
            .expect("a place");
        let drawn = vertices(&app, rig.cloth, Mesh::ATTRIBUTE_POSITION);
        let truth = skinned(&app, &rig);
        for (drawn, truth) in drawn.iter().zip(truth).take(SIDE as usize) {
            let drawn = place.transform_point(*drawn);
            assert!(drawn.distance(truth) < ROUNDING, "{drawn} {truth}");
        }
    }
}

/// A character that stands still lets its cloth sleep; a bone that moves wakes it, another skin, and a skeleton that goes.
#[test]
fn a_bone_wakes_what_sleeps() {
    type Change = fn(&mut App, &Rig);
    let changes: [Change; 3] = [
        |app, rig| change::<Transform>(app, rig.bones[2], |bone| bone.rotate_z(0.05)),
        |app, rig| change::<ClothSkin>(app, rig.cloth, |skin| skin.blend = 0.5),
        |app, rig| {
            let mut cloth = app.world_mut().entity_mut(rig.cloth);
            cloth.remove::<(SkinnedMesh, ClothSkeleton)>();
        },
    ];
    for (index, change) in changes.into_iter().enumerate() {
        let (mut app, rig) = asleep();
        let still: Vec<Vec3> = particles(&app, rig.cloth).positions().collect();
        tick(&mut app, 10);
        assert!(particles(&app, rig.cloth).positions().eq(still));
        change(&mut app, &rig);
        tick(&mut app, 2);
        assert!(!stats(&app, rig.cloth).is_asleep, "{index}");
    }
}

/// A character that stands still, and whose cloth sleeps.
fn asleep() -> (App, Rig) {
    let (mut app, rig) = animated(ClothSkin::painted());
    app.world_mut().entity_mut(rig.cloth).insert(ClothMaterial {
        damping: 0.1,
        ..ClothMaterial::COTTON
    });
    let mut ticks = 0;
    while !stats(&app, rig.cloth).is_asleep {
        tick(&mut app, 1);
        ticks += 1;
        assert!(ticks < 1500, "it falls asleep");
    }
    (app, rig)
}

/// A grid that has no skeleton stays near where it is at rest, wherever its entity goes; with the component gone it falls.
#[test]
fn without_a_skeleton_the_pose_is_the_cloth_at_rest() {
    let mut app = app();
    let cloth = (Cloth::new(9, 9, 0.1), ClothSkin::within(0.07));
    let cloth = app.world_mut().spawn(cloth).id();
    let largest = |app: &App| {
        let rest = surface(app, cloth).rest_positions().to_vec();
        let pairs = particles(app, cloth).positions().zip(rest);
        pairs
            .map(|(at, rest)| at.distance(rest))
            .fold(0.0, f32::max)
    };
    let mut most = 0.0_f32;
    for count in 0..64 {
        let swing = Transform::from_xyz((count as f32 * 0.2).sin(), 0.0, 0.0);
        app.world_mut().entity_mut(cloth).insert(swing);
        tick(&mut app, 1);
        most = most.max(largest(&app));
    }
    assert!((0.0699..0.07 + ROUNDING).contains(&most), "{most}");
    app.world_mut().entity_mut(cloth).insert(Pins::none());
    app.world_mut().entity_mut(cloth).remove::<ClothSkin>();
    tick(&mut app, 64);
    assert!(largest(&app) > 1.0);
}

/// Frozen, each particle keeps its place as seen from the bones, however they and the root go: its distance from the pose, turned as the
/// first bone is. Switched off it stays, and comes along when it goes on. Nothing jumps then: as seen from the bones, which swing wildly,
/// it goes on by no more in that tick than in its fastest tick before.
#[test]
fn frozen_it_goes_with_the_bones() {
    for level in [ClothLodLevel::Frozen, ClothLodLevel::Off] {
        let (mut app, rig) = animated(ClothSkin::painted());
        let beside = |app: &App| -> Vec<Vec3> {
            let bone: &GlobalTransform = app.world().get(rig.bones[0]).expect("a bone");
            let back = bone.rotation().inverse();
            let pairs = simulated(app, rig.cloth)
                .into_iter()
                .zip(skinned(app, &rig));
            pairs.map(|(place, pose)| back * (place - pose)).collect()
        };
        let farthest = |a: &[Vec3], b: &[Vec3]| {
            let apart = a.iter().zip(b).map(|(a, b)| a.distance(*b));
            apart.fold(0.0, f32::max)
        };
        let (mut before, mut fastest) = (beside(&app), 0.0_f32);
        go(&mut app, &rig, 1..80, |app| {
            let now = beside(app);
            fastest = fastest.max(farthest(&before, &now));
            before = now;
        });
        let lod = ClothLod::at(level);
        app.world_mut().entity_mut(rig.cloth).insert(lod);
        let is_off = level == ClothLodLevel::Off;
        go(&mut app, &rig, 80..120, |app| {
            let off = farthest(&before, &beside(app));
            assert!(is_off || off < 10.0 * ROUNDING, "{off}");
            assert_eq!(stats(app, rig.cloth).substeps, 0);
        });
        assert!(!is_off || farthest(&before, &beside(&app)) > 2.0 * fastest);
        app.world_mut().entity_mut(rig.cloth).remove::<ClothLod>();
        go(&mut app, &rig, 120..121, |_| {});
        let off = farthest(&before, &beside(&app));
        assert!(off < fastest, "{level:?}: {off} {fastest}");
        assert_eq!(fault(&app, rig.cloth), None);
    }
}
