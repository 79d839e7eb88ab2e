//! The nodes behind a reduction, for pictures: what modes and forces on flanks do to the whole mesh.
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
//! Modes are computed again, by the route that the basis came from, and only once somebody asks. The two of a pair of equal
//! frequency come out as any two of their plane: at the flanks they are turned to those of the basis.

use super::error::ReductionError;
use super::mounting::field;
use super::{Basis, Mounting, Surface};
use crate::assembly::assemble;
use crate::assembly::tie::{MassKind, Tie};
use crate::limits;
use crate::mesh::{self, GearMesh, GearMeshParams, vtu};
use crate::modes::cyclic::{Hub, Sector};
use crate::modes::{self, Options, Target};
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
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

/// Modes of the mesh whose squared frequencies are so near that of the basis are the same.
const SAME: f64 = 1e-5;
/// What they may be off the basis at the flanks.
const OFF: f64 = 1e-3;
/// Nodes of a sector and of the whole gear that are so near are one [m].
const NEAR: f64 = 1e-8;

/// Where the whole mesh comes from.
#[derive(Clone, Debug)]
pub(super) enum Whole {
    /// It is generated; the mesh at hand is a sector of it.
    Generated(Toothing, Box<GearMeshParams>),
    /// The mesh at hand is the whole.
    AtHand,
}

/// What the nodes of a reduced gear follow from.
#[derive(Debug)]
pub(super) struct OfMesh {
    pub(super) mesh: GearMesh,
    pub(super) whole: Whole,
    pub(super) material: Material,
    pub(super) mounting: Mounting,
    pub(super) basis: Arc<Basis>,
    /// Modes of the basis that are kept, ascending.
    pub(super) kept: Vec<usize>,
    /// With the compliance of the others.
    pub(super) residual: bool,
    /// Forces act on lines over strips of the width.
    pub(super) strips: Option<Strips>,
    pub(super) found: OnceLock<Result<Found, Reason>>,
}

/// The mesh with all that displaces it.
#[derive(Debug)]
pub(super) struct Found {
    nodes: Vec<Vec3>,
    cells: Arc<Cells>,
    /// Shapes of the kept modes, three components per node.
    shapes: Vec<Vec<f64>>,
    surface: Surface,
    /// Lines as sums of flank nodes.
    lines: Option<Vec<Sum>>,
    tie: Tie,
    factor: Cholesky,
    /// Rigid motions that are free: displacements, mass times these, their static response on the held hub.
    rigid: Vec<[Vec<f64>; 3]>,
    /// Inverse of the inertias of the rigid motions.
    inverse: Mat<f64>,
}

impl Recovery for OfMesh {
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

impl OfMesh {
    fn found(&self) -> Result<&Found, Reason> {
        let found = self.found.get_or_init(|| self.find());
        found.as_ref().map_err(Clone::clone)
    }

