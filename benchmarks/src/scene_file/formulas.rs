//! Validity ranges of the stiffness formulas, and warnings where a scene leaves them.

use super::{ModelChoice, SceneError, SceneFile};
use gearbench_models::spec::{Body, ContactSpec, FlankContact, SceneSpec, mesh_layout};
use gearbench_models::stiffness::build_with_warnings;

/// Warnings on the limits of the stiffness formulas that the gears of a mesh exceed.
pub(crate) fn formula_limits(
    spec: &SceneSpec,
    gears: [usize; 2],
    contact: &ContactSpec,
) -> Vec<String> {
    let [a, b] = gears.map(|i| &spec.gears[i]);
    let (Body::Gear(ga), Ok(l)) = (&a.body, mesh_layout(a, b)) else {
        return Vec::new();
    };
    let materials = [a.material, b.material];
    let stiffness = &contact.stiffness;
    let built = build_with_warnings(stiffness, ga, &b.body, &l.pair, materials, l.face_width);
    built.map_or_else(
        |_| Vec::new(),
        |b| b.warnings.iter().map(ToString::to_string).collect(),
    )
}

impl SceneFile {
    /// Warnings on the limits of the stiffness formulas for all meshes of a model, each at the line of its contact.
    /// Flank points have no formula.
    pub(super) fn outside_formulas(&self, choice: &ModelChoice) -> Vec<SceneError> {
        let spec = self.spec_for(choice);
        let index = self.models.iter().position(|m| m.label == choice.label);
        let contact = self
            .document
            .at("models")
            .member(index.unwrap_or_default())
            .key("contact");
        let mut all: Vec<SceneError> = Vec::new();
        for (i, (mesh, own)) in spec
            .meshes
            .iter()
            .zip(&choice.modelling.contacts)
            .enumerate()
        {
            if own.flanks != FlankContact::Toothing {
                continue;
            }
            let place = contact.member(i);
            let place = if place.exists() {
                place
            } else {
                contact.clone()
            };
            for limit in formula_limits(&spec, mesh.gears, own) {
                let message = format!("model `{}`: {limit}", choice.label);
                all.push(
                    place
                        .first(&["stiffness"])
                        .error(message, "outside its range", ""),
                );
            }
        }
        all
    }
}
