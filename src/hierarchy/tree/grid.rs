//! The tree of a grid: rows and columns halved on each level.

use bevy::math::Vec3;

use super::{
    halving::{GridTree, Part},
    node::{Node, Outline},
    shape::Tree,
    stored::{Bounds, Volumes, each},
};
use crate::{
    cloth::ClothParticles,
    hierarchy::{
        probe::Probe,
        rule::BoundRule,
        search_buffers::SearchBuffers,
        volume::{NodeVolume, Volume},
    },
};

impl Tree for GridTree {
    fn outline(&self) -> &Outline {
        &self.outline
    }

    fn node(&self, level: usize, node: u32) -> Node {
        let (_, rows, columns) = self.parts(level, node);
        let mut children = [0; 4];
        let mut child_count = 0;
        if let Some(below) = self.levels.get(level + 1) {
            for row in rows.children.clone() {
                for column in columns.children.clone() {
                    children[usize::from(child_count)] = below.index(row, column);
                    child_count += 1;
                }
            }
        }
        Node {
            level,
            middle: rows.middle * self.outline.layout.columns + columns.middle,
            rest_radius: self.levels[level].rest_radius(rows, columns),
            children,
            child_count,
        }
    }

    fn rebuild(&self, volumes: &mut Volumes, particles: &ClothParticles) {
        each!(volumes, bounds => match bounds.rule {
            BoundRule::RestShape => {}
            BoundRule::Refit => bounds.refit_levels.refit(self, particles.blocks()),
            BoundRule::Paper => rebuild_paper(bounds, self, particles),
        });
    }

    fn volume(&self, volumes: &Volumes, particles: &ClothParticles, node: u32) -> NodeVolume {
        let level = (self.outline.levels).partition_point(|level| level.end <= node);
        let (place, rows, columns) = self.parts(level, node);
        each!(volumes, bounds => match bounds.rule {
            BoundRule::RestShape => {
                let radius = self.levels[level].rest_radius(rows, columns);
                bounds.at_rest(middle(particles, rows, columns), radius).into()
            }
            BoundRule::Refit | BoundRule::Paper => {
                stored(bounds, self, particles, level, place).into()
            }
        })
    }

    fn search(
        &self,
        volumes: &Volumes,
        particles: &ClothParticles,
        probe: &Probe,
        found: &mut SearchBuffers,
    ) {
        let reach = probe.reach() as f32;
        each!(volumes, bounds => match bounds.rule {
            BoundRule::RestShape => descend(self, particles, probe, found, |level, _, rows, columns| {
                let radius = self.levels[level].rest_radius(rows, columns);
                bounds.at_rest(middle(particles, rows, columns), radius).may_reach(probe, reach)
            }),
            BoundRule::Refit => descend(self, particles, probe, found, |level, at, _, _| {
                stored(bounds, self, particles, level, at).may_reach(probe, reach)
            }),
            // The paper's volumes ignore the particles' radius.
            BoundRule::Paper => descend(self, particles, probe, found, |level, at, _, _| {
                stored(bounds, self, particles, level, at).may_reach(probe, probe.radius)
            }),
        });
    }
}

/// Position of a node's middle particle (m).
#[inline(always)]
fn middle(particles: &ClothParticles, rows: &Part, columns: &Part) -> Vec3 {
    particles.blocks()[(rows.block + columns.block) as usize].position(columns.lane as usize)
}

/// The volume of a node computed by `Paper` or `Refit`.
#[inline(always)]
fn stored<V: Volume>(
    bounds: &Bounds<V>,
    tree: &GridTree,
    particles: &ClothParticles,
    level: usize,
    [row, column]: [u32; 2],
) -> V {
    let at = &tree.levels[level];
    if bounds.rule == BoundRule::Paper {
        return bounds.nodes[at.index(row, column) as usize];
    }
    let (rows, columns) = (&at.rows[row as usize], &at.columns[column as usize]);
    if level + 1 == tree.levels.len() {
        V::around(middle(particles, rows, columns), 0.0)
    } else {
        bounds.refit_levels.volume(at, level, row, column)
    }
}

/// The paper's Figure 4.
fn rebuild_paper<V: Volume>(bounds: &mut Bounds<V>, tree: &GridTree, particles: &ClothParticles) {
    bounds.nodes.clear();
    let longest = tree.outline.layout.columns.max(tree.outline.layout.rows) as f32;
    let mut radius = (longest + 1.0) / 2.0 * tree.spacing.max_element();
    for level in &tree.levels {
        for rows in &level.rows {
            for columns in &level.columns {
                let corner = |row, column| {
                    let slot = tree.outline.layout.slot(row, column);
                    particles.blocks()[slot.block].position(slot.lane)
                };
                let (left, right) = (columns.span.start, columns.span.end - 1);
                let (top, bottom) = (rows.span.start, rows.span.end - 1);
                let upper = corner(top, left) + corner(top, right);
                let sum = upper + corner(bottom, left) + corner(bottom, right);
                bounds.nodes.push(V::around(sum / 4.0, radius));
            }
        }
        radius /= 2.0;
    }
}

/// Tests the root, and then, level by level, the children of each touching node.
fn descend(
    tree: &GridTree,
    particles: &ClothParticles,
    probe: &Probe,
    found: &mut SearchBuffers,
    touches: impl Fn(usize, [u32; 2], &Part, &Part) -> bool,
) {
    let [here, next] = &mut found.frontier;
    here.clear();
    here.push([0, 1, 0, 1]);
    let leaves = tree.levels.len() - 1;
    for (level, parts) in tree.levels.iter().enumerate() {
        let before = found.visits.len();
        next.clear();
        for &[first_row, end_row, first_column, end_column] in here.iter() {
            for (row, rows) in (first_row..end_row).zip(&parts.rows[first_row as usize..]) {
                for (column, columns) in
                    (first_column..end_column).zip(&parts.columns[first_column as usize..])
                {
                    let touching = touches(level, [row, column], rows, columns);
                    if !found.is_silent {
                        found.visits.push((parts.index(row, column), touching));
                    }
                    if touching && level < leaves {
                        let (below, beside) = (&rows.children, &columns.children);
                        next.push([below.start, below.end, beside.start, beside.end]);
                    } else if touching && probe.meets(middle(particles, rows, columns)) {
                        (found.candidates)
                            .push(rows.middle * tree.outline.layout.columns + columns.middle);
                    }
                }
            }
        }
        if level == leaves {
            found.leaf_tests += found.visits.len() - before;
        }
        std::mem::swap(here, next);
    }
}
