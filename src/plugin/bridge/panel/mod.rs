//! An egui panel at the window's left edge: the properties of the fabric on top, the simulation's settings folded
//! below.

mod debugging;
mod fabric;
mod quality;
mod row;
#[cfg(test)]
mod tests;

use bevy::{
    camera::Viewport,
    diagnostic::DiagnosticsStore,
    ecs::system::SystemParam,
    prelude::{
        App, Commands, Component, DetectChangesMut, Entity, Fixed, Name, Plugin, Query, Reflect,
        ReflectComponent, ReflectDefault, ReflectResource, Res, ResMut, Resource, Result, Time,
        UVec2, Virtual,
    },
};
use bevy_egui::{
    EguiContexts, EguiPlugin, EguiPrimaryContextPass,
    egui::{self, CollapsingHeader, Frame, Id, RichText, ScrollArea, Ui},
};

use crate::{cloth::ClothMaterial, plugin::authoring::ClothGravity};
use debugging::PanelCloth;
use quality::Quality;
use row::{choose, line, slide};

/// The panel at the left edge of the window: as high as the window, and always [`WIDTH`](Self::WIDTH) wide.
///
/// It covers part of the camera's picture. To draw beside the panel instead, set the camera's
/// [`viewport`](Self::viewport) whenever panel or window change. Give egui a camera of its own then, since egui is laid
/// out in its camera's viewport:
///
/// ```
/// use bevy::{camera::RenderTarget, prelude::*, window::PrimaryWindow};
/// use bevy_drape::plugin::ClothPanel;
///
/// fn draw_beside_panel(
///     panel: Res<ClothPanel>,
///     window: Single<&Window, With<PrimaryWindow>>,
///     mut camera: Single<&mut Camera, With<Camera3d>>,
/// ) {
///     camera.viewport = panel.viewport(window.physical_size(), window.scale_factor());
/// }
/// ```
#[derive(Resource, Reflect, Debug, Clone, PartialEq, Eq)]
#[type_path = "bevy_drape"]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct ClothPanel {
    /// Shown or hidden.
    pub visible: bool,
    /// The game's keys and what they do. The panel lists them at its lower edge and never scrolls them out of sight.
    pub keys: Vec<(String, String)>,
}

impl Default for ClothPanel {
    fn default() -> Self {
        Self {
            visible: true,
            keys: Vec::new(),
        }
    }
}

/// At most this many cloths start unfolded.
const MOST_OPEN: usize = 2;
/// At most this many cloths start as a list of names: more are folded under one header.
const MOST_LISTED: usize = 8;

impl ClothPanel {
    /// Width of the panel while it is shown (logical pixels).
    pub const WIDTH: f32 = 304.0;

    /// The part of a window of this size (physical pixels) that the panel leaves free. `None` stands for the whole
    /// window: while the panel is hidden, or if the window is no wider than twice the panel.
    pub fn viewport(&self, window: UVec2, scale_factor: f32) -> Option<Viewport> {
        let panel = (Self::WIDTH * scale_factor).round() as u32;
        (self.visible && window.x > 2 * panel && window.y > 0).then(|| Viewport {
            physical_position: UVec2::new(panel, 0),
            physical_size: UVec2::new(window.x - panel, window.y),
            ..Default::default()
        })
    }
}

/// Speed of a collider (m/s), set by the panel. The game reads it and moves the collider.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothColliderSpeed(pub f32);

/// Shows a panel on the primary window. It has pause and single step (of the fixed schedules) and the time of a tick,
/// gravity, and the speed of each collider with a [`ClothColliderSpeed`]. For each cloth it sets the fabric: by
/// presets, or by sliders for stretch, stiffness, weight, slipperiness and damping. Folded below are search and gizmos,
/// sub-steps, and the exact values of the material. The game's keys stay in sight at the
/// lower edge. Each value has its unit and a tooltip.
///
/// Adds `EguiPlugin` if the app has none yet. The resource [`ClothPanel`] shows and hides it.
#[derive(Debug, Default, Clone, Copy)]
pub struct ClothPanelPlugin;

impl Plugin for ClothPanelPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<EguiPlugin>() {
            app.add_plugins(EguiPlugin::default());
        }
        app.register_type::<ClothPanel>()
            .register_type::<ClothColliderSpeed>()
            .init_resource::<ClothPanel>()
            .init_resource::<ClothGravity>()
            .add_systems(EguiPrimaryContextPass, draw_panel);
    }
}

