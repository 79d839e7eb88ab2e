//! Test systems, each with its exact solution where one exists.

pub use crate::hammer::*;
use gearbench_integrators::{
    Energy, Layout, METHODS, Method, ModalSplit, NullSink, Outputs, Report, Resolution,
    SecondOrderSystem, Sink, State, StateView, StepError, Stepping, TimePlan, Work, method,
};

/// Runs a method of the table; the state is the one where it ended.
pub fn run(
    method: &Method,
    sys: &mut dyn SecondOrderSystem,
    mut s: State,
    plan: &TimePlan<'_>,
) -> (State, Work, Result<(), StepError>) {
    let mut work = Work::default();
    let result = method
        .build()
        .run(sys, &mut s, plan, &mut NullSink, &mut work);
    (s, work, result)
}

/// Runs a method `id(name=value)` that must not fail, with a sink.
pub fn watch(
    text: &str,
    sys: &mut dyn SecondOrderSystem,
    mut s: State,
    plan: &TimePlan<'_>,
    sink: &mut dyn Sink,
) -> (State, Work) {
    let mut work = Work::default();
    let result = method(text)
        .unwrap()
        .run(sys, &mut s, plan, sink, &mut work);
    if let Err(e) = result {
        panic!("{text} under {:?}: {e}", plan.resolution);
    }
    (s, work)
}

/// Runs a method that must not fail.
pub fn solve(
    method: &Method,
    sys: &mut dyn SecondOrderSystem,
    s: State,
    plan: &TimePlan<'_>,
) -> (State, Work) {
    watch(method.info.id, sys, s, plan, &mut NullSink)
}

pub fn by_id(id: &str) -> &'static Method {
    METHODS
        .iter()
        .find(|m| m.info.id == id)
        .unwrap_or_else(|| panic!("no method {id}"))
}

pub fn fixed_step() -> impl Iterator<Item = &'static Method> {
    METHODS
        .iter()
        .filter(|m| m.info.stepping != Stepping::Adaptive)
}

pub fn adaptive() -> impl Iterator<Item = &'static Method> {
    METHODS
        .iter()
        .filter(|m| m.info.stepping != Stepping::Fixed)
}

/// Fits the slope of log(error) over log(x) by least squares.
pub fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (mut sx, mut sy, mut sxx, mut sxy) = (0.0, 0.0, 0.0, 0.0);
    for &(x, y) in points {
        let (x, y) = (x.ln(), y.ln());
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    (n * sxy - sx * sy) / (n * sxx - sx * sx)
}

pub fn state(q: &[f64], v: &[f64]) -> State {
    State {
        t: 0.0,
        q: q.to_vec(),
        v: v.to_vec(),
        discrete: Vec::new(),
    }
}

