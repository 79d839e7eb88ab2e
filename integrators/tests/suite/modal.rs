//! The trigonometric method: exact for the linear part, symplectic, symmetric, in flight in one step.

use crate::problems::*;
use gearbench_integrators::modal::propagator::coefficients;
use gearbench_integrators::{
    AcceptedStep, At, Control, Layout, ModalSplit, NullSink, Resolution, SecondOrderSystem, Sink,
    State, StepError, TimePlan, Work, method,
};
use std::f64::consts::TAU;

/// Independent oscillators under steady loads, next to a smooth nonlinear coupling and a stop.
#[derive(Clone)]
pub struct Modes {
    pub omega: Vec<f64>,
    pub zeta: Vec<f64>,
    pub load: Vec<f64>,
    /// Shape of the modes at the point that the nonlinear forces act on.
    pub shape: Vec<f64>,
    /// Cubic spring at the point.
    pub cubic: f64,
    /// Stiffness of the stop at `point > 0`: the stop itself in series with a residual compliance.
    pub stop: f64,
    /// Where the stop stands.
    pub wall: f64,
}

impl Modes {
    pub fn linear(omega: &[f64], zeta: &[f64], load: &[f64]) -> Self {
        Modes {
            omega: omega.to_vec(),
            zeta: zeta.to_vec(),
            load: load.to_vec(),
            shape: vec![1.0; omega.len()],
            cubic: 0.0,
            stop: 0.0,
            wall: f64::INFINITY,
        }
    }

    pub fn point(&self, q: &[f64]) -> f64 {
        self.shape.iter().zip(q).map(|(b, q)| b * q).sum()
    }

    fn contact(&self, q: &[f64]) -> f64 {
        let x = self.point(q);
        let pressed = (x - self.wall).max(0.0);
        let push = if pressed > 0.0 {
            self.stop * pressed
        } else {
            0.0
        };
        -push - self.cubic * x * x * x
    }

    pub fn energy(&self, s: &State) -> f64 {
        let x = self.point(&s.q);
        let pressed = (x - self.wall).max(0.0);
        let contact = if pressed > 0.0 {
            0.5 * self.stop * pressed * pressed
        } else {
            0.0
        };
        let modes: f64 = (0..self.omega.len())
            .map(|i| {
                0.5 * s.v[i] * s.v[i] + 0.5 * (self.omega[i] * s.q[i]).powi(2)
                    - self.load[i] * s.q[i]
            })
            .sum();
        modes + contact + 0.25 * self.cubic * x.powi(4)
    }

    pub fn exact(&self, from: &State, t: f64) -> State {
        let mut s = from.clone();
        for i in 0..self.omega.len() {
            let c = coefficients(self.omega[i], self.zeta[i], t);
            s.q[i] = c.qq * from.q[i] + c.qv * from.v[i] + c.qg * self.load[i];
            s.v[i] = c.vq * from.q[i] + c.vv * from.v[i] + c.qv * self.load[i];
        }
        s.t = t;
        s
    }
}

impl ModalSplit for Modes {
    fn oscillators(&self, omega: &mut [f64], zeta: &mut [f64]) {
        omega.copy_from_slice(&self.omega);
        zeta.copy_from_slice(&self.zeta);
    }
    fn remainder(&mut self, at: At<'_>, a: &mut [f64]) {
        let force = self.contact(at.q);
        for i in 0..a.len() {
            a[i] = self.load[i] + self.shape[i] * force;
        }
    }
    fn steady(&mut self, _at: At<'_>, a: &mut [f64]) -> f64 {
        a.copy_from_slice(&self.load);
        f64::INFINITY
    }
    /// The gap of the first coordinate, which is free, less the largest swing of the others; no load on either.
    fn free_until(&mut self, s: &State) -> f64 {
        if self.wall == f64::INFINITY && self.cubic == 0.0 {
            return f64::INFINITY;
        }
        if self.cubic != 0.0 || self.omega[0] != 0.0 || self.load.iter().any(|g| *g != 0.0) {
            return s.t;
        }
        let swing: f64 = (1..s.q.len())
            .map(|i| self.shape[i].abs() * s.q[i].hypot(s.v[i] / self.omega[i]))
            .sum();
        let gap = self.wall - self.shape[0] * s.q[0] - swing;
        let speed = self.shape[0] * s.v[0];
        if gap <= 0.0 {
            s.t
        } else if speed <= 0.0 {
            f64::INFINITY
        } else {
            s.t + gap / speed
        }
    }
}

impl SecondOrderSystem for Modes {
    fn layout(&self) -> Layout {
        Layout {
            n: self.omega.len(),
            event_functions: 0,
            discrete: 0,
        }
    }
    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        q.fill(1.0);
        v.fill(1.0);
    }
    fn characteristic_time(&self, _at: At<'_>) -> f64 {
        0.1
    }
    fn force(&mut self, at: At<'_>, f: &mut [f64]) {
        let contact = self.contact(at.q);
        for i in 0..f.len() {
            let (w, z) = (self.omega[i], self.zeta[i]);
            f[i] = self.load[i] + self.shape[i] * contact - w * (w * at.q[i] + 2.0 * z * at.v[i]);
        }
    }
    fn solve_mass(&mut self, _at: At<'_>, _f: &mut [f64]) {}
    fn apply_mass(&mut self, _at: At<'_>, x: &[f64], y: &mut [f64]) {
        y.copy_from_slice(x);
    }
    fn tangent_times(&mut self, _at: At<'_>, _dq: &[f64], _dv: &[f64], _df: &mut [f64]) {
        unreachable!("explicit methods only")
    }
    fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
        Some(self)
    }
}

