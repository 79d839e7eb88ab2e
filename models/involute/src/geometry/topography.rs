//! A measured flank: material removed on a grid over profile and width.
//!
//! Rows are at equal steps of the length of roll, columns at equal steps over the width. Between them the surface is
//! smooth: cubic in both directions, through the amounts, with the slopes of parabolas through three neighbours
//! (Catmull and Rom, 1974; at the borders through the outer three). Parabolas are reproduced exactly, smooth surfaces
//! to the third power of the steps. Beyond the grid the amounts are those of its border.

use super::error::{GeometryError, finite, positive};
use super::modification::FlankRange;
use super::quantity::Quantity;

/// Material removed on a grid (m); negative for additional material.
#[derive(Clone, Debug, PartialEq)]
pub struct Topography {
    rows: usize,
    columns: usize,
    amounts: Vec<f64>,
    radii: Option<[f64; 2]>,
    heights: Option<[f64; 2]>,
}

/// Largest number of grid points along profile and width.
const MOST: usize = 1000;

impl Topography {
    /// Builds the grid from rows from the root to the tip, each from the lower to the upper end of the face (m). The
    /// first and the last row are at `radii` (m), by default the form circle and the tip; the first and the last
    /// column at `heights` from the middle of the face (m), by default its ends.
    ///
    /// # Errors
    /// [`GeometryError::Topography`] for fewer than two or more than 1000 rows or columns, rows of different lengths and
    /// amounts that are not finite.
    pub fn new(
        rows: &[Vec<f64>],
        radii: Option<[f64; 2]>,
        heights: Option<[f64; 2]>,
    ) -> Result<Self, GeometryError> {
        let refuse = |found: String, expected: &str| {
            Err(GeometryError::Topography {
                found,
                expected: expected.to_owned(),
            })
        };
        let columns = rows.first().map_or(0, Vec::len);
        for n in [rows.len(), columns] {
            if !(2..=MOST).contains(&n) {
                let found = format!("{} rows of {columns} amounts", rows.len());
                return refuse(
                    found,
                    "2 to 1000 rows over the profile of 2 to 1000 amounts",
                );
            }
        }
        if let Some(i) = rows.iter().position(|row| row.len() != columns) {
            let found = format!("{} amounts in row {}", rows[i].len(), i + 1);
            return refuse(found, &format!("{columns} as in the first row"));
        }
        let amounts: Vec<f64> = rows.iter().flatten().copied().collect();
        if amounts.iter().any(|x| !x.is_finite()) {
            return refuse("an amount that is not finite".into(), "lengths in metre");
        }
        Ok(Topography {
            rows: rows.len(),
            columns,
            amounts,
            radii,
            heights,
        })
    }

    /// Returns the numbers of rows over the profile and of columns over the width.
    pub fn size(&self) -> [usize; 2] {
        [self.rows, self.columns]
    }

