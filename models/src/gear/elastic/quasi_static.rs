//! Quasi-static correction: the compliance that a method with impulses leaves out of the modes is added to the
//! residual compliance.
//!
//! Under a method with impulses on the modes every `h`, a sustained force moves mode `i` by `lag_i` less than
//! `1/omega_i^2` ([`ModalSplit::prepare`](gearbench_integrators::ModalSplit::prepare)). The compliance of the flank
//! nodes is increased by the difference,
//!
//! ```text
//! R_h = R + B diag(quasi_static) B^T + l l^T lag_0 / J
//! ```
//!
//! with the effective base radii `l` of the nodes about a free hub: the deflection under load is that of the model
//! whatever the step. It is of the size of `h^2 / 12` over the mass that follows at once, and as local as that mass:
//! nodes more than [`NEAR`] teeth apart are left as they are.

use super::body::Elastic;
use super::reduced::FlankCompliance;
use crate::cholesky::dot;
use crate::geometry::along_profile;

/// Distance in teeth up to which the correction between nodes is included.
const NEAR: usize = 2;

impl Elastic {
    pub(super) fn correct_by(&self, missing: Option<&[f64]>) {
        let mut correction = self.correction.borrow_mut();
        let Some(missing) = missing.filter(|l| l.iter().any(|x| *x != 0.0)) else {
            correction.on = false;
            return;
        };
        let Some(residual) = &self.data.residual else {
            return;
        };
        correction.on = true;
        if correction.missing == missing {
            return;
        }
        let (modes, of_flanks) = (self.data.modes(), self.data.rows());
        let (frame, of_modes) = missing.split_at(self.own);
        // A bearing is slow: nothing is left out of its directions.
        let frame = &frame[..usize::from(self.turns())];
        // Scaled so that the product of two rows is the compliance of the pair of nodes.
        let width = modes + frame.len();
        let mut rows = Vec::with_capacity(of_flanks * width);
        for row in 0..of_flanks {
            for quasi_static in frame {
                let effective_radius = self.own_radius(row);
                rows.push(effective_radius * (quasi_static / self.hub.inertia).sqrt());
            }
            let shapes = &self.data.shapes[row * modes..][..modes];
            rows.extend(
                shapes
                    .iter()
                    .zip(of_modes)
                    .map(|(b, quasi_static)| b * quasi_static.sqrt()),
            );
        }
        let row = |row: usize| &rows[row * width..][..width];
        let mut flanks = residual.flanks.clone();
        match &mut flanks {
            FlankCompliance::Cyclic {
                teeth,
                per_tooth: m,
                blocks,
            } => {
                for apart in 0..*teeth {
                    if apart.min(*teeth - apart) > NEAR {
                        continue;
                    }
                    for i in 0..*m {
                        let line = &mut blocks[(apart * *m + i) * *m..][..*m];
                        for (j, c) in line.iter_mut().enumerate() {
                            *c += dot(row(apart * *m + i), row(j));
                        }
                    }
                }
            }
            FlankCompliance::Full(c) => {
                let per_node = self.data.per_node();
                let mut tooth = vec![0; of_flanks];
                for grid in self.data.flanks.grids() {
                    for &node in &grid.nodes {
                        tooth[node as usize * per_node..][..per_node].fill(grid.tooth as usize);
                    }
                }
                let teeth = 1 + tooth.iter().copied().max().unwrap_or(0);
                for i in 0..of_flanks {
                    for j in 0..=i {
                        let apart = tooth[i].abs_diff(tooth[j]);
                        if apart.min(teeth - apart) <= NEAR {
                            let given = dot(row(i), row(j));
                            c[i * of_flanks + j] += given;
                            if i != j {
                                c[j * of_flanks + i] += given;
                            }
                        }
                    }
                }
            }
            FlankCompliance::Deflated(c) => c.give(&rows, width),
        }
        correction.flanks = Some(flanks);
        correction.missing.clear();
        correction.missing.extend_from_slice(missing);
    }

    /// Returns the displacement of a row of a flank node per unit rotation (displacement) of the frame.
    fn own_radius(&self, row: usize) -> f64 {
        let node = row / self.data.per_node();
        let x = &self.positions[node];
        let outward = self.data.normals[node];
        let n = if row.is_multiple_of(self.data.per_node()) {
            outward
        } else {
            along_profile(&outward)
        };
        match self.hub.slide {
            None => x.x * n.y - x.y * n.x,
            // A rack slides along its own y.
            Some(_) => n.y,
        }
    }
}
