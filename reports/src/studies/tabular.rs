//! Studies whose results are the rows of one table: the record keeps columns, rows, charts and finding as the study
//! declares them, so that page, charts, CSV file and terminal lines of any such study follow without code of its own.
//!
//! A study declares its columns once (`gearbench::studies::tabular`). A chart names the keys of its columns
//! ([`TableChart`]).

mod front;

use super::StudyReport;
use crate::columns::{Column as DeclaredColumn, Columns, FileDescription, Value};
use crate::csv_table::named_unit;
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart, extremes};
use crate::drawing::style::curve_style;
use crate::markup::column::{Format, Rank};
use crate::markup::table::{Table, common_prefix};
use crate::markup::{glance, note, prose, runs, section};
use crate::numbers::{count, short};
use crate::record::Status;
use crate::record::checks::each;
use crate::studies::compare::histories;
use crate::view::{View, capital};
pub use front::{FrontPanel, TableFront};
use maud::{Markup, html};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Factor by which a logarithmic ordinate exceeds its points.
const MARGIN: f64 = 1.6;
/// Key of the column by which every row has its model.
pub const MODEL: &str = "model";
/// Key of the column with the status of a row.
pub const STATUS: &str = "status";
/// Key of the column with the reason of a failure.
pub const MESSAGE: &str = "message";
/// Key of the column with the reference of the errors of a row, in tables with a row for each of them.
pub const AGAINST: &str = "against";
/// Key of the column that says which rows are on a front.
pub const ON_FRONT: &str = "on_front";
/// Largest number of rows that a page has.
const MOST_ON_PAGE: usize = 1000;

/// The part of a record of a study whose results are one table.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TabularRecord {
    /// Name of the study, which is that of its command and of its file.
    pub name: String,
    /// Sentence on the rows of the table.
    pub rows_are: String,
    /// The finding: sentences in plain words.
    pub finding: Vec<String>,
    /// Columns of the table.
    pub columns: Vec<TableColumn>,
    /// Rows of the table, failed ones included.
    pub rows: Vec<TableRow>,
    /// Tables that sum the rows up, which stand before them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub summaries: Vec<SummaryTable>,
    /// Key of the column by which rows are grouped; empty for that of models.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub grouped_by: String,
    /// Remark below the table.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub remark: String,
    /// Charts over columns of the table.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub charts: Vec<TableChart>,
}

/// A table that sums up rows of the study, one row for each series of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SummaryTable {
    /// Title of the table.
    pub title: String,
    /// Columns of the table.
    pub columns: Vec<TableColumn>,
    /// Rows of the table.
    pub rows: Vec<TableRow>,
    /// Remark below the table.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub remark: String,
}

impl SummaryTable {
    /// Returns a table of some rows.
    pub fn of<R>(title: &str, columns: &Columns<'_, R>, rows: &[R], remark: &str) -> Self {
        Self {
            title: title.into(),
            columns: columns.recorded(),
            rows: rows.iter().map(|r| columns.recorded_row(r)).collect(),
            remark: remark.into(),
        }
    }
}

/// A column of the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TableColumn {
    /// Key of the column, with its SI unit at the end.
    pub key: String,
    /// Meaning of the column in words.
    pub meaning: String,
    /// Heading on the page; a column without heading is in the CSV file alone.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub heading: String,
    /// Format of its cells on the page.
    #[serde(default)]
    pub format: Format,
    /// Rank on the page: columns that identify a row and those with results are always shown.
    #[serde(default)]
    pub rank: Rank,
}

impl TableColumn {
    /// Shows the column on pages as one with results.
    pub fn show(&mut self, heading: String, format: Format) {
        (self.heading, self.format, self.rank) = (heading, format, Rank::Result);
    }
}

/// A row of the table: its values by the keys of the columns; a value that is absent has no key.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TableRow(BTreeMap<String, Value>);

impl TableRow {
    /// Returns a row from keys and values.
    pub fn of(values: impl IntoIterator<Item = (String, Value)>) -> Self {
        let some = values.into_iter().filter(|(_, x)| *x != Value::Absent);
        Self(some.collect())
    }

    fn value(&self, key: &str) -> Value {
        self.0.get(key).cloned().unwrap_or(Value::Absent)
    }

    fn number(&self, key: &str) -> Option<f64> {
        self.0.get(key).and_then(Value::number)
    }

