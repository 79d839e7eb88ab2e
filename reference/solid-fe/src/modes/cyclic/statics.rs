//! Static responses of a body, bore held, to forces on one sector: one problem of a sector's size per harmonic.

use super::Sector;
use crate::Vec3;
use crate::modes::ModesError;
use crate::solve::{Cholesky, Scalar, Symbolic};
use crate::vector::turned;
use faer::{Mat, Par, c64};
use std::sync::Arc;

/// Responses of all harmonics to forces on one sector.
#[derive(Clone, Debug)]
pub struct StaticResponses {
    /// `C^T K_n^-1 C` per harmonic from 0 to z/2, row by row.
    pub compliance: Vec<Vec<c64>>,
}

/// Responses to the inertia of rigid motions `e` of one harmonic, as sums over one sector; all row by row.
#[derive(Clone, Debug)]
pub struct InertialResponses {
    /// `C^T K_n^-1 M e`.
    pub inertial: Vec<c64>,
    /// `(M e_p)^H K_n^-1 M e_q`, free nodes only.
    pub hub: Vec<c64>,
    /// Inertia matrix `e_p^H M e_q`.
    pub inertia: Vec<c64>,
}

/// A direction at a free node of the sector: `(place, direction)`.
pub type Column = (usize, Vec3);

fn dot<T: Scalar>((place, direction): &Column, x: faer::ColRef<'_, T>) -> c64 {
    let mut sum = c64::new(0.0, 0.0);
    for axis in 0..3 {
        let [re, im] = x[3 * place + axis].parts();
        sum += c64::new(direction[axis] * re, direction[axis] * im);
    }
    sum
}

impl Sector {
    /// Returns the index of a node among the free ones, or `None` if it is tied to the hub or lies on the high cut.
    pub fn place_of(&self, node: u32) -> Option<usize> {
        match self.place.get(node as usize) {
            Some(&(place, false)) if place != super::sector::HELD => Some(place as usize),
            _ => None,
        }
    }

    /// Responses along some columns to unit forces along them on sector 0.
    pub fn static_responses(&self, columns: &[Column]) -> Result<StaticResponses, ModesError> {
        let sectors = self.sectors();
        let harmonics = sectors / 2 + 1;
        let symbolic = Arc::new(self.symbolic()?);
        let compliance = self.each(0..harmonics as usize, |n| {
            let n = n as u32;
            if n == 0 || 2 * n == sectors {
                self.harmonic_compliance::<f64>(n, columns, &symbolic)
            } else {
                self.harmonic_compliance::<c64>(n, columns, &symbolic)
            }
        })?;
        Ok(StaticResponses { compliance })
    }

    /// Responses along some columns to the inertia of motions of a harmonic, three displacements per node of the sector.
    pub fn inertial_responses(
        &self,
        harmonic: u32,
        columns: &[Column],
        motions: &[&[c64]],
    ) -> Result<InertialResponses, ModesError> {
        match harmonic {
            0 => self.inertial_responses_of::<f64>(harmonic, columns, motions),
            _ => self.inertial_responses_of::<c64>(harmonic, columns, motions),
        }
    }

    fn inertial_responses_of<T: Scalar>(
        &self,
        harmonic: u32,
        columns: &[Column],
        motions: &[&[c64]],
    ) -> Result<InertialResponses, ModesError> {
        // The high cut is the low cut of the next sector.
        let pitch = std::f64::consts::TAU / f64::from(self.sectors());
        let (sin, cos) = self.phase(harmonic).sin_cos();
        let back = c64::new(cos, -sin);
        let mut images = Vec::new();
        let mut loads = vec![vec![c64::new(0.0, 0.0); self.unknowns()]; motions.len()];
        for (motion, load) in motions.iter().zip(&mut loads) {
            let image = [0, 1].map(|part| {
                let of = |c: &c64| if part == 0 { c.re } else { c.im };
                let e: Vec<f64> = motion.iter().map(of).collect();
                let mut image = vec![0.0; e.len()];
                self.assembly.mass.apply(&e, &mut image);
                image
            });
            for (node, &(place, high)) in self.place.iter().enumerate() {
                if place == super::sector::HELD {
                    continue;
                }
                let [re, im] = image.each_ref().map(|image| {
                    let f = Vec3::from_column_slice(&image[3 * node..][..3]);
                    if high { turned(f, -pitch) } else { f }
                });
                for axis in 0..3 {
                    let f = c64::new(re[axis], im[axis]);
                    load[3 * place as usize + axis] += if high { f * back } else { f };
                }
            }
            images.push(image);
        }
        let mut x = Mat::from_fn(self.unknowns(), motions.len(), |i, p| {
            T::complex(loads[p][i].re, loads[p][i].im)
        });
        let symbolic = Arc::new(self.symbolic()?);
        let stiffness = self.matrices::<T>(harmonic).stiffness;
        Cholesky::with_symbolic(stiffness.as_ref(), symbolic, Some(Par::Seq))?
            .solve_many(x.as_mut(), Par::Seq);
        let n = motions.len();
        let pairs = || (0..n).flat_map(|p| (0..n).map(move |q| (p, q)));
        let number = |x: &T| {
            let [re, im] = x.parts();
            c64::new(re, im)
        };
        let sum = |of: &mut dyn Iterator<Item = c64>| of.fold(c64::new(0.0, 0.0), |s, x| s + x);
        Ok(InertialResponses {
            inertial: (columns.iter())
                .flat_map(|c| (0..n).map(|p| dot(c, x.col(p))).collect::<Vec<_>>())
                .collect(),
            hub: pairs()
                .map(|(p, q)| {
                    let u = x.col(q).iter().map(number);
                    sum(&mut loads[p].iter().zip(u).map(|(f, u)| f.conj() * u))
                })
                .collect(),
            inertia: pairs()
                .map(|(p, q)| {
                    let [re, im] = &images[q];
                    let image = re.iter().zip(im).map(|(re, im)| c64::new(*re, *im));
                    sum(&mut motions[p].iter().zip(image).map(|(e, f)| e.conj() * f))
                })
                .collect(),
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
