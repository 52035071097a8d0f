//! The interface of all trees.

use std::{fmt::Debug, ops::Range};

use super::{node::Node, stored::Volumes};
use crate::{
    cloth::{ClothParticles, Layout},
    hierarchy::{probe::Probe, query::TopDownQuery, volume::NodeVolume},
};

/// Facts about a tree.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Outline {
    /// The layout of its particles.
    pub layout: Layout,
    /// The nodes of each level, the root's first.
    pub levels: Vec<Range<u32>>,
    /// Whether distances are also along the diagonals of a grid's cells.
    pub diagonals: bool,
    /// Nodes that together contain all particles: the root, unless no path leads from it to all of them.
    pub tops: Vec<u32>,
}

/// A tree over a cloth's particles, built once for a surface.
pub(crate) trait Tree: Debug + Send + Sync {
    fn outline(&self) -> &Outline;

    /// A node of a level.
    fn node(&self, level: usize, node: u32) -> Node;

    /// Updates the volumes for the particles, by their rule and growth. May choose another rule.
    fn rebuild(&self, volumes: &mut Volumes, particles: &ClothParticles);

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
