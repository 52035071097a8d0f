//! Cloth that begins a tick deep inside a collider, which appeared or was teleported there.

use bevy::math::Vec3;

use crate::{
    cloth::{ClothParticles, LANES, MapInline, Slot, Surface},
    contact::{
        candidates::{Candidate, ContactBlock, ContactSettings},
        colliders::{ColliderShape, ColliderSubstep, MovingCollider, Nearest},
        friction::MAX_STEPS,
        particles::ContactResult,
    },
};

/// The nearest ways out tear a piece of cloth if they stretch a side of a triangle by more than this factor.
const TEARS: f32 = 1.1;

/// A piece is looked at if its deepest particle's centre is so deep inside, in spacings.
const DEEP: f32 = 0.25;

/// Speed on a common way (m/s), and the largest acceleration towards it (m/s²): against taut cloth it is a force, so it
/// stretches nothing far.
const SPEED: f32 = 0.18;
const ACCELERATION: f32 = 400.0;

/// Time in which the motion inside decays to 1/e (s).
const SLOWED_FOR: f32 = 0.1;

/// Largest number of particles by which the common way of a piece is chosen.
const SAMPLES: usize = 64;

/// In place of a lane, before the candidates are known.
const NOWHERE: u32 = u32::MAX;

/// The particles that leave colliders by another way than the nearest.
///
/// The nearest ways out of a ball in a curtain lead to both of its sides. They would stretch the cloth without end, and it
/// would whip. So all of a connected piece goes one way: along its mean normal or against it, or along the mean of the
/// nearest ways out, whichever is shortest for its deepest particle and ends inside no other collider. A piece that finds none, or that
/// hangs from a pin inside, is left alone.
#[derive(Debug, Default, Clone)]
pub(crate) struct Embedding {
    all: Vec<Embedded>,
    /// Depth of the deepest of them (m).
    deepest: f32,
    // Memory of `find`.
    inside: Vec<Inside>,
    /// For each particle, 1 + its index among those inside; 0 outside.
    index: Vec<u32>,
    pieces: Vec<Piece>,
}

/// A particle with its own way out of a collider.
#[derive(Debug, Clone, Copy)]
struct Embedded {
    /// The caller's ID of the collider.
    id: usize,
    particle: u32,
    slot: Slot,
    /// Its lane, counted through the contact blocks.
    place: u32,
    /// While it is hidden (1/kg).
    inverse_mass: f32,
    /// Direction of its way, in the cloth's frame; `None` to leave it alone.
    direction: Option<Vec3>,
}

/// A particle inside a collider.
#[derive(Debug, Clone, Copy)]
struct Inside {
    particle: u32,
    place: Vec3,
    /// Vector to the nearest place outside (m).
    out: Vec3,
    is_pinned: bool,
    /// Another of the same piece, or itself: the first of it in the end.
    piece: u32,
}

/// A connected piece of cloth inside a collider, by its first particle.
#[derive(Debug, Default, Clone, Copy)]
struct Piece {
    /// Area × normal (m²), and the sum of the nearest ways out (m).
    normal: Vec3,
    out: Vec3,
    count: usize,
    is_torn: bool,
    is_pinned: bool,
    direction: Option<Vec3>,
}

impl Embedding {
    /// Begins a tick.
    pub fn clear(&mut self) {
        self.all.clear();
        self.deepest = 0.0;
    }

