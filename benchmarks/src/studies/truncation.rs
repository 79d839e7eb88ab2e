//! The study of mode counts: error of the elastic model over the number of modes and their highest frequency, with and
//! without residual compliance, chosen by frequency and by flank compliance, against full finite elements on the same mesh.
//!
//! The full model runs once, at a step so small that its own error is negligible, and all runs are compared with it.
//! Between the largest number of modes that misses a limit and the fewest that keeps it, the study bisects, so that the
//! fewest modes are found and not only bracketed.

use super::tabular::{Cell, Measured, Others, TableLine, TabularStudy};
use crate::cli::arguments::{AnyReference, BoundedOutput, TimedOutput};
use crate::cli::exit::Exit;
use crate::cli::terminal::{Refusal, refuse_run};
use crate::cli::values::DEFAULT_SCENE;
use crate::experiment::configuration::Configuration;
use crate::experiment::decimation::decimate_run;
use crate::experiment::error::StudyError;
use crate::experiment::run::{Job, RunError, run};
use crate::scene_file::{ModelChoice, SceneError, SceneFile, Selection};
use clap::Args;
use gearbench_integrators::table::{NEWMARK, TRIGONOMETRIC, VELOCITY_VERLET};
use gearbench_integrators::{MethodSpec, Resolution, Scheme};
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::spec::{ModelSpec, Modelling};
use gearbench_reference::full_order::FullOrderParameters;
use gearbench_reference::reduction::ElasticParameters;
use gearbench_reference::reduction::choose::Criterion;
use gearbench_reports::columns::Columns;
use gearbench_reports::metrics::{compare as measure, compare_all};
use gearbench_reports::numbers::{count, counted, limit as within, per_cent, times};
use gearbench_reports::record::{ReferenceSeries, Results, Run};
use gearbench_reports::tabular::TableChart;
use gearbench_reports::{Format, Metric};

const EXAMPLES: &str = "\
Examples:
  gearbench truncation                                   the scene spur_impact
  gearbench truncation spur_impact_large --counts 0,25,50,100
  gearbench truncation my_scene.toml --models elastic,fe --no-refine

The study runs the elastic model with a series of mode counts. Modes are selected by frequency and by flank
compliance; the truncated modes are either retained as residual compliance or neglected (plain truncation, among
others at 80 kHz and with 200 modes, as published). Each run is compared with one run of full finite elements on the
same mesh and with the reference of the scene.

The scene needs an elastic model and a model `fe` with the same mesh and the same contact. The study uses their
integrators; plain truncation uses the integrators of an elastic model with `residual = false`, if the scene has one.";

/// Compute the error of the elastic model over the number of modes, against full finite elements on the same mesh
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Truncation {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Labels of the elastic model and of the full model [default: the first of each kind]
    #[arg(long, value_name = "A,B")]
    pub models: Option<String>,
    /// Numbers of modes per gear, separated by commas [default: 0,10,25,35,50,75,100,150,200,300]
    #[arg(long, value_name = "N,M", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(0..=2000))]
    pub counts: Vec<u32>,
    /// Integrator of the full model [default: newmark with a fifth of its step in the scene]
    #[arg(long, value_name = "X@STEP")]
    pub reference_integrator: Option<String>,
    /// Do not determine the least number of modes for errors of 2, 1 and 0.5 %
    #[arg(long)]
    pub no_refine: bool,
    /// Where results go, how long a run may take, how often it is timed.
    #[command(flatten)]
    pub run: TimedOutput,
    /// Whether a reference of other gears will do.
    #[command(flatten)]
    pub insist: AnyReference,
}

/// Model whose modes are counted.
const ELASTIC: &str = ElasticParameters::MODEL;
/// Id of the full-order model, also its id as a reference.
const FULL: &str = FullOrderParameters::MODEL;
/// Limits of the force-history error whose fewest modes are determined.
const LIMITS: [f64; 3] = [0.02, 0.01, 0.005];
/// Step of the full model over that of the scene.
const FINER: f64 = 0.2;
/// Factor by which the time limit of the full model exceeds that of other runs.
const PATIENCE: u32 = 10;
/// Steps when the scene's model has no fixed one [s].
const STEP: f64 = 1e-6;
const FULL_STEP: f64 = 5e-7;
const TRUNCATED_STEP: f64 = 2e-8;
/// Default numbers of modes per gear.
const COUNTS: [usize; 10] = [0, 10, 25, 35, 50, 75, 100, 150, 200, 300];
/// Frequency bound of the published truncation [Hz]: "modes up to 80 kHz" (GTM, SIMPACK User Meeting 2014; rack and
/// pinion of an electric power steering).
const PUBLISHED_HZ: f64 = 80e3;
/// Published number of elastic coordinates per body.
const PUBLISHED_MODES: usize = 200;

