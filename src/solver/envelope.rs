//! The envelope in which a cloth is simulated well, and by what it may be left.

use std::fmt;

use bevy::reflect::Reflect;

use super::{Precision, substep::DAMPING_REFERENCE};

/// A limit of the envelope in which a cloth is simulated well. Beyond one it stays finite and goes on, but it no longer
/// moves as its material says. Each was measured by the lab's experiment `stability`.
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ClothLimit {
    /// A spring is stretched by 15 % more than its material gives under four times the weight of the cloth: the sub-steps
    /// do not hold it.
    Stretch,
    /// The most sub-steps that the settings allow do not hold the tolerance that they ask for.
    Tolerance,
    /// The heaviest particle that is free is more than 300 times as heavy as the lightest, or with tethers more than
    /// 10,000 times.
    MassRatio,
    /// The cloth is farther from its frame's origin, its own size not counted, than single precision resolves well: 1,000 m
    /// with 20 sub-steps in 1/60 s, half of it with twice as many, and 40,000 spacings.
    Distance,
    /// The cloth is damped so much that how fast it falls depends on the sub-steps, by more than a tenth: above 0.979
    /// with 20 sub-steps in 1/60 s.
    Damping,
    /// A ball or capsule thinner than half a spacing comes to the cloth by more than 6 of its radii in a sub-step: it may
    /// get through.
    Dart,
}

/// Largest length / rest length − 1 beyond what the material gives.
const MOST_STRETCH: f32 = 0.15;
/// Of the masses of free particles, without tethers and with. Those of a rectangle's corners and middle differ by 4.
const MOST_MASS_RATIO: [f32; 2] = [300.0, 10_000.0];
/// In metres, at this length of a sub-step (s): rounding weighs the more the less a particle moves in one. And in
/// spacings: where it is half a per cent of one.
const MOST_DISTANCE: f32 = 1_000.0;
const MOST_SPACINGS: f32 = 40_000.0;
const USUAL_SUBSTEP: f32 = 1.0 / 1200.0;
/// Of u = −ln(1 − D) in a sub-step: a damped fall is too fast by u ⁄ (1 − e^−u), a tenth here.
const MOST_DAMPING: f32 = 0.194;
/// Of a ball, in radii in a sub-step, and which ones are meant, in spacings.
const MOST_WAY: f32 = 6.0;
const SMALL: f32 = 0.5;

impl ClothLimit {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Stretch,
        Self::Tolerance,
        Self::MassRatio,
        Self::Distance,
        Self::Damping,
        Self::Dart,
    ];

    /// What brings the cloth back.
    pub fn remedy(self) -> &'static str {
        match self {
            Self::Stretch => {
                "more sub-steps or a tolerance (`ClothSettings`), tethers or fewer particles; pins that start and stop gently, no farther apart than the cloth is long"
            }
            Self::Tolerance => {
                "more sub-steps or a larger tolerance; what the material itself gives no sub-steps take away"
            }
            Self::MassRatio => {
                "lighter particles, pins in their place, or tethers (`ClothSettings::tethers`)"
            }
            Self::Distance => {
                "a `Transform` that moves along with it: particles are simulated in its frame"
            }
            Self::Damping => "less damping (`ClothMaterial::damping`) or more sub-steps",
            Self::Dart => "a thicker or slower collider, or a finer cloth",
        }
    }
}

impl ClothLimit {
    /// A quantity beyond it and up to where that is good, in words.
    pub(crate) fn figures(self, [quantity, good_up_to]: [f32; 2]) -> String {
        // Three digits tell enough.
        let digits = |value: f32| match value {
            100.0.. => format!("{value:.0}"),
            10.0.. => format!("{value:.1}"),
            _ => format!("{value:.3}"),
        };
        let percent = |value: f32| {
            let percent = 100.0 * value;
            let is_whole = (percent - percent.round()).abs() < 0.05 || percent >= 100.0;
            let decimals = usize::from(!is_whole);
            format!("{percent:.decimals$} %")
        };
        let [found, good] = match self {
            Self::Stretch | Self::Tolerance => [quantity, good_up_to].map(percent),
            _ => [quantity, good_up_to].map(digits),
        };
        let what = match self {
            Self::Stretch | Self::Tolerance => "",
            Self::MassRatio => "heaviest to lightest ",
            Self::Distance => "metres ",
            Self::Damping => "D ",
            Self::Dart => "radii a sub-step ",
        };
        format!("{what}{found} (limit {good})")
    }
}

/// What a cloth beyond it is.
impl fmt::Display for ClothLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Stretch => "overstretched",
            Self::Tolerance => "stretched beyond tolerance",
            Self::MassRatio => "made of too different masses",
            Self::Distance => "too far from its frame's origin",
            Self::Damping => "damped too much",
            Self::Dart => "met by too small and fast a collider",
        })
    }
}

/// What is asked of a cloth at the end of a tick.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct Load {
    /// The largest stretch of a structural spring.
    pub stretch: f32,
    /// By what it is held.
    pub precision: Precision,
    /// Whether the cap on sub-steps stopped it short of its tolerance.
    pub is_capped: bool,
    /// Length of a sub-step (s).
    pub substep: f32,
    /// The stretch that the material itself may give.
    pub given: f32,
    /// The paper's D.
    pub damping: f32,
    /// Whether tethers hold it.
    pub is_tethered: bool,
    /// Masses of the lightest and of the heaviest particle that is free (kg).
    pub masses: [f32; 2],
    /// From the frame's origin to the cloth (m), its own size not counted.
    pub distance: f32,
    /// The smaller one of the cloth (m).
    pub spacing: f32,
    /// The longest way of a small collider in a sub-step, in its radii.
    pub way: f32,
}

