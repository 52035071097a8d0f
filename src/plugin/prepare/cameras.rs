//! Places of cameras, and visibility.

#[cfg(not(feature = "mesh"))]
use std::marker::PhantomData;

#[cfg(feature = "mesh")]
use bevy::{
    camera::{Camera, visibility::InheritedVisibility},
    ecs::system::Query,
    transform::components::GlobalTransform,
};
use bevy::{
    ecs::{entity::Entity, system::SystemParam},
    math::Vec3,
};

/// The cameras of the app; none where nothing is drawn.
#[derive(SystemParam)]
pub(crate) struct Cameras<'w, 's> {
    #[cfg(feature = "mesh")]
    all: Query<'w, 's, (&'static Camera, &'static GlobalTransform)>,
    #[cfg(feature = "mesh")]
    visibilities: Query<'w, 's, &'static InheritedVisibility>,
    #[cfg(not(feature = "mesh"))]
    none: PhantomData<(&'w (), &'s ())>,
}

impl Cameras<'_, '_> {
    /// Distance of a point from the nearest active camera (m), as of the last frame; `None` without an active camera.
    pub fn nearest(&self, point: Vec3) -> Option<f32> {
        #[cfg(feature = "mesh")]
        let places = self
            .all
            .iter()
            .filter(|(camera, _)| camera.is_active)
            .map(|(_, place)| place.translation());
        #[cfg(not(feature = "mesh"))]
        let places = {
            let PhantomData = self.none;
            std::iter::empty::<Vec3>()
        };
        places.map(|place| place.distance(point)).reduce(f32::min)
    }

    /// Whether Bevy's visibility hid an entity in the last frame, its own or an ancestor's.
    pub fn is_hidden(&self, entity: Entity) -> bool {
        #[cfg(feature = "mesh")]
        return self.visibilities.get(entity).is_ok_and(|seen| !seen.get());
        #[cfg(not(feature = "mesh"))]
        {
            let _ = entity;
            false
        }
    }
}
