//! Pictures of run-ups: spectra and maps of orders over the speed, and the strongest orders as curves.

use super::{ModelRunUp, RunUpChannel, RunUpMap, strongest};
use crate::drawing::Chart;
use crate::drawing::axis::{Axis, Frame, TICK_SIZE};
use crate::drawing::canvas::{Anchor, Canvas, DrawError, Ink, Stroke, Type, draw};
use crate::drawing::geometry::Rect;
use crate::drawing::heat::{HeatMap, colour_bar};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, LEFT, Panel, WIDTH, chart, extremes};
use crate::drawing::style::curve_style;
use crate::numbers::{Prefix, quantity, short};
use crate::record::slug;
use std::f64::consts::TAU;

/// Heights of a map, of the space above it, and of the axis below.
const MAP: f64 = 330.0;
const ABOVE: f64 = 34.0;
const BELOW: f64 = 48.0;
/// Space at the right: names of lines, and the bar.
const NAMES: f64 = 128.0;
const BAR: f64 = 92.0;
/// Number of decades of amplitude in a map.
const DECADES: f64 = 3.0;
/// Lowest lines of a map, with the mean and slow changes; they are left out of the scale.
const SLOW: f64 = 2.5;
/// Orders in the picture of curves.
const CURVES: usize = 6;
/// Between the names of two lines.
const APART: f64 = 13.0;
/// Colours of order lines and of natural frequencies on a map, the same on light and dark pages.
const ORDER: Ink = Ink(0xfe, 0xfe, 0xfe, 1.0);
const NATURAL: Ink = Ink(0xff, 0xa0, 0x5e, 1.0);

/// Draws the pictures of all models.
pub fn charts(run_ups: &[ModelRunUp]) -> Result<Vec<Chart>, DrawError> {
    let mut all = Vec::new();
    for run in run_ups.iter().filter(|r| r.message.is_empty()) {
        all.extend(curves(run)?);
        for channel in run.channels.iter().filter(|c| !c.spectra.is_empty()) {
            all.push(maps(run, channel)?);
        }
    }
    Ok(all)
}

/// Returns the largest amplitude of a map, without the lines next to zero.
fn largest(rows: &[Vec<f64>], map: &RunUpMap) -> f64 {
    let slow = SLOW / map.span;
    let beyond = map.lines.partition_point(|l| *l < slow);
    let values = rows.iter().flat_map(|r| r.iter().skip(beyond));
    values.copied().fold(0.0, f64::max)
}

/// A line on a map, with its name at the right.
struct MarkedLine {
    points: Vec<(f64, f64)>,
    name: String,
    stroke: Stroke,
}

/// Abscissa of a map: frequency or order.
#[derive(Clone, Copy, PartialEq)]
enum MapAbscissa {
    Frequency,
    Order,
}

fn marks(run: &ModelRunUp, by: MapAbscissa, x: &Axis) -> Vec<MarkedLine> {
    let speeds: Vec<f64> = (0..=60)
        .map(|i| x.min + (x.max - x.min) * f64::from(i) / 60.0)
        .filter(|s| *s > 0.0)
        .collect();
    let line = |of: &dyn Fn(f64) -> f64| speeds.iter().map(|s| (*s, of(*s))).collect();
    let mut all = Vec::new();
    for n in &run.natural {
        let f = n.frequency_hz;
        all.push(MarkedLine {
            points: line(&|s| match by {
                MapAbscissa::Frequency => 1e-3 * f,
                MapAbscissa::Order => TAU * f / s,
            }),
            name: format!("fn {}", quantity(f, "Hz", 4)),
            stroke: Stroke::dashed(NATURAL, 1.4, &[9.0, 3.0, 2.0, 3.0]),
        });
    }
    // Shafts lie at the lower edge of a spectrum.
    for o in (run.orders.iter()).filter(|o| o.of_mesh || by == MapAbscissa::Order) {
        all.push(MarkedLine {
            points: line(&|s| match by {
                MapAbscissa::Frequency => 1e-3 * o.order * s / TAU,
                MapAbscissa::Order => o.order,
            }),
            name: o.name.clone(),
            stroke: Stroke::dashed(ORDER.opacity(0.8), 0.8, &[2.5, 3.5]),
        });
    }
    all
}

