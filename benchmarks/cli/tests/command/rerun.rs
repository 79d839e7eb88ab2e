//! Tests of the command `gearbench rerun`: a record may come from elsewhere. It runs only the study of the record, and
//! writes only into the output folder.

use super::{Folder, has};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const SCENE: &str = include_str!("../malformed/scene.toml");

/// Returns all files below a folder with their contents.
fn tree(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => all.extend(tree(&path)),
            false => {
                let bytes = std::fs::read(&path).unwrap();
                all.insert(path, bytes);
            }
        }
    }
    all
}

fn record(folder: &Folder, name: &str) -> Value {
    serde_json::from_str(&folder.read(name)).unwrap()
}

/// A folder with a scene and the record of a comparison of it.
fn compared() -> Folder {
    let folder = Folder::new();
    folder.write("s.toml", SCENE);
    folder.says("compare s.toml --models rigid --integrators rk4 --repeats 1 --out r");
    folder
}

#[test]
fn a_record_runs_its_own_study_alone() {
    let folder = compared();
    let sound = record(&folder, "r/results.json");
    let mut home = sound.clone();
    home["source"]["name"] = "home/.profile".into();
    std::fs::create_dir(folder.at("home")).unwrap();
    folder.write("home/.profile", "export PRECIOUS=1\n");
    folder.write("check.toml", "schema = 1\n[[cases]]\nscene = \"s.toml\"\n");
    for (of, command) in [
        (&home, "reference home/.profile --model rigid --add"),
        (&sound, "reference s.toml --model rigid --add"),
        (&sound, "rerun r"),
        (&sound, "init pair --force --out s.toml"),
        (&sound, "fmu s.toml --force --out s.toml"),
        (&sound, "mesh s.toml --force --out m.inp"),
        (&sound, "reduce s.toml --force --out m.npz"),
        (&sound, "report r"),
        (&sound, "list --clear-cache"),
        (&sound, "completions bash"),
        (&sound, "check check.toml --update"),
        (&sound, "identify s.toml --write=scene"),
        (&sound, "sweep s.toml"),
        (&sound, "stiffness s.toml"),
        (&sound, "compare --help"),
        (&sound, "--version"),
        (&sound, "no-such-command"),
    ] {
        let mut changed = of.clone();
        changed["command"] = format!("gearbench {command}").into();
        folder.write("r/results.json", &changed.to_string());
        let before = tree(folder.path());
        folder.refuses("rerun r", &["cannot be repeated", "help:"]);
        assert!(tree(folder.path()) == before, "{command}");
    }
}

/// Options of a study that write a scene, a calibration or a baseline, or that name another folder, do nothing of the kind.
#[test]
fn a_study_that_is_made_again_writes_one_folder() {
    let folder = compared();
    folder.says("init spur_impact --out own.toml");
    folder.says("identify own.toml --model rigid --out i");
    let source = record(&folder, "r/results.json")["source"].clone();
    let check = "schema = 1\nruntime = { gate = false }\n[[cases]]\nscene = \"s.toml\"\nmodels = [\"rigid\"]\n\
                 integrators = [\"rk4@1us\"]\n";
    folder.write("check.toml", check);
    folder.says("check --update --no-runtime --out c");
    // A change of the scene that `--update` would store.
    folder.write(
        "s.toml",
        &SCENE.replace("torque_nm = 1.0", "torque_nm = 2.0"),
    );
    for (at, command, source) in [
        (
            "i",
            "identify own.toml --model rigid --write=scene --force --out elsewhere",
            None,
        ),
        (
            "i",
            "identify own.toml --model rigid --write --out=elsewhere",
            None,
        ),
        (
            "c",
            "check check.toml --update --no-runtime --out elsewhere",
            Some(source),
        ),
    ] {
        let again = format!("again-{}", tree(folder.path()).len());
        let name = format!("{at}/results.json");
        let mut changed = record(&folder, &name);
        changed["command"] = format!("gearbench {command}").into();
        if let Some(source) = source {
            changed["source"] = source;
        }
        folder.write(&name, &changed.to_string());
        let before = tree(folder.path());
        let out = folder
            .command(&format!("rerun {at} --out {again}"))
            .output()
            .unwrap();
        assert!(
            [Some(0), Some(1)].contains(&out.status.code()),
            "{command}: {}",
            super::stderr(&out)
        );
        let mut after = tree(folder.path());
        after.retain(|path, _| !path.starts_with(folder.at(&again)));
        assert!(after == before, "{command}");
        assert!(folder.at(&again).join("results.json").exists());
    }
    has(&folder.says("rerun i --out again"), &["the same: all"]);
}
