//! Scenes in which cloth touches cloth, with no plugin around them.

mod folds;
mod hold;
mod lanes;
mod motion;
mod response;
mod scenes;
mod search;
mod stopped;
mod tangled;
mod thrown;
mod torn;

use std::sync::Arc;

use bevy::math::{Quat, Vec3};

use self::thrown::Draw;
use super::{
    MutualContact, intersections, participant::Participant, settings::ClothSelfCollision,
    sheet::Sheet, work::Counts,
};
use crate::{
    cloth::{
        Cloth, ClothMaterial, ClothParticles, Springs, Surface, ThicknessFactors, TriangleMesh,
    },
    hierarchy::QuadTree,
    solver::{Solver, TickStep},
};

/// A cloth with all that moves it.
pub(super) struct Sheeted {
    pub particles: ClothParticles,
    surface: Arc<Surface>,
    sheet: Arc<Sheet>,
    solver: Solver,
    /// Where it is thinner.
    factors: Option<ThicknessFactors>,
}

impl Sheeted {
    /// Makes it thinner by factors that are drawn, from 0.1 to 1.
    fn of_drawn_thickness(mut self, draw: &mut Draw) -> Self {
        let each = (0..self.particles.len()).map(|_| 0.55 + 0.45 * draw.next());
        self.factors = ThicknessFactors::of(each.collect());
        self
    }

    /// A square of so many particles a side and this width (m), each put where `place` says from where it would lie around the
    /// origin.
    pub fn new(side: u32, width: f32, place: impl Fn(Vec3) -> Vec3) -> Self {
        Self::of_kind(side, width, false, place)
    }

    /// The same, of a grid or of an irregular mesh.
    pub fn of_kind(side: u32, width: f32, is_mesh: bool, place: impl Fn(Vec3) -> Vec3) -> Self {
        let spacing = width / (side - 1) as f32;
        let surface = if is_mesh {
            Surface::of_mesh(&irregular(side, spacing), 0.0, Vec3::ONE).expect("a surface")
        } else {
            let cloth = Cloth::new(side, side, spacing).lying().centred();
            Surface::of_grid(&cloth.grid(Vec3::ONE).expect("a valid grid"))
        };
        Self::of_surface(Arc::new(surface), place)
    }

    /// The same of any surface.
    pub fn of_surface(surface: Arc<Surface>, place: impl Fn(Vec3) -> Vec3) -> Self {
        let material = ClothMaterial::default();
        let springs = Springs::of_surface(&surface, &material);
        let tree = QuadTree::of_surface(&surface, true);
        let solver = Solver::of_surface(&surface, &springs);
        let mut particles = ClothParticles::at_rest(&surface, &material).expect("valid particles");
        for index in 0..particles.len() {
            let at = particles.position(index).expect("it exists");
            let at = place(at);
            particles.set_position(index, at).expect("it exists");
        }
        Self {
            sheet: Arc::new(Sheet::new(&surface, &tree)),
            particles,
            surface,
            solver,
            factors: None,
        }
    }
}

/// A lying square whose vertices are moved by up to 0.2 spacings, with diagonals of any direction.
fn irregular(side: u32, spacing: f32) -> TriangleMesh {
    let off = |index: u32| 0.2 * (1.7 * index as f32 + 0.3 * (index * index % 17) as f32).sin();
    let place = |index: u32| {
        let middle = 0.5 * (side - 1) as f32;
        let [row, column] = [index / side, index % side].map(|at| at as f32 - middle);
        Vec3::new(column + off(index), 0.0, row + off(index + 7)) * spacing
    };
    let cells = (0..side - 1).flat_map(|row| (0..side - 1).map(move |column| row * side + column));
    let triangles = cells.flat_map(|a| {
        let [b, c, d] = [a + 1, a + side, a + side + 1];
        if off(3 * a) > 0.0 {
            [[a, c, b], [b, c, d]]
        } else {
            [[a, c, d], [a, d, b]]
        }
    });
    TriangleMesh {
        positions: (0..side * side).map(place).collect(),
        triangles: triangles.collect(),
        ..TriangleMesh::default()
    }
}

/// Cloths that touch themselves and each other.
pub(super) struct Scene {
    pub cloths: Vec<Sheeted>,
    pub contact: MutualContact,
    pub settings: ClothSelfCollision,
    pub step: TickStep,
    /// The work that is left of a tick after its beginning, if it is not that of the number of particles.
    pub work: Option<usize>,
    /// The work of the last tick's beginning, and that which was left after it.
    pub searched: usize,
    pub begun: usize,
    pub worst: usize,
}

