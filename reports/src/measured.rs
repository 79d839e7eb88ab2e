//! Measured curves, compared with the tables of a study.
//!
//! Every study writes its results as tables ([`CsvTable`]), whose columns have fixed names with SI units. A measured
//! curve names two of these columns, an abscissa and an ordinate. It is compared with every curve of these two in the
//! tables: one per model and per combination of the table's texts (gear, branch, order). With the measured points (x_i,
//! m_i) within the range of a computed curve y(x), which is linear between its rows,
//!
//! ```text
//! error  = sqrt( sum w_i (y(x_i) - m_i)^2 / sum w_i m_i^2 )       w: trapezoidal rule over x
//! height = max y(x_i) / max m_i - 1,   place = x of max y / x of max m - 1
//! ```

use crate::csv_table::{CsvTable, named_unit};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::DrawError;
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart};
use crate::drawing::style::{model_stroke, reference_look};
use crate::markup::table::Table;
use crate::markup::{note, section};
use crate::metrics::{at_times, trapezoid_weights};
use crate::numbers::{Prefix, per_cent};
use crate::series::place_of;
use maud::{Markup, html};
use serde::{Deserialize, Serialize};

/// A measured curve with its abscissa, ordinate and source, as the scene gives it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MeasuredCurve {
    /// File with the measured points.
    pub source: String,
    /// Column of its abscissa in the tables of the study.
    pub abscissa: String,
    /// Column of its ordinate in the tables of the study.
    pub ordinate: String,
    /// Texts by which rows of the tables are chosen: column and text.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub only: Vec<(String, String)>,
    /// Abscissae in SI units, ascending.
    pub x: Vec<f64>,
    /// Ordinates in SI units, one per abscissa.
    pub y: Vec<f64>,
}

/// A computed curve next to a measured one.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparedCurve {
    /// Model, and the texts that distinguish the curve from others of the model.
    pub label: String,
    /// Measured points within the range of the computed curve.
    pub covered: usize,
    /// Relative error over these [-].
    pub error: Option<f64>,
    /// Error of the greatest value [-].
    pub height: Option<f64>,
    /// Error of its place [-].
    pub place: Option<f64>,
    points: Vec<(f64, f64)>,
}

/// Columns of text that describe how a row was computed and do not distinguish curves.
const REMARKS: [&str; 8] = [
    "status",
    "message",
    "holds",
    "limits",
    "includes",
    "calibration",
    "variant",
    "title",
];
/// The table that repeats others.
const RUNS: &str = "runs.csv";

/// Named curves as points.
type Curves = Vec<(String, Vec<(f64, f64)>)>;

impl MeasuredCurve {
    /// Checks the rules that the type does not enforce.
    pub(crate) fn validate(&self) -> Result<(), String> {
        let wrong = |what: &str| Err(format!("{}: {what}", self.source));
        if self.x.len() != self.y.len() {
            return wrong("it has not as many ordinates as abscissae");
        }
        let ascending = self.x.windows(2).all(|w| w[0] < w[1]);
        let finite = self.x.iter().chain(&self.y).all(|x| x.is_finite());
        match ascending && finite {
            true => Ok(()),
            false => wrong("abscissae are to ascend, and values to be finite"),
        }
    }

    /// Returns the heading of the curve: ordinate over abscissa, with the rows it is restricted to.
    fn title(&self) -> String {
        let of = |name: &str| named_unit(name).0.replace('_', " ");
        let only: Vec<&str> = self.only.iter().map(|(_, text)| text.as_str()).collect();
        let only = match only.is_empty() {
            true => String::new(),
            false => format!(" ({})", only.join(", ")),
        };
        format!("{}{only} over {}", of(&self.ordinate), of(&self.abscissa))
    }

    /// Returns the computed curves of its two columns with their errors.
    pub fn compared(&self, tables: &[CsvTable]) -> Vec<ComparedCurve> {
        let has = |t: &CsvTable, name: &str| place_of(&t.header, name).is_some();
        let fits = |t: &&CsvTable| has(t, &self.abscissa) && has(t, &self.ordinate);
        let own = tables.iter().filter(|t| t.file != RUNS).filter(fits);
        let mut own: Vec<&CsvTable> = own.collect();
        if own.is_empty() {
            own.extend(tables.iter().filter(fits));
        }
        let curves = own.into_iter().flat_map(|table| self.curves(table));
        (curves.filter(|(_, points)| points.len() > 1))
            .map(|(label, points)| self.compared_with(label, points))
            .collect()
    }

