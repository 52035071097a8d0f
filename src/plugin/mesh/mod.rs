//! Keeps a mesh on the particles.

mod placing;
mod skin;
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
        query::QueryData,
        reflect::ReflectComponent,
        schedule::{
            IntoScheduleConfigs, ScheduleLabel, SystemSet, common_conditions::resource_exists,
        },
        system::{Commands, Query, Res, ResMut, SystemParam},
    },
    math::{Affine3A, Vec3},
    mesh::{Mesh, Mesh3d},
    reflect::{Reflect, std_traits::ReflectDefault},
    time::{Fixed, Time},
    transform::{TransformSystems, components::GlobalTransform},
};

use super::{ClothBuilt, ClothFrame, ClothScratch, ClothState, ClothSystems, skin::Skins};
use crate::cloth::{Cloth, ClothParticles, ClothShape, Surface};
use placing::{Carriers, Drawn};
use skin::DrawnPose;
use write::{Tangents, copy_of, mesh_of, write_mesh};

/// On a cloth whose [`Mesh3d`] follows its particles, with UVs, normals and tangents; it replaces one that the entity
/// had. A cloth that is made from a mesh is drawn with a copy of that, seams and all. Give the entity a material with `double_sided: true` and `cull_mode: None`, as `fabric` does: cloth is seen from
/// both sides.
///
/// Pinned and attached particles are drawn where the cloth's entity and their targets are drawn. Interpolate what moves in
/// `FixedUpdate` and touches cloth, as the cloth is, for instance by the crate `bevy_transform_interpolation`.
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
    /// The pose that it follows, if it does.
    #[reflect(ignore)]
    pose: DrawnPose,
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
    /// What is drawn of a cloth that sleeps: when its particles were written, where its entity is, and whether it is seen.
    #[reflect(ignore)]
    settled: Option<(Tick, GlobalTransform, bool)>,
    /// Whether it drives other meshes, in this frame.
    #[reflect(ignore)]
    drives: bool,
    /// New whenever it is drawn elsewhere.
    #[reflect(ignore)]
    version: u32,
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

    /// In this frame the cloth drives another mesh: where it is drawn has to be known, be it hidden.
    pub(super) fn drive(&mut self) {
        self.drives = true;
    }

    /// Whether it is drawn as this surface.
    pub(super) fn is_of(&self, surface: &Arc<Surface>) -> bool {
        Arc::ptr_eq(&self.surface, surface)
    }

    /// Where the particles are drawn, in the entity's frame, and a number that is new whenever that is elsewhere.
    pub(super) fn drawn(&self) -> (u32, &[Vec3]) {
        (self.version, &self.drawn)
    }
}

/// What is done for the meshes in a frame.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum MeshSystems {
    /// Cloths without a mesh are given one.
    Add,
    /// What is drawn is brought up to date.
    Write,
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
            move |cloths: Query<_, _>, at: Surroundings, time: Res<_>, meshes: ResMut<_>| {
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
                (
                    add_meshes.in_set(MeshSystems::Add),
                    update.in_set(MeshSystems::Write),
                )
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
    mut cloths: Query<(
        &ClothParticles,
        &ClothFrame,
        &ClothState,
        &ClothScratch,
        &mut ClothMesh,
    )>,
) {
    for (particles, frame, state, scratch, mut mesh) in &mut cloths {
        let rests = state.rest.is_asleep();
        if !(rests && mesh.rested) {
            mesh.previous.clear();
            mesh.previous.extend(particles.positions());
            // As it was before it was carried along.
            let undone = scratch.carried.map(|carried| carried.undone_in(frame));
            if let Some(undone) = undone {
                mesh.previous
                    .iter_mut()
                    .for_each(|place| *place = undone * *place);
            }
            mesh.pose.follow(*frame, state, scratch, undone);
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
        let known = drawn.and_then(|drawn| drawn.source.clone());
        let other = mesh.filter(|mesh| drawn.is_none_or(|drawn| drawn.handle != mesh.0));
        let is_asset = matches!(cloth.shape, ClothShape::Mesh { .. });
        let source = other
            .map(|mesh| mesh.0.clone())
            .or(known)
            .filter(|_| is_asset);
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
            surface: surface.clone(),
            tangents,
            ..Default::default()
        };
        commands.entity(entity).try_insert((Mesh3d(handle), drawn));
    }
}

