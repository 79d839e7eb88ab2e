//! Reduction: what the elastic gear model needs of a finite-element mesh.
//!
//! Pass 1 ([`Basis`]) belongs to a mesh, a kind of mount and an added hub inertia, and is stored: flank nodes with
//! their normals, many modes at these nodes, the static compliance of the whole mesh between them. Pass 2 keeps some
//! of the modes and gives what the others would have carried to the residual compliance
//!
//! ```text
//! R = B (K^+ - Phi_e Omega^-2 Phi_e^T) B^T,   K^+ = P^T K_c^-1 P,   P = I - M Phi_r Phi_r^T
//! ```
//!
//! with the rigid motions `Phi_r` that the mount leaves free (inertia relief) and any support `c` that holds it.
//!
//! | part | owns |
//! |---|---|
//! | `surface` | flank nodes in order, their normals, areas and place in the mesh |
//! | `near_field` | what the elements about a flank do to a line load |
//! | `rigid` | rigid motions of a hub that is free in several directions, momentum of modes in them |
//! | `integrals` | inertia integrals of the floating frame |
//! | `basis` | modes of a mesh, or of a sector by cyclic symmetry, at these nodes |
//! | `compliance` | static compliance of the whole mesh; what kept modes carry is taken out of it by `without_modes` |
//! | [`choose`] | which modes are kept, and with what damping |
//! | `recovery` | the nodes behind a reduction, for pictures |
//! | `estimate` | what a choice costs in accuracy, before any scene is run |
//! | [`of_gear()`], [`Request`] | what a gear of a scene needs, and all that its basis depends on |
//! | `shared` | one basis for all that need the same |
//! | [`store`] | a basis in a file that numpy opens |
//! | [`cache`] | files of bases from run to run |
//! | `open`, [`Toothing`] | stored bases in a scene, held against its gears |
//!
//! Numbering and signs are those of [`gearbench_models::gear::elastic::reduced`].

mod basis;
pub mod cache;
pub mod choose;
mod compliance;

mod error;
mod estimate;
mod geometry;
mod integrals;
mod mounting;
mod near_field;
mod of_gear;
mod open;
#[cfg(test)]
mod out_of_plane_tests;
mod parameters;
#[cfg(test)]
mod reaction_tests;
mod recovery;
mod request;
mod rigid;
mod shared;
#[cfg(test)]
mod spin_tests;
pub mod store;
mod surface;
pub(crate) mod table;
#[cfg(test)]
mod tied_tests;
mod truncation;

pub use error::ReductionError;
pub use geometry::Toothing;
pub use mounting::{DIRECTIONS, Mounting, mount_text};
pub(crate) use near_field::of_flanks as near_field_of_flanks;
pub(crate) use of_gear::added_of;
pub use of_gear::{GearReductionInput, mounting_of, of_gear};
pub use parameters::ElasticParameters;
pub use request::Request;
pub(crate) use surface::Surface;
pub(crate) use truncation::{KeptModes, without_modes};

use gearbench_models::Vec3;
use gearbench_models::gear::elastic::inertia::Integrals;
use gearbench_models::gear::elastic::reduced::{OutOfPlaneShapes, Residual};
use gearbench_models::geometry::Flanks;
use std::sync::Arc;

/// Pass 1: modes and static compliance of a gear at its flank nodes and its hub.
#[derive(Clone, Debug)]
pub struct Basis {
    /// Flanks in the gear's own frame, nodes numbered through.
    pub flanks: Flanks,
    /// Outward unit normal at each flank node, own frame.
    pub normals: Vec<Vec3>,
    /// True if shapes and compliances have a second row after the outward one of each node: along the profile.
    pub along_profile: bool,
    /// The hub is free in the mount's direction.
    pub free: bool,
    /// Inertia [kg m^2] (rack: mass [kg]) including that added at the hub.
    pub inertia: f64,
    /// Inertia added at the hub.
    pub added_inertia: f64,
    /// Unknowns of the finite elements.
    pub unknowns: usize,
    /// Angular frequencies of all computed modes, ascending, without rigid motion [rad/s].
    pub omega: Vec<f64>,
    /// Modes that must be kept or truncated together have the same number: those of equal frequency.
    pub family: Vec<u32>,
    /// Shapes at the flank nodes along their directions, `direction * modes + mode` [1/sqrt(kg)]; see
    /// [`Basis::shapes_at`].
    pub shapes: Vec<f64>,
    /// Rotation (displacement) of a free hub in each mode; zeros for a fixed hub.
    pub hub: Vec<f64>,
    /// Inertia coupling with the prescribed motion of a fixed hub; zeros for a free hub.
    pub participation: Vec<f64>,
    /// Momentum of each mode by unit velocity of its coordinate, along the own x and y [sqrt(kg)].
    pub momentum: Vec<[f64; 2]>,
    /// Mass of the mesh times the place of its centre of mass, own x and y [kg m].
    pub unbalance: [f64; 2],
    /// Compliance of the whole mesh, before truncation.
    pub compliance: Residual,
    /// Displacement of rows of nodes under line loads, as in
    /// [`Reduced`](gearbench_models::gear::elastic::reduced::Reduced); `None` where it cannot be computed: helical
    /// teeth of elements other than hexahedra of eight nodes.
    pub near_field: Option<Arc<Vec<Vec<f64>>>>,
    /// Inertia integrals of all modes over the mesh, without the inertia added at the hub; `None` where they are too
    /// many.
    pub integrals: Option<Arc<Integrals>>,
    /// Mass [kg], and inertia about the axes other than the own one [kg m^2], added at a hub with out-of-plane
    /// freedom.
    pub added: [f64; 2],
    /// Data of a hub with out-of-plane freedom.
    pub lateral: Option<Arc<OutOfPlaneShapes>>,
}

/// Selection of the modes to compute, without rigid motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModeSelection {
    /// Number of the lowest modes (one more if the last is half of a pair).
    Count(usize),
    /// All up to this frequency [Hz].
    UpTo(f64),
}
