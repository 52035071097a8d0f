//! The tools that a scene is made with.

use bevy::{ecs::system::SystemParam, prelude::*};

pub use crate::woven::Weave;
use crate::{stage::Grid, woven::woven};

/// The material of a mesh.
pub type Paint = MeshMaterial3d<StandardMaterial>;

/// Spawns entities, and makes their meshes and materials.
#[derive(SystemParam)]
pub struct Workshop<'w, 's> {
    pub commands: Commands<'w, 's>,
    pub grid: Res<'w, Grid>,
    meshes: ResMut<'w, Assets<Mesh>>,
    images: ResMut<'w, Assets<Image>>,
    materials: ResMut<'w, Assets<StandardMaterial>>,
}

impl Workshop<'_, '_> {
    pub fn mesh(&mut self, mesh: impl Into<Mesh>) -> Mesh3d {
        Mesh3d(self.meshes.add(mesh))
    }

    pub fn paint(&mut self, material: impl Into<StandardMaterial>) -> Paint {
        MeshMaterial3d(self.materials.add(material))
    }

    /// A colour that is as rough as asked, from 0 for a mirror to 1.
    pub fn rough(&mut self, color: Color, perceptual_roughness: f32) -> Paint {
        self.paint(StandardMaterial {
            base_color: color,
            perceptual_roughness,
            ..default()
        })
    }

    pub fn brass(&mut self, perceptual_roughness: f32) -> Paint {
        self.paint(StandardMaterial {
            base_color: Color::srgb(0.86, 0.62, 0.24),
            perceptual_roughness,
            metallic: 0.8,
            ..default()
        })
    }

    /// Fabric as of [`woven`].
    pub fn weave(
        &mut self,
        weave: Weave,
        times: u32,
        color: impl Fn(bool, u32) -> Color,
    ) -> StandardMaterial {
        woven(weave, &mut self.images, times, color)
    }

    /// The same, ready for use.
    pub fn fabric(
        &mut self,
        weave: Weave,
        times: u32,
        color: impl Fn(bool, u32) -> Color,
    ) -> Paint {
        let material = self.weave(weave, times, color);
        self.paint(material)
    }
}
