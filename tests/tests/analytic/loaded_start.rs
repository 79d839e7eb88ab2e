//! Scenes that start in the equilibrium of their loads: only the train as a whole accelerates.

use crate::pin_starts::PINS;
use gearbench::context::Context;
use gearbench::scene_file::{Origin, SceneFile, shipped::SHIPPED};
use gearbench::small_signals::{Patience, assemble};
use gearbench_integrators::system::{Change, SecondOrderSystem, State};
use gearbench_integrators::{NullSink, Resolution, TimePlan, Work, method};
use gearbench_models::error::{BuildError, MeshPart, Subject};
use gearbench_models::scene::Scene;

/// Returns a shipped scene with or without `loaded = true` in its start, and with other changes to its text.
pub(crate) fn shipped(name: &str, loaded: bool, changes: &[(&str, &str)]) -> SceneFile {
    let shipped = SHIPPED.iter().find(|s| s.name == name).unwrap();
    let mut text = shipped.text.to_owned();
    if loaded {
        let at = text.find("start = {").unwrap();
        let end = at + text[at..].find('}').unwrap();
        text.insert_str(end, ", loaded = true ");
    }
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    SceneFile::unbuilt(&Context::default(), name, &text, Origin::Shipped, true).unwrap()
}

/// Builds a model of such a scene.
pub(crate) fn scene(
    name: &str,
    label: &str,
    loaded: bool,
    changes: &[(&str, &str)],
) -> Result<Scene, BuildError> {
    let file = shipped(name, loaded, changes);
    let choice = file.model(label).unwrap();
    assemble(
        &file.spec_for(choice),
        &choice.modelling,
        gearbench::models::models(),
        &Patience::ENDLESS,
    )
}

/// Largest acceleration but for that along the motion of the train as a whole, in typical units, and forces of the meshes [N].
///
/// Stiffness that varies along the path takes energy from the rotation under load: that much the train slows down.
fn at_start(scene: &mut Scene) -> (f64, Vec<f64>) {
    let s = scene.initial();
    let n = s.q.len();
    let (mut f, mut q, mut v) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    scene.force(s.at(), &mut f);
    let mut momentum = vec![0.0; n];
    scene.apply_mass(s.at(), &s.v, &mut momentum);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let along = dot(&s.v, &f) / dot(&s.v, &momentum);
    f.iter_mut()
        .zip(&momentum)
        .for_each(|(f, p)| *f -= along * p);
    scene.solve_mass(s.at(), &mut f);
    scene.scales(&mut q, &mut v);
    let largest = f
        .iter()
        .zip(&q)
        .map(|(a, q)| (a / q).abs())
        .fold(0.0, f64::max);
    let mut forces = vec![0.0; scene.meshes().len()];
    for c in scene.contact_forces(s.at()) {
        forces[c.mesh] += c.normal_force;
    }
    (largest, forces)
}

#[test]
fn loads_that_balance_accelerate_nothing() {
    for (name, label) in [
        ("loaded_mesh", "rigid"),
        ("loaded_mesh", "movable-teeth"),
        ("loaded_mesh", "elastic"),
        ("ring_pair", "rigid"),
        ("ring_pair", "elastic"),
        ("planetary", "rigid"),
    ] {
        let (touching, _) = at_start(&mut scene(name, label, false, &[]).unwrap());
        let (left, forces) = at_start(&mut scene(name, label, true, &[]).unwrap());
        println!(
            "{name} {label}: {left:.1e} beside {touching:.1e} of touching flanks, ratio {:.1e}, {forces:?} N",
            left / touching
        );
        assert!(
            left < 1e-6 * touching,
            "{name} {label}: {left:e} beside {touching:e}"
        );
        assert!(forces.iter().all(|f| *f > 0.0));
    }
}

#[test]
fn a_start_without_loads_is_refused() {
    let without = [
        ("torque_nm = 94.1 ", "torque_nm = 0.0 "),
        ("torque_nm = 141.15 ", "torque_nm = 0.0 "),
    ];
    let error = scene("loaded_mesh", "rigid", true, &without).err().unwrap();
    let of_start = matches!(
        *error.subject,
        Subject::Mesh {
            part: MeshPart::Start,
            ..
        }
    );
    assert!(of_start && !error.reason.help.is_empty(), "{error}");
    assert!(error.reason.cause.contains("no load acts"), "{error}");
}

