//! Selection of the modes of a model and of their damping (pass 2).
//!
//! Modes of a family are kept or truncated together: the two of a pair of equal frequency, without which equal teeth
//! would have different compliances. Larger families are not needed for that; the ranking of pairs by the mean over
//! all teeth keeps similar shapes of all harmonics together. Families are ranked by frequency, lowest first, or by
//! flank compliance, largest first: the mean over the family of
//!
//! ```text
//! c_i = sum_k A_k b_ki^2 / (omega_i^2 sum_k A_k)
//! ```
//!
//! with the reference areas `A_k` of the flank nodes. Where contact lies evenly over the face width, on spur
//! toothing without crowning, `b` is first averaged over each row of nodes: shapes that are odd over the width then
//! do not count. On helical gears it is averaged along the lines of
//! contact.
//!
//! For the teeth that touch in an impact modes can be made in place of chosen ones ([`made_for`]).

mod lines;
mod teeth;

pub use teeth::{FittedModes, in_mesh, made_for};

use super::{Basis, KeptModes, ReductionError, without_modes};
use gearbench_models::contact::points::reference_areas;
use gearbench_models::gear::elastic::reduced::{OutOfPlaneShapes, Reduced};
use gearbench_models::spec::PointRule;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::sync::Arc;

/// Criterion by which modes are ranked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Criterion {
    /// Rank by frequency, lowest first.
    Frequency,
    /// Largest flank compliance first.
    FlankCompliance,
    /// Made for the teeth in mesh at the start, for gears that turn by less than half a pitch ([`made_for`]).
    TeethInMesh,
}

impl Criterion {
    /// Its name in scenes and records.
    pub fn id(self) -> &'static str {
        match self {
            Criterion::Frequency => "frequency",
            Criterion::FlankCompliance => "flank-compliance",
            Criterion::TeethInMesh => "teeth-in-mesh",
        }
    }
}

/// Which modes to keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Criterion of the ranking.
    pub by: Criterion,
    /// At most so many.
    pub count: usize,
    /// Among so many of the lowest.
    pub candidates: usize,
    /// None above this angular frequency [rad/s]; see [`highest_for_step`].
    pub highest: f64,
    /// Time for which modes made for the teeth in mesh have to hold [s].
    pub time: f64,
    /// Contact lies evenly over the face width.
    pub even_over_width: bool,
}

/// Fraction of the Nyquist frequency of a step up to which modes are kept: impulses at steps `h` drive a mode near
/// `omega h = pi` into resonance.
const PART_OF_NYQUIST: f64 = 0.64;

/// Highest angular frequency [rad/s] that a step of `h` [s] carries.
pub fn highest_for_step(h: f64) -> f64 {
    PART_OF_NYQUIST * PI / h
}

/// Mean compliance [m/N] that each mode gives to the flanks, `c_i`.
pub fn flank_compliances(basis: &Basis, even_over_width: bool) -> Vec<f64> {
    let (mut sums, total) = match lines::means(basis) {
        Some(along_lines) if !even_over_width => along_lines,
        _ => means(basis, even_over_width),
    };
    for (s, w) in sums.iter_mut().zip(&basis.omega) {
        *s /= total * w * w;
    }
    sums
}

/// Squares of the shapes at the nodes, or of their means over rows, times areas, and the sum of these.
fn means(basis: &Basis, even_over_width: bool) -> (Vec<f64>, f64) {
    let modes = basis.omega.len();
    let mut sums = vec![0.0; modes];
    let mut total = 0.0;
    let mut mean = vec![0.0; modes];
    for (index, grid) in basis.flanks.grids().iter().enumerate() {
        let areas = reference_areas(&basis.flanks, index, PointRule::Nodes);
        // One node at a time, or a row of them.
        let together = if even_over_width { grid.columns } else { 1 };
        for (nodes, areas) in grid.nodes.chunks(together).zip(areas.chunks(together)) {
            let area: f64 = areas.iter().sum();
            mean.fill(0.0);
            for (&node, a) in nodes.iter().zip(areas) {
                let shapes = basis.shapes_at(node);
                for (m, b) in mean.iter_mut().zip(shapes) {
                    *m += a / area * b;
                }
            }
            for (s, m) in sums.iter_mut().zip(&mean) {
                *s += area * m * m;
            }
            total += area;
        }
    }
    (sums, total)
}

/// Modes that are kept or truncated together.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Modes of the family.
    pub modes: std::ops::Range<usize>,
    /// Rank, largest first: minus the frequency [rad/s], or the compliance per mode [m/N].
    pub rank: f64,
}

/// The families among the candidates of a choice, best first; its number of modes does not count here.
pub fn ranked(basis: &Basis, choice: &Choice) -> Vec<Family> {
    let compliances = match choice.by {
        Criterion::Frequency => Vec::new(),
        Criterion::FlankCompliance | Criterion::TeethInMesh => {
            flank_compliances(basis, choice.even_over_width)
        }
    };
    ranked_by(basis, choice, &compliances)
}

