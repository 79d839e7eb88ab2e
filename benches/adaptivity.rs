//! Savings and errors of adaptivity inside a run: `cargo bench --bench adaptivity [-- --store FILE]`.
//!
//! `hammer` of rigid gears, movable teeth and elastic gears, each method with flights stepped through and crossed in
//! one step of the closed form (`free_flight`): steps, force evaluations, wall time by turns (the least of the repeats, as the machine may be shared), and how far
//! the impulse of the contact force and the last speeds are from those without the switch.

mod support;

use gearbench_integrators::observers::Tee;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::system::{Outputs, SecondOrderSystem};
use gearbench_integrators::{AcceptedStep, Control, NullSink, Resolution, Sink, TimePlan, Work};
use gearbench_models::scene::{Channel, OfMesh, Scene};
use serde_json::{Value, json};
use support::ratio::{Ratios, by_turns, ratios};
use support::scenes::{built, file, method, run, store};

/// Sink for the impulse of the contact force by the trapezoidal rule over accepted steps.
#[derive(Default)]
struct Impulse {
    force: usize,
    last: f64,
    sum: f64,
    /// Number of steps that begin or end in contact.
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

/// A scene with a method, and whether its vibration may be removed.
struct Candidate {
    scene: Scene,
    method: String,
}

/// Results by which a run is judged.
struct RunResult {
    work: Work,
    impulse: f64,
    closed: u64,
    speed: f64,
    residual: f64,
}

fn judged(candidate: &mut Candidate, plan: &TimePlan<'_>) -> RunResult {
    let scene = &mut candidate.scene;
    let mut ledger = Ledger::default();
    let mut impulse = Impulse {
        force: scene.channel(Channel::Mesh(0, OfMesh::Force)).unwrap(),
        ..Impulse::default()
    };
    let mut sinks = Tee(vec![&mut ledger, &mut impulse]);
    let mut method = method(&candidate.method);
    let (state, work, _) = run(scene, method.as_mut(), plan, &mut sinks);
    ledger.close(scene, &state);
    let pinion = &scene.gears()[0];
    let momentum = pinion.model.hub_state(pinion.at(state.at())).momentum;
    RunResult {
        work,
        impulse: impulse.sum,
        closed: impulse.closed,
        speed: momentum / pinion.model.hub().inertia,
        residual: ledger.residual_relative(),
    }
}

/// Prints a row of the table and returns its figures.
fn compare(
    criterion: &mut Ratios,
    what: &str,
    plan: &TimePlan<'_>,
    mut pair: [Candidate; 2],
) -> (String, Value) {
    let found = [0, 1].map(|k| judged(&mut pair[k], plan));
    let [off, on] = by_turns(criterion, "off / on", what, || {
        [0, 1].map(|k| {
            let Candidate {
                scene,
                method: text,
            } = &mut pair[k];
            run(scene, method(text).as_mut(), plan, &mut NullSink).2
        })
    });
    let relative = |of: &dyn Fn(&RunResult) -> f64| (of(&found[1]) / of(&found[0]) - 1.0).abs();
    let (impulse, speed) = (relative(&|f| f.impulse), relative(&|f| f.speed));
    let [a, b] = &found;
    let row = format!(
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
    let figures = json!({
        "what": what,
        "steps": [a.work.steps, b.work.steps],
        "steps_in_contact": [a.closed, b.closed],
        "force_evaluations": [a.work.force_evaluations, b.work.force_evaluations],
        "wall_s": [off, on],
        "ratio": off / on,
        "impulse_differs_rel": impulse,
        "speed_differs_rel": speed,
        "energy_residual_rel": [a.residual, b.residual],
    });
    (row, figures)
}

#[allow(clippy::print_stdout)]
fn main() {
    let file = file("hammer");
    let mut criterion = ratios(1.0);
    let mut rows = Vec::new();
    let candidate = |label: &str, method: &str| Candidate {
        scene: built(&file, label, &[]),
        method: method.to_owned(),
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
            candidate(label, method),
            candidate(label, &format!("{method}(free_flight=1)")),
        ];
        let what = format!("free_flight, {label}, {method}, {resolution:?}");
        rows.push(compare(&mut criterion, &what, &plan, pair));
    }
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
    let (rows, figures): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
    println!("{}", rows.join("\n"));
    store(
        "cargo bench --bench adaptivity -- --store FILE",
        json!({ "rows": figures }),
    );
}
