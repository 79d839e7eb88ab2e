//! Steps of helical gears compared with those of the same mesh without helix angle, on bearings, and with full finite
//! elements.

use super::ratio::{Ratios, by_turns};
use super::scenes::{built, run};
use gearbench::context::Context;
use gearbench::scene_file::{Origin, SceneFile};
use gearbench_integrators::system::{SecondOrderSystem, State};
use gearbench_integrators::{AcceptedStep, Control, NullSink, Resolution, Sink, TimePlan};
use gearbench_models::scene::Scene;

const STEP: f64 = 1e-6;

/// Duration of the impact that is run with full finite elements in one turn [s], and the step of their explicit
/// method.
const FULL: (f64, f64) = (4e-7, 2e-8);

/// Motion of the gears.
#[derive(Clone, Copy, Debug)]
pub enum Motion {
    /// The pinion strikes the wheel at rest.
    Impact,
    /// A constant torque on the pinion [N m], in balance with that of the wheel.
    Load(f64),
}

/// Stiff bearings that couple no directions.
const BEARING: &str =
    "bearing = { stiffness = [5.0e8, 5.0e8, 2.0e8, 2.0e5, 2.0e5, 0.0] }\nspin_terms = \"off\"";

/// Returns the scene at a helix angle [deg], on bearings or on hubs that only rotate.
pub fn scene(helix: f64, motion: Motion, label: &str, bearings: bool) -> (Scene, f64) {
    let (torque, wheel) = match motion {
        Motion::Impact => (0.0, 0.0),
        Motion::Load(torque) => (torque, -20.0 * 2.0 / 3.0),
    };
    let mut text = include_str!("helical_scene.txt").to_string();
    for (word, x) in [
        ("-HELIX", -helix),
        ("HELIX", helix),
        ("TORQUE", torque),
        ("REACTION", 1.5 * torque),
        ("SPEED", wheel),
    ] {
        text = text.replace(word, &format!("{x:?}"));
    }
    text = text.replace("BEARING", if bearings { BEARING } else { "" });
    let file = SceneFile::unbuilt(
        &Context::default(),
        "helical",
        &text,
        Origin::Shipped,
        false,
    )
    .unwrap_or_else(|e| panic!("{e:?}"));
    (built(&file, label, &[]), file.duration)
}

/// Counters of an evaluation, on average over the steps of a run.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    steps: usize,
    touching: usize,
    pairs: usize,
    points: usize,
    projections: usize,
    met: usize,
    pushing: usize,
    nodes: usize,
}

/// Sink that records the states of a run.
struct States(Vec<State>);

impl Sink for States {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        self.0.push(step.to.clone());
        Control::Continue
    }
}

fn counts(scene: &mut Scene, end: f64) -> Counts {
    let mut states = States(vec![]);
    let mut method = gearbench_integrators::table::TRIGONOMETRIC.build();
    let plan = TimePlan::new(end, Resolution::Step(STEP));
    run(scene, method.as_mut(), &plan, &mut states);
    let mut c = Counts::default();
    for s in &states.0 {
        let pushing = scene.contact_forces(s.at()).len();
        c.steps += 1;
        if pushing == 0 {
            continue;
        }
        c.touching += 1;
        c.pushing += pushing;
        if let Some(points) = scene.meshes()[0].search.points() {
            let work = points.work();
            c.pairs += work.pairs;
            c.points += work.points;
            c.projections += work.projections;
            c.met += work.nodes;
        }
        c.nodes += scene.pressed_nodes(0).len() + scene.pressed_nodes(1).len();
    }
    c
}

/// Compares the time of a step [s] of a helical mesh with that of the same mesh without helix angle, in alternation.
#[allow(clippy::print_stdout)]
pub fn compare(criterion: &mut Ratios, helix: f64, motion: Motion, label: &str) {
    let scenes = [helix, 0.0].map(|helix| scene(helix, motion, label, false));
    let id = format!("{label}, {helix} degrees, {motion:?}");
    side_by_side(
        criterion,
        ("helical / spur", &id, 3.0),
        ["helical", "spur"],
        scenes,
    );
}

/// Compares the time of a step of a mesh on bearings with that on hubs that only rotate.
pub fn bearings(criterion: &mut Ratios, helix: f64, motion: Motion, label: &str) {
    let scenes = [true, false].map(|bearings| scene(helix, motion, label, bearings));
    let id = format!("{label}, {helix} degrees, {motion:?}");
    side_by_side(
        criterion,
        ("bearings / none", &id, 1.2),
        ["bearings", "none"],
        scenes,
    );
}

/// Compares the wall time of full finite elements per simulated time with that of elastic gears: the same gears, mesh,
/// contact and impact. The explicit method runs the first steps of the impact, the elastic gears all of it.
#[allow(clippy::print_stdout)]
pub fn against_full(criterion: &mut Ratios, helix: f64) {
    let (mut full, _) = scene(helix, Motion::Impact, "fe-lumped", false);
    let (mut elastic, end) = scene(helix, Motion::Impact, "elastic", false);
    let times = by_turns(
        criterion,
        "fe / elastic",
        &format!("{helix} degrees"),
        || {
            let mut method = gearbench_integrators::table::VELOCITY_VERLET.build();
            let plan = TimePlan::new(FULL.0, Resolution::Step(FULL.1));
            let (_, _, wall) = run(&mut full, method.as_mut(), &plan, &mut NullSink);
            let mut method = gearbench_integrators::table::TRIGONOMETRIC.build();
            let plan = TimePlan::new(end, Resolution::Step(STEP));
            let (_, _, beside) = run(&mut elastic, method.as_mut(), &plan, &mut NullSink);
            [wall / FULL.0, beside / end]
        },
    );
    println!(
        "{helix} degrees, fe / elastic per simulated time: {:.0} (bar 1000)",
        times[0] / times[1]
    );
    println!(
        "  fe, {} coordinates: {:.0} ms a microsecond; elastic, {}: {:.3} ms",
        full.layout().n,
        times[0] * 1e-3,
        elastic.layout().n,
        times[1] * 1e-3
    );
}

#[allow(clippy::print_stdout)]
fn side_by_side(
    criterion: &mut Ratios,
    (group, id, bar): (&str, &str, f64),
    names: [&str; 2],
    mut scenes: [(Scene, f64); 2],
) {
    let counts = [0, 1].map(|k| {
        let (scene, end) = &mut scenes[k];
        counts(scene, *end)
    });
    let times = by_turns(criterion, group, id, || {
        [0, 1].map(|k| {
            let (scene, end) = &mut scenes[k];
            let mut method = gearbench_integrators::table::TRIGONOMETRIC.build();
            let plan = TimePlan::new(*end, Resolution::Step(STEP));
            let (_, work, wall) = run(scene, method.as_mut(), &plan, &mut NullSink);
            wall / work.steps as f64
        })
    });
    println!(
        "{id}, {group}: ratio {:.2} (bar {bar})",
        times[0] / times[1]
    );
    for (k, name) in names.into_iter().enumerate() {
        let c = counts[k];
        let per = |n: usize| n as f64 / c.touching.max(1) as f64;
        println!(
            "  {name:<8} {:8.2} us a step; of {} steps {} touch: {:.1} pairs of flanks, {:.0} points placed, {:.0} projected, {:.0} nodes met, {:.0} points pushing, {:.0} nodes pressed",
            times[k] * 1e6,
            c.steps,
            c.touching,
            per(c.pairs),
            per(c.points),
            per(c.projections),
            per(c.met),
            per(c.pushing),
            per(c.nodes)
        );
    }
}
