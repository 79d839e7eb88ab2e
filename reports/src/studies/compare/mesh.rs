//! Picture of the meshing teeth at peak force, with the contact forces.

use super::motion::still;
use crate::drawing::Chart;
use crate::drawing::axis::nice_step;
use crate::drawing::canvas::{Anchor, Canvas, DrawError, Ink, Stroke, Type, draw, text_width};
use crate::drawing::geometry::{Rect, clip_polygon};
use crate::drawing::labels::OccupiedArea;
use crate::drawing::panel::WIDTH;
use crate::drawing::style::{curve_style, marker};
use crate::markup::gears::Viewer;
use crate::numbers::{counted, quantity, short};
use crate::record::{ContactPoint, ContactSnapshot, GearMotion, Run};
use crate::studies::solid;
use crate::view::View;

const GAP: f64 = 20.0;
/// File of the picture, which the page shows where gears do not move.
pub(super) const FILE: &str = "mesh.svg";

struct Picture<'a> {
    label: String,
    style: usize,
    run: &'a Run,
    snapshot: ContactSnapshot,
}

/// Draws up to two models next to each other, each at its own peak force.
pub fn mesh(view: &View<'_>) -> Result<Option<Chart>, DrawError> {
    let mut pictures: Vec<Picture<'_>> = Vec::new();
    for group in &view.groups {
        let has = |r: &Run| {
            let outlined = |s: &ContactSnapshot| s.outlines.iter().any(|o| o.points.len() > 2);
            r.motion
                .as_ref()
                .is_some_and(|m| !m.bodies.is_empty() && !m.time_s.is_empty())
                || r.contacts.as_ref().is_some_and(outlined)
        };
        let best = view.best(group).filter(|(_, r)| has(r));
        let any = || group.runs.iter().find(|(_, r)| has(r));
        let Some((_, run)) = best.or_else(any) else {
            continue;
        };
        if let Some(snapshot) = still(run) {
            pictures.push(Picture {
                label: group.label.clone(),
                style: group.style,
                run,
                snapshot,
            });
        }
    }
    // Two pictures at most: the first model, and beside it the one that touches with most points, which is elastic where
    // there is one.
    if pictures.len() > 2 {
        let points = |p: &Picture<'_>| p.snapshot.contacts.len();
        let most = (1..pictures.len())
            .rev()
            .max_by_key(|&i| points(&pictures[i]));
        pictures.swap(1, most.unwrap_or(1));
        pictures.truncate(2);
    }
    if pictures.is_empty() {
        return Ok(None);
    }
    let n = pictures.len() as f64;
    let width = (WIDTH - GAP * (n - 1.0)) / n;
    let plot_height = if n > 1.0 { 400.0 } else { 430.0 };
    let title = "Meshing teeth at peak force";
    if let Some(motion) = pictures[0].run.motion.as_ref().filter(|m| m.is_spatial()) {
        return in_space(&pictures[0], motion, title).map(Some);
    }
    let svg = draw(WIDTH, plot_height + 30.0, title, |c| {
        for (i, p) in pictures.iter().enumerate() {
            let x = i as f64 * (width + GAP);
            panel(
                c,
                p,
                Rect::new(x + 1.0, 29.0, x + width - 1.0, 29.0 + plot_height),
            );
        }
    })?;
    let instants: Vec<String> = pictures
        .iter()
        .map(|p| {
            let points = counted(p.snapshot.contacts.len(), "point", "points");
            format!(
                "{} at {}, {points} of contact",
                p.label,
                quantity(p.snapshot.time_s, "s", 3)
            )
        })
        .collect();
    Ok(Some(Chart {
        file: FILE.into(),
        title: title.into(),
        caption: format!(
            "Teeth at the instant of the highest contact force ({}). Arrows: force of each tooth pair on the second gear of \
             its mesh, summed over its points of contact, in proportion to its magnitude. Dash-dotted: line of action.",
            instants.join("; ")
        ),
        svg,
    }))
}

