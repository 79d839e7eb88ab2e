//! Full mesh behind a reduction, for figures: displacements of all nodes from modes and flank forces.
//!
//! A reduction keeps what happens at the flanks. Here the rest is found again from the mesh: shapes of the kept modes at all
//! nodes, and the static displacement that the modes which were cut follow with,
//!
//! ```text
//! u = Phi q + (P^T K_c^-1 P - Phi Omega^-2 Phi^T) f
//! ```
//!
//! with the nodal forces `f` of contact and hub, the rigid motions that `P = I - M e J^-1 e^T` relieves of their load, and the
//! stiffness `K_c` of the held hub (as in `compliance`). Along the normals of the flanks that is the displacement that
//! the gear itself computes with.
//!
//! Modes are computed again, by the method of the basis, and only when needed. The two of a pair of equal frequency
//! are arbitrary in their plane: they are rotated to agree with those of the basis at the flanks.

mod modes;

use super::choose::FittedModes;
use super::error::ReductionError;
use super::mounting::field;
use super::{Basis, Mounting, Surface};
use crate::assembly::assemble;
use crate::assembly::tie::{MassKind, Tie};
use crate::gear_mesh::{self, GearMesh, GearMeshParams};
use crate::limits;
use crate::mesh::vtu;
use crate::solve::Cholesky;
use crate::vector::dot;
use faer::prelude::Solve;
use faer::{Mat, Par};
use gearbench_models::Vec3;
use gearbench_models::error::Reason;
use gearbench_models::gear::elastic::lines::{LinesOfFlanks, Strips, Sum};
use gearbench_models::gear::{BodyLoad, Recovery};
use gearbench_models::geometry::swept::Cells;
use gearbench_models::spec::Body as Toothing;
use gearbench_models::stiffness::Material;
use std::sync::{Arc, OnceLock};

/// Where the whole mesh comes from.
#[derive(Clone, Debug)]
pub(super) enum MeshExtent {
    /// It is generated; the mesh at hand is a sector of it.
    Generated(Box<(Toothing, GearMeshParams)>),
    /// The mesh at hand is the whole.
    AtHand,
}

/// Data from which the nodal displacements of a reduced gear follow.
#[derive(Debug)]
pub(super) struct MeshRecovery {
    pub(super) mesh: GearMesh,
    pub(super) whole: MeshExtent,
    pub(super) material: Material,
    pub(super) mounting: Mounting,
    pub(super) basis: Arc<Basis>,
    /// Kept modes of the basis, ascending; fitted modes are combinations of these.
    pub(super) kept: Vec<usize>,
    /// Modes that are made of these.
    pub(super) made: Option<FittedModes>,
    /// With the compliance of the others.
    pub(super) residual: bool,
    /// Forces act on lines over strips of the width.
    pub(super) strips: Option<Strips>,
    pub(super) found: OnceLock<Result<RecoveredModes, Reason>>,
}

/// The mesh with all that displaces it.
#[derive(Debug)]
pub(super) struct RecoveredModes {
    nodes: Vec<Vec3>,
    cells: Arc<Cells>,
    /// Shapes of the kept modes, three components per node.
    shapes: Vec<Vec<f64>>,
    surface: Surface,
    /// Lines as sums of flank nodes.
    lines: Option<Vec<Sum>>,
    tie: Tie,
    factor: Cholesky,
    /// Free rigid motions: displacements, mass times these, and their static response on the fixed hub.
    rigid: Vec<[Vec<f64>; 3]>,
    /// Inverse of the inertias of the rigid motions.
    inverse: Mat<f64>,
}

impl Recovery for MeshRecovery {
    fn cells(&self) -> Result<Arc<Cells>, Reason> {
        Ok(self.found()?.cells.clone())
    }

