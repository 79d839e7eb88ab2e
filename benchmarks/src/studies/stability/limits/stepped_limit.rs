//! Stability limit of a method as implemented, without theory: the program steps a linear system, and the step is
//! halved and doubled until growth begins.
//!
//! Where dampers do not couple the modes, or the system is small, growth is the **spectral radius** of the amplification.
//! A method may carry more from step to step than coordinates and velocities (an acceleration that was evaluated at a
//! predicted velocity, an auxiliary one). So the amplification is realised from what can be seen, the states after
//! `0, 1, 2, 3` steps from unit states, `P_k = C A^k B`: with the Hankel matrices `H_0 = [P_0 P_1; P_1 P_2]` and
//! `H_1 = [P_1 P_2; P_2 P_3]` and `H_0 = U S V^T`, cut off at its rank,
//!
//! ```text
//! A = S^(-1/2) U^T H_1 V S^(-1/2)
//! ```
//!
//! up to a change of coordinates (the eigensystem realisation of J.-N. Juang, R. S. Pappa, *J. Guidance* 8 (1985) 620).
//! This tells a growth of a part in ten million per step, which Dormand-Prince without damping needs: beyond its limit it
//! grows that slowly.
//!
//! Larger systems whose modes dampers couple take **long runs** from a random state, where growth is a matter of per cent
//! per step: the energy doubles again and again in the second half.

use super::linear::{Dense, Linear};
use super::linearised::Linearised;
use super::system::{CoupledOscillators, Damping, Vibrations};
use super::{LimitError, first_unstable};
use gearbench_integrators::linear_stability::{Impulses, Stability};
use gearbench_integrators::{
    AcceptedStep, Control, Integrator, MethodSpec, Resolution, SecondOrderSystem, Sink, State,
    TimePlan, Work,
};
use nalgebra::DMatrix;

/// Coordinates up to which the amplification of a coupled system is formed.
const SMALL: usize = 40;
/// Radius above one that counts as growth.
const GROWTH: f64 = 1e-7;
/// Spectral radius above one that counts as growth of a whole system, in which the motion of free bodies is a double
/// eigenvalue of one that rounding splits.
const GROWTH_OF_ALL: f64 = 1e-5;
/// Singular values below this part of the largest are rounding.
const RANK: f64 = 1e-9;
/// Steps of a long run, and by how much the energy grows in its second half when it is unstable.
const LONG: u32 = 1600;
const LONG_GROWTH: f64 = 100.0;
/// Bounds of the search for limits, as steps over the fastest mode's time, `omega h`.
const FROM: f64 = 0.2;
const TO: f64 = 1e3;

/// The largest stable step [s] of a method at the scene's closed state, by stepping its linear system; `damped: false`
/// leaves its dampers out. `None` where no step up to a thousand times the fastest mode's is unstable, for methods
/// without a fixed step, and for systems that are too large to be stepped this way.
pub fn step_limit(
    linearised: &mut Linearised,
    method: MethodSpec,
    damped: bool,
) -> Result<Option<f64>, LimitError> {
    let integrator = method.build();
    let mut trial = SteppedMethod { integrator };
    match method.stability() {
        Stability::Controlled => Ok(None),
        Stability::Impulses(impulses) => trial.trigonometric_limit(linearised, impulses),
        _ => match linearised.linear()? {
            Linear::Dense(dense) if damped => trial.vibrations(&dense),
            Linear::Dense(dense) => trial.vibrations(&dense.undamped()),
            Linear::FastestMode(_) => Ok(None),
        },
    }
}

/// Integrator whose stability limit is searched.
struct SteppedMethod {
    integrator: Box<dyn Integrator>,
}

/// Records states after the first steps.
struct Snapshots(Vec<State>);

impl Sink for Snapshots {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        self.0.push(step.to.clone());
        Control::Continue
    }

    fn wants_restarts(&self) -> bool {
        false
    }
}

/// Energy of unit masses in the middle and at the end of a long run.
struct Energy<'a> {
    square: &'a [f64],
    steps: u32,
    middle: f64,
    end: f64,
}

