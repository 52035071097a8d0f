//! The quadtree: the particles of each node.

mod grid;
mod halving;
mod network;
mod node;
mod refit;
mod shape;
mod stored;
#[cfg(test)]
mod tests;

use std::{ops::Range, sync::Arc};

use bevy::{
    math::{Vec3, bounding::BoundingSphere},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use crate::cloth::{
    ClothError, ClothGrid, ClothParticles, Graph, Layout, ParticleError, Spring, SpringError,
    SpringKind, Surface,
};
use network::NetworkTree;
use shape::Tree;
use stored::growth;

pub use node::Node;
pub(crate) use stored::{Volumes, each};

use halving::GridTree;

/// A tree over the particles of a cloth. Each node's patch is split into up to four, down to one particle in each leaf.
/// It depends only on the rest shape, is built once, and is shared by its clones.
///
/// Nodes are numbered level by level from the root, 0. A grid's tree stores no nodes, only the halves of its rows and
/// columns on each level.
#[derive(Reflect, Debug, Clone)]
#[type_path = "bevy_drape"]
#[reflect(opaque)]
#[reflect(Default, Debug, Clone)]
pub struct QuadTree(Arc<dyn Tree>);

impl Default for QuadTree {
    /// A tree without particles.
    fn default() -> Self {
        Self(Arc::new(NetworkTree::default()))
    }
}

impl QuadTree {
    /// Builds the tree of a surface: of a [grid](Self::of_grid) by rows and columns, of a mesh by patches. `diagonals`
    /// states whether shear springs run along the diagonals of a grid.
    pub fn of_surface(surface: &Surface, diagonals: bool) -> Self {
        match surface.as_grid() {
            Some(grid) => Self::of_grid(grid, diagonals),
            None => Self(Arc::new(NetworkTree::new(
                surface.rest_positions(),
                surface.layout(),
                surface.graph(),
            ))),
        }
    }

    /// Builds the tree of a grid, by halving its rows and columns. `diagonals` states whether shear springs run along
    /// the diagonals, which shortens distances along the springs.
    pub fn of_grid(grid: &ClothGrid, diagonals: bool) -> Self {
        Self(Arc::new(GridTree::new(grid, diagonals)))
    }

    /// Builds a tree over any particles: `rest` are their positions at rest (m), and `springs` join them. Bend springs
    /// are not paths. Takes O(n log² n) time.
    ///
    /// # Errors
    /// [`SpringError::Invalid`] for the first spring that does not join two particles, or whose rest length is not
    /// from 10⁻⁹ to 10¹² m. The stretch of a spring without a length is undefined.
    /// [`ParticleError::NotFinite`] for a position that is not finite.
    pub fn of_network(rest: &[Vec3], springs: &[Spring]) -> Result<Self, ClothError> {
        if let Some(index) = rest.iter().position(|position| !position.is_finite()) {
            return Err(ClothError::Particle(ParticleError::NotFinite {
                index,
                position: rest[index],
                displacement: Vec3::ZERO,
                inverse_mass: 0.0,
            }));
        }
        let is_valid = |spring: &Spring| {
            spring.ends.iter().all(|&end| (end as usize) < rest.len())
                && (1.0e-9..=1.0e12).contains(&spring.rest_length)
        };
        if let Some(index) = springs.iter().position(|spring| !is_valid(spring)) {
            return Err(ClothError::Spring(SpringError::Invalid {
                index,
                spring: springs[index],
                particles: rest.len(),
            }));
        }
        // The stretch of bend springs is not measured.
        let paths = springs
            .iter()
            .filter(|spring| spring.kind != SpringKind::Bend);
        let graph = Graph::new(
            rest.len(),
            paths.map(|spring| (spring.ends, spring.rest_length)),
        );
        let layout = Layout::new(rest.len() as u32, 1);
        Ok(Self(Arc::new(NetworkTree::new(rest, layout, &graph))))
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.levels().last().map_or(0, |level| level.end as usize)
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The nodes of each level, the root's first. All leaves are on the last level; above it, a patch of one particle
    /// has itself as its only child.
    pub fn levels(&self) -> &[Range<u32>] {
        self.0.levels()
    }

    /// The level of a node, 0 for the root.
    pub fn level_of(&self, node: u32) -> usize {
        self.levels().partition_point(|level| level.end <= node)
    }

    /// The node with an index.
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn node(&self, node: u32) -> Node {
        self.0.node(self.level_of(node), node)
    }

    /// Largest distance at rest from a particle to a corner of its faces, along the springs (m).
    pub(crate) fn face_reach(&self, surface: &Surface) -> f32 {
        surface.face_reach(self.0.diagonals())
    }

    /// A sphere around all particle centres, from the root's rest shape at a stretch
    /// ([`Stretch::bound`](crate::solver::Stretch)). It reads only one particle for each piece of the cloth.
    pub fn root_sphere(&self, particles: &ClothParticles, stretch: f32) -> BoundingSphere {
        let none = BoundingSphere::new(Vec3::ZERO, 0.0);
        if !self.matches(particles) {
            return none;
        }
        let sphere = |&top: &u32| {
            let node = self.node(top);
            let radius = (node.rest_radius * growth(stretch)).max(0.0);
            (particles.position_at(node.middle as usize), radius)
        };
        let mut tops = self.0.tops().iter().map(sphere);
        let Some((centre, radius)) = tops.next() else {
            return none;
        };
        let first = BoundingSphere::new(centre, radius);
        tops.fold(first, |around, (centre, radius)| {
            merged(&around, centre, radius)
        })
    }

    /// Indices of a node's particles.
    pub fn particles_of(&self, node: u32) -> Vec<u32> {
        let level = self.level_of(node);
        let mut nodes = vec![node];
        for _ in level + 1..self.levels().len() {
            nodes = nodes
                .into_iter()
                .flat_map(|node| self.node(node).children().to_vec())
                .collect();
        }
        nodes
            .into_iter()
            .map(|leaf| self.node(leaf).middle)
            .collect()
    }

    /// Numbers of nodes and columns, which identify the volumes of a tree.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.len(), self.0.layout().columns as usize]
    }

    /// Whether the tree belongs to `particles`: the same number and layout.
    pub fn matches(&self, particles: &ClothParticles) -> bool {
        self.0.layout() == particles.layout()
    }

    pub(super) fn shape(&self) -> &dyn Tree {
        &*self.0
    }

    /// Checks that each node's children divide its patch, and that each of `particles` particles is in exactly one
    /// leaf.
    ///
    /// # Errors
    /// A message that names the node at fault.
    pub fn validate(&self, particles: usize) -> Result<(), String> {
        let last = self.levels().len().saturating_sub(1);
        let mut parent_of = vec![None; self.len()];
        let mut leaf_of = vec![None; particles];
        for (level, nodes) in self.levels().iter().enumerate() {
            for index in nodes.clone() {
                let node = self.node(index);
                if node.is_leaf() != (level == last) {
                    return Err(format!(
                        "node {index} of level {level} of {last} is a leaf too early"
                    ));
                }
                if level > 0 && parent_of[index as usize].is_none() {
                    return Err(format!("node {index} has no parent"));
                }
                for &child in node.children() {
                    let is_below = self.levels()[level + 1].contains(&child);
                    if !is_below || parent_of[child as usize].replace(index).is_some() {
                        return Err(format!(
                            "node {child} is not a child of node {index} alone, one level below"
                        ));
                    }
                }
                if node.is_leaf() {
                    match leaf_of.get_mut(node.middle as usize) {
                        Some(leaf @ None) => *leaf = Some(index),
                        _ => {
                            return Err(format!(
                                "leaf {index} is not the one of particle {}",
                                node.middle
                            ));
                        }
                    }
                }
                if !self.particles_of(index).contains(&node.middle) {
                    return Err(format!("the middle of node {index} is not in it"));
                }
            }
        }
        match leaf_of.iter().position(Option::is_none) {
            None => Ok(()),
            Some(particle) => Err(format!("particle {particle} is in no leaf")),
        }
    }
}

/// The sphere around both. Pieces may be as far apart as numbers go, or lost, so no length overflows: `f64`.
fn merged(around: &BoundingSphere, centre: Vec3, radius: f32) -> BoundingSphere {
    let (from, to) = (around.center.as_dvec3(), centre.as_dvec3());
    let [one, other, apart] = [
        f64::from(around.radius()),
        f64::from(radius),
        from.distance(to),
    ];
    if one >= apart + other {
        return *around;
    }
    // Another that contains it is the whole.
    let whole = ((one + other + apart) / 2.0).max(other);
    let part = match whole > other {
        true => (whole - one) / apart,
        false => 1.0,
    };
    let middle = from.lerp(to, part).as_vec3();
    // More than the rounding errors of its middle and radius.
    let rounding = f64::from(middle.abs().max_element() * f32::EPSILON);
    let radius = (whole * (1.0 + 1.0e-6) + rounding) as f32;
    BoundingSphere::new(middle, radius.max(0.0))
}