/// A way to truncate modes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Variant {
    /// Name of the variant.
    label: &'static str,
    /// Criterion of the mode selection, the parameter `choose`.
    choose: Criterion,
    /// True if the residual compliance is kept, the parameter `residual`.
    residual: bool,
    /// Factor of the step relative to that of the scene's integrator.
    step: f64,
}

const BY_COMPLIANCE: Criterion = Criterion::FlankCompliance;

/// Variants that are compared. The cost of a smaller step is compared with the cost of the truncated modes.
#[rustfmt::skip]
const VARIANTS: [Variant; 5] = [
    Variant { label: "by flank compliance", choose: BY_COMPLIANCE, residual: true, step: 1.0 },
    Variant { label: "by flank compliance, a quarter of the step", choose: BY_COMPLIANCE, residual: true, step: 0.25 },
    Variant { label: "by frequency", choose: Criterion::Frequency, residual: true, step: 1.0 },
    Variant { label: "truncated, by flank compliance", choose: BY_COMPLIANCE, residual: false, step: 1.0 },
    Variant { label: "truncated, by frequency", choose: Criterion::Frequency, residual: false, step: 1.0 },
];

/// Bound on the modes of a gear.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ModeBound {
    /// Greatest number of modes.
    Count(usize),
    /// All modes below a frequency [Hz].
    Below(f64),
}

impl std::fmt::Display for ModeBound {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            ModeBound::Count(n) => write!(f, "{n} modes"),
            ModeBound::Below(hz) => write!(f, "modes to {:.0} kHz", 1e-3 * hz),
        }
    }
}

/// The model that a cell runs.
#[derive(Clone, Debug)]
pub struct Modes {
    /// Variant of truncation and modes of a reduced model; `None` for the full model.
    case: Option<(Variant, ModeBound)>,
    /// The full model and its integrator, with whose run the others are compared.
    full: String,
}

impl Modes {
    fn is_published(&self) -> Option<&'static str> {
        let (variant, modes) = self.case?;
        let plain = !variant.residual && variant.choose == Criterion::Frequency;
        match modes {
            ModeBound::Count(PUBLISHED_MODES) if plain => Some("plain truncation with 200 modes"),
            ModeBound::Below(_) if plain => Some("plain truncation at 80 kHz"),
            _ => None,
        }
    }
}

/// The elastic model of a study and its integrators.
struct Reduced {
    elastic: Configuration,
    method: Scheme,
    /// Integrator of plain truncation, whose contact is stiff.
    truncated: Scheme,
    full: String,
}

impl Reduced {
    fn cell(&self, variant: Variant, modes: ModeBound) -> Cell<Modes> {
        let usual = if variant.residual {
            &self.method
        } else {
            &self.truncated
        };
        let method = usual.method.at(match usual.resolution {
            Resolution::Step(h) => Resolution::Step(variant.step * h),
            Resolution::Tolerance(r) => Resolution::Tolerance(variant.step * r),
        });
        let mut configuration = self.elastic.clone();
        ElasticParameters::change(&mut configuration.modelling, |p| {
            (p.modes, p.max_frequency_hz, p.target_error) = match modes {
                ModeBound::Count(n) => (Some(n), None, None),
                ModeBound::Below(hz) => (None, Some(hz), None),
            };
            p.choose = Some(variant.choose);
            p.residual = Some(variant.residual);
            // Modes that the step cannot carry are cut.
            p.step_s = usual.resolution.step().or(p.step_s);
        });
        Cell {
            configuration,
            method,
            name: format!("{modes}, {}", variant.label),
            variant: Some(variant.label.into()),
            at: Modes {
                case: Some((variant, modes)),
                full: self.full.clone(),
            },
        }
    }
}

