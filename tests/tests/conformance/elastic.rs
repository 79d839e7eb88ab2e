//! Gears reduced from a small mesh, under every method: energy, momentum, order, and statics against the full mesh.

use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::{
    AcceptedStep, Control, EquilibriumOptions, METHODS, Method, Outputs, Resolution,
    SecondOrderSystem, Sink, State, Stepping, TimePlan, Work, equilibrium,
};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    ContactSpec, Load, ModelSpec, Modelling, Mount, Parameters, PointContact, Profile, SceneSpec,
    SurfaceKind, Value, effective_radius,
};
use gearbench_reference::MODELS;
use gearbench_reference::statics::LoadedPair;
use gearbench_tests::*;

/// After the impact, before the opposite flanks meet.
const T_END: f64 = 1.5e-4;

/// Turn of the pinion [rad] by which the flanks overlap.
const CLOSED: f64 = 3e-4;

/// A model on a small generated mesh; modes of the elastic one.
fn meshed(id: &str, modes: Option<usize>) -> ModelSpec {
    let mesh = [
        ("flank_elements", 6),
        ("fillet_elements", 2),
        ("across_elements", 4),
        ("rim_elements", 2),
        ("width_elements", 1),
    ];
    let values = mesh.into_iter().chain(modes.map(|n| ("modes", n)));
    let parameters: Parameters = values
        .map(|(key, n)| (key.to_string(), Value::Number(n as f64)))
        .collect();
    ModelSpec {
        id: id.into(),
        parameters,
    }
}

fn modelling(model: &ModelSpec, surface: SurfaceKind) -> Modelling {
    let points = PointContact {
        surface,
        ..PointContact::new(1e15)
    };
    Modelling {
        gears: vec![model.clone(), model.clone()],
        contacts: vec![ContactSpec {
            points: Some(points),
            ..contact(1.5e10)
        }],
    }
}

/// Case A with the inertia of the meshes.
fn spec(gap: f64) -> SceneSpec {
    let mut spec = case_a(gap);
    for g in &mut spec.gears {
        g.inertia = None;
    }
    spec
}

fn scene_of(spec: &SceneSpec, modes: usize) -> Scene {
    let model = meshed("elastic", Some(modes));
    Scene::build(spec, &modelling(&model, SurfaceKind::Smooth), MODELS)
        .unwrap_or_else(|e| panic!("{e}"))
}

/// Impulse of the contact torque on each gear, by the trapezoidal rule.
struct Impulse {
    channels: [usize; 2],
    last: Option<[f64; 2]>,
    sum: [f64; 2],
    out: Outputs,
}

impl Impulse {
    fn new(scene: &Scene) -> Self {
        Impulse {
            channels: ["pinion", "wheel"]
                .map(|g| gearbench_tests::named(scene, &format!("contact_torque:{g}"))),
            last: None,
            sum: [0.0; 2],
            out: Outputs::default(),
        }
    }

    fn read(&mut self, sys: &mut dyn SecondOrderSystem, s: &State) -> [f64; 2] {
        sys.output(s.at(), &mut self.out);
        self.channels.map(|c| self.out.channels[c])
    }
}

impl Sink for Impulse {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let from = match self.last.take() {
            Some(x) => x,
            None => self.read(sys, step.from),
        };
        let to = self.read(sys, step.to);
        for k in 0..2 {
            self.sum[k] += 0.5 * (step.to.t - step.from.t) * (from[k] + to[k]);
        }
        self.last = Some(to);
        Control::Continue
    }
}

