//! The key `calibration` of a model: the set of fitted constants that it uses.

use super::calibration::{Calibration, CalibrationKind, Constants, of_gear};
use super::error::SceneError;
use super::model::Context;
use super::reading::keys::keys;
use super::reading::values::CalibrationName;
use super::reading::{Place, suggest};
use serde::{Deserialize, Serialize};

keys! {
    /// A calibration of another scene or label.
    struct CalibrationTable {
        /// "impact", "static" or "running"
        name: CalibrationName,
        /// scene whose calibration is taken, default this one
        scene: Option<String>,
        /// label in that scene, default this model's
        label: Option<String>,
    }
}

/// Calibration of the model itself, or of another scene or label.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub enum CalibrationChoice {
    /// The calibration of this model in this scene.
    #[serde(rename = "<text>")]
    Own(CalibrationName),
    /// The calibration of another scene or label.
    #[serde(rename = "<table>")]
    Other(CalibrationTable),
}

/// The calibration that a model uses.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationUse {
    /// Name of the calibration: `impact`, `static` or `running`.
    pub name: String,
    /// Name of the scene in which the constants were fitted.
    pub scene: String,
    /// Label of the model in that scene.
    pub label: String,
    /// Constants that were applied; `None` if the scene was loaded without calibrations.
    pub constants: Option<Constants>,
    /// Constants stored under this name, applied or not.
    pub stored: Option<Constants>,
}

impl CalibrationUse {
    /// The kind of data to which the constants were fitted.
    pub fn fitted_to(&self) -> CalibrationKind {
        CalibrationKind::named(&self.name).unwrap_or_default()
    }
}

/// Callback that finds the calibrations of a scene by its name.
pub(super) type FindCalibration<'a> = dyn Fn(&str) -> Result<Option<Calibration>, SceneError> + 'a;

/// Finds the constants for the model with a label.
pub(super) fn calibration(
    choice: CalibrationChoice,
    context: &Context<'_>,
    label: &str,
    at: &Place<'_>,
) -> Result<CalibrationUse, SceneError> {
    let (name, scene, other) = match choice {
        CalibrationChoice::Own(name) => (name.0, None, None),
        CalibrationChoice::Other(keys) => (keys.name.0, keys.scene, keys.label),
    };
    let scene = scene.unwrap_or_else(|| context.scene.to_owned());
    let label = other.unwrap_or_else(|| label.to_owned());
    let found = (context.calibrations)(&scene);
    let stored;
    let mut constants = None;
    if !context.calibrated {
        // A new fit does not depend on what an earlier one left, not even on whether that can be read.
        let file = found.ok().flatten();
        stored = file.and_then(|f| f.get(&name, &label).cloned());
    } else {
        let file = found?.unwrap_or_default();
        let Some(found) = file.get(&name, &label) else {
            let labels: Vec<&String> = file
                .sets
                .get(&name)
                .into_iter()
                .flat_map(|l| l.keys())
                .collect();
            // A scene of one's own is known by its file.
            let from = match scene == context.scene && !context.shipped {
                true => at.file(),
                false => &scene,
            };
            let there = match labels.is_empty() {
                true => String::new(),
                false => format!("; the scene has one for {}", suggest::words(&labels)),
            };
            let way = match CalibrationKind::named(&name) {
                None | Some(CalibrationKind::Impact) => String::new(),
                Some(other) => format!(" --to {}", other.as_str()),
            };
            return at.refuse(
                format!("the scene `{scene}` has no calibration \"{name}\" of `{label}`"),
                "this calibration is missing",
                format!(
                    "fit it with `gearbench identify {from} --model {label}{way} --write`{there}"
                ),
            );
        };
        let mut found = found.clone();
        let gears: Vec<&str> = context.gears.iter().map(|g| g.spec.name.as_str()).collect();
        let of_gears = found.parameters.keys().filter_map(|key| of_gear(key).0);
        if let Some(other) = of_gears.into_iter().find(|of| !gears.contains(of)) {
            return at.refuse(
                format!("the calibration \"{name}\" of `{label}` in scene `{scene}` has constants of a gear `{other}`, which is not in this scene"),
                "unknown gear",
                suggest::there_are(other, &gears),
            );
        }
        if scene != context.scene {
            // Another scene's gap is that of its own start.
            found.gap = None;
        }
        stored = Some(found.clone());
        constants = Some(found);
    }
    Ok(CalibrationUse {
        name,
        scene,
        label,
        constants,
        stored,
    })
}
