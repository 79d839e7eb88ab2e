//! Ends of the path of contact, counts of events, both flanks of the backlash, runs without event location.

use gearbench_integrators::{
    AcceptedStep, Control, Resolution, SecondOrderSystem, Sink, State, TimePlan,
};
use gearbench_models::contact::Candidate;
use gearbench_models::geometry::Side;
use gearbench_models::law::Damping;
use gearbench_models::spec::{
    ContactSpec, Load, ModelSpec, Mount, Profile, SceneSpec, effective_radius, mesh_layout,
};
use gearbench_tests::*;

/// Returns a pinion driven against a load on the wheel, from contact at rest.
fn driven(speed: f64, torque: f64) -> SceneSpec {
    let mut spec = case_a(0.0);
    let side = if speed > 0.0 { Side::Left } else { Side::Right };
    spec.meshes[0].start = start(side, 0.0);
    spec.gears[0].mount = Mount::Driven(Profile::Constant(speed));
    spec.gears[1].speed = -speed / 1.5;
    spec.gears[1].loads = vec![Load::Applied(Profile::Constant(speed.signum() * torque))];
    spec
}

fn damped(per_width: f64) -> ContactSpec {
    ContactSpec {
        damping: Damping::KelvinVoigtRatio { ratio: 0.1 },
        ..contact(per_width)
    }
}

/// Sink that records the states before and after switches or hand-overs.
#[derive(Default)]
struct TransitionSink(Vec<[State; 2]>);

impl Sink for TransitionSink {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, _step: &AcceptedStep<'_>) -> Control {
        Control::Continue
    }
    fn restarted(&mut self, _sys: &mut dyn SecondOrderSystem, before: &State, after: &State) {
        self.0.push([before.clone(), after.clone()]);
    }
}

#[test]
fn pairs_come_in_and_leave_open_and_touch_beside_the_path() {
    for speed in [80.0, -80.0] {
        for id in [
            "rk4",
            "dopri5",
            "velocity-verlet",
            "generalised-alpha",
            "bdf",
            "tsit45",
        ] {
            let spec = driven(speed, 60.0);
            let l = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
            let mut scene = build(&spec, &[rigid(), rigid()], &damped(1.5e10));
            let row = gearbench_integrators::method(id).unwrap().info();
            let (start, mut switches) = (scene.initial(), TransitionSink::default());
            let pitches = 6.0;
            let t_end = pitches * std::f64::consts::TAU / 20.0 / speed.abs();
            let plan = TimePlan::new(t_end, resolution(row, 2e-6, 1e-6));
            watched(&mut scene, start, id, &plan, &mut switches);
            let (mut zones, mut touches) = (0, 0);
            for [before, after] in &switches.0 {
                let key = |c: &Candidate| (c.slot, c.points[0].tooth);
                let [of_before, of_after] = [before, after].map(|s| listed(&scene, s));
                let only = |a: &[(usize, Candidate)], b: &[(usize, Candidate)]| -> Vec<Candidate> {
                    let other = |c: &Candidate| b.iter().any(|(_, x)| key(x) == key(c));
                    a.iter().map(|(_, c)| *c).filter(|c| !other(c)).collect()
                };
                let mut changed = only(&of_before, &of_after);
                changed.extend(only(&of_after, &of_before));
                zones += changed.len();
                for c in &changed {
                    // Far beyond the path, and as far open as an edge is followed.
                    let beyond = (l.path[0] - c.s).max(c.s - l.path[1]);
                    assert!(
                        c.gap > 1e-4 && beyond > 5e-4,
                        "{id}: {:.1e} m, {beyond:.1e} m",
                        c.gap
                    );
                }
                if changed.is_empty() {
                    // Where the force is nothing, or nearly so: a damper releases flanks that still overlap.
                    let nearest = (of_before.iter())
                        .map(|(_, c)| c.gap.abs())
                        .fold(f64::INFINITY, f64::min);
                    assert!(nearest < 1e-5, "{id}: {nearest:.1e} m off touch");
                    touches += 1;
                }
            }
            // Each pitch one pair comes in and one leaves on each flank; on the loaded flank it touches and parts.
            assert!(
                (zones as f64 - 4.0 * pitches).abs() <= 2.0,
                "{id}: {zones} ends in {pitches} pitches"
            );
            assert!(
                (f64::from(touches) - 2.0 * pitches).abs() <= 6.0,
                "{id}: {touches} touches in {pitches} pitches"
            );
        }
    }
}

