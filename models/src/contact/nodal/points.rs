//! Result of a search for nodal contact: points with the nodes of their faces.

use super::nodes::{GearNodes, weighted};
use crate::Vec3;
use crate::contact::gear_state::GearState;
use crate::gear::FlankDisplacement;
use crate::geometry::Side;
use crate::kinematics::{Point, PointWrench, Tooth};

/// A gear of a mesh in the search for nodal points.
pub struct NodalGearState<'a> {
    /// The gear and its state.
    pub gear_state: GearState<'a>,
    /// Flank displacement field, for a gear that has one.
    pub field: Option<&'a dyn FlankDisplacement>,
    /// Active nodes of the gear; empty without a field.
    pub nodes: &'a mut GearNodes,
}

impl NodalGearState<'_> {
    /// Returns a bound of the displacements of the flank nodes before residual compliance [m].
    #[inline]
    pub fn bound(&mut self) -> f64 {
        self.field
            .map_or(0.0, |field| self.nodes.bound(field, self.gear_state.at))
    }
}

/// Bound of the gaps of points that a search returns. Between loaded nodes the residual displacement may bulge
/// outwards, so that points with positive gaps before residual compliance may touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GapBound {
    /// Deepest overlap found so far [m].
    pub depth: f64,
    /// Gap [m] up to which points are returned whatever the overlap.
    pub least: f64,
}

impl GapBound {
    /// Fraction of the deepest overlap up to which positive gaps are returned.
    const BESIDE: f64 = 0.125;

    /// Returns the largest gap before residual compliance of the returned points [m].
    #[inline]
    pub fn gap(&self) -> f64 {
        self.least.max(Self::BESIDE * self.depth)
    }

    /// Returns [`Self::gap`] after a search with overlaps up to a depth [m].
    #[inline]
    pub fn gap_after(&self, depth: f64) -> f64 {
        self.least.max(Self::BESIDE * self.depth.max(depth))
    }

    /// Returns true if a point of that gap is needed, and updates the deepest overlap.
    #[inline]
    pub fn takes(&mut self, gap0: f64) -> bool {
        self.depth = self.depth.max(-gap0);
        gap0 <= self.gap()
    }
}

/// Nodal contact points of the meshes of a scene.
#[derive(Clone, Debug, Default)]
pub struct NodalPoints {
    /// Contact points of all meshes.
    pub points: Vec<NodalPoint>,
    /// Points on partners that have no field and do not move rigidly with their hub.
    pub partners: Vec<Point>,
    /// Additional terms of contacts along lines of flanks.
    pub lines: Vec<LineTerms>,
    /// Derivatives of those lines whose hubs move in further directions than their own.
    pub motions: Vec<RelativeMotion>,
}

impl NodalPoints {
    /// Removes all points.
    pub fn clear(&mut self) {
        self.points.clear();
        self.partners.clear();
        self.lines.clear();
        self.motions.clear();
    }

    /// Returns the derivative of the gap of a line by the motion of the hubs, with outward node displacements `a` of both
    /// gears, and with further derivatives `by_place` by the places on both flanks.
    #[inline]
    pub fn line_slope(&self, line: u32, a: [[f64; 4]; 2], by_place: [f64; 2]) -> LineSlope {
        let line = &self.lines[line as usize];
        let moved = |k: usize| weighted(&line.slopes[k], &a[k]);
        match line.motion {
            LineMotion::OwnDirections(radii) => {
                LineSlope::OwnDirections([0, 1].map(|k| radii[k] - moved(k) + by_place[k]))
            }
            LineMotion::Relative(motion) => {
                let motion = &self.motions[motion as usize];
                let mut gap = motion.gap;
                for k in 0..2 {
                    gap.add(by_place[k] - moved(k), &motion.paths[k]);
                }
                LineSlope::Relative(gap)
            }
        }
    }
}

/// Motion of the hubs of a mesh by which the gap of a line and its places on both flanks change.
#[derive(Clone, Copy, Debug)]
pub enum LineMotion {
    /// Rotation or sliding alone, with the slopes of the gap of undeformed flanks by the displacement of each gear. The
    /// place on a flank is measured by the displacement of its own gear.
    OwnDirections([f64; 2]),
    /// Motion in further directions: index in [`NodalPoints::motions`]. The place on a flank is measured by its path
    /// coordinate.
    Relative(u32),
}

impl Default for LineMotion {
    fn default() -> Self {
        LineMotion::OwnDirections([0.0; 2])
    }
}

/// Derivatives of a line by the motion of the second gear relative to the first, all about one point.
#[derive(Clone, Copy, Debug, Default)]
pub struct RelativeMotion {
    /// Derivative of the gap of undeformed flanks.
    pub gap: PointWrench,
    /// Derivatives of the path coordinates of both flanks.
    pub paths: [PointWrench; 2],
    /// Derivatives of the gap by the motion of the hub of each gear with [deformed lines](crate::gear::DeformedLines),
    /// while its nodes are at rest; zero for other gears.
    pub of_nodes: [PointWrench; 2],
}

