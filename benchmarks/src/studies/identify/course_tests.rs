//! Tests of constants along the path and of single gears: recovery from data, and refusal for models without them.

use super::tests::{fitted, impact, keys, made, outcomes, plan};
use super::*;
use crate::experiment::runner::Runner;
use crate::scene_file::calibration::{CURVATURE, Constants, GAP, SLOPE, STIFFNESS};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::spec::{FlankContact, PointContact, SceneSpec};
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reports::identify::Outcome;

/// Impacts whose pair begins at places along the path.
fn along(spec: &SceneSpec, places: &[f64]) -> Vec<DataSet> {
    let at = |&s: &f64| {
        let mut spec = spec.clone();
        spec.meshes[0].start.path_coordinate = Some(s);
        impact(&spec, 20.0, &format!("at {s}"))
    };
    places.iter().map(at).collect()
}

/// The values that data were made with are found within a few intervals, and these are narrow.
fn meets(found: &Identification, truth: &[(&str, f64)], narrow: f64) {
    assert!(
        outcomes(found).iter().all(|o| *o == Outcome::Identified),
        "{:?}",
        found.record
    );
    for (p, (key, x)) in found.record.parameters.iter().zip(truth) {
        assert_eq!(p.key, *key);
        let [low, high] = [p.low, p.high].map(Option::unwrap);
        let wide = 1.5 * (high - low);
        assert!(
            (p.value.unwrap() - x).abs() < wide && wide < narrow * x.abs(),
            "{p:?}"
        );
    }
}

#[test]
fn a_course_along_the_path_is_found_again() {
    let (mut plan, spec) = plan("rigid");
    let truth = [
        (STIFFNESS, 1.5e10),
        (SLOPE, 0.2),
        (CURVATURE, -0.3),
        (GAP, 3e-6),
    ];
    for set in along(&spec, &[0.008, 0.011, 0.014, 0.017]) {
        let set = made(&plan, set, &Constants::of(truth), 1e-3);
        plan.data.push(set);
    }
    plan.wishes.fit = keys(&truth.map(|t| t.0));
    let found = fitted(&plan);
    meets(&found, &truth, 0.2);
    // One start of the model, and the best fit without the course.
    assert_eq!((found.record.starts, found.record.starts_agreed), (2, 2));
    let named = &found.record.parameters[1];
    assert_eq!(
        (named.name.as_str(), named.unit.as_str()),
        ("stiffness slope along the path", "")
    );
}

#[test]
fn constants_of_single_gears_are_found_again() {
    let (mut plan, spec) = plan("movable-teeth");
    let truth = [
        (STIFFNESS, 2.7e10),
        ("pinion.tooth_stiffness_n_per_m", 9e8),
        ("wheel.tooth_stiffness_n_per_m", 6e8),
        ("pinion.tooth_mass_kg", 4e-3),
        ("wheel.tooth_mass_kg", 7e-3),
    ];
    let held = Constants::of(truth).merged_with(&Constants::of([(GAP, 3e-6)]));
    for (speed, name) in [(20.0, "slow"), (60.0, "fast")] {
        let set = made(&plan, impact(&spec, speed, name), &held, 1e-4);
        plan.data.push(set);
    }
    plan.wishes.fit = keys(&truth.map(|t| t.0));
    plan.wishes.held = vec![(GAP.into(), 3e-6)];
    // Two teeth that swing on springs in series look much like the same two the other way round.
    plan.wishes.starts = vec![
        ("pinion.tooth_stiffness_n_per_m".into(), 8e8),
        ("wheel.tooth_stiffness_n_per_m".into(), 7e8),
        ("pinion.tooth_mass_kg".into(), 5e-3),
        ("wheel.tooth_mass_kg".into(), 6e-3),
    ];
    let found = fitted(&plan);
    let own = &found.record.parameters[1];
    assert_eq!(own.name, "tooth stiffness of pinion");
    for (p, (key, x)) in found.record.parameters.iter().zip(truth) {
        assert_eq!(p.key, key);
        assert!((p.value.unwrap() / x - 1.0).abs() < 0.05, "{p:?}");
    }
    assert_eq!(found.record.parameters[5].value, Some(3e-6));
}

