//! The trigonometric method: exact for the linear part, symplectic, symmetric, one step per flight.

use crate::equilibrium::Springs;
use crate::modes::Modes;
use crate::problems::*;
use gearbench_integrators::modal::propagator::coefficients;
use gearbench_integrators::{
    AcceptedStep, Control, NullSink, Resolution, SecondOrderSystem, Sink, State, StepError,
    TimePlan,
};
use std::f64::consts::TAU;

fn apart(a: &State, b: &State) -> f64 {
    let pairs = a.q.iter().zip(&b.q).chain(a.v.iter().zip(&b.v));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A stop that is never reached keeps the flights short, so that many steps are made.
#[test]
fn oscillators_and_steady_loads_are_exact_over_long_times() {
    let zeta = [0.0, 0.0, 0.0, 1e-4, 0.02, 0.7, 0.999, 1.0, 30.0];
    let omega = [0.0, 0.01, 31.4, 7.0, 1.0, 3.0, 5.0, 2.0, 4.0];
    let load = [1e-5, 1e-4, -2.0, 1.0, 0.5, 3.0, -1.0, 1.0, 2.0];
    let mut modes = Modes::linear(&omega, &zeta, &load);
    modes.wall = 1e9;
    let start = state(
        &[0.1, -1.0, 0.3, 0.2, 1.0, 2.0, 0.5, -1.0, 0.3],
        &[0.0, 1.0, 2.0, -1.0, 0.0, 3.0, 1.0, 2.0, 1.0],
    );
    for (t_end, n, filter) in [(1e3, 20_000.0, 0), (1e3, 333_333.0, 0), (1e3, 20_000.0, 2)] {
        let text = format!("trigonometric(filter={filter})");
        let plan = steps(t_end, n);
        let (s, work) = watch(&text, &mut modes, start.clone(), &plan, &mut NullSink);
        assert_eq!(work.steps as f64, n);
        let error = apart(&s, &modes.exact(&start, t_end));
        println!("{text}: {n} steps, error {error:.1e} after 5000 periods of the fastest");
        // The phase of the fastest mode is known to eps omega t.
        assert!(error < 1e-9, "{text}: {error:.1e}");
    }
}

/// A flight without any possible contact is one step with exact values inside and a single evaluation.
#[test]
fn flight_is_one_step_with_exact_values_inside() {
    #[derive(Default)]
    struct Inside {
        worst: f64,
        ends: f64,
    }
    struct Check<'a>(&'a Modes, State, Inside);
    impl Sink for Check<'_> {
        fn accepted(
            &mut self,
            _sys: &mut dyn SecondOrderSystem,
            step: &AcceptedStep<'_>,
        ) -> Control {
            let mut s = step.to.clone();
            for i in 0..=100 {
                let theta = f64::from(i) / 100.0;
                step.dense.eval(theta, &mut s.q, &mut s.v);
                let t = step.from.t + theta * (step.to.t - step.from.t);
                self.2.worst = self.2.worst.max(apart(&s, &self.0.exact(&self.1, t)));
            }
            self.2.ends = self.2.ends.max(apart(&s, step.to));
            Control::Continue
        }
    }
    let modes = Modes::linear(&[0.0, 3.0, 50.0], &[0.0, 0.1, 0.0], &[0.2, -1.0, 4.0]);
    let start = state(&[0.0, 1.0, 0.1], &[0.5, 0.0, 1.0]);
    for plan in [steps(10.0, 12345.0), tolerance(10.0, 1e-6)] {
        let mut check = Check(&modes, start.clone(), Inside::default());
        let mut own = modes.clone();
        let (s, work) = watch("trigonometric", &mut own, start.clone(), &plan, &mut check);
        assert_eq!((work.steps, work.force_evaluations), (1, 1));
        assert_eq!(s.t, 10.0);
        let Inside { worst, ends } = check.2;
        assert!(worst < 1e-12 && ends < 1e-13, "{worst:.1e} {ends:.1e}");
    }
}

fn nonlinear() -> Modes {
    Modes {
        cubic: 2.0,
        shape: vec![1.0, 0.7, -0.4, 0.3],
        ..Modes::linear(&[0.0, 1.0, 2.3, 9.0], &[0.0; 4], &[0.0, 0.1, 0.0, -0.3])
    }
}

fn pushed() -> State {
    state(&[0.5, 0.2, -0.3, 0.02], &[0.1, -0.4, 0.5, 0.3])
}

