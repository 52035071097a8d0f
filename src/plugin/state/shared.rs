//! Data shared by cloths that are made alike.

use std::sync::{Arc, OnceLock};

use super::{recipe::Recipe, source::Source};
use crate::{
    cloth::{
        ClothError, ClothMaterial, ClothStiffening, Skinning, SpringKind, Springs,
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
    /// Builds springs, solver and tree of a surface, or takes those of `alike` that are the same: cloths with the same recipe.
    pub fn new(
        recipe: Recipe,
        material: &ClothMaterial,
        surface: Arc<Surface>,
        factors: Arc<StiffnessFactors>,
        alike: &[Arc<Self>],
    ) -> Self {
        let stiffnesses = Stiffnesses::of(material, &factors);
        // A tree does not know of stiffness.
        let has_diagonals = material.shear_compliance.is_finite();
        let tree = || match alike.iter().find(|of| of.has_tree(has_diagonals)) {
            Some(known) => known.tree.clone(),
            None => QuadTree::of_surface(&surface, has_diagonals),
        };
        let springs_of = |known: &Self| known.stiffnesses.has_springs_of(&stiffnesses);
        let bends_as = |known: &Self| known.stiffnesses.bends_as(&stiffnesses);
        let (tree, (springs, solver)) = join(tree, || {
            let (springs, mut solver) = match alike.iter().find(|of| springs_of(of)) {
                Some(known) => (known.springs.clone(), known.solver.clone()),
                None => {
                    let springs = Springs::with_factors(&surface, material, &factors);
                    let solver = Solver::of_surface(&surface, &springs);
                    (springs, solver)
                }
            };
            solver.set_bending(match alike.iter().find(|of| bends_as(of)) {
                Some(known) => known.solver.bending().cloned(),
                None => Bending::with_factors(&surface, material, factors.clone()),
            });
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
    fn has_tree(&self, has_diagonals: bool) -> bool {
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

/// The values of a material that its solver depends on, and the factors of its particles.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Stiffnesses {
    everywhere: Stiffness,
    factors: Arc<StiffnessFactors>,
}

#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Stiffness {
    /// Compliances along weft and warp, and of shear (m/N).
    springs: ([f32; 2], f32),
    stiffening: Option<ClothStiffening>,
    /// Flexural rigidities of strips along weft and warp (N·m).
    bending: [f32; 2],
}

impl Stiffnesses {
    pub fn of(material: &ClothMaterial, factors: &Arc<StiffnessFactors>) -> Self {
        Self {
            everywhere: Stiffness::of(material),
            factors: factors.clone(),
        }
    }

    /// Whether a solver is the same for both materials.
    pub fn are_alike(a: &ClothMaterial, b: &ClothMaterial) -> bool {
        Stiffness::of(a) == Stiffness::of(b)
    }

    /// Whether springs of one surface are the same.
    fn has_springs_of(&self, other: &Self) -> bool {
        let springs = |of: &Stiffness| (of.springs, of.stiffening);
        springs(&self.everywhere) == springs(&other.everywhere)
            && self.factors.stretch == other.factors.stretch
    }

    /// Whether one surface resists bending alike.
    fn bends_as(&self, other: &Self) -> bool {
        self.everywhere.bending == other.everywhere.bending
            && self.factors.bending == other.factors.bending
    }
}

impl Stiffness {
    fn of(material: &ClothMaterial) -> Self {
        Self {
            springs: (material.stretch_compliances(), material.shear_compliance),
            stiffening: material.stiffening,
            bending: material.bend_rigidities(),
        }
    }
}

#[cfg(test)]
mod tests {
    use bevy::math::Vec3;

    use super::{super::shared_parts::SharedParts, *};
    use crate::{
        cloth::{Cloth, ClothParticles, ClothTears, ClothWeft},
        meshes::irregular,
        solver::TickStep,
    };

    /// Takes what stays the same: what a cloth gets after a change moves it, to the bit, as what is built anew. Grid and mesh,
    /// each change of a material or of its factors, from each to each.
    #[test]
    fn parts_that_are_taken_are_as_new() {
        let mesh = irregular(0.5, 0.5, 0.1, 0.3);
        for cloth in [
            Cloth::new(6, 6, 0.1),
            Cloth::triangles(mesh.positions, mesh.triangles),
        ] {
            let recipe = Recipe {
                grain: None,
                tears: ClothTears::default(),
                as_mesh: false,
                shape: cloth.shape.clone(),
                scale: Vec3::ONE,
                source: None,
            };
            let surface = || cloth.surface(Vec3::ONE);
            let len = surface().expect("a surface").len();
            let painted = |seed: usize| {
                let of = |index: usize| 1.0 + ((index * seed) % 7) as f32;
                (0..len).map(of).collect::<Vec<f32>>()
            };
            let of = |stretch: f32, bend: f32, weft: f32| ClothMaterial {
                stretch_compliance: stretch,
                bend_rigidity: bend,
                weft: Some(ClothWeft {
                    stretch_compliance: weft,
                    bend_rigidity: bend,
                }),
                ..ClothMaterial::COTTON
            };
            let factors = |stretch: usize, bending: usize| {
                Arc::new(StiffnessFactors {
                    stretch: painted(stretch),
                    bending: painted(bending),
                })
            };
            let soft = of(1.0e-3, 1.0e-4, 1.0e-3);
            let all = [
                (soft, Arc::default()),
                (of(2.0e-3, 1.0e-4, 1.0e-3), Arc::default()),
                (of(1.0e-3, 3.0e-4, 1.0e-3), Arc::default()),
                (of(1.0e-3, 1.0e-4, 4.0e-3), Arc::default()),
                (soft, factors(3, 3)),
                (soft, factors(5, 3)),
                (soft, factors(3, 5)),
            ];
            let get = |parts: &mut SharedParts, (material, factors): &(ClothMaterial, Arc<_>)| {
                let of = |_: &Surface| Ok(Arc::clone(factors));
                let found = parts.get(&recipe, material, of, surface);
                found.expect("a surface")
            };
            for (index, wanted) in all.iter().enumerate() {
                let new = moved(&get(&mut SharedParts::default(), wanted), &wanted.0);
                for before in &all {
                    let mut parts = SharedParts::default();
                    let _known = get(&mut parts, before);
                    let taken = moved(&get(&mut parts, wanted), &wanted.0);
                    assert_eq!(taken, new, "{index}");
                }
            }
        }
    }

    /// The places (m) of a cloth that hangs by its first particle, after eight ticks.
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
}
