//! Results of the study: fronts of error and cost, the cheapest runs within limits of the error, charts and finding.

use super::arguments::Precision;
use super::converged::short_of;
use crate::studies::tabular::Measured;

use gearbench_reports::columns::Columns;
use gearbench_reports::comparison::{Kind, Yardstick};
use gearbench_reports::numbers::{counted, limit, per_cent, quantity, round_quantity, short};
use gearbench_reports::pareto::{Point, cheapest, front};
use gearbench_reports::record::{Run, SELF};
use gearbench_reports::tabular::{
    AGAINST, FrontPanel, MODEL, SummaryTable, TableChart, TableFront, TableRow,
};
use gearbench_reports::{Adequacy, Format, Metric, NOTHING, capital};

/// Limits of the error at which models are compared.
const LEVELS: [f64; 4] = [0.05, 0.02, 0.01, 0.005];
/// The limits that the finding names; the table has all.
const NAMED: [f64; 2] = [LEVELS[0], LEVELS[2]];

type Row<'a> = &'a Measured<Precision>;

/// Returns the ids of the references of some rows, without their own converged solutions.
pub(super) fn references_of(rows: &[Row<'_>]) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for m in rows.iter().flat_map(|r| &r.run.metrics) {
        if m.against != SELF && !all.contains(&m.against) {
            all.push(m.against.clone());
        }
    }
    all
}

