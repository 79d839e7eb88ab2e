//! One impact in closed form, force jump at touch-down included: errors and peaks of a run are the integrator's, whatever
//! was sampled.
//!
//! Two free gears with a Kelvin-Voigt contact are one mass `m = 1/(r1^2/I1 + r2^2/I2)` on a spring and a dashpot:
//! `d = v0/w_d exp(-z w s) sin(w_d s)`, `f = k d + c d'` from touch-down on until it vanishes.

use gearbench::context::Context;
use gearbench::experiment::run::{Job, NO_BOUND, run};
use gearbench_integrators::Scheme;
use gearbench_integrators::table::{DOPRI5, RK4, VELOCITY_VERLET};
use gearbench_models::law::Damping;
use gearbench_models::spec::{ContactSpec, Modelling, effective_radius};
use gearbench_reports::force::ForceHistory;
use gearbench_reports::metrics::compare;
use gearbench_reports::record::{Metrics, Run};
use gearbench_reports::series::TimeSeries;
use gearbench_tests::*;

const T_END: f64 = 1.5e-4;
const GAP: f64 = 3.1e-6;
const SPEED: f64 = 20.0;
/// Stiffness of the pair [N/m]: per width, of 10 mm.
const K: f64 = 2e8;

/// An impact with a damping ratio: dashpot [N s/m], first contact [s], and the force after it.
struct Impact {
    dashpot: f64,
    touch: f64,
    force: Box<dyn Fn(f64) -> f64>,
    release: f64,
}

fn impact(ratio: f64) -> Impact {
    let scene = case_a(GAP);
    let r = [0, 1].map(|i: usize| effective_radius(&scene.gears[i].body));
    let inertia = |i: usize| scene.gears[i].inertia.unwrap();
    let m = (r[0] * r[0] / inertia(0) + r[1] * r[1] / inertia(1)).recip();
    let w = (K / m).sqrt();
    let (dashpot, v0) = (2.0 * ratio * (K * m).sqrt(), SPEED * r[0]);
    let damped = w * (1.0 - ratio * ratio).sqrt();
    let force = move |s: f64| {
        let (sin, cos) = (damped * s).sin_cos();
        let (d, rate) = (sin / damped, cos - ratio * w / damped * sin);
        v0 * (-ratio * w * s).exp() * (K * d + dashpot * rate)
    };
    // It pushes until it vanishes, before the flanks part.
    let (mut a, mut b) = (1e-9, std::f64::consts::PI / damped);
    for _ in 0..200 {
        let middle = 0.5 * (a + b);
        if force(middle) > 0.0 {
            a = middle;
        } else {
            b = middle;
        }
    }
    Impact {
        dashpot,
        touch: GAP / v0,
        force: Box::new(force),
        release: a,
    }
}

impl Impact {
    /// Returns the exact history in a number of pieces.
    fn exact(&self, pieces: u32) -> TimeSeries {
        let mut force = ForceHistory::default();
        for k in 0..pieces {
            let node = |i: u32| {
                let s = self.release * (f64::from(k) + f64::from(i) / 5.0) / f64::from(pieces);
                (self.touch + s, (self.force)(s))
            };
            force.push(&(0..6).map(node).collect::<Vec<_>>());
        }
        let mut series = TimeSeries::named(["contact_force_pinion_wheel_n"]);
        series.push(0.0, &[0.0]);
        series.push(T_END, &[0.0]);
        series.forces = vec![force];
        series
    }

    fn run(&self, method: &Scheme, samples: u32) -> Run {
        let modelling = Modelling {
            gears: vec![rigid(); 2],
            contacts: vec![ContactSpec {
                damping: Damping::KelvinVoigt { c: self.dashpot },
                ..contact(K / 0.01)
            }],
        };
        let grid: Vec<f64> = (0..=samples)
            .map(|i| T_END * f64::from(i) / f64::from(samples))
            .collect();
        run(&Job {
            scene: &case_a(GAP),
            modelling: &modelling,
            context: &Context::default(),
            method,
            t_end: T_END,
            grid: &grid,
            also_steps: true,
            forces: false,
            measurable: false,
            paths: false,
            histories: false,
            motion: false,
            pictures: None,
            events: true,
            repeats: 0,
            timeout: NO_BOUND,
            max_steps: 1_000_000,
        })
        .unwrap()
    }

