//! Dashpots and friction at points, in one solve with the residual compliance and, at the end of an impulse, with the
//! velocities.
//!
//! The normal force of a point follows from its law at its gap and the rate of the gap, its friction from the sliding
//! speed, `N_p = n(g_p, r_p)`, `T_p = t(N_p, s_p)`. All three arguments depend on the forces: the gap by the residual
//! compliance `R`, and, where a method needs the forces at the end of a half impulse of length `tau`, rate and sliding
//! speed by the inverse mass `Y`,
//!
//! ```text
//! g = g0 + w . R F,   r = r* + tau w . Y F,   s = s* + tau z . Y F,   F = sum_p w_p N_p + z_p T_p
//! ```
//!
//! over *ports*: the nodes of the gears, outwards (`w`) and along the profile (`z`), and behind them the hubs that are free
//! to move, whose weights are the effective radii. `r*` and `s*` are the rates before the contact acts.
//!
//! **Rates follow quasi-statically.** As a gap closes, the nodes on residual compliance are displaced, and the dashpot
//! receives the rest of the rate, the compression of the point itself. With the stiffness `K` of the points,
//!
//! ```text
//! r = D b,    D = (I + W^T R W K)^-1,    b = r* + tau W^T Y F
//! ```
//!
//! with the rates `b` before residual compliance. Linearly `F = (I + K W^T R W)^-1 (K g0 + c D b)` dissipates `b . D^T
//! c D b`, which is never negative. Nodes with masses dissipate the same as far as they are slow compared with `c/K`.
//! (With `b` in place of `r` an impact loses twice as much as that of finite elements.) Sliding speeds have no such
//! correction.
//!
//! **Retardation.** Where bodies are damped in proportion to their stiffness, residual compliance and point are one
//! Kelvin-Voigt element: the law sees the gap `g + beta b`, besides the rate of its own dashpot
//! ([`retarded`](crate::law::retarded)).
//!
//! The impulses on both sides of an instant are then the implicit midpoint rule for the dashpots, `v+ - v- = h M^-1
//! B^T N((v+ + v-)/2)`, and for friction likewise: of second order, and stable whatever `c h / m`, so that sticking
//! friction does not chatter however steep its regularisation is (E. Hairer, Ch. Lubich, G. Wanner, *Geometric
//! Numerical Integration*, 2006, ch. II.1; for dampers in position-explicit methods T. J. R. Hughes, *The Finite
//! Element Method*, 1987, sec. 9.1.2).
//!
//! Newton's method on `F`, with the slopes `k = -dn/dg`, `c = -dn/dr`, `f = dt/dN`, `d = -dt/ds` of the points at hand:
//!
//! ```text
//! (I + sum_p (w_p + f_p z_p) (k_p (R w_p) + c_p tau (Y w_p))^T + d_p z_p (tau Y z_p)^T) dF = sum_p w_p N_p + z_p T_p - F
//! ```
//!
//! Normal laws are linear piece by piece: without friction the iteration ends when no point changes its piece.

use super::compliance::Block;
use super::descent::{Descent, norm_of};
use super::spring::Spring;
use gearbench_integrators::dense_solve::{Lu, solve_in_place};
use gearbench_integrators::system::Singular;

/// Largest number of Newton iterations.
const MOST_ITERATIONS: usize = 100;

/// Direction of a point over the ports of both gears: four nodes and one hub each.
#[derive(Clone, Copy, Debug, Default)]
pub struct PortDirection {
    /// Indices of the ports; entries without weight are arbitrary.
    pub ports: [u32; 10],
    /// Weights of the ports: those of nodes as in the gap, those of hubs the negative effective radius.
    pub weights: [f64; 10],
}

/// A point with its directions over the ports.
#[derive(Clone, Copy, Debug, Default)]
pub struct PortPoint {
    /// Direction along the normal.
    pub normal: PortDirection,
    /// Direction along the profile, without weights if there is no friction.
    pub sliding: PortDirection,
}

