//! Tests of `scan` and `merge`: tables, parts, refusals, and the workflow of Snakemake.

// Figures of documents, and the reason why a test is skipped, are printed.
#![allow(clippy::print_stdout)]

use super::{Folder, has, stderr, stdout};
use gearbench_reports::record::OF_THE_CLOCK;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Two models under random speeds, at listed stiffnesses.
const SCAN: &str = "scan spur_impact --models rigid,movable-teeth --vary gears.pinion.speed_rad_s=uniform(10,100) \
                    --vary gears.*.face_width_m=0.008,0.01 --samples 32 --indices";

fn record(folder: &Path) -> Value {
    let text = std::fs::read_to_string(folder.join("results.json")).unwrap();
    let mut record: Value = serde_json::from_str(&text).unwrap();
    OF_THE_CLOCK.iter().for_each(|key| {
        record.as_object_mut().unwrap().remove(*key);
    });
    record
}

/// Parts in any order give the table and the record of the scan in one piece.
#[test]
fn parts_make_the_whole() {
    let folder = Folder::new();
    folder.says(&format!("{SCAN} --out whole --threads 2"));
    for i in 1..=3 {
        folder.says(&format!("{SCAN} --shard {i}/3 --out part{i} --threads 1"));
    }
    folder.says("merge part2 part3 part1 --out merged");
    let table = folder.read("whole/cells.csv");
    assert_eq!(folder.read("merged/cells.csv"), table);
    assert_eq!(record(&folder.at("merged")), record(&folder.at("whole")));
    // 32 samples in three variants, at two widths, of two models.
    assert_eq!(table.lines().count(), 1 + 32 * 3 * 2 * 2);
    assert_eq!(
        folder.read("merged/timings.csv").lines().count(),
        table.lines().count()
    );
    let indices = record(&folder.at("merged"))["indices"]
        .as_array()
        .unwrap()
        .len();
    // Two models, two widths, four outputs, one random axis.
    assert_eq!(indices, 16);
    super::as_documented(&folder.at("merged"));
    // The page follows from the record, and a rerun gives the same results.
    let page = folder.read("merged/index.html");
    folder.says("report merged");
    assert_eq!(folder.read("merged/index.html"), page);
    has(&folder.says("rerun merged --out again"), &["the same: all"]);
}

/// A part that is missing, doubled, damaged or of another scan is named, and nothing is written.
#[test]
fn parts_that_do_not_fit_are_refused() {
    let folder = Folder::new();
    let scan = "scan spur_impact --models rigid --vary gears.pinion.speed_rad_s=uniform(10,20) --samples 4";
    for i in 1..=2 {
        folder.says(&format!("{scan} --shard {i}/2 --out p{i}"));
    }
    folder.says(&format!("{scan} --shard 2/2 --seed 2 --out seed"));
    folder.says(&format!("{scan} --shard 2/3 --out of3"));
    folder.says(&format!("{scan} --out whole"));
    folder.refuses("merge p2 --out m", &["1 of 2 parts are missing: 1"]);
    folder.refuses(
        "merge p1 p2 p2 --out m",
        &["p2: part 2 of 2 is there twice"],
    );
    folder.refuses(
        "merge p1 seed --out m",
        &[
            "seed: the part is of another scan than p1",
            "seed 2",
            "seed 1",
        ],
    );
    folder.refuses("merge p1 of3 --out m", &["of3", "one of 3 parts"]);
    folder.refuses("merge p1 whole --out m", &["whole: it has a whole scan"]);
    folder.refuses("merge p1 nothing --out m", &["nothing"]);
    folder.says("init spur_impact --out s.toml");
    folder.says(&format!(
        "{} --shard 2/2 --out scene",
        scan.replace("spur_impact", "s.toml")
    ));
    folder.refuses(
        "merge p1 scene --out m",
        &["scene: the part is of another scan", "its scene"],
    );
    let cut: Vec<String> = folder
        .read("p2/cells.csv")
        .lines()
        .take(2)
        .map(str::to_owned)
        .collect();
    folder.write("p2/cells.csv", &(cut.join("\n") + "\n"));
    folder.refuses(
        "merge p1 p2 --out m",
        &["p2/cells.csv: it has 1 rows, expected 2", "--shard"],
    );
    assert!(!folder.at("m").exists());
}

