//! Tests of mutated scenes and records: for any content the program ends by itself, with a documented exit code, within
//! its memory limit and without a panic.
//!
//! A part runs with all other tests, in this process. The whole corpus of 2,000 runs the command, a process for each:
//!
//! ```text
//! cargo test --release --locked --workspace --test mutations -- --ignored --nocapture
//! ```
//!
//! `GEARBENCH_FROM=400` goes on with number 400, after a mend.

// Progress and the figures of the whole corpus are for whoever runs it.
#![expect(clippy::print_stdout)]

mod generator;

use gearbench::context::Context;
use gearbench::experiment::conditions::Conditions;
use gearbench::experiment::runner::Runner;
use gearbench::scene_file::{Origin, SceneFile};
use gearbench::studies::compare::{Plan, compare};
use gearbench_reports::{report_from, write_results};
use generator::Random;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const PAIR: &str = include_str!("../malformed/scene.toml");

/// A planetary set on a shaft with an elastic pinion on a bearing: the parts of the format that the pair has not.
const PLANETS: &str = r#"schema = 1
name = "planets"
duration_s = 1e-4
gears.sun = { teeth = 20, module_m = 2e-3, face_width_m = 0.01, bore_radius_m = 0.008, thinning_m = 30e-6, position_m = [0.0, 0.0], speed_rad_s = 100.0, loads = [{ torque_nm = 30.0 }] }
gears.p1 = { teeth = 28, module_m = 2e-3, face_width_m = 0.01, bore_radius_m = 0.01, thinning_m = 30e-6 }
gears.ring = { teeth = 76, module_m = 2e-3, face_width_m = 0.01, internal = true, addendum_factor = 0.85, position_m = [0.0, 0.0], mount = "fixed" }
shafts = [{ name = "arm", carries = [{ body = "carrier", at_m = 0.0, inertia_kgm2 = 2e-3, planets = ["p1"], speed_rad_s = 20.833333333333332, loads = [{ torque_nm = -144.0 }] }] }]
meshes = [
  { gears = ["sun", "p1"], centre_distance_m = 0.048, direction_deg = 0 },
  { gears = ["p1", "ring"] },
]
[[models]]
model = "rigid"
contact = { stiffness = "iso6336", damping = { law = "ratio-at-load", ratio = 0.06 } }
[study]
integrators = [{ method = "dopri5", rtol = 1e-6 }]
"#;

/// A helical pair on bearings and a rack would be further ones; shafts join two stages here.
const STAGES: &str = r#"schema = 1
name = "stages"
duration_s = 1e-4
gears.p1 = { teeth = 19, module_m = 2e-3, face_width_m = 0.01, bore_radius_m = 0.006, helix_angle_deg = 15.0, bearing = { stiffness = [2e8, 2e8, 1e8, 1e5, 1e5, 0.0], damping = [2e3, 2e3, 1e3, 10.0, 10.0, 0.0] } }
gears.w1 = { teeth = 53, module_m = 2e-3, face_width_m = 0.01, bore_radius_m = 0.015, helix_angle_deg = -15.0, tip_relief = { amount_m = 12e-6, start_radius_m = 0.0535 } }
gears.p2 = { teeth = 17, module_m = 3e-3, face_width_m = 0.01, bore_radius_m = 0.008, profile_shift = 0.2 }
gears.rack = { kind = "rack", teeth = 25, module_m = 3e-3, face_width_m = 0.01, mass_kg = 12.0, loads = [{ force_n = -185.0 }], speed_m_s = 0.54 }
shafts = [
  { name = "mid", carries = [{ gear = "w1", at_m = 0.0 }, { gear = "p2", at_m = 0.06 }], sections = [{ length_m = 0.06, diameter_m = 0.025 }], damping_ratio = 0.02, speed_rad_s = -20.0 },
]
meshes = [{ gears = ["p1", "w1"], backlash_m = 60e-6 }, { gears = ["p2", "rack"], backlash_m = 60e-6, direction_deg = 90 }]
[[models]]
model = "rigid"
contact = { stiffness = "compliance", damping = { law = "flores", e = 0.7 }, friction = { mu = 0.05, stick_m = 1e-6 } }
[[models]]
model = "movable-teeth"
contact = { stiffness = "iso6336" }
parameters = { tooth_stiffness_n_per_m = 7.8e8, tooth_mass_kg = 2e-3 }
[study]
integrators = [{ method = "rk4", step_s = 1e-6 }, { method = "newmark", step_s = 1e-6 }]
"#;

