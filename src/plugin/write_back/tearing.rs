//! Tears cloth that is loaded too much, and tells of tears.

use bevy::prelude::{DetectChangesMut, Entity, Local, Message, MessageWriter, Query, Vec3};

use crate::{
    cloth::{ClothMaterial, ClothParticles, ClothTearing, ClothTears, Strength, TearSearch},
    plugin::{
        authoring::{ClothOrder, Ordered},
        frame::ClothFrame,
        state::{ClothBuilt, ClothState},
    },
};

/// A cloth was torn or mended. It is sent in the tick after [`ClothTears`] changed.
#[derive(Message, Debug, Clone, Copy, PartialEq)]
pub struct ClothTorn {
    /// The cloth.
    pub cloth: Entity,
    /// Number of edges that are torn since the last tick.
    pub edges: usize,
    /// Where, as the tick ends: the first of the particles that came apart, in the world (m); or the middle of an edge, if none did.
    pub place: Vec3,
    /// Number of pieces that the cloth now has.
    pub pieces: usize,
}

/// Tears each cloth that has a [`ClothTearing`] at edges that bear too much. They open in the next tick.
pub(crate) fn tear_cloths(
    mut cloths: Query<(
        &ClothTearing,
        Option<&ClothMaterial>,
        &ClothBuilt,
        &ClothParticles,
        &ClothState,
        &mut ClothTears,
    )>,
    mut search: Local<TearSearch>,
) {
    for (tearing, material, built, particles, state, mut tears) in &mut cloths {
        // Tears that the game has listed since the tick began open first.
        let is_ready = state.is_valid
            && !state.rest.is_asleep()
            && built.matches(particles)
            && built.tears() == &*tears;
        let material = material.copied().unwrap_or_default();
        if is_ready && tearing.validate(&material).is_ok() {
            let factors = (built.from.as_ref()).map(|from| from.factors.stiffness.clone());
            let strength = Strength {
                tearing,
                material: &material,
                factors: &factors.unwrap_or_default(),
            };
            let tensions =
                |visit: &mut dyn FnMut([u32; 2], f32)| built.solver.for_each_tension(visit);
            let torn = search.edges(strength, built.surface(), particles, &tears, tensions);
            if !torn.is_empty() && tears.bypass_change_detection().tear_all(torn) > 0 {
                tears.set_changed();
            }
        }
    }
}

/// Sends a message of each cloth that was torn in this tick, in the order of [`ClothOrder`].
pub(crate) fn report_tears(
    mut cloths: Query<(
        Entity,
        Option<&ClothOrder>,
        &ClothFrame,
        &ClothParticles,
        &mut ClothBuilt,
    )>,
    mut messages: MessageWriter<ClothTorn>,
    mut torn: Local<Vec<Ordered>>,
) {
    torn.clear();
    for (cloth, order, .., built) in &cloths {
        if built.unreported_tear.is_some() {
            torn.push((order.copied().unwrap_or_default(), cloth));
        }
    }
    torn.sort_unstable();
    let mut each = cloths.iter_many_mut(torn.iter().map(|(_, cloth)| cloth));
    while let Some((cloth, _, frame, particles, mut built)) = each.fetch_next() {
        if let Some((ends, edges)) = built.unreported_tear.take() {
            // A game may have emptied the particles since the tear opened: then all that is known is where the cloth is.
            let [a, b] = ends.map(|end| particles.position(end as usize).unwrap_or_default());
            messages.write(ClothTorn {
                cloth,
                edges,
                place: frame.to_world((a + b) / 2.0),
                pieces: built.surface().pieces(),
            });
        }
    }
}
