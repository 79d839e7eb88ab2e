//! Mesh frequency, resonance and transmission error of one pair by `sweep`, `stiffness`, `modes`, `response` and runs agree, whatever
//! the helix angle: all are of the transverse plane.
#![allow(clippy::print_stdout, reason = "observed figures")]

use super::response::{FrequencyGrid, response};
use super::sweep::{self, mesh_resonance};
use crate::context::Context;
use crate::experiment::conditions::Conditions;
use crate::experiment::configuration::Configuration;
use crate::experiment::linear_models::mesh_modes;
use crate::experiment::run::run;
use crate::experiment::runner::Runner;
use crate::models::models;
use crate::scene_file::{Origin, SHIPPED, SceneFile};
use crate::studies::modes::{self, vibrations};
use gearbench_integrators::Scheme;
use gearbench_integrators::table::{DOPRI5, TRIGONOMETRIC};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{Body, Load, Mount, Profile, base_radius};
use gearbench_reference::statics::{Load as StaticLoad, LoadedPair, MeshCycle};
use gearbench_reports::record::{MeshMode, Run, Steady};
use gearbench_reports::response::GroupResponse;
use gearbench_reports::series::TRANSMISSION_ERROR;
use gearbench_reports::sweep::Branch;
use std::f64::consts::TAU;

/// Returns two gears under 100 N m with a constant stiffness per width; the first one has the helix angle `helix_deg`
/// [deg].
fn cylindrical(helix_deg: f64, damping_ratio: f64) -> SceneFile {
    let distance = 0.102 / helix_deg.to_radians().cos() + 1e-4;
    let text = format!(
        r#"
schema = 1
name = "pair"
duration_s = 1e-4
gears.pinion = {{ teeth = 20, module_m = 0.004, face_width_m = 0.03, helix_angle_deg = {helix_deg}, inertia_kgm2 = 1e-3, speed_rad_s = 10.0, loads = [{{ torque_nm = 100.0 }}] }}
gears.wheel = {{ teeth = 31, module_m = 0.004, face_width_m = 0.03, helix_angle_deg = {}, inertia_kgm2 = 3e-3, speed_rad_s = -6.4516129032, loads = [{{ torque_nm = 155.0 }}] }}
meshes = [{{ gears = ["pinion", "wheel"], centre_distance_m = {distance}, start = {{ flank = "left", gap_m = 0.0 }} }}]
[[models]]
model = "rigid"
contact = {{ stiffness = {{ kind = "constant", stiffness_n_per_m2 = 1.4e10 }}, damping = {{ law = "ratio-at-load", ratio = {damping_ratio} }}, slices = 30 }}
"#,
        -helix_deg
    );
    SceneFile::parse(
        &Context::default(),
        "pair.toml",
        &text,
        Origin::Shipped,
        false,
    )
    .unwrap()
}

/// Returns two elastic gears on half-spaces under 33 N m. With fewer modes the stiffness of `response` lacks the
/// rotation of the hubs by truncated modes: 13 % of it with 20 modes.
fn elastic() -> SceneFile {
    let text = r#"
schema = 1
name = "pair"
duration_s = 1e-4
gears.pinion = { teeth = 20, module_m = 0.004, face_width_m = 0.01, bore_radius_m = 0.015, speed_rad_s = 10.0, loads = [{ torque_nm = 33.0 }] }
gears.wheel = { teeth = 31, module_m = 0.004, face_width_m = 0.01, bore_radius_m = 0.025, speed_rad_s = -6.4516129032, loads = [{ torque_nm = 51.15 }] }
meshes = [{ gears = ["pinion", "wheel"], centre_distance_m = 0.1021, start = { flank = "left", gap_m = 0.0 } }]
[[models]]
model = "elastic"
parameters = { modes = 100, damping_ratio = 0.05, flank_elements = 6, width_elements = 1 }
contact = { local = "half-space", damping = { law = "ratio-at-load", ratio = 0.2 } }
"#;
    SceneFile::parse(
        &Context::default(),
        "pair.toml",
        text,
        Origin::Shipped,
        false,
    )
    .unwrap()
}

