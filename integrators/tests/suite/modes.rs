//! A test system of independent oscillators with a nonlinear force at one point.

use crate::unit_masses;
use gearbench_integrators::modal::propagator::coefficients;
use gearbench_integrators::{
    Energy, Layout, ModalSplit, Outputs, Power, Report, SecondOrderSystem, State, StateView,
};

/// Independent oscillators under steady loads with a smooth nonlinear coupling and a stop.
#[derive(Clone)]
pub struct Modes {
    pub omega: Vec<f64>,
    pub zeta: Vec<f64>,
    pub load: Vec<f64>,
    /// Shape of the modes at the point that the nonlinear forces act on.
    pub shape: Vec<f64>,
    /// Coefficient of the cubic spring at the point.
    pub cubic: f64,
    /// Stiffness of the stop at `point > 0`: the stop itself in series with a residual compliance.
    pub stop: f64,
    /// Position of the stop.
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
    fn remainder(&mut self, at: StateView<'_>, a: &mut [f64]) {
        let force = self.contact(at.q);
        for i in 0..a.len() {
            a[i] = self.load[i] + self.shape[i] * force;
        }
    }
    fn steady(&mut self, _at: StateView<'_>, a: &mut [f64]) -> f64 {
        a.copy_from_slice(&self.load);
        f64::INFINITY
    }
    /// Returns a bound from the gap of the first coordinate, which is free, less the largest amplitude of the others,
    /// without load on either.
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

impl Report for Modes {
    fn output(&mut self, at: StateView<'_>, out: &mut Outputs) {
        let s = State {
            q: at.q.to_vec(),
            v: at.v.to_vec(),
            ..State::default()
        };
        let oscillators = self.omega.iter().zip(&self.zeta).zip(at.v);
        out.energy = Energy {
            contact: self.energy(&s),
            ..Energy::default()
        };
        out.power = Power {
            dissipated: oscillators.map(|((w, z), v)| 2.0 * z * w * v * v).sum(),
            ..Power::default()
        };
    }
}

impl SecondOrderSystem for Modes {
    unit_masses!(|own| [own.omega.len(), 0, 0], modal: ModalSplit, report: Report);

    fn characteristic_time(&self, _at: StateView<'_>) -> f64 {
        0.1
    }
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        let contact = self.contact(at.q);
        for i in 0..f.len() {
            let (w, z) = (self.omega[i], self.zeta[i]);
            f[i] = self.load[i] + self.shape[i] * contact - w * (w * at.q[i] + 2.0 * z * at.v[i]);
        }
    }
    fn tangent_times(&mut self, _at: StateView<'_>, _dq: &[f64], _dv: &[f64], _df: &mut [f64]) {
        unreachable!("explicit methods only")
    }
}