/// Returns a chart, that of the still picture with the description of the moving gears.
pub(super) fn captioned(mut chart: Chart, moving: Option<&(Viewer, Vec<String>)>) -> Chart {
    if chart.file != FILE {
        return chart;
    }
    let Some((viewer, left_out)) = moving else {
        chart.caption += " The gears of this page do not move: the record has no motion of them, as records of versions \
                          before the moving gears.";
        return chart;
    };
    chart.title = "Meshing teeth".into();
    chart.caption = format!(
        "Moving gears of {}, all at the same time; on paper and without scripts a still picture. Arrows: force of each tooth \
         pair on the second gear of its mesh. Colours: contact pressure, or force per width. Tooth displacements are \
         magnified by the factor that the list shows; in a section, teeth without displacement are dashed. Between frames, \
         positions are interpolated. Still picture: {}{}",
        counted(viewer.models, "model", "models"),
        chart.caption,
        match left_out.as_slice() {
            [] => String::new(),
            labels => format!(
                " Models that do not fit into the page: {}.",
                labels.join("; ")
            ),
        }
    );
    chart
}

/// Draws the gears of a model in space.
fn in_space(p: &Picture<'_>, motion: &GearMotion, title: &str) -> Result<Chart, DrawError> {
    const HEIGHT: f64 = 520.0;
    let frame = motion.nearest(p.snapshot.time_s).unwrap_or(0);
    let svg = draw(WIDTH, HEIGHT + 30.0, title, |c| {
        let area = Rect::new(1.0, 29.0, WIDTH - 1.0, 29.0 + HEIGHT);
        marker(c, (9.0, 14.0), 5.2, curve_style(p.style), true);
        let heading = format!("{} ({})", p.label, p.run.integrator);
        c.text(
            &heading,
            (21.0, 14.0),
            Type::new(13.5, Anchor::Start).bold(),
        );
        c.fill(&area, Ink::WHITE);
        solid::paint(c, motion, (frame, 1.0, curve_style(p.style).ink), &area);
        c.frame(&area, Stroke::new(Ink::PALE, 1.0));
    })?;
    Ok(Chart {
        file: FILE.into(),
        title: title.into(),
        caption: format!(
            "Gears of {} in space at {}, the instant of the highest contact force. Lines on the teeth: contacts, coloured by \
             their load from dark to light. Arrows: force of each tooth pair on the second gear of its mesh.",
            p.label,
            quantity(p.snapshot.time_s, "s", 3)
        ),
        svg,
    })
}

/// Returns the section of the plane that the picture shows: centre and half width \[m\].
fn focus(s: &ContactSnapshot) -> Option<((f64, f64), f64)> {
    let finite = |p: &&[f64; 2]| p[0].is_finite() && p[1].is_finite();
    let contacts: Vec<[f64; 2]> = (s.contacts.iter().map(|c| &c.point))
        .filter(finite)
        .copied()
        .collect();
    let mean = |points: &[[f64; 2]]| {
        let n = points.len() as f64;
        let sum = points
            .iter()
            .fold((0.0, 0.0), |a, p| (a.0 + p[0], a.1 + p[1]));
        (sum.0 / n, sum.1 / n)
    };
    let line = s.line_of_action.filter(|l| l.iter().all(|p| finite(&p)));
    let outline: Vec<[f64; 2]> = (s.outlines.iter().flat_map(|o| &o.points))
        .filter(finite)
        .copied()
        .collect();
    let centre = if !contacts.is_empty() {
        mean(&contacts)
    } else if let Some(l) = line {
        mean(&l)
    } else if !outline.is_empty() {
        mean(&outline)
    } else {
        return None;
    };
    let extent = |points: &[[f64; 2]], k: usize| {
        let low = points.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|p| p[k]).fold(f64::MIN, f64::max);
        (high - low).max(0.0)
    };
    let half = match line {
        Some([a, b]) => 0.55 * (b[0] - a[0]).hypot(b[1] - a[1]),
        None => 0.12 * extent(&outline, 0).max(extent(&outline, 1)),
    };
    let half = half.max(0.75 * extent(&contacts, 0).max(extent(&contacts, 1)));
    (half > 0.0).then_some((centre, half))
}

