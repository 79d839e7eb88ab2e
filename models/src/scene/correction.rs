//! The Newton correction: gears separately, then contacts as low-rank terms (Woodbury).
//!
//! ([`low_rank`](super::low_rank)) with a row and a column for each normal force (for each of both gears, where stiffness or separation changes along
//! the path), and for each sliding force where there is friction. Many
//! contacts of large gears, and those of gears with displacement fields, have forms of their own.

use super::active::{ContactCoupling, moves};
use super::assembled::Scene;
use super::condensed::kappa;
use super::low_rank::LowRank;
use gearbench_integrators::system::{Coeffs, Singular, StateView};

impl Scene {
    /// Solves for the gears separately, then adds the contacts as low-rank terms (Woodbury).
    pub(super) fn newton_correction(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        self.with_carrier_state(at, |scene, carrier_state| {
            scene.evaluate_contacts(carrier_state)
        });
        if self.shafts.is_empty() && self.carriers.is_empty() {
            return self.correct_contacts(at, c, false, rhs_to_x);
        }
        self.correct_with_shafts(at, c, rhs_to_x)
    }

    /// Solves with the contacts of the last evaluation, and with the links of shafts where these are requested.
    pub(super) fn correct_contacts(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        links: bool,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        self.correct_gears(at, c, rhs_to_x)?;
        if self.fields {
            return self.correct_nodal(at, c, rhs_to_x);
        }
        let m = self.work.active.len();
        if m == 0 && !links {
            return Ok(());
        }
        if !links && self.condenses_now(c) {
            let work = &mut self.work;
            let contacts = (work.active.as_slice(), work.rows.as_slice());
            return (work.condensed).correct(&mut self.gears, contacts, at, c, rhs_to_x);
        }
        self.tangents_of_contacts(at)?;
        let plain = m == 1 && !links && self.work.tangents[0].plain;
        if plain && self.meshes[self.work.active[0].mesh].friction.is_none() {
            return self.correct_one_contact(at, c, rhs_to_x);
        }

        let mut terms = std::mem::take(&mut self.work.low_rank);
        terms.begin(self.n, self.gears.len());
        for i in 0..m {
            self.terms_of_contact(at, c, i, &mut terms);
        }
        if links {
            self.terms_of_shafts(at, c, &mut terms);
        }
        let solved = self.correct_terms(at, c, &mut terms);
        let solved = solved.and_then(|()| terms.solve(rhs_to_x));
        self.work.low_rank = terms;
        solved
    }

    /// Computes `Z = A0^-1 U` of low-rank terms.
    fn correct_terms(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        terms: &mut LowRank,
    ) -> Result<(), Singular> {
        terms.correct(|member, z| {
            let g = &mut self.gears[member];
            let (own, viscous) = (g.at(at), g.viscous());
            g.model.correct(own, c, viscous, z)
        })
    }

    /// Returns true if the condensed correction applies to the present contacts.
    pub(super) fn condenses_now(&self, c: Coeffs) -> bool {
        self.condenses
            && self.work.active.iter().all(|a| {
                let candidate = &self.work.candidates[a.candidate];
                let mesh = &self.meshes[a.mesh];
                (mesh.friction.is_none() || mesh.search.points().is_some())
                    && candidate.stiffness_s == 0.0
                    && candidate.curvature == [0.0; 2]
                    && kappa(a.force.dn_dg, a.force.dn_dgdot, c) >= 0.0
            })
    }

    fn correct_gears(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        x: &mut [f64],
    ) -> Result<(), Singular> {
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
        at: StateView<'_>,
        c: Coeffs,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let mut z = std::mem::take(&mut self.work.low_rank.column);
        z.resize(self.n, 0.0);
        self.work.rows[0][0].add_to(1.0, &mut z);
        let solved = self.correct_gears(at, c, &mut z);
        let (force, row) = (&self.work.active[0].force, &self.work.rows[0][0]);
        let per_gap = c.k * force.dn_dg + c.d * force.dn_dgdot;
        let v_dot = |x: &[f64]| per_gap * row.dot(x);
        let pivot = 1.0 - v_dot(&z);
        let singular = pivot == 0.0 || !pivot.is_finite();
        let y = v_dot(x) / pivot;
        for (x, z) in x.iter_mut().zip(&z) {
            *x += y * z;
        }
        z.fill(0.0);
        self.work.low_rank.column = z;
        if singular { Err(Singular) } else { solved }
    }

    /// Adds the terms of contact `i`: one where both gears receive the same change of force, otherwise one for each,
    /// and one of the sliding force.
    fn terms_of_contact(&self, at: StateView<'_>, c: Coeffs, i: usize, terms: &mut LowRank) {
        let (a, rows, t) = (
            &self.work.active[i],
            &self.work.rows[i],
            &self.work.tangents[i],
        );
        let [first, second] = self.meshes[a.mesh].gears;
        let members = [first.min(second), first.max(second)];
        let members = || members.map(|i| (i, self.gears[i].range())).into_iter();
        let by = |row: [f64; 2]| row.map(|k| c.k * k + c.d * t.rate);
        let parts = if t.plain { 0..1 } else { 0..2 };
        for k in parts {
            rows[0].add_parts_to(by(t.on[k]), &mut terms.row);
            self.add_couplings(i, c, |coupling| coupling.on[k], &mut terms.row);
            let own = match (t.plain, k) {
                (true, _) => [1.0, 1.0],
                (false, 0) => [1.0, 0.0],
                (false, _) => [0.0, 1.0],
            };
            rows[0].add_parts_to(own, &mut terms.column);
            terms.push(members(), 1.0);
        }
        if self.meshes[a.mesh].friction.is_none() {
            return;
        }
        // dF = df_dn dN + df_dv dslide on the sliding row; dslide follows the contact point.
        let candidate = &self.work.candidates[a.candidate];
        let turn = rows[2].dot(at.v) - rows[1].dot(at.v);
        let along = [[1.0, 0.0], [0.0, 1.0]].map(|d| moves(&self.meshes[a.mesh], candidate, d));
        let per_s = c.k * a.friction.df_dv * turn;
        let of_normal = by(t.normal).map(|x| a.friction.df_dn * x);
        rows[0].add_parts_to(of_normal, &mut terms.row);
        self.add_couplings(
            i,
            c,
            |coupling| a.friction.df_dn * coupling.normal,
            &mut terms.row,
        );
        rows[1].add_to(c.d * a.friction.df_dv, &mut terms.row);
        rows[0].add_parts_to(along.map(|x| per_s * x), &mut terms.row);
        rows[1].add_to(1.0, &mut terms.column);
        terms.push(members(), 1.0);
        // The turning of the sliding row (dt/ds F) is left out of the Newton matrix: it is of the size of
        // F / r_b against a contact stiffness, and costs a further rank.
    }

    /// Adds the couplings of contact `i` with its neighbours to a row.
    fn add_couplings(
        &self,
        i: usize,
        c: Coeffs,
        by: impl Fn(&ContactCoupling) -> f64,
        row: &mut [f64],
    ) {
        for coupling in self.work.couplings_of(i) {
            let factor = c.k * by(coupling);
            let elastic = self.work.tangents[coupling.to].elastic;
            self.work.rows[coupling.to][0].add_parts_to(elastic.map(|x| factor * x), row);
        }
    }
}
