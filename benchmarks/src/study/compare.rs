//! The comparison: every model of a scene under every integrator, against its reference and against the
//! model's own converged solution.
//!
//! Two errors, never mixed: `against` the external reference is the model's error, `against: "self"` the
//! integrator's. The converged solution is Dormand-Prince with located events at a tolerance of 1e-10 (1e-8 where
//! that takes too long); of gears with modes it is the trigonometric method at 1e-4.

use super::machine;
use super::run::{Job, Method, RunError, run};
use super::verdict::{against_contact, against_tolerance};
use crate::models::models;
use crate::scene_file::{ModelChoice, SceneFile};
use gearbench_integrators::{METHODS, Resolution};
use gearbench_models::gear::table::Model;
use gearbench_models::scene::spec::{Modelling, SceneSpec};
use gearbench_reference::ExternalReference;
use gearbench_reports::metrics::compare as measure;
use gearbench_reports::record::{ReferenceSeries, Results, Run, Study, Tolerance};
use gearbench_reports::series::TimeSeries;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Tolerances tried for the converged solution and the time each may take; long stiff scenes get the second.
const SELF: [(f64, Duration); 2] = [
    (1e-10, Duration::from_secs(3)),
    (1e-8, Duration::from_secs(15)),
];
/// Tolerance of the converged solution of gears with modes, by the method that is exact for these.
const EXACT_MODES: f64 = 1e-4;
/// Half width of the close-up around the peak, over the duration.
const CLOSE_UP: f64 = 0.012;
/// Buckets of a history in the record.
const KEPT_BUCKETS: usize = 700;
/// Samples up to which a record keeps the further columns (travels) as well.
const FULL_COLUMNS: usize = 5000;

/// The setting that names pairs of a model and an integrator that cannot run it.
pub const LEFT_OUT: &str = "left out: needs a linear part";

/// A model of the comparison with its scene (a calibration may place the gears its own way).
#[derive(Clone, Debug)]
pub struct Entry {
    /// Name in records and on the command line.
    pub label: String,
    /// Model id of the record: that of the gears, or `mixed`.
    pub model: String,
    /// Calibration it takes its constants from.
    pub calibration: Option<String>,
    /// The scene.
    pub scene: SceneSpec,
    /// Its models.
    pub modelling: Modelling,
    /// Its integrators, where they are not those of the plan.
    pub methods: Option<Vec<Method>>,
    /// Time that others publish for such a model [s].
    pub published: Option<f64>,
}

impl Entry {
    /// A model of a scene.
    pub fn of(scene: &SceneFile, choice: &ModelChoice) -> Entry {
        Entry {
            label: choice.label.clone(),
            model: choice.model.clone(),
            calibration: choice.calibration.as_ref().map(|c| c.name.clone()),
            scene: scene.spec_for(choice),
            modelling: choice.modelling.clone(),
            methods: choice.integrators.clone(),
            published: choice.published,
        }
    }
}

/// What to compare.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// Name of the scene.
    pub name: String,
    /// One line for the reader.
    pub title: String,
    /// Command that makes the record again.
    pub command: String,
    /// Models.
    pub entries: Vec<Entry>,
    /// Integrators.
    pub methods: Vec<Method>,
    /// Table of models.
    pub models: &'a [Model],
    /// End [s].
    pub duration: f64,
    /// Samples of the histories over the duration.
    pub samples: usize,
    /// External reference.
    pub reference: Option<ReferenceSeries>,
    /// Label of an entry whose first run is a further reference.
    pub reference_model: Option<String>,
    /// Source of published times.
    pub published: Option<String>,
    /// What the scene calls accurate enough.
    pub tolerance: Option<Tolerance>,
    /// Settings to show.
    pub settings: Vec<(String, String)>,
    /// Timed repeats.
    pub repeats: u32,
    /// Locate events.
    pub events: bool,
    /// Wall-clock bound of one integration.
    pub timeout: Duration,
}

