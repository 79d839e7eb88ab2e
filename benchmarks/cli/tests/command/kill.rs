//! Tests that a study that is killed repeatedly and resumed equals an undisturbed one, except for times.

use super::{Folder, stdout};
use gearbench::experiment::journal::JOURNAL;
use gearbench_reports::record::OF_THE_CLOCK;
use serde_json::Value;
use std::process::{Child, Stdio};
use std::time::Duration;

/// Number of kills of one study.
const KILLS: usize = 20;
/// Seed of the random moments of the kills.
const SEED: u64 = 0x6765_6172_2d6b_696c;

/// Studies whose pieces take some milliseconds each.
const QUICK: [&str; 6] = [
    "stability spur_rotation --models rigid --integrators velocity-verlet,rk4,newmark \
     --axis contact-stiffness=0.1:100:6 --steps 5e-7:2e-4:10 --duration 2e-3 --threads 2",
    "compare spur_impact --models rigid,rigid-iso6336,movable-teeth --repeats 1",
    "precision spur_impact --models rigid,rigid-iso6336 --integrators velocity-verlet,rk4,dopri5",
    "sweep loaded_mesh --models rigid --from 1000 --to 3000 --points 24 --cycles 4",
    "identify spur_impact --model rigid",
    "scan spur_impact --models rigid,movable-teeth --vary gears.pinion.speed_rad_s=uniform(10,100) --samples 600 --threads 2",
];
/// Studies that reduce finite elements first, or run them.
const SLOW: [&str; 3] = [
    "penalty spur_impact --points 9 --positions 4",
    "truncation spur_impact --counts 10,20,30,40 --no-refine --repeats 1",
    "choose spur_impact --metric peak --tolerance 0.05",
];

/// Studies of a loaded scene with several models, each of which is a piece.
const BY_MODEL: [&str; 3] = [
    "run-up m.toml --models rigid,a,b,movable-teeth --from 200 --to 900 --over 0.05 --samples 8192",
    "response m.toml --models rigid,a,b,movable-teeth --points 20",
    "modes m.toml --models rigid,a,b,movable-teeth",
];
/// Points on which several runs of one model are compared.
const COUPLING: &str = "coupling spur_impact --models rigid --steps 1e-6:6.4e-5:7 --threads 1";

/// The loaded scene with two more models.
fn several_models(folder: &Folder) {
    folder.says("init loaded_mesh --out m.toml");
    let scene = folder.read("m.toml");
    let mut models = String::new();
    for (label, stiffness) in [("a", "1.5e10"), ("b", "2.1e10")] {
        models.push_str(&format!(
            "[[models]]\nlabel = \"{label}\"\nmodel = \"rigid\"\ncontact = {{ stiffness = {{ kind = \"constant\", \
             stiffness_n_per_m2 = {stiffness} }} }}\n"
        ));
    }
    folder.write(
        "m.toml",
        &scene.replacen("[study]", &format!("{models}\n[study]"), 1),
    );
}

/// Keys of the record that depend on measured times, or on the place of the files.
const BY_THE_CLOCK: [&str; 5] = ["record", "report", "tried", "chosen", "cheapest"];

/// Returns the answer and the record of a study without entries that depend on the clock.
fn without_clock(mut value: Value) -> Value {
    match &mut value {
        Value::Object(map) => {
            OF_THE_CLOCK.iter().chain(&BY_THE_CLOCK).for_each(|key| {
                map.remove(*key);
            });
            for v in map.values_mut() {
                *v = without_clock(v.take());
            }
        }
        Value::Array(all) => all.iter_mut().for_each(|v| *v = without_clock(v.take())),
        _ => {}
    }
    value
}

/// Starts a study whose answer is read, or that is to be killed.
pub(super) fn start(folder: &Folder, study: &str, read: bool) -> Child {
    let mut command = folder.command(&format!("{study} --out here --json"));
    // Nobody empties the pipe of a study that is to be killed.
    let to = if read { Stdio::piped } else { Stdio::null };
    command.stdout(to()).stderr(to());
    command.spawn().unwrap()
}

/// Runs a study to its end and returns its answer and its record.
pub(super) fn finish(folder: &Folder, study: &str) -> [Value; 2] {
    let out = start(folder, study, true).wait_with_output().unwrap();
    // The JSON object has absolute paths.
    let text = stdout(&out).replace(&folder.path().display().to_string(), "");
    let answer: Value = serde_json::from_str(&text)
        .unwrap_or_else(|e| panic!("{study}: {e}: {}{}", stdout(&out), super::stderr(&out)));
    let record = std::fs::read_to_string(folder.at("here/results.json")).ok();
    let record = record.map_or(Value::Null, |text| serde_json::from_str(&text).unwrap());
    assert!(
        !folder.at("here").join(JOURNAL).exists(),
        "{study}: the journal has served"
    );
    super::as_documented(&folder.at("here"));
    [answer, record].map(without_clock)
}

