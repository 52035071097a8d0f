//! The same springs by explicit forces in f64, plainly written: the reference, and a peer where springs are soft.

use bevy_drape::cloth::Spring;

use crate::{
    outcome::Places,
    player::Frames,
    scene::{COMPARED, NEARLY_RIGID, Scene},
    shared::{exact::Exact, sheet::Sheet},
    told::FRAME,
};

pub struct Explicit {
    exact: Exact,
    steps: u32,
}

impl Explicit {
    pub fn new(scene: &Scene, steps: u32, start: u32) -> Self {
        Self {
            exact: Exact::of(&scene.sheet_of(scene.compliance, start)),
            steps,
        }
    }
}

impl Frames for Explicit {
    fn step(&mut self) -> Result<(), String> {
        self.exact.advance(f64::from(FRAME), self.steps);
        Ok(())
    }

    fn places(&mut self) -> Places {
        let each = self.exact.places();
        each.map(|place| place.as_vec3().to_array()).collect()
    }
}

/// Where a scene's particles are when they are compared, and by how much that may be wrong (m).
///
/// Soft springs: the difference to half as many steps, which is three times what is left. Rigid ones are given a small compliance
/// in their place, and one ten times as large: if what that changes is in proportion, nine parts of ten of it are between the two.
pub fn reference(scene: &Scene, is_quick: bool) -> (Exact, f64) {
    let seconds = f64::from(COMPARED) * f64::from(FRAME);
    let after = |compliance: f32, finer: f64| {
        let sheet = scene.sheet_of(compliance, 0);
        let steps = finer * seconds * frequency(&sheet) / 2.0;
        let mut exact = Exact::of(&sheet);
        exact.advance(seconds, steps.ceil() as u32);
        exact
    };
    if scene.compliance > 0.0 {
        let [fine, coarse] = [8.0, 4.0].map(|finer| after(scene.compliance, finer));
        let error = fine.distance(coarse.places()) / 3.0;
        return (fine, error);
    }
    let rigid = if is_quick {
        10.0 * NEARLY_RIGID
    } else {
        NEARLY_RIGID
    };
    let [fine, coarse] = [1.0, 10.0].map(|softer| after(softer * rigid, 1.5));
    let error = fine.distance(coarse.places()) / 9.0;
    (fine, error)
}

/// A bound above the largest angular frequency of a sheet (rad/s): no row of the matrix of stiffnesses over masses has a larger
/// sum (Gershgorin).
fn frequency(sheet: &Sheet) -> f64 {
    let mut rows = vec![0.0; sheet.particles.len()];
    let inverse_masses: Vec<f64> = sheet.particles.inverse_masses().map(f64::from).collect();
    for Spring {
        ends, compliance, ..
    } in &sheet.springs
    {
        for end in ends.map(|end| end as usize) {
            rows[end] += 2.0 * inverse_masses[end] / f64::from(*compliance);
        }
    }
    rows.into_iter().fold(0.0, f64::max).sqrt()
}
