//! Condensed Newton correction for contacts that act on few of many coordinates.
//!
//! With the active rows `w_i` and `kappa_i = -(c.k dN/dg + c.d dN/dg') >= 0` the matrix is `A0 + W W^T`, `W` the
//! rows times `sqrt(kappa)`. Only the coordinates `S` that the rows touch take part: `G = E^T A0^-1 E` is
//! what the gears condense to, and
//!
//! ```text
//! x = x0 - A0^-1 E W mu,    (I + W^T G W) mu = W^T x0_S                 few rows
//!                           (I + B B^T) u = L^-1 x0_S,  mu = B^T u      few coordinates
//! ```
//!
//! with `G = L L^T`, `B = L^T W`. Both are symmetric with eigenvalues from 1 upwards, so a stiff penalty harms
//! neither. Friction, with rows `z_i` along the profile, `f = dt/dN` and `d = c.d dt/ds`, is not: its equations are those
//! of the forces themselves,
//!
//! ```text
//! dN_i = -kappa_i w_i . x,   dT_i = f_i dN_i + d_i z_i . x,   x_S = x0_S + G sum_j (w_j dN_j + z_j dT_j)
//! ```

use super::active::Active;
use super::members::SceneGear;
use crate::cholesky::{backward, cholesky, dot, forward};
use crate::gear::{add_response, condensed};
use crate::kinematics::Row;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::{Coeffs, Singular, StateView};

/// Mark of a coordinate that no row contains.
const NONE: u32 = u32::MAX;

/// Buffers of the condensed correction.
#[derive(Default)]
pub(super) struct CondensedCorrection {
    /// Index of each coordinate of the scene among the affected ones of its gear.
    mark: Vec<u32>,
    /// Affected coordinates of each gear, in its own numbering, and their first position in `S`.
    touched: Vec<(Vec<u32>, usize)>,
    /// Blocks of `G`, one per gear.
    g: Vec<f64>,
    /// Rows scaled by `sqrt(kappa)`: entries `(index in S, value)`, and the start of each row.
    entries: Vec<(u32, f64)>,
    begins: Vec<usize>,
    /// Columns of `G W` or `B`, of length `|S|`, one per row.
    columns: Vec<f64>,
    small: Vec<f64>,
    rhs: Vec<f64>,
    forces: Vec<f64>,
    /// Restriction of `x0` to `S`.
    x: Vec<f64>,
}

pub(super) fn kappa(dn_dg: f64, dn_dgdot: f64, c: Coeffs) -> f64 {
    -(c.k * dn_dg + c.d * dn_dgdot)
}

/// Returns the gear with a coordinate of the scene.
fn gear_of(gears: &[SceneGear], coordinate: usize) -> usize {
    gears.partition_point(|g| g.range().end <= coordinate)
}

impl CondensedCorrection {
    /// Adds contacts with their rows to `x0 = A0^-1 rhs`.
    pub(super) fn correct(
        &mut self,
        gears: &mut [SceneGear],
        (active, rows): (&[Active], &[[Row; 4]]),
        at: StateView<'_>,
        c: Coeffs,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let slides = |a: &Active| a.friction.df_dn != 0.0 || a.friction.df_dv != 0.0;
        let slide = active.iter().any(slides);
        let rows = || active.iter().zip(rows);
        let of_contact = if slide { 2 } else { 1 };
        let all = rows().flat_map(|(_, r)| &r[..of_contact]);
        self.collect(gears, all, x.len());
        self.entries.clear();
        self.begins.clear();
        self.begins.push(0);
        for (a, rows) in rows() {
            let scale = if slide {
                1.0
            } else {
                kappa(a.force.dn_dg, a.force.dn_dgdot, c).sqrt()
            };
            for row in &rows[..of_contact] {
                row.for_each(|i, value| {
                    let gear = gear_of(gears, i);
                    let index = self.touched[gear].1 as u32 + self.mark[i];
                    self.entries.push((index, scale * value));
                });
                self.begins.push(self.entries.len());
            }
        }
        self.g.clear();
        self.x.clear();
        for (g, (touched, _)) in gears.iter_mut().zip(&self.touched) {
            let n = touched.len();
            let start = self.g.len();
            self.g.resize(start + n * n, 0.0);
            self.x
                .extend(touched.iter().map(|&i| x[g.offset + i as usize]));
            if n > 0 {
                let (own, viscous) = (g.at(at), g.viscous());
                condensed(
                    g.model.as_mut(),
                    own,
                    c,
                    viscous,
                    touched,
                    &mut self.g[start..],
                )?;
            }
        }
        // The form by coordinates also factorises the blocks of G.
        if slide {
            self.solve_sliding(active, c)?;
        } else if self.begins.len() - 1 <= 2 * self.x.len() {
            self.solve_by_rows()?;
        } else {
            self.solve_by_coordinates()?;
        }
        for (g, (touched, start)) in gears.iter_mut().zip(&self.touched) {
            if !touched.is_empty() {
                let (own, viscous, range) = (g.at(at), g.viscous(), g.range());
                let forces = &self.forces[*start..][..touched.len()];
                let touched = (touched.as_slice(), forces);
                add_response(g.model.as_mut(), own, c, viscous, touched, &mut x[range])?;
            }
        }
        Ok(())
    }

