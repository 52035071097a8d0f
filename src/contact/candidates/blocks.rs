//! The particles and triangles that each collider may touch in a tick, in blocks of eight.

use std::{ops::Range, sync::Arc};

use crate::{
    cloth::{Fan, Fans, LANES, Lanes, Layout, MapInline, Slot, Surface},
    contact::friction::FrictionBudget,
};

/// A particle that a collider may touch in the tick, with the triangles that it owns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Candidate {
    pub particle: u32,
    /// Its lane, counted through the [`ContactBlock`]s.
    pub place: u32,
    /// Whether the triangles that it owns are tested.
    pub has_faces: bool,
}

impl Candidate {
    /// Its contact block and lane.
    pub fn lane(&self) -> (usize, usize) {
        (self.place as usize / LANES, self.place as usize % LANES)
    }

    /// The triangles that are tested for it.
    pub fn fan<'a>(&self, fans: &'a Fans) -> Fan<'a> {
        match self.has_faces {
            true => fans.of(self.particle),
            false => Fan::default(),
        }
    }
}

/// No contact block.
const NONE: u32 = u32::MAX;

/// Eight particles, some of which a collider may touch in the tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ContactBlock {
    /// Which of the cloth's blocks.
    pub block: u32,
    /// Bit mask of the lanes that are candidates.
    pub lanes: u8,
    /// Blocks of the same collider with the other corners of a grid's cells: to the right, below, and below to the
    /// right.
    pub around: [u32; 3],
    /// Bit mask of the lanes that are pushed as particles; the others may be pushed by triangles.
    pub points: u8,
    /// Bit mask of the lanes that are tested one by one in this sub-step.
    pub left: u8,
    /// Until everything has moved this far, none of its particles can touch (m).
    pub clear_until: f32,
    /// Until everything has moved this far, no triangle that one of them owns can touch (m).
    pub faces_clear_until: f32,
    /// Whether that was used up as the sub-step began.
    pub are_faces_due: bool,
    /// Largest displacement of its particles since the search (m), where that is measured; else 0.
    pub moved: f32,
    /// Each particle's share of the cloth's area (m²).
    pub area: Lanes,
    /// Each particle's factor of μ.
    pub grip: Lanes,
    /// Largest depth of each (m); negative for the smallest distance.
    pub depth: Lanes,
}

impl ContactBlock {
    pub fn new(block: u32) -> Self {
        Self {
            block,
            lanes: 0,
            around: [NONE; 3],
            points: u8::MAX,
            left: 0,
            clear_until: f32::NEG_INFINITY,
            faces_clear_until: f32::NEG_INFINITY,
            are_faces_due: false,
            moved: 0.0,
            area: [0.0; LANES],
            grip: [1.0; LANES],
            depth: [f32::NEG_INFINITY; LANES],
        }
    }

    /// Whether the cells that its particles own are known.
    pub fn has_cells(&self) -> bool {
        self.around[2] != NONE
    }
}

/// Which triangles of its particles a collider is tested against.
pub(crate) struct TestedFaces<F> {
    /// Whether a triangle is excluded.
    pub is_left_out: F,
    pub pushed: PushedParticles,
}

/// Which particles are pushed beside tested triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PushedParticles {
    All,
    /// Those whose triangles have at most this [width](Surface::face_widths) (m): these triangles are not tested.
    Fine(f32),
    None,
}

/// Everything that colliders may touch in the tick.
#[derive(Debug, Default, Clone)]
pub(crate) struct Candidates {
    pub all: Vec<Candidate>,
    pub blocks: Vec<ContactBlock>,
    /// For each block of the colliders that are tested against triangles.
    pub budgets: Vec<FrictionBudget>,
    /// Factors of μ, by the cloth's blocks; empty if all are 1.
    pub grips: Arc<[Lanes]>,
    /// The last contact block of each of the cloth's blocks.
    marks: Vec<u32>,
    /// A bit for each particle, to sort them.
    found: Vec<u64>,
}

impl Candidates {
    /// Clears everything.
    pub fn clear(&mut self) {
        self.all.clear();
        self.blocks.clear();
        self.budgets.clear();
    }

