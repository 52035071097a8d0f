//! The quad-tree: which particles each node holds.

use std::ops::Range;

use bevy::{math::Vec2, reflect::Reflect};

use crate::cloth::ClothGrid;

/// A node: a patch of the grid.
#[derive(Reflect, Debug, Clone, PartialEq)]
pub struct Node {
    /// First column and one past the last.
    pub columns: Range<u32>,
    /// First row and one past the last.
    pub rows: Range<u32>,
    /// Indices of the children, empty for a leaf.
    pub children: Range<u32>,
    /// Index of the patch's middle particle.
    pub middle: u32,
    /// Largest distance at rest, along the springs, from the middle particle to one of the patch (m).
    pub rest_radius: f32,
}

impl Node {
    /// Whether the node holds one particle.
    pub fn is_leaf(&self) -> bool {
        self.children.is_empty()
    }
}

/// A quad-tree over a grid of any size, one particle a leaf, level by level.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
pub struct QuadTree {
    nodes: Vec<Node>,
    levels: Vec<Range<u32>>,
    columns: u32,
}

impl QuadTree {
    /// The tree over `grid`. `diagonals` says whether springs run along them: distances through the springs
    /// are shorter then.
    pub fn of_grid(grid: &ClothGrid, diagonals: bool) -> Self {
        let node = |columns: Range<u32>, rows: Range<u32>| {
            let middle = |range: &Range<u32>| range.start + (range.end - range.start - 1) / 2;
            let (column, row) = (middle(&columns), middle(&rows));
            // A middle is never nearer to the end than to the start, and distances grow with either count.
            let across = columns.end - 1 - column;
            let down = rows.end - 1 - row;
            Node {
                middle: grid.index(row, column),
                rest_radius: rest_distance(grid.spacing(), across, down, diagonals),
                columns,
                rows,
                children: 0..0,
            }
        };
        let mut nodes = vec![node(0..grid.columns(), 0..grid.rows())];
        let mut levels = Vec::new();
        let mut level = 0..1;
        while !level.is_empty() {
            levels.push(level.start as u32..level.end as u32);
            for parent in level.clone() {
                let first = nodes.len() as u32;
                let (columns, rows) = (nodes[parent].columns.clone(), nodes[parent].rows.clone());
                if columns.len() > 1 || rows.len() > 1 {
                    for rows in halves(rows) {
                        for columns in halves(columns.clone()) {
                            nodes.push(node(columns, rows.clone()));
                        }
                    }
                }
                nodes[parent].children = first..nodes.len() as u32;
            }
            level = level.end..nodes.len();
        }
        Self {
            nodes,
            levels,
            columns: grid.columns(),
        }
    }

    /// All nodes, level by level, the root first.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The nodes of each level, the root's first.
    pub fn levels(&self) -> &[Range<u32>] {
        &self.levels
    }

    /// The level that a node is on, 0 for the root.
    pub fn level_of(&self, node: u32) -> usize {
        self.levels.partition_point(|level| level.end <= node)
    }

    /// Index of the particle at (row, column).
    pub fn particle(&self, row: u32, column: u32) -> u32 {
        row * self.columns + column
    }

    /// Whether each node's children part its patch among them and each leaf holds one particle.
    ///
    /// # Errors
    /// A sentence that names the node at fault.
    pub fn validate(&self, grid: &ClothGrid) -> Result<(), String> {
        let mut leaf_of = vec![false; grid.len()];
        for (index, node) in self.nodes.iter().enumerate() {
            let area = |node: &Node| node.columns.len() * node.rows.len();
            if node.is_leaf() {
                if area(node) != 1 {
                    return Err(format!("leaf {index} holds {} particles", area(node)));
                }
                let particle = grid.index(node.rows.start, node.columns.start);
                if node.middle != particle
                    || std::mem::replace(&mut leaf_of[particle as usize], true)
                {
                    return Err(format!(
                        "leaf {index} is not the one leaf of particle {particle}"
                    ));
                }
                continue;
            }
            let children = &self.nodes[node.children.start as usize..node.children.end as usize];
            let within = |outer: &Range<u32>, inner: &Range<u32>| {
                outer.start <= inner.start && inner.end <= outer.end && !inner.is_empty()
            };
            let inside = |child: &Node| {
                within(&node.columns, &child.columns) && within(&node.rows, &child.rows)
            };
            if !children.iter().all(inside)
                || children.iter().map(area).sum::<usize>() != area(node)
            {
                return Err(format!(
                    "the children of node {index} do not part its patch"
                ));
            }
        }
        match leaf_of.iter().position(|&found| !found) {
            None => Ok(()),
            Some(particle) => Err(format!("particle {particle} is in no leaf")),
        }
    }
}

