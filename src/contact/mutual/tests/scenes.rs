//! No triangles intersect, in any tick.

use bevy::math::Vec3;

use super::{Scene, Sheeted, floor, turned};

#[test]
fn a_sheet_that_drops_into_a_pile_does_not_pass_through_itself() {
    let wavy = |at: Vec3| {
        let ripple = 0.02 * (9.0 * at.z).sin() + 0.01 * (7.0 * at.x).cos();
        Vec3::new(at.x, at.z + 0.6, ripple)
    };
    let mut scene = Scene::new(vec![Sheeted::new(24, 1.0, wavy)], 0.008);
    for tick in 0..180 {
        let start = std::time::Instant::now();
        scene.tick(|_, particles, _| floor(particles));
        if tick % 20 == 19 {
            println!(
                "{tick}: {} intersect, {} pairs, {} close, {} searches, zones {}, {:.2} m/s, {:.2} ms",
                scene.worst,
                scene.contact.pairs(),
                scene.contact.close(),
                scene.contact.searches(),
                scene.contact.has_zones(),
                scene.largest_speed(),
                start.elapsed().as_secs_f64() * 1.0e3,
            );
        }
    }
    assert_eq!(scene.worst, 0);
}

#[test]
fn sheets_that_fall_on_each_other_stay_apart() {
    let sheets = (0..10).map(|index| {
        Sheeted::new(16, 0.6, move |at| {
            turned(Vec3::Y * 0.13 * index as f32, at) + Vec3::Y * (0.02 + 0.03 * index as f32)
        })
    });
    let mut scene = Scene::new(sheets.collect(), 0.006);
    for tick in 0..240 {
        let start = std::time::Instant::now();
        scene.tick(|_, particles, _| floor(particles));
        if tick % 20 == 19 {
            println!(
                "{tick}: {} intersect, {} pairs, {} close, {} searches, zones {}, {:.3} m/s, {:.2} ms",
                scene.worst,
                scene.contact.pairs(),
                scene.contact.close(),
                scene.contact.searches(),
                scene.contact.has_zones(),
                scene.largest_speed(),
                start.elapsed().as_secs_f64() * 1.0e3,
            );
        }
    }
    assert_eq!(scene.worst, 0);
}
