//! Stiffness of a pair (or of the mesh) along the path of contact, and the compliance that pairs share, evaluated in
//! constant time without allocation.
//!
//! Two pairs in contact bend the same two gear bodies. With `k_p` the stiffness of one pair alone
//! (tooth, body and contact in series) and `c_pr` the approach of pair `p` under a unit force on pair
//! `r`, forces `N` and approaches `d` of the pairs in contact obey
//!
//! ```text
//! d_p = N_p / k_p + sum over r != p of c_pr N_r
//! ```

use super::error::{StiffnessError, positive};
use super::spline::{Ends, Interpolation, Spline};

/// Reference of a stiffness: one tooth pair or the whole mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PairOrMesh {
    /// One spring per tooth pair; pairs in contact act in parallel.
    #[default]
    Pair,
    /// One spring whatever the number of pairs in contact.
    Mesh,
}

/// Stiffness (N/m) of a pair over the path coordinate `s` (m) for the whole face width, and the compliances (m/N)
/// between pairs.
#[derive(Debug, Clone, PartialEq)]
pub struct StiffnessCurve {
    of: PairOrMesh,
    own: Spline,
    /// Compliances between pairs one, two, ... base pitches apart.
    coupling: Vec<Spline>,
}

impl StiffnessCurve {
    /// Returns a constant stiffness (N/m).
    ///
    /// # Errors
    /// [`StiffnessError::NotPositive`].
    pub fn constant(k: f64, of: PairOrMesh) -> Result<StiffnessCurve, StiffnessError> {
        positive("stiffness [N/m]", k)?;
        Ok(Self::of_spline(Spline::constant(k), of))
    }

    /// Interpolates `k` (N/m) at the increasing path coordinates `s` (m).
    ///
    /// # Errors
    /// [`StiffnessError`] when lengths differ, fewer than two points are given, `s` does not increase,
    /// a value is not finite and positive, or the spline dips to zero between the points.
    pub fn interpolate(
        s: &[f64],
        k: &[f64],
        of: PairOrMesh,
        ends: Ends,
        interpolation: Interpolation,
    ) -> Result<StiffnessCurve, StiffnessError> {
        let own = Spline::interpolate(s, k, ends, interpolation)?;
        if let Some(i) = k.iter().position(|&x| x <= 0.0) {
            let reason = format!("k[{i}] is {} N/m; it must be positive", k[i]);
            return Err(StiffnessError::Table { reason });
        }
        let (at, value) = own.minimum();
        if value <= 0.0 {
            return Err(StiffnessError::NotPositiveBetween { s: at, value });
        }
        Ok(Self::of_spline(own, of))
    }

    fn of_spline(own: Spline, of: PairOrMesh) -> StiffnessCurve {
        StiffnessCurve {
            of,
            own,
            coupling: Vec::new(),
        }
    }

    /// Adds the compliance (m/N) between pairs that are one more base pitch apart than the present ones: `c` at the
    /// increasing means `s` (m) of their path coordinates, constant beyond them.
    ///
    /// # Errors
    /// [`StiffnessError::Table`].
    pub fn couple(&mut self, s: &[f64], c: &[f64]) -> Result<(), StiffnessError> {
        let cubic = Interpolation::Cubic;
        let spline = Spline::interpolate(s, c, Ends::Clamped, cubic)?;
        self.coupling.push(spline);
        Ok(())
    }

    /// Returns whether the stiffness refers to a pair or to the mesh.
    pub fn of(&self) -> PairOrMesh {
        self.of
    }

    /// Returns the range of path coordinates (m) in which the stiffness varies; `None` for a constant one.
    pub fn range(&self) -> Option<[f64; 2]> {
        self.own.range()
    }

    /// Returns the stiffness (N/m) of one pair alone and its slope (N/m^2) at `s` (m), in constant time without
    /// allocation.
    #[inline]
    pub fn eval(&self, s: f64) -> (f64, f64) {
        self.own.eval(s)
    }

    /// Returns the compliance (m/N) between two pairs that are `pitches` base pitches apart, and its slope (1/N), at
    /// the mean `s` (m) of their path coordinates: the approach of one per force on the other, for the whole face
    /// width. It is (0, 0) without coupling. It takes constant time without allocation.
    #[inline]
    pub fn coupling(&self, pitches: usize, s: f64) -> (f64, f64) {
        match self.coupling.get(pitches.wrapping_sub(1)) {
            Some(c) => c.eval(s),
            None => (0.0, 0.0),
        }
    }

    /// Returns the largest number of base pitches over which pairs are coupled; 0 without coupling.
    #[inline]
    pub fn coupled_pitches(&self) -> usize {
        self.coupling.len()
    }

    /// Returns the smallest stiffness as (position in m, value in N/m).
    pub fn minimum(&self) -> (f64, f64) {
        self.own.minimum()
    }

    /// Returns the largest stiffness as (position in m, value in N/m).
    pub fn maximum(&self) -> (f64, f64) {
        self.own.maximum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(k: &[f64]) -> Result<StiffnessCurve, StiffnessError> {
        let s: Vec<f64> = (0..k.len()).map(|i| i as f64).collect();
        let cubic = Interpolation::Cubic;
        StiffnessCurve::interpolate(&s, k, PairOrMesh::Pair, Ends::Clamped, cubic)
    }

    #[test]
    fn stiffnesses_that_are_not_positive_are_refused() {
        let refused = |k: &[f64]| curve(k).unwrap_err().to_string();
        assert!(refused(&[1.0, -2.0, 1.0]).contains("k[1]"));
        assert!(refused(&[100.0, 1e-3, 1e-3, 100.0]).contains("linear interpolation"));
        assert!(StiffnessCurve::constant(0.0, PairOrMesh::Pair).is_err());
    }

    #[test]
    fn pairs_are_coupled_by_whole_pitches_only_where_it_is_known() {
        let mut k = curve(&[1.0, 2.0, 1.0]).unwrap();
        assert_eq!(k.coupling(1, 0.5), (0.0, 0.0));
        k.couple(&[0.5, 1.5], &[0.25, 0.75]).unwrap();
        k.couple(&[0.9, 1.1], &[0.1, -0.1]).unwrap();
        assert_eq!(k.coupled_pitches(), 2);
        assert_eq!(k.coupling(1, 1.0), (0.5, 0.5));
        assert_eq!(k.coupling(1, 0.0), (0.25, 0.0));
        assert!((k.coupling(2, 1.0).1 + 1.0).abs() < 1e-12);
        for pitches in [0, 3] {
            assert_eq!(k.coupling(pitches, 1.0), (0.0, 0.0));
        }
    }
}
