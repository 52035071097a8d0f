//! Cloth whose layers are more work than a tick has.

use bevy::math::Vec3;

use super::{Scene, Sheeted, floor, turned};
use crate::contact::layers::MOST_STOPPED;

/// A sheet above the floor, on its edge, leaning a little.
fn upright(thickness: f32, angles: Vec3) -> Scene {
    let place = move |at: Vec3| turned(angles + 1.5 * Vec3::X, at) + 0.45 * Vec3::Y;
    Scene::new(vec![Sheeted::new(16, 0.8, place)], thickness)
}

fn places(scene: &Scene) -> Vec<Vec3> {
    scene.cloths[0].particles.positions().collect()
}

fn height(scene: &Scene) -> f32 {
    let places = places(scene);
    places.iter().map(|place| place.y).sum::<f32>() / places.len() as f32
}

/// A sheet that crumples has too much work in some of its ticks: then it stays where it was apart. It never passes through
/// itself, and lies on the floor at last.
#[test]
fn cloth_with_too_much_work_does_not_pass() {
    for (angles, work) in [
        (Vec3::new(0.1, 0.2, 0.05), 40_000),
        (Vec3::new(-0.05, 1.0, 0.1), 60_000),
        (Vec3::new(0.2, -0.6, -0.1), 80_000),
    ] {
        let mut scene = upright(0.008, angles);
        scene.work = Some(work);
        let mut stopped = 0;
        for _ in 0..150 {
            scene.tick(|_, particles, _| floor(particles));
            assert_eq!(scene.contact.ticks_off, 0, "{angles}: let go");
            stopped += u32::from(scene.contact.counts.is_lost);
        }
        assert!(stopped > 0, "{angles}");
        assert_eq!(scene.worst, 0, "{angles}");
        assert!(height(&scene) < 0.15, "{angles}: {}", height(&scene));
    }
}

/// Cloth that cannot go on is let go after so many ticks in a row. It does not move until then.
#[test]
fn cloth_is_not_stopped_for_ever() {
    let mut scene = upright(0.008, Vec3::new(0.1, 0.2, 0.05));
    let tick = |scene: &mut Scene| scene.tick(|_, particles, _| floor(particles));
    while scene.contact.wanted_substeps() == 0 {
        tick(&mut scene);
    }
    let before = places(&scene);
    scene.work = Some(0);
    for _ in 0..MOST_STOPPED {
        tick(&mut scene);
        assert!(scene.contact.stopped > 0);
        assert_eq!(places(&scene), before);
    }
    tick(&mut scene);
    assert_eq!((scene.contact.stopped, scene.contact.pairs()), (0, 0));
    assert_ne!(places(&scene), before);
    // What is well again is kept apart as before.
    scene.work = None;
    (0..20).for_each(|_| tick(&mut scene));
    assert_eq!(scene.contact.lost(), 0);
}

/// Cloth whose pins move on is not stopped: it would be torn apart.
#[test]
fn cloth_whose_pins_move_goes_on() {
    let mut scene = upright(0.008, Vec3::new(0.1, 0.2, 0.05));
    let tick = |scene: &mut Scene| scene.tick(|_, particles, _| floor(particles));
    while scene.contact.wanted_substeps() == 0 {
        tick(&mut scene);
    }
    scene.cloths[0].particles.pin(0);
    scene.work = Some(0);
    tick(&mut scene);
    assert!(scene.contact.stopped > 0);
    scene.tick(|_, particles, end| {
        let place = particles.position(0).expect("it exists");
        let moved = place + 0.01 * end * Vec3::Y;
        particles.set_position(0, moved).expect("finite");
        floor(particles);
    });
    assert_eq!(scene.contact.stopped, 0);
    assert!(scene.contact.lost() > 0);
}
