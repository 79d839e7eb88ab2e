//! The scene as a second-order system: force, tangent, Newton correction, event functions, switches.

use super::contacts::gap_row;
use super::{Scene, SceneGear, parties};
use crate::contact::{Candidate, Wanted};
use crate::gear::LargeGear;
use crate::kinematics::Row;
use crate::law::Law;
use gearbench_integrators::FlightPath;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::{
    At, Change, Coeffs, Events, FreeFlight, Layout, ModalSplit, Outputs, Report, SecondOrderSystem,
    Singular, State,
};

/// Event function of an open contact: the gap, or, where the bodies still overlap after a damped release, how far
/// the law is from pushing again; in metres.
#[inline]
fn open_event(law: &Law, c: &Candidate, gap: f64, rate: f64, impact_speed: f64) -> f64 {
    if gap > 0.0 {
        return gap;
    }
    let n = law.smooth(gap, rate, impact_speed, c.stiffness).n;
    gap.max(-as_length(law, n, c.stiffness))
}

/// A force as the length that the elastic law would need for it, with sign.
#[inline]
fn as_length(law: &Law, n: f64, k: f64) -> f64 {
    let x = n / k;
    if law.exponent() == 1.0 {
        x
    } else {
        x.signum() * x.abs().powf(1.0 / law.exponent())
    }
}

impl SecondOrderSystem for Scene {
    fn layout(&self) -> Layout {
        Layout {
            n: self.n,
            event_functions: self.event_functions,
            discrete: self.discrete,
        }
    }

    fn scales(&self, q: &mut [f64], v: &mut [f64]) {
        for g in &self.gears {
            g.model
                .hub()
                .magnitudes(self.magnitudes, &mut q[g.range()], &mut v[g.range()]);
        }
    }

    fn characteristic_time(&self, _at: At<'_>) -> f64 {
        self.characteristic_time
    }

    fn force(&mut self, at: At<'_>, f: &mut [f64]) {
        f.fill(0.0);
        for g in &mut self.gears {
            if g.internal {
                let own = g.at(at);
                let range = g.range();
                g.model.forces(own, &mut f[range]);
            }
            g.add_load(at, f);
        }
        self.evaluate_contacts(at);
        self.add_contact_forces(f);
    }

    fn solve_mass(&mut self, at: At<'_>, f_to_a: &mut [f64]) {
        if !self.inverse_mass.is_empty() {
            for (f, m) in f_to_a.iter_mut().zip(&self.inverse_mass) {
                *f *= m;
            }
            return;
        }
        for g in &self.gears {
            let range = g.range();
            match g.model.coupled_mass() {
                Some(mass) => mass.solve(g.at(at), &mut f_to_a[range]),
                None => {
                    for (f, m) in f_to_a[range.clone()].iter_mut().zip(&self.mass[range]) {
                        *f /= m;
                    }
                }
            }
        }
    }

    fn apply_mass(&mut self, at: At<'_>, x: &[f64], y: &mut [f64]) {
        if !self.inverse_mass.is_empty() {
            for ((y, x), m) in y.iter_mut().zip(x).zip(&self.mass) {
                *y = m * x;
            }
            return;
        }
        for g in &self.gears {
            let range = g.range();
            match g.model.coupled_mass() {
                Some(mass) => mass.apply(g.at(at), &x[range.clone()], &mut y[range]),
                None => {
                    for i in range {
                        y[i] = self.mass[i] * x[i];
                    }
                }
            }
        }
    }