/// Relative change of energy over an impact, and the largest difference of a gear's momentum from the impulse on it.
fn impact(scene: &mut Scene, method: &Method, resolution: Resolution) -> (f64, f64) {
    let mut s = scene.initial();
    let momenta = |scene: &Scene, s: &State| {
        [0, 1].map(|k: usize| {
            let g = &scene.gears()[k];
            g.model.hub_state(g.at(s.at())).momentum
        })
    };
    let mut impulse = Impulse::new(scene);
    impulse.read(scene, &s);
    let energy = impulse.out.energy.total();
    let before = momenta(scene, &s);
    method
        .build()
        .run(
            scene,
            &mut s,
            &TimePlan::new(T_END, resolution),
            &mut impulse,
            &mut Work::default(),
        )
        .unwrap_or_else(|e| panic!("{}: {e}", method.info.id));
    let after = momenta(scene, &s);
    impulse.read(scene, &s);
    assert_eq!(impulse.out.energy.contact, 0.0, "{}", method.info.id);
    let off = [0, 1].map(|k: usize| (impulse.sum[k] / (after[k] - before[k]) - 1.0).abs());
    (
        impulse.out.energy.total() / energy - 1.0,
        off[0].max(off[1]),
    )
}

#[test]
fn impacts_keep_energy_and_momentum_under_every_method() {
    let mut scene = scene_of(&spec(3.1e-6), 20);
    let methods = methods_of(&mut scene);
    assert_eq!(methods.len(), METHODS.len(), "the modal one too");
    for method in methods {
        let info = method.info;
        let (resolution, limit) = match (info.stepping, info.order) {
            _ if info.linear_part => (Resolution::Step(2e-7), 2e-5),
            (Stepping::Adaptive, _) => (Resolution::Tolerance(1e-6), 1e-4),
            (_, 0 | 1) => (Resolution::Step(4e-9), 1e-4),
            (_, 2) => (Resolution::Step(5e-8), 2e-5),
            _ => (Resolution::Step(1e-7), 2e-5),
        };
        let (energy, momentum) = impact(&mut scene, method, resolution);
        println!(
            "{:20} {resolution:?}: energy {energy:+.1e}, momentum off by {momentum:.1e}",
            info.id
        );
        if !info.dissipative {
            assert!(energy.abs() < limit, "{}: energy {energy:.1e}", info.id);
        }
        let fixed = matches!(resolution, Resolution::Step(_));
        let limit = if fixed { 1e-6 } else { 1e-3 };
        assert!(momentum < limit, "{}: momentum {momentum:.1e}", info.id);
    }
}

/// Case A at rest with a torque [N m] on the pinion and the wheel held.
fn pressed(torque: f64) -> SceneSpec {
    let mut spec = spec(0.0);
    spec.gears[0].speed = 0.0;
    spec.gears[0].loads = vec![Load::Applied(Profile::Constant(torque))];
    spec.gears[1].mount = Mount::Fixed;
    spec
}

/// Gears that swing while they press on each other, so little that the same points touch all the time.
#[test]
fn swinging_in_contact_has_the_declared_order() {
    let mut scene = scene_of(&pressed(60.0), 8);
    let mut start = scene.initial();
    start.q[0] = CLOSED;
    equilibrium(&mut scene, &mut start, &EquilibriumOptions::default()).unwrap();
    start.t = 0.0;
    // Off the equilibrium, where some errors of first order would vanish.
    start.q[0] += 1e-7;
    start.v[0] = 5e-3;
    let t_end = 2e-5;
    let mut end = |id: &str, resolution: Resolution| {
        let o = run_from(
            &mut scene,
            start.clone(),
            id,
            &TimePlan::new(t_end, resolution),
        )
        .unwrap(id);
        o.state.q
    };
    let exact = end("rk4", Resolution::Step(t_end / 4000.0));
    let swing = exact.iter().zip(&start.q);
    let swing = swing.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    let methods: Vec<_> = METHODS
        .iter()
        .filter(|m| m.info.stepping != Stepping::Adaptive)
        .collect();
    for method in methods {
        let info = method.info;
        let first = match info.order {
            1 => 800.0,
            4 => 24.0,
            5 => 16.0,
            _ => 200.0,
        };
        let (mut h, mut errors) = (vec![], vec![]);
        for i in 0..4 {
            let n = f64::round(first * f64::powi(1.4, i));
            h.push(t_end / n);
            let q = end(info.id, Resolution::Step(t_end / n));
            let error = q.iter().zip(&exact);
            errors.push(error.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / swing);
        }
        let order = slope(&h, &errors);
        println!(
            "{:20} order {order:.2}, declared {}, errors {:.1e} .. {:.1e}",
            info.id, info.order, errors[0], errors[3]
        );
        // Order five has a short way from where it begins to rounding.
        let band = if info.order < 5 { 0.25 } else { 0.5 };
        assert!(
            order > f64::from(info.order) - band,
            "{}: order {order:.2}",
            info.id
        );
    }
}

