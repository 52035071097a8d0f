//! Where the bounding volume of each node is, by three rules.

use bevy::{
    math::{
        Vec3,
        bounding::{Aabb3d, BoundingSphere},
    },
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::{
    BoundingVolume, KDop, NodeVolume, Obb, QuadTree,
    probe::ROUNDING,
    refit::Pyramid,
    tree::{GridTree, NetworkTree, Part, Shape},
    volume::Volume,
};
use crate::cloth::{ClothError, ClothParticles, Slot};

/// How the bounding volumes of a tree's nodes come about.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, Clone, PartialEq, Hash)]
pub enum BoundRule {
    /// The paper's Figure 4: the root's radius is (longest side + 1)/2 spacings, each level below has half of
    /// its parent's. Around the mean of the patch's four corners. *Misses contacts*: the radius is less than
    /// half of a square patch's diagonal. Of spheres, and of boxes whose half side it is; of grids.
    Paper,
    /// The smallest around the children's, computed bottom up each tick: tight, complete, at the cost of touching
    /// every particle. Of every volume.
    Refit,
    /// Around the patch's middle particle; the radius is the largest distance at rest, along the springs, to a
    /// particle of the patch, times 1 + the largest stretch present. Nothing is computed a node, and nothing
    /// is missed ([proof](super#nothing-is-missed)). Of spheres, and of the boxes around them.
    #[default]
    RestShape,
}

impl BoundRule {
    /// The rules with their names, for menus.
    pub const ALL: [(&str, Self); 3] = [
        ("rest shape", Self::RestShape),
        ("refit", Self::Refit),
        ("paper", Self::Paper),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        let is_it = |(_, each): &&(&str, Self)| *each == self;
        Self::ALL.iter().find(is_it).map_or("", |(name, _)| name)
    }

    /// Whether there is such a rule for a volume: all can be refitted, spheres and AABBs follow the others, too.
    pub fn suits(self, volume: BoundingVolume) -> bool {
        self == Self::Refit || matches!(volume, BoundingVolume::Sphere | BoundingVolume::Aabb)
    }

    /// # Errors
    /// [`ClothError::NoSuchBounds`] if there is no such rule for the volume.
    pub(super) fn check(self, volume: BoundingVolume) -> Result<(), ClothError> {
        if self.suits(volume) {
            return Ok(());
        }
        Err(ClothError::NoSuchBounds {
            volume: volume.name(),
            rule: self.name(),
        })
    }
}

/// What a radius at rest grows by. Finite, so that a leaf's, 0 times this, is 0 whatever becomes of the cloth.
pub(super) fn growth(stretch: f32) -> f32 {
    ((1.0 + stretch) * ROUNDING).min(f32::MAX)
}

/// The bounding volumes of one kind.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Bounds<V: Volume> {
    pub(super) rule: BoundRule,
    /// Of `RestShape`: what a radius at rest grows by.
    growth: f32,
    /// Of `Paper` each node's; of `Refit` those of a network's nodes.
    nodes: Vec<V>,
    /// Of `Refit` over a grid.
    pyramid: Pyramid<V>,
}

impl<V: Volume> Default for Bounds<V> {
    fn default() -> Self {
        Self {
            rule: BoundRule::default(),
            growth: 1.0,
            nodes: Vec::new(),
            pyramid: Pyramid::default(),
        }
    }
}

impl<V: Volume> Bounds<V> {
    fn rebuild(
        &mut self,
        rule: BoundRule,
        tree: &QuadTree,
        particles: &ClothParticles,
        stretch: f32,
    ) {
        self.rule = rule;
        self.growth = growth(stretch);
        match (rule, &tree.0) {
            (BoundRule::RestShape, _) => {}
            (BoundRule::Refit, Shape::Grid(tree)) => self.pyramid.refit(tree, particles.blocks()),
            (BoundRule::Refit, Shape::Network(tree)) => self.refit_network(tree, particles),
            (BoundRule::Paper, Shape::Grid(tree)) => self.halve(tree, particles),
            // Figure 4 is of a grid.
            (BoundRule::Paper, Shape::Network(_)) => self.rule = BoundRule::RestShape,
        }
    }

