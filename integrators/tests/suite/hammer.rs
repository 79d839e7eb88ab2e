//! Gears that impact within their backlash, with an exact piecewise solution.

use crate::problems::watch;
use gearbench_integrators::{
    AcceptedStep, Change, Control, Energy, Events, FlightPath, FreeFlight, Layout, Method,
    ModalSplit, Outputs, Power, Report, SecondOrderSystem, Sink, State, StateView, TimePlan, Work,
};

/// Two gears with backlash that touch on one line of action, with a linear penalty and non-adhesive Kelvin-Voigt
/// damping: exact piece by piece. The relative coordinate `s = r_b1 phi_1 - r_b2 phi_2` is free for `|s| < j/2`.
#[derive(Clone)]
pub struct Hammer {
    pub inertia: [f64; 2],
    pub radius: [f64; 2],
    pub stiffness: f64,
    pub damping: f64,
    pub backlash: f64,
    /// Speeds at the start [rad/s]; `s` starts at `s0` [m].
    pub speed: [f64; 2],
    pub s0: f64,
    /// Number of evaluations of the outputs.
    pub looks: u64,
}

/// Discrete state of a run without event location, with clipped force.
const CLIPPED: f64 = 2.0;

impl Hammer {
    /// Builds steel spur gears z = 20/30, m = 5 mm, b = 20 mm, as discs of pitch radius; `zeta` is the damping ratio
    /// of the contact.
    pub fn gears(zeta: f64) -> Self {
        let (z, m, b, alpha) = ([20.0, 30.0], 5e-3, 20e-3, 20f64.to_radians());
        let pitch = z.map(|z| 0.5 * m * z);
        let radius = pitch.map(|r| r * alpha.cos());
        let inertia = pitch.map(|r| 0.5 * 7850.0 * std::f64::consts::PI * b * r.powi(4));
        let mut h = Hammer {
            inertia,
            radius,
            stiffness: 5.72e9 * b,
            damping: 0.0,
            backlash: 1e-4,
            speed: [101.0, 66.0],
            s0: 0.0,
            looks: 0,
        };
        h.damping = 2.0 * zeta * (h.stiffness * h.reduced_mass()).sqrt();
        h
    }

    /// Builds one impact from a gap of a tenth of a micrometre; it ends before `t_end()`.
    pub fn one_impact(zeta: f64) -> Self {
        let mut h = Self::gears(zeta);
        h.speed = [1.0, 0.0];
        h.s0 = 0.5 * h.backlash - 1e-7 * 1.7;
        h
    }

    pub fn reduced_mass(&self) -> f64 {
        let m = [0, 1].map(|i| self.inertia[i] / self.radius[i].powi(2));
        m[0] * m[1] / (m[0] + m[1])
    }

    pub fn omega(&self) -> f64 {
        (self.stiffness / self.reduced_mass()).sqrt()
    }

    pub fn start(&self) -> State {
        State {
            t: 0.0,
            q: vec![self.s0 / self.radius[0], 0.0],
            v: self.speed.to_vec(),
            discrete: vec![0.0],
        }
    }

    fn relative(&self, at: StateView<'_>) -> (f64, f64) {
        let r = self.radius;
        (
            r[0] * at.q[0] - r[1] * at.q[1],
            r[0] * at.v[0] - r[1] * at.v[1],
        )
    }

    /// Returns the force on the line of action, positive on the driving flank.
    fn line_force(&self, at: StateView<'_>) -> f64 {
        let (s, u) = self.relative(at);
        let side = at.discrete[0];
        if side == 0.0 {
            0.0
        } else if side == CLIPPED {
            let p = s.abs() - 0.5 * self.backlash;
            if p <= 0.0 {
                return 0.0;
            }
            s.signum() * (self.stiffness * p + self.damping * u * s.signum()).max(0.0)
        } else {
            self.stiffness * (s - 0.5 * side * self.backlash) + self.damping * u
        }
    }

