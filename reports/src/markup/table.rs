//! Tables of the report: right-aligned numbers, rows grouped by model, empty columns dropped, none wider than the page.
//!
//! The table at a glance always has the columns that identify a row ([`Rank::Key`]) and those with the result
//! ([`Rank::Result`]), and as many others as fit the page. The remaining columns are in a second table below, with the
//! same keys. On a narrow screen a table scrolls in its own box.

use super::column::{Column, Format, PAGE, Rank, width};
use super::prose;
use crate::columns::{Column as DeclaredColumn, Columns, Value};
use crate::drawing::style::mark;
use crate::glossary::explained;
use crate::numbers::{
    ABSENT, Prefix, ROUNDING, count, deviation, duration, percent, power, quantity, short,
    significant,
};
use maud::{Markup, Render, html};

/// A table whose columns are functions of its rows.
pub struct Table<'r, R> {
    rows: &'r [R],
    columns: Vec<Column>,
    /// Heading of the group of each row, with the place of its colour.
    groups: Vec<Option<(String, usize)>>,
    classes: Vec<&'static str>,
    /// Index of the run of each row in the record, by which charts find it.
    runs: Vec<Option<usize>>,
}

/// Number of rows from which on a table is folded; all data are in the CSV files.
const LONG: usize = 60;
/// Fraction of the largest magnitude of a column below which a number is rounding error.
const NOTHING: f64 = 1e-9;

impl<'r, R> Table<'r, R> {
    /// Makes a table of some rows without columns.
    pub fn of(rows: &'r [R]) -> Self {
        Self {
            rows,
            columns: Vec::new(),
            groups: rows.iter().map(|_| None).collect(),
            classes: vec![""; rows.len()],
            runs: vec![None; rows.len()],
        }
    }

    /// Groups adjacent rows of one label under a heading with the colour of its style.
    pub fn grouped(mut self, group: impl Fn(&R) -> (String, usize)) -> Self {
        self.groups = self.rows.iter().map(|r| Some(group(r))).collect();
        self
    }

    /// Sets the CSS class of each row.
    pub fn classed(mut self, class: impl Fn(&R) -> &'static str) -> Self {
        self.classes = self.rows.iter().map(class).collect();
        self
    }

    /// Sets the index of the run of each row in the record.
    pub fn of_runs(mut self, index: impl Fn(&R) -> Option<usize>) -> Self {
        self.runs = self.rows.iter().map(index).collect();
        self
    }

    /// Adds a column with given values.
    fn show(self, heading: &str, unit: &str, format: Format, values: Vec<Value>) -> Self {
        let numbers = || values.iter().map(Value::number);
        let each = |f: &dyn Fn(f64) -> String| numbers().map(|x| Some(f(x?))).collect::<Vec<_>>();
        let (unit, cells) = match format {
            Format::Text | Format::Plain => (unit.to_owned(), values.iter().map(text).collect()),
            Format::Counts => {
                let any = numbers().flatten().any(|x| x > 0.0);
                let cells = match any {
                    true => each(&|x| count(x as u64)),
                    false => vec![None; values.len()],
                };
                (unit.to_owned(), cells)
            }
            Format::Numbers(digits) => {
                let prefix = common_prefix(numbers().flatten(), unit);
                let largest = numbers().flatten().fold(0.0_f64, |a, x| a.max(x.abs()));
                let nothing = if unit.is_empty() {
                    0.0
                } else {
                    ROUNDING.max(NOTHING * largest)
                };
                let shown = |x: f64| if x.abs() < nothing { 0.0 } else { x };
                let cells = each(&|x| significant(shown(x) * prefix.factor, digits));
                (format!("{}{unit}", prefix.symbol), cells)
            }
            Format::Durations => (String::new(), each(&duration)),
            Format::Quantities(digits) => (String::new(), each(&|x| quantity(x, unit, digits))),
            Format::Short(digits) => (unit.to_owned(), each(&|x| short(x, digits))),
            Format::Fixed(digits) => {
                let shown = |x: f64| if x.abs() < 1e-6 { 0.0 } else { x };
                (unit.to_owned(), each(&|x| significant(shown(x), digits)))
            }
            Format::Scaled(factor, ref unit, digits) => {
                let cells = each(&|x| significant(x / factor, digits));
                (unit.clone().into_owned(), cells)
            }
            Format::Powers => {
                let nothing = |x: f64| unit.is_empty() && x != 0.0 && x.abs() < ROUNDING;
                let cells = each(&|x| match nothing(x) {
                    true => format!("< {}", power(ROUNDING, 1)),
                    false => power(x, 2),
                });
                (unit.to_owned(), cells)
            }
            Format::Percents(digits) => ("%".into(), each(&|x| percent(x, digits))),
            Format::Deviations => ("%".into(), each(&|x| deviation(x, 3))),
        };
        self.column(heading, unit, format == Format::Text, cells)
    }

