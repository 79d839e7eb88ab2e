//! Torque paths, load sharing and the power balance in records, compared with closed forms.
//!
//! Mesh stiffness is constant, so that a train that has come to rest in itself carries the torques that statics say: nothing
//! excites it.

use gearbench::context::Context;
use gearbench::experiment::conditions::Conditions;
use gearbench::experiment::runner::Runner;
use gearbench::scene_file::{Origin, SceneFile};
use gearbench::studies::compare::{Plan, compare};
use gearbench_integrators::table::DOPRI5;
use gearbench_reports::record::{MemberPath, MeshPath, Run, TorquePaths};

const CONTACT: &str = "[[models]]\nmodel = \"rigid\"\ncontact = { stiffness = { kind = \"constant\", of = \"mesh\", \
    stiffness_n_per_m2 = 1.5e10 }, damping = { law = \"kelvin-voigt-ratio\", ratio = 0.2 } }\n";

fn gear(name: &str, teeth: u32, more: &str) -> String {
    format!(
        "[gears.{name}]\nteeth = {teeth}\nmodule_m = 0.003\nface_width_m = 0.02\nthinning_m = 3e-5\n{more}\n"
    )
}

/// Runs a scene from a text with gears, shafts and meshes.
fn run_of(text: &str, duration: f64) -> Run {
    let text = format!(
        "schema = 1\nname = \"paths\"\ntitle = \"Paths\"\nduration_s = {duration:?}\n{text}{CONTACT}"
    );
    let scene = SceneFile::parse(&Context::default(), "paths", &text, Origin::Shipped, false)
        .unwrap_or_else(|e| panic!("{e:?}"));
    let choices = scene.select(None).unwrap();
    let plan = Plan {
        conditions: Conditions {
            samples: 2001,
            repeats: 0,
            ..Conditions::of(&scene)
        },
        tolerance: None,
        ..Plan::of(&scene, &choices, &[])
    };
    let plan = plan.with_methods(vec![DOPRI5.at_tolerance(1e-9)]);
    let mut runs = compare(&plan, &Runner::default()).unwrap().runs;
    let run = runs.remove(0);
    assert!(!run.status.is_failure(), "{:?}", run.message);
    run
}

fn paths(run: &Run) -> &TorquePaths {
    run.paths.as_ref().expect("paths of a train")
}

fn mesh<'p>(paths: &'p TorquePaths, gears: [&str; 2]) -> &'p MeshPath {
    paths.meshes.iter().find(|m| m.gears == gears).unwrap()
}

fn member<'p>(paths: &'p TorquePaths, name: &str) -> &'p MemberPath {
    paths.members.iter().find(|m| m.name == name).unwrap()
}

fn near(what: &str, found: f64, wanted: f64, within: f64) {
    println!(
        "{what}: {found:.9}, closed form {wanted:.9}, relative difference {:+.1e}",
        found / wanted - 1.0
    );
    assert!(
        (found - wanted).abs() <= within * wanted.abs(),
        "{what}: {found} {wanted}"
    );
}

/// Checks that input less output, dissipated and stored power balance, as in the ledger of the run.
fn balances(what: &str, run: &Run, within: f64) {
    let (p, ledger) = (paths(run), &run.ledger);
    let work = p.work_in_j - p.work_out_j;
    let external = ledger.external_work_j.unwrap();
    println!(
        "{what}: in {} out {} dissipated {} stored {}, not explained {:.1e} of the work of {:.3e} J, ledger {external}",
        p.work_in_j,
        p.work_out_j,
        p.dissipated_j,
        p.stored_j,
        p.unexplained_j / p.work_in_j,
        p.work_in_j
    );
    assert!(
        (work - external).abs() < within * p.work_in_j,
        "{work} {external}"
    );
    let stored = ledger.energy_end_j.unwrap() - ledger.energy_start_j.unwrap();
    assert!((p.stored_j - stored).abs() < 1e-12 * p.work_in_j);
    assert!(p.unexplained_j.abs() < within * p.work_in_j);
    assert!(p.has_settled(), "{}", p.change_rel);
}

/// An unbalanced torque accelerates a train: its mean speeds rise, and shares of the input are meaningless.
#[test]
fn a_train_that_accelerates_has_not_settled() {
    let text = gear(
        "first",
        20,
        "speed_rad_s = 30.0\nloads = [{ torque_nm = 30.0 }]",
    ) + &gear("idler", 30, "speed_rad_s = -20.0")
        + &gear("last", 24, "speed_rad_s = 25.0")
        + "[[meshes]]\ngears = [\"first\", \"idler\"]\nbacklash_m = 8e-5\n\
           [[meshes]]\ngears = [\"idler\", \"last\"]\nbacklash_m = 8e-5\n";
    let run = run_of(&text, 0.02);
    assert!(!paths(&run).has_settled(), "{}", paths(&run).change_rel);
}

