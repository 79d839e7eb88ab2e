//! Elastic coupling of tooth pairs through their common bodies: forces along the path by the compliance, and tangents
//! of all pairs.
//!
//! With the elastic forces `N`, their tangents `K = dN/dg` and the compliances `C` between contacts,
//!
//! ```text
//! dg = (I - C K)^-1 (dg0 + C dN|g),    dN = dN|g0 + K G dN|g0,    G = (I - C K)^-1 C
//! ```

use super::active::{Active, ContactCoupling, tangent};
use super::assembled::Scene;
use crate::contact::pairs::MOST_ON_LINE as MOST;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::{Singular, StateView};

impl Scene {
    /// Returns the elastic force of an active contact, which acts on neighbouring pairs [N].
    fn elastic_force(&self, a: &Active) -> f64 {
        let c = &self.work.candidates[a.candidate];
        let law = self.meshes[a.mesh].law.undamped();
        law.force(a.gap, 0.0, 0.0, c.stiffness)
    }

    /// Calls `f(i, j, compliance, its derivative along the normal, elastic forces)` for active contacts on a common
    /// body.
    pub(super) fn each_coupling(&self, mut f: impl FnMut(usize, usize, [f64; 2], [f64; 2])) {
        let active = &self.work.active;
        for (i, a) in active.iter().enumerate() {
            let Some(pairs) = self.meshes[a.mesh].search.pairs() else {
                continue;
            };
            if !pairs.couples() {
                continue;
            }
            // Contacts on one line of action are consecutive.
            for (j, b) in active.iter().enumerate().skip(i + 1) {
                let [of_a, of_b] = [a, b].map(|x| &self.work.candidates[x.candidate]);
                if b.mesh != a.mesh || !pairs.on_one_line(of_a, of_b) {
                    break;
                }
                if let Some((c, slope)) = pairs.compliance(of_a, of_b) {
                    let forces = [a, b].map(|x| self.elastic_force(x));
                    f(i, j, [c, slope], forces);
                }
            }
        }
    }

    /// Adds the change of the compliance between the contacts of a mesh along the path to their forces.
    pub(super) fn add_coupling_along_path(&mut self, m: usize) {
        let mut found = std::mem::take(&mut self.work.along_path);
        found.clear();
        self.each_coupling(|i, j, [_, slope], [n, o]| {
            if self.work.active[i].mesh == m {
                // By half for either contact, and by half for either gear.
                let along = -0.25 * slope * n * o;
                found.extend([(i, along), (j, along)]);
            }
        });
        for &(i, along) in &found {
            let work = &mut self.work;
            let c = &work.candidates[work.active[i].candidate];
            let (scale, in_space) = (c.scale, c.along.is_some());
            let active = &mut work.active[i];
            if in_space {
                active.along += along;
                continue;
            }
            active.on[0] += along / scale[0];
            active.on[1] -= along / scale[1];
        }
        self.work.along_path = found;
    }

    /// Computes the tangents of the active contacts at a state into `work.tangents` and `work.couplings`.
    pub(super) fn tangents_of_contacts(&mut self, at: StateView<'_>) -> Result<(), Singular> {
        let work = &mut self.work;
        work.tangents.clear();
        work.couplings.clear();
        for (a, rows) in work.active.iter().zip(&work.rows) {
            let c = &work.candidates[a.candidate];
            let law = &self.meshes[a.mesh].law;
            work.tangents.push(tangent(law, c, a, &rows[0], at.v));
        }
        let mut first = 0;
        while first < self.work.active.len() {
            let n = self.on_line_from(first);
            if n > 1 {
                self.couplings_of_line(first, n)?;
            }
            first += n;
        }
        Ok(())
    }

    /// Returns the number of active contacts from `first` on with the same bodies: those of its line, at least one.
    fn on_line_from(&self, first: usize) -> usize {
        let active = &self.work.active[first..];
        let a = &active[0];
        let Some(pairs) = self.meshes[a.mesh].search.pairs().filter(|p| p.couples()) else {
            return 1;
        };
        let of = |x: &Active| &self.work.candidates[x.candidate];
        let same = |b: &&Active| b.mesh == a.mesh && pairs.on_one_line(of(a), of(b));
        active.iter().take(MOST).take_while(same).count()
    }

    /// Computes the couplings of the contacts of a line.
    fn couplings_of_line(&mut self, first: usize, n: usize) -> Result<(), Singular> {
        let Some(pairs) = self.meshes[self.work.active[first].mesh].search.pairs() else {
            return Ok(());
        };
        let (mut c, mut slopes) = ([0.0; MOST * MOST], [0.0; MOST * MOST]);
        let (mut k, mut force) = ([0.0; MOST], [0.0; MOST]);
        for i in 0..n {
            let a = &self.work.active[first + i];
            let of_a = &self.work.candidates[a.candidate];
            let law = self.meshes[a.mesh].law.undamped();
            let elastic = law.smooth(a.gap, 0.0, 0.0, of_a.stiffness);
            (k[i], force[i]) = (elastic.dn_dg, elastic.n);
            for j in 0..i {
                let of_b = &self.work.candidates[self.work.active[first + j].candidate];
                if let Some((value, slope)) = pairs.compliance(of_a, of_b) {
                    (c[i * n + j], c[j * n + i]) = (value, value);
                    (slopes[i * n + j], slopes[j * n + i]) = (slope, slope);
                }
            }
        }
        // Columns of G, then the response of the elastic forces: H = I + K G.
        let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
        let mut g = [0.0; MOST * MOST];
        for column in 0..n {
            let (mut matrix, mut rhs) = ([0.0; MOST * MOST], [0.0; MOST]);
            for i in 0..n {
                rhs[i] = c[i * n + column];
                for j in 0..n {
                    matrix[i * n + j] = unit(i, j) - c[i * n + j] * k[j];
                }
            }
            solve_in_place(&mut matrix[..n * n], &mut rhs[..n])?;
            for i in 0..n {
                g[i * n + column] = rhs[i];
            }
        }
        let h = |i: usize, l: usize| unit(i, l) + k[i] * g[i * n + l];
        let work = &mut self.work;
        for i in 0..n {
            let t = &mut work.tangents[first + i];
            t.plain = false;
            let a = &work.active[first + i];
            let c = &work.candidates[a.candidate];
            let (scale, in_space) = (c.scale, c.along.is_some());
            for l in 0..n {
                let by = g[i * n + l];
                let along: f64 = (0..n)
                    .map(|j| slopes[i * n + j] * (force[j] * h(i, l) + force[i] * h(j, l)))
                    .sum();
                let along = if in_space { 0.0 } else { -0.25 * along };
                work.couplings.push(ContactCoupling {
                    of: first + i,
                    to: first + l,
                    normal: a.force.dn_dg * by,
                    on: [
                        t.by_gap[0] * by + along / scale[0],
                        t.by_gap[1] * by - along / scale[1],
                    ],
                });
            }
        }
        Ok(())
    }
}
