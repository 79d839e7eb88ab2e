//! `--measured FILE.csv`: measured curves to be compared with the tables of a study.
//!
//! The first column of numbers is the abscissa, every further one is a curve. Columns are called as in the tables of the
//! study (docs/data.md), or the same with another unit: `mesh_frequency [kHz]`, `transmission_error_rms_um`. Columns of texts,
//! such as `model` or `gear`, choose the rows of the tables that the curve belongs to.

use super::terminal::Refusal;
use gearbench_reference::{data, files};
use gearbench_reports::measured::MeasuredCurve;
use std::path::Path;

/// Size of a file that is read at most [bytes].
const LARGEST: u64 = 1 << 26;

/// Units with the ending of the column in SI units and the factor to it.
const UNITS: [(&str, &str, f64); 22] = [
    ("Hz", "_hz", 1.0),
    ("kHz", "_hz", 1e3),
    ("s", "_s", 1.0),
    ("ms", "_s", 1e-3),
    ("us", "_s", 1e-6),
    ("m", "_m", 1.0),
    ("mm", "_m", 1e-3),
    ("um", "_m", 1e-6),
    ("nm", "_m", 1e-9),
    ("N", "_n", 1.0),
    ("kN", "_n", 1e3),
    ("N/m", "_n_per_m", 1.0),
    ("N/mm", "_n_per_m", 1e3),
    ("N/um", "_n_per_m", 1e6),
    ("rad/s", "_rad_s", 1.0),
    ("rpm", "_rad_s", std::f64::consts::PI / 30.0),
    ("1/min", "_rad_s", std::f64::consts::PI / 30.0),
    ("N m", "_nm", 1.0),
    ("Nm", "_nm", 1.0),
    ("m/s", "_m_s", 1.0),
    ("-", "", 1.0),
    ("1", "", 1.0),
];
/// Endings of names in other units than SI.
const ENDINGS: [(&str, &str); 7] = [
    ("_khz", "kHz"),
    ("_um", "um"),
    ("_mm", "mm"),
    ("_kn", "kN"),
    ("_n_per_um", "N/um"),
    ("_rpm", "rpm"),
    ("_ms", "ms"),
];

/// The column of a study that a heading means, and the factor to its unit; the error is the unit that is not known.
fn column(heading: &str) -> Result<(String, f64), String> {
    let heading = heading.trim();
    let bracketed = [('[', ']'), ('(', ')')]
        .into_iter()
        .find_map(|(open, close)| {
            let (name, rest) = heading.split_once(open)?;
            Some((name.trim(), rest.strip_suffix(close)?.trim()))
        });
    let by_ending =
        || (ENDINGS.iter()).find_map(|(ending, unit)| Some((heading.strip_suffix(ending)?, *unit)));
    let Some((stem, unit)) = bracketed.or_else(by_ending) else {
        return Ok((heading.to_owned(), 1.0));
    };
    let plain = unit.replace(['µ', 'μ'], "u");
    let known = UNITS.iter().find(|(name, ..)| *name == plain);
    let (_, si, factor) = known.ok_or(unit)?;
    Ok((format!("{}{si}", stem.replace(' ', "_")), *factor))
}

