//! Data shared by cloths that are made alike.

use std::sync::{Arc, OnceLock, Weak};

use bevy::{ecs::resource::Resource, math::Vec3};

use super::source::Source;
use crate::{
    cloth::{
        ClothError, ClothGrain, ClothMaterial, ClothShape, ClothTears, ClothWeft, Skinning,
        SpringKind, Springs, Surface, TriangleMesh,
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
        match self.tears.edges() {
            [] => Ok(surface),
            edges => Arc::new(surface).torn(edges),
        }
    }
}

/// All shared data in use.
#[derive(Resource, Debug, Default)]
pub(crate) struct SharedParts {
    known: Vec<Weak<Shared>>,
}

impl SharedParts {
    /// The shared data of cloths with this recipe and material: made by `make` if there is none yet.
    ///
    /// # Errors
    /// The error that `make` finds in the surface.
    pub fn get(
        &mut self,
        recipe: &Recipe,
        material: &ClothMaterial,
        make: impl FnOnce() -> Result<Surface, ClothError>,
    ) -> Result<Arc<Shared>, ClothError> {
        let stiffnesses = Stiffnesses::of(material);
        let mut alike = None;
        for known in self.known.iter().filter_map(Weak::upgrade) {
            if known.recipe.as_ref() == Some(recipe) {
                if known.stiffnesses == stiffnesses {
                    return Ok(known);
                }
                alike = Some(known);
            }
        }
        let surface = match &alike {
            Some(known) => known.surface.clone(),
            None => Arc::new(make()?),
        };
        // A tree does not know of stiffness.
        let has_diagonals = material.shear_compliance.is_finite();
        let known = alike.filter(|known| {
            surface.as_grid().is_none() || known.springs.has(SpringKind::Shear) == has_diagonals
        });
        let tree = || match &known {
            Some(known) => known.tree.clone(),
            None => QuadTree::of_surface(&surface, has_diagonals),
        };
        let (tree, (springs, solver)) = join(tree, || {
            let springs = Springs::of_surface(&surface, material);
            let mut solver = Solver::of_surface(&surface, &springs);
            solver.set_bending(Bending::new(&surface, material));
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

    /// The same for a cloth whose material has changed.
    pub fn with_material(&mut self, shared: &Arc<Shared>, material: &ClothMaterial) -> Arc<Shared> {
        let Some(recipe) = &shared.recipe else {
            return shared.clone();
        };
        // A surface of that recipe exists, so it can't be refused.
        let other = self.get(recipe, material, || Ok((*shared.surface).clone()));
        other.unwrap_or_else(|_| shared.clone())
    }
}

/// The values of a material that its solver depends on: compliances of stretch and shear (m/N), flexural rigidity
/// (N·m), and those of the weft.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct Stiffnesses {
    warp: [f32; 3],
    weft: Option<ClothWeft>,
}

impl Stiffnesses {
    pub fn of(material: &ClothMaterial) -> Self {
        Self {
            warp: [
                material.stretch_compliance,
                material.shear_compliance,
                material.bend_rigidity,
            ],
            weft: material.weft,
        }
    }
}