/// Compliance and mobility of the ports under forces on them.
#[derive(Clone, Debug, Default)]
pub struct Ports {
    /// Number of ports.
    pub n: usize,
    /// Ranges of the ports of each gear.
    pub blocks: Vec<Block>,
    /// Blocks of `R`, one `len x len` matrix after the other [m/N].
    pub compliance: Vec<f64>,
    /// Blocks of `tau Y` [m/s/N]; empty where rates do not depend on the forces.
    pub mobility: Vec<f64>,
    /// Matrix `T`, one row of all ports for each node, where nodes follow quasi-statically: when ports move inwards by
    /// `y`, the gap of a point closes by `w . (y - T y)`. Empty otherwise.
    pub following: Vec<f64>,
    /// Port index of each of those nodes.
    pub of_nodes: Vec<u32>,
    /// Full rows of `(I - T) tau Y`; empty where no nodes follow or rates do not depend on the forces.
    answer: Vec<f64>,
}

impl Ports {
    /// Computes the matrix of the rate response from mobility and following nodes.
    fn combine(&mut self) {
        self.answer.clear();
        if self.mobility.is_empty() || self.following.is_empty() {
            return;
        }
        let n = self.n;
        self.answer.resize(n * n, 0.0);
        let mut begin = 0;
        for b in &self.blocks {
            for i in 0..b.len {
                let row = &self.mobility[begin..][..b.len];
                begin += b.len;
                let port = b.start + i;
                let own = &mut self.answer[port * n + b.start..][..b.len];
                for (x, y) in own.iter_mut().zip(row) {
                    *x += y;
                }
                let lines = self.following.chunks_exact(n);
                for (&node, line) in self.of_nodes.iter().zip(lines) {
                    let t = line[port];
                    if t == 0.0 {
                        continue;
                    }
                    let out = &mut self.answer[node as usize * n + b.start..][..b.len];
                    for (x, y) in out.iter_mut().zip(row) {
                        *x -= t * y;
                    }
                }
            }
        }
    }
}

/// Solve for normal forces with dashpots and for friction, with its buffers.
#[derive(Clone, Debug, Default)]
pub struct DissipativeSolve {
    /// Ports, to be set before a solve.
    pub ports: Ports,
    /// Directions of the points over the ports, in the order of the springs.
    pub points: Vec<PortPoint>,
    force: Vec<f64>,
    gaps: Vec<f64>,
    rates: Vec<f64>,
    slips: Vec<f64>,
    matrix: Vec<f64>,
    step: Vec<f64>,
    line: Vec<f64>,
    touched: Vec<(usize, usize)>,
    descent: Descent,
    factor: Lu,
}

/// Multiplies block by block: `y = A x`.
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

impl PortDirection {
    fn along(&self, y: &[f64]) -> f64 {
        let ports = self.ports.iter().zip(&self.weights);
        ports.map(|(&i, w)| w * y[i as usize]).sum()
    }

    /// Adds the multiple `x w` of the direction to `y`.
    fn add(&self, x: f64, y: &mut [f64]) {
        for (&i, w) in self.ports.iter().zip(&self.weights) {
            y[i as usize] += x * w;
        }
    }
}

