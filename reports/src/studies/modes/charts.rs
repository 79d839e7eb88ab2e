//! Pictures of modes: shares of energy as a table of cells, and mode shapes of the gears in the plane.

use super::{MemberPlace, MemberShape, ModeRecord, ModelModes};
use crate::drawing::Chart;
use crate::drawing::canvas::{Anchor, Canvas, DrawError, Ink, Stroke, Type, draw, text_width};
use crate::drawing::geometry::Rect;
use crate::drawing::panel::WIDTH;
use crate::drawing::style::curve_style;
use crate::numbers::{percent, quantity};
use crate::record::slug;

/// Modes in a picture of shares, and of shapes.
const MOST_SHARES: usize = 24;
const MOST_SHAPES: usize = 9;
/// Columns of a picture of shares.
const MOST_HOLDERS: usize = 14;
/// Least share for a column to be in the picture, and for a number to be written in a cell.
const SHOWN: f64 = 0.02;
const WRITTEN: f64 = 0.005;
/// Heights of a row, of the heads, and the width of the names of modes.
const ROW: f64 = 22.0;
const NAMES: f64 = 104.0;
/// Points around a gear.
const AROUND: usize = 72;
/// Pictures side by side, and their heights.
const ABREAST: usize = 3;
const TALL: f64 = 210.0;

/// Draws the pictures of all models.
pub fn charts(vibrations: &[ModelModes]) -> Result<Vec<Chart>, DrawError> {
    let mut all = Vec::new();
    for v in vibrations {
        let swinging: Vec<&ModeRecord> = v.modes.iter().filter(|m| m.frequency_hz > 0.0).collect();
        if swinging.is_empty() {
            continue;
        }
        all.push(shares(v, &swinging)?);
        all.extend(shapes(v, &swinging)?);
    }
    Ok(all)
}

/// Returns the members or springs with their share of an energy by mode; those with negligible shares in all modes are
/// left out.
fn columns<'a>(
    names: impl Iterator<Item = &'a str>,
    modes: &[&ModeRecord],
    shares: fn(&ModeRecord) -> &[f64],
) -> Vec<(&'a str, Vec<f64>)> {
    let column = |(k, name): (usize, &'a str)| {
        let of = |m: &&ModeRecord| shares(m).get(k).copied().unwrap_or(0.0);
        (name, modes.iter().map(of).collect::<Vec<f64>>())
    };
    let largest = |c: &(&str, Vec<f64>)| c.1.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let mut all: Vec<_> = names.enumerate().map(column).collect();
    all.retain(|c| largest(c) >= SHOWN);
    while all.len() > MOST_HOLDERS / 2 {
        let least = (0..all.len()).min_by(|a, b| largest(&all[*a]).total_cmp(&largest(&all[*b])));
        least.into_iter().for_each(|i| drop(all.remove(i)));
    }
    all
}

