//! Errors of particles.

use bevy::{math::Vec3, reflect::Reflect};
use thiserror::Error;

use crate::cloth::particle_id::ParticleId;

/// The reason why particles are not those of a cloth.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ParticleError {
    /// A particle's position, displacement or inverse mass is not finite or out of range.
    #[error(
        "particle {index} is not finite, is beyond 10¹⁸ m, or is lighter than 10⁻¹⁵ kg: position {position}, displacement {displacement}, inverse mass {inverse_mass}"
    )]
    NotFinite {
        /// Index of the first such particle.
        index: usize,
        /// Its position (m).
        position: Vec3,
        /// Its displacement (m).
        displacement: Vec3,
        /// Its inverse mass (1/kg), zero or more.
        inverse_mass: f32,
    },
    /// The number of particles is not that of the surface.
    #[error(
        "the cloth has {expected} particles, its `ClothParticles` hold {found}: insert {expected}, or `ClothParticles::default()` to build the cloth at rest"
    )]
    Count {
        /// Number of particles of the surface.
        expected: usize,
        /// Number of particles found.
        found: usize,
    },
    /// The particles are those of another grid with the same number of particles.
    #[error(
        "the cloth has {cloth}, its `ClothParticles` have {columns} columns × {rows} rows: insert `ClothParticles::new` with a position for each index, or `ClothParticles::default()` to build the cloth at rest"
    )]
    Layout {
        /// Columns and rows of the cloth, or its particles and vertices.
        cloth: String,
        /// Particles per row.
        columns: u32,
        /// Particles per column.
        rows: u32,
    },
    /// The numbers of positions and inverse masses differ.
    #[error("{positions} positions have {inverse_masses} inverse masses: give one for each")]
    InverseMassCount {
        /// Number of positions.
        positions: usize,
        /// Number of inverse masses.
        inverse_masses: usize,
    },
    /// A particle that does not exist was written to.
    #[error("{id:?} is outside a cloth of {columns} columns × {rows} rows")]
    NoSuchParticle {
        /// The particle's ID.
        id: ParticleId,
        /// Particles along the width.
        columns: u32,
        /// Particles along the height.
        rows: u32,
    },
}
