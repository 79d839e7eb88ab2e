//! Dashpots at points, in one solve with the residual compliance and, at the end of a kick, with the velocities.
//!
//! A point pushes with its law at its gap and the rate of the gap, `N_p = n(g_p, r_p)`. Both answer to the forces: the
//! gap by the residual compliance `R`, and, where a method asks for the forces at the end of a half kick of length
//! `tau`, the rate by the inverse mass `Y`,
//!
//! ```text
//! g = g0 + w . R F,    r = r* + tau w . Y F,    F = sum_p w_p N_p
//! ```
//!
//! over *ports*: the nodes of the gears, and behind them the hubs that are free to move, whose weights are the effective
//! radii. `r*` is the rate before the contact acts. The kicks at both sides of an instant then make the implicit midpoint
//! rule for the dashpots, `v+ - v- = h M^-1 B^T N((v+ + v-)/2)`: of second order, and stable whatever `c h / m` (E.
//! Hairer, Ch. Lubich, G. Wanner, *Geometric Numerical Integration*, 2006, ch. II.1; for dampers in
//! position-explicit methods T. J. R. Hughes, *The Finite Element Method*, 1987, sec. 9.1.2).
//!
//! Newton's method on `F`, with the slopes `k = -dn/dg` and `c = -dn/dr` of the points at hand:
//!
//! ```text
//! (I + sum_p w_p (k_p (R w_p) + c_p tau (Y w_p))^T) dF = sum_p w_p N_p - F
//! ```
//!
//! The laws are linear piece by piece, so that the iteration ends when no point changes its piece.

use super::compliance::Block;
use super::spring::Spring;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::Singular;

/// Newton iterations before the solve is given up.
const MOST_ITERATIONS: usize = 100;
/// Iterations after which steps that do not lessen the residual are halved.
const PATIENCE: usize = 8;

/// A point over the ports of both gears: four nodes and a hub each.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ported {
    /// Ports; those without weight are any.
    pub ports: [u32; 10],
    /// Their weights: of nodes as in the gap, of hubs the effective radius, less.
    pub weights: [f64; 10],
}

/// What ports do under forces on them.
#[derive(Clone, Debug, Default)]
pub struct Ports {
    /// Number of ports.
    pub n: usize,
    /// Gear by gear.
    pub blocks: Vec<Block>,
    /// `R` of the blocks, one `len x len` matrix after the other [m/N].
    pub compliance: Vec<f64>,
    /// `tau Y` alike [m/s/N]; empty where rates do not answer.
    pub mobility: Vec<f64>,
}

/// The solve and its buffers.
#[derive(Clone, Debug, Default)]
pub struct DashpotSolve {
    /// The ports; to be set before a solve.
    pub ports: Ports,
    /// The points over them, in the order of the springs.
    pub points: Vec<Ported>,
    force: Vec<f64>,
    gaps: Vec<f64>,
    rates: Vec<f64>,
    matrix: Vec<f64>,
    step: Vec<f64>,
    line: Vec<f64>,
    pieces: Vec<(f64, f64)>,
}

/// `y = A x` block by block.
fn apply(blocks: &[Block], matrix: &[f64], x: &[f64], y: &mut Vec<f64>) {
    y.clear();
    y.resize(x.len(), 0.0);
    if matrix.is_empty() {
        return;
    }
    let mut begin = 0;
    for b in blocks {
        let x = &x[b.start..][..b.len];
        for (i, y) in y[b.start..][..b.len].iter_mut().enumerate() {
            let row = &matrix[begin + i * b.len..][..b.len];
            *y = row.iter().zip(x).map(|(a, x)| a * x).sum();
        }
        begin += b.len * b.len;
    }
}

impl Ported {
    fn along(&self, y: &[f64]) -> f64 {
        let ports = self.ports.iter().zip(&self.weights);
        ports.map(|(&i, w)| w * y[i as usize]).sum()
    }
}