fn draw_panel(mut contexts: EguiContexts, mut shown: Shown) -> Result {
    if shown.panel.visible {
        shown.draw(contexts.ctx_mut()?);
    }
    Ok(())
}

type Speed = &'static mut ClothColliderSpeed;

/// Everything that the panel shows and sets.
#[derive(SystemParam)]
struct Shown<'w, 's> {
    panel: Res<'w, ClothPanel>,
    cloths: Query<'w, 's, PanelCloth>,
    speeds: Query<'w, 's, (Entity, Option<&'static Name>, Speed)>,
    gravity: ResMut<'w, ClothGravity>,
    running: ResMut<'w, Time<Virtual>>,
    fixed: ResMut<'w, Time<Fixed>>,
    diagnostics: Option<Res<'w, DiagnosticsStore>>,
    commands: Commands<'w, 's>,
}

impl Shown<'_, '_> {
    /// Draws the panel and returns the rectangle that it covers.
    fn draw(&mut self, context: &egui::Context) -> egui::Rect {
        let place = egui::vec2(ClothPanel::WIDTH, context.content_rect().height());
        // An area instead of egui's side panel, so that egui knows of a mouse over it.
        let area = egui::Area::new(Id::new("bevy_drape: panel"))
            .fixed_pos(egui::Pos2::ZERO)
            .constrain(false)
            .movable(false)
            .show(context, |ui| {
                // Content that does not fit is cut off, as it must not widen the panel.
                let (rect, _) = ui.allocate_exact_size(place, egui::Sense::hover());
                let frame = Frame::side_top_panel(ui.style());
                ui.painter().rect_filled(rect, 0.0, frame.fill);
                let inside = egui::UiBuilder::new().max_rect(rect.shrink(10.0));
                let mut inside = ui.new_child(inside);
                inside.shrink_clip_rect(rect);
                self.draw_keys(&mut inside);
                ScrollArea::vertical()
                    .auto_shrink(false)
                    .show(&mut inside, |ui| self.draw_all(ui));
            });
        area.response.rect
    }

    fn draw_all(&mut self, ui: &mut Ui) {
        self.draw_clock(ui);
        let count = self.cloths.iter().len();
        if count > MOST_LISTED {
            ui.separator();
            CollapsingHeader::new(RichText::new(format!("{count} cloths")).strong())
                .id_salt("cloths")
                .show_unindented(ui, |ui| self.draw_cloths(ui));
        } else {
            self.draw_cloths(ui);
        }
        ui.separator();
        self.draw_world(ui);
        ui.separator();
        CollapsingHeader::new("debugging")
            .default_open(false)
            .show_unindented(ui, |ui| self.draw_debugging(ui));
    }

    fn draw_cloths(&mut self, ui: &mut Ui) {
        let few = self.cloths.iter().len() <= MOST_OPEN;
        for mut cloth in &mut self.cloths {
            ui.separator();
            // Menus take their ids from their names, which are the same for every cloth.
            ui.push_id(cloth.entity, |ui| {
                CollapsingHeader::new(RichText::new(cloth.name()).strong())
                    .id_salt("fabric")
                    .default_open(few)
                    .show_unindented(ui, |ui| draw_fabric(ui, &mut cloth.material));
            });
        }
    }

    fn draw_debugging(&mut self, ui: &mut Ui) {
        let few = self.cloths.iter().len() <= MOST_OPEN;
        for mut cloth in &mut self.cloths {
            ui.push_id(cloth.entity, |ui| {
                if few {
                    debugging::show(ui, &mut cloth, *self.gravity, &mut self.commands);
                } else {
                    CollapsingHeader::new(cloth.name())
                        .id_salt("debugging")
                        .show_unindented(ui, |ui| {
                            debugging::show(ui, &mut cloth, *self.gravity, &mut self.commands);
                        });
                }
            });
        }
    }

    /// The keys, at the lower edge: in sight whatever is above them.
    fn draw_keys(&self, ui: &mut Ui) {
        if self.panel.keys.is_empty() {
            return;
        }
        let most = 0.5 * ui.available_height();
        egui::Panel::bottom("bevy_drape: keys")
            .frame(Frame::NONE.inner_margin(egui::Margin {
                top: 4,
                ..Default::default()
            }))
            .show(ui, |ui| {
                ScrollArea::vertical()
                    .auto_shrink([false, true])
                    .min_scrolled_height(most)
                    .max_height(most)
                    .show(ui, |ui| {
                        CollapsingHeader::new("keys")
                            .default_open(true)
                            .show_unindented(ui, |ui| list_keys(ui, &self.panel.keys));
                    });
            });
    }

