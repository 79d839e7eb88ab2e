//! The assembled system: gears, meshes, sizes, buffers. What it does stands in the modules beside.

use super::carriers::Carriers;
use super::linear_path::OneSpring;
use super::members::{SceneGear, SceneMesh};
use super::shafts::Shafts;
use super::workspace::Workspace;
use crate::gear::{FreeFlight, Magnitudes};
use crate::spec::{Load, Mount, Profile};
use gearbench_integrators::system::State;

/// The assembled system.
pub struct Scene {
    pub(super) gears: Vec<SceneGear>,
    pub(super) meshes: Vec<SceneMesh>,
    pub(super) shafts: Shafts,
    pub(super) carriers: Carriers,
    pub(super) channels: Vec<String>,
    pub(super) magnitudes: Magnitudes,
    pub(super) characteristic_time: f64,
    pub(super) n: usize,
    pub(super) discrete: usize,
    pub(super) event_functions: usize,
    /// The first of the event functions of guides.
    pub(super) guide_events: usize,
    /// A gear has a displacement field.
    pub(super) fields: bool,
    /// Dashpots and friction at flank points are taken implicitly where a method can: hubs and modes are all that they
    /// act on, each with a mass of its own.
    pub(super) implicit_dissipation: bool,
    /// Friction of a mesh has a history.
    pub(super) remembers: bool,
    /// Flanks of a mesh are looked at in space: contact rows turn with the gears.
    pub(super) in_space: bool,
    /// A gear asks for the condensed Newton correction.
    pub(super) condenses: bool,
    /// All searches have event functions; else forces are clipped and nothing is located.
    pub(super) locates: bool,
    /// Without event location: somebody needs impact speeds or engaged teeth to be followed.
    pub(super) tracks: bool,
    /// Diagonal masses, and their inverse where all gears have such, else empty.
    pub(super) mass: Vec<f64>,
    pub(super) inverse_mass: Vec<f64>,
    pub(super) work: Workspace,
    /// All gears are oscillators.
    pub(super) oscillators: bool,
    /// The whole scene is two gears on one constant spring.
    pub(super) one_spring: Option<OneSpring>,
    /// A gear may be put to rest in flight.
    pub(super) cuts_vibration: bool,
    /// Buffer of [`Self::flight_until`].
    pub(super) flights: Vec<FreeFlight>,
    pub(super) initial: State,
    /// [`Self::initial`] is the static equilibrium of the loads.
    pub(super) balanced: bool,
    pub(super) phases: Vec<f64>,
}

impl Scene {
    /// The gears, and behind them the bodies of shafts.
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

    /// Starts from a state near the static equilibrium of the loads.
    pub fn start_from(&mut self, state: State) {
        self.initial = state;
        self.balanced = true;
    }

    /// Angle [rad] (displacement [m] of a rack) of each gear's tooth 0 at the assembled position.
    pub fn phases(&self) -> &[f64] {
        &self.phases
    }

    /// True when all contact forces lie on the lines of action; points of flanks have the normals of the
    /// deflected teeth.
    pub fn on_lines_of_action(&self) -> bool {
        self.locates
    }

    /// Puts a fixed or driven gear where it has moved by `displacement` [rad] or [m] from the assembled position and
    /// rests: from 1 s on, with neither speed nor acceleration. Does nothing to a gear that is free to move.
    pub fn hold(&mut self, gear: usize, displacement: f64) {
        let way = Profile::Ramp {
            from: 2.0 * displacement,
            to: 0.0,
            start: 0.0,
            end: 1.0,
        };
        self.drive(gear, way);
    }

    /// Prescribes the speed of a fixed or driven gear anew; does nothing to one that is free to move.
    pub fn drive(&mut self, gear: usize, speed: Profile) {
        self.work.reported.forget();
        let hub = self.gears[gear].model.hub_mut();
        if !hub.is_free() {
            hub.mount = Mount::Driven(speed);
        }
    }

    /// Puts another load in the place of one that a gear, or a body behind the gears, has from its settings. What was made
    /// of the first one at assembly, as a damping at the load of a mesh, stays.
    pub fn apply(&mut self, member: usize, load: usize, profile: Profile) {
        self.work.reported.forget();
        let gear = &mut self.gears[member];
        gear.loads[load] = Load::Applied(profile);
        gear.note_load();
    }

    /// Typical deflection and speed along the lines of action.
    pub fn magnitudes(&self) -> Magnitudes {
        self.magnitudes
    }
}
