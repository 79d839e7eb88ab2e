//! Friction of a mesh at a state: its coefficient at a speed, and the history of stick-slip friction.
//!
//! Stick-slip friction has a state for each flank of the first gear, in cells over the width where sliding differs there
//! (helical gears): the part of the sliding force that was reached when the last step was accepted, and when that was. It
//! is part of the discrete state; a cell that carries nothing forgets.

use super::assembled::Scene;
use super::members::{SceneGear, SceneMesh};
use crate::geometry::Side;
use crate::kinematics::Tooth;
use crate::law::Friction;
use gearbench_integrators::system::{State, StateView};

/// Number of cells over the width of a helical mesh.
const OVER_WIDTH: usize = 16;

/// Friction of a mesh with its history.
#[derive(Clone, Copy, Debug)]
pub struct MeshFriction {
    /// Friction law.
    pub law: Friction,
    /// Offset of the history in the discrete state: a time, then the cells.
    pub(super) discrete: usize,
    /// Teeth of the first gear, cells over the width, and the width [m].
    teeth: usize,
    over_width: usize,
    width: f64,
}

impl MeshFriction {
    pub(super) fn new(law: Friction, teeth: u32, helical: bool, width: f64) -> Self {
        MeshFriction {
            law,
            discrete: 0,
            teeth: teeth as usize,
            over_width: if helical { OVER_WIDTH } else { 1 },
            width,
        }
    }

    /// Returns the length of the history.
    pub(super) fn cells(&self) -> usize {
        if self.law.sticks() {
            1 + 2 * self.teeth * self.over_width
        } else {
            0
        }
    }

    /// Returns the cell of a position on a flank.
    fn cell(&self, (tooth, side, z): (Tooth, Side, f64)) -> usize {
        let tooth = tooth.index.rem_euclid(self.teeth as i64) as usize;
        let across = ((z / self.width + 0.5) * self.over_width as f64) as usize;
        let flank = 2 * tooth + usize::from(side == Side::Right);
        self.discrete + 1 + flank * self.over_width + across.min(self.over_width - 1)
    }

    /// Returns the law at a speed of the first hub, without the history of a position.
    #[inline]
    pub(super) fn at(&self, gears: &[SceneGear], mesh: &SceneMesh, at: StateView<'_>) -> Friction {
        if self.law.film().is_none() {
            return self.law;
        }
        let first = &gears[mesh.gears[0]];
        self.law.at_speed(first.model.hub().speed_at(first.at(at)))
    }

    /// Returns the law at a position; `law` is the result of [`Self::at`].
    #[inline]
    pub(super) fn here(
        &self,
        law: Friction,
        place: (Tooth, Side, f64),
        at: StateView<'_>,
    ) -> Friction {
        if !law.sticks() {
            return law;
        }
        let since = at.t - at.discrete[self.discrete];
        law.after(at.discrete[self.cell(place)], since)
    }
}

impl Scene {
    /// Starts the history of friction at a state.
    pub(super) fn begin_friction(&self, s: &mut State) {
        for f in self.meshes.iter().filter_map(|m| m.friction.as_ref()) {
            if f.cells() > 0 {
                s.discrete[f.discrete..][..f.cells()].fill(0.0);
                s.discrete[f.discrete] = s.t;
            }
        }
    }

    /// Stores the fraction of the sliding force in every cell at an accepted state: the mean over its contacts,
    /// weighted by their forces.
    pub(super) fn remember_friction(&mut self, s: &mut State) {
        self.evaluate_contacts(s.at());
        let mut reached = std::mem::take(&mut self.work.reached);
        reached.clear();
        let mut add = |mesh: &SceneMesh, at: (Tooth, Side, f64), n: f64, per_force: f64| {
            if let Some(f) = mesh.friction.as_ref().filter(|f| f.law.sticks()) {
                let mu = f.at(&self.gears, mesh, s.at()).mu();
                let part = if mu > 0.0 { -per_force / mu } else { 0.0 };
                reached.push((f.cell(at), n, part));
            }
        };
        for a in &self.work.active {
            let candidate = &self.work.candidates[a.candidate];
            let mesh = &self.meshes[a.mesh];
            let ([tooth, _], side) = mesh.search.flank_of(candidate);
            let place = (tooth, side, candidate.points[0].x.z);
            add(mesh, place, a.force.n, a.friction.df_dn);
        }
        // Whichever gear is the slave: with it the normal turns, and the sliding speed is that of either over the other.
        let nodal = &self.work.nodal;
        for a in &nodal.active {
            let p = &nodal.found.points[a.point];
            let place = (p.teeth[0], p.side(), p.x.z);
            let mesh = &self.meshes[p.mesh as usize];
            add(mesh, place, a.force.n, a.sliding.force.df_dn);
        }
        self.begin_friction(s);
        for &(cell, force, _) in &reached {
            s.discrete[cell] += force;
        }
        let total: Vec<f64> = reached.iter().map(|(cell, ..)| s.discrete[*cell]).collect();
        for &(cell, ..) in &reached {
            s.discrete[cell] = 0.0;
        }
        for (&(cell, force, part), total) in reached.iter().zip(total) {
            if total > 0.0 {
                s.discrete[cell] += part * force / total;
            }
        }
        self.work.reached = reached;
    }
}
