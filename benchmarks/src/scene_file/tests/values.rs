//! Values of a scene file arrive in the scene unchanged.

use super::{BASE, changed, parse, read, render, toothing_of};
use crate::context::Context;
use crate::scene_file::{Selection, load, load_uncalibrated};
use gearbench_integrators::Resolution;
use gearbench_models::error::{BuildError, GearPart, MeshPart};
use gearbench_models::geometry::{Pair, ReliefShape, Side};
use gearbench_models::law::Damping;
use gearbench_models::spec::{Body, Freedom, Load, Mount, Profile, SpinTerms};
use gearbench_models::stiffness::{Material, PairOrMesh, PairStiffness};
use gearbench_reports::Metric;

#[test]
fn the_base_scene() {
    let scene = parse(BASE).unwrap_or_else(|e| panic!("{}", render(&e)));
    assert_eq!(
        (scene.name.as_str(), scene.title.as_str(), scene.duration),
        ("test", "A test", 1e-4)
    );
    let [pinion, wheel] = [&scene.spec.gears[0], &scene.spec.gears[1]];
    assert_eq!(
        (pinion.name.as_str(), wheel.name.as_str()),
        ("pinion", "wheel")
    );
    assert_eq!((pinion.speed, wheel.speed), (20.0, 0.0));
    assert_eq!(wheel.position, [0.1001, 0.0, 0.0]);
    assert_eq!(pinion.loads, [Load::Applied(Profile::Constant(10.0))]);
    assert_eq!(pinion.mount, Mount::Revolute);
    assert_eq!(pinion.material, Material::STEEL);
    let mesh = &scene.spec.meshes[0];
    assert_eq!(
        (mesh.gears, mesh.start.side, mesh.start.gap),
        ([0, 1], Side::Left, 1e-6)
    );
    let labels: Vec<&str> = scene.models.iter().map(|m| m.label.as_str()).collect();
    assert_eq!(labels, ["rigid", "movable-teeth"]);
    let contact = &scene.models[0].modelling.contacts[0];
    assert_eq!(
        contact.stiffness,
        PairStiffness::Constant {
            per_width: 1.4e10,
            of: PairOrMesh::Pair
        }
    );
    assert_eq!(
        (contact.damping, contact.exponent, contact.slices),
        (Damping::Flores { e: 0.9 }, 1.0, None)
    );
    assert_eq!(scene.study.models, labels);
    assert_eq!(
        scene.study.integrators[0].resolution,
        Resolution::Tolerance(1e-6)
    );
    assert_eq!(
        scene.study.integrators[1].resolution,
        Resolution::Step(1e-6)
    );
    let t = scene.tolerance.unwrap();
    assert_eq!(
        (t.metric, t.limit, t.against.as_str()),
        (Metric::ForceL2Aligned, 0.05, "calculix")
    );
}

#[test]
fn gears_keep_the_order_of_the_file() {
    let text = BASE.replace("pinion", "zebra").replace("wheel", "ant");
    let scene = parse(&text).unwrap();
    assert_eq!(scene.spec.gears[0].name, "zebra");
}

#[test]
fn toothing() {
    let scene = read(
        "teeth = 20",
        "teeth = 20\npressure_angle_deg = 20.0\nprofile_shift = -0.1\naddendum_factor = 0.9\ndedendum_factor = 1.2\n\
         tip_radius_factor = 0.2\nthinning_m = 1e-5\nbore_radius_m = 0.01\nprofile_crowning_m = 2e-6\nlead_crowning_m = 3e-6\n\
         tip_relief = { amount_m = 1e-5, start_radius_m = 0.042, shape = \"parabolic\" }\n\
         material = { young_pa = 2e11, poisson = 0.28, density_kg_m3 = 7800 }\nadded_inertia_kgm2 = 1e-3",
    );
    let gear = &scene.spec.gears[0];
    let body = toothing_of(&scene, 0);
    let p = body.params();
    assert_eq!(
        [p.profile_shift, p.addendum, p.dedendum, p.tip_radius],
        [-0.1, 0.9, 1.2, 0.2]
    );
    assert_eq!([p.thinning, p.bore_radius], [1e-5, 0.01]);
    assert_eq!(
        [
            p.modifications.profile_crowning,
            p.modifications.lead_crowning
        ],
        [2e-6, 3e-6]
    );
    let relief = p.modifications.tip_relief.unwrap();
    assert_eq!(
        (relief.amount, relief.start_radius, relief.shape),
        (1e-5, 0.042, ReliefShape::Parabolic)
    );
    assert_eq!(
        gear.material,
        Material {
            young: 2e11,
            poisson: 0.28,
            density: 7800.0
        }
    );
    assert_eq!((gear.inertia, gear.added_inertia), (None, 1e-3));
    assert!((p.pressure_angle - 20f64.to_radians()).abs() < 1e-16);
}

