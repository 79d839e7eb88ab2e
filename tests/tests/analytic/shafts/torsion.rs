//! Shafts that are twisted: frequencies, methods, energies, channels.

use super::*;
use gearbench_integrators::{Events, Outputs, Report, Resolution};
use gearbench_models::geometry::Side;
use gearbench_models::spec::{GearSpec, Load, Mount, Profile, ShaftDamping, effective_radius};

/// Two and five inertias on springs: openTorsion's tests `test_shaft` and `test_friswell_ex971`, to printed digits, and the
/// closed form of two.
#[test]
fn chains_have_the_frequencies_of_opentorsion() {
    let (a, b, k) = (211.4, 8.3, 9.775e6_f64);
    let two = shaft(
        "two",
        vec![body(0.0, "a", a), body(1.0, "b", b)],
        vec![coupling(1.0, k)],
    );
    let f = frequencies(&mut build(&alone(vec![two]), &[], &contact(1e9)));
    let exact = (k * (1.0 / a + 1.0 / b)).sqrt() / TAU;
    println!("two inertias {f:?} Hz, exact {exact}");
    assert!((f[1] / exact - 1.0).abs() < 1e-12 && f[0] < 1e-6 * exact);
    assert!((f[1] - 176.1).abs() < 0.05);

    let inertias = [3.5e-3, 3.5e-3, 3.5e-3, 0.15, 0.05];
    let springs = [12e3, 12e3, 14e3, 10e3];
    let stations = (inertias.iter().enumerate())
        .map(|(i, inertia)| body(0.1 * i as f64, &format!("disc {i}"), *inertia));
    let sections = springs.map(|k| coupling(0.1, k));
    let five = shaft("five", stations.collect(), sections.to_vec());
    let f = frequencies(&mut build(&alone(vec![five]), &[], &contact(1e9)));
    println!("five inertias {f:?} Hz");
    for (f, printed) in f[1..].iter().zip([81.21, 141.21, 378.95, 536.36]) {
        assert!((f - printed).abs() < 0.005, "{f} for {printed}");
    }
}

/// Gears of module 4 mm at places on the x axis; only ratios of radii, inertias and springs matter.
fn toothed(name: &str, teeth: u32, x: f64, inertia: f64) -> GearSpec {
    let mut g = gear(name, spur(teeth), x, 0.0);
    g.inertia = Some(inertia);
    g
}

/// Frequencies of a train whose meshes have a stiffness [N/m], at preloaded contacts.
fn train(spec: &SceneSpec, mesh: f64) -> Vec<f64> {
    let models = vec![rigid(); spec.gears.len()];
    let width = 0.01;
    let mut scene = build(spec, &models, &contact(mesh / width));
    let s = scene.initial();
    squares(&mut scene, &s)
}

/// Rigid constraint gears are the limit of stiff meshes: squares of frequencies over 1/k, extrapolated.
fn with_rigid_meshes(spec: &SceneSpec, mesh: f64) -> Vec<f64> {
    let [once, twice] = [mesh, 2.0 * mesh].map(|k| train(spec, k));
    let limit = once.iter().zip(&twice).map(|(a, b)| 2.0 * b - a);
    limit.map(|x| x.max(0.0).sqrt() / TAU).collect()
}

/// openTorsion's `friswell_pagex`: a motor, two equal gears, a rotor on each.
#[test]
fn an_idler_pair_has_the_frequencies_of_opentorsion() {
    let gears = vec![
        toothed("one", 30, 0.0, 25e-6),
        toothed("two", 30, 0.1201, 25e-6),
    ];
    let motor = shaft(
        "motor shaft",
        vec![
            body(0.0, "motor", 4e-4),
            on(0.1, 0),
            body(0.2, "first rotor", 7e-4),
        ],
        vec![coupling(0.1, 1e4), coupling(0.1, 5e3)],
    );
    let other = shaft(
        "other shaft",
        vec![on(0.0, 1), body(0.1, "second rotor", 7e-4)],
        vec![coupling(0.1, 5e3)],
    );
    let spec = SceneSpec {
        gears,
        meshes: vec![mesh([0, 1], start(Side::Left, -1e-7))],
        shafts: vec![motor, other],
    };
    let f = with_rigid_meshes(&spec, 1e11);
    println!("idler pair {f:?} Hz");
    let printed = [0.0, 425.359477, 634.072760, 3247.192354];
    // Printed digits are cut, not rounded.
    for (f, p) in f.iter().zip(printed).skip(1) {
        assert!((f - p).abs() < 1e-6, "{f} for {p}");
    }
    assert!(f[0] < 1e-2);
}