    fn column(
        mut self,
        heading: &str,
        unit: String,
        text: bool,
        cells: Vec<Option<String>>,
    ) -> Self {
        // The first column identifies the row.
        let rank = match self.columns.is_empty() {
            true => Rank::Key,
            false => Rank::Detail,
        };
        self.columns.push(Column {
            rank,
            heading: heading.into(),
            unit,
            cells,
            text,
        });
        self
    }

    /// Adds the columns of a declaration that pages show. The cells of a row that has no row of the declaration stay
    /// empty.
    pub fn columns<P>(self, declared: &Columns<'_, P>, row: impl Fn(&'r R) -> Option<P>) -> Self {
        (declared.all.iter()).fold(self, |table, c| table.declared(c, &row))
    }

    /// Adds columns of a declaration in the order of some keys.
    ///
    /// # Panics
    /// If the declaration has no column of a key.
    pub fn columns_by_key<P>(
        self,
        declared: &Columns<'_, P>,
        keys: &[&str],
        row: impl Fn(&'r R) -> Option<P>,
    ) -> Self {
        keys.iter().fold(self, |table, key| {
            let column = declared.all.iter().find(|c| c.key == *key);
            let column = column.unwrap_or_else(|| panic!("there is no column {key}"));
            table.declared(column, &row)
        })
    }

    fn declared<P>(
        self,
        column: &DeclaredColumn<'_, P>,
        row: &impl Fn(&'r R) -> Option<P>,
    ) -> Self {
        let Some((heading, format)) = &column.shown else {
            return self;
        };
        let value = |r: &'r R| row(r).map_or(Value::Absent, |p| (column.value)(&p));
        let values = self.rows.iter().map(value).collect();
        let table = self.show(heading, column.unit(), format.clone(), values);
        match column.rank {
            Rank::Detail => table,
            rank => table.ranked(rank),
        }
    }

    fn ranked(mut self, rank: Rank) -> Self {
        if let Some(column) = self.columns.last_mut() {
            column.rank = rank;
        }
        self
    }

    /// Returns the table at a glance as lines for a terminal: headings with units, then a line for each row; columns
    /// that neither identify a row nor have results are left out.
    pub fn lines(&self) -> Vec<String> {
        let any = |c: &&Column| c.rank != Rank::Detail && c.cells.iter().any(Option::is_some);
        let mut lines = vec![String::new(); 1 + self.rows.len()];
        // The heading of a group is a column of its own where there are several.
        let group = |i: usize| self.groups[i].as_ref().map(|(heading, _)| heading.clone());
        let groups: Vec<Option<String>> = (0..self.rows.len()).map(group).collect();
        let several = groups.windows(2).any(|g| g[0] != g[1]);
        let group = several.then(|| Column {
            rank: Rank::Key,
            heading: "Model".into(),
            unit: String::new(),
            cells: groups,
            text: true,
        });
        for c in group.iter().chain(self.columns.iter().filter(any)) {
            let head = match c.unit.as_str() {
                "" => c.heading.clone(),
                unit => format!("{} [{unit}]", c.heading),
            };
            let cells = c.cells.iter().map(|cell| cell.as_deref().unwrap_or("-"));
            let cells: Vec<&str> = std::iter::once(head.as_str()).chain(cells).collect();
            let width = cells.iter().map(|t| t.chars().count()).max().unwrap_or(0);
            for (line, cell) in lines.iter_mut().zip(cells) {
                if !line.is_empty() {
                    line.push_str("  ");
                }
                match c.text {
                    true => line.push_str(&format!("{cell:<width$}")),
                    false => line.push_str(&format!("{cell:>width$}")),
                }
            }
        }
        lines.iter().map(|l| l.trim_end().to_owned()).collect()
    }

    /// Ranks the last column as one that identifies the row.
    pub fn key(self) -> Self {
        self.ranked(Rank::Key)
    }

    /// Ranks the last column as the result of the table.
    pub fn result(self) -> Self {
        self.ranked(Rank::Result)
    }

    fn values<T: Into<Value>>(&self, value: impl Fn(&R) -> T) -> Vec<Value> {
        self.rows.iter().map(|r| value(r).into()).collect()
    }

    /// Adds a column of left-aligned text; cells of empty text stay empty.
    pub fn text<T: Into<Value>>(self, heading: &str, cell: impl Fn(&R) -> T) -> Self {
        let cells = self.values(cell);
        self.show(heading, "", Format::Text, cells)
    }

    /// Adds a column of numbers that are already formatted.
    pub fn written<T: Into<Value>>(
        self,
        heading: &str,
        unit: &str,
        cell: impl Fn(&R) -> T,
    ) -> Self {
        let cells = self.values(cell);
        self.show(heading, unit, Format::Plain, cells)
    }

    /// Adds a column of numbers in SI units with one prefix by their typical magnitude. Without a unit the numbers have
    /// no prefix.
    pub fn numbers<T: Into<Value>>(
        self,
        heading: &str,
        unit: &str,
        digits: usize,
        value: impl Fn(&R) -> T,
    ) -> Self {
        let values = self.values(value);
        self.show(heading, unit, Format::Numbers(digits), values)
    }

    /// Adds a column of ranges from least to greatest value, with one prefix.
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
        self.column(heading, unit, false, cells)
    }

    /// Adds a column of residuals, always as powers of ten.
    pub fn powers<T: Into<Value>>(
        self,
        heading: &str,
        unit: &str,
        value: impl Fn(&R) -> T,
    ) -> Self {
        let values = self.values(value);
        self.show(heading, unit, Format::Powers, values)
    }

    /// Adds a column of ratios in per cent.
    pub fn percents<T: Into<Value>>(
        self,
        heading: &str,
        digits: usize,
        value: impl Fn(&R) -> T,
    ) -> Self {
        let values = self.values(value);
        self.show(heading, "", Format::Percents(digits), values)
    }

    /// Adds a column of deviations in per cent, with their sign.
    pub fn deviations<T: Into<Value>>(self, heading: &str, value: impl Fn(&R) -> T) -> Self {
        let values = self.values(value);
        self.show(heading, "", Format::Deviations, values)
    }
}

