//! Natural frequencies of scenes about their loaded state, as `gearbench modes` computes them: closed forms, loads and
//! the accelerated train, constraints, order.

use crate::shafts::{bar, body, coupling, on, shaft};
use gearbench::context::Context;
use gearbench::studies::modes::{ModesSettings, vibrations};
use gearbench_models::geometry::Side;
use gearbench_models::law::Damping;
use gearbench_models::spec::{
    Bearing, ContactSpec, Freedom, Load, ModelSpec, Modelling, Mount, OutOfPlaneSpec, Profile,
    SceneSpec, StationMember, effective_radius,
};
use gearbench_models::stiffness::Material;
use gearbench_reports::modes::{LinearisedState, ModelModes};
use gearbench_tests::*;
use std::f64::consts::TAU;

/// Returns the result of the study for a scene with one model for all gears.
pub fn vibrations_of(spec: &SceneSpec, model: &ModelSpec, contact: &ContactSpec) -> ModelModes {
    let modelling = Modelling {
        gears: vec![model.clone(); spec.gears.len()],
        contacts: vec![contact.clone(); spec.meshes.len()],
    };
    let wanted = ModesSettings {
        most: usize::MAX,
        ..ModesSettings::default()
    };
    let all = &models_with_flanks();
    let found =
        vibrations("it", (spec, &modelling), all, &wanted).expect("the scene can be assembled");
    assert!(found.residual_rel < 1e-12, "{}", found.residual_rel);
    found
}

/// Returns the frequencies of oscillations [Hz].
fn swinging(found: &ModelModes) -> Vec<f64> {
    let all = found.modes.iter().map(|m| m.frequency_hz);
    all.filter(|f| *f > 0.0).collect()
}

fn torque(value: f64) -> Vec<Load> {
    vec![Load::Applied(Profile::Constant(value))]
}

/// Returns gears of case A that start with open flanks, with torques on both.
fn loaded_pair(torques: [f64; 2]) -> SceneSpec {
    let mut spec = case_a(3e-5);
    for (g, t) in spec.gears.iter_mut().zip(torques) {
        g.speed = 0.0;
        g.loads = torque(t);
    }
    spec
}

/// Returns inertias and base radii of both gears.
fn pair_data(spec: &SceneSpec) -> [[f64; 2]; 2] {
    [0, 1].map(|i| {
        let g = &spec.gears[i];
        [g.inertia.unwrap(), effective_radius(&g.body)]
    })
}

const WIDTH: f64 = 0.01;

/// Two gears on one spring: `omega^2 = k (r1^2/J1 + r2^2/J2)`, with a dashpot `zeta = c omega / (2 k)`; torques that are out of
/// balance accelerate the train, and the mesh carries what is left.
#[test]
fn a_pair_swings_on_its_mesh() {
    let (per_width, c) = (2e10, 700.0);
    let damped = ContactSpec {
        damping: Damping::KelvinVoigt { c },
        ..contact(per_width)
    };
    // Balanced, out of balance, and the other way round, on the flanks beyond the backlash.
    for torques in [[60.0, 90.0], [60.0, 10.0], [-60.0, -20.0]] {
        let spec = loaded_pair(torques);
        let [[j1, r1], [j2, r2]] = pair_data(&spec);
        let yielding = r1 * r1 / j1 + r2 * r2 / j2;
        let force = (torques[0] * r1 / j1 + torques[1] * r2 / j2).abs() / yielding;
        let found = vibrations_of(&spec, &rigid(), &damped);
        let pairs = found.meshes[0].force_n / force;
        println!("{torques:?}: {found:?}");
        assert_eq!(
            (found.about, found.modes.len()),
            (LinearisedState::Loaded, 2)
        );
        assert!((pairs - 1.0).abs() < 1e-9, "{pairs}");
        assert_eq!(found.modes[0].frequency_hz, 0.0);
        let f = found.modes[1].frequency_hz;
        // One or two pairs share the load.
        let shares = [1.0_f64, 2.0].map(|n| (f * TAU).powi(2) / (n * per_width * WIDTH * yielding));
        let n = if (shares[0] - 1.0).abs() < 0.1 {
            1.0
        } else {
            2.0
        };
        let (k, c) = (n * per_width * WIDTH, n * c);
        let omega = (k * yielding).sqrt();
        assert!((f * TAU / omega - 1.0).abs() < 1e-9, "{shares:?}");
        let zeta = found.modes[1].damping_ratio.unwrap();
        let exact = 0.5 * c * omega / k;
        assert!((zeta / exact - 1.0).abs() < 1e-8, "{zeta} for {exact}");
        assert!((found.modes[1].strain[0] - 1.0).abs() < 1e-12);
        assert_eq!(found.modes[1].name, "mesh pinion - wheel");
        println!(
            "pair under load: frequency off by {:.1e}, mesh force by {:.1e}, damping ratio by {:.1e}",
            (f * TAU / omega - 1.0).abs(),
            (pairs - 1.0).abs(),
            (zeta / exact - 1.0).abs()
        );
        let share = r1 * r1 / j1 / yielding;
        assert!((found.modes[1].kinetic[0] - share).abs() < 1e-9);
    }
}