    /// Returns the curves of a table.
    fn curves(&self, table: &CsvTable) -> Curves {
        let place = |name: &str| place_of(&table.header, name);
        let (Some(x), Some(y)) = (place(&self.abscissa), place(&self.ordinate)) else {
            return Curves::new();
        };
        let number = |row: &[String], i: usize| row.get(i)?.parse::<f64>().ok();
        let is_text = |i: &usize| {
            let mut cells = table.rows.iter().filter_map(|r| r.get(*i));
            cells.any(|c| !c.is_empty() && c.parse::<f64>().is_err())
        };
        let is_remark = |i: &usize| REMARKS.contains(&table.header[*i].as_str());
        let texts = (0..table.header.len()).filter(is_text);
        let texts: Vec<usize> = texts.filter(|i| !is_remark(i)).collect();
        let remark = |row: &[String], name: &str| {
            let cell = place(name).and_then(|i| row.get(i));
            cell.cloned().unwrap_or_default()
        };
        let mut found = Curves::new();
        for row in &table.rows {
            let chosen = |(column, text): &(String, String)| {
                place(column).is_none_or(|i| row.get(i).is_some_and(|c| c == text))
            };
            // A result is compared only where it holds.
            let holds = remark(row, "holds") != "false"
                && ["", "converged", "unchecked"].contains(&remark(row, "status").as_str());
            let point = number(row, x).zip(number(row, y));
            let Some(point) = point.filter(|_| holds && self.only.iter().all(chosen)) else {
                continue;
            };
            let label: Vec<&str> = texts.iter().map(|i| row[*i].as_str()).collect();
            let label = match label.is_empty() {
                true => table.file.trim_end_matches(".csv").to_owned(),
                false => label.join(", "),
            };
            match found.iter_mut().find(|(known, _)| *known == label) {
                Some((_, points)) => points.push(point),
                None => found.push((label, vec![point])),
            }
        }
        for (_, points) in &mut found {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            points.dedup_by(|a, b| a.0 == b.0);
        }
        found
    }

    fn compared_with(&self, label: String, points: Vec<(f64, f64)>) -> ComparedCurve {
        let (xs, ys): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let range = xs.first().zip(xs.last());
        let inside = |x: f64| range.is_some_and(|(a, b)| (*a..=*b).contains(&x));
        let measured = self.x.iter().copied().zip(self.y.iter().copied());
        let (places, wanted): (Vec<f64>, Vec<f64>) = measured.filter(|p| inside(p.0)).unzip();
        let computed = at_times(&xs, &ys, &places);
        let weights = match places.len() {
            1 => vec![1.0],
            _ => trapezoid_weights(&places),
        };
        let (mut missed, mut norm) = (0.0, 0.0);
        for ((m, y), w) in wanted.iter().zip(&computed).zip(weights) {
            missed += w * (y - m).powi(2);
            norm += w * m * m;
        }
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        let top = |values: &[f64]| {
            let highest = (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b]))?;
            Some((places[highest], values[highest]))
        };
        let tops = top(&wanted).zip(top(&computed));
        ComparedCurve {
            label,
            covered: places.len(),
            error: finite((missed / norm).sqrt()),
            height: tops.and_then(|(m, y)| finite(y.1 / m.1 - 1.0)),
            place: tops.and_then(|(m, y)| finite(y.0 / m.0 - 1.0)),
            points,
        }
    }
}

/// Returns a line for each computed curve next to a measured one, for a terminal. A measured curve without matching
/// columns in any table gives one line that states this.
pub fn lines(curves: &[MeasuredCurve], tables: &[CsvTable]) -> Vec<String> {
    let mut said = Vec::new();
    for curve in curves {
        let found = curve.compared(tables);
        if found.is_empty() {
            said.push(format!(
                "{}: {}",
                curve.source,
                nothing_to_compare(curve, tables)
            ));
        }
        for d in found {
            let head = format!("{}: {}, {}", curve.source, curve.title(), d.label);
            said.push(match d.error {
                Some(error) => format!(
                    "{head}: {} off, at {} of {} measured points",
                    per_cent(error, 3),
                    d.covered,
                    curve.x.len()
                ),
                None => format!("{head}: no measured point lies within its range"),
            });
        }
    }
    said
}

