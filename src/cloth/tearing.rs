//! Cloth that tears where it is loaded too much.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{
    material::ClothMaterial, particles::ClothParticles, quantity::QuantityError,
    springs::StiffnessFactors, stress::Stress, surface::Surface, tears::ClothTears,
};
use crate::cloth::{Allowed, arrays::MapInline};

/// Tears a cloth where its threads bear more than their strength. A tear begins at the thread that is overloaded most, and runs
/// across it from tick to tick, an edge at a time.
///
/// The load of a thread is that at which its material is stretched as far (N/m, the force on a strip over its width). On a mesh
/// it is also no more than that of the patch around, of 3 to 12 rings of faces, by the forces that its springs apply. At the end of a tear,
/// the patch has two rings. By default, a mesh that may tear takes at least 20 sub-steps in 1/64 s. A
/// [map](crate::cloth::ClothMaterialMap) of stretch changes the stretch, not the strength. So the
/// cloth needs a compliance: none of [`ClothMaterial`]'s presets for fabrics is rigid. Beside a pin a coarse cloth is
/// stretched more than it should be, see [`ClothSettings`](crate::solver::ClothSettings); that counts as load, too.
///
/// The edges are listed in [`ClothTears`], which this component requires. `ClothTorn` messages tell of each tear.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// fn banner(mut commands: Commands) {
///     commands.spawn((Cloth::new(20, 30, 0.05), ClothMaterial::COTTON, ClothTearing::new(800.0)));
/// }
/// # bevy::ecs::system::assert_is_system(banner);
/// ```
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(ClothTears)]
pub struct ClothTearing {
    /// The load that threads along the warp can bear: along the columns of a grid, and along any edge of a mesh without a
    /// [grain](crate::cloth::ClothGrain) (N/m).
    pub strength: f32,
    /// The same along the weft: along the rows of a grid, or across the [grain](crate::cloth::ClothGrain) of a mesh (N/m).
    pub weft_strength: f32,
}

impl Default for ClothTearing {
    /// 1,000 N/m both ways, under which [`COTTON`](ClothMaterial::COTTON) stretches by 10 %: a guess.
    fn default() -> Self {
        Self::new(1000.0)
    }
}

impl ClothTearing {
    /// As strong along the weft as along the warp (N/m).
    pub const fn new(strength: f32) -> Self {
        Self {
            strength,
            weft_strength: strength,
        }
    }

    /// Checks that the strengths are positive, and that the material stretches.
    ///
    /// # Errors
    /// [`QuantityError`].
    pub fn validate(&self, material: &ClothMaterial) -> Result<(), QuantityError> {
        let positive = Allowed(|value| value > 0.0, "positive");
        let strengths = [self.strength, self.weft_strength];
        positive.check("strength of a cloth that tears (N/m)", strengths)?;
        let quantity = "stretch compliance of a cloth that tears (m/N)";
        positive.check(quantity, material.stretch_compliances())
    }
}

/// The strength of a cloth, and what it is of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Strength<'a> {
    pub tearing: &'a ClothTearing,
    pub material: &'a ClothMaterial,
    pub factors: &'a StiffnessFactors,
}

impl Strength<'_> {
    /// The load that an edge bears (N/m). `along_warp` is the square of the cosine of its angle with the warp.
    fn load(&self, along_warp: f32) -> f32 {
        let tearing = self.tearing;
        between([tearing.weft_strength, tearing.strength], along_warp)
    }

    /// The strain of an edge at the load that it bears.
    fn strain(&self, ends: [u32; 2], along_warp: f32) -> f32 {
        let [weft, warp] = self.material.stretch_compliances();
        let tearing = self.tearing;
        let strains = [weft * tearing.weft_strength, warp * tearing.strength];
        let linear = between(strains, along_warp) * self.factors.of_spring(ends);
        let stiffening = self.material.stiffening;
        stiffening.map_or(linear, |stiffening| stiffening.strain_of(linear))
    }
}

