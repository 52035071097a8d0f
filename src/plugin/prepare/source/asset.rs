//! The meshes of cloths and colliders that are made from assets.

use bevy::{
    asset::LoadState,
    ecs::system::SystemParam,
    platform::collections::HashMap,
    prelude::{AssetId, AssetServer, Assets, Entity, Mesh, Mesh3d, Query, Res, Resource},
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
pub(crate) struct ChangedMeshes(pub(super) HashMap<AssetId<Mesh>, u32>);

/// The error of a mesh that is not among the assets.
pub(crate) fn not_there(server: Option<&AssetServer>, id: AssetId<Mesh>) -> MeshError {
    match server.and_then(|server| server.get_load_state(id)) {
        Some(LoadState::Failed(error)) => MeshError::Failed {
            reason: error.to_string(),
        },
        Some(LoadState::Loading) => MeshError::Loading,
        Some(LoadState::NotLoaded | LoadState::Loaded) | None => MeshError::NotLoaded,
    }
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
        if self.get(id).is_ok() {
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
        Err(not_there(self.server.as_deref(), id).into())
    }

    fn get(&self, id: AssetId<Mesh>) -> Result<&Mesh, MeshError> {
        let mesh = self.meshes.as_ref().and_then(|meshes| meshes.get(id));
        mesh.ok_or(MeshError::NotLoaded)
    }

    /// The triangles of a mesh that has been loaded.
    ///
    /// # Errors
    /// The error of the mesh.
    pub fn triangles(&self, id: AssetId<Mesh>) -> Result<TriangleMesh, MeshError> {
        TriangleMesh::of_asset(self.get(id)?)
    }

    /// The triangles of a mesh, with the joints and weights of its vertices.
    ///
    /// # Errors
    /// The error of the mesh; [`SkinError::MissingJoints`] if it names no joints.
    fn with_skin(&self, source: Source) -> Result<(TriangleMesh, Vec<JointWeights>), ClothError> {
        let (needed, joints) = (1, 0);
        let skin = skin_of_asset(self.get(source.mesh)?)?;
        let skin = skin.ok_or(SkinError::MissingJoints { needed, joints })?;
        Ok((self.triangles(source.mesh)?, skin))
    }

    /// The skinning by joints of a surface that was made from that mesh.
    ///
    /// # Errors
    /// The error of the mesh; [`SkinError::MissingJoints`] if it names no joints.
    pub fn skinning(&self, source: Source, surface: &Surface) -> Result<Skinning, ClothError> {
        let (mesh, skin) = self.with_skin(source)?;
        Ok(Skinning::new(surface, &mesh.positions, &skin)?)
    }

    /// The triangles of a skinned mesh, bound to its joints.
    ///
    /// # Errors
    /// As for [`skinning`](Self::skinning).
    pub fn skinned(&self, source: Source) -> Result<SkinnedTriangles, ClothError> {
        let (mesh, skin) = self.with_skin(source)?;
        SkinnedTriangles::new(&mesh.positions, &mesh.triangles, &skin)
    }

    /// The triangles of a recipe that is made from an asset; none of any other.
    ///
    /// # Errors
    /// The error of the mesh.
    pub fn mesh(&self, recipe: &Recipe) -> Result<TriangleMesh, MeshError> {
        let mesh = recipe.source.map(|source| self.triangles(source.mesh));
        mesh.unwrap_or_else(|| Ok(TriangleMesh::default()))
    }
}
