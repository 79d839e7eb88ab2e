//! Closest point of a flank to a point in space, and the gap along the normal of the flank.
//!
//! On a face the closest point solves `X_a . (x - X) = X_b . (x - X) = 0` (Newton). Where it lies beyond an
//! edge the search goes on to the neighbouring face; between two faces that both send it to the other the
//! closest point lies on their common edge. At the closest point the motion of `X` along the surface drops
//! out of the gap, so `dg = n . (dx - dX)` with fixed parameters is exact.
//!
//! Beyond the outer edges there is no flank. Only at the tip a point counts a little further, on the surface
//! continued: the area it stands for still lies partly on the flank.

use super::patch::Patch;
use super::surface::{Shape, SurfacePoint};
use crate::Vec3;
use crate::kinematics::Pose;

/// Projection of a point on a flank.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projection {
    pub row: usize,
    pub column: usize,
    /// Position on the face, 0 to 1 within it.
    pub a: f64,
    pub b: f64,
    /// Closest point [m] with its derivatives; the second derivatives are those before the last correction.
    pub spot: SurfacePoint,
    /// Unit normal of the flank, out of the tooth.
    pub normal: Vec3,
    /// Distance along the normal [m], positive outside.
    pub gap: f64,
    /// Edge between faces with the closest point, if any: the position then moves in one direction only.
    pub edge: Option<Edge>,
}

impl Projection {
    /// Returns the derivative of the position by a displacement of the point `x` relative to the flank [1/m].
    #[inline]
    pub fn sensitivity(&self, x: &Vec3) -> [Vec3; 2] {
        let spot = &self.spot;
        let r = x - spot.x;
        let aa = spot.along.dot(&spot.along) - spot.bend[0].dot(&r);
        let ab = spot.along.dot(&spot.across) - spot.bend[1].dot(&r);
        let bb = spot.across.dot(&spot.across) - spot.bend[2].dot(&r);
        match self.edge {
            None => {
                let per = (aa * bb - ab * ab).recip();
                [
                    per * (bb * spot.along - ab * spot.across),
                    per * (aa * spot.across - ab * spot.along),
                ]
            }
            Some(Edge::Along) => [spot.along / aa, Vec3::zeros()],
            Some(Edge::Across) => [Vec3::zeros(), spot.across / bb],
        }
    }
}

/// Grid lines along which an edge between faces runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edge {
    /// Edge between two rows, over the width.
    Across,
    /// Edge between two columns, along the profile.
    Along,
}

/// A flank in its deformed state.
#[derive(Clone, Copy, Debug)]
pub(super) struct DeformedSurface<'a> {
    pub shape: &'a Shape,
    pub x: &'a [Vec3],
    pub pose: &'a Pose,
    /// Faces of an undeformed flank in its own frame, if available.
    pub patches: Option<&'a [Patch]>,
}

/// Overlap of neighbouring faces, to cover rounding.
pub(super) const OVERLAP: f64 = 1e-9;
/// Fraction of a face by which a point may lie beyond the outer edges of the flank: otherwise elastic displacements
/// along the edge would lose points on it.
pub(super) const RIM: f64 = 0.01;
/// Largest fraction of the last face by which a point beyond the tip still counts.
pub(super) const MOST_PAST: f64 = 0.5;
/// Fraction of the last face up to which projections beyond the tip are returned. The height of a point decides when
/// it has left ([`TipTaper`]). The projection of a point with a deep overlap, as before residual compliance, lies further
/// out than its height, so that this bound must never be the stricter one.
pub(super) const BEYOND_TIP: f64 = 1.0;
/// Distance from an edge, as a fraction of a face, within which both faces are searched, so that the gap over facets
/// has no jump.
pub(super) const NEAR_EDGE: f64 = 0.1;
/// Newton step on a face [1] at which the search of the closest point ends: the remaining error is of the order of its
/// square times the curvature of the face.
const CLOSE: f64 = 1e-4;
/// Largest number of Newton iterations on a face.
const ITERATIONS: usize = 20;

/// Start of a projection: a face and a position on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ProjectionStart {
    pub row: usize,
    pub column: usize,
    pub place: [f64; 2],
}

/// Tip taper of a point: the factor of its gap, and the gradient of the factor by the position of the point.
#[derive(Clone, Copy, Debug)]
pub(super) struct TipTaper {
    pub factor: f64,
    /// Gradient of the factor [1/m].
    pub gradient: Vec3,
}

impl TipTaper {
    /// Taper of a point whose whole length is on the flank.
    pub const NONE: TipTaper = TipTaper {
        factor: 1.0,
        gradient: Vec3::new(0.0, 0.0, 0.0),
    };

