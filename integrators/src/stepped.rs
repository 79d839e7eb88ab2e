//! The loop of all one-step methods: fixed steps or PI step control, table knots, event location.
//!
//! **Events.** After a tentative step the guards are read. Where one fell through zero, the first root is
//! found on the step's interpolant, the method itself steps there, and the rest, a part in ten thousand of
//! that step or less, is read from the interpolant of the shorter step, so that the event time has the
//! accuracy of the method and not of its interpolant. The branch is switched there and the method
//! restarts: every step sees one smooth force. Without this a fourth-order method shows order 1.8 on an
//! elastic impact and 0.9 with Kelvin-Voigt damping. A guard that falls and rises within one step is not
//! seen: the step must resolve the shortest contact.
//!
//! **Step control** (adaptive methods): `h <- h * clamp(0.9 err^-(0.85 x) err_old^(0.2 x))`, `x = 1/p`
//! (Gustafsson 1991; exponents of Hairer, Norsett, Wanner, *Solving ODEs I*, II.4 and its DOPRI5); no
//! growth right after a rejected step; after a restart the step starts from the system's pace.
//!
//! **Fixed steps** lie on the grid `t0 + i h`. A knot or an event cuts a step short and the next one ends on
//! the grid again, whatever the rounding of sums. A method that knows how far nothing happens
//! ([`OneStep::reach`]) goes there in one step, to the last point of the grid before it; that step says nothing about
//! the next, and guards that fall in it (which pairs of teeth face each other) are set afresh at its end.
//!
//! **Coasts.** Told to ([`Integrator::coast`]), the loop does the same for every other method along the closed form that
//! the system itself knows ([`SecondOrderSystem::coast`]): no error but rounding, at a cost that does not grow with the
//! length of the flight. What a method would make of the flight, its drift of energy and phase among it, is then not
//! seen, so coasts are off unless asked for: a comparison of methods shows what the methods do. Steps in contact are those
//! of the method; errors that cancel over flight and contact together, as those of first order of semi-implicit Euler
//! nearly do, cancel no more.

mod locate;

use crate::bounds::Bounds;
use crate::coast::{CoastDense, Coasting};
use crate::events::Watch;
pub use crate::interpolation::{hermite, hermite_with_acceleration};
use crate::method::{
    AcceptedStep, Control, Dense, Integrator, MethodInfo, OneStep, Resolution, Sink, StepError,
    Stepping, TimePlan, Tolerance, Work,
};
use crate::system::{Change, SecondOrderSystem, State};

/// Events allowed at one instant before the run is called chatter.
pub(crate) const MAX_EVENTS_AT_ONCE: u32 = 200;

/// Gives a one-step method its loop.
#[derive(Clone, Debug, Default)]
pub struct Stepped<M> {
    method: M,
    coasting: Coasting,
}

impl<M> Stepped<M> {
    /// Wraps a method.
    pub fn new(method: M) -> Self {
        Stepped {
            method,
            coasting: Coasting::default(),
        }
    }
}

/// The solution inside a step that the method made to `end` and that was accepted to `stretch` of it.
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
}

/// Buffers of one run.
struct Run {
    /// End of the step as the method made it.
    end: State,
    /// The event inside it.
    event: State,
    watch: Watch,
}

/// How far a located step goes.
enum Located {
    /// The guards in `watch.falling` are at their root at the start of the step.
    Start,
    /// `event` lies at this fraction of the step to `end`.
    At(f64),
}

/// The tolerance a plan asks for (0: fixed steps), where the method can do that.
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

/// First step of an adaptive method after a restart [s]: the estimate goes with `(h/pace)^(1/exponent)`.
pub(crate) fn first_step(
    sys: &dyn SecondOrderSystem,
    s: &State,
    plan: &TimePlan<'_>,
    rtol: f64,
    exponent: f64,
) -> f64 {
    let pace = sys.pace(s.at()).min(plan.t_end - s.t);
    pace * (3.0 * rtol.powf(exponent)).min(0.5)
}

/// Step over tolerance, `h ~ rtol^x`, of a method: its error goes with `h^order ~ rtol^slope`.
pub(crate) fn step_exponent(info: &MethodInfo) -> f64 {
    info.tolerance_slope / f64::from(info.order)
}

/// The smallest step that time resolves around `t` [s].
pub(crate) fn resolution_of_time(t: f64, plan: &TimePlan<'_>) -> f64 {
    4.0 * f64::EPSILON * t.abs().max(1e-3 * plan.t_end.abs())
}

