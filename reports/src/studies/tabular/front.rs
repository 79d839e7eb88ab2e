//! Charts of one column over another with the Pareto front of their rows, such as error over cost: a point per row with
//! a text of its own, the front as a staircase, failed rows as crosses at the edge.

use super::{Quantity, TableChart, TableRow, TabularRecord};
use crate::columns::Value;
use crate::csv_table::named_unit;
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Guide, LabelledPoint, Panel, chart, extremes};
use crate::drawing::style::curve_style;
use crate::markup::column::Format;
use crate::numbers::{count, per_cent, power, round_quantity, short};
use crate::pareto::{Point, front};
use crate::view::NOTHING;
use serde::{Deserialize, Serialize};

/// Height of the panel of a chart with one, and of each of several.
const HEIGHT: f64 = 400.0;
const SMALL: f64 = 225.0;
/// Factor by which the ordinate of a point of a front must be below that of the last named point to be named itself.
const IMPROVEMENT: f64 = 0.95;
/// Colour and width of the full front.
const FRONT: (Ink, f64) = (Ink::DARK, 1.5);
/// Dashes of the front that takes all rows in.
const DOTTED: &[f64] = &[3.0, 3.0];

/// The Pareto fronts of a chart: rows that no other row of their panel beats in abscissa and magnitude of the ordinate.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TableFront {
    /// Panels of the chart, each with the front of its rows.
    pub panels: Vec<FrontPanel>,
    /// Keys of the columns whose values name a point.
    pub named_by: Vec<String>,
    /// Key of a column; the rows of one group and one value are joined along their own front. Empty for no such lines.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub joined_by: String,
    /// Key of a column; rows with a value there have no part in the full front, and a dotted one takes them in. Empty if
    /// all rows have a part in the front.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub without: String,
}

/// A panel of a chart with fronts.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FrontPanel {
    /// Heading of the panel; empty for none.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub title: String,
    /// Values of columns that all rows of the panel have; a failed row may lack them.
    pub rows: TableRow,
}

impl FrontPanel {
    fn has(&self, row: &TableRow) -> bool {
        let is_same = |(key, value): (&String, &Value)| match row.0.get(key) {
            Some(own) => own == value,
            None => row.failed(),
        };
        self.rows.0.iter().all(is_same)
    }
}

impl TableFront {
    /// Returns the keys of all columns that the chart needs.
    pub(super) fn keys(&self) -> impl Iterator<Item = &String> {
        let of_panels = self.panels.iter().flat_map(|p| p.rows.0.keys());
        let further = [&self.joined_by, &self.without].into_iter();
        let further = further.filter(|key| !key.is_empty());
        of_panels.chain(&self.named_by).chain(further)
    }
}

/// A row as a point of a panel, in the units of the axes.
struct Plotted<'r> {
    row: &'r TableRow,
    /// Place of its group.
    group: usize,
    point: Point,
}

/// The rows of a panel.
struct Rows<'r> {
    panel: &'r FrontPanel,
    ordinate: Quantity<'r>,
    held: Vec<Plotted<'r>>,
    /// Failed rows of the same groups.
    failed: Vec<(&'r TableRow, usize)>,
}

impl Rows<'_> {
    fn front(&self, has: impl Fn(&Plotted<'_>) -> bool) -> Vec<usize> {
        let kept: Vec<usize> = (0..self.held.len())
            .filter(|i| has(&self.held[*i]))
            .collect();
        let points: Vec<Point> = kept.iter().map(|i| self.held[*i].point).collect();
        front(&points).into_iter().map(|k| kept[k]).collect()
    }

    fn places(&self, of: &[usize]) -> Vec<(f64, f64)> {
        let place = |i: &usize| (self.held[*i].point.cost, self.held[*i].point.error);
        of.iter().map(place).collect()
    }

    /// Returns the points of a front whose ordinate is clearly below that of the last such point.
    fn improvements(&self, front: &[usize]) -> Vec<usize> {
        let mut last = f64::INFINITY;
        let mut kept = front.to_vec();
        kept.retain(|i| {
            let error = self.held[*i].point.error;
            let is_clear = error < IMPROVEMENT * last;
            if is_clear {
                last = error;
            }
            is_clear
        });
        kept
    }
}

