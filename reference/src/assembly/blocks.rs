//! Symmetric sparse matrices over the nodes of a mesh, and their products.
//!
//! Rows are nodes; of each row only the entries at and right of the diagonal are stored. A product therefore
//! reads every stored entry once and uses it twice: it is bound by the memory that streams past.

use crate::mesh::Mesh;
use std::sync::Arc;

/// Which nodes share an element: compressed rows, diagonal first, then ascending columns right of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    starts: Vec<u32>,
    columns: Vec<u32>,
}

impl Pattern {
    /// The pattern of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        let nodes = mesh.nodes.len();
        // Elements of each node, then its neighbours from them.
        let mut first = vec![0u32; nodes + 1];
        for &node in &mesh.connectivity {
            first[node as usize + 1] += 1;
        }
        for i in 0..nodes {
            first[i + 1] += first[i];
        }
        let mut of_node = vec![0u32; mesh.connectivity.len()];
        let mut next = first.clone();
        for (e, element) in mesh.elements().enumerate() {
            for &node in element {
                of_node[next[node as usize] as usize] = e as u32;
                next[node as usize] += 1;
            }
        }
        let mut starts = Vec::with_capacity(nodes + 1);
        let mut columns = Vec::new();
        let mut row: Vec<u32> = Vec::new();
        starts.push(0);
        for node in 0..nodes as u32 {
            row.clear();
            row.push(node);
            for &e in &of_node[first[node as usize] as usize..first[node as usize + 1] as usize] {
                row.extend(mesh.element(e as usize).iter().filter(|&&m| m > node));
            }
            row.sort_unstable();
            row.dedup();
            columns.extend_from_slice(&row);
            starts.push(columns.len() as u32);
        }
        Pattern { starts, columns }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of stored entries.
    pub fn entries(&self) -> usize {
        self.columns.len()
    }

    #[inline]
    fn row(&self, node: usize) -> std::ops::Range<usize> {
        self.starts[node] as usize..self.starts[node + 1] as usize
    }

    /// Place of an entry with `row <= column`.
    #[inline]
    fn place(&self, row: u32, column: u32) -> usize {
        let range = self.row(row as usize);
        let start = range.start;
        start + self.columns[range].partition_point(|&c| c < column)
    }

    /// The diagonal alone.
    pub fn diagonal(nodes: usize) -> Self {
        Pattern {
            starts: (0..=nodes as u32).collect(),
            columns: (0..nodes as u32).collect(),
        }
    }

    /// Stored entries of a row as `(column, place)`, ascending.
    pub fn of_row(&self, row: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.row(row)
            .map(|place| (self.columns[place] as usize, place))
    }

    /// Stored entries as `(row, column, place)`, `row <= column`.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize, usize)> + '_ {
        (0..self.nodes()).flat_map(move |row| {
            self.row(row)
                .map(move |place| (row, self.columns[place] as usize, place))
        })
    }
}

/// A symmetric matrix of 3x3 blocks.
#[derive(Clone, Debug)]
pub struct BlockMatrix {
    pattern: Arc<Pattern>,
    /// Row-major blocks.
    blocks: Vec<[f64; 9]>,
}

impl BlockMatrix {
    /// All zero.
    pub fn zeros(pattern: Arc<Pattern>) -> Self {
        let blocks = vec![[0.0; 9]; pattern.entries()];
        BlockMatrix { pattern, blocks }
    }

    /// Where the blocks stand.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// The stored blocks, in the order of the pattern.
    pub fn blocks(&self) -> &[[f64; 9]] {
        &self.blocks
    }

    /// Bytes that a product streams: blocks and columns.
    pub fn bytes(&self) -> usize {
        self.blocks.len() * (9 * 8 + 4) + self.pattern.starts.len() * 4
    }

    /// Adds an element's matrix, row-major over `3 n` coordinates.
    pub fn add(&mut self, nodes: &[u32], k: &[f64]) {
        let size = 3 * nodes.len();
        for (a, &row) in nodes.iter().enumerate() {
            for (b, &column) in nodes.iter().enumerate() {
                if row > column {
                    continue;
                }
                let block = &mut self.blocks[self.pattern.place(row, column)];
                for i in 0..3 {
                    for j in 0..3 {
                        block[3 * i + j] += k[(3 * a + i) * size + 3 * b + j];
                    }
                }
            }
        }
    }