/// Returns the number of whole lines of a journal, which may not exist.
pub(super) fn lines(folder: &Folder) -> usize {
    let bytes = std::fs::read(folder.at("here").join(JOURNAL)).unwrap_or_default();
    bytes.iter().filter(|b| **b == b'\n').count()
}

/// Parts of 1, evenly distributed (xorshift64*, Vigna 2016).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11;
        bits as f64 / (1_u64 << 53) as f64
    }
}

/// Kills a study at random until it has ended, at most `kills` times, and compares it with an undisturbed one. Returns
/// the number of kills that left it unfinished with more pieces than it began with.
fn killed_and_resumed(study: &str, kills: usize) -> usize {
    killed_by_pieces(study, kills, 3.0)
}

/// Kills a study after one to `more` further pieces of its journal, until it has ended, and compares it with an
/// undisturbed one.
fn killed_by_pieces(study: &str, kills: usize, more: f64) -> usize {
    let (mut whole, mut killed) = (Folder::new(), Folder::new());
    (whole.cached, killed.cached) = (true, true);
    for folder in [&whole, &killed] {
        several_models(folder);
    }
    let wanted = finish(&whole, study);
    let mut random = Random(SEED);
    let mut progressed = 0;
    for kill in 0..kills {
        let before = lines(&killed);
        let mut child = start(&killed, study, false);
        // By the lines of the journal, not by a clock: each start gets one to three pieces done, the first of them often
        // torn.
        let at = before.max(1) + 1 + (more * random.next()) as usize;
        while lines(&killed) < at && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_micros(200));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let after = lines(&killed);
        if after == 0 {
            break;
        }
        assert!(after >= before, "{study}: kill {kill} lost finished pieces");
        progressed += usize::from(after > before.max(1));
    }
    let resumed = finish(&killed, study);
    for (a, b) in resumed.iter().zip(&wanted) {
        assert_eq!(a, b, "{study}");
    }
    progressed
}

#[test]
fn killed_twenty_times_and_resumed_a_study_is_the_same() {
    for study in QUICK {
        let progressed = killed_and_resumed(study, KILLS);
        assert!(
            progressed >= 5,
            "{study}: {progressed} kills fell into work"
        );
    }
}

/// Few pieces: after every one of them the study is killed.
#[test]
fn killed_after_every_piece_and_resumed_a_study_is_the_same() {
    for study in BY_MODEL {
        let progressed = killed_by_pieces(study, 4, 0.0);
        assert!(
            progressed >= 2,
            "{study}: {progressed} kills fell into work"
        );
    }
    let progressed = killed_and_resumed(COUPLING, KILLS);
    assert!(
        progressed >= 3,
        "{COUPLING}: {progressed} kills fell into work"
    );
}

/// Takes some minutes: `cargo test --release -p gearbench-cli --test command -- --ignored killed`.
#[test]
#[ignore = "runs finite elements again and again, some minutes"]
fn killed_twenty_times_and_resumed_a_slow_study_is_the_same() {
    for study in SLOW {
        let progressed = killed_and_resumed(study, KILLS);
        assert!(
            progressed >= 5,
            "{study}: {progressed} kills fell into work"
        );
    }
}

#[test]
fn the_folder_is_tried_before_the_first_run() {
    let folder = Folder::new();
    folder.write("file", "");
    // A run of hours, were it begun.
    let study = "compare spur_impact --models rigid --integrators rk4@1e-12 --timeout 100000 --out file/here";
    folder.refuses(study, &["file/here"]);
    assert_eq!(folder.files(), 1);
}

#[test]
fn a_record_is_run_again() {
    let folder = Folder::new();
    folder.says(
        "compare spur_impact --models rigid,elastic-own-mesh --integrators dopri5,bdf --out here",
    );
    let text = folder.read("here/results.json");
    // The scene of the record counts, whatever becomes of the file.
    let said = folder.says("rerun here --out again");
    super::has(&said, &["the same: all"]);
    assert_eq!(folder.read("here/results.json"), text);
    let record: serde_json::Value = serde_json::from_str(&text).unwrap();
    let runs = record["runs"].as_array().unwrap();
    let file = runs.iter().find_map(|r| r["files"][0].as_str()).unwrap();
    let csv = |at: &str| folder.read(&format!("{at}/{file}"));
    assert_eq!(csv("here"), csv("again"));
    let changed = text.replacen("\"steps\": ", "\"steps\": 1", 1);
    std::fs::write(folder.at("here/results.json"), changed).unwrap();
    let out = folder.ends("rerun here/results.json --out again", 1);
    super::has(&stdout(&out), &["/runs/0/steps"]);
    let before = text.replacen("\"source\"", "\"source_of_another_version\"", 1);
    std::fs::write(folder.at("here/results.json"), before).unwrap();
    folder.refuses(
        "rerun here",
        &[
            "does not contain its scene",
            "gearbench compare spur_impact",
        ],
    );
}
