//! The loop of all one-step methods: fixed steps or PI step control, table breakpoints, event location.
//!
//! **Events.** After a tentative step the event functions are read. Where one fell through zero, the first root is
//! found on the step's interpolant, the method itself steps there, and the rest, a part in ten thousand of
//! that step or less, is read from the interpolant of the shorter step, so that the event time has the
//! accuracy of the method and not of its interpolant. The branch is switched there and the method
//! restarts: every step sees one smooth force. Without this a fourth-order method shows order 1.8 on an
//! elastic impact and 0.9 with Kelvin-Voigt damping. An event function that falls and rises within one step shows at
//! neither end of it; long steps are looked into for such dips (`events::dips`).
//!
//! **Step control** (adaptive methods): `h <- h * clamp(0.9 err^-(0.85 x) err_old^(0.2 x))`, `x = 1/p`
//! (Gustafsson 1991; exponents of Hairer, Norsett, Wanner, *Solving ODEs I*, II.4 and its DOPRI5); no
//! growth right after a rejected step; after a restart the step starts from the system's characteristic time.
//!
//! **Fixed steps** lie on the grid `t0 + i h`. A breakpoint or an event cuts a step short and the next one ends on the
//! grid again, whatever the rounding of sums. A method with a bound of the next contact ([`OneStep::free_flight_end`])
//! goes there in one step, to the last point of the grid before it. That step gives no information about the size of
//! the next, and event functions that fall in it (which pairs of teeth face each other) are reset at its end.
//!
//! **Free flights.** With [`Integrator::free_flight`] on, the loop does the same for every other method along the
//! closed form of the system ([`SecondOrderSystem::flight_path`]): with rounding errors only, at a cost that does not
//! grow with the length of the flight. The errors of the method in flight, such as its drift of energy and phase, are
//! then absent, so that this is off by default: a comparison of methods shows the methods themselves. Steps in contact
//! are those of the method; errors that cancel over flight and contact together, as those of first order of
//! semi-implicit Euler nearly do, no longer cancel.

mod advance;
mod locate;
mod resume;

use crate::archive::Archive;
use crate::bounds::Bounds;
use crate::error::StepError;
use crate::events::Watch;
use crate::free_flight::FlightProbe;
pub use crate::interpolation::{hermite, hermite_with_acceleration};
use crate::method::{
    Dense, Integrator, MethodInfo, OneStep, Resolution, RestoreError, Sink, Stepping, TimePlan,
    Tolerance, Work,
};
use crate::system::{Change, SecondOrderSystem, State};
use advance::StepOutcome;

/// Number of events at one instant above which the run ends with [`StepError::Chatter`].
pub(crate) const MAX_EVENTS_AT_ONCE: u32 = 200;
/// Assumed error, relative to the tolerance, before the first step of a run or after a restart.
const ERROR_AT_START: f64 = 1e-4;

/// Runs a one-step method in the common loop.
#[derive(Clone, Debug, Default)]
pub struct Stepped<M> {
    method: M,
    flight: FlightProbe,
    left: Option<PausedRun>,
}

/// Data of the loop at the end of a run, from which a further run continues.
#[derive(Clone, Copy, Debug, Default)]
struct PausedRun {
    t_begin: f64,
    h_next: f64,
    on_grid: u64,
    err_old: f64,
    after_rejection: bool,
    afresh: bool,
}

impl<M> Stepped<M> {
    /// Wraps a one-step method.
    pub fn new(method: M) -> Self {
        Stepped {
            method,
            flight: FlightProbe::default(),
            left: None,
        }
    }
}

/// Dense output of an accepted step: the method stepped to `end`, and the step ends at the fraction `stretch` of it.
struct MethodDense<'a, M> {
    method: &'a M,
    from: &'a State,
    end: &'a State,
    stretch: f64,
}

impl<M: OneStep> Dense for MethodDense<'_, M> {
    fn eval(&self, theta: f64, q: &mut [f64], v: &mut [f64]) {
        self.method
            .interpolate(self.from, self.end, theta * self.stretch, q, v);
    }

    fn order(&self) -> u32 {
        self.method.info().order
    }
}

/// Data of one run from step to step, and its buffers.
struct Run<'p> {
    plan: &'p TimePlan<'p>,
    tolerance: Tolerance,
    /// Exponent `x` of the step over the tolerance, `h ~ rtol^x`.
    exponent: f64,
    fixed: bool,
    /// True if events are located.
    events: bool,
    t_begin: f64,
    /// Size of the next step [s].
    h_next: f64,
    /// Index of the grid point from which the next fixed step starts.
    on_grid: u64,
    /// Error of the previous step, relative to the tolerance.
    err_old: f64,
    after_rejection: bool,
    /// True if the method restarts before its next step.
    afresh: bool,
    /// Next time at which a load has a breakpoint [s].
    breakpoint: f64,
    /// Number of events without progress in time so far.
    events_here: u32,
    /// State at the end of the step of the method.
    end: State,
    /// State at the event inside the step.
    event: State,
    watch: Watch,
}

