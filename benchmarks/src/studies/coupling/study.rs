//! The study: its arguments, its cells, what a run in two parts measures, its table, charts and finding.
//!
//! A model runs as one system, and then in two parts with every extrapolation of forces and interpolation of motion: a
//! line of cells over the communication step, between whose largest step that holds and the next one the study bisects.

use super::exchange::{Bounds, CoupledRun, CouplingScheme, End, exchange};
use super::frames::{Frame, HostError, frames};
use super::step_polynomial::{Extrapolation, Motion};
use super::stiffness::oscillator;
use super::theory;
use crate::cli::arguments::BoundedOutput;
use crate::cli::exit::Exit;
use crate::cli::terminal::{Refusal, refuse_run};
use crate::cli::values::{DEFAULT_SCENE, number, positive, time};
use crate::experiment::conditions::logarithmic;
use crate::experiment::configuration::Configuration;
use crate::experiment::error::{ModelRefusal, StudyError};
use crate::experiment::history::History;
use crate::experiment::parallel::thread_count;
use crate::experiment::record::time_series;
use crate::experiment::run::{Job, NO_BOUND, RunError, run};
use crate::experiment::runner::unfinished;
use crate::experiment::status::{message_of, status_of};
use crate::scene_file::{ModelChoice, SceneError, SceneFile, Selection};
use crate::studies::tabular::{Cell, Measured, Others, TableLine, TabularStudy};
use clap::Args;
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_integrators::table::{RK4, VELOCITY_VERLET};
use gearbench_integrators::{Resolution, Scheme, StepError};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::scene::Scene;
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reference::reduction::choose::Criterion;
use gearbench_reports::columns::Columns;
use gearbench_reports::metrics::compare;
use gearbench_reports::numbers::{per_cent, quantity, short};
use gearbench_reports::record::{Ledger, ReferenceSeries, Results, Run, Status, finite};
use gearbench_reports::tabular::{SummaryTable, TableChart};
use gearbench_reports::{FinishedRun, Format, Metric};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

const EXAMPLES: &str = "\
Examples:
  gearbench coupling                                  the scene spur_impact with the models of its study
  gearbench coupling loaded_mesh --duration 1e-3 --models rigid,elastic
  gearbench coupling spur_impact --extrapolations quadratic --motions linear,cubic
  gearbench coupling my_scene.toml --steps 1e-7:1e-4:16 --tolerance 0.01

The host simulates the movable hubs with their inertia and loads; the gears are a subsystem whose hub motion the host
prescribes. In each communication step the host moves first, with forces extrapolated from their last values; the
gears follow with interpolated motion. Each run is compared with the same model under the same integrator without
coupling: error of the force history, final speeds, and the energy that the coupling adds or removes. A run is
accurate if its error is within --tolerance. It has failed if the gears cannot be integrated further or if the
coupling adds more than half of the vibration energy.

The study adds to an elastic model its variant with plain truncation (the lowest modes, without residual compliance),
unless the scene has one or --models is given.";

/// Couple the gears to a host that moves their hubs: error, energy and stability over the communication step
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Coupling {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Models of the scene by label, separated by commas [default: the models of its study without full finite
    /// elements]
    #[arg(long, visible_alias = "model", value_name = "A,B")]
    pub models: Option<String>,
    /// Communication steps with a unit (1us:100us), or in seconds [default: the step of the gears and its doubles up to
    /// 4/omega, where omega is the frequency of the hubs on their teeth]
    #[arg(long, value_name = "FROM:TO[:POINTS]", value_parser = steps)]
    pub steps: Option<Steps>,
    /// Extrapolations of the forces on hubs, separated by commas [default: all]
    #[arg(long, value_name = "X,Y", value_delimiter = ',')]
    pub extrapolations: Vec<Extrapolation>,
    /// Interpolations of the motion of hubs, separated by commas
    #[arg(
        long,
        value_name = "X,Y",
        value_delimiter = ',',
        default_value = "linear"
    )]
    pub motions: Vec<Motion>,
    /// Integrator of the gears, X@STEP [default: the first explicit one of the model with a step, else rk4]
    #[arg(long, value_name = "X@STEP")]
    pub integrator: Option<String>,
    /// Largest relative L2 error of the force history of an accurate run
    #[arg(long, value_name = "E", default_value_t = 0.05, value_parser = tolerance)]
    pub tolerance: f64,
    /// Simulated time in seconds [default: the duration of the scene]
    #[arg(long, value_name = "S", value_parser = positive)]
    pub duration: Option<f64>,
    /// Number of simultaneous runs [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Where results go, and how long a run may take.
    #[command(flatten)]
    pub run: BoundedOutput,
}

/// Communication steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps(pub Vec<f64>);

/// Most steps on a line.
const MOST: usize = 400;

