//! Solid elements: stiffness and mass of one element, isotropic linear elasticity.
//!
//! `K = sum_q w_q det J B^T D B`, `M = sum_q w_q rho det J N^T N` (scalar, times the unit matrix of three axes).
//!
//! | kind | stiffness | mass |
//! |---|---|---|
//! | C3D8 | 2x2x2 points | consistent, 2x2x2 |
//! | C3D8I | C3D8 and three incompatible modes `1 - xi_i^2`, condensed statically | as C3D8 |
//! | C3D20 | 3x3x3 | consistent, 3x3x3 |
//! | C3D20R | 2x2x2 | consistent, 2x2x2 |
//! | C3D4 | 1 | consistent, 1 |
//! | C3D10 | 4 | consistent, 4 |
//! | C3D6 | 2, on the axis of the wedge | consistent, 2 |
//! | C3D15 | 3 over the triangle x 3 | consistent, 3x3 |
//!
//! The incompatible modes take the Jacobian at the centre, scaled by `det J_0 / det J`, so that constant
//! strains stay exact on distorted elements (R. L. Taylor, P. J. Beresford, E. L. Wilson, *Int. J. Numer.
//! Meth. Eng.* 10 (1976) 1211). They get no mass: an internal displacement with mass adds modes of its own.
//!
//! These are the rules of CalculiX 2.20, found by comparison: C3D8, C3D20 and C3D20R give its stored
//! eigenfrequencies to all printed digits (a C3D20R mass by 3x3x3 points would differ in the sixth). Only its C3D8I
//! is another element: CalculiX keeps the internal displacements in the mass. The mass of one C3D20R has rank 8
//! of 20, and that of every stored mesh of them is singular: good for modes and for implicit steps, but what
//! divides by the mass wants the lumped one. So are the masses of tetrahedra and wedges: one C3D4 has rank 1 of 4,
//! one C3D10 4 of 10, one C3D6 2 of 6, one C3D15 9 of 15. A single column of C3D20R has motions without strain energy that
//! pass from element to element; two columns beside each other have none. One C3D6 has a single such motion.
//!
//! Text: T. J. R. Hughes, *The Finite Element Method* (1987), ch. 3 and 4.

mod inside;
mod rules;
mod shape;

#[cfg(test)]
mod tests;

use crate::Material;
use crate::Vec3;
use crate::mesh::ElementKind;
pub use inside::Inside;
use nalgebra::Matrix3;
pub(crate) use rules::{solid_rule, stiffness_rule};
pub use shape::{MAX_NODES, gradients, natural, values};

/// An element that cannot be integrated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are about")]
pub enum ElementError {
    #[error(
        "element {} is turned inside out: its Jacobian is {determinant:.3e} at an integration point; check the order of its nodes and the shape of the mesh there",
        element + 1
    )]
    Inverted { element: usize, determinant: f64 },
    #[error(
        "Young's modulus {young:.3e} Pa and Poisson's ratio {poisson} describe no elastic solid; expected E > 0 and nu between -1 and 0.5"
    )]
    Material { young: f64, poisson: f64 },
    #[error("density is {density} kg/m^3; expected a positive value")]
    Density { density: f64 },
    #[error(transparent)]
    TooLarge(#[from] crate::limits::TooMuchMemory),
}

/// Most functions whose gradients meet in a stiffness: 20 nodes, or 8 and three incompatible modes.
const MAX_PAIRS: usize = MAX_NODES * (MAX_NODES + 1) / 2;

/// Shape functions of an element kind at a point of the reference cube.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    xi: [f64; 3],
    pub(crate) weight: f64,
    pub(crate) values: [f64; MAX_NODES],
    pub(crate) gradients: [[f64; 3]; MAX_NODES],
}

impl Point {
    pub(crate) fn new(kind: ElementKind, xi: [f64; 3], weight: f64) -> Self {
        let mut point = Point {
            xi,
            weight,
            values: [0.0; MAX_NODES],
            gradients: [[0.0; 3]; MAX_NODES],
        };
        values(kind, xi, &mut point.values);
        gradients(kind, xi, &mut point.gradients);
        point
    }
}

/// Integrates elements of one kind: shape functions at its points, evaluated once.
#[derive(Clone, Debug)]
pub struct Integrator {
    kind: ElementKind,
    points: Vec<Point>,
    centre: [[f64; 3]; MAX_NODES],
}

impl Integrator {
    /// Prepares the rule of a kind.
    pub fn new(kind: ElementKind) -> Self {
        let points = stiffness_rule(kind).into_iter();
        let points = points.map(|(xi, weight)| Point::new(kind, xi, weight));
        let points = points.collect();
        let centre = Point::new(kind, [0.0; 3], 0.0).gradients;
        Integrator {
            kind,
            points,
            centre,
        }
    }

