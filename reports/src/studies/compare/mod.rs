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
mod teeth;
mod timing;
mod transmission;
mod window;
mod yardstick;

use crate::csv_table::CsvTable;
use crate::drawing::Chart;
use crate::drawing::canvas::DrawError;
use crate::markup::runs;
use crate::studies::{StudyReport, findings, of_scene};
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

/// Returns the report of a comparison of one or several scenes: charts and tables of histories, errors and costs have
/// the models of all scenes, pictures of flanks are those of each.
pub(super) fn report(views: &[View<'_>]) -> Result<StudyReport, DrawError> {
    let Some(first_scene) = views.first() else {
        return Ok(StudyReport::default());
    };
    let (finding, answer) = findings(views, |view| {
        // The sentence on the yardstick is first.
        (
            finding::finding(view),
            usize::from(view.yardstick.is_some()),
        )
    });
    let moving = motion::viewer(&View::joined(views), mesh::FILE);
    let still = mesh::mesh(first_scene)?.map(|c| mesh::captioned(c, moving.as_ref()));
    let first = (histories::force(views)?.into_iter())
        .chain(cost::accuracy(views)?)
        .chain(histories::speeds(views)?)
        // Several scenes are compared for their transmission error.
        .chain(transmission::error(views)?.filter(|_| views.len() > 1))
        .chain(still);
    let before = [
        cost::runtime(views)?,
        pressure::pressure(views)?,
        transmission::error(views)?.filter(|_| views.len() == 1),
        teeth::teeth(views)?,
        channels::channels(views)?,
    ];
    let mut charts: Vec<Chart> = before.into_iter().flatten().collect();
    for view in views {
        let own = (paths::shares(view)?.into_iter())
            .chain(flanks::flanks(view)?)
            .chain(deformed::deformed(view)?);
        charts.extend(own.map(|c| Chart {
            title: view.with_scene(&c.title),
            ..c
        }));
    }
    Ok(StudyReport {
        finding,
        answer,
        first: first.collect(),
        tables: html! {
            (glance::glance(views))
            @for view in views {
                (of_scene(view, &html! {
                    (glance::others(view)) (glance::integration(view))
                    (timing::timing(view)) (meshes::table(view)) (paths::tables(view))
                }))
            }
        },
        charts,
        viewer: moving.map(|(viewer, _)| viewer),
        details: html! { @for view in views { (of_scene(view, &runs::all(view))) } },
        ..StudyReport::default()
    })
}

/// Returns the tables of a scene in files of their own.
pub(super) fn csv(view: &View<'_>) -> Vec<CsvTable> {
    [meshes::csv(view), paths::csv(view)].concat()
}
