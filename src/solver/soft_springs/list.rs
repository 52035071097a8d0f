//! The forces of the springs of particles that tears made, one by one.

use bevy::math::Vec3;

use crate::{
    cloth::{Block, Layout, Slot, SpringList},
    solver::kernels::share,
};

#[derive(Debug, Default, Clone)]
pub(super) struct ForceList {
    springs: Vec<ListedForce>,
    /// Where their particles are.
    slots: Vec<Slot>,
    /// On each of these (N).
    forces: Vec<Vec3>,
}

#[derive(Debug, Clone)]
struct ListedForce {
    ends: [u32; 2],
    /// N/m.
    stiffness: f32,
    /// One over the squared length at rest (1/m²).
    inverse_rest_square: f32,
}

impl ForceList {
    /// Of the springs of the particles from this one on. `None` if one is rigid.
    pub fn new(list: &SpringList, first: u32, layout: Layout) -> Option<Self> {
        let (list, particles) = list.beyond(first);
        let forces = list.springs.iter().map(|spring| ListedForce {
            ends: spring.ends,
            stiffness: 1.0 / spring.compliance,
            inverse_rest_square: (spring.rest_length * spring.rest_length).recip(),
        });
        let springs: Vec<ListedForce> = forces.collect();
        let is_finite = springs.iter().all(|spring| spring.stiffness.is_finite());
        let slots = particles.iter().map(|at| layout.slot_of(*at as usize));
        is_finite.then(|| Self {
            springs,
            slots: slots.collect(),
            forces: vec![Vec3::ZERO; particles.len()],
        })
    }

    /// Adds what the forces make of displacements with this weight (s²).
    pub fn push(&mut self, blocks: &mut [Block], weight: f32) {
        self.forces.fill(Vec3::ZERO);
        for spring in &self.springs {
            let [a, b] = spring.ends.map(|end| {
                let slot = self.slots[end as usize];
                blocks[slot.block].position(slot.lane)
            });
            let square = a.distance_squared(b) * spring.inverse_rest_square;
            let force = share(spring.stiffness, square) * (b - a);
            self.forces[spring.ends[0] as usize] += force;
            self.forces[spring.ends[1] as usize] -= force;
        }
        for (force, slot) in self.forces.iter().zip(&self.slots) {
            let block = &mut blocks[slot.block];
            let given = weight * block.inverse_mass(slot.lane) * *force;
            block.set_displacement(slot.lane, block.displacement(slot.lane) + given);
        }
    }
}