    /// Computes `(s, s')` at a time from the closed-form pieces, and the number of impacts so far.
    pub fn exact(&self, t: f64) -> (f64, f64, u32) {
        let (r, half) = (self.radius, 0.5 * self.backlash);
        let (w0, m) = (self.omega(), self.reduced_mass());
        let delta = 0.5 * self.damping / m;
        let wd = (w0 * w0 - delta * delta).sqrt();
        // c x + d x' = 0 on x = sin(wd t) e^(-delta t).
        let y = self.damping * wd;
        let x = self.stiffness - self.damping * delta;
        let contact = (std::f64::consts::PI - y.atan2(x)) / wd;
        let piece = |u: f64, tau: f64| {
            let e = (-delta * tau).exp();
            let (sin, cos) = (wd * tau).sin_cos();
            (u / wd * e * sin, u * e * (cos - delta / wd * sin))
        };
        let (mut now, mut s) = (0.0, self.s0);
        let mut u = r[0] * self.speed[0] - r[1] * self.speed[1];
        let mut impacts = 0;
        loop {
            let side = u.signum();
            let flight = (side * half - s) / u;
            if now + flight >= t {
                return (s + u * (t - now), u, impacts);
            }
            now += flight;
            impacts += 1;
            if now + contact >= t {
                let (x, v) = piece(u, t - now);
                return (side * half + x, v, impacts);
            }
            let (x, v) = piece(u, contact);
            (s, u) = (side * half + x, v);
            now += contact;
        }
    }

    /// Returns the error of the relative motion at the end, relative to the initial relative speed. The position is
    /// weighted by the speed over half a contact.
    pub fn error(&self, s: &State) -> f64 {
        let (x, u, _) = self.exact(s.t);
        let (x1, u1) = self.relative(s.at());
        let u0 = self.radius[0] * self.speed[0] - self.radius[1] * self.speed[1];
        ((u1 - u) / u0)
            .abs()
            .max(((x1 - x) * self.omega() / u0).abs())
    }

    /// Returns the linear momentum of the pair, invariant without external torque.
    pub fn momentum(&self, v: &[f64]) -> f64 {
        self.inertia[0] * v[0] / self.radius[0] + self.inertia[1] * v[1] / self.radius[1]
    }
}

impl ModalSplit for Hammer {
    fn oscillators(&self, omega: &mut [f64], zeta: &mut [f64]) {
        omega.fill(0.0);
        zeta.fill(0.0);
    }
    fn remainder(&mut self, at: StateView<'_>, a: &mut [f64]) {
        self.force(at, a);
        self.solve_mass(at, a);
    }
    fn steady(&mut self, _at: StateView<'_>, a: &mut [f64]) -> f64 {
        a.fill(0.0);
        f64::INFINITY
    }
    fn free_until(&mut self, s: &State) -> f64 {
        let (x, u) = self.relative(s.at());
        let gap = 0.5 * self.backlash - u.signum() * x;
        if s.discrete[0].abs() == 1.0 || x.abs() >= 0.5 * self.backlash {
            return s.t;
        }
        s.t + (1.0 - 1e-9) * gap / u.abs()
    }
}

impl SecondOrderSystem for Hammer {
    fn layout(&self) -> Layout {
        Layout {
            n: 2,
            event_functions: 2,
            discrete: 1,
        }
    }
    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        let u = (self.radius[0] * self.speed[0] - self.radius[1] * self.speed[1]).abs();
        for i in 0..2 {
            v[i] = u / self.radius[i];
            q[i] = v[i] / self.omega();
        }
    }
    fn characteristic_time(&self, at: StateView<'_>) -> f64 {
        if at.discrete[0] == 0.0 {
            f64::INFINITY
        } else {
            1.0 / self.omega()
        }
    }
    fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
        Some(self)
    }
    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        let n = self.line_force(at);
        f[0] = -self.radius[0] * n;
        f[1] = self.radius[1] * n;
    }
    fn solve_mass(&mut self, _at: StateView<'_>, f: &mut [f64]) {
        f[0] /= self.inertia[0];
        f[1] /= self.inertia[1];
    }
    fn apply_mass(&mut self, _at: StateView<'_>, x: &[f64], y: &mut [f64]) {
        y[0] = self.inertia[0] * x[0];
        y[1] = self.inertia[1] * x[1];
    }
    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        let (ds, du) = self.relative(StateView { q: dq, v: dv, ..at });
        let closed = if at.discrete[0] == CLIPPED {
            self.line_force(at) != 0.0
        } else {
            at.discrete[0] != 0.0
        };
        let dn = if closed {
            self.stiffness * ds + self.damping * du
        } else {
            0.0
        };
        df[0] = -self.radius[0] * dn;
        df[1] = self.radius[1] * dn;
    }
    fn events(&mut self) -> Option<&mut dyn Events> {
        Some(self)
    }
    fn free_flight(&mut self) -> Option<&mut dyn FreeFlight> {
        Some(self)
    }
    fn report(&mut self) -> Option<&mut dyn Report> {
        Some(self)
    }
}

