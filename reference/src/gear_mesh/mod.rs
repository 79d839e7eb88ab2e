//! Meshes of toothed bodies: structured meshes of gears and racks, and the data that a gear has beyond its mesh.
//!
//! A [`GearMesh`] stands in its own frame: axis z through the origin, tooth 0 centred on +x, tooth `k` follows
//! counter-clockwise. A rack as in [`gearbench_models::geometry`]: reference line on y, teeth pointing to -x,
//! tooth 0 centred on y = 0, tooth `k` follows towards +y, `Left` is the side that meets left flanks of gears.
//! Sets are named from 1, as the decks have them: `flank_1l` is the left flank of tooth 0. [`crate::mesh`] has the
//! conventions of nodes, elements and faces.

mod assembly;
#[cfg(test)]
mod body_tests;
mod build;
mod checks;
mod conical;
#[cfg(test)]
mod conical_tests;
#[cfg(test)]
mod cyclic_tests;
mod error;
mod grading;
mod membership;
mod params;
mod profile;
#[cfg(test)]
mod ring_tests;
mod section;
#[cfg(test)]
mod tests;
mod width;

pub use build::{gear, rack, sector};
pub use error::{MeshError, Part};
pub use membership::membership;
pub use params::{FineTeeth, Focus, GearMeshParams, Tooth, Web};

use crate::mesh::Mesh;
use crate::modes::cyclic::SectorMesh;
use gearbench_models::geometry::{FlankGrid, Side};

/// Name of the node set of a flank; with an `s` in front, of its set of faces.
pub(crate) fn flank_set(tooth: u32, side: Side) -> String {
    format!("flank_{}{}", tooth + 1, letter(side))
}

/// Letter of a side in the names of sets.
pub(crate) fn letter(side: Side) -> char {
    match side {
        Side::Left => 'l',
        Side::Right => 'r',
    }
}

/// A toothed body as finite elements, in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub struct GearMesh {
    /// Nodes and elements of the gear.
    pub mesh: Mesh,
    /// Number of teeth of the whole gear (of a rack: all its teeth).
    pub teeth: u32,
    /// Nodes that are rigidly tied to the hub: the bore, or the back of a rack.
    pub bore: Vec<u32>,
    /// Flanks as structured grids; a foreign mesh may have fewer than two per tooth. Numbers from that of the nodes on
    /// are those of tied points.
    pub flanks: Vec<FlankGrid>,
    /// Points of flanks that are no nodes, where the mesh of the flanks is no grid.
    pub tied: Vec<TiedPoint>,
}

/// A flank point tied to the nodes of its face: nodes with their weights, which add up to 1. Its displacement is the
/// weighted sum of theirs, and a force on it is distributed to them by the same weights.
#[derive(Clone, Debug, PartialEq)]
pub struct TiedPoint(pub Vec<(u32, f64)>);

impl GearMesh {
    /// Returns the mesh as a sector of its gear, if it was meshed as one.
    pub fn as_sector(&self) -> SectorMesh<'_> {
        SectorMesh {
            mesh: &self.mesh,
            sectors: self.teeth,
            bore: &self.bore,
        }
    }

    /// Returns the nodes to which a flank point is tied, with their weights; a node is tied to itself.
    pub fn follows(&self, point: u32) -> Vec<(u32, f64)> {
        match (point as usize).checked_sub(self.mesh.nodes.len()) {
            None => vec![(point, 1.0)],
            Some(tied) => self.tied.get(tied).map_or(Vec::new(), |t| t.0.clone()),
        }
    }

    /// Moves the nodes of the flanks by the deviations of their teeth; those within follow the forces only.
    pub fn deviate(&mut self, gear: &gearbench_models::geometry::Gear) {
        for grid in &mut self.flanks {
            grid.deviate(gear);
            for (node, x) in grid.nodes.iter().zip(&grid.positions) {
                // Tied points move by themselves: the nodes within follow the forces only.
                if let Some(node) = self.mesh.nodes.get_mut(*node as usize) {
                    *node = *x;
                }
            }
        }
    }
}
