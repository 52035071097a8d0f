//! The number of sub-steps in a tick: a fixed number, or as few as hold a tolerance.

use bevy::reflect::Reflect;

use super::stretch::Stretch;

/// More would be a mistake in typing, and would hang the game.
pub(super) const MAX_SUBSTEPS: u32 = 10_000;

/// Fractions of the tolerance. Below the first there may be fewer sub-steps, above the last there are more, and the one
/// between is the aim then. The rest is for the unforeseeable; in the wide band between nothing changes.
const SLACK: f32 = 0.3;
const AIM: f32 = 0.5;
const TIGHT: f32 = 0.8;

/// Ticks in a row that have to be below before sub-steps become fewer, and the part that is left of them then.
const CALM_TICKS: u32 = 3;
const FEWER: f32 = 0.9;

/// Margin over the needs of ripples or loads, so that a small growth changes nothing; the fraction of them below which
/// a need counts as less, and the ticks in which it has to; and the largest multiples of the particles' need.
const MARGIN: f32 = 1.05;
const SLACKER: f32 = 0.75;
const SLACK_TICKS: u32 = 30;
const MOST_FOR_TAUT: u32 = 4;
const MOST_FOR_LOAD: u32 = 8;
const MOST_FOR_CONTACT: u32 = 16;

/// A collider that leaves more stretch unsolved than this asks for more sub-steps. Chains that give way so far let through what
/// is narrower than they are apart.
const STRETCHED: f32 = 0.1;

/// Fewer than this, and what moves within a tick is missed.
const FEWEST: u32 = 4;

/// Sub-steps in 1/60 s for each particle along a cloth's longer side: with fewer, chains that carry others stretch by more than
/// a few per cent (the lab's chart `hung`).
const FOR_EACH_PARTICLE: f32 = 1.0 / 3.0;

/// With this factor a roller of 2 to 220 times the mass of the strip that it lies across sags it as deep as its weight says, within
/// 4 % (`cargo test --test headless heavy`).
const FOR_LOAD: f32 = 12.0;

/// With a sub-step of this many seconds, strips of irregular meshes tear at 95 to 106 % of their strength. With one that is five times
/// as long, some tear at 85 % (`BEVY_DRAPE_LONG=1 cargo test --test headless its_strength`).
const STRESS_SUBSTEP: f32 = 1.0 / 1280.0;

/// The number of sub-steps in a tick. Cost grows in proportion to the sub-steps, and the error of the motion falls with
/// their square. Stretch that passes from chain to chain falls faster still, once there are enough.
#[derive(Reflect, Debug, Default, Clone, Copy, PartialEq)]
#[type_path = "bevy_drape"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub enum Substepping {
    /// As many as the cloth needs:
    ///
    /// - By its number of particles, [`Substepping::needed`]; or, for a soft cloth, as many as explicit forces need,
    ///   [`Solver::needed`](crate::solver::Solver::needed).
    /// - More where it is taut as a membrane, until ripples across its chains are resolved,
    ///   [`Stretch::ripple_substeps`].
    /// - More where a body lies on it, or where a mesh is denser than elsewhere, until it holds that, [`Stretch::load_substeps`].
    /// - Up to four times as many where a seam bears much, until the springs beside it are stretched by no more than a tenth.
    /// - At least 20 in 1/64 s for a mesh that may tear, [`ClothTearing`](crate::cloth::ClothTearing).
    /// - More where something that moves forces it over a collider's edges, so that it is stretched by far more than its
    ///   material gives, or an edge goes deep into it in one sub-step, [`Stretch::contact_substeps`]. That tick is repeated, before the
    ///   game sees it.
    #[default]
    Automatic,
    /// This number of sub-steps per tick, from 1 to 10,000.
    Fixed(u32),
    /// As few as keep the largest stretch of a structural spring within a tolerance. A tick that ends beyond the
    /// tolerance is repeated with more sub-steps, before the game sees it.
    Adaptive {
        /// Largest allowed stretch, length / rest length − 1: 0.01 is one per cent. Positive.
        stretch: f32,
        /// Largest number of sub-steps in a tick, including repeated ones, from 1 to 10,000. If they don't suffice, or
        /// the material itself stretches more, the log says so:
        /// [`ClothLimit::Tolerance`](crate::solver::ClothLimit::Tolerance).
        max_substeps: u32,
    },
}

