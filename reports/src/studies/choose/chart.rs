//! Estimated error against predicted cost of everything that a choice has tried.

use crate::drawing::Chart;
use crate::drawing::axis::{Axis, Frame};
use crate::drawing::canvas::{Anchor, Canvas, DrawError, Ink, Type, draw, text_width};
use crate::drawing::geometry::Rect;
use crate::drawing::panel::{LEFT, RIGHT, WIDTH, extremes};
use crate::drawing::scatter;
use crate::drawing::style::{look, marker};
use crate::numbers::{Prefix, quantity, short};
use crate::studies::choose::{ChoiceRecord, TriedRecord};

/// A candidate that has both an error and a cost.
struct Point<'a> {
    tried: &'a TriedRecord,
    style: usize,
    cost: f64,
    error: f64,
    chosen: bool,
}

/// The chart of a choice.
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
    let failed: Vec<(Ink, String)> = (choice.tried.iter())
        .filter_map(|t| {
            let why = t.failure.as_deref()?;
            let why = why.split(':').next().unwrap_or(why);
            let text = format!("{}, {}: {why}", t.level, t.method());
            Some((look(style(t)).ink, text))
        })
        .collect();
    let limit = 100.0 * choice.tolerance;
    let (least, most) = extremes(points.iter().map(|p| p.cost));
    let prefix = Prefix::of(least, 1.0);
    let x = Axis::logarithmic(least * prefix.factor, most * prefix.factor);
    let (low, high) = extremes(points.iter().map(|p| p.error).chain([limit]));
    let y = Axis::logarithmic(low, high);
    let top = 34.0 + scatter::failures_height(failed.len());
    let area = Rect::new(LEFT, top, WIDTH - RIGHT, top + 360.0);
    let title = "Estimated error against predicted cost";
    let svg = draw(WIDTH, area.y1 + 46.0, title, |c| {
        let names: Vec<(&str, usize)> = families.iter().copied().zip(0..).collect();
        scatter::key(c, &names);
        scatter::failures(c, &failed, top, "choose.csv");
        let frame = Frame { area, x, y };
        let name = format!("{} [%]", choice.metric_title);
        let cost = format!("processor time for the whole scene [{}s]", prefix.symbol);
        frame.paint(c, &cost, &name, true);
        let text = format!("tolerance {} %", short(limit, 3));
        scatter::tolerance(c, &frame, limit, &text);
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

fn caption(choice: &ChoiceRecord) -> String {
    format!(
        "Each point is a model under an integrator at one step or tolerance, run on the window ({}). Filled: estimated to \
         keep the tolerance with its margin; open and pale: not, or not by enough. The ring is the choice. Errors are \
         distances to the top level with what that level is off, over the whole scene; costs are scaled from the window, set-up \
         not included.",
        choice.window
    )
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
