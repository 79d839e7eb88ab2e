//! What the library refuses, and says so; that all functions are there.

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
    let mut package = packed(&shipped("hammer"), "rigid", "rk4@2us", &[]);
    assert!(Fmu::try_new(&package, false, Some("another")).is_none());
    assert!(said().contains("not those that the description was written for"));
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
    let fmu = Fmu::stepping(&packed(&shipped("hammer"), "rigid", "rk4@2us", &[]));
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
    // And the instance goes on.
    fmu.step(0.0, 1e-5);
    assert_eq!(fmu.get("time"), 1e-5);
}

#[test]
fn hubs_that_nobody_can_move_are_refused() {
    use gearbench::fmu::coupled::Coupled;
    let file = shipped("driveline");
    let refuse = |gear: &str| {
        let choice = &file.models[0];
        match Coupled::assemble(&file, choice, &[gear.to_owned()]) {
            Ok(_) => panic!("{gear}"),
            Err(e) => e.told(),
        }
    };
    assert!(refuse("pinion").contains("stands on a shaft"));
    assert!(refuse("pinon").contains("did you mean `pinion`"));
}

/// Racks, bearings, bodies on shafts: names and units.
#[test]
fn variables_have_names_and_units() {
    let file = shipped("driveline");
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