/// The shipped conical pair on axes that meet, under its loads from the start on.
fn conical() -> SceneFile {
    let shipped = SHIPPED.iter().find(|s| s.name == "beveloid").unwrap();
    let scene = SceneFile::unbuilt(
        &Context::default(),
        "beveloid",
        shipped.text,
        Origin::Shipped,
        true,
    );
    let mut scene = scene.unwrap();
    for g in &mut scene.spec.gears {
        for load in &mut g.loads {
            if let Load::Applied(torque) = load {
                *load = Load::Applied(Profile::Constant(torque.settled()));
            }
        }
    }
    scene
}

fn entry(scene: &SceneFile) -> Configuration {
    Configuration::of(scene, &scene.models[0])
}

/// The method of the runs: elastic gears have one that is exact for modes.
fn method(scene: &SceneFile) -> Scheme {
    match scene.models[0].label.as_str() {
        "elastic" => TRIGONOMETRIC.at_step(1e-6),
        _ => DOPRI5.at_tolerance(1e-6),
    }
}

fn plan(scene: &SceneFile, frequencies: Vec<f64>, cycles: usize, settle: f64) -> sweep::Plan {
    sweep::Plan {
        conditions: Conditions {
            repeats: 0,
            ..Conditions::of(scene)
        },
        entries: vec![entry(scene)],
        standing: Vec::new(),
        method: method(scene),
        frequencies,
        branches: vec![Branch::Fresh],
        cycles,
        settle,
        positions: 12,
    }
}

fn steady(run: &Run) -> &Steady {
    assert!(!run.status.is_failure(), "{:?}", run.message);
    run.steady.as_ref().unwrap()
}

/// Returns the transmission error [m] at the start of a run whose gears are in equilibrium, with the second one fixed.
fn error_at_the_start(scene: &SceneFile) -> f64 {
    let mut own = entry(scene);
    for g in &mut own.scene.gears {
        g.speed = 0.0;
    }
    own.scene.gears[1].mount = Mount::Fixed;
    own.scene.meshes[0].start.loaded = true;
    let conditions = Conditions::of(scene);
    let method = method(scene);
    let job = conditions.job((&own.scene, &own.modelling), &method, &[0.0, 1e-6]);
    let made = run(&crate::experiment::run::Job {
        t_end: 1e-6,
        repeats: 0,
        ..job
    });
    let series = made.unwrap().series.unwrap();
    let (_, error) = series.all_of(TRANSMISSION_ERROR).next().unwrap();
    error[0]
}

/// A mesh cycle at rest under a torque on the first gear.
fn standing_cycle(own: &Configuration, torque: f64) -> MeshCycle {
    let mut pair = LoadedPair::new(&own.scene, &own.modelling, models()).unwrap();
    let load = StaticLoad::Force(torque / base_radius(&own.scene.gears[0].body));
    MeshCycle::solve(&mut pair, load, 12, |_| {}).unwrap()
}

/// The response of the only mesh at two frequencies.
fn responded(own: &Configuration, range: [f64; 2]) -> GroupResponse {
    let wanted = FrequencyGrid {
        range: Some(range),
        points: 2,
        phases: 24,
    };
    let of = (&own.scene, &own.modelling);
    let answered = response(&own.label, of, models(), &wanted, &|_| false).unwrap();
    assert!(answered.message.is_empty(), "{}", answered.message);
    answered.groups[0].clone()
}

/// The lowest natural frequency of a model above a bound [Hz].
fn lowest_above(own: &Configuration, bound: f64) -> f64 {
    let of = (&own.scene, &own.modelling);
    let found = vibrations(&own.label, of, models(), &modes::ModesSettings::default()).unwrap();
    let mode = found.modes.iter().find(|m| m.frequency_hz > bound);
    mode.unwrap().frequency_hz
}

