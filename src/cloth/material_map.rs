//! The material of a cloth, particle by particle.

use std::sync::Arc;

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{
    LANES, Lanes,
    material::ClothMaterial,
    particles::DensityFactors,
    quantity::Allowed,
    skin::{ClothPaint, PaintError},
    springs::StiffnessFactors,
    surface::Surface,
};

/// Scales a cloth's material, particle by particle: a stiff seam, an elastic waist, a hem that is wet and heavy. Without
/// this component, the material is the same everywhere.
///
/// All of it may change in every tick. A change of the density changes masses alone, and velocities stay. It also replaces
/// masses that the game set individually. A change of stretch or bending builds the springs anew, which takes
/// milliseconds for thousands of particles.
///
/// A tick of a grid with a map of stretch or bending takes up to 1.2 times as long. Such a grid has the surface of a mesh, and the change
/// to that and back loses [creases](crate::solver::ClothCreasing). A [rope](crate::cloth::Cloth::rope) has no map of stretch or bending.
///
/// ```
/// use bevy_drape::prelude::*;
///
/// let map = ClothMaterialMap {
///     // Wet below 0.4 m at rest: it weighs twice as much there.
///     density: ClothFactor::added(ClothPaint::at_rest(|place| if place.y < 0.4 { 1.0 } else { 0.0 })),
///     // Full red is eleven times as stiff; without red it is as stiff as the material.
///     bending: ClothFactor::added(ClothPaint::color(0, 10.0)),
///     // A waist of a tenth of the stiffness.
///     stretch: ClothFactor::of(ClothPaint::at_rest(|place| if place.y > 1.0 { 0.1 } else { 1.0 })),
///     ..ClothMaterialMap::default()
/// };
/// # let _ = map;
/// ```
#[derive(Component, Reflect, Debug, Default, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothMaterialMap {
    /// Scales the areal density. Positive and finite.
    pub density: ClothFactor,
    /// Scales the stiffness against stretch and shear. Positive and finite. A rigid material stays rigid. A spring between two
    /// particles is as stiff as two halves of their materials, one after the other.
    pub stretch: ClothFactor,
    /// Scales the flexural rigidity. Zero or more, and finite. A face has the mean of its corners.
    pub bending: ClothFactor,
    /// Scales the friction μ against colliders. Zero or more, and finite. A triangle that lies on a sharp edge has the factor of its first
    /// particle. Cloth on cloth has the friction of [`ClothSelfCollision`](crate::contact::ClothSelfCollision) alone.
    pub friction: ClothFactor,
    /// Scales the thickness of [`ClothSelfCollision`](crate::contact::ClothSelfCollision), from 0.1 to 1: the settings have that of the
    /// thickest part. A face and an edge have the mean of their corners. A change of it searches for all layers anew. Where layers touch
    /// fast, the thinnest particle decides the number of sub-steps.
    pub thickness: ClothFactor,
}

/// A factor for each particle: a base, plus what is painted.
#[derive(Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ClothFactor {
    /// The factor where nothing is painted. Zero or more.
    pub base: f32,
    /// Added to it, particle by particle. Zero or more.
    pub paint: ClothPaint,
}

impl Default for ClothFactor {
    /// 1 everywhere.
    fn default() -> Self {
        Self::added(0.0)
    }
}

impl ClothFactor {
    /// 1 plus the paint: 0 changes nothing, 1 doubles.
    pub fn added(paint: impl Into<ClothPaint>) -> Self {
        Self {
            base: 1.0,
            paint: paint.into(),
        }
    }

    /// The paint itself: 1 changes nothing, 0.5 halves.
    pub fn of(paint: impl Into<ClothPaint>) -> Self {
        Self {
            base: 0.0,
            paint: paint.into(),
        }
    }

    /// Whether it is 1 everywhere.
    fn is_one(&self) -> bool {
        matches!(self.paint, ClothPaint::Uniform(added) if self.base + added == 1.0)
    }

