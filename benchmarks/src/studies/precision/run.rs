//! Runs of the study of accuracy against cost.

use super::plan::{Full, Plan, Variant};
use crate::experiment::budget::NOT_TRIED;
use crate::experiment::converged::{
    Candidate, Converged, ConvergedResult, SMALL, candidates, converged, exact_for_modes,
};
use crate::experiment::decimation::decimate;
use crate::experiment::key::Key;
use crate::experiment::run::{Job, LEFT_OUT, NO_BOUND, RunError, run, run_timed};
use crate::experiment::runner::Runner;
use crate::experiment::status::judge;
use gearbench_integrators::{MethodSpec, Scheme};
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_reports::metrics::{compare as measure, compare_all};
use gearbench_reports::precision::PrecisionRecord;
use gearbench_reports::record::{
    ConvergedSettings, Part, ReferenceSeries, Results, Run, SELF, Status,
};
use gearbench_reports::series::TimeSeries;
use std::fmt::Display;

#[cfg(test)]
mod tests;

/// Tolerances tried for the converged solution of gears with modes and the steps each may take. A tenth of the finest
/// tolerance of a series, where that is affordable.
const EXACT_MODES: [(f64, u64); 3] = [(1e-6, 1_000_000), (1e-4, 1_500_000), (1e-3, 1_500_000)];
/// Step of the converged solution of a full model that is no reference over the finest of its series: a method of second
/// order then leaves a tenth of the error.
const FINER: f64 = 0.3;
/// Steps of a reference with a fixed step at most.
const MOST_STEPS: u64 = 20_000_000;

/// Key of the setting that lists resolutions that were left out.
const TOO_FINE: &str = "left out: finer than a run that took too long";
/// Key of the setting that lists converged solutions coarser than intended.
pub(super) const COARSE: &str = "converged less far than they should be";
/// Key of the setting that lists models with unknown integration errors.
const UNKNOWN: &str = "without a converged solution";