fn steps(text: &str) -> Result<Steps, String> {
    const EXPECTED: &str = "expected FROM:TO or FROM:TO:POINTS, 0 < FROM < TO, for example 100ns:100us:12, or in seconds 1e-7:1e-4:12";
    let of = |text: &str| time(text).map_err(|_| EXPECTED.to_owned());
    let parts: Vec<&str> = text.split(':').collect();
    let (from, to, points) = match parts.as_slice() {
        [from, to] => (of(from)?, of(to)?, 12),
        [from, to, points] => {
            let n = points.trim().parse().ok();
            let n = n.filter(|n| (2..=MOST).contains(n));
            let wrong = || format!("`{points}` points; expected 2 to {MOST}");
            (of(from)?, of(to)?, n.ok_or_else(wrong)?)
        }
        _ => return Err(EXPECTED.into()),
    };
    match from < to {
        true => Ok(Steps(logarithmic(from, to, points))),
        false => Err(EXPECTED.into()),
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    let expected = "expected a relative error between 0 and 1, for example 0.05";
    number(text, |x| *x > 0.0 && *x < 1.0, expected)
}

/// Energy error of a coupling over the vibration energy above which it counts as unstable [-].
pub(super) const ALLOWED: f64 = 0.5;
/// Energy error of a coupling over the vibration energy at which a run is given up [-].
const HOPELESS: f64 = 1e3;
/// Largest default communication step over the time `1/omega` of the hubs on their teeth.
const LARGEST: f64 = 4.0;
/// Communication steps over a run at least.
const FEWEST: f64 = 2.5;
/// Ratio of the smallest step that failed to the largest successful one below it, at which the search for the limit
/// ends.
const BRACKET: f64 = 1.05;
/// Step of a model without an integrator of its own, over its characteristic time.
const FINE: f64 = 0.05;
/// Step of gears with plain truncation, whose contact is stiff [s].
const TRUNCATED_STEP: f64 = 2e-8;
/// Reference id of a model's run as one system.
pub(super) const WHOLE: &str = "one system";
/// Key of the column of communication steps, and of their limit by theory.
const STEP: &str = "communication_step_s";
const THEORY: &str = "theory_step_s";
/// Least and greatest error that charts show.
const SHOWN: [f64; 2] = [1e-9, 10.0];

/// A model that a host can move.
#[derive(Debug)]
pub struct Hosted {
    /// Frames of the hubs in the host, or the reason why there are none.
    frames: Result<Vec<Frame>, HostError>,
    /// Angular frequency [rad/s] and damping ratio of the hubs on the teeth in contact; `None` without contact.
    oscillator: Option<[f64; 2]>,
    /// True if the truncated modes are kept as residual compliance; `None` if no gear is elastic.
    residual: Option<bool>,
    /// Relative L2 error of the force within which a run is accurate.
    tolerance: f64,
}

/// How a cell runs its model.
#[derive(Clone, Debug)]
pub struct Coupled {
    /// The coupling, and the line of the cell; `None` as one system.
    scheme: Option<(CouplingScheme, usize)>,
    model: Arc<Hosted>,
}

/// Quantities of a run in two parts.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct CouplingRow {
    /// Work of the extrapolated forces on the host, less that of the gears along their motion [J].
    energy_error_j: Option<f64>,
    /// Energy error of the coupling over the energy that vibrates [-].
    energy_error_rel: Option<f64>,
    /// Its largest magnitude in one communication step.
    energy_error_step_rel: Option<f64>,
    /// Number of communication steps.
    exchanges: Option<u64>,
    /// Communication step from which on linear theory has the coupling make up more energy than is allowed [s].
    theory_step_s: Option<f64>,
}

impl TabularStudy for Coupling {
    const NAME: &'static str = "coupling";
    const ROWS: &'static str =
        "one row per communication step, after those of the models as one system";
    const REMARK: &'static str = "Energy error: work that the host takes less work that the gears give, over the energy that vibrates and \
        passes through contacts in the run as one system.";
    /// A failed run is a result.
    const EXIT: fn(&Results) -> Exit = Exit::of_any_run;
    type At = Coupled;
    type Row = CouplingRow;

    fn scene(&self) -> &str {
        &self.scene
    }

