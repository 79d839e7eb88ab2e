//! Typical ranges of the values of a scene, in wide bounds, and units in which they are often given by mistake.
//!
//! Lengths are rows of one table, [`LENGTHS`]: bounds in metres, in modules or in reference radii, by the last key of
//! the path. They are checked before the geometry is built, so that an error of the geometry can name the unit that was
//! probably meant.

use super::error::SceneError;
use super::reading::{Document, Place};

/// Typical range of a quantity with its unit, and units in which it is often given by mistake with their factors.
pub(super) struct TypicalRange {
    unit: &'static str,
    range: [f64; 2],
    slips: &'static [(f64, &'static str)],
}

/// Units in which lengths are often given by mistake.
const OTHER_LENGTHS: &[(f64, &str)] = &[(1e-3, "millimetres"), (1e-6, "micrometres")];
/// Bounds of the module [m].
const MODULES: [f64; 2] = [5e-5, 0.1];

/// Unit in which the bounds of a length are given.
#[derive(Clone, Copy, Debug, PartialEq)]
enum LengthUnit {
    /// Absolute bounds in metres [m].
    Metre,
    /// Modules of the gear; outside of gears those of the largest one.
    Module,
    /// Reference radii of the gear; outside of gears those of the largest one.
    Radius,
}

/// Last key of a path, bounds of the magnitude, and their unit; the first matching row applies.
#[rustfmt::skip]
const LENGTHS: &[(&str, [f64; 2], LengthUnit)] = &[
    ("module_m", MODULES, LengthUnit::Metre),
    ("face_width_m", [1e-4, 3.0], LengthUnit::Metre),
    ("bore_radius_m", [0.0, 1.5], LengthUnit::Radius),
    ("tip_circle_radius_m", [0.5, 2.0], LengthUnit::Radius),
    ("root_circle_radius_m", [0.5, 2.0], LengthUnit::Radius),
    ("rim_radius_m", [0.5, 10.0], LengthUnit::Radius),
    ("start_radius_m", [0.3, 2.0], LengthUnit::Radius),
    ("radii_m", [0.3, 2.0], LengthUnit::Radius),
    ("heights_m", [0.0, 3.0], LengthUnit::Metre),
    ("body_height_m", [0.05, 100.0], LengthUnit::Module),
    ("thinning_m", [0.0, 0.5], LengthUnit::Module),
    ("amount_m", [0.0, 0.2], LengthUnit::Module),
    ("profile_crowning_m", [0.0, 0.2], LengthUnit::Module),
    ("lead_crowning_m", [0.0, 0.2], LengthUnit::Module),
    ("helix_slope_m", [0.0, 0.2], LengthUnit::Module),
    ("helix_slope_m.left", [0.0, 0.2], LengthUnit::Module),
    ("helix_slope_m.right", [0.0, 0.2], LengthUnit::Module),
    ("twist_m", [0.0, 0.2], LengthUnit::Module),
    ("twist_m.left", [0.0, 0.2], LengthUnit::Module),
    ("twist_m.right", [0.0, 0.2], LengthUnit::Module),
    ("runout_m", [0.0, 1.0], LengthUnit::Module),
    ("cumulative_pitch_m", [0.0, 0.2], LengthUnit::Module),
    ("profile_slope_m", [0.0, 0.2], LengthUnit::Module),
    ("profile_form_m", [0.0, 0.2], LengthUnit::Module),
    ("low.length_m", [0.0, 3.0], LengthUnit::Metre),
    ("high.length_m", [0.0, 3.0], LengthUnit::Metre),
    ("centre_distance_m", [1e-3, 10.0], LengthUnit::Radius),
    ("backlash_m", [0.0, 0.5], LengthUnit::Module),
    ("gap_m", [0.0, 0.5], LengthUnit::Module),
    ("reach_m", [0.0, 0.5], LengthUnit::Module),
    ("clearance_m", [0.0, 0.5], LengthUnit::Module),
    ("path_coordinate_m", [0.0, 5.0], LengthUnit::Radius),
    ("position_m", [0.0, 300.0], LengthUnit::Radius),
    ("centre_of_mass_m", [0.0, 10.0], LengthUnit::Radius),
    ("at_m", [0.0, 300.0], LengthUnit::Radius),
    ("length_m", [0.0, 300.0], LengthUnit::Radius),
    ("diameter_m", [1e-2, 10.0], LengthUnit::Radius),
    ("inner_diameter_m", [0.0, 10.0], LengthUnit::Radius),
    ("stick_m", [0.0, 1e-2], LengthUnit::Metre),
    ("roughness_m", [0.0, 1e-4], LengthUnit::Metre),
];

