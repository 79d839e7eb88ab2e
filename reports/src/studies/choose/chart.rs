//! Chart of estimated error over predicted cost of all candidates of a choice.

use crate::drawing::Chart;
use crate::drawing::axis::{Axis, Frame, TICK_SIZE};
use crate::drawing::canvas::{Anchor, DrawError, Ink, Type, draw_with};
use crate::drawing::geometry::Rect;
use crate::drawing::labels::OccupiedArea;
use crate::drawing::panel::{LEFT, RIGHT, WIDTH, extremes};
use crate::drawing::scatter;
use crate::drawing::style::{curve_style, marker};
use crate::numbers::{Prefix, per_cent, quantity, short};
use crate::studies::choose::{Adequacy, CandidateRecord, ChoiceRecord};

/// A candidate that has both an error and a cost.
struct Point<'a> {
    tried: &'a CandidateRecord,
    style: usize,
    cost: f64,
    error: f64,
    chosen: bool,
}

impl Point<'_> {
    fn is_adequate(&self) -> bool {
        self.tried.adequate == Adequacy::Adequate
    }

    /// Returns candidate, verdict, error and cost as a text.
    fn text(&self) -> String {
        format!(
            "{}, {}: {}; {} in {}{}",
            self.tried.level,
            self.tried.method(),
            self.tried.adequate,
            per_cent(0.01 * self.error, 3),
            quantity(self.cost, "s", 3),
            if self.chosen { ", the choice" } else { "" }
        )
    }
}

/// Draws the chart of a choice.
pub fn choose(choice: &ChoiceRecord) -> Result<Option<Chart>, DrawError> {
    let families = choice.families();
    let style = |t: &CandidateRecord| families.iter().position(|f| *f == t.family).unwrap_or(0);
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
            Some((curve_style(style(t)).ink, text))
        })
        .collect();
    let limit = 100.0 * choice.tolerance;
    let (least, most) = extremes(points.iter().map(|p| p.cost));
    let prefix = Prefix::of(least, 1.0);
    let x = Axis::logarithmic(least * prefix.factor, most * prefix.factor);
    let (low, high) = extremes(points.iter().map(|p| p.error).chain([limit]));
    let y = Axis::logarithmic(low, high);
    let names: Vec<(&str, usize)> = families.iter().copied().zip(0..).collect();
    let top = 6.0 + scatter::key_height(&names, WIDTH) + scatter::failures_height(failed.len());
    let area = Rect::new(LEFT, top, WIDTH - RIGHT, top + 360.0);
    let title = "Estimated error against predicted cost";
    let svg = draw_with(WIDTH, area.y1 + 46.0, title, &scatter::panels(), |c| {
        scatter::key(c, &names, WIDTH, false);
        scatter::failures(c, &failed, WIDTH, top, "choose.csv");
        let frame = Frame { area, x, y };
        let name = format!("estimated error of the {} [%]", choice.metric_title);
        let cost = format!("processor time for the whole scene [{}s]", prefix.symbol);
        c.group(&frame.attributes("panel", &cost, &name, ""), |c| {
            frame.paint(c, &cost, &name, true);
            let mut room = OccupiedArea::of(area);
            let at = |p: &Point<'_>| frame.at(p.cost * prefix.factor, p.error);
            let radius = |p: &Point<'_>| match (p.chosen, p.is_adequate()) {
                (true, _) => 10.0,
                (_, true) => 6.2,
                _ => 4.6,
            };
            points
                .iter()
                .for_each(|p| room.occupy_point(at(p), radius(p)));
            let tolerance = (limit, format!("tolerance {} %", short(limit, 3)));
            scatter::limits(c, &frame, &[tolerance], &mut room);
            for p in &points {
                let mut l = curve_style(p.style);
                let size = if p.is_adequate() { 5.2 } else { 3.6 };
                if !p.is_adequate() {
                    l.ink = l.ink.opacity(0.35);
                }
                scatter::point(c, at(p), (p.style, None), &p.text(), |c| {
                    marker(c, at(p), size, l, true);
                    if p.chosen {
                        c.circle(at(p), 10.0, Ink::DARK, Some(2.0));
                    }
                });
            }
            if let Some(p) = points.iter().find(|p| p.chosen) {
                let cost = quantity(p.cost, "s", 3);
                let text = format!("{}, {}: {cost}", p.tried.level, p.tried.method());
                let kind = Type::new(TICK_SIZE, Anchor::Start).bold();
                c.group(&scatter::notes(), |c| {
                    room.write(c, &text, at(p), kind);
                });
            }
        });
    })?;
    Ok(Some(Chart {
        file: "choose.svg".into(),
        title: title.into(),
        caption: caption(choice),
        svg,
    }))
}

fn caption(choice: &ChoiceRecord) -> String {
    format!(
        "Each point is a model under an integrator at one step or tolerance, run on the window ({}). Large and strong: \
         adequate; small and pale: not adequate or not decided. The ring is the choice. Errors are distances to the yardstick over \
         the whole scene, without the yardstick's own error; costs are those of one run, scaled from the window, without \
         set-up.",
        choice.window
    )
}