#[test]
fn studies_agree_in_the_transverse_plane() {
    let cylindrical = [0.0, 15.0, 25.0].map(|helix| {
        let name = format!("{helix} degrees");
        (name, cylindrical(helix, 0.2))
    });
    let all = cylindrical
        .into_iter()
        .chain([("conical".to_owned(), conical())]);
    for (name, scene) in all {
        let near = |what: &str, found: f64, expected: f64, within: f64| {
            println!("{name}, {what}: {found:.6e} for {expected:.6e}");
            assert!(
                (found / expected - 1.0).abs() < within,
                "{name}, {what}: {found} for {expected}"
            );
        };
        let own = entry(&scene);
        let gears = &own.scene.gears;
        let radii = [0, 1].map(|i| base_radius(&gears[i].body));
        let torque = gears[0].loads.iter().map(|l| l.greatest(0.0)).sum::<f64>();
        // `stiffness --torque`: force and stiffness of the transverse plane at the pitch point.
        let cycle = standing_cycle(&own, torque);
        let at = cycle.positions.len() / 2;
        let built = Scene::build(&own.scene, &own.modelling, models()).unwrap();
        let yielding: f64 = (0..2)
            .map(|i| radii[i].powi(2) / built.gears()[i].model.hub().hub.inertia)
            .sum();
        let natural = |tangent: f64| (tangent * yielding).sqrt() / TAU;
        let local = natural(cycle.tangent[at]);
        // `compare`: the gears start in the equilibrium.
        let start = error_at_the_start(&scene);
        near(
            "error of a run in equilibrium",
            start,
            cycle.positions[at].approach,
            1e-3,
        );
        // `modes`.
        near("frequency by modes", lowest_above(&own, 0.0), local, 1e-3);
        // `response`.
        let group = &responded(&own, [500.0, 1000.0]);
        let limit = &group.meshes[0];
        near(
            "stiffness by response",
            limit.stiffness_n_per_m,
            cycle.mesh_tangent() * cycle.face_width,
            0.02,
        );
        // `sweep`: at rest, and slowly.
        let still = plan(&scene, Vec::new(), 2, 4e-3);
        let resonance = mesh_resonance(&still, &still.entries[0]).unwrap().unwrap();
        let mean = natural(cycle.mesh_tangent() * cycle.face_width);
        // The mean over other phases: the stiffness of spur gears jumps between them.
        near("resonance by sweep", resonance, mean, 1e-2);
        let by_response = group.resonance_hz.unwrap();
        near("resonance by response", by_response, resonance, 1e-9);
        let slow = plan(&scene, vec![50.0, 100.0], 1, 4e-3);
        let results = sweep::sweep(&slow, &Runner::default()).unwrap();
        let rest = &results.statics()[0];
        near(
            "static error of sweep",
            rest.error_mean_m,
            cycle.mean_error(),
            1e-3,
        );
        let Body::Gear(first) = &gears[0].body else {
            unreachable!("a gear")
        };
        let mean_of_modes: f64 = limit.force_n * first.base_helix_angle().cos();
        near("force by response", mean_of_modes, torque / radii[0], 1e-3);
        for (run, f) in results.runs.iter().zip([50.0, 100.0]) {
            let s = steady(run);
            let by_speed = s.speed_rad_s.abs() * f64::from(first.teeth()) / TAU;
            near("mesh frequency of sweep", s.mesh_frequency_hz, f, 1e-3);
            near("the same by the speed", by_speed, f, 1e-3);
            near(
                "error of slow running",
                s.error_mean_m,
                rest.error_mean_m,
                1.5e-2,
            );
        }
    }
}

