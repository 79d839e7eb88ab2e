//! Settings of an FMU that the scene does not contain, and the opening of its resources.

use super::coupled::Coupled;
use crate::context::Context;
use crate::scene_file::{Origin, SceneError, SceneFile};
use gearbench_integrators::{MethodSpec, Resolution, Scheme};
use gearbench_reference::hash::Hash;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the scene file among the resources.
pub const SCENE: &str = "scene.toml";
/// Name of the calibration file, where scenes expect it.
pub const CALIBRATION: &str = "scene.calibration.toml";
/// Name of the settings file among the resources.
pub const SETTINGS: &str = "fmu.json";

/// Settings of an FMU in addition to its scene: model, integration method, moved hubs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Version of the program that packed the FMU.
    pub gearbench: String,
    /// Label of the model.
    pub model: String,
    /// Integration method of co-simulation.
    pub method: MethodSpec,
    /// Step of the method [s]; `None` if it runs at `rtol`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step_s: Option<f64>,
    /// Relative tolerance of the method.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rtol: Option<f64>,
    /// True if contact events are located.
    pub events: bool,
    /// Gears whose hubs the host moves.
    pub moved: Vec<String>,
    /// Hash of the variables, [`Interface::key`](super::interface::Interface::key).
    pub interface: String,
}

/// Reason why the resources of an FMU cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// A file cannot be read.
    #[error("{path}: {error}; the resources of an FMU have to be unpacked without changes")]
    Read {
        /// Path of the file.
        path: String,
        /// The error of the operating system.
        error: std::io::Error,
    },
    /// The settings cannot be parsed.
    #[error("{SETTINGS}: {0}; pack the FMU again with `gearbench fmu`")]
    Settings(#[from] serde_json::Error),
    /// The scene cannot be read.
    #[error("{}", .0.to_text())]
    Scene(#[from] SceneError),
    /// The resources differ from the packed ones.
    #[error("{0}; pack the FMU again with `gearbench fmu`")]
    Changed(String),
}

/// A scene that is opened from the resources of an FMU.
pub struct OpenedScene {
    /// The scene with its ports and variables.
    pub coupled: Coupled,
    /// Integration method of co-simulation with its step or tolerance.
    pub scheme: Scheme,
    /// True if contact events are located.
    pub events: bool,
}

impl Settings {
    /// The method with its step or tolerance; `None` if the settings do not have exactly one of them.
    pub fn scheme(&self) -> Option<Scheme> {
        let resolution = match (self.step_s, self.rtol) {
            (Some(h), None) => Resolution::Step(h),
            (None, Some(rtol)) => Resolution::Tolerance(rtol),
            _ => return None,
        };
        Some(self.method.at(resolution))
    }

    /// The text of the settings file.
    pub fn text(&self) -> String {
        // The settings have numbers and texts only, which JSON can represent.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// The instantiation token: a hash of settings and scene that ties the model description to the resources.
    pub fn token(settings: &str, scene: &str) -> String {
        let mut hash = Hash::START;
        hash.text(settings);
        hash.text(scene);
        hash.to_string()
    }
}

/// Opens the resources of an FMU.
///
/// # Errors
/// A resource is missing, was changed, or comes from another version.
pub fn open(resources: &Path, token: &str) -> Result<OpenedScene, OpenError> {
    let read = |name: &str| {
        let path = resources.join(name);
        std::fs::read_to_string(&path).map_err(|error| OpenError::Read {
            path: path.display().to_string(),
            error,
        })
    };
    let (settings, text) = (read(SETTINGS)?, read(SCENE)?);
    if Settings::token(&settings, &text) != token {
        return Err(OpenError::Changed(
            "scene or settings do not match the model description".into(),
        ));
    }
    let settings: Settings = serde_json::from_str(&settings)?;
    let origin = Origin::File(resources.join(SCENE));
    let mut file = SceneFile::unbuilt(&Context::default(), SCENE, &text, origin, true)?;
    file.damp_unbuilt(&[&settings.model])?;
    let changed = |why: &str| OpenError::Changed(why.to_owned());
    let choice = (file.model(&settings.model)).ok_or_else(|| changed("the model is missing"))?;
    let scheme = (settings.scheme()).ok_or_else(|| changed("step and tolerance are not unique"))?;
    let coupled = Coupled::assemble(&file, choice, &settings.moved)?;
    if coupled.interface.key() != settings.interface {
        return Err(OpenError::Changed(format!(
            "the library ({}) and the program that packed the FMU ({}) number variables differently",
            env!("CARGO_PKG_VERSION"),
            settings.gearbench
        )));
    }
    Ok(OpenedScene {
        coupled,
        scheme,
        events: settings.events,
    })
}
