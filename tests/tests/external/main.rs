//! Comparison with results of other programs and of the literature: CalculiX impacts stored in `reference/`.
//!
//! The calibrated models must stay within what their fit reached; nothing here is a golden value of our own.

mod default_modes;
mod elastic;
mod full_order;
mod half_space;

use gearbench::context::Context;
use gearbench::experiment::conditions::Conditions;
use gearbench::experiment::runner::Runner;
use gearbench::scene_file;
use gearbench::scene_file::calibration::Constants;
use gearbench::studies::compare::{Plan, compare};
use gearbench::studies::identify::{DataSet, FitPlan, apply, identify};
use gearbench_integrators::table::DOPRI5;
use gearbench_models::gear::table::MODELS;
use gearbench_models::scene::{Channel, OfMesh};
use gearbench_reference::{ExternalReference, reference};
use gearbench_reports::record::Metrics;

/// Returns the reference of the models of a scene: its first one.
fn stored(scene: &scene_file::SceneFile) -> ExternalReference {
    let named = scene.reference().expect("the scene names a reference");
    reference(named.stored().expect("it is stored")).expect("it is known")
}

/// Returns the reference on whose mesh models of a scene run: its last one.
fn on_one_mesh(scene: &scene_file::SceneFile) -> ExternalReference {
    let named = scene
        .references
        .last()
        .expect("the scene names a reference");
    reference(named.stored().expect("it is stored")).expect("it is known")
}

/// Returns the metrics of each model of a scene relative to its reference, by label, under a strict adaptive method.
fn against_reference(name: &str) -> (Vec<(String, Metrics)>, ExternalReference) {
    let labels = Some("rigid,movable-teeth");
    let scene = scene_file::load_for(
        &Context::default(),
        name,
        scene_file::Selection::Labels(labels),
    );
    let scene = scene.unwrap_or_else(|e| panic!("{e:?}"));
    let external = stored(&scene);
    let choices = scene.select(labels).unwrap();
    let labels: Vec<String> = choices.iter().map(|m| m.label.clone()).collect();
    let plan = Plan {
        conditions: Conditions {
            samples: 200,
            repeats: 0,
            ..Conditions::of(&scene)
        },
        tolerance: None,
        ..Plan::of(&scene, &choices, &[external.data([0, 1])])
    }
    .with_methods(vec![DOPRI5.at_tolerance(1e-8)]);
    let record = compare(&plan, &Runner::default()).unwrap();
    let found = record
        .runs
        .iter()
        .zip(labels)
        .map(|(r, label)| (label, r.against("calculix").expect("compared").clone()))
        .collect();
    (found, external)
}

fn of<'a>(found: &'a [(String, Metrics)], label: &str) -> &'a Metrics {
    &found
        .iter()
        .find(|(l, _)| l == label)
        .expect("the model is in the scene")
        .1
}

#[test]
fn case_a_on_resolved_contacts_within_the_limits_of_rigid_and_movable_teeth() {
    let (found, external) = against_reference("spur_impact");
    for (label, limit) in [("rigid", 0.05), ("movable-teeth", 0.035)] {
        let m = of(&found, label);
        let error = m.force_l2_aligned.unwrap();
        assert!(
            error <= limit,
            "{label}: aligned force error {error:.4} beyond {limit}"
        );
        // Neither model keeps energy in vibrations of the bodies: they rebound a little too fast, by the
        // 1.5 % that the restitution of the reference leaves (e = 0.985).
        let impulse = m.impulse_rel.unwrap();
        assert!(
            (0.0..0.012).contains(&impulse),
            "{label}: impulse {impulse:+.4}"
        );
        let peak = m.peak_force_rel.unwrap();
        assert!(peak.abs() < 0.04, "{label}: peak {peak:+.4}");
        let span = 20.0 - external.summary.omega1_mean_end_rad_s;
        let rebound = (m.speeds_end[0].1 - external.summary.omega1_mean_end_rad_s) / span;
        assert!(
            rebound.abs() < 0.01,
            "{label}: rebound {rebound:+.4} of the span"
        );
    }
    let (rigid, teeth) = (of(&found, "rigid"), of(&found, "movable-teeth"));
    assert!(
        teeth.force_l2_aligned < rigid.force_l2_aligned,
        "movable teeth follow the ripples better"
    );
}

