//! The limits of a tick's work.

/// Work limits of a tick. Each particle adds [`MOST_WORK`]; the sum stays between the two limits of all. Each particle has at
/// least [`LEAST_WORK`], more than twice what the whole search at the beginning takes: 4 units a particle for a flat grid, 70 to
/// 190 for a crumpled one, 600 to 840 for an irregular mesh. A unit takes some 10 ns, 5 to 16 by scene, so a tick of up to 8,000
/// particles takes no more than about 0.2 s.
const MOST_WORK: usize = 1 << 16;
const LEAST_WORK_OF_ALL: usize = 1 << 22;
const MOST_WORK_OF_ALL: usize = 1 << 24;
pub(super) const LEAST_WORK: usize = 1 << 11;

/// Units of work for the features of two patches that are gathered, and for a feature that is compared with eight others.
pub(super) const WORK_OF_GATHERING: usize = 4;
pub(super) const WORK_OF_EIGHT: usize = 8;

/// Units of work for a listed pair that is measured, and for a contact that is listed and pushed.
pub(super) const WORK_OF_MEASURING: usize = 3;
pub(super) const WORK_OF_CONTACT: usize = 10;

/// Number of near features that are compared with another in a unit of work, to find those that others keep apart.
pub(super) const FEATURES_LEFT_OUT: usize = 8;

/// Units of work for an edge and a face that may cross, in f64.
pub(super) const WORK_OF_CROSSING: usize = 3;

/// The part of these limits for particles of patches that began inside each other: these have no guarantee to keep.
const OF_TANGLED: f32 = 1.0 / 16.0;

/// Largest number of listed pairs of features for each particle. Piles and twisted strips have 90.
pub(super) const MOST_LISTED: usize = 512;

/// The work and the events of a tick.
#[derive(Debug, Default, Clone, Copy)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Counts {
    /// Number of pairs of features that touched, for each particle of contacts: the most of any sub-step.
    pub touched: f32,
    /// Number of sub-steps, and the largest motion of a particle in one, as a fraction of the smallest thickness.
    /// Motion is relative to a particle in the middle of the first cloth.
    pub substeps: u32,
    pub motion: f32,
    /// Number of pairs of patches compared.
    pub compared: u32,
    /// Work left in the tick.
    pub work: usize,
    /// Whether no pair of the sub-step can have passed through each other. Pairs that pins force together may.
    pub is_certain: bool,
    /// Whether there was too much work: for the rest of the tick the cloths are stopped, or nothing is kept apart.
    pub is_lost: bool,
    /// Number of sub-steps of the tick in which that was so, or a pair was not certain.
    pub lost: u32,
}

impl Counts {
    /// Begins a tick of cloths with this many particles.
    pub fn new(particles: usize) -> Self {
        Self {
            work: most_work(particles),
            ..Self::default()
        }
    }

    /// Lowers the limit. A share of the particles, `tangled` (0 to 1), began inside each other.
    pub fn tighten(&mut self, particles: usize, tangled: f32) {
        let part = 1.0 - tangled * (1.0 - OF_TANGLED);
        self.work = self.work.min((part * most_work(particles) as f32) as usize);
    }

    /// Takes this much work from the rest.
    pub fn take(&mut self, work: usize) {
        self.work = self.work.saturating_sub(work);
    }
}

fn most_work(particles: usize) -> usize {
    let work = MOST_WORK.saturating_mul(particles);
    let work = work.clamp(LEAST_WORK_OF_ALL, MOST_WORK_OF_ALL);
    work.max(LEAST_WORK.saturating_mul(particles))
}
