//! Reduced gears against full-order finite elements on the same mesh and law, against CalculiX, and their own ledgers.
//!
//! What is reduced shows beside the full order, whose own step is so small that its error does not; what is left
//! against CalculiX is what stands between the full order and CalculiX too. Limits stand a little above what was found.
//! Figures: `cargo test --release -p gearbench-tests --test external elastic -- --nocapture`.
#![allow(clippy::print_stdout)]

use super::full_order::load;
use gearbench::experiment::conditions::Conditions;
use gearbench::experiment::runner::Runner;
use gearbench::models::models;
use gearbench::scene_file::SceneFile;
use gearbench::studies::compare::{Plan, YardstickChoice, compare};
use gearbench_integrators::observers::Tee;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{Resolution, Scheme, TimePlan};
use gearbench_models::scene::Scene;
use gearbench_models::spec::Modelling;
use gearbench_reference::ExternalReference;
use gearbench_reports::metrics;
use gearbench_reports::record::Run;
use gearbench_tests::{Impulse, slope, watched};
use serde_json::Value;

type Case = (SceneFile, ExternalReference);

/// Parameters of the elastic model that replace those of the scene.
type ParameterOverrides<'a> = &'a [(&'a str, Value)];

fn change(modelling: &mut Modelling, other: ParameterOverrides<'_>) {
    for gear in &mut modelling.gears {
        for (key, value) in other {
            gear.set(key, value.clone()).unwrap();
        }
    }
}

fn run(
    (scene, external): &Case,
    label: &str,
    other: ParameterOverrides<'_>,
    method: Option<(&str, f64)>,
) -> Run {
    let mut plan = Plan {
        conditions: Conditions {
            repeats: 0,
            ..Conditions::of(scene)
        },
        tolerance: None,
        wanted: YardstickChoice::Stored,
        ..Plan::of(
            scene,
            &[scene.model(label).unwrap()],
            &[external.data([0, 1])],
        )
    };
    change(&mut plan.entries[0].modelling, other);
    if let Some((text, step)) = method {
        plan = plan.with_methods(vec![Scheme {
            method: text.parse().unwrap(),
            resolution: Resolution::Step(step),
        }]);
    }
    compare(&plan, &Runner::default()).unwrap().runs.remove(0)
}

/// Returns the errors of a run: force history, impulse, peak.
fn errors(what: &str, run: &Run, of: &Run) -> [f64; 3] {
    let reference = of.finished().and(Ok(of.series.as_ref())).unwrap().unwrap();
    let m = metrics::compare(run.finished().unwrap(), reference, "fe");
    let e = [m.force_l2, m.impulse_rel, m.peak_force_rel].map(Option::unwrap);
    println!(
        "{what}: force history {:.3} %, impulse {:+.4} %, peak {:+.3} %",
        100.0 * e[0],
        100.0 * e[1],
        100.0 * e[2]
    );
    e
}

#[test]
fn few_modes_with_residual_compliance_are_full_finite_elements() {
    let case = load("spur_impact", "fe,elastic,elastic-truncated");
    let full = run(&case, "fe", &[], Some(("newmark", 1e-7)));
    let modes = |n: f64| ("modes", Value::from(n));
    let mut of_modes = Vec::new();
    for (n, limits) in [
        (50.0, [0.011, 6e-4, 0.01]),
        (100.0, [6e-3, 2e-4, 2e-3]),
        (200.0, [4e-3, 2e-4, 2e-3]),
    ] {
        let found = run(&case, "elastic", &[modes(n)], None);
        assert!(found.modes.unwrap() <= n as usize);
        let what = format!("{n} modes at 1 us");
        let e = errors(&what, &found, &full);
        for (e, limit) in e.iter().zip(limits) {
            assert!(e.abs() < limit, "{what}: {e:.2e} beyond {limit:.0e}");
        }
        let calculix = found.against("calculix").unwrap().force_l2.unwrap();
        println!("{what}: against CalculiX {:.2} %", 100.0 * calculix);
        assert!(n < 100.0 || calculix < 0.012, "{calculix}");
        of_modes.push((found, e));
    }
    let (usual, [usual_error, ..]) = &of_modes[1];

    // The step leaves next to nothing: what kicks leave out of the modes is given to the residual compliance.
    let fine = run(&case, "elastic", &[], Some(("trigonometric", 2.5e-7)));
    let [apart, impulse, peak] = errors("1 us against 0.25 us", usual, &fine);
    assert!(apart < 1e-3 && impulse.abs() < 1e-4 && peak.abs() < 1e-3);

    // Cut modes without residual compliance.
    let truncated = run(&case, "elastic-truncated", &[], None);
    let what = format!("{} modes, plain truncation", truncated.modes.unwrap());
    let [e, ..] = errors(&what, &truncated, &full);
    println!(
        "plain truncation is {:.0} times further off",
        e / usual_error
    );
    assert!(e > 40.0 * usual_error, "{e} {usual_error}");
}

/// With Hertz's half-spaces in the place of the elements in contact, on both sides: what is left is the reduction.
#[test]
fn few_modes_on_half_spaces_are_full_finite_elements_on_half_spaces() {
    let case = load("spur_impact", "fe-half-space,elastic-half-space");
    let full = run(&case, "fe-half-space", &[], None);
    let fine = run(&case, "fe-half-space", &[], Some(("newmark", 1.25e-7)));
    let [step, ..] = errors("fe at 0.25 us against 0.125 us", &full, &fine);
    // Of second order: the finer one is off by a third of this.
    assert!(step < 1.5e-3, "{step:.2e}");
    for (n, limits) in [(100.0, [4.5e-3, 2e-4, 3e-3]), (200.0, [3e-3, 2e-4, 2e-3])] {
        let modes = ("modes", Value::from(n));
        let found = run(&case, "elastic-half-space", &[modes], None);
        let what = format!("{n} modes on half-spaces");
        let e = errors(&what, &found, &fine);
        for (e, limit) in e.iter().zip(limits) {
            assert!(e.abs() < limit, "{what}: {e:.2e} beyond {limit:.0e}");
        }
    }
}

/// Returns the relative change of energy over an impact, and of the gears' momenta from the impulse of the torques.
fn balance(scene: &mut Scene, h: f64, t_end: f64) -> (f64, f64) {
    let start = scene.initial();
    let (mut ledger, mut impulse) = (Ledger::default(), Impulse::new(scene, &start));
    let plan = TimePlan::new(t_end, Resolution::Step(h));
    let mut sinks = Tee(vec![&mut ledger, &mut impulse]);
    let (end, _) = watched(scene, start, "trigonometric", &plan, &mut sinks);
    assert_eq!(ledger.end.contact, 0.0, "the flanks have parted");
    let energy = ledger.end.total() / ledger.start.unwrap().total() - 1.0;
    (energy, impulse.error(scene, &end))
}

#[test]
fn impacts_keep_momentum_and_lose_little_energy() {
    let (scene, _) = load("spur_impact", "elastic");
    let choice = scene.model("elastic").unwrap();
    let spec = scene.spec_for(choice);
    let steps = [1e-6, 5e-7, 2e-7, 1e-7, 5e-8];
    let mut worst = [0.0_f64; 5];
    let (mut mean, mut square) = ([0.0_f64; 5], [0.0_f64; 5]);
    let gaps = 8;
    for gap in 0..gaps {
        let mut spec = spec.clone();
        // Steps of 1 us close the gap by 0.75 um each: contact begins at all phases of a step.
        spec.meshes[0].start.gap = 2e-6 + 0.75e-6 * f64::from(gap) / f64::from(gaps);
        let mut built = Scene::build(&spec, &choice.modelling, models()).unwrap();
        for (i, h) in steps.into_iter().enumerate() {
            let (energy, momentum) = balance(&mut built, h, 1.3e-4);
            println!(
                "gap {gap}, step {h:.0e} s: energy {energy:+.1e}, impulse off by {momentum:.0e}"
            );
            worst[i] = worst[i].max(energy.abs());
            mean[i] += energy / f64::from(gaps);
            square[i] += energy * energy;
            assert!(momentum < 1e-9, "step {h:e}: momentum {momentum:.1e}");
        }
    }
    for i in 0..steps.len() {
        square[i] = (square[i] / f64::from(gaps)).sqrt();
        println!(
            "step {:.1e} s: energy of an impact within {:.1e}, {:.1e} in the root mean square, {:+.1e} on average",
            steps[i], worst[i], square[i], mean[i]
        );
    }
    // The error goes by where within a step contact begins and ends: of either sign, and next to nothing on average.
    for (i, limit) in [(0, 2e-4), (2, 1e-5), (4, 5e-7)] {
        let h = steps[i];
        assert!(worst[i] < limit, "step {h:e}: energy {:.1e}", worst[i]);
    }
    assert!(mean[0].abs() < 1e-5, "made up on average: {mean:?}");
    let order = slope(&steps, &square);
    println!("falls with the power {order:.1} of the step");
    assert!(order > 1.9, "{order}");
}