/// Returns the labels of the models of some rows.
fn models_of(rows: &[Row<'_>]) -> Vec<String> {
    let mut all: Vec<String> = rows.iter().map(|r| r.run.model_label()).collect();
    let mut known = std::collections::HashSet::new();
    all.retain(|label| known.insert(label.clone()));
    all
}

/// Returns the metric of errors against a reference: integration errors have a metric of their own.
pub(super) fn headline_against(rows: &[Row<'_>], id: &str, metric: Metric) -> Metric {
    let own = metric.of_integration();
    let known = |r: &Row<'_>| r.run.against(id).is_some_and(|m| m.get(own).is_some());
    if id == SELF && rows.iter().any(known) {
        own
    } else {
        metric
    }
}

/// Returns cost and error of a run; `None` of a failed one, and of one without error.
fn point(row: Row<'_>, id: &str, metric: Metric) -> Option<Point> {
    let ended = (!row.run.status.is_failure()).then_some(&row.run)?;
    let error = ended.against(id)?.get(metric)?.abs();
    let cost = ended.cost_s();
    let point = Point { cost, error };
    (point.is_sound() && error > NOTHING).then_some(point)
}

/// Returns the indices of the selected rows on their front, ascending in cost.
fn front_of(
    rows: &[Row<'_>],
    (id, metric): (&str, Metric),
    has: impl Fn(Row<'_>) -> bool,
) -> Vec<usize> {
    let all = rows.iter().enumerate().filter(|(_, row)| has(row));
    let (places, points): (Vec<usize>, Vec<Point>) =
        (all.filter_map(|(i, row)| Some((i, point(row, id, metric)?)))).unzip();
    front(&points).into_iter().map(|k| places[k]).collect()
}

/// Returns the indices of the rows on the front against a reference; of the own converged solution each model has one.
pub(super) fn fronts(rows: &[Row<'_>], id: &str, metric: Metric) -> Vec<usize> {
    if id != SELF {
        return front_of(rows, (id, metric), |_| true);
    }
    let of = |label: String| front_of(rows, (id, metric), |row| row.run.model_label() == label);
    models_of(rows).into_iter().flat_map(of).collect()
}

fn is_fitted(row: Row<'_>) -> bool {
    row.run.fitted_to.is_some()
}

/// Returns number of modes, and step or tolerance of a run.
fn modes_and_step(run: &Run) -> String {
    let resolution = match (run.step, run.rtol) {
        (Some(h), _) => round_quantity(h, "s", 3),
        (None, Some(rtol)) => format!("rtol\u{a0}{}", short(rtol, 3)),
        (None, None) => String::new(),
    };
    match run.modes {
        Some(n) => format!("{n}\u{a0}modes, {resolution}"),
        None => resolution,
    }
}

/// A reference that runs are compared with, in the metric of their errors.
struct Against<'a> {
    id: &'a str,
    metric: Metric,
    /// The reference with its own error; one that the study computes is taken as exact.
    yardstick: Yardstick,
}

impl Against<'_> {
    /// Returns the cheapest of selected rows within a limit; runs that are so by chance are not.
    fn cheapest<'r>(
        &self,
        rows: &[Row<'r>],
        limit: f64,
        has: impl Fn(Row<'_>) -> bool,
    ) -> Option<Row<'r>> {
        let error = |row: Row<'_>| point(row, self.id, self.metric);
        let all = rows.iter().filter(|row| has(row));
        let within = |(row, point): &(Row<'_>, Point)| {
            let error = (self.metric, point.error);
            self.yardstick.verdict_on(&row.run, error, limit) == Adequacy::Adequate
        };
        let all = all.filter_map(|row| Some((*row, error(row)?)));
        let (kept, points): (Vec<Row<'r>>, Vec<Point>) = all.filter(within).unzip();
        cheapest(&points, limit).map(|i| kept[i])
    }

    /// Returns the number of runs that are within a limit by chance.
    fn by_chance(&self, rows: &[Row<'_>], limit: f64) -> usize {
        let is_within = |row: &&Row<'_>| {
            point(row, self.id, self.metric)
                .is_some_and(|p| self.yardstick.verdict(p.error, limit) == Adequacy::Adequate)
        };
        let all = rows.iter().filter(|row| !is_fitted(row)).filter(is_within);
        all.filter(|row| row.run.agrees_by_chance(self.metric, limit))
            .count()
    }

    /// Returns the clause on the own error, behind the name of the reference; a run of the study is taken as exact.
    fn own_error(&self) -> String {
        match (self.yardstick.kind, self.yardstick.error) {
            (Kind::Named, _) => String::new(),
            (_, Some(e)) => format!(", whose own error is stated as {},", per_cent(e, 2)),
            (_, None) => ", whose own error is not stated,".into(),
        }
    }
}

impl Precision {
    /// The metric that the study is about.
    pub(super) fn headline(&self) -> Metric {
        self.plan.metrics.first().copied().unwrap_or_default()
    }

    /// The reference with an id.
    fn reference<'a>(&self, id: &'a str, metric: Metric) -> Against<'a> {
        let external = self.plan.external.iter().find(|e| e.id == id);
        Against {
            id,
            metric,
            yardstick: Yardstick {
                kind: external.map_or(Kind::Named, |_| Kind::Stored),
                error: external.and_then(|e| e.own_error),
                ..Yardstick::default()
            },
        }
    }

    /// Ids of the references with errors and the metric of each; the own converged solutions alone if there is no other.
    fn compared_with(&self, rows: &[Row<'_>]) -> Vec<(String, Metric)> {
        let has_point = |id: &String| rows.iter().any(|r| point(r, id, self.headline()).is_some());
        let mut ids = references_of(rows);
        ids.retain(has_point);
        if ids.is_empty() {
            ids.push(SELF.into());
        }
        let of = |id: String| {
            let metric = headline_against(rows, &id, self.headline());
            (id, metric)
        };
        ids.into_iter().map(of).collect()
    }

    /// Tables of the Pareto front and of the cheapest run of each model against each reference.
    #[rustfmt::skip]
    pub(super) fn tables(&self, rows: &[Row<'_>]) -> Vec<SummaryTable> {
        let mut all = Vec::new();
        for (id, metric) in self.compared_with(rows) {
            let id = id.as_str();
            let fair = front_of(rows, (id, metric), |row| !is_fitted(row));
            let mut on_front = fronts(rows, id, metric);
            if id != SELF {
                on_front.extend(fair.iter().filter(|i| !on_front.contains(i)).copied().collect::<Vec<_>>());
                on_front.sort_by(|a, b| rows[*a].run.cost_s().total_cmp(&rows[*b].run.cost_s()));
            }
            if on_front.is_empty() {
                continue;
            }
            let is_fair = |i: &usize| rows[*i].run.fitted_to.is_none() && fair.contains(i);
            let any_fitted = on_front.iter().any(|i| is_fitted(rows[*i]));
            let columns = Columns::<usize>::of("", "")
                .model(|i| rows[*i].run.model_label())
                .integrator(|i| rows[*i].run.integrator.clone()).shown("Integrator", Format::Text).result()
                .add("resolution", "modes, and step or tolerance", |i| modes_and_step(&rows[*i].run)).shown("Resolution", Format::Text).result()
                .add("error", metric.meaning(), |i| point(rows[*i], id, metric).map(|p| p.error)).shown("Error", Format::Percents(3)).result()
                .add("integration_error", "error of integration", |i| if id == SELF { None } else { rows[*i].run.integration_error(metric) }).shown("Error of integration", Format::Percents(2)).result()
                .add("cpu_s", "processor time", |i| rows[*i].run.cost_s()).shown("Processor time", Format::Quantities(3)).result()
                .add("fitted_to", "reference of the fit", |i| rows[*i].run.fitted_to.clone()).shown("Fitted to", Format::Text).result()
                .add("fair", "on the front without fitted models", |i| (any_fitted && is_fair(i)).then_some("\u{2713}")).shown("Front, nothing fitted", Format::Text).result()
                .add("steps", "accepted steps", |i| rows[*i].run.steps).shown("Steps", Format::Counts)
                .add("force_evaluations", "evaluations of the contact forces", |i| rows[*i].run.force_evaluations).shown("Force evaluations", Format::Counts)
                .add("factorisations", "factorisations of the Newton matrix", |i| rows[*i].run.factorisations).shown("Factorisations", Format::Counts);
            let remark = format!("Runs that no other {} beats in processor time and in {} at once.", if id == SELF { "of their model" } else { "run" }, metric.words());
            all.push(SummaryTable::of(&format!("Pareto front against {id}, {}", metric.words()), &columns, &on_front, &remark));
            if id == SELF {
                continue;
            }
            let against = &self.reference(id, metric);
            let labels: Vec<String> = models_of(rows).into_iter().filter(|label| rows.iter().any(|r| r.run.model_label() == *label && point(r, id, metric).is_some())).collect();
            let mut columns = Columns::<String>::of("", "")
                .model(|label| label.clone());
            for level in LEVELS {
                let cell = move |label: &String| {
                    let row = against.cheapest(rows, level, |r| r.run.model_label() == *label)?;
                    Some(format!("{} ({}, {})", quantity(row.run.cost_s(), "s", 2), row.run.integrator, modes_and_step(&row.run)))
                };
                columns = columns.add(format!("within_{level}"), "cheapest run within a limit", cell).shown(&format!("Within {}", limit(level)), Format::Text).result();
            }
            let least = |label: &String| {
                let own = rows.iter().filter(|r| r.run.model_label() == *label);
                let errors = own.filter_map(|r| Some((point(r, id, metric)?.error, r.run.integration_error(metric))));
                errors.filter(|(error, own)| own.is_none_or(|own| own <= *error)).map(|(error, _)| error).min_by(f64::total_cmp)
            };
            let columns = columns.add("least", "least error of the runs whose error of integration is no larger", least).shown("Least error", Format::Percents(3)).result();
            let remark = format!(
                "Least processor time among the runs within the limit; a dash: none is. A run is within it if its error{} and its error of \
                 integration are; the least error is that of the runs whose error of integration is no larger. A model that was fitted to this history is not predicted by it: its error is the rest of the fit.",
                against.yardstick.error.map_or_else(String::new, |e| format!(", with the own error of the reference of {},", per_cent(e, 2)))
            );
            all.push(SummaryTable::of(&format!("Cheapest run of each model against {id}"), &columns, &labels, &remark));
        }
        all
    }

    pub(super) fn charts_of(&self, rows: &[Row<'_>]) -> Vec<TableChart> {
        let compared = self.compared_with(rows);
        let first = &compared[0];
        let all_rows = |id: &str| FrontPanel {
            title: String::new(),
            rows: TableRow::of([(AGAINST.into(), id.into())]),
        };
        let chart = |file: String, (id, metric): (&str, Metric), abscissa: &str| {
            let over = match abscissa {
                "cpu_s" => "processor time",
                _ => "force evaluations, which a noisy machine does not change",
            };
            TableChart {
                file,
                title: format!("{} against {id}", capital(metric.words())),
                caption: format!(
                    "{} over {over}. Every point is a run; those on the front are strong and named, those that another beats in both are \
                     faint. The full staircase is the front of models with nothing fitted. Failed runs stand as crosses above.",
                    capital(metric.words())
                ),
                abscissa: abscissa.into(),
                ordinates: vec![metric.key().into()],
                front: Some(TableFront {
                    panels: vec![all_rows(id)],
                    named_by: ["integrator", "modes", "step_s", "rtol"]
                        .map(String::from)
                        .to_vec(),
                    // Constants are fitted to references, not to converged solutions.
                    without: if id == SELF { "" } else { "fitted_to" }.into(),
                    ..TableFront::default()
                }),
                ..TableChart::default()
            }
        };
        let joined = |chart: TableChart, title: &str, caption: String, panels: Vec<FrontPanel>| {
            let front = chart.front.map(|front| TableFront {
                panels,
                joined_by: "integrator".into(),
                ..front
            });
            TableChart {
                title: title.into(),
                caption,
                front,
                ..chart
            }
        };
        let mut charts = Vec::new();
        for (k, (id, metric)) in compared.iter().filter(|c| c.0 != SELF).enumerate() {
            charts.push(chart(numbered("model", k), (id, *metric), "cpu_s"));
        }
        let own = headline_against(rows, SELF, self.headline());
        let panels = panels_of_models(rows, own);
        if !panels.is_empty() {
            let caption = format!(
                "{} against each model's own converged solution: the error of integration alone, without that of the model. An elastic \
                 model has the number of modes with which most integrators ran. Lines join the front of an integrator.",
                capital(own.words())
            );
            let chart = chart("precision_integration".into(), (SELF, own), "cpu_s");
            let title = "Error of integration by model, over processor time";
            charts.push(joined(chart, title, caption, panels));
        }
        if first.0 != SELF {
            let (id, metric) = (first.0.as_str(), first.1);
            let caption = "The runs of each model under each integrator that no other run of the two beats: where a line ends, finer \
                           steps buy nothing more from the model."
                .to_owned();
            let best = chart("precision_families".into(), (id, metric), "cpu_s");
            let title = format!("The best of each model and integrator against {id}");
            charts.push(joined(best, &title, caption, vec![all_rows(id)]));
        }
        let (id, metric) = (first.0.as_str(), first.1);
        charts.push(chart(
            "precision_work".into(),
            (id, metric),
            "force_evaluations",
        ));
        if id != SELF {
            for (k, further) in self.plan.metrics.iter().enumerate().skip(1) {
                charts.push(chart(numbered("metric", k), (id, *further), "cpu_s"));
            }
        }
        charts
    }

    pub(super) fn sentences(&self, rows: &[Row<'_>]) -> Vec<String> {
        let compared = self.compared_with(rows);
        let (id, metric) = (compared[0].0.as_str(), compared[0].1);
        let failed = rows.iter().filter(|r| r.run.status.is_failure()).count();
        let failed = format!("{failed} of {} failed", counted(rows.len(), "run", "runs"));
        let mut sentences = Vec::new();
        if id == SELF {
            sentences.push("No run is compared with a reference: errors are those of integration, against each model's own converged solution.".to_owned());
        } else {
            let any_fitted = rows
                .iter()
                .any(|r| is_fitted(r) && point(r, id, metric).is_some());
            let against = self.reference(id, metric);
            let cheapest = |level: f64| {
                if against.yardstick.error.is_some_and(|own| own >= level) {
                    return format!("within {} nothing is decided", limit(level));
                }
                match against.cheapest(rows, level, |r| !is_fitted(r)) {
                    Some(r) => format!(
                        "within {} {} under {} ({}, {})",
                        limit(level),
                        r.run.model_label(),
                        r.run.integrator,
                        modes_and_step(&r.run),
                        quantity(r.run.cost_s(), "s", 2)
                    ),
                    None => format!("within {} nothing", limit(level)),
                }
            };
            sentences.push(format!(
                "Cheapest against {id}{} by {}{}: {}.",
                against.own_error(),
                metric.words(),
                if any_fitted {
                    ", among what was not fitted to it"
                } else {
                    ""
                },
                NAMED.map(cheapest).join("; ")
            ));
            let by_chance = NAMED.map(|level| (against.by_chance(rows, level), level));
            if let Some((n, level)) = by_chance.into_iter().rfind(|(n, _)| *n > 0) {
                let (runs, errors, they) = match n {
                    1 => (
                        "One run is".to_owned(),
                        "its error of integration is",
                        "It is",
                    ),
                    n => (
                        format!("{n} runs are"),
                        "their errors of integration are",
                        "They are",
                    ),
                };
                sentences.push(format!(
                    "{runs} closer to {id} than {} although {errors} larger: steps like those of the reference, or errors that cancel. \
                     {they} not counted.",
                    limit(level),
                ));
            }
            sentences.extend(fits(rows, (id, metric)));
        }
        let mut coarse: Vec<String> = Vec::new();
        for row in rows {
            let modes = row
                .run
                .modes
                .map_or_else(String::new, |n| format!(", {n} modes"));
            let by = row.run.own_solution.as_ref().and_then(short_of);
            let text = by.map(|by| format!("{}{modes} ({by})", row.run.model_label()));
            coarse.extend(text.filter(|text| !coarse.contains(text)));
        }
        if !coarse.is_empty() {
            sentences.push(format!(
                "Converged solutions are coarser than they should be: {}; the integration error is unknown for runs that are not ten times coarser.",
                coarse.join("; ")
            ));
        }
        sentences.push(match compared.len() - 1 {
            0 => format!("{failed}."),
            n => format!(
                "Other limits and {} stand in the tables; {failed}.",
                counted(n, "further reference", "further references")
            ),
        });
        sentences
    }
}

/// Returns the name of a chart of which there may be several.
fn numbered(what: &str, place: usize) -> String {
    match place {
        0 => format!("precision_{what}"),
        _ => format!("precision_{what}_{}", place + 1),
    }
}

/// A panel for each model with errors of integration, of an elastic model with the number of modes with which most
/// integrators ran.
fn panels_of_models(rows: &[Row<'_>], metric: Metric) -> Vec<FrontPanel> {
    let mut panels = Vec::new();
    for label in models_of(rows) {
        let own = rows.iter().filter(|r| r.run.model_label() == label);
        let own: Vec<&Run> = (own.filter(|r| point(r, SELF, metric).is_some()))
            .map(|r| &r.run)
            .collect();
        let integrators = |modes: Option<usize>| {
            let all = own.iter().filter(|r| r.modes == modes);
            let mut all: Vec<&str> = all.map(|r| r.integrator.as_str()).collect();
            all.sort_unstable();
            all.dedup();
            all.len()
        };
        let busiest = own.iter().map(|r| (integrators(r.modes), r.modes)).max();
        let Some((_, modes)) = busiest else { continue };
        if own.iter().filter(|r| r.modes == modes).count() < 2 {
            continue;
        }
        let mut of: Vec<(String, gearbench_reports::columns::Value)> = vec![
            (AGAINST.into(), SELF.into()),
            (MODEL.into(), label.as_str().into()),
        ];
        of.extend(modes.map(|n| ("modes".to_owned(), n.into())));
        panels.push(FrontPanel {
            title: match modes {
                Some(n) => format!("{label}, {n} modes"),
                None => label,
            },
            rows: TableRow::of(of),
        });
    }
    panels
}

/// Returns the sentence on models that were fitted to the reference; `None` if none is on the front.
fn fits(rows: &[Row<'_>], (id, metric): (&str, Metric)) -> Option<String> {
    let own = front_of(rows, (id, metric), is_fitted);
    let errors = own
        .iter()
        .filter_map(|i| Some(point(rows[*i], id, metric)?.error));
    let least = errors.min_by(f64::total_cmp)?;
    let mut models: Vec<String> = own.iter().map(|i| rows[*i].run.model_label()).collect();
    models.sort();
    models.dedup();
    let on_front = fronts(rows, id, metric);
    let is_cheap = on_front.iter().any(|i| is_fitted(rows[*i]));
    let rest = if is_cheap {
        "costs less, but is the rest of a fit, not a prediction"
    } else {
        "is the rest of a fit, not a prediction, and it is not even cheaper"
    };
    Some(format!(
        "{} {} fitted to this very history: down to {} that {rest}.",
        capital(&models.join(" and ")),
        if models.len() > 1 { "were" } else { "was" },
        per_cent(least, 3)
    ))
}
