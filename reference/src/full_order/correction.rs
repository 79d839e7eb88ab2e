//! Newton corrections of a full-order gear: `A = c_m M + c_k K` in the frame on the hub is constant, so it is
//! factorised once for a step size and solved with from then on.
//!
//! Left out of `A` are the terms of the order of the elastic strain that the turning frame brings; Newton
//! converges linearly in them. For many contacts on few nodes the columns of `A^-1` that belong to those nodes
//! are kept, so that a contact needs no further sparse solves (`G = E^T A^-1 E`, the flexibility of the nodes).

use super::frame::Frame;
use crate::assembly::tie::Reduced;
use crate::solve::{Cholesky, union};
use faer::sparse::SparseColMat;
use gearbench_integrators::system::{Coeffs, Singular};
use std::collections::HashMap;

/// Memory for kept columns [bytes]; they are dropped when it is full.
const COLUMN_BYTES: usize = 1 << 30;

/// Weights of a Newton matrix.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// Weights of mass and stiffness of the body; that of its damping, which is proportional to its stiffness, is in the
    /// latter.
    pub body: Coeffs,
    /// Weights of the hub and its bearing.
    pub hub: Coeffs,
    /// Damping on the rotation of the hub [N m s/rad].
    pub hub_damping: f64,
}

impl Weights {
    /// Returns the weights of a body on a held hub.
    pub fn of_body(body: Coeffs) -> Self {
        Weights {
            body,
            hub: body,
            hub_damping: 0.0,
        }
    }
}

/// Factor of the matrix for one set of weights.
#[derive(Debug)]
struct Factor {
    key: [f64; 3],
    cholesky: Cholesky,
    /// Column in `columns` of each node, by its index among the free ones.
    of_node: HashMap<u32, usize>,
    /// Three columns of `A^-1` per kept node, coordinates in the frame, hub last.
    columns: Vec<f64>,
    /// Column of the hub coordinate; computed when needed.
    hub: Vec<f64>,
}

/// Factors of the Newton matrix, with their buffers.
#[derive(Debug)]
pub struct Correction {
    /// Coordinates of the hub: 0 or 1.
    own: usize,
    n: usize,
    matrix: SparseColMat<usize, f64>,
    /// Entries of stiffness and mass on the pattern of `matrix`.
    entries: Vec<[f64; 2]>,
    /// Newton steps and the steps to the end of a run take turns: two factors are kept.
    factors: Vec<Factor>,
    count: u64,
    buffer: Vec<f64>,
    nodes: Vec<u32>,
    small: Vec<f64>,
}

impl Correction {
    /// Prepares for a gear with `own` hub coordinates.
    pub fn new(reduced: &Reduced, own: usize) -> Self {
        let (pattern, entries) = union(reduced.stiffness.as_ref(), reduced.mass.as_ref());
        let matrix = SparseColMat::new(pattern, vec![0.0; entries.len()]);
        Correction {
            own,
            n: matrix.nrows(),
            matrix,
            entries,
            factors: Vec::new(),
            count: 0,
            buffer: Vec::new(),
            nodes: Vec::new(),
            small: Vec::new(),
        }
    }

    /// Returns the number of factorisations so far.
    pub fn factorisations(&self) -> u64 {
        self.count
    }

    /// Makes the factor for weights the first of `factors`.
    fn prepare(&mut self, weights: Weights) -> Result<(), Singular> {
        let c = weights.body;
        let key = [c.m, c.k, weights.hub.d * weights.hub_damping];
        if let Some(i) = self.factors.iter().position(|f| same(&f.key, &key)) {
            self.factors.swap(0, i);
            return Ok(());
        }
        for (x, [k, m]) in self.matrix.val_mut().iter_mut().zip(&self.entries) {
            *x = c.k * k + c.m * m;
        }
        if self.own > 0 && key[2] != 0.0 {
            // The hub's is the last column of the lower triangle: its only entry is the diagonal.
            let last = self.matrix.val_mut().len() - 1;
            self.matrix.val_mut()[last] += key[2];
        }
        self.count += 1;
        if self.factors.len() < 2 {
            let cholesky = Cholesky::new(self.matrix.as_ref()).map_err(|_| Singular)?;
            self.factors.insert(
                0,
                Factor {
                    key,
                    cholesky,
                    of_node: HashMap::new(),
                    columns: Vec::new(),
                    hub: Vec::new(),
                },
            );
            return Ok(());
        }
        self.factors.swap(0, 1);
        let factor = &mut self.factors[0];
        factor.key = [f64::NAN; 3];
        factor.of_node.clear();
        factor.columns.clear();
        factor.hub.clear();
        factor
            .cholesky
            .refactor(self.matrix.as_ref())
            .map_err(|_| Singular)?;
        factor.key = key;
        Ok(())
    }

    /// `x <- A^-1 x` for coordinates in space, the hub's first.
    pub fn solve(&mut self, frame: Frame, weights: Weights, x: &mut [f64]) -> Result<(), Singular> {
        self.prepare(weights)?;
        // In the frame the hub's coordinate stands last.
        let (hub, nodes) = x.split_at_mut(self.own);
        self.buffer.clear();
        self.buffer.extend_from_slice(nodes);
        frame.all_to_frame(&mut self.buffer);
        self.buffer.extend_from_slice(hub);
        self.factors[0].cholesky.solve(&mut self.buffer);
        let (of_nodes, of_hub) = self.buffer.split_at_mut(self.n - self.own);
        frame.all_to_space(of_nodes);
        nodes.copy_from_slice(of_nodes);
        hub.copy_from_slice(of_hub);
        if x.iter().all(|x| x.is_finite()) {
            Ok(())
        } else {
            Err(Singular)
        }
    }