    fn selection(&self) -> Selection<'_> {
        Selection::Reduced(self.models.as_deref())
    }

    fn options(&mut self) -> &mut BoundedOutput {
        &mut self.run
    }

    fn repeats(&self) -> u32 {
        0
    }

    fn line(at: &Coupled) -> Option<usize> {
        at.scheme.map(|(_, line)| line)
    }

    fn threads(&self) -> usize {
        thread_count(self.threads)
    }

    fn duration(&self, scene: &SceneFile) -> f64 {
        self.duration.unwrap_or(scene.duration)
    }

    fn settings(&self, _: &SceneFile) -> Vec<(String, String)> {
        let labels = format!(
            "converged: the force within {} % (relative L2) of the same model as one system; energy growth: the coupling makes up more than {} % of the energy that vibrates and passes through contacts",
            short(100.0 * self.tolerance, 3),
            short(100.0 * ALLOWED, 2)
        );
        let host = "hubs that are free to move, with their inertia and loads, on extrapolated forces; the gears follow on interpolated motion";
        vec![("host".into(), host.into()), ("labels".into(), labels)]
    }

    fn cells(&self, scene: &SceneFile) -> Result<Vec<Cell<Coupled>>, Refusal> {
        let chosen = scene.select_reduced(self.models.as_deref())?;
        let mut cells = Vec::new();
        let mut line = 0;
        let mut refused: Option<HostError> = None;
        for (configuration, is_added) in configurations(scene, &chosen, self.models.is_some()) {
            let label = &configuration.label;
            let of = (&configuration.scene, &configuration.modelling);
            let mut built = match Scene::build(of.0, of.1, &scene.context.models) {
                Ok(built) => built,
                // Nobody asked for plain truncation, and contact on half-spaces has none.
                Err(e) if is_added && e.refusal().is_some() => continue,
                Err(e) => return Err(scene.locate_in(label, &e).into()),
            };
            let time = built.characteristic_time(built.initial().at());
            let method = self.method(scene, &configuration, time)?;
            if method.method.info().linear_part && built.modal().is_none() {
                let refused = RunError::no_linear_part(method.method.id(), &built, of.0);
                return Err(refuse_run(refused));
            }
            let frames = frames(of.0, &mut built);
            // Without theory the runs are there all the same.
            let found = frames.as_ref().ok().map(|frames| {
                let found = oscillator(of.0, of.1, &scene.context.models, frames);
                found.ok().flatten()
            });
            let model = Arc::new(Hosted {
                frames,
                oscillator: found.flatten(),
                residual: keeps_residual(&configuration),
                tolerance: self.tolerance,
            });
            let cell = |scheme: Option<(CouplingScheme, usize)>| Cell {
                configuration: configuration.clone(),
                method,
                variant: None,
                name: scheme.map_or("one system".into(), |(scheme, _)| name(scheme)),
                at: Coupled {
                    scheme,
                    model: Arc::clone(&model),
                },
            };
            cells.push(cell(None));
            if let Err(why) = &model.frames {
                refused = refused.or_else(|| Some(why.clone()));
                continue;
            }
            let steps = self.steps_of(scene, &method, model.oscillator)?;
            for motion in once(&self.motions) {
                for extrapolation in self.extrapolations() {
                    let scheme = |step: f64| CouplingScheme {
                        extrapolation,
                        motion,
                        step,
                    };
                    cells.extend(steps.iter().map(|h| cell(Some((scheme(*h), line)))));
                    line += 1;
                }
            }
        }
        if line == 0 {
            let (why, help) = match refused {
                Some(e) => (e.to_string(), e.help()),
                None => (
                    "it has only full finite elements".into(),
                    "name the models with --models, or add a reduced one",
                ),
            };
            let why = format!(
                "the scene `{}` cannot be coupled to a host: {why}",
                scene.name
            );
            return Err(SceneError::plain(why, help).into());
        }
        Ok(cells)
    }

    fn measure(
        &self,
        cell: &Cell<Coupled>,
        job: &Job<'_>,
        others: &Others<'_, Self>,
    ) -> Result<(Run, CouplingRow), StudyError> {
        let frames = match &cell.at.model.frames {
            Ok(frames) => frames,
            Err(why) => {
                let refused = Run {
                    status: Status::Refused,
                    message: Some(why.to_string()),
                    simulated_s: 0.0,
                    ..untimed(&cell.method)
                };
                return Ok((refused, CouplingRow::default()));
            }
        };
        let Some((scheme, _)) = cell.at.scheme else {
            let mut made = run(job)?;
            let own = made.series.as_ref().zip(made.finished().ok());
            let own = own.map(|(series, run)| compare(run, series, WHOLE));
            made.metrics.extend(own);
            made.contacts = None;
            return Ok((made, CouplingRow::default()));
        };
        let label = &cell.configuration.label;
        let same_model = |r: &&Measured<Self>| r.cell.configuration.label == *label;
        let whole = others.common.iter().find(same_model).map(|r| &r.run);
        // The limit of theory is that of the line.
        let theory = others.rows.first().map(|r| r.row.theory_step_s);
        in_two_parts(cell, frames, (scheme, theory), job, whole)
    }

    fn next(&self, rows: &[Measured<Self>]) -> Option<Cell<Coupled>> {
        let (_, line) = rows.first()?.cell.at.scheme?;
        let [held, failed] = Line::of(rows.iter()).stable();
        let (held, failed) = (held?, failed?);
        if failed <= BRACKET * held {
            return None;
        }
        let mut cell = rows[0].cell.clone();
        let (of_line, _) = cell.at.scheme?;
        let scheme = CouplingScheme {
            step: (held * failed).sqrt(),
            ..of_line
        };
        cell.at.scheme = Some((scheme, line));
        cell.name = name(scheme);
        Some(cell)
    }

    fn compare(&self, rows: &mut [Measured<Self>]) -> Vec<ReferenceSeries> {
        rows.iter_mut().for_each(|r| r.run.series = None);
        // Steps that closed in on a limit stand among the others.
        rows.sort_by(|a, b| {
            let key =
                |r: &Measured<Self>| r.cell.at.scheme.map(|(scheme, line)| (line, scheme.step));
            key(a)
                .partial_cmp(&key(b))
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        Vec::new()
    }

    fn summaries(&self, rows: &[&Measured<Self>]) -> Vec<SummaryTable> {
        let columns = line_columns();
        let remark = "Accurate: every run up to there keeps the tolerance of the settings. Stable: none failed and none made up \
            more energy than allowed. Orders are those between the two smallest steps; a force that begins within a step is of \
            first order in the force, of second in the impulse, whatever the extrapolation.";
        vec![SummaryTable::of(
            "How far the coupling holds",
            &columns,
            &lines(rows),
            remark,
        )]
    }

    #[rustfmt::skip]
    fn columns<'a>(columns: Columns<'a, TableLine<'a, Self>>) -> Columns<'a, TableLine<'a, Self>> {
        let scheme = |f: &TableLine<'_, Self>| f.cell.at.scheme.map(|(scheme, _)| scheme);
        let metric = move |m: Metric| move |f: &TableLine<'_, Self>| scheme(f).and_then(|_| f.run.against(WHOLE)?.get(m));
        columns
            .add("extrapolation", "extrapolation of the forces on hubs of a host: `constant`, `linear`, `quadratic`; empty as one system", move |f| scheme(f).map(|s| s.extrapolation.as_str()))
            .add("motion", "interpolation of the motion of hubs between communication points: `linear`, `cubic`", move |f| scheme(f).map(|s| s.motion.as_str()))
            .add("manner", "extrapolation, and the interpolation unless it is linear", move |f| scheme(f).map(manner)).shown("Extrapolation", Format::Text).result()
            .add(STEP, "communication step of host and gears", move |f| scheme(f).map(|s| s.step)).shown("Communication step", Format::Quantities(3)).result()
            .add("force_l2", "relative L2 error of the force history against the model as one system", metric(Metric::ForceL2)).shown("Force, L2", Format::Percents(3)).result()
            .add("rebound_rel", "greatest error of a final speed over the range of that speed", metric(Metric::Rebound)).shown("Speeds at the end", Format::Percents(3)).result()
            .add("energy_error_j", "work of the extrapolated forces on the host minus work of the gears along their motion, over the run", |f| f.row.energy_error_j)
            .add("energy_error_rel", "`energy_error_j` over the energy of vibration and the work through contacts of the uncoupled run", |f| f.row.energy_error_rel).shown("Energy error", Format::Percents(3)).result()
            .add("energy_error_step_rel", "its greatest magnitude in one communication step, over the same energy", |f| f.row.energy_error_step_rel).shown("Largest in a step", Format::Percents(3))
            .add("exchanges", "communication steps", |f| f.row.exchanges)
            .add(THEORY, "communication step above which, by linear theory, the coupling generates more energy than allowed", |f| f.row.theory_step_s).shown("Limit of theory", Format::Quantities(3))
    }

    fn charts(&self, _: &[&Measured<Self>]) -> Vec<TableChart> {
        let chart = |file: &str, title: &str, what: &str, ordinate: &str| TableChart {
            file: file.into(),
            title: title.into(),
            caption: format!(
                "{what} over the communication step, model by model, for each extrapolation of the forces on hubs. Crosses are \
                 runs that failed; dotted lines in the colour of a model are where theory has the coupling make up more energy \
                 than is allowed: the hubs as one oscillator on the static stiffness of the teeth."
            ),
            abscissa: STEP.into(),
            ordinates: vec![ordinate.into()],
            panels_by: "manner".into(),
            within: Some(SHOWN),
            verticals: THEORY.into(),
            magnitudes: true,
            ..TableChart::default()
        };
        vec![
            TableChart {
                levels: vec![self.tolerance],
                ..chart(
                    "coupling_error",
                    "Error of the coupling",
                    "Relative L2 error of the force history against the run as one system, with the tolerance,",
                    "force_l2",
                )
            },
            chart(
                "coupling_energy",
                "Energy error of the coupling",
                "Work that the host takes from extrapolated forces less what the gears give along the motion that they see, over \
                 the whole run, by magnitude, over the energy that vibrates and passes through contacts,",
                "energy_error_rel",
            ),
        ]
    }

    fn finding(&self, rows: &[&Measured<Self>]) -> Vec<String> {
        let all = lines(rows);
        if all.is_empty() {
            return vec!["The record holds no run in two parts.".into()];
        }
        let mut labels: Vec<String> = all.iter().map(Line::label).collect();
        labels.dedup();
        let best = |label: &String| {
            let of = all.iter().filter(|c| c.label() == *label);
            let kept = of.filter_map(|c| Some((c.accurate()[0]?, c)));
            match kept.max_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((step, c)) => {
                    format!(
                        "{label} up to {} ({})",
                        quantity(step, "s", 3),
                        manner(c.scheme)
                    )
                }
                None => format!("{label} at no step"),
            }
        };
        let parts: Vec<String> = labels.iter().map(best).collect();
        let mut sentences = vec![format!(
            "Communication steps that keep the force within the tolerance: {}.",
            parts.join("; ")
        )];
        sentences.extend(gain(&all));
        sentences
    }
}

