//! When a cloth has come to rest.

use super::Stretch;

/// The speed that no particle of a cloth at rest has (m/s): a kinetic energy of 5·10⁻⁵ J/kg.
const SPEED: f32 = 0.01;

/// What the largest stretch of a cloth at rest changes by at most, a second.
const STRETCH_CHANGE: f32 = 0.01;

/// How long a cloth has to be calm before it sleeps (s).
const PATIENCE: f32 = 0.5;

/// How long a cloth has been at rest.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct Rest {
    calm: f32,
    /// The largest and the smallest stretch in that time.
    stretch: Option<(f32, f32)>,
}

impl Rest {
    /// Takes what the tick ended with: its length (s), the speed of the fastest particle (m/s), the stretch.
    pub fn observe(&mut self, seconds: f32, largest_speed: f32, stretch: Stretch) {
        let stretch = stretch.structural;
        let (low, high) = self.stretch.unwrap_or((stretch, stretch));
        let (low, high) = (low.min(stretch), high.max(stretch));
        if largest_speed < SPEED && high - low < STRETCH_CHANGE * PATIENCE {
            self.calm += seconds;
            self.stretch = Some((low, high));
        } else {
            *self = Self::default();
        }
    }

    /// Whether it has been long enough.
    pub fn is_asleep(&self) -> bool {
        self.calm >= PATIENCE
    }

    /// Wakes the cloth.
    pub fn disturb(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(ticks: u32, speed: f32, stretch: impl Fn(u32) -> f32) -> Rest {
        let mut rest = Rest::default();
        for tick in 0..ticks {
            let structural = stretch(tick);
            let stretch = Stretch {
                structural,
                bound: structural,
            };
            rest.observe(1.0 / 64.0, speed, stretch);
        }
        rest
    }

    #[test]
    fn sleeps_when_it_has_been_calm_long_enough() {
        assert!(!after(31, 0.009, |_| 0.1).is_asleep());
        assert!(after(32, 0.009, |_| 0.1).is_asleep());
        assert!(!after(640, 0.011, |_| 0.1).is_asleep(), "too fast");
        let creeping = |tick: u32| tick as f32 / 64.0 * 0.011;
        assert!(!after(640, 0.0, creeping).is_asleep(), "still stretching");
        let creeping = |tick: u32| tick as f32 / 64.0 * 0.009;
        assert!(after(32, 0.0, creeping).is_asleep());
        assert!(!after(64, f32::NAN, |_| 0.1).is_asleep());
        let mut rest = after(64, 0.0, |_| 0.1);
        rest.disturb();
        assert!(!rest.is_asleep());
    }
}
