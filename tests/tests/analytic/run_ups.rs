//! Run-ups between given speeds: the speeds follow the ramp whatever the loads of the scene are.

use gearbench::context::Context;
use gearbench::experiment::conditions::Conditions;
use gearbench::experiment::configuration::Configuration;
use gearbench::experiment::runner::Runner;
use gearbench::scene_file::{Origin, SceneFile};
use gearbench::studies::run_up::{EvaluationSettings, Plan, Ramp, study};
use gearbench_integrators::table::DOPRI5;

/// Returns a two-stage gearbox between a motor and a machine with a load.
fn gearbox(motor: &str, machine: &str) -> SceneFile {
    let text = format!(
        "schema = 1\nname = \"two_stage\"\nduration_s = 0.02\n\
         gears.p1 = {{ teeth = 19, module_m = 2e-3, face_width_m = 0.02, bore_radius_m = 0.006 }}\n\
         gears.w1 = {{ teeth = 53, module_m = 2e-3, face_width_m = 0.02, bore_radius_m = 0.015 }}\n\
         gears.p2 = {{ teeth = 17, module_m = 3e-3, face_width_m = 0.03, bore_radius_m = 0.008, profile_shift = 0.2 }}\n\
         gears.w2 = {{ teeth = 61, module_m = 3e-3, face_width_m = 0.03, bore_radius_m = 0.03 }}\n\
         shafts = [\n\
         {{ name = \"input\", carries = [{{ body = \"motor\", at_m = 0.0, inertia_kgm2 = 1e-3{motor} }}, {{ gear = \"p1\", at_m = 0.12 }}], sections = [{{ length_m = 0.12, diameter_m = 0.015 }}], damping_ratio = 0.02, speed_rad_s = 150.0 }},\n\
         {{ name = \"mid\", carries = [{{ gear = \"w1\", at_m = 0.0 }}, {{ gear = \"p2\", at_m = 0.06 }}], sections = [{{ length_m = 0.06, diameter_m = 0.025 }}], speed_rad_s = -53.774 }},\n\
         {{ name = \"output\", carries = [{{ gear = \"w2\", at_m = 0.0 }}, {{ body = \"machine\", at_m = 0.2, inertia_kgm2 = 0.05{machine} }}], sections = [{{ length_m = 0.2, diameter_m = 0.03 }}], damping_ratio = 0.02, speed_rad_s = 14.986 }},\n\
         ]\n\
         meshes = [{{ gears = [\"p1\", \"w1\"], backlash_m = 60e-6 }}, {{ gears = [\"p2\", \"w2\"], backlash_m = 60e-6, direction_deg = 90 }}]\n\
         models = [{{ model = \"rigid\", contact = {{ stiffness = \"iso6336\", damping = {{ law = \"ratio-at-load\", ratio = 0.05 }} }} }}]\n"
    );
    SceneFile::unbuilt(
        &Context::default(),
        "two_stage",
        &text,
        Origin::Shipped,
        true,
    )
    .unwrap()
}

/// The drive supplies the torque of the loads: the gearbox reaches the speed of the ramp. The largest measured
/// difference is 0.3 % of the change of speed.
#[test]
fn a_run_up_reaches_its_speeds_whatever_the_loads() {
    let (from, to, over) = (50.0, 400.0, 0.2);
    for (motor, machine) in [
        (12.0, "viscous_nms_per_rad = 8.0"),
        (12.0, "viscous_nms_per_rad = 4.0"),
        (12.0, "torque_nm = -119.88"),
        (0.0, "viscous_nms_per_rad = 8.0"),
        (-5.0, "torque_nm = 20.0"),
    ] {
        let motor = format!(", loads = [{{ torque_nm = {motor:?} }}]");
        let loads = format!(", loads = [{{ {machine} }}]");
        let scene = gearbox(&motor, &loads);
        let ramp = Ramp { from, to, over };
        let plan = Plan {
            conditions: Conditions {
                duration: over,
                repeats: 0,
                samples: 500,
                ..Conditions::of(&scene)
            },
            entries: vec![Configuration::of(&scene, &scene.models[0])],
            method: DOPRI5.at_tolerance(1e-6),
            ramp: Some(ramp),
            look: EvaluationSettings {
                gear: 0,
                multiples: 2,
                turns: None,
                onset: 0.02 * over,
                samples: 1 << 15,
            },
        };
        let results = study(&plan, &Runner::default()).unwrap();
        let found = &results.run_ups()[0];
        assert_eq!(found.message, "", "{motor} {machine}");
        // Windows of a turn: the mean speed of the last one is that of the ramp in its middle.
        let speeds = found.by_turns.speed_rad_s.iter();
        for (speed, t) in speeds.zip(&found.by_turns.time_s) {
            let asked = from + (to - from) * t / over;
            let error = (speed - asked) / (to - from);
            assert!(
                error.abs() < 0.02,
                "{motor} {machine}: {speed} at {t} s, ramp {asked}"
            );
        }
    }
}
