//! Losses of gears with friction, compared with the quasi-static integral over a mesh cycle and with the loss factor
//! H_v of H. Ohlendorf (Dissertation, TU Munich 1958; ISO/TR 14179-2); friction does not chatter.

use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::system::{Coeffs, StateView};
use gearbench_integrators::{
    AcceptedStep, Control, Events, Outputs, Report, Resolution, SecondOrderSystem, Sink, TimePlan,
};
use gearbench_models::law::{Damping, Friction, FrictionForm};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    ContactSpec, FlankContact, Load, ModelSpec, Modelling, Mount, PointContact, Profile, SceneSpec,
    effective_radius, mesh_layout,
};
use gearbench_reference::MODELS;
use gearbench_tests::*;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

const MU: f64 = 0.05;
/// Speed of the pinion [rad/s] and torque on the wheel [N m].
const SPEED: f64 = 60.0;
const TORQUE: f64 = 141.15;

/// Returns the gears of the FZG test rig, type C, with the pinion driven.
fn driven() -> SceneSpec {
    let mut spec = fzg_c(SPEED);
    spec.gears[0].mount = Mount::Driven(Profile::Constant(SPEED));
    spec.gears[1].loads = vec![Load::Applied(Profile::Constant(TORQUE))];
    spec
}

fn rubbing(friction: Option<Friction>, ratio: f64) -> ContactSpec {
    ContactSpec {
        stiffness: weber_banaschek(),
        damping: match ratio {
            0.0 => Damping::None,
            ratio => Damping::RatioAtLoad { ratio },
        },
        friction,
        flanks: FlankContact::Points(PointContact::new(1e15)),
        ..contact(1.4e10)
    }
}

fn elastic(modes: usize) -> ModelSpec {
    let mesh = [
        ("flank_elements", 10),
        ("fillet_elements", 2),
        ("across_elements", 4),
        ("rim_elements", 2),
        ("width_elements", 1),
        ("modes", modes),
    ];
    with(model_of("elastic", mesh), "damping_ratio", 0.02)
}

fn scene_of(spec: &SceneSpec, model: &ModelSpec, contact: &ContactSpec) -> Scene {
    let modelling = Modelling {
        gears: vec![model.clone(); 2],
        contacts: vec![contact.clone()],
    };
    let table = [models(), MODELS.to_vec()].concat();
    Scene::build(spec, &modelling, &table).unwrap_or_else(|e| panic!("{e}"))
}

/// Returns the mean power [W] of friction over a mesh cycle when the wheel rotates uniformly and is always in balance.
fn quasi_static(spec: &SceneSpec, model: &ModelSpec, friction: Friction) -> f64 {
    let mut scene = scene_of(spec, model, &rubbing(Some(friction), 0.0));
    let (cycle, positions) = (TAU / 16.0 / SPEED, 200);
    let mut s = scene.initial();
    assert_eq!(s.q.len(), 1, "the wheel is all that gives way");
    let mut out = Outputs::default();
    let mut sum = 0.0;
    for i in 0..positions {
        s.t = cycle * (f64::from(i) + 0.5) / f64::from(positions);
        s.v[0] = -SPEED / 1.5;
        let even = -SPEED / 1.5 * s.t;
        // Turns that open the contact, and that press far more than the load does.
        let (mut open, mut pressed) = (even - 2e-3, even + 2e-3);
        for _ in 0..60 {
            let q = [0.5 * (open + pressed)];
            let mut f = [0.0];
            let at = StateView { q: &q, ..s.at() };
            scene.force(at, &mut f);
            if f[0] > 0.0 {
                open = q[0]
            } else {
                pressed = q[0]
            }
        }
        s.q[0] = open;
        scene.output(s.at(), &mut out);
        sum += out.power.dissipated;
    }
    sum / f64::from(positions)
}