    /// Begins the tick again.
    pub fn restart(&mut self) {
        for contact in &mut self.blocks {
            contact.depth = [f32::NEG_INFINITY; LANES];
            contact.clear_until = f32::NEG_INFINITY;
            contact.faces_clear_until = f32::NEG_INFINITY;
        }
        self.budgets.fill(FrictionBudget::NONE);
    }

    /// Adds the candidates of a collider, in any order, and the tested triangles that they own, if any. Returns the ranges of the
    /// candidates and their blocks, both in the order of the cloth. So the result does not depend on the search method.
    pub fn add(
        &mut self,
        found: &[u32],
        surface: &Surface,
        layout: Layout,
        faces: Option<&TestedFaces<impl Fn(&[u32; 3]) -> bool>>,
    ) -> Ranges {
        let first = [self.all.len(), self.blocks.len(), self.budgets.len()];
        self.sort(found, surface.len());
        self.marks.resize(layout.blocks(), 0);
        let pushed = faces.map_or(PushedParticles::All, |faces| faces.pushed);
        let is_fine = |particle: u32| match pushed {
            PushedParticles::Fine(widest) => surface.face_widths()[particle as usize] <= widest,
            PushedParticles::All | PushedParticles::None => false,
        };
        for index in first[0]..self.all.len() {
            let particle = self.all[index].particle;
            let Slot { block, lane } = layout.slot_of(particle as usize);
            self.all[index].place = (block * LANES + lane) as u32;
            self.mark(block, first[1]);
            let Some(faces) = faces else {
                continue;
            };
            let mut owned = surface.faces().of(particle).iter();
            // A triangle that is left out takes the particle's others with it.
            if !is_fine(particle) && !owned.any(&faces.is_left_out) {
                let fan = surface.fans().of(particle);
                self.all[index].has_faces = !fan.faces.is_empty();
                for corner in fan.corners {
                    self.mark(corner.block, first[1]);
                }
            }
        }
        self.blocks[first[1]..].sort_unstable_by_key(|contact| contact.block);
        for (index, contact) in self.blocks.iter_mut().enumerate().skip(first[1]) {
            self.marks[contact.block as usize] = index as u32;
            if pushed != PushedParticles::All {
                contact.points = 0;
            }
        }
        for candidate in &mut self.all[first[0]..] {
            let (block, lane) = candidate.lane();
            let index = self.marks[block] as usize;
            candidate.place = (index * LANES + lane) as u32;
            let contact = &mut self.blocks[index];
            contact.lanes |= 1 << lane;
            // Also one whose triangles are left out: those of its neighbours do not push it.
            if matches!(pushed, PushedParticles::Fine(_)) && !candidate.has_faces {
                contact.points |= 1 << lane;
            }
            contact.area[lane] = surface.area_of(candidate.particle as usize);
            if layout.has_cells && candidate.has_faces {
                let (strip, next) = (layout.strip as usize, block + 1);
                let is_last = next.is_multiple_of(strip);
                let beside = if is_last { next - strip } else { next };
                let around = [beside, block + strip, beside + strip];
                contact.around = around.map_inline(|block| self.marks[block] - first[1] as u32);
            }
        }
        if faces.is_some() {
            let count = self.blocks.len() - first[1];
            self.budgets.resize(first[2] + count, FrictionBudget::NONE);
        }
        Ranges {
            candidates: first[0]..self.all.len(),
            blocks: first[1]..self.blocks.len(),
            budgets: first[2]..self.budgets.len(),
            has_points: self.blocks[first[1]..].iter().any(|of| of.points != 0),
        }
    }

    /// Adds particles in the order of the cloth, each once.
    fn sort(&mut self, found: &[u32], particles: usize) {
        self.found.resize(particles.div_ceil(64), 0);
        for &particle in found {
            self.found[particle as usize / 64] |= 1 << (particle % 64);
        }
        for (word, bits) in (0_u32..).zip(&mut self.found) {
            while *bits != 0 {
                self.all.push(Candidate {
                    particle: 64 * word + bits.trailing_zeros(),
                    place: 0,
                    has_faces: false,
                });
                *bits &= *bits - 1;
            }
        }
    }

