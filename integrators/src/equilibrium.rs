//! Static equilibrium: `f(t, q, v = 0) = 0` at a fixed time, by Newton's method with the analytic tangent of the
//! system.
//!
//! ```text
//! K dx = f,   q <- q + alpha dx,   K = -df/dq
//! ```
//!
//! The line search for the step `alpha` uses the work of the residual along the correction, `dx . f(q + alpha dx)`. It
//! has one unit whatever the coordinates are, and with elastic forces it is the slope of the potential, so that a
//! contact that closes inside a step appears as a change of sign (M. A. Crisfield, *Nonlinear Finite Element Analysis
//! of Solids and Structures*, vol. 1, ch. 9). Contacts are clipped ([`SecondOrderSystem::begin`] with
//! `located = false`). The force is then piecewise smooth, and the number of Newton steps is about the number of
//! changes of the set of closed contacts.
//!
//! **Bodies that only a contact supports** have a singular block of the matrix even where the whole system is
//! supported. A system that corrects block by block then returns [`Singular`]. Its matrix is shifted by a small mass,
//! `K + mu M`, with `mu` a small fraction of the Rayleigh quotient of the motion that the residual starts. The shift
//! changes the path to the equilibrium, not the equilibrium. A body that keeps moving under the shift has no support.

use crate::method::{Tolerance, Work};
use crate::system::{Coeffs, SecondOrderSystem, Singular, State, StateView};

/// Tolerance and iteration limit of the static solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquilibriumOptions {
    /// Largest last correction, as a fraction of [`SecondOrderSystem::scales`].
    pub tolerance: f64,
    /// Largest number of Newton iterations.
    pub max_iterations: u32,
}

impl Default for EquilibriumOptions {
    fn default() -> Self {
        EquilibriumOptions {
            tolerance: 1e-9,
            max_iterations: 60,
        }
    }
}

/// Reason why the static solve failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EquilibriumError {
    /// Newton's method did not converge.
    #[error(
        "no equilibrium at t = {t:.6e} s: scaled correction {residual:.3e} after {iterations} Newton iterations; start nearer to it, or load in smaller parts"
    )]
    NewtonDiverged {
        /// Time of the equilibrium [s].
        t: f64,
        /// Last correction, relative to the scales of the system.
        residual: f64,
        /// Number of Newton iterations.
        iterations: u32,
    },
    /// A body is supported neither by its mount nor by a closed contact.
    #[error(
        "nothing holds the bodies at t = {t:.6e} s: fix or drive a gear, or start with the loaded flanks in contact"
    )]
    SingularTangent {
        /// Time of the equilibrium [s].
        t: f64,
    },
    /// A force or a coordinate became infinite or not a number.
    #[error("coordinate {dof} is not finite at t = {t:.6e} s: the static solve blew up")]
    NonFinite {
        /// Time of the equilibrium [s].
        t: f64,
        /// Index of the coordinate.
        dof: usize,
    },
}

/// Shift of a body supported by contact alone, relative to the Rayleigh quotient of its motion.
const SHIFT: f64 = 1e-6;
/// Number of iterations under a shift during which the correction may fail to decrease. After that the shift is
/// reduced by this factor, at most `RELAXATIONS` times.
const PATIENCE: u32 = 4;
const RELAXATIONS: u32 = 3;
const RELAXATION: f64 = 1e-3;
/// A line search starts when the work of the residual decreases by less than this factor.
const SLACK: f64 = 0.8;
/// Largest number of force evaluations of one line search.
const LINE_SEARCH: u32 = 24;
/// Multiple of the tolerance up to which a correction that no longer decreases counts as converged, because of
/// rounding.
const STALLED: f64 = 1e3;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn force(
    sys: &mut dyn SecondOrderSystem,
    s: &State,
    q: &[f64],
    f: &mut [f64],
    work: &mut Work,
) -> Result<(), EquilibriumError> {
    let at = StateView {
        t: s.t,
        q,
        v: &s.v,
        discrete: &s.discrete,
    };
    sys.force(at, f);
    work.force_evaluations += 1;
    match f.iter().position(|x| !x.is_finite()) {
        Some(dof) => Err(EquilibriumError::NonFinite { t: s.t, dof }),
        None => Ok(()),
    }
}

/// Returns the shift for a system whose matrix is [`Singular`]: a fraction of `d K d / d M d` with `d = M^-1 f`.
pub(crate) fn shift(
    sys: &mut dyn SecondOrderSystem,
    s: &State,
    f: &[f64],
) -> Result<f64, Singular> {
    let mut d = f.to_vec();
    sys.solve_mass(s.at(), &mut d);
    let inertia = dot(&d, f);
    let mut df = vec![0.0; d.len()];
    sys.tangent_times(s.at(), &d, &s.v, &mut df);
    let quotient = -dot(&d, &df) / inertia;
    // A motion that meets no stiffness at all starts from rounding, not from a contact.
    if quotient.is_finite() && quotient > 0.0 {
        Ok(SHIFT * quotient)
    } else {
        Err(Singular)
    }
}