    fn displacements(&self, modes: &[f64], load: &BodyLoad) -> Result<[Vec<Vec3>; 2], Reason> {
        let found = self.found()?;
        let mut u = vec![0.0; 3 * found.nodes.len()];
        for (q, shape) in modes.iter().zip(&found.shapes) {
            add(*q, shape, &mut u);
        }
        if self.residual {
            self.add_static(found, load, &mut u);
        }
        let u = u.chunks_exact(3).map(Vec3::from_column_slice).collect();
        Ok([found.nodes.clone(), u])
    }
}

fn add(by: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += by * x;
    }
}

impl MeshRecovery {
    fn found(&self) -> Result<&RecoveredModes, Reason> {
        let found = self.found.get_or_init(|| self.find());
        found.as_ref().map_err(Clone::clone)
    }

    fn find(&self) -> Result<RecoveredModes, Reason> {
        let whole = match &self.whole {
            MeshExtent::AtHand => self.mesh.clone(),
            MeshExtent::Generated(of) => {
                let (body, params) = of.as_ref();
                let whole = match body {
                    Toothing::Gear(gear) => gear_mesh::gear(gear, params),
                    Toothing::Rack(rack) => gear_mesh::rack(rack, params),
                };
                whole.map_err(|e| Reason::from(e.to_string()))?
            }
        };
        let n = 3 * whole.mesh.nodes.len();
        let what = format!("shapes of {} modes at {n} displacements", self.kept.len());
        let bytes = 8.0 * 3.0 * self.kept.len() as f64 * n as f64;
        limits::check(what, bytes, "keep fewer modes, or use fewer elements")
            .map_err(|e| Reason::from(e.to_string()))?;
        self.on(&whole).map_err(|e| e.to_string().into())
    }

    /// All that displaces a mesh.
    fn on(&self, whole: &GearMesh) -> Result<RecoveredModes, ReductionError> {
        let nodes = &whole.mesh.nodes;
        let surface = Surface::new(whole)?;
        let surface = match self.basis.along_profile {
            true => surface.with_profile(),
            false => surface,
        };
        let lines = match (self.strips, &self.basis.near_field) {
            (Some(strips), Some(near)) => {
                let lines = LinesOfFlanks::new(&surface.flanks, near, strips);
                let lines = lines.map_err(|e| ReductionError::Mismatch(e.to_string()))?;
                Some(lines.sums)
            }
            _ => None,
        };
        let assembly = assemble(&whole.mesh, &self.material)?;
        let tie = Tie::new(nodes, &whole.bore, &[]);
        let held = tie.reduce(&assembly, &[], MassKind::Consistent);
        let factor = Cholesky::new(held.stiffness.as_ref())?;
        drop(held);

        let motions = self.mounting.motions();
        let added = self.mounting.added_in_motions();
        let rigid: Vec<[Vec<f64>; 3]> = (motions.iter())
            .map(|motion| {
                let unit = field(*motion, nodes);
                let mut image = vec![0.0; unit.len()];
                assembly.mass.apply(&unit, &mut image);
                let response = static_response(&tie, &factor, &image);
                [unit, image, response]
            })
            .collect();
        let inertia = Mat::from_fn(rigid.len(), rigid.len(), |i, j| {
            dot(&rigid[i][0], &rigid[j][1]) + if i == j { added[i] } else { 0.0 }
        });
        let identity = Mat::<f64>::identity(rigid.len(), rigid.len());
        let mut found = RecoveredModes {
            nodes: nodes.clone(),
            cells: Arc::new(vtu::cells(&whole.mesh)),
            shapes: Vec::new(),
            surface,
            lines,
            tie,
            factor,
            inverse: inertia.partial_piv_lu().solve(identity),
            rigid,
        };
        let shapes = match self.whole {
            MeshExtent::AtHand => self.modes_of(whole, &assembly)?,
            MeshExtent::Generated(..) => self.modes_by_sector(whole)?,
        };
        let shapes = self.like_basis(&found, shapes)?;
        found.shapes = match &self.made {
            Some(made) => combined(made, &shapes),
            None => shapes,
        };
        Ok(found)
    }

