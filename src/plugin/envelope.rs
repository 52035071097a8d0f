//! Tells of cloths that leave the envelope in which they are simulated well.

use bevy::{
    ecs::{
        entity::Entity,
        message::{Message, MessageWriter},
        name::NameOrEntity,
        system::Query,
    },
    log::warn,
    reflect::Reflect,
};

use super::{ClothStats, components::ClothTick};
use crate::solver::ClothLimit;

/// So many ticks in a row make a warning: a blow may stretch a cloth for an instant, which does no harm.
const TICKS: u32 = 8;

/// A cloth has left the envelope in which it is simulated well, for more than an instant. It is logged as well, with the
/// remedy: once for each limit, and again after its [`ClothSettings`](crate::solver::ClothSettings) have changed.
#[derive(Message, Reflect, Debug, Clone, Copy, PartialEq)]
pub struct ClothLimitExceeded {
    /// The cloth.
    pub cloth: Entity,
    /// Which limit.
    pub limit: ClothLimit,
    /// The quantity: a stretch, a ratio of masses, a distance in spacings, a damping, or a way in radii.
    pub quantity: f32,
    /// Up to where it is good.
    pub good_up_to: f32,
}

/// Looks at every cloth that moved in the tick.
pub(super) fn tell_of_limits(
    mut cloths: Query<(NameOrEntity, &mut ClothTick, &mut ClothStats)>,
    mut exceeded: MessageWriter<ClothLimitExceeded>,
) {
    for (cloth, mut tick, mut stats) in &mut cloths {
        // Kept as it was while it sleeps or stands still; not touched, so that nothing seems to change.
        let Some(load) = tick.load else {
            continue;
        };
        tick.load = None;
        stats.exceeded = None;
        for (index, limit) in ClothLimit::ALL.into_iter().enumerate() {
            let (ticks, is_told) = &mut tick.beyond[index];
            let Some([quantity, good_up_to]) = load.beyond(limit) else {
                *ticks = 0;
                continue;
            };
            stats.exceeded = stats.exceeded.or(Some(limit));
            *ticks += 1;
            // What passes through does so at once.
            if (*ticks >= TICKS || limit == ClothLimit::Dart) && !std::mem::replace(is_told, true) {
                exceeded.write(ClothLimitExceeded {
                    cloth: cloth.entity,
                    limit,
                    quantity,
                    good_up_to,
                });
                warn!(
                    "{cloth} has left the envelope in which cloth is simulated well: its {limit} is {quantity:.3}, good up to {good_up_to}; {}",
                    limit.remedy()
                );
            }
        }
    }
}
