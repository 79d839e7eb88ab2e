//! The quasi-static correction: the compliance that impulses leave out of oscillators, and the gain of a system that
//! adds it as local compliance.

use crate::problems::*;
use crate::unit_masses;
use gearbench_integrators::{Layout, ModalSplit, SecondOrderSystem, State, StateView};

/// Oscillators with a two-sided spring at one point, in series with a local compliance.
struct SpringLoadedOscillators {
    omega: Vec<f64>,
    /// Shape of the oscillators at the point.
    shape: Vec<f64>,
    /// Steady load on each oscillator.
    load: Vec<f64>,
    spring: f64,
    local: f64,
    /// True if the system adds the compliance that the method leaves out.
    gives: bool,
    quasi_static: Vec<f64>,
}

impl SpringLoadedOscillators {
    /// Builds a free body with modes, the fastest of which is about as fast as the contact.
    fn body(gives: bool) -> Self {
        SpringLoadedOscillators {
            omega: vec![0.0, 1.4],
            shape: vec![1.0, 0.8],
            load: vec![0.0; 2],
            spring: 1.5,
            local: 0.2,
            gives,
            quasi_static: vec![0.0; 2],
        }
    }

    fn given(&self) -> f64 {
        let of = self.shape.iter().zip(&self.quasi_static);
        of.map(|(b, quasi_static)| b * b * quasi_static).sum()
    }

    /// Returns the force of the spring.
    fn press(&self, q: &[f64]) -> f64 {
        let x: f64 = self.shape.iter().zip(q).map(|(b, q)| b * q).sum();
        x / (1.0 / self.spring + self.local + self.given())
    }

    /// Returns the frequencies of two oscillators with the spring: roots of the characteristic polynomial.
    fn frequencies(&self) -> [f64; 2] {
        let k = 1.0 / (1.0 / self.spring + self.local);
        let (b, w) = (&self.shape, &self.omega);
        let [p, r] = [0, 1].map(|i| w[i] * w[i] + k * b[i] * b[i]);
        let c = k * b[0] * b[1];
        let (mean, half) = (0.5 * (p + r), (0.25 * (p - r) * (p - r) + c * c).sqrt());
        [(mean - half).sqrt(), (mean + half).sqrt()]
    }

    /// Returns the frequencies of the motion over steps `h`, from the cosines of the phases of the one-step map.
    fn stepped(&mut self, h: f64) -> [f64; 2] {
        let mut map = [[0.0; 4]; 4];
        for j in 0..4 {
            let unit = |i: usize| f64::from(u8::from(i == j));
            let s = self.after(state(&[unit(0), unit(1)], &[unit(2), unit(3)]), h, 1.0);
            let column = [s.q[0], s.q[1], s.v[0], s.v[1]];
            for i in 0..4 {
                map[i][j] = column[i];
            }
        }
        // The map keeps areas: its eigenvalues are pairs exp(+-i phase).
        let trace: f64 = (0..4).map(|i| map[i][i]).sum();
        let mut square = 0.0;
        for i in 0..4 {
            for j in 0..4 {
                square += map[i][j] * map[j][i];
            }
        }
        let sum = 0.5 * trace;
        let squares = 0.25 * square + 1.0;
        let half = (0.5 * squares - 0.25 * sum * sum).max(0.0).sqrt();
        [half, -half].map(|x| (0.5 * sum + x).acos() / h)
    }

    fn after(&mut self, s: State, h: f64, n: f64) -> State {
        solve(by_id("trigonometric"), self, s, &steps(n * h, n)).0
    }
}

impl ModalSplit for SpringLoadedOscillators {
    fn oscillators(&self, omega: &mut [f64], zeta: &mut [f64]) {
        omega.copy_from_slice(&self.omega);
        zeta.fill(0.0);
    }
    fn prepare(&mut self, quasi_static: &[f64]) {
        if self.gives {
            self.quasi_static.copy_from_slice(quasi_static);
        }
    }
    fn remainder(&mut self, at: StateView<'_>, a: &mut [f64]) {
        let force = self.press(at.q);
        for i in 0..a.len() {
            a[i] = self.load[i] - self.shape[i] * force;
        }
    }
    fn steady(&mut self, _at: StateView<'_>, a: &mut [f64]) -> f64 {
        a.copy_from_slice(&self.load);
        f64::INFINITY
    }
    fn free_until(&mut self, s: &State) -> f64 {
        s.t
    }
}

