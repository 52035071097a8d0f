use bevy::prelude::*;
use bevy_drape::prelude::*;

fn fan(mut commands: Commands) {
    // It reaches 3 m, within 0.3 rad of its forward direction, and blows at 6 m/s.
    commands.spawn((ClothWindZone::fan(3.0, 0.3, 6.0), Transform::from_xyz(0.0, 1.0, 2.0)));
}

#[derive(Component)]
struct InVehicle(Vec3);

fn ride(mut cloths: Query<(&InVehicle, &mut ClothAir)>) {
    for (vehicle, mut air) in &mut cloths {
        air.velocity = Some(vehicle.0);
    }
}
