//! The line of `fe` in the table of gear models.

use super::body::Body;
use super::gear::FullOrder;
use crate::assembly::tie::MassKind;
use crate::mesh_source::{self, Reader, Source};
use gearbench_models::error::BuildError;
use gearbench_models::gear::GearModel;
use gearbench_models::gear::table::{GearContext, Model, ParameterInfo};

const MODEL: &str = "fe";

/// Parameters of the model.
static PARAMETERS: [ParameterInfo; 8] = mesh_source::with_own(&[ParameterInfo {
    key: "mass",
    meaning: "\"consistent\" (default) or \"lumped\", which explicit methods want",
    required: false,
}]);

/// Its row.
pub const ROW: Model = Model {
    id: MODEL,
    title: "full finite elements: every node moves, contact over the flank faces",
    parameters: &PARAMETERS,
    build,
};

fn build(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let reader = Reader {
        model: MODEL,
        context,
    };
    let mass = match reader.text("mass")? {
        None | Some("consistent") => MassKind::Consistent,
        Some("lumped") => MassKind::Lumped,
        Some(other) => {
            return Err(reader.error(
                "mass",
                (
                    format!("\"{other}\" is not known"),
                    "expected \"consistent\" or \"lumped\"",
                ),
            ));
        }
    };
    let mesh = Source::read(&reader)?.whole(&reader)?;
    if mesh.mesh.kind.nodes() != 8 {
        return Err(reader.error(
            "element",
            (
                format!(
                    "flanks touch on faces with four nodes, those of {} have eight",
                    mesh.mesh.kind.name()
                ),
                "take C3D8 or C3D8I",
            ),
        ));
    }
    let body = Body::new(
        mesh,
        &context.material,
        &context.placement,
        &context.hub.mount,
        mass,
        context.added_inertia,
    )
    .map_err(|e| reader.error("mesh", e.to_string()))?;
    Ok(Box::new(FullOrder::new(
        context.hub.clone(),
        context.lever,
        body,
    )))
}
