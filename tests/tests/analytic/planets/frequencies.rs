//! Natural frequencies of planetary gears of the literature, from assembled scenes.
//!
//! J. Lin, R. G. Parker, *Analytical characterization of the unique properties of planetary gear free vibration*, J. Vib. Acoust.
//! 121 (1999) 316; C. G. Cooley, R. G. Parker, *Vibration properties of high-speed planetary gears with gyroscopic effects*, J. Vib.
//! Acoust. 134 (2012) 061014; A. Kahraman, *Natural modes of planetary gear trains*, J. Sound Vib. 173 (1994) 125. A body counts by
//! its mass and by its inertia over the square of its radius alone, so that gears of any size have the same frequencies: 26, 34
//! and 94 teeth at 24.6 degrees stand for all of them.

use super::{across, carrier_of};
use crate::shafts::{body, frequencies, shaft};
use gearbench::context::Context;
use gearbench_models::geometry::{Gear, GearParams, Internal};
use gearbench_models::spec::{
    Body, ContactSpec, GearSpec, Load, Mount, Profile, SceneSpec, StationMember, effective_radius,
};
use gearbench_models::stiffness::{PairOrMesh, PairStiffness};
use gearbench_tests::*;
use std::f64::consts::TAU;

/// Data of carrier, ring, sun and planet.
struct Set {
    /// Masses of the bodies [kg].
    mass: [f64; 4],
    /// Inertia over the square of the radius [kg].
    inertia: [f64; 4],
    /// Stiffness of the meshes [N/m].
    mesh: f64,
    /// Radial stiffness of the bearings [N/m].
    bearing: [f64; 4],
    /// Torsional stiffness of the supports over the square of the radius [N/m].
    turn: [f64; 3],
    pressure_angle: f64,
}

const LIN_PARKER: Set = Set {
    mass: [5.43, 2.35, 0.4, 0.66],
    inertia: [6.29, 3.00, 0.39, 0.61],
    mesh: 5e8,
    bearing: [1e8; 4],
    turn: [0.0, 1e9, 0.0],
    pressure_angle: 24.6,
};

const COOLEY_PARKER: Set = Set {
    mass: [12.0, 7.64, 3.0, 1.86],
    inertia: [6.80, 8.09, 1.75, 1.25],
    mesh: 100e6,
    bearing: [50e6, 100e6, 20e6, 10e6],
    turn: [100e6, 100e6, 20e6],
    pressure_angle: 20.0,
};

/// Overlap of the flanks at the start, so that all of them are loaded [m]: small, so that the forces, whose directions
/// rotate with the bodies, have no effect. On fixed lines of action any value is small.
const OVERLAP: f64 = 2e-9;
const OVERLAP_ON_LINES: f64 = 2e-7;

fn toothed(name: &str, params: GearParams, position: [f64; 2]) -> GearSpec {
    GearSpec {
        body: Body::Gear(Gear::new(params.clone()).unwrap()),
        position: [position[0], position[1], 0.0],
        ..gear(name, spur(20), 0.0, 0.0)
    }
}

/// Returns sun, planets and ring without profile shifts, at their nominal distances.
fn gears(planets: usize, pressure_angle: f64) -> (Vec<GearSpec>, f64) {
    let params = |teeth| GearParams {
        pressure_angle: pressure_angle.to_radians(),
        tip_radius: 0.2,
        bore_radius: 0.0,
        ..spur(teeth)
    };
    let distance = 0.5 * 4e-3 * (26.0 + 34.0);
    let mut all = vec![toothed("sun", params(26), [0.0; 2])];
    for k in 0..planets {
        let angle = TAU * k as f64 / planets as f64;
        let place = [distance * angle.cos(), distance * angle.sin()];
        all.push(toothed(&format!("planet-{k}"), params(34), place));
    }
    let ring = GearParams {
        addendum: 0.8,
        internal: Some(Internal::default()),
        ..params(94)
    };
    all.push(toothed("ring", ring, [0.0; 2]));
    (all, distance)
}

fn stiff(mesh: f64, width: f64) -> ContactSpec {
    ContactSpec {
        stiffness: PairStiffness::Constant {
            per_width: mesh / width,
            of: PairOrMesh::Mesh,
        },
        ..contact(1e9)
    }
}

