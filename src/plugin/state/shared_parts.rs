//! All data that cloths share.

use std::sync::{Arc, Weak};

use bevy::prelude::{Entity, Resource};

use super::{
    async_build::{AsyncBuilds, BuildRequest},
    recipe::Recipe,
    shared::{Shared, Stiffnesses},
};
use crate::{
    cloth::{
        ClothError, ClothMaterial, MaterialFactors, MeshError, PaintError, Surface, TriangleMesh,
    },
    plugin::threads::Threads,
};

/// All shared data in use.
#[derive(Resource, Debug, Default)]
pub(crate) struct SharedParts {
    known: Vec<Weak<Shared>>,
    pub builds: AsyncBuilds,
}

impl SharedParts {
    /// The shared data of cloths with this recipe and material, and the factors that `factors` finds for its surface; and these. The
    /// surface is made by `make` if there is none yet. `before` is of the same cloth with other tears.
    ///
    /// # Errors
    /// Those of `make` and `factors`.
    pub fn get(
        &mut self,
        recipe: &Recipe,
        material: &ClothMaterial,
        before: Option<&Shared>,
        factors: impl FnOnce(&Surface) -> Result<MaterialFactors, PaintError>,
        make: impl FnOnce() -> Result<Surface, ClothError>,
    ) -> Result<(Arc<Shared>, MaterialFactors), ClothError> {
        let alike = self.alike(recipe);
        let surface = match alike.first() {
            Some(known) => known.surface.clone(),
            None => Arc::new(make()?),
        };
        let factors = factors(&surface)?;
        let stiffnesses = Stiffnesses::of(material, &factors.stiffness);
        if let Some(known) = alike.iter().find(|known| known.stiffnesses == stiffnesses) {
            return Ok((known.clone(), factors));
        }
        let shared = Shared::new(
            Threads::Compute,
            recipe.clone(),
            material,
            surface,
            factors.stiffness.clone(),
            &alike,
            before,
        );
        Ok((self.keep(shared), factors))
    }

    /// Makes it known.
    fn keep(&mut self, shared: Shared) -> Arc<Shared> {
        let shared = Arc::new(shared);
        self.known.retain(|known| known.strong_count() > 0);
        self.known.push(Arc::downgrade(&shared));
        shared
    }

    /// The shared data of a request that is built in the background, to be kept until [`get`](Self::get) finds it; `None` if that is
    /// known already, or the request has a NaN: bad input is found at once.
    ///
    /// # Errors
    /// [`MeshError::Loading`] until it is built; that of `mesh`, and those of the surface, its grain, tears and map.
    pub fn get_built(
        &mut self,
        request: &BuildRequest,
        mesh: impl FnOnce() -> Result<TriangleMesh, MeshError>,
    ) -> Result<Option<Arc<Shared>>, ClothError> {
        let recipe = &request.recipe;
        if recipe.has_nan() {
            return Ok(None);
        }
        if let Some(built) = self.builds.take(recipe)? {
            return Ok(Some(self.keep(built)));
        }
        let alike = self.alike(recipe);
        if let Some(first) = alike.first() {
            let factors = request.factors(&first.surface)?;
            let stiffnesses = Stiffnesses::of(&request.material, &factors);
            if alike.iter().any(|known| known.stiffnesses == stiffnesses) {
                return Ok(None);
            }
        }
        self.builds.begin(request.clone(), mesh()?, alike, None);
        Err(MeshError::Loading.into())
    }

    /// Begins to build in the background what this cloth needs in its next tick, in place of what it needed before.
    pub fn build_ahead(&mut self, cloth: Entity, request: BuildRequest) {
        if self.alike(&request.recipe).is_empty() {
            let mesh = TriangleMesh::default();
            self.builds.begin(request, mesh, Vec::new(), Some(cloth));
        }
    }

    /// The shared data of a recipe that is [built ahead](Self::build_ahead), to be kept until [`get`](Self::get) finds it. `None` also
    /// if it can't be built: [`get`](Self::get) says why.
    pub fn built_ahead(&mut self, recipe: &Recipe) -> Option<Arc<Shared>> {
        let built = self.builds.take_begun(recipe)?.ok()?;
        Some(self.keep(built))
    }

    /// All that is made of a recipe.
    fn alike(&self, recipe: &Recipe) -> Vec<Arc<Shared>> {
        let all = self.known.iter().filter_map(Weak::upgrade);
        let alike = all.filter(|known| known.recipe.as_ref() == Some(recipe));
        alike.collect()
    }
}
