//! The lines of action of a mesh as data, and the kinematics of its gears.

use super::separation::Separation;
use super::spatial::{MeshPose, NearestPoints, Spatial};
use crate::Vec3;
use crate::contact::gear_state::GearState;
use crate::gear::{GearModel, ToothCoordinates};
use crate::geometry::{Gear, RollMap, Side};
use crate::kinematics::{HubFrame, MeshView, Tooth};
use crate::law::Law;
use crate::stiffness::StiffnessCurve;
use gearbench_integrators::system::StateView;
use std::cell::OnceCell;

/// A slice of the face width.
#[derive(Clone, Debug)]
pub struct Slice {
    /// Position over the width in [-1, 1].
    pub zeta: f64,
    /// Height along the axis [m]; of the sliced gear where axes are not parallel.
    pub z: f64,
    /// Share of the slice in the stiffness.
    pub weight: f64,
    /// Offset of the path coordinates of both gears by the helix, of left and right flanks [m].
    pub offset: [[f64; 2]; 2],
    /// Maps from lengths of roll of both gears to path coordinates where these differ, on left and right flanks of
    /// conical gears.
    pub rolls: Option<Box<[[RollMap; 2]; 2]>>,
    /// Separation of the left and the right flanks of both gears from the involutes.
    pub separation: [[Separation; 2]; 2],
}

/// Geometry of a mesh in its transverse plane.
#[derive(Clone, Debug)]
pub struct MeshGeometry {
    /// View of gear a (never a rack) and gear b from the mesh.
    pub views: [MeshView; 2],
    /// Index of the mesh in each gear's own count.
    pub mesh_of_gear: [u8; 2],
    /// Centre of gear a [m].
    pub centre_a: Vec3,
    /// Axes of the mesh: directions count from the first to the second, the gears rotate about the third.
    pub axes: [Vec3; 3],
    /// Direction from gear a to the pitch point in these axes [rad].
    pub direction: f64,
    /// Distance between the tangent points [m].
    pub length: f64,
    /// Base pitch [m].
    pub base_pitch: f64,
    /// Start and end of the path of contact on `s_a` [m].
    pub zone: [f64; 2],
    /// Base helix angle of gear a [rad].
    pub base_helix: f64,
    /// Gears whose teeth have individual deviations.
    pub deviating: [Option<Gear>; 2],
}

/// Lines of action of both flanks of a mesh.
#[derive(Clone, Debug)]
pub struct LinesOfAction {
    pub(super) mesh: MeshGeometry,
    /// Tooth index of b in pair 0, with tooth 0 of a, for the left and the right flank.
    pub partner: [i64; 2],
    /// Steps of the tooth numbers of both gears from one left pair to the next.
    pub(super) counting: [i64; 2],
    /// Stiffness of a pair along `s_a`, for the whole width.
    pub stiffness: StiffnessCurve,
    /// Contact law without its damping.
    pub(super) elastic: Law,
    /// True for one spring of the whole mesh, whatever the number of pairs in contact.
    pub whole_mesh: bool,
    /// Slices over the width; one for a spur gear.
    pub slices: Vec<Slice>,
    /// Number of contact slots per line.
    pub pairs: usize,
    /// Path coordinates `s_a` between which pairs may touch [m].
    pub(super) zone: [f64; 2],
    pub(super) helix_cos: f64,
    pub(super) per_base_pitch: f64,
    pub(super) lines: Vec<Line>,
    /// Flanks in space, where axes are not parallel or hubs move out of the plane.
    pub(super) spatial: Option<Box<Spatial>>,
    /// True if hubs translate and axes stay parallel, and the heights of both centres at the start [m].
    pub(super) planar: bool,
    pub(super) heights: [f64; 2],
}

/// One flank side of one slice.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) side: Side,
    pub(super) slice: usize,
    /// Unit normal from a to b, and its transverse part.
    pub(super) normal: Vec3,
    pub(super) transverse: Vec3,
    /// Tangent point on gear a in the plane of the slice.
    pub(super) origin: Vec3,
    /// Path coordinate `s = at_zero + per_displacement * displacement + per_pair * pair` for both gears, helix
    /// included.
    pub(super) map: [PathMap; 2],
    /// True if the tooth numbers increase with the pairs, for both gears.
    pub(super) ascending: [bool; 2],
    /// True if neither flank is modified and no tooth deviates. Teeth that move together then have one gap, `helix_cos
    /// (slack - per_displacement_a displacement_a - per_displacement_b displacement_b)`, and beyond their tips a
    /// larger one.
    pub(super) plain: bool,
    pub(super) slack: f64,
    /// Path coordinates of both gears beyond which the tip edge touches [m].
    pub(super) tips: [f64; 2],
}