/// What is no cloth any more is not drawn as one, but as what it was made from, if it was. What the game has put in place of
/// the plugin's mesh stays.
fn remove_mesh(
    removed: On<Remove, Cloth>,
    meshes: Query<(&ClothMesh, Option<&Mesh3d>)>,
    mut commands: Commands,
) {
    if let Ok((own, drawn)) = meshes.get(removed.entity) {
        let mut entity = commands.entity(removed.entity);
        if drawn.is_some_and(|drawn| drawn.0 == own.handle) {
            match &own.source {
                Some(source) => entity.try_insert(Mesh3d(source.clone())),
                None => entity.try_remove::<Mesh3d>(),
            };
        }
        entity.try_remove::<ClothMesh>();
    }
}

#[derive(QueryData)]
#[query_data(mutable)]
struct Drawing {
    entity: Entity,
    built: &'static ClothBuilt,
    particles: Ref<'static, ClothParticles>,
    frame: &'static ClothFrame,
    state: &'static ClothState,
    transform: Option<&'static GlobalTransform>,
    visibility: Option<&'static InheritedVisibility>,
    mesh: &'static mut ClothMesh,
}

/// Where things are drawn.
#[derive(SystemParam)]
struct Surroundings<'w, 's> {
    transforms: Query<'w, 's, &'static GlobalTransform>,
    skins: Skins<'w, 's>,
}

fn update_meshes(
    mut cloths: Query<Drawing>,
    around: Surroundings,
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
        cloth.update(&around, &mut meshes, fraction);
    }
}

impl DrawingItem<'_, '_> {
    fn update(&mut self, around: &Surroundings, meshes: &mut Assets<Mesh>, fraction: f32) {
        let drives = std::mem::take(&mut self.mesh.drives);
        if !self.state.is_valid || !self.built.matches(&self.particles) {
            return;
        }
        // What the game hides no camera sees. What merely no camera looks at is kept up to date: whether one does is
        // known only after culling, too late for this frame.
        let is_seen = self.visibility.is_none_or(|visibility| visibility.get());
        if !is_seen && !drives {
            self.mesh.settled = None;
            return;
        }
        let own = GlobalTransform::from(self.frame.affine());
        let entity = self.transform.copied().unwrap_or(own);
        let ClothMesh {
            handle,
            previous,
            carriers,
            pose,
            targets,
            drawn,
            normals,
            tangents,
            rested,
            settled,
            version,
            ..
        } = &mut *self.mesh;
        // Those of the tick: what has been attached since has yet to be taken over.
        let drawn_at = self.state.targets.iter();
        let drawn_at = drawn_at.map_while(|target| around.transforms.get(*target).ok());
        targets.clear();
        targets.extend(drawn_at.map(GlobalTransform::affine));
        let place = |joint| around.transforms.get(joint).ok().copied();
        let moves = pose.read(self.entity, &around.skins, place);
        // What sleeps is drawn once.
        let state =
            (!moves && self.state.rest.is_asleep() && *rested && !carriers.differ_from(targets))
                .then_some((self.particles.last_changed(), entity, is_seen));
        if state.is_some() && *settled == state {
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
        let is_skinned = pose.place(&self.built.shared, fraction, drawn);
        place.place(carriers, is_skinned, drawn);
        *version = version.wrapping_add(1);
        *settled = state;
        let surface = self.built.surface();
        if is_seen
            && let Some(mut mesh) = meshes.get_mut(&*handle)
            && mesh.count_vertices() == surface.vertices()
        {
            write_mesh(&mut mesh, surface, drawn, normals, tangents);
        }
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