#[test]
fn case_c_in_force_impulse_and_rebound() {
    // The bodies of case C ring at 19 and 30 kHz within a contact of 0.3 ms.
    let (found, external) = against_reference("spur_impact_large");
    for label in ["rigid", "movable-teeth"] {
        let m = of(&found, label);
        assert!(
            m.force_l2_aligned.unwrap() < 0.05,
            "{label}: {:?}",
            m.force_l2_aligned
        );
        assert!(
            m.impulse_rel.unwrap().abs() < 0.012,
            "{label}: {:?}",
            m.impulse_rel
        );
        assert!(
            m.peak_force_rel.unwrap().abs() < 0.10,
            "{label}: {:?}",
            m.peak_force_rel
        );
        let end = external.summary.omega2_mean_end_rad_s;
        assert!(
            (m.speeds_end[1].1 / end - 1.0).abs() < 0.012,
            "{label}: {:?} against {end}",
            m.speeds_end
        );
    }
}

#[test]
fn identification_finds_the_stored_rigid_calibration_again() {
    let name = "spur_impact";
    let wanted = scene_file::Selection::Labels(Some("rigid"));
    let scene = scene_file::load_uncalibrated(&Context::default(), name, wanted)
        .unwrap_or_else(|e| panic!("{e:?}"));
    let external = stored(&scene);
    let choice = scene.model("rigid").unwrap();
    let history = &external.history;
    let spec = scene.spec_for(choice);
    let plan = FitPlan {
        data: vec![DataSet::history(
            name,
            &spec,
            &history.time,
            &history.contact_force,
        )],
        ..FitPlan::new(scene.clone(), &choice.label, &choice.modelling)
    };
    let found = identify(&plan, &Runner::default(), |_, _| {}).unwrap();
    let calibrated =
        scene_file::load_for(&Context::default(), name, wanted).unwrap_or_else(|e| panic!("{e:?}"));
    let constants = calibrated
        .model("rigid")
        .unwrap()
        .calibration
        .clone()
        .unwrap()
        .constants
        .unwrap();
    let parameters = &found.record.parameters;
    let stiffness = (parameters.iter().find(|p| p.key == "stiffness_n_per_m2")).unwrap();
    let value = stiffness.value.unwrap();
    let stored = constants.stiffness.unwrap();
    assert!(
        (value / stored - 1.0).abs() < 1e-4,
        "{value} against {stored}"
    );
    // What is left is correlated over many samples: the interval is wider than that of independent errors, of 1 %.
    let half = stiffness.relative().unwrap();
    assert!((0.02..0.15).contains(&half), "{stiffness:?}");
    assert!(found.record.data[0].l2 < 0.05);

    // The fit is a minimum: either neighbour is worse.
    let error = |factor: f64| {
        let (mut spec, mut modelling) = (scene.spec_for(choice), choice.modelling.clone());
        let gap = constants.gap.unwrap();
        apply(
            &Constants::of([("stiffness_n_per_m2", factor * stored), ("gap_m", gap)]),
            &choice.model,
            &mut spec,
            &mut modelling,
        )
        .unwrap();
        let mut built = gearbench_models::scene::Scene::build(&spec, &modelling, MODELS).unwrap();
        let force = gearbench::experiment::run::history_on_grid(
            &Context::default(),
            &mut built,
            &DOPRI5.at_tolerance(1e-8),
            u64::MAX,
            (&external.history.time, Channel::Mesh(0, OfMesh::Force)),
        )
        .unwrap();
        force
            .iter()
            .zip(&external.history.contact_force)
            .map(|(a, b)| (a - b).powi(2))
            .sum::<f64>()
    };
    assert!(error(1.0) < error(0.98) && error(1.0) < error(1.02));
}
