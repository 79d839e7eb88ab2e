//! A stability map that is killed again and again and resumed equals the one that was left alone, byte for byte.

use super::{Folder, has, stderr};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::Duration;

/// Kills of one map.
const KILLS: usize = 20;
/// Seed of their moments.
const SEED: u64 = 0x6765_6172_2d6b_696c;

/// A quick map of rigid gears whose runs take some milliseconds each.
fn start(folder: &Folder) -> Child {
    let map = "stability spur_rotation --models rigid --integrators velocity-verlet,rk4,newmark \
               --axis contact-stiffness=0.1:100:6 --steps 5e-7:2e-4:10 --duration 2e-3 --threads 2 --out map";
    let mut command = folder.command(map);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().unwrap()
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
    let (whole, killed) = (Folder::new(), Folder::new());
    finish(start(&whole));
    let wanted = runs(whole.path());

    let mut random = Random(SEED);
    let (mut partial, mut progressed) = (0, 0);
    for kill in 0..KILLS {
        let before = lines(killed.path());
        let mut child = start(&killed);
        // By the lines of the journal, not by a clock; on average twenty of them make one whole map.
        let part = 2.0 * random.next() / KILLS as f64;
        let at = before + (part * wanted.len() as f64) as usize;
        while lines(killed.path()) < at && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_micros(200));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let after = lines(killed.path());
        assert!(after >= before, "kill {kill} lost finished runs");
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
        "only {partial} of {KILLS} kills left a map half done"
    );
    finish(start(&killed));

    assert_eq!(runs(killed.path()), wanted, "the journals differ");
    for name in ["stability.csv", "stability_limits.csv"] {
        assert!(
            read(killed.path(), name) == read(whole.path(), name),
            "{name} differs"
        );
    }
    let maps = |dir: &Path| {
        let text = String::from_utf8(read(dir, "results.json")).unwrap();
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        value["maps"].to_string()
    };
    assert_eq!(maps(killed.path()), maps(whole.path()));
    let csv = String::from_utf8(read(whole.path(), "stability.csv")).unwrap();
    assert!(!csv.contains("NaN") && !csv.contains("inf,"));
    assert!(csv.lines().count() > 180, "{} lines", csv.lines().count());
}

#[test]
fn another_map_in_the_same_folder_is_refused() {
    let folder = Folder::new();
    let map = "stability spur_impact --models rigid --out map --integrators rk4 --axis contact-stiffness=1,2 --steps";
    folder.says(&format!("{map} 1e-6:1e-4:4"));
    let kept = read(folder.path(), "stability.csv");
    let other = folder.ends(&format!("{map} 1e-6:1e-4:5"), 2);
    has(&stderr(&other), &["--fresh", "--out", "rk4"]);
    assert_eq!(read(folder.path(), "stability.csv"), kept);
    folder.says(&format!("{map} 1e-6:1e-4:5 --fresh"));
    assert_ne!(read(folder.path(), "stability.csv"), kept);
}
