//! Tables of the report: right-aligned numbers, rows grouped by model, empty columns dropped.

use crate::drawing::style::swatch;
use crate::numbers::{ABSENT, Prefix, power, significant};
use maud::{Markup, Render, html};

/// A table whose columns are functions of its rows.
pub struct Table<'r, R> {
    rows: &'r [R],
    columns: Vec<Column>,
    /// Heading of the group of each row, with the place of its colour.
    groups: Vec<Option<(String, usize)>>,
    classes: Vec<&'static str>,
}

/// A column: its heading, unit, and one cell per row.
struct Column {
    heading: String,
    unit: String,
    cells: Vec<Option<String>>,
    text: bool,
}

impl<'r, R> Table<'r, R> {
    /// A table of some rows without columns.
    pub fn of(rows: &'r [R]) -> Self {
        Self {
            rows,
            columns: Vec::new(),
            groups: rows.iter().map(|_| None).collect(),
            classes: vec![""; rows.len()],
        }
    }

    /// Neighbours of one label stand under it as a heading, beside the colour of that place.
    pub fn grouped(mut self, group: impl Fn(&R) -> (String, usize)) -> Self {
        self.groups = self.rows.iter().map(|r| Some(group(r))).collect();
        self
    }

    /// Classes of rows.
    pub fn classed(mut self, class: impl Fn(&R) -> &'static str) -> Self {
        self.classes = self.rows.iter().map(class).collect();
        self
    }

    fn column(mut self, heading: &str, unit: &str, text: bool, cells: Vec<Option<String>>) -> Self {
        self.columns.push(Column {
            heading: heading.into(),
            unit: unit.into(),
            cells,
            text,
        });
        self
    }

    fn cells<T: Into<Option<String>>>(&self, cell: impl Fn(&R) -> T) -> Vec<Option<String>> {
        let said = |r: &R| cell(r).into().filter(|s| !s.is_empty());
        self.rows.iter().map(said).collect()
    }

    fn values<T: Into<Option<f64>>>(&self, value: impl Fn(&R) -> T) -> Vec<Option<f64>> {
        let finite = |r: &R| value(r).into().filter(|x| x.is_finite());
        self.rows.iter().map(finite).collect()
    }

    /// Text, left-aligned; nothing where it is empty.
    pub fn text<T: Into<Option<String>>>(self, heading: &str, cell: impl Fn(&R) -> T) -> Self {
        let cells = self.cells(cell);
        self.column(heading, "", true, cells)
    }

    /// Numbers already written.
    pub fn written<T: Into<Option<String>>>(
        self,
        heading: &str,
        unit: &str,
        cell: impl Fn(&R) -> T,
    ) -> Self {
        let cells = self.cells(cell);
        self.column(heading, unit, false, cells)
    }

    /// Numbers in SI units: one prefix for the column, by its typical magnitude. Without a unit
    /// the numbers stay as they are.
    pub fn numbers<T: Into<Option<f64>>>(
        self,
        heading: &str,
        unit: &str,
        digits: usize,
        value: impl Fn(&R) -> T,
    ) -> Self {
        let values = self.values(value);
        let prefix = common_prefix(values.iter().flatten().copied(), unit);
        let cell = |x: &Option<f64>| Some(significant((*x)? * prefix.factor, digits));
        let unit = format!("{}{unit}", prefix.symbol);
        let cells = values.iter().map(cell).collect();
        self.column(heading, &unit, false, cells)
    }

    /// Spans from least to greatest, with one prefix for the column.
    pub fn ranges(
        self,
        heading: &str,
        unit: &str,
        digits: usize,
        value: impl Fn(&R) -> Option<[f64; 2]>,
    ) -> Self {
        let values: Vec<Option<[f64; 2]>> = self.rows.iter().map(value).collect();
        let prefix = common_prefix(values.iter().flatten().map(|r| r[1]), unit);
        let cell = |r: &Option<[f64; 2]>| {
            let r = r.filter(|r| r.iter().all(|x| x.is_finite()))?;
            let [a, b] = r.map(|x| significant(x * prefix.factor, digits));
            Some(format!("{a}\u{a0}\u{2013}\u{a0}{b}"))
        };
        let unit = format!("{}{unit}", prefix.symbol);
        let cells = values.iter().map(cell).collect();
        self.column(heading, &unit, false, cells)
    }

    /// Residuals, always as powers of ten.
    pub fn powers<T: Into<Option<f64>>>(
        self,
        heading: &str,
        unit: &str,
        value: impl Fn(&R) -> T,
    ) -> Self {
        let values = self.values(value);
        let cells = values.iter().map(|x| Some(power((*x)?, 2))).collect();
        self.column(heading, unit, false, cells)
    }

    /// Ratios in per cent.
    pub fn percents<T: Into<Option<f64>>>(
        self,
        heading: &str,
        digits: usize,
        value: impl Fn(&R) -> T,
    ) -> Self {
        let values = self.values(value);
        let cell = |x: &Option<f64>| Some(significant(100.0 * (*x)?, digits));
        let cells = values.iter().map(cell).collect();
        self.column(heading, "%", false, cells)
    }

    /// Deviations in per cent, with their sign.
    pub fn deviations<T: Into<Option<f64>>>(self, heading: &str, value: impl Fn(&R) -> T) -> Self {
        let values = self.values(value);
        let cells = values.iter().map(|x| Some(deviation((*x)?))).collect();
        self.column(heading, "%", false, cells)
    }
}

/// A ratio in per cent, with its sign.
fn deviation(x: f64) -> String {
    let sign = if x > 0.0 { "+" } else { "" };
    format!("{sign}{}", significant(100.0 * x, 3))
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

impl<R> Render for Table<'_, R> {
    fn render(&self) -> Markup {
        let any = |c: &&Column| c.cells.iter().any(Option::is_some);
        let shown: Vec<&Column> = self.columns.iter().filter(any).collect();
        let rows: Vec<usize> = (0..self.rows.len()).collect();
        let blocks = rows.chunk_by(|a, b| self.groups[*a] == self.groups[*b]);
        html! {
            div.scroll {
                table {
                    thead {
                        tr {
                            @for c in &shown {
                                th.t[c.text] {
                                    (c.heading)
                                    @if !c.unit.is_empty() { br; span.unit { (c.unit) } }
                                }
                            }
                        }
                    }
                    @for block in blocks {
                        tbody {
                            @if let Some((heading, style)) = &self.groups[block[0]] {
                                tr.group {
                                    th colspan=(shown.len()) {
                                        span.swatch style={ "background:" (swatch(*style)) } {}
                                        (heading)
                                    }
                                }
                            }
                            @for &i in block {
                                tr class=(self.classes[i]) {
                                    @for c in &shown {
                                        td.t[c.text] { (c.cells[i].as_deref().unwrap_or(ABSENT)) }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}
