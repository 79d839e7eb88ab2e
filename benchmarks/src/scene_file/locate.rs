//! The line of a scene file that an error of the assembly is about.

use super::model::ModelPlace;
use super::{SceneError, SceneFile};
use gearbench_models::spec::BuildError;

impl SceneFile {
    /// The place in the file that an error of the assembly is about.
    pub fn locate(&self, error: &BuildError) -> SceneError {
        let choice = self.models.iter().position(|m| {
            error.parameter.is_some() && error.subject.contains(&format!("model `{}`", m.model))
        });
        self.place(choice, error)
    }

    /// The same for an error met while building the model with a label.
    pub fn locate_in(&self, label: &str, error: &BuildError) -> SceneError {
        self.place(self.models.iter().position(|m| m.label == label), error)
    }

    fn place(&self, choice: Option<usize>, error: &BuildError) -> SceneError {
        let model = choice.and_then(|i| self.model_places.get(i));
        let label = choice.map_or(String::new(), |i| {
            format!(" (model `{}`)", self.models[i].label)
        });
        let (message, help) = match error.message.split_once("; ") {
            Some((message, help)) => (message, help),
            None => (
                error.message.as_str(),
                "correct the value, or leave it out to take the default",
            ),
        };
        let message = format!("{}: {message}{label}", error.subject);
        let gear = error
            .gear
            .as_ref()
            .and_then(|g| self.spec.gears.iter().position(|s| s.name == *g));
        let span = if let (Some(key), Some(model)) = (&error.parameter, model) {
            model.first(&[&format!("parameters.{key}"), "parameters", "model"])
        } else if let Some(i) = gear {
            self.gears[i].first(keys_in(&error.message))
        } else if let Some(mesh) = self.mesh_of(&error.subject) {
            self.mesh_span(mesh, model, &error.message)
        } else {
            model.map_or(0..0, |m| m.header.clone())
        };
        self.source.error(span, message, "this", help)
    }

    fn mesh_of(&self, subject: &str) -> Option<usize> {
        self.spec.meshes.iter().position(|m| {
            let [a, b] = m.gears.map(|i| format!("`{}`", self.spec.gears[i].name));
            subject.starts_with("mesh") && subject.contains(&a) && subject.contains(&b)
        })
    }

    /// An error about a mesh is about a model's contact or about the mesh itself.
    fn mesh_span(
        &self,
        mesh: usize,
        model: Option<&ModelPlace>,
        message: &str,
    ) -> std::ops::Range<usize> {
        let says = |words: &[&str]| words.iter().any(|w| message.contains(w));
        let contact: &[&str] = if says(&["slices"]) {
            &["contact.slices", "contact"]
        } else if says(&["damp", "restitution", "Kelvin"]) {
            &["contact.damping", "contact"]
        } else if says(&["exponent"]) {
            &["contact.exponent", "contact"]
        } else if says(&["tiffness", "Hertz", "ISO", "oundation", "table"]) {
            &["contact.stiffness", "contact"]
        } else {
            &[]
        };
        let draft = &self.meshes[mesh];
        match (model, &draft.start) {
            (Some(model), _) if !contact.is_empty() => model.first(contact),
            (_, Some(start)) if says(&["start lies"]) => start.first(&["path_coordinate_m"]),
            _ => draft
                .place
                .first(&["centre_distance_m", "backlash_m", "gears"]),
        }
    }
}

/// Keys of a gear that a message speaks of.
fn keys_in(message: &str) -> &'static [&'static str] {
    if message.contains("inertia") {
        &[
            "inertia_kgm2",
            "mass_kg",
            "added_inertia_kgm2",
            "added_mass_kg",
        ]
    } else if message.contains("load") {
        &["loads"]
    } else if message.contains("mount") || message.contains("driven") {
        &["mount"]
    } else {
        &[]
    }
}
