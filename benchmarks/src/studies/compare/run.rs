//! Runs of a comparison, and their errors against references and yardstick.

use super::plan::Plan;
use super::yardstick::{REFINED, YardstickChoice, most_detailed, of_entry, of_stored, refined};
use crate::experiment::configuration::Configuration;
use crate::experiment::converged::{ConvergedResult, candidates, of_model};
use crate::experiment::decimation::decimate_run;
use crate::experiment::key::Key;
use crate::experiment::linear_models::mesh_modes;
use crate::experiment::run::{Job, LEFT_OUT, NO_BOUND, RunError, run};
use crate::experiment::runner::Runner;
use crate::experiment::status::{against_contact, judge};
use gearbench_integrators::Scheme;
use gearbench_models::spec::MeshSpec;
use gearbench_reports::comparison::{CompareRecord, Kind, Yardstick};
use gearbench_reports::metrics::meshes::mesh_forces;
use gearbench_reports::metrics::{Metric, compare as measure, compare_all};
use gearbench_reports::numbers::quantity;
use gearbench_reports::record::{Metrics, Part, ReferenceSeries, Results, Run, SELF, Tolerance};
use gearbench_reports::series::TimeSeries;
use std::fmt::Display;

/// Runs all models and integrators of a comparison and evaluates their errors.
///
/// # Errors
/// [`RunError`] when a model cannot be built, or nothing of what is asked for can run.
pub fn compare(plan: &Plan, runner: &Runner<'_>) -> Result<Results, RunError> {
    let grid = plan.conditions.grid();
    let mut runs = Vec::with_capacity(plan.len());
    // What only the built models and their runs show.
    let mut found = Vec::new();
    let mut refused = None;
    let mut references: Vec<ReferenceSeries> = plan.references.clone();
    let mut tolerance = plan.tolerance.clone();
    let mut wanted = plan.wanted.clone();
    let mut yardstick = match &wanted {
        // With several references the tolerance names the relevant one.
        _ if !references.is_empty()
            && tolerance.as_ref().is_none_or(|t| is_stored(&references, t)) =>
        {
            let named =
                (references.iter()).find(|r| tolerance.as_ref().is_some_and(|t| t.against == r.id));
            named.or(references.first()).map(of_stored)
        }
        _ => None,
    };
    let mut no_refined = String::new();
    if let YardstickChoice::Refined(problem) = &plan.wanted {
        match refined(plan, problem, runner)? {
            Ok(made) => {
                references.insert(0, made.reference);
                yardstick = Some(made.yardstick);
            }
            Err(why) => {
                no_refined = format!("no refined gears were made: {why}");
                wanted = most_detailed(&plan.conditions.context.models, &plan.entries)
                    .map_or(YardstickChoice::Stored, YardstickChoice::MostDetailed);
                if let (Some(t), Some(label)) = (
                    tolerance.as_mut().filter(|t| t.against == REFINED),
                    wanted.label(),
                ) {
                    t.against = label.to_owned();
                }
            }
        }
    }
    // The model that is a reference runs first, and keeps its place in the record.
    let is_reference = |e: &Configuration| wanted.label() == Some(e.label.as_str());
    let mut order: Vec<usize> = (0..plan.entries.len()).collect();
    order.sort_by_key(|&i| !is_reference(&plan.entries[i]));
    let mut by_entry: Vec<Vec<Run>> = vec![Vec::new(); plan.entries.len()];
    for i in order {
        let entry = &plan.entries[i];
        let done: usize = by_entry.iter().map(Vec::len).sum();
        let runs = &mut by_entry[i];
        let job = |method| {
            let of = (&entry.scene, &entry.modelling);
            Job {
                histories: true,
                ..plan.conditions.job(of, method, &grid)
            }
        };
        let mut own: Option<ConvergedResult> = None;
        let asked = plan.methods_of(entry);
        let mut pictured = false;
        for method in plan.methods_of(entry) {
            let pictures = plan.pictures_of(entry, method);
            let own_job = || Job {
                pictures: pictures.as_ref(),
                motion: !pictured,
                ..job(method)
            };
            let report = |what: &dyn Display| {
                let what = format!("{}, {what}", entry.label);
                runner.report_progress(done + runs.len(), plan.len(), &what);
            };
            report(&method.method);
            let held = (
                &references,
                &tolerance,
                &yardstick,
                asked,
                plan.ripple_above,
            );
            let mut make = || {
                let mut row = run(&own_job())?;
                row.published_s = entry.published;
                row.published_derived = entry.published_derived;
                // The first run gives the number of coordinates of the model.
                let own = match &mut own {
                    Some(own) => own,
                    none => {
                        report(&"converged solution");
                        let candidates = candidates(&row, asked);
                        // Neither the time that a run may take nor the machine has any part in it.
                        let job = Job {
                            timeout: NO_BOUND,
                            ..job(method)
                        };
                        let key = Key::new("converged solution")
                            .and_scene(job.scene, job.modelling)
                            .and(&(job.t_end, job.grid, job.measurable, &candidates));
                        let found = runner.piece(key, || of_model(&job, &row, &candidates));
                        none.insert(found?)
                    }
                };
                // Of the reference itself and its model the converged solution is the judge.
                let tolerance = (tolerance.as_ref())
                    .filter(|t| !(is_reference(entry) && t.against == entry.label));
                let limits = (tolerance, yardstick.as_ref());
                measure_against(&mut row, method, limits, &references, own);
                if let (Ok(_), Some(series)) = (row.finished(), &row.series) {
                    row.mesh_forces = mesh_forces(series, &meshes_of(entry), plan.ripple_above);
                }
                Ok::<_, RunError>(row)
            };
            let mut row = match runner.row(own_job().key().and(&held), method, &mut make) {
                // Not every method is for every model; the record says which pairs it has not.
                Err(e) if e.leaves_out() => {
                    let pair = format!("{} under {}: {e}", entry.label, method.method);
                    found.push((LEFT_OUT.into(), pair));
                    refused.get_or_insert(e);
                    continue;
                }
                other => other?,
            };
            entry.sign(&mut row);
            if is_reference(entry)
                && runs.is_empty()
                && !row.status.is_failure()
                && let Some(series) = &row.series
            {
                references.insert(0, reference_of(entry, &row, series));
                if yardstick.is_none() {
                    let kind = match wanted {
                        YardstickChoice::Named(_) => Kind::Named,
                        _ => Kind::Model,
                    };
                    let metric = tolerance
                        .as_ref()
                        .map_or_else(Metric::default, |t| t.metric);
                    let id = (entry.label.as_str(), kind);
                    yardstick = Some(of_entry(id, &row, metric, &no_refined));
                }
            }
            // Outlines are the same for every integrator: one picture per model is enough.
            if pictured || row.status.is_failure() {
                (row.contacts, row.motion) = (None, None);
            } else {
                pictured = row.contacts.is_some();
            }
            decimate_run(&mut row, &references);
            runner.reserve_memory(&row);
            runs.push(row);
        }
    }
    let modes = plan
        .entries
        .iter()
        .zip(&by_entry)
        .filter_map(modes_that_act);
    found.extend(modes);
    runs.extend(by_entry.into_iter().flatten());
    if let Some(e) = refused.filter(|_| runs.is_empty()) {
        return Err(e);
    }
    runner.report_progress(runs.len(), plan.len(), "report");
    let mesh_modes = mesh_modes(
        &plan.entries,
        &plan.conditions.context.models,
        runner,
        false,
    )?;
    Ok(Results {
        mesh_modes,
        settings: [plan.conditions.settings.clone(), found].concat(),
        tolerance,
        references,
        runs,
        ..plan.conditions.record(Part::Compare(CompareRecord {
            published: plan.published.clone(),
            yardstick,
        }))
    })
}

