//! Data shared by cloths that are made alike.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::recipe::{Recipe, Source};
use crate::{
    cloth::{
        ClothError, ClothMaterial, ClothStiffening, Skinning, SpringKind, Springs,
        StiffnessFactors, Surface,
    },
    contact::Sheet,
    hierarchy::QuadTree,
    plugin::threads::{Threads, join},
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
    /// The first clone, if it was made in the background.
    spare: Mutex<Option<Solver>>,
    /// For contact of cloth with cloth: made when a cloth needs it.
    sheet: OnceLock<Arc<Sheet>>,
    /// The skinning by joints: made when a cloth has joints.
    skinning: OnceLock<Arc<Skinning>>,
}

impl Shared {
    /// Builds springs, solver and tree of a surface, or takes those of `alike` that are the same: they share its recipe and
    /// surface. `before` is of the same cloth with other tears.
    pub fn new(
        threads: Threads,
        recipe: Recipe,
        material: &ClothMaterial,
        surface: Arc<Surface>,
        factors: Arc<StiffnessFactors>,
        alike: &[Arc<Self>],
        before: Option<&Self>,
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
        let springs = || match alike.iter().find(|of| springs_of(of)) {
            Some(known) => (known.springs.clone(), known.solver.clone()),
            None => {
                let springs = Springs::with_factors(&surface, material, &factors);
                let solver = Solver::of_surface(&surface, &springs);
                (springs, solver)
            }
        };
        let bending = || match alike.iter().find(|of| bends_as(of)) {
            Some(known) => known.solver.bending().cloned(),
            None => {
                let is_as_rigid = |of: &&Self| of.stiffnesses.bending == stiffnesses.bending;
                let known = before.filter(is_as_rigid);
                let known = known.and_then(|of| Some((of.solver.bending()?, &*of.surface)));
                Bending::with_factors(&surface, material, factors.clone(), known)
            }
        };
        let (tree, ((springs, mut solver), bending)) =
            join(threads, tree, || (springs(), bending()));
        solver.set_bending(bending);
        // Neither knows of stiffness, but a sheet's patches are those of the tree.
        let of_same_tree = alike.iter().filter(|of| of.has_tree(has_diagonals));
        let sheet = of_same_tree.filter_map(|of| of.sheet.get()).next();
        let skinning = alike.iter().filter_map(|of| of.skinning.get()).next();
        Self {
            recipe: Some(recipe),
            stiffnesses,
            solver,
            spare: Mutex::default(),
            surface,
            springs,
            tree,
            sheet: sheet.cloned().map_or_else(OnceLock::new, OnceLock::from),
            skinning: skinning.cloned().map_or_else(OnceLock::new, OnceLock::from),
        }
    }

    /// A solver for a cloth.
    pub fn new_solver(&self) -> Solver {
        let spare = self
            .spare
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        spare.unwrap_or_else(|| self.solver.clone())
    }

    /// Makes now what the first tick of a cloth needs.
    pub fn make_ready(&mut self, needs_sheet: bool) {
        self.surface.fans();
        self.surface.pieces_of();
        if self.surface.as_grid().is_none() {
            self.surface.face_widths();
        }
        if needs_sheet {
            self.sheet();
        }
        self.spare = Mutex::new(Some(self.solver.clone()));
    }

    /// Whether its tree is that of springs with diagonals, or without: those of a grid change its bounds.
    fn has_tree(&self, has_diagonals: bool) -> bool {
        self.surface.as_grid().is_none() || self.springs.has(SpringKind::Shear) == has_diagonals
    }

    /// The sheet that contact of cloth with cloth searches.
    pub fn sheet(&self) -> &Arc<Sheet> {
        let make = || Arc::new(Sheet::new(&self.surface, &self.tree));
        self.sheet.get_or_init(make)
    }

    /// Whether contact of cloth with cloth has needed its sheet.
    pub fn has_sheet(&self) -> bool {
        self.sheet.get().is_some()
    }

    /// The skinning of its particles by joints, if it has been made.
    pub fn known_skinning(&self) -> Option<&Skinning> {
        self.skinning.get().map(Arc::as_ref)
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
        Ok(Some(self.skinning.get_or_init(|| Arc::new(made))))
    }
}