#[test]
fn running_back_with_turned_speeds_arrives_where_it_began() {
    for filter in [0, 2] {
        let text = format!("trigonometric(filter={filter})");
        let mut modes = nonlinear();
        let mut go = |from: State| {
            let plan = steps(50.0, 1000.0);
            let (mut s, _) = watch(&text, &mut modes, from, &plan, &mut NullSink);
            s.v.iter_mut().for_each(|v| *v = -*v);
            s.t = 0.0;
            s
        };
        let there = go(pushed());
        let far = apart(&there, &pushed());
        let error = apart(&go(there), &pushed());
        println!("{text}: back to {error:.1e} after 1000 steps there and back");
        assert!(error < 1e-10 && far > 0.1, "{text}: {error:.1e} {far:.1e}");
    }
}

#[test]
fn energy_stays_in_a_band_over_long_runs() {
    struct Band(Modes, f64, [f64; 2], f64);
    impl Sink for Band {
        fn accepted(&mut self, _: &mut dyn SecondOrderSystem, s: &AcceptedStep<'_>) -> Control {
            let off = (self.0.energy(s.to) / self.1 - 1.0).abs();
            let late = usize::from(s.to.t > 0.5 * self.3);
            self.2[late] = self.2[late].max(off);
            Control::Continue
        }
    }
    for filter in [0, 2] {
        let t_end = 1e4;
        let text = format!("trigonometric(filter={filter})");
        let mut modes = nonlinear();
        let mut band = Band(modes.clone(), modes.energy(&pushed()), [0.0; 2], t_end);
        watch(&text, &mut modes, pushed(), &steps(t_end, 1e5), &mut band);
        let [early, late] = band.2;
        println!("{text}: energy within {early:.2e} in the first half, {late:.2e} in the second");
        assert!(
            late < 1.1 * early && early < 0.05,
            "{text}: {early:.2e} {late:.2e}"
        );
    }
}

#[test]
fn a_system_without_a_split_is_refused() {
    let mut whole = Springs::new(&[1.0], &[0.0]);
    let m = by_id("trigonometric");
    let (_, _, result) = run(m, &mut whole, state(&[1.0], &[0.0]), &steps(1.0, 10.0));
    let error = result.unwrap_err();
    assert!(matches!(error, StepError::Unsupported { .. }));
    assert!(error.to_string().contains("velocity-verlet"), "{error}");

    let mut driven = Modes::linear(&[1.0], &[-0.1], &[0.0]);
    let (_, _, result) = run(m, &mut driven, state(&[1.0], &[0.0]), &steps(1.0, 10.0));
    assert!(result.unwrap_err().to_string().contains("damping ratio"));
}

/// Oscillators at and beyond critical damping under a force that depends on position and velocity: against the closed
/// form of the sum, with the order of the method.
#[test]
fn overdamped_oscillators_follow_forces_with_order_two() {
    let m = by_id("trigonometric");
    for zeta in [0.3, 1.0, 2.0] {
        let error = |h: f64| {
            let mut modes = Modes::linear(&[1.0], &[zeta], &[30.0]);
            (modes.stop, modes.wall) = (0.3, -100.0);
            let (end, _, result) = run(m, &mut modes, state(&[1.0], &[0.2]), &steps(2.0, 2.0 / h));
            result.unwrap();
            // The stop, which is pressed all the time, adds to the stiffness; its force at zero is the load.
            let omega = 1.3_f64.sqrt();
            let c = coefficients(omega, zeta / omega, 2.0);
            (end.q[0] - (c.qq + 0.2 * c.qv)).abs()
        };
        let order = (error(0.1) / error(0.05)).log2();
        println!("zeta {zeta}: {:.1e}, order {order:.2}", error(0.05));
        assert!((order - 2.0).abs() < 0.1, "zeta {zeta}: order {order}");
    }
}

