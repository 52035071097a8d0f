//! The interface of all trees.

use std::fmt::Debug;

use super::{
    node::{Node, Outline},
    stored::Volumes,
};
use crate::{
    cloth::ClothParticles,
    hierarchy::{probe::Probe, search_buffers::SearchBuffers, volume::NodeVolume},
};

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
        found: &mut SearchBuffers,
    );
}