/// Elastic gears have one transmission error, one stiffness and one resonance in a run of `compare`, in `stiffness`, `modes`,
/// `response` and `sweep`.
#[test]
fn studies_agree_on_elastic_gears() {
    let scene = elastic();
    let near = |what: &str, found: f64, expected: f64, within: f64| {
        println!("elastic, {what}: {found:.6e} for {expected:.6e}");
        let off = (found / expected - 1.0).abs();
        assert!(off < within, "{what}: {found} for {expected}");
    };
    let own = entry(&scene);
    let cycle = standing_cycle(&own, 33.0);
    let at = cycle.positions.len() / 2;
    let start = error_at_the_start(&scene);
    near(
        "error of a run in equilibrium",
        start,
        cycle.positions[at].approach,
        2e-3,
    );
    let group = &responded(&own, [100.0, 200.0]);
    let still = plan(&scene, Vec::new(), 2, 4e-3);
    let by_sweep = mesh_resonance(&still, &still.entries[0]).unwrap().unwrap();
    let by_response = group.resonance_hz.unwrap();
    near("resonance by response", by_response, by_sweep, 1e-9);
    // The mode at one phase lies within the range over the mesh cycle.
    let range = group.resonance_range_hz.unwrap();
    let mode = lowest_above(&own, 0.5 * range[0]);
    println!("elastic, frequency by modes {mode:.1}, range {range:.1?}");
    assert!((0.99 * range[0]..1.01 * range[1]).contains(&mode));
    let tangent = cycle.mesh_tangent() * cycle.face_width;
    near(
        "stiffness by response",
        group.meshes[0].stiffness_n_per_m,
        tangent,
        0.03,
    );
    let slow = plan(&scene, vec![100.0], 1, 4e-3);
    let results = sweep::sweep(&slow, &Runner::default()).unwrap();
    let rest = &results.statics()[0];
    near(
        "static error of sweep",
        rest.error_mean_m,
        cycle.mean_error(),
        2e-3,
    );
    let slow = steady(&results.runs[0]);
    near(
        "mesh frequency of sweep",
        slow.mesh_frequency_hz,
        100.0,
        1e-3,
    );
    near(
        "error of slow running",
        slow.error_mean_m,
        rest.error_mean_m,
        1.5e-2,
    );
}

/// In elastic gears, the vibration of a contact on its own teeth (89 kHz in this pair) strains the contacts more than
/// the mode in which the hubs close the mesh: the mesh mode is the latter, near that of rigid gears of the same
/// compliance.
#[test]
fn the_mesh_mode_of_elastic_gears_is_that_of_their_hubs() {
    let text = r#"
schema = 1
name = "pair"
duration_s = 1e-4
gears.pinion = { teeth = 23, module_m = 0.003, face_width_m = 0.009536, bore_radius_m = 0.01468, speed_rad_s = 68.07, loads = [{ torque_nm = 16.74 }] }
gears.wheel = { teeth = 21, module_m = 0.003, face_width_m = 0.009536, bore_radius_m = 0.01337, speed_rad_s = -74.55285714, loads = [{ torque_nm = 15.28434783 }] }
meshes = [{ gears = ["pinion", "wheel"], backlash_m = 0.00006854, start = { flank = "left", loaded = true } }]
[[models]]
model = "rigid"
contact = { stiffness = "compliance", damping = { law = "ratio-at-load", ratio = 0.005 } }
[[models]]
model = "elastic"
parameters = { modes = 20, damping_ratio = 0.05, flank_elements = 6, width_elements = 1 }
contact = { local = "half-space", damping = { law = "ratio-at-load", ratio = 0.05 } }
"#;
    let scene = SceneFile::parse(
        &Context::default(),
        "pair.toml",
        text,
        Origin::Shipped,
        false,
    )
    .unwrap();
    let all: Vec<Configuration> = (scene.models.iter())
        .map(|m| Configuration::of(&scene, m))
        .collect();
    let modes = mesh_modes(&all, models(), &Runner::default(), false).unwrap();
    println!("{modes:?}");
    let [rigid, elastic] = &modes[..] else {
        panic!("{modes:?}");
    };
    let of = |m: &MeshMode| [m.frequency_hz.unwrap(), m.resonance_hz.unwrap()];
    for (rigid, elastic) in of(rigid).into_iter().zip(of(elastic)) {
        assert!((elastic / rigid - 1.0).abs() < 0.15, "{modes:?}");
    }
    // Ratios of modes and of the contact hardly damp it.
    assert!(elastic.damping_ratio.unwrap() < 0.01, "{modes:?}");
}

/// The 27 speeds of which ten were windows of too few mesh cycles.
#[test]
fn helical_gears_are_measured_over_whole_cycles_at_all_speeds() {
    let scene = cylindrical(25.0, 0.2);
    let frequencies = (0..27).map(|i| 1500.0 + 250.0 * f64::from(i)).collect();
    let results = sweep::sweep(&plan(&scene, frequencies, 2, 1e-3), &Runner::default()).unwrap();
    for run in &results.runs {
        steady(run);
    }
    assert_eq!(results.runs.len(), 27);
}
