//! How a cloth follows its skinned pose.

mod binding;
mod paint;

#[cfg(feature = "mesh")]
use bevy::mesh::{MeshVertexAttribute, VertexFormat};
use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::ClothError;

pub(crate) use binding::Skinning;
pub use paint::{ClothPaint, RestFunction};

/// Has a cloth follow a pose: how far each particle may be from where that has it, and what it may not pass behind.
///
/// The pose is that of the entity's `SkinnedMesh`: a particle's place in it is Σ wⱼ Jⱼ Bⱼ x, with joints' global transforms J,
/// inverse bind poses B, weights w, and x the vertex in the mesh (linear blend skinning). It is read once a tick, and moves
/// smoothly over the sub-steps. Without a `SkinnedMesh` the pose is the cloth at rest, where its entity is.
///
/// Particles that are pinned, by [`Pins`](crate::cloth::Pins) or by a max distance of 0, are in the pose exactly, and are drawn
/// where the joints are drawn. A cloth begins in the pose. The renderer does not skin it again: its mesh is a copy without joints, and
/// a `ClothSkeleton` stands in place of its `SkinnedMesh`.
///
/// # Painting
/// With feature `mesh`, [`painted`](Self::painted) takes the max distance and, where there is one, the backstop from two vertex
/// attributes of floats, in metres: `_MAX_DISTANCE` and `_BACKSTOP` in a glTF file, as Blender exports attributes of these
/// names (*Data, Mesh, Attributes*). They have to be registered with Bevy's `GltfPlugin`:
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
/// [`ClothPaint::color`] takes a colour channel in their place, which needs no registration.
///
/// ```
/// use bevy_drape::prelude::*;
///
/// // What is pinned follows the skeleton; the rest is free.
/// let cape = ClothSkin::default();
/// // Black follows the skeleton, white is up to 0.4 m away from it, and nothing gets 2 cm behind it.
/// let coat = ClothSkin::within(ClothPaint::color(0, 0.4)).with_backstop(0.02, 0.5);
/// # let _ = (cape, coat);
/// ```
#[derive(Component, Reflect, Debug, Clone, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothSkin {
    /// How far each particle may be from its place in the pose (m): 0 holds it there; infinity, or anything
    /// beyond 10¹² m, leaves it free.
    pub max_distance: ClothPaint,
    /// What particles stay in front of, if anything.
    pub backstop: Option<ClothBackstop>,
    /// How much of the simulation there is, from 0, the pose exactly, to 1. Between them each max distance is multiplied with
    /// it, an infinite one taken as twice the cloth's diagonal.
    pub blend: f32,
    /// If any place of the pose moves farther than this in a tick (m), more than the cloth is [carried
    /// along](crate::plugin::ClothInertia), that is a cut of the animation, or a teleport, and no motion: each particle is then
    /// at once where it was, as seen from its place in the pose, and gets no speed from the jump. Positive.
    pub teleport_distance: f32,
}

/// A ball behind each particle that it stays out of: its surface begins `distance` behind the particle's place in the pose,
/// against the normal there, and its centre is a `radius` farther.
///
/// ```text
///        pose ── normal →          particles stay to the right of the arc
///  (    ● │
///   ball )│
///  (     ←→ distance
/// ```
#[derive(Reflect, Debug, Clone, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ClothBackstop {
    /// How far behind the pose it begins (m); likewise infinity for particles that have none.
    pub distance: ClothPaint,
    /// Radius of the ball (m), positive: about as large as what is behind the cloth.
    pub radius: f32,
}

impl Default for ClothBackstop {
    /// A ball of half a metre, which begins at the pose.
    fn default() -> Self {
        Self {
            distance: ClothPaint::Uniform(0.0),
            radius: 0.5,
        }
    }
}

impl Default for ClothSkin {
    /// Pins follow the pose, and all else is free.
    fn default() -> Self {
        // Not infinity, for files that can't hold it.
        Self::within(f32::MAX)
    }
}

impl ClothSkin {
    /// How far a pose moves in a tick (m) by default that jumps.
    pub const DEFAULT_TELEPORT_DISTANCE: f32 = 2.0;

    /// The attribute that [`painted`](Self::painted) takes the max distance from (m): `_MAX_DISTANCE` in a glTF file.
    #[cfg(feature = "mesh")]
    pub const MAX_DISTANCE: MeshVertexAttribute =
        MeshVertexAttribute::new("Cloth_MaxDistance", 0x0c10_7401, VertexFormat::Float32);

    /// Likewise of the backstop: `_BACKSTOP`.
    #[cfg(feature = "mesh")]
    pub const BACKSTOP: MeshVertexAttribute =
        MeshVertexAttribute::new("Cloth_Backstop", 0x0c10_7402, VertexFormat::Float32);

    /// Each particle stays within its distance (m) from the pose.
    pub fn within(max_distance: impl Into<ClothPaint>) -> Self {
        Self {
            max_distance: max_distance.into(),
            backstop: None,
            blend: 1.0,
            teleport_distance: Self::DEFAULT_TELEPORT_DISTANCE,
        }
    }

    /// Max distances as they are painted in the attribute [`MAX_DISTANCE`](Self::MAX_DISTANCE).
    #[cfg(feature = "mesh")]
    pub fn painted() -> Self {
        Self::within(ClothPaint::attribute(Self::MAX_DISTANCE.name, 0, 1.0))
    }

    /// With a backstop that begins a distance behind the pose (m), of a radius (m).
    pub fn with_backstop(self, distance: impl Into<ClothPaint>, radius: f32) -> Self {
        let backstop = Some(ClothBackstop {
            distance: distance.into(),
            radius,
        });
        Self { backstop, ..self }
    }

    /// With a backstop as it is painted in the attribute [`BACKSTOP`](Self::BACKSTOP), of a radius (m).
    #[cfg(feature = "mesh")]
    pub fn with_painted_backstop(self, radius: f32) -> Self {
        self.with_backstop(ClothPaint::attribute(Self::BACKSTOP.name, 0, 1.0), radius)
    }

    /// Whether its own values are in their ranges.
    ///
    /// # Errors
    /// [`ClothError::Quantity`] for the first that is not.
    pub fn validate(&self) -> Result<(), ClothError> {
        let share = |v: f32| (0.0..=1.0).contains(&v);
        ClothError::check(self.blend, share, "the skin's blend", "from 0 to 1")?;
        let positive = |v: f32| v > 0.0;
        ClothError::check(
            self.teleport_distance,
            positive,
            "the skin's teleport distance (m)",
            "positive",
        )?;
        if let Some(backstop) = &self.backstop {
            ClothError::check(
                backstop.radius,
                |v| v > 0.0 && v.is_finite(),
                "the backstop's radius (m)",
                "positive and finite",
            )?;
        }
        Ok(())
    }

    /// How far a particle may be from its place in the pose (m), of a cloth of a diagonal (m), by its max distance.
    pub(crate) fn blended(&self, max_distance: f32, diagonal: f32) -> f32 {
        if self.blend == 1.0 {
            max_distance
        } else {
            self.blend * max_distance.min(2.0 * diagonal)
        }
    }
}
