//! Shafts in torsion: methods, energies, channels.

use super::*;
use gearbench_integrators::{Events, Resolution};
use gearbench_models::spec::{Load, Mount, Profile, ShaftDamping, effective_radius};

/// Returns motor, pinion, wheel and load on shafts.
pub fn driveline(damping: ShaftDamping) -> SceneSpec {
    let mut spec = case_of_body(-1e-6);
    spec.gears[0].speed = 0.0;
    let section = |k: f64| vec![coupling(0.2, k)];
    let mut motor = BodySpec::new("motor", 2e-3);
    motor.loads = vec![Load::Applied(Profile::Constant(30.0))];
    let mut load = BodySpec::new("load", 9e-3);
    load.loads = vec![Load::Viscous(0.3)];
    let station = |place: f64, body: BodySpec| Station {
        place,
        carries: StationMember::Body(Box::new(body)),
    };
    spec.shafts = vec![
        ShaftSpec {
            damping,
            ..shaft("input", vec![station(0.0, motor), on(0.2, 0)], section(2e4))
        },
        ShaftSpec {
            damping,
            ..shaft("output", vec![on(0.0, 1), station(0.2, load)], section(4e4))
        },
    ];
    spec
}

/// All models and methods agree, and their energy balances close.
#[test]
fn all_methods_run_a_driveline() {
    let time = 4e-4;
    for subject in subjects() {
        if subject.model.id == "fe" {
            continue;
        }
        let spec = driveline(ShaftDamping::Ratio(0.02));
        let mut scene = of_subject(&spec, &subject);
        let [motor, load] = [2, 3].map(|i| scene.gears()[i].range().start);
        let mut reference: Option<[f64; 2]> = None;
        for method in methods_of(&mut scene) {
            let id = method.info.id;
            let resolution = resolution(method.info, 2e-7, 1e-7);
            let mut scene = of_subject(&spec, &subject);
            let o = run(&mut scene, id, resolution, time).unwrap(id);
            let now = [o.state.v[motor], o.state.v[load]];
            let first = *reference.get_or_insert(now);
            let books = o.ledger.residual_relative();
            println!("{} {id}: {now:?} rad/s, books {books:.1e}", subject.name);
            for (a, b) in now.iter().zip(first) {
                assert!(
                    (a - b).abs() < 4e-3 * first[0].abs(),
                    "{id}: {now:?} {first:?}"
                );
            }
            assert!(books.abs() < 1e-2, "{} {id}: {books}", subject.name);
        }
    }
}

/// The Newton correction with contacts and shafts is the inverse of the matrix of the tangents.
#[test]
fn corrections_invert_tangents() {
    for subject in subjects() {
        let mut scene = of_subject(&driveline(ShaftDamping::Time(1e-6)), &subject);
        let mut s = scene.initial();
        scene.begin(&mut s, false);
        for c in [(1.0, 0.0, 0.0), (1.0, 1e-6, 1e-12), (1.0, 1e-4, 1e-8)] {
            let c = Coeffs {
                m: c.0,
                d: c.1,
                k: c.2,
            };
            corrects(&mut scene, &s, c, false, &subject.name);
        }
    }
}

/// Free of damping, loads and meshes energy stays as the order of a method says, momentum to rounding; forces come of the
/// energy.
#[test]
fn a_chain_keeps_energy_and_momentum() {
    let stations = (0..4).map(|i| body(0.1 * f64::from(i), &format!("disc {i}"), 1e-3));
    let sections = vec![coupling(0.1, 2e4), bar(0.2, 0.02, Material::STEEL, 4)];
    let spec = alone(vec![shaft("chain", stations.collect(), sections)]);
    let mut scene = build(&spec, &[], &contact(1e9));
    let mut s = scene.initial();
    s.v = Numbers::new(3).vector(&vec![1.0; s.v.len()]);
    let [mass, _] = matrices(&mut scene, &s);
    let momentum =
        |s: &State| -> f64 { s.v.iter().enumerate().map(|(i, v)| mass[(i, i)] * v).sum() };
    let (before, p) = (energy(&mut scene, &s), momentum(&s));
    for id in [
        "rk4",
        "velocity-verlet",
        "trigonometric",
        "generalised-alpha",
        "dopri5",
    ] {
        let mut ends = Vec::new();
        for h in [2e-6, 1e-6] {
            let plan = gearbench_integrators::TimePlan::new(1e-3, Resolution::Step(h));
            let end = run_from(&mut scene, s.clone(), id, &plan).unwrap(id).state;
            let moved = (momentum(&end) / p - 1.0).abs();
            assert!(moved < 1e-11, "{id}: momentum changes by {moved}");
            ends.push((energy(&mut scene, &end) / before - 1.0).abs());
        }
        println!("{id}: energy changes by {ends:?}, momentum below 1e-11");
        assert!(
            ends[0] < 2e-2 && ends[1] < ends[0].max(1e-12),
            "{id}: {ends:?}"
        );
    }
}

