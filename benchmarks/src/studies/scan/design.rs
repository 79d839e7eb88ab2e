//! Design of a scan: which values of its axes each cell has.
//!
//! Listed values are combined with each other (full factorial design). Distributions are sampled:
//!
//! | sampling | samples | source |
//! |---|---|---|
//! | `sobol` | Sobol sequence, scrambled after Owen and seeded | B. Burley, *J. Comput. Graph. Tech.* 9 (2020) No. 4 |
//! | `latin` | Latin hypercube: every axis has one sample in each of N equal shares | McKay, Beckman, Conover, *Technometrics* 21 (1979) 239 |
//! | `random` | independent samples | |
//!
//! Sensitivity indices need the samples of two independent matrices A and B, and A with one column of B after the other
//! (A. Saltelli et al., *Comput. Phys. Commun.* 181 (2010) 259): `d + 2` variants of each sample with d random axes.
//! They are sampled in [`REPLICATES`] groups, each scrambled with another seed; the differences between the groups are
//! the error of the indices.
//!
//! The cells of one sample follow each other: its variants, and for each the combinations of listed values, the last
//! axis fastest. All combinations have the same samples, so that their differences are not those of the samples; and
//! the first cells of a scan are a scan with fewer samples.

use super::axis::{Axis, AxisValues, text};
use crate::scene_file::changes::KeyPath;
use gearbench_reference::hash::spread;
use gearbench_reports::scan::Sampling;
use toml_edit::Value;

/// Number of groups of samples for sensitivity indices.
pub const REPLICATES: usize = 16;
/// Largest number of samples of one Sobol sequence.
const MOST_SOBOL: usize = 1 << 16;
/// Largest number of axes of one Sobol sequence.
const MOST_DIMENSIONS: usize = 256;
/// Largest number of cells.
const MOST_CELLS: u64 = 1_000_000_000_000;

/// Design of a scan.
#[derive(Clone, Debug)]
pub struct Design {
    axes: Vec<Axis>,
    sampling: Sampling,
    /// Number of samples; 1 without random axes.
    samples: usize,
    seed: u64,
    /// True if sensitivity indices are computed.
    indices: bool,
    /// Number of combinations of listed values.
    combinations: usize,
    /// For Latin hypercubes: the share of each sample, by random axis and variant A or B.
    shares: Vec<Vec<u32>>,
    cells: u64,
}

/// A cell of a scan by its place in the design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Sample, from 0.
    pub sample: usize,
    /// Variant of the sample: 0 for A, 1 for B, 2 + j for A with column j of B.
    pub variant: usize,
    /// Combination of listed values.
    pub combination: usize,
}

