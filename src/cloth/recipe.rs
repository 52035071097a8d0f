//! The component that says what a cloth is made from.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
    transform::components::Transform,
};

use super::{
    ClothError, ClothGrid, ClothMaterial, ClothParticles, ClothPlane, GridShape, Pins, Surface,
    TriangleMesh, presence::log_unsimulated,
};

/// A cloth: a grid of particles, or any triangle mesh.
///
/// Spawning this is enough. A grid of `columns` × `rows` particles, `spacing` metres apart, hangs by its top row from the
/// entity's [`Transform`], laid out from (0, 0, 0) to (width, −height, 0) in the entity's frame; [`lying`](Self::lying) lays
/// it out in the horizontal plane and [`centred`](Self::centred) around its transform. Particle (row, column) has the index
/// `row × columns + column` (paper, equation 1).
///
/// A mesh is cloth as it lies in its asset, and nothing of it is pinned unless [`Pins`] say so. With feature `mesh`, which is
/// on by default, `Cloth::mesh()` beside a `Mesh3d` takes that one's; [`triangles`](Self::triangles) takes positions and
/// triangles.
///
/// A grid, or triangles of its own, is never made from a `Mesh3d` beside it. The plugin draws the cloth in place of that one, logs it once,
/// and puts the `Mesh3d` back when this component is removed. For that mesh as cloth use `Cloth::mesh()`; to have the cloth drive it, put
/// it on another entity with a `ClothRenderMesh`.
///
/// Position, rotation and scale are respected at spawn; moved later, the transform carries the pinned particles along and the
/// others follow by their springs.
///
/// This component may change at any time. A grid that gets another resolution and stays the same rectangle, so that columns − 1 times the
/// spacing and rows − 1 times the spacing stay what they are, stays where it is and moves on as it did: so may a cloth become coarser
/// with its distance. Folds that are finer than the new spacing unfold, as fast as they are stretched out. Masses that the game gave to single particles are those of the material again. Any other change builds a new
/// cloth at rest.
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
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[component(on_add = log_unsimulated)]
#[require(ClothParticles, ClothMaterial, Pins, Transform)]
pub struct Cloth {
    /// What it is made from.
    pub shape: ClothShape,
    /// How far particles that are not pinned begin beside the surface, at most, in spacings: as real cloth, which is
    /// never flat. Without it nothing moves a flat cloth out of a vertical plane, and a flag stays a board. The same
    /// for the same cloth, and no part of its rest lengths. From 0 to 0.1.
    pub unevenness: f32,
}

/// What a [`Cloth`] is made from.
#[derive(Reflect, Debug, Clone, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ClothShape {
    /// A grid of particles.
    Grid(GridShape),
    /// Triangles that the game gives.
    Triangles {
        /// Vertices in the entity's frame (m), before the transform's scale.
        positions: Vec<Vec3>,
        /// Three vertices each, in either order.
        triangles: Vec<[u32; 3]>,
        /// Vertices no farther apart than this are one particle (m), before the transform's scale.
        weld: f32,
    },
    /// The entity's `Mesh3d`, once its asset has been loaded.
    #[cfg(feature = "mesh")]
    Mesh {
        /// Vertices no farther apart than this are one particle (m), before the transform's scale.
        weld: f32,
    },
}

impl Default for ClothShape {
    /// 16 × 16 particles, 0.1 m apart.
    fn default() -> Self {
        Cloth::default().shape
    }
}

impl Default for Cloth {
    /// 16 × 16 particles, 0.1 m apart.
    fn default() -> Self {
        Self::new(16, 16, 0.1)
    }
}

impl Cloth {
    /// What [`unevenness`](Self::unevenness) is by default: a hundredth of a millimetre in a cloth with 0.1 m between
    /// its particles.
    pub const DEFAULT_UNEVENNESS: f32 = 1.0e-4;

    /// How near vertices of a mesh are that are one particle by default (m, before the transform's scale): those that a
    /// modelling program splits along seams are in exactly the same place.
    pub const DEFAULT_WELD: f32 = 1.0e-5;

    /// A cloth of `columns` × `rows` particles, `spacing` metres apart, hanging from its transform.
    pub const fn new(columns: u32, rows: u32, spacing: f32) -> Self {
        Self::of_shape(ClothShape::Grid(GridShape {
            columns,
            rows,
            spacing,
            plane: ClothPlane::Hanging,
            centred: false,
        }))
    }

