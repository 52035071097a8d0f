//! Floor 0: the definition of a cloth: its surface, particles, springs, material and pins.

mod arrays;
mod cut;
mod error;
mod function;
mod grain;
mod grid;
mod grouped;
mod lanes;
mod limits;
mod lines;
mod material;
mod material_map;
mod particle_id;
mod particles;
mod pins;
mod presence;
mod quantity;
mod recipe;
mod rope;
#[cfg(feature = "mesh")]
mod rope_mesh;
mod sewing;
mod skin;
mod spring;
mod springs;
mod stress;
mod surface;
mod tearing;
mod tears;

pub(crate) use arrays::MapInline;
#[cfg(feature = "mesh")]
pub(crate) use arrays::sorted;
pub use error::{
    BoundsError, ClothError, SelfCollisionError, ShapeError, TargetError, TransformError,
};
pub use grain::ClothGrain;
#[doc(hidden)]
pub use grid::ClothGrid;
pub use grid::{ClothPlane, GridError, GridShape};
pub use limits::MAX_PARTICLES;
pub use material::{ClothMaterial, ClothStiffening, ClothWeft};
pub use material_map::{ClothFactor, ClothMaterialMap};
pub use particle_id::ParticleId;
pub use particles::{ClothParticles, ParticleError};
pub use pins::{Corner, Pin, PinError, PinPredicate, Pins, RestPredicate};
pub(crate) use quantity::Allowed;
pub use quantity::QuantityError;
pub use recipe::{Cloth, ClothShape};
pub use rope::{RopePath, RopeShape};
#[cfg(feature = "mesh")]
pub use rope_mesh::RopeError;
pub use skin::{ClothBackstop, ClothPaint, ClothSkin, PaintError, RestFunction, SkinError};
#[doc(hidden)]
pub use spring::{Spring, SpringKind};
pub use springs::SpringError;
#[doc(hidden)]
pub use springs::Springs;
#[doc(hidden)]
pub use surface::SurfaceBinding;
pub use surface::{
    GrainError, MAX_MESH_PARTICLES, MeshError, Spacing, Surface, TearError, TriangleMesh,
    VertexAttribute,
};
pub use tearing::ClothTearing;
pub use tears::ClothTears;

pub(crate) use cut::Cut;
pub(crate) use grouped::Grouped;
pub(crate) use lanes::{
    Block, DX, DY, DZ, LANES, Lanes, Layout, Run, Slot, View, W, X, Y, Z, larger, larger_or_nan,
    smaller,
};
pub(crate) use limits::FARTHEST;
pub(crate) use material::Woven;
pub(crate) use material_map::{MaterialFactors, ThicknessFactors};
pub(crate) use particles::{DensityFactors, Earlier, Load, StepKind};
pub(crate) use presence::ClothPresence;
pub(crate) use sewing::{SewnSide, Stitch, stitches};
pub(crate) use skin::Skinning;
pub(crate) use springs::{Compliances, SpringList, SpringStorage, StiffnessFactors};
pub(crate) use surface::{Chain, Fan, Fans, Flat, Graph, ShortestPaths, StencilKind};
#[cfg(feature = "mesh")]
pub(crate) use surface::{JointWeights, add_face_normals, same_places, skin_of_asset};
pub(crate) use tearing::{Strength, TearSearch};
