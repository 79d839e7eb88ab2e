//! Hexahedral elements: stiffness and mass of one element, isotropic linear elasticity.
//!
//! `K = sum_q w_q det J B^T D B`, `M = sum_q w_q rho det J N^T N` (scalar, times the unit matrix of three axes).
//!
//! | kind | stiffness | mass |
//! |---|---|---|
//! | C3D8 | 2x2x2 points | consistent, 2x2x2 |
//! | C3D8I | C3D8 and three incompatible modes `1 - xi_i^2`, condensed statically | as C3D8 |
//! | C3D20 | 3x3x3 | consistent, 3x3x3 |
//! | C3D20R | 2x2x2 | consistent, 3x3x3 |
//!
//! The incompatible modes take the Jacobian at the centre, scaled by `det J_0 / det J`, so that constant
//! strains stay exact on distorted elements (R. L. Taylor, P. J. Beresford, E. L. Wilson, *Int. J. Numer.
//! Meth. Eng.* 10 (1976) 1211). They get no mass: an internal displacement with mass adds modes of its own.
//! Text: T. J. R. Hughes, *The Finite Element Method* (1987), ch. 3 and 4.

mod shape;

#[cfg(test)]
mod tests;

use crate::mesh::ElementKind;
use gearbench_models::Vec3;
use gearbench_models::stiffness::Material;
use nalgebra::Matrix3;
pub use shape::{MAX_NODES, gradients, natural_corner, values};

/// An element that cannot be integrated.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ElementError {
    /// Turned inside out or flat somewhere.
    #[error(
        "element {} is turned inside out: its Jacobian is {determinant:.3e} at an integration point; check the order of its nodes and the shape of the mesh there",
        element + 1
    )]
    Inverted {
        /// The element, from 0.
        element: usize,
        /// The determinant there.
        determinant: f64,
    },
    /// A material that is none.
    #[error(
        "Young's modulus {young:.3e} Pa and Poisson's ratio {poisson} describe no elastic solid; expected E > 0 and nu between -1 and 0.5"
    )]
    Material {
        /// Young's modulus [Pa].
        young: f64,
        /// Poisson's ratio.
        poisson: f64,
    },
}

/// Gauss-Legendre points and weights on [-1, 1].
const TWO: [(f64, f64); 2] = [
    (-0.577_350_269_189_625_8, 1.0),
    (0.577_350_269_189_625_8, 1.0),
];
const THREE: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

/// Points of a product rule with their weights.
fn rule(line: &[(f64, f64)]) -> impl Iterator<Item = ([f64; 3], f64)> + '_ {
    line.iter().flat_map(move |&(z, wz)| {
        line.iter()
            .flat_map(move |&(y, wy)| line.iter().map(move |&(x, wx)| ([x, y, z], wx * wy * wz)))
    })
}

/// Shape function gradients in space and the determinant at a point of an element.
fn at_point(
    kind: ElementKind,
    x: &[Vec3],
    xi: [f64; 3],
    d: &mut [[f64; 3]; MAX_NODES],
) -> (Matrix3<f64>, f64) {
    let n = kind.nodes();
    gradients(kind, xi, d);
    // J[i][j] = dx_j / dxi_i.
    let mut j = Matrix3::zeros();
    for (x, d) in x.iter().zip(&d[..n]) {
        for a in 0..3 {
            for b in 0..3 {
                j[(a, b)] += d[a] * x[b];
            }
        }
    }
    let det = j.determinant();
    let inverse = j.try_inverse().unwrap_or_else(Matrix3::zeros);
    for d in &mut d[..n] {
        let g = *d;
        for a in 0..3 {
            d[a] = inverse[(a, 0)] * g[0] + inverse[(a, 1)] * g[1] + inverse[(a, 2)] * g[2];
        }
    }
    (j, det)
}

/// Lame constants of a material.
fn lame(material: &Material) -> Result<(f64, f64), ElementError> {
    let (e, nu) = (material.young, material.poisson);
    if !(e > 0.0 && e.is_finite() && nu > -1.0 && nu < 0.5) {
        return Err(ElementError::Material {
            young: e,
            poisson: nu,
        });
    }
    Ok((
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        e / (2.0 * (1.0 + nu)),
    ))
}

/// `w B_a^T D B_b` of two gradients: `lambda a b^T + mu (b a^T + (a.b) I)`.
#[inline]
fn block(a: &[f64; 3], b: &[f64; 3], lambda: f64, mu: f64) -> [[f64; 3]; 3] {
    let dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mut k = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            k[i][j] = lambda * a[i] * b[j] + mu * b[i] * a[j];
        }
        k[i][i] += mu * dot;
    }
    k
}

