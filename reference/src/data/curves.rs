//! Curves of a table: ordinates over the first column of numbers, in SI units.
//!
//! The first column of numbers is the abscissa, every further one is a curve. A heading is a name in SI units, such as
//! `mesh_frequency_hz`, or the same name with another unit: `mesh_frequency [kHz]`, `transmission_error_rms_um`. Columns of
//! texts, such as `model` or `gear`, tell curves of one heading apart.

use super::read::Numbers;
use super::table::{MOST_ROWS, Row, Rows, TableError, shown};
use super::units;

/// A curve: ordinates over abscissae.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Name of the abscissa, with its SI unit as the ending.
    pub abscissa: String,
    /// Name of the ordinate likewise.
    pub ordinate: String,
    /// Texts of its rows: heading and text.
    pub texts: Vec<(String, String)>,
    /// Abscissae of the curve, strictly ascending.
    pub x: Vec<f64>,
    /// Ordinates of the curve.
    pub y: Vec<f64>,
}

/// Abscissa and ordinate of each point, and the place of its row.
type Points = Vec<(f64, f64, usize)>;

/// The curves of a table.
///
/// # Errors
/// [`TableError`] with line and column: what was expected, what was found, a way out.
pub fn curves(text: &str) -> Result<Vec<Curve>, TableError> {
    let help = "a line of names as in the tables of a study, then rows of numbers";
    let mut rows = Rows::of(text, None);
    let mut head = Row::default();
    if !rows.next(&mut head)? {
        return Err(rows.error(&head, "", "a table", "nothing", help));
    }
    let mut body: Vec<Row> = Vec::new();
    let mut row = Row::default();
    while rows.next(&mut row)? {
        if body.len() == MOST_ROWS {
            let expected = format!("at most {MOST_ROWS} rows");
            return Err(rows.error(&row, "", &expected, "more", "keep every n-th row"));
        }
        body.push(row.clone());
    }
    let mut numbers = Numbers::of(&rows, None);
    let cell = |row: &Row, i: usize| row.cells.get(i).unwrap_or_default().to_owned();
    let given = |i: usize| (body.iter().map(move |r| cell(r, i))).filter(|c| !c.is_empty());
    let (mut numeric, mut texts) = (Vec::new(), Vec::new());
    for i in 0..head.cells.len() {
        // Which sign numbers have is not known before they are read.
        let is_number = |c: String| c.replace(',', ".").parse::<f64>().is_ok();
        match (given(i).next(), given(i).any(is_number)) {
            (None, _) => {}
            (Some(_), true) => numeric.push(i),
            (Some(_), false) => texts.push(i),
        }
    }
    let Some((&x, ys)) = numeric.split_first().filter(|(_, ys)| !ys.is_empty()) else {
        return Err(rows.error(&head, "", "two columns of numbers", "fewer", help));
    };
    let named = |i: usize| {
        let name = cell(&head, i);
        units::in_si(&name).map_err(|unit| {
            let help = format!(
                "the unit {} is not known; units: {}",
                shown(&unit),
                units::all()
            );
            rows.error_in(&head, (i, &name), "a name, or a name with a unit", &help)
        })
    };
    let (abscissa, x_factor) = named(x)?;
    let mut found: Vec<(Curve, Points)> = Vec::new();
    for &y in ys {
        let (ordinate, y_factor) = named(y)?;
        for (place, row) in body.iter().enumerate() {
            let mut number = |i: usize, factor: f64| -> Result<Option<f64>, TableError> {
                match cell(row, i).as_str() {
                    "" => Ok(None),
                    text => numbers
                        .read(text, factor)
                        .map(Some)
                        .map_err(|(expected, help)| {
                            rows.error_in(row, (i, &cell(&head, i)), expected, help)
                        }),
                }
            };
            let Some((a, b)) = number(x, x_factor)?.zip(number(y, y_factor)?) else {
                continue;
            };
            let texts: Vec<(String, String)> = (texts.iter())
                .map(|&i| (cell(&head, i), cell(row, i)))
                .collect();
            let is_it = |c: &Curve| c.ordinate == ordinate && c.texts == texts;
            let index = found.iter().position(|(c, _)| is_it(c)).unwrap_or_else(|| {
                let curve = Curve {
                    abscissa: abscissa.clone(),
                    ordinate: ordinate.clone(),
                    texts,
                    ..Curve::default()
                };
                found.push((curve, Vec::new()));
                found.len() - 1
            });
            found[index].1.push((a, b, place));
        }
    }
    for (curve, points) in &mut found {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let Some(w) = points.windows(2).find(|w| w[0].0 == w[1].0) {
            let help =
                "distinguish curves by a column of texts, such as `model`, or average the rows";
            let name = cell(&head, x);
            let expected = "a value that no other row of the curve has";
            return Err(rows.error_in(&body[w[1].2], (x, &name), expected, help));
        }
        (curve.x, curve.y) = points.iter().map(|(a, b, _)| (*a, *b)).unzip();
    }
    Ok(found.into_iter().map(|(curve, _)| curve).collect())
}
