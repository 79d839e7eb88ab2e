//! The shipped scenes load, and those with a reference agree with it.

use super::{render, toothing_of};
use crate::context::Context;
use crate::scene_file::{
    CalibrationUse, Origin, SHIPPED, SceneFile, Selection, load, load_uncalibrated,
};
use gearbench_models::geometry::{Pair, Side};
use gearbench_models::stiffness::PairStiffness;
use std::path::Path;

#[test]
fn all_load_and_are_described() {
    for shipped in SHIPPED {
        let scene =
            load(&Context::default(), shipped.name).unwrap_or_else(|e| panic!("{}", render(&e)));
        assert_eq!(scene.name, shipped.name);
        assert_eq!(scene.origin, Origin::Shipped);
        assert!(
            !scene.title.is_empty() && !scene.description.is_empty() && scene.tolerance.is_some()
        );
        assert!(scene.select(None).unwrap().len() >= 2);
        assert!(
            scene
                .calibration_path()
                .ends_with(format!("calibrations/{}.toml", shipped.name))
        );
        // Without a calibration both are the same.
        if scene.models.iter().any(|m| m.calibration.is_some()) {
            load_uncalibrated(&Context::default(), shipped.name, Selection::All)
                .unwrap_or_else(|e| panic!("{}", render(&e)));
        }
    }
}

/// All scenes of examples, benches and tests can be read.
#[test]
fn all_scenes_of_the_repository_are_read() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut read = 0;
    for folder in ["examples", "../benches/support", "../tests/fingerprint"] {
        for entry in std::fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let text = match path.extension() {
                Some(e) if e == "toml" => std::fs::read_to_string(&path).unwrap(),
                _ => continue,
            };
            // Files of `check` have a schema, too, but cases in place of gears.
            let is_check = text.lines().any(|l| l == "[[cases]]");
            if !is_check && text.lines().any(|l| l.starts_with("schema")) {
                let name = path.to_string_lossy().into_owned();
                let scene = SceneFile::unbuilt(
                    &Context::default(),
                    &name,
                    &text,
                    Origin::File(path),
                    false,
                );
                scene.unwrap_or_else(|e| panic!("{}", render(&e)));
                read += 1;
            }
        }
    }
    assert!(read >= 8, "{read}");
}

/// Every impact scene has four explicit and four implicit methods.
#[test]
fn enough_methods() {
    for name in ["spur_impact", "spur_impact_large"] {
        let study = load(&Context::default(), name).unwrap().study;
        let implicit = |m: &gearbench_integrators::Scheme| m.method.info().implicit;
        let count = study.integrators.iter().filter(|m| implicit(m)).count();
        assert!(count >= 4 && study.integrators.len() - count >= 4, "{name}");
    }
}

#[test]
fn impacts_are_those_of_their_references() {
    for name in ["spur_impact", "spur_impact_large", "helical_impact"] {
        let scene = load(&Context::default(), name).unwrap();
        // The last reference is the one on whose mesh models run.
        let several = scene.references.len() > 1;
        let id = scene.references.last().unwrap().stored().unwrap();
        let reference = gearbench_reference::reference(id).unwrap();
        let p = &reference.parameters;
        assert_eq!(scene.tolerance.as_ref().unwrap().against, "calculix");
        for (i, (gear, data)) in scene.spec.gears.iter().zip(&p.gears).enumerate() {
            let body = toothing_of(&scene, i);
            let g = body.params();
            assert_eq!(g.teeth, data.teeth);
            assert_eq!(g.helix_angle, data.helix_angle_deg.to_radians());
            assert_eq!(gear.inertia, Some(data.inertia));
            assert_eq!(gear.speed, data.speed);
            assert_eq!(
                [
                    g.module,
                    g.face_width,
                    g.bore_radius,
                    g.tip_radius,
                    g.addendum,
                    g.dedendum
                ],
                [
                    p.module,
                    p.face_width,
                    data.bore_radius,
                    p.tip_radius,
                    p.addendum,
                    p.dedendum
                ]
            );
            assert_eq!(
                [
                    gear.material.young,
                    gear.material.poisson,
                    gear.material.density
                ],
                [p.young, p.poisson, p.density]
            );
            assert!((body.r_base() - data.base_radius).abs() < 1e-15);
        }
        let mesh = &scene.spec.meshes[0];
        assert_eq!(
            (mesh.start.side, mesh.start.gap),
            (
                Side::Left,
                if several {
                    p.gap_exact
                } else {
                    p.gap_effective
                }
            )
        );
        assert!((scene.spec.gears[1].position[0] - p.centre_distance).abs() < 1e-15);
        // The pitch point is where the reference starts.
        let [a, b] = [0, 1].map(|i| toothing_of(&scene, i));
        let pair = Pair::new(&a, &b, p.centre_distance).unwrap();
        assert!((pair.s_pitch() - p.path_coordinate).abs() < 1e-12);
    }
}