impl Substepping {
    /// Number of sub-steps in a tick of `seconds` for a cloth with this number of particles along its longer side. It
    /// is one for three particles in 1/60 s, from 4 to 10,000.
    pub fn needed(particles: usize, seconds: f32) -> u32 {
        let wanted = FOR_EACH_PARTICLE * particles as f32 * seconds * 60.0;
        (wanted.ceil() as u32).clamp(FEWEST, MAX_SUBSTEPS)
    }

    /// Number of sub-steps in a tick of `seconds` that holds a body under `gravity` (m/s²). The body is `ratio` times
    /// as heavy as the particles, `spacing` apart (m), of the chains that carry it.
    ///
    /// The regularisation of a chain's equations gives way by 2 ε w T Δt² under its pull T, between particles of the
    /// inverse mass w at the distance h. As a fraction of h, that is in proportion to `r g Δt²/h`, with the ratio r and
    /// gravity g. It is also in proportion to one over the slope of the chain, which grows with the cube root of the
    /// weight.
    pub(crate) fn for_load(ratio: f32, gravity: f32, spacing: f32, seconds: f32) -> f32 {
        FOR_LOAD * (ratio * gravity * seconds * seconds / spacing).cbrt()
    }

    /// Number of sub-steps in a tick of `seconds` after which the springs of a mesh bear its load in equal shares, to some 5 % in
    /// patches of it. So a mesh tears at its strength.
    pub(crate) fn for_stress(seconds: f32) -> u32 {
        ((seconds / STRESS_SUBSTEP).ceil() as u32).min(MAX_SUBSTEPS)
    }

    /// Number of sub-steps in a tick for a cloth that a collider forces over its edges. 0 if `substeps` were enough.
    ///
    /// The stretch that they left `unsolved` falls about as their number to the power of −¾ (measured with sticks of 1 to 4 cm).
    /// The depth of contact before a push, `depths` times the distance at which edges touch, falls as their number. If it
    /// is more than one, an edge is through a triangle as a sub-step ends.
    pub(crate) fn for_contact(unsolved: f32, depths: f32, substeps: u32) -> f32 {
        let for_stretch = match 2.0 * unsolved / STRETCHED {
            twice if twice > 2.0 => twice * twice.cbrt(),
            _ => 0.0,
        };
        let for_depth = if depths > 1.0 { depths } else { 0.0 };
        substeps as f32 * f32::max(for_stretch, for_depth)
    }
}

/// Chooses the number of sub-steps of each tick.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct Control {
    /// For the coming tick. 0 before the first.
    substeps: f32,
    /// Sub-steps of this tick so far that are repeated.
    spent: f32,
    /// The stretch a tick ago.
    before: f32,
    /// Ticks in a row for which fewer would have done.
    calm: u32,
    /// Whether the last tick ended beyond the tolerance.
    is_beyond: bool,
    /// For the tension of the ticks before, and for what lay on it.
    taut: Demand,
    loaded: Demand,
    /// For what a collider stretched.
    stretched: Demand,
    /// Sub-steps that the particles need.
    least: u32,
}

/// Sub-steps that something in the ticks before asked for.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct Demand {
    substeps: f32,
    /// Ticks in a row that asked for much less.
    slack: u32,
}

impl Demand {
    fn observe(&mut self, wanted: f32) {
        let is_slack = wanted < SLACKER * self.substeps;
        self.slack = if is_slack { self.slack + 1 } else { 0 };
        if wanted > self.substeps || self.slack == SLACK_TICKS {
            *self = Self {
                substeps: (MARGIN * wanted).ceil(),
                slack: 0,
            };
        }
    }

    /// At least `needed` sub-steps, and at most `times` as many.
    fn needed(self, needed: u32, times: u32) -> u32 {
        let most = needed.saturating_mul(times).min(MAX_SUBSTEPS);
        needed.max((self.substeps as u32).min(most))
    }
}

