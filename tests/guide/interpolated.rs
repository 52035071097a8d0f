use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_transform_interpolation::prelude::*;

fn body(mut commands: Commands) {
    // With `TransformInterpolationPlugin` in the app.
    commands.spawn((ClothCollider::ball(0.3), TransformInterpolation, Transform::default()));
}