/// Returns the reason why no computed curve is compared with a measured one.
fn nothing_to_compare(curve: &MeasuredCurve, tables: &[CsvTable]) -> String {
    let columns = [&curve.abscissa, &curve.ordinate];
    let unknown = |name: &&&String| tables.iter().all(|t| place_of(&t.header, name).is_none());
    match columns.iter().find(unknown) {
        Some(name) => format!("no table of this study has a column `{name}`"),
        None => format!(
            "no table of this study has a curve of `{}` over `{}`",
            curve.ordinate, curve.abscissa
        ),
    }
}

/// Returns the section and the charts of the measured curves of a record.
pub(crate) fn report(
    curves: &[MeasuredCurve],
    tables: &[CsvTable],
) -> Result<(Markup, Vec<Chart>), DrawError> {
    if curves.is_empty() {
        return Ok((Markup::default(), Vec::new()));
    }
    let found: Vec<(&MeasuredCurve, Vec<ComparedCurve>)> =
        curves.iter().map(|c| (c, c.compared(tables))).collect();
    let rows: Vec<(&MeasuredCurve, &ComparedCurve)> = (found.iter())
        .flat_map(|(c, all)| all.iter().map(|d| (*c, d)))
        .collect();
    let table = Table::of(&rows)
        .text("Measured", |(c, _)| c.title())
        .text("Computed", |(_, d)| d.label.clone())
        .key()
        .percents("Error", 3, |(_, d)| d.error)
        .result()
        .deviations("Greatest value", |(_, d)| d.height)
        .deviations("Its place", |(_, d)| d.place)
        .text("Points", |(c, d)| format!("{} of {}", d.covered, c.x.len()))
        .text("File", |(c, _)| c.source.clone());
    let lone: Vec<String> = (found.iter())
        .filter(|(_, all)| all.is_empty())
        .map(|(c, _)| format!("{}: {}.", c.source, nothing_to_compare(c, tables)))
        .collect();
    let remark = "Error: relative root mean square over the measured points within the range of the computed curve, which is \
                  joined by lines. Greatest value and its place: deviations of the computed one.";
    let markup = section(
        "Measured curves",
        html! {
            (table)
            (note(remark))
            @for line in &lone { (note(line)) }
        },
    );
    let charts = (found.iter().enumerate())
        .filter(|(_, (_, all))| !all.is_empty())
        .map(|(i, (c, all))| drawn(i, c, all));
    Ok((markup, charts.collect::<Result<Vec<_>, _>>()?))
}

