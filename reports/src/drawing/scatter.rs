//! Common parts of charts of error over cost: key of models, numbers of integrators, strip of failed runs, line of the
//! tolerance.

use super::axis::{Frame, NAME_SIZE, TICK_SIZE};
use super::canvas::{Anchor, Canvas, Ink, Stroke, Type, text_width};
use super::geometry::Rect;
use super::labels::OccupiedArea;
use super::legend::{entry_attributes, in_rows};
use super::panel::{LEFT, RIGHT};
use super::style::{cross, curve_style, marker};

/// Largest number of failed runs that the strip names.
const NAMED: usize = 6;
const ROW: f64 = 18.0;

/// Returns left edge and row of the entries of the key: models, then the meaning of filled markers.
fn key_places(names: &[(&str, usize)], width: f64) -> Vec<(f64, usize)> {
    let widths = names
        .iter()
        .map(|n| 38.0 + 1.08 * text_width(n.0, NAME_SIZE));
    in_rows(
        widths.chain([text_width(FILLING, TICK_SIZE)]),
        LEFT + 6.0,
        width - RIGHT,
    )
}

/// Legend text for filled and open markers in every chart of runs.
const FILLING: &str = "filled: explicit, open: implicit";

/// Returns the height of [`key`].
pub fn key_height(names: &[(&str, usize)], width: f64) -> f64 {
    8.0 + 20.0 * (key_places(names, width).last().map_or(0, |p| p.1) + 1) as f64
}

/// Paints the key of models by colour and marker, in the order of their styles; `methods` adds the meaning of filled
/// markers.
pub fn key(c: &mut Canvas, names: &[(&str, usize)], width: f64, methods: bool) {
    let places = key_places(names, width);
    for ((name, style), (x, row)) in names.iter().zip(&places) {
        let y = 12.0 + 20.0 * *row as f64;
        c.group(&entry_attributes(*style), |c| {
            marker(c, (*x, y), 5.2, curve_style(*style), true);
            c.text(name, (x + 12.0, y), Type::new(NAME_SIZE, Anchor::Start));
        });
    }
    if let (true, Some((x, row))) = (methods, places.last()) {
        let kind = Type::new(TICK_SIZE, Anchor::Start).ink(Ink::GREY);
        c.text(FILLING, (x - 6.0, 12.0 + 20.0 * *row as f64), kind);
    }
}

/// Integrators by number, in the order of appearance: names would hide each other.
pub struct Numbers<'a> {
    names: Vec<&'a str>,
    /// Width of the chart.
    width: f64,
}

impl<'a> Numbers<'a> {
    pub fn of(names: impl IntoIterator<Item = &'a str>, width: f64) -> Self {
        let mut all: Vec<&str> = Vec::new();
        for name in names {
            if !all.contains(&name) {
                all.push(name);
            }
        }
        Self { names: all, width }
    }

    /// Returns the number of an integrator.
    pub fn text(&self, name: &str) -> String {
        let place = self.names.iter().position(|n| *n == name);
        place.map_or_else(String::new, |i| (i + 1).to_string())
    }

    fn places(&self) -> Vec<(f64, usize)> {
        let widths = self
            .names
            .iter()
            .map(|n| 34.0 + 1.08 * text_width(n, TICK_SIZE));
        in_rows(widths, LEFT, self.width - RIGHT)
    }

    /// Returns the height of the key below a plot.
    pub fn height(&self) -> f64 {
        8.0 + ROW * self.places().last().map_or(0, |p| p.1 + 1) as f64
    }

    /// Writes the key from `top` downwards.
    pub fn paint(&self, c: &mut Canvas, top: f64) {
        for (i, (name, (x, row))) in self.names.iter().zip(self.places()).enumerate() {
            let y = top + ROW * (row as f64 + 0.5);
            let number = Type::new(TICK_SIZE, Anchor::End).bold();
            c.text(&(i + 1).to_string(), (x + 14.0, y), number);
            let kind = Type::new(TICK_SIZE, Anchor::Start);
            c.text(name, (x + 19.0, y), kind);
        }
    }
}

/// Returns the height of the strip for a number of failed runs.
pub fn failures_height(failed: usize) -> f64 {
    match failed {
        0 => 0.0,
        n => 16.0 + ROW * n.min(NAMED) as f64,
    }
}

/// Paints failed runs with their colours in a strip that ends above `bottom`; `rest` names the place of those that do
/// not fit.
pub fn failures(c: &mut Canvas, failed: &[(Ink, String)], width: f64, bottom: f64, rest: &str) {
    if failed.is_empty() {
        return;
    }
    let top = bottom - failures_height(failed.len());
    let edge = Rect::new(LEFT, top, width - RIGHT, bottom - 8.0);
    c.edge_of_failures(&edge);
    let kind = Type::new(TICK_SIZE, Anchor::Start);
    let word = Type::new(TICK_SIZE, Anchor::End).ink(Ink::FAIL);
    c.text("failed", (LEFT - 10.0, edge.middle()), word);
    let more = failed.len() > NAMED;
    let shown = if more { NAMED - 1 } else { failed.len() };
    let mut y = edge.y0 + 13.0;
    for (ink, text) in &failed[..shown] {
        cross(c, (edge.x0 + 14.0, y), 4.2, *ink);
        c.text(text, (edge.x0 + 27.0, y), kind);
        y += ROW;
    }
    if more {
        let text = format!("and {} more, see {rest}", failed.len() - shown);
        c.text(&text, (edge.x0 + 27.0, y), kind);
    }
}

/// Draws the line of a tolerance and returns its ordinate; [`OccupiedArea::write_along`] names it when all points are placed.
pub fn tolerance(c: &mut Canvas, frame: &Frame, limit: f64, room: &mut OccupiedArea) -> f64 {
    let (x, y) = frame.at(frame.x.max, limit);
    let line = [(frame.area.x0, y), (x, y)];
    let stroke = Stroke::dashed(Ink::DARK, 1.2, &[6.0, 4.0]);
    c.line_within(&line, &frame.area, stroke);
    room.occupy_line(&line);
    y
}
