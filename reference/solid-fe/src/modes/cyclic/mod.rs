//! Modes of a body of equal sectors about z from one of them, such as those of a gear from one tooth.
//!
//! A body of z equal sectors moves in harmonics n = 0 .. z/2: in the frame turned with sector k its displacement is
//! `u_k = Re(u exp(i k mu))`, `mu = 2 pi n / z`. On the cuts of the sector that means
//! `u_high = exp(i mu) R u_low` with the rotation R by one pitch, which leaves one Hermitian problem of the
//! sector's size per harmonic (D. L. Thomas, *Int. J. Numer. Meth. Eng.* 14, 1979, 81). Harmonics 0 and z/2 are
//! real; every mode of the others stands for two modes of the body, `Re` and `Im` of the same shape.
//!
//! The bore is held by the hub. Motions of the hub that keep the symmetry enter where they belong: turning and
//! sliding along z in n = 0; sliding across, and tilting, as a pair of directions in n = 1.
//!
//! All harmonics without hub motions share one analysis; threads take them in turn. A harmonic is searched
//! until its next mode lies above the last mode wanted of the whole body.

mod harmonic;
mod sector;
mod statics;
#[cfg(test)]
mod tests;

pub use sector::{Sector, SectorMesh};
pub use statics::{Column, InertialResponses, StaticResponses};

use super::{ModesError, Options, Report, Target};
use crate::Material;
use crate::assembly::tie::HubMotion;
use crate::limits;
use crate::limits::carried;
use crate::solve::Symbolic;
use faer::{Mat, c64};
use harmonic::Harmonic;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Part of a pair of modes, or a single mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Single mode of harmonics 0 and z/2.
    Single,
    /// `Re(u exp(i k mu))`.
    Cosine,
    /// `Im(u exp(i k mu))`.
    Sine,
}

/// A mode of the whole body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CyclicMode {
    /// Square of the angular frequency [rad²/s²].
    pub omega2: f64,
    /// Harmonic, 0 to z/2: number of nodal diameters, up to aliases.
    pub harmonic: u32,
    /// Which of a pair.
    pub part: Part,
    /// Column among the shapes of the harmonic.
    pub column: usize,
    /// `|K u - omega^2 M u| / |K u|` of the harmonic's problem.
    pub residual: f64,
}

/// Lowest modes of a whole body, pairs kept whole, orthonormal in the mass of the whole body.
#[derive(Clone, Debug)]
pub struct CyclicModes {
    /// Number of sectors of the body.
    pub sectors: u32,
    /// Unknowns of the whole body, hub motions apart.
    pub unknowns: usize,
    /// Modes, ascending; the cosine mode of a pair before the sine mode.
    pub modes: Vec<CyclicMode>,
    /// Complex shapes per harmonic, three displacements per node of the sector x modes of the harmonic [1/sqrt(kg)].
    pub shapes: Vec<Mat<c64>>,
    /// Work of each harmonic.
    pub reports: Vec<Report>,
}

impl CyclicModes {
    /// Displacements of the sector number `sector` in a mode, in the frame of the body: entry
    /// `3 node + axis` belongs to the sector's node turned by `sector` pitches [1/sqrt(kg)].
    ///
    /// # Panics
    /// If there is no such mode or `u` has another length than three times the nodes of the sector.
    pub fn expand(&self, mode: usize, sector: u32, u: &mut [f64]) {
        let mode = &self.modes[mode];
        let shape = self.shapes[mode.harmonic as usize].col(mode.column);
        assert_eq!(
            u.len(),
            shape.nrows(),
            "three displacements per node of the sector"
        );
        let pitch = std::f64::consts::TAU / f64::from(self.sectors);
        // Whole turns taken out first: exact phases for all sectors.
        let turns = (u64::from(sector) * u64::from(mode.harmonic)) % u64::from(self.sectors);
        let (sin, cos) = (pitch * turns as f64).sin_cos();
        let (turn_sin, turn_cos) = (pitch * f64::from(sector)).sin_cos();
        for (node, u) in u.chunks_exact_mut(3).enumerate() {
            let part = |axis: usize| {
                let c = shape[3 * node + axis];
                match mode.part {
                    Part::Single | Part::Cosine => c.re * cos - c.im * sin,
                    Part::Sine => c.re * sin + c.im * cos,
                }
            };
            let (x, y) = (part(0), part(1));
            u[0] = turn_cos * x - turn_sin * y;
            u[1] = turn_sin * x + turn_cos * y;
            u[2] = part(2);
        }
    }

    /// Returns the frequencies [Hz].
    pub fn frequencies(&self) -> Vec<f64> {
        let to_hz = |m: &CyclicMode| m.omega2.max(0.0).sqrt() / std::f64::consts::TAU;
        self.modes.iter().map(to_hz).collect()
    }
}

/// Free motions of the hub.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hub {
    /// Free motions of the hub; the others are fixed.
    pub motions: Vec<HubMotion>,
    /// Inertia that the hub adds, one value per motion [kg] or [kg m²].
    pub added_inertia: Vec<f64>,
}

impl Hub {
    /// Held in every direction.
    pub fn fixed() -> Self {
        Self::default()
    }

    /// Free to turn about z, with added inertia [kg m²].
    pub fn turning(added_inertia: f64) -> Self {
        Self {
            motions: vec![HubMotion::Turn],
            added_inertia: vec![added_inertia],
        }
    }
}

/// Factors are kept between rounds while all together stay below this [bytes].
const KEEP_BELOW: usize = 800_000_000;

/// Number of harmonics that are searched before those without a needed mode are released.
const AT_A_TIME: usize = 128;

