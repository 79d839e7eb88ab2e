//! Tests of the command `gearbench check`: storing a baseline, agreement with it, and every kind of deviation.

use super::{Folder, as_documented, has};
use gearbench_reports::Part;
use gearbench_reports::check::{CheckRecord, Kind, Verdict};

const CHECK: &str = "schema = 1\nruntime = { gate = false }\n[[cases]]\nscene = \"s.toml\"\nmodels = [\"rigid-iso6336\"]\n\
                     integrators = [\"newmark@1us\", \"dopri5@1e-6\"]\n";

/// A scene of one impact of rigid gears with a stiffness in numbers, and its check.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.says("init spur_impact --out s.toml");
    let scene = folder.read("s.toml");
    let label = "label = \"rigid-iso6336\"\nmodel = \"rigid\"\ncontact = { stiffness = ";
    let norm = format!("{label}\"iso6336\" }}");
    assert!(scene.contains(&norm));
    let constant = format!("{label}{{ kind = \"constant\", stiffness_n_per_m2 = 1.5e10 }} }}");
    folder.write("s.toml", &scene.replace(&norm, &constant));
    folder.write("check.toml", CHECK);
    folder
}

fn record(folder: &Folder) -> CheckRecord {
    match gearbench_reports::load_results(&folder.at("r"))
        .unwrap()
        .part
    {
        Part::Check(record) => record,
        other => panic!("{other:?}"),
    }
}

fn moved(record: &CheckRecord) -> Vec<String> {
    let found = record.entries.iter().flat_map(|e| e.moved());
    found.map(|f| f.what.clone()).collect()
}

#[test]
fn a_change_of_one_per_cent_is_named_and_an_update_takes_it() {
    let folder = folder();
    folder.refuses(
        "check --out r",
        &["the baseline for the comparison is missing", "--update"],
    );
    has(&folder.says("check --update --out r"), &["stored:"]);
    let first = folder.read("check.baseline.jsonl");
    assert_eq!(first.lines().count(), 2);
    has(&folder.says("check --out r"), &["2 entries hold"]);
    assert!(record(&folder).holds());
    // Nothing moved: an update leaves the file alone.
    has(
        &folder.says("check --update --out r"),
        &["no value has moved"],
    );
    assert_eq!(folder.read("check.baseline.jsonl"), first);

    let scene = folder.read("s.toml");
    folder.write(
        "s.toml",
        &scene.replace("n_per_m2 = 1.5e10", "n_per_m2 = 1.515e10"),
    );
    let out = folder.ends("check --out r", 1);
    let said = String::from_utf8(out.stdout).unwrap();
    has(
        &said,
        &[
            "moved  peak_force_n",
            "stiffness_n_per_m2",
            "2 of 2 entries moved",
        ],
    );
    let record = record(&folder);
    assert!(moved(&record).contains(&"force_l2_aligned@calculix".to_owned()));
    let constants = (record.entries.iter()).flat_map(|e| e.reported());
    let constants: Vec<_> = constants.filter(|f| f.kind == Kind::Parameter).collect();
    assert_eq!(constants.len(), 2);
    assert!((constants[0].change.unwrap() - 0.01).abs() < 1e-12);
    for name in ["summary.md", "junit.xml", "check.csv"] {
        assert!(
            folder.read(&format!("r/{name}")).contains("peak_force_n"),
            "{name}"
        );
    }
    has(&folder.read("r/index.html"), &["peak force", "What moved"]);
    has(
        &folder.says("check --update --out r"),
        &["moved  peak_force_n", "stored:"],
    );
    let both = folder.read("check.baseline.jsonl");
    assert!(both.starts_with(&first) && both.lines().count() == 4);
    folder.says("check --out r");
    folder.says("check --history peak_force_n --out h");
    assert!(folder.read("h/history.svg").contains("peak_force_n"));
    folder.refuses(
        "check --history peak --out i",
        &["no quantity `peak`", "peak_force_n"],
    );
}

/// Counts of work are exact, a failed run and an entry that is gone are findings, other cases keep their entries.
#[test]
fn work_failures_and_entries() {
    let folder = folder();
    folder.says("check --update --out r");
    let baseline = folder.read("check.baseline.jsonl");
    let count = baseline.split("\"newton_iterations\":").nth(1).unwrap();
    let count: u64 = count.split([',', '}']).next().unwrap().parse().unwrap();
    let old = format!("\"newton_iterations\":{count}");
    let one_less = format!("\"newton_iterations\":{}", count - 1);
    folder.write(
        "check.baseline.jsonl",
        &baseline.replacen(&old, &one_less, 1),
    );
    folder.ends("check --out r", 1);
    assert_eq!(moved(&record(&folder)), ["newton_iterations"]);
    folder.write(
        "check.toml",
        &CHECK.replace("schema = 1", "schema = 1\nwork = \"report\""),
    );
    folder.ends("check --out r", 0);

    folder.write("check.baseline.jsonl", &baseline);
    folder.write(
        "check.toml",
        &CHECK.replace(", \"dopri5@1e-6\"", ", \"velocity-verlet@90us\""),
    );
    folder.ends("check --out r", 1);
    let found = record(&folder);
    let entries: Vec<(String, Verdict)> = (found.entries.iter())
        .flat_map(|e| &e.findings)
        .filter(|f| f.kind == Kind::Entry)
        .map(|f| (f.texts()[0].clone(), f.verdict))
        .collect();
    assert_eq!(
        entries,
        ["new", "absent"].map(|word| (word.to_owned(), Verdict::Moved))
    );

    folder.write("check.baseline.jsonl", "{\"baseline\": 1, oops}\n");
    folder.refuses("check --out x", &["line 1", "check.baseline.jsonl"]);
    folder.refuses("check --cases other --out x", &["line 1"]);
    folder.write("check.baseline.jsonl", &baseline);
    folder.refuses(
        "check --cases other --out x",
        &["no case `other`", "it has s"],
    );
    folder.refuses("check nowhere.toml", &["nowhere.toml", "init check"]);
    assert!(!folder.at("x").exists());
}

/// The template of `init check` runs, and its files conform to the schema and the dictionary.
#[test]
fn the_template_runs_and_keeps_to_the_formats() {
    let folder = Folder::new();
    folder.says("init check");
    folder.says("init workflow");
    has(
        &folder.read("workflow.yml"),
        &["gearbench check check.toml"],
    );
    folder.says("check --quick --update --no-runtime --out r");
    as_documented(&folder.at("r"));
    let page = folder.read("r/index.html");
    folder.says("report r");
    assert_eq!(folder.read("r/index.html"), page);
}
