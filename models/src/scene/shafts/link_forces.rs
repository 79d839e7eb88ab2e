//! Links of shafts in a scene: forces, tangents, corrections and reports.

use super::links::{Link, small};
use crate::kinematics::Wrench;
use crate::scene::assembled::Scene;
use crate::scene::low_rank::LowRank;
use crate::scene::members::SceneGear;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::{
    Coeffs, Energy, Power, SecondOrderSystem, Singular, StateView,
};

impl Scene {
    /// Adds the forces of elastic shafts.
    #[inline]
    pub(in crate::scene) fn add_shafts(&self, at: StateView<'_>, f: &mut [f64]) {
        for link in self.shafts.springs() {
            link.add_to(link.force(&self.gears, at), f);
        }
    }

    /// Projects forces to those compatible with rigid shafts.
    #[inline]
    pub(in crate::scene) fn hold_shafts(&mut self, at: StateView<'_>, f: &mut [f64]) {
        if !self.shafts.rigid().is_empty() {
            self.hold_rigid(at, f);
        }
    }

    /// Projects forces to those compatible with rigid shafts and stores the forces along the rows in
    /// `work.shafts.forces`.
    fn hold_rigid(&mut self, at: StateView<'_>, f: &mut [f64]) {
        let mut work = std::mem::take(&mut self.work.shafts);
        let n = f.len();
        work.x.clear();
        work.x.extend_from_slice(f);
        self.solve_mass(at, &mut work.x);
        work.small.clear();
        if self.shafts.inverse.is_empty() {
            work.z.clear();
            work.z.resize(n * self.shafts.rigid().len(), 0.0);
            for (k, column) in work.z.chunks_exact_mut(n).enumerate() {
                self.shafts.rigid()[k].add_to(1.0, column);
                self.solve_mass(at, column);
            }
            work.small.extend(small(self.shafts.rigid(), &work.z, n));
        } else {
            work.small.extend_from_slice(&self.shafts.small);
        }
        let rigid = self.shafts.rigid();
        work.forces.clear();
        let missing = |l: &Link| l.acceleration(at.t) - l.dot(&work.x);
        work.forces.extend(rigid.iter().map(missing));
        match solve_in_place(&mut work.small, &mut work.forces) {
            Ok(()) => {
                for (link, force) in rigid.iter().zip(&work.forces) {
                    link.add_to(*force, f);
                }
            }
            // Dependent links were left out, so that only masses that are no numbers come here.
            Err(Singular) => f.fill(f64::NAN),
        }
        self.work.shafts = work;
    }

    /// Adds the tangent of elastic shafts.
    pub(in crate::scene) fn add_shaft_tangent(
        &self,
        at: StateView<'_>,
        [dq, dv]: [&[f64]; 2],
        df: &mut [f64],
    ) {
        for l in self.shafts.springs() {
            let [stiffness, damping] = l.slopes(&self.gears, at);
            l.add_to(-(stiffness * l.dot(dq) + damping * l.dot(dv)), df);
        }
    }

    /// Adds the terms of the links to those of contacts in a Newton correction.
    pub(in crate::scene) fn terms_of_shafts(
        &self,
        at: StateView<'_>,
        c: Coeffs,
        terms: &mut LowRank,
    ) {
        for (i, link) in self.shafts.links.iter().enumerate() {
            link.add_to(-self.link_response(link, at, c), &mut terms.row);
            link.add_to(1.0, &mut terms.column);
            let [one, other] = link.members;
            let second = Some(one.max(other)).filter(|m| *m != one.min(other));
            let members = std::iter::once(one.min(other)).chain(second);
            terms.push(
                members.map(|m| (m, self.gears[m].range())),
                self.unit_of_link(i),
            );
        }
    }

    /// Solves for the correction with all links.
    pub(in crate::scene) fn correct_with_shafts(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let rhs = if c.m == 0.0 { x.to_vec() } else { Vec::new() };
        let apart = self.fields || !self.carriers.is_empty() || self.condenses_now(c);
        let found = if apart {
            self.correct_links_after(at, c, x)
        } else {
            self.correct_contacts(at, c, true, x)
        };
        if found.is_ok() || c.m != 0.0 {
            return found;
        }
        // Without its links a body on a shaft meets no stiffness; with them it may.
        x.copy_from_slice(&rhs);
        self.correct_statics(at, c, x)
    }