    /// Nodes (places among the free ones) of coordinates, each once, into `self.nodes`; their columns are kept.
    fn keep(&mut self, coordinates: &[u32]) {
        self.nodes.clear();
        for &i in coordinates {
            if i as usize >= self.own {
                let node = (i - self.own as u32) / 3;
                if !self.nodes.contains(&node) {
                    self.nodes.push(node);
                }
            }
        }
        let n = self.n;
        let factor = &mut self.factors[0];
        let asks_hub = coordinates.iter().any(|&i| (i as usize) < self.own);
        if asks_hub && factor.hub.is_empty() {
            factor.hub.resize(n, 0.0);
            factor.hub[n - 1] = 1.0;
            factor.cholesky.solve(&mut factor.hub);
        }
        if (factor.of_node.len() + self.nodes.len()) * 24 * n > COLUMN_BYTES {
            factor.of_node.clear();
            factor.columns.clear();
        }
        let fresh: Vec<u32> = self
            .nodes
            .iter()
            .copied()
            .filter(|node| !factor.of_node.contains_key(node))
            .collect();
        if fresh.is_empty() {
            return;
        }
        let start = factor.columns.len();
        factor.columns.resize(start + 3 * fresh.len() * n, 0.0);
        for (i, &node) in fresh.iter().enumerate() {
            factor.of_node.insert(node, start / (3 * n) + i);
            for axis in 0..3 {
                let column = start + (3 * i + axis) * n;
                factor.columns[column + 3 * node as usize + axis] = 1.0;
            }
        }
        let columns = &mut factor.columns[start..];
        factor.cholesky.solve_many(
            faer::MatMut::from_column_major_slice_mut(columns, n, 3 * fresh.len()),
            faer::Par::Seq,
        );
    }

    /// Flexibility `E^T A^-1 E` of some coordinates, row-major.
    pub fn flexibility(
        &mut self,
        frame: Frame,
        weights: Weights,
        coordinates: &[u32],
        g: &mut [f64],
    ) -> Result<(), Singular> {
        self.prepare(weights)?;
        self.keep(coordinates);
        let (n, s) = (self.n, coordinates.len());
        let factor = &self.factors[0];
        let own = self.own;
        // A node and an axis, or `None` for the hub.
        let split = |i: u32| {
            let i = (i as usize).checked_sub(own)?;
            Some(((i / 3) as u32, i % 3))
        };
        for (col, &j) in coordinates.iter().enumerate() {
            let (columns, weights) = match split(j) {
                Some((node, axis)) => {
                    let mut unit = [0.0; 3];
                    unit[axis] = 1.0;
                    let start = 3 * factor.of_node[&node] * n;
                    (&factor.columns[start..][..3 * n], frame.to_frame(unit))
                }
                None => (&factor.hub[..], [1.0, 0.0, 0.0]),
            };
            let at_row = |row: usize| -> f64 {
                let columns = columns.chunks_exact(n);
                weights.iter().zip(columns).map(|(w, c)| w * c[row]).sum()
            };
            let (mut last, mut response) = (u32::MAX, [0.0; 3]);
            for (row, &i) in coordinates.iter().enumerate() {
                g[row * s + col] = match split(i) {
                    Some((at, axis)) => {
                        if at != last {
                            let start = 3 * at as usize;
                            let own = [0, 1, 2].map(|k| at_row(start + k));
                            (last, response) = (at, frame.to_space(own));
                        }
                        response[axis]
                    }
                    None => at_row(n - 1),
                };
            }
        }
        Ok(())
    }

    /// `x += A^-1 E f` for forces at some coordinates.
    pub fn add_response(
        &mut self,
        frame: Frame,
        weights: Weights,
        coordinates: &[u32],
        forces: &[f64],
        x: &mut [f64],
    ) -> Result<(), Singular> {
        self.prepare(weights)?;
        self.keep(coordinates);
        let n = self.n;
        self.small.clear();
        self.small.resize(3 * self.nodes.len(), 0.0);
        let mut at_hub = 0.0;
        for (&i, f) in coordinates.iter().zip(forces) {
            let Some(i) = (i as usize).checked_sub(self.own) else {
                at_hub += f;
                continue;
            };
            let node = (i / 3) as u32;
            if let Some(k) = self.nodes.iter().position(|&x| x == node) {
                self.small[3 * k + i % 3] += f;
            }
        }
        frame.all_to_frame(&mut self.small);
        self.buffer.clear();
        self.buffer.resize(n, 0.0);
        let factor = &self.factors[0];
        for (node, f) in self.nodes.iter().zip(self.small.chunks_exact(3)) {
            let columns = &factor.columns[3 * factor.of_node[node] * n..][..3 * n];
            let (a, rest) = columns.split_at(n);
            let (b, c) = rest.split_at(n);
            for (((y, a), b), c) in self.buffer.iter_mut().zip(a).zip(b).zip(c) {
                *y += f[0] * a + f[1] * b + f[2] * c;
            }
        }
        for (y, c) in self.buffer.iter_mut().zip(&factor.hub) {
            *y += at_hub * c;
        }
        let (of_nodes, of_hub) = self.buffer.split_at_mut(n - self.own);
        frame.all_to_space(of_nodes);
        let (hub, nodes) = x.split_at_mut(self.own);
        for (x, y) in hub.iter_mut().zip(of_hub) {
            *x += *y;
        }
        for (x, y) in nodes.iter_mut().zip(of_nodes) {
            *x += *y;
        }
        Ok(())
    }
}

/// Steps on a grid differ by rounding: their weights are the same to a correction.
pub(super) fn same<const N: usize>(a: &[f64; N], b: &[f64; N]) -> bool {
    a.iter()
        .zip(b)
        .all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs())
}
