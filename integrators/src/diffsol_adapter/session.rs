//! The loop over the steps of a solver: events, breakpoints, restarts, bounds.

use super::Shared;
use super::kernel::{Counts, Kernel, KernelDense, copy};
use crate::bounds::Bounds;
use crate::error::StepError;
use crate::events::Watch;
use crate::free_flight::{FlightDense, FlightProbe};
use crate::method::{AcceptedStep, Control, Sink, TimePlan, Work};
use crate::stepped::{MAX_EVENTS_AT_ONCE, first_not_finite, resolution_of_time};
use crate::system::{Change, State};
use diffsol::error::OdeSolverError;
use diffsol::{DiffsolError, NalgebraContext, NalgebraVec, Vector};
use std::cell::RefCell;

mod locate;

/// Failure of a run, from this crate or from diffsol.
pub(super) enum SessionError {
    /// An error of this crate.
    Step(StepError),
    /// An error of diffsol.
    Library(DiffsolError),
}

impl From<DiffsolError> for SessionError {
    fn from(e: DiffsolError) -> Self {
        SessionError::Library(e)
    }
}

impl From<StepError> for SessionError {
    fn from(e: StepError) -> Self {
        SessionError::Step(e)
    }
}

/// Action of the loop after a step of the solver.
enum NextAction {
    /// The solver makes its next step.
    Step,
    /// The solver restarts from a changed state.
    Restart,
    /// The run ends.
    End,
}

/// State of one run with a solver of diffsol.
pub(super) struct Session<'x, 'a> {
    shared: &'x Shared<'a>,
    s: &'x mut State,
    plan: &'x TimePlan<'x>,
    sink: &'x mut dyn Sink,
    work: &'x mut Work,
    t_begin: f64,
    bounds: Bounds,
    watch: Watch,
    events: bool,
    events_here: u32,
    breakpoint: f64,
    to: State,
    y: RefCell<NalgebraVec<f64>>,
    seen: Counts,
    flight: FlightProbe,
}

impl<'x, 'a> Session<'x, 'a> {
    pub(super) fn new(
        shared: &'x Shared<'a>,
        s: &'x mut State,
        plan: &'x TimePlan<'x>,
        sink: &'x mut dyn Sink,
        work: &'x mut Work,
        free_flights: bool,
    ) -> Self {
        let mut sys = shared.sys.borrow_mut();
        let layout = sys.layout();
        Session {
            shared,
            plan,
            sink,
            work,
            t_begin: s.t,
            bounds: Bounds::default(),
            watch: Watch::new(layout.event_functions),
            events: plan.events && layout.event_functions > 0,
            events_here: 0,
            breakpoint: sys.next_breakpoint(s.t),
            to: s.clone(),
            y: RefCell::new(NalgebraVec::zeros(2 * layout.n, NalgebraContext::default())),
            seen: Counts::default(),
            flight: FlightProbe {
                on: free_flights,
                ..FlightProbe::default()
            },
            s,
        }
    }

    /// Runs to the end of the plan. `first_step` returns the first step after a restart.
    pub(super) fn run(
        &mut self,
        kernel: &mut dyn Kernel,
        first_step: &dyn Fn(&State) -> f64,
    ) -> Result<(), SessionError> {
        loop {
            if self.events {
                self.shared
                    .event_functions(self.s.at(), &mut self.watch.before);
            }
            let h = kernel.step_size();
            let stop = self.plan.t_end.min(self.breakpoint);
            // diffsol takes a stop time within a hundred units of rounding for reached.
            let least = 200.0 * f64::EPSILON * (self.s.t.abs() + h);
            let mut last = h;
            self.flight.query_interval.end();
            if let Some(next) = self.flight_path(h, stop)? {
                if matches!(next, NextAction::End) {
                    return Ok(());
                }
            } else if stop - self.s.t <= least.max(resolution_of_time(self.s.t, self.plan)) {
                self.s.t = stop;
                self.between(false, false);
            } else {
                kernel.stop_at(stop)?;
                loop {
                    let cut = kernel.step_size();
                    match self.step(kernel, stop)? {
                        NextAction::Step => {
                            last = cut;
                            match self.flight_path(kernel.step_size(), stop)? {
                                None => {}
                                Some(NextAction::End) => return Ok(()),
                                Some(_) => break,
                            }
                        }
                        NextAction::Restart => {
                            // The step before one that was cut short says more about the characteristic time.
                            last = last.max(cut);
                            break;
                        }
                        NextAction::End => return Ok(()),
                    }
                }
            }
            if self.s.t >= self.plan.t_end {
                return Ok(());
            }
            let (s, shared) = (&*self.s, self.shared);
            kernel.restart(s.t, last.min(first_step(s)), &mut |y, dy| {
                let n = s.q.len();
                y[..n].copy_from_slice(&s.q);
                y[n..].copy_from_slice(&s.v);
                shared.rhs(y, s.t, dy);
            });
        }
    }

