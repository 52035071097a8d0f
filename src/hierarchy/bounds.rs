//! Bounding spheres of the tree's nodes under three rules.

use bevy::{
    ecs::{component::Component, reflect::ReflectComponent},
    math::{Vec3, Vec3A, bounding::BoundingSphere},
    reflect::{Reflect, std_traits::ReflectDefault},
};

use super::QuadTree;
use crate::cloth::{ClothGrid, ClothParticles};

/// What a radius grows by so that rounding in `f32` never makes a sphere too small. A sphere's radius and the
/// test against it take fewer than 20 roundings of half an ε each; this is 84 ε.
pub(crate) const ROUNDING: f32 = 1.0 + 1.0e-5;

/// Where the sphere of a node is.
#[derive(Component, Reflect, Debug, Default, Clone, Copy, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, Clone, PartialEq, Hash)]
pub enum BoundRule {
    /// The paper's Figure 4: the root's radius is (longest side + 1)/2 spacings, each level below has half of
    /// its parent's. Around the mean of the patch's four corners. *Misses contacts*: the radius is less than
    /// half of a square patch's diagonal.
    Paper,
    /// The smallest radius around the mean of the children's centres that holds the children's spheres,
    /// computed bottom up each tick: tight, complete, at the cost of touching every node.
    Refit,
    /// Around the patch's middle particle; the radius is the largest distance at rest, along the springs, to a
    /// particle of the patch, times 1 + the largest stretch present. Nothing is computed a node, and nothing
    /// is missed: a way along the springs is never shorter than the straight line, and none is longer than at
    /// rest by more than the most stretched spring.
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
}

/// The bounding spheres of a tree's nodes.
#[derive(Reflect, Debug, Default, Clone, PartialEq)]
pub struct SphereBounds {
    rule: BoundRule,
    particle_radius: f32,
    /// Of `RestShape`: what a radius at rest grows by.
    growth: f32,
    /// Of `Refit` and `Paper`.
    centre: Vec<Vec3>,
    /// Of `Refit` and `Paper` (m).
    radius: Vec<f32>,
}

impl SphereBounds {
    /// Brings the spheres up to date with the particles. `stretch` is the largest over structural and shear
    /// springs ([`Stretch::bound`](crate::solver::Stretch)), `particle_radius` that of the leaves (m).
    pub fn rebuild(
        &mut self,
        rule: BoundRule,
        tree: &QuadTree,
        grid: &ClothGrid,
        particles: &ClothParticles,
        stretch: f32,
        particle_radius: f32,
    ) {
        self.rule = rule;
        self.particle_radius = particle_radius;
        // Finite, so that a leaf's radius at rest, 0 times this, is 0 whatever becomes of the cloth.
        self.growth = ((1.0 + stretch) * ROUNDING).min(f32::MAX);
        match rule {
            BoundRule::RestShape => {}
            BoundRule::Refit => self.refit(tree, particles),
            BoundRule::Paper => self.halve(tree, grid, particles),
        }
    }

    /// Bottom up. Children come after their parents in the tree, so one way backwards does it.
    fn refit(&mut self, tree: &QuadTree, particles: &ClothParticles) {
        self.centre.resize(tree.nodes().len(), Vec3::ZERO);
        self.radius.resize(tree.nodes().len(), 0.0);
        for (index, node) in tree.nodes().iter().enumerate().rev() {
            let children = node.children.start as usize..node.children.end as usize;
            if children.is_empty() {
                self.centre[index] = particles.position_at(node.middle as usize);
                self.radius[index] = self.particle_radius;
                continue;
            }
            let centre = self.centre[children.clone()].iter().sum::<Vec3>() / children.len() as f32;
            let reach = |child: usize| centre.distance(self.centre[child]) + self.radius[child];
            self.radius[index] =
                children.map(reach).fold(0.0, f32::max) * (1.0 + 4.0 * f32::EPSILON);
            self.centre[index] = centre;
        }
    }

    /// The paper's Figure 4.
    fn halve(&mut self, tree: &QuadTree, grid: &ClothGrid, particles: &ClothParticles) {
        self.centre.resize(tree.nodes().len(), Vec3::ZERO);
        self.radius.resize(tree.nodes().len(), 0.0);
        let longest = grid.columns().max(grid.rows()) as f32;
        let mut radius = (longest + 1.0) / 2.0 * grid.spacing().max_element();
        for level in tree.levels() {
            for index in level.start as usize..level.end as usize {
                let node = &tree.nodes()[index];
                let (left, right) = (node.columns.start, node.columns.end - 1);
                let (top, bottom) = (node.rows.start, node.rows.end - 1);
                let corner =
                    |row, column| particles.position_at(tree.particle(row, column) as usize);
                self.centre[index] = (corner(top, left)
                    + corner(top, right)
                    + corner(bottom, left)
                    + corner(bottom, right))
                    / 4.0;
                self.radius[index] = radius;
            }
            radius /= 2.0;
        }
    }

    /// The rule by which the spheres were last brought up to date.
    pub fn rule(&self) -> BoundRule {
        self.rule
    }

    /// Radius of each particle (m).
    pub fn particle_radius(&self) -> f32 {
        self.particle_radius
    }

    /// The sphere of a node, in the cloth's frame (m).
    pub fn sphere(&self, tree: &QuadTree, particles: &ClothParticles, node: u32) -> BoundingSphere {
        let (centre, radius) = match self.rule {
            BoundRule::RestShape => self.rest_sphere(tree, particles, node),
            BoundRule::Refit | BoundRule::Paper => self.stored_sphere(node),
        };
        BoundingSphere::new(Vec3A::from(centre), radius)
    }

    /// The sphere of a node under `RestShape`.
    pub(crate) fn rest_sphere(
        &self,
        tree: &QuadTree,
        particles: &ClothParticles,
        node: u32,
    ) -> (Vec3, f32) {
        let node = &tree.nodes()[node as usize];
        let radius = node.rest_radius * self.growth + self.particle_radius;
        (particles.position_at(node.middle as usize), radius)
    }

    /// The sphere of a node under `Refit` and `Paper`.
    pub(crate) fn stored_sphere(&self, node: u32) -> (Vec3, f32) {
        (self.centre[node as usize], self.radius[node as usize])
    }

    /// Whether each node's sphere holds its particles and, under `Refit`, its children's spheres. Under
    /// `Paper` that often does not hold.
    ///
    /// # Errors
    /// A sentence that names the node at fault.
    pub fn validate(&self, tree: &QuadTree, particles: &ClothParticles) -> Result<(), String> {
        let sphere = |node: u32| {
            let sphere = self.sphere(tree, particles, node);
            (
                Vec3::from(sphere.center).as_dvec3(),
                f64::from(sphere.radius()),
            )
        };
        let tolerance = f64::from(ROUNDING);
        for (index, node) in tree.nodes().iter().enumerate() {
            let (centre, radius) = sphere(index as u32);
            for row in node.rows.clone() {
                for column in node.columns.clone() {
                    let particle = tree.particle(row, column) as usize;
                    let reach = centre.distance(particles.position_at(particle).as_dvec3())
                        + f64::from(self.particle_radius);
                    if reach > radius * tolerance {
                        return Err(format!(
                            "node {index} of radius {radius} does not hold particle {particle}, at {reach}"
                        ));
                    }
                }
            }
            if self.rule == BoundRule::Refit {
                for child in node.children.clone() {
                    let (child_centre, child_radius) = sphere(child);
                    if centre.distance(child_centre) + child_radius > radius * tolerance {
                        return Err(format!("node {index} does not hold its child {child}"));
                    }
                }
            }
        }
        Ok(())
    }
}
