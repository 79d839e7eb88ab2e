//! The scene as independent oscillators and a remainder, for methods that are exact for the linear part.

use super::assembled::Scene;
use crate::gear::LinearMotion;
use gearbench_integrators::system::{
    Events, HalfStepImpulse, ModalSplit, SecondOrderSystem, State, StateView,
};

/// Reason why the coordinates of a scene are not independent oscillators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coupling {
    /// A carrier rotates with its gears and couples them.
    Carrier,
    /// Gyroscopic terms couple the directions of a gear on its bearing.
    Gyroscopic(usize),
    /// Coriolis forces couple the modes of a gear.
    Coriolis(usize),
    /// The bearing of a gear has clearance, or couples its directions.
    Bearing(usize),
    /// The coordinates of a gear are not those of a linear body.
    Gear(usize),
    /// A rigid shaft joins coordinates that oscillate.
    Shaft,
}

impl Scene {
    /// Returns the reason why the coordinates are not independent oscillators, or `None` where they are.
    pub fn coupling(&self) -> Option<Coupling> {
        if self.oscillators {
            return None;
        }
        let of = |i: usize| match self.gears[i].model.linear() {
            None => Some(Coupling::Gear(i)),
            Some(l) if l.oscillators().is_some() => None,
            Some(l) if l.spins() => Some(Coupling::Coriolis(i)),
            Some(_)
                if self.gears[i]
                    .model
                    .hub()
                    .lateral
                    .as_ref()
                    .is_some_and(|l| l.spins) =>
            {
                Some(Coupling::Gyroscopic(i))
            }
            Some(_) => Some(Coupling::Bearing(i)),
        };
        // What no setting of a gear changes comes first.
        let coupled = (0..self.gears.len()).filter_map(of);
        match self.carriers.is_empty() {
            false => Some(Coupling::Carrier),
            true => coupled.reduce(|a, b| match (a, b) {
                (_, b @ Coupling::Gear(_)) if !matches!(a, Coupling::Gear(_)) => b,
                (a, _) => a,
            }),
        }
        .or(Some(Coupling::Shaft))
    }
}

impl ModalSplit for Scene {
    fn oscillators(&self, omega: &mut [f64], zeta: &mut [f64]) {
        for g in &self.gears {
            if let Some(o) = g.model.linear().and_then(LinearMotion::oscillators) {
                omega[g.range()].copy_from_slice(o.omega);
                zeta[g.range()].copy_from_slice(o.zeta);
            }
        }
    }

    fn prepare(&mut self, quasi_static: &[f64]) {
        for g in &self.gears {
            if let Some(linear) = g.model.linear() {
                linear.set_quasi_static_correction(Some(&quasi_static[g.range()]));
            }
        }
        self.work.nodal.forget();
        self.work.reported.forget();
    }

    fn starts_balanced(&self, s: &State) -> bool {
        let start = &self.initial;
        self.balanced && s.t == start.t && s.q == start.q && s.v == start.v
    }

    fn remainder(&mut self, at: StateView<'_>, a: &mut [f64]) {
        a.fill(0.0);
        for g in &self.gears {
            g.add_load(at, a);
            if let Some(linear) = g.model.linear() {
                linear.add_other_forces(g.at(at), &mut a[g.range()]);
            }
        }
        self.add_shafts(at, a);
        self.add_contacts(at, a);
        self.hold_shafts(at, a);
        self.solve_mass(at, a);
    }

    fn remainder_after(&mut self, at: StateView<'_>, impulse: &HalfStepImpulse<'_>, a: &mut [f64]) {
        if !self.implicit_dissipation {
            return self.remainder(at, a);
        }
        a.fill(0.0);
        for g in &self.gears {
            g.add_load(at, a);
            if let Some(linear) = g.model.linear() {
                linear.add_other_forces(g.at(at), &mut a[g.range()]);
            }
        }
        self.add_shafts(at, a);
        self.evaluate_after(at, impulse, a);
        self.add_contact_forces(a);
        self.solve_mass(at, a);
    }

    fn steady(&mut self, at: StateView<'_>, a: &mut [f64]) -> f64 {
        a.fill(0.0);
        if !self.shafts.is_empty() {
            return at.t;
        }
        for g in &self.gears {
            let swings_aside = g.model.hub().lateral.is_some() && g.model.displacement().is_some();
            if swings_aside || g.steady_load(at.t).is_none() {
                return at.t;
            }
            g.add_load(at, a);
            if let Some(linear) = g.model.linear() {
                linear.add_other_forces(g.at(at), &mut a[g.range()]);
            }
        }
        self.solve_mass(at, a);
        self.next_breakpoint(at.t)
    }

    fn free_until(&mut self, s: &State) -> f64 {
        self.flight_until(s.at())
    }
}
