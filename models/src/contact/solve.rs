//! Contact solve with local compliance: `g = g0 + C N(g)` for all points that share a compliance.
//!
//! Semismooth Newton on the gaps: `r = g - g0 - C N(g)`, `J = I - C dN/dg`. With `C` positive semidefinite
//! and `dN/dg <= 0` the Jacobian is regular; a linear law converges in as many iterations as the active set
//! changes. Damping laws use the rate of `g0`: with the rate of `g` the law would become a differential
//! equation in `N`.

use crate::law::{Law, LawForce};
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::Singular;

/// One point of the solve.
#[derive(Clone, Copy, Debug, Default)]
pub struct SolvePoint {
    /// Its law.
    pub law: Law,
    /// Gap before local compliance [m].
    pub gap0: f64,
    /// Its rate [m/s].
    pub rate: f64,
    /// Impact speed [m/s].
    pub impact_speed: f64,
    /// Stiffness of the law.
    pub stiffness: f64,
    /// Branch: `Some(true)` closed and smooth, `Some(false)` open, `None` clipped.
    pub closed: Option<bool>,
    /// Result: gap with local compliance [m].
    pub gap: f64,
    /// Result: normal force and derivatives at that gap.
    pub force: LawForce,
}

/// Buffers of the solve; grows to the largest number of points and stays.
#[derive(Clone, Debug, Default)]
pub struct CompliantSolve {
    jacobian: Vec<f64>,
    residual: Vec<f64>,
    released: Vec<f64>,
}

/// Newton iterations before the solve is given up.
const MAX_ITERATIONS: u32 = 60;

impl CompliantSolve {
    /// Solves for gaps and forces; `c` is the row-major compliance [m/N] between the points.
    pub fn solve(&mut self, c: &[f64], points: &mut [SolvePoint]) -> Result<(), Singular> {
        let n = points.len();
        for p in points.iter_mut() {
            p.gap = p.gap0;
            p.force = LawForce::default();
        }
        for _ in 0..MAX_ITERATIONS {
            // Gap of each point if it alone let go, from the forces of the last iteration.
            self.released.clear();
            for i in 0..n {
                let others: f64 = (0..n)
                    .filter(|&j| j != i)
                    .map(|j| c[i * n + j] * points[j].force.n)
                    .sum();
                self.released.push(points[i].gap0 + others);
            }
            for (p, &released) in points.iter_mut().zip(&self.released) {
                let closed = p.closed.unwrap_or(released < 0.0);
                p.force = LawForce::default();
                if closed {
                    let force = p.law.smooth(p.gap, p.rate, p.impact_speed, p.stiffness);
                    let pulls = p.closed.is_none() && force.n < 0.0;
                    p.force = if pulls { LawForce::default() } else { force };
                }
            }
            self.residual.clear();
            let mut worst = 0.0_f64;
            for i in 0..n {
                let deflection: f64 = (0..n).map(|j| c[i * n + j] * points[j].force.n).sum();
                let r = points[i].gap - points[i].gap0 - deflection;
                worst = worst.max(r.abs() / (points[i].gap0.abs() + deflection.abs() + 1e-12));
                self.residual.push(r);
            }
            if worst <= 1e-14 {
                return Ok(());
            }
            self.jacobian(c, points);
            solve_in_place(&mut self.jacobian, &mut self.residual)?;
            let mut moved = 0.0_f64;
            for (p, d) in points.iter_mut().zip(&self.residual) {
                p.gap -= d;
                moved = moved.max(d.abs() / (p.gap.abs() + 1e-12));
            }
            if moved <= 1e-15 {
                return Ok(());
            }
        }
        // A stalled solve must not pass for a force.
        Err(Singular)
    }