/// Runs all variants at all resolutions and computes their errors against the references.
///
/// # Errors
/// [`RunError`] when a model cannot be built, a reference does not reach the end, or the user interrupts.
pub fn study(plan: &Plan, runner: &Runner<'_>) -> Result<Results, RunError> {
    let study = Study {
        plan,
        grid: plan.conditions.grid(),
    };
    let mut notes: Vec<(String, String)> = Vec::new();
    let mut computed: Vec<(ReferenceSeries, Converged)> = Vec::new();
    for full in &plan.fulls {
        let what = format!("reference {}", full.id);
        if runner.budget().is_spent() {
            return Err(RunError::Reference(format!(
                "the budget of {} was used up before the reference {}; increase it (--budget), or name another reference (--against)",
                runner.budget().described(),
                full.id
            )));
        }
        runner.report_progress(computed.len(), plan.len(), &what);
        let entry = &full.entry;
        let key = Key::new("reference")
            .and_scene(&entry.scene, &entry.modelling)
            .and(&(&full.method, &study.grid));
        let (record, found) = runner.piece(key, || study.reference(full))?;
        if let Some(short) = short_of(&found, &format!("the reference {}", full.id)) {
            note(&mut notes, COARSE, short);
        }
        computed.push((record, found));
    }
    let mut references: Vec<(&str, Vec<&TimeSeries>)> = Vec::new();
    references.extend((plan.external.iter()).map(|e| (e.id.as_str(), e.all_series())));
    references.extend((computed.iter()).map(|(r, own)| (r.id.as_str(), vec![&own.series])));

    let full_names: Vec<String> = plan.fulls.iter().map(|f| format!("{f:?}")).collect();
    let mut runs: Vec<Run> = Vec::with_capacity(plan.len());
    let mut done = plan.fulls.len();
    for variant in &plan.variants {
        let mut own: Option<ConvergedResult> = None;
        // Integrators that cannot run this model, or whose steps have become too many.
        let mut closed: Vec<MethodSpec> = Vec::new();
        for method in &variant.methods {
            done += 1;
            if closed.contains(&method.method) {
                continue;
            }
            let label = variant.label();
            if runner.budget().is_spent() {
                let rest = format!("{label} under {}", method.described());
                note(&mut notes, NOT_TRIED, rest);
                continue;
            }
            let report = |what: &dyn Display| {
                runner.report_progress(done - 1, plan.len(), &format!("{label}, {what}"));
            };
            report(&method.method);
            let job = study.job((&variant.entry.scene, &variant.entry.modelling), method);
            let held = (&variant.against, &plan.external, &full_names, plan.timed);
            let make = || {
                let mut row = run_timed(&job, plan.timed)?;
                let own = match &mut own {
                    Some(own) => own,
                    none => {
                        report(&"converged solution");
                        let key = Key::new("converged solution")
                            .and_scene(job.scene, job.modelling)
                            .and(&(&study.grid, &variant.methods));
                        let found: ConvergedResult =
                            runner.piece(key, || study.own_solution(variant, &row, &computed))?;
                        match &found {
                            Ok(own) => {
                                if let Some(short) = short_of(own, &label) {
                                    note(&mut notes, COARSE, short);
                                }
                            }
                            Err(why) => note(&mut notes, UNKNOWN, format!("{label}: {why}")),
                        }
                        none.insert(found)
                    }
                };
                measure_against(&mut row, variant, method, &references, own);
                Ok::<_, RunError>(row)
            };
            let mut row = match runner.row(job.key().and(&held), method, make) {
                Err(e) if e.leaves_out() => {
                    let pair = format!("{} under {}: {e}", variant.entry.label, method.method);
                    note(&mut notes, LEFT_OUT, pair);
                    closed.push(method.method);
                    continue;
                }
                other => other?,
            };
            let steps = method.resolution.step().is_some();
            if row.status == Status::Timeout && !finest(variant, method) {
                let kind = if steps { "steps" } else { "tolerances" };
                note(
                    &mut notes,
                    TOO_FINE,
                    format!("{label} under {}, finer {kind}", method.method),
                );
                closed.push(method.method);
            }
            fill(&mut row, variant);
            runs.push(row);
        }
    }
    if let Some((_, rest)) = notes.iter_mut().find(|(what, _)| what == NOT_TRIED) {
        *rest = format!("{}: {rest}", runner.budget().described());
    }
    runner.report_progress(done, plan.len(), "report");
    let computed = computed.into_iter().map(|(r, _)| r);
    Ok(Results {
        settings: [plan.conditions.settings.clone(), notes].concat(),
        references: plan.external.iter().cloned().chain(computed).collect(),
        runs,
        ..plan.conditions.record(Part::Precision(PrecisionRecord {
            metrics: plan.metrics.clone(),
        }))
    })
}

/// Returns a note on the converged solution of gears with modes, if its tolerance is coarser than intended.
fn short_of(found: &Converged, whose: &str) -> Option<String> {
    let exact = exact_for_modes(EXACT_MODES[0].0);
    let (wanted, steps) = EXACT_MODES[0];
    let steps = steps as f64;
    (found.by.integrator == exact.method.to_string())
        .then_some(found.by.rtol?)
        .filter(|rtol| *rtol > wanted)
        .map(|rtol| {
            format!(
                "{whose} with {rtol:.0e} in place of {wanted:.0e}, which needs more than {steps:.0e} steps: the integration error is unknown for runs that are not ten times coarser"
            )
        })
}

/// Adds a setting, or to the one of its name.
fn note(notes: &mut Vec<(String, String)>, what: &str, text: String) {
    match notes.iter_mut().find(|(w, _)| w == what) {
        Some((_, told)) if told.contains(&text) => {}
        Some((_, told)) => {
            told.push_str("; ");
            told.push_str(&text);
        }
        None => notes.push((what.to_owned(), text)),
    }
}

/// True if an integrator is at the last resolution of its series.
fn finest(variant: &Variant, method: &Scheme) -> bool {
    let last = variant.methods.iter().rfind(|m| m.method == method.method);
    last == Some(method)
}

/// Completes a row by the label and the published times of its model. Histories and pictures of hundreds of runs are
/// not kept.
fn fill(row: &mut Run, variant: &Variant) {
    let entry = &variant.entry;
    entry.sign(row);
    row.published_s = entry.published;
    row.published_derived = entry.published_derived;
    // Number of modes that the model reports.
    row.modes = row.modes.or(variant.modes);
    row.contacts = None;
}

