//! The bridge to rapier: it moves the balls and does nothing else.

use bevy::{
    app::{App, FixedUpdate, Plugin},
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
    reflect::{Reflect, std_traits::ReflectDefault},
    transform::helper::TransformHelper,
};
use bevy_rapier3d::{geometry::Collider, plugin::PhysicsSet};

use super::{ClothFault, ClothSystems, naming::Part, rapier_body::add_push_back};
use crate::{cloth::ClothError, contact::ClothCollider};

/// Makes the rapier `Collider::ball` on the same entity a [`ClothCollider`], with the radius and scale that
/// rapier uses.
#[derive(Component, Reflect, Debug, Default, Clone, Copy)]
#[reflect(Component, Default, Debug, Clone)]
pub struct RapierClothCollider;

/// Adopts rapier's balls, and has rapier run before the cloth. `RapierPhysicsPlugin` belongs in the same
/// schedule: `RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule()`.
#[derive(Debug, Clone, Copy)]
pub struct ClothRapierPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl Default for ClothRapierPlugin {
    fn default() -> Self {
        Self::new(FixedUpdate)
    }
}

impl ClothRapierPlugin {
    /// With its system in `schedule`, which must be that of [`ClothPlugin`](super::ClothPlugin).
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }
}

impl Plugin for ClothRapierPlugin {
    fn build(&self, app: &mut App) {
        add_push_back(app, self.schedule);
        app.register_type::<RapierClothCollider>()
            .add_observer(release::<RapierClothCollider>)
            .add_observer(release::<Collider>)
            .add_systems(
                self.schedule,
                adopt_balls
                    .after(PhysicsSet::Writeback)
                    .before(ClothSystems::Prepare),
            );
    }
}

/// Without its marker or its rapier collider, an adopted collider is one no more.
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

fn adopt_balls(
    mut adopted: Query<
        (
            Entity,
            &Collider,
            Option<&mut ClothCollider>,
            Option<&ClothFault>,
        ),
        With<RapierClothCollider>,
    >,
    transforms: TransformHelper,
    mut commands: Commands,
) {
    for (entity, collider, cloth_collider, fault) in &mut adopted {
        let Some(ball) = collider.as_ball() else {
            let shape = format!("{:?}", collider.raw.shape_type());
            if cloth_collider.is_some() {
                commands.entity(entity).try_remove::<ClothCollider>();
            }
            ClothFault::report(
                &mut commands,
                entity,
                fault,
                Part::Collider,
                Err(ClothError::NotABall { shape }),
            );
            continue;
        };
        // Rapier's radius has its scale in it, which need not be the transform's; ours is before the scale.
        let scale = transforms
            .compute_global_transform(entity)
            .map_or(1.0, |transform| transform.scale().abs().max_element());
        let unscaled = if scale > 0.0 {
            ball.radius() / scale
        } else {
            ball.radius()
        };
        let wanted = ClothCollider::ball(unscaled);
        match cloth_collider {
            Some(mut cloth_collider) => {
                if *cloth_collider != wanted {
                    *cloth_collider = wanted;
                }
            }
            None => {
                commands.entity(entity).try_insert(wanted);
            }
        }
    }
}
