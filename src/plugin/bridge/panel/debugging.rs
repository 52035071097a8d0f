//! The debugging part of the panel: search for contacts, solver settings, and their cost.

use std::mem::discriminant;

use bevy::{
    diagnostic::{Diagnostic, DiagnosticsStore},
    ecs::query::QueryData,
    prelude::{Commands, DetectChangesMut, Entity, Name},
};
use bevy_egui::egui::{RichText, Ui};

use super::{
    fabric::{show_stiffening, show_weft},
    row::{choose, line, slide, slide_small},
};
use crate::{
    cloth::ClothMaterial,
    contact::NarrowPhase,
    hierarchy::{SearchMethod, SearchReason},
    plugin::{
        authoring::ClothGravity,
        bridge::diagnostics::ClothDiagnosticsPlugin,
        draw::ShowClothGizmos,
        state::{ClothBuilt, ClothSearch, ClothStats},
    },
    solver::{ClothSettings, Substepping, TimeOrder},
};

/// Means of the last second or so, of all cloths together: their sum, and a text that explains it.
pub(super) fn times(diagnostics: &DiagnosticsStore) -> (String, String) {
    type Plugin = ClothDiagnosticsPlugin;
    let mean = |path| diagnostics.get(&path).and_then(Diagnostic::smoothed);
    let means = [Plugin::INTEGRATE, Plugin::REBUILD, Plugin::QUERY].map(mean);
    let [integrate, rebuild, query] = means.map(Option::unwrap_or_default);
    let tip = format!(
        "Time of a fixed tick for all cloths together, a mean of the last ticks:\n\
         solver {integrate:.3} ms, refit of the volumes {rebuild:.4} ms, search {query:.4} ms.\n"
    );
    (
        format!("{:7.3} ms a tick", integrate + rebuild + query),
        tip,
    )
}

/// The folded rows of one cloth. `gravity` is that of all cloths.
pub(super) fn show(
    ui: &mut Ui,
    cloth: &mut PanelClothItem,
    gravity: ClothGravity,
    commands: &mut Commands,
) {
    show_figures(ui, cloth);
    show_gizmos(ui, cloth, commands);
    show_search(ui, cloth);
    let mut settings = *cloth.settings;
    show_settings(ui, &mut settings, gravity);
    cloth.settings.set_if_neq(settings);
    let mut material = *cloth.material;
    show_material(ui, &mut material);
    cloth.material.set_if_neq(material);
}

fn show_figures(ui: &mut Ui, cloth: &PanelClothItem) {
    let stats = cloth.stats;
    let mut figure = |name: &str, figure: String, tip: &str| {
        let text = format!("{name:<13} {figure:>17}");
        line(ui, RichText::new(text).monospace(), tip);
    };
    let particles = cloth.built.surface().len().to_string();
    figure("particles", particles, "Particles of the cloth");
    let tip = "Particles that a collider pushed out in the last tick; for small colliders, cells of two triangles";
    figure("contacts", stats.contacts.to_string(), tip);
    let nodes = cloth.built.tree().len();
    let visited = format!("{} of {nodes}", stats.nodes_visited);
    let tip = "Nodes of the bounding-volume tree that the search of the last tick visited";
    figure("nodes visited", visited, tip);
    let tip = "Particles that the search of the last tick tested against a collider";
    figure("tested", stats.leaf_tests.to_string(), tip);
    let stretch = format!("{:.1} %", 100.0 * stats.stretch.structural);
    let tip = "The largest stretch of a spring at the end of the last tick (% of its rest length)";
    figure("stretch", stretch, tip);
    let tip = "Sub-steps of the last tick; none while the cloth sleeps";
    figure("sub-steps", stats.substeps.to_string(), tip);
    let found = search_text(stats);
    let tip = format!(
        "{found}\n{} colliders near, {} of them against triangles, {} extra searches within the tick",
        stats.colliders_near, stats.by_triangles, stats.requeries
    );
    line(ui, found, &tip);
}

/// The chosen search, and the reason.
fn search_text(stats: &ClothStats) -> String {
    match stats.reason {
        SearchReason::NothingNear | SearchReason::Asleep => format!("no search: {}", stats.reason),
        reason => format!("{} ({reason})", stats.search),
    }
}

