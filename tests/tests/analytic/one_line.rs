//! Contacts on lines of action without candidates: their forces are those of the candidates; what a run under load takes.

use gearbench_integrators::observers::recorder::Recorder;
use gearbench_integrators::{
    AcceptedStep, Control, NullSink, Resolution, SecondOrderSystem, Sink, State, TimePlan, Work,
    method,
};
use gearbench_models::geometry::GearParams;
use gearbench_models::law::Damping;
use gearbench_models::scene::{Channel, OfGear, OfMesh, Scene};
use gearbench_models::spec::{Body, ContactSpec, Load, ModelSpec, Profile, SceneSpec};
use gearbench_tests::*;

fn loaded(torque: f64) -> SceneSpec {
    let mut spec = fzg_c(400.0);
    for (g, torque) in spec.gears.iter_mut().zip([torque, 1.5 * torque]) {
        g.loads = vec![Load::Applied(Profile::Constant(torque))];
    }
    spec
}

fn helical(mut spec: SceneSpec) -> SceneSpec {
    for (g, sign) in spec.gears.iter_mut().zip([1.0, -1.0]) {
        if let Body::Gear(own) = &g.body {
            let params = GearParams {
                helix_angle: sign * 12.0_f64.to_radians(),
                ..own.params().clone()
            };
            g.body = Body::Gear(gearbench_models::geometry::Gear::new(params).unwrap());
        }
    }
    spec.gears[1].position[0] = 0.0935;
    spec
}

fn compliance(damping: Damping) -> ContactSpec {
    ContactSpec {
        stiffness: weber_banaschek(),
        damping,
        ..contact(1.4e10)
    }
}

fn damped(per_width: f64, damping: Damping) -> ContactSpec {
    ContactSpec {
        damping,
        ..contact(per_width)
    }
}

/// Sink that records the ends of steps.
#[derive(Default)]
struct StateSink(Vec<State>);

impl Sink for StateSink {
    fn accepted(&mut self, _sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        self.0.push(step.to.clone());
        Control::Continue
    }
}

/// Springs inside a gear do not change the sum of the forces on it: the rest is the load and the contact forces on its
/// hub, computed from all their points and rows.
#[test]
fn forces_without_candidates_are_those_of_the_candidates() {
    let teeth = movable(8e8, 8e-3, 100.0);
    let kelvin = Damping::KelvinVoigtRatio { ratio: 0.05 };
    let at_load = Damping::RatioAtLoad { ratio: 0.05 };
    let cases: [(&str, SceneSpec, [ModelSpec; 2], ContactSpec); 7] = [
        (
            "coupled",
            loaded(94.1),
            [rigid(), rigid()],
            compliance(at_load),
        ),
        (
            "kelvin",
            loaded(94.1),
            [rigid(), rigid()],
            damped(1.4e10, kelvin),
        ),
        (
            "helical",
            helical(loaded(94.1)),
            [rigid(), rigid()],
            ContactSpec {
                slices: Some(3),
                ..compliance(at_load)
            },
        ),
        (
            "windows",
            loaded(94.1),
            [teeth.clone(), teeth.clone()],
            damped(2.68e10, at_load),
        ),
        (
            "teeth and rigid",
            loaded(94.1),
            [teeth.clone(), rigid()],
            damped(2.68e10, kelvin),
        ),
        (
            "coupled teeth",
            loaded(94.1),
            [teeth.clone(), teeth.clone()],
            compliance(at_load),
        ),
        (
            "all teeth",
            loaded(94.1),
            [all_teeth(teeth.clone()), teeth],
            contact(2.68e10),
        ),
    ];
    for (name, spec, models, contact) in cases {
        let mut scene = build(&spec, &models, &contact);
        let mut kept = StateSink::default();
        let plan = TimePlan::new(2e-3, Resolution::Tolerance(1e-5));
        let begin = scene.initial();
        watched(&mut scene, begin, "dopri5", &plan, &mut kept);
        let (mut in_contact, mut worst) = (0, 0.0_f64);
        for s in &kept.0 {
            let mut f = vec![0.0; s.q.len()];
            scene.force(s.at(), &mut f);
            let contacts = scene.contact_forces(s.at());
            in_contact += usize::from(!contacts.is_empty());
            for (k, g) in scene.gears().iter().enumerate() {
                let load = [94.1, 141.15][k];
                let sum: f64 = f[g.range()].iter().sum();
                let size: f64 = f[g.range()].iter().map(|f| f.abs()).sum();
                let expected: f64 = contacts.iter().map(|c| c.on_hubs[k]).sum();
                worst = worst.max((sum - load - expected).abs() / (load + size));
            }
        }
        println!(
            "{name}: {} states, {in_contact} in contact: {worst:.1e}",
            kept.0.len()
        );
        assert!(in_contact > 50 && worst < 1e-11, "{name}: {worst:e}");
    }
}

