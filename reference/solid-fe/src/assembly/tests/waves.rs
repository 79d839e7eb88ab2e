//! Frequencies with exact solutions: waves in a bar and in a box, and a clamped beam.

use super::support::{frequencies, nodes_where};
use crate::Material;
use crate::Vec3;
use crate::assembly::assemble;
use crate::assembly::tie::{HubMotion, MassKind, Tie};
use crate::mesh::ElementKind;
use crate::mesh::brick;
use crate::test_support::{largest, product};
use std::f64::consts::{PI, TAU};

#[test]
fn a_bar_vibrates_as_its_discrete_dispersion_says() {
    // Without Poisson's ratio longitudinal motion stays one-dimensional, and sin(a x) at the nodes is an exact
    // mode of the mesh: omega^2 = c^2 (2 / h^2) (1 - cos a h) over 1 (lumped) or (2 + cos a h) / 3 (consistent).
    let material = Material {
        poisson: 0.0,
        ..Material::STEEL
    };
    let (cells, length) = (6, 30e-3);
    let h = length / f64::from(cells);
    let speed = (material.young / material.density).sqrt();
    for kind in [ElementKind::C3D8, ElementKind::C3D8I] {
        let mesh = brick(kind, [cells as usize, 2, 1], [length, 8e-3, 5e-3]);
        let a = assemble(&mesh, &material).unwrap();
        let tie = Tie::new(&mesh.nodes, &nodes_where(&mesh, |x| x.x == 0.0), &[]);
        for (mass, side) in [(MassKind::Consistent, 1.0), (MassKind::Lumped, -1.0)] {
            let reduced = tie.reduce(&a, &[], mass);
            for wave in 0..4 {
                let number = (f64::from(wave) + 0.5) * PI / length;
                let cosine = (number * h).cos();
                let mut value = (speed / h).powi(2) * 2.0 * (1.0 - cosine);
                if mass == MassKind::Consistent {
                    value *= 3.0 / (2.0 + cosine);
                }
                let exact = (speed * number).powi(2);
                assert!(
                    side * (value - exact) > 0.0,
                    "above with consistent mass, below with lumped"
                );
                let u: Vec<f64> = tie
                    .free
                    .iter()
                    .flat_map(|&i| [(number * mesh.nodes[i as usize].x).sin(), 0.0, 0.0])
                    .collect();
                let (ku, mu) = (product(&reduced.stiffness, &u), product(&reduced.mass, &u));
                let left: Vec<f64> = ku.iter().zip(&mu).map(|(k, m)| k - value * m).collect();
                assert!(
                    largest(&left) < 1e-12 * largest(&ku),
                    "{kind:?} {mass:?} {wave} {:e}",
                    largest(&left) / largest(&ku)
                );
            }
        }
    }
}

#[test]
fn frequencies_converge_with_twice_the_order_of_the_element() {
    // Standing waves in a box with smooth, frictionless walls. The Rayleigh quotient of the exact mode at the nodes
    // errs by the square of the interpolation's energy error.
    let material = Material::STEEL;
    let side = 1e-2;
    let (a, b) = (PI / side, PI / side);
    let shear = material.shear_modulus();
    let nu = material.poisson;
    let pressure = material.young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    for (modulus, amplitude) in [(shear, [b, -a]), (pressure, [a, b])] {
        let exact = modulus / material.density * (a * a + b * b);
        for kind in ElementKind::ALL {
            let error = |cells: usize| {
                let mesh = brick(kind, [cells, cells, 1], [side, side, 3e-3]);
                let k = assemble(&mesh, &material).unwrap();
                let u: Vec<f64> = mesh
                    .nodes
                    .iter()
                    .flat_map(|x| {
                        [
                            amplitude[0] * (a * x.x).sin() * (b * x.y).cos(),
                            amplitude[1] * (a * x.x).cos() * (b * x.y).sin(),
                            0.0,
                        ]
                    })
                    .collect();
                let (mut f, mut p) = (vec![0.0; u.len()], vec![0.0; u.len()]);
                k.stiffness.apply(&u, &mut f);
                k.mass.apply(&u, &mut p);
                let dot = |y: &[f64]| u.iter().zip(y).map(|(u, y)| u * y).sum::<f64>();
                (dot(&f) / dot(&p) / exact - 1.0).abs()
            };
            let (coarse, fine) = (error(6), error(12));
            let order = (coarse / fine).log2();
            let expected = if kind.is_quadratic() { 4.0 } else { 2.0 };
            assert!(
                (order - expected).abs() < 0.1 * expected,
                "{kind:?}: order {order:.2}, errors {coarse:.2e} {fine:.2e}"
            );
        }
    }
}

