//! The study of penalties: force, impulse and static transmission error of one model over the penalty of its contact,
//! compared with the same model with hard contact.
//!
//! A penalty is a numerical spring without physical counterpart. Results that depend on it are no results for the
//! gears; with hard contact as the limit, the study shows above which penalty they no longer depend on it.

use super::tabular::{Cell, Measured, Others, TableLine, TabularStudy};
use crate::cli::arguments::BoundedOutput;
use crate::cli::terminal::Refusal;
use crate::cli::values::{DEFAULT_LOAD, DEFAULT_SCENE, number, positions, positive_load};
use crate::experiment::conditions::logarithmic;
use crate::experiment::configuration::Configuration;
use crate::experiment::error::StudyError;
use crate::experiment::run::{Job, run};
use crate::scene_file::{ModelChoice, SceneError, SceneFile, Selection};
use clap::Args;
use gearbench_integrators::table::VELOCITY_VERLET;
use gearbench_models::spec::{ContactSpec, mesh_layout};
use gearbench_reference::statics::{Load, LoadedPair, MeshCycle};
use gearbench_reports::columns::Columns;
use gearbench_reports::metrics::compare as measure;
use gearbench_reports::numbers::{per_cent, power, round_quantity, short};
use gearbench_reports::record::{ReferenceSeries, Run, SELF};
use gearbench_reports::series::TimeSeries;
use gearbench_reports::tabular::TableChart;
use gearbench_reports::{Format, Metric};
use serde::{Deserialize, Serialize};

const EXAMPLES: &str = "\
Examples:
  gearbench penalty                                  the elastic gears of spur_impact, contact points at nodes
  gearbench penalty spur_impact --from 1e14 --to 1e16 --points 5
  gearbench penalty my_scene.toml --model elastic --hard elastic-without-penalty

The study runs one model with a series of penalties and computes its static transmission error under --load. The limit
for comparison is the same model with hard contact, if the scene has one (--hard, or the label with -hard appended).
Both need the same contact points: a penalty at nodes converges to hard contact at nodes, not to hard contact of
averaged gaps.";

/// Compute results over the contact penalty and compare them with hard contact
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Penalty {
    /// Name of a shipped scene, or path of a scene file (.toml)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Label of the model [default: the first with a variant LABEL-hard, else the first with contact at flank points]
    #[arg(long, visible_alias = "models", value_name = "LABEL")]
    pub model: Option<String>,
    /// Label of the same model with hard contact [default: LABEL-hard, if the scene has it]
    #[arg(long, value_name = "LABEL")]
    pub hard: Option<String>,
    /// Softest penalty [Pa/m]
    #[arg(long, value_name = "PA_PER_M", default_value_t = 1e13, value_parser = penalty)]
    pub from: f64,
    /// Stiffest penalty [Pa/m]
    #[arg(long, value_name = "PA_PER_M", default_value_t = 1e17, value_parser = penalty)]
    pub to: f64,
    /// Number of penalties, evenly spaced on a logarithmic scale
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub points: u32,
    /// Load of the static equilibria in the transverse plane per common face width [N/mm]
    #[arg(long, value_name = "N_PER_MM", default_value_t = DEFAULT_LOAD, value_parser = positive_load)]
    pub load: f64,
    /// Number of positions of the static cycle over one base pitch
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = positions)]
    pub positions: usize,
    /// Where results go, and how long a run may take.
    #[command(flatten)]
    pub run: BoundedOutput,
}

fn penalty(text: &str) -> Result<f64, String> {
    let expected = "expected a positive number of Pa/m, for example 1e15";
    number(text, |x| *x > 0.0 && *x <= 1e25, expected)
}

/// Advice for a model without a penalty.
const TAKE_POINTS: &str =
    "use a model with contact at flank points: `contact = { penalty_pa_per_m = .. }`";
/// Deviation from hard contact up to which a penalty is stiff enough.
const ENOUGH: f64 = 0.01;
/// Name of the reference.
const HARD: &str = "hard";

/// Contact and static load of a cell.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Penalty [Pa/m]; `None` for hard contact.
    penalty: Option<f64>,
    /// Force along the line of action in the static equilibria [N]; `None` leaves them out.
    load: Option<f64>,
    positions: usize,
}

/// Quantities of a run that do not come from its histories.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PenaltyRow {
    /// Mean static transmission error over one base pitch [m].
    static_error_m: Option<f64>,
    /// Deviations of peak force, impulse and static transmission error from hard contact.
    deviations: [Option<f64>; 3],
}

