//! Keeps a mesh on the particles.

mod placing;
mod write;

use std::sync::Arc;

use bevy::{
    app::{
        App, FixedFirst, FixedLast, FixedPostUpdate, FixedPreUpdate, FixedUpdate, Plugin,
        PostUpdate,
    },
    asset::{AssetEventSystems, AssetId, Assets, Handle},
    camera::visibility::{InheritedVisibility, VisibilitySystems},
    ecs::{
        change_detection::{DetectChanges, Ref, Tick},
        component::Component,
        entity::Entity,
        intern::Interned,
        lifecycle::Remove,
        observer::On,
        query::{Has, QueryData, Without},
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

use super::{ClothBuilt, ClothFrame, ClothPaused, ClothScratch, ClothState, ClothSystems};
use crate::cloth::{Cloth, ClothParticles, ClothShape, Surface};
use placing::{Carriers, Drawn};
use write::{Tangents, copy_of, mesh_of, write_mesh};

/// On a cloth whose [`Mesh3d`] follows its particles, with UVs, normals and tangents; it replaces one that the entity
/// had, which comes back when [`Cloth`] is removed. A cloth that is made from a mesh is drawn with a copy of that, seams and all. Give the entity a material with `double_sided: true` and `cull_mode: None`, as `fabric` does: cloth is seen from
/// both sides.
///
/// Pinned and attached particles are drawn where the cloth's entity and their targets are drawn. Interpolate what moves in
/// `FixedUpdate` and touches cloth, as the cloth is, for instance by the crate `bevy_transform_interpolation`.
///
/// The mesh of a cloth that Bevy's visibility hides, its own or an ancestor's, is not written; the cloth moves on all the same.
///
/// Reflected as nothing: it is made again.
#[derive(Component, Reflect, Debug, Default)]
#[reflect(Component, Default, Debug)]
pub struct ClothMesh {
    #[reflect(ignore)]
    handle: Handle<Mesh>,
    /// The asset that the cloth was made from.
    #[reflect(ignore)]
    source: Option<Handle<Mesh>>,
    /// What the entity drew before.
    #[reflect(ignore)]
    before: Option<Handle<Mesh>>,
    /// What it is a mesh of.
    #[reflect(ignore)]
    surface: Arc<Surface>,
    #[reflect(ignore)]
    tangents: Tangents,
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
    /// Whether the mesh shows the particles yet.
    #[reflect(ignore)]
    is_drawn: bool,
    /// What is drawn of a cloth that sleeps: when its particles were written, and where its entity is.
    #[reflect(ignore)]
    settled: Option<(Tick, GlobalTransform)>,
}

impl ClothMesh {
    /// The mesh that is drawn.
    pub fn id(&self) -> AssetId<Mesh> {
        self.handle.id()
    }

    /// The asset that the cloth was made from, if it was.
    pub fn source(&self) -> Option<&Handle<Mesh>> {
        self.source.as_ref()
    }
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
    mut cloths: Query<
        (
            &ClothParticles,
            &ClothFrame,
            &ClothState,
            &ClothScratch,
            &mut ClothMesh,
        ),
        Without<ClothPaused>,
    >,
) {
    for (particles, frame, state, scratch, mut mesh) in &mut cloths {
        let rests = state.rest.is_asleep();
        if !(rests && mesh.rested) {
            mesh.previous.clear();
            mesh.previous.extend(particles.positions());
            mesh.carriers.follow(*frame, state, scratch);
        }
        mesh.rested = rests;
    }
}

fn add_meshes(
    cloths: Query<(
        Entity,
        &Cloth,
        &ClothBuilt,
        Option<&Mesh3d>,
        Option<&ClothMesh>,
    )>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut commands: Commands,
) {
    for (entity, cloth, built, mesh, drawn) in &cloths {
        let surface = built.surface();
        let is_right = |drawn: &ClothMesh| {
            Arc::ptr_eq(&drawn.surface, surface) && meshes.contains(&drawn.handle)
        };
        if surface.is_empty() {
            continue;
        }
        if let Some(drawn) = drawn.filter(|drawn| is_right(drawn)) {
            // The game has put back what the cloth was made from.
            if mesh.is_some_and(|mesh| Some(&mesh.0) == drawn.source.as_ref()) {
                let own = Mesh3d(drawn.handle.clone());
                commands.entity(entity).try_insert(own);
            }
            continue;
        }
        // What the entity drew before the plugin's own mesh.
        let known = drawn.and_then(|drawn| drawn.before.clone());
        let other = mesh.filter(|mesh| drawn.is_none_or(|drawn| drawn.handle != mesh.0));
        let is_asset = matches!(cloth.shape, ClothShape::Mesh { .. });
        let before = other.map(|mesh| mesh.0.clone()).or(known);
        let source = before.clone().filter(|_| is_asset);
        // What the cloth was made from may have gone meanwhile, or be the renderer's alone.
        let copy = source
            .as_ref()
            .and_then(|source| copy_of(meshes.get(source)?, surface));
        let copy = copy.unwrap_or_else(|| mesh_of(surface));
        let tangents = Tangents::of(&copy);
        let handle = meshes.add(copy);
        let drawn = ClothMesh {
            handle: handle.clone(),
            source,
            before,
            surface: surface.clone(),
            tangents,
            ..Default::default()
        };
        commands.entity(entity).try_insert((Mesh3d(handle), drawn));
    }
}

/// What is no cloth any more is not drawn as one, but as what the entity drew before, if it did. What the game has put in place of
/// the plugin's mesh stays.
fn remove_mesh(
    removed: On<Remove, Cloth>,
    meshes: Query<(&ClothMesh, Option<&Mesh3d>)>,
    mut commands: Commands,
) {
    if let Ok((own, drawn)) = meshes.get(removed.entity) {
        let mut entity = commands.entity(removed.entity);
        if drawn.is_some_and(|drawn| drawn.0 == own.handle) {
            match &own.before {
                Some(before) => entity.try_insert(Mesh3d(before.clone())),
                None => entity.try_remove::<Mesh3d>(),
            };
        }
        entity.try_remove::<ClothMesh>();
    }
}

#[derive(QueryData)]
#[query_data(mutable)]
struct Drawing {
    built: &'static ClothBuilt,
    particles: Ref<'static, ClothParticles>,
    frame: &'static ClothFrame,
    state: &'static ClothState,
    transform: Option<&'static GlobalTransform>,
    visibility: Option<&'static InheritedVisibility>,
    is_paused: Has<ClothPaused>,
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
        if !self.state.is_valid || !self.built.matches(&self.particles) {
            return;
        }
        // What the game hides no camera sees. What merely no camera looks at is kept up to date: whether one does is
        // known only after culling, too late for this frame.
        if self.visibility.is_some_and(|visibility| !visibility.get()) {
            self.mesh.settled = None;
            return;
        }
        // It goes with its entity as it is, once it has been drawn at all.
        if self.is_paused && self.mesh.is_drawn {
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
            tangents,
            rested,
            is_drawn,
            settled,
            ..
        } = &mut *self.mesh;
        // Those of the tick: what has been attached since has yet to be taken over.
        let drawn_at = self.state.targets.iter();
        let drawn_at = drawn_at.map_while(|target| transforms.get(*target).ok());
        targets.clear();
        targets.extend(drawn_at.map(GlobalTransform::affine));
        // What sleeps is drawn once.
        let state = (self.state.rest.is_asleep() && *rested && !carriers.differ_from(targets))
            .then_some((self.particles.last_changed(), entity));
        if state.is_some() && *settled == state {
            return;
        }
        let Some(mut mesh) = meshes.get_mut(&*handle) else {
            return;
        };
        let surface = self.built.surface();
        if mesh.count_vertices() != surface.vertices() {
            return;
        }
        interpolate(drawn, previous, &self.particles, fraction);
        let place = Drawn {
            built: self.built,
            state: self.state,
            particles: &self.particles,
            entity,
            targets,
            fraction,
        };
        place.place(carriers, drawn);
        write_mesh(&mut mesh, surface, drawn, normals, tangents);
        *is_drawn = true;
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