    fn text(&self, key: &str) -> &str {
        self.0.get(key).and_then(Value::as_text).unwrap_or("")
    }

    /// True if a column of yes and no says yes.
    fn is(&self, key: &str) -> bool {
        self.0.get(key) == Some(&Value::from(true))
    }

    /// True if the row is of a failed run.
    fn failed(&self) -> bool {
        let status = self.0.get(STATUS).and_then(Value::as_text);
        let is = |text: &str| Status::ALL.into_iter().find(|s| s.as_str() == text);
        status.and_then(is).is_some_and(Status::is_failure)
    }
}

/// A chart over columns of the table: a panel for each ordinate, a curve for each model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TableChart {
    /// Name of the file, without ending.
    pub file: String,
    /// Title of the chart.
    pub title: String,
    /// Sentence below the chart.
    pub caption: String,
    /// Key of the column of abscissae.
    pub abscissa: String,
    /// Keys of the columns of ordinates.
    pub ordinates: Vec<String>,
    /// Key of a column of which each value has panels of its own; empty for common panels.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub panels_by: String,
    /// Least and greatest ordinate, at which values beyond are drawn; in the units of the columns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<[f64; 2]>,
    /// Key of a column, in the unit of the abscissae, at whose values vertical lines stand in the colours of their
    /// groups; empty for none.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub verticals: String,
    /// True if magnitudes are drawn, as for deviations.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub magnitudes: bool,
    /// True if points are not joined, as those of independent rows.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub points: bool,
    /// Levels of the ordinates that are drawn as limits, in the units of their columns.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub levels: Vec<f64>,
    /// Key of a column whose texts name points; empty if none has a name.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub marks: String,
    /// Name of the rows without abscissa, which are horizontal lines; empty if there are none to be drawn.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub limit: String,
    /// Pareto fronts; without them a chart has a curve for each group.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub front: Option<TableFront>,
}

impl<R> Columns<'_, R> {
    /// Returns the columns as a record describes them.
    pub fn recorded(&self) -> Vec<TableColumn> {
        let of = |c: &DeclaredColumn<'_, R>| {
            let (heading, format) = c.shown.clone().unwrap_or_default();
            TableColumn {
                key: c.key.clone(),
                meaning: c.meaning.clone(),
                heading,
                format,
                rank: c.rank,
            }
        };
        self.all.iter().map(of).collect()
    }

    /// Returns a row as a record has it.
    pub fn recorded_row(&self, row: &R) -> TableRow {
        TableRow::of(self.all.iter().map(|c| (c.key.clone(), (c.value)(row))))
    }
}

impl TabularRecord {
    /// Checks the rules that the types do not enforce.
    pub(crate) fn validate(&self) -> Result<(), String> {
        // They name files of the folder.
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "_-".contains(c);
        for name in self.charts.iter().map(|c| &c.file).chain([&self.name]) {
            if name.is_empty() || name.len() > 60 || !name.chars().all(plain) {
                return Err(format!(
                    "`{name}` is no name of a file: small letters, digits, _ and -"
                ));
            }
        }
        let rows_fit = |rows: &[TableRow], columns: &[TableColumn]| {
            each("rows", rows, |row| {
                let known = |key: &&String| columns.iter().any(|c| c.key == **key);
                let unknown = row.0.keys().find(|key| !known(key));
                unknown.map_or(Ok(()), |key| Err(format!("there is no column `{key}`")))
            })
        };
        rows_fit(&self.rows, &self.columns)?;
        each("summaries", &self.summaries, |t| {
            rows_fit(&t.rows, &t.columns)
        })?;
        each("charts", &self.charts, |c| {
            let marks = Some(&c.marks).filter(|key| !key.is_empty());
            let grouped = Some(&self.grouped_by).filter(|key| !key.is_empty());
            let marks = marks.into_iter().chain(grouped);
            let further = [&c.panels_by, &c.verticals];
            let further = further.into_iter().filter(|key| !key.is_empty());
            let of_front = c.front.iter().flat_map(TableFront::keys);
            let further = further.chain(marks).chain([&c.abscissa]).chain(of_front);
            for key in c.ordinates.iter().chain(further) {
                if self.column(key).is_none() {
                    return Err(format!("there is no column `{key}`"));
                }
            }
            Ok(())
        })
    }

