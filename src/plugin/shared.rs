//! What cloths made alike share.

use std::sync::{Arc, OnceLock, Weak};

use bevy::{ecs::resource::Resource, math::Vec3};

use super::source::Source;
use crate::{
    cloth::{ClothError, ClothMaterial, ClothShape, Skinning, SpringKind, Springs, Surface},
    contact::Sheet,
    hierarchy::QuadTree,
    solver::{Bending, Solver},
};

/// A surface with its springs and tree.
#[derive(Debug, Default)]
pub(super) struct Shared {
    pub recipe: Option<Recipe>,
    stiffnesses: [f32; 3],
    pub surface: Arc<Surface>,
    pub springs: Springs,
    pub tree: QuadTree,
    /// One that has moved nothing yet, for each cloth to begin with.
    pub solver: Solver,
    /// For contact of cloth with cloth: made when a cloth asks for it.
    sheet: OnceLock<Arc<Sheet>>,
    /// What moves it with joints: made when a cloth has some.
    skinning: OnceLock<Skinning>,
}

impl Shared {
    /// What contact of cloth with cloth searches.
    pub fn sheet(&self) -> &Arc<Sheet> {
        self.sheet
            .get_or_init(|| Arc::new(Sheet::new(&self.surface, &self.tree)))
    }

    /// What moves its particles with joints, if that has been made.
    pub fn known_skinning(&self) -> Option<&Skinning> {
        self.skinning.get()
    }

    /// What moves its particles with joints; `None` of what is made from no asset.
    ///
    /// # Errors
    /// What `make` finds wrong with the asset.
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

/// What a surface is made from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Recipe {
    pub shape: ClothShape,
    pub scale: Vec3,
    /// The mesh, of one that is made from an asset.
    pub source: Option<Source>,
}

/// All that is in use.
#[derive(Resource, Debug, Default)]
pub(super) struct SharedParts {
    known: Vec<Weak<Shared>>,
}

impl SharedParts {
    /// What a cloth of this recipe and material has in common with others: theirs, if there are any.
    ///
    /// # Errors
    /// What `make` finds wrong with the surface.
    pub fn get(
        &mut self,
        recipe: &Recipe,
        material: &ClothMaterial,
        make: impl FnOnce() -> Result<Surface, ClothError>,
    ) -> Result<Arc<Shared>, ClothError> {
        let stiffnesses = stiffnesses(material);
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
        let springs = Springs::of_surface(&surface, material);
        let diagonals = springs.has(SpringKind::Shear);
        // A tree does not know of stiffness.
        let known = alike.filter(|known| known.springs.has(SpringKind::Shear) == diagonals);
        let tree = match known {
            Some(known) => known.tree.clone(),
            None => QuadTree::of_surface(&surface, diagonals),
        };
        let mut solver = Solver::of_surface(&surface, &springs);
        solver.set_bending(Bending::new(&surface, material));
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

    /// The same of a cloth whose material has become another.
    pub fn with_material(&mut self, shared: &Arc<Shared>, material: &ClothMaterial) -> Arc<Shared> {
        let Some(recipe) = &shared.recipe else {
            return shared.clone();
        };
        // A surface of that recipe is there: it has nothing to be refused for.
        let other = self.get(recipe, material, || Ok((*shared.surface).clone()));
        other.unwrap_or_else(|_| shared.clone())
    }
}

/// What a material's solver is made for: compliances of stretch and shear (m/N), rigidity of bending (N·m).
pub(super) fn stiffnesses(material: &ClothMaterial) -> [f32; 3] {
    [
        material.stretch_compliance,
        material.shear_compliance,
        material.bend_rigidity,
    ]
}