/// Moves the coordinates of `s` to static equilibrium at its time and sets the velocities to zero.
///
/// The search starts at `s.q`. If only a contact supports a gear, that contact has to be closed there. Prescribed
/// mounts keep their position at `s.t`. The discrete state of `s` is prepared for clipped contacts.
///
/// The search starts at `s.q`: where only a contact holds a gear, that contact has to be closed there. Prescribed
/// mounts stand where they are at `s.t`. The discrete state of `s` is prepared for clipped contacts.
///
/// # Errors
/// [`EquilibriumError`]; `s.q` is then the last iterate.
pub fn equilibrium(
    sys: &mut dyn SecondOrderSystem,
    s: &mut State,
    options: &EquilibriumOptions,
) -> Result<Work, EquilibriumError> {
    let n = sys.layout().n;
    let mut work = Work::default();
    s.v.fill(0.0);
    sys.begin(s, false);
    let scales = Tolerance::of(sys, options.tolerance).q;
    let mut f = vec![0.0; n];
    let (mut dx, mut trial, mut f_trial) = (f.clone(), f.clone(), f.clone());
    let mut mass = 0.0;
    let (mut previous, mut idle, mut relaxations) = (f64::INFINITY, 0, 0);
    force(sys, s, &s.q, &mut f, &mut work)?;
    for _ in 0..options.max_iterations {
        if f.iter().all(|x| *x == 0.0) {
            return Ok(work);
        }
        loop {
            dx.copy_from_slice(&f);
            let c = Coeffs {
                m: mass,
                d: 0.0,
                k: 1.0,
            };
            match work.correct(sys, s.at(), c, &mut dx) {
                Ok(()) => break,
                Err(Singular) if mass == 0.0 => {
                    mass = shift(sys, s, &f)
                        .map_err(|Singular| EquilibriumError::SingularTangent { t: s.t })?;
                }
                Err(Singular) => return Err(EquilibriumError::SingularTangent { t: s.t }),
            }
        }
        work.newton_iterations += 1;
        if let Some(dof) = dx.iter().position(|x| !x.is_finite()) {
            return Err(EquilibriumError::NonFinite { t: s.t, dof });
        }
        // Rounding in large coordinates, such as angles after many turns, bounds what a correction can reach.
        let size = dx
            .iter()
            .zip(&scales)
            .zip(&s.q)
            .map(|((d, scale), q)| (d.abs() - 4.0 * f64::EPSILON * q.abs()).max(0.0) / scale)
            .fold(0.0, f64::max);
        line_search(sys, s, &dx, &mut f, (&mut trial, &mut f_trial), &mut work)?;
        let stalled = size > 0.5 * previous && size <= STALLED * options.tolerance;
        if size <= options.tolerance || stalled {
            return Ok(work);
        }
        idle = if size > 0.5 * previous { idle + 1 } else { 0 };
        if mass > 0.0 && idle > PATIENCE {
            if relaxations == RELAXATIONS {
                return Err(EquilibriumError::SingularTangent { t: s.t });
            }
            relaxations += 1;
            mass *= RELAXATION;
            idle = 0;
        }
        previous = size;
    }
    if mass > 0.0 {
        return Err(EquilibriumError::SingularTangent { t: s.t });
    }
    Err(EquilibriumError::NewtonDiverged {
        t: s.t,
        residual: previous,
        iterations: options.max_iterations,
    })
}

/// Moves `s.q` along `dx` and stores the residual of the new position in `f`.
fn line_search(
    sys: &mut dyn SecondOrderSystem,
    s: &mut State,
    dx: &[f64],
    f: &mut Vec<f64>,
    (trial, f_trial): (&mut Vec<f64>, &mut Vec<f64>),
    work: &mut Work,
) -> Result<(), EquilibriumError> {
    let start = dot(dx, f);
    // Ends of the bracket: the work of the residual is positive at `low` and negative at `high`.
    let (mut low, mut high) = ((0.0, start), (1.0, 0.0));
    let mut alpha = 1.0;
    for k in 0..LINE_SEARCH {
        for i in 0..dx.len() {
            trial[i] = s.q[i] + alpha * dx[i];
        }
        force(sys, s, trial, f_trial, work)?;
        let slope = dot(dx, f_trial);
        // Beyond a softening (a contact that opens) the residual keeps its sign: the full step stands.
        if slope.abs() <= SLACK * start.abs() || start <= 0.0 || (k == 0 && slope > 0.0) {
            break;
        }
        if slope < 0.0 {
            high = (alpha, slope);
        } else {
            low = (alpha, slope);
        }
        // Regula falsi, kept off the ends so that a kink cannot hold it there.
        let width = high.0 - low.0;
        let zero = low.0 + width * low.1 / (low.1 - high.1);
        alpha = zero.clamp(low.0 + 0.05 * width, high.0 - 0.05 * width);
    }
    std::mem::swap(&mut s.q, trial);
    std::mem::swap(f, f_trial);
    Ok(())
}
