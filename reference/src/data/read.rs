//! Conversion of a table to histories: numbers, times, and their errors.

use super::columns::{self, Column, Columns, Role, columns};
use super::process::Processing;
use super::table::{Delimiter, MOST_ROWS, Row, Rows, TableError, comments, shown};
use super::units::known;
use super::{Channel, ForceKind, Quantity, Reference, Subjects};

/// Samples that a history has at least.
const LEAST: usize = 3;

/// User settings for the reading of a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Column of time; `None` finds it by its name.
    pub time: Option<String>,
    /// Columns of quantities; none finds all by their names.
    pub columns: Vec<(Quantity, String)>,
    /// Unit of time, where it is not that of the header.
    pub time_unit: Option<String>,
    /// Units of quantities likewise.
    pub units: Vec<(Quantity, String)>,
    /// Part of the contact force in the table; `None` uses the name of the column, otherwise the normal force.
    pub force_kind: Option<ForceKind>,
    /// Delimiter between cells; `None` detects it.
    pub delimiter: Option<Delimiter>,
    /// True if numbers have decimal commas; `None` detects it.
    pub decimal_comma: Option<bool>,
    /// Processing of the histories.
    pub processing: Processing,
}

impl Request {
    pub(super) fn column_of(&self, role: Role) -> Option<&str> {
        match role {
            Role::Time => self.time.as_deref(),
            Role::Of(quantity) => of(&self.columns, quantity),
        }
    }

    pub(super) fn unit_of(&self, role: Role) -> Option<&str> {
        match role {
            Role::Time => self.time_unit.as_deref(),
            Role::Of(quantity) => of(&self.units, quantity),
        }
    }
}

fn of(list: &[(Quantity, String)], quantity: Quantity) -> Option<&str> {
    let found = list.iter().find(|(q, _)| *q == quantity);
    found.map(|(_, text)| text.as_str())
}

/// Numbers with points or commas, the same in the whole table.
pub(super) struct Numbers {
    comma: Option<bool>,
    /// True if commas separate cells and the user does not request decimal commas.
    between_cells: bool,
}

impl Numbers {
    /// Determines the number format of a table from the setting of the user, if any.
    pub(super) fn of(rows: &Rows<'_>, decimal_comma: Option<bool>) -> Self {
        Numbers {
            comma: decimal_comma,
            between_cells: rows.delimiter == Delimiter::Comma && decimal_comma.is_none(),
        }
    }

    /// A number times the factor of its unit; else why it is none.
    pub(super) fn read(
        &mut self,
        cell: &str,
        factor: f64,
    ) -> Result<f64, (&'static str, &'static str)> {
        let comma = cell.contains(',');
        let point = cell.contains('.');
        if comma && point {
            return Err((
                "a number without thousands separators",
                "export plain numbers",
            ));
        }
        if self.between_cells && is_thousands(cell) {
            return Err((
                "a number without thousands separators",
                "export plain numbers, or set `decimal = \"comma\"` if the comma is the decimal sign",
            ));
        }
        if comma || point {
            match self.comma {
                Some(known) if known != comma => {
                    let expected = match known {
                        true => "a number with a decimal comma, like the numbers before it",
                        false => "a number with a decimal point, like the numbers before it",
                    };
                    return Err((
                        expected,
                        "use one decimal sign in the whole table; the key `decimal` sets it",
                    ));
                }
                _ => self.comma = Some(comma),
            }
        }
        let number = match comma {
            true => cell.replace(',', ".").parse::<f64>(),
            false => cell.parse::<f64>(),
        };
        match number {
            // Squares of larger numbers overflow.
            Ok(x) if (factor * x).abs() < 1e150 => Ok(factor * x),
            Ok(_) => Err((
                "a finite number",
                "leave the cell empty if there is no measured value",
            )),
            Err(_) => Err((
                "a number",
                "leave the cell empty if there is no measured value",
            )),
        }
    }
}

/// Returns true if a cell is a whole number with thousands separators, such as `1,000` or `-12,345,678`.
fn is_thousands(cell: &str) -> bool {
    let mut groups = cell.trim_start_matches(['+', '-']).split(',');
    let digits = |g: &str| !g.is_empty() && g.bytes().all(|b| b.is_ascii_digit());
    let first = groups.next().is_some_and(|g| digits(g) && g.len() <= 3);
    let mut others = groups.peekable();
    first && others.peek().is_some() && others.all(|g| digits(g) && g.len() == 3)
}

