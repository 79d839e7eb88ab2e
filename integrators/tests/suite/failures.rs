//! Every early end of a run, caused on purpose: the error has the time, and the state is the last accepted one.

use crate::problems::*;
use crate::{split_off, unit_masses};
use gearbench_integrators::Bound;
use gearbench_integrators::explicit::runge_kutta::RungeKutta;
use gearbench_integrators::explicit::semi_implicit_euler::SemiImplicitEuler;
use gearbench_integrators::explicit::velocity_verlet::VelocityVerlet;
use gearbench_integrators::implicit::generalised_alpha::GeneralisedAlpha;
use gearbench_integrators::method::Tolerance;
use gearbench_integrators::modal::resonance::Filter;
use gearbench_integrators::modal::trigonometric::Trigonometric;
use gearbench_integrators::{
    Change, Events, Layout, METHODS, ModalSplit, OneStep, Resolution, SecondOrderSystem, State,
    StateView, StepError, Stepping, TimePlan, Work,
};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// System `x'' = f(t, x)` with a separate tangent, right or wrong.
struct Scalar {
    force: fn(f64, f64) -> f64,
    tangent: fn(f64) -> f64,
}

impl SecondOrderSystem for Scalar {
    unit_masses!(|_own| [1, 0, 0], modal: ModalSplit);

    fn characteristic_time(&self, _at: StateView<'_>) -> f64 {
        0.1
    }
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        f[0] = (self.force)(at.t, at.q[0]);
    }
    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], _dv: &[f64], df: &mut [f64]) {
        df[0] = (self.tangent)(at.q[0]) * dq[0];
    }
}

split_off!(Scalar, |_own, _i| (0.7, 0.0));
split_off!(PermanentEvent, |_own, _i| (1.0, 0.0));

/// Returns a plan that suits the method.
fn plan_for(m: &gearbench_integrators::Method, t_end: f64) -> TimePlan<'static> {
    plan_of(m, t_end, 100.0 * t_end, 1e-6)
}

#[test]
fn a_force_that_is_not_a_number_ends_the_run_where_it_starts() {
    for m in METHODS {
        let mut sys = Scalar {
            force: |t, x| if t > 0.505 { f64::NAN } else { -x },
            tangent: |_| -1.0,
        };
        let (s, _, result) = run(m, &mut sys, state(&[1.0], &[0.0]), &plan_for(m, 1.0));
        let Err(StepError::NonFinite { t, dof: 0 }) = result else {
            panic!("{}: {result:?}", m.info.id)
        };
        assert!(t > 0.4 && t < 0.7, "{}: {t}", m.info.id);
        assert!(s.t <= 0.52 && s.q[0].is_finite(), "{}: {s:?}", m.info.id);
    }
}

/// The solution `x = (1 - t)^-2` of `x'' = 6 x^2` is infinite at one.
#[test]
fn a_blow_up_is_reported_near_its_time() {
    for m in METHODS {
        let mut sys = Scalar {
            force: |_, x| 6.0 * x * x,
            tangent: |x| 12.0 * x,
        };
        let (s, _, result) = run(m, &mut sys, state(&[1.0], &[2.0]), &plan_for(m, 3.0));
        let error = result.expect_err(m.info.id);
        println!("{:20} {error}", m.info.id);
        let t = match error {
            StepError::NonFinite { t, .. }
            | StepError::StepTooSmall { t, .. }
            | StepError::NewtonDiverged { t, .. }
            | StepError::SingularTangent { t, .. } => t,
            e => panic!("{}: {e:?}", m.info.id),
        };
        assert!((0.9..1.5).contains(&t), "{}: {t}", m.info.id);
        assert!(s.q[0].is_finite() && s.v[0].is_finite());
    }
}

#[test]
fn newton_with_a_wrong_tangent_diverges() {
    for id in ["newmark", "hht-alpha", "generalised-alpha"] {
        // One that is too soft goes too far, which the search along corrections makes up for.
        let mut sys = Scalar {
            force: |_, x| -100.0 * x,
            tangent: |_| 0.0,
        };
        let (_, _, result) = run(by_id(id), &mut sys, state(&[1.0], &[0.0]), &steps(3.0, 3.0));
        assert!(result.is_ok(), "{id}: {result:?}");
        // One that points the other way leads nowhere.
        let mut sys = Scalar {
            force: |_, x| -100.0 * x,
            tangent: |_| 8.0,
        };
        let (s, _, result) = run(by_id(id), &mut sys, state(&[1.0], &[0.0]), &steps(3.0, 3.0));
        let Err(StepError::NewtonDiverged {
            t: 0.0,
            h,
            residual,
            iterations: 60,
        }) = result
        else {
            panic!("{id}: {result:?}")
        };
        assert!(h == 1.0 && residual > 1.0);
        assert_eq!(s.q, [1.0]);
    }
}

