//! `--measured FILE.csv`: measured curves to be compared with the tables of a study, whose columns they are called after
//! (docs/data.md). Columns of texts choose the rows of the tables that a curve belongs to.

use super::terminal::Refusal;
use crate::scene_file::tables;
use gearbench_reference::data::{Curve, curves};
use gearbench_reports::measured::MeasuredCurve;
use std::path::Path;

/// Largest size of a file [bytes].
const LARGEST: u64 = 1 << 26;

/// Reads the measured curves of a file.
///
/// # Errors
/// [`Refusal::Input`] with the line at which the file is not a table of measured curves.
pub fn read(path: &Path) -> Result<Vec<MeasuredCurve>, Refusal> {
    let from = "paths count from where the command runs";
    let text = tables::text(path, LARGEST, from).map_err(|e| e.plain())?;
    let found = curves(&text.decoded).map_err(|e| text.error(&e, "--measured"))?;
    let measured = |c: Curve| MeasuredCurve {
        source: text.name.clone(),
        abscissa: c.abscissa,
        ordinate: c.ordinate,
        only: c.texts,
        x: c.x,
        y: c.y,
    };
    Ok(found.into_iter().map(measured).collect())
}
