//! Gears and meshes as they stand in a scene: where their coordinates and their discrete state are.

use super::direct::Follows;
use super::friction::MeshFriction;
use crate::Vec3;
use crate::contact::{LineClearance, Party, Search};
use crate::gear::GearModel;
use crate::law::{Law, UNTOUCHED, touch_speed};
use crate::spec::{Load, Profile};
use gearbench_integrators::system::At;

/// A gear in the scene.
pub struct SceneGear {
    /// Name from the scene.
    pub name: String,
    /// Id of its model.
    pub id: String,
    /// The model.
    pub model: Box<dyn GearModel>,
    /// Loads on its hub.
    pub loads: Vec<Load>,
    /// Its coordinates are `q[offset.0 .. offset.0 + n]`.
    pub(super) offset: usize,
    pub(super) n: usize,
    pub(super) discrete: (usize, usize),
    /// It has forces of its own.
    pub(super) internal: bool,
    /// What its flanks follow.
    pub(super) follows: Follows,
    /// Cells of its discrete state, from the first on, that say by which coordinates teeth move.
    pub(super) places: usize,
    /// The loads on its hub where they never change and act on its first coordinate alone [N m] or [N].
    pub(super) constant_load: Option<f64>,
}

impl SceneGear {
    /// A gear that has not found its place yet.
    pub(super) fn new(name: &str, id: &str, model: Box<dyn GearModel>, loads: &[Load]) -> Self {
        SceneGear {
            name: name.into(),
            id: id.into(),
            model,
            loads: loads.to_vec(),
            offset: 0,
            n: 0,
            discrete: (0, 0),
            internal: true,
            follows: Follows::Several,
            places: 0,
            constant_load: None,
        }
    }

    /// The gear's own slice of a state.
    #[inline(always)]
    pub fn at<'a>(&self, at: At<'a>) -> At<'a> {
        let (own, cells) = (
            self.range(),
            self.discrete.0..self.discrete.0 + self.discrete.1,
        );
        At {
            t: at.t,
            q: &at.q[own.clone()],
            v: &at.v[own],
            discrete: &at.discrete[cells],
        }
    }

    /// Load on the hub [N m] or [N] at a time and hub speed.
    pub fn load(&self, t: f64, speed: f64) -> f64 {
        self.loads
            .iter()
            .map(|l| match l {
                Load::Applied(p) => p.value(t),
                Load::Viscous(c) => -c * speed,
            })
            .sum()
    }

    /// Notes the loads on its hub where they never change.
    pub(super) fn note_load(&mut self) {
        let hub = self.model.hub();
        let constant = |l: &Load| matches!(l, Load::Applied(Profile::Constant(_)));
        let alone = hub.is_free() && hub.hub_shapes.is_empty();
        let known = alone && self.loads.iter().all(constant);
        self.constant_load = known.then(|| self.load(0.0, 0.0));
    }

    /// Adds the load on a hub that is free to move to the scene's forces.
    #[inline]
    pub(super) fn add_load(&self, at: At<'_>, f: &mut [f64]) {
        if self.loads.is_empty() {
            return;
        }
        if let Some(load) = self.constant_load {
            f[self.offset] += load;
            return;
        }
        let hub = self.model.hub();
        if hub.is_free() {
            let load = self.load(at.t, hub.load_speed(self.at(at)));
            hub.add_load(load, &mut f[self.range()]);
        }
    }

    pub(super) fn viscous(&self) -> f64 {
        self.loads
            .iter()
            .map(|l| if let Load::Viscous(c) = l { *c } else { 0.0 })
            .sum()
    }

    /// Range of its coordinates in the scene's.
    #[inline]
    pub fn range(&self) -> std::ops::Range<usize> {
        self.offset..self.offset + self.n
    }

    /// What loads apply to the hub whatever its speed [N m] or [N].
    pub(super) fn applied(&self, t: f64) -> f64 {
        let value = |l: &Load| match l {
            Load::Applied(p) => p.value(t),
            Load::Viscous(_) => 0.0,
        };
        self.loads.iter().map(value).sum()
    }

    /// Its rate.
    pub(super) fn applied_rate(&self, t: f64) -> f64 {
        let slope = |l: &Load| match l {
            Load::Applied(p) => p.slope(t),
            Load::Viscous(_) => 0.0,
        };
        self.loads.iter().map(slope).sum()
    }

    /// The load on its hub where that is constant from `t` until the next breakpoint; 0 for a hub that is not free. None
    /// where its speed is prescribed otherwise than linear in time: nobody extrapolates that.
    pub(super) fn steady_load(&self, t: f64) -> Option<f64> {
        let hub = self.model.hub();
        if !hub.is_free() {
            return hub.moves_linearly().then_some(0.0);
        }
        let mut sum = 0.0;
        for load in &self.loads {
            sum += match load {
                Load::Applied(p) if p.is_steady(t) => p.value(t),
                Load::Viscous(0.0) => 0.0,
                _ => return None,
            };
        }
        Some(sum)
    }
}