impl Sink for Energy<'_> {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let s = step.to;
        let of = |i: usize| self.square[i] * s.q[i] * s.q[i] + s.v[i] * s.v[i];
        self.end = (0..s.q.len()).map(of).sum();
        self.steps += 1;
        if self.steps == LONG / 2 {
            self.middle = self.end;
        }
        // Long before numbers end.
        if self.end < 1e200 {
            Control::Continue
        } else {
            Control::Stop
        }
    }

    fn wants_restarts(&self) -> bool {
        false
    }
}

/// The first unstable step; the frequency [rad/s] sets where to look.
fn search(
    omega: f64,
    unstable: impl FnMut(f64) -> Result<bool, LimitError>,
) -> Result<Option<f64>, LimitError> {
    first_unstable([FROM / omega, TO / omega], unstable)
}

impl SteppedMethod {
    fn vibrations(&mut self, dense: &Dense) -> Result<Option<f64>, LimitError> {
        if dense.at_ends.is_none()
            && let Some(modes) = dense.modes()
        {
            if modes.is_empty() {
                return Ok(None);
            }
            let mut sys = Vibrations::independent(&modes);
            return search(sys.highest, |h| self.modes_grow(&mut sys, h));
        }
        let mut sys = Vibrations::coupled(dense);
        if sys.n() <= SMALL {
            search(sys.highest, |h| self.all_grow(&mut sys, h))
        } else {
            let square = sys.square.as_slice().to_vec();
            search(sys.highest, |h| self.long_run_grows(&mut sys, &square, h))
        }
    }

    /// The trigonometric method, whose rest depends on the step; without damping.
    fn trigonometric_limit(
        &mut self,
        linearised: &mut Linearised,
        impulses: Impulses,
    ) -> Result<Option<f64>, LimitError> {
        let Some(omega) = linearised.oscillators() else {
            return Ok(None);
        };
        let first = omega.iter().copied().fold(0.0, f64::max);
        let rest = linearised.rest(&omega, impulses, f64::MIN_POSITIVE)?;
        let stiffest = rest.symmetric_eigenvalues().max().max(0.0).sqrt();
        if stiffest == 0.0 {
            return Ok(None);
        }
        let square: Vec<f64> = omega.iter().map(|w| w * w).collect();
        let mut sys = CoupledOscillators {
            omega: omega.clone(),
            rest,
        };
        // Resonances begin where the fastest mode turns by pi in a step; the limit is sought below.
        let last = 0.999 * std::f64::consts::PI / first;
        let found = search(stiffest.max(first), |h| {
            if h > last {
                return Ok(true);
            }
            sys.rest = linearised.rest(&omega, impulses, h)?;
            self.long_run_grows(&mut sys, &square, h)
        })?;
        Ok(found.filter(|h| *h < 0.99 * last))
    }

    /// Steps from a state; false where the run fails.
    fn run(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        s: &mut State,
        (h, steps): (f64, u32),
        sink: &mut dyn Sink,
    ) -> bool {
        let plan = TimePlan::new(f64::from(steps) * h, Resolution::Step(h));
        self.integrator
            .run(sys, s, &plan, sink, &mut Work::default())
            .is_ok()
    }

    /// Four steps from a state, with the state itself in front; `None` where a step fails.
    fn snapshots(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        mut s: State,
        h: f64,
    ) -> Option<Vec<State>> {
        let mut seen = Snapshots(vec![s.clone()]);
        let ended = self.run(sys, &mut s, (h, 3), &mut seen);
        (ended && seen.0.len() == 4).then_some(seen.0)
    }

