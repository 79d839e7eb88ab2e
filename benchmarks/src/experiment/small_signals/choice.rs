//! Selection of the models of a scene for dense matrices: all but full finite elements.

use crate::experiment::run::LEFT_OUT;
use crate::experiment::settings::settings;
use crate::scene_file::{ModelChoice, SceneError, SceneFile};

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
        let ids = c.modelling.gears.iter().map(|g| g.id.as_str());
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
        let parts = ["gear ", "shaft ", "mesh ", "model ", "odd"];
        parts.iter().any(|p| what.starts_with(p))
    });
    told.extend(left.iter().map(|c| {
        let why = format!("{}: full finite elements; {TAKE_ELASTIC}", c.label);
        (LEFT_OUT.to_owned(), why)
    }));
    Ok((taken, told))
}
