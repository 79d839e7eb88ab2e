//! `w = dg/dq`: the gap of every candidate against the contact row of both gears, by central differences, and
//! the gap rate `w . v` and what is prescribed against differences in time.

use gearbench_integrators::{Events, State};
use gearbench_models::contact::Candidate;
use gearbench_models::geometry::{
    Gear, GearParams, Modifications, Rack, RackParams, ReliefShape, Side, TipRelief,
};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Body, GearSpec, ModelSpec, Mount, Profile, SceneSpec, effective_radius,
};
use gearbench_tests::*;

/// Returns the largest error of the rows of all candidates relative to the largest entry, and the number of
/// candidates.
fn worst_row_error(scene: &Scene, s: &State) -> (f64, usize) {
    let found = candidates(scene, s);
    let (scale, _) = scales(scene);
    let mut worst = 0.0_f64;
    for (mesh, c) in &found {
        let w = contact_row(scene, s, *mesh, c);
        let largest = w.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for i in 0..s.q.len() {
            // Short, as flanks change their curvature where the edge of a tip begins to touch.
            let h = 0.005 * scale[i];
            let gap = |x: f64| {
                let mut moved = s.clone();
                moved.q[i] += x;
                same_candidate(scene, &moved, *mesh, c).map(|c| c.gap)
            };
            // A pair at the very end of its path may leave it under the difference.
            let (Some(above), Some(below)) = (gap(h), gap(-h)) else {
                continue;
            };
            worst = worst.max(((above - below) / (2.0 * h) - w[i]).abs() / largest);
        }
    }
    (worst, found.len())
}

/// Returns the sign of rotation: gears of a train rotate in alternate directions; a rack moves with its gear.
fn rolling_sign(index: usize, g: &GearSpec) -> f64 {
    if matches!(g.body, Body::Rack(_)) || index.is_multiple_of(2) {
        1.0
    } else {
        -1.0
    }
}

/// Returns a state with the gears rolled together by an angle of the first, and every coordinate displaced by
/// deflections.
fn rolled(scene: &mut Scene, spec: &SceneSpec, roll: f64, numbers: &mut Numbers) -> State {
    let mut s = scene.initial();
    let (sq, sv) = scales(scene);
    let r0 = effective_radius(&spec.gears[0].body);
    for (i, (g, sg)) in spec.gears.iter().zip(scene.gears()).enumerate() {
        let displacement = rolling_sign(i, g) * roll * r0 / effective_radius(&g.body);
        if sg.model.hub().coordinates() > 0 {
            sg.range().for_each(|i| s.q[i] += displacement);
        }
    }
    for i in 0..s.q.len() {
        s.q[i] += sq[i] * numbers.draw();
        s.v[i] += sv[i] * numbers.draw();
    }
    scene.commit(&mut s);
    s
}

/// Rotates a scene through some pitches and checks every candidate at each position.
fn check(name: &str, spec: &SceneSpec, models: &[ModelSpec], tolerance: f64) {
    let mut scene = build(spec, models, &contact(1.5e10));
    let mut numbers = Numbers::new(7);
    let (mut most, mut worst) = (0, 0.0_f64);
    for place in 0..16 {
        let s = rolled(
            &mut scene,
            spec,
            0.057 * f64::from(place) - 0.3,
            &mut numbers,
        );
        let (error, n) = worst_row_error(&scene, &s);
        worst = worst.max(error);
        most = most.max(n);
    }
    assert!(most >= 3, "{name}: only {most} candidates");
    assert!(
        worst <= tolerance,
        "{name}: rows off by {worst:.3e} of the effective_radius, tolerance {tolerance:.0e}"
    );
}

fn by_radius(model: ModelSpec) -> ModelSpec {
    let model = with(
        model,
        "stiffness_radius_m",
        vec![0.036, 0.040, 0.044, 0.062],
    );
    with(
        model,
        "stiffness_at_radius_n_per_m",
        vec![7e8, 6e8, 4e8, 3e8],
    )
}

