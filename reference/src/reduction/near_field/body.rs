//! The near field of a mesh of any elements: those about a flank themselves, cut out of the body.
//!
//! A line load on a row of the flank (inward normal `-n`, tangent `e`, length along z) has Flamant's solution in the whole
//! plane below it, wherever the body ends. On a part of the body cut out about the flank the elements are given that
//! solution: its displacements on the faces of the cut, its tractions
//!
//! ```text
//! t = s (r.m) r + nu s m_z e_z,     s = -2 cos(t)/(pi r)
//! ```
//!
//! with the outward normal `m` and the direction `r` from the line, on all faces that are free: on the end faces they hold
//! strains plane, and what free ends yield stays in the support. What the elements answer to the load at the row differs from
//! Flamant's solution by what is of the mesh alone, whatever its elements are (K. L. Johnson, *Contact Mechanics* (1985),
//! 2.2). On a flank tractions are left out nearer to the line than its neighbours are: there it goes through the line, where
//! they vanish.
//!
//! At the tip a load has no half-space below it: that row takes the value of the one before, by the distance of rows.

mod flamant;
mod quadrature;

use super::super::ReductionError;
use super::super::surface::Surface;
use crate::assembly::assemble;
use crate::assembly::tie::{MassKind, Tie};
use crate::gear_mesh::GearMesh;
use crate::limits::carried;
use crate::mesh::{self, Face, Mesh};
use crate::recognise::Facet;
use crate::recognise::tied::shape;
use crate::solve::{Cholesky, SolveError};
use faer::{Mat, Par};
use flamant::Flamant;
use gearbench_models::Vec3;
use gearbench_models::geometry::FlankGrid;
use gearbench_models::stiffness::Material;
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::f64::consts::PI;

/// Half the extent of the part that is cut out, over the length of the flank.
const EXTENT: f64 = 1.0;

/// Extent of the patch beyond the mean plane of the flank: to the fillet, not to the next tooth.
const BEYOND: f64 = 0.3;

/// Share of the distance to the next row nearer than which tractions are left out.
const NEAR: f64 = 0.75;

/// Faces with a normal nearer to z than this are end faces.
const END: f64 = 0.9;

/// How far over its length a row may leave z.
const STRAIGHT: f64 = 1e-3;

/// Displacement over `A` of each row by a line load at each row, of lengths in m; per flank, in the order of the surface.
///
/// `surface` is that of `gear`, its own flanks or more: copies of a sector come after them.
///
/// Nothing where teeth are not straight, flanks have fewer than three rows or the part cannot be factorised.
///
/// # Errors
/// Memory; elements that cannot be integrated.
pub fn of_flanks(
    gear: &GearMesh,
    material: &Material,
    surface: &Surface,
) -> Result<Option<Vec<Vec<f64>>>, ReductionError> {
    let grids = &surface.flanks.grids()[..gear.flanks.len()];
    let straight = |g: &FlankGrid| {
        let along = g.positions[g.columns - 1] - g.positions[0];
        g.rows > 2 && along.xy().norm() <= STRAIGHT * along.z.abs()
    };
    if !grids.iter().all(straight) {
        return Ok(None);
    }
    let skin = Ends::of(gear);
    let of_grid = |grid: &FlankGrid| {
        let rows = Rows::new(gear, surface, grid);
        Part::cut(&gear.mesh, &skin, &rows).near_field(material, &rows)
    };
    let all = grids.par_iter().map(carried(of_grid));
    match all.collect::<Result<Vec<_>, _>>() {
        Ok(all) => Ok(Some(all)),
        Err(ReductionError::Solve(SolveError::NotPositiveDefinite { .. })) => Ok(None),
        Err(e) => Err(e),
    }
}

/// Where a body ends.
struct Ends {
    faces: HashSet<Face>,
    /// Nodes at which a sector is cut from its neighbours: it does not end there.
    cut: HashSet<u32>,
}

impl Ends {
    fn of(gear: &GearMesh) -> Self {
        let sets = ["cut_low", "cut_high"].map(|name| gear.mesh.node_sets.get(name));
        Ends {
            faces: mesh::boundary(&gear.mesh.blocks).into_iter().collect(),
            cut: sets.into_iter().flatten().flatten().copied().collect(),
        }
    }

    fn has(&self, face: Face, corners: &[u32]) -> bool {
        self.faces.contains(&face) && !corners.iter().all(|n| self.cut.contains(n))
    }
}

/// The rows of a flank as lines along z.
struct Rows {
    /// Place and outward normal of each, z left out.
    lines: Vec<(Vec3, Vec3)>,
    /// Forces at nodes of the mesh by an outward unit load per width, row by row.
    loads: Vec<Vec<(u32, Vec3)>>,
    /// Width of the flank [m].
    width: f64,
}

