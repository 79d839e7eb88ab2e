//! Integration rules: natural coordinates of the points with their weights.
//!
//! [`stiffness_rule`] is that of the element, as CalculiX has it; [`solid_rule`] integrates volumes and moments:
//! Gauss-Legendre with three points per axis, on wedges and tetrahedra after the collapsed coordinates
//! `xi = x, eta = y (1 - x), zeta = z (1 - x)(1 - y)` (A. H. Stroud, *Approximate Calculation of Multiple
//! Integrals*, 1971, conical products), exact to the third degree on a tetrahedron.

use crate::mesh::{ElementKind, Shape};

/// Points with their weights.
pub(crate) type Rule = Vec<([f64; 3], f64)>;

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
fn product(line: &[(f64, f64)]) -> Rule {
    let points = line.iter().flat_map(|&(z, wz)| {
        line.iter()
            .flat_map(move |&(y, wy)| line.iter().map(move |&(x, wx)| ([x, y, z], wx * wy * wz)))
    });
    points.collect()
}

/// Three points of a triangle, exact to the second degree.
const TRIANGLE: [[f64; 2]; 3] = [
    [1.0 / 6.0, 1.0 / 6.0],
    [2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0],
];

/// The rule of stiffness and mass.
pub(crate) fn stiffness_rule(kind: ElementKind) -> Rule {
    match kind {
        ElementKind::C3D8 | ElementKind::C3D8I | ElementKind::C3D20R => product(&TWO),
        ElementKind::C3D20 => product(&THREE),
        ElementKind::C3D4 => vec![([0.25; 3], 1.0 / 6.0)],
        ElementKind::C3D10 => {
            let root = 5.0_f64.sqrt();
            let (far, near) = ((5.0 + 3.0 * root) / 20.0, (5.0 - root) / 20.0);
            let at = |i: usize| std::array::from_fn(|k| if k + 1 == i { far } else { near });
            (0..4).map(|i| (at(i), 1.0 / 24.0)).collect()
        }
        ElementKind::C3D6 => TWO
            .iter()
            .map(|&(z, w)| ([1.0 / 3.0, 1.0 / 3.0, z], 0.5 * w))
            .collect(),
        ElementKind::C3D15 => THREE
            .iter()
            .flat_map(|&(z, w)| TRIANGLE.map(|[x, y]| ([x, y, z], w / 6.0)))
            .collect(),
    }
}

/// A rule for volumes and their moments; of hexahedra that of [`stiffness_rule`] without reduction.
pub(crate) fn solid_rule(kind: ElementKind) -> Rule {
    let unit = |x: f64| 0.5 * (1.0 + x);
    match kind.shape() {
        Shape::Hexahedron if kind.is_quadratic() => product(&THREE),
        Shape::Hexahedron => product(&TWO),
        Shape::Wedge => (product(&THREE).into_iter())
            .map(|([x, y, z], w)| {
                let (x, y) = (unit(x), unit(y));
                ([x, y * (1.0 - x), z], 0.25 * w * (1.0 - x))
            })
            .collect(),
        Shape::Tetrahedron => (product(&THREE).into_iter())
            .map(|([x, y, z], w)| {
                let (x, y, z) = (unit(x), unit(y), unit(z));
                let at = [x, y * (1.0 - x), z * (1.0 - x) * (1.0 - y)];
                (at, 0.125 * w * (1.0 - x).powi(2) * (1.0 - y))
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `int x^a y^b z^c`: of a tetrahedron `a! b! c! / (a + b + c + 3)!`, of a wedge that of its triangle.
    #[test]
    fn volumes_and_moments_of_the_reference_elements() {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        let moment = |rule: &Rule, p: [i32; 3]| -> f64 {
            let terms = rule.iter();
            let term =
                |(x, w): &([f64; 3], f64)| w * (0..3).map(|i| x[i].powi(p[i])).product::<f64>();
            terms.map(term).sum()
        };
        for kind in ElementKind::ALL {
            for (rule, degree) in [
                (solid_rule(kind), 3),
                (
                    stiffness_rule(kind),
                    if kind.is_quadratic() { 2 } else { 1 },
                ),
            ] {
                for p in (0..64).map(|i| [i % 4, i / 4 % 4, i / 16]) {
                    if p.iter().sum::<i32>() > degree {
                        continue;
                    }
                    let line = |n: i32| f64::from(1 - n % 2) * 2.0 / f64::from(n + 1);
                    let exact = match kind.shape() {
                        Shape::Hexahedron => p.map(line).iter().product(),
                        Shape::Wedge => {
                            factorial(p[0]) * factorial(p[1]) / factorial(p[0] + p[1] + 2)
                                * line(p[2])
                        }
                        Shape::Tetrahedron => {
                            p.map(factorial).iter().product::<f64>()
                                / factorial(p.iter().sum::<i32>() + 3)
                        }
                    };
                    let found = moment(&rule, p);
                    assert!(
                        (found - exact).abs() < 1e-14,
                        "{kind:?} {p:?} {found} {exact}"
                    );
                }
            }
        }
    }
}
