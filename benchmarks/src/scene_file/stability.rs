//! `[study] stability`: the maps of `gearbench stability`.

use super::error::SceneError;
use super::reader::{Entry, Key, Section, key};
use crate::studies::stability::axis::{Axis, spaced};
use gearbench_integrators::{MethodError, MethodSpec};

pub(super) static STABILITY: &[Key] = &[
    key(
        "models",
        "labels of the models, default those of the study without full finite elements",
    ),
    key(
        "integrators",
        "list of \"id\" or \"id(name=value)\", default explicit and implicit methods with fixed steps",
    ),
    key(
        "duration_s",
        "simulated time in seconds, default that of the scene",
    ),
    key(
        "step_s",
        "steps in seconds, { from, to, points }, default around the fastest oscillation of the model",
    ),
    key(
        "rtol",
        "tolerances of methods that choose their steps, { from, to, points }, default 1e-9 to 1e-1",
    ),
    key(
        "axes",
        "one or two parameters, [{ axis = \"contact-stiffness\", from = 0.1, to = 100.0, points = 7 }]",
    ),
    key(
        "max_steps",
        "steps after which a run is a timeout, default 200000",
    ),
];
pub(super) static SPAN: &[Key] = &[
    key("from", "smallest value"),
    key("to", "greatest value"),
    key(
        "points",
        "number of values, evenly over the decades, default 12",
    ),
];
pub(super) static AXIS: &[Key] = &[
    key(
        "axis",
        "contact-stiffness, tooth-stiffness, damping, speed, modes, rho-inf or hht-alpha",
    ),
    key("from", "smallest value"),
    key("to", "greatest value"),
    key(
        "points",
        "number of values, evenly over the decades, default 8",
    ),
    key(
        "values",
        "the values themselves, in place of from, to and points",
    ),
];

/// Steps after which a run is a timeout when a scene does not say.
pub const MAX_STEPS: u64 = 200_000;
/// Columns of a map when nobody says.
pub const COLUMNS: usize = 12;
/// Rows of a map when nobody says.
pub const ROWS: usize = 8;
/// Cells along one side of a map at most.
pub const MOST: u32 = 400;

/// Values evenly over the decades.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Smallest.
    pub from: f64,
    /// Greatest.
    pub to: f64,
    /// Number.
    pub points: usize,
}

impl Span {
    /// The values.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        spaced(self.from, self.to, self.points)
    }
}

/// A parameter with the values that were asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisValues {
    /// The parameter.
    pub axis: Axis,
    /// Its values, ascending.
    pub values: Vec<f64>,
}

/// One set of maps: models under integrators over the same axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StabilitySet {
    /// Labels; `None` takes those of the study.
    pub models: Option<Vec<String>>,
    /// Integrators; `None` takes the usual ones.
    pub integrators: Option<Vec<MethodSpec>>,
    /// Simulated time [s].
    pub duration: Option<f64>,
    /// Steps [s].
    pub steps: Option<Span>,
    /// Tolerances.
    pub tolerances: Option<Span>,
    /// One or two parameters; none takes the contact stiffness.
    pub axes: Vec<AxisValues>,
    /// Bound on the steps of a run.
    pub max_steps: Option<u64>,
}

/// Reads `stability = { .. }`, or a list of such sets.
pub(super) fn sets(entry: &Entry<'_>, labels: &[&str]) -> Result<Vec<StabilitySet>, SceneError> {
    if entry.is_list() {
        entry.list()?.iter().map(|e| set(e, labels)).collect()
    } else {
        Ok(vec![set(entry, labels)?])
    }
}