impl Run<'_> {
    /// Continues from a committed state and counts the events `without_progress`; the lengths are constant.
    fn go_on(&mut self, s: &State, without_progress: bool) -> Result<(), StepError> {
        self.events_here = if without_progress {
            self.events_here + 1
        } else {
            0
        };
        if self.events_here > MAX_EVENTS_AT_ONCE {
            return Err(StepError::Chatter {
                t: s.t,
                events: self.events_here,
            });
        }
        self.end.discrete.copy_from_slice(&s.discrete);
        self.event.discrete.copy_from_slice(&s.discrete);
        Ok(())
    }

    /// Shortens the step after one of size `h` from `t` with too large an error.
    fn shorten(&mut self, t: f64, h: f64, err: f64) -> Result<(), StepError> {
        let bad = !err.is_finite();
        self.after_rejection = true;
        let factor = if bad {
            0.1
        } else {
            (0.9 * err.powf(-self.exponent)).clamp(0.1, 0.9)
        };
        self.h_next = h * factor;
        if self.h_next >= resolution_of_time(t, self.plan) {
            return Ok(());
        }
        Err(if bad {
            let dof = first_not_finite(&self.end).unwrap_or(0);
            StepError::NonFinite { t, dof }
        } else {
            StepError::StepTooSmall { t, h: self.h_next }
        })
    }

    /// Sets the next step after an accepted one of size `h` to `t`. A step that was cut short by a breakpoint or the
    /// end gives no information about the next size.
    fn lengthen(&mut self, t: f64, h: f64, err: f64, cut: bool) -> Result<(), StepError> {
        let e = err.max(1e-10);
        let x = self.exponent;
        let largest = if self.after_rejection { 1.0 } else { 10.0 };
        let factor = 0.9 * e.powf(-0.85 * x) * self.err_old.powf(0.2 * x);
        let uncut = if cut { self.h_next } else { 0.0 };
        self.h_next = (h * factor.clamp(0.2, largest)).max(uncut);
        if self.h_next < resolution_of_time(t, self.plan) {
            return Err(StepError::StepTooSmall { t, h: self.h_next });
        }
        self.err_old = e;
        self.after_rejection = false;
        Ok(())
    }
}

/// Returns the tolerance of a plan (0 for fixed steps), if the method supports it.
pub(crate) fn tolerance_of(plan: &TimePlan<'_>, info: &MethodInfo) -> Result<f64, StepError> {
    let unsupported = |what| StepError::Unsupported {
        method: info.id,
        what,
    };
    match (plan.resolution, info.stepping) {
        (Resolution::Step(_), Stepping::Fixed | Stepping::Both) => Ok(0.0),
        (Resolution::Tolerance(rtol), Stepping::Adaptive | Stepping::Both) => {
            if rtol > 0.0 && rtol < 1.0 {
                Ok(rtol)
            } else {
                Err(unsupported("with a tolerance outside (0, 1)"))
            }
        }
        (Resolution::Step(_), _) => Err(unsupported("with a fixed step")),
        (Resolution::Tolerance(_), _) => Err(unsupported("under a tolerance")),
    }
}

/// Returns the first step of an adaptive method after a restart [s], from the characteristic time of the system: the
/// estimate is proportional to `(h/characteristic time)^(1/exponent)`.
pub(crate) fn first_step(
    sys: &dyn SecondOrderSystem,
    s: &State,
    plan: &TimePlan<'_>,
    rtol: f64,
    exponent: f64,
) -> f64 {
    let characteristic_time = sys.characteristic_time(s.at()).min(plan.t_end - s.t);
    characteristic_time * (3.0 * rtol.powf(exponent)).min(0.5)
}

/// Returns the exponent `x` of a method in `h ~ rtol^x`: its error is proportional to `h^order ~ rtol^slope`.
pub(crate) fn step_exponent(info: &MethodInfo) -> f64 {
    info.tolerance_slope / f64::from(info.order)
}

/// Returns the smallest step [s] that floating-point time resolves around `t`.
pub(crate) fn resolution_of_time(t: f64, plan: &TimePlan<'_>) -> f64 {
    4.0 * f64::EPSILON * t.abs().max(1e-3 * plan.t_end.abs())
}