/// Flanks of one side of a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct ActingFlanks {
    /// The point halfway along the path of contact and of the width [m], and the normal from the first gear to the second there;
    /// none where the mesh has no line of action.
    pub middle: Option<(Vec3, Vec3)>,
    /// Gap at the assembled position [m].
    pub gap: f64,
}

/// A mesh in the scene.
pub struct SceneMesh {
    /// Indices of the gears; the first is never a rack.
    pub gears: [usize; 2],
    /// Direction halfway between the axes of its gears.
    pub axis: Vec3,
    /// Ways of the flanks towards each other along the line of action by a unit of the hubs' own motion: effective base radii, of
    /// an internal gear below zero; a rack recedes as its mate approaches.
    pub towards: [f64; 2],
    /// Its left and its right flanks.
    pub(super) acting: [ActingFlanks; 2],
    /// Finds candidate points.
    pub search: Search,
    /// Normal law.
    pub law: Law,
    /// Sliding friction.
    pub friction: Option<MeshFriction>,
    /// Its contact has no penalty.
    pub(super) hard: bool,
    /// Effective radius arms of both gears on each line of action, where contacts need no candidates.
    pub(super) arms: Option<Vec<[f64; 2]>>,
    /// Its gears are rigid bodies that move in space, and contacts need no candidates.
    pub(super) bodies: bool,
    /// One of its gears has a displacement field, or its flanks touch along lines.
    pub(super) nodal: bool,
    /// What facing flanks are apart at least, were the gears rigid.
    pub(super) clearances: Vec<LineClearance>,
    /// How far the points of the flanks may stand off what [`Self::clearances`] are made of [m].
    pub(super) gap_bound: f64,
    /// Offset of its discrete state, and of its event functions.
    pub(super) discrete: usize,
    pub(super) event_functions: usize,
    /// What the search says of itself: cells of discrete state, contact slots, event functions.
    pub(super) cells: usize,
    pub(super) slots: usize,
    pub(super) zones: usize,
}

impl SceneMesh {
    /// Its contacts take energy: by dampers or by friction.
    #[inline]
    pub(super) fn dissipates(&self) -> bool {
        self.law.is_dissipative() || self.friction.is_some()
    }

    /// Its search's own part of the discrete state.
    #[inline]
    pub fn search_discrete(&self) -> std::ops::Range<usize> {
        self.discrete..self.discrete + self.cells
    }

    /// Modes and impact speeds of its slots.
    #[inline]
    pub(super) fn modes(&self) -> std::ops::Range<usize> {
        self.slot(0)..self.slot(self.slots)
    }

    /// [Touch speed](touch_speed) of a contact with a gap rate [m/s]; contacts of a search without slots store none.
    #[inline]
    pub(super) fn impact_speed(&self, discrete: &[f64], slot: usize, g_rate: f64) -> f64 {
        let stored = if slot < self.slots {
            discrete[self.slot(slot) + 1]
        } else {
            UNTOUCHED
        };
        touch_speed(stored, g_rate)
    }

    /// Mode of a contact; 0 with a search without slots.
    #[inline]
    pub(super) fn mode(&self, discrete: &[f64], slot: usize) -> f64 {
        if slot < self.slots {
            discrete[self.slot(slot)]
        } else {
            0.0
        }
    }

    #[inline]
    pub(super) fn slot(&self, slot: usize) -> usize {
        self.discrete + self.cells + 2 * slot
    }
}

#[inline(always)]
pub(super) fn parties<'a>(
    gears: &'a [SceneGear],
    mesh: &SceneMesh,
    at: At<'a>,
) -> (Party<'a>, Party<'a>) {
    let party = |i: usize| Party {
        gear: gears[i].model.as_ref(),
        at: gears[i].at(at),
    };
    (party(mesh.gears[0]), party(mesh.gears[1]))
}
