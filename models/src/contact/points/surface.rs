//! Surface of one flank: its reference shape, its points, and its faces in the deformed state.
//!
//! ```text
//! X(a, b) = sum_i N_i(a, b) x_i + R B(a, b)
//! ```
//!
//! `x_i` the deformed corners of the face, `N_i` bilinear, `R` the turn of the gear's own frame, `B` what the
//! splines through the undeformed nodes rise above the bilinear face: zero at the nodes and for faceted
//! surfaces. Between the rows and columns `B` is the bilinearly blended patch of its four edge curves
//! (S. A. Coons, MIT MAC-TR-41, 1967). `a`, `b` run from 0 to 1, `xi = 2 (a, b) - 1`.

use super::cone::Cone;
use super::rule::{FlankPoint, Rule};
use super::spline::{bulge, bulges, chord_bound};
use crate::Vec3;
use crate::geometry::{FlankGrid, Flanks, Side, Tips};
use crate::kinematics::Pose;
use crate::spec::{PointRule, SurfaceKind};

/// Reference shape of a flank in the frame of its gear.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub tooth: u32,
    pub side: Side,
    pub rows: usize,
    pub columns: usize,
    /// Node numbers of the gear, row by row.
    pub nodes: Vec<u32>,
    /// Undeformed nodes in the own frame, row by row [m].
    pub positions: Vec<Vec3>,
    /// Bulges of the chords along the profile, `row * columns + column`; empty for faceted surfaces.
    profile: Vec<[Vec3; 2]>,
    /// Bulges of the chords over the width, `row * (columns - 1) + column`; empty for faceted surfaces.
    width: Vec<[Vec3; 2]>,
    /// Height of each row as [`Tips`] measures it, ascending to the tip; on a cone, moved along it to the middle of
    /// the face.
    pub heights: Vec<f64>,
    /// Radii along the axis of a conical gear.
    pub cone: Option<Cone>,
    /// Height z of each column [m].
    pub z: Vec<f64>,
    /// Length of the faces along the profile of each row [m].
    pub lengths: Vec<f64>,
    /// Largest distance of the flank from the plane of a face of each row within the neighbouring rows [m].
    pub chord_bound: Vec<f64>,
    /// Reference area of each point [m^2], in the order of [`Shape::points`]; ones for nodes with unit areas.
    pub areas: Vec<f64>,
    first_face: u32,
}

impl Shape {
    /// Builds the shape of grid `g` of `flanks`; `tips` defines the heights.
    pub fn new(flanks: &Flanks, g: usize, kind: SurfaceKind, rule: &Rule, tips: Tips) -> Self {
        let FlankGrid {
            tooth,
            side,
            rows,
            columns,
            ref nodes,
            ref positions,
        } = flanks.grids()[g];
        let at = |r: usize, c: usize| positions[r * columns + c];
        let (mut profile, mut width) = (vec![], vec![]);
        if kind == SurfaceKind::Smooth {
            profile = vec![[Vec3::zeros(); 2]; (rows - 1) * columns];
            for c in 0..columns {
                let line: Vec<Vec3> = (0..rows).map(|r| at(r, c)).collect();
                for (r, e) in bulges(&line).into_iter().enumerate() {
                    profile[r * columns + c] = e;
                }
            }
            if columns > 2 {
                for r in 0..rows {
                    let line: Vec<Vec3> = (0..columns).map(|c| at(r, c)).collect();
                    width.extend(bulges(&line));
                }
            }
        }
        let (mid_row, mid_column) = (rows / 2, columns / 2);
        let height = |x: Vec3| tips.height([x.x, x.y]);
        let mut shape = Shape {
            tooth,
            side,
            rows,
            columns,
            nodes: nodes.clone(),
            heights: (0..rows).map(|r| height(at(r, mid_column))).collect(),
            z: (0..columns).map(|c| at(mid_row, c).z).collect(),
            lengths: (0..rows - 1)
                .map(|r| (at(r + 1, mid_column) - at(r, mid_column)).norm())
                .collect(),
            chord_bound: chord_bound(&(0..rows).map(|r| at(r, mid_column)).collect::<Vec<_>>()),
            positions: positions.clone(),
            cone: None,
            profile,
            width,
            areas: vec![],
            first_face: flanks.face(g, 0, 0),
        };
        shape.measure(rule);
        shape
    }

