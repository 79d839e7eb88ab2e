//! Poses of both gears of a mesh: their frames in space, and their distance from the layout of the mesh.

use super::flanked::FlankedGear;
use super::search_gear::SearchGear;
use crate::Vec3;
use crate::contact::pairs::MeshGeometry;
use crate::kinematics::Pose;

/// Angle between two axes below which they count as parallel [rad].
const PARALLEL: f64 = 1e-12;

/// Poses and displacements of both gears at a state.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeshPoses {
    /// Displacements of the hubs along their own motion [rad or m].
    pub displacements: [f64; 2],
    /// Gear frames in space.
    pub poses: [Pose; 2],
    /// Largest approach of the flanks along the path of contact by all other motion of the hubs [m].
    pub beside: f64,
}

impl MeshPoses {
    pub fn is_finite(&self) -> bool {
        self.displacements.iter().all(|x| x.is_finite()) && self.beside.is_finite()
    }
}

/// Layout of the gears of a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    /// Vector from the centre of the first gear to that of the second [m].
    apart: Vec3,
    /// Axes of both gears; for cylindrical gears the common axis, along which their flanks are equal.
    axes: [Vec3; 2],
    /// Largest distance of the nodes of each gear from its centre [m].
    radii: [f64; 2],
    /// Change of the path of contact per length along the axis.
    tan_helix: f64,
    slides: [bool; 2],
}

impl Layout {
    /// Returns the layout of gears that do not merely rotate about parallel fixed axes with their middles at one
    /// height, otherwise `None`.
    pub fn of(
        search_gears: &[SearchGear<'_>; 2],
        geometry: &MeshGeometry,
        gears: &[FlankedGear; 2],
    ) -> Option<Self> {
        let [a, b] = [0, 1].map(|k| &search_gears[k].gear.hub().hub);
        let apart = b.centre - a.centre;
        let held = a.lateral.is_none() && b.lateral.is_none();
        let parallel = a.axes[2].cross(&b.axes[2]).norm() < PARALLEL;
        if held && parallel && a.axes[2].dot(&apart).abs() < PARALLEL * apart.norm() {
            return None;
        }
        let furthest = |g: &FlankedGear| {
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

    /// Returns the largest change of the path coordinates from out-of-plane hub motion [m].
    pub fn beside(&self, poses: &[Pose; 2]) -> f64 {
        let mut moved = poses[1].origin - poses[0].origin - self.apart;
        for (pose, _) in poses.iter().zip(self.slides).filter(|(_, slides)| *slides) {
            // A rack translates along its slide by its displacement.
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
