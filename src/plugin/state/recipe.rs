//! The inputs of a surface.

use std::sync::Arc;

use bevy::math::Vec3;
#[cfg(feature = "mesh")]
use bevy::prelude::{AssetId, Mesh};

use crate::cloth::{ClothError, ClothGrain, ClothShape, ClothTears, Surface, TriangleMesh};

/// The inputs of a surface.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Recipe {
    /// Shared, as a mesh of the game's is long to copy and to compare.
    pub shape: KnownShape,
    pub scale: Vec3,
    /// The mesh, if it is made from an asset.
    pub source: Option<Source>,
    /// The grain of a mesh with a weft.
    pub grain: Option<ClothGrain>,
    pub tears: ClothTears,
    /// Whether a grid without tears has the surface of a mesh.
    pub as_mesh: bool,
}

impl Recipe {
    /// Whether it has a NaN, which is unlike itself.
    pub fn has_nan(&self) -> bool {
        let same = self;
        let shape = &*same.shape.0;
        self != same || *self.shape.0 != *shape
    }

    /// The surface with its grain and its tears: of `mesh`, if it is made from an asset.
    ///
    /// # Errors
    /// Those of [`ClothShape::surface`], [`ClothGrain::apply`] and [`Surface::torn`].
    pub fn surface(&self, mesh: &TriangleMesh) -> Result<Surface, ClothError> {
        let surface = match *self.shape.0 {
            #[cfg(feature = "mesh")]
            ClothShape::Mesh { weld } => Surface::of_mesh(mesh, weld, self.scale)?,
            _ => self.shape.0.surface(self.scale)?,
        };
        let surface = match &self.grain {
            Some(grain) => grain.apply(surface, mesh)?,
            None => surface,
        };
        if self.tears.edges().is_empty() && !self.as_mesh {
            return Ok(surface);
        }
        self.opened(Arc::new(surface))
    }

    /// The whole surface, with its tears, or as a mesh.
    ///
    /// # Errors
    /// Those of [`Surface::torn`].
    pub fn opened(&self, whole: Arc<Surface>) -> Result<Surface, ClothError> {
        match self.tears.edges() {
            [] if !self.as_mesh => Ok((*whole).clone()),
            edges => Ok(whole.torn(edges)?),
        }
    }
}

/// A shape that many recipes share. One with a NaN is like itself, unlike a [`ClothShape`].
#[derive(Debug, Clone)]
pub(crate) struct KnownShape(pub Arc<ClothShape>);

impl PartialEq for KnownShape {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0 == other.0
    }
}

/// A mesh, and how often it had been changed.
#[cfg(feature = "mesh")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Source {
    pub mesh: AssetId<Mesh>,
    pub version: u32,
}

/// Without Bevy's meshes there is none.
#[cfg(not(feature = "mesh"))]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Source {}
