//! Scenes that start in the equilibrium of their loads: nothing but the train as a whole accelerates.

use gearbench::experiment::small_signals::assemble;
use gearbench::scene_file::{Origin, SceneFile, shipped::SHIPPED};
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_models::error::{BuildError, MeshPart, Subject};
use gearbench_models::scene::Scene;

/// A model of a shipped scene with `loaded = true` in its start, and other changes to its text.
fn scene(
    name: &str,
    label: &str,
    loaded: bool,
    changes: &[(&str, &str)],
) -> Result<Scene, BuildError> {
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
    let file = SceneFile::unbuilt(name, &text, Origin::Shipped, true).unwrap();
    let choice = file.model(label).unwrap();
    assemble(
        &file.spec_for(choice),
        &choice.modelling,
        gearbench::models::models(),
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
        ("spur_rotation", "rigid"),
    ] {
        let (touching, _) = at_start(&mut scene(name, label, false, &[]).unwrap());
        let (left, forces) = at_start(&mut scene(name, label, true, &[]).unwrap());
        println!(
            "{name} {label}: {left:.1e} beside {touching:.1e} of touching flanks, {forces:?} N"
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
        ("law = \"ratio-at-load\", ratio = 0.05", "law = \"none\""),
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
