//! The residual compliance `R` of the nodes of a solve, gear by gear: its inverse, and its root `C C^T = R`.

use crate::cholesky::{append_inverse, cholesky_padded, dot, padded};

/// Relative pivot below which a direction of the compliance is none.
const RANK: f64 = 1e-13;

/// Relative pivot of the compliance from which on its inverse serves.
const REGULAR: f64 = 1e-8;

/// Nodes of one gear in the solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// Its first node.
    pub start: usize,
    /// Its number of nodes.
    pub len: usize,
}

/// The compliance of the present nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct Compliance {
    pub blocks: Vec<Block>,
    numbers: Vec<u32>,
    /// Number of nodes.
    pub n: usize,
    /// `R` of the blocks, one `len x len` matrix after the other.
    pub matrix: Vec<f64>,
    /// Their inverses, rows padded, where all are regular.
    pub inverse: Vec<f64>,
    /// Whether they are, once asked for; the inverses are then those of the present nodes.
    regular: Option<bool>,
    /// Whether `root` is that of the present nodes.
    rooted: bool,
    /// Lower triangles `C` of the blocks, one `len x len` matrix after the other.
    root: Vec<f64>,
    /// Of the factorisations.
    factor: Vec<f64>,
    line: Vec<f64>,
}

impl Compliance {
    pub fn forget(&mut self) {
        self.n = 0;
        self.numbers.clear();
        self.blocks.clear();
    }

    /// See [`NodalSolve::set_nodes`](super::NodalSolve::set_nodes).
    pub fn set(&mut self, blocks: &[Block], numbers: &[u32], fill: impl FnOnce(&mut [f64])) {
        if self.n > 0 && self.blocks == blocks && self.numbers == numbers {
            return;
        }
        self.blocks.clear();
        self.blocks.extend_from_slice(blocks);
        self.numbers.clear();
        self.numbers.extend_from_slice(numbers);
        self.n = numbers.len();
        self.matrix.clear();
        let size = blocks.iter().map(|b| b.len * b.len).sum();
        self.matrix.resize(size, 0.0);
        fill(&mut self.matrix);
        if self.n == 0 {
            // One node that does not give way: points without weights need no case of their own.
            self.blocks.push(Block { start: 0, len: 1 });
            self.matrix.push(0.0);
            self.n = 1;
        }
        self.rooted = false;
        self.regular = None;
    }

    /// The inverse, where it is not there yet; whether the compliance is regular.
    pub fn take_inverse(&mut self) -> bool {
        if let Some(regular) = self.regular {
            return regular;
        }
        let mut regular = true;
        self.inverse.clear();
        let mut begin = 0;
        for b in &self.blocks {
            let r = &self.matrix[begin..][..b.len * b.len];
            begin += b.len * b.len;
            let stride = padded(b.len);
            self.factor.clear();
            self.factor.resize(b.len * stride, 0.0);
            let mut largest = 0.0_f64;
            for (i, line) in r.chunks_exact(b.len.max(1)).enumerate() {
                self.factor[i * stride..][..b.len].copy_from_slice(line);
                largest = largest.max(line[i]);
            }
            regular &= cholesky_padded(&mut self.factor, b.len).is_ok();
            let pivot = |i: usize| self.factor[i * stride + i].powi(2);
            regular &= (0..b.len).all(|i| pivot(i) >= REGULAR * largest);
            if !regular {
                break;
            }
            append_inverse(&self.factor, b.len, &mut self.line, &mut self.inverse);
        }
        self.regular = Some(regular);
        regular
    }

    /// `C`, where it is not there yet.
    pub fn take_root(&mut self) {
        if self.rooted {
            return;
        }
        self.rooted = true;
        self.root.clear();
        self.root.extend_from_slice(&self.matrix);
        let mut begin = 0;
        for b in &self.blocks {
            root_of(&mut self.root[begin..][..b.len * b.len], b.len);
            begin += b.len * b.len;
        }
    }

    /// `small = I + C^T S C`, its lower triangle; `stiffness`, full rows of `S`, becomes `S C`.
    pub fn congruence(&self, stiffness: &mut [f64], small: &mut Vec<f64>) {
        let n = self.n;
        small.clear();
        small.resize(n * n, 0.0);
        // Rows of S C in place: column j of C begins at row j, so columns to the left are still needed last.
        let mut begin = 0;
        for b in &self.blocks {
            let root = &self.root[begin..][..b.len * b.len];
            for row in stiffness.chunks_exact_mut(n) {
                let part = &mut row[b.start..][..b.len];
                for j in 0..b.len {
                    let mut sum = 0.0;
                    for i in j..b.len {
                        sum += part[i] * root[i * b.len + j];
                    }
                    part[j] = sum;
                }
            }
            begin += b.len * b.len;
        }
        let mut begin = 0;
        for b in &self.blocks {
            let root = &self.root[begin..][..b.len * b.len];
            for i in 0..b.len {
                let line = &stiffness[(b.start + i) * n..][..n];
                for j in 0..=i {
                    let c = root[i * b.len + j];
                    let row = &mut small[(b.start + j) * n..][..=b.start + j];
                    for (x, y) in row.iter_mut().zip(line) {
                        *x += c * y;
                    }
                }
            }
            begin += b.len * b.len;
        }
        for i in 0..n {
            small[i * n + i] += 1.0;
        }
    }

    /// `y += C^T f`.
    pub fn add_root_transposed(&self, f: &[f64], y: &mut [f64]) {
        let mut begin = 0;
        for b in &self.blocks {
            let y = &mut y[b.start..][..b.len];
            for i in 0..b.len {
                let f = f[b.start + i];
                let row = &self.root[begin + i * b.len..][..=i];
                for (y, c) in y.iter_mut().zip(row) {
                    *y += c * f;
                }
            }
            begin += b.len * b.len;
        }
    }

    /// `u = C y`.
    pub fn displace(&self, y: &[f64], u: &mut Vec<f64>) {
        u.clear();
        u.resize(self.n, 0.0);
        let mut begin = 0;
        for b in &self.blocks {
            let y = &y[b.start..][..b.len];
            for i in 0..b.len {
                u[b.start + i] = dot(&self.root[begin + i * b.len..][..=i], y);
            }
            begin += b.len * b.len;
        }
    }
}

/// `C` with `R = C C^T` in place; directions in which `R` has nothing but rounding are left out.
fn root_of(r: &mut [f64], n: usize) {
    let largest = (0..n).fold(0.0_f64, |m, i| m.max(r[i * n + i]));
    for j in 0..n {
        let row = r[j * n..][..j].iter();
        let pivot = r[j * n + j] - row.map(|x| x * x).sum::<f64>();
        let root = if pivot > RANK * largest {
            pivot.sqrt()
        } else {
            0.0
        };
        r[j * n + j] = root;
        for i in j + 1..n {
            r[j * n + i] = 0.0;
            let (above, below) = r.split_at_mut(i * n);
            let x = below[j] - dot(&below[..j], &above[j * n..][..j]);
            below[j] = if root > 0.0 { x / root } else { 0.0 };
        }
    }
}