impl Rows {
    fn new(gear: &GearMesh, surface: &Surface, grid: &FlankGrid) -> Self {
        let at = |row: usize, column: usize| row * grid.columns + column;
        let z = |column: usize| grid.positions[at(0, column)].z;
        let width = (z(grid.columns - 1) - z(0)).abs();
        // Each column represents half of the width on either side of it.
        let share = |c: usize| {
            let (before, after) = (c.saturating_sub(1), (c + 1).min(grid.columns - 1));
            0.5 * (z(after) - z(before)).abs()
        };
        let (mut lines, mut loads) = (Vec::new(), Vec::new());
        for row in 0..grid.rows {
            let (mut place, mut normal) = (Vec3::zeros(), Vec3::zeros());
            let mut load = Vec::new();
            for column in 0..grid.columns {
                let node = grid.nodes[at(row, column)] as usize;
                let place_of = node * surface.per_node();
                let n = surface.directions[place_of];
                for (node, w) in surface.follows(place_of) {
                    let w = w * share(column);
                    place += w / width * gear.mesh.nodes[node as usize];
                    load.push((node, w * n));
                }
                normal += n;
            }
            place.z = 0.0;
            normal.z = 0.0;
            lines.push((place, normal.normalize()));
            loads.push(load);
        }
        Rows {
            lines,
            loads,
            width,
        }
    }

    fn length(&self) -> f64 {
        let [first, .., last] = &*self.lines else {
            return 0.0;
        };
        (last.0 - first.0).norm()
    }

    /// Distance to the nearest other row.
    fn spacing(&self, row: usize) -> f64 {
        let others = [row.checked_sub(1), Some(row + 1)];
        let distance = |r: usize| Some((self.lines.get(r)?.0 - self.lines[row].0).norm());
        (others.into_iter().flatten().filter_map(distance)).fold(f64::MAX, f64::min)
    }
}

/// A part of a body about a flank.
struct Part {
    mesh: Mesh,
    /// Node of the part per node of the body.
    place: HashMap<u32, u32>,
    /// Nodes on the faces at which it was cut out.
    cut: Vec<u32>,
    free: Vec<FreeFace>,
}

/// A face at which the body ends.
struct FreeFace {
    facet: Facet,
    /// It is an end face of the teeth.
    end: bool,
}

impl Part {
    /// Cuts the elements about a flank out.
    fn cut(body: &Mesh, skin: &Ends, rows: &Rows) -> Self {
        let count = rows.lines.len() as f64;
        let mean = |of: fn(&(Vec3, Vec3)) -> Vec3| rows.lines.iter().map(of).sum::<Vec3>() / count;
        let (centre, normal) = (mean(|l| l.0), mean(|l| l.1).normalize());
        let length = rows.length();
        let inside = |nodes: &[u32]| {
            let sum: Vec3 = nodes.iter().map(|&n| body.nodes[n as usize]).sum();
            let mut d = sum / nodes.len() as f64 - centre;
            d.z = 0.0;
            d.norm() < EXTENT * length && d.dot(&normal) < BEYOND * length
        };
        let (mut mesh, mut place, mut of_body) = (
            Mesh {
                nodes: Vec::new(),
                blocks: Vec::new(),
                node_sets: Default::default(),
                face_sets: Default::default(),
            },
            HashMap::new(),
            Vec::new(),
        );
        let mut before = 0;
        for block in &body.blocks {
            for (e, nodes) in block.elements().enumerate().filter(|(_, n)| inside(n)) {
                of_body.push((before + e) as u32);
                let own = nodes.iter().map(|&n| {
                    *place.entry(n).or_insert_with(|| {
                        mesh.nodes.push(body.nodes[n as usize]);
                        mesh.nodes.len() as u32 - 1
                    })
                });
                mesh::push(&mut mesh.blocks, block.kind, own.collect::<Vec<_>>());
            }
            before += block.element_count();
        }
        let (mut cut, mut free) = (Vec::new(), Vec::new());
        let back: HashMap<u32, u32> = place.iter().map(|(body, own)| (*own, *body)).collect();
        for face in mesh::boundary(&mesh.blocks) {
            let (kind, nodes) = mesh.element_of(face.element as usize);
            let face_nodes: Vec<u32> = (kind.face_nodes(face.face.into()))
                .map(|i| nodes[i])
                .collect();
            let sides = kind.faces()[usize::from(face.face)].len();
            let (corners, mids) = face_nodes.split_at(sides);
            let in_body = Face {
                element: of_body[face.element as usize],
                face: face.face,
            };
            let corners_in_body: Vec<u32> = corners.iter().map(|n| back[n]).collect();
            if !skin.has(in_body, &corners_in_body) {
                cut.extend(face_nodes);
                continue;
            }
            let Some(facet) = Facet::new(face, corners, mids) else {
                continue;
            };
            let (_, [a, b]) = point(&facet, &mesh.nodes, [1.0 / 3.0; 2]);
            let normal = b.cross(&a);
            let end = normal.z.abs() > END * normal.norm();
            free.push(FreeFace { facet, end });
        }
        cut.sort_unstable();
        cut.dedup();
        Part {
            mesh,
            place,
            cut,
            free,
        }
    }