impl TabularRecord {
    /// Draws a chart with fronts; `None` if no row has a point in it.
    pub(super) fn front_chart(
        &self,
        spec: &TableChart,
        of: &TableFront,
    ) -> Result<Option<Chart>, DrawError> {
        let Some(abscissa) = Quantity::of(self, &spec.abscissa, true) else {
            return Ok(None);
        };
        let all: Vec<Rows<'_>> = (of.panels.iter())
            .flat_map(|panel| spec.ordinates.iter().map(move |key| (panel, key)))
            .filter_map(|(panel, key)| self.rows_of(panel, key, &abscissa))
            .collect();
        let held = || all.iter().flat_map(|rows| &rows.held);
        let (low, high) = extremes(held().map(|p| p.point.cost));
        if low > high {
            return Ok(None);
        }
        let x = Axis::logarithmic(low, high);
        let groups = self.groups();
        let in_legend: Vec<usize> = (0..groups.len())
            .filter(|group| held().any(|p| p.group == *group))
            .collect();
        let label = |group: &usize| {
            let own = held().find(|p| p.group == *group && p.row.0.contains_key(&of.without));
            let without = own.and_then(|p| self.named_value(&of.without, p.row));
            let text = match without {
                Some(without) => {
                    let heading = self.column(&of.without).map_or("", |c| c.heading.as_str());
                    format!("{} ({} {without})", groups[*group], heading.to_lowercase())
                }
                None => groups[*group].to_owned(),
            };
            Entry::marked(&text, curve_style(*group), true)
        };
        let mut legend: Vec<Entry> = in_legend.iter().map(label).collect();
        let is_without = |p: &Plotted<'_>| p.row.0.contains_key(&of.without);
        if !held().all(is_without) {
            legend.push(Entry::line("front", Stroke::new(FRONT.0, FRONT.1)));
        }
        if held().any(is_without) {
            let stroke = Stroke::dashed(Ink::GREY, 1.3, DOTTED);
            legend.push(Entry::line("front of all", stroke));
        }
        let height = if all.len() > 1 { SMALL } else { HEIGHT };
        let mut panels: Vec<Panel> = Vec::new();
        for rows in &all {
            let (low, high) = extremes(rows.held.iter().map(|p| p.point.error));
            let y = Axis::logarithmic(low, high);
            let entry = |group: usize| in_legend.iter().position(|g| *g == group);
            let fronts = [rows.front(|p| !is_without(p)), rows.front(|_| true)];
            let mut panel = Panel::new(height, &x, &rows.ordinate.name);
            panel.remark.clone_from(&rows.panel.title);
            let mut named: Vec<(usize, String)> = Vec::new();
            if !of.joined_by.is_empty() {
                for (line, name) in self.joined(rows, of) {
                    named.extend(line.first().map(|i| (*i, name.to_owned())));
                    let group = line.first().map_or(0, |i| rows.held[*i].group);
                    panel.guides.push(Guide {
                        points: rows.places(&line),
                        stroke: Stroke::new(curve_style(group).ink.opacity(0.5), 1.2),
                        entry: entry(group),
                    });
                }
            }
            for (k, front) in fronts.iter().enumerate() {
                let stroke = match k {
                    0 => Stroke::new(FRONT.0, FRONT.1),
                    _ => Stroke::dashed(Ink::GREY, 1.3, DOTTED),
                };
                if k == 0 || rows.held.iter().any(is_without) {
                    panel.guides.push(Guide {
                        points: staircase(&rows.places(front), &x, &y),
                        stroke,
                        entry: None,
                    });
                }
                if of.joined_by.is_empty() {
                    let new = rows.improvements(front).into_iter();
                    let new: Vec<usize> =
                        new.filter(|i| named.iter().all(|(n, _)| n != i)).collect();
                    let name = |i: usize| (i, self.name_of(rows.held[i].row, &of.named_by));
                    named.extend(new.into_iter().map(name));
                }
            }
            let is_strong = |i: &usize| fronts.iter().any(|front| front.contains(i));
            let (strong, pale): (Vec<usize>, Vec<usize>) =
                (0..rows.held.len()).partition(is_strong);
            for i in pale.into_iter().chain(strong) {
                let p = &rows.held[i];
                panel.labelled.push(LabelledPoint {
                    at: (p.point.cost, p.point.error),
                    entry: entry(p.group).unwrap_or_default(),
                    look: curve_style(p.group),
                    is_strong: is_strong(&i),
                    text: self.point_text(p, spec, of, &rows.ordinate),
                });
            }
            let mark = |(i, name): (usize, String)| {
                let point = rows.held[i].point;
                ((point.cost, point.error), name)
            };
            panel.marks = named.into_iter().map(mark).collect();
            // The abscissa of a failed row is where it ended: it does not widen the axis.
            let failed = rows.failed.iter().filter_map(|(row, group)| {
                let at = abscissa.of_row(row)?.clamp(x.min, x.max);
                let none = Curve::points(curve_style(*group), 0.0, true, Vec::new());
                Some(none.failed(vec![at]))
            });
            panel.curves = failed.collect();
            panel.y = Some(y);
            panels.push(panel);
        }
        if let Some(last) = panels.last_mut() {
            last.x_name = Some(abscissa.name.clone());
        }
        let file = format!("{}.svg", spec.file);
        chart(&file, &spec.title, &spec.caption, &legend, &panels).map(Some)
    }

