//! An egui panel with every setting of the cloths and live figures.

use std::ops::RangeInclusive;

use bevy::{
    app::{App, Plugin},
    diagnostic::{Diagnostic, DiagnosticPath, DiagnosticsStore},
    ecs::{
        change_detection::DetectChangesMut,
        component::Component,
        entity::Entity,
        error::Result,
        name::Name,
        query::QueryData,
        reflect::{ReflectComponent, ReflectResource},
        resource::Resource,
        system::{Commands, Query, Res, ResMut, SystemParam},
    },
    reflect::{Reflect, std_traits::ReflectDefault},
    time::{Fixed, Time, Virtual},
};
use bevy_egui::{
    EguiContexts, EguiPlugin, EguiPrimaryContextPass,
    egui::{self, ComboBox, Slider, SliderClamping, Ui},
};

use super::{
    ClothDiagnosticsPlugin, ClothGravity, ClothSearch, ClothStats, ClothTopology, ShowClothGizmos,
};
use crate::{
    cloth::ClothMaterial,
    contact::NarrowPhase,
    hierarchy::{SearchMethod, SearchReason},
    solver::{ClothSettings, Precision},
};

/// Whether the panel is shown.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq, Eq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct ClothPanel {
    /// Shown or hidden.
    pub visible: bool,
}

impl Default for ClothPanel {
    fn default() -> Self {
        Self { visible: true }
    }
}

/// Speed of a collider (m/s), for the panel to set. The game moves the collider and reads it.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct ClothColliderSpeed(pub f32);

/// Shows a panel on the primary window: level shown, search method and what it chose, sub-steps, material, gravity, the speed of
/// each collider with a [`ClothColliderSpeed`], pause and single step (of the fixed schedules), time a tick, nodes visited, contacts.
///
/// Adds `EguiPlugin` if the app has none yet.
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

#[derive(QueryData)]
#[query_data(mutable)]
struct PanelCloth {
    entity: Entity,
    name: Option<&'static Name>,
    settings: &'static mut ClothSettings,
    material: &'static mut ClothMaterial,
    search_method: &'static mut SearchMethod,
    narrow_phase: &'static mut NarrowPhase,
    show: Option<&'static mut ShowClothGizmos>,
    topology: &'static ClothTopology,
    search: &'static ClothSearch,
    stats: &'static ClothStats,
}

#[derive(SystemParam)]
struct Clocks<'w> {
    running: ResMut<'w, Time<Virtual>>,
    fixed: ResMut<'w, Time<Fixed>>,
}

fn draw_panel(
    mut contexts: EguiContexts,
    panel: Res<ClothPanel>,
    mut cloths: Query<PanelCloth>,
    mut speeds: Query<(Entity, Option<&Name>, &mut ClothColliderSpeed)>,
    mut gravity: ResMut<ClothGravity>,
    mut clocks: Clocks,
    diagnostics: Option<Res<DiagnosticsStore>>,
    mut commands: Commands,
) -> Result {
    if !panel.visible {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    egui::Window::new("Cloth")
        .default_pos([12.0, 12.0])
        .default_width(270.0)
        .show(context, |ui| {
            show_clock(ui, &mut clocks);
            if let Some(diagnostics) = diagnostics {
                show_times(ui, &diagnostics);
            }
            ui.separator();
            let mut down = -gravity.0.y;
            ui.add(slider(&mut down, 0.0..=25.0).text("gravity (m/s²)"));
            let changed = ClothGravity(gravity.0.with_y(-down));
            gravity.set_if_neq(changed);
            for (entity, name, mut speed) in &mut speeds {
                let label = format!(
                    "{} (m/s)",
                    name.map_or_else(|| entity.to_string(), ToString::to_string)
                );
                let mut value = speed.0;
                ui.add(slider(&mut value, 0.0..=10.0).text(label));
                speed.set_if_neq(ClothColliderSpeed(value));
            }
            for mut cloth in &mut cloths {
                let name = cloth
                    .name
                    .map_or_else(|| format!("cloth {}", cloth.entity), ToString::to_string);
                ui.separator();
                egui::CollapsingHeader::new(name)
                    .id_salt(cloth.entity)
                    .default_open(true)
                    .show(ui, |ui| show_cloth(ui, &mut cloth, &mut commands));
            }
        });
    Ok(())
}

/// A slider that leaves a value outside of its range alone until someone moves it.
fn slider<T: egui::emath::Numeric>(value: &mut T, range: RangeInclusive<T>) -> Slider<'_> {
    Slider::new(value, range).clamping(SliderClamping::Edits)
}

