//! The meshes of cloths and colliders that are made from assets.

use bevy::{
    asset::{AssetId, AssetServer, Assets, LoadState},
    ecs::{
        entity::Entity,
        resource::Resource,
        system::{Query, Res, SystemParam},
    },
    mesh::{Mesh, Mesh3d},
    platform::collections::HashMap,
};

use crate::{
    cloth::{
        Cloth, ClothError, ClothShape, JointWeights, MeshError, SkinError, Skinning, Surface,
        TriangleMesh, skin_of_asset,
    },
    contact::SkinnedTriangles,
    plugin::{
        authoring::ClothMesh,
        state::{Recipe, Source},
    },
};

/// The number of changes of each mesh since it was loaded; unchanged meshes are not in it.
#[derive(Resource, Debug, Default)]
pub(crate) struct ChangedMeshes(HashMap<AssetId<Mesh>, u32>);

impl ChangedMeshes {
    /// A mesh has been changed.
    pub fn note(&mut self, mesh: AssetId<Mesh>) {
        *self.0.entry(mesh).or_default() += 1;
    }

    /// The mesh is no longer used.
    pub fn forget(&mut self, mesh: AssetId<Mesh>) {
        self.0.remove(&mesh);
    }
}

/// The joints and weights of a mesh's vertices.
///
/// # Errors
/// [`SkinError::MissingJoints`] if it names no joints.
fn skin_of(mesh: &Mesh) -> Result<Vec<JointWeights>, ClothError> {
    skin_of_asset(mesh)?.ok_or(ClothError::Skin(SkinError::MissingJoints {
        needed: 1,
        joints: 0,
    }))
}

/// The assets, if the app has any.
#[derive(SystemParam)]
pub(crate) struct Sources<'w, 's> {
    cloths: Query<'w, 's, (Option<&'static Mesh3d>, Option<&'static ClothMesh>)>,
    meshes: Option<Res<'w, Assets<Mesh>>>,
    server: Option<Res<'w, AssetServer>>,
    changed: Option<Res<'w, ChangedMeshes>>,
}

impl Sources<'_, '_> {
    /// The mesh that a cloth is made from, once it has been loaded; `None` for a cloth that is not made from an asset. `known`
    /// is the one that it was made from.
    ///
    /// # Errors
    /// [`MeshError::Loading`] while it is being loaded, [`NotLoaded`](MeshError::NotLoaded) if nothing
    /// loads it, [`Failed`](MeshError::Failed).
    pub fn find(
        &self,
        entity: Entity,
        cloth: &Cloth,
        known: Option<Source>,
    ) -> Result<Option<Source>, ClothError> {
        let ClothShape::Mesh { .. } = cloth.shape else {
            return Ok(None);
        };
        let (mesh, drawn) = self.cloths.get(entity).unwrap_or_default();
        let handle = match (mesh, drawn) {
            (Some(mesh), Some(drawn)) if drawn.id() == mesh.0.id() => drawn.source(),
            (Some(mesh), _) => Some(&mesh.0),
            (None, drawn) => drawn.and_then(ClothMesh::source),
        };
        let handle = handle.ok_or(MeshError::NotLoaded)?;
        self.loaded(handle.id(), known).map(Some)
    }

    /// The mesh and its version, once it has been loaded. `known` is the last one that was used.
    ///
    /// # Errors
    /// As for [`find`](Self::find).
    pub fn loaded(&self, id: AssetId<Mesh>, known: Option<Source>) -> Result<Source, ClothError> {
        if self
            .meshes
            .as_ref()
            .is_some_and(|meshes| meshes.contains(id))
        {
            let version = self.changed.as_ref().and_then(|changed| changed.0.get(&id));
            return Ok(Source {
                mesh: id,
                version: version.copied().unwrap_or(0),
            });
        }
        // A surface outlasts the asset that it was made from.
        if let Some(known) = known.filter(|known| known.mesh == id) {
            return Ok(known);
        }
        match self
            .server
            .as_ref()
            .and_then(|server| server.get_load_state(id))
        {
            Some(LoadState::Failed(error)) => Err(ClothError::Mesh(MeshError::Failed {
                reason: error.to_string(),
            })),
            Some(LoadState::Loading) => Err(MeshError::Loading.into()),
            Some(LoadState::NotLoaded | LoadState::Loaded) | None => {
                Err(MeshError::NotLoaded.into())
            }
        }
    }

    /// The triangles of a mesh that has been loaded.
    ///
    /// # Errors
    /// The error of the mesh.
    pub fn triangles(&self, id: AssetId<Mesh>) -> Result<TriangleMesh, MeshError> {
        let mesh = self.meshes.as_ref().and_then(|meshes| meshes.get(id));
        TriangleMesh::of_asset(mesh.ok_or(MeshError::NotLoaded)?)
    }

    /// The skinning by joints of a surface that was made from that mesh.
    ///
    /// # Errors
    /// The error of the mesh; [`SkinError::MissingJoints`] if it names no joints.
    pub fn skinning(&self, source: Source, surface: &Surface) -> Result<Skinning, ClothError> {
        let mesh = self
            .meshes
            .as_ref()
            .and_then(|meshes| meshes.get(source.mesh));
        let skin = skin_of(mesh.ok_or(MeshError::NotLoaded)?)?;
        let mesh = self.triangles(source.mesh)?;
        Ok(Skinning::new(surface, &mesh.positions, &skin)?)
    }

    /// The triangles of a skinned mesh, bound to its joints.
    ///
    /// # Errors
    /// As for [`skinning`](Self::skinning).
    pub fn skinned(&self, source: Source) -> Result<SkinnedTriangles, ClothError> {
        let mesh = self
            .meshes
            .as_ref()
            .and_then(|meshes| meshes.get(source.mesh));
        let skin = skin_of(mesh.ok_or(MeshError::NotLoaded)?)?;
        let mesh = self.triangles(source.mesh)?;
        SkinnedTriangles::new(&mesh.positions, &mesh.triangles, &skin)
    }

    /// The triangles of a recipe that is made from an asset; none of any other.
    ///
    /// # Errors
    /// The error of the mesh.
    pub fn mesh(&self, recipe: &Recipe) -> Result<TriangleMesh, MeshError> {
        let of = |source: Source| self.triangles(source.mesh);
        recipe
            .source
            .map_or_else(|| Ok(TriangleMesh::default()), of)
    }
}