/// Implements the sizes, scales and capabilities of test systems with unit masses and unit scales.
#[macro_export]
macro_rules! unit_masses {
    (|$own:ident| [$n:expr, $events:expr, $discrete:expr] $(, $capability:ident: $trait:ident)*) => {
        fn layout(&self) -> Layout {
            let $own = self;
            Layout {
                n: $n,
                event_functions: $events,
                discrete: $discrete,
            }
        }
        fn scales(&self, q: &mut [f64], v: &mut [f64]) {
            q.fill(1.0);
            v.fill(1.0);
        }
        fn solve_mass(&mut self, _at: StateView<'_>, _f: &mut [f64]) {}
        fn apply_mass(&mut self, _at: StateView<'_>, x: &[f64], y: &mut [f64]) {
            y.copy_from_slice(x);
        }
        $(fn $capability(&mut self) -> Option<&mut dyn $trait> {
            Some(self)
        })*
    };
}

/// Implements the modal split of a system from the frequency [rad/s] and damping ratio of each coordinate; the
/// remainder is the rest of its acceleration.
#[macro_export]
macro_rules! split_off {
    ($system:ty, |$own:ident, $i:ident| $oscillator:expr) => {
        impl gearbench_integrators::ModalSplit for $system {
            fn oscillators(&self, omega: &mut [f64], zeta: &mut [f64]) {
                let $own = self;
                for $i in 0..omega.len() {
                    (omega[$i], zeta[$i]) = $oscillator;
                }
            }
            fn remainder(&mut self, at: StateView<'_>, a: &mut [f64]) {
                self.force(at, a);
                self.solve_mass(at, a);
                let $own = &*self;
                for $i in 0..a.len() {
                    let (w, z): (f64, f64) = $oscillator;
                    a[$i] += w * (w * at.q[$i] + 2.0 * z * at.v[$i]);
                }
            }
            fn steady(&mut self, at: StateView<'_>, _a: &mut [f64]) -> f64 {
                at.t
            }
            fn free_until(&mut self, s: &State) -> f64 {
                s.t
            }
        }
    };
}

split_off!(Duffing, |_own, i| ([1.0, 1.3][i], [0.05, 0.0][i]));
split_off!(Oscillator, |own, _i| (own.omega, 0.0));
split_off!(Chain, |_own, _i| (0.0, 0.0));

/// Two coupled Duffing oscillators with cubic damping and a full mass matrix, forced so that `q = (sin 1.3 t + 0.2 cos
/// 2.1 t, cos(0.9 t + 0.4))` is the exact solution.
#[derive(Default)]
pub struct Duffing;

impl Duffing {
    const M: [[f64; 2]; 2] = [[2.0, 0.3], [0.3, 1.0]];

    pub fn exact(t: f64) -> [[f64; 2]; 3] {
        let (s1, c1) = (1.3 * t).sin_cos();
        let (s2, c2) = (2.1 * t).sin_cos();
        let (s3, c3) = (0.9 * t + 0.4).sin_cos();
        [
            [s1 + 0.2 * c2, c3],
            [1.3 * c1 - 0.42 * s2, -0.9 * s3],
            [-1.69 * s1 - 0.882 * c2, -0.81 * c3],
        ]
    }

    pub fn start() -> State {
        let [q, v, _] = Self::exact(0.0);
        state(&q, &v)
    }

    fn internal(q: &[f64], v: &[f64]) -> [f64; 2] {
        let (d, dv) = (q[0] - q[1], v[0] - v[1]);
        let c = 1.5 * d + 0.4 * d * d * d + 0.3 * dv * (1.0 + d * d);
        [
            2.0 * q[0] + 0.5 * q[0].powi(3) + 0.2 * v[0] + c,
            1.2 * q[1] + 0.1 * v[1] + 0.05 * v[1].powi(3) - c,
        ]
    }

    pub fn error(s: &State) -> f64 {
        let [q, v, _] = Self::exact(s.t);
        (0..2)
            .map(|i| (s.q[i] - q[i]).abs().max((s.v[i] - v[i]).abs()))
            .fold(0.0, f64::max)
    }
}

impl SecondOrderSystem for Duffing {
    fn layout(&self) -> Layout {
        Layout {
            n: 2,
            event_functions: 0,
            discrete: 0,
        }
    }
    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        q.fill(1.0);
        v.fill(1.0);
    }
    fn characteristic_time(&self, _at: StateView<'_>) -> f64 {
        0.5
    }
    fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
        Some(self)
    }
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        let [q, v, a] = Self::exact(at.t);
        let (there, here) = (Self::internal(&q, &v), Self::internal(at.q, at.v));
        for i in 0..2 {
            f[i] = Self::M[i][0] * a[0] + Self::M[i][1] * a[1] + there[i] - here[i];
        }
    }
    fn solve_mass(&mut self, _at: StateView<'_>, f: &mut [f64]) {
        let [[a, b], [c, d]] = Self::M;
        let det = a * d - b * c;
        (f[0], f[1]) = ((d * f[0] - b * f[1]) / det, (a * f[1] - c * f[0]) / det);
    }
    fn apply_mass(&mut self, _at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        for i in 0..2 {
            y[i] = Self::M[i][0] * x[0] + Self::M[i][1] * x[1];
        }
    }
    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        let (q, v) = (at.q, at.v);
        let (d, vr) = (q[0] - q[1], v[0] - v[1]);
        let (dd, ddv) = (dq[0] - dq[1], dv[0] - dv[1]);
        let dc = (1.5 + 1.2 * d * d + 0.6 * vr * d) * dd + 0.3 * (1.0 + d * d) * ddv;
        df[0] = -((2.0 + 1.5 * q[0] * q[0]) * dq[0] + 0.2 * dv[0] + dc);
        df[1] = -(1.2 * dq[1] + (0.1 + 0.15 * v[1] * v[1]) * dv[1] - dc);
    }
}

/// Oscillator `x'' = -omega^2 x`, with `omega = 1` by default.
pub struct Oscillator {
    pub omega: f64,
}

