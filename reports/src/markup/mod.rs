//! The report: one self-contained HTML page, for the screen offline and for paper.
//!
//! The page makes no request: style, charts and scripts are in the page. The page is complete without the scripts:
//! `charts.js` adds what a pointer and keys do on charts, `gears.js` moves gears. `maud` escapes every text from data; only
//! the charts, which are SVG already, and the data of moving gears, which are JSON without `<`, are inserted unchanged.

pub mod column;
pub mod gears;
pub mod runs;
pub mod table;

use crate::drawing::Chart;
use crate::drawing::style::{mark, night};
use crate::glossary::explained;
use crate::metrics::Metric;
use crate::numbers::{count, quantity};
use crate::record::{Results, Run, Status};
use crate::studies::{StudyReport, of_scene};
use crate::view::{Group, View};
use gears::Viewer;
use maud::{DOCTYPE, Markup, PreEscaped, Render, html};

/// Style of all pages.
const STYLE: &str = include_str!("style.css");
/// Script of all pages.
pub const SCRIPT: &str = include_str!("charts.js");

/// Renders a section under a heading.
pub fn section(heading: &str, content: impl Render) -> Markup {
    html! { section { h2 { (heading) } (content) } }
}

/// Renders a section that belongs to the short version of the page.
pub fn glance(heading: &str, content: impl Render) -> Markup {
    html! { section.glance { h2 { (heading) } (content) } }
}

/// Renders a note below a table.
pub fn note(text: impl Render) -> Markup {
    html! { p.note { (text) } }
}

/// Renders sentences in sequence.
pub fn sentences(all: &[Markup]) -> Markup {
    let all: Vec<&str> = all.iter().map(|m| m.0.as_str()).collect();
    PreEscaped(all.join(" "))
}

/// Returns the text of a sentence of a page, without its elements.
pub fn text(markup: &Markup) -> String {
    let mut plain = String::with_capacity(markup.0.len());
    let mut inside = false;
    for c in markup.0.chars() {
        match c {
            '<' => inside = true,
            '>' if inside => inside = false,
            c if !inside => plain.push(c),
            _ => {}
        }
    }
    let entities = [
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&quot;", "\""),
        ("&amp;", "&"),
    ];
    entities
        .iter()
        .fold(plain, |text, (entity, sign)| text.replace(entity, sign))
}

/// Renders a text of a record in plain words: metrics by their names, other names of the format as code.
pub fn prose(text: &str) -> Markup {
    with_code(&in_words(text), |part| html! { (part) })
}

/// Renders a text as [`prose`] does, with the meanings of the terms of the glossary.
fn prose_with_terms(text: &str) -> Markup {
    with_code(&in_words(text), explained)
}

/// Renders a text with its quoted parts as code.
fn with_code(text: &str, part: impl Fn(&str) -> Markup) -> Markup {
    let parts = text.split('`').enumerate();
    html! { @for (i, text) in parts { @if i % 2 == 1 { code { (text) } } @else { (part(text)) } } }
}

/// Returns a text with the names of metrics in place of their keys.
fn in_words(text: &str) -> String {
    // A key that is a word of its own, quoted or not, is a metric.
    let mut text = text.to_owned();
    let mut metrics = Metric::ALL;
    metrics.sort_by_key(|m| std::cmp::Reverse(m.key().len()));
    for m in metrics.into_iter().filter(|m| m.key().contains('_')) {
        text = text.replace(&format!("`{}`", m.key()), m.words());
        text = text.replace(m.key(), m.words());
    }
    text
}

/// Returns the clause on the number of failed runs of a record, for the end of a sentence.
pub fn failed_of(results: &Results) -> String {
    let failed = results.runs.iter().filter(|r| r.status.is_failure());
    match (failed.count(), results.runs.len()) {
        (0, 1) => "the run did not fail".into(),
        (0, all) => format!("none of the {all} runs failed"),
        (1, 1) => "the run failed and is shown as a failure".into(),
        (1, all) => format!("1 of {all} runs failed and is shown as a failure"),
        (n, all) => format!("{n} of {all} runs failed and are shown as failures"),
    }
}

