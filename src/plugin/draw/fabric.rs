//! The look of fabric.

use bevy::{color::Color, pbr::StandardMaterial};

/// A matt material that is lit and visible from both sides, as cloth needs. Add textures as to any other:
/// `StandardMaterial { base_color_texture: Some(image), ..fabric(Color::WHITE) }`.
///
/// ```no_run
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// fn setup(mut commands: Commands, mut materials: ResMut<Assets<StandardMaterial>>) {
///     let red = materials.add(fabric(Color::srgb(0.7, 0.1, 0.15)));
///     commands.spawn((Cloth::new(32, 32, 0.05), MeshMaterial3d(red)));
/// }
/// ```
pub fn fabric(color: impl Into<Color>) -> StandardMaterial {
    StandardMaterial {
        base_color: color.into(),
        perceptual_roughness: 0.9,
        reflectance: 0.2,
        double_sided: true,
        cull_mode: None,
        ..Default::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_seen_and_lit_from_both_sides() {
        let material = fabric(Color::WHITE);
        assert!(material.double_sided && material.cull_mode.is_none());
    }
}