    /// Makes a block of the cloth one of those from `first` on.
    fn mark(&mut self, block: usize, first: usize) {
        let mark = self.marks[block] as usize;
        let known = self.blocks.get(mark).filter(|_| mark >= first);
        if known.is_none_or(|known| known.block as usize != block) {
            self.marks[block] = self.blocks.len() as u32;
            self.blocks.push(ContactBlock {
                grip: self.grips.get(block).copied().unwrap_or([1.0; LANES]),
                ..ContactBlock::new(block as u32)
            });
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
pub(crate) struct Ranges {
    pub candidates: Range<usize>,
    pub blocks: Range<usize>,
    pub budgets: Range<usize>,
    /// Whether any particles are pushed, beside triangles or alone.
    pub has_points: bool,
}

#[cfg(test)]
mod tests {
    use bevy::math::Vec3;

    use super::*;
    use crate::{cloth::Cloth, contact::tests::Random, meshes};

    /// Particles are found for one collider after the other, in any order and more than once, on a grid and on a mesh. Each is a
    /// candidate once, in the cloth's order, in its lane of its block. The corners of its triangles are in blocks, too, unless one
    /// of the triangles that meet it is left out.
    #[test]
    fn each_particle_is_a_candidate_once() {
        let grid = Cloth::new(19, 11, 0.1).surface(Vec3::ONE).expect("a grid");
        let mesh = meshes::irregular(0.9, 0.7, 0.1, 0.3);
        let mesh = Surface::of_mesh(&mesh, 1.0e-5, Vec3::ONE).expect("a mesh");
        let mut random = Random(3);
        for surface in [grid, mesh] {
            let (layout, count) = (surface.layout(), surface.len());
            let mut candidates = Candidates::default();
            for tick in 0..40 {
                candidates.clear();
                for _ in 0..4 {
                    let most = 2 * random.below(count as u32);
                    let found: Vec<u32> = (0..most).map(|_| random.below(count as u32)).collect();
                    let left_out = random.below(count as u32);
                    let is_left_out = |corners: &[u32; 3]| corners.contains(&left_out);
                    let pushed = [
                        PushedParticles::All,
                        PushedParticles::None,
                        PushedParticles::Fine(0.1),
                        PushedParticles::Fine(10.0),
                    ][tick / 2 % 4];
                    let faces = TestedFaces {
                        is_left_out,
                        pushed,
                    };
                    let by_triangles = (tick % 2 == 0).then_some(&faces);
                    let ranges = candidates.add(&found, &surface, layout, by_triangles);
                    let all = &candidates.all[ranges.candidates.clone()];
                    let mut expected = found.clone();
                    expected.sort_unstable();
                    expected.dedup();
                    assert!(all.iter().map(|of| of.particle).eq(expected));
                    let blocks = &candidates.blocks[ranges.blocks.clone()];
                    assert!(blocks.is_sorted_by(|a, b| a.block < b.block));
                    let has_block =
                        |block: usize| blocks.iter().any(|of| of.block as usize == block);
                    for candidate in all {
                        let (block, lane) = candidate.lane();
                        let (contact, slot) = (
                            &candidates.blocks[block],
                            layout.slot_of(candidate.particle as usize),
                        );
                        assert!(ranges.blocks.contains(&block));
                        assert_eq!((contact.block as usize, lane), (slot.block, slot.lane));
                        let meets = surface.faces().of(candidate.particle);
                        let own = surface.fans().of(candidate.particle);
                        let is_whole = by_triangles.is_some() && !meets.iter().any(is_left_out);
                        let width = surface.face_widths()[candidate.particle as usize];
                        let is_fine =
                            matches!(pushed, PushedParticles::Fine(widest) if width <= widest);
                        let is_whole = is_whole && !is_fine;
                        let is_point = contact.points & (1 << lane) != 0;
                        let is_pushed = match (by_triangles, pushed) {
                            (None, _) | (_, PushedParticles::All) => true,
                            (_, PushedParticles::None) => false,
                            (_, PushedParticles::Fine(_)) => own.faces.is_empty() || !is_whole,
                        };
                        assert_eq!(is_point, is_pushed, "a point, or by its triangles");
                        let fan = candidate.fan(surface.fans());
                        assert_eq!(fan.faces, if is_whole { own.faces } else { &[] });
                        assert!(fan.corners.iter().all(|corner| has_block(corner.block)));
                    }
                    let lanes: u32 = blocks.iter().map(|of| of.lanes.count_ones()).sum();
                    assert_eq!(lanes as usize, all.len());
                }
            }
        }
    }
}
