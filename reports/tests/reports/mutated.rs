//! Reports of records of every study that were edited at random: the report is written, or the record is refused with
//! its file and the place in it; there is no panic.

use crate::{contents, has_only_numbers, made_up, modes, pages, precision, trains, written};
use gearbench_reports::check::{
    CheckRecord, CheckedEntry, Finding, Kind, MeasuredEntry, Stored, Trend, Verdict,
};
use gearbench_reports::response::{
    GroupResponse, MeshLimit, MeshPoint, ModelResponse, MountPoint, ResponsePoint, ResponseRecord,
};
use gearbench_reports::scan::{
    FailureCount, SampleDesign, SampleStatistics, ScanAxis, ScanConfiguration, ScanRecord,
    SensitivityIndex, ShownRow,
};
use gearbench_reports::stiffness::{
    LinePressure, ModelStiffness, PairLoad, StiffnessPosition, StiffnessRecord,
};
use gearbench_reports::store::{RECORD, ReportError};
use gearbench_reports::studies::Study;
use gearbench_reports::{Part, Results, report_from};
use serde_json::{Value, json};
use std::fs;
use std::panic::catch_unwind;

/// Number of edits of each record in an ordinary run of the tests; `GEARBENCH_EDITS` sets another one.
const EDITS: u64 = 60;

/// SplitMix64 random numbers (Steele, Lea and Flood, OOPSLA 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

/// Makes a frequency response of two models, one of which has none.
pub fn response_results() -> Results {
    let mesh = |name: &str| MeshLimit {
        name: name.into(),
        force_n: 2700.0,
        stiffness_n_per_m: 2.7e8,
        stiffness_range_n_per_m: [2.4e8, 3.0e8],
        error_rms_m: 5e-7,
        error_peak_to_peak_m: 2e-6,
        error_harmonics_m: vec![6e-7, 1e-7],
    };
    let point = |i: u32| {
        let f = 500.0 + 100.0 * f64::from(i);
        let amplitude = 5e-7 / ((1.0 - (f / 2500.0).powi(2)).abs() + 0.05);
        let of_mesh = MeshPoint {
            error_rms_m: amplitude,
            error_peak_to_peak_m: 3.0 * amplitude,
            error_harmonics_m: vec![1.2 * amplitude, 0.1 * amplitude],
            force_rms_n: 2e8 * amplitude,
            force_least_n: 2700.0 - 5e8 * amplitude,
            force_greatest_n: 2700.0 + 5e8 * amplitude,
        };
        let mount = MountPoint {
            rms_n: 1e8 * amplitude,
            harmonics_n: vec![1.1e8 * amplitude],
        };
        ResponsePoint {
            mesh_frequency_hz: f,
            meshes: vec![of_mesh.clone(), of_mesh],
            mounts: vec![mount],
        }
    };
    let response = ModelResponse {
        label: "rigid".into(),
        coordinates: 4,
        groups: vec![GroupResponse {
            own_frequency_hz: 1000.0,
            meshes: vec![mesh("sun - planet"), mesh("planet - ring")],
            mounts: vec!["ring".into()],
            resonance_hz: Some(2500.0),
            resonance_range_hz: Some([2200.0, 2700.0]),
            points: (0..40).map(point).collect(),
        }],
        ..ModelResponse::default()
    };
    let none = ModelResponse {
        label: "elastic".into(),
        message: "no equilibrium was found".into(),
        ..ModelResponse::default()
    };
    Results {
        part: Part::Response(ResponseRecord {
            responses: vec![response, none],
        }),
        ..Results::default()
    }
}