fn show_clock(ui: &mut Ui, clocks: &mut Clocks) {
    ui.horizontal(|ui| {
        let paused = clocks.running.is_paused();
        if ui.button(if paused { "Run" } else { "Pause" }).clicked() {
            if paused {
                clocks.running.unpause();
            } else {
                clocks.running.pause();
            }
        }
        if ui
            .add_enabled(paused, egui::Button::new("Single step"))
            .clicked()
        {
            let timestep = clocks.fixed.timestep();
            clocks.fixed.accumulate_overstep(timestep);
        }
    });
}

fn show_times(ui: &mut Ui, diagnostics: &DiagnosticsStore) {
    type Plugin = ClothDiagnosticsPlugin;
    let mean = |path: &DiagnosticPath| {
        diagnostics
            .get(path)
            .and_then(Diagnostic::smoothed)
            .unwrap_or(0.0)
    };
    let (integrate, rebuild, query) = (
        mean(&Plugin::INTEGRATE),
        mean(&Plugin::REBUILD),
        mean(&Plugin::QUERY),
    );
    ui.label(format!(
        "{:.3} ms a tick in solver and search",
        integrate + rebuild + query
    ))
    .on_hover_text(format!(
        "integrate {integrate:.3}, rebuild {rebuild:.4}, query {query:.4} ms"
    ));
}