    /// Removes all numbers that are not finite.
    pub(crate) fn keep_finite(&mut self) {
        let summaries = self.summaries.iter_mut().flat_map(|t| &mut t.rows);
        for row in self.rows.iter_mut().chain(summaries) {
            row.0
                .retain(|_, x| !matches!(x, Value::Number(x) if !x.is_finite()));
        }
    }

    fn column(&self, key: &str) -> Option<&TableColumn> {
        self.columns.iter().find(|c| c.key == key)
    }

    /// The declaration of the columns, whose values are those of the rows.
    fn declared(&self) -> Columns<'_, &TableRow> {
        declared(&format!("{}.csv", self.name), &self.rows_are, &self.columns)
    }

    /// Returns the rows as values of a type whose fields are columns.
    ///
    /// # Errors
    /// A row that is no value of the type.
    pub fn rows_as<T: DeserializeOwned>(&self) -> Result<Vec<T>, serde_json::Error> {
        let of = |row: &TableRow| serde_json::from_value(serde_json::to_value(row)?);
        self.rows.iter().map(of).collect()
    }

    /// Name of the group of a row: its model, if nothing else is said.
    fn group<'r>(&self, row: &'r TableRow) -> &'r str {
        match self.grouped_by.as_str() {
            "" => row.text(MODEL),
            key => row.text(key),
        }
    }

    /// Groups in the order of their first rows.
    fn groups(&self) -> Vec<&str> {
        let mut all: Vec<&str> = Vec::new();
        for row in &self.rows {
            let group = self.group(row);
            if !all.contains(&group) {
                all.push(group);
            }
        }
        all
    }

    /// The table of some rows under a declaration of their columns, in the groups of the study.
    fn table_of<'r>(
        &self,
        rows: &'r [TableRow],
        declared: &Columns<'_, &'r TableRow>,
    ) -> Table<'r, TableRow> {
        let groups = self.groups();
        let style = |row: &TableRow| {
            let place = groups.iter().position(|g| *g == self.group(row));
            (self.group(row).to_owned(), place.unwrap_or(0))
        };
        Table::of(rows)
            .grouped(style)
            .classed(|row| if row.failed() { "failed" } else { "" })
            .columns(declared, Some)
    }

    /// The rows that a page has: all, or of very many those on a front, else the first.
    fn on_page(&self) -> Vec<TableRow> {
        if self.rows.len() <= MOST_ON_PAGE {
            return self.rows.clone();
        }
        let has_fronts = self.column(ON_FRONT).is_some();
        let is_chosen = |row: &&TableRow| !has_fronts || row.is(ON_FRONT);
        let chosen = self.rows.iter().filter(is_chosen);
        chosen.take(MOST_ON_PAGE).cloned().collect()
    }

    fn table(&self) -> Table<'_, TableRow> {
        self.table_of(&self.rows, &self.declared())
    }

    fn summary<'r>(&self, summary: &'r SummaryTable) -> Table<'r, TableRow> {
        let declared = declared("", "", &summary.columns);
        self.table_of(&summary.rows, &declared)
    }

    /// Returns the description of the file with the table.
    pub fn described(&self) -> FileDescription {
        self.declared().described()
    }

    /// Returns the columns with keys and results as lines for a terminal: those of the summaries, if there are any.
    pub fn lines(&self) -> Vec<String> {
        match self.summaries.is_empty() {
            true => self.table().lines(),
            false => {
                let of = |t: &SummaryTable| {
                    let title = std::iter::once(t.title.clone());
                    title.chain(self.summary(t).lines()).collect::<Vec<_>>()
                };
                self.summaries.iter().flat_map(of).collect()
            }
        }
    }

    fn charts(&self) -> Result<Vec<Chart>, DrawError> {
        let charts = self.charts.iter().map(|c| self.chart(c));
        charts.filter_map(Result::transpose).collect()
    }

    /// The ordinate of each panel of a chart, and the value that its rows share, if panels have rows of their own.
    fn panels<'s>(&'s self, spec: &'s TableChart) -> Vec<(&'s str, Option<&'s str>)> {
        let mut values: Vec<Option<&str>> = Vec::new();
        for row in &self.rows {
            let value = Some(row.text(&spec.panels_by)).filter(|text| !text.is_empty());
            if value.is_some() && !values.contains(&value) {
                values.push(value);
            }
        }
        if spec.panels_by.is_empty() {
            values = vec![None];
        }
        let of =
            |value: Option<&'s str>| spec.ordinates.iter().map(move |key| (key.as_str(), value));
        values.into_iter().flat_map(of).collect()
    }

    fn chart(&self, spec: &TableChart) -> Result<Option<Chart>, DrawError> {
        if let Some(front) = &spec.front {
            return self.front_chart(spec, front);
        }
        let Some(abscissa) = Quantity::of(self, &spec.abscissa, false) else {
            return Ok(None);
        };
        let Some(x) = axis_over(self.rows.iter().filter_map(|r| abscissa.of_row(r)), 1.0) else {
            return Ok(None);
        };
        let groups = self.groups();
        let mut panels: Vec<Panel> = Vec::new();
        let (mut has_limits, mut has_verticals) = (false, false);
        for (key, own_panel) in self.panels(spec) {
            let Some(ordinate) = Quantity::of(self, key, spec.magnitudes) else {
                continue;
            };
            let drawn = |r: &TableRow| {
                let [low, high] = spec.within.map_or([f64::MIN, f64::MAX], |within| {
                    within.map(|y| ordinate.factor * y)
                });
                Some(ordinate.of_row(r)?.clamp(low, high))
            };
            let mut curves = Vec::new();
            for (style, group) in groups.iter().enumerate() {
                let in_panel = |r: &&TableRow| match own_panel {
                    Some(value) => r.text(&spec.panels_by) == value,
                    None => true,
                };
                let own = || {
                    let of_group = self.rows.iter().filter(|r| self.group(r) == *group);
                    of_group.filter(in_panel)
                };
                let (failed, held): (Vec<_>, Vec<_>) = own().partition(|r| r.failed());
                let is_limit =
                    |r: &&&TableRow| abscissa.of_row(r).is_none() && !spec.limit.is_empty();
                for limit in held.iter().filter(is_limit).filter_map(|r| drawn(r)) {
                    has_limits = true;
                    let stroke = Stroke::new(Ink::DARK, 1.4);
                    curves.push(Curve::line(stroke, vec![(x.min, limit), (x.max, limit)]));
                }
                let point = |r: &&TableRow| Some((abscissa.of_row(r)?, drawn(r)?));
                let mut points: Vec<(f64, f64)> = held.iter().filter_map(point).collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                let vertical = own().find_map(|r| r.number(&spec.verticals));
                let vertical = vertical.map(|at| abscissa.factor * at);
                let is_shown = |at: &f64| (x.min..=x.max).contains(at) && !points.is_empty();
                if let Some(at) = vertical.filter(is_shown) {
                    has_verticals = true;
                    let (low, high) = extremes(points.iter().map(|p| p.1));
                    let stroke = Stroke::dashed(curve_style(style).ink, 1.3, &[2.0, 3.0]);
                    curves.push(Curve::line(stroke, vec![(at, low), (at, high)]));
                }
                let failed = failed.into_iter().filter_map(|r| abscissa.of_row(r));
                let curve = match spec.points {
                    true => Curve::points(curve_style(style), 4.2, true, points),
                    false => Curve::joined(curve_style(style), 1.6, 4.2, points),
                };
                curves.push(curve.failed(failed.collect()));
            }
            if curves.iter().all(|c| c.points.is_empty()) {
                continue;
            }
            let level = |level: &f64| (ordinate.factor * level, ordinate.level_text(*level));
            let marked = |r: &TableRow| {
                let at = (abscissa.of_row(r)?, drawn(r)?);
                let name = r.0.get(&spec.marks)?.as_text()?.to_owned();
                (!r.failed()).then_some((at, name))
            };
            let mut panel = Panel {
                limits: spec.levels.iter().map(level).collect(),
                marks: self.rows.iter().filter_map(marked).collect(),
                ..Panel::new(170.0, &x, &ordinate.name).curves(curves)
            };
            if let Some(value) = own_panel {
                panel.remark = value.to_owned();
            }
            let (low, high) = panel.ordinates();
            // The limit of the curves counts, not zero; markers stay inside of the frame.
            panel.y = axis_over([low, high].into_iter(), MARGIN);
            panels.push(panel);
        }
        let Some(last) = panels.last_mut() else {
            return Ok(None);
        };
        last.x_name = Some(abscissa.name.clone());
        let drawn = |group: &str| {
            let mut own = self.rows.iter().filter(|r| self.group(r) == group);
            own.any(|r| abscissa.of_row(r).is_some() || !spec.limit.is_empty())
        };
        let mut legend: Vec<Entry> = (groups.iter().enumerate())
            .filter(|(_, group)| drawn(group))
            .map(|(i, group)| Entry::marked(group, curve_style(i), true))
            .collect();
        if has_limits {
            legend.push(Entry::line(&spec.limit, Stroke::new(Ink::DARK, 1.4)));
        }
        if has_verticals && let Some(column) = self.column(&spec.verticals) {
            let stroke = Stroke::dashed(Ink::GREY, 1.3, &[2.0, 3.0]);
            legend.push(Entry::line(&column.heading, stroke));
        }
        let file = format!("{}.svg", spec.file);
        chart(&file, &spec.title, &spec.caption, &legend, &panels).map(Some)
    }
}