/// A row of a reduced model whose run ended well.
struct Ended<'a> {
    modes: usize,
    /// Error of the force history against full finite elements, if it is known.
    error: Option<f64>,
    run: &'a Run,
}

/// Error of the force history of a run against full finite elements.
fn error(run: &Run, metric: Metric) -> Option<f64> {
    let ended = (!run.status.is_failure())
        .then(|| run.against(FULL))
        .flatten();
    ended?.get(metric).filter(|e| e.is_finite())
}

/// The rows of a variant, ascending in modes; failed runs have no error.
fn of_variant<'a>(
    rows: impl IntoIterator<Item = &'a Measured<Truncation>>,
    variant: &Variant,
) -> Vec<Ended<'a>> {
    let own = rows.into_iter().filter(|r| {
        let is = r.cell.at.case.is_some_and(|(v, _)| v == *variant);
        is && r.run.modes.is_some()
    });
    let mut all: Vec<Ended<'a>> = own
        .map(|r| Ended {
            modes: r.run.modes.unwrap_or(0),
            error: error(&r.run, Metric::ForceL2).map(f64::abs),
            run: &r.run,
        })
        .collect();
    all.sort_by_key(|r| r.modes);
    all
}

/// Returns the row with the fewest modes from which on every number of modes is within a limit; a failed run is beyond
/// every limit.
fn fewest<'s, 'a>(rows: &'s [Ended<'a>], limit: f64) -> Option<&'s Ended<'a>> {
    let keeps = |r: &&Ended<'_>| r.error.is_some_and(|e| e <= limit);
    rows.iter().rev().take_while(keeps).last()
}

