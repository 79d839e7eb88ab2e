//! Records of several scenes: charts, tables and files in which each curve and row has the name of its scene.

use crate::{contents, finding, has_only_numbers, holds, made_up, written};
use gearbench_reports::store::PAGE;
use gearbench_reports::{Results, report_from, write_results};
use std::collections::BTreeMap;

/// Makes the record of the impact under another name of the scene, with forces times a factor.
fn impact(scene: &str, factor: f64) -> Results {
    let mut results = made_up::impact_results();
    results.header.scene = scene.into();
    results.header.title = format!("The gears {scene}");
    let runs = results.runs.iter_mut().filter_map(|r| r.series.as_mut());
    let references = results.references.iter_mut().map(|r| &mut r.series);
    for series in runs.chain(references) {
        for column in &mut series.columns {
            if column.name.starts_with("contact_force") {
                column.values.iter_mut().for_each(|f| *f *= factor);
            }
        }
    }
    results
}

fn joined() -> Results {
    Results::joined([impact("original", 1.0), impact("corrected", 0.5)]).unwrap()
}

/// Texts of the entries of the legend of a chart.
fn legend(svg: &str) -> Vec<String> {
    let entries = svg.split("class=\"entry\"").skip(1);
    let text = |entry: &str| {
        let text = entry.split("<text").nth(1)?.split_once('>')?.1;
        Some(text.split("</text>").next()?.trim().to_owned())
    };
    entries.filter_map(text).collect()
}

/// The names of all scenes are at curves, in the finding, in tables and in files.
#[test]
fn scenes_share_charts_and_tables() {
    let files = written(&joined());
    has_only_numbers(&files);
    holds(
        &files,
        &["force.svg", "speeds.svg", "accuracy.svg", "runs.csv"],
    );
    for name in ["force.svg", "speeds.svg", "accuracy.svg"] {
        let names = legend(&files[name]);
        for scene in ["original: rigid", "corrected: rigid"] {
            let found = names.iter().filter(|n| n.starts_with(scene)).count();
            assert!(found >= 1, "{scene} in {name}: {names:?}");
        }
    }
    let page = &files[PAGE];
    assert!(page.contains("scenes <b>original</b>, <b>corrected</b>"));
    let finding = finding(page);
    for scene in ["original", "corrected"] {
        let answer = format!("<b>{scene}</b>: The cheapest run");
        assert!(finding.contains(&answer), "{finding}");
        assert!(page.contains(&format!("Scene <b>{scene}</b>")));
    }
    // Rows of the table at a glance, one for each scene and model.
    let glance = page.split("At a glance").nth(1).unwrap();
    let glance = glance.split("</table>").next().unwrap();
    for label in ["original: movable-teeth", "corrected: movable-teeth"] {
        assert!(glance.contains(label), "{glance}");
    }
    let histories = |scene: &str| {
        let begin = format!("{scene}-run");
        files.keys().filter(|n| n.starts_with(&begin)).count()
    };
    assert!(histories("original") > 0 && histories("original") == histories("corrected"));
}

/// Each run has one row of its own, which points of all scenes lead to.
#[test]
fn runs_of_all_scenes_have_rows_of_their_own() {
    let files = written(&joined());
    let page = &files[PAGE];
    let runs = made_up::impact_results().runs.len();
    let points = files["accuracy.svg"].matches("data-run=\"").count();
    for index in [0, runs] {
        assert!(
            page.contains(&format!("<tr data-run=\"{index}\"")),
            "{index}"
        );
    }
    assert!(points > runs, "{points} points of twice {runs} runs");
    assert!(!page.contains(&format!("data-run=\"{}\"", 2 * runs)));
}

