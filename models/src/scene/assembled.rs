//! The assembled system: gears, meshes, sizes and buffers. Its functions are in the other modules of the scene.

use super::carriers::Carriers;
use super::members::{SceneGear, SceneMesh};
use super::shafts::Shafts;
use super::workspace::Workspace;
use crate::gear::{FreeFlight, Magnitudes};
use crate::spec::{Load, Mount, Profile};
use gearbench_integrators::system::State;

/// The assembled system of gears, meshes and shafts.
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
    /// Index of the first event function of guides.
    pub(super) guide_events: usize,
    /// True if a gear has a displacement field.
    pub(super) fields: bool,
    /// True if dashpots and friction at flank points can be implicit: they act only on hubs and modes, each with a
    /// mass of its own.
    pub(super) implicit_dissipation: bool,
    /// True if the friction of a mesh has a history.
    pub(super) remembers: bool,
    /// True if flanks of a mesh are evaluated in space: contact rows rotate with the gears.
    pub(super) in_space: bool,
    /// True if a gear needs the condensed Newton correction.
    pub(super) condenses: bool,
    /// True if all searches have event functions; otherwise forces are clipped and no event is located.
    pub(super) locates: bool,
    /// True if impact speeds or engaged teeth have to be tracked without event location.
    pub(super) tracks: bool,
    /// Diagonal masses, and their inverse where all gears have a constant diagonal mass, otherwise empty.
    pub(super) mass: Vec<f64>,
    pub(super) inverse_mass: Vec<f64>,
    pub(super) work: Workspace,
    /// True if all gears are oscillators.
    pub(super) oscillators: bool,
    /// Buffer of [`Self::flight_until`].
    pub(super) flights: Vec<FreeFlight>,
    pub(super) initial: State,
    /// True if [`Self::initial`] is the static equilibrium of the loads.
    pub(super) balanced: bool,
    pub(super) phases: Vec<f64>,
}

impl Scene {
    /// Returns the gears, followed by the bodies of shafts.
    pub fn gears(&self) -> &[SceneGear] {
        &self.gears
    }

    /// Returns the meshes.
    pub fn meshes(&self) -> &[SceneMesh] {
        &self.meshes
    }

    /// Returns the initial state.
    pub fn initial(&self) -> State {
        self.initial.clone()
    }

    /// Sets an initial state near the static equilibrium of the loads.
    pub fn start_from(&mut self, state: State) {
        self.initial = state;
        self.balanced = true;
    }

    /// Returns the angle [rad] (displacement [m] of a rack) of each gear's tooth 0 at the assembled position.
    pub fn phases(&self) -> &[f64] {
        &self.phases
    }

    /// Returns true when all contact forces lie on the lines of action; points of flanks have the normals of the
    /// deflected teeth.
    pub fn on_lines_of_action(&self) -> bool {
        self.locates
    }

    /// Fixes a fixed or driven gear at a `displacement` [rad or m] from the assembled position, at rest from 1 s on.
    /// It has no effect on a gear that is free to move.
    pub fn hold(&mut self, gear: usize, displacement: f64) {
        let way = Profile::Ramp {
            from: 2.0 * displacement,
            to: 0.0,
            start: 0.0,
            end: 1.0,
        };
        self.drive(gear, way);
    }

    /// Prescribes a new speed of a fixed or driven gear; it has no effect on one that is free to move.
    pub fn drive(&mut self, gear: usize, speed: Profile) {
        self.work.reported.forget();
        let hub = self.gears[gear].model.hub_mut();
        if !hub.is_free() {
            hub.mount = Mount::Driven(speed);
        }
    }

    /// Replaces a load of a gear, or of a body behind the gears. Quantities that were computed from the original load
    /// at assembly, such as a damping at the load of a mesh, are not changed.
    pub fn apply(&mut self, member: usize, load: usize, profile: Profile) {
        self.work.reported.forget();
        let gear = &mut self.gears[member];
        gear.loads[load] = Load::Applied(profile);
        gear.note_load();
    }

    /// Returns typical deflection and speed along the lines of action.
    pub fn magnitudes(&self) -> Magnitudes {
        self.magnitudes
    }
}
