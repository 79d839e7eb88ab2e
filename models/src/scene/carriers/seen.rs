//! Evaluation of a scene in the carrier frame: forces, events, frames of hubs.

use super::relative::RelativeState;
use crate::kinematics::HubFrame;
use crate::scene::assembled::Scene;
use gearbench_integrators::system::{At, SecondOrderSystem, State};

impl Scene {
    /// Calls `act` with the state for contacts: the carrier-frame state where there are carriers, otherwise the state
    /// itself.
    pub(in crate::scene) fn seen<R>(
        &mut self,
        at: At<'_>,
        act: impl FnOnce(&mut Self, At<'_>) -> R,
    ) -> R {
        if self.carriers.is_empty() {
            return act(self, at);
        }
        let mut relative = std::mem::take(&mut self.work.relative);
        self.carriers.see(at, &mut relative);
        let seen = At {
            q: &relative.q,
            v: &relative.v,
            ..at
        };
        let result = act(self, seen);
        self.work.relative = relative;
        result
    }

    /// Calls `act` with a carrier-frame state whose discrete part may change.
    pub(in crate::scene) fn seen_state<R>(
        &mut self,
        s: &mut State,
        act: impl FnOnce(&mut Self, &mut State) -> R,
    ) -> R {
        if self.carriers.is_empty() {
            return act(self, s);
        }
        let mut relative = RelativeState::default();
        self.carriers.see(s.at(), &mut relative);
        let mut seen = State {
            t: s.t,
            q: relative.q,
            v: relative.v,
            discrete: std::mem::take(&mut s.discrete),
        };
        let result = act(self, &mut seen);
        s.discrete = seen.discrete;
        result
    }

    /// Adds the forces that `act` computes in the carrier frame.
    #[inline]
    pub(in crate::scene) fn relative_forces(
        &mut self,
        at: At<'_>,
        f: &mut [f64],
        act: impl FnOnce(&mut Self, At<'_>, &mut [f64]),
    ) {
        if self.carriers.is_empty() {
            return act(self, at, f);
        }
        let mut relative = std::mem::take(&mut self.work.relative);
        self.carriers.see(at, &mut relative);
        let RelativeState { q, v, f: own } = &mut relative;
        own.clear();
        own.resize(f.len(), 0.0);
        act(self, At { q, v, ..at }, own);
        self.carriers.pull_back(at, &relative, f);
        self.work.relative = relative;
    }

    /// Adds the forces of contacts, and the internal forces of gears on carriers.
    #[inline]
    pub(in crate::scene) fn add_relative_forces(&mut self, at: At<'_>, f: &mut [f64]) {
        self.relative_forces(at, f, |scene, seen, f| {
            scene.add_carried_forces(seen, f);
            scene.add_contacts(seen, f);
        });
    }

    /// Adds internal forces of gears on carriers, in the carrier frame.
    pub(in crate::scene) fn add_carried_forces(&mut self, seen: At<'_>, f: &mut [f64]) {
        if self.carriers.is_empty() {
            return;
        }
        for (i, g) in self.gears.iter_mut().enumerate() {
            if self.carriers.carries(i) && g.internal {
                let (own, range) = (g.at(seen), g.range());
                g.model.forces(own, &mut f[range]);
            }
        }
    }

    /// Sets the velocities of gears on carriers to those of their pins.
    pub fn follow_carriers(&self, s: &mut State) {
        self.carriers.carry_along(s);
    }

    /// Adds the centrifugal forces of gears that rotate with their carriers at the present speeds.
    pub fn add_centrifugal(&mut self, at: At<'_>, f: &mut [f64]) {
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
        let mut relative = RelativeState::default();
        self.carriers.see(s.at(), &mut relative);
        let RelativeState { q, v, .. } = relative;
        State {
            q,
            v,
            t: s.t,
            discrete: s.discrete.clone(),
        }
    }

    /// Returns the axes of a hub, not rotated with the gear, and its origin in space [m].
    pub fn hub_frame(&mut self, gear: usize, at: At<'_>) -> HubFrame {
        let frame = self.seen(at, |scene, seen| {
            let g = &scene.gears[gear];
            let own = g.at(seen);
            g.model.hub().hub.frame(own.t, own.q)
        });
        self.carriers.frame(gear, at, frame)
    }
}
