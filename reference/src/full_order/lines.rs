//! The flanks of a full-order gear as lines, for contact on half-spaces.
//!
//! Outward displacement of a line of nodes with weights `w` and outward normals `n` in the frame on the hub,
//!
//! ```text
//! a = sum w n . u,    u = R^T (X + d - s) - X,    da/dd = w R n
//! da = -F . v - M . w,    F = R sum w n,    M = R sum (X + u) x w n
//! ```
//!
//! for a hub at `s` with the velocity `v` and the angular velocity `w`, about its origin:
//! the same sums as those of a reduction ([`LinesOfFlanks`]).

use super::FullOrder;
use super::kinematics::dot3;
use crate::gear_mesh::GearMesh;
use crate::reduction::{Surface, near_field_of_flanks};
use gearbench_integrators::system::StateView;
use gearbench_models::Vec3;
use gearbench_models::error::Reason;
use gearbench_models::gear::DeformedLines;
use gearbench_models::gear::elastic::lines::{LinesOfFlanks, Strips};
use gearbench_models::geometry::Flanks;
use gearbench_models::kinematics::{PointWrench, Pose, Row};
use gearbench_models::stiffness::Material;
use std::sync::Arc;

/// Lines of the flanks of a gear; empty where its contact does not use them.
#[derive(Debug, Default)]
pub struct Lines {
    flanks: Flanks,
    near_field: Arc<Vec<Vec<f64>>>,
    /// Each line as nodes of its mesh, with weights times outward normals in the frame.
    sums: Vec<Vec<(u32, [f64; 3])>>,
}

impl Lines {
    /// Returns true if there are no lines.
    pub fn is_empty(&self) -> bool {
        self.sums.is_empty()
    }

    /// Returns the nodes of a line; the surface has checked that no flank node is tied to the hub.
    fn of(&self, line: u32) -> &[(u32, [f64; 3])] {
        self.sums.get(line as usize).map_or(&[], Vec::as_slice)
    }

    /// The lines of a mesh in its own frame, which `pose` turns into the assembled position.
    ///
    /// # Errors
    /// Why its flanks make no lines.
    pub fn new(
        mesh: &GearMesh,
        material: &Material,
        pose: &Pose,
        strips: Strips,
    ) -> Result<Self, Reason> {
        let surface = Surface::new(mesh).map_err(|e| e.to_string())?;
        let near_field =
            near_field_of_flanks(mesh, material, &surface).map_err(|e| e.to_string())?;
        let Some(near_field) = near_field else {
            return Err((
                "half-space contact needs the response of the mesh to a line load, which is not available for these flanks",
                "use straight teeth or C3D8 or C3D8I, or give the contact local = \"mesh\"",
            )
                .into());
        };
        let lines = LinesOfFlanks::new(&surface.flanks, &near_field, strips)?;
        let surface = &surface;
        let of_node = |&(node, w): &(usize, f64)| {
            let n = w * pose.turn(&surface.directions[node]);
            (surface.follows(node)).map(move |(node, share)| (node, (share * n).into()))
        };
        Ok(Lines {
            sums: (lines.sums.iter())
                .map(|sum| sum.iter().flat_map(of_node).collect())
                .collect(),
            flanks: lines.flanks,
            near_field: lines.near_field,
        })
    }
}

impl DeformedLines for FullOrder {
    fn flanks(&self) -> &Flanks {
        &self.lines.flanks
    }

    fn near_field(&self) -> &Arc<Vec<Vec<f64>>> {
        &self.lines.near_field
    }

    fn outward(&self, at: StateView<'_>, line: u32) -> (f64, PointWrench) {
        let (frame, d) = (self.frame(at), &at.q[self.own..]);
        let (mut outward, mut force, mut moment) = (0.0, Vec3::zeros(), Vec3::zeros());
        for (node, direction) in self.lines.of(line) {
            let x = &self.body.position[*node as usize];
            let place = self.body.place[*node as usize] as usize;
            let u = frame.elastic(x, &d[3 * place..][..3]);
            outward += dot3(u, direction);
            let direction = Vec3::from(*direction);
            force -= direction;
            moment -= (x + Vec3::from(u)).cross(&direction);
        }
        let by_hub = PointWrench {
            point: self.hub.hub.frame(at.t, at.q).origin,
            force: frame.to_space(force.into()).into(),
            moment: frame.to_space(moment.into()).into(),
        };
        (outward, by_hub)
    }

    fn row(&self, at: StateView<'_>, lines: &[u32; 4], weights: &[f64; 4], row: &mut Row) {
        let frame = self.frame(at);
        for (&line, w) in lines.iter().zip(weights) {
            for (node, direction) in self.lines.of(line) {
                let place = self.body.place[*node as usize] as usize;
                let along = frame.to_space(direction.map(|x| w * x));
                row.push_span(self.own + 3 * place, along);
            }
        }
    }
}
