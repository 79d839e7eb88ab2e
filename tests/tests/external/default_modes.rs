//! Error of the default choice of modes in impacts, scene by scene, compared with 1000 eigenmodes at a quarter of the step:
//! what is left is the choice. The stored errors find a default that gets worse.
//!
//! Figures: `cargo test --release -p gearbench-tests --test external default_modes -- --nocapture`.
#![allow(clippy::print_stdout)]

use gearbench::context::Context;
use gearbench::experiment::conditions::Conditions;
use gearbench::experiment::runner::Runner;
use gearbench::scene_file::{Origin, SceneFile};
use gearbench::studies::compare::{Plan, YardstickChoice, compare};
use gearbench_reports::metrics;
use gearbench_reports::record::Run;

/// An impact of two gears.
struct Impact {
    name: &'static str,
    teeth: [u32; 2],
    shifts: [f64; 2],
    helix_deg: f64,
    width_elements: u32,
    centre_distance_m: f64,
    start: &'static str,
    speed: f64,
    contact: &'static str,
    /// Largest error of the force history with 100 default modes, relative L2.
    stored: f64,
}

const POINTS: &str = "penalty_pa_per_m = 1e15";
const HALF_SPACE: &str = "local = \"half-space\"";

/// Centre distance of 20/30 teeth, 4 mm, at a helix angle of 15 degrees, and that of spur gears; with 0.1 mm.
const HELICAL: f64 = 0.103_627_618_041_008;
const SPUR: f64 = 0.1001;

const HELICAL_IMPACT: Impact = Impact {
    name: "helical, 15 degrees",
    teeth: [20, 30],
    shifts: [0.0; 2],
    helix_deg: 15.0,
    width_elements: 6,
    centre_distance_m: HELICAL,
    start: "flank = \"left\", gap_m = 2e-6",
    speed: 20.0,
    contact: POINTS,
    stored: 0.0,
};

fn scene(of: &Impact) -> SceneFile {
    let Impact {
        teeth: [a, b],
        shifts: [xa, xb],
        helix_deg,
        width_elements,
        centre_distance_m,
        start,
        speed,
        contact,
        ..
    } = of;
    let model = |label: &str, parameters: &str, step: f64| {
        format!(
            "[[models]]\nlabel = \"{label}\"\nmodel = \"elastic\"\ncontact = {{ {contact} }}\n\
             parameters = {{ flank_elements = 8, width_elements = {width_elements}, {parameters} }}\n\
             integrators = [{{ method = \"trigonometric\", step_s = {step:e} }}]\n"
        )
    };
    let gear = |name: &str, teeth: &u32, shift: &f64, helix: f64, more: &str| {
        format!(
            "[gears.{name}]\nteeth = {teeth}\nmodule_m = 0.004\nface_width_m = 0.012\ntip_radius_factor = 0.3\n\
             profile_shift = {shift}\nhelix_angle_deg = {helix}\n{more}\n"
        )
    };
    let text = [
        "schema = 1\nname = \"impact\"\ntitle = \"Impact\"\nduration_s = 0.15e-3\n".to_owned(),
        gear("pinion", a, xa, *helix_deg, &format!("bore_radius_m = 0.015\nspeed_rad_s = {speed}")),
        gear("wheel", b, xb, -helix_deg, "bore_radius_m = 0.025"),
        format!(
            "[[meshes]]\ngears = [\"pinion\", \"wheel\"]\ncentre_distance_m = {centre_distance_m}\nstart = {{ {start} }}\n"
        ),
        model("default", "modes = 100", 1e-6),
        model("eigenmodes", "modes = 100, choose = \"flank-compliance\"", 1e-6),
        model(
            "converged",
            "modes = 1000, choose = \"frequency\", max_frequency_hz = 2e6",
            2.5e-7,
        ),
    ]
    .concat();
    SceneFile::unbuilt(&Context::default(), "impact", &text, Origin::Shipped, true)
        .unwrap_or_else(|e| panic!("{e:?}"))
}

fn runs(scene: &SceneFile) -> Vec<Run> {
    let models: Vec<_> = scene.models.iter().collect();
    let plan = Plan {
        conditions: Conditions {
            repeats: 0,
            ..Conditions::of(scene)
        },
        tolerance: None,
        wanted: YardstickChoice::Stored,
        ..Plan::of(scene, &models, &[])
    };
    compare(&plan, &Runner::default()).unwrap().runs
}

#[test]
fn default_modes_of_impacts_are_as_good_as_they_were() {
    let impacts = [
        Impact {
            stored: 1.35e-2,
            ..HELICAL_IMPACT
        },
        Impact {
            name: "helical, right flanks",
            start: "flank = \"right\", gap_m = 2e-6",
            speed: -20.0,
            stored: 1.35e-2,
            ..HELICAL_IMPACT
        },
        Impact {
            name: "helical, away from the pitch point",
            start: "flank = \"left\", gap_m = 2e-6, path_coordinate_m = 0.0118",
            stored: 1.65e-2,
            ..HELICAL_IMPACT
        },
        Impact {
            name: "helical, half-spaces",
            contact: HALF_SPACE,
            stored: 9.8e-3,
            ..HELICAL_IMPACT
        },
        Impact {
            name: "spur, half-spaces",
            helix_deg: 0.0,
            width_elements: 1,
            centre_distance_m: SPUR,
            contact: HALF_SPACE,
            stored: 1.9e-3,
            ..HELICAL_IMPACT
        },
    ];
    for impact in impacts {
        let [default, eigenmodes, converged] = runs(&scene(&impact)).try_into().unwrap();
        let series = converged.series.as_ref().unwrap();
        let error = |run: &Run| {
            let run = run.finished().unwrap();
            metrics::compare(run, series, "converged").force_l2.unwrap()
        };
        let (default, eigenmodes) = (error(&default), error(&eigenmodes));
        println!(
            "{}: 100 default modes {:.2} %, 100 eigenmodes {:.2} %",
            impact.name,
            100.0 * default,
            100.0 * eigenmodes
        );
        assert!(default < impact.stored, "{}: {default:.3e}", impact.name);
        assert!(default < eigenmodes, "{}: {eigenmodes:.3e}", impact.name);
    }
}