/// The declaration of the columns of a recorded table, whose values are those of its rows.
fn declared<'c>(file: &str, rows: &str, columns: &'c [TableColumn]) -> Columns<'c, &'c TableRow> {
    let mut all = Columns::of(file, rows);
    for c in columns {
        all = all.add(&c.key, &c.meaning, |row: &&TableRow| row.value(&c.key));
        if !c.heading.is_empty() {
            all = all.shown(&c.heading, c.format.clone());
        }
        if let Some(column) = all.all.last_mut() {
            column.rank = c.rank;
        }
    }
    all
}

/// A column as an axis shows it: its name with unit and the factor of its values.
struct Quantity<'a> {
    key: &'a str,
    name: String,
    unit: String,
    factor: f64,
    magnitudes: bool,
}

impl<'a> Quantity<'a> {
    fn of(record: &'a TabularRecord, key: &str, magnitudes: bool) -> Option<Self> {
        let c = record.column(key)?;
        let (bare, unit) = named_unit(&c.key);
        let name = match c.heading.as_str() {
            "" => capital(&bare.replace('_', " ")),
            heading => heading.to_owned(),
        };
        let (factor, unit) = match c.format {
            Format::Percents(_) | Format::Deviations => (100.0, "%".to_owned()),
            Format::Powers | Format::Short(_) => (1.0, unit.to_owned()),
            _ => {
                let values = record.rows.iter().filter_map(|r| r.number(key));
                let prefix = common_prefix(values, unit);
                (prefix.factor, format!("{}{unit}", prefix.symbol))
            }
        };
        let brackets = match unit.as_str() {
            "" => String::new(),
            unit => format!(" [{unit}]"),
        };
        Some(Self {
            key: &c.key,
            name: format!("{name}{brackets}"),
            unit,
            factor,
            magnitudes,
        })
    }

