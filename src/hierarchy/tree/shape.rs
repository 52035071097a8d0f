//! What every kind of tree can do.

use std::{fmt::Debug, ops::Range};

use super::Node;
use crate::{
    cloth::{ClothParticles, Layout},
    hierarchy::{BoundRule, NodeVolume, Probe, found::Found, stored::Volumes},
};

/// A tree over a cloth's particles, made once for a surface.
pub(crate) trait Tree: Debug + Send + Sync {
    /// The nodes of each level, the root's first.
    fn levels(&self) -> &[Range<u32>];

    /// A node of a level.
    fn node(&self, level: usize, node: u32) -> Node;

    /// Nodes side by side on a level, where all of its nodes lie in rows and columns.
    fn columns(&self, _level: usize) -> Option<u32> {
        None
    }

    /// How the particles lie that it was made for.
    fn layout(&self) -> Layout;

    /// Nodes that hold all particles between them: the root, unless no path leads from it to all of them.
    fn tops(&self) -> &[u32];

    /// Brings the volumes up to date with the particles.
    fn rebuild(
        &self,
        volumes: &mut Volumes,
        rule: BoundRule,
        particles: &ClothParticles,
        stretch: f32,
    );

    /// The volume of a node around its particles' centres.
    fn volume(&self, volumes: &Volumes, particles: &ClothParticles, node: u32) -> NodeVolume;

    /// Adds what a probe meets to what was found.
    fn search(
        &self,
        volumes: &Volumes,
        particles: &ClothParticles,
        probe: &Probe,
        found: &mut Found,
    );
}
