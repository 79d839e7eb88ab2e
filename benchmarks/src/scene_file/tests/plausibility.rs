//! Implausible values cause a warning with their line and the unit that is probably meant; plausible ones cause none.

use super::super::SHIPPED;
use super::{changed, parse, read, render};
use crate::context::Context;
use crate::models::models;
use gearbench_models::scene::Scene;

/// Returns the warnings on the base scene with one piece of text replaced. Its wheel starts at rest under a load on the
/// pinion, which is the subject of the tests of `motion`.
fn said(from: &str, to: &str) -> Vec<String> {
    let all = read(from, to).odd;
    let all = all.iter().map(|odd| odd.to_text());
    all.filter(|odd| !odd.contains("the kinematics of the train give"))
        .collect()
}

#[test]
fn odd_values_are_said_with_the_unit_that_is_meant() {
    let material =
        "teeth = 20\nmaterial = { young_pa = 210e9, poisson = 0.3, density_kg_m3 = 30000 }";
    let friction = "{ stiffness = \"iso6336\", friction = { mu = 50, v_ref_m_s = 0.01 }, \
                    damping = { law = \"kelvin-voigt-ratio\", ratio = 100.0 } }";
    let cases = [
        (
            ("duration_s = 1e-4", "duration_s = 1e9"),
            vec!["test.toml:4: `duration_s` = 1e9 s is far"],
        ),
        (
            ("teeth = 20", material),
            vec![
                "`density_kg_m3` = 30000 kg/m^3 is far outside the typical range of gears; typical values are 1e2 to 2.5e4 kg/m^3",
            ],
        ),
        (
            ("{ stiffness = \"iso6336\" }", friction),
            vec![
                "test.toml:32: `mu` = 50 is far outside the typical range of gears; if 50 is in per cent, write mu = 0.5",
                "`ratio` = 100 is far",
            ],
        ),
        (
            ("speed_rad_s = 20.0", "speed_rad_s = 2e4"),
            vec!["test.toml:12: the teeth of `pinion` move at 880 m/s"],
        ),
        (
            ("torque_nm = 10.0", "torque_nm = 5000.0"),
            vec![
                "test.toml:13: the load causes 133000 N on the teeth of `pinion`, 0.0158 of its Young's modulus",
            ],
        ),
        (("torque_nm = 10.0", "torque_nm = 11.0"), vec![]),
        (
            ("tolerance = 0.05", "tolerance = 5"),
            vec![
                "test.toml:6: `tolerance` = 5 permits an error of 500 %; if 5 is in per cent, write tolerance = 0.05",
            ],
        ),
        (
            (
                "tolerance = 0.05",
                "tolerance = { metric = \"peak_force_n\", limit = 5 }",
            ),
            vec![],
        ),
        (
            (
                "tolerance = 0.05",
                "tolerance = { limit = 5, against = \"self\" }",
            ),
            vec![
                "test.toml:6: `limit` = 5 permits an error of 500 %; if 5 is in per cent, write limit = 0.05",
            ],
        ),
        (
            (
                "face_width_m = 0.01\nspeed",
                "face_width_m = 0.01\ninertia_kgm2 = 1e2\nspeed",
            ),
            vec!["`inertia_kgm2` = "],
        ),
    ];
    for ((from, to), expected) in cases {
        let found = said(from, to);
        assert_eq!(found.len(), expected.len(), "{to}: {found:#?}");
        for (found, expected) in found.iter().zip(expected) {
            assert!(found.contains(expected), "{found}\n{expected}");
        }
    }
}

/// A scene in millimetres has gears of 80 metres; the warnings say so.
#[test]
fn millimetres_are_said() {
    let metres = changed("duration_s = 1e-4", "duration_s = 1e-4");
    let text = (metres.replace("module_m = 0.004", "module_m = 4"))
        .replace("centre_distance_m = 0.1001", "centre_distance_m = 100.1");
    let odd = parse(&text).unwrap().odd;
    let told: Vec<String> = odd.iter().map(|odd| odd.to_text()).collect();
    for line in [10, 17] {
        let expected = format!(
            "test.toml:{line}: `module_m` = 4 m is far outside the typical range of gears; if 4 is in millimetres, write module_m = 0.004"
        );
        assert!(told.contains(&expected), "{told:#?}");
    }
}

#[test]
fn nothing_of_the_shipped_scenes_is_odd() {
    for s in SHIPPED {
        let scene = crate::scene_file::load_unbuilt(&Context::default(), s.name).unwrap();
        assert!(scene.odd.is_empty(), "{:?}", scene.odd);
    }
}

/// Direction of a rack according to the page on the format: this rack is to the right of its gear, whose rim moves
/// upwards there.
#[test]
fn a_rack_moves_as_the_rim_of_a_counter_clockwise_gear() {
    let rack = "kind = \"rack\"\nteeth = 30";
    let text = changed("teeth = 30", rack).replace("mount = \"revolute\"", "speed_m_s = 0.1");
    let text = text.replace("centre_distance_m = 0.1001", "backlash_m = 1e-4");
    let scene = parse(&text).unwrap_or_else(|e| panic!("{}", render(&e)));
    let spec = scene.spec_for(&scene.models[0]);
    let built = Scene::build(&spec, &scene.models[0].modelling, models()).unwrap();
    let slide = built.gears()[1].model.hub().hub.slide.unwrap();
    assert!(spec.gears[1].position[0] > 0.0);
    assert!((slide.y - 1.0).abs() < 1e-12, "{slide}");
}
