//! Charts of loads on flanks: maps at the peak and over the run, load over the width.
//!
//! A flank is drawn with the face width across and the length of roll upwards, from the form circle to the tip.

mod over_width;

use crate::drawing::Chart;
use crate::drawing::axis::{Axis, Frame, NAME_SIZE, TICK_SIZE, tick_label};
use crate::drawing::canvas::{Anchor, Canvas, DrawError, Ink, Stroke, Type, draw};
use crate::drawing::geometry::Rect;
use crate::drawing::heat::colour;
use crate::drawing::panel::WIDTH;
use crate::drawing::style::{curve_style, marker};
use crate::numbers::{Prefix, counted, quantity};
use crate::record::{FlankLoad, FlankPatch, FlankValue, Run};
use crate::view::View;

/// Height of a map, of the line above it and of the axis below.
const MAP: f64 = 150.0;
const ABOVE: f64 = 40.0;
const BELOW: f64 = 46.0;
/// Space of the ordinate at the left and of the colour bar at the right.
const LEFT: f64 = 62.0;
const BAR: f64 = 92.0;
/// Gap between the maps on the page.
const GAP: f64 = 14.0;
/// Largest number of teeth per model in a map.
const MOST_TEETH: usize = 4;
/// Height of a line of contact on a map.
const LINE: f64 = 5.0;

/// Flank loads of a model at its peak force.
struct PeakLoads<'a> {
    label: &'a str,
    style: usize,
    run: &'a Run,
    load: &'a FlankLoad,
    time: f64,
}

/// Returns the first model and the one with most contacts, each with its most loaded flanks.
fn chosen<'a>(view: &'a View<'a>) -> Vec<PeakLoads<'a>> {
    let mut all: Vec<PeakLoads<'a>> = Vec::new();
    for group in &view.groups {
        let of = |run: &'a Run| -> Option<(&'a FlankLoad, f64)> {
            let snapshot = run.contacts.as_ref()?;
            let force = |l: &FlankLoad| l.patches.iter().map(|p| p.force_n).sum::<f64>();
            let most = snapshot.flanks.iter().filter(|l| !l.patches.is_empty());
            let most = most.max_by(|a, b| force(a).total_cmp(&force(b)))?;
            Some((most, snapshot.time_s))
        };
        let best = view.best(group).filter(|(_, r)| of(r).is_some());
        let any = || group.runs.iter().find(|(_, r)| of(r).is_some());
        if let Some((_, run)) = best.or_else(any)
            && let Some((load, time)) = of(run)
        {
            all.push(PeakLoads {
                label: &group.label,
                style: group.style,
                run,
                load,
                time,
            });
        }
    }
    if all.len() > 2 {
        let most = (1..all.len())
            .rev()
            .max_by_key(|&i| all[i].load.patches.len());
        all.swap(1, most.unwrap_or(1));
        all.truncate(2);
    }
    all
}

/// Returns the teeth in contact with the largest loads, in the order of their numbers.
fn teeth(load: &FlankLoad) -> Vec<i64> {
    let mut forces: Vec<(i64, f64)> = Vec::new();
    for p in &load.patches {
        match forces.iter_mut().find(|(tooth, _)| *tooth == p.tooth) {
            Some((_, force)) => *force += p.force_n,
            None => forces.push((p.tooth, p.force_n)),
        }
    }
    forces.sort_by(|a, b| b.1.total_cmp(&a.1));
    forces.truncate(MOST_TEETH);
    let mut teeth: Vec<i64> = forces.into_iter().map(|f| f.0).collect();
    teeth.sort_unstable();
    teeth
}

fn unit(value: FlankValue) -> (&'static str, &'static str) {
    match value {
        FlankValue::Pressure => ("pressure", "Pa"),
        FlankValue::LineLoad => ("force per width", "N/m"),
    }
}

/// Returns the axes of a flank, in millimetres.
fn axes(load: &FlankLoad) -> [Axis; 2] {
    let mm = |ends: [f64; 2]| Axis::linear(1e3 * ends[0], 1e3 * ends[1]);
    [mm(load.width_m), mm(load.roll_m)]
}

