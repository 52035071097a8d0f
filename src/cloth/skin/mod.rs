//! Cloth that follows a skinned pose.

mod binding;
mod paint;

#[cfg(feature = "mesh")]
use bevy::mesh::{MeshVertexAttribute, VertexFormat};
use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::quantity::{Allowed, QuantityError};

pub use binding::SkinError;
pub(crate) use binding::Skinning;
pub use paint::{ClothPaint, PaintError, RestFunction};

/// Makes a cloth follow a skinned pose. It limits each particle's distance from the pose, and can stop particles from
/// passing behind it.
///
/// The pose is that of the entity's `SkinnedMesh`. A particle's position in it is Σ wⱼ Jⱼ Bⱼ x (linear blend skinning).
/// J are the joints' global transforms, B inverse bind poses, w weights, and x is the vertex position. The pose is read once a
/// tick and interpolated over the sub-steps. Without a `SkinnedMesh`, the pose is the cloth at rest in its entity's
/// frame.
///
/// Particles pinned by [`Pins`](crate::cloth::Pins) or by a max distance of 0 follow the pose exactly, and are drawn
/// where the joints are drawn. A cloth begins in the pose. The renderer does not skin it again: its mesh is a copy
/// without joints, and a `ClothSkeleton` replaces its `SkinnedMesh`.
///
/// # Painting
/// With feature `mesh`, [`painted`](Self::painted) reads the max distance, and the backstop if there is one, from two
/// float vertex attributes in metres. A glTF file calls them `_MAX_DISTANCE` and `_BACKSTOP`: Blender exports
/// attributes of these names (*Data, Mesh, Attributes*). Register them with Bevy's `GltfPlugin`:
///
/// ```no_run
/// use bevy::{gltf::GltfPlugin, prelude::*};
/// use bevy_drape::prelude::*;
///
/// let painted = GltfPlugin::default()
///     .add_custom_vertex_attribute("MAX_DISTANCE", ClothSkin::MAX_DISTANCE)
///     .add_custom_vertex_attribute("BACKSTOP", ClothSkin::BACKSTOP);
/// App::new().add_plugins((DefaultPlugins.set(painted), DrapePlugins::default())).run();
/// ```
///
/// [`ClothPaint::color`] reads a colour channel instead, and needs no registration.
///
/// ```
/// use bevy_drape::prelude::*;
///
/// // Pinned particles follow the skeleton; the rest is free.
/// let cape = ClothSkin::default();
/// // Black follows the skeleton, white moves up to 0.4 m away from it, and nothing gets 2 cm behind it.
/// let coat = ClothSkin::within(ClothPaint::color(0, 0.4)).with_backstop(0.02, 0.5);
/// # let _ = (cape, coat);
/// ```
#[derive(Component, Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothSkin {
    /// The largest distance of each particle from its position in the pose (m). 0 holds it there. Infinity, or anything
    /// beyond 10¹² m, leaves it free.
    pub max_distance: ClothPaint,
    /// A limit behind the pose that particles do not pass; `None` for no limit.
    pub backstop: Option<ClothBackstop>,
    /// The blend from the pose, at 0, to the simulation, at 1. In between, each max distance is multiplied by it; an
    /// infinite one counts as twice the cloth's diagonal.
    pub blend: f32,
    /// Motion of the pose in a tick above which it counts as a cut of the animation or a teleport (m), positive. The
    /// motion of any one position counts, without the motion that the cloth is [carried
    /// along](crate::plugin::ClothInertia) with. Each particle then jumps with its position in the pose, and gets no
    /// velocity from the jump.
    pub teleport_distance: f32,
}

