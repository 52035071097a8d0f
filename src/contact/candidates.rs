//! The particles and triangles that each collider may touch in a tick, in blocks of eight.

use std::ops::Range;

use super::held::Held;
use crate::cloth::{LANES, Lanes, Layout, Slot, Surface};

/// A particle that a collider may touch in the tick, with the triangles that it owns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    pub particle: u32,
    /// Its lane, counted through the [`ContactBlock`]s.
    pub place: u32,
    /// Range of the corners and faces that it owns in the [`Fans`]; empty without triangles.
    pub corners: [u32; 2],
    pub faces: [u32; 2],
}

impl Candidate {
    /// Its contact block and lane.
    pub fn lane(&self) -> (usize, usize) {
        (self.place as usize / LANES, self.place as usize % LANES)
    }
}

/// No contact block.
const NONE: u32 = u32::MAX;

/// Eight particles, some of which a collider may touch in the tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ContactBlock {
    /// Which of the cloth's blocks.
    pub block: u32,
    /// Bit mask of the lanes that are candidates.
    pub lanes: u8,
    /// Blocks of the same collider with the other corners of a grid's cells: to the right, below, and below to the
    /// right.
    pub around: [u32; 3],
    /// Whether it is tested lane by lane in this sub-step.
    pub is_left: bool,
    /// Until everything has moved this far, no lane can touch (m).
    pub clear_until: f32,
    /// Each particle's share of the cloth's area (m²).
    pub area: Lanes,
    /// Largest depth of each (m); negative for the smallest distance.
    pub depth: Lanes,
}

impl ContactBlock {
    pub fn new(block: u32) -> Self {
        Self {
            block,
            lanes: 0,
            around: [NONE; 3],
            is_left: false,
            clear_until: f32::NEG_INFINITY,
            area: [0.0; LANES],
            depth: [f32::NEG_INFINITY; LANES],
        }
    }

    /// Whether the cells that its particles own are known.
    pub fn has_cells(&self) -> bool {
        self.around[2] != NONE
    }
}

/// The faces that candidates own.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Fans {
    /// All corners of each candidate's faces, without repetition; the candidate itself first.
    corners: Vec<Slot>,
    faces: Vec<[Slot; 3]>,
    /// Largest number of triangles at a particle, each of which may push it.
    pub max_faces: f32,
}

impl Fans {
    /// Clears everything.
    pub fn clear(&mut self) {
        self.corners.clear();
        self.faces.clear();
    }

    /// Adds the faces that a particle owns, or none if one of them is left out. Returns the ranges of their corners and
    /// faces.
    pub fn add(
        &mut self,
        surface: &Surface,
        layout: Layout,
        particle: u32,
        is_left_out: impl Fn(&[u32; 3]) -> bool,
    ) -> [[u32; 2]; 2] {
        let (first_corner, first_face) = (self.corners.len(), self.faces.len());
        let mut faces = surface.faces().of(particle);
        // All or none: the memory of a particle's faces relies on the same set.
        if faces.iter().any(is_left_out) {
            faces = &[];
        }
        if !faces.is_empty() {
            self.corners.push(layout.slot_of(particle as usize));
        }
        for face in faces {
            let slots = face.map(|corner| layout.slot_of(corner as usize));
            for slot in slots {
                if !self.corners[first_corner..].contains(&slot) {
                    self.corners.push(slot);
                }
            }
            self.faces.push(slots);
        }
        [
            [first_corner as u32, self.corners.len() as u32],
            [first_face as u32, self.faces.len() as u32],
        ]
    }

    pub fn corners(&self, [first, end]: [u32; 2]) -> &[Slot] {
        &self.corners[first as usize..end as usize]
    }

    pub fn faces(&self, [first, end]: [u32; 2]) -> &[[Slot; 3]] {
        &self.faces[first as usize..end as usize]
    }
}

/// Everything that colliders may touch in the tick.
#[derive(Debug, Default, Clone)]
pub(super) struct Candidates {
    pub all: Vec<Candidate>,
    pub blocks: Vec<ContactBlock>,
    pub fans: Fans,
    /// For each block of the colliders that are tested against triangles.
    pub helds: Vec<Held>,
    /// The last contact block of each of the cloth's blocks.
    marks: Vec<u32>,
}

