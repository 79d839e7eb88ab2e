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
        let mut count = 0;
        for node in mesh.connectivity() {
            first[node as usize + 1] += 1;
            count += 1;
        }
        for i in 0..nodes {
            first[i + 1] += first[i];
        }
        let mut of_node = vec![0u32; count];
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

    /// The pattern of pairs of nodes, in any order and any number of times; each node is its own neighbour.
    ///
    /// # Panics
    /// If a pair has a node beyond `nodes`.
    pub fn of_pairs(nodes: usize, mut pairs: Vec<(u32, u32)>) -> Self {
        pairs.extend((0..nodes as u32).map(|n| (n, n)));
        for (a, b) in &mut pairs {
            (*a, *b) = (*a.min(b), *a.max(b));
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut starts = vec![0; nodes + 1];
        for (row, _) in &pairs {
            starts[*row as usize + 1] += 1;
        }
        for i in 0..nodes {
            starts[i + 1] += starts[i];
        }
        Pattern {
            starts,
            columns: pairs.into_iter().map(|(_, column)| column).collect(),
        }
    }

    /// Returns the number of nodes.
    pub fn nodes(&self) -> usize {
        self.starts.len() - 1
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

/// Coupling between two nodes in a matrix.
pub trait Entry: Copy {
    /// The zero entry.
    const ZERO: Self;
    /// Entry of nodes `a` and `b` in the row-major matrix of an element of `nodes`.
    fn of_element(matrix: &[f64], nodes: usize, a: usize, b: usize) -> Self;
    /// The sum with another.
    fn plus(&mut self, other: Self);
    /// Returns the product `E x`.
    fn times(&self, x: &[f64; 3]) -> [f64; 3];
    /// Returns the product `E^T x`.
    fn transposed_times(&self, x: &[f64; 3]) -> [f64; 3];
    /// Returns the 3x3 block of the entry, row by row.
    fn block(&self) -> [f64; 9];
}

/// A 3x3 block, row by row.
impl Entry for [f64; 9] {
    const ZERO: Self = [0.0; 9];

    fn of_element(k: &[f64], nodes: usize, a: usize, b: usize) -> Self {
        std::array::from_fn(|at| k[(3 * a + at / 3) * 3 * nodes + 3 * b + at % 3])
    }

    fn plus(&mut self, other: Self) {
        self.iter_mut().zip(other).for_each(|(s, o)| *s += o);
    }

    #[inline]
    fn times(&self, x: &[f64; 3]) -> [f64; 3] {
        [
            self[0] * x[0] + self[1] * x[1] + self[2] * x[2],
            self[3] * x[0] + self[4] * x[1] + self[5] * x[2],
            self[6] * x[0] + self[7] * x[1] + self[8] * x[2],
        ]
    }

    #[inline]
    fn transposed_times(&self, x: &[f64; 3]) -> [f64; 3] {
        [
            self[0] * x[0] + self[3] * x[1] + self[6] * x[2],
            self[1] * x[0] + self[4] * x[1] + self[7] * x[2],
            self[2] * x[0] + self[5] * x[1] + self[8] * x[2],
        ]
    }

    fn block(&self) -> [f64; 9] {
        *self
    }
}

/// A scalar, meant times the unit matrix of three axes.
impl Entry for f64 {
    const ZERO: Self = 0.0;

    fn of_element(m: &[f64], nodes: usize, a: usize, b: usize) -> Self {
        m[a * nodes + b]
    }

    fn plus(&mut self, other: Self) {
        *self += other;
    }

    #[inline]
    fn times(&self, x: &[f64; 3]) -> [f64; 3] {
        x.map(|x| self * x)
    }

    #[inline]
    fn transposed_times(&self, x: &[f64; 3]) -> [f64; 3] {
        self.times(x)
    }

    fn block(&self) -> [f64; 9] {
        [*self, 0.0, 0.0, 0.0, *self, 0.0, 0.0, 0.0, *self]
    }
}

/// A symmetric matrix over nodes.
#[derive(Clone, Debug)]
pub struct NodalMatrix<E> {
    pattern: Arc<Pattern>,
    entries: Vec<E>,
}

/// A symmetric matrix of 3x3 blocks.
pub type BlockMatrix = NodalMatrix<[f64; 9]>;
/// A symmetric matrix of scalars, meant times the unit matrix of three axes.
pub type ScalarMatrix = NodalMatrix<f64>;

impl<E: Entry> NodalMatrix<E> {
    /// Creates a matrix of zeros.
    pub fn zeros(pattern: Arc<Pattern>) -> Self {
        let entries = vec![E::ZERO; pattern.columns.len()];
        NodalMatrix { pattern, entries }
    }

    /// Returns the positions of the entries.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// The stored entries, in the order of the pattern.
    pub fn entries(&self) -> &[E] {
        &self.entries
    }

    /// Bytes that a product streams: entries and columns.
    pub fn bytes(&self) -> usize {
        self.entries.len() * (size_of::<E>() + 4) + self.pattern.starts.len() * 4
    }

    /// Adds an element's matrix, row-major over its nodes (and their axes).
    pub fn add(&mut self, nodes: &[u32], matrix: &[f64]) {
        for (a, &row) in nodes.iter().enumerate() {
            for (b, &column) in nodes.iter().enumerate() {
                if row <= column {
                    let entry = E::of_element(matrix, nodes.len(), a, b);
                    self.entries[self.pattern.place(row, column)].plus(entry);
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
            let entries = &self.entries[range];
            let xr = &x[row];
            // The diagonal entry is symmetric: its upper part counts once.
            let mut sum = entries[0].times(xr);
            for (&column, e) in columns[1..].iter().zip(&entries[1..]) {
                let own = e.times(&x[column as usize]);
                let other = e.transposed_times(xr);
                let yc = &mut y[column as usize];
                for i in 0..3 {
                    sum[i] += own[i];
                    yc[i] += other[i];
                }
            }
            let yr = &mut y[row];
            for i in 0..3 {
                yr[i] += sum[i];
            }
        }
    }
}

impl BlockMatrix {
    /// Adds a value at a pair of coordinates `3 node + axis`, the lower one first, and at its mirror.
    ///
    /// # Panics
    /// If the pair of nodes is not in the pattern.
    pub fn add_coordinates(&mut self, [low, high]: [u32; 2], value: f64) {
        let (row, column) = (low / 3, high / 3);
        let (i, j) = (low as usize % 3, high as usize % 3);
        let block = &mut self.entries[self.pattern.place(row, column)];
        block[3 * i + j] += value;
        if row == column && i != j {
            block[3 * j + i] += value;
        }
    }

    /// Replaces each block by a function of it.
    pub fn map(&mut self, f: impl Fn(&[f64; 9]) -> [f64; 9]) {
        self.entries.iter_mut().for_each(|e| *e = f(e));
    }

    /// The matrix of a number of each block.
    pub fn scalars(&self, f: impl Fn(&[f64; 9]) -> f64) -> ScalarMatrix {
        NodalMatrix {
            pattern: self.pattern.clone(),
            entries: self.entries.iter().map(f).collect(),
        }
    }
}

impl ScalarMatrix {
    /// One entry per node.
    pub fn diagonal(entries: &[f64]) -> Self {
        let nodes = entries.len() as u32;
        let pattern = Pattern {
            starts: (0..=nodes).collect(),
            columns: (0..nodes).collect(),
        };
        NodalMatrix {
            pattern: Arc::new(pattern),
            entries: entries.to_vec(),
        }
    }

    /// Lumps every entry between a fixed and a free node onto both of them: row sums are preserved.
    pub fn decouple(&mut self, held: impl Fn(usize) -> bool) {
        for row in 0..self.pattern.nodes() {
            let range = self.pattern.row(row);
            let diagonal = range.start;
            for place in range.skip(1) {
                let column = self.pattern.columns[place] as usize;
                if held(row) != held(column) {
                    let lumped = std::mem::take(&mut self.entries[place]);
                    self.entries[diagonal] += lumped;
                    let other = self.pattern.row(column).start;
                    self.entries[other] += lumped;
                }
            }
        }
    }
}
