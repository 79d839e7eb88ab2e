//! Shapes of the kept modes at all nodes, as the basis has them at the flanks.

use super::{MeshRecovery, RecoveredModes, add};
use crate::assembly::Assembly;
use crate::assembly::tie::{MassKind, Tie};
use crate::gear_mesh::GearMesh;
use crate::modes::cyclic::{Hub, Sector};
use crate::modes::{self, Options, Target};
use crate::reduction::error::ReductionError;
use crate::vector::dot;
use faer::Mat;
use faer::prelude::Solve;
use gearbench_models::Vec3;
use std::collections::HashMap;

/// Modes of the mesh whose squared frequencies are so near that of the basis are the same.
const SAME: f64 = 1e-5;
/// Largest relative difference from the basis at the flanks.
const OFF: f64 = 1e-3;
/// Distance below which nodes of a sector and of the whole gear coincide [m].
const NEAR: f64 = 1e-8;

impl MeshRecovery {
    /// The lowest modes, up to the highest that is kept and the next: squared frequencies and shapes at all nodes.
    pub(super) fn modes_of(
        &self,
        whole: &GearMesh,
        assembly: &Assembly,
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

    /// Computes the modes from the sector of a gear with equal teeth.
    pub(super) fn modes_by_sector(
        &self,
        whole: &GearMesh,
    ) -> Result<Vec<(f64, Vec<f64>)>, ReductionError> {
        let Some(count) = self.count() else {
            return Ok(Vec::new());
        };
        let hub = Hub {
            motions: self.mounting.motions(),
            added_inertia: self.mounting.added_in_motions(),
        };
        let own = hub.motions.len();
        let search = Sector::new(&self.mesh.as_sector(), &self.material, &hub)?;
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

    /// Combines the kept modes as in the basis: those of one frequency are mixed so that they agree at the flanks.
    pub(super) fn like_basis(
        &self,
        found: &RecoveredModes,
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
                // Modes that hardly move the flanks must not make the combination singular.
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
    fn without_rigid(&self, found: &RecoveredModes, shape: &[f64]) -> Vec<f64> {
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

    /// Returns the motion of the hub in a shape for each of the rigid motions: by the tied nodes, in the least-squares
    /// sense.
    fn hub_of(&self, found: &RecoveredModes, shape: &[f64]) -> Vec<f64> {
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
}
