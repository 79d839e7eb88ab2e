//! Rules for the page of every study: tables that show their results, findings that are short and name fitted models,
//! plain words, sizes.

use crate::{finding, made_up, precision, without_scripts, written};
use gearbench_reports::record::SELF;
use gearbench_reports::stability::{Cell, Columns, Limit, Map, MapAxis, StabilityRecord};
use gearbench_reports::store::PAGE;
use gearbench_reports::{
    Adequacy, CandidateRecord, ChoiceRecord, ChooseRecord, LevelRecord, Metric, Part,
    ReferenceDistance, Results, Status, Verdict,
};

/// Width of the text of a page \[px\], and of a character of its tables.
const PAGE_WIDTH: f64 = 920.0;
const CHARACTER: f64 = 6.4;

pub fn stability() -> Results {
    let at: Vec<f64> = (0..10).map(|i| 1e-8 * 2_f64.powi(i)).collect();
    let map = |integrator: &str| Map {
        model: "rigid".into(),
        integrator: integrator.into(),
        duration_s: 1e-3,
        columns: Columns::Step,
        axes: vec![MapAxis {
            id: "contact-stiffness".into(),
            name: "contact stiffness over the scene's".into(),
            values: vec![1.0],
            ..MapAxis::default()
        }],
        cells: (at.iter().enumerate())
            .map(|(i, h)| Cell {
                at: *h,
                status: if i < 6 {
                    Status::Converged
                } else {
                    Status::BlowUp
                },
                ..Cell::default()
            })
            .collect(),
        at: at.clone(),
        ..Map::default()
    };
    let maps = vec![map("rk4"), map("velocity-verlet")];
    assert_ne!(maps[0].limit(), Some(Limit::default()));
    Results {
        part: Part::Stability(StabilityRecord { maps }),
        ..Results::default()
    }
}

pub fn choose() -> Results {
    let tried = |cost_s: f64, error: f64| CandidateRecord {
        level: "rigid, own `rigid`".into(),
        family: "rigid".into(),
        integrator: "velocity-verlet".into(),
        step_s: Some(1.37e-5),
        cost_s: Some(cost_s),
        error: Some(error),
        adequate: Adequacy::of(error, 0.01, 0.05),
        ..CandidateRecord::default()
    };
    let level = LevelRecord {
        name: "rigid, own `rigid`".into(),
        family: "rigid".into(),
        distance: Some(0.03),
        error: Some(0.031),
        adequate: Adequacy::Adequate,
        cheapest: Some(0),
        setup_s: Some(1.2e-5),
        ..LevelRecord::default()
    };
    let choice = ChoiceRecord {
        metric: "peak".into(),
        metric_title: "peak force".into(),
        tolerance: 0.05,
        verdict: Some(Verdict::Adequate),
        yardstick: "`elastic, 35 modes, finer mesh`".into(),
        yardstick_error: Some(0.01),
        references: vec![ReferenceDistance {
            reference: "calculix".into(),
            yardstick: Some(0.07),
            choice: None,
        }],
        runs: 10,
        total_cost_s: Some(7.7e-5),
        chosen: Some(0),
        predicted_error: Some(0.014),
        predicted_cost_s: Some(6.52e-6),
        setup_s: Some(1.2e-5),
        window: "the whole scene".into(),
        reason: vec!["The hierarchy settles at `elastic`; the metric is `peak_force_rel`.".into()],
        levels: vec![level],
        tried: vec![tried(6.52e-6, 0.014), tried(7e-6, 0.0141), tried(2e-6, 0.2)],
        ..ChoiceRecord::default()
    };
    Results {
        part: Part::Choose(Box::new(ChooseRecord { choice })),
        ..Results::default()
    }
}

/// Returns the page of every study.
fn pages() -> Vec<(&'static str, String)> {
    let all = [
        ("compare", made_up::impact_results()),
        ("rotation", made_up::rotation_results()),
        ("precision", precision::results()),
        ("penalty", made_up::penalty_results()),
        ("sweep", made_up::sweep_results()),
        ("stability", stability()),
        ("choose", choose()),
    ];
    let page = |r: &Results| written(r).remove(PAGE).unwrap();
    all.iter().map(|(name, r)| (*name, page(r))).collect()
}

