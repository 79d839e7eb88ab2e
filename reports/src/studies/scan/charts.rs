//! Charts of a scan: responses over each axis, distributions, sensitivity indices.

use super::{ScanRecord, ShownRow, axis_words, output_text, short_name};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart};
use crate::drawing::style::curve_style;
use crate::studies::tabular::axis_over;

/// Largest number of outputs of a chart, a panel each.
const MOST_PANELS: usize = 5;
/// Largest number of curves of a panel.
const MOST_CURVES: usize = 10;
/// Largest number of axes with a chart.
const MOST_AXES: usize = 8;
/// Largest number of points of a curve of points.
const MOST_POINTS: usize = 600;

/// Returns the charts of a scan.
pub fn charts(record: &ScanRecord) -> Result<Vec<Chart>, DrawError> {
    let mut charts = Vec::new();
    let sampled = record.samples.is_some();
    for axis in (0..record.axes.len()).take(MOST_AXES) {
        charts.extend(response(record, axis)?);
    }
    if sampled {
        charts.extend(distribution(record)?);
    }
    if !record.indices.is_empty() {
        charts.push(sensitivity(record)?);
    }
    Ok(charts)
}

/// A curve of a chart: a configuration at values of the listed axes other than the abscissa.
#[derive(PartialEq)]
struct Family {
    configuration: usize,
    at: Vec<usize>,
}

impl Family {
    fn of(row: &ShownRow, abscissa: Option<usize>) -> Self {
        let mut at = row.at.clone();
        if let Some(axis) = abscissa {
            at[axis] = 0;
        }
        Family {
            configuration: row.configuration,
            at,
        }
    }

    /// Its name: what distinguishes it from the others.
    fn name(&self, record: &ScanRecord, abscissa: Option<usize>) -> String {
        let own = |(i, _): &(usize, _)| Some(*i) != abscissa;
        let axes = record.axes.iter().zip(&self.at).enumerate().filter(own);
        let values = axes.filter(|(_, (a, _))| a.values.len() > 1);
        let values =
            values.map(|(_, (a, at))| format!("{} = {}", short_name(&a.keys[0]), a.values[*at]));
        let several = record.configurations.len() > 1;
        let several_methods = record
            .configurations
            .windows(2)
            .any(|c| c[0].label == c[1].label);
        let configuration = &record.configurations[self.configuration];
        let label = match (several, several_methods) {
            (_, true) => Some(configuration.text()),
            (true, false) => Some(configuration.label.clone()),
            (false, false) => None,
        };
        let parts: Vec<String> = label.into_iter().chain(values).collect();
        match parts.is_empty() {
            true => configuration.label.clone(),
            false => parts.join(", "),
        }
    }
}

/// Families of rows, in their order; at most [`MOST_CURVES`].
fn families(record: &ScanRecord, abscissa: Option<usize>) -> Vec<Family> {
    let mut all: Vec<Family> = Vec::new();
    for row in &record.shown {
        let family = Family::of(row, abscissa);
        if !all.contains(&family) {
            all.push(family);
        }
    }
    all.truncate(MOST_CURVES);
    all
}

