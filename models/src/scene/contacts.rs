//! Evaluation of all contacts of a scene at one state.

use super::condensed::Condensed;
use super::nodal::Nodal;
use super::nodal_tangent::Reduced;
use super::{Scene, SceneGear, SceneMesh, parties};
use crate::Vec3;
use crate::contact::pairs::all_open;
use crate::contact::{Candidate, Party, Wanted};
use crate::geometry::Side;
use crate::kinematics::{Row, Tooth};
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

/// The contact force at a point, for pictures and reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce {
    /// Index of the mesh.
    pub mesh: usize,
    /// Teeth of both gears, unwrapped.
    pub teeth: [Tooth; 2],
    /// Flank side that is in contact.
    pub side: Side,
    /// Where [m].
    pub x: Vec3,
    /// Force on the second gear of the mesh [N].
    pub force: Vec3,
    /// Normal force [N].
    pub normal_force: f64,
    /// Gap [m].
    pub gap: f64,
}

/// Buffers; they grow to the largest number of contacts and stay.
#[derive(Default)]
pub(super) struct Workspace {
    pub candidates: Vec<Candidate>,
    /// Candidates before a zone switch.
    pub listed: Vec<Candidate>,
    pub active: Vec<Active>,
    /// Three rows per active contact: normal, sliding, sliding one metre further along the normal.
    pub rows: Vec<[Row; 3]>,
    pub condensed: Condensed,
    /// Contacts of gears with fields.
    pub nodal: Nodal,
    /// Their tangent.
    pub reduced: Reduced,
    /// Newton correction: rows V, columns Z, small matrix, small vector.
    pub v: Vec<f64>,
    pub z: Vec<f64>,
    pub small: Vec<f64>,
    pub rhs: Vec<f64>,
    /// Row for a gap rate on its own.
    pub scratch: Row,
}

/// In-plane direction of sliding: the normal's transverse part turned by 90 degrees.
pub(super) fn sliding_direction(n: &Vec3) -> Vec3 {
    let t = Vec3::new(-n.y, n.x, 0.0);
    t / t.norm()
}

#[inline]
fn fill_rows(
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
    let of_a = a.gear.row(a.at, &c.points[0], &c.normal, row);
    row.mark_split();
    row.target(gears[mesh.gears[1]].offset, c.scale[1]);
    let of_b = b.gear.row(b.at, &c.points[1], &c.normal, row);
    [of_a, c.scale[1] * of_b - c.scale[0] * of_a]
}

impl Scene {
    /// Fills `work.active` and its rows with the contacts at a state.
    #[inline]
    pub(super) fn evaluate_contacts(&mut self, at: At<'_>) {
        if self.fields {
            self.evaluate_with_fields(at);
            return;
        }
        self.work.active.clear();
        self.work.candidates.clear();
        let located = at.discrete[0] != 0.0;
        for m in 0..self.meshes.len() {
            if !(located && all_open(&at.discrete[self.meshes[m].modes()])) {
                self.evaluate_mesh(at, m, located);
            }
        }
    }

    /// Appends the contacts of a mesh.
    #[inline(never)]
    pub(super) fn evaluate_mesh(&mut self, at: At<'_>, m: usize, located: bool) {
        let Scene {
            gears,
            meshes,
            work,
            ..
        } = self;
        let mesh = &meshes[m];
        let (a, b) = parties(gears, mesh, at);
        let first = work.candidates.len();
        let discrete = &at.discrete[mesh.search_discrete()];
        let wanted = if located {
            Wanted::Closed(&at.discrete[mesh.modes()])
        } else {
            Wanted::Touching(0.0)
        };
        mesh.search
            .candidates(a, b, discrete, wanted, &mut work.candidates);
        for (k, c) in work.candidates.iter().enumerate().skip(first) {
            let i = work.active.len();
            if i == work.rows.len() {
                work.rows.push(Default::default());
            }
            let rows = &mut work.rows[i];
            let prescribed = fill_rows(gears, mesh, [&a, &b], c, rows);
            let rate = rows[0].dot(at.v) + prescribed.gap;
            let stored = mesh.impact_speed(at.discrete, c.slot);
            let impact_speed = if stored > 0.0 { stored } else { -rate };
            let law = mesh.law.shared(c.share);
            let force = if located {
                law.smooth(c.gap, rate, impact_speed, c.stiffness)
            } else {
                law.clipped(c.gap, rate, impact_speed, c.stiffness)
            };
            if !located && force.n == 0.0 {
                continue;
            }
            work.active.push(Active {
                mesh: m,
                candidate: k,
                gap: c.gap,
                rate,
                impact_speed,
                force,
                friction: FrictionForce::default(),
                sliding: 0.0,
                prescribed,
            });
            if mesh.friction.is_some() {
                slide(mesh, at, rows, &mut work.active[i]);
            }
        }
    }

    /// Applies `x += N w + F t` of all active contacts.
    #[inline]
    pub(super) fn add_contact_forces(&self, f: &mut [f64]) {
        for (c, rows) in self.work.active.iter().zip(&self.work.rows) {
            rows[0].add_to(c.force.n, f);
            if self.meshes[c.mesh].friction.is_some() {
                rows[1].add_to(c.friction.f, f);
            }
        }
        if self.fields {
            self.work.nodal.add_forces(&self.gears, f);
        }
    }

    /// Derivative of the normal forces in a direction, one per active contact, into `work.rhs`.
    pub(super) fn normal_tangent(&mut self, dq: &[f64], dv: &[f64]) {
        let work = &mut self.work;
        work.rhs.clear();
        for (c, rows) in work.active.iter().zip(&work.rows) {
            let candidate = &work.candidates[c.candidate];
            let along = -rows[0].dot_first(dq) / candidate.scale[0];
            work.rhs.push(
                c.force.dn_dg * rows[0].dot(dq)
                    + c.force.dn_dgdot * rows[0].dot(dv)
                    + c.force.dn_dk * candidate.stiffness_s * along,
            );
        }
    }

    /// Contact forces at a state, for pictures and reports.
    pub fn contact_forces(&mut self, at: At<'_>) -> Vec<ContactForce> {
        self.evaluate_contacts(at);
        let nodal = self.work.nodal.active.iter().filter(|a| a.force.n > 0.0);
        let nodal = nodal.map(|a| {
            let p = &self.work.nodal.found.points[a.point];
            let normal = a.direction / a.direction.norm();
            ContactForce {
                mesh: p.mesh as usize,
                teeth: p.teeth,
                side: if p.slot == 0 { Side::Left } else { Side::Right },
                x: p.x,
                force: if p.slave == 0 { -a.force.n } else { a.force.n } * normal,
                normal_force: a.force.n,
                gap: a.gap,
            }
        });
        self.work
            .active
            .iter()
            .filter(|c| c.force.n > 0.0)
            .map(|c| {
                let candidate = &self.work.candidates[c.candidate];
                let (teeth, side) = self.meshes[c.mesh].search.flank_of(candidate);
                let n = &candidate.normal;
                ContactForce {
                    mesh: c.mesh,
                    teeth,
                    side,
                    x: candidate.points[0].x,
                    force: c.force.n * n + c.friction.f * sliding_direction(n),
                    normal_force: c.force.n,
                    gap: c.gap,
                }
            })
            .chain(nodal)
            .collect()
    }
}

fn slide(mesh: &SceneMesh, at: At<'_>, rows: &[Row; 3], active: &mut Active) {
    if let Some(friction) = &mesh.friction {
        active.sliding = rows[1].dot(at.v) + active.prescribed.sliding;
        active.friction = friction.force(active.force.n, active.sliding);
    }
}
