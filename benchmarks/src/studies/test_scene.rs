//! Gears for tests of studies: a coarse pair, which reduces in a fraction of a second, and one whose stiffness is a wave.

use crate::context::Context;
use crate::scene_file::{Origin, SceneFile};
use gearbench_models::spec::mesh_layout;

const GEARS: &str = r#"
schema = 1
name = "coarse"
duration_s = 1.2e-4

[gears.a]
teeth = 18
module_m = 0.002
face_width_m = 0.006
bore_radius_m = 0.007
speed_rad_s = 20.0

[gears.b]
teeth = 24
module_m = 0.002
face_width_m = 0.006
bore_radius_m = 0.01

[[meshes]]
gears = ["a", "b"]
backlash_m = 80e-6
start = { flank = "left", gap_m = 1e-6 }
"#;

const MESH: &str = "flank_elements = 4, fillet_elements = 2, across_elements = 6, rim_elements = 2, width_elements = 1";

/// Returns the pair as full finite elements.
pub fn coarse_full() -> SceneFile {
    let text = format!(
        "{GEARS}\n[[models]]\nmodel = \"fe\"\nparameters = {{ {MESH} }}\ncontact = {{ penalty_pa_per_m = 2e15 }}\n"
    );
    SceneFile::unbuilt(
        &Context::default(),
        "coarse.toml",
        &text,
        Origin::Shipped,
        false,
    )
    .expect("a scene")
}

/// Returns the pair with elastic gears and the given further parameters.
pub fn coarse(parameters: &str) -> SceneFile {
    let text = format!(
        "{GEARS}\n[[models]]\nmodel = \"elastic\"\nparameters = {{ {MESH}, {parameters} }}\n\
         contact = {{ penalty_pa_per_m = 2e15, damping_ns_per_m3 = 2e9 }}\n"
    );
    SceneFile::unbuilt(
        &Context::default(),
        "coarse.toml",
        &text,
        Origin::Shipped,
        false,
    )
    .expect("a scene")
}

/// Returns the first gear with a rack in place of the second gear.
pub fn coarse_rack(parameters: &str) -> SceneFile {
    let rack = GEARS
        .replace(
            "[gears.b]\nteeth = 24",
            "[gears.b]\nkind = \"rack\"\nteeth = 6",
        )
        .replace("bore_radius_m = 0.01\n", "")
        .replace("backlash_m = 80e-6", "centre_distance_m = 0.01805");
    let text = format!(
        "{rack}\n[[models]]\nmodel = \"elastic\"\nparameters = {{ {MESH}, {parameters} }}\n\
         contact = {{ penalty_pa_per_m = 2e15, damping_ns_per_m3 = 2e9 }}\n"
    );
    SceneFile::unbuilt(
        &Context::default(),
        "rack.toml",
        &text,
        Origin::Shipped,
        false,
    )
    .expect("a scene")
}

/// Returns gears with a mesh stiffness `k0 (1 + depth cos)` of one wave per base pitch, and some damping.
pub fn waves(depth: f64, ratio: f64, wheel_torque: f64) -> SceneFile {
    let text = |rows: &str| {
        format!(
            r#"
schema = 1
name = "wave"
duration_s = 1e-3
[gears.pinion]
teeth = 20
module_m = 0.004
face_width_m = 0.01
speed_rad_s = 100.0
loads = [{{ torque_nm = 10.0 }}]
[gears.wheel]
teeth = 30
module_m = 0.004
face_width_m = 0.01
speed_rad_s = -66.66666666666667
loads = [{{ torque_nm = {wheel_torque} }}]
[[meshes]]
gears = ["pinion", "wheel"]
centre_distance_m = 0.1001
[[models]]
model = "rigid"
contact = {{ stiffness = {rows}, damping = {{ law = "kelvin-voigt-ratio", ratio = {ratio} }} }}
"#
        )
    };
    let parse = |rows: &str| {
        SceneFile::parse(
            &Context::default(),
            "wave.toml",
            &text(rows),
            Origin::Shipped,
            false,
        )
        .unwrap()
    };
    let plain = parse("\"iso6336\"");
    let [a, b] = [&plain.spec.gears[0], &plain.spec.gears[1]];
    let l = mesh_layout(a, b).unwrap();
    let (mut at, mut k) = (Vec::new(), Vec::new());
    for i in 0..=64 {
        let u = f64::from(i) / 64.0;
        at.push(format!("{:.12e}", l.pitch_point + (u - 0.5) * l.base_pitch));
        let wave = (std::f64::consts::TAU * u).cos();
        k.push(format!("{:.12e}", 1e8 * (1.0 + depth * wave)));
    }
    parse(&format!(
        "{{ kind = \"table\", of = \"mesh\", ends = \"periodic\", path_coordinate_m = [{}], stiffness_n_per_m = [{}] }}",
        at.join(", "),
        k.join(", ")
    ))
}
