//! Loaded running over the mesh frequency: transmission error, contact force, spectra, cycles.

use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink};
use crate::drawing::curves::{Curve, CurvePanel, draw_curves};
use crate::drawing::style::{Look, Marker, look};
use crate::numbers::{count, quantity};
use crate::record::{Run, StaticCycle, Steady};
use crate::view::View;

/// A model with its runs by mesh frequency.
pub struct Swept<'a> {
    /// Its name.
    pub label: String,
    /// Place in the order of appearance.
    pub style: usize,
    /// Runs that settled, ascending in mesh frequency.
    pub runs: Vec<(&'a Steady, &'a Run)>,
    /// Mesh frequencies at which it failed \[Hz\].
    pub failed: Vec<f64>,
    /// Its static limit.
    pub statics: Option<&'a StaticCycle>,
}

impl Swept<'_> {
    /// The speed with the largest transmission error.
    pub fn peak(&self) -> Option<&Steady> {
        let rms = |s: &Steady| s.error_rms_m;
        (self.runs.iter())
            .max_by(|a, b| rms(a.0).total_cmp(&rms(b.0)))
            .map(|(s, _)| *s)
    }
}

/// The models of a sweep.
pub fn swept<'a>(view: &View<'a>, statics: &'a [StaticCycle]) -> Vec<Swept<'a>> {
    (view.groups.iter())
        .map(|g| {
            let steady = |ok: bool| {
                g.runs
                    .iter()
                    .filter(move |(_, r)| r.status.is_failure() != ok)
                    .filter_map(|(_, r)| Some((r.steady.as_ref()?, *r)))
            };
            let mut runs: Vec<(&Steady, &Run)> = steady(true).collect();
            runs.sort_by(|a, b| a.0.mesh_frequency_hz.total_cmp(&b.0.mesh_frequency_hz));
            Swept {
                label: g.label.clone(),
                style: g.style,
                runs,
                failed: steady(false).map(|(s, _)| s.mesh_frequency_hz).collect(),
                statics: statics.iter().find(|s| s.label == g.label),
            }
        })
        .filter(|s| !s.runs.is_empty() || !s.failed.is_empty())
        .collect()
}

