//! One step of the loop: its planned end, and the advance of the state.

use super::{MethodDense, Run, Stepped, first_not_finite, resolution_of_time};
use crate::error::StepError;
use crate::free_flight::FlightDense;
use crate::method::{AcceptedStep, Control, Dense, OneStep, Sink, Work};
use crate::system::{SecondOrderSystem, State};

/// Planned end of a step, and the kind of motion to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlannedStep {
    /// End time of the step [s].
    pub(super) t_new: f64,
    /// End of the run or next breakpoint [s], whichever comes first.
    stop: f64,
    /// True if no contact closes before the end of the step, whatever its length.
    pub(super) leaps: bool,
    /// True if the step follows the closed-form motion of the system.
    pub(super) free_flights: bool,
    /// True if the rest of the interval is below the resolution of time after an event, so that no step is made.
    pub(super) sliver: bool,
}

/// Outcome of a step.
#[derive(Clone, Copy, Debug)]
pub(super) enum StepOutcome {
    /// The error was too large: the next step is shorter.
    Rejected,
    /// The sink ended the run.
    Stopped,
    /// The state advanced, or switches at the start of the step.
    Advanced {
        /// True if the step ends at an event.
        located: bool,
        /// True if time advanced by more than rounding.
        progressed: bool,
    },
}

impl<M: OneStep> Stepped<M> {
    /// Plans the end of the next step: on the grid of fixed steps, at the end of the run and at breakpoints, or at the
    /// end of a free flight. It never leaves a negligible rest of a step.
    pub(super) fn aim(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &State,
        r: &mut Run<'_>,
    ) -> PlannedStep {
        let stop = r.plan.t_end.min(r.breakpoint);
        let mut t_new = if r.fixed {
            while r.t_begin + (r.on_grid + 1) as f64 * r.h_next <= s.t + 1e-9 * r.h_next {
                r.on_grid += 1;
            }
            r.t_begin + (r.on_grid + 1) as f64 * r.h_next
        } else {
            r.h_next = self.method.preferred_step(r.h_next);
            s.t + r.h_next
        };
        let mut end = self.method.free_flight_end(sys, s, r.h_next);
        if self.flight.on {
            end = self.flight.end(sys, s, t_new);
        }
        end = end.min(stop);
        if r.fixed && end < stop {
            end = r.t_begin + ((end - r.t_begin) / r.h_next).floor() * r.h_next;
        }
        let leaps = end > t_new + 1e-9 * r.h_next;
        if leaps {
            t_new = end;
            if r.fixed {
                r.on_grid = ((end - r.t_begin) / r.h_next) as u64 - 1;
            }
        } else if t_new >= stop - 1e-9 * r.h_next {
            t_new = stop;
        } else if !r.fixed && t_new > stop - r.h_next {
            t_new = 0.5 * (s.t + stop);
        }
        PlannedStep {
            t_new,
            stop,
            leaps,
            free_flights: self.flight.on && leaps,
            sliver: t_new == stop && t_new - s.t <= resolution_of_time(s.t, r.plan),
        }
    }

    /// Makes the step, passes it to the sink and advances the state, up to an event where one lies in the step.
    pub(super) fn advance(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        aim: &PlannedStep,
        r: &mut Run<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<StepOutcome, StepError> {
        let mut outcome = (false, true);
        if aim.sliver {
            s.t = aim.stop;
        } else if aim.free_flights {
            let (from, to) = (s.t, aim.t_new);
            let path = &self.flight.path;
            r.end.t = to;
            path.at(to, &mut r.end.q, &mut r.end.v);
            check_finite(&r.end)?;
            let dense = FlightDense { path, from, to };
            let control = accept(sys, [s, &r.end], &dense, true, sink, work);
            std::mem::swap(s, &mut r.end);
            if control == Control::Stop {
                return Ok(StepOutcome::Stopped);
            }
        } else {
            let h = aim.t_new - s.t;
            let err = (self.method).step(sys, s, h, &r.tolerance, &mut r.end, work)?;
            r.end.t = aim.t_new;
            if !r.fixed && (!err.is_finite() || err > 1.0) {
                work.rejected += 1;
                r.shorten(s.t, h, err)?;
                return Ok(StepOutcome::Rejected);
            }
            check_finite(&r.end)?;

            let (mut located, mut stretch) = (false, Some(1.0));
            if r.events && !aim.leaps {
                sys.event_functions(r.end.at(), &mut r.watch.after);
                let fell = r.watch.any_fell();
                let dip = self.dipped(sys, s, h, r, work)?;
                if fell || dip.is_some() {
                    located = true;
                    stretch = self.locate(sys, s, dip.unwrap_or(h), r, work)?;
                }
            }
            let mut progressed = false;
            if let Some(stretch) = stretch {
                let to = if located { &r.event } else { &r.end };
                let dense = MethodDense {
                    method: &self.method,
                    from: s,
                    end: &r.end,
                    stretch,
                };
                let control = accept(sys, [s, to], &dense, aim.leaps, sink, work);
                progressed = to.t - s.t > 1e-12 * (r.plan.t_end - r.t_begin);
                std::mem::swap(s, if located { &mut r.event } else { &mut r.end });
                if control == Control::Stop {
                    return Ok(StepOutcome::Stopped);
                }
            }
            if !(r.fixed || located || aim.leaps) {
                r.lengthen(s.t, h, err, aim.t_new == aim.stop)?;
            }
            outcome = (located, progressed);
        }
        let (located, progressed) = outcome;
        Ok(StepOutcome::Advanced {
            located,
            progressed,
        })
    }
}

/// Passes a step between two states to the sink and counts it.
fn accept(
    sys: &mut dyn SecondOrderSystem,
    [from, to]: [&State; 2],
    dense: &dyn Dense,
    flight: bool,
    sink: &mut dyn Sink,
    work: &mut Work,
) -> Control {
    let step = AcceptedStep {
        from,
        to,
        dense,
        flight,
    };
    work.steps += 1;
    sink.accepted(sys, &step)
}

fn check_finite(end: &State) -> Result<(), StepError> {
    first_not_finite(end).map_or(Ok(()), |dof| Err(StepError::NonFinite { t: end.t, dof }))
}