/// Returns the clause on the numbers of failed and of inaccurate runs.
pub fn short_of(results: &Results) -> String {
    let inaccurate = |r: &&Run| r.status == Status::Inaccurate;
    match results.runs.iter().filter(inaccurate).count() {
        0 => failed_of(results),
        n => format!("{}, {n} are inaccurate", failed_of(results)),
    }
}

/// Renders a document: title, the program that made it, style, and what its body contains.
pub fn document(title: &Markup, generator: &str, body: &Markup) -> Markup {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content=(generator);
                title { (title) " - gearbench" }
                style { (PreEscaped(STYLE)) "@media screen and (prefers-color-scheme: dark){" (PreEscaped(night())) "}" }
            }
            body { (body) }
        }
    }
}

/// Returns the HTML page of a record with the report of its study.
pub fn page(results: &Results, report: &StudyReport) -> String {
    let views = View::of_scenes(results);
    let names: Vec<&str> = results.scenes().map(|r| r.header.name()).collect();
    let name = names.join(" \u{b7} ");
    let scenes: Vec<&str> = results.scenes().map(|r| r.header.scene.as_str()).collect();
    let stamp = [
        results.header.created.clone(),
        format!("commit {}", results.header.commit),
        results.header.machine.cpu.clone(),
    ];
    let said = |s: &&String| !s.is_empty() && *s != "commit ";
    let stamp: Vec<&str> = stamp.iter().filter(said).map(String::as_str).collect();
    let body = html! {
        main {
            header {
                p.kicker {
                    "gearbench \u{b7} " (results.study_name()) " \u{b7} " (if scenes.len() > 1 { "scenes " } else { "scene " })
                    @for (i, scene) in scenes.iter().enumerate() { @if i > 0 { ", " } b { (scene) } }
                }
                h1 { (name) }
                p.stamp { (stamp.join(" \u{b7} ")) }
            }
            section.finding {
                h2 { "Finding" }
                (finding(report))
            }
            @if !report.first.is_empty() {
                div.first { @for (i, c) in report.first.iter().enumerate() { (chart(i + 1, c, report.viewer.as_ref())) } }
            }
            (report.tables)
            @for (i, c) in report.charts.iter().enumerate() {
                (chart(report.first.len() + i + 1, c, report.viewer.as_ref()))
            }
            @for view in &views { (of_scene(view, &models(view))) }
            (report.details)
            @for view in &views { (of_scene(view, &setting(view))) }
            (origin(&views))
        }
        script { (PreEscaped(SCRIPT)) }
        @if report.viewer.is_some() { (gears::scripts()) }
    };
    let title = html! { (name) ": " (results.study_name()) };
    let page = document(&title, "gearbench", &body);
    let lines = page
        .0
        .replace("<section", "\n<section")
        .replace("<tr", "\n<tr");
    lines
        .chars()
        .filter(|c| *c == '\n' || !c.is_control())
        .collect()
}

/// Renders the sentences of a finding, that with the answer first.
fn finding(report: &StudyReport) -> Markup {
    let answer = report.answer.min(report.finding.len());
    let (before, from) = report.finding.split_at(answer);
    let (answer, after) = from.split_at(from.len().min(1));
    let others = [before, after].concat();
    html! {
        p.answer { (sentences(answer)) }
        @if !others.is_empty() { p { (sentences(&others)) } }
    }
}

/// Renders a chart under its heading, with its number.
fn chart(number: usize, chart: &Chart, viewer: Option<&Viewer>) -> Markup {
    html! {
        section.chart {
            h2 { (chart.title) }
            figure {
                div.pan { (PreEscaped(&chart.svg)) }
                @if let Some(v) = viewer.filter(|v| v.chart == chart.file) { (v.figure()) }
                figcaption { b { "Figure " (number) "." } " " (prose_with_terms(&chart.caption)) }
            }
        }
    }
}

