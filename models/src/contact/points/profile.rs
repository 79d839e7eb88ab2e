//! Flanks that are equal in every transverse plane: a profile in two dimensions, and projections on it.
//!
//! The profile is a chain of cubics `p(a) = c_0 + c_1 a + c_2 a^2 + c_3 a^3` from row to row, in the gear frame;
//! facets are the linear case. The closest point solves `p' . (x - p) = 0`. As for [projections on
//! surfaces](super::projection), beyond an edge the neighbouring face is searched, and between two facets that both
//! refer a point to the other the closest point is their common edge.

use super::chords::{Bulge, Chord, chords, on_curve};
use super::projection::{BEYOND_TIP, NEAR_EDGE, OVERLAP, RIM};
use super::rule::Rule;
use super::surface::Shape;
use crate::geometry::{Side, Tips};

/// A point or direction in the transverse plane.
pub(super) type Vec2 = nalgebra::Vector2<f64>;

/// Transverse distance [m] within which the nodes of a row coincide.
const ONE: f64 = 1e-12;
/// Newton step on a face [1] at which the search of the closest point ends: the remaining error is of the order of its
/// square.
const CLOSE: f64 = 1e-4;
/// Newton step at which a projection ends that serves as an initial guess only.
pub(super) const NEARLY: f64 = 1e-2;
/// Largest number of Newton iterations on a face.
const ITERATIONS: usize = 20;
/// Profile of a flank from the root to the tip.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    side: Side,
    tips: Tips,
    faceted: bool,
    /// Polynomial coefficients of each face.
    curves: Vec<[Vec2; 4]>,
    chords: Vec<Chord>,
    bulges: Vec<Bulge>,
    /// Height of each node.
    heights: Vec<f64>,
    /// Reciprocal differences of the heights.
    per_height: Vec<f64>,
    /// Nodes of the profile.
    pub knots: Vec<Vec2>,
    /// Points of each face along the profile; for the rule at nodes, the nodes.
    pub points: Vec<Vec2>,
}

/// Projection of a point on a profile.
#[derive(Clone, Copy, Debug)]
pub(super) struct ProfileProjection {
    pub row: usize,
    /// Position on the face, 0 to 1 within it.
    pub a: f64,
    /// Unit normal, out of the tooth.
    pub normal: Vec2,
    /// Distance along the normal [m], positive outside.
    pub gap: f64,
    /// Derivative of the position by a displacement of the point [1/m].
    pub sensitivity: Vec2,
}

impl Profile {
    /// Returns the profile of a shape, if all its transverse planes are equal.
    pub fn new(shape: &Shape, rule: &Rule, tips: Tips) -> Option<Self> {
        let flat = |row: usize, column: usize, place| shape.undeformed(row, column, place).xy();
        let same = |a: Vec2, b: Vec2| (a - b).norm() < ONE;
        for row in 0..shape.rows - 1 {
            for a in [0.0, 0.5, 1.0] {
                let first = flat(row, 0, [a, 0.0]);
                for column in 0..shape.columns - 1 {
                    let others = [0.0, 0.5, 1.0].map(|b| flat(row, column, [a, b]));
                    if !others.into_iter().all(|x| same(x, first)) {
                        return None;
                    }
                }
            }
        }
        Some(Self::of(shape, rule, tips, |row, a| flat(row, 0, [a, 0.0])))
    }

