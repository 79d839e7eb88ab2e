//! Cholesky factorisation of small dense matrices, row-major.

use gearbench_integrators::system::Singular;

/// Computes a scalar product with four partial sums, because a single sum would wait for each addition.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (fours_a, rest_a) = a.as_chunks::<4>();
    let (fours_b, rest_b) = b[..a.len()].as_chunks::<4>();
    for (x, y) in fours_a.iter().zip(fours_b) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + rest
}

/// Computes the lower triangle `L` of `A = L L^T` in place; only the lower triangle of `a` is read.
pub(crate) fn cholesky(a: &mut [f64], n: usize) -> Result<(), Singular> {
    for i in 0..n {
        let (above, from_i) = a.split_at_mut(i * n);
        for j in 0..i {
            let row = &above[j * n..][..=j];
            from_i[j] = (from_i[j] - dot(&from_i[..j], row)) / row[j];
        }
        let pivot = from_i[i] - dot(&from_i[..i], &from_i[..i]);
        if !(pivot > 0.0 && pivot.is_finite()) {
            return Err(Singular);
        }
        from_i[i] = pivot.sqrt();
    }
    Ok(())
}

/// Solves `L x = b` in place: `x <- L^-1 x`.
pub(crate) fn forward(l: &[f64], x: &mut [f64]) {
    let n = x.len();
    for i in 0..n {
        let row = &l[i * n..][..n];
        x[i] = (x[i] - dot(&row[..i], &x[..i])) / row[i];
    }
}

/// Solves `L^T x = b` in place: `x <- L^-T x`.
pub(crate) fn backward(l: &[f64], x: &mut [f64]) {
    let n = x.len();
    for i in (0..n).rev() {
        let row = &l[i * n..][..n];
        x[i] /= row[i];
        let xi = x[i];
        for (y, l) in x[..i].iter_mut().zip(row) {
            *y -= l * xi;
        }
    }
}

/// Number of entries of a chunk of a padded row.
const WIDE: usize = 8;

/// Returns the row length of a padded matrix with `n` columns.
pub(crate) fn padded(n: usize) -> usize {
    n.next_multiple_of(WIDE)
}

/// Computes the upper triangle `U` of `A = U^T U` in place, with rows [`padded`]. Only the upper triangle of `a` is
/// read; the content below the diagonal is lost.
pub(crate) fn cholesky_padded(a: &mut [f64], n: usize) -> Result<(), Singular> {
    let stride = padded(n);
    for k in 0..n {
        let (above, row) = a.split_at_mut(k * stride);
        let (row, _) = row[..stride].as_chunks_mut::<WIDE>();
        let first = k / WIDE;
        for (c, row) in (first..).zip(&mut row[first..]) {
            let mut sum = *row;
            for line in above.chunks_exact(stride) {
                let x = line[k];
                let (line, _) = line.as_chunks::<WIDE>();
                for (s, y) in sum.iter_mut().zip(&line[c]) {
                    *s -= x * y;
                }
            }
            *row = sum;
        }
        let pivot = row[first][k % WIDE];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return Err(Singular);
        }
        let per = pivot.sqrt().recip();
        for row in &mut row[first..] {
            for x in row {
                *x *= per;
            }
        }
    }
    Ok(())
}

/// Positions of the entries of a banded matrix in storage.
#[derive(Clone, Debug, Default)]
pub(crate) struct EntryPositions {
    /// Index of the last column of each row.
    last: Vec<usize>,
    /// Index of the first row whose last column lies in a chunk or behind it, by chunk.
    first: Vec<usize>,
    /// Length of a row in storage.
    stride: usize,
}

impl EntryPositions {
    /// Returns the storage position of an entry of the upper triangle, or `None` outside the band.
    #[inline]
    pub fn of(&self, i: usize, j: usize) -> Option<usize> {
        let begin = i / WIDE * WIDE;
        (j >= begin && j <= self.last[i]).then(|| i * self.stride + j - begin)
    }
}

/// A symmetric matrix with a variable band width, no row ending before the row above it: its upper triangle, row `k`
/// from the chunk of column `k` on. The storage of a matrix that couples all columns is that of a [`padded`] one, that
/// of a chain is a band.
#[derive(Clone, Debug, Default)]
pub(crate) struct BandedMatrix {
    places: EntryPositions,
    entries: Vec<f64>,
}

