//! What a point search needs to know of a gear.

use crate::gear::GearModel;
use crate::kinematics::MeshView;
use crate::spec::Body;

/// What a point search needs to know of a gear.
#[derive(Clone, Copy)]
pub struct Owner<'a> {
    /// Toothing.
    pub body: &'a Body,
    /// The model; its flanks are taken where it has some.
    pub gear: &'a dyn GearModel,
    /// Angle [rad] (displacement [m] of a rack) of tooth 0 at the assembled position.
    pub phase: f64,
    /// How the mesh sees it.
    pub view: MeshView,
    /// The mesh's index in the gear's own count.
    pub mesh: u8,
}
