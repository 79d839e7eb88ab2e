//! Flanks as lines: the interface of a reduction to contact with one pressure line per tooth pair and strip of the
//! width.
//!
//! A line of nodes is the mean of the columns of a strip, each with the width that it stands for, so that a load on it is
//! spread evenly over the width of the strip. Between four lines along the profile a contact at a place `x` of an element
//! acts by cubic B-splines,
//!
//! ```text
//! w = ((1-x)^3, 4 - 6 x^2 + 3 x^3, 1 + 3 x + 3 x^2 - 3 x^3, x^3)/6
//! ```
//!
//! with `u_-1 = 2 u_0 - u_1` beyond the ends: spread to two nodes, a load that passes from element to element would make
//! the mesh yield more and less (C. de Boor, *A Practical Guide to Splines* (1978), for the splines).
//!
//! Where the mesh is finer along the profile than 16 elements, lines of twice the distance stand for it,
//! `v_j = (u_2j-2 + 4 u_2j-1 + 6 u_2j + 4 u_2j+1 + u_2j+2)/16`: B-splines of twice the width are made of these. So the load
//! is always spread wider than a contact is, and [`HalfSpace`](crate::law::HalfSpace) gives the difference.

use super::reduced::{FlankCompliance, Reduced, Residual};
use crate::Vec3;
use crate::error::Reason;
use crate::geometry::{FlankGrid, Flanks};
use std::sync::Arc;

/// Largest number of elements along a flank for which the lines are those of the mesh.
const FINEST: usize = 16;

/// Smallest number of lines along a flank.
const LEAST: usize = 4;

/// Division of the face width into strips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strips {
    /// One strip for each layer of elements.
    Layers,
    /// A number of strips with equal numbers of layers.
    Count(usize),
}

/// Weights of the four lines around a position in an element, with their slopes by the position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Index of the first of the four lines.
    pub first: usize,
    /// Weights of the four lines.
    pub weights: [f64; 4],
    /// Derivatives of the weights by the position in the element.
    pub slopes: [f64; 4],
}

/// Computes the weights for a contact in element `element` of `lines - 1`, at the position `x`, 0 to 1 within it.
#[inline]
pub fn spread(element: usize, x: f64, lines: usize) -> Spread {
    let r = 1.0 - x;
    let mut weights = [
        r * r * r / 6.0,
        (4.0 + x * x * (3.0 * x - 6.0)) / 6.0,
        (4.0 + r * r * (3.0 * r - 6.0)) / 6.0,
        x * x * x / 6.0,
    ];
    let mut slopes = [
        -0.5 * r * r,
        x * (1.5 * x - 2.0),
        r * (2.0 - 1.5 * r),
        0.5 * x * x,
    ];
    let mut first = element.wrapping_sub(1);
    if element == 0 {
        // The line before the first is 2 u_0 - u_1.
        first = 0;
        weights = before_first(weights);
        slopes = before_first(slopes);
    } else if element + 2 == lines {
        first = lines - LEAST;
        weights = behind_last(weights);
        slopes = behind_last(slopes);
    }
    Spread {
        first,
        weights,
        slopes,
    }
}

fn before_first([w, a, b, c]: [f64; 4]) -> [f64; 4] {
    [a + 2.0 * w, b - w, c, 0.0]
}

fn behind_last([a, b, c, w]: [f64; 4]) -> [f64; 4] {
    [0.0, a, b - w, c + 2.0 * w]
}

/// Weighted sum of nodes or rows of a mesh: their numbers and weights.
pub type Sum = Vec<(usize, f64)>;

/// Returns the lines of a flank with a number of rows of nodes.
fn lines_of(rows: usize) -> Vec<Sum> {
    let mut lines: Vec<Sum> = (0..rows).map(|r| vec![(r, 1.0)]).collect();
    while lines.len() > FINEST + 1 && lines.len() % 2 == 1 {
        let last = lines.len() as i64 - 1;
        // Beyond the ends lines go on straight.
        let line = |j: i64| -> Sum {
            let (end, next, beyond) = if j < 0 {
                (0, 1, -j)
            } else if j > last {
                (last, last - 1, j - last)
            } else {
                return lines[j as usize].clone();
            };
            let times = |line: &Sum, by: f64| -> Sum {
                line.iter().map(|(row, w)| (*row, by * w)).collect()
            };
            let beyond = beyond as f64;
            let mut sum = times(&lines[end as usize], 1.0 + beyond);
            sum.extend(times(&lines[next as usize], -beyond));
            sum
        };
        lines = (0..=last / 2)
            .map(|j| {
                let mut of_row = vec![0.0; rows];
                for (offset, part) in (-2..=2).zip([1.0, 4.0, 6.0, 4.0, 1.0]) {
                    for (row, w) in line(2 * j + offset) {
                        of_row[row] += part / 16.0 * w;
                    }
                }
                let terms = of_row.into_iter().enumerate();
                terms.filter(|(_, w)| *w != 0.0).collect()
            })
            .collect();
    }
    lines
}