    /// Solves for the correction without mass from a dense matrix, `P^T A + s C C^T` with the projection `P` of rigid
    /// shafts: any `s` gives the admissible solution.
    fn correct_statics(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let n = self.n;
        let (mut dq, mut dv, mut df) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let mut a = vec![0.0; n * n];
        for j in 0..n {
            (dq[j], dv[j]) = (c.k, c.d);
            self.tangent_times(at, &dq, &dv, &mut df);
            (dq[j], dv[j]) = (0.0, 0.0);
            for (i, df) in df.iter().enumerate() {
                a[i * n + j] = -df;
            }
        }
        let stiffest = (0..n).fold(0.0_f64, |m, i| m.max(a[i * n + i].abs()));
        for link in self.shafts.rigid() {
            for &(i, wi) in &link.row {
                for &(j, wj) in &link.row {
                    a[i * n + j] += stiffest * wi * wj;
                }
            }
        }
        solve_in_place(&mut a, x)
    }

    /// Adds the links to `x = B^-1 rhs` with a correction `B` that includes all contacts in a form of their own.
    fn correct_links_after(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let (n, count) = (self.n, self.shafts.links.len());
        self.correct_sets(at, c, x)?;
        let (mut v, mut z) = (vec![0.0; n * count], vec![0.0; n * count]);
        let lines = v.chunks_exact_mut(n).zip(z.chunks_exact_mut(n));
        for (link, (row, column)) in self.shafts.links.iter().zip(lines) {
            link.add_to(-self.link_response(link, at, c), row);
            link.add_to(1.0, column);
        }
        for column in z.chunks_exact_mut(n) {
            self.correct_sets(at, c, column)?;
        }
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| x * y).sum() };
        let (mut small, mut y) = (Vec::with_capacity(count * count), Vec::new());
        for (i, row) in v.chunks_exact(n).enumerate() {
            let own = self.unit_of_link(i);
            let line = z.chunks_exact(n).enumerate();
            small.extend(line.map(|(j, z)| if i == j { own } else { 0.0 } - dot(row, z)));
            y.push(dot(row, x));
        }
        solve_in_place(&mut small, &mut y)?;
        for (y, z) in y.iter().zip(z.chunks_exact(n)) {
            x.iter_mut().zip(z).for_each(|(x, z)| *x += y * z);
        }
        Ok(())
    }

    /// Returns the diagonal of the equation of a link's force in a correction: zero for a rigid link, which has no
    /// compliance.
    pub(in crate::scene) fn unit_of_link(&self, link: usize) -> f64 {
        f64::from(u8::from(!self.shafts.links[link].is_rigid()))
    }

    /// Adds energy and powers of elastic shafts.
    pub(in crate::scene) fn add_shaft_books(
        &self,
        at: StateView<'_>,
        energy: &mut Energy,
        power: &mut Power,
    ) {
        for link in self.shafts.springs() {
            let [d, rate] = link.deformation(&self.gears, at);
            energy.strain += 0.5 * link.stiffness * d * d;
            power.dissipated += link.damping * rate * rate;
            power.dissipated += link.friction([d, rate], at) * rate;
            if !link.driven.is_empty() {
                let force = link.stiffness * d + link.damping * rate;
                power.external += force * link.drift(&self.gears, at);
            }
        }
    }

    /// Computes the forces of all links along their rows in `work.shafts.acting`; `contacts` are the forces of
    /// contacts and loads, and the internal forces of gears on carriers.
    pub(in crate::scene) fn evaluate_links(&mut self, at: StateView<'_>, contacts: &[f64]) {
        let mut acting = std::mem::take(&mut self.work.shafts.acting);
        acting.clear();
        acting.extend(
            self.shafts
                .springs()
                .iter()
                .map(|l| l.force(&self.gears, at)),
        );
        if !self.shafts.rigid().is_empty() {
            let mut f = contacts.to_vec();
            for (i, g) in self.gears.iter_mut().enumerate() {
                if g.internal && !self.carriers.carries(i) {
                    let (own, range) = (g.at(at), g.range());
                    g.model.forces(own, &mut f[range]);
                }
            }
            self.relative_forces(at, &mut f, |scene, carrier_state, f| {
                scene.add_carried_forces(carrier_state, f)
            });
            for (link, force) in self.shafts.springs().iter().zip(&acting) {
                link.add_to(*force, &mut f);
            }
            self.hold_rigid(at, &mut f);
            acting.extend_from_slice(&self.work.shafts.forces);
        }
        self.work.shafts.acting = acting;
    }

    /// Adds the forces of the links on a member, to its coordinates and as a wrench.
    pub(in crate::scene) fn add_links_on(&self, member: usize, f: &mut [f64], wrench: &mut Wrench) {
        for (link, force) in self.shafts.links.iter().zip(&self.work.shafts.acting) {
            if !link.members.contains(&member) {
                continue;
            }
            let range = self.gears[member].range();
            for &(i, w) in link.row.iter().filter(|(i, _)| range.contains(i)) {
                f[i] += force * w;
            }
            let hub = self.gears[member].model.hub();
            for s in link.shares.iter().filter(|s| s.member == member) {
                let on = force * s.weight;
                match s.direction {
                    5 => wrench.torque += on,
                    d @ 0..3 => wrench.force += on * hub.axes[d],
                    _ => {}
                }
            }
        }
    }

    /// Returns the torque with which the ground fixes or drives a member of a planetary set [N m].
    pub(in crate::scene) fn torque_of_ground(&self, member: usize) -> f64 {
        let links = self.shafts.links.iter().zip(&self.work.shafts.acting);
        let own = links.filter(|(l, _)| l.ground().is_some_and(|g| g.member == member));
        own.map(|(_, force)| force).sum()
    }

    /// Returns the power of the drives of planetary sets, from the forces of the last [`Self::evaluate_links`] [W].
    pub(in crate::scene) fn power_of_grounds(&self, t: f64) -> f64 {
        let links = self.shafts.links.iter().zip(&self.work.shafts.acting);
        let power = links.filter_map(|(l, force)| Some(force * l.ground()?.motion(t)[0]));
        power.sum()
    }

    /// Returns the forces of all links along their rows, from the last [`Self::evaluate_links`].
    pub(super) fn acting_links(&self) -> &[f64] {
        &self.work.shafts.acting
    }

    /// Returns the derivative of a link's force by its deformation in a correction; for a rigid link only the sign.
    fn link_response(&self, link: &Link, at: StateView<'_>, c: Coeffs) -> f64 {
        if link.is_rigid() {
            return 1.0;
        }
        let [stiffness, damping] = link.slopes(&self.gears, at);
        c.k * stiffness + c.d * damping
    }

    /// Computes the torques of members on the next one through their shaft or stage [N m].
    pub(in crate::scene) fn fill_shaft_torques(&self, channels: &mut [f64]) {
        for (channel, link) in channels.iter_mut().zip(&self.shafts.torques) {
            *channel = link.map_or(0.0, |i| self.work.shafts.acting[i]);
        }
    }

    /// Returns true if rigid shafts join coordinates that oscillate.
    pub(in crate::scene) fn rigid_shafts_swing(&self) -> bool {
        let swings = |g: &SceneGear, i: usize| {
            let of = g.model.linear().and_then(|l| l.oscillators());
            of.is_none_or(|o| o.omega[i - g.offset] != 0.0 || o.zeta[i - g.offset] != 0.0)
        };
        let owner = |i: usize| self.gears.iter().find(|g| g.range().contains(&i));
        let rows = self.shafts.rigid().iter().flat_map(|l| &l.row);
        rows.into_iter()
            .any(|&(i, _)| owner(i).is_none_or(|g| swings(g, i)))
    }
}

/// Buffers of the shafts.
#[derive(Default)]
pub(in crate::scene) struct ShaftWork {
    /// Buffers of rigid links: accelerations, columns, equations, forces.
    x: Vec<f64>,
    z: Vec<f64>,
    small: Vec<f64>,
    forces: Vec<f64>,
    /// Forces of all links at the state of the report.
    acting: Vec<f64>,
}
