//! An arm that bends, made of a skinned mesh, and cloth around it.

use std::f32::consts::{FRAC_PI_2, TAU};

use bevy::{
    math::{DAffine3, DVec3},
    mesh::{
        VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
};
use bevy_drape::prelude::*;

use crate::{meshes::sheets::*, support::*};

/// Where the elbow is, the ends of the arm, and those of its sleeve (m).
pub const ELBOW: f32 = 0.3;
const ARM: [f32; 2] = [0.0, 0.6];
const SLEEVE: [f32; 2] = [0.04, 0.56];
/// Radius of the sleeve (m).
const WIDE: f32 = 0.065;
/// Rings of the arm, and vertices around each: 2,028 triangles.
const GRAIN: (u32, u32) = (38, 26);

/// The part of the arm that cloth meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum By {
    Capsules,
    /// Its triangles.
    Mesh,
}

/// Which cloth is on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Worn {
    /// A grid that lies over the elbow.
    Sheet,
    /// A tube, held at the shoulder.
    Sleeve,
}

/// An arm.
pub struct Arm {
    pub joints: [Entity; 2],
    /// Its mesh.
    pub skin: Entity,
    places: Vec<Vec3>,
    faces: Vec<[u32; 3]>,
}

/// A tube along the x axis between two ends, of a radius that depends on the place (m). It may be closed.
fn tube(
    [from, to]: [f32; 2],
    radius: impl Fn(f32) -> f32,
    (rings, around): (u32, u32),
    is_closed: bool,
) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut places = Vec::new();
    for ring in 0..=rings {
        let x = from.lerp(to, ring as f32 / rings as f32);
        for step in 0..around {
            let (sin, cos) = (TAU * step as f32 / around as f32).sin_cos();
            places.push(Vec3::new(x, cos * radius(x), sin * radius(x)));
        }
    }
    let mut faces = Vec::new();
    for ring in 0..rings {
        for step in 0..around {
            let [a, b] = [step, (step + 1) % around].map(|step| ring * around + step);
            let [c, d] = [a, b].map(|corner| corner + around);
            faces.extend([[a, b, c], [b, d, c]]);
        }
    }
    for (end, out, first) in [(from, -0.5, 0), (to, 0.5, rings * around)] {
        let tip = places.len() as u32;
        places.push(Vec3::X * (end + out * radius(end)));
        for step in 0..around {
            let [a, b] = [step, (step + 1) % around].map(|step| first + step);
            faces.push(if out < 0.0 { [tip, b, a] } else { [tip, a, b] });
        }
    }
    if !is_closed {
        faces.truncate((2 * rings * around) as usize);
        places.truncate(((rings + 1) * around) as usize);
    }
    (places, faces)
}

fn radius(x: f32) -> f32 {
    0.05 - 0.02 * x
}

/// The weight of the forearm.
fn weight(x: f32) -> f32 {
    ((x - ELBOW) / 0.1 + 0.5).clamp(0.0, 1.0)
}

/// The arm as an asset, bound to shoulder and elbow.
pub fn arm_mesh(places: &[Vec3], faces: &[[u32; 3]]) -> Mesh {
    let weights = places.iter().map(|at| weight(at.x));
    let weights: Vec<[f32; 4]> = weights.map(|fore| [1.0 - fore, fore, 0.0, 0.0]).collect();
    let joints = VertexAttributeValues::Uint16x4(vec![[0, 1, 0, 0]; places.len()]);
    asset(places, faces)
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints)
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights)
}

/// Spawns an arm with its shoulder here.
pub fn spawn_arm(app: &mut App, by: By, shoulder: Transform) -> Arm {
    if !app
        .world()
        .contains_resource::<Assets<SkinnedMeshInverseBindposes>>()
    {
        app.init_asset::<SkinnedMeshInverseBindposes>();
    }
    let elbow = Transform::from_xyz(ELBOW, 0.0, 0.0);
    let world = app.world_mut();
    let upper = world.spawn(shoulder).id();
    let fore = world.spawn((elbow, ChildOf(upper))).id();
    let mut poses = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>();
    let inverse_bindposes = poses.add(vec![Mat4::IDENTITY, elbow.to_matrix().inverse()]);
    let skinned = SkinnedMesh {
        inverse_bindposes,
        joints: vec![upper, fore],
    };
    let (places, faces) = tube(ARM, radius, GRAIN, true);
    let handle = add(app, arm_mesh(&places, &faces));
    let skin = app.world_mut().spawn((Mesh3d(handle), skinned)).id();
    if by == By::Mesh {
        let collider = ClothCollider::mesh();
        app.world_mut().entity_mut(skin).insert(collider);
    } else {
        for (bone, from) in [(upper, 0.0), (fore, ELBOW)] {
            let middle = from + ELBOW / 2.0;
            let place = Transform::from_xyz(ELBOW / 2.0, 0.0, 0.0)
                .with_rotation(Quat::from_rotation_z(-FRAC_PI_2));
            let capsule = ClothCollider::capsule(radius(middle), ELBOW);
            app.world_mut().spawn((capsule, place, ChildOf(bone)));
        }
    }
    Arm {
        joints: [upper, fore],
        skin,
        places,
        faces,
    }
}