/// Friswell's example 9.6.3 (a ship's turbine): a turbine, a pinion with two mates, one of them with a further wheel.
#[test]
fn a_turbine_train_has_the_frequencies_of_friswell() {
    // Shafts of 2.5 m x 0.2 m and 3.5 m x 0.25 m, G = 68 GPa, without mass.
    let material = Material {
        young: 2.0 * 68e9 * 1.3,
        poisson: 0.3,
        density: 0.0,
    };
    let gears = vec![
        toothed("pinion", 50, 0.0, 200.0),
        toothed("mate", 50, 0.2001, 200.0),
        toothed("wheel", 80, -0.2601, 800.0),
        toothed("far wheel", 80, 0.4602, 800.0),
    ];
    let long = || vec![bar(3.5, 0.25, material, 1)];
    let shafts = vec![
        shaft(
            "turbine shaft",
            vec![body(0.0, "turbine", 3200.0), on(2.5, 0)],
            vec![bar(2.5, 0.2, material, 1)],
        ),
        shaft(
            "first",
            vec![on(0.0, 2), body(3.5, "propeller", 450.0)],
            long(),
        ),
        shaft(
            "second",
            vec![on(0.0, 3), body(3.5, "other propeller", 450.0)],
            long(),
        ),
    ];
    let meshes = [[0, 1], [0, 2], [1, 3]].map(|g| mesh(g, start(Side::Left, -1e-7)));
    let spec = SceneSpec {
        gears,
        meshes: meshes.to_vec(),
        shafts,
    };
    let f = with_rigid_meshes(&spec, 1e14);
    println!("turbine train {f:?} Hz");
    let printed = [0.0, 10.30419334, 20.47926065, 24.42291926];
    for (f, p) in f.iter().zip(printed).skip(1) {
        assert!((f - p).abs() < 1e-8, "{f} for {p}");
    }
    assert!(f[0] < 1e-2);
}

/// A bar that twists: frequencies `n c / (2 L)`, of second order in the length of the elements.
#[test]
fn a_free_bar_twists_at_its_frequencies() {
    let (length, material) = (0.8, Material::STEEL);
    let speed = (material.young / (2.0 * 1.3) / material.density).sqrt();
    let mut errors: Vec<[f64; 2]> = Vec::new();
    let counts = [4, 8, 16, 32];
    for n in counts {
        let bar = shaft("bar", vec![], vec![bar(length, 0.04, material, n)]);
        let f = frequencies(&mut build(&alone(vec![bar]), &[], &contact(1e9)));
        let of = |k: usize| (f[k] / (k as f64 * speed / (2.0 * length)) - 1.0).abs();
        errors.push([of(1), of(2)]);
    }
    println!("relative errors of two torsional frequencies by elements {counts:?}: {errors:?}");
    for k in 0..2 {
        let order = (errors[2][k] / errors[3][k]).log2();
        assert!((order - 2.0).abs() < 0.05, "order {order}");
    }
    assert!(errors[3][0] < 5e-4);
}

/// Motor, pinion, wheel, load.
pub fn driveline(damping: ShaftDamping) -> SceneSpec {
    let mut spec = case_a(-1e-6);
    spec.gears[0].speed = 0.0;
    let section = |k: f64| vec![coupling(0.2, k)];
    let mut motor = BodySpec::new("motor", 2e-3);
    motor.loads = vec![Load::Applied(Profile::Constant(30.0))];
    let mut load = BodySpec::new("load", 9e-3);
    load.loads = vec![Load::Viscous(0.3)];
    let station = |place: f64, body: BodySpec| Station {
        place,
        carries: Carried::Body(Box::new(body)),
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

/// All models, all methods: one answer, and books that close.
#[test]
fn all_methods_run_a_driveline() {
    let time = 4e-4;
    for subject in subjects() {
        if subject.model.id == "fe" {
            continue;
        }
        let both = [subject.spec.clone(), subject.spec.clone()];
        let spec = driveline(ShaftDamping::Ratio(0.02));
        let mut scene = build(&spec, &both, &subject.contact);
        let [motor, load] = [2, 3].map(|i| scene.gears()[i].range().start);
        let mut reference: Option<[f64; 2]> = None;
        for method in methods_of(&mut scene) {
            let id = method.info.id;
            let resolution = resolution(method.info, 2e-7, 1e-7);
            let mut scene = build(&spec, &both, &subject.contact);
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

/// The Newton correction with contacts and shafts is the inverse of what tangents say.
#[test]
fn corrections_invert_tangents() {
    for subject in subjects() {
        let both = [subject.spec.clone(), subject.spec.clone()];
        let mut scene = build(
            &driveline(ShaftDamping::Time(1e-6)),
            &both,
            &subject.contact,
        );
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
    let total = |scene: &mut Scene, s: &State| {
        let mut out = Outputs::default();
        scene.output(s.at(), &mut out);
        out.energy.total()
    };
    let (before, p) = (total(&mut scene, &s), momentum(&s));
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
            ends.push((total(&mut scene, &end) / before - 1.0).abs());
        }
        println!("{id}: energy changes by {ends:?}, momentum below 1e-11");
        assert!(
            ends[0] < 2e-2 && ends[1] < ends[0].max(1e-12),
            "{id}: {ends:?}"
        );
    }
}

/// Order of the methods on a shaft: errors at the end over the step.
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
        carries: Carried::Body(Box::new(drive)),
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

/// A driveline at rest under load: torques by the ratio, twists by the springs.
#[test]
fn a_held_driveline_carries_its_torque() {
    use gearbench_integrators::{EquilibriumOptions, equilibrium};
    for model in models() {
        let both = [usual(&model), usual(&model)];
        let mut spec = driveline(ShaftDamping::None);
        if let Carried::Body(load) = &mut spec.shafts[1].stations[1].carries {
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

/// The shipped scene beside Holzer's frequencies of the same train with a rigid mesh.
#[test]
fn shipped_driveline() {
    let file = gearbench::scene_file::load("driveline").unwrap();
    let mut spec = file.spec.clone();
    spec.meshes[0].start.gap = -1e-7;
    let mut scene = Scene::build(&spec, &file.models[0].modelling, &models()).unwrap();
    let f = frequencies(&mut scene);
    println!("driveline {f:?} Hz");
    for (f, rigid) in f[1..4].iter().zip([178.2, 615.0, 5074.4]) {
        assert!(*f < rigid && *f > 0.9 * rigid, "{f} for {rigid}");
    }
}
