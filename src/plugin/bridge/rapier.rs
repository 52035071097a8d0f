//! The bridge to rapier: rapier moves the colliders, and cloth collides with them. With a `ClothPushBack`, cloth pushes
//! them back.

use bevy::{
    ecs::{intern::Interned, schedule::ScheduleLabel, world::Ref},
    prelude::{
        App, BVec3, Commands, Component, DetectChanges, DetectChangesMut, Entity, GlobalTransform,
        IntoScheduleConfigs, On, Plugin, Query, Reflect, ReflectComponent, ReflectDefault, Remove,
        Transform, TransformHelper, Vec3, With,
    },
};
use bevy_rapier3d::{
    dynamics::{LockedAxes, RapierRigidBodyHandle, ReadMassProperties, RigidBody, Velocity},
    geometry::Collider,
    plugin::{
        PhysicsSet,
        context::{RapierContextEntityLink, RapierRigidBodySet},
    },
};

use crate::{
    contact::ClothCollider,
    plugin::{
        authoring::{ClothBody, ClothPush},
        sets::{ClothSystems, runs_in_schedule},
    },
};

/// Makes the rapier `Collider` on the same entity a [`ClothCollider`], at the scale and with the offsets that rapier
/// uses. All shapes work, including compounds, convex hulls, meshes and height fields; only lines and custom shapes
/// can't be touched.
#[derive(Component, Reflect, Debug, Default, Clone, Copy)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone)]
pub struct RapierClothCollider;

/// Adopts rapier's colliders, and orders rapier before the cloth. Add `RapierPhysicsPlugin` to the same schedule:
/// `RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule()`.
#[derive(Debug, Clone, Copy)]
pub struct ClothRapierPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

runs_in_schedule! {
    /// Runs its system in `schedule`, which must be that of [`ClothPlugin`](crate::plugin::ClothPlugin).
    ClothRapierPlugin
}

impl Plugin for ClothRapierPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<RapierClothCollider>()
            .register_type::<ClothPushBack>()
            .add_observer(release_body)
            .add_observer(release::<RapierClothCollider>)
            .add_observer(release::<Collider>)
            .add_systems(
                self.schedule,
                (
                    (read_masses, adopt_colliders)
                        .after(PhysicsSet::Writeback)
                        .before(ClothSystems::Prepare),
                    push_back.in_set(ClothSystems::WriteBack),
                ),
            );
    }
}

/// Removes the adopted collider of an entity that lost its marker or its rapier collider.
fn release<C: Component>(
    removed: On<Remove, C>,
    adopted: Query<(), With<RapierClothCollider>>,
    mut commands: Commands,
) {
    if adopted.contains(removed.entity) {
        commands
            .entity(removed.entity)
            .try_remove::<ClothCollider>();
    }
}

fn adopt_colliders(
    mut adopted: Query<(Entity, &Collider, Option<&mut ClothCollider>), With<RapierClothCollider>>,
    transforms: TransformHelper,
    mut commands: Commands,
) {
    for (entity, collider, cloth_collider) in &mut adopted {
        if let Some(ClothCollider::Shared(shared)) = cloth_collider.as_deref()
            && shared.is_of(&collider.raw)
        {
            continue;
        }
        let wanted = match collider.as_ball() {
            // A ball becomes a plain ball collider, which games can read and change, without the transform's scale.
            Some(ball) => {
                let place = transforms.compute_global_transform(entity);
                let scale = place.map_or(1.0, |place| place.scale().abs().max_element());
                let scale = if scale > 0.0 { scale } else { 1.0 };
                ClothCollider::ball(ball.radius() / scale)
            }
            None => ClothCollider::parry(collider.raw.clone()),
        };
        set(cloth_collider, wanted, entity, &mut commands);
    }
}

/// Gives an entity a component, or another value of it.
fn set<C: Component + PartialEq>(
    known: Option<impl DetectChangesMut<Inner = C>>,
    wanted: C,
    entity: Entity,
    commands: &mut Commands,
) {
    if let Some(mut known) = known {
        known.set_if_neq(wanted);
    } else {
        commands.entity(entity).try_insert(wanted);
    }
}

