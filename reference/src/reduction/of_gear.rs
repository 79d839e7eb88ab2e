//! Which reduction a gear of a scene needs: its mesh and its mount.

use super::{ModeSelection, Mounting, Request};
use crate::gear_mesh::GearMesh;
use crate::mesh_source::{MeshParameters, Reader, Source};
use crate::recognise::RecognisedBody;
use gearbench_models::Vec3;
use gearbench_models::error::{BuildError, GearPart};
use gearbench_models::gear::table::GearContext;
use gearbench_models::spec::{Body, Freedom};
use gearbench_models::stiffness::Material;

/// The mesh of a gear, how its hub is mounted.
#[derive(Clone, Debug)]
pub struct GearReductionInput {
    /// Mesh of the gear.
    pub mesh: GearMesh,
    /// True if the mesh is one sector of a gear with equal teeth.
    pub sector: bool,
    /// Mount of the gear.
    pub mounting: Mounting,
    /// Friction loads its flanks.
    pub slides: bool,
    /// Result of the recognition of a mesh from a file.
    pub found: Option<RecognisedBody>,
    /// How the mesh was read, a line each.
    pub notes: Vec<String>,
}

impl GearReductionInput {
    /// Returns the request from which the basis is computed.
    pub fn request(&self, material: Material, wanted: ModeSelection) -> Request<'_> {
        Request {
            mesh: &self.mesh,
            sector: self.sector,
            material,
            mounting: self.mounting,
            wanted,
            along_profile: self.slides,
            foreign: None,
        }
    }
}

/// The mesh and mount of a gear, by the parameters of its model.
pub fn of_gear(
    model: &'static str,
    context: &GearContext<'_>,
    mesh: &MeshParameters,
) -> Result<GearReductionInput, BuildError> {
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
    Ok(GearReductionInput {
        mesh,
        sector,
        mounting: mounting_of(context)?,
        slides: context.slides,
        found,
        notes,
    })
}

/// How a gear is mounted, in its own frame.
pub fn mounting_of(context: &GearContext<'_>) -> Result<Mounting, BuildError> {
    let free = context.hub.is_free();
    let mounting = match context.body {
        Body::Gear(_) => Mounting::gear(free, context.added_inertia),
        Body::Rack(_) => Mounting::rack(free, context.added_inertia),
    };
    if context.hub.lateral.is_none() {
        return Ok(mounting);
    }
    let [mass, tilting] = added_of(context)?;
    let mounting = mounting.with_added(mass, tilting);
    mounting
        .lateral(free_in_own_frame(context))
        .map_err(|why| BuildError::gear(context.name, GearPart::Mount, why))
}

/// Returns the free out-of-plane directions of a hub, in the gear frame; driven ones are fixed.
pub(super) fn free_in_own_frame(context: &GearContext<'_>) -> [bool; 6] {
    let Some(lateral) = &context.hub.lateral else {
        return [false; 6];
    };
    // The first axis of a rack's hub is its slide, which is its own y.
    let of_hub = match context.body {
        Body::Gear(_) => [0, 1, 2, 3, 4, 5],
        Body::Rack(_) => [1, 0, 2, 4, 3, 5],
    };
    of_hub.map(|d| d != context.hub.moving() && lateral.directions[d] == Freedom::Free)
}

/// Returns the mass and inertia of the body of a hub beyond its mesh: mass [kg], and inertia about each axis across
/// its own [kg m^2]. The mesh has that of the toothing without the core of a solid gear.
pub(crate) fn added_of(context: &GearContext<'_>) -> Result<[f64; 2], BuildError> {
    let Some(lateral) = &context.hub.lateral else {
        return Ok([0.0; 2]);
    };
    let error = |why: (String, &str)| BuildError::gear(context.name, GearPart::Inertia, why);
    let (body, density) = (&lateral.body, context.material.density);
    if body.centre != Vec3::zeros() {
        return Err(error((
            "the centre of mass of finite elements is that of their mesh, with what is added at the hub itself".to_owned(),
            "leave `centre_of_mass_m` out",
        )));
    }
    let toothing = context.body.mass(density);
    let more = body.mass - toothing;
    if more < -1e-6 * toothing {
        let cause = format!(
            "a mass of {:.4e} kg is less than the {toothing:.4e} kg of the toothing, which finite elements have",
            body.mass
        );
        return Err(error((cause, "leave `mass_kg` out")));
    }
    let more = if more > 1e-12 * toothing { more } else { 0.0 };
    let width2 = context.body.face_width().powi(2);
    Ok(match context.body {
        Body::Gear(g) => {
            let core = g.core_mass(density);
            let of_core = 0.5 * g.core_inertia(density) + core * width2 / 12.0;
            // Of a body of three or more equal sectors, about any line across the axis.
            let own = g.mass_properties(density);
            let own = 0.5 * own.izz + own.mass * width2 / 12.0;
            let across = 0.5 * (body.inertia[(0, 0)] + body.inertia[(1, 1)]);
            let tilting = if across - own > 1e-12 * own {
                across - own
            } else {
                0.0
            };
            [more + core, tilting + of_core]
        }
        Body::Rack(_) => [more, more * width2 / 12.0],
    })
}