    /// Pause and step, and a line with the state of the cloths.
    fn draw_clock(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let paused = self.running.is_paused();
            let button = egui::Button::new(if paused { "Run" } else { "Pause" });
            if ui.add(button.min_size(egui::vec2(64.0, 0.0))).clicked() {
                if paused {
                    self.running.unpause();
                } else {
                    self.running.pause();
                }
            }
            let step = ui.add_enabled(paused, egui::Button::new("Single step"));
            let timestep = self.fixed.timestep();
            let milliseconds = timestep.as_secs_f64() * 1.0e3;
            let tip = format!("One fixed tick: {milliseconds:.1} ms of simulated time");
            let step = step.on_hover_text(&tip).on_disabled_hover_text(tip);
            if step.clicked() {
                self.fixed.accumulate_overstep(timestep);
            }
        });
        let times = self.diagnostics.as_deref().map(debugging::times);
        let (time, mut tip) = times.unwrap_or_default();
        let (mut cloths, mut asleep) = (0, 0);
        let mut limits = Vec::new();
        for cloth in &self.cloths {
            cloths += 1;
            asleep += usize::from(cloth.stats.is_asleep);
            limits.extend(cloth.stats.exceeded);
        }
        tip += "A cloth at rest sleeps and costs almost nothing.";
        for limit in &limits {
            let remedy = limit.remedy();
            tip += &format!("\nOutside the range that simulates well: {limit} {remedy}.");
        }
        let state = match (limits.is_empty(), cloths, asleep) {
            (false, ..) => "beyond its limits".to_string(),
            (_, _, 0) => "moving".to_string(),
            (_, 1, _) => "asleep".to_string(),
            _ => format!("{asleep} of {cloths} asleep"),
        };
        let mut text = RichText::new(format!("{time} · {state}")).monospace();
        if !limits.is_empty() {
            text = text.color(ui.visuals().warn_fg_color);
        }
        line(ui, text, &tip);
    }

    /// Settings that all cloths share.
    fn draw_world(&mut self, ui: &mut Ui) {
        let mut down = -self.gravity.0.y;
        let tip = "Gravity, downwards (m/s²): 9.81 on Earth, 1.62 on the Moon. A cloth with its own gravity keeps it";
        slide(ui, "gravity", tip, &mut down, 0.0..=25.0, |slider| {
            slider.fixed_decimals(2).suffix(" m/s²")
        });
        let changed = ClothGravity(self.gravity.0.with_y(-down));
        self.gravity.set_if_neq(changed);
        for (entity, name, mut speed) in &mut self.speeds {
            let name = name.map_or_else(|| entity.to_string(), ToString::to_string);
            let mut value = speed.0;
            let tip = format!("Speed of {name} (m/s)");
            slide(ui, &name, &tip, &mut value, 0.0..=10.0, |slider| {
                slider.fixed_decimals(2).suffix(" m/s")
            });
            speed.set_if_neq(ClothColliderSpeed(value));
        }
    }
}

fn list_keys(ui: &mut Ui, keys: &[(String, String)]) {
    egui::Grid::new("keys")
        .spacing([10.0, 1.0])
        .min_row_height(0.0)
        .show(ui, |ui| {
            for (key, what) in keys {
                ui.strong(key);
                ui.label(what);
                ui.end_row();
            }
        });
}

/// A preset, and how stretchy, stiff, heavy, slippery and damped the fabric is. Only what someone moves is changed.
fn draw_fabric(ui: &mut Ui, material: &mut impl DetectChangesMut<Inner = ClothMaterial>) {
    let mut changed = *material.bypass_change_detection();
    let presets = ClothMaterial::PRESETS;
    let (name, preset) = Quality::nearest(&changed);
    let mark = if preset == changed { "" } else { ", changed" };
    let now = format!("{name}{mark}");
    choose(
        ui,
        "fabric",
        "The preset that the cloth started from. “changed”: a value differs from the preset",
        &mut changed,
        &now,
        presets.map(|(name, preset)| {
            let qualities =
                Quality::ALL.map(|each| format!("{} {:.0} %", each.name(), each.of(&preset)));
            (name.to_string(), qualities.join(", "), preset)
        }),
    );
    for quality in Quality::ALL {
        let mut place = quality.of(&changed);
        let (name, tip) = (quality.name(), quality.explain(&changed));
        if slide(ui, name, &tip, &mut place, 0.0..=100.0, |slider| {
            slider.fixed_decimals(0).suffix(" %")
        }) {
            quality.set(&mut changed, place);
        }
    }
    material.set_if_neq(changed);
}
