//! Fast balls against a free cloth: how many get through.

use super::{
    random::Random,
    shots::{SPACING, Shot},
};

const TRIALS: u64 = 9;

/// After how many ticks a ball of a radius (m) at a speed (m/s), spinning, is through a free cloth.
fn through(speed: f32, radius: f32, is_swept: bool, seed: u64) -> Option<u32> {
    let mut random = Random(seed);
    let beside = random.within(1.0);
    Shot {
        speed,
        radius,
        is_swept,
        beside: [beside.x, beside.y],
        delay: random.part(),
        spin: random.direction() * 50.0 * random.part(),
    }
    .through()
}

/// How many balls get through, by speed and radius, with the test all along the way and with that at the end of each
/// sub-step alone: counted, and printed as CSV by `cargo test --lib tunnelling -- --nocapture`.
#[test]
fn tunnelling_is_of_the_discrete_test_alone() {
    let mut discrete = 0;
    let mut swept = 0;
    println!("speed_m_s,spacing_m,radius_over_spacing,test,trials,tunnelled");
    for speed in [10.0, 50.0, 100.0, 200.0, 400.0] {
        for ratio in [0.5, 1.0, 2.0, 4.0] {
            for (is_swept, name, sum) in [
                (false, "discrete", &mut discrete),
                (true, "swept", &mut swept),
            ] {
                let tunnelled: Vec<_> = (0..TRIALS)
                    .filter_map(|seed| through(speed, ratio * SPACING, is_swept, seed))
                    .collect();
                let count = tunnelled.len();
                println!("{speed},{SPACING},{ratio},{name},{TRIALS},{count}");
                *sum += count;
            }
        }
    }
    assert!(discrete > 0, "there is something to be swept for");
    assert_eq!(swept, 0);
}
