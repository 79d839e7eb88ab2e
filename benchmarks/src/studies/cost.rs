//! The study of cost: the processor time of each model and integrator, by step, by evaluation and by simulated time, and
//! what a longer simulation would take.
//!
//! The study compares nothing with a reference, so that it also answers for scenes without one. Errors and cost together
//! are the subject of `precision`.

use super::tabular::{Cell, Measured, Others, TableLine, TabularStudy};
use crate::cli::arguments::{BoundedOutput, TimedOutput};
use crate::cli::terminal::{Refusal, integrators_of};
use crate::cli::values::{DEFAULT_SCENE, positive};
use crate::experiment::configuration::Configuration;
use crate::experiment::error::StudyError;
use crate::experiment::run::{Job, run};
use crate::scene_file::{SceneFile, Selection};
use clap::Args;
use gearbench_reports::Format;
use gearbench_reports::columns::Columns;
use gearbench_reports::numbers::{counted, duration, short, times};
use gearbench_reports::record::Run;
use gearbench_reports::tabular::TableChart;

const EXAMPLES: &str = "\
Examples:
  gearbench cost                                   the models and integrators of spur_impact
  gearbench cost my_scene.toml --simulate 10       and what ten seconds of it would take
  gearbench cost rack_pinion --models rigid,movable-teeth --integrators rk4@1us,dopri5@1e-6

Times are processor times of the integration on this machine, without set-up and without recording, and the median of
--repeats. The estimate for --simulate assumes that the further time is like the time of the scene.";

/// Compute what the runs of each model and integrator cost: time per step, per evaluation and per simulated second
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Cost {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Models of the scene by label, separated by commas [default: the models of its study]
    #[arg(long, value_name = "A,B")]
    pub models: Option<String>,
    /// Integrators separated by commas: id or id(name=value), optionally with @STEP or @RTOL [default: those of the
    /// scene]
    #[arg(long, value_name = "X,Y")]
    pub integrators: Option<String>,
    /// Simulated time whose cost is estimated, in seconds
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = positive)]
    pub simulate: f64,
    /// Where results go, how long a run may take, how often it is timed.
    #[command(flatten)]
    pub run: TimedOutput,
}

/// Processor time over simulated time; `None` for a run that did not end well.
fn per_second(f: &Measured<Cost>) -> Option<f64> {
    let ended = !f.run.status.is_failure() && f.run.simulated_s > 0.0;
    ended.then(|| f.run.cost_s() / f.run.simulated_s)
}

/// Processor time over a count of the run.
fn over(count: fn(&Run) -> u64) -> impl Fn(&TableLine<'_, Cost>) -> Option<f64> {
    move |f| (count(&f.run) > 0).then(|| f.run.cost_s() / count(&f.run) as f64)
}

impl TabularStudy for Cost {
    const NAME: &'static str = "cost";
    const ROWS: &'static str = "one row per model and integrator";
    const REMARK: &'static str = "Processor time of the integration, without set-up and recording. Cost alone does not say which run is \
        accurate enough: `gearbench precision` has errors and cost together.";
    type At = f64;
    type Row = ();

    fn scene(&self) -> &str {
        &self.scene
    }

