//! The memory from which a cloth is drawn.

use std::sync::Arc;

use bevy::{
    ecs::change_detection::Tick,
    math::Affine3A,
    prelude::{Component, Entity, Mesh, Vec3},
};

use super::{
    blend::Blend,
    placing::Carriers,
    skin::DrawnPose,
    tube,
    write::{Tangents, TornVertices, Vectors},
};
use crate::{
    cloth::Surface,
    plugin::frame::{ClothFrame, Shift},
};

/// On a cloth that has a [`ClothMesh`](crate::plugin::ClothMesh): all that its picture needs from frame to frame. It is
/// made again for a clone, and for a scene that is loaded.
#[derive(Component, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct MeshDrawing {
    /// The surface that it is a mesh of.
    pub(super) surface: Arc<Surface>,
    pub(super) tangents: Tangents,
    pub(super) vertices: TornVertices,
    /// Positions as the last tick began, in the cloth's frame.
    pub(super) previous: Vec<Vec3>,
    /// The carriers of its pins, as of the last two ticks.
    pub(super) carriers: Carriers,
    /// The pose that it follows, if it does.
    pub(super) pose: DrawnPose,
    /// Where its targets are drawn.
    pub(super) targets: Vec<Affine3A>,
    /// Whether those were remembered from a cloth that slept.
    pub(super) rested: bool,
    /// Positions to be drawn, in the entity's frame.
    pub(in crate::plugin::draw) drawn: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    /// The picture of a cloth that sleeps or is frozen: when its particles were written, the place of its entity or of
    /// the frozen particles relative to it, and whether it is visible.
    pub(super) settled: Option<(Tick, Affine3A, bool)>,
    /// The last picture, and how it blends into the current one.
    pub(super) before: Vec<Vec3>,
    pub(super) blend: Blend,
    /// Place of the particles relative to the entity that they are frozen to.
    pub(super) frozen: Option<Affine3A>,
    /// Whether it drives other meshes, in this frame: its drawn positions are needed then, even if it is hidden.
    pub(in crate::plugin::draw) drives: bool,
    /// Changes whenever it is drawn elsewhere.
    pub(in crate::plugin::draw) version: u32,
}

impl MeshDrawing {
    /// Takes over the mesh of another surface. It moves on from where it is drawn.
    pub(super) fn replace(&mut self, new: Self) {
        let old = std::mem::replace(self, new);
        (self.previous, self.carriers, self.pose) = (old.previous, old.carriers, old.pose);
        (self.rested, self.drives) = (old.rested, old.drives);
        self.version = old.version.wrapping_add(1);
    }

    /// Writes the drawn positions of the particles into the mesh, with normals and, if it has them, tangents. Vertices
    /// without a particle stay where they are.
    pub(super) fn write(&mut self, mesh: &mut Mesh) {
        let surface = &self.surface;
        if let Some(radius) = tube::radius_of(surface) {
            return tube::write(mesh, &self.drawn, radius);
        }
        surface.normals_at(&self.drawn, &mut self.normals);
        let mut vectors = Vectors::of(mesh);
        for (values, of_particles) in [
            (&mut vectors.positions, &self.drawn),
            (&mut vectors.normals, &self.normals),
        ] {
            for (vertex, value) in values.iter_mut().flat_map(|all| all.iter_mut()).enumerate() {
                if let Some(particle) = self.vertices.particle_of(surface, vertex) {
                    *value = of_particles[particle].to_array();
                }
            }
        }
        self.tangents.write(vectors);
    }

    /// Shifts it with the world's origin, from one frame to another; `target` gives the current place of a target.
    pub(crate) fn shift(
        &mut self,
        shift: Shift,
        frames: [ClothFrame; 2],
        target: impl Fn(Entity) -> Option<Affine3A>,
    ) {
        self.carriers.shift(shift, frames, target);
        self.pose.shift(shift, frames);
    }

    /// Whether it is drawn as this surface.
    pub(crate) fn is_of(&self, surface: &Arc<Surface>) -> bool {
        Arc::ptr_eq(&self.surface, surface)
    }
}
