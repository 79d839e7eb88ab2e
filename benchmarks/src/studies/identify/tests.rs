//! Tests with data made from known constants: the fit recovers them, and reports those that the data do not determine.

use super::*;
use crate::context::Context;
use crate::experiment::conditions::even;
use crate::experiment::runner::Runner;
use crate::scene_file::calibration::{Constants, DAMPING, GAP, STIFFNESS};
use crate::scene_file::{Selection, load_for};
use gearbench_reports::identify::Outcome;

const TOOTH_STIFFNESS: &str = "tooth_stiffness_n_per_m";
const TOOTH_MASS: &str = "tooth_mass_kg";
const TOOTH_DAMPING: &str = "tooth_damping_ns_per_m";
/// Close to what `spur_impact` was calibrated to.
const TRUTH: [(&str, f64); 4] = [
    (STIFFNESS, 2.7e10),
    (TOOTH_STIFFNESS, 7.8e8),
    (TOOTH_MASS, 5.2e-3),
    (GAP, 3e-6),
];

/// Returns a plan for the shipped impact with its own constants, still without data.
pub(super) fn plan(label: &str) -> (FitPlan, gearbench_models::spec::SceneSpec) {
    let scene = load_for(
        &Context::default(),
        "spur_impact",
        Selection::Labels(Some(label)),
    )
    .unwrap();
    let choice = scene.model(label).unwrap();
    let plan = FitPlan::new(scene.clone(), label, &choice.modelling);
    (plan, scene.spec_for(choice))
}

/// Returns data that the model itself makes with constants, with noise relative to the root mean square.
pub(super) fn made(plan: &FitPlan, mut set: DataSet, truth: &Constants, noise: f64) -> DataSet {
    let values = modelled(plan, &set, truth, Clock::default()).unwrap();
    let rms = plan::size(&values) / (values.len() as f64).sqrt();
    let mut random = estimate::tests::Draws::new(7);
    let values: Vec<f64> = (values.iter())
        .map(|x| x + noise * rms * random.normal())
        .collect();
    match &mut set.data {
        Data::History { values: own, .. } => *own = values,
        Data::Statics(target) => target.compliance = values,
    }
    set
}

/// Returns an impact at a given speed of the first gear.
pub(super) fn impact(spec: &gearbench_models::spec::SceneSpec, speed: f64, name: &str) -> DataSet {
    let mut spec = spec.clone();
    spec.gears[0].speed = speed;
    let time = even(200, 1.4e-4);
    DataSet::history(name, &spec, &time, &time)
}

/// A mesh cycle at rest.
fn at_rest(spec: &gearbench_models::spec::SceneSpec) -> DataSet {
    let target = StaticTarget {
        force: 1000.0,
        compliance: vec![1.0; 8],
    };
    DataSet::statics("at rest", spec, target)
}

pub(super) fn keys(all: &[&str]) -> Option<Vec<String>> {
    Some(all.iter().map(|k| (*k).to_owned()).collect())
}

pub(super) fn fitted(plan: &FitPlan) -> Identification {
    identify(plan, &Runner::default(), |_, _| {}).unwrap()
}

pub(super) fn outcomes(found: &Identification) -> Vec<Outcome> {
    found.record.parameters.iter().map(|p| p.outcome).collect()
}

/// A fit to two speeds at once recovers the constants that the data were made with, and predicts a third speed, which
/// was not fitted.
#[test]
fn constants_of_made_data_are_found_again() {
    let (mut plan, spec) = plan("movable-teeth");
    let truth = Constants::of(TRUTH);
    for (speed, name) in [(20.0, "slow"), (60.0, "fast")] {
        let set = made(&plan, impact(&spec, speed, name), &truth, 1e-3);
        plan.data.push(set);
    }
    let held_out = made(&plan, impact(&spec, 40.0, "between"), &truth, 0.0);
    plan.held_out.push(held_out);
    let found = fitted(&plan);
    assert_eq!(
        outcomes(&found),
        [Outcome::Identified; 4],
        "{:?}",
        found.record
    );
    assert!(found.record.undetermined.is_empty());
    for (p, (key, x)) in found.record.parameters.iter().zip(TRUTH) {
        assert_eq!(p.key, key);
        let [low, high] = [p.low, p.high].map(Option::unwrap);
        let wide = 1.5 * (high - low);
        assert!(
            (p.value.unwrap() - x).abs() < wide && wide < 0.1 * x,
            "{p:?}"
        );
    }
    let [slow, fast, between] = &found.record.data[..] else {
        panic!("three data sets");
    };
    assert!(!slow.validation && !fast.validation && between.validation);
    assert!(between.l2 < 2e-3, "{}", between.l2);
    assert!(between.impulse_rel.unwrap().abs() < 1e-3);
}

