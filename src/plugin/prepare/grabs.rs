//! Moves hands, and attaches particles to them.

use std::sync::Arc;

use bevy::{
    ecs::{entity_disabling::Disabled, query::QueryData},
    prelude::{
        Allow, ChildOf, Commands, DetectChanges, Entity, Has, Local, On, Query, Ref, Remove, Res,
        Time, Transform, Vec2, Vec3, World,
    },
};

use super::roots::Roots;
use crate::{
    cloth::{Cloth, ClothError, ClothParticles, Pin, Surface, TargetError},
    plugin::{
        authoring::{ClothAttachments, ClothGrab, ClothGrip},
        frame::{ClothFrame, unusable},
        naming::Part,
        state::{ClothBuilt, ClothFault, ClothScratch, ClothState},
    },
};

/// Number of times that a hand is moved to where each pin lets it be.
const ROUNDS: usize = 16;

/// Stretch of a spring at the held particle from which on the hand slows down, and at which it stops.
const SLOWS: f32 = 0.1;
const STOPS: f32 = 0.3;

#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct HandQuery {
    entity: Entity,
    grab: &'static ClothGrab,
    grip: &'static mut ClothGrip,
    place: &'static mut Transform,
    is_child: Has<ChildOf>,
    fault: Option<&'static ClothFault>,
}

#[derive(QueryData)]
pub(crate) struct GrabbedQuery {
    cloth: Ref<'static, Cloth>,
    built: &'static ClothBuilt,
    particles: &'static ClothParticles,
    frame: &'static ClothFrame,
    state: &'static ClothState,
    scratch: &'static ClothScratch,
    attachments: Option<&'static ClothAttachments>,
}

/// Memory of [`hold_cloths`], which is reused from tick to tick.
#[derive(Debug, Default)]
pub(crate) struct Holds {
    /// Cloth and particle of each hand, and the hand, sorted.
    order: Vec<(Entity, u32, Entity)>,
    /// Cloth and particle of each hand that has moved in this tick, and the particle's new place in the world (m).
    moved: Vec<(Entity, u32, Vec3)>,
    /// Place of each pin of one cloth in the world, and how far from there the held particle may be (m).
    reaches: Vec<(Vec3, f32)>,
}

/// Moves each hand towards its target, and attaches the particle that it holds. Of two hands on one cloth, the second
/// yields to where the first has moved.
pub(crate) fn hold_cloths(
    mut hands: Query<HandQuery>,
    cloths: Query<GrabbedQuery>,
    roots: Roots,
    time: Res<Time>,
    mut holds: Local<Holds>,
    mut commands: Commands,
) {
    holds.order.clear();
    holds.moved.clear();
    let order = hands
        .iter()
        .map(|hand| (hand.grab.cloth, hand.grab.particle, hand.entity));
    holds.order.extend(order);
    // Hands of one cloth move in the same order, whichever was spawned first.
    holds.order.sort_unstable();
    for index in 0..holds.order.len() {
        let (wanted, _, entity) = holds.order[index];
        let Ok(mut hand) = hands.get_mut(entity) else {
            continue;
        };
        if let Some(held) = hand.grip.cloth {
            if held != wanted || hand.grip.particle != hand.grab.particle {
                // It takes hold anew in the next tick.
                hand.grip.cloth = None;
                commands.queue(move |world: &mut World| detach(world, entity, held));
                continue;
            }
            let cloth = cloths.get(held);
            let is_there = cloth.is_ok_and(|cloth| {
                hand.follow_tear(cloth.built.surface());
                hand.has(&cloth, &roots)
            });
            if !is_there {
                commands.entity(entity).try_remove::<ClothGrab>();
                continue;
            }
        }
        let cloth = cloths.get(wanted).ok();
        let outcome = match cloth {
            _ if hand.is_child || wanted == entity => Err(TargetError::HandNotAlone.into()),
            Some(cloth) => hand.hold(&cloth, time.delta_secs(), &mut holds, &mut commands),
            None => Err(TargetError::NoSuchCloth { cloth: wanted }.into()),
        };
        ClothFault::report(&mut commands, entity, hand.fault, Part::Grab, outcome);
    }
}

