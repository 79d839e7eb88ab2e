//! Runtimes of integrations in units of a fixed kernel, which reduces the influence of the machine and its load.
//!
//! Both are measured as processor time of the thread, alternately and for about as long, so that what slows one slows the
//! other: each measurement of the integration is divided by the mean of the kernel's before and after it. The median of such
//! ratios counts, which a few that were disturbed do not move, and of the medians at several moments the least: a neighbour
//! that takes caches away slows all integrations by a quarter for some seconds and the kernel by less, a program that became
//! slower is so at every moment. The kernel is made of what integrations are made of: short
//! right-hand sides with a branch (an oscillator with backlash under RK4), products of a dense matrix that lies in the cache,
//! and memory read out of order.

use crate::experiment::machine::timed;
use std::hint::black_box;

/// Steps of the oscillator, products and reads in one kernel: some milliseconds.
const STEPS: usize = 4_000;
const PRODUCTS: usize = 300;
const READS: usize = 30_000;
/// Size of the matrix, and of the memory that is read [numbers].
const SIZE: usize = 128;
const MEMORY: usize = 1 << 16;
/// Shortest measurement [s]: shorter integrations are repeated within one.
const LEAST: f64 = 5e-3;
/// Measurements in a row, and of integrations that take long [s].
const ROUNDS: usize = 7;
const FEW: usize = 3;
const LONG: f64 = 0.3;

/// Oscillators side by side, and running sums of a product: as many as keep a processor as busy as integrations do. One
/// chain of dependent numbers alone would hardly notice a neighbour on the same core.
const LANES: usize = 8;

/// Runs the kernel once; its value keeps the compiler from removing it.
fn kernel(matrix: &[f64], memory: &[u32], x: &mut [f64; SIZE]) -> f64 {
    let (mut q, mut v) = ([0.0_f64; LANES], [0.0_f64; LANES]);
    for (i, v) in v.iter_mut().enumerate() {
        *v = 1.0 + 0.1 * i as f64;
    }
    let force = |q: f64, v: f64, t: f64| {
        let gap = if q > 0.1 { q - 0.1 } else { (q + 0.1).min(0.0) };
        0.3 * t.sqrt() - gap - 0.05 * v
    };
    let h = 1e-3;
    for i in 0..STEPS {
        let t = i as f64 * h;
        for (q, v) in q.iter_mut().zip(&mut v) {
            let a1 = force(*q, *v, t);
            let a2 = force(*q + 0.5 * h * *v, *v + 0.5 * h * a1, t + 0.5 * h);
            let a3 = force(
                *q + 0.5 * h * *v + 0.25 * h * h * a1,
                *v + 0.5 * h * a2,
                t + 0.5 * h,
            );
            let a4 = force(*q + h * *v + 0.5 * h * h * a2, *v + h * a3, t + h);
            *q += h * *v + h * h / 6.0 * (a1 + a2 + a3);
            *v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        }
    }
    for _ in 0..PRODUCTS {
        let mut y = [0.0; SIZE];
        for (y, row) in y.iter_mut().zip(matrix.chunks_exact(SIZE)) {
            let mut sums = [0.0; LANES];
            for (a, b) in row.chunks_exact(LANES).zip(x.chunks_exact(LANES)) {
                for ((s, a), b) in sums.iter_mut().zip(a).zip(b) {
                    *s += a * b;
                }
            }
            *y = sums.iter().sum();
        }
        *x = y;
    }
    let (mut at, mut sum) = ([0_usize; LANES], 0_u64);
    for _ in 0..READS {
        for (lane, at) in at.iter_mut().enumerate() {
            let next = memory[*at];
            sum = sum.wrapping_add(u64::from(next));
            *at = (next as usize).wrapping_add(lane + sum as usize) % memory.len();
        }
    }
    q.iter().chain(&v).sum::<f64>() + x[0] + sum as f64
}

/// Measures the ratios of the time of an integration to that of the kernel.
pub(super) fn ratios(mut integrate: impl FnMut()) -> Vec<f64> {
    // Rows sum to a little less than one: the product neither grows nor vanishes into denormal numbers here.
    let matrix: Vec<f64> = (0..SIZE * SIZE)
        .map(|i| (1.0 + ((i * 7) % 13) as f64 / 13.0) / (1.5 * SIZE as f64))
        .collect();
    let memory: Vec<u32> = (0..MEMORY as u32)
        .map(|i| i.wrapping_mul(2_654_435_761))
        .collect();
    let mut x = [1.0; SIZE];
    let mut time_kernel = || {
        timed(|| {
            black_box(kernel(&matrix, &memory, black_box(&mut x)));
            x = x.map(|x| x.clamp(0.5, 2.0));
        })
        .1
    };
    // The first of each warms caches, and says how often it has to be repeated.
    let (one_kernel, one) = (time_kernel(), timed(&mut integrate).1);
    let sample = one.max(LEAST);
    let repeats = (sample / one.max(1e-9)).ceil().clamp(1.0, 1e5) as usize;
    let kernels = (sample / one_kernel.max(1e-6)).round().clamp(1.0, 1e3) as usize;
    let mut time_kernels = || (0..kernels).map(|_| time_kernel()).sum::<f64>() / kernels as f64;
    let mut before = time_kernels();
    let ratio = |_| {
        let (_, work) = timed(|| (0..repeats).for_each(|_| integrate()));
        let after = time_kernels();
        let mean = 0.5 * (std::mem::replace(&mut before, after) + after);
        work / repeats as f64 / mean
    };
    let rounds = if one > LONG { FEW } else { ROUNDS };
    (0..rounds).map(ratio).collect()
}

/// Returns the median of ratios; `None` of an empty list.
pub(super) fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_the_work_is_measured_as_often() {
        let work = |n: u64| (0..n).fold(0, |a, b| black_box(a ^ b));
        for n in [10, 30_000_000] {
            let found = ratios(|| {
                black_box(work(n));
            });
            assert_eq!(found.len(), ROUNDS);
            assert!(median(&found).is_some_and(|r| r.is_finite() && r >= 0.0));
        }
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[]), None);
    }

    #[test]
    fn the_kernel_stays_finite() {
        let matrix = vec![0.9 / SIZE as f64; SIZE * SIZE];
        let mut x = [1.0; SIZE];
        assert!(kernel(&matrix, &[1, 0], &mut x).is_finite());
    }
}
