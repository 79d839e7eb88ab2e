//! The bounds of a run: number of steps, wall clock, cancellation from outside.
//!
//! The clock also tells the pace: a run that has gone on for a while and would, from what it has done of its time,
//! take a multiple of its limit, is stopped there and then and says how long it would have taken.

use crate::error::StepError;
use crate::method::{TimePlan, Work};
use std::fmt;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Steps between two looks at the clock at most; a look costs about as much as a step of two coordinates.
const CLOCK_STRIDE: u64 = 64;
/// Steps that take longer [s] are each looked at.
const LONG_STEPS: Duration = Duration::from_millis(1);
/// Part of the limit, and time [s], after which the pace counts.
const PACE_AFTER: (f64, f64) = (0.1, 1.0);
/// So many times the limit a run may be estimated to take: the pace changes between flight and contact.
const PACE_BEYOND: f64 = 2.0;

/// A bound of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Number of attempted steps.
    Steps(u64),
    /// Wall clock [s].
    Time(f64),
    /// Wall clock [s], and the time that the whole run would have taken at its pace so far [s].
    Pace {
        /// The bound.
        limit: f64,
        /// The estimate.
        estimate: f64,
    },
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Bound::Steps(n) => write!(f, "{n} attempted steps are the limit"),
            Bound::Time(limit) => write!(f, "{limit:.3} s of wall time are the limit"),
            Bound::Pace { limit, estimate } => write!(
                f,
                "at this pace the run would take {estimate:.2e} s, where {limit:.3} s of wall time are the limit"
            ),
        }
    }
}

/// Counts attempted steps against a plan.
#[derive(Debug)]
pub(crate) struct Bounds {
    tries: u64,
    /// The attempt at which the clock is looked at next, and the attempts between two looks.
    next_look: u64,
    stride: u64,
    begin: Instant,
    looked: Instant,
    /// Time at the first look [s].
    start: Option<f64>,
}

impl Default for Bounds {
    fn default() -> Self {
        let now = Instant::now();
        Bounds {
            tries: 0,
            next_look: 0,
            stride: 1,
            begin: now,
            looked: now,
            start: None,
        }
    }
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
        self.tries += 1;
        let bound = if self.tries > plan.max_steps {
            Some(Bound::Steps(plan.max_steps))
        } else if let Some(limit) = plan.time_limit
            && self.tries > self.next_look
        {
            self.look(limit, plan.t_end, t)
        } else {
            None
        };
        let steps = work.steps;
        bound.map_or(Ok(()), |bound| Err(StepError::Timeout { t, steps, bound }))
    }

    /// Looks at the clock.
    #[cold]
    fn look(&mut self, limit: Duration, t_end: f64, t: f64) -> Option<Bound> {
        let now = Instant::now();
        self.stride = if now - self.looked > LONG_STEPS {
            1
        } else {
            (2 * self.stride).min(CLOCK_STRIDE)
        };
        self.looked = now;
        self.next_look = self.tries + self.stride - 1;
        let (spent, limit) = ((now - self.begin).as_secs_f64(), limit.as_secs_f64());
        let start = *self.start.get_or_insert(t);
        if spent >= limit {
            return Some(Bound::Time(limit));
        }
        let estimate = spent * (t_end - start) / (t - start);
        let known = spent >= PACE_AFTER.1.max(PACE_AFTER.0 * limit);
        (known && estimate > PACE_BEYOND * limit).then_some(Bound::Pace { limit, estimate })
    }

    /// Counts attempts that a library made on its own.
    pub(crate) fn add(&mut self, tries: u64) {
        self.tries += tries;
    }
}