/// Paints lines clipped to the map, and their names where there is space: at the right, or above where they end at the
/// top.
fn paint_marks(c: &mut Canvas, frame: &Frame, marks: &[MarkedLine]) {
    let area = frame.area;
    let (mut right, mut above): (Vec<f64>, Vec<[f64; 2]>) = (Vec::new(), Vec::new());
    for m in marks {
        let points: Vec<(f64, f64)> = m.points.iter().map(|p| frame.at(p.0, p.1)).collect();
        let attributes = [("class", "ray".to_owned()), ("data-name", m.name.clone())];
        c.group(&attributes, |c| c.curve(&points, &area, m.stroke));
        let Some(end) = points.last() else { continue };
        let kind = Type::new(TICK_SIZE - 1.0, Anchor::Start);
        if (area.y0..=area.y1).contains(&end.1) {
            if right.iter().all(|y| (y - end.1).abs() >= APART) {
                c.line(
                    &[(area.x1, end.1), (area.x1 + 5.0, end.1)],
                    Stroke::new(Ink::GREY, 1.0),
                );
                c.text(&short_name(&m.name), (area.x1 + 8.0, end.1), kind);
                right.push(end.1);
            }
            continue;
        }
        // Where it leaves at the top.
        let leaves = points
            .windows(2)
            .find(|p| p[0].1 >= area.y0 && p[1].1 < area.y0);
        if let Some([a, b]) = leaves.map(|p| [p[0], p[1]]) {
            let x = a.0 + (b.0 - a.0) * (area.y0 - a.1) / (b.1 - a.1);
            let name = short_name(&m.name);
            let half = 3.2 * name.chars().count() as f64;
            let place = [x - half, x + half];
            if above.iter().all(|o| place[0] > o[1] || place[1] < o[0]) && place[1] < area.x1 + 20.0
            {
                let kind = Type::new(TICK_SIZE - 1.0, Anchor::Middle);
                c.text(&name, (x, area.y0 - 9.0), kind);
                above.push(place);
            }
        }
    }
}

/// Shortens a name to 20 characters.
fn short_name(name: &str) -> String {
    const MOST: usize = 20;
    match name.chars().count() > MOST {
        true => name.chars().take(MOST - 1).chain(['\u{2026}']).collect(),
        false => name.to_owned(),
    }
}

/// Draws spectra over the speed above and orders over the speed below, with one scale of amplitudes.
fn maps(run: &ModelRunUp, channel: &RunUpChannel) -> Result<Chart, DrawError> {
    let title = format!("{}: {}", capital(&channel.name), run.label);
    let top =
        largest(&channel.spectra, &run.by_time).max(largest(&channel.order_spectra, &run.by_turns));
    let prefix = Prefix::of(top, 1.0);
    let top = if top > 0.0 { top * prefix.factor } else { 1.0 };
    let scale = Axis::decades(top * 10f64.powf(-DECADES), top);
    let scaled = |rows: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let row = |r: &Vec<f64>| r.iter().map(|x| x * prefix.factor).collect();
        rows.iter().map(row).collect()
    };
    let khz: Vec<f64> = run.by_time.lines.iter().map(|f| 1e-3 * f).collect();
    let panels = [
        (
            MapAbscissa::Frequency,
            &run.by_time,
            &khz,
            scaled(&channel.spectra),
        ),
        (
            MapAbscissa::Order,
            &run.by_turns,
            &run.by_turns.lines,
            scaled(&channel.order_spectra),
        ),
    ];
    let tall = ABOVE + MAP + BELOW;
    let (low, high) = extremes(panels.iter().flat_map(|p| p.1.speed_rad_s.iter().copied()));
    let x = Axis::linear(low, high);
    let unit = format!("{}{}", prefix.symbol, channel.unit);
    let bar_name = format!("[{unit}]");
    let svg = draw(WIDTH, 2.0 * tall, &title, |c| {
        for (i, (by, map, lines, columns)) in panels.iter().enumerate() {
            let y0 = tall * i as f64 + ABOVE;
            let frame = Frame {
                area: Rect::new(LEFT, y0, WIDTH - NAMES - BAR, y0 + MAP),
                x: x.clone(),
                y: Axis::linear(0.0, lines.last().copied().unwrap_or(1.0)),
            };
            let (y_name, x_name) = match by {
                MapAbscissa::Frequency => ("frequency [kHz]".to_owned(), String::new()),
                MapAbscissa::Order => (
                    format!("order: per turn of {}", run.gear),
                    format!("speed of {} [rad/s]", run.gear),
                ),
            };
            let heat = HeatMap {
                x: &map.speed_rad_s,
                y: lines,
                columns,
                scale: &scale,
                unit: &unit,
            };
            heat.paint(c, &frame);
            // Both maps have the speed as their abscissa, which the lower one names.
            let speed = format!("speed of {} [rad/s]", run.gear);
            let attributes = frame.attributes("map", &speed, &y_name, "");
            c.group(&attributes, |c| paint_axes(c, &frame, [&x_name, &y_name]));
            paint_marks(c, &frame, &marks(run, *by, &x));
            let bar = Rect::new(WIDTH - BAR + 14.0, y0 + 16.0, WIDTH - BAR + 32.0, y0 + MAP);
            colour_bar(c, bar, &scale, &bar_name);
        }
    })?;
    Ok(Chart {
        file: format!("run_up_{}_{}.svg", slug(&run.label), slug(&channel.column)),
        title,
        caption: format!(
            "Amplitudes (half of peak to peak) over the speed of {}. Above spectra of windows of {}, in which orders are rays and natural \
             frequencies (fn, dash-dotted) stay level; a fast ray is as wide as it moves within a window. Below the orders of windows of \
             {} turns at even angles, in which orders stay level and natural frequencies fall. Lines are lighter where one meets the other: \
             resonance.",
            run.gear,
            quantity(run.by_time.span, "s", 3),
            short(run.by_turns.span, 4)
        ),
        svg,
    })
}

