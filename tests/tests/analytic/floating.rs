//! Hubs that are free across or along their axis without a bearing float on their meshes: natural frequencies and loaded states
//! beside closed forms and beside bearings of 1 N/m.

use crate::loaded_start::{scene, shipped};
use gearbench::context::Context;
use gearbench::scene_file::{Origin, SceneFile};
use gearbench::small_signals::{Patience, assemble};
use gearbench::studies::modes::{ModesSettings, vibrations};
use gearbench_integrators::system::SecondOrderSystem;
use gearbench_models::scene::Scene;

/// Returns the first model of a scene, and its natural frequencies without and with rigid motions [Hz].
fn frequencies(file: &SceneFile) -> (usize, Vec<f64>) {
    let choice = file.model("rigid").unwrap();
    let spec = file.spec_for(choice);
    let of = (&spec, &choice.modelling);
    let found = vibrations(
        "rigid",
        of,
        gearbench::models::models(),
        &ModesSettings::default(),
    )
    .unwrap();
    let times = found.modes.iter();
    let all: Vec<f64> = times
        .flat_map(|m| std::iter::repeat_n(m.frequency_hz, m.multiplicity))
        .collect();
    let rigid = all.iter().filter(|f| **f == 0.0).count();
    (rigid, all.into_iter().filter(|f| *f > 0.0).collect())
}

/// The audit's own matrix has 2885.2 (2), 5010.9, 6175.6 (2) and 8115.3 Hz, and one rigid motion, of a set whose sun floats.
#[test]
fn a_floating_sun_swings_on_its_meshes() {
    let bore = "thinning_m = 3e-5 # backlash\nbore_radius_m = 0.012\n";
    let held = "z = \"held\", tilt_x = \"held\", tilt_y = \"held\" }\n";
    let free = format!("{bore}directions = {{ x = \"free\", y = \"free\", {held}");
    let soft =
        format!("{bore}bearing = {{ stiffness = [1, 1, 0, 0, 0, 0] }}\ndirections = {{ {held}");
    let [free, soft] = [free, soft].map(|with| {
        let file = shipped("planetary", false, &[(bore, with.as_str())]);
        frequencies(&file)
    });
    println!("{free:?}\n{soft:?}");
    assert_eq!((free.0, soft.0), (1, 1));
    let own = [2885.2, 2885.2, 5010.9, 6175.6, 6175.6, 8115.3];
    assert_eq!(free.1.len(), own.len());
    for ((free, soft), own) in free.1.iter().zip(&soft.1).zip(own) {
        assert!((free - own).abs() < 0.06, "{free} {own}");
        assert!((free / soft - 1.0).abs() < 1e-6, "{free} {soft}");
    }
}

