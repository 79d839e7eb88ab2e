//! Rigid bodies in space whose contacts need no candidates: the same forces as by candidates, and how many nearest points they
//! take.

use super::*;
use gearbench_integrators::system::{Events, SecondOrderSystem};
use gearbench_integrators::{AcceptedStep, Control, Resolution, Sink, TimePlan, Work};
use gearbench_models::law::Damping;
use gearbench_models::spec::{ContactSpec, Load, Profile};
use gearbench_models::stiffness::{IsoVariation, PairStiffness};

/// Returns a damped contact whose stiffness varies along the path and whose pairs have no common elastic body.
fn law() -> ContactSpec {
    let mut law = contact(1.5e10);
    law.stiffness = PairStiffness::Iso6336 {
        variation: IsoVariation::IsoMean,
    };
    law.damping = Damping::RatioAtLoad { ratio: 0.06 };
    law
}

/// Sink that records the states of a run.
struct States(Vec<State>);

impl Sink for States {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        self.0.push(step.to.clone());
        Control::Continue
    }
}

/// Returns a loaded helical pair on bearings that tilt.
fn loaded_pair(modified: bool) -> SceneSpec {
    let mut spec = helical_pair(0.3, 0.0, modified);
    for (gear, (speed, torque)) in spec
        .gears
        .iter_mut()
        .zip([(100.0, 100.0), (-66.6667, 150.0)])
    {
        gear.speed = speed;
        gear.lateral = on_bearings();
        gear.loads.push(Load::Applied(Profile::Constant(torque)));
    }
    spec
}

/// Returns the accepted states of a run of one millisecond with event location.
fn states(spec: &SceneSpec) -> (Scene, Vec<State>) {
    let mut scene = build(spec, &[rigid(), rigid()], &law());
    let (mut state, mut sink) = (scene.initial(), States(Vec::new()));
    let plan = TimePlan::new(1e-3, Resolution::Tolerance(1e-6));
    let mut method = gearbench_integrators::table::DOPRI5.build();
    let mut work = Work::default();
    method
        .run(&mut scene, &mut state, &plan, &mut sink, &mut work)
        .unwrap();
    (scene, sink.0)
}

/// The forces that a step sees are made without candidates; those of reports with them.
#[test]
fn forces_without_candidates_are_those_of_candidates() {
    let mut specs = floating();
    // The carrying flanks, with contacts that are damped while they part.
    for (_, spec) in &mut specs {
        for (gear, speed) in spec.gears.iter_mut().zip([3e-3, -2e-3]) {
            gear.speed = speed;
            gear.loads.push(Load::Applied(Profile::Constant(100.0)));
        }
    }
    for (name, spec) in specs {
        let mut scene = build(&spec, &[rigid(), rigid()], &law());
        let mut numbers = Numbers::new(23);
        let (mut worst, mut pressed) = (0.0_f64, 0);
        for place in 0..12 {
            let mut s = displaced(&scene, &spec, 0.04 * f64::from(place) - 0.25, &mut numbers);
            s.v.iter_mut().for_each(|v| *v = 1e-3 * numbers.draw());
            scene.begin(&mut s, true);
            let mut f = vec![0.0; s.q.len()];
            scene.force(s.at(), &mut f);
            let contacts = scene.contact_forces(s.at());
            pressed += contacts.len();
            for k in 0..2 {
                let of: f64 = contacts.iter().map(|c| c.on_hubs[k]).sum();
                let size: f64 = contacts.iter().map(|c| c.on_hubs[k].abs()).sum();
                let own = f[scene.gears()[k].range().start];
                if size > 0.0 {
                    // The load of 100 N m (N) aside.
                    worst = worst.max((own - 100.0 - of).abs() / size);
                }
            }
        }
        println!("{name}: {pressed} contacts, torques within {worst:.1e}");
        assert!(pressed > 20, "{name}: {pressed}");
        assert!(worst < 1e-8, "{name}: {worst:.2e}");
    }
}

