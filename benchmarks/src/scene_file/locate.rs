//! The line of a scene file that an error of the assembly is about.

use super::reading::Place;
use super::{SceneError, SceneFile};
use gearbench_models::error::{BuildError, GearPart, MeshPart, Subject};

impl SceneFile {
    /// The place in the file that an error met while building the model with a label is about.
    pub fn locate_in(&self, label: &str, error: &BuildError) -> SceneError {
        let choice = self.models.iter().position(|m| m.label == label);
        let models = self.document.at("models");
        let model = choice.map_or_else(|| models.root(), |i| models.member(i));
        let help = match error.reason.help.as_str() {
            "" => "correct the value, or leave it out to take the default",
            help => help,
        };
        let message = format!(
            "{}: {} (model `{label}`)",
            error.subject, error.reason.cause
        );
        let place = self.place_of(&model, &error.subject);
        place.error(message, "this", help)
    }

    fn place_of<'d>(&'d self, model: &Place<'d>, subject: &Subject) -> Place<'d> {
        match subject {
            Subject::Scene => model.clone(),
            Subject::Parameter { key, .. } => {
                let own = model.key("parameters").key(key);
                let gears = self
                    .spec
                    .gears
                    .iter()
                    .map(|g| model.key("gears").key(&g.name));
                let mut of_gears = gears.map(|gear| gear.key("parameters").key(key));
                match own.exists() {
                    true => own,
                    false => (of_gears.find(Place::exists))
                        .unwrap_or_else(|| model.first(&["parameters", "model"])),
                }
            }
            Subject::Gear { name, part } => {
                let gear = self.document.at("gears").key(name);
                match part {
                    GearPart::Model => match model.key("gears").key(name) {
                        own if own.exists() => own,
                        _ => model.first(&["model"]),
                    },
                    _ if !gear.exists() => model.clone(),
                    GearPart::Whole => gear,
                    GearPart::Inertia => gear.first(&[
                        "inertia_kgm2",
                        "mass_kg",
                        "added_inertia_kgm2",
                        "added_mass_kg",
                    ]),
                    GearPart::Load => gear.first(&["loads"]),
                    GearPart::Mount => gear.first(&["mount"]),
                }
            }
            Subject::Mesh { gears, part } => self.place_of_mesh(model, gears, *part),
        }
    }

    /// An error about a mesh is about a model's contact or about the mesh itself.
    fn place_of_mesh<'d>(
        &'d self,
        model: &Place<'d>,
        gears: &[String; 2],
        part: MeshPart,
    ) -> Place<'d> {
        let name = |i: usize| &self.spec.gears[i].name;
        let index =
            (self.spec.meshes.iter()).position(|m| m.gears.map(name) == [&gears[0], &gears[1]]);
        let Some(index) = index else {
            return model.clone();
        };
        let mesh = self.document.at("meshes").member(index);
        let key = match part {
            MeshPart::Layout => return mesh.first(&["centre_distance_m", "backlash_m", "gears"]),
            MeshPart::Start if mesh.has("start") => {
                return mesh.key("start").first(&["path_coordinate_m", "gap_m"]);
            }
            MeshPart::Start => return mesh.first(&["centre_distance_m", "backlash_m", "gears"]),
            MeshPart::Stiffness => "stiffness",
            MeshPart::Exponent => "exponent",
            MeshPart::Damping => "damping",
            MeshPart::Friction => "friction",
            MeshPart::Slices => "slices",
            MeshPart::Contact => "",
        };
        // One contact for all meshes, or one of each.
        let contact = model.key("contact");
        let own = contact.member(index);
        match own.exists() {
            true => own.first(&[key]),
            false if contact.exists() => contact.first(&[key]),
            false => model.clone(),
        }
    }
}
