//! Properties of fabric in plain words: each is a scale from 0 to 100 over one or two values of a material.

use crate::cloth::ClothMaterial;

/// A quality of fabric that a slider of the panel sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quality {
    Stretchy,
    Stiff,
    Heavy,
    Slippery,
    Damped,
}

/// Ends of the scales, which exceed the knits' stretch and canvas' bending.
const STRETCH: Logarithmic = Logarithmic([1.0e-7, 1.0e-1]);
const BEND: Logarithmic = Logarithmic([1.0e-7, 1.0e-2]);
const DENSITY: Logarithmic = Logarithmic([0.02, 5.0]);
/// The maximum damping D of the scale.
const DAMPING: f32 = 0.2;

impl Quality {
    pub const ALL: [Self; 5] = [
        Self::Stretchy,
        Self::Stiff,
        Self::Heavy,
        Self::Slippery,
        Self::Damped,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Stretchy => "stretchy",
            Self::Stiff => "stiff",
            Self::Heavy => "heavy",
            Self::Slippery => "slippery",
            Self::Damped => "damped",
        }
    }

    /// The preset that a material was most likely made from: it shares the most qualities, and differs least in the others.
    pub fn nearest(material: &ClothMaterial) -> (&'static str, ClothMaterial) {
        let differences = |preset: &ClothMaterial| {
            let each = Self::ALL.map(|quality| (quality.of(preset) - quality.of(material)).abs());
            let changed = each.iter().filter(|difference| **difference > 0.0).count();
            (changed, each.iter().sum::<f32>())
        };
        let found = ClothMaterial::PRESETS.map(|preset| (differences(&preset.1), preset));
        let nearest = found
            .into_iter()
            .reduce(|a, b| if b.0 < a.0 { b } else { a });
        nearest.map_or(ClothMaterial::PRESETS[0], |(_, preset)| preset)
    }

    /// Value of a material on the scale; below 0 or above 100 if it is beyond.
    pub fn of(self, material: &ClothMaterial) -> f32 {
        match self {
            Self::Stretchy if material.stretch_compliance == 0.0 => 0.0,
            Self::Stretchy => STRETCH.place(material.stretch_compliance),
            Self::Stiff if material.bend_rigidity == 0.0 => 0.0,
            Self::Stiff => BEND.place(material.bend_rigidity),
            Self::Heavy => DENSITY.place(material.areal_density),
            Self::Slippery => 100.0 * (1.0 - material.friction),
            Self::Damped => 100.0 * material.damping / DAMPING,
        }
    }

    /// Sets this quality of a material. Its other values stay as they are. The weft keeps its ratio to the warp.
    pub fn set(self, material: &mut ClothMaterial, place: f32) {
        let weft = material.weft.as_mut();
        match self {
            Self::Stretchy => {
                let (warp, value) = (
                    &mut material.stretch_compliance,
                    STRETCH.value_or_none(place),
                );
                set_both(warp, weft.map(|weft| &mut weft.stretch_compliance), value);
            }
            Self::Stiff => {
                let (warp, value) = (&mut material.bend_rigidity, BEND.value_or_none(place));
                set_both(warp, weft.map(|weft| &mut weft.bend_rigidity), value);
            }
            Self::Heavy => material.areal_density = DENSITY.value(place),
            Self::Slippery => material.friction = (1.0 - place / 100.0).max(0.0),
            Self::Damped => material.damping = (DAMPING * place / 100.0).clamp(0.0, 1.0),
        }
    }

    /// Explains the physics: quantity, exact value with its unit, and the values at both ends of the scale.
    pub fn explain(self, material: &ClothMaterial) -> String {
        let ClothMaterial {
            areal_density,
            stretch_compliance,
            bend_rigidity,
            damping,
            friction,
            ..
        } = material;
        match self {
            Self::Stretchy => format!(
                "How much the cloth gives when pulled.\n\
                 Stretch compliance: {stretch_compliance} m/N. A square patch, pulled by 1 N, grows by {} mm.\n\
                 0 % is rigid, 1 % is 0.0000001 m/N, 100 % is {} m/N.",
                1.0e3 * stretch_compliance,
                STRETCH.0[1]
            ),
            Self::Stiff => format!(
                "How much the cloth resists bending and folding.\n\
                 Flexural rigidity: {bend_rigidity} N·m. A strip of 1 cm width, bent to a radius of 1 cm, needs {} N·mm.\n\
                 0 % is none, 100 % is {} N·m. Silk has 0.000002 N·m, canvas 0.00036 N·m.",
                1.0e3 * bend_rigidity,
                BEND.0[1]
            ),
            Self::Heavy => format!(
                "How much the cloth weighs.\n\
                 Mass per area: {areal_density} kg/m².\n\
                 0 % is {} kg/m², 100 % is {} kg/m². A shirt has 0.12 kg/m², jeans have 0.45 kg/m².",
                DENSITY.0[0], DENSITY.0[1]
            ),
            Self::Slippery => format!(
                "How easily the cloth slides over colliders.\n\
                 Coulomb's coefficient of friction μ: {friction} (no unit).\n\
                 0 % is μ = 1, which holds on a slope of 45°; 100 % is μ = 0, without friction."
            ),
            Self::Damped => format!(
                "How soon the cloth calms down.\n\
                 Damping D: {damping} (no unit), the share of its velocity that it loses in 1/60 s.\n\
                 0 % is D = 0, 100 % is D = {DAMPING}."
            ),
        }
    }
}

