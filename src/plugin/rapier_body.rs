//! Rapier's bodies, pushed back by cloth.

use bevy::{
    app::App,
    ecs::{
        component::Component,
        entity::Entity,
        intern::Interned,
        lifecycle::Remove,
        observer::On,
        query::With,
        reflect::ReflectComponent,
        schedule::{IntoScheduleConfigs, ScheduleLabel},
        system::{Commands, Query},
    },
    math::{BVec3, Vec3},
    reflect::{Reflect, std_traits::ReflectDefault},
};
use bevy_rapier3d::{
    dynamics::{LockedAxes, ReadMassProperties, RigidBody, Velocity},
    plugin::PhysicsSet,
};

use super::{ClothBody, ClothPush, ClothSystems};

/// Has cloth push a dynamic rapier body back: on the entity with the `RigidBody`, the rapier `Collider` and the
/// [`RapierClothCollider`](super::RapierClothCollider). Rapier's mass of it becomes a [`ClothBody`], and what the cloth changes
/// of its velocity is added to rapier's. Without this, rapier moves the body and the cloth alone gives way.
///
/// `LockedAxes` count, which are the world's: along and about those cloth does not push the body. Bodies that are not dynamic are moved by nothing, as ever.
///
/// # Heavy bodies
/// While springs are solved, the particles beneath a body carry a part of its mass, so that light cloth holds a body hundreds of times as
/// heavy: a square metre of cotton, 150 g, held by its edges, holds balls of up to 70 kg that drop on it by 0.2 m, without a gain of energy,
/// and a strip of 46 g sags under rollers of 0.1 to 10 kg as deep as their weight says, within 4 % (both measured with bodies that have no engine but equations of motion). That takes more sub-steps, with the cube
/// root of the ratio of the masses and up to eight times as many as the cloth takes alone; with
/// [`Substepping::Automatic`](crate::solver::Substepping::Automatic), the default, it takes them by itself as long as it holds the body.
/// With too few a heavy body stretches the cloth far, and may fall through. Very soft cloth, which is else moved by its springs' forces, is
/// solved by threads as long as it carries a body. What cloth carries rolls on it, but hardly slides: its particles hold such a body as by
/// friction without a limit.
#[derive(Component, Reflect, Debug, Default, Clone, Copy)]
#[reflect(Component, Default, Debug, Clone)]
#[require(ReadMassProperties, Velocity)]
pub struct ClothPushBack;

/// Adds what this takes to the schedule that rapier and the cloth are in.
pub(super) fn add_push_back(app: &mut App, schedule: Interned<dyn ScheduleLabel>) {
    app.register_type::<ClothPushBack>()
        .add_observer(release_body)
        .add_systems(
            schedule,
            (
                read_masses
                    .after(PhysicsSet::Writeback)
                    .before(ClothSystems::Prepare),
                push_back.in_set(ClothSystems::WriteBack),
            ),
        );
}

fn release_body(removed: On<Remove, ClothPushBack>, mut commands: Commands) {
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
        // Rapier knows the mass from its first step on.
        if *kind != RigidBody::Dynamic || mass.mass <= 0.0 {
            if known.is_some() {
                commands
                    .entity(entity)
                    .try_remove::<(ClothBody, ClothPush)>();
            }
            continue;
        }
        let locked = locked.copied().unwrap_or(LockedAxes::empty());
        let locks =
            |axes: [LockedAxes; 3]| BVec3::from_array(axes.map(|axis| locked.contains(axis)));
        // What rapier takes for none can't be turned.
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
        match known {
            Some(mut known) => {
                if *known != body {
                    *known = body;
                }
            }
            None => {
                commands.entity(entity).try_insert(body);
            }
        }
    }
}

/// Adds what the cloth changed of a body's velocity to rapier's.
fn push_back(mut bodies: Query<(&ClothPush, &mut Velocity), With<ClothPushBack>>) {
    for (push, mut velocity) in &mut bodies {
        if *push != ClothPush::default() {
            velocity.linear += push.velocity;
            velocity.angular += push.angular_velocity;
        }
    }
}
