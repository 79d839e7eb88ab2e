//! Planetary sets with planets on elastic pins: they start with the velocity of their carrier, and keep it.

use crate::loaded_start::scene;
use gearbench_integrators::observers::ledger::Ledger;
use gearbench_integrators::system::{Outputs, Report, SecondOrderSystem, State};
use gearbench_integrators::{Resolution, TimePlan};
use gearbench_models::scene::Scene;
use gearbench_tests::watched;

/// Mass of a planet on an elastic pin [kg], and distance of the pins from the axis of the carrier [m].
const MASS: f64 = 1.0;
const DISTANCE: f64 = 0.081;
/// Speeds of sun, planets, ring and carrier that roll on each other [rad/s], for a carrier that turns by 200/9 rad/s.
const CARRIER: f64 = 200.0 / 9.0;
const SPEEDS: [f64; 6] = [100.0, -40.0, -40.0, -40.0, 0.0, CARRIER];

/// Free directions of the pins, and the settings of a gear for them.
pub(crate) const PINS: [(&str, &str); 4] = [
    ("", ""),
    (
        "z",
        "bearing = { stiffness = [0, 0, 1e8, 0, 0, 0] }\ndirections = { x = \"held\", y = \"held\", tilt_x = \"held\", tilt_y = \"held\" }",
    ),
    (
        "x, y",
        "bearing = { stiffness = [1e8, 1e8, 0, 0, 0, 0], damping = [2e3, 2e3, 0, 0, 0, 0] }\ndirections = { z = \"held\", tilt_x = \"held\", tilt_y = \"held\" }",
    ),
    (
        "x, y, z",
        "bearing = { stiffness = [1e8, 1e8, 1e8, 0, 0, 0], damping = [2e3, 2e3, 0, 0, 0, 0] }\ndirections = { tilt_x = \"held\", tilt_y = \"held\" }",
    ),
];

/// Elastic gears with contact of their elements in place of half-spaces.
const ELEMENTS: &str = "elastic with elements in contact";

/// Builds the shipped set on such pins.
fn on_pins(pins: &str, label: &str, loaded: bool) -> Scene {
    let planet = "bore_radius_m = 0.015\n";
    let with = format!("{planet}mass_kg = {MASS}\n{pins}\n");
    let mut changes = Vec::new();
    if !pins.is_empty() {
        changes.push((planet, with.as_str()));
    }
    if label == ELEMENTS {
        changes.push((
            "contact = { local = \"half-space\" }",
            "contact = { penalty_pa_per_m = 1e15 }",
        ));
    }
    let label = label.split(' ').next().unwrap_or(label);
    scene("planetary", label, loaded, &changes).unwrap()
}

/// Returns the kinetic energy of bodies that roll at the given speeds, with planets on elastic pins at their positions
/// [J].
fn closed_form(scene: &mut Scene, s: &State, free: &str) -> f64 {
    let gears = scene.gears().iter().zip(SPEEDS);
    let turns: f64 = gears
        .map(|(g, speed)| 0.5 * g.model.hub().hub.inertia * speed * speed)
        .sum();
    // Of planets whose places are held the carrier has the inertia.
    if !free.contains('x') {
        return turns;
    }
    let n = s.q.len();
    let (mut unit, mut mass) = (vec![0.0; n], vec![0.0; n]);
    let mut goes_round = 0.0;
    for planet in 1..4 {
        let (centre, first) = {
            let g = &scene.gears()[planet];
            (g.model.hub().hub.centre, g.range().start)
        };
        let place = (centre.x + s.q[first + 1]).hypot(centre.y + s.q[first + 2]);
        unit[first + 1] = 1.0;
        scene.apply_mass(s.at(), &unit, &mut mass);
        unit[first + 1] = 0.0;
        // A mesh of finite elements has nearly the mass that is given.
        let mass = mass[first + 1];
        assert!((place / DISTANCE - 1.0).abs() < 1e-4 && (mass / MASS - 1.0).abs() < 1e-4);
        goes_round += 0.5 * mass * (CARRIER * place).powi(2);
    }
    turns + goes_round
}

fn hub_speeds(scene: &Scene, v: &[f64]) -> Vec<f64> {
    (scene.gears().iter()).map(|g| v[g.range().start]).collect()
}

fn largest_error(speeds: &[f64]) -> f64 {
    let errors = speeds.iter().zip(SPEEDS).map(|(v, is)| (v - is).abs());
    errors.fold(0.0, f64::max) / SPEEDS[0]
}

#[test]
fn planets_on_pins_start_with_the_velocity_of_their_carrier() {
    for label in ["rigid", "movable-teeth", "elastic", ELEMENTS] {
        for (free, pins) in PINS {
            for loaded in [false, true] {
                let mut scene = on_pins(pins, label, loaded);
                let s = scene.initial();
                let mut out = Outputs::default();
                scene.output(s.at(), &mut out);
                let exact = closed_form(&mut scene, &s, free);
                let error = out.energy.kinetic / exact - 1.0;
                let speeds = largest_error(&hub_speeds(&scene, &s.v));
                println!(
                    "{label}, pins free along `{free}`, loaded {loaded}: {exact:.4} J, error {error:.1e}; speeds {speeds:.1e}"
                );
                assert!(error.abs() < 1e-6, "{label} {free} {loaded}: {error:e}");
                assert!(speeds < 1e-6, "{label} {free} {loaded}: {speeds:e}");
            }
        }
    }
}

#[test]
fn sets_on_pins_run_at_the_speeds_that_they_start_with() {
    let t_end = 1e-3;
    for (label, method, resolution) in [
        ("rigid", "dopri5", Resolution::Tolerance(1e-8)),
        ("movable-teeth", "dopri5", Resolution::Tolerance(1e-8)),
        ("elastic", "velocity-verlet", Resolution::Step(2.5e-7)),
        (ELEMENTS, "velocity-verlet", Resolution::Step(2.5e-7)),
    ] {
        for (free, pins) in PINS {
            let mut scene = on_pins(pins, label, true);
            let start = scene.initial();
            let energy = closed_form(&mut scene, &start, free);
            let n = start.q.len();
            let (mut momentum, first) = (vec![0.0; n], start.v.clone());
            scene.apply_mass(start.at(), &first, &mut momentum);
            let mut ledger = Ledger::default();
            let plan = TimePlan::new(t_end, resolution);
            let (end, _) = watched(&mut scene, start, method, &plan, &mut ledger);
            let unexplained = ledger.residual() / energy;
            // The speed of the train as a whole, without what vibrates.
            let along = |v: &[f64]| momentum.iter().zip(v).map(|(p, v)| p * v).sum::<f64>();
            let train = along(&end.v) / along(&first) - 1.0;
            let speeds = largest_error(&hub_speeds(&scene, &end.v));
            println!(
                "{label}, pins free along `{free}`: energy {unexplained:.1e}, speed of the train {train:.1e}, of hubs {speeds:.1e}"
            );
            assert!(unexplained.abs() < 1e-6, "{label} {free}: {unexplained:e}");
            assert!(train.abs() < 1e-3, "{label} {free}: {train:e}");
            // Teeth that pass let hubs swing by as much.
            assert!(speeds < 1e-2, "{label} {free}: {speeds:e}");
        }
    }
}
