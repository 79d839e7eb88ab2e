//! Tests of drive trains around the gears: stages without teeth, loads and motions from files, soft shafts, deviations,
//! measured machines, identification of numbers of the scene.

use super::{Folder, has};
use std::path::PathBuf;

/// A file of the measured machines.
fn measured(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../measured")
        .join(name)
}

/// The record of a study.
fn record(folder: &Folder, out: &str) -> serde_json::Value {
    serde_json::from_str(&folder.read(&format!("{out}/results.json"))).unwrap()
}

/// The histories of the first run of a study.
fn history_of(folder: &Folder, out: &str) -> String {
    let files = std::fs::read_dir(folder.at(out)).unwrap();
    let mut files = files.filter_map(|f| f.ok()?.file_name().into_string().ok());
    let is_history = |f: &String| {
        f.starts_with("run01") && !f.ends_with("-events.csv") && !f.ends_with("-pairs.csv")
    };
    folder.read(&format!("{out}/{}", files.find(is_history).unwrap()))
}

/// A motor on a shaft drives a pair, whose wheel lifts a load behind a stage without teeth.
const WINCH: &str = r#"schema = 1
name = "winch"
duration_s = 0.02
[gears.pinion]
teeth = 20
module_m = 4e-3
face_width_m = 10e-3
[gears.wheel]
teeth = 30
module_m = 4e-3
face_width_m = 10e-3
[[meshes]]
gears = ["pinion", "wheel"]
backlash_m = 20e-6
start = { flank = "left", loaded = true }
[[shafts]]
name = "input"
carries = [
    { body = "motor", at_m = 0.0, inertia_kgm2 = 1e-2, loads = [LOAD] },
    { gear = "pinion", at_m = 0.1 },
]
sections = [{ length_m = 0.1, stiffness_nm_per_rad = 2000.0, damping_nms_per_rad = DAMPER }]
[[shafts]]
name = "drum"
carries = [
    { body = "rope", at_m = 0.0, inertia_kgm2 = 5e-2, loads = [{ torque_nm = -40.0 }] },
    { body = "brake", at_m = 0.1, inertia_kgm2 = 1e-3 },
]
sections = [{ length_m = 0.1, stiffness_nm_per_rad = SOFT }]
damping_s = 1e-4
[[stages]]
name = "belt"
between = ["wheel", "rope"]
ratio = -2.0
STAGE
[[models]]
model = "rigid"
contact = { stiffness = "iso6336", damping = { law = "ratio-at-load", ratio = 0.1 } }
[study]
models = ["rigid"]
integrators = [{ method = "generalised-alpha(rho_inf=0.8)", step_s = 2e-5 }]
samples = 400
"#;

fn winch(load: &str, damper: &str, soft: &str, stage: &str) -> String {
    WINCH
        .replace("LOAD", load)
        .replace("DAMPER", damper)
        .replace("SOFT", soft)
        .replace("STAGE", stage)
}

/// Natural frequencies of a measured drive train with two stages, one of them a mesh, as its published constants give
/// them by an eigenvalue problem of numpy: 22 nodes, 21 springs.
#[test]
fn a_measured_drive_train_has_its_frequencies() {
    let expected = [
        (
            "modes_8mm",
            [
                28.0397, 39.6400, 68.3214, 299.8897, 571.7923, 937.0422, 1505.2151,
            ],
        ),
        (
            "modes_6mm",
            [
                22.7234, 39.5585, 65.3894, 299.8118, 572.0085, 711.4472, 1505.2151,
            ],
        ),
    ];
    let folder = Folder::new();
    for (name, expected) in expected {
        let scene = measured(&format!("aalto_rig/{name}.toml"));
        folder.says(&format!("modes {} --out {name}", scene.display()));
        let found = record(&folder, name);
        let modes = found["vibrations"][0]["modes"].as_array().unwrap();
        for (mode, f) in modes.iter().skip(1).zip(expected) {
            let own = mode["frequency_hz"].as_f64().unwrap();
            // Four digits behind the point are known.
            assert!((own - f).abs() < 6e-5 + 1e-5 * f, "{name}: {own} for {f}");
        }
        assert_eq!(modes[0]["name"], "rigid motion");
    }
    // The damped ones of the 8 mm shaft: magnitude of the eigenvalue, and damping ratio.
    let found = record(&folder, "modes_8mm");
    let expected = [
        (28.924, 0.1383),
        (39.709, 0.3338),
        (69.980, 0.1007),
        (300.752, 0.0454),
    ];
    let modes = found["vibrations"][0]["modes"].as_array().unwrap();
    for (mode, (f, ratio)) in modes.iter().skip(1).zip(expected) {
        let own = mode["damping_ratio"].as_f64().unwrap();
        let magnitude = mode["damped_frequency_hz"].as_f64().unwrap() / (1.0 - own * own).sqrt();
        assert!((magnitude / f - 1.0).abs() < 1e-4, "{magnitude} for {f}");
        assert!((own - ratio).abs() < 1e-4, "{own} for {ratio}");
    }
}