/// Returns the quantities that are compared with hard contact; none of a failed run.
fn quantities(r: &Measured<Penalty>) -> [Option<f64>; 3] {
    let ended = (!r.run.status.is_failure()).then_some(&r.run);
    let metric = |m: Metric| ended?.metrics.first()?.get(m);
    [
        metric(Metric::PeakForce),
        metric(Metric::Impulse),
        r.row.static_error_m.filter(|_| ended.is_some()),
    ]
}

/// Names of the quantities.
const NAMES: [&str; 3] = ["peak force", "impulse", "static transmission error"];

impl TabularStudy for Penalty {
    const NAME: &'static str = "penalty";
    const ROWS: &'static str = "one row per penalty, and one of hard contact";
    const REMARK: &'static str = "Off: deviation from hard contact. TE: transmission error at rest under the load of the study, mean over a \
        base pitch.";
    type At = Contact;
    type Row = PenaltyRow;

    fn scene(&self) -> &str {
        &self.scene
    }

    fn selection(&self) -> Selection<'_> {
        Selection::All
    }

    fn options(&mut self) -> &mut BoundedOutput {
        &mut self.run
    }

    fn settings(&self, scene: &SceneFile) -> Vec<(String, String)> {
        let text = |force: f64| {
            format!(
                "{} along the line of action in the transverse plane, {} N/mm",
                round_quantity(force, "N", 4),
                short(self.load, 4)
            )
        };
        let force = self.static_load(scene);
        force
            .map(|f| ("static load".into(), text(f)))
            .into_iter()
            .collect()
    }

    fn cells(&self, scene: &SceneFile) -> Result<Vec<Cell<Contact>>, Refusal> {
        let (choice, hard) = self.sides(scene)?;
        if self.to <= self.from {
            return Err(Refusal::Input(miette::miette!(
                help = "give the softer penalty with --from",
                "the penalties from {:e} to {:e} Pa/m do not increase",
                self.from,
                self.to
            )));
        }
        let soft = Configuration::of(scene, choice);
        let usual = scene.study.integrators.first().copied();
        let usual = usual.unwrap_or(VELOCITY_VERLET.at_step(1e-7));
        let load = self.static_load(scene);
        let cell = |configuration: Configuration, penalty: Option<f64>| {
            let own = configuration.methods.as_ref().and_then(|m| m.first());
            Cell {
                method: own.copied().unwrap_or(usual),
                name: penalty.map_or("hard contact".into(), |p| format!("{p:.1e} Pa/m")),
                variant: None,
                at: Contact {
                    penalty,
                    load,
                    positions: self.positions,
                },
                // One name for soft and hard contact: they are one model.
                configuration: Configuration {
                    label: soft.label.clone(),
                    model: soft.model.clone(),
                    ..configuration
                },
            }
        };
        let mut cells = Vec::new();
        for penalty in logarithmic(self.from, self.to, self.points as usize) {
            cells.push(cell(with_penalty(&soft, penalty)?, Some(penalty)));
        }
        cells.extend(hard.map(|hard| cell(Configuration::of(scene, hard), None)));
        Ok(cells)
    }

    fn measure(
        &self,
        cell: &Cell<Contact>,
        job: &Job<'_>,
        _: &Others<'_, Self>,
    ) -> Result<(Run, PenaltyRow), StudyError> {
        let mut made = run(job)?;
        made.contacts = None;
        let row = PenaltyRow {
            static_error_m: static_error(cell, job)?,
            ..PenaltyRow::default()
        };
        Ok((made, row))
    }

    fn compare(&self, rows: &mut [Measured<Self>]) -> Vec<ReferenceSeries> {
        let is_hard = |r: &&Measured<Self>| r.cell.at.penalty.is_none();
        let hard = rows.iter().find(is_hard);
        let ended = hard.filter(|r| !r.run.status.is_failure());
        let series = ended.and_then(|r| r.run.series.clone());
        // Without a limit to refer to, the outputs alone.
        let none = TimeSeries::default();
        let id = if series.is_some() { HARD } else { SELF };
        for r in rows.iter_mut() {
            let target = match r.cell.at.penalty {
                Some(_) => series.as_ref().unwrap_or(&none),
                None => &none,
            };
            let metrics = r.run.finished().map(|run| measure(run, target, id));
            r.run.metrics.extend(metrics);
        }
        let limit = rows.iter().find(is_hard).map(quantities);
        for r in rows.iter_mut().filter(|r| r.cell.at.penalty.is_some()) {
            let own = quantities(r);
            r.row.deviations = std::array::from_fn(|k| Some(own[k]? / limit?[k]? - 1.0));
        }
        let reference = series.map(|series| ReferenceSeries {
            id: HARD.into(),
            title: "hard contact".into(),
            source: "the last run of this record".into(),
            series,
            ..ReferenceSeries::default()
        });
        reference.into_iter().collect()
    }

    #[rustfmt::skip]
    fn columns<'a>(columns: Columns<'a, TableLine<'a, Self>>) -> Columns<'a, TableLine<'a, Self>> {
        let of = |k: usize| move |f: &TableLine<'_, Self>| quantities(f)[k];
        let off = |k: usize| move |f: &TableLine<'_, Self>| f.row.deviations[k];
        let to_hard = |f: &TableLine<'_, Self>| f.run.against(HARD).filter(|_| f.cell.at.penalty.is_some())?.get(Metric::ForceL2);
        columns
            .add("penalty_pa_per_m", "penalty of the contact; empty for hard contact", |f| f.cell.at.penalty).shown("Penalty", Format::Powers).result()
            .add("peak_force_n", Metric::PeakForce.meaning(), of(0)).shown("Peak force", Format::Numbers(5)).result()
            .add("peak_force_off_rel", "deviation of the peak force from hard contact", off(0)).shown("Peak force, off", Format::Deviations).result()
            .add("impulse_ns", Metric::Impulse.meaning(), of(1)).shown("Impulse", Format::Numbers(5)).result()
            .add("impulse_off_rel", "deviation of the impulse from hard contact", off(1)).shown("Impulse, off", Format::Deviations).result()
            .add("static_transmission_error_m", "mean static transmission error over a base pitch under the load of the study", of(2)).shown("Static TE", Format::Numbers(5)).result()
            .add("static_transmission_error_off_rel", "deviation of the static transmission error from hard contact", off(2)).shown("Static TE, off", Format::Deviations).result()
            .add("force_l2_to_hard", "relative L2 error of the force history against hard contact", to_hard).shown("Force history, off", Format::Percents(3))
            .add("cpu_s", "processor time of the integration", |f| f.run.cpu_s).shown("Processor time", Format::Numbers(3))
            .add("steps", "accepted steps", |f| f.run.steps).shown("Steps", Format::Counts)
    }

    fn charts(&self, _: &[&Measured<Self>]) -> Vec<TableChart> {
        let keys = |names: [&str; 3]| names.map(String::from).to_vec();
        vec![
            TableChart {
                file: "penalty".into(),
                title: "Independence of the penalty".into(),
                caption: "Peak force and impulse of the run, and mean static transmission error over one base pitch, over \
                          the penalty of the contact. The dark line is hard contact, which has none."
                    .into(),
                abscissa: "penalty_pa_per_m".into(),
                ordinates: keys(["peak_force_n", "impulse_ns", "static_transmission_error_m"]),
                limit: "hard contact".into(),
                ..TableChart::default()
            },
            TableChart {
                file: "penalty_distance".into(),
                title: "Distance to hard contact".into(),
                caption: "Magnitudes of the deviations from hard contact. A penalty that gives like a spring in series \
                          loses a decade of deviation per decade of penalty; where the lines level off, step and mesh \
                          decide."
                    .into(),
                abscissa: "penalty_pa_per_m".into(),
                ordinates: keys([
                    "peak_force_off_rel",
                    "impulse_off_rel",
                    "static_transmission_error_off_rel",
                ]),
                magnitudes: true,
                ..TableChart::default()
            },
        ]
    }

    fn finding(&self, rows: &[&Measured<Self>]) -> Vec<String> {
        let point = |f: &&Measured<Self>| Point {
            penalty: f.cell.at.penalty,
            failed: f.run.status.is_failure(),
            deviations: f.row.deviations,
        };
        let label = rows
            .first()
            .map_or_else(String::new, |f| f.run.model_label());
        sentences(&label, &rows.iter().map(point).collect::<Vec<_>>())
    }
}

