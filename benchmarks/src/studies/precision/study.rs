//! The study as a table: its cells, what a cell measures, its columns.

use super::arguments::Precision;
use super::converged::{MOST_STEPS, described};
use super::plan::Plan;
use super::results::{fronts, headline_against, references_of};
use crate::cli::arguments::{AnyReference, BoundedOutput};
use crate::cli::exit::Exit;
use crate::cli::terminal::Refusal;
use crate::experiment::budget::Budget;
use crate::experiment::error::StudyError;
use crate::experiment::run::{Job, run_timed};
use crate::experiment::status::judge;
use crate::scene_file::{SceneError, SceneFile, Selection};
use crate::studies::tabular::{Cell, Measured, Others, SharedWork, TableLine, TabularStudy};
use gearbench_integrators::Scheme;
use gearbench_reports::columns::Columns;
use gearbench_reports::metrics::{compare as measure, compare_all};
use gearbench_reports::record::{ReferenceSeries, Results, Run, SELF, Status};
use gearbench_reports::runs::work;
use gearbench_reports::tabular::{ON_FRONT, SummaryTable, TableChart};
use gearbench_reports::{Format, Metric, capital};
use std::sync::Arc;
use std::time::Duration;

/// Short runs are timed until their repeats together take this long.
const TIMED: Duration = Duration::from_millis(25);
/// Key of the setting that lists resolutions that were left out.
pub(super) const TOO_FINE: &str = "left out: finer than a run that took too long";

/// Values of a cell besides its model and its integrator.
#[derive(Clone, Debug)]
pub struct Resolution {
    /// Modes per gear, where the study varies them.
    pub modes: Option<usize>,
    /// Ids of the references that the run is compared with.
    pub against: Arc<Vec<String>>,
    /// Integrators of the variant at all resolutions: its converged solution is finer than all of them.
    pub methods: Arc<Vec<Scheme>>,
}

impl TabularStudy for Precision {
    const NAME: &'static str = "precision";
    const ROWS: &'static str = "one row per run and reference";
    const REMARK: &'static str = "Errors against `self`, the converged solution of the same model, are those of the integration; errors \
        against a reference are those of the model and its resolution together. Processor time: of the integration, without set-up, \
        median of the repeats.";
    /// A failed run is a result.
    const EXIT: fn(&Results) -> Exit = Exit::of_any_run;
    type At = Resolution;
    /// References on whose front the run is.
    type Row = Vec<String>;

    fn scene(&self) -> &str {
        &self.scene
    }

