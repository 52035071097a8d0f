//! Keeps a mesh on the particles.

mod placing;
mod surface;

use bevy::{
    app::{
        App, FixedFirst, FixedLast, FixedPostUpdate, FixedPreUpdate, FixedUpdate, Plugin,
        PostUpdate,
    },
    asset::{AssetEventSystems, Assets, Handle},
    camera::visibility::{InheritedVisibility, VisibilitySystems},
    ecs::{
        change_detection::{DetectChanges, Ref, Tick},
        component::Component,
        entity::Entity,
        intern::Interned,
        lifecycle::Remove,
        observer::On,
        query::{QueryData, With},
        reflect::ReflectComponent,
        schedule::{IntoScheduleConfigs, ScheduleLabel, common_conditions::resource_exists},
        system::{Commands, Query, Res, ResMut},
    },
    math::{Affine3A, Vec3},
    mesh::{Mesh, Mesh3d},
    reflect::{Reflect, std_traits::ReflectDefault},
    time::{Fixed, Time},
    transform::{TransformSystems, components::GlobalTransform},
};

use super::{ClothFrame, ClothSystems, ClothTopology, components::ClothTick};
use crate::cloth::{Cloth, ClothGrid, ClothParticles};
use placing::{Carriers, Drawn};
use surface::{flat_mesh, write_mesh};

/// On a cloth whose [`Mesh3d`] follows its particles, with UVs, normals and tangents; it replaces one that the entity
/// had. Give the entity a material with `double_sided: true` and `cull_mode: None`, as `fabric` does: cloth is seen from
/// both sides.
///
/// Pinned and attached particles are drawn where the cloth's entity and their targets are drawn. Interpolate what moves in
/// `FixedUpdate` and touches cloth, as the cloth is, for instance by the crate `bevy_transform_interpolation`.
///
/// Reflected as nothing: it is made anew.
#[derive(Component, Reflect, Debug, Default)]
#[reflect(Component, Default, Debug)]
pub struct ClothMesh {
    #[reflect(ignore)]
    handle: Handle<Mesh>,
    #[reflect(ignore)]
    grid: ClothGrid,
    /// Positions as the last tick began, in the cloth's frame.
    #[reflect(ignore)]
    previous: Vec<Vec3>,
    /// What carries its pins, as of the last two ticks.
    #[reflect(ignore)]
    carriers: Carriers,
    /// Where its targets are drawn.
    #[reflect(ignore)]
    targets: Vec<Affine3A>,
    /// Whether those were remembered from a cloth that slept.
    #[reflect(ignore)]
    rested: bool,
    /// Positions to be drawn, in the entity's frame.
    #[reflect(ignore)]
    drawn: Vec<Vec3>,
    #[reflect(ignore)]
    normals: Vec<Vec3>,
    /// What is drawn of a cloth that sleeps: when its particles were written, and where its entity is.
    #[reflect(ignore)]
    settled: Option<(Tick, GlobalTransform)>,
}

/// Gives each cloth a mesh with UVs, normals and tangents that follows its particles, updated once a rendered frame and
/// interpolated between two ticks by `overstep_fraction`. Does nothing in an app without meshes.
#[derive(Debug, Clone, Copy)]
pub struct ClothMeshPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl Default for ClothMeshPlugin {
    fn default() -> Self {
        Self::new(FixedUpdate)
    }
}

impl ClothMeshPlugin {
    /// For a [`ClothPlugin`](super::ClothPlugin) in `schedule`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }
}

impl Plugin for ClothMeshPlugin {
    fn build(&self, app: &mut App) {
        let fixed: [Interned<dyn ScheduleLabel>; 5] = [
            FixedFirst.intern(),
            FixedPreUpdate.intern(),
            FixedUpdate.intern(),
            FixedPostUpdate.intern(),
            FixedLast.intern(),
        ];
        // In any other schedule a tick is a frame, and there is nothing to interpolate.
        let interpolated = fixed.contains(&self.schedule);
        let update =
            move |cloths: Query<_, _>, at: Query<_, _>, time: Res<_>, meshes: ResMut<_>| {
                update_meshes(cloths, at, time, meshes, interpolated);
            };
        app.register_type::<ClothMesh>()
            .add_observer(remove_mesh)
            .add_systems(
                self.schedule,
                remember_positions
                    .after(ClothSystems::Query)
                    .before(ClothSystems::Integrate),
            )
            // Before the asset events, from which Bevy's culling takes the new bounds.
            .add_systems(
                PostUpdate,
                (add_meshes, update)
                    .chain()
                    .after(ClothSystems::WriteBack)
                    .after(TransformSystems::Propagate)
                    .after(VisibilitySystems::VisibilityPropagate)
                    .before(AssetEventSystems)
                    .run_if(resource_exists::<Assets<Mesh>>)
                    .run_if(resource_exists::<Time<Fixed>>),
            );
    }
}