/// Paints ticks and names outside of a map, without the grid that would cover it.
fn paint_axes(c: &mut Canvas, frame: &Frame, [x_name, y_name]: [&str; 2]) {
    use crate::drawing::axis::{NAME_SIZE, tick_label};
    let r = frame.area;
    let small = |anchor| Type::new(TICK_SIZE, anchor).ink(Ink::GREY);
    let tick = Stroke::new(Ink::GREY, 1.0);
    let ticks = frame.x.ticks((r.width() / 85.0) as usize);
    for &t in &ticks {
        let (x, _) = frame.at(t, frame.y.min);
        c.line(&[(x, r.y1), (x, r.y1 + 4.0)], tick);
        let label = tick_label(t, &ticks, false);
        c.text(&label, (x, r.y1 + 13.0), small(Anchor::Middle));
    }
    let ticks = frame.y.ticks((r.height() / 38.0) as usize);
    for &t in &ticks {
        let (_, y) = frame.at(frame.x.min, t);
        c.line(&[(r.x0 - 4.0, y), (r.x0, y)], tick);
        let label = tick_label(t, &ticks, false);
        c.text(&label, (r.x0 - 7.0, y), small(Anchor::End));
    }
    c.frame(&r, Stroke::new(Ink::PALE, 1.0));
    let middle = 0.5 * (r.x0 + r.x1);
    let name = Type::new(NAME_SIZE, Anchor::Middle);
    c.text(x_name, (middle, r.y1 + 31.0), name);
    c.text(y_name, (14.0, r.middle()), name.upwards());
}

/// Draws the strongest orders over the speed, a panel for each quantity that has maps.
fn curves(run: &ModelRunUp) -> Result<Option<Chart>, DrawError> {
    let shown: Vec<&RunUpChannel> = run
        .channels
        .iter()
        .filter(|c| !c.spectra.is_empty())
        .collect();
    // By their part of the largest of each quantity.
    let mut weights = vec![0.0_f64; run.orders.len()];
    for channel in &shown {
        let peak = |k: usize| run.peak(channel, k).map_or(0.0, |p| p.amplitude);
        let most = (0..weights.len()).map(peak).fold(0.0, f64::max);
        for (k, weight) in weights.iter_mut().enumerate().filter(|_| most > 0.0) {
            *weight = weight.max(peak(k) / most);
        }
    }
    let mut chosen: Vec<usize> = (0..weights.len()).collect();
    chosen.sort_by(|a, b| weights[*b].total_cmp(&weights[*a]));
    chosen.truncate(CURVES);
    chosen.sort_unstable();
    if chosen.is_empty() || strongest(run, 1).is_empty() {
        return Ok(None);
    }
    let speeds = &run.by_turns.speed_rad_s;
    let (low, high) = extremes(speeds.iter().copied());
    let x = Axis::linear(low, high);
    let mut panels: Vec<Panel> = Vec::new();
    for channel in shown {
        let values = chosen
            .iter()
            .flat_map(|k| channel.orders[*k].iter().copied());
        let (_, top) = extremes(values);
        let prefix = Prefix::of(top, 1.0);
        let curves = chosen.iter().enumerate().map(|(style, k)| {
            let points = speeds.iter().zip(&channel.orders[*k]);
            let points = points
                .map(|(s, a)| (*s, prefix.factor * a))
                .filter(|p| p.1 > 0.0);
            let look = curve_style(style);
            Curve::line(Stroke::dashed(look.ink, 1.7, look.dash), points.collect())
                .along(Some(style))
        });
        let mut panel = Panel::new(170.0, &x, &format!("[{}{}]", prefix.symbol, channel.unit))
            .remark(channel.name.clone())
            .curves(curves);
        let top = top * prefix.factor;
        if top > 0.0 {
            panel.y = Some(Axis::logarithmic(top * 10f64.powf(-DECADES), top));
        }
        panels.push(panel);
    }
    if let Some(last) = panels.last_mut() {
        last.x_name = Some(format!("speed of {} [rad/s]", run.gear));
    }
    let names: Vec<Entry> = (chosen.iter().enumerate())
        .map(|(style, k)| {
            let o = &run.orders[*k];
            let name = match o.of_mesh {
                true => format!("{} (order {})", o.name, short(o.order, 4)),
                false => o.name.clone(),
            };
            let look = curve_style(style);
            Entry::history(&name, Stroke::dashed(look.ink, 1.7, look.dash), Some(style))
        })
        .collect();
    let title = format!("Orders over the speed: {}", run.label);
    let caption = "Amplitudes (half of peak to peak) of the strongest orders, each followed at its very order through windows of whole \
                   turns.";
    let file = format!("run_up_orders_{}.svg", slug(&run.label));
    chart(&file, title, caption, &names, &panels).map(Some)
}

fn capital(text: &str) -> String {
    crate::view::capital(text)
}