    /// Turns rows of `dN` at fixed gap into rows of `dN` with compliance: `(I - K C) dN = K dg0`, `K = dN/dg`.
    /// `rows` is row-major, one row of length `len` per point, already multiplied by `K`.
    pub fn couple(
        &mut self,
        c: &[f64],
        points: &[SolvePoint],
        rows: &mut [f64],
        len: usize,
    ) -> Result<(), Singular> {
        let n = points.len();
        for column in 0..len {
            self.jacobian.clear();
            self.residual.clear();
            for i in 0..n {
                for j in 0..n {
                    let unit = if i == j { 1.0 } else { 0.0 };
                    self.jacobian
                        .push(unit - points[i].force.dn_dg * c[i * n + j]);
                }
                self.residual.push(rows[i * len + column]);
            }
            solve_in_place(&mut self.jacobian, &mut self.residual)?;
            for i in 0..n {
                rows[i * len + column] = self.residual[i];
            }
        }
        Ok(())
    }

    fn jacobian(&mut self, c: &[f64], points: &[SolvePoint]) {
        let n = points.len();
        self.jacobian.clear();
        for i in 0..n {
            for j in 0..n {
                let unit = if i == j { 1.0 } else { 0.0 };
                self.jacobian
                    .push(unit - c[i * n + j] * points[j].force.dn_dg);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Damping;

    #[test]
    fn springs_in_series() {
        // One point, linear law k and compliance C: N = d / (1/k + C).
        let mut p = [SolvePoint {
            gap0: -1e-5,
            stiffness: 2e8,
            ..Default::default()
        }];
        CompliantSolve::default().solve(&[3e-9], &mut p).unwrap();
        let want = 1e-5 / (1.0 / 2e8 + 3e-9);
        assert!((p[0].force.n - want).abs() < 1e-10 * want);
    }

    #[test]
    fn coupling_opens_a_neighbour() {
        // Pressing point 0 moves point 1 away: it must end open with zero force.
        let mut p = [
            SolvePoint {
                gap0: -1e-5,
                stiffness: 1e9,
                ..Default::default()
            },
            SolvePoint {
                gap0: -1e-7,
                stiffness: 1e9,
                ..Default::default()
            },
        ];
        let c = [4e-9, 1e-9, 1e-9, 4e-9];
        CompliantSolve::default().solve(&c, &mut p).unwrap();
        assert_eq!(p[1].force.n, 0.0);
        assert!((p[0].force.n - 1e-5 / 5e-9).abs() < 1e-6);
        assert!(p[1].gap > 0.0);
    }

    #[test]
    fn a_damper_on_a_compliant_point_has_a_force_from_first_touch_on() {
        // Just overlapping and approaching: the damper pushes at once and the compliance gives way.
        let law = Law::new(1.0, Damping::KelvinVoigt { c: 500.0 }).unwrap();
        let (k, c, v) = (1.5e8, 3e-9, 0.7);
        for closed in [None, Some(true)] {
            let mut p = [SolvePoint {
                law,
                gap0: -1e-9,
                rate: -v,
                stiffness: k,
                closed,
                ..Default::default()
            }];
            CompliantSolve::default().solve(&[c], &mut p).unwrap();
            let want = (k * 1e-9 + 500.0 * v) / (1.0 + k * c);
            assert!(
                (p[0].force.n - want).abs() < 1e-9 * want,
                "{} {want}",
                p[0].force.n
            );
        }
    }

    #[test]
    fn each_point_keeps_its_own_law() {
        let damped = Law::new(1.0, Damping::KelvinVoigt { c: 500.0 }).unwrap();
        let point = SolvePoint {
            gap0: -1e-6,
            rate: -0.5,
            stiffness: 1e8,
            ..Default::default()
        };
        let mut p = [
            point,
            SolvePoint {
                law: damped,
                ..point
            },
        ];
        CompliantSolve::default()
            .solve(&[1e-9, 0.0, 0.0, 1e-9], &mut p)
            .unwrap();
        assert!((p[0].force.n - 100.0 / 1.1).abs() < 1e-9);
        assert!((p[1].force.n - 350.0 / 1.1).abs() < 1e-9);
    }
}