fn remember_positions(
    mut cloths: Query<(&ClothParticles, &ClothFrame, &ClothTick, &mut ClothMesh)>,
) {
    for (particles, frame, tick, mut mesh) in &mut cloths {
        let rests = tick.rest.is_asleep();
        if !(rests && mesh.rested) {
            mesh.previous.clear();
            mesh.previous.extend(particles.positions());
            mesh.carriers.follow(*frame, tick);
        }
        mesh.rested = rests;
    }
}

fn add_meshes(
    cloths: Query<(Entity, &ClothTopology, Option<&ClothMesh>)>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut commands: Commands,
) {
    for (entity, topology, mesh) in &cloths {
        let is_right =
            |mesh: &ClothMesh| mesh.grid == topology.grid && meshes.contains(&mesh.handle);
        if topology.grid.is_empty() || mesh.is_some_and(is_right) {
            continue;
        }
        let handle = meshes.add(flat_mesh(&topology.grid));
        let mesh = ClothMesh {
            handle: handle.clone(),
            grid: topology.grid,
            ..Default::default()
        };
        commands.entity(entity).try_insert((Mesh3d(handle), mesh));
    }
}

/// What is no cloth any more is not drawn as one.
fn remove_mesh(
    removed: On<Remove, Cloth>,
    meshes: Query<(), With<ClothMesh>>,
    mut commands: Commands,
) {
    if meshes.contains(removed.entity) {
        commands
            .entity(removed.entity)
            .try_remove::<(ClothMesh, Mesh3d)>();
    }
}

#[derive(QueryData)]
#[query_data(mutable)]
struct Drawing {
    topology: &'static ClothTopology,
    particles: Ref<'static, ClothParticles>,
    frame: &'static ClothFrame,
    tick: &'static ClothTick,
    transform: Option<&'static GlobalTransform>,
    visibility: Option<&'static InheritedVisibility>,
    mesh: &'static mut ClothMesh,
}

fn update_meshes(
    mut cloths: Query<Drawing>,
    transforms: Query<&GlobalTransform>,
    time: Res<Time<Fixed>>,
    mut meshes: ResMut<Assets<Mesh>>,
    interpolated: bool,
) {
    let fraction = if interpolated {
        time.overstep_fraction().min(1.0)
    } else {
        1.0
    };
    for mut cloth in &mut cloths {
        cloth.update(&transforms, &mut meshes, fraction);
    }
}

impl DrawingItem<'_, '_> {
    fn update(
        &mut self,
        transforms: &Query<&GlobalTransform>,
        meshes: &mut Assets<Mesh>,
        fraction: f32,
    ) {
        if !self.tick.sound || !self.topology.fits(&self.particles) {
            return;
        }
        // What the game hides no camera sees. What merely no camera looks at is kept up to date: whether one does is
        // known only after culling, too late for this frame.
        if self.visibility.is_some_and(|visibility| !visibility.get()) {
            self.mesh.settled = None;
            return;
        }
        let own = GlobalTransform::from(self.frame.affine());
        let entity = self.transform.copied().unwrap_or(own);
        let ClothMesh {
            handle,
            previous,
            carriers,
            targets,
            drawn,
            normals,
            rested,
            settled,
            ..
        } = &mut *self.mesh;
        // Those of the tick: what has been attached since has yet to be taken over.
        let drawn_at = self.tick.attachments.iter();
        let drawn_at = drawn_at.map_while(|each| transforms.get(each.target).ok());
        targets.clear();
        targets.extend(drawn_at.map(GlobalTransform::affine));
        // What sleeps is drawn once.
        let state = (self.tick.rest.is_asleep() && *rested && !carriers.differ_from(targets))
            .then_some((self.particles.last_changed(), entity));
        if state.is_some() && *settled == state {
            return;
        }
        let Some(mut mesh) = meshes.get_mut(&*handle) else {
            return;
        };
        if mesh.count_vertices() != self.particles.len() {
            return;
        }
        interpolate(drawn, previous, &self.particles, fraction);
        let place = Drawn {
            tick: self.tick,
            grid: &self.topology.grid,
            particles: &self.particles,
            entity,
            targets,
            fraction,
        };
        place.place(carriers, drawn);
        write_mesh(&mut mesh, &self.topology.grid, drawn, normals);
        *settled = state;
    }
}

/// Where the particles are to be drawn: `fraction` of the way from the last tick to this one, in the cloth's frame.
fn interpolate(
    drawn: &mut Vec<Vec3>,
    previous: &[Vec3],
    particles: &ClothParticles,
    fraction: f32,
) {
    drawn.clear();
    if previous.len() == particles.len() {
        let pairs = previous.iter().zip(particles.positions());
        drawn.extend(pairs.map(|(from, to)| from.lerp(to, fraction)));
    } else {
        drawn.extend(particles.positions());
    }
}
