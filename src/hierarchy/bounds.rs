//! The bounding volumes of a tree's nodes.

use bevy::reflect::{Reflect, std_traits::ReflectDefault};

use super::{
    rule::BoundRule,
    tree::{QuadTree, Volumes, each, growth},
    volume::{BoundingVolume, NodeVolume},
};
use crate::cloth::{BoundsError, ClothParticles};

/// The bounding volumes of a tree's nodes, with a volume type and a rule chosen at run time.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
#[type_path = "bevy_drape"]
#[reflect(opaque)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct NodeBounds {
    pub(super) volumes: Volumes,
    /// Size of the tree of the last update.
    size: [usize; 2],
}

impl NodeBounds {
    /// Updates the volumes for the particles. `stretch` is the largest stretch of any structural or shear spring
    /// ([`Stretch::bound`](crate::solver::Stretch)).
    ///
    /// # Errors
    /// [`BoundsError::Unsupported`] if the volume does not support the rule. Nothing changes then.
    pub fn rebuild(
        &mut self,
        (volume, rule): (BoundingVolume, BoundRule),
        tree: &QuadTree,
        particles: &ClothParticles,
        stretch: f32,
    ) -> Result<(), BoundsError> {
        rule.check(volume)?;
        if self.volume() != volume {
            self.volumes = Volumes::of(volume);
        }
        self.size = tree.size();
        each!(&mut self.volumes, bounds => {
            bounds.rule = rule;
            bounds.growth = growth(stretch);
        });
        tree.shape().rebuild(&mut self.volumes, particles);
        Ok(())
    }

    /// Whether they belong to a tree of this size. Those of the rest shape belong to any tree.
    pub(super) fn matches(&self, tree: &QuadTree) -> bool {
        self.rule() == BoundRule::RestShape || self.size == tree.size()
    }

    /// The type of the volumes.
    pub fn volume(&self) -> BoundingVolume {
        self.volumes.kind()
    }

    /// The rule of the last update.
    pub fn rule(&self) -> BoundRule {
        each!(&self.volumes, bounds => bounds.rule)
    }

    /// The volume of a node around its particles, including their radius (m), in the cloth's frame. Volumes by `Paper`
    /// ignore the radius.
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
        let volume = tree.shape().volume(&self.volumes, particles, node);
        volume.inflated(radius)
    }
}