fn shares(v: &ModelModes, modes: &[&ModeRecord]) -> Result<Chart, DrawError> {
    let modes = &modes[..modes.len().min(MOST_SHARES)];
    let strain = columns(v.springs.iter().map(String::as_str), modes, |m| &m.strain);
    let kinetic = columns(v.members.iter().map(|p| p.name.as_str()), modes, |m| {
        &m.kinetic
    });
    let title = format!("Where the energy of modes lies: {}", v.label);
    let heads = strain.iter().chain(&kinetic).map(|c| text_width(c.0, 12.0));
    let head = 34.0 + heads.fold(0.0, f64::max);
    let height = head + ROW * modes.len() as f64 + 12.0;
    let count = (strain.len() + kinetic.len()).max(1) as f64;
    let gap = 18.0;
    let cell = ((WIDTH - NAMES - gap - 12.0) / count).min(74.0);
    let svg = draw(WIDTH, height, &title, |c| {
        let small = |anchor| Type::new(12.0, anchor);
        for (i, m) in modes.iter().enumerate() {
            let y = head + ROW * (i as f64 + 0.5);
            let times = match m.multiplicity {
                1 => String::new(),
                n => format!(" ({n}\u{d7})"),
            };
            let text = format!("{}{times}", quantity(m.frequency_hz, "Hz", 4));
            c.text(&text, (NAMES - 8.0, y), small(Anchor::End));
        }
        let mut x = NAMES;
        for (what, columns, style) in [
            ("strain energy", &strain, 1),
            ("kinetic energy", &kinetic, 0),
        ] {
            if columns.is_empty() {
                continue;
            }
            c.text(what, (x, 10.0), small(Anchor::Start).bold());
            for (name, column) in columns {
                let middle = x + 0.5 * cell;
                let at = (middle, head - 8.0 - 0.5 * text_width(name, 12.0));
                c.text(name, at, small(Anchor::Middle).upwards());
                for (i, share) in column.iter().enumerate() {
                    let y = head + ROW * i as f64;
                    paint_share(c, &Rect::new(x, y, x + cell, y + ROW), *share, style);
                }
                x += cell;
            }
            x += gap;
        }
    })?;
    Ok(Chart {
        file: format!("modes_energy_{}.svg", slug(&v.label)),
        title,
        caption: "Shares of strain energy of meshes, shafts, bearings and bodies, and of kinetic energy of gears and bodies, in \
                  per cent, mode by mode. The fuller a cell, the larger its share; holders of less than 2 % everywhere are left \
                  out."
            .into(),
        svg,
    })
}

fn paint_share(c: &mut Canvas, r: &Rect, share: f64, style: usize) {
    let full = share.clamp(0.0, 1.0);
    let ink = curve_style(style).ink;
    c.fill(
        &Rect::new(r.x0, r.y0 + 1.0, r.x0 + full * r.width(), r.y1 - 1.0),
        ink.opacity(0.45),
    );
    c.frame(r, Stroke::new(Ink::GRID, 0.8));
    if share.abs() >= WRITTEN {
        let kind = Type::new(11.5, Anchor::Middle);
        c.text(&percent(share, 2), (0.5 * (r.x0 + r.x1), r.middle()), kind);
    }
}

/// Draws the gears of a plane in the first modes; `None` if axes are not parallel.
fn shapes(v: &ModelModes, modes: &[&ModeRecord]) -> Result<Option<Chart>, DrawError> {
    let toothed: Vec<(&MemberPlace, usize)> = (v.members.iter().enumerate())
        .filter(|(_, p)| p.toothed)
        .map(|(k, p)| (p, k))
        .collect();
    if toothed.is_empty() || toothed.iter().any(|(p, _)| !p.in_plane) {
        return Ok(None);
    }
    let modes = &modes[..modes.len().min(MOST_SHAPES)];
    let reach = |p: &MemberPlace| if p.slides { 0.0 } else { 1.08 * p.radius_m };
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for (p, _) in &toothed {
        for (k, x) in [p.x_m, p.y_m].into_iter().enumerate() {
            low[k] = low[k].min(x - reach(p));
            high[k] = high[k].max(x + reach(p));
        }
    }
    let span = [high[0] - low[0], high[1] - low[1]].map(|s| s.max(1e-6));
    let (wide, rows) = (WIDTH / ABREAST as f64, modes.len().div_ceil(ABREAST));
    let scale = ((wide - 24.0) / span[0]).min((TALL - 54.0) / span[1]);
    let title = format!("How gears move: {}", v.label);
    let svg = draw(WIDTH, TALL * rows as f64, &title, |c| {
        for (i, m) in modes.iter().enumerate() {
            let (left, top) = (wide * (i % ABREAST) as f64, TALL * (i / ABREAST) as f64);
            let head = format!("{}: {}", quantity(m.frequency_hz, "Hz", 4), m.name);
            let size = (12.0 * (wide - 14.0) / text_width(&head, 12.0)).clamp(7.5, 12.0);
            c.text(
                &head,
                (left + 0.5 * wide, top + 12.0),
                Type::new(size, Anchor::Middle),
            );
            let centre = (left + 0.5 * wide, top + 24.0 + 0.5 * (TALL - 34.0));
            let at = |x: f64, y: f64| {
                let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
                (
                    centre.0 + scale * (x - middle[0]),
                    centre.1 - scale * (y - middle[1]),
                )
            };
            // The largest way at a flank, in the plane or out of it, is drawn as a ninth of the picture.
            let way = |s: &MemberShape, p: &MemberPlace| {
                let tilt = s.tilt_x_rad.hypot(s.tilt_y_rad);
                let turns = (p.radius_m * s.turn_rad).abs().max(p.radius_m * tilt);
                turns.max(s.x_m.hypot(s.y_m)).max(s.z_m.abs())
            };
            let largest = (toothed.iter().map(|(p, k)| way(&m.shape[*k], p))).fold(0.0, f64::max);
            let by = if largest > 0.0 {
                TALL / 9.0 / scale / largest
            } else {
                0.0
            };
            for (n, (p, k)) in toothed.iter().enumerate() {
                paint_gear(c, p, &m.shape[*k], by, (&at, n));
            }
        }
    })?;
    Ok(Some(Chart {
        file: format!("modes_shapes_{}.svg", slug(&v.label)),
        title,
        caption: "Gears at rest in outline (base circles), and turned and moved as in the mode, largely magnified, at one moment \
                  of the swing; of several modes of one frequency the first. Gears of one shaft stand in each other's place; \
                  bodies on shafts, and motions along and tilts about axes, are in modes_shapes.csv."
            .into(),
        svg,
    }))
}