/// Wrong keys and values of the first cell end the scan before it runs; those of further cells are rows.
#[test]
fn wrong_values_are_refused_or_rows() {
    let folder = Folder::new();
    let scan = "scan spur_impact --models rigid --vary";
    let near = ["unknown key `sped_rad_s`", "did you mean `speed_rad_s`"];
    folder.refuses(&format!("{scan} gears.pinion.sped_rad_s=1,2"), &near);
    folder.refuses(
        &format!("{scan} models.soft.contact.stiffness=1"),
        &["no entry `soft`", "rigid"],
    );
    folder.refuses(&format!("{scan} gears.pinion.teeth=1..5"), &["FROM..TO:N"]);
    folder.refuses(
        &format!("{scan} gears.pinion.teeth=20 --outputs force_l2"),
        &["--against"],
    );
    folder.refuses(
        &format!("{scan} gears.pinion.teeth=20 --outputs velocity"),
        &["there is no quantity", "efficiency"],
    );
    folder.refuses(
        &format!("{scan} gears.pinion.speed_rad_s=normal(1,2)"),
        &["--samples"],
    );
    assert!(!folder.at("out").exists());
    let said = folder.says(&format!("{scan} gears.pinion.teeth=20,0 --out rows"));
    has(&said, &["of which 1 failed", "number of teeth is 0"]);
    let table = folder.read("rows/cells.csv");
    assert!(
        table.lines().nth(2).unwrap().contains(",refused,,,,,"),
        "{table}"
    );
    // Nothing but failures is a failure.
    let out = folder.ends(
        &format!("{scan} gears.pinion.speed_rad_s=20,21 --integrators semi-implicit-euler@5e-5 --out none"),
        3,
    );
    has(&(stdout(&out) + &stderr(&out)), &["of which 2 failed"]);
}

/// A model on which no key has an effect is named: its mesh is that of a file. A width that the mesh does not have is
/// refused.
#[test]
fn keys_without_effect_are_said() {
    let folder = Folder::new();
    let said = folder.says(
        "scan spur_impact --models rigid,elastic --vary gears.*.face_width_m=0.0098,0.01 --integrators trigonometric@1us,dopri5@1e-4",
    );
    has(
        &said,
        &["The results of elastic, elastic are the same in all scenes"],
    );
    folder.says("scan spur_impact --models elastic --vary gears.*.face_width_m=0.008,0.01 --integrators dopri5@1e-4 --out b");
    let table = folder.read("b/cells.csv");
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert!(
        rows[0].contains(",refused,") && rows[0].contains("10.0000 mm"),
        "{table}"
    );
    assert!(rows[1].contains(",unchecked,"), "{table}");
}

/// Errors refer to the model of `--against` in the scene of the same cell: those of the model itself are none.
#[test]
fn errors_refer_to_the_model_of_the_same_scene() {
    let folder = Folder::new();
    folder.says("scan spur_impact --models rigid,movable-teeth --against rigid-iso6336 --vary gears.pinion.speed_rad_s=10,40 --out a");
    let table = folder.read("a/cells.csv");
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let at = header.iter().position(|c| *c == "peak_force_rel").unwrap();
    let peak = header.iter().position(|c| *c == "peak_force_n").unwrap();
    let rows: Vec<Vec<&str>> = table
        .lines()
        .skip(1)
        .map(|l| l.split(',').collect())
        .collect();
    for cell in rows.chunks(3) {
        assert!(cell[0][at].is_empty(), "{table}");
        let of = |row: &Vec<&str>| row[peak].parse::<f64>().unwrap();
        for row in &cell[1..] {
            let error: f64 = row[at].parse().unwrap();
            assert!(
                (error - (of(row) / of(&cell[0]) - 1.0)).abs() < 1e-9,
                "{table}"
            );
        }
    }
}

/// The map of the efficiency: at nine points within 0.2 % of the quasi-static integral of the friction over a mesh cycle
/// (two pairs share the load equally; the coefficient of Schlenk).
#[test]
fn efficiency_is_that_of_the_quasi_static_integral() {
    let folder = Folder::new();
    folder.says(
        "scan mesh_efficiency --models rigid --vary gears.wheel.loads.1.torque_nm=50,141.15,300 --vary \
         gears.pinion.mount.driven.speed_rad_s|gears.wheel.speed_rad_s|duration_s=100|-66.6666666666667|0.015707963,\
         200|-133.333333333333|0.0078539816,400|-266.666666666667|0.0039269908 --outputs efficiency --out e",
    );
    let table = folder.read("e/cells.csv");
    let mut greatest: f64 = 0.0;
    for line in table.lines().skip(1) {
        let row: Vec<&str> = line.split(',').collect();
        let x = |i: usize| row[i].parse::<f64>().unwrap();
        let (torque, speed, efficiency) = (x(1), x(2), x(8));
        let expected = quasi_static_efficiency(torque, speed);
        let off = efficiency / expected - 1.0;
        let loss = (1.0 - efficiency) / (1.0 - expected);
        println!(
            "{torque} N m, {speed} rad/s: efficiency {efficiency:.5}, integral {expected:.5}, loss over that of the integral {loss:.3}"
        );
        greatest = greatest.max(off.abs());
    }
    println!(
        "greatest deviation of the efficiency {:.2} %",
        100.0 * greatest
    );
    assert_eq!(table.lines().count(), 10);
    assert!(greatest < 2e-3, "{greatest}");
}