/// A sphere behind each particle that the particle cannot enter. Its surface begins `distance` behind the particle's
/// position in the pose, against the normal there. Its centre is a `radius` farther back.
///
/// ```text
///        pose ── normal →          particles stay to the right of the arc
///  (    ● │
///   ball )│
///  (     ←→ distance
/// ```
#[derive(Reflect, Debug, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ClothBackstop {
    /// Distance of the sphere from the pose (m). Infinity, or anything beyond 10¹² m, gives a particle none.
    pub distance: ClothPaint,
    /// Radius of the sphere (m), positive: about the size of the body behind the cloth.
    pub radius: f32,
}

impl Default for ClothBackstop {
    /// A sphere of half a metre that begins at the pose.
    fn default() -> Self {
        Self {
            distance: ClothPaint::Uniform(0.0),
            radius: 0.5,
        }
    }
}

impl Default for ClothSkin {
    /// Pins follow the pose, and all other particles are free.
    fn default() -> Self {
        // Not infinity, for file formats that cannot store it.
        Self::within(f32::MAX)
    }
}

impl ClothSkin {
    /// Default of [`teleport_distance`](Self::teleport_distance) (m).
    pub const DEFAULT_TELEPORT_DISTANCE: f32 = 2.0;

    /// The attribute from which [`painted`](Self::painted) reads the max distance (m): `_MAX_DISTANCE` in a glTF file.
    #[cfg(feature = "mesh")]
    pub const MAX_DISTANCE: MeshVertexAttribute =
        MeshVertexAttribute::new("Cloth_MaxDistance", 0x0c10_7401, VertexFormat::Float32);

    /// The attribute of the backstop's distance (m): `_BACKSTOP` in a glTF file.
    #[cfg(feature = "mesh")]
    pub const BACKSTOP: MeshVertexAttribute =
        MeshVertexAttribute::new("Cloth_Backstop", 0x0c10_7402, VertexFormat::Float32);

    /// Limits each particle to its distance (m) from the pose.
    pub fn within(max_distance: impl Into<ClothPaint>) -> Self {
        Self {
            max_distance: max_distance.into(),
            backstop: None,
            blend: 1.0,
            teleport_distance: Self::DEFAULT_TELEPORT_DISTANCE,
        }
    }

    /// Reads max distances from the attribute [`MAX_DISTANCE`](Self::MAX_DISTANCE).
    #[cfg(feature = "mesh")]
    pub fn painted() -> Self {
        Self::within(ClothPaint::attribute(Self::MAX_DISTANCE.name, 0, 1.0))
    }

    /// Adds a backstop of a radius (m) that begins a distance (m) behind the pose.
    pub fn with_backstop(self, distance: impl Into<ClothPaint>, radius: f32) -> Self {
        let backstop = Some(ClothBackstop {
            distance: distance.into(),
            radius,
        });
        Self { backstop, ..self }
    }

    /// Adds a backstop of a radius (m) whose distances come from the attribute [`BACKSTOP`](Self::BACKSTOP).
    #[cfg(feature = "mesh")]
    pub fn with_painted_backstop(self, radius: f32) -> Self {
        self.with_backstop(ClothPaint::attribute(Self::BACKSTOP.name, 0, 1.0), radius)
    }

    /// Checks that the component's own values are in range.
    ///
    /// # Errors
    /// [`QuantityError`] for the first value that is out of range.
    pub fn validate(&self) -> Result<(), QuantityError> {
        Allowed::SHARE.check("the skin's blend", [self.blend])?;
        let positive = Allowed(|v| v > 0.0, "positive");
        positive.check("the skin's teleport distance (m)", [self.teleport_distance])?;
        if let Some(backstop) = &self.backstop {
            Allowed::POSITIVE.check("the backstop's radius (m)", [backstop.radius])?;
        }
        Ok(())
    }

    /// The blended max distance (m) of a particle, on a cloth of a diagonal (m).
    pub(crate) fn blended(&self, max_distance: f32, diagonal: f32) -> f32 {
        match self.blend {
            1.0 => max_distance,
            blend => blend * max_distance.min(2.0 * diagonal),
        }
    }
}
