//! The example of a user-defined model, joined to the table by one line, in all studies.

use clap::Parser;
use gearbench::cli::{Cli, run};
use gearbench_reports::record::{Part, Results};
use gearbench_tests::{elastic_web, joined};
use std::path::Path;
use std::process::ExitCode;

/// Runs a study of a scene, and reads its record if it succeeds.
fn study(folder: &Path, command: &str) -> Option<Results> {
    let (study, options) = command.split_once(' ').unwrap_or((command, ""));
    let scene = folder.join("example.toml");
    std::fs::write(&scene, include_str!("example.toml")).unwrap();
    let out = folder.join(study);
    let paths = [scene.as_os_str(), "--out".as_ref(), out.as_os_str()];
    let words = ["gearbench", study].into_iter().map(Into::into);
    let options = options.split_whitespace().map(Into::into);
    let arguments = words.chain(paths.map(Into::into)).chain(options);
    let cli = Cli::try_parse_from(arguments.collect::<Vec<std::ffi::OsString>>()).unwrap();
    // Short runs may not settle: a result that falls short is one.
    if ![ExitCode::SUCCESS, ExitCode::from(1)].contains(&run(joined(), cli)) {
        return None;
    }
    let record = std::fs::read_to_string(out.join("results.json")).unwrap();
    Some(serde_json::from_str(&record).unwrap())
}

#[test]
fn a_model_that_joins_the_table_runs_through_the_studies() {
    let folder = tempfile::tempdir().unwrap();
    for (command, runs) in [
        ("compare --repeats 1", 3),
        ("precision --repeats 1", 5),
        // Two speeds, up and down.
        ("sweep", 4),
    ] {
        let record = study(folder.path(), command).expect(command);
        let own = (record.runs.iter()).filter(|r| r.model == elastic_web::MODEL.id);
        assert_eq!(own.clone().count(), runs, "{command}");
        for run in own {
            let (status, message) = (run.status, &run.message);
            assert!(!status.is_failure(), "{command}: {status}, {message:?}");
        }
    }

    let record = study(folder.path(), "stability").expect("maps");
    let Part::Stability(record) = record.part else {
        panic!("a record of another study");
    };
    for map in record.maps {
        let stable = map.cells.iter().filter(|c| c.status.holds());
        assert!(stable.count() > 3, "{} under {}", map.model, map.integrator);
    }

    // What the model cannot do is refused.
    let modes = study(
        folder.path(),
        "stability --models elastic-web --axis modes=0,5",
    );
    assert!(modes.is_none());
}
