//! Tests of the study of coupling: labels, refined limits, truncated models, default steps, refusals.

use super::{BuiltModel, built, rigid};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::runner::Runner;
use crate::models::models;
use crate::scene_file::{Origin, SceneFile};
use crate::studies::coupling::frames::{HostError, frames};
use crate::studies::coupling::plan::{Entry, Plan, default_steps, keeps_residual, truncated};
use crate::studies::coupling::run::{WHOLE, study};
use crate::studies::coupling::stiffness;
use crate::studies::test_scene::coarse;
use gearbench_integrators::table::{RK4, VELOCITY_VERLET};
use gearbench_integrators::{Resolution, Scheme};
use gearbench_models::scene::Scene;
use gearbench_reports::coupling::{Extrapolation, Motion};
use gearbench_reports::record::Status;

/// A plan of one model.
fn plan(file: &SceneFile, method: Scheme, steps: Vec<f64>) -> Plan {
    let BuiltModel { entry, frames, .. } = built(file);
    let oscillator = stiffness::oscillator(&entry.scene, &entry.modelling, models(), &frames);
    Plan {
        conditions: Conditions::of(file),
        entries: vec![Entry {
            oscillator: oscillator.expect("matrices"),
            configuration: entry,
            frames,
            method,
            steps,
        }],
        extrapolations: vec![Extrapolation::Linear, Extrapolation::Quadratic],
        motions: vec![Motion::Linear],
        tolerance: 0.05,
    }
}

#[test]
fn a_study_labels_its_runs() {
    let file = rigid(400.0);
    let plan = plan(&file, RK4.at_step(2.5e-7), vec![1e-6, 5e-5]);
    assert_eq!((plan.len(), plan.lines().len()), (5, 2));
    let results = study(&plan, &Runner::default(), 2).expect("a record");
    assert!(results.runs[0].against(WHOLE).is_some() && results.runs[0].status.holds());
    for c in results.couplings() {
        let [small, large] = [&c.cells[0], &c.cells[1]];
        assert_eq!(small.status, Status::Converged, "{small:?}");
        assert!(small.force_l2.unwrap() < 0.01 && small.energy_error_rel.unwrap().abs() < 0.01);
        // Beyond theory hubs and teeth drive each other apart.
        assert!(
            c.theory_s.unwrap() < 5e-5 && large.status.is_failure(),
            "{large:?}"
        );
        assert!(large.message.is_some());
        assert!(c.accurate()[0] >= Some(1e-6) && c.stable()[1] <= Some(5e-5));
        // Closed in on.
        let [held, failed] = c.stable().map(Option::unwrap);
        assert!(failed < 1.06 * held && !c.refined.is_empty());
        assert!(
            (c.energy_j.unwrap() / small.energy_error_j.unwrap() * small.energy_error_rel.unwrap()
                - 1.0)
                .abs()
                < 1e-12
        );
    }
    // The result does not depend on the number of threads.
    let again = study(&plan, &Runner::default(), 1).expect("a record");
    assert_eq!(again.couplings(), results.couplings());
}

#[test]
fn a_twin_by_plain_truncation_has_the_lowest_modes_alone() {
    let file = coarse(&[("modes", 12.0.into())]);
    let of = Configuration::of(&file, &file.models[0]);
    let method = VELOCITY_VERLET.at_step(1e-8);
    let twin = truncated(&of, method, 1e-8);
    assert_eq!(
        (keeps_residual(&of), keeps_residual(&twin)),
        (Some(true), Some(false))
    );
    assert_eq!(twin.label, "elastic-truncated");
    assert_eq!(twin.variant().as_deref(), Some("truncated"));
}

#[test]
fn usual_steps_double_from_that_of_the_gears() {
    let steps = default_steps(&RK4.at_step(1e-6), Some([1e5, 0.0]), 1.0);
    assert!(steps.windows(2).all(|h| h[1] == 2.0 * h[0]) && steps[0] == 1e-6);
    assert!((2e-5..8e-5).contains(steps.last().unwrap()));
    // Never longer than a run, and there is always one.
    let short = default_steps(&RK4.at_step(1e-3), None, 1e-4);
    assert!(short.iter().all(|h| *h <= 1e-4) && !short.is_empty());
    let adaptive = Scheme {
        method: RK4,
        resolution: Resolution::Tolerance(1e-6),
    };
    assert!(default_steps(&adaptive, None, 1e-3).len() > 5);
}

#[test]
fn scenes_that_a_host_cannot_have_are_refused() {
    let held = rigid(0.0)
        .text()
        .replace("teeth = 20", "teeth = 20\nmount = \"fixed\"");
    let held = held.replace("teeth = 30", "teeth = 30\nmount = \"fixed\"");
    let file = SceneFile::unbuilt(
        &Context::default(),
        "own.toml",
        &held,
        Origin::Shipped,
        false,
    )
    .expect("a scene");
    let entry = Configuration::of(&file, &file.models[0]);
    let mut scene = Scene::build(&entry.scene, &entry.modelling, models()).expect("a model");
    assert_eq!(
        frames(&entry.scene, &mut scene).unwrap_err(),
        HostError::NoneFree
    );
    assert!(!HostError::NoneFree.help().is_empty());
}
