//! Everything that is built from a cloth's components.

use std::sync::Arc;

use bevy::{
    ecs::change_detection::Tick,
    prelude::{Component, Reflect, ReflectDefault, Vec3},
};

use super::{notices::Noticed, pose::SkinLimits, recipe::Source, shared::Shared};
use crate::{
    cloth::{
        ClothError, ClothGrain, ClothMaterial, ClothParticles, ClothTears, MaterialFactors, Pins,
        Springs, Surface,
    },
    hierarchy::QuadTree,
    solver::{FreePieces, Solver, Tethers, material_stretch},
};

/// A cloth's surface, springs, tree of bounding volumes and solver. The plugin builds them from the cloth's other
/// components, and again when those change. Empty until the first tick. Scenes and clones don't have it.
#[derive(Component, Reflect, Debug, Default)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug)]
#[component(clone_behavior = Ignore)]
pub struct ClothBuilt {
    /// Shared by all cloths that are made alike.
    #[reflect(ignore)]
    pub(crate) shared: Arc<Shared>,
    /// The inputs from which all this was built.
    #[reflect(ignore)]
    pub(crate) from: Option<BuiltFrom>,
    /// The inputs from which nothing could be built, and why.
    #[reflect(ignore)]
    pub(crate) refused: Option<(FailedBuild, ClothError)>,
    /// What has been logged of it.
    #[reflect(ignore)]
    pub(crate) noticed: Noticed,
    #[reflect(ignore)]
    pub(crate) solver: Solver,
    /// The acceleration (m/s²) that tethers are for, and the factor of the material's weight; 0 without tethers; `None` if they have to
    /// be made again.
    #[reflect(ignore)]
    tethered: Option<[f32; 2]>,
    /// The stretch of the material itself, under the gravity of the tick and under the largest gravity so far.
    #[reflect(ignore)]
    pub(crate) material_stretch: f32,
    #[reflect(ignore)]
    pub(crate) largest_material_stretch: f32,
    /// Masses of its lightest and heaviest free particle (kg).
    #[reflect(ignore)]
    pub(crate) masses: [f32; 2],
    /// How far its particles may be from the pose that it follows, if it follows one.
    #[reflect(ignore)]
    pub(crate) skin: Option<Box<SkinLimits>>,
    /// The particles that are pinned, in their order, and a number that is new whenever others are.
    #[reflect(ignore)]
    pub(crate) pinned: Vec<u32>,
    #[reflect(ignore)]
    pub(crate) pins_version: u32,
    /// The two particles between which the last tear is, and how many edges it tore, until that is reported.
    #[reflect(ignore)]
    pub(crate) unreported_tear: Option<([u32; 2], usize)>,
}

/// When the components of a cloth were last changed, those that it has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Changes {
    pub cloth: Tick,
    pub grain: Option<Tick>,
    pub map: Option<Tick>,
    pub tears: Option<Tick>,
}

/// The inputs of a cloth, besides the recipe of its surface.
#[derive(Debug, Clone)]
pub(crate) struct BuiltFrom {
    pub unevenness: f32,
    pub changes: Changes,
    pub material: ClothMaterial,
    /// The factors of its `ClothMaterialMap`.
    pub factors: MaterialFactors,
    pub pins: Pins,
}

/// The inputs of a cloth that could not be built, besides the recipe of its surface.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FailedBuild {
    pub changes: Changes,
    pub source: Option<Source>,
    pub material: ClothMaterial,
    pub pins: Pins,
    pub scale: Vec3,
    /// Its columns and rows.
    pub particles: [u32; 2],
}

/// The tears of a cloth that has none.
pub(crate) static NO_TEARS: ClothTears = ClothTears::none();

impl ClothBuilt {
    /// The surface, scaled.
    pub fn surface(&self) -> &Arc<Surface> {
        &self.shared.surface
    }

    /// The springs, grouped by colour.
    pub fn springs(&self) -> &Springs {
        &self.shared.springs
    }

    /// The quad-tree of bounding volumes.
    pub fn tree(&self) -> &QuadTree {
        &self.shared.tree
    }

    /// Whether all this is of `particles`: not before the first tick, nor once a game has emptied the particles, until the
    /// next.
    pub(crate) fn matches(&self, particles: &ClothParticles) -> bool {
        !particles.is_empty() && particles.matches(self.surface())
    }

    /// The mesh that it was made from, if it was.
    pub(crate) fn source(&self) -> Option<Source> {
        self.shared.recipe.as_ref().and_then(|recipe| recipe.source)
    }

    /// Whether it was made with this grain, which was last changed then. Values are compared only where the game wrote them.
    pub(crate) fn has_grain(&self, wanted: Option<&ClothGrain>, changed: Option<Tick>) -> bool {
        let recipe = self.shared.recipe.as_ref();
        let known = recipe.and_then(|recipe| recipe.grain.as_ref());
        let grained = self.from.as_ref().and_then(|from| from.changes.grain);
        let is_unchanged = changed.is_some() && changed == grained;
        (is_unchanged && known.is_some() && wanted.is_some()) || known == wanted
    }