impl<M: OneStep> Integrator for Stepped<M> {
    fn info(&self) -> &'static MethodInfo {
        self.method.info()
    }

    fn coast(&mut self, on: bool) -> bool {
        // A method that is exact for oscillators has flights of its own.
        let of_its_own = self.method.info().linear_part;
        self.coasting.on = on && !of_its_own;
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
        let info = self.method.info();
        let rtol = tolerance_of(plan, info)?;
        let layout = sys.layout();
        let exponent = step_exponent(info);
        let tolerance = Tolerance::of(sys, rtol);
        sys.begin(s, plan.events);
        if s.t >= plan.t_end {
            return Ok(());
        }
        self.method.begin(sys, plan.resolution)?;
        self.coasting.hope();
        self.method.restart(sys, s, work);
        let mut r = Run {
            end: s.clone(),
            event: s.clone(),
            watch: Watch::new(layout.guards),
        };
        let events = plan.events && layout.guards > 0;
        if events {
            sys.guards(s.at(), &mut r.watch.before);
        }

        let t_begin = s.t;
        let (fixed, mut h_next) = match plan.resolution {
            Resolution::Step(h) => (true, h),
            Resolution::Tolerance(_) => (false, first_step(sys, s, plan, rtol, exponent)),
        };
        let least = 4.0 * f64::EPSILON * t_begin.abs().max(plan.t_end.abs());
        if !(h_next.is_finite() && h_next > if fixed { least } else { 0.0 }) {
            return Err(StepError::StepTooSmall { t: s.t, h: h_next });
        }
        let mut on_grid: u64 = 0;
        let mut err_old: f64 = 1e-4;
        let mut after_rejection = false;
        let mut bounds = Bounds::default();
        let mut events_here = 0u32;
        let mut knot = sys.next_knot(s.t);

        while s.t < plan.t_end {
            bounds.check(plan, s.t, work)?;
            // Land on the end and on knots; never leave a sliver of a step behind.
            let stop = plan.t_end.min(knot);
            let mut t_new = if fixed {
                while t_begin + (on_grid + 1) as f64 * h_next <= s.t + 1e-9 * h_next {
                    on_grid += 1;
                }
                t_begin + (on_grid + 1) as f64 * h_next
            } else {
                h_next = self.method.favoured(h_next);
                s.t + h_next
            };
            let mut reach = self.method.reach(sys, s, h_next);
            let mut coasts = false;
            if self.coasting.on {
                reach = self.coasting.reach(sys, s, t_new);
                coasts = true;
            }
            reach = reach.min(stop);
            if fixed && reach < stop {
                reach = t_begin + ((reach - t_begin) / h_next).floor() * h_next;
            }
            let leaps = reach > t_new + 1e-9 * h_next;
            coasts &= leaps;
            if leaps {
                t_new = reach;
                if fixed {
                    on_grid = ((reach - t_begin) / h_next) as u64 - 1;
                }
            } else if t_new >= stop - 1e-9 * h_next {
                t_new = stop;
            } else if !fixed && t_new > stop - h_next {
                t_new = 0.5 * (s.t + stop);
            }
            let h = t_new - s.t;

            // An event may leave less than time resolves before a knot or the end: step over that.
            let sliver = t_new == stop && h <= resolution_of_time(s.t, plan);
            let mut located = false;
            let mut progressed = true;
            if sliver {
                s.t = stop;
            } else if coasts {
                r.end.t = t_new;
                let coast = &self.coasting.coast;
                coast.at(t_new, &mut r.end.q, &mut r.end.v);
                if let Some(dof) = first_not_finite(&r.end) {
                    return Err(StepError::NonFinite { t: t_new, dof });
                }
                let step = AcceptedStep {
                    from: s,
                    to: &r.end,
                    dense: &CoastDense {
                        coast,
                        from: s.t,
                        to: t_new,
                    },
                    flight: true,
                };
                let control = sink.accepted(sys, &step);
                work.steps += 1;
                std::mem::swap(s, &mut r.end);
                if control == Control::Stop {
                    return Ok(());
                }
            } else {
                let err = self.method.step(sys, s, h, &tolerance, &mut r.end, work)?;
                r.end.t = t_new;
                if !fixed {
                    let bad = !err.is_finite();
                    if bad || err > 1.0 {
                        work.rejected += 1;
                        after_rejection = true;
                        let factor = if bad {
                            0.1
                        } else {
                            (0.9 * err.powf(-exponent)).clamp(0.1, 0.9)
                        };
                        h_next = h * factor;
                        if h_next < resolution_of_time(s.t, plan) {
                            return Err(match first_not_finite(&r.end) {
                                Some(dof) if bad => StepError::NonFinite { t: s.t, dof },
                                None if bad => StepError::NonFinite { t: s.t, dof: 0 },
                                _ => StepError::StepTooSmall { t: s.t, h: h_next },
                            });
                        }
                        continue;
                    }
                }
                if let Some(dof) = first_not_finite(&r.end) {
                    return Err(StepError::NonFinite { t: t_new, dof });
                }

                let mut stretch = 1.0;
                if events && !leaps {
                    sys.guards(r.end.at(), &mut r.watch.after);
                    if r.watch.any_fell() {
                        located = true;
                        match self.locate(sys, s, h, &tolerance, &mut r, work)? {
                            Located::At(x) => stretch = x,
                            Located::Start => progressed = false,
                        }
                    }
                }
                if progressed {
                    let to = if located { &r.event } else { &r.end };
                    let dense = MethodDense {
                        method: &self.method,
                        from: s,
                        end: &r.end,
                        stretch,
                    };
                    let step = AcceptedStep {
                        from: s,
                        to,
                        dense: &dense,
                        flight: leaps,
                    };
                    let control = sink.accepted(sys, &step);
                    work.steps += 1;
                    progressed = to.t - s.t > 1e-12 * (plan.t_end - t_begin);
                    std::mem::swap(s, if located { &mut r.event } else { &mut r.end });
                    if control == Control::Stop {
                        return Ok(());
                    }
                }
                if !(fixed || located || leaps) {
                    let e = err.max(1e-10);
                    let largest = if after_rejection { 1.0 } else { 10.0 };
                    let factor = 0.9 * e.powf(-0.85 * exponent) * err_old.powf(0.2 * exponent);
                    // A step cut by a knot or the end says nothing about the step to take next.
                    let uncut = if t_new == stop { h_next } else { 0.0 };
                    h_next = (h * factor.clamp(0.2, largest)).max(uncut);
                    if h_next < resolution_of_time(s.t, plan) {
                        return Err(StepError::StepTooSmall { t: s.t, h: h_next });
                    }
                    err_old = e;
                    after_rejection = false;
                }
            }

            let keep = sink.wants_restarts();
            if keep {
                r.event.copy_from(s);
            }
            let mut change = Change::None;
            if coasts {
                // Teeth are handed over before anyone asks which of them face each other.
                change = Change::Restart;
                sys.commit(s);
                if events {
                    sys.begin(s, true);
                }
            } else if events && leaps && progressed {
                // Nothing touched on the way, so no branch ended; the next one starts from here.
                r.event.memory.copy_from_slice(&s.memory);
                sys.begin(s, true);
                sys.guards(s.at(), &mut r.watch.after);
                if r.event.memory != s.memory {
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
                    sys.switch(s, r.watch.falling[i]);
                }
            }
            if !coasts && sys.commit(s) == Change::Restart {
                change = Change::Restart;
            }
            if s.t >= knot {
                knot = sys.next_knot(s.t);
                change = Change::Restart;
            }
            if change == Change::Restart {
                if keep {
                    sink.restarted(sys, &r.event, s);
                }
                if s.t >= plan.t_end {
                    break;
                }
                work.restarts += 1;
                self.method.restart(sys, s, work);
                self.coasting.hope();
                if !fixed {
                    h_next = h_next.min(first_step(sys, s, plan, rtol, exponent));
                    err_old = 1e-4;
                    after_rejection = false;
                }
                if events {
                    sys.guards(s.at(), &mut r.watch.before);
                }
            } else if !sliver {
                self.method.advance();
                r.watch.advance();
            }
            if located && !progressed {
                events_here += 1;
                if events_here > MAX_EVENTS_AT_ONCE {
                    return Err(StepError::Chatter {
                        t: s.t,
                        events: events_here,
                    });
                }
            } else {
                events_here = 0;
            }
            // The lengths are constant; the memory that the next step starts from is the committed one.
            r.end.memory.copy_from_slice(&s.memory);
            r.event.memory.copy_from_slice(&s.memory);
        }
        Ok(())
    }
}

/// The first coordinate that is not finite in itself or its rate.
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