/// The search for edges to tear next. Its memory is reused from tick to tick.
#[derive(Debug, Default)]
pub(crate) struct TearSearch {
    places: Vec<Vec3>,
    /// Each overloaded edge, the most loaded first: its load over its strength, its ends, and how much of it is along the warp.
    overloaded: Vec<(f32, [u32; 2], f32)>,
    stress: Stress,
}

impl TearSearch {
    /// Tears at the most overloaded edge of each part of a cloth, or at those at which its tears end: a tear that runs takes
    /// the load off the rest. Returns these edges, of the whole surface. `tensions` calls its argument with the ends of each spring
    /// of a mesh, and its tension T L₀/L (N).
    pub fn edges(
        &mut self,
        strength: Strength,
        surface: &Surface,
        particles: &ClothParticles,
        tears: &ClothTears,
        tensions: impl FnOnce(&mut dyn FnMut([u32; 2], f32)),
    ) -> Vec<[u32; 2]> {
        self.places.clear();
        self.places.extend(particles.positions());
        self.find_stretched(strength, surface);
        if self.overloaded.is_empty() {
            return Vec::new();
        }
        let is_tip = tips(surface, tears);
        // Edges of an irregular mesh are stretched unevenly, and so are those that cross a knee.
        if surface.rest_grid().is_none() || strength.material.stiffening.is_some() {
            self.keep_loaded(strength, surface, &is_tip, tensions);
        }
        self.overloaded
            .sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let pieces = surface.pieces_of();
        let splits: Vec<(bool, u32, Vec<[u32; 2]>)> = (self.overloaded.iter())
            .filter_map(|(_, ends, _)| split(*ends, surface, particles, &is_tip))
            .collect();
        let mut has_running = vec![false; surface.len()];
        for (runs, particle, _) in &splits {
            has_running[pieces[*particle as usize] as usize] |= runs;
        }
        let mut is_used = vec![false; surface.len()];
        let mut has_begun = vec![false; surface.len()];
        let mut torn = Vec::new();
        for (runs, particle, edges) in splits {
            let piece = pieces[particle as usize] as usize;
            let may_tear = runs || !has_running[piece] && !has_begun[piece];
            let ends = || edges.iter().flatten().map(|end| *end as usize);
            if may_tear && !ends().any(|end| is_used[end]) {
                has_begun[piece] = true;
                ends().for_each(|end| is_used[end] = true);
                torn.extend(edges);
            }
        }
        torn
    }

    /// Finds the edges that are stretched too far.
    fn find_stretched(&mut self, strength: Strength, surface: &Surface) {
        let places = &self.places;
        self.overloaded.clear();
        surface.for_each_thread(|ends, rest_length, along_warp| {
            let [a, b] = ends.map_inline(|end| places[end as usize]);
            let stretch = a.distance(b) / rest_length - 1.0;
            let borne = strength.strain(ends, along_warp);
            if stretch > borne {
                (self.overloaded).push((stretch / borne, ends, along_warp));
            }
        });
    }

    /// Keeps those of them whose patch bears too much, too.
    fn keep_loaded(
        &mut self,
        strength: Strength,
        surface: &Surface,
        is_tip: &[bool],
        tensions: impl FnOnce(&mut dyn FnMut([u32; 2], f32)),
    ) {
        self.stress.find(tensions, surface, &self.places);
        (self.overloaded).retain_mut(|(load, ends, along_warp)| {
            let borne = strength.load(*along_warp);
            let is_at_tip = ends.iter().any(|end| is_tip[*end as usize]);
            let of_patch = self.stress.along(*ends, is_at_tip, &self.places) / borne;
            *load = load.min(of_patch);
            // False for NaN.
            of_patch > 1.0
        });
    }
}

/// The strength of a thread from those of weft and warp, as an ellipse has it, by the square of the cosine of its angle with the warp.
fn between([weft, warp]: [f32; 2], along_warp: f32) -> f32 {
    match along_warp {
        0.0 => weft,
        1.0 => warp,
        square => 1.0 / ((1.0 - square) / weft.powi(2) + square / warp.powi(2)).sqrt(),
    }
}

