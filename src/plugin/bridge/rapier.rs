//! The bridge to rapier: rapier moves the colliders, and cloth collides with them. With a `ClothPushBack`, cloth pushes
//! them back.

use bevy::{
    app::{App, Plugin},
    ecs::{
        change_detection::DetectChangesMut,
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
    reflect::{Reflect, std_traits::ReflectDefault},
    transform::helper::TransformHelper,
};
use bevy_rapier3d::{geometry::Collider, plugin::PhysicsSet};

use super::rapier_body::add_push_back;
use crate::{
    contact::ClothCollider,
    plugin::{
        naming::Part,
        sets::{ClothSystems, runs_in_schedule},
        state::ClothFault,
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
        add_push_back(app, self.schedule);
        app.register_type::<RapierClothCollider>()
            .add_observer(release::<RapierClothCollider>)
            .add_observer(release::<Collider>)
            .add_systems(
                self.schedule,
                adopt_colliders
                    .after(PhysicsSet::Writeback)
                    .before(ClothSystems::Prepare),
            );
    }
}

/// Removes the adopted collider of an entity that lost its marker or its rapier collider.
fn release<C: Component>(
    removed: On<Remove, C>,
    adopted: Query<Option<&ClothFault>, With<RapierClothCollider>>,
    mut commands: Commands,
) {
    if let Ok(known) = adopted.get(removed.entity) {
        commands
            .entity(removed.entity)
            .try_remove::<ClothCollider>();
        ClothFault::report(&mut commands, removed.entity, known, Part::Collider, Ok(()));
    }
}

fn adopt_colliders(
    mut adopted: Query<(Entity, &Collider, Option<&mut ClothCollider>), With<RapierClothCollider>>,
    transforms: TransformHelper,
    mut commands: Commands,
) {
    for (entity, collider, cloth_collider) in &mut adopted {
        let is_known = match cloth_collider.as_deref() {
            Some(ClothCollider::Shared(shared)) => shared.is_of(&collider.raw),
            _ => false,
        };
        if is_known {
            continue;
        }
        let wanted = match collider.as_ball() {
            // A ball becomes a plain ball collider, which games can read and change, without the transform's scale.
            Some(ball) => {
                let scale = transforms
                    .compute_global_transform(entity)
                    .map_or(1.0, |transform| transform.scale().abs().max_element());
                let unscaled = if scale > 0.0 {
                    ball.radius() / scale
                } else {
                    ball.radius()
                };
                ClothCollider::ball(unscaled)
            }
            None => ClothCollider::parry(collider.raw.clone()),
        };
        match cloth_collider {
            Some(mut known) => {
                known.set_if_neq(wanted);
            }
            None => {
                commands.entity(entity).try_insert(wanted);
            }
        }
    }
}