impl Plan<'_> {
    /// The comparison of some models of a scene as the scene describes it: one timed repeat, a minute per run.
    pub fn of(
        scene: &SceneFile,
        choices: &[&ModelChoice],
        reference: Option<&ExternalReference>,
    ) -> Plan<'static> {
        Plan {
            name: scene.name.clone(),
            title: scene.title.clone(),
            command: String::new(),
            entries: choices.iter().map(|c| Entry::of(scene, c)).collect(),
            methods: scene.study.integrators.clone(),
            models: models(),
            duration: scene.duration,
            samples: scene.study.samples,
            reference: reference.map(external),
            reference_model: scene.study.reference_model.clone(),
            published: scene.study.published.clone(),
            tolerance: scene.tolerance.clone(),
            settings: Vec::new(),
            repeats: 1,
            events: scene.study.events,
            timeout: Duration::from_secs(60),
        }
    }

    /// The same under other integrators, for all models.
    #[must_use]
    pub fn with_methods(mut self, methods: Vec<Method>) -> Self {
        for entry in &mut self.entries {
            entry.methods = None;
        }
        self.methods = methods;
        self
    }

    /// Number of runs.
    pub fn len(&self) -> usize {
        self.entries.iter().map(|e| self.methods_of(e).len()).sum()
    }

    fn methods_of<'p>(&'p self, entry: &'p Entry) -> &'p [Method] {
        entry.methods.as_deref().unwrap_or(&self.methods)
    }

    /// True when there is nothing to run.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Times to record at: those of the reference, and an even grid.
    fn grid(&self) -> Vec<f64> {
        let n = self.samples.max(2) - 1;
        let mut grid: Vec<f64> = (0..=n)
            .map(|i| self.duration * i as f64 / n as f64)
            .collect();
        if let Some(r) = &self.reference {
            let last = r.series.time_s.last().copied().unwrap_or(0.0);
            grid.retain(|&t| t > last);
            let own = r
                .series
                .time_s
                .iter()
                .copied()
                .filter(|&t| t <= self.duration);
            let mut all: Vec<f64> = own.collect();
            all.append(&mut grid);
            grid = all;
        }
        grid
    }
}

/// The history of an external reference as records keep it.
pub fn external(r: &ExternalReference) -> ReferenceSeries {
    let h = &r.history;
    ReferenceSeries {
        // Records name the program; the title and source say which case.
        id: r.id.split('/').next().unwrap_or(r.id).to_string(),
        title: r.title.split(", impact").next().unwrap_or(r.title).to_string(),
        source: format!("{} ({})", r.title, r.id),
        note: "first-order bricks, faceted flanks: judge models against this discretisation, it is not converged physics"
            .into(),
        command: Some(r.regenerate.to_string()),
        cpu_s: Some(r.summary.cpu_s),
        series: TimeSeries {
            time_s: h.time.clone(),
            contact_force_n: h.contact_force.clone(),
            omega1_rad_s: h.omega1_mean.clone(),
            omega2_rad_s: h.omega2_mean.clone(),
            columns: Vec::new(),
        },
    }
}