/// Returns the largest unbalanced force relative to the largest load; for a free train without the part that
/// accelerates it as a whole.
fn imbalance(scene: &mut Scene, free: bool) -> f64 {
    let s = scene.initial();
    let n = s.q.len();
    let (mut f, mut q, mut v) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    scene.force(s.at(), &mut f);
    scene.add_centrifugal(s.at(), &mut f);
    let mut momentum = vec![0.0; n];
    scene.apply_mass(s.at(), &s.v, &mut momentum);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let energy = dot(&s.v, &momentum);
    let along = if free && energy > 0.0 {
        dot(&s.v, &f) / energy
    } else {
        0.0
    };
    (f.iter_mut().zip(&momentum)).for_each(|(f, p)| *f -= along * p);
    scene.scales(&mut q, &mut v);
    let load = scene
        .gears()
        .iter()
        .filter(|g| !g.range().is_empty())
        .map(|g| {
            let i = g.range().start;
            (g.load(0.0, s.v[i]) * q[i]).abs()
        });
    let load = load.fold(0.0, f64::max);
    f.iter()
        .zip(&q)
        .map(|(f, q)| (f * q).abs())
        .fold(0.0, f64::max)
        / load
}

/// Duration [s] in which a train that started in equilibrium keeps its forces, since teeth pass by little.
const SHORT: f64 = 2e-5;

/// Returns the largest change of the force of a mesh after a short run, relative to the largest force.
fn force_change(scene: &mut Scene) -> f64 {
    let forces = |scene: &mut Scene, s: &State| {
        let mut sums = vec![0.0; scene.meshes().len()];
        for c in scene.contact_forces(s.at()) {
            sums[c.mesh] += c.normal_force;
        }
        sums
    };
    let mut s = scene.initial();
    let before = forces(scene, &s);
    if s.q.is_empty() {
        return 0.0;
    }
    let plan = TimePlan::new(SHORT, Resolution::Step(1e-7));
    let mut method = method("velocity-verlet").unwrap();
    method
        .run(scene, &mut s, &plan, &mut NullSink, &mut Work::default())
        .unwrap();
    let after = forces(scene, &s);
    let largest = before.iter().fold(0.0, |m: f64, f| m.max(*f));
    let changes = before.iter().zip(&after).map(|(a, b)| (b - a).abs());
    changes.fold(0.0, f64::max) / largest
}

/// Supports of a pinion and a wheel under load.
const MOUNTS: [(&str, &str, &str); 5] = [
    (
        "driven pinion",
        "mount = { driven = { speed_rad_s = 157.08 } }",
        "loads = [{ torque_nm = 86.7 }]",
    ),
    (
        "free",
        "speed_rad_s = 157.08\nloads = [{ torque_nm = 34.984210526315790 }]",
        "speed_rad_s = -63.38315789473684\nloads = [{ torque_nm = 86.7 }]",
    ),
    (
        "fixed wheel",
        "loads = [{ torque_nm = 35.0 }]",
        "mount = \"fixed\"",
    ),
    (
        "bearings",
        "speed_rad_s = 157.08\nloads = [{ torque_nm = 34.984210526315790 }]\nbearing = { stiffness = [2e8, 2e8, 0, 0, 0, 0], damping = [2e3, 2e3, 0, 0, 0, 0] }\ndirections = { z = \"held\", tilt_x = \"held\", tilt_y = \"held\" }",
        "speed_rad_s = -63.38315789473684\nloads = [{ torque_nm = 86.7 }]\nbearing = { stiffness = [4e8, 4e8, 0, 0, 0, 0], damping = [4e3, 4e3, 0, 0, 0, 0] }\ndirections = { z = \"held\", tilt_x = \"held\", tilt_y = \"held\" }",
    ),
    (
        "driven pinion, wheel on a bearing",
        "mount = { driven = { speed_rad_s = 157.08 } }",
        "loads = [{ torque_nm = 86.7 }]\nbearing = { stiffness = [4e8, 4e8, 0, 0, 0, 0], damping = [4e3, 4e3, 0, 0, 0, 0] }\ndirections = { z = \"held\", tilt_x = \"held\", tilt_y = \"held\" }",
    ),
];

const LAWS: [&str; 6] = [
    "law = \"none\"",
    "law = \"kelvin-voigt\", damping_ns_per_m = 500.0",
    "law = \"kelvin-voigt-ratio\", ratio = 0.05",
    "law = \"ratio-at-load\", ratio = 0.05",
    "law = \"hunt-crossley\", e = 0.7",
    "law = \"flores\", e = 0.7",
];

