//! Patches that begin inside each other.

use bevy::math::Vec3;

use super::{Scene, Sheeted, participants, thrown::Draw, turned};
use crate::contact::layers::{MutualContact, work::Counts};

/// The share of a scene's patches that are inside each other.
fn tangled(contact: &mut MutualContact) -> f32 {
    contact.near.tangled_share(contact.motion.patches.len())
}

fn begin(scene: &mut Scene) {
    let participants = participants(&mut scene.cloths, scene.settings);
    scene.contact.begin(&participants, |_, _| true);
}

/// A sheet, all of whose particles from a corner on are folded into the plane of the others.
fn with_corner_folded(side: u32, from: f32) -> Sheeted {
    Sheeted::new(side, 1.0, |at| {
        let over = (at.x + at.z - from).max(0.0);
        at - over * Vec3::new(1.0, 0.0, 1.0)
    })
}

/// Random pairs of grids and meshes: if and only if triangles intersect (by brute force in f64), some patches are tangled.
/// None of these pairs is nearer than a hundredth of the thickness without.
#[test]
fn what_begins_crossed_is_tangled() {
    let mut crossed = 0;
    for seed in 0..60 {
        let mut draw = Draw(seed * 6007 + 5);
        let sheets = [0, 1].map(|_| {
            let (angles, off) = (3.0 * draw.vector(), 0.25 * draw.vector());
            // The brute force takes exactly coplanar faces for crossed by its rounding.
            let place = move |at: Vec3| {
                let wave = 0.01 * (9.0 * at.x).sin() * (7.0 * at.z).cos();
                turned(angles, at + wave * Vec3::Y) + off
            };
            Sheeted::of_kind(8 + seed % 7, 0.5, draw.next() > 0.0, place)
        });
        let mut scene = Scene::new(sheets.into(), 0.005);
        let is_crossed = scene.intersections() > 0;
        begin(&mut scene);
        let is_tangled = tangled(&mut scene.contact) > 0.0;
        assert_eq!(is_tangled, is_crossed, "pair {seed}: tangled, crossed");
        crossed += u32::from(is_crossed);
    }
    assert!((15..45).contains(&crossed), "{crossed} of 60 begin crossed");
}

/// A corner that began folded into the sheet is put back: nothing of it is left.
#[test]
fn a_sheet_that_lies_flat_again_is_not_tangled() {
    let mut scene = Scene::new(vec![with_corner_folded(20, 0.7)], 0.005);
    scene.step.acceleration = Vec3::ZERO;
    begin(&mut scene);
    assert!(tangled(&mut scene.contact) > 0.0);
    let flat = Sheeted::new(20, 1.0, |at| at);
    scene.cloths[0].particles.copy_from(&flat.particles);
    // As if colliders had pushed it: contact does not begin anew.
    (0..2).for_each(|_| scene.tick(|_, _, _| {}));
    assert_eq!(tangled(&mut scene.contact), 0.0);
}

/// A corner takes as little of the limit as it is large. Of two sheets in one place all is tangled.
#[test]
fn what_is_tangled_has_less_work() {
    let left = |sheets: Vec<Sheeted>| {
        let mut scene = Scene::new(sheets, 0.005);
        begin(&mut scene);
        let all = Counts::new(scene.cloths.iter().map(|cloth| cloth.particles.len()).sum());
        (
            tangled(&mut scene.contact),
            scene.contact.counts.work as f32 / all.work as f32,
        )
    };
    let apart = |height: f32| Sheeted::new(20, 1.0, move |at| at + height * Vec3::Y);
    let (share, work) = left(vec![with_corner_folded(20, 0.7), apart(0.02), apart(0.04)]);
    assert!(share > 0.0 && share < 0.1, "{share} of a pile");
    assert!(work > 0.85, "{work} of the work of a pile");
    let (share, work) = left([0.0, 0.0].map(apart).into());
    assert!(share > 0.9, "{share} of two in one place");
    assert!(work < 0.2, "{work} of the work of two in one place");
}

/// The limit is lower for large cloths, too.
#[test]
fn large_cloths_that_are_tangled_have_less_work() {
    let particles = 100_000;
    let all = Counts::new(particles);
    let mut tangled = all;
    tangled.tighten(particles, 1.0);
    assert!(tangled.work < all.work / 10);
}

/// Two sheets begin through each other, and two others are squeezed later. After a change of circumstances the first are left
/// alone, still, and the others are not.
#[test]
fn only_what_was_tangled_is_left_alone_when_circumstances_change() {
    let upright = |at: Vec3| Vec3::new(at.x, at.z, 0.0);
    let lying = |off: f32| Sheeted::new(12, 0.5, move |at| at + off * Vec3::Y);
    let through = [lying(0.0), Sheeted::new(12, 0.5, upright)];
    let far = |height: f32| Sheeted::new(12, 0.5, move |at| at + Vec3::new(2.0, height, 0.0));
    let thickness = 0.008;
    let mut scene = Scene::new(through.into(), thickness);
    scene.cloths.extend([far(0.0), far(0.05)]);
    begin(&mut scene);
    let before = tangled(&mut scene.contact);
    assert!(before > 0.0);
    // Nearer than what counts as tangled at the beginning.
    let squeezed = far(0.005 * thickness);
    scene.cloths[3].particles.copy_from(&squeezed.particles);
    scene.settings.friction = 0.2;
    begin(&mut scene);
    assert_eq!(tangled(&mut scene.contact), before);
}