impl Control {
    /// Number of sub-steps for the coming tick of a cloth that [needs](Substepping::needed) at least `needed`.
    pub fn substeps(&mut self, substepping: Substepping, needed: u32) -> u32 {
        match substepping {
            Substepping::Automatic => {
                let substeps = self.asked(needed);
                *self = Self {
                    substeps: substeps as f32,
                    taut: self.taut,
                    loaded: self.loaded,
                    stretched: self.stretched,
                    least: needed,
                    ..Self::default()
                };
                substeps
            }
            Substepping::Fixed(substeps) => {
                *self = Self {
                    substeps: substeps as f32,
                    ..Self::default()
                };
                substeps
            }
            Substepping::Adaptive { max_substeps, .. } => {
                // Fewer sub-steps would leave much unsolved, which comes back in the change to more.
                let fewest = self.asked(needed).min(max_substeps) as f32;
                self.substeps = self.substeps.clamp(fewest, max_substeps as f32).ceil();
                self.spent = 0.0;
                self.substeps as u32
            }
        }
    }

    /// Number of sub-steps for ripples, loads and colliders, if the particles need `needed`.
    fn asked(&self, needed: u32) -> u32 {
        let taut = self.taut.needed(needed, MOST_FOR_TAUT);
        let loaded = self.loaded.needed(needed, MOST_FOR_LOAD);
        let stretched = self.stretched.needed(needed, MOST_FOR_CONTACT);
        taut.max(loaded).max(stretched)
    }

    fn note_demands(&mut self, stretch: &Stretch) {
        self.taut.observe(stretch.ripple_substeps);
        self.loaded.observe(stretch.load_substeps);
        self.stretched.observe(stretch.contact_substeps);
    }

    /// Number of sub-steps with which a tick is repeated in which a collider stretched the cloth.
    fn again(&mut self) -> Option<u32> {
        let wanted = self.stretched.needed(self.least, MOST_FOR_CONTACT);
        let is_more = wanted as f32 > 1.5 * self.substeps;
        is_more.then(|| {
            self.substeps = wanted as f32;
            wanted
        })
    }

    /// Takes the stretch at the end of the tick. If the tick has to be repeated, returns the number of sub-steps for
    /// that.
    pub fn observe(&mut self, substepping: Substepping, stretch: Stretch) -> Option<u32> {
        let Substepping::Adaptive {
            stretch: tolerance,
            max_substeps,
        } = substepping
        else {
            self.note_demands(&stretch);
            return match substepping {
                Substepping::Automatic => self.again(),
                _ => None,
            };
        };
        let max = max_substeps as f32;
        let found = stretch.structural;
        // Solved chains stretch less with more than the square of the sub-steps: the cube is a cautious guess.
        let substeps = self.substeps;
        let wanted = |stretch: f32| substeps * (stretch / (AIM * tolerance)).cbrt();
        // Sub-steps can't remove the stretch of the material at its tension.
        let unsolved = found - stretch.material.min(found);
        self.is_beyond = found > tolerance;
        if self.is_beyond && unsolved > AIM * tolerance {
            let least = (self.substeps * 1.25).ceil();
            let more = wanted(unsolved).clamp(least, self.substeps * 2.0);
            let left = max - self.spent - self.substeps;
            if left >= least {
                let more = more.min(left);
                self.spent += self.substeps;
                self.substeps = more.ceil();
                self.calm = 0;
                return Some(self.substeps as u32);
            }
            self.substeps = more.min(max);
        }
        // Its growth in this tick may repeat in the next.
        let foreseen = unsolved + (unsolved - self.before).max(0.0);
        if foreseen > TIGHT * tolerance {
            self.substeps = wanted(foreseen).clamp(self.substeps, self.substeps * 2.0);
            self.calm = 0;
        } else if foreseen < SLACK * tolerance {
            self.calm += 1;
            if self.calm == CALM_TICKS {
                self.substeps = (self.substeps * FEWER).floor();
                self.calm = 0;
            }
        } else {
            self.calm = 0;
        }
        self.before = unsolved;
        self.note_demands(&stretch);
        None
    }

    /// Whether the last tick ended beyond the tolerance: for want of sub-steps, or since the material gives more.
    pub fn is_beyond(&self) -> bool {
        self.is_beyond
    }
}

#[cfg(test)]
mod tests;