/// First bending frequency [Hz] of a cantilever by Timoshenko's beam: the determinant of its four end
/// conditions changes sign there (shear coefficient of a rectangle by Cowper 1966).
fn timoshenko(length: f64, height: f64, width: f64, material: &Material) -> f64 {
    let nu = material.poisson;
    let kappa = 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu);
    let (area, inertia) = (height * width, width * height.powi(3) / 12.0);
    let (ei, kga) = (
        material.young * inertia,
        kappa * material.shear_modulus() * area,
    );
    let r2 = inertia / (area * length * length);
    let s2 = ei / (kga * length * length);
    // T. C. Huang, J. Appl. Mech. 28 (1961) 579: clamped-free beam.
    let condition = |omega: f64| {
        let b2 = material.density * area * length.powi(4) * omega * omega / ei;
        let root = ((r2 - s2).powi(2) + 4.0 / b2).sqrt();
        let alpha = ((-(r2 + s2) + root) / 2.0).sqrt();
        let beta = ((r2 + s2 + root) / 2.0).sqrt();
        let b = b2.sqrt();
        2.0 + (b2 * (r2 - s2).powi(2) + 2.0) * (b * alpha).cosh() * (b * beta).cos()
            - b * (r2 + s2) / (1.0 - b2 * r2 * s2).sqrt() * (b * alpha).sinh() * (b * beta).sin()
    };
    let euler = 1.875_104_07_f64.powi(2) * (ei / (material.density * area * length.powi(4))).sqrt();
    let (mut low, mut high) = (0.5 * euler, 1.2 * euler);
    assert!(condition(low) * condition(high) < 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if condition(low) * condition(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low / TAU
}

#[test]
fn a_slender_cantilever_bends_as_timoshenko_s_beam() {
    let (length, side) = (100e-3, 5e-3);
    // Free of Poisson's effect, which no beam theory clamps as a solid is clamped.
    let material = Material {
        poisson: 0.0,
        ..Material::STEEL
    };
    let beam = timoshenko(length, side, side, &material);
    for (kind, cells, bound) in [
        (ElementKind::C3D20, [10, 1, 1], 1e-3),
        // A single column of C3D20R has motions without energy that pass from element to element.
        (ElementKind::C3D20R, [10, 2, 2], 1e-3),
        (ElementKind::C3D8I, [20, 1, 1], 3e-3),
    ] {
        let mesh = brick(kind, cells, [length, side, side]);
        let a = assemble(&mesh, &material).unwrap();
        let tie = Tie::new(&mesh.nodes, &nodes_where(&mesh, |x| x.x == 0.0), &[]);
        let f = frequencies(&tie.reduce(&a, &[], MassKind::Consistent), 2);
        let lumped = frequencies(&tie.reduce(&a, &[], MassKind::Lumped), 2);
        let below = 1.0 - lumped[0] / f[0];
        assert!(
            (0.0..5e-3).contains(&below),
            "{kind:?}: {below:e} lower with lumped mass"
        );
        assert!((f[1] / f[0] - 1.0).abs() < 1e-6, "both planes alike");
        assert!(
            (f[0] / beam - 1.0).abs() < bound,
            "{kind:?}: {} Hz, beam {beam} Hz",
            f[0]
        );
    }
}

#[test]
fn a_hub_of_great_inertia_holds_the_beam_as_a_clamp_does() {
    // A free hub adds one rigid motion; with growing inertia the elastic frequencies fall to the clamped ones.
    let mesh = brick(ElementKind::C3D8I, [10, 1, 1], [50e-3, 5e-3, 5e-3]);
    let bore = nodes_where(&mesh, |x| x.x == 0.0);
    let a = assemble(&mesh, &Material::STEEL).unwrap();
    let clamped = Tie::new(&mesh.nodes, &bore, &[]);
    let clamped = frequencies(&clamped.reduce(&a, &[], MassKind::Consistent), 1)[0];
    let slide = HubMotion::Slide(Vec3::y());
    let free = Tie::new(&mesh.nodes, &bore, &[slide]);
    let total: f64 = a.lumped.iter().sum();
    let mut last = f64::INFINITY;
    for ratio in [1.0, 10.0, 1e3] {
        let mut reduced = free.reduce(&a, &[ratio * total], MassKind::Consistent);
        // A weak spring holds the rigid motion: its frequency is known and far below.
        let spring = total * (TAU * 1e-2 * clamped).powi(2) * (1.0 + ratio);
        let place = reduced.stiffness.val().len() - 1;
        reduced.stiffness.val_mut()[place] += spring;
        let f = frequencies(&reduced, 3);
        assert!((f[0] / (1e-2 * clamped) - 1.0).abs() < 1e-3, "{f:?}");
        // Bending in z does not move the hub; bending in y does.
        let elastic = f[2];
        assert!(elastic < last && elastic > clamped * (1.0 - 1e-6), "{f:?}");
        last = elastic;
    }
    assert!((last / clamped - 1.0).abs() < 1e-3, "{last} {clamped}");
}