    /// Stiffness [N/m] and scalar consistent mass [kg] of one element.
    ///
    /// `x` has the positions of its `n` nodes. `stiffness` is row-major over `3 n` coordinates (node, then axis),
    /// `mass` row-major over `n` nodes; both are overwritten. `element` only names it in errors.
    pub fn matrices(
        &self,
        element: usize,
        x: &[Vec3],
        material: &Material,
        stiffness: &mut [f64],
        mass: &mut [f64],
    ) -> Result<(), ElementError> {
        let n = self.kind.nodes();
        let (lambda, mu) = lame(material)?;
        if !(material.density > 0.0 && material.density.is_finite()) {
            return Err(ElementError::Density {
                density: material.density,
            });
        }
        let modes = if self.kind == ElementKind::C3D8I {
            3
        } else {
            0
        };
        let functions = n + modes;
        let centre = jacobian(x, &self.centre);
        let (centre_det, centre_inverse) = (centre.determinant(), inverse(&centre));
        // `sum_q w det J (grad N_a)(grad N_b)^T` of all pairs a <= b: the moduli enter once, at the end.
        let mut pairs = [[0.0; 9]; MAX_PAIRS];
        let mut masses = [0.0; MAX_PAIRS];
        let mut g = [[0.0; 3]; MAX_NODES];
        for point in &self.points {
            let j = jacobian(x, &point.gradients);
            let determinant = j.determinant();
            // Written so that a NaN is refused too.
            if determinant.is_nan() || determinant <= 0.0 {
                return Err(ElementError::Inverted {
                    element,
                    determinant,
                });
            }
            let j = inverse(&j);
            for (g, natural) in g[..n].iter_mut().zip(&point.gradients) {
                *g = [0, 1, 2].map(|i| {
                    j[(i, 0)] * natural[0] + j[(i, 1)] * natural[1] + j[(i, 2)] * natural[2]
                });
            }
            for m in 0..modes {
                let slope = -2.0 * point.xi[m] * centre_det / determinant;
                g[n + m] = [0, 1, 2].map(|i| centre_inverse[(i, m)] * slope);
            }
            let w = point.weight * determinant;
            let mut pair = pairs.iter_mut();
            for (a, ga) in g[..functions].iter().enumerate() {
                let ga = ga.map(|x| w * x);
                for (gb, pair) in g[a..functions].iter().zip(&mut pair) {
                    for i in 0..3 {
                        for j in 0..3 {
                            pair[3 * i + j] += ga[i] * gb[j];
                        }
                    }
                }
            }
            let mut pair = masses.iter_mut();
            for (a, na) in point.values[..n].iter().enumerate() {
                let na = w * material.density * na;
                for (nb, pair) in point.values[a..n].iter().zip(&mut pair) {
                    *pair += na * nb;
                }
            }
        }
        let mut pair = masses.iter();
        for a in 0..n {
            for (b, m) in (a..n).zip(&mut pair) {
                mass[a * n + b] = *m;
                mass[b * n + a] = *m;
            }
        }
        let size = 3 * n;
        let mut coupling = [[0.0; 9]; 24];
        let mut own = nalgebra::SMatrix::<f64, 9, 9>::zeros();
        let mut pair = pairs.iter();
        for a in 0..functions {
            for (b, g) in (a..functions).zip(&mut pair) {
                let shear = mu * (g[0] + g[4] + g[8]);
                for i in 0..3 {
                    for j in 0..3 {
                        let mut k = lambda * g[3 * i + j] + mu * g[3 * j + i];
                        if i == j {
                            k += shear;
                        }
                        let (row, column) = (3 * a + i, 3 * b + j);
                        if b < n {
                            stiffness[row * size + column] = k;
                            stiffness[column * size + row] = k;
                        } else if a < n {
                            coupling[row][column - size] = k;
                        } else {
                            own[(row - size, column - size)] = k;
                            own[(column - size, row - size)] = k;
                        }
                    }
                }
            }
        }
        if modes > 0 {
            // The own stiffness of the modes is positive definite wherever the Jacobian is.
            let refused = ElementError::Inverted {
                element,
                determinant: centre_det,
            };
            let inverse = own.cholesky().ok_or(refused)?.inverse();
            condense(&coupling, &inverse, stiffness);
        }
        Ok(())
    }
}

/// `J[i][j] = dx_j / dxi_i`.
#[inline]
fn jacobian(x: &[Vec3], gradients: &[[f64; 3]; MAX_NODES]) -> Matrix3<f64> {
    let mut j = Matrix3::zeros();
    for (x, g) in x.iter().zip(gradients) {
        for a in 0..3 {
            for b in 0..3 {
                j[(a, b)] += g[a] * x[b];
            }
        }
    }
    j
}

/// The inverse; zero for a singular matrix, whose determinant is refused where it matters.
fn inverse(j: &Matrix3<f64>) -> Matrix3<f64> {
    j.try_inverse().unwrap_or_else(Matrix3::zeros)
}

/// Takes the condensed incompatible modes off the stiffness (24 x 24, row-major).
fn condense(
    coupling: &[[f64; 9]; 24],
    inverse: &nalgebra::SMatrix<f64, 9, 9>,
    stiffness: &mut [f64],
) {
    let mut condensed = [[0.0; 9]; 24];
    for (row, c) in condensed.iter_mut().zip(coupling) {
        for q in 0..9 {
            row[q] = (0..9).map(|p| c[p] * inverse[(p, q)]).sum();
        }
    }
    for i in 0..24 {
        for j in i..24 {
            let sum: f64 = (0..9).map(|q| condensed[i][q] * coupling[j][q]).sum();
            stiffness[i * 24 + j] -= sum;
            stiffness[j * 24 + i] = stiffness[i * 24 + j];
        }
    }
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
