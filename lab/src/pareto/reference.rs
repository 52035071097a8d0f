//! The motions that errors are measured against: small steps in f64, many of them.

use std::{
    num::NonZero,
    sync::{
        OnceLock,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use bevy::math::DVec3;

use super::{
    methods::{Player, Way},
    scenes::{Case, TICKS},
};
use crate::methods::Method;

/// Where all particles are at the end of each tick.
pub type Film = Vec<Vec<DVec3>>;

/// A case's motion as exact as it is known.
pub struct Reference {
    pub film: Film,
    /// Sub-steps a tick.
    pub substeps: u32,
    /// RMS distance to the same with half of the sub-steps (m).
    pub error: f64,
}

impl Reference {
    /// Doubles the sub-steps from `first` to `last` until that moves particles by `enough` (m) or less.
    fn new(case: &Case, [first, last]: [u32; 2], enough: f64) -> Self {
        let mut reference = Self {
            film: film(case, first),
            substeps: first,
            error: f64::INFINITY,
        };
        while reference.error > enough && reference.substeps < last {
            let substeps = 2 * reference.substeps;
            let film = film(case, substeps);
            let error = rms(&film, &reference.film);
            reference = Self {
                film,
                substeps,
                error,
            };
        }
        reference
    }

    /// Of each case, on as many threads as there are. `done` is called after each.
    pub fn all(
        cases: &[Case],
        substeps: [u32; 2],
        enough: f64,
        done: impl Fn() + Sync,
    ) -> Vec<Self> {
        let found: Vec<OnceLock<Self>> = cases.iter().map(|_| OnceLock::new()).collect();
        let next = AtomicUsize::new(0);
        let threads = thread::available_parallelism().map_or(1, NonZero::get);
        thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    while let index = next.fetch_add(1, Ordering::Relaxed)
                        && let Some(case) = cases.get(index)
                    {
                        found[index].get_or_init(|| Self::new(case, substeps, enough));
                        done();
                    }
                });
            }
        });
        found
            .into_iter()
            .map(|cell| cell.into_inner().expect("each was computed"))
            .collect()
    }
}

/// In f64, with this many sub-steps a tick.
fn film(case: &Case, substeps: u32) -> Film {
    let way = Way::Peer(Method::SmallSteps { substeps }, 1);
    let mut player: Player<f64> = Player::new(case, way);
    (0..TICKS)
        .map(|tick| {
            player.tick(tick);
            let mut positions = Vec::new();
            player.positions(&mut positions);
            positions
        })
        .collect()
}

/// RMS distance (m) of two motions, over all particles and ticks.
fn rms(a: &Film, b: &Film) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    let (sum, count) = pairs.fold((0.0, 0.0), |(sum, count), (a, b)| {
        (sum + a.distance_squared(*b), count + 1.0)
    });
    (sum / count).sqrt()
}
