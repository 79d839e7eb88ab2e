//! The bounds of a run: number of steps, wall clock, cancellation from outside.

use crate::method::{StepError, TimePlan, Work};
use std::sync::atomic::Ordering;
use std::time::Instant;

/// Steps between two looks at the clock; a look costs about as much as a step of two coordinates.
const CLOCK_STRIDE: u64 = 64;

/// Counts attempted steps against a plan.
#[derive(Debug, Default)]
pub(crate) struct Bounds {
    tries: u64,
}

impl Bounds {
    /// Call before each attempt.
    #[inline]
    pub(crate) fn check(
        &mut self,
        plan: &TimePlan<'_>,
        t: f64,
        work: &Work,
    ) -> Result<(), StepError> {
        if plan.cancel.is_some_and(|c| c.load(Ordering::Relaxed)) {
            return Err(StepError::Interrupted { t });
        }
        let look = self.tries.is_multiple_of(CLOCK_STRIDE);
        self.tries += 1;
        if self.tries > plan.max_steps
            || (look && plan.deadline.is_some_and(|d| Instant::now() >= d))
        {
            return Err(StepError::Timeout {
                t,
                steps: work.steps,
            });
        }
        Ok(())
    }

    /// Counts attempts that a library made on its own.
    pub(crate) fn add(&mut self, tries: u64) {
        self.tries += tries;
    }
}