#[test]
fn every_model_on_both_flanks_of_spur_gears() {
    for side in Side::BOTH {
        let mut spec = case_a(3e-6);
        spec.meshes[0].start = start(side, 3e-6);
        let teeth = movable(5.3e8, 4.8e-3, 20.0);
        for (name, models) in [
            ("rigid", [rigid(), rigid()]),
            ("movable", [teeth.clone(), teeth.clone()]),
            (
                "all teeth",
                [all_teeth(teeth.clone()), all_teeth(teeth.clone())],
            ),
            ("k(r)", [by_radius(teeth.clone()), by_radius(teeth.clone())]),
            ("elastic", [web(0.01), web(0.01)]),
            ("mixed", [web(0.0), teeth.clone()]),
        ] {
            check(&format!("{name} {side:?}"), &spec, &models, 2e-8);
        }
    }
}

fn modified(params: GearParams, modifications: Modifications) -> GearParams {
    GearParams {
        modifications,
        ..params
    }
}

#[test]
fn helical_and_modified_flanks_in_slices() {
    let tip = Gear::new(spur(20)).unwrap().r_tip();
    let relief = Modifications {
        tip_relief: Some(TipRelief {
            amount: 20e-6,
            start_radius: tip - 2e-3,
            shape: ReliefShape::Parabolic,
        }),
        profile_crowning: 5e-6,
        lead_crowning: 4e-6,
        ..Modifications::default()
    };
    let crowned = Modifications {
        profile_crowning: 8e-6,
        ..Modifications::default()
    };
    let helix = |beta: f64, z: u32| GearParams {
        helix_angle: beta,
        face_width: 0.02,
        ..spur(z)
    };
    let distance = 0.1001;
    let wide = distance / 15f64.to_radians().cos();
    for (name, a, b, x) in [
        (
            "relief",
            modified(spur(20), relief.clone()),
            modified(spur(30), crowned.clone()),
            distance,
        ),
        (
            "helical",
            helix(15f64.to_radians(), 20),
            helix(-15f64.to_radians(), 30),
            wide,
        ),
        (
            "helical with relief",
            modified(helix(-15f64.to_radians(), 20), relief),
            modified(helix(15f64.to_radians(), 30), crowned),
            wide,
        ),
    ] {
        for side in Side::BOTH {
            let spec = pair_of(
                gear("a", a.clone(), 0.0, 5.0),
                gear("b", b.clone(), x, 0.0),
                start(side, 3e-6),
            );
            for models in [
                [rigid(), rigid()],
                [movable(5e8, 5e-3, 0.0), movable(5e8, 5e-3, 0.0)],
                [web(0.0), rigid()],
            ] {
                check(
                    &format!("{name} {side:?} {}", models[0].id()),
                    &spec,
                    &models,
                    2e-6,
                );
            }
        }
    }
}

#[test]
fn gear_and_rack_on_both_flanks() {
    let helical_rack = || {
        let mut r = rack("rack", 40, 0.0401 / 10f64.to_radians().cos(), 0.0);
        let params = RackParams {
            teeth: 40,
            module: 4e-3,
            tip_radius: 0.3,
            helix_angle: -10f64.to_radians(),
            ..RackParams::default()
        };
        r.body = Body::Rack(Rack::new(params).unwrap());
        r
    };
    let helical_gear = GearParams {
        helix_angle: 10f64.to_radians(),
        ..spur(20)
    };
    for side in Side::BOTH {
        for (name, a, b) in [
            ("spur", spur(20), rack("rack", 40, 0.0401, 0.0)),
            ("helical", helical_gear.clone(), helical_rack()),
        ] {
            let spec = pair_of(gear("a", a, 0.0, 5.0), b, start(side, 3e-6));
            let teeth = movable(5e8, 5e-3, 10.0);
            for models in [
                [rigid(), rigid()],
                [teeth.clone(), teeth.clone()],
                [all_teeth(teeth.clone()), all_teeth(teeth.clone())],
                [web(0.0), rigid()],
            ] {
                check(
                    &format!("{name} {side:?} {}", models[0].id()),
                    &spec,
                    &models,
                    5e-8,
                );
            }
        }
    }
}

