//! Picture of deformed teeth at peak force: sections of flanks with magnified displacements.

use crate::drawing::Chart;
use crate::drawing::axis::nice_step;
use crate::drawing::canvas::{Anchor, Canvas, DrawError, Ink, Stroke, Type, draw, text_width};
use crate::drawing::geometry::Rect;
use crate::drawing::panel::WIDTH;
use crate::drawing::style::{curve_style, marker};
use crate::numbers::{quantity, short};
use crate::record::{ContactSnapshot, DeformedSection, Run};
use crate::view::View;

const HEIGHT: f64 = 430.0;
/// Drawn length of the largest displacement over the half width of the picture.
const SHOWN: f64 = 0.09;

/// Returns a round number not above `x`.
fn round_below(x: f64) -> f64 {
    let power = 10f64.powf(x.log10().floor());
    let lead = [5.0, 2.0, 1.0].into_iter().find(|m| m * power <= x);
    lead.unwrap_or(1.0) * power
}

fn largest(sections: &[DeformedSection]) -> f64 {
    let all = sections.iter().flat_map(|s| &s.displacements);
    all.map(|d| d[0].hypot(d[1])).fold(0.0, f64::max)
}

/// Returns the model with most nodes on its deformed flanks.
pub fn deformed(view: &View<'_>) -> Result<Option<Chart>, DrawError> {
    let mut best: Option<(&str, usize, &Run, &ContactSnapshot)> = None;
    let nodes = |s: &ContactSnapshot| s.deformed.iter().map(|d| d.points.len()).sum::<usize>();
    for group in &view.groups {
        for (_, run) in &group.runs {
            let Some(snapshot) = &run.contacts else {
                continue;
            };
            let more = best.is_none_or(|(_, _, _, other)| nodes(snapshot) > nodes(other));
            if nodes(snapshot) > 0 && largest(&snapshot.deformed) > 0.0 && more {
                best = Some((&group.label, group.style, run, snapshot));
            }
        }
    }
    let Some((label, style, run, snapshot)) = best else {
        return Ok(None);
    };
    let points = snapshot.deformed.iter().flat_map(|s| &s.points);
    let contacts = &snapshot.contacts;
    let n = contacts.len().max(1) as f64;
    let centre = [0, 1].map(|k| contacts.iter().map(|c| c.point[k]).sum::<f64>() / n);
    let half = points
        .map(|p| (p[0] - centre[0]).abs().max((p[1] - centre[1]).abs()))
        .fold(0.0, f64::max);
    if !(half.is_finite() && half > 0.0) {
        return Ok(None);
    }
    let half = 1.02 * half;
    let most = largest(&snapshot.deformed);
    let times = round_below(SHOWN * half / most).max(1.0);
    let title = "Deformed teeth at peak force";
    let svg = draw(WIDTH, HEIGHT + 30.0, title, |c| {
        let area = Rect::new(1.0, 29.0, WIDTH - 1.0, 29.0 + HEIGHT);
        marker(c, (9.0, 14.0), 5.2, curve_style(style), true);
        let bold = Type::new(13.5, Anchor::Start).bold();
        let heading = format!(
            "{label} ({}), displacements {} times as large",
            run.integrator,
            short(times, 3)
        );
        c.text(&heading, (21.0, 14.0), bold);
        c.fill(&area, Ink::WHITE);
        let scale = 0.5 * area.height() / half;
        let middle = (0.5 * (area.x0 + area.x1), 0.5 * (area.y0 + area.y1));
        let at = |x: f64, y: f64| {
            (
                middle.0 + (x - centre[0]) * scale,
                middle.1 - (y - centre[1]) * scale,
            )
        };
        for tooth in teeth(&snapshot.deformed) {
            let (still, moved) = outline(&tooth, times);
            let still: Vec<_> = still.iter().map(|p| at(p[0], p[1])).collect();
            let moved: Vec<_> = moved.iter().map(|p| at(p[0], p[1])).collect();
            c.line_within(&still, &area, Stroke::dashed(Ink::GREY, 1.0, &[4.0, 3.0]));
            c.line_within(&moved, &area, Stroke::new(curve_style(style).ink, 1.8));
            for p in &moved {
                if area.holds(*p) {
                    c.circle(*p, 1.6, curve_style(style).ink, None);
                }
            }
        }
        for contact in contacts {
            let p = at(contact.point[0], contact.point[1]);
            if area.holds(p) {
                c.circle(p, 2.4, Ink::DARK, Some(1.0));
            }
        }
        bars(c, &area, scale, times, most);
        c.frame(&area, Stroke::new(Ink::PALE, 1.0));
    })?;
    Ok(Some(Chart {
        file: "deformed.svg".into(),
        title: title.into(),
        caption: format!(
            "Sections of the flanks in contact and of their neighbours at the height of the largest load, at {}. Dashed: where \
             the rigid motion takes the nodes; full: with displacements {} times as large, up to {}. Rings: contacts.",
            quantity(snapshot.time_s, "s", 3),
            short(times, 3),
            quantity(most, "m", 3)
        ),
        svg,
    }))
}

/// Returns the sections of a gear grouped by tooth.
fn teeth(sections: &[DeformedSection]) -> Vec<Vec<&DeformedSection>> {
    let mut teeth: Vec<Vec<&DeformedSection>> = Vec::new();
    for s in sections {
        let same = |of: &&mut Vec<&DeformedSection>| of[0].gear == s.gear && of[0].tooth == s.tooth;
        match teeth.iter_mut().find(same) {
            Some(tooth) => tooth.push(s),
            None => teeth.push(vec![s]),
        }
    }
    teeth
}

/// Returns the outline of a tooth from one root over the tip to the other root, undeformed and deformed.
fn outline(sections: &[&DeformedSection], times: f64) -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
    let (mut still, mut moved) = (Vec::new(), Vec::new());
    for (i, s) in sections.iter().enumerate() {
        let mut of: Vec<([f64; 2], [f64; 2])> = (s.points.iter().zip(&s.displacements))
            .map(|(p, d)| (*p, [p[0] + times * d[0], p[1] + times * d[1]]))
            .collect();
        if i % 2 == 1 {
            of.reverse();
        }
        still.extend(of.iter().map(|p| p.0));
        moved.extend(of.iter().map(|p| p.1));
    }
    (still, moved)
}

/// Paints the scale bars of lengths and of displacements.
fn bars(c: &mut Canvas, area: &Rect, scale: f64, times: f64, most: f64) {
    let rows = [
        (nice_step(55.0 / scale), scale, "length"),
        (nice_step(most), scale * times, "displacement"),
    ];
    for (i, (length, scale, name)) in rows.into_iter().enumerate() {
        let y = area.y1 - 18.0 - 22.0 * i as f64;
        let (x, width) = (area.x0 + 16.0, length * scale);
        let text = format!("{} {name}", quantity(length, "m", 2));
        let plate = Rect::new(
            x - 8.0,
            y - 11.0,
            x + width + 16.0 + text_width(&text, 12.5),
            y + 11.0,
        );
        c.fill(&plate, Ink::WHITE.opacity(0.88));
        c.line(&[(x, y), (x + width, y)], Stroke::new(Ink::DARK, 2.2));
        for end in [x, x + width] {
            c.line(
                &[(end, y - 5.0), (end, y + 5.0)],
                Stroke::new(Ink::DARK, 1.4),
            );
        }
        c.text(&text, (x + width + 8.0, y), Type::new(12.5, Anchor::Start));
    }
}
