//! Contacts on lines of action that carry (or may carry) a force, and their rows.

use super::members::{SceneGear, SceneMesh, parties};
use crate::Vec3;
use crate::contact::{Candidate, Party};
use crate::kinematics::Row;
use crate::law::{FrictionForce, LawForce};
use gearbench_integrators::system::At;

/// A contact that carries (or may carry) a force.
#[derive(Clone, Copy, Debug)]
pub(super) struct Active {
    pub mesh: usize,
    /// Index into the candidates.
    pub candidate: usize,
    /// Gap [m].
    pub gap: f64,
    /// Its rate [m/s].
    pub rate: f64,
    pub impact_speed: f64,
    pub force: LawForce,
    pub friction: FrictionForce,
    /// Sliding speed of gear b over gear a [m/s].
    pub sliding: f64,
    pub prescribed: Prescribed,
}

/// Speeds that driven mounts prescribe [m/s].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Prescribed {
    /// Of the first gear's point along the normal.
    pub first: f64,
    /// Of the gap.
    pub gap: f64,
    /// Of sliding.
    pub sliding: f64,
}

/// In-plane direction of sliding: the normal's transverse part turned by 90 degrees.
pub(super) fn sliding_direction(n: &Vec3) -> Vec3 {
    let t = Vec3::new(-n.y, n.x, 0.0);
    t / t.norm()
}

#[inline]
pub(super) fn fill_rows(
    gears: &[SceneGear],
    mesh: &SceneMesh,
    [a, b]: [&Party<'_>; 2],
    c: &Candidate,
    rows: &mut [Row; 3],
) -> Prescribed {
    let offset = |k: usize| gears[mesh.gears[k]].offset;
    let row = &mut rows[0];
    let [first, gap] = gap_row(gears, mesh, [a, b], c, row);
    let mut prescribed = Prescribed {
        first,
        gap,
        sliding: 0.0,
    };
    if mesh.friction.is_none() {
        return prescribed;
    }
    let t = sliding_direction(&c.normal);
    for (k, shift) in [(1, 0.0), (2, 1.0)] {
        let row = &mut rows[k];
        row.clear();
        let moved = |i: usize| {
            let mut p = c.points[i];
            p.x += shift * Vec3::new(t.y, -t.x, 0.0);
            p
        };
        row.target(offset(0), -1.0);
        let of_a = a.gear.row(a.at, &moved(0), &t, row);
        row.mark_split();
        row.target(offset(1), 1.0);
        let of_b = b.gear.row(b.at, &moved(1), &t, row);
        if k == 1 {
            prescribed.sliding = of_b - of_a;
        }
    }
    prescribed
}

/// The row `dg/dq` of a candidate; returns the prescribed speed of the first gear's point along the normal, and of the
/// gap.
#[inline]
pub(super) fn gap_row(
    gears: &[SceneGear],
    mesh: &SceneMesh,
    [a, b]: [&Party<'_>; 2],
    c: &Candidate,
    row: &mut Row,
) -> [f64; 2] {
    row.clear();
    row.target(gears[mesh.gears[0]].offset, -c.scale[0]);
    let of_a = (a.gear).row(a.at, &c.points[0], &(c.normal + c.aside[0]), row);
    row.mark_split();
    row.target(gears[mesh.gears[1]].offset, c.scale[1]);
    let of_b = (b.gear).row(b.at, &c.points[1], &(c.normal + c.aside[1]), row);
    [of_a, c.scale[1] * of_b - c.scale[0] * of_a]
}

pub(super) fn gap_rate(
    gears: &[SceneGear],
    mesh: &SceneMesh,
    c: &Candidate,
    at: At<'_>,
    row: &mut Row,
) -> f64 {
    let (a, b) = parties(gears, mesh, at);
    let [_, prescribed] = gap_row(gears, mesh, [&a, &b], c, row);
    row.dot(at.v) + prescribed
}

/// Length of the transverse part of a candidate's normal.
pub(super) fn transverse(c: &Candidate) -> f64 {
    c.normal.x.hypot(c.normal.y)
}

pub(super) fn slide(mesh: &SceneMesh, at: At<'_>, rows: &[Row; 3], active: &mut Active) {
    if let Some(friction) = &mesh.friction {
        active.sliding = rows[1].dot(at.v) + active.prescribed.sliding;
        active.friction = friction.force(active.force.n, active.sliding);
    }
}
