//! Tests that every model of a scene with loads is listed with the damping of its mesh mode.

use super::{Folder, as_documented, has, stderr, stdout};

const SCENE: &str = r#"schema = 1
name = "damped"
duration_s = 1e-4
gears.pinion = { teeth = 20, module_m = 0.004, face_width_m = 0.01, speed_rad_s = 100.0, loads = [{ torque_nm = 100.0 }] }
gears.wheel = { teeth = 30, module_m = 0.004, face_width_m = 0.01, speed_rad_s = -66.66666666666667, loads = [{ torque_nm = 150.0 }] }
meshes = [{ gears = ["pinion", "wheel"], centre_distance_m = 0.1001, start = { flank = "left", gap_m = 0.0 } }]
models = [
  { model = "rigid", label = "heavy", contact = { stiffness = "iso6336", damping = { law = "ratio-at-load", ratio = 0.05 } } },
  { model = "rigid", label = "light", contact = { stiffness = "iso6336", damping = { law = "ratio-at-load", ratio = 0.01 } } },
]
study.integrators = [{ method = "dopri5", rtol = 1e-6 }]
study.sweep = { from_hz = 400.0, to_hz = 500.0, points = 2, cycles = 1, settle_s = 1e-3 }
"#;

#[test]
fn the_damping_of_the_mesh_mode_is_printed_recorded_and_warned_about_once() {
    let folder = Folder::new();
    folder.write("d.toml", SCENE);
    let stability = "--integrators rk4 --steps 1us:2us:2 --axis speed=1 --no-refine";
    for (study, rest) in [
        ("compare", ""),
        ("modes", ""),
        ("response", "--points 2 --phases 16"),
        ("sweep", ""),
        ("stability", stability),
    ] {
        let out = folder.command(&format!(
            "{study} d.toml --models heavy,light --out {study} {rest}"
        ));
        let mut out = out;
        let out = out.output().unwrap();
        let (said, warned) = (stdout(&out), stderr(&out));
        has(
            &said,
            &[
                "mesh mode of rigid, heavy:",
                "damping ratio 5 %",
                "mesh mode of rigid, light:",
                "damping ratio 1 %",
            ],
        );
        assert_eq!(
            warned.matches("differ in the damping").count(),
            1,
            "{study}: {warned}"
        );
        let record = folder.read(&format!("{study}/results.json"));
        let record: serde_json::Value = serde_json::from_str(&record).unwrap();
        let modes = record["mesh_modes"].as_array().unwrap();
        let ratios: Vec<f64> = modes
            .iter()
            .map(|m| m["damping_ratio"].as_f64().unwrap())
            .collect();
        assert!(
            (ratios[0] - 0.05).abs() < 1e-4 && (ratios[1] - 0.01).abs() < 1e-4,
            "{study}: {ratios:?}"
        );
        has(
            &folder.read(&format!("{study}/index.html")),
            &["Damping of the mesh mode", "Note: the models differ"],
        );
        // Columns of `response` are those of other tests.
        if study != "response" {
            as_documented(&folder.at(study));
        }
    }
    // Models alike in it are not warned about; gears without loads have no mesh mode.
    let alike = folder.ends("compare d.toml --models heavy --out one", 0);
    assert!(!stderr(&alike).contains("differ in the damping"));
    let free = SCENE
        .replace(", loads = [{ torque_nm = 100.0 }]", "")
        .replace(", loads = [{ torque_nm = 150.0 }]", "");
    let free = free.replace("ratio-at-load", "kelvin-voigt-ratio");
    folder.write("f.toml", &free);
    let said = folder.says("compare f.toml --out free");
    assert!(
        !said.contains("mesh mode") && !folder.read("free/results.json").contains("mesh_modes")
    );
}
