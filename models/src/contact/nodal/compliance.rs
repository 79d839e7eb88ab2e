//! The residual compliance `R` of the nodes of a solve, gear by gear, with its inverse and its root `C C^T = R`.

use crate::cholesky::{append_inverse, cholesky_padded, dot, padded};

/// Relative pivot below which a direction of the compliance counts as rigid.
const RANK: f64 = 1e-13;

/// Relative pivot of the compliance above which its inverse is accurate enough.
const REGULAR: f64 = 1e-8;

/// Range of the nodes of one gear in the solve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Block {
    /// Index of the first node.
    pub start: usize,
    /// Number of nodes of the gear.
    pub len: usize,
}

/// Residual compliance of the present nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct Compliance {
    pub blocks: Vec<Block>,
    numbers: Vec<u32>,
    /// Number of nodes of both gears.
    pub n: usize,
    /// Blocks of `R`, one `len x len` matrix after the other [m/N].
    pub matrix: Vec<f64>,
    /// Inverses of the blocks, with padded rows, where all are regular.
    pub inverse: Vec<f64>,
    /// True if all blocks are regular; `None` until it is known. The inverses then belong to the present nodes.
    regular: Option<bool>,
    /// True if `root` belongs to the present nodes.
    rooted: bool,
    /// Lower triangles `C` of the blocks, one `len x len` matrix after the other.
    root: Vec<f64>,
    /// Factors of the blocks.
    factor: Vec<f64>,
    line: Vec<f64>,
    /// The previous nodes, and the position of the inverse of each unchanged block among them.
    before: PreviousNodes,
    kept: Vec<Option<usize>>,
}

/// Compliance and inverse of the previous nodes.
#[derive(Clone, Debug, Default)]
struct PreviousNodes {
    blocks: Vec<Block>,
    numbers: Vec<u32>,
    matrix: Vec<f64>,
    inverse: Vec<f64>,
    regular: bool,
}

impl PreviousNodes {
    /// Moves the content of a compliance here and leaves it empty.
    fn take_from(&mut self, c: &mut Compliance) {
        std::mem::swap(&mut self.blocks, &mut c.blocks);
        std::mem::swap(&mut self.numbers, &mut c.numbers);
        std::mem::swap(&mut self.matrix, &mut c.matrix);
        std::mem::swap(&mut self.inverse, &mut c.inverse);
        self.regular = c.regular == Some(true);
        c.blocks.clear();
        c.numbers.clear();
        c.matrix.clear();
        c.inverse.clear();
        c.kept.clear();
    }
}

impl Compliance {
    pub fn forget(&mut self) {
        self.n = 0;
        self.numbers.clear();
        self.blocks.clear();
    }

    /// See [`NodalSolve::set_nodes`](super::NodalSolve::set_nodes).
    pub fn set(
        &mut self,
        blocks: &[Block],
        numbers: &[u32],
        mut fill: impl FnMut(usize, &mut [f64]),
    ) {
        if self.n > 0 && self.blocks == blocks && self.numbers == numbers {
            return;
        }
        let mut before = std::mem::take(&mut self.before);
        before.take_from(self);
        self.blocks.extend_from_slice(blocks);
        self.numbers.extend_from_slice(numbers);
        self.n = numbers.len();
        let size = blocks.iter().map(|b| b.len * b.len).sum();
        self.matrix.resize(size, 0.0);
        // Of many gears only a few have changed nodes.
        let mut rest = self.matrix.as_mut_slice();
        let same = before.blocks.len() == blocks.len();
        let (mut of_matrix, mut of_inverse) = (0, 0);
        for (k, b) in blocks.iter().enumerate() {
            let (own, behind) = rest.split_at_mut(b.len * b.len);
            rest = behind;
            let was = if same {
                before.blocks[k]
            } else {
                Block::default()
            };
            let known = before.numbers.get(was.start..was.start + was.len);
            if same && known == Some(&numbers[b.start..][..b.len]) {
                own.copy_from_slice(&before.matrix[of_matrix..][..own.len()]);
                self.kept.push(before.regular.then_some(of_inverse));
            } else {
                fill(k, own);
                self.kept.push(None);
            }
            of_matrix += was.len * was.len;
            of_inverse += was.len * padded(was.len);
        }
        self.before = before;
        if self.n == 0 {
            // One node that does not give way: points without weights need no case of their own.
            self.blocks.push(Block { start: 0, len: 1 });
            self.kept.push(None);
            self.matrix.push(0.0);
            self.n = 1;
        }
        self.rooted = false;
        self.regular = None;
    }

    /// Computes the inverse, if needed, and returns true if the compliance is regular.
    pub fn take_inverse(&mut self) -> bool {
        if let Some(regular) = self.regular {
            return regular;
        }
        let mut regular = true;
        self.inverse.clear();
        let mut begin = 0;
        for (b, kept) in self.blocks.iter().zip(&self.kept) {
            let r = &self.matrix[begin..][..b.len * b.len];
            begin += b.len * b.len;
            let stride = padded(b.len);
            if let Some(from) = *kept {
                let before = &self.before.inverse[from..][..b.len * stride];
                self.inverse.extend_from_slice(before);
                continue;
            }
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

    /// Computes the root `C`, if needed.
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

    /// Computes the lower triangle of `small = I + C^T S C`; `stiffness`, full rows of `S`, becomes `S C`.
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

    /// Adds `C^T f` to `y`.
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

    /// Computes the displacements `u = C y`.
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

/// Computes the root `C` of `R = C C^T` in place; directions in which `R` consists of rounding are left out.
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