    fn find(&self) -> Result<Found, Reason> {
        let whole = match &self.whole {
            Whole::AtHand => self.mesh.clone(),
            Whole::Generated(Toothing::Gear(gear), params) => {
                mesh::gear(gear, params).map_err(|e| Reason::from(e.to_string()))?
            }
            Whole::Generated(Toothing::Rack(rack), params) => {
                mesh::rack(rack, params).map_err(|e| Reason::from(e.to_string()))?
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
    fn on(&self, whole: &GearMesh) -> Result<Found, ReductionError> {
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
        let mut found = Found {
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
            Whole::AtHand => self.modes_of(whole, &assembly)?,
            Whole::Generated(..) => self.modes_by_sector(whole)?,
        };
        found.shapes = self.like_basis(&found, shapes)?;
        Ok(found)
    }

    /// The lowest modes, up to the highest that is kept and the next: squared frequencies and shapes at all nodes.
    fn modes_of(
        &self,
        whole: &GearMesh,
        assembly: &crate::assembly::Assembly,
    ) -> Result<Vec<(f64, Vec<f64>)>, ReductionError> {
        let Some(count) = self.count() else {
            return Ok(Vec::new());
        };
        let motions = self.mounting.motions();
        let tie = Tie::new(&whole.mesh.nodes, &whole.bore, &motions);
        let added = self.mounting.added_in_motions();
        let pair = tie.reduce(assembly, &added, MassKind::Consistent);
        let count = (count + motions.len()).min(tie.coordinates());
        let found = modes::find(&pair, Target::Count(count), &Options::default())?;
        let shape = |mode: usize| {
            let vector: Vec<f64> = found.vectors.col(mode).iter().copied().collect();
            let mut full = vec![0.0; 3 * whole.mesh.nodes.len()];
            tie.expand(&vector, &mut full);
            (found.omega2[mode], full)
        };
        Ok((motions.len()..found.omega2.len()).map(shape).collect())
    }

    /// The same by the sector of a gear whose teeth are all alike.
    fn modes_by_sector(&self, whole: &GearMesh) -> Result<Vec<(f64, Vec<f64>)>, ReductionError> {
        let Some(count) = self.count() else {
            return Ok(Vec::new());
        };
        let hub = Hub {
            motions: self.mounting.motions(),
            added_inertia: self.mounting.added_in_motions(),
        };
        let own = hub.motions.len();
        let search = Sector::new(&self.mesh, &self.material, &hub)?;
        let all = search.unknowns() * self.mesh.teeth as usize;
        let target = Target::Count((count + own).min(all));
        let found = search.find(target, &Options::default())?;
        let places = self.places(whole)?;
        let highest = self.basis.omega[count.min(self.basis.omega.len()) - 1].powi(2);
        let mut of_sector = vec![0.0; 3 * self.mesh.mesh.nodes.len()];
        let mut shapes = Vec::new();
        for mode in own..found.modes.len() {
            if found.modes[mode].omega2 > highest * (1.0 + SAME) {
                break;
            }
            let mut full = vec![0.0; 3 * whole.mesh.nodes.len()];
            for (tooth, places) in (0..).zip(&places) {
                found.expand(mode, tooth, &mut of_sector);
                for (&node, u) in places.iter().zip(of_sector.chunks_exact(3)) {
                    full[3 * node as usize..][..3].copy_from_slice(u);
                }
            }
            shapes.push((found.modes[mode].omega2, full));
        }
        Ok(shapes)
    }

    /// Modes to look for; `None` where none is kept.
    fn count(&self) -> Option<usize> {
        let highest = *self.kept.last()?;
        let family = self.basis.family[highest];
        Some(self.basis.family.partition_point(|f| *f <= family))
    }

    /// Per tooth the nodes of the whole gear that the nodes of the sector are.
    fn places(&self, whole: &GearMesh) -> Result<Vec<Vec<u32>>, ReductionError> {
        let key = |x: &Vec3, by: [i64; 3]| {
            let of = |axis: usize| (x[axis] / NEAR / 4.0).floor() as i64 + by[axis];
            [of(0), of(1), of(2)]
        };
        let nodes = &whole.mesh.nodes;
        let numbered = (0..).zip(nodes);
        let table: HashMap<[i64; 3], u32> = numbered.map(|(i, x)| (key(x, [0; 3]), i)).collect();
        let find = |x: &Vec3| {
            let around = (0..27).map(|k| key(x, [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1]));
            let mut near = around.filter_map(|k| table.get(&k).copied());
            near.find(|i| (nodes[*i as usize] - x).norm() < NEAR)
        };
        let pitch = std::f64::consts::TAU / f64::from(self.mesh.teeth);
        (0..self.mesh.teeth)
            .map(|tooth| {
                let (sin, cos) = (pitch * f64::from(tooth)).sin_cos();
                let turned =
                    |x: &Vec3| Vec3::new(cos * x.x - sin * x.y, sin * x.x + cos * x.y, x.z);
                let places = self.mesh.mesh.nodes.iter().map(|x| find(&turned(x)));
                places.collect::<Option<Vec<u32>>>().ok_or_else(|| {
                    let why = format!("the sector of tooth {} is no part of the mesh", tooth + 1);
                    ReductionError::Mismatch(why)
                })
            })
            .collect()
    }

    /// Shapes of the kept modes as the basis has them: those of one frequency mixed so that they are its own at the flanks.
    fn like_basis(
        &self,
        found: &Found,
        modes: Vec<(f64, Vec<f64>)>,
    ) -> Result<Vec<Vec<f64>>, ReductionError> {
        let basis = &self.basis;
        let (rows, all) = (basis.directions(), basis.omega.len());
        let mut shapes = Vec::with_capacity(self.kept.len());
        for &mode in &self.kept {
            let omega2 = basis.omega[mode].powi(2);
            let same: Vec<Vec<f64>> = (modes.iter())
                .filter(|(of, _)| (of - omega2).abs() <= SAME * omega2)
                .map(|(_, shape)| self.without_rigid(found, shape))
                .collect();
            let along = |shape: &Vec<f64>| {
                let mut out = vec![0.0; rows];
                found.surface.along_directions(shape, &mut out);
                out
            };
            let at_flanks: Vec<Vec<f64>> = same.iter().map(along).collect();
            let wanted: Vec<f64> = (0..rows).map(|k| basis.shapes[k * all + mode]).collect();
            let size = dot(&wanted, &wanted);
            let n = same.len();
            let gram = Mat::from_fn(n, n, |i, j| {
                // What hardly moves the flanks must not make the mixture singular.
                let more = if i == j { 1e-12 * size } else { 0.0 };
                dot(&at_flanks[i], &at_flanks[j]) + more
            });
            let onto = Mat::from_fn(n, 1, |i, _| dot(&at_flanks[i], &wanted));
            let mixture = gram.partial_piv_lu().solve(onto);
            let mut rest = wanted;
            let mut shape = vec![0.0; 3 * found.nodes.len()];
            for i in 0..n {
                add(-mixture[(i, 0)], &at_flanks[i], &mut rest);
                add(mixture[(i, 0)], &same[i], &mut shape);
            }
            let off = (dot(&rest, &rest) / size.max(f64::MIN_POSITIVE)).sqrt();
            if off.is_nan() || off > OFF {
                let hertz = basis.omega[mode] / std::f64::consts::TAU;
                return Err(ReductionError::Mismatch(format!(
                    "the mode at {hertz:.6e} Hz is found again only but for {:.1e} of it at the flanks",
                    off
                )));
            }
            shapes.push(shape);
        }
        Ok(shapes)
    }

    /// A shape without rigid motion, of which rounding and the tolerance of the search leave some.
    fn without_rigid(&self, found: &Found, shape: &[f64]) -> Vec<f64> {
        let mut shape = shape.to_vec();
        // One motion alone holds no momentum in elastic modes by itself, and what is added at the hub moves with it.
        if self.mounting.is_lateral() {
            let added = self.mounting.added_in_motions();
            let hub = self.hub_of(found, &shape);
            let momenta: Vec<f64> = (found.rigid.iter().zip(&added).zip(&hub))
                .map(|(([_, image, _], added), h)| dot(image, &shape) + added * h)
                .collect();
            found.take_rigid(&momenta, &mut shape);
        }
        shape
    }

    /// How a shape moves the hub in each of the rigid motions: by the held nodes, in the least squares.
    fn hub_of(&self, found: &Found, shape: &[f64]) -> Vec<f64> {
        let held: Vec<usize> = (0..found.nodes.len())
            .filter(|n| found.tie.place[*n] == Tie::HELD)
            .flat_map(|n| 3 * n..3 * n + 3)
            .collect();
        let over = |a: &[f64], b: &[f64]| held.iter().map(|i| a[*i] * b[*i]).sum::<f64>();
        let n = found.rigid.len();
        let gram = Mat::from_fn(n, n, |i, j| over(&found.rigid[i][0], &found.rigid[j][0]));
        let onto = Mat::from_fn(n, 1, |i, _| over(&found.rigid[i][0], shape));
        let hub = gram.partial_piv_lu().solve(onto);
        (0..n).map(|i| hub[(i, 0)]).collect()
    }

    /// `(P^T K_c^-1 P - Phi Omega^-2 Phi^T) f`.
    fn add_static(&self, found: &Found, load: &BodyLoad, u: &mut [f64]) {
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
        for (&mode, shape) in self.kept.iter().zip(&found.shapes) {
            let own = dot(shape, &f) + turning * basis.hub[mode];
            add(-own / basis.omega[mode].powi(2), shape, &mut w);
        }
        add(1.0, &w, u);
    }
}

impl Found {
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
