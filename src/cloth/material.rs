//! What a cloth is made of.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::ClothError;

/// What a cloth is made of. May change at any time.
///
/// A compliance is that of a *square patch of the cloth*, whatever the patch's size: pulled by one newton at
/// two opposite edges, that kind of springs alone would let it grow by this many metres. A square's compliance
/// does not depend on its size, so stretch and shear keep their meaning under any resolution: a spring of a
/// strip `w` wide and `l` long gets compliance × l ⁄ w. Zero is rigid.
///
/// Bending is resisted by the same law between every second particle. Such a chord shortens with the fourth
/// power of a bend's sharpness: it keeps folds from closing, softly at first, and is weaker on a finer grid.
///
/// A mesh has no rows: its stretch springs run along all edges, each standing for the area of the faces beside it, and give
/// alike in all directions. They resist shear as well, as much as an isotropic sheet of that stretch and a Poisson's ratio of a
/// third; only a shear compliance below the stretch compliance adds to that. Bend springs join the two corners that face each
/// other across an edge.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothMaterial {
    /// Mass per area (kg/m²), positive.
    pub areal_density: f32,
    /// Compliance along rows and columns (m/N), zero or more.
    pub stretch_compliance: f32,
    /// Compliance along both diagonals (m/N), zero or more; infinite for no shear springs.
    pub shear_compliance: f32,
    /// Compliance between every second particle (m/N), zero or more; infinite for no bend springs.
    pub bend_compliance: f32,
    /// The paper's D: the part of its velocity that the cloth loses in 1/60 s, from 0 to 1.
    pub damping: f32,
    /// Coulomb's μ against colliders, zero or more.
    pub friction: f32,
}

impl Default for ClothMaterial {
    fn default() -> Self {
        Self::COTTON
    }
}

impl ClothMaterial {
    /// A plain cotton weave, as in a bed sheet.
    pub const COTTON: Self = Self {
        areal_density: 0.15,
        stretch_compliance: 1.0e-4,
        shear_compliance: 1.0e-3,
        bend_compliance: 1.0e-1,
        damping: 0.01,
        friction: 0.4,
    };
    /// Thin, slippery, and free to shear and fold.
    pub const SILK: Self = Self {
        areal_density: 0.06,
        stretch_compliance: 2.0e-4,
        shear_compliance: 1.0e-2,
        bend_compliance: 2.0,
        damping: 0.005,
        friction: 0.2,
    };
    /// Heavy and stiff, as in a sail or a tent.
    pub const CANVAS: Self = Self {
        areal_density: 0.4,
        stretch_compliance: 2.0e-5,
        shear_compliance: 1.0e-4,
        bend_compliance: 2.0e-3,
        damping: 0.02,
        friction: 0.6,
    };
    /// Stretchy and grippy, as a thin rubber sheet.
    pub const RUBBER: Self = Self {
        areal_density: 1.0,
        stretch_compliance: 3.0e-3,
        shear_compliance: 3.0e-3,
        bend_compliance: 1.0e-1,
        damping: 0.03,
        friction: 0.9,
    };
    /// The named materials, for menus.
    pub const PRESETS: [(&str, Self); 4] = [
        ("cotton", Self::COTTON),
        ("silk", Self::SILK),
        ("canvas", Self::CANVAS),
        ("rubber", Self::RUBBER),
    ];

    /// Whether each value is in its range.
    ///
    /// # Errors
    /// [`ClothError::Quantity`] for the first that is not.
    pub fn validate(&self) -> Result<(), ClothError> {
        let check = ClothError::check;
        let finite = |v: f32| v >= 0.0 && v.is_finite();
        let not_negative = |v: f32| v >= 0.0;
        check(
            self.areal_density,
            |v: f32| v > 0.0 && v.is_finite(),
            "areal density (kg/m²)",
            "positive",
        )?;
        let range = "zero or more, and finite";
        check(
            self.stretch_compliance,
            finite,
            "stretch compliance (m/N)",
            range,
        )?;
        check(self.friction, finite, "friction μ", range)?;
        let range = "zero or more";
        check(
            self.shear_compliance,
            not_negative,
            "shear compliance (m/N)",
            range,
        )?;
        check(
            self.bend_compliance,
            not_negative,
            "bend compliance (m/N)",
            range,
        )?;
        let unit = |v: f32| (0.0..=1.0).contains(&v);
        check(self.damping, unit, "damping D", "from 0 to 1")?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_valid_and_each_bad_value_is_named() {
        for (name, material) in ClothMaterial::PRESETS {
            assert_eq!(material.validate(), Ok(()), "{name}");
        }
        let bad: [(fn(&mut ClothMaterial, f32), &[f32], &str); 6] = [
            (
                |m, v| m.areal_density = v,
                &[0.0, -1.0, f32::NAN, f32::INFINITY],
                "density",
            ),
            (
                |m, v| m.stretch_compliance = v,
                &[-1.0, f32::NAN, f32::INFINITY],
                "stretch",
            ),
            (|m, v| m.shear_compliance = v, &[-1.0, f32::NAN], "shear"),
            (|m, v| m.bend_compliance = v, &[-1.0, f32::NAN], "bend"),
            (|m, v| m.damping = v, &[-0.1, 1.1, f32::NAN], "damping"),
            (
                |m, v| m.friction = v,
                &[-0.1, f32::NAN, f32::INFINITY],
                "friction",
            ),
        ];
        for (set, values, name) in bad {
            for &value in values {
                let mut material = ClothMaterial::default();
                set(&mut material, value);
                let message = material.validate().expect_err(name).to_string();
                assert!(message.contains(name), "{message}");
                assert!(message.contains(&value.to_string()), "{message}");
            }
        }
    }
}