    fn correct(&mut self, at: At<'_>, c: Coeffs, rhs_to_x: &mut [f64]) -> Result<(), Singular> {
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
            return self.correct_condensed(at, c, rhs_to_x);
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

    fn factorisations(&self) -> Option<u64> {
        let large = self.gears.iter().filter_map(|g| g.model.large());
        let kept = large.map(LargeGear::factorisations);
        kept.reduce(|a, b| a + b)
    }

    fn tangent_times(&mut self, at: At<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        df.fill(0.0);
        for g in &mut self.gears {
            let own = g.at(at);
            let range = g.range();
            g.model.tangent(
                own,
                &dq[range.clone()],
                &dv[range.clone()],
                &mut df[range.clone()],
            );
            let hub = g.model.hub();
            if hub.coordinates() > 0 && !g.loads.is_empty() {
                let along = At {
                    v: &dv[range.clone()],
                    ..own
                };
                let load = -g.viscous() * hub.load_speed(along);
                hub.add_load(load, &mut df[range]);
            }
        }
        self.evaluate_contacts(at);
        self.normal_tangent(dq, dv);
        let work = &self.work;
        for (i, (a, rows)) in work.active.iter().zip(&work.rows).enumerate() {
            rows[0].add_to(work.rhs[i], df);
            if self.meshes[a.mesh].friction.is_some() {
                // The contact point moves along the line of action and takes the sliding row with it.
                let candidate = &work.candidates[a.candidate];
                let ds = -rows[0].dot_first(dq) / (candidate.scale[0] * transverse(candidate));
                let turn = rows[2].dot(at.v) - rows[1].dot(at.v);
                let dslide = rows[1].dot(dv) + ds * turn;
                let dforce = a.friction.df_dn * work.rhs[i] + a.friction.df_dv * dslide;
                rows[1].add_to(dforce - ds * a.friction.f, df);
                rows[2].add_to(ds * a.friction.f, df);
            }
        }
        if self.fields {
            self.add_nodal_tangent([dq, dv], df);
        }
    }

    fn modal(&mut self) -> Option<&mut dyn ModalSplit> {
        if self.oscillators { Some(self) } else { None }
    }
    fn events(&mut self) -> Option<&mut dyn Events> {
        Some(self)
    }
    fn free_flight(&mut self) -> Option<&mut dyn FreeFlight> {
        Some(self)
    }
    fn report(&mut self) -> Option<&mut dyn Report> {
        Some(self)
    }
}

impl Events for Scene {
    fn event_functions(&mut self, at: At<'_>, out: &mut [f64]) {
        out.fill(1.0);
        if out.is_empty() {
            return;
        }
        for m in 0..self.meshes.len() {
            let mesh = &self.meshes[m];
            let (a, b) = parties(&self.gears, mesh, at);
            let (zone, slots) =
                out[mesh.event_functions..][..mesh.zones + mesh.slots].split_at_mut(mesh.zones);
            let Some(pairs) = mesh.search.pairs() else {
                continue;
            };
            pairs.watch(a, b, &at.discrete[mesh.search_discrete()], zone, slots);
            // Gaps are all that open contacts and contacts without damping need.
            let modes = &at.discrete[mesh.modes()];
            let (mut closed, mut overlap) = (false, false);
            for (g, mode) in slots.iter_mut().zip(modes.chunks_exact(2)) {
                if mode[0] != 0.0 {
                    closed = true;
                    *g = -*g;
                } else {
                    overlap |= *g <= 0.0;
                }
            }
            if (closed || overlap) && mesh.law.is_dissipative() {
                let wanted = if overlap {
                    Wanted::Listed
                } else {
                    Wanted::Closed(modes)
                };
                self.damped_events(at, m, wanted, out);
            }
        }
    }

    fn next_breakpoint(&self, t: f64) -> f64 {
        let mut next = f64::INFINITY;
        for g in &self.gears {
            next = next.min(g.model.hub().next_breakpoint(t));
            for l in &g.loads {
                if let crate::spec::Load::Applied(p) = l {
                    next = next.min(p.next_breakpoint(t));
                }
            }
        }
        next
    }

