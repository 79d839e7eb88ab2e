//! Speeds and torques of a train: kinematics of its meshes, and the balance of the torques of its loads.
//!
//! Each mesh is a row `g` with `g . w = 0` for the speeds `w` of the rotors (shafts, carriers); a rotor that the housing holds
//! is a row of its own. Admissible speeds are the null space `N` of all rows; loads are in balance if `N^T T = 0`, and the
//! multipliers `l` of the rows, `G^T l = -T`, are the torques of the meshes.

use nalgebra::{DMatrix, DVector};

/// Share of the largest torque that may be missing in a balance: files have few digits.
const BALANCED: f64 = 1e-6;
/// Singular values below this share of the largest are zero.
const ZERO: f64 = 1e-9;

/// Speeds and torques of the rotors of a train.
#[derive(Clone, Debug, Default)]
pub struct Train {
    /// Number of rotors.
    pub rotors: usize,
    /// Rows of the meshes by rotor and coefficient, each on the first gear times its teeth.
    pub meshes: Vec<Vec<(usize, f64)>>,
    /// Rotors that the housing holds.
    pub held: Vec<usize>,
}

impl Train {
    fn rows(&self, more: usize) -> DMatrix<f64> {
        let n = self.meshes.len() + self.held.len();
        let mut rows = DMatrix::zeros(n + more, self.rotors);
        for (i, mesh) in self.meshes.iter().enumerate() {
            // Of unit length, so that numbers of teeth do not weigh.
            let length = mesh.iter().map(|(_, c)| c * c).sum::<f64>().sqrt();
            for (rotor, coefficient) in mesh {
                rows[(i, *rotor)] += coefficient / length;
            }
        }
        for (i, rotor) in self.held.iter().enumerate() {
            rows[(self.meshes.len() + i, *rotor)] = 1.0;
        }
        rows
    }

    /// Speeds of all rotors from the given ones; `None` if they contradict the train. Speeds that are not determined are
    /// zero.
    pub fn speeds(&self, given: &[(usize, f64)]) -> Option<Vec<f64>> {
        let mut rows = self.rows(given.len());
        let n = rows.nrows();
        let mut right = DVector::zeros(n);
        for (i, (rotor, speed)) in given.iter().enumerate() {
            let row = n - given.len() + i;
            rows[(row, *rotor)] = 1.0;
            right[row] = *speed;
        }
        if n == 0 || self.rotors == 0 {
            return Some(vec![0.0; self.rotors]);
        }
        let speeds = rows.clone().svd(true, true).solve(&right, ZERO).ok()?;
        let scale = given.iter().fold(0.0_f64, |x, (_, s)| x.max(s.abs()));
        let fits = (rows * &speeds - right).amax() <= 1e-6 * scale;
        fits.then(|| speeds.iter().copied().collect())
    }

    /// Admissible speeds, one column each.
    fn admissible(&self) -> DMatrix<f64> {
        let mut rows = self.rows(0);
        // At least as many rows as rotors, so that the decomposition has all directions.
        let n = rows.nrows().max(self.rotors);
        rows = rows.resize(n, self.rotors, 0.0);
        let Some(directions) = rows.clone().svd(false, true).v_t else {
            return DMatrix::zeros(self.rotors, 0);
        };
        let images = &rows * directions.transpose();
        let free: Vec<_> = (0..self.rotors)
            .filter(|i| images.column(*i).amax() < 1e-7)
            .map(|i| directions.row(i).transpose())
            .collect();
        match free.is_empty() {
            true => DMatrix::zeros(self.rotors, 0),
            false => DMatrix::from_columns(&free),
        }
    }

    /// Completes torques by those of the rotors in `open`, so that all are in balance; `None` if that is not possible.
    pub fn balanced(&self, torques: &[f64], open: &[usize]) -> Option<Vec<f64>> {
        let free = self.admissible();
        let mut all = DVector::from_column_slice(torques);
        let missing = -(free.transpose() * &all);
        let scale = all.amax();
        if missing.amax() > BALANCED * scale {
            if open.is_empty() {
                return None;
            }
            let mut own = DMatrix::zeros(free.ncols(), open.len());
            for (i, rotor) in open.iter().enumerate() {
                for k in 0..free.ncols() {
                    own[(k, i)] = free[(*rotor, k)];
                }
            }
            let found = own.clone().svd(true, true).solve(&missing, ZERO).ok()?;
            if (own * &found - missing).amax() > BALANCED * scale {
                return None;
            }
            for (rotor, torque) in open.iter().zip(found.iter()) {
                all[*rotor] += torque;
            }
        }
        Some(all.iter().copied().collect())
    }

    /// Signs of the torques that the meshes exert on their first gears.
    pub fn mesh_signs(&self, torques: &[f64]) -> Vec<f64> {
        let rows = self.rows(0);
        let right = -DVector::from_column_slice(torques);
        let found = rows.transpose().svd(true, true).solve(&right, ZERO);
        let n = self.meshes.len();
        found.map_or_else(
            |_| vec![0.0; n],
            |x| {
                let largest = x.amax();
                let sign = |x: f64| {
                    if x.abs() < 1e-9 * largest {
                        0.0
                    } else {
                        x.signum()
                    }
                };
                let first = |i: usize| self.meshes[i].first().map_or(0.0, |(_, c)| c.signum());
                (0..n).map(|i| first(i) * sign(x[i])).collect()
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::Train;

    #[test]
    fn a_planetary_set_has_the_speeds_of_willis() {
        // Sun 24, planet 30, ring 84 held; rotors: sun, planet, ring, carrier.
        let train = Train {
            rotors: 4,
            meshes: vec![
                vec![(0, 24.0), (1, 30.0), (3, -54.0)],
                vec![(1, 30.0), (2, -84.0), (3, 54.0)],
            ],
            held: vec![2],
        };
        let speeds = train.speeds(&[(0, 100.0)]).unwrap();
        assert!((speeds[3] - 100.0 * 24.0 / 108.0).abs() < 1e-10);
        assert!(speeds[2].abs() < 1e-10);
        let torques = train.balanced(&[60.0, 0.0, 0.0, 0.0], &[3]).unwrap();
        assert!((torques[3] + 270.0).abs() < 1e-9, "{torques:?}");
        // Sun pushes planets with its left flanks: the mesh resists on the sun. Planets push the ring with right flanks.
        let signs = train.mesh_signs(&torques);
        assert_eq!(signs, [-1.0, 1.0]);
        assert!(train.balanced(&[60.0, 0.0, 0.0, 0.0], &[]).is_none());
        assert!(train.speeds(&[(0, 100.0), (3, 1.0)]).is_none());
    }

    #[test]
    fn a_pair_turns_by_its_teeth() {
        let train = Train {
            rotors: 2,
            meshes: vec![vec![(0, 20.0), (1, 40.0)]],
            held: vec![],
        };
        assert!((train.speeds(&[(0, 3.0)]).unwrap()[1] + 1.5).abs() < 1e-12);
        let torques = train.balanced(&[5.0, 0.0], &[1]).unwrap();
        assert!((torques[1] - 10.0).abs() < 1e-12);
        assert_eq!(train.mesh_signs(&torques), [-1.0]);
    }
}
