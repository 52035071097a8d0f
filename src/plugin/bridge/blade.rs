//! Blades that cut cloth.

use bevy::{
    ecs::system::SystemParam,
    prelude::{DetectChangesMut, Entity, Query, Vec3},
};

use super::surface_now::surface_now;
use crate::{
    cloth::{ClothParticles, ClothTears, Cut},
    plugin::{
        frame::ClothFrame,
        state::{ClothBuilt, ClothState},
    },
};

/// Cuts cloths with a blade: a sword, scissors, the mouse. Only cloths with [`ClothTears`] or
/// [`ClothTearing`](crate::cloth::ClothTearing) are cut.
///
/// A cut runs along the edges of the cloth's faces that are nearest to it: between two faces, if the way from the middle of one
/// to the middle of the other goes through the swept area. It opens in the next tick, or in the first one in which a cloth that stands
/// still goes on. Cloth is where it was at the end of the last tick.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_drape::prelude::*;
///
/// #[derive(Component)]
/// struct Sword {
///     /// Hilt and tip, as the last tick ended.
///     last: Option<[Vec3; 2]>,
/// }
///
/// fn slash(mut swords: Query<(&GlobalTransform, &mut Sword)>, mut blade: ClothBlade) {
///     for (place, mut sword) in &mut swords {
///         let now = [place.translation(), place.transform_point(Vec3::Y)];
///         if let Some(last) = sword.last.replace(now) {
///             blade.sweep(last, now);
///         }
///     }
/// }
/// # bevy::ecs::system::assert_is_system(slash);
/// ```
#[derive(SystemParam)]
pub struct ClothBlade<'w, 's> {
    cloths: Query<'w, 's, Cuttable>,
}

type Cuttable = (
    Entity,
    &'static ClothBuilt,
    &'static ClothParticles,
    &'static ClothFrame,
    &'static ClothState,
    &'static mut ClothTears,
);

impl ClothBlade<'_, '_> {
    /// Cuts where a straight blade goes from two ends to two others, in the world (m). Returns how many edges were torn.
    /// Nothing is cut if an input is not finite.
    pub fn sweep(&mut self, from: [Vec3; 2], to: [Vec3; 2]) -> usize {
        self.sweep_where(from, to, |_| true)
    }

    /// The same, among the cloths for which `includes` returns true.
    pub fn sweep_where(
        &mut self,
        from: [Vec3; 2],
        to: [Vec3; 2],
        includes: impl Fn(Entity) -> bool,
    ) -> usize {
        let mut torn = 0;
        for (entity, built, particles, frame, state, mut tears) in &mut self.cloths {
            if !includes(entity) {
                continue;
            }
            let Some(surface) = surface_now(built, state, Some(&tears), particles) else {
                continue;
            };
            let to_cloth = frame.isometry().inverse();
            let [from, to] = [from, to].map(|blade| blade.map(|end| to_cloth * end));
            let edges = Cut::new(from, to).edges(&surface, particles);
            let new = tears.bypass_change_detection().tear_all(edges);
            if new > 0 {
                tears.set_changed();
                torn += new;
            }
        }
        torn
    }
}
