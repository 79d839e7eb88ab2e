//! The line of `fe` in the table of gear models: its parameters and where its mesh comes from.

use super::body::Body;
use super::gear::FullOrder;
use crate::assembly::tie::MassKind;
use crate::mesh::{ElementKind, GearMesh, GearMeshParams, RackMeshParams};
use crate::{deck, mesh};
use gearbench_models::gear::GearModel;
use gearbench_models::gear::table::{GearContext, Model, ParameterInfo};
use gearbench_models::scene::spec::{Body as Toothing, BuildError, Value};
use std::path::Path;

const MODEL: &str = "fe";

/// Parameters of the model.
pub static PARAMETERS: &[ParameterInfo] = &[
    ParameterInfo {
        key: "mesh",
        meaning: "\"generated\" (default), a stored reference such as \"calculix/case-a-fine\", or a path of a deck (.inp, .inp.gz)",
        required: false,
    },
    ParameterInfo {
        key: "element",
        meaning: "\"C3D8\" or \"C3D8I\" (default for generated meshes); a deck brings its own",
        required: false,
    },
    ParameterInfo {
        key: "mass",
        meaning: "\"consistent\" (default) or \"lumped\", which explicit methods want",
        required: false,
    },
    ParameterInfo {
        key: "flank_elements",
        meaning: "elements along a flank of a generated mesh",
        required: false,
    },
    ParameterInfo {
        key: "fillet_elements",
        meaning: "elements along a fillet of a generated mesh",
        required: false,
    },
    ParameterInfo {
        key: "across_elements",
        meaning: "elements across a tooth of a generated mesh",
        required: false,
    },
    ParameterInfo {
        key: "rim_elements",
        meaning: "elements from root to bore of a generated mesh",
        required: false,
    },
    ParameterInfo {
        key: "width_elements",
        meaning: "elements over the face width of a generated mesh",
        required: false,
    },
];

/// The models of this crate.
pub static MODELS: &[Model] = &[Model {
    id: "fe",
    title: "full finite elements: every node moves, contact over the flank faces",
    parameters: PARAMETERS,
    build,
}];

fn error(key: &str, message: impl Into<String>) -> BuildError {
    BuildError::parameter(MODEL, key, message)
}

fn text<'a>(context: &'a GearContext<'_>, key: &str) -> Result<Option<&'a str>, BuildError> {
    match context.parameters.get(key) {
        None => Ok(None),
        Some(Value::Text(x)) => Ok(Some(x)),
        Some(_) => Err(error(key, "expected a word in quotation marks")),
    }
}

fn count(context: &GearContext<'_>, key: &str) -> Result<Option<usize>, BuildError> {
    match context.parameters.get(key) {
        None => Ok(None),
        Some(Value::Number(x)) if *x >= 1.0 && *x <= 500.0 && x.fract() == 0.0 => {
            Ok(Some(*x as usize))
        }
        Some(_) => Err(error(key, "expected a whole number from 1 to 500")),
    }
}

/// The mesh of a gear in its own frame.
fn mesh_of(context: &GearContext<'_>) -> Result<GearMesh, BuildError> {
    let element = match text(context, "element")? {
        None => None,
        Some(name) => Some(ElementKind::from_name(name).ok_or_else(|| {
            let known: Vec<&str> = ElementKind::ALL.iter().map(|k| k.name()).collect();
            error(
                "element",
                format!(
                    "there is no element \"{name}\"; there are {}",
                    known.join(", ")
                ),
            )
        })?),
    };
    match text(context, "mesh")?.unwrap_or("generated") {
        "generated" => generated(context, element),
        source => stored(context, source, element),
    }
}

