//! Rattle of a loose gear: a wheel of inertia J with a drag torque T behind a pinion whose speed swings. The flanks push with
//! `T + J a` over the base radius of the wheel, so that they part where the shaft slows the wheel down by more than `T/J`:
//! `A w^2 z1/z2 > T/J` with the amplitude `A` of the shaft's angle, if teeth are stiff.

use gearbench::context::Context;
use gearbench::scene_file::{self, SceneFile, Selection};
use gearbench_integrators::{
    AcceptedStep, Control, Report, Resolution, SecondOrderSystem, Sink, State, TimePlan,
};
use gearbench_integrators::{Outputs, Work};
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{ContactSpec, Load, Modelling, Mount, Profile, SceneSpec};
use gearbench_models::stiffness::{PairOrMesh, PairStiffness};
use gearbench_tests::*;
use std::f64::consts::TAU;

/// Sink that detects a loss of contact after a given time.
struct SeparationSink {
    from: f64,
    force: usize,
    parted: bool,
    out: Outputs,
}

impl Sink for SeparationSink {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        if step.to.t < self.from {
            return Control::Continue;
        }
        let report: &mut dyn Report = sys.report().expect("scenes report");
        report.sample(step.to.at(), &mut self.out);
        self.parted |= self.out.channels[self.force] == 0.0;
        match self.parted {
            true => Control::Stop,
            false => Control::Continue,
        }
    }

    fn restarted(&mut self, _: &mut dyn SecondOrderSystem, _: &State, _: &State) {}
}

/// Returns the mean speed of the driven pinion and the frequency of its oscillation.
fn swing(spec: &SceneSpec) -> [f64; 2] {
    match &spec.gears[0].mount {
        Mount::Driven(Profile::Harmonic {
            mean, frequency, ..
        }) => [*mean, *frequency],
        other => panic!("{other:?}"),
    }
}

/// Returns the scene with another amplitude of the pinion's speed [rad/s], with the wheel in step at the start.
fn with_amplitude(spec: &SceneSpec, amplitude: f64) -> SceneSpec {
    let [mean, frequency] = swing(spec);
    let mut spec = spec.clone();
    spec.gears[0].mount = Mount::Driven(Profile::Harmonic {
        mean,
        amplitude,
        frequency,
        phase: 0.0,
    });
    spec.gears[1].speed = -(mean + amplitude) * 2.0 / 3.0;
    spec
}

/// Returns the drag over inertia of the wheel of a built scene [rad/s2].
fn drag(spec: &SceneSpec, scene: &Scene) -> f64 {
    let [Load::Applied(Profile::Constant(torque))] = &spec.gears[1].loads[..] else {
        panic!("a constant drag");
    };
    torque / scene.gears()[1].model.hub().inertia
}

/// Returns the amplitude of the pinion's speed above which flanks lose contact after a period to settle, relative to
/// that of the closed form with stiff teeth, by a number of bisections.
fn onset(
    spec: &SceneSpec,
    modelling: &Modelling,
    (method, resolution): (&str, Resolution),
    (settle, halves): (f64, usize),
) -> f64 {
    let [_, frequency] = swing(spec);
    let models = gearbench::models::models();
    let [mean, _] = swing(spec);
    // What of the wheel has its speed is then found again by it.
    let spec = &with_amplitude(spec, 0.02 * mean + 1.0);
    let mut scene = Scene::build(spec, modelling, models).unwrap();
    let closed = 1.5 * drag(spec, &scene) / (TAU * frequency);
    let parts = |scene: &mut Scene, amplitude: f64| {
        let varied = with_amplitude(spec, amplitude);
        let Mount::Driven(motion) = &varied.gears[0].mount else {
            unreachable!("it is driven");
        };
        scene.drive(0, motion.clone());
        let mut s = scene.initial();
        let wheel = scene.gears()[1].range();
        let speed = varied.gears[1].speed;
        let before = scene.gears()[1]
            .model
            .hub_state(scene.gears()[1].at(s.at()))
            .speed;
        s.v[wheel].iter_mut().for_each(|v| {
            if (*v - before).abs() < 1e-9 * before.abs() {
                *v = speed;
            }
        });
        let mut sink = SeparationSink {
            from: settle / frequency,
            force: named(scene, "force:0"),
            parted: false,
            out: Outputs::default(),
        };
        let plan = TimePlan::new((settle + 1.5) / frequency, resolution);
        let mut work = Work::default();
        let mut m = gearbench_integrators::method(method).unwrap();
        m.run(scene, &mut s, &plan, &mut sink, &mut work).unwrap();
        sink.parted
    };
    let (mut lo, mut hi) = (0.0, 1.6 * closed);
    assert!(parts(&mut scene, hi), "no onset up to {hi}");
    for _ in 0..halves {
        let mid = 0.5 * (lo + hi);
        if parts(&mut scene, mid) {
            hi = mid
        } else {
            lo = mid
        }
    }
    0.5 * (lo + hi) / closed
}