    /// Finds the particles that leave a collider by another way than the nearest, among those found near it as the tick
    /// begins. `others` are all colliders near. Call it only for a collider that it did not touch in the last tick, or if it
    /// `was_embedded`: what touches deeper is squeezed.
    ///
    /// They are in pieces that their nearest ways out would tear, or push into another collider.
    pub fn find<'a>(
        &mut self,
        (id, collider): (usize, &MovingCollider),
        was_embedded: bool,
        found: &[u32],
        (surface, particles, particle_radius): (&Surface, &ClothParticles, f32),
        others: impl Iterator<Item = &'a MovingCollider> + Clone,
    ) {
        let begins_at = if was_embedded {
            0.0
        } else {
            particle_radius + DEEP * surface.spacing().shortest
        };
        // Only a half-space has one way out for all.
        if collider.shape == ColliderShape::HalfSpace
            || self.collect(collider, found, particles, particle_radius) <= begins_at
        {
            return;
        }
        self.connect(surface, particles);
        let others = others.filter(|other| *other != collider);
        for inside in &self.inside {
            let end = inside.place + inside.out;
            let is_blocked = inside.out.length() > surface.spacing().longest
                && is_in_another(others.clone(), end, inside.place);
            self.pieces[inside.piece as usize].is_torn |= is_blocked;
        }
        for piece in 0..self.pieces.len() {
            let Piece {
                count,
                is_torn,
                is_pinned,
                ..
            } = self.pieces[piece];
            if count > 0 && is_torn && !is_pinned {
                self.pieces[piece].direction =
                    self.choose(piece, collider, particle_radius, others.clone());
            }
        }
        let layout = particles.layout();
        for inside in self.inside.iter().filter(|inside| !inside.is_pinned) {
            let piece = &self.pieces[inside.piece as usize];
            if piece.is_torn {
                self.deepest = self.deepest.max(inside.out.length());
                self.all.push(Embedded {
                    id,
                    particle: inside.particle,
                    place: NOWHERE,
                    slot: layout.slot_of(inside.particle as usize),
                    inverse_mass: 0.0,
                    direction: piece.direction,
                });
            }
        }
    }

    /// Depth of the deepest of them as the tick began (m); 0 if there is none.
    pub fn deepest(&self) -> f32 {
        self.deepest
    }

    /// Collects the particles inside. Returns the largest depth (m).
    fn collect(
        &mut self,
        collider: &MovingCollider,
        found: &[u32],
        particles: &ClothParticles,
        particle_radius: f32,
    ) -> f32 {
        self.inside.clear();
        let (pose, mut deepest) = (collider.from, 0.0_f32);
        let shape = &collider.shape;
        let bounds = shape
            .is_geometry()
            .then(|| (pose.inverse(), shape.bounds()));
        for &particle in found {
            let place = particles.position_at(particle as usize);
            let is_beyond = bounds.is_some_and(|(inverse, [low, high])| {
                let local = inverse * place;
                local.max(low).min(high).distance(local) > particle_radius
            });
            if is_beyond {
                continue;
            }
            let Nearest { distance, normal } = collider.nearest(0.0, place);
            let depth = particle_radius - distance;
            if depth > 0.0 {
                deepest = deepest.max(depth);
                self.inside.push(Inside {
                    particle,
                    place,
                    out: normal * depth,
                    is_pinned: particles.is_pinned(particle as usize) == Some(true),
                    piece: 0,
                });
            }
        }
        // The result does not depend on the method of the search.
        self.inside.sort_unstable_by_key(|inside| inside.particle);
        deepest
    }

    /// Finds the connected pieces of what is inside, and whether their nearest ways out tear them.
    fn connect(&mut self, surface: &Surface, particles: &ClothParticles) {
        let spacing = surface.spacing().shortest;
        let Self {
            inside,
            index,
            pieces,
            ..
        } = self;
        index.resize(particles.len(), 0);
        for (at, one) in inside.iter_mut().enumerate() {
            one.piece = at as u32;
            index[one.particle as usize] = at as u32 + 1;
        }
        pieces.clear();
        pieces.resize(inside.len(), Piece::default());
        for face in surface.faces().all() {
            let corners = face.map_inline(|corner| index[corner as usize].checked_sub(1));
            let Some(at) = corners.into_iter().flatten().next() else {
                continue;
            };
            let places = face.map_inline(|corner| particles.position_at(corner as usize));
            let [a, b, c] = places;
            pieces[at as usize].normal += (b - a).cross(c - a) / 2.0;
            for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                let (Some(first), Some(second)) = (corners[i], corners[j]) else {
                    continue;
                };
                join(inside, first, second);
                let [first, second] = [first, second].map_inline(|at| inside[at as usize]);
                let side = first.place.distance(second.place).max(spacing);
                let ends = (first.place + first.out).distance(second.place + second.out);
                let is_pinned = first.is_pinned || second.is_pinned;
                let piece = &mut pieces[at as usize];
                piece.is_torn |= ends > TEARS * side && !is_pinned;
                piece.is_pinned |= is_pinned;
            }
        }
        for at in 0..inside.len() {
            let root = root_of(inside, at as u32);
            inside[at].piece = root;
            index[inside[at].particle as usize] = 0;
            let own = pieces[at];
            let piece = &mut pieces[root as usize];
            piece.count += 1;
            piece.out += inside[at].out;
            if root != at as u32 {
                piece.normal += own.normal;
                piece.is_torn |= own.is_torn;
                piece.is_pinned |= own.is_pinned;
            }
        }
    }

    /// The common way of a piece.
    fn choose<'a>(
        &self,
        piece: usize,
        collider: &MovingCollider,
        particle_radius: f32,
        others: impl Iterator<Item = &'a MovingCollider> + Clone,
    ) -> Option<Vec3> {
        let Piece {
            normal, out, count, ..
        } = self.pieces[piece];
        let members = || {
            let members = self.inside.iter();
            let own = members.filter(move |inside| inside.piece as usize == piece);
            own.step_by(count.div_ceil(SAMPLES))
        };
        let normal = normal.normalize_or_zero();
        let directions = [normal, -normal, out.normalize_or_zero()];
        let mut best = (f32::INFINITY, None);
        for direction in directions
            .into_iter()
            .filter(|direction| *direction != Vec3::ZERO)
        {
            let (mut longest, mut sampled, mut blocked) = (0.0_f32, 0, 0);
            for member in members() {
                sampled += 1;
                let far = distance_out(collider, member.place, direction, particle_radius);
                let end = |far: f32| member.place + direction * far;
                match far.filter(|far| !is_in_another(others.clone(), end(*far), member.place)) {
                    Some(far) => longest = longest.max(far),
                    None => blocked += 1,
                }
            }
            if 2 * blocked < sampled && longest < best.0 {
                best = (longest, Some(direction));
            }
        }
        best.1
    }

    /// The particles that do so for one collider.
    fn of(&self, id: usize) -> &[Embedded] {
        let [first, end] = self.range(id);
        &self.all[first..end]
    }

    fn range(&self, id: usize) -> [usize; 2] {
        // Callers count upwards.
        [id, id.saturating_add(1)].map_inline(|id| self.all.partition_point(|one| one.id < id))
    }

    /// Blocks of the particles that leave a collider by another way than the nearest.
    pub fn blocks(&self, id: usize) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.of(id).iter().map(|one| one.slot.block)
    }

    /// Notes where the candidates are among the contact blocks.
    pub fn note_places(&mut self, id: usize, candidates: &[Candidate]) {
        let [first, end] = self.range(id);
        for one in &mut self.all[first..end] {
            let key = one.particle;
            let at = candidates.binary_search_by_key(&key, |candidate| candidate.particle);
            one.place = at.map_or(NOWHERE, |at| candidates[at].place);
        }
    }

    /// Holds them in place while the collider pushes others, until [`push`](Self::push).
    pub fn hide(&mut self, id: usize, particles: &mut ClothParticles) {
        let [first, end] = self.range(id);
        for one in &mut self.all[first..end] {
            let block = &mut particles.blocks_mut()[one.slot.block];
            one.inverse_mass = block.inverse_mass(one.slot.lane);
            block.set_inverse_mass(one.slot.lane, 0.0);
        }
    }

    /// Moves them on along their ways. `contacts` are all blocks of candidates.
    pub fn push(
        &self,
        particles: &mut ClothParticles,
        contacts: &mut [ContactBlock],
        (id, of): (usize, &ColliderSubstep),
        settings: &ContactSettings,
    ) -> ContactResult {
        let mut found = ContactResult::default();
        let own = self.of(id);
        if own.is_empty() {
            return found;
        }
        let seconds = particles.substep();
        let (fastest, most) = (SPEED * seconds, ACCELERATION * seconds * seconds);
        for one in own {
            let block = &mut particles.blocks_mut()[one.slot.block];
            let lane = one.slot.lane;
            block.set_inverse_mass(lane, one.inverse_mass);
            let (place, displacement) = (block.position(lane), block.displacement(lane));
            let nearest = of.nearest(place);
            let depth = settings.particle_radius - nearest.distance;
            let in_contacts = one.place as usize;
            if let Some(contact) = contacts.get_mut(in_contacts / LANES) {
                let known = &mut contact.depth[in_contacts % LANES];
                *known = known.max(depth);
            }
            if depth.is_nan() || depth <= 0.0 {
                continue;
            }
            found.deepest = found.deepest.max(depth);
            let Some(direction) = one.direction else {
                continue;
            };
            let relative = displacement - of.surface_motion(place);
            let slowed = relative * (1.0 - seconds / (seconds + SLOWED_FOR));
            let faster = (fastest.min(depth) - slowed.dot(direction)).clamp(0.0, most);
            let push = slowed + direction * faster - relative;
            let pushed = place + push;
            block.set_position(lane, pushed);
            block.set_displacement(lane, displacement + push);
            (found.given).add(pushed - of.origin, push, one.inverse_mass);
            found.farthest_push = found.farthest_push.max(push.length());
        }
        found
    }
}

