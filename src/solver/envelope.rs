//! The limits of the envelope in which a cloth is simulated well.

use std::fmt;

use bevy::reflect::Reflect;

use super::{step::DAMPING_REFERENCE, substepping::Substepping};

/// A limit of the envelope in which a cloth is simulated well. Beyond a limit, the simulation stays finite and
/// continues, but the cloth no longer moves as its material should. Each limit was measured by the lab's experiment
/// `stability`.
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[type_path = "bevy_drape"]
#[non_exhaustive]
pub enum ClothLimit {
    /// A spring is stretched by 15 % more than its material stretches under four times the weight of the cloth: there
    /// are too few sub-steps.
    Stretch,
    /// The largest number of sub-steps that the settings allow does not hold their tolerance.
    Tolerance,
    /// The heaviest free particle is more than 10,000 times as heavy as the lightest; more than 300 times in a mesh
    /// without tethers.
    MassRatio,
    /// The cloth is too far from its frame's origin for single precision, its own size not counted: more than 40,000
    /// spacings, or 1,000 m with 20 sub-steps in 1/60 s. Twice the sub-steps halve that distance.
    Distance,
    /// The cloth is damped so strongly that the decay of its motion depends on the sub-steps, by more than a hundredth,
    /// or a tenth in first order. The limit is a damping of 0.979 with 20 sub-steps in 1/60 s.
    Damping,
    /// A ball or capsule thinner than half a spacing approaches the cloth by more than 6 of its radii in a sub-step: it
    /// may pass through.
    SmallFastCollider,
    /// Pins force layers through each other, or contact of layers is too much work: they are so fast, so thick or so crowded.
    /// A tick compares between 4 and 17 million pairs of features of up to 8,000 particles, and 2,000 for each particle of
    /// more. It lists 512 for each. With more work, all cloths that may touch each other stop for the rest of the tick, where
    /// their layers were last apart, and go on in the next. After eight such ticks in a row nothing keeps them apart for the
    /// rest of the tick and the next eight. The same holds at once if pins move meanwhile, or if any patches began inside
    /// each other.
    Layers,
    /// The cloth began deep inside a collider, where the nearest ways out lead apart. Each piece of it is let out on one
    /// side, or left alone where another collider or a pin inside bars the way.
    Embedded,
}

/// Largest length / rest length − 1 beyond what the material gives.
const MAX_STRETCH: f32 = 0.15;
/// Of the masses of free particles: of a mesh, and of what chains of a grid or tethers hold. Those of a rectangle's corners and
/// middle differ by 4.
const MAX_MASS_RATIO: [f32; 2] = [300.0, 10_000.0];
/// In metres, at this length of a sub-step (s): rounding weighs the more the less a particle moves in one. And in
/// spacings: where it is half a per cent of one.
const MAX_DISTANCE: f32 = 1_000.0;
const MAX_SPACINGS: f32 = 40_000.0;
const USUAL_SUBSTEP: f32 = 1.0 / 1200.0;
/// Of u = −ln(1 − D) in a sub-step: a damped fall is too fast by u ⁄ (1 − e^−u), a tenth here.
const MAX_DAMPING: f32 = 0.194;
/// Of a ball, in radii in a sub-step, and which ones are meant, in spacings.
const MAX_TRAVEL: f32 = 6.0;
const SMALL: f32 = 0.5;

impl ClothLimit {
    /// All limits.
    pub const ALL: [Self; 8] = [
        Self::Stretch,
        Self::Tolerance,
        Self::MassRatio,
        Self::Distance,
        Self::Damping,
        Self::SmallFastCollider,
        Self::Layers,
        Self::Embedded,
    ];

    /// The remedy, as a part of a sentence in the log.
    pub fn remedy(self) -> &'static str {
        match self {
            Self::Stretch => {
                "more sub-steps or a tolerance (`ClothSettings`), tethers or fewer particles; pins that start and stop gently, no farther apart than the cloth is long"
            }
            Self::Tolerance => {
                "more sub-steps or a larger tolerance; sub-steps can't remove the stretch of the material itself"
            }
            Self::MassRatio => {
                "lighter particles, pins in their place, or tethers (`ClothSettings::tethers`)"
            }
            Self::Distance => {
                "a `Transform` that moves along with it: particles are simulated in its frame"
            }
            Self::Damping => "less damping (`ClothMaterial::damping`) or more sub-steps",
            Self::SmallFastCollider => "a thicker or slower collider, or a finer cloth",
            Self::Layers => {
                "slower cloth or more sub-steps; a thickness (`ClothSelfCollision`) that is no larger than the spacing"
            }
            Self::Embedded => {
                "a cloth or a collider that appears beside the other; `ClothLayers` if they shall not meet"
            }
        }
    }
}