/// Returns three gears, the second meshing with both others at right angles, so that tooth flanks have arbitrary
/// angles.
fn idler_train() -> SceneSpec {
    let first = gear("first", spur(20), 0.0, 5.0);
    let idler = gear("idler", spur(30), 0.1001, 0.0);
    let mut last = gear("last", spur(24), 0.1001, 0.0);
    last.position[1] = 0.1082;
    SceneSpec {
        duration: f64::INFINITY,
        gears: vec![first, idler, last],
        meshes: vec![
            mesh([0, 1], start(Side::Left, 3e-6)),
            mesh([1, 2], start(Side::Right, 3e-6)),
        ],
        shafts: vec![],
        stages: Vec::new(),
    }
}

#[test]
fn an_idler_with_two_meshes() {
    let spec = idler_train();
    let teeth = movable(5e8, 5e-3, 10.0);
    for models in [
        [rigid(), rigid(), rigid()],
        [teeth.clone(), teeth.clone(), teeth.clone()],
        [rigid(), web(0.0), teeth.clone()],
    ] {
        check(&format!("idler {}", models[1].id()), &spec, &models, 5e-8);
    }
}

#[test]
fn gap_rate_holds_with_driven_gears() {
    // One gear or the other driven, ramp and table; movable teeth have coordinates on a driven hub as well.
    let ramp = Profile::Ramp {
        from: 3.0,
        to: 9.0,
        start: 0.0,
        end: 0.1,
    };
    let table = Profile::table(vec![0.0, 0.02, 0.3], vec![2.0, -4.0, 6.0]);
    let teeth = movable(5e8, 5e-3, 10.0);
    for driven in 0..2 {
        for profile in [ramp.clone(), table.clone()] {
            for (first, second) in [
                (rigid(), rigid()),
                (teeth.clone(), rigid()),
                (web(0.0), teeth.clone()),
            ] {
                for with_rack in [false, true] {
                    let mut spec = case_a(3e-6);
                    if with_rack {
                        spec.gears[1] = rack("wheel", 40, 0.0401, 0.0);
                    }
                    spec.gears[driven].mount = Mount::Driven(profile.clone());
                    let models = [first.clone(), second.clone()];
                    let scene = build(&spec, &models, &contact(1.5e10));
                    let mut numbers = Numbers::new(3);
                    let (sq, _) = scales(&scene);
                    let mut s = scene.initial();
                    s.t = 0.05;
                    for i in 0..s.q.len() {
                        s.q[i] += sq[i] * numbers.draw();
                        s.v[i] += numbers.draw();
                    }
                    let h = 1e-7;
                    let gap = |dt: f64, mesh: usize, c: &Candidate| {
                        let mut moved = s.clone();
                        moved.t += dt;
                        for i in 0..s.q.len() {
                            moved.q[i] += dt * s.v[i];
                        }
                        same_candidate(&scene, &moved, mesh, c).map(|c| c.gap)
                    };
                    let mut seen = 0;
                    for (mesh, c) in candidates(&scene, &s) {
                        let (w, prescribed) = row_and_rate(&scene, &s, mesh, &c);
                        let own: f64 = w.iter().zip(&s.v).map(|(w, v)| w * v).sum();
                        let rate = own + prescribed;
                        let (Some(above), Some(below)) = (gap(h, mesh, &c), gap(-h, mesh, &c))
                        else {
                            continue;
                        };
                        let by_difference = (above - below) / (2.0 * h);
                        assert!(
                            (by_difference - rate).abs() <= 1e-7 * (1.0 + rate.abs()),
                            "{} {} driven {driven}, rack {with_rack}: {rate} but {by_difference}",
                            models[0].id(),
                            models[1].id()
                        );
                        seen += 1;
                    }
                    assert!(seen >= 2);
                }
            }
        }
    }
}
