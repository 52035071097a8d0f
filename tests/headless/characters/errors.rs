//! Skins that are none.

use bevy::{
    mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    prelude::*,
};
use bevy_drape::{plugin::ClothSkeleton, prelude::*};

use super::rig::*;
use crate::{meshes::sheets::*, support::*};

fn app_with(skin: ClothSkin) -> (App, Rig) {
    let mut app = app_that_draws(FixedUpdate);
    let rig = rig(&mut app, skin);
    tick(&mut app, 1);
    (app, rig)
}

fn error(app: &App, rig: &Rig) -> ClothError {
    fault(app, rig.cloth).expect("a fault")
}

/// Joints that are despawned, or become NaN, are a fault that names them, and the cloth stands still; one that comes back is
/// followed again. What is scaled to nothing is followed.
#[test]
fn joints_that_are_no_more_are_faults() {
    let (mut app, rig) = app_with(ClothSkin::painted());
    let place = *app.world().get::<Transform>(rig.bones[2]).expect("a bone");
    for bad in [Vec3::NAN, Vec3::INFINITY] {
        let still = simulated(&app, rig.cloth);
        change::<Transform>(&mut app, rig.bones[2], |bone| bone.translation = bad);
        tick(&mut app, 3);
        assert!(matches!(
            error(&app, &rig),
            ClothError::Skin(SkinError::Joint { joint: 2, .. })
        ));
        assert_eq!(simulated(&app, rig.cloth), still);
        change::<Transform>(&mut app, rig.bones[2], |bone| *bone = place);
        tick(&mut app, 3);
        assert_eq!(fault(&app, rig.cloth), None);
    }
    change::<Transform>(&mut app, rig.bones[2], |bone| bone.scale = Vec3::ZERO);
    tick(&mut app, 30);
    assert_eq!(fault(&app, rig.cloth), None);
    let truth = skinned(&app, &rig);
    for (place, truth) in simulated(&app, rig.cloth)
        .iter()
        .zip(truth)
        .take(SIDE as usize)
    {
        assert!(place.distance(truth) < 5.0e-6, "{place} {truth}");
    }
    change::<Transform>(&mut app, rig.bones[2], |bone| *bone = place);
    app.world_mut().entity_mut(rig.bones[2]).despawn();
    tick(&mut app, 2);
    assert!(
        matches!(error(&app, &rig), ClothError::Skin(SkinError::Joint { joint: 2, entity }) if entity == rig.bones[2])
    );
}

#[test]
fn bind_poses_and_joints_have_to_be_there() {
    let (mut app, rig) = app_with(ClothSkin::painted());
    let known = app
        .world()
        .get::<ClothSkeleton>(rig.cloth)
        .expect("it is drawn")
        .clone();
    let known = SkinnedMesh {
        inverse_bindposes: known.inverse_bindposes,
        joints: known.joints,
    };
    let skin = |app: &mut App, skin: SkinnedMesh| {
        app.world_mut().entity_mut(rig.cloth).insert(skin);
        tick(app, 1);
    };
    let mut two = known.clone();
    two.joints.truncate(2);
    skin(&mut app, two);
    let few = ClothError::Skin(SkinError::MissingJoints {
        needed: 3,
        joints: 2,
    });
    assert_eq!(error(&app, &rig), few);
    let mut poses = app
        .world_mut()
        .resource_mut::<Assets<SkinnedMeshInverseBindposes>>();
    let short = poses.add(vec![Mat4::IDENTITY; 2]);
    let other = |inverse_bindposes| SkinnedMesh {
        inverse_bindposes,
        ..known.clone()
    };
    skin(&mut app, other(short));
    assert_eq!(error(&app, &rig), few);
    skin(&mut app, other(Handle::default()));
    let none = ClothError::Skin(SkinError::MissingJoints {
        needed: 3,
        joints: 0,
    });
    assert!(
        error(&app, &rig).to_string().contains("bind poses"),
        "{none}"
    );
    skin(&mut app, known);
    assert_eq!(fault(&app, rig.cloth), None);
}

/// Weights that are none, and a mesh without any, are faults; the cloth beside goes on.
#[test]
fn weights_have_to_be_weights() {
    let mut app = app_that_draws(FixedUpdate);
    let good = rig(&mut app, ClothSkin::painted());
    let bare = skinned_sheet().with_removed_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT);
    let bare = rig_of(&mut app, bare, ClothSkin::default());
    let negative = vec![[0.5, -0.5, 0.0, 0.0]; (SIDE * SIDE) as usize];
    let negative = skinned_sheet().with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, negative);
    let negative = rig_of(&mut app, negative, ClothSkin::default());
    tick(&mut app, 2);
    assert!(matches!(
        error(&app, &bare),
        ClothError::Skin(SkinError::MissingJoints { .. })
    ));
    assert!(matches!(
        error(&app, &negative),
        ClothError::Skin(SkinError::Weights { .. })
    ));
    assert_eq!(fault(&app, good.cloth), None);
}

#[test]
fn each_bad_value_is_named() {
    let good = ClothSkin::painted().with_backstop(0.1, 0.5);
    for (bad, name) in [
        (
            ClothSkin {
                blend: 1.1,
                ..good.clone()
            },
            "blend",
        ),
        (
            ClothSkin {
                blend: f32::NAN,
                ..good.clone()
            },
            "blend",
        ),
        (
            ClothSkin {
                teleport_distance: 0.0,
                ..good.clone()
            },
            "teleport",
        ),
        (good.clone().with_backstop(0.1, 0.0), "radius"),
        (good.clone().with_backstop(-0.1, 0.5), "backstop"),
        (ClothSkin::within(-1.0), "max distance"),
        (ClothSkin::within(ClothPaint::color(0, 1.0)), "Vertex_Color"),
        (
            ClothSkin::within(ClothPaint::vertices([1.0])),
            "81 vertices",
        ),
        (good.clone().with_painted_backstop(0.5), "Cloth_Backstop"),
    ] {
        let (mut app, rig) = app_with(bad);
        let error = error(&app, &rig).to_string();
        assert!(error.contains(name), "{name}: {error}");
        change::<ClothSkin>(&mut app, rig.cloth, |skin| *skin = good.clone());
        tick(&mut app, 1);
        assert_eq!(fault(&app, rig.cloth), None, "{name}");
    }
}