/// Bends the elbow by an angle about an axis (rad).
pub fn bend(app: &mut App, arm: &Arm, axis: Vec3, angle: f32) {
    change::<Transform>(app, arm.joints[1], |elbow| {
        elbow.rotation = Quat::from_axis_angle(axis, angle);
    });
}

/// Spawns cloth on an arm that is straight.
pub fn dress(app: &mut App, arm: &Arm, worn: Worn, bundle: impl Bundle) -> Entity {
    let shoulder = *app
        .world()
        .get::<Transform>(arm.joints[0])
        .expect("a place");
    match worn {
        Worn::Sheet => {
            let cloth = Cloth::new(32, 32, 0.015).lying().centred();
            let place = shoulder * Transform::from_xyz(ELBOW, 0.07, 0.0);
            let sheet = (cloth, Pins::none(), place);
            app.world_mut().spawn(sheet).insert(bundle).id()
        }
        Worn::Sleeve => {
            let (places, faces) = tube(SLEEVE, |_| WIDE, (32, 26), false);
            let mesh = add(app, asset(&places, &faces));
            let held = Pin::at_rest(|at| at.x < SLEEVE[0] + 0.001);
            let held = ClothAttachments::new([(held, arm.joints[0])]);
            spawn(app, &mesh, (Pins::none(), held, shoulder, bundle))
        }
    }
}

/// Where the arm's vertices are, by brute force in f64.
fn truth(app: &App, arm: &Arm) -> Vec<DVec3> {
    let [upper, fore] = arm.joints.map(|joint| {
        let own = app.world().get::<Transform>(joint).expect("a transform");
        let (rotation, place) = (own.rotation.as_dquat(), own.translation.as_dvec3());
        DAffine3::from_rotation_translation(rotation, place)
    });
    let fore = upper * fore * DAffine3::from_translation(DVec3::X * -f64::from(ELBOW));
    let each = arm.places.iter().map(|at| {
        let (weight, at) = (f64::from(weight(at.x)), at.as_dvec3());
        (upper.transform_point3(at)).lerp(fore.transform_point3(at), weight)
    });
    each.collect()
}

/// Whether a closed surface winds around a point (van Oosterom and Strackee 1983).
fn is_inside(places: &[DVec3], faces: &[[u32; 3]], point: DVec3) -> bool {
    let each = faces.iter().map(|face| {
        let [a, b, c] = face.map(|corner| places[corner as usize] - point);
        let [x, y, z] = [a, b, c].map(DVec3::length);
        let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
        2.0 * a.dot(b.cross(c)).atan2(below)
    });
    each.sum::<f64>().abs() > f64::from(TAU)
}

/// Places of a cloth's particles in the world.
pub fn in_world(app: &App, cloth: Entity) -> Vec<Vec3> {
    let frame = app.world().get::<ClothFrame>(cloth).expect("a frame");
    let places = particles(app, cloth).positions();
    places.map(|at| frame.to_world(at)).collect()
}

/// Number of a cloth's particles that are inside of the arm.
pub fn inside(app: &App, arm: &Arm, cloth: Entity) -> usize {
    let truth = truth(app, arm);
    let of = |at: &DVec3| {
        // Nothing inside is farther from all vertices than the arm is thick.
        let is_near = |place: &DVec3| place.distance(*at) < f64::from(2.0 * radius(0.0));
        truth.iter().any(is_near) && is_inside(&truth, &arm.faces, *at)
    };
    let places = in_world(app, cloth).into_iter().map(Vec3::as_dvec3);
    places.filter(of).count()
}

/// How far an arm is bent that does so up to an angle (rad), `speed` times in π s.
pub fn angle(most: f32, speed: f32, seconds: f32) -> f32 {
    most / 2.0 * (1.0 - (2.0 * speed * seconds).cos())
}
