//! Fine meshes that coarse cloths drive.

mod drawn;

use std::sync::Arc;

use bevy::{
    app::{App, Plugin, PostUpdate},
    asset::{AssetEvent, AssetEventSystems, AssetId, AssetServer, Assets, Handle, LoadState},
    camera::visibility::InheritedVisibility,
    ecs::{
        component::Component,
        entity::{ComponentCloneCtx, Entity, MapEntities, SourceComponent},
        lifecycle::Remove,
        message::MessageReader,
        observer::On,
        query::{QueryData, With, Without},
        reflect::{ReflectComponent, ReflectFromWorld, ReflectMapEntities},
        schedule::{IntoScheduleConfigs, common_conditions::resource_exists},
        system::{Commands, Local, Query, Res, ResMut},
        world::{FromWorld, World},
    },
    mesh::{Mesh, Mesh3d},
    reflect::{Reflect, std_traits::ReflectDefault},
    transform::components::GlobalTransform,
};

use super::{ClothBuilt, ClothFault, ClothMesh, mesh::MeshSystems, naming::Part};
use crate::cloth::{Cloth, ClothError, Surface};
use drawn::Driven;

/// On an entity with a [`Mesh3d`]: a cloth drives this mesh. A coarse cloth is simulated, and a fine mesh is drawn on it (also
/// known as proxy simulation, or as a wrap deformer).
///
/// Each vertex is bound once to the nearest point of the cloth at rest, where both entities are placed as the mesh is first drawn: put
/// them so that the mesh is where the cloth is before it falls, for instance as a child of the cloth or at the same transform. From then
/// on the mesh is drawn where the cloth is, wherever its own entity goes, interpolated between ticks as the cloth is; normals and tangents
/// are turned along, texture coordinates and all else stay as they are ([`SurfaceBinding`](crate::cloth::SurfaceBinding) says how). A copy
/// of the asset is drawn, which others keep as it is. The cloth may be of either kind, and hidden by
/// `Visibility::Hidden`: then its own mesh is not written. Several meshes may hang on one cloth, each on an entity of its own, which
/// is not itself a cloth.
///
/// The binding is made again when the `Mesh3d`, the asset or the cloth's shape change. A mesh farther from the cloth than that is large,
/// one that can't be read and a cloth that is gone are a [`ClothFault`]. When the component is taken away the entity draws its asset
/// again.
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
#[reflect(Component, FromWorld, MapEntities, Debug, Clone, PartialEq)]
pub struct ClothRenderMesh {
    /// The cloth that drives the mesh.
    #[entities]
    pub cloth: Entity,
}

impl FromWorld for ClothRenderMesh {
    /// Of no cloth as yet, for editors: a fault.
    fn from_world(_: &mut World) -> Self {
        let cloth = Entity::PLACEHOLDER;
        Self { cloth }
    }
}

/// What is drawn for a [`ClothRenderMesh`]. In scenes and clones it is no more than which asset was replaced: all else is made again.
#[derive(Component, Reflect, Debug, Default)]
#[reflect(Component, Default)]
#[component(clone_behavior = Custom(clone_replaced))]
struct RenderMeshState {
    /// What the entity drew before.
    source: Handle<Mesh>,
    /// What is drawn.
    #[reflect(ignore)]
    handle: Handle<Mesh>,
    #[reflect(ignore)]
    bound: Option<Bound>,
}

/// What a mesh is bound to.
#[derive(Debug)]
struct Bound {
    cloth: Entity,
    surface: Arc<Surface>,
    driven: Driven,
}