    fn begin(&mut self, s: &mut State, located: bool) {
        for g in &self.gears {
            if let Some(linear) = g.model.linear() {
                linear.set_quasi_static_correction(None);
            }
        }
        self.work.nodal.forget();
        // Contacts of an earlier run let go of their teeth.
        for m in 0..self.meshes.len() {
            for slot in 0..self.meshes[m].slots {
                if s.discrete[self.meshes[m].slot(slot)] != 0.0 {
                    self.engage(s, m, slot, false);
                }
            }
        }
        s.discrete[0] = f64::from(u8::from(located && self.locates));
        for i in 0..self.meshes.len() {
            let mesh = &self.meshes[i];
            let range = mesh.search_discrete();
            if let Some(pairs) = mesh.search.pairs() {
                let mut zone = vec![0.0; range.len()];
                let (a, _) = parties(&self.gears, mesh, s.at());
                pairs.begin(a, &mut zone);
                s.discrete[range].copy_from_slice(&zone);
            }
            for slot in 0..mesh.slots {
                let at = mesh.slot(slot);
                s.discrete[at] = 0.0;
                s.discrete[at + 1] = 0.0;
            }
        }
        self.refresh_modes(s, None);
    }

    fn transition(&mut self, s: &mut State, event: usize) -> Change {
        let m = self
            .meshes
            .iter()
            .rposition(|mesh| event >= mesh.event_functions)
            .unwrap_or(0);
        let mesh = &self.meshes[m];
        let local = event - mesh.event_functions;
        let zones = mesh.zones;
        if local < zones {
            let range = mesh.search_discrete();
            let Some(pairs) = mesh.search.pairs() else {
                return Change::None;
            };
            // A pair that leaves is no candidate any more: look at it before.
            let mut listed = std::mem::take(&mut self.work.listed);
            listed.clear();
            let (a, b) = parties(&self.gears, mesh, s.at());
            let discrete = &s.discrete[range.clone()];
            pairs.candidates(a, b, discrete, Wanted::Listed, &mut listed);
            let change = pairs.transition(local, &mut s.discrete[range]);
            let leaving = change
                .left
                .and_then(|slot| listed.iter().find(|c| c.slot == slot).copied());
            self.work.listed = listed;
            if let Some(slot) = change.left {
                let at = self.meshes[m].slot(slot);
                if let Some(c) = leaving.filter(|_| s.discrete[at] != 0.0) {
                    self.tell(s, m, &c, false);
                }
                s.discrete[at] = 0.0;
                s.discrete[at + 1] = 0.0;
            }
            if let Some(slot) = change.entered {
                self.refresh_modes(s, Some((m, slot)));
            }
        } else {
            let slot = local - zones;
            let at = mesh.slot(slot);
            let closing = s.discrete[at] == 0.0;
            // A contact that a damper releases early keeps its impact speed until the flanks part.
            let apart = self
                .find(s, m, slot)
                .is_none_or(|c| c.gap >= -1e-6 * self.magnitudes.deflection);
            if closing {
                if apart || s.discrete[at + 1] <= 0.0 {
                    let speed = self.approach_speed(s, m, slot);
                    s.discrete[at + 1] = speed;
                }
                s.discrete[at] = 1.0;
            } else {
                s.discrete[at] = 0.0;
                if apart {
                    s.discrete[at + 1] = 0.0;
                }
            }
            self.engage(s, m, slot, closing);
        }
        Change::Restart
    }

    fn commit(&mut self, s: &mut State) -> Change {
        let mut change = Change::None;
        for g in &mut self.gears {
            let range = g.range();
            let State { t, q, v, discrete } = s;
            let own = &mut discrete[g.discrete.0..][..g.discrete.1];
            let Some(teeth) = g.model.teeth() else {
                continue;
            };
            if teeth.commit(*t, &mut q[range.clone()], &mut v[range], own) == Change::Restart {
                change = Change::Restart;
            }
        }
        if s.discrete[0] == 0.0 && self.tracks {
            self.track_modes(s);
        }
        if self.cuts_vibration && self.cut_off_vibration(s) {
            change = Change::Restart;
        }
        change
    }
}

impl FreeFlight for Scene {
    fn flight_path(&mut self, s: &State, later: f64, path: &mut FlightPath) -> f64 {
        self.path_from(s.at(), later, path)
    }

