//! Finite-element bodies for figures: cells, and the positions of all nodes at a state.

use crate::Vec3;
use crate::error::Reason;
use crate::geometry::swept::Cells;
use gearbench_integrators::system::StateView;
use std::fmt;
use std::sync::Arc;

/// Positions of all nodes of a body at a state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DisplacedNodes {
    /// Positions after the rigid motion of the gear [m].
    pub rigid: Vec<Vec3>,
    /// Displacements of the nodes from these positions [m].
    pub displacement: Vec<Vec3>,
}

/// Loads on a body: forces on flank nodes, numbered as in [`FlankDisplacement`](super::FlankDisplacement), and the
/// load on its hub.
#[derive(Clone, Debug, Default)]
pub struct BodyLoad {
    /// Numbers of flank nodes, or of lines, with forces into the tooth [N]; along the profile, forces against it.
    pub forces: Vec<(u32, f64)>,
    /// Load on the hub [N m or N].
    pub hub: f64,
}

/// A gear whose body is a finite-element mesh.
pub trait MeshedBody {
    /// Returns the cells of the mesh.
    ///
    /// # Errors
    /// Why they are not known, with a way out.
    fn cells(&self) -> Result<Arc<Cells>, Reason>;

    /// Returns the positions of all nodes at a state.
    ///
    /// # Errors
    /// Why they are not known, with a way out.
    fn displaced(&self, at: StateView<'_>, load: &BodyLoad) -> Result<DisplacedNodes, Reason>;
}

/// The full mesh behind a reduction: displacements of all nodes from modal coordinates and flank forces.
pub trait Recovery: fmt::Debug + Send + Sync {
    /// Returns the cells of the mesh.
    ///
    /// # Errors
    /// Why they are not known, with a way out.
    fn cells(&self) -> Result<Arc<Cells>, Reason>;

    /// Returns the undeformed nodes, and their displacements from modal coordinates and a load, both in the gear frame
    /// [m].
    ///
    /// # Errors
    /// Why they are not known, with a way out.
    fn displacements(&self, modes: &[f64], load: &BodyLoad) -> Result<[Vec<Vec3>; 2], Reason>;
}
