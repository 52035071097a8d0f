//! Places of cameras, and visibility.

use bevy::{
    ecs::system::SystemParam,
    prelude::{Camera, Entity, GlobalTransform, InheritedVisibility, Query, Vec3},
};

/// The cameras of the app.
#[derive(SystemParam)]
pub(crate) struct Cameras<'w, 's> {
    all: Query<'w, 's, (&'static Camera, &'static GlobalTransform)>,
    visibilities: Query<'w, 's, &'static InheritedVisibility>,
}

impl Cameras<'_, '_> {
    /// Distance of a point from the nearest active camera (m), as of the last frame; `None` without an active camera.
    pub fn nearest(&self, point: Vec3) -> Option<f32> {
        let active = self.all.iter().filter(|(camera, _)| camera.is_active);
        let distances = active.map(|(_, place)| place.translation().distance(point));
        distances.reduce(f32::min)
    }

    /// Whether Bevy's visibility hid an entity in the last frame, its own or an ancestor's.
    pub fn is_hidden(&self, entity: Entity) -> bool {
        self.visibilities.get(entity).is_ok_and(|seen| !seen.get())
    }
}
