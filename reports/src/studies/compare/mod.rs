//! The study that compares models and integrators of a scene; other studies borrow its charts of histories.

mod channels;
mod cost;
mod finding;
mod glance;
pub(super) mod histories;
mod mesh;
mod pressure;
mod timing;
mod window;

use crate::drawing::canvas::DrawError;
use crate::markup::runs;
use crate::studies::StudyReport;
use crate::view::View;
use maud::html;
use serde::{Deserialize, Serialize};

/// What the record of this study has of its own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareRecord {
    /// Where times of other programs were published, for [`crate::record::Run::published_s`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published: Option<String>,
}

/// What the study says of a record.
pub(super) fn report(view: &View<'_>, part: &CompareRecord) -> Result<StudyReport, DrawError> {
    let charts = [
        histories::force(view)?,
        pressure::pressure(view)?,
        histories::speeds(view)?,
        channels::channels(view)?,
        mesh::mesh(view)?,
        cost::runtime(view)?,
        cost::accuracy(view)?,
    ];
    Ok(StudyReport {
        finding: finding::finding(view),
        tables: html! { (glance::glance(view)) (timing::timing(view, part)) },
        charts: charts.into_iter().flatten().collect(),
        details: runs::all(view),
        csv: Vec::new(),
        ..StudyReport::default()
    })
}