/// 30 N m on the first of three gears: the idler passes on the force, not its own torque, and all power leaves at the last one.
#[test]
fn an_idler_hands_the_force_on() {
    let torque = 30.0 * 24.0 / 20.0;
    let text = gear(
        "first",
        20,
        "speed_rad_s = 30.0\nloads = [{ torque_nm = 30.0 }]",
    ) + &gear("idler", 30, "speed_rad_s = -20.0")
        + &gear(
            "last",
            24,
            &format!(
                "speed_rad_s = 25.0\nloads = [{{ torque_nm = {:?} }}]",
                -torque
            ),
        )
        + "[[meshes]]\ngears = [\"first\", \"idler\"]\nbacklash_m = 8e-5\n\
           [[meshes]]\ngears = [\"idler\", \"last\"]\nbacklash_m = 8e-5\nstart = { flank = \"left\", gap_m = 0.0 }\n";
    // The idler drives the last gear with its other flank.
    let text = text.replace(
        "gears = [\"idler\", \"last\"]\nbacklash_m = 8e-5\nstart = { flank = \"left\"",
        "gears = [\"idler\", \"last\"]\nbacklash_m = 8e-5\nstart = { flank = \"right\"",
    );
    let run = run_of(&text, 0.2);
    let p = paths(&run);
    let (a, b) = (mesh(p, ["first", "idler"]), mesh(p, ["idler", "last"]));
    near("torque on the first", a.torque_nm[0], -30.0, 1e-8);
    near("torque on the last", b.torque_nm[1], torque, 1e-8);
    near(
        "torque of the first mesh on the idler",
        a.torque_nm[1],
        -45.0,
        1e-8,
    );
    near("of the second", b.torque_nm[0], 45.0, 1e-8);
    near("force", b.force_n, a.force_n, 1e-8);
    near("share of the first mesh", a.share.unwrap(), 1.0, 1e-8);
    near("of the second", b.share.unwrap(), 1.0, 1e-8);
    near(
        "power",
        a.power_w,
        30.0 * member(p, "first").speed_rad_s,
        1e-8,
    );
    assert!(
        member(p, "idler").contact_nm.abs() < 1e-6 && p.sharing.is_empty() && p.shafts.is_empty()
    );
    balances("idler train", &run, 1e-9);
}

/// Two steps, 20/40 and 18/36 teeth, with a rigid shaft between: torque four times, its shaft carries twice. What comes in by the
/// drive goes out at the load that answers to its speed.
#[test]
fn a_compound_train_multiplies_its_torque() {
    let text = gear("one", 20, "mount = { driven = { speed_rad_s = 80.0 } }")
        + &gear("two", 40, "")
        + &gear("three", 18, "")
        + &gear(
            "four",
            36,
            "speed_rad_s = 20.0\nloads = [{ viscous_nms_per_rad = 2.0 }]",
        )
        + "[[meshes]]\ngears = [\"one\", \"two\"]\nbacklash_m = 8e-5\n\
           [[meshes]]\ngears = [\"three\", \"four\"]\nbacklash_m = 8e-5\nstart = { flank = \"right\", gap_m = 0.0 }\n\
           [[shafts]]\nname = \"between\"\nspeed_rad_s = -40.0\n\
           carries = [{ gear = \"two\", at_m = 0.0 }, { gear = \"three\", at_m = 0.1 }]\n";
    let run = run_of(&text, 0.3);
    let p = paths(&run);
    let out = 2.0 * 20.0;
    near("load", member(p, "four").load_nm, -out, 1e-8);
    near("drive", member(p, "one").mount_nm, out / 4.0, 1e-8);
    near("shaft", p.shafts[0].torque_nm.abs(), out / 2.0, 1e-8);
    let (a, b) = (mesh(p, ["one", "two"]), mesh(p, ["three", "four"]));
    near(
        "torque on the second",
        a.torque_nm[1].abs(),
        out / 2.0,
        1e-8,
    );
    near("torque on the fourth", b.torque_nm[1], out, 1e-8);
    near("power", p.input_w, out * 20.0, 1e-8);
    near(
        "over the shaft",
        p.shafts[0].power_w.abs(),
        out * 20.0,
        1e-8,
    );
    near("share", b.share.unwrap(), 1.0, 1e-8);
    // A drive's work is a sum over samples, the start with its knocks in it.
    balances("train with a drive", &run, 5e-5);
}