    /// Computes the areas of all points.
    fn measure(&mut self, rule: &Rule) {
        let still = Pose::STILL;
        let element = |row: usize, column: usize, a: f64, b: f64| {
            let s = self
                .face(&self.positions, &still, row, column)
                .eval(self, a, b);
            s.along.cross(&s.across).norm()
        };
        let areas = if rule.alike {
            vec![1.0; self.rows * self.columns]
        } else if rule.is_nodes() {
            let mut areas = vec![0.0; self.rows * self.columns];
            let gauss = Rule::new(PointRule::Quadrature {
                along: 3,
                across: 3,
            });
            for row in 0..self.rows - 1 {
                for column in 0..self.columns - 1 {
                    for &(a, wa) in &gauss.along {
                        for &(b, wb) in &gauss.across {
                            let area = wa * wb * element(row, column, a, b);
                            let n = Flanks::weights([2.0 * a - 1.0, 2.0 * b - 1.0]);
                            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
                            for ((r, c), n) in corners.into_iter().zip(n) {
                                areas[(row + r) * self.columns + column + c] += n * area;
                            }
                        }
                    }
                }
            }
            areas
        } else {
            let mut areas = vec![];
            for row in 0..self.rows - 1 {
                for column in 0..self.columns - 1 {
                    for &(a, wa) in &rule.along {
                        for &(b, wb) in &rule.across {
                            areas.push(wa * wb * element(row, column, a, b));
                        }
                    }
                }
            }
            areas
        };
        self.areas = areas;
    }

    /// Returns the outward unit normals at the nodes, row by row.
    pub fn nodal_normals(&self) -> Vec<Vec3> {
        let still = Pose::STILL;
        (0..self.rows * self.columns)
            .map(|i| {
                let (r, c) = (i / self.columns, i % self.columns);
                let (row, column) = (r.min(self.rows - 2), c.min(self.columns - 2));
                let face = self.face(&self.positions, &still, row, column);
                let s = face.eval(self, (r - row) as f64, (c - column) as f64);
                self.side.sign() * s.across.cross(&s.along).normalize()
            })
            .collect()
    }

    /// Calls `f` for each point of the faces with `keep(row, column)`, row by row.
    #[inline]
    pub fn points(
        &self,
        rule: &Rule,
        keep: impl Fn(usize, usize) -> bool,
        mut f: impl FnMut(FlankPoint),
    ) {
        if rule.is_nodes() {
            for r in 0..self.rows {
                let row = r.min(self.rows - 2);
                let length = 0.5 * (self.lengths[row] + self.lengths[r.saturating_sub(1)]);
                for c in 0..self.columns {
                    let column = c.min(self.columns - 2);
                    if keep(row, column) {
                        f(FlankPoint {
                            row,
                            column,
                            a: (r - row) as f64,
                            b: (c - column) as f64,
                            area: self.areas[r * self.columns + c],
                            length,
                        });
                    }
                }
            }
            return;
        }
        let per_face = rule.along.len() * rule.across.len();
        for row in 0..self.rows - 1 {
            for column in 0..self.columns - 1 {
                if !keep(row, column) {
                    continue;
                }
                let first = (row * (self.columns - 1) + column) * per_face;
                let mut areas = self.areas[first..][..per_face].iter();
                for &(a, wa) in &rule.along {
                    let length = wa * self.lengths[row];
                    for (&(b, _), &area) in rule.across.iter().zip(&mut areas) {
                        f(FlankPoint {
                            row,
                            column,
                            a,
                            b,
                            area,
                            length,
                        });
                    }
                }
            }
        }
    }

    /// Returns true if the faces are bilinear facets.
    #[inline]
    pub fn is_faceted(&self) -> bool {
        self.profile.is_empty()
    }

    /// Returns the number of a face among all faces of the gear.
    #[inline]
    pub fn face_number(&self, row: usize, column: usize) -> u32 {
        self.first_face + (row * (self.columns - 1) + column) as u32
    }

    /// Returns the node numbers at the corners of a face, as in [`Flanks::corners`].
    #[inline]
    pub fn corners(&self, row: usize, column: usize) -> [u32; 4] {
        let i = row * self.columns + column;
        let n = self.columns;
        [
            self.nodes[i],
            self.nodes[i + n],
            self.nodes[i + n + 1],
            self.nodes[i + 1],
        ]
    }