fn drawn(i: usize, measured: &MeasuredCurve, all: &[ComparedCurve]) -> Result<Chart, DrawError> {
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    let x_prefix = Prefix::of(largest(&measured.x), 1.0);
    let y_prefix = Prefix::of(largest(&measured.y), 1.0);
    let named = |column: &str, prefix: &Prefix| {
        let (stem, unit) = named_unit(column);
        let stem = stem.replace('_', " ");
        match unit {
            "" => stem,
            unit => format!("{stem} [{}{unit}]", prefix.symbol),
        }
    };
    let unitless = |column: &str| named_unit(column).1.is_empty();
    let x_factor = if unitless(&measured.abscissa) {
        1.0
    } else {
        x_prefix.factor
    };
    let y_factor = if unitless(&measured.ordinate) {
        1.0
    } else {
        y_prefix.factor
    };
    let places = || {
        let computed = all.iter().flat_map(|d| d.points.iter().map(|p| p.0));
        let own = measured.x.iter().copied();
        // A single measured point has no range of its own.
        own.chain(computed.filter(|_| measured.x.len() < 2))
    };
    let (first, last) = (
        places().fold(f64::INFINITY, f64::min),
        places().fold(f64::NEG_INFINITY, f64::max),
    );
    let x = Axis::padded(first * x_factor, last * x_factor, 0.05);
    let scaled = |p: &(f64, f64)| (p.0 * x_factor, p.1 * y_factor);
    let mut legend = vec![Entry::marked("measured", reference_look(), true)];
    let mut curves = Vec::new();
    for (style, d) in all.iter().enumerate() {
        legend.push(Entry::history(&d.label, model_stroke(style), Some(style)));
        let (t, y): (Vec<f64>, Vec<f64>) = d.points.iter().map(scaled).unzip();
        curves.push(Curve::history(model_stroke(style), &x, &t, &y).along(Some(style)));
    }
    let points = measured.x.iter().copied().zip(measured.y.iter().copied());
    let points: Vec<(f64, f64)> = points.map(|p| scaled(&p)).collect();
    curves.push(Curve::points(reference_look(), 3.2, true, points));
    let panel = Panel {
        x_name: Some(named(&measured.abscissa, &x_prefix)),
        ..Panel::new(230.0, &x, &named(&measured.ordinate, &y_prefix))
            .curves(curves)
            .close()
    };
    let errors: Vec<String> = (all.iter())
        .filter_map(|d| Some(format!("{} {}", d.label, per_cent(d.error?, 3))))
        .collect();
    let caption = format!(
        "Measured points of {} and the curves of this study. {}",
        measured.source,
        match errors.is_empty() {
            true => "No measured point lies within the range of a curve.".to_owned(),
            false => format!("Errors: {}.", errors.join(", ")),
        }
    );
    let title = format!("Measured: {}", measured.title());
    chart(
        &format!("measured{}.svg", i + 1),
        &title,
        caption,
        &legend,
        &[panel],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peak(x: f64) -> f64 {
        3.0 + (x - 2.0).powi(2).recip().min(4.0)
    }

    fn table(factor: f64) -> CsvTable {
        let row = |model: &str, x: f64, f: f64, status: &str| {
            [
                model.to_owned(),
                status.to_owned(),
                x.to_string(),
                (f * peak(x)).to_string(),
            ]
            .to_vec()
        };
        let xs = || (0..=40).map(|i| 0.1 * f64::from(i));
        CsvTable {
            file: "sweep.csv".into(),
            header: ["model", "status", "mesh_frequency_hz", "force_peak_n"]
                .map(String::from)
                .to_vec(),
            rows: (xs().map(|x| row("rigid", x, factor, "converged")))
                .chain(xs().map(|x| row("elastic", x, 1.0, "converged")))
                .chain(xs().map(|x| row("elastic", x, 9.0, "inaccurate")))
                .collect(),
        }
    }

    fn measured(only: Vec<(String, String)>) -> MeasuredCurve {
        let x: Vec<f64> = (0..=50).map(|i| 0.1 * f64::from(i)).collect();
        MeasuredCurve {
            source: "rig.csv".into(),
            abscissa: "mesh_frequency_hz".into(),
            ordinate: "force_peak_n".into(),
            only,
            y: x.iter().map(|x| peak(*x)).collect(),
            x,
        }
    }

    /// A curve that is 10 % too high has an error of 10 % at the points within its range; unsettled runs are not
    /// compared.
    #[test]
    fn errors_are_those_of_the_points_that_a_curve_covers() {
        let found = measured(Vec::new()).compared(&[table(1.1)]);
        let labels: Vec<&str> = found.iter().map(|d| d.label.as_str()).collect();
        assert_eq!(labels, ["rigid", "elastic"]);
        assert_eq!(found[0].covered, 41);
        let errors = [0, 1].map(|i| found[i].error.unwrap());
        assert!(
            (errors[0] - 0.1).abs() < 1e-9 && errors[1] < 1e-9,
            "{errors:?}"
        );
        assert!((found[0].height.unwrap() - 0.1).abs() < 1e-9);
        assert!(found[0].place.unwrap().abs() < 1e-9);
        let one = measured(vec![("model".into(), "rigid".into())]);
        assert_eq!(one.compared(&[table(1.1)]).len(), 1);
    }

    /// The page has a row and the chart a line for each curve, and the page names curves without a table.
    #[test]
    fn page_and_lines_name_every_curve() {
        let mut other = measured(Vec::new());
        other.ordinate = "speed_rad_s".into();
        let all = [measured(Vec::new()), other];
        let (page, charts) = report(&all, &[table(1.1)]).unwrap();
        let page = page.into_string();
        assert!(
            page.contains("no table of this study has a column `speed_rad_s`"),
            "{page}"
        );
        assert_eq!(charts.len(), 1);
        assert!(charts[0].svg.contains("mesh frequency [Hz]"));
        let said = lines(&all, &[table(1.1)]);
        assert_eq!(said.len(), 3);
        assert!(
            said[0].contains("rigid: 10.0\u{a0}% off, at 41 of 51"),
            "{}",
            said[0]
        );
    }
}
