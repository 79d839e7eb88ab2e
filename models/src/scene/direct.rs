//! Forces and event functions of meshes without candidates: gears whose teeth move by one coordinate each on lines of
//! action, and rigid bodies that move in space, without friction and with event location. Steps use these; reports and
//! tangents use candidates.

use super::assembled::Scene;
use super::members::{SceneGear, SceneMesh, gear_states};
use super::workspace::Workspace;
use crate::contact::pairs::{LinesOfAction, Mesh, MeshedBodies, PRESCRIBED, PairList, Twist};
use crate::kinematics::{BodyMotion, Tooth};
use gearbench_integrators::system::StateView;

/// Motion that the flanks of a gear follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FlankMotion {
    /// The flanks follow the hub, by its one coordinate or by a prescribed motion.
    Hub,
    /// Each tooth follows a coordinate of its own.
    Teeth,
    /// The flanks follow the hub in several directions.
    Body,
    /// The flanks follow several coordinates at once.
    Several,
}

impl FlankMotion {
    /// Returns the motion of the flanks of a gear at a state; `discrete` is that of the gear.
    pub(super) fn of(gear: &SceneGear, discrete: &[f64]) -> Self {
        let model = gear.model.as_ref();
        let hub = model.hub();
        if hub.lateral.is_some() {
            let rigid = hub.own == 0 && model.teeth().is_none() && model.surface().is_none();
            return match rigid {
                true => FlankMotion::Body,
                false => FlankMotion::Several,
            };
        }
        if model.surface().is_some() || model.coupled_mass().is_some() {
            return FlankMotion::Several;
        }
        let tooth = Tooth { index: 0, mesh: 0 };
        match model.teeth() {
            Some(teeth) if teeth.coordinate(discrete, tooth).is_some() => FlankMotion::Teeth,
            None if !hub.is_internal() => FlankMotion::Hub,
            _ => FlankMotion::Several,
        }
    }
}

impl SceneGear {
    /// Returns the coordinate of the scene by which a tooth moves.
    fn coordinate(&self, at: StateView<'_>, tooth: Tooth) -> usize {
        let own = match self.model.teeth() {
            Some(teeth) if self.follows == FlankMotion::Teeth => {
                teeth.coordinate(self.cells(at), tooth).unwrap_or(0)
            }
            _ if self.n == 0 => return PRESCRIBED,
            _ => 0,
        };
        self.offset + own
    }

