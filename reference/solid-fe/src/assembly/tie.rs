//! Rigid tie of the bore nodes to the hub point, and the matrices over the free coordinates.
//!
//! `u = T r`: a free node keeps its three displacements, a held node follows the hub. Reduced coordinates are
//! `3 place + axis` of the free nodes in ascending order, then one per motion that the hub is free in;
//! motions that are not listed are fixed. `K_r = T^T K T` and `M_r = T^T M T + diag(0, added)`.

use super::blocks::Entry;
use super::{Assembly, NodalMatrix, ScalarMatrix};
use crate::Vec3;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use serde::{Deserialize, Serialize};

/// A motion that the hub may be free in, about or along axes through the origin of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HubMotion {
    /// Rotation about z.
    Turn,
    /// Turning about a unit axis.
    TurnAbout(Vec3),
    /// Sliding along a unit direction.
    Slide(Vec3),
}

impl HubMotion {
    /// Displacement of a point of the hub per unit of the motion.
    pub fn of(self, x: &Vec3) -> Vec3 {
        match self {
            HubMotion::Turn => Vec3::new(-x.y, x.x, 0.0),
            HubMotion::TurnAbout(axis) => axis.cross(x),
            HubMotion::Slide(direction) => direction,
        }
    }
}

/// Kind of the mass matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum MassKind {
    /// As the elements integrate it.
    Consistent,
    /// Lumped, diagonal mass matrix.
    Lumped,
}

/// Which coordinates stay free.
#[derive(Clone, Debug)]
pub struct Tie {
    /// Free nodes in ascending order.
    pub free: Vec<u32>,
    /// Per node its place in `free`, or [`Tie::HELD`].
    pub place: Vec<u32>,
    /// Held nodes with their displacement per unit of each hub motion.
    held: Vec<(u32, Vec<Vec3>)>,
    motions: usize,
}

/// Reduced matrices: lower triangles, diagonal included.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// Stiffness matrix over the free coordinates.
    pub stiffness: SparseColMat<usize, f64>,
    /// Mass matrix over the free coordinates.
    pub mass: SparseColMat<usize, f64>,
}

impl Reduced {
    /// Returns the matrices with some coordinates fixed at zero: their rows and columns are removed.
    ///
    /// # Panics
    /// If `held` has fewer values than there are coordinates.
    pub fn held(&self, held: &[bool]) -> Self {
        let mut place = vec![usize::MAX; held.len()];
        let free: Vec<usize> = (0..held.len()).filter(|&i| !held[i]).collect();
        for (new, &old) in free.iter().enumerate() {
            place[old] = new;
        }
        let strike = |a: &SparseColMat<usize, f64>| {
            let mut starts = vec![0];
            let (mut rows, mut values) = (Vec::new(), Vec::new());
            for &column in &free {
                for (row, value) in a.row_idx_of_col(column).zip(a.val_of_col(column)) {
                    if !held[row] {
                        rows.push(place[row]);
                        values.push(*value);
                    }
                }
                starts.push(rows.len());
            }
            let n = free.len();
            SparseColMat::new(
                SymbolicSparseColMat::new_checked(n, n, starts, None, rows),
                values,
            )
        };
        Reduced {
            stiffness: strike(&self.stiffness),
            mass: strike(&self.mass),
        }
    }
}

impl Tie {
    /// Mark of a node that is tied to the hub.
    pub const HELD: u32 = u32::MAX;

    /// Ties the bore nodes; the hub is free in the motions listed. None: the bore is clamped.
    ///
    /// # Panics
    /// If a bore node is none of the nodes.
    pub fn new(nodes: &[Vec3], bore: &[u32], motions: &[HubMotion]) -> Self {
        let mut place = vec![0; nodes.len()];
        for &node in bore {
            place[node as usize] = Self::HELD;
        }
        let mut free = Vec::new();
        let mut held = Vec::new();
        for (node, place) in place.iter_mut().enumerate() {
            if *place == Self::HELD {
                let moved = motions.iter().map(|m| m.of(&nodes[node])).collect();
                held.push((node as u32, moved));
            } else {
                *place = free.len() as u32;
                free.push(node as u32);
            }
        }
        Tie {
            free,
            place,
            held,
            motions: motions.len(),
        }
    }

