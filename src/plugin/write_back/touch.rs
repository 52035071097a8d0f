//! Sends a message when a cloth and a collider begin to touch, and when they no longer do.

use bevy::{
    ecs::entity_disabling::Disabled,
    prelude::{Allow, Discard, Entity, Local, MessageWriter, On, Query},
};

use crate::plugin::{
    authoring::{ClothOrder, Ordered},
    state::{ClothContacts, ClothState, ClothTouchStarted, ClothTouchStopped},
};

/// Sends messages of the difference between this tick and the last.
pub(crate) fn send_touch_messages(
    mut cloths: Query<(Entity, Option<&ClothOrder>, &ClothState, &mut ClothContacts)>,
    mut started: MessageWriter<ClothTouchStarted>,
    mut stopped: MessageWriter<ClothTouchStopped>,
    mut touching: Local<Vec<Ordered>>,
) {
    touching.clear();
    for (cloth, order, _, contacts) in &cloths {
        if !(contacts.now.is_empty() && contacts.reported.is_empty()) {
            touching.push((order.copied().unwrap_or_default(), cloth));
        }
    }
    touching.sort_unstable();
    let mut each = cloths.iter_many_mut(touching.iter().map(|(_, cloth)| cloth));
    while let Some((cloth, _, state, mut contacts)) = each.fetch_next() {
        let ClothContacts { now, reported, .. } = &mut *contacts;
        if !state.is_valid {
            now.clear();
        }
        for contact in now.iter() {
            let mut each = reported.iter_mut();
            if let Some(known) = each.find(|known| known.collider == contact.collider) {
                let deepest = &mut known.deepest_penetration;
                *deepest = deepest.max(contact.deepest_penetration);
                known.particles = known.particles.max(contact.particles);
            } else {
                reported.push(*contact);
                started.write(ClothTouchStarted {
                    cloth,
                    collider: contact.collider,
                    particles: contact.particles,
                    deepest_penetration: contact.deepest_penetration,
                });
            }
        }
        reported.retain(|reported| {
            let mut each = now.iter();
            let lasts = each.any(|contact| contact.collider == reported.collider);
            if !lasts {
                stopped.write(reported.stopped(cloth));
            }
            lasts
        });
    }
}

/// Ends the contacts of a cloth that is removed, and contacts that a game replaces, of a disabled cloth too.
pub(crate) fn send_stopped_messages(
    removed: On<Discard, ClothContacts>,
    contacts: Query<&ClothContacts, Allow<Disabled>>,
    mut stopped: MessageWriter<ClothTouchStopped>,
) {
    if let Ok(contacts) = contacts.get(removed.entity) {
        for reported in &contacts.reported {
            stopped.write(reported.stopped(removed.entity));
        }
    }
}
