//! The creases of a grid.
//!
//! A stencil of the plate has a second difference d, a rest curvature κ₀ and a normal n. Its energy is `½ k |d − c n|²`, where c is
//! κ₀ times the square of the spacing. The part without c is the plate's. The rest is a force, `c k` times the gradient of d·n.
//! It includes how n turns, so that no stencil has a resultant or a moment.
//!
//! Only stencils with a crease are looked at in a sub-step. Each family of stencils is pushed before it is solved: one at its rest
//! curvature stays there, however stiff the others are.

use bevy::math::Vec3;

use super::{
    creasing::{ClothCreasing, recall},
    plate::Plate,
};
use crate::cloth::{Block, ClothGrid, Layout, MapInline, Slot};

/// What stencils are solved together, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Solve {
    /// The cells between each even column and the next one, or each odd one.
    Twist { is_odd: bool },
    /// Down the columns.
    Down,
    /// Along the rows.
    Across,
}

impl Solve {
    const ALL: [Self; 4] = [
        Self::Twist { is_odd: false },
        Self::Twist { is_odd: true },
        Self::Down,
        Self::Across,
    ];

    /// Which of a particle's curvatures is solved.
    fn kind(self) -> usize {
        match self {
            Self::Across => ACROSS,
            Self::Down => DOWN,
            Self::Twist { .. } => TWIST,
        }
    }
}

const ACROSS: usize = 0;
const DOWN: usize = 1;
/// Of the cell whose upper left corner the particle is.
const TWIST: usize = 2;

/// A stencil with a crease.
#[derive(Debug, Clone, Copy)]
struct Crease {
    /// Of chains, the particles before and after the one in the middle, that itself, and those beside it; of cells, the corners.
    particles: [u32; 5],
    is_cell: bool,
    /// k c (N), by the sign of the normal.
    moment: f32,
    forces: [Vec3; 5],
}

/// The rest curvatures of a grid.
#[derive(Debug, Clone)]
pub(super) struct GridCreases {
    plate: Plate,
    spacing: [f32; 2],
    slots: Vec<Slot>,
    /// Rest curvatures along rows, along columns and of twist (1/m).
    rest: Vec<[f32; 3]>,
    /// Memory for those that may yield.
    trials: Vec<[f32; 3]>,
    places: Vec<Vec3>,
    creases: Vec<Crease>,
    /// Where those of each family end.
    ends: [usize; Solve::ALL.len()],
}

impl GridCreases {
    pub fn new(grid: &ClothGrid, plate: &Plate) -> Self {
        let layout = plate.layout;
        Self {
            plate: plate.clone(),
            spacing: grid.spacing().to_array(),
            slots: layout.slots().collect(),
            rest: vec![[0.0; 3]; layout.len()],
            trials: vec![[0.0; 3]; layout.len()],
            places: vec![Vec3::ZERO; layout.len()],
            // Room for all at once: no later step may ask for it.
            creases: Vec::with_capacity(3 * layout.len()),
            ends: [0; Solve::ALL.len()],
        }
    }

    pub fn rest(&self) -> &[f32] {
        self.rest.as_flattened()
    }

    /// Takes over rest curvatures; none where there are those of another surface.
    pub fn recall(&mut self, rest: &[f32]) {
        if recall(self.rest.as_flattened_mut(), rest) {
            self.gather();
        }
    }

    /// Gathers the stencils with a crease, family by family.
    fn gather(&mut self) {
        let Layout { columns, .. } = self.plate.layout;
        self.creases.clear();
        for (family, end) in Solve::ALL.into_iter().zip(&mut self.ends) {
            for (at, rest) in self.rest.iter().enumerate() {
                let crease = rest[family.kind()];
                let (row, column) = (at as u32 / columns, at as u32 % columns);
                let is_own = match family {
                    Solve::Twist { is_odd } => (column % 2 == 1) == is_odd,
                    _ => true,
                };
                if crease != 0.0 && is_own {
                    let stencil = Stencil::new(&self.plate, family.kind(), row, column);
                    self.creases.extend(stencil.crease(crease, self.spacing));
                }
            }
            *end = self.creases.len();
        }
    }