/// The pair under a constant torque in step, for studies of gears that run.
fn running() -> String {
    let wheel = "speed_rad_s = -13.333333333333334\nloads = [{ torque_nm = 1.5 }]";
    PAIR.replace("mount = \"revolute\"", wheel)
}

/// Studies of the scene of that place in [`base`]; all of them run on it as it is.
const STUDIES: [&[&str]; 4] = [
    &[
        "compare s.toml --repeats 1 --timeout 2",
        "compare s.toml --repeats 1 --timeout 2 --models elastic",
        "modes s.toml",
        "response s.toml --points 8",
        "stability s.toml --grid 3x2 --timeout 2",
        "coupling s.toml --timeout 2",
        "mesh s.toml",
        "precision s.toml --models rigid --steps 1us --rtols 1e-4 --timeout 2",
    ],
    &[
        "stiffness s.toml --positions 4",
        "sweep s.toml --points 2 --timeout 2",
        "run-up s.toml --timeout 2 --from 100 --to 200 --over 0.4",
        "choose s.toml --tolerance 0.1 --timeout 1 --budget 10",
    ],
    &[
        "compare s.toml --repeats 1 --timeout 2",
        "modes s.toml",
        "response s.toml --points 4",
        "stability s.toml --grid 3x2 --timeout 2",
        "mesh s.toml",
    ],
    &[
        "compare s.toml --repeats 1 --timeout 2",
        "modes s.toml",
        "response s.toml --points 2 --models rigid",
        "mesh s.toml",
    ],
];

fn base(place: usize) -> String {
    match place {
        0 => PAIR.into(),
        1 => running(),
        2 => PLANETS.into(),
        _ => STAGES.into(),
    }
}

/// The scene with a number, and its study: bases in turn, and of each its studies in turn.
fn case(number: usize) -> (String, &'static str) {
    let mut random = Random::new(number as u64);
    let place = number % STUDIES.len();
    let studies = STUDIES[place];
    let study = studies[number / STUDIES.len() % studies.len()];
    (generator::scene(&base(place), &mut random), study)
}

/// Lines of a scene that its base has not.
fn changes(number: usize) -> String {
    let (text, _) = case(number);
    let base = base(number % STUDIES.len());
    let new = text.lines().filter(|l| !base.lines().any(|b| b == *l));
    let gone = base.lines().filter(|b| !text.lines().any(|l| l == *b));
    let all = gone
        .map(|l| format!("- {l}"))
        .chain(new.map(|l| format!("+ {l}")));
    all.collect::<Vec<_>>().join("\n")
}

/// Reads a scene and compares its models without elements, up to a bound of steps.
fn compared(text: &str) -> Option<gearbench_reports::record::Results> {
    let file = SceneFile::unbuilt(
        &Context::default(),
        "mutated.toml",
        text,
        Origin::Shipped,
        false,
    )
    .ok()?;
    let choices: Vec<_> = (file.models.iter())
        .filter(|m| m.model == "rigid" || m.model == "movable-teeth")
        .collect();
    let plan = Plan::of(&file, &choices, &[]);
    let plan = Plan {
        conditions: Conditions {
            repeats: 0,
            max_steps: 300,
            samples: plan.conditions.samples.min(300),
            timeout: Duration::from_secs(5),
            ..plan.conditions
        },
        ..plan
    };
    compare(&plan, &Runner::default()).ok()
}

#[test]
fn mutated_scenes_do_not_panic() {
    let mut ran = 0;
    for number in 0..60 {
        let (text, _) = case(number);
        let done = catch_unwind(|| compared(&text));
        let done = done.unwrap_or_else(|_| panic!("scene {number}:\n{text}"));
        // A panic within a run is a row of the record.
        for run in done.iter().flat_map(|r| &r.runs) {
            let message = run.message.as_deref().unwrap_or_default();
            assert!(
                !message.contains("the program itself failed"),
                "scene {number}: {message}\n{text}"
            );
        }
        ran += usize::from(done.is_some());
    }
    assert!((5..60).contains(&ran), "{ran} of 60 scenes ran");
}

