//! The method seam: what an integrator declares, how it is driven, what it counts.
//!
//! The method owns the loop and pushes accepted steps to a [`Sink`]: solvers of libraries borrow their
//! problem, so a pull-style `step()` would be self-referential. One-step methods implement [`OneStep`] and
//! get the loop, step control and event location from [`crate::stepped::Stepped`].

use crate::error::StepError;
use crate::system::{At, Change, Coeffs, SecondOrderSystem, Singular, State};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Whether a method runs at fixed steps, under a tolerance, or both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stepping {
    /// Fixed steps only.
    Fixed,
    /// Tolerance only.
    Adaptive,
    /// Either.
    Both,
}

/// One parameter of a method with its default and admissible range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name as written in `id(name=value)`.
    pub name: &'static str,
    /// Default value.
    pub default: f64,
    /// Smallest and largest admissible value.
    pub range: (f64, f64),
    /// What it does.
    pub meaning: &'static str,
}

/// What a method declares of itself; tests read it and hold the method to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodInfo {
    /// Name on the command line and in records.
    pub id: &'static str,
    /// Name in text.
    pub name: &'static str,
    /// Order of convergence on smooth problems; the highest one of a method of variable order.
    pub order: u32,
    /// Solves equations in each step.
    pub implicit: bool,
    /// Fixed steps, tolerance, or both.
    pub stepping: Stepping,
    /// Slope of log(error) over log(rtol) under a tolerance; 0 when the method has none.
    pub tolerance_slope: f64,
    /// Loses energy on a linear undamped oscillator at finite step. A method that does not may still gain
    /// some (Tsitouras) or let it swing (symplectic methods).
    pub dissipative: bool,
    /// Runs systems with a [`SecondOrderSystem::modal`] split only, and is exact for their oscillators.
    pub linear_part: bool,
    /// Keeps dense matrices of the first-order form, twice as large as the coordinates: memory grows with the square.
    pub dense_matrices: bool,
    /// Parameters.
    pub parameters: &'static [Parameter],
    /// Where the method comes from.
    pub citation: &'static str,
}

/// How finely to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// Fixed step [s].
    Step(f64),
    /// Relative tolerance; the absolute one is this times [`SecondOrderSystem::scales`].
    Tolerance(f64),
}

impl Resolution {
    /// The fixed step [s].
    pub fn step(self) -> Option<f64> {
        match self {
            Resolution::Step(h) => Some(h),
            Resolution::Tolerance(_) => None,
        }
    }

    /// The relative tolerance.
    pub fn tolerance(self) -> Option<f64> {
        match self {
            Resolution::Step(_) => None,
            Resolution::Tolerance(rtol) => Some(rtol),
        }
    }
}

/// What to integrate and within which bounds.
#[derive(Clone, Copy, Debug)]
pub struct TimePlan<'a> {
    /// End time [s].
    pub t_end: f64,
    /// Step or tolerance.
    pub resolution: Resolution,
    /// Locate contact events and restart there.
    pub events: bool,
    /// Largest number of steps, rejected ones included.
    pub max_steps: u64,
    /// Bound on the processor time of the integration, that of observers ([`Sink::spent`]) excluded. A run whose pace
    /// would take it far beyond is stopped early.
    pub time_limit: Option<Duration>,
    /// Set from outside to stop the run.
    pub cancel: Option<&'a AtomicBool>,
}

impl TimePlan<'_> {
    /// A plan to `t_end` with event location and no bounds.
    pub fn new(t_end: f64, resolution: Resolution) -> Self {
        TimePlan {
            t_end,
            resolution,
            events: true,
            max_steps: u64::MAX,
            time_limit: None,
            cancel: None,
        }
    }
}

/// Counted work of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Accepted steps.
    pub steps: u64,
    /// Steps rejected by the error estimate or repeated to hit an event.
    pub rejected: u64,
    /// Force evaluations (those of the observers are not counted).
    pub force_evaluations: u64,
    /// Newton iterations.
    pub newton_iterations: u64,
    /// Factorisations of the Newton matrix.
    pub factorisations: u64,
    /// Events located.
    pub events: u64,
    /// Restarts of the method.
    pub restarts: u64,
}

impl Work {
    /// Asks a system for a Newton correction and counts the factorisations that took: those it says it made, or
    /// one where it keeps no factors.
    pub(crate) fn correct(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        at: At<'_>,
        c: Coeffs,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        let before = sys.factorisations();
        let result = sys.correct(at, c, rhs_to_x);
        self.factorisations += match (before, sys.factorisations()) {
            (Some(before), Some(after)) => after - before,
            _ => 1,
        };
        result
    }
}

/// The solution inside an accepted step.
pub trait Dense {
    /// Coordinates and velocities at `theta` in [0, 1] of the step.
    fn eval(&self, theta: f64, q: &mut [f64], v: &mut [f64]);

    /// Order of the method, the highest one where it varies: integrals over the step need be no more exact.
    fn order(&self) -> u32 {
        u32::MAX
    }

    /// Energy per unit mass [m^2/s^2] of each coordinate that linear dampers took in the step beyond the trapezoidal rule
    /// on their powers at its ends. False where the method has no better figure than that rule.
    fn damping_beyond_trapezoid(&self, _beyond: &mut [f64]) -> bool {
        false
    }
}

/// An accepted step, before events switch or commit the discrete state.
pub struct AcceptedStep<'a> {
    /// State at the start of the step; its discrete state held through the step.
    pub from: &'a State,
    /// State at its end, with the discrete state of the step.
    pub to: &'a State,
    /// The solution in between.
    pub dense: &'a dyn Dense,
    /// Nothing touched on the way and all loads were steady: the solution in between is exact.
    pub flight: bool,
}

