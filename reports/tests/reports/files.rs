//! The files of a report: format, completeness, honesty.

use crate::{contents, finding, has_only_numbers, holds, made_up, without_scripts, written};
use gearbench_reports::series::{CONTACT_FORCE, SPEED};
use gearbench_reports::store::{PAGE, RECORD};
use gearbench_reports::{
    Column, ContactEvent, Histories, PairSample, Results, Run, Status, load_results, report_from,
    write_results,
};
use std::fs;
use std::path::Path;

#[test]
fn the_keys_of_the_format_are_there() {
    let dir = tempfile::tempdir().unwrap();
    write_results(dir.path(), &made_up::impact_results()).unwrap();
    let json: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(dir.path().join(RECORD)).unwrap()).unwrap();
    assert_eq!(json["schema"], gearbench_reports::SCHEMA);
    for key in [
        "scene", "machine", "commit", "runs", "study", "command", "created",
    ] {
        assert!(json.get(key).is_some(), "{key}");
    }
    let run = &json["runs"][0];
    for key in [
        "model",
        "integrator",
        "step",
        "status",
        "wall_s",
        "setup_s",
        "simulated_s",
        "steps",
        "rejected",
        "force_evaluations",
        "newton_iterations",
        "factorisations",
        "dofs",
        "metrics",
    ] {
        assert!(run.get(key).is_some(), "{key}");
    }
    assert!(json["runs"][3].get("rtol").is_some() && json["runs"][3].get("step").is_none());
    for key in [
        "force_l2",
        "force_l2_aligned",
        "peak_force_n",
        "peak_force_rel",
        "impulse_ns",
        "impulse_rel",
        "duration_s",
        "speeds_end",
        "energy_drift_rel",
        "against",
    ] {
        assert!(run["metrics"][0].get(key).is_some(), "{key}");
    }
    let elastic = Run {
        modes: Some(50),
        residual: Some(true),
        ..Run::default()
    };
    let elastic = serde_json::to_value(elastic).unwrap();
    assert_eq!(
        (&elastic["modes"], &elastic["residual"]),
        (&50.into(), &true.into())
    );
}

#[test]
fn every_status_has_its_words() {
    for status in Status::ALL {
        let json = serde_json::to_value(status).unwrap();
        assert_eq!(json, status.as_str());
        assert_eq!(serde_json::from_value::<Status>(json).unwrap(), status);
    }
    assert_eq!(
        Status::ALL.map(Status::as_str).join(" | "),
        "converged | unchecked | inaccurate | energy growth | chatter | newton failure | step underflow | \
         blow-up | tunnelling | adhesive force | timeout | refused | aborted | interrupted"
    );
}

#[test]
fn a_record_survives_its_file() {
    let dir = tempfile::tempdir().unwrap();
    let saved = made_up::impact_results().sanitised();
    write_results(dir.path(), &saved).unwrap();
    let loaded = load_results(dir.path()).unwrap();
    assert_eq!(loaded.settings, saved.settings);
    assert_eq!(loaded.runs.len(), saved.runs.len());
    for (a, b) in loaded.runs.iter().zip(&saved.runs) {
        assert_eq!(a.status, b.status);
        let (a, b) = (a.series.as_ref().unwrap(), b.series.as_ref().unwrap());
        assert_eq!(a.len(), b.len());
        for (x, y) in a.contact_force().iter().zip(b.contact_force()) {
            assert!((x - y).abs() <= 2.0 * f64::EPSILON * y.abs());
        }
    }
    let simple = Results {
        runs: vec![Run {
            model: "rigid".into(),
            integrator: "rk4".into(),
            wall_s: 0.5,
            setup_s: 0.0,
            simulated_s: 0.25,
            ..Run::default()
        }],
        settings: vec![("z".into(), "20".into()), ("a".into(), "x".into())],
        ..Results::default()
    };
    let text = serde_json::to_string(&simple).unwrap();
    assert_eq!(serde_json::from_str::<Results>(&text).unwrap(), simple);
}