#[test]
fn calibrations_are_applied() {
    let scene = load(&Context::default(), "spur_impact").unwrap();
    let rigid = scene.model("rigid").unwrap();
    let constants = rigid
        .calibration
        .as_ref()
        .unwrap()
        .constants
        .as_ref()
        .unwrap();
    let PairStiffness::Constant { per_width, .. } = rigid.modelling.contacts[0].stiffness else {
        panic!("{:?}", rigid.modelling.contacts[0].stiffness)
    };
    assert_eq!(Some(per_width), constants.stiffness);
    assert!((1.2e10..1.9e10).contains(&per_width));
    assert_eq!(
        scene.spec_for(rigid).meshes[0].start.gap,
        constants.gap.unwrap()
    );
    let movable = scene.model("movable-teeth").unwrap();
    for gear in &movable.modelling.gears {
        assert!(gear.values()["tooth_stiffness_n_per_m"].as_f64() > Some(1e8));
    }
    // Nothing fitted stays as it is.
    let iso = scene.model("rigid-iso6336").unwrap();
    assert!(matches!(
        iso.modelling.contacts[0].stiffness,
        PairStiffness::Iso6336 { .. }
    ));
    assert_eq!(
        scene.spec_for(iso).meshes[0].start.gap,
        scene.spec.meshes[0].start.gap
    );
    // Another scene's gap is not taken over.
    let hammer = load(&Context::default(), "hammer").unwrap();
    let CalibrationUse {
        scene: from,
        constants,
        ..
    } = hammer.model("rigid").unwrap().calibration.clone().unwrap();
    assert_eq!(
        (from.as_str(), constants.unwrap().gap),
        ("spur_impact", None)
    );
    assert_eq!(
        hammer.spec_for(hammer.model("rigid").unwrap()).meshes[0]
            .start
            .gap,
        50e-6
    );
}

#[test]
fn the_hammering_pair_starts_in_the_middle_of_its_backlash() {
    let scene = load(&Context::default(), "hammer").unwrap();
    let [a, b] = [0, 1].map(|i| toothing_of(&scene, i));
    let pair = Pair::new(&a, &b, scene.spec.gears[1].position[0]).unwrap();
    assert!((pair.backlash_normal() - 100e-6).abs() < 1e-13);
    assert_eq!(scene.spec.meshes[0].start.gap, 50e-6);
}

/// Example 1 of Ebrahimi and Eberhard has no forces but impacts, and its teeth have the published stiffnesses.
#[test]
fn the_rotating_pair_is_free_and_has_the_published_stiffnesses() {
    let scene = load(&Context::default(), "spur_rotation").unwrap();
    assert!(scene.spec.gears.iter().all(|g| g.loads.is_empty()));
    let stiffness = |label: &str| {
        let gears = &scene.model(label).unwrap().modelling.gears;
        (gears.iter()).map(|g| g.values()["tooth_stiffness_n_per_m"].as_f64().unwrap())
    };
    for (label, published) in [
        ("movable-teeth-5.6e7", 5.6e7),
        ("movable-teeth-3.6e9", 3.6e9),
    ] {
        assert!(stiffness(label).all(|k| k == published), "{label}");
    }
    assert!(
        scene.spec.gears[0].speed * scene.duration / std::f64::consts::TAU > 3.0,
        "several rotations"
    );
}
