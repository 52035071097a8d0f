//! No triangles intersect, in any tick.

use bevy::math::Vec3;

use super::{Scene, Sheeted, floor, turned};

#[test]
fn a_sheet_that_drops_into_a_pile_does_not_pass_through_itself() {
    let wavy = |at: Vec3| {
        let ripple = 0.02 * (9.0 * at.z).sin() + 0.01 * (7.0 * at.x).cos();
        Vec3::new(at.x, at.z + 0.55, ripple)
    };
    let mut scene = Scene::new(vec![Sheeted::new(20, 1.0, wavy)], 0.008);
    for _ in 0..60 {
        scene.tick(|_, particles, _| floor(particles));
    }
    assert_eq!(scene.worst, 0);
    assert!(scene.contact.pairs() > 100, "it lies on itself");
}

#[test]
fn sheets_that_fall_on_each_other_stay_apart() {
    let sheets = (0..4).map(|index| {
        Sheeted::new(12, 0.6, move |at| {
            turned(Vec3::Y * 0.13 * index as f32, at) + Vec3::Y * (0.02 + 0.03 * index as f32)
        })
    });
    let mut scene = Scene::new(sheets.collect(), 0.006);
    for _ in 0..60 {
        scene.tick(|_, particles, _| floor(particles));
    }
    assert_eq!(scene.worst, 0);
    assert!(scene.contact.near() > 30, "they lie on each other");
}