    fn errors(&self, method: &Scheme) -> Metrics {
        compare(
            self.run(method, 100).finished().unwrap(),
            &self.exact(400),
            "exact",
        )
    }
}

/// Returns the slope of log(error) over log(resolution).
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let over: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    over / logs.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// The jump at touch-down is no limit: errors and peaks fall as the method does, in the L1 norm twice as fast as in the
/// L2 norm where the event time rules.
#[test]
fn errors_of_a_jumping_force_fall_with_the_order_of_the_method() {
    let impact = impact(0.2);
    for (name, schemes, least) in [
        (
            "rk4",
            [8e-6, 4e-6, 2e-6, 1e-6].map(|h| (h, RK4.at_step(h))),
            3.0,
        ),
        (
            "velocity-verlet",
            [8e-7, 4e-7, 2e-7, 1e-7].map(|h| (h, VELOCITY_VERLET.at_step(h))),
            1.8,
        ),
        (
            "dopri5",
            [1e-4, 1e-6, 1e-8, 1e-10].map(|r| (r, DOPRI5.at_tolerance(r))),
            0.8,
        ),
    ] {
        let found: Vec<(f64, Metrics)> = (schemes.iter())
            .map(|(x, scheme)| (*x, impact.errors(scheme)))
            .collect();
        let fitted = |of: fn(&Metrics) -> Option<f64>| {
            slope(
                &found
                    .iter()
                    .map(|(x, m)| (*x, of(m).unwrap().abs()))
                    .collect::<Vec<_>>(),
            )
        };
        let l1 = fitted(|m| m.force_l1);
        let peak = fitted(|m| m.peak_force_rel);
        let last = &found[3].1;
        println!(
            "{name}: order {l1:.2} in the L1 norm, {peak:.2} of the peak, {:.2} in the L2 norm; finest {:.1e}, {:.1e}, {:.1e}",
            fitted(|m| m.force_l2),
            last.force_l1.unwrap(),
            last.peak_force_rel.unwrap(),
            last.force_l2.unwrap()
        );
        assert!(l1 > least && peak > least, "{name}: {l1:.2}, {peak:.2}");
    }
    let fine = impact.errors(&DOPRI5.at_tolerance(1e-12));
    assert!(fine.force_l1.unwrap() < 1e-9, "{fine:?}");
    assert!(fine.peak_force_rel.unwrap().abs() < 1e-9, "{fine:?}");
}

/// A contact damped so much that its force is greatest just after touch-down: steps of any size find the peak.
#[test]
fn the_force_just_after_touch_down_is_not_lost() {
    let impact = impact(0.7);
    let jump = (impact.force)(0.0);
    for scheme in [
        RK4.at_step(1e-9),
        RK4.at_step(1e-7),
        VELOCITY_VERLET.at_step(2e-9),
        DOPRI5.at_tolerance(1e-8),
    ] {
        let peak = impact.errors(&scheme).peak_force_n.unwrap();
        assert!(
            (peak / jump - 1.0).abs() < 1e-6,
            "{scheme:?}: {peak} {jump}"
        );
    }
}

/// A run against itself is zero, and no metric of the force depends on the samples of the histories.
#[test]
fn errors_are_free_of_sampling() {
    let impact = impact(0.2);
    for scheme in [
        RK4.at_step(1e-6),
        RK4.at_step(3e-9),
        DOPRI5.at_tolerance(1e-6),
    ] {
        let [coarse, fine] = [7, 900].map(|n| impact.run(&scheme, n));
        let reference = fine.series.clone().unwrap();
        let kept = reference.forces[0].len();
        assert!(
            (3..200).contains(&kept),
            "{kept} pieces of {} steps",
            fine.steps
        );
        let own = compare(coarse.finished().unwrap(), &reference, "self");
        assert_eq!(own.force_l1, Some(0.0), "{scheme:?}");
        assert_eq!(own.force_l2, Some(0.0));
        assert_eq!(own.peak_force_rel, Some(0.0));
        assert_eq!(own.impulse_rel, Some(0.0));
        // The pieces go through a journal unchanged in kind.
        let text = serde_json::to_string(&reference).unwrap();
        let back: TimeSeries = serde_json::from_str(&text).unwrap();
        let again = compare(coarse.finished().unwrap(), &back, "self");
        assert!(again.force_l1.unwrap() < 1e-14, "{:?}", again.force_l1);
    }
}