/// What could not be bound, and why: looked at again once something is another.
#[derive(Component, Debug)]
struct RefusedMesh {
    source: AssetId<Mesh>,
    surface: Arc<Surface>,
    /// Where the mesh and the cloth are.
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

/// Draws each [`ClothRenderMesh`] where its cloth takes it, once a rendered frame. Does nothing in an app without meshes. It is
/// for a [`ClothMeshPlugin`](super::ClothMeshPlugin).
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
                    bind.after(MeshSystems::Add).before(MeshSystems::Write),
                    update
                        .after(bind)
                        .after(MeshSystems::Write)
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

/// What a mesh is bound to.
#[derive(QueryData)]
#[query_data(mutable)]
struct Driving {
    built: &'static ClothBuilt,
    place: Option<&'static GlobalTransform>,
    mesh: &'static mut ClothMesh,
}

/// Binds meshes to cloths, once both are there.
fn bind(
    mut wanted: Query<Binding, Without<Cloth>>,
    cloths: Query<(), With<Cloth>>,
    mut driving: Query<Driving>,
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
                driving.mesh.drive();
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
            // It has its parts with the next tick.
            _ if cloths.contains(cloth) => continue,
            _ => Err(ClothError::NoDrivingCloth { cloth }),
        };
        // What is on its way is no fault.
        let outcome = match outcome {
            Err(ClothError::MeshLoading) => Ok(()),
            outcome => outcome,
        };
        let part = Part::RenderMesh;
        ClothFault::report(&mut commands, each.entity, each.fault, part, outcome);
    }
}

impl BindingItem<'_, '_> {
    fn bind(
        &self,
        driving: &DrivingItem,
        surface: Arc<Surface>,
        changed: &[AssetId<Mesh>],
        meshes: &mut Assets<Mesh>,
        server: Option<&AssetServer>,
        commands: &mut Commands,
    ) -> Result<(), ClothError> {
        // What the entity drew before the plugin's copy.
        let other = self.mesh.map(|mesh| &mesh.0);
        let other = other.filter(|mesh| self.state.is_none_or(|state| state.handle != **mesh));
        let source = other.or(self.state.map(|state| &state.source));
        let source = source.ok_or(ClothError::MeshNotLoaded)?.clone();
        let Some(asset) = meshes.get(&source) else {
            return Err(
                match server.and_then(|server| server.get_load_state(&source)) {
                    Some(LoadState::Failed(error)) => ClothError::MeshFailed {
                        reason: error.to_string(),
                    },
                    Some(LoadState::Loading) => ClothError::MeshLoading,
                    _ => ClothError::MeshNotLoaded,
                },
            );
        };
        let place = self.place.copied().unwrap_or_default();
        let cloth = driving.place.copied().unwrap_or_default();
        let places = [place, cloth];
        // What was refused would be again: a mesh takes milliseconds to bind.
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

/// Draws the meshes where their cloths have been drawn.
fn update(
    mut driven: Query<(
        &mut RenderMeshState,
        Option<&GlobalTransform>,
        Option<&InheritedVisibility>,
    )>,
    driving: Query<(&ClothMesh, Option<&GlobalTransform>)>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for (mut state, place, visibility) in &mut driven {
        let is_hidden = visibility.is_some_and(|visibility| !visibility.get());
        let RenderMeshState { handle, bound, .. } = &mut *state;
        let Some(Bound {
            cloth,
            surface,
            driven,
        }) = bound
        else {
            continue;
        };
        let Ok((cloth, at)) = driving.get(*cloth) else {
            continue;
        };
        if is_hidden || !cloth.is_of(surface) {
            continue;
        }
        let place = place.copied().unwrap_or_default();
        let at = at.copied().unwrap_or_default();
        if driven.follow(surface, cloth, &place, &at)
            && let Some(mut mesh) = meshes.get_mut(&*handle)
        {
            driven.write(&mut mesh);
        }
    }
}

/// What is driven no more draws its asset again, unless the game has put something else in place of the copy.
fn remove_render_mesh(
    removed: On<Remove, ClothRenderMesh>,
    states: Query<(&RenderMeshState, Option<&Mesh3d>)>,
    faults: Query<&ClothFault>,
    mut commands: Commands,
) {
    if let Ok((state, drawn)) = states.get(removed.entity) {
        let mut entity = commands.entity(removed.entity);
        if drawn.is_some_and(|drawn| drawn.0 == state.handle) {
            entity.try_insert(Mesh3d(state.source.clone()));
        }
        entity.try_remove::<RenderMeshState>();
    }
    commands.entity(removed.entity).try_remove::<RefusedMesh>();
    let known = faults.get(removed.entity).ok();
    let part = Part::RenderMesh;
    ClothFault::report(&mut commands, removed.entity, known, part, Ok(()));
}
