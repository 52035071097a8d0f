//! Figures for Bevy's `DiagnosticsStore`.

use bevy::{
    app::{App, FixedUpdate, Plugin},
    diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic},
    ecs::{
        intern::Interned,
        schedule::{IntoScheduleConfigs, ScheduleLabel},
        system::Query,
    },
};

use super::{ClothStats, ClothSystems, components::ClothTick};

/// Measures every tick into Bevy's `DiagnosticsStore`: times and counts added up over all cloths, and the
/// largest stretch among them.
#[derive(Debug, Clone, Copy)]
pub struct ClothDiagnosticsPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl Default for ClothDiagnosticsPlugin {
    fn default() -> Self {
        Self::new(FixedUpdate)
    }
}

impl ClothDiagnosticsPlugin {
    /// Time of all sub-steps a tick (ms).
    pub const INTEGRATE: DiagnosticPath = DiagnosticPath::const_new("cloth/integrate");
    /// Time to bring the bounding spheres up to date (ms).
    pub const REBUILD: DiagnosticPath = DiagnosticPath::const_new("cloth/rebuild");
    /// Time of the search (ms).
    pub const QUERY: DiagnosticPath = DiagnosticPath::const_new("cloth/query");
    /// Nodes of the trees that were looked at.
    pub const NODES_VISITED: DiagnosticPath = DiagnosticPath::const_new("cloth/nodes_visited");
    /// Leaves among them.
    pub const LEAF_TESTS: DiagnosticPath = DiagnosticPath::const_new("cloth/leaf_tests");
    /// Particles that were pushed out of a collider.
    pub const CONTACTS: DiagnosticPath = DiagnosticPath::const_new("cloth/contacts");
    /// Sub-steps, those included that were done again for a tolerance; none of a cloth that sleeps.
    pub const SUBSTEPS: DiagnosticPath = DiagnosticPath::const_new("cloth/substeps");
    /// Cloths that sleep.
    pub const ASLEEP: DiagnosticPath = DiagnosticPath::const_new("cloth/asleep");
    /// The largest stretch of a structural spring (%).
    pub const STRETCH: DiagnosticPath = DiagnosticPath::const_new("cloth/stretch");

    /// With its system in `schedule`, which must be that of [`ClothPlugin`](super::ClothPlugin).
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }
}

impl Plugin for ClothDiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        for path in [Self::INTEGRATE, Self::REBUILD, Self::QUERY] {
            app.register_diagnostic(Diagnostic::new(path).with_suffix(" ms"));
        }
        for path in [
            Self::NODES_VISITED,
            Self::LEAF_TESTS,
            Self::CONTACTS,
            Self::SUBSTEPS,
            Self::ASLEEP,
        ] {
            app.register_diagnostic(Diagnostic::new(path));
        }
        app.register_diagnostic(Diagnostic::new(Self::STRETCH).with_suffix(" %"));
        app.add_systems(self.schedule, measure.in_set(ClothSystems::WriteBack));
    }
}

fn measure(cloths: Query<(&ClothTick, &ClothStats)>, mut diagnostics: Diagnostics) {
    let sound = || {
        cloths
            .iter()
            .filter(|(tick, _)| tick.sound)
            .map(|(_, stats)| stats)
    };
    type Plugin = ClothDiagnosticsPlugin;
    let sum = |figure: fn(&ClothStats) -> f64| sound().map(figure).sum::<f64>();
    diagnostics.add_measurement(&Plugin::INTEGRATE, || sum(|stats| stats.integrate_ms));
    diagnostics.add_measurement(&Plugin::REBUILD, || sum(|stats| stats.rebuild_ms));
    diagnostics.add_measurement(&Plugin::QUERY, || sum(|stats| stats.query_ms));
    diagnostics.add_measurement(&Plugin::NODES_VISITED, || {
        sum(|stats| stats.nodes_visited as f64)
    });
    diagnostics.add_measurement(&Plugin::LEAF_TESTS, || sum(|stats| stats.leaf_tests as f64));
    diagnostics.add_measurement(&Plugin::CONTACTS, || sum(|stats| stats.contacts as f64));
    diagnostics.add_measurement(&Plugin::SUBSTEPS, || sum(|stats| f64::from(stats.substeps)));
    diagnostics.add_measurement(&Plugin::ASLEEP, || {
        sum(|stats| f64::from(u8::from(stats.is_asleep)))
    });
    diagnostics.add_measurement(&Plugin::STRETCH, || {
        let stretch = sound().map(|stats| f64::from(stats.stretch.structural));
        100.0 * stretch.fold(0.0, f64::max)
    });
}