/// Derivative of the gap of a line with displaced nodes by the motion of the hubs.
#[derive(Clone, Copy, Debug)]
pub enum LineSlope {
    /// Derivatives by the displacements of both gears.
    OwnDirections([f64; 2]),
    /// Derivative by the motion of the second gear relative to the first.
    Relative(PointWrench),
}

/// Derivatives of a contact along a line of both flanks by its places on them and by the motion of the hubs.
#[derive(Clone, Copy, Debug, Default)]
pub struct LineTerms {
    /// Motion of the hubs.
    pub motion: LineMotion,
    /// Slopes of the weights of the nodes of each gear by the place on its flank.
    pub slopes: [[f64; 4]; 2],
    /// Slopes of the logarithm of the force of the law by the place on each flank.
    pub ln_force: [f64; 2],
    /// Lines of a gear with [deformed lines](crate::gear::DeformedLines) in place of slots. Their weights are those of
    /// the point; their dependence on the hub is part of the motion.
    pub deformed: [Option<[u32; 4]>; 2],
    /// Increase of the slope for nodes that rotate with their gear: it determines the moment about the hub, whatever
    /// the force on the hub coordinate.
    pub with_nodes: [f64; 2],
    /// Relative radius of curvature [m].
    pub radius: f64,
}

/// Contact point of one flank on the other, with the nodes of both faces.
#[derive(Clone, Copy, Debug)]
pub struct NodalPoint {
    /// Index of the mesh in the scene.
    pub mesh: u32,
    /// Mark of the flank side, as in [`Candidate::slot`](crate::contact::Candidate).
    pub slot: u8,
    /// Index of the gear of the mesh with the point (slave); the other is the master.
    pub slave: u8,
    /// Index in [`NodalPoints::partners`], if any.
    pub partner: Option<u32>,
    /// Index in [`NodalPoints::lines`], if it is a line.
    pub line: Option<u32>,
    /// Teeth of the first and second gear of the mesh.
    pub teeth: [Tooth; 2],
    /// Position [m], undeformed if its gear has a field.
    pub x: Vec3,
    /// Normal of the rigid master, out of its tooth: of unit length, or of the length of the taper factor.
    pub normal: Vec3,
    /// Derivative of the position on the face of the master by the displacement of the point [1/m].
    pub sensitivity: [Vec3; 2],
    /// Position on the face of the master, 0 to 1 in both directions.
    pub place: [f64; 2],
    /// Corners of the faces as indices in the [`GearNodes`] of both gears; [`UNUSED`](super::UNUSED) without a field.
    pub slots: [[u32; 4]; 2],
    /// Weights of the corners.
    pub weights: [[f64; 4]; 2],
    /// Gap before residual compliance [m], times the taper factor of a point that leaves contact over the tip.
    pub gap0: f64,
    /// Stiffness of the law, [N/m] for a linear law.
    pub stiffness: f64,
    /// Factor of the damper per area of the law [m^2].
    pub share: f64,
    /// Relative gradient `grad m / m` of the taper factor by the position of the point [1/m]; zero without taper.
    pub taper_gradient: Vec3,
}

impl NodalPoint {
    /// Returns the flank side.
    #[inline]
    pub fn side(&self) -> Side {
        if self.slot == 0 {
            Side::Left
        } else {
            Side::Right
        }
    }

    /// Returns the index of the slave in the mesh, then that of the master.
    #[inline]
    pub fn sides(&self) -> [usize; 2] {
        let slave = usize::from(self.slave);
        [slave, 1 - slave]
    }

    /// Returns the slopes of the master's outward displacements `a` at the corners of the face by the position on it
    /// [m].
    #[inline]
    pub fn slope(&self, a: [f64; 4]) -> [f64; 2] {
        let [s, t] = self.place;
        [
            (1.0 - t) * (a[1] - a[0]) + t * (a[2] - a[3]),
            (1.0 - s) * (a[3] - a[0]) + s * (a[2] - a[1]),
        ]
    }

    /// Returns the direction `d` of the force on the slave, for displacements `a` of the master's corners and a gap
    /// [m].
    #[inline]
    pub fn direction(&self, a: [f64; 4], gap: f64) -> Vec3 {
        let [s, t] = self.slope(a);
        self.normal - s * self.sensitivity[0] - t * self.sensitivity[1] + gap * self.taper_gradient
    }

    /// Multiplies the gap and its derivatives by a taper factor `m` with the given gradient by the position: `m g`
    /// replaces `g`, and `d = m (n - w_a e_a - w_b e_b) + g grad m`.
    pub fn taper(&mut self, factor: f64, gradient: Vec3) {
        self.gap0 *= factor;
        self.normal *= factor;
        for x in self.weights.as_flattened_mut() {
            *x *= factor;
        }
        for e in &mut self.sensitivity {
            *e *= factor;
        }
        self.taper_gradient = gradient / factor;
    }
}
