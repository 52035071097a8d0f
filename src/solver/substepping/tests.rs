//! How many sub-steps a tick gets, and when it is repeated.

use super::*;

const PERCENT: Substepping = Substepping::Adaptive {
    stretch: 0.01,
    max_substeps: 100,
};

/// Runs a cloth whose stretch is `load` ⁄ sub-steps². Returns the sub-steps of each tick, and how many were
/// done in vain.
fn run(control: &mut Control, load: impl Fn(u32) -> f32, ticks: u32) -> (Vec<u32>, u32) {
    let mut vain = 0;
    let mut taken = Vec::new();
    for tick in 0..ticks {
        let mut substeps = control.substeps(PERCENT, FEWEST);
        loop {
            let structural = load(tick) / (substeps * substeps) as f32;
            let stretch = Stretch {
                structural,
                bound: structural,
                ..Stretch::default()
            };
            match control.observe(PERCENT, stretch) {
                Some(more) => {
                    vain += substeps;
                    assert!(more > substeps && more <= 100);
                    substeps = more;
                }
                None => break,
            }
        }
        assert!(load(tick) / ((substeps * substeps) as f32) <= 0.01 || control.is_beyond());
        taken.push(substeps);
    }
    (taken, vain)
}

#[test]
fn settles_on_what_the_load_asks_for_and_stays() {
    // 1 % at 20 sub-steps, 0.8 % at 22.4, 0.3 % at 36.5.
    let (taken, vain) = run(&mut Control::default(), |_| 4.0, 60);
    assert!(taken[10..].iter().all(|&n| n == taken[10]), "{taken:?}");
    assert!((23..=36).contains(&taken[10]), "{taken:?}");
    assert!(vain <= 4 + 8 + 16, "{vain}");
}

#[test]
fn follows_a_load_up_without_failing_and_down_without_haste() {
    // Up fourfold within a second, then nothing.
    let load = |tick: u32| match tick {
        0..64 => 4.0,
        64..128 => 4.0 + 12.0 * (tick - 64) as f32 / 64.0,
        _ => 0.0,
    };
    let mut control = Control::default();
    let (taken, _) = run(&mut control, load, 64);
    assert!((23..=36).contains(&taken[63]), "{taken:?}");
    let mut control_on = control;
    let (_, vain) = run(&mut control_on, |tick| load(tick + 64), 64);
    assert_eq!(vain, 0, "it was ahead all the time");
    let (taken, _) = run(&mut control_on, |_| 0.0, 400);
    let steps = taken.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(
        taken.is_sorted_by(|a, b| a >= b) && steps <= 20,
        "{taken:?}"
    );
    assert_eq!(taken[399], FEWEST);
}

#[test]
fn needs_grow_with_the_cloth_and_the_tick() {
    let needed = |particles| Substepping::needed(particles, 1.0 / 60.0);
    assert_eq!([2, 16, 32, 64, 128].map(needed), [4, 6, 11, 22, 43]);
    assert_eq!(Substepping::needed(64, 1.0 / 30.0), 43);
    assert_eq!(Substepping::needed(usize::MAX, 1.0), MAX_SUBSTEPS);
    let mut control = Control::default();
    assert_eq!(control.substeps(Substepping::Automatic, 11), 11);
    assert_eq!(control.substeps(PERCENT, 11), 11);
}

/// What the material gives no sub-steps take away, and none are burnt for it; what is beyond is said.
#[test]
fn nothing_is_repeated_for_what_the_material_gives() {
    let mut control = Control::default();
    assert_eq!(control.substeps(PERCENT, 10), 10);
    let stretch = Stretch {
        structural: 0.05,
        bound: 0.05,
        material: 0.049,
        ..Stretch::default()
    };
    assert_eq!(control.observe(PERCENT, stretch), None);
    assert!(control.is_beyond());
    assert_eq!(control.substeps(PERCENT, 10), 10);
}

