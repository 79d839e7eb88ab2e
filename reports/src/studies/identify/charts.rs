//! Charts of an identification: data with the fitted models, residuals, profiles.

use super::tables::axis_names;
use super::{DataKind, FitRecord};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart, extremes};
use crate::drawing::style::{curve_style, model_stroke, reference_stroke};

/// Draws the charts of a record.
pub fn charts(fits: &[FitRecord]) -> Result<Vec<Chart>, DrawError> {
    let mut all = Vec::new();
    all.extend(fitted(fits)?);
    all.extend(profiles(fits)?);
    Ok(all)
}

/// Returns the names of the data sets in the order of appearance.
fn names(fits: &[FitRecord]) -> Vec<&str> {
    let mut all: Vec<&str> = Vec::new();
    for d in fits.iter().flat_map(|f| &f.data) {
        if !all.contains(&d.name.as_str()) {
            all.push(&d.name);
        }
    }
    all
}

fn fitted(fits: &[FitRecord]) -> Result<Option<Chart>, DrawError> {
    let mut panels = Vec::new();
    for name in names(fits) {
        let sets: Vec<_> = (fits.iter().enumerate())
            .filter_map(|(i, f)| Some((i, f.data.iter().find(|d| d.name == name)?)))
            .filter(|(_, d)| d.abscissa.len() > 1)
            .collect();
        let Some((_, first)) = sets.first() else {
            continue;
        };
        let (fx, fy) = match first.kind {
            DataKind::Force => (1e6, 1.0),
            DataKind::Torque | DataKind::Speed | DataKind::Angle => (1e3, 1.0),
            DataKind::Compliance => (1.0, 1e9),
        };
        let scaled = |x: &[f64], by: f64| -> Vec<f64> { x.iter().map(|x| by * x).collect() };
        let x = scaled(&first.abscissa, fx);
        let (low, high) = extremes(x.iter().copied());
        let axis = Axis::linear(low, high);
        let [x_name, y_name] = axis_names(first.kind);
        let reference = Curve::history(reference_stroke(0), &axis, &x, &scaled(&first.data, fy));
        let of_models = sets.iter().map(|(i, d)| {
            Curve::history(
                model_stroke(*i),
                &axis,
                &scaled(&d.abscissa, fx),
                &scaled(&d.model, fy),
            )
            .along(Some(*i))
        });
        let heading = match first.validation {
            true => format!("{name} (not fitted)"),
            false => name.to_owned(),
        };
        panels.push(
            Panel::new(200.0, &axis, y_name)
                .remark(heading)
                .curves(std::iter::once(reference).chain(of_models)),
        );
        let differences = sets.iter().map(|(i, d)| {
            let r: Vec<f64> = (d.model.iter().zip(&d.data))
                .map(|(a, b)| fy * (a - b))
                .collect();
            Curve::history(model_stroke(*i), &axis, &scaled(&d.abscissa, fx), &r)
        });
        let zero = Curve::line(Stroke::new(Ink::GREY, 0.8), vec![(low, 0.0), (high, 0.0)]);
        let unit = y_name.split_once('[').map_or("", |(_, unit)| unit);
        panels.push(Panel {
            x_name: Some(x_name.into()),
            ..Panel::new(110.0, &axis, &format!("residual [{unit}"))
                .curves(std::iter::once(zero).chain(differences))
        });
    }
    if panels.is_empty() {
        return Ok(None);
    }
    let mut legend = vec![Entry::line("data", reference_stroke(0))];
    legend.extend(
        (fits.iter().enumerate()).map(|(i, f)| Entry::history(&f.label, model_stroke(i), Some(i))),
    );
    chart(
        "identify.svg",
        "Data and fitted models",
        "The data (dark), what the fitted models make of them, and below the residuals, model less data.",
        &legend,
        &panels,
    )
    .map(Some)
}

fn profiles(fits: &[FitRecord]) -> Result<Option<Chart>, DrawError> {
    let mut panels = Vec::new();
    for (i, f) in fits.iter().enumerate() {
        for p in f.profiles.iter().filter(|p| p.value.len() > 1) {
            let points: Vec<(f64, f64)> = (p.value.iter().copied())
                .zip(p.deviation.iter().map(|d| d.abs()))
                .collect();
            let (low, high) = extremes(p.value.iter().copied());
            if low >= high {
                continue;
            }
            panels.push(Panel {
                x_name: Some(f.axis_name(&p.key)),
                limits: vec![(p.quantile, "95 %".into())],
                ..Panel::new(130.0, &Axis::padded(low, high, 0.02), "deviation")
                    .remark(f.label.clone())
                    .curves([Curve::joined(curve_style(i), 1.6, 3.6, points)])
            });
        }
    }
    if panels.is_empty() {
        return Ok(None);
    }
    chart(
        "identify_profiles.svg",
        "Profiles",
        "How much worse the fit gets with one parameter held and all others fitted again, in standard errors. Straight \
         sides that are equally steep mean that the interval is that of the linear problem; the interval is what lies \
         below the dashed line.",
        &[],
        &panels,
    )
    .map(Some)
}
