//! Frequency response over the mesh frequency: transmission error, mesh force, forces of mounts, harmonics.

use super::{GroupResponse, ModelResponse, ResponsePoint};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart, extremes};
use crate::drawing::style::curve_style;
use crate::record::slug;

const KHZ: f64 = 1e-3;
const UM: f64 = 1e6;
const X_NAME: &str = "mesh frequency [kHz]";
/// Number of harmonics, and of mounts, in a chart.
const SHOWN: usize = 4;
const MOST_MOUNTS: usize = 4;

/// Returns a line for points at which no flanks separate, and a thin one for the others.
fn curves(
    group: &GroupResponse,
    style: usize,
    value: impl Fn(&ResponsePoint) -> f64,
) -> Vec<Curve> {
    let mut all = Vec::new();
    let points: Vec<(bool, (f64, f64))> = (group.points.iter())
        .map(|p| (p.is_linear(), (KHZ * p.mesh_frequency_hz, value(p))))
        .collect();
    let mut start = 0;
    while start < points.len() {
        let holds = points[start].0;
        let length = points[start..].iter().take_while(|p| p.0 == holds).count();
        // Where flanks separate, the line is extended to the neighbouring points.
        let beside = usize::from(!holds);
        let from = start.saturating_sub(beside);
        let end = (start + length + beside).min(points.len());
        let piece = points[from..end].iter().map(|p| p.1).collect();
        let stroke = match holds {
            true => Stroke::dashed(curve_style(style).ink, 1.8, curve_style(style).dash),
            false => Stroke::dashed(curve_style(style).ink, 0.9, &[1.5, 2.5]),
        };
        all.push(Curve::line(stroke, piece));
        start += length;
    }
    all
}

fn legend(responses: &[ModelResponse]) -> Vec<Entry> {
    let solid = |(i, r): (usize, &ModelResponse)| {
        Entry::line(
            &r.label,
            Stroke::dashed(curve_style(i).ink, 1.8, curve_style(i).dash),
        )
    };
    responses.iter().enumerate().map(solid).collect()
}

/// Draws the charts of all groups of meshes.
pub fn charts(responses: &[ModelResponse]) -> Result<Vec<Chart>, DrawError> {
    let groups = responses.iter().map(|r| r.groups.len()).max().unwrap_or(0);
    let mut all = Vec::new();
    for g in 0..groups {
        let of: Vec<(usize, &ModelResponse, &GroupResponse)> = (responses.iter().enumerate())
            .filter_map(|(i, r)| Some((i, r, r.groups.get(g)?)))
            .collect();
        let frequencies = of.iter().flat_map(|(.., g)| &g.points);
        let (low, high) = extremes(frequencies.map(|p| KHZ * p.mesh_frequency_hz));
        if low >= high {
            continue;
        }
        let x = Axis::padded(low, high, 0.01);
        for mesh in 0..of[0].2.meshes.len() {
            // Models of one scene have the same meshes; a record that was edited may not.
            let of: Vec<_> = (of.iter().copied())
                .filter(|(.., g)| mesh < g.meshes.len())
                .collect();
            all.push(over_frequency(&of, mesh, &x, &legend(responses))?);
        }
        all.extend(mounts(&of, g, &x, &legend(responses))?);
        if let Some((_, r, group)) = of.last() {
            all.push(harmonics(r, group, &x)?);
        }
    }
    Ok(all)
}

type Of<'a> = [(usize, &'a ModelResponse, &'a GroupResponse)];

/// Returns the mesh frequencies at which one of their first four harmonics equals the resonance of a group, with names.
fn orders(of: &Of<'_>, x: &Axis, named: bool) -> Vec<(f64, String)> {
    let Some(f) = of.iter().rev().find_map(|(.., g)| g.resonance_hz) else {
        return Vec::new();
    };
    let line = |k: u32| {
        let name = match (named, k) {
            (false, _) => String::new(),
            (_, 1) => "fn".into(),
            _ => format!("fn/{k}"),
        };
        (KHZ * f / f64::from(k), name)
    };
    let all = (1..=4).rev().map(line);
    all.filter(|(at, _)| (x.min..=x.max).contains(at)).collect()
}

