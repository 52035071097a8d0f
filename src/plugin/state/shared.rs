//! Data shared by cloths that are made alike.

use std::sync::{Arc, OnceLock};

use super::{recipe::Recipe, source::Source};
use crate::{
    cloth::{
        ClothError, ClothMaterial, ClothStiffening, ClothWeft, Skinning, SpringKind, Springs,
        StiffnessFactors, Surface,
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
    pub stiffnesses: Stiffnesses,
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
    /// Builds the springs and the solver of a surface, and takes its tree: at the same time, where there are threads for it.
    pub fn new(
        recipe: Recipe,
        material: &ClothMaterial,
        surface: Arc<Surface>,
        factors: Arc<StiffnessFactors>,
        tree: impl FnOnce() -> QuadTree + Send,
    ) -> Self {
        let stiffnesses = Stiffnesses::of(material, &factors);
        let (tree, (springs, solver)) = join(tree, || {
            let springs = Springs::with_factors(&surface, material, &factors);
            let mut solver = Solver::of_surface(&surface, &springs);
            solver.set_bending(Bending::with_factors(&surface, material, factors));
            (springs, solver)
        });
        Self {
            recipe: Some(recipe),
            stiffnesses,
            solver,
            surface,
            springs,
            tree,
            sheet: OnceLock::new(),
            skinning: OnceLock::new(),
        }
    }

    /// Whether its tree is that of springs with diagonals, or without: those of a grid change its bounds.
    pub fn has_tree(&self, has_diagonals: bool) -> bool {
        self.surface.as_grid().is_none() || self.springs.has(SpringKind::Shear) == has_diagonals
    }

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

/// The values of a material that its solver depends on: compliances of stretch and shear (m/N), flexural rigidity
/// (N·m), those of the weft, how it stiffens, and the factors of its particles.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Stiffnesses {
    everywhere: Stiffness,
    factors: Arc<StiffnessFactors>,
}

type Stiffness = ([f32; 3], Option<ClothWeft>, Option<ClothStiffening>);

impl Stiffnesses {
    pub fn of(material: &ClothMaterial, factors: &Arc<StiffnessFactors>) -> Self {
        Self {
            everywhere: everywhere(material),
            factors: factors.clone(),
        }
    }

    /// Whether a solver is the same for both materials.
    pub fn are_alike(a: &ClothMaterial, b: &ClothMaterial) -> bool {
        everywhere(a) == everywhere(b)
    }
}

fn everywhere(material: &ClothMaterial) -> Stiffness {
    let warp = [
        material.stretch_compliance,
        material.shear_compliance,
        material.bend_rigidity,
    ];
    (warp, material.weft, material.stiffening)
}
