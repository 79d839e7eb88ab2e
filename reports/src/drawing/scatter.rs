//! What charts of error against cost share: the key, the edge of failures, the line of the tolerance.

use super::axis::{Frame, NAME_SIZE, TICK_SIZE};
use super::canvas::{Anchor, Canvas, Ink, Stroke, Type, text_width};
use super::geometry::Rect;
use super::legend::in_rows;
use super::panel::{LEFT, RIGHT, WIDTH};
use super::style::{cross, look, marker};

/// Failures that are named.
const NAMED: usize = 6;
const ROW: f64 = 18.0;

/// Names by colour, in the order of their styles.
pub fn key(c: &mut Canvas<'_>, names: &[(&str, usize)]) {
    let widths = names.iter().map(|n| 38.0 + text_width(n.0, NAME_SIZE));
    let places = in_rows(widths, LEFT + 6.0, WIDTH - RIGHT);
    for ((name, style), (x, row)) in names.iter().zip(places) {
        let y = 12.0 + 20.0 * row as f64;
        marker(c, (x, y), 5.2, look(*style), true);
        c.text(name, (x + 12.0, y), Type::new(NAME_SIZE, Anchor::Start));
    }
}

/// Height of the edge of so many failures.
pub fn failures_height(failed: usize) -> f64 {
    match failed {
        0 => 0.0,
        n => 16.0 + ROW * n.min(NAMED) as f64,
    }
}

/// Failed runs with their colours, on an edge of their own that ends above `bottom`; `rest` says where the others stand.
pub fn failures(c: &mut Canvas<'_>, failed: &[(Ink, String)], bottom: f64, rest: &str) {
    if failed.is_empty() {
        return;
    }
    let top = bottom - failures_height(failed.len());
    let edge = Rect::new(LEFT, top, WIDTH - RIGHT, bottom - 8.0);
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

/// The line of a tolerance; the place of its name.
pub fn tolerance(c: &mut Canvas<'_>, frame: &Frame, limit: f64, text: &str) -> Rect {
    let (x, y) = frame.at(frame.x.max, limit);
    let stroke = Stroke::dashed(Ink::DARK, 1.2, &[6.0, 4.0]);
    c.line_within(&[(frame.area.x0, y), (x, y)], &frame.area, stroke);
    let kind = Type::new(TICK_SIZE, Anchor::End).ink(Ink::GREY);
    c.text(text, (x - 8.0, y - 10.0), kind);
    let width = text_width(text, TICK_SIZE);
    Rect::new(x - 12.0 - width, y - 18.0, x, y + 2.0)
}
