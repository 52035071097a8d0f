//! All data that cloths share.

use std::sync::{Arc, Weak};

use bevy::ecs::resource::Resource;

use super::{
    async_build::{AsyncBuilds, BuildRequest},
    recipe::Recipe,
    shared::{Shared, Stiffnesses},
};
use crate::{
    cloth::{ClothError, ClothMaterial, SpringKind, StiffnessFactors, Surface, TriangleMesh},
    hierarchy::QuadTree,
};

/// All shared data in use.
#[derive(Resource, Debug, Default)]
pub(crate) struct SharedParts {
    known: Vec<Weak<Shared>>,
    builds: AsyncBuilds,
}

impl SharedParts {
    /// The shared data of cloths with this recipe and material, and the factors that `factors` finds for its surface. The
    /// surface is made by `make` if there is none yet.
    ///
    /// # Errors
    /// Those of `make` and `factors`.
    pub fn get(
        &mut self,
        recipe: &Recipe,
        material: &ClothMaterial,
        factors: impl FnOnce(&Surface) -> Result<Arc<StiffnessFactors>, ClothError>,
        make: impl FnOnce() -> Result<Surface, ClothError>,
    ) -> Result<Arc<Shared>, ClothError> {
        let all = self.known.iter().filter_map(Weak::upgrade);
        let alike: Vec<_> = all
            .filter(|known| known.recipe.as_ref() == Some(recipe))
            .collect();
        let surface = match alike.last() {
            Some(known) => known.surface.clone(),
            None => Arc::new(make()?),
        };
        let factors = factors(&surface)?;
        let stiffnesses = Stiffnesses::of(material, &factors);
        if let Some(known) = alike.iter().find(|known| known.stiffnesses == stiffnesses) {
            return Ok(known.clone());
        }
        // A tree does not know of stiffness.
        let has_diagonals = material.shear_compliance.is_finite();
        let known = alike.last().filter(|known| {
            surface.as_grid().is_none() || known.springs.has(SpringKind::Shear) == has_diagonals
        });
        let tree = || match &known {
            Some(known) => known.tree.clone(),
            None => QuadTree::of_surface(&surface, has_diagonals),
        };
        let shared = Shared::new(recipe.clone(), material, surface.clone(), factors, tree);
        Ok(self.keep(shared))
    }

    /// Makes it known.
    fn keep(&mut self, shared: Shared) -> Arc<Shared> {
        let shared = Arc::new(shared);
        self.known.retain(|known| known.strong_count() > 0);
        self.known.push(Arc::downgrade(&shared));
        shared
    }

    /// The shared data of an order that is built beside the game, to be kept until [`get`](Self::get) finds it; `None` if a surface
    /// of its recipe is known already: what is left then is quickly built.
    ///
    /// # Errors
    /// Those of [`AsyncBuilds::get`].
    pub fn get_built(
        &mut self,
        order: BuildRequest,
        mesh: impl FnOnce() -> Result<TriangleMesh, ClothError>,
    ) -> Result<Option<Arc<Shared>>, ClothError> {
        let mut all = self.known.iter().filter_map(Weak::upgrade);
        if all.any(|known| known.recipe.as_ref() == Some(&order.recipe)) {
            return Ok(None);
        }
        let built = self.builds.get(order, mesh)?;
        Ok(Some(self.keep(built)))
    }

    /// Begins a tick.
    pub fn begin_tick(&mut self) {
        self.builds.begin_tick();
    }

    /// The same for a cloth whose material, or the factors of it, have changed.
    pub fn with_material(
        &mut self,
        shared: &Arc<Shared>,
        material: &ClothMaterial,
        factors: &Arc<StiffnessFactors>,
    ) -> Arc<Shared> {
        let Some(recipe) = &shared.recipe else {
            return shared.clone();
        };
        // A surface of that recipe exists, so it can't be refused.
        let known = |_: &Surface| Ok(factors.clone());
        let other = self.get(recipe, material, known, || Ok((*shared.surface).clone()));
        other.unwrap_or_else(|_| shared.clone())
    }
}
