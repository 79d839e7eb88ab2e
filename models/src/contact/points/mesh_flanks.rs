//! Flanks of a mesh, and the limits of the point search.

use super::flanked::{FlankedGear, NearbyFlank};
use super::poses::{Layout, MeshPoses};
use super::projection::TipTaper;
use super::rule::Rule;
use super::search_gear::SearchGear;
use crate::contact::clearance::Clearance;
use crate::contact::gear_state::GearState;
use crate::contact::nodal::NodalPoint;
use crate::contact::pairs::MeshGeometry;
use crate::error::Reason;
use crate::geometry::Side;
use crate::kinematics::Tooth;
use crate::spec::{Body, Passes, PointContact, PointLaw};

/// Largest gap of undeformed flanks in the search, relative to the base pitch.
const REACH: f64 = 0.02;

/// Distance before and behind the path of contact in which teeth may touch, relative to the base pitch.
const BEFORE_AND_AFTER: f64 = 0.5;

/// Flanks of both gears of a mesh, with penalties and limits of the search.
#[derive(Debug)]
pub(super) struct MeshFlanks {
    pub gears: [FlankedGear; 2],
    pub rule: Rule,
    /// Penalty for the points of each gear [Pa/m]; 0 for a gear whose points are not used.
    pub penalty: [f64; 2],
    /// Largest gap of returned points [m].
    pub reach: f64,
    /// Distance between the tangent points [m].
    pub length: f64,
    pub helix_cos: f64,
    pub base_pitch: f64,
    /// True if all points within reach are returned, because gaps are averaged over them.
    pub hard: bool,
    /// Range of path coordinates of the first gear in which its flanks are searched [m].
    pub zone: [f64; 2],
    /// Layout of gears whose axes are not parallel or may move; `None` for parallel fixed axes at one height.
    pub layout: Option<Layout>,
}

impl MeshFlanks {
    pub fn new(
        search_gears: [SearchGear<'_>; 2],
        geometry: &MeshGeometry,
        settings: &PointContact,
    ) -> Result<Self, (Option<usize>, Reason)> {
        if let Some(problem) = settings.problem() {
            return Err((None, problem));
        }
        let rule = Rule::new(settings.rule);
        let flanked = |k: usize| {
            FlankedGear::new(search_gears[k], settings.surface, &rule).map_err(|e| (Some(k), e))
        };
        let gears = [flanked(0)?, flanked(1)?];
        // Hard contact uses the areas of the points alone, so that its penalty is arbitrary.
        let (hard, p) = match settings.law {
            PointLaw::Penalty { stiffness, .. } => (false, stiffness),
            PointLaw::Hard => (true, 1.0),
        };
        let penalty = match settings.passes {
            Passes::First => [p, 0.0],
            Passes::Second => [0.0, p],
            Passes::Auto if hard && (gears[0].own || !gears[1].own) => [p, 0.0],
            Passes::Auto if hard => [0.0, p],
            Passes::Auto | Passes::Both => [0.5 * p, 0.5 * p],
        };
        let layout = Layout::of(&search_gears, geometry, &gears);
        let width = gears[0].face_width.min(gears[1].face_width);
        // Flanks of both sides of a conical gear have helix angles of their own.
        let steepest = |o: &SearchGear<'_>| match o.body {
            Body::Gear(g) if g.is_conical() => Side::BOTH
                .map(|side| g.flank(side).tan_helix.abs())
                .into_iter()
                .fold(0.0, f64::max),
            _ => geometry.base_helix.tan().abs(),
        };
        let steepest = steepest(&search_gears[0]).max(steepest(&search_gears[1]));
        let beside = BEFORE_AND_AFTER * geometry.base_pitch + 0.5 * width * steepest;
        let reach = settings.reach.unwrap_or(REACH * geometry.base_pitch);
        Ok(MeshFlanks {
            gears,
            rule,
            penalty,
            reach,
            length: geometry.length,
            helix_cos: geometry.base_helix.cos(),
            base_pitch: geometry.base_pitch,
            hard,
            zone: [geometry.zone[0] - beside, geometry.zone[1] + beside],
            layout,
        })
    }

    /// Returns the largest distance of flanks on the path coordinate with points within reach [m].
    pub fn reach_along(&self) -> f64 {
        self.along(self.reach)
    }

    /// Converts a gap [m] to a distance of flanks on the path coordinate [m].
    pub fn along(&self, gap: f64) -> f64 {
        gap / self.helix_cos
    }

    pub fn tooth(&self, k: usize, near: &NearbyFlank) -> Tooth {
        Tooth {
            index: near.tooth,
            mesh: self.gears[k].mesh,
        }
    }

    /// Returns the poses of both gears at a state.
    #[inline]
    pub fn poses(&self, gear_states: [&GearState<'_>; 2]) -> MeshPoses {
        let displacements = gear_states.map(|p| p.gear.hub().displacement(p.at.t, p.at.q));
        let poses = [0, 1].map(|k| self.gears[k].pose(gear_states[k], displacements[k]));
        MeshPoses {
            beside: self.layout.map_or(0.0, |layout| layout.beside(&poses)),
            displacements,
            poses,
        }
    }

    /// Returns lower bounds of the gaps of all points of rigid flanks at hub displacements, with hubs otherwise at
    /// their assembled position; `None` where flanks move otherwise or no bound is known.
    pub fn clearance(&self, displacements: [f64; 2]) -> Option<Clearance> {
        let mut gaps = [0.0; 2];
        for (side, gap) in Side::BOTH.into_iter().zip(&mut gaps) {
            let [a, b] = [0, 1].map(|k| self.gears[k].foremost(side, displacements[k]));
            let along = self.length - a? - b?;
            let nearest = along - self.base_pitch * (along / self.base_pitch).round();
            *gap = nearest * self.helix_cos;
        }
        Some(Clearance {
            gaps,
            per_displacement: [0, 1].map(|k| -self.helix_cos * self.gears[k].per_displacement()),
        })
    }

    /// Applies the tip taper to a point that leaves contact over the tip: to its area for averages of gaps, otherwise
    /// to its gap.
    #[inline]
    pub fn taper(&self, point: &mut NodalPoint, taper: &TipTaper) {
        if !taper.acts() {
        } else if self.hard {
            point.stiffness *= taper.area();
        } else {
            point.taper(taper.factor, taper.gradient);
        }
    }

    /// Returns the factor of the damper of the contact for a point of gear `k` with an area [m^2].
    pub fn share(&self, k: usize, area: f64) -> f64 {
        area * self.penalty[k] / (self.penalty[0] + self.penalty[1])
    }
}