/// A row as the finding needs it.
struct Point {
    penalty: Option<f64>,
    failed: bool,
    deviations: [Option<f64>; 3],
}

/// Returns the deviations at the stiffest penalty, and the penalties from which on they are small.
fn sentences(label: &str, rows: &[Point]) -> Vec<String> {
    let ended = || rows.iter().filter(|p| !p.failed);
    let soft: Vec<(f64, &Point)> = ended().filter_map(|p| Some((p.penalty?, p))).collect();
    let Some((at, stiffest)) = soft.last() else {
        return vec!["No run with a penalty ended well.".into()];
    };
    if !ended().any(|p| p.penalty.is_none()) {
        return vec![format!(
            "{label} has no run with hard contact to compare with."
        )];
    }
    let named = NAMES.iter().zip(stiffest.deviations);
    let off: Vec<String> = named
        .filter_map(|(name, off)| Some(format!("{name} by {}", per_cent(off?.abs(), 2))))
        .collect();
    let mut sentences = vec![format!(
        "With a penalty of {} Pa/m {label} differs from hard contact in {}.",
        power(*at, 1),
        off.join(", ")
    )];
    let enough = |k: usize| {
        let near = |(_, p): &&(f64, &Point)| p.deviations[k].is_some_and(|x| x.abs() <= ENOUGH);
        let (from, _) = soft.iter().rev().take_while(near).last()?;
        Some(format!("the {} from {} Pa/m on", NAMES[k], power(*from, 1)))
    };
    let from: Vec<String> = [0, 2].into_iter().filter_map(enough).collect();
    if !from.is_empty() {
        let within = per_cent(ENOUGH, 1);
        sentences.push(format!("Within {within} are {}.", from.join(" and ")));
    }
    sentences
}