#[test]
fn the_report_is_a_function_of_the_record() {
    let dir = tempfile::tempdir().unwrap();
    write_results(dir.path(), &made_up::impact_results()).unwrap();
    let first = contents(dir.path());
    // Histories are data that the record has only in part: they are left alone.
    let is_history =
        |n: &str| n.starts_with("run0") || n.starts_with("run1") || n.starts_with("reference");
    for name in first.keys().filter(|n| *n != RECORD && !is_history(n)) {
        fs::remove_file(dir.path().join(name)).unwrap();
    }
    report_from(dir.path()).unwrap();
    let second = contents(dir.path());
    assert_eq!(
        first.keys().collect::<Vec<_>>(),
        second.keys().collect::<Vec<_>>()
    );
    for (name, text) in &first {
        assert!(*text == second[name], "{name} differs");
    }
    holds(
        &first,
        &[
            "force.svg",
            "speeds.svg",
            "mesh.svg",
            "flanks.svg",
            "flanks_over_run.svg",
            "load_over_width.svg",
            "runtime.svg",
            "accuracy.svg",
            PAGE,
        ],
    );
    let csv = &first["run02-rigid-velocity-verlet.csv"];
    let header = "time_s,contact_force_pinion_wheel_n,speed_pinion_rad_s,speed_wheel_rad_s\n";
    assert!(csv.starts_with(header));
}

/// Histories at full resolution are in files of their own and not in the record, which keeps those of the charts; files
/// of an earlier record are removed.
#[test]
fn whole_histories_have_files_of_their_own() {
    let dir = tempfile::tempdir().unwrap();
    let mut results = made_up::impact_results();
    let whole = made_up::impact(1e-5, 3000.0, 0.0, 1e-7);
    // The most accurate run of its model, of several the one with the fewest evaluations of the force.
    let stem = results.runs[1].file_stem(1);
    results.runs[1].histories = Some(Histories {
        on_grid: (0..whole.len()).step_by(10).collect(),
        further: vec![Column {
            name: "force_x_pinion_wheel_n".into(),
            values: (0..whole.len()).step_by(10).map(|i| i as f64).collect(),
        }],
        pairs: vec![PairSample {
            time_s: 2e-5,
            mesh: 1,
            teeth: [3, 30],
            force_n: 5.0,
            ..PairSample::default()
        }],
        events: vec![ContactEvent {
            time_s: 1e-5,
            closes: true,
            mesh: 1,
            teeth: [3, 30],
            force_n: [0.0, 120.0],
            located: true,
        }],
        series: Some(whole.clone()),
    });
    write_results(dir.path(), &results).unwrap();
    let files = contents(dir.path());
    assert!(!files[RECORD].contains("histories") && !files[RECORD].contains("force_x_pinion"));
    let record: serde_json::Value = serde_json::from_str(&files[RECORD]).unwrap();
    let names = ["", "-pairs", "-events"].map(|ending| format!("{stem}{ending}.csv"));
    assert_eq!(record["runs"][1]["files"], serde_json::json!(names));
    // A file of every name, and no file of histories that no run names; a comparison has those of one run of each model.
    let runs = record["runs"].as_array().unwrap();
    let mut named: Vec<&str> = (runs.iter())
        .flat_map(|r| r["files"].as_array().into_iter().flatten())
        .filter_map(|name| name.as_str())
        .collect();
    named.sort_unstable();
    let histories =
        |name: &&str| name.starts_with("run") && name.ends_with(".csv") && *name != "runs.csv";
    let there: Vec<&str> = files.keys().map(String::as_str).filter(histories).collect();
    assert_eq!(named, there);
    assert_eq!(runs.iter().filter(|r| r["files"].is_array()).count(), 2);
    let even = &files[&format!("{stem}.csv")];
    assert_eq!(even.lines().count(), 1 + whole.len().div_ceil(10));
    assert!(
        even.lines().nth(2).unwrap().ends_with(",1.000000000e1"),
        "{even}"
    );
    let pairs = &files[&format!("{stem}-pairs.csv")];
    assert!(pairs.contains("2.000000000e-5,1,3,30,5.0"), "{pairs}");
    let events = &files[&format!("{stem}-events.csv")];
    assert!(
        events.contains(",closes,1,3,30,0.000000000e0,1.200000000e2,true"),
        "{events}"
    );
    results.runs[1].histories = None;
    results.runs[1].series = None;
    write_results(dir.path(), &results).unwrap();
    let left = contents(dir.path());
    assert!(
        !left.keys().any(|name| name.starts_with(&stem)),
        "{:?}",
        left.keys()
    );
}