#[test]
fn many_rotations_have_the_expected_number_of_events() {
    // Ten revolutions: 200 pitches, in each of which a pair is looked at, touches, parts and is left on the loaded flank,
    // and looked at and left on the other; nothing else once the start has settled.
    let spec = driven(200.0, 60.0);
    let mut scene = build(&spec, &[rigid(), rigid()], &damped(1.5e10));
    let t_end = 10.0 * std::f64::consts::TAU / 200.0;
    let o = run(&mut scene, "dopri5", Resolution::Tolerance(1e-8), t_end).unwrap("rotation");
    let events = o.work.events as f64;
    assert!(
        (events - 1200.0).abs() < 25.0,
        "{events} events in 200 pitches"
    );
    let residual = o.ledger.residual_relative();
    assert!(
        o.normal_min >= -1e-6 && residual.abs() < 1e-5,
        "{} N, {residual:.1e}",
        o.normal_min
    );
    let wheel = o.state.q[0] * 1.5 / (10.0 * std::f64::consts::TAU);
    assert!((wheel + 1.0).abs() < 1e-4, "{wheel}");
}

#[test]
fn movable_and_elastic_teeth_pass_the_ends_of_the_path_at_any_speed() {
    // A tooth that takes load as it enters gives way; it must not be thrown out again and again.
    let teeth = movable(5.3e8, 4.8e-3, 150.0);
    let soft = movable(5e7, 4.8e-3, 20.0);
    let models: [[ModelSpec; 2]; 3] = [
        [teeth.clone(), teeth],
        [soft.clone(), soft],
        [web(0.05), rigid()],
    ];
    for models in models {
        for speed in [0.5, -0.5, 5.0, 100.0] {
            let spec = driven(speed, 60.0);
            let contact = damped(2e10);
            let mut scene = build(&spec, &models, &contact);
            // One pitch, so that each end is passed once on each flank; slow runs start next to an end.
            let mut s = scene.initial();
            let l = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
            let mut close = spec.clone();
            close.meshes[0].start.path_coordinate = Some(l.path[1] - 2e-5);
            scene = build(&close, &models, &contact);
            s.clone_from(&scene.initial());
            let t_end = (1e-4 / (0.0376 * speed.abs())).max(2e-3);
            let plan = TimePlan {
                max_steps: 3_000_000,
                ..TimePlan::new(t_end, Resolution::Tolerance(1e-6))
            };
            let o = run_from(&mut scene, s, "dopri5", &plan)
                .unwrap(&format!("{} at {speed} rad/s", models[0].id()));
            let pitches = speed.abs() * t_end / (std::f64::consts::TAU / 20.0);
            let most = 60.0 + 60.0 * pitches;
            assert!(
                (o.work.events as f64) < most,
                "{} at {speed} rad/s: {} events",
                models[0].id(),
                o.work.events
            );
        }
    }
}

#[test]
fn hammering_in_the_backlash_keeps_the_energy() {
    for model in [rigid(), movable(5.3e8, 4.8e-3, 0.0), web(0.0)] {
        let spec = case_a(34e-6);
        let both = [model.clone(), model.clone()];
        let mut scene = build(&spec, &both, &contact(2e10));
        let (start, mut switches) = (scene.initial(), TransitionSink::default());
        let plan = TimePlan::new(3e-3, Resolution::Tolerance(1e-9));
        let (_, work) = watched(&mut scene, start, "dopri5", &plan, &mut switches);
        // Both flanks take part, again and again.
        let mut flanks = [0, 0];
        for [s, _] in &switches.0 {
            let touching = |side: Side| {
                candidates(&scene, s).iter().any(|(m, c)| {
                    c.gap.abs() < 1e-13 && scene.meshes()[*m].search.flank_of(c).1 == side
                })
            };
            flanks[0] += usize::from(touching(Side::Left));
            flanks[1] += usize::from(touching(Side::Right));
        }
        assert!(
            flanks.iter().all(|&n| n >= 8),
            "{}: {flanks:?} events on the flanks",
            model.id()
        );
        let o = run(&mut scene, "dopri5", Resolution::Tolerance(1e-9), 3e-3).unwrap("hammer");
        let e = o.ledger.end.total() / o.ledger.start.unwrap().total() - 1.0;
        assert!(
            e.abs() < 1e-6,
            "{}: energy changes by {e:.2e} over {} events",
            model.id(),
            work.events
        );
    }
}

