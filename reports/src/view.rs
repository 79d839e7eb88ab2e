//! The view of a record that charts and page share: models in order of appearance, their best runs, and the reference.

use crate::metrics::Metric;
use crate::numbers::{per_cent, quantity, round_quantity};
use crate::record::{Part, ReferenceSeries, Results, Run, SELF, Study};
use crate::studies::choose::Adequacy;
use crate::studies::compare::{Kind, Yardstick};
use std::borrow::Cow;

/// A relative error below this is rounding, not a result.
pub const NOTHING: f64 = 1e-10;

/// Kind of an error against the converged solution of the run's own model, for use before the word "error".
pub const INTEGRATION: &str = "integration";

/// The runs of one model variant.
pub struct Group<'a> {
    /// Label of the model with its variant; with several scenes after the name of its scene.
    pub label: String,
    /// Label of the model with its variant, as its runs have it.
    pub model: String,
    /// Place in the order of appearance: decides colour, dash and marker everywhere.
    pub style: usize,
    /// Runs with their index among those of all scenes of the record.
    pub runs: Vec<(usize, &'a Run)>,
}

/// A record of one scene seen by the report.
pub struct View<'a> {
    pub results: &'a Results,
    /// Name of the scene, if the page has several.
    pub scene: Option<&'a str>,
    /// Index of the scene among those of the page.
    pub place: usize,
    /// Models in order of appearance.
    pub groups: Vec<Group<'a>>,
    /// Id of the reference that errors refer to.
    pub against: Option<String>,
    /// Metric of the errors in the report.
    pub metric: Metric,
    /// Greatest adequate error in that metric; `None` if the scene states no tolerance.
    pub limit: Option<f64>,
    /// Yardstick that the models of a comparison are compared with; `None` in records of other studies.
    pub yardstick: Option<Cow<'a, Yardstick>>,
}

/// Returns the yardstick of a comparison. Records of former versions do not name theirs: it is the first of their
/// references.
pub fn yardstick_of(results: &Results) -> Option<Cow<'_, Yardstick>> {
    let Part::Compare(part) = &results.part else {
        return None;
    };
    let first = || {
        let reference = results.references.first()?;
        Some(Cow::Owned(Yardstick {
            id: reference.id.clone(),
            kind: Kind::Stored,
            title: reference.title.clone(),
            ..Yardstick::default()
        }))
    };
    part.yardstick.as_ref().map(Cow::Borrowed).or_else(first)
}

impl<'a> View<'a> {
    /// Makes the view of the record of one scene, or of the first scene of several.
    pub fn new(results: &'a Results) -> Self {
        Self::of(results, None, &[])
    }

    /// Makes the views of all scenes of a record: their models have looks, and their runs indices, of their own.
    pub fn of_scenes(results: &'a Results) -> Vec<Self> {
        let mut views: Vec<Self> = Vec::with_capacity(1 + results.further.len());
        for one in results.scenes() {
            let name = (!results.further.is_empty()).then_some(one.header.scene.as_str());
            views.push(Self::of(one, name, &views));
        }
        views
    }

    fn of(results: &'a Results, scene: Option<&'a str>, before: &[Self]) -> Self {
        let models: usize = before.iter().map(|v| v.groups.len()).sum();
        let runs: usize = before.iter().map(|v| v.results.runs.len()).sum();
        let mut groups: Vec<Group<'a>> = Vec::new();
        for (index, run) in results.runs.iter().enumerate() {
            let model = run.model_label();
            match groups.iter_mut().find(|g| g.model == model) {
                Some(group) => group.runs.push((runs + index, run)),
                None => groups.push(Group {
                    label: match scene {
                        Some(scene) => format!("{scene}: {model}"),
                        None => model.clone(),
                    },
                    model,
                    style: models + groups.len(),
                    runs: vec![(runs + index, run)],
                }),
            }
        }
        let compared = |id: &str| results.runs.iter().any(|r| r.against(id).is_some());
        let yardstick = yardstick_of(results);
        let limited = results.tolerance.as_ref();
        // Models are compared with something else than themselves, where there is anything else.
        let limited = limited.filter(|t| yardstick.is_none() || t.against != SELF);
        let against = (limited.iter().map(|t| &t.against))
            .chain(yardstick.iter().map(|y| &y.id))
            .chain(results.references.iter().map(|r| &r.id))
            .find(|id| compared(id))
            .or_else(|| {
                let mut metrics = results.runs.iter().flat_map(|r| &r.metrics);
                metrics.next().map(|m| &m.against)
            })
            .cloned();
        let limited = limited.filter(|t| Some(&t.against) == against.as_ref());
        let yardstick = yardstick.filter(|y| Some(&y.id) == against.as_ref());
        let metric = match limited {
            Some(t) => t.metric,
            // Reduced and full models share mesh and start: nothing is to be shifted.
            None if results.study() == Study::Tabular => Metric::ForceL2,
            None => metric_against(
                results,
                against.as_deref().unwrap_or_default(),
                Metric::default(),
            ),
        };
        Self {
            results,
            scene,
            place: before.len(),
            groups,
            against,
            metric,
            limit: limited.map(|t| t.limit),
            yardstick,
        }
    }

