//! Runs of scenes and their results.

use gearbench_integrators::observers::Tee;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{
    AcceptedStep, Control, METHODS, Method, MethodInfo, Outputs, Report, Resolution,
    SecondOrderSystem, Sink, State, StepError, Stepping, TimePlan, Work,
};
use gearbench_models::scene::{OfMesh, Scene};

/// Result of a run.
pub struct Outcome {
    /// State at the end.
    pub state: State,
    /// Energy ledger of the run.
    pub ledger: Ledger,
    /// Work counters of the run.
    pub work: Work,
    /// Smallest normal force of any contact at any accepted step [N].
    pub normal_min: f64,
    /// Impulse of the contact force of the first mesh [N s], trapezoid rule over accepted steps.
    pub impulse: f64,
    /// Largest contact force of the first mesh at an accepted step [N].
    pub peak: f64,
    /// Success, or the error that ended the run.
    pub result: Result<(), StepError>,
}

impl Outcome {
    /// Returns the result of a run that must not have failed.
    pub fn unwrap(self, what: &str) -> Outcome {
        if let Err(e) = &self.result {
            panic!("{what}: {e}");
        }
        self
    }
}

/// Sink that records forces at accepted steps.
#[derive(Default)]
struct Forces {
    normal_min: f64,
    impulse: f64,
    peak: f64,
    last: Option<f64>,
    meshes: usize,
    out: Outputs,
}

impl Sink for Forces {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        if self.last.is_none() {
            sys.output(step.from.at(), &mut self.out);
            self.last = Some(self.out.channels[0]);
        }
        sys.output(step.to.at(), &mut self.out);
        for m in 0..self.meshes {
            self.normal_min = self
                .normal_min
                .min(self.out.channels[OfMesh::ALL.len() * m + OfMesh::LeastNormal as usize]);
        }
        let force = self.out.channels[0];
        self.peak = self.peak.max(force);
        self.impulse += 0.5 * (step.to.t - step.from.t) * (self.last.unwrap_or(0.0) + force);
        self.last = Some(force);
        Control::Continue
    }

    fn restarted(&mut self, sys: &mut dyn SecondOrderSystem, _before: &State, after: &State) {
        sys.output(after.at(), &mut self.out);
        self.last = Some(self.out.channels[0]);
    }
}

/// Runs a scene from its initial state with a method `id(name=value)`.
pub fn run(scene: &mut Scene, id: &str, resolution: Resolution, t_end: f64) -> Outcome {
    let s = scene.initial();
    run_from(
        scene,
        s,
        id,
        &TimePlan {
            max_steps: 4_000_000,
            ..TimePlan::new(t_end, resolution)
        },
    )
}

/// Runs a scene from a state with a method that must not fail, with a sink.
pub fn watched(
    scene: &mut Scene,
    mut state: State,
    id: &str,
    plan: &TimePlan<'_>,
    sink: &mut dyn Sink,
) -> (State, Work) {
    let mut work = Work::default();
    let mut method = gearbench_integrators::method(id).expect("the method is known");
    if let Err(e) = method.run(scene, &mut state, plan, sink, &mut work) {
        panic!("{id} under {:?}: {e}", plan.resolution);
    }
    (state, work)
}

/// Runs a scene from a given state.
pub fn run_from(scene: &mut Scene, mut state: State, id: &str, plan: &TimePlan<'_>) -> Outcome {
    let mut integrator = gearbench_integrators::method(id).expect("the method is known");
    let mut ledger = Ledger::default();
    let mut forces = Forces {
        meshes: scene.meshes().len(),
        ..Forces::default()
    };
    let mut work = Work::default();
    let result = integrator.run(
        scene,
        &mut state,
        plan,
        &mut Tee(vec![&mut ledger, &mut forces]),
        &mut work,
    );
    let Forces {
        normal_min,
        impulse,
        peak,
        ..
    } = forces;
    Outcome {
        state,
        ledger,
        work,
        normal_min,
        impulse,
        peak,
        result,
    }
}

/// Returns the value of a named channel at a state.
pub fn channel(scene: &mut Scene, s: &State, name: &str) -> f64 {
    let mut out = Outputs::default();
    scene.output(s.at(), &mut out);
    out.channels[named(scene, name)]
}

/// Returns the index of a channel by its name.
pub fn named(scene: &Scene, name: &str) -> usize {
    let found = scene.channels().iter().position(|c| c == name);
    found.unwrap_or_else(|| panic!("there is no channel {name}"))
}

/// Returns a resolution that a method supports: the step [s], or a tolerance where it has no fixed steps.
pub fn resolution(info: &MethodInfo, step: f64, tolerance: f64) -> Resolution {
    match info.stepping {
        Stepping::Adaptive => Resolution::Tolerance(tolerance),
        _ => Resolution::Step(step),
    }
}

/// Returns the methods of the table that can run a scene.
pub fn methods_of(scene: &mut Scene) -> Vec<&'static Method> {
    let split = scene.modal().is_some();
    METHODS
        .iter()
        .filter(|m| split || !m.info.linear_part)
        .collect()
}

/// Sink that compares the momentum of both gears of a scene with the impulse of their contact torques, by the
/// trapezoidal rule.
#[derive(Default)]
pub struct Impulse {
    /// Momentum of both gears at the start and at the end.
    momentum: [[f64; 2]; 2],
    impulse: [f64; 2],
    last: Option<[f64; 2]>,
    channels: [usize; 2],
    /// Largest force of the first mesh at an accepted step [N].
    pub peak: f64,
    out: Outputs,
}

impl Impulse {
    /// Creates the sink for a scene of two gears at a state.
    pub fn new(scene: &mut Scene, s: &State) -> Self {
        let channels = [0, 1].map(|k| {
            let name = format!("contact_torque:{}", scene.gears()[k].name);
            named(scene, &name)
        });
        let mut watch = Impulse {
            channels,
            momentum: [momenta(scene, s); 2],
            ..Impulse::default()
        };
        watch.last = Some(watch.torques(scene, s));
        watch
    }

    fn torques(&mut self, sys: &mut dyn SecondOrderSystem, s: &State) -> [f64; 2] {
        sys.output(s.at(), &mut self.out);
        self.peak = self.peak.max(self.out.channels[0]);
        self.channels.map(|c| self.out.channels[c])
    }

    /// Returns the largest relative difference between the impulse and the change of momentum of each gear.
    pub fn error(&mut self, scene: &Scene, end: &State) -> f64 {
        self.momentum[1] = momenta(scene, end);
        let off = |k: usize| {
            let gained = self.momentum[1][k] - self.momentum[0][k];
            (self.impulse[k] / gained - 1.0).abs()
        };
        off(0).max(off(1))
    }

    /// Returns the momentum of each gear at the start and at the end.
    pub fn momenta(&self) -> [[f64; 2]; 2] {
        self.momentum
    }
}

/// Returns the momentum of the first two gears of a scene about their axes.
fn momenta(scene: &Scene, s: &State) -> [f64; 2] {
    [0, 1].map(|k: usize| {
        let g = &scene.gears()[k];
        g.model.hub_state(g.at(s.at())).momentum
    })
}

impl Sink for Impulse {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let from = self.last.unwrap_or_default();
        let to = self.torques(sys, step.to);
        for k in 0..2 {
            self.impulse[k] += 0.5 * (step.to.t - step.from.t) * (from[k] + to[k]);
        }
        self.last = Some(to);
        Control::Continue
    }

    fn restarted(&mut self, sys: &mut dyn SecondOrderSystem, _before: &State, after: &State) {
        self.last = Some(self.torques(sys, after));
    }
}