/// Efficiency of the gears of `mesh_efficiency` from the equilibrium of both gears under friction, pair by pair.
fn quasi_static_efficiency(torque: f64, speed: f64) -> f64 {
    let (teeth, module, distance, width) = ([16.0, 24.0], 4.5e-3, 0.0915, 0.014);
    let alpha = 20_f64.to_radians();
    let base = teeth.map(|z| module * z * alpha.cos() / 2.0);
    let tip = [0.1817, 0.1715];
    let tip = [0, 1].map(|i| module * (teeth[i] / 2.0 + 1.0 + tip[i]));
    let working = ((base[0] + base[1]) / distance).acos();
    let length = distance * working.sin();
    let pitch_point = base[0] * working.tan();
    let pitch = std::f64::consts::PI * module * alpha.cos();
    let end = (tip[0].powi(2) - base[0].powi(2)).sqrt();
    let begin = length - (tip[1].powi(2) - base[1].powi(2)).sqrt();
    // H. Schlenk: N/mm, mm, m/s, mPa s, um.
    let radius = 1.0 / (1.0 / pitch_point + 1.0 / (length - pitch_point));
    let pressure = (torque / base[1] / width).max(150e3) / radius * 1e-6;
    let sum_of_speeds = 2.0 * base[0] * working.tan() * speed;
    let mu = 0.048 * (pressure / sum_of_speeds).powf(0.2) * 20_f64.powf(-0.05) * 0.4_f64.powf(0.25);
    let of_wheel = speed * base[0] / base[1];
    let (mut taken, mut given) = (0.0, 0.0);
    let n = 4000;
    for i in 0..n {
        let first = begin + (i as f64 + 0.5) / n as f64 * pitch;
        let pairs = [first, first + pitch].into_iter().filter(|s| *s <= end);
        let (mut arms, mut count) = ([0.0, 0.0], 0.0);
        for s in pairs {
            let sliding = speed * s - of_wheel * (length - s);
            let friction = mu * (sliding / 0.01).tanh();
            arms[0] += base[0] + friction * s;
            arms[1] += base[1] + friction * (length - s);
            count += 1.0;
        }
        let force = torque / (arms[1] / count);
        given += force * (arms[0] / count) * speed;
        taken += torque * of_wheel;
    }
    taken / given
}

/// The workflow of `gearbench init snakemake`: its table is that of one process, also after a kill of the whole workflow,
/// and after a part was deleted. Skipped with a message where Snakemake is not installed.
#[test]
fn snakemake_runs_the_parts() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let snakemake = root.join("target/tools/snakemake/bin/snakemake");
    if !snakemake.is_file() {
        println!("skipped: Snakemake is not installed (.ci/snakemake.sh)");
        return;
    }
    let folder = Folder::new();
    folder.says("init snakemake");
    let scan = "--models rigid --vary gears.pinion.speed_rad_s=10..100:400";
    folder.write(
        "snakemake/config.yaml",
        &format!(
            "gearbench: {}\nscene: spur_impact\nscan: \"{scan}\"\nshards: 5\nresults: results\n",
            env!("CARGO_BIN_EXE_gearbench")
        ),
    );
    folder.says(&format!("scan spur_impact {scan} --out whole"));
    let start = |arguments: &[&str]| {
        let mut command = Command::new(&snakemake);
        command.args(arguments).current_dir(folder.at("snakemake"));
        command
            .env("GEARBENCH_CACHE", "off")
            .env("HOME", folder.path());
        command
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped());
        command.spawn().unwrap()
    };
    let finish = || {
        let out = start(&["--cores", "2"]).wait_with_output().unwrap();
        assert!(out.status.success(), "{}{}", stdout(&out), stderr(&out));
    };
    // Killed while parts run: the next start continues.
    let mut first = start(&["--cores", "2"]);
    while !folder.at("snakemake/results/shards").exists() && first.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let _ = first.kill();
    let _ = first.wait();
    let unlocked = start(&["--unlock"]).wait_with_output().unwrap();
    assert!(unlocked.status.success(), "{}", stderr(&unlocked));
    finish();
    let whole = folder.read("whole/cells.csv");
    assert_eq!(folder.read("snakemake/results/cells.csv"), whole);
    // A lost part is made again, and the table with it.
    std::fs::remove_dir_all(folder.at("snakemake/results/shards/2-of-5")).unwrap();
    finish();
    assert!(
        folder
            .at("snakemake/results/shards/2-of-5/cells.csv")
            .exists()
    );
    assert_eq!(folder.read("snakemake/results/cells.csv"), whole);
}