impl Events for Hammer {
    /// Computes the event functions per flank. A closed contact lasts while its force pushes. An open one lasts until
    /// the flank is reached, and after a release with damping, where the penetration is not yet zero, while the force
    /// would pull.
    fn event_functions(&mut self, at: StateView<'_>, out: &mut [f64]) {
        let (s, u) = self.relative(at);
        let lag = self.damping / self.stiffness;
        for (out, side) in out.iter_mut().zip([1.0, -1.0]) {
            let p = side * s - 0.5 * self.backlash;
            *out = if at.discrete[0] == side {
                p + lag * side * u
            } else {
                -p + lag * (-side * u).max(0.0)
            };
        }
    }
    fn begin(&mut self, s: &mut State, located: bool) {
        s.discrete[0] = if located { 0.0 } else { CLIPPED };
    }
    fn transition(&mut self, s: &mut State, event: usize) -> Change {
        let side = [1.0, -1.0][event];
        s.discrete[0] = if s.discrete[0] == side { 0.0 } else { side };
        Change::Restart
    }
}

impl FreeFlight for Hammer {
    fn flight_path(&mut self, s: &State, later: f64, path: &mut FlightPath) -> f64 {
        let until = self.free_until(s);
        if until > later {
            path.begin(s.t);
            for i in 0..2 {
                path.oscillator(0.0, 0.0, [s.q[i], s.v[i]], 0.0);
                path.moves(i, 1.0);
            }
        }
        until
    }
}

impl Report for Hammer {
    fn output(&mut self, at: StateView<'_>, out: &mut Outputs) {
        self.looks += 1;
        let n = self.line_force(at);
        let (s, u) = self.relative(at);
        let pen = (s.abs() - 0.5 * self.backlash).max(0.0);
        let contact = if at.discrete[0] == 0.0 {
            0.0
        } else {
            0.5 * self.stiffness * pen * pen
        };
        out.energy = Energy {
            kinetic: 0.5 * (self.inertia[0] * at.v[0].powi(2) + self.inertia[1] * at.v[1].powi(2)),
            strain: 0.0,
            contact,
        };
        out.power = Power {
            external: 0.0,
            dissipated: if n == 0.0 { 0.0 } else { self.damping * u * u },
            ..Power::default()
        };
        out.channels.clear();
        out.channels.extend([at.v[0], at.v[1], n]);
    }
}

/// Returns the time at which the impact of [`Hammer::one_impact`] is over [s].
pub fn after_impact(h: &Hammer) -> f64 {
    let u = h.radius[0] * h.speed[0] - h.radius[1] * h.speed[1];
    (0.5 * h.backlash - h.s0) / u + 4.0 / h.omega()
}

/// Root mean square error of the relative speed over its initial value, on a grid of dense output.
pub struct SpeedError<'a> {
    hammer: &'a Hammer,
    grid: f64,
    next: u32,
    sum: f64,
    q: [f64; 2],
    v: [f64; 2],
}

impl<'a> SpeedError<'a> {
    pub fn new(hammer: &'a Hammer, grid: f64) -> Self {
        SpeedError {
            hammer,
            grid,
            next: 0,
            sum: 0.0,
            q: [0.0; 2],
            v: [0.0; 2],
        }
    }

    pub fn rms(&self) -> f64 {
        (self.sum / f64::from(self.next)).sqrt()
    }
}

impl Sink for SpeedError<'_> {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let h = step.to.t - step.from.t;
        let r = self.hammer.radius;
        let u0 = r[0] * self.hammer.speed[0] - r[1] * self.hammer.speed[1];
        while f64::from(self.next) * self.grid <= step.to.t {
            let t = f64::from(self.next) * self.grid;
            let theta = (t - step.from.t) / h;
            step.dense.eval(theta, &mut self.q, &mut self.v);
            let u = r[0] * self.v[0] - r[1] * self.v[1];
            self.sum += ((u - self.hammer.exact(t).1) / u0).powi(2);
            self.next += 1;
        }
        Control::Continue
    }
}

/// Runs a method and measures [`SpeedError`] on a grid of that many points.
pub fn speed_error(
    method: &Method,
    hammer: &Hammer,
    plan: &TimePlan<'_>,
    points: f64,
) -> (f64, Work) {
    let mut error = SpeedError::new(hammer, plan.t_end / points);
    let (mut sys, start) = (hammer.clone(), hammer.start());
    let (_, work) = watch(method.info.id, &mut sys, start, plan, &mut error);
    (error.rms(), work)
}
