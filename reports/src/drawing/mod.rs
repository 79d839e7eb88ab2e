//! Charts as self-contained SVG documents, each a pure function of a record.
//!
//! Every model has one colour, dash pattern and marker in all charts; a reference is the
//! thick dark line. Axes carry units; long histories are decimated so that peaks stay.
//!
//! plotters writes the SVG ([`canvas`]); this module lays out axes, legends and dashes. The `ChartBuilder` of plotters
//! 0.3.7 was tried on the chart of errors over mode counts (two panels, both axes logarithmic) and rejected. It accepts
//! ticks at 1, 2, 5 (`with_key_points`), but they must come from [`axis::Axis::ticks`] all the same. Linear and
//! logarithmic axes are different types (four pairs of them, or a coordinate type of our own). It would replace
//! `axis::Frame`, 60 lines, by 45 lines of configuration. Its legend is one column inside the plot, over the data; it
//! cuts names of ordinates at the edge; panels with a common axis have plots of unequal size; `DashedLineSeries` has
//! one length of dash and gap, no dash-dot, and writes every dash as an element (709 elements for two curves, compared
//! with 285 here for four with markers, failures and marks). Strips of failed runs and the placement of names need
//! positions on the page, which it does not expose.

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