/// The values of a material that its solver depends on, and the factors of its particles.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Stiffnesses {
    /// Compliances along weft and warp, and of shear (m/N).
    springs: ([f32; 2], f32),
    /// Whether anything differs along weft and warp: a mesh's springs depend on that.
    is_woven: bool,
    stiffening: Option<ClothStiffening>,
    /// Flexural rigidities of strips along weft and warp (N·m).
    bending: [f32; 2],
    /// The factors of each place.
    factors: Arc<StiffnessFactors>,
}

impl Stiffnesses {
    pub fn of(material: &ClothMaterial, factors: &Arc<StiffnessFactors>) -> Self {
        Self {
            springs: (material.stretch_compliances(), material.shear_compliance),
            is_woven: material.is_woven(),
            stiffening: material.stiffening,
            bending: material.bend_rigidities(),
            factors: factors.clone(),
        }
    }

    /// Whether a surface has the same springs with both.
    fn has_springs_of(&self, other: &Self) -> bool {
        let springs = |of: &Self| (of.springs, of.is_woven, of.stiffening);
        springs(self) == springs(other) && self.factors.stretch == other.factors.stretch
    }

    /// Whether a surface resists bending alike with both.
    fn bends_as(&self, other: &Self) -> bool {
        self.bending == other.bending && self.factors.bending == other.factors.bending
    }
}

#[cfg(test)]
pub(super) mod tests {
    use bevy::math::Vec3;

    use super::{
        super::{recipe::KnownShape, shared_parts::SharedParts},
        *,
    };
    use crate::{
        cloth::{
            Cloth, ClothParticles, ClothShape, ClothTears, ClothWeft, MaterialFactors,
            SpringStorage,
        },
        meshes::irregular,
        solver::TickStep,
    };

    type Wanted = (ClothMaterial, Arc<StiffnessFactors>);

    pub fn recipe(shape: &ClothShape, as_mesh: bool) -> Recipe {
        Recipe {
            grain: None,
            tears: ClothTears::default(),
            as_mesh,
            shape: KnownShape(Arc::new(shape.clone())),
            scale: Vec3::ONE,
            source: None,
        }
    }

    fn get(parts: &mut SharedParts, recipe: &Recipe, (material, factors): &Wanted) -> Arc<Shared> {
        let of = |_: &Surface| Ok(with(factors));
        let surface = || recipe.surface(&Default::default());
        let found = parts.get(recipe, material, None, of, surface);
        found.expect("a surface").0
    }

    fn with(stiffness: &Arc<StiffnessFactors>) -> MaterialFactors {
        MaterialFactors {
            stiffness: stiffness.clone(),
            ..MaterialFactors::default()
        }
    }

    /// A material, and changes of each of its parts and of its factors.
    fn changes(particles: usize) -> [Wanted; 12] {
        let material = ClothMaterial {
            stretch_compliance: 1.0e-3,
            bend_rigidity: 1.0e-4,
            ..ClothMaterial::COTTON
        };
        let woven = |stretch_compliance: f32, bend_rigidity: f32| ClothMaterial {
            weft: Some(ClothWeft {
                stretch_compliance,
                bend_rigidity,
            }),
            ..material
        };
        let alone = |material: ClothMaterial| (material, Arc::default());
        let painted = |seed: usize| -> Vec<f32> {
            let of = |index: usize| 1.0 + ((index * seed) % 7) as f32;
            (0..particles).map(of).collect()
        };
        let factors = |stretch: usize, bending: usize| {
            let [stretch, bending] = [stretch, bending].map(painted);
            (material, Arc::new(StiffnessFactors { stretch, bending }))
        };
        [
            alone(material),
            alone(ClothMaterial {
                stretch_compliance: 2.0e-3,
                ..material
            }),
            alone(ClothMaterial {
                shear_compliance: f32::INFINITY,
                ..material
            }),
            alone(ClothMaterial {
                bend_rigidity: 3.0e-4,
                ..material
            }),
            alone(ClothMaterial {
                bend_rigidity: 0.0,
                ..material
            }),
            alone(ClothMaterial {
                stiffening: Some(ClothStiffening {
                    strain: 0.01,
                    factor: 5.0,
                }),
                ..material
            }),
            alone(woven(4.0e-3, 1.0e-4)),
            alone(woven(1.0e-3, 4.0e-4)),
            factors(3, 3),
            factors(5, 3),
            factors(3, 5),
            factors(5, 5),
        ]
    }