    /// Returns the reference that charts show as the dark line.
    pub fn reference(&self) -> Option<&'a ReferenceSeries> {
        let all = &self.results.references;
        let id = self.against.as_deref();
        all.iter()
            .find(|r| Some(r.id.as_str()) == id)
            .or(all.first())
            .filter(|r| !r.series.is_empty())
    }

    /// Returns a view with the models of all scenes; references and tolerance are those of the first.
    pub fn joined(views: &[View<'a>]) -> Self {
        let mut joined = Self::new(views[0].results);
        let group = |g: &Group<'a>| Group {
            label: g.label.clone(),
            model: g.model.clone(),
            runs: g.runs.clone(),
            ..*g
        };
        joined.groups = (views.iter())
            .flat_map(|v| v.groups.iter().map(group))
            .collect();
        joined
    }

    /// Returns a label with the name of the scene before it, if the page has several scenes.
    pub fn with_scene(&self, label: &str) -> String {
        match self.scene {
            Some(scene) => format!("{scene}: {label}"),
            None => label.to_owned(),
        }
    }

    /// Returns the index of a run among those of all scenes of the record.
    pub fn index_of(&self, run: &Run) -> Option<usize> {
        let mut all = self.groups.iter().flat_map(|g| &g.runs);
        all.find_map(|(index, own)| std::ptr::eq(*own, run).then_some(*index))
    }

    /// Returns the name of a reference for prose and legends.
    pub fn reference_name(&self, id: &str) -> String {
        if id == SELF {
            return "the model's own converged solution".into();
        }
        match self.results.references.iter().find(|r| r.id == id) {
            Some(r) if !r.title.is_empty() => r.title.clone(),
            _ => id.to_owned(),
        }
    }

    /// Returns the magnitude of a run's error in the metric of the view.
    pub fn error(&self, run: &Run) -> Option<f64> {
        let metrics = run.against(self.against.as_deref()?)?;
        metrics
            .get(self.metric)
            .filter(|e| e.is_finite())
            .map(f64::abs)
    }

    /// True if the constants of a run were fitted to the history that its errors refer to.
    pub fn is_fitted(&self, run: &Run) -> bool {
        run.fitted_to.is_some() && run.fitted_to == self.against
    }

    /// True if errors are those of models, against something else than their own converged solutions.
    pub fn is_of_models(&self) -> bool {
        self.against.as_deref().is_some_and(|id| id != SELF)
    }

    /// True if a model is the first of its scene, which the others are compared with in cost.
    pub fn is_first(&self, group: &Group<'_>) -> bool {
        self.groups.first().is_some_and(|g| g.style == group.style)
    }

    /// Returns the kind of the error of a run that was not fitted, for use before the word "error".
    pub fn kind_of_error(&self) -> &'static str {
        match self.against.as_deref() {
            Some(SELF) => INTEGRATION,
            _ if self
                .yardstick
                .as_ref()
                .is_some_and(|y| y.kind != Kind::Stored) =>
            {
                "model"
            }
            _ => "prediction",
        }
    }

    /// Formats an error in the metric of the view, with its unit.
    pub fn error_text(&self, error: f64) -> String {
        match self.metric.unit() {
            "" if error < NOTHING => "below 1e\u{2212}8\u{a0}%".into(),
            "" => per_cent(error, 3),
            unit => quantity(error, unit, 3),
        }
    }

    /// Returns the verdict on the accuracy of a run; `None` if the scene states no tolerance or the run has no error.
    pub fn verdict(&self, run: &Run) -> Option<Adequacy> {
        if run.status.is_failure() {
            return None;
        }
        let (limit, error) = (self.limit?, self.error(run)?);
        // Without a yardstick the reference counts as exact.
        let exact = Yardstick::default();
        let yardstick = self.yardstick.as_deref().unwrap_or(&exact);
        Some(yardstick.verdict_on(run, (self.metric, error), limit))
    }

    /// True if the run is the yardstick of the comparison, or a run of the model that the yardstick comes from.
    pub fn is_yardstick(&self, run: &Run) -> bool {
        (self.yardstick.as_ref()).is_some_and(|y| {
            matches!(y.kind, Kind::Model | Kind::Named) && y.title == run.model_label()
        })
    }

    /// True if a run is adequate by the tolerance of the scene, or, without a tolerance, if its status is one that
    /// holds.
    pub fn adequate(&self, run: &Run) -> bool {
        match self.limit {
            Some(_) => self.verdict(run) == Some(Adequacy::Adequate),
            None => run.status.holds(),
        }
    }

    /// Returns the run whose cost counts as that of its model: the cheapest adequate one, else the most accurate one.
    /// All texts on the time of a model refer to this run.
    pub fn costed<'g>(&self, group: &'g Group<'a>) -> Option<&'g (usize, &'a Run)> {
        self.cheapest(group).or_else(|| self.best(group))
    }

    /// Returns the cheapest adequate run of a model.
    pub fn cheapest<'g>(&self, group: &'g Group<'a>) -> Option<&'g (usize, &'a Run)> {
        (group.runs.iter())
            .filter(|(_, r)| self.adequate(r) && r.cost_s().is_finite())
            .min_by(|a, b| a.1.cost_s().total_cmp(&b.1.cost_s()))
    }

    /// Returns the run that represents its model: the least error among runs that did not fail, and the least cost
    /// among those that share its three leading digits.
    pub fn best<'g>(&self, group: &'g Group<'a>) -> Option<&'g (usize, &'a Run)> {
        self.best_by(group, Run::cost_s)
    }

    /// Returns the run with the least error of a model; among runs that share its three leading digits the one of least
    /// `cost`.
    fn best_by<'g>(
        &self,
        group: &'g Group<'a>,
        cost: impl Fn(&Run) -> f64,
    ) -> Option<&'g (usize, &'a Run)> {
        let usable = || group.runs.iter().filter(|(_, r)| !r.status.is_failure());
        let least = usable()
            .filter_map(|(_, r)| self.error(r))
            .min_by(f64::total_cmp);
        match least {
            Some(least) => usable()
                .filter(|(_, r)| {
                    let shown = |e: f64| format!("{e:.2e}");
                    self.error(r)
                        .is_some_and(|e| shown(e) == shown(least) || e < NOTHING)
                })
                .min_by(|a, b| cost(a.1).total_cmp(&cost(b.1))),
            None => usable().min_by(|a, b| {
                let drift = |r: &Run| r.ledger.residual_rel.map_or(f64::INFINITY, f64::abs);
                drift(a.1).total_cmp(&drift(b.1))
            }),
        }
    }

    /// Returns the run whose histories charts show for a model: the best one with a series, else the longest failed
    /// one.
    pub fn drawn<'g>(&self, group: &'g Group<'a>) -> Option<&'g (usize, &'a Run)> {
        self.drawn_by(group, Run::cost_s)
    }

    /// Returns the run whose histories are written to files, as [`View::drawn`], but by work instead of time.
    pub fn stored_run<'g>(&self, group: &'g Group<'a>) -> Option<&'g (usize, &'a Run)> {
        self.drawn_by(group, |r| r.force_evaluations as f64)
    }

    fn drawn_by<'g>(
        &self,
        group: &'g Group<'a>,
        cost: impl Fn(&Run) -> f64,
    ) -> Option<&'g (usize, &'a Run)> {
        let has = |r: &Run| r.series.as_ref().is_some_and(|s| s.len() > 1);
        if let Some(best) = self.best_by(group, cost).filter(|(_, r)| has(r)) {
            return Some(best);
        }
        let mut candidates: Vec<_> = group.runs.iter().filter(|(_, r)| has(r)).collect();
        candidates.sort_by(|a, b| {
            let rank = |r: &Run| {
                (
                    r.status.is_failure(),
                    self.error(r).unwrap_or(f64::INFINITY),
                )
            };
            let (fa, ea) = rank(a.1);
            let (fb, eb) = rank(b.1);
            fa.cmp(&fb)
                .then(ea.total_cmp(&eb))
                .then(b.1.simulated_s.total_cmp(&a.1.simulated_s))
        });
        candidates.first().copied()
    }
}

/// Returns the metric of errors against a reference, where `metric` is the study's: against the model's own converged
/// solution it is the metric of integration errors, if the record has it.
pub fn metric_against(results: &Results, id: &str, metric: Metric) -> Metric {
    let own = metric.of_integration();
    let known = |r: &Run| r.against(id).is_some_and(|m| m.get(own).is_some());
    if id == SELF && results.runs.iter().any(known) {
        own
    } else {
        metric
    }
}

/// Returns the step or tolerance of a run, for labels.
pub fn resolution(run: &Run) -> String {
    match (run.step, run.rtol) {
        (Some(h), _) => format!("h\u{a0}=\u{a0}{}", round_quantity(h, "s", 3)),
        (None, Some(r)) => format!("rtol\u{a0}{}", crate::numbers::short(r, 3)),
        (None, None) => String::new(),
    }
}

/// Returns a text with its first letter in upper case.
pub fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |first| {
        first.to_uppercase().collect::<String>() + chars.as_str()
    })
}
