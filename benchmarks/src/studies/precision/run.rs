//! Runs of accuracy against cost.

use super::plan::{Full, Plan, Variant};
use crate::experiment::converged::{SMALL, converged, exact_for_modes, tight};
use crate::experiment::key::Key;
use crate::experiment::run::{Job, LEFT_OUT, RunError, run, run_timed};
use crate::experiment::runner::Runner;
use crate::experiment::thin::thin;
use gearbench_integrators::Resolution;
use gearbench_integrators::{MethodSpec, Scheme};
use gearbench_models::spec::{Modelling, SceneSpec};
use gearbench_reports::metrics::{compare as measure, compare_all};
use gearbench_reports::precision::PrecisionRecord;
use gearbench_reports::record::{Part, ReferenceSeries, Results, Run, SELF, Status};
use gearbench_reports::series::TimeSeries;
use std::fmt::Display;
use std::time::Duration;

#[cfg(test)]
mod tests;

/// Tolerances tried for the converged solution of gears with modes and the steps each may take. A hundredth of the
/// finest tolerance of a series, where that is affordable.
const EXACT_MODES: [(f64, u64); 3] = [(1e-6, 1_000_000), (1e-4, 2_500_000), (1e-3, 2_500_000)];
/// Step of the converged solution of a full model that is no reference over the finest of its series.
const FINER: f64 = 0.5;
/// So many times longer than others a reference may take.
const PATIENCE: u32 = 10;

/// The setting that says which resolutions were left out.
const TOO_FINE: &str = "left out: finer than a run that took too long";
/// The setting that says whose converged solution is coarser than it should be.
pub(super) const COARSE: &str = "converged less far than they should be";
/// The setting that says whose errors of integration are unknown.
const UNKNOWN: &str = "without a converged solution in the time of a run";

/// A converged solution of gears with modes.
type Exact = Option<(Scheme, TimeSeries)>;

