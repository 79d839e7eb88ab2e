//! CSV tables of an identification: parameters, residuals, profiles, and histories for measured curves.

use super::{DataRecord, FitHistory, FitRecord, IdentifyRecord, ParameterRecord, ProfileRecord};
use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::markup::column::Format;

/// Returns the tables that a record has data for.
pub fn tables(part: &IdentifyRecord) -> Vec<CsvTable> {
    let fits = part.fits.as_slice();
    let data = || (fits.iter()).flat_map(|f| f.data.iter().map(move |d| (f, d)));
    let of_parameters = fits
        .iter()
        .flat_map(|f| f.parameters.iter().map(move |p| (f, p)));
    let points = data().flat_map(|(f, d)| (0..d.abscissa.len()).map(move |i| (f, d, i)));
    let mut all = vec![
        parameters().table(of_parameters),
        fitted().table(data()),
        residuals().table(points),
    ];
    if fits.iter().any(|f| !f.profiles.is_empty()) {
        let rows = fits
            .iter()
            .flat_map(|f| f.profiles.iter().map(move |p| (f, p)));
        let rows = rows.flat_map(|(f, p)| (0..p.value.len()).map(move |i| (f, p, i)));
        all.push(profiles().table(rows));
    }
    if !part.histories.is_empty() {
        let mut names: Vec<&str> = Vec::new();
        for column in (part.histories.iter()).flat_map(|h| &h.series.columns) {
            if !names.contains(&column.name.as_str()) {
                names.push(&column.name);
            }
        }
        let rows = part.histories.iter();
        let rows = rows.flat_map(|h| (0..h.series.len()).map(move |i| (h, i)));
        all.push(histories(&names).table(rows));
    }
    all
}

type Parameter<'a> = (&'a FitRecord, &'a ParameterRecord);
type Data<'a> = (&'a FitRecord, &'a DataRecord);
type Residual<'a> = (&'a FitRecord, &'a DataRecord, usize);
type Profile<'a> = (&'a FitRecord, &'a ProfileRecord, usize);

#[rustfmt::skip]
pub fn parameters<'a>() -> Columns<'a, Parameter<'a>> {
    Columns::<Parameter<'_>>::of("identify.csv", "`identify`: one row per parameter of a fit.")
        .model(|(f, _)| f.label.clone())
        .add("parameter", "key of a parameter, with its unit at the end", |(_, p)| p.key.clone()).shown("Key", Format::Text)
        .add("outcome", "`identified`; `at bound`: the best fit is beyond a bound; `held`: given, not fitted; `not identifiable`: the data do not determine it", |(_, p)| p.outcome).shown("Outcome", Format::Text).result()
        .add("value", "its value, held or fitted, in the unit of the parameter", |(_, p)| p.value)
        .add("low_95", "lower end of the 95 % interval, empty where it is open", |(_, p)| p.low)
        .add("high_95", "upper end of the 95 % interval", |(_, p)| p.high)
        .add("freedom", "degrees of freedom of its variance", |(_, p)| p.freedom).shown("Degrees of freedom", Format::Numbers(3))
        .add("by_profile", "the interval is that of the profile, because the problem is not linear in it", |(_, p)| p.by_profile)
}

#[rustfmt::skip]
pub fn fitted<'a>() -> Columns<'a, Data<'a>> {
    Columns::<Data<'_>>::of("identify_data.csv", "`identify`: one row per data set of a fit.")
        .model(|(f, _)| f.label.clone())
        .add("against", "data set", |(_, d)| d.name.clone()).shown("Data", Format::Text)
        .add("validation", "validation data, not fitted", |(_, d)| d.validation)
        .add("weight", "weight of the data's residuals over their size", |(_, d)| d.weight).shown("Weight", Format::Numbers(3))
        .add("error_l2", "relative L2 error of the fitted model", |(_, d)| d.l2).shown("Error, L2", Format::Percents(3)).result()
        .add("peak_force_rel", "error of the peak force", |(_, d)| d.peak_rel).shown("Peak", Format::Deviations).result()
        .add("impulse_rel", "error of the impulse", |(_, d)| d.impulse_rel).shown("Impulse", Format::Deviations).result()
        .add("correlation_lag1", "autocorrelation of the residuals at lag 1", |(_, d)| d.correlation_lag1).shown("Residuals, lag 1", Format::Numbers(3))
}

#[rustfmt::skip]
pub fn residuals<'a>() -> Columns<'a, Residual<'a>> {
    Columns::<Residual<'_>>::of("identify_residuals.csv", "`identify`: one row per point of a data set.")
        .model(|(f, ..)| f.label.clone())
        .add("against", "data set", |(_, d, _)| d.name.clone())
        .add("abscissa", "time of a force in s, position of a compliance in base pitches", |(_, d, i)| d.abscissa[*i])
        .add("measured", "the data in N or m/N", |(_, d, i)| d.data.get(*i).copied())
        .add("modelled", "the fitted model, in the same unit", |(_, d, i)| d.model.get(*i).copied())
        .add("residual_value", "model minus data, in the same unit", |(_, d, i)| Some(d.model.get(*i)? - d.data.get(*i)?))
}

#[rustfmt::skip]
pub fn profiles<'a>() -> Columns<'a, Profile<'a>> {
    Columns::<Profile<'_>>::of("identify_profiles.csv", "`identify`: one row per value of a parameter at which the others were fitted.")
        .model(|(f, ..)| f.label.clone())
        .add("parameter", "key of the parameter, with its unit at the end", |(_, p, _)| p.key.clone())
        .add("value", "value at which it is held", |(_, p, i)| p.value[*i])
        .add("deviation", "signed root of the scaled increase of the sum of squares with the parameter held at the value", |(_, p, i)| p.deviation.get(*i).copied())
}

#[rustfmt::skip]
pub fn histories<'a>(names: &[&'a str]) -> Columns<'a, (&'a FitHistory, usize)> {
    let columns = Columns::<(&FitHistory, usize)>::of(
        "identify_histories.csv",
        "`identify --measured`: histories of the scene with the initial and the identified constants, one row per time; further columns \
         are those of histories above.",
    )
    .model(|(h, _)| h.label.clone())
    .add("constants", "constants that the model ran with: `initial` or `identified`", |(h, _)| h.constants)
    .add("time_s", "time", |(h, i)| h.series.time_s[*i]);
    let value = |name: &'a str| move |(h, i): &(&FitHistory, usize)| h.series.column(name)?.get(*i).copied();
    (names.iter()).fold(columns, |all, name| all.add(*name, "", value(name)))
}
