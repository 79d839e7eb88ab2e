//! Tests of the verdicts on runs: work limits bound the converged solution of a model, no run is compared with itself,
//! and a run without verdict has not passed.

use super::{Folder, stderr, stdout};
use serde_json::Value;

const SCENE: &str = include_str!("../malformed/scene.toml");
const FLORES: &str = "damping = { law = \"flores\", e = 0.9 }";
const TOOTH: &str = "stiffness_n_per_m2 = 1.4e10";

fn with(name: &str, pairs: &[(&str, &str)]) -> Folder {
    let folder = Folder::new();
    let mut text = SCENE.to_owned();
    for (from, to) in pairs {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    folder.write(name, &text);
    folder
}

/// The scene with a tolerance against `self`.
fn gated(pairs: &[(&str, &str)]) -> Folder {
    let gate = "duration_s = 1e-4\ntolerance = { metric = \"force_l2\", limit = 0.05, against = \"self\" }\n";
    let has = SCENE.contains("tolerance =");
    let all: Vec<_> = (!has)
        .then_some(("duration_s = 1e-4\n", gate))
        .into_iter()
        .chain(pairs.iter().copied())
        .collect();
    with("scene.toml", &all)
}

fn runs(folder: &Folder, study: &str) -> Vec<Value> {
    let path = format!("out/base/{study}/results.json");
    let record: Value = serde_json::from_str(&folder.read(&path)).unwrap();
    record["runs"].as_array().unwrap().clone()
}

/// The error of integration is the same under every bound of time that the run itself keeps, and the record names the
/// solution that it was measured against. A run at the tolerance of that solution is not compared with itself.
#[test]
fn converged_solutions_do_not_depend_on_the_bound_of_time() {
    let folder = gated(&[(TOOTH, "stiffness_n_per_m2 = 1e25")]);
    let found = |timeout: &str| {
        let arguments = format!(
            "compare scene.toml --models movable-teeth --integrators dopri5@1e-6 --repeats 1 --fresh --timeout {timeout}"
        );
        let out = folder.command(&arguments).output().unwrap();
        let row = runs(&folder, "compare").remove(0);
        let status = row["status"].as_str().unwrap().to_owned();
        assert_ne!(status, "timeout", "{}", stdout(&out));
        (status, row["own_solution"].clone(), row["metrics"].clone())
    };
    let long = found("60");
    assert_eq!(found("2"), long);
    if let Some(rtol) = long.1["rtol"].as_f64() {
        assert!(rtol <= 1e-7, "{long:?}");
        // The solution itself, and what is hardly coarser, is not judged, and does not pass: finer ones take too many
        // steps here.
        for own in [rtol, 5.0 * rtol] {
            is_not_judged(&folder, own, "no converged solution");
        }
    } else {
        // Without a solution nothing is judged.
        assert_eq!(long.0, "unchecked", "{long:?}");
    }
    // There is no solution beyond 1e-12.
    let plain = gated(&[]);
    for own in [1e-12, 5e-12] {
        is_not_judged(&plain, own, "ten times finer");
    }
}

/// Asserts that a run at a tolerance is not judged by a converged solution, does not pass, and says why.
fn is_not_judged(folder: &Folder, rtol: f64, why: &str) {
    let out = folder.ends(
        &format!("compare scene.toml --models movable-teeth --integrators dopri5@{rtol:e} --repeats 1 --fresh"),
        1,
    );
    let row = runs(folder, "compare").remove(0);
    assert_eq!(row["status"], "unchecked", "{}", stdout(&out));
    let message = row["message"].as_str().unwrap();
    assert!(message.contains(why), "{message}");
    assert_eq!(row["metrics"].as_array().unwrap().len(), 0, "{row}");
}

/// A scene with a tolerance whose runs cannot be judged does not pass, whatever the method says of its own tolerance; the
/// same comparison without a tolerance shows what there is.
#[test]
fn what_was_not_judged_has_not_passed() {
    let damped = "damping = { law = \"kelvin-voigt-bounded\", damping_ns_per_m = 1e12 }";
    let folder = gated(&[(FLORES, damped)]);
    let arguments =
        "compare scene.toml --models rigid --integrators newmark@1us,hht-alpha@1us --repeats 1";
    let out = folder.command(arguments).output().unwrap();
    let unjudged = runs(&folder, "compare");
    assert!(
        unjudged.iter().all(|r| r["status"] != "converged"),
        "{}",
        stdout(&out)
    );
    let said = stdout(&out);
    assert_ne!(out.status.code(), Some(0), "{said}{}", stderr(&out));
    if unjudged.iter().any(|r| r["status"] == "unchecked") {
        assert!(said.contains("not judged"), "{said}");
        assert!(
            said.contains("only a run within the tolerance has passed"),
            "{said}"
        );
    }
    // `except` takes a model out of the gate, as for one beyond the tolerance.
    let help = stdout(&folder.ends("--help", 0));
    assert!(
        help.contains("What was not judged has not passed"),
        "{help}"
    );
}

/// Teeth that never touch have a force of zero, which agrees with that of the converged solution.
#[test]
fn no_contact_is_a_defined_case() {
    let folder = gated(&[
        ("speed_rad_s = 20.0", "speed_rad_s = 0.0"),
        ("loads = [{ torque_nm = 1.0 }]\n", ""),
    ]);
    let arguments =
        "compare scene.toml --models rigid --integrators dopri5@1e-6,rk4@1us --repeats 1";
    let said = stdout(&folder.ends(arguments, 0));
    for row in runs(&folder, "compare") {
        assert_eq!(row["status"], "converged", "{said}");
        let message = row["message"].as_str().unwrap();
        assert!(message.contains("no contact"), "{message}");
        assert_eq!(row["metrics"][0]["force_l2"], 0.0, "{row}");
    }
}

/// The bound of a study lists what it leaves untried, and the bound of a run is one of processor time.
#[test]
fn budgets_list_what_was_not_tried() {
    let folder = with("scene.toml", &[]);
    let arguments =
        "precision scene.toml --models rigid --integrators dopri5 --repeats 1 --budget 1e-3";
    let out = folder.command(arguments).output().unwrap();
    let said = format!("{}{}", stdout(&out), stderr(&out));
    assert!(said.contains("not tried within the budget"), "{said}");
    let out = folder
        .command("choose hammer --budget 1e-3")
        .output()
        .unwrap();
    assert_eq!(out.status.code(), Some(3));
    assert!(stderr(&out).contains("--budget"), "{}", stderr(&out));
    let out = folder.ends(
        "compare scene.toml --models rigid --integrators rk4@1ns --timeout 1e-3 --repeats 1",
        3,
    );
    let said = stdout(&out);
    assert!(said.contains("processor time"), "{said}");
}