impl<M: OneStep + Clone + 'static> Integrator for Stepped<M> {
    fn info(&self) -> &'static MethodInfo {
        self.method.info()
    }

    fn free_flight(&mut self, on: bool) -> bool {
        // A method that is exact for oscillators has flights of its own.
        let of_its_own = self.method.info().linear_part;
        self.flight.on = on && !of_its_own;
        on || !of_its_own
    }

    fn run(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        plan: &TimePlan<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<(), StepError> {
        self.left = None;
        self.integrate(sys, s, plan, sink, work)
    }

    fn resume(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        change: Change,
        plan: &TimePlan<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<(), StepError> {
        if let Some(left) = &mut self.left {
            left.afresh |= change == Change::Restart;
        }
        self.integrate(sys, s, plan, sink, work)
    }

    fn duplicate(&self) -> Box<dyn Integrator> {
        Box::new(self.clone())
    }

    fn archive(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        resolution: Resolution,
        archive: &mut Archive<'_>,
    ) -> Result<(), RestoreError> {
        let mut ran = self.left.is_some();
        archive.flag(&mut ran)?;
        if !ran {
            self.left = None;
            return Ok(());
        }
        if archive.reads() {
            self.method.begin(sys, resolution)?;
        }
        let left = self.left.get_or_insert_default();
        archive.number(&mut left.t_begin)?;
        archive.number(&mut left.h_next)?;
        archive.whole(&mut left.on_grid)?;
        archive.number(&mut left.err_old)?;
        archive.flag(&mut left.after_rejection)?;
        archive.flag(&mut left.afresh)?;
        self.flight.query_interval.archive(archive)?;
        Ok(self.method.archive(archive)?)
    }
}

impl<M: OneStep> Stepped<M> {
    /// Integrates a run, or the next piece of one.
    fn integrate(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        plan: &TimePlan<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<(), StepError> {
        let info = self.method.info();
        let rtol = tolerance_of(plan, info)?;
        let layout = sys.layout();
        let exponent = step_exponent(info);
        let tolerance = Tolerance::of(sys, rtol);
        if self.left.is_none() {
            sys.begin(s, plan.events);
        }
        if s.t >= plan.t_end {
            return Ok(());
        }
        // A run that fails is not gone on with.
        let left = self.left.take();
        if left.is_none() {
            self.method.begin(sys, plan.resolution)?;
            self.method.balance(sys, s, plan.resolution, work);
            self.flight.query_interval.end();
            self.method.restart(sys, s, work);
        }
        let mut watch = Watch::new(layout.event_functions);
        let events = plan.events && layout.event_functions > 0;
        if events {
            sys.event_functions(s.at(), &mut watch.before);
        }
        let (fixed, h_next) = match plan.resolution {
            Resolution::Step(h) => (true, h),
            Resolution::Tolerance(_) => (false, first_step(sys, s, plan, rtol, exponent)),
        };
        let least = 4.0 * f64::EPSILON * s.t.abs().max(plan.t_end.abs());
        if !(h_next.is_finite() && h_next > if fixed { least } else { 0.0 }) {
            return Err(StepError::StepTooSmall { t: s.t, h: h_next });
        }
        let mut bounds = Bounds::default();
        let mut r = Run {
            plan,
            tolerance,
            exponent,
            fixed,
            events,
            t_begin: s.t,
            h_next,
            on_grid: 0,
            err_old: ERROR_AT_START,
            after_rejection: false,
            afresh: false,
            breakpoint: sys.next_breakpoint(s.t),
            events_here: 0,
            end: s.clone(),
            event: s.clone(),
            watch,
        };
        if let Some(left) = left {
            r.t_begin = left.t_begin;
            r.h_next = left.h_next;
            r.on_grid = left.on_grid;
            r.err_old = left.err_old;
            r.after_rejection = left.after_rejection;
            if left.afresh {
                work.restarts += 1;
                self.start_afresh(sys, s, &mut r, work);
            }
        }
        while s.t < plan.t_end {
            bounds.check(plan, s.t, work, &*sink)?;
            let aim = self.aim(sys, s, &mut r);
            match self.advance(sys, s, &aim, &mut r, sink, work)? {
                StepOutcome::Rejected => {}
                StepOutcome::Stopped => return Ok(()),
                StepOutcome::Advanced {
                    located,
                    progressed,
                } => self.settle(sys, s, &aim, (located, progressed), &mut r, sink, work)?,
            }
        }
        self.left = Some(PausedRun {
            t_begin: r.t_begin,
            h_next: r.h_next,
            on_grid: r.on_grid,
            err_old: r.err_old,
            after_rejection: r.after_rejection,
            afresh: r.afresh,
        });
        Ok(())
    }
}

/// Returns the index of the first coordinate whose value or rate is not finite.
#[inline]
pub(crate) fn first_not_finite(s: &State) -> Option<usize> {
    // A sum is finite unless a term is not (overflow of the sum itself is a blow-up as well).
    let sum: f64 = s.q.iter().sum::<f64>() + s.v.iter().sum::<f64>();
    if sum.is_finite() {
        return None;
    }
    let n = s.q.len();
    (0..n)
        .find(|&i| !(s.q[i].is_finite() && s.v[i].is_finite()))
        .or(Some(0))
}
