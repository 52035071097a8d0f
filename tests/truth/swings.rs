//! How a cloth swings, rings and sags with the settings by default, against closed forms. Ticks are Bevy's, of 1/64 s.

use bevy_drape::{
    cloth::ClothMaterial,
    solver::{ClothSettings, Control, TickStep},
};
use examples_shared::{
    modes::{
        ROOTS, hanging_found, hanging_period, membrane_found, membrane_period, taut_found, taut_sag,
    },
    sheet::{GRAVITY, threads},
};

use crate::catenary::catenary;

/// Without bending and damping.
fn cotton() -> ClothMaterial {
    let cotton = ClothMaterial::COTTON;
    threads(cotton.stretch_compliance, cotton.shear_compliance)
}

fn tethers() -> bool {
    ClothSettings::default().tethers
}

/// The first three modes of a sheet of 64 rows, 2 m long, to half a per cent. 64 rows in place of a continuum are off by less than
/// 0.4 % in the third, (j h ⁄ L)² ⁄ 24 and more where it is steep; one crossing found between two sub-steps by 10⁻⁵.
#[test]
fn a_hanging_sheet_swings_with_the_periods_of_its_modes() {
    for (name, material) in [("rigid", threads(0.0, 0.0)), ("cotton", cotton())] {
        let ratios: Vec<f64> = (0..ROOTS.len())
            .map(|mode| {
                let step = TickStep::default();
                let found = hanging_found(64, 2.0, mode, &material, step, tethers());
                found / hanging_period(2.0, mode)
            })
            .collect();
        println!("hanging sheet, {name}: periods over true ones {ratios:.4?}");
        for ratio in ratios {
            assert!((ratio - 1.0).abs() < 0.005, "{name}: {ratio}");
        }
    }
}

/// Tethers hold what threads hold anyhow: with and without them the modes are the same to 1 %.
#[test]
fn tethers_change_no_mode() {
    for (name, material) in [("rigid", threads(0.0, 0.0)), ("cotton", cotton())] {
        for mode in 0..ROOTS.len() {
            let [with, without] = [true, false].map(|tethers| {
                hanging_found(64, 2.0, mode, &material, TickStep::default(), tethers)
            });
            println!("{name}, mode {mode}: {with:.4} s with tethers, {without:.4} s without");
            assert!((with / without - 1.0).abs() < 0.01, "{with} {without}");
        }
    }
}

/// The first mode of cotton that is stretched by 1 % on a frame, to 1.5 %, at any resolution, by the settings by default: which ask for
/// more sub-steps than so many particles do, until ripples of its tension are resolved, 37 at 65². A lattice of 17² in place of a
/// membrane is off by (π h ⁄ a)² ⁄ 24 = 0.2 %; backward Euler, of first order, by (ω Δt)² ⁄ 3 = 0.4 %.
#[test]
fn a_membrane_rings_with_its_period() {
    let ratios = [17, 24, 33, 48, 65].map(|side| {
        let step = TickStep {
            seconds: 1.0 / 60.0,
            ..TickStep::default()
        };
        let control = Some(Control::default());
        let found = membrane_found(side, &cotton(), step, tethers(), control);
        let ratio = found / membrane_period(&cotton());
        println!("membrane, {side}²: period over the true one {ratio:.4}");
        ratio
    });
    for ratio in ratios {
        assert!((ratio - 1.0).abs() < 0.015, "{ratios:?}");
    }
}

/// A strip of cotton as long as its span, 2 m: it sags by 48 mm, to 3 %.
#[test]
fn a_taut_strip_sags_by_what_its_threads_give() {
    let material = cotton();
    let truth = taut_sag(2.0, &material);
    let weight = f64::from(material.areal_density) * GRAVITY;
    let (_, elastic) = catenary(2.0, weight, 1.0 / f64::from(material.stretch_compliance))(1.0);
    println!("taut strip: a flat arc sags {truth:.5} m, the elastic catenary {elastic:.5} m");
    assert!((elastic / truth - 1.0).abs() < 0.005, "{elastic} {truth}");
    assert!((truth - 0.0480).abs() < 0.0001, "{truth}");
    let found = [17, 33, 65].map(|columns| {
        let found = taut_found(columns, 2.0, &material, TickStep::default(), tethers());
        println!(
            "taut strip, {columns} particles: {:.1} mm, true {:.1} mm",
            1.0e3 * found,
            1.0e3 * elastic
        );
        found
    });
    for sag in found {
        assert!((sag / elastic - 1.0).abs() < 0.03, "{found:?} {elastic}");
    }
}