/// Four planets, the second moved by 2 um along its circle: the sun moves to where opposite planets carry alike. Closed form of
/// the audit: 574.96, 311.85, 574.96, 311.85 N, sun at (-1.766, 0.643) um.
#[test]
fn a_floating_sun_shares_the_load() {
    let text = |sun: &str| {
        let body = "module_m = 0.003\nface_width_m = 0.02\nthinning_m = 3e-5\n";
        let planets: String = (1..=4)
            .map(|k| format!("[gears.p{k}]\nteeth = 30\n{body}bore_radius_m = 0.015\n"))
            .collect();
        let of_sun: String = [0.0, 90.001_414_7, 180.0, 270.0]
            .iter()
            .enumerate()
            .map(|(k, d)| {
                let k = k + 1;
                format!("[[meshes]]\ngears = [\"sun\", \"p{k}\"]\ncentre_distance_m = 0.081\ndirection_deg = {d:?}\n")
            })
            .collect();
        let of_ring: String = (1..=4)
            .map(|k| {
                let start = if k == 1 {
                    "start = { flank = \"right\", gap_m = 0.0, loaded = true }\n"
                } else {
                    ""
                };
                format!("[[meshes]]\ngears = [\"p{k}\", \"ring\"]\n{start}")
            })
            .collect();
        format!(
            "schema = 1\nname = \"four\"\ntitle = \"Four planets\"\nduration_s = 1e-3\n\
             tolerance = {{ metric = \"force_l1\", limit = 0.05, against = \"self\" }}\n\
             [gears.sun]\nteeth = 24\n{body}bore_radius_m = 0.012\nloads = [{{ torque_nm = 60.0 }}]\n{sun}\n{planets}\
             [gears.ring]\ninternal = true\nteeth = 84\n{body}addendum_factor = 0.8\ntip_radius_factor = 0.25\ncutter_teeth = 25\n\
             rim_radius_m = 0.15\nmount = \"fixed\"\nposition_m = [0.0, 0.0]\n\
             [[shafts]]\nname = \"arm\"\ncarries = [{{ body = \"carrier\", at_m = 0.0, inertia_kgm2 = 0.01, planets = [\"p1\", \"p2\", \"p3\", \"p4\"], loads = [{{ torque_nm = -270.0 }}] }}]\n\
             {of_sun}{of_ring}\
             [[models]]\nmodel = \"rigid\"\ncontact = {{ stiffness = {{ kind = \"constant\", stiffness_n_per_m2 = 1.4e10, of = \"mesh\" }} }}\n"
        )
    };
    let held = "z = \"held\", tilt_x = \"held\", tilt_y = \"held\" }";
    let mut found: Vec<[f64; 8]> = Vec::new();
    for sun in [
        format!("directions = {{ x = \"free\", y = \"free\", {held}"),
        format!("bearing = {{ stiffness = [1, 1, 0, 0, 0, 0] }}\ndirections = {{ {held}"),
    ] {
        let file = SceneFile::unbuilt(
            &Context::default(),
            "four",
            &text(&sun),
            Origin::Shipped,
            false,
        )
        .unwrap();
        let choice = file.model("rigid").unwrap();
        let spec = file.spec_for(choice);
        let mut scene = assemble(
            &spec,
            &choice.modelling,
            gearbench::models::models(),
            &Patience::ENDLESS,
        )
        .unwrap();
        let s = scene.initial();
        let mut forces = [0.0; 8];
        for c in scene.contact_forces(s.at()) {
            forces[c.mesh] += c.normal_force;
        }
        let first = scene.gears()[0].range().start;
        let sun = [s.q[first + 1], s.q[first + 2]].map(|x| 1e6 * x);
        println!("{forces:?} N, sun at {sun:?} um");
        // The closed form is linear: that of opposite planets is their mean.
        for (k, is) in [(0, 574.96), (1, 311.85)] {
            let mean = 0.5 * (forces[k] + forces[k + 2]);
            assert!((mean / is - 1.0).abs() < 3e-5, "{mean} {is}");
            assert!((forces[k] / is - 1.0).abs() < 2e-4, "{forces:?} {is}");
        }
        found.push(forces);
        for (found, is) in sun.into_iter().zip([-1.766, 0.643]) {
            assert!((found - is).abs() < 1e-3, "{found} {is}");
        }
    }
    for (free, soft) in found[0].iter().zip(&found[1]) {
        assert!((free / soft - 1.0).abs() < 1e-6, "{found:?}");
    }
}

