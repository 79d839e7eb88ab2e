//! The assembled scene: gears on their mounts, loads, meshes, as one second-order system.
//!
//! `M q'' = f_int(q, q') + f_load(t, q') + sum_c (w_c N_c + t_c F_c)`: `w = dg/dq` is the contact row, `t` the
//! sliding row. Newton corrections solve the gears' own blocks and add the contacts as low-rank terms
//! (Woodbury), so a gear brings whatever structure its coordinates have. Where a gear has many coordinates of which
//! contacts touch few, both are condensed to these.
//!
//! Contacts of flank points have no event functions: a scene with such a mesh reports none and is never located.
//!
//! Discrete state layout: `[located, gears..., meshes...]`; a mesh holds its search's discrete state and then per
//! contact slot `(mode, impact speed)`, mode 1 closed and 0 open.

mod assembly;
mod assembly_points;
pub mod channels;
mod condensed;
mod contacts;
mod free_flight;
mod modal;
mod nodal;
mod nodal_tangent;
mod outputs;
mod system;

pub use channels::{Channel, OfGear, OfMesh};
pub use contacts::ContactForce;

use crate::contact::{LineClearance, Party, Search};
use crate::gear::{FreeFlight, GearModel, Magnitudes};
use crate::law::{Friction, Law};
use crate::spec::{Load, Mount, Profile};
use contacts::Workspace;
use gearbench_integrators::system::{At, State};

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
    offset: usize,
    n: usize,
    discrete: (usize, usize),
    /// It has forces of its own.
    internal: bool,
}

impl SceneGear {
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
    fn load(&self, t: f64, speed: f64) -> f64 {
        self.loads
            .iter()
            .map(|l| match l {
                Load::Applied(p) => p.value(t),
                Load::Viscous(c) => -c * speed,
            })
            .sum()
    }

    /// Adds the load on a hub that is free to move to the scene's forces.
    #[inline]
    fn add_load(&self, at: At<'_>, f: &mut [f64]) {
        if self.loads.is_empty() {
            return;
        }
        let hub = self.model.hub();
        if hub.coordinates() > 0 {
            let load = self.load(at.t, hub.load_speed(self.at(at)));
            hub.add_load(load, &mut f[self.range()]);
        }
    }

    fn viscous(&self) -> f64 {
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
}

/// A mesh in the scene.
pub struct SceneMesh {
    /// Indices of the gears; the first is never a rack.
    pub gears: [usize; 2],
    /// Finds candidate points.
    pub search: Search,
    /// Normal law.
    pub law: Law,
    /// Sliding friction.
    pub friction: Option<Friction>,
    /// Its contact has no penalty.
    hard: bool,
    /// One of its gears has a displacement field.
    nodal: bool,
    /// What facing flanks are apart at least, were the gears rigid.
    clearances: Vec<LineClearance>,
    /// How far the points of the flanks may stand off what [`Self::clearances`] are made of [m].
    gap_bound: f64,
    /// Offset of its discrete state, and of its event functions.
    discrete: usize,
    event_functions: usize,
    /// What the search says of itself: cells of discrete state, contact slots, event functions.
    cells: usize,
    slots: usize,
    zones: usize,
}

impl SceneMesh {
    #[inline]
    fn search_discrete(&self) -> std::ops::Range<usize> {
        self.discrete..self.discrete + self.cells
    }

    /// Modes and impact speeds of its slots.
    #[inline]
    fn modes(&self) -> std::ops::Range<usize> {
        self.slot(0)..self.slot(self.slots)
    }

    /// Speed stored at the first touch of a contact [m/s]; 0 where none is, as with a search without slots.
    #[inline]
    fn impact_speed(&self, discrete: &[f64], slot: usize) -> f64 {
        if slot < self.slots {
            discrete[self.slot(slot) + 1]
        } else {
            0.0
        }
    }

    #[inline]
    fn slot(&self, slot: usize) -> usize {
        self.discrete + self.cells + 2 * slot
    }
}

/// The assembled system.
pub struct Scene {
    gears: Vec<SceneGear>,
    meshes: Vec<SceneMesh>,
    channels: Vec<String>,
    magnitudes: Magnitudes,
    characteristic_time: f64,
    n: usize,
    discrete: usize,
    event_functions: usize,
    /// A gear has a displacement field.
    fields: bool,
    /// A gear asks for the condensed Newton correction.
    condenses: bool,
    /// All searches have event functions; else forces are clipped and nothing is located.
    locates: bool,
    /// Without event location: somebody needs impact speeds or engaged teeth to be followed.
    tracks: bool,
    /// Diagonal masses, and their inverse where all gears have such, else empty.
    mass: Vec<f64>,
    inverse_mass: Vec<f64>,
    work: Workspace,
    /// All gears are oscillators.
    oscillators: bool,
    /// A gear may be put to rest in flight.
    cuts_vibration: bool,
    /// Buffer of [`Self::flight_until`].
    flights: Vec<FreeFlight>,
    initial: State,
    phases: Vec<f64>,
}

impl Scene {
    /// The gears.
    pub fn gears(&self) -> &[SceneGear] {
        &self.gears
    }

    /// The meshes.
    pub fn meshes(&self) -> &[SceneMesh] {
        &self.meshes
    }

    /// The initial state.
    pub fn initial(&self) -> State {
        self.initial.clone()
    }

    /// Angle [rad] (displacement [m] of a rack) of each gear's tooth 0 at the assembled position.
    pub fn phases(&self) -> &[f64] {
        &self.phases
    }

    /// Ends of the line of action that a contact lies on [m], in the transverse plane.
    pub fn line_of_action(&self, contact: &ContactForce) -> Option<[[f64; 2]; 2]> {
        let ends = self.meshes.get(contact.mesh)?.search.line(contact.side)?;
        Some(ends.map(|p| [p.x, p.y]))
    }

    /// True when all contact forces lie on the lines of action; points of flanks have the normals of the
    /// deflected teeth.
    pub fn on_lines_of_action(&self) -> bool {
        self.locates
    }

    /// Replaces the loads of a gear, for sweeps.
    pub fn set_loads(&mut self, gear: usize, loads: Vec<Load>) {
        self.gears[gear].loads = loads;
    }

    /// Puts a fixed or driven gear where it has moved by `displacement` [rad] or [m] from the assembled position and
    /// rests: from 1 s on, with neither speed nor acceleration. Does nothing to a gear that is free to move.
    pub fn hold(&mut self, gear: usize, displacement: f64) {
        let hub = self.gears[gear].model.hub_mut();
        if hub.coordinates() == 0 {
            hub.mount = Mount::Driven(Profile::Ramp {
                from: 2.0 * displacement,
                to: 0.0,
                start: 0.0,
                end: 1.0,
            });
        }
    }

    /// Typical deflection and speed along the lines of action.
    pub fn magnitudes(&self) -> Magnitudes {
        self.magnitudes
    }
}

#[inline(always)]
fn parties<'a>(gears: &'a [SceneGear], mesh: &SceneMesh, at: At<'a>) -> (Party<'a>, Party<'a>) {
    let party = |i: usize| Party {
        gear: gears[i].model.as_ref(),
        at: gears[i].at(at),
    };
    (party(mesh.gears[0]), party(mesh.gears[1]))
}