    /// Returns the profile of a shape through the points `at(row, a)` of each face.
    pub fn of(
        shape: &Shape,
        rule: &Rule,
        tips: Tips,
        at: impl Fn(usize, f64) -> Vec2 + Copy,
    ) -> Self {
        let mut knots: Vec<Vec2> = (0..shape.rows - 1).map(|r| at(r, 0.0)).collect();
        knots.push(at(shape.rows - 2, 1.0));
        let faceted = shape.is_faceted();
        let curves: Vec<[Vec2; 4]> = (0..shape.rows - 1)
            .map(|row| {
                // A cubic through four places is that of the spline.
                let x = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|a| at(row, a));
                if faceted {
                    return [x[0], x[3] - x[0], Vec2::zeros(), Vec2::zeros()];
                }
                [
                    x[0],
                    -5.5 * x[0] + 9.0 * x[1] - 4.5 * x[2] + x[3],
                    9.0 * x[0] - 22.5 * x[1] + 18.0 * x[2] - 4.5 * x[3],
                    -4.5 * x[0] + 13.5 * x[1] - 13.5 * x[2] + 4.5 * x[3],
                ]
            })
            .collect();
        let (chords, bulges) = chords(shape.side, &knots, &curves);
        let points = if rule.is_nodes() {
            knots.clone()
        } else {
            let faces = 0..shape.rows - 1;
            let of_face = |row| rule.along.iter().map(move |&(a, _)| (row, a));
            faces.flat_map(of_face).map(|(row, a)| at(row, a)).collect()
        };
        Profile {
            side: shape.side,
            tips,
            faceted,
            per_height: shape
                .heights
                .windows(2)
                .map(|h| (h[1] - h[0]).recip())
                .collect(),
            heights: shape.heights.clone(),
            curves,
            chords,
            bulges,
            knots,
            points,
        }
    }

    /// Returns the number of faces.
    #[inline]
    pub fn faces(&self) -> usize {
        self.curves.len()
    }

    /// Returns the height of a point, measured as those of the rows.
    #[inline]
    pub fn height(&self, x: &Vec2) -> f64 {
        self.tips.height([x.x, x.y])
    }

    /// Returns the position of a point on the last face by its height, and the gradient of the position [1/m].
    #[inline]
    pub fn tip_place(&self, x: &Vec2) -> (f64, Vec2) {
        let last = self.faces() - 1;
        let per = self.per_height[last];
        let gradient = per * Vec2::from(self.tips.gradient([x.x, x.y]));
        ((self.height(x) - self.heights[last]) * per, gradient)
    }

    /// Returns the face whose strip contains a height, searched from a given face on, and the position in the strip,
    /// from 0 to 1 (beyond, outside the profile).
    #[inline]
    pub fn row_at(&self, height: f64, mut row: usize) -> (usize, f64) {
        while row + 1 < self.faces() && height >= self.heights[row + 1] {
            row += 1;
        }
        while row > 0 && height < self.heights[row] {
            row -= 1;
        }
        (row, (height - self.heights[row]) * self.per_height[row])
    }

    /// Returns a face near a height, for rows of nearly equal height.
    #[inline]
    pub fn near(&self, height: f64) -> usize {
        let last = self.heights.len() - 1;
        let part = (height - self.heights[0]) / (self.heights[last] - self.heights[0]);
        // Beyond the ends, and for what is no number, the first or the last.
        ((part * last as f64) as usize).min(last - 1)
    }

    /// Returns true if a height lies between the ends of the profile.
    pub fn reaches(&self, height: f64) -> bool {
        (self.heights[0]..=self.heights[self.faces()]).contains(&height)
    }

    /// Returns the point of the profile at a height, limited to its ends.
    pub fn at_height(&self, height: f64) -> Vec2 {
        let (row, a) = self.row_at(height, self.near(height));
        self.place(row, a.clamp(0.0, 1.0))
    }

    /// Returns a lower bound of the gap of a point [m], infinite more than a face beyond root or tip, and the face for
    /// which it was computed.
    #[inline]
    pub fn clearance(&self, x: &Vec2, from: usize) -> (f64, usize) {
        let (row, a) = self.row_at(self.height(x), from);
        if !(-1.0..=2.0).contains(&a) {
            return (f64::INFINITY, row);
        }
        (self.clearance_bound(x, row), row)
    }

    /// Returns a lower bound of the gap of a point opposite to a face [m].
    #[inline]
    pub fn clearance_bound(&self, x: &Vec2, row: usize) -> f64 {
        let chord = &self.chords[row];
        chord.normal.dot(x) - chord.distance - chord.out
    }

    /// Returns a bound of the decrease of the gap between the ends of a face and faces of a master [m].
    #[inline]
    pub fn dip(&self, row: usize, master: &Profile, faces: [usize; 2]) -> f64 {
        self.bulges[row].dip(faces.map(|face| &master.bulges[face]))
    }

    /// Returns a point of the curve of a face.
    #[inline]
    pub fn place(&self, row: usize, a: f64) -> Vec2 {
        on_curve(&self.curves[row], a)
    }

    /// Finds the closest point of the curve of a face, continued beyond its ends, until a Newton step is smaller than
    /// `close`.
    #[inline]
    fn on_face(&self, x: &Vec2, row: usize, mut a: f64, close: f64) -> ProfileProjection {
        let [c0, c1, c2, c3] = &self.curves[row];
        if self.faceted {
            let per = c1.dot(c1).recip();
            a = (c1.dot(&(x - c0)) * per).clamp(-2.0, 3.0);
            let normal = self.chords[row].normal;
            return ProfileProjection {
                row,
                a,
                normal,
                gap: normal.dot(&(x - c0)),
                sensitivity: per * c1,
            };
        }
        let mut left = ITERATIONS;
        loop {
            let p = c0 + a * (c1 + a * (c2 + a * c3));
            let tangent = c1 + a * (2.0 * c2 + (3.0 * a) * c3);
            let bend = 2.0 * c2 + (6.0 * a) * c3;
            let r = x - p;
            let per = (tangent.dot(&tangent) - bend.dot(&r)).recip();
            let step = tangent.dot(&r) * per;
            left -= 1;
            if step.abs() < close || left == 0 {
                // The remaining step, whose third order is below rounding.
                let r = r - step * (tangent + (0.5 * step) * bend);
                let tangent = tangent + step * bend;
                let n = outward(self.side, &tangent);
                let normal = n / n.norm();
                return ProfileProjection {
                    row,
                    a: a + step,
                    normal,
                    gap: normal.dot(&r),
                    sensitivity: per * tangent,
                };
            }
            a = (a + step).clamp(-2.0, 3.0);
        }
    }

    /// Returns the edge between two faces as the closest point; the normal is the direction of the distance.
    fn on_edge(&self, x: &Vec2, feet: [ProfileProjection; 2]) -> ProfileProjection {
        let foot = feet[0];
        let a = foot.a.clamp(0.0, 1.0);
        let r = x - self.place(foot.row, a);
        let mean = feet[0].normal + feet[1].normal;
        let (distance, side) = (r.norm(), mean.dot(&r).signum());
        let normal = if distance > 1e-14 {
            side / distance * r
        } else {
            mean / mean.norm()
        };
        ProfileProjection {
            a,
            normal,
            gap: normal.dot(&r),
            sensitivity: Vec2::zeros(),
            ..foot
        }
    }

    /// Finds the closest point, starting from a position on a face; `None` beyond the ends, at the tip by more than a
    /// face.
    #[inline]
    pub fn project(&self, x: &Vec2, row: usize, a: f64) -> Option<ProfileProjection> {
        self.projection(x, (row, a), CLOSE)
    }

    /// Finds the closest point approximately, with an error of the cube of [`NEARLY`] in the gap relative to the
    /// length of a face and of its square in the position.
    #[inline]
    pub fn project_nearly(&self, x: &Vec2, row: usize, a: f64) -> Option<ProfileProjection> {
        self.projection(x, (row, a), NEARLY)
    }

    #[inline]
    fn projection(
        &self,
        x: &Vec2,
        (row, a): (usize, f64),
        close: f64,
    ) -> Option<ProfileProjection> {
        let mut foot = self.on_face(x, row, a, close);
        let mut last: Option<ProfileProjection> = None;
        for _ in 0..self.faces() {
            let row = if foot.a > 1.0 + OVERLAP && foot.row + 1 < self.faces() {
                foot.row + 1
            } else if foot.a < -OVERLAP && foot.row > 0 {
                foot.row - 1
            } else {
                break;
            };
            if let Some(last) = last.filter(|l| l.row == row) {
                return Some(self.on_edge(x, [foot, last]));
            }
            last = Some(foot);
            let place = if row > foot.row {
                foot.a - 1.0
            } else {
                foot.a + 1.0
            };
            foot = self.on_face(x, row, place, close);
        }
        if !(-RIM..=1.0 + BEYOND_TIP).contains(&foot.a) {
            return None;
        }
        Some(self.nearer(x, foot))
    }

    /// Returns the nearer of the closest points on both facets, for a point near an edge inside a convex flank.
    #[inline]
    fn nearer(&self, x: &Vec2, foot: ProfileProjection) -> ProfileProjection {
        if foot.gap >= 0.0 || !self.faceted {
            return foot;
        }
        let row = if foot.a > 1.0 - NEAR_EDGE && foot.row + 1 < self.faces() {
            foot.row + 1
        } else if foot.a < NEAR_EDGE && foot.row > 0 {
            foot.row - 1
        } else {
            return foot;
        };
        let other = self.on_face(x, row, 0.5, CLOSE);
        let valid = (-OVERLAP..=1.0 + OVERLAP).contains(&other.a);
        if valid && other.gap < 0.0 && other.gap > foot.gap {
            other
        } else {
            foot
        }
    }
}

/// Rotates a tangent towards the tip into the outward normal of the tooth.
#[inline]
pub(super) fn outward(side: Side, along: &Vec2) -> Vec2 {
    side.sign() * Vec2::new(-along.y, along.x)
}
