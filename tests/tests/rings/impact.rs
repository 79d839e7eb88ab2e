//! One impact of a pinion on a ring: elastic gears compared with full finite elements, and ledgers.

use super::*;
use gearbench::context::Context;
use gearbench::experiment::conditions::Conditions;
use gearbench::experiment::runner::Runner;
use gearbench::scene_file::{SceneFile, Selection, load_for};
use gearbench::studies::compare::{Plan, YardstickChoice, compare};
use gearbench_integrators::observers::Tee;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{Resolution, TimePlan};
use gearbench_reports::metrics;
use gearbench_reports::record::Run;
use gearbench_tests::{Impulse, watched};

fn scene() -> SceneFile {
    let wanted = Selection::Labels(Some("elastic,fe"));
    load_for(&Context::default(), "ring_impact", wanted).unwrap_or_else(|e| panic!("{e:?}"))
}

fn run(scene: &SceneFile, label: &str, modes: Option<f64>) -> Run {
    let mut plan = Plan {
        conditions: Conditions {
            repeats: 0,
            ..Conditions::of(scene)
        },
        tolerance: None,
        wanted: YardstickChoice::Stored,
        ..Plan::of(scene, &[scene.model(label).unwrap()], &[])
    };
    for gear in &mut plan.entries[0].modelling.gears {
        if let Some(n) = modes {
            gear.set("modes", n).unwrap();
        }
    }
    compare(&plan, &Runner::default()).unwrap().runs.remove(0)
}

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

/// With many modes the remaining difference is that deflected flanks of finite elements touch slightly beside the
/// contact point of undeformed ones.
#[test]
fn modes_with_residual_compliance_are_full_finite_elements() {
    let scene = scene();
    let full = run(&scene, "fe", None);
    for (modes, limits) in [(100.0, [6e-3, 2e-3, 5e-3]), (400.0, [6e-3, 2e-3, 3e-3])] {
        let found = run(&scene, "elastic", Some(modes));
        let what = format!("{} modes", found.modes.unwrap());
        let e = errors(&what, &found, &full);
        for (e, limit) in e.iter().zip(limits) {
            assert!(e.abs() < limit, "{what}: {e:.2e} beyond {limit:.0e}");
        }
    }
}

#[test]
fn impacts_keep_momentum_and_lose_little_energy() {
    let scene = scene();
    let choice = scene.model("elastic").unwrap();
    let spec = scene.spec_for(choice);
    let mut built = Scene::build(&spec, &choice.modelling, gearbench::models::models()).unwrap();
    for (h, limit) in [(1e-6, 3e-4), (2.5e-7, 2e-5), (1e-7, 1e-6)] {
        let start = built.initial();
        let (mut ledger, mut impulse) = (Ledger::default(), Impulse::new(&mut built, &start));
        let plan = TimePlan::new(scene.duration, Resolution::Step(h));
        let mut sinks = Tee(vec![&mut ledger, &mut impulse]);
        let (end, _) = watched(&mut built, start, "trigonometric", &plan, &mut sinks);
        assert_eq!(ledger.end.contact, 0.0, "the flanks have parted");
        let energy = ledger.end.total() / ledger.start.unwrap().total() - 1.0;
        let momentum = impulse.error(&built, &end);
        println!("step {h:.1e} s: energy {energy:+.1e}, impulse off by {momentum:.0e}");
        assert!(
            energy.abs() < limit && momentum < 1e-9,
            "{energy} {momentum}"
        );
    }
}
