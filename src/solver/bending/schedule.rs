//! The sub-steps in which a soft mesh bends.

/// Most sub-steps that a push is for.
pub(super) const MOST_AT_ONCE: u32 = 4;

/// The sub-steps of a tick in which a surface bends: one of a number of them, for all of them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BendingSchedule {
    stride: u32,
    /// Whether it began with a stride of more than one.
    is_strided: bool,
    /// Sub-steps that it has bent for, all from the first one on.
    done: u32,
}

impl BendingSchedule {
    /// It bends in one of `stride` sub-steps.
    pub fn new(stride: u32) -> Self {
        Self {
            stride,
            is_strided: stride > 1,
            done: 0,
        }
    }

    /// From now on it bends in each sub-step.
    pub fn bend_in_each(&mut self) {
        self.stride = 1;
    }

    /// The same in a tick of explicit springs, whose first and last kicks are for half a sub-step: as the kick, where it bends in each.
    pub fn for_kick(&mut self, index: u32, count: u32) -> f32 {
        match (self.is_strided, index) {
            (true, index) if index == count => 0.0,
            (true, index) => self.next(index, count) as f32,
            (false, index) if index == 0 || index == count => 0.5,
            (false, _) => 1.0,
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

    /// A tick of explicit springs bends for all of its sub-steps, too.
    #[test]
    fn forces_bend_for_each_sub_step() {
        for stride in 1..=MOST_AT_ONCE {
            for count in 1..=60 {
                for shortened in 0..=count {
                    let mut schedule = BendingSchedule::new(stride);
                    let kicks = (0..=count).map(|index| {
                        if index == shortened {
                            schedule.bend_in_each();
                        }
                        schedule.for_kick(index, count)
                    });
                    let all = kicks.sum::<f32>();
                    assert_eq!(all, count as f32, "{stride}, {shortened} of {count}");
                }
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
