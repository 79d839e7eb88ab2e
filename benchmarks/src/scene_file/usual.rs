//! Where the values of a scene usually lie, in wide bounds, and units that they are often given in by mistake.

use super::error::SceneError;
use super::reading::Place;

/// A quantity, its unit, where its values lie, and units that it is often given in by mistake with their factors.
pub(super) struct Usual {
    unit: &'static str,
    range: [f64; 2],
    slips: &'static [(f64, &'static str)],
}

pub(super) const MODULE: Usual = Usual {
    unit: "m",
    range: [5e-5, 0.1],
    slips: &[(1e-3, "millimetres")],
};
pub(super) const FACE_WIDTH: Usual = Usual {
    unit: "m",
    range: [1e-4, 3.0],
    slips: &[(1e-3, "millimetres")],
};
pub(super) const YOUNG: Usual = Usual {
    unit: "Pa",
    range: [1e7, 1.3e12],
    slips: &[(1e9, "GPa"), (1e6, "MPa")],
};
pub(super) const DENSITY: Usual = Usual {
    unit: "kg/m^3",
    range: [100.0, 25e3],
    slips: &[(1e3, "g/cm^3"), (1e12, "t/mm^3")],
};
pub(super) const FRICTION: Usual = Usual {
    unit: "",
    range: [0.0, 1.5],
    slips: &[(0.01, "per cent")],
};
pub(super) const DAMPING_RATIO: Usual = Usual {
    unit: "",
    range: [0.0, 1.0],
    slips: &[(0.01, "per cent")],
};
pub(super) const STIFFNESS: Usual = Usual {
    unit: "N/m^2",
    range: [1e7, 1e13],
    slips: &[(1e9, "N/(mm um)")],
};
pub(super) const PENALTY: Usual = Usual {
    unit: "Pa/m",
    range: [1e10, 1e20],
    slips: &[(1e9, "MPa/mm")],
};
pub(super) const DURATION: Usual = Usual {
    unit: "s",
    range: [1e-8, 1e4],
    slips: &[(1e-3, "milliseconds"), (1e-6, "microseconds")],
};
pub(super) const PRESSURE_ANGLE: Usual = Usual {
    unit: "degrees",
    range: [10.0, 35.0],
    slips: &[(180.0 / std::f64::consts::PI, "radians")],
};
pub(super) const HELIX_ANGLE: Usual = Usual {
    unit: "degrees",
    range: [1.0, 60.0],
    slips: &[(180.0 / std::f64::consts::PI, "radians")],
};
/// Inertia over that of the toothing.
pub(super) const INERTIA: Usual = Usual {
    unit: "times that of the toothing",
    range: [1e-2, 1e5],
    slips: &[],
};

impl Usual {
    /// What is odd about a value, if anything is, and the value in the unit that is probably meant.
    pub(super) fn odd(&self, place: &Place<'_>, key: &str, value: f64) -> Option<SceneError> {
        let [least, most] = self.range;
        if (least..=most).contains(&value) {
            return None;
        }
        let unit = self.unit;
        let meant = self
            .slips
            .iter()
            .find(|(factor, _)| (least..=most).contains(&(value * factor)));
        let help = match meant {
            Some((factor, slip)) => {
                let right = suggest_number(value * factor);
                format!("if {value} is in {slip}, write {key} = {right}")
            }
            None => format!("usual are {least:e} to {most:e} {unit}")
                .trim_end()
                .to_owned(),
        };
        let message = format!(
            "`{key}` = {} {unit} is far from what gears have",
            plain(value)
        );
        Some(place.error(message.replace("  ", " "), "odd", help))
    }
}

/// A number as one would write it.
fn plain(x: f64) -> String {
    if x == 0.0 || (1e-3..1e6).contains(&x.abs()) {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

/// A product of a number and a unit, without the digits of rounding.
fn suggest_number(x: f64) -> String {
    let digits: f64 = format!("{x:.11e}").parse().unwrap_or(x);
    plain(digits)
}
