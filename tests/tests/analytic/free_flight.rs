//! Closed-form flight: the motion itself, no contact during it, and the work that it saves for every method.

use crate::flight::{Impacts, hammer};
use gearbench_integrators::observers::Tee;
use gearbench_integrators::{
    Events, FlightPath, FreeFlight, METHODS, NullSink, Outputs, Report, Resolution, State,
    Stepping, TimePlan, Work, method,
};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    ContactSpec, FlankContact, Load, ModelSpec, Mount, PointContact, Profile, SceneSpec,
};
use gearbench_tests::*;

pub fn toy(damping: f64) -> ModelSpec {
    model_of(
        "elastic-toy",
        [
            ("rows", 9.0),
            ("columns", 2.0),
            ("modes", 6.0),
            ("residual_m_per_n", 2e-9),
            ("damping_ratio", damping),
        ],
    )
}

pub fn with_points() -> ContactSpec {
    ContactSpec {
        flanks: FlankContact::Points(PointContact::new(1e15)),
        ..contact(1.5e10)
    }
}

/// Returns pairs with a closed form, by name.
fn pairs() -> Vec<(&'static str, [ModelSpec; 2], ContactSpec)> {
    let teeth = movable(1e8, 4.8e-3, 0.0);
    let damped = movable(5.3e8, 4.8e-3, 60.0);
    vec![
        ("rigid", [rigid(), rigid()], contact(1.5e10)),
        ("movable", [teeth.clone(), teeth.clone()], contact(5e10)),
        (
            "all teeth",
            [all_teeth(teeth), all_teeth(damped.clone())],
            contact(5e10),
        ),
        ("damped", [damped, rigid()], contact(5e10)),
        ("elastic", [toy(0.0), toy(0.01)], with_points()),
        ("elastic and rigid", [toy(0.02), rigid()], with_points()),
    ]
}

/// Returns case A in flight within its backlash, with loads, one hub in three driven, and gears that vibrate by `size`
/// [m].
fn flying(models: &[ModelSpec; 2], contact: &ContactSpec, size: f64, seed: u64) -> (Scene, State) {
    let mut numbers = Numbers::new(seed);
    let mut spec = hammer(100e-6);
    spec.meshes[0].start.gap *= 1.0 + 0.4 * numbers.draw();
    for g in &mut spec.gears {
        g.speed = 10.0 * numbers.draw();
        g.loads = vec![Load::Applied(Profile::Constant(5.0 * numbers.draw()))];
    }
    if seed.is_multiple_of(3) {
        spec.gears[1].mount = Mount::Driven(Profile::Ramp {
            from: 3.0 * numbers.draw(),
            to: 50.0 * numbers.draw(),
            start: -1.0,
            end: 10.0,
        });
    }
    let mut scene = build(&spec, models, contact);
    let mut s = scene.initial();
    let (scale, _) = scales(&scene);
    let magnitude = scene.magnitudes().deflection;
    for g in scene.gears() {
        let own = g.model.hub().coordinates();
        if g.id == "rigid" {
            continue;
        }
        for i in g.range().skip(own) {
            let x = size / magnitude * scale[i] * numbers.draw();
            s.q[i] += x;
            s.v[i] += 1e5 * x * numbers.draw();
        }
    }
    scene.begin(&mut s, false);
    (scene, s)
}