/// What the sink wants next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Go on.
    Continue,
    /// End the run here without an error.
    Stop,
}

/// Receives accepted steps. Observers record; integrators print nothing.
pub trait Sink {
    /// A step was accepted.
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control;

    /// The state was switched or handed over at one instant, from `before` to `after`.
    fn restarted(&mut self, _sys: &mut dyn SecondOrderSystem, _before: &State, _after: &State) {}

    /// False lets the loop skip copies that only observers need.
    fn wants_restarts(&self) -> bool {
        true
    }

    /// Wall time that the observer itself has taken so far. No bound of a run counts it.
    fn spent(&self) -> Duration {
        Duration::ZERO
    }
}

/// Ignores everything: for timing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NullSink;

impl Sink for NullSink {
    #[inline]
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, _step: &AcceptedStep<'_>) -> Control {
        Control::Continue
    }
    fn wants_restarts(&self) -> bool {
        false
    }
}

/// A method that can integrate a system over a plan.
pub trait Integrator {
    /// What the method declares.
    fn info(&self) -> &'static MethodInfo;

    /// Crosses flights in one step of the system's own closed form ([`SecondOrderSystem::flight_path`]), or steps
    /// through them; false where the method cannot do what is asked.
    fn free_flight(&mut self, on: bool) -> bool {
        !on
    }

    /// Integrates from `s` to the end of the plan; `s` ends at the last accepted state, `work` counts also
    /// when the run fails.
    fn run(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        plan: &TimePlan<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<(), StepError>;

    /// Goes on from the state in which the last run of this method ended, as if that had not ended there: discrete state,
    /// grid of fixed steps and what the method remembers are kept, so that a run in pieces is the run as a whole.
    /// [`Change::Restart`] where forces jumped in between: the method then starts afresh, as at a breakpoint. A method that
    /// has not run begins a run.
    fn resume(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        change: Change,
        plan: &TimePlan<'_>,
        sink: &mut dyn Sink,
        work: &mut Work,
    ) -> Result<(), StepError>;

    /// A copy with all that the method remembers: beside a copy of the state it is what a run is set back to.
    fn duplicate(&self) -> Box<dyn Integrator>;
}

/// A one-step method. `from` is never changed by a step, so a step may be repeated with another size.
pub trait OneStep {
    /// What the method declares.
    fn info(&self) -> &'static MethodInfo;

    /// Called once at the start of a run: refuses systems that the method cannot run.
    fn begin(
        &mut self,
        _sys: &mut dyn SecondOrderSystem,
        _resolution: Resolution,
    ) -> Result<(), StepError> {
        Ok(())
    }

    /// Moves the static equilibrium that a system starts in to the state that steps of the method leave at rest, where the two
    /// differ. Called once, after [`Self::begin`].
    fn balance(
        &mut self,
        _sys: &mut dyn SecondOrderSystem,
        _s: &mut State,
        _resolution: Resolution,
        _work: &mut Work,
    ) {
    }

    /// Sizes buffers and evaluates what the first step needs; called again after every restart.
    fn restart(&mut self, sys: &mut dyn SecondOrderSystem, s: &State, work: &mut Work);

    /// One step of size `h` [s]. `to` has the right lengths and the discrete state of `from`. Returns the error
    /// estimate scaled by `tolerance` (accepted when <= 1), or 0 for methods without one.
    fn step(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        from: &State,
        h: f64,
        tolerance: &Tolerance,
        to: &mut State,
        work: &mut Work,
    ) -> Result<f64, StepError>;

    /// A time up to which the method goes from `s` in one step, whatever step `h` is asked for, because nothing
    /// touches until then; at most `s.t + h` where it does not.
    fn free_flight_end(&mut self, _sys: &mut dyn SecondOrderSystem, s: &State, _h: f64) -> f64 {
        s.t
    }

    /// The step of at most this size that the method likes best under a tolerance.
    fn preferred_step(&self, h: f64) -> f64 {
        h
    }

    /// The last step was accepted and nothing changed: move cached end values to the start.
    fn advance(&mut self);

    /// The solution inside the last step; the default is the cubic Hermite interpolant of `q` from both
    /// ends and its derivative.
    fn interpolate(&self, from: &State, to: &State, theta: f64, q: &mut [f64], v: &mut [f64]) {
        crate::interpolation::hermite(from, to, theta, q, v);
    }

    /// [`Dense::damping_beyond_trapezoid`] of the last step.
    fn damping_beyond_trapezoid(&self, _from: &State, _to: &State, _beyond: &mut [f64]) -> bool {
        false
    }
}

/// Tolerances per coordinate.
#[derive(Clone, Debug, Default)]
pub struct Tolerance {
    /// Relative tolerance, 0 for fixed steps.
    pub rtol: f64,
    /// Magnitudes of coordinates.
    pub q: Vec<f64>,
    /// Magnitudes of velocities.
    pub v: Vec<f64>,
}

impl Tolerance {
    /// Reads the system's scales.
    pub fn of(sys: &dyn SecondOrderSystem, rtol: f64) -> Self {
        let n = sys.layout().n;
        let mut tol = Tolerance {
            rtol,
            q: vec![1.0; n],
            v: vec![1.0; n],
        };
        sys.scales(&mut tol.q, &mut tol.v);
        // A scale that is no magnitude would turn the error estimate into infinity or NaN.
        for scale in tol.q.iter_mut().chain(&mut tol.v) {
            if !(scale.is_finite() && *scale > 0.0) {
                *scale = 1.0;
            }
        }
        tol
    }
}
