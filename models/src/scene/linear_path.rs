//! Closed-form motion from event to event of two rigid gears on one constant spring and damper.
//!
//! With the displacements `x` of both gears the gap of left flanks is `g_l = G_l + y`, that of right flanks `g_r = G_r - y`,
//! `y = p . x`. Under steady loads, with `1/m = sum p^2/J` over the gears that are free, `a_0` the acceleration of `y`
//! without contact, and the force `N = -k g - c g'` of what is closed,
//!
//! ```text
//! y'' = a_0 + (N_l - N_r)/m,    x_i = u_i + m p_i/J_i y,    u_i'' = T_i/J_i - m p_i/J_i a_0
//! ```
//!
//! so that `y` is one damped oscillator under a constant load, in flight or contact, and `u` a motion under constant
//! loads. The next event is the first fall to zero of the force `N` of a closed contact, or of an open gap (or the
//! rise of a force, after a damper released flanks that still overlap): a root of a quadratic in flight, and of `N_e +
//! e^(-d t) (P cos w t + Q sin w t)` in contact, whose extremes are known and bracket it.
//!
//! **Where it holds**: one mesh, rigid gears, unmodified equal teeth, one stiffness for the whole mesh that does not vary
//! along the path, a law linear in gap and gap rate, no friction, backlash, damping below critical; loads that are steady.

use super::assembled::Scene;
use super::direct::FlankMotion;
use super::members::{SceneGear, SceneMesh};
use crate::geometry::Side;
use gearbench_integrators::FlightPath;
use gearbench_integrators::modal::propagator::coefficients;
use gearbench_integrators::system::{Events, StateView};

/// Step in which observers resolve a contact, in radians of its oscillation.
const PHASE: f64 = 0.5;
/// Largest number of corrections of the time of an event.
const MAX_CORRECTIONS: u32 = 100;

/// The single spring of a scene with a closed form.
#[derive(Clone, Debug)]
pub(super) struct OneSpring {
    /// Gaps of left and of right flanks at the assembled position [m].
    gaps: [f64; 2],
    /// Change of the gap of left flanks by the displacement of each gear [m] or [-].
    per_displacement: [f64; 2],
    /// Stiffness [N/m] and damping [N s/m].
    stiffness: f64,
    damper: f64,
}

/// One side of the teeth, with the gap `gap + sign y`.
#[derive(Clone, Copy, Debug)]
struct Flank {
    gap: f64,
    sign: f64,
    closed: bool,
}

impl OneSpring {
    /// Returns the single spring of a scene, if there is one.
    pub(super) fn of(gears: &[SceneGear], meshes: &[SceneMesh]) -> Option<Self> {
        let [mesh] = meshes else { return None };
        let pairs = mesh.search.pairs()?;
        let rigid = gears.len() == 2 && gears.iter().all(|g| g.follows == FlankMotion::Hub);
        let fits = rigid
            && mesh.arms.is_some()
            && pairs.is_one_constant_spring()
            && mesh.law.is_piecewise_linear();
        let of = |side| pairs.clearance_of(side);
        let [left, right] = Side::BOTH.map(of);
        let (left, right) = (left?, right?);
        let backlash = left.assembled + right.assembled;
        (fits && backlash > 0.0).then(|| OneSpring {
            gaps: [left.assembled, right.assembled],
            per_displacement: left.per_displacement,
            stiffness: pairs.stiffness.eval(0.0).0,
            damper: mesh.law.damper(),
        })
    }
}

/// Damped oscillation about its static position, in which `alpha y + beta y'` is evaluated.
#[derive(Clone, Copy, Debug)]
struct DampedOscillation {
    omega: f64,
    zeta: f64,
    load: f64,
    start: [f64; 2],
}

impl DampedOscillation {
    fn at(&self, t: f64) -> [f64; 2] {
        let c = coefficients(self.omega, self.zeta, t);
        let [y, v] = self.start;
        [
            c.qq * y + c.qv * v + c.qg * self.load,
            c.vq * y + c.vv * v + c.qv * self.load,
        ]
    }

    /// Returns the acceleration at a position and speed.
    fn acceleration(&self, [y, v]: [f64; 2]) -> f64 {
        self.load - 2.0 * self.zeta * self.omega * v - self.omega * self.omega * y
    }

