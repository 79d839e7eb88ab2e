//! Full-order finite elements against CalculiX on the same meshes, and their own ledgers.
//!
//! Same elements, same penalty, faceted flanks on both sides; what is left is how contact is integrated over
//! the faces and the scheme in time. Limits stand a little above what was found, far inside what is asked.

use gearbench::context::Context;
use gearbench::experiment::conditions::Conditions;
use gearbench::experiment::runner::Runner;
use gearbench::models::models;
use gearbench::scene_file::{self, SceneFile};
use gearbench::studies::compare::{Plan, compare};
use gearbench_integrators::observers::Tee;
use gearbench_integrators::system::{Outputs, SecondOrderSystem};
use gearbench_integrators::{AcceptedStep, Control, Resolution, Sink, TimePlan};
use gearbench_models::scene::Scene;
use gearbench_models::spec::PointRule;
use gearbench_reference::{ExternalReference, reference};
use gearbench_reports::record::Run;
use gearbench_tests::{Impulse, watched};
use std::sync::LazyLock;

/// Loads a scene with these models, and its reference.
pub(crate) fn load(name: &str, labels: &str) -> (SceneFile, ExternalReference) {
    let wanted = scene_file::Selection::Labels(Some(labels));
    let scene =
        scene_file::load_for(&Context::default(), name, wanted).unwrap_or_else(|e| panic!("{e:?}"));
    let external = crate::on_one_mesh(&scene);
    (scene, external)
}

/// Runs a model of a scene under its own integrator.
fn run(
    (scene, external): &(SceneFile, ExternalReference),
    label: &str,
    rule: Option<PointRule>,
) -> Run {
    let mut plan = Plan {
        conditions: Conditions {
            repeats: 0,
            ..Conditions::of(scene)
        },
        tolerance: None,
        ..Plan::of(
            scene,
            &[scene.model(label).unwrap()],
            &[external.data([0, 1])],
        )
    };
    for contact in &mut plan.entries[0].modelling.contacts {
        if let (Some(points), Some(rule)) = (contact.flanks.points_mut(), rule) {
            points.rule = rule;
        }
    }
    compare(&plan, &Runner::default()).unwrap().runs.remove(0)
}

/// Case A on fine flanks with the default points, run once.
static CASE_A: LazyLock<((SceneFile, ExternalReference), Run)> = LazyLock::new(|| {
    let case = load("spur_impact", "fe");
    let usual = run(&case, "fe", None);
    (case, usual)
});

struct Limits {
    force: f64,
    impulse: f64,
    peak: f64,
    rebound: f64,
}

/// Prints the errors of a run relative to CalculiX and checks them against limits.
#[allow(clippy::print_stdout)]
fn check(what: &str, run: &Run, external: &ExternalReference, limits: &Limits) {
    let m = run.against("calculix").unwrap();
    let force = m.force_l2.unwrap();
    let impulse = m.impulse_rel.unwrap();
    let peak = m.peak_force_rel.unwrap();
    let start = external.parameters.gears[0].speed;
    let end = external.summary.omega1_mean_end_rad_s;
    let rebound = (m.speeds_end[0].1 - end) / (start - end);
    println!(
        "{what}: force history {:.2} %, impulse {:+.3} %, peak {:+.2} %, rebound {:+.3} % of the span",
        100.0 * force,
        100.0 * impulse,
        100.0 * peak,
        100.0 * rebound
    );
    assert!(force < limits.force, "force history {force}");
    assert!(impulse.abs() < limits.impulse, "impulse {impulse}");
    assert!(peak.abs() < limits.peak, "peak {peak}");
    assert!(rebound.abs() < limits.rebound, "rebound {rebound}");
}

fn along(along: usize) -> Option<PointRule> {
    Some(PointRule::Quadrature { along, across: 2 })
}

#[test]
fn case_a_fine_with_quadrature_points_and_with_nodes() {
    let (case, usual) = &*CASE_A;
    let limits = Limits {
        force: 0.003,
        impulse: 1e-3,
        peak: 3e-3,
        rebound: 1e-3,
    };
    check(
        "case A fine, 8 points along a face",
        usual,
        &case.1,
        &limits,
    );
    // Fewer points stay further off: it is the integration of the contact that differs.
    let limits = Limits {
        force: 0.006,
        ..limits
    };
    let few = run(case, "fe", along(3));
    check("case A fine, 3 points along a face", &few, &case.1, &limits);
    let limits = Limits {
        force: 0.03,
        impulse: 2e-3,
        peak: 0.03,
        rebound: 0.005,
    };
    let nodes = run(case, "fe", Some(PointRule::Nodes));
    check("case A fine, nodes", &nodes, &case.1, &limits);
}

#[test]
fn on_coarse_flanks_the_integration_of_the_contact_decides() {
    // Eight elements per flank: one of them carries the force. The elements are the same in both programs, so
    // with more points along a face the difference goes away.
    let (mut scene, _) = load("spur_impact", "fe");
    let external = reference("calculix/case-a-coarse").unwrap();
    scene.duration = 1.3e-4;
    for model in &mut scene.models {
        for gear in &mut model.modelling.gears {
            if gear.id() == "fe" {
                gear.set("mesh", "calculix/case-a-coarse").unwrap();
            }
        }
    }
    let case = (scene, external);
    let limits = |force, peak| Limits {
        force,
        impulse: 2e-3,
        peak,
        rebound: 5e-3,
    };
    for (what, rule, limits) in [
        (
            "case A coarse, 3 points along a face",
            along(3),
            limits(0.08, 0.05),
        ),
        (
            "case A coarse, 8 points along a face",
            None,
            limits(0.03, 0.01),
        ),
        (
            "case A coarse, nodes",
            Some(PointRule::Nodes),
            limits(0.15, 0.05),
        ),
    ] {
        check(what, &run(&case, "fe", rule), &case.1, &limits);
    }
}