/// Paints the map of a flank: background, axes, the content that `paint` draws, edge.
fn map(
    c: &mut Canvas,
    (load, area, first): (&FlankLoad, Rect, bool),
    name: &str,
    paint: impl FnOnce(&mut Canvas, &Frame),
) {
    let [x, y] = axes(load);
    let frame = Frame { area, x, y };
    c.fill(&area, Ink::WHITE);
    let most = (area.width() / 60.0).max(2.0) as usize;
    frame.paint_x(c, "place over the width [mm]", most);
    let ticks = frame.y.ticks(5);
    for &t in &ticks {
        let (_, y) = frame.at(frame.x.min, t);
        c.line(&[(area.x0, y), (area.x1, y)], Stroke::new(Ink::GRID, 0.8));
        if first {
            let kind = Type::new(TICK_SIZE, Anchor::End).ink(Ink::GREY);
            c.text(&tick_label(t, &ticks, false), (area.x0 - 7.0, y), kind);
        }
    }
    if first {
        let at = (area.x0 - 48.0, 0.5 * (area.y0 + area.y1));
        let kind = Type::new(NAME_SIZE, Anchor::Middle).upwards();
        c.text("length of roll [mm]", at, kind);
    }
    paint(c, &frame);
    c.frame(&area, Stroke::new(Ink::PALE, 1.0));
    c.text(
        name,
        (area.x0, area.y0 - 10.0),
        Type::new(12.5, Anchor::Start),
    );
}

/// Paints the colour bar next to the maps of a model.
fn bar(c: &mut Canvas, (y0, y1): (f64, f64), value: FlankValue, greatest: f64) {
    const PARTS: usize = 48;
    let x = WIDTH - BAR + 8.0;
    let prefix = Prefix::of(greatest, 1.0);
    let (_, of) = unit(value);
    let axis = Axis::linear(0.0, greatest * prefix.factor);
    let height = (y1 - y0) / PARTS as f64;
    for i in 0..PARTS {
        let low = y1 - (i as f64) * height;
        let part = (i as f64 + 0.5) / PARTS as f64;
        c.fill(
            &Rect::new(x, low - height - 0.1, x + 12.0, low),
            colour(part),
        );
    }
    let ticks = axis.ticks(5);
    for &t in &ticks {
        let y = y1 - axis.place(t) * (y1 - y0);
        c.line(&[(x + 12.0, y), (x + 16.0, y)], Stroke::new(Ink::GREY, 1.0));
        let kind = Type::new(TICK_SIZE, Anchor::Start).ink(Ink::GREY);
        c.text(&tick_label(t, &ticks, false), (x + 19.0, y), kind);
    }
    c.text(
        &format!("[{}{of}]", prefix.symbol),
        (x, y0 - 10.0),
        Type::new(12.5, Anchor::Start),
    );
}

/// Paints a patch of contact; a contact line has a visible least height.
fn patch(c: &mut Canvas, frame: &Frame, p: &FlankPatch, greatest: f64) {
    let half = p.size_m.map(|s| 0.5e3 * s);
    let (x, y) = (1e3 * p.height_m, 1e3 * p.roll_m);
    let (x0, y0) = frame.at(x - half[1], y + half[0]);
    let (x1, y1) = frame.at(x + half[1], y - half[0]);
    let more = (0.5 * (LINE - (y1 - y0))).max(0.0);
    let r = &frame.area;
    let seen = Rect::new(
        x0.max(r.x0),
        (y0 - more).max(r.y0),
        x1.min(r.x1),
        (y1 + more).min(r.y1),
    );
    if seen.x1 > seen.x0 && seen.y1 > seen.y0 {
        c.fill(&seen, colour(p.value / greatest));
    }
}

fn heading(c: &mut Canvas, b: &PeakLoads<'_>, y: f64, tail: &str) {
    marker(c, (9.0, y), 5.2, curve_style(b.style), true);
    let text = format!("{} ({}){tail}", b.label, b.run.integrator);
    c.text(&text, (21.0, y), Type::new(13.5, Anchor::Start).bold());
}

