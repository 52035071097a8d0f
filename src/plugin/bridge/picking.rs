//! Bevy's picking: pointers hit cloth, and drag it.

#[cfg(feature = "mesh")]
use bevy::ecs::query::Without;
use bevy::{
    camera::visibility::RenderLayers,
    ecs::system::SystemParam,
    picking::{
        Pickable, PickingSystems,
        backend::{
            HitData, PointerHits,
            ray::{RayId, RayMap},
        },
        events::{Pointer, Press},
        pointer::{PointerAction, PointerButton, PointerInput},
    },
    prelude::{
        App, Camera, Commands, Component, DetectChanges, Entity, Has, IntoScheduleConfigs,
        MessageReader, MessageWriter, On, Plugin, PreUpdate, Query, Ref, Res, Resource,
        ViewVisibility, With, error, resource_exists,
    },
};

use super::ray_cast::ClothRayCast;
#[cfg(feature = "mesh")]
use crate::plugin::draw::ClothRenderMesh;
use crate::{cloth::Cloth, plugin::authoring::ClothGrab};

/// Lets Bevy's pointers hit cloth, so that observers of `Pointer<Click>` and its like work on cloths. Dragging a cloth
/// moves it by a [`ClothGrab`].
///
/// Needs Bevy's picking, which `DefaultPlugins` include with the feature `bevy_picking`. Add Bevy's `MeshPickingPlugin`,
/// too, if other meshes are to hide cloth from pointers. A `Pickable::IGNORE` beside a `Cloth` keeps pointers off it.
///
/// A cloth that is hidden is hit while a camera shows a [`ClothRenderMesh`](crate::plugin::ClothRenderMesh) that it drives.
/// Where another backend hits that mesh, pointers drag its cloth, if that is behind the same point of the picture. A
/// `Pickable::IGNORE` beside the mesh keeps pointers off the mesh, and off its hidden cloth.
///
/// The extra data of a hit are a [`ClothHit`](crate::plugin::ClothHit), unless the hit is that of another backend. Then
/// a [`ClothRayCast`] along the pointer's ray finds it.
///
/// ```no_run
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// App::new().add_plugins((DefaultPlugins, DrapePlugins::default(), ClothPickingPlugin::default()));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct ClothPickingPlugin {
    /// The button that drags cloth, the primary one by default. `None`: no button does.
    pub button: Option<PointerButton>,
}

impl Default for ClothPickingPlugin {
    fn default() -> Self {
        let button = Some(PointerButton::Primary);
        Self { button }
    }
}

impl Plugin for ClothPickingPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            PreUpdate,
            point_at_cloths
                .in_set(PickingSystems::Backend)
                .run_if(resource_exists::<RayMap>),
        );
        if let Some(button) = self.button {
            app.insert_resource(GrabButton(button))
                .add_observer(take_pressed)
                .add_systems(
                    PreUpdate,
                    (drag, let_go_of_released)
                        .chain()
                        .after(PickingSystems::Last)
                        .run_if(resource_exists::<RayMap>),
                );
        }
    }

    fn finish(&self, app: &mut App) {
        if !app.world().contains_resource::<RayMap>() {
            error!(
                "pointers hit no cloth: add Bevy's `DefaultPickingPlugins`, which `DefaultPlugins` include with Bevy's feature `bevy_picking`"
            );
        }
    }
}

/// The button that drags cloth.
#[derive(Resource)]
struct GrabButton(PointerButton);

/// A hand that follows a pointer.
#[derive(Component)]
struct PointerHand {
    ray: RayId,
    /// From the origin of the ray (m).
    distance: f32,
}

type Looks = (
    Option<&'static ViewVisibility>,
    Option<&'static RenderLayers>,
    Option<&'static Pickable>,
);

/// The entities that pointers may hit.
#[derive(SystemParam)]
struct Pickables<'w, 's> {
    all: Query<'w, 's, Looks>,
    cloths: Query<'w, 's, (), With<Cloth>>,
    #[cfg(feature = "mesh")]
    driven: Query<'w, 's, (Entity, &'static ClothRenderMesh), Without<Cloth>>,
}

impl Pickables<'_, '_> {
    fn pickable(&self, entity: Entity) -> Option<&Pickable> {
        let (.., pickable) = self.all.get(entity).ok()?;
        pickable
    }

    fn is_hoverable(&self, entity: Entity) -> bool {
        (self.pickable(entity)).is_none_or(|pickable| pickable.is_hoverable)
    }

    /// Whether a camera of these layers shows an entity.
    fn is_shown(&self, entity: Entity, layers: &RenderLayers) -> bool {
        self.all.get(entity).is_ok_and(|(visibility, own, _)| {
            visibility.is_none_or(|visibility| visibility.get())
                && own.cloned().unwrap_or_default().intersects(layers)
        })
    }