/// The set of `planets/sharing.rs` in motion: a pin that is off by `e` along its circle shifts the forces by
/// `2 K cos alpha (mean e - e)`, `1/K = 1/k_s + 1/k_r`. Ring meshes carry no power in space, and all of the rolling power.
#[test]
fn planets_share_as_the_closed_form_says() {
    let (sun, planet, ring) = (24_u32, 30_u32, 84_u32);
    let (module, width, stiffness, torque) = (0.003, 0.02, 1.5e10, 60.0);
    let distance = 0.5 * module * f64::from(sun + planet);
    let on_carrier = torque * f64::from(sun + ring) / f64::from(sun);
    for error in [0.0, 2e-6, -2e-6] {
        let mut text = gear(
            "sun",
            sun,
            &format!(
                "bore_radius_m = 0.012\nspeed_rad_s = 20.0\nloads = [{{ torque_nm = {torque:?} }}]"
            ),
        );
        for k in 1..4 {
            text += &gear(&format!("p{k}"), planet, "bore_radius_m = 0.015");
        }
        text += &gear(
            "ring",
            ring,
            "internal = true\naddendum_factor = 0.8\ntip_radius_factor = 0.25\ncutter_teeth = 25\nrim_radius_m = 0.15\n\
             mount = \"fixed\"\nposition_m = [0.0, 0.0]",
        );
        text += &format!(
            "[[shafts]]\nname = \"arm\"\ncarries = [{{ body = \"carrier\", at_m = 0.0, inertia_kgm2 = 0.01, \
             planets = [\"p1\", \"p2\", \"p3\"], speed_rad_s = {:?}, loads = [{{ torque_nm = {:?} }}] }}]\n",
            20.0 * f64::from(sun) / f64::from(sun + ring),
            -on_carrier
        );
        let off = (error / distance).to_degrees();
        for (k, direction) in [0.0, 120.0 + off, 240.0].into_iter().enumerate() {
            text += &format!(
                "[[meshes]]\ngears = [\"sun\", \"p{}\"]\ncentre_distance_m = {distance:?}\ndirection_deg = {direction:?}\n",
                k + 1
            );
        }
        for k in 1..4 {
            let start = if k == 1 {
                "start = { flank = \"right\", gap_m = 0.0 }\n"
            } else {
                ""
            };
            text += &format!("[[meshes]]\ngears = [\"p{k}\", \"ring\"]\n{start}");
        }
        let run = run_of(&text, 0.1);
        let p = paths(&run);
        let cos = 20.0_f64.to_radians().cos();
        let mean = torque / (3.0 * 0.5 * module * f64::from(sun) * cos);
        let k = 0.5 * stiffness * width;
        let [on_sun, on_ring] = p.sharing.as_slice() else {
            panic!("{:?}", p.sharing);
        };
        assert_eq!(
            (on_sun.gear.as_str(), on_ring.gear.as_str()),
            ("sun", "ring")
        );
        let mut largest = 0.0_f64;
        for (i, share) in on_sun.planets.iter().enumerate() {
            let own = if i == 1 { error } else { 0.0 };
            let wanted = (1.0 + 2.0 * k * cos * (error / 3.0 - own) / mean) / 3.0;
            largest = largest.max(wanted);
            near(&share.planet, share.mean, wanted, 1e-8);
            near("on the ring", on_ring.planets[i].mean, wanted, 1e-8);
            assert!(share.least <= share.mean && share.mean <= share.greatest);
        }
        near("K gamma", on_sun.factor, 3.0 * largest, 1e-8);
        let rolling = f64::from(ring) / f64::from(sun + ring);
        let input = torque * member(p, "sun").speed_rad_s;
        near("input", p.input_w, input, 1e-8);
        let all = |names: fn(usize) -> [String; 2], of: fn(&MeshPath) -> f64| -> f64 {
            (1..4)
                .map(|k| {
                    let gears = names(k);
                    of(p.meshes.iter().find(|m| m.gears == gears).unwrap())
                })
                .sum()
        };
        let suns = |k: usize| ["sun".into(), format!("p{k}")];
        let rings = |k: usize| [format!("p{k}"), "ring".into()];
        near(
            "power of the sun's meshes",
            all(suns, |m| m.power_w),
            input,
            1e-8,
        );
        near(
            "their rolling power",
            all(suns, |m| m.rolling_w.unwrap()),
            rolling * input,
            1e-8,
        );
        near(
            "that of the ring's",
            all(rings, |m| m.rolling_w.unwrap()),
            rolling * input,
            1e-8,
        );
        assert!(all(rings, |m| m.power_w).abs() < 1e-9 * input);
        near(
            "ring",
            member(p, "ring").mount_nm.abs(),
            on_carrier - torque,
            1e-8,
        );
        // Its transmission errors are those that the carrier sees: some micrometres, not its turn.
        let errors = run.series.as_ref().unwrap().columns.iter();
        let of_sun = errors.filter(|c| c.name == "transmission_error_sun_p1_m");
        let greatest = of_sun
            .flat_map(|c| &c.values)
            .fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!(greatest > 1e-7 && greatest < 3e-5, "{greatest}");
        balances("planetary set", &run, 1e-9);
    }
}
