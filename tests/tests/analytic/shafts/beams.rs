//! Shafts that bend: exact deflections, the frequencies of Timoshenko's beam, momentum in space.

use super::*;
use gearbench_integrators::{Resolution, TimePlan};
use gearbench_models::Vec3;
use gearbench_models::spec::{Bearing, Freedom, Mount, OutOfPlaneSpec};
use nalgebra::{Matrix2, Matrix4};
use std::f64::consts::PI;

const D: f64 = 0.05;

/// Returns area, second moment, shear modulus and shear coefficient of a round steel bar.
fn properties(m: &Material) -> [f64; 4] {
    let nu = m.poisson;
    [
        0.25 * PI * D * D,
        PI / 64.0 * D.powi(4),
        m.young / (2.0 * (1.0 + nu)),
        6.0 * (1.0 + nu) / (7.0 + 6.0 * nu),
    ]
}

/// Returns a body with the freedom of an [`OutOfPlaneSpec`].
fn sideways(place: f64, name: &str, directions: [Freedom; 6], bearing: Bearing) -> Station {
    let mut body = BodySpec::new(name, 0.0);
    body.lateral = Some(Box::new(OutOfPlaneSpec {
        directions,
        bearing,
        ..OutOfPlaneSpec::default()
    }));
    Station {
        place,
        carries: StationMember::Body(Box::new(body)),
    }
}

const FREE: [Freedom; 6] = [const { Freedom::Free }; 6];
const HELD: [Freedom; 6] = [const { Freedom::Fixed }; 6];

fn free_beam(length: f64, divisions: usize) -> SceneSpec {
    let stations = vec![sideways(0.0, "end", FREE, Bearing::default())];
    let sections = vec![bar(length, D, Material::STEEL, divisions)];
    alone(vec![shaft("beam", stations, sections)])
}

/// `P L^3 / 3 E I + P L / kappa G A` at the tip, and its slope, for any number of elements; stretching and twist beside.
#[test]
fn a_cantilever_bends_exactly() {
    let (length, force) = (0.3, 1e4);
    let m = Material::STEEL;
    let [area, second, g, kappa] = properties(&m);
    for n in [1, 3, 8] {
        let mut wall = sideways(0.0, "wall", HELD, Bearing::default());
        if let StationMember::Body(body) = &mut wall.carries {
            body.mount = Mount::Fixed;
        }
        let stations = vec![wall, sideways(length, "tip", FREE, Bearing::default())];
        let spec = alone(vec![shaft(
            "cantilever",
            stations,
            vec![bar(length, D, m, n)],
        )]);
        let mut scene = build(&spec, &[], &contact(1e9));
        let s = scene.initial();
        let tip = scene.gears()[1].range().start;
        // Own turn first, then x, y, z and tilts.
        let exact = |d: usize| match d {
            0 => force * length / (g * 2.0 * second),
            1 | 2 => {
                force * length.powi(3) / (3.0 * m.young * second)
                    + force * length / (kappa * g * area)
            }
            3 => force * length / (m.young * area),
            _ => force * length / (m.young * second),
        };
        for d in 0..6 {
            let mut x = vec![0.0; s.q.len()];
            x[tip + d] = force;
            let c = Coeffs {
                m: 0.0,
                d: 0.0,
                k: 1.0,
            };
            scene.correct(s.at(), c, &mut x).unwrap();
            let error = (x[tip + d] / exact(d) - 1.0).abs();
            println!("{n} elements, direction {d}: {error:.1e} off");
            assert!(error < 1e-9, "{n} {d}: {} for {}", x[tip + d], exact(d));
            if d == 1 {
                let slope = force * length.powi(2) / (2.0 * m.young * second);
                assert!((x[tip + 5] / slope - 1.0).abs() < 1e-9);
            }
        }
    }
}