    /// Bottom up. Children come after their parents in the tree, so one way backwards does it.
    fn refit_network(&mut self, tree: &NetworkTree, particles: &ClothParticles) {
        self.nodes
            .resize(tree.nodes.len(), V::around(Vec3::ZERO, 0.0));
        for (index, node) in tree.nodes.iter().enumerate().rev() {
            let children = node.children.start as usize..node.children.end as usize;
            let volume = match &self.nodes[children] {
                [] => V::around(position(particles, tree.slots[node.middle as usize]), 0.0),
                [a] => *a,
                [a, b] => V::unite([a, b, a, b]),
                [a, b, c] => V::unite([a, b, c, c]),
                [a, b, c, d, ..] => V::unite([a, b, c, d]),
            };
            self.nodes[index] = volume;
        }
    }

    /// The paper's Figure 4.
    fn halve(&mut self, tree: &GridTree, particles: &ClothParticles) {
        self.nodes.clear();
        let longest = tree.layout.columns.max(tree.layout.rows) as f32;
        let mut radius = (longest + 1.0) / 2.0 * tree.longest_spacing();
        for level in &tree.levels {
            for rows in &level.rows {
                for columns in &level.columns {
                    let corner = |row, column| position(particles, tree.layout.slot(row, column));
                    let (left, right) = (columns.span.start, columns.span.end - 1);
                    let (top, bottom) = (rows.span.start, rows.span.end - 1);
                    let sum = corner(top, left)
                        + corner(top, right)
                        + corner(bottom, left)
                        + corner(bottom, right);
                    self.nodes.push(V::around(sum / 4.0, radius));
                }
            }
            radius /= 2.0;
        }
    }

    /// The volume of a node of a grid's tree that `Paper` or `Refit` has computed.
    #[inline(always)]
    pub(super) fn stored(
        &self,
        tree: &GridTree,
        particles: &ClothParticles,
        level: usize,
        [row, column]: [u32; 2],
    ) -> V {
        let at = &tree.levels[level];
        if self.rule == BoundRule::Paper {
            return self.nodes[at.index(row, column) as usize];
        }
        let (rows, columns) = (&at.rows[row as usize], &at.columns[column as usize]);
        if level + 1 == tree.levels.len() {
            V::around(middle(particles, rows, columns), 0.0)
        } else {
            self.pyramid.volume(at, level, row, column)
        }
    }

    /// The volume of a node of a network's tree that `Refit` has computed.
    #[inline(always)]
    pub(super) fn stored_in_network(&self, node: u32) -> V {
        self.nodes[node as usize]
    }

    /// The radius under `RestShape` (m).
    #[inline(always)]
    pub(super) fn grown(&self, rest_radius: f32) -> f32 {
        rest_radius * self.growth
    }

    fn volume(&self, tree: &QuadTree, particles: &ClothParticles, node: u32) -> V {
        let level = tree.level_of(node);
        let at = tree.node(node);
        match &tree.0 {
            _ if self.rule == BoundRule::RestShape => V::around(
                particles.position_at(at.middle as usize),
                self.grown(at.rest_radius),
            ),
            Shape::Grid(tree) => {
                let (row, column) = tree.parts(level, node);
                self.stored(tree, particles, level, [row, column])
            }
            Shape::Network(_) => self.stored_in_network(node),
        }
    }

