//! Connected pieces of cloth inside a collider, and their ways out.

use bevy::math::Vec3;

use crate::{
    cloth::{ClothParticles, MapInline, Surface},
    contact::{
        colliders::{MovingCollider, Nearest},
        friction::MAX_STEPS,
    },
};

/// The nearest ways out tear a piece of cloth if they stretch a side of a triangle by more than this factor.
const TEARS: f32 = 1.1;

/// Largest number of particles by which the common way of a piece is chosen.
const SAMPLES: usize = 64;

/// The particles inside a collider, and the pieces that they are in.
#[derive(Debug, Default, Clone)]
pub(super) struct Pieces {
    inside: Vec<Inside>,
    /// For each particle, 1 + its index among those inside; 0 outside.
    index: Vec<u32>,
    all: Vec<Piece>,
}

/// A particle inside a collider.
#[derive(Debug, Clone, Copy)]
pub(super) struct Inside {
    pub particle: u32,
    place: Vec3,
    /// Vector to the nearest place outside (m).
    pub out: Vec3,
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

impl Pieces {
    /// Collects the particles inside. Returns the largest depth (m).
    pub fn collect(
        &mut self,
        collider: &MovingCollider,
        found: &[u32],
        particles: &ClothParticles,
        particle_radius: f32,
    ) -> f32 {
        self.inside.clear();
        let (pose, mut deepest) = (collider.from, 0.0_f32);
        let shape = &collider.shape;
        let bounds = (shape.is_geometry()).then(|| (pose.inverse(), shape.bounds()));
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

    /// Finds the pieces, which of them their nearest ways out would tear or push into another collider, and a common way for each of
    /// these.
    pub fn find_ways<'a>(
        &mut self,
        collider: &MovingCollider,
        surface: &Surface,
        particles: &ClothParticles,
        particle_radius: f32,
        others: impl Iterator<Item = &'a MovingCollider> + Clone,
    ) {
        self.connect(surface, particles);
        for inside in &self.inside {
            let end = inside.place + inside.out;
            let is_blocked = inside.out.length() > surface.spacing().longest
                && is_in_another(others.clone(), end, inside.place);
            self.all[inside.piece as usize].is_torn |= is_blocked;
        }
        for piece in 0..self.all.len() {
            let own = self.all[piece];
            if own.count > 0 && own.is_torn && !own.is_pinned {
                self.all[piece].direction =
                    self.choose(piece, collider, particle_radius, others.clone());
            }
        }
    }

    /// The free particles of pieces that the nearest ways out tear, and the way of each piece, if it has one.
    pub fn torn(&self) -> impl Iterator<Item = (&Inside, Option<Vec3>)> {
        let free = self.inside.iter().filter(|inside| !inside.is_pinned);
        free.filter_map(|inside| {
            let piece = &self.all[inside.piece as usize];
            piece.is_torn.then_some((inside, piece.direction))
        })
    }

    /// Finds the connected pieces of what is inside, and whether their nearest ways out tear them.
    fn connect(&mut self, surface: &Surface, particles: &ClothParticles) {
        let spacing = surface.spacing().shortest;
        let Self {
            inside,
            index,
            all: pieces,
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
        let of = self.all[piece];
        let members = || {
            let members = self.inside.iter();
            let own = members.filter(move |inside| inside.piece as usize == piece);
            own.step_by(of.count.div_ceil(SAMPLES))
        };
        let normal = of.normal.normalize_or_zero();
        let directions = [normal, -normal, of.out.normalize_or_zero()];
        let mut best = (f32::INFINITY, None);
        for direction in directions.into_iter().filter(|way| *way != Vec3::ZERO) {
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
