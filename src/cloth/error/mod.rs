//! Errors of cloths and colliders.

mod check;

use bevy::{ecs::entity::Entity, math::Vec3, reflect::Reflect};
use thiserror::Error;

use super::{limits::MAX_PARTICLES, particle_id::ParticleId, spring::Spring};

/// The reason why a cloth or a collider is not simulated, with the value at fault.
///
/// The plugin logs each error once with its entity, marks the entity with a [`ClothFault`](crate::plugin::ClothFault),
/// and continues with the other entities. Fixing the value brings the entity back.
#[derive(Reflect, Debug, Clone, PartialEq, Error)]
#[type_path = "bevy_drape"]
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
    #[error("{columns} × {rows} particles exceed the maximum of {MAX_PARTICLES} for a cloth")]
    GridTooLarge {
        /// Particles along the width.
        columns: u32,
        /// Particles along the height.
        rows: u32,
    },
    /// A number outside its valid range, or not finite.
    #[error("{quantity} must be {expected}, not {value}")]
    Quantity {
        /// The name of the quantity, with its unit.
        #[reflect(ignore)]
        quantity: &'static str,
        /// The valid range.
        #[reflect(ignore)]
        expected: &'static str,
        /// The invalid value.
        value: f32,
    },
    /// A cloth's thickness is more than half of its shortest spacing.
    #[error(
        "a thickness of {thickness} m needs a spacing of at least twice that, but the shortest is {shortest} m: use a smaller thickness or fewer particles"
    )]
    TooThick {
        /// The thickness (m).
        thickness: f32,
        /// The shortest spacing at rest (m).
        shortest: f32,
    },
    /// Rows and columns were requested of a cloth that was not made from a grid.
    #[error("the cloth is a mesh, which has neither rows nor columns")]
    NotAGrid,
    /// A cloth with pressure does not enclose a volume.
    #[error(
        "a cloth with pressure must be a closed mesh, with two faces at each edge, but this mesh has a border"
    )]
    NotClosed,
    /// A pin names a particle outside the cloth.
    #[error("{pin} is outside a cloth of {cloth}")]
    PinOutOfRange {
        /// The pin.
        pin: String,
        /// The cloth's columns and rows, or its particles and vertices.
        cloth: String,
    },
    /// A pin names rows and columns, but the cloth is not a grid.
    #[error(
        "{pin} names rows and columns, but the cloth is a mesh: pin it by vertex, position, colour or attribute"
    )]
    PinNeedsGrid {
        /// The pin.
        pin: String,
    },
    /// A pin names a vertex attribute that the mesh does not have, or that is not numeric.
    #[error("{pin} needs an attribute that the mesh does not have; it has: {attributes}")]
    NoSuchAttribute {
        /// The pin.
        pin: String,
        /// The names of the mesh's attributes.
        attributes: String,
    },
    /// A pin by position, colour or attribute matches no particle.
    #[error("{pin} matches no particle of the cloth")]
    PinFindsNothing {
        /// The pin.
        pin: String,
    },
    /// A paint names a vertex attribute or a channel that does not exist.
    #[error("no channel {channel} of a vertex attribute \"{name}\"; the cloth has: {attributes}")]
    NoSuchPaint {
        /// The name of the attribute.
        name: String,
        /// The channel, from 0.
        channel: usize,
        /// The names of the cloth's attributes.
        attributes: String,
    },
    /// A paint does not have one value for each vertex.
    #[error("{found} values were given for {expected} vertices: give one for each vertex")]
    PaintCount {
        /// Number of vertices.
        expected: usize,
        /// Number of values.
        found: usize,
    },
    /// The axis of a [`ClothGrain`](crate::cloth::ClothGrain) has no direction.
    #[error("the axis of a grain must be finite and have a length: {axis}")]
    GrainAxis {
        /// The axis.
        axis: Vec3,
    },
    /// A mesh with a weft has no texture coordinates that its warp could follow.
    #[error("a weft on a mesh needs texture coordinates to follow, or a `ClothGrain` with an axis")]
    GrainNeedsUvs,
    /// A triangle of a mesh with a weft has no area in the texture, and so no direction of its warp.
    #[error(
        "triangle {triangle} has no area in the texture, so its warp has no direction: unfold it, or insert a `ClothGrain` with an axis"
    )]
    FoldedUvs {
        /// Index of the triangle.
        triangle: usize,
    },
    /// A skinned mesh has a joint weight that is negative or not finite.
    #[error("the joint weights of vertex {vertex} must be finite and not negative: {weights:?}")]
    SkinWeights {
        /// Index of the vertex.
        vertex: usize,
        /// Its weights.
        weights: [f32; 4],
    },
    /// A skinned mesh has no joint indices and weights, or its vertices name joints that do not exist.
    #[error(
        "the mesh needs joint indices and weights for each vertex, and {needed} joints with inverse bind poses, but there are {joints}"
    )]
    SkinJoints {
        /// Number of joints that the vertices name.
        needed: usize,
        /// Number of joints that exist.
        joints: usize,
    },
    /// A character has no descendant with the name of the bone.
    #[error("no descendant of this entity is a bone named \"{name}\"")]
    NoSuchBone {
        /// The name of the bone.
        name: String,
    },
    /// A joint of a skinned mesh does not exist, or its transform is not finite.
    #[error("joint {joint} of the skin, {entity}, must exist and have a finite global transform")]
    Joint {
        /// Index of the joint.
        joint: usize,
        /// Its entity.
        entity: Entity,
    },
    /// The mesh asset of a cloth does not exist, and is not being loaded.
    #[error("the mesh is neither loaded nor loading: does the entity have a `Mesh3d`?")]
    MeshNotLoaded,
    /// The mesh asset of a cloth is being loaded: the cloth waits for it. Neither logged nor marked.
    #[error("the mesh is being loaded")]
    MeshLoading,
    /// The mesh asset of a cloth could not be loaded.
    #[error("the mesh could not be loaded: {reason}")]
    MeshFailed {
        /// The error of the asset server.
        reason: String,
    },
    /// A mesh has its vertices only in the render world.
    #[error(
        "the mesh is only in the render world: load it with `RenderAssetUsages::MAIN_WORLD` too, which is the default"
    )]
    MeshNotReadable,
    /// A mesh is made of lines or points.
    #[error("a cloth needs a triangle list or a triangle strip, not a {topology}")]
    MeshTopology {
        /// The topology of the mesh.
        topology: String,
    },
    /// A mesh has no positions, or positions that are not `Float32x3`.
    #[error("the mesh has no positions of format `Float32x3`")]
    MeshWithoutPositions,
    /// The number of indices is not a multiple of three.
    #[error("{indices} indices do not make whole triangles: their number must be a multiple of 3")]
    MeshIndexCount {
        /// Number of indices.
        indices: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} has corners {corners:?}, but there are {vertices} vertices")]
    TriangleOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// Its corners.
        corners: [u32; 3],
        /// Number of vertices.
        vertices: usize,
    },
    /// A vertex is not finite, or beyond 10¹² m.
    #[error("vertex {vertex} is not finite or is beyond 10¹² m: {position}")]
    VertexNotFinite {
        /// Index of the vertex.
        vertex: usize,
        /// Its position (m).
        position: Vec3,
    },
    /// No triangle of the mesh has an area.
    #[error("none of the mesh's {triangles} triangles has an area")]
    MeshWithoutArea {
        /// Number of triangles.
        triangles: usize,
    },
    /// A mesh gives more particles than [`MAX_MESH_PARTICLES`](crate::cloth::MAX_MESH_PARTICLES).
    #[error("{particles} particles exceed the maximum of 262144 for a cloth from a mesh")]
    MeshTooLarge {
        /// Number of particles that the mesh gives.
        particles: usize,
    },
    /// The cloth that drives a mesh, or that a hand holds, does not exist, or is not a cloth.
    #[error("{cloth} does not exist or is not a cloth")]
    NoSuchCloth {
        /// The missing cloth.
        cloth: Entity,
    },
    /// A hand has a parent, or is the cloth that it holds.
    #[error("a `ClothGrab` must be on an entity of its own, without a parent")]
    HandNotAlone,
    /// A mesh driven by a cloth is too far from it.
    #[error(
        "vertex {vertex} of the mesh is {distance} m from the cloth at rest, which is only {farthest} m across: place the mesh on the cloth"
    )]
    BoundTooFar {
        /// Index of the vertex.
        vertex: usize,
        /// Its distance from the cloth (m).
        distance: f32,
        /// The largest allowed distance (m).
        farthest: f32,
    },
    /// An entity, or one of its ancestors, has no `Transform`.
    #[error("{name} has no `Transform`: insert one, such as `Transform::default()`")]
    NoTransform {
        /// The entity without one.
        entity: Entity,
        /// Its `Name` or ID, after `the parent` or `the ancestor` where it is above.
        name: String,
    },
    /// A transform is not finite, or has a zero scale.
    #[error("the global transform must be finite, with a scale other than zero: {transform}")]
    Transform {
        /// The transform, as text.
        transform: String,
    },
    /// A particle's position, displacement or inverse mass is not finite or out of range.
    #[error(
        "particle {index} is not finite, is beyond 10¹⁸ m, or is lighter than 10⁻¹⁵ kg: position {position}, displacement {displacement}, inverse mass {inverse_mass}"
    )]
    ParticleNotFinite {
        /// Index of the first such particle.
        index: usize,
        /// Its position (m).
        position: Vec3,
        /// Its displacement (m).
        displacement: Vec3,
        /// Its inverse mass (1/kg), zero or more.
        inverse_mass: f32,
    },
    /// A shape that cloth cannot touch, such as a line.
    #[error("cloth cannot collide with this shape: {shape}")]
    NoSuchShape {
        /// The shape.
        shape: String,
    },
    /// The points of a convex hull lie in one plane.
    #[error("the convex hull of these {points} points has no volume: they lie in one plane")]
    FlatHull {
        /// Number of points.
        points: usize,
    },
    /// A height field has fewer than two rows or columns, or an incomplete row.
    #[error(
        "a height field needs at least 2 full rows of at least 2 columns, not {heights} heights in {columns} columns"
    )]
    HeightFieldSize {
        /// Number of heights.
        heights: usize,
        /// Number of heights in each row.
        columns: usize,
    },
    /// A compound has a rotated part and a scale that is not uniform.
    #[error("a compound with a rotated part needs a uniform scale, not {scale}")]
    SkewedPart {
        /// The scale of the transform.
        scale: Vec3,
    },
    /// A part of a compound has a position that is out of range, or a rotation that cannot be normalized.
    #[error(
        "part {part} of the compound needs a finite position within 10¹² m and a rotation other than zero: position {place}, rotation {rotation}"
    )]
    PartPose {
        /// Index of the part.
        part: usize,
        /// Its position (m).
        place: Vec3,
        /// Its rotation, as text.
        rotation: String,
    },
    /// The number of particles is not that of the surface.
    #[error(
        "the cloth has {expected} particles, its `ClothParticles` hold {found}: insert {expected}, or `ClothParticles::default()` to build the cloth at rest"
    )]
    ParticleCount {
        /// Number of particles of the surface.
        expected: usize,
        /// Number of particles found.
        found: usize,
    },
    /// The particles are those of another grid with the same number of particles.
    #[error(
        "the cloth has {cloth}, its `ClothParticles` have {columns} columns × {rows} rows: insert `ClothParticles::new` with a position for each index, or `ClothParticles::default()` to build the cloth at rest"
    )]
    ParticleLayout {
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
    /// A spring does not join two different particles, or its rest length or compliance is out of range.
    #[error(
        "spring {index}, {spring:?}, must join two of the {particles} particles, with a rest length from 10⁻⁹ to 10¹² m and a finite compliance of zero or more"
    )]
    BadSpring {
        /// Its index in the list.
        index: usize,
        /// The spring.
        spring: Spring,
        /// Number of particles.
        particles: usize,
    },
    /// A bounding volume does not support the bound rule.
    #[error(
        "{volume} do not support the bound rule `{rule}`: use `BoundRule::Refit`, or spheres or AABBs"
    )]
    NoSuchBounds {
        /// The bounding volumes, in the plural.
        #[reflect(ignore)]
        volume: &'static str,
        /// The rule.
        #[reflect(ignore)]
        rule: &'static str,
    },
    /// A tear runs along no edge of the cloth.
    #[error("no edge of the cloth joins the particles {edge:?}, along which it is torn")]
    NoSuchEdge {
        /// Indices of its ends in the whole cloth.
        edge: [u32; 2],
    },
    /// The target of an attached pin does not exist or has no transform.
    #[error("{pin} is attached to {target}, which does not exist or has no transform")]
    NoTarget {
        /// The attached pin.
        pin: String,
        /// The target.
        target: Entity,
    },
    /// No entity has the name of an attached pin's target.
    #[error("{pin} is attached to \"{name}\", but no entity with a transform has that name")]
    NoTargetNamed {
        /// The attached pin.
        pin: String,
        /// The name of the target.
        name: String,
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