/// Path coordinate of a flank as a linear function of its tooth's displacement and the pair number.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PathMap {
    pub(super) at_zero: f64,
    pub(super) per_displacement: f64,
    pub(super) per_pair: f64,
}

impl PathMap {
    #[inline(always)]
    pub(super) fn s(&self, displacement: f64, pair: i64) -> f64 {
        self.at_zero + self.per_displacement * displacement + self.per_pair * pair as f64
    }
}

/// Kinematics of a gear at a state, for the lines of action.
pub(super) struct GearKinematics<'a> {
    pub(super) at: StateView<'a>,
    pub(super) displacements: Displacements<'a>,
    gear: &'a dyn GearModel,
    frame: OnceCell<(HubFrame, f64)>,
}

/// Displacements of the teeth of a gear.
#[derive(Clone, Copy)]
pub(super) enum Displacements<'a> {
    /// All teeth move with the hub, by its displacement.
    OfHub(f64),
    /// Each tooth has its own displacement.
    OfTeeth(&'a dyn ToothCoordinates),
}

impl<'a> GearKinematics<'a> {
    #[inline]
    pub(super) fn new(gear_state: &GearState<'a>) -> Self {
        let GearState { gear, at } = *gear_state;
        let displacements = match gear.teeth() {
            Some(teeth) => Displacements::OfTeeth(teeth),
            None => Displacements::OfHub(gear.hub().displacement_at(at)),
        };
        GearKinematics {
            at,
            displacements,
            gear,
            frame: OnceCell::new(),
        }
    }

    /// Returns the axes of the hub, and the part of a tooth's displacement that moves these.
    pub(super) fn frame(&self) -> &(HubFrame, f64) {
        self.frame.get_or_init(|| {
            let hub = self.gear.hub();
            let along = hub.slide.map_or(0.0, |_| hub.displacement_at(self.at));
            (hub.hub.frame(self.at.t, self.at.q), along)
        })
    }
}

/// Derivatives that the nearest points of flanks in space include.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd)]
pub(super) enum PointDerivatives {
    /// The derivative of the gap alone.
    Gap,
    /// The derivatives of the gap and of the path coordinate.
    Path,
    /// The derivatives of the gap and of the lengths of roll of both flanks.
    Rolls,
}

/// Both gears of a mesh at a state.
pub(super) struct MeshedGears<'a> {
    pub(super) of: [GearKinematics<'a>; 2],
    pub(super) derivatives: PointDerivatives,
    pose: OnceCell<MeshPose>,
}

impl<'a> MeshedGears<'a> {
    #[inline]
    pub(super) fn new(a: &GearState<'a>, b: &GearState<'a>) -> Self {
        MeshedGears {
            of: [GearKinematics::new(a), GearKinematics::new(b)],
            derivatives: PointDerivatives::Path,
            pose: OnceCell::new(),
        }
    }

    /// Creates the gears of a mesh of which only gaps and gap rates are needed.
    #[inline]
    pub(super) fn for_gaps(a: &GearState<'a>, b: &GearState<'a>) -> Self {
        MeshedGears {
            derivatives: PointDerivatives::Gap,
            ..Self::new(a, b)
        }
    }

    /// Creates the gears of a mesh whose contacts have places on both flanks.
    #[inline]
    pub(super) fn for_lines(a: &GearState<'a>, b: &GearState<'a>) -> Self {
        MeshedGears {
            derivatives: PointDerivatives::Rolls,
            ..Self::new(a, b)
        }
    }

    /// Returns the poses of the hubs of a mesh in space.
    #[inline]
    pub(super) fn pose(&self, spatial: &Spatial) -> &MeshPose {
        self.pose
            .get_or_init(|| spatial.pose([0, 1].map(|k| &self.of[k].frame().0)))
    }
}

/// A tooth pair at a state.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairState {
    pub(super) teeth: [Tooth; 2],
    pub(super) s: [f64; 2],
    pub(super) gap: f64,
    pub(super) scale: [f64; 2],
    pub(super) curvature: [f64; 2],
    /// Nearest points of the flanks, in space.
    pub(super) touch: Option<NearestPoints>,
}

pub(super) const ZONE_EVENTS: usize = 4;

/// Returns true if no slot is closed; per slot `(mode, impact speed)`.
#[inline]
pub(crate) fn all_open(modes: &[f64]) -> bool {
    let mut slot = 0;
    while slot < modes.len() {
        if modes[slot] != 0.0 {
            return false;
        }
        slot += 2;
    }
    true
}

#[inline]
pub(super) fn side_index(side: Side) -> usize {
    match side {
        Side::Left => 0,
        Side::Right => 1,
    }
}