/// Returns the setting that describes a model: its key contains the model's label as scenes write it.
fn setting_of<'r>(results: &'r Results, label: &str) -> Option<(&'r String, &'r String)> {
    let key = format!("model {}", label.replace(", ", "-"));
    let found = results.settings.iter().find(|(k, _)| *k == key);
    found.map(|(k, v)| (k, v))
}

/// Renders the list of the models of tables and charts, each with its settings; empty where the record has none.
fn models(view: &View<'_>) -> Markup {
    let known = |g: &Group<'_>| setting_of(view.results, &g.model).is_some();
    let groups: Vec<&Group<'_>> = view.groups.iter().filter(|g| known(g)).collect();
    if groups.is_empty() {
        return Markup::default();
    }
    let list = html! {
        dl.models {
            @for g in groups {
                dt { (mark(g.style)) (g.label) }
                dd { @if let Some((_, text)) = setting_of(view.results, &g.model) { (prose(text)) } }
            }
        }
    };
    section("What the models are", list)
}

/// Renders settings and references of a scene.
fn setting(view: &View<'_>) -> Markup {
    let r = view.results;
    let shown: Vec<&String> = (view.groups.iter())
        .filter_map(|g| Some(setting_of(r, &g.model)?.0))
        .collect();
    let settings: Vec<(&str, &str)> = (r.settings.iter())
        .filter(|(k, _)| !shown.contains(&k))
        .map(|(k, v)| (k.as_str(), v.as_str()))
        .collect();
    html! {
        @if !settings.is_empty() { (section("Settings", list(&settings))) }
        @for reference in &r.references {
            (section(
                &format!("Reference: {}", view.reference_name(&reference.id)),
                list(&[
                    ("source", &reference.source),
                    ("note", &reference.note),
                    ("samples", &count(reference.series.len() as u64)),
                    ("read as", &reference.processing.join("; ")),
                    ("cost", &reference.cpu_s.map_or(String::new(), |t| {
                        format!("{} of processor time", quantity(t, "s", 3))
                    })),
                    ("regenerated by", reference.command.as_deref().unwrap_or_default()),
                ]),
            ))
        }
    }
}

/// Renders names with their texts; an empty text is left out.
fn list(pairs: &[(&str, &str)]) -> Markup {
    html! {
        dl { @for (k, v) in pairs.iter().filter(|p| !p.1.is_empty()) { dt { (k) } dd { (prose(v)) } } }
    }
}

/// Renders calibrations, machine and version, and the command that makes the report again.
fn origin(views: &[View<'_>]) -> Markup {
    let header = &views[0].results.header;
    let m = &header.machine;
    let cores = Some(m.cores.to_string()).filter(|_| m.cores > 0);
    let calibrations: Vec<String> = (views.iter().flat_map(|v| &v.groups))
        .filter_map(|g| {
            let name = g.runs.iter().find_map(|(_, r)| r.calibration.as_ref())?;
            Some(format!("{}: {name}", g.label))
        })
        .collect();
    let record = format!("results.json, schema {}", header.schema);
    let or_none = |x: &'_ Option<String>| x.clone().unwrap_or_default();
    html! {
        section {
            h2 { "How this was made" }
            (list(&[
                ("calibration", &calibrations.join("; ")),
                ("processor", &m.cpu),
                ("logical cores", &or_none(&cores)),
                ("system", &m.os),
                ("architecture", &or_none(&m.arch)),
                ("build profile", &or_none(&m.profile)),
                ("remark", &or_none(&m.note)),
                ("commit", &header.commit),
                ("made", &header.created),
                ("record", &record),
            ]))
            p { "Make it again with" }
            pre { (header.command) }
        }
    }
}
