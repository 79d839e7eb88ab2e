//! Gears that run under load: slices, passivity, slow running compared with statics, torque ratio, order of the gears.

use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::{
    AcceptedStep, Control, Outputs, Resolution, SecondOrderSystem, Sink, State, TimePlan,
};
use gearbench_models::gear::table::Model;
use gearbench_models::geometry::GearParams;
use gearbench_models::law::Damping;
use gearbench_models::scene::{OfGear, OfMesh, Scene};
use gearbench_models::spec::{
    ContactSpec, Load, ModelSpec, Modelling, Profile, SceneSpec, effective_radius, mesh_layout,
};
use gearbench_reference::statics::{Load as StaticLoad, LoadedPair, MeshCycle};
use gearbench_tests::*;

mod elastic;
mod graded;
mod half_space;
mod statics;

/// Returns the gears of the FZG test rig, type C, under a torque in balance on both.
fn fzg(speed: f64, torque: f64) -> SceneSpec {
    let mut spec = fzg_c(speed);
    for (g, torque) in spec.gears.iter_mut().zip([torque, 1.5 * torque]) {
        g.loads = vec![Load::Applied(Profile::Constant(torque))];
    }
    spec
}

/// Returns the same gears with the wheel first.
fn exchanged(mut spec: SceneSpec) -> SceneSpec {
    spec.gears.swap(0, 1);
    spec
}

fn varying(damping: Damping) -> ContactSpec {
    ContactSpec {
        stiffness: weber_banaschek(),
        damping,
        ..contact(1.4e10)
    }
}

fn statics(spec: &SceneSpec, model: &ModelSpec, contact: &ContactSpec) -> LoadedPair {
    let modelling = Modelling {
        gears: vec![model.clone(), model.clone()],
        contacts: vec![contact.clone()],
    };
    let table: Vec<Model> = models_with_flanks();
    LoadedPair::new(spec, &modelling, &table).unwrap()
}

/// Sink that records energies and forces over a run.
#[derive(Default)]
struct Watch {
    contact: Option<f64>,
    /// Integral of the contact's power, magnitudes.
    power: f64,
    /// Time from which the recording starts.
    after: f64,
    peak: f64,
    error: Option<[f64; 2]>,
    torques: [f64; 2],
    time: f64,
    out: Outputs,
}

/// Returns a quantity of a gear of a pair.
fn of_gear(out: &Outputs, gear: usize, what: OfGear) -> f64 {
    out.channels[OfMesh::ALL.len() + OfGear::ALL.len() * gear + what as usize]
}

/// Returns the transmission error of a pair along the line of action [m].
fn transmission_error(spec: &SceneSpec, out: &Outputs) -> f64 {
    let r = [0, 1].map(|i| effective_radius(&spec.gears[i].body));
    let at = |i: usize| of_gear(out, i, OfGear::Displacement);
    r[0] * at(0) + r[1] * at(1)
}

struct Running<'a> {
    spec: &'a SceneSpec,
    watch: Watch,
}

impl Sink for Running<'_> {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let w = &mut self.watch;
        sys.output(step.to.at(), &mut w.out);
        let contact = w.out.energy.contact;
        if let Some(before) = w.contact {
            w.power += (contact - before).abs();
        }
        w.contact = Some(contact);
        if step.to.t > w.after {
            let h = step.to.t - step.from.t;
            let force = w.out.channels[0];
            w.peak = w.peak.max(force);
            let te = transmission_error(self.spec, &w.out);
            w.error = Some(match w.error {
                None => [te, te],
                Some([low, high]) => [low.min(te), high.max(te)],
            });
            w.time += h;
            for i in 0..2 {
                w.torques[i] += h * of_gear(&w.out, i, OfGear::ContactTorque);
            }
        }
        Control::Continue
    }
}

fn observe(
    spec: &SceneSpec,
    scene: &mut Scene,
    id: &str,
    resolution: Resolution,
    t_end: f64,
    after: f64,
) -> (State, Ledger, Watch) {
    let mut ledger = Ledger::default();
    let mut running = Running {
        spec,
        watch: Watch {
            after,
            ..Watch::default()
        },
    };
    let plan = TimePlan {
        max_steps: 4_000_000,
        ..TimePlan::new(t_end, resolution)
    };
    let start = scene.initial();
    let mut sinks = gearbench_integrators::observers::Tee(vec![&mut ledger, &mut running]);
    let (state, _) = watched(scene, start, id, &plan, &mut sinks);
    ledger.close(scene, &state);
    (state, ledger, running.watch)
}