/// Draws the flanks at the peak, one map for each tooth in contact.
fn at_peak(all: &[PeakLoads<'_>]) -> Result<Chart, DrawError> {
    let row = ABOVE + MAP + BELOW;
    let title = "Load on the flanks at peak force";
    let svg = draw(WIDTH, row * all.len() as f64, title, |c| {
        for (i, b) in all.iter().enumerate() {
            let top = i as f64 * row + ABOVE;
            let tail = format!(", {} flanks of {}", b.load.side, b.load.gear);
            heading(c, b, top - 28.0, &tail);
            let teeth = teeth(b.load);
            let n = teeth.len() as f64;
            let width = (WIDTH - LEFT - BAR - GAP * (n - 1.0)) / n;
            let greatest = b.load.patches.iter().map(|p| p.value).fold(0.0, f64::max);
            for (k, tooth) in teeth.iter().enumerate() {
                let x = LEFT + k as f64 * (width + GAP);
                let of = b.load.patches.iter().filter(|p| p.tooth == *tooth);
                let force: f64 = of.clone().map(|p| p.force_n).sum();
                let name = format!("tooth {tooth}, {}", quantity(force, "N", 3));
                let area = Rect::new(x, top, x + width, top + MAP);
                map(c, (b.load, area, k == 0), &name, |c, frame| {
                    of.for_each(|p| patch(c, frame, p, greatest));
                });
            }
            bar(c, (top, top + MAP), b.load.value, greatest);
        }
    })?;
    let told: Vec<String> = all
        .iter()
        .map(|b| {
            let (what, of) = unit(b.load.value);
            let greatest = b.load.patches.iter().map(|p| p.value).fold(0.0, f64::max);
            format!(
                "{}: {what} up to {} at {}",
                b.label,
                quantity(greatest, of, 3),
                quantity(b.time, "s", 3)
            )
        })
        .collect();
    Ok(Chart {
        file: "flanks.svg".into(),
        title: title.into(),
        caption: format!(
            "Where flanks touch at the instant of the highest contact force, and what they bear there ({}). Each model has its \
             own scale of colours. The length of roll grows from the form circle to the tip.",
            told.join("; ")
        ),
        svg,
    })
}

/// Draws the greatest load at each place of a flank over the run.
fn over_run(all: &[PeakLoads<'_>]) -> Result<Option<Chart>, DrawError> {
    let shown: Vec<_> = (all.iter())
        .filter_map(|b| Some((b, b.load.over_run.as_ref().filter(|g| g.instants > 1)?)))
        .collect();
    if shown.is_empty() {
        return Ok(None);
    }
    let row = ABOVE + MAP + BELOW;
    let title = "Greatest load on the flanks over the run";
    let svg = draw(WIDTH, row * shown.len() as f64, title, |c| {
        for (i, (b, grid)) in shown.iter().enumerate() {
            let top = i as f64 * row + ABOVE;
            let tail = format!(", {} flanks of {}", b.load.side, b.load.gear);
            heading(c, b, top - 28.0, &tail);
            let greatest = grid.values.iter().copied().fold(0.0, f64::max);
            let area = Rect::new(LEFT, top, WIDTH - BAR, top + MAP);
            let name = format!(
                "all teeth, {}",
                counted(grid.instants, "instant", "instants")
            );
            map(c, (b.load, area, true), &name, |c, frame| {
                let r = &frame.area;
                let (w, h) = (
                    r.width() / grid.columns as f64,
                    r.height() / grid.rows as f64,
                );
                for (k, value) in grid.values.iter().enumerate().filter(|(_, v)| **v > 0.0) {
                    let (i, j) = ((k / grid.columns) as f64, (k % grid.columns) as f64);
                    let (x, y) = (r.x0 + j * w, r.y1 - (i + 1.0) * h);
                    // A hair over the neighbours, that no ground shines through between them.
                    let cell = Rect::new(x, y - 0.1, (x + w + 0.1).min(r.x1), y + h);
                    c.fill(&cell, colour(value / greatest));
                }
            });
            bar(c, (top, top + MAP), b.load.value, greatest);
        }
    })?;
    Ok(Some(Chart {
        file: "flanks_over_run.svg".into(),
        title: title.into(),
        caption: "The greatest load at each place of the flanks among instants of the run at equal distances, all teeth laid on \
                  each other: the contact pattern of the meshing cycles run through. Blank where no instant touched."
            .into(),
        svg,
    }))
}

/// Draws maps at the peak and over the run, and the load over the width; empty if no run has flank loads.
pub fn flanks(view: &View<'_>) -> Result<Vec<Chart>, DrawError> {
    let all = chosen(view);
    if all.is_empty() {
        return Ok(Vec::new());
    }
    let charts = [
        Some(at_peak(&all)?),
        over_run(&all)?,
        over_width::over_width(&all)?,
    ];
    Ok(charts.into_iter().flatten().collect())
}
