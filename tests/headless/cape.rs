//! A cape on the shoulders of a body that jumps.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::support::*;

/// A body of a capsule with a ball for its head jumps 1 m and comes down three times as fast as in free fall, as games move it. So the
/// cape goes over the head, with or without friction. Ten seconds later it hangs behind the body again, all of it below its pins,
/// and lies on nothing.
#[test]
fn a_cape_comes_down_after_a_jump() {
    for (friction, head) in [(0.4, 0.16), (0.4, 0.12), (0.0, 0.16)] {
        let mut app = app();
        let world = app.world_mut();
        let body = world.spawn(Transform::default()).id();
        world.spawn((
            ClothCollider::capsule(0.16, 0.9),
            Transform::from_xyz(0.0, 0.9, 0.0),
            ChildOf(body),
        ));
        world.spawn((
            ClothCollider::ball(head),
            Transform::from_xyz(0.0, 1.65, 0.0),
            ChildOf(body),
        ));
        let material = ClothMaterial {
            friction,
            ..default()
        };
        let (shoulders, behind) = (1.45, -0.1);
        let cape = (
            Cloth::new(20, 24, 0.5 / 19.0),
            Pins::none(),
            material,
            ClothAttachments::new([(Pin::Row(0), body)]),
            Transform::from_xyz(-0.25, shoulders, behind),
        );
        let cape = world.spawn(cape).id();
        tick(&mut app, 64);
        let (mut height, mut speed, mut highest) = (0.0, (6.0 * GRAVITY).sqrt(), 0);
        let above = |app: &App, height: f32| {
            let frame: &ClothFrame = app.world().get(cape).expect("a frame");
            let positions = particles(app, cape).positions();
            let above = positions.filter(|at| frame.to_world(*at).y > height + shoulders + 0.05);
            above.count()
        };
        for _ in 0..64 * 11 {
            height = f32::max(height + speed * TICK, 0.0);
            speed = if height > 0.0 {
                speed - 3.0 * GRAVITY * TICK
            } else {
                0.0
            };
            change::<Transform>(&mut app, body, |place| place.translation.y = height);
            tick(&mut app, 1);
            highest = highest.max(above(&app, height));
        }
        assert!(highest > 100, "it goes over the head: {highest}");
        assert_eq!(above(&app, 0.0), 0, "μ {friction}, head {head}");
        assert!(particles(&app, cape).largest_speed() < 0.2);
    }
}
