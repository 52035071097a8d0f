//! The plugin that simulates: system sets, schedule, gravity.

use bevy::{
    app::{App, FixedUpdate, Plugin},
    ecs::{
        bundle::Bundle,
        component::Component,
        entity::Entity,
        intern::Interned,
        lifecycle::{Add, Insert, Remove},
        observer::On,
        query::With,
        reflect::ReflectResource,
        resource::Resource,
        schedule::{
            IntoScheduleConfigs, ScheduleLabel, SystemSet, common_conditions::resource_exists,
        },
        system::{Commands, Query},
        world::World,
    },
    log::error,
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
    time::Time,
};

use super::{
    ClothAttachments, ClothContacts, ClothFault, ClothFrame, ClothLimitExceeded, ClothSearch,
    ClothStats, ClothTeleport, ClothTopology, ClothTouchStarted, ClothTouchStopped,
    colliders::{ColliderMotion, prepare_colliders},
    components::{ClothTick, Vicinity},
    contacts::{tell_of_removed_cloths, tell_of_touches},
    envelope::report_limits,
    fault::{Part, log_faults},
    prepare::prepare_cloths,
    search::{query_collisions, rebuild_hierarchies},
    tick::integrate,
};
use crate::{
    cloth::{Cloth, ClothMaterial, ClothParticles, ClothPresence, Pins},
    contact::{ClothCollider, NarrowPhase},
    hierarchy::SearchMethod,
    solver::ClothSettings,
};

/// What happens in a tick, in this order. Each runs once a tick, not once a sub-step.
///
/// Systems that move colliders or write particles belong before [`Prepare`](Self::Prepare), those that read
/// what came of it after [`WriteBack`](Self::WriteBack).
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ClothSystems {
    /// Builds new cloths, checks every input, takes over transforms, gravity and colliders.
    Prepare,
    /// Finds which colliders are near, chooses how to search, and brings the bounding volumes up to date.
    Rebuild,
    /// Searches the trees from the top down, with bounds inflated by how far cloth and ball can move in the
    /// tick: candidates.
    Query,
    /// All sub-steps: Verlet, one sweep over the springs, response on the candidates.
    Integrate,
    /// Messages and diagnostics.
    WriteBack,
}

/// Acceleration of every cloth (m/s²), in the world; [`ClothSettings::gravity`] overrides it for one.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct ClothGravity(pub Vec3);

impl Default for ClothGravity {
    /// 9.81 m/s² downwards.
    fn default() -> Self {
        Self(Vec3::new(0.0, -9.81, 0.0))
    }
}

/// Simulates every [`Cloth`]. Needs `TimePlugin` and nothing that draws.
#[derive(Debug, Clone, Copy)]
pub struct ClothPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl Default for ClothPlugin {
    fn default() -> Self {
        Self::new(FixedUpdate)
    }
}

impl ClothPlugin {
    /// With its systems in `schedule`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }
}

