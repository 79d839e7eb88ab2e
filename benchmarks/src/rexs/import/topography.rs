//! Topographical modifications of a file as grids of a scene.
//!
//! A file lists points by their distance from the datum face and their diameter or length of roll. A scene has amounts at equal
//! steps of the length of roll and over the width.

use super::gears::exact;
use crate::rexs::attributes as key;
use crate::rexs::model::Component;

/// Base radius and face width of a gear, which the points of a topography refer to.
pub(super) struct FlankMeasures {
    /// Base radius [m].
    pub(super) r_base: f64,
    /// Face width [m].
    pub(super) width: f64,
}

/// A topography as the scene has it: amounts at equal steps of the length of roll and over the width.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TopographyGrid {
    /// Amounts from the root to the tip, each row from the lower to the upper end [m].
    pub(super) rows: Vec<Vec<f64>>,
    /// Radii of the first and the last row [m].
    pub(super) radii: [f64; 2],
    /// Heights of the first and the last column from the middle of the face [m].
    pub(super) heights: [f64; 2],
    /// True if the points of the file have other steps.
    pub(super) is_resampled: bool,
}

/// Largest number of rows and columns of a resampled topography.
const MOST_STEPS: usize = 200;

impl TopographyGrid {
    /// Radii of the first and the last row, heights of the first and the last column [m].
    pub(super) fn extent(&self) -> [[f64; 2]; 2] {
        [self.radii, self.heights]
    }

    /// The grid of a component, or the reason why its points are none.
    pub(super) fn of(own: &Component, measures: &FlankMeasures) -> Result<Self, String> {
        let amounts = own
            .list(&key::TOPOGRAPHY)
            .ok_or("it has no list of amounts")?;
        let coordinates = own.list(&key::TOPOGRAPHY_COORDINATES);
        let coordinates = coordinates.ok_or("it has no list of coordinates")?;
        let lengths = match (
            own.list(&key::TOPOGRAPHY_LENGTHS),
            own.list(&key::TOPOGRAPHY_DIAMETERS),
        ) {
            (Some(lengths), _) => lengths,
            (None, Some(diameters)) => {
                let roll = |d: f64| (0.25 * d * d - measures.r_base.powi(2)).max(0.0).sqrt();
                diameters.into_iter().map(roll).collect()
            }
            (None, None) => return Err("it has neither diameters nor lengths of roll".into()),
        };
        let n = amounts.len();
        let all = [&amounts, &coordinates, &lengths];
        if all
            .iter()
            .any(|list| list.len() != n || list.iter().any(|x| !x.is_finite()))
        {
            return Err("its lists are not numbers of the same points".into());
        }
        let [down, across] = [steps(&lengths), steps(&coordinates)];
        if down.len() < 2 || across.len() < 2 || down.len() * across.len() != n {
            return Err("its points are no rectangular grid".into());
        }
        let mut given = vec![vec![None; across.len()]; down.len()];
        for ((amount, s), z) in amounts.iter().zip(&lengths).zip(&coordinates) {
            given[nearest(&down, *s)][nearest(&across, *z)] = Some(*amount);
        }
        let given: Option<Vec<Vec<f64>>> = given
            .into_iter()
            .map(|row| row.into_iter().collect())
            .collect();
        let given = given.ok_or("its points are no rectangular grid")?;
        let (places, columns) = (even(&down), even(&across));
        let at = |s: f64, z: f64| {
            let ((i, p), (j, q)) = (between(&down, s), between(&across, z));
            let row = |i: usize| (1.0 - q) * given[i][j] + q * given[i][j + 1];
            (1.0 - p) * row(i) + p * row(i + 1)
        };
        let rows = match (&places, &columns) {
            (None, None) => given.clone(),
            _ => {
                let (down, across) = (
                    places.as_ref().unwrap_or(&down),
                    columns.as_ref().unwrap_or(&across),
                );
                let row = |s: &f64| across.iter().map(|z| at(*s, *z)).collect();
                down.iter().map(row).collect()
            }
        };
        let ends = |of: &[f64]| [of[0], of[of.len() - 1]];
        Ok(TopographyGrid {
            rows: rows
                .into_iter()
                .map(|row: Vec<f64>| row.into_iter().map(exact).collect())
                .collect(),
            radii: ends(&down).map(|s| exact(s.hypot(measures.r_base))),
            heights: ends(&across).map(|z| exact(z - 0.5 * measures.width)),
            is_resampled: places.is_some() || columns.is_some(),
        })
    }
}

/// Distinct values of a list, ascending; values within a nanometre are one.
fn steps(of: &[f64]) -> Vec<f64> {
    let mut all = of.to_vec();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    all
}