/// Both halves of `range`, the first the larger, or the whole of it where it holds one.
fn halves(range: Range<u32>) -> impl Iterator<Item = Range<u32>> + Clone {
    let half = range.start + (range.end - range.start).div_ceil(2);
    [range.start..half, half..range.end]
        .into_iter()
        .filter(|half| !half.is_empty())
}

/// Length of the shortest way along the springs at rest between two particles so many columns and rows apart
/// (m).
fn rest_distance(spacing: Vec2, across: u32, down: u32, diagonals: bool) -> f32 {
    let diagonal = if diagonals { across.min(down) } else { 0 };
    let (across, down) = (across - diagonal, down - diagonal);
    diagonal as f32 * spacing.length() + across as f32 * spacing.x + down as f32 * spacing.y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloth::Cloth;
    use bevy::math::Vec3;

    fn grid(columns: u32, rows: u32) -> ClothGrid {
        Cloth::new(columns, rows, 0.5)
            .grid(Vec3::ONE)
            .expect("a sound grid")
    }

    #[test]
    fn every_grid_size_gives_a_sound_tree() {
        for columns in 2..20 {
            for rows in 2..20 {
                let grid = grid(columns, rows);
                let tree = QuadTree::of_grid(&grid, true);
                assert_eq!(tree.validate(&grid), Ok(()), "{columns} × {rows}");
                let depth = columns.max(rows).next_power_of_two().ilog2() as usize;
                assert_eq!(tree.levels().len(), depth + 1, "{columns} × {rows}");
            }
        }
    }

    #[test]
    fn the_papers_cloth_has_256_leaves_on_its_fourth_level() {
        let tree = QuadTree::of_grid(&grid(16, 16), true);
        let counts: Vec<usize> = tree.levels().iter().map(Range::len).collect();
        assert_eq!(counts, [1, 4, 16, 64, 256]);
        for (level, range) in tree.levels().iter().enumerate() {
            assert!(range.clone().all(|node| tree.level_of(node) == level));
        }
    }

    #[test]
    fn validate_finds_what_is_broken() {
        let grid = grid(5, 3);
        let sound = QuadTree::of_grid(&grid, true);
        let break_it = |mend: fn(&mut QuadTree)| {
            let mut tree = sound.clone();
            mend(&mut tree);
            tree.validate(&grid)
        };
        assert!(break_it(|tree| tree.nodes[0].children.end -= 1).is_err());
        assert!(break_it(|tree| tree.nodes.last_mut().expect("a leaf").middle = 0).is_err());
        assert!(break_it(|tree| tree.nodes[1].columns.end = 9).is_err());
    }

    /// Dijkstra would say the same; on a grid the shortest way is known: diagonals first, then straight on.
    #[test]
    fn rest_radius_reaches_the_farthest_corner() {
        let tree = QuadTree::of_grid(&grid(16, 16), true);
        // From (7, 7) to (15, 15): eight diagonals of 0.5 √2 m.
        assert!((tree.nodes()[0].rest_radius - 4.0 * 2.0_f32.sqrt()).abs() < 1e-6);
        let tree = QuadTree::of_grid(&grid(16, 16), false);
        assert_eq!(tree.nodes()[0].rest_radius, 8.0);
        let tree = QuadTree::of_grid(&grid(9, 3), true);
        // From (1, 4) to (2, 8): one diagonal and three columns.
        assert!((tree.nodes()[0].rest_radius - 0.5 * 2.0_f32.sqrt() - 1.5).abs() < 1e-6);
        assert!(
            tree.nodes()
                .iter()
                .filter(|node| node.is_leaf())
                .all(|leaf| leaf.rest_radius == 0.0)
        );
    }
}
