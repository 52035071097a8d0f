//! The sliders of fabrics with a weft, and of those that stiffen.

use bevy_egui::egui::Ui;

use super::row::{slide, slide_small};
use crate::cloth::{ClothMaterial, ClothWeft};

/// Whether the cloth differs along its weft, and its values there.
pub(super) fn show_weft(ui: &mut Ui, material: &mut ClothMaterial) {
    let mut is_woven = material.weft.is_some();
    ui.checkbox(&mut is_woven, "has a weft").on_hover_text(
        "Whether it stretches and bends differently along its rows, or across the grain of a mesh",
    );
    let same = ClothWeft {
        stretch_compliance: material.stretch_compliance,
        bend_rigidity: material.bend_rigidity,
    };
    material.weft = is_woven.then_some(material.weft.unwrap_or(same));
    let Some(weft) = &mut material.weft else {
        return;
    };
    let tip = "Stretch compliance along the weft (m/N). 0 is rigid";
    let stretch = &mut weft.stretch_compliance;
    slide_small(ui, "weft, m/N", tip, stretch, 0.0..=10.0);
    let tip = "Flexural rigidity along the weft (N·m). 0 bends freely";
    slide_small(ui, "weft, N·m", tip, &mut weft.bend_rigidity, 0.0..=0.01);
}

/// Whether the cloth stiffens as it stretches, and how.
pub(super) fn show_stiffening(ui: &mut Ui, material: &mut ClothMaterial) {
    let mut stiffens = material.stiffening.is_some();
    ui.checkbox(&mut stiffens, "stiffens").on_hover_text(
        "Whether it is stiffer once it is stretched, as a knit. A grid is then solved as a mesh, which takes longer",
    );
    material.stiffening = stiffens.then_some(material.stiffening.unwrap_or_default());
    let Some(stiffening) = &mut material.stiffening else {
        return;
    };
    let tip = "Strain from which on it is stiffer: elongation over length (no unit)";
    let strain = &mut stiffening.strain;
    slide(ui, "from a strain of", tip, strain, 0.001..=1.0, |slider| {
        slider.logarithmic(true)
    });
    let tip = "How many times as stiff it is there (no unit)";
    let factor = &mut stiffening.factor;
    slide(ui, "times as stiff", tip, factor, 1.0..=1000.0, |slider| {
        slider.logarithmic(true)
    });
}
