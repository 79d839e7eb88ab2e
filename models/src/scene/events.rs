//! Events of a scene: event functions, transitions of contacts and zones, and the history in the discrete state.

use super::active::gap_rate;
use super::assembled::Scene;
use super::members::gear_states;
use crate::contact::pairs::all_open;
use crate::contact::{Candidate, CandidateSelection};
use crate::law::{CLOSED, OPEN, UNTOUCHED, touch_speed};
use crate::spec::Load;
use gearbench_integrators::system::{Change, Events, State, StateView};

impl Events for Scene {
    fn event_functions(&mut self, at: StateView<'_>, out: &mut [f64]) {
        out.fill(1.0);
        if out.is_empty() {
            return;
        }
        let (contacts, guides) = out.split_at_mut(self.guide_events);
        self.watch_guides(at, guides);
        self.with_carrier_state(at, |scene, carrier_state| {
            scene.watch(carrier_state, contacts)
        });
    }

    fn next_breakpoint(&self, t: f64) -> f64 {
        let mut next = f64::INFINITY;
        for g in &self.gears {
            next = next.min(g.model.hub().next_breakpoint(t));
            for l in &g.loads {
                if let Load::Applied(p) = l {
                    next = next.min(p.next_breakpoint(t));
                }
            }
        }
        for ground in self.shafts.grounds() {
            next = next.min(ground.next_breakpoint(t));
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
        self.work.reported.forget();
        self.with_mut_carrier_state(s, Self::let_go);
        s.discrete[0] = f64::from(u8::from(located && self.locates));
        self.with_mut_carrier_state(s, Self::begin_contacts);
        self.begin_guides(s);
    }

    fn transition(&mut self, s: &mut State, event: usize) -> Change {
        match event.checked_sub(self.guide_events) {
            Some(guide) => self.turn_guide(s, guide),
            None => self.with_mut_carrier_state(s, |scene, carrier_state| {
                scene.switch(carrier_state, event)
            }),
        }
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
            self.with_mut_carrier_state(s, Self::track_modes);
        }
        self.remember_guides(s);
        if self.remembers {
            self.with_mut_carrier_state(s, Self::remember_friction);
        }
        change
    }
}

impl Scene {
    /// Disengages the teeth of contacts of an earlier run.
    fn let_go(&mut self, s: &mut State) {
        for m in 0..self.meshes.len() {
            for slot in 0..self.meshes[m].slots {
                if s.discrete[self.meshes[m].slot(slot)] != 0.0 {
                    self.engage(s, m, slot, false);
                }
            }
        }
    }

