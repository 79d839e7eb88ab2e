//! Gears and meshes in a scene, with the positions of their coordinates and of their discrete state.

use super::direct::FlankMotion;
use super::friction::MeshFriction;
use crate::Vec3;
use crate::contact::{GearState, LineClearance, Search};
use crate::gear::GearModel;
use crate::law::{Law, UNTOUCHED, touch_speed};
use crate::spec::{Load, Profile};
use gearbench_integrators::system::StateView;

/// A gear in the scene.
pub struct SceneGear {
    /// Name from the scene.
    pub name: String,
    /// Identifier of the gear model.
    pub id: String,
    /// Gear model.
    pub model: Box<dyn GearModel>,
    /// Loads on its hub.
    pub loads: Vec<Load>,
    /// Offset and number of its coordinates, `q[offset .. offset + n]`.
    pub(super) offset: usize,
    pub(super) n: usize,
    pub(super) discrete: (usize, usize),
    /// True if the gear has internal forces.
    pub(super) internal: bool,
    /// Motion that the flanks follow.
    pub(super) follows: FlankMotion,
    /// Number of cells of its discrete state, from the first on, that determine by which coordinates teeth move.
    pub(super) places: usize,
    /// Sum of the loads on its hub where they are constant and act on its first coordinate alone [N m or N].
    pub(super) constant_load: Option<f64>,
}

impl SceneGear {
    /// Creates a gear before its coordinates are numbered.
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
            follows: FlankMotion::Several,
            places: 0,
            constant_load: None,
        }
    }

    /// Returns the part of a state that belongs to the gear.
    #[inline(always)]
    pub fn at<'a>(&self, at: StateView<'a>) -> StateView<'a> {
        let (own, cells) = (
            self.range(),
            self.discrete.0..self.discrete.0 + self.discrete.1,
        );
        StateView {
            t: at.t,
            q: &at.q[own.clone()],
            v: &at.v[own],
            discrete: &at.discrete[cells],
        }
    }

    /// Returns the load on the hub [N m or N] at a time and hub speed.
    pub fn load(&self, t: f64, speed: f64) -> f64 {
        self.loads
            .iter()
            .map(|l| match l {
                Load::Applied(p) => p.value(t),
                Load::Viscous(c) => -c * speed,
            })
            .sum()
    }

    /// Stores the sum of the loads on the hub where they are constant.
    pub(super) fn note_load(&mut self) {
        let hub = self.model.hub();
        let constant = |l: &Load| matches!(l, Load::Applied(Profile::Constant(_)));
        let alone = hub.is_free() && hub.hub_shapes.is_empty();
        let known = alone && self.loads.iter().all(constant);
        self.constant_load = known.then(|| self.load(0.0, 0.0));
    }

    /// Adds the load on a free hub to the forces of the scene.
    #[inline]
    pub(super) fn add_load(&self, at: StateView<'_>, f: &mut [f64]) {
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

    /// Returns the range of its coordinates in the scene.
    #[inline]
    pub fn range(&self) -> std::ops::Range<usize> {
        self.offset..self.offset + self.n
    }

    /// Returns the applied load on the hub [N m or N], independent of its speed.
    pub(super) fn applied(&self, t: f64) -> f64 {
        let value = |l: &Load| match l {
            Load::Applied(p) => p.value(t),
            Load::Viscous(_) => 0.0,
        };
        self.loads.iter().map(value).sum()
    }

    /// Returns the rate of the applied load.
    pub(super) fn applied_rate(&self, t: f64) -> f64 {
        let slope = |l: &Load| match l {
            Load::Applied(p) => p.slope(t),
            Load::Viscous(_) => 0.0,
        };
        self.loads.iter().map(slope).sum()
    }

    /// Returns the load on the hub if it is constant from `t` until the next breakpoint; 0 for a hub that is not free.
    /// `None` where its speed is prescribed other than linearly in time.
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
    /// Midpoint of the path of contact and of the width [m], and the normal from the first gear to the second there;
    /// `None` where the mesh has no line of action.
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
    /// Approach of the flanks along the line of action per unit of the hubs' own motion: effective base radii,
    /// negative for an internal gear; a rack recedes as its mate approaches.
    pub towards: [f64; 2],
    /// Left and right flanks.
    pub(super) acting: [ActingFlanks; 2],
    /// Search for candidate points.
    pub search: Search,
    /// Normal contact law.
    pub law: Law,
    /// Retardation time of its flanks [s], the mean of those of its elastic gears: see
    /// [`DissipativeSolve`](crate::contact::nodal::DissipativeSolve).
    pub(super) retardation: f64,
    /// Friction of the mesh.
    pub friction: Option<MeshFriction>,
    /// True if the contact has no penalty.
    pub(super) hard: bool,
    /// Effective radius arms of both gears on each line of action, where contacts need no candidates.
    pub(super) arms: Option<Vec<[f64; 2]>>,
    /// True if the gears are rigid bodies that move in space, and contacts need no candidates.
    pub(super) bodies: bool,
    /// True if one of its gears has a displacement field, or its flanks touch along lines.
    pub(super) nodal: bool,
    /// Lower bounds of the gaps between facing flanks of rigid gears.
    pub(super) clearances: Vec<LineClearance>,
    /// Largest deviation of the flank points from the flanks of [`Self::clearances`] [m].
    pub(super) gap_bound: f64,
    /// Offset of its discrete state, and of its event functions.
    pub(super) discrete: usize,
    pub(super) event_functions: usize,
    /// Numbers of cells of discrete state, contact slots and event functions of the search.
    pub(super) cells: usize,
    pub(super) slots: usize,
    pub(super) zones: usize,
}

impl SceneMesh {
    /// Returns true if its flanks have dampers.
    #[inline]
    pub(super) fn is_damped(&self) -> bool {
        self.law.is_dissipative() || self.retardation > 0.0
    }

    /// Returns true if its contacts dissipate energy, by dampers or by friction.
    #[inline]
    pub(super) fn dissipates(&self) -> bool {
        self.is_damped() || self.friction.is_some()
    }

    /// Returns the range of the search in the discrete state.
    #[inline]
    pub fn search_discrete(&self) -> std::ops::Range<usize> {
        self.discrete..self.discrete + self.cells
    }

    /// Returns the range of modes and impact speeds of its slots.
    #[inline]
    pub(super) fn modes(&self) -> std::ops::Range<usize> {
        self.slot(0)..self.slot(self.slots)
    }

    /// Returns the [impact speed](touch_speed) of a contact from its gap rate [m/s]; contacts of a search without
    /// slots store none.
    #[inline]
    pub(super) fn impact_speed(&self, discrete: &[f64], slot: usize, g_rate: f64) -> f64 {
        let stored = if slot < self.slots {
            discrete[self.slot(slot) + 1]
        } else {
            UNTOUCHED
        };
        touch_speed(stored, g_rate)
    }

    /// Returns the mode of a contact; 0 for a search without slots.
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
pub(super) fn gear_states<'a>(
    gears: &'a [SceneGear],
    mesh: &SceneMesh,
    at: StateView<'a>,
) -> (GearState<'a>, GearState<'a>) {
    let gear_state = |i: usize| GearState {
        gear: gears[i].model.as_ref(),
        at: gears[i].at(at),
    };
    (gear_state(mesh.gears[0]), gear_state(mesh.gears[1]))
}