/// A double-helical pinion floats along z on both its halves: `w^2 = 2 k sin^2(beta_b) / m`, 747.8564 Hz.
#[test]
fn a_double_helical_pinion_swings_along_its_axis() {
    let text = |along: &str| {
        let half = |name: &str, teeth: u32, helix: f64, more: &str| {
            format!(
                "[gears.{name}]\nteeth = {teeth}\nmodule_m = 0.003\nface_width_m = 0.02\nhelix_angle_deg = {helix:?}\n{more}\n"
            )
        };
        let pinion = format!(
            "bore_radius_m = 0.01\nmass_kg = 2.0\n{along}\nloads = [{{ torque_nm = 30.0 }}]"
        );
        let wheel = "bore_radius_m = 0.02\nmount = \"fixed\"";
        let mut text = String::from(
            "schema = 1\nname = \"double\"\ntitle = \"Double helical\"\nduration_s = 1e-3\n\
             tolerance = { metric = \"force_l1\", limit = 0.05, against = \"self\" }\n",
        );
        text += &half(
            "upper",
            23,
            25.0,
            &format!("{pinion}\nposition_m = [0.0, 0.0, 0.05]"),
        );
        text += &half("lower", 23, -25.0, &pinion);
        text += &half("upper_wheel", 40, -25.0, wheel);
        text += &half("lower_wheel", 40, 25.0, wheel);
        text += "[[shafts]]\nname = \"pinion\"\ncarries = [{ gear = \"lower\", at_m = 0.0 }, { gear = \"upper\", at_m = 0.05 }]\n";
        for half in ["upper", "lower"] {
            text += &format!(
                "[[meshes]]\ngears = [\"{half}\", \"{half}_wheel\"]\nbacklash_m = 1e-4\nstart = {{ flank = \"left\" }}\n"
            );
        }
        text += "[[models]]\nmodel = \"rigid\"\ncontact = { stiffness = { kind = \"constant\", stiffness_n_per_m2 = 1.4e10, of = \"mesh\" }, slices = 1 }\n";
        text
    };
    let held = "x = \"held\", y = \"held\", tilt_x = \"held\", tilt_y = \"held\" }";
    for along in [
        format!("directions = {{ z = \"free\", {held}"),
        format!("bearing = {{ stiffness = [0, 0, 1, 0, 0, 0] }}\ndirections = {{ {held}"),
    ] {
        let file = SceneFile::unbuilt(
            &Context::default(),
            "double",
            &text(&along),
            Origin::Shipped,
            false,
        )
        .unwrap_or_else(|e| panic!("{e:?}"));
        let (rigid, found) = frequencies(&file);
        println!("{along}: {rigid} rigid, {found:?} Hz");
        assert_eq!(rigid, 0);
        let nearest = found
            .iter()
            .map(|f| (f - 747.8564).abs())
            .fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-3, "{found:?}");
    }
}

/// Under light loads at speed a set on pins has an equilibrium, with the centrifugal forces of its planets: they are where a run
/// keeps them, `m w^2 r / k` further out.
#[test]
fn centrifugal_forces_are_part_of_the_loaded_start() {
    let planet = "bore_radius_m = 0.015\n";
    let pins = "bore_radius_m = 0.015\nmass_kg = 1.3\nbearing = { stiffness = [1e8, 1e8, 0, 0, 0, 0], damping = [2e3, 2e3, 0, 0, 0, 0] }\ndirections = { z = \"held\", tilt_x = \"held\", tilt_y = \"held\" }\n";
    let speed: f64 = 100.0;
    for torque in [60.0_f64, 1.0, 0.1] {
        let (on_sun, on_carrier) = (
            format!("torque_nm = {torque:?} "),
            format!("torque_nm = {:?} ", -4.5 * torque),
        );
        let changes = [
            (planet, pins),
            ("speed_rad_s = 100.0", "speed_rad_s = 450.0"),
            ("speed_rad_s = 22.222222222222222", "speed_rad_s = 100.0"),
            ("torque_nm = 60.0 ", on_sun.as_str()),
            ("torque_nm = -270.0 ", on_carrier.as_str()),
        ];
        let scene: Scene = scene("planetary", "rigid", true, &changes).unwrap();
        let s = scene.initial();
        let first = scene.gears()[1].range().start;
        let outward = s.q[first + 1];
        // Tangential forces of sun and ring press the pin, radial ones of both cancel but for their pressure angles.
        let exact = 1.3 * speed * speed * 0.081 / (1e8 - 1.3 * speed * speed);
        let sum: f64 = (1..4)
            .map(|k| {
                let g = &scene.gears()[k];
                let hub = &g.model.hub().hub;
                let place = hub.centre.xy().normalize();
                let at = g.range().start;
                place.x * s.q[at + 1] + place.y * s.q[at + 2]
            })
            .sum::<f64>()
            / 3.0;
        println!(
            "{torque} N m: {outward:.6e} m outward, {sum:.6e} on average, {exact:.6e} by centrifugal force alone"
        );
        let n = scene.layout().n;
        assert!(n > 6);
        let by_torque = 2e-3 * torque / 60.0;
        assert!(
            (sum / exact - 1.0).abs() < 0.02 + by_torque * 50.0,
            "{torque}: {sum:e} {exact:e}"
        );
        let turn = s.v[scene.gears()[0].range().start];
        assert!((turn / 450.0 - 1.0).abs() < 1e-6, "{turn}");
    }
}