    /// Whether it is torn by these tears, which were last changed then. Values are compared only where they were written.
    pub(crate) fn is_torn_by(&self, wanted: &ClothTears, changed: Option<Tick>) -> bool {
        let known = self.from.as_ref().and_then(|from| from.changes.tears);
        known == changed || wanted.edges() == self.tears().edges()
    }

    /// The tears of its surface.
    pub(crate) fn tears(&self) -> &ClothTears {
        (self.shared.recipe.as_ref()).map_or(&NO_TEARS, |recipe| &recipe.tears)
    }

    /// Whether it is a grid that has the surface of a mesh, though nothing is torn.
    pub(crate) fn is_as_mesh(&self) -> bool {
        (self.shared.recipe.as_ref()).is_some_and(|recipe| recipe.as_mesh)
    }

    /// Whether it was made from components that were changed then, and from this material and these pins.
    pub(crate) fn is_made_from(
        &self,
        changes: &Changes,
        material: &ClothMaterial,
        pins: &Pins,
    ) -> bool {
        self.from.as_ref().is_some_and(|from| {
            from.changes == *changes && from.material == *material && from.pins == *pins
        })
    }

    /// The largest density of a mesh over its mean; 0 if it is as dense everywhere. The chains of a grid need no more sub-steps for that.
    pub(crate) fn density_ratio(&self) -> f32 {
        let factors = self.from.as_ref().map(|from| &from.factors.density);
        let differs = factors.filter(|of| of.most > of.least);
        let is_mesh = self.surface().rest_grid().is_none();
        differs
            .filter(|_| is_mesh)
            .map_or(0.0, |of| of.most / of.mean)
    }

    /// Gives particles the masses that material and pins give them.
    pub(crate) fn give_masses(
        &self,
        of: impl Iterator<Item = usize> + Clone,
        particles: &mut ClothParticles,
    ) {
        let Some(from) = &self.from else {
            return;
        };
        for index in of.clone() {
            particles.assign_mass(index, self.surface(), &from.material, &from.factors.density);
        }
        let given: std::collections::HashSet<usize> = of.collect();
        if !given.is_empty() {
            from.pins.for_each(self.surface(), |index| {
                if given.contains(&index) {
                    particles.pin(index);
                }
            });
        }
    }

    /// Gives pinned particles the masses that the material gives them.
    pub(crate) fn release_pins(&self, particles: &mut ClothParticles) {
        let Some(from) = self.from.as_ref().filter(|_| self.matches(particles)) else {
            return;
        };
        for index in 0..particles.len() {
            if particles.inverse_mass(index) == Some(0.0) {
                particles.assign_mass(index, self.surface(), &from.material, &from.factors.density);
            }
        }
    }

    /// Takes over masses and pins of particles that the game wrote.
    pub(crate) fn refresh_masses(&mut self, particles: &ClothParticles) {
        if self.tethered.is_none() {
            // `tether` takes them over, later in the tick.
            return;
        }
        self.masses = particles.free_masses();
        if !pinned(particles).eq(self.pinned.iter().copied()) {
            self.forget_tethers();
        }
    }

    /// Has tethers be made again: other particles are pinned, or the material gives in another way.
    pub(crate) fn forget_tethers(&mut self) {
        self.tethered = None;
    }

    /// Makes tethers again if what they were made for has changed: the pins, the material, or that gravity
    /// (m/s²) is larger than ever before; and what follows from the same. Returns whether it did.
    pub(crate) fn tether(
        &mut self,
        wanted: bool,
        material: &ClothMaterial,
        particles: &ClothParticles,
        gravity: f32,
        largest_gravity: &mut f32,
    ) -> bool {
        if self.tethered.is_none() {
            self.pinned.clear();
            self.pinned.extend(pinned(particles));
            self.masses = particles.free_masses();
            self.pins_version = self.pins_version.wrapping_add(1);
        }
        let factors = self.from.as_ref().map(|from| &from.factors);
        let mean = factors.map_or(1.0, |of| of.density.mean);
        // In steps, so that a weight that changes in every tick does not make tethers in every tick.
        let mut weight = 1.0;
        while weight < mean {
            weight *= 2.0;
        }
        let material = &ClothMaterial {
            areal_density: material.areal_density * weight,
            ..material.softer(factors.map_or(1.0, |of| of.stiffness.softest()))
        };
        let surface = &self.shared.surface;
        let gives = |gravity: f32| material_stretch(surface, material, self.pinned.len(), gravity);
        // Gravity that comes and goes finds all as it was; what it stretched before is no fault after.
        *largest_gravity = largest_gravity.max(Tethers::made_for(gravity));
        self.material_stretch = gives(gravity);
        self.largest_material_stretch = gives(largest_gravity.max(gravity));
        let needs = [*largest_gravity, weight];
        let made_for = Some(if wanted { needs } else { [0.0; 2] });
        if self.tethered == made_for {
            return false;
        }
        self.tethered = made_for;
        let tethers = || Tethers::new(surface, material, particles, *largest_gravity);
        let tethers = wanted.then(tethers).unwrap_or_default();
        self.solver.set_tethers(tethers);
        let free_pieces = FreePieces::new(surface, particles);
        self.solver.set_free_pieces(free_pieces);
        true
    }
}