/// Losses of a run.
struct Losses {
    after: f64,
    begun: Option<(f64, f64)>,
    ended: (f64, f64),
    /// Number of sign changes of the friction of a pair of teeth.
    flips: u32,
    /// Friction force by the teeth of a pair.
    friction_force: HashMap<[i64; 2], f64>,
    /// A second copy of the scene for evaluations.
    probe: Scene,
}

/// Sink with the ledger, and its content from a time on.
struct Watch {
    ledger: Ledger,
    losses: Losses,
}

impl Sink for Watch {
    fn accepted(&mut self, sys: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        let control = self.ledger.accepted(sys, step);
        let l = &mut self.losses;
        let now = (step.to.t, self.ledger.dissipated);
        if now.0 >= l.after {
            l.begun.get_or_insert(now);
            l.ended = now;
        }
        let forces = l.probe.contact_forces(step.to.at());
        let mut friction_force = HashMap::<_, f64>::new();
        for c in &forces {
            *friction_force.entry(c.teeth.map(|t| t.index)).or_default() += c.friction;
        }
        for (teeth, friction_force) in friction_force {
            let before = l
                .friction_force
                .insert(teeth, friction_force)
                .unwrap_or(0.0);
            l.flips += u32::from(friction_force * before < 0.0 && step.to.t >= l.after);
        }
        control
    }
}

/// Runs a scene over mesh cycles, of which the first are not counted.
fn watch([mut scene, probe]: [Scene; 2], step: f64, cycles: [f64; 2]) -> Watch {
    let cycle = TAU / 16.0 / SPEED;
    let mut watch = Watch {
        ledger: Ledger::default(),
        losses: Losses {
            after: cycles[0] * cycle,
            begun: None,
            ended: (0.0, 0.0),
            flips: 0,
            friction_force: HashMap::new(),
            probe,
        },
    };
    let plan = TimePlan {
        max_steps: 4_000_000,
        ..TimePlan::new(cycles[1] * cycle, Resolution::Step(step))
    };
    let start = scene.initial();
    watched(&mut scene, start, "trigonometric", &plan, &mut watch);
    watch
}

impl Losses {
    /// Returns the mean power over the counted time [W].
    fn power(&self) -> f64 {
        let begun = self.begun.unwrap();
        (self.ended.1 - begun.1) / (self.ended.0 - begun.0)
    }
}

/// Returns the loss factor of spur gears: the loss at a friction coefficient of one relative to the power when pairs
/// share the load equally.
fn loss_factor(spec: &SceneSpec) -> f64 {
    let l = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
    let ratio = 1.5;
    // Contact ratios of approach and recess.
    let [low, high] = l.path;
    let parts = [l.pitch_point - low, high - l.pitch_point].map(|s| s / l.base_pitch);
    let [e1, e2] = parts;
    PI * (ratio + 1.0) / (16.0 * ratio) * (1.0 - (e1 + e2) + e1 * e1 + e2 * e2)
}

#[test]
fn losses_are_those_of_the_quasi_static_integral_and_of_the_loss_factor() {
    let friction = Friction::new(MU, 2e-3).unwrap();
    let spec = driven();
    let by_factor = MU * loss_factor(&spec) * TORQUE * SPEED / 1.5;
    let rigid_gears = rigid();
    for (model, still, step) in [
        (rigid_gears.clone(), rigid_gears, 1e-6),
        (elastic(20), elastic(0), 5e-7),
    ] {
        let integral = quasi_static(&spec, &still, friction);
        let run = |friction| {
            let scene = || scene_of(&spec, &model, &rubbing(friction, 0.05));
            watch([scene(), scene()], step, [1.0, 3.0])
        };
        let (with, without) = (run(Some(friction)), run(None));
        let loss = with.losses.power() - without.losses.power();
        let residual = with.ledger.residual() / with.ledger.dissipated;
        let flips = f64::from(with.losses.flips) / 2.0;
        println!(
            "{}: {flips} flips a mesh cycle; {loss:.3} W, quasi-static {integral:.3} W, mu H_v P {by_factor:.3} W; damping {:.3} W; ledger open by {residual:.1e}",
            model.id(),
            without.losses.power()
        );
        assert!(
            (loss / integral - 1.0).abs() < 0.01,
            "{}: {loss} {integral}",
            model.id()
        );
        assert!(
            (loss / by_factor - 1.0).abs() < 0.05,
            "{}: {loss} {by_factor}",
            model.id()
        );
        // Each pair once, at its pitch point.
        assert!(
            flips <= 1.5,
            "{}: friction chatters, {flips} flips",
            model.id()
        );
        assert!(residual.abs() < 1e-3, "{}: {residual}", model.id());
    }
}