    fn selection(&self) -> Selection<'_> {
        Selection::Precision(self.models.as_deref())
    }

    fn options(&mut self) -> &mut BoundedOutput {
        &mut self.bounded
    }

    fn repeats(&self) -> u32 {
        self.repeats
    }

    fn duration(&self, scene: &SceneFile) -> f64 {
        scene.study.precision.duration.unwrap_or(scene.duration)
    }

    fn compared(&self) -> Option<&AnyReference> {
        Some(&self.insist)
    }

    fn budget(&self) -> Budget {
        self.budget.budget()
    }

    fn prepare(
        &mut self,
        scene: &mut SceneFile,
        references: &[ReferenceSeries],
    ) -> Result<(), Refusal> {
        let against: Vec<&str> = self.asked.against.iter().map(String::as_str).collect();
        scene.damp_unbuilt(&against)?;
        let choices = scene.select_precision(self.models.as_deref())?;
        let plan = Plan::of(scene, &choices, references, &self.asked);
        let help = "`gearbench precision --help` shows all options";
        self.plan = plan.map_err(|reason| SceneError::plain(reason, help))?;
        Ok(())
    }

    fn references(
        &self,
        of_scene: Vec<ReferenceSeries>,
        shared: &SharedWork<'_>,
    ) -> Result<Vec<ReferenceSeries>, StudyError> {
        let mut all = of_scene;
        all.retain(|r| self.plan.external.iter().any(|e| e.id == r.id));
        for full in &self.plan.fulls {
            shared.begin(&format!("reference {}", full.id))?;
            all.push(self.solution_of(full, shared)?.0.clone());
        }
        Ok(all)
    }

    fn settings(&self, _: &SceneFile) -> Vec<(String, String)> {
        let converged = ("converged solution (self)".to_owned(), described());
        let of_models = self.plan.settings.iter().cloned();
        of_models.chain([converged]).collect()
    }

    fn cells(&self, _: &SceneFile) -> Result<Vec<Cell<Resolution>>, Refusal> {
        let mut cells = Vec::new();
        for variant in &self.plan.variants {
            let at = Resolution {
                modes: variant.modes,
                against: Arc::new(variant.against.clone()),
                methods: Arc::new(variant.methods.clone()),
            };
            cells.extend(variant.methods.iter().map(|method| Cell {
                configuration: variant.entry.clone(),
                method: *method,
                variant: None,
                name: match variant.modes {
                    Some(n) => format!("{n} modes, {}", method.described()),
                    None => method.described(),
                },
                at: at.clone(),
            }));
        }
        Ok(cells)
    }

    fn leaves_out(
        &self,
        cell: &Cell<Resolution>,
        rows: &[Measured<Self>],
    ) -> Option<(&'static str, String)> {
        let is_same = |other: &Cell<Resolution>| {
            other.configuration.label == cell.configuration.label
                && other.at.modes == cell.at.modes
                && other.method.method == cell.method.method
        };
        let too_long = |r: &&Measured<Self>| r.run.status == Status::Timeout && is_same(&r.cell);
        let coarser = rows.iter().find(too_long)?;
        let kind = match coarser.cell.method.resolution.step() {
            Some(_) => "steps",
            None => "tolerances",
        };
        let modes = (cell.at.modes).map_or_else(String::new, |n| format!(", {n} modes"));
        let label = format!("{}{modes}", cell.configuration.label);
        Some((
            TOO_FINE,
            format!("{label} under {}, finer {kind}", cell.method.method),
        ))
    }

    fn measure(
        &self,
        cell: &Cell<Resolution>,
        job: &Job<'_>,
        others: &Others<'_, Self>,
    ) -> Result<(Run, Vec<String>), StudyError> {
        let job = Job {
            histories: false,
            events: self.plan.events,
            max_steps: MOST_STEPS,
            ..*job
        };
        let mut made = run_timed(&job, TIMED)?;
        let own = self.own_solution(cell, &job, &made, others.shared)?;
        let own = match &*own {
            Ok(own) => own.judges(&cell.method, &made).map(|()| own),
            Err(why) => Err(why.clone()),
        };
        let mut metrics = Vec::new();
        if let Ok(finished) = made.finished() {
            let compared = others.references.iter();
            for reference in compared.filter(|r| cell.at.against.contains(&r.id)) {
                let full = self.plan.fulls.iter().find(|f| f.id == reference.id);
                metrics.push(match full {
                    // The record has a thinned history.
                    Some(full) => {
                        let whole = self.solution_of(full, others.shared)?;
                        compare_all(finished, &[&whole.1.series], &reference.id)
                    }
                    None => compare_all(finished, &reference.all_series(), &reference.id),
                });
            }
            metrics.extend((own.iter()).map(|own| measure(finished, &own.series, SELF)));
            made.own_solution = own.as_ref().ok().map(|own| own.by.clone());
        }
        made.metrics.extend(metrics);
        judge(&mut made, (None, None), own.err().as_deref());
        made.published_s = cell.configuration.published;
        made.published_derived = cell.configuration.published_derived;
        // Number of modes that the model reports.
        made.modes = made.modes.or(cell.at.modes);
        // Histories and pictures of hundreds of runs are not kept.
        (made.series, made.contacts) = (None, None);
        Ok((made, Vec::new()))
    }

    fn compare(&self, rows: &mut [Measured<Self>]) -> Vec<ReferenceSeries> {
        let all: Vec<&Measured<Self>> = rows.iter().collect();
        let references = references_of(&all);
        let mut on: Vec<Vec<String>> = vec![Vec::new(); rows.len()];
        for id in references.iter().map(String::as_str).chain([SELF]) {
            for i in fronts(&all, id, headline_against(&all, id, self.headline())) {
                on[i].push(id.to_owned());
            }
        }
        for (row, on) in rows.iter_mut().zip(on) {
            row.row = on;
        }
        Vec::new()
    }

    fn table_lines(cell: &Measured<Self>) -> Vec<TableLine<'_, Self>> {
        TableLine::of_references(cell)
    }

    #[rustfmt::skip]
    fn columns<'a>(columns: Columns<'a, TableLine<'a, Self>>) -> Columns<'a, TableLine<'a, Self>> {
        let is_on_front = |f: &TableLine<'_, Self>| f.metrics.is_some_and(|m| f.row.contains(&m.against));
        let mut cost = work();
        // The processor time is the result.
        cost.all.iter_mut().for_each(|c| c.rank = Default::default());
        let columns = columns
            .modes(|f| f.run.modes).shown("Modes", Format::Plain).result()
            .add("fitted_to", "reference to which the model's constants were fitted", |f| f.run.fitted_to.clone()).shown("Fitted to", Format::Text)
            .against(|f| f.metrics.map(|m| m.against.clone())).shown("Against", Format::Text).result()
            .add(ON_FRONT, "no run of the record is both cheaper and more accurate", is_on_front);
        let errors = Metric::ALL.into_iter().filter(|m| m.is_error());
        errors
            .fold(columns, |all, e| all.add(e.key(), e.meaning(), move |f| f.metrics?.get(e)))
            .join(cost, |f| Some(f.run()))
    }

    fn shown(&self) -> Vec<(&'static str, String, Format)> {
        let mut metrics = self.plan.metrics.clone();
        metrics.extend(
            [self.headline().of_integration()]
                .iter()
                .filter(|m| !self.plan.metrics.contains(m)),
        );
        let percents = |m: Metric| (m.key(), capital(m.words()), Format::Percents(3));
        let mut shown: Vec<_> = metrics.into_iter().map(percents).collect();
        shown.push(("cpu_s", "Processor time".into(), Format::Durations));
        shown
    }

    fn summaries(&self, rows: &[&Measured<Self>]) -> Vec<SummaryTable> {
        self.tables(rows)
    }

    fn charts(&self, rows: &[&Measured<Self>]) -> Vec<TableChart> {
        self.charts_of(rows)
    }

    fn finding(&self, rows: &[&Measured<Self>]) -> Vec<String> {
        self.sentences(rows)
    }
}
