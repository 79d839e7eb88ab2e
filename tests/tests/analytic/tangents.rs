//! `tangent_times` compared with differences of the force; `correction` compares `correct` with the dense inverse of
//! `m M + d D + k K`.

mod correction;

use correction::{COEFFICIENTS, correct_error};
use gearbench_integrators::{Events, SecondOrderSystem, State};
use gearbench_models::law::{Damping, Friction};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    ContactSpec, FlankContact, Load, ModelSpec, effective_radius, mesh_layout,
};
use gearbench_models::stiffness::{Ends, Interpolation, IsoVariation, PairOrMesh, PairStiffness};
use gearbench_tests::*;

fn laws() -> Vec<(f64, Damping)> {
    vec![
        (1.0, Damping::None),
        (1.5, Damping::None),
        (10.0 / 9.0, Damping::None),
        (1.0, Damping::KelvinVoigt { c: 300.0 }),
        (1.0, Damping::KelvinVoigtRatio { ratio: 0.1 }),
        (1.5, Damping::Flores { e: 0.7 }),
        (1.0, Damping::Gonthier { e: 0.8 }),
        (1.5, Damping::HuntCrossley { e: 0.9 }),
        (1.0, Damping::LankaraniNikravesh { e: 0.6 }),
    ]
}

fn stiffnesses() -> Vec<PairStiffness> {
    let s: Vec<f64> = (0..9).map(|i| 4e-3 + 2e-3 * f64::from(i)).collect();
    let k = vec![
        1.1e8, 1.2e8, 1.4e8, 1.5e8, 1.6e8, 1.5e8, 1.35e8, 1.2e8, 1.15e8,
    ];
    vec![
        PairStiffness::Constant {
            per_width: 1.5e10,
            of: PairOrMesh::Pair,
        },
        PairStiffness::Iso6336 {
            variation: IsoVariation::IsoMean,
        },
        PairStiffness::Parabola {
            per_width: 1.5e10,
            along: [0.6, -0.3],
            of: PairOrMesh::Pair,
        },
        PairStiffness::Table {
            s,
            k,
            of: PairOrMesh::Pair,
            ends: Ends::Clamped,
            interpolation: Interpolation::Cubic,
        },
    ]
}

fn pairs() -> Vec<[ModelSpec; 2]> {
    let teeth = movable(5.3e8, 4.8e-3, 20.0);
    vec![
        [rigid(), rigid()],
        [teeth.clone(), teeth.clone()],
        [all_teeth(teeth.clone()), rigid()],
        [web(0.02), web(0.02)],
        [web(0.02), teeth.clone()],
        [rigid(), web(0.02)],
    ]
}

/// Returns a scene with overlapping flanks that approach, both gears with a viscous load, with or without event
/// location.
fn pressed(
    models: &[ModelSpec; 2],
    contact: &ContactSpec,
    located: bool,
    depth: f64,
) -> (Scene, State) {
    pressed_at(models, contact, located, depth, None)
}

/// Returns the same scene with the pair of the start at another position on the path, or before it [m].
fn pressed_at(
    models: &[ModelSpec; 2],
    contact: &ContactSpec,
    located: bool,
    depth: f64,
    along: Option<f64>,
) -> (Scene, State) {
    let mut spec = case_a(0.0);
    spec.gears[1].loads = vec![Load::Viscous(0.3)];
    spec.gears[0].loads = vec![Load::Viscous(0.2)];
    let path = mesh_layout(&spec.gears[0], &spec.gears[1]).unwrap().path;
    spec.meshes[0].start.path_coordinate = along.map(|x| path[0] + x.max(0.0));
    let mut scene = build(&spec, models, contact);
    let mut s = scene.initial();
    let mut numbers = Numbers::new(11);
    let (sq, sv) = scales(&scene);
    for i in 0..s.q.len() {
        s.q[i] += 0.02 * sq[i] * numbers.draw();
        s.v[i] += 0.02 * sv[i] * numbers.draw();
    }
    // Back before the start of the path, both gears together.
    if let Some(back) = along.filter(|x| *x < 0.0) {
        let radii = [0, 1].map(|i| effective_radius(&spec.gears[i].body));
        for (g, sign) in [(0, 1.0), (1, -1.0)] {
            let range = scene.gears()[g].range();
            range.for_each(|i| s.q[i] += sign * back / radii[g]);
        }
    }
    // Hub and teeth of the pinion go forward by the depth.
    let range = scene.gears()[0].range();
    range.for_each(|i| s.q[i] += depth / 0.0376);
    scene.begin(&mut s, located);
    (scene, s)
}

fn force(scene: &mut Scene, s: &State) -> Vec<f64> {
    let mut f = vec![0.0; s.q.len()];
    scene.force(s.at(), &mut f);
    f
}

