//! Actions between two steps: branches switch, teeth are handed over, and the method continues or restarts.

use super::advance::PlannedStep;
use super::{ERROR_AT_START, Run, Stepped, first_step};
use crate::error::StepError;
use crate::method::{OneStep, Sink, Work};
use crate::system::{Change, SecondOrderSystem, State};

impl<M: OneStep> Stepped<M> {
    /// Restarts the method from a state.
    pub(super) fn start_afresh(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &State,
        r: &mut Run<'_>,
        work: &mut Work,
    ) {
        self.method.restart(sys, s, work);
        self.flight.query_interval.end();
        if !r.fixed {
            let first = first_step(sys, s, r.plan, r.tolerance.rtol, r.exponent);
            r.h_next = r.h_next.min(first);
            r.err_old = ERROR_AT_START;
            r.after_rejection = false;
        }
        if r.events {
            sys.event_functions(s.at(), &mut r.watch.before);
        }
    }

    /// Makes the state at the end of a step the start of the next one.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn settle(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        aim: &PlannedStep,
        (located, progressed): (bool, bool),
        r: &mut Run<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<(), StepError> {
        let keep = sink.wants_restarts();
        if keep {
            r.event.copy_from(s);
        }
        let mut change = Change::None;
        if aim.free_flights {
            // Teeth are handed over before anyone asks which of them face each other.
            change = Change::Restart;
            sys.commit(s);
            if r.events {
                sys.begin(s, true);
            }
        } else if r.events && aim.leaps && progressed {
            // Nothing touched on the way, so no branch ended; the next one starts from here.
            r.event.discrete.copy_from_slice(&s.discrete);
            sys.begin(s, true);
            sys.event_functions(s.at(), &mut r.watch.after);
            if r.event.discrete != s.discrete {
                work.restarts += 1;
                if keep {
                    sink.restarted(sys, &r.event, s);
                    r.event.copy_from(s);
                }
            }
        }
        if located {
            // The method's end values belong to another time by a hair, so it starts afresh even when
            // the branch stays.
            change = Change::Restart;
            work.events += r.watch.falling.len() as u64;
            for i in 0..r.watch.falling.len() {
                sys.transition(s, r.watch.falling[i]);
            }
        }
        if !aim.free_flights && sys.commit(s) == Change::Restart {
            change = Change::Restart;
        }
        if s.t >= r.breakpoint {
            r.breakpoint = sys.next_breakpoint(s.t);
            change = Change::Restart;
        }
        if change == Change::Restart {
            if keep {
                sink.restarted(sys, &r.event, s);
            }
            if s.t >= r.plan.t_end {
                r.afresh = true;
                return Ok(());
            }
            work.restarts += 1;
            self.start_afresh(sys, s, r, work);
        } else if !aim.sliver {
            self.method.advance();
            r.watch.advance();
        }
        r.go_on(s, located && !progressed)
    }
}