/// Returns the text of a page without its tags.
fn text(html: &str) -> String {
    let html = html.replace("<br>", " ");
    let parts = html
        .split('<')
        .map(|p| p.split_once('>').map_or(p, |(_, text)| text));
    parts.collect::<Vec<_>>().concat()
}

/// Returns attribute and text of all elements of a name.
fn elements<'h>(html: &'h str, name: &str) -> Vec<(&'h str, String)> {
    let (open, close) = (format!("<{name}"), format!("</{name}>"));
    let all = html.split(&open[..]).skip(1);
    all.filter(|e| e.starts_with([' ', '>']))
        .filter_map(|e| e.split(&close[..]).next()?.split_once('>'))
        .map(|(attributes, inner)| (attributes, text(inner)))
        .collect()
}

/// Estimates the width of a table by its longest cells and words of its heads: text of more than 23 characters wraps.
fn width(table: &str) -> f64 {
    let heads: Vec<usize> = (elements(table, "th").iter())
        .filter(|(a, _)| !a.contains("colspan"))
        .map(|(_, t)| t.split(' ').map(|w| w.chars().count()).max().unwrap_or(0))
        .collect();
    let mut widest = heads.clone();
    for row in table.split("<tr").skip(1) {
        for (i, (_, t)) in elements(row, "td").iter().enumerate() {
            widest[i] = widest[i].max(t.chars().count().min(23));
        }
    }
    widest.iter().map(|n| 12.0 + CHARACTER * *n as f64).sum()
}

/// Every study has its results in the table at a glance, and no table is wider than the page, so that nothing is hidden
/// on a usual screen or on paper; on a narrow screen a table scrolls in its own box.
#[test]
fn no_table_hides_its_results() {
    for (name, page) in pages() {
        let (_, body) = page.split_once("</style>").unwrap();
        for more in body.split("<details").skip(1) {
            let more = more.split("</details>").next().unwrap();
            let hidden: Vec<_> = (elements(more, "th").into_iter())
                .filter(|(a, _)| a.contains(" r\""))
                .collect();
            assert!(
                hidden.is_empty() || more.contains("<summary>All "),
                "{name}: {hidden:?}"
            );
        }
        let tables: Vec<&str> = body.split("<table").skip(1).collect();
        assert!(!tables.is_empty(), "{name}");
        for table in tables {
            let table = table.split("</table>").next().unwrap();
            let w = width(table);
            assert!(
                w <= 1.04 * PAGE_WIDTH,
                "{name}: {w} {:?}",
                elements(table, "th")
            );
        }
        let boxed = body.matches("<div class=\"pan\"><table>").count();
        assert_eq!(boxed, body.matches("<table").count(), "{name}");
    }
}

/// The last columns, which were cut off in an earlier version, are in the table at a glance.
#[test]
fn the_columns_at_the_end_are_at_a_glance() {
    for (study, section, columns) in [
        (
            "compare",
            "Metrics against",
            &["Rebound", "Energy drift", "Impulse"][..],
        ),
        (
            "precision",
            "One row per run and reference",
            &["Against", "Processor time"],
        ),
    ] {
        let page = pages().into_iter().find(|p| p.0 == study).unwrap().1;
        let table = page.split(section).nth(1).unwrap();
        let glance = table.split("</table>").next().unwrap();
        assert!(!glance.contains("<details"), "{study}");
        let heads = elements(glance, "th");
        for column in columns {
            let shown = heads.iter().any(|(_, t)| t.starts_with(column));
            assert!(shown, "{study}: {column} not in {heads:?}");
        }
    }
}