/// No contact closes before the predicted time, whatever vibrates, and the motion is that of a fine integration.
#[test]
fn a_free_flight_is_the_motion_and_nothing_touches_on_it() {
    for (name, models, contact) in pairs() {
        let (mut flights, mut worst) = (0, 0.0_f64);
        for seed in 0..40 {
            let (mut scene, s) = flying(&models, &contact, 1e-6, seed);
            let mut path = FlightPath::default();
            let until = scene.flight_path(&s, 0.0, &mut path).min(0.02);
            if until == 0.0 {
                continue;
            }
            flights += 1;
            let force = gearbench_tests::named(&scene, "force:0");
            let (mut here, mut out) = (s.clone(), Outputs::default());
            for k in 0..=200 {
                here.t = until * f64::from(k) / 200.0;
                path.at(here.t, &mut here.q, &mut here.v);
                scene.output(here.at(), &mut out);
                assert_eq!(
                    out.channels[force], 0.0,
                    "{name}, seed {seed}: touches {k}/200 into a flight of {until:.2e} s"
                );
            }
            let t_end = until.min(2e-4);
            let plan = TimePlan {
                events: false,
                ..TimePlan::new(t_end, Resolution::Tolerance(1e-11))
            };
            let (mut fine, mut work) = (s.clone(), Work::default());
            let mut m = method("dopri5").unwrap();
            m.run(&mut scene, &mut fine, &plan, &mut NullSink, &mut work)
                .unwrap();
            path.at(t_end, &mut here.q, &mut here.v);
            let (q, v) = scales(&scene);
            for i in 0..q.len() {
                let apart = [
                    (here.q[i] - fine.q[i]) / q[i],
                    (here.v[i] - fine.v[i]) / v[i],
                ];
                for x in apart {
                    worst = worst.max(x.abs());
                }
            }
        }
        println!("{name}: {flights} flights, {worst:.1e} of the scales from a fine integration");
        assert!(flights > 25, "{name}: {flights} flights");
        assert!(worst < 1e-6, "{name}: {worst:.1e}");
    }
}

/// Motions without a closed form are integrated in steps.
#[test]
fn motions_without_a_closed_form_are_stepped_through() {
    let flies = |change: &dyn Fn(&mut SceneSpec), models: [ModelSpec; 2]| {
        let mut spec = hammer(100e-6);
        change(&mut spec);
        let mut scene = build(&spec, &models, &contact(5e10));
        let mut s = scene.initial();
        scene.begin(&mut s, true);
        scene.flight_path(&s, 0.0, &mut FlightPath::default()) > 0.0
    };
    let load = |load: Load| move |spec: &mut SceneSpec| spec.gears[0].loads = vec![load.clone()];
    assert!(flies(&|_| {}, [rigid(), movable(1e8, 4.8e-3, 60.0)]));
    assert!(!flies(&load(Load::Viscous(0.1)), [rigid(), rigid()]));
    let ramp = Profile::Ramp {
        from: 0.0,
        to: 1.0,
        start: -1.0,
        end: 1.0,
    };
    assert!(!flies(&load(Load::Applied(ramp)), [rigid(), rigid()]));
    // Overdamped teeth, unequal teeth, and flanks that touch.
    assert!(!flies(&|_| {}, [rigid(), movable(1e8, 4.8e-3, 2e3)]));
    let unequal: Vec<f64> = (0..20).map(|i| 1e8 + 1e6 * f64::from(i)).collect();
    let unequal = with(
        movable(1e8, 4.8e-3, 0.0),
        "tooth_stiffness_n_per_m",
        unequal,
    );
    assert!(!flies(&|_| {}, [unequal, rigid()]));
    let touching = |spec: &mut SceneSpec| spec.meshes[0].start.gap = -1e-6;
    assert!(!flies(&touching, [rigid(), rigid()]));
}

fn finish(spec: &SceneSpec, models: &[ModelSpec; 2], id: &str, resolution: Resolution) -> Outcome {
    let mut scene = build(spec, models, &contact(1.5e10));
    run(&mut scene, id, resolution, 0.004).unwrap(id)
}