impl Coupling {
    fn extrapolations(&self) -> Vec<Extrapolation> {
        match self.extrapolations.as_slice() {
            [] => Extrapolation::ALL.to_vec(),
            asked => once(asked),
        }
    }

    /// The integrator of the gears.
    fn method(
        &self,
        scene: &SceneFile,
        entry: &Configuration,
        characteristic_time: f64,
    ) -> Result<Scheme, Refusal> {
        if let Some(text) = &self.integrator {
            let found = Scheme::list(text, &scene.study.integrators).map_err(RunError::from);
            return match found.map_err(refuse_run)?.as_slice() {
                [one] => Ok(*one),
                _ => Err(Refusal::Input(miette::miette!(
                    help = "name one, for example --integrator rk4@200ns",
                    "`{text}` names more than one integrator for the gears"
                ))),
            };
        }
        let fits = |s: &&Scheme| {
            !s.method.info().implicit
                && s.method.info().order > 1
                && matches!(s.resolution, Resolution::Step(_))
        };
        let own = entry.methods.iter().flatten().find(fits);
        let usual = || {
            let fine = FINE * characteristic_time.min(scene.duration);
            // A round step.
            let decade = 10f64.powf(fine.log10().floor());
            let round = [5.0, 2.0, 1.0].into_iter().map(|x| x * decade);
            RK4.at_step(round.into_iter().find(|h| *h <= fine).unwrap_or(fine))
        };
        Ok(own.copied().unwrap_or_else(usual))
    }

