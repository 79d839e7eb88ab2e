//! Closed-form motion from event to event, where the system provides it for closed contacts
//! ([`FreeFlight::linear_path`](crate::FreeFlight::linear_path)).
//!
//! A method that is exact for oscillators is also exact for linear contacts: it follows the path of the system to the
//! event at its end, at any step or tolerance, and switches there. In contact the path is passed to observers in steps
//! that resolve its vibration; a flight is one step. Without such a path the method makes steps.

use super::{Run, Stepped, first_not_finite, resolution_of_time};
use crate::bounds::Bounds;
use crate::error::StepError;
use crate::free_flight::FlightDense;
use crate::method::{AcceptedStep, Control, OneStep, Sink, Work};
use crate::system::{Change, SecondOrderSystem, State};

/// Outcome of the query for a closed-form path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SegmentOutcome {
    /// The system has no closed form at this state.
    Unknown,
    /// The sink ended the run.
    Stopped,
    /// The state is at the end of the path.
    Completed,
}

impl<M: OneStep> Stepped<M> {
    /// Follows the closed-form motion of the system to its next event, if there is one.
    pub(super) fn segment(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        r: &mut Run<'_>,
        bounds: &mut Bounds,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<SegmentOutcome, StepError> {
        if !self.segments.on || !self.segments.query_interval.over() {
            return Ok(SegmentOutcome::Unknown);
        }
        let path = &mut self.segments.path;
        let until = sys.linear_path(s, path);
        let resolved = s.t + resolution_of_time(s.t, r.plan);
        self.segments.query_interval.learn(until <= resolved);
        if until <= resolved {
            return Ok(SegmentOutcome::Unknown);
        }
        let stop = until.min(r.plan.t_end);
        let start = s.t;
        let parts = (path.pressed()).map_or(1.0, |h| ((stop - start) / h).ceil().max(1.0));
        let mut change = Change::None;
        let mut part = 0.0;
        while part < parts && change == Change::None {
            if part > 0.0 {
                bounds.check(r.plan, s.t, work, &*sink)?;
            }
            part += 1.0;
            let to = if part < parts {
                start + (stop - start) * (part / parts)
            } else {
                stop
            };
            r.end.t = to;
            path.at(to, &mut r.end.q, &mut r.end.v);
            if let Some(dof) = first_not_finite(&r.end) {
                return Err(StepError::NonFinite { t: to, dof });
            }
            work.steps += 1;
            let step = AcceptedStep {
                from: s,
                to: &r.end,
                dense: &FlightDense {
                    path,
                    from: s.t,
                    to,
                },
                flight: path.pressed().is_none(),
            };
            let control = sink.accepted(sys, &step);
            std::mem::swap(s, &mut r.end);
            if control == Control::Stop {
                return Ok(SegmentOutcome::Stopped);
            }
            if part < parts {
                change = sys.commit(s);
                r.end.discrete.copy_from_slice(&s.discrete);
            }
        }
        let keep = sink.wants_restarts();
        if keep {
            r.event.copy_from(s);
        }
        if change == Change::None {
            if s.t == until {
                work.events += path.switches().len() as u64;
                for &event in path.switches() {
                    change = sys.transition(s, event);
                }
            }
            if sys.commit(s) == Change::Restart {
                change = Change::Restart;
            }
        }
        if s.t >= r.breakpoint {
            r.breakpoint = sys.next_breakpoint(s.t);
            change = Change::Restart;
        }
        if change == Change::Restart {
            work.restarts += 1;
            if keep {
                sink.restarted(sys, &r.event, s);
            }
        }
        // The data stored by the method belong to the start of the path.
        self.segments.left = true;
        let progressed = s.t - start > 1e-12 * (r.plan.t_end - r.t_begin);
        r.go_on(s, !progressed)?;
        Ok(SegmentOutcome::Completed)
    }

    /// Restarts the method where a path of the system ended.
    pub(super) fn leave_segment(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &State,
        r: &mut Run<'_>,
        work: &mut Work,
    ) {
        if std::mem::take(&mut self.segments.left) {
            self.start_afresh(sys, s, r, work);
        }
    }
}