/// Lets go, also of what is disabled.
pub(crate) fn let_go(
    removed: On<Remove, ClothGrab>,
    mut hands: Query<(&mut ClothGrip, Option<&ClothFault>), Allow<Disabled>>,
    mut cloths: Query<&mut ClothAttachments, Allow<Disabled>>,
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

fn detach(world: &mut World, hand: Entity, cloth: Entity) {
    if let Some(mut known) = world.get_mut::<ClothAttachments>(cloth) {
        known.detach(hand);
    }
}

/// Attaches a particle to a hand, if both are still there.
fn attach(world: &mut World, hand: Entity, cloth: Entity, particle: u32) {
    let holds = world
        .get::<ClothGrab>(hand)
        .is_some_and(|grab| grab.cloth == cloth);
    if let Ok(mut cloth) = world.get_entity_mut(cloth)
        && holds
    {
        let mut known = cloth.entry::<ClothAttachments>().or_default();
        known.get_mut().attach(Pin::Index(particle as usize), hand);
    }
}

impl GrabbedQueryItem<'_, '_> {
    /// Whether it has been simulated, and its `Cloth` is the same since then.
    fn is_built(&self) -> bool {
        let from = self.built.from.as_ref();
        self.built.matches(self.particles)
            && from.is_some_and(|from| from.changes.cloth == self.cloth.last_changed())
    }
}

impl HandQueryItem<'_, '_> {
    /// Takes over the surface if the one that it holds was torn or mended, and still has the particle.
    fn follow_tear(&mut self, surface: &Arc<Surface>) {
        let (grip, particle) = (&mut *self.grip, self.grab.particle);
        let is_known = Arc::ptr_eq(&grip.surface, surface);
        let parents = match is_known {
            true => None,
            false => surface.parents_in(&grip.surface),
        };
        if parents.is_some_and(|parents| parents.get(particle as usize) == Some(&particle)) {
            grip.surface = surface.clone();
            grip.lengths = lengths(surface, particle);
        }
    }

    /// Whether the surface is still the one that it holds, and does not jump.
    fn has(&self, cloth: &GrabbedQueryItem, roots: &Roots) -> bool {
        let carrier = cloth.state.attachments.targets.first();
        cloth.is_built()
            && Arc::ptr_eq(&self.grip.surface, cloth.built.surface())
            && !cloth.scratch.teleports
            && !roots.jumps(self.grab.cloth)
            && !carrier.is_some_and(|carrier| roots.jumps(*carrier))
    }

    /// Moves the hand, and keeps its particle attached to it.
    fn hold(
        &mut self,
        cloth: &GrabbedQueryItem,
        seconds: f32,
        holds: &mut Holds,
        commands: &mut Commands,
    ) -> Result<(), ClothError> {
        self.grab.validate()?;
        if !cloth.is_built() {
            return Ok(());
        }
        if !self.place.is_finite() {
            *self.place = Transform::from_translation(self.grab.target);
        }
        let is_attached = cloth
            .attachments
            .is_some_and(|known| known.has_target(self.entity));
        if self.grip.cloth.is_none() {
            self.take_hold(cloth, is_attached)?;
        }
        let particle = self.grab.particle as usize;
        let step = self.grab.target - self.place.translation;
        let speed = self.grab.speed * self.ease(cloth);
        let mut to = self.place.translation + step.clamp_length_max(speed * seconds);
        if is_attached {
            let offset = self.place.transform_point(self.grip.offset) - self.place.translation;
            let place = self.within_reach(cloth, to + offset, holds);
            holds
                .moved
                .push((self.grab.cloth, self.grab.particle, place));
            to = place - offset;
        } else if cloth.particles.is_pinned(particle) == Some(false) {
            self.grip.offset = self.offset(cloth)?;
            // It is attached where it is, and moves from the next tick on.
            to = self.place.translation;
            let (hand, held) = (self.entity, (self.grab.cloth, self.grab.particle));
            commands.queue(move |world: &mut World| attach(world, hand, held.0, held.1));
        }
        if self.place.translation != to {
            self.place.translation = to;
        }
        Ok(())
    }

    /// Measures how far the particle is from all others. A hand that holds nothing yet begins at its target.
    fn take_hold(&mut self, cloth: &GrabbedQueryItem, is_attached: bool) -> Result<(), ClothError> {
        let (surface, particle) = (cloth.built.surface(), self.grab.particle as usize);
        Pin::Index(particle).validate(surface)?;
        if !is_attached {
            self.place.translation = self.grab.target;
        }
        *self.grip = ClothGrip {
            cloth: Some(self.grab.cloth),
            particle: self.grab.particle,
            surface: surface.clone(),
            lengths: lengths(surface, self.grab.particle),
            offset: self.offset(cloth)?,
        };
        Ok(())
    }

    /// Where the particle is, in the hand's own frame.
    fn offset(&self, cloth: &GrabbedQueryItem) -> Result<Vec3, ClothError> {
        let place = cloth.particles.position_at(self.grab.particle as usize);
        let hand = self.place.compute_affine();
        let offset = hand.inverse().transform_point3(cloth.frame.to_world(place));
        offset
            .is_finite()
            .then_some(offset)
            .ok_or_else(|| unusable(hand))
    }

    /// Fraction of its speed at which it moves. It slows down while the springs at its particle are stretched.
    fn ease(&self, cloth: &GrabbedQueryItem) -> f32 {
        let place = |particle: u32| cloth.particles.position_at(particle as usize);
        let at = place(self.grab.particle);
        let beside = self.grip.surface.graph().of(self.grab.particle).iter();
        let stretches = beside.map(|(other, length)| place(*other).distance(at) / length - 1.0);
        let largest = stretches.fold(0.0, f32::max);
        ((STOPS - largest) / (STOPS - SLOWS)).clamp(0.0, 1.0)
    }

    /// A place near to `place` where the particle is within reach of every pin, in the world (m). It is projected into the
    /// ball around each pin in turn.
    fn within_reach(&self, cloth: &GrabbedQueryItem, mut place: Vec3, holds: &mut Holds) -> Vec3 {
        let masses = cloth.particles.inverse_masses().enumerate();
        let pins = masses.filter(|(pin, mass)| *mass == 0.0 && *pin != self.grab.particle as usize);
        let reach = 1.0 + self.grab.stretch;
        let moved = &holds.moved;
        let reaches = pins.map(|(pin, _)| {
            let moved = moved
                .iter()
                .find(|(of, particle, _)| *of == self.grab.cloth && *particle as usize == pin);
            let at = || cloth.frame.to_world(cloth.particles.position_at(pin));
            let at = moved.map_or_else(at, |(.., at)| *at);
            (at, reach * self.grip.lengths[pin])
        });
        holds.reaches.clear();
        holds.reaches.extend(reaches);
        for _ in 0..ROUNDS {
            let mut is_within = true;
            for &(at, farthest) in &holds.reaches {
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
