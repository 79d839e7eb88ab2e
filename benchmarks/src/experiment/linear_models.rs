//! Models of a scene for analyses with dense matrices: all but full finite elements; and their mesh modes.

use super::configuration::Configuration;
use super::journal::JournalError;
use super::key::Key;
use super::motion::motion_of_mode;
use super::run::LEFT_OUT;
use super::runner::Runner;
use super::settings::settings;
use crate::scene_file::{ModelChoice, SceneError, SceneFile};
use crate::small_signals::mesh_mode::{FEW_OVER_CYCLE, ModeMotion, mesh_mode};
use gearbench_models::gear::table::Model;
use gearbench_reports::record::MeshMode;

/// The advice for full finite elements.
const TAKE_ELASTIC: &str =
    "use elastic gears, whose modes and compliance are reduced from the same mesh";

/// Selected models, and settings for the report.
type SelectedModels<'s> = (Vec<&'s ModelChoice>, Vec<(String, String)>);

/// Selects the models with some labels, or all of the study except full finite elements; also returns the settings for
/// the report.
///
/// # Errors
/// Unknown labels, or requested full finite elements.
pub fn selected_models<'s>(
    scene: &'s SceneFile,
    labels: Option<&str>,
) -> Result<SelectedModels<'s>, SceneError> {
    let choices = scene.select(labels)?;
    let large = |c: &&ModelChoice| {
        let ids = c.modelling.gears.iter().map(|g| g.id());
        ids.chain([c.model.as_str()])
            .any(|id| scene.properties_of(id).full_order)
    };
    let (left, taken): (Vec<&ModelChoice>, Vec<&ModelChoice>) =
        choices.into_iter().partition(large);
    if let Some(choice) = left
        .first()
        .filter(|_| labels.is_some() || taken.is_empty())
    {
        let why = format!(
            "`{}` has all nodes of finite elements as coordinates, too many for dense matrices",
            choice.label
        );
        return Err(SceneError::plain(why, TAKE_ELASTIC));
    }
    let mut told = settings(scene, &taken, false);
    told.retain(|(what, _)| {
        let parts = ["gear ", "shaft ", "mesh ", "damping ", "model ", "odd"];
        parts.iter().any(|p| what.starts_with(p))
    });
    told.extend(left.iter().map(|c| {
        let why = format!("{}: full finite elements; {TAKE_ELASTIC}", c.label);
        (LEFT_OUT.to_owned(), why)
    }));
    Ok((taken, told))
}

/// The mesh modes of all models of a study whose scene has loads, with their motions if the page shows these. A mode that
/// cannot be computed gives a row with the reason.
///
/// # Errors
/// [`JournalError`].
pub fn mesh_modes<'e>(
    entries: impl IntoIterator<Item = &'e Configuration>,
    models: &[Model],
    runner: &Runner<'_>,
    moving: bool,
) -> Result<Vec<MeshMode>, JournalError> {
    let mut all = Vec::new();
    for entry in entries {
        if runner.is_interrupted() {
            break;
        }
        let key = Key::new("mesh mode").and_scene(&entry.scene, &entry.modelling);
        let key = if moving { key.and(&"moving") } else { key };
        let label = entry.model_label();
        let of = (&entry.scene, &entry.modelling);
        let found = runner.piece(key, || {
            let motion_of: ModeMotion<'_> = &motion_of_mode;
            let motion_of = moving.then_some(motion_of);
            Ok::<_, JournalError>(mesh_mode(&label, of, models, FEW_OVER_CYCLE, motion_of))
        })?;
        all.extend(found);
    }
    Ok(all)
}
