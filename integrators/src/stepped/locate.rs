//! Location of the first event in a tentative step, with steps of the method itself.

use super::{Run, Stepped, first_not_finite};
use crate::error::StepError;
use crate::events::Root;
use crate::events::dips::SHORT;
use crate::method::{OneStep, Work};
use crate::system::{SecondOrderSystem, State};

/// Fraction of a step that is read from the interpolant instead of stepped when an event is located.
const SHIFT: f64 = 1e-4;
/// Largest number of steps of the method towards one event.
const MAX_LOCATIONS: u32 = 50;

impl<M: OneStep> Stepped<M> {
    /// Searches for event functions that fell and rose again in the step from `s` of size `h` to `r.end`. If one did
    /// so on the interpolant and in a step of the method, the step ends at the bottom of the first dip, and its size
    /// is returned.
    pub(super) fn dipped(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &State,
        h: f64,
        r: &mut Run<'_>,
        work: &mut Work,
    ) -> Result<Option<f64>, StepError> {
        if h <= SHORT * sys.characteristic_time(s.at()) {
            return Ok(None);
        }
        let Run {
            tolerance,
            end,
            event,
            watch,
            ..
        } = r;
        let t_full = end.t;
        let dipped = watch.any_dipped(|x, out| {
            self.method
                .interpolate(s, end, x, &mut event.q, &mut event.v);
            event.t = s.t + x * (end.t - s.t);
            sys.event_functions(event.at(), out);
        });
        if !dipped {
            return Ok(None);
        }
        let shorter = watch.until * h;
        for (h, t) in [(shorter, s.t + shorter), (h, t_full)] {
            self.method.step(sys, s, h, tolerance, end, work)?;
            end.t = t;
            work.rejected += 1;
            sys.event_functions(end.at(), &mut watch.after);
            if watch.any_fell() && t < t_full {
                return Ok(Some(shorter));
            }
        }
        Ok(None)
    }

    /// Finds the first event in the step from `s` of size `h` to `r.end`. The state at the event remains in `r.event`,
    /// the event functions to switch in `r.watch.falling`. Returns the fraction of the step to `r.end` at which the
    /// event lies, or `None` where event functions are at their root at the start of the step.
    pub(super) fn locate(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &State,
        h: f64,
        r: &mut Run<'_>,
        work: &mut Work,
    ) -> Result<Option<f64>, StepError> {
        let Run {
            tolerance,
            end,
            event,
            watch,
            ..
        } = r;
        let events_on = |method: &M,
                         sys: &mut dyn SecondOrderSystem,
                         end: &State,
                         x: f64,
                         event: &mut State,
                         out: &mut [f64]| {
            method.interpolate(s, end, x, &mut event.q, &mut event.v);
            event.t = s.t + x * (end.t - s.t);
            sys.event_functions(event.at(), out);
        };
        let root = watch.first_root(0.1 * SHIFT, |x, out| {
            events_on(&self.method, sys, end, x, event, out)
        });
        let Root::Inside(mut theta) = root else {
            return Ok(None);
        };
        let t_full = end.t;
        let (mut lo, mut hi) = (0.0, 1.0);
        let mut stretch = 1.0;
        for location in 1..=MAX_LOCATIONS {
            if theta < 1.0 {
                self.method.step(sys, s, theta * h, tolerance, end, work)?;
                end.t = s.t + theta * h;
                work.rejected += 1;
            } else if end.t != t_full {
                self.method.step(sys, s, h, tolerance, end, work)?;
                end.t = t_full;
                work.rejected += 1;
            }
            sys.event_functions(end.at(), &mut watch.here);
            let f = watch.lowest_here();
            // Secant on the interpolant of this step, around its end.
            let (mut x0, mut f0, mut x1) = (1.0, f, 1.0 - SHIFT);
            for correction in 0..8 {
                if f0 == 0.0 {
                    x1 = x0;
                    break;
                }
                events_on(&self.method, sys, end, x1, event, &mut watch.here);
                let f1 = watch.lowest_here();
                // What comes no closer has only rounding left to go by, which leads anywhere.
                if correction > 1 && f1.abs() >= f0.abs() {
                    x1 = x0;
                    break;
                }
                let x2 = x1 - f1 * (x1 - x0) / (f1 - f0);
                if f1 == 0.0 || !x2.is_finite() {
                    break;
                }
                let moved = (x2 - x1).abs();
                (x0, f0, x1) = (x1, f1, x2.clamp(0.5, 1.5));
                if moved <= 2.0 * f64::EPSILON {
                    break;
                }
            }
            stretch = x1;
            if (x1 - 1.0).abs() <= SHIFT || location == MAX_LOCATIONS {
                break;
            }
            if f > 0.0 {
                lo = theta;
            } else {
                hi = theta;
            }
            let next = theta * x1;
            theta = if next > lo && next < hi {
                next
            } else if hi - lo > f64::EPSILON {
                0.5 * (lo + hi)
            } else {
                hi
            };
        }
        // The step ends sooner now: what is no parabola over all of it may be one up to here.
        let h = end.t - s.t;
        if h < (1.0 - SHIFT) * (t_full - s.t) {
            sys.event_functions(end.at(), &mut watch.after);
            let falling = watch.falling.clone();
            if let Some(shorter) = self.dipped(sys, s, h, r, work)? {
                return self.locate(sys, s, shorter, r, work);
            }
            r.watch.falling = falling;
        }
        let Run {
            end, event, watch, ..
        } = r;
        stretch = stretch.clamp(1.0 - SHIFT, 1.0 + SHIFT);
        events_on(&self.method, sys, end, stretch, event, &mut watch.here);
        event.t = event.t.min(t_full);
        if let Some(dof) = first_not_finite(event) {
            return Err(StepError::NonFinite { t: event.t, dof });
        }
        watch.select();
        Ok(Some(stretch))
    }
}