/// Resonance of the mesh: that of the last model that has one, the most detailed of a scene.
pub fn resonance(all: &[Swept<'_>]) -> Option<f64> {
    all.iter().rev().find_map(|s| s.statics?.resonance_hz)
}

const KHZ: f64 = 1e-3;
const UM: f64 = 1e6;
const X_NAME: &str = "mesh frequency [kHz]";

fn blank(height: f64, x: &Axis, y_name: &str) -> CurvePanel {
    CurvePanel {
        height,
        x: x.clone(),
        x_ticks: Vec::new(),
        x_name: None,
        y: None,
        y_name: y_name.into(),
        remark: String::new(),
        curves: Vec::new(),
        limits: Vec::new(),
        verticals: Vec::new(),
        marks: Vec::new(),
    }
}

/// Lines at the mesh resonance and where harmonics of the mesh frequency meet it.
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

fn legend(all: &[Swept<'_>]) -> Vec<(String, Look, bool)> {
    (all.iter())
        .map(|s| (s.label.clone(), look(s.style), true))
        .collect()
}

/// The charts of a sweep.
///
/// # Errors
/// [`DrawError`] when the backend refuses.
pub fn sweep(all: &[Swept<'_>], statics: &[StaticCycle]) -> Result<Vec<Chart>, DrawError> {
    let frequencies = || {
        all.iter()
            .flat_map(|s| s.runs.iter().map(|r| r.0.mesh_frequency_hz))
    };
    let (low, high) = (
        frequencies().fold(f64::INFINITY, f64::min),
        frequencies().fold(0.0, f64::max),
    );
    if low > high {
        return Ok(Vec::new());
    }
    let x = Axis::padded(KHZ * low, KHZ * high, 0.02);
    let mut charts = vec![over_speed(all, &x)?];
    charts.extend(spectra(all)?);
    charts.extend(harmonics(all, &x)?);
    charts.extend(cycles(statics, all)?);
    Ok(charts)
}

fn over_speed(all: &[Swept<'_>], x: &Axis) -> Result<Chart, DrawError> {
    type Get = fn(&Steady) -> f64;
    type Limit = Option<fn(&StaticCycle) -> f64>;
    let values: [(&str, Get, Limit); 3] = [
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
    ];
    let marks = orders(resonance(all), x);
    let mut panels = Vec::new();
    for (k, (name, get, limit)) in values.into_iter().enumerate() {
        let mut panel = blank(190.0, x, name);
        for s in all {
            let points: Vec<(f64, f64)> = (s.runs.iter())
                .map(|(r, _)| (KHZ * r.mesh_frequency_hz, get(r)))
                .filter(|p| p.1.is_finite())
                .collect();
            // The static limit, at the left edge.
            if let (Some(of), Some(statics)) = (limit, s.statics) {
                let at = x.min + 0.004 * (x.max - x.min);
                panel.curves.push(Curve {
                    look: look(s.style),
                    width: 0.0,
                    radius: 4.6,
                    filled: false,
                    points: vec![(at, of(statics))],
                    failed: Vec::new(),
                });
            }
            panel.curves.push(Curve {
                look: look(s.style),
                width: 1.6,
                radius: 2.8,
                filled: true,
                points,
                failed: s.failed.iter().map(|f| KHZ * f).collect(),
            });
        }
        if k == 0 {
            panel.verticals.clone_from(&marks);
        } else {
            panel.verticals = marks.iter().map(|(x, _)| (*x, String::new())).collect();
        }
        panels.push(panel);
    }
    let title = "Transmission error and contact force over speed";
    if let Some(last) = panels.last_mut() {
        last.x_name = Some(X_NAME.into());
    }
    let found = resonance(all).map_or(String::new(), |f| {
        format!(
            " fn = {}: the gears against each other on the mean mesh stiffness; at fn/2, fn/3, ... a harmonic of the mesh \
             frequency meets it.",
            quantity(f, "Hz", 3)
        )
    });
    Ok(Chart {
        file: "sweep.svg".into(),
        title,
        caption: format!(
            "TE: transmission error, about its mean, over whole mesh cycles of steady running. Open markers at the left \
             edge: its static value under the same load. A greatest over mean contact force near 2 goes with teeth that \
             lift off.{found}"
        ),
        svg: draw_curves(title, &legend(all), &panels)?,
    })
}

/// Every harmonic of every speed at its own frequency: what the system answers there.
fn spectra(all: &[Swept<'_>]) -> Result<Option<Chart>, DrawError> {
    let highest = (all.iter())
        .flat_map(|s| &s.runs)
        .map(|(r, _)| r.mesh_frequency_hz * r.error_harmonics_m.len() as f64)
        .fold(0.0, f64::max);
    let lowest = (all.iter())
        .flat_map(|s| &s.runs)
        .map(|(r, _)| r.mesh_frequency_hz)
        .fold(f64::INFINITY, f64::min);
    let Some(fn_hz) = resonance(all) else {
        return Ok(None);
    };
    // Well beyond the mesh resonance bodies and teeth answer.
    let top = highest.min(6.0 * fn_hz);
    let x = Axis {
        min: 0.9 * KHZ * lowest,
        max: KHZ * top,
        log: true,
    };
    let gears: Vec<String> = (all.iter())
        .flat_map(|s| &s.runs)
        .map(|(r, _)| r.bearings.iter().map(|b| b.gear.clone()).collect())
        .next()
        .unwrap_or_default();
    let points = |s: &Swept<'_>, of: &dyn Fn(&Steady) -> Vec<f64>, scale: f64| -> Curve {
        let mut points: Vec<(f64, f64)> = (s.runs.iter())
            .flat_map(|(r, _)| {
                let f = r.mesh_frequency_hz;
                of(r)
                    .into_iter()
                    .enumerate()
                    .map(move |(k, a)| (KHZ * f * (k + 1) as f64, scale * a))
            })
            .filter(|p| p.1 > 0.0 && p.0 <= x.max)
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curve {
            look: look(s.style),
            width: 0.0,
            radius: 1.7,
            filled: true,
            points,
            failed: Vec::new(),
        }
    };
    let mut panels = vec![blank(230.0, &x, "TE amplitude [\u{b5}m]")];
    panels[0].curves = all
        .iter()
        .map(|s| points(s, &|r| r.error_harmonics_m.clone(), UM))
        .collect();
    for gear in &gears {
        let mut panel = blank(210.0, &x, "bearing force [N]");
        panel.remark = format!("bearing of {gear}");
        let of = |r: &Steady| {
            let b = r.bearings.iter().find(|b| b.gear == *gear);
            b.map_or_else(Vec::new, |b| b.harmonics_n.clone())
        };
        panel.curves = all.iter().map(|s| points(s, &of, 1.0)).collect();
        panels.push(panel);
    }
    for p in &mut panels {
        p.y = top_decades(p, 4.0);
        p.verticals = vec![(KHZ * fn_hz, String::new())];
    }
    panels[0].verticals[0].1 = "fn".into();
    if let Some(last) = panels.last_mut() {
        last.x_name = Some("frequency [kHz]".into());
    }
    let title = "Spectra of transmission error and bearing forces, all speeds";
    let own =
        (all.iter().flat_map(|s| &s.runs)).any(|(r, _)| r.bearings.iter().any(|b| b.own_inertia));
    let handed = if own {
        "Bearing forces of elastic gears contain the inertia of their own vibration; those of the others are the contact \
         force handed on."
    } else {
        "Bearing forces are the contact force handed on: the hubs do not give way."
    };
    Ok(Some(Chart {
        file: "sweep_spectra.svg".into(),
        title,
        caption: format!(
            "Amplitudes of all harmonics of the mesh frequency at all speeds, each at its own frequency: where the points \
             of many speeds rise together the gears resonate. {handed}"
        ),
        svg: draw_curves(title, &legend(all), &panels)?,
    }))
}

/// A logarithmic ordinate over the upper decades of a panel.
fn top_decades(panel: &CurvePanel, decades: f64) -> Option<Axis> {
    let values = || {
        panel
            .curves
            .iter()
            .flat_map(|c| c.points.iter().map(|p| p.1))
    };
    let (low, high) = (
        values().fold(f64::INFINITY, f64::min),
        values().fold(0.0, f64::max),
    );
    (high > 0.0).then(|| {
        let mut axis = Axis::logarithmic(low.max(high * 10f64.powf(-decades)), high);
        if !panel.remark.is_empty() {
            axis.max *= 4.0;
        }
        axis
    })
}

/// The first harmonics over speed, of the most detailed model.
fn harmonics(all: &[Swept<'_>], x: &Axis) -> Result<Option<Chart>, DrawError> {
    const SHOWN: usize = 4;
    let Some(s) = all.iter().rev().find(|s| s.runs.len() > 1) else {
        return Ok(None);
    };
    let markers = [
        Marker::Square,
        Marker::Triangle,
        Marker::Diamond,
        Marker::Circle,
    ];
    let of = |k: usize| -> Look {
        Look {
            marker: markers[k],
            ..look(k)
        }
    };
    let mut panel = blank(210.0, x, "TE amplitude [\u{b5}m]");
    let mut force = blank(210.0, x, "bearing force [N]");
    for k in 0..SHOWN {
        for (p, get) in [
            (
                &mut panel,
                &(|r: &Steady| r.error_harmonics_m.get(k).map(|a| UM * a))
                    as &dyn Fn(&Steady) -> Option<f64>,
            ),
            (&mut force, &|r: &Steady| {
                r.bearings.first()?.harmonics_n.get(k).copied()
            }),
        ] {
            p.curves.push(Curve {
                look: of(k),
                width: 1.5,
                radius: 2.6,
                filled: true,
                points: (s.runs.iter())
                    .filter_map(|(r, _)| Some((KHZ * r.mesh_frequency_hz, get(r)?)))
                    .collect(),
                failed: Vec::new(),
            });
        }
    }
    let marks = orders(resonance(all), x);
    force.verticals = marks.iter().map(|(x, _)| (*x, String::new())).collect();
    panel.verticals = marks;
    force.x_name = Some(X_NAME.into());
    let name = (s.runs.first())
        .and_then(|(r, _)| r.bearings.first())
        .map_or(String::new(), |b| b.gear.clone());
    if !name.is_empty() {
        force.remark = format!("bearing of {name}");
    }
    let names: Vec<(String, Look, bool)> = (0..SHOWN)
        .map(|k| {
            let text = if k == 0 {
                "mesh frequency".into()
            } else {
                format!("{} times", k + 1)
            };
            (text, of(k), true)
        })
        .collect();
    let title = "Harmonics of the mesh frequency over speed";
    Ok(Some(Chart {
        file: "sweep_harmonics.svg".into(),
        title,
        caption: format!("Amplitudes of the first harmonics; {}.", s.label),
        svg: draw_curves(title, &names, &[panel, force])?,
    }))
}

/// Transmission error over two mesh cycles: at rest, slow, and where each resonance is.
fn cycles(still: &[StaticCycle], all: &[Swept<'_>]) -> Result<Option<Chart>, DrawError> {
    let Some(detailed) = all.iter().rev().find(|s| !s.runs.is_empty()) else {
        return Ok(None);
    };
    let peak = detailed.peak().map_or(0.0, |s| s.mesh_frequency_hz);
    let half = resonance(all).map_or(0.5 * peak, |f| 0.5 * f);
    let first = detailed.runs[0].0.mesh_frequency_hz;
    let last = detailed.runs[detailed.runs.len() - 1].0.mesh_frequency_hz;
    let mut wanted = vec![first, half.clamp(first, last), peak, last];
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
    let line = |look: Look, points: Vec<(f64, f64)>| Curve {
        look,
        width: 1.8,
        radius: 0.0,
        filled: true,
        points,
        failed: Vec::new(),
    };
    let statics: Vec<Curve> = (still.iter())
        .map(|s| {
            let style = all.iter().find(|a| a.label == s.label).map(|a| a.style);
            // A model that stands still only is the dark line.
            let look = style.map_or(STANDING, look);
            line(look, twice(&s.position, &s.error_m, s.error_mean_m))
        })
        .collect();
    if !statics.is_empty() {
        let mut panel = blank(150.0, &x, "TE [\u{b5}m]");
        panel.remark = "at rest".into();
        panel.curves = statics;
        panels.push(panel);
    }
    for f in wanted {
        let mut panel = blank(150.0, &x, "TE [\u{b5}m]");
        panel.remark = format!("mesh frequency about {}", quantity(f, "Hz", 3));
        for s in all {
            let near = |r: &Steady| (r.mesh_frequency_hz - f).abs();
            let run = (s.runs.iter()).min_by(|a, b| near(a.0).total_cmp(&near(b.0)));
            if let Some((r, _)) = run {
                let points = twice(&r.position, &r.error_cycle_m, r.error_mean_m);
                panel.curves.push(line(look(s.style), points));
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
        if all.iter().all(|a| a.label != s.label) {
            names.push((format!("{} (at rest)", s.label), STANDING, false));
        }
    }
    let title = "Transmission error over two mesh cycles";
    let cycles = detailed.runs[0].0.cycles;
    Ok(Some(Chart {
        file: "sweep_cycles.svg".into(),
        title,
        caption: format!(
            "About its mean; each dynamic line is the mean of {} cycles. At rest: static equilibrium under the same load.",
            count(cycles as u64)
        ),
        svg: draw_curves(title, &names, &panels)?,
    }))
}

/// Look of a model that was not swept.
const STANDING: Look = Look {
    ink: Ink::DARK,
    dash: &[],
    marker: Marker::Circle,
};