fn show_cloth(ui: &mut Ui, cloth: &mut PanelClothItem, commands: &mut Commands) {
    let (tree, stats) = (cloth.topology.tree(), cloth.stats);
    ui.label(format!(
        "{} contacts · {} of {} nodes visited · stretch {:.1} % · {}",
        stats.contacts,
        stats.nodes_visited,
        tree.len(),
        100.0 * stats.stretch.structural,
        if stats.is_asleep {
            "asleep".to_string()
        } else {
            format!("{} sub-steps", stats.substeps)
        },
    ));

    if let Some(limit) = stats.exceeded {
        let color = ui.visuals().warn_fg_color;
        ui.colored_label(color, format!("beyond what is simulated well: {limit}"))
            .on_hover_text(limit.remedy());
    }

    ui.label(search_text(stats)).on_hover_text(format!(
        "{} particles tested, {} colliders near, {} of them against triangles, {} searches again within the tick",
        stats.leaf_tests, stats.colliders_near, stats.by_triangles, stats.requeries,
    ));

    let deepest = tree.levels().len().saturating_sub(1);
    let mut shown = cloth.show.as_deref().cloned().unwrap_or(ShowClothGizmos {
        levels: None,
        springs: false,
    });
    let level = shown
        .levels
        .as_ref()
        .map(|levels| (*levels.start()).min(deepest));
    let text = level.map_or_else(|| "none".to_string(), |level| level_name(cloth, level));
    ComboBox::from_label("volumes")
        .selected_text(text)
        .show_ui(ui, |ui| {
            ui.selectable_value(&mut shown.levels, None, "none");
            for level in 0..=deepest {
                ui.selectable_value(
                    &mut shown.levels,
                    Some(level..=level),
                    level_name(cloth, level),
                );
            }
        });
    ui.checkbox(&mut shown.springs, "springs");
    match &mut cloth.show {
        Some(show) => {
            show.set_if_neq(shown);
        }
        None if shown.levels.is_some() || shown.springs => {
            commands.entity(cloth.entity).try_insert(shown);
        }
        None => {}
    }

    let mut method = *cloth.search_method;
    ComboBox::from_label("search")
        .selected_text(method.to_string())
        .show_ui(ui, |ui| {
            for each in SearchMethod::ALL {
                ui.selectable_value(&mut method, each, each.to_string());
            }
        });
    cloth.search_method.set_if_neq(method);

    let mut narrow_phase = *cloth.narrow_phase;
    let is_it = |(_, each): &&(&'static str, NarrowPhase)| *each == narrow_phase;
    let name = NarrowPhase::ALL
        .iter()
        .find(is_it)
        .map_or("", |(name, _)| name);
    ComboBox::from_label("contact by")
        .selected_text(name)
        .show_ui(ui, |ui| {
            for (name, each) in NarrowPhase::ALL {
                ui.selectable_value(&mut narrow_phase, each, name);
            }
        });
    cloth.narrow_phase.set_if_neq(narrow_phase);

    let mut settings = *cloth.settings;
    show_precision(ui, &mut settings.precision);
    ui.checkbox(&mut settings.tethers, "tethers");
    ui.checkbox(&mut settings.sleeps, "sleeps at rest");
    cloth.settings.set_if_neq(settings);

    let mut material = *cloth.material;
    show_material(ui, &mut material);
    cloth.material.set_if_neq(material);
}

/// What was chosen, and why.
fn search_text(stats: &ClothStats) -> String {
    match stats.reason {
        SearchReason::NothingNear | SearchReason::Asleep => format!("no search: {}", stats.reason),
        reason => format!("search: {} ({reason})", stats.search),
    }
}

fn show_precision(ui: &mut Ui, precision: &mut Precision) {
    let fixed = matches!(precision, Precision::Substeps(_));
    ui.horizontal(|ui| {
        if ui.radio(fixed, "fixed").clicked() && !fixed {
            *precision = Precision::default();
        }
        if ui.radio(!fixed, "tolerance").clicked() && fixed {
            *precision = ClothSettings::tolerance(0.01).precision;
        }
    });
    match precision {
        Precision::Substeps(substeps) => {
            ui.add(slider(substeps, 1..=80).text("sub-steps"));
        }
        Precision::Tolerance {
            stretch,
            most_substeps,
        } => {
            let mut percent = 100.0 * *stretch;
            ui.add(
                slider(&mut percent, 0.1..=20.0)
                    .logarithmic(true)
                    .text("% stretch"),
            );
            *stretch = percent / 100.0;
            ui.add(slider(most_substeps, 1..=400).text("sub-steps at most"));
        }
    }
}

fn level_name(cloth: &PanelClothItem, level: usize) -> String {
    let (visited, touching) = cloth.search.query().level(cloth.topology.tree(), level);
    format!("level {level}: {touching} touching, {visited} visited")
}

fn show_material(ui: &mut Ui, material: &mut ClothMaterial) {
    let presets = ClothMaterial::PRESETS;
    let name = presets
        .iter()
        .find(|(_, preset)| preset == material)
        .map_or("custom", |(name, _)| name);
    ComboBox::from_label("material")
        .selected_text(name)
        .show_ui(ui, |ui| {
            for (name, preset) in presets {
                ui.selectable_value(material, preset, name);
            }
        });
    ui.add(
        slider(&mut material.areal_density, 0.01..=5.0)
            .logarithmic(true)
            .text("kg/m²"),
    );
    for (value, text) in [
        (&mut material.stretch_compliance, "stretch (m/N)"),
        (&mut material.shear_compliance, "shear (m/N)"),
        (&mut material.bend_compliance, "bend (m/N)"),
    ] {
        ui.add(
            slider(value, 0.0..=10.0)
                .logarithmic(true)
                .smallest_positive(1.0e-6)
                .text(text),
        );
    }
    ui.add(slider(&mut material.damping, 0.0..=0.2).text("damping D"));
    ui.add(slider(&mut material.friction, 0.0..=2.0).text("friction μ"));
}
