//! The measurements of a run, alike for all solvers.

use bevy::math::DVec3;
use bevy_drape::cloth::SpringKind;

use crate::{collider::depths, scene::Scene, shared::exact::Exact};

/// Places of all particles (m).
pub type Places = Vec<[f32; 3]>;

/// CPU time of all threads in a frame (ms).
#[derive(Debug, Clone, Copy)]
pub struct Milliseconds {
    pub mean: f64,
    /// The 99th percentile of all frames, and the longest; NaN where only the mean is known.
    pub p99: f64,
    pub max: f64,
}

impl Milliseconds {
    pub fn new(mut frames: Vec<f64>) -> Self {
        frames.sort_by(f64::total_cmp);
        let count = frames.len();
        Self {
            mean: frames.iter().sum::<f64>() / count as f64,
            p99: frames[count * 99 / 100],
            max: frames[count - 1],
        }
    }

    pub fn mean_only(mean: f64) -> Self {
        Self {
            mean,
            p99: f64::NAN,
            max: f64::NAN,
        }
    }
}

/// A run of a scene by a solver.
pub struct Play {
    pub ms: Milliseconds,
    /// After half a second.
    pub compared: Places,
    /// In each of the last frames.
    pub last: Vec<Places>,
}

/// The result of a run.
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    pub ms: f64,
    /// Of springs along rows and columns in the last second, as parts of their length.
    pub max_stretch: f64,
    pub rms_stretch: f64,
    /// RMS distance from the reference after half a second (m).
    pub off: Option<f64>,
    /// How deep triangles are in the ball, at most, in the last second (m).
    pub depth: Option<f64>,
}

impl Play {
    pub fn outcome(&self, scene: &Scene, reference: Option<&Exact>) -> Outcome {
        let sheet = scene.sheet_of(scene.compliance, 0);
        let threads: Vec<_> = sheet
            .springs
            .iter()
            .filter(|spring| spring.kind == SpringKind::Structural)
            .map(|spring| (spring.ends, f64::from(spring.rest_length)))
            .collect();
        let [max_stretch, rms_stretch] = stretch(&self.last, &threads);
        let told = scene.told(0);
        // The ball stands still.
        let depths = self.last.iter().map(|places| {
            let [_, of_triangles] = depths(places, &told.triangles, &told.colliders, 0.0);
            of_triangles
        });
        let deepest = depths.fold(0.0, larger);
        Outcome {
            ms: self.ms.mean,
            max_stretch,
            rms_stretch,
            off: reference
                .map(|reference| reference.distance(self.compared.iter().map(|at| exact(*at)))),
            depth: scene.ball.map(|_| deepest),
        }
    }
}

/// The largest and the RMS stretch of springs, of their ends and rest lengths (m), in all frames; NaN where it blew up.
pub fn stretch(frames: &[Places], springs: &[([u32; 2], f64)]) -> [f64; 2] {
    let (mut largest, mut squares) = (f64::NEG_INFINITY, 0.0);
    for places in frames {
        for (ends, length) in springs {
            let [a, b] = ends.map(|end| exact(places[end as usize]));
            let stretch = a.distance(b) / length - 1.0;
            largest = larger(largest, stretch);
            squares += stretch * stretch;
        }
    }
    let count = (frames.len() * springs.len()) as f64;
    [largest, f64::sqrt(squares / count)]
}

/// The larger of two, or NaN.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// The median of some values, of which NaN is the largest.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    // Whatever its sign.
    values.sort_by(|a, b| a.is_nan().cmp(&b.is_nan()).then(a.total_cmp(b)));
    values[values.len() / 2]
}

pub fn exact(place: [f32; 3]) -> DVec3 {
    DVec3::from_array(place.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_hides_a_blow_up() {
        let springs = [([0, 1], 1.0), ([1, 2], 2.0)];
        let still = vec![[0.0; 3], [1.5, 0.0, 0.0], [1.5, 2.0, 0.0]];
        let [largest, rms] = stretch(std::slice::from_ref(&still), &springs);
        assert_eq!(largest, 0.5);
        assert!((rms - (0.25_f64 / 2.0).sqrt()).abs() < 1.0e-12);
        let gone = vec![[0.0; 3], [f32::NAN; 3], [0.0; 3]];
        let both = stretch(&[gone, still], &springs);
        assert!(both.iter().all(|stretch| stretch.is_nan()));
        assert_eq!(median([3.0, f64::NAN, 1.0]), 3.0);
        assert!(median([f64::NAN, -f64::NAN, 1.0]).is_nan());
    }

    #[test]
    fn the_longest_frames_are_told() {
        let ms = Milliseconds::new((0..200).map(f64::from).rev().collect());
        assert_eq!([ms.mean, ms.p99, ms.max], [99.5, 198.0, 199.0]);
    }
}