#[test]
fn findings_are_four_sentences_at_most() {
    for (name, page) in pages() {
        let said = text(finding(&page).split_once("</h2>").unwrap().1);
        let sentences = said.trim().trim_end_matches('.').split(". ").count();
        assert!(
            (1..=4).contains(&sentences),
            "{name}: {sentences} in {said}"
        );
    }
}

/// A model that was fitted to the history it is compared with makes no prediction there, and the page does not present
/// it as one.
#[test]
fn a_fit_is_no_prediction() {
    let mut results = made_up::impact_results();
    for r in results.runs.iter_mut().filter(|r| r.model == "rigid") {
        r.fitted_to = Some("calculix".into());
        r.wall_s *= 0.01;
    }
    let files = written(&results);
    let said = text(finding(&files[PAGE]));
    // The answer is first, then the sentence that names the yardstick.
    assert!(
        said.contains("a prediction.Models are compared with"),
        "{said}"
    );
    let (named, rest) = said.split_once(';').unwrap();
    assert!(
        named.contains("predicts the scene within its tolerance"),
        "{said}"
    );
    assert!(
        named.contains("movable-teeth under") && !named.contains("rigid under"),
        "{said}"
    );
    assert!(
        rest.contains("fitted to this very history") && rest.contains("not a prediction"),
        "{said}"
    );
    assert!(said.contains("what the fits to it leave: rigid"), "{said}");
    assert!(text(&files[PAGE]).contains("rest of a fit"));
    for r in &mut results.runs {
        r.fitted_to = Some("calculix".into());
    }
    let said = text(finding(&written(&results)[PAGE]));
    assert!(said.contains("No model predicts the scene"), "{said}");
}

/// A tolerance against a model that did not run is not applied, and never called one of integration.
#[test]
fn a_tolerance_against_an_absent_model_is_not_applied() {
    let mut results = made_up::impact_results();
    results.references.clear();
    if let Part::Compare(part) = &mut results.part {
        part.yardstick = None;
    }
    for run in &mut results.runs {
        run.metrics.retain(|m| m.against == SELF);
    }
    if let Some(tolerance) = &mut results.tolerance {
        tolerance.against = "elastic".into();
    }
    let said = text(finding(&written(&results)[PAGE]));
    assert!(
        said.contains("is not applied, since elastic has no result"),
        "{said}"
    );
    assert!(!said.contains("integrated within"), "{said}");
}

/// A page has neither keys of the format nor quoted names in its sentences, and singular and plural are correct.
#[test]
fn pages_speak_in_words() {
    for (name, page) in pages() {
        let said = without_scripts(page.split("</style>").nth(1).unwrap(), "");
        let said = text(&said);
        for m in Metric::ALL.into_iter().filter(|m| m.key().contains('_')) {
            assert!(!said.contains(m.key()), "{name}: {}", m.key());
        }
        assert!(!said.contains('`'), "{name}");
        for wrong in [
            " 1 runs",
            " 1 times ",
            " 1 choices",
            " 1 scenes",
            "Simulation time",
        ] {
            assert!(!said.contains(wrong), "{name}: {wrong}");
        }
        assert!(page.contains("prefers-color-scheme: dark"), "{name}");
    }
}

/// Titles of figures are all different: each names its reference.
#[test]
fn no_two_figures_have_one_title() {
    for (name, page) in pages() {
        let mut titles: Vec<String> = elements(&page, "h2").into_iter().map(|t| t.1).collect();
        let all = titles.len();
        titles.sort();
        titles.dedup();
        assert_eq!(titles.len(), all, "{name}");
    }
}

/// A page of twenty models with long histories is smaller than 3 MB; the CSV files have the data.
#[test]
fn pages_stay_small() {
    let mut results = made_up::rotation_results();
    let base = results.runs.clone();
    for k in 0..4 {
        for r in &base {
            let mut r = r.clone();
            r.variant = Some(format!("{} {k}", r.variant.unwrap_or_default()));
            results.runs.push(r);
        }
    }
    let page = &written(&results)[PAGE];
    assert!(page.len() < 3_000_000, "{}", page.len());
}