/// Marks the particles at which a tear ends: torn edges lead there, and it is still one.
fn tips(surface: &Surface, tears: &ClothTears) -> Vec<bool> {
    let mut is_tip = vec![false; surface.len()];
    for end in tears.edges().iter().flatten() {
        is_tip[*end as usize] = true;
    }
    for (_, origin) in surface.copies() {
        is_tip[origin as usize] = false;
    }
    is_tip
}

/// Where an overloaded edge has the cloth tear: whether a tear runs on there, at which of its ends, and along which edges
/// of the whole surface. That end is one at which a tear ends, or else one at a border. `None` if it is pinned, or has
/// faces on one side alone.
fn split(
    ends: [u32; 2],
    surface: &Surface,
    particles: &ClothParticles,
    is_tip: &[bool],
) -> Option<(bool, u32, Vec<[u32; 2]>)> {
    let rest = surface.rest_positions();
    let [from, to] = ends.map_inline(|end| rest[end as usize]);
    let mut best: Option<(bool, u32, Vec<[u32; 2]>)> = None;
    for end in ends {
        if particles.is_pinned(end as usize) != Some(false) {
            continue;
        }
        let edges = across(end, to - from, surface);
        let runs = is_tip[end as usize];
        // One edge is enough at a border.
        let is_better = best
            .as_ref()
            .is_none_or(|(known, _, others)| (runs, others.len()) > (*known, edges.len()));
        if !edges.is_empty() && is_better {
            let whole = |edge: [u32; 2]| edge.map_inline(|end| surface.origin_of(end));
            best = Some((runs, end, edges.into_iter().map(whole).collect()));
        }
    }
    best
}

/// The edges at a particle that separate its faces on both sides of the plane across `direction`.
fn across(particle: u32, direction: Vec3, surface: &Surface) -> Vec<[u32; 2]> {
    let rest = surface.rest_positions();
    let at = rest[particle as usize];
    let is_beyond = |face: [u32; 3]| {
        let sum: Vec3 = face.iter().map(|corner| rest[*corner as usize] - at).sum();
        sum.dot(direction) > 0.0
    };
    let faces = surface.faces_around(particle);
    let fan: Vec<([u32; 3], bool)> = faces.map(|face| (face, is_beyond(face))).collect();
    let mut edges = Vec::new();
    for (index, (face, side)) in fan.iter().enumerate() {
        for (other, other_side) in &fan[..index] {
            let mut others = face.iter().filter(|corner| **corner != particle);
            let shared = others.find(|corner| other.contains(corner));
            if let Some(end) = shared
                && side != other_side
            {
                edges.push([particle, *end]);
            }
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along weft and warp it is exactly their strength, half-way `√2 a b ⁄ √(a² + b²)`, and nowhere outside of the two. Three quotients,
    /// two sums and a root round it by less than eight parts in 2²⁴. An infinite strength along one of them leaves `a ⁄ sin`.
    #[test]
    fn strength_is_an_ellipse() {
        let rounding = 4.0 * f32::EPSILON;
        for [weft, warp] in [
            [80.0, 120.0],
            [120.0, 80.0],
            [700.0, 700.0],
            [1.0e-3, 1.0e6],
        ] {
            assert_eq!(between([weft, warp], 0.0), weft);
            assert_eq!(between([weft, warp], 1.0), warp);
            let half: f64 = f64::from(weft) * f64::from(warp) * 2.0_f64.sqrt()
                / f64::from(weft).hypot(f64::from(warp));
            let found = f64::from(between([weft, warp], 0.5));
            assert!(
                (found / half - 1.0).abs() < f64::from(rounding),
                "{found} {half}"
            );
            for part in 0..=1000_u16 {
                let found = between([weft, warp], f32::from(part) / 1000.0);
                let allowed = weft.min(warp) * (1.0 - rounding)..=weft.max(warp) * (1.0 + rounding);
                assert!(allowed.contains(&found), "{part}: {found}");
            }
        }
        let found = between([3.0, f32::INFINITY], 0.75);
        assert!((found / 6.0 - 1.0).abs() < rounding, "{found}");
        assert_eq!(between([f32::INFINITY; 2], 0.5), f32::INFINITY);
    }
}