/// The straight flight of rigid gears without loads is exact for every method: the closed form changes only the work.
#[test]
fn free_flights_change_nothing_where_a_method_is_exact() {
    let spec = hammer(50e-6);
    for row in METHODS.iter().filter(|m| !m.info.linear_part) {
        let id = row.info.id;
        let resolution = resolution(row.info, 1e-6, 1e-9);
        let models = [rigid(), rigid()];
        let off = finish(&spec, &models, id, resolution);
        let on = finish(&spec, &models, &format!("{id}(free_flight=1)"), resolution);
        let apart = (0..2)
            .map(|i| (on.state.v[i] / off.state.v[i] - 1.0).abs())
            .fold(0.0, f64::max);
        println!(
            "{id}: {} and {} steps, {} and {} evaluations, speeds differ by {apart:.1e}",
            off.work.steps, on.work.steps, off.work.force_evaluations, on.work.force_evaluations
        );
        // Under a tolerance steps fall otherwise.
        let allowed = match resolution {
            Resolution::Step(_) => 1e-9,
            Resolution::Tolerance(rtol) => 3e2 * rtol,
        };
        assert!(apart < allowed, "{id}: {apart:.1e}");
        if row.info.stepping != Stepping::Adaptive {
            assert!(2 * on.work.steps < off.work.steps, "{id}");
        }
    }
}

/// Vibrating teeth under loads: the motion converged to is the same, energy is accounted for. The error at a step is
/// that of the contacts alone, of the declared order, but not smaller here: errors of flight and contact cancel in
/// part.
#[test]
fn runs_with_free_flights_converge_to_the_same_motion() {
    let mut spec = hammer(50e-6);
    spec.gears[0].loads = vec![Load::Applied(Profile::Constant(2.0))];
    let teeth = movable(2e8, 4.8e-3, 0.0);
    let models = [teeth.clone(), teeth];
    let exact = |id| finish(&spec, &models, id, Resolution::Tolerance(1e-12));
    let (stepped, flown) = (exact("dopri5"), exact("dopri5(free_flight=1)"));
    let apart = (flown.state.v[0] / stepped.state.v[0] - 1.0).abs();
    let residual = flown.ledger.residual_relative();
    println!("dopri5: flown and stepped differ by {apart:.1e}, residual {residual:.1e}");
    assert!(apart < 1e-7 && residual.abs() < 1e-9);
    assert!(flown.ledger.external.abs() > 1e-3);
    for (id, step) in [
        ("velocity-verlet", 4e-7),
        ("rk4", 4e-7),
        ("hht-alpha", 4e-7),
    ] {
        let at = |path: &str, step: f64| {
            let id = format!("{id}{path}");
            let o = finish(&spec, &models, &id, Resolution::Step(step));
            let error = (o.state.v[0] / flown.state.v[0] - 1.0).abs();
            let residual = o.ledger.residual_relative().abs();
            println!(
                "{id}, {step:.0e} s: {} steps, error {error:.1e}, residual {residual:.1e}, work {:.4e} J",
                o.work.steps, o.ledger.external
            );
            (error, residual, o.work.steps)
        };
        let off = at("", step);
        let [on, finer] = [1.0, 0.25].map(|part| at("(free_flight=1)", part * step));
        assert!(finer.0 < 0.2 * on.0 + 1e-8, "{id}: {on:?} {finer:?}");
        assert!(on.1 < 3.0 * off.1 + 1e-9, "{id}: {on:?} {off:?}");
        assert!(2 * on.2 < off.2, "{id}");
    }
}

/// With ten times the backlash, and so ten times the flight between impacts, the work per impact is unchanged with
/// every method.
#[test]
fn the_cost_of_hammering_follows_contact_time_with_every_method() {
    for row in METHODS.iter().filter(|m| !m.info.linear_part) {
        for events in [true, false] {
            let cost = |stretch: f64| {
                let spec = hammer(50e-6 * stretch);
                let mut scene = build(&spec, &[rigid(), rigid()], &contact(1.5e10));
                let plan = TimePlan {
                    events,
                    ..TimePlan::new(0.02 * stretch, resolution(row.info, 1e-6, 1e-5))
                };
                let (mut s, mut work) = (scene.initial(), Work::default());
                let mut impacts = Impacts::of(&scene);
                let mut m = method(&format!("{}(free_flight=1)", row.info.id)).unwrap();
                let mut sinks = Tee(vec![&mut impacts]);
                m.run(&mut scene, &mut s, &plan, &mut sinks, &mut work)
                    .unwrap();
                assert!(impacts.number > 20, "{}", row.info.id);
                [work.steps + work.rejected, work.force_evaluations]
                    .map(|x| x as f64 / f64::from(impacts.number))
            };
            let (short, long) = (cost(1.0), cost(10.0));
            // Steps under a tolerance that find contact by rejections only are not alike from impact to impact.
            let more = if events || row.info.stepping != Stepping::Adaptive {
                1.1
            } else {
                1.4
            };
            println!(
                "{}, events {events}: {short:.1?} and {long:.1?} steps and evaluations per impact",
                row.info.id
            );
            for (short, long) in short.into_iter().zip(long) {
                assert!(
                    long <= more * short,
                    "{}, events {events}: {long:.1} per impact, {short:.1} with a tenth of the flight",
                    row.info.id
                );
            }
        }
    }
}