    /// The communication steps of a model.
    fn steps_of(
        &self,
        scene: &SceneFile,
        method: &Scheme,
        oscillator: Option<[f64; 2]>,
    ) -> Result<Vec<f64>, Refusal> {
        let duration = self.duration(scene);
        let steps = match &self.steps {
            Some(steps) => steps.0.clone(),
            None => default_steps(method, oscillator, duration),
        };
        match steps.iter().find(|h| **h > duration) {
            Some(h) => Err(Refusal::Input(miette::miette!(
                help = "give smaller steps (--steps), or a longer --duration",
                "a communication step of {h:e} s is longer than the {duration:e} s that are simulated"
            ))),
            None => Ok(steps),
        }
    }
}

/// Returns each item once, in order.
fn once<T: PartialEq + Copy>(all: &[T]) -> Vec<T> {
    let mut found: Vec<T> = Vec::new();
    for one in all {
        if !found.contains(one) {
            found.push(*one);
        }
    }
    found
}

/// Extrapolation and interpolation in words.
fn manner(scheme: CouplingScheme) -> String {
    match scheme.motion {
        Motion::Linear => scheme.extrapolation.as_str().into(),
        other => format!(
            "{}, {} motion",
            scheme.extrapolation.as_str(),
            other.as_str()
        ),
    }
}

/// Name of a cell for the display of the progress.
fn name(scheme: CouplingScheme) -> String {
    format!("{}, {:.1e} s", manner(scheme), scheme.step)
}

/// Returns the models, and after an elastic one its counterpart with plain truncation if the scene has none and no
/// models are named; with true for the counterpart.
fn configurations(
    scene: &SceneFile,
    chosen: &[&ModelChoice],
    named: bool,
) -> Vec<(Configuration, bool)> {
    let of = |c: &&ModelChoice| (Configuration::of(scene, c), false);
    let mut all: Vec<(Configuration, bool)> = chosen.iter().map(of).collect();
    let place = |residual: bool| {
        let mut all = all.iter();
        all.position(|(c, _)| keeps_residual(c) == Some(residual))
    };
    if let (false, Some(i), None) = (named, place(true), place(false)) {
        all.insert(i + 1, (truncated(&all[i].0), true));
    }
    all
}

/// Returns the elastic model with plain truncation: its lowest modes, without the residual compliance of the others.
pub(super) fn truncated(of: &Configuration) -> Configuration {
    let mut entry = of.clone();
    ElasticParameters::change(&mut entry.modelling, |p| {
        p.residual = Some(false);
        p.choose = Some(Criterion::Frequency);
        p.target_error = None;
        p.step_s = Some(TRUNCATED_STEP);
    });
    entry.label = format!("{}-truncated", of.label);
    entry.methods = Some(vec![VELOCITY_VERLET.at_step(TRUNCATED_STEP)]);
    entry
}