impl DissipativeSolve {
    /// Solves for the forces of the springs at gap and rates; `gap0`, `rate` and `slip` of the springs are values
    /// without contact. The gaps are stored in the springs. The iteration starts from the forces of the springs.
    ///
    /// # Errors
    /// [`Singular`] where numbers are not finite or the iteration does not end.
    pub fn solve(&mut self, springs: &mut [Spring]) -> Result<(), Singular> {
        self.ports.combine();
        self.force.clear();
        self.force.resize(self.ports.n, 0.0);
        for (s, p) in springs.iter().zip(&self.points) {
            p.normal.add(s.force.n, &mut self.force);
        }
        let linear = (springs.iter()).all(|s| s.law.is_piecewise_linear() && s.friction.is_none());
        self.descent.begin(linear);
        let mut norm = self.residual(springs);
        for _ in 0..MOST_ITERATIONS {
            if !norm.is_finite() {
                return Err(Singular);
            }
            if self.descent.ends(norm, norm_of(&self.force), springs) {
                return Ok(());
            }
            self.step.clear();
            self.step.extend_from_slice(&self.line);
            self.linearise(springs);
            solve_in_place(&mut self.matrix, &mut self.step)?;
            let mut length = 1.0;
            for (f, d) in self.force.iter_mut().zip(&self.step) {
                *f += d;
            }
            norm = self.residual(springs);
            while self.descent.halves(length, norm) {
                length *= 0.5;
                for (f, d) in self.force.iter_mut().zip(&self.step) {
                    *f -= length * d;
                }
                norm = self.residual(springs);
            }
        }
        Err(Singular)
    }

    /// Returns the residual displacements `u = -R F` of all ports, with the ports.
    pub fn displacements(&mut self) -> (&Ports, &[f64]) {
        let Ports {
            blocks, compliance, ..
        } = &self.ports;
        apply(blocks, compliance, &self.force, &mut self.gaps);
        self.gaps.iter_mut().for_each(|u| *u = -*u);
        (&self.ports, &self.gaps)
    }

    /// Computes gaps and forces of the points under the forces on the ports; returns the norm of the residual, in
    /// units of displacement.
    fn residual(&mut self, springs: &mut [Spring]) -> f64 {
        let p = &self.ports;
        apply(&p.blocks, &p.compliance, &self.force, &mut self.gaps);
        apply(&p.blocks, &p.mobility, &self.force, &mut self.slips);
        self.rates.clear();
        if p.answer.is_empty() {
            self.rates.extend_from_slice(&self.slips);
        } else {
            let of_port =
                |row: &[f64]| -> f64 { row.iter().zip(&self.force).map(|(a, f)| a * f).sum() };
            self.rates.extend(p.answer.chunks_exact(p.n).map(of_port));
        }
        self.line.clear();
        self.line.extend(self.force.iter().map(|f| -f));
        for (s, p) in springs.iter_mut().zip(&self.points) {
            let rate = s.rate + p.normal.along(&self.rates);
            let before = s.rate_before + p.normal.along(&self.slips);
            s.press(s.gap0 + p.normal.along(&self.gaps), rate, before);
            p.normal.add(s.force.n, &mut self.line);
            if let Some(friction) = &s.friction {
                let slip = s.slip + p.sliding.along(&self.slips);
                s.friction_force = friction.force(s.force.n, slip);
                p.sliding.add(s.friction_force.f, &mut self.line);
            }
        }
        norm_of(&self.line)
    }

    /// Assembles the matrix of the present linear pieces.
    fn linearise(&mut self, springs: &[Spring]) {
        let n = self.ports.n;
        self.matrix.clear();
        self.matrix.resize(n * n, 0.0);
        for i in 0..n {
            self.matrix[i * n + i] = 1.0;
        }
        for (i, s) in springs.iter().enumerate() {
            let PortPoint { normal, sliding } = self.points[i];
            let slopes = [-s.force.dn_dg, -s.force.dn_dgdot];
            if slopes != [0.0; 2] {
                let retarded = s.retarded_damping();
                if slopes[1] == 0.0 || self.ports.answer.is_empty() {
                    self.respond(&normal, [slopes[0], slopes[1] + retarded]);
                } else {
                    self.respond(&normal, [slopes[0], retarded]);
                    self.follow(&normal, slopes[1]);
                }
                self.add_outer(&normal, 1.0);
                if s.friction_force.df_dn != 0.0 {
                    self.add_outer(&sliding, s.friction_force.df_dn);
                }
            }
            if s.friction_force.df_dv != 0.0 && !self.ports.mobility.is_empty() {
                self.respond(&sliding, [0.0, -s.friction_force.df_dv]);
                self.add_outer(&sliding, 1.0);
            }
        }
    }

