//! Lower bounds of gaps from the chords of a profile: one scalar product per bound.
//!
//! With the unit normal `n` and the distance `d` of a chord, all of the profile about its face stands out of it by at most
//! `p`, so that a point `x` that faces it has a gap of `n . x - d - p` at least. Along a chord of the length `l` that touches
//! a flank of the curvature `kappa` with both ends the gap falls by
//!
//! ```text
//! l^2 kappa / 8
//! ```
//!
//! in between, and by the protrusion of the chord's own profile.

use super::profile::{Vec2, outward};
use crate::geometry::Side;

/// Number of points along a face and half of both neighbours at which its protrusion beyond the chord is sampled.
const SAMPLES: usize = 16;

/// Safety factor for the profile between samples, and for curvature within a face.
const ROOM: f64 = 1.5;

/// Fraction of the length of a chord added to its protrusion.
const LEAST: f64 = 1e-3;

/// Chord of a face of a profile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    /// Outward unit normal of the chord.
    pub normal: Vec2,
    /// Distance of the chord from the origin along the normal [m].
    pub distance: f64,
    /// Largest protrusion of the profile [m], from the middle of the previous face to that of the next one.
    pub out: f64,
}

/// Curvature bound of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bulge {
    /// Largest protrusion beyond the chord [m].
    out: f64,
    /// Squared length of the chord [m^2].
    square: f64,
    /// One eighth of the curvature [1/m].
    per_square: f64,
}

impl Bulge {
    /// Returns a bound of the decrease of the gap between the ends of a face and faces of a master [m].
    #[inline]
    pub fn dip(&self, masters: [&Bulge; 2]) -> f64 {
        let [a, b] = masters.map(|m| m.per_square);
        self.out + self.square * a.max(b)
    }
}

/// Returns a point on a cubic.
#[inline]
pub(super) fn on_curve([c0, c1, c2, c3]: &[Vec2; 4], a: f64) -> Vec2 {
    c0 + a * (c1 + a * (c2 + a * c3))
}

/// Computes the chords of the faces between nodes, and their curvature bounds.
pub(super) fn chords(side: Side, knots: &[Vec2], curves: &[[Vec2; 4]]) -> (Vec<Chord>, Vec<Bulge>) {
    let last = curves.len() - 1;
    let line = |row: usize| {
        let along = knots[row + 1] - knots[row];
        let length = along.norm();
        let n = outward(side, &along) / length;
        (n, n.dot(&(0.5 * (knots[row] + knots[row + 1]))), length)
    };
    // Beyond its ends the profile is extended along its last faces.
    let stands_out = |row: usize, from: f64, to: f64| {
        let (n, d, length) = line(row);
        let most = (0..=SAMPLES).fold(0.0_f64, |most, i| {
            let at = from + (to - from) * i as f64 / SAMPLES as f64;
            let of = (row as f64 + at.floor()).clamp(0.0, last as f64) as usize;
            let a = at - (of as f64 - row as f64);
            most.max(n.dot(&on_curve(&curves[of], a)) - d)
        });
        ROOM * most + LEAST * length
    };
    let chords = (0..=last).map(|row| {
        let (normal, distance, _) = line(row);
        Chord {
            normal,
            distance,
            out: stands_out(row, -0.5, 1.5),
        }
    });
    let bulges = (0..=last).map(|row| {
        let (n, _, length) = line(row);
        let turn = |other: usize| (line(other).0 - n).norm();
        let turns = turn(row.saturating_sub(1)).max(turn((row + 1).min(last)));
        Bulge {
            out: stands_out(row, 0.0, 1.0),
            square: length * length,
            per_square: 0.125 * ROOM * turns / length,
        }
    });
    (chords.collect(), bulges.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Builds faces of a circle about the origin, from one angle to another, as cubics through points and slopes of
    /// their ends.
    fn circle(radius: f64, angles: [f64; 2], faces: usize) -> (Vec<Vec2>, Vec<[Vec2; 4]>) {
        let step = (angles[1] - angles[0]) / faces as f64;
        let at = |i: usize| {
            let (sin, cos) = (angles[0] + i as f64 * step).sin_cos();
            let slope = step * radius * Vec2::new(-sin, cos);
            (radius * Vec2::new(cos, sin), slope)
        };
        let curve = |i: usize| {
            let ((x, u), (y, v)) = (at(i), at(i + 1));
            let off = y - x;
            [x, u, 3.0 * off - 2.0 * u - v, u + v - 2.0 * off]
        };
        (
            (0..=faces).map(|i| at(i).0).collect(),
            (0..faces).map(curve).collect(),
        )
    }

    #[test]
    fn gaps_of_round_flanks_keep_their_bounds() {
        // Outwards of a right flank is away from the origin here; the slave curves the other way, about a centre beyond it.
        let (of_master, faces) = (10.0, 9);
        let (knots, curves) = circle(of_master, [-0.3, 0.3], faces);
        let (chords_of, bulges_of) = chords(Side::Right, &knots, &curves);
        let bound = |x: &Vec2| {
            let angle = x.y.atan2(x.x);
            let row = ((angle + 0.3) / 0.6 * faces as f64).clamp(0.0, faces as f64 - 1.0) as usize;
            let c = &chords_of[row];
            (c.normal.dot(x) - c.distance - c.out, row)
        };
        let gap = |x: &Vec2| x.norm() - of_master;
        for (of_slave, faces) in [(6.0, 3), (6.0, 12), (40.0, 3), (1e4, 2)] {
            let angle = 2.0 / of_slave;
            let (knots, curves) = circle(of_slave, [-angle, angle], faces);
            let (_, bulges) = chords(Side::Right, &knots, &curves);
            for lift in [-0.01, 0.0, 0.05] {
                let facing = |x: Vec2| Vec2::new(of_master + of_slave + lift - x.x, x.y);
                for (row, curve) in curves.iter().enumerate() {
                    let ends = [0, 1].map(|i| bound(&facing(knots[row + i])));
                    let dip = bulges[row].dip(ends.map(|(_, face)| &bulges_of[face]));
                    let mut least = f64::INFINITY;
                    for i in 0..=40 {
                        let x = facing(on_curve(curve, i as f64 / 40.0));
                        let exact = gap(&x);
                        assert!(bound(&x).0 <= exact, "{of_slave} {row} {i}");
                        least = least.min(exact);
                    }
                    let told = ends[0].0.min(ends[1].0) - dip;
                    assert!(told <= least, "{of_slave} {row}: {told} {least}");
                    // The bound is of use: it misses no more than some sagittas.
                    let sagitta = bulges[row].square * (0.125 / of_slave + 0.125 / of_master);
                    assert!(least - told < 4.0 * sagitta + 0.02, "{least} {told}");
                }
            }
        }
    }
}