/// Index of the value of an ascending list next to `x`.
fn nearest(of: &[f64], x: f64) -> usize {
    let distance = |i: &usize| (of[*i] - x).abs();
    let all = 0..of.len();
    all.min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(0)
}

/// Equal steps over the span of an ascending list, as fine as its finest; `None` if its own steps are equal.
fn even(of: &[f64]) -> Option<Vec<f64>> {
    let (first, n) = (of[0], of.len() - 1);
    let span = of[n] - first;
    let place = |i: usize, n: usize| first + span * i as f64 / n as f64;
    if (0..=n).all(|i| (of[i] - place(i, n)).abs() < 1e-6 * span) {
        return None;
    }
    let finest = of.windows(2).map(|w| w[1] - w[0]).fold(span, f64::min);
    let n = ((span / finest).ceil() as usize).min(MOST_STEPS);
    Some((0..=n).map(|i| place(i, n)).collect())
}

/// The interval of an ascending list around `x`, and the share of its length before `x`.
fn between(of: &[f64], x: f64) -> (usize, f64) {
    let i = of.partition_point(|y| *y <= x).clamp(1, of.len() - 1) - 1;
    (i, ((x - of[i]) / (of[i + 1] - of[i])).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::{FlankMeasures, TopographyGrid};
    use crate::rexs::attributes as key;
    use crate::rexs::model::Component;

    /// A component with the points of a product of diameters and coordinates.
    fn component(diameters: &[f64], coordinates: &[f64], amount: fn(f64, f64) -> f64) -> Component {
        let all = || {
            diameters
                .iter()
                .flat_map(|d| coordinates.iter().map(move |z| (*d, *z)))
        };
        let mut own = Component::default();
        own.set_list(
            &key::TOPOGRAPHY_DIAMETERS,
            &all().map(|p| p.0).collect::<Vec<_>>(),
        );
        own.set_list(
            &key::TOPOGRAPHY_COORDINATES,
            &all().map(|p| p.1).collect::<Vec<_>>(),
        );
        own.set_list(
            &key::TOPOGRAPHY,
            &all().map(|(d, z)| amount(d, z)).collect::<Vec<_>>(),
        );
        own
    }

    const MEASURES: FlankMeasures = FlankMeasures {
        r_base: 0.02,
        width: 0.01,
    };

    #[test]
    fn points_at_other_steps_are_interpolated() {
        // Linear over the length of roll and the width, so that interpolation is exact.
        let amount = |d: f64, z: f64| 1e-3 * (0.25 * d * d - 4e-4).sqrt() + 2e-3 * z;
        let own = component(&[0.041, 0.042, 0.045], &[0.0, 0.002, 0.01], amount);
        let grid = TopographyGrid::of(&own, &MEASURES).unwrap();
        assert!(grid.is_resampled);
        assert_eq!(
            [grid.radii[0], grid.heights[0], grid.heights[1]],
            [0.0205, -0.005, 0.005]
        );
        let [first, last] = grid.radii.map(|r| (r * r - 4e-4).sqrt());
        let (m, n) = (grid.rows.len() - 1, grid.rows[0].len() - 1);
        assert_eq!(n, 5);
        for (i, row) in grid.rows.iter().enumerate() {
            for (j, x) in row.iter().enumerate() {
                let s = first + (last - first) * i as f64 / m as f64;
                let z = 0.01 * j as f64 / n as f64;
                assert!((x - (1e-3 * s + 2e-3 * z)).abs() < 1e-14, "{i} {j}: {x}");
            }
        }
    }

    #[test]
    fn points_that_are_no_grid_are_named() {
        let own = component(&[0.041, 0.045], &[0.0, 0.01], |_, _| 1e-6);
        let why = |change: &dyn Fn(&mut Component)| {
            let mut own = own.clone();
            change(&mut own);
            TopographyGrid::of(&own, &MEASURES).unwrap_err()
        };
        assert!(
            why(&|c| drop(
                c.attributes
                    .remove("diameters_of_topographical_modification")
            ))
            .contains("neither")
        );
        assert!(why(&|c| c.set_list(&key::TOPOGRAPHY, &[1e-6])).contains("same points"));
        assert!(
            why(&|c| c.set_list(&key::TOPOGRAPHY_COORDINATES, &[0.0, 1e-3, 2e-3, 3e-3]))
                .contains("rectangular")
        );
        assert!(
            why(&|c| c.set_list(&key::TOPOGRAPHY_COORDINATES, &[0.0, 1e-3, 0.0, 0.0]))
                .contains("rectangular")
        );
    }
}
