//! Free deviations of the teeth outside the windows from their mean, in closed form.
//!
//! `m d'' + c d' + k d = 0` for every such tooth, so `(d, d')` at time `t` follows from its value at a common
//! reference time by one 2 x 2 matrix. The deviations sum to zero: they do not act on the body.
//!
//! Discrete state: `[t_ref, sum d^2, sum d d', sum d'^2, d_0, d_0', d_1, d_1', ...]`; entries of teeth inside windows
//! are zero.

use super::springs::ToothSprings;

/// Deviations of a gear with a number of teeth; all functions take the part of the discrete state with the deviations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deviations {
    pub teeth: usize,
}

/// Exchange of a tooth between a window and the mean.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exchange {
    /// Time of the exchange [s].
    pub t: f64,
    /// Number of teeth in the mean, before and after.
    pub count: f64,
    /// Index of the tooth that leaves the window and joins the mean.
    pub leaves: i64,
    /// Index of the tooth that leaves the mean and enters the window.
    pub enters: i64,
}

/// Number of cells before the deviations.
const HEAD: usize = 4;
/// Square of an amplitude below the resolution of angles [rad^2]. Deviations that have decayed below it are set to
/// zero before they become subnormal numbers, which are slow on processors.
const NOTHING: f64 = 1e-60;

/// Computes the propagator, `[d; d'](t) = P [d; d'](t_ref)`, row by row.
fn propagator(p: &ToothSprings, dt: f64) -> [f64; 4] {
    let (k, c, m) = (p.stiffness[0], p.damping[0], p.mass[0]);
    let (w2, a) = (k / m, 0.5 * c / m);
    let decay = (-a * dt).exp();
    let inside = w2 - a * a;
    // Underdamped, overdamped, and the limit between them.
    let (co, si) = if inside > 1e-12 * w2 {
        let w = inside.sqrt();
        ((w * dt).cos(), (w * dt).sin() / w)
    } else if inside < -1e-12 * w2 {
        let w = (-inside).sqrt();
        ((w * dt).cosh(), (w * dt).sinh() / w)
    } else {
        (1.0, dt)
    };
    [
        decay * (co + a * si),
        decay * si,
        -decay * w2 * si,
        decay * (co - a * si),
    ]
}

impl Deviations {
    /// Returns the length of the discrete state.
    pub fn cells(&self) -> usize {
        HEAD + 2 * self.teeth
    }

    fn cell(&self, index: i64) -> usize {
        HEAD + 2 * index.rem_euclid(self.teeth as i64) as usize
    }

    /// Calls `f` with `[d, d', d'']` at time `t` of every tooth with a deviation.
    pub fn each(
        &self,
        p: &ToothSprings,
        t: f64,
        discrete: &[f64],
        mut f: impl FnMut(usize, [f64; 3]),
    ) {
        if discrete[1] == 0.0 && discrete[3] == 0.0 {
            return;
        }
        let m = propagator(p, t - discrete[0]);
        let (k, c) = (p.stiffness[0] / p.mass[0], p.damping[0] / p.mass[0]);
        for (i, cell) in discrete[HEAD..].chunks_exact(2).enumerate() {
            let d = m[0] * cell[0] + m[1] * cell[1];
            let v = m[2] * cell[0] + m[3] * cell[1];
            f(i, [d, v, -k * d - c * v]);
        }
    }

    /// Returns `(sum d^2, sum d'^2)` at time `t`.
    pub fn squares(&self, p: &ToothSprings, t: f64, discrete: &[f64]) -> (f64, f64) {
        let [dd, dv, vv] = [discrete[1], discrete[2], discrete[3]];
        if dd == 0.0 && vv == 0.0 {
            return (0.0, 0.0);
        }
        let m = propagator(p, t - discrete[0]);
        (
            m[0] * m[0] * dd + 2.0 * m[0] * m[1] * dv + m[1] * m[1] * vv,
            m[2] * m[2] * dd + 2.0 * m[2] * m[3] * dv + m[3] * m[3] * vv,
        )
    }

