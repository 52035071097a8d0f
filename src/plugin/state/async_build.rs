//! Shared data that is built in the background.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use bevy::{
    ecs::entity::Entity,
    tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on},
};

use super::{recipe::Recipe, shared::Shared};
use crate::{
    cloth::{
        ClothError, ClothMaterial, ClothMaterialMap, MeshError, StiffnessFactors, Surface,
        TriangleMesh,
    },
    plugin::threads::Threads,
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
        let mut shared = Shared::new(
            Threads::This,
            self.recipe,
            &self.material,
            surface,
            factors,
            alike,
            before,
        );
        shared.make_ready(before.is_none_or(Shared::has_sheet));
        Ok(shared)
    }
}

/// A task that builds what is requested.
#[derive(Debug)]
pub(crate) struct BuildTask {
    recipe: Recipe,
    task: Task<Result<Shared, ClothError>>,
    /// The cloth that needs it in its next tick, if it is built ahead.
    cloth: Option<Entity>,
    /// Whether the task has begun, or is not to begin any more.
    is_claimed: Arc<AtomicBool>,
    /// Ticks since a cloth waited for it.
    idle: u32,
}

/// All tasks that build.
#[derive(Debug, Default)]
pub(crate) struct AsyncBuilds {
    pub all: Vec<BuildTask>,
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
    /// [`MeshError::Loading`] until it is built; those of the surface, its grain, tears and map.
    pub fn take(&mut self, recipe: &Recipe) -> Result<Option<Shared>, ClothError> {
        let Some(known) = self.all.iter().position(|known| known.recipe == *recipe) else {
            return Ok(None);
        };
        self.all[known].idle = 0;
        if !self.all[known].task.is_finished() {
            return Err(MeshError::Loading.into());
        }
        block_on(self.all.swap_remove(known).task).map(Some)
    }

    /// Takes the data of a task that has begun, and waits for its end. `None` also if the task has not begun: any number of others could
    /// be ahead of it.
    pub fn take_begun(&mut self, recipe: &Recipe) -> Option<Result<Shared, ClothError>> {
        let known = self.all.iter().position(|known| known.recipe == *recipe)?;
        let building = self.all.swap_remove(known);
        (building.is_claimed)
            .swap(true, Ordering::Relaxed)
            .then(|| block_on(building.task))
    }

    /// Begins to build: of `mesh`, if it is made from an asset, or of parts that are made `alike`. A request for
    /// `cloth`, to build ahead, takes the place of its last one.
    pub fn begin(
        &mut self,
        request: BuildRequest,
        mesh: TriangleMesh,
        alike: Vec<Arc<Shared>>,
        cloth: Option<Entity>,
    ) {
        self.all.retain(|known| {
            let is_replaced = cloth.is_some() && known.cloth == cloth;
            if is_replaced {
                known.is_claimed.store(true, Ordering::Relaxed);
            }
            !is_replaced
        });
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
        let is_claimed = Arc::new(AtomicBool::new(false));
        self.all.push(BuildTask {
            recipe: request.recipe.clone(),
            cloth,
            is_claimed: is_claimed.clone(),
            task: pool.spawn(async move {
                if is_claimed.swap(true, Ordering::Relaxed) {
                    // Nobody waits for it.
                    return Err(MeshError::Loading.into());
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
        time::{Duration, Instant},
    };

    use bevy::math::Vec3;

    use super::{
        super::shared::tests::{moved, recipe},
        *,
    };
    use crate::{
        cloth::{Cloth, ClothTears},
        meshes::irregular,
    };

    fn request(cloth: &Cloth, edges: usize, before: Option<Arc<Shared>>) -> BuildRequest {
        let surface = cloth.surface(Vec3::ONE).expect("a surface");
        let sides = surface.triangles().iter().map(|[a, b, _]| [*a, *b]);
        let mut tears = ClothTears::default();
        tears.tear_all(sides.step_by(5).take(edges));
        BuildRequest {
            recipe: Recipe {
                tears,
                ..recipe(&cloth.shape, false)
            },
            material: ClothMaterial {
                stretch_compliance: 1.0e-3,
                bend_rigidity: 1.0e-4,
                ..ClothMaterial::COTTON
            },
            map: None,
            before,
        }
    }

    fn begin_ahead(builds: &mut AsyncBuilds, request: BuildRequest) {
        builds.begin(
            request,
            TriangleMesh::default(),
            Vec::new(),
            Some(Entity::PLACEHOLDER),
        );
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
            begin_ahead(&mut builds, ahead);
            let start = Instant::now();
            while !builds.all[0].is_claimed.load(Ordering::Relaxed) {
                assert!(
                    start.elapsed() < Duration::from_secs(60),
                    "it does not begin"
                );
                thread::sleep(Duration::from_millis(1));
            }
            let built = builds.take_begun(&recipe).expect("its task has begun");
            let built = built.expect("a surface");
            let new = build(request(&cloth, 6, None)).expect("a surface");
            assert!(new.surface.is_torn());
            assert_eq!(moved(&built, &material), moved(&new, &material));
            assert!(builds.all.is_empty());
        }
    }

    /// A tick does not wait for a task behind others: it builds the data itself. A request for the same cloth replaces the last one.
    ///
    /// No other test may keep all threads of the pool busy.
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
                let begun = has_begun.recv_timeout(Duration::from_secs(60));
                begun.expect("a thread is free");
                (let_go, task)
            })
            .collect();
        let cloth = Cloth::new(6, 6, 0.1);
        let [first, second] = [3, 6].map(|edges| request(&cloth, edges, None));
        let recipes = [&first, &second].map(|request| request.recipe.clone());
        let mut builds = AsyncBuilds::default();
        begin_ahead(&mut builds, first);
        let of_first = builds.all[0].is_claimed.clone();
        begin_ahead(&mut builds, second);
        let (count, is_claimed) = (builds.all.len(), of_first.load(Ordering::Relaxed));
        let found = recipes.map(|recipe| builds.take_begun(&recipe).is_some());
        for (let_go, task) in busy {
            drop(let_go);
            block_on(task);
        }
        assert_eq!((count, is_claimed, found), (1, true, [false; 2]));
        assert!(builds.all.is_empty());
    }
}
