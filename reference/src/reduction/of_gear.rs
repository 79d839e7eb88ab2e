//! Which reduction a gear of a scene needs: its mesh and its mount.

use super::{Mounting, Request, Wanted};
use crate::mesh::GearMesh;
use crate::mesh_source::{MeshParameters, Reader, Source};
use crate::recognise::Found;
use gearbench_models::error::BuildError;
use gearbench_models::gear::table::GearContext;
use gearbench_models::spec::Body;
use gearbench_models::stiffness::Material;

/// The mesh of a gear, how its hub is mounted.
#[derive(Clone, Debug)]
pub struct OfGear {
    /// The mesh.
    pub mesh: GearMesh,
    /// The mesh is one sector of a gear whose teeth are all alike.
    pub sector: bool,
    /// The mount.
    pub mounting: Mounting,
    /// Friction loads its flanks.
    pub slides: bool,
    /// What was recognised of a mesh that was read.
    pub found: Option<Found>,
    /// How the mesh was read, a line each.
    pub notes: Vec<String>,
}

impl OfGear {
    /// What its basis is computed from.
    pub fn request(&self, material: Material, wanted: Wanted) -> Request<'_> {
        Request {
            mesh: &self.mesh,
            sector: self.sector,
            material,
            mounting: self.mounting,
            wanted,
            along_profile: self.slides,
        }
    }
}

/// The mesh and mount of a gear, by the parameters of its model.
pub fn of_gear(
    model: &'static str,
    context: &GearContext<'_>,
    mesh: &MeshParameters,
) -> Result<OfGear, BuildError> {
    let reader = Reader { model, context };
    let source = Source::read(&reader, mesh)?;
    let (found, notes) = match &source {
        Source::Deck(stored) => (stored.found.clone(), stored.notes.clone()),
        Source::Generated(_) => (None, Vec::new()),
    };
    let (mesh, sector) = match source.sector(&reader)? {
        Some(sector) => (sector, true),
        None => (source.whole(&reader)?, false),
    };
    let free = context.hub.is_free();
    Ok(OfGear {
        mesh,
        sector,
        mounting: match context.body {
            Body::Gear(_) => Mounting::gear(free, context.added_inertia),
            Body::Rack(_) => Mounting::rack(free, context.added_inertia),
        },
        slides: context.slides,
        found,
        notes,
    })
}