    /// Exchanges the tooth in a slot: `state = [R, R', S, S']` of the mean and of the slot; `outside` returns true for
    /// the teeth that belong to the mean afterwards. The sums of positions and of velocities are conserved.
    pub fn exchange(
        &self,
        p: &ToothSprings,
        teeth: Exchange,
        discrete: &mut [f64],
        state: &mut [f64; 4],
        outside: impl Fn(i64) -> bool,
    ) {
        let Exchange { t, count, .. } = teeth;
        let m = propagator(p, t - discrete[0]);
        discrete[0] = t;
        let per_square = p.mass[0] / p.stiffness[0];
        for cell in discrete[HEAD..].chunks_exact_mut(2) {
            let (d, v) = (cell[0], cell[1]);
            cell[0] = m[0] * d + m[1] * v;
            cell[1] = m[2] * d + m[3] * v;
            if cell[0] * cell[0] + per_square * cell[1] * cell[1] < NOTHING {
                cell.fill(0.0);
            }
        }
        let (leaves, enters) = (self.cell(teeth.leaves), self.cell(teeth.enters));
        let [mean, mean_v, s, v] = *state;
        let (s_in, v_in) = (mean + discrete[enters], mean_v + discrete[enters + 1]);
        let (new, new_v) = (mean + (s - s_in) / count, mean_v + (v - v_in) / count);
        *state = [new, new_v, s_in, v_in];
        discrete[leaves] = s - mean;
        discrete[leaves + 1] = v - mean_v;
        discrete[enters] = 0.0;
        discrete[enters + 1] = 0.0;
        let mut sums = [0.0; 3];
        for i in 0..self.teeth {
            if !outside(i as i64) {
                continue;
            }
            let cell = &mut discrete[HEAD + 2 * i..][..2];
            cell[0] += mean - new;
            cell[1] += mean_v - new_v;
            sums[0] += cell[0] * cell[0];
            sums[1] += cell[0] * cell[1];
            sums[2] += cell[1] * cell[1];
        }
        discrete[1..HEAD].copy_from_slice(&sums);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn springs(damping: f64) -> ToothSprings {
        ToothSprings {
            uniform: true,
            stiffness: vec![5e8],
            damping: vec![damping],
            mass: vec![5e-3],
            radius_squared: 0.035 * 0.035,
            radius: None,
        }
    }

    #[test]
    fn propagates_the_free_equation() {
        // Central differences of the closed form satisfy m d'' + c d' + k d = 0, below and above critical.
        for c in [0.0, 200.0, 1e4] {
            let p = springs(c);
            let (t, h) = (3e-6, 1e-9);
            let d = |t: f64| {
                let m = propagator(&p, t);
                m[0] * 1e-6 + m[1] * 0.3
            };
            let v = (d(t + h) - d(t - h)) / (2.0 * h);
            let a = (d(t + h) - 2.0 * d(t) + d(t - h)) / (h * h);
            let residual = p.mass[0] * a + c * v + p.stiffness[0] * d(t);
            let m = propagator(&p, t);
            assert!((m[2] * 1e-6 + m[3] * 0.3 - v).abs() < 1e-5 * 0.3, "c {c}");
            assert!(
                residual.abs() < 1e-3 * p.stiffness[0] * 1e-6,
                "c {c}: {residual}"
            );
        }
    }

    #[test]
    fn exchange_keeps_sums_and_zero_mean_of_deviations() {
        let p = springs(0.0);
        let d = Deviations { teeth: 6 };
        let mut discrete = vec![0.0; d.cells()];
        // Teeth 0, 1, 2 in the window, 3, 4, 5 outside with deviations that sum to zero.
        for (i, x) in [(3, 2e-6), (4, -5e-6), (5, 3e-6)] {
            discrete[HEAD + 2 * i] = x;
        }
        let mut state = [1e-4, 2.0, 9e-5, 1.5];
        let before = 3.0 * state[0] + state[2];
        let before_v = 3.0 * state[1] + state[3];
        let teeth = Exchange {
            t: 0.0,
            count: 3.0,
            leaves: 0,
            enters: 3,
        };
        d.exchange(&p, teeth, &mut discrete, &mut state, |i| {
            ![1, 2, 3].contains(&i)
        });
        assert!((3.0 * state[0] + state[2] - before).abs() < 1e-18);
        assert!((3.0 * state[1] + state[3] - before_v).abs() < 1e-14);
        let sum: f64 = (0..6).map(|i| discrete[HEAD + 2 * i]).sum();
        assert!(sum.abs() < 1e-19, "{sum}");
        assert!((state[2] - (1e-4 + 2e-6)).abs() < 1e-18);
        // Tooth 0 is where it was, measured from the new mean.
        assert!((state[0] + discrete[HEAD] - 9e-5).abs() < 1e-18);
    }
}
