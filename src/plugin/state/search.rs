//! The result of a search, and the region in which a cloth may be touched.

use bevy::prelude::{Component, Reflect, ReflectDefault, Vec3};

use crate::{
    hierarchy::{NodeBounds, TopDownQuery},
    plugin::frame::Shift,
};

/// The bounding volumes of the last tick in which a collider was near, and the result of the search through them.
/// Scenes and clones don't have it, because it belongs to a single tick.
#[derive(Component, Reflect, Debug, Default)]
#[type_path = "bevy_drape"]
#[reflect(Default, Debug)]
#[component(clone_behavior = Ignore)]
pub struct ClothSearch {
    #[reflect(ignore)]
    pub(crate) bounds: NodeBounds,
    #[reflect(ignore)]
    pub(crate) query: TopDownQuery,
}

impl ClothSearch {
    /// The nodes that were visited, the nodes that touched, and the candidates.
    pub fn query(&self) -> &TopDownQuery {
        &self.query
    }
}

/// The region in which a cloth may be touched in the tick. It is small, so that a thousand cloths with nothing near are
/// skipped without reading anything else.
#[derive(Component, Debug, Default, Clone, Copy)]
pub(crate) struct BroadPhaseBounds {
    /// Around the whole of it, as far as it may get in the tick, in the world (m).
    pub centre: Vec3,
    pub radius: f32,
    /// Whether the cloth takes part in the tick.
    pub takes_part: bool,
    /// Whether it sleeps, touching something that may have gone.
    pub has_sleeping_contacts: bool,
    /// Whether there is something to search for.
    pub is_searched: bool,
    /// Whether what an earlier search found is still there.
    pub is_stale: bool,
}

impl BroadPhaseBounds {
    /// Has been shifted with the world's origin.
    pub fn shift(&mut self, shift: Shift) {
        self.centre += shift.0;
        self.radius += shift.rounding(self.centre.into());
    }

    /// Leaves the cloth out of the tick.
    pub fn leave_out(&mut self) {
        self.takes_part = false;
        self.has_sleeping_contacts = false;
        self.is_stale |= self.is_searched;
        self.is_searched = false;
    }
}