/// Held hubs, gears pressed on each other: the deflection of full finite elements on the same mesh, but for
/// displacements along the flanks, which reduced contact leaves out. What these do is turn by the angle between facets,
/// and falls with it. Any number of modes deflects alike, and a hub that is free to turn under the torque turns as far
/// as one turned by hand.
#[test]
fn statics_are_those_of_full_finite_elements() {
    let mut of_facets = Vec::new();
    for (surface, flank, limits) in [
        (SurfaceKind::Faceted, 6, [2.5e-2, 2.5e-2]),
        (SurfaceKind::Faceted, 12, [2.5e-2, 2.5e-2]),
        (SurfaceKind::Faceted, 24, [2.5e-2, 2.5e-2]),
        (SurfaceKind::Smooth, 6, [5e-4, 8e-3]),
    ] {
        let model = |id: &str, modes: Option<usize>| {
            let model = with(
                meshed(id, modes),
                "flank_elements",
                Value::Number(flank as f64),
            );
            modelling(&model, surface)
        };
        let pair = |id: &str, modes: Option<usize>| {
            LoadedPair::new(&spec(0.0), &model(id, modes), MODELS).unwrap_or_else(|e| panic!("{e}"))
        };
        let mut full = pair("fe", None);
        let mut reduced = [0, 8, 60].map(|n| pair("elastic", Some(n)));
        let layout = full.layout();
        let (pitch, base) = (layout.pitch_point, layout.base_pitch);
        let mut largest = 0.0_f64;
        for (place, s, limit) in [
            ("pitch point", pitch, limits[0]),
            ("end of the path", pitch + 0.45 * base, limits[1]),
        ] {
            for force in [200.0, 2000.0] {
                let want = full.under_force(s, force).unwrap().approach;
                let found = reduced[2].under_force(s, force).unwrap();
                let apart = reduced[..2].iter_mut().fold(0.0_f64, |m, r| {
                    let other = r.at_approach(s, found.approach).unwrap().force;
                    m.max((other / found.force - 1.0).abs())
                });
                let off = found.approach / want - 1.0;
                println!(
                    "{surface:?}, {flank} elements, {place}, {force} N: approach {want:.4e} m, off by {off:+.1e}; any number of modes within {apart:.1e}"
                );
                assert!(apart < 1e-10, "{apart:.1e}");
                assert!(off.abs() < limit, "{off:.1e}");
                largest = largest.max(off.abs());
            }
        }
        of_facets.push(largest);
        for torque in [10.0, 60.0] {
            let spec = pressed(torque);
            let effective_radius = effective_radius(&spec.gears[0].body);
            let by_hand = reduced[2]
                .under_force(pitch, torque / effective_radius)
                .unwrap();
            let free = [0, 8, 60].map(|modes| {
                let mut scene = Scene::build(&spec, &model("elastic", Some(modes)), MODELS)
                    .unwrap_or_else(|e| panic!("{e}"));
                let mut s = scene.initial();
                s.q[0] = CLOSED;
                equilibrium(&mut scene, &mut s, &EquilibriumOptions::default()).unwrap();
                channel(&mut scene, &s, "displacement:pinion") * effective_radius
            });
            let apart = (free[0] / free[2] - 1.0)
                .abs()
                .max((free[1] / free[2] - 1.0).abs());
            let off = free[2] / by_hand.approach - 1.0;
            println!(
                "{surface:?}, {flank} elements, {torque} N m: free hub off by {off:+.1e}; any number of modes within {apart:.1e}"
            );
            assert!(apart < 1e-8, "{apart:.1e}");
            assert!(off.abs() < 1e-3, "{off:.1e}");
        }
    }
    println!(
        "largest, 6, 12 and 24 facets, smooth: {}",
        of_facets
            .iter()
            .map(|x| format!("{x:.1e} "))
            .collect::<String>()
    );
    for finer in of_facets[..3].windows(2) {
        assert!(finer[1] < 0.7 * finer[0], "{of_facets:?}");
    }
}

