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

/// Returns the attributes of a chart whose groups of class `panel` the script of a page reads.
pub fn panels() -> [(&'static str, String); 1] {
    [("class", "panels".to_owned())]
}

/// Returns the attributes of the group of names, which a page hides while the chart is zoomed.
pub fn notes() -> [(&'static str, String); 1] {
    [("class", "notes".to_owned())]
}

/// Paints a point of a panel, with its text for the cursor of a page, the index of the look of its model, and the index of
/// its run if the page has a row of it.
pub fn point(
    c: &mut Canvas,
    (x, y): (f64, f64),
    (style, run): (usize, Option<usize>),
    text: &str,
    paint: impl FnOnce(&mut Canvas),
) {
    let mut attributes = vec![
        ("class", "point".to_owned()),
        ("data-at", format!("{x:.3} {y:.3}")),
        ("data-entry", style.to_string()),
    ];
    attributes.extend(run.map(|run| ("data-run", run.to_string())));
    c.group(&attributes, |c| {
        c.title(text);
        paint(c);
    });
}

/// Paints a line of a panel that is no curve to be read: it stays with its points while the chart is zoomed. `style` is
/// the index of the look of its model, if it has one.
pub fn guide(
    c: &mut Canvas,
    points: &[(f64, f64)],
    area: &Rect,
    stroke: Stroke,
    style: Option<usize>,
) {
    let class = [("class", "guide".to_owned())];
    let entry = style.map(|s| ("data-entry", s.to_string()));
    let attributes: Vec<_> = class.into_iter().chain(entry).collect();
    c.group(&attributes, |c| c.curve(points, area, stroke));
}

/// Draws the lines of limits with their names, which stay in sight while the chart is zoomed. All points must be in `room`.
pub fn limits(c: &mut Canvas, frame: &Frame, limits: &[(f64, String)], room: &mut OccupiedArea) {
    let area = frame.area;
    let lines = limits.iter().map(|(limit, text)| {
        let (_, y) = frame.at(frame.x.max, *limit);
        ([(area.x0, y), (area.x1, y)], text)
    });
    let lines: Vec<_> = lines
        .filter(|l| (area.y0..=area.y1).contains(&l.0[0].1))
        .collect();
    lines.iter().for_each(|(line, _)| room.occupy_line(line));
    let stroke = Stroke::dashed(Ink::DARK, 1.2, &[6.0, 4.0]);
    let kind = Type::new(TICK_SIZE, Anchor::Start).ink(Ink::GREY);
    for (line, text) in lines {
        c.group(&[("class", "limit".to_owned())], |c| {
            c.curve(&line, &area, stroke);
            let at = format!("{:.3} {:.3}", area.x0, line[0].1);
            let name = [("class", "along".to_owned()), ("data-at", at)];
            c.group(&name, |c| {
                room.write_along(c, text, line[0].1, kind);
            });
        });
    }
}