/// Without loads gears with open flanks remain so, and closed contacts are used as they are.
#[test]
fn without_loads_the_start_is_the_state() {
    let apart = vibrations_of(&case_a(3e-5), &rigid(), &contact(2e10));
    assert_eq!(
        (apart.about, apart.modes.len()),
        (LinearisedState::Apart, 1)
    );
    assert_eq!(apart.modes[0].multiplicity, 2);
    let pressed = vibrations_of(&case_a(-1e-6), &rigid(), &contact(2e10));
    assert_eq!(
        (pressed.about, pressed.modes.len()),
        (LinearisedState::Preloaded, 2)
    );
    // Torques that pull the gears apart, held by the ground in no way: they close on the other flanks. A gear that is held
    // and not pressed leaves nothing to find.
    let mut held = case_a(3e-5);
    held.gears[0].mount = Mount::Fixed;
    let held = vibrations_of(&held, &rigid(), &contact(2e10));
    assert_eq!(held.about, LinearisedState::Apart);
}

/// Of every model the state carries the load, energies of each mode are whole, and rigid gears on the same stiffness as movable
/// teeth in series with their contact swing alike.
#[test]
fn every_model_carries_its_load() {
    let spec = loaded_pair([60.0, 10.0]);
    let [[j1, r1], [j2, r2]] = pair_data(&spec);
    let yielding = r1 * r1 / j1 + r2 * r2 / j2;
    let force = (60.0 * r1 / j1 + 10.0 * r2 / j2) / yielding;
    for model in models() {
        let found = vibrations_of(&spec, &usual(&model), &contact(5e10));
        let off = found.meshes[0].force_n / force - 1.0;
        println!(
            "{}: {} steps, force {off:e}, {:?}",
            model.id,
            found.steps,
            swinging(&found)
        );
        assert_eq!(
            found.about,
            LinearisedState::Loaded,
            "{}: {}",
            model.id,
            found.message
        );
        // The hub of a gear whose modes move it shares its acceleration otherwise than one mass.
        assert!(off.abs() < 0.02, "{}: {off}", model.id);
        for m in found.modes.iter().filter(|m| m.frequency_hz > 0.0) {
            let [strain, kinetic] = [&m.strain, &m.kinetic].map(|s| s.iter().sum::<f64>());
            assert!((strain - 1.0).abs() < 1e-9 && (kinetic - 1.0).abs() < 1e-9);
        }
    }
}