/// Returns the largest error of the tangent in some directions relative to the size of the change.
fn tangent_error(scene: &mut Scene, s: &State) -> f64 {
    let (sq, sv) = scales(scene);
    let mut numbers = Numbers::new(5);
    let n = s.q.len();
    let mut worst = 0.0_f64;
    for direction in 0..6 {
        let mut dq = numbers.vector(&sq);
        let mut dv = numbers.vector(&sv);
        match direction {
            0 => dq.fill(0.0),
            1 => dv.fill(0.0),
            _ => {}
        }
        let mut df = vec![0.0; n];
        scene.tangent_times(s.at(), &dq, &dv, &mut df);
        let h = 1e-4;
        let moved = |x: f64| {
            let mut m = s.clone();
            for i in 0..n {
                m.q[i] += x * dq[i];
                m.v[i] += x * dv[i];
            }
            m
        };
        let (above, below) = (force(scene, &moved(h)), force(scene, &moved(-h)));
        let size = df.iter().fold(1e-6_f64, |m, x| m.max(x.abs()));
        for i in 0..n {
            worst = worst.max(((above[i] - below[i]) / (2.0 * h) - df[i]).abs() / size);
        }
    }
    worst
}

#[test]
fn tangent_is_the_derivative_of_the_force() {
    let frictions = [None, Some(Friction::new(0.08, 0.02).unwrap())];
    let mut cases = 0;
    for models in pairs() {
        for stiffness in stiffnesses() {
            for (exponent, damping) in laws() {
                for friction in frictions {
                    let contact = ContactSpec {
                        stiffness: stiffness.clone(),
                        exponent,
                        damping,
                        normal_force: None,
                        friction,
                        slices: None,
                        flanks: FlankContact::Toothing,
                    };
                    for located in [false, true] {
                        let (mut scene, s) = pressed(&models, &contact, located, 3e-6);
                        let touching = channel(&mut scene, &s, "force:0");
                        assert!(
                            touching > 0.1,
                            "{} {damping:?} {located}: {touching} N",
                            models[0].id()
                        );
                        let error = tangent_error(&mut scene, &s);
                        assert!(
                            error < 2e-6,
                            "{} {}, {}, exponent {exponent}, {damping:?}, friction {}, located {located}: {error:.2e}",
                            models[0].id(),
                            models[1].id(),
                            stiffness.id(),
                            friction.is_some()
                        );
                        cases += 1;
                    }
                }
            }
        }
    }
    assert_eq!(cases, 6 * 4 * 9 * 2 * 2);
}

/// Two pairs that bend one body, on the path and with the edge of a tip before it: the tangent is complete, and the Newton
/// correction its inverse.
#[test]
fn coupled_pairs_and_edges_of_tips_have_their_tangent() {
    let teeth = movable(5.3e8, 4.8e-3, 20.0);
    let of_edge = |scene: &Scene, s: &State| {
        let found = candidates(scene, s);
        let pressed: Vec<_> = found.iter().filter(|(_, c)| c.gap < 0.0).collect();
        assert!(pressed.len() > 1, "{} pairs", pressed.len());
        pressed.iter().any(|(_, c)| c.curvature != [0.0; 2])
    };
    for models in [
        [rigid(), rigid()],
        [teeth.clone(), teeth.clone()],
        [rigid(), web(0.02)],
    ] {
        for damping in [Damping::None, Damping::KelvinVoigt { c: 300.0 }] {
            for (along, edge) in [(1e-3, false), (-2e-4, true)] {
                for located in [false, true] {
                    let contact = ContactSpec {
                        stiffness: weber_banaschek(),
                        damping,
                        friction: Some(Friction::new(0.08, 0.02).unwrap()),
                        ..contact(1.5e10)
                    };
                    let (mut scene, s) = pressed_at(&models, &contact, located, 8e-6, Some(along));
                    let what = format!(
                        "{} {}, {damping:?}, {along}, located {located}",
                        models[0].id(),
                        models[1].id()
                    );
                    assert_eq!(of_edge(&scene, &s), edge, "{what}");
                    let error = tangent_error(&mut scene, &s);
                    assert!(error < 2e-5, "{what}: {error:.2e}");
                    for c in COEFFICIENTS {
                        let error = correct_error(&mut scene, &s, c);
                        assert!(error < 1e-8, "{what}, {c:?}: {error:.2e}");
                    }
                }
            }
        }
    }
}

#[test]
fn closed_contacts_continue_smoothly_into_the_gap() {
    // A located contact that is closed keeps its branch on the far side of zero, so that a root can be sought.
    for models in pairs() {
        for (exponent, damping) in laws() {
            let contact = ContactSpec {
                exponent,
                damping,
                ..contact(1.5e10)
            };
            let (mut scene, mut s) = pressed(&models, &contact, true, 3e-6);
            let first = scene.gears()[0].range();
            first.for_each(|i| s.q[i] -= 5e-6 / 0.0376);
            let found = candidates(&scene, &s);
            assert!(found.iter().all(|(_, c)| c.gap > 0.0));
            let error = tangent_error(&mut scene, &s);
            assert!(
                error < 2e-6,
                "{} {exponent} {damping:?}: {error:.2e}",
                models[0].id()
            );
        }
    }
}