/// The response over an axis: points of samples over a random axis, lines or bands over a listed one.
fn response(record: &ScanRecord, axis: usize) -> Result<Option<Chart>, DrawError> {
    let place = |r: &ShownRow| r.values[axis];
    let Some(x) = axis_over(record.shown.iter().filter_map(place), 1.0) else {
        return Ok(None);
    };
    let listed = !record.axes[axis].values.is_empty();
    let is_seed = !listed
        && record.axes[axis]
            .distribution
            .as_deref()
            .is_some_and(|d| d.starts_with("seeds"));
    if is_seed {
        return Ok(None);
    }
    let families = families(record, Some(axis));
    let outputs = record.outputs.len().min(MOST_PANELS);
    let mut panels = Vec::new();
    for output in 0..outputs {
        let mut curves = Vec::new();
        for (style, family) in families.iter().enumerate() {
            let own = || {
                record
                    .shown
                    .iter()
                    .filter(|r| Family::of(r, Some(axis)) == *family)
            };
            let point = |r: &ShownRow| Some((r.values[axis]?, r.outputs[output]?));
            let failed = own().filter(|r| r.outputs.iter().all(Option::is_none));
            let failed: Vec<f64> = failed.filter_map(place).take(MOST_POINTS).collect();
            let look = curve_style(style);
            let bands = bands(record, (axis, output), family);
            if listed && !bands.is_empty() {
                let of = |k: usize| bands.iter().map(|(x, q)| (*x, q[k])).collect::<Vec<_>>();
                let thin = Stroke::dashed(look.ink, 1.0, &[3.0, 3.0]);
                curves.push(Curve::line(thin, of(1)));
                curves.push(Curve::line(thin, of(5)));
                curves.push(Curve::joined(look, 1.8, 3.6, of(3)).failed(failed));
            } else if listed && record.samples.is_none() {
                let mut points: Vec<(f64, f64)> = own().filter_map(point).collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                let radius = if points.len() > 40 { 1.6 } else { 3.4 };
                curves.push(Curve::joined(look, 1.4, radius, points).failed(failed));
            } else {
                let mut points: Vec<(f64, f64)> =
                    own().filter_map(point).take(MOST_POINTS).collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                curves.push(Curve::points(look, 1.8, true, points).failed(failed));
            }
        }
        if curves.iter().all(|c| c.points.is_empty()) {
            continue;
        }
        let (name, unit) = output_text(&record.outputs[output]);
        panels.push(
            Panel::new(150.0, &x, &in_brackets(unit))
                .remark(name)
                .curves(curves)
                .near(),
        );
    }
    let Some(last) = panels.last_mut() else {
        return Ok(None);
    };
    last.x_name = Some(axis_words(&record.axes[axis].keys[0]));
    let legend: Vec<Entry> = (families.iter().enumerate())
        .map(|(i, f)| Entry::marked(&f.name(record, Some(axis)), curve_style(i), true))
        .collect();
    let key = record.axes[axis].keys.join(" | ");
    let what = match (listed, record.samples.is_some()) {
        (true, true) => {
            "Median of the samples, and between the thin lines the middle 90 % of them."
        }
        (true, false) => {
            "One point for each scene. An ordinate of values that are alike does not begin at zero."
        }
        (false, _) => "One point for each sample; the other random axes vary as well.",
    };
    Ok(Some(chart(
        &format!("scan_{}.svg", axis + 1),
        format!("Over {key}"),
        what,
        &legend,
        &panels,
    )?))
}

/// Name of an output with its unit, as it stands next to an axis.
fn axis_name(key: &str) -> String {
    let (name, unit) = output_text(key);
    format!("{name} {}", in_brackets(unit))
        .trim_end()
        .to_owned()
}

/// A unit as it stands next to an axis; an empty text for ratios.
fn in_brackets(unit: &str) -> String {
    match unit {
        "" => String::new(),
        unit => format!("[{unit}]"),
    }
}