impl Design {
    /// Makes a design of axes; `samples` is the number of samples, which `seeds(N)` also states.
    ///
    /// # Errors
    /// A sentence with what was expected, where axes and options do not fit together.
    pub fn new(
        axes: Vec<Axis>,
        (sampling, samples, seed): (Sampling, Option<usize>, u64),
        indices: bool,
    ) -> Result<Self, String> {
        let mut keys: Vec<&KeyPath> = axes.iter().flat_map(|a| &a.keys).collect();
        keys.sort_by_key(|k| k.names());
        if let Some(twice) = keys.windows(2).find(|k| k[0] == k[1]) {
            return Err(format!("`{}` is varied twice", twice[0]));
        }
        let mut stated = samples;
        for axis in &axes {
            if let AxisValues::Seeds { count: n, .. } = axis.values {
                if stated.is_some_and(|stated| stated != n) {
                    let stated = stated.unwrap_or_default();
                    return Err(format!(
                        "seeds({n}) and {stated} samples do not fit together: give one number"
                    ));
                }
                stated = Some(n);
            }
        }
        let random = axes
            .iter()
            .any(|a| !matches!(a.values, AxisValues::Listed(_)));
        let sampled = axes
            .iter()
            .filter(|a| matches!(a.values, AxisValues::Sampled(_)))
            .count();
        let samples = match (stated, random) {
            (Some(n), true) => n,
            (None, true) => {
                return Err("distributions need a number of samples: give --samples N".into());
            }
            (Some(_), false) => {
                return Err(
                    "--samples needs an axis with a distribution, such as KEY=uniform(1,2)".into(),
                );
            }
            (None, false) => 1,
        };
        if indices {
            if sampled == 0
                || axes
                    .iter()
                    .any(|a| matches!(a.values, AxisValues::Seeds { .. }))
            {
                return Err(
                    "sensitivity indices need axes with distributions, and no seeds".into(),
                );
            }
            if samples % REPLICATES != 0 || samples < 2 * REPLICATES {
                return Err(format!(
                    "sensitivity indices are computed from {REPLICATES} groups of samples: expected a multiple of {REPLICATES} of at least {}",
                    2 * REPLICATES
                ));
            }
        }
        let dimensions = if indices { 2 * sampled } else { sampled };
        let groups = if indices { REPLICATES } else { 1 };
        if sampling == Sampling::Sobol && sampled > 0 {
            if samples / groups > MOST_SOBOL {
                return Err(format!(
                    "a Sobol sequence has at most {} samples: use --sampling latin",
                    groups * MOST_SOBOL
                ));
            }
            if dimensions > MOST_DIMENSIONS {
                return Err(format!(
                    "a Sobol sequence has at most {MOST_DIMENSIONS} columns: use --sampling latin"
                ));
            }
        }
        let mut design = Design {
            shares: Vec::new(),
            combinations: 0,
            cells: 0,
            axes,
            sampling,
            samples,
            seed,
            indices,
        };
        let too_many = "the scan has more than 1e12 cells";
        let combinations = design.lengths().try_fold(1, usize::checked_mul);
        design.combinations = combinations.ok_or(too_many)?;
        let cells = (design.combinations as u64)
            .checked_mul(samples as u64)
            .and_then(|n| n.checked_mul(design.variants() as u64));
        design.cells = cells.filter(|n| *n <= MOST_CELLS).ok_or(too_many)?;
        if sampling == Sampling::Latin {
            design.shares = (0..dimensions)
                .map(|d| design.latin(d, samples / groups, groups))
                .collect();
        }
        Ok(design)
    }

    /// The axes, in the order of the command line.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// How distributions are sampled.
    pub fn sampling(&self) -> Sampling {
        self.sampling
    }

    /// Seed of the samples.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Number of cells.
    pub fn cells(&self) -> u64 {
        self.cells
    }

    /// Number of samples; 1 where nothing is random.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// True if some axis is random.
    pub fn is_sampled(&self) -> bool {
        self.axes
            .iter()
            .any(|a| !matches!(a.values, AxisValues::Listed(_)))
    }

    /// True if sensitivity indices are computed.
    pub fn has_indices(&self) -> bool {
        self.indices
    }

    /// Number of variants of each sample.
    pub fn variants(&self) -> usize {
        if self.indices {
            2 + self.sampled_axes().count()
        } else {
            1
        }
    }

