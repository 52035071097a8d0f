//! The component that defines a cloth.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
    transform::components::Transform,
};

use super::{
    error::ClothError,
    grid::{ClothGrid, ClothPlane, GridError, GridShape},
    material::ClothMaterial,
    particles::ClothParticles,
    pins::Pins,
    presence::log_unsimulated,
    quantity::{Allowed, QuantityError},
    rope::{RopePath, RopeShape},
    surface::{Surface, TriangleMesh},
};
#[cfg(feature = "mesh")]
use super::{
    rope_mesh::{RopeError, path_of},
    surface::MeshError,
};

/// A cloth: a grid of particles, any triangle mesh, or a [`rope`](Self::rope).
///
/// Spawning this component is enough. A grid of `columns` × `rows` particles, `spacing` metres apart, hangs by its top
/// row from the entity's [`Transform`]. It spans (0, 0, 0) to (width, −height, 0) in the entity's frame.
/// [`lying`](Self::lying) lays it out horizontally, and [`centred`](Self::centred) centres it on its transform.
/// Particle (row, column) has the index `row × columns + column` (paper, equation 1).
///
/// A mesh begins in the shape of its asset. Nothing of it is pinned unless you add [`Pins`]. With feature `mesh`, on by
/// default, `Cloth::mesh()` takes the mesh of the `Mesh3d` on the same entity; [`triangles`](Self::triangles) takes
/// positions and triangles.
///
/// A grid, a rope, or a cloth of its own triangles, ignores a `Mesh3d` on its entity. The plugin draws the cloth in its place, logs
/// that once, and puts the `Mesh3d` back when this component is removed. `Cloth::mesh()` makes the cloth from that mesh. A
/// `ClothRenderMesh` on another entity lets the cloth drive it.
///
/// Position, rotation and scale apply at spawn. When the transform moves later, it carries the pinned particles, and
/// the springs pull the others along.
///
/// This component may change at any time. If a grid changes only its resolution, so that (columns − 1) × spacing and
/// (rows − 1) × spacing stay the same, the cloth keeps its position, shape and motion. Use this to make a distant cloth
/// coarser. Folds finer than the new spacing unfold as fast as they are stretched out, and particles lose masses that
/// the game set individually. Any other change builds a new cloth at rest.
///
/// ```
/// use bevy::math::Vec3;
/// use bevy_drape::prelude::*;
///
/// let curtain = Cloth::new(32, 32, 0.05);
/// let tablecloth = Cloth::new(64, 64, 0.025).lying().centred();
/// let kite = Cloth::triangles(
///     [Vec3::ZERO, Vec3::new(-0.5, 0.5, 0.0), Vec3::new(0.5, 0.5, 0.0), Vec3::new(0.0, 1.0, 0.0)],
///     [[0, 2, 1], [1, 2, 3]],
/// );
/// # let _ = (curtain, tablecloth, kite);
/// ```
#[derive(Component, Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[component(on_add = log_unsimulated)]
#[require(ClothParticles, ClothMaterial, Pins, Transform)]
pub struct Cloth {
    /// The grid, the rope or the triangles.
    pub shape: ClothShape,
    /// The largest initial offset of free particles from the surface, in spacings: real cloth is never perfectly flat.
    /// Without it, nothing moves a flat cloth out of a vertical plane, and a flag stays a board. Equal cloths get equal
    /// offsets, and rest lengths do not change. From 0 to 0.1.
    pub unevenness: f32,
}

/// The shape of a [`Cloth`].
#[derive(Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ClothShape {
    /// A grid of particles.
    Grid(GridShape),
    /// A row of particles without faces.
    Rope(RopeShape),
    /// A rope that begins along a path.
    RopePath(RopePath),
    /// Triangles provided by the game.
    Triangles {
        /// Vertices in the entity's frame (m), before the transform's scale.
        positions: Vec<Vec3>,
        /// Three vertices each, in either winding order.
        triangles: Vec<[u32; 3]>,
        /// Vertices no farther apart than this are welded into one particle (m), before the transform's scale.
        weld: f32,
    },
    /// The mesh of the entity's `Mesh3d`, once its asset has loaded.
    #[cfg(feature = "mesh")]
    Mesh {
        /// Vertices no farther apart than this are welded into one particle (m), before the transform's scale.
        weld: f32,
    },
}