/// Runs the study.
///
/// # Errors
/// [`RunError`] when a model cannot be built, a reference does not reach the end, or the user interrupts.
pub fn study(plan: &Plan<'_>, runner: &Runner<'_>) -> Result<Results, RunError> {
    let study = Study {
        plan,
        grid: plan.conditions.grid(),
    };
    let mut notes: Vec<(String, String)> = Vec::new();
    let mut computed: Vec<(ReferenceSeries, TimeSeries)> = Vec::new();
    for full in &plan.fulls {
        let what = format!("reference {}", full.id);
        runner.tell(computed.len(), plan.len(), &what);
        let entry = &full.entry;
        let key = Key::new("reference")
            .and_scene(&entry.scene, &entry.modelling)
            .and(&(&full.method, &study.grid, plan.conditions.timeout));
        let (record, series, short) = runner.piece(key, || study.reference(full))?;
        if let Some(rtol) = short {
            let bound = study.patient().as_secs_f64();
            note(
                &mut notes,
                COARSE,
                told_short(&format!("the reference {}", full.id), rtol, bound),
            );
        }
        computed.push((record, series));
    }
    let mut references: Vec<(&str, Vec<&TimeSeries>)> = Vec::new();
    references.extend((plan.external.iter()).map(|e| (e.id.as_str(), e.all_series())));
    references.extend((computed.iter()).map(|(r, s)| (r.id.as_str(), vec![s])));

    let full_names: Vec<String> = plan.fulls.iter().map(|f| format!("{f:?}")).collect();
    let mut runs: Vec<Run> = Vec::with_capacity(plan.len());
    let mut done = plan.fulls.len();
    for variant in &plan.variants {
        let mut own: Option<Option<TimeSeries>> = None;
        // Integrators that cannot run this model, or whose steps have become too many.
        let mut closed: Vec<MethodSpec> = Vec::new();
        for method in &variant.methods {
            done += 1;
            if closed.contains(&method.method) {
                continue;
            }
            let label = variant.label();
            let tell = |what: &dyn Display| {
                runner.tell(done - 1, plan.len(), &format!("{label}, {what}"));
            };
            tell(&method.method);
            let job = study.job((&variant.entry.scene, &variant.entry.modelling), method);
            let held = (&variant.against, &plan.external, &full_names, plan.timed);
            let make = || {
                let mut row = run_timed(&job, plan.timed)?;
                let own = match &mut own {
                    Some(own) => own,
                    none => {
                        tell(&"converged solution");
                        let key = Key::new("converged solution")
                            .and_scene(job.scene, job.modelling)
                            .and(&(&study.grid, plan.conditions.timeout));
                        let found =
                            runner.piece(key, || study.own_solution(variant, &row, &references));
                        let (found, short) = found?;
                        if let Some(rtol) = short {
                            let bound = plan.conditions.timeout.as_secs_f64();
                            note(&mut notes, COARSE, told_short(&label, rtol, bound));
                        } else if found.is_none() {
                            note(&mut notes, UNKNOWN, label.clone());
                        }
                        none.insert(found)
                    }
                };
                measure_against(&mut row, variant, &references, own.as_ref());
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
    runner.tell(done, plan.len(), "report");
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

/// A solution that has a coarser tolerance than the first in words.
fn told_short(whose: &str, rtol: f64, bound: f64) -> String {
    format!(
        "{whose} to {rtol:.0e} in place of {:.0e}, which did not end in {bound} s, or in its steps: runs at finer tolerances are less off than is told",
        EXACT_MODES[0].0
    )
}

/// The tolerance of a solution of gears with modes, where it is coarser than it should be.
fn short_of(found: &Exact) -> Option<f64> {
    match found.as_ref()?.0.resolution {
        Resolution::Tolerance(r) if r > EXACT_MODES[0].0 => Some(r),
        _ => None,
    }
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

/// Whether a method is the last of its series.
fn finest(variant: &Variant, method: &Scheme) -> bool {
    let last = variant.methods.iter().rfind(|m| m.method == method.method);
    last == Some(method)
}

/// What the caller of a run knows of it. Histories and pictures of hundreds of runs are nobody's business.
fn fill(row: &mut Run, variant: &Variant) {
    let entry = &variant.entry;
    entry.sign(row);
    row.published_s = entry.published;
    // The modes that were kept, as the model says.
    row.modes = row.modes.or(variant.modes);
    row.contacts = None;
}

fn measure_against(
    row: &mut Run,
    variant: &Variant,
    references: &[(&str, Vec<&TimeSeries>)],
    own: Option<&TimeSeries>,
) {
    let mut metrics = Vec::new();
    if let Ok(run) = row.finished() {
        let held = (references.iter()).filter(|(id, _)| variant.against.iter().any(|a| a == id));
        metrics.extend(held.map(|(id, all)| compare_all(run, all, id)));
        metrics.extend(own.map(|own| measure(run, own, SELF)));
    }
    row.metrics.extend(metrics);
    row.series = None;
}

struct Study<'a> {
    plan: &'a Plan<'a>,
    grid: Vec<f64>,
}

impl Study<'_> {
    fn job<'j>(&'j self, of: (&'j SceneSpec, &'j Modelling), method: &'j Scheme) -> Job<'j> {
        self.plan.conditions.job(of, method, &self.grid)
    }

    /// The time of a reference.
    fn patient(&self) -> Duration {
        PATIENCE * self.plan.conditions.timeout
    }

    /// A reference as the record keeps it, its whole history, and its tolerance where it is coarser than it should be.
    fn reference(
        &self,
        full: &Full,
    ) -> Result<(ReferenceSeries, TimeSeries, Option<f64>), RunError> {
        let entry = &full.entry;
        let mut short = None;
        let (series, method, dofs) = match &full.method {
            Some(method) => {
                let row = run(&Job {
                    repeats: 0,
                    timeout: self.patient(),
                    max_steps: u64::MAX,
                    events: true,
                    ..self.job((&entry.scene, &entry.modelling), method)
                })?;
                if row.status.is_failure() {
                    return Err(RunError::Reference(format!(
                        "{} under {} did not reach the end: {}",
                        full.id,
                        method.method,
                        row.message.as_deref().unwrap_or("no reason given")
                    )));
                }
                (row.series, *method, row.dofs)
            }
            None => {
                let found = self.exact((&entry.scene, &entry.modelling), self.patient())?;
                short = short_of(&found);
                let (method, series) = found.unzip();
                (
                    series,
                    method.unwrap_or_else(|| exact_for_modes(EXACT_MODES[0].0)),
                    0,
                )
            }
        };
        let Some(series) = series else {
            return Err(RunError::Reference(format!(
                "{}, which the others would be held against, has no converged solution: it may take {} s, {PATIENCE} times the bound of a run, and {} steps at a tolerance of {:.0e}; allow more (--timeout), shorten the scene ([study.precision] duration_s), or name another reference (--against)",
                full.id,
                self.patient().as_secs_f64(),
                EXACT_MODES[2].1,
                EXACT_MODES[2].0
            )));
        };
        let resolution = match method.resolution {
            Resolution::Step(h) => format!("step {h:.1e} s"),
            Resolution::Tolerance(r) => format!("rtol {r:.0e}"),
        };
        let coordinates = if dofs > 0 {
            format!("{dofs} coordinates ")
        } else {
            String::new()
        };
        let record = ReferenceSeries {
            id: full.id.clone(),
            title: full.title.clone(),
            source: format!(
                "computed for this record: {coordinates}under {}, {resolution}",
                method.method
            ),
            series: thin(&series),
            ..ReferenceSeries::default()
        };
        Ok((record, series, short))
    }

    /// The converged solution of gears with modes, by the finest tolerance that a time allows.
    fn exact(&self, of: (&SceneSpec, &Modelling), timeout: Duration) -> Result<Exact, RunError> {
        for (rtol, steps) in EXACT_MODES {
            let tries = [(exact_for_modes(rtol), steps)];
            let job = |method| Job {
                timeout,
                ..self.job(of, method)
            };
            if let Some(series) = converged(&job, 1, &tries)? {
                let [(method, _)] = tries;
                return Ok(Some((method, series)));
            }
        }
        Ok(None)
    }

    /// The model's own converged solution, and its tolerance where it is coarser than it should be; `row` says how large
    /// the model is.
    fn own_solution(
        &self,
        variant: &Variant,
        row: &Run,
        references: &[(&str, Vec<&TimeSeries>)],
    ) -> Result<(Option<TimeSeries>, Option<f64>), RunError> {
        let entry = &variant.entry;
        // A model that is a reference has its converged solution already.
        let reference = self.plan.fulls.iter().find(|f| {
            f.entry.label == entry.label
                && (f.method.is_some() || f.entry.modelling.gears == entry.modelling.gears)
        });
        if let Some(full) = reference {
            let found = references.iter().find(|(id, _)| *id == full.id);
            let whole = found.and_then(|(_, all)| all.first());
            return Ok((whole.map(|series| (*series).clone()), None));
        }
        if row.modes.is_some() {
            let of = (&entry.scene, &entry.modelling);
            match self.exact(of, self.plan.conditions.timeout) {
                // Terms of rotation couple the modes.
                Err(RunError::NoLinearPart(_)) => {}
                found => {
                    let found = found?;
                    let short = short_of(&found);
                    return Ok((found.map(|(_, series)| series), short));
                }
            }
        }
        let job = |method| Job {
            timeout: self.patient(),
            ..self.job((&entry.scene, &entry.modelling), method)
        };
        if row.dofs <= SMALL {
            return Ok((converged(&job, row.dofs, &tight())?, None));
        }
        // A full model: its own integrator on half the finest step.
        let steps = (variant.methods.iter()).filter_map(|m| Some((m.resolution.step()?, m)));
        let Some((h, method)) = steps.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            return Ok((None, None));
        };
        let own = converged(&job, 1, &[(method.method.at_step(FINER * h), u64::MAX)])?;
        Ok((own, None))
    }
}
