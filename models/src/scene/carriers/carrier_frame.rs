//! Evaluation of a scene in the carrier frame: forces, events, frames of hubs.

use super::relative::CarrierFrameState;
use crate::kinematics::HubFrame;
use crate::scene::assembled::Scene;
use gearbench_integrators::system::{SecondOrderSystem, State, StateView};

impl Scene {
    /// Calls `act` with the state for contacts: the carrier-frame state where there are carriers, otherwise the state
    /// itself.
    pub(in crate::scene) fn with_carrier_state<R>(
        &mut self,
        at: StateView<'_>,
        act: impl FnOnce(&mut Self, StateView<'_>) -> R,
    ) -> R {
        if self.carriers.is_empty() {
            return act(self, at);
        }
        let mut relative = std::mem::take(&mut self.work.relative);
        self.carriers.to_carrier_frame(at, &mut relative);
        let carrier_state = StateView {
            q: &relative.q,
            v: &relative.v,
            ..at
        };
        let result = act(self, carrier_state);
        self.work.relative = relative;
        result
    }

    /// Calls `act` with a carrier-frame state whose discrete part may change.
    pub(in crate::scene) fn with_mut_carrier_state<R>(
        &mut self,
        s: &mut State,
        act: impl FnOnce(&mut Self, &mut State) -> R,
    ) -> R {
        if self.carriers.is_empty() {
            return act(self, s);
        }
        let mut relative = CarrierFrameState::default();
        self.carriers.to_carrier_frame(s.at(), &mut relative);
        let mut carrier_state = State {
            t: s.t,
            q: relative.q,
            v: relative.v,
            discrete: std::mem::take(&mut s.discrete),
        };
        let result = act(self, &mut carrier_state);
        s.discrete = carrier_state.discrete;
        result
    }

    /// Adds the forces that `act` computes in the carrier frame.
    #[inline]
    pub(in crate::scene) fn relative_forces(
        &mut self,
        at: StateView<'_>,
        f: &mut [f64],
        act: impl FnOnce(&mut Self, StateView<'_>, &mut [f64]),
    ) {
        if self.carriers.is_empty() {
            return act(self, at, f);
        }
        let mut relative = std::mem::take(&mut self.work.relative);
        self.carriers.to_carrier_frame(at, &mut relative);
        let CarrierFrameState { q, v, f: own } = &mut relative;
        own.clear();
        own.resize(f.len(), 0.0);
        act(self, StateView { q, v, ..at }, own);
        self.carriers.pull_back(at, &relative, f);
        self.work.relative = relative;
    }

    /// Adds the forces of contacts, and the internal forces of gears on carriers.
    #[inline]
    pub(in crate::scene) fn add_relative_forces(&mut self, at: StateView<'_>, f: &mut [f64]) {
        self.relative_forces(at, f, |scene, carrier_state, f| {
            scene.add_carried_forces(carrier_state, f);
            scene.add_contacts(carrier_state, f);
        });
    }

    /// Adds internal forces of gears on carriers, in the carrier frame.
    pub(in crate::scene) fn add_carried_forces(
        &mut self,
        carrier_state: StateView<'_>,
        f: &mut [f64],
    ) {
        if self.carriers.is_empty() {
            return;
        }
        for (i, g) in self.gears.iter_mut().enumerate() {
            if self.carriers.carries(i) && g.internal {
                let (own, range) = (g.at(carrier_state), g.range());
                g.model.forces(own, &mut f[range]);
            }
        }
    }

    /// Sets the velocities of gears on carriers to those of their pins.
    pub fn follow_carriers(&self, s: &mut State) {
        self.carriers.carry_along(s);
    }

    /// Adds the centrifugal forces of gears that rotate with their carriers at the present speeds.
    pub fn add_centrifugal(&mut self, at: StateView<'_>, f: &mut [f64]) {
        if self.carriers.is_empty() {
            return;
        }
        let mut a = vec![0.0; f.len()];
        self.carriers.centripetal(at, &mut a);
        let mut inertia = vec![0.0; f.len()];
        self.apply_mass(at, &a, &mut inertia);
        f.iter_mut().zip(&inertia).for_each(|(f, i)| *f -= i);
    }

    /// Returns true if a gear rotates with a carrier.
    pub fn is_carried(&self, gear: usize) -> bool {
        self.carriers.carries(gear)
    }

    /// Returns the coordinate of the carrier of a mesh, and its index among the members of the scene.
    pub fn carrier_of_mesh(&self, mesh: usize) -> Option<(usize, usize)> {
        let carrier = self.carriers.carrier_of(mesh)?;
        let body = self
            .gears
            .iter()
            .position(|g| g.offset == carrier.turn && g.n > 0)?;
        Some((carrier.turn, body))
    }

    /// Returns the carrier-frame state.
    pub fn relative_state(&self, s: &State) -> State {
        let mut relative = CarrierFrameState::default();
        self.carriers.to_carrier_frame(s.at(), &mut relative);
        let CarrierFrameState { q, v, .. } = relative;
        State {
            q,
            v,
            t: s.t,
            discrete: s.discrete.clone(),
        }
    }

    /// Returns the axes of a hub, not rotated with the gear, and its origin in space [m].
    pub fn hub_frame(&mut self, gear: usize, at: StateView<'_>) -> HubFrame {
        let frame = self.with_carrier_state(at, |scene, carrier_state| {
            let g = &scene.gears[gear];
            let own = g.at(carrier_state);
            g.model.hub().hub.frame(own.t, own.q)
        });
        self.carriers.frame(gear, at, frame)
    }
}