/// Length keys without a typical range.
#[cfg(test)]
const FREE_LENGTHS: [&str; 1] = ["unit_m"];

/// Warns of lengths outside the typical range of gears.
pub(super) fn lengths(document: &Document) -> Vec<SceneError> {
    let number = |path: &str| document.number(path);
    // A module in millimetres is no measure for the other lengths until it is converted.
    let module_of = |gear: &str| {
        let module = number(&format!("{gear}.module_m")).filter(|m| *m > 0.0)?;
        let in_bounds = |m: &f64| (MODULES[0]..=MODULES[1]).contains(m);
        let meant = OTHER_LENGTHS.iter().map(|(factor, _)| module * factor);
        std::iter::once(module).chain(meant).find(in_bounds)
    };
    let radius_of = |gear: &str| {
        let teeth = number(&format!("{gear}.teeth"))?;
        let helix = number(&format!("{gear}.helix_angle_deg")).unwrap_or(0.0);
        let radius = 0.5 * teeth * module_of(gear)? / helix.to_radians().cos();
        (radius > 0.0 && radius.is_finite()).then_some(radius)
    };
    let gear_of = |path: &str| {
        let mut parts = path.split('.');
        let found = (parts.next()? == "gears").then(|| parts.next())??;
        Some(format!("gears.{found}"))
    };
    let gears: std::collections::BTreeSet<String> =
        document.numbers().filter_map(|(p, _)| gear_of(p)).collect();
    let largest = |of: &dyn Fn(&str) -> Option<f64>| {
        let all = gears.iter().filter_map(|g| of(g));
        all.fold(None, |most: Option<f64>, x| {
            Some(most.map_or(x, |m| m.max(x)))
        })
    };
    let own_or_largest = |path: &str, of: &dyn Fn(&str) -> Option<f64>| {
        gear_of(path)
            .and_then(|gear| of(&gear))
            .or_else(|| largest(of))
    };
    let mut odd = Vec::new();
    for (path, value) in document.numbers() {
        let plain = without_places(path);
        let ends = |end: &str| {
            let before = plain.strip_suffix(end);
            before.is_some_and(|b| b.is_empty() || b.ends_with('.'))
        };
        let Some((end, range, measure)) = LENGTHS.iter().find(|(end, ..)| ends(end)) else {
            continue;
        };
        let scale = match measure {
            LengthUnit::Metre => Some(1.0),
            LengthUnit::Module => own_or_largest(path, &module_of),
            LengthUnit::Radius => own_or_largest(path, &radius_of),
        };
        let Some(scale) = scale else { continue };
        let usual = TypicalRange {
            unit: "m",
            range: range.map(|x| x * scale),
            slips: OTHER_LENGTHS,
        };
        let key = end.split('.').find(|k| k.ends_with("_m")).unwrap_or(end);
        odd.extend(usual.warning(&document.at(path), key, value));
    }
    odd
}

/// A path without the indices of lists.
fn without_places(path: &str) -> String {
    let mut plain = String::new();
    let mut inside = false;
    for c in path.chars() {
        match c {
            '[' => inside = true,
            ']' => inside = false,
            c if !inside => plain.push(c),
            _ => {}
        }
    }
    plain
}