/// Sets the value of the warp, and that of the weft in the same ratio; from or to 0, to the same value.
fn set_both(warp: &mut f32, weft: Option<&mut f32>, value: f32) {
    if let Some(weft) = weft {
        let scaled = *weft * (value / *warp);
        *weft = if *warp > 0.0 { scaled } else { value };
    }
    *warp = value;
}

/// A logarithmic scale from the value at 0 to that at 100.
struct Logarithmic([f32; 2]);

impl Logarithmic {
    fn place(&self, value: f32) -> f32 {
        let [start, end] = self.0;
        100.0 * (value / start).ln() / (end / start).ln()
    }

    /// The value at a place, 0 at the lower end.
    fn value_or_none(&self, place: f32) -> f32 {
        if place > 0.0 { self.value(place) } else { 0.0 }
    }

    fn value(&self, place: f32) -> f32 {
        let [start, end] = self.0;
        start * (end / start).powf(place / 100.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_scale_goes_both_ways_and_leaves_the_others_alone() {
        for (name, preset) in ClothMaterial::PRESETS {
            for quality in Quality::ALL {
                let at = quality.of(&preset);
                assert!((0.0..=100.0).contains(&at), "{name} {quality:?}: {at}");
                for place in [0.0, 1.0, 37.0, 100.0] {
                    let mut material = preset;
                    quality.set(&mut material, place);
                    assert_eq!(material.validate(), Ok(()));
                    assert!((quality.of(&material) - place).abs() < 1.0e-3);
                    for other in Quality::ALL {
                        let same = other.of(&material) == other.of(&preset);
                        assert!(same || other == quality, "{quality:?} moves {other:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_weft_keeps_its_ratio() {
        let mut denim = ClothMaterial::DENIM;
        let ratios = |material: &ClothMaterial| {
            let weft = material.weft.unwrap_or_default();
            [
                weft.stretch_compliance / material.stretch_compliance,
                weft.bend_rigidity / material.bend_rigidity,
            ]
        };
        let before = ratios(&denim);
        Quality::Stretchy.set(&mut denim, 30.0);
        Quality::Stiff.set(&mut denim, 70.0);
        for (now, before) in ratios(&denim).into_iter().zip(before) {
            assert!((now / before - 1.0).abs() < 1.0e-5, "{now} {before}");
        }
        // Rigid and back.
        Quality::Stretchy.set(&mut denim, 0.0);
        assert_eq!(denim.weft.map(|weft| weft.stretch_compliance), Some(0.0));
        Quality::Stretchy.set(&mut denim, 30.0);
        assert_eq!(ratios(&denim)[0], 1.0);
    }

    #[test]
    fn more_of_it_is_more_of_it() {
        let [silk, canvas, rubber] = [
            ClothMaterial::SILK,
            ClothMaterial::CANVAS,
            ClothMaterial::RUBBER,
        ];
        assert!(Quality::Stretchy.of(&rubber) > Quality::Stretchy.of(&canvas));
        assert!(Quality::Stiff.of(&canvas) > Quality::Stiff.of(&silk));
        assert!(Quality::Heavy.of(&rubber) > Quality::Heavy.of(&silk));
        assert!(Quality::Slippery.of(&silk) > Quality::Slippery.of(&rubber));
    }

    #[test]
    fn what_has_no_place_on_a_scale_is_at_its_end() {
        let mut loose = ClothMaterial {
            stretch_compliance: 0.0,
            bend_rigidity: 0.0,
            ..ClothMaterial::COTTON
        };
        assert_eq!(Quality::Stretchy.of(&loose), 0.0);
        assert_eq!(Quality::Stiff.of(&loose), 0.0);
        Quality::Stiff.set(&mut loose, 50.0);
        assert_eq!(loose.validate(), Ok(()));
        assert!(loose.bend_rigidity > 0.0);
    }
}
