//! List of the constants that are fitted to finite elements.

use gearbench::scene_file::SceneFile;

/// A fit: model, free constants and constants at fixed values.
pub struct FitSpec {
    /// Name of the fit in tables.
    pub name: &'static str,
    /// Id of the model.
    pub model: &'static str,
    /// Keys of the free constants, `None` for the default of the model; `*.` stands for each gear.
    pub keys: Option<&'static [&'static str]>,
    /// Keys of fixed constants with their values.
    pub held: &'static [(&'static str, f64)],
}

const K: &str = "stiffness_n_per_m2";
const TOOTH: &str = "tooth_stiffness_n_per_m";
const MASS: &str = "tooth_mass_kg";
const DAMPER: &str = "tooth_damping_ns_per_m";
const CONTACT_DAMPER: &str = "damping_ns_per_m";
const SLOPE: &str = "path_slope";
const GAP: &str = "gap_m";

/// The fits of a scene. Where the data do not determine the damping of a contact, it keeps its initial value.
pub const WANTED: &[FitSpec] = &[
    of("rigid", "rigid", None),
    of("rigid, along the path", "rigid", Some(&[K, SLOPE, GAP])),
    of("movable teeth", TEETH, None),
    of(
        "movable teeth, damped",
        TEETH,
        Some(&[K, TOOTH, MASS, DAMPER, GAP]),
    ),
    of(
        "movable teeth, each gear",
        TEETH,
        Some(&[K, "*.tooth_stiffness_n_per_m", "*.tooth_mass_kg", GAP]),
    ),
    of(
        "movable teeth, along the path",
        TEETH,
        Some(&[K, TOOTH, MASS, SLOPE, GAP]),
    ),
    of(
        "movable teeth, along the path, damped contact",
        TEETH,
        Some(&[K, TOOTH, MASS, SLOPE, CONTACT_DAMPER, GAP]),
    ),
    FitSpec {
        held: &[(CONTACT_DAMPER, 50.0)],
        ..of(
            "movable teeth, along the path, contact damped by 50 N s/m",
            TEETH,
            Some(&[K, TOOTH, MASS, SLOPE, GAP]),
        )
    },
];

const TEETH: &str = "movable-teeth";

const fn of(
    name: &'static str,
    model: &'static str,
    keys: Option<&'static [&'static str]>,
) -> FitSpec {
    FitSpec {
        name,
        model,
        keys,
        held: &[],
    }
}

/// Replaces a key with `*.` by the keys of all gears.
pub fn of_gears(key: &str, scene: &SceneFile) -> Vec<String> {
    match key.strip_prefix("*.") {
        Some(key) => (scene.spec.gears.iter())
            .map(|gear| format!("{}.{key}", gear.name))
            .collect(),
        None => vec![key.to_owned()],
    }
}
