//! Charts as self-contained SVG documents, each a pure function of a record.
//!
//! Every model has one colour, dash pattern and marker in all charts; a reference is the
//! thick dark line. Axes carry units; long histories are decimated so that peaks stay.

pub mod axis;
pub mod canvas;
pub mod curves;
pub mod labels;
pub mod lines;
pub mod style;

/// One chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// File name.
    pub file: String,
    /// Heading.
    pub title: &'static str,
    /// How to read it, in plain text.
    pub caption: String,
    /// The SVG document.
    pub svg: String,
}