/// Paints a gear in its initial and in its displaced position, with a mark that shows its turn.
fn paint_gear(
    c: &mut Canvas,
    p: &MemberPlace,
    s: &MemberShape,
    by: f64,
    (at, n): (&dyn Fn(f64, f64) -> (f64, f64), usize),
) {
    let ink = curve_style(n).ink;
    let (dx, dy) = (by * s.x_m, by * s.y_m);
    if p.slides {
        // A rack: its way as an arrow.
        let to = at(p.x_m + dx, p.y_m + dy + by * s.turn_rad);
        arrow(c, at(p.x_m, p.y_m), to, ink);
        return;
    }
    let ring = |x: f64, y: f64| -> Vec<(f64, f64)> {
        let step = std::f64::consts::TAU / AROUND as f64;
        let point = |i: usize| {
            let (sin, cos) = (step * i as f64).sin_cos();
            at(x + p.radius_m * cos, y + p.radius_m * sin)
        };
        (0..=AROUND).map(point).collect()
    };
    c.line(&ring(p.x_m, p.y_m), Stroke::new(Ink::PALE, 1.0));
    let moved = (p.x_m + dx, p.y_m + dy);
    c.line(
        &ring(moved.0, moved.1),
        Stroke::dashed(ink, 1.8, curve_style(n).dash),
    );
    // A turn is drawn no larger than a third of a turn round.
    let turn = (by * s.turn_rad).clamp(-2.0, 2.0);
    let spoke = |x: f64, y: f64, angle: f64, stroke: Stroke, c: &mut Canvas| {
        let (sin, cos) = angle.sin_cos();
        c.line(
            &[at(x, y), at(x + p.radius_m * cos, y + p.radius_m * sin)],
            stroke,
        );
    };
    let up = std::f64::consts::FRAC_PI_2;
    spoke(p.x_m, p.y_m, up, Stroke::new(Ink::PALE, 1.0), c);
    spoke(moved.0, moved.1, up + turn, Stroke::new(ink, 2.0), c);
    if dx.hypot(dy) > 0.0 {
        arrow(c, at(p.x_m, p.y_m), at(moved.0, moved.1), ink);
    }
}

fn arrow(c: &mut Canvas, from: (f64, f64), to: (f64, f64), ink: Ink) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    if length < 1.5 {
        return;
    }
    let (x, y) = (dx / length, dy / length);
    let tip = 6.0_f64.min(0.6 * length);
    let back = |side: f64| {
        (
            to.0 - tip * x - side * 0.5 * tip * y,
            to.1 - tip * y + side * 0.5 * tip * x,
        )
    };
    c.line(&[from, to], Stroke::new(ink, 1.6));
    c.polygon(&[to, back(1.0), back(-1.0)], ink);
}