/// A tick in which a collider stretches the cloth is repeated once, with up to sixteen times the sub-steps; half a second
/// later the cloth takes as many as before. A fixed number stays.
#[test]
fn what_a_collider_stretches_is_done_again() {
    let struck = |unsolved: f32, substeps: u32| Stretch {
        contact_substeps: Substepping::for_contact(unsolved, 0.0, substeps),
        ..Stretch::default()
    };
    let automatic = Substepping::Automatic;
    let mut control = Control::default();
    assert_eq!(control.substeps(automatic, 10), 10);
    assert_eq!(control.observe(automatic, struck(0.09, 10)), None);
    assert_eq!(control.substeps(automatic, 10), 10);
    assert_eq!(control.observe(automatic, struck(2.0, 10)), Some(160));
    assert_eq!(control.observe(automatic, struck(1.0, 160)), None);
    for _ in 0..SLACK_TICKS {
        assert_eq!(control.substeps(automatic, 10), 160);
        assert_eq!(control.observe(automatic, struck(0.0, 160)), None);
    }
    assert_eq!(control.substeps(automatic, 10), 10);
    assert_eq!(control.substeps(Substepping::Fixed(7), 10), 7);
    let observed = control.observe(Substepping::Fixed(7), struck(2.0, 7));
    assert_eq!(observed, None);
    // So is one in which an edge goes deeper than it touches.
    assert_eq!(Substepping::for_contact(0.0, 0.9, 10), 0.0);
    assert_eq!(Substepping::for_contact(0.0, 3.0, 10), 30.0);
    assert_eq!(Substepping::for_contact(f32::NAN, f32::NAN, 10), 0.0);
}

#[test]
fn stops_at_the_cap_and_says_so() {
    let mut control = Control::default();
    let (taken, _) = run(&mut control, |_| 400.0, 10);
    assert!(control.is_beyond());
    assert_eq!(taken[9], 100);
    let (_, _) = run(&mut control, |_| 1.0, 10);
    assert!(!control.is_beyond());
}

#[test]
fn a_fixed_number_is_taken_as_it_is() {
    let mut control = Control::default();
    assert_eq!(control.substeps(Substepping::Fixed(7), 9), 7);
    let stretched = Stretch {
        structural: 9.0,
        bound: 9.0,
        ..Stretch::default()
    };
    assert_eq!(control.observe(Substepping::Fixed(7), stretched), None);
    assert_eq!(control.substeps(Substepping::Fixed(7), 9), 7);
}

/// Up at once, down after half a second, by a little not at all, and never beyond what is sensible.
#[test]
fn ripples_of_tension_are_given_what_they_ask_for() {
    let mut control = Control::default();
    let mut next = |ripple_substeps: f32| {
        let stretch = Stretch {
            ripple_substeps,
            ..Stretch::default()
        };
        assert_eq!(control.observe(Substepping::Automatic, stretch), None);
        control.substeps(Substepping::Automatic, 20)
    };
    assert_eq!(
        [0.0, 5.0, 19.0, 36.0, 37.0].map(&mut next),
        [20, 20, 20, 38, 38]
    );
    for _ in 0..100 {
        assert_eq!(next(30.0), 38);
    }
    for _ in 1..SLACK_TICKS {
        assert_eq!(next(22.0), 38);
    }
    assert_eq!([22.0, f32::NAN, f32::INFINITY].map(&mut next), [24, 24, 80]);
    let mut held = Control::default();
    let taut = Stretch {
        ripple_substeps: 38.0,
        ..Stretch::default()
    };
    held.substeps(PERCENT, 20);
    assert_eq!(held.observe(PERCENT, taut), None);
    assert_eq!(held.substeps(PERCENT, 20), 40);
    assert_eq!(held.substeps(Substepping::Fixed(7), 20), 7);
    assert_eq!(held.substeps(Substepping::Automatic, 20), 20);
}
