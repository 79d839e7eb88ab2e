//! A coarse pair of gears for tests of studies, which reduces in a fraction of a second.

use crate::scene_file::{Origin, SceneFile};

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

/// The pair as full finite elements.
pub fn coarse_full() -> SceneFile {
    let text = format!(
        "{GEARS}\n[[models]]\nmodel = \"fe\"\nparameters = {{ {MESH} }}\ncontact = {{ penalty_pa_per_m = 2e15 }}\n"
    );
    SceneFile::unbuilt("coarse.toml", &text, Origin::Shipped, false).expect("a scene")
}

/// The pair with elastic gears that have further parameters.
pub fn coarse(parameters: &str) -> SceneFile {
    let text = format!(
        "{GEARS}\n[[models]]\nmodel = \"elastic\"\nparameters = {{ {MESH}, {parameters} }}\n\
         contact = {{ penalty_pa_per_m = 2e15, damping_ns_per_m3 = 2e9 }}\n"
    );
    SceneFile::unbuilt("coarse.toml", &text, Origin::Shipped, false).expect("a scene")
}