impl BandedMatrix {
    /// Sets a matrix of zeros with `n` rows, wide enough for the given `pairs` of coupled columns, lower one first.
    pub fn reset(&mut self, n: usize, pairs: impl Iterator<Item = (usize, usize)>) {
        let p = &mut self.places;
        p.last.clear();
        p.last.extend(0..n);
        for (low, high) in pairs {
            p.last[low] = p.last[low].max(high);
        }
        let mut last = 0;
        for own in &mut p.last {
            last = last.max(*own);
            *own = last;
        }
        let widest = |last: &[usize]| {
            let chunks = last
                .iter()
                .enumerate()
                .map(|(k, l)| l / WIDE - k / WIDE + 1);
            chunks.max().unwrap_or(0)
        };
        let mut chunks = widest(&p.last);
        if 2 * WIDE * chunks > n {
            // No band: what couples all is summed in one order, however the rows reach.
            p.last.fill(n.saturating_sub(1));
            chunks = widest(&p.last);
        }
        p.first.clear();
        for (k, last) in p.last.iter().enumerate() {
            p.first.resize(p.first.len().max(last / WIDE + 1), k);
        }
        p.stride = WIDE * chunks;
        self.entries.clear();
        self.entries.resize(n * p.stride, 0.0);
    }

    /// Returns the positions of the entries and the entries.
    pub fn parts(&mut self) -> (&EntryPositions, &mut [f64]) {
        (&self.places, &mut self.entries)
    }

    /// Computes the upper triangle `U` of `A = U^T U` in place.
    pub fn factorise(&mut self) -> Result<(), Singular> {
        let EntryPositions {
            last,
            first,
            stride,
        } = &self.places;
        let stride = *stride;
        for k in 0..last.len() {
            let (above, row) = self.entries.split_at_mut(k * stride);
            let (row, _) = row[..stride].as_chunks_mut::<WIDE>();
            let own = k / WIDE;
            // Rows that reach column k.
            let reaching = last[..k].partition_point(|last| *last < k);
            for (c, row) in (own..=last[k] / WIDE).zip(&mut *row) {
                let mut sum = *row;
                let from = reaching.max(first[c]).min(k);
                for (p, line) in (from..k).zip(above[from * stride..].chunks_exact(stride)) {
                    let begin = p / WIDE;
                    let x = line[k - begin * WIDE];
                    let (line, _) = line.as_chunks::<WIDE>();
                    for (s, y) in sum.iter_mut().zip(&line[c - begin]) {
                        *s -= x * y;
                    }
                }
                *row = sum;
            }
            let pivot = row[0][k % WIDE];
            if !(pivot > 0.0 && pivot.is_finite()) {
                return Err(Singular);
            }
            let per = pivot.sqrt().recip();
            for row in row {
                for x in row {
                    *x *= per;
                }
            }
        }
        Ok(())
    }

    /// Solves with a factorised matrix in place: `x <- (U^T U)^-1 x`.
    pub fn solve(&self, x: &mut [f64]) {
        let p = &self.places;
        let row = |k: usize| &self.entries[k * p.stride + k % WIDE..][..p.last[k] - k + 1];
        for k in 0..x.len() {
            let row = row(k);
            let y = x[k] / row[0];
            x[k] = y;
            for (x, u) in x[k + 1..].iter_mut().zip(&row[1..]) {
                *x -= y * u;
            }
        }
        for k in (0..x.len()).rev() {
            let row = row(k);
            x[k] = (x[k] - dot(&row[1..], &x[k + 1..][..row.len() - 1])) / row[0];
        }
    }
}

/// Adds a multiple of a row, `y += x row`, over the chunks from 0 to that of entry `last`.
#[inline]
fn add_row(x: f64, row: &[f64], last: usize, y: &mut [f64]) {
    let (row, _) = row.as_chunks::<WIDE>();
    let (y, _) = y.as_chunks_mut::<WIDE>();
    for (y, r) in y.iter_mut().zip(&row[..=last / WIDE]) {
        for j in 0..WIDE {
            y[j] += x * r[j];
        }
    }
}

