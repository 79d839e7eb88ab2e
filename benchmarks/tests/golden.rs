//! Golden runs: results and work of the default comparison, compared with a stored table.
//!
//! Regenerate after a change that is meant:
//! `GEARBENCH_UPDATE_GOLDEN=1 cargo test --release -p gearbench --test golden`
//!
//! The work of fixed-step methods is pinned exactly. Adaptive methods may take a step more or less where
//! sums are rounded otherwise (another processor, another compiler), so theirs is held to 3 %.

use gearbench::context::Context;
use gearbench::experiment::conditions::Conditions;
use gearbench::experiment::runner::Runner;
use gearbench::scene_file;
use gearbench::studies::compare::{Plan, compare};
use gearbench_reports::record::Run;
use std::fmt::Write;
use std::path::PathBuf;

const HEADER: &str = "# Golden runs of scene spur_impact, made by:\n\
    #   GEARBENCH_UPDATE_GOLDEN=1 cargo test --release -p gearbench --test golden\n\
    model,integrator,status,dofs,steps,rejected,force_evaluations,newton_iterations,events,\
    force_l2_aligned,peak_force_n,impulse_ns,speed_end_pinion_rad_s,speed_end_wheel_rad_s\n";

fn runs() -> Vec<Run> {
    // Models with integrators of their own are finite elements: other tests hold those.
    let labels = Some("rigid,movable-teeth,rigid-iso6336");
    let scene = scene_file::load_for(
        &Context::default(),
        "spur_impact",
        scene_file::Selection::Labels(labels),
    );
    let mut scene = scene.unwrap_or_else(|e| panic!("{e:?}"));
    let references = scene.load_own_references(false).unwrap();
    let choices = scene.select(labels).unwrap();
    let plan = Plan {
        conditions: Conditions {
            samples: 200,
            repeats: 0,
            ..Conditions::of(&scene)
        },
        tolerance: None,
        ..Plan::of(&scene, &choices, &references)
    };
    compare(&plan, &Runner::default()).unwrap().runs
}

fn row(r: &Run) -> String {
    let m = r.against("calculix").unwrap();
    let x = |v: Option<f64>| v.map_or("-".to_string(), |v| format!("{v:.6e}"));
    let mut line = format!(
        "{},{},{},{},{},{},{},{},{}",
        r.model_label().replace(", ", ":"),
        r.integrator,
        r.status,
        r.dofs,
        r.steps,
        r.rejected,
        r.force_evaluations,
        r.newton_iterations,
        r.events
    );
    for v in [
        m.force_l2_aligned,
        m.peak_force_n,
        m.impulse_ns,
        m.speed_end("pinion"),
        m.speed_end("wheel"),
    ] {
        write!(line, ",{}", x(v)).unwrap();
    }
    line
}

#[test]
fn spur_impact_is_what_it_was() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden/spur_impact.csv");
    let runs = runs();
    let now: Vec<String> = runs.iter().map(row).collect();
    if std::env::var_os("GEARBENCH_UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, format!("{HEADER}{}\n", now.join("\n"))).unwrap();
    }
    let stored = std::fs::read_to_string(&path).unwrap();
    let data = |l: &&str| !l.starts_with('#') && !l.starts_with("model,");
    let before: Vec<&str> = stored.lines().filter(data).collect();
    assert_eq!(
        before.len(),
        now.len(),
        "other runs than before:\n{}",
        now.join("\n")
    );
    for ((was, is), run) in before.iter().zip(&now).zip(&runs) {
        let (a, b): (Vec<&str>, Vec<&str>) = (was.split(',').collect(), is.split(',').collect());
        assert_eq!(a.len(), b.len(), "{was}\n{is}");
        let adaptive = run.rtol.is_some();
        for (i, (x, y)) in a.iter().zip(&b).enumerate() {
            if x == y {
                continue;
            }
            let (Ok(x), Ok(y)) = (x.parse::<f64>(), y.parse::<f64>()) else {
                panic!("was {was}\n is {is}");
            };
            let work = (4..9).contains(&i);
            let allowed = match (work, adaptive) {
                (true, false) => 0.0,
                (true, true) => (0.03 * x.abs()).max(5.0),
                (false, false) => 2e-6 * x.abs(),
                (false, true) => 1e-4 * x.abs(),
            };
            assert!((x - y).abs() <= allowed, "column {i}\nwas {was}\n is {is}");
        }
    }
}
