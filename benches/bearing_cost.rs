//! This bench compares the cost of a step of rigid helical gears on bearings with that on fixed axes
//! (`cargo bench --bench bearing_cost`).
//!
//! Both runs have the same gears, loads, law and method (`dopri5`, events located). They take turns, and the ratio is one of processor
//! time of one thread per step. On fixed
//! axes the gap of a pair is a linear function of two angles; on bearings that tilt it is the least distance of two helicoids in
//! space, slice by slice.

mod support;

use gearbench::context::Context;
use gearbench::scene_file::{Origin, SceneFile};
use gearbench_integrators::{NullSink, Resolution, TimePlan, Work};
use gearbench_models::scene::Scene;
use support::ratio::{busy_seconds, by_turns, ratios};
use support::scenes::built;

/// Bearings of both gears, whose tilt is free.
const BEARINGS: [&str; 2] = [
    "bearing = { stiffness = [2e8, 2e8, 1e8, 1e5, 1e5, 0.0], damping = [2e3, 2e3, 1e3, 10.0, 10.0, 0.0] }",
    "bearing = { stiffness = [4e8, 4e8, 2e8, 4e5, 4e5, 0.0], damping = [4e3, 4e3, 2e3, 20.0, 20.0, 0.0] }",
];

fn scene(bearings: bool) -> (Scene, f64) {
    let mut text = include_str!("support/bearing_scene.txt").to_string();
    for (word, bearing) in ["PINION_BEARING", "WHEEL_BEARING"].iter().zip(BEARINGS) {
        text = text.replace(word, if bearings { bearing } else { "" });
    }
    let file = SceneFile::unbuilt(
        &Context::default(),
        "helical_bearings",
        &text,
        Origin::Shipped,
        false,
    )
    .unwrap_or_else(|e| panic!("{e:?}"));
    (built(&file, "rigid", &[]), file.duration)
}

/// Returns the processor time of a step [s], and the work of a run.
fn timed((scene, end): &mut (Scene, f64)) -> (f64, Work) {
    let mut method = gearbench_integrators::table::DOPRI5.build();
    let plan = TimePlan::new(*end, Resolution::Tolerance(1e-6));
    let (mut state, mut work) = (scene.initial(), Work::default());
    let busy = busy_seconds(|| {
        let done = method.run(scene, &mut state, &plan, &mut NullSink, &mut work);
        done.unwrap_or_else(|e| panic!("{e}"));
    });
    (busy / work.steps as f64, work)
}

#[allow(clippy::print_stdout)]
fn main() {
    let mut scenes = [true, false].map(scene);
    let mut works = [Work::default(); 2];
    let times = by_turns(
        &mut ratios(2.0),
        "bearings / fixed axes",
        "rigid, helical",
        || {
            [0, 1].map(|k| {
                let (time, work) = timed(&mut scenes[k]);
                works[k] = work;
                time
            })
        },
    );
    println!(
        "rigid helical gears, bearings over fixed axes: {:.1} times the processor time of a step",
        times[0] / times[1]
    );
    for (name, (time, work)) in ["bearings", "fixed axes"]
        .iter()
        .zip(times.iter().zip(works))
    {
        println!(
            "  {name:<10} {:8.2} us a step; {} steps, {} force evaluations, {} events",
            time * 1e6,
            work.steps,
            work.force_evaluations,
            work.events
        );
    }
}