/// Quantiles of a family over a listed axis with numbers.
fn bands(
    record: &ScanRecord,
    (axis, output): (usize, usize),
    family: &Family,
) -> Vec<(f64, [f64; 7])> {
    let mut all: Vec<(f64, [f64; 7])> = (record.statistics.iter())
        .filter(|s| s.output == output && s.configuration == family.configuration)
        .filter(|s| (0..s.at.len()).all(|i| i == axis || s.at[i] == family.at[i]))
        .filter_map(|s| {
            let value = record.axes[axis].values.get(s.at[axis])?;
            Some((value.parse().ok()?, s.quantiles))
        })
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

/// Cumulative distributions of the outputs.
fn distribution(record: &ScanRecord) -> Result<Option<Chart>, DrawError> {
    let families = families(record, None);
    let mut panels = Vec::new();
    for output in 0..record.outputs.len().min(MOST_PANELS) {
        let values = |family: &Family| -> Vec<f64> {
            let own = record
                .shown
                .iter()
                .filter(|r| Family::of(r, None) == *family);
            let mut values: Vec<f64> = own.filter_map(|r| r.outputs[output]).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let all: Vec<Vec<f64>> = families.iter().map(values).collect();
        let Some(x) = axis_over(all.iter().flatten().copied(), 1.0) else {
            continue;
        };
        let curves = all.into_iter().enumerate().map(|(i, values)| {
            let n = values.len() as f64;
            let stroke = Stroke::dashed(curve_style(i).ink, 1.8, curve_style(i).dash);
            let points = values.into_iter().enumerate();
            Curve::line(
                stroke,
                points
                    .map(|(k, x)| (x, 100.0 * (k as f64 + 0.5) / n))
                    .collect(),
            )
        });
        let mut panel = Panel::new(130.0, &x, "share [%]").curves(curves);
        panel.y = Some(Axis::linear(0.0, 100.0));
        panel.x_name = Some(axis_name(&record.outputs[output]));
        panels.push(panel);
    }
    if panels.is_empty() {
        return Ok(None);
    }
    let legend: Vec<Entry> = (families.iter().enumerate())
        .map(|(i, f)| {
            let look = curve_style(i);
            Entry::line(
                &f.name(record, None),
                Stroke::dashed(look.ink, 1.8, look.dash),
            )
        })
        .collect();
    Ok(Some(chart(
        "scan_distribution.svg",
        "Distribution of the results",
        "Share of the samples that do not exceed a value.",
        &legend,
        &panels,
    )?))
}

/// Sensitivity indices with their intervals, a panel for each output.
fn sensitivity(record: &ScanRecord) -> Result<Chart, DrawError> {
    let axes: Vec<usize> = (0..record.axes.len())
        .filter(|a| record.indices.iter().any(|i| i.axis == *a))
        .collect();
    let x = Axis::linear(-0.5, axes.len() as f64 - 0.5);
    let ticks: Vec<(f64, String)> = (axes.iter().enumerate())
        .map(|(i, a)| (i as f64, short_name(&record.axes[*a].keys[0]).to_owned()))
        .collect();
    let several = record.configurations.len().min(MOST_CURVES);
    let mut panels = Vec::new();
    for output in 0..record.outputs.len().min(MOST_PANELS) {
        let mut curves = Vec::new();
        for configuration in 0..several {
            let look = curve_style(configuration);
            let (mut first, mut total) = (Vec::new(), Vec::new());
            let own = (record.indices.iter())
                .filter(|s| (s.configuration, s.output) == (configuration, output));
            // Of several combinations of listed values the first one is drawn; the table has all.
            for s in own.filter(|s| s.at.iter().all(|at| *at == 0)) {
                let Some(i) = axes.iter().position(|a| *a == s.axis) else {
                    continue;
                };
                let shift = 0.12 * (configuration as f64 - 0.5 * (several as f64 - 1.0));
                for (value, points, side) in
                    [(s.first, &mut first, -0.03), (s.total, &mut total, 0.03)]
                {
                    let x = i as f64 + shift + side;
                    points.push((x, value[0]));
                    let thin = Stroke::new(look.ink, 1.0);
                    curves.push(Curve::line(thin, vec![(x, value[1]), (x, value[2])]));
                }
            }
            curves.push(Curve::points(look, 4.0, true, first));
            curves.push(Curve::points(look, 4.0, false, total));
        }
        let mut panel = Panel::new(140.0, &x, "share of variance").curves(curves);
        panel.remark = output_text(&record.outputs[output]).0;
        panel.x_ticks = ticks.clone();
        panel.y = Some(Axis::linear(-0.05, 1.05));
        panel.limits = vec![(0.0, String::new())];
        panels.push(panel);
    }
    if let Some(last) = panels.last_mut() {
        last.x_name = Some(String::from("axis"));
    }
    let mut legend: Vec<Entry> = (record.configurations.iter().take(several).enumerate())
        .map(|(i, c)| Entry::marked(&c.label, curve_style(i), true))
        .collect();
    legend.push(Entry::line(
        "filled: first order, open: total",
        Stroke::new(Ink::PALE, 1.0),
    ));
    chart(
        "scan_sensitivity.svg",
        "Sensitivity",
        "Share of the variance of each result that an axis causes alone (first order), and alone and together with other \
         axes (total), with 95 % intervals.",
        &legend,
        &panels,
    )
}