    /// Returns the part of the discrete state that determines these coordinates.
    #[inline(always)]
    fn places<'a>(&self, at: StateView<'a>) -> &'a [f64] {
        &at.discrete[self.discrete.0..][..self.places]
    }

    #[inline]
    fn cells<'a>(&self, at: StateView<'a>) -> &'a [f64] {
        &at.discrete[self.discrete.0..][..self.discrete.1]
    }

    /// Returns displacement and speed of the hub where these are prescribed.
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
    /// Stores whether the contacts need no candidates, and the arms of those on lines of action.
    pub(super) fn note_directness(&mut self, gears: &[SceneGear]) {
        let pair = self.gears.map(|i| &gears[i]);
        (self.arms, self.bodies) = (None, false);
        let Some(pairs) = self.search.pairs().filter(|_| self.friction.is_none()) else {
            return;
        };
        let all = |these: &[FlankMotion]| pair.iter().all(|g| these.contains(&g.follows));
        if pairs.is_spatial() {
            self.bodies = all(&[FlankMotion::Hub, FlankMotion::Body]) && !pairs.couples();
        } else if all(&[FlankMotion::Hub, FlankMotion::Teeth]) {
            self.arms = Some(pairs.arms(pair.map(|g| &g.model.hub().hub)));
        }
    }

    /// Returns the mesh at a state with event location and the motions of both gears, if these are rigid bodies in
    /// space and contacts need no candidates.
    fn as_bodies<'a>(
        &'a self,
        gears: &'a [SceneGear],
        at: StateView<'a>,
    ) -> Option<(&'a LinesOfAction, MeshedBodies<'a>, [BodyMotion; 2])> {
        let pairs = self.search.pairs()?;
        if !self.bodies || at.discrete[0] == 0.0 {
            return None;
        }
        let (a, b) = gear_states(gears, self, at);
        let motions = [&a, &b].map(|gear_state| {
            let StateView { t, q, v, .. } = gear_state.at;
            gear_state.gear.hub().body_motion(t, q, v)
        });
        let [of_a, of_b] = &motions;
        let origin = of_b.origin;
        let mesh = MeshedBodies {
            law: &self.law,
            gears: [a, b],
            twist: Twist {
                origin,
                velocity: of_b.velocity - of_a.velocity - of_a.spin.cross(&(origin - of_a.origin)),
                spin: of_b.spin - of_a.spin,
            },
            discrete: &at.discrete[self.search_discrete()],
            modes: &at.discrete[self.modes()],
        };
        Some((pairs, mesh, motions))
    }

    /// Returns the mesh at a state with event location, if its contacts need no candidates; its pairs are then in the
    /// list of the mesh.
    #[inline(always)]
    fn directly<'a>(
        &'a self,
        gears: &'a [SceneGear],
        at: StateView<'a>,
        pair_list: &mut PairList,
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
        pairs.list(&mesh, pair_list, |k, tooth| [a, b][k].coordinate(at, tooth));
        Some((pairs, mesh))
    }
}

impl Scene {
    /// Adds the contact forces of a mesh, if its contacts need no candidates.
    #[inline]
    pub(super) fn add_forces_directly(
        &mut self,
        at: StateView<'_>,
        m: usize,
        f: &mut [f64],
    ) -> bool {
        if let Some((pairs, mesh, motions)) = self.meshes[m].as_bodies(&self.gears, at) {
            let [force, moment] = pairs.wrench_on_second(&mesh);
            for (k, sign) in [(0, -1.0), (1, 1.0)] {
                let gear = &self.gears[self.meshes[m].gears[k]];
                let wrench = (&mesh.twist.origin, &(sign * force), &(sign * moment));
                (gear.model.hub()).add_wrench(&motions[k], wrench, &mut f[gear.range()]);
            }
            return true;
        }
        let Workspace {
            pair_lists,
            pressed,
            ..
        } = &mut self.work;
        let pair_list = &mut pair_lists[m];
        let direct = self.meshes[m].directly(&self.gears, at, pair_list);
        let Some((pairs, mesh)) = direct else {
            return false;
        };
        pairs.add_forces(&mesh, pair_list, pressed, f);
        true
    }

    /// Sets the event functions of a mesh, if its contacts need no candidates.
    #[inline]
    pub(super) fn watch_directly(&mut self, at: StateView<'_>, m: usize, out: &mut [f64]) -> bool {
        if let Some((pairs, mesh, _)) = self.meshes[m].as_bodies(&self.gears, at) {
            let of_mesh = &self.meshes[m];
            let own = &mut out[of_mesh.event_functions..][..of_mesh.zones + of_mesh.slots];
            let (zones, slots) = own.split_at_mut(of_mesh.zones);
            pairs.watch_bodies(&mesh, zones, slots);
            return true;
        }
        let Workspace {
            pair_lists,
            pressed,
            ..
        } = &mut self.work;
        let pair_list = &mut pair_lists[m];
        let of_mesh = &self.meshes[m];
        let Some((pairs, mesh)) = of_mesh.directly(&self.gears, at, pair_list) else {
            return false;
        };
        let own = &mut out[of_mesh.event_functions..][..of_mesh.zones + of_mesh.slots];
        let (zones, slots) = own.split_at_mut(of_mesh.zones);
        pairs.watch_listed(&mesh, pair_list, pressed, zones, slots);
        true
    }
}