    fn steady_work(&mut self, from: At<'_>, to: At<'_>) -> Option<f64> {
        self.work_of_flight(from, to)
    }
}

impl Report for Scene {
    fn has_powers(&self) -> bool {
        let gear = |g: &SceneGear| g.model.hub().has_powers() || !g.loads.is_empty();
        // Stiffness along the path puts power in; points of flanks have a constant penalty.
        self.gears.iter().any(gear)
            || self.meshes.iter().any(|m| {
                m.search.pairs().is_some() || m.law.is_dissipative() || m.friction.is_some()
            })
    }

    fn has_jumps(&self) -> bool {
        // Dampers of modes and loads on hubs let no contact force jump.
        self.meshes
            .iter()
            .any(|m| m.search.pairs().is_some() || m.law.is_dissipative() || m.friction.is_some())
    }

    fn channels(&self) -> &[String] {
        &self.channels
    }

    fn output(&mut self, at: At<'_>, out: &mut Outputs) {
        self.fill_output(at, out);
    }
}

/// Length of the transverse part of a candidate's normal.
fn transverse(c: &Candidate) -> f64 {
    c.normal.x.hypot(c.normal.y)
}

fn gap_rate(
    gears: &[super::SceneGear],
    mesh: &super::SceneMesh,
    c: &Candidate,
    at: At<'_>,
    row: &mut Row,
) -> f64 {
    let (a, b) = parties(gears, mesh, at);
    let [_, prescribed] = gap_row(gears, mesh, [&a, &b], c, row);
    row.dot(at.v) + prescribed
}

impl Scene {
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

