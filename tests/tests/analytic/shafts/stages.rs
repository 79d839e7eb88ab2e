//! Stages without teeth: exact frequencies, accelerations and damping, conservation, torques that are reported, and the
//! kinematics of the train.

use super::torsion::driveline;
use super::*;
use gearbench_integrators::{Events, Outputs, Report, Resolution, TimePlan};
use gearbench_models::scene::Channel;
use gearbench_models::spec::{Load, Profile, ShaftDamping, StageSpec, Train};

/// Inertias of the two members of a stage [kg m^2], its ratio, its stiffness [N m/rad] and its damping time [s].
const INERTIAS: [f64; 2] = [2e-3, 3e-2];
const RATIO: f64 = -3.5;
const STIFFNESS: f64 = 5e3;
const TIME: f64 = 1e-4;

fn stage(members: [usize; 2], stiffness: f64, damping: f64) -> StageSpec {
    StageSpec {
        name: "belt".into(),
        members,
        ratio: RATIO,
        stiffness,
        damping,
    }
}

/// Returns two bodies on shafts of their own, without gears, and a stage between them.
fn pair(stiffness: f64, damping: f64) -> SceneSpec {
    // A shaft joins two members: the second one of each has hardly any inertia.
    let of = |k: usize| {
        let stations = vec![
            body(0.0, &format!("body {k}"), INERTIAS[k]),
            body(0.1, &format!("end {k}"), 1e-15),
        ];
        shaft(&format!("shaft {k}"), stations, vec![coupling(0.1, 1e-3)])
    };
    SceneSpec {
        stages: vec![stage([0, 2], stiffness, damping)],
        ..alone(vec![of(0), of(1)])
    }
}

/// The reduced inertia of the stage at its second member: `1/J = 1/(i^2 J_1) + 1/J_2`.
fn reduced() -> f64 {
    (1.0 / (RATIO * RATIO * INERTIAS[0]) + 1.0 / INERTIAS[1]).recip()
}

/// A stage between two inertias vibrates at the frequency of its spring on the reduced inertia. The damping of the stage
/// is proportional to its stiffness.
#[test]
fn an_elastic_stage_has_its_frequency_and_damping() {
    let omega = (STIFFNESS / reduced()).sqrt();
    let mut scene = build(&pair(STIFFNESS, TIME), &[], &contact(1e9));
    let found = frequencies(&mut scene);
    let highest = found
        .iter()
        .map(|f| f * TAU)
        .filter(|w| *w < 1e5)
        .fold(0.0_f64, f64::max);
    let near = found.iter().map(|f| f * TAU / omega - 1.0);
    let nearest = near.fold(
        f64::INFINITY,
        |m: f64, x| if x.abs() < m.abs() { x } else { m },
    );
    println!("{highest} rad/s, expected {omega}: {nearest:.1e}");
    assert!(nearest.abs() < 1e-9, "{found:?}");
    // Along the mode, x = (i J_2, -J_1 i^2 ..) with `C x = time K x`.
    let s = scene.initial();
    let mut along = vec![0.0; s.q.len()];
    along[0] = 1.0 / (RATIO * INERTIAS[0]);
    along[2] = -1.0 / INERTIAS[1];
    let zero = vec![0.0; along.len()];
    let (mut by_place, mut by_speed) = (zero.clone(), zero.clone());
    scene.tangent_times(s.at(), &along, &zero, &mut by_place);
    scene.tangent_times(s.at(), &zero, &along, &mut by_speed);
    for i in [0, 2] {
        // The springs to the ends have no damping.
        assert!((by_speed[i] / by_place[i] / TIME - 1.0).abs() < 1e-5);
    }
}

/// A rigid stage accelerates both members in its ratio, as one inertia, under every method, with its energy balance.
#[test]
fn a_rigid_stage_moves_both_members_in_its_ratio() {
    let torque = 4.0;
    let mut spec = pair(f64::INFINITY, 0.0);
    if let StationMember::Body(body) = &mut spec.shafts[0].stations[0].carries {
        body.loads = vec![Load::Applied(Profile::Constant(torque))];
    }
    let expected = torque / (INERTIAS[0] + INERTIAS[1] / (RATIO * RATIO));
    let time = 1e-3;
    for id in ["rk4", "velocity-verlet", "generalised-alpha", "dopri5"] {
        let mut scene = build(&spec, &[], &contact(1e9));
        let resolution = match id {
            "dopri5" => Resolution::Tolerance(1e-9),
            _ => Resolution::Step(1e-6),
        };
        let o = run(&mut scene, id, resolution, time).unwrap(id);
        let [first, second] = [o.state.v[0], o.state.v[2]];
        // The ends on weak springs hardly move.
        assert!(
            (first / (expected * time) - 1.0).abs() < 1e-5,
            "{id}: {first}"
        );
        assert!((first / second / RATIO - 1.0).abs() < 1e-11, "{id}");
        assert!(o.ledger.residual_relative().abs() < 1e-6, "{id}");
        let channel = scene.channel(Channel::ShaftTorque(2)).unwrap();
        let mut out = Outputs::default();
        scene.output(o.state.at(), &mut out);
        let on_second = INERTIAS[1] * expected / RATIO;
        assert!(
            (out.channels[channel] / on_second - 1.0).abs() < 1e-5,
            "{id}"
        );
    }
}

