//! Estimate of the accuracy of a selection of modes, before any scene is run: a model impact.
//!
//! The gear hits its mirror image, which is to say a wall, with one row of flank nodes (one node, where contact does
//! not lie evenly over the width), along the normal:
//!
//! ```text
//! m y'' = -F,   q_i'' + omega_i^2 q_i = -b_i F,   y + sum_i b_i q_i = (R + A / 20) F   while F > 0
//! ```
//!
//! over the kept modes, with `m = J / effective base radius^2` (a fixed gear is treated as free), the static
//! compliance `A` of the whole mesh there, and the residual compliance `R`; a twentieth of `A` represents the contact
//! law. The reference keeps every mode of the basis. The estimate is the relative L2 difference of the force
//! histories, root mean square over rows of a left and a right flank. It does not depend on the speed: until contact
//! ends the system is linear.

use super::choose::{Choice, Family, ranked};
use super::{Basis, ReductionError};
use gearbench_models::geometry::Side;

/// Rows of a flank that are hit.
const ROWS: usize = 5;
/// Compliance of the contact law relative to the static one of the mesh.
const LAW: f64 = 0.05;
/// Steps per radian of the fastest motion of the contact.
const STEPS_PER_RADIAN: f64 = 5.0;
/// Simulated time over the half period of the static compliance.
const HALF_PERIODS: f64 = 1.5;
/// Places in the force history that are compared.
const SAMPLES: usize = 200;

/// A place that is hit, with the force history of all modes.
struct Probe {
    /// Shape of each mode, averaged over the nodes.
    shapes: Vec<f64>,
    /// Static compliance of the whole mesh [m/N].
    compliance: f64,
    reference: Vec<f64>,
}

/// The model impacts of a basis.
pub struct Impacts<'a> {
    basis: &'a Basis,
    /// Mass of the gear on its line of action [kg].
    mass: f64,
    probes: Vec<Probe>,
}

impl<'a> Impacts<'a> {
    /// Prepares the impacts of a gear; `effective_radius` is the base radius [m], or `cos(alpha)` for a rack.
    pub fn new(basis: &'a Basis, effective_radius: f64, even_over_width: bool) -> Self {
        let mut impacts = Impacts {
            basis,
            mass: basis.inertia / (effective_radius * effective_radius),
            probes: Vec::new(),
        };
        let all: Vec<usize> = (0..basis.omega.len()).collect();
        let grids = basis.flanks.grids();
        for grid in Side::BOTH
            .iter()
            .filter_map(|side| grids.iter().find(|g| g.side == *side))
        {
            let rows = ROWS.min(grid.rows);
            for i in 0..rows {
                // In the middle of equal parts of the flank.
                let row = (2 * i + 1) * grid.rows / (2 * rows);
                let of_row = &grid.nodes[row * grid.columns..][..grid.columns];
                let nodes = if even_over_width {
                    of_row
                } else {
                    &of_row[grid.columns / 2..][..1]
                };
                impacts.probes.push(Probe::new(basis, nodes));
            }
        }
        for i in 0..impacts.probes.len() {
            impacts.probes[i].reference = impacts.force(&impacts.probes[i], &all);
        }
        impacts
    }

    /// Estimated relative L2 error of a contact-force history with these modes and the static compliance of all
    /// others.
    pub fn error(&self, kept: &[usize]) -> f64 {
        let mut sum = 0.0;
        for probe in &self.probes {
            let force = self.force(probe, kept);
            let squares = |x: f64| x * x;
            let norm: f64 = probe.reference.iter().copied().map(squares).sum();
            let miss: f64 = (force.iter().zip(&probe.reference))
                .map(|(a, b)| squares(a - b))
                .sum();
            sum += miss / norm;
        }
        (sum / self.probes.len() as f64).sqrt()
    }

