//! The query against brute force on random states, and what the paper's radii miss.

use std::collections::BTreeMap;

use bevy::math::Vec3;
use proptest::{prelude::*, strategy::ValueTree, test_runner::TestRunner};

use super::*;
use crate::{
    cloth::{Cloth, ClothGrid, ClothMaterial, ClothParticles, SpringKind, Springs},
    solver::Stretch,
};

/// A cloth in some state, and a ball near it.
#[derive(Debug, Clone)]
struct State {
    columns: u32,
    rows: u32,
    diagonals: bool,
    /// How the particles are moved from rest, in spacings: waves, a fold, and each by itself.
    waves: Vec3,
    folded: bool,
    noise: f32,
    seed: u64,
    /// Radius in spacings, and the particle that it is near to, how near in radii, and from where.
    radius: f32,
    near: usize,
    distance: f32,
    direction: Vec3,
    particle_radius: f32,
    /// How far from the origin all of this happens, in spacings.
    origin: Vec3,
}

const SPACING: f32 = 0.1;

fn states() -> impl Strategy<Value = State> {
    let within = |limit: f32| (-limit..limit, -limit..limit, -limit..limit).prop_map(Vec3::from);
    let grid = (2u32..36, 2u32..36, any::<bool>());
    let noise = prop_oneof![Just(0.0f32), 0.0f32..0.5, 0.0f32..8.0];
    let shape = (within(6.0), any::<bool>(), noise, any::<u64>());
    let radius = prop_oneof![0.05f32..1.0, 1.0f32..12.0];
    let ball = (
        radius,
        any::<usize>(),
        0.0f32..1.6,
        within(1.0),
        0.0f32..0.3,
    );
    let origin = prop_oneof![Just(Vec3::ZERO), within(1.0e4)];
    (grid, shape, ball, origin).prop_map(
        |(
            (columns, rows, diagonals),
            (waves, folded, noise, seed),
            (radius, near, distance, direction, particle_radius),
            origin,
        )| State {
            columns,
            rows,
            diagonals,
            waves,
            folded,
            noise,
            seed,
            radius,
            near,
            distance,
            direction,
            particle_radius,
            origin,
        },
    )
}

/// A state, woven.
struct Scene {
    grid: ClothGrid,
    tree: QuadTree,
    particles: ClothParticles,
    stretch: Stretch,
    probe: Probe,
}

