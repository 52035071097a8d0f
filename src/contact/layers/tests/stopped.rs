//! Cloth whose layers are more work than a tick has.

use bevy::math::{Quat, Vec3};

use super::{Scene, Sheeted, floor, thrown::Draw, turned};
use crate::contact::layers::{MOST_STOPPED, work::LEAST_WORK};

/// A grid or an irregular mesh above the floor, on its edge, leaning as drawn.
fn upright(seed: u32) -> Scene {
    let mut draw = Draw(7919 * seed + 1);
    let angles = 1.5 * Vec3::X + 0.3 * draw.vector();
    let turn = Quat::from_rotation_y(3.0 * draw.next());
    let place = move |at: Vec3| turn * turned(angles, at) + 0.55 * Vec3::Y;
    let thickness = 0.004 * 4.0_f32.powf(0.5 * draw.next() + 0.5);
    let sheet = Sheeted::of_kind(14 + seed % 4, 0.8, seed % 2 == 1, place);
    Scene::new(vec![sheet], thickness)
}

fn tick(scene: &mut Scene) {
    scene.tick(|_, particles, _| floor(particles));
}

/// A scene at the first touch of its layers.
fn touching() -> Scene {
    let mut scene = upright(0);
    for _ in 0..150 {
        if scene.contact.wanted_substeps() > 0 {
            return scene;
        }
        tick(&mut scene);
    }
    panic!("its layers never touch")
}

fn places(scene: &Scene) -> Vec<Vec3> {
    scene.cloths[0].particles.positions().collect()
}

fn height(scene: &Scene) -> f32 {
    let places = places(scene);
    places.iter().map(|place| place.y).sum::<f32>() / places.len() as f32
}

/// Sheets that crumple have half of the work that they need in their longest tick. In such ticks they stay where they were
/// apart. They never pass through themselves, and lie on the floor at last.
#[test]
fn cloth_with_too_much_work_does_not_pass() {
    const TICKS: usize = 150;
    for seed in 0..12 {
        let mut free = upright(seed);
        let (mut most, mut searched) = (0, 0);
        for _ in 0..TICKS {
            tick(&mut free);
            assert_eq!(free.contact.lost(), 0, "{seed}");
            most = most.max(free.begun - free.contact.counts.work);
            searched = searched.max(free.searched);
        }
        let mut scene = upright(seed);
        scene.work = Some(most / 2);
        let mut stopped = 0;
        for _ in 0..TICKS {
            tick(&mut scene);
            assert_eq!(scene.contact.ticks_off, 0, "{seed}: let go");
            stopped += u32::from(scene.contact.counts.is_lost);
            searched = searched.max(scene.searched);
        }
        let each = searched / scene.cloths[0].particles.len();
        assert!(2 * each < LEAST_WORK, "{seed}: {each}");
        assert!(stopped > 0, "{seed}");
        for scene in [&free, &scene] {
            assert_eq!(scene.worst, 0, "{seed}");
            assert!(height(scene) < 0.15, "{seed}: {}", height(scene));
        }
    }
}

/// Cloth that cannot go on is let go after so many ticks in a row. It does not move until then.
#[test]
fn cloth_is_not_stopped_for_ever() {
    let mut scene = touching();
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
    // With enough work, contact keeps it apart as before.
    scene.work = None;
    (0..20).for_each(|_| tick(&mut scene));
    assert_eq!(scene.contact.lost(), 0);
}

/// Cloth whose pins move on is not stopped: it would be torn apart.
#[test]
fn cloth_whose_pins_move_goes_on() {
    let mut scene = touching();
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