fn apart(a: &State, b: &State) -> f64 {
    let pairs = a.q.iter().zip(&b.q).chain(a.v.iter().zip(&b.v));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A stop that nothing reaches keeps the flights short, so that many steps are taken.
#[test]
fn oscillators_and_steady_loads_are_exact_over_long_times() {
    let zeta = [0.0, 0.0, 0.0, 1e-4, 0.02, 0.7, 0.999];
    let omega = [0.0, 0.01, 31.4, 7.0, 1.0, 3.0, 5.0];
    let load = [1e-5, 1e-4, -2.0, 1.0, 0.5, 3.0, -1.0];
    let mut modes = Modes::linear(&omega, &zeta, &load);
    modes.wall = 1e9;
    let start = state(
        &[0.1, -1.0, 0.3, 0.2, 1.0, 2.0, 0.5],
        &[0.0, 1.0, 2.0, -1.0, 0.0, 3.0, 1.0],
    );
    for (t_end, n, filter) in [(1e3, 20_000.0, 0), (1e3, 333_333.0, 0), (1e3, 20_000.0, 2)] {
        let text = format!("trigonometric(filter={filter})");
        let (mut s, mut work) = (start.clone(), Work::default());
        method(&text)
            .unwrap()
            .run(
                &mut modes,
                &mut s,
                &steps(t_end, n),
                &mut NullSink,
                &mut work,
            )
            .unwrap();
        assert_eq!(work.steps as f64, n);
        let error = apart(&s, &modes.exact(&start, t_end));
        println!("{text}: {n} steps, error {error:.1e} after 5000 periods of the fastest");
        // The phase of the fastest mode is known to eps omega t.
        assert!(error < 1e-9, "{text}: {error:.1e}");
    }
}

/// Nothing that could touch: one step, no evaluation but the first, and exact values inside.
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
        let (mut s, mut work) = (start.clone(), Work::default());
        by_id("trigonometric")
            .build()
            .run(&mut modes.clone(), &mut s, &plan, &mut check, &mut work)
            .unwrap();
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
        let (mut modes, mut s) = (nonlinear(), pushed());
        let far = {
            let mut go = || {
                let mut m = method(&text).unwrap();
                m.run(
                    &mut modes,
                    &mut s,
                    &steps(50.0, 1000.0),
                    &mut NullSink,
                    &mut Work::default(),
                )
                .unwrap();
                s.v.iter_mut().for_each(|v| *v = -*v);
                s.t = 0.0;
            };
            go();
            let far = pushed().q[0];
            go();
            far
        };
        let error = apart(&s, &pushed());
        println!("{text}: back to {error:.1e} after 1000 steps there and back");
        assert!(error < 1e-10 && far != 0.0, "{text}: {error:.1e}");
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
        let (mut modes, mut s) = (nonlinear(), pushed());
        let mut band = Band(modes.clone(), modes.energy(&s), [0.0; 2], t_end);
        let mut m = method(&text).unwrap();
        m.run(
            &mut modes,
            &mut s,
            &steps(t_end, 1e5),
            &mut band,
            &mut Work::default(),
        )
        .unwrap();
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
    struct Whole(Oscillator);
    impl SecondOrderSystem for Whole {
        fn layout(&self) -> Layout {
            self.0.layout()
        }
        fn scales(&self, q: &mut [f64], v: &mut [f64]) {
            self.0.scales(q, v);
        }
        fn force(&mut self, at: At<'_>, f: &mut [f64]) {
            self.0.force(at, f);
        }
        fn solve_mass(&mut self, _at: At<'_>, _f: &mut [f64]) {}
        fn apply_mass(&mut self, at: At<'_>, x: &[f64], y: &mut [f64]) {
            self.0.apply_mass(at, x, y);
        }
        fn tangent_times(&mut self, at: At<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
            self.0.tangent_times(at, dq, dv, df);
        }
    }
    let mut whole = Whole(Oscillator { omega: 1.0 });
    let m = by_id("trigonometric");
    let (_, _, result) = run(m, &mut whole, state(&[1.0], &[0.0]), &steps(1.0, 10.0));
    let error = result.unwrap_err();
    assert!(matches!(error, StepError::Unsupported { .. }));
    assert!(error.to_string().contains("velocity-verlet"), "{error}");

    let mut critical = Modes::linear(&[1.0], &[1.0], &[0.0]);
    let (_, _, result) = run(m, &mut critical, state(&[1.0], &[0.0]), &steps(1.0, 10.0));
    assert!(result.unwrap_err().to_string().contains("damping ratio"));
}

/// Ten times the flight between two impacts costs no more steps and no more evaluations.
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

/// A body with one elastic mode, of mass one each, that bounces on a stop under a steady load, or rests on it and
/// rocks; `omega_c h` of the contact is given. The largest energy error over the energy of the motion, 40000 steps.
fn energy_error(omega_h: f64, contact_h: f64, pressed: bool, filter: u8) -> f64 {
    struct Worst {
        modes: Modes,
        start: f64,
        scale: f64,
        error: f64,
    }
    impl Sink for Worst {
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
    let mut worst = Worst {
        start: modes.energy(&start),
        scale: if pressed {
            0.5 * speed * speed
        } else {
            0.5 * load
        },
        error: 0.0,
        modes: modes.clone(),
    };
    let mut m = method(&format!("trigonometric(filter={filter})")).unwrap();
    let (mut s, plan) = (start, steps(2000.0, 40_000.0));
    m.run(&mut modes, &mut s, &plan, &mut worst, &mut Work::default())
        .unwrap();
    worst.error
}

/// The table in the head of the module, and that the default costs nothing where it is not needed.
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