/// Returns the number of modes halfway between the fewest that keep a limit and the next smaller that was tried; `None`
/// when there is none in between, or nothing keeps the limit.
fn between(rows: &[Ended<'_>], limit: f64) -> Option<usize> {
    let fewest = fewest(rows, limit)?.modes;
    let below = (rows.iter().map(|r| r.modes))
        .filter(|n| *n < fewest)
        .max()?;
    (fewest - below > 1).then_some(below + (fewest - below) / 2)
}

impl TabularStudy for Truncation {
    const NAME: &'static str = "truncation";
    const ROWS: &'static str =
        "one row per truncation of modes and number of modes, after that of full finite elements";
    const REMARK: &'static str = "Errors: against full finite elements on the same mesh, not shifted in time. Modes chosen by flank \
        compliance reach high frequencies early: the highest frequency says what a step has to follow, not how many modes there are.";
    /// A failed run is a result.
    const EXIT: fn(&Results) -> Exit = Exit::of_any_run;
    type At = Modes;
    type Row = ();

    fn scene(&self) -> &str {
        &self.scene
    }

    fn selection(&self) -> Selection<'_> {
        Selection::All
    }

    fn options(&mut self) -> &mut BoundedOutput {
        &mut self.run.bounded
    }

    fn repeats(&self) -> u32 {
        self.run.repeats
    }

    fn compared(&self) -> Option<&AnyReference> {
        Some(&self.insist)
    }

    fn cells(&self, scene: &SceneFile) -> Result<Vec<Cell<Modes>>, Refusal> {
        let (elastic, full) = self.sides(scene)?;
        let full_method = self.full_method(scene, full)?;
        let full = Configuration::of(scene, full);
        let reduced = Reduced {
            elastic: Configuration::of(scene, elastic),
            method: first(elastic, TRIGONOMETRIC, STEP),
            truncated: truncated(scene, elastic),
            full: format!("{:?} {full_method:?}", full.modelling),
        };
        let mut counts: Vec<usize> = self.counts.iter().map(|n| *n as usize).collect();
        if counts.is_empty() {
            counts = COUNTS.to_vec();
        }
        counts.sort_unstable();
        counts.dedup();
        let mut cells = vec![Cell {
            configuration: full,
            method: full_method,
            variant: None,
            name: "full finite elements".into(),
            at: Modes {
                case: None,
                full: reduced.full.clone(),
            },
        }];
        for variant in VARIANTS {
            let bounds = counts.iter().map(|n| ModeBound::Count(*n));
            cells.extend(bounds.map(|modes| reduced.cell(variant, modes)));
            if !variant.residual && variant.choose == Criterion::Frequency {
                cells.push(reduced.cell(variant, ModeBound::Below(PUBLISHED_HZ)));
            }
        }
        Ok(cells)
    }

    fn measure(
        &self,
        cell: &Cell<Modes>,
        job: &Job<'_>,
        others: &Others<'_, Self>,
    ) -> Result<(Run, ()), StudyError> {
        let is_full = cell.at.case.is_none();
        let mut made = match is_full {
            true => run(&Job {
                repeats: 0,
                timeout: PATIENCE * job.timeout,
                ..*job
            })?,
            false => run(job)?,
        };
        let mut metrics = Vec::new();
        if let Ok(finished) = made.finished() {
            let full = others.rows.first().and_then(|r| r.run.series.as_ref());
            metrics.extend(full.map(|series| measure(finished, series, FULL)));
            let external = others.references.iter();
            metrics.extend(external.map(|r| compare_all(finished, &r.all_series(), &r.id)));
        }
        made.metrics.extend(metrics);
        if is_full {
            if made.status.is_failure() || made.series.is_none() {
                return Err(StudyError::Run(RunError::Reference(format!(
                    "the full model under {} did not complete the run: {}",
                    cell.method.method,
                    made.message.as_deref().unwrap_or("no reason given")
                ))));
            }
            return Ok((made, ()));
        }
        made.choose = cell.at.case.map(|(v, _)| v.choose.id().into());
        made.residual = cell.at.case.map(|(v, _)| v.residual);
        // The modes that were kept, as the model says; a model without any keeps none.
        made.modes = Some(made.modes.unwrap_or(0));
        made.contacts = None;
        decimate_run(&mut made, &[]);
        Ok((made, ()))
    }

    fn next(&self, rows: &[Measured<Self>]) -> Option<Cell<Modes>> {
        if self.no_refine {
            return None;
        }
        let searched = VARIANTS.iter().filter(|v| v.residual && v.step == 1.0);
        let mut wanted = searched.flat_map(|v| LIMITS.map(|limit| (v, limit)));
        wanted.find_map(|(variant, limit)| {
            let modes = ModeBound::Count(between(&of_variant(rows, variant), limit)?);
            // Families of modes are kept whole: another number asked for may be one that was had.
            let is_new = |r: &Measured<Self>| r.cell.at.case != Some((*variant, modes));
            let cell = &rows
                .iter()
                .find(|r| r.cell.at.case.is_some_and(|(v, _)| v == *variant))?
                .cell;
            let reduced = Reduced {
                elastic: cell.configuration.clone(),
                method: cell.method,
                truncated: cell.method,
                full: cell.at.full.clone(),
            };
            rows.iter()
                .all(is_new)
                .then(|| reduced.cell(*variant, modes))
        })
    }

    fn compare(&self, rows: &mut [Measured<Self>]) -> Vec<ReferenceSeries> {
        // Searched numbers stand in their order.
        rows.sort_by_key(|r| {
            let case = r.cell.at.case;
            let place = case.and_then(|(v, _)| VARIANTS.iter().position(|w| *w == v));
            (case.is_some(), place, r.run.modes)
        });
        let reference = rows.first().and_then(|full| {
            Some(ReferenceSeries {
                id: FULL.into(),
                title: "full finite elements on the same mesh".into(),
                source: format!(
                    "the first run of this record: {} coordinates under {}",
                    full.run.dofs, full.cell.method.method
                ),
                series: full.run.series.clone()?,
                ..ReferenceSeries::default()
            })
        });
        // Histories that a report shows: the full model, published ways, the best of each variant and the one that
        // reaches the middle limit.
        let mut shown: Vec<(&str, Option<usize>)> = Vec::new();
        for variant in &VARIANTS {
            let own = of_variant(rows.iter(), variant);
            let sound = own.iter().filter_map(|r| Some((r.error?, r)));
            let best = sound
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .map(|(_, r)| r.modes);
            let middle = fewest(&own, LIMITS[1]).map(|r| r.modes);
            shown.extend(
                [best, middle]
                    .into_iter()
                    .flatten()
                    .map(|n| (variant.label, Some(n))),
            );
        }
        for row in rows.iter_mut().skip(1) {
            let of = |(label, modes): &(&str, Option<usize>)| {
                row.cell.variant.as_deref() == Some(*label) && row.run.modes == *modes
            };
            if row.cell.at.is_published().is_none() && !shown.iter().any(of) {
                (row.run.series, row.run.histories) = (None, None);
            }
        }
        reference.into_iter().collect()
    }

    #[rustfmt::skip]
    fn columns<'a>(columns: Columns<'a, TableLine<'a, Self>>) -> Columns<'a, TableLine<'a, Self>> {
        let of = |metric: Metric| move |f: &TableLine<'_, Self>| error(&f.run, metric);
        let further = |f: &TableLine<'_, Self>| {
            let ended = (!f.run.status.is_failure()).then_some(&f.run.metrics);
            ended?.iter().find(|m| m.against != FULL)?.get(Metric::ForceL2)
        };
        let per_step = |f: &TableLine<'_, Self>| (f.run.steps > 0).then(|| f.run.cost_s() / f.run.steps as f64);
        columns
            .add("modes", "modes per gear that are kept", |f| f.run.modes).shown("Modes", Format::Plain).result()
            .add("highest_hz", "highest frequency among the modes", |f| f.run.highest_hz.filter(|x| *x > 0.0)).shown("Highest mode", Format::Numbers(3))
            .add("force_l2", "relative L2 error of the force history against full finite elements on the same mesh", of(Metric::ForceL2)).shown("Force history, off", Format::Percents(3)).result()
            .add("force_l2_to_reference", "relative L2 error of the force history against the first reference of the scene", further).shown("Off the reference", Format::Percents(3))
            .add("peak_force_rel", "deviation of the peak force from full finite elements", of(Metric::PeakForceRel)).shown("Peak force, off", Format::Deviations)
            .add("impulse_rel", "deviation of the impulse from full finite elements", of(Metric::ImpulseRel)).shown("Impulse, off", Format::Deviations)
            .add("cpu_s", "processor time of the integration, median of the repeats", |f| f.run.cost_s()).shown("Time of the run", Format::Durations).result()
            .add("cpu_per_step_s", "processor time of an accepted step", per_step).shown("Time of a step", Format::Durations)
            .add("steps", "accepted steps", |f| f.run.steps).shown("Steps", Format::Counts)
            .add("setup_s", "wall time before the first step", |f| f.run.setup_s).shown("Set-up", Format::Durations)
            .add("residual", "whether the truncated modes are represented by residual compliance", |f| f.run.residual)
            .add("choose", "choice of the modes", |f| f.run.choose.clone())
            .add("mark", "published truncation that the row repeats", |f| f.cell.at.is_published().map(String::from)).shown("Published", Format::Text)
    }

    fn charts(&self, _: &[&Measured<Self>]) -> Vec<TableChart> {
        let keys = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect();
        let over_modes = TableChart {
            abscissa: "modes".into(),
            ..TableChart::default()
        };
        vec![
            TableChart {
                file: "truncation".into(),
                title: "Error over the number of modes".into(),
                caption: "Relative L2 error of the contact-force history, not shifted in time, against full finite elements on \
                          the same mesh and against the reference of the scene. Failed runs stand as crosses above the frame."
                    .into(),
                ordinates: keys(&["force_l2", "force_l2_to_reference"]),
                magnitudes: true,
                levels: LIMITS.to_vec(),
                marks: "mark".into(),
                ..over_modes.clone()
            },
            TableChart {
                file: "truncation_frequencies".into(),
                title: "Error over the highest frequency".into(),
                caption: "The same runs over the highest frequency among the modes that either gear keeps.".into(),
                abscissa: "highest_hz".into(),
                ordinates: keys(&["force_l2"]),
                magnitudes: true,
                levels: LIMITS.to_vec(),
                marks: "mark".into(),
                ..TableChart::default()
            },
            TableChart {
                file: "truncation_peak".into(),
                title: "Peak force and impulse over the number of modes".into(),
                caption: "Magnitudes of the deviations from full finite elements.".into(),
                ordinates: keys(&["peak_force_rel", "impulse_rel"]),
                magnitudes: true,
                ..over_modes.clone()
            },
            TableChart {
                file: "truncation_cost".into(),
                title: "Cost over the number of modes".into(),
                caption: "Processor time of an accepted step, and of the whole run without set-up. Plain truncation needs the \
                          small steps of its stiff contact."
                    .into(),
                ordinates: keys(&["cpu_per_step_s", "cpu_s"]),
                ..over_modes
            },
        ]
    }

    fn finding(&self, rows: &[&Measured<Self>]) -> Vec<String> {
        let own = |v: &Variant| of_variant(rows.iter().copied(), v);
        let residual = || VARIANTS.iter().filter(|v| v.residual && v.step == 1.0);
        if residual().all(|v| own(v).is_empty()) {
            return vec!["No run with modes was made.".into()];
        }
        let fewest_of = |v: &Variant| {
            let own = own(v);
            let reached: Vec<String> = (LIMITS.iter())
                .filter_map(|limit| {
                    Some(format!(
                        "{} for {}",
                        fewest(&own, *limit)?.modes,
                        within(*limit)
                    ))
                })
                .collect();
            match reached.is_empty() {
                true => format!("more than any number tried when chosen {}", v.label),
                false => format!("{} when chosen {}", reached.join(", "), v.label),
            }
        };
        let all: Vec<String> = residual()
            .filter(|v| !own(v).is_empty())
            .map(fewest_of)
            .collect();
        let mut sentences = vec![format!(
            "With residual compliance the fewest modes per gear are {} (error of the force history against full finite elements on \
             the same mesh).",
            all.join("; ")
        )];
        for row in rows {
            let Some(name) = row.cell.at.is_published() else {
                continue;
            };
            let modes = row.run.modes.unwrap_or(0);
            let Some(off) = error(&row.run, Metric::ForceL2) else {
                sentences.push(format!(
                    "The {name} ({modes} modes) failed: {}.",
                    row.run.status.as_str()
                ));
                continue;
            };
            // The best run with residual compliance and no more modes.
            let rows: Vec<Ended<'_>> = residual().flat_map(own).collect();
            let fair = (rows.iter()).filter(|r| r.modes <= modes && r.error.is_some());
            let better =
                fair.min_by(|a, b| a.error.unwrap_or(1.0).total_cmp(&b.error.unwrap_or(1.0)));
            let compared = better.map_or_else(String::new, |r| {
                let e = r.error.unwrap_or(f64::NAN);
                format!(
                    ", {}that of {} modes with residual compliance ({}, {} steps in place of {})",
                    times(off / e),
                    r.modes,
                    per_cent(e, 2),
                    count(r.run.steps),
                    count(row.run.steps),
                )
            });
            sentences.push(format!(
                "The {name} ({modes} modes per gear) has an error of {}{compared}.",
                per_cent(off, 3)
            ));
        }
        let failed = rows.iter().filter(|r| r.run.status.is_failure()).count();
        if failed > 0 {
            sentences.push(format!(
                "{failed} of {} failed.",
                counted(rows.len(), "run", "runs")
            ));
        }
        sentences
    }
}

