//! The tree of arbitrary particles: patches split along the surface at rest, with stored nodes.

use std::ops::Range;

use bevy::math::{DVec3, Vec3};

use super::{
    node::{Node, Outline},
    shape::Tree,
    stored::{Bounds, Volumes, each},
};
use crate::{
    cloth::{ClothParticles, Graph, Layout, ShortestPaths, Slot},
    hierarchy::{
        probe::Probe,
        rule::BoundRule,
        search_buffers::SearchBuffers,
        volume::{NodeVolume, Volume},
    },
};

/// From this ratio of its radius along the surface to that through space on, a patch is folded: its halves are split
/// along the surface. On a flat patch, a path along edges is up to √2 times as long as a straight line from the same particle.
const FOLDED: f64 = 1.5;

/// A tree over arbitrarily connected particles.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct NetworkTree {
    /// Its tops are the topmost nodes with a finite radius.
    outline: Outline,
    nodes: Vec<NetworkNode>,
}

#[derive(Debug, Clone, PartialEq)]
struct NetworkNode {
    middle: u32,
    rest_radius: f32,
    /// Slot of the middle particle.
    slot: Slot,
    children: Range<u32>,
}

impl NetworkTree {
    /// Builds a tree over particles at `rest` (m), which lie as `layout` says, with paths along the edges of `graph`.
    pub fn new(rest: &[Vec3], layout: Layout, graph: &Graph) -> Self {
        let mut tree = Self::default();
        tree.outline.layout = layout;
        let mut splitter = Splitter {
            rest,
            order: (0..rest.len() as u32).collect(),
            paths: ShortestPaths::new(graph),
            pieces: match graph.pieces() {
                ..=1 => Vec::new(),
                _ => graph.pieces_of(),
            },
            distances: Vec::new(),
            keys: vec![0.0; rest.len()],
        };
        let mut patches: Vec<Range<usize>> =
            Vec::from_iter((!rest.is_empty()).then_some(0..rest.len()));
        while !patches.is_empty() {
            let first = tree.nodes.len() as u32;
            let below = first + patches.len() as u32;
            let is_last = patches.iter().all(|patch| patch.len() == 1);
            let mut parts = Vec::new();
            for patch in patches {
                let (middle, rest_radius, is_folded) = splitter.measure(patch.clone());
                let child = below + parts.len() as u32;
                if !is_last {
                    splitter.split(patch, is_folded, &mut parts);
                }
                // Of the last patches there are no parts.
                let end = below + parts.len() as u32;
                tree.nodes.push(NetworkNode {
                    middle,
                    rest_radius,
                    slot: layout.slot_of(middle as usize),
                    children: child..end,
                });
            }
            tree.outline.levels.push(first..below);
            patches = parts;
        }
        tree.find_tops();
        tree
    }

    fn find_tops(&mut self) {
        let mut queue: Vec<u32> = Vec::from_iter((!self.nodes.is_empty()).then_some(0));
        while let Some(index) = queue.pop() {
            let node = &self.nodes[index as usize];
            if node.rest_radius.is_finite() || node.children.is_empty() {
                self.outline.tops.push(index);
            } else {
                queue.extend(node.children.clone());
            }
        }
    }

    /// Bottom up. Children come after their parents, so one backward pass suffices.
    fn refit<V: Volume>(&self, bounds: &mut Bounds<V>, particles: &ClothParticles) {
        let none = V::around(Vec3::ZERO, 0.0);
        bounds.nodes.resize(self.nodes.len(), none);
        for (index, node) in self.nodes.iter().enumerate().rev() {
            let children = node.children.start as usize..node.children.end as usize;
            bounds.nodes[index] = match &bounds.nodes[children] {
                [] => V::around(position(particles, node.slot), 0.0),
                [a] => *a,
                [a, b] => V::unite([a, b, a, b]),
                [a, b, c] => V::unite([a, b, c, c]),
                [a, b, c, d, ..] => V::unite([a, b, c, d]),
            };
        }
    }

    /// The volume of a node.
    #[inline(always)]
    fn volume_of<V: Volume>(&self, bounds: &Bounds<V>, index: u32, middle: Vec3) -> V {
        match bounds.rule {
            BoundRule::RestShape => bounds.at_rest(middle, self.nodes[index as usize].rest_radius),
            BoundRule::Refit | BoundRule::Paper => bounds.nodes[index as usize],
        }
    }
}

impl Tree for NetworkTree {
    fn outline(&self) -> &Outline {
        &self.outline
    }

    fn node(&self, level: usize, node: u32) -> Node {
        let of = &self.nodes[node as usize];
        let mut children = [0; 4];
        for (id, child) in children.iter_mut().zip(of.children.clone()) {
            *id = child;
        }
        Node {
            level,
            middle: of.middle,
            rest_radius: of.rest_radius,
            children,
            child_count: of.children.len() as u8,
        }
    }

    fn rebuild(&self, volumes: &mut Volumes, particles: &ClothParticles) {
        each!(volumes, bounds => match bounds.rule {
            BoundRule::RestShape => {}
            BoundRule::Refit => self.refit(bounds, particles),
            // The paper's Figure 4 is for grids.
            BoundRule::Paper => bounds.rule = BoundRule::RestShape,
        });
    }

    fn volume(&self, volumes: &Volumes, particles: &ClothParticles, node: u32) -> NodeVolume {
        let middle = position(particles, self.nodes[node as usize].slot);
        each!(volumes, bounds => self.volume_of(bounds, node, middle).into())
    }