    /// Number of reduced coordinates.
    pub fn coordinates(&self) -> usize {
        3 * self.free.len() + self.motions
    }

    /// `u = T r`: displacements of all nodes.
    pub fn expand(&self, reduced: &[f64], full: &mut [f64]) {
        let (nodes, hub) = reduced.split_at(3 * self.free.len());
        for (&node, u) in self.free.iter().zip(nodes.chunks_exact(3)) {
            full[3 * node as usize..][..3].copy_from_slice(u);
        }
        for (node, moved) in &self.held {
            let u: Vec3 = moved.iter().zip(hub).map(|(m, h)| *h * m).sum();
            full[3 * *node as usize..][..3].copy_from_slice(u.as_slice());
        }
    }

    /// `T^T f`: forces at all nodes as reduced forces.
    pub fn gather(&self, full: &[f64], reduced: &mut [f64]) {
        let (nodes, hub) = reduced.split_at_mut(3 * self.free.len());
        for (&node, f) in self.free.iter().zip(nodes.chunks_exact_mut(3)) {
            f.copy_from_slice(&full[3 * node as usize..][..3]);
        }
        hub.fill(0.0);
        for (node, moved) in &self.held {
            let f = &full[3 * *node as usize..][..3];
            for (h, m) in hub.iter_mut().zip(moved) {
                *h += m.x * f[0] + m.y * f[1] + m.z * f[2];
            }
        }
    }

    /// `T^T K T` and `T^T M T` with inertia added at the hub: per free motion a mass [kg] or a moment of inertia
    /// [kg m^2].
    ///
    /// # Panics
    /// If there are fewer values than motions.
    pub fn reduce(&self, a: &Assembly, added_inertia: &[f64], mass: MassKind) -> Reduced {
        let stiffness = self.reduced(&a.stiffness, &vec![0.0; self.motions]);
        let mass = match mass {
            MassKind::Consistent => self.reduced(&a.mass, added_inertia),
            MassKind::Lumped => self.reduced(&ScalarMatrix::diagonal(&a.lumped), added_inertia),
        };
        Reduced { stiffness, mass }
    }

    fn reduced<E: Entry>(&self, a: &NodalMatrix<E>, added: &[f64]) -> SparseColMat<usize, f64> {
        let nodes = self.free.len();
        let n = self.coordinates();
        // What a unit of each hub motion does: the hub's rows of the lower triangle, and its own block.
        let mut full = vec![0.0; 3 * self.place.len()];
        let mut image = vec![0.0; full.len()];
        let mut hub_rows: Vec<Vec<f64>> = Vec::new();
        for motion in 0..self.motions {
            full.fill(0.0);
            for (node, moved) in &self.held {
                full[3 * *node as usize..][..3].copy_from_slice(moved[motion].as_slice());
            }
            a.apply(&full, &mut image);
            let mut row = vec![0.0; n];
            self.gather(&image, &mut row);
            row[3 * nodes + motion] += added[motion];
            hub_rows.push(row);
        }
        let mut starts = vec![0];
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        for (&node, place) in self.free.iter().zip(0..) {
            // Entries right of the diagonal in the row of a symmetric matrix are those below it in the column.
            for axis in 0..3 {
                for (column, at) in a.pattern().of_row(node as usize) {
                    let other = self.place[column];
                    if other == Self::HELD {
                        continue;
                    }
                    let b = a.entries()[at].block();
                    for i in 0..3 {
                        if other == place && i < axis {
                            continue;
                        }
                        rows.push(3 * other as usize + i);
                        values.push(b[3 * axis + i]);
                    }
                }
                let own = 3 * place as usize + axis;
                for (motion, row) in hub_rows.iter().enumerate() {
                    if row[own] != 0.0 {
                        rows.push(3 * nodes + motion);
                        values.push(row[own]);
                    }
                }
                starts.push(rows.len());
            }
        }
        for motion in 0..self.motions {
            for (lower, row) in hub_rows.iter().enumerate().skip(motion) {
                rows.push(3 * nodes + lower);
                values.push(row[3 * nodes + motion]);
            }
            starts.push(rows.len());
        }
        let pattern = SymbolicSparseColMat::new_checked(n, n, starts, None, rows);
        SparseColMat::new(pattern, values)
    }
}
