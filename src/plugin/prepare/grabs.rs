//! Moves hands, and attaches particles to them.

use bevy::{
    ecs::{
        entity::Entity,
        lifecycle::Remove,
        observer::On,
        query::QueryData,
        system::{Commands, Query, Res},
    },
    math::{Vec2, Vec3},
    time::Time,
    transform::components::Transform,
};

use super::roots::Roots;
use crate::{
    cloth::{ClothError, ClothParticles, Pin, Surface},
    plugin::{
        authoring::{ClothAttachments, ClothGrab, ClothGrip},
        frame::ClothFrame,
        naming::Part,
        state::{ClothBuilt, ClothFault},
    },
};

/// Number of times that a hand is moved to where each pin lets it be.
const ROUNDS: usize = 16;

#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct HandQuery {
    entity: Entity,
    grab: &'static ClothGrab,
    grip: &'static mut ClothGrip,
    place: &'static mut Transform,
    fault: Option<&'static ClothFault>,
}

#[derive(QueryData)]
pub(crate) struct GrabbedQuery {
    built: &'static ClothBuilt,
    particles: &'static ClothParticles,
    frame: &'static ClothFrame,
    attachments: Option<&'static ClothAttachments>,
}

/// Moves each hand towards its target, and attaches the particle that it holds.
pub(crate) fn hold_cloths(
    mut hands: Query<HandQuery>,
    cloths: Query<GrabbedQuery>,
    roots: Roots,
    time: Res<Time>,
    mut commands: Commands,
) {
    for mut hand in &mut hands {
        let wanted = hand.grab.cloth;
        let cloth = cloths.get(hand.grip.cloth.unwrap_or(wanted)).ok();
        if let Some(held) = hand.grip.cloth {
            let is_there = |cloth: &GrabbedQueryItem| {
                held == wanted && cloth.particles.len() == hand.grip.lengths.len()
            };
            if !cloth.as_ref().is_some_and(is_there) || roots.jumps(held) {
                commands.entity(hand.entity).try_remove::<ClothGrab>();
                continue;
            }
        }
        let outcome = match cloth {
            Some(cloth) => hand.hold(&cloth, time.delta_secs(), &mut commands),
            None => Err(ClothError::NoSuchCloth { cloth: wanted }),
        };
        let known = hand.fault;
        ClothFault::report(&mut commands, hand.entity, known, Part::Grab, outcome);
    }
}

/// Lets go.
pub(crate) fn let_go(
    removed: On<Remove, ClothGrab>,
    mut hands: Query<(&mut ClothGrip, Option<&ClothFault>)>,
    mut cloths: Query<&mut ClothAttachments>,
    mut commands: Commands,
) {
    let Ok((mut grip, fault)) = hands.get_mut(removed.entity) else {
        return;
    };
    let held = grip.cloth.take();
    if let Some(mut attachments) = held.and_then(|cloth| cloths.get_mut(cloth).ok()) {
        attachments.detach(removed.entity);
    }
    ClothFault::report(&mut commands, removed.entity, fault, Part::Grab, Ok(()));
}

impl HandQueryItem<'_, '_> {
    /// Moves the hand, and keeps its particle attached to it.
    fn hold(
        &mut self,
        cloth: &GrabbedQueryItem,
        seconds: f32,
        commands: &mut Commands,
    ) -> Result<(), ClothError> {
        self.grab.validate()?;
        if !cloth.built.matches(cloth.particles) {
            // Not simulated yet.
            return Ok(());
        }
        if self.grip.cloth.is_none() {
            self.take_hold(cloth)?;
        }
        let step = self.grab.target - self.place.translation;
        let step = step.clamp_length_max(self.grab.speed * seconds);
        let to = self.place.translation + step;
        let place = self.within_reach(cloth, to + self.grip.offset) - self.grip.offset;
        if self.place.translation != place {
            self.place.translation = place;
        }
        let is_attached = (cloth.attachments).is_some_and(|known| known.has_target(self.entity));
        if self.grip.is_holding && !is_attached {
            let (hand, pin) = (self.entity, Pin::Index(self.grab.particle as usize));
            let mut cloth = commands.entity(self.grab.cloth);
            let mut attachments = cloth.entry::<ClothAttachments>();
            attachments
                .or_default()
                .and_modify(move |mut known| known.attach(pin, hand));
        }
        Ok(())
    }

    /// Measures how far the particle is from all others, and puts the hand at its target.
    fn take_hold(&mut self, cloth: &GrabbedQueryItem) -> Result<(), ClothError> {
        let (surface, particle) = (cloth.built.surface(), self.grab.particle as usize);
        Pin::Index(particle).validate(surface)?;
        let place = cloth.frame.to_world(cloth.particles.position_at(particle));
        *self.grip = ClothGrip {
            cloth: Some(self.grab.cloth),
            is_holding: cloth.particles.is_pinned(particle) == Some(false),
            lengths: lengths(surface, self.grab.particle),
            offset: place - self.grab.target,
        };
        *self.place = Transform::from_translation(self.grab.target);
        Ok(())
    }

    /// The place nearest to `place` where the particle is within reach of every pin, in the world (m): it is projected
    /// into the ball around each pin in turn, until it is in all of them.
    fn within_reach(&self, cloth: &GrabbedQueryItem, mut place: Vec3) -> Vec3 {
        let reach = 1.0 + self.grab.stretch;
        for _ in 0..ROUNDS {
            let mut is_within = true;
            for (pin, inverse_mass) in cloth.particles.inverse_masses().enumerate() {
                if inverse_mass > 0.0 || pin == self.grab.particle as usize {
                    continue;
                }
                let at = cloth.frame.to_world(cloth.particles.position_at(pin));
                let farthest = reach * self.grip.lengths[pin];
                if at.distance_squared(place) > farthest * farthest {
                    place = at + (place - at).clamp_length_max(farthest);
                    is_within = false;
                }
            }
            if is_within {
                break;
            }
        }
        place
    }
}

/// Distance of each particle from one of them at rest (m): straight on a surface that is flat and convex, along edges on
/// any other.
fn lengths(surface: &Surface, from: u32) -> Vec<f32> {
    match surface.flat() {
        Some(flat) => {
            let straight = |other| Vec2::from(flat.between(other, from as usize)).length();
            (0..surface.len()).map(straight).collect()
        }
        None => {
            let paths = surface.graph().distances([from].into_iter());
            paths.into_iter().map(|(path, _)| path).collect()
        }
    }
}
