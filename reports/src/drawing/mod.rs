//! Charts as self-contained SVG documents, each a pure function of a record.
//!
//! Every model has one colour, dash pattern and marker in all charts; a reference is the
//! thick dark line. Axes carry units; long histories are decimated so that peaks stay.
//!
//! plotters writes the SVG ([`canvas`]); axes, legends and dashes are laid out here, where its `ChartBuilder` has no
//! equal: its logarithmic axes label decades alone, where spans of a decade need 1, 2, 5; its legend is one column inside
//! the plot, over the data; `DashedLineSeries` has one length of dash and gap, no dash-dot, and breaks a history of a
//! thousand points into as many elements, where SVG has an attribute; and panels that share an axis, strips of failed
//! runs and names that keep clear of points need the places of things on the page, which it keeps to itself.

pub mod axis;
pub mod canvas;
pub mod geometry;
pub mod labels;
pub mod legend;
pub mod panel;
pub mod scatter;
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