    /// Collects the coordinates in the rows, gear by gear.
    fn collect<'a>(
        &mut self,
        gears: &[SceneGear],
        rows: impl Iterator<Item = &'a Row>,
        coordinates: usize,
    ) {
        self.mark.clear();
        self.mark.resize(coordinates, NONE);
        self.touched.resize_with(gears.len(), Default::default);
        for (touched, _) in &mut self.touched {
            touched.clear();
        }
        for row in rows {
            row.for_each(|i, _| {
                if self.mark[i] == NONE {
                    let gear = gear_of(gears, i);
                    let touched = &mut self.touched[gear].0;
                    self.mark[i] = touched.len() as u32;
                    touched.push((i - gears[gear].offset) as u32);
                }
            });
        }
        let mut start = 0;
        for (touched, begin) in &mut self.touched {
            *begin = start;
            start += touched.len();
        }
    }

    fn row(&self, i: usize) -> &[(u32, f64)] {
        &self.entries[self.begins[i]..self.begins[i + 1]]
    }

    /// Computes `columns = M W` for the blocks `M` in `g`, symmetric, or transposed lower triangles.
    fn multiply(&mut self, triangular: bool) {
        let (size, rows) = (self.x.len(), self.begins.len() - 1);
        let mut columns = std::mem::take(&mut self.columns);
        columns.clear();
        columns.resize(size * rows, 0.0);
        for (i, column) in columns.chunks_exact_mut(size.max(1)).enumerate() {
            let mut block = 0;
            for (touched, start) in &self.touched {
                let n = touched.len();
                for &(index, value) in self.row(i) {
                    let Some(local) = (index as usize).checked_sub(*start).filter(|l| *l < n)
                    else {
                        continue;
                    };
                    let line = &self.g[block + local * n..][..n];
                    let line = if triangular { &line[..=local] } else { line };
                    for (y, g) in column[*start..].iter_mut().zip(line) {
                        *y += value * g;
                    }
                }
                block += n * n;
            }
        }
        self.columns = columns;
    }

    /// Solves `(I + W^T G W) mu = W^T x0`.
    fn solve_by_rows(&mut self) -> Result<(), Singular> {
        self.multiply(false);
        let (size, rows) = (self.x.len(), self.begins.len() - 1);
        let mut small = std::mem::take(&mut self.small);
        let mut rhs = std::mem::take(&mut self.rhs);
        small.clear();
        small.resize(rows * rows, 0.0);
        rhs.clear();
        for i in 0..rows {
            let row = self.row(i);
            for j in 0..=i {
                let column = &self.columns[j * size..][..size];
                let sum: f64 = row.iter().map(|&(k, w)| w * column[k as usize]).sum();
                small[i * rows + j] = sum + f64::from(u8::from(i == j));
            }
            rhs.push(row.iter().map(|&(k, w)| w * self.x[k as usize]).sum());
        }
        let solved = cholesky(&mut small, rows).map(|()| {
            forward(&small, &mut rhs);
            backward(&small, &mut rhs);
        });
        self.small = small;
        self.set_forces(&rhs);
        self.rhs = rhs;
        solved
    }

    /// Solves the equations of normal forces and friction, two per contact.
    fn solve_sliding(&mut self, active: &[Active], c: Coeffs) -> Result<(), Singular> {
        self.multiply(false);
        let (size, rows) = (self.x.len(), self.begins.len() - 1);
        let mut small = std::mem::take(&mut self.small);
        let mut rhs = std::mem::take(&mut self.rhs);
        small.clear();
        rhs.clear();
        for i in 0..rows {
            let a = &active[i / 2];
            let normal = i % 2 == 0;
            let per_motion = if normal {
                -kappa(a.force.dn_dg, a.force.dn_dgdot, c)
            } else {
                c.d * a.friction.df_dv
            };
            let row = self.row(i);
            for j in 0..rows {
                let column = &self.columns[j * size..][..size];
                let along: f64 = row.iter().map(|&(k, w)| w * column[k as usize]).sum();
                small.push(f64::from(u8::from(i == j)) - per_motion * along);
            }
            if !normal {
                small[i * rows + i - 1] -= a.friction.df_dn;
            }
            let along: f64 = row.iter().map(|&(k, w)| w * self.x[k as usize]).sum();
            rhs.push(per_motion * along);
        }
        let solved = solve_in_place(&mut small, &mut rhs);
        self.small = small;
        rhs.iter_mut().for_each(|force| *force = -*force);
        self.set_forces(&rhs);
        self.rhs = rhs;
        solved
    }

    /// Solves `(I + B B^T) u = L^-1 x0` and computes `mu = B^T u`.
    fn solve_by_coordinates(&mut self) -> Result<(), Singular> {
        let mut block = 0;
        for (touched, start) in &self.touched {
            let n = touched.len();
            let g = &mut self.g[block..][..n * n];
            cholesky(g, n)?;
            forward(g, &mut self.x[*start..][..n]);
            block += n * n;
        }
        self.multiply(true);
        let (size, rows) = (self.x.len(), self.begins.len() - 1);
        self.small.clear();
        self.small.resize(size * size, 0.0);
        for i in 0..size {
            self.small[i * size + i] = 1.0;
        }
        for column in self.columns.chunks_exact(size) {
            for (i, &bi) in column.iter().enumerate() {
                if bi != 0.0 {
                    for (s, bj) in self.small[i * size..][..=i].iter_mut().zip(column) {
                        *s += bi * bj;
                    }
                }
            }
        }
        cholesky(&mut self.small, size)?;
        forward(&self.small, &mut self.x);
        backward(&self.small, &mut self.x);
        let mut rhs = std::mem::take(&mut self.rhs);
        rhs.clear();
        rhs.extend((0..rows).map(|i| dot(&self.columns[i * size..][..size], &self.x)));
        self.set_forces(&rhs);
        self.rhs = rhs;
        Ok(())
    }

    /// Sets the forces `-W mu` on the affected coordinates.
    fn set_forces(&mut self, mu: &[f64]) {
        let mut forces = std::mem::take(&mut self.forces);
        forces.clear();
        forces.resize(self.x.len(), 0.0);
        for (i, mu) in mu.iter().enumerate() {
            for &(k, w) in self.row(i) {
                forces[k as usize] -= w * mu;
            }
        }
        self.forces = forces;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both forms give equal forces for two gears with rows across both and a stiff penalty, and these solve `x = x0 +
    /// G f`, `f = -W W^T x`.
    #[test]
    fn both_forms_solve_the_same_equation() {
        let sizes = [3usize, 2];
        let number = |i: usize| ((7 * i * i + 3 * i) as f64).sin();
        let mut b = CondensedCorrection {
            touched: vec![((0..3).collect(), 0), ((0..2).collect(), 3)],
            begins: vec![0],
            ..CondensedCorrection::default()
        };
        for n in sizes {
            let m: Vec<f64> = (0..n * n).map(|i| number(i + n)).collect();
            for i in 0..n {
                for j in 0..n {
                    let product: f64 = (0..n).map(|k| m[i * n + k] * m[j * n + k]).sum();
                    b.g.push(product + f64::from(u8::from(i == j)));
                }
            }
        }
        b.x = (0..5).map(|i| number(i + 20)).collect();
        for i in 0..12 {
            for k in 0..5 {
                b.entries.push((k, 1e3 * number(5 * i + k as usize)));
            }
            b.begins.push(b.entries.len());
        }
        let (g, x0) = (b.g.clone(), b.x.clone());
        b.solve_by_rows().unwrap();
        let by_rows = b.forces.clone();
        b.solve_by_coordinates().unwrap();
        for (a, c) in by_rows.iter().zip(&b.forces) {
            assert!((a - c).abs() < 1e-9 * c.abs(), "{a} {c}");
        }
        let mut x = x0;
        let mut block = 0;
        for (n, start) in [(3, 0), (2, 3)] {
            for i in 0..n {
                x[start + i] += dot(&g[block + i * n..][..n], &by_rows[start..start + n]);
            }
            block += n * n;
        }
        let mut f = vec![0.0; 5];
        for i in 0..12 {
            let along: f64 = b.row(i).iter().map(|&(k, w)| w * x[k as usize]).sum();
            for &(k, w) in b.row(i) {
                f[k as usize] -= w * along;
            }
        }
        for (a, c) in by_rows.iter().zip(&f) {
            assert!((a - c).abs() < 1e-5 * c.abs(), "{a} {c}");
        }
    }
}