/// Makes a regression check with a quantity of every kind.
pub fn check_results() -> Results {
    let finding = |kind: Kind, verdict: Verdict| Finding {
        kind,
        what: "peak_force_n".into(),
        allowed: "1e-6 of it".into(),
        change: Some(0.01),
        verdict,
        ..Finding::default()
    };
    let kinds = Kind::ALL.into_iter().zip(Verdict::ALL.into_iter().cycle());
    let entry = CheckedEntry {
        measured: MeasuredEntry {
            case: "impact".into(),
            scene: "spur_impact".into(),
            model: "rigid".into(),
            method: "dopri5@1e-6".into(),
            metrics: [("peak_force_n".to_owned(), 3612.3)].into(),
            work: [("steps".to_owned(), 1234)].into(),
            runtime: Some(1.5),
            ..MeasuredEntry::default()
        },
        findings: kinds.map(|(k, v)| finding(k, v)).collect(),
    };
    let part = CheckRecord {
        file: "check.toml".into(),
        stored: Some(Stored {
            baseline: 3,
            ..Stored::default()
        }),
        entries: vec![entry],
        quantity: "peak_force_n".into(),
        history: vec![Trend {
            entry: "impact / rigid / dopri5@1e-6".into(),
            points: vec![(1, 3600.0), (2, 3605.0), (4, 3612.3)],
        }],
    };
    Results {
        part: Part::Check(part),
        ..Results::default()
    }
}

/// Makes a stiffness study of two models over a mesh cycle, one of which has no equilibrium.
pub fn stiffness_results() -> Results {
    let position = |i: u32| StiffnessPosition {
        path_coordinate_m: 0.012 * (f64::from(i) / 8.0 - 0.5),
        error_m: 1e-5 * (1.0 + 0.1 * f64::from(i % 3)),
        force_n: 3000.0,
        tangent_n_per_m: 3e8,
        pairs: (0..=i64::from(i % 2))
            .map(|offset| PairLoad {
                offset,
                force_n: 3000.0 / f64::from(i % 2 + 1),
            })
            .collect(),
        pressure: (i > 2).then_some(LinePressure {
            half_width_m: 1e-4,
            peak_pa: 1e9,
        }),
    };
    let solved = ModelStiffness {
        label: "rigid".into(),
        includes: "constant".into(),
        limits: vec!["made up".into()],
        force_n: 3000.0,
        face_width_m: 0.01,
        base_pitch_m: 0.012,
        pitch_point_m: 0.001,
        path_m: [-0.008, 0.009],
        single_stiffness_n_per_m2: 1.4e10,
        at_pitch_point_n_per_m2: 1.4e10,
        mesh_stiffness_n_per_m2: 2e10,
        mesh_tangent_n_per_m2: 2.1e10,
        error_mean_m: 1.1e-5,
        error_peak_to_peak_m: 2e-6,
        positions: (0..8).map(position).collect(),
        ..ModelStiffness::default()
    };
    let lost = ModelStiffness {
        label: "elastic".into(),
        message: "no approach carries the load".into(),
        ..ModelStiffness::default()
    };
    Results {
        part: Part::Stiffness(StiffnessRecord {
            stiffness: vec![solved, lost],
        }),
        ..Results::default()
    }
}

/// A study of stiffness has a record, a page and tables as the others have.
#[test]
fn stiffness_has_a_page() {
    let files = written(&stiffness_results());
    crate::holds(
        &files,
        &[
            "stiffness.svg",
            "stiffness.csv",
            "cycle_rigid.csv",
            "runs.csv",
        ],
    );
    has_only_numbers(&files);
    let found = crate::finding(&files["index.html"]);
    for words in [
        "3\u{a0}kN",
        "300\u{a0}N/mm",
        "20.0",
        "2.00\u{a0}\u{b5}m",
        "no approach",
    ] {
        assert!(found.contains(words), "{words} in {found}");
    }
    let cycle = &files["cycle_rigid.csv"];
    assert_eq!(cycle.lines().count(), 1 + 8);
    assert!(
        cycle
            .lines()
            .next()
            .unwrap()
            .ends_with("force_pair_0_n,force_pair_1_n,contact_half_width_m,contact_pressure_pa")
    );
    assert!(!files.contains_key("cycle_elastic.csv"));
    assert_eq!(files["runs.csv"], files["stiffness.csv"]);
}

