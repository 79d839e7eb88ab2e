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

/// A force that lies along a line of a flank: by how much it moves each mode, and how much it counts.
#[derive(Clone, Debug)]
pub(super) struct Load {
    /// Shapes at the line [1/sqrt(kg)].
    pub shapes: Vec<f64>,
    /// Area of the line [m^2]; for a force that rises along it, the fraction [`RISING`] of it.
    pub weight: f64,
}

/// Weight of a force that rises from one end of a line to the other, without a mean, relative to a uniform one.
const RISING: f64 = 0.3;

/// A place on a line: along the width, area of its column, and nodes between which it lies.
type LinePoint = (f64, f64, [(u32, f64); 2]);

/// Returns the forces along the lines of contact of a flank, its generators or its rows of nodes: uniform ones, and,
/// where contact is not uniform over the width, those that rise along the line.
pub(super) fn loads(basis: &Basis, index: usize, even_over_width: bool) -> Vec<Load> {
    let grid = &basis.flanks.grids()[index];
    let areas = reference_areas(&basis.flanks, index, PointRule::Nodes);
    let flank = Flank::of(basis, grid, &areas);
    let [low, high] = flank.ends;
    let helical = (grid.nodes.iter()).any(|n| basis.normals[*n as usize].z.abs() > HELICAL);
    let node = |row: usize, column: usize| row * grid.columns + column;
    let lines: Vec<Vec<LinePoint>> = if helical && high - low >= PLANE {
        let lines = PER_ROW * grid.rows;
        let on_line = |line: usize| {
            let at = low + (line as f64 + 0.5) / lines as f64 * (high - low);
            let columns = (0..grid.columns).filter_map(|column| {
                let (row, place) = flank.crossing(at, column)?;
                let [a, b] = [node(row, column), node(row + 1, column)];
                let parts = [(grid.nodes[a], 1.0 - place), (grid.nodes[b], place)];
                let area = flank.widths[column] / lines as f64;
                Some((grid.positions[a].z, area, parts))
            });
            columns.collect()
        };
        (0..lines).map(on_line).collect()
    } else {
        let in_row = |row: usize| {
            let columns = (0..grid.columns).map(|column| {
                let i = node(row, column);
                let parts = [(grid.nodes[i], 1.0), (grid.nodes[i], 0.0)];
                (grid.positions[i].z, areas[i], parts)
            });
            columns.collect()
        };
        (0..grid.rows).map(in_row).collect()
    };
    let mut loads = Vec::new();
    for line in lines {
        let area: f64 = line.iter().map(|p| p.1).sum();
        if area <= 0.0 {
            continue;
        }
        loads.push(Load {
            shapes: moved(basis, &line, |_, part| part / area),
            weight: area,
        });
        let middle = line.iter().map(|(z, a, _)| z * a).sum::<f64>() / area;
        let spread: f64 = line.iter().map(|(z, a, _)| a * (z - middle).powi(2)).sum();
        if !even_over_width && spread > 0.0 {
            let scale = (spread * area).sqrt();
            loads.push(Load {
                shapes: moved(basis, &line, |z, part| part * (z - middle) / scale),
                weight: RISING * area,
            });
        }
    }
    loads
}

/// How a force along a line, given by place and area, moves the modes.
fn moved(basis: &Basis, line: &[LinePoint], force: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let mut out = vec![0.0; basis.omega.len()];
    for (z, area, parts) in line {
        let force = force(*z, *area);
        for (node, part) in parts {
            for (x, b) in out.iter_mut().zip(basis.shapes_at(*node)) {
                *x += force * part * b;
            }
        }
    }
    out
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