    /// A level with its unit, as a chart names it.
    fn level_text(&self, level: f64) -> String {
        format!("{} {}", short(self.factor * level, 3), self.unit)
    }

    /// The value on the axis; magnitudes of zero have no place on a logarithmic one.
    fn of_row(&self, row: &TableRow) -> Option<f64> {
        let x = self.factor * row.number(self.key)?;
        match self.magnitudes {
            true => Some(x.abs()).filter(|x| *x > 0.0),
            false => Some(x),
        }
    }
}

/// Returns an axis over some values, logarithmic where they are positive and spread over more than a decade and a half;
/// `None` if they are all the same. A logarithmic axis exceeds them by a factor at both ends.
pub(super) fn axis_over(values: impl Iterator<Item = f64>, factor: f64) -> Option<Axis> {
    let (low, high) = extremes(values);
    if low >= high {
        return None;
    }
    Some(match low > 0.0 && high > 30.0 * low {
        true => Axis::logarithmic(low / factor, high * factor),
        false => Axis::padded(low, high, 0.03),
    })
}

/// Returns the report of a study whose results are one table.
pub(super) fn report(view: &View<'_>, record: &TabularRecord) -> Result<StudyReport, DrawError> {
    let mut charts = record.charts()?;
    // References alone are no result.
    if view.results.runs.iter().any(|r| r.series.is_some()) {
        charts.extend(histories::force(std::slice::from_ref(view))?);
    }
    let with_remark = |table: Table<'_, TableRow>, remark: &str| {
        html! {
            (table)
            @if !remark.is_empty() { (note(prose(remark))) }
        }
    };
    let on_page = record.on_page();
    let remark = match on_page.len() < record.rows.len() {
        true => format!(
            "{} The page has {} of {} rows, {}; {} has all.",
            record.remark,
            count(on_page.len() as u64),
            count(record.rows.len() as u64),
            match record.column(ON_FRONT) {
                Some(_) => "those on a front",
                None => "the first",
            },
            record.declared().described().file,
        ),
        false => record.remark.clone(),
    };
    let rows = with_remark(record.table_of(&on_page, &record.declared()), &remark);
    let heading = capital(&record.rows_are);
    let summaries = record.summaries.iter();
    let summaries =
        summaries.map(|t| (t.title.as_str(), with_remark(record.summary(t), &t.remark)));
    let mut all = summaries.chain([(heading.as_str(), rows)]);
    let first = all.next().map(|(title, content)| glance(title, content));
    let tables = html! {
        (first.unwrap_or_default())
        @for (title, content) in all { (section(title, content)) }
    };
    // Rows by reference have the metrics of all runs already.
    let details = match (view.results.runs.as_slice(), record.column(AGAINST)) {
        ([], _) => Markup::default(),
        (_, Some(_)) => runs::failures(view),
        (_, None) => runs::all(view),
    };
    Ok(StudyReport {
        finding: record.finding.iter().map(|s| prose(s)).collect(),
        tables,
        charts,
        details,
        csv: vec![record.declared().table(&record.rows)],
        ..StudyReport::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Part, Results};

    fn record() -> TabularRecord {
        let columns = Columns::<(&str, Option<f64>, f64)>::of("penalty.csv", "One row per run")
            .model(|r| r.0.to_owned())
            .add("penalty_pa_per_m", "penalty", |r| r.1)
            .shown("Penalty", Format::Powers)
            .add("peak_force_n", "peak", |r| r.2)
            .shown("Peak", Format::Numbers(4))
            .result();
        let rows = [
            ("elastic", Some(1e13), 900.0),
            ("elastic", Some(1e15), 1090.0),
            ("elastic", None, 1100.0),
        ];
        TabularRecord {
            name: "penalty".into(),
            rows_are: "One row per run".into(),
            finding: vec!["It converges.".into()],
            columns: columns.recorded(),
            rows: (rows.iter()).map(|r| columns.recorded_row(r)).collect(),
            charts: vec![TableChart {
                file: "penalty".into(),
                abscissa: "penalty_pa_per_m".into(),
                ordinates: vec!["peak_force_n".into()],
                limit: "hard contact".into(),
                ..TableChart::default()
            }],
            ..TabularRecord::default()
        }
    }

    /// Page, chart, file and terminal have the values of the columns, and a record that is read again gives the same.
    #[test]
    fn one_declaration_gives_page_chart_file_and_lines() {
        let results = Results {
            part: Part::Tabular(record()),
            ..Results::default()
        };
        let json = serde_json::to_string(&results).unwrap();
        let again: Results = serde_json::from_str(&json).unwrap();
        assert_eq!(again, results);
        let report = crate::studies::report(&again).unwrap();
        let charts: Vec<_> = report.all_charts().collect();
        assert_eq!(charts.len(), 1);
        assert!(charts[0].svg.contains("hard contact"));
        let csv = report.csv[0].text();
        assert!(
            csv.starts_with("model,penalty_pa_per_m,peak_force_n\nelastic,1.0"),
            "{csv}"
        );
        assert!(csv.ends_with("elastic,,1.100000000e3\n"), "{csv}");
        let page = report.tables.0;
        assert!(page.contains("Peak") && page.contains("1100"), "{page}");
        let lines = record().lines();
        assert!(
            lines[0].contains("Peak [N]") && lines[3].ends_with("1100"),
            "{lines:?}"
        );
    }

    #[test]
    fn rows_and_charts_have_columns() {
        let mut gap = record();
        gap.columns.pop();
        assert!(gap.validate().unwrap_err().contains("rows"));
        let mut outside = record();
        outside.name = "../penalty".into();
        assert!(
            outside
                .validate()
                .unwrap_err()
                .contains("no name of a file")
        );
        let mut chart = record();
        chart.charts[0].ordinates.push("mass_kg".into());
        assert!(chart.validate().unwrap_err().contains("mass_kg"));
    }
}