fn panel(c: &mut Canvas, p: &Picture<'_>, area: Rect) {
    let heading = format!("{} ({})", p.label, p.run.integrator);
    marker(c, (area.x0 + 8.0, 14.0), 5.2, curve_style(p.style), true);
    let bold = Type::new(13.5, Anchor::Start).bold();
    c.text(&heading, (area.x0 + 20.0, 14.0), bold);
    c.fill(&area, Ink::WHITE);
    if let Some((centre, half)) = focus(&p.snapshot) {
        let scale = 0.5 * area.width().min(area.height()) / half;
        let middle = (0.5 * (area.x0 + area.x1), 0.5 * (area.y0 + area.y1));
        let at = |q: [f64; 2]| {
            (
                middle.0 + (q[0] - centre.0) * scale,
                middle.1 - (q[1] - centre.1) * scale,
            )
        };
        let mut room = OccupiedArea::of(area);
        let mut bodies = Vec::new();
        for (i, outline) in p.snapshot.outlines.iter().enumerate() {
            let mut points: Vec<(f64, f64)> = outline.points.iter().map(|q| at(*q)).collect();
            let body = clip_polygon(&points, &area);
            c.polygon(&body, Ink::BODIES[i % 2]);
            points.extend(points.first().copied());
            c.line_within(&points, &area, Stroke::new(Ink::BODY_EDGE, 1.4));
            room.occupy_line(&points);
            bodies.push((outline.gear.as_str(), body));
        }
        if let Some([a, b]) = p.snapshot.line_of_action {
            let stroke = Stroke::dashed(Ink::GREY, 1.1, &[12.0, 3.0, 2.0, 3.0]);
            c.line_within(&[at(a), at(b)], &area, stroke);
            room.occupy_line(&[at(a), at(b)]);
        }
        scale_bar(c, scale, &area, &mut room);
        let labels = arrows(c, p, &at, &area, &mut room);
        for (text, at) in labels {
            room.write(c, &text, at, Type::new(13.0, Anchor::Start).bold());
        }
        for (name, body) in bodies {
            if let Some(at) = deepest(&body, &area) {
                let kind = Type::new(13.0, Anchor::Start).ink(Ink::GREY);
                room.write(c, name, at, kind);
            }
        }
    }
    c.frame(&area, Stroke::new(Ink::PALE, 1.0));
}

/// Returns the grid point deepest inside a body, where its name has space.
fn deepest(body: &[(f64, f64)], area: &Rect) -> Option<(f64, f64)> {
    const ACROSS: i32 = 24;
    let inside = |(x, y): (f64, f64)| {
        let edges = body.iter().zip(body.iter().cycle().skip(1));
        let crossed = edges.filter(|(a, b)| {
            (a.1 > y) != (b.1 > y) && x < a.0 + (y - a.1) / (b.1 - a.1) * (b.0 - a.0)
        });
        crossed.count() % 2 == 1
    };
    let depth = |(x, y): (f64, f64)| {
        let edge = (x - area.x0)
            .min(area.x1 - x)
            .min(y - area.y0)
            .min(area.y1 - y);
        let off = body.iter().map(|p| (p.0 - x).hypot(p.1 - y));
        off.fold(2.0 * edge, f64::min)
    };
    let part = |k: i32| (f64::from(k) + 0.5) / f64::from(ACROSS);
    (0..ACROSS * ACROSS)
        .map(|i| {
            let (u, v) = (part(i % ACROSS), part(i / ACROSS));
            (area.x0 + u * area.width(), area.y0 + v * area.height())
        })
        .filter(|p| inside(*p))
        .max_by(|a, b| depth(*a).total_cmp(&depth(*b)))
}

