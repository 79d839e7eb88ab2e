//! The bounds of a run: number of steps, processor time, cancellation from outside.
//!
//! A bound of time counts the processor time of a run: the integration and its observers, which may take longer than
//! the integration itself. Other work on the machine does not count. The share of the observers ([`Sink::spent`]) is
//! reported where a bound is reached; it is their share of the wall time, because reading the processor clock twice in
//! every step would cost as much as a step of two coordinates.
//!
//! The clock also gives the pace: a run that has gone on for a while and would, from what it has done of its time,
//! take a multiple of its limit, is stopped there and then with an estimate of how long it would have taken.

use crate::clock::processor_time;
use crate::error::StepError;
use crate::method::{Sink, TimePlan, Work};
use std::fmt;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Largest number of steps between two readings of the clock; one reading costs about as much as a step of two
/// coordinates.
const CLOCK_STRIDE: u64 = 64;
/// Duration of a step [s] above which the clock is read after every step.
const LONG_STEPS: Duration = Duration::from_millis(1);
/// Fraction of the limit, and time [s], after which the duration of the run is extrapolated.
const PACE_AFTER: (f64, f64) = (0.1, 1.0);
/// Ratio of the extrapolated duration to the limit above which a run is stopped. The pace changes between flight and
/// contact, hence a margin.
const PACE_BEYOND: f64 = 2.0;
/// Share of the observers from which on it is reported.
const REPORTED_SHARE: f64 = 0.05;

/// A bound of a run that was reached, or that the run would exceed at its present pace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Largest number of attempted steps.
    Steps(u64),
    /// Limit of the processor time.
    Time {
        /// Limit of the processor time [s].
        limit: f64,
        /// Share of the observers in the processor time [-].
        observers: f64,
    },
    /// Limit of the processor time [s], which the run would exceed at its present pace.
    Pace {
        /// Limit of the processor time [s].
        limit: f64,
        /// Estimated processor time of the whole run [s].
        estimate: f64,
        /// Share of the observers in the processor time [-].
        observers: f64,
    },
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of_observers = match self {
            Bound::Steps(n) => return write!(f, "{n} attempted steps are the limit"),
            Bound::Time { limit, observers } => {
                write!(f, "{limit:.3} s of processor time are the limit")?;
                observers
            }
            Bound::Pace {
                limit,
                estimate,
                observers,
            } => {
                write!(
                    f,
                    "at this pace the run would take {estimate:.2e} s, where {limit:.3} s of processor time are the limit"
                )?;
                observers
            }
        };
        if *of_observers >= REPORTED_SHARE {
            let share = 100.0 * of_observers;
            write!(f, " (recording takes {share:.0} % of the time)")?;
        }
        Ok(())
    }
}

#[derive(Clone, Copy, Debug)]
struct Reading {
    wall: Instant,
    processor: Option<Duration>,
    /// Wall time that the observers of the run have used so far.
    observed: Duration,
}

impl Reading {
    fn now(observed: Duration) -> Reading {
        Reading {
            wall: Instant::now(),
            processor: processor_time(),
            observed,
        }
    }

    /// Returns the processor time of the run since an earlier reading [s], or the wall time where the system reports no
    /// processor time, and the share of the observers in it.
    fn since(&self, begin: &Reading) -> (f64, f64) {
        let wall = (self.wall - begin.wall).as_secs_f64();
        let observed = self.observed.saturating_sub(begin.observed).as_secs_f64();
        let spent = match (begin.processor, self.processor) {
            (Some(from), Some(to)) => to.saturating_sub(from).as_secs_f64(),
            _ => wall,
        };
        (spent, share_of(observed, wall))
    }
}

