//! Inertia relief: from the compliance of a gear on a fixed hub to that on its mount.

use crate::reduction::Mounting;
use faer::Mat;
use faer::prelude::Solve;
use gearbench_models::gear::elastic::reduced::{FlankCompliance, Residual};

/// Compliance with fixed hub, and the data of inertia relief.
pub(super) struct FixedHubCompliance {
    /// `X` between the flank nodes, in the layout of the result.
    pub flanks: FlankCompliance,
    /// Number of hub motions, `n`: the free ones, or the fixed one of a fixed hub.
    pub motions: usize,
    /// Displacement outwards per unit of each motion, `a_k`, `n` per row.
    pub arms: Vec<f64>,
    /// `g_k`, `n` per row.
    pub inertial: Vec<f64>,
    /// `Gamma`, `n x n`.
    pub hub: Vec<f64>,
    /// Inertia `J` without that added at the hub, `n x n`.
    pub inertia: Vec<f64>,
}

impl FixedHubCompliance {
    /// The compliance on a mount.
    pub fn mounted(self, mounting: &Mounting) -> Residual {
        let rows = self.arms.len() / self.motions;
        if mounting.is_lateral() {
            return self.mounted_lateral(mounting);
        }
        let FixedHubCompliance {
            mut flanks,
            arms,
            inertial,
            hub,
            inertia,
            ..
        } = self;
        if !mounting.free {
            return Residual {
                flanks,
                hub: vec![0.0; rows],
                hub_hub: 0.0,
            };
        }
        let inertia = inertia[0] + mounting.added_inertia;
        let gamma = hub[0] / (inertia * inertia);
        // Teeth that are alike move alike.
        let alike = match &flanks {
            FlankCompliance::Full(_) | FlankCompliance::Deflated(_) => rows,
            FlankCompliance::Cyclic { per_tooth, .. } => *per_tooth,
        };
        add_relief(&mut flanks, rows, |k, l| {
            let k = k % alike;
            arms[k] * arms[l] * gamma - (inertial[k] * arms[l] + arms[k] * inertial[l]) / inertia
        });
        let hub_to = |k: usize| arms[k] * gamma - inertial[k] / inertia;
        Residual {
            hub: (0..rows).map(hub_to).collect(),
            hub_hub: gamma,
            flanks,
        }
    }

    /// Returns `J^-1` including the inertia added at the hub.
    fn inverse(&self, mounting: &Mounting) -> Mat<f64> {
        let n = self.motions;
        let added = mounting.added_in_motions();
        let inertia = Mat::from_fn(n, n, |p, q| {
            self.inertia[p * n + q] + if p == q { added[p] } else { 0.0 }
        });
        inertia.partial_piv_lu().solve(Mat::<f64>::identity(n, n))
    }

    /// Returns the matrix `Gamma`.
    fn gamma(&self) -> Mat<f64> {
        let n = self.motions;
        Mat::from_fn(n, n, |p, q| self.hub[p * n + q])
    }

    /// Displacements of the hub in its free directions by unit loads on it there, against inertia relief: such a load is a
    /// column with `X = g = 0` and a unit vector as `a`.
    pub fn hub_compliance(&self, mounting: &Mounting) -> Mat<f64> {
        let inverse = self.inverse(mounting);
        inverse.transpose() * self.gamma() * &inverse
    }

    /// Computes the compliance on a hub that is free in several directions.
    fn mounted_lateral(self, mounting: &Mounting) -> Residual {
        let n = self.motions;
        let rows = self.arms.len() / n;
        let (inverse, gamma) = (self.inverse(mounting), self.gamma());
        let hub = self.hub_compliance(mounting);
        // Rows of `b`, and of `Gamma b - g`.
        let of_rows = |x: &[f64]| Mat::from_fn(x.len() / n, n, |k, p| x[k * n + p]);
        let b = of_rows(&self.arms) * inverse.transpose();
        let g = of_rows(&self.inertial);
        let h = &b * gamma.transpose() - &g;
        let mut flanks = self.flanks;
        add_relief(&mut flanks, rows, |k, l| {
            (0..n)
                .map(|p| b[(k, p)] * h[(l, p)] - g[(k, p)] * b[(l, p)])
                .sum()
        });
        let own = |k: usize| -> f64 { (0..n).map(|p| h[(k, p)] * inverse[(p, 0)]).sum() };
        Residual {
            hub: match mounting.free {
                true => (0..rows).map(own).collect(),
                false => vec![0.0; rows],
            },
            hub_hub: if mounting.free { hub[(0, 0)] } else { 0.0 },
            flanks,
        }
    }
}

/// Adds the rigid-motion part between two rows.
fn add_relief(flanks: &mut FlankCompliance, rows: usize, relief: impl Fn(usize, usize) -> f64) {
    match flanks {
        FlankCompliance::Full(c) => {
            for (k, row) in c.chunks_exact_mut(rows).enumerate() {
                for (l, c) in row.iter_mut().enumerate() {
                    *c += relief(k, l);
                }
            }
        }
        // Teeth are alike: rows of any tooth, columns of tooth 0.
        FlankCompliance::Cyclic {
            per_tooth, blocks, ..
        } => {
            let m = *per_tooth;
            for (i, c) in blocks.iter_mut().enumerate() {
                *c += relief(i / m, i % m);
            }
        }
        FlankCompliance::Deflated(_) => {
            unreachable!("nothing is taken from a compliance before it is mounted")
        }
    }
}