impl Truncation {
    /// The elastic and the full model of a scene that are compared: the first two on the same mesh with the same contact,
    /// so that only the modes differ.
    fn sides<'s>(
        &self,
        scene: &'s SceneFile,
    ) -> Result<(&'s ModelChoice, &'s ModelChoice), Refusal> {
        let named = match &self.models {
            Some(text) => scene.select(Some(text))?,
            None => scene.models.iter().collect(),
        };
        let of = |id: &str| {
            let whole = (named.iter().copied()).filter(|m| m.model == id && !is_truncated(m));
            let whole: Vec<&ModelChoice> = whole.collect();
            (!whole.is_empty()).then_some(whole).ok_or_else(|| {
                SceneError::plain(
                    format!("the scene `{}` has no model of the kind `{id}`", scene.name),
                    format!(
                        "the study compares `{ELASTIC}` with `{FULL}` on the same mesh; add a [[models]] with model = \"{id}\""
                    ),
                )
            })
        };
        let (reduced, full) = (of(ELASTIC)?, of(FULL)?);
        let mut pairs = reduced
            .iter()
            .flat_map(|e| full.iter().map(move |f| (*e, *f)));
        let found = pairs.find(|(e, f)| differ_in_modes_alone(&e.modelling, &f.modelling));
        found.ok_or_else(|| {
            let (e, f) = (&reduced[0].label, &full[0].label);
            Refusal::from(SceneError::plain(
                format!("no elastic model of the scene `{}` has the mesh and the contact of a full one: `{e}` and `{f}` differ in more than their modes", scene.name),
                format!("give `{f}` the mesh parameters and the `contact` of `{e}`, or name two models that share them with --models"),
            ))
        })
    }

    fn full_method(&self, scene: &SceneFile, full: &ModelChoice) -> Result<Scheme, Refusal> {
        if let Some(text) = &self.reference_integrator {
            let methods = Scheme::list(text, &scene.study.integrators)
                .map_err(RunError::from)
                .map_err(refuse_run)?;
            if let Some(method) = methods.into_iter().next() {
                return Ok(method);
            }
        }
        let own = first(full, NEWMARK, FULL_STEP);
        let step = own.resolution.step().unwrap_or(FULL_STEP);
        Ok(NEWMARK.at_step(FINER * step))
    }
}