/// The curves of a file.
///
/// # Errors
/// [`Refusal::Input`] with the line at which the file is not a table of measured curves.
pub fn read(path: &Path) -> Result<Vec<MeasuredCurve>, Refusal> {
    const TABLE: &str = "expected a CSV file: a line of names as in the tables of the study (docs/data.md), then rows of numbers";
    let source = path.display().to_string();
    let refuse = |what: String, help: &str| {
        let help = help.to_owned();
        Refusal::Input(miette::miette!(help = help, "--measured {source}: {what}"))
    };
    let bytes = files::read(path, LARGEST).map_err(|e| refuse(e.to_string(), TABLE))?;
    let (text, _) = data::decode(&bytes).map_err(|e| {
        refuse(
            format!("expected {}, found {}", e.expected, e.found),
            &e.help,
        )
    })?;
    let mut heads = text.lines().map(str::trim);
    let head = heads.find(|l| !l.is_empty() && !l.starts_with('#'));
    let head = head.ok_or_else(|| refuse("the file has no line of names".into(), TABLE))?;
    let separators = [b'\t', b';', b','];
    let separator = separators
        .into_iter()
        .find(|d| head.contains(char::from(*d)));
    let separator = separator.unwrap_or(b',');
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .delimiter(separator)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let heads = reader
        .headers()
        .map_err(|e| refuse(e.to_string(), TABLE))?
        .clone();
    let mut rows: Vec<(u64, csv::StringRecord)> = Vec::new();
    for row in reader.records() {
        let row = row.map_err(|e| refuse(e.to_string(), TABLE))?;
        let line = row.position().map_or(0, csv::Position::line);
        if row.iter().any(|c| !c.is_empty()) {
            rows.push((line, row));
        }
    }
    // Where commas do not separate columns they may stand for the decimal point.
    let number = |cell: &str| -> Option<f64> {
        let plain = match separator {
            b',' => cell.to_owned(),
            _ => cell.replace(',', "."),
        };
        plain.parse().ok().filter(|x: &f64| x.is_finite())
    };
    let cells = |i: usize| {
        rows.iter()
            .filter_map(move |(_, r)| r.get(i))
            .filter(|c| !c.is_empty())
    };
    let (mut numeric, mut texts) = (Vec::new(), Vec::new());
    for i in 0..heads.len() {
        match (
            cells(i).next().is_some(),
            cells(i).any(|c| number(c).is_some()),
        ) {
            (false, _) => {}
            (true, true) => numeric.push(i),
            (true, false) => texts.push(i),
        }
    }
    let Some((&x, ys)) = numeric.split_first().filter(|(_, ys)| !ys.is_empty()) else {
        return Err(refuse(
            "the file has no two columns of numbers".into(),
            TABLE,
        ));
    };
    for (line, row) in &rows {
        for &i in &numeric {
            let cell = row.get(i).unwrap_or_default();
            if !cell.is_empty() && number(cell).is_none() {
                let what = format!(
                    "line {line}, column `{}`: `{cell}` is not a number",
                    &heads[i]
                );
                return Err(refuse(what, "leave cells without a value empty"));
            }
        }
    }
    let named = |i: usize| {
        column(&heads[i]).map_err(|unit| {
            let known: Vec<&str> = UNITS.iter().map(|u| u.0).collect();
            let what = format!("column `{}`: the unit `{unit}` is not known", &heads[i]);
            refuse(what, &format!("units: {}", known.join(", ")))
        })
    };
    let (abscissa, x_factor) = named(x)?;
    let mut curves: Vec<MeasuredCurve> = Vec::new();
    for &y in ys {
        let (ordinate, y_factor) = named(y)?;
        for (_, row) in &rows {
            let cell = |i: usize| row.get(i).and_then(number);
            let Some((a, b)) = cell(x).zip(cell(y)) else {
                continue;
            };
            let only: Vec<(String, String)> = (texts.iter())
                .map(|&i| {
                    (
                        heads[i].to_owned(),
                        row.get(i).unwrap_or_default().to_owned(),
                    )
                })
                .collect();
            let is_it = |c: &MeasuredCurve| c.ordinate == ordinate && c.only == only;
            let place = curves.iter().position(is_it).unwrap_or_else(|| {
                curves.push(MeasuredCurve {
                    source: source.clone(),
                    abscissa: abscissa.clone(),
                    ordinate: ordinate.clone(),
                    only,
                    ..MeasuredCurve::default()
                });
                curves.len() - 1
            });
            curves[place].x.push(a * x_factor);
            curves[place].y.push(b * y_factor);
        }
    }
    for curve in &mut curves {
        let points = curve.x.iter().copied().zip(curve.y.iter().copied());
        let mut points: Vec<(f64, f64)> = points.collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let Some(w) = points.windows(2).find(|w| w[0].0 == w[1].0) {
            let what = format!("two rows have {} as `{}`", w[0].0, curve.abscissa);
            let help = "tell curves apart by a column of texts, such as `model`, or average them";
            return Err(refuse(what, help));
        }
        (curve.x, curve.y) = points.into_iter().unzip();
    }
    Ok(curves)
}

#[cfg(test)]
mod tests {
    use super::column;

    #[test]
    fn headings_are_columns_of_the_study_in_si_units() {
        for (heading, name, factor) in [
            ("mesh_frequency_hz", "mesh_frequency_hz", 1.0),
            ("mesh_frequency [kHz]", "mesh_frequency_hz", 1e3),
            (
                "transmission error rms (µm)",
                "transmission_error_rms_m",
                1e-6,
            ),
            (
                "transmission_error_rms_um",
                "transmission_error_rms_m",
                1e-6,
            ),
            ("position_base_pitches", "position_base_pitches", 1.0),
            ("speed [1/min]", "speed_rad_s", std::f64::consts::PI / 30.0),
        ] {
            assert_eq!(column(heading), Ok((name.to_owned(), factor)), "{heading}");
        }
        assert_eq!(column("speed [furlong]"), Err("furlong".into()));
    }
}