impl Candidates {
    /// Clears everything.
    pub fn clear(&mut self) {
        self.all.clear();
        self.blocks.clear();
        self.fans.clear();
        self.helds.clear();
    }

    /// Begins the tick again.
    pub fn restart(&mut self) {
        for contact in &mut self.blocks {
            contact.depth = [f32::NEG_INFINITY; LANES];
            contact.clear_until = f32::NEG_INFINITY;
        }
        self.helds.fill(Held::NONE);
    }

    /// Adds the candidates of a collider, in any order. With `is_left_out`, adds the triangles that they own, too; it
    /// returns whether a triangle is excluded. Returns the ranges of the candidates and their blocks, both in the order
    /// of the cloth. So the result does not depend on the search method.
    pub fn add(
        &mut self,
        found: &[u32],
        surface: &Surface,
        layout: Layout,
        is_left_out: Option<&impl Fn(&[u32; 3]) -> bool>,
    ) -> Ranges {
        let first = [self.all.len(), self.blocks.len(), self.helds.len()];
        self.all.extend(found.iter().map(|&particle| Candidate {
            particle,
            place: 0,
            corners: [0; 2],
            faces: [0; 2],
        }));
        self.all[first[0]..].sort_unstable_by_key(|candidate| candidate.particle);
        self.marks.resize(layout.blocks(), 0);
        for index in first[0]..self.all.len() {
            let candidate = &mut self.all[index];
            let Slot { block, lane } = layout.slot_of(candidate.particle as usize);
            candidate.place = (block * LANES + lane) as u32;
            self.mark(block, first[1]);
            if let Some(is_left_out) = is_left_out {
                let particle = self.all[index].particle;
                let [corners, faces] = self.fans.add(surface, layout, particle, is_left_out);
                (self.all[index].corners, self.all[index].faces) = (corners, faces);
                for corner in corners[0]..corners[1] {
                    let corner = self.fans.corners([corner, corner + 1])[0];
                    self.mark(corner.block, first[1]);
                }
            }
        }
        self.blocks[first[1]..].sort_unstable_by_key(|contact| contact.block);
        for (index, contact) in self.blocks.iter().enumerate().skip(first[1]) {
            self.marks[contact.block as usize] = index as u32;
        }
        for candidate in &mut self.all[first[0]..] {
            let (block, lane) = candidate.lane();
            let index = self.marks[block] as usize;
            candidate.place = (index * LANES + lane) as u32;
            let contact = &mut self.blocks[index];
            contact.lanes |= 1 << lane;
            contact.area[lane] = surface.area_of(candidate.particle as usize);
            if layout.rows > 1 && candidate.faces[0] < candidate.faces[1] {
                let strip = layout.strip as usize;
                let is_last = (block + 1).is_multiple_of(strip);
                let beside = if is_last {
                    block + 1 - strip
                } else {
                    block + 1
                };
                let around = [beside, block + strip, beside + strip];
                contact.around = around.map(|block| self.marks[block] - first[1] as u32);
            }
        }
        if is_left_out.is_some() {
            let count = self.blocks.len() - first[1];
            self.helds.resize(first[2] + count, Held::NONE);
        }
        Ranges {
            candidates: first[0]..self.all.len(),
            blocks: first[1]..self.blocks.len(),
            helds: first[2]..self.helds.len(),
        }
    }

    /// Makes a block of the cloth one of those from `first` on.
    fn mark(&mut self, block: usize, first: usize) {
        let mark = self.marks[block] as usize;
        let known = self.blocks.get(mark).filter(|_| mark >= first);
        if known.is_none_or(|known| known.block as usize != block) {
            self.marks[block] = self.blocks.len() as u32;
            self.blocks.push(ContactBlock::new(block as u32));
        }
    }

    /// The largest depth of a candidate (m).
    pub fn depth_of(&self, candidate: &Candidate) -> f32 {
        let (block, lane) = candidate.lane();
        self.blocks[block].depth[lane]
    }
}

/// Ranges of a collider's candidates, their blocks, and their contents.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Ranges {
    pub candidates: Range<usize>,
    pub blocks: Range<usize>,
    pub helds: Range<usize>,
}
