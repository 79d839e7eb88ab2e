//! Stability limits compared with closed forms of the literature, and every implemented method compared with its
//! declaration.

use super::*;
use crate::{
    Layout, METHODS, ModalSplit, NullSink, Resolution, SecondOrderSystem, State, StateView,
    TimePlan, Work,
};

fn of(text: &str) -> Stability {
    text.parse::<crate::MethodSpec>().unwrap().stability()
}

fn polynomial(id: &str) -> Vec<f64> {
    match of(id) {
        Stability::Polynomial(r) => r,
        other => panic!("{id}: {other:?}"),
    }
}

fn close(a: f64, b: f64, tolerance: f64, what: &str) {
    assert!((a / b - 1.0).abs() <= tolerance, "{what}: {a} {b}");
}

/// Coefficients of the truncated exponential, and of Dormand-Prince with its `z^6/600` (Hairer, Wanner, IV.2).
#[test]
fn polynomials_come_from_the_tableaus() {
    let exact = [
        1.0,
        1.0,
        0.5,
        1.0 / 6.0,
        1.0 / 24.0,
        1.0 / 120.0,
        1.0 / 600.0,
    ];
    for (id, n) in [("rk4", 5), ("dopri5", 7)] {
        let r = polynomial(id);
        assert_eq!(r.len(), n, "{r:?}");
        for (found, want) in r.iter().zip(exact) {
            close(*found, want, 1e-13, id);
        }
    }
}

#[test]
fn limits_on_the_axes_are_those_of_the_literature() {
    let rk4 = polynomial("rk4");
    close(
        first_exit(&rk4, [0.0, 1.0]),
        8.0_f64.sqrt(),
        1e-8,
        "imaginary axis",
    );
    close(
        first_exit(&rk4, [-1.0, 0.0]),
        2.785_293_563_405_282,
        1e-8,
        "real axis",
    );
    let dopri5 = polynomial("dopri5");
    close(
        first_exit(&dopri5, [-1.0, 0.0]),
        3.306_567_892_634_942_5,
        1e-8,
        "real axis",
    );
    // |R(iy)|^2 - 1 = y^6 (-1/1800 + u/1600 - u^2/14400 + u^3/360000), u = y^2.
    let y = first_exit(&dopri5, [0.0, 1.0]);
    let u = y * y;
    let rest = -1.0 / 1800.0 + u / 1600.0 - u * u / 14_400.0 + u * u * u / 360_000.0;
    assert!(
        (0.99..1.0).contains(&y) && rest.abs() < 1e-8,
        "{y} {rest:e}"
    );
    // A ray is scaled; systems that are unstable themselves are left out.
    close(
        first_exit(&rk4, [0.0, 50.0]),
        8.0_f64.sqrt() / 50.0,
        1e-8,
        "scaled",
    );
    assert_eq!(first_exit(&rk4, [0.0, 0.0]), f64::INFINITY);
    assert_eq!(first_exit(&rk4, [3.0, 0.0]), f64::INFINITY);
}

#[test]
fn flips_are_the_classical_limits() {
    let limit = |id: &str, zeta: f64| of(id).largest_step(10.0, zeta);
    for zeta in [0.0, 0.01, 0.3, 1.0, 5.0] {
        let (z2, z) = ((1.0_f64 + zeta * zeta).sqrt(), zeta);
        let euler = limit("semi-implicit-euler", zeta).unwrap();
        close(euler, 0.2 * (z2 - z), 1e-11, "semi-implicit Euler");
        let verlet = limit("velocity-verlet", zeta).unwrap();
        let want = 0.2 * ((1.0 + 4.0 * z * z).sqrt() - 2.0 * z);
        close(verlet, want, 1e-11, "velocity Verlet");
        for beta in [0.0_f64, 1.0 / 6.0, 0.2] {
            let found = limit(&format!("newmark(beta={beta})"), zeta).unwrap();
            let want = 0.2 / (1.0 - 4.0 * beta).sqrt();
            close(found, want, 1e-11, "newmark");
        }
        for id in [
            "newmark",
            "newmark(beta=0.3)",
            "hht-alpha",
            "hht-alpha(alpha=0.333)",
            "generalised-alpha",
            "generalised-alpha(rho_inf=0)",
            "generalised-alpha(rho_inf=1)",
            "bdf",
            "tsit45",
        ] {
            assert_eq!(limit(id, zeta), None, "{id}");
        }
    }
}