/// Sums the forces of each tooth pair at one point, since the many contact points of a flank would cover each other.
fn by_pair(contacts: &[ContactPoint]) -> Vec<ContactPoint> {
    let mut pairs: Vec<(ContactPoint, f64)> = Vec::new();
    for contact in contacts {
        let weight = contact.force[0].hypot(contact.force[1]);
        let known =
            (pairs.iter_mut()).find(|(pair, _)| !pair.pair.is_empty() && pair.pair == contact.pair);
        match known {
            Some((pair, total)) if weight.is_finite() => {
                *total += weight;
                let share = if *total > 0.0 { weight / *total } else { 0.0 };
                for k in 0..2 {
                    pair.force[k] += contact.force[k];
                    pair.point[k] += share * (contact.point[k] - pair.point[k]);
                }
                // The line with the largest load, of several over the width.
                if contact.pressure_pa > pair.pressure_pa {
                    (pair.pressure_pa, pair.half_width_m) =
                        (contact.pressure_pa, contact.half_width_m);
                }
            }
            Some(_) => {}
            None => pairs.push((contact.clone(), weight)),
        }
    }
    pairs.into_iter().map(|(pair, _)| pair).collect()
}

/// Draws the force of every pair as an arrow and returns the texts, each with the point of its arrow.
fn arrows(
    c: &mut Canvas,
    p: &Picture<'_>,
    at: &dyn Fn([f64; 2]) -> (f64, f64),
    area: &Rect,
    room: &mut OccupiedArea,
) -> Vec<(String, (f64, f64))> {
    let magnitude = |f: [f64; 2]| f[0].hypot(f[1]);
    let pairs = by_pair(&p.snapshot.contacts);
    let greatest = (pairs.iter())
        .map(|k| magnitude(k.force))
        .filter(|f| f.is_finite())
        .fold(0.0, f64::max);
    let mut labels = Vec::new();
    if greatest <= 0.0 {
        return labels;
    }
    let ink = curve_style(p.style).ink;
    let reach = 0.3 * area.width().min(area.height());
    for contact in &pairs {
        let force = magnitude(contact.force);
        let (x, y) = at(contact.point);
        if !(force.is_finite() && force > 0.0 && x.is_finite() && y.is_finite()) {
            continue;
        }
        let (ux, uy) = (contact.force[0] / force, -contact.force[1] / force);
        let length = (reach * force / greatest).max(14.0);
        let tip = (x + ux * length, y + uy * length);
        let neck = (tip.0 - 11.0 * ux, tip.1 - 11.0 * uy);
        c.line(&[(x, y), neck], Stroke::new(Ink::WHITE, 6.0));
        c.line(&[(x, y), neck], Stroke::new(ink, 3.0));
        let barb = 5.5;
        let (left, right) = (
            (neck.0 - barb * uy, neck.1 + barb * ux),
            (neck.0 + barb * uy, neck.1 - barb * ux),
        );
        c.polygon(&[tip, left, right], ink);
        marker(c, (x, y), 4.6, curve_style(p.style), false);
        room.occupy_line(&[(x, y), tip]);
        for part in [0.0, 0.25, 0.5, 0.75, 1.0] {
            room.occupy_point((x + part * length * ux, y + part * length * uy), 6.0);
        }
        let mut text = quantity(force, "N", 3);
        if !contact.pair.is_empty() {
            text = format!("{text} (pair {})", contact.pair);
        }
        if let Some(pressure) = contact.pressure_pa {
            text = format!("{text}, {}", quantity(pressure, "Pa", 3));
        }
        labels.push((text, tip));
    }
    labels
}

fn scale_bar(c: &mut Canvas, scale: f64, area: &Rect, room: &mut OccupiedArea) {
    let length = nice_step(55.0 / scale);
    let width = length * scale;
    let (x, y) = (area.x0 + 16.0, area.y1 - 16.0);
    let text = format!("{} mm", short(length * 1e3, 3));
    let total = width + 14.0 + text_width(&text, 12.5);
    let plate = Rect::new(x - 8.0, y - 11.0, x + total, y + 11.0);
    c.fill(&plate, Ink::WHITE.opacity(0.88));
    room.occupy(plate);
    c.line(&[(x, y), (x + width, y)], Stroke::new(Ink::DARK, 2.2));
    for end in [x, x + width] {
        let tick = [(end, y - 5.0), (end, y + 5.0)];
        c.line(&tick, Stroke::new(Ink::DARK, 1.4));
    }
    c.text(&text, (x + width + 8.0, y), Type::new(12.5, Anchor::Start));
}