    /// Computes the taper at the position `a` on the last face by its height in the frame of the master, with the
    /// gradient of that; `past` is half the length of the point relative to the face. Returns `None` where the point
    /// has left.
    ///
    /// The part `t = 1/2 + (1 - a) / (2 past)` of its length is on the flank. The gap is multiplied by `m = t sqrt(3 -
    /// 2 t)`, so that the energy `k (m g)^2 / 2` of a linear law decreases with `m^2 = t^2 (3 - 2 t)`, smoothly at
    /// both ends, without a jump of the force. The factor applies to the gap and not to the area, because the force is
    /// then the derivative of one potential by the row of `m g`, whatever the law. The height determines the position,
    /// because that of a point on the slave depends on the motion of the slave alone: no rotation of the master about
    /// its axis changes it.
    ///
    /// Of its length the part `t = 1/2 + (1 - a) / (2 past)` is on the flank. The gap takes the factor
    /// `m = t sqrt(3 - 2 t)`, so that the energy `k (m g)^2 / 2` of a linear law fades with `m^2 = t^2 (3 - 2 t)`,
    /// smoothly at both ends: the force has no jump there. The gap carries the factor, and not the area, because the
    /// force is then the derivative of one potential by the row of `m g`, whatever the law. The place is told by the
    /// height because that of a point on the slave answers to the motion of the slave alone: no motion of the master
    /// about its axis changes it.
    #[inline]
    pub fn new((a, gradient): (f64, Vec3), past: f64) -> Option<TipTaper> {
        let t = 0.5 + 0.5 * (1.0 - a) / past;
        if t >= 1.0 {
            return Some(TipTaper::NONE);
        }
        if t <= 0.0 {
            return None;
        }
        let root = (3.0 - 2.0 * t).sqrt();
        Some(TipTaper {
            factor: t * root,
            gradient: -1.5 * (1.0 - t) / (root * past) * gradient,
        })
    }

    /// Returns true if the point is in the taper.
    #[inline]
    pub fn acts(&self) -> bool {
        self.factor < 1.0
    }

    /// Returns the remaining fraction of the area of the point.
    #[inline]
    pub fn area(&self) -> f64 {
        self.factor * self.factor
    }
}

/// Returns -1, 0 or 1 for a coordinate below, in or above `[0, 1]`.
#[inline]
fn beyond(t: f64) -> isize {
    isize::from(t > 1.0 + OVERLAP) - isize::from(t < -OVERLAP)
}

