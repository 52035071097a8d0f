//! How long a body has stayed where it is.

use bevy::prelude::{Isometry3d, Vec3};

use crate::plugin::frame::Shift;

/// A body is at rest when none of its points has moved by more than this distance (m) in this time (s). That is a third of
/// the speed at which Jolt lets bodies sleep.
const REACH: f32 = 5.0e-3;
const PATIENCE: f32 = 0.5;

/// How long a body has stayed where it is.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Stay {
    place: Option<Isometry3d>,
    seconds: f32,
}

impl Stay {
    /// Takes the place of a shape after a tick of this length. Its points are up to `extent` (m) from its origin.
    pub fn note(&mut self, place: Isometry3d, extent: f32, seconds: f32) {
        let is_near = self.place.is_some_and(|known| {
            let gone = Vec3::from(place.translation - known.translation).length();
            let turned = known.rotation.inverse() * place.rotation;
            gone + 2.0 * turned.xyz().length() * extent <= REACH
        });
        if is_near {
            self.seconds = (self.seconds + seconds).min(PATIENCE);
        } else {
            (self.place, self.seconds) = (Some(place), 0.0);
        }
    }

    /// The same in a world whose origin was shifted.
    pub fn shifted(self, shift: Shift) -> Self {
        Self {
            place: self.place.map(|place| shift.rigid(place, None)),
            ..self
        }
    }

    /// Whether it has been there for long enough to be at rest.
    pub fn is_long(&self) -> bool {
        self.seconds >= PATIENCE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Quat;

    const TICK: f32 = 1.0 / 64.0;

    fn settles_after(path: impl Fn(f32) -> Isometry3d, ticks: u32) -> bool {
        let mut stay = Stay::default();
        for tick in 0..ticks {
            stay.note(path(tick as f32 * TICK), 0.1, TICK);
        }
        stay.is_long()
    }

    /// 5 mm in half a second: the first place begins the wait, 32 ticks end it.
    #[test]
    fn what_moves_or_turns_does_not_settle() {
        let moves =
            |speed: f32| move |time: f32| Isometry3d::from_translation(Vec3::X * speed * time);
        let turns = |speed: f32| move |time: f32| Quat::from_rotation_y(speed * time).into();
        assert!(!settles_after(moves(0.0), 32) && settles_after(moves(0.0), 33));
        assert!(!settles_after(moves(0.0102), 640) && settles_after(moves(0.0098), 33));
        assert!(!settles_after(turns(0.105), 640) && settles_after(turns(0.095), 33));
        assert!(!settles_after(moves(f32::NAN), 640));
    }
}
