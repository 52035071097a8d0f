//! Shared data that is built beside the game.

use std::sync::Arc;

use bevy::tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on};

use super::{recipe::Recipe, shared::Shared};
use crate::{
    cloth::{ClothError, ClothMaterial, ClothMaterialMap, TriangleMesh},
    hierarchy::QuadTree,
};

/// Ticks without a cloth that waits for it, after which a task is given up.
const PATIENCE: u32 = 60;

/// What is to be built.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BuildRequest {
    pub recipe: Recipe,
    pub material: ClothMaterial,
    pub map: Option<ClothMaterialMap>,
}

impl BuildRequest {
    /// Builds it of a mesh, if it is made from an asset.
    ///
    /// # Errors
    /// Those of the surface, its grain, tears and map.
    fn build(self, mesh: &TriangleMesh) -> Result<Shared, ClothError> {
        let Self {
            recipe,
            material,
            map,
        } = self;
        let surface = Arc::new(recipe.surface(mesh)?);
        let factors = match &map {
            Some(map) => map.factors(&surface)?.stiffness,
            None => Arc::default(),
        };
        let tree = QuadTree::of_surface(&surface, material.shear_compliance.is_finite());
        let shared = Shared::new(recipe, &material, surface, factors, || tree);
        // The first tick needs them.
        shared.surface.fans();
        shared.sheet();
        Ok(shared)
    }
}

/// A task that builds what is requested.
#[derive(Debug)]
struct Building {
    request: BuildRequest,
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

    /// What has been built of this request, which begins to be built if it is not yet. `mesh` is that of its asset.
    ///
    /// # Errors
    /// [`ClothError::MeshLoading`] until it is built; that of `mesh`, and those of the surface, its grain, tears and map.
    pub fn get(
        &mut self,
        request: BuildRequest,
        mesh: impl FnOnce() -> Result<TriangleMesh, ClothError>,
    ) -> Result<Shared, ClothError> {
        let known = self.all.iter().position(|known| known.request == request);
        let Some(known) = known else {
            let (mesh, wanted) = (mesh()?, request.clone());
            let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
            self.all.push(Building {
                request,
                task: pool.spawn(async move { wanted.build(&mesh) }),
                idle: 0,
            });
            return Err(ClothError::MeshLoading);
        };
        self.all[known].idle = 0;
        if !self.all[known].task.is_finished() {
            return Err(ClothError::MeshLoading);
        }
        block_on(self.all.swap_remove(known).task)
    }
}
