//! Checks of a scene that do not depend on the models.

use super::assembly_lines::is_half_space;
use super::members::{SceneGear, SceneMesh};
use super::nodal::islands;
use crate::error::{BuildError, GearPart, MeshPart};
use crate::spec::{Body, ContactSpec, GearSpec, Load, Modelling, SceneSpec};

/// Refuses different laws on meshes that residual compliance couples, because these are solved together.
pub(super) fn refuse_two_laws(
    spec: &SceneSpec,
    gears: &[SceneGear],
    meshes: &[SceneMesh],
) -> Result<(), BuildError> {
    for island in islands(gears, meshes) {
        let soft = island.meshes.iter().find(|m| !meshes[**m].hard);
        let hard = island.meshes.iter().find(|m| meshes[**m].hard);
        if let (Some(&soft), Some(&hard)) = (soft, hard) {
            let name = |m: usize, k: usize| spec.gears[meshes[m].gears[k]].name.as_str();
            return Err(BuildError::mesh(
                [name(hard, 0), name(hard, 1)],
                MeshPart::Contact,
                (
                    format!(
                        "its contact is hard, but that of `{}` and `{}`, coupled by the compliance of a gear, has a penalty",
                        name(soft, 0),
                        name(soft, 1)
                    ),
                    "give both the same law",
                ),
            ));
        }
    }
    Ok(())
}

/// Refuses a law of a program on a mesh that has no tooth pairs: contact at points or along lines of flanks has a law per
/// area or width.
pub(super) fn refuse_user_law(
    names: [&str; 2],
    contact: &ContactSpec,
    has_pairs: bool,
) -> Result<(), BuildError> {
    match &contact.normal_force {
        Some(law) if !has_pairs => Err(BuildError::mesh(
            names,
            MeshPart::NormalForce,
            (
                format!(
                    "the law `{}` acts between tooth pairs, but these gears touch at points or along lines of their flanks",
                    law.name()
                ),
                "use it with `rigid` or `movable-teeth` gears, or remove `normal_force` from this contact",
            ),
        )
        .of_model()),
        _ => Ok(()),
    }
}

/// Refuses contacts on half-spaces that a model of the scene does not support, before any gear is meshed.
///
/// # Errors
/// A conical gear.
pub(super) fn check_contacts(spec: &SceneSpec, modelling: &Modelling) -> Result<(), BuildError> {
    let meshes = spec.meshes.iter().zip(&modelling.contacts);
    let half_spaces = meshes.filter(|(_, contact)| is_half_space(contact));
    let gears = half_spaces.flat_map(|(mesh, _)| mesh.gears);
    let conical = |gear: &&GearSpec| matches!(&gear.body, Body::Gear(g) if g.is_conical());
    match gears.map(|i| &spec.gears[i]).find(conical) {
        None => Ok(()),
        Some(gear) => Err(BuildError::gear(
            &gear.name,
            GearPart::Model,
            (
                "half-space contact needs cylindrical gears, but this one is conical",
                "use the contact of the elements, local = \"mesh\"",
            ),
        )
        .of_model()),
    }
}

/// Refuses loads that no run can apply.
pub(super) fn check_load(gear: &str, load: &Load) -> Result<(), BuildError> {
    let problem = match load {
        Load::Applied(p) => p.problem(),
        Load::Viscous(c) if !(c.is_finite() && *c >= 0.0) => {
            Some(format!("viscous coefficient {c} is not zero or positive"))
        }
        Load::Viscous(_) => None,
    };
    match problem {
        Some(p) => Err(BuildError::gear(gear, GearPart::Load, format!("load: {p}"))),
        None => Ok(()),
    }
}
