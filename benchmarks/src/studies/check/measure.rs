//! Runs of the cases of a check, and the measurement of their runtimes.

use super::file::{Case, CheckFile};
use super::kernel;
use super::quantity::values;
use crate::cli::arguments::AnyReference;
use crate::cli::terminal::{Refusal, references_of};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::key::Key;
use crate::experiment::reference_series::recorded;
use crate::experiment::run::{Job, RunError, bare, run_in};
use crate::experiment::runner::Runner;
use crate::scene_file::{self, Selection};
use gearbench_integrators::{Resolution, Scheme};
use gearbench_models::scene::Scene;
use gearbench_reports::check::MeasuredEntry;
use gearbench_reports::record::{ReferenceSeries, Run};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Case with its scene, models, integrators and references.
pub(super) struct LoadedCase<'a> {
    pub(super) case: &'a Case,
    conditions: Conditions,
    configurations: Vec<Configuration>,
    methods: Vec<Scheme>,
    references: Vec<ReferenceSeries>,
}

/// Loads the scene of a case and builds its models.
///
/// # Errors
/// Errors of the scene, and of the settings of the case.
pub(super) fn load<'a>(
    context: &Context,
    file: &CheckFile,
    case: &'a Case,
) -> Result<LoadedCase<'a>, Refusal> {
    let labels = case.models.as_deref();
    let mut scene = scene_file::load_for(context, &case.scene, Selection::Labels(labels))?;
    let references = references_of(&mut scene, &AnyReference::default())?;
    let choices = scene.select(labels)?;
    // A model that cannot run is an entry as well: what is not measured has not passed.
    let refused = scene.refused.iter().filter_map(|r| scene.model(&r.label));
    let mut configurations: Vec<Configuration> = (choices.iter().copied())
        .chain(refused)
        .map(|c| Configuration::of(&scene, c))
        .collect();
    let mut methods = scene.study.integrators.clone();
    if let Some(text) = &case.integrators {
        methods = Scheme::list(text, &methods).map_err(|e| {
            file.about(
                case,
                e.to_string(),
                "`gearbench list` names the integrators",
            )
        })?;
        scene.check_steps(&methods)?;
        configurations.iter_mut().for_each(|c| c.methods = None);
    }
    Ok(LoadedCase {
        case,
        conditions: Conditions {
            events: scene.study.events,
            ..Conditions::of(&scene).compared_with(&scene.spec, &references)
        },
        configurations,
        methods,
        references: references
            .iter()
            .map(|r| recorded(r, &scene.spec))
            .collect(),
    })
}

/// Returns an integrator in the notation of the command line, with its step or tolerance.
fn written(scheme: &Scheme) -> String {
    // `500ns` and `5e-7s` are one step, whose last bit differs.
    let plain = |x: f64| format!("{x:.12e}").parse().unwrap_or(x);
    let resolution = match scheme.resolution {
        Resolution::Step(h) => Resolution::Step(plain(h)),
        Resolution::Tolerance(r) => Resolution::Tolerance(plain(r)),
    };
    Scheme {
        resolution,
        ..*scheme
    }
    .to_string()
}

fn work(run: &Run) -> BTreeMap<String, u64> {
    [
        ("steps", run.steps),
        ("rejected", run.rejected),
        ("force_evaluations", run.force_evaluations),
        ("newton_iterations", run.newton_iterations),
        ("factorisations", run.factorisations),
        ("events", run.events),
    ]
    .map(|(key, n)| (key.to_owned(), n))
    .into()
}