impl SecondOrderSystem for Oscillator {
    fn layout(&self) -> Layout {
        Layout {
            n: 1,
            event_functions: 0,
            discrete: 0,
        }
    }
    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        q.fill(1.0);
        v.fill(self.omega);
    }
    fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
        Some(self)
    }
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        f[0] = -self.omega * self.omega * at.q[0];
    }
    fn solve_mass(&mut self, _at: StateView<'_>, _f: &mut [f64]) {}
    fn apply_mass(&mut self, _at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        y.copy_from_slice(x);
    }
    fn tangent_times(&mut self, _at: StateView<'_>, dq: &[f64], _dv: &[f64], df: &mut [f64]) {
        df[0] = -self.omega * self.omega * dq[0];
    }
    fn report(&mut self) -> Option<&mut dyn Report> {
        Some(self)
    }
}

impl Report for Oscillator {
    fn output(&mut self, at: StateView<'_>, out: &mut Outputs) {
        out.energy = Energy {
            kinetic: 0.5 * at.v[0] * at.v[0],
            strain: 0.5 * (self.omega * at.q[0]).powi(2),
            contact: 0.0,
        };
        out.channels.clear();
        out.channels.extend([at.q[0], at.v[0]]);
    }
}

/// A free chain of masses with stiffening, damped springs between neighbours: no external force.
pub struct Chain {
    pub masses: Vec<f64>,
    pub damping: f64,
}

impl Chain {
    pub fn momentum(&self, v: &[f64]) -> f64 {
        self.masses.iter().zip(v).map(|(m, v)| m * v).sum()
    }

    pub fn energy(&self, s: &State) -> f64 {
        let kinetic: f64 = self.masses.iter().zip(&s.v).map(|(m, v)| m * v * v).sum();
        let strain: f64 =
            s.q.windows(2)
                .map(|q| {
                    let d = q[1] - q[0];
                    2.0 * d * d + 0.75 * d.powi(4)
                })
                .sum();
        0.5 * kinetic + strain
    }
}

impl SecondOrderSystem for Chain {
    fn layout(&self) -> Layout {
        Layout {
            n: self.masses.len(),
            event_functions: 0,
            discrete: 0,
        }
    }
    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        q.fill(1.0);
        v.fill(1.0);
    }
    fn characteristic_time(&self, _at: StateView<'_>) -> f64 {
        0.3
    }
    fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
        Some(self)
    }
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        f.fill(0.0);
        for i in 1..f.len() {
            let (d, dv) = (at.q[i] - at.q[i - 1], at.v[i] - at.v[i - 1]);
            let s = 4.0 * d + 3.0 * d.powi(3) + self.damping * dv * (1.0 + d * d);
            f[i] -= s;
            f[i - 1] += s;
        }
    }
    fn solve_mass(&mut self, _at: StateView<'_>, f: &mut [f64]) {
        for (f, m) in f.iter_mut().zip(&self.masses) {
            *f /= m;
        }
    }
    fn apply_mass(&mut self, _at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        for i in 0..x.len() {
            y[i] = self.masses[i] * x[i];
        }
    }
    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        df.fill(0.0);
        for i in 1..df.len() {
            let (d, v) = (at.q[i] - at.q[i - 1], at.v[i] - at.v[i - 1]);
            let ds = (4.0 + 9.0 * d * d + 2.0 * self.damping * v * d) * (dq[i] - dq[i - 1])
                + self.damping * (1.0 + d * d) * (dv[i] - dv[i - 1]);
            df[i] -= ds;
            df[i - 1] += ds;
        }
    }
}

/// Returns a plan of `n` fixed steps.
pub fn steps(t_end: f64, n: f64) -> TimePlan<'static> {
    TimePlan::new(t_end, Resolution::Step(t_end / n))
}

/// Returns a plan under a tolerance.
pub fn tolerance(t_end: f64, rtol: f64) -> TimePlan<'static> {
    TimePlan::new(t_end, Resolution::Tolerance(rtol))
}

/// Returns a plan that suits a method: a tolerance, or `n` steps where it supports fixed steps.
pub fn plan_of(m: &Method, t_end: f64, n: f64, rtol: f64) -> TimePlan<'static> {
    match m.info.stepping {
        Stepping::Adaptive => tolerance(t_end, rtol),
        _ => steps(t_end, n),
    }
}