#[test]
fn loads_and_mounts() {
    let load = |text: &str| {
        read("{ torque_nm = 10.0 }", text).spec.gears[0]
            .loads
            .clone()
    };
    assert_eq!(
        load(
            "{ ramp = { from_nm = 0.0, to_nm = 5, start_s = 0.0, end_s = 1e-5 } }, { viscous_nms_per_rad = 0.1 }"
        ),
        [
            Load::Applied(Profile::Ramp {
                from: 0.0,
                to: 5.0,
                start: 0.0,
                end: 1e-5
            }),
            Load::Viscous(0.1)
        ]
    );
    assert_eq!(
        load("{ table = { time_s = [0, 1], torque_nm = [2, 3] } }"),
        [Load::Applied(Profile::table(
            vec![0.0, 1.0],
            vec![2.0, 3.0]
        ))]
    );
    let mount = |text: &str| {
        read("mount = \"revolute\"", text).spec.gears[1]
            .mount
            .clone()
    };
    assert_eq!(mount("mount = \"fixed\""), Mount::Fixed);
    assert_eq!(
        mount("mount = { driven = { speed_rad_s = -3.0 } }"),
        Mount::Driven(Profile::Constant(-3.0))
    );
    assert_eq!(
        mount(
            "mount = { driven = { ramp = { from_rad_s = 0, to_rad_s = 1, start_s = 0, end_s = 1 } } }"
        ),
        Mount::Driven(Profile::Ramp {
            from: 0.0,
            to: 1.0,
            start: 0.0,
            end: 1.0
        })
    );
}

#[test]
fn models_per_gear() {
    let scene = read(
        "parameters = {",
        "gears = { wheel = \"rigid\" }\nparameters = {",
    );
    let gears = &scene.models[1].modelling.gears;
    assert_eq!([gears[0].id(), gears[1].id()], ["movable-teeth", "rigid"]);
    assert!(gears[1].values().is_empty() && gears[0].values().len() == 2);
}

#[test]
fn distance_from_backlash_and_direction() {
    let scene = read(
        "centre_distance_m = 0.1001",
        "backlash_m = 8e-5\ndirection_deg = 90.0",
    );
    let [x, y, _] = scene.spec.gears[1].position;
    let [a, b] = [0, 1].map(|i| toothing_of(&scene, i));
    assert!(x.abs() < 1e-15);
    assert!((Pair::new(&a, &b, y).unwrap().backlash_normal() - 8e-5).abs() < 1e-13);
}

#[test]
fn a_rack_is_placed_by_its_backlash() {
    for helix in [0.0, 15.0] {
        let text = BASE
            .replace(
                "teeth = 20",
                &format!(
                    "teeth = 20\nthinning_m = 1e-5\nprofile_shift = 0.2\nhelix_angle_deg = {helix}"
                ),
            )
            .replace(
                "teeth = 30",
                &format!(
                    "kind = \"rack\"\nteeth = 30\nthinning_m = 2e-5\nhelix_angle_deg = -{helix}"
                ),
            )
            .replace(
                "mount = \"revolute\"",
                "mass_kg = 0.3\nspeed_m_s = 0.1\nloads = [{ force_n = 3.0 }]",
            )
            .replace("centre_distance_m = 0.1001", "backlash_m = 1e-4");
        let scene = parse(&text).unwrap_or_else(|e| panic!("{}", render(&e)));
        let [gear, rack] = [&scene.spec.gears[0], &scene.spec.gears[1]];
        let (Body::Gear(g), Body::Rack(r)) = (&gear.body, &rack.body) else {
            panic!("gear and rack")
        };
        let pair = Pair::new(g, r, rack.position[0]).unwrap();
        assert!(
            (pair.backlash_normal() - 1e-4).abs() < 1e-12,
            "{}",
            pair.backlash_normal()
        );
        assert_eq!(
            (rack.mount.clone(), rack.inertia, rack.speed),
            (Mount::Prismatic, Some(0.3), 0.1)
        );
        assert!((rack.facing - std::f64::consts::PI).abs() < 1e-15);
    }
}

