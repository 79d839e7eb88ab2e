//! Inertia integrals of the floating frame, and the terms they bring a gear that turns about z.
//!
//! With the frame at angle `theta`, undeformed places `X` and shapes `phi_i` in it, the velocity of a particle is
//! `theta' z x (X + phi q) + phi q'`, and twice the kinetic energy
//!
//! ```text
//! theta'^2 (J + 2 a.q + q.G q) + 2 theta' (p.q' + q.C q') + q'.q'
//! a_i = int X_xy.phi_i dm,  G_ij = int phi_i,xy.phi_j,xy dm,  C_ij = int (z x phi_i).phi_j dm,  p_i = int (z x X).phi_i dm
//! ```
//!
//! (A. A. Shabana, *Dynamics of Multibody Systems*, ch. 5; O. Wallrapp, *Mech. Struct. Mach.* 22 (1994) 327). `C` is
//! skew; `p` is zero where the hub is free, by the choice of the frame. Lagrange's equations are
//!
//! ```text
//! q'' + theta'' (p - C q) + Omega^2 q = theta'^2 (a + G q) + 2 theta' C q' + ...
//! (J + 2 a.q + q.G q) theta'' + (p - C q).q'' = T - 2 theta' (a + G q).q'
//! ```
//!
//! with the centrifugal load `a`, its softening `G`, the Coriolis force `C`. Measured against `Omega^2 q` they are of
//! the order `theta' / omega_1` and its square: [`AUTO_LIMIT`] is where they enter by themselves. What is left out
//! beyond that is the stiffening by the tension of the centrifugal load, of the order of a strain.

use serde::{Deserialize, Serialize};

/// Inertia integrals of a body with its modes in the gear frame, without the inertia added at the hub.
///
/// The blocks of the mass matrix at rest are `M_tt = mass`, `M_tr` from `mass centre`, `M_rr = tensor`,
/// `M_te = translation`, `M_re = rotation`, `M_ee = 1`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Integrals {
    /// Mass of the body [kg].
    pub mass: f64,
    /// Centre of mass [m].
    pub centre: [f64; 3],
    /// Tensor of inertia about the origin, `int (|X|^2 1 - X X^T) dm`, row-major [kg m^2].
    pub tensor: [f64; 9],
    /// Integral `int phi_i dm`, three per mode [sqrt(kg)].
    pub translation: Vec<f64>,
    /// Integral `int X x phi_i dm`, three per mode [sqrt(kg) m].
    pub rotation: Vec<f64>,
    /// Integral `a_i` of the centrifugal load [sqrt(kg) m].
    pub radial: Vec<f64>,
    /// Matrix `G_ij` of the centrifugal softening, symmetric, row-major [1].
    pub planar: Vec<f64>,
    /// Matrix `C_ij` of the Coriolis force, skew, row-major [1].
    pub gyroscopic: Vec<f64>,
}

impl Integrals {
    /// Returns the number of modes.
    pub fn modes(&self) -> usize {
        self.radial.len()
    }

    /// Returns the integrals of a selection of the modes.
    ///
    /// # Panics
    /// If there is no such mode.
    pub fn of_modes(&self, kept: &[usize]) -> Integrals {
        let n = self.modes();
        let three = |x: &[f64]| {
            kept.iter()
                .flat_map(|&i| x[3 * i..3 * i + 3].to_vec())
                .collect()
        };
        let square = |x: &[f64]| -> Vec<f64> {
            (kept.iter())
                .flat_map(|&i| kept.iter().map(move |&j| x[i * n + j]))
                .collect()
        };
        Integrals {
            mass: self.mass,
            centre: self.centre,
            tensor: self.tensor,
            translation: three(&self.translation),
            rotation: three(&self.rotation),
            radial: kept.iter().map(|&i| self.radial[i]).collect(),
            planar: square(&self.planar),
            gyroscopic: square(&self.gyroscopic),
        }
    }

    /// Returns the integrals of `count` shapes within the span of the modes; `v` has a row of `count` coefficients for
    /// each mode.
    pub fn in_span(&self, v: &[f64], count: usize) -> Integrals {
        let modes = self.modes();
        // `V^T X` of a matrix with a row for each mode.
        let across = |x: &[f64], columns: usize| -> Vec<f64> {
            let mut out = vec![0.0; count * columns];
            for (row, x) in v.chunks_exact(count.max(1)).zip(x.chunks_exact(columns)) {
                for (out, v) in out.chunks_exact_mut(columns).zip(row) {
                    out.iter_mut().zip(x).for_each(|(out, x)| *out += v * x);
                }
            }
            out
        };
        let square = |x: &[f64]| -> Vec<f64> {
            let left = across(x, modes);
            let mut out = vec![0.0; count * count];
            for (out, left) in (out.chunks_exact_mut(count.max(1))).zip(left.chunks_exact(modes)) {
                for (row, l) in v.chunks_exact(count.max(1)).zip(left) {
                    out.iter_mut().zip(row).for_each(|(out, v)| *out += l * v);
                }
            }
            out
        };
        Integrals {
            mass: self.mass,
            centre: self.centre,
            tensor: self.tensor,
            translation: across(&self.translation, 3),
            rotation: across(&self.rotation, 3),
            radial: across(&self.radial, 1),
            planar: square(&self.planar),
            gyroscopic: square(&self.gyroscopic),
        }
    }

    /// Returns true if all lengths match the number of modes and all numbers are finite.
    pub fn fits(&self, modes: usize) -> bool {
        let lengths = [
            (self.translation.len(), 3 * modes),
            (self.rotation.len(), 3 * modes),
            (self.radial.len(), modes),
            (self.planar.len(), modes * modes),
            (self.gyroscopic.len(), modes * modes),
        ];
        let all = [
            &self.translation,
            &self.rotation,
            &self.radial,
            &self.planar,
            &self.gyroscopic,
        ];
        lengths.iter().all(|(found, expected)| found == expected)
            && all.iter().all(|x| x.iter().all(|x| x.is_finite()))
    }

    /// Computes `y = a + G q`.
    pub(super) fn outward(&self, q: &[f64], y: &mut [f64]) {
        product(&self.planar, q, y);
        for (y, a) in y.iter_mut().zip(&self.radial) {
            *y += a;
        }
    }

    /// Computes `y = G q`.
    pub(super) fn softening(&self, q: &[f64], y: &mut [f64]) {
        product(&self.planar, q, y);
    }

    /// Computes `y = C v`.
    pub(super) fn coriolis(&self, v: &[f64], y: &mut [f64]) {
        product(&self.gyroscopic, v, y);
    }
}

/// Computes `y = A x`, with row-major `A`.
fn product(a: &[f64], x: &[f64], y: &mut [f64]) {
    for (y, row) in y.iter_mut().zip(a.chunks_exact(x.len().max(1))) {
        *y = crate::cholesky::dot(row, x);
    }
}

/// Inertia terms of a rotating frame in an elastic gear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SpinTerms {
    /// All terms, if the initial speed of a run (the largest speed of a driven hub) is more than [`AUTO_LIMIT`] of the
    /// lowest frequency.
    #[default]
    Auto,
    /// All terms: coordinates are then no independent oscillators.
    Full,
    /// Only the terms of a rigid body.
    None,
}

/// Ratio of the spin rate to the lowest angular frequency above which [`SpinTerms::Auto`] includes all terms. Below it
/// they change frequencies by less than about this ratio, and expand the flanks by less than its square times the
/// radius.
pub const AUTO_LIMIT: f64 = 0.01;
