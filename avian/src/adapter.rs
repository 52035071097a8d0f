//! Cloth and Avian in one game. Copy this file into yours, and add [`AvianClothPlugin`] beside `PhysicsPlugins::default()` and
//! `DrapePlugins::new(FixedPostUpdate)`.

use avian3d::{
    parry::shape::{Shape, TypedShape},
    prelude::*,
};
use bevy::prelude::*;
use bevy_drape::prelude::*;

/// Makes the Avian `Collider` on the same entity a [`ClothCollider`]: cloth touches it.
#[derive(Component, Debug, Default, Clone, Copy)]
pub struct AvianClothCollider;

/// Has cloth push a dynamic body back: on the entity with the `RigidBody`, the `Collider` and the [`AvianClothCollider`].
///
/// Avian puts a body to sleep that moves slowly, without gravity from then on. What lies on cloth moves slowly, but the cloth
/// goes on pushing, so such a body does not sleep.
#[derive(Component, Debug, Default, Clone, Copy)]
#[require(SleepingDisabled)]
pub struct AvianPushBack;

/// Runs the cloth after Avian, in Avian's own schedule.
///
/// Avian moves a body; the cloth then takes it from where it was to where Avian has sent it, gives way or pushes it back, and
/// writes where it ends. In this order a frame shows the body where the cloth has left it. The other way round it shows the
/// body where Avian sent it, as deep in the cloth as it moves in a tick.
pub struct AvianClothPlugin;

impl Plugin for AvianClothPlugin {
    fn build(&self, app: &mut App) {
        let read = (adopt_colliders, read_masses)
            .after(PhysicsSystems::Last)
            .before(ClothSystems::Prepare);
        let write = push_back.in_set(ClothSystems::WriteBack);
        app.add_systems(FixedPostUpdate, (read, write))
            .add_observer(release::<AvianClothCollider, ClothCollider>)
            .add_observer(release::<AvianPushBack, (ClothBody, ClothPush)>);
    }
}

/// Without its marker an entity loses what that gave it.
fn release<Marker: Component, Given: Bundle>(removed: On<Remove, Marker>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<Given>();
}

fn adopt_colliders(
    colliders: Query<(Entity, Ref<Collider>, Ref<AvianClothCollider>)>,
    mut commands: Commands,
) {
    for (entity, collider, marker) in &colliders {
        if !collider.is_changed() && !marker.is_added() {
            continue;
        }
        // The shape without its scale: cloth takes the transform's, as Avian does.
        match cloth_shape(&*collider.shape().0) {
            Some(shape) => _ = commands.entity(entity).try_insert(shape),
            None => {
                warn!("{entity}: cloth can't touch {:?}", collider.shape());
                commands.entity(entity).try_remove::<ClothCollider>();
            }
        }
    }
}

/// By its numbers, as Avian and cloth are built on different versions of parry.
fn cloth_shape(shape: &dyn Shape) -> Option<ClothCollider> {
    Some(match shape.as_typed_shape() {
        TypedShape::Ball(ball) => ClothCollider::ball(ball.radius),
        TypedShape::Cuboid(cuboid) => Cuboid::from_size(2.0 * cuboid.half_extents).into(),
        TypedShape::Cylinder(it) => ClothCollider::cylinder(it.radius, 2.0 * it.half_height),
        TypedShape::Cone(cone) => ClothCollider::cone(cone.radius, 2.0 * cone.half_height),
        TypedShape::Capsule(it) => {
            let pose = Isometry3d::new(it.center(), it.rotation_wrt_y());
            ClothCollider::compound([(pose, ClothCollider::capsule(it.radius, it.height()))])
        }
        TypedShape::HalfSpace(half) if half.normal == Vec3::Y => ClothCollider::plane(),
        TypedShape::ConvexPolyhedron(hull) => ClothCollider::convex_hull(hull.points()),
        TypedShape::TriMesh(mesh) => ClothCollider::trimesh(mesh.vertices(), mesh.indices()),
        TypedShape::HeightField(ground) => {
            let (heights, columns) = (ground.heights(), ground.ncols() + 1);
            let row = |row| (0..columns).map(move |column| heights[(row, column)]);
            let rows: Vec<f32> = (0..=ground.nrows()).flat_map(row).collect();
            ClothCollider::heightfield(rows, columns, ground.scale())
        }
        TypedShape::Compound(compound) => {
            let parts = compound.shapes().iter().map(|(pose, part)| {
                let pose = Isometry3d::new(pose.translation, pose.rotation);
                Some((pose, cloth_shape(&*part.0)?))
            });
            ClothCollider::compound(parts.collect::<Option<Vec<_>>>()?)
        }
        _ => return None,
    })
}

fn read_masses(
    bodies: Query<
        (
            Entity,
            &RigidBody,
            &ComputedMass,
            &ComputedAngularInertia,
            &ComputedCenterOfMass,
            Option<&LockedAxes>,
            Option<&ClothBody>,
        ),
        With<AvianPushBack>,
    >,
    mut commands: Commands,
) {
    for (entity, kind, mass, inertia, centre, locked, known) in &bodies {
        if !kind.is_dynamic() || !mass.is_finite() {
            if known.is_some() {
                commands.entity(entity).try_remove::<ClothBody>();
            }
            continue;
        }
        let (moments, axes) = inertia.principal_angular_inertia_with_local_frame();
        let locked = locked.map_or(0, LockedAxes::to_bits);
        let locks = |axes: [u8; 3]| BVec3::from_array(axes.map(|axis| locked & axis != 0));
        let body = ClothBody {
            mass: mass.value(),
            // Avian writes 0 for a body that cannot turn.
            inertia: Vec3::select(moments.cmpgt(Vec3::ZERO), moments, Vec3::INFINITY),
            axes,
            centre_of_mass: centre.0,
            locked_translation: locks([0b100_000, 0b010_000, 0b001_000]),
            locked_rotation: locks([0b000_100, 0b000_010, 0b000_001]),
        };
        if known.is_none_or(|known| *known != body) {
            commands.entity(entity).try_insert(body);
        }
    }
}

fn push_back(
    mut bodies: Query<
        (
            &ClothPush,
            &mut LinearVelocity,
            &mut AngularVelocity,
            &Transform,
            &mut Position,
            &mut Rotation,
            Has<ChildOf>,
        ),
        With<AvianPushBack>,
    >,
) {
    for (push, mut linear, mut angular, place, mut position, mut rotation, is_child) in &mut bodies
    {
        if *push == ClothPush::default() {
            continue;
        }
        linear.0 += push.velocity;
        angular.0 += push.angular_velocity;
        // Cloth has moved the transform of a body that is no child. Avian takes that over too, but not less than 0.01 mm or 0.1°.
        if !is_child {
            (position.0, rotation.0) = (place.translation, place.rotation);
        }
    }
}