/// Stiffness [N/m] and scalar consistent mass [kg] of one element.
///
/// `x` has the positions of its `n` nodes. `stiffness` is row-major over `3 n` coordinates (node, then axis),
/// `mass` row-major over `n` nodes. `element` only names it in errors.
///
/// # Errors
/// [`ElementError`] for a Jacobian that is not positive or a material that is none.
pub fn matrices(
    kind: ElementKind,
    element: usize,
    x: &[Vec3],
    material: &Material,
    stiffness: &mut [f64],
    mass: &mut [f64],
) -> Result<(), ElementError> {
    let n = kind.nodes();
    let size = 3 * n;
    let (lambda, mu) = lame(material)?;
    stiffness[..size * size].fill(0.0);
    mass[..n * n].fill(0.0);
    let positive = |determinant: f64| {
        if determinant > 0.0 {
            Ok(())
        } else {
            Err(ElementError::Inverted {
                element,
                determinant,
            })
        }
    };
    let mut d = [[0.0; 3]; MAX_NODES];
    let of_stiffness: &[_] = if kind == ElementKind::C3D20 {
        &THREE
    } else {
        &TWO
    };
    let incompatible = kind == ElementKind::C3D8I;
    let centre = at_point(kind, x, [0.0; 3], &mut d);
    let centre_inverse = centre.0.try_inverse().unwrap_or_else(Matrix3::zeros);
    // Coupling (24 x 9) and own (9 x 9) stiffness of the incompatible modes.
    let mut coupling = [[0.0; 9]; 24];
    let mut own = nalgebra::SMatrix::<f64, 9, 9>::zeros();
    for (xi, w) in rule(of_stiffness) {
        let (_, det) = at_point(kind, x, xi, &mut d);
        positive(det)?;
        let w = w * det;
        for a in 0..n {
            for b in a..n {
                let k = block(&d[a], &d[b], w * lambda, w * mu);
                for i in 0..3 {
                    for j in 0..3 {
                        stiffness[(3 * a + i) * size + 3 * b + j] += k[i][j];
                    }
                }
            }
        }
        if incompatible {
            let scale = centre.1 / det;
            let modes: [[f64; 3]; 3] = std::array::from_fn(|m| {
                let slope = -2.0 * xi[m] * scale;
                std::array::from_fn(|i| centre_inverse[(i, m)] * slope)
            });
            for (p, mode) in modes.iter().enumerate() {
                for a in 0..n {
                    let k = block(&d[a], mode, w * lambda, w * mu);
                    for i in 0..3 {
                        for j in 0..3 {
                            coupling[3 * a + i][3 * p + j] += k[i][j];
                        }
                    }
                }
                for (r, other) in modes.iter().enumerate() {
                    let k = block(mode, other, w * lambda, w * mu);
                    for i in 0..3 {
                        for j in 0..3 {
                            own[(3 * p + i, 3 * r + j)] += k[i][j];
                        }
                    }
                }
            }
        }
    }
    for i in 0..size {
        for j in 0..i {
            stiffness[i * size + j] = stiffness[j * size + i];
        }
    }
    if incompatible {
        // The own stiffness of the modes is positive definite wherever the Jacobian is.
        let inverse = own.try_inverse().ok_or(ElementError::Inverted {
            element,
            determinant: centre.1,
        })?;
        let mut condensed = [[0.0; 9]; 24];
        for (row, c) in condensed.iter_mut().zip(&coupling) {
            for q in 0..9 {
                row[q] = (0..9).map(|p| c[p] * inverse[(p, q)]).sum();
            }
        }
        for i in 0..24 {
            for j in i..24 {
                let sum: f64 = (0..9).map(|q| condensed[i][q] * coupling[j][q]).sum();
                stiffness[i * 24 + j] -= sum;
                if i != j {
                    stiffness[j * 24 + i] = stiffness[i * 24 + j];
                }
            }
        }
    }
    let of_mass: &[_] = if n == 8 { &TWO } else { &THREE };
    let mut shape = [0.0; MAX_NODES];
    for (xi, w) in rule(of_mass) {
        let (_, det) = at_point(kind, x, xi, &mut d);
        positive(det)?;
        values(kind, xi, &mut shape);
        let w = w * det * material.density;
        for a in 0..n {
            for b in 0..n {
                mass[a * n + b] += w * shape[a] * shape[b];
            }
        }
    }
    Ok(())
}