fn show_gizmos(ui: &mut Ui, cloth: &mut PanelClothItem, commands: &mut Commands) {
    let tree = cloth.built.tree();
    let deepest = tree.levels().len().saturating_sub(1);
    let shown = cloth.show.as_deref().cloned();
    let mut shown = shown.unwrap_or_else(ShowClothGizmos::nothing);
    let was = shown.clone();
    let level = was.levels.map(|[first, _]| first.min(deepest));
    let now = level.map_or_else(|| "none".to_string(), |level| format!("level {level}"));
    let levels = (0..=deepest).map(|level| {
        let (visited, touching) = cloth.search.query().level(tree, level);
        let figures = format!("{visited} visited, {touching} touching");
        (format!("level {level}"), figures, Some([level; 2]))
    });
    choose(
        ui,
        "volumes",
        "Level of the bounding-volume tree to draw, 0 is the root. Red and dark: a collider touches it. \
         Green and bright: none does. Faint: the search did not visit it",
        &mut shown.levels,
        &now,
        std::iter::once(("none".to_string(), String::new(), None)).chain(levels),
    );
    ui.checkbox(&mut shown.springs, "draw springs")
        .on_hover_text("Springs along rows and columns; diagonals fainter");
    match &mut cloth.show {
        Some(show) => {
            show.set_if_neq(shown);
        }
        None if shown != was => {
            commands.entity(cloth.entity).try_insert(shown);
        }
        None => {}
    }
}

