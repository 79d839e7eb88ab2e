//! Contacts on lines of action with a force, or possibly with one, and their rows.

use super::members::{SceneGear, SceneMesh, gear_states};
use crate::Vec3;
use crate::contact::{Candidate, GearState};
use crate::geometry::along_profile;
use crate::kinematics::{Point, Row};
use crate::law::{Friction, FrictionForce, Law, LawForce};
use gearbench_integrators::system::StateView;

/// A contact with a force, or possibly with one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Active {
    pub mesh: usize,
    /// Index of the candidate.
    pub candidate: usize,
    /// Gap of the contact [m].
    pub gap: f64,
    /// Rate of the gap [m/s].
    pub rate: f64,
    pub impact_speed: f64,
    pub force: LawForce,
    /// Factors of the parts of both gears in the contact row: the normal force plus the parametric term of the
    /// potential along the path [N].
    pub on: [f64; 2],
    /// Parametric term on the separate row of flanks in space [N].
    pub along: f64,
    pub friction: FrictionForce,
    /// Sliding speed of gear b relative to gear a [m/s].
    pub sliding: f64,
    pub prescribed: PrescribedSpeeds,
}

/// Speeds from prescribed motions of driven mounts [m/s].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PrescribedSpeeds {
    /// Speeds of the points of both gears along the normal.
    pub points: [f64; 2],
    /// Gap rate from prescribed motions.
    pub gap: f64,
    /// Sliding speed from prescribed motions.
    pub sliding: f64,
    /// Rate of the path coordinate of flanks in space from prescribed motions.
    pub path: f64,
}

/// Returns the direction of sliding of a candidate, with the taper factor of a point that leaves contact over a tip,
/// as in its normal.
pub(super) fn sliding_of(c: &Candidate) -> Vec3 {
    c.taper * along_profile(&c.normal)
}

/// Returns the displacement of a contact along the line of action, from displacements of the parts of its row; flank
/// points keep their position on the flank.
pub(super) fn moves(mesh: &SceneMesh, c: &Candidate, d: [f64; 2]) -> f64 {
    if mesh.search.points().is_some() || c.along.is_some() {
        0.0
    } else {
        along(c, d) / transverse(c)
    }
}

