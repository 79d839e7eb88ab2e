//! Near field of a mesh: displacement of the rows of nodes around a line load on a flank, without any support.
//!
//! The same elements on a half-space, in plane strain, under the same load at a node, with the displacements of Flamant's
//! solution on the boundary of the patch:
//!
//! ```text
//! u_z = -A ln r + B cos^2 t,    u_x = -C t + B sin t cos t,    A = 2 (1 - nu^2)/(pi E)
//! B = (1 + nu)/(pi E),    C = (1 - 2 nu) (1 + nu)/(pi E)
//! ```
//!
//! at the distance `r` and the angle `t` from the inward normal (K. L. Johnson, *Contact Mechanics* (1985), 2.2). On
//! the surface of the half-space itself the displacement is `-A ln |x|`, which the elements reproduce from a few rows
//! on; only the rows next to the load differ. With these, the part of the mesh is removed from the static compliance
//! and the Hertzian part is added: [`lines`](gearbench_models::gear::elastic::lines). For elements that do not form
//! such a lattice the patch is cut out of the body: `body`.

mod body;

use super::ReductionError;
use super::surface::Surface;
use crate::element::{ElementError, Integrator};
use crate::gear_mesh::GearMesh;
use crate::mesh::{ElementKind, Mesh};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use gearbench_models::Vec3;
use gearbench_models::geometry::FlankGrid;
use gearbench_models::stiffness::Material;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Rows away from the load up to which the elements differ from the half-space.
const REACH: usize = 8;

/// Elements on either side of the load, and as far down.
const PATCH: usize = 11;

/// Fewest and most layers of elements in a patch.
const LAYERS: [usize; 2] = [4, 24];

/// Depths over lengths of elements that have a patch of their own: powers of the fourth root of two.
const PER_OCTAVE: f64 = 4.0;

/// Displacement over `A` of rows, from the loaded one on, in units of the length of the elements.
type Kernel = [f64; REACH + 1];

/// Computes the displacement over `A` of each row of nodes by a line load at each row, with lengths in m: per flank of
/// the mesh, in the order of its surface, `rows x rows`. `None` where it cannot be computed.
///
/// # Errors
/// Memory; elements that cannot be integrated.
pub fn of_flanks(
    gear: &GearMesh,
    material: &Material,
    surface: &Surface,
) -> Result<Option<Vec<Vec<f64>>>, ReductionError> {
    let kind = gear.mesh.kind().filter(|k| k.nodes() == 8);
    if let Some(kind) = kind.filter(|_| gear.tied.is_empty())
        && let Some(all) = of_lattices(gear, kind, material)?
    {
        return Ok(Some(all));
    }
    body::of_flanks(gear, material, surface)
}