/// A generated mesh.
fn generated(
    context: &GearContext<'_>,
    element: Option<ElementKind>,
) -> Result<GearMesh, BuildError> {
    let mut params = GearMeshParams::default();
    if let Some(kind) = element {
        params.kind = kind;
    }
    let tooth = &mut params.tooth;
    for (key, value) in [
        ("flank_elements", &mut tooth.flank),
        ("fillet_elements", &mut tooth.fillet),
        ("across_elements", &mut tooth.across),
        ("rim_elements", &mut params.rim),
        ("width_elements", &mut params.width),
    ] {
        if let Some(n) = count(context, key)? {
            *value = n;
        }
    }
    let mesh = match context.body {
        Toothing::Gear(g) => mesh::gear(g, &params),
        Toothing::Rack(r) => mesh::rack(
            r,
            &RackMeshParams {
                kind: params.kind,
                tooth: params.tooth,
                body: params.rim,
                width: params.width,
                ..RackMeshParams::default()
            },
        ),
    };
    mesh.map_err(|e| error("mesh", e.to_string()))
}

/// The mesh of a gear in a deck: the toothed body with as many teeth whose centre is nearest.
fn stored(
    context: &GearContext<'_>,
    source: &str,
    element: Option<ElementKind>,
) -> Result<GearMesh, BuildError> {
    for key in [
        "flank_elements",
        "fillet_elements",
        "across_elements",
        "rim_elements",
        "width_elements",
    ] {
        if context.parameters.contains_key(key) {
            return Err(error(
                key,
                format!("is for generated meshes, but the mesh is \"{source}\"; leave it out"),
            ));
        }
    }
    let stored = crate::REFERENCES.iter().find(|r| r.id == source);
    let deck = match stored {
        Some(reference) => deck::read_bytes(source, reference.deck),
        None if Path::new(source).is_file() => deck::read(source),
        None => {
            let known: Vec<&str> = crate::REFERENCES.iter().map(|r| r.id).collect();
            return Err(error(
                "mesh",
                format!(
                    "\"{source}\" is neither a file nor a stored reference; there are \"generated\", {}",
                    known.join(", ")
                ),
            ));
        }
    };
    let gears = deck
        .and_then(|d| deck::gears(&d))
        .map_err(|e| error("mesh", e.to_string()))?;
    let (teeth, rack) = match context.body {
        Toothing::Gear(g) => (g.teeth(), false),
        Toothing::Rack(r) => (r.teeth(), true),
    };
    let found: Vec<String> = gears
        .iter()
        .map(|g| format!("{} with {} teeth", g.name, g.mesh.teeth))
        .collect();
    let distance = |g: &deck::DeckGear| (g.centre - context.hub.centre).xy().norm();
    let mut gear = gears
        .into_iter()
        .filter(|g| rack == matches!(g.shape, deck::BodyShape::Rack { .. }))
        .filter(|g| rack || g.mesh.teeth == teeth)
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .ok_or_else(|| {
            error(
                "mesh",
                format!(
                    "gear `{}` has {teeth} teeth, but \"{source}\" has {}",
                    context.name,
                    found.join(", ")
                ),
            )
        })?
        .mesh;
    if let Some(kind) = element {
        if kind.nodes() != gear.mesh.kind.nodes() {
            return Err(error(
                "element",
                format!(
                    "the elements of \"{source}\" are {} with {} nodes; {} has {}",
                    gear.mesh.kind.name(),
                    gear.mesh.kind.nodes(),
                    kind.name(),
                    kind.nodes()
                ),
            ));
        }
        gear.mesh.kind = kind;
    }
    Ok(gear)
}

fn build(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let mass = match text(context, "mass")? {
        None | Some("consistent") => MassKind::Consistent,
        Some("lumped") => MassKind::Lumped,
        Some(other) => {
            return Err(error(
                "mass",
                format!("\"{other}\" is not known; expected \"consistent\" or \"lumped\""),
            ));
        }
    };
    let mesh = mesh_of(context)?;
    if mesh.mesh.kind.nodes() != 8 {
        return Err(error(
            "element",
            format!(
                "flanks touch on faces with four nodes, those of {} have eight; take C3D8 or C3D8I",
                mesh.mesh.kind.name()
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
    .map_err(|e| error("mesh", e.to_string()))?;
    Ok(Box::new(FullOrder::new(
        context.hub.clone(),
        context.lever,
        body,
    )))
}
