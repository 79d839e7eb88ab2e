//! Contacts without fields in the tangent, each with its few rows.

use super::{ReducedTangent, add_outer};
use crate::kinematics::Row;
use crate::scene::active::{Active, ContactCoupling, Tangent};
use gearbench_integrators::system::Coeffs;

impl ReducedTangent {
    /// Adds `T` of a contact without fields, including friction.
    pub(in crate::scene) fn add_contact(
        &mut self,
        a: &Active,
        tangent: &Tangent,
        rows: &[Row; 4],
        c: Coeffs,
    ) {
        let (mut parts, mut sliding) = ([vec![], vec![]], vec![]);
        for (gear, part) in parts.iter_mut().enumerate() {
            rows[0].for_each_of(gear, |i, x| part.push((self.mark[i], x)));
        }
        rows[1].for_each(|i, x| sliding.push((self.mark[i], x)));
        let (t, n) = (&mut self.response, self.size);
        for j in 0..2 {
            let by = |k: f64| c.k * k + c.d * tangent.rate;
            for k in 0..2 {
                add_outer(t, n, &parts[k], &parts[j], by(tangent.on[k][j]));
            }
            let of_normal = a.friction.df_dn * by(tangent.normal[j]);
            add_outer(t, n, &sliding, &parts[j], of_normal);
        }
        add_outer(t, n, &sliding, &sliding, c.d * a.friction.df_dv);
    }

    /// Adds `T` of the coupling of a contact without fields to another one.
    pub(in crate::scene) fn add_coupling(
        &mut self,
        coupling: &ContactCoupling,
        rows: &[Row; 4],
        (tangent, to): (&Tangent, &Row),
        a: &Active,
        c: Coeffs,
    ) {
        let (mut right, mut sliding) = (vec![], vec![]);
        for (gear, by) in tangent.elastic.into_iter().enumerate() {
            to.for_each_of(gear, |i, x| right.push((self.mark[i], by * x)));
        }
        rows[1].for_each(|i, x| sliding.push((self.mark[i], x)));
        let (t, n) = (&mut self.response, self.size);
        for (gear, by) in coupling.on.into_iter().enumerate() {
            let mut left = vec![];
            rows[0].for_each_of(gear, |i, x| left.push((self.mark[i], x)));
            add_outer(t, n, &left, &right, c.k * by);
        }
        let by = c.k * a.friction.df_dn * coupling.normal;
        add_outer(t, n, &sliding, &right, by);
    }
}