/// A hub on a bearing with clearance under a load: it leaves the play and swings on the bearing; the other mass stays slack.
#[test]
fn bearings_carry_what_meshes_press() {
    let k = 4e7;
    let mut spec = loaded_pair([60.0, 90.0]);
    let mut bearing = Bearing::default();
    (bearing.stiffness[0][0], bearing.stiffness[1][1]) = (k, k);
    let mut directions: [Freedom; 6] = Default::default();
    (directions[0], directions[1]) = (Freedom::Free, Freedom::Free);
    spec.gears[1].lateral = Some(Box::new(OutOfPlaneSpec {
        directions,
        bearing,
        mass: Some(2.0),
        ..OutOfPlaneSpec::default()
    }));
    let tight = vibrations_of(&spec, &rigid(), &contact(2e10));
    let lowest = swinging(&tight);
    println!("{tight:?}");
    // Across the line of action the mesh does not act.
    let across = (k / 2.0).sqrt() / TAU;
    let found = lowest.iter().any(|f| (f / across - 1.0).abs() < 1e-3);
    assert!(found, "{lowest:?} for {across}");
    let named = |what: &str| tight.modes.iter().any(|m| m.name.contains(what));
    assert!(named("bearing of wheel") && named("mesh pinion - wheel"));
    assert_eq!(tight.modes[0].multiplicity, 1);
    let lateral = spec.gears[1].lateral.as_mut().unwrap();
    lateral.bearing.clearance = 2e-5;
    let loose = vibrations_of(&spec, &rigid(), &contact(2e10));
    assert_eq!(loose.about, LinearisedState::Loaded, "{}", loose.message);
    let force = loose.meshes[0].force_n / tight.meshes[0].force_n;
    assert!((force - 1.0).abs() < 1e-3, "{force}");
}

/// Rigid shafts leave no frequency: a gear with a body on a rigid shaft is a gear of both inertias.
#[test]
fn rigid_shafts_have_no_frequency() {
    let mut spec = loaded_pair([60.0, 90.0]);
    let with = 4e-4;
    let mut one = spec.clone();
    one.gears[0].added_inertia = with;
    spec.shafts = vec![shaft(
        "stiff",
        vec![on(0.0, 0), body(0.1, "disc", with)],
        vec![],
    )];
    let [joined, one] = [&spec, &one].map(|s| vibrations_of(s, &rigid(), &contact(2e10)));
    assert_eq!(
        (joined.constraints, joined.coordinates, joined.frequencies),
        (1, 3, 2)
    );
    let ratio = joined.modes[1].frequency_hz / one.modes[1].frequency_hz;
    println!("rigid shaft: frequency off by {:.1e}", (ratio - 1.0).abs());
    assert!((ratio - 1.0).abs() < 1e-10, "{ratio}");
}

/// Frequencies do not depend on the order of gears, nor on which gear of a mesh comes first.
#[test]
fn order_is_no_matter() {
    let gear_at = |name: &str, x: f64| {
        let mut g = gear(name, spur(30), x, 0.0);
        g.inertia = Some(1.5e-3);
        g
    };
    let scene = |names: [&str; 3]| {
        let place = |name: &str| match name {
            "a" => gear_at("a", 0.0),
            "b" => gear_at("b", 0.1201),
            _ => gear_at("c", 0.2402),
        };
        let mut gears: Vec<_> = names.into_iter().map(place).collect();
        let at = |name: &str| names.iter().position(|n| *n == name).unwrap();
        for (name, t) in [("a", 40.0), ("c", 25.0)] {
            gears[at(name)].loads = torque(t);
        }
        let shafts = vec![shaft(
            "out",
            vec![on(0.0, at("c")), body(0.3, "load", 0.01)],
            vec![bar(0.2, 0.03, Material::STEEL, 2), coupling(0.1, 2e4)],
        )];
        SceneSpec {
            duration: f64::INFINITY,
            meshes: vec![
                mesh([at("a"), at("b")], start(Side::Left, 1e-5)),
                mesh([at("b"), at("c")], start(Side::Left, 1e-5)),
            ],
            gears,
            shafts,
            stages: Vec::new(),
        }
    };
    let [one, other] = [["a", "b", "c"], ["c", "a", "b"]]
        .map(|names| vibrations_of(&scene(names), &rigid(), &contact(2e10)));
    println!("{:?}: {:?}", one.about, swinging(&one));
    assert_eq!(one.about, LinearisedState::Loaded, "{}", one.message);
    for (a, b) in swinging(&one).iter().zip(swinging(&other)) {
        assert!((a / b - 1.0).abs() < 1e-9, "{a} for {b}");
    }
    // The train as a whole, and nothing else, is rigid.
    assert_eq!(
        (one.modes[0].multiplicity, one.modes[0].frequency_hz),
        (1, 0.0)
    );
    assert!(one.meshes.iter().all(|m| m.force_n > 0.0));
}