    /// Takes the places where this part of the displacements leads to.
    fn load(&mut self, blocks: &[Block], part: f32) {
        // From next to the cloth, so that no digit of a displacement is lost.
        let origin = blocks.first().map_or(Vec3::ZERO, |block| block.position(0));
        for (place, slot) in self.places.iter_mut().zip(&self.slots) {
            let block = &blocks[slot.block];
            *place = (block.position(slot.lane) - origin) + part * block.displacement(slot.lane);
        }
    }

    /// Takes the forces where this part of the displacements leads to.
    pub fn aim(&mut self, blocks: &[Block], part: f32) {
        if self.creases.is_empty() {
            return;
        }
        self.load(blocks, part);
        for crease in &mut self.creases {
            let places = crease.particles.map(|at| self.places[at as usize]);
            crease.forces = forces(places, crease.moment, crease.is_cell);
        }
    }

    /// Adds the forces' displacements with this weight (s²): those of a family, or of all.
    pub fn push(&self, family: Option<Solve>, weight: f32, blocks: &mut [Block]) {
        let place = family.and_then(|family| Solve::ALL.iter().position(|of| *of == family));
        let creases = match place {
            Some(0) => &self.creases[..self.ends[0]],
            Some(place) => &self.creases[self.ends[place - 1]..self.ends[place]],
            None => &self.creases[..],
        };
        for crease in creases {
            for (particle, force) in crease.particles.iter().zip(&crease.forces) {
                let Slot { block, lane } = self.slots[*particle as usize];
                let block = &mut blocks[block];
                block.displace(lane, weight * block.inverse_mass(lane) * *force);
            }
        }
    }

    /// Has rest curvatures follow where the cloth is bent beyond its yield curvature.
    pub fn flow(&mut self, creasing: &ClothCreasing, blocks: &[Block]) {
        self.load(blocks, 0.0);
        let Layout { columns, rows, .. } = self.plate.layout;
        for (at, trial) in self.trials.iter_mut().enumerate() {
            let (row, column) = (at as u32 / columns, at as u32 % columns);
            for (kind, trial) in trial.iter_mut().enumerate() {
                let stencil = Stencil::new(&self.plate, kind, row, column);
                let curvature = stencil.curvature(&self.places, self.spacing);
                *trial = creasing.trial(curvature, self.rest[at][kind]);
            }
        }
        let mut has_flowed = false;
        for at in 0..self.rest.len() {
            let (row, column) = (at as u32 / columns, at as u32 % columns);
            let trial = |up: u32, left: u32| self.trials[at - (up * columns + left) as usize];
            let own = trial(0, 0);
            let bent = |of: [f32; 3]| of[ACROSS] * of[ACROSS] + of[DOWN] * of[DOWN];
            // Both are averaged to where the other one is.
            let (mut twisted, mut cells) = (0.0, 0.0_f32);
            for (up, left) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let is_cell = up <= row && left <= column && row - up + 1 < rows;
                if is_cell && column - left + 1 < columns {
                    let twist = trial(up, left)[TWIST];
                    twisted += 2.0 * twist * twist;
                    cells += 1.0;
                }
            }
            let flow = creasing.flow(bent(own) + twisted / cells.max(1.0));
            let mut flows = [flow, flow, 0.0];
            if own[TWIST] != 0.0 {
                let below = at + columns as usize;
                let corners = [at, at + 1, below, below + 1].map(|at| bent(self.trials[at]));
                let bent = corners[0] + corners[1] + corners[2] + corners[3];
                let twisted = 2.0 * own[TWIST] * own[TWIST];
                flows[TWIST] = creasing.flow(bent / 4.0 + twisted);
            }
            let [wide, high] = self.spacing;
            let most = [2.0 / wide, 2.0 / high, 2.0 / (wide * high).sqrt()];
            for kind in [ACROSS, DOWN, TWIST] {
                let rest = &mut self.rest[at][kind];
                let flowed = (*rest + flows[kind] * own[kind]).clamp(-most[kind], most[kind]);
                has_flowed |= flowed != *rest;
                *rest = flowed;
            }
        }
        if has_flowed {
            self.gather();
        }
    }
}