    /// Event functions of a mesh's closed or overlapping contacts with a damper, from the force.
    fn damped_events(&mut self, at: At<'_>, m: usize, wanted: Wanted<'_>, out: &mut [f64]) {
        let Scene {
            gears,
            meshes,
            work,
            ..
        } = self;
        let mesh = &meshes[m];
        let (a, b) = parties(gears, mesh, at);
        let modes = &at.discrete[mesh.modes()];
        let slots = &mut out[mesh.event_functions + mesh.zones..];
        work.candidates.clear();
        mesh.search.candidates(
            a,
            b,
            &at.discrete[mesh.search_discrete()],
            wanted,
            &mut work.candidates,
        );
        for c in &work.candidates {
            let (mode, stored) = (modes[2 * c.slot], modes[2 * c.slot + 1]);
            if mode == 0.0 && c.gap > 0.0 {
                continue;
            }
            let rate = gap_rate(gears, mesh, c, at, &mut work.scratch);
            let v0 = if stored > 0.0 { stored } else { -rate };
            slots[c.slot] = if mode != 0.0 {
                let n = mesh.law.smooth(c.gap, rate, v0, c.stiffness).n;
                as_length(&mesh.law, n, c.stiffness)
            } else {
                open_event(&mesh.law, c, c.gap, rate, v0)
            };
        }
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

    /// Sets the modes of all slots (or of one) from the clipped force at a state.
    fn refresh_modes(&mut self, s: &mut State, only: Option<(usize, usize)>) {
        for m in 0..self.meshes.len() {
            if self.meshes[m].slots == 0 {
                continue;
            }
            let mut found = std::mem::take(&mut self.work.candidates);
            found.clear();
            let mesh = &self.meshes[m];
            let (a, b) = parties(&self.gears, mesh, s.at());
            let discrete = &s.discrete[mesh.search_discrete()];
            mesh.search
                .candidates(a, b, discrete, Wanted::Listed, &mut found);
            for c in &found {
                if only.is_some_and(|x| x != (m, c.slot)) {
                    continue;
                }
                let mesh = &self.meshes[m];
                let rate = gap_rate(&self.gears, mesh, c, s.at(), &mut self.work.scratch);
                let pushes = mesh.law.clipped(c.gap, rate, -rate, c.stiffness).n > 0.0
                    // Touching and approaching counts as closed, or the first step would start open.
                    || (c.gap <= 0.0 && rate < 0.0);
                if pushes {
                    let slot = mesh.slot(c.slot);
                    s.discrete[slot] = 1.0;
                    s.discrete[slot + 1] = (-rate).max(0.0);
                    let slot = c.slot;
                    self.engage(s, m, slot, true);
                }
            }
            self.work.candidates = found;
        }
    }

    /// Without event location: impact speeds and engagement follow the accepted states.
    fn track_modes(&mut self, s: &mut State) {
        for m in 0..self.meshes.len() {
            if self.meshes[m].slots == 0 {
                continue;
            }
            let mut found = std::mem::take(&mut self.work.candidates);
            found.clear();
            let mesh = &self.meshes[m];
            let (a, b) = parties(&self.gears, mesh, s.at());
            let discrete = &s.discrete[mesh.search_discrete()];
            mesh.search
                .candidates(a, b, discrete, Wanted::Touching(0.0), &mut found);
            for slot in 0..mesh.slots {
                let touching = found.iter().find(|c| c.slot == slot && c.gap < 0.0);
                let at = self.meshes[m].slot(slot);
                match touching {
                    Some(c) if s.discrete[at] == 0.0 => {
                        let rate = gap_rate(
                            &self.gears,
                            &self.meshes[m],
                            c,
                            s.at(),
                            &mut self.work.scratch,
                        );
                        s.discrete[at] = 1.0;
                        s.discrete[at + 1] = (-rate).max(0.0);
                        self.engage(s, m, slot, true);
                    }
                    None if s.discrete[at] != 0.0 => {
                        s.discrete[at] = 0.0;
                        s.discrete[at + 1] = 0.0;
                        self.engage(s, m, slot, false);
                    }
                    _ => {}
                }
            }
            self.work.candidates = found;
        }
    }

    fn find(&mut self, s: &State, m: usize, slot: usize) -> Option<Candidate> {
        let mesh = &self.meshes[m];
        let (a, b) = parties(&self.gears, mesh, s.at());
        let mut found = std::mem::take(&mut self.work.candidates);
        found.clear();
        let wanted = if s.discrete[0] != 0.0 {
            Wanted::Listed
        } else {
            Wanted::Touching(f64::INFINITY)
        };
        let discrete = &s.discrete[mesh.search_discrete()];
        mesh.search.candidates(a, b, discrete, wanted, &mut found);
        let c = found.iter().find(|c| c.slot == slot).copied();
        self.work.candidates = found;
        c
    }

    fn approach_speed(&mut self, s: &State, m: usize, slot: usize) -> f64 {
        let Some(c) = self.find(s, m, slot) else {
            return 0.0;
        };
        let rate = gap_rate(
            &self.gears,
            &self.meshes[m],
            &c,
            s.at(),
            &mut self.work.scratch,
        );
        (-rate).max(0.0)
    }

    /// Tells both gears that a contact of a slot closed or opened.
    fn engage(&mut self, s: &mut State, m: usize, slot: usize, closed: bool) {
        if let Some(c) = self.find(s, m, slot) {
            self.tell(s, m, &c, closed);
        }
    }

    fn tell(&mut self, s: &mut State, m: usize, c: &Candidate, closed: bool) {
        let (teeth, side) = self.meshes[m].search.flank_of(c);
        for k in 0..2 {
            let g = &mut self.gears[self.meshes[m].gears[k]];
            let own = &mut s.discrete[g.discrete.0..][..g.discrete.1];
            if let Some(coordinates) = g.model.teeth() {
                coordinates.engage(own, teeth[k], side, closed);
            }
        }
    }
}
