//! Scenes and calibrations that are embedded in the program. A new scene needs a file and a line in [`SHIPPED`].

/// A scene that is embedded in the program.
#[derive(Clone, Copy, Debug)]
pub struct ShippedScene {
    /// Name on the command line.
    pub name: &'static str,
    /// Text of the scene file.
    pub text: &'static str,
    /// Text of its calibration file; empty if it has none.
    pub calibration: &'static str,
}

macro_rules! shipped {
    ($name:literal) => {
        ShippedScene {
            name: $name,
            text: include_str!(concat!("../../scenes/", $name, ".toml")),
            calibration: "",
        }
    };
    ($name:literal, calibrated) => {
        ShippedScene {
            calibration: include_str!(concat!("../../calibrations/", $name, ".toml")),
            ..shipped!($name)
        }
    };
}

/// All embedded scenes; the first is the default comparison.
pub static SHIPPED: &[ShippedScene] = &[
    shipped!("spur_impact", calibrated),
    shipped!("spur_impact_large", calibrated),
    shipped!("flank_contact", calibrated),
    shipped!("helical_impact"),
    shipped!("helical_tilted"),
    shipped!("rack_pinion"),
    shipped!("spur_rotation"),
    shipped!("loaded_mesh"),
    shipped!("mesh_efficiency"),
    shipped!("hammer"),
    shipped!("helical_hammer"),
    shipped!("helical_loaded"),
    shipped!("misaligned"),
    shipped!("skew_pairs"),
    shipped!("beveloid"),
    shipped!("beveloid_corrected"),
    shipped!("beveloid_pairs"),
    shipped!("backlash_parametric"),
    shipped!("backlash_forced"),
    shipped!("driveline"),
    shipped!("gearbox_rattle"),
    shipped!("steering_rattle"),
    shipped!("ring_pair"),
    shipped!("ring_impact"),
    shipped!("planetary"),
    shipped!("run_up"),
    shipped!("planetary_run_up"),
];

/// Returns an embedded scene by name.
pub fn shipped(name: &str) -> Option<&'static ShippedScene> {
    SHIPPED.iter().find(|s| s.name == name)
}
