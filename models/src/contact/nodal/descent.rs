//! When Newton's method on the forces of points with dashpots ends.

use super::spring::Spring;

/// Iterations after which steps that do not lessen the residual are halved.
const PATIENCE: usize = 8;
/// Shortest part of a step.
const SHORTEST: f64 = 1e-3;

/// The course of an iteration.
#[derive(Clone, Debug, Default)]
pub(super) struct Descent {
    iteration: usize,
    /// Normal laws are linear piece by piece.
    linear: bool,
    /// Slopes of the points where the step began.
    pieces: Vec<(f64, f64)>,
    /// Largest norm of what was lacking, and the norm before the step.
    first: f64,
    before: f64,
    /// A step that was cut short ends on the piece where it began without being at its solution.
    whole: bool,
}

fn slopes(s: &Spring) -> (f64, f64) {
    (s.force.dn_dg, s.force.dn_dgdot)
}

impl Descent {
    /// Begins; `linear`: laws are linear piece by piece and nothing rubs.
    pub fn begin(&mut self, linear: bool) {
        self.iteration = 0;
        self.linear = linear;
        self.pieces.clear();
        self.first = 0.0;
        self.before = f64::INFINITY;
        self.whole = true;
    }

    /// Whether the forces, of this norm, are found, where what they lack has the given norm; else a step begins.
    pub fn ends(&mut self, norm: f64, forces: f64, springs: &[Spring]) -> bool {
        let pieces = self.pieces.iter().zip(springs);
        let same = self.iteration > 0 && { pieces }.all(|(p, s)| *p == slopes(s));
        self.first = self.first.max(norm);
        // What is left counts beside what was lacking and beside the forces, whose rounding it is.
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

    /// Whether a step of this length is to be halved, after which what is lacking has the given norm.
    pub fn halves(&mut self, length: f64, norm: f64) -> bool {
        self.whole = length == 1.0;
        self.iteration > PATIENCE + 1 && norm > self.before && length > SHORTEST
    }
}

/// Euclidean norm.
pub(super) fn norm_of(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}