impl DashpotSolve {
    /// Forces of the springs by their laws at gap and rate; `gap0` and `rate` of the springs are those without contact.
    /// Leaves the gaps in them. Begins with the forces that the springs have.
    ///
    /// # Errors
    /// [`Singular`] where numbers are not finite or the iteration does not end.
    pub fn solve(&mut self, springs: &mut [Spring]) -> Result<(), Singular> {
        let n = self.ports.n;
        self.force.clear();
        self.force.resize(n, 0.0);
        for (s, p) in springs.iter().zip(&self.points) {
            for (&i, w) in p.ports.iter().zip(&p.weights) {
                self.force[i as usize] += w * s.force.n;
            }
        }
        let linear = springs.iter().all(|s| s.law.is_piecewise_linear());
        let mut norm = self.residual(springs);
        // What dashpots add may be far below the rounding of the elastic forces: where gears hardly vibrate, the first
        // residual is no measure of what can be reached.
        let size = self.force.iter().map(|f| f * f).sum::<f64>().sqrt();
        let (mut scale, mut before) = (norm.max(size), f64::INFINITY);
        self.pieces.clear();
        for iteration in 0..MOST_ITERATIONS {
            if !norm.is_finite() {
                return Err(Singular);
            }
            let same = iteration > 0
                && (self.pieces.iter().zip(&*springs))
                    .all(|(p, s)| *p == (s.force.dn_dg, s.force.dn_dgdot));
            scale = scale.max(norm);
            if norm == 0.0 || (same && linear) || norm <= 1e-14 * scale {
                return Ok(());
            }
            // Rounding ends the descent of laws that are not linear.
            if norm <= 1e-10 * scale && norm >= 0.5 * before {
                return Ok(());
            }
            before = norm;
            self.linearise(springs);
            solve_in_place(&mut self.matrix, &mut self.step)?;
            let mut length = 1.0;
            for (f, d) in self.force.iter_mut().zip(&self.step) {
                *f += d;
            }
            let step = std::mem::take(&mut self.step);
            norm = self.residual(springs);
            while iteration > PATIENCE && norm > before && length > 1e-3 {
                length *= 0.5;
                for (f, d) in self.force.iter_mut().zip(&step) {
                    *f -= length * d;
                }
                norm = self.residual(springs);
            }
            self.step = step;
        }
        Err(Singular)
    }

    /// Residual displacements `u = -R F` of all ports.
    pub fn displacements(&mut self) -> &[f64] {
        let Ports {
            blocks, compliance, ..
        } = &self.ports;
        apply(blocks, compliance, &self.force, &mut self.gaps);
        self.gaps.iter_mut().for_each(|u| *u = -*u);
        &self.gaps
    }

    /// Gaps and forces of the points under the forces on the ports; returns the norm of what these lack, in units of
    /// displacement.
    fn residual(&mut self, springs: &mut [Spring]) -> f64 {
        let p = &self.ports;
        apply(&p.blocks, &p.compliance, &self.force, &mut self.gaps);
        apply(&p.blocks, &p.mobility, &self.force, &mut self.rates);
        self.line.clear();
        self.line.extend(self.force.iter().map(|f| -f));
        for (s, p) in springs.iter_mut().zip(&self.points) {
            s.gap = s.gap0 + p.along(&self.gaps);
            let rate = s.rate + p.along(&self.rates);
            s.force = s.law.at_point(s.gap, rate, s.stiffness);
            for (&i, w) in p.ports.iter().zip(&p.weights) {
                self.line[i as usize] += w * s.force.n;
            }
        }
        self.line.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// The matrix of the present pieces, and the right side in `step`.
    fn linearise(&mut self, springs: &[Spring]) {
        let n = self.ports.n;
        self.step.clear();
        self.step.extend_from_slice(&self.line);
        self.pieces.clear();
        self.pieces
            .extend(springs.iter().map(|s| (s.force.dn_dg, s.force.dn_dgdot)));
        self.matrix.clear();
        self.matrix.resize(n * n, 0.0);
        for i in 0..n {
            self.matrix[i * n + i] = 1.0;
        }
        let p = &self.ports;
        for (s, point) in springs.iter().zip(&self.points) {
            let slopes = (-s.force.dn_dg, -s.force.dn_dgdot);
            if slopes == (0.0, 0.0) {
                continue;
            }
            // k R w + c tau Y w, block by block: both matrices are symmetric.
            let mut begin = 0;
            for b in &p.blocks {
                self.line.clear();
                self.line.resize(b.len, 0.0);
                let mut touched = false;
                for (&i, &w) in point.ports.iter().zip(&point.weights) {
                    let Some(local) = (i as usize).checked_sub(b.start).filter(|l| *l < b.len)
                    else {
                        continue;
                    };
                    if w == 0.0 {
                        continue;
                    }
                    touched = true;
                    let at = begin + local * b.len;
                    let add = |line: &mut [f64], row: &[f64], factor: f64| {
                        for (x, a) in line.iter_mut().zip(row) {
                            *x += factor * a;
                        }
                    };
                    add(&mut self.line, &p.compliance[at..][..b.len], slopes.0 * w);
                    if slopes.1 != 0.0 && !p.mobility.is_empty() {
                        add(&mut self.line, &p.mobility[at..][..b.len], slopes.1 * w);
                    }
                }
                begin += b.len * b.len;
                if !touched {
                    continue;
                }
                for (&i, &w) in point.ports.iter().zip(&point.weights) {
                    if w != 0.0 {
                        let row = &mut self.matrix[i as usize * n + b.start..][..b.len];
                        for (x, a) in row.iter_mut().zip(&self.line) {
                            *x += w * a;
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
