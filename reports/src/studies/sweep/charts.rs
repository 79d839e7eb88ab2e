//! Loaded running over the mesh frequency: transmission error, contact force, spectra, cycles.

mod spectra;

use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart, extremes};
use crate::drawing::style::{CurveStyle, Marker, curve_style, reference_stroke};
use crate::numbers::{count, quantity};
use crate::record::{StaticCycle, Steady};
use crate::studies::sweep::{Bistable, Branch, ModelCycle, SweptBranch, resonance};
use spectra::{shaft_orders, spectra};

const KHZ: f64 = 1e-3;
const UM: f64 = 1e6;
const X_NAME: &str = "mesh frequency [kHz]";

/// Returns the vertical lines at the mesh resonance and at the mesh frequencies whose harmonics equal it.
fn orders(resonance: Option<f64>, axis: &Axis) -> Vec<(f64, String)> {
    let Some(f) = resonance else {
        return Vec::new();
    };
    (1..=4)
        .rev()
        .map(|k| {
            let name = if k == 1 {
                "fn".into()
            } else {
                format!("fn/{k}")
            };
            (KHZ * f / f64::from(k), name)
        })
        .filter(|(x, _)| (axis.min..=axis.max).contains(x))
        .collect()
}

/// Returns the vertical lines of `marks` without their names.
fn unnamed(marks: &[(f64, String)]) -> Vec<(f64, String)> {
    marks.iter().map(|(x, _)| (*x, String::new())).collect()
}

