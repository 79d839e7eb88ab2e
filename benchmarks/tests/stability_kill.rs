//! A stability map that is killed again and again and resumed equals the one that was left alone, byte for byte.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Kills of one map.
const KILLS: usize = 20;
/// Seed of their moments.
const SEED: u64 = 0x6765_6172_2d6b_696c;

/// A folder of its own, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("gearbench-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A quick map of rigid gears whose runs take some milliseconds each.
fn start(dir: &Path) -> Child {
    Command::new(env!("CARGO_BIN_EXE_gearbench"))
        .args(["stability", "spur_rotation", "--models", "rigid"])
        .args(["--integrators", "velocity-verlet,rk4,newmark"])
        .args(["--axis", "contact-stiffness=0.1:100:6"])
        .args(["--steps", "5e-7:2e-4:10", "--duration", "2e-3"])
        .args(["--threads", "2", "--out", "map"])
        .current_dir(dir)
        .env("NO_COLOR", "1")
        .env("GEARBENCH_CACHE", "off")
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn finish(child: Child) {
    let out = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.success(), "{said}");
}

fn read(dir: &Path, name: &str) -> Vec<u8> {
    std::fs::read(dir.join("map").join(name)).unwrap()
}

/// Finished runs of a journal by name, without their wall times; no run may stand there twice.
fn runs(dir: &Path) -> BTreeMap<String, String> {
    let text = String::from_utf8(read(dir, "journal.jsonl")).unwrap();
    let mut found = BTreeMap::new();
    for line in text.lines().skip(1) {
        let mut value: serde_json::Value = serde_json::from_str(line).unwrap();
        let object = value.as_object_mut().unwrap();
        assert!(object.remove("wall_s").is_some());
        let key = object["key"].as_str().unwrap().to_owned();
        let other = found.insert(key, value.to_string());
        assert!(other.is_none(), "a run was made twice: {line}");
    }
    found
}

/// Whole lines of a journal that is perhaps not there yet.
fn lines(dir: &Path) -> usize {
    let bytes = std::fs::read(dir.join("map/journal.jsonl")).unwrap_or_default();
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

#[test]
fn killed_twenty_times_and_resumed_it_is_the_same_to_the_byte() {
    let (whole, killed) = (Folder::new("map-whole"), Folder::new("map-killed"));
    let begin = Instant::now();
    finish(start(&whole.0));
    let length = begin.elapsed();
    let wanted = runs(&whole.0);

    let mut random = Random(SEED);
    let (mut partial, mut progressed, mut after_the_end) = (0, 0, 0);
    for kill in 0..KILLS {
        let before = lines(&killed.0);
        let mut child = start(&killed.0);
        // On average twenty of them make one whole map: all fall into work.
        let part = length.mul_f64(2.0 * random.next() / KILLS as f64);
        let moment = Instant::now() + Duration::from_millis(3) + part;
        while Instant::now() < moment && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_micros(200));
        }
        let ended = child.try_wait().unwrap().is_some();
        child.kill().unwrap();
        child.wait().unwrap();
        let after = lines(&killed.0);
        assert!(after >= before, "kill {kill} lost finished runs");
        after_the_end += usize::from(ended);
        let unfinished = after <= wanted.len();
        partial += usize::from(after > 1 && unfinished);
        progressed += usize::from(after > before && unfinished);
    }
    assert!(
        progressed >= 3,
        "only {progressed} kills fell into work that left finished runs"
    );
    assert!(
        partial >= KILLS / 2,
        "only {partial} of {KILLS} kills left a map half done ({after_the_end} came after its end)"
    );
    finish(start(&killed.0));

    assert_eq!(runs(&killed.0), wanted, "the journals differ");
    for name in ["stability.csv", "stability_limits.csv"] {
        assert!(
            read(&killed.0, name) == read(&whole.0, name),
            "{name} differs"
        );
    }
    let maps = |dir: &Path| {
        let text = String::from_utf8(read(dir, "results.json")).unwrap();
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        value["maps"].to_string()
    };
    assert_eq!(maps(&killed.0), maps(&whole.0));
    let csv = String::from_utf8(read(&whole.0, "stability.csv")).unwrap();
    assert!(!csv.contains("NaN") && !csv.contains("inf,"));
    assert!(csv.lines().count() > 180, "{} lines", csv.lines().count());
}

#[test]
fn another_map_in_the_same_folder_is_refused() {
    let folder = Folder::new("map-other");
    let run = |more: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_gearbench"))
            .args([
                "stability",
                "spur_impact",
                "--models",
                "rigid",
                "--out",
                "map",
            ])
            .args(["--integrators", "rk4", "--axis", "contact-stiffness=1,2"])
            .args(more)
            .current_dir(&folder.0)
            .env("NO_COLOR", "1")
            .output()
            .unwrap()
    };
    let first = run(&["--steps", "1e-6:1e-4:4"]);
    assert!(first.status.success(), "{first:?}");
    let kept = read(&folder.0, "stability.csv");
    let other = run(&["--steps", "1e-6:1e-4:5"]);
    let said = String::from_utf8_lossy(&other.stderr).into_owned();
    assert_eq!(other.status.code(), Some(2), "{said}");
    for word in ["--fresh", "--out", "rk4"] {
        assert!(said.contains(word), "{said}");
    }
    assert_eq!(read(&folder.0, "stability.csv"), kept);
    let fresh = run(&["--steps", "1e-6:1e-4:5", "--fresh"]);
    assert!(fresh.status.success(), "{fresh:?}");
    assert_ne!(read(&folder.0, "stability.csv"), kept);
}
