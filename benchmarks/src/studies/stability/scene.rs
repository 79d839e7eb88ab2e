//! `[study] stability` of a scene: maps that are computed by default, without options on the command line.

use super::axis::Axis;
use crate::experiment::conditions::logarithmic;
use crate::scene_file::SceneError;
use crate::scene_file::reading::Place;
use crate::scene_file::reading::keys::keys;
use crate::scene_file::reading::values::{Count, Distinct, Label, Method, Positive};
use gearbench_integrators::MethodSpec;

/// Default bound on the steps of a run.
pub const MAX_STEPS: u64 = 200_000;
/// Default number of columns of a map.
pub const COLUMNS: usize = 12;
/// Default number of rows of a map.
pub const ROWS: usize = 8;
/// Largest number of cells along one side of a map.
pub const MOST: u32 = 400;

keys! {
    /// A set of maps of stability.
    struct StabilityTable {
        /// labels of the models, default those of the study without full finite elements
        models: Option<Distinct<Label>>,
        /// list of "id" or "id(name=value)", default explicit and implicit methods with fixed steps
        integrators: Option<Vec<Method>>,
        /// simulated time in seconds, default that of the scene
        duration_s: Option<Positive>,
        /// steps in seconds, { from, to, points }, default around the fastest oscillation of the model
        step_s: Option<SpanTable>,
        /// tolerances of methods that choose their steps, { from, to, points }, default 1e-9 to 1e-1
        rtol: Option<SpanTable>,
        /// one or two parameters, [{ axis = "contact-stiffness", from = 0.1, to = 100.0, points = 7 }]
        axes: Option<Vec<AxisTable>>,
        /// steps after which a run is a timeout, default 200000
        max_steps: Option<Count<1, { u32::MAX }>>,
    }

    /// A range of values, evenly spaced over the decades.
    struct SpanTable {
        /// smallest value
        from: Positive,
        /// greatest value
        to: Positive,
        /// number of values, evenly over the decades, default 12
        points: Option<Count<2, MOST>>,
    }

    /// A parameter of a map of stability.
    struct AxisTable {
        /// contact-stiffness, tooth-stiffness, damping, speed, modes, rho-inf or hht-alpha
        axis: Axis,
        /// smallest value
        from: Option<Positive>,
        /// greatest value
        to: Option<Positive>,
        /// number of values, evenly over the decades, default 8
        points: Option<Count<2, MOST>>,
        /// the values themselves, in place of from, to and points
        values: Option<Vec<f64>>,
    }
}

/// Range of values, evenly spaced on a logarithmic scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Smallest value of the span.
    pub from: f64,
    /// Greatest value of the span.
    pub to: f64,
    /// Number of values, both ends included.
    pub points: usize,
}

impl Span {
    /// Returns the values, evenly spaced on a logarithmic scale.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        logarithmic(self.from, self.to, self.points)
    }
}

/// Parameter of an axis with its requested values.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisValues {
    /// Parameter of the axis.
    pub axis: Axis,
    /// Values of the parameter, ascending.
    pub values: Vec<f64>,
}

/// Set of maps: models under integrators over the same axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StabilitySet {
    /// Labels of the models; `None` takes those of the study.
    pub models: Option<Vec<String>>,
    /// Integrators of the maps; `None` takes the defaults of the study.
    pub integrators: Option<Vec<MethodSpec>>,
    /// Simulated time [s]; `None` leaves it to the study.
    pub duration: Option<f64>,
    /// Span of the steps [s].
    pub steps: Option<Span>,
    /// Span of the relative tolerances.
    pub tolerances: Option<Span>,
    /// Axes with one or two parameters; without any the axis is the contact stiffness.
    pub axes: Vec<AxisValues>,
    /// Bound on the steps of a run.
    pub max_steps: Option<u64>,
}