/// Lets cloth push a dynamic rapier body back. Add it to the entity with the `RigidBody`, the rapier `Collider` and the
/// [`RapierClothCollider`](crate::plugin::RapierClothCollider). The plugin makes a [`ClothBody`] from rapier's mass, and adds
/// the change of velocity from the cloth to rapier's velocity. Without this component, rapier moves the body and only
/// the cloth yields.
///
/// Cloth does not push the body along or about its `LockedAxes`, which are axes of the world. Cloth never pushes bodies
/// that are not dynamic.
///
/// # Heavy bodies
/// While springs are solved, the particles beneath a body carry a part of its mass. So light cloth holds bodies
/// hundreds of times its weight:
///
/// - A square metre of cotton, 150 g, held by its edges, holds balls of up to 70 kg that drop on it by 0.2 m, without a
///   gain of energy.
/// - A strip of 46 g sags under rollers of 0.1 to 10 kg as deep as their weight says, within 4 %.
///
/// Both were measured with bodies that are moved by equations of motion alone, without a physics engine.
///
/// A heavy body takes more sub-steps, growing with the cube root of the ratio of the masses, up to eight times those of
/// the cloth alone. With [`Substepping::Automatic`](crate::solver::Substepping::Automatic), the default, the cloth
/// takes them automatically as long as it holds the body. With too few, a heavy body stretches the cloth far, and may
/// fall through. Very soft cloth, otherwise moved by the forces of its springs, is solved by chains as long as it
/// carries a body. A body on hanging cloth rolls, but hardly slides: the particles hold it as if by friction without a limit.
///
/// Where cloth lies on another collider, a body stands on that through the cloth, and slides by Coulomb's law.
///
/// A body that has come to rest on a cloth sleeps in rapier as long as the cloth sleeps.
#[derive(Component, Reflect, Debug, Default, Clone, Copy)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone)]
#[require(ReadMassProperties, Velocity)]
pub struct ClothPushBack;

/// Forgets a body, and wakes it if cloth held it.
fn release_body(
    removed: On<Remove, ClothPushBack>,
    held: Query<(&ClothPush, &RapierRigidBodyHandle, &RapierContextEntityLink)>,
    mut contexts: Query<&mut RapierRigidBodySet>,
    mut commands: Commands,
) {
    if let Ok((push, handle, link)) = held.get(removed.entity)
        && push.is_held
        && let Ok(context) = contexts.get_mut(link.0)
        && let Some(body) = context.into_inner().bodies.get_mut(handle.0)
    {
        body.wake_up(true);
    }
    commands
        .entity(removed.entity)
        .try_remove::<(ClothBody, ClothPush)>();
}

/// Takes rapier's masses over.
fn read_masses(
    mut bodies: Query<
        (
            Entity,
            &RigidBody,
            &ReadMassProperties,
            Option<&LockedAxes>,
            Option<&mut ClothBody>,
        ),
        With<ClothPushBack>,
    >,
    mut commands: Commands,
) {
    for (entity, kind, mass, locked, known) in &mut bodies {
        // Rapier computes the mass in its first step.
        if *kind != RigidBody::Dynamic || mass.mass <= 0.0 {
            if known.is_some() {
                let mut body = commands.entity(entity);
                body.try_remove::<(ClothBody, ClothPush)>();
            }
            continue;
        }
        let locked = locked.copied().unwrap_or(LockedAxes::empty());
        let locks =
            |axes: [LockedAxes; 3]| BVec3::from_array(axes.map(|axis| locked.contains(axis)));
        // Rapier's zero stands for a body that can't be rotated.
        let moments = mass.principal_inertia;
        let inertia = Vec3::select(moments.cmpgt(Vec3::ZERO), moments, Vec3::INFINITY);
        let body = ClothBody {
            mass: mass.mass,
            inertia,
            axes: mass.principal_inertia_local_frame,
            centre_of_mass: mass.local_center_of_mass,
            locked_translation: locks([
                LockedAxes::TRANSLATION_LOCKED_X,
                LockedAxes::TRANSLATION_LOCKED_Y,
                LockedAxes::TRANSLATION_LOCKED_Z,
            ]),
            locked_rotation: locks([
                LockedAxes::ROTATION_LOCKED_X,
                LockedAxes::ROTATION_LOCKED_Y,
                LockedAxes::ROTATION_LOCKED_Z,
            ]),
        };
        set(known, body, entity, &mut commands);
    }
}

/// Adds the change of velocity from the cloth to rapier's velocity. A body that sleeping cloth holds sleeps in rapier, too, until
/// the cloth lets go of it.
fn push_back(
    mut bodies: Query<
        (
            Ref<ClothPush>,
            &mut Velocity,
            &Transform,
            &RapierRigidBodyHandle,
            &RapierContextEntityLink,
        ),
        With<ClothPushBack>,
    >,
    mut contexts: Query<&mut RapierRigidBodySet>,
) {
    for (push, mut velocity, transform, handle, link) in &mut bodies {
        if !push.is_held && *push != ClothPush::default() {
            velocity.linear += push.velocity;
            velocity.angular += push.angular_velocity;
        }
        if !push.is_held && !push.is_changed() {
            continue;
        }
        let context = contexts.get_mut(link.0).ok();
        let Some(body) = context.and_then(|context| context.into_inner().bodies.get_mut(handle.0))
        else {
            continue;
        };
        match push.is_held {
            true if !body.is_sleeping() => {
                // Rapier wakes a body whose components say something else than it does.
                *velocity = Velocity::zero();
                let seen = GlobalTransform::from(*transform).compute_transform();
                let mut place = *body.position();
                (place.translation, place.rotation) = (seen.translation, seen.rotation);
                body.set_position(place, false);
                body.sleep();
            }
            false if body.is_sleeping() => body.wake_up(true),
            _ => {}
        }
    }
}
