//! Gives cloths their meshes, and takes them away.

use bevy::{
    mesh::skinning::SkinnedMesh,
    prelude::{Assets, Commands, Entity, Mesh, Mesh3d, On, Query, Remove, ResMut},
};

use super::{
    drawing::MeshDrawing,
    write::{Tangents, copy_of, mesh_of},
};
use crate::{
    cloth::{Cloth, ClothShape},
    plugin::{
        authoring::{ClothMesh, ClothSkeleton},
        state::{ClothBuilt, Notices},
    },
};

/// Gives a mesh to each cloth that has none, or the mesh of another surface.
pub(in crate::plugin::draw) fn add_meshes(
    cloths: Query<(
        Entity,
        &Cloth,
        &ClothBuilt,
        Option<&Mesh3d>,
        Option<&ClothMesh>,
        Option<&SkinnedMesh>,
    )>,
    mut drawings: Query<&mut MeshDrawing>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut notices: ResMut<Notices>,
    mut commands: Commands,
) {
    for (entity, cloth, built, mesh, drawn, skin) in &cloths {
        let surface = built.surface();
        let drawing = drawings.get(entity);
        let is_current = drawing.is_ok_and(|drawing| drawing.is_of(surface));
        let is_right = |drawn: &ClothMesh| is_current && meshes.contains(&drawn.handle);
        if surface.is_empty() {
            continue;
        }
        if let Some(skin) = skin {
            // The particles that are drawn follow the skeleton already.
            let mut cloth = commands.entity(entity);
            cloth.try_insert(ClothSkeleton::of(skin));
            cloth.try_remove::<SkinnedMesh>();
        }
        if let Some(drawn) = drawn.filter(|drawn| is_right(drawn)) {
            // The game has put back the mesh that the cloth was made from.
            if mesh.is_some_and(|mesh| Some(&mesh.0) == drawn.source.as_ref()) {
                let own = Mesh3d(drawn.handle.clone());
                commands.entity(entity).try_insert(own);
            }
            continue;
        }
        // The mesh that the entity drew before the plugin's own.
        let known = drawn.and_then(|drawn| drawn.replaced.clone());
        let other = mesh.filter(|mesh| drawn.is_none_or(|drawn| drawn.handle != mesh.0));
        let is_asset = matches!(cloth.shape, ClothShape::Mesh { .. });
        let is_own = |mesh: &Mesh3d| {
            let mut drawn = cloths.iter().filter_map(|(.., drawn, _)| drawn);
            drawn.any(|drawn| drawn.handle == mesh.0)
        };
        // A scene or a clone brings a mesh of the plugin's along.
        if drawn.is_none() && !is_asset && other.is_some_and(|mesh| !is_own(mesh)) {
            notices.add(entity, replacing(cloth));
        }
        let replaced = other.map(|mesh| mesh.0.clone()).or(known);
        let source = replaced.clone().filter(|_| is_asset);
        // The asset that the cloth was made from may have been removed meanwhile, or be in the render world alone.
        let asset = source.as_ref().and_then(|source| meshes.get(source));
        let copy = asset.and_then(|asset| copy_of(asset, surface));
        let (copy, vertices) = copy.unwrap_or_else(|| mesh_of(surface));
        let tangents = Tangents::of(&copy);
        let handle = meshes.add(copy);
        let drawn = ClothMesh {
            handle: handle.clone(),
            source,
            replaced,
        };
        let new = MeshDrawing {
            surface: surface.clone(),
            tangents,
            vertices,
            ..MeshDrawing::default()
        };
        let mut cloth = commands.entity(entity);
        cloth.try_insert((Mesh3d(handle), drawn));
        if let Ok(mut drawing) = drawings.get_mut(entity) {
            drawing.replace(new);
        } else {
            cloth.try_insert(new);
        }
    }
}

/// The text for a cloth that ignores the `Mesh3d` on its entity.
fn replacing(cloth: &Cloth) -> String {
    let kind = match cloth.shape {
        ClothShape::Grid(_) => "a grid",
        _ if cloth.shape.is_rope() => "a rope",
        _ => "made of its own triangles",
    };
    format!(
        "it is {kind} and is drawn in place of its `Mesh3d`: use `Cloth::mesh()` to make the cloth from that mesh, or put the `Mesh3d` on another entity \
         with a `ClothRenderMesh`"
    )
}

/// An entity that is no cloth any more draws again what it drew before, if anything. A mesh that the game has put in
/// place of the plugin's stays.
pub(super) fn remove_mesh(
    removed: On<Remove, Cloth>,
    meshes: Query<(&ClothMesh, Option<&Mesh3d>, Option<&ClothSkeleton>)>,
    mut commands: Commands,
) {
    if let Ok((own, drawn, skeleton)) = meshes.get(removed.entity) {
        let mut entity = commands.entity(removed.entity);
        if drawn.is_some_and(|drawn| drawn.0 == own.handle) {
            match &own.replaced {
                Some(replaced) => entity.try_insert(Mesh3d(replaced.clone())),
                None => entity.try_remove::<Mesh3d>(),
            };
        }
        if let Some(skeleton) = skeleton {
            entity.try_insert(skeleton.to_skin());
            entity.try_remove::<ClothSkeleton>();
        }
        entity.try_remove::<(ClothMesh, MeshDrawing)>();
    }
}
