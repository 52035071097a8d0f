//! One sub-step over springs that lie anywhere, as those of a mesh.
//!
//! A list without chains is swept once, colour by colour. A list with chains is solved forward and back. Forward:
//! chain after chain, then the springs on no chain one by one. Back: these springs from last to first, then the
//! chains from last to first. The remaining errors of the springs after such a pass are symmetric: no part of them
//! oscillates or changes its sign (the symmetric Gauss-Seidel iteration; Saad 2003, section 4.1). A motion of second
//! order, which continues from these errors, needs that. Forward and back, it gained no energy in any mesh tried; in
//! one direction alone, it gained ten times the initial energy.

use std::sync::Arc;

use bevy::math::Vec4;

use super::{
    chains::Bundles,
    kernels::{Kernels, Packet, Row, SPRINGS, StepScale, Stiffer, four, turned},
    spring_solver::{Motion, SolvedSubstep, SpringSolver},
    stretch::Stretch,
};
use crate::cloth::{
    Block, DX, DY, DZ, LANES, Layout, MapInline, Slot, Spring, SpringKind, SpringList, W, X, Y, Z,
};

/// Half of the lanes: as many numbers as a vector has.
const HALF: usize = LANES / 2;

/// A list of springs as the sub-steps want them.
#[derive(Debug, Default, Clone)]
pub(super) struct ListSolver {
    springs: Arc<SpringList>,
    /// Those on no chain.
    packets: Arc<[Packet]>,
    /// How many of them are across edges: the first.
    across: usize,
    /// Their pulls over their lengths (kg).
    pulls: Vec<Vec4>,
    chains: Bundles,
    layout: Layout,
    step_scale: StepScale,
    stiffer: Stiffer,
    /// The particles of one sub-step, strip by strip: in the order of their indices, with what is no particle at the end of
    /// each row of the layout.
    rows: Vec<Row>,
}

impl ListSolver {
    /// For particles that lie as `layout` says.
    pub fn new(springs: &Arc<SpringList>, layout: Layout) -> Self {
        let row_of = |end: u32| {
            let width = layout.strip * LANES as u32;
            end / layout.columns * width + end % layout.columns
        };
        // What is no spring moves the row behind all others.
        let none = (layout.blocks() * LANES) as u32;
        let packet = |springs: &[usize], list: &[Spring]| {
            let of = |at: usize| springs.get(at).map(|&spring| &list[spring]);
            let end =
                |at: usize, which: usize| of(at).map_or(none, |spring| row_of(spring.ends[which]));
            let numbers = |number: &dyn Fn(&Spring) -> f32, without: f32| {
                Vec4::from_array(std::array::from_fn(|at| of(at).map_or(without, number)))
            };
            Packet {
                from: std::array::from_fn(|at| end(at, 0)),
                to: std::array::from_fn(|at| end(at, 1)),
                rest_square: numbers(&|spring| spring.rest_length * spring.rest_length, 1.0),
                compliance: numbers(&|spring| spring.compliance, 0.0),
            }
        };
        let mut is_solved = vec![false; springs.springs.len()];
        for edge in springs.chains.iter().flat_map(|chain| &chain.edges) {
            is_solved[*edge as usize] = true;
        }
        let (mut packets, mut across) = (Vec::new(), 0);
        for colour in &springs.colours {
            let swept: Vec<usize> = colour.clone().filter(|at| !is_solved[*at]).collect();
            let each = swept.chunks(SPRINGS);
            packets.extend(each.map(|swept| packet(swept, &springs.springs)));
            if springs.springs[colour.start].kind != SpringKind::Structural {
                across = packets.len();
            }
        }
        Self {
            springs: springs.clone(),
            across,
            pulls: vec![Vec4::ZERO; packets.len()],
            packets: packets.into(),
            chains: Bundles::new(springs, row_of, none),
            layout,
            step_scale: StepScale::default(),
            stiffer: (springs.stiffening.as_ref()).map_or(Stiffer::NONE, Stiffer::of),
            rows: vec![Row::default(); layout.blocks() * LANES + 1],
        }
    }

    /// Takes the particles at these places.
    pub fn load_from(&mut self, slots: &[Slot], blocks: &[Block]) {
        for (row, slot) in self.rows.iter_mut().zip(slots) {
            let block = &blocks[slot.block];
            row.place = block
                .position(slot.lane)
                .extend(block.inverse_mass(slot.lane));
            row.moved = block.displacement(slot.lane).extend(0.0);
        }
    }