    /// Switches the contact, zone or guide at an event function.
    fn switch(&mut self, s: &mut State, event: usize) -> Change {
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
            let (a, b) = gear_states(&self.gears, mesh, s.at());
            let discrete = &s.discrete[range.clone()];
            pairs.candidates(a, b, discrete, CandidateSelection::Listed, &mut listed);
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
                s.discrete[at + 1] = UNTOUCHED;
            }
            if let Some(slot) = change.entered {
                self.refresh_modes(s, Some((m, slot)));
            }
        } else {
            let slot = local - zones;
            let at = mesh.slot(slot);
            let closing = s.discrete[at] == 0.0;
            // A contact that a damper releases early keeps its impact speed until the flanks part.
            let found = self.find(s, m, slot);
            let apart = found.is_none_or(|c| c.gap >= -1e-6 * self.magnitudes.deflection);
            if closing {
                if apart || s.discrete[at + 1] < 0.0 {
                    let speed = found.map_or(0.0, |c| self.approach_speed(s, m, &c));
                    s.discrete[at + 1] = speed;
                }
                s.discrete[at] = found.map_or(CLOSED, |c| {
                    let rate = self.rate_of(s, m, &c);
                    let law = self.meshes[m].law.shared(c.share);
                    law.mode(c.gap, rate, c.stiffness)
                });
            } else {
                let rate = found.map_or(0.0, |c| self.rate_of(s, m, &c));
                s.discrete[at] = self.meshes[m].law.mode_after(s.discrete[at], rate);
                if s.discrete[at] != OPEN {
                    return Change::Restart;
                }
                if apart {
                    s.discrete[at + 1] = UNTOUCHED;
                }
            }
            if let Some(c) = found {
                self.tell(s, m, &c, closing);
            }
        }
        Change::Restart
    }

    /// Sets zones and modes of all meshes from a carrier-frame state.
    fn begin_contacts(&mut self, s: &mut State) {
        for i in 0..self.meshes.len() {
            let mesh = &self.meshes[i];
            let range = mesh.search_discrete();
            if let Some(pairs) = mesh.search.pairs() {
                let mut zone = vec![0.0; range.len()];
                let (a, b) = gear_states(&self.gears, mesh, s.at());
                pairs.begin(a, b, &mut zone);
                s.discrete[range].copy_from_slice(&zone);
            }
            for slot in 0..mesh.slots {
                let at = mesh.slot(slot);
                s.discrete[at] = OPEN;
                s.discrete[at + 1] = UNTOUCHED;
            }
        }
        self.begin_friction(s);
        self.refresh_modes(s, None);
    }

    /// Computes the event functions at a carrier-frame state.
    fn watch(&mut self, at: StateView<'_>, out: &mut [f64]) {
        for m in 0..self.meshes.len() {
            if self.watch_directly(at, m, out) {
                continue;
            }
            let mesh = &self.meshes[m];
            let (a, b) = gear_states(&self.gears, mesh, at);
            let (zone, slots) =
                out[mesh.event_functions..][..mesh.zones + mesh.slots].split_at_mut(mesh.zones);
            let Some(pairs) = mesh.search.pairs() else {
                continue;
            };
            let discrete = &at.discrete[mesh.search_discrete()];
            let modes = &at.discrete[mesh.modes()];
            let closed = !all_open(modes);
            // Forces of closed contacts tell when they end; each pair is searched once for force and gap.
            if closed && (mesh.law.is_dissipative() || pairs.couples()) {
                pairs.watch_zones(a, b, discrete, zone);
                let selection = if pairs.couples() {
                    CandidateSelection::Watched(modes)
                } else {
                    CandidateSelection::Listed
                };
                self.damped_events(at, m, selection, out);
                continue;
            }
            // Gaps are all that open contacts and contacts without damping need.
            pairs.watch(a, b, discrete, zone, slots);
            let mut overlap = false;
            for (g, mode) in slots.iter_mut().zip(modes.chunks_exact(2)) {
                if mode[0] != OPEN {
                    *g = -*g;
                } else {
                    overlap |= *g <= 0.0;
                }
            }
            if overlap && mesh.law.is_dissipative() {
                self.damped_events(at, m, CandidateSelection::Listed, out);
            }
        }
    }

    /// Computes event functions of a mesh's closed or overlapping contacts with a damper from the force.
    fn damped_events(
        &mut self,
        at: StateView<'_>,
        m: usize,
        selection: CandidateSelection<'_>,
        out: &mut [f64],
    ) {
        let Scene {
            gears,
            meshes,
            work,
            ..
        } = self;
        let mesh = &meshes[m];
        let (a, b) = gear_states(gears, mesh, at);
        let modes = &at.discrete[mesh.modes()];
        let slots = &mut out[mesh.event_functions + mesh.zones..];
        work.candidates.clear();
        mesh.search.candidates(
            a,
            b,
            &at.discrete[mesh.search_discrete()],
            selection,
            &mut work.candidates,
        );
        for c in &work.candidates {
            let (mode, stored) = (modes[2 * c.slot], modes[2 * c.slot + 1]);
            if mode == 0.0 && c.gap > 0.0 {
                slots[c.slot] = c.gap;
                continue;
            }
            let rate = gap_rate(gears, mesh, c, at, &mut work.scratch);
            let v0 = touch_speed(stored, rate);
            let law = mesh.law.shared(c.share);
            slots[c.slot] = if mode != 0.0 {
                law.valid_for(mode, c.gap, rate, v0, c.stiffness)
            } else {
                law.until_it_pushes(c.gap, rate, v0, c.stiffness)
            };
        }
    }

    /// Sets the modes of all slots (or of one) from the clipped force at a state.
    fn refresh_modes(&mut self, s: &mut State, only: Option<(usize, usize)>) {
        for m in 0..self.meshes.len() {
            if self.meshes[m].slots == 0 {
                continue;
            }
            let found = self.take_candidates(s, m, CandidateSelection::Listed);
            for c in &found {
                if only.is_some_and(|x| x != (m, c.slot)) {
                    continue;
                }
                let mesh = &self.meshes[m];
                let rate = gap_rate(&self.gears, mesh, c, s.at(), &mut self.work.scratch);
                let law = mesh.law.shared(c.share);
                let pushes = law.clipped(c.gap, rate, -rate, c.stiffness).n > 0.0
                    // Touching and approaching counts as closed, or the first step would start open.
                    || (c.gap <= 0.0 && rate < 0.0);
                if pushes {
                    let slot = mesh.slot(c.slot);
                    s.discrete[slot] = law.mode(c.gap, rate, c.stiffness);
                    s.discrete[slot + 1] = (-rate).max(0.0);
                    let slot = c.slot;
                    self.engage(s, m, slot, true);
                }
            }
            self.work.candidates = found;
        }
    }

    /// Updates impact speeds and engagement from accepted states, without event location.
    fn track_modes(&mut self, s: &mut State) {
        for m in 0..self.meshes.len() {
            if self.meshes[m].slots == 0 {
                continue;
            }
            let found = self.take_candidates(s, m, CandidateSelection::Touching(0.0));
            for slot in 0..self.meshes[m].slots {
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
                        s.discrete[at] = OPEN;
                        s.discrete[at + 1] = UNTOUCHED;
                        self.engage(s, m, slot, false);
                    }
                    _ => {}
                }
            }
            self.work.candidates = found;
        }
    }

    /// Moves the candidates of a mesh out of their buffer, which the caller returns after use.
    fn take_candidates(
        &mut self,
        s: &State,
        m: usize,
        selection: CandidateSelection<'_>,
    ) -> Vec<Candidate> {
        let mut found = std::mem::take(&mut self.work.candidates);
        found.clear();
        let mesh = &self.meshes[m];
        let (a, b) = gear_states(&self.gears, mesh, s.at());
        let discrete = &s.discrete[mesh.search_discrete()];
        mesh.search
            .candidates(a, b, discrete, selection, &mut found);
        found
    }

    fn find(&mut self, s: &State, m: usize, slot: usize) -> Option<Candidate> {
        let selection = if s.discrete[0] != 0.0 {
            CandidateSelection::Listed
        } else {
            CandidateSelection::Touching(f64::INFINITY)
        };
        let found = self.take_candidates(s, m, selection);
        let c = found.iter().find(|c| c.slot == slot).copied();
        self.work.candidates = found;
        c
    }

    fn approach_speed(&mut self, s: &State, m: usize, c: &Candidate) -> f64 {
        (-self.rate_of(s, m, c)).max(0.0)
    }

    fn rate_of(&mut self, s: &State, m: usize, c: &Candidate) -> f64 {
        let mesh = &self.meshes[m];
        gap_rate(&self.gears, mesh, c, s.at(), &mut self.work.scratch)
    }

    /// Notifies both gears that a contact of a slot closed or opened.
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