    /// Grid, grid as a mesh, and mesh move alike, to the bit, whether their parts are taken from others or made anew.
    #[test]
    fn parts_that_are_taken_are_as_new() {
        let mesh = irregular(0.5, 0.5, 0.1, 0.3);
        let [grid, mesh] = [
            Cloth::new(6, 6, 0.1).shape,
            Cloth::triangles(mesh.positions, mesh.triangles).shape,
        ];
        for recipe in [
            recipe(&grid, false),
            recipe(&grid, true),
            recipe(&mesh, false),
        ] {
            let surface = recipe.surface(&Default::default()).expect("a surface");
            let all = changes(surface.len());
            for wanted in &all {
                let new = moved(
                    &get(&mut SharedParts::default(), &recipe, wanted),
                    &wanted.0,
                );
                for before in &all {
                    let mut parts = SharedParts::default();
                    let _known = get(&mut parts, &recipe, before);
                    let taken = moved(&get(&mut parts, &recipe, wanted), &wanted.0);
                    assert_eq!(taken, new, "{before:?} {wanted:?}");
                }
            }
        }
    }

    /// The same for a cloth that was torn in another way, and of another material, map or structure before.
    #[test]
    fn parts_taken_from_other_tears_are_as_new() {
        let mesh = irregular(0.5, 0.5, 0.1, 0.3);
        let [grid, mesh] = [
            Cloth::new(6, 6, 0.1).shape,
            Cloth::triangles(mesh.positions, mesh.triangles).shape,
        ];
        let torn = |shape: &ClothShape, count: usize| {
            let mut recipe = recipe(shape, false);
            let whole = recipe.surface(&Default::default()).expect("a surface");
            for face in whole.triangles().iter().step_by(9).take(count) {
                recipe.tears.tear_out(&whole, *face);
            }
            recipe
        };
        for (shape, counts) in [&grid, &mesh]
            .into_iter()
            .flat_map(|shape| [[0, 2], [2, 4], [4, 1], [3, 0]].map(|counts| (shape, counts)))
        {
            let [first, then] = counts.map(|count| torn(shape, count));
            let [of_first, of_then] = [&first, &then].map(|recipe| {
                let surface = recipe.surface(&Default::default()).expect("a surface");
                changes(surface.len())
            });
            for wanted in &of_then {
                let new = get(&mut SharedParts::default(), &then, wanted);
                for before in &of_first {
                    let before = get(&mut SharedParts::default(), &first, before);
                    let (of, make) = (
                        |_: &Surface| Ok(with(&wanted.1)),
                        || then.surface(&Default::default()),
                    );
                    let taken =
                        SharedParts::default().get(&then, &wanted.0, Some(&before), of, make);
                    let (taken, _) = taken.expect("a surface");
                    let [taken, new] = [&taken, &new].map(|of| moved(of, &wanted.0));
                    assert_eq!(taken, new, "{counts:?} {wanted:?}");
                }
            }
        }
    }

    /// A change makes only those parts anew that depend on it.
    #[test]
    fn only_what_changes_is_made() {
        let mesh = irregular(0.5, 0.5, 0.1, 0.3);
        let shape = Cloth::triangles(mesh.positions, mesh.triangles).shape;
        let recipe = recipe(&shape, false);
        let surface = recipe.surface(&Default::default()).expect("a surface");
        let all = changes(surface.len());
        let mut parts = SharedParts::default();
        let [material, stretch, bending, mapped, stretched, bent] =
            [0, 1, 3, 8, 9, 10].map(|index| get(&mut parts, &recipe, &all[index]));
        let springs = |of: &Shared| match of.springs.storage() {
            SpringStorage::List(list) => Arc::as_ptr(list),
            SpringStorage::Grid(..) => std::ptr::null(),
        };
        let bends = |of: &Shared| of.solver.bending().expect("it bends").matrix();
        for (a, b) in [(&material, &bending), (&mapped, &bent)] {
            assert_eq!(springs(a), springs(b));
            assert_ne!(bends(a), bends(b));
        }
        for (a, b) in [(&material, &stretch), (&mapped, &stretched)] {
            assert_ne!(springs(a), springs(b));
            assert_eq!(bends(a), bends(b));
        }
    }

    /// The places (m) of a cloth that hangs by its first particle, after eight ticks.
    pub fn moved(shared: &Shared, material: &ClothMaterial) -> Vec<Vec3> {
        let at_rest = ClothParticles::at_rest(&shared.surface, material);
        let mut particles = at_rest.expect("a material");
        particles.pin(0);
        let mut solver = shared.new_solver();
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
