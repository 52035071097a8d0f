//! A line of figures in the picture's upper right corner, in a window and in a saved picture alike.

use bevy::prelude::*;

/// How far in front of the camera the text is (m): nearer than anything else.
const DISTANCE: f32 = 0.3;
/// Height of its letters, in parts of the picture's height.
const HEIGHT: f32 = 0.034;

/// What is written, a line each, and whether it is as it should be.
#[derive(Resource, Default)]
pub struct Figure {
    pub lines: Vec<String>,
    pub is_good: bool,
}

/// Writes the [`Figure`].
pub struct FigurePlugin;

impl Plugin for FigurePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Figure>().add_systems(
            PostUpdate,
            // As the camera is in this frame.
            write.after(TransformSystems::Propagate),
        );
    }
}

fn write(
    figure: Res<Figure>,
    camera: Single<(&GlobalTransform, &Projection), With<Camera3d>>,
    mut gizmos: Gizmos,
) {
    let (camera, Projection::Perspective(lens)) = *camera else {
        return;
    };
    // Blue and orange: told apart by everybody.
    let color = if figure.is_good {
        Color::srgb(0.05, 0.25, 0.45)
    } else {
        Color::srgb(0.75, 0.30, 0.0)
    };
    let half = DISTANCE * (0.5 * lens.fov).tan();
    let size = 2.0 * HEIGHT * half;
    let corner = Vec3::new(half * lens.aspect_ratio - size, half - size, -DISTANCE);
    for (number, line) in figure.lines.iter().enumerate() {
        let place = camera.transform_point(corner - 1.5 * size * number as f32 * Vec3::Y);
        let place = Isometry3d::new(place, camera.rotation());
        // By its upper right corner.
        gizmos.text(place, line, size, Vec2::splat(0.5), color);
    }
}