    /// The factor of each particle; empty if it is 1 everywhere.
    ///
    /// # Errors
    /// [`PaintError::Quantity`] for the first that is not in this range;
    /// [`PaintError::NoSuchChannel`]; [`PaintError::Count`].
    fn values(
        &self,
        surface: &Surface,
        quantity: &'static str,
        range: Allowed,
    ) -> Result<Vec<f32>, PaintError> {
        if self.is_one() {
            return Ok(Vec::new());
        }
        let mut factors = self.paint.values(surface, quantity)?;
        Allowed(|base| base >= 0.0, "zero or more").check(quantity, [self.base])?;
        factors.iter_mut().for_each(|factor| *factor += self.base);
        range.check(quantity, factors.iter().copied())?;
        Ok(factors)
    }
}

impl ClothMaterialMap {
    /// Whether it changes how a material stretches or bends.
    pub(crate) fn has_stiffness(&self, material: &ClothMaterial) -> bool {
        let [weft, warp] = material.bend_rigidities();
        !self.stretch.is_one() || weft.max(warp) > 0.0 && !self.bending.is_one()
    }

    /// The factors of each particle.
    ///
    /// # Errors
    /// [`PaintError::Quantity`] for the first that is out of its range; [`PaintError::NoSuchChannel`];
    /// [`PaintError::Count`].
    pub(crate) fn factors(&self, surface: &Surface) -> Result<MaterialFactors, PaintError> {
        let (positive, or_zero) = (Allowed::POSITIVE, Allowed::SIZE);
        // All springs of a rope share one compliance, and it never has the surface of a mesh.
        let is_rope = surface.rope_radius().is_some();
        let one = Allowed(|of| of == 1.0, "1 on a rope");
        let [of_stretch, of_bending] = [positive, or_zero].map(|of| if is_rope { one } else { of });
        let density = (self.density).values(surface, "factor of the density", positive)?;
        let stretch = (self.stretch).values(surface, "factor of the stiffness", of_stretch)?;
        let bending = (self.bending).values(surface, "factor of the rigidity", of_bending)?;
        let friction = (self.friction).values(surface, "factor of the friction", or_zero)?;
        let thinner = Allowed(|of| (0.1..=1.0).contains(&of), "from 0.1 to 1");
        let thickness = (self.thickness).values(surface, "factor of the thickness", thinner)?;
        Ok(MaterialFactors {
            density: DensityFactors::new(density, surface),
            stiffness: Arc::new(StiffnessFactors { stretch, bending }),
            grips: by_block(&friction, surface).into(),
            thickness: ThicknessFactors::of(thickness).map(Arc::new),
        })
    }
}

/// The factors of a cloth's material, one a particle.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct MaterialFactors {
    pub density: DensityFactors,
    pub stiffness: Arc<StiffnessFactors>,
    /// Of μ, by the blocks of particles; empty if all are 1.
    pub grips: Arc<[Lanes]>,
    /// `None` if all are 1.
    pub thickness: Option<Arc<ThicknessFactors>>,
}

/// The factors of the thickness of layers, one a particle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ThicknessFactors {
    each: Vec<f32>,
    pub least: f32,
}

impl ThicknessFactors {
    /// `None` without any.
    pub fn of(each: Vec<f32>) -> Option<Self> {
        let least = each.iter().copied().reduce(f32::min)?;
        Some(Self { each, least })
    }

    pub fn each(&self) -> &[f32] {
        &self.each
    }

    /// The mean of the factors of some particles.
    pub fn mean<const N: usize>(&self, particles: [u32; N]) -> f32 {
        let each = particles.iter().map(|&of| self.each[of as usize]);
        each.sum::<f32>() / N as f32
    }
}

/// One value a particle, by the blocks of particles.
fn by_block(values: &[f32], surface: &Surface) -> Vec<Lanes> {
    let layout = surface.layout();
    let all = layout.blocks();
    let blocks = if values.is_empty() { 0 } else { all };
    let mut lanes = vec![[1.0; LANES]; blocks];
    for (value, slot) in values.iter().zip(layout.slots()) {
        lanes[slot.block][slot.lane] = *value;
    }
    lanes
}
