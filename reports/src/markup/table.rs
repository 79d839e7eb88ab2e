//! Tables of the report: right-aligned numbers, rows grouped by model, empty columns dropped.

use super::escape;
use crate::drawing::style::swatch;
use crate::numbers::{ABSENT, Prefix, power, significant};

/// A column: its heading, unit, and one cell per row.
pub struct Column {
    heading: String,
    unit: String,
    cells: Vec<Option<String>>,
    text: bool,
}

impl Column {
    /// Text, left-aligned.
    pub fn text(heading: &str, cells: Vec<Option<String>>) -> Self {
        Self {
            heading: heading.into(),
            unit: String::new(),
            cells,
            text: true,
        }
    }

    /// Numbers already written.
    pub fn written(heading: &str, unit: &str, cells: Vec<Option<String>>) -> Self {
        Self {
            heading: heading.into(),
            unit: unit.into(),
            cells,
            text: false,
        }
    }

    /// Numbers in SI units: one prefix for the column, by its typical magnitude. Without a unit
    /// the numbers stay as they are.
    pub fn numbers(heading: &str, unit: &str, digits: usize, values: &[Option<f64>]) -> Self {
        let prefix = common_prefix(values.iter().flatten().copied(), unit);
        let cell = |x: f64| {
            x.is_finite()
                .then(|| significant(x * prefix.factor, digits))
        };
        Self::written(
            heading,
            &format!("{}{unit}", prefix.symbol),
            values.iter().map(|x| x.and_then(cell)).collect(),
        )
    }

    /// Spans from least to greatest, with one prefix for the column.
    pub fn ranges(heading: &str, unit: &str, digits: usize, values: &[Option<[f64; 2]>]) -> Self {
        let prefix = common_prefix(values.iter().flatten().map(|r| r[1]), unit);
        let cell = |r: [f64; 2]| {
            let [a, b] = r.map(|x| significant(x * prefix.factor, digits));
            r.iter()
                .all(|x| x.is_finite())
                .then(|| format!("{a}\u{a0}\u{2013}\u{a0}{b}"))
        };
        Self::written(
            heading,
            &format!("{}{unit}", prefix.symbol),
            values.iter().map(|x| x.and_then(cell)).collect(),
        )
    }

    /// Residuals, always as powers of ten.
    pub fn powers(heading: &str, unit: &str, values: &[Option<f64>]) -> Self {
        let cell = |x: f64| x.is_finite().then(|| power(x, 2));
        let cells = values.iter().map(|x| x.and_then(cell)).collect();
        Self::written(heading, unit, cells)
    }

    /// Ratios in per cent.
    pub fn percents(heading: &str, digits: usize, values: &[Option<f64>]) -> Self {
        let cell = |x: f64| x.is_finite().then(|| significant(100.0 * x, digits));
        let cells = values.iter().map(|x| x.and_then(cell)).collect();
        Self::written(heading, "%", cells)
    }

    /// Deviations in per cent, with their sign.
    pub fn deviations(heading: &str, values: &[Option<f64>]) -> Self {
        let cell = |x: f64| {
            let sign = if x > 0.0 { "+" } else { "" };
            x.is_finite()
                .then(|| format!("{sign}{}", significant(100.0 * x, 3)))
        };
        let cells = values.iter().map(|x| x.and_then(cell)).collect();
        Self::written(heading, "%", cells)
    }
}

/// The prefix for the typical magnitude of a column; none without a unit.
fn common_prefix(values: impl Iterator<Item = f64>, unit: &str) -> Prefix {
    let mut sizes: Vec<f64> = values
        .map(f64::abs)
        .filter(|x| x.is_finite() && *x > 0.0)
        .collect();
    sizes.sort_by(f64::total_cmp);
    let typical = sizes.get(sizes.len() / 2).copied().unwrap_or(1.0);
    match unit {
        "" => Prefix::of(1.0, 1.0),
        "N" => Prefix::of(typical, 20.0),
        _ => Prefix::of(typical, 1.0),
    }
}

/// Rows that belong together under one heading.
pub struct Rows {
    /// Heading; none for a plain table.
    pub heading: Option<(String, usize)>,
    /// Number of rows.
    pub count: usize,
    /// Class of each row, or empty.
    pub classes: Vec<&'static str>,
}

/// Writes a table; the groups together have as many rows as each column has cells.
pub fn table(columns: &[Column], groups: &[Rows]) -> String {
    let shown: Vec<&Column> = columns
        .iter()
        .filter(|c| c.cells.iter().any(Option::is_some))
        .collect();
    let mut out = String::from("<div class=\"scroll\"><table>\n<thead><tr>");
    for c in &shown {
        let unit = if c.unit.is_empty() {
            String::new()
        } else {
            format!("<br><span class=\"unit\">{}</span>", escape(&c.unit))
        };
        let class = if c.text { " class=\"t\"" } else { "" };
        out.push_str(&format!("<th{class}>{}{unit}</th>", escape(&c.heading)));
    }
    out.push_str("</tr></thead>\n");
    let mut row = 0;
    for group in groups {
        out.push_str("<tbody>\n");
        if let Some((heading, style)) = &group.heading {
            out.push_str(&format!(
                "<tr class=\"group\"><th colspan=\"{}\"><span class=\"swatch\" \
                 style=\"background:{}\"></span>{}</th></tr>\n",
                shown.len(),
                swatch(*style),
                escape(heading)
            ));
        }
        for i in 0..group.count {
            let class = group.classes.get(i).copied().unwrap_or("");
            out.push_str(&format!("<tr class=\"{class}\">"));
            for c in &shown {
                let cell = c.cells.get(row).and_then(Option::as_deref);
                let class = if c.text { " class=\"t\"" } else { "" };
                out.push_str(&format!(
                    "<td{class}>{}</td>",
                    escape(cell.unwrap_or(ABSENT))
                ));
            }
            out.push_str("</tr>\n");
            row += 1;
        }
        out.push_str("</tbody>\n");
    }
    out.push_str("</table></div>\n");
    out
}