    /// Displacement of each row by a line load at each.
    fn near_field(&self, material: &Material, rows: &Rows) -> Result<Vec<f64>, ReductionError> {
        let assembly = assemble(&self.mesh, material)?;
        let tie = Tie::new(&self.mesh.nodes, &self.cut, &[]);
        let stiffness = tie.reduce(&assembly, &[], MassKind::Lumped).stiffness;
        let factor = Cholesky::new(stiffness.as_ref())?;
        let compliance = 2.0 * (1.0 - material.poisson.powi(2)) / (PI * material.young);
        let count = rows.lines.len();
        let size = 3 * self.mesh.nodes.len();
        let (mut image, mut reduced) = (vec![0.0; size], vec![0.0; tie.coordinates()]);
        let mut given = vec![vec![0.0; size]; count];
        let mut x = Mat::<f64>::zeros(reduced.len(), count);
        for (row, u) in given.iter_mut().enumerate() {
            let field = Flamant::new(&rows.lines[row], material.poisson);
            for &n in &self.cut {
                let moved = compliance * field.displacement(&self.mesh.nodes[n as usize]);
                u[3 * n as usize..][..3].copy_from_slice(moved.as_slice());
            }
            assembly.stiffness.apply(u, &mut image);
            image.iter_mut().for_each(|f| *f = -*f);
            self.add_tractions(&field, NEAR * rows.spacing(row), &mut image);
            for (node, w) in &rows.loads[row] {
                if let Some(&n) = self.place.get(node) {
                    (0..3).for_each(|i| image[3 * n as usize + i] -= w[i]);
                }
            }
            tie.gather(&image, &mut reduced);
            x.col_mut(row)
                .iter_mut()
                .zip(&reduced)
                .for_each(|(x, f)| *x = *f);
        }
        factor.solve_many(x.as_mut(), Par::Seq);
        let mut of_rows = vec![0.0; count * count];
        for (row, u) in given.iter_mut().enumerate() {
            for (i, x) in x.col(row).iter().enumerate() {
                u[3 * tie.free[i / 3] as usize + i % 3] = *x;
            }
            for (other, load) in rows.loads.iter().enumerate() {
                let outwards = load.iter().map(|(node, w)| {
                    let n = self.place.get(node).map_or(0, |n| 3 * *n as usize);
                    w.x * u[n] + w.y * u[n + 1] + w.z * u[n + 2]
                });
                of_rows[row * count + other] = -outwards.sum::<f64>() / (rows.width * compliance);
            }
        }
        Ok(symmetric(of_rows, rows))
    }

    /// Adds the forces of the tractions on free faces.
    fn add_tractions(&self, field: &Flamant, nearest: f64, forces: &mut [f64]) {
        for free in &self.free {
            let facet = &free.facet;
            let nearest = if free.end { 0.0 } else { nearest };
            quadrature::each(facet.corners().len(), |xi, axes| {
                let (x, along) = point(facet, &self.mesh.nodes, xi);
                // A piece as large as its distance to the line is divided further.
                let size = axes.map(|a| (a[0] * along[0] + a[1] * along[1]).norm());
                field.distance(&x) < 2.0 * size[0].max(size[1])
            })
            .for_each(|(xi, weight)| {
                let (x, along) = point(facet, &self.mesh.nodes, xi);
                if field.distance(&x) < nearest {
                    return;
                }
                let area = along[1].cross(&along[0]);
                let size = area.norm();
                let force = weight * size * field.traction(&x, &(area / size));
                for ((value, _), &n) in shape(facet, xi).iter().zip(facet.nodes()) {
                    (0..3).for_each(|i| forces[3 * n as usize + i] += value * force[i]);
                }
            });
        }
    }
}

/// Averages both directions; at the tip it uses the effect of a load before it, and the load itself as in the row
/// before.
fn symmetric(found: Vec<f64>, rows: &Rows) -> Vec<f64> {
    let n = rows.lines.len();
    let tip = n - 1;
    let mut out = found.clone();
    for i in 0..n {
        for j in 0..n {
            out[i * n + j] = match (i == tip, j == tip) {
                (true, true) => {
                    let before = found[(tip - 1) * n + tip - 1];
                    before - (rows.spacing(tip) / rows.spacing(tip - 1)).ln()
                }
                (true, false) => found[j * n + i],
                (false, true) => found[i * n + j],
                (false, false) => 0.5 * (found[i * n + j] + found[j * n + i]),
            };
        }
    }
    out
}

/// Place on a face and its derivatives by the natural coordinates. Corners run about the inward normal.
fn point(facet: &Facet, nodes: &[Vec3], xi: [f64; 2]) -> (Vec3, [Vec3; 2]) {
    let (mut x, mut along) = (Vec3::zeros(), [Vec3::zeros(); 2]);
    for ((value, slopes), &n) in shape(facet, xi).iter().zip(facet.nodes()) {
        let node = &nodes[n as usize];
        x += *value * node;
        along[0] += slopes[0] * node;
        along[1] += slopes[1] * node;
    }
    (x, along)
}

#[cfg(test)]
mod tests;