/// Over many pitches of flight teeth leave and enter windows: those in closed form are where integrated ones are, up to
/// the rounding of angles; and so they are through an impact, up to the method's error on so stiff a tooth.
#[test]
fn teeth_in_closed_form_equal_integrated_ones_up_to_rounding() {
    let teeth = movable(5.3e8, 4.8e-3, 20.0);
    let mut spec = hammer(100e-6);
    // In step, so that the flight lasts; a small difference lets them touch after several pitches.
    spec.gears[1].speed = -20.0 / 1.5 + 2e-4;
    let displacement = |model: ModelSpec, from: Option<&[f64; 2]>, t_end: f64, step: f64| {
        let mut scene = build(&spec, &[model.clone(), model], &contact(5e10));
        let mut s = scene.initial();
        if let Some(push) = from {
            // Both hubs get the push, their teeth lag behind and vibrate.
            for (g, push) in scene.gears().iter().zip(push) {
                s.v[g.range().start] += push;
            }
        }
        let plan = TimePlan::new(t_end, Resolution::Step(step));
        let out = run_from(&mut scene, s, "rk4(free_flight=1)", &plan).unwrap("rk4");
        let s = out.state;
        let speeds = [
            "speed:pinion",
            "speed:wheel",
            "hub_angle:pinion",
            "hub_angle:wheel",
        ]
        .map(|name| channel(&mut scene, &s, name));
        (speeds, out.work.steps)
    };
    let apart = |a: [f64; 4], b: [f64; 4]| {
        (0..4)
            .map(|i| ((a[i] - b[i]) / a[i]).abs())
            .fold(0.0, f64::max)
    };
    let push = [1e-2, -1e-2];
    let (few, steps) = displacement(teeth.clone(), Some(&push), 0.05, 1e-6);
    let (every, _) = displacement(all_teeth(teeth.clone()), Some(&push), 0.05, 1e-6);
    let d = apart(few, every);
    println!(
        "flight over {:.1} pitches in {steps} steps: {d:.1e}",
        few[2] / 0.314
    );
    assert!(few[2] > 3.0 * 0.314 && steps < 1000, "{few:?} {steps}");
    assert!(d < 1e-12, "{d:.1e}");
    // Hammering: impacts excite the teeth that leave their windows in the flights between.
    spec.gears[1].speed = -12.0;
    let displacement = |model: ModelSpec| {
        let mut scene = build(&spec, &[model.clone(), model], &contact(5e10));
        let plan = TimePlan::new(0.02, Resolution::Step(1e-7));
        let s = scene.initial();
        let out = run_from(&mut scene, s, "rk4(free_flight=1)", &plan).unwrap("rk4");
        let s = out.state;
        [
            "speed:pinion",
            "speed:wheel",
            "hub_angle:pinion",
            "hub_angle:wheel",
        ]
        .map(|name| channel(&mut scene, &s, name))
    };
    let d = apart(displacement(teeth.clone()), displacement(all_teeth(teeth)));
    println!("hammering: {d:.1e}");
    assert!(d < 1e-8, "{d:.1e}");
}