/// Reads the histories of a table and describes their processing; the caller sets id, title and source.
///
/// Units become those of SI, transverse forces normal ones. Samples are those of the file: a cell that is empty is a
/// sample that its history does not have.
///
/// # Errors
/// [`TableError`] with line and column: what was expected, what was found, a way out.
pub fn read(text: &str, request: &Request, subjects: &Subjects) -> Result<Reference, TableError> {
    let mut rows = Rows::of(text, request.delimiter);
    let mut head = Row::default();
    if !rows.next(&mut head)? {
        let help = "a line of names, then a line for each time";
        return Err(rows.error(&head, "", "a table", "nothing", help));
    }
    let mut found = columns(&rows, &head, request, subjects)?;
    let mut numbers = Numbers::of(&rows, request.decimal_comma);
    let mut row = Row::default();
    let mut more = rows.next(&mut row)?;
    if more && line_of_units(&row, &mut found, subjects) {
        more = rows.next(&mut row)?;
    }
    if let Some(column) = found.read.iter().find(|c| c.unit.is_none()) {
        let dimension = column.role.dimension(subjects);
        let mut error = rows.error_in(
            &head,
            (column.index, &column.name),
            &format!(
                "a unit of {}: {}",
                column.role.told(subjects),
                known(dimension)
            ),
            "give the unit in the header, `name [unit]`, or in the scene: units = { force = \"kN\" }",
        );
        error.found = format!("none in {}", shown(&column.name));
        return Err(error);
    }
    let factor = |c: &Column| c.unit.as_ref().map_or(1.0, |(_, factor)| *factor);
    let time_of = |c: &&Column| c.role == Role::Time;
    let (Some(time_column), others) = (
        found.read.iter().find(time_of),
        found
            .read
            .iter()
            .filter(|c| !time_of(c))
            .collect::<Vec<_>>(),
    ) else {
        // `columns` refuses a table without times.
        return Err(rows.error(&head, "", "a column of time", "none", ""));
    };
    let mut channels: Vec<Channel> = (others.iter())
        .filter_map(|c| match c.role {
            Role::Of(quantity) => Some(Channel {
                quantity,
                time: Vec::new(),
                value: Vec::new(),
            }),
            Role::Time => None,
        })
        .collect();
    let mut last: Option<f64> = None;
    let mut count = 0;
    while more {
        count += 1;
        if count > MOST_ROWS {
            let expected = format!("at most {MOST_ROWS} rows");
            let help = "keep every n-th row";
            return Err(rows.error(&row, "", &expected, "more", help));
        }
        let wide = row.cells.len() > head.cells.len();
        if wide
            && row
                .cells
                .iter()
                .skip(head.cells.len())
                .any(|c| !c.is_empty())
        {
            let names = head.cells.len();
            let help = "one name for each column; numbers with commas need semicolons or tabs between columns";
            let found = format!("{} cells", row.cells.len());
            return Err(rows.error(
                &row,
                "",
                &format!("{names} cells, the number of names"),
                &found,
                help,
            ));
        }
        let mut cell = |column: &Column| -> Result<Option<f64>, TableError> {
            match row.cells.get(column.index).unwrap_or_default() {
                "" => Ok(None),
                text => match numbers.read(text, factor(column)) {
                    Ok(x) => Ok(Some(x)),
                    Err((expected, help)) => {
                        let place = (column.index, column.name.as_str());
                        Err(rows.error_in(&row, place, expected, help))
                    }
                },
            }
        };
        let time = cell(time_column)?;
        let values = others
            .iter()
            .map(|c| cell(c))
            .collect::<Result<Vec<_>, _>>()?;
        let place = (time_column.index, time_column.name.as_str());
        match time {
            None if values.iter().all(Option::is_none) => {}
            None => {
                let help = "give a time in every row with data";
                return Err(rows.error_in(&row, place, "a time", help));
            }
            Some(t) => {
                if let Some(before) = last.filter(|before| t <= *before) {
                    let what = if t == before {
                        "the same time again"
                    } else {
                        "an earlier time"
                    };
                    let expected = format!("a time after {before:e} s");
                    let help = "sort the rows by time and keep one row for each time";
                    let mut error = rows.error_in(&row, place, &expected, help);
                    error.found = format!("{}, {what}", error.found);
                    return Err(error);
                }
                last = Some(t);
                for (channel, x) in channels.iter_mut().zip(values) {
                    if let Some(x) = x {
                        channel.time.push(t);
                        channel.value.push(x);
                    }
                }
            }
        }
        more = rows.next(&mut row)?;
    }
    for (channel, column) in channels.iter().zip(&others) {
        if channel.time.len() < LEAST {
            let mut error = rows.error_in(
                &head,
                (column.index, &column.name),
                &format!("at least {LEAST} samples"),
                "leave the column out, or record more often",
            );
            error.found = format!("{}", channel.time.len());
            return Err(error);
        }
    }
    let mut lines = vec![table_line(&rows, &numbers, count)];
    lines.extend(found.read.iter().map(|c| unit_line(c, subjects)));
    for (channel, column) in channels.iter_mut().zip(&others) {
        if let Quantity::Force(m) = channel.quantity {
            let angle = subjects.meshes.get(m).map_or(0.0, |m| m.base_helix);
            lines.push(force_line(
                column.kind,
                angle,
                &subjects.told(channel.quantity),
            ));
            if column.kind == ForceKind::Transverse {
                channel.value.iter_mut().for_each(|f| *f /= angle.cos());
            }
        }
    }
    if !found.passed_over.is_empty() {
        let names: Vec<String> = found
            .passed_over
            .iter()
            .take(20)
            .map(|n| shown(n))
            .collect();
        lines.push(format!("ignored columns: {}", names.join(", ")));
    }
    let place = rows.error(&head, "", "", "", "");
    lines.extend(request.processing.apply(&mut channels, LEAST).map_err(
        |(expected, found, help)| TableError {
            expected,
            found,
            help,
            ..place
        },
    )?);
    Ok(Reference {
        channels,
        processing: lines,
        stated: stated(text),
        ..Reference::default()
    })
}