impl Default for ClothShape {
    /// 16 × 16 particles, 0.1 m apart.
    fn default() -> Self {
        Cloth::default().shape
    }
}

impl ClothShape {
    /// Whether it is a rope: a row of particles without faces.
    pub const fn is_rope(&self) -> bool {
        matches!(self, Self::Rope(_) | Self::RopePath(_))
    }

    /// The points of the path along which a rope begins, if it has one.
    pub(crate) fn path(&self) -> Option<&[Vec3]> {
        match self {
            Self::RopePath(path) => Some(&path.points),
            _ => None,
        }
    }

    /// As [`Cloth::surface`].
    pub(crate) fn surface(&self, scale: Vec3) -> Result<Surface, ClothError> {
        match self {
            Self::Grid(grid) => Ok(Surface::of_grid(&grid.scaled(scale)?)),
            Self::Rope(rope) => Ok(Surface::of_grid(&rope.scaled(scale)?)),
            Self::RopePath(path) => path.surface(scale),
            Self::Triangles {
                positions,
                triangles,
                weld,
            } => {
                let mesh = TriangleMesh {
                    positions: positions.clone(),
                    triangles: triangles.clone(),
                    ..TriangleMesh::default()
                };
                Ok(Surface::of_mesh(&mesh, *weld, scale)?)
            }
            #[cfg(feature = "mesh")]
            Self::Mesh { .. } => Err(MeshError::NotLoaded.into()),
        }
    }
}

impl Default for Cloth {
    /// 16 × 16 particles, 0.1 m apart.
    fn default() -> Self {
        Self::new(16, 16, 0.1)
    }
}

impl Cloth {
    /// Default of [`unevenness`](Self::unevenness): a hundredth of a millimetre in a cloth with 0.1 m between its
    /// particles.
    pub const DEFAULT_UNEVENNESS: f32 = 1.0e-4;

    /// Default distance below which vertices of a mesh become one particle (m, before the transform's scale). Vertices
    /// that a modelling program splits along seams are at exactly the same position.
    pub const DEFAULT_WELD: f32 = 1.0e-5;

    /// A cloth of `columns` × `rows` particles, `spacing` metres apart, that hangs from its transform.
    pub const fn new(columns: u32, rows: u32, spacing: f32) -> Self {
        Self::of_shape(ClothShape::Grid(GridShape {
            columns,
            rows,
            spacing,
            plane: ClothPlane::Hanging,
            centred: false,
        }))
    }

    /// A rope of this many particles, `spacing` metres apart, and this radius (m). It hangs down from its transform;
    /// [`lying`](Self::lying) lays it out along +x. Its first particle is pinned unless its `Pins` say otherwise. The pin
    /// [`Pin::Index`](crate::cloth::Pin::Index) holds any other.
    ///
    /// ```
    /// use bevy::prelude::*;
    /// use bevy_drape::prelude::*;
    ///
    /// fn spawn_clothesline(mut commands: Commands) {
    ///     // 3 m long and 1 cm thick, held by both ends.
    ///     let ends = Pins::new([Pin::Index(0), Pin::Index(60)]);
    ///     commands.spawn((Cloth::rope(61, 0.05, 0.005).lying(), ends, Transform::from_xyz(0.0, 2.0, 0.0)));
    /// }
    /// # bevy::ecs::system::assert_is_system(spawn_clothesline);
    /// ```
    pub const fn rope(particles: u32, spacing: f32, radius: f32) -> Self {
        Self::of_shape(ClothShape::Rope(RopeShape {
            particles,
            spacing,
            radius,
            plane: ClothPlane::Hanging,
            centred: false,
        }))
    }

