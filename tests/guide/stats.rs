use bevy::prelude::*;
use bevy_drape::prelude::*;

fn report(cloths: Query<(&Name, &ClothStats)>) {
    for (name, stats) in &cloths {
        println!(
            "{name}: {} sub-steps, {:.2} ms, stretched by {:.1} %, asleep: {}",
            stats.substeps,
            stats.integrate_ms,
            100.0 * stats.stretch.structural,
            stats.is_asleep
        );
    }
}