    /// The mesh of the entity's `Mesh3d`. It waits for the asset, is built from it, and draws it where the cloth is, in a mesh
    /// of its own: others who use the asset see it as it was.
    #[cfg(feature = "mesh")]
    pub const fn mesh() -> Self {
        Self::of_shape(ClothShape::Mesh {
            weld: Self::DEFAULT_WELD,
        })
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

    /// A grid laid out in the horizontal plane, facing up. A mesh lies as it does in its asset.
    pub const fn lying(mut self) -> Self {
        if let ClothShape::Grid(grid) = &mut self.shape {
            grid.plane = ClothPlane::Lying;
        }
        self
    }

    /// A grid with its middle at the entity's origin. A mesh lies as it does in its asset.
    pub const fn centred(mut self) -> Self {
        if let ClothShape::Grid(grid) = &mut self.shape {
            grid.centred = true;
        }
        self
    }

    /// Exactly as it is at rest: for tests and comparisons that need its symmetry.
    pub const fn flat(mut self) -> Self {
        self.unevenness = 0.0;
        self
    }

    /// With vertices of a mesh no farther apart than `distance` (m, before the transform's scale) as one particle; 0 for
    /// those in exactly the same place. A grid has none.
    pub const fn welded(mut self, distance: f32) -> Self {
        match &mut self.shape {
            ClothShape::Grid(_) => {}
            ClothShape::Triangles { weld, .. } => *weld = distance,
            #[cfg(feature = "mesh")]
            ClothShape::Mesh { weld } => *weld = distance,
        }
        self
    }

    /// The grid that it is made from, if it is one.
    pub const fn as_grid(&self) -> Option<&GridShape> {
        match &self.shape {
            ClothShape::Grid(grid) => Some(grid),
            _ => None,
        }
    }

    /// (columns − 1) × spacing (m) of a grid; 0 of a mesh.
    pub fn width(&self) -> f32 {
        self.as_grid().map_or(0.0, |grid| grid.size().x)
    }

    /// (rows − 1) × spacing (m) of a grid; 0 of a mesh.
    pub fn height(&self) -> f32 {
        self.as_grid().map_or(0.0, |grid| grid.size().y)
    }

    /// The checked grid under a transform's `scale`; of a mesh there is none.
    ///
    /// # Errors
    /// Too few or too many particles; a spacing that is zero, negative, not finite, below 10⁻⁹ m, or of a cloth
    /// larger than 10¹² m; [`ClothError::NotAGrid`].
    pub fn grid(&self, scale: Vec3) -> Result<ClothGrid, ClothError> {
        let grid = self.as_grid().ok_or(ClothError::NotAGrid)?;
        grid.scaled(scale)
    }

    /// The surface of a grid or of triangles under a transform's `scale`; [`Surface::of_mesh`] makes that of an asset.
    ///
    /// # Errors
    /// As [`grid`](Self::grid) and [`Surface::of_mesh`] have them; [`ClothError::MeshNotLoaded`] of an asset's.
    pub fn surface(&self, scale: Vec3) -> Result<Surface, ClothError> {
        match &self.shape {
            ClothShape::Grid(grid) => grid.scaled(scale).map(|grid| Surface::of_grid(&grid)),
            ClothShape::Triangles {
                positions,
                triangles,
                weld,
            } => {
                let mesh = TriangleMesh {
                    positions: positions.clone(),
                    triangles: triangles.clone(),
                    ..TriangleMesh::default()
                };
                Surface::of_mesh(&mesh, *weld, scale)
            }
            #[cfg(feature = "mesh")]
            ClothShape::Mesh { .. } => Err(ClothError::MeshNotLoaded),
        }
    }

    /// Whether its own values are in their ranges.
    ///
    /// # Errors
    /// [`ClothError::Quantity`] for an unevenness that is not.
    pub fn validate(&self) -> Result<(), ClothError> {
        let range = |u: f32| (0.0..=0.1).contains(&u);
        ClothError::check(
            self.unevenness,
            range,
            "unevenness (spacings)",
            "from 0 to 0.1",
        )?;
        Ok(())
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
            assert!(matches!(cloth.validate(), Err(ClothError::Quantity { .. })));
        }
    }

    #[test]
    fn a_mesh_has_no_rows() {
        let kite = Cloth::triangles([Vec3::ZERO, Vec3::X, Vec3::Y], [[0, 1, 2]]);
        assert_eq!(kite.clone().lying().centred(), kite);
        assert_eq!(kite.grid(Vec3::ONE), Err(ClothError::NotAGrid));
        assert_eq!(kite.width(), 0.0);
        assert_eq!(kite.surface(Vec3::ONE).map(|surface| surface.len()), Ok(3));
    }
}