    /// Moves the particles at these places.
    pub fn store_to(&self, slots: &[Slot], blocks: &mut [Block]) {
        for (row, slot) in self.rows.iter().zip(slots) {
            blocks[slot.block].set_displacement(slot.lane, row.moved.truncate());
        }
    }

    fn load(&mut self, blocks: &[Block]) {
        // Of no particles, one that holds none.
        let strip = self.layout.strip.max(1) as usize;
        let of_rows = self.rows.chunks_exact_mut(strip * LANES);
        for (rows, blocks) in of_rows.zip(blocks.chunks_exact(strip)) {
            let mut each = rows.chunks_exact_mut(strip);
            let strips: [&mut [Row]; LANES] =
                std::array::from_fn(|_| each.next().unwrap_or_default());
            for (at, block) in blocks.iter().enumerate() {
                let view = block.view();
                for half in [0, HALF] {
                    let of = |from: usize| Vec4::from_slice(&view[from + half..][..HALF]);
                    let places = turned([of(X), of(Y), of(Z), of(W)]);
                    let moved = turned([of(DX), of(DY), of(DZ), Vec4::ZERO]);
                    for lane in 0..HALF {
                        strips[half + lane][at] = Row {
                            place: places[lane],
                            moved: moved[lane],
                        };
                    }
                }
            }
        }
    }

    fn store(&self, blocks: &mut [Block]) {
        // Of no particles, one that holds none.
        let strip = self.layout.strip.max(1) as usize;
        let of_rows = self.rows.chunks_exact(strip * LANES);
        for (rows, blocks) in of_rows.zip(blocks.chunks_exact_mut(strip)) {
            let mut strips = rows.chunks_exact(strip);
            let strips: [&[Row]; LANES] =
                std::array::from_fn(|_| strips.next().unwrap_or_default());
            for (at, block) in blocks.iter_mut().enumerate() {
                let view = block.view_mut();
                for half in [0, HALF] {
                    let moved = four(|lane| strips[half + lane][at].moved);
                    for (from, numbers) in [DX, DY, DZ].into_iter().zip(turned(moved)) {
                        view[from + half..][..HALF].copy_from_slice(&numbers.to_array());
                    }
                }
            }
        }
    }

    /// The stretch of the material at the tensions of the last sub-step, and the angular frequency of the fastest ripples at the
    /// median particle (rad/s): `ω² = 3/2 w Σ F/l`, as of a lattice of even triangles. Of springs along edges that give.
    ///
    /// The rows are stored by then, and serve as memory: the sums lie beside their displacements.
    pub fn tensions(&mut self) -> [f32; 2] {
        let rows = &mut self.rows;
        let mut material = 0.0_f32;
        let scale = self.step_scale.inverse_weight;
        let stiffer = self.stiffer;
        // The tension over the length (N/m), and the elongation as a part of the length.
        let mut add = |ends: [u32; 2], tension: f32, part: f32| {
            material = material.max(stiffer.strain(part));
            for end in ends {
                rows[end as usize].moved.w += tension;
            }
        };
        self.chains.for_each_pull(|ends, rest, compliance, pull| {
            if compliance > 0.0 {
                let tension = scale * pull / rest;
                add(ends, tension, compliance * tension);
            }
        });
        let packets = self.packets.iter().zip(&self.pulls).skip(self.across);
        for (packet, pull) in packets {
            let (compliance, pull) = (packet.compliance.to_array(), pull.to_array());
            for at in 0..SPRINGS {
                if compliance[at] > 0.0 {
                    let (ends, tension) = ([packet.from[at], packet.to[at]], scale * pull[at]);
                    add(ends, tension, compliance[at] * tension);
                }
            }
        }
        // The last row is no particle's.
        let rows = rows.split_last_mut().map_or(&mut [][..], |(_, rows)| rows);
        let (mut below, mut above) = (0, 0);
        for row in &mut *rows {
            row.moved.w *= 1.5 * row.place.w;
            below += usize::from(row.moved.w < 0.0);
            above += usize::from(row.moved.w > 0.0);
        }
        // Of pinned particles, and of what is no particle, it is 0: they are not counted.
        let middle = (below + above) / 2;
        if middle < below || above == 0 {
            return [material, 0.0];
        }
        let from_above = below + above - middle;
        let at = rows.len() - from_above;
        let of = |row: &Row| row.moved.w;
        let (_, median, _) = rows.select_nth_unstable_by(at, |a, b| of(a).total_cmp(&of(b)));
        [material, of(median).sqrt()]
    }