/// Differences of the force along random directions against the tangent, and the Newton correction against the dense
/// inverse.
#[test]
fn tangents_are_derivatives_and_corrections_their_inverse() {
    let mut scene = scene_of(&spec(-8e-6), 20);
    let mut s = scene.initial();
    let (sq, sv) = scales(&scene);
    let mut numbers = Numbers::new(11);
    let n = s.q.len();
    for g in scene.gears() {
        for i in g.range().skip(1) {
            s.q[i] = 0.05 * sq[i] * numbers.draw();
        }
    }
    assert!(scene.contact_forces(s.at()).len() > 1);
    let small = 1e-9 / scene.magnitudes().deflection;
    let gears: Vec<_> = scene.gears().iter().map(|g| g.range()).collect();
    let mut worst = 0.0_f64;
    for _ in 0..6 {
        let (dq, dv) = (numbers.vector(&sq), numbers.vector(&sv));
        let mut df = vec![0.0; n];
        scene.tangent_times(s.at(), &dq, &dv, &mut df);
        let mut moved = |x: f64| {
            let mut m = s.clone();
            for i in 0..n {
                m.q[i] += x * dq[i];
                m.v[i] += x * dv[i];
            }
            let mut f = vec![0.0; n];
            scene.force(m.at(), &mut f);
            f
        };
        let (above, below) = (moved(small), moved(-small));
        for range in &gears {
            let work = |i: usize, x: f64| (x * sq[i]).abs();
            let size = range.clone().fold(1e-12_f64, |m, i| m.max(work(i, df[i])));
            for i in range.clone() {
                let slope = (above[i] - below[i]) / (2.0 * small);
                worst = worst.max(work(i, slope - df[i]) / size);
            }
        }
    }
    println!("tangent off by {worst:.1e}");
    assert!(worst < 3e-3, "{worst:.1e}");

    let (mut worst, k) = (0.0_f64, 2.5e-13);
    let c = gearbench_integrators::Coeffs { m: 1.0, d: 0.0, k };
    let mut a = vec![0.0; n * n];
    for j in 0..n {
        let unit = |x: f64| -> Vec<f64> { (0..n).map(|i| if i == j { x } else { 0.0 }).collect() };
        let (mut df, mut mass) = (vec![0.0; n], vec![0.0; n]);
        scene.tangent_times(s.at(), &unit(k), &unit(0.0), &mut df);
        scene.apply_mass(s.at(), &unit(1.0), &mut mass);
        for i in 0..n {
            a[i * n + j] = (mass[i] - df[i]) * sq[i] * sq[j];
        }
    }
    let mut want = numbers.vector(&vec![1.0; n]);
    let mut x: Vec<f64> = want.iter().zip(&sq).map(|(r, s)| r / s).collect();
    scene.correct(s.at(), c, &mut x).unwrap();
    solve_in_place(&mut a, &mut want).unwrap();
    let size = want.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for i in 0..n {
        worst = worst.max((x[i] / sq[i] - want[i]).abs() / size);
    }
    println!("correction off by {worst:.1e}");
    assert!(worst < 1e-8, "{worst:.1e}");
}