/// A row of units below the names, as instruments write them; cells that are no units leave it a row of numbers.
fn line_of_units(row: &Row, found: &mut Columns, subjects: &Subjects) -> bool {
    let unit = |c: &Column| {
        let cell = row.cells.get(c.index).unwrap_or_default();
        let bare = cell
            .trim_start_matches(['[', '('])
            .trim_end_matches([']', ')']);
        if bare.parse::<f64>().is_ok() {
            return None;
        }
        Some((bare.to_owned(), columns::factor(c.role, bare, subjects)?))
    };
    let units: Option<Vec<_>> = found.read.iter().map(unit).collect();
    let Some(units) = units else { return false };
    for (column, unit) in found.read.iter_mut().zip(units) {
        column.unit.get_or_insert(unit);
    }
    true
}

fn table_line(rows: &Rows<'_>, numbers: &Numbers, count: usize) -> String {
    let commas = match numbers.comma {
        Some(true) => ", decimal commas",
        _ => "",
    };
    let delimiter = rows.delimiter.words();
    format!("{count} rows, {delimiter} between columns{commas}")
}

fn unit_line(c: &Column, subjects: &Subjects) -> String {
    let (unit, factor) = c.unit.as_ref().map_or(("", 1.0), |(u, f)| (u.as_str(), *f));
    let told = c.role.told(subjects);
    let name = shown(&c.name);
    match factor == 1.0 {
        true => format!("{told}: column {name} in SI units"),
        false => format!("{told}: column {name} in {unit}, times {factor:.7} to SI units"),
    }
}

fn force_line(kind: ForceKind, angle: f64, what: &str) -> String {
    let degrees = angle.to_degrees();
    match kind {
        _ if angle == 0.0 => {
            format!(
                "{what}: normal force, which in spur gears is equal to the force in the transverse plane"
            )
        }
        ForceKind::Normal => {
            format!("{what}: read as the normal force (base helix angle {degrees:.4} degrees)")
        }
        ForceKind::Transverse => format!(
            "{what}: given in the transverse plane, divided by cos(beta_b) = {:.6} to the normal force (base helix angle {degrees:.4} degrees)",
            angle.cos()
        ),
    }
}

/// Conditions that comments state: `key = number` with the key of a scene.
fn stated(text: &str) -> Vec<(String, f64)> {
    let lines = comments(text).filter_map(|l| l.split_once(" = "));
    let of_scene = |key: &str| key.contains('.') || key.ends_with("_s") || key.ends_with("_m");
    lines
        .filter_map(|(key, x)| Some((key.trim().to_owned(), x.trim().parse().ok()?)))
        .filter(|(key, x): &(String, f64)| of_scene(key) && !key.contains(' ') && x.is_finite())
        .take(1000)
        .collect()
}
