//! Worlds with a floating origin.

use bevy::{
    ecs::{entity_disabling::Disabled, query::QueryData, system::RunSystemOnce},
    math::Affine3A,
    prelude::{Allow, Entity, GlobalTransform, In, Query, ResMut, Vec3, World},
};

#[cfg(feature = "mesh")]
use crate::plugin::draw::MeshDrawing;
use crate::{
    cloth::{Allowed, QuantityError},
    plugin::{
        authoring::{ClothGrab, ClothWindZone, PlacedZone, RootMotion},
        frame::{ClothFrame, Places, Shift, rigid},
        prepare::{ColliderMotion, Skins},
        state::{BroadPhaseBounds, ClothState, WindField},
    },
};

/// Shifts all cloths and colliders with the world's origin, for games with a floating origin. Call it between two
/// ticks, after you have added `by` (m) to the `Transform` of every entity without a parent. Nothing gains speed,
/// deforms or rotates. Sleeping cloth sleeps on, and gusts and eddies stay where they were in the world.
///
/// The plugin's remembered positions in the world change, and so do the targets of [`ClothGrab`]s. Particles don't,
/// because they are given in their cloth's frame. An entity that is within rounding of its shifted position counts as being exactly there.
///
/// # Errors
/// [`QuantityError`] if `by` is not finite; nothing changes then.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// /// Keeps the camera within a kilometre of the origin.
/// fn recentre(
///     camera: Single<Entity, With<Camera3d>>,
///     mut roots: Query<(Entity, &mut Transform), Without<ChildOf>>,
///     mut commands: Commands,
/// ) {
///     let Ok((_, camera)) = roots.get(*camera) else { return };
///     let by = -camera.translation.round();
///     if by.length() > 1000.0 {
///         roots.iter_mut().for_each(|(_, mut place)| place.translation += by);
///         commands.queue(move |world: &mut World| shift_cloths(world, by));
///     }
/// }
/// ```
pub fn shift_cloths(world: &mut World, by: Vec3) -> Result<(), QuantityError> {
    Allowed::FINITE.check("jump of the world's origin (m)", by.to_array())?;
    // A world without the plugin remembers nothing.
    if world.contains_resource::<WindField>() {
        let shifted = world.run_system_once_with(shift, Shift(by));
        debug_assert!(shifted.is_ok(), "all that it asks for is there");
    }
    Ok(())
}

#[derive(QueryData)]
#[query_data(mutable)]
struct ShiftQuery {
    entity: Entity,
    frame: &'static mut ClothFrame,
    state: &'static mut ClothState,
    bounds: &'static mut BroadPhaseBounds,
    #[cfg(feature = "mesh")]
    drawing: Option<&'static mut MeshDrawing>,
}

fn shift(
    In(shift): In<Shift>,
    mut cloths: Query<ShiftQuery, Allow<Disabled>>,
    mut colliders: Query<(Entity, &mut ColliderMotion), Allow<Disabled>>,
    mut roots: Query<(Entity, &mut RootMotion), Allow<Disabled>>,
    zones: Query<&ClothWindZone, Allow<Disabled>>,
    mut hands: Query<&mut ClothGrab, Allow<Disabled>>,
    mut field: ResMut<WindField>,
    places: Places,
    skins: Skins,
) {
    let place = |entity: Entity| places.of(entity).ok();
    let pose = |entity: Entity| place(entity).map(|place| rigid(&place.affine()));
    let zone = |entity: Entity| PlacedZone::new(entity, zones.get(entity).ok()?, &places).ok();
    let mut joints: Vec<Affine3A> = Vec::new();
    for (entity, mut motion) in &mut colliders {
        if skins.read(entity, place, &mut joints).is_err() {
            joints.clear();
        }
        motion.shift(shift, pose(entity), &mut joints);
    }
    for (entity, mut motion) in &mut roots {
        motion.shift(shift, pose(entity));
    }
    field.shift(shift);
    for mut hand in &mut hands {
        hand.target += shift.0;
    }
    for mut cloth in &mut cloths {
        let own = place(cloth.entity);
        let before = *cloth.frame;
        let after = before.shifted(shift, own.as_ref());
        *cloth.frame = after;
        cloth.bounds.shift(shift);
        if skins.read(cloth.entity, place, &mut joints).is_err() {
            joints.clear();
        }
        let carrier = match cloth.state.attachments.targets.first() {
            Some(target) => pose(*target),
            None => own.map(|own: GlobalTransform| rigid(&own.affine())),
        };
        let state = &mut *cloth.state;
        state.pose.shift(shift, [before, after], &joints);
        let first_target = &mut state.attachments.first_target;
        *first_target = first_target.map(|was| shift.rigid(was, carrier));
        state.lod.frozen = state.lod.frozen.map(|was| was.shifted(shift, carrier));
        state.inputs.forces.shift(shift, zone);
        let rounding = 2.0 * shift.rounding(before.isometry().translation);
        let colliders = state.resting.colliders_mut();
        colliders.for_each(|on| on.add_slack(rounding));
        #[cfg(feature = "mesh")]
        if let Some(drawing) = &mut cloth.drawing {
            let target = |entity| place(entity).map(|place| place.affine());
            drawing.shift(shift, [before, after], target);
        }
    }
}
