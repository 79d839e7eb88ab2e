//! Charts as self-contained SVG documents, each a pure function of a record.
//!
//! Every model has one colour, dash pattern and marker in all charts; a reference is the
//! thick dark line. Axes carry units; long histories are decimated so that peaks stay.
//!
//! [`canvas`] writes the SVG; this module lays out axes, legends and dashes. Groups with `data-` attributes describe
//! panels, curves and entries of legends, so that the script of a page (`markup/charts.js`) reads the values of curves
//! from the drawing and no datum is in the page twice.
//!
//! The crate plotters, which wrote the SVG before, has no groups, dashes, titles or attributes. Its `ChartBuilder` was
//! tried on the chart of errors over mode counts and rejected: its legend is one column over the data, panels with a
//! common axis have plots of unequal size, and every dash is an element.

pub mod axis;
pub mod canvas;
pub mod geometry;
pub mod heat;
pub mod ink;
pub mod labels;
pub mod legend;
pub mod panel;
pub mod scatter;
pub mod style;

pub use canvas::DrawError;

/// A chart as an SVG document with its file name and texts.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Name of the SVG file.
    pub file: String,
    /// Heading of the chart.
    pub title: String,
    /// Caption in plain text: how to read the chart.
    pub caption: String,
    /// Text of the SVG document.
    pub svg: String,
}