impl ClothLimit {
    /// A quantity beyond the limit, and the largest good value, as text.
    pub(crate) fn figures(self, [quantity, good_up_to]: [f32; 2]) -> String {
        // Three digits say enough.
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
            Self::SmallFastCollider => "radii a sub-step ",
            Self::Layers => "sub-steps without ",
            Self::Embedded => "metres deep ",
        };
        format!("{what}{found} (limit {good})")
    }
}

/// The state of a cloth beyond the limit.
impl fmt::Display for ClothLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Stretch => "overstretched",
            Self::Tolerance => "stretched beyond tolerance",
            Self::MassRatio => "made of particles with too different masses",
            Self::Distance => "too far from its frame's origin",
            Self::Damping => "damped too much",
            Self::SmallFastCollider => "hit by too small and fast a collider",
            Self::Embedded => "inside of a collider that appeared in it",
            Self::Layers => "too fast, too thick, too crowded or too firmly pinned for its layers to be kept apart",
        })
    }
}

/// The quantities at the end of a tick that are compared with the limits.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct LimitInputs {
    /// The largest stretch of a structural spring.
    pub stretch: f32,
    /// The settings that hold it.
    pub substepping: Substepping,
    /// Whether it is stretched beyond its tolerance.
    pub is_beyond: bool,
    /// Length of a sub-step (s).
    pub substep: f32,
    /// The stretch that the material itself may give.
    pub material_stretch: f32,
    /// The paper's D.
    pub damping: f32,
    /// Whether tethers or the chains of a grid hold it: heavy particles hardly stretch these.
    pub holds_weight: bool,
    /// Masses of the lightest and of the heaviest particle that is free (kg).
    pub masses: [f32; 2],
    /// From the frame's origin to the cloth (m), its own size not counted.
    pub distance: f32,
    /// The smaller one of the cloth (m).
    pub spacing: f32,
    /// The longest travel of a small collider in a sub-step, in its radii.
    pub collider_travel: f32,
    /// Sub-steps of the tick in which its layers were not kept apart.
    pub lost: u32,
    /// Depth of the deepest particle inside of a collider that appeared there (m).
    pub embedded: f32,
}

impl LimitInputs {
    /// The travel of a ball or capsule in a sub-step, in its radii, if it is so small that it counts as one.
    pub fn travel_in_radii(radius: f32, travel: f32, spacing: f32) -> Option<f32> {
        (radius < SMALL * spacing && radius > 0.0).then(|| travel / radius)
    }