/// Ranks by the compliances of all modes, or, without any, by frequency.
fn ranked_by(basis: &Basis, choice: &Choice, compliances: &[f64]) -> Vec<Family> {
    let mut families = Vec::new();
    let mut first = 0;
    for same in basis.family.chunk_by(|a, b| a == b) {
        let modes = first..first + same.len();
        first = modes.end;
        let rank = match compliances {
            [] => -basis.omega[modes.start],
            _ => compliances[modes.clone()].iter().sum::<f64>() / same.len() as f64,
        };
        if modes.end <= choice.candidates && basis.omega[modes.end - 1] <= choice.highest {
            families.push(Family { modes, rank });
        }
    }
    families.sort_by(|a, b| b.rank.total_cmp(&a.rank));
    families
}

/// Part of the modes that are chosen for the hub, where it moves aside of its own motion.
const FOR_HUB: f64 = 0.25;

/// Returns the compliance of each mode at a hub in its out-of-plane directions, each direction relative to the sum
/// over all modes: a bearing depends on modes that a selection for the flanks alone would leave out. `None` for a hub
/// that only rotates.
fn hub_compliances(basis: &Basis) -> Option<Vec<f64>> {
    let lateral = basis.lateral.as_ref()?;
    let of = |d: usize| {
        let modes = lateral.hub.iter().zip(&basis.omega);
        modes.map(move |(phi, w)| (phi[d] / w).powi(2))
    };
    let mut sums = vec![0.0; basis.omega.len()];
    for d in 0..6 {
        let total: f64 = of(d).sum();
        if total > 0.0 {
            for (sum, c) in sums.iter_mut().zip(of(d)) {
                *sum += c / total;
            }
        }
    }
    Some(sums)
}

/// Returns the selected modes, ascending; for a hub with out-of-plane freedom a quarter of them are those that move it
/// most. A family that exceeds the limit is skipped in favour of smaller ones, except where all modes below some
/// frequency are requested.
pub fn choose(basis: &Basis, choice: &Choice) -> Vec<usize> {
    let mut kept = Vec::new();
    let by_frequency = choice.by == Criterion::Frequency;
    if let Some(of_hub) = hub_compliances(basis).filter(|_| !by_frequency) {
        let room = (FOR_HUB * choice.count.min(basis.omega.len()) as f64) as usize;
        for family in ranked_by(basis, choice, &of_hub) {
            if family.modes.len() <= room.saturating_sub(kept.len()) {
                kept.extend(family.modes);
            }
        }
    }
    for family in ranked(basis, choice) {
        if kept.contains(&family.modes.start) {
            continue;
        }
        if family.modes.len() <= choice.count.saturating_sub(kept.len()) {
            kept.extend(family.modes);
        } else if by_frequency {
            break;
        }
    }
    kept.sort_unstable();
    kept
}

/// Damping of the modes: a ratio for all, and Rayleigh's `C = alpha M + beta K`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModalDamping {
    /// Ratio of every mode.
    pub ratio: f64,
    /// Mass part [1/s].
    pub alpha: f64,
    /// Stiffness part [s].
    pub beta: f64,
}

impl ModalDamping {
    /// Ratio of a mode.
    pub fn at(&self, omega: f64) -> f64 {
        self.ratio + 0.5 * (self.alpha / omega + self.beta * omega)
    }
}

impl FittedModes {
    /// These modes as the elastic gear takes them, as [`reduced`].
    pub fn reduced(
        &self,
        damping: &ModalDamping,
        residual: bool,
    ) -> Result<Reduced, ReductionError> {
        let all: Vec<usize> = (0..self.basis.omega.len()).collect();
        with_kept(&self.basis, &all, damping, residual.then_some(&self.rows))
    }
}

/// The kept modes of a basis as the elastic gear takes them; `residual`: with the compliance of all others.
pub fn reduced(
    basis: &Basis,
    kept: &[usize],
    damping: &ModalDamping,
    residual: bool,
) -> Result<Reduced, ReductionError> {
    with_kept(basis, kept, damping, residual.then_some(&[]))
}

/// Returns the model of selected modes; with `residual`, the rows of the teeth for which modes were fitted, with the
/// residual compliance.
fn with_kept(
    basis: &Basis,
    kept: &[usize],
    damping: &ModalDamping,
    residual: Option<&[u32]>,
) -> Result<Reduced, ReductionError> {
    let modes = basis.omega.len();
    let pick = |x: &[f64]| -> Vec<f64> { kept.iter().map(|&i| x[i]).collect() };
    let omega = pick(&basis.omega);
    let ratios: Vec<f64> = omega.iter().map(|w| damping.at(*w)).collect();
    let rows = basis.directions();
    let mut shapes = Vec::with_capacity(rows * kept.len());
    for row in basis.shapes.chunks_exact(modes.max(1)).take(rows) {
        shapes.extend(kept.iter().map(|&i| row[i]));
    }
    let hub = pick(&basis.hub);
    let residual = if let Some(made_for) = residual {
        let kept = KeptModes {
            made_for,
            omega: &omega,
            shapes: &shapes,
            hub: &hub,
        };
        Some(without_modes(&basis.compliance, kept)?)
    } else {
        None
    };
    Ok(Reduced {
        flanks: basis.flanks.clone(),
        normals: basis.normals.clone(),
        along_profile: basis.along_profile,
        free: basis.free,
        inertia: basis.inertia,
        omega,
        damping: ratios,
        shapes,
        hub,
        participation: pick(&basis.participation),
        momentum: kept.iter().map(|&i| basis.momentum[i]).collect(),
        unbalance: basis.unbalance,
        residual,
        near_field: basis.near_field.clone(),
        integrals: basis.integrals.as_ref().map(|i| i.of_modes(kept)),
        lateral: basis.lateral_of(kept),
    })
}