/// Whether a way from a place ends inside a collider that it does not begin in.
fn is_in_another<'a>(
    mut others: impl Iterator<Item = &'a MovingCollider>,
    end: Vec3,
    begin: Vec3,
) -> bool {
    let is_in = |other: &MovingCollider, place| other.nearest(0.0, place).distance < 0.0;
    others.any(|other| is_in(other, end) && !is_in(other, begin))
}

/// The first of a piece.
fn root_of(inside: &[Inside], mut at: u32) -> u32 {
    while inside[at as usize].piece != at {
        at = inside[at as usize].piece;
    }
    at
}

/// Makes two particles one piece.
fn join(inside: &mut [Inside], first: u32, second: u32) {
    let [first, second] = [first, second].map_inline(|at| root_of(inside, at));
    inside[first.max(second) as usize].piece = first.min(second);
}

/// Distance along a way to the surface (m), unless it is too far along the inside of a box.
fn distance_out(
    collider: &MovingCollider,
    place: Vec3,
    direction: Vec3,
    particle_radius: f32,
) -> Option<f32> {
    let mut gone = 0.0;
    for _ in 0..MAX_STEPS {
        let nearest = collider.nearest(0.0, place + direction * gone);
        let depth = particle_radius - nearest.distance;
        if depth <= 1.0e-3 * gone {
            return Some(gone);
        }
        gone += depth;
    }
    None
}