impl AxisValues {
    /// Creates the values of a parameter, sorted and without duplicates.
    ///
    /// # Errors
    /// The first value that the parameter cannot have.
    pub fn new(axis: Axis, mut values: Vec<f64>) -> Result<Self, f64> {
        let [low, high] = axis.range();
        if let Some(x) = values.iter().find(|x| !(low..=high).contains(*x)) {
            return Err(*x);
        }
        values.sort_by(f64::total_cmp);
        values.dedup();
        Ok(AxisValues { axis, values })
    }
}

impl StabilityTable {
    /// Validates the keys and returns the set of maps that they describe.
    pub(crate) fn read(self, at: &Place<'_>) -> Result<StabilitySet, SceneError> {
        let span = |keys: Option<SpanTable>, key: &str, below: f64| {
            let read = |keys: SpanTable| {
                let points = keys.points.map_or(COLUMNS, |n| n.0);
                span([keys.from.0, keys.to.0], points, below, &at.key(key))
            };
            keys.map(read).transpose()
        };
        let lists = at.key("axes");
        let list = self.axes.unwrap_or_default();
        if list.len() > 2 {
            return lists.refuse(
                format!("{} axes besides the step", list.len()),
                "expected one or two",
                "a map has the step and one parameter, small multiples a second one; write further sets of maps",
            );
        }
        let axes = (list.into_iter().enumerate())
            .map(|(i, keys)| keys.read(&lists.member(i)))
            .collect::<Result<Vec<_>, _>>()?;
        if let [a, b] = axes.as_slice()
            && a.axis == b.axis
        {
            return lists.member(1).refuse(
                format!("the axis `{}` is given twice", a.axis.id()),
                "again",
                "name another parameter, or remove it",
            );
        }
        Ok(StabilitySet {
            models: self.models.map(Distinct::labels),
            integrators: (self.integrators).map(|list| list.into_iter().map(|m| m.0).collect()),
            duration: self.duration_s.map(f64::from),
            steps: span(self.step_s, "step_s", f64::INFINITY)?,
            tolerances: span(self.rtol, "rtol", 1.0)?,
            axes,
            max_steps: self.max_steps.map(|n| n.0 as u64),
        })
    }
}

/// Values evenly over the decades, from the smaller to the greater one.
fn span(
    [from, to]: [f64; 2],
    points: usize,
    below: f64,
    at: &Place<'_>,
) -> Result<Span, SceneError> {
    if to <= from {
        return at.key("to").refuse(
            format!("`to` is {to}, below the start of the map"),
            format!("expected more than {from}"),
            "give the smaller value as `from`",
        );
    }
    if to >= below {
        return at.key("to").refuse(
            format!("`to` is {to}"),
            format!("expected less than {below}"),
            "a tolerance is a part of the solution",
        );
    }
    Ok(Span { from, to, points })
}

impl AxisTable {
    fn read(self, at: &Place<'_>) -> Result<AxisValues, SceneError> {
        let axis = self.axis;
        let values = if let Some(values) = self.values {
            let others = ["from", "to", "points"];
            if let Some(key) = others.into_iter().find(|key| at.has(key)) {
                return at.key(key).refuse(
                    format!("`values` and `{key}` are both given"),
                    "and this",
                    "give the values themselves, or their ends and number",
                );
            }
            values
        } else {
            match (self.from, self.to) {
                (None, None) if !axis.defaults().is_empty() => axis.defaults(),
                (Some(from), Some(to)) => {
                    let points = self.points.map_or(ROWS, |n| n.0);
                    span([from.0, to.0], points, f64::INFINITY, at)?.values()
                }
                (None, _) => return Err(at.missing("from", &Self::TABLE)),
                (_, None) => return Err(at.missing("to", &Self::TABLE)),
            }
        };
        AxisValues::new(axis, values).map_err(|x| {
            let [low, high] = axis.range();
            at.first(&["values", "from"]).error(
                format!("the {} {x} cannot be", axis.name()),
                format!("expected {low} to {high}"),
                "leave it out",
            )
        })
    }
}
