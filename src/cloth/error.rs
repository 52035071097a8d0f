//! What can be wrong with a cloth or a collider.

use std::mem::discriminant;

use bevy::{
    ecs::entity::{Entity, EntityMapper, MapEntities},
    math::Vec3,
    reflect::Reflect,
};
use thiserror::Error;

use super::{MAX_PARTICLES, ParticleId, Pin, Spring};

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
    /// Layers of cloth are to be kept farther apart than its particles leave room for.
    #[error(
        "a thickness of {thickness} m asks for a spacing of at least twice as much, and the shortest is {shortest} m: make the thickness smaller, or the cloth of fewer particles"
    )]
    TooThick {
        /// How far apart (m).
        thickness: f32,
        /// The shortest spacing at rest (m).
        shortest: f32,
    },
    /// Rows and columns were asked of a cloth that was not made from a grid.
    #[error("the cloth is a mesh, which has neither rows nor columns")]
    NotAGrid,
    /// Pressure was asked for in a cloth that does not enclose a volume.
    #[error(
        "a cloth with pressure must be a closed mesh: each edge between two faces, and this one has a border"
    )]
    NotClosed,
    /// A pin that names a particle outside of the cloth.
    #[error("{pin:?} is outside of a cloth of {cloth}")]
    PinOutOfRange {
        /// The pin.
        pin: Pin,
        /// Its columns and rows, or its particles and vertices.
        cloth: String,
    },
    /// A pin by rows and columns on a cloth that has neither.
    #[error(
        "{pin:?} names rows and columns, and the cloth is a mesh: pin it by vertex, place, colour or attribute"
    )]
    PinNeedsGrid {
        /// The pin.
        pin: Pin,
    },
    /// A pin by a vertex attribute that the mesh does not have, or not as numbers.
    #[error("{pin:?} asks for an attribute that the mesh does not have; it has: {attributes}")]
    NoSuchAttribute {
        /// The pin.
        pin: Pin,
        /// The names of those that it has.
        attributes: String,
    },
    /// A pin by place, colour or attribute that no particle answers to.
    #[error("{pin:?} holds for no particle of the cloth")]
    PinFindsNothing {
        /// The pin.
        pin: Pin,
    },
    /// The asset of a cloth from a mesh is not there, and nothing loads it.
    #[error(
        "the mesh has not been loaded, and nothing is loading it: is there a `Mesh3d` with it?"
    )]
    MeshNotLoaded,
    /// The asset of a cloth from a mesh is being loaded: the cloth waits for it. Neither logged nor marked.
    #[error("the mesh is being loaded")]
    MeshLoading,
    /// The asset of a cloth from a mesh could not be loaded.
    #[error("the mesh could not be loaded: {reason}")]
    MeshFailed {
        /// What the asset server says.
        reason: String,
    },
    /// A mesh whose vertices are in the render world alone.
    #[error(
        "the mesh is in the render world only: load it with `RenderAssetUsages::MAIN_WORLD` too, as by default"
    )]
    MeshNotReadable,
    /// A mesh of lines or points.
    #[error("a cloth needs a mesh of triangles, as a list or a strip, not a {topology}")]
    MeshTopology {
        /// What it is made of.
        topology: String,
    },
    /// A mesh without positions of three floats.
    #[error("the mesh has no positions of three floats")]
    MeshWithoutPositions,
    /// Indices that are not three for each triangle.
    #[error("{indices} indices are not three for each triangle")]
    MeshIndexCount {
        /// How many there are.
        indices: usize,
    },
    /// A triangle of a vertex that does not exist.
    #[error("triangle {triangle} has the corners {corners:?}, and there are {vertices} vertices")]
    TriangleOutOfRange {
        /// Which triangle.
        triangle: usize,
        /// Its corners.
        corners: [u32; 3],
        /// How many vertices there are.
        vertices: usize,
    },
    /// A vertex that is not finite or beyond all measure.
    #[error("vertex {vertex} is not finite, or beyond 10¹² m: {position}")]
    VertexNotFinite {
        /// Which vertex.
        vertex: usize,
        /// Where it is (m).
        position: Vec3,
    },
    /// A mesh in which no triangle has an area.
    #[error("none of the mesh's {triangles} triangles has an area")]
    MeshWithoutArea {
        /// How many there are.
        triangles: usize,
    },
    /// A mesh of more particles than [`MAX_MESH_PARTICLES`](super::MAX_MESH_PARTICLES).
    #[error("{particles} particles are more than the 262144 that a cloth from a mesh may have")]
    MeshTooLarge {
        /// How many there would be.
        particles: usize,
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
    /// A shape that cloth cannot touch, such as a line.
    #[error("cloth does not touch this shape: {shape}")]
    NoSuchShape {
        /// What it is.
        shape: String,
    },
    /// A convex hull of points that lie in one plane.
    #[error("the convex hull of these {points} points encloses nothing: they lie in one plane")]
    FlatHull {
        /// How many points there are.
        points: usize,
    },
    /// A height field of fewer than two rows or columns, or whose rows are not full.
    #[error(
        "a height field needs at least 2 full rows of at least 2 columns: {heights} heights in {columns} columns are not"
    )]
    HeightFieldSize {
        /// How many heights there are.
        heights: usize,
        /// How many each row should have.
        columns: usize,
    },
    /// A compound with a part that is turned, under a scale that is not the same along all axes.
    #[error(
        "a part of the compound is turned, which can't be stretched along one axis only: {scale}"
    )]
    SkewedPart {
        /// The scale of the transform.
        scale: Vec3,
    },
    /// A compound with a part whose place is not finite or beyond all measure, or whose rotation is none.
    #[error(
        "part {part} of the compound needs a finite place within 10¹² m, and a rotation that is one: place {place}, rotation {rotation}"
    )]
    PartPose {
        /// Which part.
        part: usize,
        /// Its place (m).
        place: Vec3,
        /// Its rotation, written out.
        rotation: String,
    },
    /// Particles that are not those of the surface.
    #[error(
        "the cloth has {expected} particles, its `ClothParticles` hold {found}: give it as many, or empty them"
    )]
    ParticleCount {
        /// What the surface asks for.
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
    /// No entity has the name that a pin is attached to.
    #[error("{pin:?} is attached to \"{name}\", and no entity with a transform has that name")]
    NoTargetNamed {
        /// The attached pin.
        pin: Pin,
        /// The name.
        name: String,
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
