//! How long something has taken.

use bevy::platform::time::Instant;

/// Since `start` (ms).
pub(super) fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1.0e3
}