    /// Returns the rows from the root to the tip, each with the amounts from the lower to the upper end of the face (m).
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.amounts.chunks(self.columns)
    }

    /// Returns the radii of the first and the last row (m), if they are not form circle and tip.
    pub fn radii(&self) -> Option<[f64; 2]> {
        self.radii
    }

    /// Returns the heights of the first and the last column from the middle of the face (m), if they are not its ends.
    pub fn heights(&self) -> Option<[f64; 2]> {
        self.heights
    }

    /// Returns the largest amount removed or left at a point of the grid (m).
    pub fn greatest(&self) -> f64 {
        self.amounts.iter().fold(0.0, |g, x| x.abs().max(g))
    }

    /// Checks that the grid lies on the flank.
    pub(super) fn check(&self, radii: [f64; 2], width: f64) -> Result<(), GeometryError> {
        let refuse =
            |found: String, expected: String| Err(GeometryError::Topography { found, expected });
        if let Some([low, high]) = self.radii {
            positive(Quantity::TopographyRadius, low)?;
            positive(Quantity::TopographyRadius, high)?;
            // A measurement may extend slightly beyond the flank that the tool generates.
            let slack = 1e-3 * (radii[1] - radii[0]);
            if low >= high || low < radii[0] - slack || high > radii[1] + slack {
                return refuse(
                    format!("rows from radius {low:.6} m to {high:.6} m"),
                    format!(
                        "the first below the last, within {:.6} m (form) and {:.6} m (tip)",
                        radii[0], radii[1]
                    ),
                );
            }
        }
        if let Some([low, high]) = self.heights {
            finite(Quantity::TopographyHeight, low)?;
            finite(Quantity::TopographyHeight, high)?;
            if low >= high || 2.0 * low.abs().max(high.abs()) > width * (1.0 + 1e-9) {
                return refuse(
                    format!("columns from {low:.6} m to {high:.6} m"),
                    format!(
                        "the first below the last, within {:.6} m of the middle of the face",
                        0.5 * width
                    ),
                );
            }
        }
        Ok(())
    }

    /// Returns the material removed (m) at length of roll `s` and `zeta` in [-1, 1] over the face width, its first and
    /// second derivative by `s` and its derivative by `zeta`.
    pub(super) fn removed(&self, s: f64, of: &FlankRange, zeta: f64) -> [f64; 4] {
        let roll = |r: f64| (r * r - of.r_base * of.r_base).max(0.0).sqrt();
        let [from, to] = self.radii.map_or([of.roll[0], of.roll[1]], |r| r.map(roll));
        let [low, high] = self.heights.unwrap_or([-of.half_width, of.half_width]);
        let (length, width) = (to - from, high - low);
        let parts = [(s - from) / length, (of.half_width * zeta - low) / width];
        let [e, by_part, bend, across] = self.at(parts);
        let by_zeta = across * of.half_width / width;
        [e, by_part / length, bend / (length * length), by_zeta]
    }

    /// Returns the amount (m) at fractions of the distance from the first to the last row and column, its first and
    /// second derivative by the former and its derivative by the latter.
    fn at(&self, parts: [f64; 2]) -> [f64; 4] {
        let (rows, along) = weights(self.rows, parts[0]);
        let (columns, across) = weights(self.columns, parts[1]);
        let sum = |along: &[f64; 4], across: &[f64; 4]| {
            let row = |i: usize| {
                let at = |j: usize| across[j] * self.amounts[i * self.columns + columns[j]];
                at(0) + at(1) + at(2) + at(3)
            };
            let part = |i: usize| along[i] * row(rows[i]);
            part(0) + part(1) + part(2) + part(3)
        };
        [
            sum(&along[0], &across[0]),
            sum(&along[1], &across[0]),
            sum(&along[2], &across[0]),
            sum(&along[0], &across[1]),
        ]
    }
}

/// Returns the four grid points around a fraction of the distance, their weights, and the first two derivatives of
/// these by the fraction.
fn weights(n: usize, part: f64) -> ([usize; 4], [[f64; 4]; 3]) {
    let steps = (n - 1) as f64;
    let x = part.clamp(0.0, 1.0) * steps;
    let i = (x as usize).min(n - 2);
    let t = x - i as f64;
    let (t2, t3) = (t * t, t * t * t);
    // Beyond the grid the amounts of its border hold.
    let inside = f64::from(u8::from((0.0..=1.0).contains(&part)));
    let (once, twice) = (inside * steps, inside * steps * steps);
    if n == 2 {
        let rise = [-once, once, 0.0, 0.0];
        return ([0, 1, 0, 0], [[1.0 - t, t, 0.0, 0.0], rise, [0.0; 4]]);
    }
    let cubic = [
        [
            0.5 * (2.0 * t2 - t3 - t),
            0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
            0.5 * (4.0 * t2 - 3.0 * t3 + t),
            0.5 * (t3 - t2),
        ],
        [
            0.5 * once * (4.0 * t - 3.0 * t2 - 1.0),
            0.5 * once * (9.0 * t2 - 10.0 * t),
            0.5 * once * (8.0 * t - 9.0 * t2 + 1.0),
            0.5 * once * (3.0 * t2 - 2.0 * t),
        ],
        [
            0.5 * twice * (4.0 - 6.0 * t),
            0.5 * twice * (18.0 * t - 10.0),
            0.5 * twice * (8.0 - 18.0 * t),
            0.5 * twice * (6.0 * t - 2.0),
        ],
    ];
    // Beyond the border the parabola through the outer three goes on: p_-1 = 3 p_0 - 3 p_1 + p_2.
    if i == 0 {
        let of = cubic.map(|[before, first, second, behind]| {
            [
                first + 3.0 * before,
                second - 3.0 * before,
                behind + before,
                0.0,
            ]
        });
        return ([0, 1, 2, 0], of);
    }
    if i == n - 2 {
        let of = cubic.map(|[before, first, second, behind]| {
            [
                before + behind,
                first - 3.0 * behind,
                second + 3.0 * behind,
                0.0,
            ]
        });
        return ([i - 1, i, i + 1, 0], of);
    }
    ([i - 1, i, i + 1, i + 2], cubic)
}

#[cfg(test)]
#[path = "topography_tests.rs"]
mod tests;
