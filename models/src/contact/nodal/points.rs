//! What a search hands over: points with the nodes that they lie on.

use super::nodes::{GearNodes, weighted};
use crate::Vec3;
use crate::contact::party::Party;
use crate::gear::FlankDisplacement;
use crate::geometry::Side;
use crate::kinematics::{Point, Tooth};

/// A gear of a mesh in the search for nodal points.
pub struct NodalParty<'a> {
    /// The gear and its state.
    pub party: Party<'a>,
    /// Its field, where it has one.
    pub field: Option<&'a dyn FlankDisplacement>,
    /// Its active nodes; empty without a field.
    pub nodes: &'a mut GearNodes,
}

impl NodalParty<'_> {
    /// A bound of the displacements of its flank nodes before residual compliance [m].
    #[inline]
    pub fn bound(&mut self) -> f64 {
        self.field
            .map_or(0.0, |field| self.nodes.bound(field, self.party.at))
    }
}

/// Which points are wanted beyond those that touch without residual compliance: between loaded nodes the residual
/// displacement may rise outwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GapBound {
    /// Deepest overlap found so far [m].
    pub depth: f64,
    /// Gap [m] up to which points are wanted whatever the overlap.
    pub least: f64,
}

impl GapBound {
    /// Part of the deepest overlap.
    const BESIDE: f64 = 0.125;

    /// Largest gap before residual compliance that is wanted [m].
    #[inline]
    pub fn gap(&self) -> f64 {
        self.least.max(Self::BESIDE * self.depth)
    }

    /// [`Self::gap`] after a search that finds overlaps up to a depth [m].
    #[inline]
    pub fn gap_after(&self, depth: f64) -> f64 {
        self.least.max(Self::BESIDE * self.depth.max(depth))
    }

    /// Whether a point of that gap is wanted; it may deepen the overlap.
    #[inline]
    pub fn takes(&mut self, gap0: f64) -> bool {
        self.depth = self.depth.max(-gap0);
        gap0 <= self.gap()
    }
}

/// Points of a scene's meshes.
#[derive(Clone, Debug, Default)]
pub struct NodalPoints {
    /// The points.
    pub points: Vec<NodalPoint>,
    /// Points on partners that neither have a field nor move as one with their hub.
    pub partners: Vec<Point>,
    /// What contacts along lines of flanks have of their own.
    pub lines: Vec<LineTerms>,
}

impl NodalPoints {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.points.clear();
        self.partners.clear();
        self.lines.clear();
    }
}

/// How a contact along a line of both flanks answers to the displacements of the gears of its mesh.
#[derive(Clone, Copy, Debug, Default)]
pub struct LineTerms {
    /// Slope of the gap of undeformed flanks by the displacement of either gear.
    pub effective_radii: [f64; 2],
    /// Slopes of the weights of the nodes of either gear by its displacement.
    pub slopes: [[f64; 4]; 2],
    /// Slopes of the logarithm of the law's force.
    pub ln_force: [f64; 2],
    /// Lines of a gear that [says where its nodes are](crate::gear::DeformedLines) in the place of slots; their weights
    /// are those of the point, and what follows them with the hub is in the effective radius.
    pub deformed: [Option<[u32; 4]>; 2],
    /// By how much its slope is larger where these nodes turn with their gear: the moment about the hub goes by that, whatever
    /// the hub itself feels.
    pub with_nodes: [f64; 2],
    /// Relative radius of curvature [m].
    pub radius: f64,
}

impl LineTerms {
    /// Slope of the gap by the displacement of gear `k`, its nodes displaced outwards by `a`.
    #[inline]
    pub fn effective_radius(&self, k: usize, a: &[f64; 4]) -> f64 {
        self.effective_radii[k] - weighted(&self.slopes[k], a)
    }
}

/// A point of one flank held against the other, with the nodes that both lie on.
#[derive(Clone, Copy, Debug)]
pub struct NodalPoint {
    /// Mesh of the scene.
    pub mesh: u32,
    /// A mark of its flank side, as [`Candidate::slot`](crate::contact::Candidate).
    pub slot: u8,
    /// Which gear of the mesh the point belongs to; the other is the master.
    pub slave: u8,
    /// Its place among [`NodalPoints::partners`], if it has one.
    pub partner: Option<u32>,
    /// Its place among [`NodalPoints::lines`], if it is a line.
    pub line: Option<u32>,
    /// Teeth of the first and second gear of the mesh.
    pub teeth: [Tooth; 2],
    /// Position [m], undeformed where its gear has a field.
    pub x: Vec3,
    /// Normal of the rigid master, out of its tooth: of unit length, or of the factor of a point that leaves.
    pub normal: Vec3,
    /// How the place on the master's face answers to the point's motion [1/m].
    pub sensitivity: [Vec3; 2],
    /// Place on the master's face, 0 to 1.
    pub place: [f64; 2],
    /// Corners of the faces among the [`GearNodes`] of both gears; [`UNUSED`](super::UNUSED) without a field.
    pub slots: [[u32; 4]; 2],
    /// Their weights.
    pub weights: [[f64; 4]; 2],
    /// Gap before residual compliance [m], times the factor of a point that leaves over the tip.
    pub gap0: f64,
    /// Stiffness of the law, [N/m] for a linear law.
    pub stiffness: f64,
    /// What the law's damper per area is multiplied by [m^2].
    pub share: f64,
    /// `grad m / m` of the factor of a point that leaves over the tip, by its position; else zero [1/m].
    pub fading: Vec3,
}

impl NodalPoint {
    /// Side of the flanks.
    #[inline]
    pub fn side(&self) -> Side {
        if self.slot == 0 {
            Side::Left
        } else {
            Side::Right
        }
    }

    /// Index of the slave in the mesh, then of the master.
    #[inline]
    pub fn sides(&self) -> [usize; 2] {
        let slave = usize::from(self.slave);
        [slave, 1 - slave]
    }

    /// Slope of the master's outward displacements `a` at the corners of the face, by the place on it [m].
    #[inline]
    pub fn slope(&self, a: [f64; 4]) -> [f64; 2] {
        let [s, t] = self.place;
        [
            (1.0 - t) * (a[1] - a[0]) + t * (a[2] - a[3]),
            (1.0 - s) * (a[3] - a[0]) + s * (a[2] - a[1]),
        ]
    }

    /// Direction `d` of the force on the slave, for displacements `a` of the master's corners and a gap [m].
    #[inline]
    pub fn direction(&self, a: [f64; 4], gap: f64) -> Vec3 {
        let [s, t] = self.slope(a);
        self.normal - s * self.sensitivity[0] - t * self.sensitivity[1] + gap * self.fading
    }

    /// Multiplies the gap and all that it is made of with a factor `m`, whose gradient by the position is given: `m g`
    /// takes the place of `g`, and `d = m (n - w_a e_a - w_b e_b) + g grad m`.
    pub fn fade(&mut self, factor: f64, gradient: Vec3) {
        self.gap0 *= factor;
        self.normal *= factor;
        for x in self.weights.as_flattened_mut() {
            *x *= factor;
        }
        for e in &mut self.sensitivity {
            *e *= factor;
        }
        self.fading = gradient / factor;
    }
}