#[test]
fn mutated_records_do_not_panic() {
    let folder = tempfile::tempdir().unwrap();
    let results = compared(PAIR).expect("a record");
    write_results(folder.path(), &results).unwrap();
    let path = folder.path().join("results.json");
    let base = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    let mut drawn = 0;
    for number in 0..60 {
        let text = generator::record(&base, &mut Random::new(number));
        std::fs::write(&path, &text).unwrap();
        let done = catch_unwind(AssertUnwindSafe(|| report_from(folder.path()).is_ok()));
        let end = text.len().min(2000);
        drawn += usize::from(done.unwrap_or_else(|_| panic!("record {number}: {}", &text[..end])));
    }
    assert!((5..60).contains(&drawn), "{drawn} of 60 records were drawn");
}

/// The limit of memory of a run [GB], and how far the program may be above its own estimates.
const MEMORY: &str = "0.5";
const ABOVE: f64 = 1.5;
/// Memory of the program before it reads any input [GB].
const ITSELF: f64 = 0.1;
/// Time after which a process counts as one that hangs: far more than its own bounds, also on a busy machine.
const HANGS: Duration = Duration::from_secs(300);

/// Seconds above which a process is named with its time.
const SLOW: f64 = 20.0;

/// End of a process: exit code, memory, time and output.
struct ProcessEnd {
    code: Option<i32>,
    /// Greatest memory that was seen [GB].
    memory: f64,
    seconds: f64,
    said: String,
}

fn run(folder: &Path, arguments: &[&str]) -> ProcessEnd {
    let begin = Instant::now();
    let errors = folder.join("stderr");
    let mut child = Command::new(env!("CARGO_BIN_EXE_gearbench"))
        .args(arguments)
        .current_dir(folder)
        .env("GEARBENCH_CACHE", folder.join("cache"))
        .stdout(Stdio::null())
        .stderr(std::fs::File::create(&errors).unwrap())
        .spawn()
        .unwrap();
    let mut memory: f64 = 0.0;
    let code = loop {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id()));
        let most = status.ok().and_then(|s| {
            let line = s.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
            line.split_whitespace().next()?.parse::<f64>().ok()
        });
        memory = memory.max(1e-6 * most.unwrap_or(0.0));
        if let Some(ended) = child.try_wait().unwrap() {
            break ended.code();
        }
        if begin.elapsed() > HANGS {
            child.kill().unwrap();
            child.wait().unwrap();
            break None;
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    ProcessEnd {
        code,
        memory,
        seconds: begin.elapsed().as_secs_f64(),
        said: std::fs::read_to_string(errors).unwrap_or_default(),
    }
}

/// Numbers of a corpus, from the one that the environment names.
fn numbers() -> std::ops::Range<usize> {
    let from = std::env::var("GEARBENCH_FROM");
    from.map_or(0, |f| f.parse().expect("a whole number"))..1000
}

/// Counts the processes and their errors, and prints each error as it occurs.
#[derive(Default)]
struct Count {
    codes: std::collections::BTreeMap<i32, usize>,
    wrong: Vec<String>,
    done: usize,
    memory: f64,
    seconds: f64,
}

impl Count {
    /// Counts a process and returns true if it needs attention: a wrong end, or a slow one.
    fn add(&mut self, name: &str, ended: &ProcessEnd) -> bool {
        let before = self.wrong.len();
        let known = [0, 1, 2, 3, 130];
        let mut say = |what: String| {
            println!("{name}: {what}");
            self.wrong.push(format!("{name}: {what}"));
        };
        match ended.code {
            Some(code) if known.contains(&code) => *self.codes.entry(code).or_default() += 1,
            Some(code) => say(format!("ended with {code}: {}", ended.said)),
            None => say(format!("killed after {:.0} s", ended.seconds)),
        }
        if ended.said.contains("panicked at") {
            say(format!("panics: {}", ended.said));
        }
        let limit: f64 = MEMORY.parse().unwrap();
        if ended.memory > ABOVE * limit + ITSELF {
            say(format!("takes {:.2} GB", ended.memory));
        }
        let slow = ended.seconds > SLOW;
        if slow {
            println!("{name}: {:.0} s", ended.seconds);
        }
        self.memory = self.memory.max(ended.memory);
        self.seconds = self.seconds.max(ended.seconds);
        self.done += 1;
        if self.done.is_multiple_of(50) {
            self.describe("so far");
        }
        slow || self.wrong.len() > before
    }