/// True if the gears keep the compliance of the truncated modes; `None` if no gear is elastic.
pub(super) fn keeps_residual(of: &Configuration) -> Option<bool> {
    let gears = of.modelling.gears.iter().filter_map(ElasticParameters::of);
    gears.map(|p| p.keeps_residual()).reduce(|a, b| a && b)
}

/// Returns the default communication steps [s]: the step of the gears doubled until the motion of hubs on their teeth
/// cannot be resolved.
pub(super) fn default_steps(
    method: &Scheme,
    oscillator: Option<[f64; 2]>,
    duration: f64,
) -> Vec<f64> {
    let most = duration / FEWEST;
    let last = oscillator.map_or(most, |[omega, _]| (LARGEST / omega).min(most));
    let first = match method.resolution {
        Resolution::Step(h) => h.min(most),
        Resolution::Tolerance(_) => 1e-3 * last,
    };
    let doubled = std::iter::successors(Some(first), |h| Some(2.0 * h));
    doubled
        .take_while(|h| *h < 1.5 * last || *h == first)
        .collect()
}

/// A run under a method whose time is not measured.
fn untimed(method: &Scheme) -> Run {
    Run {
        cpu_s: f64::NAN,
        ..unfinished(method)
    }
}

/// Energy that vibrates and passes through contacts in the run as one system [J].
fn vibrating(whole: Option<&Run>) -> Option<f64> {
    let found = whole?.ledger.vibrating_j.and_then(finite);
    found.filter(|e| *e > 0.0)
}

/// Runs a model in two parts and compares it with its run as one system.
fn in_two_parts(
    cell: &Cell<Coupled>,
    frames: &[Frame],
    (scheme, theory): (CouplingScheme, Option<Option<f64>>),
    job: &Job<'_>,
    whole: Option<&Run>,
) -> Result<(Run, CouplingRow), StudyError> {
    let mut scene = job.assemble().map_err(RunError::from)?;
    let mut history = History::whole(&scene, job.grid.to_vec(), job.also_steps);
    let scale = vibrating(whole);
    let bounds = Bounds {
        t_end: job.t_end,
        events: job.events,
        max_steps: job.max_steps,
        cancel: job.context.interruption.flag(),
        timeout: (job.timeout < NO_BOUND).then_some(job.timeout),
        hopeless: scale.map_or(f64::MAX, |e| HOPELESS * e),
    };
    let found = exchange(
        &mut scene,
        frames,
        &cell.method,
        scheme,
        bounds,
        &mut history,
    );
    if job.context.interruption.is_requested() {
        return Err(RunError::Interrupted.into());
    }
    let theory = theory.unwrap_or_else(|| {
        let contact = whole.and_then(|w| w.against(WHOLE)?.duration_s);
        let theory = cell.at.model.oscillator.zip(contact.filter(|t| *t > 0.0));
        theory.and_then(|(o, time)| theory::limit(scheme.extrapolation, o, time, ALLOWED))
    });
    let row = CouplingRow {
        energy_error_j: finite(found.energy),
        energy_error_rel: scale.and_then(|e| finite(found.energy / e)),
        energy_error_step_rel: scale.and_then(|e| finite(found.largest / e)),
        exchanges: Some(found.exchanges),
        theory_step_s: theory,
    };
    let series = time_series(job, &scene, &history);
    let ledger = Ledger::default();
    let finished = FinishedRun::reached(&series, &ledger, [found.reached, job.t_end]);
    let target = whole.and_then(|w| w.series.as_ref());
    let metrics = finished.ok().zip(target);
    let metrics = metrics.map(|(run, whole)| compare(run, whole, WHOLE));
    let (status, message) = status(
        cell,
        &found,
        &row,
        metrics.as_ref().and_then(|m| m.force_l2),
    );
    let made = Run {
        status,
        message,
        simulated_s: found.reached,
        metrics: metrics.into_iter().collect(),
        ..untimed(&cell.method)
    };
    Ok((made, row))
}

/// The status of a run in two parts, and why it has it.
fn status(
    cell: &Cell<Coupled>,
    found: &CoupledRun,
    row: &CouplingRow,
    force_error: Option<f64>,
) -> (Status, Option<String>) {
    let fixed = matches!(cell.method.resolution, Resolution::Step(_));
    let at = found.reached;
    let blow_up = |why: String| (Status::BlowUp, Some(why));
    match &found.end {
        End::Gears(e @ StepError::NonFinite { .. }) => {
            return blow_up(format!("{e}, or a smaller communication step"));
        }
        End::Gears(e) => return (status_of(e), Some(message_of(e, fixed))),
        End::RanAway => {
            return blow_up(format!(
                "the motion of hubs and gears diverges by t = {at:.4e} s; use a smaller communication step"
            ));
        }
        End::Timeout => {
            let why = format!("stopped at t = {at:.4e} s at the limit of processor time");
            return (Status::Timeout, Some(why));
        }
        End::Reached => {}
    }
    let percent = |x: f64| short(100.0 * x, 3);
    let tolerance = cell.at.model.tolerance;
    if let Some(made_up) = row.energy_error_rel.filter(|e| *e > ALLOWED) {
        let why = format!(
            "the coupling adds {} % of the vibration energy; use a smaller communication step",
            percent(made_up)
        );
        return (Status::EnergyGrowth, Some(why));
    }
    match force_error {
        Some(e) if e <= tolerance => (Status::Converged, None),
        Some(e) => (
            Status::Inaccurate,
            Some(format!(
                "the error of the force against the run without coupling is {} %, above the limit of {} %",
                percent(e),
                percent(tolerance)
            )),
        ),
        None => (
            Status::Unchecked,
            Some("the run without coupling has no contact force for comparison".into()),
        ),
    }
}