    /// Returns the first time [s] at which `f = offset + alpha y + beta y'` falls to zero in an oscillation, or
    /// infinity. Minima of a decaying oscillation only rise, so that the first one decides.
    fn falls(&self, offset: f64, [alpha, beta]: [f64; 2]) -> f64 {
        let value = |x: [f64; 2]| offset + alpha * x[0] + beta * x[1];
        let slope = |x: [f64; 2]| alpha * x[1] + beta * self.acceleration(x);
        let x = self.start;
        let jerk = -2.0 * self.zeta * self.omega * self.acceleration(x) - self.omega.powi(2) * x[1];
        let (first, second) = (slope(x), alpha * self.acceleration(x) + beta * jerk);
        let decay = self.zeta * self.omega;
        let w = self.omega * ((1.0 - self.zeta) * (1.0 + self.zeta)).sqrt();
        // f' = e^(-d t) (P cos w t + Q sin w t).
        let (p, q) = (first, (second + decay * first) / w);
        if p == 0.0 && q == 0.0 {
            return f64::INFINITY;
        }
        let half = std::f64::consts::PI / w;
        let mut extreme = (-p).atan2(q) / w;
        while extreme <= 0.0 {
            extreme += half;
        }
        while extreme > half {
            extreme -= half;
        }
        let falling = first < 0.0 || (first == 0.0 && second < 0.0);
        let (mut lo, mut hi) = if falling {
            (0.0, extreme)
        } else {
            (extreme, extreme + half)
        };
        let (above, below) = (value(self.at(lo)), value(self.at(hi)));
        if below > 0.0 || below.is_nan() {
            return f64::INFINITY;
        }
        if above <= 0.0 {
            return lo;
        }
        // Between two extremes f is all but half a wave.
        let (mean, height) = (0.5 * (above + below), 0.5 * (above - below));
        let wave = (-mean / height).clamp(-1.0, 1.0).acos() * std::f64::consts::FRAC_1_PI;
        let mut t = lo + wave * (hi - lo);
        for _ in 0..MAX_CORRECTIONS {
            let x = self.at(t);
            let f = value(x);
            if f > 0.0 {
                lo = t;
            } else {
                hi = t;
            }
            let next = t - f / slope(x);
            if (next - t).abs() <= 2.0 * f64::EPSILON * t {
                break;
            }
            t = if next > lo && next < hi {
                next
            } else {
                0.5 * (lo + hi)
            };
        }
        t
    }
}

/// Returns the first time after 0 at which `c + b t + a t^2 / 2` crosses zero in the given direction, or infinity.
fn crosses(c: f64, b: f64, a: f64, downwards: bool) -> f64 {
    let sign = if downwards { 1.0 } else { -1.0 };
    let (c, b, a) = (sign * c, sign * b, sign * a);
    let disc = b * b - 2.0 * a * c;
    if disc < 0.0 || (a == 0.0 && b >= 0.0) {
        return f64::INFINITY;
    }
    // At the root that falls the slope is -sqrt(disc).
    let root = disc.sqrt();
    let t = if b <= 0.0 {
        2.0 * c / (root - b)
    } else {
        -(b + root) / a
    };
    if t > 0.0 { t } else { f64::INFINITY }
}

impl Scene {
    /// Computes [`FreeFlight::linear_path`](gearbench_integrators::FreeFlight::linear_path) of the scene.
    pub(super) fn linear_path_from(&self, at: StateView<'_>, path: &mut FlightPath) -> f64 {
        self.one_spring_path(at, path).unwrap_or(at.t)
    }

