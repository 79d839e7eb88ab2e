//! Natural frequencies of shafts in torsion, alone and joined by meshes.

use super::*;
use crate::small_signals::vibrations_of;
use gearbench::context::Context;
use gearbench_models::geometry::Side;
use gearbench_models::spec::GearSpec;
use gearbench_reports::modes::LinearisedState;

/// Two and five inertias on springs: openTorsion's tests `test_shaft` and `test_friswell_ex971`, to printed digits, and the
/// closed form of two.
#[test]
fn chains_have_the_frequencies_of_opentorsion() {
    let (a, b, k) = (211.4, 8.3, 9.775e6_f64);
    let two = shaft(
        "two",
        vec![body(0.0, "a", a), body(1.0, "b", b)],
        vec![coupling(1.0, k)],
    );
    let f = frequencies(&mut build(&alone(vec![two]), &[], &contact(1e9)));
    let exact = (k * (1.0 / a + 1.0 / b)).sqrt() / TAU;
    println!("two inertias {f:?} Hz, exact {exact}");
    assert!((f[1] / exact - 1.0).abs() < 1e-12 && f[0] < 1e-6 * exact);
    assert!((f[1] - 176.1).abs() < 0.05);

    let inertias = [3.5e-3, 3.5e-3, 3.5e-3, 0.15, 0.05];
    let springs = [12e3, 12e3, 14e3, 10e3];
    let stations = (inertias.iter().enumerate())
        .map(|(i, inertia)| body(0.1 * i as f64, &format!("disc {i}"), *inertia));
    let sections = springs.map(|k| coupling(0.1, k));
    let five = shaft("five", stations.collect(), sections.to_vec());
    let f = frequencies(&mut build(&alone(vec![five]), &[], &contact(1e9)));
    println!("five inertias {f:?} Hz");
    for (f, printed) in f[1..].iter().zip([81.21, 141.21, 378.95, 536.36]) {
        assert!((f - printed).abs() < 0.005, "{f} for {printed}");
    }
}

/// Returns gears of module 4 mm at positions on the x axis; only ratios of radii, inertias and springs matter.
fn toothed(name: &str, teeth: u32, x: f64, inertia: f64) -> GearSpec {
    let mut g = gear(name, spur(teeth), x, 0.0);
    g.inertia = Some(inertia);
    g
}

/// Returns the frequencies of a train whose meshes have a stiffness [N/m], at preloaded contacts.
fn train(spec: &SceneSpec, mesh: f64) -> Vec<f64> {
    let models = vec![rigid(); spec.gears.len()];
    let width = 0.01;
    let mut scene = build(spec, &models, &contact(mesh / width));
    let s = scene.initial();
    squares(&mut scene, &s)
}

/// Returns the frequencies as `gearbench modes` computes them.
fn studied(spec: &SceneSpec, mesh: f64) -> Vec<f64> {
    let found = vibrations_of(spec, &rigid(), &contact(mesh / 0.01));
    assert_eq!(found.about, LinearisedState::Preloaded);
    let squares = found.modes.iter().map(|m| (TAU * m.frequency_hz).powi(2));
    let times = found.modes.iter().map(|m| m.multiplicity);
    squares.zip(times).flat_map(|(x, n)| vec![x; n]).collect()
}

/// Returns the limit of stiff meshes, for comparison with rigid constraint gears: squares of frequencies over 1/k,
/// extrapolated.
fn with_rigid_meshes(spec: &SceneSpec, mesh: f64, of: fn(&SceneSpec, f64) -> Vec<f64>) -> Vec<f64> {
    let [once, twice] = [mesh, 2.0 * mesh].map(|k| of(spec, k));
    let limit = once.iter().zip(&twice).map(|(a, b)| 2.0 * b - a);
    limit.map(|x| x.max(0.0).sqrt() / TAU).collect()
}

