use bevy::prelude::*;
use bevy_drape::prelude::*;

fn main() {
    App::new()
        .add_plugins((MinimalPlugins, DrapePlugins::default()))
        .add_systems(Startup, setup)
        .add_systems(FixedPostUpdate, report)
        .run();
}

fn setup(mut commands: Commands) {
    // A sheet of 24 × 24 particles, 5 cm apart, lies in the air. Nothing holds it.
    let sheet = Cloth::new(24, 24, 0.05).lying().centred();
    commands.spawn((Name::new("sheet"), sheet, Pins::none(), Transform::from_xyz(0.0, 1.2, 0.0)));
    // A ball of radius 0.4 m is beneath it.
    commands.spawn((ClothCollider::ball(0.4), Transform::from_xyz(0.0, 0.6, 0.0)));
}

fn report(cloth: Single<(&ClothParticles, &ClothFrame)>) {
    let (particles, frame) = *cloth;
    // Particles are in the cloth's own frame, in metres: here row 12, column 12.
    if let Some(middle) = particles.position((12, 12)) {
        println!("its middle is at {}", frame.to_world(middle));
    }
}
