//! What can be wrong with a cloth or a collider.

mod check;

use bevy::{ecs::entity::Entity, math::Vec3, reflect::Reflect};
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
    /// A vertex attribute that a number of each particle was to come from does not exist.
    #[error(
        "there is no channel {channel} of a vertex attribute \"{name}\"; the cloth has: {attributes}"
    )]
    NoSuchPaint {
        /// Its name.
        name: String,
        /// Which channel of it, from 0.
        channel: usize,
        /// The names of those that there are.
        attributes: String,
    },
    /// Numbers that are not one for each vertex.
    #[error("the cloth has {expected} vertices, and {found} numbers were given for them")]
    PaintCount {
        /// How many vertices there are.
        expected: usize,
        /// How many numbers.
        found: usize,
    },
    /// A skinned mesh whose joints' weights are no weights.
    #[error("the weights of vertex {vertex}'s joints must be finite and not negative: {weights:?}")]
    SkinWeights {
        /// Which vertex.
        vertex: usize,
        /// Its weights.
        weights: [f32; 4],
    },
    /// A skinned mesh without joint indices and weights, or whose vertices name more joints than there are.
    #[error(
        "the mesh needs a joint index and weights for each vertex, and {needed} joints with bind poses; there are {joints}"
    )]
    SkinJoints {
        /// How many joints its vertices name.
        needed: usize,
        /// How many there are.
        joints: usize,
    },
    /// No entity below a character has the name of a bone.
    #[error("there is no bone \"{name}\" below this entity")]
    NoSuchBone {
        /// The name.
        name: String,
    },
    /// A joint of a skinned mesh that does not exist, or whose transform is not finite.
    #[error("joint {joint} of the skin, {entity}, must exist with a finite global transform")]
    Joint {
        /// Which joint.
        joint: usize,
        /// Its entity.
        entity: Entity,
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
    /// The cloth that drives a mesh does not exist, or is no cloth.
    #[error("the mesh is driven by {cloth}, which does not exist or is no cloth")]
    NoDrivingCloth {
        /// What was to drive it.
        cloth: Entity,
    },
    /// A mesh that is to be driven by a cloth, and is elsewhere.
    #[error(
        "vertex {vertex} of the mesh is {distance} m from the cloth at rest, whose size is {farthest} m: put the mesh where the cloth is"
    )]
    BoundTooFar {
        /// Which vertex.
        vertex: usize,
        /// How far it is from the cloth (m).
        distance: f32,
        /// How far it may be (m).
        farthest: f32,
    },
    /// An entity, or one above it, that has no `Transform`.
    #[error("{name} has no `Transform`: insert one, such as `Transform::default()`")]
    NoTransform {
        /// The entity without one.
        entity: Entity,
        /// Its `Name` or number, after `the parent` or `the ancestor` where it is above.
        name: String,
    },
    /// A transform that is not finite, or that is scaled to nothing.
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
    /// Particles that are more or fewer than those of the surface.
    #[error(
        "the cloth has {expected} particles, its `ClothParticles` hold {found}: insert {expected}, or `ClothParticles::default()` to build the cloth at rest"
    )]
    ParticleCount {
        /// What the surface asks for.
        expected: usize,
        /// What was found.
        found: usize,
    },
    /// Particles that are those of another grid, though as many.
    #[error(
        "the cloth has {cloth}, its `ClothParticles` have {columns} columns × {rows} rows: insert `ClothParticles::new` with a position for each index, or `ClothParticles::default()` to build the cloth at rest"
    )]
    ParticleLayout {
        /// Columns and rows of the cloth, or its particles and vertices.
        cloth: String,
        /// Particles a row.
        columns: u32,
        /// Particles a column.
        rows: u32,
    },
    /// Positions and inverse masses that are not as many of either.
    #[error("{positions} positions have {inverse_masses} inverse masses: give one for each")]
    InverseMassCount {
        /// How many positions.
        positions: usize,
        /// How many inverse masses.
        inverse_masses: usize,
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
