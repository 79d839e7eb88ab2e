//! The line of `fe` in the table of gear models.

use super::body::{AddedInertia, Body};
use super::gear::FullOrder;
use super::lines::Lines;
use crate::assembly::tie::MassKind;
use crate::mesh_source::{MeshParameters, Reader, Source};
use crate::reduction::added_of;
use gearbench_models::declare_parameters;
use gearbench_models::error::BuildError;
use gearbench_models::gear::GearModel;
use gearbench_models::gear::parameters::ModelParameters;
use gearbench_models::gear::properties::Properties;
use gearbench_models::gear::table::{GearContext, Model};
use gearbench_models::spec::{Body as Toothing, UPRIGHT};

declare_parameters! {
    /// Parameters of the model.
    pub struct FullOrderParameters model "fe" {
        /// "consistent" (default) or "lumped", which explicit methods want
        mass: MassKind,
        /// [alpha, beta] of the damping alpha M + beta K, in 1/s and s; beta damps the static compliance of cut modes and the contact as well; alpha damps the modes of `elastic`
        rayleigh: [f64; 2],
        flatten mesh: MeshParameters,
    }
}

const MODEL: &str = FullOrderParameters::MODEL;

/// Row of the model in the table.
pub const ROW: Model = Model::of::<FullOrderParameters>(
    "full finite elements: every node moves, contact over the flank faces",
    Properties {
        full_order: true,
        ..Properties::NONE
    },
    build,
);

fn build(context: &GearContext<'_>) -> Result<Box<dyn GearModel>, BuildError> {
    let reader = Reader {
        model: MODEL,
        context,
    };
    let given = context.parameters::<FullOrderParameters>()?;
    let mass = given.mass.unwrap_or(MassKind::Consistent);
    let [alpha, retardation] = reader.rayleigh(given.rayleigh)?;
    if alpha != 0.0 {
        return Err(reader.error(
            "rayleigh",
            (
                "damping proportional to the mass is that of modes, which this model does not have",
                "give [0, beta], or use the model `elastic`",
            ),
        ));
    }
    let mut mesh = Source::read(&reader, &given.mesh)?.whole(&reader)?;
    if let Toothing::Gear(gear) = context.body {
        mesh.deviate(gear);
    }
    // On half-spaces it is lines that touch, whatever the faces are.
    let of_nodes = context.lines.is_none();
    if of_nodes && !mesh.tied.is_empty() {
        return Err(reader.error(
            "mesh",
            (
                "the faces of its flanks are not grids of quadrilaterals, which this model needs for contact",
                "give the contact local = \"half-space\", or use the model `elastic`, which accepts all faces",
            ),
        ));
    }
    if of_nodes && mesh.mesh.kind().is_none_or(|k| k.nodes() != 8) {
        return Err(reader.error(
            "element",
            (
                format!(
                    "flanks touch on faces with four nodes, on elements with eight; the elements are {}",
                    mesh.mesh.kind_names()
                ),
                "use C3D8 or C3D8I, or give the contact local = \"half-space\"",
            ),
        ));
    }
    // A hub that moves in several directions, or turns about a tilted axis.
    let floats = context.hub.lateral.is_some()
        || (context.hub.slide.is_none() && context.hub.axes != UPRIGHT);
    let lines = match context.lines {
        None => Lines::default(),
        Some(strips) => Lines::new(
            &mesh,
            &context.material,
            &context.placement.pose(0.0),
            strips,
        )
        .map_err(|e| reader.error("mesh", e))?,
    };
    let (hub, material, placement) = (context.hub, &context.material, &context.placement);
    let own = context.added_inertia;
    let body = if floats {
        let [added, tilting] = added_of(context)?;
        let added = AddedInertia {
            own,
            mass: match context.body {
                Toothing::Gear(_) => added,
                Toothing::Rack(_) => own,
            },
            tilting,
        };
        Body::floating(mesh, material, placement, hub, mass, added)
    } else {
        Body::new(mesh, material, placement, &hub.mount, mass, own)
    };
    let body = body.map_err(|e| reader.error("mesh", e.to_string()).of_model())?;
    let gear = FullOrder::new(context.hub.clone(), context.effective_radius, body);
    Ok(Box::new(
        gear.with_retardation(retardation).with_lines(lines),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support;
    use gearbench_models::Vec3;
    use gearbench_models::gear::elastic::lines::Strips;
    use gearbench_models::kinematics::{BodyMass, OutOfPlane};
    use gearbench_models::spec::{Bearing, Freedom, Mount};
    use gearbench_models::stiffness::Material;
    use nalgebra::Matrix3;
    use std::sync::Arc;

    /// Coordinates of a gear, of them those of its hub, that is free sideways with a mass added, on axes of its own.
    fn built(more: f64, lines: Option<Strips>) -> Result<(usize, usize), BuildError> {
        let gear = test_support::stub(9, 0.0);
        let mass = gear.mass_properties(Material::STEEL.density).mass;
        let body = Toothing::Gear(gear);
        let mut hub = test_support::hub(Mount::Revolute, None);
        hub.axes = [Vec3::y(), Vec3::z(), Vec3::x()];
        let mut directions = [const { Freedom::Fixed }; 6];
        directions[..2].fill(Freedom::Free);
        hub.lateral = Some(Arc::new(OutOfPlane {
            directions,
            bearing: Bearing::default(),
            body: BodyMass {
                mass: mass + more,
                inertia: Matrix3::identity(),
                centre: Vec3::zeros(),
            },
            spins: false,
        }));
        let counts = ["flank", "fillet", "across", "rim", "width"];
        let model = ROW.spec(counts.map(|key| (format!("{key}_elements"), 3)))?;
        let context = GearContext {
            lines,
            ..test_support::context(&body, &hub, &model)
        };
        let gear = (ROW.build)(&context)?;
        Ok((gear.hub().len(), gear.hub().coordinates()))
    }

    #[test]
    fn a_hub_that_moves_sideways_has_its_directions() {
        let (all, hub) = built(0.1, None).unwrap();
        assert_eq!(hub, 3);
        assert_eq!(all % 3, 0);
        let e = built(-0.1, None).unwrap_err().to_string();
        assert!(e.contains("leave `mass_kg` out"), "{e}");
        // Flanks that touch on half-spaces have the same coordinates.
        assert_eq!(built(0.1, Some(Strips::Layers)).unwrap(), (all, hub));
    }
}
