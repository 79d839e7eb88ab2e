//! Plan of a study of stability: maps with their axes, and the order of their cells.

use super::axis::Axis;
use super::setup::{AxisError, Setup};
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use gearbench_integrators::MethodSpec;
use gearbench_reports::record::Tolerance;
use gearbench_reports::stability::Columns;

/// Parameter of an axis with its values.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedAxis {
    pub axis: Axis,
    /// Values of the parameter, ascending, the scene's own among them.
    pub values: Vec<f64>,
    /// Index of the scene's own value.
    pub own: usize,
}

impl PlannedAxis {
    /// Creates an axis for a model: the scene's own value replaces a value close to it, or is added.
    ///
    /// # Errors
    /// [`AxisError`] when the parameter does not go with the model or the method.
    pub fn new(axis: Axis, values: &[f64], setup: &Setup) -> Result<Self, AxisError> {
        let own = axis.own(setup)?;
        let mut values: Vec<f64> = (values.iter())
            .map(|x| if axis.is_count() { x.round() } else { *x })
            .filter(|x| (x - own).abs() > NEXT_TO * own.abs())
            .collect();
        values.push(own);
        values.sort_by(f64::total_cmp);
        values.dedup();
        let own = values.iter().position(|x| *x == own).unwrap_or(0);
        Ok(PlannedAxis { axis, values, own })
    }
}

/// Relative distance to the scene's own value up to which a value is replaced by it.
const NEXT_TO: f64 = 0.12;

/// Map of one model under one integrator.
#[derive(Clone, Debug)]
pub struct MapPlan {
    /// Number of the set; maps of one set share axes and duration.
    pub set: usize,
    /// Index of the model in the plan.
    pub entry: usize,
    pub method: MethodSpec,
    /// True if the integrator is implicit.
    pub implicit: bool,
    /// Kind of the columns: steps, or tolerances for methods that choose their steps.
    pub columns: Columns,
    /// Values of the columns, steps [s] or tolerances, ascending.
    pub at: Vec<f64>,
    /// Axes of the map, one or two parameters.
    pub axes: Vec<PlannedAxis>,
    /// Simulated time of each run [s].
    pub duration: f64,
    /// Bound on the steps of a run, rejected ones included.
    pub max_steps: u64,
}

impl MapPlan {
    /// Returns the number of rows; the first axis varies fastest.
    pub fn rows(&self) -> usize {
        self.axes.iter().map(|a| a.values.len()).product()
    }

    pub fn len(&self) -> usize {
        self.rows() * self.at.len()
    }

    /// Returns the row of the scene's own parameters.
    pub fn own_row(&self) -> usize {
        let mut place = 1;
        let mut row = 0;
        for a in &self.axes {
            row += place * a.own;
            place *= a.values.len();
        }
        row
    }

    /// Returns the value of every axis in a row.
    pub fn values(&self, row: usize) -> Vec<(Axis, f64)> {
        let mut rest = row;
        (self.axes.iter())
            .map(|a| {
                let value = a.values[rest % a.values.len()];
                rest /= a.values.len();
                (a.axis, value)
            })
            .collect()
    }
}

/// Plan of a study of stability.
#[derive(Clone, Debug)]
pub struct Plan {
    pub conditions: Conditions,
    pub entries: Vec<Configuration>,
    /// Maps of the study, in the order of the record.
    pub maps: Vec<MapPlan>,
    /// Tolerance for accurate cells, against the model's own converged solution.
    pub tolerance: Tolerance,
    /// True if the largest stable step is refined by further runs.
    pub refine: bool,
}

impl Plan {
    /// Returns scene, models and integrator of a row of a map.
    pub fn setup(&self, map: &MapPlan, row: usize) -> Result<Setup, AxisError> {
        let mut setup = self.own(map);
        for (axis, value) in map.values(row) {
            axis.apply(value, &mut setup)?;
        }
        Ok(setup)
    }

    /// Returns the set-up of a map at the scene's own parameters.
    pub fn own(&self, map: &MapPlan) -> Setup {
        let entry = &self.entries[map.entry];
        Setup {
            scene: entry.scene.clone(),
            modelling: entry.modelling.clone(),
            method: map.method,
        }
    }

    /// Returns the number of cells of all maps.
    pub fn cells(&self) -> usize {
        self.maps.iter().map(MapPlan::len).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_their_values() {
        let axis = |axis, values: &[f64], own| PlannedAxis {
            axis,
            values: values.to_vec(),
            own,
        };
        let map = MapPlan {
            set: 0,
            entry: 2,
            method: gearbench_integrators::table::GENERALISED_ALPHA,
            implicit: true,
            columns: Columns::Step,
            at: vec![1e-7, 1e-6],
            axes: vec![
                axis(Axis::RhoInf, &[0.0, 0.5, 1.0], 1),
                axis(Axis::Speed, &[1.0, 2.0], 1),
            ],
            duration: 1e-3,
            max_steps: 1000,
        };
        assert_eq!((map.rows(), map.len(), map.own_row()), (6, 12, 4));
        assert_eq!(map.values(4), [(Axis::RhoInf, 0.5), (Axis::Speed, 2.0)]);
    }
}