/// Appends the inverse of `A = U^T U` from a factor of [`cholesky_padded`], with rows [`padded`], to `out`; `work` is
/// a buffer.
pub(crate) fn append_inverse(u: &[f64], n: usize, work: &mut Vec<f64>, out: &mut Vec<f64>) {
    let stride = padded(n);
    // W = U^-T, row by row: W_k = (e_k - sum_{p<k} U_pk W_p) / U_kk.
    work.clear();
    work.resize(n * stride, 0.0);
    for k in 0..n {
        let (above, row) = work.split_at_mut(k * stride);
        let row = &mut row[..stride];
        for (p, of_p) in above.chunks_exact(stride).enumerate() {
            add_row(-u[p * stride + k], of_p, p, row);
        }
        row[k] += 1.0;
        let per = u[k * stride + k].recip();
        row.iter_mut().for_each(|x| *x *= per);
    }
    // A^-1 = W^T W.
    let begin = out.len();
    out.resize(begin + n * stride, 0.0);
    for (k, row) in work.chunks_exact(stride.max(1)).enumerate() {
        for i in 0..=k {
            add_row(row[i], row, k, &mut out[begin + i * stride..][..stride]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factorisation_solves() {
        // A = M M^T + I of a fixed full matrix.
        let n = 7;
        let m: Vec<f64> = (0..n * n).map(|i| ((i * i + 3) as f64).sin()).collect();
        let mut a = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..n {
                a[i * n + j] = dot(&m[i * n..][..n], &m[j * n..][..n]);
            }
            a[i * n + i] += 1.0;
        }
        let x: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
        let mut b: Vec<f64> = (0..n).map(|i| dot(&a[i * n..][..n], &x)).collect();
        cholesky(&mut a, n).unwrap();
        forward(&a, &mut b);
        backward(&a, &mut b);
        for (b, x) in b.iter().zip(&x) {
            assert!((b - x).abs() < 1e-13);
        }
        let mut indefinite = [1.0, 0.0, 2.0, 1.0];
        assert_eq!(cholesky(&mut indefinite, 2), Err(Singular));
    }

    #[test]
    fn a_padded_factorisation_inverts() {
        for n in [1, 7, 8, 9, 19, 24] {
            let m: Vec<f64> = (0..n * n).map(|i| ((i * i + 3) as f64).sin()).collect();
            let stride = padded(n);
            let mut a = vec![0.0; n * stride];
            for i in 0..n {
                for j in 0..n {
                    a[i * stride + j] = dot(&m[i * n..][..n], &m[j * n..][..n]);
                }
                a[i * stride + i] += 1.0;
            }
            let plain = a.clone();
            cholesky_padded(&mut a, n).unwrap();
            let mut inverse = vec![];
            append_inverse(&a, n, &mut vec![], &mut inverse);
            for i in 0..n {
                for j in 0..n {
                    let unit: f64 = (0..n)
                        .map(|k| inverse[i * stride + k] * plain[k * stride + j])
                        .sum();
                    let want = f64::from(u8::from(i == j));
                    assert!((unit - want).abs() < 1e-12, "{n}: {unit} {want}");
                }
            }
        }
        let mut indefinite = [0.0; 16];
        (indefinite[0], indefinite[1], indefinite[9]) = (1.0, 2.0, 1.0);
        assert_eq!(cholesky_padded(&mut indefinite, 2), Err(Singular));
    }

    /// A banded factorisation solves for chains of blocks coupled to their neighbours, and for a block that couples
    /// all.
    #[test]
    fn a_banded_factorisation_solves() {
        for (n, block) in [(1, 1), (9, 9), (40, 40), (40, 5), (61, 7), (64, 8)] {
            let reaches = |i: usize| ((i / block + 2) * block - 1).min(n - 1);
            let mut banded = BandedMatrix::default();
            banded.reset(n, (0..n).map(|i| (i, reaches(i))));
            let mut whole = vec![0.0; n * n];
            for i in 0..n {
                for j in i..=reaches(i) {
                    let x = ((i * n + j + 3) as f64).sin() + if i == j { n as f64 } else { 0.0 };
                    (whole[i * n + j], whole[j * n + i]) = (x, x);
                    let (places, entries) = banded.parts();
                    entries[places.of(i, j).unwrap()] = x;
                }
            }
            let narrow = 2 * 2 * block.next_multiple_of(WIDE) + 2 * WIDE <= n;
            assert!(!narrow || banded.parts().0.of(0, reaches(0) + 1).is_none());
            let x: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
            let mut b: Vec<f64> = (0..n).map(|i| dot(&whole[i * n..][..n], &x)).collect();
            banded.factorise().unwrap();
            banded.solve(&mut b);
            for (b, x) in b.iter().zip(&x) {
                assert!((b - x).abs() < 1e-12, "{n}, {block}: {b} {x}");
            }
        }
        let mut indefinite = BandedMatrix::default();
        indefinite.reset(2, [(0, 1)].into_iter());
        let (places, entries) = indefinite.parts();
        for (i, j, x) in [(0, 0, 1.0), (0, 1, 2.0), (1, 1, 1.0)] {
            entries[places.of(i, j).unwrap()] = x;
        }
        assert_eq!(indefinite.factorise(), Err(Singular));
    }
}