#[test]
fn a_singular_newton_matrix_is_named() {
    // Newmark: M + h^2/4 K with h = 1 and K = -4.
    let mut sys = Scalar {
        force: |_, x| 4.0 * x,
        tangent: |_| 4.0,
    };
    let (_, _, result) = run(
        by_id("newmark"),
        &mut sys,
        state(&[1.0], &[0.0]),
        &steps(3.0, 3.0),
    );
    assert_eq!(result, Err(StepError::SingularTangent { t: 0.0, h: 1.0 }));
}

#[test]
fn a_singular_force_drives_the_step_to_zero() {
    for m in METHODS
        .iter()
        .filter(|m| m.info.stepping != Stepping::Fixed)
    {
        let mut sys = Scalar {
            force: |t, _| (0.5 - t).abs().powf(-1.5).min(1e300),
            tangent: |_| 0.0,
        };
        let plan = tolerance(1.0, 1e-6);
        let (_, _, result) = run(m, &mut sys, state(&[0.0], &[0.0]), &plan);
        let Err(StepError::StepTooSmall { t, h }) = result else {
            panic!("{}: {result:?}", m.info.id)
        };
        assert!((t - 0.5).abs() < 1e-3 && h < 1e-6, "{}: {t} {h}", m.info.id);
    }
}

#[test]
fn bounds_of_a_run_are_kept() {
    let yes = AtomicBool::new(true);
    for m in METHODS {
        let plan = TimePlan {
            max_steps: 10,
            ..plan_for(m, 50.0)
        };
        let (s, work, result) = run(m, &mut Duffing, Duffing::start(), &plan);
        let Err(StepError::Timeout { t, steps, bound }) = result else {
            panic!("{}: {result:?}", m.info.id)
        };
        let found = (t, steps, bound);
        assert_eq!(found, (s.t, work.steps, Bound::Steps(10)), "{}", m.info.id);
        assert!(work.steps + work.rejected <= 11 && s.t > 0.0, "{work:?}");

        let plan = TimePlan {
            time_limit: Some(Duration::ZERO),
            ..plan_for(m, 50.0)
        };
        let (_, work, result) = run(m, &mut Duffing, Duffing::start(), &plan);
        let bound = Bound::Time {
            limit: 0.0,
            observers: 0.0,
        };
        let stopped = StepError::Timeout {
            t: 0.0,
            steps: 0,
            bound,
        };
        assert_eq!(result, Err(stopped));
        assert_eq!(work.steps, 0);

        let plan = TimePlan {
            cancel: Some(&yes),
            ..plan_for(m, 50.0)
        };
        let (_, _, result) = run(m, &mut Duffing, Duffing::start(), &plan);
        assert_eq!(result, Err(StepError::Interrupted { t: 0.0 }));
    }
}

#[test]
fn plans_that_a_method_cannot_run_are_refused() {
    for m in METHODS {
        let step = TimePlan::new(1.0, Resolution::Step(0.1));
        let tol = TimePlan::new(1.0, Resolution::Tolerance(1e-5));
        for (plan, refused) in [
            (step, m.info.stepping == Stepping::Adaptive),
            (tol, m.info.stepping == Stepping::Fixed),
        ] {
            let (_, _, result) = run(m, &mut Duffing, Duffing::start(), &plan);
            let is = matches!(result, Err(StepError::Unsupported { .. }));
            assert_eq!(is, refused, "{} {result:?}", m.info.id);
        }
        for resolution in [
            Resolution::Step(0.0),
            Resolution::Step(-1.0),
            Resolution::Step(f64::NAN),
            Resolution::Step(1e-20),
            Resolution::Tolerance(0.0),
            Resolution::Tolerance(f64::NAN),
        ] {
            let plan = TimePlan::new(1.0, resolution);
            let (_, _, result) = run(m, &mut Duffing, Duffing::start(), &plan);
            assert!(result.is_err(), "{} {resolution:?}", m.info.id);
        }
    }
}

