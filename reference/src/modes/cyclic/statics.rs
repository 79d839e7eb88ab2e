//! Static responses of a gear, bore held, to forces on one tooth: one problem of a sector's size per harmonic.

use super::Sector;
use crate::modes::ModesError;
use crate::solve::{Cholesky, Scalar, Symbolic};
use crate::vector::{self, turned};
use faer::{Mat, Par, c64};
use gearbench_models::Vec3;
use std::sync::Arc;

/// Responses of all harmonics.
#[derive(Clone, Debug)]
pub(crate) struct StaticResponses {
    /// `C^T K_n^-1 C` per harmonic from 0 to z/2, row by row.
    pub compliance: Vec<Vec<c64>>,
    /// `C^T K_0^-1 M e`.
    pub inertial: Vec<f64>,
    /// `(M e)^T K_0^-1 M e` of one sector, free nodes only.
    pub hub: f64,
    /// `e^T M e` of one sector.
    pub inertia: f64,
}

/// A direction at a free node of the sector: `(place, direction)`.
pub(crate) type Column = (usize, Vec3);

fn dot<T: Scalar>((place, direction): &Column, x: faer::ColRef<'_, T>) -> c64 {
    let mut sum = c64::new(0.0, 0.0);
    for axis in 0..3 {
        let [re, im] = x[3 * place + axis].parts();
        sum += c64::new(direction[axis] * re, direction[axis] * im);
    }
    sum
}

impl Sector {
    /// Place of a node among the free ones; `None` if the hub holds it or it lies on the high cut.
    pub(crate) fn place_of(&self, node: u32) -> Option<usize> {
        match self.place.get(node as usize) {
            Some(&(place, false)) if place != super::sector::HELD => Some(place as usize),
            _ => None,
        }
    }

    /// Responses along some columns to unit forces along them on tooth 0, and to the motion `e` that is the same in
    /// every sector, three displacements per node of the sector.
    pub(crate) fn static_responses(
        &self,
        columns: &[Column],
        e: &[f64],
    ) -> Result<StaticResponses, ModesError> {
        let teeth = self.teeth();
        let harmonics = teeth / 2 + 1;
        let symbolic = Arc::new(self.symbolic()?);
        let compliance = self.each(harmonics as usize, |n| {
            let n = n as u32;
            if n == 0 || 2 * n == teeth {
                self.harmonic_compliance::<f64>(n, columns, &symbolic)
            } else {
                self.harmonic_compliance::<c64>(n, columns, &symbolic)
            }
        })?;
        let mut image = vec![0.0; e.len()];
        self.assembly.mass.apply(e, &mut image);
        let inertia = vector::dot(e, &image);
        // The high cut is the low cut of the next sector.
        let pitch = std::f64::consts::TAU / f64::from(teeth);
        let mut load = vec![0.0; self.unknowns()];
        for (&(place, high), f) in self.place.iter().zip(image.chunks_exact(3)) {
            if place == super::sector::HELD {
                continue;
            }
            let f = Vec3::from_column_slice(f);
            let f = if high { turned(f, -pitch) } else { f };
            for axis in 0..3 {
                load[3 * place as usize + axis] += f[axis];
            }
        }
        let mut x = Mat::from_fn(load.len(), 1, |i, _| load[i]);
        let stiffness = self.matrices::<f64>(0).stiffness;
        Cholesky::with_symbolic(stiffness.as_ref(), symbolic, Some(Par::Seq))?
            .solve_many(x.as_mut(), Par::Seq);
        Ok(StaticResponses {
            compliance,
            inertial: columns.iter().map(|c| dot(c, x.col(0)).re).collect(),
            hub: load.iter().zip(x.col(0).iter()).map(|(f, x)| f * x).sum(),
            inertia,
        })
    }

    fn harmonic_compliance<T: Scalar>(
        &self,
        harmonic: u32,
        columns: &[Column],
        symbolic: &Arc<Symbolic>,
    ) -> Result<Vec<c64>, ModesError> {
        let stiffness = self.matrices::<T>(harmonic).stiffness;
        let factor = Cholesky::with_symbolic(stiffness.as_ref(), symbolic.clone(), Some(Par::Seq))?;
        let m = columns.len();
        let mut x = Mat::<T>::zeros(factor.unknowns(), m);
        for (j, (place, direction)) in columns.iter().enumerate() {
            for axis in 0..3 {
                x[(3 * place + axis, j)] = T::real(direction[axis]);
            }
        }
        factor.solve_many(x.as_mut(), Par::Seq);
        let mut g = Vec::with_capacity(m * m);
        for row in columns {
            g.extend((0..m).map(|j| dot(row, x.col(j))));
        }
        // Hermitian up to rounding: make it so.
        for i in 0..m {
            for j in 0..=i {
                let mean = 0.5 * (g[i * m + j] + g[j * m + i].conj());
                g[i * m + j] = mean;
                g[j * m + i] = mean.conj();
            }
        }
        Ok(g)
    }
}
