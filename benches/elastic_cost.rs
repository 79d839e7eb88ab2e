//! Cost of the elastic model: `cargo bench --bench elastic_cost [-- --calculix-cpu-s SECONDS --store FILE]`, or one part
//! of it: `cargo bench --bench elastic_cost -- --only damping`. Times of parts 2 to 4 are processor time.
//!
//! 1. One impact (`spur_impact`, reductions made before): elastic with residual compliance beside full finite
//!    elements on the same mesh, the better of explicit and implicit, and beside CalculiX. The time of CalculiX is the
//!    stored one or, better, one measured on this machine (`reference/calculix/regenerate.sh case-a-fine 0.1335e-3`,
//!    processor time), handed over on the command line. `--store` writes figures and machine into a file.
//!    The ratios are of hundreds and more: the finite elements run once, not by turns. Beside the elements in contact stand
//!    Hertz's half-spaces, elastic and full alike (`elastic-half-space`, `fe-half-space`).
//! 2. Flight: `hammer` with ten times the backlash and duration, so that flights last ten times as long between the
//!    same impacts.
//! 3. Mesh: twice the elements at the same flank nodes, time per step.
//! 4. Damping: `loaded_mesh` with the damping that it states for all models, modes, residual compliance and contact
//!    alike, beside the same gears without damping, time per step.

mod support;

use gearbench_integrators::{NullSink, Resolution, TimePlan, Work};
use gearbench_models::scene::Scene;
use gearbench_reference::reference;
use serde_json::{Value, json};
use support::ratio::{busy_seconds, by_turns, ratios};
use support::scenes::{after, built, file, method, run, store};

const REPEATS: usize = 15;
const COMMAND: &str = "cargo bench --bench elastic_cost -- --calculix-cpu-s SECONDS --store FILE";

/// Returns the smallest wall time [s] of a number of runs, without set-up.
fn timed(scene: &mut Scene, text: &str, h: f64, end: f64, repeats: usize) -> (f64, Work) {
    let plan = TimePlan::new(end, Resolution::Step(h));
    let mut work = Work::default();
    let times = (0..repeats).map(|_| {
        let (_, counted, wall) = run(scene, method(text).as_mut(), &plan, &mut NullSink);
        work = counted;
        wall
    });
    (times.fold(f64::INFINITY, f64::min), work)
}

/// Runs the trigonometric method on two scenes in alternation, at a microsecond a step; criterion reports the ratio of
/// times by weight.
fn pair(id: &str, pair: &mut [(Scene, f64); 2], weight: fn(&Work) -> f64) -> ([f64; 2], [Work; 2]) {
    let mut works = [Work::default(); 2];
    let times = by_turns(&mut ratios(2.0), "elastic", id, || {
        [0, 1].map(|k| {
            let (scene, end) = &mut pair[k];
            let busy = busy_seconds(|| {
                works[k] = timed(scene, "trigonometric", 1e-6, *end, 1).1;
            });
            busy / weight(&works[k])
        })
    });
    (times, works)
}

