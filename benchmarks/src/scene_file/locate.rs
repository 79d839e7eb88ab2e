//! Location of assembly errors in the scene file.

use super::reading::Place;
use super::{ModelChoice, SceneError, SceneFile};
use gearbench_models::error::{BuildError, GearPart, MeshPart, Subject};
use gearbench_models::scene::Scene;
use gearbench_models::spec::FlankContact;

impl SceneFile {
    /// Locates an error, met while building the model with a label, in the scene file.
    pub fn locate_in(&self, label: &str, error: &BuildError) -> SceneError {
        let choice = self.models.iter().position(|m| m.label == label);
        let models = self.document.at("models");
        let model = choice.map_or_else(|| models.root(), |i| models.member(i));
        let help = match error.reason.help.as_str() {
            "" => "correct the value, or remove it to use the default",
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
            Subject::Parameter { gear, key, .. } => {
                // A gear's own table of parameters precedes that of all gears.
                let own = (gear.iter()).map(|g| model.key("gears").key(g).key("parameters"));
                let mut all = own.chain([model.key("parameters")]).map(|p| p.key(key));
                (all.find(Place::exists)).unwrap_or_else(|| model.first(&["parameters", "model"]))
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
                    GearPart::Mount => gear.first(&["bearing", "directions", "mount", "axis"]),
                }
            }
            Subject::Shaft { name } => {
                let index = self.spec.shafts.iter().position(|s| s.name == *name);
                let shafts = self.document.at("shafts");
                index.map_or_else(|| model.clone(), |i| shafts.member(i).first(&["name"]))
            }
            Subject::Stage { name } => {
                let index = self.spec.stages.iter().position(|s| s.name == *name);
                let stages = self.document.at("stages");
                index.map_or_else(|| model.clone(), |i| stages.member(i).first(&["name"]))
            }
            Subject::Mesh { gears, part } => self.place_of_mesh(model, gears, *part),
        }
    }

    /// The place of an error of a mesh: the contact of a model, or the mesh itself.
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
            MeshPart::NormalForce => "normal_force",
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

impl SceneFile {
    /// Checks keys of flank points in a model whose gears have no contact points: hard contact is refused, as there
    /// would be no contact at all; a penalty causes a warning.
    pub(super) fn without_effect(
        &self,
        choice: &ModelChoice,
        built: &Scene,
    ) -> Result<Option<SceneError>, SceneError> {
        let flanks = built.gears().iter().any(|g| g.model.surface().is_some());
        let mut contacts = choice.modelling.contacts.iter().map(|c| &c.flanks);
        let of_points = contacts.find(|f| **f != FlankContact::Toothing);
        let Some(of_points) = of_points.filter(|_| !flanks) else {
            return Ok(None);
        };
        let index = self.models.iter().position(|m| m.label == choice.label);
        let model = self.document.at("models").member(index.unwrap_or_default());
        let contact = model.key("contact");
        let place = (contact.member(0)).first(&["law", "penalty_pa_per_m", "penalty_n_per_m"]);
        let place = match place.exists() {
            true => place,
            false => contact.first(&["law", "penalty_pa_per_m", "penalty_n_per_m"]),
        };
        let error = place.error(
            format!(
                "model `{}`: its gears are in contact along lines of action, so that a contact of flank points has no effect",
                choice.label
            ),
            "no flank points",
            "give the stiffness of a tooth pair, such as stiffness = \"iso6336\", or another gear model",
        );
        match of_points.is_hard() {
            true => Err(error),
            false => Ok(Some(error)),
        }
    }
}
