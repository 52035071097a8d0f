//! The plugin that simulates: system sets, schedule, gravity.

#[cfg(feature = "mesh")]
use bevy::{
    camera::visibility::VisibilitySystems,
    prelude::{AssetEvent, First, Mesh, Messages},
};
use bevy::{
    ecs::{entity_disabling::Disabled, intern::Interned, schedule::ScheduleLabel},
    prelude::{
        Add, Allow, App, Bundle, Commands, Component, Entity, Insert, IntoScheduleConfigs, Last,
        On, Plugin, Query, Remove, SystemCondition, Time, TransformSystems, With,
        any_with_component, error, resource_exists,
    },
};

#[cfg(feature = "mesh")]
use super::prepare::{ChangedMeshes, SharedMeshes, note_changed_meshes};
use super::{
    authoring::{self, ClothGrab, ClothGravity, ClothOrder, ClothSeam, ClothWindZone, give_order},
    frame::ClothFrame,
    naming::Part,
    prepare::{
        ChangedColliders, ColliderMotion, ColliderTree, Islands, Seams, Teleporting,
        build_torn_ahead, choose_levels, find_islands, follow_roots, forget_collider,
        forget_stitches, hold_cloths, let_go, note_enabled, note_removals, prepare_cloths,
        prepare_colliders, prepare_seams, prepare_wind,
    },
    reflection::register_with_lists,
    search::{query_collisions, rebuild_hierarchies},
    sets::{ClothSystems, runs_in_schedule},
    state::{
        ClothBuilt, ClothContacts, ClothFault, ClothParts, ClothSearch, ClothStats,
        ClothTouchStarted, ClothTouchStopped, Notices, OwnParts, SharedParts, WindField,
        log_notices,
    },
    step::{integrate, push_bodies},
    write_back::{
        ClothLimitExceeded, ClothTorn, log_faults, make_bone_colliders, remove_bone_colliders,
        report_limits, report_lost, report_tears, send_stopped_messages, send_touch_messages,
        tear_cloths,
    },
};
use crate::{
    cloth::{
        Cloth, ClothGrain, ClothMaterial, ClothMaterialMap, ClothParticles, ClothPresence,
        ClothSkin, ClothTearing, ClothTears, Pins,
    },
    contact::{ClothCollider, ClothLayers, ClothSelfCollision, NarrowPhase},
    hierarchy::SearchMethod,
    solver::{ClothCreasing, ClothPressure, ClothSettings},
};

/// Simulates every [`Cloth`]. Needs `TimePlugin`, and no rendering.
#[derive(Debug, Clone, Copy)]
pub struct ClothPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

runs_in_schedule! {
    /// Runs its systems in `schedule`.
    ClothPlugin
}

impl Plugin for ClothPlugin {
    fn build(&self, app: &mut App) {
        register_types(app);
        add_resources_and_observers(app);
        add_systems(app, self.schedule);
    }

    fn finish(&self, app: &mut App) {
        #[cfg(feature = "mesh")]
        if app
            .world()
            .contains_resource::<Messages<AssetEvent<Mesh>>>()
        {
            app.init_resource::<ChangedMeshes>()
                .add_systems(First, note_changed_meshes);
        }
        if !app.world().contains_resource::<Time>() {
            error!(
                "cloth does not move: there is no clock. Add Bevy's `TimePlugin`, which `MinimalPlugins` and `DefaultPlugins` include"
            );
        }
    }
}

/// Registers the components of all floors for scenes and inspectors.
fn register_types(app: &mut App) {
    register_with_lists::<Cloth>(app);
    register_with_lists::<ClothCollider>(app);
    register_with_lists::<ClothGrain>(app);
    register_with_lists::<ClothMaterialMap>(app);
    register_with_lists::<ClothTears>(app);
    register_with_lists::<Pins>(app);
    register_with_lists::<ClothSkin>(app);
    app.register_type::<ClothMaterial>()
        .register_type::<ClothParticles>()
        .register_type::<ClothSettings>()
        .register_type::<SearchMethod>()
        .register_type::<NarrowPhase>()
        .register_type::<ClothSelfCollision>()
        .register_type::<ClothLayers>()
        .register_type::<ClothContacts>()
        .register_type::<ClothFrame>()
        .register_type::<ClothStats>()
        .register_type::<ClothBuilt>()
        .register_type::<ClothSearch>()
        .register_type::<ClothFault>()
        .register_type::<ClothPressure>()
        .register_type::<ClothTearing>()
        .register_type::<ClothCreasing>();
    authoring::register_types(app);
}