/// The base scene with a third gear, which meshes with the second.
fn idler() -> String {
    changed(
        "[[models]]",
        "[[meshes]]\ngears = [\"wheel\", \"third\"]\ncentre_distance_m = 0.1201\n\n[[models]]",
    )
    .replace(
        "[gears.wheel]",
        "[gears.third]\nteeth = 30\nmodule_m = 0.004\nface_width_m = 0.01\n\n[gears.wheel]",
    )
}

#[test]
fn an_idler_has_two_meshes() {
    let scene = parse(&idler()).unwrap_or_else(|e| panic!("{}", render(&e)));
    assert_eq!(scene.spec.meshes.len(), 2);
    let third = scene.spec.gears.iter().find(|g| g.name == "third").unwrap();
    assert!((third.position[0] - 0.2202).abs() < 1e-15);
    assert!(scene.models.iter().all(|m| m.modelling.contacts.len() == 2));
}

#[test]
fn a_study_without_integrators_takes_the_adaptive_ones() {
    let scene = read(
        "integrators = [{ method = \"dopri5\", rtol = 1e-6 }, { method = \"rk4\", step_s = 1e-6 }]",
        "events = false",
    );
    assert!(scene.study.integrators.len() >= 5 && !scene.study.events);
    assert!(
        scene
            .study
            .integrators
            .iter()
            .all(|m| matches!(m.resolution, Resolution::Tolerance(_)))
    );
    // The names of the command line mean the same metrics.
    let scene = read(
        "tolerance = 0.05",
        "tolerance = { metric = \"peak\", limit = 0.05 }",
    );
    assert_eq!(scene.tolerance.unwrap().metric, Metric::PeakForceRel);
    let scene = read(
        "[study]",
        "[study]\nquantities = [\"force-aligned\", \"peak_force_n\", \"omega2_end\", \"speeds_end\"]\nprecision = { metrics = [\"peak_force_rel\"] }",
    );
    let of_scene = [Metric::ForceL2Aligned, Metric::PeakForce];
    assert_eq!(scene.study.quantities, of_scene);
    assert_eq!(scene.study.precision.metrics, [Metric::PeakForceRel]);
    let all = Metric::ALL.map(|m| format!("\"{m}\"")).join(", ");
    let scene = read(
        "[study]",
        &format!("[study]\nquantities = [{all}]\nsamples = 100\nmodels = [\"movable-teeth\"]"),
    );
    assert_eq!(
        (scene.study.quantities.len(), scene.study.samples),
        (Metric::ALL.len(), 100)
    );
    assert_eq!(scene.select(None).unwrap()[0].label, "movable-teeth");
    assert_eq!(scene.select(Some("rigid, movable-teeth")).unwrap().len(), 2);
    assert!(render(&scene.select(Some("rigd")).unwrap_err()).contains("did you mean `rigid`"));
    assert!(render(&scene.select(Some(",")).unwrap_err()).contains("no model is named"));
}

