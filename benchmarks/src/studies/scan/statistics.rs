//! Statistics of a scan over its samples, computed in passes over its rows: memory does not grow with their number.
//!
//! | pass | computes |
//! |---|---|
//! | 1 | counts, means and standard deviations (B. P. Welford, *Technometrics* 4 (1962) 419), least and greatest values |
//! | 2 | sensitivity indices |
//! | 3 to 10 | quantiles, by selection in eight digits of eight bits |
//!
//! A quantile p is the value of rank `ceil(p n)` of n sorted values. A number is sorted by its bits: those of a
//! non-negative number are in its order, those of a negative one in reverse.
//!
//! Sensitivity indices of axis j, with f of the samples A, B and A with column j of B (first order: A. Saltelli et al.,
//! *Comput. Phys. Commun.* 181 (2010) 259; total: M. J. W. Jansen, *Comput. Phys. Commun.* 117 (1999) 35):
//!
//! ```text
//! S_j = mean(f_B (f_AB - f_A)) / V,     T_j = mean((f_A - f_AB)^2) / (2 V),     V the variance of f_A and f_B
//! ```
//!
//! f counts from its mean. An index is the ratio of two means over [`REPLICATES`] groups of samples, each
//! scrambled with another seed; its interval is that of a ratio (Student's t of the numerators less the index times the denominators).

use super::design::{Design, REPLICATES};
use gearbench_reports::scan::{SampleStatistics, SensitivityIndex};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Shares of samples of the quantiles that are recorded, next to the least and greatest value.
const SHARES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];
/// Largest number of statistics; a scan with more combinations of listed values has none.
const MOST: usize = 5000;
/// Number of values of a digit of eight bits.
const DIGIT: usize = 256;

/// A row of a run: cell, configuration, outputs (NaN where there are none).
pub type Visit<'v> = dyn FnMut(u64, usize, &[f64]) + 'v;

/// Moments of the values of one output.
#[derive(Clone, Copy, Debug)]
struct Moments {
    count: u64,
    missing: u64,
    mean: f64,
    /// Sum of the squares of deviations from the mean.
    squares: f64,
    least: f64,
    greatest: f64,
}

impl Moments {
    const NONE: Moments = Moments {
        count: 0,
        missing: 0,
        mean: 0.0,
        squares: 0.0,
        least: f64::INFINITY,
        greatest: f64::NEG_INFINITY,
    };

    fn add(&mut self, x: f64) {
        if x.is_nan() {
            self.missing += 1;
            return;
        }
        self.count += 1;
        let off = x - self.mean;
        self.mean += off / self.count as f64;
        self.squares += off * (x - self.mean);
        self.least = self.least.min(x);
        self.greatest = self.greatest.max(x);
    }
}

/// Selection of the value of one rank among values that are seen pass by pass.
#[derive(Clone)]
struct Selection {
    /// Rank among the values that begin with the digits found so far, from 0.
    rank: u64,
    /// Digits found so far, in the highest bits.
    found: u64,
    counts: [u64; DIGIT],
}

/// The bits of a number in an order in which they sort as the number does.
fn sortable(x: f64) -> u64 {
    let bits = x.to_bits();
    bits ^ if bits >> 63 == 1 { u64::MAX } else { 1 << 63 }
}

fn number(sortable: u64) -> f64 {
    f64::from_bits(
        sortable
            ^ if sortable >> 63 == 1 {
                1 << 63
            } else {
                u64::MAX
            },
    )
}

impl Selection {
    fn new(rank: u64) -> Self {
        Selection {
            rank,
            found: 0,
            counts: [0; DIGIT],
        }
    }

    fn see(&mut self, bits: u64, digit: u32) {
        let below = 64 - 8 * digit;
        let same = digit == 0 || (bits ^ self.found) >> below == 0;
        if same {
            self.counts[(bits >> (below - 8)) as usize & (DIGIT - 1)] += 1;
        }
    }

    /// Fixes the next digit after a pass.
    fn settle(&mut self, digit: u32) {
        let mut value = 0;
        while value + 1 < DIGIT && self.rank >= self.counts[value] {
            self.rank -= self.counts[value];
            value += 1;
        }
        self.found |= (value as u64) << (56 - 8 * digit);
        self.counts = [0; DIGIT];
    }
}

