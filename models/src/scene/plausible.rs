//! What of a scene cannot be, whatever the models.

use super::members::{SceneGear, SceneMesh};
use super::nodal::islands;
use crate::error::{BuildError, GearPart, MeshPart};
use crate::spec::{Load, SceneSpec};

/// Meshes that residual compliance couples are solved together, by one kind of law.
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

/// Refuses loads that no run could take.
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
