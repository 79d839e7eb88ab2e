//! Newton corrections of an elastic gear on a bearing.
//!
//! ```text
//! [ A_hh       -E^T       ] [x_h]   [ r_h          ]
//! [ B E   1 + B P D^-1 P^T ] [ F ] = [ -B P D^-1 r_q ],      x_q = D^-1 (r_q + P^T F)
//! ```

use super::{Elastic, Motion, add, dot};
use crate::kinematics::listed;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::{Coeffs, Singular, StateView};

impl Elastic {
    /// Solves with `c.m M + c.d D + c.k K` of a gear on a bearing, with `hub_damping` on its rotation.
    pub(in super::super) fn correct_on_bearing(
        &self,
        at: StateView<'_>,
        c: Coeffs,
        hub_damping: f64,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let Some((lateral, shapes)) = self.lateral() else {
            return Err(Singular);
        };
        let s = self.lateral_motion(shapes, at);
        let own = self.hub.moving();
        let (list, n) = listed(self.hub.free_directions());
        let mass = lateral.mass(&s.frame.x, own, self.hub.inertia);
        // Inertia of the hub in its six directions, condensed over the own coordinates.
        let mut b = [[0.0; 6]; 6];
        for d in 0..6 {
            let mut along = Motion::default();
            (along.x[d], along.v[d]) = (c.k, c.d);
            let change = lateral.bearing_change(&s.hub, &along);
            for i in 0..6 {
                b[i][d] = -change[i];
            }
        }
        b[own][own] += c.d * hub_damping;
        let slope = s.turned.slope(&s.off);
        let size = n + 6;
        let mut a = [0.0; 144];
        let mut y = [0.0; 12];
        y[..n].copy_from_slice(&x[..n]);
        let e = |i: usize, k: usize| {
            let along = f64::from(u8::from(list[k] == i));
            along + if list[k] == own { slope[i] } else { 0.0 }
        };
        for (k, &dk) in list[..n].iter().enumerate() {
            let mut change = [0.0; 6];
            if lateral.spins {
                let mut along = Motion::default();
                (along.x[dk], along.v[dk]) = (c.k, c.d);
                change = lateral.spin_change(&s.frame, &along);
            }
            for (i, &di) in list[..n].iter().enumerate() {
                a[i * size + k] = c.m * mass[di][dk] - change[di];
            }
            for j in 0..6 {
                a[k * size + n + j] = -e(j, k);
            }
        }
        // P D^-1 P^T and P D^-1 r_q, own axes first.
        let (mut give, mut flow) = ([[0.0; 6]; 6], [0.0; 6]);
        for (k, phi) in shapes.0.iter().enumerate() {
            let i = self.own + k;
            let (w, z) = (self.omega[i], self.zeta[i]);
            let d = c.m + c.d * 2.0 * z * w + c.k * w * w;
            if d == 0.0 {
                return Err(Singular);
            }
            x[i] /= d;
            add(&mut flow, x[i], phi);
            for (row, p) in give.iter_mut().zip(phi) {
                add(row, p / d, phi);
            }
        }
        let flow = s.turned.to_hub(&flow);
        let columns = give.map(|row| s.turned.to_hub(&row));
        let mut turned = [[0.0; 6]; 6];
        for j in 0..6 {
            let column = s.turned.to_hub(&columns.map(|row| row[j]));
            for i in 0..6 {
                turned[i][j] = column[i];
            }
        }
        for i in 0..6 {
            let row = n + i;
            for k in 0..n {
                a[row * size + k] = (0..6).map(|j| b[i][j] * e(j, k)).sum();
            }
            for j in 0..6 {
                let through: f64 = (0..6).map(|l| b[i][l] * turned[l][j]).sum();
                a[row * size + n + j] = f64::from(u8::from(i == j)) + through;
            }
            y[row] = -dot(&b[i], &flow);
        }
        solve_in_place(&mut a[..size * size], &mut y[..size])?;
        x[..n].copy_from_slice(&y[..n]);
        let mut force = [0.0; 6];
        force.copy_from_slice(&y[n..size]);
        let force = s.turned.to_own(&force);
        for (k, phi) in shapes.0.iter().enumerate() {
            let i = self.own + k;
            let (w, z) = (self.omega[i], self.zeta[i]);
            let d = c.m + c.d * 2.0 * z * w + c.k * w * w;
            x[i] += dot(phi, &force) / d;
        }
        Ok(())
    }

    /// Returns the rigid part of the mass matrix over the free directions of the hub, row-major, and their number.
    pub(in super::super) fn hub_mass(&self, at: StateView<'_>) -> ([f64; 36], usize) {
        let n = self.own;
        let mut out = [0.0; 36];
        match self.hub.lateral.as_deref().filter(|l| l.spins) {
            Some(lateral) => {
                let mass = lateral.mass_matrix(&self.hub.motion(at.t, at.q, at.v).x);
                for (i, di) in self.hub.free_directions().enumerate() {
                    for (j, dj) in self.hub.free_directions().enumerate() {
                        out[i * n + j] = mass[di][dj];
                    }
                }
            }
            None => {
                for i in 0..n {
                    out[i * n + i] = self.hub.masses[i];
                }
            }
        }
        (out, n)
    }
}
