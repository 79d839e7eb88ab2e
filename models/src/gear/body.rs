//! Bodies of finite elements, for pictures: cells, and where all nodes are at a state.

use crate::Vec3;
use crate::error::Reason;
use crate::geometry::swept::Cells;
use gearbench_integrators::system::At;
use std::fmt;
use std::sync::Arc;

/// Nodes of a body at a state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Displaced {
    /// Where the rigid motion of the gear takes them [m].
    pub rigid: Vec<Vec3>,
    /// How far they are off that place [m].
    pub displacement: Vec<Vec3>,
}

/// What acts on a body: forces by the numbers of
/// [`FlankDisplacement`](super::FlankDisplacement), and the load on its hub.
#[derive(Clone, Debug, Default)]
pub struct BodyLoad {
    /// Numbers of flank nodes, or of lines, and forces into the tooth (along the profile: against it) [N].
    pub forces: Vec<(u32, f64)>,
    /// On the hub [N m] or [N].
    pub hub: f64,
}

/// A gear whose body is a mesh.
pub trait MeshedBody {
    /// Its elements.
    ///
    /// # Errors
    /// Why they are not known, with a way out.
    fn cells(&self) -> Result<Arc<Cells>, Reason>;

    /// All its nodes at a state.
    ///
    /// # Errors
    /// Why they are not known, with a way out.
    fn displaced(&self, at: At<'_>, load: &BodyLoad) -> Result<Displaced, Reason>;
}

/// The nodes behind a reduction: what its coordinates and forces on its flanks do to all of them.
pub trait Recovery: fmt::Debug + Send + Sync {
    /// The elements.
    ///
    /// # Errors
    /// Why they are not known, with a way out.
    fn cells(&self) -> Result<Arc<Cells>, Reason>;

    /// Nodes at rest, and their displacements by the coordinates of the modes and a load, both in the gear's own frame
    /// [m].
    ///
    /// # Errors
    /// Why they are not known, with a way out.
    fn displacements(&self, modes: &[f64], load: &BodyLoad) -> Result<[Vec<Vec3>; 2], Reason>;
}