/// Lines of all flanks of a mesh.
#[derive(Clone, Debug)]
pub struct LinesOfFlanks {
    /// Flanks whose nodes are the lines.
    pub flanks: Flanks,
    /// Each line as a sum of the flank nodes of the mesh.
    pub sums: Vec<Sum>,
    /// Displacement of the lines under line loads from the mesh near a flank, as [`Reduced::near_field`].
    pub near_field: Arc<Vec<Vec<f64>>>,
}

impl LinesOfFlanks {
    /// Builds the lines of flanks over strips of the width; `near_field` is that of the rows of each flank.
    ///
    /// # Errors
    /// Too few rows along a flank, strips that do not fit the layers of elements over the width.
    pub fn new(flanks: &Flanks, near_field: &[Vec<f64>], strips: Strips) -> Result<Self, Reason> {
        let mut grids = Vec::new();
        let mut sums: Vec<Sum> = Vec::new();
        let mut fields = Vec::new();
        for (grid, of_rows) in flanks.grids().iter().zip(near_field) {
            let lines = lines_of(grid.rows);
            if lines.len() < LEAST {
                return Err((
                    format!(
                        "half-space contact needs {LEAST} rows of nodes along a flank, but there are {}",
                        lines.len()
                    ),
                    "mesh the flanks with at least 3 elements along the profile, 8 are usual",
                )
                    .into());
            }
            let layers = grid.columns - 1;
            let strips = match strips {
                Strips::Layers => layers,
                Strips::Count(n) => n,
            };
            if strips == 0 || layers % strips != 0 {
                return Err((
                    format!(
                        "the contact has {strips} slices, but the flanks have {layers} layers of elements over the width"
                    ),
                    "use a number of layers that is a multiple of the slices",
                )
                    .into());
            }
            let of_strip = layers / strips;
            let first = sums.len() as u32;
            let mut positions = Vec::new();
            for line in &lines {
                for strip in 0..strips {
                    let mut x = Vec3::zeros();
                    let mut sum = Vec::new();
                    for (row, w) in line {
                        for i in 0..=of_strip {
                            let edge = i == 0 || i == of_strip;
                            let w = w / of_strip as f64 * if edge { 0.5 } else { 1.0 };
                            let place = row * grid.columns + strip * of_strip + i;
                            x += w * grid.positions[place];
                            sum.push((grid.nodes[place] as usize, w));
                        }
                    }
                    positions.push(x);
                    sums.push(sum);
                }
            }
            fields.push(congruence(of_rows, &lines));
            grids.push(FlankGrid {
                rows: lines.len(),
                columns: strips,
                nodes: (first..sums.len() as u32).collect(),
                positions,
                ..grid.clone()
            });
        }
        Ok(LinesOfFlanks {
            flanks: Flanks::new(grids),
            sums,
            near_field: Arc::new(fields),
        })
    }
}

impl Reduced {
    /// Returns the gear with lines over strips of the width in place of its flank nodes.
    ///
    /// # Errors
    /// What is missing: the compliance of the modes that were cut, what the mesh does to a line load, rows along the
    /// flank.
    pub fn over_lines(&self, strips: Strips) -> Result<Reduced, Reason> {
        let Some(residual) = &self.residual else {
            return Err((
                "half-space contact needs the static compliance of the whole mesh, but the residual compliance of the truncated modes is switched off",
                "remove `residual = false`",
            )
                .into());
        };
        let Some(near_field) = &self.near_field else {
            return Err((
                "half-space contact needs the response of the mesh to a line load, which the reduction does not contain",
                "repeat the reduction, `gearbench reduce`, with a mesh with straight teeth or of hexahedra with eight nodes",
            )
                .into());
        };
        let lines = LinesOfFlanks::new(&self.flanks, near_field, strips)?;
        let per_node = self.per_node();
        // Rows of the shapes: of a node outwards, then along the profile.
        let row_sums: Vec<Sum> = (lines.sums.iter())
            .flat_map(|sum| {
                (0..per_node).map(move |d| {
                    let of_direction = |(node, w): &(usize, f64)| (node * per_node + d, *w);
                    sum.iter().map(of_direction).collect()
                })
            })
            .collect();
        let modes = self.modes();
        let normals = (lines.sums.iter())
            .map(|sum| {
                let terms = sum.iter().map(|(node, w)| *w * self.normals[*node]);
                terms.fold(Vec3::zeros(), |sum, n| sum + n).normalize()
            })
            .collect();
        Ok(Reduced {
            flanks: lines.flanks,
            normals,
            shapes: rows_of_sums(&self.shapes, modes, &row_sums),
            residual: Some(Residual {
                flanks: over(&residual.flanks, &row_sums),
                hub: rows_of_sums(&residual.hub, 1, &row_sums),
                hub_hub: residual.hub_hub,
            }),
            near_field: Some(lines.near_field),
            ..self.clone()
        })
    }
}

