//! Search for modes of one harmonic, which can be continued.

use super::{Sector, SharedAnalysis};
use crate::modes::lanczos::{Lanczos, Target, is_small};
use crate::modes::{Modes, ModesError, Options, Symmetric, default_shift, dense};
use crate::solve::{Cholesky, Scalar, Symbolic, negative_eigenvalues};
use faer::{Mat, Par, c64};
use std::sync::Arc;

/// Number of vectors per step.
const BLOCK: usize = 4;

/// Search for modes of one harmonic.
pub(super) struct Harmonic {
    /// Modes of the body per mode of the harmonic.
    weight: usize,
    search: Search,
    /// Squares of the computed angular frequencies, ascending.
    found: Vec<f64>,
}

enum Search {
    Real(Box<State<f64>>),
    Complex(Box<State<c64>>),
    /// None of its modes is needed; the result of the search so far.
    GivenUp(Box<Modes<c64>>),
}

impl Harmonic {
    /// Assembles a harmonic of which about `guess` modes are needed; `shared` is the analysis of those without hub
    /// motions.
    pub fn new(
        sector: &Sector,
        harmonic: u32,
        guess: usize,
        shared: &SharedAnalysis,
        options: &Options,
    ) -> Result<Self, ModesError> {
        let single = harmonic == 0 || 2 * harmonic == sector.sectors();
        let search = if single {
            Search::Real(Box::new(State::new(
                sector, harmonic, guess, shared, options,
            )?))
        } else {
            Search::Complex(Box::new(State::new(
                sector, harmonic, guess, shared, options,
            )?))
        };
        Ok(Self {
            weight: if single { 1 } else { 2 },
            search,
            found: Vec::new(),
        })
    }

    /// Modes of the body per mode of this harmonic.
    pub fn weight(&self) -> usize {
        self.weight
    }

    /// Returns the squares of the computed angular frequencies, ascending.
    pub fn found(&self) -> &[f64] {
        &self.found
    }

    /// Computes the lowest modes, or all up to a bound and the next one unless that has been done; `keep` stores the
    /// factor.
    pub fn find(&mut self, target: Target, keep: bool) -> Result<(), ModesError> {
        if let (Target::Above(omega2), Some(last)) = (target, self.found.last())
            && *last > omega2
        {
            return Ok(());
        }
        self.found = match &mut self.search {
            Search::Real(s) => s.find(target, keep)?,
            Search::Complex(s) => s.find(target, keep)?,
            // The lowest of its modes is above every later bound.
            Search::GivenUp(_) => return Ok(()),
        };
        Ok(())
    }

    /// Gives up matrices and basis where all modes are above a bound, which later bounds never exceed.
    pub fn give_up_above(
        &mut self,
        sector: &Sector,
        harmonic: u32,
        omega2: f64,
        verify: bool,
    ) -> Result<(), ModesError> {
        let above = self.found.first().is_some_and(|lowest| *lowest > omega2);
        if above && !matches!(self.search, Search::GivenUp(_)) {
            let none = self.finish(sector, harmonic, omega2, verify)?;
            self.search = Search::GivenUp(Box::new(none));
        }
        Ok(())
    }

    /// Shapes of the modes up to `omega2` over the sector's nodes, orthonormal in the mass of the whole body.
    pub fn finish(
        &self,
        sector: &Sector,
        harmonic: u32,
        omega2: f64,
        verify: bool,
    ) -> Result<Modes<c64>, ModesError> {
        let count = self.found.partition_point(|w| *w <= omega2);
        // Halfway to the next one, if it is known.
        let bound = (self.found.get(count)).map(|next| match count {
            0 => next - 0.5 * next.abs(),
            _ => 0.5 * (self.found[count - 1] + next),
        });
        let bound = bound.filter(|_| verify);
        let scale = (self.weight as f64 / f64::from(sector.sectors())).sqrt();
        match &self.search {
            Search::Real(s) => s.finish(sector, harmonic, count, bound, scale),
            Search::Complex(s) => s.finish(sector, harmonic, count, bound, scale),
            Search::GivenUp(none) => Ok((**none).clone()),
        }
    }
}

/// Matrices and iteration of a harmonic.
struct State<T: Scalar> {
    stiffness: Symmetric<T>,
    mass: Arc<Symmetric<T>>,
    symbolic: SharedAnalysis,
    shift: f64,
    factor: Option<Cholesky<T>>,
    engine: Engine<T>,
}