    /// True if any of the independent modes grows; two runs suffice for all modes.
    fn modes_grow(&mut self, sys: &mut Vibrations, h: f64) -> Result<bool, LimitError> {
        let n = sys.n();
        let omega: Vec<f64> = sys.square.iter().map(|x| x.sqrt()).collect();
        let at_rest = vec![0.0; n];
        let moved = State {
            q: vec![1.0; n],
            v: at_rest.clone(),
            ..State::default()
        };
        let kicked = State {
            q: at_rest,
            v: omega.clone(),
            ..State::default()
        };
        let (Some(a), Some(b)) = (
            self.snapshots(sys, moved, h),
            self.snapshots(sys, kicked, h),
        ) else {
            return Ok(true);
        };
        for i in 0..n {
            let of_step = |k: usize| {
                let column = |s: &State| [s.q[i], s.v[i] / omega[i]];
                let ([x, y], [z, w]) = (column(&a[k]), column(&b[k]));
                DMatrix::from_column_slice(2, 2, &[x, y, z, w])
            };
            if radius(&[0, 1, 2, 3].map(of_step))? > 1.0 + GROWTH {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The whole system, from every unit state.
    fn all_grow(&mut self, sys: &mut Vibrations, h: f64) -> Result<bool, LimitError> {
        let n = sys.n();
        let w = sys.highest;
        // Free motion that no damper feels only drifts.
        let Damping::Full(damping) = &sys.damping else {
            return Ok(false);
        };
        let largest = damping.amax();
        let free =
            |i: usize| sys.square[i].sqrt() < 1e-5 * w && damping.row(i).amax() <= 1e-9 * largest;
        let kept: Vec<usize> = (0..n).filter(|i| !free(*i)).collect();
        let size = 2 * kept.len();
        let mut of_steps = [0, 1, 2, 3].map(|_| DMatrix::zeros(size, size));
        for (j, (&at, moves)) in (kept.iter().map(|k| (k, false)))
            .chain(kept.iter().map(|k| (k, true)))
            .enumerate()
        {
            let mut s = State {
                q: vec![0.0; n],
                v: vec![0.0; n],
                ..State::default()
            };
            if moves {
                s.v[at] = w;
            } else {
                s.q[at] = 1.0;
            }
            let Some(states) = self.snapshots(sys, s, h) else {
                return Ok(true);
            };
            for (p, s) in of_steps.iter_mut().zip(&states) {
                for (i, &k) in kept.iter().enumerate() {
                    p[(i, j)] = s.q[k];
                    p[(i + kept.len(), j)] = s.v[k] / w;
                }
            }
        }
        Ok(radius(&of_steps)? > 1.0 + GROWTH_OF_ALL)
    }

    /// A long run from a random state; `square` are the squared frequencies of the energy.
    fn long_run_grows(
        &mut self,
        sys: &mut dyn SecondOrderSystem,
        square: &[f64],
        h: f64,
    ) -> Result<bool, LimitError> {
        let n = square.len();
        let highest = square.iter().copied().fold(0.0, f64::max).sqrt();
        let mut seed = 0x2545_f491_4f6c_dd1d_u64;
        let mut draw = || {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            seed as f64 / u64::MAX as f64 - 0.5
        };
        let mut s = State {
            q: (0..n).map(|_| draw()).collect(),
            v: (0..n).map(|_| highest.max(1.0) * draw()).collect(),
            ..State::default()
        };
        let mut energy = Energy {
            square,
            steps: 0,
            middle: f64::INFINITY,
            end: 0.0,
        };
        let ended = self.run(sys, &mut s, (h, LONG), &mut energy);
        // A run that the sink stopped has no middle, or grew beyond it.
        Ok(!ended || energy.steps < LONG || energy.end > LONG_GROWTH * energy.middle)
    }
}

/// Spectral radius of the amplification behind the states after none to three steps.
fn radius(p: &[DMatrix<f64>; 4]) -> Result<f64, LimitError> {
    let n = p[0].nrows();
    let hankel = |first: usize| {
        DMatrix::from_fn(2 * n, 2 * n, |i, j| {
            p[first + i / n + j / n][(i % n, j % n)]
        })
    };
    let (h0, h1) = (hankel(0), hankel(1));
    if !h0.iter().chain(&h1).all(|x| x.is_finite()) {
        return Ok(f64::INFINITY);
    }
    let svd = h0.svd(true, true);
    let (Some(u), Some(vt)) = (&svd.u, &svd.v_t) else {
        return Err(LimitError::Matrices(
            "an amplification has no singular values",
        ));
    };
    let largest = svd.singular_values.max();
    let kept: Vec<usize> = (0..2 * n)
        .filter(|&i| svd.singular_values[i] > RANK * largest)
        .collect();
    let u = u.select_columns(&kept);
    let vt = vt.select_rows(&kept);
    let inner = u.transpose() * h1 * vt.transpose();
    let root: Vec<f64> = kept
        .iter()
        .map(|&i| svd.singular_values[i].sqrt())
        .collect();
    let size = kept.len();
    let a = faer::Mat::from_fn(size, size, |i, j| inner[(i, j)] / (root[i] * root[j]));
    let values = super::linear::eigenvalues(&a)?;
    Ok(values.iter().fold(0.0, |m, z| z[0].hypot(z[1]).max(m)))
}