/// Returns the share of the observers in a wall time [s], of which they used `observed`.
fn share_of(observed: f64, wall: f64) -> f64 {
    if wall > 0.0 {
        (observed / wall).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// Returns the share of a processor time [s] that belongs to the integration, if observers used `observed` of the wall
/// time [s].
#[must_use]
pub fn integration_time(processor: f64, observed: f64, wall: f64) -> f64 {
    processor * (1.0 - share_of(observed, wall))
}

/// Counts attempted steps and compares the use of time with the bounds of a plan.
#[derive(Debug)]
pub(crate) struct Bounds {
    tries: u64,
    /// Number of the attempt at which the clock is read next, and the number of attempts between two readings.
    next_look: u64,
    stride: u64,
    looked: Instant,
    /// Clocks at the first reading, and the simulated time of that reading [s].
    begin: Option<(Reading, f64)>,
}

impl Default for Bounds {
    fn default() -> Self {
        Bounds {
            tries: 0,
            next_look: 0,
            stride: 1,
            looked: Instant::now(),
            begin: None,
        }
    }
}

impl Bounds {
    /// Checks the bounds of a plan; to be called before each attempted step.
    #[inline]
    pub(crate) fn check(
        &mut self,
        plan: &TimePlan<'_>,
        t: f64,
        work: &Work,
        sink: &dyn Sink,
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
            self.look(limit, plan.t_end, t, sink.spent())
        } else {
            None
        };
        let steps = work.steps;
        bound.map_or(Ok(()), |bound| Err(StepError::Timeout { t, steps, bound }))
    }

    #[cold]
    fn look(&mut self, limit: Duration, t_end: f64, t: f64, observed: Duration) -> Option<Bound> {
        self.judge(Reading::now(observed), limit.as_secs_f64(), t_end, t)
    }

    /// Returns the bound that is reached, or would be exceeded, according to a reading of the clocks at the time `t`.
    fn judge(&mut self, now: Reading, limit: f64, t_end: f64, t: f64) -> Option<Bound> {
        self.stride = if now.wall - self.looked > LONG_STEPS {
            1
        } else {
            (2 * self.stride).min(CLOCK_STRIDE)
        };
        self.looked = now.wall;
        self.next_look = self.tries + self.stride - 1;
        let (begin, start) = self.begin.get_or_insert((now, t));
        let (spent, observers) = now.since(begin);
        if spent >= limit {
            return Some(Bound::Time { limit, observers });
        }
        let estimate = spent * (t_end - *start) / (t - *start);
        let known = spent >= PACE_AFTER.1.max(PACE_AFTER.0 * limit);
        (known && estimate > PACE_BEYOND * limit).then_some(Bound::Pace {
            limit,
            estimate,
            observers,
        })
    }

    /// Adds attempted steps that a solver library made on its own.
    pub(crate) fn add(&mut self, tries: u64) {
        self.tries += tries;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Observers count against the limit, and their share is reported, both at the limit and at the pace.
    #[test]
    fn observers_count_against_the_limit() {
        let begin = Instant::now();
        let reading = |wall: f64, processor: f64, observed: f64| Reading {
            wall: begin + Duration::from_secs_f64(wall),
            processor: Some(Duration::from_secs_f64(processor)),
            observed: Duration::from_secs_f64(observed),
        };
        let mut bounds = Bounds::default();
        let (limit, t_end) = (10.0, 1.0);
        let mut at = |now, t| bounds.judge(now, limit, t_end, t);
        assert_eq!(at(reading(0.0, 0.0, 0.0), 0.0), None);
        assert_eq!(at(reading(10.0, 5.0, 6.0), 0.5), None);
        // The integration alone has taken 4 s, with its observers 10 s.
        let found = at(reading(20.0, 10.0, 12.0), 0.9).unwrap();
        let expected = Bound::Time {
            limit,
            observers: 0.6,
        };
        assert_eq!(found, expected);
        assert_eq!(
            found.to_string(),
            "10.000 s of processor time are the limit (recording takes 60 % of the time)"
        );
        // Half of the limit for a tenth of the time.
        let slow = at(reading(10.0, 5.0, 0.0), 0.1).unwrap();
        let Bound::Pace {
            estimate,
            observers,
            ..
        } = slow
        else {
            panic!("{slow:?}")
        };
        assert!((estimate - 50.0).abs() < 1e-9 && observers == 0.0);
        assert!(!slow.to_string().contains("recording"), "{slow}");
    }
}