impl Penalty {
    /// The model whose penalty is varied, and the same one with hard contact.
    fn sides<'s>(
        &self,
        scene: &'s SceneFile,
    ) -> Result<(&'s ModelChoice, Option<&'s ModelChoice>), Refusal> {
        let twin = |m: &&ModelChoice| scene.model(&format!("{}-hard", m.label)).is_some();
        let soft = |c: &ContactSpec| c.flanks.penalty().is_some();
        let penalty = |m: &&ModelChoice| m.modelling.contacts.iter().any(soft);
        let found = (scene.models.iter().find(twin)).or_else(|| scene.models.iter().find(penalty));
        let choice = match (&self.model, found) {
            (Some(label), _) => scene.select(Some(label))?[0],
            (None, Some(found)) => found,
            (None, None) => {
                let why = format!("no model of the scene `{}` has a penalty", scene.name);
                return Err(SceneError::plain(why, TAKE_POINTS).into());
            }
        };
        let hard = match &self.hard {
            Some(label) => Some(scene.select(Some(label))?[0]),
            None => scene.model(&format!("{}-hard", choice.label)),
        };
        Ok((choice, hard))
    }

    /// The force of the static equilibria, which are those of one mesh of two gears [N].
    fn static_load(&self, scene: &SceneFile) -> Option<f64> {
        let gears = &scene.spec.gears;
        match scene.spec.meshes.as_slice() {
            [mesh] if gears.len() == 2 => {
                let [a, b] = mesh.gears;
                let layout = mesh_layout(&gears[a], &gears[b]);
                layout.ok().map(|l| 1e3 * self.load * l.face_width)
            }
            _ => None,
        }
    }
}

/// The configuration with another penalty in all its meshes.
fn with_penalty(configuration: &Configuration, penalty: f64) -> Result<Configuration, SceneError> {
    let mut configuration = configuration.clone();
    let mut any = false;
    for contact in &mut configuration.modelling.contacts {
        if let Some(stiffness) = contact.flanks.penalty_mut() {
            *stiffness = penalty;
            any = true;
        }
    }
    match any {
        true => Ok(configuration),
        false => Err(SceneError::plain(
            format!("the contact of `{}` has no penalty", configuration.label),
            TAKE_POINTS,
        )),
    }
}

/// Mean static transmission error over one base pitch [m].
fn static_error(cell: &Cell<Contact>, job: &Job<'_>) -> Result<Option<f64>, StudyError> {
    let Some(force) = cell.at.load else {
        return Ok(None);
    };
    let fail = |e| StudyError::Statics(cell.configuration.label.clone(), e);
    let mut pair = LoadedPair::new(job.scene, job.modelling, &job.context.models).map_err(fail)?;
    let cycle = MeshCycle::solve(&mut pair, Load::Force(force), cell.at.positions, |_| {});
    Ok(Some(cycle.map_err(fail)?.mean_error()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_finding_names_the_stiffest_run_and_where_the_penalty_suffices() {
        let point = |i: u32| {
            let penalty = (i < 9).then(|| 1e13 * 10f64.powf(0.5 * f64::from(i)));
            let off = penalty.map(|p| -0.3 / (1.0 + p / 1e13));
            Point {
                penalty,
                failed: i == 8,
                deviations: [off, off, off.map(|x| 10.0 * x)],
            }
        };
        let rows: Vec<Point> = (0..=9).map(point).collect();
        // 0.3 / (1 + p / 1e13) is 0.01 % at 3e16, where the last run that did not fail stands; 1 % is at 2.9e14.
        let all = sentences("elastic", &rows).join(" ");
        assert!(
            all.contains("With a penalty of 3e16 Pa/m elastic differs"),
            "{all}"
        );
        assert!(all.contains("peak force by 0.0095\u{a0}%"), "{all}");
        let from =
            "the peak force from 3e14 Pa/m on and the static transmission error from 3e15 Pa/m on";
        assert!(all.contains(from), "{all}");
        let none = sentences("elastic", &rows[..9]).join(" ");
        assert!(none.contains("no run with hard contact"), "{none}");
        assert!(
            sentences("elastic", &rows[8..])
                .join("")
                .contains("No run with a penalty")
        );
    }
}