/// Returns the meshes of sun and planets, and of planets and ring.
fn meshes(planets: usize, overlap: f64) -> Vec<gearbench_models::spec::MeshSpec> {
    use gearbench_models::geometry::Side;
    // A planet hands the load on from one of its flanks to the other.
    let at = |gears, side| mesh(gears, start(side, -overlap));
    (1..=planets)
        .flat_map(|p| [at([0, p], Side::Left), at([p, planets + 1], Side::Right)])
        .collect()
}

fn scene_of(set: &Set, planets: usize) -> (SceneSpec, Vec<ContactSpec>) {
    let (mut gears, distance) = gears(planets, set.pressure_angle);
    let [of_carrier, of_ring, of_sun, of_planet] = [0, 1, 2, 3].map(|k| {
        let mut lateral = across(set.bearing[k], 0.0).unwrap();
        lateral.mass = Some(set.mass[k]);
        lateral
    });
    let of = |k: usize, radius: f64| set.inertia[k] * radius * radius;
    let last = gears.len() - 1;
    // Says how large a deflection is: that of the overlap.
    let torque = set.mesh * OVERLAP * effective_radius(&gears[0].body);
    gears[0].loads = vec![Load::Applied(Profile::Constant(torque))];
    for (i, g) in gears.iter_mut().enumerate() {
        let radius = effective_radius(&g.body);
        let (kind, lateral) = match i {
            0 => (2, of_sun.clone()),
            i if i == last => (1, of_ring.clone()),
            _ => (3, of_planet.clone()),
        };
        g.inertia = Some(of(kind, radius));
        let mut lateral = lateral;
        if kind < 3 {
            lateral.bearing.stiffness[5][5] = set.turn[kind] * radius * radius;
        }
        g.lateral = Some(lateral);
    }
    let mut carrier = body(0.0, "carrier", of(0, distance));
    if let StationMember::Body(body) = &mut carrier.carries {
        body.planets = (1..=planets).collect();
        let mut lateral = of_carrier;
        lateral.bearing.stiffness[5][5] = set.turn[0] * distance * distance;
        body.lateral = Some(lateral);
    }
    let width = gears[0].body.face_width();
    let spec = SceneSpec {
        duration: f64::INFINITY,
        gears,
        meshes: meshes(planets, OVERLAP),
        shafts: vec![shaft("arm", vec![carrier], vec![])],
        stages: Vec::new(),
    };
    let contacts = vec![stiff(set.mesh, width); spec.meshes.len()];
    (spec, contacts)
}

fn found(spec: &SceneSpec, contact: &ContactSpec) -> Vec<f64> {
    frequencies(&mut build(spec, &vec![rigid(); spec.gears.len()], contact))
}

/// Checks computed frequencies against printed ones, `times` each, in any order.
fn hold(found: &[f64], printed: &[(&[f64], usize)], within: f64, what: &str) {
    let mut wanted: Vec<f64> = printed
        .iter()
        .flat_map(|(all, times)| all.iter().flat_map(move |f| vec![*f; *times]))
        .collect();
    wanted.sort_by(f64::total_cmp);
    assert_eq!(found.len(), wanted.len(), "{what}: {found:?}");
    let worst = (found.iter().zip(&wanted)).fold(0.0_f64, |m, (f, w)| m.max((f - w).abs()));
    println!("{what}: frequencies within {worst:.3e} of the printed ones");
    for (f, w) in found.iter().zip(&wanted) {
        println!("{what}: {f:.4} for {w}");
        assert!(
            (f - w).abs() <= within,
            "{what}: {f} Hz for {w} Hz in {found:?}"
        );
    }
}

#[test]
fn lin_and_parkers_planetary_gear() {
    // The printed 727.0 and 1091.0 Hz of four planets are 727.27 and 1091.16, 1536.6 Hz is 1536.54: equations of their own say so.
    let planet: &[f64] = &[1808.2, 5963.8, 6981.7];
    let cases: [(usize, &[f64], &[f64]); 3] = [
        (
            3,
            &[0.0, 1475.7, 1930.3, 2658.3, 7462.8, 11775.3],
            &[743.2, 1102.4, 1896.0, 2276.4, 6986.3, 9647.9],
        ),
        (
            4,
            &[0.0, 1536.6, 1970.6, 2625.7, 7773.6, 13071.1],
            &[727.27, 1091.16, 1892.8, 2342.5, 7189.9, 10437.6],
        ),
        (
            5,
            &[0.0, 1567.4, 2006.1, 2614.8, 8065.4, 14253.1],
            &[710.0, 1072.0, 1888.1, 2425.3, 7382.4, 11172.3],
        ),
    ];
    for (n, rotational, translational) in cases {
        let (spec, contacts) = scene_of(&LIN_PARKER, n);
        let found = found(&spec, &contacts[0]);
        let printed = [(rotational, 1), (translational, 2), (planet, n - 3)];
        hold(
            &found,
            &printed,
            0.065,
            &format!("Lin and Parker, {n} planets"),
        );
    }
}

