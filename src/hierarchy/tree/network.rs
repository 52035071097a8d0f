//! The tree of particles on no grid: patches parted in rest space, each node stored.

use std::{cmp::Reverse, collections::BinaryHeap, ops::Range};

use bevy::math::{DVec3, Vec3};

use super::Node;
use crate::cloth::{ClothError, Layout, Slot, Spring, SpringKind};

/// A tree over particles joined by any springs.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct NetworkTree {
    /// Of the particles: one row.
    pub layout: Layout,
    pub nodes: Vec<NetworkNode>,
    pub ranges: Vec<Range<u32>>,
    /// Where each particle lies.
    pub slots: Vec<Slot>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct NetworkNode {
    pub middle: u32,
    pub rest_radius: f32,
    pub children: Range<u32>,
}

impl NetworkTree {
    pub fn new(rest: &[Vec3], springs: &[Spring]) -> Result<Self, ClothError> {
        if let Some(index) = rest.iter().position(|position| !position.is_finite()) {
            return Err(ClothError::ParticleNotFinite {
                index,
                position: rest[index],
                displacement: Vec3::ZERO,
                inverse_mass: 0.0,
            });
        }
        let mut ways = Ways::new(rest.len(), springs)?;
        let layout = Layout::new(rest.len() as u32, 1);
        let mut tree = Self {
            layout,
            nodes: Vec::new(),
            ranges: Vec::new(),
            slots: layout.slots().collect(),
        };
        let mut order: Vec<u32> = (0..rest.len() as u32).collect();
        let mut patches: Vec<Range<usize>> =
            Vec::from_iter((!rest.is_empty()).then_some(0..rest.len()));
        while !patches.is_empty() {
            let first = tree.nodes.len() as u32;
            let below = first + patches.len() as u32;
            let is_last = patches.iter().all(|patch| patch.len() == 1);
            let mut parts = Vec::new();
            for patch in patches {
                let middle = middle(&order[patch.clone()], rest);
                let rest_radius = ways.farthest(middle, &order[patch.clone()]);
                let child = below + parts.len() as u32;
                if !is_last {
                    part(&mut order, patch, rest, &mut parts);
                }
                let end = if is_last {
                    child
                } else {
                    below + parts.len() as u32
                };
                tree.nodes.push(NetworkNode {
                    middle,
                    rest_radius,
                    children: child..end,
                });
            }
            tree.ranges.push(first..below);
            patches = parts;
        }
        Ok(tree)
    }

    pub fn node(&self, level: usize, node: u32) -> Node {
        let NetworkNode {
            middle,
            rest_radius,
            ref children,
        } = self.nodes[node as usize];
        let mut ids = [0; 4];
        for (id, child) in ids.iter_mut().zip(children.clone()) {
            *id = child;
        }
        Node {
            level,
            middle,
            rest_radius,
            children: ids,
            child_count: children.len() as u8,
        }
    }
}

/// The particle nearest to the centroid of its patch at rest.
fn middle(patch: &[u32], rest: &[Vec3]) -> u32 {
    let at = |particle: u32| rest[particle as usize].as_dvec3();
    let centroid = patch.iter().map(|&particle| at(particle)).sum::<DVec3>() / patch.len() as f64;
    let distance = |&particle: &u32| at(particle).distance_squared(centroid);
    let nearest = |a: &u32, b: &u32| distance(a).total_cmp(&distance(b));
    patch
        .iter()
        .copied()
        .min_by(nearest)
        .expect("no patch is empty")
}

/// Halves a patch along its longest extent, and each half along its own.
fn part(order: &mut [u32], patch: Range<usize>, rest: &[Vec3], parts: &mut Vec<Range<usize>>) {
    for half in halves(order, patch, rest) {
        parts.extend(halves(order, half, rest));
    }
}

