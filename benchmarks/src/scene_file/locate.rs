//! The line of a scene file that an error of the assembly is about.

use super::model::ModelPlace;
use super::{SceneError, SceneFile};
use gearbench_models::error::{BuildError, GearPart, MeshPart, Subject};
use std::ops::Range;

impl SceneFile {
    /// The place in the file that an error met while building the model with a label is about.
    pub fn locate_in(&self, label: &str, error: &BuildError) -> SceneError {
        let choice = self.models.iter().position(|m| m.label == label);
        let model = choice.and_then(|i| self.model_places.get(i));
        let help = match error.reason.help.as_str() {
            "" => "correct the value, or leave it out to take the default",
            help => help,
        };
        self.source.error(
            self.span_of(model, &error.subject),
            format!(
                "{}: {} (model `{label}`)",
                error.subject, error.reason.cause
            ),
            "this",
            help,
        )
    }

    fn span_of(&self, model: Option<&ModelPlace>, subject: &Subject) -> Range<usize> {
        let of_model = |keys: &[&str]| model.map_or(0..0, |m| m.first(keys));
        match subject {
            Subject::Scene => of_model(&[]),
            Subject::Parameter { key, .. } => {
                of_model(&[&format!("parameters.{key}"), "parameters", "model"])
            }
            Subject::Gear { name, part } => {
                let index = self.spec.gears.iter().position(|g| g.name == *name);
                let keys: &[&str] = match part {
                    GearPart::Model => return of_model(&[&format!("gears.{name}"), "model"]),
                    GearPart::Whole => &[],
                    GearPart::Inertia => &[
                        "inertia_kgm2",
                        "mass_kg",
                        "added_inertia_kgm2",
                        "added_mass_kg",
                    ],
                    GearPart::Load => &["loads"],
                    GearPart::Mount => &["mount"],
                };
                index.map_or_else(|| of_model(&[]), |i| self.gears[i].first(keys))
            }
            Subject::Mesh { gears, part } => self.span_of_mesh(model, gears, *part),
        }
    }

    /// An error about a mesh is about a model's contact or about the mesh itself.
    fn span_of_mesh(
        &self,
        model: Option<&ModelPlace>,
        gears: &[String; 2],
        part: MeshPart,
    ) -> Range<usize> {
        let key = match part {
            MeshPart::Layout | MeshPart::Start => None,
            MeshPart::Stiffness => Some("contact.stiffness"),
            MeshPart::Exponent => Some("contact.exponent"),
            MeshPart::Damping => Some("contact.damping"),
            MeshPart::Friction => Some("contact.friction"),
            MeshPart::Slices => Some("contact.slices"),
            MeshPart::Contact => Some("contact"),
        };
        let name = |i: usize| &self.spec.gears[i].name;
        let draft = self.meshes.iter().find(|m| {
            let [a, b] = m.spec.gears;
            [name(a), name(b)] == [&gears[0], &gears[1]]
        });
        match (model, key, draft) {
            (Some(model), Some(key), _) => model.first(&[key, "contact"]),
            (_, _, Some(draft)) => match (&draft.start, part) {
                (Some(start), MeshPart::Start) => start.first(&["path_coordinate_m", "gap_m"]),
                _ => draft
                    .place
                    .first(&["centre_distance_m", "backlash_m", "gears"]),
            },
            (model, _, None) => model.map_or(0..0, |m| m.header.clone()),
        }
    }
}