/// Runs the comparison. `progress` is told the number of runs done and the name of the next.
pub fn compare(
    plan: &Plan<'_>,
    cancel: Option<&AtomicBool>,
    mut progress: impl FnMut(usize, &str),
) -> Result<Results, RunError> {
    let grid = plan.grid();
    let tight = tight();
    let exact_modes = SELF.map(|(_, timeout)| (exact_for_modes(EXACT_MODES), timeout));
    let mut runs = Vec::with_capacity(plan.len());
    let mut left_out = Vec::new();
    let mut references: Vec<ReferenceSeries> = plan.reference.iter().cloned().collect();
    // The model that is a reference runs first, and keeps its place in the record.
    let is_reference = |e: &Entry| plan.reference_model.as_deref() == Some(e.label.as_str());
    let mut order: Vec<usize> = (0..plan.entries.len()).collect();
    order.sort_by_key(|&i| !is_reference(&plan.entries[i]));
    let mut by_entry: Vec<Vec<Run>> = vec![Vec::new(); plan.entries.len()];
    for i in order {
        let entry = &plan.entries[i];
        let done: usize = by_entry.iter().map(Vec::len).sum();
        let runs = &mut by_entry[i];
        let job = |method| Job {
            scene: &entry.scene,
            modelling: &entry.modelling,
            models: plan.models,
            method,
            t_end: plan.duration,
            grid: &grid,
            also_steps: true,
            forces: false,
            events: plan.events,
            repeats: plan.repeats,
            timeout: plan.timeout,
            max_steps: u64::MAX,
            cancel,
        };
        let mut own: Option<Option<TimeSeries>> = None;
        let mut pictured = false;
        for method in plan.methods_of(entry) {
            progress(
                done + runs.len(),
                &format!("{}, {}", entry.label, method.text),
            );
            let mut row = match run(&job(method)) {
                // Not every method is for every model; the record says which pairs it has not.
                Err(RunError::NoLinearPart(id)) if plan.len() > 1 => {
                    left_out.push((LEFT_OUT.into(), format!("{} under {id}", entry.label)));
                    continue;
                }
                other => other?,
            };
            row.model.clone_from(&entry.model);
            row.variant = variant(entry);
            row.calibration.clone_from(&entry.calibration);
            row.published_s = entry.published;
            // The first run says how large the model is.
            let own = match &mut own {
                Some(own) => own,
                none => {
                    progress(
                        done + runs.len(),
                        &format!("{}, converged solution", entry.label),
                    );
                    none.insert(if row.modes.is_some() {
                        converged(&job, &exact_modes)?
                    } else if row.dofs <= SMALL {
                        converged(&job, &tight)?
                    } else {
                        None
                    })
                }
            };
            measure_against(&mut row, plan, &references, own.as_ref());
            if is_reference(entry)
                && runs.is_empty()
                && !row.status.is_failure()
                && let Some(series) = &row.series
            {
                references.insert(0, reference_of(entry, &row, series));
            }
            // Outlines are the same for every integrator: one picture per model is enough.
            if pictured || row.status.is_failure() {
                row.contacts = None;
            } else {
                pictured = row.contacts.is_some();
            }
            row.series = row.series.map(|s| thin(&s));
            runs.push(row);
        }
    }
    runs.extend(by_entry.into_iter().flatten());
    if runs.is_empty()
        && let Some((_, pair)) = left_out.first()
    {
        let id = pair.rsplit(' ').next().unwrap_or(pair);
        return Err(RunError::NoLinearPart(id.into()));
    }
    progress(runs.len(), "report");
    Ok(Results {
        scene: plan.name.clone(),
        title: plan.title.clone(),
        study: Study::Compare,
        command: plan.command.clone(),
        machine: machine::machine(),
        commit: machine::COMMIT.into(),
        created: machine::now(),
        settings: [plan.settings.clone(), left_out].concat(),
        tolerance: plan.tolerance.clone(),
        references,
        published: plan.published.clone(),
        runs,
        ..Results::default()
    })
}

/// How converged solutions of gears without modes are computed, the best first, with the time each may take.
pub(super) fn tight() -> [(Method, Duration); 2] {
    SELF.map(|(rtol, timeout)| {
        let method = Method {
            text: "dopri5".into(),
            resolution: Resolution::Tolerance(rtol),
        };
        (method, timeout)
    })
}

/// The method that is exact for modes, under a tolerance.
pub(super) fn exact_for_modes(rtol: f64) -> Method {
    Method {
        text: "trigonometric".into(),
        resolution: Resolution::Tolerance(rtol),
    }
}

/// Coordinates up to which a converged solution is computed: beyond, it costs more than all the runs.
pub(super) const SMALL: usize = 2000;

/// The model's own converged solution by the first of these methods that reaches the end in its time; `None` when it
/// is not to be had in reasonable time.
pub(super) fn converged<'a>(
    job: &impl Fn(&'a Method) -> Job<'a>,
    tight: &'a [(Method, Duration)],
) -> Result<Option<TimeSeries>, RunError> {
    for (method, timeout) in tight {
        let row = run(&Job {
            repeats: 0,
            timeout: *timeout,
            events: true,
            ..job(method)
        })?;
        if !row.status.is_failure() {
            return Ok(row.series);
        }
    }
    Ok(None)
}

/// What sets an entry apart from others of its model: its label, without the model's id in front.
pub(super) fn variant(entry: &Entry) -> Option<String> {
    (entry.label != entry.model).then(|| {
        let rest = entry
            .label
            .strip_prefix(&entry.model)
            .and_then(|r| r.strip_prefix('-'));
        rest.unwrap_or(&entry.label).to_string()
    })
}

/// What the report calls the runs of an entry.
pub(super) fn model_label(entry: &Entry) -> String {
    Run {
        model: entry.model.clone(),
        variant: variant(entry),
        ..Run::default()
    }
    .model_label()
}

