//! Cost of movable teeth compared with rigid gears, in one run: `cargo bench --bench model_cost`.
//!
//! 1. The same method at the same step, by turns: wall time per run of `spur_impact`.
//! 2. At an own error of 1 % (relative L2 of the force history against the model's own converged solution): the
//!    cheapest method and resolution of each model (a search among candidates: not by criterion).

mod support;

use gearbench_integrators::{METHODS, NullSink, Resolution, Stepping, TimePlan};
use gearbench_models::scene::{Channel, OfMesh, Scene};
use support::ratio::{Ratios, by_turns, ratios};
use support::scenes::{built, file, resolution as text, run};
use support::sweep::{record, sweep, time};

const OWN_ERROR: f64 = 0.01;

fn grid(end: f64) -> Vec<f64> {
    (0..=1000).map(|i| end * f64::from(i) / 1000.0).collect()
}

struct CheapestRun {
    wall: f64,
    what: String,
    error: f64,
    forces: u64,
}

fn best(scene: &mut Scene, end: f64) -> Option<CheapestRun> {
    let grid = grid(end);
    let mut tight = gearbench_integrators::table::DOPRI5.build();
    let converged = record(
        scene,
        tight.as_mut(),
        Resolution::Tolerance(1e-11),
        &grid,
        Channel::Mesh(0, OfMesh::Force),
    )
    .ok()?;
    let size: f64 = converged.iter().map(|f| f * f).sum();
    let mut best: Option<CheapestRun> = None;
    for row in METHODS {
        for resolution in sweep(row.info.stepping != Stepping::Fixed, 3e-5) {
            let mut method = row.build();
            let Ok(force) = record(
                scene,
                method.as_mut(),
                resolution,
                &grid,
                Channel::Mesh(0, OfMesh::Force),
            ) else {
                continue;
            };
            let error: f64 = force
                .iter()
                .zip(&converged)
                .map(|(a, b)| (a - b).powi(2))
                .sum();
            let error = (error / size).sqrt();
            if error > OWN_ERROR || error.is_nan() {
                continue;
            }
            let (wall, work) = time(scene, method.as_mut(), resolution, end);
            if best.as_ref().is_none_or(|b| wall < b.wall) {
                let what = format!("{}, {}", row.info.id, text(resolution));
                best = Some(CheapestRun {
                    wall,
                    what,
                    error,
                    forces: work.force_evaluations,
                });
            }
        }
    }
    best
}

/// Compares movable teeth with rigid gears, method by method.
#[allow(clippy::print_stdout)]
fn same_step(criterion: &mut Ratios, rigid: &mut Scene, teeth: &mut Scene, end: f64) {
    let plan = TimePlan::new(end, Resolution::Step(5e-7));
    let mut lines = Vec::new();
    for row in METHODS
        .iter()
        .filter(|m| m.info.stepping != Stepping::Adaptive && !m.info.linear_part)
    {
        let mut method = row.build();
        let mut steps = 0;
        let [b, a] = by_turns(criterion, "movable teeth / rigid", row.info.id, || {
            [&mut *teeth, &mut *rigid].map(|scene| {
                let (_, work, wall) = run(scene, method.as_mut(), &plan, &mut NullSink);
                steps = work.steps;
                wall
            })
        });
        let per_step = |wall: f64| format!("{:.0} ns/step", 1e9 * wall / steps as f64);
        lines.push(format!(
            "{:<22} {:>12} {:>14} {:>7.2}",
            row.info.id,
            per_step(a),
            per_step(b),
            b / a
        ));
    }
    println!(
        "same method, same step (0.5 us), spur_impact, {:.0} us",
        end * 1e6
    );
    println!(
        "{:<22} {:>12} {:>14} {:>7}",
        "method", "rigid", "movable teeth", "ratio"
    );
    println!("{}", lines.join("\n"));
}

#[allow(clippy::print_stdout)]
fn main() {
    let file = file("spur_impact");
    let end = file.duration;
    let [mut rigid, mut teeth] = ["rigid", "movable-teeth"].map(|label| built(&file, label, &[]));
    same_step(&mut ratios(0.5), &mut rigid, &mut teeth, end);
    println!(
        "\nat an own error of {:.0} % of the force history, cheapest method of each",
        100.0 * OWN_ERROR
    );
    if let (Some(a), Some(b)) = (best(&mut rigid, end), best(&mut teeth, end)) {
        for (name, x) in [("rigid", &a), ("movable teeth", &b)] {
            println!(
                "{name:<14} {:>8.1} us  {} ({} force evaluations, error {:.2} %)",
                x.wall * 1e6,
                x.what,
                x.forces,
                100.0 * x.error
            );
        }
        println!("ratio {:.1}", b.wall / a.wall);
    }
}