/// Factor of the shifted stiffness.
fn factor<T: Scalar>(
    stiffness: &Symmetric<T>,
    shift: f64,
    mass: &Symmetric<T>,
    symbolic: &SharedAnalysis,
) -> Result<Cholesky<T>, ModesError> {
    let shifted = stiffness.minus(shift, mass);
    let factor = Cholesky::with_symbolic(shifted.as_ref(), symbolic.clone(), Some(Par::Seq))?;
    Ok(factor)
}

enum Engine<T: Scalar> {
    /// All modes of a small problem.
    Dense(Modes<T>),
    Iteration(Lanczos<T>),
}

impl<T: Scalar> State<T> {
    fn new(
        sector: &Sector,
        harmonic: u32,
        guess: usize,
        shared: &SharedAnalysis,
        options: &Options,
    ) -> Result<Self, ModesError> {
        let pair = sector.matrices::<T>(harmonic);
        let stiffness = Symmetric::new(pair.stiffness.as_ref())?;
        let mass = Arc::new(Symmetric::new(pair.mass.as_ref())?);
        let n = mass.size();
        let shift = options
            .shift
            .unwrap_or_else(|| default_shift(&stiffness, &mass));
        let symbolic = if sector.hub_coordinates(harmonic) == 0 {
            shared.clone()
        } else {
            Arc::new(Symbolic::new(pair.stiffness.symbolic())?)
        };
        let block = options.block.unwrap_or(BLOCK).max(1);
        let engine = if is_small(n, guess, block) {
            Engine::Dense(dense::lowest(&stiffness, &mass, n, shift)?)
        } else {
            Engine::Iteration(Lanczos::new(mass.clone(), shift, block))
        };
        Ok(Self {
            stiffness,
            mass,
            symbolic,
            shift,
            factor: None,
            engine,
        })
    }

    fn find(&mut self, target: Target, keep: bool) -> Result<Vec<f64>, ModesError> {
        let iteration = match &mut self.engine {
            Engine::Dense(all) => return Ok(all.omega2.clone()),
            Engine::Iteration(iteration) => iteration,
        };
        let factor = match self.factor.take() {
            Some(factor) => factor,
            None => {
                let factor = factor(&self.stiffness, self.shift, &self.mass, &self.symbolic)?;
                iteration.report.factorisations += 1;
                iteration.report.factor_bytes = factor.bytes();
                factor
            }
        };
        iteration.run(&factor, target)?;
        if keep {
            self.factor = Some(factor);
        }
        iteration.found()
    }

    fn finish(
        &self,
        sector: &Sector,
        harmonic: u32,
        count: usize,
        bound: Option<f64>,
        scale: f64,
    ) -> Result<Modes<c64>, ModesError> {
        let mut modes = match &self.engine {
            Engine::Dense(all) => Modes {
                omega2: all.omega2[..count].to_vec(),
                vectors: all.vectors.subcols(0, count).to_owned(),
                residuals: all.residuals[..count].to_vec(),
                report: all.report,
            },
            Engine::Iteration(iteration) => match &self.factor {
                Some(factor) => iteration.modes(factor, &self.stiffness, count)?,
                None => {
                    let factor = factor(&self.stiffness, self.shift, &self.mass, &self.symbolic)?;
                    let mut modes = iteration.modes(&factor, &self.stiffness, count)?;
                    modes.report.factorisations += 1;
                    modes
                }
            },
        };
        if let (Some(bound), Engine::Iteration(_)) = (bound, &self.engine) {
            let shifted = self.stiffness.minus(bound, &self.mass);
            let counted = negative_eigenvalues(shifted.as_ref(), &self.symbolic)?;
            if counted != count {
                return Err(ModesError::Missed {
                    counted,
                    found: count,
                    frequency: bound.max(0.0).sqrt() / std::f64::consts::TAU,
                });
            }
            modes.report.verified = counted;
            modes.report.factorisations += 1;
        }
        let mut shapes = Mat::zeros(sector.displacements(), count);
        let mut reduced = Vec::with_capacity(self.mass.size());
        for j in 0..count {
            reduced.clear();
            reduced.extend(modes.vectors.col(j).iter().copied());
            if let Some(full) = shapes.col_mut(j).try_as_col_major_mut() {
                sector.expand(harmonic, &reduced, scale, full.as_slice_mut());
            }
        }
        Ok(Modes {
            omega2: modes.omega2,
            vectors: shapes,
            residuals: modes.residuals,
            report: modes.report,
        })
    }
}