    /// Returns the smallest selection in the ranking whose estimate meets a target.
    pub fn fewest(&self, choice: &Choice, target: f64) -> Result<Vec<usize>, ReductionError> {
        let families: Vec<Family> = ranked(self.basis, choice);
        let first = |count: usize| -> Vec<usize> {
            let mut kept: Vec<usize> = (families[..count].iter())
                .flat_map(|f| f.modes.clone())
                .collect();
            kept.sort_unstable();
            kept
        };
        // As many families as there is room for.
        let mut room = choice.count;
        let most = families
            .iter()
            .take_while(|f| {
                let fits = f.modes.len() <= room;
                room = room.saturating_sub(f.modes.len());
                fits
            })
            .count();
        let all = first(most);
        let best = self.error(&all);
        if best.is_nan() || best > target {
            return Err(ReductionError::Mismatch(format!(
                "all {} modes up to the limits of number and step leave an estimated error of {best:.2e}; allow \
                 more modes, a shorter step or a larger error",
                all.len()
            )));
        }
        let (mut too_few, mut enough) = (None, most);
        while too_few.map_or(0, |f| f + 1) < enough {
            let middle = (too_few.map_or(0, |f: usize| f + 1) + enough) / 2;
            if self.error(&first(middle)) <= target {
                enough = middle;
            } else {
                too_few = Some(middle);
            }
        }
        Ok(first(enough))
    }

    /// Force history of an impact at unit speed with some modes.
    fn force(&self, probe: &Probe, kept: &[usize]) -> Vec<f64> {
        let omega = &self.basis.omega;
        let static_part = |i: usize| (probe.shapes[i] / omega[i]).powi(2);
        let rest = probe.compliance - kept.iter().map(|&i| static_part(i)).sum::<f64>();
        let contact_compliance = rest + LAW * probe.compliance;

        let shapes: Vec<f64> = kept.iter().map(|&i| probe.shapes[i]).collect();
        let light = 1.0 / self.mass + shapes.iter().map(|b| b * b).sum::<f64>();
        let half_period =
            std::f64::consts::PI * (self.mass * (1.0 + LAW) * probe.compliance).sqrt();
        let end = HALF_PERIODS * half_period;
        let per_sample =
            ((end / SAMPLES as f64) * STEPS_PER_RADIAN * (light / contact_compliance).sqrt())
                .ceil();
        let h = end / SAMPLES as f64 / per_sample;
        let turn: Vec<[f64; 3]> = (kept.iter())
            .map(|&i| {
                let (s, c) = (omega[i] * h).sin_cos();
                [c, s / omega[i], -s * omega[i]]
            })
            .collect();
        let (mut q, mut v) = (vec![0.0; kept.len()], vec![0.0; kept.len()]);
        // Displacement of the rigid gear towards the wall, and its rate.
        let (mut approach, mut rate) = (0.0, 1.0);
        let mut f = 0.0_f64;
        let mut history = Vec::with_capacity(SAMPLES);
        for _ in 0..SAMPLES {
            for _ in 0..per_sample as usize {
                // Leapfrog integration: two successive half impulses at one position are combined.
                rate -= h * f / self.mass;
                approach += h * rate;
                let mut outward = 0.0;
                for (((q, v), b), [c, s, d]) in q.iter_mut().zip(&mut v).zip(&shapes).zip(&turn) {
                    let kicked = *v - h * f * b;
                    (*q, *v) = (c * *q + s * kicked, d * *q + c * kicked);
                    outward += b * *q;
                }
                f = ((approach + outward) / contact_compliance).max(0.0);
            }
            history.push(f);
        }
        history
    }
}

impl Probe {
    fn new(basis: &Basis, nodes: &[u32]) -> Self {
        let modes = basis.omega.len();
        let part = 1.0 / nodes.len() as f64;
        let mut shapes = vec![0.0; modes];
        for &node in nodes {
            for (s, b) in shapes.iter_mut().zip(basis.shapes_at(node)) {
                *s += part * b;
            }
        }
        let pairs = nodes
            .iter()
            .flat_map(|i| nodes.iter().map(move |j| (*i, *j)));
        let compliance = pairs
            .map(|(i, j)| part * part * basis.compliance_between(i, j))
            .sum();
        Probe {
            shapes,
            compliance,
            reference: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests;
