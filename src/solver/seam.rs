//! Seams: stitches that hold particles of two cloths together.
//!
//! A stitch is a constraint of extended position-based dynamics (Macklin, Müller and Chentanez 2016): its point x and the
//! point Σ wᵢ xᵢ of the other side are no farther apart than a gap that closes, and at last in the same place. The springs of both
//! cloths are solved first, each cloth for itself. So a seam stretches the springs beside it by what the other cloth falls in a
//! sub-step, times its rows: as the square of the sub-step. By default, a cloth takes up to four times as many sub-steps, to
//! keep that within a tenth. To apply the last sub-step's force before the springs makes that
//! worse: the forces swing.

use bevy::math::{Isometry3d, Vec3};

use super::substepping::MAX_SUBSTEPS;
use crate::cloth::{ClothParticles, Slot, Stitch};

/// Largest speed at which a seam closes (m/s).
const CLOSING: f32 = 1.0;

/// Rounds of a sub-step, each forwards and backwards along the seam.
const ROUNDS: usize = 2;

/// The largest slope of the curve by which it closes, over that of a line.
const STEEPEST: f32 = 1.5;

/// The least part of a load that counts in the next tick.
const KEPT: f32 = 0.9;

/// The largest stretch that the load of a seam may leave in the springs beside it.
const GIVEN: f32 = 0.1;

/// A seam from tick to tick.
#[derive(Debug, Default, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Seam {
    /// The particles of both sides, each once: the place of the cloth, 0 or 1, and the particle.
    nodes: Vec<[u32; 2]>,
    threads: Vec<Thread>,
    /// For how long it has been closing (s).
    since: f32,
    /// The longest gap as it began (m).
    longest: f32,
    /// The largest acceleration by which springs moved a particle off the seam as the last tick ended (m/s²).
    load: f32,
    /// The same in the last sub-step.
    #[cfg_attr(feature = "serialize", serde(skip))]
    load_now: f32,
    #[cfg_attr(feature = "serialize", serde(skip))]
    states: Vec<State>,
    /// As the tick began.
    #[cfg_attr(feature = "serialize", serde(skip))]
    before: Vec<Thread>,
}

/// A stitch from sub-step to sub-step.
#[derive(Debug, Default, Clone, Copy)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct Thread {
    /// The nodes of its point and of those that this is sewn onto, and their weights: 1, and less than 0.
    nodes: [u32; 4],
    weights: [f32; 4],
    at: f32,
    share: f32,
    /// The gap as the seam began, and the one that is left (m).
    begin: f32,
    gap: f32,
    /// Force on the point in the last sub-step (N).
    pull: Vec3,
    /// Whether the gap has closed.
    is_closed: bool,
}

#[derive(Debug, Default, Clone, Copy)]
struct State {
    place: Vec3,
    /// As the sub-step began (m).
    before: Vec3,
    push: Vec3,
    inverse_mass: f32,
}

/// What a game asks of a seam.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SeamPull {
    /// Time to close (s).
    pub seconds: f32,
    /// Gap under a load (m per N/m).
    pub compliance: f32,
    /// The part of its length that is sewn.
    pub sewn: [f32; 2],
}

/// A cloth of a seam.
#[derive(Debug)]
pub(crate) struct SeamCloth<'a> {
    pub particles: &'a mut ClothParticles,
    /// From its frame to the common one; `None` if they are the same.
    pub to_common: Option<Isometry3d>,
    /// Whether nothing moves it, as if it sleeps.
    pub is_fixed: bool,
}

impl SeamCloth<'_> {
    fn slot(&self, particle: u32) -> Slot {
        self.particles.layout().slot_of(particle as usize)
    }

    fn own_vector(&self, vector: Vec3) -> Vec3 {
        match self.to_common {
            None => vector,
            Some(frame) => frame.rotation.inverse() * vector,
        }
    }
}

impl Thread {
    fn is_sewn(&self, [from, to]: [f32; 2]) -> bool {
        from <= self.at && self.at <= to && from < to
    }

