//! Warnings about cloths that are simulated all the same: each is logged once, by name.

use bevy::prelude::{Entity, Query, Res, ResMut, Resource, warn};

use crate::plugin::naming::{Named, Part};

/// Notices that have yet to be logged, each with its cloth and its text.
#[derive(Resource, Debug, Default)]
pub(crate) struct Notices(Vec<(Entity, String)>);

impl Notices {
    /// Has a notice of a cloth be logged as the frame ends.
    pub fn add(&mut self, cloth: Entity, text: String) {
        self.0.push((cloth, text));
    }

    /// Whether there is anything to log.
    pub fn are_there(notices: Res<Self>) -> bool {
        !notices.0.is_empty()
    }
}

/// Which notices a cloth has been given: that a predicate holds for no particle, and that a tick takes longer than it lasts.
#[derive(Debug, Default)]
pub(crate) struct Noticed {
    /// Whether it was built, and not looked at since.
    pub is_due: bool,
    pub given: [bool; 2],
}

/// Logs the notices of a frame; equal texts in one line.
pub(crate) fn log_notices(mut notices: ResMut<Notices>, names: Query<Named>) {
    let mut all = std::mem::take(&mut notices.0);
    all.retain(|(cloth, _)| names.contains(*cloth));
    while let Some((cloth, text)) = all.first().cloned() {
        let Ok(name) = names.get(cloth) else {
            return;
        };
        let name = name.describe(Part::Cloth);
        match all.iter().filter(|(_, other)| *other == text).count() {
            1 => warn!("{name}: {text}"),
            alike => warn!("{name} and {} more: {text}", alike - 1),
        }
        all.retain(|(_, other)| *other != text);
    }
}