/// The records of the band brake: the first was fitted, the others are held out; a narrower limit is not kept.
#[test]
fn a_measured_brake_with_play_is_within_its_limits() {
    let folder = Folder::new();
    for name in ["half_hertz_25mm", "half_hertz_38mm", "one_hertz_25mm"] {
        let scene = measured(&format!("friction_play/{name}.toml"));
        let said = folder.says(&format!(
            "compare {} --repeats 1 --out {name}",
            scene.display()
        ));
        has(&said, &["within the scene's tolerance"]);
    }
    let name = "half_hertz_25mm";
    let scene = std::fs::read_to_string(measured(&format!("friction_play/{name}.toml"))).unwrap();
    let table = std::fs::read_to_string(measured(&format!("friction_play/{name}.csv"))).unwrap();
    folder.write(
        "narrow.toml",
        &scene.replace("limit = 0.06", "limit = 0.03"),
    );
    folder.write(&format!("{name}.csv"), &table);
    folder.ends("compare narrow.toml --repeats 1 --out narrow", 1);
}

/// The steady train carries its load through the shaft and the stage, however soft a shaft is: torques follow from
/// equilibrium, twists from stiffness.
#[test]
fn soft_trains_find_their_equilibrium() {
    let folder = Folder::new();
    // 30 N m at the motor, 45 at the wheel, 90 at the drum, of which the load takes 40: the rest accelerates the train.
    let load = "{ torque_nm = 30.0 }";
    for (name, soft) in [("stiff", "1e5"), ("soft", "2.0")] {
        let stage = "stiffness_nm_per_rad = 500.0";
        folder.write(&format!("{name}.toml"), &winch(load, "0.5", soft, stage));
        let said = folder.says(&format!("modes {name}.toml --out {name}"));
        assert!(said.contains("rigid: loaded"), "{said}");
    }
    let force = |name: &str| {
        let found = record(&folder, name);
        found["vibrations"][0]["meshes"][0]["force_n"]
            .as_f64()
            .unwrap()
    };
    // The train accelerates as a whole: the force of the mesh does not depend on the stiffness of a shaft.
    assert!((force("soft") / force("stiff") - 1.0).abs() < 1e-6);
}

/// A load from a column of a file is the load of a table in the scene, in other units, with offset, factor and zero.
#[test]
fn loads_and_motions_are_read_from_files() {
    let folder = Folder::new();
    let stage = "stiffness_nm_per_rad = 500.0\ndamping_nms_per_rad = 0.5";
    let table = "{ torque_nm = 20.0 }, { table = { time_s = [0.0, 0.005, 0.01, 0.015], torque_nm = [0.0, 5.0, -2.0, 3.0] } }";
    folder.write("table.toml", &winch(table, "0.5", "1e4", stage));
    // Counted the other way, in N mm over ms, 2 ms early, about a mean of 1 N m before the start.
    let csv = "{ torque_nm = 20.0 }, { csv = { file = \"drive.csv\", column = \"T\", unit = \"N mm\", factor = -1.0, offset_s = 0.002, zero_over_s = [-0.003, 0.0] } }";
    folder.write("file.toml", &winch(csv, "0.5", "1e4", stage));
    folder.write(
        "drive.csv",
        "t [ms];T\n-5;1000\n-3;1000\n-2;1000\n3;-4000\n8;3000\n13;-2000\n",
    );
    let end = |name: &str| -> Vec<f64> {
        folder.says(&format!("compare {name}.toml --repeats 1 --out {name}"));
        let found = record(&folder, name);
        let columns = found["runs"][0]["series"]["columns"].as_array().unwrap();
        let last = |c: &serde_json::Value| c["values"].as_array().unwrap().last()?.as_f64();
        columns.iter().filter_map(last).collect()
    };
    let (table, file) = (end("table"), end("file"));
    assert!(table.len() > 2);
    for (a, b) in table.iter().zip(&file) {
        assert!(
            (a - b).abs() < 1e-9 * a.abs().max(1.0),
            "{table:?} {file:?}"
        );
    }
    // The record knows the file: a rerun of a changed one is told.
    folder.write("drive.csv", "t [ms];T\n0;1\n1;2\n2;3\n");
    let out = folder.command("rerun file --out again").output().unwrap();
    has(&super::stderr(&out), &["drive.csv"]);
}