/// Three particles in a line and those beside the middle one, or the corners of a cell.
struct Stencil {
    particles: [u32; 5],
    kind: usize,
    /// N/m; 0 if there is no such stencil.
    stiffness: f32,
}

impl Stencil {
    fn new(plate: &Plate, kind: usize, row: u32, column: u32) -> Self {
        let Layout { columns, rows, .. } = plate.layout;
        let at = row * columns + column;
        let along = |at: u32, count: u32, step: u32, own: u32| {
            let before = if at > 0 { own - step } else { own };
            let after = if at + 1 < count { own + step } else { own };
            [before, after]
        };
        let [left, right] = along(column, columns, 1, at);
        let [above, below] = along(row, rows, columns, at);
        let (particles, stiffness) = match kind {
            ACROSS => ([left, right, at, above, below], plate.across(row, column)),
            DOWN => ([above, below, at, left, right], plate.down(row, column)),
            _ => {
                let corners = [at, right, below, below + (right - at), at];
                (corners, plate.twist(row, column))
            }
        };
        Self {
            particles,
            kind,
            stiffness,
        }
    }

    /// What its second difference is of a curvature, with the sign of its own normal (m²).
    fn area(&self, [wide, high]: [f32; 2]) -> f32 {
        match self.kind {
            ACROSS => wide * wide,
            DOWN => -high * high,
            _ => wide * high,
        }
    }

    fn crease(&self, crease: f32, spacing: [f32; 2]) -> Option<Crease> {
        (self.stiffness > 0.0).then_some(Crease {
            particles: self.particles,
            is_cell: self.kind == TWIST,
            moment: self.stiffness * crease * self.area(spacing),
            forces: [Vec3::ZERO; 5],
        })
    }

    /// 1/m, 0 if there is no such stencil.
    fn curvature(&self, places: &[Vec3], spacing: [f32; 2]) -> f32 {
        if self.stiffness <= 0.0 {
            return 0.0;
        }
        let places = self.particles.map(|particle| places[particle as usize]);
        let (difference, along) = match self.kind {
            TWIST => cell(places),
            _ => chain(places),
        };
        let frame = Frame::new(along);
        frame.map_or(0.0, |of| difference.dot(of.normal) / self.area(spacing))
    }
}

/// The second difference of a chain, and two directions in the surface.
fn chain([before, after, own, near, far]: [Vec3; 5]) -> (Vec3, [Vec3; 2]) {
    let difference = (before - own) + (after - own);
    (difference, [after - before, far - near])
}

/// The same of a cell, along its diagonals.
fn cell([a, b, c, d, _]: [Vec3; 5]) -> (Vec3, [Vec3; 2]) {
    ((a - b) - (c - d), [d - a, c - b])
}

/// A normal, and how it turns: by `−n` times the scalar products of these with the changes of both directions (1/m).
struct Frame {
    normal: Vec3,
    turns: [Vec3; 2],
}

impl Frame {
    fn new([a, b]: [Vec3; 2]) -> Option<Self> {
        let across = a.cross(b);
        let length = across.length();
        let normal = across / length;
        // Of three particles in one place nothing is known.
        let turns = [b.cross(normal) / length, normal.cross(a) / length];
        normal.is_finite().then_some(Self { normal, turns })
    }
}

/// The forces of a crease on its particles (N), along the normal where they are.
fn forces(places: [Vec3; 5], moment: f32, is_cell: bool) -> [Vec3; 5] {
    let (difference, along) = if is_cell { cell(places) } else { chain(places) };
    let Some(frame) = Frame::new(along) else {
        return [Vec3::ZERO; 5];
    };
    // What turns the normal, for each direction. Beyond the moment it is that of a chain which lies on itself, and of no use.
    let most = moment.abs();
    let lever = |turn: Vec3| (moment * difference.dot(turn)).clamp(-most, most);
    let [a, b] = frame.turns.map_inline(lever);
    let forces = match is_cell {
        true => [moment + a, b - moment, -b - moment, moment - a, 0.0],
        false => [moment + a, moment - a, -2.0 * moment, b, -b],
    };
    forces.map(|force| force * frame.normal)
}