impl State {
    fn weave(&self) -> Scene {
        let grid = Cloth::new(self.columns, self.rows, SPACING)
            .grid(Vec3::ONE)
            .expect("a sound grid");
        let material = ClothMaterial {
            shear_compliance: if self.diagonals { 0.0 } else { f32::INFINITY },
            ..ClothMaterial::COTTON
        };
        let mut particles = ClothParticles::at_rest(&grid, &material).expect("a sound material");
        let mut seed = self.seed;
        let mut random = || {
            // SplitMix64.
            seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let z = (seed ^ (seed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((z ^ (z >> 31)) >> 40) as f32 / (1u64 << 23) as f32 - 1.0
        };
        for (row, column) in grid.cells() {
            let rest = grid.rest_position(row, column);
            let phase = Vec3::new(
                row as f32 * 0.4,
                column as f32 * 0.3,
                (row + column) as f32 * 0.2,
            );
            let mut moved =
                rest + Vec3::from(phase.to_array().map(f32::sin)) * self.waves * SPACING;
            if self.folded && row > self.rows / 2 {
                moved.y = -moved.y;
            }
            moved += Vec3::new(random(), random(), random()) * self.noise * SPACING;
            particles
                .set_position((row, column), moved + self.origin * SPACING)
                .expect("it exists");
        }
        let springs = Springs::of_grid(&grid, &material);
        let near = particles
            .position(self.near % particles.len())
            .expect("it exists");
        let radius = self.radius * SPACING;
        Scene {
            tree: QuadTree::of_grid(&grid, springs.has(SpringKind::Shear)),
            stretch: Stretch::measure(&springs, &particles),
            probe: Probe {
                centre: near + self.direction.normalize_or(Vec3::Z) * radius * self.distance,
                radius,
                particle_radius: self.particle_radius * SPACING,
            },
            grid,
            particles,
        }
    }
}

impl Scene {
    fn bounds(&self, rule: BoundRule) -> SphereBounds {
        let mut bounds = SphereBounds::default();
        let particle_radius = self.probe.particle_radius;
        bounds.rebuild(
            rule,
            &self.tree,
            &self.grid,
            &self.particles,
            self.stretch.bound,
            particle_radius,
        );
        bounds
    }

    fn found(&self, query: &mut TopDownQuery, rule: BoundRule) -> Vec<u32> {
        query.clear(&self.tree);
        let found = query.search(&self.tree, &self.bounds(rule), &self.particles, &self.probe);
        let mut found = query.candidates()[found].to_vec();
        found.sort_unstable();
        found
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    /// `Refit` and `RestShape` find what brute force in f64 finds: no more, no less, whatever the state.
    #[test]
    fn the_query_equals_brute_force(state in states()) {
        let scene = state.weave();
        prop_assert_eq!(scene.tree.validate(&scene.grid), Ok(()));
        let truth = brute_force(&scene.particles, &scene.probe);
        let mut query = TopDownQuery::default();
        for rule in [BoundRule::Refit, BoundRule::RestShape] {
            prop_assert_eq!(scene.bounds(rule).validate(&scene.tree, &scene.particles), Ok(()));
            prop_assert_eq!(&scene.found(&mut query, rule), &truth, "{:?}", rule);
            for (index, node) in scene.tree.nodes().iter().enumerate() {
                let holds = |particle: &u32| {
                    let (row, column) = (particle / state.columns, particle % state.columns);
                    node.rows.contains(&row) && node.columns.contains(&column)
                };
                let touching = query.states()[index] == NodeState::Touching;
                prop_assert!(touching || !truth.iter().any(holds), "a node above a contact is red");
                let untouched = query.states()[index] == NodeState::Untouched;
                let children = node.children.start as usize..node.children.end as usize;
                let looked_at = |state: &NodeState| *state != NodeState::Unvisited;
                prop_assert!(!untouched || !query.states()[children].iter().any(looked_at), "what is green is pruned");
            }
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
        let scene = state.weave();
        let bounds = scene.bounds(BoundRule::RestShape);
        let far = Probe {
            centre: scene.probe.centre + Vec3::splat(1.0e3),
            ..scene.probe
        };
        query.clear(&scene.tree);
        let first = query.search(&scene.tree, &bounds, &scene.particles, &scene.probe);
        let (visited, states) = (query.nodes_visited(), query.states().to_vec());
        let none = query.search(&scene.tree, &bounds, &scene.particles, &far);
        assert!(none.is_empty());
        assert_eq!(
            query.nodes_visited(),
            visited + 1,
            "a far ball costs one test, the root's"
        );
        assert_eq!(query.states(), states);
        let second = query.search(&scene.tree, &bounds, &scene.particles, &scene.probe);
        assert_eq!(query.candidates()[first], query.candidates()[second]);
        query.clear(&scene.tree);
        assert!(
            query
                .states()
                .iter()
                .all(|state| *state == NodeState::Unvisited)
        );
    }
}

/// Figure 4's radius of a square patch, (n + 1)/2 spacings, is less than its half-diagonal, (n − 1)/√2: a ball
/// that touches just the corner of a flat cloth of 16 × 16 is missed at the root.
#[test]
fn the_papers_root_misses_its_own_corner() {
    let flat = State {
        columns: 16,
        rows: 16,
        diagonals: true,
        waves: Vec3::ZERO,
        folded: false,
        noise: 0.0,
        seed: 0,
        radius: 1.0,
        near: 0,
        distance: 0.9,
        direction: Vec3::new(-1.0, 1.0, 0.0),
        particle_radius: 0.0,
        origin: Vec3::ZERO,
    };
    let scene = flat.weave();
    assert_eq!(brute_force(&scene.particles, &scene.probe), [0]);
    let mut query = TopDownQuery::default();
    assert!(scene.found(&mut query, BoundRule::Paper).is_empty());
    assert_eq!(query.nodes_visited(), 1);
    assert!(
        scene
            .bounds(BoundRule::Paper)
            .validate(&scene.tree, &scene.particles)
            .is_err()
    );
    assert_eq!(scene.found(&mut query, BoundRule::RestShape), [0]);
}

/// How many contacts the paper's radii miss on random states: counted, and printed by
/// `cargo test paper_misses -- --nocapture`.
#[test]
fn paper_misses() {
    let mut runner = TestRunner::deterministic();
    let mut query = TopDownQuery::default();
    // By the ball's radius in spacings: contacts, missed ones, states with contacts, those with a miss.
    let mut counts = BTreeMap::<&str, [usize; 4]>::new();
    for _ in 0..10_000 {
        let state = states().new_tree(&mut runner).expect("a state").current();
        let scene = state.weave();
        let truth = brute_force(&scene.particles, &scene.probe);
        let found = scene.found(&mut query, BoundRule::Paper);
        assert!(
            found.iter().all(|particle| truth.contains(particle)),
            "what is found is there"
        );
        let missed = truth.len() - found.len();
        let size = if state.radius < 1.0 {
            "below 1 spacing"
        } else {
            "1 to 12 spacings"
        };
        for size in [size, "any"] {
            let count = counts.entry(size).or_default();
            count[0] += truth.len();
            count[1] += missed;
            count[2] += usize::from(!truth.is_empty());
            count[3] += usize::from(missed > 0);
        }
    }
    for (size, [contacts, missed, states, wrong]) in &counts {
        let percent = |part: usize, whole: usize| 100.0 * part as f64 / whole as f64;
        println!(
            "`Paper`, ball radius {size}: {missed} of {contacts} contacts missed ({:.1} %), \
             in {wrong} of {states} states with contacts ({:.1} %)",
            percent(*missed, *contacts),
            percent(*wrong, *states),
        );
    }
    let [contacts, missed, ..] = counts["any"];
    assert!(
        missed > 0 && missed < contacts,
        "it finds some and misses some"
    );
}
