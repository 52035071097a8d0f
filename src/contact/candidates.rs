//! Which particles and triangles each collider may touch in a tick, and in which blocks of eight they are.

use std::ops::Range;

use super::held::Held;
use crate::cloth::{LANES, Lanes, Layout, Slot, Surface};

/// A particle that a collider may touch in the tick; with triangles, one that stands for some.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    pub particle: u32,
    /// Its lane, counted through the [`ContactBlock`]s.
    pub place: u32,
    /// From where to where the corners and the faces that it stands for are among the [`Fans`]; none without triangles.
    pub corners: [u32; 2],
    pub faces: [u32; 2],
}

impl Candidate {
    /// Which contact block it is in, and which lane of it.
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
    /// Which lanes are candidates, a bit each.
    pub lanes: u8,
    /// Those of the same collider in which a grid's cells have their other corners: to the right, below, and below to the right.
    pub around: [u32; 3],
    /// Whether it has to be looked at lane by lane in this sub-step.
    pub is_left: bool,
    /// No lane can touch before everything has moved so far (m).
    pub clear_until: f32,
    /// The part of the cloth's area that each stands for (m²).
    pub area: Lanes,
    /// The deepest that each has been found (m); negative if it has only come so near.
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

    /// Whether the cells are known of which its particles are the first.
    pub fn has_cells(&self) -> bool {
        self.around[2] != NONE
    }

    /// Whether a lane is a candidate.
    pub fn has(&self, lane: usize) -> bool {
        self.lanes & (1 << lane) != 0
    }
}

/// The faces that candidates stand for.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Fans {
    /// All corners of each candidate's faces, each once; the candidate itself first.
    corners: Vec<Slot>,
    faces: Vec<[Slot; 3]>,
    /// How many triangles a particle may be a corner of, and be pushed by.
    pub max_faces: f32,
}

impl Fans {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.corners.clear();
        self.faces.clear();
    }

    /// Adds the faces that a particle stands for, or none if one of them is left out. Returns from where to where their corners and
    /// they are.
    pub fn add(
        &mut self,
        surface: &Surface,
        layout: Layout,
        particle: u32,
        is_left_out: impl Fn(&[u32; 3]) -> bool,
    ) -> [[u32; 2]; 2] {
        let (first_corner, first_face) = (self.corners.len(), self.faces.len());
        let mut faces = surface.faces().of(particle);
        // All or none: what is remembered of a particle's faces counts on the same ones.
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

/// What all colliders may touch in the tick.
#[derive(Debug, Default, Clone)]
pub(super) struct Candidates {
    pub all: Vec<Candidate>,
    pub blocks: Vec<ContactBlock>,
    pub fans: Fans,
    /// For each block of those colliders that are tested against triangles.
    pub helds: Vec<Held>,
    /// Of each of the cloth's blocks, which contact block it was last.
    marks: Vec<u32>,
}

impl Candidates {
    /// Forgets all.
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

    /// Adds those of a collider, whatever their order; with the triangles that they stand for, if `is_left_out`
    /// is given, which says of each whether it is not to be tested. Returns where they and their blocks are, each in the order of the cloth: so the
    /// result is the same whichever search has found them.
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

    /// Has a block of the cloth be among those from `first` on.
    fn mark(&mut self, block: usize, first: usize) {
        let mark = self.marks[block] as usize;
        let known = self.blocks.get(mark).filter(|_| mark >= first);
        if known.is_none_or(|known| known.block as usize != block) {
            self.marks[block] = self.blocks.len() as u32;
            self.blocks.push(ContactBlock::new(block as u32));
        }
    }

    /// The deepest that a candidate has been found (m).
    pub fn depth_of(&self, candidate: &Candidate) -> f32 {
        let (block, lane) = candidate.lane();
        self.blocks[block].depth[lane]
    }
}

/// Where the candidates of a collider are, their blocks, and what these hold.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Ranges {
    pub candidates: Range<usize>,
    pub blocks: Range<usize>,
    pub helds: Range<usize>,
}