/// Forces and event functions take about two places on a flank for each pair, four where flanks are modified.
#[test]
fn nearest_points_are_found_at_once() {
    for modified in [false, true] {
        let spec = loaded_pair(modified);
        let (mut scene, states) = states(&spec);
        let places = |scene: &Scene| {
            let pairs = scene.meshes()[0].search.pairs().unwrap();
            pairs.evaluated_places()
        };
        let lines = 2 * 16;
        let (mut closed, mut listed) = (0, 0);
        let (mut by_force, mut by_events) = (0, 0);
        for s in &states {
            // Zones of both sides, then modes and touch speeds.
            let (zones, modes) = s.discrete[1..].split_at(2 * lines);
            closed += modes.chunks_exact(2).filter(|m| m[0] != 0.0).count();
            let pairs = zones.chunks_exact(2).map(|z| z[1] - z[0] + 1.0);
            listed += pairs.sum::<f64>() as usize;
            let mut f = vec![0.0; s.q.len()];
            let before = places(&scene);
            scene.force(s.at(), &mut f);
            by_force += places(&scene) - before;
            let mut events = vec![0.0; scene.layout().event_functions];
            let before = places(&scene);
            scene.event_functions(s.at(), &mut events);
            by_events += places(&scene) - before;
        }
        let per_closed = by_force as f64 / closed as f64;
        let per_listed = by_events as f64 / listed as f64;
        println!(
            "modified {modified}: {} states, {closed} closed pairs, {per_closed:.2} places each; {listed} listed, {per_listed:.2} places each",
            states.len()
        );
        assert!(closed > 100, "{closed}");
        let most = if modified { 4.0 } else { 2.0 };
        assert!(
            per_closed < most && per_listed < most,
            "{per_closed} {per_listed}"
        );
    }
}

/// Pairs of the side that does not carry are known to be apart by one of them; once they are not, each is evaluated.
#[test]
fn flanks_behind_close_when_the_backlash_is_taken_up() {
    let spec = loaded_pair(true);
    let (mut scene, states) = states(&spec);
    let s = &states[states.len() / 2];
    let wheel = scene.gears()[1].range().start;
    let mesh = &scene.meshes()[0];
    let slots = mesh.search.pairs().unwrap().slots();
    let modes = &s.discrete[s.discrete.len() - 2 * slots..];
    let closed = modes.chunks_exact(2).filter(|m| m[0] != 0.0).count();
    let ending = |scene: &mut Scene, turn: f64| {
        let mut s = s.clone();
        s.q[wheel] += turn;
        let mut events = vec![0.0; scene.layout().event_functions];
        scene.event_functions(s.at(), &mut events);
        events.iter().filter(|g| **g < 0.0).count()
    };
    let here = ending(&mut scene, 0.0);
    // 0.17 mm on the base circle; the backlash is 0.07 mm.
    let turned = [-3e-3, 3e-3].map(|turn| ending(&mut scene, turn));
    println!("{closed} closed; {here} branches end at the state, {turned:?} after turns");
    assert!(here <= 1, "{here}");
    // All closed pairs open, and those behind close.
    assert!(turned[0].max(turned[1]) > closed + 10, "{turned:?}");
}

/// Event functions of pairs are those of their candidates, but for sides that are known to be apart: these are.
#[test]
fn sides_that_are_left_out_are_apart() {
    for modified in [false, true] {
        let spec = loaded_pair(modified);
        let (mut scene, states) = states(&spec);
        let slots = scene.meshes()[0].search.pairs().unwrap().slots();
        // Those of pairs come last.
        let first = scene.layout().event_functions - slots;
        let pitch = std::f64::consts::TAU * effective_radius(&spec.gears[0].body) / 20.0;
        // Half a percent of the base pitch, rounding aside.
        let far = 4.99e-3 * pitch;
        let wheel = scene.gears()[1].range().start;
        let mut numbers = Numbers::new(7);
        let (mut left_out, mut least, mut same, mut worst) = (0, f64::INFINITY, 0, 0.0_f64);
        for s in states.iter().step_by(4) {
            for turn in 0..12 {
                let mut s = s.clone();
                s.q[wheel] += 2e-4 * (f64::from(turn) - 6.0);
                // Tilts up to 1e-2, most of them small; offsets up to a tenth of a millimetre.
                let tilt = 1e-2 * (5.0 * numbers.draw() - 5.0).exp2();
                for g in scene.gears() {
                    let at = g.range().start;
                    let moves = s.q[at + 1..at + 6].iter_mut();
                    for (q, size) in moves.zip([1e-4, 1e-4, 1e-4, tilt, tilt]) {
                        *q += size * numbers.draw();
                    }
                }
                let modes = s.discrete.len() - 2 * slots;
                let mut events = vec![0.0; first + slots];
                scene.event_functions(s.at(), &mut events);
                for (_, c) in listed(&scene, &s) {
                    let event = events[first + c.slot];
                    if s.discrete[modes + 2 * c.slot] != 0.0 || c.gap <= 0.0 {
                        continue;
                    }
                    if event > 0.9 * pitch {
                        left_out += 1;
                        least = least.min(c.gap);
                    } else if event.min(c.gap) > far {
                        // Lower bounds, which depend on where the search began.
                        same += 1;
                    } else {
                        same += 1;
                        worst = worst.max((event - c.gap).abs());
                    }
                }
            }
        }
        println!(
            "modified {modified}: {left_out} left out, the nearest {least:.2e} m apart; {same} within {worst:.1e} m"
        );
        assert!(left_out > 1000 && same > 1000, "{left_out} {same}");
        assert!(least > far, "{least:e}");
        assert!(worst < 1e-15, "{worst:e}");
    }
}
