//! The material of a cloth.

mod presets;
mod stiffening;

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::cloth::quantity::{Allowed, QuantityError};
pub use stiffening::ClothStiffening;

/// The material of a cloth. May change at any time.
///
/// A compliance is that of a *square patch of the cloth*. Pull two opposite edges of the patch with one newton: if only
/// springs of that kind resisted, the patch would grow by this many metres. The size of the patch does not matter, so
/// stretch and shear mean the same at any resolution. The spring of a strip `w` wide and `l` long gets
/// compliance × l ⁄ w. Zero is rigid.
///
/// Cloth resists bending like an elastic plate, by its flexural rigidity D. The moment D w ⁄ r holds a strip of width w
/// bent to the radius r. Textile laboratories measure D by bending a sample (KES-F, in gf·cm²/cm: one is 9.81·10⁻⁵ N·m)
/// or by letting it hang over an edge (Peirce 1930, Cusick 1965). D means the same at any resolution and width. Without a
/// [`weft`](Self::weft), it is the same in all directions. Poisson's ratio in bending is 0, so that free edges do not curl.
///
/// A mesh has no rows. Its stretch springs run along all edges, and each represents the area of the faces beside it.
/// They stretch alike in all directions, and also resist shear, like an isotropic sheet with a Poisson's ratio of a
/// third. A shear compliance below the stretch compliance adds springs across each edge, between the two opposite
/// corners. A larger one changes nothing.
///
/// A woven cloth differs along its two sets of yarns. [`weft`](Self::weft) holds what differs across: along the rows
/// of a grid, or across a mesh's [grain](crate::cloth::ClothGrain). The other values are then those along the warp:
/// down the columns of a grid, or along the grain. A mesh takes the stiffer direction as at most a hundred times as stiff as
/// the other, in stretch and in bending. A strip of it stretches like one of a grid, shear springs included. With the
/// stiffnesses a and b of both, its shear stiffness is at least √(a b) × 3⁄8.
#[derive(Component, Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default))]
pub struct ClothMaterial {
    /// Mass per area (kg/m²), positive.
    pub areal_density: f32,
    /// Compliance along rows and columns (m/N), zero or more. With a [`weft`](Self::weft), that along the warp.
    pub stretch_compliance: f32,
    /// Compliance along both diagonals (m/N), zero or more; infinity for no shear springs.
    pub shear_compliance: f32,
    /// Flexural rigidity (N·m): the moment that holds a strip bent to a curvature of 1/m, per metre of its width. Zero
    /// or more, finite. Zero bends freely and costs nothing. With a [`weft`](Self::weft), that of a strip along the warp. Folds stay
    /// in cloth with a [`ClothCreasing`](crate::solver::ClothCreasing).
    pub bend_rigidity: f32,
    /// The values that differ along the weft. `None` is a cloth that is alike in both directions.
    pub weft: Option<ClothWeft>,
    /// How it stiffens as it stretches. `None` is a cloth that stretches in proportion to its load.
    pub stiffening: Option<ClothStiffening>,
    /// Damping along springs, the internal loss of the material: the time (s) in which a released stretch decays to
    /// 1/e. It is the τ of a Kelvin-Voigt solid, zero or more and finite. The damping ratio of an oscillation of
    /// angular frequency ω is τ ω/2. It conserves momentum and does not slow a fall. Rigid springs do not stretch and
    /// lose nothing. Zero costs nothing.
    pub stretch_damping: f32,
    /// The paper's D, the internal loss of the material: the fraction of its relative velocity that the cloth loses in
    /// 1/60 s, from 0 to 1.
    ///
    /// The velocity of a pinned cloth is relative to the mean velocity of its pins: a cape hangs the same in a moving
    /// vehicle as in a parked one. That of a cloth without pins, or of a piece without pins, is
    /// relative to its centre of mass: all materials fall alike, and damping slows only how they turn and ripple. [`Solver`](crate::solver::Solver), used on its own, damps relative
    /// to the velocity in [`TickStep`](crate::solver::TickStep).
    pub damping: f32,
    /// Coulomb's μ against colliders, zero or more.
    pub friction: f32,
}