/// Returns the pair of a user scene with a mount and a damping law.
fn user_pair((pinion, wheel): (&str, &str), law: &str) -> SceneFile {
    let text = format!(
        "schema = 1\nname = \"pair\"\nduration_s = 5e-3\n\
         [gears.pinion]\nteeth = 23\nmodule_m = 2.5e-3\nface_width_m = 0.018\nbore_radius_m = 0.0125\nprofile_shift = 0.3\n\
         tip_relief = {{ amount_m = 12e-6, start_radius_m = 0.0305 }}\n{pinion}\n\
         [gears.wheel]\nteeth = 57\nmodule_m = 2.5e-3\nface_width_m = 0.018\nbore_radius_m = 0.02\nprofile_shift = -0.1\n\
         added_inertia_kgm2 = 2e-3\n{wheel}\n\
         [[meshes]]\ngears = [\"pinion\", \"wheel\"]\ncentre_distance_m = 0.1006\nstart = {{ flank = \"left\", loaded = true }}\n\
         [[models]]\nmodel = \"rigid\"\ncontact = {{ stiffness = \"iso6336\", damping = {{ {law} }} }}\n\
         [[models]]\nmodel = \"movable-teeth\"\nparameters = {{ tooth_stiffness_n_per_m = 7.8e8, tooth_mass_kg = 2e-3 }}\n\
         contact = {{ stiffness = \"iso6336\", damping = {{ {law} }} }}\n\
         [[models]]\nmodel = \"elastic\"\nparameters = {{ modes = 10, damping_ratio = 0.02, flank_elements = 6, width_elements = 1 }}\n\
         contact = {{ penalty_pa_per_m = 1e15 }}\n"
    );
    SceneFile::unbuilt(&Context::default(), "pair", &text, Origin::Shipped, true)
        .unwrap_or_else(|e| panic!("{e:?}"))
}

/// All models, mounts and damping laws start in equilibrium.
#[test]
fn every_model_mount_and_damping_law_starts_in_equilibrium() {
    for (mount, pinion, wheel) in MOUNTS {
        for law in LAWS {
            let file = user_pair((pinion, wheel), law);
            // Elastic gears have no law of pairs.
            let labels: &[&str] = if law == LAWS[0] {
                &["rigid", "movable-teeth", "elastic"]
            } else {
                &["rigid", "movable-teeth"]
            };
            for label in labels {
                let choice = file.model(label).unwrap();
                let spec = file.spec_for(choice);
                let made = assemble(
                    &spec,
                    &choice.modelling,
                    gearbench::models::models(),
                    &Patience::ENDLESS,
                );
                let mut scene = made.unwrap_or_else(|e| panic!("{label}, {mount}, {law}: {e}"));
                let left = imbalance(&mut scene, !pinion.contains("driven"));
                println!("{label}, {mount}, {law}: {left:.1e} of the load");
                assert!(left < 1e-6, "{label}, {mount}, {law}: {left:e}");
                let moved = force_change(&mut scene);
                println!("    forces of the meshes change by {moved:.1e} in {SHORT} s");
                let bound = if *label == "elastic" { 5e-2 } else { 5e-3 };
                assert!(moved < bound, "{label}, {mount}, {law}: {moved:e}");
            }
        }
    }
}

/// Planetary sets with rigid and elastic pins: models and damping laws start in equilibrium and keep their forces.
#[test]
fn every_set_on_a_carrier_starts_in_equilibrium() {
    let planet = "bore_radius_m = 0.015\n";
    let elements = (
        "contact = { local = \"half-space\" }",
        "contact = { penalty_pa_per_m = 1e15 }",
    );
    let shared = "damping = { mesh_ratio = 0.02 } #";
    let contact = |label: &str| match label {
        "rigid" => "contact = { stiffness = \"compliance\"",
        _ => "contact = { stiffness = { kind = \"constant\", stiffness_n_per_m2 = 2.68e10 }",
    };
    for (free, pins) in PINS {
        let mass = if pins.is_empty() { "" } else { "mass_kg = 1.0" };
        let with = format!("{planet}{mass}\n{pins}\n");
        for (label, law) in (LAWS.iter().map(|law| ("rigid", *law)))
            .chain(LAWS.iter().map(|law| ("movable-teeth", *law)))
            .chain([("elastic", "")])
        {
            let damped = format!("{}, damping = {{ {law} }}", contact(label));
            let mut changes = vec![(planet, with.as_str()), (shared, "#")];
            if label == "elastic" {
                changes.push(elements);
            } else {
                changes.push((contact(label), damped.as_str()));
            }
            let made = scene("planetary", label, true, &changes);
            let mut scene = made.unwrap_or_else(|e| panic!("{label}, `{free}`, {law}: {e}"));
            let left = imbalance(&mut scene, true);
            let moved = force_change(&mut scene);
            println!(
                "{label}, pins free along `{free}`, {law}: {left:.1e} of the load, {moved:.1e}"
            );
            assert!(left < 1e-5, "{label}, `{free}`, {law}: {left:e}");
            let bound = if label == "elastic" { 5e-2 } else { 5e-3 };
            assert!(moved < bound, "{label}, `{free}`, {law}: {moved:e}");
        }
    }
}

