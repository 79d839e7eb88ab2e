//! Tangents compared with differences, the Newton correction with the dense inverse, and repeatability.

use super::*;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::Coeffs;
use gearbench_models::law::Friction;

/// Returns scenes of elastic gears in contact, with descriptions.
fn touching() -> Vec<(&'static str, Scene, State)> {
    let mut all = Vec::new();
    let elastic = || toy(13, 3, 6, 2e-9);
    let damped = PointContact::new(1e15).damped(2e8);
    let rubbing = Some(Friction::new(0.3, 0.5).unwrap());
    for (name, models, points, exponent, friction) in [
        (
            "linear",
            [elastic(), elastic()],
            PointContact::new(1e15),
            1.0,
            None,
        ),
        ("damped", [elastic(), elastic()], damped, 1.0, None),
        ("rubbing", [elastic(), elastic()], damped, 1.0, rubbing),
        (
            "rubbing on movable teeth",
            [elastic(), movable(5.3e8, 4.8e-3, 0.0)],
            PointContact::new(1e15),
            1.0,
            rubbing,
        ),
        (
            "rubbing without residual compliance",
            [toy(13, 3, 6, 0.0), toy(13, 3, 6, 0.0)],
            PointContact::new(1e15),
            1.0,
            rubbing,
        ),
        (
            "exponent 1.5",
            [elastic(), elastic()],
            PointContact::new(4e17),
            1.5,
            None,
        ),
        (
            "without residual compliance",
            [toy(13, 3, 6, 0.0), toy(13, 3, 6, 0.0)],
            PointContact::new(1e15),
            1.0,
            None,
        ),
        (
            "with movable teeth",
            [elastic(), movable(5.3e8, 4.8e-3, 0.0)],
            PointContact::new(1e15),
            1.0,
            None,
        ),
        (
            "with nodes on springs",
            [nodes_on_springs(5), elastic()],
            PointContact::new(1e15),
            1.0,
            None,
        ),
    ] {
        let points = PointContact {
            rule: quadrature(6, 2),
            ..points
        };
        let contact = ContactSpec {
            exponent,
            friction,
            ..with_points(points)
        };
        let spec = case_a(-12e-6);
        let scene = build(&spec, &models, &contact);
        let mut s = scene.initial();
        deform(&scene, &mut s, 3e-6, 3);
        all.push((name, scene, s));
    }
    all
}

/// Differences of the force along random directions, gear by gear: the tangent leaves out how normals and effective
/// base radius arms turn, overlap over the radius of curvature.
#[test]
fn the_tangent_is_the_derivative_of_the_force() {
    for (name, mut scene, s) in touching() {
        assert!(scene.contact_forces(s.at()).len() > 1, "{name}");
        let (sq, sv) = scales(&scene);
        let gears: Vec<_> = scene.gears().iter().map(|g| g.range()).collect();
        let mut numbers = Numbers::new(5);
        let mut worst = 0.0_f64;
        for direction in 0..6 {
            // Of velocities alone: forces change by little, and are smooth over a part of the regularisation speed.
            let small = if direction == 0 {
                1e-2
            } else {
                1e-9 / scene.magnitudes().deflection
            };
            let mut dq = numbers.vector(&sq);
            let mut dv = numbers.vector(&sv);
            match direction {
                0 => dq.fill(0.0),
                1 => dv.fill(0.0),
                _ => {}
            }
            let mut df = vec![0.0; s.q.len()];
            scene.tangent_times(s.at(), &dq, &dv, &mut df);
            let mut moved = |x: f64| {
                let mut m = s.clone();
                for i in 0..m.q.len() {
                    m.q[i] += x * dq[i];
                    m.v[i] += x * dv[i];
                }
                force(&mut scene, &m)
            };
            let (above, below) = (moved(small), moved(-small));
            for range in &gears {
                let work = |i: usize, x: f64| (x * sq[i]).abs();
                let size = range.clone().fold(1e-12_f64, |m, i| m.max(work(i, df[i])));
                for i in range.clone() {
                    let slope = (above[i] - below[i]) / (2.0 * small);
                    worst = worst.max(work(i, slope - df[i]) / size);
                }
            }
        }
        println!("{name}: tangent off by {worst:.1e}");
        assert!(worst < 3e-3, "{name}: {worst:.2e}");
    }
}

#[test]
fn the_correction_is_the_inverse_of_the_newton_matrix() {
    let choices = [(1.0, 0.0, 0.0), (1.0, 5e-7, 2.5e-13), (1.0, 1e-5, 1e-10)];
    for (name, mut scene, s) in touching() {
        let n = s.q.len();
        let (sq, _) = scales(&scene);
        for (m, d, k) in choices {
            let c = Coeffs { m, d, k };
            let mut a = vec![0.0; n * n];
            for j in 0..n {
                let unit =
                    |x: f64| -> Vec<f64> { (0..n).map(|i| if i == j { x } else { 0.0 }).collect() };
                let (mut df, mut mass) = (vec![0.0; n], vec![0.0; n]);
                scene.tangent_times(s.at(), &unit(k), &unit(d), &mut df);
                scene.apply_mass(s.at(), &unit(m), &mut mass);
                for i in 0..n {
                    a[i * n + j] = (mass[i] - df[i]) * sq[i] * sq[j];
                }
            }
            let mut numbers = Numbers::new(23);
            let mut want = numbers.vector(&vec![1.0; n]);
            let mut rhs = vec![0.0; n];
            for i in 0..n {
                let line = &a[i * n..][..n];
                rhs[i] = line.iter().zip(&want).map(|(a, x)| a * x).sum::<f64>();
            }
            let mut x: Vec<f64> = rhs.iter().zip(&sq).map(|(r, s)| r / s).collect();
            scene.correct(s.at(), c, &mut x).unwrap();
            solve_in_place(&mut a, &mut rhs).unwrap();
            want.copy_from_slice(&rhs);
            let error = (0..n).fold(0.0_f64, |e, i| e.max((x[i] / sq[i] - want[i]).abs()));
            println!("{name}, {c:?}: correction off by {error:.1e}");
            assert!(error < 1e-8, "{name}, {c:?}: {error:.2e}");
        }
    }
}

/// Equal states give equal bits, whatever was evaluated before: the solve starts from the last result, but its own is
/// that of the final set of closed points.
#[test]
fn forces_repeat_bit_for_bit() {
    for (name, mut scene, s) in touching() {
        let first = force(&mut scene, &s);
        let mut numbers = Numbers::new(9);
        let (sq, _) = scales(&scene);
        for round in 0..40 {
            let mut other = s.clone();
            let size = [1e-3, 0.1, 1.0, 10.0][round % 4];
            for (q, d) in other.q.iter_mut().zip(numbers.vector(&sq)) {
                *q += size * d;
            }
            force(&mut scene, &other);
            assert_eq!(first, force(&mut scene, &s), "{name}, round {round}");
        }
    }
}