/// Returns gears at rest under torques that are nearly in balance: the imbalance is a fraction of the limit of
/// friction.
fn resting(of_limit: f64) -> SceneSpec {
    let mut spec = driven();
    let layout = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
    let off = 0.25 * layout.base_pitch;
    spec.meshes[0].start.path_coordinate = Some(layout.pitch_point + off);
    // About what the load presses them together by: little has to settle.
    spec.meshes[0].start.gap = -12e-6;
    let normal_force = TORQUE / effective_radius(&spec.gears[1].body);
    let limit = MU * normal_force * 2.5 * off;
    let loads = [TORQUE / 1.5, TORQUE + of_limit * limit];
    for (g, load) in spec.gears.iter_mut().zip(loads) {
        (g.mount, g.speed) = (Mount::Revolute, 0.0);
        g.loads = vec![Load::Applied(Profile::Constant(load))];
    }
    spec
}

/// Sink that measures the rotation of the wheel from a time on [rad].
struct Drift {
    wheel: usize,
    after: f64,
    low: f64,
    high: f64,
}

impl Sink for Drift {
    fn accepted(&mut self, _: &mut dyn SecondOrderSystem, step: &AcceptedStep<'_>) -> Control {
        if step.to.t >= self.after {
            let q = step.to.q[self.wheel];
            (self.low, self.high) = (self.low.min(q), self.high.max(q));
        }
        Control::Continue
    }
}

#[test]
fn friction_holds_what_sticks_and_lets_go_beyond() {
    let stick = Friction::of_form(MU, FrictionForm::StickSlip(1e-6)).unwrap();
    let creep = Friction::new(MU, 1e-2).unwrap();
    for (model, id) in [
        (rigid(), "velocity-verlet"),
        (rigid(), "newmark"),
        (rigid(), "dopri5"),
        (elastic(20), "trigonometric"),
        (elastic(20), "newmark"),
    ] {
        let resolution = match id {
            "dopri5" => Resolution::Tolerance(1e-7),
            "newmark" => Resolution::Step(2e-6),
            _ => Resolution::Step(1e-6),
        };
        let drift = |friction, of_limit| {
            let spec = resting(of_limit);
            let mut scene = scene_of(&spec, &model, &rubbing(Some(friction), 0.2));
            let mut drift = Drift {
                wheel: scene.gears()[1].range().start,
                after: 10e-3,
                low: f64::INFINITY,
                high: f64::NEG_INFINITY,
            };
            let plan = TimePlan {
                max_steps: 4_000_000,
                ..TimePlan::new(14e-3, resolution)
            };
            let s = scene.initial();
            watched(&mut scene, s, id, &plan, &mut drift);
            drift.high - drift.low
        };
        let (held, crept, slid) = (drift(stick, 0.5), drift(creep, 0.5), drift(stick, 3.0));
        println!(
            "{} by {id}: {held:.1e} rad held, {crept:.1e} crept, {slid:.1e} slid",
            model.id()
        );
        assert!(
            held < 0.05 * crept && held < 3e-4 && crept < 0.5 * slid,
            "{} by {id}",
            model.id()
        );
    }
}

