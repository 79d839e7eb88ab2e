//! `calibration` of a model: whose fitted constants it takes.

use super::calibration::{Calibration, Constants, NAMES};
use super::error::SceneError;
use super::model::Context;
use super::reader::{Entry, Key, key};
use super::suggest;

pub(super) static CALIBRATION: &[Key] = &[
    key("name", "\"impact\" or \"static\""),
    key(
        "scene",
        "scene whose calibration is taken, default this one",
    ),
    key("label", "label in that scene, default this model's"),
];

/// A calibration asked for by a model.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationUse {
    /// `impact` or `static`.
    pub name: String,
    /// Scene it was fitted in.
    pub scene: String,
    /// Label there.
    pub label: String,
    /// The constants that were applied; `None` when the scene was loaded without calibrations.
    pub constants: Option<Constants>,
}

/// Finds the calibrations of a scene by its name, if there are any.
pub(super) type FindCalibration<'a> = dyn Fn(&str) -> Result<Option<Calibration>, SceneError> + 'a;

/// Reads a calibration, for the model with a label.
pub(super) fn calibration(
    entry: &Entry<'_>,
    context: &Context<'_>,
    label: &str,
) -> Result<CalibrationUse, SceneError> {
    let names = NAMES.map(|n| (n, n));
    let (name, scene, label) = if entry.is_table() {
        let s = entry.section("`calibration`", CALIBRATION)?;
        let text = |key: &str, default: &str| {
            s.get(key)
                .map_or(Ok(default.to_owned()), |e| e.text().map(str::to_owned))
        };
        (
            s.need("name")?.word(&names)?,
            text("scene", context.scene)?,
            text("label", label)?,
        )
    } else {
        (
            entry.word(&names)?,
            context.scene.to_owned(),
            label.to_owned(),
        )
    };
    let constants = match context.calibrations {
        None => None,
        Some(find) => {
            let file = find(&scene)?;
            let found = file.as_ref().and_then(|c| c.get(name, &label));
            let mut found = found.cloned().ok_or_else(|| {
                let labels = file
                    .as_ref()
                    .and_then(|c| c.sets.get(name))
                    .map_or(Vec::new(), |labels| {
                        labels.keys().map(String::as_str).collect()
                    });
                let there = if labels.is_empty() {
                    String::new()
                } else {
                    format!("; there is one for {}", suggest::words(&labels))
                };
                entry.error(
                    format!("there is no calibration \"{name}\" of `{label}` in scene `{scene}`"),
                    "not there",
                    format!(
                        "fit it with `gearbench identify {scene} --model {label} --write`{there}"
                    ),
                )
            })?;
            if scene != context.scene {
                // Another scene's gap is that of its own start.
                found.gap = None;
            }
            Some(found)
        }
    };
    Ok(CalibrationUse {
        name: name.to_owned(),
        scene,
        label,
        constants,
    })
}
