//! Wall time over simulated time of gears that run under load: `cargo bench --bench real_time [-- --store FILE]`.
//!
//! `loaded_mesh` with rigid gears and with movable teeth: of some methods over their resolutions the cheapest whose own
//! error (relative L2 against the model's converged solution) is at most 0.1 % in the contact force and in the
//! transmission error, setup apart; then both by turns. Elastic gears as shipped, on half-spaces, and with the elements of
//! their meshes in contact: the longest step of the trigonometric method within 1 % of a run at a tenth of it. The work stands beside the times: right-hand sides, steps, events,
//! and what a right-hand side costs with all that belongs to it.

mod support;

use gearbench::scene_file::SceneFile;
use gearbench_integrators::observers::recorder::Recorder;
use gearbench_integrators::{NullSink, Resolution, StepError, TimePlan, Work};
use gearbench_models::scene::{Channel, OfGear, OfMesh, Scene};
use gearbench_models::spec::{FlankContact, PointContact, PointRule};
use serde_json::json;
use std::time::Duration;
use support::ratio::{by_turns, ratios};
use support::scenes::{built, changed, file, method, resolution as text, run, store};
use support::sweep::time;

const COMMAND: &str = "cargo bench --bench real_time -- --store FILE";
const OWN_ERROR: f64 = 1e-3;
const ELASTIC_ERROR: f64 = 1e-2;
const SAMPLES: usize = 4000;

/// Returns force [N] and transmission error [m] on an even grid.
fn series(
    scene: &mut Scene,
    id: &str,
    resolution: Resolution,
    end: f64,
) -> Result<[Vec<f64>; 2], StepError> {
    let grid = (0..=SAMPLES).map(|i| end * i as f64 / SAMPLES as f64);
    let mut recorder = Recorder::on(grid.collect());
    let mut s = scene.initial();
    let plan = TimePlan {
        // A method beyond its limit finds no end.
        time_limit: Some(Duration::from_secs(3)),
        ..TimePlan::new(end, resolution)
    };
    method(id).run(scene, &mut s, &plan, &mut recorder, &mut Work::default())?;
    let column = |channel| {
        let channel = scene.channel(channel);
        channel.map_or_else(Vec::new, |c| recorder.column(c))
    };
    let turned = [0, 1].map(|i| column(Channel::Gear(i, OfGear::Displacement)));
    let radius = [0, 1].map(|i| scene.gears()[i].model.hub().effective_base_radius);
    let error = turned[0].iter().zip(&turned[1]);
    let error = error.map(|(a, b)| radius[0] * a + radius[1] * b).collect();
    Ok([column(Channel::Mesh(0, OfMesh::Force)), error])
}

fn relative(a: &[f64], b: &[f64]) -> f64 {
    let differ: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (differ / b.iter().map(|b| b * b).sum::<f64>()).sqrt()
}

struct RunResult {
    id: &'static str,
    resolution: Resolution,
    errors: [f64; 2],
    wall: f64,
    work: Work,
}

/// Returns the cheapest run within the error.
fn cheapest(scene: &mut Scene, end: f64) -> Option<RunResult> {
    let converged = series(scene, "dopri5", Resolution::Tolerance(1e-11), end).ok()?;
    let tolerances = (4..=10).map(|i| Resolution::Tolerance(10f64.powf(-0.5 * f64::from(i))));
    let rk4 = [6e-6, 4e-6, 3e-6, 2e-6].map(|h| ("rk4", Resolution::Step(h)));
    let verlet = [2e-6, 1e-6, 5e-7].map(|h| ("velocity-verlet", Resolution::Step(h)));
    let candidates = tolerances
        .flat_map(|r| [("dopri5", r), ("tsit45", r)])
        .chain(rk4)
        .chain(verlet);
    let mut best: Option<RunResult> = None;
    for (id, resolution) in candidates {
        let Ok(found) = series(scene, id, resolution, end) else {
            continue;
        };
        let errors = [0, 1].map(|i| relative(&found[i], &converged[i]));
        if !errors.iter().all(|e| *e <= OWN_ERROR) {
            continue;
        }
        let (wall, work) = time(scene, method(id).as_mut(), resolution, end);
        if best.as_ref().is_none_or(|b| wall < b.wall) {
            best = Some(RunResult {
                id,
                resolution,
                errors,
                wall,
                work,
            });
        }
    }
    best
}