    /// The rows of a panel; `None` if none of them has a point.
    fn rows_of<'r>(
        &'r self,
        panel: &'r FrontPanel,
        key: &str,
        abscissa: &Quantity<'_>,
    ) -> Option<Rows<'r>> {
        let ordinate = Quantity::of(self, key, true)?;
        let groups = self.groups();
        let place = |row: &TableRow| groups.iter().position(|g| *g == self.group(row));
        let least = match ordinate.unit.as_str() {
            "%" => NOTHING * ordinate.factor,
            _ => 0.0,
        };
        let of_panel = self.rows.iter().filter(|row| panel.has(row));
        let (failed, held): (Vec<&TableRow>, Vec<&TableRow>) = of_panel.partition(|r| r.failed());
        let plotted = |row: &'r TableRow| {
            let (cost, error) = (abscissa.of_row(row)?, ordinate.of_row(row)?);
            let point = Point { cost, error };
            (point.is_sound() && error > least).then_some(Plotted {
                row,
                group: place(row)?,
                point,
            })
        };
        let held: Vec<Plotted<'_>> = held.into_iter().filter_map(plotted).collect();
        let failed = failed.into_iter().filter_map(|r| Some((r, place(r)?)));
        let failed = failed.filter(|(_, group)| held.iter().any(|p| p.group == *group));
        let failed = failed.collect();
        (!held.is_empty()).then_some(Rows {
            panel,
            ordinate,
            held,
            failed,
        })
    }

    /// The fronts of the rows of one group and one value each, with that value.
    fn joined<'r>(&self, rows: &Rows<'r>, of: &TableFront) -> Vec<(Vec<usize>, &'r str)> {
        let mut keys: Vec<(usize, &str)> = Vec::new();
        for p in &rows.held {
            let key = (p.group, p.row.text(&of.joined_by));
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
        let line = |(group, value): (usize, &'r str)| {
            let has = |p: &Plotted<'_>| p.group == group && p.row.text(&of.joined_by) == value;
            (rows.front(has), value)
        };
        keys.into_iter().map(line).collect()
    }

    /// The value of a column in words: with its unit, or with the name of the column.
    fn named_value(&self, key: &str, row: &TableRow) -> Option<String> {
        let column = self.column(key)?;
        let (bare, unit) = named_unit(key);
        let number = match row.value(key) {
            Value::Text(text) => return Some(text),
            value => value.number()?,
        };
        Some(match (&column.format, unit) {
            (Format::Percents(_) | Format::Deviations, _) => per_cent(number.abs(), 3),
            (Format::Counts, "") => format!("{} {}", count(number as u64), bare.replace('_', " ")),
            (Format::Powers, "") => format!("{} {}", bare.replace('_', " "), power(number, 1)),
            (_, "") => format!("{} {}", short(number, 3), bare.replace('_', " ")),
            (_, unit) => round_quantity(number, unit, 3),
        })
    }

    /// The name of a row by the values of some columns.
    fn name_of(&self, row: &TableRow, keys: &[String]) -> String {
        let values = keys.iter().filter_map(|key| self.named_value(key, row));
        values.collect::<Vec<_>>().join(", ")
    }

    /// Returns group, name, ordinate and abscissa of a point as a text for the cursor of a page.
    fn point_text(
        &self,
        p: &Plotted<'_>,
        spec: &TableChart,
        of: &TableFront,
        ordinate: &Quantity<'_>,
    ) -> String {
        let value = |key: &str| self.named_value(key, p.row).unwrap_or_default();
        format!(
            "{}, {}: {} in {}",
            self.group(p.row),
            self.name_of(p.row, &of.named_by),
            value(ordinate.key),
            value(&spec.abscissa)
        )
    }
}

/// Returns the staircase of a front: all points above and to the right of it are dominated.
fn staircase(points: &[(f64, f64)], x: &Axis, y: &Axis) -> Vec<(f64, f64)> {
    let mut path: Vec<(f64, f64)> = Vec::with_capacity(2 * points.len() + 2);
    for (cost, error) in points {
        let from = path.last().map_or(y.max, |last| last.1);
        path.extend([(*cost, from), (*cost, *error)]);
    }
    let last = path.last().copied();
    path.extend(last.map(|(_, error)| (x.max, error)));
    path
}