/// Free of damping and loads a stage keeps the energy, as the order of a method says, and the momentum `J_1 w_1 + J_2 w_2/i`.
#[test]
fn a_stage_keeps_energy_and_momentum() {
    let mut scene = build(&pair(STIFFNESS, 0.0), &[], &contact(1e9));
    let mut s = scene.initial();
    s.v = vec![7.0, 7.0, 3.0, 3.0];
    let momentum = |s: &State| RATIO * INERTIAS[0] * s.v[0] + INERTIAS[1] * s.v[2];
    let (before, p) = (energy(&mut scene, &s), momentum(&s));
    for id in [
        "rk4",
        "velocity-verlet",
        "trigonometric",
        "generalised-alpha",
    ] {
        let plan = TimePlan::new(2e-2, Resolution::Step(1e-6));
        let end = run_from(&mut scene, s.clone(), id, &plan).unwrap(id).state;
        let moved = (momentum(&end) / p - 1.0).abs();
        let drift = (energy(&mut scene, &end) / before - 1.0).abs();
        println!("{id}: energy {drift:.1e}, momentum {moved:.1e}");
        // The springs to the ends pull, by 1e-3 N m/rad.
        assert!(moved < 1e-5 && drift < 1e-5, "{id}: {drift} {moved}");
    }
}

/// In a scene with gears, for every model: the Newton correction is the inverse of the matrix of the tangents, with an
/// elastic and with a rigid stage.
#[test]
fn corrections_invert_tangents_with_stages() {
    for subject in subjects() {
        for stiffness in [3e4, f64::INFINITY] {
            let mut spec = driveline(ShaftDamping::Time(1e-6));
            let stations = vec![body(0.0, "drum", 1e-2), body(0.1, "flywheel", 2e-2)];
            spec.shafts
                .push(shaft("winch", stations, vec![coupling(0.1, 4e4)]));
            // Members: two gears, motor, load, drum, flywheel.
            spec.stages = vec![stage([3, 4], stiffness, 0.0)];
            let mut scene = of_subject(&spec, &subject);
            let mut s = scene.initial();
            scene.begin(&mut s, false);
            let c = Coeffs {
                m: 1.0,
                d: 1e-6,
                k: 1e-12,
            };
            let rigid = stiffness.is_infinite();
            corrects(&mut scene, &s, c, rigid, &subject.name);
        }
    }
}

/// Speeds in step are in the ratio of the stage.
#[test]
fn the_train_turns_in_the_ratio_of_a_stage() {
    let mut spec = pair(STIFFNESS, 0.0);
    for station in &mut spec.shafts[0].stations {
        if let StationMember::Body(body) = &mut station.carries {
            body.speed = 70.0;
        }
    }
    let train = Train::new(&spec);
    let speeds = train.in_step(&[0]);
    assert!((speeds[2] - 70.0 / RATIO).abs() < 1e-12 && (speeds[3] - 70.0 / RATIO).abs() < 1e-12);
    assert_eq!(train.joined(0), [0, 1, 2, 3]);
}

/// A stage with an impossible ratio, stiffness, damping or pair of members is refused by its name.
#[test]
fn stages_that_cannot_be_are_refused() {
    let refused = |change: fn(&mut StageSpec), what: &str| {
        let mut spec = pair(STIFFNESS, 0.0);
        change(&mut spec.stages[0]);
        let modelling = Modelling {
            gears: vec![],
            contacts: vec![],
        };
        let built = Scene::build(&spec, &modelling, &joined().models);
        let text = built.err().unwrap().to_string();
        assert!(
            text.contains("stage `belt`") && text.contains(what),
            "{text}"
        );
    };
    refused(|s| s.ratio = 0.0, "ratio");
    refused(|s| s.stiffness = -1.0, "stiffness");
    refused(|s| s.damping = f64::NAN, "damping");
    refused(|s| s.members = [2, 2], "itself");
    refused(
        |s| {
            s.stiffness = f64::INFINITY;
            s.damping = 1e-5;
        },
        "rigid",
    );
}

/// A section with damping of its own has that in place of its shaft's.
#[test]
fn sections_have_their_own_damping() {
    let stations = (0..3).map(|i| body(0.1 * f64::from(i), &format!("disc {i}"), 1e-3));
    let mut sections = vec![coupling(0.1, 2e4), coupling(0.1, 1e4)];
    sections[1].damping = Some(0.0);
    let damped = ShaftSpec {
        damping: ShaftDamping::Time(3e-6),
        ..shaft("chain", stations.collect(), sections)
    };
    let mut scene = build(&alone(vec![damped]), &[], &contact(1e9));
    let s = scene.initial();
    let damping = scene.damping_matrix(s.at());
    let c = 3e-6 * 2e4;
    let expected = [[c, -c, 0.0], [-c, c, 0.0], [0.0; 3]];
    for (i, row) in expected.iter().enumerate() {
        for (j, x) in row.iter().enumerate() {
            assert!((damping[(i, j)] - x).abs() < 1e-12 * c, "{damping}");
        }
    }
}