fn add_resources_and_observers(app: &mut App) {
    give_parts::<Cloth, ClothParts>(app);
    give_parts::<ClothCollider, (ColliderMotion, ClothOrder)>(app);
    give_parts::<ClothWindZone, ClothOrder>(app);
    app.init_resource::<ClothGravity>()
        .add_message::<ClothTouchStarted>()
        .add_message::<ClothTouchStopped>()
        .add_message::<ClothLimitExceeded>()
        .add_message::<ClothTorn>()
        .insert_resource(ClothPresence::Simulated)
        .init_resource::<SharedParts>()
        .init_resource::<Notices>()
        .init_resource::<Islands>()
        .init_resource::<Seams>()
        .init_resource::<ColliderTree>()
        .init_resource::<WindField>()
        .init_resource::<ChangedColliders>()
        .init_resource::<Teleporting>()
        .add_observer(send_stopped_messages)
        .add_observer(clear_removed_cloth)
        .add_observer(clear_removed_collider)
        .add_observer(reset_motion)
        .add_observer(remove_bone_colliders)
        .add_observer(let_go)
        .add_observer(forget_stitches)
        .add_observer(forget_collider)
        .add_observer(note_enabled)
        .add_systems(Last, note_removals)
        .add_systems(
            Last,
            build_torn_ahead.run_if(any_with_component::<ClothTears>),
        )
        .add_systems(Last, log_notices.run_if(Notices::are_there));
    #[cfg(feature = "mesh")]
    app.init_resource::<SharedMeshes>();
}

fn add_systems(app: &mut App, schedule: Interned<dyn ScheduleLabel>) {
    // In the schedule of transform propagation, cameras and visibility are of this frame or of the last.
    let levels = choose_levels.ambiguous_with(TransformSystems::Propagate);
    #[cfg(feature = "mesh")]
    let levels = levels.ambiguous_with(VisibilitySystems::VisibilityPropagate);
    // A hand may be drawn where it was a frame ago, too.
    let hands = hold_cloths
        .run_if(any_with_component::<ClothGrab>)
        .ambiguous_with(TransformSystems::Propagate);
    // A cloth that has lost its last `ClothTears` is mended, which is reported, too.
    let tears = (
        report_tears,
        tear_cloths.run_if(any_with_component::<ClothTearing>),
    )
        .chain();
    // Once more after the last one is gone, to wake what it held.
    let seams = prepare_seams.run_if(any_with_component::<ClothSeam>.or_else(Seams::were_there));
    app.configure_sets(
        schedule,
        (
            ClothSystems::Prepare,
            ClothSystems::Rebuild,
            ClothSystems::Query,
            ClothSystems::Integrate,
            ClothSystems::WriteBack,
        )
            .chain(),
    )
    .add_systems(
        schedule,
        (
            (
                give_order,
                note_removals,
                follow_roots,
                hands,
                prepare_colliders,
                prepare_wind,
                levels,
                prepare_cloths,
                seams,
                find_islands,
            )
                .chain()
                .run_if(resource_exists::<Time>)
                .in_set(ClothSystems::Prepare),
            rebuild_hierarchies.in_set(ClothSystems::Rebuild),
            query_collisions.in_set(ClothSystems::Query),
            // In the schedule of transform propagation, a pushed body may be drawn a frame late.
            (
                integrate,
                push_bodies.ambiguous_with(TransformSystems::Propagate),
            )
                .chain()
                .in_set(ClothSystems::Integrate),
            make_bone_colliders.in_set(ClothSystems::WriteBack),
            (
                report_lost,
                send_touch_messages,
                report_limits,
                tears,
                log_faults,
            )
                .chain()
                .in_set(ClothSystems::WriteBack),
        ),
    );
}

/// Adds to each cloth, collider or wind zone the components that it was not spawned with: to those that existed before the
/// plugin, and to new ones.
fn give_parts<C: Component, Parts: Bundle + Default>(app: &mut App) {
    let world = app.world_mut();
    let mut earlier = world.query_filtered::<Entity, With<C>>();
    for entity in earlier.iter(world).collect::<Vec<_>>() {
        world.entity_mut(entity).insert_if_new(Parts::default());
    }
    app.add_observer(|added: On<Add, C>, mut commands: Commands| {
        let mut entity = commands.entity(added.entity);
        entity.try_insert_if_new(Parts::default());
    });
}

/// Removes the plugin's components from an entity that is no cloth any more. Particles and settings stay, since they
/// are the game's. Pinned particles get their mass back.
fn clear_removed_cloth(
    removed: On<Remove, Cloth>,
    faults: Query<&ClothFault>,
    mut cloths: Query<(&ClothBuilt, &mut ClothParticles)>,
    mut commands: Commands,
) {
    if let Ok((built, mut particles)) = cloths.get_mut(removed.entity) {
        built.release_pins(&mut particles);
    }
    commands.entity(removed.entity).try_remove::<OwnParts>();
    let known = faults.get(removed.entity).ok();
    ClothFault::report(&mut commands, removed.entity, known, Part::Cloth, Ok(()));
}

/// The same for a collider.
fn clear_removed_collider(
    removed: On<Remove, ClothCollider>,
    faults: Query<&ClothFault, Allow<Disabled>>,
    mut commands: Commands,
) {
    commands
        .entity(removed.entity)
        .try_remove::<ColliderMotion>();
    let known = faults.get(removed.entity).ok();
    ClothFault::report(&mut commands, removed.entity, known, Part::Collider, Ok(()));
}

/// A collider that is inserted again does not move from its earlier place.
fn reset_motion(inserted: On<Insert, ClothCollider>, mut motions: Query<&mut ColliderMotion>) {
    if let Ok(mut motion) = motions.get_mut(inserted.entity) {
        *motion = ColliderMotion::default();
    }
}
