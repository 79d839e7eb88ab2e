//! Refused calls of the library with their messages; presence of all functions of the standard.

use crate::host::{Fmu, all, said, version};
use crate::{packed, scene, shipped};
use std::collections::BTreeSet;

const ERROR: i32 = 3;

#[test]
fn all_functions_of_the_standard_are_there() {
    let all = all();
    let names: BTreeSet<_> = all.iter().map(|(name, _)| name).collect();
    assert_eq!((all.len(), names.len()), (75, 75));
    assert!(all.iter().all(|(_, address)| *address != 0));
    assert_eq!(version(), "3.0");
}

#[test]
fn another_scene_than_the_described_one_is_refused() {
    let mut package = packed(&shipped("hammer", "rigid"), "rigid", "rk4@2us", &[]);
    assert!(Fmu::try_new(&package, false, Some("another")).is_none());
    assert!(said().contains("do not match the model description"));
    let scene = package.entries.iter_mut();
    let scene = scene.into_iter().find(|e| e.path.ends_with("scene.toml"));
    scene.unwrap().bytes.extend(b"# changed\n");
    assert!(Fmu::try_new(&package, true, None).is_none());
    assert!(said().contains("pack the FMU again"));
    package.entries.retain(|e| !e.path.ends_with("fmu.json"));
    assert!(Fmu::try_new(&package, false, None).is_none());
    assert!(said().contains("fmu.json"));
}

#[test]
fn bad_calls_end_in_errors() {
    let fmu = Fmu::stepping(&packed(
        &shipped("hammer", "rigid"),
        "rigid",
        "rk4@2us",
        &[],
    ));
    let refused = |status: i32, why: &str| {
        assert_eq!(status, ERROR);
        let told = said();
        assert!(told.contains(why), "{told}");
    };
    refused(fmu.try_step(0.0, 1e-5), "not initialised");
    refused(fmu.try_set("pinion.torque", f64::NAN), "not a number");
    fmu.initialise(0.0);
    refused(fmu.try_step(0.0, -1e-5), "communication step");
    refused(fmu.try_step(1.0, 1e-5), "the instance is at 0 s");
    refused(fmu.try_set("pinion.speed", 1.0), "cannot be set");
    refused(fmu.try_get_integer(0), "no variables of type Int32");
    // The instance remains usable.
    fmu.step(0.0, 1e-5);
    assert_eq!(fmu.get("time"), 1e-5);
}

fn refused(status: i32, why: &str) {
    let told = said();
    assert_eq!(status, ERROR, "{told}");
    assert!(told.contains(why), "{told}");
}

#[test]
fn a_terminated_instance_neither_steps_nor_changes() {
    let fmu = Fmu::stepping(&packed(
        &shipped("hammer", "rigid"),
        "rigid",
        "rk4@2us",
        &[],
    ));
    refused(fmu.try_terminate(), "not initialised");
    fmu.initialise(0.0);
    fmu.step(0.0, 1e-5);
    assert_eq!(fmu.try_terminate(), 0);
    refused(fmu.try_step(1e-5, 1e-5), "terminated");
    refused(fmu.try_set("pinion.torque", 1.0), "terminated");
    refused(fmu.try_terminate(), "terminated");
    // The values it reached can be read; a reset restarts the instance.
    assert_eq!(fmu.get("time"), 1e-5);
    fmu.reset();
    fmu.initialise(0.0);
    fmu.step(0.0, 1e-5);
}

#[test]
fn times_out_of_order_are_refused() {
    let fmu = Fmu::stepping(&packed(
        &shipped("hammer", "rigid"),
        "rigid",
        "rk4@2us",
        &[],
    ));
    refused(fmu.try_enter(f64::NAN, None), "start time");
    refused(fmu.try_enter(1.0, Some(0.5)), "stop time is 0.5 s");
    refused(fmu.try_enter(0.0, Some(f64::NAN)), "stop time is NaN");
    fmu.initialise_until(0.0, Some(5e-5));
    refused(fmu.try_step(0.0, 6e-5), "the stop time is 0.00005 s");
    refused(fmu.try_step(0.0, f64::NAN), "communication step");
    // Five steps whose sum misses the stop time by rounding.
    let mut t = 0.0;
    for _ in 0..5 {
        fmu.step(t, 1e-5);
        t += 1e-5;
    }
    refused(fmu.try_step(t, 1e-5), "stop time");
    assert!((fmu.get("time") - 5e-5).abs() < 1e-18);
}

#[test]
fn states_that_are_no_numbers_are_refused() {
    let package = packed(&shipped("hammer", "rigid"), "rigid", "rk4@2us", &[]);
    let fmu = Fmu::exchanging(&package);
    fmu.initialise(0.0);
    let good = fmu.states();
    for bad in [f64::NAN, f64::INFINITY] {
        let mut x = good.clone();
        x[1] = bad;
        refused(fmu.try_states(&x), "continuous state 2");
        // The state before is kept.
        assert_eq!(fmu.states(), good);
        assert!(fmu.rates().iter().all(|x| x.is_finite()));
    }
    // Numbers whose derivatives are none.
    let far = vec![1e300; good.len()];
    assert_eq!(fmu.try_states(&far), 0);
    let (status, rates) = fmu.try_rates();
    assert!(
        status == ERROR || rates.iter().all(|x| x.is_finite()),
        "{rates:?}"
    );
    said();
    assert!(!Fmu::is_made_without_a_name(&package));
    assert!(said().contains("name of the instance"));
}

#[test]
fn hubs_that_nobody_can_move_are_refused() {
    use gearbench::fmu::coupled::Coupled;
    let file = shipped("driveline", "rigid");
    let refuse = |gear: &str| {
        let choice = &file.models[0];
        match Coupled::assemble(&file, choice, &[gear.to_owned()]) {
            Ok(_) => panic!("{gear}"),
            Err(e) => e.to_text(),
        }
    };
    assert!(refuse("pinion").contains("is on a shaft"));
    assert!(refuse("pinon").contains("did you mean `pinion`"));
}

/// Racks, bearings, bodies on shafts: names and units.
#[test]
fn variables_have_names_and_units() {
    let file = shipped("driveline", "rigid");
    let package = packed(&file, "rigid", "rk4@1us", &[]);
    let text = &package.entries[0].bytes;
    let text = String::from_utf8_lossy(text);
    let has = |parts: &[&str]| {
        let mut lines = text.lines();
        let found = lines.any(|l| parts.iter().all(|p| l.contains(p)));
        assert!(found, "{parts:?} in\n{text}");
    };
    has(&[
        "name=\"motor.torque\"",
        "causality=\"input\"",
        "unit=\"N.m\"",
    ]);
    has(&["name=\"motor.torque_end\"", "causality=\"input\""]);
    has(&[
        "name=\"load.speed\"",
        "causality=\"output\"",
        "unit=\"rad/s\"",
    ]);
    has(&["name=\"pinion_wheel.force_x\"", "unit=\"N\""]);
    has(&["name=\"shaft_torque_motor_pinion\"", "unit=\"N.m\""]);
    let rack = include_str!("../../../benchmarks/templates/rack.toml");
    let own = scene(&rack.replacen("name = \"rack\"", "name = \"1-two\"", 1));
    let package = packed(&own, "rigid", "rk4@1us", &["rack"]);
    let text = String::from_utf8_lossy(&package.entries[0].bytes);
    let has = |part: &str| assert!(text.contains(part), "{part} in\n{text}");
    has("name=\"rack.displacement\"");
    has("name=\"rack.contact_force\"");
    has("modelIdentifier=\"_1_two\"");
    assert_eq!(package.identifier, "_1_two");
}