fn legend(all: &[SweptBranch<'_>]) -> Vec<Entry> {
    let entry = |s: &SweptBranch<'_>| Entry::marked(&s.label, curve_style(s.style), filled(s));
    all.iter().map(entry).collect()
}

/// True if markers are filled; on the way down they are open.
fn filled(s: &SweptBranch<'_>) -> bool {
    s.branch != Branch::Down
}

/// Returns all runs that settled.
fn settled<'s>(all: &'s [SweptBranch<'_>]) -> impl Iterator<Item = &'s Steady> {
    all.iter().flat_map(|s| s.runs.iter().map(|r| r.0))
}

/// Draws the charts of a sweep.
pub fn sweep(
    all: &[SweptBranch<'_>],
    statics: &[ModelCycle<'_>],
    two: &[Bistable],
) -> Result<Vec<Chart>, DrawError> {
    let (low, high) = extremes(settled(all).map(|s| s.mesh_frequency_hz));
    if low > high {
        return Ok(Vec::new());
    }
    let x = Axis::padded(KHZ * low, KHZ * high, 0.02);
    let mut charts = vec![over_speed(all, &x, two)?];
    charts.extend(spectra(all)?);
    charts.extend(harmonics(all, &x)?);
    charts.extend(cycles(statics, all)?);
    charts.extend(shaft_orders(all)?);
    Ok(charts)
}

fn over_speed(all: &[SweptBranch<'_>], x: &Axis, two: &[Bistable]) -> Result<Chart, DrawError> {
    type Field = fn(&Steady) -> f64;
    type Limit = Option<fn(&StaticCycle) -> f64>;
    let values: [(&str, Field, Limit); 4] = [
        (
            "TE, rms [\u{b5}m]",
            |s| UM * s.error_rms_m,
            Some(|s| UM * s.rms()),
        ),
        (
            "TE, peak to peak [\u{b5}m]",
            |s| UM * s.error_peak_to_peak_m,
            Some(|s| UM * s.error_peak_to_peak_m),
        ),
        (
            "greatest / mean force",
            |s| s.force_peak_n / s.force_mean_n,
            None,
        ),
        ("time without contact [%]", |s| 100.0 * s.separated, None),
    ];
    let marks = orders(resonance(all), x);
    let mut panels = Vec::new();
    for (k, (name, get, limit)) in values.into_iter().enumerate() {
        let mut panel = Panel::new(190.0, x, name);
        for s in all {
            // The static limit, at the left edge.
            if let (Some(of), Some(statics)) = (limit, s.statics) {
                let at = x.min + 0.004 * (x.max - x.min);
                let point = vec![(at, of(statics))];
                panel
                    .curves
                    .push(Curve::points(curve_style(s.style), 4.6, false, point));
            }
            let points = (s.runs.iter())
                .map(|(r, _)| (KHZ * r.mesh_frequency_hz, get(r)))
                .filter(|p| p.1.is_finite());
            let mut curve = Curve::joined(curve_style(s.style), 1.6, 2.8, points.collect());
            if let Some(marker) = &mut curve.marker {
                marker.2 = filled(s);
            }
            let apart = (s.unsettled.iter())
                .map(|(r, _)| (KHZ * r.mesh_frequency_hz, get(r)))
                .filter(|p| p.1.is_finite());
            let apart: Vec<(f64, f64)> = apart.collect();
            if !apart.is_empty() {
                let points = Curve::points(curve_style(s.style), 3.2, false, apart);
                panel.curves.push(points);
            }
            let failed = s.failed.iter().map(|f| KHZ * f);
            panel.curves.push(curve.failed(failed.collect()));
        }
        panel.verticals = if k == 0 {
            marks.clone()
        } else {
            unnamed(&marks)
        };
        for t in two {
            let of = all.iter().find(|s| s.model == t.label);
            let ink = of
                .map_or(Ink::GREY, |s| curve_style(s.style).ink)
                .opacity(0.12);
            let band = |[a, b]: &[f64; 2]| ([KHZ * a, KHZ * b], ink);
            panel.bands.extend(t.ranges.iter().map(band));
        }
        panel.x_name = (k == 3).then(|| X_NAME.into());
        panels.push(panel);
    }
    let found = resonance(all).map_or(String::new(), |f| {
        let mut resonances = all.iter().filter_map(|s| s.statics?.resonance_hz);
        let of = match resonances.all(|other| (other - f).abs() < 1e-3 * f) {
            true => String::new(),
            false => all
                .iter()
                .rev()
                .find(|s| s.statics.is_some_and(|s| s.resonance_hz.is_some()))
                .map_or(String::new(), |s| format!(" of {}", s.model)),
        };
        format!(
            " fn = {}: the resonance of the mesh{of}; at fn/2, fn/3, ... a harmonic of the mesh \
             frequency meets it.",
            quantity(f, "Hz", 3)
        )
    });
    let apart = match all.iter().all(|s| s.unsettled.is_empty()) {
        true => "",
        false => {
            " Small open markers off the lines: runs that did not settle, whose values stand for no speed."
        }
    };
    let caption = format!(
        "TE: transmission error, about its mean, over whole mesh cycles of steady running. Open markers at the left edge: \
         its static value under the same load. Filled markers: the speed rises, or each run starts afresh; open ones: it \
         falls. Tinted: speeds at which both differ, so that the gears run in the one way or the other.{apart}{found}"
    );
    let title = "Transmission error and contact force over speed";
    chart("sweep.svg", title, caption, &legend(all), &panels)
}

/// Draws the first harmonics over speed, of the most detailed model.
fn harmonics(all: &[SweptBranch<'_>], x: &Axis) -> Result<Option<Chart>, DrawError> {
    const SHOWN: usize = 4;
    let Some(s) = (all.iter().rev()).find(|s| s.first && s.runs.len() > 1) else {
        return Ok(None);
    };
    let markers = [
        Marker::Square,
        Marker::Triangle,
        Marker::Diamond,
        Marker::Circle,
    ];
    let of = |k: usize| -> CurveStyle {
        CurveStyle {
            marker: markers[k],
            ..curve_style(k)
        }
    };
    type Field = fn(&Steady, usize) -> Option<f64>;
    let panel = |y_name: &str, get: Field| {
        let curve = |k: usize| {
            let point = |(r, _): &(&Steady, _)| Some((KHZ * r.mesh_frequency_hz, get(r, k)?));
            Curve::joined(of(k), 1.5, 2.6, s.runs.iter().filter_map(point).collect())
        };
        Panel::new(210.0, x, y_name).curves((0..SHOWN).map(curve))
    };
    let mut error = panel("TE amplitude [\u{b5}m]", |r, k| {
        r.error_harmonics_m.get(k).map(|a| UM * a)
    });
    let mut force = panel("bearing force [N]", |r, k| {
        r.bearings.first()?.harmonics_n.get(k).copied()
    });
    error.verticals = orders(resonance(all), x);
    force.verticals = unnamed(&error.verticals);
    force.x_name = Some(X_NAME.into());
    let name = (s.runs.first())
        .and_then(|(r, _)| r.bearings.first())
        .map_or(String::new(), |b| b.gear.clone());
    if !name.is_empty() {
        force.remark = format!("bearing of {name}");
    }
    let name = |k: usize| match k {
        0 => Entry::marked("mesh frequency", of(k), true),
        _ => Entry::marked(&format!("{} times", k + 1), of(k), true),
    };
    let names: Vec<Entry> = (0..SHOWN).map(name).collect();
    let caption = format!("Amplitudes of the first harmonics; {}.", s.label);
    let title = "Harmonics of the mesh frequency over speed";
    chart(
        "sweep_harmonics.svg",
        title,
        caption,
        &names,
        &[error, force],
    )
    .map(Some)
}

/// Draws the transmission error over two mesh cycles: quasi-static, at low speed, and at each resonance.
fn cycles(still: &[ModelCycle<'_>], all: &[SweptBranch<'_>]) -> Result<Option<Chart>, DrawError> {
    let Some(detailed) = all.iter().rev().find(|s| !s.runs.is_empty()) else {
        return Ok(None);
    };
    let peak = detailed.peak().map_or(0.0, |s| s.mesh_frequency_hz);
    let half = resonance(all).map_or(0.5 * peak, |f| 0.5 * f);
    let first = detailed.runs[0].0.mesh_frequency_hz;
    let last = detailed.runs[detailed.runs.len() - 1].0.mesh_frequency_hz;
    let mut wanted = vec![first, half.max(first).min(last), peak, last];
    wanted.sort_by(f64::total_cmp);
    wanted.dedup_by(|a, b| (*a - *b).abs() < 0.08 * *b);
    let x = Axis::linear(-1.0, 1.0);
    let mut panels = Vec::new();
    let twice = |position: &[f64], values: &[f64], mean: f64| -> Vec<(f64, f64)> {
        let mut points: Vec<(f64, f64)> = (-2..=1)
            .flat_map(|turn| {
                (position.iter().zip(values))
                    .map(move |(p, e)| (p + f64::from(turn), UM * (e - mean)))
            })
            .filter(|p| (-1.0..=1.0).contains(&p.0))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    };
    let line =
        |look: CurveStyle, points| Curve::line(Stroke::dashed(look.ink, 1.8, look.dash), points);
    let statics = still.iter().map(|s| {
        // A model that stands still only is the dark line.
        let look = of_cycle(all, s).map_or(standing(s.scene), |a| curve_style(a.style));
        let cycle = s.cycle;
        line(
            look,
            twice(&cycle.position, &cycle.error_m, cycle.error_mean_m),
        )
    });
    if !still.is_empty() {
        let panel = Panel::new(150.0, &x, "TE [\u{b5}m]").remark("at rest");
        panels.push(panel.curves(statics));
    }
    for f in wanted {
        let mut panel = Panel::new(150.0, &x, "TE [\u{b5}m]")
            .remark(format!("mesh frequency about {}", quantity(f, "Hz", 3)));
        for s in all {
            let near = |r: &Steady| (r.mesh_frequency_hz - f).abs();
            let run = (s.runs.iter()).min_by(|a, b| near(a.0).total_cmp(&near(b.0)));
            if let Some((r, _)) = run {
                let points = twice(&r.position, &r.error_cycle_m, r.error_mean_m);
                let mut curve = line(curve_style(s.style), points);
                // The way down is thin upon the way up.
                if let Some(stroke) = curve.stroke.as_mut().filter(|_| !filled(s)) {
                    stroke.width *= 0.5;
                }
                panel.curves.push(curve);
            }
        }
        panels.push(panel);
    }
    if let Some(last) = panels.last_mut() {
        last.x_name =
            Some("position of the reference pair from the pitch point / base pitch".into());
    }
    let mut names = legend(all);
    for s in still {
        if of_cycle(all, s).is_none() {
            let name = format!("{} (at rest)", s.label);
            names.push(Entry::marked(&name, standing(s.scene), false));
        }
    }
    let caption = format!(
        "About its mean; each dynamic line is the mean of {} cycles. At rest: static equilibrium under the same load.",
        count(detailed.runs[0].0.cycles as u64)
    );
    let title = "Transmission error over two mesh cycles";
    chart("sweep_cycles.svg", title, caption, &names, &panels).map(Some)
}

/// Returns the branch of the model of a static cycle.
fn of_cycle<'s, 'a>(all: &'s [SweptBranch<'a>], s: &ModelCycle<'_>) -> Option<&'s SweptBranch<'a>> {
    let of = |a: &&SweptBranch<'_>| a.statics.is_some_and(|x| std::ptr::eq(x, s.cycle));
    all.iter().find(of)
}

/// Returns the look of the quasi-static limit of a model without runs in the sweep, by the place of its scene.
fn standing(scene: usize) -> CurveStyle {
    let Stroke { ink, dash, .. } = reference_stroke(scene);
    CurveStyle {
        ink: if scene == 0 { Ink::DARK } else { ink },
        dash,
        marker: Marker::Circle,
    }
}