/// Computes `L A` for a matrix with rows of a number of columns: sums of its rows.
pub(super) fn rows_of_sums(a: &[f64], columns: usize, sums: &[Sum]) -> Vec<f64> {
    let mut out = vec![0.0; sums.len() * columns];
    for (out, sum) in out.chunks_exact_mut(columns.max(1)).zip(sums) {
        for &(row, w) in sum {
            for (x, a) in out.iter_mut().zip(&a[row * columns..][..columns]) {
                *x += w * a;
            }
        }
    }
    out
}

/// Computes `L A L^T` for a square matrix.
fn congruence(a: &[f64], sums: &[Sum]) -> Vec<f64> {
    let n = a.len().isqrt();
    let left = rows_of_sums(a, n, sums);
    let mut out = Vec::with_capacity(sums.len() * sums.len());
    for of_sum in left.chunks_exact(n.max(1)) {
        for sum in sums {
            out.push(sum.iter().map(|(row, w)| w * of_sum[*row]).sum());
        }
    }
    out
}

/// Returns the compliance between sums of rows.
fn over(of_rows: &FlankCompliance, sums: &[Sum]) -> FlankCompliance {
    match of_rows {
        FlankCompliance::Full(c) => FlankCompliance::Full(congruence(c, sums)),
        FlankCompliance::Cyclic {
            teeth,
            per_tooth: m,
            blocks,
        } => {
            let per_tooth = sums.len() / teeth;
            let of_tooth = &sums[..per_tooth];
            FlankCompliance::Cyclic {
                teeth: *teeth,
                per_tooth,
                blocks: (blocks.chunks_exact(m * m))
                    .flat_map(|block| congruence(block, of_tooth))
                    .collect(),
            }
        }
        FlankCompliance::Deflated(c) => {
            FlankCompliance::Deflated(Box::new(c.over(sums, |whole| over(whole, sums))))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A displacement that is linear along the flank is reproduced exactly, at both ends too, and slopes are
    /// derivatives.
    #[test]
    fn splines_carry_what_is_linear() {
        for lines in [4, 5, 9, 13] {
            for element in 0..lines - 1 {
                for x in [0.0, 0.2, 0.7, 1.0] {
                    let s = spread(element, x, lines);
                    let sum: f64 = s.weights.iter().sum();
                    let place = (0..4).map(|i| (s.first + i) as f64 * s.weights[i]);
                    assert!((sum - 1.0).abs() < 1e-14);
                    let place: f64 = place.sum();
                    assert!((place - element as f64 - x).abs() < 1e-13, "{element} {x}");
                    let h = 1e-6;
                    let [a, b] = [x - h, x + h].map(|x| spread(element, x, lines).weights);
                    for i in 0..4 {
                        let difference = (b[i] - a[i]) / (2.0 * h);
                        assert!((difference - s.slopes[i]).abs() < 1e-8);
                    }
                }
            }
        }
    }

    /// Lines of a fine mesh are at every second row, and the weights between them extend over four rows.
    #[test]
    fn lines_of_fine_meshes_make_wider_splines() {
        let rows = 25;
        let lines = lines_of(rows);
        assert_eq!(lines.len(), 13);
        for (j, line) in lines.iter().enumerate() {
            let sum: f64 = line.iter().map(|t| t.1).sum();
            let place: f64 = line.iter().map(|t| t.0 as f64 * t.1).sum();
            assert!((sum - 1.0).abs() < 1e-14 && (place - 2.0 * j as f64).abs() < 1e-13);
        }
        let on_rows = |element: usize, x: f64| {
            let s = spread(element, x, lines.len());
            let mut out = vec![0.0; rows];
            for i in 0..4 {
                for (row, w) in &lines[s.first + i] {
                    out[*row] += s.weights[i] * w;
                }
            }
            out
        };
        let at = on_rows(6, 0.0);
        let sum: f64 = at.iter().sum();
        assert!((sum - 1.0).abs() < 1e-14);
        // Symmetric about row 12, and nothing outside of eight rows.
        for k in 0..=12 {
            assert!((at[12 - k] - at[12 + k]).abs() < 1e-15);
            assert!(k <= 4 || at[12 + k] == 0.0);
        }
    }
}