/// A file that cannot be a load, or a wrong key of a stage, is refused with the file, the line and the reason.
#[test]
fn files_that_cannot_be_loads_are_refused() {
    let folder = Folder::new();
    let refuse = |keys: &str, words: &[&str]| {
        let load = format!("{{ csv = {{ file = \"drive.csv\", {keys} }} }}");
        folder.write("t.toml", &winch(&load, "0.5", "1e4", ""));
        folder.refuses("compare t.toml --out d", words);
    };
    refuse("column = \"T\"", &["drive.csv", "paths are relative"]);
    folder.write("drive.csv", "t [s],T [N m],v [m/s]\n0,1,1\n1,2,1\n2,x,1\n");
    refuse("column = \"M\"", &["drive.csv:1", "`M`", "the columns are"]);
    refuse("column = \"T\"", &["drive.csv:4", "a number", "`x`"]);
    refuse("column = \"v\"", &["a torque, for example N m"]);
    refuse(
        "column = \"T\", unit = \"kg\"",
        &["t.toml", "\"kg\" is not the unit of a torque"],
    );
    refuse("column = \"T\", zero = 1", &["zero", "zero_over_s"]);
    folder.write("drive.csv", "t [s],T [N m]\n0,1\n1,2\n2,3\n");
    refuse(
        "column = \"T\", zero_over_s = [5.0, 6.0]",
        &["the mean becomes zero"],
    );
    for (stage, words) in [
        ("damping_nms_per_rad = 1.0", "a rigid stage has no damper"),
        ("stiffness_nm_per_rad = -1.0", "stiffness_nm_per_rad"),
    ] {
        folder.write("t.toml", &winch("{ torque_nm = 1.0 }", "0.5", "1e4", stage));
        folder.refuses("compare t.toml --out d", &[words]);
    }
    let scene = winch("{ torque_nm = 1.0 }", "0.5", "1e4", "");
    folder.write(
        "t.toml",
        &scene.replace("\"wheel\", \"rope\"", "\"wheel\", \"rop\""),
    );
    folder.refuses("compare t.toml --out d", &["no gear or body `rop`", "rope"]);
}

/// Run-out of a gear is a transmission error once per turn, with half of it as amplitude, and no missed contact, also
/// where it is a third of the module.
#[test]
fn run_out_is_no_missed_contact() {
    let folder = Folder::new();
    let scene = r#"schema = 1
name = "eccentric"
duration_s = 6.4
[gears.pinion]
teeth = 95
module_m = 1.5e-3
face_width_m = 15e-3
deviations = { runout_m = 0.5212e-3 }
mount = { driven = { speed_rad_s = 1.0 } }
[gears.wheel]
teeth = 95
module_m = 1.5e-3
face_width_m = 15e-3
loads = [{ torque_nm = 1.0 }]
speed_rad_s = -1.0
[[meshes]]
gears = ["pinion", "wheel"]
backlash_m = 0.4e-3
start = { flank = "left", loaded = true }
[[models]]
model = "rigid"
contact = { stiffness = "iso6336", damping = { law = "ratio-at-load", ratio = 0.1 } }
[study]
models = ["rigid"]
integrators = [{ method = "generalised-alpha(rho_inf=0.5)", step_s = 1e-3 }]
samples = 4000
"#;
    folder.write("eccentric.toml", scene);
    let said = folder.says("compare eccentric.toml --repeats 1 --out run");
    has(&said, &["The run did not fail."]);
    let text = history_of(&folder, "run");
    let mut lines = text.lines().filter(|l| !l.starts_with('#'));
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = |name: &str| head.iter().position(|h| *h == name).unwrap();
    let (t, e) = (at("time_s"), at("transmission_error_pinion_wheel_m"));
    // Fourier coefficients over the first turn.
    let [mut cosine, mut sine, mut count] = [0.0, 0.0, 0.0];
    for line in lines {
        let row: Vec<f64> = line
            .split(',')
            .map(|x| x.parse().unwrap_or(f64::NAN))
            .collect();
        if row[t] < std::f64::consts::TAU {
            cosine += row[e] * row[t].cos();
            sine += row[e] * row[t].sin();
            count += 1.0;
        }
    }
    let amplitude = 2.0 * f64::hypot(cosine, sine) / count;
    assert!((amplitude / 260.6e-6 - 1.0).abs() < 2e-3, "{amplitude}");
}

