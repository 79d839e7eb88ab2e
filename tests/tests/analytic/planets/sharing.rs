//! Phases of the meshes of planetary sets, and how planets share the load, beside closed forms.
//!
//! Relations between phases: R. G. Parker, J. Lin, *Mesh phasing relationships in planetary and epicyclic gears*, J. Mech. Design
//! 126 (2004) 365. A planet at the angle `psi_n` from the first meshes with the sun by `z_s psi_n / 2 pi` of a base pitch before
//! it, with the ring by `z_r psi_n / 2 pi`, both but for whole pitches. The sets are those of Shweiki et al. (ISMA 2016, paper 785):
//! 21/39/99 teeth with planets at whole numbers of 120ths of a turn.

use gearbench::context::Context;
use gearbench::scene_file::{Origin, SceneFile};
use gearbench::small_signals::{Patience, loaded};
use gearbench_models::scene::{ContactForce, Scene};
use std::f64::consts::TAU;
use std::fmt::Write as _;

const MODULE: f64 = 0.003;
const WIDTH: f64 = 0.02;
/// Stiffness of a pair of teeth, per width [N/m^2].
const STIFFNESS: f64 = 2e10;
const PRESSURE_ANGLE: f64 = 20.0;

/// Returns a set from numbers of teeth of sun, planets and ring, directions of the planets [deg], and the torque on
/// the sun [N m].
fn set([sun, planet, ring]: [u32; 3], directions: &[f64], torque: f64) -> Scene {
    let distance = 0.5 * MODULE * f64::from(sun + planet);
    // The torque on the carrier that balances that on the sun.
    let on_carrier = -torque * f64::from(sun + ring) / f64::from(sun);
    let mut text = String::from(
        "schema = 1\nname = \"set\"\ntitle = \"A set\"\nduration_s = 1e-3\n\
         tolerance = { metric = \"force_l1\", limit = 0.05, against = \"self\" }\n",
    );
    let body = format!("module_m = {MODULE:?}\nface_width_m = {WIDTH:?}\nthinning_m = 3e-5\n");
    let _ = write!(
        text,
        "[gears.sun]\nteeth = {sun}\n{body}bore_radius_m = 0.01\nloads = [{{ torque_nm = {torque:?} }}]\n"
    );
    for k in 0..directions.len() {
        let _ = write!(
            text,
            "[gears.p{k}]\nteeth = {planet}\n{body}bore_radius_m = 0.015\n"
        );
    }
    let rim = 0.5 * MODULE * f64::from(ring) + 0.02;
    let _ = write!(
        text,
        "[gears.ring]\ninternal = true\nteeth = {ring}\n{body}addendum_factor = 0.8\ntip_radius_factor = 0.25\n\
         cutter_teeth = 25\nrim_radius_m = {rim:?}\nmount = \"fixed\"\nposition_m = [0.0, 0.0]\n"
    );
    let names: Vec<String> = (0..directions.len()).map(|k| format!("\"p{k}\"")).collect();
    let _ = write!(
        text,
        "[[shafts]]\nname = \"arm\"\ncarries = [{{ body = \"carrier\", at_m = 0.0, inertia_kgm2 = 0.01, planets = [{}], loads = [{{ torque_nm = {on_carrier:?} }}] }}]\n",
        names.join(", ")
    );
    for (k, direction) in directions.iter().enumerate() {
        let _ = write!(
            text,
            "[[meshes]]\ngears = [\"sun\", \"p{k}\"]\ncentre_distance_m = {distance:?}\ndirection_deg = {direction:?}\n"
        );
    }
    for k in 0..directions.len() {
        let start = if k == 0 {
            "start = { flank = \"right\", gap_m = 0.0 }\n"
        } else {
            ""
        };
        let _ = write!(text, "[[meshes]]\ngears = [\"p{k}\", \"ring\"]\n{start}");
    }
    let _ = write!(
        text,
        "[[models]]\nmodel = \"rigid\"\ncontact = {{ stiffness = {{ kind = \"constant\", stiffness_n_per_m2 = {STIFFNESS:?} }} }}\n"
    );
    let file = SceneFile::unbuilt(&Context::default(), "set", &text, Origin::Shipped, false)
        .unwrap_or_else(|e| panic!("{e:?}"));
    let choice = file.model("rigid").unwrap();
    let spec = file.spec_for(choice);
    Scene::build(&spec, &choice.modelling, gearbench::models::models()).unwrap()
}

/// Returns the contacts of a set in static equilibrium.
fn contacts(scene: &mut Scene) -> Vec<ContactForce> {
    let found = loaded(scene, true, &Patience::ENDLESS).unwrap_or_else(|e| panic!("{e}"));
    scene.contact_forces(found.state.at()).to_vec()
}