    /// `(P^T K_c^-1 P - Phi Omega^-2 Phi^T) f`.
    fn add_static(&self, found: &RecoveredModes, load: &BodyLoad, u: &mut [f64]) {
        let (basis, surface) = (&self.basis, &found.surface);
        let per_node = basis.per_node();
        let count = found.lines.as_ref().map_or(basis.normals.len(), Vec::len);
        let mut f = vec![0.0; u.len()];
        for &(number, force) in &load.forces {
            let number = number as usize;
            let (number, direction) = if number < count {
                (number, 0)
            } else {
                (number - count, 1)
            };
            let own = [(number, 1.0)];
            let sum: &[(usize, f64)] = match &found.lines {
                Some(lines) => &lines[number],
                None => &own,
            };
            for &(node, weight) in sum {
                let row = node * per_node + direction;
                let along = surface.directions[row];
                for (mesh_node, share) in surface.follows(row) {
                    // Forces press into the tooth, displacements count outwards.
                    let by = -force * weight * share;
                    for axis in 0..3 {
                        f[3 * mesh_node as usize + axis] += by * along[axis];
                    }
                }
            }
        }
        let turning = if self.mounting.free { load.hub } else { 0.0 };
        let mut momenta: Vec<f64> = found.rigid.iter().map(|[e, ..]| dot(e, &f)).collect();
        if let (true, Some(own)) = (self.mounting.free, momenta.first_mut()) {
            *own += turning;
        }
        let mut w = static_response(&found.tie, &found.factor, &f);
        let accelerations = found.times_inverse(&momenta);
        for (a, [_, _, response]) in accelerations.iter().zip(&found.rigid) {
            add(-a, response, &mut w);
        }
        let momenta: Vec<f64> = (found.rigid.iter())
            .map(|[_, image, _]| dot(image, &w))
            .collect();
        found.take_rigid(&momenta, &mut w);
        let own: Vec<(f64, f64)> = match &self.made {
            Some(FittedModes { basis, .. }) => {
                let omega = basis.omega.iter().copied();
                omega.zip(basis.hub.iter().copied()).collect()
            }
            None => {
                let of = |&mode: &usize| (basis.omega[mode], basis.hub[mode]);
                self.kept.iter().map(of).collect()
            }
        };
        for ((omega, hub), shape) in own.into_iter().zip(&found.shapes) {
            let own = dot(shape, &f) + turning * hub;
            add(-own / omega.powi(2), shape, &mut w);
        }
        add(1.0, &w, u);
    }
}

impl RecoveredModes {
    fn times_inverse(&self, x: &[f64]) -> Vec<f64> {
        let row = |i: usize| (0..x.len()).map(|j| self.inverse[(i, j)] * x[j]).sum();
        (0..x.len()).map(row).collect()
    }

    /// Takes rigid motion with these momenta out of a displacement.
    fn take_rigid(&self, momenta: &[f64], w: &mut [f64]) {
        for (share, [unit, ..]) in self.times_inverse(momenta).iter().zip(&self.rigid) {
            add(-share, unit, w);
        }
    }
}

/// Shapes of modes that are made of the first of a basis.
fn combined(made: &FittedModes, shapes: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let count = made.basis.omega.len();
    let length = shapes.first().map_or(0, Vec::len);
    let mut out = vec![vec![0.0; length]; count];
    for (part, shape) in made.span.chunks_exact(count.max(1)).zip(shapes) {
        for (by, out) in part.iter().zip(&mut out) {
            add(*by, shape, out);
        }
    }
    out
}

/// `K_c^-1 f` at all nodes.
fn static_response(tie: &Tie, factor: &Cholesky, f: &[f64]) -> Vec<f64> {
    let mut own = vec![0.0; tie.coordinates()];
    tie.gather(f, &mut own);
    let mut x = Mat::from_fn(own.len(), 1, |i, _| own[i]);
    factor.solve_many(x.as_mut(), Par::Seq);
    let own: Vec<f64> = x.col(0).iter().copied().collect();
    let mut full = vec![0.0; f.len()];
    tie.expand(&own, &mut full);
    full
}

#[cfg(test)]
mod tests;