/// Every study has `runs.csv` with a row per run, its errors against each reference and its work.
#[test]
fn every_study_has_a_table_of_its_runs() {
    for results in records() {
        let files = written(&results);
        let table = &files["runs.csv"];
        assert!(table.lines().count() > 1, "{}", results.study());
    }
    let results = precision::results();
    let files = written(&results);
    let mut lines = files["runs.csv"].lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    for column in [
        "run",
        "model",
        "force_l2_aligned_against_fe",
        "wall_s",
        "force_evaluations",
    ] {
        assert!(header.contains(&column), "{column} in {header:?}");
    }
    assert_eq!(lines.count(), results.runs.len());
    // A column that no run has a value for is left out.
    assert!(!header.contains(&"mesh_frequency_hz"));
    let sweep = written(&made_up::sweep_results());
    let header = sweep["runs.csv"].lines().next().unwrap().to_owned();
    assert!(
        header.contains(",mesh_frequency_hz,") && header.contains(",force_peak_n,"),
        "{header}"
    );
}

/// Returns a record of every study.
/// Makes a scan of a listed and a random axis by two models, one of which fails in some cells.
fn scan_results() -> Results {
    let axis = |key: &str, values: &[&str], distribution: Option<&str>| ScanAxis {
        keys: vec![key.into()],
        values: values.iter().map(|v| (*v).into()).collect(),
        distribution: distribution.map(str::to_owned),
    };
    let configuration = |label: &str| ScanConfiguration {
        label: label.into(),
        integrator: "dopri5 at 1e-6".into(),
    };
    let statistics = |at: usize| SampleStatistics {
        at: vec![at, 0],
        count: 4,
        missing: 1,
        mean: 2500.0,
        deviation: 100.0,
        quantiles: [2000.0, 2100.0, 2300.0, 2500.0, 2700.0, 2900.0, 3000.0],
        ..SampleStatistics::default()
    };
    let index = |axis: usize| SensitivityIndex {
        at: vec![0, 0],
        axis,
        first: [0.3, 0.2, 0.4],
        total: [0.5, 0.4, 0.6],
        ..SensitivityIndex::default()
    };
    let shown = |i: u32| ShownRow {
        cell: u64::from(i) + 1,
        at: vec![i as usize / 4, 0],
        values: vec![Some(20.0 + f64::from(i / 4)), Some(0.2 * f64::from(i % 4))],
        outputs: vec![(i != 3).then_some(2000.0 + 100.0 * f64::from(i))],
        ..ShownRow::default()
    };
    Results {
        part: Part::Scan(Box::new(ScanRecord {
            axes: vec![
                axis("gears.pinion.speed_rad_s", &["20", "21"], None),
                axis("gears.wheel.bore_radius_m", &[], Some("uniform(0,1)")),
            ],
            samples: Some(SampleDesign {
                samples: 4,
                seed: 1,
                variants: 1,
                ..SampleDesign::default()
            }),
            cells: 8,
            outputs: vec!["peak_force_n".into()],
            configurations: vec![configuration("rigid"), configuration("elastic")],
            failures: vec![FailureCount {
                configuration: 1,
                status: gearbench_reports::Status::Refused,
                count: 1,
                first_cell: 4,
                message: "made up".into(),
            }],
            statistics: [0, 1].map(statistics).to_vec(),
            indices: [0, 1].map(index).to_vec(),
            shown: (0..8).map(shown).collect(),
            ..ScanRecord::default()
        })),
        ..Results::default()
    }
}

fn records() -> Vec<Results> {
    let mut compare = made_up::impact_results();
    compare.runs.truncate(4);
    let mut sweep = made_up::sweep_results();
    sweep.runs.retain(|r| r.wall_s > 0.0);
    vec![
        compare,
        trains::trains(),
        sweep,
        made_up::penalty_results(),
        made_up::identify_results(),
        precision::results(),
        pages::stability(),
        pages::choose(),
        modes::of_models(),
        trains::run_up(),
        response_results(),
        check_results(),
        stiffness_results(),
        scan_results(),
    ]
}

/// Collects the places of a record as JSON pointers; of a long list its ends and some entries between.
fn places(value: &Value, at: &str, all: &mut Vec<String>) {
    let mut child = |key: String, value: &Value| {
        let at = format!("{at}/{}", key.replace('~', "~0").replace('/', "~1"));
        all.push(at.clone());
        places(value, &at, all);
    };
    match value {
        Value::Object(map) => map.iter().for_each(|(k, v)| child(k.clone(), v)),
        // Ends of a list and some between: histories would have all edits otherwise.
        Value::Array(list) => {
            let every = (list.len() / 8).max(1);
            let chosen = list.iter().enumerate().step_by(every);
            chosen.for_each(|(i, v)| child(i.to_string(), v));
        }
        _ => {}
    }
}