pub(super) const YOUNG: TypicalRange = TypicalRange {
    unit: "Pa",
    range: [1e7, 1.3e12],
    slips: &[(1e9, "GPa"), (1e6, "MPa")],
};
pub(super) const DENSITY: TypicalRange = TypicalRange {
    unit: "kg/m^3",
    range: [100.0, 25e3],
    slips: &[(1e3, "g/cm^3"), (1e12, "t/mm^3")],
};
pub(super) const FRICTION: TypicalRange = TypicalRange {
    unit: "",
    range: [0.0, 1.5],
    slips: &[(0.01, "per cent")],
};
pub(super) const DAMPING_RATIO: TypicalRange = TypicalRange {
    unit: "",
    range: [0.0, 1.0],
    slips: &[(0.01, "per cent")],
};
pub(super) const STIFFNESS: TypicalRange = TypicalRange {
    unit: "N/m^2",
    range: [1e7, 1e13],
    slips: &[(1e9, "N/(mm um)")],
};
pub(super) const PENALTY: TypicalRange = TypicalRange {
    unit: "Pa/m",
    range: [1e10, 1e20],
    slips: &[(1e9, "MPa/mm")],
};
/// Greatest relative error that a scene accepts.
pub(super) const TOLERANCE: TypicalRange = TypicalRange {
    unit: "",
    range: [0.0, 1.0],
    slips: &[(0.01, "per cent")],
};
pub(super) const DURATION: TypicalRange = TypicalRange {
    unit: "s",
    range: [1e-8, 1e4],
    slips: &[(1e-3, "milliseconds"), (1e-6, "microseconds")],
};
pub(super) const PRESSURE_ANGLE: TypicalRange = TypicalRange {
    unit: "degrees",
    range: [10.0, 35.0],
    slips: &[(180.0 / std::f64::consts::PI, "radians")],
};
pub(super) const HELIX_ANGLE: TypicalRange = TypicalRange {
    unit: "degrees",
    range: [1.0, 60.0],
    slips: &[(180.0 / std::f64::consts::PI, "radians")],
};
/// Inertia relative to that of the toothing.
pub(super) const INERTIA: TypicalRange = TypicalRange {
    unit: "times that of the toothing",
    range: [1e-2, 1e5],
    slips: &[],
};

impl TypicalRange {
    /// Returns a warning on an unusual value, with the value in the unit that is probably meant.
    pub(super) fn warning(&self, place: &Place<'_>, key: &str, value: f64) -> Option<SceneError> {
        let [least, most] = self.range;
        if (least..=most).contains(&value.abs()) {
            return None;
        }
        let unit = self.unit;
        let meant = self
            .slips
            .iter()
            .find(|(factor, _)| (least..=most).contains(&(value * factor).abs()));
        let help = match meant {
            Some((factor, slip)) => {
                let right = suggest_number(value * factor);
                format!("if {value} is in {slip}, write {key} = {right}")
            }
            None => format!(
                "typical values are {} to {} {unit}",
                scientific(least),
                scientific(most)
            )
            .trim_end()
            .to_owned(),
        };
        let message = format!(
            "`{key}` = {} {unit} is far outside the typical range of gears",
            plain(value)
        );
        Some(place.error(message.replace("  ", " "), "odd", help))
    }
}

/// Formats a number in plain decimal notation where possible.
fn plain(x: f64) -> String {
    if x == 0.0 || (1e-3..1e6).contains(&x.abs()) {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

/// Product of a number and a unit, rounded to remove rounding errors.
fn suggest_number(x: f64) -> String {
    let digits: f64 = format!("{x:.11e}").parse().unwrap_or(x);
    plain(digits)
}

/// Formats a bound with as few digits as possible.
fn scientific(x: f64) -> String {
    let short: f64 = format!("{x:.1e}").parse().unwrap_or(x);
    format!("{short:e}")
}

#[cfg(test)]
mod tests {
    use super::super::reading::keys::tables;
    use super::*;

    /// Every key of a length has a row in the table of bounds.
    #[test]
    fn every_length_of_the_format_has_bounds() {
        let mut lengths = 0;
        for table in tables() {
            let of_length = |key: &&str| key.ends_with("_m") && !key.contains("_per_");
            for key in table.keys.iter().map(|(key, _)| *key).filter(of_length) {
                let bounded = LENGTHS
                    .iter()
                    .any(|(end, ..)| end.split('.').any(|k| k == key));
                assert!(
                    bounded || FREE_LENGTHS.contains(&key),
                    "`{key}` of {} has no bounds",
                    table.name
                );
                lengths += 1;
            }
        }
        assert!(lengths >= 40, "{lengths}");
    }

    #[test]
    fn paths_lose_the_places_of_lists() {
        let path = "shafts[0].carries[12].centre_of_mass_m[2]";
        assert_eq!(without_places(path), "shafts.carries.centre_of_mass_m");
    }
}