/// Returns the text of a cell; an empty text is no value.
fn text(value: &Value) -> Option<String> {
    let text = match value {
        Value::Absent => String::new(),
        Value::Number(x) => x.to_string(),
        Value::Count(n) => n.to_string(),
        Value::Text(text) => text.clone(),
    };
    Some(text).filter(|text| !text.is_empty())
}

/// Returns the prefix for the typical magnitude of a column; no prefix without a unit.
pub fn common_prefix(values: impl Iterator<Item = f64>, unit: &str) -> Prefix {
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

impl<R> Table<'_, R> {
    /// Returns the columns of each part of the table, the part at a glance first.
    fn parts(&self) -> Vec<Vec<&Column>> {
        let any = |c: &&Column| c.cells.iter().any(Option::is_some);
        let shown: Vec<&Column> = self.columns.iter().filter(any).collect();
        let of = |rank: Rank| shown.iter().copied().filter(move |c| c.rank == rank);
        let keys: f64 = of(Rank::Key).map(Column::width).sum();
        let mut left = PAGE - keys - of(Rank::Result).map(Column::width).sum::<f64>();
        let fits = |c: &&&Column| match c.rank {
            Rank::Detail => {
                left -= c.width();
                left >= 0.0
            }
            _ => true,
        };
        let glance: Vec<&Column> = shown.iter().filter(fits).copied().collect();
        let mut parts = vec![glance];
        let rest = |c: &&Column| !parts[0].iter().any(|g| std::ptr::eq(*g, *c));
        let rest: Vec<&Column> = of(Rank::Detail).filter(rest).collect();
        for column in rest {
            let room = parts.len() > 1
                && (parts.last()).is_some_and(|p| width(p) + column.width() <= PAGE);
            if !room {
                parts.push(of(Rank::Key).collect());
            }
            parts.last_mut().into_iter().for_each(|p| p.push(column));
        }
        parts
    }

    fn part(&self, columns: &[&Column]) -> Markup {
        let rows: Vec<usize> = (0..self.rows.len()).collect();
        let blocks = rows.chunk_by(|a, b| self.groups[*a] == self.groups[*b]);
        html! {
            // Where a screen is narrower than the table, it scrolls in its box.
            div.pan {
            table {
                thead {
                    tr {
                        @for c in columns {
                            th.t[c.text].r[c.rank == Rank::Result] {
                                (explained(&c.heading))
                                @if !c.unit.is_empty() { br; span.unit { (c.unit) } }
                            }
                        }
                    }
                }
                @for block in blocks {
                    tbody {
                        @if let Some((heading, style)) = &self.groups[block[0]] {
                            tr.group { th colspan=(columns.len()) { (mark(*style)) (heading) } }
                        }
                        @for &i in block {
                            tr class=[Some(self.classes[i]).filter(|c| !c.is_empty())] data-run=[self.runs[i]] {
                                @for c in columns { (cell(c, i)) }
                            }
                        }
                    }
                }
            }
            }
        }
    }
}

