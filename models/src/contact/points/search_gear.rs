//! A gear as the input of a point search.

use crate::gear::GearModel;
use crate::kinematics::MeshView;
use crate::spec::Body;

/// A gear as the input of a point search: body, model, phase and view.
#[derive(Clone, Copy)]
pub struct SearchGear<'a> {
    /// Body with the toothing of the gear.
    pub body: &'a Body,
    /// The gear model, whose flanks are used if it has any.
    pub gear: &'a dyn GearModel,
    /// Angle [rad] (displacement [m] of a rack) of tooth 0 at the assembled position.
    pub phase: f64,
    /// View of the gear from the mesh.
    pub view: MeshView,
    /// Index of the mesh in the gear's own count.
    pub mesh: u8,
}