/// Oscillator `q'' + 2 zeta omega q' + omega^2 q = 0`; for methods that are exact for oscillators, a free mass on a
/// remainder.
struct Oscillator {
    omega: f64,
    zeta: f64,
}

impl SecondOrderSystem for Oscillator {
    fn layout(&self) -> Layout {
        Layout {
            n: 1,
            ..Layout::default()
        }
    }
    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        (q[0], v[0]) = (1.0, self.omega);
    }
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        f[0] = -self.omega * (self.omega * at.q[0] + 2.0 * self.zeta * at.v[0]);
    }
    fn solve_mass(&mut self, _at: StateView<'_>, _f: &mut [f64]) {}
    fn apply_mass(&mut self, _at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        y.copy_from_slice(x);
    }
    fn tangent_times(&mut self, _at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        df[0] = -self.omega * (self.omega * dq[0] + 2.0 * self.zeta * dv[0]);
    }
    fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
        Some(self)
    }
}

impl ModalSplit for Oscillator {
    fn oscillators(&self, omega: &mut [f64], zeta: &mut [f64]) {
        (omega[0], zeta[0]) = (0.0, 0.0);
    }
    fn remainder(&mut self, at: StateView<'_>, a: &mut [f64]) {
        self.force(at, a);
    }
    fn steady(&mut self, at: StateView<'_>, _a: &mut [f64]) -> f64 {
        at.t
    }
    fn free_until(&mut self, s: &State) -> f64 {
        s.t
    }
}

/// Returns the energy after a number of steps relative to the initial energy.
fn growth(text: &str, zeta: f64, h: f64, steps: u32) -> f64 {
    let mut sys = Oscillator { omega: 30.0, zeta };
    let mut s = State {
        q: vec![1.0],
        v: vec![10.0],
        ..State::default()
    };
    let energy = |s: &State| (30.0 * s.q[0]).powi(2) + s.v[0].powi(2);
    let start = energy(&s);
    let plan = TimePlan::new(f64::from(steps) * h, Resolution::Step(h));
    let mut method = crate::method(text).unwrap();
    match method.run(&mut sys, &mut s, &plan, &mut NullSink, &mut Work::default()) {
        Ok(()) => energy(&s) / start,
        Err(_) => f64::INFINITY,
    }
}

/// One per cent below its limit every method stays bounded and one per cent above it does not; implicit methods stay
/// bounded at a thousand times that step.
#[test]
fn methods_have_the_limits_they_declare() {
    let variants = ["newmark(beta=0)", "newmark(beta=0.2)"];
    let names = METHODS.iter().map(|m| m.info.id).chain(variants);
    for text in names {
        let stability = of(text);
        for zeta in [0.0, 0.02, 0.2, 0.8] {
            match stability {
                Stability::Controlled => continue,
                Stability::Unconditional => {
                    let left = growth(text, zeta, 100.0, 2000);
                    assert!(left < 1e3, "{text}, {zeta}: {left:e}");
                    continue;
                }
                _ => {}
            }
            let h = stability.largest_step(30.0, zeta).unwrap();
            // Slowest is Dormand-Prince without damping: a part in 10^5 per step.
            let (below, above) = (
                growth(text, zeta, 0.99 * h, 8000),
                growth(text, zeta, 1.01 * h, 8000),
            );
            assert!(
                below < 300.0 && above > 1.05,
                "{text}, {zeta}: {below:e} {above:e}"
            );
            assert!(
                above > 1e3 * below || below < 1.0,
                "{text}, {zeta}: {below:e} {above:e}"
            );
        }
    }
}