/// Returns the residual of moment and shear at the far end of a free Timoshenko beam: the determinant of the transfer
/// matrix of `w' = phi + V/(kappa G A)`, `phi' = M/(E I)`, `M' = -V - rho I w^2 phi`, `V' = -rho A w^2 w`.
fn free_end(omega: f64, length: f64) -> f64 {
    let m = Material::STEEL;
    let [area, second, g, kappa] = properties(&m);
    let w2 = omega * omega;
    // Lengths in metres, moments over E I.
    let (ei, ga) = (m.young * second, kappa * g * area);
    let a = Matrix4::new(
        0.0,
        1.0,
        0.0,
        ei / ga, //
        0.0,
        0.0,
        1.0,
        0.0, //
        0.0,
        -m.density * second * w2 / ei,
        0.0,
        -1.0, //
        -m.density * area * w2 / ei,
        0.0,
        0.0,
        0.0,
    );
    let t = (a * length).exp();
    Matrix2::new(t[(2, 0)], t[(2, 1)], t[(3, 0)], t[(3, 1)]).determinant()
}

/// Returns the natural frequencies of the free beam [Hz].
fn exact_bending(length: f64, count: usize) -> Vec<f64> {
    let mut found = Vec::new();
    let step = 20.0 * TAU / 20.0;
    let mut w = 50.0 * TAU;
    while found.len() < count {
        let (mut a, mut b) = (w, w + step);
        if free_end(a, length).signum() != free_end(b, length).signum() {
            for _ in 0..100 {
                let c = 0.5 * (a + b);
                if free_end(a, length).signum() == free_end(c, length).signum() {
                    a = c;
                } else {
                    b = c;
                }
            }
            found.push(0.5 * (a + b) / TAU);
        }
        w += step;
    }
    found
}

/// The free beam of 50 x 1000 mm: six motions without stiffness, bending twice in either plane, torsion and stretching; of
/// second order.
#[test]
fn a_free_beam_has_timoshenkos_frequencies() {
    let length = 1.0;
    let m = Material::STEEL;
    let bending = exact_bending(length, 2);
    let torsion = (m.young / 2.6 / m.density).sqrt() / (2.0 * length);
    let stretching = (m.young / m.density).sqrt() / (2.0 * length);
    let exact = [bending[0], bending[0], bending[1], bending[1]];
    println!("exact: bending {bending:?}, torsion {torsion}, stretching {stretching} Hz");
    // Without shear and rotary inertia bending is a little faster: 22.3733 sqrt(E I / rho A) / L^2.
    let slender = 22.3733 / TAU * (m.young / m.density).sqrt() * D / 4.0;
    assert!(bending[0] < slender && bending[0] > 0.98 * slender);
    let mut errors = Vec::new();
    for n in [8, 16, 32] {
        let f = frequencies(&mut build(&free_beam(length, n), &[], &contact(1e9)));
        assert!(f[5] < 1e-3 * f[6], "{f:?}");
        println!("{n} elements: {:?} Hz", &f[6..12]);
        assert!((f[6] / f[7] - 1.0).abs() < 1e-9 && (f[8] / f[9] - 1.0).abs() < 1e-9);
        let of: Vec<f64> = (f[6..10].iter().zip(exact))
            .map(|(f, e)| (f / e - 1.0).abs())
            .collect();
        let near = |want: f64| {
            let off = f.iter().map(|f| (f / want - 1.0).abs());
            off.fold(f64::INFINITY, f64::min)
        };
        errors.push([of[0], of[2], near(torsion), near(stretching)]);
    }
    println!("relative errors: {errors:?}");
    for k in 0..4 {
        let order = (errors[1][k] / errors[2][k]).log2();
        assert!((order - 2.0).abs() < 0.1, "{k}: order {order}");
        assert!(errors[2][k] < 6e-3);
    }
}