    fn describe(&self, what: &str) {
        println!(
            "{} {what}: codes {:?}, {} wrong, at most {:.2} GB and {:.1} s",
            self.done,
            self.codes,
            self.wrong.len(),
            self.memory,
            self.seconds
        );
    }

    fn end(self, what: &str) {
        self.describe(what);
        assert!(self.wrong.is_empty(), "{}", self.wrong.join("\n"));
    }
}

/// A study with an output and the limit of memory.
fn arguments(study: &str) -> Vec<&str> {
    let out = match study.starts_with("mesh") {
        true => "o.inp",
        false => "o",
    };
    let all = study.split_whitespace();
    all.chain(["--memory", MEMORY, "--out", out]).collect()
}

/// Scenes that a study refuses as they are would hide from it whatever is changed in them.
#[test]
#[ignore = "two minutes"]
fn every_base_runs_in_its_studies() {
    for (place, studies) in STUDIES.iter().enumerate() {
        for study in *studies {
            let folder = tempfile::tempdir().unwrap();
            std::fs::write(folder.path().join("s.toml"), base(place)).unwrap();
            let ended = run(folder.path(), &arguments(study));
            // A run that the time limit ends has begun: nothing was refused.
            let did = matches!(ended.code, Some(0 | 1 | 3));
            assert!(did, "{place}, {study}: {:?}: {}", ended.code, ended.said);
        }
    }
}

#[test]
#[ignore = "half an hour"]
fn a_thousand_mutated_scenes() {
    let mut count = Count::default();
    for number in numbers() {
        let folder = tempfile::tempdir().unwrap();
        let (text, study) = case(number);
        std::fs::write(folder.path().join("s.toml"), text).unwrap();
        let ended = run(folder.path(), &arguments(study));
        if count.add(&format!("scene {number}, {study}"), &ended) {
            println!("{}", changes(number));
        }
    }
    count.end("scenes");
}

#[test]
#[ignore = "ten minutes"]
fn a_thousand_mutated_records() {
    let mut count = Count::default();
    let folder = tempfile::tempdir().unwrap();
    let mut bases = Vec::new();
    let running = running();
    let scenes = [
        ("compare", PAIR),
        ("modes", STAGES),
        ("response", STAGES),
        ("precision", PAIR),
        ("stability", PAIR),
        ("sweep", &running),
        ("coupling", PAIR),
        ("stiffness", &running),
    ];
    for (study, text) in scenes {
        std::fs::write(folder.path().join("s.toml"), text).unwrap();
        let more = match study {
            "sweep" => "--points 3",
            "stability" => "--grid 3x2",
            "precision" => "--models rigid",
            _ => "",
        };
        let command = format!("{study} s.toml --timeout 5 --out {study} {more}");
        let arguments = command.replace(
            "--timeout 5",
            match study {
                "modes" | "response" | "stiffness" => "",
                _ => "--timeout 5",
            },
        );
        let arguments: Vec<&str> = arguments.split_whitespace().collect();
        run(folder.path(), &arguments);
        let record = folder.path().join(study).join("results.json");
        match std::fs::read_to_string(record) {
            Ok(text) => bases.push((study, serde_json::from_str(&text).unwrap())),
            Err(e) => println!("no record of {study}: {e}"),
        }
    }
    assert_eq!(bases.len(), scenes.len(), "studies with a record");
    for number in numbers() {
        let (study, base) = &bases[number % bases.len()];
        let text = generator::record(base, &mut Random::new(number as u64));
        let place = folder.path().join("mutated");
        std::fs::create_dir_all(&place).unwrap();
        std::fs::write(place.join("results.json"), text).unwrap();
        let ended = run(folder.path(), &["report", "mutated", "--memory", MEMORY]);
        count.add(&format!("record {number} of {study}"), &ended);
        std::fs::remove_dir_all(&place).unwrap();
    }
    count.end("records");
}
