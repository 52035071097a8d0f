//! Fine meshes that coarse cloths drive.

mod drawn;

use std::sync::Arc;

use bevy::{
    asset::AssetEventSystems,
    ecs::{
        entity::{ComponentCloneCtx, MapEntities, SourceComponent},
        query::QueryData,
        reflect::ReflectMapEntities,
    },
    prelude::{
        App, AssetEvent, AssetId, AssetServer, Assets, Commands, Component, Entity, FromWorld,
        GlobalTransform, Handle, InheritedVisibility, IntoScheduleConfigs, Local, Mesh, Mesh3d,
        MessageReader, On, Plugin, PostUpdate, Query, Reflect, ReflectComponent, ReflectDefault,
        ReflectFromWorld, Remove, Res, ResMut, With, Without, World, resource_exists,
    },
};

use super::mesh::{MeshDrawing, add_meshes, update_meshes};
use crate::{
    cloth::{Cloth, ClothError, MeshError, Surface, TargetError},
    plugin::{
        naming::Part,
        prepare::not_there,
        state::{ClothBuilt, ClothFault},
    },
};
use drawn::Driven;

/// On an entity with a [`Mesh3d`] that a cloth drives: a coarse cloth is simulated, and a fine mesh is drawn on it.
/// Also known as proxy simulation, or a wrap deformer.
///
/// Each vertex is bound once to the nearest point of the cloth at rest, with both entities where they are when the mesh
/// is first drawn. So place the mesh where the cloth is before it falls, for instance as a child of the cloth or at the
/// same transform. From then on the mesh follows the cloth, wherever its own entity goes, and is interpolated between
/// ticks like the cloth. Normals and tangents are rotated along; texture coordinates and everything else stay as they
/// are. [`SurfaceBinding`](crate::cloth::SurfaceBinding) describes the binding.
///
/// The plugin draws a copy of the asset, and leaves the asset itself unchanged. The cloth may be made from a grid or a
/// mesh. Its own mesh is not written while it is hidden by `Visibility::Hidden`. A cloth may drive several meshes, each
/// on an entity of its own that is not itself a cloth.
///
/// The binding is made again when the `Mesh3d`, the asset or the cloth's shape change. There is a [`ClothFault`] if the
/// mesh is farther from the cloth than the cloth is large, if it can't be read, or if the cloth is gone. When you
/// remove the component, the entity draws its asset again.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// fn cape(mut commands: Commands, assets: Res<AssetServer>) {
///     let cloth = commands.spawn((Cloth::new(20, 24, 0.05), Visibility::Hidden)).id();
///     let fine = Mesh3d(assets.load("models/cape.glb#Mesh0/Primitive0"));
///     commands.spawn((ClothRenderMesh { cloth }, fine));
/// }
/// ```
#[derive(Component, Reflect, MapEntities, Debug, Clone, Copy, PartialEq, Eq)]
#[type_path = "bevy_drape"]
#[reflect(Component, FromWorld, MapEntities, Debug, Clone, PartialEq)]
pub struct ClothRenderMesh {
    /// The cloth that drives the mesh.
    #[entities]
    pub cloth: Entity,
}

impl FromWorld for ClothRenderMesh {
    /// Without a cloth, for editors: a fault until one is set.
    fn from_world(_: &mut World) -> Self {
        let cloth = Entity::PLACEHOLDER;
        Self { cloth }
    }
}

/// The drawn copy of a [`ClothRenderMesh`]. Scenes and clones hold only the asset that was replaced; everything else is
/// made again.
#[derive(Component, Reflect, Debug, Default)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default)]
#[component(clone_behavior = Custom(clone_replaced))]
struct RenderMeshState {
    /// The mesh that the entity drew before.
    source: Handle<Mesh>,
    /// The mesh that is drawn.
    #[reflect(ignore)]
    handle: Handle<Mesh>,
    #[reflect(ignore)]
    bound: Option<Bound>,
}