fn show_search(ui: &mut Ui, cloth: &mut PanelClothItem) {
    let mut method = *cloth.search_method;
    choose(
        ui,
        "search",
        "Search for contacts: every particle, or a tree of bounding volumes with a rule. Auto takes the cheapest",
        &mut method,
        &cloth.search_method.to_string(),
        SearchMethod::ALL.map(|each| (each.to_string(), String::new(), each)),
    );
    cloth.search_method.set_if_neq(method);

    let mut narrow_phase = *cloth.narrow_phase;
    let is_it = |(_, each): &&(&'static str, NarrowPhase)| *each == narrow_phase;
    let now = NarrowPhase::ALL.iter().find(is_it);
    let now = now.map_or("", |(name, _)| name);
    choose(
        ui,
        "contact by",
        "Contact of colliders with particles or triangles. Auto takes triangles for small balls and capsules, otherwise particles",
        &mut narrow_phase,
        now,
        NarrowPhase::ALL.map(|(name, each)| (name.to_string(), String::new(), each)),
    );
    cloth.narrow_phase.set_if_neq(narrow_phase);
}

fn show_settings(ui: &mut Ui, settings: &mut ClothSettings, of_all: ClothGravity) {
    show_substeps(ui, &mut settings.substepping);
    let mut is_first = settings.order == TimeOrder::First;
    ui.checkbox(&mut is_first, "Verlet as in the paper").on_hover_text(
        "First order in time, equation (2): swings lose energy, more with fewer sub-steps. Off: second order",
    );
    settings.order = match is_first {
        true => TimeOrder::First,
        false => TimeOrder::Second,
    };
    ui.checkbox(&mut settings.tethers, "tethers").on_hover_text(
        "No particle gets farther from a pin than the cloth between them allows: less stretch at the same sub-steps",
    );
    ui.checkbox(&mut settings.sleeps, "sleeps at rest")
        .on_hover_text("A cloth at rest is not simulated until something disturbs it");
    let mut millimetres = 1.0e3 * settings.particle_radius;
    let tip =
        "Radius of each particle (mm): how far from a collider the cloth lies. A rope has its own";
    if slide(
        ui,
        "radius, mm",
        tip,
        &mut millimetres,
        0.0..=50.0,
        |slider| slider.fixed_decimals(1),
    ) {
        settings.particle_radius = millimetres / 1.0e3;
    }
    let mut is_own = settings.gravity.is_some();
    ui.checkbox(&mut is_own, "own gravity")
        .on_hover_text("Gravity for this cloth alone, in place of that of all");
    let own = settings.gravity.unwrap_or(of_all.0);
    settings.gravity = is_own.then_some(own);
    if let Some(gravity) = &mut settings.gravity {
        let mut down = -gravity.y;
        let tip = "Gravity of this cloth, downwards (m/s²)";
        if slide(ui, "down, m/s²", tip, &mut down, 0.0..=25.0, |slider| {
            slider.fixed_decimals(2)
        }) {
            gravity.y = -down;
        }
    }
}

fn show_substeps(ui: &mut Ui, substepping: &mut Substepping) {
    ui.horizontal(|ui| {
        let mut choose = |name: &str, tip: &str, choice: Substepping| {
            // The number of a chosen kind stays.
            let is_chosen = discriminant(substepping) == discriminant(&choice);
            if ui.radio(is_chosen, name).on_hover_text(tip).clicked() && !is_chosen {
                *substepping = choice;
            }
        };
        let tip = "Sub-steps by the number of particles, the same in each tick";
        choose("automatic", tip, Substepping::Automatic);
        let tip = "Your number of sub-steps: each tick costs the same";
        choose("fixed", tip, Substepping::Fixed(20));
        let tip =
            "Enough sub-steps to keep the stretch below a limit, and at least those of “automatic”";
        choose("tolerance", tip, ClothSettings::tolerance(0.01).substepping);
    });
    match substepping {
        Substepping::Automatic => {}
        Substepping::Fixed(substeps) => {
            let tip = "Sub-steps of each fixed tick, 1 to 80: more sub-steps stretch less, and each costs the same time";
            slide(ui, "sub-steps", tip, substeps, 1..=80, |slider| slider);
        }
        Substepping::Adaptive {
            stretch,
            max_substeps,
        } => {
            let mut percent = 100.0 * *stretch;
            let tip = "The largest stretch allowed (% of its rest length), 0.1 to 20";
            if slide(ui, "stretch, %", tip, &mut percent, 0.1..=20.0, |slider| {
                slider.logarithmic(true)
            }) {
                *stretch = percent / 100.0;
            }
            let tip = "The most sub-steps that a tick may take, 1 to 400";
            slide(ui, "at most", tip, max_substeps, 1..=400, |slider| slider);
        }
    }
}

/// The exact values, in their units.
fn show_material(ui: &mut Ui, of: &mut ClothMaterial) {
    let tip = "The values behind the sliders above. Double-click a number to edit it";
    line(ui, "material, exact", tip);
    let tip = "Mass per area (kg/m²)";
    slide_small(ui, "mass, kg/m²", tip, &mut of.areal_density, 0.01..=5.0);
    let tip = "Compliance along rows and columns (m/N): how far a square patch grows under 1 N. 0 is rigid";
    let stretch = &mut of.stretch_compliance;
    slide_small(ui, "stretch, m/N", tip, stretch, 0.0..=10.0);
    let tip = "Compliance along both diagonals (m/N). 0 is rigid, infinity is no shear springs";
    slide_small(ui, "shear, m/N", tip, &mut of.shear_compliance, 0.0..=10.0);
    let tip = "Flexural rigidity (N·m). 0 bends freely";
    slide_small(ui, "bend, N·m", tip, &mut of.bend_rigidity, 0.0..=0.01);
    show_weft(ui, of);
    show_stiffening(ui, of);
    let mut slide = |name, tip, value, most| slide(ui, name, tip, value, 0.0..=most, |of| of);
    let tip = "Damping along springs (s): time in which a free stretch decays. 0 is none";
    slide("loss, s", tip, &mut of.stretch_damping, 0.1);
    let tip = "Share of its velocity that the cloth loses in 1/60 s (no unit), 0 to 1";
    slide("damping D", tip, &mut of.damping, 0.2);
    let tip = "Coulomb's coefficient of friction against colliders (no unit)";
    slide("friction μ", tip, &mut of.friction, 2.0);
}

/// A cloth with everything that the panel shows and sets.
#[derive(QueryData)]
#[query_data(mutable)]
pub(super) struct PanelCloth {
    pub entity: Entity,
    name: Option<&'static Name>,
    pub settings: &'static mut ClothSettings,
    pub material: &'static mut ClothMaterial,
    pub search_method: &'static mut SearchMethod,
    pub narrow_phase: &'static mut NarrowPhase,
    pub show: Option<&'static mut ShowClothGizmos>,
    pub built: &'static ClothBuilt,
    pub search: &'static ClothSearch,
    pub stats: &'static ClothStats,
}

/// Number of letters of a cloth's name that fit.
const LONGEST_NAME: usize = 36;

impl PanelClothItem<'_, '_> {
    pub fn name(&self) -> String {
        let name = self
            .name
            .map_or_else(|| format!("cloth {}", self.entity), ToString::to_string);
        // A header is not cut off by itself.
        name.chars().take(LONGEST_NAME).collect()
    }
}
