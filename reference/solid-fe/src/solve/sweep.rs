//! Forward and backward sweep through a supernodal factor for one right-hand side.
//!
//! A supernode is a dense block of columns, stored column by column: its triangle on top, the rows below it.
//! Each sweep streams the factor through the processor exactly once, four columns at a time; that stream
//! is what bounds it.

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

/// Number of columns that are processed together.
const GROUP: usize = 4;

/// Solves `L y = x` in place.
pub(super) fn forward(
    symbolic: &SymbolicSupernodalCholesky<usize>,
    values: &[f64],
    x: &mut [f64],
    block: &mut [f64],
) {
    for s in 0..symbolic.n_supernodes() {
        let (begin, end) = (symbolic.supernode_begin()[s], symbolic.supernode_end()[s]);
        let rows = symbolic.supernode(s).pattern();
        let (columns, height) = (end - begin, end - begin + rows.len());
        let l = &values[symbolic.col_ptr_for_val()[s]..][..columns * height];
        let block = &mut block[..height];
        let (top, below) = block.split_at_mut(columns);
        top.copy_from_slice(&x[begin..end]);
        below.fill(0.0);
        let mut j = 0;
        while j + GROUP <= columns {
            let (c0, rest) = l[j * height..].split_at(height);
            let (c1, rest) = rest.split_at(height);
            let (c2, rest) = rest.split_at(height);
            let c3 = &rest[..height];
            let y0 = block[j] / c0[j];
            let y1 = (block[j + 1] - c0[j + 1] * y0) / c1[j + 1];
            let y2 = (block[j + 2] - c0[j + 2] * y0 - c1[j + 2] * y1) / c2[j + 2];
            let y3 = (block[j + 3] - c0[j + 3] * y0 - c1[j + 3] * y1 - c2[j + 3] * y2) / c3[j + 3];
            block[j..j + GROUP].copy_from_slice(&[y0, y1, y2, y3]);
            j += GROUP;
            subtract_four(
                &mut block[j..],
                [&c0[j..], &c1[j..], &c2[j..], &c3[j..]],
                [y0, y1, y2, y3],
            );
        }
        while j < columns {
            let c = &l[j * height..][..height];
            let y = block[j] / c[j];
            block[j] = y;
            j += 1;
            for (b, c) in block[j..].iter_mut().zip(&c[j..]) {
                *b -= c * y;
            }
        }
        let (top, below) = block.split_at(columns);
        x[begin..end].copy_from_slice(top);
        for (&i, b) in rows.iter().zip(below) {
            x[i] += b;
        }
    }
}

/// Solves `L^T y = x` in place.
pub(super) fn backward(
    symbolic: &SymbolicSupernodalCholesky<usize>,
    values: &[f64],
    x: &mut [f64],
    block: &mut [f64],
) {
    for s in (0..symbolic.n_supernodes()).rev() {
        let (begin, end) = (symbolic.supernode_begin()[s], symbolic.supernode_end()[s]);
        let rows = symbolic.supernode(s).pattern();
        let (columns, height) = (end - begin, end - begin + rows.len());
        let l = &values[symbolic.col_ptr_for_val()[s]..][..columns * height];
        let block = &mut block[..height];
        let (top, below) = block.split_at_mut(columns);
        top.copy_from_slice(&x[begin..end]);
        for (b, &i) in below.iter_mut().zip(rows) {
            *b = x[i];
        }
        let mut j = columns;
        while j % GROUP != 0 {
            j -= 1;
            let c = &l[j * height..][..height];
            let sum = dot(&c[j + 1..], &block[j + 1..]);
            block[j] = (block[j] - sum) / c[j];
        }
        while j > 0 {
            let after = j;
            j -= GROUP;
            let (c0, rest) = l[j * height..].split_at(height);
            let (c1, rest) = rest.split_at(height);
            let (c2, rest) = rest.split_at(height);
            let c3 = &rest[..height];
            let [s0, s1, s2, s3] = four_dots(
                [&c0[after..], &c1[after..], &c2[after..], &c3[after..]],
                &block[after..],
            );
            let y3 = (block[j + 3] - s3) / c3[j + 3];
            let y2 = (block[j + 2] - s2 - c2[j + 3] * y3) / c2[j + 2];
            let y1 = (block[j + 1] - s1 - c1[j + 2] * y2 - c1[j + 3] * y3) / c1[j + 1];
            let y0 = (block[j] - s0 - c0[j + 1] * y1 - c0[j + 2] * y2 - c0[j + 3] * y3) / c0[j];
            block[j..after].copy_from_slice(&[y0, y1, y2, y3]);
        }
        x[begin..end].copy_from_slice(&block[..columns]);
    }
}

/// `b -= sum c_k y_k`.
fn subtract_four(b: &mut [f64], c: [&[f64]; GROUP], y: [f64; GROUP]) {
    let n = b.len();
    let [c0, c1, c2, c3] = c.map(|c| &c[..n]);
    for i in 0..n {
        b[i] -= (c0[i] * y[0] + c1[i] * y[1]) + (c2[i] * y[2] + c3[i] * y[3]);
    }
}

/// Lanes of a sum: independent partial sums let it run in vector registers.
const LANES: usize = 4;

/// Products of four columns with `b`.
fn four_dots(c: [&[f64]; GROUP], b: &[f64]) -> [f64; GROUP] {
    let n = b.len();
    let c = c.map(|c| &c[..n]);
    let mut sums = [[0.0; LANES]; GROUP];
    let whole = n - n % LANES;
    let mut i = 0;
    while i < whole {
        let b = &b[i..i + LANES];
        for k in 0..GROUP {
            let c = &c[k][i..i + LANES];
            for lane in 0..LANES {
                sums[k][lane] += c[lane] * b[lane];
            }
        }
        i += LANES;
    }
    let mut total = sums.map(|s| (s[0] + s[1]) + (s[2] + s[3]));
    for i in whole..n {
        for k in 0..GROUP {
            total[k] += c[k][i] * b[i];
        }
    }
    total
}

/// Returns the product of one column with `b`.
fn dot(c: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (c, c_rest) = c.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    for (c, b) in c.iter().zip(b) {
        for lane in 0..LANES {
            sums[lane] += c[lane] * b[lane];
        }
    }
    let rest: f64 = c_rest.iter().zip(b_rest).map(|(c, b)| c * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}