#[test]
fn case_c_the_rack_and_helical_gears() {
    let limits = Limits {
        force: 0.006,
        impulse: 2e-3,
        peak: 5e-3,
        rebound: 1e-3,
    };
    for scene in ["spur_impact_large", "rack_pinion", "helical_impact"] {
        let case = load(scene, "fe");
        let found = run(&case, "fe", None);
        check(scene, &found, &case.1, &limits);
    }
}

/// Quantities that velocity Verlet conserves exactly, with the impulse of the torques by the trapezoidal rule: the
/// work of the forces between half steps, `K_(n+1/2) - K_(n-1/2) = f_n . (q_(n+1) - q_(n-1)) / 2`; and the physical
/// energy, which it conserves to second order.
#[derive(Default)]
struct Ledger {
    out: Outputs,
    energy: [f64; 2],
    before: Vec<f64>,
    kinetic: [f64; 2],
    work: f64,
}

impl Ledger {
    fn half_step(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) {
        let h = step.to.t - step.from.t;
        let moved =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let forward = moved(&step.to.q, &step.from.q);
        let mut y = vec![0.0; forward.len()];
        sys.apply_mass(step.from.at(), &forward, &mut y);
        let kinetic = 0.5 * dot(&forward, &y) / (h * h);
        if self.before.is_empty() {
            self.kinetic[0] = kinetic;
        } else {
            sys.force(step.from.at(), &mut y);
            self.work += 0.5 * dot(&y, &moved(&step.to.q, &self.before));
        }
        self.kinetic[1] = kinetic;
        self.before.clone_from(&step.from.q);
    }
}

impl Sink for Ledger {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        if self.before.is_empty() {
            sys.output(step.from.at(), &mut self.out);
            self.energy[0] = self.out.energy.total();
        }
        self.half_step(sys, step);
        sys.output(step.to.at(), &mut self.out);
        self.energy[1] = self.out.energy.total();
        Control::Continue
    }
}

#[test]
#[allow(clippy::print_stdout)]
fn explicit_steps_keep_momentum_and_make_up_little_energy() {
    let (scene, _) = load("spur_impact", "fe-lumped");
    let choice = scene.model("fe-lumped").unwrap();
    let mut built = Scene::build(&scene.spec_for(choice), &choice.modelling, models()).unwrap();
    let mut drift = Vec::new();
    for h in [3e-8, 1.5e-8] {
        let start = built.initial();
        let (mut ledger, mut impulse) = (Ledger::default(), Impulse::new(&mut built, &start));
        // Until the flanks have parted; a whole number of steps.
        let plan = TimePlan::new(1.08e-4, Resolution::Step(h));
        let mut sinks = Tee(vec![&mut ledger, &mut impulse]);
        let (end, _) = watched(&mut built, start, "velocity-verlet", &plan, &mut sinks);
        let error = impulse.error(&built, &end);
        assert!(error < 1e-9, "impulse: {error:e}");
        println!("step {h:e} s: impulse off by {error:e}");
        let made_up = ledger.kinetic[1] - ledger.kinetic[0] - ledger.work;
        let relative = made_up / ledger.energy[0];
        assert!(relative.abs() < 1e-10, "work of the steps: {relative:e}");
        drift.push((ledger.energy[1] / ledger.energy[0] - 1.0).abs());
        println!(
            "step {h:e} s: work {relative:e}, energy {:e}",
            drift[drift.len() - 1]
        );
    }
    assert!(drift[0] < 5e-4, "{drift:?}");
    assert!(drift[1] < 0.5 * drift[0], "{drift:?}");
}

#[test]
#[allow(clippy::print_stdout)]
fn explicit_and_implicit_agree_on_the_same_masses() {
    let (case, implicit) = &*CASE_A;
    let (scene, external) = case;
    let plan = Plan {
        conditions: Conditions {
            repeats: 0,
            duration: 6e-5,
            ..Conditions::of(scene)
        },
        tolerance: None,
        ..Plan::of(
            scene,
            &[scene.model("fe").unwrap()],
            &[external.data([0, 1])],
        )
    };
    let plan = plan.with_methods(vec![
        gearbench_integrators::table::VELOCITY_VERLET.at_step(2.5e-8),
    ]);
    let explicit = compare(&plan, &Runner::default()).unwrap().runs.remove(0);
    let (a, b) = (implicit.series.as_ref().unwrap(), explicit.series.unwrap());
    let (mut difference, mut size) = (0.0, 0.0);
    for (t, f) in b.time_s.iter().zip(b.contact_force()) {
        let i = a
            .time_s
            .partition_point(|x| x < t)
            .clamp(1, a.time_s.len() - 1);
        let w = (t - a.time_s[i - 1]) / (a.time_s[i] - a.time_s[i - 1]);
        let force = a.contact_force();
        let g = force[i - 1] * (1.0 - w) + force[i] * w;
        difference += (f - g).powi(2);
        size += f * f;
    }
    let error = (difference / size).sqrt();
    println!(
        "explicit beside implicit, consistent mass: force history {:.2} %",
        100.0 * error
    );
    assert!(error < 0.005, "{error}");
}