    fn one_spring_path(&self, at: StateView<'_>, path: &mut FlightPath) -> Option<f64> {
        let spring = self.one_spring.as_ref()?;
        let mesh = &self.meshes[0];
        let p = spring.per_displacement;
        // Displacement, speed, and acceleration without contact of both gears, and of `y`.
        let (mut motion, mut y) = ([[0.0; 3]; 2], [0.0; 3]);
        let (mut loose, mut yields) = (0.0, [0.0; 2]);
        for k in 0..2 {
            let g = &self.gears[mesh.gears[k]];
            let hub = g.model.hub();
            motion[k] = hub.frame(g.at(at), g.steady_load(at.t)?);
            for d in 0..3 {
                y[d] += p[k] * motion[k][d];
            }
            if hub.is_free() {
                yields[k] = p[k] / hub.inertia;
                loose += p[k] * yields[k];
            }
        }
        if loose == 0.0 {
            return None;
        }
        let modes = &at.discrete[mesh.modes()];
        let slots = mesh.slots / 2;
        let mut flanks = [1.0, -1.0].map(|sign| Flank {
            gap: 0.0,
            sign,
            closed: false,
        });
        for (side, flank) in flanks.iter_mut().enumerate() {
            flank.gap = spring.gaps[side];
            let own = &modes[2 * slots * side..][..2 * slots];
            let closed = own.chunks_exact(2).filter(|mode| mode[0] != 0.0).count();
            // Slices of one side open and close together.
            if closed != 0 && closed != slots {
                return None;
            }
            flank.closed = closed > 0;
        }
        let closed = flanks.iter().filter(|f| f.closed);
        let (k, c) = (spring.stiffness, spring.damper);
        let (count, pushed) =
            closed.fold((0.0, 0.0), |(n, sum), f| (n + 1.0, sum + f.sign * f.gap));
        // Backlash keeps one side open.
        if count > 1.0 {
            return None;
        }
        let omega = (loose * k * count).sqrt();
        let swing = DampedOscillation {
            omega,
            zeta: if count > 0.0 {
                0.5 * loose * c / omega
            } else {
                0.0
            },
            load: y[2] - loose * k * pushed,
            start: [y[0], y[1]],
        };
        if swing.zeta >= 1.0 || swing.zeta.is_nan() {
            return None;
        }
        let (mut first, mut who) = (f64::INFINITY, 0);
        for (side, flank) in flanks.iter().enumerate() {
            let time = if flank.closed {
                // N = -k (G + sign y) - c sign y'.
                swing.falls(-k * flank.gap, [-k * flank.sign, -c * flank.sign])
            } else if count > 0.0 {
                f64::INFINITY
            } else {
                let [g, rate, acceleration] = [
                    flank.gap + flank.sign * y[0],
                    flank.sign * y[1],
                    flank.sign * y[2],
                ];
                touches([g, rate, acceleration], k, c)
            };
            if time < first {
                (first, who) = (time, side);
            }
        }
        path.begin(at.t);
        let until = at.t + first;
        let breakpoint = self.next_breakpoint(at.t);
        if until <= breakpoint {
            for slot in slots * who..slots * (who + 1) {
                path.switch_at_end(mesh.event_functions + mesh.zones + slot);
            }
        }
        if count > 0.0 {
            path.press(PHASE / omega);
        }
        path.oscillator(swing.omega, swing.zeta, swing.start, swing.load);
        let shares = yields.map(|y| y / loose);
        for (i, share) in mesh.gears.iter().zip(shares) {
            let g = &self.gears[*i];
            if g.n > 0 {
                path.moves(g.offset, share);
            }
        }
        for ((i, share), x) in mesh.gears.iter().zip(shares).zip(motion) {
            let g = &self.gears[*i];
            if g.n > 0 {
                let rest = [0, 1, 2].map(|d| x[d] - share * y[d]);
                path.oscillator(0.0, 0.0, [rest[0], rest[1]], rest[2]);
                path.moves(g.offset, 1.0);
            }
        }
        Some(until.min(breakpoint))
    }
}

/// Returns the time at which an open flank in flight closes [s]: its gap falls to zero, or, while it still overlaps
/// after a release with a damper, its force rises to zero.
fn touches([g, rate, acceleration]: [f64; 3], k: f64, c: f64) -> f64 {
    // A gap within rounding of zero counts to the side in which its rate points.
    let parts = crosses(g, rate, acceleration, false);
    if g > 0.0 || (g == 0.0 && rate >= 0.0) {
        return crosses(g, rate, acceleration, true);
    }
    let force = [
        -k * g - c * rate,
        -k * rate - c * acceleration,
        -k * acceleration,
    ];
    if force[0] > 0.0 && force[1] >= 0.0 {
        return 0.0;
    }
    let pushes = crosses(force[0], force[1], force[2], false);
    if pushes < parts {
        return pushes;
    }
    // It parts first, and may come back.
    let away = rate + acceleration * parts;
    parts + crosses(0.0, away, acceleration, true)
}
