//! Clunk and rattle of the shipped steering gear (`steering_rattle`): the road force turns round, the rack crosses the backlash
//! and strikes the other flanks. The clunk is the first stay on these, rattle begins when the pinion leaves them again.

use gearbench::context::Context;
use gearbench::scene_file::{self, Selection};
use gearbench_integrators::observers::Tee;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{
    AcceptedStep, Control, Outputs, Report, Resolution, SecondOrderSystem, Sink, State, TimePlan,
};
use gearbench_models::scene::Scene;
use gearbench_tests::*;

/// Result of a model for the reversal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Clunk {
    /// Time of the impact [s].
    strikes: f64,
    /// Peak of the contact force [N].
    peak: f64,
    /// Time of the loss of contact, the onset of rattle [s].
    leaves: f64,
}

/// Force below which the end of a contact is not distinguished from rounding [N].
const LEAST: f64 = 1e-3;

/// Sink that finds the first period of contact on the flanks that drive the rack back.
struct Watch {
    force: usize,
    on_rack: usize,
    found: Clunk,
    out: Outputs,
}

impl Watch {
    fn new(scene: &Scene) -> Self {
        Watch {
            force: named(scene, "force:0"),
            on_rack: named(scene, "contact_torque:rack"),
            found: Clunk::default(),
            out: Outputs::default(),
        }
    }

    fn look(&mut self, sys: &mut dyn SecondOrderSystem, s: &State) {
        let report: &mut dyn Report = sys.report().expect("scenes report");
        report.sample(s.at(), &mut self.out);
        let (force, on_rack) = (
            self.out.channels[self.force],
            self.out.channels[self.on_rack],
        );
        let found = &mut self.found;
        if found.leaves > 0.0 {
            return;
        }
        if found.strikes == 0.0 && on_rack < -LEAST {
            found.strikes = s.t;
        } else if found.strikes > 0.0 && force < LEAST {
            found.leaves = s.t;
        }
        if found.strikes > 0.0 {
            found.peak = found.peak.max(force);
        }
    }
}

impl Sink for Watch {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        self.look(sys, step.to);
        Control::Continue
    }

    fn restarted(&mut self, sys: &mut dyn SecondOrderSystem, _: &State, after: &State) {
        self.look(sys, after);
    }
}

/// Runs a model of the scene.
fn of(label: &str, (method, resolution): (&str, Resolution), until: f64) -> (Clunk, Ledger, State) {
    let file = scene_file::load_for(
        &Context::default(),
        "steering_rattle",
        Selection::Labels(Some(label)),
    )
    .unwrap();
    let model = file.model(label).unwrap();
    let models = gearbench::models::models();
    let mut scene = Scene::build(&file.spec_for(model), &model.modelling, models).unwrap();
    let (mut ledger, mut watch) = (Ledger::default(), Watch::new(&scene));
    let begin = scene.initial();
    let plan = TimePlan::new(until, resolution);
    let mut both = Tee(vec![&mut ledger, &mut watch]);
    let (end, _) = watched(&mut scene, begin, method, &plan, &mut both);
    (watch.found, ledger, end)
}

const TIGHT: (&str, Resolution) = ("dopri5", Resolution::Tolerance(1e-10));
const EXACT: (&str, Resolution) = ("trigonometric", Resolution::Step(5e-7));
const UNTIL: f64 = 1.6e-3;

/// The energy balance of supplied, dissipated and stored energy closes, and runs repeat to the last bit.
#[test]
fn the_books_of_a_reversal_close_with_friction_and_runs_repeat() {
    for (label, method, most) in [
        ("rigid", TIGHT, 1e-7),
        ("movable-teeth", TIGHT, 1e-7),
        ("elastic", EXACT, 1e-4),
    ] {
        let (clunk, ledger, end) = of(label, method, UNTIL);
        println!(
            "{label}: {clunk:?}, {:.4} J lost of {:.4} J, {:.1e} of it not explained",
            ledger.dissipated,
            ledger.external,
            ledger.residual_relative()
        );
        assert!(ledger.residual_relative().abs() < most, "{label}");
        // Friction acts over some tenths of a millimetre.
        assert!(ledger.dissipated > 0.01, "{label}: {}", ledger.dissipated);
        assert_eq!(
            of(label, method, UNTIL).2,
            end,
            "{label} runs otherwise again"
        );
    }
}

/// All models are compared with full finite elements.
#[test]
#[ignore = "a minute: 1300 steps of full finite elements"]
fn clunk_and_onset_of_rattle_beside_finite_elements() {
    let until = 1.3e-3;
    let fe = of(
        "fe",
        ("hht-alpha(alpha=0.05)", Resolution::Step(1e-6)),
        until,
    )
    .0;
    println!("fe: {fe:?}");
    for (label, method, peak, time) in [
        ("rigid", TIGHT, 0.07, 5e-3),
        ("movable-teeth", TIGHT, 0.16, 1e-2),
        ("elastic", EXACT, 0.05, 2e-3),
    ] {
        let own = of(label, method, until).0;
        let off = [
            own.peak / fe.peak - 1.0,
            own.strikes / fe.strikes - 1.0,
            own.leaves / fe.leaves - 1.0,
        ];
        println!(
            "{label}: {own:?}; peak off by {:.2} %, strike by {:.2} %, onset of rattle by {:.2} %",
            1e2 * off[0],
            1e2 * off[1],
            1e2 * off[2]
        );
        assert!(off[0].abs() < peak, "{label}: {off:?}");
        assert!(
            off[1].abs() < time && off[2].abs() < time,
            "{label}: {off:?}"
        );
    }
}