/// Values of a [`ClothMaterial`] along its weft: the rows of a grid, or across the grain of a mesh. The default is cotton's.
#[derive(Reflect, Debug, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default))]
pub struct ClothWeft {
    /// Compliance (m/N), zero or more.
    pub stretch_compliance: f32,
    /// Flexural rigidity (N·m), zero or more, finite. Twist has the geometric mean of warp and weft, as in an orthotropic
    /// plate by Huber (1923).
    pub bend_rigidity: f32,
}

impl Default for ClothWeft {
    fn default() -> Self {
        Self {
            stretch_compliance: ClothMaterial::COTTON.stretch_compliance,
            bend_rigidity: ClothMaterial::COTTON.bend_rigidity,
        }
    }
}

impl Default for ClothMaterial {
    fn default() -> Self {
        Self::COTTON
    }
}

impl ClothMaterial {
    /// Checks that each value is in its range.
    ///
    /// # Errors
    /// [`QuantityError`] for the first value that is out of range.
    pub fn validate(&self) -> Result<(), QuantityError> {
        let finite = |value, quantity| Allowed::SIZE.check(quantity, [value]);
        Allowed::LENGTH.check("areal density (kg/m²)", [self.areal_density])?;
        finite(self.stretch_compliance, "stretch compliance (m/N)")?;
        finite(self.bend_rigidity, "bending rigidity (N·m)")?;
        if let Some(weft) = self.weft {
            let stretch = weft.stretch_compliance;
            finite(stretch, "stretch compliance of the weft (m/N)")?;
            finite(weft.bend_rigidity, "bending rigidity of the weft (N·m)")?;
        }
        if let Some(stiffening) = self.stiffening {
            stiffening.validate()?;
        }
        finite(self.friction, "friction μ")?;
        let or_infinite = Allowed(|v| v >= 0.0, "zero or more");
        or_infinite.check("shear compliance (m/N)", [self.shear_compliance])?;
        finite(self.stretch_damping, "damping along springs (s)")?;
        Allowed::SHARE.check("damping D", [self.damping])
    }

    /// Stretch compliances along rows, the weft, and along columns, the warp (m/N).
    pub(crate) fn stretch_compliances(&self) -> [f32; 2] {
        let warp = self.stretch_compliance;
        [self.weft.map_or(warp, |weft| weft.stretch_compliance), warp]
    }

    /// Whether it differs along its weft.
    pub(crate) fn is_woven(&self) -> bool {
        let differs = |[weft, warp]: [f32; 2]| weft != warp;
        differs(self.stretch_compliances()) || differs(self.bend_rigidities())
    }

    /// The same material where all of it stretches and shears more easily: by this factor of its stiffness.
    pub(crate) fn softer(&self, factor: f32) -> Self {
        let weft = |weft: ClothWeft| ClothWeft {
            stretch_compliance: weft.stretch_compliance / factor,
            ..weft
        };
        Self {
            stretch_compliance: self.stretch_compliance / factor,
            shear_compliance: self.shear_compliance / factor,
            weft: self.weft.map(weft),
            ..*self
        }
    }

    /// The strain under a tension (N/m) of warp or weft, whichever gives more.
    pub(crate) fn largest_strain(&self, tension: f32) -> f32 {
        let [weft, warp] = self.stretch_compliances();
        let linear = weft.max(warp) * tension;
        (self.stiffening).map_or(linear, |stiffening| stiffening.strain_of(linear))
    }

    /// The stretch compliances of a mesh (m/N). Where warp and weft differ, they are those of strips of a grid: shear springs,
    /// which a mesh need not have, add to both.
    pub(crate) fn woven_stretch(&self) -> Woven {
        let compliances = self.stretch_compliances();
        if !self.is_woven() {
            return Woven::of(compliances);
        }
        let [weft, warp] = compliances.map(|compliance| 1.0 / f64::from(compliance));
        let shear = f64::from(self.shear_compliance);
        // Rigid ones stay infinite; 1 ⁄ (1 ⁄ s + 1 ⁄ b) is s b ⁄ (s + b).
        let strip = |along: f64, beside: f64| 1.0 / (along + 1.0 / (shear + 1.0 / beside));
        Woven::of([strip(weft, warp), strip(warp, weft)].map(|compliance| compliance as f32))
    }

