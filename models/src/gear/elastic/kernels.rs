//! Products of the shapes of a few nodes with all modes, several nodes at once so that coordinates are read once.
//!
//! Sums run in four parts, whatever number of nodes goes together: what a node gets does not depend on its company.

/// Number of entries of a chunk.
const WIDE: usize = 4;

/// Computes the scalar products `b_k . x` for `N` rows.
#[inline]
fn dots<const N: usize>(b: [&[f64]; N], x: &[f64]) -> [f64; N] {
    let n = x.len();
    let chunks = b.map(|b| b[..n].as_chunks::<WIDE>());
    let (of_x, rest) = x.as_chunks::<WIDE>();
    let mut parts = [[0.0; WIDE]; N];
    for (i, x) in of_x.iter().enumerate() {
        for k in 0..N {
            let b = &chunks[k].0[i];
            for j in 0..WIDE {
                parts[k][j] += b[j] * x[j];
            }
        }
    }
    let mut sums = [0.0; N];
    for k in 0..N {
        let [a, b, c, d] = parts[k];
        sums[k] = (a + c) + (b + d);
        for (b, x) in chunks[k].1.iter().zip(rest) {
            sums[k] += b * x;
        }
    }
    sums
}

/// Computes `out_k = b_k . x` for nodes `k`, with their shapes in `row`.
#[inline]
pub(super) fn gather<'a>(
    nodes: &[u32],
    row: impl Fn(u32) -> &'a [f64],
    x: &[f64],
    out: &mut [f64],
) {
    let (fours, rest) = nodes.as_chunks::<4>();
    let (of_fours, of_rest) = out[..nodes.len()].as_chunks_mut::<4>();
    for (four, out) in fours.iter().zip(of_fours) {
        *out = dots(four.map(&row), x);
    }
    let (twos, ones) = rest.as_chunks::<2>();
    let (of_twos, of_ones) = of_rest.as_chunks_mut::<2>();
    for (two, out) in twos.iter().zip(of_twos) {
        *out = dots(two.map(&row), x);
    }
    for (&one, out) in ones.iter().zip(of_ones) {
        [*out] = dots([row(one)], x);
    }
}

/// Computes `f -= sum_k F_k b_k` for four rows.
#[inline]
fn subtract(b: [&[f64]; 4], forces: [f64; 4], f: &mut [f64]) {
    let n = f.len();
    let b = b.map(|b| &b[..n]);
    let chunks = b.map(|b| b.as_chunks::<WIDE>().0);
    let (of_f, rest) = f.as_chunks_mut::<WIDE>();
    for (i, f) in of_f.iter_mut().enumerate() {
        for j in 0..WIDE {
            let pair = forces[0] * chunks[0][i][j] + forces[1] * chunks[1][i][j];
            f[j] -= pair + (forces[2] * chunks[2][i][j] + forces[3] * chunks[3][i][j]);
        }
    }
    let done = n - rest.len();
    for (i, f) in (done..).zip(rest) {
        let pair = forces[0] * b[0][i] + forces[1] * b[1][i];
        *f -= pair + (forces[2] * b[2][i] + forces[3] * b[3][i]);
    }
}

/// Computes `f -= sum_k F_k b_k` for nodes `k`, with their shapes in `row`; nodes without force are skipped.
#[inline]
pub(super) fn scatter<'a>(
    nodes: &[u32],
    forces: &[f64],
    row: impl Fn(u32) -> &'a [f64],
    f: &mut [f64],
) {
    let (mut rows, mut four, mut count) = ([&[][..]; 4], [0.0; 4], 0);
    for (&node, &force) in nodes.iter().zip(forces) {
        if force == 0.0 {
            continue;
        }
        (rows[count], four[count]) = (row(node), force);
        count += 1;
        if count == 4 {
            subtract(rows, four, f);
            count = 0;
        }
    }
    if count > 0 {
        for k in count..4 {
            (rows[k], four[k]) = (rows[0], 0.0);
        }
        subtract(rows, four, f);
    }
}

/// Computes the sum of `(w_i x_i)^2`.
#[inline]
pub(super) fn squares(w: &[f64], x: &[f64]) -> f64 {
    let n = w.len().min(x.len());
    let (of_w, rest_w) = w[..n].as_chunks::<8>();
    let (of_x, rest_x) = x[..n].as_chunks::<8>();
    let mut parts = [0.0; 8];
    for (w, x) in of_w.iter().zip(of_x) {
        for j in 0..8 {
            let y = w[j] * x[j];
            parts[j] += y * y;
        }
    }
    let rest = rest_w.iter().zip(rest_x).map(|(w, x)| (w * x) * (w * x));
    parts.iter().sum::<f64>() + rest.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_plain_loops_and_know_no_company() {
        for modes in [0, 1, 4, 7, 33] {
            let b: Vec<f64> = (0..11 * modes).map(|i| (i as f64).sin()).collect();
            let x: Vec<f64> = (0..modes).map(|i| (0.3 * i as f64).cos()).collect();
            let row = |k: u32| &b[k as usize * modes..][..modes];
            let nodes: Vec<u32> = (0..11).rev().collect();
            let mut out = vec![0.0; 11];
            gather(&nodes, row, &x, &mut out);
            for (&node, &a) in nodes.iter().zip(&out) {
                let plain: f64 = row(node).iter().zip(&x).map(|(b, x)| b * x).sum();
                assert!((a - plain).abs() < 1e-13);
                let mut alone = [0.0];
                gather(&[node], row, &x, &mut alone);
                assert_eq!(alone[0], a);
            }
            let forces: Vec<f64> = (0..11).map(|k| f64::from(k % 3)).collect();
            let mut f = vec![1.0; modes];
            scatter(&nodes, &forces, row, &mut f);
            for (i, f) in f.iter().enumerate() {
                let pressed = nodes.iter().zip(&forces).map(|(&k, x)| x * row(k)[i]);
                assert!((f - (1.0 - pressed.sum::<f64>())).abs() < 1e-13);
            }
            let plain: f64 = x.iter().zip(&b).map(|(w, x)| (w * x).powi(2)).sum();
            assert!((squares(&x, &b) - plain).abs() < 1e-13);
        }
    }
}
