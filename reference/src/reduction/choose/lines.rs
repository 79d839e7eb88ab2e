//! Shapes averaged along the lines of contact of helical flanks.
//!
//! A line of contact of two involute helicoids is a generator of both: a straight line along which the normal is constant (F.
//! L. Litvin, A. Fuentes, *Gear Geometry and Applied Theory*, 2nd ed. 2004, ch. 14). So the direction of the normal in the
//! transverse plane numbers the lines of a flank, and a force that lies along one of them moves a mode by the mean of its
//! shape there: what is odd along the line does not count, on helical flanks as over the width of spur ones.

use super::Basis;
use gearbench_models::contact::points::reference_areas;
use gearbench_models::geometry::FlankGrid;
use gearbench_models::spec::PointRule;

/// Lines for each row of nodes.
const PER_ROW: usize = 3;

/// Part of a normal along the axis from which on a flank is helical.
const HELICAL: f64 = 0.02;

/// Turn of the normals over a flank below which they number no lines [rad]: that of a rack is plane.
const PLANE: f64 = 1e-3;

/// Squares of the means of the shapes of all modes along lines of contact, times their lengths, and the sum of these; `None`
/// for flanks that are not those of helical gears.
pub(super) fn means(basis: &Basis) -> Option<(Vec<f64>, f64)> {
    let helical = basis.normals.iter().any(|n| n.z.abs() > HELICAL);
    if !helical {
        return None;
    }
    let mut sums = vec![0.0; basis.omega.len()];
    let mut total = 0.0;
    let mut mean = sums.clone();
    for (index, grid) in basis.flanks.grids().iter().enumerate() {
        let flank = Flank::of(
            basis,
            grid,
            &reference_areas(&basis.flanks, index, PointRule::Nodes),
        );
        let [low, high] = flank.ends;
        if high - low < PLANE {
            return None;
        }
        let lines = PER_ROW * grid.rows;
        for line in 0..lines {
            let at = low + (line as f64 + 0.5) / lines as f64 * (high - low);
            mean.fill(0.0);
            let mut length = 0.0;
            for column in 0..grid.columns {
                let Some((row, place)) = flank.crossing(at, column) else {
                    continue;
                };
                let width = flank.widths[column];
                length += width;
                for (row, part) in [(row, 1.0 - place), (row + 1, place)] {
                    let shapes = basis.shapes_at(grid.nodes[row * grid.columns + column]);
                    for (m, b) in mean.iter_mut().zip(shapes) {
                        *m += part * width * b;
                    }
                }
            }
            if length > 0.0 {
                for (s, m) in sums.iter_mut().zip(&mean) {
                    *s += m * m / length;
                }
                total += length;
            }
        }
    }
    Some((sums, total))
}

/// Directions of the normals of a flank.
struct Flank {
    rows: usize,
    columns: usize,
    /// By row, then column, from that in the middle [rad].
    angles: Vec<f64>,
    ends: [f64; 2],
    /// Areas of the columns of nodes [m^2].
    widths: Vec<f64>,
}

impl Flank {
    fn of(basis: &Basis, grid: &FlankGrid, areas: &[f64]) -> Self {
        let (rows, columns) = (grid.rows, grid.columns);
        let normal = |i: usize| &basis.normals[grid.nodes[i] as usize];
        let middle = normal(rows / 2 * columns + columns / 2);
        let angle = |i: usize| {
            let n = normal(i);
            let (across, along) = (
                middle.x * n.y - middle.y * n.x,
                middle.x * n.x + middle.y * n.y,
            );
            across.atan2(along)
        };
        let angles: Vec<f64> = (0..rows * columns).map(angle).collect();
        let ends = angles
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |e, a| {
                [e[0].min(*a), e[1].max(*a)]
            });
        let width = |c: usize| (0..rows).map(|r| areas[r * columns + c]).sum();
        Flank {
            rows,
            columns,
            angles,
            ends,
            widths: (0..columns).map(width).collect(),
        }
    }

    /// Where a line crosses a column of nodes: the row below, and the place from it to the next.
    fn crossing(&self, at: f64, column: usize) -> Option<(usize, f64)> {
        let of_row = |row: usize| self.angles[row * self.columns + column];
        (1..self.rows).find_map(|row| {
            let [a, b] = [of_row(row - 1), of_row(row)];
            let between = (a - at) * (b - at) <= 0.0 && a != b;
            between.then(|| (row - 1, (at - a) / (b - a)))
        })
    }
}