/// Of flanks that are the surface of a lattice of hexahedra of eight nodes.
fn of_lattices(
    gear: &GearMesh,
    kind: ElementKind,
    material: &Material,
) -> Result<Option<Vec<Vec<f64>>>, ElementError> {
    let mut patches = BTreeMap::new();
    let mut order: Vec<&FlankGrid> = gear.flanks.iter().collect();
    order.sort_by_key(|g| (g.tooth, g.side));
    let mut all = Vec::with_capacity(order.len());
    for grid in order {
        let Some(faces) = faces(&gear.mesh, grid) else {
            return Ok(None);
        };
        // Mean over the neighbouring rows.
        let mean = |row: usize, of: &dyn Fn(&[f64; 2]) -> f64| {
            let (before, after) = (row.saturating_sub(1), row.min(faces.len() - 1));
            0.5 * (of(&faces[before]) + of(&faces[after]))
        };
        let lengths: Vec<f64> = (0..grid.rows).map(|r| mean(r, &|f| f[0])).collect();
        let kernels = (0..grid.rows)
            .map(|r| {
                let aspect = mean(r, &|f| f[1]) / lengths[r];
                between(aspect, kind, material.poisson, &mut patches)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let positions: Vec<f64> = std::iter::once(0.0)
            .chain(faces.iter().scan(0.0, |at, f| {
                *at += f[0];
                Some(*at)
            }))
            .collect();
        let mut of_grid = Vec::with_capacity(grid.rows * grid.rows);
        for i in 0..grid.rows {
            for j in 0..grid.rows {
                let apart = i.abs_diff(j);
                of_grid.push(if apart <= REACH {
                    0.5 * (kernels[i][apart] + kernels[j][apart])
                        - 0.5 * (lengths[i] * lengths[j]).ln()
                } else {
                    -(positions[i] - positions[j]).abs().ln()
                });
            }
        }
        all.push(of_grid);
    }
    Ok(Some(all))
}

/// Length along the profile and depth of the elements below the faces of a flank, row by row, in the middle of its width.
fn faces(mesh: &Mesh, grid: &FlankGrid) -> Option<Vec<[f64; 2]>> {
    let column = (grid.columns - 1) / 2;
    let at = |row: usize, column: usize| grid.nodes[row * grid.columns + column];
    let x = |node: &u32| mesh.nodes[*node as usize];
    (0..grid.rows - 1)
        .map(|row| {
            let face = [
                at(row, column),
                at(row + 1, column),
                at(row + 1, column + 1),
                at(row, column + 1),
            ];
            let below = (mesh.elements()).find(|e| face.iter().all(|node| e.contains(node)))?;
            let middle = |nodes: &mut dyn Iterator<Item = &u32>| {
                0.25 * nodes.map(x).fold(Vec3::zeros(), |sum, x| sum + x)
            };
            let inside = middle(&mut below.iter().filter(|n| !face.contains(n)));
            let [a, b, c, d] = face.each_ref().map(x);
            let along = 0.5 * (b - a + c - d);
            let normal = along.cross(&(d - a + c - b)).normalize();
            let depth = normal.dot(&(inside - 0.25 * (a + b + c + d))).abs();
            Some([along.norm(), depth])
        })
        .collect()
}

/// The kernel of elements of a depth over their length, between those of two patches.
fn between(
    aspect: f64,
    kind: ElementKind,
    poisson: f64,
    patches: &mut BTreeMap<i32, Kernel>,
) -> Result<Kernel, ElementError> {
    let place = (PER_OCTAVE * aspect.log2()).clamp(-3.0 * PER_OCTAVE, 3.0 * PER_OCTAVE);
    let low = place.floor() as i32;
    let mut of = |i: i32| -> Result<Kernel, ElementError> {
        match patches.get(&i) {
            Some(kernel) => Ok(*kernel),
            None => {
                let kernel = patch((f64::from(i) / PER_OCTAVE).exp2(), kind, poisson)?;
                patches.insert(i, kernel);
                Ok(kernel)
            }
        }
    };
    let (low, high) = (of(low)?, of(low + 1)?);
    let u = place - place.floor();
    Ok(std::array::from_fn(|k| (1.0 - u) * low[k] + u * high[k]))
}

/// Computes the kernel of elements of length one and depth `depth`.
fn patch(depth: f64, kind: ElementKind, poisson: f64) -> Result<Kernel, ElementError> {
    // Young's modulus such that A is one.
    let material = Material {
        young: 2.0 * (1.0 - poisson * poisson) / PI,
        poisson,
        density: 1.0,
    };
    let layers = ((PATCH as f64 / depth).ceil() as usize).clamp(LAYERS[0], LAYERS[1]);
    let stiffness = plane_strain(depth, kind, &material)?;
    let levels = layers + 1;
    let columns = 2 * PATCH + 1;
    let number = |i: usize, level: usize| i * levels + level;
    // Displacement [inward, along the surface] where it is given: on all of the boundary but the surface.
    let given = |i: usize, level: usize| {
        let edge = i == 0 || i == columns - 1 || level == levels - 1;
        edge.then(|| {
            let (x, z) = (i as f64 - PATCH as f64, level as f64 * depth);
            let (r, t) = (x.hypot(z), x.atan2(z));
            let scale = 1.0 / (2.0 * (1.0 - poisson));
            let c = scale * (1.0 - 2.0 * poisson);
            [
                -r.ln() + scale * t.cos().powi(2),
                -c * t + scale * t.sin() * t.cos(),
            ]
        })
    };
    let mut free = vec![None; columns * levels];
    let mut unknowns = 0;
    for i in 0..columns {
        for level in 0..levels {
            if given(i, level).is_none() {
                free[number(i, level)] = Some(unknowns);
                unknowns += 2;
            }
        }
    }
    let mut matrix = Mat::<f64>::zeros(unknowns, unknowns);
    let mut load = Mat::<f64>::zeros(unknowns, 1);
    for i in 0..columns - 1 {
        for level in 0..layers {
            let nodes = [
                (i, level),
                (i + 1, level),
                (i + 1, level + 1),
                (i, level + 1),
            ];
            for (a, &(ia, la)) in nodes.iter().enumerate() {
                let Some(row) = free[number(ia, la)] else {
                    continue;
                };
                for (b, &(ib, lb)) in nodes.iter().enumerate() {
                    for axis in 0..2 {
                        let k = &stiffness[2 * a + axis][2 * b..2 * b + 2];
                        match (free[number(ib, lb)], given(ib, lb)) {
                            (Some(column), _) => {
                                matrix[(row + axis, column)] += k[0];
                                matrix[(row + axis, column + 1)] += k[1];
                            }
                            (None, Some(u)) => {
                                load[(row + axis, 0)] -= k[0] * u[0] + k[1] * u[1];
                            }
                            (None, None) => {}
                        }
                    }
                }
            }
        }
    }
    let loaded = free[number(PATCH, 0)].unwrap_or(0);
    load[(loaded, 0)] += 1.0;
    // Positive definite wherever the element's own stiffness is, and that was computed.
    let factor = matrix
        .llt(Side::Lower)
        .map_err(|_| ElementError::Material {
            young: material.young,
            poisson,
        })?;
    let u = factor.solve(&load);
    Ok(std::array::from_fn(|k| {
        free[number(PATCH + k, 0)].map_or(0.0, |row| u[(row, 0)])
    }))
}

/// Returns the plane-strain stiffness of an element of length one, depth `depth` and width one: `[inward, along]` of
/// its nodes, from the surface down.
fn plane_strain(
    depth: f64,
    kind: ElementKind,
    material: &Material,
) -> Result<[[f64; 8]; 8], ElementError> {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, depth], [0.0, depth]];
    let x: Vec<Vec3> = [0.0, 1.0]
        .into_iter()
        .flat_map(|y| corners.map(|[x, z]| Vec3::new(x, z, y)))
        .collect();
    let (mut k, mut mass) = (vec![0.0; 24 * 24], vec![0.0; 64]);
    Integrator::new(kind).matrices(0, &x, material, &mut k, &mut mass)?;
    let mut out = [[0.0; 8]; 8];
    for a in 0..8 {
        for b in 0..8 {
            for i in 0..2 {
                for j in 0..2 {
                    // The second axis is inward here, the first along the surface.
                    out[2 * (a % 4) + i][2 * (b % 4) + j] +=
                        k[(3 * a + 1 - i) * 24 + 3 * b + 1 - j];
                }
            }
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Square elements with incompatible modes against a computation of its own (plane strain, nu 0.3, another code);
    /// far from the load all are the half-space.
    #[test]
    fn kernels_are_those_of_a_half_space_far_away() {
        let square = patch(1.0, ElementKind::C3D8I, 0.3).unwrap();
        for (found, expected) in square.iter().zip([2.2745, -0.2014, -0.674, -1.116]) {
            assert!((found - expected).abs() < 3e-3, "{square:?}");
        }
        for aspect in [0.25, 0.5, 1.0, 2.0, 4.0] {
            let kernel = patch(aspect, ElementKind::C3D8I, 0.3).unwrap();
            for (k, x) in kernel.iter().enumerate().skip(4) {
                let error = (x + (k as f64).ln()).abs();
                assert!(error < 0.05, "depth {aspect}, {k} rows away: {error:.3}");
            }
        }
    }
}
