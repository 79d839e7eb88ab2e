//! Newton corrections of scenes with carriers.
//!
//! In the carrier-frame state the motion of a carrier is the frame of its set, `x = J x~`: contacts, pins and teeth
//! depend on `x~_g` alone, inertia and forces from the ground on `x_g = R x~_g + B x_c`. With the product `a_j = R^T
//! A_0 B e_j` of the absolute part and the correction `S` of the gears with all contacts in the carrier-frame state,
//!
//! ```text
//! y_j = S a_j,    x~_g = S R^T r_g - sum_j y_j x_cj
//! sum_j (A_0,ij + b_i . a_j - a_i . y_j) x_cj = r_ci + b_i . R^T r_g - a_i . S R^T r_g
//! ```
//!
//! for the coordinates `i`, `j` of carriers, `b_j = R^T B e_j`. Bearings of gears on the ground count as the same in all radial
//! directions, and how forces turn with the carrier is left to the iteration.

use crate::scene::assembled::Scene;
use gearbench_integrators::dense_solve::solve_in_place;
use gearbench_integrators::system::{Coeffs, SecondOrderSystem, Singular, StateView};

impl Scene {
    /// Solves for gears and contacts without links, at a state of the scene with evaluated contacts.
    pub(in crate::scene) fn correct_sets(
        &mut self,
        at: StateView<'_>,
        c: Coeffs,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        if self.carriers.is_empty() {
            return self.correct_contacts(at, c, false, x);
        }
        self.with_carrier_state(at, |scene, carrier_state| {
            scene.correct_relative(at, carrier_state, c, x)
        })
    }

    fn correct_relative(
        &mut self,
        at: StateView<'_>,
        carrier_state: StateView<'_>,
        c: Coeffs,
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let n = x.len();
        let of_carriers = self.carriers.coordinates();
        let columns: Vec<Vec<f64>> = (of_carriers.iter())
            .map(|&j| self.carriers.motion_of(j, carrier_state, n))
            .collect();
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| x * y).sum() };
        // Right-hand sides in the relative state.
        let mut relative = x.to_vec();
        self.carriers.turn_back(at, &mut relative);
        let on_carriers: Vec<f64> = (of_carriers.iter().zip(&columns))
            .map(|(&j, b)| x[j] + dot(b, &relative))
            .collect();
        let products: Vec<Vec<f64>> = columns
            .iter()
            .map(|b| self.absolute_product(carrier_state, c, b))
            .collect();
        let own: Vec<Vec<f64>> = (of_carriers.iter())
            .map(|&j| {
                let mut unit = vec![0.0; n];
                unit[j] = 1.0;
                self.absolute_product(carrier_state, c, &unit)
            })
            .collect();
        of_carriers.iter().for_each(|&j| relative[j] = 0.0);
        self.correct_contacts(carrier_state, c, false, &mut relative)?;
        let mut couplings = products.clone();
        for y in &mut couplings {
            self.correct_contacts(carrier_state, c, false, y)?;
        }
        let m = of_carriers.len();
        let mut small = Vec::with_capacity(m * m);
        let mut motion = Vec::with_capacity(m);
        for (i, &of) in of_carriers.iter().enumerate() {
            for j in 0..m {
                let a = own[j][of] + dot(&columns[i], &products[j]);
                small.push(a - dot(&products[i], &couplings[j]));
            }
            motion.push(on_carriers[i] - dot(&products[i], &relative));
        }
        solve_in_place(&mut small, &mut motion)?;
        for (y, by) in couplings.iter().zip(&motion) {
            relative.iter_mut().zip(y).for_each(|(x, y)| *x -= by * y);
        }
        for (b, by) in columns.iter().zip(&motion) {
            relative.iter_mut().zip(b).for_each(|(x, b)| *x += by * b);
        }
        self.carriers.turn_forth(at, &mut relative);
        x.copy_from_slice(&relative);
        for (&j, by) in of_carriers.iter().zip(&motion) {
            x[j] = *by;
        }
        Ok(())
    }

    /// Computes `A_0 x` of the absolute part: inertia, bearings and loads on the ground.
    fn absolute_product(&mut self, carrier_state: StateView<'_>, c: Coeffs, x: &[f64]) -> Vec<f64> {
        let n = x.len();
        let mut y = vec![0.0; n];
        self.apply_mass(carrier_state, x, &mut y);
        y.iter_mut().for_each(|y| *y *= c.m);
        let [dq, dv] = [c.k, c.d].map(|by| x.iter().map(|x| by * x).collect::<Vec<f64>>());
        let mut df = vec![0.0; n];
        for (i, g) in self.gears.iter_mut().enumerate() {
            let (own, range) = (g.at(carrier_state), g.range());
            if range.is_empty() {
                continue;
            }
            if !self.carriers.carries(i) {
                let along = [&dq[range.clone()], &dv[range.clone()]];
                g.model
                    .tangent(own, along[0], along[1], &mut df[range.clone()]);
            }
            df[range.start] -= g.viscous() * dv[range.start];
        }
        y.iter_mut().zip(&df).for_each(|(y, df)| *y -= df);
        y
    }
}
