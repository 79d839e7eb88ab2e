//! Cholesky factorisation of small dense matrices, row-major.

use gearbench_integrators::system::Singular;

/// Four sums at once: a single one would wait for each addition.
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

/// Lower triangle `L` of `A = L L^T` in place; only the lower triangle of `a` is read.
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

/// `x <- L^-1 x`.
pub(crate) fn forward(l: &[f64], x: &mut [f64]) {
    let n = x.len();
    for i in 0..n {
        let row = &l[i * n..][..n];
        x[i] = (x[i] - dot(&row[..i], &x[..i])) / row[i];
    }
}

/// `x <- L^-T x`.
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
}