/// Sums over the samples of a group, of one output of a configuration and combination.
struct Sums {
    samples: u64,
    /// Squares of the values of A and B about their mean, half of their sum.
    squares: f64,
    /// Numerators of the indices of each axis.
    first: Vec<f64>,
    total: Vec<f64>,
}

/// Statistics and sensitivity indices of a scan.
#[derive(Debug, Default)]
pub struct Statistics {
    /// Statistics over the samples.
    pub samples: Vec<SampleStatistics>,
    /// Sensitivity indices.
    pub indices: Vec<SensitivityIndex>,
}

/// Number of combinations of listed values, configurations and outputs.
struct Sizes {
    combinations: usize,
    configurations: usize,
    outputs: usize,
}

impl Sizes {
    fn all(&self) -> usize {
        self.combinations * self.configurations * self.outputs
    }

    /// Position of an output of a configuration and combination.
    fn position(&self, combination: usize, configuration: usize, output: usize) -> usize {
        (combination * self.configurations + configuration) * self.outputs + output
    }
}

impl Statistics {
    /// Computes the statistics of a design whose rows `rows` visits in the order of its cells, as often as it is asked.
    ///
    /// # Errors
    /// Errors of `rows`.
    pub fn of<E>(
        design: &Design,
        (configurations, outputs): (usize, usize),
        rows: &dyn Fn(&mut Visit<'_>) -> Result<(), E>,
    ) -> Result<Self, E> {
        let combinations = design.combinations();
        let sizes = Sizes {
            combinations,
            configurations,
            outputs,
        };
        let few = combinations <= MOST && sizes.all() <= MOST;
        if !design.is_sampled() || !few {
            return Ok(Statistics::default());
        }
        // Both A and B are samples of the distributions.
        let is_sample = |cell: u64| design.place(cell).variant < 2;
        let mut moments = vec![Moments::NONE; sizes.all()];
        rows(&mut |cell, configuration, values| {
            if is_sample(cell) {
                let begin = sizes.position(design.place(cell).combination, configuration, 0);
                (moments[begin..].iter_mut().zip(values)).for_each(|(m, x)| m.add(*x));
            }
        })?;
        let indices = match design.has_indices() {
            true => indices(design, &sizes, &moments, rows)?,
            false => Vec::new(),
        };
        let quantiles = quantiles(design, &sizes, &moments, rows)?;
        let mut samples = Vec::new();
        for output in 0..outputs {
            for configuration in 0..configurations {
                for combination in 0..combinations {
                    let i = sizes.position(combination, configuration, output);
                    let m = &moments[i];
                    if m.count == 0 {
                        continue;
                    }
                    let [q5, q25, q50, q75, q95] = quantiles[i];
                    samples.push(SampleStatistics {
                        configuration,
                        output,
                        at: design.positions(combination),
                        count: m.count,
                        missing: m.missing,
                        mean: m.mean,
                        deviation: (m.squares / (m.count.max(2) - 1) as f64).sqrt(),
                        quantiles: [m.least, q5, q25, q50, q75, q95, m.greatest],
                    });
                }
            }
        }
        Ok(Statistics { samples, indices })
    }
}

/// Quantiles of all outputs, in eight passes.
fn quantiles<E>(
    design: &Design,
    sizes: &Sizes,
    moments: &[Moments],
    rows: &dyn Fn(&mut Visit<'_>) -> Result<(), E>,
) -> Result<Vec<[f64; 5]>, E> {
    let rank = |share: f64, n: u64| ((share * n as f64).ceil() as u64).clamp(1, n.max(1)) - 1;
    let mut selections: Vec<[Selection; 5]> = (moments.iter())
        .map(|m| SHARES.map(|share| Selection::new(rank(share, m.count))))
        .collect();
    for digit in 0..8 {
        rows(&mut |cell, configuration, values| {
            let place = design.place(cell);
            if place.variant > 1 {
                return;
            }
            let begin = sizes.position(place.combination, configuration, 0);
            for (of, x) in selections[begin..].iter_mut().zip(values) {
                if !x.is_nan() {
                    let bits = sortable(*x);
                    of.iter_mut().for_each(|s| s.see(bits, digit));
                }
            }
        })?;
        selections
            .iter_mut()
            .flatten()
            .for_each(|s| s.settle(digit));
    }
    Ok(selections
        .iter()
        .map(|all| [0, 1, 2, 3, 4].map(|k| number(all[k].found)))
        .collect())
}

/// Sensitivity indices of all outputs, in one pass.
fn indices<E>(
    design: &Design,
    sizes: &Sizes,
    moments: &[Moments],
    rows: &dyn Fn(&mut Visit<'_>) -> Result<(), E>,
) -> Result<Vec<SensitivityIndex>, E> {
    let axes: Vec<usize> = design.sampled_axes().collect();
    let variants = design.variants();
    let per_group = design.samples() / REPLICATES;
    let empty = || Sums {
        samples: 0,
        squares: 0.0,
        first: vec![0.0; axes.len()],
        total: vec![0.0; axes.len()],
    };
    let mut sums: Vec<Vec<Sums>> = (0..sizes.all())
        .map(|_| (0..REPLICATES).map(|_| empty()).collect())
        .collect();
    // Values of the sample whose rows are being visited: of each position, by variant.
    let mut values = vec![f64::NAN; sizes.all() * variants];
    let mut filled = 0;
    rows(&mut |cell, configuration, outputs| {
        let place = design.place(cell);
        for (output, x) in outputs.iter().enumerate() {
            let i = sizes.position(place.combination, configuration, output);
            values[i * variants + place.variant] = *x;
        }
        filled += 1;
        if filled < sizes.combinations * sizes.configurations * variants {
            return;
        }
        filled = 0;
        let group = place.sample / per_group;
        for (i, f) in values.chunks_exact(variants).enumerate() {
            // A sample with a failed run counts for no index.
            if f.iter().any(|x| x.is_nan()) {
                continue;
            }
            let sums = &mut sums[i][group];
            let [a, b] = [f[0] - moments[i].mean, f[1] - moments[i].mean];
            sums.samples += 1;
            sums.squares += 0.5 * (a * a + b * b);
            for (j, f) in f[2..].iter().enumerate() {
                let mixed = f - moments[i].mean;
                sums.first[j] += b * (mixed - a);
                sums.total[j] += 0.5 * (a - mixed).powi(2);
            }
        }
    })?;
    let mut found = Vec::new();
    for output in 0..sizes.outputs {
        for configuration in 0..sizes.configurations {
            for combination in 0..sizes.combinations {
                let i = sizes.position(combination, configuration, output);
                let used = || sums[i].iter().filter(|s| s.samples > 0);
                if moments[i].squares <= 0.0 || used().count() < 2 {
                    continue;
                }
                for (j, axis) in axes.iter().enumerate() {
                    let share = |of: fn(&Sums) -> &Vec<f64>| {
                        let each =
                            used().map(|s| [of(s)[j], s.squares].map(|x| x / s.samples as f64));
                        ratio_with_interval(&each.collect::<Vec<_>>())
                    };
                    found.push(SensitivityIndex {
                        configuration,
                        output,
                        at: design.positions(combination),
                        axis: *axis,
                        first: share(|s| &s.first),
                        total: share(|s| &s.total),
                    });
                }
            }
        }
    }
    Ok(found)
}

/// Ratio of the means of at least two pairs of values, with its 95 % interval (linearised, W. G. Cochran, *Sampling
/// Techniques*, 1977, 6.3).
fn ratio_with_interval(of: &[[f64; 2]]) -> [f64; 3] {
    let n = of.len() as f64;
    let [above, below] = [0, 1].map(|k| of.iter().map(|x| x[k]).sum::<f64>() / n);
    let ratio = above / below;
    let squares = of
        .iter()
        .map(|x| (x[0] - ratio * x[1]).powi(2))
        .sum::<f64>();
    let t = StudentsT::new(0.0, 1.0, n - 1.0).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975));
    let half = t * (squares / (n - 1.0) / n).sqrt() / below;
    [ratio, ratio - half, ratio + half]
}

#[cfg(test)]
mod tests {
    use super::*;
    use gearbench_reports::scan::Sampling;