fn shipped(labels: &str) -> SceneFile {
    scene_file::load_for(
        &Context::default(),
        "gearbox_rattle",
        Selection::Labels(Some(labels)),
    )
    .unwrap()
}

/// Stiff teeth of one stiffness, at rest on average: the closed form, to what their compliance adds, `(w/w0)^2`.
#[test]
fn a_loose_gear_rattles_from_the_closed_form_on() {
    let file = shipped("rigid");
    // Strong dampers, too: flanks that part faster than these know.
    for (frequency, mean, ratio) in [
        (50.0, 0.0, 0.05),
        (100.0, 0.0, 0.05),
        (100.0, 200.0, 0.05),
        (100.0, 3.0, 0.1),
        (100.0, 3.0, 0.3),
    ] {
        let mut spec = file.spec.clone();
        spec.gears[0].mount = Mount::Driven(Profile::Harmonic {
            mean,
            amplitude: 1.0,
            frequency,
            phase: 0.0,
        });
        let mut modelling = file.models[0].modelling.clone();
        modelling.contacts[0] = ContactSpec {
            stiffness: PairStiffness::Constant {
                per_width: 1.4e10,
                of: PairOrMesh::Mesh,
            },
            damping: Damping::RatioAtLoad { ratio },
            ..modelling.contacts[0].clone()
        };
        let at = onset(
            &spec,
            &modelling,
            ("dopri5", Resolution::Tolerance(1e-7)),
            (1.0, 14),
        );
        println!(
            "{frequency} Hz about {mean} rad/s, damping ratio {ratio}: parts at {at:.5} of the closed form"
        );
        assert!((at - 1.0).abs() < 1e-2, "{at}");
    }
}

/// The models of the shipped scene: while the shaft swings about rest their teeth yield, but do not pass; at speed the passing of
/// teeth shakes a gear whose drag is all that presses it, and parts it sooner.
#[test]
fn models_rattle_near_the_closed_form() {
    for label in ["rigid", "movable-teeth", "elastic"] {
        let file = shipped(label);
        let model = file.model(label).unwrap();
        let (method, settle, halves) = match label {
            "elastic" => (("trigonometric", Resolution::Step(1e-6)), 6.0, 9),
            _ => (("dopri5", Resolution::Tolerance(1e-6)), 6.0, 12),
        };
        let turning = file.spec_for(model);
        let [_, frequency] = swing(&turning);
        let mut standing = turning.clone();
        standing.gears[0].mount = Mount::Driven(Profile::Harmonic {
            mean: 0.0,
            amplitude: 1.0,
            frequency,
            phase: 0.0,
        });
        let [at_rest, at_speed] = [&standing, &turning]
            .map(|spec| onset(spec, &model.modelling, method, (settle, halves)));
        println!(
            "{label}: parts at {at_rest:.4} of the closed form about rest, at {at_speed:.4} as shipped"
        );
        assert!((at_rest - 1.0).abs() < 0.05, "{label}: {at_rest}");
        assert!(at_speed < at_rest);
    }
}
