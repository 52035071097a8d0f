//! The sub-steps in which a soft mesh bends.

/// Most sub-steps that a push is for.
pub(super) const MOST_AT_ONCE: u32 = 4;

/// The sub-steps of a tick in which a surface bends: one of a number of them, for all of them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BendingSchedule {
    stride: u32,
    /// Sub-steps that it has bent for, all from the first one on.
    done: u32,
}

impl BendingSchedule {
    /// It bends in one of `stride` sub-steps.
    pub fn new(stride: u32) -> Self {
        Self { stride, done: 0 }
    }

    /// From now on it bends in each sub-step.
    pub fn bend_in_each(&mut self) {
        self.stride = 1;
    }

    /// The same in a tick of forces, whose first and last kicks are halves: as many as the kick where it bends in each.
    pub fn times(&mut self, index: u32, count: u32) -> f32 {
        match index {
            _ if self.stride == 1 && (index == 0 || index == count) => 0.5,
            _ if self.stride == 1 => 1.0,
            _ if index == count => 0.0,
            _ => self.next(index, count) as f32,
        }
    }

    /// For how many sub-steps it bends in sub-step `index` of `count`: for a stride in the middle one of it. Then particles at rest
    /// have nearly no velocity between two strides.
    pub fn next(&mut self, index: u32, count: u32) -> u32 {
        let due = self.stride.min(count - self.done);
        if index < self.done + due / 2 {
            return 0;
        }
        // More, if the stride was shortened.
        let due = due.max(index + 1 - self.done);
        self.done += due;
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tick of forces bends for all of its sub-steps, too.
    #[test]
    fn forces_bend_for_each_sub_step() {
        for stride in 1..=MOST_AT_ONCE {
            for count in 1..=60 {
                let mut schedule = BendingSchedule::new(stride);
                let times = (0..=count).map(|index| schedule.times(index, count));
                assert_eq!(times.sum::<f32>(), count as f32, "{stride} {count}");
            }
        }
    }

    /// All sub-steps of a tick are bent for, each once, and none much earlier or later than it is due: from some sub-step on, in
    /// each.
    #[test]
    fn each_sub_step_is_bent_for_once() {
        for stride in 1..=MOST_AT_ONCE {
            for count in 1..=60 {
                for shortened in 0..=count {
                    let mut schedule = BendingSchedule::new(stride);
                    let mut bent = 0;
                    for index in 0..count {
                        if index == shortened {
                            schedule.bend_in_each();
                        }
                        let now = schedule.next(index, count);
                        assert!(now <= stride);
                        bent += now;
                        assert!(bent.abs_diff(index) <= stride);
                    }
                    assert_eq!(bent, count, "{stride}, {shortened} of {count}");
                }
            }
        }
    }
}
