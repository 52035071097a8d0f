//! The choice between particles and triangles in the narrow phase.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::{cloth::Surface, contact::colliders::MovingCollider};

/// Colliders with a radius of at least this many spacings are tested against particles, smaller ones against triangles.
///
/// A ball that a cloth wraps dips into the flat triangles between the particles. It dips by 22 % of its radius at 1.5 spacings,
/// 11 at 2, 6.6 at 2.5, 4.6 at 3, and 2.7 at 4. At 1 and below it falls through. Against triangles it dips by 0.2 % or
/// less from 0.7 spacings on (`cargo bench --profile dev --bench contact`). A whole tick of a 64² cloth at rest on a
/// large ball takes 2.4 times as long against triangles. The eye notices five per cent.
pub const PARTICLES_FROM: f32 = 3.0;

/// A collider that moves farther in a tick than this many of its radii separates the particles before the springs can
/// hold them together. It is tested against triangles.
const SLOW_RADII: f32 = 2.0;

/// A shape with edges is tested against triangles if a spacing exceeds this many particle radii. Particles a radius off
/// the faces keep the triangle across an edge of a box outside up to 2.8 radii (2√2), and across a corner up to 2.1
/// (1.5 √2). So nothing shows through a finer cloth.
const EDGES_FROM: f32 = 2.0;

/// The narrow phase of a cloth: its colliders are tested against particles or against triangles. A component of the
/// cloth.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Component, Default, Debug, Clone, PartialEq, Hash)]
pub enum NarrowPhase {
    /// Triangles for three kinds of colliders, particles otherwise. These are balls and capsules with a radius below
    /// [`PARTICLES_FROM`] spacings, those that move farther than their width in the tick, and shapes with edges. Shapes
    /// with edges use particles if the cloth's spacing is at most two radii of its particles. On a mesh, each triangle counts by
    /// its own size: as the spacing of a square grid whose triangles have as large a circle around them.
    #[default]
    Auto,
    /// Particles: exact while the collider is large compared with the spacing.
    Particles,
    /// Triangles for all colliders but planes, for which particles are exact, and skinned meshes.
    Triangles,
}

impl NarrowPhase {
    /// The choices with their names, for menus.
    pub const ALL: [(&str, Self); 3] = [
        ("auto", Self::Auto),
        ("particles", Self::Particles),
        ("triangles", Self::Triangles),
    ];

    /// The narrow phase of a collider, on a cloth with a particle radius (m). `Auto` where it
    /// [depends on the triangle](Self::widest_fine).
    pub(crate) fn of(
        self,
        collider: &MovingCollider,
        surface: &Surface,
        particle_radius: f32,
    ) -> Self {
        let spacing = surface.spacing().longest;
        if !collider.shape.has_edges() {
            let chosen = |spacing| self.chosen(collider.shape.radius(), collider.travel(), spacing);
            // A fast collider is tested against triangles of any size.
            let is_for_any_size = chosen(0.0) == Self::Triangles;
            return match chosen(spacing) {
                Self::Triangles if !is_for_any_size && surface.as_grid().is_none() => Self::Auto,
                chosen => chosen,
            };
        }
        let is_seen = spacing > EDGES_FROM * particle_radius;
        match self {
            Self::Triangles => Self::Triangles,
            Self::Auto if is_seen => Self::Triangles,
            Self::Auto | Self::Particles => Self::Particles,
        }
    }

    /// The largest width (m) of triangles whose particles are enough for a ball or a capsule of this radius (m).
    pub(crate) fn widest_fine(radius: f32) -> f32 {
        radius / PARTICLES_FROM
    }

    /// The narrow phase of a collider of `radius` (m), if it has one, that moves by `travel` in the tick (m), on a
    /// cloth with a `spacing` (m).
    pub fn chosen(self, radius: Option<f32>, travel: f32, spacing: f32) -> Self {
        let is_small =
            |radius: f32| radius < PARTICLES_FROM * spacing || travel > SLOW_RADII * radius;
        match (self, radius) {
            (Self::Triangles, Some(_)) => Self::Triangles,
            (Self::Auto, Some(radius)) if is_small(radius) => Self::Triangles,
            _ => Self::Particles,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_choice_follows_radius_and_travel() {
        let chosen = |choice: NarrowPhase, radius, travel| choice.chosen(radius, travel, 0.1);
        assert_eq!(
            chosen(NarrowPhase::Auto, Some(0.29), 0.0),
            NarrowPhase::Triangles
        );
        assert_eq!(
            chosen(NarrowPhase::Auto, Some(0.31), 0.0),
            NarrowPhase::Particles
        );
        assert_eq!(
            chosen(NarrowPhase::Auto, Some(0.31), 0.63),
            NarrowPhase::Triangles
        );
        assert_eq!(chosen(NarrowPhase::Auto, None, 9.0), NarrowPhase::Particles);
        assert_eq!(
            chosen(NarrowPhase::Triangles, None, 0.0),
            NarrowPhase::Particles
        );
        assert_eq!(
            chosen(NarrowPhase::Triangles, Some(9.0), 0.0),
            NarrowPhase::Triangles
        );
        assert_eq!(
            chosen(NarrowPhase::Particles, Some(0.01), 9.0),
            NarrowPhase::Particles
        );
    }
}