#[allow(clippy::print_stdout)]
fn impact(calculix: Option<f64>) -> Value {
    let file = file("spur_impact");
    let end = file.duration;
    let mut runs = Vec::new();
    for modes in [0.0, 70.0, 100.0, 200.0] {
        let mut scene = built(&file, "elastic", &[("modes", modes)]);
        let (wall, work) = timed(&mut scene, "trigonometric", 1e-6, end, REPEATS);
        runs.push((modes, wall, work));
    }
    let mut half_spaces = built(&file, "elastic-half-space", &[]);
    let (on_half_spaces, steps) = timed(&mut half_spaces, "trigonometric", 1e-6, end, REPEATS);
    let full_on_half_spaces = timed(
        &mut built(&file, "fe-half-space", &[]),
        "newmark",
        2.5e-7,
        end,
        1,
    )
    .0;
    let explicit = timed(
        &mut built(&file, "fe-lumped", &[]),
        "velocity-verlet",
        3e-8,
        end,
        1,
    )
    .0;
    let implicit = timed(
        &mut built(&file, "fe", &[]),
        "hht-alpha(alpha=0.05)",
        5e-7,
        end,
        1,
    )
    .0;
    let fe = explicit.min(implicit);
    let published = reference("calculix/case-a-fine").map(|r| r.summary.cpu_s);
    let (calculix, whence) = match (calculix, published) {
        (Some(s), _) => (s, "measured on this machine"),
        (None, Ok(s)) => (s, "stored, another machine"),
        (None, Err(e)) => panic!("{e}"),
    };
    println!("one impact of spur_impact, {:.0} us", 1e6 * end);
    println!(
        "fe: explicit {explicit:.2} s, implicit {implicit:.2} s; CalculiX {calculix:.1} s of processor time ({whence})"
    );
    let per_step = |run: &(f64, f64, Work)| run.1 / run.2.steps as f64;
    println!(
        "elastic, time per step of 200 modes over none: {:.2}",
        per_step(&runs[3]) / per_step(&runs[0])
    );
    println!(
        "elastic, 100 modes: elements in contact over half-spaces: {:.2}",
        runs[2].1 / on_half_spaces
    );
    let mut stored = Vec::new();
    for (modes, wall, work) in runs {
        stored.push(json!({
            "modes": modes,
            "wall_s": wall,
            "steps": work.steps,
            "fe_over_elastic": fe / wall,
            "calculix_over_elastic": calculix / wall,
        }));
        println!(
            "elastic, {modes:>3} modes: {:>7.3} ms, {} steps, {:.2} us each; fe / elastic {:>6.0}, CalculiX / elastic {:>7.0}",
            1e3 * wall,
            work.steps,
            1e6 * wall / work.steps as f64,
            fe / wall,
            calculix / wall
        );
    }
    println!(
        "elastic, 100 modes on half-spaces: {:>7.3} ms, {} steps, {:.2} us each; fe on half-spaces {full_on_half_spaces:.2} s, {:>6.0} times; CalculiX / elastic {:>7.0}",
        1e3 * on_half_spaces,
        steps.steps,
        1e6 * on_half_spaces / steps.steps as f64,
        full_on_half_spaces / on_half_spaces,
        calculix / on_half_spaces
    );
    json!({
        "scene": "spur_impact",
        "half_spaces": {
            "modes": 100,
            "wall_s": on_half_spaces,
            "steps": steps.steps,
            "fe_s": full_on_half_spaces,
            "fe_over_elastic": full_on_half_spaces / on_half_spaces,
            "calculix_over_elastic": calculix / on_half_spaces,
        },
        "simulated_s": end,
        "fe_explicit_s": explicit,
        "fe_implicit_s": implicit,
        "calculix_cpu_s": calculix,
        "calculix_time": whence,
        "elastic": stored,
    })
}

#[allow(clippy::print_stdout)]
fn flight() -> Value {
    let ten = file(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/support/hammer_ten.toml"
    ));
    let mut scenes = [ten, file("hammer")].map(|f| (built(&f, "elastic", &[]), f.duration));
    let ([long, short], works) = pair("ten times the flight", &mut scenes, |_| 1.0);
    println!(
        "hammer, elastic: {:.2} ms and {} steps; ten times the flight {:.2} ms and {} steps; ratio {:.3}",
        1e3 * short,
        works[1].steps,
        1e3 * long,
        works[0].steps,
        long / short
    );
    json!({ "scene": "hammer", "wall_s": short, "ten_times_the_flight_s": long, "ratio": long / short })
}

#[allow(clippy::print_stdout)]
fn mesh() -> Value {
    let file = file("hammer");
    let mut scenes =
        [14.0, 4.0].map(|rim| (built(&file, "elastic", &[("rim_elements", rim)]), 2e-3));
    let ([large, small], _) = pair("twice the elements", &mut scenes, |work| work.steps as f64);
    println!(
        "mesh: {:.2} us a step, {:.2} us with more than twice the elements at the same flank nodes; ratio {:.3}",
        1e6 * small,
        1e6 * large,
        large / small
    );
    json!({ "scene": "hammer", "step_s": small, "twice_the_elements_step_s": large, "ratio": large / small })
}

#[allow(clippy::print_stdout)]
fn damping() -> Value {
    let damped = file("loaded_mesh");
    let text = damped.text().replace("\ndamping = {", "\n# damping = {");
    assert_ne!(text, damped.text());
    let mut undamped = damped.with_text(&text).unwrap_or_else(|e| panic!("{e:?}"));
    let made = undamped.build_selected(&["elastic"]);
    made.unwrap_or_else(|e| panic!("{e:?}"));
    let mut scenes = [damped, undamped].map(|f| (built(&f, "elastic", &[]), 2e-3));
    let ([with, without], _) = pair("damping of all", &mut scenes, |work| work.steps as f64);
    println!(
        "damping: {:.2} us a step, {:.2} us without; ratio {:.3}",
        1e6 * with,
        1e6 * without,
        with / without
    );
    json!({ "scene": "loaded_mesh", "step_s": with, "undamped_step_s": without, "ratio": with / without })
}

fn main() {
    match after("--only").as_deref() {
        None => {}
        Some("flight") => return drop(flight()),
        Some("mesh") => return drop(mesh()),
        Some("damping") => return drop(damping()),
        Some(other) => panic!("--only {other}: expected flight, mesh or damping"),
    }
    let calculix = after("--calculix-cpu-s").and_then(|w| w.parse().ok());
    store(
        COMMAND,
        json!({
            "calculix_command": "time reference/calculix/regenerate.sh case-a-fine 0.1335e-3",
            "impact": impact(calculix),
            "flight": flight(),
            "mesh": mesh(),
            "damping": damping(),
        }),
    );
}
