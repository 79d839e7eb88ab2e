//! `tangent_times` against differences of the force, and `correct` against the dense inverse of
//! `m M + d D + k K`.

use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::{Coeffs, Events, SecondOrderSystem, State};
use gearbench_models::Vec3;
use gearbench_models::kinematics::Row;
use gearbench_models::law::{Damping, Friction};
use gearbench_models::scene::Scene;
use gearbench_models::spec::{ContactSpec, Load, ModelSpec, effective_radius, mesh_layout};
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

/// A scene pressed together by some deflections and approaching, both with a viscous load, located or not.
fn pressed(
    models: &[ModelSpec; 2],
    contact: &ContactSpec,
    located: bool,
    depth: f64,
) -> (Scene, State) {
    pressed_at(models, contact, located, depth, None)
}

/// The same with the pair of the start somewhere else on the path, or before it [m].
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

/// Largest error of the tangent in some directions over the size of the change.
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
                        friction,
                        slices: None,
                        points: None,
                    };
                    for located in [false, true] {
                        let (mut scene, s) = pressed(&models, &contact, located, 3e-6);
                        let touching = channel(&mut scene, &s, "force:0");
                        assert!(
                            touching > 0.1,
                            "{} {damping:?} {located}: {touching} N",
                            models[0].id
                        );
                        let error = tangent_error(&mut scene, &s);
                        assert!(
                            error < 2e-6,
                            "{} {}, {}, exponent {exponent}, {damping:?}, friction {}, located {located}: {error:.2e}",
                            models[0].id,
                            models[1].id,
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
                        models[0].id, models[1].id
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
                models[0].id
            );
        }
    }
}

const COEFFICIENTS: [Coeffs; 3] = [
    Coeffs {
        m: 1.0,
        d: 3e-7,
        k: 1e-13,
    },
    Coeffs {
        m: 1.0,
        d: 4e-5,
        k: 2e-9,
    },
    Coeffs {
        m: 1.0,
        d: 1e-3,
        k: 1e-6,
    },
];

/// What turning sliding forces add to `K`: `-F (dt/ds) (ds/dq)` of each contact, as a full matrix.
fn turning(scene: &mut Scene, s: &State) -> Vec<f64> {
    let n = s.q.len();
    let mut k = vec![0.0; n * n];
    for contact in scene.contact_forces(s.at()) {
        let Some((mesh, c)) = candidates(scene, s).into_iter().find(|(m, c)| {
            *m == contact.mesh
                && c.points[0].x == contact.x
                && c.points[0].tooth == contact.teeth[0]
        }) else {
            continue;
        };
        let t = Vec3::new(-c.normal.y, c.normal.x, 0.0);
        let friction = contact.force.dot(&t);
        let row_at = |shift: f64, n: &Vec3, gears: &[(usize, f64)]| {
            let mut row = Row::default();
            row.clear();
            for &(k, sign) in gears {
                let g = &scene.gears()[scene.meshes()[mesh].gears[k]];
                let mut p = c.points[k];
                p.x += shift * c.normal;
                row.target(g.range().start, sign);
                g.model.row(g.at(s.at()), &p, n, &mut row);
            }
            let mut w = vec![0.0; s.q.len()];
            row.add_to(1.0, &mut w);
            w
        };
        let both = [(0, -1.0), (1, 1.0)];
        let (here, there) = (row_at(0.0, &t, &both), row_at(1.0, &t, &both));
        let path = row_at(0.0, &c.normal, &[(0, 0.5), (1, 0.5)]);
        for i in 0..n {
            for j in 0..n {
                k[i * n + j] -= friction * (there[i] - here[i]) * path[j];
            }
        }
    }
    k
}

/// Largest difference of `correct` and a dense elimination without the turning of sliding forces, relative to
/// the solution.
fn correct_error(scene: &mut Scene, s: &State, c: Coeffs) -> f64 {
    let mut numbers = Numbers::new(23);
    let n = s.q.len();
    let (sq, _) = scales(scene);
    // A right-hand side with a solution of the size of the scales, or Newton's would not look like that.
    let mut rhs = vec![0.0; n];
    scene.apply_mass(s.at(), &numbers.vector(&sq), &mut rhs);
    let mut x = rhs.clone();
    scene.correct(s.at(), c, &mut x).unwrap();

    let mut a = turning(scene, s);
    a.iter_mut().for_each(|x| *x *= -c.k);
    for j in 0..n {
        let unit = |x: f64| -> Vec<f64> { (0..n).map(|i| if i == j { x } else { 0.0 }).collect() };
        let (mut df, mut m) = (vec![0.0; n], vec![0.0; n]);
        scene.tangent_times(s.at(), &unit(c.k), &unit(c.d), &mut df);
        scene.apply_mass(s.at(), &unit(c.m), &mut m);
        for i in 0..n {
            a[i * n + j] += m[i] - df[i];
        }
    }
    let mut dense = rhs;
    solve_in_place(&mut a, &mut dense).unwrap();
    // Coordinates have different units: measure each against its scale.
    let size = (0..n).fold(0.0_f64, |m, i| m.max(dense[i].abs() / sq[i]));
    (0..n).fold(0.0_f64, |m, i| m.max((x[i] - dense[i]).abs() / sq[i])) / size
}

#[test]
fn correction_is_the_inverse_of_the_newton_matrix() {
    for models in pairs() {
        for stiffness in stiffnesses() {
            for (exponent, damping) in laws() {
                for located in [false, true] {
                    for depth in [3e-6, -3e-6] {
                        let contact = ContactSpec {
                            stiffness: stiffness.clone(),
                            exponent,
                            damping,
                            friction: None,
                            slices: None,
                            points: None,
                        };
                        let (mut scene, s) = pressed(&models, &contact, located, depth);
                        for c in COEFFICIENTS {
                            let error = correct_error(&mut scene, &s, c);
                            assert!(
                                error < 1e-8,
                                "{} {}, {}, {exponent}, {damping:?}, located {located}, depth {depth}, {c:?}: {error:.2e}",
                                models[0].id,
                                models[1].id,
                                stiffness.id()
                            );
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn correction_with_friction_leaves_out_only_the_turning_of_the_sliding_force() {
    for models in pairs() {
        for (exponent, damping) in laws() {
            let friction = Some(Friction::new(0.08, 0.02).unwrap());
            let contact = ContactSpec {
                exponent,
                damping,
                friction,
                ..contact(1.5e10)
            };
            for located in [false, true] {
                let (mut scene, s) = pressed(&models, &contact, located, 3e-6);
                for c in COEFFICIENTS {
                    let error = correct_error(&mut scene, &s, c);
                    let name = &models[0].id;
                    assert!(
                        error < 1e-8,
                        "{name}, {exponent}, {damping:?}, located {located}, {c:?}: {error:.2e}"
                    );
                }
            }
        }
    }
}