/// Returns the position of a contact on its line of action, in base pitches from the pitch point, for a mesh in a
/// direction [deg] with the pitch point at a distance from the centre [m].
fn phase(contact: &ContactForce, direction: f64, pitch_radius: f64) -> f64 {
    let axis = direction.to_radians();
    let away = [
        contact.x.x - pitch_radius * axis.cos(),
        contact.x.y - pitch_radius * axis.sin(),
    ];
    let along = (contact.force.x * away[0] + contact.force.y * away[1]) / contact.normal_force;
    along / (TAU / 2.0 * MODULE * PRESSURE_ANGLE.to_radians().cos())
}

/// Returns the distance from the nearest whole number.
fn part(x: f64) -> f64 {
    x - x.round()
}

#[test]
fn planets_mesh_in_the_phases_that_their_places_give() {
    let (sun, planet, ring) = (21, 39, 99);
    for places in [[0, 40, 80], [0, 42, 84]] {
        let directions = places.map(|p| 360.0 * f64::from(p) / f64::from(sun + ring));
        let contacts = contacts(&mut set([sun, planet, ring], &directions, 0.1));
        for (of_ring, radius, teeth) in [
            (0, 0.5 * MODULE * f64::from(sun), sun),
            (3, 0.5 * MODULE * f64::from(ring), ring),
        ] {
            let found: Vec<f64> = (0..3)
                .map(|k| {
                    let contact = contacts.iter().find(|c| c.mesh == of_ring + k).unwrap();
                    phase(contact, directions[k], radius)
                })
                .collect();
            for k in 1..3 {
                let wanted = f64::from(teeth) * directions[k] / 360.0;
                let differs = [found[k] - found[0] - wanted, found[k] - found[0] + wanted]
                    .map(part)
                    .map(f64::abs);
                let least = differs[0].min(differs[1]);
                println!(
                    "{places:?}, {teeth} teeth: planet {k} at {:.5} of a pitch from the first, theory {:.5} or {:.5}: {least:.1e}",
                    (found[k] - found[0]).rem_euclid(1.0),
                    wanted.rem_euclid(1.0),
                    (-wanted).rem_euclid(1.0)
                );
                assert!(least < 2e-5, "{places:?} {teeth} {k}: {least}");
            }
        }
    }
}

/// With `U` the way of the sun along its line of action, a planet whose pin is off by `e` along its circle is pressed by
/// `N = K (U - 2 e cos alpha)`, `1/K = 1/k_s + 1/k_r`: `N - mean N = 2 K cos alpha (mean e - e)`.
#[test]
fn a_pin_error_shifts_the_shares_of_the_planets_as_the_closed_form_says() {
    let (sun, planet, ring) = (24, 30, 84);
    let (torque, radius) = (60.0, 0.5 * MODULE * f64::from(sun + planet));
    for error in [0.0, 1e-6, -1e-6] {
        let directions = [0.0, 120.0 + (error / radius).to_degrees(), 240.0];
        let contacts = contacts(&mut set([sun, planet, ring], &directions, torque));
        let forces: Vec<f64> = (0..6)
            .map(|m| {
                contacts
                    .iter()
                    .filter(|c| c.mesh == m)
                    .map(|c| c.normal_force)
                    .sum()
            })
            .collect();
        let pairs = |m: usize| contacts.iter().filter(|c| c.mesh == m).count() as f64;
        let cos = PRESSURE_ANGLE.to_radians().cos();
        let mean = torque / (3.0 * 0.5 * MODULE * f64::from(sun) * cos);
        let per_pair = STIFFNESS * WIDTH;
        for k in 0..3 {
            assert_eq!((pairs(k), pairs(3 + k)), (pairs(0), pairs(3)));
            assert!((forces[k] / forces[3 + k] - 1.0).abs() < 1e-7, "{forces:?}");
            let stiffness = per_pair / (1.0 / pairs(k) + 1.0 / pairs(3 + k));
            let own = if k == 1 { error } else { 0.0 };
            let shift = 2.0 * stiffness * cos * (error / 3.0 - own);
            let largest = 2.0 * stiffness * cos * error.abs();
            println!(
                "error {error:.0e} m, planet {k}: {:.4} N, shifted by {:.4}, closed form {shift:.4}, which differs by {:.1e} of the largest shift",
                forces[k],
                forces[k] - mean,
                (forces[k] - mean - shift).abs() / largest
            );
            assert!(
                (forces[k] - mean - shift).abs() < 1e-3 * largest + 1e-6 * mean,
                "{error} {k}: {forces:?}"
            );
        }
    }
}