impl SecondOrderSystem for SpringLoadedOscillators {
    unit_masses!(|own| [own.omega.len(), 0, 0], modal: ModalSplit);

    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        self.remainder(at, f);
        for i in 0..f.len() {
            f[i] -= self.omega[i] * self.omega[i] * at.q[i];
        }
    }
    fn tangent_times(&mut self, _at: StateView<'_>, _dq: &[f64], _dv: &[f64], _df: &mut [f64]) {
        unreachable!("an explicit method only")
    }
}

/// Frequencies of a body in contact converge with order two, and with order four with the quasi-static correction.
#[test]
fn a_contact_with_the_quasi_static_correction_has_order_four() {
    let lengths = [0.8, 0.4, 0.2, 0.1];
    for (gives, declared) in [(false, 2.0), (true, 4.0)] {
        let mut body = SpringLoadedOscillators::body(gives);
        let exact = body.frequencies();
        let mut errors = [[0.0; 4]; 2];
        for (i, h) in lengths.into_iter().enumerate() {
            let found = body.stepped(h);
            for k in 0..2 {
                errors[k][i] = (found[k] / exact[k] - 1.0).abs();
            }
        }
        for (k, e) in errors.iter().enumerate() {
            let order = (e[0] / e[3]).ln() / (lengths[0] / lengths[3]).ln();
            println!(
                "gives {gives}: frequency {:.3}, errors {}, order {order:.2}",
                exact[k],
                e.map(|e| format!("{e:.1e}")).join(" ")
            );
            assert!((order - declared).abs() < 0.25, "gives {gives}: {order}");
        }
    }
}

/// The contact force under a steady load at rest is that of the springs in series, at every step.
#[test]
fn a_load_at_rest_presses_alike_at_every_step() {
    let mut errors = [0.0_f64; 2];
    for gives in [false, true] {
        for h in [0.05, 0.5, 1.0] {
            let mut body = SpringLoadedOscillators {
                omega: vec![0.7, 1.9],
                load: vec![0.3, 0.0],
                ..SpringLoadedOscillators::body(gives)
            };
            // A single step shows the quasi-static correction.
            body.gives = true;
            body.after(state(&[0.0; 2], &[0.0; 2]), h, 1.0);
            let quasi_static = std::mem::replace(&mut body.quasi_static, vec![0.0; 2]);
            body.gives = gives;
            if gives {
                body.quasi_static.clone_from(&quasi_static);
            }
            let yields = |i: usize| 1.0 / (body.omega[i] * body.omega[i]);
            let (b, load) = (body.shape.clone(), body.load[0] * yields(0));
            let series = 1.0 / body.spring + body.local;
            let of_modes: f64 = (0..2).map(|i| b[i] * b[i] * yields(i)).sum();
            let exact = b[0] * load / (series + of_modes);
            // Where the kicks balance oscillators and load.
            let left: f64 = (0..2).map(|i| b[i] * b[i] * quasi_static[i]).sum();
            let force = b[0] * load / (series + body.given() + of_modes - left);
            let q = [0, 1]
                .map(|i| body.load[i] * yields(i) - force * b[i] * (yields(i) - quasi_static[i]));
            let s = body.after(state(&q, &[0.0; 2]), h, 200.0);
            let moved = (0..2).fold(0.0_f64, |m, i| m.max((s.q[i] - q[i]).abs()));
            assert!(moved < 1e-12, "rests: {moved:.1e}");
            let error = (body.press(&s.q) / exact - 1.0).abs();
            println!("gives {gives}, step {h}: force at rest off by {error:.1e}");
            let worst = &mut errors[usize::from(gives)];
            *worst = worst.max(error);
        }
    }
    assert!(errors[0] > 0.02 && errors[1] < 1e-12, "{errors:?}");
}
