//! Gears reduced from a small mesh: order of swinging in contact, and statics against the full mesh.

use gearbench_integrators::{
    EquilibriumOptions, METHODS, Outputs, Report, Resolution, SecondOrderSystem, Stepping,
    TimePlan, equilibrium,
};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    ContactSpec, Load, ModelSpec, Modelling, Mount, Passes, PointContact, Profile, SceneSpec,
    SurfaceKind, effective_radius,
};
use gearbench_reference::MODELS;
use gearbench_reference::statics::LoadedPair;
use gearbench_tests::*;

/// Rotation of the pinion [rad] by which the flanks overlap.
const CLOSED: f64 = 3e-4;

/// Returns a model on a small generated mesh, with modes of the elastic one.
pub(crate) fn meshed(id: &str, modes: Option<usize>) -> ModelSpec {
    let mesh = [
        ("flank_elements", 6),
        ("fillet_elements", 2),
        ("across_elements", 4),
        ("rim_elements", 2),
        ("width_elements", 1),
    ];
    let values = mesh.into_iter().chain(modes.map(|n| ("modes", n)));
    model_of(id, values)
}

pub(crate) fn modelling(model: &ModelSpec, surface: SurfaceKind) -> Modelling {
    let points = PointContact {
        surface,
        // Both passes nearly hide what displacements along the flanks do.
        passes: Passes::First,
        ..PointContact::new(1e15)
    };
    Modelling {
        gears: vec![model.clone(), model.clone()],
        contacts: vec![ContactSpec {
            flanks: points.into(),
            ..contact(1.5e10)
        }],
    }
}

fn scene_of(spec: &SceneSpec, modes: usize) -> Scene {
    let model = meshed("elastic", Some(modes));
    Scene::build(spec, &modelling(&model, SurfaceKind::Smooth), MODELS)
        .unwrap_or_else(|e| panic!("{e}"))
}

/// Returns case A at rest with a torque [N m] on the pinion and the wheel fixed.
fn pressed(torque: f64) -> SceneSpec {
    let mut spec = case_of_body(0.0);
    spec.gears[0].speed = 0.0;
    spec.gears[0].loads = vec![Load::Applied(Profile::Constant(torque))];
    spec.gears[1].mount = Mount::Fixed;
    spec
}

/// Gears that vibrate in contact, with such a small amplitude that the same points touch all the time, have the
/// declared order.
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
            let model = with(meshed(id, modes), "flank_elements", flank as f64);
            modelling(&model, surface)
        };
        let pair = |id: &str, modes: Option<usize>| {
            LoadedPair::new(&case_of_body(0.0), &model(id, modes), MODELS)
                .unwrap_or_else(|e| panic!("{e}"))
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
            let [effective_radius, of_wheel] =
                [0, 1].map(|i: usize| effective_radius(&spec.gears[i].body));
            // One pass leaves the torques of both gears a little off their ratio: the force along the line of action is what
            // both balance in the mean.
            let mut along = 0.0;
            let free = [0, 8, 60].map(|modes| {
                let mut scene = Scene::build(&spec, &model("elastic", Some(modes)), MODELS)
                    .unwrap_or_else(|e| panic!("{e}"));
                let mut s = scene.initial();
                s.q[0] = CLOSED;
                equilibrium(&mut scene, &mut s, &EquilibriumOptions::default()).unwrap();
                let on_wheel = channel(&mut scene, &s, "contact_torque:wheel");
                along = 0.5 * (torque / effective_radius + on_wheel.abs() / of_wheel);
                channel(&mut scene, &s, "hub_angle:pinion") * effective_radius
            });
            let by_hand = reduced[2].under_force(pitch, along).unwrap();
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

/// Contact forces of full finite elements are the gradient of their energy, along the whole path and where points leave
/// over the tips: against differences of the energy in random directions of all nodes and both hubs.
#[test]
fn forces_of_finite_elements_are_the_gradient_of_their_energy() {
    let model = meshed("fe", None);
    for surface in [SurfaceKind::Smooth, SurfaceKind::Faceted] {
        let mut modelling = modelling(&model, surface);
        for contact in &mut modelling.contacts {
            if let Some(points) = contact.flanks.points_mut() {
                points.passes = Passes::Both;
            }
        }
        let (mut leaving, mut worst) = (0, 0.0_f64);
        for step in 0..28_u32 {
            // Chords lie below the flanks: they have to be pressed deeper.
            let mut spec = case_of_body(match surface {
                SurfaceKind::Smooth => -6e-6,
                SurfaceKind::Faceted => -25e-6,
            });
            spec.meshes[0].start.path_coordinate = Some(6e-3 + 0.6e-3 * f64::from(step));
            let mut scene =
                Scene::build(&spec, &modelling, MODELS).unwrap_or_else(|e| panic!("{e}"));
            let s = scene.initial();
            let fades = |c: &gearbench_models::contact::Candidate| c.taper < 1.0 && c.gap < 0.0;
            leaving += candidates(&scene, &s)
                .iter()
                .filter(|(_, c)| fades(c))
                .count();
            let mut f = vec![0.0; s.q.len()];
            scene.force(s.at(), &mut f);
            // Nodes of undeformed gears: nothing but contact acts.
            let mut numbers = Numbers::new(9 + u64::from(step));
            let mut scale = vec![1.0; s.q.len()];
            for g in scene.gears() {
                scale[g.range().start] = 20.0;
            }
            let direction = numbers.vector(&scale);
            let mut out = Outputs::default();
            let mut energy = |x: f64| {
                let mut moved = s.clone();
                for (q, d) in moved.q.iter_mut().zip(&direction) {
                    *q += x * d;
                }
                scene.output(moved.at(), &mut out);
                out.energy.contact
            };
            let h = 2e-9;
            let change = (8.0 * (energy(h) - energy(-h)) - (energy(2.0 * h) - energy(-2.0 * h)))
                / (12.0 * h);
            let along = f.iter().zip(&direction);
            let (work, size) = along.fold((0.0, 0.0_f64), |(w, s), (f, d)| {
                (w + f * d, s + (f * d).abs())
            });
            worst = worst.max((change + work).abs() / size);
        }
        println!("{surface:?}: {leaving} points leave, forces off by {worst:.1e}");
        assert!(leaving > 1, "{surface:?}: {leaving}");
        assert!(worst < 1e-6, "{surface:?}: {worst:.1e}");
    }
}