    /// Whether a camera of these layers shows a cloth, or a mesh that it drives, to pointers.
    fn is_seen(&self, cloth: Entity, layers: &RenderLayers) -> bool {
        let is_seen = |mesh| self.is_hoverable(mesh) && self.is_shown(mesh, layers);
        #[cfg(feature = "mesh")]
        let is_mesh_seen = || {
            let mut driven = self.driven.iter();
            driven.any(|(mesh, drives)| drives.cloth == cloth && is_seen(mesh))
        };
        #[cfg(not(feature = "mesh"))]
        let is_mesh_seen = || false;
        is_seen(cloth) || self.is_hoverable(cloth) && is_mesh_seen()
    }

    /// The cloth that an entity is, or that drives its mesh.
    fn cloth_of(&self, entity: Entity) -> Option<Entity> {
        #[cfg(feature = "mesh")]
        let entity = (self.driven.get(entity)).map_or(entity, |(_, drives)| drives.cloth);
        (self.cloths.contains(entity) && self.is_hoverable(entity)).then_some(entity)
    }
}

/// The picking backend: which cloth each pointer is over.
fn point_at_cloths(
    rays: Res<RayMap>,
    cameras: Query<(&Camera, Option<&RenderLayers>)>,
    pickables: Pickables,
    mut ray_cast: ClothRayCast,
    mut hits: MessageWriter<PointerHits>,
) {
    for (id, &ray) in rays.iter() {
        let Ok((camera, layers)) = cameras.get(id.camera) else {
            continue;
        };
        let layers = layers.cloned().unwrap_or_default();
        let mut picks: Vec<(Entity, HitData)> = Vec::new();
        let mut next = |picks: &[(Entity, HitData)]| {
            let is_new = |cloth| picks.iter().all(|(known, _)| *known != cloth);
            ray_cast.cast_where(ray, f32::INFINITY, |cloth| {
                is_new(cloth) && pickables.is_seen(cloth, &layers)
            })
        };
        while let Some(hit) = next(&picks) {
            let (point, normal) = (Some(hit.point), Some(hit.normal));
            let data = HitData::new_with_extra(id.camera, hit.distance, point, normal, hit);
            picks.push((hit.cloth, data));
            let pickable = pickables.pickable(hit.cloth);
            if pickable.is_none_or(|pickable| pickable.should_block_lower) {
                break;
            }
        }
        if !picks.is_empty() {
            hits.write(PointerHits::new(id.pointer, picks, camera.order as f32));
        }
    }
}

/// Takes hold of a cloth where a pointer presses it.
fn take_pressed(
    press: On<Pointer<Press>>,
    button: Res<GrabButton>,
    pickables: Pickables,
    rays: Res<RayMap>,
    mut ray_cast: ClothRayCast,
    mut commands: Commands,
) {
    // A press goes on to the parents of what was pressed, too.
    let is_own = press.original_event_target() == press.entity;
    let Some(cloth) = pickables.cloth_of(press.entity) else {
        return;
    };
    if press.button != button.0 || !is_own {
        return;
    }
    let id = RayId::new(press.hit.camera, press.pointer_id);
    // Another backend may have found it, too, without saying where.
    if let Some(&ray) = rays.map.get(&id)
        && let Some(hit) = ray_cast.cast_where(ray, f32::INFINITY, |entity| entity == cloth)
    {
        let (ray, distance) = (id, hit.distance);
        commands.spawn((hit.grab(), PointerHand { ray, distance }));
    }
}

/// Moves hands with their pointers, at the distance at which they took hold.
fn drag(mut hands: Query<(&PointerHand, &mut ClothGrab)>, rays: Res<RayMap>) {
    for (hand, mut grab) in &mut hands {
        // A pointer outside of the camera's picture has none.
        if let Some(ray) = rays.map.get(&hand.ray) {
            grab.target = ray.get_point(hand.distance);
        }
    }
}

/// Lets go where a pointer's button is released, or where the plugin has let go.
fn let_go_of_released(
    hands: Query<(Entity, Ref<PointerHand>, Has<ClothGrab>)>,
    button: Res<GrabButton>,
    mut inputs: MessageReader<PointerInput>,
    mut commands: Commands,
) {
    let inputs: Vec<PointerInput> = inputs.read().cloned().collect();
    for (entity, hand, is_holding) in &hands {
        let mut lets_go = !is_holding;
        let pointer = hand.ray.pointer;
        for input in inputs.iter().filter(|input| input.pointer_id == pointer) {
            match input.action {
                PointerAction::Release(released) if released == button.0 => lets_go = true,
                // The one by which it was spawned: what was released before was another.
                PointerAction::Press(pressed) if pressed == button.0 => {
                    lets_go &= !hand.is_added();
                }
                PointerAction::Cancel => lets_go = true,
                _ => {}
            }
        }
        if lets_go {
            commands.entity(entity).try_despawn();
        }
    }
}
