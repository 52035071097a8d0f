//! What particles are held by between the sub-steps in which their pairs are gone through.

use bevy::math::Vec3;

use super::{Scene, Sheeted, floor, participants, settings};
use crate::contact::layers::{
    mean_pushes::{LATEST, MeanPushes},
    origin::Origin,
};

/// A vector for each number, as if drawn, of up to 1 in each direction.
fn drawn(number: usize) -> Vec3 {
    let number = number as f32;
    Vec3::new(
        (1.7 * number).sin(),
        (2.9 * number + 1.0).sin(),
        (4.3 * number + 2.0).sin(),
    )
}

/// Whatever the pushes were, and however particles move: none gets faster or is turned back, and none is pushed otherwise than
/// against its motion. How far any two have come nearer to each other is no less than they have.
#[test]
fn what_is_held_gets_no_faster_and_is_not_turned_back() {
    let mut cloths = vec![Sheeted::new(7, 0.6, |at| at)];
    let count = cloths[0].particles.len();
    let layout = cloths[0].particles.layout();
    let (mut passed, mut hold) = (Origin::default(), MeanPushes::default());
    {
        let participants = participants(&mut cloths, settings(0.01));
        passed.set(&participants);
        hold.clear(&participants);
    }
    let push = |index: usize| match index % 3 {
        0 => Vec3::ZERO,
        _ => 1.0e-4 * drawn(index),
    };
    for index in 0..count {
        hold.add(0, layout.slot_of(index), push(index) / LATEST);
        let moved = 1.0e-4 * drawn(3 * index + 7);
        let particles = &mut cloths[0].particles;
        let at = particles.position(index).expect("it exists");
        particles
            .set_position(index, at + moved)
            .expect("it exists");
        particles.set_displacement(index, moved).expect("it exists");
    }
    let before: Vec<Vec3> = cloths[0].particles.displacements().collect();
    let mut is_pushed = [false];
    let (farthest, approach) = hold.apply(
        &mut participants(&mut cloths, settings(0.01)),
        &passed,
        &mut is_pushed,
    );
    assert!(is_pushed[0] && farthest > 0.0);
    let ends: Vec<Vec3> = cloths[0].particles.displacements().collect();
    // Of a particle at 0.3 m and 1e-4 m of motion, in f32.
    let off = 1.0e-7;
    let mut held = 0;
    for (index, (&from, &to)) in before.iter().zip(&ends).enumerate() {
        assert!(to.length() <= from.length() + off, "{from} {to}");
        assert!((to - from).length() <= farthest + off);
        let along = push(index).normalize_or_zero();
        if from.dot(along) < 0.0 {
            held += 1;
            assert!(to.dot(along) < off, "{} turned back", to.dot(along));
        } else {
            assert_eq!(from, to, "it goes the way that it is pushed");
        }
    }
    assert!(held > 10, "{held}");
    for (index, a) in ends.iter().enumerate() {
        for b in &ends[..index] {
            // All started from a sheet where any two were as far apart as at rest: what they have come nearer is less than this.
            assert!((*a - *b).length() <= approach + off, "{approach}");
        }
    }
}

/// Of two cloths each is marked that is held, and no other.
#[test]
fn each_cloth_that_is_held_is_marked() {
    for marked in [[true, false], [false, true], [true, true], [false, false]] {
        let mut cloths = vec![Sheeted::new(3, 0.2, |at| at), Sheeted::new(3, 0.2, |at| at)];
        let (mut passed, mut hold) = (Origin::default(), MeanPushes::default());
        let slot = cloths[0].particles.layout().slot_of(4);
        {
            let participants = participants(&mut cloths, settings(0.01));
            passed.set(&participants);
            hold.clear(&participants);
        }
        for (index, cloth) in cloths.iter_mut().enumerate() {
            let moved = Vec3::NEG_Y * 1.0e-4;
            cloth
                .particles
                .set_displacement(4, moved)
                .expect("it exists");
            if marked[index] {
                hold.add(index, slot, Vec3::Y * 1.0e-5 / LATEST);
            }
        }
        let mut is_pushed = [false; 2];
        let mut participants = participants(&mut cloths, settings(0.01));
        hold.apply(&mut participants, &passed, &mut is_pushed);
        assert_eq!(is_pushed, marked);
    }
}

/// A sheet on one that lies on the floor: once at rest it is held where it is, one thickness above.
#[test]
fn layers_at_rest_stay_where_they_are() {
    let thickness = 0.006;
    let sheets = (0..2).map(|index| {
        let height = 0.0061 * index as f32;
        Sheeted::new(9, 0.4, move |at| {
            at + Vec3::new(0.011 * index as f32, height, 0.0)
        })
    });
    let mut scene = Scene::new(sheets.collect(), thickness);
    for _ in 0..60 {
        scene.tick(|_, particles, _| floor(particles));
    }
    let places = |scene: &Scene| -> Vec<Vec3> { scene.cloths[1].particles.positions().collect() };
    let before = places(&scene);
    for _ in 0..60 {
        scene.tick(|_, particles, _| floor(particles));
        for (at, was) in places(&scene).into_iter().zip(&before) {
            // As far as they may rest in each other.
            assert!((at - *was).length() < 0.04 * thickness, "{was} {at}");
        }
    }
    for at in &before {
        assert!((at.y - thickness).abs() < 0.05 * thickness, "{at}");
    }
    assert_eq!(scene.worst, 0);
}