#[test]
fn a_file_has_its_calibration_beside_it() {
    let folder = std::env::temp_dir().join(format!("gearbench-scene-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("own.toml");
    std::fs::write(
        &path,
        changed(
            "model = \"rigid\"",
            "model = \"rigid\"\ncalibration = \"static\"",
        ),
    )
    .unwrap();
    let name = path.to_str().unwrap();
    let shown = render(&load(&Context::default(), name).unwrap_err());
    assert!(shown.contains("no calibration \"static\""), "{shown}");
    let scene = load_uncalibrated(&Context::default(), name, Selection::All).unwrap();
    assert_eq!(
        scene.calibration_path(),
        folder.join("own.calibration.toml")
    );
    std::fs::write(
        scene.calibration_path(),
        "[static.rigid]\nstiffness_n_per_m2 = 1.5e10\n",
    )
    .unwrap();
    let scene = load(&Context::default(), name).unwrap_or_else(|e| panic!("{}", render(&e)));
    assert_eq!(
        scene.models[0].modelling.contacts[0].stiffness,
        PairStiffness::Constant {
            per_width: 1.5e10,
            of: PairOrMesh::Pair
        }
    );
    std::fs::write(
        scene.calibration_path(),
        "[static.rigid]\nstiffness_n_per_m2 = 0\n",
    )
    .unwrap();
    assert!(
        render(&load(&Context::default(), name).unwrap_err()).contains("own.calibration.toml:2:")
    );
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn errors_of_the_assembly_have_a_line() {
    let scene = parse(BASE).unwrap();
    let line = |label: &str, e: BuildError| scene.locate_in(label, &e).line();
    for (part, expected) in [
        (GearPart::Whole, 15),
        (GearPart::Inertia, 15),
        (GearPart::Load, 15),
        (GearPart::Mount, 19),
        (GearPart::Model, 27),
    ] {
        let e = BuildError::gear("wheel", part, "odd");
        assert_eq!(line("rigid", e), Some(expected), "{part:?}");
    }
    let load = BuildError::gear("pinion", GearPart::Load, "bad");
    assert_eq!(line("rigid", load), Some(13));
    for key in ["tooth_mass_kg", "spring_radius_m"] {
        let e = BuildError::parameter("movable-teeth", key, "too heavy");
        assert_eq!(line("movable-teeth", e), Some(33));
    }
    for (part, expected) in [
        (MeshPart::Layout, 23),
        (MeshPart::Start, 24),
        (MeshPart::Stiffness, 28),
        (MeshPart::Friction, 28),
        (MeshPart::Contact, 28),
    ] {
        let e = BuildError::mesh(["pinion", "wheel"], part, "odd");
        assert_eq!(line("rigid", e), Some(expected), "{part:?}");
    }
    // With one contact per mesh the faulty one is shown.
    let two = "model = \"rigid\"\ncontact = [{ stiffness = \"iso6336\" },\n    { slices = 2, stiffness = \"iso6336\" }]\n\n[[models]]\nlabel = \"other\"\nmodel = \"rigid\"";
    let train = idler().replacen("model = \"rigid\"", two, 1);
    let scene_of_two = parse(&train).unwrap_or_else(|e| panic!("{}", render(&e)));
    for (gears, line) in [(["pinion", "wheel"], 37), (["wheel", "third"], 38)] {
        let e = BuildError::mesh(gears, MeshPart::Slices, "too many");
        assert_eq!(scene_of_two.locate_in("rigid", &e).line(), Some(line));
    }
    let why = ("inertia 0 is not positive", "give another");
    let e = BuildError::gear("wheel", GearPart::Inertia, why);
    let shown = render(&scene.locate_in("rigid", &e));
    assert!(
        shown.contains("gear `wheel`: inertia 0") && shown.contains("help: give another"),
        "{shown}"
    );
}

#[test]
fn bearings_and_axes() {
    let scene = read(
        "speed_rad_s = 20.0",
        "bearing = { stiffness = [1e8, 1e8, 5e7, 1e4, 1e4, 0.0], damping = [1e3, 1e3, 1e3, 1.0, 1.0, 0.0] }\ndirections = { z = \"held\", tilt_x = { driven = { speed_rad_s = 0.01 } } }\nadded_mass_kg = 0.2\nspin_terms = \"off\"\nmisalignment_deg = { plane_of_action = 0.03 }",
    );
    let pinion = &scene.spec.gears[0];
    let lateral = pinion.lateral.as_deref().unwrap();
    assert_eq!(
        lateral.directions,
        [
            Freedom::Free,
            Freedom::Free,
            Freedom::Fixed,
            Freedom::Driven(Profile::Constant(0.01)),
            Freedom::Free,
            Freedom::Fixed,
        ]
    );
    assert_eq!((lateral.added_mass, lateral.spin), (0.2, SpinTerms::Off));
    assert_eq!(lateral.bearing.stiffness[2][2], 5e7);
    assert_eq!(lateral.bearing.damping[3][3], 1.0);
    // Towards the line of action of left flanks, at 90 degrees less the working pressure angle.
    let alpha = (0.05_f64 * 2.0 * 20_f64.to_radians().cos() / 0.1001).acos();
    let axis = pinion.axes[2];
    assert!((axis.xy().norm() - 0.03_f64.to_radians().sin()).abs() < 1e-12);
    assert!((axis.y.atan2(axis.x) - (std::f64::consts::FRAC_PI_2 - alpha)).abs() < 1e-12);
    assert_eq!(scene.spec.gears[1].axes[2].z, 1.0);
}