/// An oscillator under impulses: the limit `4 = h^2 K_c` of a free mass, and the closed form of the frequency beyond
/// which a spring `k` on an oscillator is unstable, `2 + 2 cos x = h^2 k sinc x`, compared with long runs.
#[test]
fn kicks_of_an_oscillator_flip_where_its_weights_say() {
    struct ImpulsiveOscillator(f64, f64);
    impl SecondOrderSystem for ImpulsiveOscillator {
        fn layout(&self) -> Layout {
            Layout {
                n: 1,
                ..Layout::default()
            }
        }
        fn scales(&self, q: &mut [f64], v: &mut [f64]) {
            (q[0], v[0]) = (1.0, 1.0);
        }
        fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
            f[0] = -(self.0 * self.0 + self.1) * at.q[0];
        }
        fn solve_mass(&mut self, _at: StateView<'_>, _f: &mut [f64]) {}
        fn apply_mass(&mut self, _at: StateView<'_>, x: &[f64], y: &mut [f64]) {
            y.copy_from_slice(x);
        }
        fn tangent_times(&mut self, _at: StateView<'_>, dq: &[f64], _dv: &[f64], df: &mut [f64]) {
            df[0] = -(self.0 * self.0 + self.1) * dq[0];
        }
        fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
            Some(self)
        }
    }
    impl ModalSplit for ImpulsiveOscillator {
        fn oscillators(&self, omega: &mut [f64], zeta: &mut [f64]) {
            (omega[0], zeta[0]) = (self.0, 0.0);
        }
        fn remainder(&mut self, at: StateView<'_>, a: &mut [f64]) {
            a[0] = -self.1 * at.q[0];
        }
        fn steady(&mut self, at: StateView<'_>, _a: &mut [f64]) -> f64 {
            at.t
        }
        fn free_until(&mut self, s: &State) -> f64 {
            s.t
        }
    }
    for (text, from) in [
        ("trigonometric(filter=0)", f64::INFINITY),
        ("trigonometric(filter=2)", 0.0),
    ] {
        let impulses = Impulses { filter_from: from };
        assert_eq!(of(text), Stability::Impulses(impulses));
        let (omega, k) = (1.0, 8.0);
        let margin = |h: f64| {
            impulses
                .weights(omega, h)
                .map_or(-1.0, |[c, w]| c - w * w * k)
        };
        let (mut low, mut high) = (0.1, std::f64::consts::PI);
        for _ in 0..50 {
            let h = 0.5 * (low + high);
            if margin(h) > 0.0 { low = h } else { high = h }
        }
        assert!((0.5..3.0).contains(&low), "{low}");
        let grown = |h: f64| {
            let mut s = State {
                q: vec![1.0],
                v: vec![0.3],
                ..State::default()
            };
            let plan = TimePlan::new(2000.0 * h, Resolution::Step(h));
            let mut method = crate::method(text).unwrap();
            let run = method.run(
                &mut ImpulsiveOscillator(omega, k),
                &mut s,
                &plan,
                &mut NullSink,
                &mut Work::default(),
            );
            if run.is_ok() {
                s.q[0].hypot(s.v[0])
            } else {
                f64::INFINITY
            }
        };
        let (below, above) = (grown(0.99 * low), grown(1.01 * low));
        assert!(
            below < 50.0 && above > 1e3,
            "{text}: {low} {below:e} {above:e}"
        );
    }
    assert_eq!(
        Impulses { filter_from: 1.0 }.weights(0.0, 0.7),
        Some([4.0, 0.7])
    );
    assert_eq!(Impulses { filter_from: 1.0 }.weights(4.0, 0.8), None);
}
