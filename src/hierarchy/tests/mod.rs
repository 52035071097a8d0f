//! The query against brute force on random states, for every volume, rule and shape.

pub(super) mod holds;
mod misses;
mod rays;
mod states;
mod surfaces;

use proptest::{prelude::*, strategy::ValueTree, test_runner::TestRunner};

use super::*;
use crate::cloth::ClothParticles;
use holds::Holds;
use states::{Scene, State, states};

impl NodeBounds {
    /// Checks that each node's volume contains its particles' centres and, under `Refit`, its children's volumes. Under
    /// `Paper` this often fails.
    ///
    /// # Errors
    /// A message that names the node at fault.
    fn validate(&self, tree: &QuadTree, particles: &ClothParticles) -> Result<(), String> {
        let volume_of = |node| tree.shape().volume(&self.volumes, particles, node);
        for node in 0..tree.len() as u32 {
            let volume = volume_of(node);
            for particle in tree.particles_of(node) {
                let position = particles.position_at(particle as usize);
                if !volume.holds(position.as_dvec3(), 0.0) {
                    return Err(format!(
                        "node {node}, {volume:?}, does not hold particle {particle} at {position}"
                    ));
                }
            }
            if self.rule() == BoundRule::Refit {
                for &child in tree.node(node).children() {
                    let child_volume = volume_of(child);
                    if !volume.holds_volume(&child_volume) {
                        return Err(format!(
                            "node {node}, {volume:?}, does not hold its child {child}, {child_volume:?}"
                        ));
                    }
                }
            }
        }
        Ok(())
    }
}

/// Each volume by each rule that misses nothing.
const COMPLETE: [(BoundingVolume, BoundRule); 8] = [
    (BoundingVolume::Sphere, BoundRule::RestShape),
    (BoundingVolume::Aabb, BoundRule::RestShape),
    (BoundingVolume::Sphere, BoundRule::Refit),
    (BoundingVolume::Aabb, BoundRule::Refit),
    (BoundingVolume::Obb, BoundRule::Refit),
    (BoundingVolume::KDop14, BoundRule::Refit),
    (BoundingVolume::KDop18, BoundRule::Refit),
    (BoundingVolume::KDop26, BoundRule::Refit),
];

/// What a scene's states are searched with: kept from one to the next, as a game keeps them.
#[derive(Default)]
struct Searcher {
    bounds: [NodeBounds; COMPLETE.len()],
    query: TopDownQuery,
}