/// The own constant of a gear overrides the one of all gears, in whatever order they are given.
#[test]
fn constants_of_a_gear_come_after_those_of_all() {
    let (plan, mut spec) = plan("movable-teeth");
    let of = |mass: f64| Constants::of([("tooth_mass_kg", 5e-3), ("wheel.tooth_mass_kg", mass)]);
    let mut modelling = plan.modelling.clone();
    apply(&of(4e-3), "movable-teeth", &mut spec, &mut modelling).unwrap();
    let mass = |i: usize| modelling.gears[i].values()["tooth_mass_kg"].as_f64();
    assert_eq!([mass(0), mass(1)], [Some(5e-3), Some(4e-3)]);
}

#[test]
fn what_a_model_has_not_is_refused_with_what_there_is() {
    let refused = |label: &str, key: &str, change: &dyn Fn(&mut FitPlan)| {
        let (mut plan, spec) = plan(label);
        plan.data = vec![made(
            &plan,
            impact(&spec, 20.0, "impact"),
            &Constants::of([(STIFFNESS, 1e10)]),
            0.0,
        )];
        plan.wishes.fit = keys(&[key]);
        change(&mut plan);
        let e = identify(&plan, &Runner::default(), |_, _| {}).unwrap_err();
        assert!(e.is_of_wishes(), "{e}");
        e.to_string()
    };
    let nothing = |_: &mut FitPlan| {};
    for (label, key, words) in [
        (
            "rigid",
            "pinion.tooth_mass_kg",
            &["`rigid`", "no constants of their own"][..],
        ),
        ("movable-teeth", "pinon.tooth_mass_kg", &["pinion, wheel"]),
        (
            "movable-teeth",
            "pinion.gap_m",
            &["`gap_m`", "tooth_mass_kg"],
        ),
        (
            "movable-teeth",
            "pinion.tooth_mas_kg",
            &["`tooth_mas_kg`", "tooth_mass_kg"],
        ),
    ] {
        let said = refused(label, key, &nothing);
        assert!(words.iter().all(|w| said.contains(w)), "{key}: {said}");
    }
    // No stiffness that a course could be one of, and contacts at points of flanks.
    let normed = |plan: &mut FitPlan| {
        plan.modelling.contacts[0].stiffness =
            gearbench_models::stiffness::PairStiffness::Iso6336 {
                variation: Default::default(),
            };
    };
    assert!(refused("rigid", SLOPE, &normed).contains("stiffness_n_per_m2"));
    let points = |plan: &mut FitPlan| {
        plan.modelling.contacts[0].flanks = FlankContact::Points(PointContact::new(1e15));
        plan.modelling.gears[1] = ElasticParameters::default().spec();
    };
    assert!(refused("rigid", CURVATURE, &points).contains("contact at flank points"));
}

/// The weight of the peak counts as documented, and none changes nothing.
#[test]
fn residuals_are_weighed_by_the_force() {
    let (plan, spec) = plan("rigid");
    let truth = Constants::of([(STIFFNESS, 1e10)]);
    let mut set = made(&plan, impact(&spec, 20.0, "impact"), &truth, 0.0);
    let size = set.size();
    assert!(set.factors().iter().all(|f| (f * size - 1.0).abs() < 1e-12));
    set.peak_weight = 3.0;
    let factors = set.factors();
    let values = set.values();
    let at = |i: usize| factors[i];
    let peak = (0..values.len())
        .max_by(|&i, &j| values[i].total_cmp(&values[j]))
        .unwrap();
    assert_eq!(values[0], 0.0);
    assert!((at(peak) / at(0) - 3.0).abs() < 1e-12);
    let weighed: f64 = factors
        .iter()
        .zip(values)
        .map(|(f, y)| (f * y).powi(2))
        .sum();
    assert!((weighed - 1.0).abs() < 1e-12);
}