#[test]
fn without_events_a_run_converges_to_the_same_motion() {
    // The clipped force with its kinks at unlocated times: order two is all that remains, and velocity Verlet
    // keeps it.
    for model in [rigid(), movable(5.3e8, 4.8e-3, 0.0)] {
        let models = [model.clone(), model.clone()];
        let contact = contact(2e10);
        let run_at = |resolution: Resolution, events: bool, id: &str| {
            let mut scene = build(&case_a(3e-6), &models, &contact);
            let s = scene.initial();
            let plan = TimePlan {
                events,
                ..TimePlan::new(2e-4, resolution)
            };
            run_from(&mut scene, s, id, &plan).unwrap(id)
        };
        let reference = run_at(Resolution::Tolerance(1e-11), true, "dopri5");
        let steps = [4e-7, 2e-7, 1e-7, 5e-8, 2.5e-8];
        let errors: Vec<f64> = steps
            .iter()
            .map(|&h| {
                let o = run_at(Resolution::Step(h), false, "velocity-verlet");
                assert_eq!(o.work.events, 0);
                (o.state.v[0] - reference.state.v[0]).abs() / 20.0
            })
            .collect();
        let order = slope(&steps, &errors);
        assert!(
            order > 1.7,
            "{}: order {order:.2} without events, errors {errors:?}",
            model.id()
        );
        let o = run_at(Resolution::Tolerance(1e-8), false, "dopri5");
        let error = (o.state.v[0] - reference.state.v[0]).abs() / 20.0;
        assert!(
            error < 1e-4,
            "{}: dopri5 without events is off by {error:.2e}",
            model.id()
        );
        let _ = effective_radius(&case_a(0.0).gears[0].body);
    }
}

#[test]
fn impact_speeds_belong_to_their_own_impact() {
    // Hammering with a law that needs the impact speed: each impact realises the law's restitution, also after
    // many turns, where rounding in the angles is larger.
    let damping = Damping::Flores { e: 0.8 };
    let chi = 1.6 * 0.2 / 0.8;
    let r = gearbench_models::law::realised_restitution(chi);
    for turned in [0.0, 300.0, 30_000.0] {
        let spec = case_a(34e-6);
        let contact = ContactSpec {
            damping,
            ..contact(2e10)
        };
        let mut scene = build(&spec, &[rigid(), rigid()], &contact);
        let mut s = scene.initial();
        let pitch = std::f64::consts::TAU / 20.0;
        s.q[0] += turned * pitch;
        s.q[1] -= turned * pitch / 1.5;
        let effective_radii = [0, 1].map(|i| effective_radius(&spec.gears[i].body));
        let closing = |s: &State| s.v[0] * effective_radii[0] + s.v[1] * effective_radii[1];
        let first = closing(&s).abs();
        let mut switches = TransitionSink::default();
        let plan = TimePlan::new(1.2e-3, Resolution::Tolerance(1e-9));
        watched(&mut scene, s, "dopri5", &plan, &mut switches);
        // Free flights between impacts: their relative speeds fall by r each time.
        let mut speeds: Vec<f64> = Vec::new();
        for [s, _] in &switches.0 {
            let gap = candidates(&scene, s)
                .iter()
                .map(|(_, c)| c.gap.abs())
                .fold(f64::INFINITY, f64::min);
            let v = closing(s).abs();
            if gap < 1e-11 && speeds.last().is_none_or(|last| (last - v).abs() > 1e-6 * v) {
                speeds.push(v);
            }
        }
        assert!(speeds.len() >= 4, "{speeds:?}");
        for (i, v) in speeds.iter().enumerate() {
            let want = first * r.powi(i as i32);
            assert!(
                (v / want - 1.0).abs() < 1e-5,
                "turned by {turned} pitches, flight {i}: {v} m/s, {want} m/s"
            );
        }
    }
}