fn halves(
    order: &mut [u32],
    patch: Range<usize>,
    rest: &[Vec3],
) -> impl Iterator<Item = Range<usize>> + use<> {
    let half = patch.len().div_ceil(2);
    let members = &mut order[patch.clone()];
    if half < members.len() {
        let at = |particle: &u32| rest[*particle as usize];
        let low = members.iter().map(at).fold(Vec3::MAX, Vec3::min);
        let high = members.iter().map(at).fold(Vec3::MIN, Vec3::max);
        let axis = (high - low).max_position();
        // Ties by index, so that the tree is the same everywhere.
        members.select_nth_unstable_by(half, |a, b| {
            at(a)[axis].total_cmp(&at(b)[axis]).then(a.cmp(b))
        });
    }
    let parts = [
        patch.start..patch.start + half,
        patch.start + half..patch.end,
    ];
    parts.into_iter().filter(|part| !part.is_empty())
}

/// Shortest ways along the springs at rest.
struct Ways {
    /// Of each particle, where its neighbours begin.
    first: Vec<usize>,
    neighbours: Vec<(u32, f32)>,
    /// Of each particle, in which search it was reached, and how far away (m).
    reached: Vec<(u32, f64)>,
    /// Of each particle, the search in which it was wanted.
    wanted: Vec<u32>,
    search: u32,
    heap: BinaryHeap<Reverse<(u64, u32)>>,
}

impl Ways {
    fn new(particles: usize, springs: &[Spring]) -> Result<Self, ClothError> {
        let is_sound = |spring: &Spring| {
            spring.ends.iter().all(|&end| (end as usize) < particles)
                && (1.0e-9..=1.0e12).contains(&spring.rest_length)
        };
        if let Some(index) = springs.iter().position(|spring| !is_sound(spring)) {
            return Err(ClothError::BadSpring {
                index,
                spring: springs[index],
                particles,
            });
        }
        // What a bend spring allows is not measured.
        let ways = || {
            springs
                .iter()
                .filter(|spring| spring.kind != SpringKind::Bend)
        };
        let mut first = vec![0; particles + 1];
        for end in ways().flat_map(|spring| spring.ends) {
            first[end as usize + 1] += 1;
        }
        for particle in 0..particles {
            first[particle + 1] += first[particle];
        }
        let mut next = first.clone();
        let mut neighbours = vec![(0, 0.0); first[particles]];
        for spring in ways() {
            let [a, b] = spring.ends;
            for (from, to) in [(a, b), (b, a)] {
                neighbours[next[from as usize]] = (to, spring.rest_length);
                next[from as usize] += 1;
            }
        }
        Ok(Self {
            first,
            neighbours,
            reached: vec![(0, 0.0); particles],
            wanted: vec![0; particles],
            search: 0,
            heap: BinaryHeap::new(),
        })
    }

    /// The distance from `start` to the farthest of `patch` (m), rounded up; infinite if one is out of reach.
    fn farthest(&mut self, start: u32, patch: &[u32]) -> f32 {
        self.search += 1;
        let search = self.search;
        for &particle in patch {
            self.wanted[particle as usize] = search;
        }
        let mut left = patch.len();
        self.heap.clear();
        self.heap.push(Reverse((0, start)));
        self.reached[start as usize] = (search, 0.0);
        // Bits of floats that are not negative are in the order of the floats.
        while let Some(Reverse((bits, particle))) = self.heap.pop() {
            let distance = f64::from_bits(bits);
            let at = particle as usize;
            if distance > self.reached[at].1 {
                continue;
            }
            if self.wanted[at] == search {
                self.wanted[at] = 0;
                left -= 1;
                if left == 0 {
                    return if distance > 0.0 {
                        (distance as f32).next_up()
                    } else {
                        0.0
                    };
                }
            }
            for &(neighbour, length) in &self.neighbours[self.first[at]..self.first[at + 1]] {
                let further = distance + f64::from(length);
                let known = &mut self.reached[neighbour as usize];
                if known.0 != search || further < known.1 {
                    *known = (search, further);
                    self.heap.push(Reverse((further.to_bits(), neighbour)));
                }
            }
        }
        f32::INFINITY
    }
}