    /// Crosses a free flight that is longer than a step of size `h` and ends by `stop`; returns the next action, or
    /// `None` where there is no such flight.
    fn flight_path(&mut self, h: f64, stop: f64) -> Result<Option<NextAction>, SessionError> {
        let shared = self.shared;
        let later = self.s.t + h;
        if !self.flight.on || later >= stop {
            return Ok(None);
        }
        let until = {
            let mut sys = shared.sys.borrow_mut();
            self.flight.end(&mut **sys, self.s, later).min(stop)
        };
        if until <= later {
            return Ok(None);
        }
        self.bounds
            .check(self.plan, self.s.t, self.work, &*self.sink)?;
        let (to, path) = (&mut self.to, &self.flight.path);
        to.t = until;
        path.at(until, &mut to.q, &mut to.v);
        if let Some(dof) = first_not_finite(to) {
            return Err(StepError::NonFinite { t: until, dof }.into());
        }
        let step = AcceptedStep {
            from: self.s,
            to: &self.to,
            dense: &FlightDense {
                path,
                from: self.s.t,
                to: until,
            },
            flight: true,
        };
        let control = self.sink.accepted(&mut **shared.sys.borrow_mut(), &step);
        self.work.steps += 1;
        self.events_here = 0;
        std::mem::swap(self.s, &mut self.to);
        if control == Control::Stop {
            return Ok(Some(NextAction::End));
        }
        self.between(false, true);
        Ok(Some(if self.s.t >= self.plan.t_end {
            NextAction::End
        } else {
            NextAction::Restart
        }))
    }

    /// Makes one step of the solver and returns the next action.
    fn step(&mut self, kernel: &mut dyn Kernel, stop: f64) -> Result<NextAction, SessionError> {
        let shared = self.shared;
        self.bounds
            .check(self.plan, self.s.t, self.work, &*self.sink)?;
        shared.not_finite.set(None);
        let h = kernel.step_size();
        let stepped = kernel.step();
        let (seen, counts) = (self.seen, kernel.counts());
        self.seen = counts;
        self.work.rejected += counts.rejected - seen.rejected;
        self.work.newton_iterations += counts.newton_iterations - seen.newton_iterations;
        self.work.factorisations += counts.factorisations - seen.factorisations;
        self.bounds.add(counts.rejected - seen.rejected);
        let reached = stepped.map_err(|e| explain(e, shared, self.s.t, h, counts, seen))?;

        let to = &mut self.to;
        copy(kernel.y(), &mut to.q, &mut to.v);
        to.t = if reached { stop } else { kernel.time() };
        if let Some(dof) = first_not_finite(to) {
            let (t, dof) = shared.not_finite.get().unwrap_or((to.t, dof));
            return Err(StepError::NonFinite { t, dof }.into());
        }

        let mut located = false;
        let mut progressed = true;
        if self.events {
            shared.event_functions(to.at(), &mut self.watch.after);
            let fell = self.watch.any_fell();
            if self.dipped(kernel)? || fell {
                located = true;
                progressed = self.locate(kernel)?;
            }
        }
        if progressed {
            let step = AcceptedStep {
                from: self.s,
                to: &self.to,
                dense: &KernelDense {
                    kernel,
                    from: self.s,
                    to: &self.to,
                    y: &self.y,
                },
                flight: false,
            };
            let control = self.sink.accepted(&mut **shared.sys.borrow_mut(), &step);
            self.work.steps += 1;
            progressed = self.to.t - self.s.t > 1e-12 * (self.plan.t_end - self.t_begin);
            std::mem::swap(self.s, &mut self.to);
            if control == Control::Stop {
                return Ok(NextAction::End);
            }
        }
        if located && !progressed {
            self.events_here += 1;
            if self.events_here > MAX_EVENTS_AT_ONCE {
                return Err(StepError::Chatter {
                    t: self.s.t,
                    events: self.events_here,
                }
                .into());
            }
        } else {
            self.events_here = 0;
        }
        let restart = self.between(located, false);
        Ok(if self.s.t >= self.plan.t_end {
            NextAction::End
        } else if restart {
            NextAction::Restart
        } else {
            self.watch.advance();
            NextAction::Step
        })
    }

    /// Processes events, `commit` and the next breakpoint between two steps. Returns true when the solver has to
    /// restart, as after a free flight.
    fn between(&mut self, located: bool, flown: bool) -> bool {
        let mut sys = self.shared.sys.borrow_mut();
        let s = &mut *self.s;
        let keep = self.sink.wants_restarts();
        if keep {
            self.to.copy_from(s);
        }
        let mut restart = located || flown;
        if located {
            self.work.events += self.watch.falling.len() as u64;
            for &event in &self.watch.falling {
                sys.transition(s, event);
            }
        }
        restart |= sys.commit(s) == Change::Restart;
        if flown && self.events {
            sys.begin(s, true);
        }
        if s.t >= self.breakpoint {
            self.breakpoint = sys.next_breakpoint(s.t);
            restart = true;
        }
        if restart {
            if keep {
                self.sink.restarted(&mut **sys, &self.to, s);
            }
            if s.t < self.plan.t_end {
                self.work.restarts += 1;
            }
        }
        self.to.discrete.copy_from_slice(&s.discrete);
        self.shared
            .discrete
            .borrow_mut()
            .copy_from_slice(&s.discrete);
        restart
    }
}

/// Converts the failure of a step that started at `t` with size `h` to a [`StepError`].
fn explain(
    e: DiffsolError,
    shared: &Shared<'_>,
    t: f64,
    h: f64,
    counts: Counts,
    seen: Counts,
) -> SessionError {
    if let Some((t, dof)) = shared.not_finite.get() {
        return StepError::NonFinite { t, dof }.into();
    }
    let newton = counts.newton_failures - seen.newton_failures;
    let errors = counts.rejected - seen.rejected - newton;
    match e {
        DiffsolError::OdeSolverError(
            OdeSolverError::StepSizeTooSmall { .. }
            | OdeSolverError::TooManyErrorTestFailures { .. }
            | OdeSolverError::TooManyNonlinearSolverFailures { .. },
        ) => if newton > errors {
            StepError::NewtonDiverged {
                t,
                h,
                residual: f64::INFINITY,
                iterations: (counts.newton_iterations - seen.newton_iterations) as u32,
            }
        } else {
            StepError::StepTooSmall { t, h }
        }
        .into(),
        e => SessionError::Library(e),
    }
}
