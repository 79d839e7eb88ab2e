use super::{Integrator, MAX_NODES, gradients, natural_corner, values};
use crate::mesh::ElementKind;
use gearbench_models::Vec3;
use gearbench_models::stiffness::Material;

/// A distorted element: corners moved, edges straight.
fn distorted(kind: ElementKind) -> Vec<Vec3> {
    let corners: Vec<Vec3> = (0..8)
        .map(|a| {
            let [x, y, z] = natural_corner(a);
            let s = |k: f64| 0.15 * (k * (a as f64 + 1.0)).sin();
            Vec3::new(
                1e-3 * (x + s(1.3)),
                2e-3 * (y + s(2.1)),
                1.5e-3 * (z + s(3.7)),
            )
        })
        .collect();
    let mut shape = [0.0; MAX_NODES];
    (0..kind.nodes())
        .map(|a| {
            values(ElementKind::C3D8, natural_corner(a), &mut shape);
            (0..8).map(|b| shape[b] * corners[b]).sum()
        })
        .collect()
}

fn of(kind: ElementKind) -> (Vec<Vec3>, Vec<f64>, Vec<f64>) {
    let x = distorted(kind);
    let n = kind.nodes();
    let (mut k, mut m) = (vec![0.0; 9 * n * n], vec![0.0; n * n]);
    Integrator::new(kind)
        .matrices(0, &x, &Material::STEEL, &mut k, &mut m)
        .unwrap();
    (x, k, m)
}

#[test]
fn shape_functions_are_one_at_their_node_and_gradients_are_their_slopes() {
    for kind in ElementKind::ALL {
        let n = kind.nodes();
        let mut f = [0.0; MAX_NODES];
        for a in 0..n {
            values(kind, natural_corner(a), &mut f);
            for (b, value) in f[..n].iter().enumerate() {
                assert!((value - f64::from(u8::from(a == b))).abs() < 1e-15);
            }
        }
        let xi = [0.3, -0.7, 0.2];
        let mut g = [[0.0; 3]; MAX_NODES];
        gradients(kind, xi, &mut g);
        for axis in 0..3 {
            let h = 1e-6;
            let side = |sign: f64| {
                let mut at = xi;
                at[axis] += sign * h;
                let mut f = [0.0; MAX_NODES];
                values(kind, at, &mut f);
                f
            };
            let (plus, minus) = (side(1.0), side(-1.0));
            for a in 0..n {
                assert!(((plus[a] - minus[a]) / (2.0 * h) - g[a][axis]).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn rigid_motions_need_no_force_and_mass_is_volume_times_density() {
    for kind in ElementKind::ALL {
        let (x, k, m) = of(kind);
        let n = kind.nodes();
        let size = k.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
        let motions: [fn(&Vec3) -> Vec3; 4] = [
            |_| Vec3::new(1.0, 2.0, -1.0),
            |x| Vec3::z().cross(x) * 1e3,
            |x| Vec3::x().cross(x) * 1e3,
            |x| Vec3::y().cross(x) * 1e3,
        ];
        for motion in motions {
            let u: Vec<f64> = x.iter().flat_map(|x| motion(x).data.0[0]).collect();
            for row in k.chunks_exact(3 * n) {
                let f: f64 = row.iter().zip(&u).map(|(k, u)| k * u).sum();
                assert!(f.abs() < 1e-12 * size, "{kind:?} {f:e} {size:e}");
            }
        }
        // All corners keep straight edges, so the volume is that of the eight-node brick.
        let volume: f64 = m.iter().sum::<f64>() / Material::STEEL.density;
        let (_, _, m8) = of(ElementKind::C3D8);
        let expected: f64 = m8.iter().sum::<f64>() / Material::STEEL.density;
        assert!((volume / expected - 1.0).abs() < 1e-12);
    }
}

#[test]
fn constant_strain_gives_its_energy_exactly() {
    let material = Material::STEEL;
    let (e, nu) = (material.young, material.poisson);
    let (lambda, mu) = (
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        e / (2.0 * (1.0 + nu)),
    );
    let h = [
        [1e-4, 3e-5, -2e-5],
        [5e-5, -2e-4, 4e-5],
        [1e-5, -6e-5, 7e-5],
    ];
    let strain = |i: usize, j: usize| 0.5 * (h[i][j] + h[j][i]);
    let trace = h[0][0] + h[1][1] + h[2][2];
    let mut density = 0.5 * lambda * trace * trace;
    for i in 0..3 {
        for j in 0..3 {
            density += mu * strain(i, j).powi(2);
        }
    }
    for kind in ElementKind::ALL {
        let (x, k, m) = of(kind);
        let n = 3 * kind.nodes();
        let u: Vec<f64> = x
            .iter()
            .flat_map(|x| [0, 1, 2].map(|i| h[i][0] * x[0] + h[i][1] * x[1] + h[i][2] * x[2]))
            .collect();
        let energy: f64 = (0..n)
            .map(|i| 0.5 * u[i] * (0..n).map(|j| k[i * n + j] * u[j]).sum::<f64>())
            .sum();
        let volume = m.iter().sum::<f64>() / material.density;
        // Straight edges: two points per axis integrate the Jacobian exactly too.
        let expected = density * volume;
        assert!(
            (energy / expected - 1.0).abs() < 1e-9,
            "{kind:?} {energy} {expected}"
        );
    }
}

#[test]
fn an_inverted_element_and_a_bad_material_are_named() {
    let kind = ElementKind::C3D8;
    let good = distorted(kind);
    let mut turned = good.clone();
    turned.swap(0, 1);
    let soft = Material {
        poisson: 0.5,
        ..Material::STEEL
    };
    let light = Material {
        density: 0.0,
        ..Material::STEEL
    };
    for (element, x, material, words) in [
        (0, &good, soft, "Poisson's ratio 0.5"),
        (0, &good, light, "density is 0"),
        (
            6,
            &turned,
            Material::STEEL,
            "element 7 is turned inside out",
        ),
    ] {
        let (mut k, mut m) = ([0.0; 576], [0.0; 64]);
        let refused = Integrator::new(kind).matrices(element, x, &material, &mut k, &mut m);
        let message = refused.unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
}