impl Searcher {
    /// Whether every volume and rule finds what brute force in f64 finds, no more and no less, and so does the scan.
    fn check(&mut self, scene: &Scene, validates: bool) -> Result<(), TestCaseError> {
        let truth = brute_force(&scene.particles, &scene.probe);
        for (choice, bounds) in COMPLETE.into_iter().zip(&mut self.bounds) {
            scene.rebuild(bounds, choice);
            if validates {
                prop_assert_eq!(
                    bounds.validate(&scene.tree, &scene.particles),
                    Ok(()),
                    "{:?}",
                    choice
                );
            }
            self.query.clear();
            let found = scene.found(&mut self.query, bounds);
            prop_assert_eq!(&found, &truth, "{:?} {:?}", choice, scene.probe);
        }
        self.query.clear();
        let found = self.query.scan(&scene.particles, &scene.probe);
        let mut found = self.query.candidates()[found].to_vec();
        found.sort_unstable();
        prop_assert_eq!(&found, &truth, "scan, {:?}", scene.probe);
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// All volumes find what brute force in f64 finds: no more, no less, whatever the state and the collider's
    /// shape, over grids and over networks.
    #[test]
    fn every_volume_equals_brute_force(state in states()) {
        let scene = state.build();
        let mut searcher = Searcher::default();
        // Slow on large ones: every sixteenth of them.
        let validates = state.columns * state.rows < 100 || state.seed.is_multiple_of(16);
        if validates {
            prop_assert_eq!(scene.tree.validate(scene.particles.len()), Ok(()));
        }
        searcher.check(&scene, validates)?;
    }
}

/// The same on many more states, other ones in each thread: as many as `BEVY_DRAPE_STATES` says. A million take three
/// minutes: `BEVY_DRAPE_STATES=1000000 cargo test --lib in_bulk -- --nocapture`.
#[test]
fn states_in_bulk_equal_brute_force() {
    let asked = std::env::var("BEVY_DRAPE_STATES");
    let states_wanted: usize =
        asked.map_or(20_000, |asked| asked.parse().expect("a number of states"));
    let per_thread = states_wanted.div_ceil(threads());
    let contacts: usize = std::thread::scope(|scope| {
        let run = |thread: usize| {
            let mut runner = states::runner(thread as u64);
            let mut searcher = Searcher::default();
            let mut contacts = 0;
            for _ in 0..per_thread {
                let state = states().new_tree(&mut runner).expect("a state").current();
                let scene = state.build();
                searcher
                    .check(&scene, false)
                    .unwrap_or_else(|error| panic!("{state:?}: {error}"));
                contacts += brute_force(&scene.particles, &scene.probe).len();
            }
            contacts
        };
        let threads: Vec<_> = (0..threads())
            .map(|thread| scope.spawn(move || run(thread)))
            .collect();
        threads
            .into_iter()
            .map(|thread| thread.join().expect("no miss"))
            .sum()
    });
    println!(
        "{} states, {contacts} contacts, {} volumes and rules and the scan: none missed, none false",
        per_thread * threads(),
        COMPLETE.len()
    );
}

fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// A node above a contact is touching, and what is pruned has no visited children.
#[test]
fn states_of_nodes_follow_the_search() {
    let mut runner = TestRunner::deterministic();
    let mut query = TopDownQuery::default();
    for _ in 0..300 {
        let state = states().new_tree(&mut runner).expect("a state").current();
        let scene = state.build();
        let truth = brute_force(&scene.particles, &scene.probe);
        for choice in COMPLETE {
            let mut bounds = NodeBounds::default();
            scene.rebuild(&mut bounds, choice);
            query.clear();
            scene.found(&mut query, &bounds);
            let states = query.states(&scene.tree);
            for (index, state) in states.iter().enumerate() {
                let held = scene.tree.particles_of(index as u32);
                let touches = held.iter().any(|particle| truth.contains(particle));
                assert!(
                    !touches || *state == NodeState::Touching,
                    "a node above a contact is red"
                );
                let visited = |child: &u32| states[*child as usize] != NodeState::Unvisited;
                let children = scene.tree.node(index as u32);
                assert_eq!(
                    children.children().iter().any(visited),
                    *state == NodeState::Touching && !children.is_leaf()
                );
            }
            let visited: usize = (0..scene.tree.levels().len())
                .map(|level| query.level(&scene.tree, level).0)
                .sum();
            assert_eq!(visited, query.nodes_visited());
            let leaves = scene.tree.levels().len() - 1;
            assert_eq!(query.level(&scene.tree, leaves).0, query.leaf_tests());
        }
    }
}

/// A search leaves nothing behind for the next, and several add up.
#[test]
fn searches_add_up_and_clear() {
    let mut runner = TestRunner::deterministic();
    let mut query = TopDownQuery::default();
    for _ in 0..200 {
        let state = states().new_tree(&mut runner).expect("a state").current();
        let scene = State {
            core: states::CoreKind::Ball,
            ..state
        }
        .build();
        let mut bounds = NodeBounds::default();
        scene.rebuild(&mut bounds, COMPLETE[0]);
        let far = Probe::ball(scene.probe.core.middle() + 1.0e3, scene.probe.radius, 0.0);
        query.clear();
        let first = query.search(&scene.tree, &bounds, &scene.particles, &scene.probe);
        let (visited, states) = (query.nodes_visited(), query.states(&scene.tree));
        let none = query.search(&scene.tree, &bounds, &scene.particles, &far);
        assert!(none.is_empty());
        assert_eq!(
            query.nodes_visited(),
            visited + 1,
            "what is far costs one test, the root's"
        );
        assert_eq!(query.states(&scene.tree), states);
        let second = query.search(&scene.tree, &bounds, &scene.particles, &scene.probe);
        assert_eq!(query.candidates()[first], query.candidates()[second]);
        query.clear();
        assert!(
            query
                .states(&scene.tree)
                .iter()
                .all(|state| *state == NodeState::Unvisited)
        );
    }
}

#[test]
fn what_has_no_rest_shape_is_refused() {
    let scene = State::flat(8, 8).build();
    for (_, volume) in BoundingVolume::ALL {
        for (_, rule) in BoundRule::ALL {
            let mut bounds = NodeBounds::default();
            let outcome = bounds.rebuild((volume, rule), &scene.tree, &scene.particles, 0.0);
            assert_eq!(outcome.is_ok(), rule.matches(volume), "{volume:?} {rule:?}");
            if outcome.is_ok() {
                assert_eq!((bounds.volume(), bounds.rule()), (volume, rule));
            } else {
                assert_eq!(bounds, NodeBounds::default());
            }
        }
    }
}

/// Particles of another cloth than the tree's find nothing, and do no harm.
#[test]
fn another_cloths_tree_finds_nothing() {
    let (scene, other) = (State::flat(8, 8).build(), State::flat(9, 7).build());
    let mut bounds = NodeBounds::default();
    scene.rebuild(&mut bounds, COMPLETE[2]);
    let mut query = TopDownQuery::default();
    assert!(
        query
            .search(&scene.tree, &bounds, &other.particles, &scene.probe)
            .is_empty()
    );
    assert!(
        query
            .search(
                &QuadTree::default(),
                &bounds,
                &scene.particles,
                &scene.probe
            )
            .is_empty()
    );
}