    /// Its particles, with their weights.
    fn each<'a>(&self, states: &'a [State]) -> impl Iterator<Item = (&'a State, f32)> + use<'a> {
        let each = self.nodes.into_iter().zip(self.weights);
        each.map(|(node, weight)| (&states[node as usize], weight))
    }

    /// The sum of a vector of its particles, by their weights.
    fn sum(&self, states: &[State], part: fn(&State) -> Vec3) -> Vec3 {
        let each = self.each(states);
        each.map(|(state, weight)| weight * part(state)).sum()
    }

    /// The vector to its point (m).
    fn apart(&self, states: &[State]) -> Vec3 {
        // Pushes are far smaller than places.
        self.sum(states, |state| state.place) + self.sum(states, |state| state.push)
    }

    /// Its inverse mass (1/kg).
    fn inverse_mass(&self, states: &[State]) -> f32 {
        let each = self.each(states);
        each.map(|(state, weight)| weight * weight * state.inverse_mass)
            .sum()
    }

    /// How far springs have moved its lightest particle off the others in the sub-step (m). Where contact pushed them apart before does
    /// not count: more sub-steps would not change that.
    fn moved(&self, states: &[State]) -> f32 {
        let before = self.sum(states, |state| state.before);
        let lightest = (self.each(states)).map(|(state, weight)| weight.abs() * state.inverse_mass);
        let part = lightest.fold(0.0, f32::max) / self.inverse_mass(states);
        let moved = (self.apart(states).length() - before.length()) * part;
        // Not so for NaN, as of a cloth that is lost.
        if moved > 0.0 { moved } else { 0.0 }
    }

    /// Moves its particles by an impulse times a sub-step (kg m).
    fn push(&self, by: Vec3, states: &mut [State]) {
        for (&node, weight) in self.nodes.iter().zip(self.weights) {
            let state = &mut states[node as usize];
            state.push += weight * state.inverse_mass * by;
        }
    }

    /// Solves it once. `softness` is its compliance over the square of the sub-step (1/kg), `pulled` what it has been pushed by
    /// so far in the sub-step (kg m).
    fn solve(&self, allowed: f32, softness: f32, pulled: &mut Vec3, states: &mut [State]) {
        let apart = self.apart(states);
        let distance = apart.length();
        let excess = match allowed {
            // Nothing spreads from a cloth that is lost.
            _ if !distance.is_finite() => return,
            0.0 => apart,
            _ if distance > allowed => apart * (1.0 - allowed / distance),
            _ => return,
        };
        let resistance = self.inverse_mass(states) + softness;
        // Not of NaN, and what gives without end does not pull.
        if resistance > 0.0 && resistance < f32::INFINITY {
            let by = -(excess + softness * *pulled) / resistance;
            *pulled += by;
            self.push(by, states);
        }
    }
}

impl Seam {
    /// A seam that begins with particles at these places in a common frame (m). On one cloth, `is_one`, stitches of a particle
    /// to itself are left out.
    pub fn new(stitches: &[Stitch], places: [&[Vec3]; 2], is_one: bool) -> Self {
        let mut seam = Self::default();
        let mut known = std::collections::HashMap::new();
        for stitch in stitches {
            let each = stitch.onto.iter().zip(stitch.weights);
            let is_itself = |(&onto, weight): (&u32, f32)| weight > 0.0 && onto == stitch.point;
            if is_one && each.clone().any(is_itself) {
                continue;
            }
            let mut node = |side: u32, particle: u32| {
                let key = [if is_one { 0 } else { side }, particle];
                let new = seam.nodes.len() as u32;
                *known.entry(key).or_insert_with(|| {
                    seam.nodes.push(key);
                    new
                })
            };
            let mut thread = Thread {
                weights: [1.0, 0.0, 0.0, 0.0],
                at: stitch.at,
                share: stitch.share,
                ..Thread::default()
            };
            thread.nodes = [node(stitch.side, stitch.point); 4];
            for (index, (&onto, weight)) in each.enumerate() {
                if weight > 0.0 {
                    thread.nodes[index + 1] = node(1 - stitch.side, onto);
                    thread.weights[index + 1] = -weight;
                }
            }
            let own = places[stitch.side as usize][stitch.point as usize];
            let others = places[1 - stitch.side as usize];
            let each = stitch.onto.iter().zip(stitch.weights);
            let there: Vec3 = each.map(|(&of, weight)| weight * others[of as usize]).sum();
            thread.begin = own.distance(there);
            thread.gap = thread.begin;
            seam.longest = seam.longest.max(thread.begin);
            seam.threads.push(thread);
        }
        seam
    }

    /// Goes on from where another seam of the same cloths was.
    pub fn resume(&mut self, other: &Self) {
        (self.since, self.load) = (other.since, other.load);
    }

    /// Whether its particles are among as many of each cloth.
    pub fn is_of(&self, counts: [usize; 2]) -> bool {
        let exists = |[cloth, particle]: &[u32; 2]| {
            let count = counts.get(*cloth as usize);
            count.is_some_and(|count| (*particle as usize) < *count)
        };
        let is_node = |node: &u32| (*node as usize) < self.nodes.len();
        self.nodes.iter().all(exists)
            && self
                .threads
                .iter()
                .all(|thread| thread.nodes.iter().all(is_node))
    }

    /// How long it takes to close, at the speed that is allowed (s).
    fn duration(&self, pull: &SeamPull) -> f32 {
        pull.seconds.max(STEEPEST * self.longest / CLOSING)
    }

    /// Whether gaps of it are still closing.
    pub fn is_closing(&self, pull: &SeamPull) -> bool {
        let is_open = |thread: &Thread| !thread.is_closed && thread.is_sewn(pull.sewn);
        self.since < self.duration(pull) && self.threads.iter().any(|thread| thread.begin > 0.0)
            || self.threads.iter().any(is_open)
    }

