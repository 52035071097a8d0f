//! What a push gives and takes.

use bevy::math::{DVec3, Vec3};

use super::{Scene, Sheeted};

/// Momentum (kg·m/s) and angular momentum about the origin (kg·m²/s) of all cloths, for displacements over `dt` (s).
fn momenta(scene: &Scene, dt: f64) -> (DVec3, DVec3) {
    let (mut linear, mut angular) = (DVec3::ZERO, DVec3::ZERO);
    for cloth in &scene.cloths {
        let particles = &cloth.particles;
        let each = particles.positions().zip(particles.displacements());
        for ((place, moved), inverse_mass) in each.zip(particles.inverse_masses()) {
            let momentum = moved.as_dvec3() / (dt * f64::from(inverse_mass));
            linear += momentum;
            angular += place.as_dvec3().cross(momentum);
        }
    }
    (linear, angular)
}

/// Two sheets that hit each other aslant keep their momentum: nothing else acts on them.
#[test]
fn what_two_sheets_give_each_other_they_have_taken() {
    let sheets = [0.0, 0.05].map(|height| {
        Sheeted::new(9, 0.4, move |at| {
            Vec3::new(at.x + 0.3 * height, at.y + height + 0.02 * at.x, at.z)
        })
    });
    let mut scene = Scene::new(sheets.into(), 0.01);
    scene.step.acceleration = Vec3::ZERO;
    scene.step.damping = 0.0;
    let dt = scene.step.seconds / scene.step.substeps as f32;
    // To each other at 2 m/s, and past each other at 1.
    for (cloth, velocity) in scene
        .cloths
        .iter_mut()
        .zip([Vec3::new(0.5, 1.0, 0.0), Vec3::new(-0.5, -1.0, 0.0)])
    {
        for index in 0..cloth.particles.len() {
            let set = cloth.particles.set_displacement(index, velocity * dt);
            set.expect("it exists");
        }
    }
    let (before, turning) = momenta(&scene, f64::from(dt));
    let size = 81.0
        * 2.0
        * f64::from(
            1.12 / scene.cloths[0]
                .particles
                .inverse_mass(40)
                .expect("it exists"),
        );
    for _ in 0..12 {
        scene.tick(|_, _, _| {});
    }
    let (after, turned) = momenta(&scene, f64::from(dt));
    // In f32, over 240 sub-steps.
    assert!(
        (after - before).length() < 1.0e-4 * size,
        "{before} {after}, of {size}"
    );
    // Overlaps that are let out move particles without any speed.
    assert!(
        (turned - turning).length() < 1.0e-2 * 0.2 * size,
        "{turning} {turned}"
    );
    assert_eq!(scene.worst, 0);
    // They have met: the upper one does not fall any more.
    let falls = |cloth: &Sheeted| {
        cloth
            .particles
            .displacements()
            .map(|moved| moved.y)
            .sum::<f32>()
            / (81.0 * dt)
    };
    let [below, above] = [0, 1].map(|index| falls(&scene.cloths[index]));
    assert!(below < 0.2 && above > -0.2, "{below} {above} m/s");
}

/// A sheet on one that is held, which leans: it slides where the slope is more than μ, and not below.
#[test]
fn layers_slide_from_the_angle_of_friction_on() {
    for (slope, slides) in [(0.2_f32, false), (0.27, false), (0.34, true), (0.5, true)] {
        let lean = move |at: Vec3| {
            let (sin, cos) = slope.atan().sin_cos();
            Vec3::new(at.x * cos - at.y * sin, at.x * sin + at.y * cos, at.z)
        };
        let below = Sheeted::new(15, 1.4, lean);
        let above = Sheeted::new(5, 0.3, move |at| {
            lean(at + Vec3::Y * 0.0099 + Vec3::X * 0.2)
        });
        let mut scene = Scene::new(vec![below, above], 0.01);
        scene.step.damping = 0.0;
        let fixed = &mut scene.cloths[0].particles;
        for index in 0..fixed.len() {
            fixed.set_inverse_mass(index, 0.0).expect("it exists");
        }
        let ticks = 30;
        for _ in 0..ticks {
            scene.tick(|_, _, _| {});
        }
        let moved: f32 = scene.cloths[1]
            .particles
            .displacements()
            .map(|moved| moved.x)
            .sum();
        let dt = scene.step.seconds / scene.step.substeps as f32;
        let speed = -moved / (25.0 * dt) / slope.atan().cos();
        let (sin, cos) = slope.atan().sin_cos();
        let wanted = 9.81 * (sin - 0.3 * cos) * ticks as f32 * scene.step.seconds;
        if slides {
            // Friction is off by at most 5 %: a push on one particle leaves less for the next to hold against.
            let held = 9.81 * 0.3 * cos * ticks as f32 * scene.step.seconds;
            assert!(
                (speed - wanted).abs() < 0.05 * held,
                "{slope}: {speed}, {wanted}"
            );
        } else {
            assert!(speed.abs() < 2.0e-3, "{slope}: {speed} m/s");
        }
    }
}

/// Pins move a sheet through another. If both are held, the sub-steps count as lost; a free one is pushed along.
#[test]
fn layers_that_pins_force_through_each_other_count_as_lost() {
    for is_free in [true, false] {
        let sheets =
            [0.0, 0.02].map(|height| Sheeted::new(7, 0.3, move |at| at + Vec3::Y * height));
        let mut scene = Scene::new(sheets.into(), 0.01);
        scene.step.acceleration = Vec3::ZERO;
        for (index, cloth) in scene.cloths.iter_mut().enumerate() {
            for particle in 0..cloth.particles.len() {
                if index == 1 || !is_free {
                    let held = cloth.particles.set_inverse_mass(particle, 0.0);
                    held.expect("it exists");
                }
            }
        }
        let (mut lost, by) = (0, Vec3::Y * -0.0005);
        for _ in 0..6 {
            scene.tick(|index, particles, _| {
                for particle in (0..particles.len()).filter(|_| index == 1) {
                    let at = particles.position(particle).expect("it exists");
                    let set = particles.set_position(particle, at + by);
                    set.expect("finite");
                }
            });
            lost += scene.contact.lost();
        }
        assert_eq!(lost == 0, is_free, "{lost} sub-steps");
        assert!(!is_free || scene.worst == 0);
    }
}
