//! One sub-step over springs that lie anywhere, as those of a mesh.
//!
//! Eight springs of a colour have their sixteen ends in as many places, so that gathering them costs more than solving
//! them. For the sweep each particle is copied to a row of its own, half a cache line: place and inverse mass, and
//! displacement. A spring then is four loads and two stores of four numbers, one division, and no root. Springs of a colour
//! share no particle, so that a core works on several at a time.

use std::sync::Arc;

use bevy::math::Vec4;

use super::{
    Stretch,
    kernel::Kernels,
    run::MIN_SOFTNESS,
    sweep::{Motion, Sweep, Swept},
};
use crate::cloth::{Block, LANES, Layout, Spring, SpringKind, SpringList};

/// A particle during a sweep.
#[derive(Debug, Default, Clone, Copy)]
#[repr(C, align(32))]
struct Row {
    /// Position (m), and inverse mass (1/kg).
    place: Vec4,
    /// Displacement (m), and 0.
    moved: Vec4,
}

/// A list of springs as the sub-steps want them.
#[derive(Debug, Default, Clone)]
pub(super) struct ListSweep {
    springs: Arc<SpringList>,
    layout: Layout,
    /// 1/Δt² (1/s²).
    inverse_dt2: f32,
    /// The particles, in the order of their indices. Of one sub-step.
    rows: Vec<Row>,
}

impl ListSweep {
    /// For particles that lie as `layout` says.
    pub fn new(springs: &Arc<SpringList>, layout: Layout) -> Self {
        Self {
            springs: springs.clone(),
            layout,
            inverse_dt2: 0.0,
            rows: vec![Row::default(); layout.len()],
        }
    }

    fn load(&mut self, blocks: &[Block]) {
        for_each_particle(self.layout, |block, lane, index| {
            let from = &blocks[block];
            self.rows[index] = Row {
                place: from.position(lane).extend(from.inverse_mass(lane)),
                moved: from.displacement(lane).extend(0.0),
            };
        });
    }

    fn store(&self, blocks: &mut [Block]) {
        for_each_particle(self.layout, |block, lane, index| {
            blocks[block].set_displacement(lane, self.rows[index].moved.truncate());
        });
    }

    /// The largest length over rest length, given where a particle is.
    fn stretch(&self, square_between: impl Fn(&Spring) -> f32) -> Stretch {
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

impl Sweep for ListSweep {
    fn set_substep(&mut self, substep: f32) {
        self.inverse_dt2 = 1.0 / (substep * substep);
    }

    fn bands(&self, _: usize) -> usize {
        1
    }

    fn substep(&mut self, blocks: &mut [Block], motion: &Motion, _: usize) -> Swept {
        let kernels = motion.kernels;
        (kernels.integrate)(blocks, motion.kept, motion.acceleration_dt2);
        self.load(blocks);
        for spring in &self.springs.springs {
            relax(&mut self.rows, spring, self.inverse_dt2);
        }
        self.store(blocks);
        motion.tethers.pull(motion.anchors, blocks, 0, kernels);
        let mut moved = [0.0; LANES];
        (kernels.commit)(blocks, &mut moved);
        let stretch = motion.measures.then(|| {
            self.load(blocks);
            let place = |end: u32| self.rows[end as usize].place.truncate();
            self.stretch(|spring| place(spring.ends[0]).distance_squared(place(spring.ends[1])))
        });
        Swept { moved, stretch }
    }

    fn measure(&self, blocks: &[Block], _: &Kernels) -> Stretch {
        let place = |end: u32| {
            let slot = self.layout.slot_of(end as usize);
            blocks[slot.block].position(slot.lane)
        };
        self.stretch(|spring| place(spring.ends[0]).distance_squared(place(spring.ends[1])))
    }

    fn boxed(&self) -> Box<dyn Sweep> {
        Box::new(self.clone())
    }
}

/// Moves the ends of a spring: [`relax`](super::kernel) of one spring in place of eight.
#[inline(always)]
fn relax(rows: &mut [Row], spring: &Spring, inverse_dt2: f32) {
    let [from, to] = spring.ends.map(|end| end as usize);
    let (a, b) = (rows[from], rows[to]);
    let way = (b.place - a.place) + (b.moved - a.moved);
    let q = way.x * way.x + way.y * way.y + way.z * way.z;
    let r2 = spring.rest_length * spring.rest_length;
    let softness = spring.compliance * inverse_dt2 + MIN_SOFTNESS;
    let weight = a.place.w + b.place.w + softness;
    let share = (q - r2) / ((1.5 * q + 0.5 * r2) * weight);
    // What is beside a displacement stays 0.
    let way = way * Vec4::new(1.0, 1.0, 1.0, 0.0);
    rows[from].moved = a.moved + way * (share * a.place.w);
    rows[to].moved = b.moved - way * (share * b.place.w);
}

/// Calls `visit` with the block, lane and index of each particle, block by block.
#[inline(always)]
fn for_each_particle(layout: Layout, mut visit: impl FnMut(usize, usize, usize)) {
    let (columns, strip) = (layout.columns as usize, layout.strip as usize);
    for row in 0..layout.rows as usize {
        for in_row in 0..strip {
            for lane in 0..LANES {
                let column = lane * strip + in_row;
                if column < columns {
                    visit(row * strip + in_row, lane, row * columns + column);
                }
            }
        }
    }
}