#[test]
fn numbers_that_are_none_reach_no_file() {
    let dir = tempfile::tempdir().unwrap();
    let mut results = made_up::impact_results();
    for run in &mut results.runs {
        if let Some(picture) = &mut run.contacts {
            picture.contacts[0].force = [f64::NAN, f64::INFINITY];
            picture.outlines[0].points[3] = [f64::NAN, 0.0];
        }
    }
    results.runs[4].wall_s = f64::NAN;
    results.runs[5].wall_s = f64::INFINITY;
    write_results(dir.path(), &results).unwrap();
    has_only_numbers(&contents(dir.path()));
    let loaded = load_results(dir.path()).unwrap();
    assert!(loaded.runs[4].wall_s.is_nan());
}

#[test]
fn a_failed_run_is_shown_as_a_failure() {
    let files = written(&made_up::impact_results());
    let page = &files[PAGE];
    assert!(page.contains("2 of 18 runs failed"));
    assert!(page.contains("speed of gear 2 not finite at t = 61.25 us"));
    assert!(page.contains("<tr class=\"failed\">"));
    for chart in ["runtime.svg", "accuracy.svg"] {
        assert!(files[chart].contains("blow-up"), "{chart}");
        assert!(files[chart].contains("newton failure"), "{chart}");
    }
    // The failed runs are the fastest of all and must not be named as the cheapest.
    let finding = finding(&files[PAGE]);
    assert!(finding.contains("dormand-prince"), "{finding}");
}

#[test]
fn the_page_is_alone_and_nothing_in_it_runs_but_its_own_script() {
    let mut results = made_up::impact_results();
    let hostile = "<script src=\"http://x\">]]>&'\u{7}";
    results.header.title = hostile.into();
    results.header.command = hostile.into();
    results.settings.push((hostile.into(), hostile.into()));
    results.references[0].title = hostile.into();
    results.header.machine.cpu = hostile.into();
    for run in &mut results.runs {
        run.variant = Some(hostile.into());
        run.message = Some(hostile.into());
        run.calibration = Some(hostile.into());
        if let Some(motion) = &mut run.motion {
            motion.bodies[0].gear = hostile.into();
        }
        if let Some(picture) = &mut run.contacts {
            picture.outlines[0].gear = hostile.into();
            picture.contacts[0].pair = hostile.into();
        }
    }
    for (name, text) in written(&results) {
        if name.ends_with(".html") || name.ends_with(".svg") {
            // The script of the charts; the data of the moving gears and their script.
            let own = if name == PAGE { 3 } else { 0 };
            assert_eq!(text.matches("<script").count(), own, "{name}");
            assert_eq!(text.matches("</script>").count(), own, "{name}");
            assert!(!without_scripts(&text, "").contains("]]>"), "{name}");
            assert!(!text.contains('\u{7}'), "{name}");
            for fetch in ["src=", "href=", "@import", "url("] {
                // As text of the page and of the data.
                let quoted = text.replace("src=&quot;", "").replace("src=\\\"", "");
                assert!(!quoted.contains(fetch), "{fetch} in {name}");
            }
        }
    }
}