#[test]
fn slices_share_stiffness_and_damping() {
    let mut spec = case_a(1e-6);
    spec.gears[1].mount = gearbench_models::spec::Mount::Revolute;
    for damping in [
        Damping::KelvinVoigtRatio { ratio: 0.05 },
        Damping::KelvinVoigt { c: 900.0 },
        Damping::HuntCrossley { e: 0.8 },
        Damping::Flores { e: 0.8 },
    ] {
        for model in [rigid(), movable(8e8, 8e-3, 0.0)] {
            let mut first: Option<[f64; 3]> = None;
            let mut worst = 0.0_f64;
            for slices in [1, 4, 16, 64] {
                let contact = ContactSpec {
                    slices: Some(slices),
                    ..varying(damping)
                };
                let mut scene = build(&spec, &[model.clone(), model.clone()], &contact);
                let o =
                    run(&mut scene, "dopri5", Resolution::Tolerance(1e-10), 3e-4).unwrap("impact");
                let got = [o.state.v[0], o.peak, o.ledger.dissipated];
                let want = *first.get_or_insert(got);
                for i in [0, 2] {
                    worst = worst.max((got[i] / want[i] - 1.0).abs());
                }
                // The peak is that of accepted steps, which a vibrating tooth places a little elsewhere.
                for ((got, want), allowed) in got.iter().zip(want).zip([1e-6, 1e-5, 1e-6]) {
                    assert!(
                        (got - want).abs() < allowed * want.abs(),
                        "{damping:?} {} {slices} slices: {got} against {want}",
                        model.id()
                    );
                }
            }
            println!(
                "{damping:?} {}: speeds and losses of 1 to 64 slices agree within {worst:.1e}",
                model.id()
            );
        }
    }
}

#[test]
fn loaded_helical_gears_converge_over_slices() {
    let mut spec = fzg(0.0, 94.1);
    for (g, sign) in spec.gears.iter_mut().zip([1.0, -1.0]) {
        let gearbench_models::spec::Body::Gear(own) = &g.body else {
            unreachable!()
        };
        let params = GearParams {
            helix_angle: sign * 12.0_f64.to_radians(),
            ..own.params().clone()
        };
        g.body = gearbench_models::spec::Body::Gear(
            gearbench_models::geometry::Gear::new(params).unwrap(),
        );
    }
    spec.gears[1].position[0] = 0.0935;
    let of = |slices: usize| {
        let contact = ContactSpec {
            slices: Some(slices),
            ..contact(1.4e10)
        };
        let mut pair = statics(&spec, &rigid(), &contact);
        let cycle = MeshCycle::solve(&mut pair, StaticLoad::Force(2600.0), 30, |_| {}).unwrap();
        [cycle.peak_to_peak(), cycle.mean_error()]
    };
    let fine = of(128);
    let counts = [4.0, 6.0, 8.0, 12.0, 16.0];
    let errors = counts.map(|n| {
        let got = of(n as usize);
        ((got[0] - fine[0]) / fine[1]).abs() + ((got[1] - fine[1]) / fine[1]).abs()
    });
    let order = -slope(&counts, &errors);
    assert!(order > 1.5, "order {order:.2} of {errors:?}");
    assert!(errors[4] < 5e-3, "{errors:?}");
}

#[test]
fn running_under_load_keeps_its_energy() {
    for (model, contact) in [
        (rigid(), varying(Damping::None)),
        (movable(8e8, 8e-3, 0.0), contact(2.68e10)),
    ] {
        let spec = fzg(400.0, 94.1);
        let steps = [1e-6, 0.5e-6, 0.25e-6];
        let residuals = steps.map(|h| {
            let mut scene = build(&spec, &[model.clone(), model.clone()], &contact);
            let (_, ledger, watch) = observe(
                &spec,
                &mut scene,
                "velocity-verlet",
                Resolution::Step(h),
                0.25,
                0.0,
            );
            ledger.residual().abs() / watch.power
        });
        println!("{}: {residuals:?}", model.id());
        assert!(
            residuals[0] < 1e-3 && residuals[2] < 1e-4,
            "{}: {residuals:?}",
            model.id()
        );
    }
}

#[test]
fn slow_running_tends_to_statics() {
    for (model, contact) in [
        (rigid(), varying(Damping::KelvinVoigtRatio { ratio: 0.05 })),
        (rigid(), varying(Damping::RatioAtLoad { ratio: 0.05 })),
        (
            movable(8e8, 8e-3, 0.0),
            ContactSpec {
                damping: Damping::KelvinVoigtRatio { ratio: 0.05 },
                ..contact(2.68e10)
            },
        ),
    ] {
        let torque = 94.1;
        let still = fzg(0.0, torque);
        let force = torque / effective_radius(&still.gears[0].body);
        let mut pair = statics(&still, &model, &contact);
        let cycle = MeshCycle::solve(&mut pair, StaticLoad::Force(force), 1200, |_| {}).unwrap();
        let peak = cycle.positions.iter().map(|p| p.force).fold(0.0, f64::max);
        let mut before = f64::INFINITY;
        for (hertz, bound) in [(180.0, 1.0), (60.0, 0.3), (20.0, 0.03)] {
            let speed = std::f64::consts::TAU * hertz / 16.0;
            let spec = fzg(speed, torque);
            let mut scene = build(&spec, &[model.clone(), model.clone()], &contact);
            let settled = 0.25 / hertz;
            let t_end = settled + 1.0 / hertz;
            let (_, _, watch) = observe(
                &spec,
                &mut scene,
                "dopri5",
                Resolution::Tolerance(1e-6),
                t_end,
                settled,
            );
            let [low, high] = watch.error.unwrap();
            let off = [
                watch.peak / peak - 1.0,
                (high - low) / cycle.peak_to_peak() - 1.0,
            ];
            println!(
                "{} {:?} {hertz} Hz: peak {:.4}, TE {:.4}",
                model.id(),
                contact.damping,
                1.0 + off[0],
                1.0 + off[1]
            );
            let worst = off[0].abs().max(off[1].abs());
            assert!(worst < bound, "{} {hertz} Hz: {off:?}", model.id());
            assert!(worst < before);
            before = worst;
        }
    }
}