impl DeformedSurface<'_> {
    /// Returns a face as a function of the position on it.
    #[inline]
    fn face(&self, row: usize, column: usize) -> impl Fn(f64, f64) -> SurfacePoint {
        let patch = (self.patches).map(|p| &p[row * (self.shape.columns - 1) + column]);
        let face = match patch {
            Some(patch) => Err(patch),
            None => Ok(self.shape.face(self.x, self.pose, row, column)),
        };
        move |a, b| match &face {
            Ok(face) => face.eval(self.shape, a, b),
            Err(patch) => patch.eval(a, b),
        }
    }

    /// Returns the unit normal out of the tooth.
    #[inline]
    fn normal(&self, spot: &SurfacePoint) -> Vec3 {
        let n = spot.across.cross(&spot.along);
        self.shape.side.sign() * n / n.norm()
    }

    /// Finds the closest point of the surface of a face, continued beyond its edges.
    #[inline]
    fn on_face(&self, x: &Vec3, row: usize, column: usize, [mut a, mut b]: [f64; 2]) -> Projection {
        let face = self.face(row, column);
        let mut spot = face(a, b);
        for _ in 0..ITERATIONS {
            let r = x - spot.x;
            let (ra, rb) = (spot.along.dot(&r), spot.across.dot(&r));
            let aa = spot.along.dot(&spot.along) - spot.bend[0].dot(&r);
            let ab = spot.along.dot(&spot.across) - spot.bend[1].dot(&r);
            let bb = spot.across.dot(&spot.across) - spot.bend[2].dot(&r);
            let det = aa * bb - ab * ab;
            let (da, db) = ((bb * ra - ab * rb) / det, (aa * rb - ab * ra) / det);
            if da.abs() + db.abs() < CLOSE {
                // The third order of the step is below rounding.
                let [aa, ab, bb] = spot.bend;
                spot.x += da * (spot.along + 0.5 * da * aa + db * ab)
                    + db * (spot.across + 0.5 * db * bb);
                spot.along += da * aa + db * ab;
                spot.across += da * ab + db * bb;
                (a, b) = (a + da, b + db);
                break;
            }
            // Further outside, the face is not relevant; its neighbour is.
            a = (a + da).clamp(-2.0, 3.0);
            b = (b + db).clamp(-2.0, 3.0);
            spot = face(a, b);
        }
        let normal = self.normal(&spot);
        Projection {
            row,
            column,
            a,
            b,
            spot,
            normal,
            gap: normal.dot(&(x - spot.x)),
            edge: None,
        }
    }

    /// Finds the closest point of the edge between the rows below and above node row `edge`, or, with `turned`,
    /// between the columns on both sides of node column `edge`; the normal is the direction of the distance.
    #[inline(never)]
    fn on_edge(&self, x: &Vec3, hits: [Projection; 2], turned: bool) -> Projection {
        let hit = hits[0];
        let face = self.face(hit.row, hit.column);
        let (mut a, mut b) = (hit.a.clamp(0.0, 1.0), hit.b.clamp(0.0, 1.0));
        let mut spot = face(a, b);
        for _ in 0..ITERATIONS {
            let r = x - spot.x;
            let (t, bend) = if turned {
                (spot.along, spot.bend[0])
            } else {
                (spot.across, spot.bend[2])
            };
            let step = t.dot(&r) / (t.dot(&t) - bend.dot(&r));
            let moved = if turned { &mut a } else { &mut b };
            *moved = (*moved + step).clamp(-RIM, 1.0 + RIM);
            spot = face(a, b);
            if step.abs() < 1e-12 {
                break;
            }
        }
        let r = x - spot.x;
        let mean = hits[0].normal + hits[1].normal;
        let (distance, side) = (r.norm(), mean.dot(&r).signum());
        // On the edge itself any direction between the normals of both faces will do.
        let normal = if distance > 1e-14 {
            side / distance * r
        } else {
            mean / mean.norm()
        };
        Projection {
            a,
            b,
            spot,
            normal,
            gap: normal.dot(&r),
            edge: Some(if turned { Edge::Along } else { Edge::Across }),
            ..hit
        }
    }

    /// Finds the closest point of the flank; `None` beyond its outer edges, at the tip by more than a face.
    pub fn project(&self, x: &Vec3, begin: ProjectionStart) -> Option<Projection> {
        let (rows, columns) = (self.shape.rows - 1, self.shape.columns - 1);
        let mut hit = self.on_face(x, begin.row, begin.column, begin.place);
        let mut last: Option<Projection> = None;
        for _ in 0..rows + columns {
            let row = hit
                .row
                .checked_add_signed(beyond(hit.a))
                .filter(|r| *r < rows)
                .unwrap_or(hit.row);
            let column = if row == hit.row {
                hit.column
                    .checked_add_signed(beyond(hit.b))
                    .filter(|c| *c < columns)
                    .unwrap_or(hit.column)
            } else {
                hit.column
            };
            if (row, column) == (hit.row, hit.column) {
                break;
            }
            if let Some(last) = last.filter(|l| (l.row, l.column) == (row, column)) {
                let turned = column != hit.column;
                return self.inside(self.on_edge(x, [hit, last], turned));
            }
            last = Some(hit);
            // The place on the next face, as long as faces have about one size.
            let place = [
                hit.a - (row as f64 - hit.row as f64),
                hit.b - (column as f64 - hit.column as f64),
            ];
            hit = self.on_face(x, row, column, place);
        }
        let hit = self.inside(hit)?;
        Some(self.nearer(x, hit))
    }

    /// Removes projections beyond the outer edges.
    #[inline]
    fn inside(&self, hit: Projection) -> Option<Projection> {
        let along = (-RIM..=1.0 + BEYOND_TIP).contains(&hit.a);
        (along && (-RIM..=1.0 + RIM).contains(&hit.b)).then_some(hit)
    }

    /// Returns the nearer of the closest points on both facets, for a point near an edge inside a convex flank.
    #[inline]
    fn nearer(&self, x: &Vec3, hit: Projection) -> Projection {
        if hit.gap >= 0.0 || !self.shape.is_faceted() {
            return hit;
        }
        let (rows, columns) = (self.shape.rows - 1, self.shape.columns - 1);
        let step = |t: f64| isize::from(t > 1.0 - NEAR_EDGE) - isize::from(t < NEAR_EDGE);
        let mut best = hit;
        for (dr, dc) in [(step(hit.a), 0), (0, step(hit.b))] {
            let row = hit.row.checked_add_signed(dr).filter(|r| *r < rows);
            let column = hit.column.checked_add_signed(dc).filter(|c| *c < columns);
            let (Some(row), Some(column)) = (row, column) else {
                continue;
            };
            if (dr, dc) == (0, 0) {
                continue;
            }
            let other = self.on_face(x, row, column, [0.5; 2]);
            let valid = beyond(other.a) == 0 && beyond(other.b) == 0;
            if valid && other.gap < 0.0 && other.gap > best.gap {
                best = other;
            }
        }
        best
    }
}
