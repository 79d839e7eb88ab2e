//! What adaptivity inside a run saves and what it changes: `cargo bench -p gearbench --bench adaptivity [-- --store
//! FILE]`.
//!
//! `hammer` of rigid gears, movable teeth and elastic gears, each method with flights stepped through and crossed in
//! one step of the closed form (`free_flight`), then with teeth and modes put to rest in flight (`vibration_cut_off`):
//! steps, force evaluations, wall time by turns (the least of the repeats, as the machine may be shared), and how far
//! the impulse of the contact force and the last speeds are from those without the switch.

use gearbench::scene_file::{self, SceneFile};
use gearbench_integrators::observers::Tee;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::system::{Outputs, SecondOrderSystem};
use gearbench_integrators::{
    AcceptedStep, Control, NullSink, Resolution, Sink, State, TimePlan, Work,
};
use gearbench_models::scene::{Channel, OfMesh, Scene};
use gearbench_models::spec;
use serde_json::{Value, json};
use std::time::Instant;

/// Repeats by turns: at least so many, and for so long [s].
const REPEATS: u32 = 5;
const LONG: f64 = 1.0;

/// Impulse of the contact force by the trapezoid rule over accepted steps.
#[derive(Default)]
struct Impulse {
    force: usize,
    last: f64,
    sum: f64,
    /// Steps that begin or end in contact.
    closed: u64,
    out: Outputs,
}

impl Sink for Impulse {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        sys.output(step.to.at(), &mut self.out);
        let force = self.out.channels[self.force];
        self.sum += 0.5 * (step.to.t - step.from.t) * (self.last + force);
        self.closed += u64::from(force != 0.0 || self.last != 0.0);
        self.last = force;
        Control::Continue
    }
}

/// A scene with a method, and whether its gears may lose their vibration.
struct Candidate {
    scene: Scene,
    method: String,
    /// Least wall time [s].
    least: f64,
}

/// What a run is judged by.
struct Found {
    work: Work,
    impulse: f64,
    closed: u64,
    speed: f64,
    residual: f64,
}

fn run(scene: &mut Scene, text: &str, plan: &TimePlan<'_>, sink: &mut dyn Sink) -> (State, Work) {
    let mut method = gearbench_integrators::method(text).unwrap_or_else(|e| panic!("{e}"));
    let (mut state, mut work) = (scene.initial(), Work::default());
    let done = method.run(scene, &mut state, plan, sink, &mut work);
    done.unwrap_or_else(|e| panic!("{text}: {e}"));
    (state, work)
}

fn judged(candidate: &mut Candidate, plan: &TimePlan<'_>) -> Found {
    let scene = &mut candidate.scene;
    let mut ledger = Ledger::default();
    let mut impulse = Impulse {
        force: scene.channel(Channel::Mesh(0, OfMesh::Force)).unwrap(),
        ..Impulse::default()
    };
    let mut sinks = Tee(vec![&mut ledger, &mut impulse]);
    let (state, work) = run(scene, &candidate.method, plan, &mut sinks);
    ledger.close(scene, &state);
    let pinion = &scene.gears()[0];
    let momentum = pinion.model.hub_state(pinion.at(state.at())).momentum;
    Found {
        work,
        impulse: impulse.sum,
        closed: impulse.closed,
        speed: momentum / pinion.model.hub().inertia,
        residual: ledger.residual_relative(),
    }
}

fn built(file: &SceneFile, label: &str, vibration_cut_off: f64) -> Scene {
    let choice = file
        .model(label)
        .unwrap_or_else(|| panic!("no model {label}"));
    let mut modelling = choice.modelling.clone();
    for gear in &mut modelling.gears {
        if vibration_cut_off > 0.0 {
            let value = spec::Value::Number(vibration_cut_off);
            gear.parameters.insert("vibration_cut_off".into(), value);
        }
    }
    let scene = Scene::build(
        &file.spec_for(choice),
        &modelling,
        gearbench::models::models(),
    );
    scene.unwrap_or_else(|e| panic!("{e}"))
}