/// Returns a number, or null, to replace the number `old`.
fn number(old: f64, random: &mut Random) -> Value {
    let all = [
        json!(0),
        json!(-1),
        json!(1),
        json!(0.0),
        json!(-old),
        json!(1e-3 * old),
        json!(1e6 * old),
        json!(5e-324),
        json!(1e-300),
        json!(1e300),
        json!(-1e300),
        json!(f64::MAX),
        json!(1u64 << 63),
        json!(u64::MAX),
        json!(u32::MAX),
        Value::Null,
    ];
    all[random.below(all.len())].clone()
}

/// Edits one random place of a record and returns its path.
fn edit(record: &mut Value, random: &mut Random) -> String {
    let mut all = Vec::new();
    places(record, "", &mut all);
    // The content first: a record of another schema or study is refused before it is read.
    let at = all[random.below(all.len())].clone();
    let other = record.pointer(&all[random.below(all.len())]).cloned();
    let whole = random.below(8) == 0;
    let Some(place) = record.pointer_mut(&at) else {
        return at;
    };
    match place {
        _ if whole => *place = other.unwrap_or_default(),
        Value::Number(old) => *place = number(old.as_f64().unwrap_or(0.0), random),
        Value::String(text) => {
            *text = match random.below(5) {
                0 => String::new(),
                1 => "x".repeat(300),
                2 => format!("{text}\u{0}\u{1b}[31m\n::error::|`<b>"),
                3 => "=1+1".into(),
                _ => text.chars().rev().collect(),
            }
        }
        Value::Array(list) => match random.below(4) {
            0 => list.clear(),
            1 => list.truncate(list.len() / 2),
            2 => list.extend(list.last().cloned()),
            _ => list.reverse(),
        },
        Value::Object(map) => {
            let keys: Vec<String> = map.keys().cloned().collect();
            if let Some(key) = keys.get(random.below(keys.len())) {
                map.remove(key);
            }
        }
        other => *other = Value::Null,
    }
    at
}

