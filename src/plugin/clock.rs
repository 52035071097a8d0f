//! Time measurement.

use bevy::platform::time::Instant;

/// Time since `start` (ms).
pub(crate) fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1.0e3
}
