//! What can be wrong with a cloth or a collider.

use std::mem::discriminant;

use bevy::{
    ecs::entity::{Entity, EntityMapper, MapEntities},
    math::Vec3,
    reflect::Reflect,
};
use thiserror::Error;

use super::{Spring, grid::MAX_PARTICLES, particles::ParticleId, pins::Pin};

/// Why a cloth or a collider is not simulated, with the value that is at fault.
///
/// The plugin logs each once with its entity, marks the entity with a
/// [`ClothFault`](crate::plugin::ClothFault), and goes on with the others. Mending the value is enough to
/// bring the entity back.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ClothError {
    /// Fewer than two columns or rows.
    #[error("a cloth needs at least 2 columns and 2 rows, not {columns} × {rows}")]
    GridTooSmall {
        /// Particles along the width.
        columns: u32,
        /// Particles along the height.
        rows: u32,
    },
    /// More particles than [`MAX_PARTICLES`], or a product that overflows.
    #[error("{columns} × {rows} particles are more than the {MAX_PARTICLES} that a cloth may have")]
    GridTooLarge {
        /// Particles along the width.
        columns: u32,
        /// Particles along the height.
        rows: u32,
    },
    /// A number that is zero, negative, too large or not finite where it may not be.
    #[error("{quantity} must be {expected}, not {value}")]
    Quantity {
        /// What the number is, with its unit.
        #[reflect(ignore)]
        quantity: &'static str,
        /// What it must be.
        #[reflect(ignore)]
        expected: &'static str,
        /// What it is.
        value: f32,
    },
    /// A pin that names a particle outside of the cloth.
    #[error("{pin:?} is outside of a cloth of {columns} columns × {rows} rows")]
    PinOutOfRange {
        /// The pin.
        pin: Pin,
        /// Particles along the width.
        columns: u32,
        /// Particles along the height.
        rows: u32,
    },
    /// A transform that is not finite, that is scaled to nothing, or that an ancestor lacks.
    #[error("the global transform must be finite, with a scale other than zero: {transform}")]
    Transform {
        /// The transform, written out.
        transform: String,
    },
    /// A particle whose position, displacement or inverse mass is not a finite number, or beyond all measure.
    #[error(
        "particle {index} is not finite, beyond 10¹⁸ m, or lighter than 10⁻¹⁵ kg: position {position}, displacement {displacement}, inverse mass {inverse_mass}"
    )]
    ParticleNotFinite {
        /// Index of the first such particle.
        index: usize,
        /// Its position (m).
        position: Vec3,
        /// Its displacement (m).
        displacement: Vec3,
        /// Its inverse mass (1/kg), which may not be negative either.
        inverse_mass: f32,
    },
    /// A rapier collider that a cloth cannot touch.
    #[error(
        "a rapier collider must be a ball, scaled alike along its axes, for cloth to touch it; this one is {shape}"
    )]
    NotABall {
        /// The kind of shape that it is.
        shape: String,
    },
    /// Columns of particles that do not fit the grid.
    #[error(
        "the cloth has {expected} particles, its `ClothParticles` hold {found}: give it as many, or empty them"
    )]
    ParticleCount {
        /// What the grid asks for.
        expected: usize,
        /// What was found.
        found: usize,
    },
    /// A spring between particles that do not exist or are one, or with a bad rest length or compliance.
    #[error(
        "spring {index}, {spring:?}, needs two of the {particles} particles, a rest length from 10⁻⁹ to 10¹² m and a finite compliance of zero or more"
    )]
    BadSpring {
        /// Its place in the list.
        index: usize,
        /// The spring.
        spring: Spring,
        /// How many particles there are.
        particles: usize,
    },
    /// A bounding volume that there is no such rule for.
    #[error("there is no bound rule `{rule}` for {volume}: refit them, or take spheres or AABBs")]
    NoSuchBounds {
        /// The volumes.
        #[reflect(ignore)]
        volume: &'static str,
        /// The rule.
        #[reflect(ignore)]
        rule: &'static str,
    },
    /// What a pin is attached to does not exist or has no transform.
    #[error("{pin:?} is attached to {target}, which does not exist or has no transform")]
    NoTarget {
        /// The attached pin.
        pin: Pin,
        /// What it is attached to.
        target: Entity,
    },
    /// A particle that does not exist was written to.
    #[error("{id:?} is outside of a cloth of {columns} columns × {rows} rows")]
    NoSuchParticle {
        /// The particle asked for.
        id: ParticleId,
        /// Particles along the width.
        columns: u32,
        /// Particles along the height.
        rows: u32,
    },
}

impl MapEntities for ClothError {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        if let Self::NoTarget { target, .. } = self {
            *target = mapper.get_mapped(*target);
        }
    }
}

impl ClothError {
    /// Whether `other` is at fault in the same place, whatever the value.
    pub(crate) fn is_same_fault(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Quantity { quantity: a, .. }, Self::Quantity { quantity: b, .. }) => a == b,
            (Self::NoTarget { .. }, Self::NoTarget { .. }) => self == other,
            _ => discriminant(self) == discriminant(other),
        }
    }

    /// `value` if it holds to `test`, else the error that names it.
    pub(crate) fn check(
        value: f32,
        test: fn(f32) -> bool,
        quantity: &'static str,
        expected: &'static str,
    ) -> Result<f32, Self> {
        if test(value) {
            Ok(value)
        } else {
            Err(Self::Quantity {
                quantity,
                expected,
                value,
            })
        }
    }
}
