//! Solutions that runs of the study are compared with: references that the study computes, and the converged solution of
//! each variant of a model. No clock decides their end: their work alone is bounded.

use super::arguments::Precision;
use super::plan::Full;
use super::study::Resolution;
use crate::experiment::conditions::Conditions;
use crate::experiment::converged::{
    Candidate, Converged, ConvergedResult, SMALL, candidates, converged, exact_for_modes,
};
use crate::experiment::decimation::decimate;
use crate::experiment::error::StudyError;
use crate::experiment::key::Key;
use crate::experiment::run::{Job, NO_BOUND, RunError, run};
use crate::studies::tabular::{Cell, SharedWork};
use gearbench_integrators::Scheme;
use gearbench_reports::record::{ConvergedSettings, ReferenceSeries, Run};
use std::sync::Arc;

/// Tolerances tried for the converged solution of gears with modes and the steps each may take. A tenth of the finest
/// tolerance of a series, where that is affordable.
const EXACT_MODES: [(f64, u64); 3] = [(1e-6, 1_000_000), (1e-4, 1_500_000), (1e-3, 1_500_000)];
/// Step of the converged solution of a full model that is no reference over the finest of its series: a method of second
/// order then leaves a tenth of the error.
const FINER: f64 = 0.3;
/// Steps of one integration at most: a bound that does not depend on the machine.
pub(super) const MOST_STEPS: u64 = 20_000_000;

/// Candidates for the converged solution of gears with modes.
fn exact_modes() -> Vec<Candidate> {
    let all = EXACT_MODES.into_iter();
    all.map(|(rtol, steps)| (exact_for_modes(rtol), steps))
        .collect()
}

/// Describes how converged solutions of the study are computed.
pub(super) fn described() -> String {
    let [(finest, _), others @ ..] = EXACT_MODES;
    let others = others.map(|(rtol, _)| format!("{rtol:.0e}"));
    format!(
        "for gears with modes {} at rtol {finest:.0e} ({} if this needs too many steps); for full models their integrator at {FINER} of its finest step; for others {}",
        exact_for_modes(finest).method,
        others.join(", "),
        crate::experiment::converged::described()
    )
}

/// Returns how a converged solution of gears with modes falls short of the intended tolerance; `None` if it does not.
pub(super) fn short_of(by: &ConvergedSettings) -> Option<String> {
    let (wanted, _) = EXACT_MODES[0];
    let rtol = by.rtol.filter(|rtol| *rtol > wanted)?;
    (by.integrator == exact_for_modes(wanted).method.to_string())
        .then(|| format!("{rtol:.0e} in place of {wanted:.0e}"))
}

/// A job whose end no clock decides.
fn untimed<'j>(job: Job<'j>) -> Job<'j> {
    Job {
        repeats: 0,
        timeout: NO_BOUND,
        max_steps: MOST_STEPS,
        events: true,
        ..job
    }
}

impl Precision {
    /// A reference of the study as the record keeps it, and its whole history.
    pub(super) fn solution_of(
        &self,
        full: &Full,
        shared: &SharedWork<'_>,
    ) -> Result<Arc<(ReferenceSeries, Converged)>, StudyError> {
        let entry = &full.entry;
        let key = Key::new("reference")
            .and_scene(&entry.scene, &entry.modelling)
            .and(&(&full.id, &full.method, shared.grid));
        shared.piece(key, || Ok(reference(full, shared.conditions, shared.grid)?))
    }

    /// The converged solution of the variant of a cell; `row` has the size of its model.
    pub(super) fn own_solution(
        &self,
        cell: &Cell<Resolution>,
        job: &Job<'_>,
        row: &Run,
        shared: &SharedWork<'_>,
    ) -> Result<Arc<ConvergedResult>, StudyError> {
        let entry = &cell.configuration;
        // A model that is a reference has its converged solution already.
        let reference = self.plan.fulls.iter().find(|f| {
            f.entry.label == entry.label
                && (f.method.is_some() || f.entry.modelling.gears == entry.modelling.gears)
        });
        if let Some(full) = reference {
            let (_, own) = &*self.solution_of(full, shared)?;
            return Ok(Arc::new(Ok(own.clone())));
        }
        let methods = &cell.at.methods;
        let key = Key::new("converged solution")
            .and_scene(job.scene, job.modelling)
            .and(&(shared.grid, methods));
        shared.piece(key, || {
            let tries = tries(row, methods);
            Ok(match tries.first() {
                Some((method, _)) => converged(&untimed(Job { method, ..*job }), &tries)?,
                None => Err("no method with a fixed step to compute it with".into()),
            })
        })
    }
}

/// Candidates for the converged solution of a variant of a model.
fn tries(row: &Run, methods: &[Scheme]) -> Vec<Candidate> {
    if row.modes.is_some() {
        let others = candidates(row, methods);
        exact_modes().into_iter().chain(others).collect()
    } else if row.dofs <= SMALL {
        candidates(row, methods)
    } else {
        // A full model: its own integrator at a part of the finest step.
        let steps = (methods.iter()).filter_map(|m| Some((m.resolution.step()?, m)));
        let finest = steps.min_by(|a, b| a.0.total_cmp(&b.0));
        (finest.into_iter())
            .map(|(h, m)| (m.method.at_step(FINER * h), MOST_STEPS))
            .collect()
    }
}

fn reference(
    full: &Full,
    conditions: &Conditions,
    grid: &[f64],
) -> Result<(ReferenceSeries, Converged), RunError> {
    let of = (&full.entry.scene, &full.entry.modelling);
    let mut coordinates = String::new();
    let found = match &full.method {
        Some(method) => {
            let row = run(&untimed(conditions.job(of, method, grid)))?;
            coordinates = format!("{} coordinates ", row.dofs);
            let by = ConvergedSettings::from(&row);
            match row.series.filter(|_| !row.status.is_failure()) {
                Some(series) => Ok(Converged { by, series }),
                None => Err(format!(
                    "{}: {}",
                    method.described(),
                    row.message.as_deref().unwrap_or("no reason given")
                )),
            }
        }
        None => {
            let first = exact_for_modes(EXACT_MODES[0].0);
            converged(&untimed(conditions.job(of, &first, grid)), &exact_modes())?
        }
    };
    let own = found.map_err(|why| {
        RunError::Reference(format!(
            "the reference {} has no converged solution: {why}; shorten the scene ([study.precision] duration_s), or name another reference (--against)",
            full.id,
        ))
    })?;
    let record = ReferenceSeries {
        id: full.id.clone(),
        title: full.title.clone(),
        source: format!("computed for this record: {coordinates}under {}", own.by),
        series: decimate(&own.series, |_| false),
        ..ReferenceSeries::default()
    };
    Ok((record, own))
}
