//! Construction of the lines of action of a mesh from its geometry: normals, tangent points, path coordinates,
//! partners.

use super::lines::{Line, LinesOfAction, MeshGeometry, PathMap, Slice, side_index};
use super::separation::Separation;
use super::spatial::Spatial;
use crate::contact::clearance::LineClearance;
use crate::geometry::{Gear, Side};
use crate::kinematics::MeshView;
use crate::law::Law;
use crate::stiffness::{PairOrMesh, StiffnessCurve};

/// Returns the step of the tooth numbers of both gears from a left pair to the next, in the direction of increasing
/// path coordinate of the first gear.
fn counting(views: &[MeshView; 2]) -> [i64; 2] {
    let up = |view: &MeshView| view.path_per_displacement() > 0.0;
    let one = if up(&views[0]) { 1 } else { -1 };
    // The path coordinate of the mate decreases.
    [one, if up(&views[1]) { -1 } else { 1 }]
}

impl LinesOfAction {
    /// Builds the lines of both flanks.
    pub fn new(g: MeshGeometry, stiffness: StiffnessCurve, law: &Law, slices: Vec<Slice>) -> Self {
        let whole_mesh = stiffness.of() == PairOrMesh::Mesh;
        let view = &g.views[0];
        let (delta, alpha) = (g.direction, view.working_pressure_angle);
        let rb = view.base_radius.unwrap_or(0.0);
        // The outward normal of an internal gear points the other way along the line.
        let inward = rb.signum();
        let mut lines = Vec::new();
        for side in [Side::Left, Side::Right] {
            let sign = side.sign();
            let along = delta + sign * (std::f64::consts::FRAC_PI_2 - alpha);
            let [x, y, axis] = g.axes;
            let transverse = inward * (along.cos() * x + along.sin() * y);
            let to_tangent = delta - sign * alpha;
            let (c, s) = (g.base_helix.cos(), g.base_helix.sin());
            let normal = c * transverse - inward * sign * s * axis;
            for (i, slice) in slices.iter().enumerate() {
                let tangent = rb.abs() * (to_tangent.cos() * x + to_tangent.sin() * y);
                let origin = g.centre_a + tangent + slice.z * axis;
                lines.push(Line {
                    side,
                    slice: i,
                    normal,
                    transverse,
                    origin,
                    map: [PathMap::default(); 2],
                    ascending: [true; 2],
                    plain: slice.separation[side.index()]
                        .iter()
                        .all(Separation::is_plain)
                        && g.deviating.iter().all(Option::is_none),
                    slack: 0.0,
                    tips: [0, 1].map(|k| slice.separation[side.index()][k].edge()[0]),
                });
            }
        }
        let zone = g.views[0].touching;
        let ratio = (zone[1] - zone[0]) / g.base_pitch;
        let pairs = if whole_mesh {
            1
        } else {
            ratio.floor() as usize + 2
        };
        let mut loa = LinesOfAction {
            partner: [0, 0],
            counting: counting(&g.views),
            stiffness,
            elastic: law.undamped(),
            whole_mesh,
            slices,
            pairs,
            zone,
            helix_cos: g.base_helix.cos(),
            per_base_pitch: g.base_pitch.recip(),
            mesh: g,
            lines,
            spatial: None,
            planar: false,
            heights: [0.0; 2],
        };
        for side in [Side::Left, Side::Right] {
            let gap = |j: i64| {
                let a = loa.mesh.views[0].path_coordinate(side, loa.mesh.views[0].assembled);
                let vb = &loa.mesh.views[1];
                let b = vb.path_coordinate(side, vb.assembled + j as f64 * vb.pitch);
                loa.mesh.length - a - b
            };
            let slope = gap(1) - gap(0);
            loa.partner[side_index(side)] = (-gap(0) / slope).round() as i64;
        }
        for l in 0..loa.lines.len() {
            let (side, slice) = (loa.lines[l].side, loa.lines[l].slice);
            let offset = loa.slices[slice].offset[side_index(side)];
            let teeth = [0, 1].map(|pair| loa.teeth(side, pair));
            loa.lines[l].ascending = [0, 1].map(|k| teeth[1][k].index > teeth[0][k].index);
            loa.lines[l].map = [0, 1].map(|k| {
                let v = &loa.mesh.views[k];
                let s = |tooth: i64, displacement: f64| {
                    v.path_coordinate(side, v.assembled + displacement + tooth as f64 * v.pitch)
                };
                let (t0, t1) = (teeth[0][k].index, teeth[1][k].index);
                PathMap {
                    at_zero: s(t0, 0.0) + offset[k],
                    per_displacement: side.sign() * v.path_per_displacement(),
                    // One base pitch per pair, up for gear a and down for gear b.
                    per_pair: (s(t1, 0.0) - s(t0, 0.0)).signum() * loa.mesh.base_pitch,
                }
            });
            loa.lines[l].slack =
                loa.mesh.length - loa.lines[l].map[0].at_zero - loa.lines[l].map[1].at_zero;
        }
        loa
    }

    /// Builds the lines for flanks in space.
    #[must_use]
    pub fn in_space(mut self, spatial: Spatial) -> Self {
        self.spatial = Some(Box::new(spatial));
        for line in &mut self.lines {
            line.plain = false;
        }
        self
    }

    /// Returns true if contact rows rotate with the hubs: axes are not parallel, or hubs move out of the plane.
    pub fn is_spatial(&self) -> bool {
        self.planar || self.spatial.is_some()
    }

    /// Returns the clearances of the mesh, one per line; empty for hubs that move out of the plane, whose clearances
    /// are not linear.
    pub fn clearances(&self) -> Vec<LineClearance> {
        if self.is_spatial() {
            return Vec::new();
        }
        let of = |line: &Line| {
            let modified: f64 = (self.slices[line.slice].separation[line.side.index()].iter())
                .map(Separation::lowest)
                .sum();
            let gears = self.mesh.deviating.iter().flatten();
            let stands_off: f64 = gears.map(Gear::greatest_tooth_deviation).sum();
            let plain = self.plain_clearance(line);
            LineClearance {
                assembled: plain.assembled + modified - stands_off,
                ..plain
            }
        };
        self.lines.iter().map(of).collect()
    }

    fn plain_clearance(&self, line: &Line) -> LineClearance {
        LineClearance {
            assembled: self.helix_cos * line.slack,
            per_displacement: line.map.map(|m| -self.helix_cos * m.per_displacement),
        }
    }

    /// Returns the gap of pair 0 of a flank at the assembled position [m], without modifications.
    pub fn assembled_gap(&self, side: Side) -> f64 {
        let j = self.partner[side_index(side)];
        let a = self.mesh.views[0].path_coordinate(side, self.mesh.views[0].assembled);
        let vb = &self.mesh.views[1];
        self.mesh.length - a - vb.path_coordinate(side, vb.assembled + j as f64 * vb.pitch)
    }
}
