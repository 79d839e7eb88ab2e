//! The meshing teeth at peak force, with the contact forces drawn.

use crate::drawing::Chart;
use crate::drawing::axis::nice_step;
use crate::drawing::canvas::{Anchor, Canvas, DrawError, Ink, Stroke, Type, draw, text_width};
use crate::drawing::geometry::{Rect, clip_polygon};
use crate::drawing::panel::WIDTH;
use crate::drawing::style::look;
use crate::numbers::{quantity, short};
use crate::record::{ContactPoint, ContactSnapshot, Run};
use crate::view::View;

const GAP: f64 = 20.0;
const BODY: [Ink; 2] = [Ink(0xdf, 0xe7, 0xef, 1.0), Ink(0xf1, 0xea, 0xdf, 1.0)];

struct Picture<'a> {
    label: String,
    style: usize,
    run: &'a Run,
    snapshot: &'a ContactSnapshot,
}

/// Up to two models side by side, each at its own peak force.
pub fn mesh(view: &View<'_>) -> Result<Option<Chart>, DrawError> {
    let mut pictures: Vec<Picture<'_>> = Vec::new();
    for group in &view.groups {
        let has = |r: &Run| {
            r.contacts
                .as_ref()
                .is_some_and(|s| s.outlines.iter().any(|o| o.points.len() > 2))
        };
        let best = view.best(group).filter(|(_, r)| has(r));
        let any = || group.runs.iter().find(|(_, r)| has(r));
        let Some((_, run)) = best.or_else(any) else {
            continue;
        };
        if let Some(snapshot) = &run.contacts {
            pictures.push(Picture {
                label: group.label.clone(),
                style: group.style,
                run,
                snapshot,
            });
        }
    }
    // Two pictures at most, of different models before variants of one.
    pictures.sort_by_key(|p| {
        let first = view
            .groups
            .iter()
            .find(|g| g.runs.iter().any(|(_, r)| r.model == p.run.model));
        (first.map(|g| &g.label) != Some(&p.label), p.style)
    });
    pictures.truncate(2);
    if pictures.is_empty() {
        return Ok(None);
    }
    let n = pictures.len() as f64;
    let width = (WIDTH - GAP * (n - 1.0)) / n;
    let plot_height = if n > 1.0 { 400.0 } else { 430.0 };
    let title = "Meshing teeth at peak force";
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
        .map(|p| format!("{} at {}", p.label, quantity(p.snapshot.time_s, "s", 4)))
        .collect();
    Ok(Some(Chart {
        file: "mesh.svg".into(),
        title,
        caption: format!(
            "Teeth at the instant of the highest contact force ({}). Arrows: force of each tooth \
             pair on gear 2, in proportion to its magnitude. Dash-dotted: line of action.",
            instants.join("; ")
        ),
        svg,
    }))
}

/// What part of the world a picture shows: centre and half width \[m\].
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

fn panel(c: &mut Canvas<'_>, p: &Picture<'_>, area: Rect) {
    let heading = format!("{} ({})", p.label, p.run.integrator);
    c.text(
        &heading,
        (area.x0, 14.0),
        Type::new(13.5, Anchor::Start).bold(),
    );
    c.fill(&area, Ink::WHITE);
    if let Some((centre, half)) = focus(p.snapshot) {
        let scale = 0.5 * area.width().min(area.height()) / half;
        let middle = (0.5 * (area.x0 + area.x1), 0.5 * (area.y0 + area.y1));
        let at = |q: [f64; 2]| {
            (
                middle.0 + (q[0] - centre.0) * scale,
                middle.1 - (q[1] - centre.1) * scale,
            )
        };
        for (i, outline) in p.snapshot.outlines.iter().enumerate() {
            let mut points: Vec<(f64, f64)> = outline.points.iter().map(|q| at(*q)).collect();
            c.polygon(&clip_polygon(&points, &area), BODY[i % 2]);
            if let Some(&first) = points.first() {
                points.push(first);
            }
            c.line_within(&points, &area, Stroke::new(Ink(0x4a, 0x55, 0x60, 1.0), 1.4));
        }
        if let Some([a, b]) = p.snapshot.line_of_action {
            let stroke = Stroke::dashed(Ink::GREY, 1.1, &[12.0, 3.0, 2.0, 3.0]);
            c.line_within(&[at(a), at(b)], &area, stroke);
        }
        names(c, p.snapshot, &at, &area);
        arrows(c, p, &at, &area);
        scale_bar(c, scale, &area);
    }
    c.frame(&area, Stroke::new(Ink::PALE, 1.0));
}