/// The shipped driveline under its load: frequencies of the same train with a rigid mesh, a per cent below.
#[test]
fn shipped_driveline_swings_under_load() {
    let file = gearbench::scene_file::load(&Context::default(), "driveline").unwrap();
    let all = gearbench::models::models();
    for (choice, teeth) in file.models.iter().zip([false, true]) {
        let scene = (&file.spec_for(choice), &choice.modelling);
        let found = vibrations("it", scene, all, &ModesSettings::default()).unwrap();
        let f = swinging(&found);
        println!("{}: {:?}, {:?}", choice.label, found.meshes, f);
        assert_eq!(found.about, LinearisedState::Loaded, "{}", found.message);
        // The load balances the motor; how stiffness changes along the path takes a millionth of it.
        let force = 20.0 / effective_radius(&file.spec.gears[0].body);
        assert!((found.meshes[0].force_n / force - 1.0).abs() < 1e-5);
        for (f, rigid) in f.iter().zip([178.2, 615.0]) {
            assert!(*f < rigid && *f > 0.98 * rigid, "{f} for {rigid}");
        }
        assert!(found.modes[1].name.starts_with("torsion of"));
        assert_eq!(
            found.modes.iter().any(|m| m.name.starts_with("teeth of")),
            teeth
        );
        let damping = found.modes[1].damping_ratio.unwrap();
        assert!(damping > 0.01 && damping < 0.04, "{damping}");
    }
}

/// A sun and three planets on pins of a carrier that is held, or turns: planets swing against each other in a pair of modes,
/// `omega^2 = k r_p^2 / J_p`, and together against the sun, `k (3 r_s^2/J_s + r_p^2/J_p)` where the carrier is held.
#[test]
fn planets_swing_in_pairs() {
    let per_width = 2e10;
    for held in [true, false] {
        let mut spec = crate::planets::set(1e-5);
        for g in &mut spec.gears {
            g.speed = 0.0;
            g.inertia = Some(if g.name == "sun" { 4e-4 } else { 2.5e-4 });
        }
        spec.gears[0].loads = torque(50.0);
        if let StationMember::Body(carrier) = &mut spec.shafts[0].stations[0].carries {
            carrier.speed = 0.0;
            if held {
                carrier.mount = Mount::Fixed;
            }
        }
        let found = vibrations_of(&spec, &rigid(), &contact(per_width));
        println!(
            "held {held}: {} Hz, {:?}, {}",
            found.frequencies,
            swinging(&found),
            found.message
        );
        assert_eq!(found.about, LinearisedState::Loaded);
        let [[js, rs], [jp, rp]] = pair_data(&spec);
        let f = swinging(&found);
        let pairs = ((f[0] * TAU).powi(2) / (per_width * WIDTH * rp * rp / jp)).round();
        let k = pairs * per_width * WIDTH;
        let exact = [
            (k * rp * rp / jp).sqrt() / TAU,
            (k * (3.0 * rs * rs / js + rp * rp / jp)).sqrt() / TAU,
        ];
        println!(
            "planets, carrier held {held}: frequency off by {:.1e}",
            (f[0] / exact[0] - 1.0).abs()
        );
        assert!((f[0] / exact[0] - 1.0).abs() < 1e-6, "{f:?} for {exact:?}");
        let multiplicities: Vec<usize> = found.modes.iter().map(|m| m.multiplicity).collect();
        assert_eq!(multiplicities, [if held { 1 } else { 2 }, 2, 1]);
        if held {
            assert!((f[1] / exact[1] - 1.0).abs() < 1e-6, "{f:?} for {exact:?}");
        }
        let forces: Vec<f64> = found.meshes.iter().map(|m| m.force_n).collect();
        assert!(
            forces
                .iter()
                .all(|f| *f > 0.0 && (f / forces[0] - 1.0).abs() < 1e-6),
            "{forces:?}"
        );
    }
}