/// The particles that are pinned, in their order.
fn pinned(particles: &ClothParticles) -> impl Iterator<Item = u32> + '_ {
    let masses = particles.inverse_masses().enumerate();
    let pinned = masses.filter(|(_, inverse_mass)| *inverse_mass == 0.0);
    pinned.map(|(index, _)| index as u32)
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            recipe::{KnownShape, Recipe},
            shared_parts::SharedParts,
        },
        *,
    };
    use crate::cloth::{Cloth, ClothFactor, ClothMaterialMap, ClothTears};

    fn shared(cloth: &Cloth, material: &ClothMaterial) -> Arc<Shared> {
        let recipe = Recipe {
            grain: None,
            tears: ClothTears::default(),
            as_mesh: false,
            shape: KnownShape(Arc::new(cloth.shape.clone())),
            scale: Vec3::ONE,
            source: None,
        };
        let surface = || cloth.surface(Vec3::ONE);
        let no_factors = |_: &Surface| Ok(MaterialFactors::default());
        let mut parts = SharedParts::default();
        let found = parts.get(&recipe, material, None, no_factors, surface);
        found.expect("a surface").0
    }

    /// Limits know the mean of a density, in steps of two, and the softest place.
    #[test]
    fn limits_know_the_map_of_the_material() {
        let cloth = Cloth::new(8, 8, 0.1);
        let surface = cloth.surface(Vec3::ONE).expect("a grid");
        let material = ClothMaterial::COTTON;
        let particles = ClothParticles::at_rest(&surface, &material).expect("a material");
        let stretch = |map: ClothMaterialMap| {
            let factors = map.factors(&surface).expect("factors");
            let mut built = ClothBuilt {
                shared: shared(&cloth, &material),
                from: Some(BuiltFrom {
                    unevenness: 0.0,
                    changes: Changes {
                        cloth: Tick::new(0),
                        grain: None,
                        map: None,
                        tears: None,
                    },
                    material,
                    factors,
                    pins: Pins::none(),
                }),
                ..Default::default()
            };
            let gravity = 9.81;
            built.tether(false, &material, &particles, gravity, &mut 0.0);
            built.material_stretch
        };
        let alone = stretch(ClothMaterialMap::default());
        for (density, softest, expected) in [(1.0, 1.0, 1.0), (10.0, 1.0, 16.0), (0.5, 0.25, 4.0)] {
            let found = stretch(ClothMaterialMap {
                density: ClothFactor::of(density),
                stretch: ClothFactor::of(softest),
                ..Default::default()
            });
            // A quotient and a product of four numbers, each rounded.
            assert!(
                (found / alone - expected).abs() < 1.0e-5 * expected,
                "{found} {alone}"
            );
        }
    }

    /// Gravity swings between nothing and 60 m/s² for 200 ticks: tethers are made as it first grows, for 9.81 and each
    /// doubling of it up to four fifths of 60, and never again.
    #[test]
    fn gravity_that_comes_and_goes_makes_no_tethers_again() {
        let cloth = Cloth::new(8, 8, 0.1);
        let surface = cloth.surface(Vec3::ONE).expect("a valid grid");
        let material = ClothMaterial::COTTON;
        let mut particles = ClothParticles::at_rest(&surface, &material).expect("a material");
        particles.pin(0);
        let mut built = ClothBuilt {
            shared: shared(&cloth, &material),
            ..Default::default()
        };
        let mut largest = 0.0;
        let mut made = |tick: u32, wanted: bool, largest: &mut f32| {
            let gravity = 30.0 * (1.0 - (0.3 * tick as f32).cos());
            built.tether(wanted, &material, &particles, gravity, largest)
        };
        let count = |ticks: std::ops::Range<u32>| {
            ticks.filter(|&tick| made(tick, true, &mut largest)).count()
        };
        assert_eq!([0..200, 200..400].map(count), [4, 0]);
        assert_eq!(largest, 8.0 * 9.81);
        // And none are made where none are wanted, whatever pulls.
        let mut largest = 0.0;
        assert!(made(400, false, &mut largest));
        assert!(!(401..600).any(|tick| made(tick, false, &mut largest)));
    }
}