#[test]
fn a_run_of_no_length_does_nothing() {
    for m in METHODS {
        for t_end in [0.0, -1.0] {
            let plan = TimePlan {
                t_end,
                ..plan_for(m, 1.0)
            };
            let (s, work, result) = run(m, &mut Duffing, Duffing::start(), &plan);
            assert_eq!(
                (s, work, result),
                (Duffing::start(), Work::default(), Ok(()))
            );
        }
    }
}

/// With all coordinates prescribed nothing is left to integrate, but time advances. diffsol cannot do that.
#[test]
fn a_system_without_coordinates_runs_or_is_refused() {
    for m in METHODS {
        let mut chain = Chain {
            masses: Vec::new(),
            damping: 0.0,
        };
        let (s, work, result) = run(m, &mut chain, state(&[], &[]), &plan_for(m, 1.0));
        if m.info.citation.ends_with("diffsol") {
            assert!(matches!(result, Err(StepError::Unsupported { .. })));
        } else {
            assert_eq!((s.t, result), (1.0, Ok(())), "{}", m.info.id);
            assert!(work.steps > 0);
        }
    }
}

/// System with an event function that no transition makes positive.
struct PermanentEvent;

impl SecondOrderSystem for PermanentEvent {
    unit_masses!(|_own| [1, 1, 1], modal: ModalSplit, events: Events);

    fn characteristic_time(&self, _at: StateView<'_>) -> f64 {
        0.1
    }
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        f[0] = -at.q[0];
    }
    fn tangent_times(&mut self, _at: StateView<'_>, dq: &[f64], _dv: &[f64], df: &mut [f64]) {
        df[0] = -dq[0];
    }
}

impl Events for PermanentEvent {
    fn event_functions(&mut self, at: StateView<'_>, out: &mut [f64]) {
        out[0] = 0.6 - at.t;
    }
    fn transition(&mut self, s: &mut State, _event: usize) -> Change {
        s.discrete[0] = 1.0 - s.discrete[0];
        Change::Restart
    }
}

#[test]
fn chatter_is_named_and_ends() {
    for m in METHODS {
        let mut s = state(&[1.0], &[0.0]);
        s.discrete = vec![0.0];
        let (s, _, result) = run(m, &mut PermanentEvent, s, &plan_for(m, 1.0));
        let Err(StepError::Chatter { t, events }) = result else {
            panic!("{}: {result:?}", m.info.id)
        };
        assert!((t - 0.6).abs() < 1e-9 && events > 100, "{}: {t}", m.info.id);
        assert!(s.q[0].is_finite());
    }
}

/// A step may be repeated with any size: it does not change its start and returns the same bits again.
#[test]
fn a_step_changes_nothing_but_its_end() {
    fn check(mut m: impl OneStep) {
        let (from, mut work) = (Duffing::start(), Work::default());
        let tolerance = Tolerance::of(&Duffing, 1e-6);
        m.begin(&mut Duffing, Resolution::Step(1e-3)).unwrap();
        m.restart(&mut Duffing, &from, &mut work);
        let before = from.clone();
        let mut ends = [0.1, 0.03, 0.1].map(|h| {
            let mut to = from.clone();
            m.step(&mut Duffing, &from, h, &tolerance, &mut to, &mut work)
                .unwrap();
            assert_eq!(from, before, "{}", m.info().id);
            to
        });
        assert_eq!(ends[0], ends[2], "{}", m.info().id);
        // After an accepted step the cached end values belong to the next start.
        m.advance();
        let [_, _, from] = &mut ends;
        let mut first = from.clone();
        let mut again = from.clone();
        m.step(&mut Duffing, from, 0.1, &tolerance, &mut first, &mut work)
            .unwrap();
        m.step(&mut Duffing, from, 0.1, &tolerance, &mut again, &mut work)
            .unwrap();
        assert_eq!(first, again, "{}", m.info().id);
    }
    check(SemiImplicitEuler::default());
    check(VelocityVerlet::default());
    check(Trigonometric::new(Filter::None));
    check(Trigonometric::new(Filter::All));
    check(RungeKutta::rk4());
    check(RungeKutta::dopri5());
    check(GeneralisedAlpha::newmark(0.25));
    check(GeneralisedAlpha::hht(0.1));
    check(GeneralisedAlpha::chung_hulbert(0.6));
}