#[test]
fn an_edited_record_is_reported_or_refused() {
    let edits = std::env::var("GEARBENCH_EDITS").ok();
    let edits = edits.and_then(|n| n.parse().ok()).unwrap_or(EDITS);
    let all = records();
    for study in Study::ALL {
        assert!(
            all.iter().any(|r| r.study() == study),
            "no record of {study}"
        );
    }
    let dir = tempfile::tempdir().unwrap();
    let (mut reported, mut refused) = (0, 0);
    let mut failures: Vec<String> = Vec::new();
    for results in &all {
        let good: Value = serde_json::from_str(&written(results)[RECORD]).unwrap();
        for seed in 0..edits {
            let mut random = Random(seed);
            let mut record = good.clone();
            let mut edited = Vec::new();
            for _ in 0..=random.below(3) {
                edited.push(edit(&mut record, &mut random));
            }
            let name = format!("{}, seed {seed}, {edited:?}", results.study());
            let path = dir.path().to_owned();
            fs::write(path.join(RECORD), record.to_string()).unwrap();
            match catch_unwind(|| report_from(&path)) {
                Ok(Ok(_)) => {
                    reported += 1;
                    let files = contents_but_record(&path);
                    if catch_unwind(|| has_only_numbers(&files)).is_err() {
                        failures.push(format!("no number: {name}"));
                    }
                }
                Ok(Err(e @ ReportError::Record { .. })) => {
                    refused += 1;
                    if !e.to_string().contains(RECORD) {
                        failures.push(format!("no file: {name}: {e}"));
                    }
                }
                Ok(Err(e)) => failures.push(format!("{name}: {e}")),
                Err(_) => failures.push(format!("panic: {name}")),
            }
            for file in fs::read_dir(&path).unwrap() {
                fs::remove_file(file.unwrap().path()).unwrap();
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    // Both happen often, or the edits are of no use.
    assert!(
        reported > refused / 4 && refused > reported / 20,
        "{reported}, {refused}"
    );
}

fn contents_but_record(dir: &std::path::Path) -> std::collections::BTreeMap<String, String> {
    let mut files = contents(dir);
    files.remove(RECORD);
    files
}

/// A refused record is reported with the place of the error and the expected value.
#[test]
fn lists_of_unequal_length_are_refused_with_their_place() {
    let refusal = |results: &Results, place: &str, to: Value| {
        let mut record: Value = serde_json::from_str(&written(results)[RECORD]).unwrap();
        *record
            .pointer_mut(place)
            .unwrap_or_else(|| panic!("{place}")) = to;
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join(RECORD), record.to_string()).unwrap();
        report_from(dir.path()).unwrap_err().to_string()
    };
    let modes = modes::of_models();
    let e = refusal(&modes, "/vibrations/0/modes/1/shape", json!([]));
    assert!(
        e.contains("vibrations[0].modes[1].shape has 0 entries, expected 2 as `members`"),
        "{e}"
    );
    let e = refusal(
        &response_results(),
        "/responses/0/groups/0/points/3/meshes",
        json!([]),
    );
    assert!(e.contains("responses[0].groups[0].points[3].meshes"), "{e}");
    let e = refusal(
        &response_results(),
        "/responses/0/groups/0/meshes",
        json!([]),
    );
    assert!(e.contains("responses[0].groups[0].meshes is empty"), "{e}");
    let grid = "/runs/0/contacts/flanks/0/over_run/columns";
    let e = refusal(&made_up::impact_results(), grid, json!(0));
    assert!(e.contains("contacts.flanks[0].over_run"), "{e}");
    let own = "/maps/0/axes/0/own";
    let e = refusal(&pages::stability(), own, json!(99));
    assert!(e.contains("maps[0].axes[0].own is 99"), "{e}");
    let e = refusal(
        &made_up::impact_results(),
        "/runs/3/series/columns/0/values",
        json!([]),
    );
    assert!(
        e.contains("series: column contact_force_pinion_wheel_n has 0 samples"),
        "{e}"
    );
    let e = refusal(
        &made_up::sweep_results(),
        "/runs/2/steady/position",
        json!([0.1]),
    );
    assert!(e.contains("steady.error_cycle_m"), "{e}");
}

/// Each mesh has its own chart even if meshes have the same name, in one group or in two.
#[test]
fn entries_of_one_name_have_files_of_their_own() {
    let mut results = response_results();
    let Part::Response(part) = &mut results.part else {
        panic!("a response")
    };
    let groups = &mut part.responses[0].groups;
    groups.push(groups[0].clone());
    groups[1].meshes[1].name = "sun / planet".into();
    let files = written(&results);
    for name in [
        "response_sun-planet.svg",
        "response_sun-planet_2.svg",
        "response_sun-planet_3.svg",
        "response_planet-ring.svg",
    ] {
        assert!(files.contains_key(name), "{name}");
    }
}

/// Records with extreme numbers, which once caused an endless loop or a panic, have a report.
#[test]
fn numbers_at_the_ends_of_their_range_have_a_report() {
    for (results, place, to) in [
        (
            made_up::sweep_results(),
            "/runs/2/steady/mesh_frequency_hz",
            json!(0),
        ),
        (pages::stability(), "/maps/0/set", json!(1u64 << 63)),
        (pages::choose(), "/choice/tried/0/error", json!(5e-324)),
        (pages::choose(), "/choice/tried/0/cost_s", json!(5e-324)),
        (precision::results(), "/rows/0/cpu_s", json!(5e-324)),
        (
            precision::results(),
            "/rows/0/force_l2_aligned",
            json!(5e-324),
        ),
    ] {
        let mut record: Value = serde_json::from_str(&written(&results)[RECORD]).unwrap();
        *record
            .pointer_mut(place)
            .unwrap_or_else(|| panic!("{place}")) = to;
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join(RECORD), record.to_string()).unwrap();
        report_from(dir.path()).unwrap_or_else(|e| panic!("{place}: {e}"));
        has_only_numbers(&contents_but_record(dir.path()));
    }
}
