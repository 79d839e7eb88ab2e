//! Forces and event functions of meshes whose contacts need no candidates: gears whose teeth move by one coordinate each,
//! on lines of action, without friction, while events are located. A step asks for nothing else; reports and tangents look
//! at candidates.

use super::assembled::Scene;
use super::members::{SceneGear, SceneMesh};
use super::workspace::Workspace;
use crate::contact::pairs::{LinesOfAction, Mesh, PRESCRIBED, Roster};
use crate::kinematics::Tooth;
use gearbench_integrators::system::At;

/// What the flanks of a gear follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Follows {
    /// The hub, by its one coordinate or by a prescribed motion.
    Hub,
    /// Each tooth a coordinate of its own.
    Teeth,
    /// Several coordinates at once.
    Several,
}

impl Follows {
    /// What those of a gear in a state do; `discrete` is the gear's own.
    pub(super) fn of(gear: &SceneGear, discrete: &[f64]) -> Self {
        let model = gear.model.as_ref();
        let lateral = model.hub().lateral.is_some();
        if lateral || model.surface().is_some() || model.coupled_mass().is_some() {
            return Follows::Several;
        }
        let tooth = Tooth { index: 0, mesh: 0 };
        match model.teeth() {
            Some(teeth) if teeth.coordinate(discrete, tooth).is_some() => Follows::Teeth,
            None if !model.hub().is_internal() => Follows::Hub,
            _ => Follows::Several,
        }
    }
}

impl SceneGear {
    /// The scene's coordinate by which a tooth moves.
    fn coordinate(&self, at: At<'_>, tooth: Tooth) -> usize {
        let own = match self.model.teeth() {
            Some(teeth) if self.follows == Follows::Teeth => {
                teeth.coordinate(self.cells(at), tooth).unwrap_or(0)
            }
            _ if self.n == 0 => return PRESCRIBED,
            _ => 0,
        };
        self.offset + own
    }

    /// Its part of the discrete state that says so.
    #[inline(always)]
    fn places<'a>(&self, at: At<'a>) -> &'a [f64] {
        &at.discrete[self.discrete.0..][..self.places]
    }

    #[inline]
    fn cells<'a>(&self, at: At<'a>) -> &'a [f64] {
        &at.discrete[self.discrete.0..][..self.discrete.1]
    }

    /// Displacement and speed of its hub where these are prescribed.
    #[inline(always)]
    fn prescribed(&self, t: f64) -> [f64; 2] {
        if self.n > 0 {
            return [0.0; 2];
        }
        let hub = self.model.hub();
        [hub.displacement(t, &[]), hub.speed(t, &[])]
    }
}

impl SceneMesh {
    /// Notes the arms of a mesh whose contacts need no candidates.
    pub(super) fn note_arms(&mut self, gears: &[SceneGear]) {
        let pair = self.gears.map(|i| &gears[i]);
        let follow = pair.iter().all(|g| g.follows != Follows::Several);
        self.arms = match self.search.pairs() {
            Some(pairs) if follow && self.friction.is_none() && !pairs.is_spatial() => {
                Some(pairs.arms(pair.map(|g| &g.model.hub().hub)))
            }
            _ => None,
        };
    }

    /// The mesh at a state where events are located, if its contacts need no candidates; the pairs that are looked at
    /// are then in the roster.
    #[inline(always)]
    fn directly<'a>(
        &'a self,
        gears: &'a [SceneGear],
        at: At<'a>,
        roster: &mut Roster,
    ) -> Option<(&'a LinesOfAction, Mesh<'a>)> {
        let (arms, pairs) = (self.arms.as_ref()?, self.search.pairs()?);
        if at.discrete[0] == 0.0 {
            return None;
        }
        let [a, b] = [&gears[self.gears[0]], &gears[self.gears[1]]];
        let mesh = Mesh {
            law: &self.law,
            arms,
            q: at.q,
            v: at.v,
            prescribed: [a.prescribed(at.t), b.prescribed(at.t)],
            discrete: [
                &at.discrete[self.search_discrete()],
                a.places(at),
                b.places(at),
            ],
            modes: &at.discrete[self.modes()],
        };
        pairs.list(&mesh, roster, |k, tooth| [a, b][k].coordinate(at, tooth));
        Some((pairs, mesh))
    }
}

impl Scene {
    /// Adds the contact forces of a mesh, if its contacts need no candidates.
    #[inline]
    pub(super) fn add_forces_directly(&mut self, at: At<'_>, m: usize, f: &mut [f64]) -> bool {
        let Workspace {
            rosters, pressed, ..
        } = &mut self.work;
        let roster = &mut rosters[m];
        let direct = self.meshes[m].directly(&self.gears, at, roster);
        let Some((pairs, mesh)) = direct else {
            return false;
        };
        pairs.add_forces(&mesh, roster, pressed, f);
        true
    }

    /// Sets the event functions of a mesh, if its contacts need no candidates.
    #[inline]
    pub(super) fn watch_directly(&mut self, at: At<'_>, m: usize, out: &mut [f64]) -> bool {
        let Workspace {
            rosters, pressed, ..
        } = &mut self.work;
        let roster = &mut rosters[m];
        let of_mesh = &self.meshes[m];
        let Some((pairs, mesh)) = of_mesh.directly(&self.gears, at, roster) else {
            return false;
        };
        let own = &mut out[of_mesh.event_functions..][..of_mesh.zones + of_mesh.slots];
        let (zones, slots) = own.split_at_mut(of_mesh.zones);
        pairs.watch_listed(&mesh, roster, pressed, zones, slots);
        true
    }
}