/// Returns the ratio of wall time to simulated time of elastic gears for the longest step within the error, by kind of
/// contact.
fn elastic(file: &SceneFile) -> Vec<(&'static str, RunResult)> {
    let kinds = [
        ("elastic, half-spaces", FlankContact::HalfSpace),
        (
            "elastic, elements",
            FlankContact::Points(PointContact {
                rule: PointRule::Quadrature {
                    along: 3,
                    across: 1,
                },
                ..PointContact::new(1e15)
            }),
        ),
    ];
    let within = |flanks: FlankContact| {
        let mut scene = changed(file, "elastic", |modelling| {
            for contact in &mut modelling.contacts {
                contact.flanks = flanks;
            }
        });
        let id = "trigonometric";
        // The shortest step stands for none within the error.
        let steps = [4e-6, 3e-6, 2e-6, 1.5e-6, 1e-6, 5e-7];
        steps.iter().find_map(|h| {
            let resolution = Resolution::Step(*h);
            let mut of = |h: f64| series(&mut scene, id, Resolution::Step(h), file.duration).ok();
            let (found, fine) = (of(*h)?, of(0.1 * h)?);
            let errors = [0, 1].map(|i| relative(&found[i], &fine[i]));
            if *h > steps[5] && !errors.iter().all(|e| *e <= ELASTIC_ERROR) {
                return None;
            }
            let (wall, work) = time(&mut scene, method(id).as_mut(), resolution, file.duration);
            Some(RunResult {
                id,
                resolution,
                errors,
                wall,
                work,
            })
        })
    };
    kinds
        .into_iter()
        .filter_map(|(label, points)| Some((label, within(points)?)))
        .collect()
}

#[allow(clippy::print_stdout)]
fn main() {
    let file = file("loaded_mesh");
    let end = file.duration;
    let labels = ["rigid", "movable-teeth"];
    let mut scenes = labels.map(|label| built(&file, label, &[]));
    let found = scenes.each_mut().map(|scene| cheapest(scene, end));
    let [Some(rigid), Some(teeth)] = &found else {
        println!("no run within the error");
        return;
    };
    let both = [rigid, teeth];
    let times = by_turns(
        &mut ratios(2.0),
        "loaded_mesh",
        "movable teeth / rigid",
        || {
            [1, 0].map(|k| {
                let plan = TimePlan::new(end, both[k].resolution);
                let mut method = method(both[k].id);
                run(&mut scenes[k], method.as_mut(), &plan, &mut NullSink).2
            })
        },
    );
    let walls = [times[1], times[0]];
    println!(
        "loaded_mesh, {end} s, own error of force and transmission error at most {OWN_ERROR}: cheapest run"
    );
    let elastic = elastic(&file);
    let mut rows: Vec<(&str, &RunResult, f64)> = Vec::new();
    rows.extend((labels.iter().zip(both).zip(walls)).map(|((label, f), wall)| (*label, f, wall)));
    rows.extend(elastic.iter().map(|(label, f)| (*label, f, f.wall)));
    let mut figures = Vec::new();
    for (label, f, wall) in rows {
        let per_rhs = 1e9 * wall / f.work.force_evaluations as f64;
        println!(
            "{label:<20} wall / simulated {:>6.3}  {} {}: errors {:.1e} {:.1e}, {} right-hand sides of {per_rhs:.0} ns, {} steps, {} events",
            wall / end,
            f.id,
            text(f.resolution),
            f.errors[0],
            f.errors[1],
            f.work.force_evaluations,
            f.work.steps,
            f.work.events,
        );
        figures.push(json!({
            "model": label,
            "method": f.id,
            "resolution": text(f.resolution),
            "errors": f.errors,
            "wall_over_simulated": wall / end,
            "right_hand_sides": f.work.force_evaluations,
            "steps": f.work.steps,
            "events": f.work.events,
        }));
    }
    println!("movable teeth / rigid {:.1}", walls[1] / walls[0]);
    store(COMMAND, json!({ "loaded_mesh": figures }));
}
