//! What the elastic model costs: `cargo bench -p gearbench --bench elastic_cost [-- --calculix-cpu-s SECONDS --store FILE]`.
//!
//! 1. One impact (`spur_impact`, reductions made before): elastic with residual compliance beside full finite
//!    elements on the same mesh, the better of explicit and implicit, and beside CalculiX. The time of CalculiX is the
//!    stored one or, better, one measured on this machine (`reference/calculix/regenerate.sh case-a-fine 0.1335e-3`,
//!    processor time), handed over on the command line. `--store` writes figures and machine into a file.
//! 2. Flight: `hammer` with ten times the backlash and duration, so that flights last ten times as long between the
//!    same impacts.
//! 3. Mesh: twice the elements at the same flank nodes.

use gearbench::scene_file::{self, SceneFile};
use gearbench_integrators::{NullSink, Resolution, TimePlan, Work};
use gearbench_models::scene::Scene;
use gearbench_models::spec;
use gearbench_reference::reference;
use serde_json::{Value, json};
use std::time::Instant;

const REPEATS: usize = 15;

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn built(file: &SceneFile, label: &str, changes: &[(&str, f64)]) -> Scene {
    let choice = file
        .model(label)
        .unwrap_or_else(|| panic!("no model {label}"));
    let mut modelling = choice.modelling.clone();
    for gear in &mut modelling.gears {
        for (key, value) in changes {
            gear.parameters
                .insert((*key).to_string(), spec::Value::Number(*value));
        }
    }
    let scene = Scene::build(
        &file.spec_for(choice),
        &modelling,
        gearbench::models::models(),
    );
    scene.unwrap_or_else(|e| panic!("{e}"))
}

/// Median wall time [s] of a run, set up apart.
fn timed(scene: &mut Scene, method: &str, h: f64, end: f64, repeats: usize) -> (f64, Work) {
    let mut counted = Work::default();
    let times = (0..repeats).map(|_| {
        let mut method = gearbench_integrators::method(method).unwrap_or_else(|e| panic!("{e}"));
        let (mut state, mut work) = (scene.initial(), Work::default());
        let plan = TimePlan::new(end, Resolution::Step(h));
        let begin = Instant::now();
        let done = method.run(scene, &mut state, &plan, &mut NullSink, &mut work);
        let wall = begin.elapsed().as_secs_f64();
        done.unwrap_or_else(|e| panic!("{e}"));
        counted = work;
        wall
    });
    (median(times.collect()), counted)
}

#[allow(clippy::print_stdout)]
fn impact(calculix: Option<f64>) -> Value {
    let file = scene_file::load("spur_impact").unwrap_or_else(|e| panic!("{e:?}"));
    let end = file.duration;
    let mut runs = Vec::new();
    for modes in [0.0, 70.0, 100.0, 200.0] {
        let mut scene = built(&file, "elastic", &[("modes", modes)]);
        let (wall, work) = timed(&mut scene, "trigonometric", 1e-6, end, REPEATS);
        runs.push((modes, wall, work));
    }
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
    json!({
        "scene": "spur_impact",
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
    let file = scene_file::load("hammer").unwrap_or_else(|e| panic!("{e:?}"));
    let ten = scene_file::load("benchmarks/benches/support/hammer_ten.toml")
        .or_else(|_| scene_file::load("benches/support/hammer_ten.toml"))
        .unwrap_or_else(|e| panic!("{e:?}"));
    let mut pair = [
        (built(&file, "elastic", &[]), file.duration),
        (built(&ten, "elastic", &[]), ten.duration),
    ];
    // By turns, so that both see the same machine.
    let mut times = [Vec::new(), Vec::new()];
    let mut works = [Work::default(); 2];
    for _ in 0..REPEATS {
        for k in 0..2 {
            let (scene, end) = &mut pair[k];
            let (wall, work) = timed(scene, "trigonometric", 1e-6, *end, 1);
            times[k].push(wall);
            works[k] = work;
        }
    }
    let [short, long] = times.map(median);
    println!(
        "hammer, elastic: {:.2} ms and {} steps; ten times the flight {:.2} ms and {} steps; ratio {:.3}",
        1e3 * short,
        works[0].steps,
        1e3 * long,
        works[1].steps,
        long / short
    );
    json!({ "scene": "hammer", "wall_s": short, "ten_times_the_flight_s": long, "ratio": long / short })
}

#[allow(clippy::print_stdout)]
fn mesh() -> Value {
    let file = scene_file::load("hammer").unwrap_or_else(|e| panic!("{e:?}"));
    let end = 2e-3;
    let coarse = [("rim_elements", 4.0)];
    let fine = [("rim_elements", 14.0)];
    let mut pair = [
        built(&file, "elastic", &coarse),
        built(&file, "elastic", &fine),
    ];
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..REPEATS {
        for (scene, times) in pair.iter_mut().zip(&mut times) {
            let (wall, work) = timed(scene, "trigonometric", 1e-6, end, 1);
            times.push(wall / work.steps as f64);
        }
    }
    let [small, large] = times.map(median);
    println!(
        "mesh: {:.2} us a step, {:.2} us with more than twice the elements at the same flank nodes; ratio {:.3}",
        1e6 * small,
        1e6 * large,
        large / small
    );
    json!({ "scene": "hammer", "step_s": small, "twice_the_elements_step_s": large, "ratio": large / small })
}

fn main() {
    let (mut calculix, mut store) = (None, None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--calculix-cpu-s" => calculix = words.next().and_then(|w| w.parse().ok()),
            "--store" => store = words.next(),
            _ => {}
        }
    }
    let figures = json!({
        "command": "cargo bench -p gearbench --bench elastic_cost -- --calculix-cpu-s SECONDS --store FILE",
        "calculix_command": "time reference/calculix/regenerate.sh case-a-fine 0.1335e-3",
        "machine": gearbench::experiment::machine::machine(),
        "date": gearbench::experiment::machine::now(),
        "commit": gearbench::experiment::machine::COMMIT,
        "impact": impact(calculix),
        "flight": flight(),
        "mesh": mesh(),
    });
    if let Some(file) = store {
        let text = format!("{figures:#}\n");
        std::fs::write(&file, text).unwrap_or_else(|e| panic!("{file}: {e}"));
    }
}