/// Returns the relative error of the contact torque [N m] on the pinion at the start and after each of some steps.
fn torque_errors(scene: &mut Scene, torque: f64, id: &str, h: f64) -> Vec<f64> {
    let mut method = method(id).unwrap();
    let (mut s, mut work) = (scene.initial(), Work::default());
    (1..=40)
        .map(|k| {
            let plan = TimePlan::new(h * f64::from(k), Resolution::Step(h));
            let run = method.resume(scene, &mut s, Change::None, &plan, &mut NullSink, &mut work);
            run.unwrap();
            let forces = scene.contact_forces(s.at());
            let on_hub: f64 = forces.iter().map(|c| c.on_hubs[0]).sum();
            on_hub.abs() / torque - 1.0
        })
        .collect()
}

/// Impulses every microsecond deflect the highest modes less than a steady force does. From static equilibrium the
/// contact torque of elastic gears was 0.24 % less than the load and vibrated; the run starts at the rest position of
/// the method.
#[test]
fn trigonometric_starts_at_rest_under_load() {
    let torque = 50.0;
    let gears = |bearing: &str| {
        format!(
            "schema = 1\nname = \"pair\"\nduration_s = 1e-4\n\
             [gears.pinion]\nteeth = 22\nmodule_m = 3e-3\nface_width_m = 0.012\nbore_radius_m = 0.014\nloads = [{{ torque_nm = {torque:?} }}]\n{bearing}\n\
             [gears.wheel]\nteeth = 33\nmodule_m = 3e-3\nface_width_m = 0.012\nbore_radius_m = 0.02\nmount = \"fixed\"\n\
             [[meshes]]\ngears = [\"pinion\", \"wheel\"]\nbacklash_m = 1e-4\nstart = {{ flank = \"left\", loaded = true }}\n"
        )
    };
    let elastic = |parameters: &str, contact: &str| {
        format!(
            "[[models]]\nmodel = \"elastic\"\nparameters = {{ flank_elements = 6, width_elements = 1, {parameters} }}\ncontact = {{ {contact} }}\n"
        )
    };
    let bearing = "bearing = { stiffness = [2e8, 2e8, 0, 0, 0, 0] }\ndirections = { z = \"held\", tilt_x = \"held\", tilt_y = \"held\" }";
    let half_space = "local = \"half-space\"";
    for (bearing, model) in [
        ("", elastic("modes = 150", half_space)),
        ("", elastic("modes = 40, damping_ratio = 0.05", half_space)),
        (
            "",
            elastic(
                "modes = 20, residual = false, step_s = 1e-6",
                "penalty_pa_per_m = 1e15",
            ),
        ),
        (bearing, elastic("modes = 40", "penalty_pa_per_m = 1e15")),
    ] {
        let text = gears(bearing) + &model;
        let file = SceneFile::unbuilt(&Context::default(), "pair", &text, Origin::Shipped, true)
            .unwrap_or_else(|e| panic!("{e:?}"));
        let choice = file.model("elastic").unwrap();
        let models = gearbench::models::models();
        let mut scene = assemble(
            &file.spec_for(choice),
            &choice.modelling,
            models,
            &Patience::ENDLESS,
        )
        .unwrap();
        let errors = torque_errors(&mut scene, torque, "trigonometric", 1e-6);
        let worst = errors.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
        println!("{model}: contact torque within {worst:.1e} of the load");
        assert!(worst < 1e-5, "{model}: {worst:e}");
    }
}