    /// `y = A x`; both of length three times the number of nodes.
    pub fn apply(&self, x: &[f64], y: &mut [f64]) {
        let (x, _) = x.as_chunks::<3>();
        let (y, _) = y.as_chunks_mut::<3>();
        y.fill([0.0; 3]);
        let nodes = self.pattern.nodes();
        debug_assert!(x.len() == nodes && y.len() == nodes);
        for row in 0..nodes {
            let range = self.pattern.row(row);
            let columns = &self.pattern.columns[range.clone()];
            let blocks = &self.blocks[range];
            let xr = x[row];
            // The diagonal block is symmetric: its upper part counts once.
            let d = &blocks[0];
            let mut sum = [
                d[0] * xr[0] + d[1] * xr[1] + d[2] * xr[2],
                d[3] * xr[0] + d[4] * xr[1] + d[5] * xr[2],
                d[6] * xr[0] + d[7] * xr[1] + d[8] * xr[2],
            ];
            for (&column, b) in columns[1..].iter().zip(&blocks[1..]) {
                let xc = x[column as usize];
                sum[0] += b[0] * xc[0] + b[1] * xc[1] + b[2] * xc[2];
                sum[1] += b[3] * xc[0] + b[4] * xc[1] + b[5] * xc[2];
                sum[2] += b[6] * xc[0] + b[7] * xc[1] + b[8] * xc[2];
                let yc = &mut y[column as usize];
                yc[0] += b[0] * xr[0] + b[3] * xr[1] + b[6] * xr[2];
                yc[1] += b[1] * xr[0] + b[4] * xr[1] + b[7] * xr[2];
                yc[2] += b[2] * xr[0] + b[5] * xr[1] + b[8] * xr[2];
            }
            let yr = &mut y[row];
            for i in 0..3 {
                yr[i] += sum[i];
            }
        }
    }
}

/// A symmetric matrix of scalars over nodes, meant times the unit matrix of three axes.
#[derive(Clone, Debug)]
pub struct ScalarMatrix {
    pattern: Arc<Pattern>,
    values: Vec<f64>,
}

impl ScalarMatrix {
    /// All zero.
    pub fn zeros(pattern: Arc<Pattern>) -> Self {
        let values = vec![0.0; pattern.entries()];
        ScalarMatrix { pattern, values }
    }

    /// Where the entries stand.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// The stored entries, in the order of the pattern.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Lumps every entry between a held and a free node onto both of them: row sums stay.
    pub fn decouple(&mut self, held: impl Fn(usize) -> bool) {
        for row in 0..self.pattern.nodes() {
            let range = self.pattern.row(row);
            let diagonal = range.start;
            for place in range.skip(1) {
                let column = self.pattern.columns[place] as usize;
                if held(row) != held(column) {
                    let lumped = std::mem::take(&mut self.values[place]);
                    self.values[diagonal] += lumped;
                    let other = self.pattern.row(column).start;
                    self.values[other] += lumped;
                }
            }
        }
    }

    /// Adds an element's matrix, row-major over `n` nodes.
    pub fn add(&mut self, nodes: &[u32], m: &[f64]) {
        let n = nodes.len();
        for (a, &row) in nodes.iter().enumerate() {
            for (b, &column) in nodes.iter().enumerate() {
                if row <= column {
                    self.values[self.pattern.place(row, column)] += m[a * n + b];
                }
            }
        }
    }

    /// `y = (A x I3) x`; both of length three times the number of nodes.
    pub fn apply3(&self, x: &[f64], y: &mut [f64]) {
        let (x, _) = x.as_chunks::<3>();
        let (y, _) = y.as_chunks_mut::<3>();
        y.fill([0.0; 3]);
        for row in 0..self.pattern.nodes() {
            let range = self.pattern.row(row);
            let columns = &self.pattern.columns[range.clone()];
            let values = &self.values[range];
            let xr = x[row];
            let mut sum = xr.map(|x| values[0] * x);
            for (&column, a) in columns[1..].iter().zip(&values[1..]) {
                let xc = x[column as usize];
                let yc = &mut y[column as usize];
                for i in 0..3 {
                    sum[i] += a * xc[i];
                    yc[i] += a * xr[i];
                }
            }
            let yr = &mut y[row];
            for i in 0..3 {
                yr[i] += sum[i];
            }
        }
    }
}
