//! Convergence control of Newton's method for the forces of points with dashpots.

use super::spring::Spring;

/// Number of iterations after which steps that do not reduce the residual are halved.
const PATIENCE: usize = 8;
/// Smallest fraction of a Newton step.
const SHORTEST: f64 = 1e-3;

/// State of one Newton iteration.
#[derive(Clone, Debug, Default)]
pub(super) struct Descent {
    iteration: usize,
    /// True if normal laws are piecewise linear.
    linear: bool,
    /// Slopes of the laws of the points at the start of the step.
    pieces: Vec<[f64; 3]>,
    /// Largest norm of the residual, and its norm before the step.
    first: f64,
    before: f64,
    /// True for a full step. A shortened step ends on the piece where it began without solving it.
    whole: bool,
}

fn slopes(s: &Spring) -> [f64; 3] {
    [s.force.dn_dg, s.force.dn_dgdot, s.seen_by.rate]
}

impl Descent {
    /// Starts an iteration; `linear` is true if laws are piecewise linear and there is no friction.
    pub fn begin(&mut self, linear: bool) {
        self.iteration = 0;
        self.linear = linear;
        self.pieces.clear();
        self.first = 0.0;
        self.before = f64::INFINITY;
        self.whole = true;
    }

    /// Returns true if the iteration has converged, from the norms of the residual and of the forces; otherwise starts
    /// a step.
    pub fn ends(&mut self, norm: f64, forces: f64, springs: &[Spring]) -> bool {
        let pieces = self.pieces.iter().zip(springs);
        let same = self.iteration > 0 && { pieces }.all(|(p, s)| *p == slopes(s));
        self.first = self.first.max(norm);
        // The residual is relative to the first residual and to the forces, which determine its rounding error.
        let scale = self.first.max(forces);
        if norm == 0.0 || (same && self.whole && self.linear) || norm <= 1e-14 * scale {
            return true;
        }
        // Rounding ends the descent of laws that are not linear.
        if norm <= 1e-10 * scale && norm >= 0.5 * self.before {
            return true;
        }
        self.before = norm;
        self.pieces.clear();
        self.pieces.extend(springs.iter().map(slopes));
        self.iteration += 1;
        self.whole = true;
        false
    }

    /// Returns true if a step of this length, after which the residual has the given norm, has to be halved.
    pub fn halves(&mut self, length: f64, norm: f64) -> bool {
        self.whole = length == 1.0;
        self.iteration > PATIENCE + 1 && norm > self.before && length > SHORTEST
    }
}

/// Returns the Euclidean norm.
pub(super) fn norm_of(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}