/// Methods have their order on a shaft: errors at the end over the step.
#[test]
fn methods_keep_their_order_on_shafts() {
    let stations = (0..3).map(|i| body(0.1 * f64::from(i), &format!("disc {i}"), 1e-3));
    let sections = vec![coupling(0.1, 2e4), coupling(0.1, 1e4)];
    let damped = ShaftSpec {
        damping: ShaftDamping::Ratio(0.05),
        ..shaft("chain", stations.collect(), sections)
    };
    let mut scene = build(&alone(vec![damped]), &[], &contact(1e9));
    let mut s = scene.initial();
    s.v = vec![1.0, -0.5, 0.2];
    let end = |scene: &mut Scene, id: &str, r: Resolution| {
        let plan = gearbench_integrators::TimePlan::new(2e-3, r);
        run_from(scene, s.clone(), id, &plan).unwrap(id).state.v
    };
    let exact = end(&mut scene, "dopri5", Resolution::Tolerance(1e-13));
    for method in gearbench_integrators::METHODS {
        let info = method.info;
        if info.stepping == gearbench_integrators::Stepping::Adaptive {
            continue;
        }
        let errors = [2e-5, 1e-5, 5e-6].map(|h| {
            let found = end(&mut scene, info.id, Resolution::Step(h));
            let error = found.iter().zip(&exact).map(|(a, b)| (a - b).abs());
            error.fold(0.0, f64::max)
        });
        let order = (errors[1] / errors[2]).log2();
        println!(
            "{}: errors {errors:?}, order {order:.2}, declared {}",
            info.id, info.order
        );
        let rounding = errors[2] < 1e-11;
        assert!(
            rounding || order > f64::from(info.order) - 0.25,
            "{}: order {order}",
            info.id
        );
    }
}

/// The torque that a shaft reports accelerates what is behind it; a driven end puts in its power.
#[test]
fn torques_and_powers_of_a_driven_shaft() {
    let mut drive = BodySpec::new("drive", 1e-3);
    drive.mount = Mount::Driven(Profile::Ramp {
        from: 0.0,
        to: 50.0,
        start: 0.0,
        end: 1e-3,
    });
    let drive = Station {
        place: 0.0,
        carries: StationMember::Body(Box::new(drive)),
    };
    let sections = vec![coupling(0.1, 1e4), coupling(0.1, 2e4)];
    let stations = vec![drive, body(0.1, "disc", 1e-3), body(0.2, "end", 2e-3)];
    let spec = ShaftSpec {
        damping: ShaftDamping::Time(2e-6),
        ..shaft("driven", stations, sections)
    };
    let mut scene = build(&alone(vec![spec]), &[], &contact(1e9));
    let o = run(&mut scene, "dopri5", Resolution::Tolerance(1e-11), 1.3e-3).unwrap("driven");
    println!(
        "books of a driven shaft {:.1e}",
        o.ledger.residual_relative()
    );
    assert!(o.ledger.residual_relative().abs() < 1e-8);
    let s = o.state;
    let torques = [0, 1].map(|t| channel(&mut scene, &s, &format!("shaft_torque:{t}")));
    let mut a = vec![0.0; s.q.len()];
    scene.force(s.at(), &mut a);
    assert!((a[0] - (torques[0] - torques[1])).abs() < 1e-9 * torques[0].abs().max(1.0));
    assert!((a[1] - torques[1]).abs() < 1e-9 * torques[1].abs().max(1.0));
    // What drives the shaft turns it against its first spring; its own inertia does not speed up any more.
    let held = channel(&mut scene, &s, "mount_torque:drive");
    assert!(
        (held - torques[0]).abs() < 1e-9 * held.abs(),
        "{held} {torques:?}"
    );
    assert!(torques[0].abs() > 1.0);
}

/// A driveline in static equilibrium carries its load: torques by the ratio, twists by the springs.
#[test]
fn a_held_driveline_carries_its_torque() {
    use gearbench_integrators::{EquilibriumOptions, equilibrium};
    for model in models() {
        let both = [usual(&model), usual(&model)];
        let mut spec = driveline(ShaftDamping::None);
        if let StationMember::Body(load) = &mut spec.shafts[1].stations[1].carries {
            load.mount = Mount::Fixed;
            load.loads.clear();
        }
        let mut scene = build(&spec, &both, &contact(5e10));
        let mut s = scene.initial();
        equilibrium(&mut scene, &mut s, &EquilibriumOptions::default()).unwrap();
        let torques = [0, 1].map(|t| channel(&mut scene, &s, &format!("shaft_torque:{t}")));
        let [ra, rb] = [0, 1].map(|i| effective_radius(&spec.gears[i].body));
        println!("{}: torques {torques:?} N m", model.id);
        assert!((torques[0] - 30.0).abs() < 1e-6, "{torques:?}");
        assert!((torques[1] + 30.0 * rb / ra).abs() < 1e-5, "{torques:?}");
        let held = channel(&mut scene, &s, "mount_torque:load");
        assert!((held + torques[1]).abs() < 1e-6, "{held} {torques:?}");
    }
}
