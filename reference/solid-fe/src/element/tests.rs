use super::{Integrator, MAX_NODES, gradients, natural, values};
use crate::Material;
use crate::Vec3;
use crate::mesh::{ElementKind, Mesh, quality};

/// A distorted element: corners moved, edges straight.
fn distorted(kind: ElementKind) -> Vec<Vec3> {
    let corners: Vec<Vec3> = (0..kind.corners())
        .map(|a| {
            let [x, y, z] = natural(kind, a);
            let s = |k: f64| 0.15 * (k * (a as f64 + 1.0)).sin();
            Vec3::new(
                1e-3 * (x + s(1.3)),
                2e-3 * (y + s(2.1)),
                1.5e-3 * (z + s(3.7)),
            )
        })
        .collect();
    let middles = kind.edges().iter().take(kind.nodes() - kind.corners());
    let middles: Vec<Vec3> = middles
        .map(|&[a, b]| 0.5 * (corners[a] + corners[b]))
        .collect();
    corners.into_iter().chain(middles).collect()
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
            values(kind, natural(kind, a), &mut f);
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
        // All edges are straight, so the volume is that of the linear element.
        let volume: f64 = m.iter().sum::<f64>() / Material::STEEL.density;
        let mesh = Mesh::new(kind, x, (0..n as u32).collect());
        let expected = quality(&mesh).volume;
        // On the axis of a wedge only the mean section matters.
        let bound = if kind == ElementKind::C3D6 {
            0.01
        } else {
            1e-12
        };
        assert!((volume / expected - 1.0).abs() < bound, "{kind:?}");
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

#[test]
fn the_linear_tetrahedron_has_its_textbook_stiffness() {
    // Constant strain: K = V B^T D B with the gradients of the volume coordinates.
    let x = [
        Vec3::new(0.1, 0.0, 0.2),
        Vec3::new(1.2, 0.1, 0.0),
        Vec3::new(0.3, 1.1, 0.1),
        Vec3::new(0.2, 0.2, 0.9),
    ];
    let edges = nalgebra::Matrix3::from_columns(&[x[1] - x[0], x[2] - x[0], x[3] - x[0]]);
    let volume = edges.determinant() / 6.0;
    let inverse = edges.try_inverse().unwrap();
    let slope = |a: usize| -> Vec3 {
        match a {
            0 => -(0..3).map(|i| inverse.row(i).transpose()).sum::<Vec3>(),
            a => inverse.row(a - 1).transpose(),
        }
    };
    let material = Material::STEEL;
    let (e, nu) = (material.young, material.poisson);
    let (lambda, mu) = (
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        e / (2.0 * (1.0 + nu)),
    );
    let (mut k, mut m) = ([0.0; 144], [0.0; 16]);
    Integrator::new(ElementKind::C3D4)
        .matrices(0, &x, &material, &mut k, &mut m)
        .unwrap();
    for (a, b) in (0..16).map(|i| (i / 4, i % 4)) {
        let (ga, gb) = (slope(a), slope(b));
        for (i, j) in (0..9).map(|i| (i / 3, i % 3)) {
            let same = if i == j { mu * ga.dot(&gb) } else { 0.0 };
            let exact = volume * (lambda * ga[i] * gb[j] + mu * ga[j] * gb[i] + same);
            let found = k[(3 * a + i) * 12 + 3 * b + j];
            assert!((found - exact).abs() < 1e-13 * e, "{found} {exact}");
        }
        let exact = material.density * volume / 16.0;
        assert!((m[4 * a + b] / exact - 1.0).abs() < 1e-13);
    }
}