fn over_frequency(
    of: &Of<'_>,
    mesh: usize,
    x: &Axis,
    legend: &[Entry],
) -> Result<Chart, DrawError> {
    type Field = fn(&ResponsePoint, usize) -> f64;
    let name = of[0].2.meshes[mesh].name.clone();
    let values: [(&str, Field); 3] = [
        ("TE, rms [\u{b5}m]", |p, m| UM * p.meshes[m].error_rms_m),
        ("TE, peak to peak [\u{b5}m]", |p, m| {
            UM * p.meshes[m].error_peak_to_peak_m
        }),
        ("force, rms [N]", |p, m| p.meshes[m].force_rms_n),
    ];
    let mut panels = Vec::new();
    for (k, (y_name, get)) in values.into_iter().enumerate() {
        let mut panel = Panel::new(180.0, x, y_name);
        panel.verticals = orders(of, x, k == 0);
        for (i, _, group) in of {
            panel.curves.extend(curves(group, *i, |p| get(p, mesh)));
        }
        panels.push(panel);
    }
    let mut range = Panel::new(180.0, x, "least / mean force");
    range.verticals = orders(of, x, false);
    range.limits = vec![(0.0, "flanks part below".into())];
    for (i, _, group) in of {
        let mean = group.meshes[mesh].force_n;
        let least = |p: &ResponsePoint| p.meshes[mesh].force_least_n / mean;
        range.curves.extend(curves(group, *i, least));
    }
    let (low, _) = range.ordinates();
    range.y = Some(Axis::padded(low.clamp(-1.0, 0.0), 1.0, 0.06));
    range.x_name = Some(X_NAME.into());
    panels.push(range);
    chart(
        &format!("response_{}.svg", slug(&name)),
        format!("Response to the passing of teeth: {name}"),
        "TE: transmission error by the hubs along the line of action, about its mean. Dotted: flanks part there, and the response \
         to first order is not valid. fn: the resonance, the root mean square over the mesh cycle of the natural frequency that \
         strains the mesh most; at fn/2, fn/3, ... a harmonic of the \
         mesh frequency meets it.",
        legend,
        &panels,
    )
}

/// Draws the forces of the mounts with the largest amplitudes.
fn mounts(
    of: &Of<'_>,
    group: usize,
    x: &Axis,
    legend: &[Entry],
) -> Result<Option<Chart>, DrawError> {
    let first = of[0].2;
    let largest = |k: &usize| {
        let all = of
            .iter()
            .flat_map(|(.., g)| &g.points)
            .filter_map(|p| p.mounts.get(*k));
        all.map(|m| m.rms_n).fold(0.0, f64::max)
    };
    let mut places: Vec<usize> = (0..first.mounts.len())
        .filter(|k| largest(k) > 0.0)
        .collect();
    places.sort_by(|a, b| largest(b).total_cmp(&largest(a)));
    places.truncate(MOST_MOUNTS);
    places.sort_unstable();
    if places.is_empty() {
        return Ok(None);
    }
    let mut panels: Vec<Panel> = (places.iter())
        .map(|&k| {
            let mut panel = Panel::new(170.0, x, "mount force, rms [N]");
            panel.remark = format!("mount of {}", first.mounts[k]);
            for (i, _, g) in of {
                let rms = |p: &ResponsePoint| p.mounts.get(k).map_or(f64::NAN, |m| m.rms_n);
                panel.curves.extend(curves(g, *i, rms));
            }
            panel.verticals = orders(of, x, false);
            panel
        })
        .collect();
    if let Some(last) = panels.last_mut() {
        last.x_name = Some(X_NAME.into());
    }
    chart(
        &format!("response_mounts_{}.svg", group + 1),
        "Forces of mounts",
        "Across the axis, about their mean: of bearings by their stiffness and damping, of held hubs the force of the teeth.",
        legend,
        &panels,
    )
    .map(Some)
}

/// Draws the first harmonics of the transmission error of the mesh of a group whose fundamental is largest, for one model.
fn harmonics(
    response: &ModelResponse,
    group: &GroupResponse,
    x: &Axis,
) -> Result<Chart, DrawError> {
    let fundamental = |m: usize| -> f64 {
        let all = group
            .points
            .iter()
            .filter_map(|p| p.meshes[m].error_harmonics_m.first());
        all.copied().fold(0.0, f64::max)
    };
    let meshes = 0..group.meshes.len();
    let largest = meshes.reduce(|a, b| {
        if fundamental(b) > fundamental(a) {
            b
        } else {
            a
        }
    });
    let mesh = largest.unwrap_or_default();
    let name = &group.meshes[mesh].name;
    let mut panel = Panel::new(240.0, x, "TE amplitude [\u{b5}m]");
    let shown = group.meshes[mesh].error_harmonics_m.len().min(SHOWN);
    for k in 0..shown {
        let of = |p: &ResponsePoint| {
            p.meshes[mesh]
                .error_harmonics_m
                .get(k)
                .map_or(f64::NAN, |a| UM * a)
        };
        panel.curves.extend(curves(group, k, of));
    }
    panel.x_name = Some(X_NAME.into());
    let entry = |k: usize| {
        let text = match k {
            0 => "mesh frequency".to_owned(),
            _ => format!("{} times", k + 1),
        };
        Entry::line(
            &text,
            Stroke::dashed(curve_style(k).ink, 1.8, curve_style(k).dash),
        )
    };
    let entries: Vec<Entry> = (0..shown).map(entry).collect();
    chart(
        &format!("response_harmonics_{}.svg", slug(name)),
        format!("Harmonics of the mesh frequency: {name}"),
        format!(
            "Amplitudes of the first harmonics of the transmission error; {}.",
            response.label
        ),
        &entries,
        &[panel],
    )
}
