//! The interface of all trees.

use std::{fmt::Debug, ops::Range};

use super::{node::Node, stored::Volumes};
use crate::{
    cloth::{ClothParticles, Layout},
    hierarchy::{probe::Probe, query::TopDownQuery, rule::BoundRule, volume::NodeVolume},
};

/// A tree over a cloth's particles, built once for a surface.
pub(crate) trait Tree: Debug + Send + Sync {
    /// The nodes of each level, the root's first.
    fn levels(&self) -> &[Range<u32>];

    /// A node of a level.
    fn node(&self, level: usize, node: u32) -> Node;

    /// Whether distances are also along the diagonals of a grid's cells.
    fn diagonals(&self) -> bool;

    /// The layout of its particles.
    fn layout(&self) -> Layout;

    /// Nodes that together contain all particles: the root, unless no path leads from it to all of them.
    fn tops(&self) -> &[u32];

    /// Updates the volumes for the particles.
    fn rebuild(
        &self,
        volumes: &mut Volumes,
        rule: BoundRule,
        particles: &ClothParticles,
        stretch: f32,
    );

    /// The volume of a node around its particles' centres.
    fn volume(&self, volumes: &Volumes, particles: &ClothParticles, node: u32) -> NodeVolume;

    /// Appends the particles that a probe meets.
    fn search(
        &self,
        volumes: &Volumes,
        particles: &ClothParticles,
        probe: &Probe,
        found: &mut TopDownQuery,
    );
}