    fn design(
        axes: &[&str],
        (sampling, samples, seed): (Sampling, usize, u64),
        indices: bool,
    ) -> Design {
        let axes = axes.iter().map(|a| a.parse().unwrap()).collect();
        Design::new(axes, (sampling, Some(samples), seed), indices).unwrap()
    }

    /// Statistics of a function of the values of a design, without scenes.
    fn of(design: &Design, f: &dyn Fn(&[f64]) -> f64) -> Statistics {
        let rows = |visit: &mut Visit<'_>| -> Result<(), ()> {
            for cell in 0..design.cells() {
                let values = design.values(cell);
                let values: Vec<f64> = values
                    .iter()
                    .map(|(_, v)| v.as_float().or(v.as_integer().map(|i| i as f64)).unwrap())
                    .collect();
                visit(cell, 0, &[f(&values)]);
            }
            Ok(())
        };
        Statistics::of(design, (1, 1), &rows).unwrap()
    }

    /// T. Ishigami and T. Homma (1990): f = sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1 on [-pi, pi]^3, whose indices are
    /// known.
    #[test]
    fn indices_of_ishigami() {
        let axis = |k: u32| format!("x{k}=uniform(-3.141592653589793,3.141592653589793)");
        let axes = [axis(1), axis(2), axis(3)];
        let axes: Vec<&str> = axes.iter().map(String::as_str).collect();
        let f = |x: &[f64]| x[0].sin() + 7.0 * x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin();
        let (a, b, pi) = (7.0_f64, 0.1_f64, std::f64::consts::PI);
        let variance = a * a / 8.0 + b * pi.powi(4) / 5.0 + b * b * pi.powi(8) / 18.0 + 0.5;
        let first = [
            0.5 * (1.0 + b * pi.powi(4) / 5.0).powi(2) / variance,
            a * a / 8.0 / variance,
            0.0,
        ];
        let joint = 8.0 * b * b * pi.powi(8) / 225.0 / variance;
        let total = [first[0] + joint, first[1], joint];
        let mut outside = 0;
        for (sampling, seed) in Sampling::ALL
            .into_iter()
            .flat_map(|s| (1..=4).map(move |seed| (s, seed)))
        {
            let s = of(&design(&axes, (sampling, 2048, seed), true), &f);
            assert!(
                (s.samples[0].mean - 0.5 * a).abs() < 0.3,
                "{}",
                s.samples[0].mean
            );
            for i in &s.indices {
                let known = [first[i.axis], total[i.axis]];
                for (found, known) in [i.first, i.total].into_iter().zip(known) {
                    outside += usize::from(!(found[1]..=found[2]).contains(&known));
                    assert!(
                        (found[0] - known).abs() < 0.1,
                        "{sampling} {found:?} {known}"
                    );
                }
            }
        }
        // Of 72 intervals of 95 % more than 8 outside would have a probability of 2 %.
        assert!(outside <= 8, "{outside} of 72 are outside");
    }

