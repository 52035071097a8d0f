//! Figures for Bevy's `DiagnosticsStore`.

use bevy::{
    diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic},
    ecs::{intern::Interned, schedule::ScheduleLabel},
    prelude::{App, IntoScheduleConfigs, Plugin, Query},
};

use crate::{
    hierarchy::{BoundRule, SearchMethod},
    plugin::{
        sets::{ClothSystems, runs_in_schedule},
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

runs_in_schedule! {
    /// Runs its system in `schedule`, which must be that of [`ClothPlugin`](crate::plugin::ClothPlugin).
    ClothDiagnosticsPlugin
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

    const TIMES: [(DiagnosticPath, Figure); 3] = [
        (Self::INTEGRATE, |of| of.integrate_ms),
        (Self::REBUILD, |of| of.rebuild_ms),
        (Self::QUERY, |of| of.query_ms),
    ];
    const COUNTS: [(DiagnosticPath, Figure); 11] = [
        (Self::COLLIDERS_NEAR, |of| of.colliders_near as f64),
        (Self::BY_TRIANGLES, |of| of.by_triangles as f64),
        (Self::SCANS, |of| {
            searched(of, |by| by == SearchMethod::Scan)
        }),
        (Self::SEARCHES, |of| {
            searched(of, |by| by.rule() == Some(BoundRule::RestShape))
        }),
        (Self::REFITS, |of| {
            searched(of, |by| {
                by.rule().is_some_and(|rule| rule != BoundRule::RestShape)
            })
        }),
        (Self::REQUERIES, |of| of.requeries.into()),
        (Self::NODES_VISITED, |of| of.nodes_visited as f64),
        (Self::LEAF_TESTS, |of| of.leaf_tests as f64),
        (Self::CONTACTS, |of| of.contacts as f64),
        (Self::SUBSTEPS, |of| of.substeps.into()),
        (Self::ASLEEP, |of| u8::from(of.is_asleep).into()),
    ];
}

/// A figure of one cloth.
type Figure = fn(&ClothStats) -> f64;

/// 1 for a cloth near colliders whose method of search `is_it`, else 0.
fn searched(stats: &ClothStats, is_it: impl Fn(SearchMethod) -> bool) -> f64 {
    u8::from(stats.colliders_near > 0 && is_it(stats.search)).into()
}

impl Plugin for ClothDiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        for (path, _) in Self::TIMES {
            app.register_diagnostic(Diagnostic::new(path).with_suffix(" ms"));
        }
        for (path, _) in Self::COUNTS {
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
    type Plugin = ClothDiagnosticsPlugin;
    let valid = cloths.iter().filter(|(state, _)| state.is_valid);
    let valid = valid.map(|(_, stats)| stats);
    for (path, figure) in Plugin::TIMES.into_iter().chain(Plugin::COUNTS) {
        diagnostics.add_measurement(&path, || {
            // A sum of nothing is −0.
            0.0 + valid.clone().map(figure).sum::<f64>()
        });
    }
    diagnostics.add_measurement(&Plugin::STRETCH, || {
        let stretch = valid.map(|stats| f64::from(stats.stretch.structural));
        100.0 * stretch.fold(0.0, f64::max)
    });
}