impl Load {
    /// The way of a ball or capsule in a sub-step, in its radii, if it is so small that it counts as one.
    pub fn way_of(radius: f32, way: f32, spacing: f32) -> Option<f32> {
        (radius < SMALL * spacing && radius > 0.0).then(|| way / radius)
    }

    /// A limit's quantity and up to where it is good, if it is exceeded.
    pub fn beyond(&self, limit: ClothLimit) -> Option<[f32; 2]> {
        let [lightest, heaviest] = self.masses;
        let quantity = match limit {
            ClothLimit::Stretch if matches!(self.precision, Precision::Substeps(_)) => {
                [self.stretch, MOST_STRETCH + self.given]
            }
            ClothLimit::Tolerance if self.is_capped => match self.precision {
                Precision::Tolerance { stretch, .. } => [self.stretch, stretch],
                Precision::Substeps(_) => return None,
            },
            ClothLimit::MassRatio if lightest > 0.0 => [
                heaviest / lightest,
                MOST_MASS_RATIO[usize::from(self.is_tethered)],
            ],
            ClothLimit::Distance => {
                let by_substep = MOST_DISTANCE * self.substep / USUAL_SUBSTEP;
                [self.distance, by_substep.min(MOST_SPACINGS * self.spacing)]
            }
            ClothLimit::Damping => {
                let most = 1.0 - (-MOST_DAMPING * DAMPING_REFERENCE / self.substep).exp();
                [self.damping, most]
            }
            ClothLimit::Dart => [self.way, MOST_WAY],
            ClothLimit::Stretch | ClothLimit::Tolerance | ClothLimit::MassRatio => return None,
        };
        (quantity[0] > quantity[1]).then_some(quantity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inside of all limits, at most of them.
    const WITHIN: Load = Load {
        stretch: MOST_STRETCH,
        precision: Precision::Substeps(20),
        is_capped: false,
        substep: USUAL_SUBSTEP,
        given: 0.0,
        damping: 0.97,
        is_tethered: false,
        masses: [1.0e-4, 1.0e-4 * MOST_MASS_RATIO[0]],
        distance: MOST_DISTANCE,
        spacing: 0.03,
        way: MOST_WAY,
    };

    fn beyond(load: Load) -> Vec<ClothLimit> {
        let exceeds = |limit: &ClothLimit| load.beyond(*limit).is_some();
        ClothLimit::ALL.into_iter().filter(exceeds).collect()
    }

    #[test]
    fn each_limit_is_exceeded_alone() {
        assert_eq!(beyond(WITHIN), []);
        let exceeded = [
            (
                Load {
                    stretch: 0.16,
                    ..WITHIN
                },
                ClothLimit::Stretch,
            ),
            (
                Load {
                    masses: [1.0e-4, 3.1e-2],
                    ..WITHIN
                },
                ClothLimit::MassRatio,
            ),
            (
                Load {
                    distance: 1.1e3,
                    ..WITHIN
                },
                ClothLimit::Distance,
            ),
            (
                Load {
                    damping: 0.99,
                    ..WITHIN
                },
                ClothLimit::Damping,
            ),
            (
                Load {
                    damping: 1.0,
                    ..WITHIN
                },
                ClothLimit::Damping,
            ),
            (Load { way: 7.0, ..WITHIN }, ClothLimit::Dart),
        ];
        for (load, limit) in exceeded {
            assert_eq!(beyond(load), [limit]);
        }
        // Halved sub-steps reach half as far, and hold more damping.
        let halved = Load {
            substep: USUAL_SUBSTEP / 2.0,
            distance: 0.51 * MOST_DISTANCE,
            damping: 0.99,
            ..WITHIN
        };
        assert_eq!(beyond(halved), [ClothLimit::Distance]);
        // A fine cloth is rounded sooner, and one that is walked with for 11 m is not.
        let fine = |distance: f32| Load {
            spacing: 0.001,
            distance,
            ..WITHIN
        };
        assert_eq!(beyond(fine(11.0)), []);
        assert_eq!(beyond(fine(41.0)), [ClothLimit::Distance]);
    }

    #[test]
    fn a_tolerance_is_beyond_where_the_cap_stops_it() {
        let precision = Precision::Tolerance {
            stretch: 0.01,
            most_substeps: 20,
        };
        let tolerant = Load {
            precision,
            ..WITHIN
        };
        assert_eq!(beyond(tolerant), [], "it takes more sub-steps");
        let capped = Load {
            is_capped: true,
            ..tolerant
        };
        assert_eq!(beyond(capped), [ClothLimit::Tolerance]);
        assert_eq!(capped.beyond(ClothLimit::Tolerance), Some([0.15, 0.01]));
    }

    #[test]
    fn tethers_hold_heavier_particles() {
        let ratio = |ratio: f32| Load {
            is_tethered: true,
            masses: [1.0e-4, 1.0e-4 * ratio],
            ..WITHIN
        };
        assert_eq!(beyond(ratio(9.9e3)), []);
        assert_eq!(beyond(ratio(1.1e4)), [ClothLimit::MassRatio]);
    }

    #[test]
    fn what_the_material_gives_is_no_fault() {
        let rubber = |stretch: f32| Load {
            stretch,
            given: 0.3,
            ..WITHIN
        };
        assert_eq!(beyond(rubber(0.44)), []);
        assert_eq!(beyond(rubber(0.46)), [ClothLimit::Stretch]);
    }

    #[test]
    fn a_dart_is_thinner_than_half_a_spacing() {
        assert_eq!(Load::way_of(0.04, 0.4, 0.1), Some(10.0));
        assert_eq!(Load::way_of(0.06, 0.4, 0.1), None);
        assert_eq!(Load::way_of(0.0, 0.4, 0.1), None);
    }
}
