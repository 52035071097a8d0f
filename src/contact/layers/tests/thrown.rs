//! Free sheets that are thrown at each other.

use bevy::math::Vec3;

use super::{Scene, Sheeted, turned};
use crate::contact::tests::is_long;

/// Numbers from −1 to 1, as if drawn.
pub(super) struct Draw(pub u32);

impl Draw {
    pub fn next(&mut self) -> f32 {
        // Numerical Recipes' generator of 32 bits.
        for _ in 0..3 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        }
        (self.0 >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| self.next()))
    }
}

/// Of 1,000 random pairs with `BEVY_DRAPE_LONG`, and of every twentieth of these without, none intersects in any tick: grids
/// and irregular meshes of other resolutions, in any attitude, 2 to 16 mm thick, half of them less from place to place, from 1 to 20 m/s.
#[test]
fn sheets_thrown_at_each_other_do_not_intersect() {
    let every = if is_long() { 1 } else { 20 };
    let mut touched = 0;
    for seed in (0..1000).step_by(every) {
        let mut draw = Draw(seed * 7919 + 1);
        let speed = 20.0_f32.powf(0.5 * draw.next() + 0.5);
        let thickness = 0.002 * 8.0_f32.powf(0.5 * draw.next() + 0.5);
        let sheets = [1.0, -1.0].map(|side: f32| {
            let angles = 3.0 * draw.vector() * if seed % 3 == 0 { 0.03 } else { 1.0 };
            let off = 0.1 * draw.vector();
            let gap = 0.02 + 0.3 * draw.next().abs();
            let wave = 0.03 * draw.next();
            let place = move |at: Vec3| {
                let at = at + Vec3::Y * wave * (9.0 * at.x).sin();
                let turned = turned(angles, at);
                // As far as a corner reaches.
                turned + Vec3::new(off.x, side * (0.46 * angles.length().min(1.0) + gap), off.z)
            };
            let sheet = Sheeted::of_kind(14 + seed % 5, 0.6, draw.next() > 0.0, place);
            if seed % 40 < 20 {
                sheet
            } else {
                sheet.of_drawn_thickness(&mut draw)
            }
        });
        let mut scene = Scene::new(sheets.into(), thickness);
        scene.step.acceleration = Vec3::ZERO;
        for (cloth, side) in scene.cloths.iter_mut().zip([1.0, -1.0]) {
            for index in 0..cloth.particles.len() {
                let velocity = Vec3::NEG_Y * (0.5 * side * speed);
                let set = cloth.particles.set_velocity(index, velocity);
                set.expect("it exists");
            }
        }
        if scene.intersections() > 0 {
            continue;
        }
        let ticks = (1.4 / speed * 60.0) as u32 + 10;
        let mut has_touched = false;
        for _ in 0..ticks {
            scene.tick(|_, _, _| {});
            has_touched |= scene.contact.wanted_substeps() > 0;
        }
        touched += u32::from(has_touched);
        assert_eq!(
            scene.worst, 0,
            "pair {seed}: {speed} m/s, {thickness} m thick"
        );
        assert_eq!(scene.contact.lost(), 0, "pair {seed}");
    }
    assert!(touched > 800 / every as u32, "{touched} have met");
}
