//! Data shared by cloths that are made alike.

use std::sync::{Arc, OnceLock, Weak};

use bevy::{ecs::resource::Resource, math::Vec3};

use super::source::Source;
use crate::{
    cloth::{
        ClothError, ClothGrain, ClothMaterial, ClothShape, ClothStiffening, ClothTears, ClothWeft,
        Skinning, SpringKind, Springs, StiffnessFactors, Surface, TriangleMesh,
    },
    contact::Sheet,
    hierarchy::QuadTree,
    plugin::threads::join,
    solver::{Bending, Solver},
};

/// A surface with its springs and tree.
#[derive(Debug, Default)]
pub(crate) struct Shared {
    pub recipe: Option<Recipe>,
    stiffnesses: Stiffnesses,
    pub surface: Arc<Surface>,
    pub springs: Springs,
    pub tree: QuadTree,
    /// An unused solver, of which each cloth gets a clone.
    pub solver: Solver,
    /// For contact of cloth with cloth: made when a cloth needs it.
    sheet: OnceLock<Arc<Sheet>>,
    /// The skinning by joints: made when a cloth has joints.
    skinning: OnceLock<Skinning>,
}

impl Shared {
    /// The sheet that contact of cloth with cloth searches.
    pub fn sheet(&self) -> &Arc<Sheet> {
        self.sheet
            .get_or_init(|| Arc::new(Sheet::new(&self.surface, &self.tree)))
    }

    /// The skinning of its particles by joints, if it has been made.
    pub fn known_skinning(&self) -> Option<&Skinning> {
        self.skinning.get()
    }

    /// The skinning of its particles by joints; `None` if it is not made from an asset.
    ///
    /// # Errors
    /// The error that `make` finds in the asset.
    pub fn skinning(
        &self,
        make: impl FnOnce(Source, &Surface) -> Result<Skinning, ClothError>,
    ) -> Result<Option<&Skinning>, ClothError> {
        let Some(source) = self.recipe.as_ref().and_then(|recipe| recipe.source) else {
            return Ok(None);
        };
        if let Some(known) = self.known_skinning() {
            return Ok(Some(known));
        }
        let made = make(source, &self.surface)?;
        Ok(Some(self.skinning.get_or_init(|| made)))
    }
}

/// The inputs of a surface.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Recipe {
    pub shape: ClothShape,
    pub scale: Vec3,
    /// The mesh, if it is made from an asset.
    pub source: Option<Source>,
    /// The grain of a mesh with a weft.
    pub grain: Option<ClothGrain>,
    pub tears: ClothTears,
    /// Whether a grid without tears is solved as a mesh.
    pub as_mesh: bool,
}

impl Recipe {
    /// The surface of a shape that needs no asset.
    ///
    /// # Errors
    /// Those of [`ClothShape::surface`] and of its grain.
    pub fn surface_without_asset(&self) -> Result<Surface, ClothError> {
        self.finished(self.shape.surface(self.scale)?, &TriangleMesh::default())
    }

    /// A surface made from `mesh`, with its grain and its tears.
    ///
    /// # Errors
    /// Those of [`ClothGrain::apply`] and of [`Surface::torn`].
    pub fn finished(&self, surface: Surface, mesh: &TriangleMesh) -> Result<Surface, ClothError> {
        let surface = match &self.grain {
            Some(grain) => grain.apply(surface, mesh)?,
            None => surface,
        };
        if self.tears.edges().is_empty() && !self.as_mesh {
            return Ok(surface);
        }
        self.opened(Arc::new(surface))
    }

    /// The whole surface, with its tears, or as a mesh.
    ///
    /// # Errors
    /// Those of [`Surface::torn`].
    pub fn opened(&self, whole: Arc<Surface>) -> Result<Surface, ClothError> {
        match self.tears.edges() {
            [] if !self.as_mesh => Ok((*whole).clone()),
            edges => whole.torn(edges),
        }
    }
}

/// All shared data in use.
#[derive(Resource, Debug, Default)]
pub(crate) struct SharedParts {
    known: Vec<Weak<Shared>>,
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
        let (tree, (springs, solver)) = join(tree, || {
            let springs = Springs::with_factors(&surface, material, &factors);
            let mut solver = Solver::of_surface(&surface, &springs);
            solver.set_bending(Bending::with_factors(&surface, material, factors));
            (springs, solver)
        });
        let shared = Arc::new(Shared {
            recipe: Some(recipe.clone()),
            stiffnesses,
            solver,
            surface,
            springs,
            tree,
            sheet: OnceLock::new(),
            skinning: OnceLock::new(),
        });
        self.known.retain(|known| known.strong_count() > 0);
        self.known.push(Arc::downgrade(&shared));
        Ok(shared)
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

/// The values of a material that its solver depends on: compliances of stretch and shear (m/N), flexural rigidity
/// (N·m), those of the weft, how it stiffens, and the factors of its particles.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Stiffnesses {
    warp: [f32; 3],
    weft: Option<ClothWeft>,
    stiffening: Option<ClothStiffening>,
    factors: Arc<StiffnessFactors>,
}

impl Stiffnesses {
    fn of(material: &ClothMaterial, factors: &Arc<StiffnessFactors>) -> Self {
        Self {
            warp: [
                material.stretch_compliance,
                material.shear_compliance,
                material.bend_rigidity,
            ],
            weft: material.weft,
            stiffening: material.stiffening,
            factors: factors.clone(),
        }
    }

    /// Whether a solver is the same for both materials.
    pub fn are_alike(a: &ClothMaterial, b: &ClothMaterial) -> bool {
        let [a, b] = [a, b].map(|material| Self::of(material, &Arc::default()));
        a == b
    }
}
