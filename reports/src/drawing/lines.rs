//! Panels of lines over a common time axis, with one legend above them.

use super::axis::{Axis, Frame, NAME_SIZE, TICK_SIZE};
use super::canvas::{Anchor, Canvas, Ink, Rect, Stroke, Type, text_width};
use crate::series::decimate;

/// Width of a chart on the page.
pub const WIDTH: f64 = 860.0;
/// Space for the names and tick labels at the left.
pub const LEFT: f64 = 78.0;
/// Space at the right.
pub const RIGHT: f64 = 16.0;
const BUCKETS: usize = 1400;

/// One line: data in the units of the axes.
pub struct Line {
    /// Abscissae, ascending.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
    /// Look.
    pub stroke: Stroke,
}

/// One panel.
pub struct Panel {
    /// Height on the page.
    pub height: f64,
    /// Name and unit of the ordinate.
    pub y_name: String,
    /// Range of the ordinate; taken from the lines when absent.
    pub y: Option<Axis>,
    /// Window of the abscissa.
    pub x: Axis,
    /// Remark inside the frame, top left, where no line is expected.
    pub remark: String,
    /// The lines, the first at the bottom of the pile.
    pub lines: Vec<Line>,
    /// Name of the abscissa, when this panel shows it.
    pub x_name: Option<String>,
}

/// An entry of the legend.
pub struct Entry {
    /// Text.
    pub text: String,
    /// Look of the sample line.
    pub stroke: Stroke,
}

/// Rows a legend takes.
fn legend_rows(entries: &[Entry]) -> Vec<Vec<usize>> {
    let mut rows: Vec<Vec<usize>> = Vec::new();
    let mut x = f64::INFINITY;
    for (i, entry) in entries.iter().enumerate() {
        let width = 62.0 + text_width(&entry.text, NAME_SIZE);
        if x + width > WIDTH - RIGHT {
            rows.push(Vec::new());
            x = LEFT;
        }
        x += width;
        if let Some(row) = rows.last_mut() {
            row.push(i);
        }
    }
    rows
}

/// Height of a chart of panels.
pub fn height(panels: &[Panel], entries: &[Entry]) -> f64 {
    let panels: f64 = panels
        .iter()
        .map(|p| p.height + if p.x_name.is_some() { 50.0 } else { 14.0 })
        .sum();
    8.0 + 22.0 * legend_rows(entries).len() as f64 + panels
}

/// Paints legend and panels from the top.
pub fn paint(c: &mut Canvas<'_>, panels: &[Panel], entries: &[Entry]) {
    let mut y = 10.0;
    for row in legend_rows(entries) {
        let mut x = LEFT;
        for i in row {
            let entry = &entries[i];
            c.line(&[(x, y), (x + 34.0, y)], entry.stroke);
            c.text(
                &entry.text,
                (x + 41.0, y),
                Type::new(NAME_SIZE, Anchor::Start),
            );
            x += 62.0 + text_width(&entry.text, NAME_SIZE);
        }
        y += 22.0;
    }
    for panel in panels {
        let area = Rect::new(LEFT, y, WIDTH - RIGHT, y + panel.height);
        let frame = Frame {
            area,
            x: panel.x.clone(),
            y: panel.y.clone().unwrap_or_else(|| panel.range()),
        };
        let name = panel.x_name.as_deref();
        frame.paint(c, name.unwrap_or(""), &panel.y_name, name.is_some());
        for line in &panel.lines {
            let points: Vec<(f64, f64)> = panel
                .visible(line)
                .into_iter()
                .map(|i| frame.at(line.x[i], line.y[i]))
                .collect();
            c.line_within(&points, &area, line.stroke);
        }
        if !panel.remark.is_empty() {
            let at = (area.x0 + 10.0, area.y0 + 14.0);
            let width = text_width(&panel.remark, TICK_SIZE);
            let back = Rect::new(at.0 - 4.0, at.1 - 9.0, at.0 + width + 4.0, at.1 + 9.0);
            c.fill(&back, Ink::WHITE.opacity(0.85));
            c.text(
                &panel.remark,
                at,
                Type::new(TICK_SIZE, Anchor::Start).ink(Ink::GREY),
            );
        }
        y += panel.height + if name.is_some() { 50.0 } else { 14.0 };
    }
}

impl Panel {
    /// Samples to draw: those in the window and one beyond each end, decimated.
    fn visible(&self, line: &Line) -> Vec<usize> {
        let n = line.x.len().min(line.y.len());
        let start = line.x[..n].partition_point(|x| *x < self.x.min);
        let end = line.x[..n].partition_point(|x| *x <= self.x.max);
        let (start, end) = (start.saturating_sub(1), (end + 1).min(n));
        if start >= end {
            return Vec::new();
        }
        decimate(&line.x[start..end], &line.y[start..end], BUCKETS)
            .into_iter()
            .map(|i| start + i)
            .collect()
    }

    /// Range of all visible ordinates with a margin, and head room for the remark.
    fn range(&self) -> Axis {
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        for line in &self.lines {
            for i in self.visible(line) {
                let y = line.y[i];
                if y.is_finite() {
                    range = (range.0.min(y), range.1.max(y));
                }
            }
        }
        let mut axis = Axis::padded(range.0, range.1, 0.07);
        if !self.remark.is_empty() {
            axis.max += 0.22 * (axis.max - axis.min);
        }
        axis
    }
}