fn measure_against(
    row: &mut Run,
    variant: &Variant,
    method: &Scheme,
    references: &[(&str, Vec<&TimeSeries>)],
    own: &ConvergedResult,
) {
    let mut metrics = Vec::new();
    let own = match own {
        Ok(own) => own.judges(method, row).map(|()| own),
        Err(why) => Err(why.clone()),
    };
    if let Ok(run) = row.finished() {
        let held = (references.iter()).filter(|(id, _)| variant.against.iter().any(|a| a == id));
        metrics.extend(held.map(|(id, all)| compare_all(run, all, id)));
        metrics.extend((own.iter()).map(|own| measure(run, &own.series, SELF)));
        row.own_solution = own.as_ref().ok().map(|own| own.by.clone());
    }
    row.metrics.extend(metrics);
    row.series = None;
    judge(row, (None, None), own.err().as_deref());
}

struct Study<'a> {
    plan: &'a Plan,
    grid: Vec<f64>,
}

impl Study<'_> {
    fn job<'j>(&'j self, of: (&'j SceneSpec, &'j Modelling), method: &'j Scheme) -> Job<'j> {
        self.plan.conditions.job(of, method, &self.grid)
    }

    /// A job whose end no clock decides: all that runs are compared with is bounded by its work alone.
    fn untimed<'j>(&'j self, of: (&'j SceneSpec, &'j Modelling), method: &'j Scheme) -> Job<'j> {
        Job {
            repeats: 0,
            timeout: NO_BOUND,
            max_steps: MOST_STEPS,
            events: true,
            ..self.job(of, method)
        }
    }

    /// A reference as the record keeps it, and its whole history.
    fn reference(&self, full: &Full) -> Result<(ReferenceSeries, Converged), RunError> {
        let entry = &full.entry;
        let of = (&entry.scene, &entry.modelling);
        let mut coordinates = String::new();
        let found = match &full.method {
            Some(method) => {
                let row = run(&self.untimed(of, method))?;
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
            None => converged(
                &self.untimed(of, &exact_for_modes(EXACT_MODES[0].0)),
                &exact_modes(),
            )?,
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

    /// Computes the model's own converged solution; `row` has the size of the model.
    fn own_solution(
        &self,
        variant: &Variant,
        row: &Run,
        computed: &[(ReferenceSeries, Converged)],
    ) -> Result<ConvergedResult, RunError> {
        let entry = &variant.entry;
        // A model that is a reference has its converged solution already.
        let reference = self.plan.fulls.iter().find(|f| {
            f.entry.label == entry.label
                && (f.method.is_some() || f.entry.modelling.gears == entry.modelling.gears)
        });
        if let Some(full) = reference
            && let Some((_, own)) = computed.iter().find(|(r, _)| r.id == full.id)
        {
            return Ok(Ok(own.clone()));
        }
        let of = (&entry.scene, &entry.modelling);
        let tries: Vec<Candidate> = if row.modes.is_some() {
            let others = candidates(row, &variant.methods);
            exact_modes().into_iter().chain(others).collect()
        } else if row.dofs <= SMALL {
            candidates(row, &variant.methods)
        } else {
            // A full model: its own integrator at a part of the finest step.
            let steps = (variant.methods.iter()).filter_map(|m| Some((m.resolution.step()?, m)));
            let finest = steps.min_by(|a, b| a.0.total_cmp(&b.0));
            (finest.into_iter())
                .map(|(h, m)| (m.method.at_step(FINER * h), MOST_STEPS))
                .collect()
        };
        match tries.first() {
            Some((method, _)) => converged(&self.untimed(of, method), &tries),
            None => Ok(Err("no method with a fixed step to compute it with".into())),
        }
    }
}

/// Candidates for the converged solution of gears with modes.
fn exact_modes() -> Vec<Candidate> {
    let all = EXACT_MODES.into_iter();
    all.map(|(rtol, steps)| (exact_for_modes(rtol), steps))
        .collect()
}
