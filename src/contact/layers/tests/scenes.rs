//! No triangles intersect, in any tick.

use bevy::math::Vec3;

use super::{Scene, Sheeted, floor, thrown::Draw, turned};

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
    assert!(
        scene.contact.contacts.pairs.len() > 30,
        "they lie on each other"
    );
}

/// What lies on the floor does not give way to what lies on it: both come to rest, one thickness apart.
#[test]
fn a_sheet_that_lies_on_another_comes_to_rest() {
    let sheets = (0..2).map(|index| {
        Sheeted::new(12, 0.6, move |at| {
            turned(Vec3::Y * 0.4 * index as f32, at) + Vec3::Y * (0.001 + 0.007 * index as f32)
        })
    });
    let mut scene = Scene::new(sheets.collect(), 0.006);
    for _ in 0..120 {
        scene.tick(|_, particles, _| floor(particles));
    }
    let dt = scene.step.seconds / scene.step.substeps as f32;
    // A sub-step of falling is what each is pushed back by: 4 mm/s of its 20 a tick. Without a floor that holds from behind the
    // sheets press each other into it, and come back at three times that.
    let most = 9.81 * dt;
    for cloth in &scene.cloths {
        let speeds = cloth.particles.displacements();
        let squares: f32 = speeds.map(|moved| (moved / dt).length_squared()).sum();
        let speed = (squares / cloth.particles.len() as f32).sqrt();
        assert!(speed < most, "{speed} m/s, of {most}");
    }
    assert_eq!(scene.worst, 0);
}

/// What was found for one thickness is not all that another one asks for.
#[test]
fn what_touches_otherwise_than_before_is_searched_for_anew() {
    let sheets = [0.0, 0.03].map(|height| Sheeted::new(9, 0.4, move |at| at + Vec3::Y * height));
    let mut scene = Scene::new(sheets.into(), 0.004);
    scene.step.acceleration = Vec3::ZERO;
    scene.tick(|_, _, _| {});
    scene.tick(|_, _, _| {});
    assert_eq!(scene.contact.searches(), 0, "nothing moves");
    assert_eq!(scene.contact.pairs(), 0);
    scene.settings.thickness = 0.04;
    scene.tick(|_, _, _| {});
    assert!(scene.contact.searches() > 0);
    let heights = |cloth: usize| scene.cloths[cloth].particles.positions().map(|at| at.y);
    let apart = heights(1)
        .zip(heights(0))
        .map(|(above, below)| above - below);
    let least = apart.fold(f32::INFINITY, f32::min);
    assert!(least > 0.031, "each vertex is pushed off a face: {least} m");
}

/// Layers that become thicker come apart slowly, however much thicker, on grids and meshes: a pair adds velocity only up to 0.25 m/s. Pairs
/// that share particles may add as much again, and springs add none to the mean of a sheet.
#[test]
fn layers_that_become_thicker_are_not_thrown() {
    let mut draw = Draw(3);
    for case in 0..8 {
        let angle = Vec3::Y * draw.next();
        let sheets = [0.0, 1.0].map(|index| {
            Sheeted::of_kind(9, 0.4, case % 2 == 1, move |at| {
                turned(index * angle, at) + Vec3::Y * 0.005 * index
            })
        });
        let mut scene = Scene::new(sheets.into(), 0.004);
        scene.step.acceleration = Vec3::ZERO;
        scene.tick(|_, _, _| {});
        scene.settings.thickness = 0.016 + 0.008 * draw.next();
        let dt = scene.step.seconds / scene.step.substeps as f32;
        let mut fastest = 0.0_f32;
        for _ in 0..20 {
            scene.tick(|_, _, _| {});
            for cloth in &scene.cloths {
                let sum: Vec3 = cloth.particles.displacements().sum();
                fastest = fastest.max(sum.length() / (cloth.particles.len() as f32 * dt));
            }
        }
        println!("{case}: {fastest} m/s");
        assert!((0.01..0.5).contains(&fastest), "{case}: {fastest} m/s");
        assert_eq!(scene.worst, 0, "{case}");
    }
}

/// A pile wants as many sub-steps as there are, however small it is beside another cloth; corners that touch hardly any unless
/// they are fast; and sheets apart from each other none.
#[test]
fn layers_want_substeps_by_what_touches() {
    let wanted = |side: u32, speed: f32, [across, up]: [f32; 2]| {
        let second = move |at: Vec3| at + Vec3::new(across, up, across);
        let width = 0.05 * (side - 1) as f32;
        let sheets = vec![
            Sheeted::new(side, width, |at| at),
            Sheeted::new(9, 0.4, second),
        ];
        let mut scene = Scene::new(sheets, 0.01);
        let cloth = &mut scene.cloths[1].particles;
        for index in 0..cloth.len() {
            let moved = speed * scene.step.seconds / scene.step.substeps as f32 * Vec3::X;
            cloth.set_displacement(index, moved).expect("it exists");
        }
        scene.tick(|_, _, _| {});
        scene.contact.wanted_substeps()
    };
    // About one pair for each of the particles that may touch, whatever the size of the other cloth.
    assert!(wanted(9, 0.0, [0.0, 0.007]) > 10);
    assert!(wanted(33, 0.0, [0.0, 0.007]) > 10);
    let corners = [0.39, 0.007];
    assert!((1..8).contains(&wanted(9, 0.0, corners)));
    // 12 m/s in a tick are 20 times the thickness.
    assert_eq!(wanted(9, -12.0, corners), 16);
    assert_eq!(wanted(9, 0.0, [0.0, 0.5]), 0);
}
