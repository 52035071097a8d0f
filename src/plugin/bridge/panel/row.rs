//! Rows of the panel: a name, a widget, and an explanation, all of the same width whatever their text.

use std::ops::RangeInclusive;

use bevy_egui::egui::{self, Align, ComboBox, Label, Layout, Response, Slider, SliderClamping, Ui};

/// Width of a name, of a slider, and of the value beside it (logical pixels).
pub(super) const NAME: f32 = 84.0;
pub(super) const SLIDER: f32 = 110.0;
const VALUE: f32 = 62.0;

/// Largest height of an open menu (logical pixels): all searches fit.
const MENU: f32 = 400.0;

/// A name, and a widget beside it.
pub(super) fn row<R>(ui: &mut Ui, name: &str, tip: &str, add: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        let size = egui::vec2(NAME, ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
            ui.set_width(NAME);
            ui.add(Label::new(name).selectable(false).truncate());
        })
        .response
        .on_hover_text(tip);
        ui.spacing_mut().slider_width = SLIDER;
        ui.spacing_mut().interact_size.x = VALUE;
        ui.spacing_mut().combo_width = SLIDER + VALUE;
        add(ui)
    })
    .inner
}

/// A slider that leaves a value outside its range alone until someone moves it. Returns whether someone did.
pub(super) fn slide<T: egui::emath::Numeric>(
    ui: &mut Ui,
    name: &str,
    tip: &str,
    value: &mut T,
    range: RangeInclusive<T>,
    look: impl FnOnce(Slider<'_>) -> Slider<'_>,
) -> bool {
    let slider = look(Slider::new(value, range).clamping(SliderClamping::Edits));
    row(ui, name, tip, |ui| ui.add(slider))
        .on_hover_text(tip)
        .changed()
}

/// A logarithmic slider of a number that is often small, and may be zero.
pub(super) fn slide_small(
    ui: &mut Ui,
    name: &str,
    tip: &str,
    value: &mut f32,
    range: RangeInclusive<f32>,
) {
    let smallest = f64::from(*range.end() * 1.0e-7);
    slide(ui, name, tip, value, range, |slider| {
        slider.logarithmic(true).smallest_positive(smallest)
    });
}

/// A menu of values with their names and explanations. It leaves a value that is not among them alone.
pub(super) fn choose<T: Clone + PartialEq>(
    ui: &mut Ui,
    name: &str,
    tip: &str,
    value: &mut T,
    now: &str,
    all: impl IntoIterator<Item = (String, String, T)>,
) -> Response {
    row(ui, name, tip, |ui| {
        ComboBox::from_id_salt(name)
            .selected_text(now)
            .truncate()
            .height(MENU)
            .show_ui(ui, |ui| {
                for (name, tip, each) in all {
                    let choice = ui.selectable_value(value, each, name);
                    if !tip.is_empty() {
                        choice.on_hover_text(tip);
                    }
                }
            })
            .response
    })
    .on_hover_text(tip)
}

/// A line of text that is cut off where the panel ends; all of it is in the tooltip.
pub(super) fn line(ui: &mut Ui, text: impl Into<egui::RichText>, tip: &str) {
    ui.add(Label::new(text.into()).selectable(false).truncate())
        .on_hover_text(tip);
}