/// A rotor on two bearings: pinned ends, `pi^2 sqrt(E I / rho A) / L^2` less shear and rotary inertia; of fourth order
/// where the ends do not move.
#[test]
fn a_beam_on_bearings_whirls_at_its_frequency() {
    let length = 1.0;
    let m = Material::STEEL;
    let [area, second, g, kappa] = properties(&m);
    let mut held = FREE;
    for d in [0, 1, 2] {
        held[d] = Freedom::Fixed;
    }
    // With k = pi / L: rho^2 I/(kappa G) w^4 - (rho A + k^2 rho I (1 + E/(kappa G))) w^2 + E I k^4 = 0.
    let k2 = (PI / length).powi(2);
    let a = m.density.powi(2) * second / (kappa * g);
    let b = m.density * (area + k2 * second * (1.0 + m.young / (kappa * g)));
    let c = m.young * second * k2 * k2;
    let exact = (2.0 * c / (b + (b * b - 4.0 * a * c).sqrt())).sqrt() / TAU;
    let mut errors = Vec::new();
    for n in [4, 8, 16] {
        let stations = vec![
            sideways(0.0, "left", held.clone(), Bearing::default()),
            sideways(length, "right", held.clone(), Bearing::default()),
        ];
        let spec = alone(vec![shaft("beam", stations, vec![bar(length, D, m, n)])]);
        let f = frequencies(&mut build(&spec, &[], &contact(1e9)));
        let first = f.iter().find(|f| **f > 1.0).copied().unwrap_or(0.0);
        errors.push((first / exact - 1.0).abs());
    }
    let order = (errors[1] / errors[2]).log2();
    println!("pinned beam {exact} Hz, errors {errors:?}, order {order:.2}");
    assert!(errors[2] < 2e-4 && order > 1.9);
}

/// A free beam in motion keeps momentum, linear and angular, and energy as methods do.
#[test]
fn a_free_beam_keeps_momentum_and_energy() {
    let mut scene = build(&free_beam(0.6, 5), &[], &contact(1e9));
    let mut s = scene.initial();
    let mut numbers = Numbers::new(11);
    for g in scene.gears() {
        let r = g.range();
        for (i, v) in s.v[r].iter_mut().enumerate() {
            *v = numbers.draw() * if (1..4).contains(&i) { 0.01 } else { 0.1 };
        }
    }
    // Own turn, x, y, z, tilts about x and y; the theory is linear: arms are those of the assembled position.
    let momenta = |scene: &Scene, s: &State| {
        let (mut p, mut l) = (Vec3::zeros(), Vec3::zeros());
        for g in scene.gears() {
            let (v, hub) = (&s.v[g.range()], &g.model.hub().hub);
            let m = hub.lateral.as_ref().unwrap().masses();
            let own = Vec3::new(m[0] * v[1], m[1] * v[2], m[2] * v[3]);
            p += own;
            l += hub.centre.cross(&own) + Vec3::new(m[3] * v[4], m[4] * v[5], hub.inertia * v[0]);
        }
        (p, l)
    };
    let (p, l) = momenta(&scene, &s);
    let before = energy(&mut scene, &s);
    for id in ["rk4", "velocity-verlet", "generalised-alpha"] {
        let plan = TimePlan::new(5e-4, Resolution::Step(5e-7));
        let end = run_from(&mut scene, s.clone(), id, &plan).unwrap(id).state;
        let (p1, l1) = momenta(&scene, &end);
        let kept = energy(&mut scene, &end) / before - 1.0;
        println!(
            "{id}: dp {:.1e}, dl {:.1e}, energy {kept:.1e}",
            (p1 - p).norm() / p.norm(),
            (l1 - l).norm() / l.norm()
        );
        assert!((p1 - p).norm() < 1e-10 * p.norm(), "{id}");
        assert!((l1 - l).norm() < 1e-10 * l.norm(), "{id}");
        assert!(kept.abs() < 5e-3, "{id}: {kept}");
    }
}

/// Corrections of many links on bearings invert tangents.
#[test]
fn corrections_of_beams_invert_tangents() {
    let mut stiffness = [[0.0; 6]; 6];
    for (d, row) in stiffness.iter_mut().enumerate() {
        row[d] = [1e8, 2e8, 5e7, 1e5, 1e5, 0.0][d];
    }
    let bearing = Bearing {
        stiffness,
        ..Bearing::default()
    };
    let stations = vec![
        sideways(0.1, "left", FREE, bearing),
        sideways(0.5, "right", FREE, bearing),
    ];
    let spec = alone(vec![shaft(
        "rotor",
        stations,
        vec![bar(0.6, D, Material::STEEL, 4)],
    )]);
    let mut scene = build(&spec, &[], &contact(1e9));
    let s = scene.initial();
    for k in [0.0, 1e-12, 1e-8] {
        let c = Coeffs { m: 1.0, d: 0.0, k };
        corrects(&mut scene, &s, c, false, "rotor");
    }
}