/// Names of the gears of each mesh.
fn meshes_of(entry: &Configuration) -> Vec<[String; 2]> {
    let scene = &entry.scene;
    let of = |m: &MeshSpec| scene.names_of(m.gears).map(str::to_owned);
    scene.meshes.iter().map(of).collect()
}

/// Describes the number of modes of each gear of an elastic model, for which the settings are only upper bounds.
fn modes_that_act((entry, runs): (&Configuration, &Vec<Run>)) -> Option<(String, String)> {
    let run = runs.iter().find(|r| r.modes.is_some())?;
    let gears = entry.scene.gears.iter().zip(&run.modes_of_gears);
    let mut each: Vec<String> = gears.map(|(g, n)| format!("{} {n}", g.name)).collect();
    let highest = run
        .highest_hz
        .map(|f| format!("the highest at {}", quantity(f, "Hz", 3)));
    each.extend(highest);
    Some((format!("modes of {}", entry.label), each.join(", ")))
}

/// True if a tolerance refers to a stored reference, or to each model's own converged solution.
fn is_stored(references: &[ReferenceSeries], tolerance: &Tolerance) -> bool {
    tolerance.against == SELF || references.iter().any(|r| r.id == tolerance.against)
}

/// The run of an entry as a reference for others.
fn reference_of(entry: &Configuration, row: &Run, series: &TimeSeries) -> ReferenceSeries {
    ReferenceSeries {
        id: entry.label.clone(),
        title: format!("{}, {}", entry.model_label(), row.integrator),
        source: format!(
            "run of this record: {} coordinates, step or tolerance {:.1e}",
            row.dofs,
            row.step.or(row.rtol).unwrap_or(f64::NAN)
        ),
        series: series.clone(),
        ..ReferenceSeries::default()
    }
}

fn measure_against(
    row: &mut Run,
    method: &Scheme,
    (tolerance, yardstick): (Option<&Tolerance>, Option<&Yardstick>),
    references: &[ReferenceSeries],
    own: &ConvergedResult,
) {
    let Ok(run) = row.finished() else { return };
    let own = match own {
        Ok(own) => own.judges(method, row).map(|()| own),
        Err(why) => Err(why.clone()),
    };
    let mut metrics: Vec<Metrics> = (references.iter())
        .map(|r| compare_all(run, &r.all_series(), &r.id))
        .collect();
    metrics.extend((own.iter()).map(|own| measure(run, &own.series, SELF)));
    row.metrics.extend(metrics);
    if let Ok(own) = &own {
        row.own_solution = Some(own.by.clone());
        against_contact(row, &own.series);
    }
    judge(row, (tolerance, yardstick), own.err().as_deref());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::test_scene::coarse;
    use gearbench_integrators::table::{DOPRI5, TRIGONOMETRIC};

    /// Terms of rotation couple the modes: the method that is exact for oscillators is left out, also as the converged
    /// solution, and the others run.
    #[test]
    fn a_method_that_a_model_does_not_take_is_left_out() {
        let scene = coarse(&[("modes", 4.0.into()), ("spin_terms", "full".into())]);
        let choices: Vec<_> = scene.models.iter().collect();
        let methods = vec![TRIGONOMETRIC.at_step(1e-6), DOPRI5.at_tolerance(1e-5)];
        let plan = Plan::of(&scene, &choices, &[]).with_methods(methods);
        let results = compare(&plan, &Runner::default()).unwrap();
        assert_eq!(results.runs.len(), 1);
        let own = results.runs[0].against("self").and_then(|m| m.force_l2);
        assert!(own.is_some_and(|e| e < 0.01), "{own:?}");
        assert!(results.settings.iter().any(|(what, _)| what == LEFT_OUT));
    }
}