impl LoadedCase<'_> {
    /// Returns the names of the gears of the scene.
    pub(super) fn gears(&self) -> impl Iterator<Item = &str> {
        let scene = self.configurations.first().map(|c| &c.scene);
        let gears = scene.into_iter().flat_map(|s| &s.gears);
        gears.map(|g| g.name.as_str())
    }

    /// Returns the number of runs, one for each model and integrator of the case.
    pub(super) fn len(&self) -> usize {
        self.configurations
            .iter()
            .map(|c| self.methods_of(c).len())
            .sum()
    }

    fn methods_of<'s>(&'s self, c: &'s Configuration) -> &'s [Scheme] {
        c.methods.as_deref().unwrap_or(&self.methods)
    }

    /// Runs every model of the case under each of its integrators.
    ///
    /// # Errors
    /// [`RunError`] when a model cannot be built, or the user ended it.
    pub(super) fn measure(
        &self,
        runner: &Runner<'_>,
        (mut done, total): (usize, usize),
    ) -> Result<Vec<Group<'_>>, RunError> {
        let grid = self.conditions.grid();
        let ids: Vec<&str> = self.references.iter().map(|r| r.id.as_str()).collect();
        let mut all = Vec::new();
        for configuration in &self.configurations {
            let mut group = Group {
                of: self,
                configuration,
                built: None,
                entries: Vec::new(),
            };
            for method in self.methods_of(configuration) {
                let found = MeasuredEntry {
                    case: self.case.name.clone(),
                    scene: self.conditions.name.clone(),
                    model: configuration.label.clone(),
                    method: written(method),
                    ..MeasuredEntry::default()
                };
                runner.report_progress(done, total, &found.name());
                done += 1;
                let job = self.job(configuration, method, &grid);
                let names = (&found.case, &found.model);
                let key = (Key::new("check").and(&job.key()))
                    .and(&(&ids, &self.case.metrics))
                    .and(&names);
                let not_made = |status, message| MeasuredEntry {
                    status,
                    message: Some(message),
                    ..found.clone()
                };
                let make = || {
                    let (scene, setup) = built(&mut group.built, &job)?;
                    let run = run_in(&job, scene, *setup)?;
                    Ok::<_, RunError>(self.measured(found.clone(), run))
                };
                let measured = match runner.guarded(key, make, not_made) {
                    // Not every method is for every model: the pair is no entry.
                    Err(e) if e.leaves_out() => continue,
                    other => other?,
                };
                group.entries.push(Entry {
                    case: self.case,
                    method: *method,
                    measured,
                    moments: Vec::new(),
                });
            }
            all.push(group);
        }
        Ok(all)
    }

    /// Returns the results of a run that a check compares: quantities, work counts, status and parameters.
    fn measured(&self, named: MeasuredEntry, run: Run) -> MeasuredEntry {
        let failed = run.status.is_failure();
        MeasuredEntry {
            metrics: values(&run, &self.case.metrics, &self.references),
            work: work(&run),
            status: run.status,
            message: run.message.filter(|_| failed),
            parameters: run.parameters,
            ..named
        }
    }

    fn job<'j>(
        &'j self,
        configuration: &'j Configuration,
        method: &'j Scheme,
        grid: &'j [f64],
    ) -> Job<'j> {
        let of = (&configuration.scene, &configuration.modelling);
        Job {
            repeats: 0,
            ..self.conditions.job(of, method, grid)
        }
    }
}

/// The scene of a job with the time that building it took, built at the first use.
fn built<'s>(
    kept: &'s mut Option<(Scene, Duration)>,
    job: &Job<'_>,
) -> Result<&'s mut (Scene, Duration), RunError> {
    match kept {
        Some(built) => Ok(built),
        none => {
            let started = Instant::now();
            let scene = job.assemble()?;
            Ok(none.insert((scene, started.elapsed())))
        }
    }
}

/// Entries of a model, whose scene is built once for all of their runs and timings.
pub(super) struct Group<'l> {
    of: &'l LoadedCase<'l>,
    configuration: &'l Configuration,
    built: Option<(Scene, Duration)>,
    pub(super) entries: Vec<Entry<'l>>,
}

/// Entry of a check that was run, with its measured runtimes.
pub(super) struct Entry<'l> {
    /// Case of the check file that the entry belongs to.
    pub(super) case: &'l Case,
    method: Scheme,
    pub(super) measured: MeasuredEntry,
    /// Times over those of the kernel, the median at each moment.
    moments: Vec<f64>,
}

impl Group<'_> {
    /// Measures the runtime of an entry once more, in addition to earlier measurements: at another moment the load of
    /// the machine differs.
    ///
    /// # Errors
    /// [`RunError`] when its model cannot be built.
    pub(super) fn time(&mut self, entry: usize) -> Result<(), RunError> {
        let entry = &mut self.entries[entry];
        if entry.measured.status.is_failure() {
            return Ok(());
        }
        let job = self.of.job(self.configuration, &entry.method, &[]);
        let (scene, _) = built(&mut self.built, &job)?;
        let now = kernel::median(&kernel::ratios(bare(&job, scene)));
        entry.moments.extend(now);
        entry.measured.runtime = entry.moments.iter().copied().reduce(f64::min);
        Ok(())
    }
}
