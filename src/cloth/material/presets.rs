//! Materials by name, with the source of their values.

use super::{ClothMaterial, ClothWeft};

/// Denim, trousers, polyester and the knits are materials of Wang, O'Brien and Ramamoorthi 2011, Data-driven elastic models
/// for cloth, by their published files. Stretch and shear are those at the smallest strain, bending that at the smallest
/// curvature. The direction u of a file is taken for the weft, v for the warp.
///
/// | preset | measured | estimated |
/// |---|---|---|
/// | [`DENIM`](Self::DENIM), [`TROUSERS`](Self::TROUSERS), [`POLYESTER`](Self::POLYESTER) | density, stretch, shear, bending | friction, damping |
/// | [`INTERLOCK_KNIT`](Self::INTERLOCK_KNIT), [`RIB_KNIT`](Self::RIB_KNIT) | density, stretch, bending | friction, damping; shear is a quarter of the measured one, as springs allow no more |
/// | [`COTTON`](Self::COTTON), [`SILK`](Self::SILK) | bending (KES-F) | density, stretch, shear, friction, damping |
/// | [`LEATHER`](Self::LEATHER) | drape (Memon et al.) | all else |
/// | [`RUBBER`](Self::RUBBER) | modulus of natural rubber, for bending | all else |
/// | [`CANVAS`](Self::CANVAS), [`FELT`](Self::FELT) | – | all |
impl ClothMaterial {
    /// A plain cotton weave, as in a bed sheet. Rigidity: 0.06 gf·cm²/cm, similar to KES-F measurements of light
    /// shirting; here it drapes by 41 to 46 %.
    pub const COTTON: Self = Self {
        areal_density: 0.15,
        stretch_compliance: 1.0e-4,
        shear_compliance: 1.0e-3,
        bend_rigidity: 6.0e-6,
        weft: None,
        stiffening: None,
        stretch_damping: 0.0,
        damping: 0.01,
        friction: 0.4,
    };
    /// Thin, slippery, easy to shear and fold. Rigidity: 0.02 gf·cm²/cm, similar to KES-F measurements of light plain
    /// silks.
    pub const SILK: Self = Self {
        areal_density: 0.06,
        stretch_compliance: 2.0e-4,
        shear_compliance: 1.0e-2,
        bend_rigidity: 2.0e-6,
        damping: 0.005,
        friction: 0.2,
        ..Self::COTTON
    };
    /// An 11 oz cotton twill, as in jeans: five times as stiff along its warp as along its weft.
    pub const DENIM: Self = Self {
        areal_density: 0.324,
        damping: 0.02,
        friction: 0.5,
        ..Self::measured([1013.9, 205.4], 53.4, [9.70e-5, 6.42e-5])
    };
    /// A cotton twill, as in trousers.
    pub const TROUSERS: Self = Self {
        areal_density: 0.220,
        damping: 0.02,
        friction: 0.5,
        ..Self::measured([2035.0, 2016.6], 104.8, [1.254e-4, 1.254e-4])
    };
    /// A polyester weave, as in a tablecloth: easy to shear.
    pub const POLYESTER: Self = Self {
        areal_density: 0.128,
        damping: 0.01,
        friction: 0.3,
        ..Self::measured([2027.5, 2002.1], 19.2, [3.13e-5, 5.17e-5])
    };
    /// A double knit, as in a T-shirt: it gives sixty times as much as polyester along its warp.
    pub const INTERLOCK_KNIT: Self = Self {
        areal_density: 0.187,
        damping: 0.03,
        friction: 0.5,
        ..Self::measured([34.5, 16.6], 9.2, [1.43e-5, 2.32e-5])
    };
    /// A ribbed knit, as in cuffs and jumpers.
    pub const RIB_KNIT: Self = Self {
        areal_density: 0.276,
        damping: 0.03,
        friction: 0.6,
        ..Self::measured([65.2, 42.9], 20.8, [3.22e-5, 4.62e-5])
    };

    /// Strips along warp and weft have these stiffnesses, shear has that one (N/m), and bending these rigidities (N·m).
    /// Shear springs add to the stiffness of a strip, so the others get less: `a = stiff − s b ⁄ (b + s)`, solved by
    /// iteration.
    const fn measured([warp, weft]: [f32; 2], shear: f32, bend: [f32; 2]) -> Self {
        let (mut along, mut across) = (warp, weft);
        let mut round = 0;
        while round < 30 {
            along = warp - shear * across / (across + shear);
            across = weft - shear * along / (along + shear);
            round += 1;
        }
        Self {
            stretch_compliance: 1.0 / along,
            shear_compliance: 1.0 / shear,
            bend_rigidity: bend[0],
            weft: Some(ClothWeft {
                stretch_compliance: 1.0 / across,
                bend_rigidity: bend[1],
            }),
            ..Self::COTTON
        }
    }

    /// Heavy and stiff, as in a sail or a tent. Rigidity: that of a bending length c of 4.5 cm by D = g ρ c³ (Peirce
    /// 1930), an estimate for unwashed cotton duck.
    pub const CANVAS: Self = Self {
        areal_density: 0.4,
        stretch_compliance: 2.0e-5,
        shear_compliance: 1.0e-4,
        bend_rigidity: 3.6e-4,
        damping: 0.02,
        friction: 0.6,
        ..Self::COTTON
    };
    /// Pressed wool, a millimetre thick, as in a hat: the same in all directions, and stiff in shear. Rigidity: that of
    /// a bending length c of 3.4 cm by D = g ρ c³ (Peirce 1930), an estimate.
    pub const FELT: Self = Self {
        areal_density: 0.25,
        stretch_compliance: 5.0e-4,
        shear_compliance: 1.0e-3,
        bend_rigidity: 1.0e-4,
        damping: 0.04,
        friction: 0.6,
        ..Self::COTTON
    };
    /// Sheepskin, 0.8 mm thick, as in a jacket. Rigidity: chosen so that it drapes like garment leathers of 0.64 to
    /// 0.96 mm, by 47 to 70 % (Memon et al. 2021, Materials 14, 4553).
    pub const LEATHER: Self = Self {
        areal_density: 0.5,
        stretch_compliance: 2.0e-4,
        shear_compliance: 4.0e-4,
        bend_rigidity: 5.0e-5,
        damping: 0.04,
        friction: 0.6,
        ..Self::COTTON
    };
    /// Stretchy and grippy, like a thin rubber sheet. Rigidity: that of a millimetre of natural rubber with a Young's
    /// modulus of 1.5 N/mm², E h³ ⁄ 12 (1 − ν²).
    pub const RUBBER: Self = Self {
        areal_density: 1.0,
        stretch_compliance: 3.0e-3,
        shear_compliance: 3.0e-3,
        bend_rigidity: 1.7e-4,
        damping: 0.03,
        friction: 0.9,
        ..Self::COTTON
    };
    /// The named materials, for menus.
    pub const PRESETS: [(&str, Self); 11] = [
        ("cotton", Self::COTTON),
        ("silk", Self::SILK),
        ("denim", Self::DENIM),
        ("trousers", Self::TROUSERS),
        ("polyester", Self::POLYESTER),
        ("interlock knit", Self::INTERLOCK_KNIT),
        ("rib knit", Self::RIB_KNIT),
        ("canvas", Self::CANVAS),
        ("felt", Self::FELT),
        ("leather", Self::LEATHER),
        ("rubber", Self::RUBBER),
    ];
}