/// Tables of several scenes are those of each with the name of the scene in front.
#[test]
fn tables_are_those_of_each_scene() {
    let files = written(&joined());
    let rows = |text: &str| -> Vec<BTreeMap<String, String>> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        reader.deserialize().map(Result::unwrap).collect()
    };
    let all = rows(&files["runs.csv"]);
    for (scene, factor) in [("original", 1.0), ("corrected", 0.5)] {
        let own = rows(&written(&impact(scene, factor))["runs.csv"]);
        let of_scene = all.iter().filter(|row| row["scene"] == scene);
        let of_scene = of_scene.map(|row| {
            let kept = row.iter().filter(|(key, _)| *key != "scene");
            kept.map(|(k, x)| (k.clone(), x.clone())).collect()
        });
        assert_eq!(of_scene.collect::<Vec<BTreeMap<_, _>>>(), own);
    }
}

/// The record of one scene has nothing of several, and is in that of several as it is.
#[test]
fn the_record_of_a_scene_stays_as_it_is() {
    let alone = Results::joined([impact("original", 1.0)]).unwrap();
    let text = serde_json::to_string(&alone).unwrap();
    assert!(!text.contains("\"further\":[{\"schema\""));
    let dir = tempfile::tempdir().unwrap();
    write_results(dir.path(), &joined()).unwrap();
    let before = contents(dir.path());
    let record: serde_json::Value = serde_json::from_str(&before["results.json"]).unwrap();
    let own: serde_json::Value =
        serde_json::from_str(&written(&impact("corrected", 0.5))["results.json"]).unwrap();
    let mut kept = record["further"][0].clone();
    // Files of histories have the name of the scene in front.
    for (run, own) in kept["runs"]
        .as_array_mut()
        .unwrap()
        .iter_mut()
        .zip(own["runs"].as_array().unwrap())
    {
        if let Some(files) = own.get("files") {
            run["files"] = files.clone();
        }
    }
    assert_eq!(kept, own);
    report_from(dir.path()).unwrap();
    assert_eq!(contents(dir.path()), before);
}

#[test]
fn scenes_that_cannot_be_told_apart_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let refused = |results: Results, word: &str| {
        let error = write_results(dir.path(), &results).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    };
    let twice = [impact("original", 1.0), impact("original", 0.5)];
    refused(Results::joined(twice).unwrap(), "two scenes have the name");
    let mut other = impact("corrected", 0.5);
    other.part = made_up::penalty_results().part;
    refused(
        Results::joined([impact("original", 1.0), other]).unwrap(),
        "same study",
    );
    let tables = [made_up::penalty_results(), made_up::penalty_results()];
    refused(Results::joined(tables).unwrap(), "has one scene");
}

/// A sweep of two scenes has both resonances, a line for each model and scene, and one table.
#[test]
fn sweeps_of_scenes_share_charts() {
    let scene = |name: &str| {
        let mut results = made_up::sweep_results();
        results.header.scene = name.into();
        results
    };
    let alone = written(&scene("original"));
    let files = written(&Results::joined([scene("original"), scene("corrected")]).unwrap());
    let single = legend(&alone["sweep.svg"]);
    let both = legend(&files["sweep.svg"]);
    assert_eq!(both.len(), 2 * single.len(), "{both:?}");
    for name in &single {
        assert!(
            both.contains(&format!("original: {name}")),
            "{name}: {both:?}"
        );
        assert!(
            both.contains(&format!("corrected: {name}")),
            "{name}: {both:?}"
        );
    }
    let lines = |files: &BTreeMap<String, String>, name: &str| files[name].lines().count() - 1;
    for name in ["sweep.csv", "sweep_cycles.csv", "statics.csv"] {
        assert_eq!(lines(&files, name), 2 * lines(&alone, name), "{name}");
        assert!(files[name].starts_with("scene,"), "{name}");
    }
    let finding = finding(&files[PAGE]);
    // The resonance by the static cycle is in the answer of each.
    let resonance = "the resonance of the mesh is 5.50\u{a0}kHz";
    assert_eq!(finding.matches(resonance).count(), 2, "{finding}");
}
