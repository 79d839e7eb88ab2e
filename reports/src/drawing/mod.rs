//! Charts as self-contained SVG documents, each a pure function of a record.
//!
//! Every model has one colour, dash pattern and marker in all charts; a reference is the
//! thick dark line. Axes carry units; long histories are decimated so that peaks stay.
//!
//! plotters writes the SVG ([`canvas`]); axes, legends and dashes are laid out here. Its `ChartBuilder` was tried on the
//! chart of errors over mode counts (two panels, both axes logarithmic, 0.3.7): `with_key_points` takes ticks at 1, 2, 5
//! and units stand on the axes, but the ticks are ours again ([`axis::Axis::ticks`]), linear and logarithmic axes are
//! different types (four pairs of them, or a coordinate of our own), and what it would replace is `axis::Frame`, 60 lines
//! for some 45 of configuration. What looked worse: its legend is one column inside the plot, over the data; names of
//! ordinates are cut at the edge; panels that share an axis get unequal plots; `DashedLineSeries` has one length of dash
//! and gap, no dash-dot, and writes every dash as an element (709 elements for two curves, 285 here for four with
//! markers, failures and marks). Strips of failed runs and names that keep clear of points need the places of things
//! on the page, which it keeps to itself.

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