/// Three set-ups whose data do not determine a parameter: each is explained in words, and the parameter has no value.
#[test]
fn what_the_data_do_not_tell_is_said_and_has_no_value() {
    let truth = Constants::of(TRUTH);
    let (plan, spec) = plan("movable-teeth");
    let with = |set: DataSet, noise: f64, fit: &[&str]| {
        let data = vec![made(&plan, set, &truth, noise)];
        let wishes = FitOptions {
            fit: keys(fit),
            ..FitOptions::default()
        };
        fitted(&FitPlan {
            data,
            wishes,
            ..plan.clone()
        })
    };
    // Springs in series at rest, with and without noise.
    for noise in [0.0, 1e-3] {
        let found = with(at_rest(&spec), noise, &[STIFFNESS, TOOTH_STIFFNESS]);
        assert_eq!(outcomes(&found), [Outcome::NotIdentifiable; 2]);
        assert_eq!(found.record.undetermined.len(), 1, "{:?}", found.record);
        let said = &found.record.undetermined[0];
        assert!(said.contains("contact stiffness") && said.contains("tooth stiffness"));
        assert!(said.contains("series"), "{said}");
        assert_eq!(found.constants(), Constants::default());
    }
    // A damper and a mass at rest; the stiffness is known all the same.
    for (key, name) in [(TOOTH_DAMPING, "tooth damping"), (TOOTH_MASS, "tooth mass")] {
        let found = with(at_rest(&spec), 1e-3, &[STIFFNESS, key]);
        assert_eq!(
            outcomes(&found),
            [Outcome::Identified, Outcome::NotIdentifiable]
        );
        let said = &found.record.undetermined[0];
        let expected = format!("{name} is not determined: gears at rest do not depend on it");
        assert!(said.starts_with(&expected), "{said}");
    }
    // A gap without a clock.
    let found = with(
        impact(&spec, 20.0, "impact"),
        1e-3,
        &[STIFFNESS, GAP, CLOCK],
    );
    use Outcome::{Identified, NotIdentifiable};
    assert_eq!(
        outcomes(&found),
        [Identified, NotIdentifiable, NotIdentifiable]
    );
    let said = &found.record.undetermined[0];
    assert!(said.contains("in time in the same way"), "{said}");
    assert!(found.constants().gap.is_none() && found.constants().stiffness.is_some());
}

/// Two recorders with clocks of their own, in offset and rate: the fit finds both clocks and the constants.
#[test]
fn the_clocks_of_several_recorders_are_found() {
    let (plan, spec) = plan("rigid");
    let truth = Constants::of([(STIFFNESS, 1.5e10)]);
    let clocks = [
        Clock {
            offset: 2e-6,
            scale: 1.003,
        },
        Clock {
            offset: -1e-6,
            scale: 0.996,
        },
    ];
    let data = clocks.iter().zip([20.0, 40.0]).map(|(clock, speed)| {
        let name = format!("at {speed} rad/s");
        let mut set = made(&plan, impact(&spec, speed, &name), &truth, 1e-3);
        if let Data::History { time, .. } = &mut set.data {
            // Times as the recorder has them.
            (time.iter_mut()).for_each(|t| *t = (*t - clock.offset) / clock.scale);
        }
        set
    });
    let found = fitted(&FitPlan {
        data: data.collect(),
        wishes: FitOptions {
            fit: keys(&[STIFFNESS, CLOCK, CLOCK_SCALE]),
            ..FitOptions::default()
        },
        ..plan.clone()
    });
    let value = |key: &str| {
        let all = &found.record.parameters;
        let own = all.iter().find(|p| p.key == key);
        let own = own.unwrap_or_else(|| panic!("{key} among {all:?}"));
        assert_eq!(own.outcome, Outcome::Identified, "{own:?}");
        own.value.unwrap()
    };
    assert!((value(STIFFNESS) / 1.5e10 - 1.0).abs() < 5e-3);
    for (clock, name) in clocks.iter().zip(["at 20 rad/s", "at 40 rad/s"]) {
        let (offset, scale) = (
            value(&format!("{CLOCK} of {name}")),
            value(&format!("{CLOCK_SCALE} of {name}")),
        );
        assert!((offset - clock.offset).abs() < 1e-7, "{offset:e}");
        assert!((scale - clock.scale).abs() < 5e-4, "{scale}");
    }
    // Clocks belong to no calibration.
    assert!(found.constants().gap.is_none() && found.constants().stiffness.is_some());
}

/// A damper that the data are without ends on its bound, and one that they have is found.
#[test]
fn dampers_are_found_or_end_on_their_bound() {
    let (plan, spec) = plan("rigid");
    for (c, outcome) in [(0.0, Outcome::AtBound), (80.0, Outcome::Identified)] {
        let truth = Constants::of([(STIFFNESS, 1.5e10), (GAP, 3e-6), (DAMPING, c)]);
        let data = vec![made(&plan, impact(&spec, 20.0, "impact"), &truth, 0.0)];
        let wishes = FitOptions {
            fit: keys(&[STIFFNESS, GAP, DAMPING]),
            ..FitOptions::default()
        };
        let found = fitted(&FitPlan {
            data,
            wishes,
            ..plan.clone()
        });
        let damper = &found.record.parameters[2];
        if c > 0.0 {
            assert_eq!(damper.outcome, outcome, "{damper:?}");
        }
        assert!((damper.value.unwrap() - c).abs() < 0.1, "{damper:?}");
    }
}

#[test]
fn keys_that_are_none_are_refused_with_those_that_are() {
    let (mut plan, spec) = plan("rigid");
    plan.data.push(made(
        &plan,
        at_rest(&spec),
        &Constants::of([(STIFFNESS, 1e10)]),
        0.0,
    ));
    plan.wishes.fit = keys(&[TOOTH_MASS]);
    let e = identify(&plan, &Runner::default(), |_, _| {}).unwrap_err();
    let said = e.to_string();
    assert!(
        said.contains(TOOTH_MASS) && said.contains(STIFFNESS),
        "{said}"
    );
}
