//! The envelope in which a cloth is simulated well, and by what it may be left.

use std::fmt;

use bevy::reflect::Reflect;

use super::Precision;

/// A limit of the envelope in which a cloth is simulated well. Beyond one it stays finite and goes on, but it no longer
/// moves as its material says. Each limit was measured: the README's table says where.
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ClothLimit {
    /// The sub-steps, and not the material, let a spring stretch by more than a tenth.
    Stretch,
    /// The most sub-steps that the settings allow do not hold the tolerance that they ask for.
    Tolerance,
    /// The heaviest particle that is free is more than 300 times as heavy as the lightest, or with tethers more than
    /// 10,000 times.
    MassRatio,
    /// A particle is farther from the origin of its cloth's frame than single precision resolves well: 20,000 spacings.
    Distance,
}

/// Largest length / rest length − 1 that sub-steps may leave.
const MOST_STRETCH: f32 = 0.1;
/// Of the masses of free particles, without tethers and with. Those of a rectangle's corners and middle differ by 4.
const MOST_MASS_RATIO: [f32; 2] = [300.0, 10_000.0];
/// In spacings: there a float's step is a thousandth of one.
const MOST_DISTANCE: f32 = 20_000.0;

impl ClothLimit {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Stretch,
        Self::Tolerance,
        Self::MassRatio,
        Self::Distance,
    ];

    /// What brings the cloth back.
    pub fn remedy(self) -> &'static str {
        match self {
            Self::Stretch => {
                "take more sub-steps, a tolerance instead (`ClothSettings::tolerance`), tethers or fewer particles; pins farther apart than the cloth is long hold nothing"
            }
            Self::Tolerance => {
                "allow more sub-steps, or a larger stretch; what the material itself gives no sub-steps take away"
            }
            Self::MassRatio => {
                "make the heavy particles lighter, pin them, or give the cloth tethers (`ClothSettings::tethers`)"
            }
            Self::Distance => {
                "move the cloth's `Transform` along with it: particles are simulated in its frame"
            }
        }
    }
}

impl fmt::Display for ClothLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Stretch => "largest stretch",
            Self::Tolerance => "largest stretch, for which it has a tolerance",
            Self::MassRatio => "ratio of the masses of its particles",
            Self::Distance => "distance from the origin of its frame, in spacings",
        })
    }
}

/// What is asked of a cloth at the end of a tick.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct Load {
    /// The largest stretch of a structural spring.
    pub stretch: f32,
    /// By what it is held.
    pub precision: Precision,
    /// Whether the cap on sub-steps stopped it short of its tolerance.
    pub is_capped: bool,
    /// Length of a sub-step (s).
    pub substep: f32,
    /// The stretch compliance of the material (m/N).
    pub compliance: f32,
    /// Whether tethers hold it.
    pub is_tethered: bool,
    /// Masses of the lightest and of the heaviest particle that is free (kg).
    pub masses: [f32; 2],
    /// Of the particle that is farthest from the frame's origin, in spacings.
    pub distance: f32,
}

impl Load {
    /// A limit's quantity and how far it is good, if it is exceeded.
    pub fn beyond(&self, limit: ClothLimit) -> Option<[f32; 2]> {
        let [lightest, heaviest] = self.masses;
        let quantity = match limit {
            // A sweep is as stiff as mass/Δt²: what is softer stretches as it should.
            ClothLimit::Stretch
                if matches!(self.precision, Precision::Substeps(_))
                    && self.compliance * lightest < 2.0 * self.substep * self.substep =>
            {
                [self.stretch, MOST_STRETCH]
            }
            ClothLimit::Tolerance if self.is_capped => match self.precision {
                Precision::Tolerance { stretch, .. } => [self.stretch, stretch],
                Precision::Substeps(_) => return None,
            },
            ClothLimit::MassRatio if lightest > 0.0 => [
                heaviest / lightest,
                MOST_MASS_RATIO[usize::from(self.is_tethered)],
            ],
            ClothLimit::Distance => [self.distance, MOST_DISTANCE],
            ClothLimit::Stretch | ClothLimit::Tolerance | ClothLimit::MassRatio => return None,
        };
        (quantity[0] > quantity[1]).then_some(quantity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inside of all limits, at each of them.
    const WITHIN: Load = Load {
        stretch: MOST_STRETCH,
        precision: Precision::Substeps(20),
        is_capped: false,
        substep: 1.0e-3,
        compliance: 1.0e-4,
        is_tethered: false,
        masses: [1.0e-4, 1.0e-4 * MOST_MASS_RATIO[0]],
        distance: MOST_DISTANCE,
    };

    fn beyond(load: Load) -> Vec<ClothLimit> {
        let exceeds = |limit: &ClothLimit| load.beyond(*limit).is_some();
        ClothLimit::ALL.into_iter().filter(exceeds).collect()
    }

    #[test]
    fn each_limit_is_exceeded_alone() {
        assert_eq!(beyond(WITHIN), []);
        assert_eq!(beyond(Load::default()), []);
        let stretched = Load {
            stretch: 0.11,
            ..WITHIN
        };
        assert_eq!(beyond(stretched), [ClothLimit::Stretch]);
        let precision = Precision::Tolerance {
            stretch: 0.01,
            most_substeps: 20,
        };
        let tolerant = Load {
            precision,
            ..stretched
        };
        assert_eq!(beyond(tolerant), [], "its tick is not over");
        let capped = Load {
            is_capped: true,
            ..tolerant
        };
        assert_eq!(beyond(capped), [ClothLimit::Tolerance]);
        assert_eq!(capped.beyond(ClothLimit::Tolerance), Some([0.11, 0.01]));
        let heavy = Load {
            masses: [1.0e-4, 3.1e-2],
            ..WITHIN
        };
        assert_eq!(beyond(heavy), [ClothLimit::MassRatio]);
        let tethered = Load {
            is_tethered: true,
            ..heavy
        };
        assert_eq!(beyond(tethered), []);
        let heavier = Load {
            masses: [1.0e-4, 1.1],
            ..tethered
        };
        assert_eq!(beyond(heavier), [ClothLimit::MassRatio]);
        let far = Load {
            distance: 2.1e4,
            ..WITHIN
        };
        assert_eq!(beyond(far), [ClothLimit::Distance]);
    }

    /// With α of the material above 2 Δt²/m the springs are softer than the sweep: their stretch is the material's.
    #[test]
    fn what_the_material_gives_is_no_fault() {
        let rubber = Load {
            stretch: 0.5,
            compliance: 2.1e-2,
            ..WITHIN
        };
        assert_eq!(beyond(rubber), []);
        let stiffer = Load {
            compliance: 1.9e-2,
            ..rubber
        };
        assert_eq!(beyond(stiffer), [ClothLimit::Stretch]);
    }
}