#[test]
fn cooley_and_parkers_planetary_gear() {
    let planet: &[f64] = &[0.9617, 4.320, 5.672];
    let cases: [(usize, &[f64], &[f64]); 3] = [
        (
            3,
            &[0.9296, 1.090, 1.358, 1.931, 5.566, 7.741],
            &[0.7432, 1.018, 1.265, 1.487, 4.976, 6.282],
        ),
        (
            4,
            &[0.9077, 1.046, 1.317, 2.013, 5.809, 8.383],
            &[0.7199, 1.001, 1.317, 1.481, 5.153, 6.488],
        ),
        (
            5,
            &[0.8802, 1.019, 1.281, 2.090, 6.030, 8.986],
            &[0.6992, 0.9863, 1.344, 1.496, 5.317, 6.693],
        ),
    ];
    let unit = (10e6_f64 / 1.86).sqrt() / TAU;
    for (n, rotational, translational) in cases {
        let (spec, contacts) = scene_of(&COOLEY_PARKER, n);
        let found: Vec<f64> = found(&spec, &contacts[0])
            .iter()
            .map(|f| f / unit)
            .collect();
        let printed = [(rotational, 1), (translational, 2), (planet, n - 3)];
        hold(
            &found,
            &printed,
            5.5e-4,
            &format!("Cooley and Parker, {n} planets"),
        );
    }
}

#[test]
fn kahramans_planetary_train() {
    // Turns alone, planets on rigid pins without a mass, the ring held; r_s = r_p, the carrier at their sum.
    let (mut gears, distance) = gears(3, 20.0);
    let (sun, planet, ring) = (2.0, 3.0, 4);
    gears[ring].mount = Mount::Fixed;
    // Teeth of sun and planet differ here: inertias and stiffnesses are those of u = r theta.
    let r = effective_radius(&gears[0].body);
    gears[0].inertia = Some(sun * r * r);
    gears[0].loads = vec![Load::Applied(Profile::Constant(7.0 * OVERLAP_ON_LINES * r))];
    for g in &mut gears[1..=3] {
        let r = effective_radius(&g.body);
        g.inertia = Some(planet * r * r);
        // Its mass is not that of the carrier.
        let mut lateral = across(0.0, 0.0).unwrap();
        lateral.directions = Default::default();
        lateral.mass = Some(1e-12);
        g.lateral = Some(lateral);
    }
    let mut carrier = body(0.0, "carrier", 0.0);
    if let StationMember::Body(body) = &mut carrier.carries {
        body.planets = vec![1, 2, 3];
    }
    // The carrier moves flanks by its radius times the cosine of the pressure angle.
    let lever = distance * 20f64.to_radians().cos();
    let width = gears[0].body.face_width();
    let mut spec = SceneSpec {
        duration: f64::INFINITY,
        gears,
        meshes: meshes(3, OVERLAP_ON_LINES),
        shafts: vec![shaft("arm", vec![carrier], vec![])],
        stages: Vec::new(),
    };
    carrier_of(&mut spec).inertia = 4.0 * lever * lever;
    let modelling = gearbench_models::spec::Modelling {
        gears: vec![rigid(); spec.gears.len()],
        contacts: (0..spec.meshes.len())
            .map(|m| stiff(if m % 2 == 0 { 7.0 } else { 11.0 }, width))
            .collect(),
    };
    let mut scene =
        gearbench_models::scene::Scene::build(&spec, &modelling, gearbench::models::models())
            .unwrap();
    let s = scene.initial();
    // The ring is a coordinate with a link to the ground: an infinite inertia beside the others.
    let [mass, stiffness] = crate::shafts::matrices(&mut scene, &s);
    let kept: Vec<usize> = (0..s.q.len()).filter(|i| *i != ring).collect();
    let n = kept.len();
    let scaled = nalgebra::DMatrix::from_fn(n, n, |i, j| {
        let (i, j) = (kept[i], kept[j]);
        0.5 * (stiffness[(i, j)] + stiffness[(j, i)]) / (mass[(i, i)] * mass[(j, j)]).sqrt()
    });
    let mut found: Vec<f64> = nalgebra::SymmetricEigen::new(scaled)
        .eigenvalues
        .iter()
        .map(|x| x.max(0.0).sqrt() / TAU)
        .collect();
    found.sort_by(f64::total_cmp);
    let printed: [(&[f64], usize); 2] = [
        (&[0.0, 0.508728970094716, 0.707886793423852], 1),
        (&[0.389848400616838], 2),
    ];
    hold(&found, &printed, 1e-7, "Kahraman");
}