/// A helical pair has a still picture in space with all faces, contacts and forces; a motion that breaks its own rules is refused.
#[test]
fn motions_in_space_have_a_still_picture_and_broken_ones_are_refused() {
    let mut results = made_up::impact_results();
    let place = results
        .runs
        .iter()
        .position(|r| r.motion.is_some())
        .unwrap();
    results.runs[place].motion = Some(made_up::motion(0.05));
    let files = written(&results);
    let still = &files["mesh.svg"];
    // 50 teeth with more than two faces of flanks each that are turned to the reader.
    assert!(
        still.matches("<polygon").count() > 100,
        "{}",
        still.matches("<polygon").count()
    );
    let page = &files[PAGE];
    assert!(page.contains("\"spatial\":true") && page.contains("Meshing teeth"));
    let motion = |change: fn(&mut gearbench_reports::GearMotion)| {
        let mut broken = results.clone();
        change(broken.runs[place].motion.as_mut().unwrap());
        broken.validate().unwrap_err()
    };
    for (error, expected) in [
        (motion(|m| m.time_s[1] = -1.0), "time_s is not ascending"),
        (
            motion(|m| m.contacts.meshes[0] = 2),
            "the number of no mesh",
        ),
        (motion(|m| m.bodies[0].teeth = 0), "0 `teeth`"),
        (
            motion(|m| m.bodies[1].points_m.data.truncate(7)),
            "not base64",
        ),
        (
            motion(|m| m.paths[0].turn_rad.bits = 8),
            "numbers, expected 3",
        ),
        (motion(|m| m.teeth[0].counts[0] = 1), "the sum of counts"),
    ] {
        assert!(
            error.contains("motion.") && error.contains(expected),
            "{error}"
        );
    }
}

#[test]
fn a_second_study_replaces_the_first_and_spares_the_rest() {
    let dir = tempfile::tempdir().unwrap();
    write_results(dir.path(), &made_up::impact_results()).unwrap();
    fs::write(dir.path().join("notes.txt"), "mine").unwrap();
    let mut fewer = made_up::impact_results();
    fewer.runs.truncate(2);
    for run in &mut fewer.runs {
        (run.contacts, run.motion) = (None, None);
    }
    write_results(dir.path(), &fewer).unwrap();
    let files = contents(dir.path());
    assert!(files.contains_key("notes.txt"));
    assert!(files.contains_key("run02-rigid-velocity-verlet.csv"));
    assert!(!files.keys().any(|n| n.starts_with("run04")));
    assert!(!files.contains_key("mesh.svg"));
    assert!(!files.contains_key("flanks.svg"));
    assert!(!files.keys().any(|n| n.starts_with(".staging")));
}

#[test]
fn bare_and_broken_records() {
    let dir = tempfile::tempdir().unwrap();
    write_results(dir.path(), &Results::default()).unwrap();
    let mut failed = made_up::impact_results();
    failed.references.clear();
    for run in &mut failed.runs {
        run.status = Status::Timeout;
        run.series = None;
        run.metrics.clear();
    }
    write_results(dir.path(), &failed).unwrap();
    assert!(contents(dir.path())[PAGE].contains("None of the 18 runs reached a usable end."));

    fs::write(dir.path().join(RECORD), "{ \"schema\": 99 }").unwrap();
    let e = load_results(dir.path()).unwrap_err().to_string();
    assert!(e.contains("schema 99") && e.contains(RECORD), "{e}");
    fs::write(dir.path().join(RECORD), "{ \"schema\": 1,\n \"scene\": 3 }").unwrap();
    let e = load_results(dir.path()).unwrap_err().to_string();
    assert!(e.contains("line 2"), "{e}");

    let mut unequal = made_up::impact_results();
    if let Some(series) = &mut unequal.runs[1].series {
        series.columns[1].values.pop();
    }
    let e = write_results(dir.path(), &unequal).unwrap_err().to_string();
    assert!(
        e.contains("run 2 (rigid, velocity-verlet)") && e.contains("speed_pinion_rad_s"),
        "{e}"
    );
}

