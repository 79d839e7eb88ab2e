//! Legends of charts: entries in as few rows as the width allows.

use super::axis::NAME_SIZE;
use super::canvas::{Anchor, Canvas, Stroke, Type, text_width};
use super::panel::{Curve, LEFT, RIGHT};
use super::style::{CurveStyle, curve_style, marker};

const ROW: f64 = 21.0;

/// An entry of the legend: its text, a sample of the line, a marker with its filling.
#[derive(Clone, Debug)]
pub struct Entry {
    text: String,
    stroke: Stroke,
    marker: Option<(CurveStyle, bool)>,
}

impl Entry {
    /// Makes an entry with a line sample and no marker.
    pub fn line(text: &str, stroke: Stroke) -> Self {
        Self {
            text: text.into(),
            stroke,
            marker: None,
        }
    }

    /// Makes an entry with a line and the markers of its model, if it has one.
    pub fn history(text: &str, stroke: Stroke, style: Option<usize>) -> Self {
        Self {
            marker: style.map(|s| (curve_style(s), true)),
            ..Self::line(text, stroke)
        }
    }

    /// Makes an entry with a line and markers.
    pub fn marked(text: &str, look: CurveStyle, filled: bool) -> Self {
        Self {
            marker: Some((look, filled)),
            ..Self::line(text, Stroke::dashed(look.ink, 1.6, look.dash))
        }
    }

    /// True if a curve has the look of the entry. An overview has lines without dash, and markers or none.
    fn describes(&self, curve: &Curve) -> bool {
        let stroke = curve.stroke.unwrap_or_else(|| Stroke::new(curve.ink, 1.0));
        let place = curve.along.map(curve_style);
        let look = place.or(curve.marker.map(|(look, ..)| look));
        let dashes = [self.stroke.dash, stroke.dash];
        self.stroke.ink == stroke.ink
            && (dashes[0] == dashes[1] || dashes.iter().any(|dash| dash.is_empty()))
            && match (self.marker, look) {
                (Some((own, _)), Some(look)) => own.marker == look.marker,
                _ => true,
            }
    }
}

/// Returns the index of the entry that describes a curve, rather one whose marker is filled as those of the curve are.
pub fn entry_of(legend: &[Entry], curve: &Curve) -> Option<usize> {
    let filled = curve.marker.is_none_or(|(.., filled)| filled);
    let is_same = |e: &&Entry| e.marker.is_none_or(|(_, own)| own == filled);
    let found = |same: bool| {
        let mut entries = legend.iter();
        entries.position(|e| e.describes(curve) && (!same || is_same(&e)))
    };
    found(true).or_else(|| found(false))
}

/// Returns the left edge and row of every entry on a chart of this width.
fn places(legend: &[Entry], width: f64) -> Vec<(f64, usize)> {
    let widths = legend
        .iter()
        .map(|e| 62.0 + 1.08 * text_width(&e.text, NAME_SIZE));
    in_rows(widths, LEFT, width - RIGHT)
}

pub fn legend_height(legend: &[Entry], width: f64) -> f64 {
    ROW * places(legend, width).last().map_or(0, |p| p.1 + 1) as f64
}

/// Paints a legend at the top of a chart.
pub fn paint_legend(c: &mut Canvas, legend: &[Entry], width: f64) {
    for (i, (entry, (x, row))) in legend.iter().zip(places(legend, width)).enumerate() {
        let y = 12.0 + ROW * row as f64;
        c.group(&entry_attributes(i), |c| {
            c.line(&[(x, y), (x + 34.0, y)], entry.stroke);
            if let Some((look, filled)) = entry.marker {
                marker(c, (x + 17.0, y), 4.6, look, filled);
            }
            let kind = Type::new(NAME_SIZE, Anchor::Start);
            c.text(&entry.text, (x + 41.0, y), kind);
        });
    }
}

/// Returns the attributes of an entry of a legend, by which the script of a page finds its curves.
pub fn entry_attributes(entry: usize) -> [(&'static str, String); 2] {
    [("class", "entry".into()), ("data-entry", entry.to_string())]
}

/// Places boxes of given widths in rows and returns left edge and row of each.
pub fn in_rows(widths: impl Iterator<Item = f64>, left: f64, right: f64) -> Vec<(f64, usize)> {
    let (mut x, mut row) = (left, 0);
    let place = |width: f64| {
        if x + width > right && x > left {
            (x, row) = (left, row + 1);
        }
        let place = (x, row);
        x += width;
        place
    };
    widths.map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Curves of one look that differ in the filling of their markers have entries of their own.
    #[test]
    fn a_curve_has_the_entry_of_its_look() {
        let look = curve_style(0);
        let legend = [
            Entry::marked("up", look, true),
            Entry::marked("down", look, false),
            Entry::marked("other", curve_style(1), true),
        ];
        let curve = |look: CurveStyle, filled: bool| Curve::points(look, 3.0, filled, Vec::new());
        assert_eq!(entry_of(&legend, &curve(look, true)), Some(0));
        assert_eq!(entry_of(&legend, &curve(look, false)), Some(1));
        assert_eq!(entry_of(&legend, &curve(curve_style(1), false)), Some(2));
        assert_eq!(entry_of(&legend, &curve(curve_style(2), true)), None);
    }
}
