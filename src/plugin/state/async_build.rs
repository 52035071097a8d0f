//! Shared data that is built in the background.

use std::sync::Arc;

use bevy::tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on};

use super::{recipe::Recipe, shared::Shared};
use crate::cloth::{
    ClothError, ClothMaterial, ClothMaterialMap, StiffnessFactors, Surface, TriangleMesh,
};

/// Ticks without a cloth that waits for it, after which a task is given up.
const PATIENCE: u32 = 16;

/// A request to build shared data.
#[derive(Debug, Clone)]
pub(crate) struct BuildRequest {
    pub recipe: Recipe,
    pub material: ClothMaterial,
    pub map: Option<ClothMaterialMap>,
}

impl BuildRequest {
    /// The factors of its map on its surface.
    ///
    /// # Errors
    /// Those of [`ClothMaterialMap::factors`].
    pub fn factors(&self, surface: &Surface) -> Result<Arc<StiffnessFactors>, ClothError> {
        match &self.map {
            Some(map) => Ok(map.factors(surface)?.stiffness),
            None => Ok(Arc::default()),
        }
    }

    /// Builds it: of a mesh, if it is made from an asset, or of parts that are made alike.
    ///
    /// # Errors
    /// Those of the surface, its grain, tears and map.
    fn build(self, mesh: &TriangleMesh, alike: &[Arc<Shared>]) -> Result<Shared, ClothError> {
        let surface = match alike.first() {
            Some(alike) => alike.surface.clone(),
            None => Arc::new(self.recipe.surface(mesh)?),
        };
        let factors = self.factors(&surface)?;
        let shared = Shared::new(self.recipe, &self.material, surface, factors, alike, None);
        // The first tick needs them.
        shared.surface.fans();
        shared.sheet();
        Ok(shared)
    }
}

/// A task that builds what is requested.
#[derive(Debug)]
struct Building {
    recipe: Recipe,
    task: Task<Result<Shared, ClothError>>,
    /// Ticks since a cloth waited for it.
    idle: u32,
}

/// All tasks that build.
#[derive(Debug, Default)]
pub(crate) struct AsyncBuilds {
    all: Vec<Building>,
}

impl AsyncBuilds {
    /// Begins a tick.
    pub fn begin_tick(&mut self) {
        for building in &mut self.all {
            building.idle += 1;
        }
        self.all.retain(|building| building.idle <= PATIENCE);
    }

    /// Takes the data that is built of this recipe; `None` if nothing builds it. Its material may have changed since the request.
    ///
    /// # Errors
    /// [`ClothError::MeshLoading`] until it is built; those of the surface, its grain, tears and map.
    pub fn take(&mut self, recipe: &Recipe) -> Result<Option<Shared>, ClothError> {
        let Some(known) = self.all.iter().position(|known| known.recipe == *recipe) else {
            return Ok(None);
        };
        self.all[known].idle = 0;
        if !self.all[known].task.is_finished() {
            return Err(ClothError::MeshLoading);
        }
        block_on(self.all.swap_remove(known).task).map(Some)
    }

    /// Begins to build: of `mesh`, if it is made from an asset, or of parts that are made `alike`.
    pub fn begin(&mut self, request: BuildRequest, mesh: TriangleMesh, alike: Vec<Arc<Shared>>) {
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
        self.all.push(Building {
            recipe: request.recipe.clone(),
            task: pool.spawn(async move { request.build(&mesh, &alike) }),
            idle: 0,
        });
    }
}