/// Gear names, where each gear's part of the picture lies.
fn names(
    c: &mut Canvas<'_>,
    s: &ContactSnapshot,
    at: &dyn Fn([f64; 2]) -> (f64, f64),
    area: &Rect,
) {
    let middle = 0.5 * (area.x0 + area.x1);
    let mut taken = [false, false];
    for outline in &s.outlines {
        let n = outline.points.len().max(1) as f64;
        let x = outline.points.iter().map(|q| at(*q).0).sum::<f64>() / n;
        let right = usize::from(x > middle);
        if std::mem::replace(&mut taken[right], true) {
            continue;
        }
        let (x, anchor) = if right == 1 {
            (area.x1 - 10.0, Anchor::End)
        } else {
            (area.x0 + 10.0, Anchor::Start)
        };
        c.text(
            &outline.gear,
            (x, area.y0 + 16.0),
            Type::new(13.0, anchor).ink(Ink::GREY),
        );
    }
}

/// Forces of one tooth pair as one, where they act on the whole: many points of a flank would hide each other.
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
            }
            Some(_) => {}
            None => pairs.push((contact.clone(), weight)),
        }
    }
    pairs.into_iter().map(|(pair, _)| pair).collect()
}

fn arrows(c: &mut Canvas<'_>, p: &Picture<'_>, at: &dyn Fn([f64; 2]) -> (f64, f64), area: &Rect) {
    let magnitude = |f: [f64; 2]| f[0].hypot(f[1]);
    let pairs = by_pair(&p.snapshot.contacts);
    let greatest = (pairs.iter())
        .map(|k| magnitude(k.force))
        .filter(|f| f.is_finite())
        .fold(0.0, f64::max);
    if greatest <= 0.0 {
        return;
    }
    let ink = look(p.style).ink;
    let reach = 0.3 * area.width().min(area.height());
    let mut labels: Vec<Rect> = Vec::new();
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
        c.circle((x, y), 3.4, Ink::WHITE, None);
        c.circle((x, y), 3.4, ink, Some(2.0));
        let text = if contact.pair.is_empty() {
            quantity(force, "N", 3)
        } else {
            format!("{}  (pair {})", quantity(force, "N", 3), contact.pair)
        };
        let width = text_width(&text, 13.0);
        let side = if ux >= 0.0 { 1.0 } else { -1.0 };
        let mut at = (tip.0 + 8.0 * side, tip.1 - 6.0);
        let mut back = place(at, width, side, area);
        while labels.iter().any(|l| l.overlaps(&back)) && back.y1 + 20.0 < area.y1 {
            at.1 += 20.0;
            back = place(at, width, side, area);
        }
        c.fill(&back, Ink::WHITE.opacity(0.88));
        let text_at = (back.x0 + 5.0, 0.5 * (back.y0 + back.y1));
        c.text(&text, text_at, Type::new(13.0, Anchor::Start).bold());
        labels.push(back);
    }
}

fn place(at: (f64, f64), width: f64, side: f64, area: &Rect) -> Rect {
    let left = if side > 0.0 {
        at.0
    } else {
        at.0 - width - 10.0
    };
    let left = left.min(area.x1 - width - 14.0).max(area.x0 + 4.0);
    let top = (at.1 - 10.0).max(area.y0 + 26.0).min(area.y1 - 24.0);
    Rect::new(left, top, left + width + 10.0, top + 20.0)
}

fn scale_bar(c: &mut Canvas<'_>, scale: f64, area: &Rect) {
    let length = nice_step(55.0 / scale);
    let width = length * scale;
    let (x, y) = (area.x0 + 16.0, area.y1 - 16.0);
    let text = format!("{} mm", short(length * 1e3, 3));
    let total = width + 14.0 + text_width(&text, 12.5);
    c.fill(
        &Rect::new(x - 8.0, y - 11.0, x + total, y + 11.0),
        Ink::WHITE.opacity(0.88),
    );
    c.line(&[(x, y), (x + width, y)], Stroke::new(Ink::DARK, 2.2));
    for end in [x, x + width] {
        c.line(
            &[(end, y - 5.0), (end, y + 5.0)],
            Stroke::new(Ink::DARK, 1.4),
        );
    }
    c.text(&text, (x + width + 8.0, y), Type::new(12.5, Anchor::Start));
}