fn set(entry: &Entry<'_>, labels: &[&str]) -> Result<StabilitySet, SceneError> {
    let s = entry.section("`stability`", STABILITY)?;
    let mut set = StabilitySet {
        models: (s.get("models"))
            .map(|e| super::study_plan::words(&e, labels))
            .transpose()?,
        integrators: s.get("integrators").map(|e| integrators(&e)).transpose()?,
        duration: s.get("duration_s").map(|e| positive(&e)).transpose()?,
        ..StabilitySet::default()
    };
    if let Some(e) = s.get("step_s") {
        set.steps = Some(span(&e.section("`step_s`", SPAN)?, COLUMNS, f64::INFINITY)?);
    }
    if let Some(e) = s.get("rtol") {
        set.tolerances = Some(span(&e.section("`rtol`", SPAN)?, COLUMNS, 1.0)?);
    }
    if let Some(e) = s.get("axes") {
        let list = e.list()?;
        if list.len() > 2 {
            return Err(e.error(
                format!("{} axes beside the step", list.len()),
                "expected one or two",
                "a map has the step and one parameter, small multiples a second one; write further sets of maps",
            ));
        }
        set.axes = list.iter().map(axis).collect::<Result<_, _>>()?;
        if let [a, b] = set.axes.as_slice()
            && a.axis == b.axis
        {
            return Err(list[1].error(
                format!("the axis `{}` stands twice", a.axis.id()),
                "again",
                "name another parameter or leave it out",
            ));
        }
    }
    if let Some(e) = s.get("max_steps") {
        set.max_steps = match e.whole()? {
            0 => {
                return Err(e.error(
                    "`max_steps` is 0",
                    "expected at least 1",
                    "200000 is the default",
                ));
            }
            n => Some(u64::from(n)),
        };
    }
    Ok(set)
}

fn positive(e: &Entry<'_>) -> Result<f64, SceneError> {
    match e.number()? {
        x if x > 0.0 => Ok(x),
        x => Err(e.error(
            format!("`{}` is {x}", e.name),
            "expected more than 0",
            "give it in SI units",
        )),
    }
}

/// Ids that the table of methods has, with admissible parameters.
fn integrators(entry: &Entry<'_>) -> Result<Vec<MethodSpec>, SceneError> {
    let one = |e: &Entry<'_>| {
        e.text()?.parse().map_err(|why: MethodError| {
            e.error(
                why.to_string(),
                "this method",
                "parameters stand in brackets: id(name=value); steps are those of the map",
            )
        })
    };
    entry.list()?.iter().map(one).collect()
}

fn span(s: &Section<'_>, points: usize, below: f64) -> Result<Span, SceneError> {
    let (from, to) = (s.need("from")?, s.need("to")?);
    let found = Span {
        from: positive(&from)?,
        to: positive(&to)?,
        points: count(s, points)?,
    };
    if found.to <= found.from {
        return Err(to.error(
            format!("`to` is {}, where the map has not begun", found.to),
            format!("expected more than {}", found.from),
            "give the smaller value as `from`",
        ));
    }
    if found.to >= below {
        return Err(to.error(
            format!("`to` is {}", found.to),
            format!("expected less than {below}"),
            "a tolerance is a part of the solution",
        ));
    }
    Ok(found)
}

fn count(s: &Section<'_>, default: usize) -> Result<usize, SceneError> {
    let Some(e) = s.get("points") else {
        return Ok(default);
    };
    match e.whole()? {
        n if (2..=MOST).contains(&n) => Ok(n as usize),
        n => Err(e.error(
            format!("`points` is {n}"),
            format!("expected 2 to {MOST}"),
            "12 steps and 8 values are usual",
        )),
    }
}

fn axis(entry: &Entry<'_>) -> Result<AxisValues, SceneError> {
    let s = entry.section("an axis", AXIS)?;
    let word = s.need("axis")?;
    let axis = word.word(&Axis::ALL.map(|a| (a.id(), a)))?;
    let [low, high] = axis.range();
    let within = |e: &Entry<'_>, x: f64| {
        if (low..=high).contains(&x) {
            Ok(())
        } else {
            Err(e.error(
                format!("the {} {x} cannot be", axis.name()),
                format!("expected {low} to {high}"),
                "leave it out",
            ))
        }
    };
    if let Some(e) = s.get("values") {
        if let Some(other) = ["from", "to", "points"].iter().find_map(|k| s.get(k)) {
            return Err(other.error(
                format!("`values` and `{}` are both given", other.name),
                "and this",
                "give the values themselves, or their ends and number",
            ));
        }
        let mut values = e.numbers()?;
        for x in &values {
            within(&e, *x)?;
        }
        values.sort_by(f64::total_cmp);
        values.dedup();
        return Ok(AxisValues { axis, values });
    }
    if s.get("from").is_none() && s.get("to").is_none() && !axis.defaults().is_empty() {
        return Ok(AxisValues {
            axis,
            values: axis.defaults(),
        });
    }
    let span = span(&s, ROWS, f64::INFINITY)?;
    within(&s.need("from")?, span.from)?;
    within(&s.need("to")?, span.to)?;
    Ok(AxisValues {
        axis,
        values: span.values(),
    })
}