    /// Returns a face in the deformed state: `x` has the positions of the nodes of the flank, `pose` is the frame of
    /// the gear.
    #[inline]
    pub fn face<'a>(&self, x: &[Vec3], pose: &'a Pose, row: usize, column: usize) -> Face<'a> {
        let i = row * self.columns + column;
        let (x00, x10) = (x[i], x[i + self.columns]);
        let (x01, x11) = (x[i + 1], x[i + self.columns + 1]);
        Face {
            row,
            column,
            pose,
            origin: x00,
            along: x10 - x00,
            across: x01 - x00,
            twist: x11 - x10 - x01 + x00,
        }
    }

    /// Returns a point of the undeformed surface in the gear frame.
    pub fn undeformed(&self, row: usize, column: usize, [a, b]: [f64; 2]) -> Vec3 {
        let still = Pose::STILL;
        (self.face(&self.positions, &still, row, column)).position(self, a, b)
    }

    /// Returns the column whose strip contains a `z`, and the position in it, from 0 to 1 (beyond, outside the flank).
    #[inline]
    pub fn column_at(&self, z: f64) -> (usize, f64) {
        let mut column = 0;
        while column + 2 < self.columns && z > self.z[column + 1] {
            column += 1;
        }
        let (low, high) = (self.z[column], self.z[column + 1]);
        (column, (z - low) / (high - low))
    }

    /// Returns the row whose strip contains a height at a position over the width, [`Shape::column_at`], and the
    /// position in it, from 0 to 1 (beyond, outside the flank).
    #[inline]
    pub fn row_at(&self, height: f64, (column, b): (usize, f64)) -> (usize, f64) {
        if let Some(cone) = &self.cone {
            return cone.row_at(height, (column, b));
        }
        let h = &self.heights;
        let above = h.partition_point(|x| *x <= height);
        let row = above.saturating_sub(1).min(h.len() - 2);
        (row, (height - h[row]) / (h[row + 1] - h[row]))
    }
}

/// A face of a flank in the deformed state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face<'a> {
    pub row: usize,
    pub column: usize,
    pose: &'a Pose,
    origin: Vec3,
    along: Vec3,
    across: Vec3,
    twist: Vec3,
}

/// A point of a face with its derivatives by `a` and `b`.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePoint {
    pub x: Vec3,
    pub along: Vec3,
    pub across: Vec3,
    /// Second derivatives: along twice, mixed, across twice.
    pub bend: [Vec3; 3],
}

impl Face<'_> {
    /// Computes position, tangents and second derivatives.
    #[inline]
    pub fn eval(&self, shape: &Shape, a: f64, b: f64) -> SurfacePoint {
        let mut spot = SurfacePoint {
            x: self.origin + a * self.along + b * (self.across + a * self.twist),
            along: self.along + b * self.twist,
            across: self.across + a * self.twist,
            bend: [Vec3::zeros(), self.twist, Vec3::zeros()],
        };
        if shape.profile.is_empty() {
            return spot;
        }
        let p = self.row * shape.columns + self.column;
        let near = bulge(&shape.profile[p], a);
        let far = bulge(&shape.profile[p + 1], a);
        let mut value = near[0] + b * (far[0] - near[0]);
        let mut along = near[1] + b * (far[1] - near[1]);
        let mut across = far[0] - near[0];
        let mut bend = [
            near[2] + b * (far[2] - near[2]),
            far[1] - near[1],
            Vec3::zeros(),
        ];
        if !shape.width.is_empty() {
            let w = self.row * (shape.columns - 1) + self.column;
            let below = bulge(&shape.width[w], b);
            let above = bulge(&shape.width[w + shape.columns - 1], b);
            value += below[0] + a * (above[0] - below[0]);
            along += above[0] - below[0];
            across += below[1] + a * (above[1] - below[1]);
            bend[1] += above[1] - below[1];
            bend[2] = below[2] + a * (above[2] - below[2]);
        }
        spot.x += self.pose.turn(&value);
        spot.along += self.pose.turn(&along);
        spot.across += self.pose.turn(&across);
        for (sum, b) in spot.bend.iter_mut().zip(&bend) {
            *sum += self.pose.turn(b);
        }
        spot
    }

    /// Computes the position.
    #[inline]
    pub fn position(&self, shape: &Shape, a: f64, b: f64) -> Vec3 {
        let mut x = self.origin + a * self.along + b * (self.across + a * self.twist);
        if shape.profile.is_empty() {
            return x;
        }
        let p = self.row * shape.columns + self.column;
        let near = bulge(&shape.profile[p], a)[0];
        let far = bulge(&shape.profile[p + 1], a)[0];
        let mut value = near + b * (far - near);
        if !shape.width.is_empty() {
            let w = self.row * (shape.columns - 1) + self.column;
            let below = bulge(&shape.width[w], b)[0];
            let above = bulge(&shape.width[w + shape.columns - 1], b)[0];
            value += below + a * (above - below);
        }
        x += self.pose.turn(&value);
        x
    }

    /// Returns the distance of a point from the plane through the face, outwards of the tooth [m].
    #[inline]
    pub fn height_over(&self, side: Side, x: &Vec3) -> f64 {
        // Left: across x along points outwards.
        let n = self.across.cross(&self.along);
        let middle = self.origin + 0.5 * (self.along + self.across) + 0.25 * self.twist;
        side.sign() * n.dot(&(x - middle)) / n.norm()
    }
}