    /// Positions of the axes with distributions.
    pub fn sampled_axes(&self) -> impl Iterator<Item = usize> + '_ {
        let axes = self.axes.iter().enumerate();
        axes.filter(|(_, a)| matches!(a.values, AxisValues::Sampled(_)))
            .map(|(i, _)| i)
    }

    /// Number of values of each listed axis, 1 for others.
    pub fn lengths(&self) -> impl Iterator<Item = usize> + '_ {
        self.axes.iter().map(|a| match &a.values {
            AxisValues::Listed(values) => values.len(),
            _ => 1,
        })
    }

    /// Number of combinations of listed values.
    pub fn combinations(&self) -> usize {
        self.combinations
    }

    /// Place of a cell in the design.
    pub fn place(&self, cell: u64) -> Place {
        let combinations = self.combinations as u64;
        let (rest, combination) = (cell / combinations, cell % combinations);
        let variants = self.variants() as u64;
        Place {
            sample: (rest / variants) as usize,
            variant: (rest % variants) as usize,
            combination: combination as usize,
        }
    }

    /// Position in its list of the value of each axis in a combination, 0 for random axes.
    pub fn positions(&self, combination: usize) -> Vec<usize> {
        let lengths: Vec<usize> = self.lengths().collect();
        let mut rest = combination;
        let mut positions = vec![0; lengths.len()];
        for (position, n) in positions.iter_mut().zip(&lengths).rev() {
            (*position, rest) = (rest % n, rest / n);
        }
        positions
    }

    /// Values of all keys in a cell, axis by axis.
    pub fn values(&self, cell: u64) -> Vec<(&KeyPath, Value)> {
        let place = self.place(cell);
        let positions = self.positions(place.combination);
        let mut column = 0;
        let mut all = Vec::new();
        for (axis, position) in self.axes.iter().zip(positions) {
            match &axis.values {
                AxisValues::Listed(values) => {
                    all.extend(axis.keys.iter().zip(values[position].iter().cloned()));
                }
                AxisValues::Sampled(distribution) => {
                    all.push((&axis.keys[0], distribution.value(self.share(place, column))));
                    column += 1;
                }
                AxisValues::Seeds { first, .. } => {
                    all.push((&axis.keys[0], Value::from(first + place.sample as i64)));
                }
            }
        }
        all
    }

    /// Values of all keys in a cell as text.
    pub fn texts(&self, cell: u64) -> Vec<String> {
        self.values(cell)
            .iter()
            .map(|(_, value)| text(value))
            .collect()
    }

    /// Share (the value of the distribution function) of a random axis, given by its number among the random ones.
    pub fn share(&self, place: Place, column: usize) -> f64 {
        let d = self.sampled_axes().count();
        let of_b = place.variant == 1 || place.variant == 2 + column;
        let dimension = column + if self.indices && of_b { d } else { 0 };
        let groups = if self.indices { REPLICATES } else { 1 };
        let in_group = self.samples / groups;
        let (group, i) = (place.sample / in_group, place.sample % in_group);
        match self.sampling {
            Sampling::Sobol => {
                // The seed of the sequence has 32 bits.
                let seed = mixed([self.seed, group as u64, 0]) as u32;
                let x = sobol_burley::sample(i as u32, dimension as u32, seed);
                // Multiples of 2^-24 from 0 on; the quantile of 0 may be infinite.
                f64::from(x) + (-25.0_f64).exp2()
            }
            Sampling::Latin => {
                let share = f64::from(self.shares[dimension][place.sample]);
                (share + self.uniform(place.sample, dimension)) / in_group as f64
            }
            Sampling::Random => self.uniform(place.sample, dimension),
        }
    }

    /// A random number between 0 and 1, both excluded, that belongs to a sample and a column.
    fn uniform(&self, sample: usize, dimension: usize) -> f64 {
        let x = mixed([self.seed, 1 + sample as u64, 1 + dimension as u64]);
        ((x >> 12) as f64 + 0.5) * (-52.0_f64).exp2()
    }

    /// The share of each sample on an axis of a Latin hypercube: a random permutation for each group.
    fn latin(&self, dimension: usize, in_group: usize, groups: usize) -> Vec<u32> {
        let mut all = Vec::with_capacity(in_group * groups);
        for group in 0..groups {
            let begin = all.len();
            all.extend(0..in_group as u32);
            let shares: &mut [u32] = &mut all[begin..];
            // Fisher and Yates; the bias of the remainder is below 2^-32.
            for i in (1..shares.len()).rev() {
                let x = mixed([
                    self.seed ^ (group as u64) << 40,
                    i as u64,
                    !(dimension as u64),
                ]);
                shares.swap(i, (x % (i as u64 + 1)) as usize);
            }
        }
        all
    }
}