/// The cloth that a mesh is bound to, and the binding.
#[derive(Debug)]
struct Bound {
    cloth: Entity,
    surface: Arc<Surface>,
    driven: Driven,
}

/// A mesh that could not be bound, and why. It is tried again once one of these changes.
#[derive(Component, Debug)]
struct RefusedMesh {
    source: AssetId<Mesh>,
    surface: Arc<Surface>,
    /// Places of the mesh and the cloth.
    places: [GlobalTransform; 2],
    error: ClothError,
}

/// A clone has the `Mesh3d` of its original as yet, which it is known by, and is given one of its own.
fn clone_replaced(original: &SourceComponent, clone: &mut ComponentCloneCtx) {
    if let Some(original) = original.read::<RenderMeshState>() {
        clone.write_target_component(RenderMeshState {
            source: original.source.clone(),
            handle: original.handle.clone(),
            bound: None,
        });
    }
}

/// Draws each [`ClothRenderMesh`] on its cloth, once per rendered frame. Needs a
/// [`ClothMeshPlugin`](crate::plugin::ClothMeshPlugin), and does nothing in an app without meshes.
#[derive(Debug, Default, Clone, Copy)]
pub struct ClothRenderMeshPlugin;

impl Plugin for ClothRenderMeshPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<ClothRenderMesh>()
            .register_type::<RenderMeshState>()
            .add_observer(remove_render_mesh)
            .add_systems(
                PostUpdate,
                (
                    bind.after(add_meshes).before(update_meshes),
                    update
                        .after(bind)
                        .after(update_meshes)
                        .before(AssetEventSystems),
                )
                    .run_if(resource_exists::<Assets<Mesh>>),
            );
    }
}

#[derive(QueryData)]
#[query_data(mutable)]
struct Binding {
    entity: Entity,
    wanted: &'static ClothRenderMesh,
    mesh: Option<&'static Mesh3d>,
    place: Option<&'static GlobalTransform>,
    state: Option<&'static RenderMeshState>,
    refused: Option<&'static RefusedMesh>,
    fault: Option<&'static ClothFault>,
}

/// The cloth that a mesh is bound to, and the binding.
#[derive(QueryData)]
#[query_data(mutable)]
struct DriveQuery {
    built: &'static ClothBuilt,
    place: Option<&'static GlobalTransform>,
    drawing: &'static mut MeshDrawing,
}

/// Binds meshes to cloths, once both exist.
fn bind(
    mut wanted: Query<Binding, Without<Cloth>>,
    cloths: Query<(), With<Cloth>>,
    mut driving: Query<DriveQuery>,
    mut meshes: ResMut<Assets<Mesh>>,
    server: Option<Res<AssetServer>>,
    mut events: MessageReader<AssetEvent<Mesh>>,
    mut changed: Local<Vec<AssetId<Mesh>>>,
    mut commands: Commands,
) {
    if wanted.is_empty() {
        events.clear();
        return;
    }
    changed.clear();
    changed.extend(events.read().filter_map(|event| match event {
        AssetEvent::Modified { id } => Some(*id),
        _ => None,
    }));
    for each in &mut wanted {
        let cloth = each.wanted.cloth;
        let outcome = match driving.get_mut(cloth) {
            Ok(mut driving) if cloths.contains(cloth) => {
                let surface = driving.built.surface().clone();
                if surface.is_empty() {
                    continue;
                }
                driving.drawing.drives = true;
                let is_bound = each.state.is_some_and(|state| {
                    let bound = state.bound.as_ref();
                    bound.is_some_and(|to| to.cloth == cloth && Arc::ptr_eq(&to.surface, &surface))
                        && each.mesh.is_some_and(|mesh| mesh.0 == state.handle)
                        && meshes.contains(&state.handle)
                        && !changed.contains(&state.source.id())
                });
                if is_bound {
                    Ok(())
                } else {
                    each.bind(
                        &driving,
                        surface,
                        &changed,
                        &mut meshes,
                        server.as_deref(),
                        &mut commands,
                    )
                }
            }
            // It gets its components with the next tick.
            _ if cloths.contains(cloth) => continue,
            _ => Err(TargetError::NoSuchCloth { cloth }.into()),
        };
        let part = Part::RenderMesh;
        ClothFault::report(&mut commands, each.entity, each.fault, part, outcome);
    }
}

