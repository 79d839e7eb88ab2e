//! CSV tables of an identification: parameters, residuals, profiles, and histories for measured curves.

use super::{DataRecord, FitHistory, FitRecord, IdentifyRecord, ParameterRecord, ProfileRecord};
use crate::csv_table::{CsvTable, number};

/// Returns the tables that a record has data for.
pub fn tables(part: &IdentifyRecord) -> Vec<CsvTable> {
    let fits = part.fits.as_slice();
    let mut all = vec![parameters(fits), fitted(fits), residuals(fits)];
    if fits.iter().any(|f| !f.profiles.is_empty()) {
        all.push(profiles(fits));
    }
    if !part.histories.is_empty() {
        all.push(histories(&part.histories));
    }
    all
}

fn parameters(fits: &[FitRecord]) -> CsvTable {
    type Row<'a> = (&'a FitRecord, &'a ParameterRecord);
    let rows = fits
        .iter()
        .flat_map(|f| f.parameters.iter().map(move |p| (f, p)));
    CsvTable::new::<Row<'_>>(
        "identify.csv",
        rows,
        &[
            ("model", &|(f, _)| f.label.clone()),
            ("parameter", &|(_, p)| p.key.clone()),
            ("outcome", &|(_, p)| p.outcome.to_string()),
            ("value", &|(_, p)| number(p.value)),
            ("low_95", &|(_, p)| number(p.low)),
            ("high_95", &|(_, p)| number(p.high)),
            ("freedom", &|(_, p)| number(p.freedom)),
            ("by_profile", &|(_, p)| p.by_profile.to_string()),
        ],
    )
}

fn fitted(fits: &[FitRecord]) -> CsvTable {
    type Row<'a> = (&'a FitRecord, &'a DataRecord);
    let rows = fits.iter().flat_map(|f| f.data.iter().map(move |d| (f, d)));
    CsvTable::new::<Row<'_>>(
        "identify_data.csv",
        rows,
        &[
            ("model", &|(f, _)| f.label.clone()),
            ("against", &|(_, d)| d.name.clone()),
            ("validation", &|(_, d)| d.validation.to_string()),
            ("weight", &|(_, d)| number(d.weight)),
            ("error_l2", &|(_, d)| number(d.l2)),
            ("peak_force_rel", &|(_, d)| number(d.peak_rel)),
            ("impulse_rel", &|(_, d)| number(d.impulse_rel)),
            ("correlation_lag1", &|(_, d)| number(d.correlation_lag1)),
        ],
    )
}

fn residuals(fits: &[FitRecord]) -> CsvTable {
    type Row<'a> = (&'a FitRecord, &'a DataRecord, usize);
    let rows = fits.iter().flat_map(|f| {
        (f.data.iter()).flat_map(move |d| (0..d.abscissa.len()).map(move |i| (f, d, i)))
    });
    CsvTable::new::<Row<'_>>(
        "identify_residuals.csv",
        rows,
        &[
            ("model", &|(f, ..)| f.label.clone()),
            ("against", &|(_, d, _)| d.name.clone()),
            ("abscissa", &|(_, d, i)| number(d.abscissa[*i])),
            ("measured", &|(_, d, i)| number(d.data.get(*i).copied())),
            ("modelled", &|(_, d, i)| number(d.model.get(*i).copied())),
            ("residual_value", &|(_, d, i)| {
                let both = d.model.get(*i).zip(d.data.get(*i));
                number(both.map(|(a, b)| a - b))
            }),
        ],
    )
}

fn profiles(fits: &[FitRecord]) -> CsvTable {
    type Row<'a> = (&'a FitRecord, &'a ProfileRecord, usize);
    let rows = fits.iter().flat_map(|f| {
        (f.profiles.iter()).flat_map(move |p| (0..p.value.len()).map(move |i| (f, p, i)))
    });
    CsvTable::new::<Row<'_>>(
        "identify_profiles.csv",
        rows,
        &[
            ("model", &|(f, ..)| f.label.clone()),
            ("parameter", &|(_, p, _)| p.key.clone()),
            ("value", &|(_, p, i)| number(p.value[*i])),
            ("deviation", &|(_, p, i)| {
                number(p.deviation.get(*i).copied())
            }),
        ],
    )
}

/// Returns the table of histories with every column that any of them has, a row per time.
fn histories(all: &[FitHistory]) -> CsvTable {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in all.iter().flat_map(|h| h.series.named_columns()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let rows = all.iter().flat_map(|h| {
        let columns: Vec<Option<&[f64]>> = names.iter().map(|n| h.series.column(n)).collect();
        (0..h.series.len()).map(move |i| {
            let value = |c: &Option<&[f64]>| number(c.and_then(|c| c.get(i).copied()));
            let head = [
                h.label.clone(),
                h.constants.to_string(),
                number(h.series.time_s[i]),
            ];
            head.into_iter().chain(columns.iter().map(value)).collect()
        })
    });
    let header = ["model", "constants", "time_s"].into_iter();
    CsvTable {
        file: "identify_histories.csv".into(),
        rows: rows.collect(),
        header: header
            .chain(names.iter().copied())
            .map(str::to_owned)
            .collect(),
    }
}