impl Plugin for ClothPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Cloth>()
            .register_type::<ClothMaterial>()
            .register_type::<ClothParticles>()
            .register_type::<Pins>()
            .register_type::<ClothSettings>()
            .register_type::<SearchMethod>()
            .register_type::<NarrowPhase>()
            .register_type::<ClothCollider>()
            .register_type::<ClothContacts>()
            .register_type::<ClothFrame>()
            .register_type::<ClothStats>()
            .register_type::<ClothAttachments>()
            .register_type::<ClothTeleport>()
            .register_type::<ClothTopology>()
            .register_type::<ClothSearch>()
            .register_type::<ClothFault>()
            .register_type::<ClothGravity>();
        add_parts_to_earlier::<Cloth, ClothParts>(app.world_mut());
        add_parts_to_earlier::<ClothCollider, ColliderMotion>(app.world_mut());
        app.init_resource::<ClothGravity>()
            .add_message::<ClothTouchStarted>()
            .add_message::<ClothTouchStopped>()
            .add_message::<ClothLimitExceeded>()
            .insert_resource(ClothPresence::Simulated)
            .add_observer(add_parts::<Cloth, ClothParts>)
            .add_observer(add_parts::<ClothCollider, ColliderMotion>)
            .add_observer(tell_of_removed_cloths)
            .add_observer(clear_removed_cloth)
            .add_observer(clear_removed_collider)
            .add_observer(begin_anew);
        app.configure_sets(
            self.schedule,
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
            self.schedule,
            (
                (prepare_colliders, prepare_cloths)
                    .chain()
                    .run_if(resource_exists::<Time>)
                    .in_set(ClothSystems::Prepare),
                rebuild_hierarchies.in_set(ClothSystems::Rebuild),
                query_collisions.in_set(ClothSystems::Query),
                integrate.in_set(ClothSystems::Integrate),
                (tell_of_touches, report_limits, log_faults)
                    .chain()
                    .in_set(ClothSystems::WriteBack),
            ),
        );
    }

    fn finish(&self, app: &mut App) {
        if !app.world().contains_resource::<Time>() {
            error!(
                "no cloth moves: there is no clock. Add Bevy's `TimePlugin`, which is among `MinimalPlugins` and `DefaultPlugins`"
            );
        }
    }
}

/// What a cloth has besides what it is spawned with. Not required components: those can't be declared any more where a
/// cloth was spawned before the plugin was added.
type ClothParts = (
    ClothSettings,
    SearchMethod,
    NarrowPhase,
    ClothTopology,
    ClothFrame,
    ClothSearch,
    ClothContacts,
    ClothStats,
    ClothTick,
    Vicinity,
);

/// Gives a new cloth or collider the parts that it was not spawned with.
fn add_parts<C: Component, Parts: Bundle + Default>(added: On<Add, C>, mut commands: Commands) {
    commands
        .entity(added.entity)
        .try_insert_if_new(Parts::default());
}

/// The same for those that were there before the plugin.
fn add_parts_to_earlier<C: Component, Parts: Bundle + Default>(world: &mut World) {
    let mut earlier = world.query_filtered::<Entity, With<C>>();
    for entity in earlier.iter(world).collect::<Vec<_>>() {
        world.entity_mut(entity).insert_if_new(Parts::default());
    }
}

/// What the plugin added to a cloth goes with it; its particles and settings stay, they are the game's. What was pinned
/// gets its mass back.
fn clear_removed_cloth(
    removed: On<Remove, Cloth>,
    faults: Query<&ClothFault>,
    mut cloths: Query<(&ClothTopology, &mut ClothParticles)>,
    mut commands: Commands,
) {
    if let Ok((topology, mut particles)) = cloths.get_mut(removed.entity) {
        topology.release_pins(&mut particles);
    }
    commands.entity(removed.entity).try_remove::<(
        ClothTopology,
        ClothFrame,
        ClothSearch,
        ClothContacts,
        ClothStats,
        ClothTick,
        Vicinity,
    )>();
    let known = faults.get(removed.entity).ok();
    ClothFault::report(&mut commands, removed.entity, known, Part::Cloth, Ok(()));
}

/// Likewise for a collider.
fn clear_removed_collider(
    removed: On<Remove, ClothCollider>,
    faults: Query<&ClothFault>,
    mut commands: Commands,
) {
    commands
        .entity(removed.entity)
        .try_remove::<ColliderMotion>();
    let known = faults.get(removed.entity).ok();
    ClothFault::report(&mut commands, removed.entity, known, Part::Collider, Ok(()));
}

/// A collider that is inserted anew has not come from where it was before.
fn begin_anew(inserted: On<Insert, ClothCollider>, mut motions: Query<&mut ColliderMotion>) {
    if let Ok(mut motion) = motions.get_mut(inserted.entity) {
        *motion = ColliderMotion::default();
    }
}