    /// Quantiles, moments and missing values against sorted values.
    #[test]
    fn quantiles_are_those_of_sorted_values() {
        let d = design(
            &["a=normal(-3,40)", "b=1,2"],
            (Sampling::Random, 999, 3),
            false,
        );
        let f = |x: &[f64]| if x[0] > 30.0 { f64::NAN } else { x[0] * x[1] };
        let s = of(&d, &f);
        assert_eq!(s.samples.len(), 2);
        for (k, s) in s.samples.iter().enumerate() {
            let mut sorted: Vec<f64> = (0..d.cells())
                .filter(|c| d.place(*c).combination == k)
                .map(|c| d.values(c)[0].1.as_float().unwrap() * (k + 1) as f64)
                .filter(|x| *x <= 30.0 * (k + 1) as f64)
                .collect();
            sorted.sort_by(f64::total_cmp);
            let n = sorted.len();
            assert_eq!((s.count, s.missing), (n as u64, 999 - n as u64));
            let at = |share: f64| sorted[(share * n as f64).ceil() as usize - 1];
            let expected = [0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0];
            for (found, share) in s.quantiles.iter().zip(expected) {
                let expected = if share == 0.0 { sorted[0] } else { at(share) };
                assert_eq!(*found, expected, "{share}");
            }
            let mean = sorted.iter().sum::<f64>() / n as f64;
            assert!((s.mean - mean).abs() < 1e-10);
        }
    }
}