/// A model under one extrapolation and interpolation: its runs, ascending in the communication step.
pub(super) struct Line<'a> {
    scheme: CouplingScheme,
    runs: Vec<(f64, &'a Measured<Coupling>)>,
}

/// Returns the lines of a table.
pub(super) fn lines<'a>(rows: &[&'a Measured<Coupling>]) -> Vec<Line<'a>> {
    let numbers = rows.iter().filter_map(|r| Coupling::line(&r.cell.at));
    let mut numbers: Vec<usize> = numbers.collect();
    numbers.sort_unstable();
    numbers.dedup();
    let of = |line: usize| {
        let own = move |r: &&'a Measured<Coupling>| Coupling::line(&r.cell.at) == Some(line);
        Line::of(rows.iter().copied().filter(own))
    };
    numbers.into_iter().map(of).collect()
}

/// A result of a row.
type Result_ = fn(&Measured<Coupling>) -> Option<f64>;

impl<'a> Line<'a> {
    fn of(rows: impl Iterator<Item = &'a Measured<Coupling>>) -> Self {
        let coupled = rows.filter_map(|r| Some((r.cell.at.scheme?.0, r)));
        let coupled: Vec<_> = coupled.collect();
        let scheme = coupled.first().map(|(scheme, _)| *scheme);
        let mut runs: Vec<_> = coupled.into_iter().map(|(s, r)| (s.step, r)).collect();
        runs.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self {
            scheme: scheme.unwrap_or_default(),
            runs,
        }
    }

    fn first(&self) -> Option<&'a Measured<Coupling>> {
        self.runs.first().map(|(_, r)| *r)
    }

    fn label(&self) -> String {
        self.first()
            .map_or_else(String::new, |r| r.run.model_label())
    }

    fn residual(&self) -> Option<bool> {
        self.first().and_then(|r| r.cell.at.model.residual)
    }

    fn theory(&self) -> Option<f64> {
        self.first().and_then(|r| r.row.theory_step_s)
    }

    /// Returns the largest step up to which the condition holds for all runs, and the next one, for which it does not.
    fn up_to(&self, holds: impl Fn(Status) -> bool) -> [Option<f64>; 2] {
        let made = self.runs.iter();
        let made = made.filter(|(_, r)| r.run.status != Status::Interrupted);
        let made: Vec<_> = made.collect();
        let held = made.iter().take_while(|(_, r)| holds(r.run.status)).count();
        let step = |i: usize| made.get(i).map(|(h, _)| *h);
        [held.checked_sub(1).and_then(step), step(held)]
    }

    /// Returns the largest communication step up to which every run was within the tolerance, and the next one.
    pub(super) fn accurate(&self) -> [Option<f64>; 2] {
        self.up_to(|s| s == Status::Converged)
    }

    /// Returns the largest communication step up to which no run failed, and the next one.
    pub(super) fn stable(&self) -> [Option<f64>; 2] {
        self.up_to(|s| !s.is_failure())
    }

    /// Runs up to the first that failed.
    fn held(&self) -> impl Iterator<Item = &(f64, &'a Measured<Coupling>)> {
        self.runs
            .iter()
            .take_while(|(_, r)| !r.run.status.is_failure())
    }

    /// Computes the order of an error between the two smallest steps without failure.
    fn order(&self, get: Result_) -> Option<f64> {
        let mut held = self.held();
        let ((h, a), (g, b)) = (held.next()?, held.next()?);
        let ratio = (get(b)? / get(a)?).abs();
        (ratio > 0.0 && ratio.is_finite()).then(|| ratio.ln() / (g / h).ln())
    }

    /// Interpolates the error of the force at a communication step between runs; `None` outside, or where a run failed.
    fn error_at(&self, step: f64) -> Option<f64> {
        let point = |(h, r): &(f64, &Measured<Coupling>)| {
            Some((h.ln(), force_error(r).filter(|e| *e > 0.0)?.ln()))
        };
        let points: Vec<(f64, f64)> = self.held().filter_map(point).collect();
        let at = step.ln();
        let pair = points.windows(2).find(|p| p[0].0 <= at && at <= p[1].0)?;
        let [(x, a), (y, b)] = [pair[0], pair[1]];
        Some((a + (at - x) / (y - x) * (b - a)).exp())
    }
}