/// True if an elastic and a full model have the same mesh of each gear and the same contact at their flanks.
fn differ_in_modes_alone(elastic: &Modelling, full: &Modelling) -> bool {
    let same_mesh = |(e, f): (&ModelSpec, &ModelSpec)| {
        ElasticParameters::of(e).map(|p| &p.mesh) == FullOrderParameters::of(f).map(|p| &p.mesh)
    };
    let contacts = elastic.contacts.iter().zip(&full.contacts);
    elastic.gears.iter().zip(&full.gears).all(same_mesh)
        && contacts.into_iter().all(|(e, f)| e.flanks == f.flanks)
}

fn is_truncated(choice: &ModelChoice) -> bool {
    let mut gears = choice.modelling.gears.iter();
    gears.any(|g| ElasticParameters::of(g).is_some_and(|p| !p.keeps_residual()))
}

/// The first integrator of a model, or one that fits it.
fn first(choice: &ModelChoice, usual: MethodSpec, step: f64) -> Scheme {
    let own = choice.integrators.as_ref().and_then(|m| m.first());
    own.copied().unwrap_or(usual.at_step(step))
}

/// The integrator of plain truncation: that of a truncated model of the scene.
fn truncated(scene: &SceneFile, elastic: &ModelChoice) -> Scheme {
    let own = (scene.models.iter()).find(|m| m.model == ELASTIC && is_truncated(m));
    own.map_or_else(
        || (first(elastic, TRIGONOMETRIC, STEP).method).at_step(TRUNCATED_STEP),
        |m| first(m, VELOCITY_VERLET, TRUNCATED_STEP),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_finds_the_fewest_modes() {
        let run = Run::default();
        // A made-up model whose error falls with its modes: 0.5 / (1 + n) falls to 1 % at 49.
        let row = |modes: usize| Ended {
            modes,
            error: Some(0.5 / (1.0 + modes as f64)),
            run: &run,
        };
        let mut rows: Vec<Ended<'_>> = [0, 10, 25, 50, 100, 200].map(row).into();
        let mut tried = 0;
        while let Some(modes) = between(&rows, 0.01) {
            rows.push(row(modes));
            rows.sort_by_key(|r| r.modes);
            tried += 1;
        }
        assert_eq!(fewest(&rows, 0.01).map(|r| r.modes), Some(49));
        assert!(tried <= 5, "{tried} runs");
        assert_eq!(between(&rows, 1e-6), None);
        assert_eq!(between(&[], 0.01), None);
    }

    /// A failed run is beyond every limit: smaller numbers do not suffice where a larger one fails.
    #[test]
    fn a_failed_run_ends_the_search_downwards() {
        let run = Run::default();
        let row = |modes: usize, error: Option<f64>| Ended {
            modes,
            error,
            run: &run,
        };
        let rows = [
            row(10, Some(0.001)),
            row(20, None),
            row(30, Some(0.002)),
            row(40, Some(0.001)),
        ];
        assert_eq!(fewest(&rows, 0.01).map(|r| r.modes), Some(30));
        assert!(fewest(&rows[..2], 0.01).is_none());
    }
}
