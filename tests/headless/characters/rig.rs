//! A character that the tests make: three bones one above the other, and a sheet that is skinned to them.

use bevy::{
    mesh::{
        VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
};
use bevy_drape::prelude::*;

use crate::{meshes::sheets::*, support::*};

/// Vertices along either side of the sheet.
pub const SIDE: u32 = 9;

/// A character.
pub struct Rig {
    pub root: Entity,
    pub bones: [Entity; 3],
    pub cloth: Entity,
}

/// Where the bones are as the mesh is bound to them, one seen from the other.
pub fn bind(bone: usize) -> Transform {
    let turn = Quat::from_rotation_z(0.3 * bone as f32);
    Transform::from_xyz(0.1, 0.4, -0.1 * bone as f32).with_rotation(turn)
}

/// The bones' inverse bind poses.
pub fn inverse_bind_poses() -> Vec<Mat4> {
    let mut global = Mat4::IDENTITY;
    (0..3)
        .map(|bone| {
            global *= bind(bone).to_matrix();
            global.inverse()
        })
        .collect()
}

/// What moves a vertex: two bones, in shares that differ from vertex to vertex, whose sum is not 1. From the lowest bone at the
/// sheet's edge to the highest at the other.
pub fn weights(vertex: u32) -> ([u16; 4], [f32; 4]) {
    let [row, column] = [vertex / SIDE, vertex % SIDE].map(|at| at as f32 / (SIDE - 1) as f32);
    let along = 1.8 * row + 0.2 * column;
    let lower = if along < 1.0 { 0 } else { 1 };
    let part = along - f32::from(lower);
    (
        [lower, lower + 1, 0, 0],
        [2.0 * (1.0 - part), 2.0 * part, 0.0, 0.0],
    )
}

/// The sheet, lying, 0.8 m wide, with what moves it.
pub fn skinned_sheet() -> Mesh {
    let count = SIDE * SIDE;
    let (joints, weights): (Vec<_>, Vec<_>) = (0..count).map(weights).unzip();
    let distances: Vec<f32> = (0..count)
        .map(|vertex| 0.05 * (vertex / SIDE) as f32)
        .collect();
    sheet_asset(SIDE, SIDE)
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_JOINT_INDEX,
            VertexAttributeValues::Uint16x4(joints),
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights)
        .with_inserted_attribute(ClothSkin::MAX_DISTANCE, distances)
        .with_generated_skinned_mesh_bounds()
        .expect("a skinned mesh")
}

/// A character in an app, with a cloth that follows its bones.
pub fn rig(app: &mut App, skin: impl Bundle) -> Rig {
    rig_of(app, skinned_sheet(), skin)
}

/// The same of another mesh.
pub fn rig_of(app: &mut App, mesh: Mesh, skin: impl Bundle) -> Rig {
    if !app
        .world()
        .contains_resource::<Assets<SkinnedMeshInverseBindposes>>()
    {
        app.init_asset::<SkinnedMeshInverseBindposes>();
    }
    let world = app.world_mut();
    let root = world.spawn((
        Transform::default(),
        Name::new("hero"),
        Visibility::default(),
    ));
    let root = root.id();
    let mut above = root;
    let bones = std::array::from_fn(|bone| {
        let name = Name::new(format!("bone {bone}"));
        above = world.spawn((bind(bone), name, ChildOf(above))).id();
        above
    });
    let mut poses = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>();
    let inverse_bindposes = poses.add(inverse_bind_poses());
    let skinned = SkinnedMesh {
        inverse_bindposes,
        joints: bones.to_vec(),
    };
    let handle = add(app, mesh);
    let bundle = (skinned, ChildOf(root), skin);
    let cloth = spawn(app, &handle, bundle);
    Rig { root, bones, cloth }
}

/// Turns the bones and moves the root as time goes by (s).
pub fn pose(app: &mut App, rig: &Rig, seconds: f32) {
    let swing = (5.0 * seconds).sin();
    for (bone, entity) in rig.bones.into_iter().enumerate() {
        change::<Transform>(app, entity, |transform| {
            let turn = Quat::from_scaled_axis(Vec3::new(0.2, 0.1, 0.4) * swing * bone as f32);
            *transform = bind(bone) * Transform::from_rotation(turn);
        });
    }
    change::<Transform>(app, rig.root, |transform| {
        transform.translation = Vec3::new(0.3 * swing, 1.0, 2.0 * seconds);
        transform.rotation = Quat::from_rotation_y(seconds);
    });
}

/// Where each vertex is in the world by the bones' transforms, by brute force in f64.
pub fn skinned(app: &App, rig: &Rig) -> Vec<Vec3> {
    use bevy::math::{DAffine3, DMat4, DVec3};
    let own = |entity: Entity| -> DMat4 {
        let transform = app.world().get::<Transform>(entity).expect("a transform");
        DAffine3::from_scale_rotation_translation(
            transform.scale.as_dvec3(),
            transform.rotation.as_dquat(),
            transform.translation.as_dvec3(),
        )
        .into()
    };
    let mut global = own(rig.root);
    let joints: Vec<DMat4> = rig
        .bones
        .iter()
        .zip(inverse_bind_poses())
        .map(|(bone, inverse)| {
            global *= own(*bone);
            global * inverse.as_dmat4()
        })
        .collect();
    let (places, _) = sheet(SIDE, SIDE);
    (0..SIDE * SIDE)
        .map(|vertex| {
            let (indices, weights) = weights(vertex);
            let place = places[vertex as usize].as_dvec3();
            let sum: f64 = weights.iter().map(|weight| f64::from(*weight)).sum();
            let each = indices.into_iter().zip(weights);
            let each = each.map(|(joint, weight)| {
                joints[joint as usize].transform_point3(place) * f64::from(weight) / sum
            });
            each.sum::<DVec3>().as_vec3()
        })
        .collect()
}

/// Where each vertex's particle is in the world.
pub fn simulated(app: &App, cloth: Entity) -> Vec<Vec3> {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    by_vertex(app, cloth)
        .into_iter()
        .map(|place| frame.to_world(place.expect("a particle")))
        .collect()
}

/// What a place may be off by, 3 m from the origin: a dozen roundings.
pub const ROUNDING: f32 = 5.0e-6;

pub fn animated(skin: impl Bundle) -> (App, Rig) {
    let mut app = app_that_draws(FixedUpdate);
    let rig = rig(&mut app, skin);
    pose(&mut app, &rig, 0.0);
    tick(&mut app, 1);
    assert_eq!(fault(&app, rig.cloth), None);
    (app, rig)
}

pub fn go(app: &mut App, rig: &Rig, ticks: std::ops::Range<u32>, mut check: impl FnMut(&mut App)) {
    for count in ticks {
        pose(app, rig, count as f32 * TICK);
        tick(app, 1);
        check(app);
    }
}