    /// A [rope](Self::rope) that begins along a path through `points`, in the entity's frame (m), with particles about `spacing` metres apart.
    ///
    /// ```
    /// use bevy::math::Vec3;
    /// use bevy_drape::prelude::*;
    ///
    /// // Up from the ground, over a beam, and down.
    /// let points = [Vec3::ZERO, Vec3::new(0.0, 2.0, 0.0), Vec3::new(0.2, 2.0, 0.0), Vec3::new(0.2, 1.0, 0.0)];
    /// let rope = Cloth::rope_along(points, 0.05, 0.01);
    /// assert_eq!(rope.surface(Vec3::ONE)?.len(), 65);
    /// # Ok::<(), bevy_drape::cloth::ClothError>(())
    /// ```
    pub fn rope_along(points: impl IntoIterator<Item = Vec3>, spacing: f32, radius: f32) -> Self {
        Self::of_shape(ClothShape::RopePath(RopePath {
            points: points.into_iter().collect(),
            spacing,
            radius,
        }))
    }

    /// A rope [along](Self::rope_along) the edges of a mesh without faces, as modelling programs export a chain of edges: a list or a strip of
    /// lines. It begins at the end whose vertex has the lower index.
    ///
    /// # Errors
    /// - [`RopeError::Topology`] for a mesh that is not of lines, and [`RopeError::Unpaired`] for half of a line.
    /// - [`RopeError::NoSuchVertex`] for an index beyond the vertices.
    /// - [`RopeError::NotAChain`] for edges that do not lead from one end to the other.
    /// - [`RopeError::Mesh`] for a mesh that can't be read.
    ///
    /// ```
    /// use bevy::prelude::*;
    /// use bevy_drape::prelude::*;
    ///
    /// /// A lanyard that was modelled, and is loading.
    /// #[derive(Resource)]
    /// struct Lanyard(Handle<Mesh>);
    ///
    /// fn spawn_once_loaded(lanyard: Res<Lanyard>, meshes: Res<Assets<Mesh>>, mut commands: Commands) -> Result {
    ///     if let Some(mesh) = meshes.get(&lanyard.0) {
    ///         commands.spawn(Cloth::rope_of(mesh, 0.02, 0.004)?);
    ///         commands.remove_resource::<Lanyard>();
    ///     }
    ///     Ok(())
    /// }
    ///
    /// fn add_to(app: &mut App) {
    ///     app.add_systems(Update, spawn_once_loaded.run_if(resource_exists::<Lanyard>));
    /// }
    /// # let _ = add_to;
    /// ```
    #[cfg(feature = "mesh")]
    pub fn rope_of(mesh: &bevy::mesh::Mesh, spacing: f32, radius: f32) -> Result<Self, RopeError> {
        Ok(Self::rope_along(path_of(mesh)?, spacing, radius))
    }

    /// The mesh of the entity's `Mesh3d`. The cloth waits for the asset, and draws itself with its own copy: other
    /// users of the asset see it unchanged.
    #[cfg(feature = "mesh")]
    pub const fn mesh() -> Self {
        let weld = Self::DEFAULT_WELD;
        Self::of_shape(ClothShape::Mesh { weld })
    }

    /// Triangles between `positions` (m), in the entity's frame.
    pub fn triangles(
        positions: impl IntoIterator<Item = Vec3>,
        triangles: impl IntoIterator<Item = [u32; 3]>,
    ) -> Self {
        Self::of_shape(ClothShape::Triangles {
            positions: positions.into_iter().collect(),
            triangles: triangles.into_iter().collect(),
            weld: Self::DEFAULT_WELD,
        })
    }

    const fn of_shape(shape: ClothShape) -> Self {
        Self {
            shape,
            unevenness: Self::DEFAULT_UNEVENNESS,
        }
    }

    /// Lays a grid out in the horizontal plane, facing up, and a rope along +x. A mesh keeps the shape of its asset, and a rope its path.
    pub const fn lying(mut self) -> Self {
        match &mut self.shape {
            ClothShape::Grid(grid) => grid.plane = ClothPlane::Lying,
            ClothShape::Rope(rope) => rope.plane = ClothPlane::Lying,
            _ => {}
        }
        self
    }

