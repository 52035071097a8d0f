use bevy::prelude::*;
use bevy_drape::prelude::*;

fn mend(faults: Query<(Entity, &Name, &ClothFault), With<Cloth>>, mut commands: Commands) {
    for (entity, name, fault) in &faults {
        // sail: spacing (m) must be positive, not -0.1
        println!("{name}: {}", fault.error);
        // A correct value is enough: the fault goes, and the cloth comes back.
        commands.entity(entity).insert(Cloth::new(10, 10, 0.1));
    }
}