    fn search(
        &self,
        volumes: &Volumes,
        particles: &ClothParticles,
        probe: &Probe,
        found: &mut SearchBuffers,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let reach = probe.reach() as f32;
        each!(volumes, bounds => {
            let queue = &mut found.frontier[0];
            queue.clear();
            queue.push([0, 1, 0, 0]);
            let mut next = 0;
            // Children are appended to the queue: level by level.
            while let Some(&[first, end, ..]) = queue.get(next) {
                next += 1;
                for index in first..end {
                    let node = &self.nodes[index as usize];
                    let middle = position(particles, node.slot);
                    let touching = self.volume_of(bounds, index, middle).may_reach(probe, reach);
                    if !found.is_silent {
                        found.visits.push((index, touching));
                    }
                    if node.children.is_empty() {
                        found.leaf_tests += 1;
                        if touching && probe.meets(middle) {
                            found.candidates.push(node.middle);
                        }
                    } else if touching {
                        queue.push([node.children.start, node.children.end, 0, 0]);
                    }
                }
            }
        });
    }
}

#[inline(always)]
fn position(particles: &ClothParticles, slot: Slot) -> Vec3 {
    particles.blocks()[slot.block].position(slot.lane)
}

/// Divides patches.
struct Splitter<'a> {
    rest: &'a [Vec3],
    /// The particles, grouped by patch.
    order: Vec<u32>,
    paths: ShortestPaths<'a>,
    /// The connected piece of each particle; empty if there is one.
    pieces: Vec<u32>,
    distances: Vec<f64>,
    /// Sort keys of a patch's particles.
    keys: Vec<f32>,
}

impl Splitter<'_> {
    /// The middle particle of a patch, nearest to its centroid, the largest distance along the surface from it to
    /// another one of the patch (m), and whether the patch is folded. The distance is infinite if the patch is of several pieces.
    fn measure(&mut self, patch: Range<usize>) -> (u32, f32, bool) {
        let members = &self.order[patch];
        if let [only] = members {
            return (*only, 0.0, false);
        }
        let at = |particle: u32| self.rest[particle as usize].as_dvec3();
        let sum: DVec3 = members.iter().map(|&particle| at(particle)).sum();
        let centroid = sum / members.len() as f64;
        let distance = |&particle: &u32| at(particle).distance_squared(centroid);
        let nearest = |a: &u32, b: &u32| distance(a).total_cmp(&distance(b));
        let middle = members.iter().copied().min_by(nearest);
        let middle = middle.expect("no patch is empty");
        if self.is_in_pieces(members) {
            return (middle, f32::INFINITY, false);
        }
        let square = |&of: &u32| at(of).distance_squared(at(middle));
        let straight = members.iter().map(square).fold(0.0, f64::max).sqrt();
        let rest_radius = self.paths.farthest(middle, members);
        let is_folded = f64::from(rest_radius) > FOLDED * straight;
        (middle, rest_radius, is_folded)
    }

    /// Halves a patch, and each half.
    fn split(&mut self, patch: Range<usize>, is_folded: bool, parts: &mut Vec<Range<usize>>) {
        for half in self.bisect(patch, is_folded) {
            parts.extend(self.bisect(half, is_folded));
        }
    }

    fn is_in_pieces(&self, members: &[u32]) -> bool {
        let piece = |particle: u32| self.pieces.get(particle as usize);
        !self.pieces.is_empty() && members.iter().any(|&of| piece(of) != piece(members[0]))
    }

    /// The bounding box of a patch.
    fn corners(&self, patch: Range<usize>) -> [Vec3; 2] {
        let members = self.order[patch].iter();
        let places = members.map(|&particle| self.rest[particle as usize]);
        let low = places.clone().fold(Vec3::MAX, Vec3::min);
        [low, places.fold(Vec3::MIN, Vec3::max)]
    }

    /// Halves a patch. A patch in pieces is halved between them, as far as halves of equal size allow. A patch that is not folded
    /// is halved along its longest extent. A folded one is halved by the nearer of two ends along the surface, so that few halves
    /// have two sides of a fold. As halves are of equal size, one may keep a few particles of the other side.
    fn bisect(
        &mut self,
        patch: Range<usize>,
        is_folded: bool,
    ) -> impl Iterator<Item = Range<usize>> + use<> {
        let half = patch.len().div_ceil(2);
        if half < patch.len() {
            if is_folded {
                self.sort_by_ends(patch.clone());
            } else {
                let [low, high] = self.corners(patch.clone());
                let axis = (high - low).max_position();
                for &particle in &self.order[patch.clone()] {
                    self.keys[particle as usize] = self.rest[particle as usize][axis];
                }
            }
            let (keys, pieces) = (&self.keys, &self.pieces);
            let piece = |of: u32| pieces.get(of as usize);
            // Ties by index, so that the tree is the same on all machines.
            self.order[patch.clone()].select_nth_unstable_by(half, |a, b| {
                let by_key = keys[*a as usize].total_cmp(&keys[*b as usize]);
                piece(*a).cmp(&piece(*b)).then(by_key).then(a.cmp(b))
            });
        }
        let middle = patch.start + half;
        let parts = [patch.start..middle, middle..patch.end];
        parts.into_iter().filter(|part| !part.is_empty())
    }

    /// Computes keys for the nearer of two ends of a patch.
    fn sort_by_ends(&mut self, patch: Range<usize>) {
        let members = &self.order[patch];
        let (paths, distances) = (&mut self.paths, &mut self.distances);
        let one = paths.distances(members[0], members, distances);
        let other = paths.distances(one, members, distances);
        for (&particle, &distance) in members.iter().zip(&*distances) {
            self.keys[particle as usize] = distance as f32;
        }
        paths.distances(other, members, distances);
        for (&particle, &distance) in members.iter().zip(&*distances) {
            self.keys[particle as usize] -= distance as f32;
        }
    }
}
