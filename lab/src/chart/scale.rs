//! Axes: linear, logarithmic, or with names in place of numbers.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

/// An axis: what it shows, from where to where.
#[derive(Debug, Clone)]
pub struct Axis {
    /// With its unit.
    pub label: String,
    pub is_log: bool,
    /// Found from what is drawn where it is not given.
    pub range: Option<[f64; 2]>,
    /// Names in place of numbers; empty for numbers.
    pub names: Vec<(f64, String)>,
}

impl Axis {
    pub fn linear(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            is_log: false,
            range: None,
            names: Vec::new(),
        }
    }

    /// What is not positive is not drawn.
    pub fn log(label: impl Into<String>) -> Self {
        Self {
            is_log: true,
            ..Self::linear(label)
        }
    }

    /// Names at 0, 1, 2 and so on.
    pub fn of_names<S: Into<String>>(
        label: impl Into<String>,
        names: impl IntoIterator<Item = S>,
    ) -> Self {
        let names: Vec<(f64, String)> = names
            .into_iter()
            .enumerate()
            .map(|(index, name)| (index as f64, name.into()))
            .collect();
        Self {
            range: Some([-0.6, names.len() as f64 - 0.4]),
            names,
            ..Self::linear(label)
        }
    }

    /// With these ends; the first may be the larger one.
    pub fn between(mut self, from: f64, to: f64) -> Self {
        self.range = Some([from, to]);
        self
    }

    /// With these names at these places, in place of numbers.
    pub fn named<S: Into<String>>(mut self, names: impl IntoIterator<Item = (f64, S)>) -> Self {
        self.names = names
            .into_iter()
            .map(|(at, name)| (at, name.into()))
            .collect();
        self
    }

    pub(super) fn shows(&self, value: f64) -> bool {
        value.is_finite() && (!self.is_log || value > 0.0)
    }

    /// Ends that hold all values, with a little room.
    pub(super) fn scale(&self, values: impl Iterator<Item = f64>) -> Scale {
        let ends = self.range.unwrap_or_else(|| {
            let all: Vec<f64> = values.filter(|&value| self.shows(value)).collect();
            let low = all.iter().copied().fold(f64::INFINITY, f64::min);
            let high = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            match (low <= high, self.is_log) {
                (false, _) => [0.1, 1.0],
                (true, true) => {
                    let room = (high / low).powf(0.05).max(1.15);
                    [low / room, high * room]
                }
                (true, false) => {
                    let room = (0.05 * (high - low)).max(1.0e-9);
                    // What begins at zero is shown from zero.
                    let from = if low >= 0.0 && low < 0.3 * high {
                        0.0
                    } else {
                        low - room
                    };
                    [from, high + room]
                }
            }
        });
        Scale {
            ends,
            is_log: self.is_log,
            names: self.names.clone(),
        }
    }
}

/// An axis with its ends found.
#[derive(Debug, Clone)]
pub struct Scale {
    pub ends: [f64; 2],
    is_log: bool,
    names: Vec<(f64, String)>,
}

impl Scale {
    fn along(&self, value: f64) -> f64 {
        if self.is_log {
            value.max(f64::MIN_POSITIVE).log10()
        } else {
            value
        }
    }

    /// Where numbers stand: one, two and five times powers of ten, as many as there is room for.
    fn ticks(&self, most: usize) -> Vec<f64> {
        let [low, high] = [
            self.ends[0].min(self.ends[1]),
            self.ends[0].max(self.ends[1]),
        ];
        if !self.names.is_empty() {
            return self.names.iter().map(|(at, _)| *at).collect();
        }
        let within = |value: &f64| *value >= low * (1.0 - 1e-9) && *value <= high * (1.0 + 1e-9);
        if self.is_log {
            let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
            let of = |factors: &[f64], every: i32| -> Vec<f64> {
                let tens = decades.clone().filter(|power| power.rem_euclid(every) == 0);
                tens.flat_map(|power| factors.iter().map(move |factor| factor * 10f64.powi(power)))
                    .filter(within)
                    .collect()
            };
            for factors in [&[1.0, 2.0, 5.0][..], &[1.0]] {
                let ticks = of(factors, 1);
                if ticks.len() <= most {
                    return ticks;
                }
            }
            return of(
                &[1.0],
                decades.clone().count().div_ceil(most.max(1)).max(2) as i32,
            );
        }
        let rough = (high - low) / most.max(1) as f64;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|factor| factor * power)
            .into_iter()
            .find(|step| *step >= rough)
            .unwrap_or(rough);
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        (first..=last).map(|index| index as f64 * step).collect()
    }
}

impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, pixels: (i32, i32)) -> i32 {
        let [from, to] = self.ends.map(|end| self.along(end));
        let part = (self.along(*value) - from) / (to - from);
        // Far outside is outside enough.
        let part = part.clamp(-4.0, 5.0);
        pixels.0 + (part * f64::from(pixels.1 - pixels.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        self.ticks(hint.max_num_points())
    }

    fn range(&self) -> Range<f64> {
        self.ends[0]..self.ends[1]
    }
}

impl ValueFormatter<f64> for Scale {
    fn format_ext(&self, value: &f64) -> String {
        let named = self.names.iter().find(|(at, _)| (at - value).abs() < 1e-9);
        named.map_or_else(|| number(*value), |(_, name)| name.clone())
    }
}

/// A number as short as it can be read: 20,000, 0.05, 10⁶, 1e-7.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1.0e-5..1.0e5).contains(&size) {
        let rounded = format!("{value:.7}");
        let text = rounded.trim_end_matches('0').trim_end_matches('.');
        if size < 1.0e4 {
            return text.into();
        }
        let split = text.len() - 3;
        return format!("{},{}", &text[..split], &text[split..]);
    }
    if size < 1.0 {
        // The font has no raised minus.
        return format!("{value:.0e}");
    }
    let power = size.log10().floor();
    let factor = (value / 10f64.powf(power) * 100.0).round() / 100.0;
    let raised: String = format!("{power}")
        .chars()
        .map(|c| match c {
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            digit => char::from_u32(0x2070 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
        })
        .collect();
    if (factor - 1.0).abs() < 1e-9 {
        format!("10{raised}")
    } else {
        format!("{factor}·10{raised}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let written = [0.0, 0.05, 5.0, 20_000.0, 100_000.0, 2.0e-6, -1.5, 1.0e-4].map(number);
        assert_eq!(
            written,
            ["0", "0.05", "5", "20,000", "10⁵", "2e-6", "-1.5", "0.0001"]
        );
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let scale = Axis::log("").scale([3.0, 4.0e3].into_iter());
        assert_eq!(scale.ticks(4), [10.0, 100.0, 1000.0]);
        assert_eq!(scale.ticks(12).first(), Some(&5.0));
        let scale = Axis::linear("").between(10.0, 0.0).scale([].into_iter());
        assert_eq!(scale.ticks(5), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(scale.map(&10.0, (0, 100)), 0);
        let scale = Axis::linear("").scale([0.0, 0.0].into_iter());
        assert!(scale.ends[0] < scale.ends[1]);
    }
}
