//! How both gears of a mesh stand: their own frames in space, and how far from where they were laid out.

use super::flanked::Flanked;
use super::owner::Owner;
use crate::Vec3;
use crate::contact::pairs::MeshGeometry;
use crate::kinematics::Pose;

/// Angle between two axes below which they are parallel [rad].
const PARALLEL: f64 = 1e-12;

/// Both gears at a state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stand {
    /// Of the hubs along their own motion [rad] or [m].
    pub displacements: [f64; 2],
    /// The own frames in space.
    pub poses: [Pose; 2],
    /// By how much all other motion of the hubs may bring flanks together along the path of contact [m].
    pub beside: f64,
}

impl Stand {
    pub fn is_finite(&self) -> bool {
        self.displacements.iter().all(|x| x.is_finite()) && self.beside.is_finite()
    }
}

/// Where the gears of a mesh were laid out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    /// From the centre of the first gear to that of the second [m].
    apart: Vec3,
    /// Those of both gears: the one in common of cylindrical gears, on which their flanks are the same everywhere.
    axes: [Vec3; 2],
    /// How far nodes are from the centres of their gears at most [m].
    radii: [f64; 2],
    /// Of the path of contact per length along the axis.
    tan_helix: f64,
    slides: [bool; 2],
}

impl Layout {
    /// That of gears which do not just turn about parallel axes, their middles at one height.
    pub fn of(
        owners: &[Owner<'_>; 2],
        geometry: &MeshGeometry,
        gears: &[Flanked; 2],
    ) -> Option<Self> {
        let [a, b] = [0, 1].map(|k| &owners[k].gear.hub().hub);
        let apart = b.centre - a.centre;
        let held = a.lateral.is_none() && b.lateral.is_none();
        let parallel = a.axes[2].cross(&b.axes[2]).norm() < PARALLEL;
        if held && parallel && a.axes[2].dot(&apart).abs() < PARALLEL * apart.norm() {
            return None;
        }
        let furthest = |g: &Flanked| {
            let nodes = g.shapes.iter().flat_map(|s| &s.positions);
            nodes.fold(0.0_f64, |most, x| most.max(x.norm()))
        };
        Some(Layout {
            apart,
            axes: match gears.iter().any(|g| g.conical) {
                true => [a.axes[2], b.axes[2]],
                false => [geometry.axes[2]; 2],
            },
            radii: [0, 1].map(|k| furthest(&gears[k])),
            tan_helix: geometry.base_helix.tan().abs(),
            slides: [0, 1].map(|k| gears[k].rack),
        })
    }

    /// What the gears' being elsewhere may change the path coordinates by [m].
    pub fn beside(&self, poses: &[Pose; 2]) -> f64 {
        let mut moved = poses[1].origin - poses[0].origin - self.apart;
        for (pose, _) in poses.iter().zip(self.slides).filter(|(_, slides)| *slides) {
            // Along its slide a rack moves as its displacement tells.
            let slide = &pose.axes[1];
            moved -= slide.dot(&moved) * slide;
        }
        let tilts = poses.iter().zip(self.radii).zip(&self.axes);
        let tilted: f64 = tilts
            .map(|((p, radius), axis)| radius * p.axes[2].cross(axis).norm())
            .sum();
        (1.0 + self.tan_helix) * (moved.norm() + tilted)
    }
}
