//! Budget of processor time for a whole study.
//!
//! All threads of the process count, including set-up: meshes and modes are computed on several threads. A study checks
//! the remaining time before each piece; its record names the pieces that were left out, and its result is that of the
//! others. Pieces that an earlier start finished cost nothing.

use gearbench_integrators::clock::processor_time_of_all_threads;
use std::time::{Duration, Instant};

/// Name of the setting that lists omitted work of a study.
pub const NOT_TRIED: &str = "not tried within the budget";

/// A clock of the processor time of all threads; of wall time where the system reports no processor time.
#[derive(Clone, Copy, Debug)]
pub struct ProcessorClock {
    processor: Option<Duration>,
    wall: Instant,
}

impl ProcessorClock {
    /// Starts a clock at the present time.
    pub fn start() -> ProcessorClock {
        ProcessorClock {
            processor: processor_time_of_all_threads(),
            wall: Instant::now(),
        }
    }

    /// Time since the start of the clock.
    pub fn elapsed(&self) -> Duration {
        match (self.processor, processor_time_of_all_threads()) {
            (Some(from), Some(now)) => now.saturating_sub(from),
            _ => self.wall.elapsed(),
        }
    }
}

/// A bound on the processor time of a study.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    limit: Duration,
    clock: ProcessorClock,
}

impl Budget {
    /// A bound that counts from now.
    pub fn new(limit: Duration) -> Budget {
        Budget {
            limit,
            clock: ProcessorClock::start(),
        }
    }

    /// A budget without a bound.
    pub fn unlimited() -> Budget {
        Budget::new(Duration::MAX)
    }

    /// Remaining time; zero when the budget is spent.
    pub fn left(&self) -> Duration {
        self.limit.saturating_sub(self.clock.elapsed())
    }

    /// True if no time is left, so that no further piece may begin.
    pub fn is_spent(&self) -> bool {
        self.left().is_zero()
    }

    /// The budget in words.
    pub fn described(&self) -> String {
        format!(
            "{} s of processor time (--budget)",
            self.limit.as_secs_f64()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_spent_by_work() {
        assert!(Budget::new(Duration::ZERO).is_spent());
        assert!(!Budget::unlimited().is_spent());
        let budget = Budget::new(Duration::from_secs(1000));
        let before = budget.left();
        let x = (0..100_000).fold(0.5_f64, |x, _| std::hint::black_box((x + 1.0).sin()));
        assert!(x.is_finite() && budget.left() < before && !budget.is_spent());
    }
}