    fn selection(&self) -> Selection<'_> {
        Selection::Labels(self.models.as_deref())
    }

    fn options(&mut self) -> &mut BoundedOutput {
        &mut self.run.bounded
    }

    fn repeats(&self) -> u32 {
        self.run.repeats
    }

    fn cells(&self, scene: &SceneFile) -> Result<Vec<Cell<f64>>, Refusal> {
        let asked = integrators_of(scene, self.integrators.as_deref())?;
        let mut cells = Vec::new();
        for choice in scene.select(self.models.as_deref())? {
            let configuration = Configuration::of(scene, choice);
            let own = configuration.methods.as_ref();
            let methods = (asked.as_ref().or(own)).unwrap_or(&scene.study.integrators);
            cells.extend(methods.iter().map(|method| Cell {
                configuration: configuration.clone(),
                method: *method,
                variant: None,
                at: self.simulate,
                name: method.to_string(),
            }));
        }
        Ok(cells)
    }

    fn measure(
        &self,
        _: &Cell<f64>,
        job: &Job<'_>,
        _: &Others<'_, Self>,
    ) -> Result<(Run, ()), StudyError> {
        let mut made = run(&Job {
            histories: false,
            ..*job
        })?;
        // The study is about the cost of a run, not about its results.
        (made.series, made.contacts) = (None, None);
        Ok((made, ()))
    }

    #[rustfmt::skip]
    fn columns<'a>(columns: Columns<'a, TableLine<'a, Self>>) -> Columns<'a, TableLine<'a, Self>> {
        let estimate = |f: &TableLine<'_, Self>| Some(per_second(f)? * f.cell.at);
        let evaluations = |f: &TableLine<'_, Self>| (f.run.steps > 0).then(|| f.run.force_evaluations as f64 / f.run.steps as f64);
        columns
            .add("dofs", "coordinates", |f| f.run.dofs).shown("Coordinates", Format::Counts).result()
            .add("cpu_s", "processor time of the integration, median of the repeats", |f| f.run.cost_s()).shown("Time of the run", Format::Durations).result()
            .add("cpu_per_simulated_time", "processor time over simulated time", |f| per_second(f)).shown("Time over simulated time", Format::Short(3)).result()
            .add("estimate_s", "processor time of the simulated time of --simulate, if it is like that of the scene", estimate).shown("Estimate", Format::Durations).result()
            .add("cpu_per_step_s", "processor time of an accepted step", over(|r| r.steps)).shown("Time of a step", Format::Durations).result()
            .add("cpu_per_evaluation_s", "processor time over the number of evaluations of the contact forces", over(|r| r.force_evaluations)).shown("Time of an evaluation", Format::Durations).result()
            .add("steps", "accepted steps", |f| f.run.steps).shown("Steps", Format::Counts)
            .add("evaluations_per_step", "evaluations of the contact forces for each accepted step", evaluations).shown("Evaluations per step", Format::Short(3))
            .add("setup_s", "wall time before the first step", |f| f.run.setup_s).shown("Set-up", Format::Durations)
    }

    fn charts(&self, _: &[&Measured<Self>]) -> Vec<TableChart> {
        vec![TableChart {
            file: "cost".into(),
            title: "Cost over the number of coordinates".into(),
            caption: "Processor time of an accepted step, and over simulated time, for each model and integrator."
                .into(),
            abscissa: "dofs".into(),
            ordinates: ["cpu_per_step_s", "cpu_per_simulated_time"].map(String::from).to_vec(),
            ..TableChart::default()
        }]
    }

    fn finding(&self, rows: &[&Measured<Self>]) -> Vec<String> {
        let ended = rows.iter().filter_map(|f| Some((f, per_second(f)?)));
        let mut ended: Vec<(&&Measured<Self>, f64)> = ended.collect();
        ended.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (Some((first, least)), Some((last, most))) = (ended.first(), ended.last()) else {
            return vec!["No run ended well.".into()];
        };
        let name = |f: &&Measured<Self>| format!("{} with {}", f.run.model_label(), f.cell.method);
        let estimate = |per_second: f64| duration(per_second * self.simulate);
        let simulated = short(self.simulate, 4);
        let mut sentences = vec![format!(
            "{simulated} s of this scene take {} of processor time with the cheapest run, {}.",
            estimate(*least),
            name(first)
        )];
        if ended.len() > 1 {
            sentences.push(format!(
                "The dearest, {}, takes {}: {}as much.",
                name(last),
                estimate(*most),
                times(most / least)
            ));
        }
        let faster = ended
            .iter()
            .filter(|(_, per_second)| *per_second < 1.0)
            .count();
        sentences.push(format!(
            "{faster} of {} take less time than they simulate.",
            counted(rows.len(), "run", "runs")
        ));
        sentences
    }
}