impl Scene {
    pub fn new(cloths: Vec<Sheeted>, thickness: f32) -> Self {
        Self {
            cloths,
            contact: MutualContact::default(),
            settings: settings(thickness),
            step: TickStep {
                seconds: 1.0 / 60.0,
                acceleration: Vec3::new(0.0, -9.81, 0.0),
                damping: 0.005,
                ..TickStep::default()
            },
            work: None,
            searched: 0,
            begun: 0,
            worst: 0,
        }
    }

    /// Moves all by a tick. `respond` is called after each sub-step, with the time that has passed in the tick (from 0 to 1).
    pub fn tick(&mut self, mut respond: impl FnMut(usize, &mut ClothParticles, f32)) {
        let dt = self.step.seconds / self.step.substeps as f32;
        let mut ticks: Vec<_> = self
            .cloths
            .iter_mut()
            .map(|cloth| cloth.solver.begin(&mut cloth.particles, self.step, &[]))
            .collect();
        let settings = self.settings;
        let mut is_begun = false;
        for _ in 0..self.step.substeps {
            if !is_begun {
                let participants = participants(&mut self.cloths, settings);
                self.contact.begin(&participants, |_, _| true);
                let particles = participants.iter().map(|cloth| cloth.particles.len());
                self.searched = Counts::new(particles.sum()).work - self.contact.counts.work;
                self.begun = self.work.unwrap_or(self.contact.counts.work);
                self.contact.counts.work = self.begun;
                is_begun = true;
            }
            let mut ends = Vec::new();
            for (cloth, tick) in self.cloths.iter_mut().zip(&mut ticks) {
                let substep = cloth.solver.substep(&mut cloth.particles, &[], tick);
                ends.push(substep.expect("one left").end());
            }
            let before = participants(&mut self.cloths, settings);
            self.contact.note_before_colliders(&before);
            drop(before);
            for (index, (cloth, end)) in self.cloths.iter_mut().zip(ends).enumerate() {
                respond(index, &mut cloth.particles, end);
            }
            let mut participants = participants(&mut self.cloths, settings);
            let mut is_pushed = vec![false; participants.len()];
            self.contact
                .respond(&mut participants, |_, _| true, dt, &mut is_pushed);
            drop(participants);
            for ((cloth, tick), is_pushed) in self.cloths.iter_mut().zip(&mut ticks).zip(is_pushed)
            {
                if is_pushed {
                    tick.note_push(&mut cloth.particles);
                }
            }
        }
        for (cloth, tick) in self.cloths.iter_mut().zip(ticks) {
            cloth.solver.end(&mut cloth.particles, &[], tick);
        }
        self.worst = self.worst.max(self.intersections());
    }

    pub fn intersections(&self) -> usize {
        let cloths: Vec<_> = self
            .cloths
            .iter()
            .map(|cloth| (&*cloth.surface, cloth.particles.positions().collect()))
            .collect();
        intersections(&cloths)
    }
}

pub(super) fn settings(thickness: f32) -> ClothSelfCollision {
    ClothSelfCollision {
        thickness,
        friction: 0.3,
        with_itself: true,
    }
}

fn participants(cloths: &mut [Sheeted], settings: ClothSelfCollision) -> Vec<Participant<'_>> {
    let each = cloths.iter_mut();
    each.map(|cloth| Participant {
        particles: &mut cloth.particles,
        sheet: &cloth.sheet,
        to_common: None,
        settings,
        thickness: cloth.factors.as_ref(),
        is_fixed: false,
    })
    .collect()
}

/// Nothing below the xz plane, with friction.
pub(super) fn floor(particles: &mut ClothParticles) {
    for index in 0..particles.len() {
        let at = particles.position(index).expect("it exists");
        if at.y < 0.0 {
            let moved = particles.displacement(index).expect("it exists");
            let stopped = (-at.y).min(-moved.y).max(0.0);
            let along = Vec3::new(moved.x, 0.0, moved.z);
            let slip = along.length();
            let grip = if slip > 0.4 * stopped {
                0.4 * stopped / slip
            } else {
                1.0
            };
            let slot = particles.layout().slot_of(index);
            let block = &mut particles.blocks_mut()[slot.block];
            block.set_position(slot.lane, Vec3::new(at.x, 0.0, at.z) - along * grip);
            block.set_displacement(slot.lane, moved + Vec3::Y * stopped - along * grip);
        }
    }
}

/// Turned by these angles (rad).
pub(super) fn turned(angles: Vec3, at: Vec3) -> Vec3 {
    Quat::from_euler(bevy::math::EulerRot::XYZ, angles.x, angles.y, angles.z) * at
}
