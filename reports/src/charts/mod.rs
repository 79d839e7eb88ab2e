//! Charts as self-contained SVG documents, each a pure function of a record.
//!
//! Every model has one colour, dash pattern and marker in all charts; a reference is the
//! thick dark line. Axes carry units; long histories are decimated so that peaks stay.

mod axis;
mod canvas;
mod choice_check;
mod choose;
mod cost;
mod curves;
mod histories;
mod lines;
mod mesh;
pub(crate) mod penalty;
pub(crate) mod precision;
pub(crate) mod stability;
mod stiffness;
mod style;
pub(crate) mod sweep;
mod truncation;

pub use canvas::DrawError;
pub use stiffness::{StiffnessCurve, StiffnessCurves, stiffness};

use crate::record::Results;
use crate::view::View;

/// One chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// File name.
    pub file: &'static str,
    /// Heading.
    pub title: &'static str,
    /// How to read it, in plain text.
    pub caption: String,
    /// The SVG document.
    pub svg: String,
}

/// File names that charts of a record can have.
pub(crate) const FILES: &[&str] = &[
    "force.svg",
    "speeds.svg",
    "mesh.svg",
    "runtime.svg",
    "accuracy.svg",
    "truncation.svg",
    "truncation_frequencies.svg",
    "truncation_peak.svg",
    "truncation_cost.svg",
    "sweep.svg",
    "sweep_spectra.svg",
    "sweep_harmonics.svg",
    "sweep_cycles.svg",
    "penalty.svg",
    "penalty_distance.svg",
    "choice_check.svg",
    "choose.svg",
];

/// The charts a record has data for, in the order of the report.
///
/// # Errors
/// [`DrawError`] when the drawing backend refuses.
pub fn charts(results: &Results) -> Result<Vec<Chart>, DrawError> {
    let view = View::new(results);
    if view.results.choice.is_some() {
        return Ok(choose::choose(&view)?.into_iter().collect());
    }
    if truncation::applies(&view) {
        let mut all = truncation::truncation(&view)?;
        all.extend(histories::force(&view)?);
        return Ok(all);
    }
    if penalty::applies(&view) {
        let mut all = penalty::penalty(&view)?;
        all.extend(histories::force(&view)?);
        return Ok(all);
    }
    if stability::applies(&view) {
        return stability::stability(&view);
    }
    if choice_check::applies(&view) {
        return choice_check::choice_check(&view);
    }
    if sweep::applies(&view) {
        return sweep::sweep(&view);
    }
    if precision::applies(results) {
        return precision::precision(&view);
    }
    let all = [
        histories::force(&view)?,
        histories::speeds(&view)?,
        mesh::mesh(&view)?,
        cost::runtime(&view)?,
        cost::accuracy(&view)?,
    ];
    Ok(all.into_iter().flatten().collect())
}

/// The colour of a model, for HTML.
pub(crate) fn swatch(style: usize) -> String {
    let canvas::Ink(r, g, b, _) = style::look(style).ink;
    format!("#{r:02x}{g:02x}{b:02x}")
}
