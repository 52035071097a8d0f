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

use crate::{
    hierarchy::{BoundRule, SearchMethod},
    plugin::{
        sets::ClothSystems,
        state::{ClothState, ClothStats},
        write_back::report_limits,
    },
};

/// Writes figures of every tick into Bevy's `DiagnosticsStore`: times and counts summed over all cloths, and the
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
    /// Time of all sub-steps in a tick (ms).
    pub const INTEGRATE: DiagnosticPath = DiagnosticPath::const_new("cloth/integrate");
    /// Time to bring the bounding volumes up to date (ms).
    pub const REBUILD: DiagnosticPath = DiagnosticPath::const_new("cloth/rebuild");
    /// Time of the search (ms).
    pub const QUERY: DiagnosticPath = DiagnosticPath::const_new("cloth/query");
    /// Nodes of the trees that the searches visited.
    pub const NODES_VISITED: DiagnosticPath = DiagnosticPath::const_new("cloth/nodes_visited");
    /// Particles that were tested: the leaves among the visited nodes, and all particles of a scanned cloth.
    pub const LEAF_TESTS: DiagnosticPath = DiagnosticPath::const_new("cloth/leaf_tests");
    /// Colliders that came near a cloth, counted once for each cloth.
    pub const COLLIDERS_NEAR: DiagnosticPath = DiagnosticPath::const_new("cloth/colliders_near");
    /// Colliders near a cloth that were tested against triangles.
    pub const BY_TRIANGLES: DiagnosticPath = DiagnosticPath::const_new("cloth/by_triangles");
    /// Cloths that were scanned: every particle was tested.
    pub const SCANS: DiagnosticPath = DiagnosticPath::const_new("cloth/scans");
    /// Cloths whose tree was searched by volumes that need no update.
    pub const SEARCHES: DiagnosticPath = DiagnosticPath::const_new("cloth/searches");
    /// Cloths whose tree was refitted and searched.
    pub const REFITS: DiagnosticPath = DiagnosticPath::const_new("cloth/refits");
    /// Searches repeated within a tick, because particles moved farther than expected.
    pub const REQUERIES: DiagnosticPath = DiagnosticPath::const_new("cloth/requeries");
    /// Particles that were pushed out of a collider.
    pub const CONTACTS: DiagnosticPath = DiagnosticPath::const_new("cloth/contacts");
    /// Sub-steps, including those repeated for a tolerance. A sleeping cloth has none.
    pub const SUBSTEPS: DiagnosticPath = DiagnosticPath::const_new("cloth/substeps");
    /// Cloths that sleep.
    pub const ASLEEP: DiagnosticPath = DiagnosticPath::const_new("cloth/asleep");
    /// The largest stretch of a structural spring (%).
    pub const STRETCH: DiagnosticPath = DiagnosticPath::const_new("cloth/stretch");

    /// Runs its system in `schedule`, which must be that of [`ClothPlugin`](crate::plugin::ClothPlugin).
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
            Self::COLLIDERS_NEAR,
            Self::BY_TRIANGLES,
            Self::SCANS,
            Self::SEARCHES,
            Self::REFITS,
            Self::REQUERIES,
            Self::NODES_VISITED,
            Self::LEAF_TESTS,
            Self::CONTACTS,
            Self::SUBSTEPS,
            Self::ASLEEP,
        ] {
            app.register_diagnostic(Diagnostic::new(path));
        }
        app.register_diagnostic(Diagnostic::new(Self::STRETCH).with_suffix(" %"));
        app.add_systems(
            self.schedule,
            measure.after(report_limits).in_set(ClothSystems::WriteBack),
        );
    }
}

fn measure(cloths: Query<(&ClothState, &ClothStats)>, mut diagnostics: Diagnostics) {
    let valid = || {
        cloths
            .iter()
            .filter(|(state, _)| state.is_valid)
            .map(|(_, stats)| stats)
    };
    type Plugin = ClothDiagnosticsPlugin;
    let sum = |figure: fn(&ClothStats) -> f64| valid().map(figure).sum::<f64>();
    diagnostics.add_measurement(&Plugin::INTEGRATE, || sum(|stats| stats.integrate_ms));
    diagnostics.add_measurement(&Plugin::REBUILD, || sum(|stats| stats.rebuild_ms));
    diagnostics.add_measurement(&Plugin::QUERY, || sum(|stats| stats.query_ms));
    diagnostics.add_measurement(&Plugin::NODES_VISITED, || {
        sum(|stats| stats.nodes_visited as f64)
    });
    diagnostics.add_measurement(&Plugin::LEAF_TESTS, || sum(|stats| stats.leaf_tests as f64));
    let count = |method: fn(SearchMethod) -> bool| {
        let is_searched = |stats: &&ClothStats| stats.colliders_near > 0 && method(stats.search);
        valid().filter(is_searched).count() as f64
    };
    diagnostics.add_measurement(&Plugin::SCANS, || {
        count(|method| method == SearchMethod::Scan)
    });
    diagnostics.add_measurement(&Plugin::SEARCHES, || {
        count(|method| method.rule() == Some(BoundRule::RestShape))
    });
    diagnostics.add_measurement(&Plugin::REFITS, || {
        count(|method| {
            method
                .rule()
                .is_some_and(|rule| rule != BoundRule::RestShape)
        })
    });
    diagnostics.add_measurement(&Plugin::COLLIDERS_NEAR, || {
        sum(|stats| stats.colliders_near as f64)
    });
    diagnostics.add_measurement(&Plugin::BY_TRIANGLES, || {
        sum(|stats| stats.by_triangles as f64)
    });
    diagnostics.add_measurement(&Plugin::REQUERIES, || {
        sum(|stats| f64::from(stats.requeries))
    });
    diagnostics.add_measurement(&Plugin::CONTACTS, || sum(|stats| stats.contacts as f64));
    diagnostics.add_measurement(&Plugin::SUBSTEPS, || sum(|stats| f64::from(stats.substeps)));
    diagnostics.add_measurement(&Plugin::ASLEEP, || {
        sum(|stats| f64::from(u8::from(stats.is_asleep)))
    });
    diagnostics.add_measurement(&Plugin::STRETCH, || {
        let stretch = valid().map(|stats| f64::from(stats.stretch.structural));
        100.0 * stretch.fold(0.0, f64::max)
    });
}