/// A pinion in a ring turns with it: what swings are both against each other, `k (1/m_1 + 1/m_2)` with `m = J/r_b^2`, also where a
/// torque is left over that accelerates both, and the mesh then bears what the inertia of the ring takes.
#[test]
fn a_ring_and_its_pinion_swing_against_each_other() {
    use gearbench::scene_file::{Origin, SceneFile};
    use gearbench::small_signals::{Patience, loaded};
    let (stiffness, width) = (2e10, 0.02);
    for more in [0.0, 12.0] {
        let text = format!(
            "schema = 1\nname = \"ring\"\nduration_s = 1e-3\n\
             [gears.pinion]\nteeth = 24\nmodule_m = 0.003\nface_width_m = {width:?}\nthinning_m = 3e-5\nspeed_rad_s = 20.0\n\
             loads = [{{ torque_nm = {:?} }}]\n\
             [gears.ring]\ninternal = true\nteeth = 84\nmodule_m = 0.003\nface_width_m = {width:?}\naddendum_factor = 0.8\n\
             tip_radius_factor = 0.25\ncutter_teeth = 25\nrim_radius_m = 0.15\nthinning_m = 3e-5\nspeed_rad_s = {:?}\n\
             loads = [{{ torque_nm = -210.0 }}]\n\
             [[meshes]]\ngears = [\"pinion\", \"ring\"]\ncentre_distance_m = 0.09\nstart = {{ flank = \"left\", gap_m = 0.0 }}\n\
             [[models]]\nmodel = \"rigid\"\ncontact = {{ stiffness = {{ kind = \"constant\", stiffness_n_per_m2 = {stiffness:?} }} }}\n",
            60.0 + more,
            20.0 * 24.0 / 84.0,
        );
        let file = SceneFile::unbuilt(&Context::default(), "ring", &text, Origin::Shipped, false)
            .unwrap_or_else(|e| panic!("{e:?}"));
        let choice = file.model("rigid").unwrap();
        let spec = file.spec_for(choice);
        let mut scene = gearbench_models::scene::Scene::build(
            &spec,
            &choice.modelling,
            gearbench::models::models(),
        )
        .unwrap();
        let found = loaded(&mut scene, true, &Patience::ENDLESS).unwrap_or_else(|e| panic!("{e}"));
        let contacts = scene.contact_forces(found.state.at()).len() as f64;
        let radii = [0, 1].map(|g| effective_radius(&spec.gears[g].body));
        let masses = [0, 1].map(|g| scene.gears()[g].model.hub().hub.inertia / radii[g].powi(2));
        let exact = (contacts * stiffness * width * (1.0 / masses[0] + 1.0 / masses[1])).sqrt();
        let swings = found.modes.squares[0].sqrt();
        println!(
            "{more} N m left over: {:.3} Hz, closed form {:.3}",
            swings / TAU,
            exact / TAU
        );
        assert_eq!((found.modes.squares.len(), found.rigid.len()), (1, 1));
        assert!((swings / exact - 1.0).abs() < 1e-6, "{swings} {exact}");
        // The ring takes its part of the acceleration.
        let rate = more / radii[0] / (masses[0] + masses[1]);
        let force = 60.0 / radii[0] + masses[1] * rate;
        assert!(
            (found.pressed[0] / force - 1.0).abs() < 1e-5,
            "{:?} {force}",
            found.pressed
        );
    }
}