impl BindingItem<'_, '_> {
    fn bind(
        &self,
        driving: &DriveQueryItem,
        surface: Arc<Surface>,
        changed: &[AssetId<Mesh>],
        meshes: &mut Assets<Mesh>,
        server: Option<&AssetServer>,
        commands: &mut Commands,
    ) -> Result<(), ClothError> {
        // The mesh that the entity drew before the plugin's copy.
        let other = self.mesh.map(|mesh| &mesh.0);
        let other = other.filter(|mesh| self.state.is_none_or(|state| state.handle != **mesh));
        let source = other.or(self.state.map(|state| &state.source));
        let source = source.ok_or(MeshError::NotLoaded)?.clone();
        let Some(asset) = meshes.get(&source) else {
            return Err(not_there(server, source.id()).into());
        };
        let place = self.place.copied().unwrap_or_default();
        let cloth = driving.place.copied().unwrap_or_default();
        let places = [place, cloth];
        // Not tried again unless something changes: binding a mesh takes milliseconds.
        if let Some(refused) = self.refused
            && refused.source == source.id()
            && Arc::ptr_eq(&refused.surface, &surface)
            && refused.places == places
            && !changed.contains(&source.id())
        {
            return Err(refused.error.clone());
        }
        let mut entity = commands.entity(self.entity);
        let (copy, driven) = match Driven::new(asset, &surface, &place, &cloth) {
            Ok(new) => new,
            Err(error) => {
                entity.try_insert(RefusedMesh {
                    source: source.id(),
                    surface,
                    places,
                    error: error.clone(),
                });
                return Err(error);
            }
        };
        let handle = meshes.add(copy);
        let state = RenderMeshState {
            source,
            handle: handle.clone(),
            bound: Some(Bound {
                cloth: self.wanted.cloth,
                surface,
                driven,
            }),
        };
        entity.try_insert((Mesh3d(handle), state));
        entity.try_remove::<RefusedMesh>();
        Ok(())
    }
}

/// Draws the meshes on their drawn cloths.
fn update(
    mut driven: Query<(
        &mut RenderMeshState,
        Option<&GlobalTransform>,
        Option<&InheritedVisibility>,
    )>,
    driving: Query<(&MeshDrawing, Option<&GlobalTransform>)>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for (mut state, place, visibility) in &mut driven {
        let is_hidden = visibility.is_some_and(|visibility| !visibility.get());
        let RenderMeshState { handle, bound, .. } = &mut *state;
        let place = place.copied().unwrap_or_default();
        if let Some(to) = bound
            && let Ok((cloth, at)) = driving.get(to.cloth)
            && !is_hidden
            && cloth.is_of(&to.surface)
            && let at = at.copied().unwrap_or_default()
            && to.driven.follow(&to.surface, cloth, &place, &at)
            && let Some(mut mesh) = meshes.get_mut(&*handle)
        {
            to.driven.write(&mut mesh);
        }
    }
}

/// An entity that is no longer driven draws its asset again, unless the game has replaced the copy.
fn remove_render_mesh(
    removed: On<Remove, ClothRenderMesh>,
    states: Query<(&RenderMeshState, Option<&Mesh3d>)>,
    faults: Query<&ClothFault>,
    mut commands: Commands,
) {
    let mut entity = commands.entity(removed.entity);
    if let Ok((state, Some(drawn))) = states.get(removed.entity)
        && drawn.0 == state.handle
    {
        entity.try_insert(Mesh3d(state.source.clone()));
    }
    entity.try_remove::<(RenderMeshState, RefusedMesh)>();
    let known = faults.get(removed.entity).ok();
    let part = Part::RenderMesh;
    ClothFault::report(&mut commands, removed.entity, known, part, Ok(()));
}
