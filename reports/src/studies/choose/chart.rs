//! Estimated error against predicted cost of everything that a choice has tried.

use crate::drawing::Chart;
use crate::drawing::axis::{Axis, Frame};
use crate::drawing::canvas::{
    Anchor, Canvas, DrawError, Ink, Rect, Stroke, Type, draw, text_width,
};
use crate::drawing::lines::{LEFT, RIGHT, WIDTH};
use crate::drawing::style::{cross, look, marker};
use crate::numbers::{Prefix, quantity, short};
use crate::studies::choose::{ChoiceRecord, TriedRecord};

/// Failed candidates that are named.
const NAMED: usize = 6;
const ROW: f64 = 18.0;

/// A candidate that has both an error and a cost.
struct Point<'a> {
    tried: &'a TriedRecord,
    style: usize,
    cost: f64,
    error: f64,
    chosen: bool,
}

/// The chart of a choice.
///
/// # Errors
/// [`DrawError`] when the backend refuses.
pub fn choose(choice: &ChoiceRecord) -> Result<Option<Chart>, DrawError> {
    let families = choice.families();
    let style = |t: &TriedRecord| families.iter().position(|f| *f == t.family).unwrap_or(0);
    let positive = |x: Option<f64>| x.filter(|x| x.is_finite() && *x > 0.0);
    let points: Vec<Point<'_>> = (choice.tried.iter().enumerate())
        .filter_map(|(i, t)| {
            Some(Point {
                tried: t,
                style: style(t),
                cost: positive(t.cost_s)?,
                error: 100.0 * positive(t.error)?,
                chosen: choice.chosen == Some(i),
            })
        })
        .collect();
    if points.is_empty() {
        return Ok(None);
    }
    let failed: Vec<&TriedRecord> = (choice.tried.iter())
        .filter(|t| t.failure.is_some())
        .collect();
    let limit = 100.0 * choice.tolerance;
    let (least, most) = bounds(points.iter().map(|p| p.cost));
    let prefix = Prefix::of(least, 1.0);
    let x = Axis::logarithmic(least * prefix.factor, most * prefix.factor);
    let (low, high) = bounds(points.iter().map(|p| p.error).chain([limit]));
    let y = Axis::logarithmic(low, high);
    let strip = match failed.len() {
        0 => 0.0,
        n => 16.0 + ROW * n.min(NAMED) as f64,
    };
    let top = 34.0;
    let area = Rect::new(LEFT, top + strip, WIDTH - RIGHT, top + strip + 360.0);
    let title = "Estimated error against predicted cost";
    let svg = draw(WIDTH, area.y1 + 46.0, title, |c| {
        key(c, &families);
        if strip > 0.0 {
            let edge = Rect::new(LEFT, top, WIDTH - RIGHT, top + strip - 8.0);
            failures(c, &failed, &edge, &style);
        }
        let frame = Frame { area, x, y };
        let name = format!("{} [%]", choice.metric_title);
        let cost = format!("processor time for the whole scene [{}s]", prefix.symbol);
        frame.paint(c, &cost, &name, true);
        line(c, &frame, limit);
        let at = |p: &Point<'_>| frame.at(p.cost * prefix.factor, p.error);
        for p in &points {
            let mut l = look(p.style);
            if !p.tried.adequate {
                l.ink = l.ink.opacity(0.35);
            }
            marker(c, at(p), 4.6, l, p.tried.adequate);
        }
        if let Some(p) = points.iter().find(|p| p.chosen) {
            chosen(c, p, at(p), &area);
        }
    })?;
    Ok(Some(Chart {
        file: "choose.svg".into(),
        title,
        caption: caption(choice),
        svg,
    }))
}

fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, 0.0), |(low, high), x| {
        (f64::min(low, x), f64::max(high, x))
    })
}

fn caption(choice: &ChoiceRecord) -> String {
    format!(
        "Each point is a model under an integrator at one step or tolerance, run on the window ({}). Filled: estimated to \
         keep the tolerance with its margin; open and pale: not, or not by enough. The ring is the choice. Errors are \
         distances to the top level with what that level is off, over the whole scene; costs are scaled from the window, set-up \
         not included.",
        choice.window
    )
}

fn key(c: &mut Canvas<'_>, families: &[&str]) {
    let mut x = LEFT + 6.0;
    for (style, family) in families.iter().enumerate() {
        marker(c, (x, 12.0), 5.0, look(style), true);
        c.text(family, (x + 12.0, 12.0), Type::new(13.5, Anchor::Start));
        x += 40.0 + text_width(family, 13.5);
    }
}

fn failures(
    c: &mut Canvas<'_>,
    failed: &[&TriedRecord],
    edge: &Rect,
    style: &dyn Fn(&TriedRecord) -> usize,
) {
    c.fill(edge, Ink(0xf7, 0xf3, 0xf2, 1.0));
    c.frame(edge, Stroke::new(Ink::PALE, 1.0));
    let kind = Type::new(12.5, Anchor::End).ink(Ink::FAIL);
    c.text("failed", (LEFT - 10.0, 0.5 * (edge.y0 + edge.y1)), kind);
    let shown = if failed.len() > NAMED {
        NAMED - 1
    } else {
        failed.len()
    };
    let mut y = edge.y0 + 13.0;
    for t in &failed[..shown] {
        cross(c, (edge.x0 + 14.0, y), 4.2, look(style(t)).ink);
        let why = t.failure.as_deref().unwrap_or_default();
        let why = why.split(':').next().unwrap_or(why);
        let text = format!("{}, {}: {why}", t.level, t.method());
        c.text(&text, (edge.x0 + 27.0, y), Type::new(12.5, Anchor::Start));
        y += ROW;
    }
    if shown < failed.len() {
        let text = format!("and {} more, see choose.csv", failed.len() - shown);
        c.text(&text, (edge.x0 + 27.0, y), Type::new(12.5, Anchor::Start));
    }
}

fn line(c: &mut Canvas<'_>, frame: &Frame, limit: f64) {
    let (x, y) = frame.at(frame.x.max, limit);
    let stroke = Stroke::dashed(Ink::DARK, 1.2, &[6.0, 4.0]);
    c.line_within(&[(frame.area.x0, y), (x, y)], &frame.area, stroke);
    let text = format!("tolerance {} %", short(limit, 3));
    let kind = Type::new(12.5, Anchor::End).ink(Ink::GREY);
    c.text(&text, (x - 8.0, y - 10.0), kind);
}

/// A ring around the choice, with its name beside it where there is room.
fn chosen(c: &mut Canvas<'_>, p: &Point<'_>, at: (f64, f64), area: &Rect) {
    c.circle(at, 10.0, Ink::DARK, Some(2.0));
    let text = format!(
        "{}, {}: {}",
        p.tried.level,
        p.tried.method(),
        quantity(p.cost, "s", 3)
    );
    let width = text_width(&text, 12.5);
    let left = (at.0 + 15.0).min(area.x1 - width - 6.0).max(area.x0 + 4.0);
    let below = if at.1 + 26.0 < area.y1 { 22.0 } else { -22.0 };
    let plate = Rect::new(
        left - 3.0,
        at.1 + below - 9.0,
        left + width + 3.0,
        at.1 + below + 9.0,
    );
    c.fill(&plate, Ink::WHITE.opacity(0.85));
    let kind = Type::new(12.5, Anchor::Start).bold();
    c.text(&text, (left, at.1 + below), kind);
}