impl Basis {
    /// Directions of all flank nodes.
    pub fn directions(&self) -> usize {
        self.normals.len() * self.per_node()
    }

    /// Returns the number of directions of a flank node: outwards, and along the profile where it is included.
    pub fn per_node(&self) -> usize {
        1 + usize::from(self.along_profile)
    }

    /// Outward shapes of all modes at a flank node [1/sqrt(kg)].
    pub fn shapes_at(&self, node: u32) -> &[f64] {
        let modes = self.omega.len();
        &self.shapes[node as usize * self.per_node() * modes..][..modes]
    }

    /// Inward displacement of a flank node by unit force into another [m/N].
    pub fn compliance_between(&self, i: u32, j: u32) -> f64 {
        let [i, j] = [i, j].map(|node| node * self.per_node() as u32);
        self.compliance.flanks.between(i, j, self.directions())
    }

    /// Returns the motion of a hub with out-of-plane freedom in some of its modes.
    fn lateral_of(&self, kept: &[usize]) -> Option<Arc<OutOfPlaneShapes>> {
        let lateral = self.lateral.as_ref()?;
        Some(Arc::new(OutOfPlaneShapes {
            hub: kept.iter().map(|&i| lateral.hub[i]).collect(),
            ..(**lateral).clone()
        }))
    }

    /// The basis with shapes within the span of its modes in place of them, of frequencies `omega`. `moving` and `span` have a
    /// row of as many for each mode: the part of a shape that has mass, and the whole displacement.
    pub(super) fn in_span(&self, moving: &[f64], span: &[f64], omega: Vec<f64>) -> Basis {
        let (modes, count) = (self.omega.len(), omega.len());
        let sums = |x: &[f64], v: &[f64]| -> Vec<f64> {
            let mut out = vec![0.0; count];
            for (x, row) in x.iter().zip(v.chunks_exact(count.max(1))) {
                out.iter_mut().zip(row).for_each(|(out, v)| *out += x * v);
            }
            out
        };
        let of_modes = |x: &[f64]| sums(x, span);
        let each = |x: &dyn Fn(usize) -> f64, v: &[f64]| -> Vec<f64> {
            sums(&(0..modes).map(x).collect::<Vec<_>>(), v)
        };
        let momentum = [0, 1].map(|axis| each(&|i| self.momentum[i][axis], moving));
        let rows = self.shapes.chunks_exact(modes.max(1));
        let lateral = self.lateral.as_ref().map(|lateral| {
            let hub = [0, 1, 2, 3, 4, 5].map(|d| each(&|i| lateral.hub[i][d], span));
            Arc::new(OutOfPlaneShapes {
                hub: (0..count)
                    .map(|k| [0, 1, 2, 3, 4, 5].map(|d| hub[d][k]))
                    .collect(),
                ..(**lateral).clone()
            })
        });
        Basis {
            family: (0..count as u32).collect(),
            shapes: rows.flat_map(of_modes).collect(),
            hub: of_modes(&self.hub),
            participation: sums(&self.participation, moving),
            momentum: (0..count)
                .map(|k| [momentum[0][k], momentum[1][k]])
                .collect(),
            integrals: (self.integrals.as_ref()).map(|i| Arc::new(i.in_span(moving, count))),
            lateral,
            omega,
            ..self.clone()
        }
    }

    /// The basis with some of its modes only, ascending; the compliance is that of the whole mesh as before.
    pub fn with_modes(&self, kept: &[usize]) -> Basis {
        let modes = self.omega.len();
        let pick = |x: &[f64]| kept.iter().map(|&i| x[i]).collect();
        let rows = self.shapes.chunks_exact(modes.max(1));
        Basis {
            omega: pick(&self.omega),
            family: kept.iter().map(|&i| self.family[i]).collect(),
            shapes: rows.flat_map(|row| kept.iter().map(|&i| row[i])).collect(),
            hub: pick(&self.hub),
            participation: pick(&self.participation),
            momentum: kept.iter().map(|&i| self.momentum[i]).collect(),
            integrals: (self.integrals.as_ref()).map(|i| Arc::new(i.of_modes(kept))),
            lateral: self.lateral_of(kept),
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests;