/// Renders a cell.
fn cell(c: &Column, row: usize) -> Markup {
    let text = c.cells[row].as_deref();
    let classes = [(c.text, "t"), (c.wraps(), "w"), (c.rank == Rank::Key, "k")];
    let classes: Vec<&str> = (classes.iter().filter(|c| c.0)).map(|c| c.1).collect();
    // Long tables are the weight of a page: most cells have no class.
    let classes = (!classes.is_empty()).then(|| classes.join(" "));
    html! { td class=[classes] { (prose(text.unwrap_or(ABSENT))) } }
}

impl<R> Render for Table<'_, R> {
    fn render(&self) -> Markup {
        let parts = self.parts();
        let Some((glance, rest)) = parts.split_first() else {
            return Markup::default();
        };
        let keys = |c: &&&Column| c.rank != Rank::Key;
        let named: Vec<&str> = (rest.iter().flatten().filter(keys))
            .map(|c| c.heading.as_str())
            .collect();
        if self.rows.len() > LONG {
            return html! {
                details {
                    summary { "All " (count(self.rows.len() as u64)) " rows" }
                    @for part in &parts { (self.part(part)) }
                }
            };
        }
        html! {
            (self.part(glance))
            @if !rest.is_empty() {
                details {
                    summary { "More of the same: " (named.join(", ")) }
                    @for part in rest { (self.part(part)) }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For any number of details, keys and results are in the table at a glance, every column is in some part, and no
    /// part is wider than the page.
    #[test]
    fn results_stand_at_a_glance_and_nothing_is_wider_than_the_page() {
        let rows = ["dopri5", "generalised-alpha(rho_inf=0.8)"];
        let mut table = Table::of(&rows).text("Integrator", |r| (*r).to_owned());
        for i in 0..30 {
            table = table.numbers(&format!("Detail number {i}"), "s", 3, |_| 1.5);
        }
        let table = table.percents("Error", 3, |_| 0.0469).result();
        let parts = table.parts();
        assert!(parts.len() > 1 && parts.iter().all(|p| width(p) <= PAGE));
        let headings =
            |part: &[&Column]| -> Vec<String> { part.iter().map(|c| c.heading.clone()).collect() };
        let glance = headings(&parts[0]);
        assert!(glance.contains(&"Error".into()) && glance.len() > 5);
        let all: Vec<String> = parts.iter().flat_map(|p| headings(p)).collect();
        for i in 0..30 {
            let name = format!("Detail number {i}");
            assert_eq!(all.iter().filter(|h| **h == name).count(), 1);
        }
        assert!(parts.iter().all(|p| p[0].heading == "Integrator"));
        let html = table.render().0;
        let (first, rest) = html.split_once("<details>").unwrap();
        assert!(
            first.contains(">Error<") && !rest.contains("Error"),
            "{first}"
        );
    }

    #[test]
    fn rounding_reads_as_nothing() {
        let rows = [2.5e-9, -9.89e-18];
        let html = Table::of(&rows).numbers("Shift", "s", 3, |x| *x).render().0;
        assert!(html.contains(">2.50<") && html.contains(">0<"), "{html}");
        let html = Table::of(&rows).percents("Error", 2, |x| *x).render().0;
        assert!(html.contains("1e\u{2212}10"), "{html}");
    }
}