    /// The pairs of particles that it joins: the place of the cloth, 0 or 1, and the particle.
    pub fn joined(&self) -> impl Iterator<Item = [[u32; 2]; 2]> + '_ {
        let node = |node: u32| self.nodes[node as usize];
        self.threads.iter().flat_map(move |thread| {
            let each = thread.nodes.iter().zip(thread.weights).skip(1);
            let used = each.filter(|(_, weight)| *weight != 0.0);
            used.map(move |(&onto, _)| [node(thread.nodes[0]), node(onto)])
        })
    }

    /// Begins a tick. A tick that is done again [restarts](Self::restart).
    pub fn begin(&mut self) {
        self.before.clone_from(&self.threads);
    }

    /// Goes back to where the tick began.
    pub fn restart(&mut self) {
        self.threads.clone_from(&self.before);
    }

    /// Ends a tick of this many seconds.
    pub fn end(&mut self, seconds: f32, pull: &SeamPull) {
        self.since = (self.since + seconds).min(self.duration(pull));
        // Asleep, nothing pulls. A load that swings does not change the sub-steps in each tick.
        if seconds > 0.0 {
            self.load = self.load_now.max(KEPT * self.load);
        }
    }

    /// Sub-steps of a tick of this many seconds in which its load stretches springs of this length (m) beside it by no more than it may:
    /// a sub-step moves a particle away from the next one by its acceleration, times the square of the sub-step.
    pub fn needed(&self, spacing: f32, seconds: f32) -> u32 {
        let wanted = seconds * (self.load / (GIVEN * spacing)).sqrt();
        (wanted.ceil() as u32).min(MAX_SUBSTEPS)
    }

    /// Closes its gaps at the end of a sub-step of `dt` (s), `seconds` after the tick began. Returns the largest push (m).
    pub fn close(
        &mut self,
        cloths: &mut [SeamCloth],
        pull: &SeamPull,
        seconds: f32,
        dt: f32,
    ) -> f32 {
        self.gather(cloths);
        let duration = self.duration(pull);
        let past = if duration > 0.0 {
            ((self.since + seconds) / duration).min(1.0)
        } else {
            1.0
        };
        // It begins and ends gently.
        let left = 1.0 - past * past * (3.0 - 2.0 * past);
        let Self {
            threads, states, ..
        } = self;
        let step = CLOSING * dt;
        for thread in threads.iter_mut() {
            if !thread.is_sewn(pull.sewn) {
                thread.is_closed = false;
                thread.gap = thread.apart(states).length();
                continue;
            }
            // What a soft seam gives is no gap.
            let given = thread.pull.length() * pull.compliance / thread.share;
            let allowed = (left * thread.begin).max(thread.gap - given - step);
            thread.gap = allowed.max(0.0);
            thread.is_closed = allowed <= 0.0;
        }
        let softness = pull.compliance / (dt * dt);
        let closed = threads.iter().filter(|thread| thread.is_closed);
        let moved = closed.map(|thread| thread.moved(states));
        self.load_now = moved.fold(0.0, f32::max) / (dt * dt);
        threads
            .iter_mut()
            .for_each(|thread| thread.pull = Vec3::ZERO);
        let mut solve = |thread: &mut Thread| {
            if thread.is_sewn(pull.sewn) {
                let mut pulled = thread.pull * dt * dt;
                let softness = softness / thread.share;
                thread.solve(thread.gap, softness, &mut pulled, states);
                thread.pull = pulled / (dt * dt);
            }
        };
        for _ in 0..ROUNDS {
            threads.iter_mut().for_each(&mut solve);
            threads.iter_mut().rev().for_each(&mut solve);
        }
        for thread in threads.iter_mut() {
            thread.gap = thread.apart(states).length();
        }
        let squares = states.iter().map(|state| state.push.length_squared());
        let farthest = squares.fold(0.0, f32::max).sqrt();
        self.scatter(cloths);
        farthest
    }

    fn gather(&mut self, cloths: &[SeamCloth]) {
        self.states.clear();
        self.states
            .extend(self.nodes.iter().map(|&[cloth, particle]| {
                let cloth = &cloths[cloth as usize];
                let Slot { block, lane } = cloth.slot(particle);
                let block = &cloth.particles.blocks()[block];
                let place = block.position(lane);
                let before = place - block.displacement(lane);
                let common = |place| cloth.to_common.map_or(place, |frame| frame * place);
                State {
                    place: common(place),
                    before: common(before),
                    push: Vec3::ZERO,
                    inverse_mass: match cloth.is_fixed {
                        true => 0.0,
                        false => block.inverse_mass(lane),
                    },
                }
            }));
    }

    fn scatter(&self, cloths: &mut [SeamCloth]) {
        for (&[cloth, particle], state) in self.nodes.iter().zip(&self.states) {
            if state.push == Vec3::ZERO {
                continue;
            }
            let cloth = &mut cloths[cloth as usize];
            let Slot { block, lane } = cloth.slot(particle);
            let by = cloth.own_vector(state.push);
            let block = &mut cloth.particles.blocks_mut()[block];
            block.set_position(lane, block.position(lane) + by);
            block.set_displacement(lane, block.displacement(lane) + by);
        }
    }
}