    /// A limit's quantity and its largest good value, if it is exceeded.
    pub fn exceeded(&self, limit: ClothLimit) -> Option<[f32; 2]> {
        let [lightest, heaviest] = self.masses;
        let quantity = match limit {
            ClothLimit::Stretch if !matches!(self.substepping, Substepping::Adaptive { .. }) => {
                [self.stretch, MAX_STRETCH + self.material_stretch]
            }
            ClothLimit::Tolerance if self.is_beyond => match self.substepping {
                Substepping::Adaptive { stretch, .. } => [self.stretch, stretch],
                Substepping::Automatic | Substepping::Fixed(_) => return None,
            },
            ClothLimit::MassRatio if lightest > 0.0 => [
                heaviest / lightest,
                MAX_MASS_RATIO[usize::from(self.holds_weight)],
            ],
            ClothLimit::Distance => {
                let by_substep = MAX_DISTANCE * self.substep / USUAL_SUBSTEP;
                [self.distance, by_substep.min(MAX_SPACINGS * self.spacing)]
            }
            ClothLimit::Damping => {
                let max = 1.0 - (-MAX_DAMPING * DAMPING_REFERENCE / self.substep).exp();
                [self.damping, max]
            }
            ClothLimit::SmallFastCollider => [self.collider_travel, MAX_TRAVEL],
            ClothLimit::Layers => [self.lost as f32, 0.0],
            ClothLimit::Embedded => [self.embedded, 0.0],
            ClothLimit::Stretch | ClothLimit::Tolerance | ClothLimit::MassRatio => return None,
        };
        (quantity[0] > quantity[1]).then_some(quantity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inside of all limits, at most of them.
    const WITHIN: LimitInputs = LimitInputs {
        stretch: MAX_STRETCH,
        substepping: Substepping::Fixed(20),
        is_beyond: false,
        substep: USUAL_SUBSTEP,
        material_stretch: 0.0,
        damping: 0.97,
        holds_weight: false,
        masses: [1.0e-4, 1.0e-4 * MAX_MASS_RATIO[0]],
        distance: MAX_DISTANCE,
        spacing: 0.03,
        collider_travel: MAX_TRAVEL,
        lost: 0,
        embedded: 0.0,
    };

    fn beyond(limit_inputs: LimitInputs) -> Vec<ClothLimit> {
        let exceeds = |limit: &ClothLimit| limit_inputs.exceeded(*limit).is_some();
        ClothLimit::ALL.into_iter().filter(exceeds).collect()
    }

    #[test]
    fn each_limit_is_exceeded_alone() {
        assert_eq!(beyond(WITHIN), []);
        let exceeded = [
            (
                LimitInputs {
                    stretch: 0.16,
                    ..WITHIN
                },
                ClothLimit::Stretch,
            ),
            (
                LimitInputs {
                    masses: [1.0e-4, 3.1e-2],
                    ..WITHIN
                },
                ClothLimit::MassRatio,
            ),
            (
                LimitInputs {
                    distance: 1.1e3,
                    ..WITHIN
                },
                ClothLimit::Distance,
            ),
            (
                LimitInputs {
                    damping: 0.99,
                    ..WITHIN
                },
                ClothLimit::Damping,
            ),
            (
                LimitInputs {
                    damping: 1.0,
                    ..WITHIN
                },
                ClothLimit::Damping,
            ),
            (
                LimitInputs {
                    collider_travel: 7.0,
                    ..WITHIN
                },
                ClothLimit::SmallFastCollider,
            ),
            (LimitInputs { lost: 1, ..WITHIN }, ClothLimit::Layers),
            (
                LimitInputs {
                    embedded: 0.1,
                    ..WITHIN
                },
                ClothLimit::Embedded,
            ),
        ];
        for (limit_inputs, limit) in exceeded {
            assert_eq!(beyond(limit_inputs), [limit]);
        }
        // Halved sub-steps reach half as far, and hold more damping.
        let halved = LimitInputs {
            substep: USUAL_SUBSTEP / 2.0,
            distance: 0.51 * MAX_DISTANCE,
            damping: 0.99,
            ..WITHIN
        };
        assert_eq!(beyond(halved), [ClothLimit::Distance]);
        // A fine cloth is rounded sooner, and one that is walked with for 11 m is not.
        let fine = |distance: f32| LimitInputs {
            spacing: 0.001,
            distance,
            ..WITHIN
        };
        assert_eq!(beyond(fine(11.0)), []);
        assert_eq!(beyond(fine(41.0)), [ClothLimit::Distance]);
    }

    #[test]
    fn a_tolerance_is_beyond_where_the_cap_stops_it() {
        let substepping = Substepping::Adaptive {
            stretch: 0.01,
            max_substeps: 20,
        };
        let tolerant = LimitInputs {
            substepping,
            ..WITHIN
        };
        assert_eq!(beyond(tolerant), [], "it takes more sub-steps");
        let capped = LimitInputs {
            is_beyond: true,
            ..tolerant
        };
        assert_eq!(beyond(capped), [ClothLimit::Tolerance]);
        assert_eq!(capped.exceeded(ClothLimit::Tolerance), Some([0.15, 0.01]));
    }

    #[test]
    fn chains_and_tethers_hold_heavier_particles() {
        let ratio = |ratio: f32| LimitInputs {
            holds_weight: true,
            masses: [1.0e-4, 1.0e-4 * ratio],
            ..WITHIN
        };
        assert_eq!(beyond(ratio(9.9e3)), []);
        assert_eq!(beyond(ratio(1.1e4)), [ClothLimit::MassRatio]);
    }

    #[test]
    fn what_the_material_gives_is_no_fault() {
        let rubber = |stretch: f32| LimitInputs {
            stretch,
            material_stretch: 0.3,
            ..WITHIN
        };
        assert_eq!(beyond(rubber(0.44)), []);
        assert_eq!(beyond(rubber(0.46)), [ClothLimit::Stretch]);
    }

    #[test]
    fn a_small_collider_is_thinner_than_half_a_spacing() {
        assert_eq!(LimitInputs::travel_in_radii(0.04, 0.4, 0.1), Some(10.0));
        assert_eq!(LimitInputs::travel_in_radii(0.06, 0.4, 0.1), None);
        assert_eq!(LimitInputs::travel_in_radii(0.0, 0.4, 0.1), None);
    }
}