/// A number that depends on all bits of three numbers.
fn mixed(of: [u64; 3]) -> u64 {
    of.into_iter().fold(0, |state, x| spread(state ^ x))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn design(axes: &[&str], sampling: Sampling, samples: Option<usize>, indices: bool) -> Design {
        let axes = axes.iter().map(|a| a.parse().unwrap()).collect();
        Design::new(axes, (sampling, samples, 7), indices).unwrap()
    }

    /// Listed axes: all combinations, the last axis fastest; keys that change together have one place.
    #[test]
    fn listed_values_are_combined() {
        let d = design(
            &["a=1,2", "b | c = 10 | 5, 20 | 6, 30 | 7"],
            Sampling::Sobol,
            None,
            false,
        );
        assert_eq!(d.cells(), 6);
        let texts = |cell| {
            let of = |(_, v): (_, Value)| v.to_string();
            d.values(cell).into_iter().map(of).collect::<Vec<_>>()
        };
        assert_eq!(texts(0), ["1", "10", "5"]);
        assert_eq!(texts(4), ["2", "20", "6"]);
        assert_eq!(d.positions(4), [1, 1]);
    }

    /// Every sampling has the mean and the standard deviation of its distribution, a Latin hypercube one sample in each
    /// share; samples of another seed differ, those of the same seed do not.
    #[test]
    fn samples_have_their_distribution() {
        for sampling in Sampling::ALL {
            let d = design(
                &["a=uniform(0,1)", "b=normal(5,2)"],
                sampling,
                Some(1024),
                false,
            );
            let shares: Vec<f64> = (0..d.cells()).map(|c| d.share(d.place(c), 0)).collect();
            let mean = shares.iter().sum::<f64>() / 1024.0;
            let square = shares.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 1024.0;
            // Four standard deviations of independent samples.
            assert!(
                (mean - 0.5).abs() < 4.0 * 0.289 / 32.0,
                "{sampling}: {mean}"
            );
            assert!((square - 1.0 / 12.0).abs() < 0.01, "{sampling}: {square}");
            assert!(shares.iter().all(|x| *x > 0.0 && *x < 1.0));
            let mut strata: Vec<usize> = shares.iter().map(|x| (x * 1024.0) as usize).collect();
            strata.sort_unstable();
            strata.dedup();
            // A Sobol sequence in a power of two has this property too.
            assert_eq!(
                strata.len() == 1024,
                sampling != Sampling::Random,
                "{sampling}"
            );
            let other = Design {
                seed: 8,
                ..d.clone()
            };
            assert_eq!(d.share(d.place(5), 1), d.clone().share(d.place(5), 1));
            assert!(
                sampling == Sampling::Latin || d.share(d.place(5), 1) != other.share(d.place(5), 1)
            );
        }
    }

    /// A column of A that comes from B is that of variant B; the others are those of A.
    #[test]
    fn variants_exchange_one_column() {
        let d = design(
            &["a=uniform(0,1)", "x=1,2", "b=uniform(0,1)"],
            Sampling::Sobol,
            Some(64),
            true,
        );
        assert_eq!((d.variants(), d.cells()), (4, 64 * 4 * 2));
        let share = |variant, column| {
            d.share(
                Place {
                    sample: 9,
                    variant,
                    combination: 0,
                },
                column,
            )
        };
        assert_eq!([share(2, 0), share(2, 1)], [share(1, 0), share(0, 1)]);
        assert_eq!([share(3, 0), share(3, 1)], [share(0, 0), share(1, 1)]);
        assert_ne!(share(0, 0), share(1, 0));
    }

    #[test]
    fn what_does_not_fit_together_is_refused() {
        let refused = |axes: &[&str], samples, indices| {
            let axes = axes.iter().map(|a| a.parse().unwrap()).collect();
            Design::new(axes, (Sampling::Sobol, samples, 1), indices).unwrap_err()
        };
        assert!(refused(&["a=uniform(0,1)"], None, false).contains("--samples"));
        assert!(refused(&["a=1,2"], Some(3), false).contains("distribution"));
        assert!(refused(&["a=seeds(3)"], Some(4), false).contains("one number"));
        assert!(refused(&["a=1,2", "a=3"], None, false).contains("twice"));
        assert!(refused(&["a=uniform(0,1)"], Some(40), true).contains("multiple of 16"));
        assert!(refused(&["a=seeds(32)"], None, true).contains("distributions"));
        assert!(refused(&["a=uniform(0,1)"], Some(70_000), false).contains("latin"));
    }
}
