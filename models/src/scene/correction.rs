//! The Newton correction: gears apart, then contacts as low-rank terms (Woodbury).
//!
//! ```text
//! A = A0 - U V,    x = x0 + Z y,    (I - V Z) y = V x0,    Z = A0^-1 U
//! ```
//!
//! with a row `V` and a column `U` for each normal force, and for each sliding force where there is friction. Many
//! contacts of large gears, and those of gears with displacement fields, have forms of their own.

use super::active::transverse;
use super::assembled::Scene;
use super::condensed::kappa;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::{At, Coeffs, Singular};

impl Scene {
    /// Solves the gears apart, then adds the contacts as low-rank terms (Woodbury).
    pub(super) fn newton_correction(
        &mut self,
        at: At<'_>,
        c: Coeffs,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        self.evaluate_contacts(at);
        let n = self.n;
        self.correct_gears(at, c, rhs_to_x)?;
        if self.fields {
            return self.correct_nodal(at, c, rhs_to_x);
        }
        let m = self.work.active.len();
        if m == 0 {
            return Ok(());
        }
        if self.condenses_now(c) {
            let work = &mut self.work;
            let contacts = (work.active.as_slice(), work.rows.as_slice());
            return (work.condensed).correct(&mut self.gears, contacts, at, c, rhs_to_x);
        }
        if m == 1 && self.meshes[self.work.active[0].mesh].friction.is_none() {
            return self.correct_one_contact(at, c, rhs_to_x);
        }
        let friction = self
            .work
            .active
            .iter()
            .any(|a| self.meshes[a.mesh].friction.is_some());
        let terms = if friction { 2 * m } else { m };

        // Rows V (how the forces answer to x) and columns Z = A0^-1 U (how x answers to the forces).
        let mut v = std::mem::take(&mut self.work.v);
        let mut z = std::mem::take(&mut self.work.z);
        v.clear();
        v.resize(terms * n, 0.0);
        z.clear();
        z.resize(terms * n, 0.0);
        for (i, (a, rows)) in self.work.active.iter().zip(&self.work.rows).enumerate() {
            let candidate = &self.work.candidates[a.candidate];
            let row = &mut v[i * n..][..n];
            rows[0].add_to(c.k * a.force.dn_dg + c.d * a.force.dn_dgdot, row);
            rows[0].add_first_to(
                -c.k * a.force.dn_dk * candidate.stiffness_s / candidate.scale[0],
                row,
            );
            rows[0].add_to(1.0, &mut z[i * n..][..n]);
        }
        let mut result = Ok(());
        if friction {
            for i in 0..m {
                self.friction_terms(at, c, i, m, &mut v, &mut z);
            }
        }
        let mut small = std::mem::take(&mut self.work.small);
        let mut rhs = std::mem::take(&mut self.work.rhs);
        small.clear();
        rhs.clear();
        for i in 0..terms {
            if result.is_ok() {
                result = self.correct_gears(at, c, &mut z[i * n..][..n]);
            }
        }
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| x * y).sum() };
        for i in 0..terms {
            let vi = &v[i * n..][..n];
            for j in 0..terms {
                // A = A0 - U V: the forces enter the residual with the opposite sign of stiffness.
                let unit = if i == j { 1.0 } else { 0.0 };
                small.push(unit - dot(vi, &z[j * n..][..n]));
            }
            rhs.push(dot(vi, rhs_to_x));
        }
        if result.is_ok() {
            result = solve_in_place(&mut small, &mut rhs);
        }
        if result.is_ok() {
            for (y, zi) in rhs.iter().zip(z.chunks_exact(n)) {
                for (x, zij) in rhs_to_x.iter_mut().zip(zi) {
                    *x += y * zij;
                }
            }
        }
        let work = &mut self.work;
        (work.v, work.z, work.small, work.rhs) = (v, z, small, rhs);
        result
    }

    /// Whether the condensed correction serves the contacts at hand.
    fn condenses_now(&self, c: Coeffs) -> bool {
        self.condenses
            && self.work.active.iter().all(|a| {
                let candidate = &self.work.candidates[a.candidate];
                self.meshes[a.mesh].friction.is_none()
                    && a.force.dn_dk * candidate.stiffness_s == 0.0
                    && kappa(a.force.dn_dg, a.force.dn_dgdot, c) >= 0.0
            })
    }

    fn correct_gears(&mut self, at: At<'_>, c: Coeffs, x: &mut [f64]) -> Result<(), Singular> {
        for g in &mut self.gears {
            let own = g.at(at);
            let range = g.range();
            let viscous = g.viscous();
            g.model.correct(own, c, viscous, &mut x[range])?;
        }
        Ok(())
    }

    /// Adds one contact without friction to `x = A0^-1 rhs`: `x += z (v.x) / (1 - v.z)`.
    fn correct_one_contact(
        &mut self,
        at: At<'_>,
        c: Coeffs,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let mut z = std::mem::take(&mut self.work.z);
        z.clear();
        z.resize(self.n, 0.0);
        self.work.rows[0][0].add_to(1.0, &mut z);
        let solved = self.correct_gears(at, c, &mut z);
        let (force, row) = (&self.work.active[0].force, &self.work.rows[0][0]);
        let candidate = &self.work.candidates[self.work.active[0].candidate];
        let per_gap = c.k * force.dn_dg + c.d * force.dn_dgdot;
        let per_path = -c.k * force.dn_dk * candidate.stiffness_s / candidate.scale[0];
        let v_dot = |x: &[f64]| {
            let along = if per_path == 0.0 {
                0.0
            } else {
                per_path * row.dot_first(x)
            };
            per_gap * row.dot(x) + along
        };
        let pivot = 1.0 - v_dot(&z);
        let singular = pivot == 0.0 || !pivot.is_finite();
        let y = v_dot(x) / pivot;
        for (x, z) in x.iter_mut().zip(&z) {
            *x += y * z;
        }
        self.work.z = z;
        if singular { Err(Singular) } else { solved }
    }

    /// Rows of the sliding force of contact `i` in the Newton correction: terms `m..2m`.
    fn friction_terms(
        &mut self,
        at: At<'_>,
        c: Coeffs,
        i: usize,
        m: usize,
        v: &mut [f64],
        z: &mut [f64],
    ) {
        let n = self.n;
        let (a, rows) = (&self.work.active[i], &self.work.rows[i]);
        if self.meshes[a.mesh].friction.is_none() {
            return;
        }
        let candidate = &self.work.candidates[a.candidate];
        let per_s = -1.0 / (candidate.scale[0] * transverse(candidate));
        let turn = rows[2].dot(at.v) - rows[1].dot(at.v);
        // dF = df_dn dN + df_dv dslide on the sliding row; dt F follows the contact point.
        let (normal, sliding) = v.split_at_mut(m * n);
        let row = &mut sliding[i * n..][..n];
        for (x, y) in row.iter_mut().zip(&normal[i * n..][..n]) {
            *x = a.friction.df_dn * y;
        }
        rows[1].add_to(c.d * a.friction.df_dv, row);
        rows[0].add_first_to(c.k * a.friction.df_dv * turn * per_s, row);
        rows[1].add_to(1.0, &mut z[(m + i) * n..][..n]);
        // The turning of the sliding row (dt/ds F) is left out of the Newton matrix: it is of the size of
        // F / r_b against a contact stiffness, and costs a further rank.
    }
}
