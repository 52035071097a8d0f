//! How particles to pin are named.

use std::{fmt, sync::Arc};

use bevy::{
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

/// A corner of the cloth at rest, seen from where it faces: +z, of a lying cloth +y.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum Corner {
    /// (0, 0).
    #[default]
    TopLeft,
    /// (0, columns − 1).
    TopRight,
    /// (rows − 1, 0).
    BottomLeft,
    /// (rows − 1, columns − 1).
    BottomRight,
}

/// Particles to pin.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Pin {
    /// The particle with this index.
    Index(usize),
    /// The particle at (row, column).
    Cell(u32, u32),
    /// A whole row, 0 at the top.
    Row(u32),
    /// A whole column, 0 at the left.
    Column(u32),
    /// One corner.
    Corner(Corner),
    /// Every particle whose (row, column) it holds for. Code can't be saved: in a scene file it pins nothing.
    Where(#[reflect(ignore)] PinPredicate),
    /// The top row of a grid, and nothing of a mesh: what is pinned unless said otherwise.
    #[default]
    Top,
    /// The particle of this vertex of the mesh, as its asset or the game numbers them: it outlasts welding.
    Vertex(usize),
    /// Every particle that is no farther at rest than a radius from a point.
    Near {
        /// In the entity's frame (m), before the transform's scale, as a mesh's vertices are.
        point: Vec3,
        /// Likewise (m).
        radius: f32,
    },
    /// Every particle whose place at rest it holds for. Code can't be saved: in a scene file it pins nothing.
    AtRest(#[reflect(ignore)] RestPredicate),
    /// Every particle with a vertex whose attribute is above a value: what an artist painted.
    Attribute {
        /// The name of the attribute: `Vertex_Color`, or as the game registered a custom one with `GltfPlugin`.
        name: String,
        /// Which of its channels, from 0.
        channel: usize,
        /// The value that it has to exceed.
        above: f32,
    },
}

/// Whether the particle at (row, column) is pinned. By default none is.
#[derive(Clone)]
pub struct PinPredicate(Arc<dyn Fn(u32, u32) -> bool + Send + Sync>);

impl PinPredicate {
    /// Every particle whose (row, column) `holds`.
    pub fn new(holds: impl Fn(u32, u32) -> bool + Send + Sync + 'static) -> Self {
        Self(Arc::new(holds))
    }

    pub(super) fn holds(&self, row: u32, column: u32) -> bool {
        (self.0)(row, column)
    }
}

/// Whether the particle is pinned that is at a place at rest, in the entity's frame (m), before the transform's scale. By
/// default none is.
#[derive(Clone)]
pub struct RestPredicate(Arc<dyn Fn(Vec3) -> bool + Send + Sync>);

impl RestPredicate {
    /// Every particle whose place at rest `holds`.
    pub fn new(holds: impl Fn(Vec3) -> bool + Send + Sync + 'static) -> Self {
        Self(Arc::new(holds))
    }

    pub(super) fn holds(&self, place: Vec3) -> bool {
        (self.0)(place)
    }
}

impl Default for RestPredicate {
    fn default() -> Self {
        Self::new(|_| false)
    }
}

impl fmt::Debug for RestPredicate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("..")
    }
}

impl PartialEq for RestPredicate {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Default for PinPredicate {
    fn default() -> Self {
        Self::new(|_, _| false)
    }
}

impl fmt::Debug for PinPredicate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("..")
    }
}

impl PartialEq for PinPredicate {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Pin {
    /// Every particle whose (row, column) `holds`.
    pub fn filter(holds: impl Fn(u32, u32) -> bool + Send + Sync + 'static) -> Self {
        Self::Where(PinPredicate::new(holds))
    }

    /// Every particle whose place at rest `holds`, in the entity's frame (m), before the transform's scale.
    pub fn at_rest(holds: impl Fn(Vec3) -> bool + Send + Sync + 'static) -> Self {
        Self::AtRest(RestPredicate::new(holds))
    }

    /// Every particle with a vertex whose colour is above a value in a channel: 0 for red, 3 for alpha.
    pub fn color(channel: usize, above: f32) -> Self {
        Self::attribute("Vertex_Color", channel, above)
    }

    /// Every particle with a vertex whose attribute is above a value in a channel, from 0.
    pub fn attribute(name: impl Into<String>, channel: usize, above: f32) -> Self {
        Self::Attribute {
            name: name.into(),
            channel,
            above,
        }
    }
}