    /// Centres a grid or a rope on the entity's origin. A mesh keeps the shape of its asset, and a rope its path.
    pub const fn centred(mut self) -> Self {
        match &mut self.shape {
            ClothShape::Grid(grid) => grid.centred = true,
            ClothShape::Rope(rope) => rope.centred = true,
            _ => {}
        }
        self
    }

    /// Begins exactly at rest, without [`unevenness`](Self::unevenness): for tests and comparisons that need the
    /// symmetry.
    pub const fn flat(mut self) -> Self {
        self.unevenness = 0.0;
        self
    }

    /// Welds vertices of a mesh that are no farther apart than `distance` (m, before the transform's scale) into one
    /// particle. 0 welds only vertices at exactly the same position. Ignored by a grid and a rope.
    pub const fn welded(mut self, distance: f32) -> Self {
        match &mut self.shape {
            ClothShape::Triangles { weld, .. } => *weld = distance,
            #[cfg(feature = "mesh")]
            ClothShape::Mesh { weld } => *weld = distance,
            _ => {}
        }
        self
    }

    /// The shape of the grid, if the cloth is one.
    pub const fn as_grid(&self) -> Option<&GridShape> {
        match &self.shape {
            ClothShape::Grid(grid) => Some(grid),
            _ => None,
        }
    }

    /// (columns − 1) × spacing (m) of a grid; 0 for a mesh or a rope.
    pub fn width(&self) -> f32 {
        self.as_grid().map_or(0.0, |grid| grid.size().x)
    }

    /// (rows − 1) × spacing (m) of a grid; 0 for a mesh or a rope.
    pub fn height(&self) -> f32 {
        self.as_grid().map_or(0.0, |grid| grid.size().y)
    }

    /// Returns the validated grid under a transform's `scale`.
    ///
    /// # Errors
    /// [`GridError::NotAGrid`] for a mesh or a rope; otherwise those of [`GridShape::scaled`].
    pub fn grid(&self, scale: Vec3) -> Result<ClothGrid, GridError> {
        let grid = self.as_grid().ok_or(GridError::NotAGrid)?;
        grid.scaled(scale)
    }

    /// Returns the surface of a grid or of triangles under a transform's `scale`. For an asset, use
    /// [`Surface::of_mesh`].
    ///
    /// # Errors
    /// - Those of [`grid`](Self::grid) and [`Surface::of_mesh`], and of [`RopeShape::scaled`] for a rope.
    /// - [`MeshError::VertexNotFinite`] for a point of a rope's path that, scaled, is not finite or is beyond 10¹² m.
    /// - [`MeshError::NotLoaded`] for an asset.
    pub fn surface(&self, scale: Vec3) -> Result<Surface, ClothError> {
        self.shape.surface(scale)
    }

    /// Checks that the component's own values are in range.
    ///
    /// # Errors
    /// [`QuantityError`] for an unevenness out of range.
    pub fn validate(&self) -> Result<(), QuantityError> {
        let range = Allowed(|u| (0.0..=0.1).contains(&u), "from 0 to 0.1");
        range.check("unevenness (spacings)", [self.unevenness])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_an_unevenness_out_of_range() {
        for unevenness in [-0.1, 0.2, f32::NAN] {
            let cloth = Cloth {
                unevenness,
                ..Cloth::default()
            };
            assert!(cloth.validate().is_err());
        }
    }

    #[test]
    fn a_mesh_has_no_rows() {
        let kite = Cloth::triangles([Vec3::ZERO, Vec3::X, Vec3::Y], [[0, 1, 2]]);
        assert_eq!(kite.clone().lying().centred(), kite);
        assert_eq!(kite.grid(Vec3::ONE), Err(GridError::NotAGrid));
        assert_eq!(kite.width(), 0.0);
        assert_eq!(kite.surface(Vec3::ONE).map(|surface| surface.len()), Ok(3));
    }
}