/// openTorsion's `friswell_pagex`: a motor, two equal gears, a rotor on each.
#[test]
fn an_idler_pair_has_the_frequencies_of_opentorsion() {
    let gears = vec![
        toothed("one", 30, 0.0, 25e-6),
        toothed("two", 30, 0.1201, 25e-6),
    ];
    let motor = shaft(
        "motor shaft",
        vec![
            body(0.0, "motor", 4e-4),
            on(0.1, 0),
            body(0.2, "first rotor", 7e-4),
        ],
        vec![coupling(0.1, 1e4), coupling(0.1, 5e3)],
    );
    let other = shaft(
        "other shaft",
        vec![on(0.0, 1), body(0.1, "second rotor", 7e-4)],
        vec![coupling(0.1, 5e3)],
    );
    let spec = SceneSpec {
        duration: f64::INFINITY,
        gears,
        meshes: vec![mesh([0, 1], start(Side::Left, -1e-7))],
        shafts: vec![motor, other],
        stages: Vec::new(),
    };
    let printed = [0.0, 425.359477, 634.072760, 3247.192354];
    for of in [train, studied] {
        let f = with_rigid_meshes(&spec, 1e11, of);
        println!("idler pair {f:?} Hz");
        // Printed digits are cut, not rounded.
        for (f, p) in f.iter().zip(printed).skip(1) {
            assert!((f - p).abs() < 1e-6, "{f} for {p}");
        }
        assert!(f[0] < 1e-2);
    }
}

/// Friswell's example 9.6.3 (a ship's turbine): a turbine, a pinion with two mates, one of them with a further wheel.
#[test]
fn a_turbine_train_has_the_frequencies_of_friswell() {
    // Shafts of 2.5 m x 0.2 m and 3.5 m x 0.25 m, G = 68 GPa, without mass.
    let material = Material {
        young: 2.0 * 68e9 * 1.3,
        poisson: 0.3,
        density: 0.0,
    };
    let gears = vec![
        toothed("pinion", 50, 0.0, 200.0),
        toothed("mate", 50, 0.2001, 200.0),
        toothed("wheel", 80, -0.2601, 800.0),
        toothed("far wheel", 80, 0.4602, 800.0),
    ];
    let long = || vec![bar(3.5, 0.25, material, 1)];
    let shafts = vec![
        shaft(
            "turbine shaft",
            vec![body(0.0, "turbine", 3200.0), on(2.5, 0)],
            vec![bar(2.5, 0.2, material, 1)],
        ),
        shaft(
            "first",
            vec![on(0.0, 2), body(3.5, "propeller", 450.0)],
            long(),
        ),
        shaft(
            "second",
            vec![on(0.0, 3), body(3.5, "other propeller", 450.0)],
            long(),
        ),
    ];
    let meshes = [[0, 1], [0, 2], [1, 3]].map(|g| mesh(g, start(Side::Left, -1e-7)));
    let spec = SceneSpec {
        duration: f64::INFINITY,
        gears,
        meshes: meshes.to_vec(),
        shafts,
        stages: Vec::new(),
    };
    let printed = [0.0, 10.30419334, 20.47926065, 24.42291926];
    for of in [train, studied] {
        let f = with_rigid_meshes(&spec, 1e14, of);
        println!("turbine train {f:?} Hz");
        for (f, p) in f.iter().zip(printed).skip(1) {
            assert!((f - p).abs() < 1e-8, "{f} for {p}");
        }
        assert!(f[0] < 1e-2);
    }
}

/// The torsional frequencies of a bar are `n c / (2 L)`, of second order in the length of the elements.
#[test]
fn a_free_bar_twists_at_its_frequencies() {
    let (length, material) = (0.8, Material::STEEL);
    let speed = (material.young / (2.0 * 1.3) / material.density).sqrt();
    let mut errors: Vec<[f64; 2]> = Vec::new();
    let counts = [4, 8, 16, 32];
    for n in counts {
        let bar = shaft("bar", vec![], vec![bar(length, 0.04, material, n)]);
        let f = frequencies(&mut build(&alone(vec![bar]), &[], &contact(1e9)));
        let of = |k: usize| (f[k] / (k as f64 * speed / (2.0 * length)) - 1.0).abs();
        errors.push([of(1), of(2)]);
    }
    println!("relative errors of two torsional frequencies by elements {counts:?}: {errors:?}");
    for k in 0..2 {
        let order = (errors[2][k] / errors[3][k]).log2();
        assert!((order - 2.0).abs() < 0.05, "order {order}");
    }
    assert!(errors[3][0] < 5e-4);
}

/// The shipped scene is compared with Holzer's frequencies of the same train with a rigid mesh.
#[test]
fn shipped_driveline() {
    let file = gearbench::scene_file::load(&Context::default(), "driveline").unwrap();
    let mut spec = file.spec.clone();
    spec.meshes[0].start.gap = -1e-7;
    let mut scene = Scene::build(&spec, &file.models[0].modelling, &models()).unwrap();
    let f = frequencies(&mut scene);
    println!("driveline {f:?} Hz");
    for (f, rigid) in f[1..3].iter().zip([178.2, 615.0]) {
        assert!(*f < rigid && *f > 0.99 * rigid, "{f} for {rigid}");
    }
}