/// A tenfold flight between two impacts costs no more steps and no more evaluations.
#[test]
fn the_cost_of_flight_does_not_grow_with_its_length() {
    for (events, resolution) in [
        (true, Resolution::Step(1e-6)),
        (false, Resolution::Step(1e-6)),
        (true, Resolution::Tolerance(1e-5)),
        (false, Resolution::Tolerance(1e-5)),
    ] {
        let cost = |stretch: f64| {
            let mut hammer = Hammer::gears(0.05);
            hammer.backlash *= stretch;
            let t_end = 0.1 * stretch;
            let plan = TimePlan {
                events,
                ..TimePlan::new(t_end, resolution)
            };
            let impacts = hammer.exact(t_end).2;
            let (s, work) = solve(
                by_id("trigonometric"),
                &mut hammer.clone(),
                hammer.start(),
                &plan,
            );
            let (_, u, _) = hammer.exact(t_end);
            let u0 = hammer.exact(0.0).1;
            let r = hammer.radius;
            let error = ((r[0] * s.v[0] - r[1] * s.v[1] - u) / u0).abs();
            println!(
                "events {events}, {resolution:?}: flight x {stretch}: {impacts} impacts, {} steps, {} rejected, {} evaluations, error {error:.1e}",
                work.steps, work.rejected, work.force_evaluations
            );
            assert!(error < 1e-2, "{error:.1e}");
            (work.steps + work.rejected, work.force_evaluations, impacts)
        };
        let (short, long) = (cost(1.0), cost(10.0));
        assert!(short.2 >= 9 && long.2 >= 9);
        let per_impact = |(steps, evaluations, impacts): (u64, u64, u32)| {
            [steps, evaluations].map(|x| x as f64 / f64::from(impacts))
        };
        let (a, b) = (per_impact(short), per_impact(long));
        assert!(b[0] < 1.1 * a[0] && b[1] < 1.1 * a[1], "{a:?} {b:?}");
    }
}

/// Returns the largest energy error over 40000 steps, relative to the energy of the motion, of a body with one elastic
/// mode, of mass one each, that bounces on a stop under a steady load, or rests on it and rocks; `omega_c h` of the
/// contact is given.
fn energy_error(omega_h: f64, contact_h: f64, pressed: bool, filter: u8) -> f64 {
    struct LargestError {
        modes: Modes,
        start: f64,
        scale: f64,
        error: f64,
    }
    impl Sink for LargestError {
        fn accepted(&mut self, _: &mut dyn SecondOrderSystem, s: &AcceptedStep<'_>) -> Control {
            let off = (self.modes.energy(s.to) - self.start).abs() / self.scale;
            self.error = self.error.max(off);
            if off > 1e6 {
                Control::Stop
            } else {
                Control::Continue
            }
        }
    }
    let (h, load): (f64, f64) = (0.05, 0.02);
    let omega_c = contact_h / h;
    let shape = vec![1.0, 0.8];
    let stop = omega_c * omega_c / 1.64;
    let mut modes = Modes {
        shape,
        stop,
        wall: 0.0,
        ..Modes::linear(&[0.0, omega_h / h], &[0.0; 2], &[load, 0.0])
    };
    let speed = 0.3 * load / omega_c;
    let start = if pressed {
        state(&[load / stop, 0.0], &[speed, 0.0])
    } else {
        state(&[-0.5, 0.0], &[0.0, 0.0])
    };
    let mut worst = LargestError {
        start: modes.energy(&start),
        scale: if pressed {
            0.5 * speed * speed
        } else {
            0.5 * load
        },
        error: 0.0,
        modes: modes.clone(),
    };
    let text = format!("trigonometric(filter={filter})");
    let plan = steps(2000.0, 40_000.0);
    watch(&text, &mut modes, start, &plan, &mut worst);
    worst.error
}

/// Measures the table in the module head, and checks that the default filter costs nothing where it is not needed.
#[test]
fn filtered_modes_do_not_resonate() {
    println!("largest energy error: resting | bouncing, filter 0, 1, 2");
    for contact_h in [0.13, 0.5] {
        println!("omega_c h = {contact_h}");
        let mut safe = [0.0_f64; 2];
        for x in [
            0.1, 1.0, 2.0, 2.5, 3.0, 3.3, 4.0, 5.0, 6.0, TAU, 6.5, 8.0, 10.0,
        ] {
            let errors = [true, false]
                .map(|rests| [0, 1, 2].map(|filter| energy_error(x, contact_h, rests, filter)));
            let text = |e: [f64; 3]| format!("{:8.1e} {:8.1e} {:8.1e}", e[0], e[1], e[2]);
            println!("  {x:7.4}: {} | {}", text(errors[0]), text(errors[1]));
            for ([none, fast, _], safe) in errors.into_iter().zip(&mut safe) {
                if x <= 2.0 {
                    assert_eq!(none, fast);
                    *safe = safe.max(fast);
                }
                assert!(
                    fast <= *safe,
                    "omega h {x}: {fast:.1e}, {safe:.1e} without a fast mode"
                );
                assert!(x != TAU || none > 1e4, "omega h {x} unfiltered: {none:.1e}");
            }
        }
    }
}