/// Records of schema 1 are read: a stored one gives a page, and a study of penalties has its runs as a table.
#[test]
fn records_of_schema_1_are_read() {
    let stored = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../validation/results/choose_refined.json"
    );
    assert!(
        fs::read_to_string(stored)
            .unwrap()
            .contains("\"schema\": 1")
    );
    let read = gearbench_reports::load_results(Path::new(stored)).unwrap();
    let gearbench_reports::Part::Tabular(table) = &read.part else {
        panic!("{}", read.study_name());
    };
    assert!(table.rows.len() > 20);

    let dir = tempfile::tempdir().unwrap();
    let run = |penalty: Option<f64>, peak: f64| {
        serde_json::json!({"model": "elastic", "integrator": "trigonometric", "status": "converged", "steps": 9,
            "rejected": 0, "force_evaluations": 9, "newton_iterations": 0, "factorisations": 0, "dofs": 4,
            "penalty_pa_per_m": penalty, "metrics": [{"against": "hard", "peak_force_n": peak}]})
    };
    let old = serde_json::json!({"schema": 1, "study": "penalty", "scene": "s", "command": "gearbench penalty s",
        "machine": {}, "commit": "", "created": "2026-01-01T00:00:00Z", "references": [],
        "runs": [run(Some(1e14), 900.0), run(Some(1e15), 1090.0), run(None, 1100.0)]});
    fs::write(dir.path().join(RECORD), old.to_string()).unwrap();
    report_from(dir.path()).unwrap();
    let csv = fs::read_to_string(dir.path().join("penalty.csv")).unwrap();
    assert!(
        csv.lines().count() == 4 && csv.contains("1.090000000e3"),
        "{csv}"
    );
    assert!(
        fs::read_to_string(dir.path().join("penalty.svg"))
            .unwrap()
            .contains("hard contact")
    );
}

/// A record of a planetary set of a former version, whose first mesh and first two gears have columns without names, is
/// read with their names, and so is the same record of schema 1.
#[test]
fn columns_without_gears_are_named() {
    let stored = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/former/carrier.json");
    let text = fs::read_to_string(stored).unwrap();
    let former: serde_json::Value = serde_json::from_str(&text).unwrap();
    let dir = tempfile::tempdir().unwrap();
    for text in [text.clone(), text.replace("\"schema\": 2", "\"schema\": 1")] {
        fs::write(dir.path().join(RECORD), text).unwrap();
        let record = load_results(dir.path()).unwrap();
        let names: Vec<&str> = record
            .settings
            .iter()
            .map(|(name, _)| name.as_str())
            .collect();
        assert_eq!(names[..2], ["simulated time", "gear sun"]);
        assert!(
            record.references[0]
                .series
                .column("contact_force_sun_p1_n")
                .is_some()
        );
        let (run, old) = (&record.runs[0], &former["runs"][0]);
        let series = run.series.as_ref().unwrap();
        let forces: Vec<&str> = series.all_of(CONTACT_FORCE).map(|(mesh, _)| mesh).collect();
        assert_eq!(forces, ["sun_p1", "sun_p2", "p1_ring", "p2_ring"]);
        let speeds: Vec<&str> = series.all_of(SPEED).map(|(gear, _)| gear).collect();
        assert_eq!(speeds, ["sun", "p1", "p2", "ring"]);
        let force: Vec<f64> =
            serde_json::from_value(old["series"]["contact_force_n"].clone()).unwrap();
        assert_eq!(series.of(CONTACT_FORCE, "sun_p1"), Some(&force[..]));
        for name in [
            "transmission_error_sun_p1_m",
            "mesh_cycle_sun_p1",
            "speed_ratio_error_sun_p1",
            "speed_ratio_error_p1_ring",
            "transverse_force_sun_p1_n",
            "transverse_force_sun_p2_n",
        ] {
            assert!(series.column(name).is_some(), "{name}");
        }
        let last = &run.metrics[0].speeds_end;
        let gears: Vec<&str> = last.iter().map(|(gear, _)| gear.as_str()).collect();
        assert_eq!(gears, ["sun", "p1"]);
        assert_eq!(Some(last[1].1), old["metrics"][0]["omega2_end"].as_f64());
        report_from(dir.path()).unwrap();
        let files = contents(dir.path());
        assert!(files["runs.csv"].contains("speed_end_p1_rad_s"));
        assert!(files["force.svg"].contains("p2 - ring"));
        // What is read is a record of this version.
        write_results(dir.path(), &record).unwrap();
        assert_eq!(load_results(dir.path()).unwrap().runs[0].series, run.series);
    }
}