    fn validate(&self, tree: &QuadTree, particles: &ClothParticles) -> Result<(), String> {
        for node in 0..tree.len() as u32 {
            let volume = self.volume(tree, particles, node);
            for particle in tree.particles_of(node) {
                let position = particles.position_at(particle as usize);
                if !volume.holds(position.as_dvec3(), 0.0) {
                    return Err(format!(
                        "node {node}, {volume:?}, does not hold particle {particle} at {position}"
                    ));
                }
            }
            if self.rule == BoundRule::Refit {
                for &child in tree.node(node).children() {
                    let child_volume = self.volume(tree, particles, child);
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

/// Where the particle in the middle of a node is (m).
#[inline(always)]
pub(super) fn middle(particles: &ClothParticles, rows: &Part, columns: &Part) -> Vec3 {
    particles.blocks()[(rows.block + columns.block) as usize].position(columns.lane as usize)
}

#[inline(always)]
pub(super) fn position(particles: &ClothParticles, slot: Slot) -> Vec3 {
    particles.blocks()[slot.block].position(slot.lane)
}

/// The bounding volumes of a tree's nodes, of a kind and by a rule that are chosen as the program runs.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
#[reflect(opaque)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct NodeBounds {
    pub(super) kind: Kind,
    /// Of the tree that they were last brought up to date for.
    size: [usize; 2],
}

/// One of the kinds, so that all that loops over nodes is compiled for it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Kind {
    Sphere(Bounds<BoundingSphere>),
    Aabb(Bounds<Aabb3d>),
    Obb(Bounds<Obb>),
    KDop14(Bounds<KDop<7>>),
    KDop18(Bounds<KDop<9>>),
    KDop26(Bounds<KDop<13>>),
}

impl Default for Kind {
    fn default() -> Self {
        Self::Sphere(Bounds::default())
    }
}

/// Runs the same code for whichever kind it is.
macro_rules! each {
    ($kind:expr, $bounds:ident => $code:expr) => {
        match $kind {
            Kind::Sphere($bounds) => $code,
            Kind::Aabb($bounds) => $code,
            Kind::Obb($bounds) => $code,
            Kind::KDop14($bounds) => $code,
            Kind::KDop18($bounds) => $code,
            Kind::KDop26($bounds) => $code,
        }
    };
}
pub(super) use each;

impl NodeBounds {
    /// Brings the volumes up to date with the particles. `stretch` is the largest over structural and shear
    /// springs ([`Stretch::bound`](crate::solver::Stretch)).
    ///
    /// # Errors
    /// [`ClothError::NoSuchBounds`] if there is no such rule for the volume. Nothing is changed then.
    pub fn rebuild(
        &mut self,
        (volume, rule): (BoundingVolume, BoundRule),
        tree: &QuadTree,
        particles: &ClothParticles,
        stretch: f32,
    ) -> Result<(), ClothError> {
        rule.check(volume)?;
        if self.volume() != volume {
            self.kind = match volume {
                BoundingVolume::Sphere => Kind::Sphere(Bounds::default()),
                BoundingVolume::Aabb => Kind::Aabb(Bounds::default()),
                BoundingVolume::Obb => Kind::Obb(Bounds::default()),
                BoundingVolume::KDop14 => Kind::KDop14(Bounds::default()),
                BoundingVolume::KDop18 => Kind::KDop18(Bounds::default()),
                BoundingVolume::KDop26 => Kind::KDop26(Bounds::default()),
            };
        }
        self.size = tree.size();
        each!(&mut self.kind, bounds => bounds.rebuild(rule, tree, particles, stretch));
        Ok(())
    }

    /// Whether they are those of a tree as large as this. The rest shape is anybody's.
    pub(super) fn fit(&self, tree: &QuadTree) -> bool {
        self.rule() == BoundRule::RestShape || self.size == tree.size()
    }

    /// The kind of volume.
    pub fn volume(&self) -> BoundingVolume {
        match self.kind {
            Kind::Sphere(_) => BoundingVolume::Sphere,
            Kind::Aabb(_) => BoundingVolume::Aabb,
            Kind::Obb(_) => BoundingVolume::Obb,
            Kind::KDop14(_) => BoundingVolume::KDop14,
            Kind::KDop18(_) => BoundingVolume::KDop18,
            Kind::KDop26(_) => BoundingVolume::KDop26,
        }
    }

    /// The rule by which the volumes were last brought up to date.
    pub fn rule(&self) -> BoundRule {
        each!(&self.kind, bounds => bounds.rule)
    }

    /// The volume of a node around the whole of its particles, which are of a radius (m), in the cloth's frame. The
    /// paper's volumes are as large as they are, whatever its particles.
    pub fn node(
        &self,
        tree: &QuadTree,
        particles: &ClothParticles,
        node: u32,
        particle_radius: f32,
    ) -> NodeVolume {
        let radius = match self.rule() {
            BoundRule::Paper => 0.0,
            BoundRule::Refit | BoundRule::RestShape => particle_radius,
        };
        each!(&self.kind, bounds => bounds.volume(tree, particles, node).drawn(radius))
    }

    /// Whether each node's volume holds its particles' centres and, under `Refit`, its children's volumes. Under
    /// `Paper` that often does not hold.
    ///
    /// # Errors
    /// A sentence that names the node at fault.
    pub fn validate(&self, tree: &QuadTree, particles: &ClothParticles) -> Result<(), String> {
        each!(&self.kind, bounds => bounds.validate(tree, particles))
    }
}
