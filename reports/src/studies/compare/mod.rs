//! The study that compares models and integrators of a scene; other studies use its charts of histories.

mod channels;
mod cost;
mod deformed;
mod finding;
mod flanks;
mod glance;
pub(super) mod histories;
mod mesh;
pub(super) mod meshes;
mod motion;
pub(super) mod paths;
mod pressure;
pub(super) mod solid;
mod teeth;
mod timing;
mod transmission;
mod window;
mod yardstick;

use crate::drawing::canvas::DrawError;
use crate::markup::runs;
use crate::studies::StudyReport;
use crate::view::View;
use maud::html;
use serde::{Deserialize, Serialize};
pub use yardstick::{Kind, Yardstick};

/// Width of the chart of the force \[page units\], which is next to the chart of the errors on a screen.
const FORCE_WIDTH: f64 = 640.0;
/// Width of the chart of the errors over cost \[page units\].
const ERROR_WIDTH: f64 = 500.0;

/// The part of a record that is specific to a comparison.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CompareRecord {
    /// Publication of the times of other programs, for [`crate::record::Run::published_s`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published: Option<String>,
    /// The yardstick of the comparison; absent where each model has only its own converged solution to be compared
    /// with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yardstick: Option<Yardstick>,
}

/// Returns the report of a comparison.
pub(super) fn report(view: &View<'_>, part: &CompareRecord) -> Result<StudyReport, DrawError> {
    let moving = motion::viewer(view, mesh::FILE);
    let first = [
        histories::force(view)?,
        cost::accuracy(view)?,
        histories::speeds(view)?,
        mesh::mesh(view)?.map(|c| mesh::captioned(c, moving.as_ref())),
    ];
    let before = [
        cost::runtime(view)?,
        pressure::pressure(view)?,
        transmission::error(view)?,
        teeth::teeth(view)?,
        channels::channels(view)?,
        paths::shares(view)?,
    ];
    let charts = (before.into_iter().flatten())
        .chain(flanks::flanks(view)?)
        .chain(deformed::deformed(view)?);
    Ok(StudyReport {
        finding: finding::finding(view),
        // The sentence on the yardstick is first.
        answer: usize::from(view.yardstick.is_some()),
        first: first.into_iter().flatten().collect(),
        tables: html! { (glance::glance(view)) (timing::timing(view, part)) (meshes::table(view)) (paths::tables(view)) },
        charts: charts.collect(),
        viewer: moving.map(|(viewer, _)| viewer),
        details: runs::all(view),
        csv: [meshes::csv(view), paths::csv(view)].concat(),
        ..StudyReport::default()
    })
}