/// A history fit for the record: peaks stay, and the surroundings of the highest one stay whole.
pub(super) fn thin(series: &TimeSeries) -> TimeSeries {
    let force = &series.contact_force_n;
    let peak = (0..force.len()).max_by(|&a, &b| force[a].total_cmp(&force[b]));
    let at = peak.map_or(0.0, |i| series.time_s[i]);
    let half = CLOSE_UP * series.time_s.last().copied().unwrap_or(0.0);
    let mut thin = series.thinned_around(KEPT_BUCKETS, [at - half, at + half]);
    if thin.len() > FULL_COLUMNS {
        thin.columns.clear();
    }
    thin
}

/// The run of an entry as a reference for others.
fn reference_of(entry: &Entry, row: &Run, series: &TimeSeries) -> ReferenceSeries {
    ReferenceSeries {
        id: entry.label.clone(),
        title: format!("{}, {}", model_label(entry), row.integrator),
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
    plan: &Plan<'_>,
    references: &[ReferenceSeries],
    converged: Option<&TimeSeries>,
) {
    let Some(series) = &row.series else { return };
    for reference in references {
        row.metrics.push(measure(
            series,
            &row.ledger,
            &reference.series,
            &reference.id,
        ));
    }
    if let Some(own) = converged {
        row.metrics.push(measure(series, &row.ledger, own, "self"));
    }
    if let Some(own) = converged {
        against_contact(row, own);
    }
    if let Some(t) = &plan.tolerance {
        against_tolerance(row, t);
    }
}

/// Integrators asked for on the command line: `id`, `id(name=value)`, each optionally followed by `@` and a step with
/// its unit (`500ns`, `1us`, `2e-7s`) or a bare number, which is a step in seconds for methods of fixed steps and a
/// tolerance for adaptive ones. Without `@` the scene's own resolution for that method is taken, or that of its
/// nearest kin.
pub fn methods_from(text: &str, scene: &[Method]) -> Result<Vec<Method>, String> {
    let mut found = Vec::new();
    for part in split_outside_brackets(text) {
        let (name, resolution) = match part.split_once('@') {
            Some((name, value)) => {
                let x = Value::parse(value)
                    .ok_or_else(|| format!("`{part}`: `{value}` after @ is not a number"))?;
                (name.trim(), Some(x))
            }
            None => (part, None),
        };
        let (row, _) = gearbench_integrators::method(name)?;
        let adaptive = |r: &Resolution| matches!(r, Resolution::Tolerance(_));
        use gearbench_integrators::Stepping;
        let resolution = match resolution {
            Some(Value::Time(x) | Value::Bare(x)) if !(x > 0.0 && x.is_finite()) => {
                return Err(format!("`{part}`: a step or tolerance must be positive"));
            }
            Some(Value::Time(_)) if row.info.stepping == Stepping::Adaptive => {
                return Err(format!(
                    "`{part}`: {} chooses its steps; give a tolerance, for example {name}@1e-6",
                    row.info.id
                ));
            }
            Some(Value::Time(x)) => Resolution::Step(x),
            // Of a method that can do both a bare number is the tolerance.
            Some(Value::Bare(x)) => match row.info.stepping {
                Stepping::Fixed => Resolution::Step(x),
                Stepping::Adaptive | Stepping::Both if x < 1.0 => Resolution::Tolerance(x),
                Stepping::Adaptive | Stepping::Both => {
                    return Err(format!(
                        "`{part}`: a tolerance is less than 1; a step has a unit, as in @1us"
                    ));
                }
            },
            None => scene
                .iter()
                .find(|m| m.text == name)
                .or_else(|| scene.iter().find(|m| id_of(&m.text) == row.info.id))
                .map(|m| m.resolution)
                .or_else(|| {
                    let fixed = row.info.stepping == Stepping::Fixed;
                    scene
                        .iter()
                        .map(|m| m.resolution)
                        .find(|r| adaptive(r) != fixed)
                })
                .unwrap_or(match row.info.stepping {
                    Stepping::Fixed => Resolution::Step(1e-6),
                    _ => Resolution::Tolerance(1e-6),
                }),
        };
        found.push(Method {
            text: name.to_string(),
            resolution,
        });
    }
    if found.is_empty() {
        let known: Vec<&str> = METHODS.iter().map(|m| m.info.id).collect();
        return Err(format!(
            "no integrator named; there are {}",
            known.join(", ")
        ));
    }
    Ok(found)
}

/// What stands after an `@`.
enum Value {
    /// A number with a unit of time, in seconds.
    Time(f64),
    /// A number.
    Bare(f64),
}

impl Value {
    fn parse(text: &str) -> Option<Value> {
        let text = text.trim();
        match text.parse() {
            Ok(x) => Some(Value::Bare(x)),
            Err(_) => seconds(text).map(Value::Time),
        }
    }
}

/// A time with its unit: `500ns`, `1us`, `0.5 ms`, `2e-7s` [s].
pub fn seconds(text: &str) -> Option<f64> {
    const UNITS: [(&str, f64); 6] = [
        ("ns", 1e-9),
        ("us", 1e-6),
        ("\u{b5}s", 1e-6),
        ("\u{3bc}s", 1e-6),
        ("ms", 1e-3),
        ("s", 1.0),
    ];
    UNITS.iter().find_map(|(unit, factor)| {
        let number = text.trim().strip_suffix(unit)?.trim_end();
        Some(factor * number.parse::<f64>().ok()?)
    })
}

fn id_of(text: &str) -> &str {
    text.split('(').next().unwrap_or(text).trim()
}

/// Splits at commas that are not inside brackets.
pub(super) fn split_outside_brackets(text: &str) -> Vec<&str> {
    let (mut parts, mut start, mut depth) = (Vec::new(), 0, 0i32);
    for (i, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(text[start..i].trim());
                start = i + 1;
            }
            _ => {}
        }
    }
    parts.push(text[start..].trim());
    parts.retain(|p| !p.is_empty());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> Vec<Method> {
        vec![
            Method {
                text: "rk4".into(),
                resolution: Resolution::Step(2e-6),
            },
            Method {
                text: "dopri5".into(),
                resolution: Resolution::Tolerance(1e-5),
            },
        ]
    }

    #[test]
    fn integrators_from_the_command_line() {
        let m = methods_from(
            "rk4, generalised-alpha(rho_inf=0.5), dopri5@1e-8,hht-alpha@1e-7",
            &scene(),
        )
        .unwrap();
        let want = [
            ("rk4", Resolution::Step(2e-6)),
            ("generalised-alpha(rho_inf=0.5)", Resolution::Step(2e-6)),
            ("dopri5", Resolution::Tolerance(1e-8)),
            ("hht-alpha", Resolution::Step(1e-7)),
        ];
        for (got, (text, resolution)) in m.iter().zip(want) {
            assert_eq!((got.text.as_str(), got.resolution), (text, resolution));
        }
    }

    #[test]
    fn a_unit_makes_it_a_step() {
        let m = methods_from(
            "trigonometric@1us,dopri5@2e-7s, rk4@500ns,hht-alpha@0.5 \u{b5}s,trigonometric@1e-4,bdf@1e-6",
            &scene(),
        )
        .unwrap();
        let want = [
            Resolution::Step(1e-6),
            Resolution::Step(2e-7),
            Resolution::Step(500.0 * 1e-9),
            Resolution::Step(0.5 * 1e-6),
            Resolution::Tolerance(1e-4),
            Resolution::Tolerance(1e-6),
        ];
        assert_eq!(m.iter().map(|m| m.resolution).collect::<Vec<_>>(), want);
        for (text, says) in [
            ("bdf@1us", "chooses its steps"),
            ("rk4@-1us", "positive"),
            ("dopri5@2", "less than 1"),
            ("rk4@1 furlong", "not a number"),
            ("rk4@us", "not a number"),
            ("rk4@infs", "positive"),
        ] {
            let e = methods_from(text, &scene()).unwrap_err();
            assert!(e.contains(says), "{text}: {e}");
        }
    }

    #[test]
    fn refusals_say_what_there_is() {
        assert!(methods_from("rk5", &scene()).unwrap_err().contains("rk4"));
        assert!(
            methods_from("rk4@-1", &scene())
                .unwrap_err()
                .contains("positive")
        );
        assert!(
            methods_from("rk4@x", &scene())
                .unwrap_err()
                .contains("not a number")
        );
        assert!(methods_from(",", &scene()).unwrap_err().contains("dopri5"));
    }
}