    /// Flexural rigidities of a mesh (N·m).
    pub(crate) fn woven_bending(&self) -> Woven {
        Woven::of(self.bend_rigidities())
    }

    /// Flexural rigidities of strips along the weft and along the warp (N·m).
    pub(crate) fn bend_rigidities(&self) -> [f32; 2] {
        let warp = self.bend_rigidity;
        [self.weft.map_or(warp, |weft| weft.bend_rigidity), warp]
    }
}

/// Two values of a mesh's material, along weft and warp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Woven {
    /// Their geometric mean.
    pub mean: f32,
    /// The fourth root of the ratio of the weft's to the warp's.
    pub ratio: f32,
}

impl Woven {
    /// The largest ratio of two values of a mesh.
    const FARTHEST_APART: f32 = 100.0;

    fn of([weft, warp]: [f32; 2]) -> Self {
        let of = |own: f32, other: f32| f64::from(own.max(other / Self::FARTHEST_APART));
        let (weft, warp) = (of(weft, warp), of(warp, weft));
        let (mean, ratio) = match weft == warp {
            true => (weft, 1.0),
            false => ((weft * warp).sqrt(), (weft / warp).powf(0.25)),
        };
        Self {
            mean: mean as f32,
            ratio: ratio as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strips of a grid, and of a mesh, are as stiff as those that were measured.
    #[test]
    fn measured_presets_have_what_was_measured() {
        for (material, [warp, weft]) in [
            (ClothMaterial::DENIM, [1013.9_f32, 205.4]),
            (ClothMaterial::TROUSERS, [2035.0, 2016.6]),
            (ClothMaterial::POLYESTER, [2027.5, 2002.1]),
            (ClothMaterial::INTERLOCK_KNIT, [34.5, 16.6]),
            (ClothMaterial::RIB_KNIT, [65.2, 42.9]),
        ] {
            let Woven { mean, ratio } = material.woven_stretch();
            let found = [1.0 / (mean / ratio.powi(2)), 1.0 / (mean * ratio.powi(2))];
            for (found, measured) in found.into_iter().zip([warp, weft]) {
                assert!(
                    (found / measured - 1.0).abs() < 1.0e-4,
                    "{found} {measured}"
                );
            }
        }
    }

    #[test]
    fn presets_are_valid_and_each_bad_value_is_named() {
        for (name, material) in ClothMaterial::PRESETS {
            assert_eq!(material.validate(), Ok(()), "{name}");
        }
        let bad: [(fn(&mut ClothMaterial, f32), &[f32], &str); 11] = [
            (
                |m, strain| {
                    m.stiffening = Some(ClothStiffening {
                        strain,
                        ..ClothStiffening::default()
                    });
                },
                &[0.0, -0.1, 11.0, f32::NAN],
                "strain beyond",
            ),
            (
                |m, factor| {
                    m.stiffening = Some(ClothStiffening {
                        factor,
                        ..ClothStiffening::default()
                    });
                },
                &[0.5, f32::NAN, f32::INFINITY],
                "factor by which",
            ),
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
            (
                |m, v| m.bend_rigidity = v,
                &[-1.0, f32::NAN, f32::INFINITY],
                "bending",
            ),
            (
                |m, v| m.stretch_damping = v,
                &[-1.0e-3, f32::INFINITY, f32::NAN],
                "along springs",
            ),
            (|m, v| m.damping = v, &[-0.1, 1.1, f32::NAN], "damping"),
            (
                |m, stretch_compliance| {
                    m.weft = Some(ClothWeft {
                        stretch_compliance,
                        ..ClothWeft::default()
                    });
                },
                &[-0.1, f32::NAN, f32::INFINITY],
                "stretch compliance of the weft",
            ),
            (
                |m, bend_rigidity| {
                    m.weft = Some(ClothWeft {
                        bend_rigidity,
                        ..ClothWeft::default()
                    });
                },
                &[-0.1, f32::NAN, f32::INFINITY],
                "bending rigidity of the weft",
            ),
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
