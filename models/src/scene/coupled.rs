//! Contacts of tooth pairs as their neighbours see them: forces along the path by the compliance of the bodies that they
//! bend together, and the tangents of all of them.
//!
//! With the elastic forces `N`, their tangents `K = dN/dg` and the compliances `C` between contacts,
//!
//! ```text
//! dg = (I - C K)^-1 (dg0 + C dN|g),    dN = dN|g0 + K G dN|g0,    G = (I - C K)^-1 C
//! ```

use super::active::{Active, Answer, tangent};
use super::assembled::Scene;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::{At, Singular};

impl Scene {
    /// Elastic force of an active contact, which is what its neighbours feel [N].
    fn elastic_force(&self, a: &Active) -> f64 {
        let c = &self.work.candidates[a.candidate];
        let law = self.meshes[a.mesh].law.undamped();
        law.smooth(a.gap, 0.0, 0.0, c.stiffness).n
    }

    /// Calls `f(i, j, compliance, its derivative along the normal, elastic forces)` for active contacts that bend one
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
            // Those of a line stand one after another.
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

    /// Joins to the forces of a mesh's contacts what the compliance between them changes by along the path.
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
            let scale = work.candidates[work.active[i].candidate].scale;
            let on = &mut work.active[i].on;
            on[0] += along / scale[0];
            on[1] -= along / scale[1];
        }
        self.work.along_path = found;
    }

    /// Tangents of the active contacts at a state, into `work.tangents` and `work.answers`.
    pub(super) fn tangents_of_contacts(&mut self, at: At<'_>) -> Result<(), Singular> {
        let work = &mut self.work;
        work.tangents.clear();
        work.answers.clear();
        for (a, rows) in work.active.iter().zip(&work.rows) {
            let c = &work.candidates[a.candidate];
            let law = &self.meshes[a.mesh].law;
            work.tangents.push(tangent(law, c, a, &rows[0], at.v));
        }
        let mut couplings = Vec::new();
        self.each_coupling(|i, j, c, n| couplings.push((i, j, c, n)));
        if couplings.is_empty() {
            return Ok(());
        }
        let mut coupled: Vec<usize> = couplings.iter().flat_map(|c| [c.0, c.1]).collect();
        coupled.sort_unstable();
        coupled.dedup();
        let n = coupled.len();
        let place = |i: usize| coupled.partition_point(|&x| x < i);
        let mut compliance = vec![0.0; n * n];
        for &(i, j, [c, _], _) in &couplings {
            let (i, j) = (place(i), place(j));
            (compliance[i * n + j], compliance[j * n + i]) = (c, c);
        }
        let k: Vec<f64> = (coupled.iter().map(|&i| &self.work.active[i]))
            .map(|a| {
                let c = &self.work.candidates[a.candidate];
                let law = self.meshes[a.mesh].law.undamped();
                law.smooth(a.gap, 0.0, 0.0, c.stiffness).dn_dg
            })
            .collect();
        // Columns of G, then how elastic forces answer: H = I + K G.
        let mut g = vec![0.0; n * n];
        for column in 0..n {
            let mut matrix: Vec<f64> = (0..n * n)
                .map(|e| f64::from(u8::from(e / n == e % n)) - compliance[e] * k[e % n])
                .collect();
            let mut rhs: Vec<f64> = (0..n).map(|i| compliance[i * n + column]).collect();
            solve_in_place(&mut matrix, &mut rhs)?;
            for (i, x) in rhs.into_iter().enumerate() {
                g[i * n + column] = x;
            }
        }
        let h = |i: usize, l: usize| f64::from(u8::from(i == l)) + k[i] * g[i * n + l];
        let work = &mut self.work;
        for (i, &of) in coupled.iter().enumerate() {
            let t = &mut work.tangents[of];
            t.plain = false;
            let scale = work.candidates[work.active[of].candidate].scale;
            for (l, &to) in coupled.iter().enumerate() {
                let by = g[i * n + l];
                let mut on = t.by_gap.map(|x| x * by);
                for &(a, b, [_, slope], forces) in &couplings {
                    if a != of && b != of {
                        continue;
                    }
                    let (a, b) = (place(a), place(b));
                    let along = -0.25 * slope * (forces[1] * h(a, l) + forces[0] * h(b, l));
                    on[0] += along / scale[0];
                    on[1] -= along / scale[1];
                }
                let normal = work.active[of].force.dn_dg * by;
                work.answers.push(Answer { of, to, normal, on });
            }
        }
        Ok(())
    }
}