/// The dynamic part of slow running falls with the speed: where a pair comes into contact at its tip edge the slope of
/// the static transmission error jumps, and the gears overshoot by the speed times that jump over their own frequency.
/// Free gears would stop before it vanishes, since their rotation has less energy than the teeth; the wheel is driven.
#[test]
fn the_overshoot_of_slow_running_falls_with_the_speed() {
    let contact = varying(Damping::KelvinVoigtRatio { ratio: 0.05 });
    let still = fzg(0.0, 94.1);
    let force = 94.1 / effective_radius(&still.gears[0].body);
    let mut pair = statics(&still, &rigid(), &contact);
    let cycle = MeshCycle::solve(&mut pair, StaticLoad::Force(force), 1200, |_| {}).unwrap();
    let over = [40.0, 20.0, 10.0, 5.0].map(|hertz| {
        let speed = std::f64::consts::TAU * hertz / 16.0;
        let mut spec = fzg(speed, 94.1);
        spec.gears[1].mount =
            gearbench_models::spec::Mount::Driven(Profile::Constant(-speed / 1.5));
        spec.gears[1].loads.clear();
        let mut scene = build(&spec, &[rigid(), rigid()], &contact);
        let settled = 0.25 / hertz;
        let (_, _, watch) = observe(
            &spec,
            &mut scene,
            "dopri5",
            Resolution::Tolerance(1e-6),
            settled + 1.0 / hertz,
            settled,
        );
        let [low, high] = watch.error.unwrap();
        (high - low) / cycle.peak_to_peak() - 1.0
    });
    println!("over statics at 40, 20, 10, 5 Hz: {over:?}");
    for pair in over.windows(2) {
        assert!(pair[1] < 0.7 * pair[0], "{over:?}");
    }
    assert!(over[3].abs() < 0.02, "{over:?}");
}

#[test]
fn the_torque_ratio_holds_in_the_mean_of_a_mesh_cycle() {
    let spec = fzg(100.0, 94.1);
    let contact = varying(Damping::KelvinVoigtRatio { ratio: 0.05 });
    let mut scene = build(&spec, &[rigid(), rigid()], &contact);
    let cycle = std::f64::consts::TAU / 16.0 / 100.0;
    let (_, _, watch) = observe(
        &spec,
        &mut scene,
        "dopri5",
        Resolution::Tolerance(1e-8),
        4.0 * cycle,
        cycle,
    );
    let ratio = watch.torques[1] / watch.torques[0];
    assert!((ratio / 1.5 - 1.0).abs() < 1e-3, "{ratio}");
}

#[test]
fn the_order_of_the_gears_does_not_matter() {
    for (model, contact) in [
        (rigid(), varying(Damping::KelvinVoigtRatio { ratio: 0.05 })),
        (rigid(), varying(Damping::HuntCrossley { e: 0.9 })),
        (
            movable(8e8, 8e-3, 0.0),
            ContactSpec {
                damping: Damping::KelvinVoigtRatio { ratio: 0.05 },
                ..contact(2.68e10)
            },
        ),
    ] {
        let spec = fzg(400.0, 94.1);
        let other = exchanged(spec.clone());
        let end = |spec: &SceneSpec| {
            let mut scene = build(spec, &[model.clone(), model.clone()], &contact);
            let o =
                run(&mut scene, "velocity-verlet", Resolution::Step(1e-6), 4e-3).unwrap("loaded");
            let speed = |name: &str| channel(&mut scene_at(spec, &model, &contact), &o.state, name);
            [
                speed("speed:pinion"),
                speed("speed:wheel"),
                o.impulse,
                o.peak,
            ]
        };
        for (a, b) in end(&spec).iter().zip(end(&other)) {
            assert!((a - b).abs() < 1e-9 * a.abs(), "{}: {a} {b}", model.id());
        }
    }
}

fn scene_at(spec: &SceneSpec, model: &ModelSpec, contact: &ContactSpec) -> Scene {
    build(spec, &[model.clone(), model.clone()], contact)
}
