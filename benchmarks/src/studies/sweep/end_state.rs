//! Final state of a run of a sweep, from which the next run of the branch starts.

use gearbench_integrators::State;
use gearbench_models::spec::{GearSpec, Mount, SceneSpec};
use serde::{Deserialize, Serialize};

/// Final state of a run of a sweep, from which the next run of the branch starts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EndState {
    pub(super) t: f64,
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) discrete: Vec<f64>,
    /// Mesh frequency of the run [Hz].
    pub(super) frequency: f64,
    /// Rotation of driven gears so far [rad]; 0 for others.
    pub(super) driven: [f64; 2],
    /// Acceleration of the first gear that keeps the speed of free gears [rad/s^2]; the second follows by the ratio.
    drive: f64,
}

impl EndState {
    /// Returns the time at which the state was reached [s].
    pub fn time(&self) -> f64 {
        self.t
    }

    /// Returns the acceleration of the first gear that kept the speed [rad/s^2].
    pub fn drive(&self) -> f64 {
        self.drive
    }

    /// Returns the end state of a run in a scene at a mesh frequency [Hz] under a drive [rad/s^2]; `None` if a
    /// coordinate is not finite.
    pub fn of(state: &State, spec: &SceneSpec, frequency: f64, drive: f64) -> Option<Self> {
        let turned = |gear: &GearSpec| match &gear.mount {
            Mount::Driven(speed) => speed.integral(state.t),
            _ => 0.0,
        };
        let end = EndState {
            t: state.t,
            q: state.q.clone(),
            v: state.v.clone(),
            discrete: state.discrete.clone(),
            frequency,
            driven: [0, 1].map(|i| turned(&spec.gears[i])),
            drive,
        };
        let numbers = [&end.q, &end.v, &end.discrete].into_iter().flatten();
        let finite = numbers.chain([&end.t]).all(|x| x.is_finite());
        finite.then_some(end)
    }
}