/// The Newton correction of finite elements that rub solves the equation that their tangent makes.
#[test]
fn finite_elements_that_rub_have_their_correction() {
    let of_mesh = elastic(0).values().into_iter();
    let of_mesh = of_mesh.filter(|(key, _)| !["modes", "damping_ratio"].contains(&key.as_str()));
    let model = model_of("fe", of_mesh);
    for (friction, ratio) in [(0.0, 0.0), (0.3, 0.0), (0.3, 0.05)] {
        let friction = (friction > 0.0).then(|| Friction::new(friction, 0.5).unwrap());
        let mut spec = driven();
        spec.meshes[0].start.gap = -4e-6;
        // Off the pitch point, where flanks slide.
        let layout = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap();
        let place = layout.pitch_point + 0.25 * layout.base_pitch;
        spec.meshes[0].start.path_coordinate = Some(place);
        let mut scene = scene_of(&spec, &model, &rubbing(friction, ratio));
        let mut s = scene.initial();
        scene.begin(&mut s, false);
        let forces = scene.contact_forces(s.at());
        let rubs = forces
            .iter()
            .any(|c| c.friction.abs() > 1e-3 * c.normal_force);
        assert_eq!(rubs, friction.is_some());
        let c = Coeffs {
            m: 1.0,
            d: 5e-7,
            k: 2.5e-13,
        };
        let n = s.q.len();
        // Forces of either sign on all coordinates, as large as their masses.
        let sines: Vec<f64> = (0..n).map(|i| ((7 * i) as f64).sin()).collect();
        let mut rhs = vec![0.0; n];
        scene.apply_mass(s.at(), &sines, &mut rhs);
        let largest = rhs.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let mut x = rhs.clone();
        scene.correct(s.at(), c, &mut x).unwrap();
        let (mut mass, mut df) = (vec![0.0; n], vec![0.0; n]);
        scene.apply_mass(s.at(), &x, &mut mass);
        let by = |factor: f64| -> Vec<f64> { x.iter().map(|x| factor * x).collect() };
        scene.tangent_times(s.at(), &by(c.k), &by(c.d), &mut df);
        let worst = (0..n).fold(0.0_f64, |w, i| w.max((mass[i] - df[i] - rhs[i]).abs())) / largest;
        println!(
            "{} contacts, friction {}: off by {worst:.1e}",
            forces.len(),
            friction.is_some()
        );
        // Of the penalty, whose stiffness stands beside a mass over the square of the step.
        assert!(worst < 3e-6, "{worst:.1e}");
    }
}

/// A quarter of a second of running: friction flips once a pair of teeth, and takes what it took in two mesh cycles.
#[test]
#[ignore = "a minute: cargo test --release -p gearbench-tests --test conformance -- quarter --include-ignored --nocapture"]
fn friction_does_not_chatter_for_a_quarter_of_a_second() {
    let friction = Friction::new(MU, 2e-3).unwrap();
    let spec = driven();
    let cycles = 0.25 / (TAU / 16.0 / SPEED);
    for (model, still) in [(rigid(), rigid()), (elastic(20), elastic(0))] {
        let scene = || scene_of(&spec, &model, &rubbing(Some(friction), 0.05));
        let run = watch([scene(), scene()], 1e-6, [1.0, cycles]);
        let flips = f64::from(run.losses.flips) / (cycles - 1.0);
        let (loss, integral) = (run.losses.power(), quasi_static(&spec, &still, friction));
        let residual = run.ledger.residual() / run.ledger.dissipated;
        println!(
            "{}: {flips:.2} flips a mesh cycle, {loss:.2} W with damping, quasi-static {integral:.2} W, ledger open by {residual:.1e}",
            model.id()
        );
        assert!(flips <= 1.1, "{}: {flips} flips", model.id());
        assert!(
            (loss / integral - 1.0).abs() < 0.03,
            "{}: {loss} {integral}",
            model.id()
        );
        assert!(residual.abs() < 3e-3, "{}: {residual}", model.id());
    }
}
