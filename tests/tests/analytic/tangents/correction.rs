//! `correct` compared with the dense inverse of `m M + d D + k K`.

use super::{laws, pairs, pressed, stiffnesses};
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::{Coeffs, SecondOrderSystem, State};
use gearbench_models::Vec3;
use gearbench_models::kinematics::Row;
use gearbench_models::law::Friction;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{ContactSpec, FlankContact};
use gearbench_tests::*;

pub(super) const COEFFICIENTS: [Coeffs; 3] = [
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

/// Returns the contribution of rotating sliding forces to `K`: `-F (dt/ds) (ds/dq)` of each contact, as a full matrix.
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

/// Returns the largest difference of `correct` and a dense elimination without the rotation of sliding forces,
/// relative to the solution.
pub(super) fn correct_error(scene: &mut Scene, s: &State, c: Coeffs) -> f64 {
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
                            normal_force: None,
                            friction: None,
                            slices: None,
                            flanks: FlankContact::Toothing,
                        };
                        let (mut scene, s) = pressed(&models, &contact, located, depth);
                        for c in COEFFICIENTS {
                            let error = correct_error(&mut scene, &s, c);
                            assert!(
                                error < 1e-8,
                                "{} {}, {}, {exponent}, {damping:?}, located {located}, depth {depth}, {c:?}: {error:.2e}",
                                models[0].id(),
                                models[1].id(),
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
                    let name = &models[0].id();
                    assert!(
                        error < 1e-8,
                        "{name}, {exponent}, {damping:?}, located {located}, {c:?}: {error:.2e}"
                    );
                }
            }
        }
    }
}
