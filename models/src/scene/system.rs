//! The scene as a second-order system: force, mass, tangent, capabilities.

use super::active::moves;
use super::assembled::Scene;
use super::members::{SceneGear, SceneMesh};
use crate::gear::LargeGear;
use gearbench_integrators::FlightPath;
use gearbench_integrators::system::{
    Coeffs, Events, FreeFlight, HalfStepImpulse, Layout, MemberContact, ModalSplit, Outputs,
    Report, SecondOrderSystem, Singular, State, StateView,
};

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

    fn characteristic_time(&self, _at: StateView<'_>) -> f64 {
        self.characteristic_time
    }

    fn force(&mut self, at: StateView<'_>, f: &mut [f64]) {
        self.force_without_contact(at, f);
        self.add_relative_forces(at, f);
        self.hold_shafts(at, f);
    }

    fn force_after(&mut self, at: StateView<'_>, impulse: &HalfStepImpulse<'_>, f: &mut [f64]) {
        if !self.implicit_dissipation {
            return self.force(at, f);
        }
        self.force_without_contact(at, f);
        self.evaluate_after(at, impulse, f);
        self.add_contact_forces(f);
    }

    fn solve_mass(&mut self, at: StateView<'_>, f_to_a: &mut [f64]) {
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

    fn apply_mass(&mut self, at: StateView<'_>, x: &[f64], y: &mut [f64]) {
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

    fn correct(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        rhs_to_x: &mut [f64],
    ) -> Result<(), Singular> {
        self.newton_correction(at, c, rhs_to_x)
    }

    fn factorisations(&self) -> Option<u64> {
        let large = self.gears.iter().filter_map(|g| g.model.large());
        let kept = large.map(LargeGear::factorisations);
        kept.reduce(|a, b| a + b)
    }

    fn tangent_times(&mut self, at: StateView<'_>, dq: &[f64], dv: &[f64], df: &mut [f64]) {
        df.fill(0.0);
        self.add_shaft_tangent(at, [dq, dv], df);
        for (i, g) in self.gears.iter_mut().enumerate() {
            let own = g.at(at);
            let range = g.range();
            if !self.carriers.carries(i) {
                g.model.tangent(
                    own,
                    &dq[range.clone()],
                    &dv[range.clone()],
                    &mut df[range.clone()],
                );
            }
            let hub = g.model.hub();
            if hub.is_free() && !g.loads.is_empty() {
                let along = StateView {
                    v: &dv[range.clone()],
                    ..own
                };
                let load = -g.viscous() * hub.load_speed(along);
                hub.add_load(load, &mut df[range]);
            }
        }
        if self.in_space || !self.carriers.is_empty() {
            self.add_contact_differences(at, [dq, dv], df);
            self.hold_shafts(at, df);
            return;
        }
        self.evaluate_contacts(at);
        if self.tangents_of_contacts(at).is_err() {
            df.fill(f64::NAN);
        }
        let work = &self.work;
        for (i, (a, rows)) in work.active.iter().zip(&work.rows).enumerate() {
            let t = &work.tangents[i];
            let d = rows[0].dot_parts(dq);
            let of_rate = t.rate * rows[0].dot(dv);
            let by = |row: [f64; 2]| row[0] * d[0] + row[1] * d[1] + of_rate;
            let (mut on, mut normal) = (t.on.map(by), by(t.normal));
            for answer in work.couplings_of(i) {
                let [k, l] = work.tangents[answer.to].elastic;
                let d = work.rows[answer.to][0].dot_parts(dq);
                let elastic = k * d[0] + l * d[1];
                normal += answer.normal * elastic;
                on = [0, 1].map(|k| on[k] + answer.on[k] * elastic);
            }
            rows[0].add_parts_to(on, df);
            if self.meshes[a.mesh].friction.is_some() {
                // The contact point moves along the line of action and takes the sliding row with it.
                let candidate = &work.candidates[a.candidate];
                let ds = moves(&self.meshes[a.mesh], candidate, d);
                let turn = rows[2].dot(at.v) - rows[1].dot(at.v);
                let dslide = rows[1].dot(dv) + ds * turn;
                let dforce = a.friction.df_dn * normal + a.friction.df_dv * dslide;
                rows[1].add_to(dforce - ds * a.friction.f, df);
                rows[2].add_to(ds * a.friction.f, df);
            }
        }
        if self.fields {
            self.add_nodal_tangent([dq, dv], df);
        }
        self.hold_shafts(at, df);
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

impl Scene {
    /// Computes internal forces, loads and forces of elastic shafts; the internal forces of gears on carriers are
    /// added with the contacts.
    fn force_without_contact(&mut self, at: StateView<'_>, f: &mut [f64]) {
        f.fill(0.0);
        self.add_shafts(at, f);
        for (i, g) in self.gears.iter_mut().enumerate() {
            if g.internal && !self.carriers.carries(i) {
                let own = g.at(at);
                let range = g.range();
                g.model.forces(own, &mut f[range]);
            }
            match g.constant_load {
                Some(load) => f[g.offset] += load,
                None => g.add_load(at, f),
            }
        }
    }

    /// Adds the tangent of contacts whose rows rotate with the gears or their carriers, by central differences.
    fn add_contact_differences(
        &mut self,
        at: StateView<'_>,
        [dq, dv]: [&[f64]; 2],
        df: &mut [f64],
    ) {
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let (moved, sped) = (largest(dq), largest(dv));
        // A hundredth of a typical deflection keeps to one branch of the law and clear of rounding.
        let steps = [
            1e-2 * self.magnitudes.deflection / moved.max(f64::MIN_POSITIVE),
            1e-2 * self.magnitudes.speed / sped.max(f64::MIN_POSITIVE),
        ];
        let mut f = vec![0.0; df.len()];
        for (k, largest) in [moved, sped].into_iter().enumerate() {
            if largest == 0.0 {
                continue;
            }
            for sign in [1.0, -1.0] {
                let h = sign * steps[k];
                let by = |x: &[f64], dx: &[f64], acts: bool| -> Vec<f64> {
                    let h = if acts { h } else { 0.0 };
                    x.iter().zip(dx).map(|(x, dx)| x + h * dx).collect()
                };
                let (q, v) = (by(at.q, dq, k == 0), by(at.v, dv, k == 1));
                f.fill(0.0);
                self.add_relative_forces(StateView { q: &q, v: &v, ..at }, &mut f);
                for (df, f) in df.iter_mut().zip(&f) {
                    *df += 0.5 / h * f;
                }
            }
        }
    }

    /// Evaluates the contacts at the end of a half-step impulse, in addition to forces without contact: dashpots and
    /// friction implicitly.
    pub(super) fn evaluate_after(
        &mut self,
        at: StateView<'_>,
        impulse: &HalfStepImpulse<'_>,
        without: &[f64],
    ) {
        let starting = &mut self.work.nodal.impulse;
        starting.set(impulse, without, &self.inverse_mass);
        starting.acts = true;
        self.evaluate_contacts(at);
        self.work.nodal.impulse.acts = false;
    }
}

impl FreeFlight for Scene {
    fn flight_path(&mut self, s: &State, later: f64, path: &mut FlightPath) -> f64 {
        self.path_from(s.at(), later, path)
    }

    fn steady_work(&mut self, from: StateView<'_>, to: StateView<'_>) -> Option<f64> {
        self.work_of_flight(from, to)
    }
}

impl Report for Scene {
    fn has_powers(&self) -> bool {
        let gear = |g: &SceneGear| g.model.hub().has_powers() || !g.loads.is_empty();
        // Elastic contact has a potential.
        self.gears.iter().any(gear)
            || self.meshes.iter().any(SceneMesh::dissipates)
            || self.shafts.damped
    }

    fn has_jumps(&self) -> bool {
        // Dampers of modes and loads on hubs let no contact force jump.
        self.meshes
            .iter()
            .any(|m| m.search.pairs().is_some() || m.dissipates())
    }

    fn channels(&self) -> &[String] {
        &self.channels
    }

    fn output(&mut self, at: StateView<'_>, out: &mut Outputs) {
        self.fill_output(at, out, true);
    }

    fn sample(&mut self, at: StateView<'_>, out: &mut Outputs) {
        self.fill_output(at, out, false);
    }

    fn work_of_loads(&mut self, from: StateView<'_>, to: StateView<'_>) -> Option<f64> {
        Some(self.loads_between(from, to))
    }

    fn touches(&mut self, at: StateView<'_>, out: &mut Vec<MemberContact>) {
        self.with_carrier_state(at, |scene, carrier_state| {
            scene.fill_touches(carrier_state, out)
        });
    }
}
