//! One run of a map, and the converged solution that it is compared with.
//!
//! The converged solution is computed once per model and row: Dormand-Prince with located events at a tight tolerance;
//! of gears with modes the trigonometric method. It is trusted only when a second run, at another tolerance or by
//! another method, agrees with it to a fifth of the tolerance that cells are judged by. Where none is to be had the
//! energy ledger alone judges, and the cells say so.

use super::plan::{MapPlan, Plan};
use super::setup::Setup;
use crate::experiment::conditions::even;
use crate::experiment::run::{Job, RunError, run};
use gearbench_integrators::Resolution;
use gearbench_integrators::table::{DOPRI5, TRIGONOMETRIC};
use gearbench_integrators::{MethodSpec, Scheme};
use gearbench_models::gear::properties::Properties;
use gearbench_models::gear::table::properties_of;
use gearbench_reports::metrics::{Metric, compare};
use gearbench_reports::record::{Run, Status, Tolerance, finite};
use gearbench_reports::series::TimeSeries;
use gearbench_reports::stability::{Cell, Columns, SelfReference};
use std::time::{Duration, Instant};

/// Part of the tolerance within which two fine solutions must agree.
const AGREEMENT: f64 = 0.2;
/// Bound on the steps of a converged solution, over that of a cell.
const MORE_STEPS: u64 = 20;
/// Default metric and limit, for scenes without a tolerance for errors against a converged solution.
const DEFAULT_METRIC: Metric = Metric::ForceL1;
const DEFAULT_LIMIT: f64 = 0.05;

/// Solutions that are tried, finest first: the solution, and the run that checks it.
const SMALL: [[(MethodSpec, f64); 2]; 2] = [
    [(DOPRI5, 1e-9), (DOPRI5, 1e-7)],
    [(DOPRI5, 1e-7), (DOPRI5, 1e-5)],
];
const WITH_MODES: [[(MethodSpec, f64); 2]; 1] = [[(TRIGONOMETRIC, 1e-4), (DOPRI5, 1e-5)]];

/// Returns the tolerance of the cells: that of the scene, against the model's own converged solution.
pub fn tolerance(scene: Option<&Tolerance>) -> Tolerance {
    let own = scene.filter(|t| t.metric.is_error());
    Tolerance {
        metric: own.map_or(DEFAULT_METRIC, |t| t.metric),
        limit: own.map_or(DEFAULT_LIMIT, |t| t.limit),
        against: "self".into(),
        except: Vec::new(),
    }
}

/// Converged solution, or the reason why there is none.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Reference {
    /// Histories of the converged solution; `None` where there is none.
    pub series: Option<TimeSeries>,
    /// Description of the converged solution in the record.
    pub told: SelfReference,
}

fn run_one(
    plan: &Plan,
    map: &MapPlan,
    setup: &Setup,
    method: &Scheme,
    max_steps: u64,
) -> Result<Run, RunError> {
    let grid = even(plan.conditions.samples, map.duration);
    run(&Job {
        t_end: map.duration,
        repeats: 0,
        max_steps,
        ..(plan.conditions).job((&setup.scene, &setup.modelling), method, &grid)
    })
}

/// Error of one run against another in the metric of the tolerance.
fn error(row: &Run, against: &TimeSeries, tolerance: &Tolerance) -> Option<f64> {
    let metrics = compare(row.finished().ok()?, against, "self");
    metrics.get(tolerance.metric).map(f64::abs).and_then(finite)
}

/// Computes the converged solution of a set-up.
pub fn reference(plan: &Plan, map: &MapPlan, setup: &Setup) -> Result<Reference, RunError> {
    let any = |has: fn(Properties) -> bool| {
        let mut gears = setup.modelling.gears.iter();
        gears.any(|g| has(properties_of(&plan.conditions.context.models, g.id())))
    };
    let mut why = String::new();
    let tried: &[[(MethodSpec, f64); 2]] = if any(|p| p.full_order) {
        why = "a converged solution of full finite elements takes too long".into();
        &[]
    } else if any(|p| p.modes) {
        &WITH_MODES
    } else {
        &SMALL
    };
    let budget = map.max_steps.saturating_mul(MORE_STEPS);
    for pair in tried {
        let [fine, check] = pair.map(|(method, rtol)| method.at_tolerance(rtol));
        let name = |m: &Scheme| match m.resolution {
            Resolution::Tolerance(r) => format!("{} rtol {r:.0e}", m.method),
            Resolution::Step(h) => format!("{} h {h:.0e} s", m.method),
        };
        let first = run_one(plan, map, setup, &fine, budget)?;
        if first.status.is_failure() {
            why = format!("{}: {}", name(&fine), first.status);
            continue;
        }
        let Some(series) = first.series else { continue };
        let second = run_one(plan, map, setup, &check, budget)?;
        if second.status.is_failure() {
            why = format!("{}: {}", name(&check), second.status);
            continue;
        }
        let method = format!("{}, checked by {}", name(&fine), name(&check));
        let Some(distance) = error(&second, &series, &plan.tolerance) else {
            why = "no contact force to compare".into();
            break;
        };
        if distance <= AGREEMENT * plan.tolerance.limit {
            return Ok(Reference {
                series: Some(series),
                told: SelfReference {
                    method,
                    checked: Some(distance),
                    missing: None,
                },
            });
        }
        why = format!("{method}: they differ by {distance:.1e}");
    }
    Ok(Reference {
        series: None,
        told: SelfReference {
            missing: Some(why),
            ..SelfReference::default()
        },
    })
}

/// Runs a cell at a step or tolerance and labels it; returns the cell and the wall time.
pub fn cell(
    plan: &Plan,
    map: &MapPlan,
    setup: &Setup,
    at: f64,
    reference: &Reference,
) -> Result<(Cell, Duration), RunError> {
    let begin = Instant::now();
    let method = setup.method.at(match map.columns {
        Columns::Step => Resolution::Step(at),
        Columns::Tolerance => Resolution::Tolerance(at),
    });
    let row = run_one(plan, map, setup, &method, map.max_steps)?;
    let (mut status, mut message) = (row.status, row.message.clone());
    let mut distance = None;
    if !status.is_failure() {
        let missing = |why: &str| format!("judged by the energy ledger alone: {why}");
        match &reference.series {
            Some(series) => match error(&row, series, &plan.tolerance) {
                Some(e) => {
                    distance = Some(e);
                    status = Status::Converged;
                    if e > plan.tolerance.limit {
                        status = Status::Inaccurate;
                        message = Some(format!(
                            "{} against the converged solution is {e:.3}, beyond {:.3}",
                            plan.tolerance.metric, plan.tolerance.limit
                        ));
                    }
                }
                None => message = Some(missing("no contact force to compare")),
            },
            None => {
                message = Some(missing(
                    reference
                        .told
                        .missing
                        .as_deref()
                        .unwrap_or("no converged solution"),
                ));
            }
        }
    }
    let cell = Cell {
        at,
        status,
        message,
        error: distance,
        energy_rel: row.ledger.residual_rel.and_then(finite),
        reached_s: finite(row.simulated_s),
        steps: row.steps,
        rejected: row.rejected,
        force_evaluations: row.force_evaluations,
        newton_iterations: row.newton_iterations,
    };
    Ok((cell, begin.elapsed()))
}
