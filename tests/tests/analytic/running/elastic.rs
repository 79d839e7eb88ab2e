//! Reduced elastic gears, those of the scene `loaded_mesh`. The whole proofs take minutes:
//! `cargo test --release -p gearbench-tests --test analytic -- running::elastic --include-ignored --nocapture`.

use super::*;
use gearbench::context::Context;
use gearbench::scene_file::{self, Selection};
use gearbench_integrators::Report;

/// Returns the scene and its elastic gears, undamped except for their modes.
fn loaded_mesh(modal: f64) -> (SceneSpec, Modelling) {
    let file = scene_file::load_for(
        &Context::default(),
        "loaded_mesh",
        Selection::Labels(Some("elastic")),
    )
    .unwrap();
    let mut modelling = file.model("elastic").unwrap().modelling.clone();
    for gear in &mut modelling.gears {
        gear.unset("rayleigh").unwrap();
        gear.set("damping_ratio", modal).unwrap();
    }
    for contact in &mut modelling.contacts {
        contact.damping = Damping::None;
    }
    (file.spec, modelling)
}

fn built(spec: &SceneSpec, modelling: &Modelling) -> Scene {
    Scene::build(spec, modelling, gearbench::models::models()).unwrap()
}

/// Returns the unexplained energy relative to the energy through the contact, by steps.
fn unexplained(t_end: f64, steps: &[f64]) -> Vec<f64> {
    let (spec, modelling) = loaded_mesh(0.0);
    let mut scene = built(&spec, &modelling);
    let found = steps.iter().map(|h| {
        let step = Resolution::Step(*h);
        let (_, ledger, watch) =
            observe(&spec, &mut scene, "trigonometric", step, t_end, 0.0);
        let found = ledger.residual().abs() / watch.power;
        println!(
            "{t_end} s at {h:.2e} s: {:.3e} J of {:.3e} J, {found:.2e}; dissipated {:.1e} J, loads {:.3e} J",
            ledger.residual(),
            watch.power,
            ledger.dissipated,
            ledger.external
        );
        found
    });
    found.collect()
}

#[test]
fn elastic_gears_keep_their_energy_under_load() {
    let found = unexplained(0.01, &[1e-6, 0.5e-6, 0.25e-6]);
    assert!(found[0] < 1e-3 && found[2] < 1e-4, "{found:?}");
}

#[test]
#[ignore = "minutes: the same over a quarter of a second"]
fn elastic_gears_keep_their_energy_for_long() {
    let found = unexplained(0.25, &[1e-6, 0.5e-6, 0.25e-6]);
    assert!(found[0] < 1e-3 && found[2] < 1e-4, "{found:?}");
}

/// Observers at one state share its contacts, whatever was evaluated, fixed or prepared in between.
#[test]
fn reports_are_those_of_their_state() {
    let (spec, modelling) = loaded_mesh(0.0);
    let mut scene = built(&spec, &modelling);
    let (mut a, mut out) = (scene.initial(), [(); 4].map(|()| Outputs::default()));
    a.q[0] += 2e-5 / effective_radius(&spec.gears[0].body);
    let mut b = a.clone();
    b.q[0] += 1e-6;
    let mut force = vec![0.0; a.q.len()];
    scene.sample(a.at(), &mut out[0]);
    scene.output(a.at(), &mut out[1]);
    scene.force(b.at(), &mut force);
    scene.output(a.at(), &mut out[2]);
    scene.output(b.at(), &mut out[3]);
    assert!(out[0].channels[0] > 1000.0);
    assert_eq!(out[0].channels, out[1].channels);
    assert_eq!(out[1], out[2]);
    assert_ne!(out[2].channels, out[3].channels);
    // The same coordinates with another residual compliance.
    let lag = vec![1e-14; force.len()];
    scene.modal().unwrap().prepare(&lag);
    scene.output(b.at(), &mut out[0]);
    assert_ne!(out[0].channels, out[3].channels);
}

/// Returns the relative differences of peak force and peak-to-peak transmission error of running at mesh frequencies
/// [Hz] from those of statics.
///
/// The vibration of the gears against each other has a ratio of 5 % to critical damping, by torques at the hubs in
/// proportion to inertia and speed; the loads bring what these take at the mean speed. Dashpots at flanks could not do
/// it: the contact gives by a hundredth of what the bodies give.
fn over_statics(frequencies: &[f64]) -> Vec<[f64; 2]> {
    let (spec, modelling) = loaded_mesh(0.05);
    let models = gearbench::models::models();
    let mut pair = LoadedPair::new(&spec, &modelling, models).unwrap();
    let radii = [0, 1].map(|i| effective_radius(&spec.gears[i].body));
    let force = 94.1 / radii[0];
    let cycle = MeshCycle::solve(&mut pair, StaticLoad::Force(force), 480, |_| {}).unwrap();
    let tangent = cycle.mesh_tangent() * cycle.face_width;
    let scene = built(&spec, &modelling);
    let inertia = [0, 1].map(|i| scene.gears()[i].model.hub().hub.inertia);
    let compliance: f64 = (0..2).map(|i| radii[i] * radii[i] / inertia[i]).sum();
    let damper = 2.0 * 0.05 * (tangent * compliance).sqrt();
    println!("static: {:.4} um peak to peak", 1e6 * cycle.peak_to_peak());
    let found = frequencies.iter().map(|hertz| {
        let mut spec = spec.clone();
        let speed = std::f64::consts::TAU * hertz / 16.0;
        for (i, (g, speed)) in spec.gears.iter_mut().zip([speed, -speed / 1.5]).enumerate() {
            g.speed = speed;
            let taken = damper * inertia[i];
            let held = Profile::Constant(force * radii[i] + taken * speed);
            g.loads = vec![Load::Applied(held), Load::Viscous(taken)];
        }
        let mut scene = built(&spec, &modelling);
        let settled = 0.25 / hertz;
        let t_end = settled + 1.0 / hertz;
        let step = Resolution::Step(5e-7);
        let (_, _, watch) = observe(&spec, &mut scene, "trigonometric", step, t_end, settled);
        let [low, high] = watch.error.unwrap();
        let off = [
            watch.peak / force - 1.0,
            (high - low) / cycle.peak_to_peak() - 1.0,
        ];
        println!(
            "elastic {hertz} Hz: peak {:.4}, TE {:.4}",
            1.0 + off[0],
            1.0 + off[1]
        );
        off
    });
    found.collect()
}

#[test]
fn slow_running_of_elastic_gears_tends_to_statics() {
    let found = over_statics(&[180.0, 60.0, 20.0]);
    let worst: Vec<f64> = found.iter().map(|x| x[0].abs().max(x[1].abs())).collect();
    assert!(worst[1] < worst[0] && worst[2] < worst[1], "{found:?}");
    // Two per cent are left where the edge of a tip comes in and the slope of the static error jumps, as with rigid gears.
    assert!(worst[2] < 0.025, "{found:?}");
}
