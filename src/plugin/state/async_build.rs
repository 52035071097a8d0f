//! Shared data that is built in the background.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

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
    /// That of the same cloth with other tears: its whole surface is torn anew.
    pub before: Option<Arc<Shared>>,
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
            None => Arc::new(match &self.before {
                Some(before) => self.recipe.opened(before.surface.whole())?,
                None => self.recipe.surface(mesh)?,
            }),
        };
        let factors = self.factors(&surface)?;
        let before = self.before.as_deref();
        let shared = Shared::new(self.recipe, &self.material, surface, factors, alike, before);
        // The first tick needs them.
        shared.surface.fans();
        if before.is_none_or(Shared::has_sheet) {
            shared.sheet();
        }
        Ok(shared)
    }
}

/// A task that builds what is requested.
#[derive(Debug)]
struct Building {
    recipe: Recipe,
    task: Task<Result<Shared, ClothError>>,
    /// Whether the task has begun, or is not to begin any more.
    has_begun: Arc<AtomicBool>,
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

    /// The same, but waits until it is built; `None` also if the task has not begun: it could be behind any number of others.
    ///
    /// # Errors
    /// Those of the surface, its grain, tears and map.
    pub fn finish(&mut self, recipe: &Recipe) -> Result<Option<Shared>, ClothError> {
        let Some(known) = self.all.iter().position(|known| known.recipe == *recipe) else {
            return Ok(None);
        };
        let building = self.all.swap_remove(known);
        match building.has_begun.swap(true, Ordering::Relaxed) {
            true => block_on(building.task).map(Some),
            false => Ok(None),
        }
    }

    /// Whether a task builds this recipe.
    pub fn builds(&self, recipe: &Recipe) -> bool {
        self.all.iter().any(|known| known.recipe == *recipe)
    }

    /// Begins to build: of `mesh`, if it is made from an asset, or of parts that are made `alike`.
    pub fn begin(&mut self, request: BuildRequest, mesh: TriangleMesh, alike: Vec<Arc<Shared>>) {
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
        let has_begun = Arc::new(AtomicBool::new(false));
        self.all.push(Building {
            recipe: request.recipe.clone(),
            has_begun: has_begun.clone(),
            task: pool.spawn(async move {
                if has_begun.swap(true, Ordering::Relaxed) {
                    // Nobody waits for it.
                    return Err(ClothError::MeshLoading);
                }
                request.build(&mesh, &alike)
            }),
            idle: 0,
        });
    }
}

#[cfg(test)]
mod tests {
    use std::{
        sync::mpsc::{Sender, channel},
        thread,
        time::Duration,
    };

    use bevy::math::Vec3;

    use super::*;
    use crate::{
        cloth::{Cloth, ClothParticles, ClothTears},
        meshes::irregular,
        solver::TickStep,
    };

    fn recipe(cloth: &Cloth, edges: usize) -> Recipe {
        let mut tears = ClothTears::default();
        let surface = cloth.surface(Vec3::ONE).expect("a surface");
        let sides = surface.triangles().iter().map(|[a, b, _]| [*a, *b]);
        tears.tear_all(sides.step_by(5).take(edges));
        Recipe {
            shape: cloth.shape.clone(),
            scale: Vec3::ONE,
            source: None,
            grain: None,
            tears,
            as_mesh: false,
        }
    }

    fn request(cloth: &Cloth, edges: usize, before: Option<Arc<Shared>>) -> BuildRequest {
        BuildRequest {
            recipe: recipe(cloth, edges),
            material: ClothMaterial {
                stretch_compliance: 1.0e-3,
                bend_rigidity: 1.0e-4,
                ..ClothMaterial::COTTON
            },
            map: None,
            before,
        }
    }

    /// Places (m) after eight ticks of a cloth that hangs by its first particle.
    fn moved(shared: &Shared, material: &ClothMaterial) -> Vec<Vec3> {
        let at_rest = ClothParticles::at_rest(&shared.surface, material);
        let mut particles = at_rest.expect("a material");
        particles.pin(0);
        let mut solver = shared.solver.clone();
        let step = TickStep {
            seconds: 1.0 / 64.0,
            substeps: 8,
            acceleration: Vec3::new(1.0, -9.81, 2.0),
            ..TickStep::default()
        };
        for _ in 0..8 {
            solver.advance(&mut particles, step, &[], |_, _| false);
        }
        particles.positions().collect()
    }

    /// The data that is built ahead of a cloth with other tears is that of a new cloth, bit for bit.
    #[test]
    fn what_is_built_ahead_is_as_built_anew() {
        let mesh = irregular(0.5, 0.5, 0.1, 0.3);
        let mesh = Cloth::triangles(mesh.positions, mesh.triangles);
        for cloth in [Cloth::new(6, 6, 0.1), mesh] {
            let build = |request: BuildRequest| request.build(&TriangleMesh::default(), &[]);
            let before = build(request(&cloth, 3, None)).expect("a surface");
            let ahead = request(&cloth, 6, Some(Arc::new(before)));
            let (recipe, material) = (ahead.recipe.clone(), ahead.material);
            let mut builds = AsyncBuilds::default();
            builds.begin(ahead, TriangleMesh::default(), Vec::new());
            while !builds.all[0].has_begun.load(Ordering::Relaxed) {
                thread::sleep(Duration::from_millis(1));
            }
            let built = builds.finish(&recipe).expect("a surface");
            let built = built.expect("its task has begun");
            let new = build(request(&cloth, 6, None)).expect("a surface");
            assert!(new.surface.len() > cloth.surface(Vec3::ONE).expect("a surface").len());
            assert_eq!(moved(&built, &material), moved(&new, &material));
            assert!(!builds.builds(&recipe));
        }
    }

    /// A task that waits behind others is not waited for: the tick builds it itself.
    #[test]
    fn a_task_that_has_not_begun_is_not_waited_for() {
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
        // Each of these keeps a thread busy until it is let go.
        let busy: Vec<(Sender<()>, Task<()>)> = (0..pool.thread_num())
            .map(|_| {
                let (begins, has_begun) = channel();
                let (let_go, waits) = channel();
                let task = pool.spawn(async move {
                    begins.send(()).expect("it is waited for");
                    let _ended: Result<(), _> = waits.recv();
                });
                has_begun.recv().expect("a thread is free");
                (let_go, task)
            })
            .collect();
        let ahead = request(&Cloth::new(6, 6, 0.1), 6, None);
        let recipe = ahead.recipe.clone();
        let mut builds = AsyncBuilds::default();
        builds.begin(ahead, TriangleMesh::default(), Vec::new());
        let found = builds.finish(&recipe).expect("no error");
        let has_begun = found.is_some();
        for (let_go, task) in busy {
            drop(let_go);
            block_on(task);
        }
        assert!(!has_begun);
        assert!(builds.all.is_empty());
    }
}