fn force_error(r: &Measured<Coupling>) -> Option<f64> {
    r.run.against(WHOLE)?.force_l2
}

/// Formats a bracket of the largest step in words.
fn up_to([held, next]: [Option<f64>; 2]) -> Option<String> {
    match (held, next) {
        (Some(h), Some(_)) => Some(quantity(h, "s", 3)),
        (Some(h), None) => Some(format!("\u{2265} {}", quantity(h, "s", 3))),
        (None, Some(h)) => Some(format!("< {}", quantity(h, "s", 3))),
        (None, None) => None,
    }
}

#[rustfmt::skip]
fn line_columns<'a>() -> Columns<'a, Line<'a>> {
    let oscillator = |c: &Line<'_>| c.first().and_then(|r| r.cell.at.model.oscillator);
    Columns::<Line<'_>>::of("", "")
        .model(|c| c.label())
        .add("manner", "extrapolation, and the interpolation unless it is linear", |c| manner(c.scheme)).shown("Extrapolation", Format::Text).result()
        .add("accurate_to", "largest step up to which every run is accurate", |c| up_to(c.accurate())).shown("Accurate up to", Format::Plain).result()
        .add("stable_to", "largest step up to which no run failed", |c| up_to(c.stable())).shown("Stable up to", Format::Plain).result()
        .add(THEORY, "limit by linear theory", |c| c.theory()).shown("Limit of theory", Format::Quantities(3)).result()
        .add("force_order", "order of the error of the force", |c| c.order(force_error)).shown("Order of force error", Format::Short(3))
        .add("energy_order", "order of the error of energy", |c| c.order(|r| r.row.energy_error_rel)).shown("Order of energy error", Format::Short(3))
        .add("frequency_hz", "natural frequency of the hubs on the static stiffness of the gears in contact", move |c| oscillator(c).map(|o| o[0] / std::f64::consts::TAU)).shown("Hubs on teeth", Format::Quantities(4))
        .add("damping_ratio", "damping ratio of that vibration", move |c| oscillator(c).map(|o| o[1])).shown("Damping ratio", Format::Percents(3))
        .add("integrator", "integrator of the gears", |c| c.first().map(|r| r.cell.method.to_string())).shown("Integrator of the gears", Format::Text)
}

/// Returns the sentence on the gain by residual compliance: elastic gears with and without it under the same coupling.
fn gain(all: &[Line<'_>]) -> Option<String> {
    let of = |residual: bool| {
        let quadratic = |c: &&Line<'_>| c.scheme.extrapolation == Extrapolation::Quadratic;
        let all = all.iter().filter(quadratic);
        all.filter(move |c| c.residual() == Some(residual))
    };
    let with = of(true).next()?;
    let without = of(false).find(|c| c.scheme.motion == with.scheme.motion)?;
    let ratio = |a: f64, b: f64| format!("{} times", short(a / b, 2));
    let stable = ratio(with.stable()[0]?, without.stable()[0]?);
    let mut sentence = format!(
        "Under {} extrapolation {} stays stable up to {}, {stable} that of {} ({})",
        manner(with.scheme),
        with.label(),
        up_to(with.stable())?,
        without.label(),
        up_to(without.stable())?,
    );
    if let Some((a, b)) = with.accurate()[0].zip(without.accurate()[0]) {
        sentence += &format!(", and accurate {} as far", ratio(a, b));
    }
    let both =
        |(h, _): &(f64, &Measured<Coupling>)| Some((*h, with.error_at(*h)?, without.error_at(*h)?));
    if let Some((h, a, b)) = with.runs.iter().find_map(both) {
        sentence += &format!(
            "; at {} the force is off by {} and {}",
            quantity(h, "s", 3),
            per_cent(a, 2),
            per_cent(b, 2)
        );
    }
    let step = |c: &Line<'_>| c.first()?.cell.method.resolution.step();
    if let Some((a, b)) = step(with).zip(step(without)).filter(|(a, b)| a != b) {
        sentence += &format!(
            "; its gears take steps of {} in place of {}",
            quantity(a, "s", 3),
            quantity(b, "s", 3)
        );
    }
    Some(sentence + ".")
}

#[cfg(test)]
mod argument_tests {
    use super::*;

    #[test]
    fn what_is_asked_for_is_read() {
        assert_eq!(steps("1e-6:4e-6:3").unwrap().0.len(), 3);
        assert_eq!(steps("1e-6:1e-4").unwrap().0.len(), 12);
        assert_eq!(steps("1us:4us:3"), steps("1e-6:4e-6:3"));
        for wrong in ["1e-4:1e-6", "1e-6", "0:1", "1e-6:1e-4:1", "a:b", "1:2:3:4"] {
            assert!(steps(wrong).is_err(), "{wrong}");
        }
        assert!(tolerance("0").is_err());
    }
}