/// Returns force [N] and transmission error [m] on a grid.
fn series(scene: &mut Scene, rtol: f64) -> ([Vec<f64>; 2], Work) {
    let end = 0.01;
    let grid = (0..=2000).map(|i| end * f64::from(i) / 2000.0).collect();
    let mut recorder = Recorder::on(grid);
    let plan = TimePlan::new(end, Resolution::Tolerance(rtol));
    let (mut s, mut work) = (scene.initial(), Work::default());
    let mut dopri5 = method("dopri5").unwrap();
    dopri5
        .run(scene, &mut s, &plan, &mut recorder, &mut work)
        .unwrap();
    let column = |channel| recorder.column(scene.channel(channel).unwrap());
    let turned = [0, 1].map(|i| column(Channel::Gear(i, OfGear::Displacement)));
    let radius = [0, 1].map(|i| scene.gears()[i].model.hub().effective_base_radius);
    let error = turned[0].iter().zip(&turned[1]);
    let error = error.map(|(a, b)| radius[0] * a + radius[1] * b).collect();
    ([column(Channel::Mesh(0, OfMesh::Force)), error], work)
}

/// Ten mesh cycles within 0.1 %, whose time `cargo bench --bench real_time` measures, take at most this work.
#[test]
fn ten_loaded_mesh_cycles_within_a_thousandth_take_so_much_work() {
    let at_load = Damping::RatioAtLoad { ratio: 0.05 };
    let teeth = movable(8e8, 8e-3, 100.0);
    for (model, contact, rtol, most) in [
        (rigid(), compliance(at_load), 3e-4, [3300, 460, 70]),
        (teeth, damped(2.68e10, at_load), 1e-3, [21000, 2850, 200]),
    ] {
        let mut scene = build(&loaded(94.1), &[model.clone(), model.clone()], &contact);
        let (fine, _) = series(&mut scene, 1e-9);
        let (found, work) = series(&mut scene, rtol);
        let errors = [0, 1].map(|i| {
            let differ = found[i].iter().zip(&fine[i]).map(|(a, b)| (a - b).powi(2));
            (differ.sum::<f64>() / fine[i].iter().map(|x| x * x).sum::<f64>()).sqrt()
        });
        println!("{}: errors {errors:?}, {work:?}", model.id());
        assert!(
            errors.iter().all(|e| *e < 1e-3),
            "{}: {errors:?}",
            model.id()
        );
        let took = [work.force_evaluations, work.steps, work.events];
        assert!(
            took.iter().zip(most).all(|(took, most)| *took <= most),
            "{}: {took:?}",
            model.id()
        );
    }
    // Timing looks at the same runs without observers.
    let mut scene = build(&loaded(94.1), &[rigid(), rigid()], &compliance(at_load));
    let plan = TimePlan::new(0.01, Resolution::Tolerance(3e-4));
    let (mut s, mut work) = (scene.initial(), Work::default());
    let mut dopri5 = method("dopri5").unwrap();
    dopri5
        .run(&mut scene, &mut s, &plan, &mut NullSink, &mut work)
        .unwrap();
    assert!(work.force_evaluations <= 3300);
}