#[allow(clippy::print_stdout)]
fn compare(what: &str, plan: &TimePlan<'_>, mut pair: [Candidate; 2]) -> Value {
    let found = [0, 1].map(|k| judged(&mut pair[k], plan));
    // By turns, so that both see the same machine.
    let started = Instant::now();
    let mut turns = 0;
    while turns < REPEATS || started.elapsed().as_secs_f64() < LONG {
        turns += 1;
        for candidate in &mut pair {
            let begin = Instant::now();
            run(&mut candidate.scene, &candidate.method, plan, &mut NullSink);
            candidate.least = candidate.least.min(begin.elapsed().as_secs_f64());
        }
    }
    let [off, on] = pair.map(|c| c.least);
    let relative = |of: &dyn Fn(&Found) -> f64| (of(&found[1]) / of(&found[0]) - 1.0).abs();
    let (impulse, speed) = (relative(&|f| f.impulse), relative(&|f| f.speed));
    let [a, b] = &found;
    println!(
        "{what:<58} {:>8} {:>7} {:>8} {:>9} {:>7} {:>9.2} {:>8.2} {:>7.2} {:>9.1e} {:>9.1e} {:>9.1e}",
        a.work.steps,
        b.work.steps,
        b.closed,
        a.work.force_evaluations,
        b.work.force_evaluations,
        1e3 * off,
        1e3 * on,
        off / on,
        impulse,
        speed,
        b.residual
    );
    json!({
        "what": what,
        "steps": [a.work.steps, b.work.steps],
        "steps_in_contact": [a.closed, b.closed],
        "force_evaluations": [a.work.force_evaluations, b.work.force_evaluations],
        "wall_s": [off, on],
        "ratio": off / on,
        "impulse_differs_rel": impulse,
        "speed_differs_rel": speed,
        "energy_residual_rel": [a.residual, b.residual],
    })
}

#[allow(clippy::print_stdout)]
fn main() {
    let mut words = std::env::args().skip(1);
    let mut store = None;
    while let Some(word) = words.next() {
        if word == "--store" {
            store = words.next();
        }
    }
    let file = scene_file::load("hammer").unwrap_or_else(|e| panic!("{e:?}"));
    println!(
        "{:<58} {:>16} {:>8} {:>17} {:>18} {:>7} {:>9} {:>9} {:>9}",
        "hammer: off and on",
        "steps",
        "closed",
        "evaluations",
        "wall [ms]",
        "ratio",
        "impulse",
        "speed",
        "energy"
    );
    let mut rows = Vec::new();
    let candidate = |label: &str, method: &str, vibration_cut_off: f64| Candidate {
        scene: built(&file, label, vibration_cut_off),
        method: method.to_owned(),
        least: f64::INFINITY,
    };
    let (step, rtol) = (Resolution::Step, Resolution::Tolerance);
    let cases = [
        ("rigid", "velocity-verlet", step(1e-6)),
        ("rigid", "rk4", step(2e-6)),
        ("rigid", "hht-alpha", step(1e-6)),
        ("rigid", "dopri5", rtol(1e-6)),
        ("rigid", "bdf", rtol(1e-6)),
        ("movable-teeth", "velocity-verlet", step(1e-6)),
        ("movable-teeth", "hht-alpha", step(1e-6)),
        ("movable-teeth", "dopri5", rtol(1e-6)),
        ("movable-teeth", "bdf", rtol(1e-6)),
        ("elastic", "velocity-verlet", step(1e-7)),
        ("elastic", "rk4", step(2e-7)),
    ];
    for (label, method, resolution) in cases {
        // Elastic gears cost more: a part of the duration, of several impacts.
        let part = if label == "elastic" { 0.08 } else { 1.0 };
        let plan = TimePlan::new(part * file.duration, resolution);
        let pair = [
            candidate(label, method, 0.0),
            candidate(label, &format!("{method}(free_flight=1)"), 0.0),
        ];
        let what = format!("free_flight, {label}, {method}, {resolution:?}");
        rows.push(compare(&what, &plan, pair));
    }
    for (label, method, resolution, vibration_cut_off) in [
        (
            "movable-teeth",
            "velocity-verlet(free_flight=1)",
            step(1e-6),
            1e-6,
        ),
        ("movable-teeth", "dopri5(free_flight=1)", rtol(1e-6), 1e-6),
        ("elastic", "trigonometric", step(1e-6), 1e-4),
    ] {
        let plan = TimePlan::new(file.duration, resolution);
        let pair = [
            candidate(label, method, 0.0),
            candidate(label, method, vibration_cut_off),
        ];
        let what = format!("vibration_cut_off {vibration_cut_off:.0e}, {label}, {method}");
        rows.push(compare(&what, &plan, pair));
    }
    if let Some(file) = store {
        let figures = json!({
            "command": "cargo bench -p gearbench --bench adaptivity -- --store FILE",
            "machine": gearbench::experiment::machine::machine(),
            "date": gearbench::experiment::machine::now(),
            "commit": gearbench::experiment::machine::COMMIT,
            "rows": rows,
        });
        let text = format!("{figures:#}\n");
        std::fs::write(&file, text).unwrap_or_else(|e| panic!("{file}: {e}"));
    }
}