/// The damper of a coupling and the inertia of a body are found again from the torques of shafts and speeds of bodies
/// that a run with known ones has, and are written into the scene; the clock of the recorder is unknown.
#[test]
fn numbers_of_a_scene_are_identified_from_its_sensors() {
    let folder = Folder::new();
    let stage = "stiffness_nm_per_rad = 500.0\ndamping_nms_per_rad = 0.5";
    let load = "{ torque_nm = 20.0 }, { table = { time_s = [0.0, 1e-3, 1.1e-3], torque_nm = [0.0, 0.0, 8.0] } }";
    let truth = winch(load, "0.6", "1e4", stage);
    folder.write("truth.toml", &truth);
    folder.says("compare truth.toml --repeats 1 --out truth");
    let text = history_of(&folder, "truth");
    let head = text.lines().find(|l| l.contains("time_s")).unwrap();
    has(
        head,
        &["shaft_torque_motor_pinion_nm", "hub_speed_rope_rad_s"],
    );
    folder.write("sensors.csv", &text);
    let reference = "reference = { csv = \"sensors.csv\", columns = { time = \"time_s\", shaft_torque.motor-pinion = \"shaft_torque_motor_pinion_nm\", speed.rope = \"hub_speed_rope_rad_s\" }, offset_s = 2e-4, from_s = 5e-4 }\n[gears.pinion]";
    let guess = winch(load, "0.3", "1e4", stage)
        .replacen("[gears.pinion]", reference, 1)
        .replace("inertia_kgm2 = 5e-2", "inertia_kgm2 = 4e-2");
    folder.write("guess.toml", &guess);
    let fit = "identify guess.toml --model rigid --fit shafts.input.sections.1.damping_nms_per_rad,shafts.drum.carries.rope.inertia_kgm2,clock_s --integrator generalised-alpha(rho_inf=0.8)@2e-5 --out fit";
    folder.refuses(&format!("{fit} --write"), &["--write=scene"]);
    let said = folder.says(&format!("{fit} --write=scene"));
    has(&said, &["shaft torque of motor-pinion", "speed of rope"]);
    super::as_documented(&folder.at("fit"));
    let found = record(&folder, "fit");
    let value = |k: usize| found["fits"][0]["parameters"][k]["value"].as_f64().unwrap();
    let expected = [0.6, 5e-2];
    for (k, x) in expected.into_iter().enumerate() {
        assert!(
            (value(k) / x - 1.0).abs() < 0.01,
            "{k}: {} for {x}\n{said}",
            value(k)
        );
    }
    // Both sensors have the clock of their recorder, which was shifted by 0.2 ms.
    assert!((value(2) + 2e-4).abs() < 4e-6, "{}\n{said}", value(2));
    assert!(found["fits"][0]["parameters"][3].is_null());
    let after = folder.read("guess.toml");
    assert!(!after.contains("damping_nms_per_rad = 0.3"), "{after}");
    folder.refuses(
        &fit.replace("carries.rope.inertia_kgm2", "carries.9.inertia_kgm2"),
        &["no entry `9`", "rope, brake"],
    );
}