/// Memory of an unknown of the sector in a mode: the complex vector, and its basis [bytes].
const VECTOR_BYTES: f64 = 48.0;

/// Computes the lowest `count` modes of the body with a given sector (one more if the last is half of a pair).
pub fn lowest(
    sector: &SectorMesh<'_>,
    material: &Material,
    hub: &Hub,
    count: usize,
    options: &Options,
) -> Result<CyclicModes, ModesError> {
    Sector::new(sector, material, hub)?.find(Target::Count(count), options)
}

impl Sector {
    /// Computes the lowest modes of the whole body (one more if the last is half of a pair), or all up to a bound.
    pub fn find(&self, target: Target, options: &Options) -> Result<CyclicModes, ModesError> {
        let sectors = self.sectors() as usize;
        let unknowns = self.unknowns() * sectors;
        if let Target::Count(wanted) = target
            && wanted > unknowns
        {
            return Err(ModesError::TooMany { wanted, unknowns });
        }
        if let Target::Count(wanted) = target {
            let what = format!(
                "{wanted} modes of a sector with {} unknowns",
                self.unknowns()
            );
            let bytes = VECTOR_BYTES * wanted as f64 * self.unknowns() as f64;
            limits::check(what, bytes, "ask for fewer modes, or use fewer elements")?;
        }
        let symbolic = Arc::new(self.symbolic()?);
        let harmonics = sectors / 2 + 1;
        let keep = 16 * symbolic.stored() * harmonics < KEEP_BELOW;
        // On average every harmonic has this many; those with more are searched further in the second round.
        let count = match target {
            Target::Count(count) => count,
            Target::Above(_) => sectors,
        };
        let guess = (count.div_ceil(sectors) + 1).min(self.unknowns());
        let mut states: Vec<Harmonic> = Vec::new();
        // Low harmonics have the low modes: of a body with very many sectors most harmonics have none of those wanted, and
        // their matrices and bases are given up before the next are made.
        while states.len() < harmonics {
            let first = states.len();
            let made = self.each(first..harmonics.min(first + AT_A_TIME), |n| {
                let mut state = Harmonic::new(self, n as u32, 2 * guess, &symbolic, options)?;
                state.find(Target::Count(guess), keep)?;
                Ok(state)
            })?;
            states.extend(made);
            if harmonics > AT_A_TIME {
                let bound = match target {
                    Target::Count(_) => last_wanted(&states, count, f64::INFINITY),
                    Target::Above(omega2) => omega2,
                };
                let numbered = states.par_iter_mut().enumerate();
                let given_up: Vec<_> = numbered
                    .map(carried(|(n, state): (usize, &mut Harmonic)| {
                        state.give_up_above(self, n as u32, bound, options.verify)
                    }))
                    .collect();
                given_up.into_iter().collect::<Result<(), _>>()?;
            }
        }
        // The last mode wanted, as far as known: an upper bound of the true one.
        let bound = match target {
            Target::Count(_) => last_wanted(&states, count, f64::INFINITY),
            Target::Above(omega2) => omega2,
        };
        let further = states.par_iter_mut();
        let further: Vec<_> = further
            .map(carried(|state: &mut Harmonic| {
                state.find(Target::Above(bound), keep)
            }))
            .collect();
        further.into_iter().collect::<Result<(), _>>()?;
        let bound = match target {
            Target::Count(_) => last_wanted(&states, count, bound),
            Target::Above(omega2) => omega2,
        };
        let finished = self.each(0..harmonics, |n| {
            states[n].finish(self, n as u32, bound, options.verify)
        })?;
        let mut modes = Vec::new();
        let (mut shapes, mut reports) = (Vec::new(), Vec::new());
        for (n, found) in finished.into_iter().enumerate() {
            let parts: &[Part] = if states[n].weight() == 1 {
                &[Part::Single]
            } else {
                &[Part::Cosine, Part::Sine]
            };
            for (column, &omega2) in found.omega2.iter().enumerate() {
                modes.extend(parts.iter().map(|&part| CyclicMode {
                    omega2,
                    harmonic: n as u32,
                    part,
                    column,
                    residual: found.residuals[column],
                }));
            }
            reports.push(found.report);
            shapes.push(found.vectors);
        }
        modes.sort_by(|a, b| a.omega2.total_cmp(&b.omega2));
        Ok(CyclicModes {
            sectors: self.sectors(),
            unknowns,
            modes,
            shapes,
            reports,
        })
    }

    /// Runs a job for each harmonic, in parallel; the results, and the first error, are those of their order.
    fn each<S: Send>(
        &self,
        harmonics: Range<usize>,
        job: impl Fn(usize) -> Result<S, ModesError> + Send + Sync,
    ) -> Result<Vec<S>, ModesError> {
        let done: Vec<_> = harmonics.into_par_iter().map(carried(job)).collect();
        done.into_iter().collect()
    }
}

/// Returns the `count`-th eigenvalue among the computed ones, each with its weight; `otherwise` if there are fewer.
fn last_wanted(states: &[Harmonic], count: usize, otherwise: f64) -> f64 {
    let mut all: Vec<f64> = (states.iter())
        .flat_map(|s| {
            s.found()
                .iter()
                .flat_map(|w| std::iter::repeat_n(*w, s.weight()))
        })
        .collect();
    if count == 0 {
        return f64::NEG_INFINITY;
    }
    if all.len() < count {
        return otherwise;
    }
    let (_, last, _) = all.select_nth_unstable_by(count - 1, f64::total_cmp);
    *last
}

/// Analysis shared by the harmonics.
type SharedAnalysis = Arc<Symbolic>;
