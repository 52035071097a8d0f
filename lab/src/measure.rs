//! Times, and what lies in the middle of them.

use std::{hint::black_box, time::Instant};

/// Median and quartiles of several turns.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Spread {
    pub low: f64,
    pub median: f64,
    pub high: f64,
}

impl Spread {
    /// Of values in any order; NaN of none.
    pub fn of(values: &[f64]) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        // Between two values, in proportion.
        let at = |part: f64| {
            let place = part * sorted.len().saturating_sub(1) as f64;
            let value = |index: f64| sorted.get(index as usize).copied().unwrap_or(f64::NAN);
            let (below, above) = (value(place.floor()), value(place.ceil()));
            below + (above - below) * place.fract()
        };
        Self {
            low: at(0.25),
            median: at(0.5),
            high: at(0.75),
        }
    }
}

/// The value in the middle; NaN of none.
pub fn median(values: &[f64]) -> f64 {
    Spread::of(values).median
}

/// Each once, in the order in which they appear.
pub fn distinct<K: PartialEq>(all: impl IntoIterator<Item = K>) -> Vec<K> {
    let mut distinct = Vec::new();
    for one in all {
        if !distinct.contains(&one) {
            distinct.push(one);
        }
    }
    distinct
}

/// Time of one call (s).
pub fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// Time of one call (s) of something short, called again until `least` seconds have passed.
pub fn seconds_each<R>(least: f64, mut work: impl FnMut() -> R) -> f64 {
    let start = Instant::now();
    let mut calls = 0;
    let mut together = 1;
    loop {
        for _ in 0..together {
            black_box(work());
        }
        calls += together;
        let passed = start.elapsed().as_secs_f64();
        if passed >= least {
            return passed / f64::from(calls);
        }
        // Not a look at the clock for each.
        if passed < least / 4.0 {
            together *= 2;
        }
    }
}

/// Slope and intercept of the straight line nearest to `points`, by least squares.
pub fn line_through(points: &[[f64; 2]]) -> [f64; 2] {
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / count;
    let (x, y) = (mean(0), mean(1));
    let (mut across, mut both) = (0.0, 0.0);
    for point in points {
        across += (point[0] - x).powi(2);
        both += (point[0] - x) * (point[1] - y);
    }
    let slope = both / across;
    [slope, y - slope * x]
}

/// Exponent of the power law nearest to `points`, of which both numbers are positive.
pub fn exponent(points: &[[f64; 2]]) -> f64 {
    let logs: Vec<[f64; 2]> = points.iter().map(|point| point.map(f64::ln)).collect();
    line_through(&logs)[0]
}

/// Numbers that look random and are the same in every run (`SplitMix64`).
#[derive(Debug, Clone)]
pub struct Random(pub u64);

impl Random {
    /// From 0 up to 1.
    pub fn part(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / (1u64 << 24) as f32
    }

    /// From one number up to another.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.part()
    }

    /// From 0 up to `count`, which is not.
    pub fn below(&mut self, count: u32) -> u32 {
        ((self.part() * count as f32) as u32).min(count.saturating_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreads_and_slopes_are_known() {
        assert_eq!(distinct([2, 1, 2, 3, 1]), [2, 1, 3]);
        let spread = Spread::of(&[5.0, 1.0, 2.0, 4.0, 3.0]);
        assert_eq!((spread.low, spread.median, spread.high), (2.0, 3.0, 4.0));
        let spread = Spread::of(&[1.0, 2.0]);
        assert_eq!((spread.low, spread.median, spread.high), (1.25, 1.5, 1.75));
        assert_eq!(Spread::of(&[4.0, 2.0, 3.0]).low, 2.5);
        assert!(median(&[]).is_nan());
        let points: Vec<[f64; 2]> = (1..9)
            .map(f64::from)
            .map(|x| [x, 3.0 * x.powf(1.5)])
            .collect();
        assert!((exponent(&points) - 1.5).abs() < 1e-12);
    }
}