    /// Computes `line = k R w + c tau Y w` in the blocks that `touched` lists; both matrices are symmetric.
    fn respond(&mut self, of: &PortDirection, [k, c]: [f64; 2]) {
        let p = &self.ports;
        self.line.clear();
        self.line.resize(p.n, 0.0);
        self.touched.clear();
        let mut begin = 0;
        for b in &p.blocks {
            let mut touched = false;
            for (&i, &w) in of.ports.iter().zip(&of.weights) {
                let local = (i as usize).checked_sub(b.start).filter(|l| *l < b.len);
                let Some(local) = local.filter(|_| w != 0.0) else {
                    continue;
                };
                touched = true;
                let at = begin + local * b.len;
                let line = &mut self.line[b.start..][..b.len];
                let mut add = |row: &[f64], factor: f64| {
                    for (x, a) in line.iter_mut().zip(row) {
                        *x += factor * a;
                    }
                };
                if k != 0.0 {
                    add(&p.compliance[at..][..b.len], k * w);
                }
                if c != 0.0 && !p.mobility.is_empty() {
                    add(&p.mobility[at..][..b.len], c * w);
                }
            }
            begin += b.len * b.len;
            if touched {
                self.touched.push((b.start, b.len));
            }
        }
    }

    /// Adds `c (w . (I - T) tau Y)` over all ports to `line`.
    fn follow(&mut self, of: &PortDirection, c: f64) {
        let p = &self.ports;
        for (&i, &w) in of.ports.iter().zip(&of.weights) {
            if w != 0.0 {
                let row = &p.answer[i as usize * p.n..][..p.n];
                for (x, a) in self.line.iter_mut().zip(row) {
                    *x += c * w * a;
                }
            }
        }
        self.touched.clear();
        self.touched.push((0, p.n));
    }

    /// Adds the outer product `factor w line^T` to the matrix.
    fn add_outer(&mut self, of: &PortDirection, factor: f64) {
        for (&i, &w) in of.ports.iter().zip(&of.weights) {
            if w == 0.0 {
                continue;
            }
            for &(start, len) in &self.touched {
                let row = &mut self.matrix[i as usize * self.ports.n + start..][..len];
                for (x, a) in row.iter_mut().zip(&self.line[start..][..len]) {
                    *x += factor * w * a;
                }
            }
        }
    }

    /// Factorises for [`Self::tangent`] at the forces of the springs, without impulse.
    ///
    /// # Errors
    /// [`Singular`].
    pub fn factorise(&mut self, springs: &[Spring]) -> Result<(), Singular> {
        let mobility = std::mem::take(&mut self.ports.mobility);
        let answer = std::mem::take(&mut self.ports.answer);
        self.linearise(springs);
        (self.ports.mobility, self.ports.answer) = (mobility, answer);
        self.factor.set(&mut self.matrix, self.ports.n)
    }

    /// Converts changes of the forces of each point, at fixed neighbours, to the changes with all couplings, in place.
    /// `changes` has the normal force and the friction of each point. Friction changes with the normal force in any
    /// case.
    pub fn tangent(&mut self, springs: &[Spring], changes: &mut [[f64; 2]]) {
        self.step.clear();
        self.step.resize(self.ports.n, 0.0);
        for ((s, p), [n, t]) in springs.iter().zip(&self.points).zip(&*changes) {
            p.normal.add(*n, &mut self.step);
            p.sliding
                .add(*t + s.friction_force.df_dn * n, &mut self.step);
        }
        self.factor.solve(&mut self.step);
        let Ports {
            blocks, compliance, ..
        } = &self.ports;
        apply(blocks, compliance, &self.step, &mut self.gaps);
        for ((s, p), [n, t]) in springs.iter().zip(&self.points).zip(changes) {
            *n += s.force.dn_dg * p.normal.along(&self.gaps);
            *t += s.friction_force.df_dn * *n;
        }
    }
}

#[cfg(test)]
mod tests;