#[inline]
pub(super) fn fill_rows(
    gears: &[SceneGear],
    mesh: &SceneMesh,
    [a, b]: [&GearState<'_>; 2],
    c: &Candidate,
    rows: &mut [Row; 4],
) -> PrescribedSpeeds {
    let offset = |k: usize| gears[mesh.gears[k]].offset;
    let row = &mut rows[0];
    let points = gap_row(gears, mesh, [a, b], c, row);
    let mut prescribed = PrescribedSpeeds {
        points,
        gap: c.scale[1] * points[1] - c.scale[0] * points[0],
        sliding: 0.0,
        path: 0.0,
    };
    if let Some(along) = c.along {
        prescribed.path = path_row(gears, mesh, [a, b], (&c.points, along), &mut rows[3]);
    }
    if mesh.friction.is_none() {
        return prescribed;
    }
    let t = sliding_of(c);
    rows[2].clear();
    let followed = if mesh.search.points().is_some() { 1 } else { 2 };
    for (k, shift) in [(1, 0.0), (2, 1.0)].into_iter().take(followed) {
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

/// Appends the row `dg/dq` of a candidate; returns the prescribed speeds of the points of both gears along the normal.
#[inline]
pub(super) fn gap_row(
    gears: &[SceneGear],
    mesh: &SceneMesh,
    [a, b]: [&GearState<'_>; 2],
    c: &Candidate,
    row: &mut Row,
) -> [f64; 2] {
    row.clear();
    row.target(gears[mesh.gears[0]].offset, -c.scale[0]);
    let of_a = (a.gear).row(a.at, &c.points[0], &(c.normal + c.aside[0]), row)
        + taper_row(a, (&c.points[1].x, &c.aside[1]), row);
    row.mark_split();
    row.target(gears[mesh.gears[1]].offset, c.scale[1]);
    let of_b = (b.gear).row(b.at, &c.points[1], &(c.normal + c.aside[1]), row)
        + taper_row(b, (&c.points[0].x, &c.aside[0]), row);
    [of_a, of_b]
}

/// Appends the gradient of the tip-taper factor by out-of-plane motion of the hub, at a point of the other gear that
/// leaves contact over the tip of this one; returns the prescribed part. The hub's own motion does not change the
/// height of the point.
#[inline]
fn taper_row(master: &GearState<'_>, (x, aside): (&Vec3, &Vec3), row: &mut Row) -> f64 {
    if *aside == Vec3::zeros() {
        return 0.0;
    }
    let (hub, at) = (&master.gear.hub().hub, master.at);
    let hub_pose = hub.hub_pose(at.t, at.q);
    hub_pose.map_or(0.0, |s| {
        hub.lateral_row_on(at.t, &s, (x, aside), row, false)
    })
}

/// Appends the row of a force `f` and a moment `m` at a contact point, on gear b against gear a. Two forces `m x u` at
/// a unit distance `u`, perpendicular to the moment, represent the moment. Returns the part of prescribed motions.
fn path_row(
    gears: &[SceneGear],
    mesh: &SceneMesh,
    [a, b]: [&GearState<'_>; 2],
    (points, [force, moment]): (&[Point; 2], [Vec3; 2]),
    row: &mut Row,
) -> f64 {
    row.clear();
    let mut prescribed = 0.0;
    let across = moment.cross(&Vec3::z());
    let across = across.try_normalize(0.0).unwrap_or(Vec3::x());
    let couple = moment.cross(&across);
    for (k, sign, gear_state) in [(0, -1.0, a), (1, 1.0, b)] {
        row.target(gears[mesh.gears[k]].offset, sign);
        let mut beside = points[k];
        beside.x += across;
        for (point, direction) in [(&beside, couple), (&points[k], force - couple)] {
            prescribed += sign * gear_state.gear.row(gear_state.at, point, &direction, row);
        }
        if k == 0 {
            row.mark_split();
        }
    }
    prescribed
}

pub(super) fn gap_rate(
    gears: &[SceneGear],
    mesh: &SceneMesh,
    c: &Candidate,
    at: StateView<'_>,
    row: &mut Row,
) -> f64 {
    let (a, b) = gear_states(gears, mesh, at);
    let [of_a, of_b] = gap_row(gears, mesh, [&a, &b], c, row);
    row.dot(at.v) + c.scale[1] * of_b - c.scale[0] * of_a
}

/// Returns the length of the transverse part of a candidate's normal.
fn transverse(c: &Candidate) -> f64 {
    c.normal.x.hypot(c.normal.y)
}

/// Returns the displacement of a contact along the normal, from displacements of the parts of its row: one half with
/// either gear, in the directions in which its stiffness and its position follow.
#[inline]
fn along(c: &Candidate, [a, b]: [f64; 2]) -> f64 {
    0.5 * (b / c.scale[1] - a / c.scale[0])
}

/// Returns one half of the derivative of the elastic energy of a contact along the path [N]: the force of the
/// parametric term on each gear.
#[inline]
pub(super) fn along_path(law: &Law, c: &Candidate, gap: f64) -> f64 {
    if c.stiffness_s == 0.0 {
        return 0.0;
    }
    0.5 * law.d_potential_dk(gap, c.stiffness) * c.stiffness_s
}

/// Returns the factors of both parts of the row of a contact with the normal force `n`: with `V = W(g, k(s))` the
/// force is `-dV/dq = n dg/dq - dW/dk k'(s) ds/dq`.
#[inline]
pub(super) fn parts(law: &Law, c: &Candidate, gap: f64, n: f64) -> ([f64; 2], f64) {
    let along = along_path(law, c, gap);
    match c.along {
        None => ([n + along / c.scale[0], n - along / c.scale[1]], 0.0),
        Some(_) => ([n; 2], along),
    }
}

/// Derivatives of the force of a contact by the two parts of its row, applied to changes of coordinates and of
/// velocities.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tangent {
    /// Derivatives of the normal force [N/m].
    pub normal: [f64; 2],
    /// Derivatives of the elastic part of the normal force, which acts on neighbouring pairs [N/m].
    pub elastic: [f64; 2],
    /// Derivatives of [`Active::on`] by the gap [N/m].
    pub by_gap: [f64; 2],
    /// Derivatives of [`Active::on`]; the first index is the gear whose part is multiplied [N/m].
    pub on: [[f64; 2]; 2],
    /// Derivative of all of them by the gap rate [N s/m].
    pub rate: f64,
    /// True if the rows of both gears have equal derivatives: one direction is then enough.
    pub plain: bool,
}

/// Coupling of two contacts: the change of the force of one with the elastic force of another, through their common
/// body.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactCoupling {
    /// Index of the contact whose force changes.
    pub of: usize,
    /// Index of the contact that causes the change.
    pub to: usize,
    /// Changes of the normal force and of [`Active::on`].
    pub normal: f64,
    pub on: [f64; 2],
}

/// Computes the tangent of a contact, without the curvature of its stiffness along the path.
pub(super) fn tangent(law: &Law, c: &Candidate, a: &Active, row: &Row, v: &[f64]) -> Tangent {
    let force = &a.force;
    // The change of the rows of spatial flanks is computed by differences.
    let plain = c.along.is_some() || (c.stiffness_s == 0.0 && c.curvature == [0.0; 2]);
    let elastic = law.undamped().smooth(a.gap, 0.0, 0.0, c.stiffness);
    if plain {
        return Tangent {
            normal: [force.dn_dg; 2],
            elastic: [elastic.dn_dg; 2],
            by_gap: [force.dn_dg; 2],
            on: [[force.dn_dg; 2]; 2],
            rate: force.dn_dgdot,
            plain,
        };
    }
    let of_stiffness = 0.5 * force.dn_dk * c.stiffness_s;
    let along = -0.5 * c.stiffness_s * elastic.dn_dk;
    // How the rows turn.
    let turning = [0, 1].map(|k| c.curvature[k] / (c.scale[k] * c.scale[k]));
    let rates = row.dot_parts(v);
    let sign = [-1.0, 1.0];
    let by_stiffness = 0.5 * elastic.dn_dk * c.stiffness_s;
    let normal = [0, 1].map(|j| {
        let rate = rates[j] + sign[j] * c.scale[j] * a.prescribed.points[j];
        force.dn_dg + sign[j] * of_stiffness / c.scale[j] + force.dn_dgdot * turning[j] * rate
    });
    let on = [0, 1].map(|k| {
        [0, 1].map(|j| {
            let own = if j == k { a.force.n * turning[k] } else { 0.0 };
            normal[j] - sign[k] * along / c.scale[k] + own
        })
    });
    Tangent {
        normal,
        elastic: [0, 1].map(|j| elastic.dn_dg + sign[j] * by_stiffness / c.scale[j]),
        by_gap: [0, 1].map(|k| force.dn_dg - sign[k] * along / c.scale[k]),
        on,
        rate: force.dn_dgdot,
        plain,
    }
}

pub(super) fn slide(
    friction: Option<Friction>,
    at: StateView<'_>,
    rows: &[Row; 4],
    active: &mut Active,
) {
    if let Some(friction) = friction {
        active.sliding = rows[1].dot(at.v) + active.prescribed.sliding;
        active.friction = friction.force(active.force.n, active.sliding);
    }
}