    /// Solves all springs forward.
    pub fn solve_there(&mut self, kernels: &Kernels) {
        let (rows, step_scale) = (&mut self.rows, &self.step_scale);
        self.chains.solve_there(rows, step_scale, kernels);
        (kernels.relax_packets_there)(rows, &self.packets, &mut self.pulls, step_scale);
    }

    /// The same backward, after [`solve_there`](Self::solve_there).
    pub fn solve_back(&mut self, kernels: &Kernels) {
        let (rows, step_scale) = (&mut self.rows, &self.step_scale);
        (kernels.relax_packets_back)(rows, &self.packets, &mut self.pulls, step_scale);
        self.chains.solve_back(rows, step_scale, kernels);
    }

    /// The largest length over rest length, given where a particle is.
    pub fn stretch(&self, square_between: impl Fn(&Spring) -> f32) -> Stretch {
        let (mut structural, mut bound) = (1.0_f32, 1.0_f32);
        for spring in &self.springs.springs {
            let ratio = || square_between(spring) / (spring.rest_length * spring.rest_length);
            match spring.kind {
                SpringKind::Structural => structural = structural.max(ratio()),
                SpringKind::Shear => bound = bound.max(ratio()),
                SpringKind::Bend => {}
            }
        }
        Stretch::of_ratios(structural.sqrt(), bound.max(structural).sqrt())
    }
}

impl SpringSolver for ListSolver {
    fn set_step_scale(&mut self, step_scale: StepScale) {
        self.step_scale = StepScale {
            stiffer: self.stiffer,
            ..step_scale
        };
    }

    fn is_exact(&self) -> bool {
        !self.chains.is_empty()
    }

    fn partitions(&self, _: usize) -> usize {
        1
    }

    fn substep(&mut self, blocks: &mut [Block], motion: &Motion, _: usize) -> SolvedSubstep {
        let kernels = motion.kernels;
        self.load(blocks);
        self.solve_there(kernels);
        if !self.chains.is_empty() {
            self.solve_back(kernels);
        }
        self.store(blocks);
        motion.tethers.pull(motion.anchors, blocks, 0, kernels);
        let mut moved = [0.0; LANES];
        (kernels.commit)(blocks, &mut moved);
        let [material, ripple] = if motion.measures && !self.chains.is_empty() {
            self.tensions()
        } else {
            [0.0; 2]
        };
        let stretch = motion.measures.then(|| Stretch {
            material,
            ..self.measure(blocks, kernels)
        });
        SolvedSubstep {
            moved,
            stretch,
            ripple,
        }
    }

    fn measure(&self, blocks: &[Block], _: &Kernels) -> Stretch {
        let place = |end: u32| {
            let slot = self.layout.slot_of(end as usize);
            blocks[slot.block].position(slot.lane)
        };
        self.stretch(|spring| place(spring.ends[0]).distance_squared(place(spring.ends[1])))
    }

    fn for_each_tension(&self, visit: &mut dyn FnMut([u32; 2], f32)) {
        let scale = self.step_scale.inverse_weight;
        let Layout { columns, strip, .. } = self.layout;
        let width = strip * LANES as u32;
        let particle_of = |row: u32| row / width * columns + row % width;
        self.chains.for_each_pull(|ends, _, _, pull| {
            visit(ends.map_inline(particle_of), scale * pull);
        });
        for (packet, pull) in self.packets.iter().zip(&self.pulls) {
            let [squares, pulls] = [packet.rest_square, *pull].map_inline(|of| of.to_array());
            for at in 0..SPRINGS {
                // The last packet of a colour is not full.
                let ends = [packet.from[at], packet.to[at]];
                if (ends[0] as usize) + 1 < self.rows.len() {
                    let tension = scale * pulls[at] * squares[at].sqrt();
                    visit(ends.map_inline(particle_of), tension);
                }
            }
        }
    }

    fn boxed(&self) -> Box<dyn SpringSolver> {
        Box::new(self.clone())
    }
}
