//! Accuracy of the interpolant inside steps.

use crate::problems::*;
use gearbench_integrators::{
    AcceptedStep, Control, METHODS, Resolution, SecondOrderSystem, Sink, State, Stepping, TimePlan,
};

/// Largest error of `q` and `v` at inner points of all steps, and largest mismatch at step ends.
#[derive(Default)]
struct Inside {
    q: f64,
    v: f64,
    ends: f64,
}

impl Sink for Inside {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let (mut q, mut v) = ([0.0; 2], [0.0; 2]);
        for theta in [0.1, 0.3, 0.5, 0.7, 0.9] {
            step.dense.eval(theta, &mut q, &mut v);
            let [qe, ve, _] = Duffing::exact(step.from.t + theta * (step.to.t - step.from.t));
            for i in 0..2 {
                self.q = self.q.max((q[i] - qe[i]).abs());
                self.v = self.v.max((v[i] - ve[i]).abs());
            }
        }
        let mut mismatch = |theta: f64, s: &State| {
            step.dense.eval(theta, &mut q, &mut v);
            for i in 0..2 {
                self.ends = self
                    .ends
                    .max((q[i] - s.q[i]).abs().max((v[i] - s.v[i]).abs()));
            }
        };
        mismatch(1.0, step.to);
        mismatch(0.0, step.from);
        Control::Continue
    }
}

fn inside(method: &gearbench_integrators::Method, plan: &TimePlan<'_>) -> (Inside, f64) {
    let mut sink = Inside::default();
    let (s, _) = watch(
        method.info.id,
        &mut Duffing,
        Duffing::start(),
        plan,
        &mut sink,
    );
    (sink, Duffing::error(&s))
}

/// The interpolant is at least as accurate as the solution for methods up to order four, and of order four for
/// Dormand-Prince: its local order is compared with the global order of the method.
#[test]
fn dense_output_does_not_spoil_the_order() {
    for method in fixed_step() {
        let info = method.info;
        let first = if info.order > 2 { 60.0 } else { 200.0 };
        let (mut q, mut v) = (Vec::new(), Vec::new());
        for i in 0..5 {
            let n = (first * f64::powi(1.4, i)).round();
            let (e, _) = inside(method, &steps(5.0, n));
            assert!(e.ends < 1e-13, "{}: ends {:.1e}", info.id, e.ends);
            q.push((5.0 / n, e.q));
            v.push((5.0 / n, e.v));
        }
        let (q, v) = (slope(&q), slope(&v));
        println!(
            "{:20} interpolant of order {q:.2} in q, {v:.2} in v",
            info.id
        );
        let wanted = f64::from(info.order.min(4)) - 0.15;
        assert!(q >= wanted && v >= wanted, "{}: {q:.2} {v:.2}", info.id);
    }
}

/// Under a tolerance the error inside steps stays near the error at the end of the run.
#[test]
fn dense_output_of_adaptive_methods_follows_the_tolerance() {
    for method in METHODS
        .iter()
        .filter(|m| m.info.stepping != Stepping::Fixed)
    {
        for rtol in [1e-5, 1e-7, 1e-9] {
            let plan = TimePlan::new(20.0, Resolution::Tolerance(rtol));
            let (e, end) = inside(method, &plan);
            println!(
                "{:10} {rtol:.0e}: inside q {:.1e} v {:.1e}, at the end {end:.1e}, ends of steps {:.1e}",
                method.info.id, e.q, e.v, e.ends
            );
            let allowed = 5e3 * rtol.powf(method.info.tolerance_slope.min(0.8));
            assert!(
                e.q.max(e.v) < allowed,
                "{} at {rtol:.0e}: {:.1e} {:.1e}",
                method.info.id,
                e.q,
                e.v
            );
        }
    }
}
